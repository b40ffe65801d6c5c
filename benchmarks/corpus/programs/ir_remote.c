/* entry: run; inputs: edges each 2B 0..15000, captured 0..72 */
#include <stdint.h>

/* Pulse lengths of an infrared remote: start, 32 bits, repeats; tolerance of a quarter. */
enum state { WAITING, LEADER, BITS, REPEAT };

uint16_t edges[72] = {9000, 4500, 560, 560, 560, 1690, 560, 560, 560, 560};
uint8_t captured = 68;
static uint32_t code;
static uint8_t keys[8], key_count;

static int near(uint16_t seen, uint16_t wanted)
{
    uint16_t slack = wanted >> 2;
    return seen >= wanted - slack && seen <= wanted + slack;
}

static uint8_t reverse(uint8_t b)
{
    uint8_t r = 0;
    for (int i = 0; i < 8; i++, b >>= 1)
        r = (uint8_t)(r << 1 | (b & 1));
    return r;
}

int run(void)
{
    enum state state = WAITING;
    uint8_t bits = 0, i = 0;

    while (i + 1 < captured) {
        uint16_t mark = edges[i], space = edges[i + 1];
        switch (state) {
        case WAITING:
            if (near(mark, 9000)) {
                state = LEADER;
                break;
            }
            i++;
            break;
        case LEADER:
            if (near(space, 4500)) {
                state = BITS;
                bits = 0;
                i += 2;
            } else if (near(space, 2250)) {
                state = REPEAT;
                i += 2;
            } else {
                state = WAITING;
                i++;
            }
            break;
        case BITS:
            if (!near(mark, 560)) {
                state = WAITING;
                break;
            }
            code >>= 1;
            if (near(space, 1690))
                code |= 0x80000000u;
            i += 2;
            if (++bits == 32) {
                state = WAITING;
                uint8_t command = (uint8_t)(code >> 16);
                if ((command ^ (uint8_t)~(code >> 24)) == 0 && key_count < 8)
                    keys[key_count++] = reverse(command);
            }
            break;
        case REPEAT:
            if (key_count && key_count < 8) {
                keys[key_count] = keys[key_count - 1];
                key_count++;
            }
            state = WAITING;
            break;
        }
    }
    return key_count;
}

int main(void)
{
    return run();
}
