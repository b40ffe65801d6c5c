/* entry: run; inputs: source each 1B 0..4, length 1..16 */
#include <stdint.h>
uint8_t source[16] = {1, 2, 3, 4, 2, 1, 0};
uint8_t length = 7;
static const void *threaded[17];
int run(void)
{
    static const void *const ops[] = {&&stop, &&inc, &&twice, &&minus, &&halve};
    for (unsigned i = 0; i < length; i++)
        threaded[i] = ops[source[i] > 4 ? 0 : source[i]];
    threaded[length] = &&stop;
    const void *const *pc = threaded;
    int x = 7;
    goto **pc++;
inc: x++; goto **pc++;
twice: x *= 2; goto **pc++;
minus: x = -x; goto **pc++;
halve: x /= 2; goto **pc++;
stop: return x;
}
int main(void) { return run(); }
