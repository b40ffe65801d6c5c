#include "realmath.h"

#include <stdint.h>

/* Taylor coefficients in z = angle * angle: sin(a) = a * S(z), cos(a) = C(z); |a| <= pi/4 leaves less than 1e-13. */
static const double sine[] = {
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5040.0,
    1.0 / 362880.0,
    -1.0 / 39916800.0,
    1.0 / 6227020800.0,
};
static const double cosine[] = {
    1.0,
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40320.0,
    -1.0 / 3628800.0,
    1.0 / 479001600.0,
    -1.0 / 87178291200.0,
};
/* atan(t) = t * A(t * t), |t| <= tan(pi/8): the first term left out is below 1e-11. */
static const double arctangent[] = {
    1.0,        -1.0 / 3.0,  1.0 / 5.0,   -1.0 / 7.0,  1.0 / 9.0,   -1.0 / 11.0,
    1.0 / 13.0, -1.0 / 15.0, 1.0 / 17.0,  -1.0 / 19.0, 1.0 / 21.0,  -1.0 / 23.0,
};

enum { SINE_TERMS = 7, COSINE_TERMS = 8, ARCTANGENT_TERMS = 12, ROOT_STEPS = 4 };

static double polynomial(const double *coefficient, int terms, double z)
{
    double value = coefficient[terms - 1];
    for (int i = terms - 2; i >= 0; i--)
        value = value * z + coefficient[i];
    return value;
}

double real_abs(double a)
{
    return a < 0.0 ? -a : a;
}

double real_clamp(double value, double limit)
{
    if (value > limit)
        return limit;
    if (value < -limit)
        return -limit;
    return value;
}

/* The integer nearest to a / unit; 0 where the angle is out of range, so that the conversion is always defined. */
static int32_t nearest_multiple(double angle, double inverse_unit)
{
    double turns = angle * inverse_unit;
    return (int32_t)(turns < 0.0 ? turns - 0.5 : turns + 0.5);
}

static double in_range(double angle)
{
    return angle >= -ANGLE_LIMIT && angle <= ANGLE_LIMIT ? angle : 0.0;
}

double real_wrap(double angle)
{
    angle = in_range(angle);
    return angle - 2.0 * PI * nearest_multiple(angle, 0.5 / PI);
}

/* sin(angle + quarter * pi/2): one reduction to |rest| <= pi/4, then the polynomial of the quadrant. */
static double sine_of_quadrant(double angle, int32_t quarter)
{
    /* pi/2 in two parts: the first has 33 bits, so that its product with a count below 2^20 is exact. */
    static const double half_pi_high = 1.57079632673412561417e+00, half_pi_low = 6.07710050650619224932e-11;
    angle = in_range(angle);
    int32_t count = nearest_multiple(angle, 2.0 / PI);
    double rest = (angle - count * half_pi_high) - count * half_pi_low;
    double z = rest * rest;
    quarter += count;
    double value = quarter & 1 ? polynomial(cosine, COSINE_TERMS, z) : rest * polynomial(sine, SINE_TERMS, z);
    return quarter & 2 ? -value : value;
}

double real_sin(double angle)
{
    return sine_of_quadrant(angle, 0);
}

double real_cos(double angle)
{
    return sine_of_quadrant(angle, 1);
}

double real_atan2(double y, double x)
{
    static const double tangent_eighth = 0.41421356237309504880;
    double ay = real_abs(y), ax = real_abs(x);
    double big = ay > ax ? ay : ax, little = ay > ax ? ax : ay;
    if (!(big > 0.0))
        return 0.0;
    double t = little / big, angle = 0.0;
    if (t > tangent_eighth) {
        angle = 0.25 * PI;
        t = (t - 1.0) / (t + 1.0);
    }
    angle += t * polynomial(arctangent, ARCTANGENT_TERMS, t * t);
    if (ay > ax)
        angle = 0.5 * PI - angle;
    if (x < 0.0)
        angle = PI - angle;
    return y < 0.0 ? -angle : angle;
}

double real_sqrt(double a)
{
    union {
        double real;
        uint64_t bits;
    } guess;
    if (!(a > 0.0))
        return 0.0;
    /* Half the exponent and half the fraction: within 4 %; each step of Newton squares the error. */
    guess.real = a;
    guess.bits = (guess.bits >> 1) + ((uint64_t)0x1ff7a400u << 32);
    for (int step = 0; step < ROOT_STEPS; step++)
        guess.real = 0.5 * (guess.real + a / guess.real);
    return guess.real;
}
