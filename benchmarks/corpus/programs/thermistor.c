/* entry: run; inputs: raw each 2B 1..4094, used 1..8 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* Temperatures by the equation with logarithms in double precision, the median by qsort, a table for the display. */
uint16_t raw[8] = {2048, 2000, 1900, 2100, 2050, 2049, 100, 4000};
uint8_t used = 8;
static double kelvin[8];

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double convert(uint16_t counts)
{
    double resistance = 10000.0 * counts / (4095.0 - counts);
    double l = log(resistance);
    return 1.0 / (1.129148e-3 + 2.34125e-4 * l + 8.76741e-8 * pow(l, 3));
}

int run(void)
{
    for (int i = 0; i < used; i++)
        kelvin[i] = convert(raw[i]);
    qsort(kelvin, used, sizeof kelvin[0], by_value);
    return (int)floor(10 * (kelvin[used / 2] - 273.15));
}

int main(void)
{
    return run();
}
