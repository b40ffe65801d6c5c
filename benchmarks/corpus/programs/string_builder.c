/* entry: run; inputs: readings any, count 0..6, name any */
#include <stdarg.h>
#include <stdint.h>

/* A report line in a buffer of fixed size: own formatted output with variable arguments, fields and padding. */
struct builder {
    char *at, *end;
    uint8_t cut;
};

int32_t readings[6] = {12, -7, 123456, 0, 65535};
uint8_t count = 5;
char name[10] = "pump";
static char line[100];

static void put(struct builder *b, char c)
{
    if (b->at < b->end)
        *b->at++ = c;
    else
        b->cut = 1;
}

static void number(struct builder *b, uint32_t value, unsigned base, int width, char pad)
{
    char digits[12], *p = digits + sizeof digits;

    do {
        unsigned digit = value % base;
        *--p = (char)(digit < 10 ? '0' + digit : 'a' + digit - 10);
        value /= base;
    } while (value != 0);
    while (digits + sizeof digits - p < width--)
        put(b, pad);
    for (; p < digits + sizeof digits; p++)
        put(b, *p);
}

static void format(struct builder *b, const char *f, ...)
{
    va_list list;

    va_start(list, f);
    for (; *f != '\0'; f++) {
        int width = 0;
        char pad = ' ';
        if (*f != '%') {
            put(b, *f);
            continue;
        }
        if (*++f == '0')
            pad = *f++;
        while (*f >= '0' && *f <= '9')
            width = 10 * width + *f++ - '0';
        switch (*f) {
        case 'd': {
            int32_t v = va_arg(list, int32_t);
            if (v < 0)
                put(b, '-');
            number(b, v < 0 ? 0u - (uint32_t)v : (uint32_t)v, 10, width, pad);
            break;
        }
        case 'x':
            number(b, va_arg(list, uint32_t), 16, width, pad);
            break;
        case 's':
            for (const char *s = va_arg(list, const char *); *s; s++)
                put(b, *s);
            break;
        default:
            put(b, *f);
        }
    }
    va_end(list);
}

int run(void)
{
    struct builder b = {line, line + sizeof line - 1, 0};

    name[sizeof name - 1] = '\0';
    format(&b, "%s #%02d:", name, count);
    for (uint8_t i = 0; i < count; i++)
        format(&b, " %6d/%04x", readings[i], (uint32_t)readings[i] & 0xFFFF);
    format(&b, "%%");
    *b.at = '\0';
    return (int)(b.at - line) << 1 | b.cut;
}

int main(void)
{
    return run();
}
