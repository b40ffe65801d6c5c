/* entry: run; inputs: frames any, length 0..40 */
#include <stdint.h>
uint8_t frames[40] = {0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0, 0x01, 0x23};
uint8_t length = 10;
static uint8_t mode, level;
static uint16_t errors, total;
int run(void)
{
    for (unsigned i = 0; i < length; i++) {
        uint8_t f = frames[i];
        switch (mode) {
        case 0:
            switch (f >> 4) {
            case 0: mode = 1; break;
            case 1: mode = 2; break;
            case 2: case 3: total += f; break;
            case 4: level++; /* fall through */
            case 5: level++; /* fall through */
            case 6: total ^= level; break;
            case 9: mode = 3; break;
            default: errors++;
            }
            break;
        case 1:
            switch (f & 7) {
            case 0: mode = 0; break;
            case 1: total <<= 1; break;
            case 2: for (int k = 0; k < 4; k++) total += k * f; break;
            case 3: mode = 3; break;
            case 4: level = 0; break;
            case 5: errors--; break;
            case 6: total = ~total; break;
            case 7: mode = 2; break;
            }
            break;
        case 2:
            if (f & 1) { mode = 0; continue; }
            for (uint8_t b = f; b; b >>= 1) total += b & 1;
            break;
        default:
            mode = f % 3;
            break;
        }
    }
    return total + errors * 256;
}
int main(void) { return run(); }
