/* entry: run; inputs: row any */
#include <stdint.h>

/* Lengths of runs of equal bits in a scan line, as a fax codes them. */
uint32_t row[8] = {0xFFFF0000, 0x00FF00FF, 0, 0xFFFFFFFF, 0x80000001};
static uint8_t runs[256];

int run(void)
{
    int count = 0;
    uint8_t colour = 0, length = 0;

    for (int i = 0; i < 8; i++) {
        uint32_t word = row[i];
        for (int bit = 31; bit >= 0; bit--) {
            uint8_t now = word >> bit & 1;
            if (now == colour && length < 255) {
                length++;
            } else {
                runs[count++] = length;
                colour = now;
                length = 1;
            }
        }
    }
    int longest = 0;
    while (count > 0)
        if (runs[--count] > longest)
            longest = runs[count];
    return longest;
}

int main(void)
{
    return run();
}
