/* entry: run; inputs: a any, b any, digits any */
#include <stdint.h>
#include <string.h>

/* Numbers of 160 bits: product, quotient by shifting, decimal text both ways. */
#define WORDS 5

uint32_t a[WORDS] = {0x89ABCDEF, 0x01234567, 0xDEADBEEF, 7}, b[WORDS] = {0x12345, 99};
char digits[40] = "12345678901234567890123";
static uint32_t product[2 * WORDS], quotient[WORDS], rest[WORDS];
static char decimal[52];

static void multiply(void)
{
    memset(product, 0, sizeof product);
    for (int i = 0; i < WORDS; i++) {
        uint32_t carry = 0;
        for (int k = 0; k < WORDS; k++) {
            uint64_t t = (uint64_t)a[i] * b[k] + product[i + k] + carry;
            product[i + k] = (uint32_t)t;
            carry = (uint32_t)(t >> 32);
        }
        product[i + WORDS] = carry;
    }
}

static int compare(const uint32_t *x, const uint32_t *y)
{
    int i = WORDS;
    while (i-- > 0)
        if (x[i] != y[i])
            return x[i] < y[i] ? -1 : 1;
    return 0;
}

static int divide(void)
{
    const uint32_t zero[WORDS] = {0};
    if (!compare(b, zero))
        return -1;
    memset(rest, 0, sizeof rest);
    memset(quotient, 0, sizeof quotient);
    for (int bit = 32 * WORDS - 1; bit >= 0; bit--) {
        uint32_t carry = a[bit / 32] >> bit % 32 & 1;
        for (int i = 0; i < WORDS; i++) {
            uint32_t out = rest[i] >> 31;
            rest[i] = rest[i] << 1 | carry;
            carry = out;
        }
        if (carry || compare(rest, b) >= 0) {
            uint32_t borrow = 0;
            for (int i = 0; i < WORDS; i++) {
                uint64_t t = (uint64_t)rest[i] - b[i] - borrow;
                rest[i] = (uint32_t)t;
                borrow = t >> 32 != 0;
            }
            quotient[bit / 32] |= 1u << bit % 32;
        }
    }
    return 0;
}

static char *to_text(uint32_t *n)
{
    char *p = decimal + sizeof decimal - 1;
    int top = WORDS - 1;

    *p = '\0';
    do {
        uint32_t left = 0;
        for (int i = top; i >= 0; i--) {
            uint64_t t = (uint64_t)left << 32 | n[i];
            n[i] = (uint32_t)(t / 10);
            left = (uint32_t)(t % 10);
        }
        *--p = (char)('0' + left);
        while (top >= 0 && n[top] == 0)
            top--;
    } while (top >= 0 && p > decimal);
    return p;
}

static void from_text(const char *s)
{
    memset(rest, 0, sizeof rest);
    for (; *s >= '0' && *s <= '9'; s++) {
        uint32_t carry = (uint32_t)(*s - '0');
        for (uint32_t *p = rest; p < rest + WORDS; p++) {
            uint64_t t = (uint64_t)*p * 10 + carry;
            *p = (uint32_t)t;
            carry = (uint32_t)(t >> 32);
        }
    }
}

int run(void)
{
    digits[sizeof digits - 1] = '\0';
    multiply();
    int status = divide();
    from_text(digits);
    return (int)strlen(to_text(rest)) + status + (int)product[9];
}

int main(void)
{
    return run();
}
