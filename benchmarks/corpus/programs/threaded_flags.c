/* entry: run; inputs: values any, n 1..9 */
#include <stdint.h>
uint8_t values[9] = {4, 9, 2, 7, 7, 1};
uint8_t n = 9;
static uint8_t taken[9];
int run(void)
{
    int order = 0;
    for (int k = 0; k < 9; k++) taken[k] = 0;
    for (;;) {
        int best = -1, second = -1;
        for (int i = 0; i < 9; i++) {
            if (taken[i]) continue;
            if (best < 0 || values[i] > values[best]) { second = best; best = i; }
            else if (second < 0 || values[i] > values[second]) second = i;
        }
        if (best < 0) break;
        taken[best] = 1;
        if (second >= 0 && values[second] == values[best]) taken[second] = 1;
        order = order * 10 + best;
    }
    return order;
}
int main(void) { return run(); }
