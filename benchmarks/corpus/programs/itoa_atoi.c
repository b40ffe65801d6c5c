/* entry: run; inputs: value any, digits any */
#include <stdint.h>
#include <string.h>

int32_t value = -90210;
char digits[12] = "  -4711";
static char buffer[36];

static char *reverse(char *s, int n)
{
    for (int i = 0, j = n - 1; i < j; i++, j--) {
        char t = s[i];
        s[i] = s[j];
        s[j] = t;
    }
    return s;
}

static char *to_text(int32_t v, char *out, unsigned base)
{
    uint32_t u = v < 0 && base == 10 ? 0u - (uint32_t)v : (uint32_t)v;
    int n = 0;
    do {
        unsigned digit = u % base;
        out[n++] = (char)(digit < 10 ? '0' + digit : 'a' + digit - 10);
        u /= base;
    } while (u != 0);
    if (v < 0 && base == 10)
        out[n++] = '-';
    out[n] = '\0';
    return reverse(out, n);
}

static int32_t to_number(const char *s)
{
    uint32_t result = 0;
    int sign = 1;
    while (*s == ' ')
        s++;
    if (*s == '-' || *s == '+')
        sign = *s++ == '-' ? -1 : 1;
    for (; *s >= '0' && *s <= '9'; s++)
        result = result * 10 + (uint32_t)(*s - '0');
    return sign * (int32_t)result;
}

int run(void)
{
    digits[11] = '\0';
    int32_t n = to_number(digits);
    int total = (int)strlen(to_text(n, buffer, 10));
    total += (int)strlen(to_text(value, buffer, 16));
    total += (int)strlen(to_text(value, buffer, 2));
    return total + to_number(to_text(value, buffer, 10)) - value;
}

int main(void)
{
    return run();
}
