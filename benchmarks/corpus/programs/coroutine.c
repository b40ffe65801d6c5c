/* entry: run; inputs: input any, length 0..48 */
#include <stdint.h>
uint8_t input[48] = "\x03" "aaa\x02zz\x05hello\x00";
uint8_t length = 20;
static uint8_t at;
static struct { uint16_t line; uint8_t left, value; uint16_t out; } unpack, sum;
#define BEGIN(c) switch ((c).line) { case 0:
#define YIELD(c, v) do { (c).line = __LINE__; return (v); case __LINE__:; } while (0)
#define END(c) } (c).line = 0; return -1
static int next_byte(void)
{
    BEGIN(unpack);
    while (at < length) {
        unpack.left = input[at++];
        if (unpack.left == 0) {
            YIELD(unpack, 256);
            continue;
        }
        if (unpack.left > 8) {
            YIELD(unpack, unpack.left);
        } else {
            unpack.value = at < length ? input[at++] : 0;
            while (unpack.left--)
                YIELD(unpack, unpack.value);
        }
    }
    END(unpack);
}
static int summed(int byte)
{
    BEGIN(sum);
    for (;;) {
        sum.out = 0;
        for (sum.left = 0; sum.left < 4; sum.left++) {
            sum.out += byte;
            YIELD(sum, 0);
        }
        YIELD(sum, sum.out);
    }
    END(sum);
}
int run(void)
{
    int total = 0;
    for (int k = 0; k < 200; k++) {
        int byte = next_byte();
        if (byte < 0) break;
        total += summed(byte);
    }
    return total;
}
int main(void) { return run(); }
