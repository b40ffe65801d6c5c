/* entry: run; inputs: moves any, n 0..30 */
#include <stdint.h>
int8_t moves[30] = {-4, -3, -2, -1, 0, 1, 2, 3, 4, 90, -90};
uint8_t n = 11;
static int x, y, z;
int run(void)
{
    for (unsigned i = 0; i < n; i++)
        switch (moves[i]) {
        case -4: x--; break;
        case -3: y--; break;
        case -2: z--; x += y; break;
        case -1: for (int k = 0; k < 3; k++) z += k; break;
        case 0: x = y = z = 0; break;
        case 1: x++; break;
        case 2: y++; break;
        case 3: z++; y ^= x; break;
        case 4: x *= 2; break;
        case 40 ... 60: z = 3; break;
        default: return -1;
        }
    return x + y + z;
}
int main(void) { return run(); }
