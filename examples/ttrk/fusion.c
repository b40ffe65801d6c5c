/* StateFusion: an extended Kalman filter over (x, y, heading, speed), in double precision.
 *
 * Prediction: the unit's yaw increments turn the heading, the speed carries the robot along it. Correction: the last yaw
 * of the inertial unit, and the position whenever a fix with a new stamp is there; each measured component on its own,
 * so that no matrix is inverted.
 */
#include "realmath.h"
#include "ttrk.h"

enum { X, Y, HEADING, SPEED };

static const double period = 0.010;             /* s */
static const double earth_radius = 6371000.0;   /* m */
static const double gps_variance = 0.25;        /* m^2, at gps_weight 1 */
static const double yaw_variance = 0.0025;      /* rad^2 */
static const double weight_least = 0.01;
static const double process_noise[FILTER_STATES] = {1.0e-4, 1.0e-4, 1.0e-5, 1.0e-3};
static const double initial_variance[FILTER_STATES] = {25.0, 25.0, 1.0, 0.25};

static void publish(const FusionFilter *filter, double turned, RobotState *state)
{
    state->pose.x = filter->state[X];
    state->pose.y = filter->state[Y];
    state->pose.heading = filter->state[HEADING];
    state->speed = (float)filter->state[SPEED];
    state->yaw_rate = (float)(turned * (1.0 / 0.010));
}

void StateFusion_reset(FusionFilter *filter, RobotState *state)
{
    for (int i = 0; i < FILTER_STATES; i++) {
        filter->state[i] = 0.0;
        for (int j = 0; j < FILTER_STATES; j++)
            filter->covariance[i][j] = 0.0;
        filter->covariance[i][i] = initial_variance[i];
    }
    filter->origin_latitude = 0.0;
    filter->origin_longitude = 0.0;
    filter->origin_scale = 1.0;
    filter->yaw = 0.0;
    filter->yaw_known = 0;
    filter->fix_stamp = 0;
    publish(filter, 0.0, state);
}

/* Angle turned since the last activation: the sum of the wrapped differences of all samples in the buffer. */
static double turned_angle(FusionFilter *filter, const Attitude *attitude, uint32_t count)
{
    double turned = 0.0;
    if (count > ATTITUDE_QUEUE)
        count = ATTITUDE_QUEUE;
    for (uint32_t i = 0; i < count; i++) {
        double yaw = attitude[i].yaw;
        if (filter->yaw_known)
            turned += real_wrap(yaw - filter->yaw);
        filter->yaw = yaw;
        filter->yaw_known = 1;
    }
    return turned;
}

static void multiply(double product[FILTER_STATES][FILTER_STATES], double a[FILTER_STATES][FILTER_STATES],
                     double b[FILTER_STATES][FILTER_STATES], bool transpose_b)
{
    for (int i = 0; i < FILTER_STATES; i++)
        for (int j = 0; j < FILTER_STATES; j++) {
            double sum = 0.0;
            for (int k = 0; k < FILTER_STATES; k++)
                sum += a[i][k] * (transpose_b ? b[j][k] : b[k][j]);
            product[i][j] = sum;
        }
}

/* State and covariance one period later: P := F P F' + Q. */
static void predict(FusionFilter *filter, double turned)
{
    double jacobian[FILTER_STATES][FILTER_STATES], half[FILTER_STATES][FILTER_STATES];
    double heading = real_wrap(filter->state[HEADING] + turned), speed = filter->state[SPEED];
    double east = period * real_cos(heading), north = period * real_sin(heading);

    filter->state[X] += speed * east;
    filter->state[Y] += speed * north;
    filter->state[HEADING] = heading;
    for (int i = 0; i < FILTER_STATES; i++)
        for (int j = 0; j < FILTER_STATES; j++)
            jacobian[i][j] = i == j ? 1.0 : 0.0;
    jacobian[X][HEADING] = -speed * north;
    jacobian[Y][HEADING] = speed * east;
    jacobian[X][SPEED] = east;
    jacobian[Y][SPEED] = north;
    multiply(half, jacobian, filter->covariance, false);
    multiply(filter->covariance, half, jacobian, true);
    for (int i = 0; i < FILTER_STATES; i++)
        filter->covariance[i][i] += process_noise[i];
}

/* Correction by one measured component of the state; `innovation` is measured minus predicted. */
static void correct(FusionFilter *filter, int component, double innovation, double variance)
{
    double gain[FILTER_STATES], row[FILTER_STATES];
    double scale = 1.0 / (filter->covariance[component][component] + variance);
    for (int i = 0; i < FILTER_STATES; i++) {
        gain[i] = filter->covariance[i][component] * scale;
        row[i] = filter->covariance[component][i];
    }
    for (int i = 0; i < FILTER_STATES; i++) {
        filter->state[i] += gain[i] * innovation;
        for (int j = 0; j < FILTER_STATES; j++)
            filter->covariance[i][j] -= gain[i] * row[j];
    }
    filter->state[HEADING] = real_wrap(filter->state[HEADING]);
}

static void use_fix(FusionFilter *filter, const Position *position, double weight)
{
    if (filter->fix_stamp == 0) {
        filter->origin_latitude = position->latitude;
        filter->origin_longitude = position->longitude;
        filter->origin_scale = real_cos(position->latitude);
    }
    filter->fix_stamp = position->stamp;
    double variance = gps_variance / (weight > weight_least ? weight : weight_least);
    double east = (position->longitude - filter->origin_longitude) * filter->origin_scale * earth_radius;
    double north = (position->latitude - filter->origin_latitude) * earth_radius;
    correct(filter, X, east - filter->state[X], variance);
    correct(filter, Y, north - filter->state[Y], variance);
}

void StateFusion_fuse(const Position *position, const Attitude *attitude, uint32_t attitude_count,
                      const double *gps_weight, FusionFilter *filter, RobotState *state)
{
    double turned = turned_angle(filter, attitude, attitude_count);
    predict(filter, turned);
    if (filter->yaw_known)
        correct(filter, HEADING, real_wrap(filter->yaw - filter->state[HEADING]), yaw_variance);
    if (position->stamp != 0 && position->stamp != filter->fix_stamp)
        use_fix(filter, position, *gps_weight);
    publish(filter, turned, state);
}
