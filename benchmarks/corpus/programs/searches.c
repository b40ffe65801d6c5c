/* entry: run; inputs: wanted any, limit 0..64 */
#include <stdint.h>

static const uint16_t table[64] = {
    3,   7,   9,   14,  20,  21,  25,  30,  33,  41,  44,  50,  58,  59,  60,  71,  73,  80,  86,  90,  95,  99,
    104, 110, 117, 121, 130, 131, 140, 146, 150, 159, 161, 170, 178, 180, 190, 199, 203, 210, 214, 220, 228, 233,
    240, 251, 260, 266, 270, 281, 290, 300, 310, 321, 330, 340, 351, 360, 371, 380, 391, 400, 410, 420};
uint16_t wanted = 180;
uint8_t limit = 64;

static int linear(uint16_t key, int n)
{
    int i = 0;
    while (i < n && table[i] != key)
        i++;
    return i < n ? i : -1;
}

static int binary(uint16_t key, int n)
{
    int low = 0, high = n - 1;
    while (low <= high) {
        int middle = low + (high - low) / 2;
        if (table[middle] == key)
            return middle;
        if (table[middle] < key)
            low = middle + 1;
        else
            high = middle - 1;
    }
    return -1;
}

static int lower_bound(uint16_t key, unsigned n)
{
    const uint16_t *first = table;
    while (n > 0) {
        unsigned half = n >> 1;
        if (first[half] < key) {
            first += half + 1;
            n -= half + 1;
        } else {
            n = half;
        }
    }
    return (int)(first - table);
}

int run(void)
{
    int a = linear(wanted, limit), b = binary(wanted, limit), c = lower_bound(wanted, limit);
    return a == b && (a < 0 || a == c) ? a : -2;
}

int main(void)
{
    return run();
}
