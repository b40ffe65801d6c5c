/* entry: run; inputs: samples any, count 1..31, rank 0..30 */
#include <stdint.h>

/* The k-th smallest sample by Hoare's selection, and the median of medians of five for comparison. */
uint16_t samples[31] = {40, 12, 77, 3, 99, 41, 12, 5, 63, 70, 22, 8, 31, 90, 1};
uint8_t count = 15, rank = 7;
static uint16_t work[31];

static void swap(uint16_t *a, uint16_t *b)
{
    uint16_t t = *a;
    *a = *b;
    *b = t;
}

static uint16_t select(uint16_t *a, int n, int k)
{
    int left = 0, right = n - 1;

    while (left < right) {
        uint16_t pivot = a[k];
        int i = left, j = right;
        do {
            while (a[i] < pivot)
                i++;
            while (pivot < a[j])
                j--;
            if (i <= j)
                swap(&a[i++], &a[j--]);
        } while (i <= j);
        if (j < k)
            left = i;
        if (k < i)
            right = j;
    }
    return a[k];
}

static uint16_t middle(uint16_t *a, int n)
{
    for (int i = 1; i < n; i++)
        for (int k = i; k > 0 && a[k] < a[k - 1]; k--)
            swap(&a[k], &a[k - 1]);
    return a[n / 2];
}

int run(void)
{
    int n = count, k = rank < count ? rank : count - 1, groups = 0;

    for (int i = 0; i < n; i++)
        work[i] = samples[i];
    uint16_t found = select(work, n, k);
    for (int i = 0; i < n; i += 5)
        work[groups++] = middle(&samples[i], n - i < 5 ? n - i : 5);
    return found << 16 | middle(work, groups);
}

int main(void)
{
    return run();
}
