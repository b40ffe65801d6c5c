/* entry: run; inputs: text any, size 0..200 */
#include <stdint.h>

char text[200] = "time,x,y\n1,20,-30\n2,25,-31\n3,\"7\",4\n10,,6\n";
uint8_t size = 44;
static int32_t columns[3][12];
static uint8_t rows;

static uint8_t parse_field(const char **at, const char *end, int32_t *value)
{
    int32_t number = 0;
    int negative = 0, quoted = 0, digits = 0;
    const char *p = *at;

    if (p < end && *p == '"') {
        quoted = 1;
        p++;
    }
    if (p < end && *p == '-') {
        negative = 1;
        p++;
    }
    while (p < end && *p >= '0' && *p <= '9') {
        number = 10 * number + *p++ - '0';
        digits++;
    }
    if (quoted && p < end && *p == '"')
        p++;
    *at = p;
    *value = negative ? -number : number;
    return digits > 0;
}

static const char *skip_line(const char *p, const char *end)
{
    while (p < end && *p != '\n')
        p++;
    return p < end ? p + 1 : end;
}

int run(void)
{
    const char *p, *end = text + size;

    p = skip_line(text, end);
    while (p < end && rows < 12) {
        for (int column = 0; column < 3; column++) {
            int32_t value;
            if (parse_field(&p, end, &value))
                columns[column][rows] = value;
            if (p < end && *p == ',')
                p++;
        }
        p = skip_line(p, end);
        rows++;
    }
    int32_t sum = 0;
    for (uint8_t r = 0; r < rows; r++)
        sum += columns[1][r] - columns[2][r];
    return sum;
}

int main(void)
{
    return run();
}
