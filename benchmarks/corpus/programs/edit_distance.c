/* entry: run; inputs: left any, right any */
#include <stdint.h>
#include <string.h>

char left[16] = "controller", right[16] = "comptroller";

static uint8_t least(uint8_t a, uint8_t b, uint8_t c)
{
    uint8_t m = a < b ? a : b;
    return m < c ? m : c;
}

int run(void)
{
    uint8_t row[17];
    left[15] = right[15] = '\0';
    uint8_t n = (uint8_t)strlen(left), m = (uint8_t)strlen(right);

    for (uint8_t j = 0; j <= m; j++)
        row[j] = j;
    for (uint8_t i = 1; i <= n; i++) {
        uint8_t diagonal = row[0];
        row[0] = i;
        for (uint8_t j = 1; j <= m; j++) {
            uint8_t above = row[j];
            row[j] = least(row[j] + 1, row[j - 1] + 1, diagonal + (left[i - 1] != right[j - 1]));
            diagonal = above;
        }
    }
    return row[m];
}

int main(void)
{
    return run();
}
