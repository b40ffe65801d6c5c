/* entry: run; inputs: text any */
#include <stdint.h>

/* Counts words, numbers and comments of a text: classes of characters, a table of transitions, actions by pointer. */
enum { LETTER, DIGIT, SPACE, SLASH, STAR, OTHER, CLASSES };
enum { IDLE, WORD, NUMBER, MAYBE, COMMENT, ENDING, STATES };

char text[90] = "x1 = 42 / y; /* 7 wonders */ z = 0x1F;";
static uint16_t words, numbers, comments;

static void nothing(void) {}
static void word(void) { words++; }
static void number(void) { numbers++; }
static void comment(void) { comments++; }

struct cell {
    uint8_t next;
    void (*action)(void);
};

static const struct cell cells[STATES][CLASSES] = {
    [IDLE] = {{WORD, word}, {NUMBER, number}, {IDLE, nothing}, {MAYBE, nothing}, {IDLE, nothing}, {IDLE, nothing}},
    [WORD] = {{WORD, nothing}, {WORD, nothing}, {IDLE, nothing}, {MAYBE, nothing}, {IDLE, nothing}, {IDLE, nothing}},
    [NUMBER] = {{NUMBER, nothing}, {NUMBER, nothing}, {IDLE, nothing}, {MAYBE, nothing}, {IDLE, nothing},
                {IDLE, nothing}},
    [MAYBE] = {{WORD, word}, {NUMBER, number}, {IDLE, nothing}, {MAYBE, nothing}, {COMMENT, comment}, {IDLE, nothing}},
    [COMMENT] = {{COMMENT, nothing}, {COMMENT, nothing}, {COMMENT, nothing}, {COMMENT, nothing}, {ENDING, nothing},
                 {COMMENT, nothing}},
    [ENDING] = {{COMMENT, nothing}, {COMMENT, nothing}, {COMMENT, nothing}, {IDLE, nothing}, {ENDING, nothing},
                {COMMENT, nothing}},
};

static uint8_t class_of(char c)
{
    if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'))
        return LETTER;
    if (c >= '0' && c <= '9')
        return DIGIT;
    switch (c) {
    case ' ':
    case '\n':
    case '\t':
        return SPACE;
    case '/':
        return SLASH;
    case '*':
        return STAR;
    default:
        return OTHER;
    }
}

int run(void)
{
    uint8_t state = IDLE;
    for (const char *p = text; p < text + sizeof text && *p; p++) {
        const struct cell *cell = &cells[state][class_of(*p)];
        cell->action();
        state = cell->next;
    }
    return words << 16 | numbers << 8 | comments;
}

int main(void)
{
    return run();
}
