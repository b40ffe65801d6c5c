/* Loops whose ends are data: pointers up to an unknown end, zeros behind strings, lists, pointers and counts that move in step. */
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

struct link {
    struct link *next;
    uint8_t value;
};

static struct link links[6] = {{&links[3], 1}, {0, 2}, {&links[1], 3}, {&links[4], 4}, {&links[2], 5}, {&links[0], 6}};

/* A list in a pool: where it begins and what is looked for are data. */
int find(void)
{
    int found = 0;
    for (int i = 0; i < 20; i++)
        for (struct link *at = &links[text[0] & 3]; at && at->value != text[i]; at = at->next)
            found++;
    return found;
}

/* A pointer and a count move in step, over and over, and what lies behind is not touched. */
int drain(void)
{
    text[23] = 0;
    for (int round = 0; round < 30; round++) {
        int16_t *to = samples + length / 2;
        for (unsigned left = length / 2; left; left--)
            *--to = (int16_t)(*to / 3);
    }
    return measure();
}

/* Records of a tag, a length and as many bytes, up to an end that is not known. */
int records(void)
{
    const uint8_t *p = text, *end = text + length;
    int found = 0;
    while (end - p >= 2) {
        uint8_t bytes = p[1];
        p += 2;
        if (bytes > end - p)
            return -1;
        p += bytes;
        found++;
    }
    return found;
}

/* Brackets open and close: two words move in turn. */
int nested(void)
{
    const uint8_t *p = text, *end = text + length;
    unsigned depth = 0, closed = 0;
    while (p != end || depth) {
        if (p != end && *p == '(' && depth < 8) {
            depth++;
            p++;
        } else if (depth) {
            depth--;
            closed++;
        } else {
            p++;
        }
    }
    return (int)closed;
}

/* Names but for the first: what only the iteration does after which nothing new comes counts as well. */
int names(void)
{
    unsigned seen = 0, found = 0;
    for (unsigned i = 0; i < 24;) {
        if (text[i] < 'a') {
            i++;
        } else if (!seen) {
            seen = 1;
            i++;
        } else {
            found++;
            do
                i++;
            while (i < 24 && text[i] >= 'a');
        }
    }
    return (int)found;
}

int main(void)
{
    return split() + measure() + reverse() + sort() + find() + drain() + records() + nested() + names();
}
