/* entry: run; inputs: samples any, width 1..9 */
#include <stdint.h>
#include <string.h>

int16_t samples[40] = {5, 9, 2, 100, 7, 3, 3, 8, -50, 4, 6, 2, 1, 9, 9, 7};
uint8_t width = 5;
int16_t smooth[40];

static void order(int16_t *a, uint8_t n)
{
    for (uint8_t i = 1; i < n; i++) {
        uint8_t j = i;
        int16_t v = a[i];
        for (; j > 0 && a[j - 1] > v; j--)
            a[j] = a[j - 1];
        a[j] = v;
    }
}

int run(void)
{
    int16_t window[9];
    const int count = 40;

    for (int i = 0; i + width <= count; i++) {
        memcpy(window, &samples[i], width * sizeof window[0]);
        order(window, width);
        smooth[i] = window[width / 2];
    }
    return smooth[3];
}

int main(void)
{
    return run();
}
