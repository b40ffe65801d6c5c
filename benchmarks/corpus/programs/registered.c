/* entry: run; inputs: events each 1B 0..3, n 0..20, swap 0..1 */
#include <stdint.h>
typedef void (*handler)(uint8_t);
uint8_t events[20] = {0, 1, 2, 3, 1, 2};
uint8_t n = 6, swap = 0;
static handler handlers[4];
static unsigned count, sum, peak;
static void ignore(uint8_t e) { count++; (void)e; }
static void add(uint8_t e) { sum += e; }
static void shift(uint8_t e) { for (unsigned i = 0; i < e; i++) sum ^= sum << 1; }
static void top(uint8_t e) { if (e > peak) peak = e; handlers[1] = ignore; }
static void reg(unsigned at, handler h) { if (at < 4) handlers[at] = h; }
int run(void)
{
    reg(0, ignore); reg(1, add); reg(2, swap ? shift : add); reg(3, top);
    for (unsigned i = 0; i < n; i++) handlers[events[i] & 3]((uint8_t)i);
    return (int)(count + sum + peak);
}
int main(void) { return run(); }
