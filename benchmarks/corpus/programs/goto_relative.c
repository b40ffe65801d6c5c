/* entry: run; inputs: text each 1B 0..3, count 0..20 */
#include <stdint.h>
uint8_t text[20] = {0, 1, 2, 3, 2, 1, 0, 3};
uint8_t count = 8;
int run(void)
{
    static const int offset[] = {&&a - &&a, &&b - &&a, &&c - &&a, &&d - &&a};
    int x = 1;
    for (unsigned i = 0; i < count; i++) {
        goto *(&&a + offset[text[i] & 3]);
    a: x += 3; continue;
    b: x ^= 5; continue;
    c: x <<= 1; continue;
    d: while (x > 100) x -= 60;
    }
    return x;
}
int main(void) { return run(); }
