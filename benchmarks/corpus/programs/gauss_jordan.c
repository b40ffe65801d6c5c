/* entry: run; inputs: entries each 2B -100..100, order 1..5 */
#include <math.h>
#include <stdint.h>

/* The inverse of a matrix in double precision with a full search for the pivot; rows and columns are swapped back. */
#define MOST 5

int16_t entries[MOST * MOST] = {4, 7, 2, 3, 6, 1, 2, 5, 3, 9, 8, 1, 0, 5, 2, 4};
uint8_t order = 4;
static double a[MOST][MOST];

static int invert(int n)
{
    int row_of[MOST], column_of[MOST], used[MOST] = {0};

    for (int step = 0; step < n; step++) {
        double big = 0.0;
        int row = 0, column = 0;
        for (int i = 0; i < n; i++) {
            if (used[i])
                continue;
            for (int k = 0; k < n; k++)
                if (!used[k] && fabs(a[i][k]) > big) {
                    big = fabs(a[i][k]);
                    row = i;
                    column = k;
                }
        }
        if (big < 1e-9)
            return -1;
        used[column] = 1;
        if (row != column)
            for (int k = 0; k < n; k++) {
                double t = a[row][k];
                a[row][k] = a[column][k];
                a[column][k] = t;
            }
        row_of[step] = row;
        column_of[step] = column;
        double pivot = 1.0 / a[column][column];
        a[column][column] = 1.0;
        for (int k = 0; k < n; k++)
            a[column][k] *= pivot;
        for (int i = 0; i < n; i++) {
            if (i == column)
                continue;
            double factor = a[i][column];
            a[i][column] = 0.0;
            for (int k = 0; k < n; k++)
                a[i][k] -= a[column][k] * factor;
        }
    }
    for (int step = n; step-- > 0;)
        if (row_of[step] != column_of[step])
            for (int k = 0; k < n; k++) {
                double t = a[k][row_of[step]];
                a[k][row_of[step]] = a[k][column_of[step]];
                a[k][column_of[step]] = t;
            }
    return 0;
}

int run(void)
{
    const int16_t *p = entries;
    for (int i = 0; i < order; i++)
        for (int k = 0; k < order; k++)
            a[i][k] = *p++;
    return invert(order) < 0 ? -1 : (int)(1000 * a[0][0]);
}

int main(void)
{
    return run();
}
