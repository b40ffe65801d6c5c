/* entry: run; inputs: values any, choice 0..3 */
#include <stdint.h>
#include <stdlib.h>

typedef int32_t (*fold)(int32_t, int32_t);

int32_t values[20] = {5, -7, 12, 900, 3};
uint8_t choice = 2;

static int32_t sum(int32_t a, int32_t b) { return (int32_t)((uint32_t)a + (uint32_t)b); }
static int32_t greatest(int32_t a, int32_t b) { return a > b ? a : b; }
static int32_t mixed(int32_t a, int32_t b) { return a ^ (int32_t)((uint32_t)b << 3); }
static int32_t digits(int32_t a, int32_t b)
{
    while (b != 0) {
        a++;
        b /= 10;
    }
    return a;
}

static const fold folds[] = {sum, greatest, mixed, digits};

static int32_t reduce(const int32_t *from, int n, fold f)
{
    int32_t result = 0;
    for (int i = 0; i < n; i++)
        result = f(result, from[i]);
    return result;
}

static int compare(const void *a, const void *b)
{
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

int run(void)
{
    int32_t key = 12, first = reduce(values, 20, folds[choice]);
    int32_t second = reduce(values, 10, digits);
    int32_t *found;

    for (int i = 1; i < 20; i++)
        for (int j = i; j > 0 && compare(&values[j], &values[j - 1]) < 0; j--) {
            int32_t t = values[j];
            values[j] = values[j - 1];
            values[j - 1] = t;
        }
    found = bsearch(&key, values, 20, sizeof values[0], compare);
    return first ^ second ^ (found ? (int)(found - values) : -1);
}

int main(void)
{
    return run();
}
