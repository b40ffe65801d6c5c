/* entry: run; inputs: accesses each 1B 0..31, used 0..50 */
#include <stddef.h>
#include <stdint.h>

/* Least recently used pages: a doubly linked list of pointers and hash chains over the same frames. */
#define FRAMES 6
#define BUCKETS 4

struct frame {
    struct frame *newer, *older, *chain;
    uint8_t page, valid;
};

uint8_t accesses[50] = {1, 2, 3, 1, 4, 5, 6, 7, 1, 2, 8, 9, 10, 1, 31, 30};
uint8_t used = 16;
static struct frame frames[FRAMES], *newest, *oldest, *table[BUCKETS];
static uint16_t hits, misses;

static void unlink(struct frame *f)
{
    if (f->newer)
        f->newer->older = f->older;
    else
        newest = f->older;
    if (f->older)
        f->older->newer = f->newer;
    else
        oldest = f->newer;
}

static void touch(struct frame *f)
{
    f->newer = NULL;
    f->older = newest;
    if (newest)
        newest->newer = f;
    newest = f;
    if (!oldest)
        oldest = f;
}

static struct frame *lookup(uint8_t page)
{
    struct frame *f = table[page % BUCKETS];
    while (f != NULL && f->page != page)
        f = f->chain;
    return f;
}

static void access(uint8_t page)
{
    struct frame *f = lookup(page);
    if (f) {
        hits++;
        unlink(f);
    } else {
        misses++;
        f = oldest;
        unlink(f);
        if (f->valid) {
            struct frame **link = &table[f->page % BUCKETS];
            while (*link != f)
                link = &(*link)->chain;
            *link = f->chain;
        }
        f->page = page;
        f->valid = 1;
        f->chain = table[page % BUCKETS];
        table[page % BUCKETS] = f;
    }
    touch(f);
}

int run(void)
{
    newest = oldest = NULL;
    for (struct frame *f = frames + FRAMES; f-- != frames;)
        touch(f);
    for (unsigned i = 0; i < used; i++)
        access(accesses[i]);
    return hits << 8 | misses;
}

int main(void)
{
    return run();
}
