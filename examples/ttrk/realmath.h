/* The robot's own elementary functions in double precision: polynomials and counted loops, no library. */
#ifndef REALMATH_H
#define REALMATH_H

#define PI 3.14159265358979323846

/* Angle in (-pi, pi] up to rounding. Arguments beyond +-ANGLE_LIMIT and NaN give 0: no angle of the robot gets there. */
#define ANGLE_LIMIT 1.0e6
double real_wrap(double angle);

/* Within 1e-9 for |angle| <= ANGLE_LIMIT (the reduction costs digits as the angle grows); beyond it as for angle 0. */
double real_sin(double angle);
double real_cos(double angle);

/* Within 1e-10; (0, 0) gives 0. */
double real_atan2(double y, double x);

/* Within 1e-12 relative; 0 for 0, negative numbers and NaN; infinity is not a valid argument. */
double real_sqrt(double a);

double real_abs(double a);
double real_clamp(double value, double limit);

#endif
