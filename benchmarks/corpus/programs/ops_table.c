/* entry: run; inputs: kinds each 1B 0..2, sizes each 1B 0..10 */
#include <stdint.h>
struct ops { int (*area)(int); int (*edge)(int); const char *name; };
static int square(int n) { return n * n; }
static int square_edge(int n) { return 4 * n; }
static int tri(int n) { int s = 0; for (int i = 1; i <= n; i++) s += i; return s; }
static int tri_edge(int n) { return 3 * n; }
static int dot(int n) { return n > 0; }
static const struct ops table[3] = {{square, square_edge, "sq"}, {tri, tri_edge, "tri"}, {dot, dot, "dot"}};
uint8_t kinds[12] = {0, 1, 2, 1, 0}, sizes[12] = {3, 4, 5, 10, 2};
int run(void)
{
    int total = 0;
    for (int i = 0; i < 12; i++) {
        const struct ops *o = &table[kinds[i]];
        total += o->area(sizes[i]) + o->edge(sizes[i]);
        for (const char *p = o->name; *p; p++) total += *p & 1;
    }
    return total;
}
int main(void) { return run(); }
