/* entry: run; inputs: pressed each 1B 0..4, presses 0..40 */
#include <stdint.h>
#include <string.h>

/* A menu on a two-line display: constant tree of items, a cursor, a stack of the way down. */
struct item {
    const char *title;
    const struct item *children, *parent;
    int16_t *value;
    int16_t low, high;
};

enum { NONE, UP, DOWN, ENTER, BACK };

uint8_t pressed[40] = {DOWN, ENTER, DOWN, ENTER, UP, UP, BACK, BACK, DOWN, ENTER, UP};
uint8_t presses = 11;
static int16_t contrast = 5, volume = 3, limit = 90;
static char display[2][17];

static const struct item root[], settings[], alarms[];
static const struct item settings[] = {
    {"Contrast", 0, root, &contrast, 0, 10}, {"Volume", 0, root, &volume, 0, 7}, {0}};
static const struct item alarms[] = {{"Limit", 0, root, &limit, 10, 120}, {0}};
static const struct item root[] = {
    {"Measure", 0, 0, 0, 0, 0}, {"Settings", settings, 0, 0, 0, 0}, {"Alarms", alarms, 0, 0, 0, 0}, {0}};

static void show(char *row, const struct item *item)
{
    size_t n = strlen(item->title);
    memset(row, ' ', 16);
    row[16] = '\0';
    memcpy(row + 1, item->title, n > 15 ? 15 : n);
    if (item->value) {
        char *p = row + 15;
        int v = *item->value;
        do {
            *p-- = (char)('0' + v % 10);
            v /= 10;
        } while (v > 0 && p > row + 8);
    }
}

int run(void)
{
    const struct item *list = root, *at = root;
    uint8_t editing = 0, changes = 0;

    for (const uint8_t *key = pressed, *end = pressed + presses; key < end; ++key) {
        switch (*key) {
        case UP:
            if (editing) {
                if (*at->value < at->high)
                    ++*at->value, changes++;
            } else if (at > list) {
                at--;
            }
            break;
        case DOWN:
            if (editing) {
                if (*at->value > at->low)
                    --*at->value, changes++;
            } else if (at[1].title) {
                at++;
            }
            break;
        case ENTER:
            if (at->children)
                at = list = at->children;
            else if (at->value)
                editing = !editing;
            break;
        case BACK:
            if (editing)
                editing = 0;
            else if (at->parent)
                at = list = at->parent;
            break;
        }
        memset(display[1], 0, sizeof display[1]);
        show(display[0], at);
        if (at[1].title)
            show(display[1], &at[1]);
    }
    return changes << 8 | display[0][1];
}

int main(void)
{
    return run();
}
