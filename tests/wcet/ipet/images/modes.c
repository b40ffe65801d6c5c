/* Branches over the same value, with a loop in between that a compiler does not copy. */
typedef struct { int mode; int gain; } State;

#ifdef __clang__
#define NOT_COPIED __attribute__((noinline))
#else
#define NOT_COPIED __attribute__((noipa))
#endif

int mode;
volatile int out;
int data[64];

NOT_COPIED int heavy(int n)
{
    int sum = 0;
    for (int i = 0; i < 50; i++)
        sum += data[i] * n;
    return sum;
}

NOT_COPIED int light(int n)
{
    int sum = 0;
    for (int i = 0; i < 5; i++)
        sum += data[i] ^ n;
    return sum;
}

NOT_COPIED void choose(int n)
{
    mode = n & 3;
}

#define BETWEEN \
    for (int k = 0; k < 7; k++) { \
        out = r; r += out; out = r ^ 3; r ^= out + 1; out = r * 5; r -= out; \
        if (out) r ^= out; \
    }

int global(int n)
{
    int r = 0;
    mode = n;
    out = light(n);
    if (mode == 1)
        r = heavy(3);
    BETWEEN
    if (mode == 2)
        r += heavy(5);
    return r;
}

int argument(int x)
{
    int r = 0;
    if (x > 5)
        r += heavy(x);
    BETWEEN
    if (x < 3)
        r += heavy(x + 1);
    return r;
}

int flag(int f)
{
    int r = 0;
    if (f)
        r += heavy(1);
    else
        r += light(1);
    BETWEEN
    if (!f)
        r += heavy(7);
    return r;
}

int twice(int m)
{
    int r = 0;
    switch (m) {
    case 0: r = heavy(1); break;
    case 1: r = light(1); break;
    case 2: r = light(2); break;
    case 3: r = 3; break;
    case 4: r = 4; break;
    case 5: r = light(5); break;
    default: r = 9;
    }
    BETWEEN
    switch (m) {
    case 0: r += light(1); break;
    case 1: r += heavy(1); break;
    case 2: r += light(3); break;
    case 3: r += light(4); break;
    case 4: r ^= 4; break;
    case 5: r += heavy(6); break;
    default: r |= 9;
    }
    return r;
}

int looped(int m)
{
    int r = 0;
    for (int i = 0; i < 10; i++) {
        if (m == 1)
            r += heavy(i);
        else
            r += light(i);
        BETWEEN
        if (m == 2)
            r += heavy(i + 1);
        else
            r += light(i);
    }
    return r;
}

int each(int n)
{
    int r = 0;
    data[3] = n;
    for (int i = 0; i < 10; i++) {
        int x = data[i];
        if (x == 1)
            r += heavy(i);
        BETWEEN
        if (x == 2)
            r += heavy(i + 1);
    }
    return r;
}

int object(State *state)
{
    int r = 0, m = state->mode;
    if (m == 1)
        r += heavy(1);
    BETWEEN
    r += state->gain;
    if (m == 2)
        r += heavy(2);
    return r;
}

int saved(int x)
{
    int big = x > 4, r = 0;
    if (big)
        r += heavy(1);
    BETWEEN
    if (x < 2)
        r += heavy(2);
    return r;
}

/* Both heavy calls may happen: the value changes in between. */
int changed(int n)
{
    int r = 0;
    mode = n;
    if (mode == 1)
        r += heavy(1);
    choose(n + 1);
    if (mode == 2)
        r += heavy(2);
    return r;
}

/* The same in different iterations. */
int alternating(int n)
{
    int r = 0;
    for (int i = 0; i < 4; i++) {
        if (n == 1)
            r += heavy(1);
        out = r;
        if (n == 2)
            r += heavy(2);
        n = 3 - n;
    }
    return r;
}

void _start(void) {}
