/* entry: run; inputs: list any */
#include <stdbool.h>
#include <stdint.h>

#define N 25
uint8_t list[N] = {9, 8, 7, 6, 5, 4, 3, 2, 1, 200, 100, 50};

int run(void)
{
    bool swapped;
    uint8_t end = N;

    do {
        swapped = false;
        for (uint8_t i = 1; i < end; i++) {
            if (list[i - 1] > list[i]) {
                uint8_t t = list[i];
                list[i] = list[i - 1];
                list[i - 1] = t;
                swapped = true;
            }
        }
        end--;
    } while (swapped && end > 1);
    return list[0];
}

int main(void)
{
    return run();
}
