/* Loops on numbers of which nothing is known: each ends for a reason of its own, if it ends. */
#include <stdint.h>

/* With 0, this never ends. */
int trailing(uint32_t x)
{
    int n = 0;
    while (!(x & 1)) {
        x >>= 1;
        n++;
    }
    return n;
}

/* Nor does this. */
int normal(uint32_t x)
{
    int n = 0;
    while (x < 1u << 24) {
        x <<= 8;
        n++;
    }
    return n;
}

/* Nor this, with a negative number. */
int halves(int32_t x)
{
    int n = 0;
    while (x) {
        x >>= 1;
        n++;
    }
    return n;
}

/* With 0 this ends: nothing may be concluded from the passes alone. */
int leaves(uint32_t x)
{
    int n = 0;
    while (!(x & 1)) {
        if (n == 40)
            return -1;
        x >>= 1;
        n++;
    }
    return n;
}

int common(int32_t a, int32_t b)
{
    while (b) {
        int32_t t = a % b;
        a = b;
        b = t;
    }
    return a;
}

unsigned divisor(unsigned a, unsigned b)
{
    while (b) {
        unsigned t = a % b;
        a = b;
        b = t;
    }
    return a;
}

/* A counter in eight bits, compared with sign. */
int refill(int held, int wanted)
{
    int8_t bits = (int8_t)held, most = (int8_t)(wanted & 15);
    int n = 0;
    while (bits < most) {
        bits += 8;
        n++;
    }
    return n;
}

/* A place in a heap in bytes, and the ones above it. */
int above(int place)
{
    uint8_t at = (uint8_t)place;
    int n = 0;
    while (at) {
        at = (uint8_t)((at - 1) >> 1);
        n++;
    }
    return n;
}

/* Roots by Newton's method, in three shapes. */
unsigned falls(unsigned n)
{
    unsigned x, y = n;
    do {
        x = y;
        y = (x + n / x) / 2;
    } while (y < x);
    return x;
}

unsigned guessed(unsigned n, unsigned y)
{
    unsigned x = n;
    while (y < x) {
        x = y;
        y = (x + n / x) / 2;
    }
    return x;
}

unsigned meets(unsigned n, unsigned y)
{
    unsigned x = n;
    while (x > y) {
        x = (x + y) / 2;
        y = n / x;
    }
    return x;
}

/* Not a root: what is divided changes. */
unsigned drifts(unsigned n, unsigned y)
{
    unsigned x = n, k = 0;
    while (y < x && k < 99) {
        x = y;
        y = (x + n / x) / 2;
        n += k++;
    }
    return x;
}

int main(void)
{
    return (int)(falls(9) + guessed(9, 2) + meets(9, 1) + drifts(9, 2)) + trailing(4) + normal(4) + halves(4) + leaves(4) + common(4, 6) + (int)divisor(4, 6) + refill(0, 9) + above(9);
}
