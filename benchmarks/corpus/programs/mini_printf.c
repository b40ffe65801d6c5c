/* entry: run; inputs: temperature any, counter any, label any */
#include <stdarg.h>
#include <stdint.h>

int16_t temperature = -273;
uint32_t counter = 123456;
char label[10] = "tank";
static char out[80];

static char *unsigned_text(char *p, char *end, uint32_t v, unsigned base, int width, char pad)
{
    char digits[11];
    int n = 0;
    do
        digits[n++] = "0123456789ABCDEF"[v % base];
    while ((v /= base) != 0);
    while (width-- > n && p < end)
        *p++ = pad;
    while (n > 0 && p < end)
        *p++ = digits[--n];
    return p;
}

static int format(char *to, int room, const char *f, ...)
{
    char *p = to, *end = to + room - 1;
    va_list list;

    va_start(list, f);
    for (; *f; f++) {
        if (*f != '%') {
            if (p < end)
                *p++ = *f;
            continue;
        }
        int width = 0;
        char pad = ' ';
        f++;
        if (*f == '0') {
            pad = '0';
            f++;
        }
        while (*f >= '0' && *f <= '9')
            width = width * 10 + (*f++ - '0');
        switch (*f) {
        case 'd': {
            int v = va_arg(list, int);
            if (v < 0 && p < end)
                *p++ = '-';
            p = unsigned_text(p, end, v < 0 ? 0u - (unsigned)v : (unsigned)v, 10, width, pad);
            break;
        }
        case 'u':
            p = unsigned_text(p, end, va_arg(list, unsigned), 10, width, pad);
            break;
        case 'x':
            p = unsigned_text(p, end, va_arg(list, unsigned), 16, width, pad);
            break;
        case 's':
            for (const char *s = va_arg(list, const char *); *s && p < end; s++)
                *p++ = *s;
            break;
        case 'c':
            if (p < end)
                *p++ = (char)va_arg(list, int);
            break;
        default:
            if (p < end)
                *p++ = *f;
            break;
        }
    }
    va_end(list);
    *p = '\0';
    return (int)(p - to);
}

int run(void)
{
    label[9] = '\0';
    return format(out, sizeof out, "%s: t=%d n=%08x (%6u)%c%%", label, temperature, (unsigned)counter,
                  (unsigned)counter, '!');
}

int main(void)
{
    return run();
}
