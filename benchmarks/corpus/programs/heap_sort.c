/* entry: run; inputs: heap any, length 0..32 */
#include <stdint.h>

int16_t heap[32] = {3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9};
int length = 15;

static void sift(int root, int end)
{
    int16_t v = heap[root];
    for (;;) {
        int child = 2 * root + 1;
        if (child >= end)
            break;
        if (child + 1 < end && heap[child + 1] > heap[child])
            child++;
        if (heap[child] <= v)
            break;
        heap[root] = heap[child];
        root = child;
    }
    heap[root] = v;
}

int run(void)
{
    for (int i = length / 2 - 1; i >= 0; i--)
        sift(i, length);
    for (int end = length - 1; end > 0; end--) {
        int16_t t = heap[0];
        heap[0] = heap[end];
        heap[end] = t;
        sift(0, end);
    }
    return heap[0];
}

int main(void)
{
    return run();
}
