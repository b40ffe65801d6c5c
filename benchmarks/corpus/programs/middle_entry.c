/* entry: run; inputs: values any, first 0..2, rounds 0..12 */
#include <stdint.h>
uint8_t values[16] = {9, 3, 200, 17, 66, 1};
uint8_t first = 1, rounds = 5;
int run(void)
{
    unsigned i = 0, r = 0, x = 0, k = 0;
    if (rounds == 0) return 0;
    if (first == 1) goto second;
    if (first == 2) goto third;
    do {
        x += values[i & 15];
        for (k = 0; k < 3; k++) {
            x ^= x << 1;
            if (x & 0x100) goto third;
    second:
            x += values[(i + k) & 15];
            i++;
        }
        x -= r;
    third:
        if (x & 2) { i += 2; x >>= 1; }
        r++;
    } while (r < rounds);
    return (int)x;
}
int main(void) { return run(); }
