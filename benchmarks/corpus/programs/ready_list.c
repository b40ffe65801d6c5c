/* entry: run; inputs: script each 1B 0..7, actions 0..40 */
#include <stdint.h>

/* The heart of a small kernel: ready lists per priority as rings with a sentinel, a bit map of the lists in use. */
typedef struct node {
    struct node *next, *previous;
} node_t;

typedef struct {
    node_t link;
    uint8_t priority, state;
    uint16_t switches;
} tcb_t;

enum { READY, RUNNING, BLOCKED };

uint8_t script[40] = {0, 0, 3, 1, 0, 2, 7, 4, 0, 0, 5, 1};
uint8_t actions = 12;

static tcb_t tasks[6] = {{.priority = 1}, {.priority = 1}, {.priority = 3},
                         {.priority = 3}, {.priority = 3}, {.priority = 0}};
static node_t ready[4];
static uint32_t map;
static tcb_t *current;

static void append(tcb_t *t)
{
    node_t *list = &ready[t->priority];
    t->link.previous = list->previous;
    t->link.next = list;
    list->previous->next = &t->link;
    list->previous = &t->link;
    map |= 1u << t->priority;
    t->state = READY;
}

static void take(tcb_t *t)
{
    t->link.previous->next = t->link.next;
    t->link.next->previous = t->link.previous;
    if (ready[t->priority].next == &ready[t->priority])
        map &= ~(1u << t->priority);
}

static void schedule(void)
{
    if (current && current->state == RUNNING)
        append(current);
    unsigned top = 31;
    while (top && !(map & 1u << top))
        top--;
    if (!(map & 1u << top))
        return;
    tcb_t *t = (tcb_t *)ready[top].next;
    take(t);
    t->state = RUNNING;
    t->switches++;
    current = t;
}

static int waiting(void)
{
    int n = 0;
    for (int i = 0; i < 4; i++)
        for (node_t *at = ready[i].next; at != &ready[i]; at = at->next)
            n++;
    return n;
}

int run(void)
{
    int waited = 0;

    for (int i = 0; i < 4; i++)
        ready[i].next = ready[i].previous = &ready[i];
    for (tcb_t *t = tasks; t < tasks + 6; t++)
        append(t);
    for (uint8_t i = 0; i < actions; i++) {
        uint8_t what = script[i];
        if (what == 0) {
            schedule();
        } else if (what == 7) {
            if (current && current != &tasks[5])
                current->state = BLOCKED;
            schedule();
        } else {
            tcb_t *t = &tasks[what - 1];
            if (t->state == BLOCKED)
                append(t);
            else if (t->state == READY && t->priority)
                take(t), t->state = BLOCKED;
        }
        waited += waiting();
    }
    return waited;
}

int main(void)
{
    return run();
}
