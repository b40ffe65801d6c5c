/* Loops whose ends are data: pointers up to an unknown end, zeros behind strings, states that move a counter in turn. */
#include <stdint.h>

uint8_t text[24] = "move 10 left; stop";
uint8_t length = 18, words[24];
int16_t samples[20];
uint32_t number = 123456;

/* Fields of text[0 .. length) between commas: two loops move one pointer to an end that is not known. */
int split(void)
{
    const uint8_t *p = text, *end = text + length;
    int found = 0;
    while (p != end) {
        const uint8_t *start = p++;
        while (p != end && *p != ',')
            p++;
        words[found++] = (uint8_t)(p - start);
    }
    return found;
}

/* Up to the zero that is stored behind a string. */
int measure(void)
{
    text[23] = 0;
    const uint8_t *p = text;
    while (*p)
        p++;
    return (int)(p - text);
}

/* Digits go to a buffer in the stack and come back in the other order. */
int reverse(void)
{
    uint8_t digits[12], *p = digits;
    uint32_t rest = number;
    int sum = 0;
    do {
        *p++ = (uint8_t)(rest % 10);
        rest /= 10;
    } while (rest);
    while (p != digits)
        sum = sum * 10 + *--p;
    return sum;
}

/* A shell sort: gaps, and elements that move by them. */
int sort(void)
{
    for (int gap = 10; gap > 0; gap /= 2)
        for (int i = gap; i < 20; i++)
            for (int j = i; j >= gap && samples[j - gap] > samples[j]; j -= gap) {
                int16_t kept = samples[j];
                samples[j] = samples[j - gap];
                samples[j - gap] = kept;
            }
    return samples[0];
}

int main(void)
{
    return split() + measure() + reverse() + sort();
}
