/* entry: run; inputs: points any */
#include <stdint.h>

#define N 14
struct point {
    int16_t x, y;
};
struct point points[N] = {{0, 0}, {5, 1}, {3, 9}, {-4, 2}, {7, 7}, {1, 1}, {2, 5}, {-1, -6}, {8, -2}};
static struct point hull[2 * N];

static int64_t cross(struct point o, struct point a, struct point b)
{
    return (int64_t)(a.x - o.x) * (b.y - o.y) - (int64_t)(a.y - o.y) * (b.x - o.x);
}

static int before(struct point a, struct point b)
{
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

int run(void)
{
    int k = 0;

    for (int i = 1; i < N; i++) {
        struct point p = points[i];
        int j = i;
        while (j > 0 && before(p, points[j - 1])) {
            points[j] = points[j - 1];
            j--;
        }
        points[j] = p;
    }
    for (int i = 0; i < N; i++) {
        while (k >= 2 && cross(hull[k - 2], hull[k - 1], points[i]) <= 0)
            k--;
        hull[k++] = points[i];
    }
    for (int i = N - 2, t = k + 1; i >= 0; i--) {
        while (k >= t && cross(hull[k - 2], hull[k - 1], points[i]) <= 0)
            k--;
        hull[k++] = points[i];
    }
    return k - 1;
}

int main(void)
{
    return run();
}
