/* entry: run; inputs: masks any */
#include <stdint.h>
uint8_t masks[10] = {0x81, 0x42, 0x24, 0x18, 0xff};
static unsigned served[8];
int run(void)
{
    unsigned total = 0;
    for (int i = 0; i < 10; i++) {
        unsigned mask = masks[i];
        while (mask) {
            switch (__builtin_ctz(mask)) {
            case 0: total += 1; break;
            case 1: total += served[0]; served[1]++; break;
            case 2: total ^= 7; break;
            case 3: served[3] += total; break;
            case 4: for (int k = 0; k < 2; k++) total += k; break;
            case 5: total--; break;
            case 6: served[6]++; break;
            case 7: total <<= 1; break;
            }
            mask &= mask - 1;
        }
    }
    return (int)total;
}
int main(void) { return run(); }
