/* Jumps whose targets no code checks, and loops that compilers enter in several places. */
#include <stdint.h>

uint8_t data[16];

int computed(void)
{
    static const void *const labels[] = {&&stop, &&increment, &&twice, &&negate, &&loop};
    const uint8_t *next = data;
    int x = 1;
    data[15] = 0;
    goto *labels[*next++];
increment: x++; goto *labels[*next++];
twice: x *= 2; goto *labels[*next++];
negate: x = -x; goto *labels[*next++];
loop:
    for (int i = 0; i < 3; i++)
        x += i * x;
    goto *labels[*next++];
stop:
    return x;
}

int threaded(void)
{
    static const void *const labels[] = {&&stop, &&increment, &&twice, &&negate, &&stop};
    static const void *code[17];
    int x = 7;
    for (int i = 0; i < 16; i++)
        code[i] = labels[data[i]];
    code[16] = &&stop;
    const void *const *next = code;
    goto **next++;
increment: x++; goto **next++;
twice: x *= 2; goto **next++;
negate: x = -x; goto **next++;
stop: return x;
}

int unchecked(void)
{
    int a = 1, b = 2;
    for (int i = 0; i < 16; i++)
        switch (data[i]) {
        case 0: a += b; break;
        case 1: a -= b; break;
        case 2: { int t = a; a = b; b = t; break; }
        case 3: b ^= 0x55; break;
        case 4: for (int k = 0; k < 3; k++) b += a >> k; break;
        default: __builtin_unreachable();
        }
    return a + b;
}

static struct { uint16_t line; uint8_t left, value, at; } coroutine;
#define YIELD(v) do { coroutine.line = __LINE__; return (v); case __LINE__:; } while (0)

static int next_byte(void)
{
    switch (coroutine.line) {
    case 0:
        while (coroutine.at < 15) {
            coroutine.left = data[coroutine.at++];
            if (coroutine.left == 0) {
                YIELD(256);
                continue;
            }
            coroutine.value = data[coroutine.at++];
            while (coroutine.left--)
                YIELD(coroutine.value);
        }
    }
    return -1;
}

int resumed(void)
{
    int total = 0, byte;
    coroutine.line = coroutine.at = 0;
    for (int k = 0; k < 100; k++) {
        if ((byte = next_byte()) < 0)
            break;
        total += byte;
    }
    return total;
}

int lowest(void)
{
    unsigned total = 0, mask = data[0] * 51u;
    while (mask) {
        switch (__builtin_ctz(mask)) {
        case 0: total += 1; break;
        case 1: total += data[1]; break;
        case 2: total ^= 7; break;
        case 3: total -= mask; break;
        case 4: total <<= 1; break;
        case 5: total--; break;
        case 6: total |= 64; break;
        case 7: total ^= total << 1; break;
        }
        mask &= mask - 1;
    }
    return (int)total;
}

int middle(void)
{
    unsigned x = 0, r = 0, k = 0;
    if (data[0] == 1) goto second;
    if (data[0] == 2) goto third;
    do {
        x += data[r & 15];
        for (k = 0; k < 3; k++) {
            x ^= x << 1;
            if (x & 8) goto third;
    second:
            x += data[(r + k) & 15];
        }
        x -= r;
    third:
        if (x & 2) x >>= 1;
        r++;
    } while (r < 9);
    return (int)x;
}

void _start(void) { computed(); threaded(); unchecked(); resumed(); lowest(); middle(); }
