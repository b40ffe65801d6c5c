/* entry: run; inputs: ops each 1B 0..6, n 0..30 */
#include <stdint.h>
uint8_t ops[30] = {0, 1, 2, 3, 4, 5, 6, 5, 4};
uint8_t n = 9;
int run(void)
{
    int a = 1, b = 2;
    for (unsigned i = 0; i < n; i++)
        switch (ops[i]) {
        case 0: a += b; break;
        case 1: a -= b; break;
        case 2: b = a; break;
        case 3: a ^= 0x55; break;
        case 4: { int t = a; a = b; b = t; break; }
        case 5: for (int k = 0; k < 3; k++) b += a >> k; break;
        case 6: a = a > b ? a : b; break;
        default: __builtin_unreachable();
        }
    return a + b;
}
int main(void) { return run(); }
