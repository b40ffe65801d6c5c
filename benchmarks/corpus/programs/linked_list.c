/* entry: run; inputs: keys each 1B 0..99, count 0..20 */
#include <stdint.h>

#define NONE 0xFF
struct node {
    uint8_t key, next;
};

uint8_t keys[20] = {5, 3, 9, 5, 1, 7, 7, 80, 20};
uint8_t count = 9;
static struct node nodes[20];
static uint8_t head, free_list;

static void clear(void)
{
    for (uint8_t i = 0; i < 20; i++)
        nodes[i].next = i + 1 < 20 ? i + 1 : NONE;
    free_list = 0;
    head = NONE;
}

static int insert(uint8_t key)
{
    uint8_t *link = &head, fresh = free_list;

    if (fresh == NONE)
        return -1;
    while (*link != NONE && nodes[*link].key < key)
        link = &nodes[*link].next;
    if (*link != NONE && nodes[*link].key == key)
        return 0;
    free_list = nodes[fresh].next;
    nodes[fresh].key = key;
    nodes[fresh].next = *link;
    *link = fresh;
    return 1;
}

static void reverse(void)
{
    uint8_t before = NONE, at = head;
    while (at != NONE) {
        uint8_t next = nodes[at].next;
        nodes[at].next = before;
        before = at;
        at = next;
    }
    head = before;
}

int run(void)
{
    int length = 0;
    clear();
    for (uint8_t i = 0; i < count; i++)
        insert(keys[i]);
    reverse();
    for (uint8_t at = head; at != NONE; at = nodes[at].next)
        length++;
    return length;
}

int main(void)
{
    return run();
}
