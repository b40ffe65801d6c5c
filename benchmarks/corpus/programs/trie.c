/* entry: run; inputs: input any */
#include <stdint.h>

/* Commands in a trie that is built at start from a constant list; the longest match splits the input into tokens. */
#define NODES 48

struct node {
    char letter;
    uint8_t child, sibling, value;
};

char input[48] = "ledon setpwm7 getadc ledoff resetx";
static struct node nodes[NODES];
static uint8_t used;
static const char *const words[] = {"ledon", "ledoff", "set", "get", "reset", "pwm", "adc", 0};

static uint8_t find(uint8_t parent, char c)
{
    uint8_t n = nodes[parent].child;
    while (n && nodes[n].letter != c)
        n = nodes[n].sibling;
    return n;
}

static void add(const char *word, uint8_t value)
{
    uint8_t at = 0;
    for (; *word; word++) {
        uint8_t next = find(at, *word);
        if (!next) {
            if (used == NODES)
                return;
            next = used++;
            nodes[next] = (struct node){*word, 0, nodes[at].child, 0};
            nodes[at].child = next;
        }
        at = next;
    }
    nodes[at].value = value;
}

static const char *longest(const char *s, uint8_t *value)
{
    const char *end = s;
    uint8_t at = 0;
    *value = 0;
    while (*s && (at = find(at, *s)) != 0) {
        s++;
        if (nodes[at].value) {
            *value = nodes[at].value;
            end = s;
        }
    }
    return end;
}

int run(void)
{
    int hash = 0;
    input[sizeof input - 1] = '\0';
    used = 1;
    for (unsigned i = 0; words[i]; i++)
        add(words[i], (uint8_t)(i + 1));
    for (const char *p = input; *p;) {
        uint8_t value;
        const char *next = longest(p, &value);
        if (value) {
            hash = hash * 31 + value;
            p = next;
        } else {
            p++;
        }
    }
    return hash;
}

int main(void)
{
    return run();
}
