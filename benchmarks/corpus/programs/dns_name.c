/* entry: run; inputs: packet any, size 12..100 */
#include <stdint.h>
#include <string.h>

/* Answers of a name server: labels with pointers back (at most eight jumps), records skipped, addresses kept. */
uint8_t packet[100] = {0x12, 0x34, 0x81, 0x80, 0, 1, 0, 1, 0, 0, 0, 0, 5, 'r', 'o', 'b', 'o', 't', 3, 'l', 'a', 'n', 0,
                       0, 1, 0, 1, 0xC0, 12, 0, 1, 0, 1, 0, 0, 0, 60, 0, 4, 192, 168, 1, 17};
uint8_t size = 43;
static char name[64];
static uint32_t addresses[4];

static int expand(int at, char *out, int room)
{
    int jumps = 0, after = -1;

    for (;;) {
        if (at >= size)
            return -1;
        uint8_t n = packet[at++];
        if (n == 0)
            break;
        if ((n & 0xC0) == 0xC0) {
            if (at >= size || ++jumps > 8)
                return -1;
            if (after < 0)
                after = at + 1;
            at = (n & 0x3F) << 8 | packet[at];
            continue;
        }
        if (n > 63 || at + n > size || n + 1 >= room)
            return -1;
        memcpy(out, packet + at, n);
        out += n;
        *out++ = '.';
        room -= n + 1;
        at += n;
    }
    *out = '\0';
    return after < 0 ? at : after;
}

static unsigned two(int at)
{
    return (unsigned)packet[at] << 8 | packet[at + 1];
}

int run(void)
{
    unsigned questions = two(4), answers = two(6), found = 0;
    int at = 12;

    while (questions--) {
        at = expand(at, name, sizeof name);
        if (at < 0 || (at += 4) > size)
            return -1;
    }
    while (answers-- && found < 4) {
        at = expand(at, name, sizeof name);
        if (at < 0 || at + 10 > size)
            return -2;
        unsigned type = two(at), length = two(at + 8);
        at += 10;
        if (at + (int)length > size)
            return -3;
        if (type == 1 && length == 4) {
            uint32_t a = 0;
            for (int i = 0; i < 4; i++)
                a = a << 8 | packet[at + i];
            addresses[found++] = a;
        }
        at += (int)length;
    }
    return (int)(found << 8 | strlen(name));
}

int main(void)
{
    return run();
}
