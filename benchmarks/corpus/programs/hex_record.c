/* entry: run; inputs: record any */
#include <stdint.h>

/* One line of a memory image: ':' count address kind data checksum, all in hexadecimal digits. */
char record[80] = ":10010000214601360121470136007EFE09D2190140";
static uint8_t memory[512];

static int nibble(char c)
{
    if (c >= 'a')
        c -= 'a' - 'A';
    if (c >= '0' && c <= '9')
        return c - '0';
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

static int byte_at(const char *p)
{
    int high = nibble(p[0]), low = nibble(p[1]);
    return high < 0 || low < 0 ? -1 : high << 4 | low;
}

int run(void)
{
    const char *p = record;
    uint8_t sum = 0, bytes[36];
    int count;

    if (*p++ != ':')
        return -1;
    count = byte_at(p);
    if (count < 0 || count > 32)
        return -2;
    for (int i = 0; i < count + 5; i++) {
        int value = byte_at(p);
        if (value < 0)
            return -3;
        if (i < 36)
            bytes[i] = (uint8_t)value;
        sum += (uint8_t)value;
        p += 2;
    }
    if (sum != 0)
        return -4;
    uint16_t address = (uint16_t)(bytes[1] << 8 | bytes[2]);
    if (bytes[3] == 0)
        for (int i = 0; i < count && address + i < 512; i++)
            memory[address + i] = bytes[4 + i];
    return memory[256];
}

int main(void)
{
    return run();
}
