/* entry: run; inputs: x any */
#include <stdint.h>

/* Temperature of a thermocouple by a polynomial, then Newton's inverse of it with a fixed number of steps. */
double x = 12.5;
static const double c[] = {0.0, 25.083, 0.0786, -0.2503, 0.0831, -0.0122};

static double horner(const double *poly, int degree, double at)
{
    double y = poly[degree];
    while (degree-- > 0)
        y = y * at + poly[degree];
    return y;
}

int run(void)
{
    double derivative[5], wanted = x, at = 1.0;

    for (int i = 1; i <= 5; i++)
        derivative[i - 1] = i * c[i];
    for (int step = 0; step < 6; step++) {
        double slope = horner(derivative, 4, at);
        if (slope == 0.0)
            break;
        at -= (horner(c, 5, at) - wanted) / slope;
    }
    return at > 0.4;
}

int main(void)
{
    return run();
}
