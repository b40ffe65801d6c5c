/* entry: run; inputs: costs any, places 1..6 */
#include <stdint.h>
#include <string.h>

/* The shortest round trip over a few places: permutations by Heap's method without recursion, and next-in-order. */
#define MOST 6

uint8_t costs[MOST][MOST] = {{0, 3, 9, 4, 7, 2}, {3, 0, 5, 5, 1, 8}, {9, 5, 0, 2, 6, 6}, {4, 5, 2, 0, 9, 3}};
uint8_t places = 4;

static uint16_t trip(const uint8_t *way, int n)
{
    uint16_t sum = costs[way[n - 1]][way[0]];
    for (const uint8_t *p = way; p + 1 < way + n; p++)
        sum += costs[p[0]][p[1]];
    return sum;
}

static int advance(uint8_t *a, int n)
{
    int i = n - 2, k = n - 1;
    while (i >= 0 && a[i] >= a[i + 1])
        i--;
    if (i < 0)
        return 0;
    while (a[k] <= a[i])
        k--;
    uint8_t t = a[i];
    a[i] = a[k];
    a[k] = t;
    for (int low = i + 1, high = n - 1; low < high; low++, high--) {
        t = a[low];
        a[low] = a[high];
        a[high] = t;
    }
    return 1;
}

int run(void)
{
    uint8_t way[MOST] = {0}, counter[MOST], n = places, i = 1;
    uint16_t best, visited = 1;

    for (uint8_t k = 0; k < n; k++)
        way[k] = k;
    memset(counter, 0, sizeof counter);
    best = trip(way, n);
    while (i < n) {
        if (counter[i] < i) {
            uint8_t other = i & 1 ? counter[i] : 0, t = way[i];
            way[i] = way[other];
            way[other] = t;
            uint16_t sum = trip(way, n);
            if (sum < best)
                best = sum;
            visited++;
            counter[i]++;
            i = 1;
        } else {
            counter[i++] = 0;
        }
    }
    for (uint8_t k = 0; k < 4; k++)
        way[k] = k;
    while (advance(way, 4))
        visited++;
    return best << 16 | visited;
}

int main(void)
{
    return run();
}
