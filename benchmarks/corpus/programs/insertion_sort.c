/* entry: run; inputs: values any, used 0..40 */
#include <stdint.h>

int16_t values[40] = {31, -4, 15, 92, -65, 35, 89, -79, 32, 38, 46, -26, 43, 38, 32, 79, 50, 28, -84, 19};
uint8_t used = 20;

static void sort(int16_t *data, int n)
{
    for (int i = 1; i < n; i++) {
        int16_t key = data[i];
        int j = i - 1;
        while (j >= 0 && data[j] > key) {
            data[j + 1] = data[j];
            j--;
        }
        data[j + 1] = key;
    }
}

int run(void)
{
    sort(values, used);
    return used ? values[used / 2] : 0;
}

int main(void)
{
    return run();
}
