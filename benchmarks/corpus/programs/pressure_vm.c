/* entry: run; inputs: program each 1B 0..15, data any, limit 1..60 */
#include <stdint.h>
uint8_t program[60] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 0};
uint32_t data[8] = {3, 1, 4, 1, 5, 9, 2, 6};
uint8_t limit = 40;
static uint32_t out[8];
int run(void)
{
    uint32_t a = data[0], b = data[1], c = data[2], d = data[3], e = data[4], f = data[5], g = data[6], h = data[7];
    unsigned pc = 0, steps = 0;
    while (steps++ < limit && pc < 60) {
        switch (program[pc++]) {
        case 0: steps = limit; break;
        case 1: a += b; break;
        case 2: b ^= c; break;
        case 3: c += d << 3; break;
        case 4: d -= e; break;
        case 5: e = e >> 1 | f << 31; break;
        case 6: f += g * 3; break;
        case 7: g ^= h; break;
        case 8: h += a; break;
        case 9: { uint32_t t = a; a = h; h = t; break; }
        case 10: if (a & 1) pc++; break;
        case 11: b += c + d + e; break;
        case 12: c = f ^ g; break;
        case 13: pc = (pc + (d & 3)); break;
        case 14: e += 7; f -= 7; break;
        default: g = a + b + c + d + e + f + h; break;
        }
    }
    out[0] = a; out[1] = b; out[2] = c; out[3] = d; out[4] = e; out[5] = f; out[6] = g; out[7] = h;
    return (int)(a ^ b ^ c ^ d ^ e ^ f ^ g ^ h);
}
int main(void) { return run(); }
