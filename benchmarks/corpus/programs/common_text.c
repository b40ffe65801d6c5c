/* entry: run; inputs: left any, right any */
#include <stdint.h>
#include <string.h>

/* Longest common subsequence of two strings, with the way back through the table. */
#define MOST 24

char left[MOST] = "gattacagtcct", right[MOST] = "tacgcatgact";
static uint8_t table[MOST + 1][MOST + 1];
static char common[MOST + 1];

int run(void)
{
    left[MOST - 1] = right[MOST - 1] = 0;
    const int n = (int)strlen(left), m = (int)strlen(right);

    for (int i = 1; i <= n; i++)
        for (int k = 1; k <= m; k++) {
            if (left[i - 1] == right[k - 1])
                table[i][k] = table[i - 1][k - 1] + 1;
            else
                table[i][k] = table[i - 1][k] > table[i][k - 1] ? table[i - 1][k] : table[i][k - 1];
        }
    int i = n, k = m, length = table[n][m];
    char *out = common + length;
    *out = '\0';
    while (i > 0 && k > 0) {
        if (left[i - 1] == right[k - 1]) {
            *--out = left[i - 1];
            i--, k--;
        } else if (table[i - 1][k] >= table[i][k - 1]) {
            i--;
        } else {
            k--;
        }
    }
    return length;
}

int main(void)
{
    return run();
}
