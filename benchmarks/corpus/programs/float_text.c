/* entry: run; inputs: text any */
#include <stdint.h>

/* Decimal fractions with exponents from text to double and back to seven digits. */
char text[24] = "-12.625e-3";
static char out[24];

static double power10(int e)
{
    double result = 1.0, base = 10.0;
    unsigned n = e < 0 ? -(unsigned)e : (unsigned)e;
    while (n) {
        if (n & 1)
            result *= base;
        base *= base;
        n >>= 1;
    }
    return e < 0 ? 1.0 / result : result;
}

static int read(const char *s, double *value)
{
    double v = 0;
    int scale = 0, exponent = 0, negative = *s == '-', minus;

    if (*s == '-' || *s == '+')
        s++;
    while (*s >= '0' && *s <= '9')
        v = v * 10 + (*s++ - '0');
    if (*s == '.')
        for (s++; *s >= '0' && *s <= '9'; s++, scale--)
            v = v * 10 + (*s - '0');
    if (*s == 'e' || *s == 'E') {
        minus = *++s == '-';
        if (minus)
            s++;
        while (*s >= '0' && *s <= '9' && exponent < 30)
            exponent = exponent * 10 + (*s++ - '0');
        scale += minus ? -exponent : exponent;
    }
    v *= power10(scale);
    *value = negative ? -v : v;
    return *s == '\0';
}

static int write(double v)
{
    char *p = out;
    int exponent = 0;

    if (v < 0) {
        *p++ = '-';
        v = -v;
    }
    if (v > 0) {
        while (v >= 10 && exponent < 320)
            v /= 10, exponent++;
        while (v < 1 && exponent > -330)
            v *= 10, exponent--;
    }
    for (int i = 0; i < 7; i++) {
        int digit = (int)v;
        *p++ = (char)('0' + digit);
        if (i == 0)
            *p++ = '.';
        v = (v - digit) * 10;
    }
    *p = '\0';
    return exponent;
}

int run(void)
{
    double value;
    text[sizeof text - 1] = '\0';
    return read(text, &value) ? write(value) : -1000;
}

int main(void)
{
    return run();
}
