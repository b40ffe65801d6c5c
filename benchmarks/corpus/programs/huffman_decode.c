/* entry: run; inputs: code any, bits 0..256 */
#include <stdint.h>

struct node {
    int8_t child[2];
    char letter;
};

uint8_t code[32] = {0x5A, 0xC3, 0x99, 0x01, 0xFE, 0x77};
uint16_t bits = 120;
static const struct node tree[] = {{{1, 2}, 0}, {{3, 4}, 0}, {{5, 6}, 0}, {{-1, -1}, 'e'}, {{7, 8}, 0},
                                   {{-1, -1}, 't'}, {{9, 10}, 0}, {{-1, -1}, 'a'}, {{-1, -1}, 'o'},
                                   {{-1, -1}, 'n'}, {{11, 12}, 0}, {{-1, -1}, 'z'}, {{-1, -1}, 'q'}};
static char plain[256];

int run(void)
{
    uint16_t at = 0, letters = 0;
    while (at < bits) {
        const struct node *n = tree;
        while (n->child[0] >= 0 && at < bits) {
            unsigned bit = code[at >> 3] >> (7 - (at & 7)) & 1;
            n = &tree[n->child[bit]];
            at++;
        }
        if (n->child[0] >= 0)
            break;
        plain[letters++] = n->letter;
    }
    return letters;
}

int main(void)
{
    return run();
}
