/* entry: run; inputs: events each 1B 0..5, pending 0..30 */
#include <stdint.h>

/* A hierarchical machine: a state is a function that handles an event or passes it to its parent; events in a queue. */
enum { ENTRY = 10, EXIT, TICK = 0, START, STOP, FAULT, CLEAR, DOOR };

struct object;
typedef void (*state)(void);
typedef const struct description *(*handler)(struct object *, uint8_t);
struct description {
    handler handle;
    const struct description *parent;
};
struct object {
    const struct description *now;
    uint8_t heat, faults, entries;
};

uint8_t events[30] = {1, 0, 0, 0, 5, 0, 3, 0, 4, 1, 2};
uint8_t pending = 11;

static const struct description top, idle, active, heating, cooling, failed;

static const struct description *on_top(struct object *o, uint8_t e)
{
    if (e == FAULT) {
        o->faults++;
        return &failed;
    }
    return 0;
}
static const struct description *on_idle(struct object *o, uint8_t e)
{
    if (e == ENTRY)
        o->entries++;
    return e == START ? &heating : 0;
}
static const struct description *on_active(struct object *o, uint8_t e)
{
    if (e == EXIT)
        o->heat = 0;
    return e == STOP || e == DOOR ? &idle : 0;
}
static const struct description *on_heating(struct object *o, uint8_t e)
{
    if (e == TICK && ++o->heat >= 3)
        return &cooling;
    return 0;
}
static const struct description *on_cooling(struct object *o, uint8_t e)
{
    if (e == TICK && o->heat && --o->heat == 0)
        return &heating;
    return 0;
}
static const struct description *on_failed(struct object *o, uint8_t e)
{
    return e == CLEAR && o->faults < 3 ? &idle : 0;
}

static const struct description top = {on_top, 0}, idle = {on_idle, &top}, active = {on_active, &top},
                                heating = {on_heating, &active}, cooling = {on_cooling, &active},
                                failed = {on_failed, 0};

static int within(const struct description *s, const struct description *outer)
{
    while (s && s != outer)
        s = s->parent;
    return s != 0;
}

static void dispatch(struct object *o, uint8_t event)
{
    const struct description *next = 0, *s = o->now;

    for (; s != 0 && next == 0; s = s->parent)
        next = s->handle(o, event);
    if (!next || next == o->now)
        return;
    for (s = o->now; s && !within(next, s); s = s->parent)
        s->handle(o, EXIT);
    o->now = next;
    next->handle(o, ENTRY);
}

int run(void)
{
    static struct object oven;
    static uint8_t queue[8], head, tail;
    uint8_t given = 0;

    oven.now = &idle;
    do {
        while (given < pending && (uint8_t)(head - tail) < 8)
            queue[head++ & 7] = events[given++];
        while (head != tail)
            dispatch(&oven, queue[tail++ & 7]);
    } while (given < pending);
    return oven.faults << 8 | oven.entries;
}

int main(void)
{
    return run();
}
