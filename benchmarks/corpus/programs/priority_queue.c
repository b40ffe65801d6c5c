/* entry: run; inputs: jobs any, amount 0..16 */
#include <stdint.h>

struct job {
    uint16_t due;
    uint8_t id, priority;
};
struct job jobs[16] = {{10, 1, 3}, {5, 2, 9}, {7, 3, 9}, {1, 4, 0}, {90, 5, 4}};
uint8_t amount = 5;
static struct job heap[17];
static uint8_t used;

static int earlier(const struct job *a, const struct job *b)
{
    return a->priority != b->priority ? a->priority > b->priority : a->due < b->due;
}

static void insert(struct job job)
{
    uint8_t at = ++used;
    while (at > 1 && earlier(&job, &heap[at / 2])) {
        heap[at] = heap[at / 2];
        at /= 2;
    }
    heap[at] = job;
}

static struct job take(void)
{
    struct job first = heap[1], last = heap[used--];
    uint8_t at = 1, child;
    while ((child = at * 2) <= used) {
        if (child < used && earlier(&heap[child + 1], &heap[child]))
            child++;
        if (!earlier(&heap[child], &last))
            break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = last;
    return first;
}

int run(void)
{
    uint32_t order = 0;
    for (uint8_t i = 0; i < amount; i++)
        insert(jobs[i]);
    while (used)
        order = order * 31 + take().id;
    return (int)order;
}

int main(void)
{
    return run();
}
