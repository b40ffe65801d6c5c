/* entry: run; inputs: request any, length 0..64, holding any */
#include <stdint.h>
#include <string.h>

/* A slave: checks the frame, reads or writes registers, answers or answers an exception. */
#define UNIT 17
#define REGISTERS 40

enum { READ = 3, WRITE_ONE = 6, WRITE_MANY = 16 };
enum error { NONE, BAD_FUNCTION, BAD_ADDRESS, BAD_VALUE };

uint8_t request[64] = {17, 3, 0, 4, 0, 6, 0x87, 0x59};
uint8_t length = 8;
uint16_t holding[REGISTERS] = {10, 20, 30, 40, 50, 60, 70, 80, 90, 100};
static uint8_t reply[96];

static uint16_t crc(const uint8_t *p, uint16_t n)
{
    uint16_t value = 0xFFFF;
    for (const uint8_t *end = p + n; p != end; ++p) {
        value ^= *p;
        for (uint8_t i = 8; i != 0; i--) {
            uint8_t carry = value & 1;
            value >>= 1;
            if (carry)
                value ^= 0xA001;
        }
    }
    return value;
}

static uint16_t big(const uint8_t *p)
{
    return (uint16_t)(p[0] << 8 | p[1]);
}

static enum error read_registers(const uint8_t *p, uint8_t *out, uint16_t *used)
{
    uint16_t first = big(p), n = big(p + 2);
    if (n == 0 || n > 32)
        return BAD_VALUE;
    if (first >= REGISTERS || first + n > REGISTERS)
        return BAD_ADDRESS;
    *out++ = (uint8_t)(2 * n);
    for (const uint16_t *r = &holding[first]; r < &holding[first + n]; r++) {
        *out++ = (uint8_t)(*r >> 8);
        *out++ = (uint8_t)*r;
    }
    *used += 1 + 2 * n;
    return NONE;
}

static enum error write_many(const uint8_t *p, uint16_t left)
{
    uint16_t first = big(p), n = big(p + 2), bytes = p[4];
    if (n == 0 || n > 24 || bytes != 2 * n || bytes + 5 > left)
        return BAD_VALUE;
    if (first + n > REGISTERS)
        return BAD_ADDRESS;
    p += 5;
    while (n--) {
        holding[first++] = big(p);
        p += 2;
    }
    return NONE;
}

static int serve(void)
{
    enum error error = NONE;
    uint16_t used = 2;

    if (length < 8 || crc(request, length) != 0)
        goto silent;
    if (request[0] != UNIT && request[0] != 0)
        goto silent;
    memcpy(reply, request, 6);
    switch (request[1]) {
    case READ:
        error = read_registers(request + 2, reply + 2, &used);
        break;
    case WRITE_ONE:
        if (big(request + 2) >= REGISTERS) {
            error = BAD_ADDRESS;
            break;
        }
        holding[big(request + 2)] = big(request + 4);
        used = 6;
        break;
    case WRITE_MANY:
        error = write_many(request + 2, length - 4);
        used = 6;
        break;
    default:
        error = BAD_FUNCTION;
    }
    if (request[0] == 0)
        goto silent;
    if (error) {
        reply[1] |= 0x80;
        reply[2] = error;
        used = 3;
    }
    uint16_t sum = crc(reply, used);
    reply[used++] = (uint8_t)sum;
    reply[used++] = (uint8_t)(sum >> 8);
    return used;
silent:
    return 0;
}

int run(void)
{
    return serve();
}

int main(void)
{
    return run();
}
