/* entry: run; inputs: text any */
#include <stdint.h>

char text[64] = "Gr\xC3\xBC\xC3\x9F\x65 \xE2\x82\xAC 5 \xF0\x9F\xA4\x96 \xC0\x80 end";
static uint16_t wide[64];
static unsigned bad;

/* One code point; *at moves past it; what is no UTF-8 counts as one bad byte. */
static uint32_t next(const unsigned char **at, const unsigned char *end)
{
    const unsigned char *p = *at;
    unsigned char first = *p++;
    unsigned more;
    uint32_t point, least;

    if (first < 0x80) {
        *at = p;
        return first;
    }
    if ((first & 0xE0) == 0xC0) {
        more = 1, point = first & 0x1F, least = 0x80;
    } else if ((first & 0xF0) == 0xE0) {
        more = 2, point = first & 0x0F, least = 0x800;
    } else if ((first & 0xF8) == 0xF0) {
        more = 3, point = first & 0x07, least = 0x10000;
    } else {
        goto wrong;
    }
    while (more--) {
        if (p == end || (*p & 0xC0) != 0x80)
            goto wrong;
        point = point << 6 | (*p++ & 0x3F);
    }
    if (point < least || point > 0x10FFFF || (point >= 0xD800 && point < 0xE000))
        goto wrong;
    *at = p;
    return point;
wrong:
    bad++;
    ++*at;
    return 0xFFFD;
}

int run(void)
{
    const unsigned char *p = (const unsigned char *)text, *end = p + sizeof text;
    uint16_t *out = wide;

    while (p < end && *p) {
        uint32_t point = next(&p, end);
        if (point >= 0x10000) {
            if (out > wide + 61)
                break;
            *out++ = (uint16_t)(0xD800 + ((point - 0x10000) >> 10));
            *out++ = (uint16_t)(0xDC00 + (point & 0x3FF));
        } else {
            *out++ = (uint16_t)point;
        }
    }
    return (int)(out - wide) << 8 | (int)bad;
}

int main(void)
{
    return run();
}
