/* entry: run; inputs: items any */
#include <stdint.h>

#define N 32
uint16_t items[N] = {500, 2, 77, 41, 900, 3, 15, 15, 68, 42, 0, 13};
static uint8_t low_of[8], high_of[8];

int run(void)
{
    int top = 0;

    low_of[0] = 0;
    high_of[0] = N - 1;
    while (top >= 0) {
        int low = low_of[top], high = high_of[top];
        top--;
        while (low < high) {
            uint16_t pivot = items[(low + high) / 2];
            int i = low, j = high;
            while (i <= j) {
                while (items[i] < pivot)
                    i++;
                while (items[j] > pivot)
                    j--;
                if (i <= j) {
                    uint16_t t = items[i];
                    items[i++] = items[j];
                    items[j--] = t;
                }
            }
            /* the larger part waits on the stack, so that its depth stays logarithmic */
            int put_low = i, put_high = high, next_low = low, next_high = j;
            if (j - low > high - i) {
                put_low = low;
                put_high = j;
                next_low = i;
                next_high = high;
            }
            if (put_low < put_high) {
                top++;
                low_of[top] = (uint8_t)put_low;
                high_of[top] = (uint8_t)put_high;
            }
            low = next_low;
            high = next_high;
        }
    }
    return items[N / 2];
}

int main(void)
{
    return run();
}
