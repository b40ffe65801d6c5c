/* entry: run; inputs: keys any, pressed 0..60 */
#include <stdint.h>
#include <string.h>

/* A line editor: the text on both sides of a gap that moves with the cursor; words are skipped and erased. */
#define ROOM 40

char keys[60] = "hello wrld\x02\x02\x02o\x05 again\x17";
uint8_t pressed = 24;
static char buffer[ROOM];
static uint8_t gap, rest = ROOM;

static void left(void)
{
    if (gap)
        buffer[--rest] = buffer[--gap];
}

static void right(void)
{
    if (rest < ROOM)
        buffer[gap++] = buffer[rest++];
}

static void home(void)
{
    rest -= gap;
    memmove(buffer + rest, buffer, gap);
    gap = 0;
}

static void end(void)
{
    while (rest != ROOM)
        right();
}

static void erase_word(void)
{
    while (gap && buffer[gap - 1] == ' ')
        gap--;
    while (gap && buffer[gap - 1] != ' ')
        gap--;
}

static void key(char c)
{
    switch (c) {
    case 1:
        home();
        break;
    case 2:
        left();
        break;
    case 4:
        if (rest < ROOM)
            rest++;
        break;
    case 5:
        end();
        break;
    case 6:
        right();
        break;
    case 8:
        if (gap)
            gap--;
        break;
    case 11:
        rest = ROOM;
        break;
    case 23:
        erase_word();
        break;
    default:
        if (c >= ' ' && gap < rest)
            buffer[gap++] = c;
    }
}

int run(void)
{
    for (uint8_t i = 0; i < pressed; ++i)
        key(keys[i]);
    home();
    uint32_t hash = 0;
    for (const char *p = buffer + rest; p < buffer + ROOM; p++)
        hash = hash * 33 ^ (uint8_t)*p;
    return (int)hash;
}

int main(void)
{
    return run();
}
