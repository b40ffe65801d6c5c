/* entry: run; inputs: delays each 1B 1..60, started 0..12, ticks 0..80 */
#include <stddef.h>
#include <stdint.h>

/* Software timers on a wheel of 16 slots; every slot is a singly linked list of nodes out of a pool. */
#define SLOTS 16

struct timer {
    struct timer *next;
    uint8_t rounds, period;
    void (*expire)(struct timer *);
};

uint8_t delays[12] = {3, 5, 17, 33, 60, 1, 8, 8};
uint8_t started = 8, ticks = 64;
static struct timer pool[12];
static struct timer *wheel[SLOTS];
static uint8_t now;
static uint16_t expired, stopped;

static void insert(struct timer *t, uint8_t delay)
{
    uint8_t slot = (now + delay) & (SLOTS - 1);
    t->rounds = (uint8_t)((delay - 1) / SLOTS);
    t->next = wheel[slot];
    wheel[slot] = t;
}

static void once(struct timer *t)
{
    (void)t;
    stopped++;
}

static void again(struct timer *t)
{
    insert(t, t->period);
}

static void tick(void)
{
    now++;
    struct timer **link = &wheel[now & (SLOTS - 1)], *due = NULL;

    while (*link != NULL) {
        struct timer *t = *link;
        if (t->rounds == 0) {
            *link = t->next;
            t->next = due;
            due = t;
        } else {
            t->rounds--;
            link = &t->next;
        }
    }
    while (due) {
        struct timer *t = due;
        due = t->next;
        expired++;
        t->expire(t);
    }
}

int run(void)
{
    for (uint8_t i = 0; i < started; i++) {
        pool[i].period = delays[i];
        pool[i].expire = i & 1 ? again : once;
        insert(&pool[i], delays[i]);
    }
    for (uint8_t left = ticks; left; left--)
        tick();
    return expired << 8 | stopped;
}

int main(void)
{
    return run();
}
