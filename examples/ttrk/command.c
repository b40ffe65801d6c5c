/* Command: turns the robot on the spot until it faces the target, then drives there. */
#include "realmath.h"
#include "ttrk.h"

static const double turn_gain = 0.8;      /* m/s of track speed per rad */
static const double turn_limit = 0.4;     /* m/s */
static const double cruise_speed = 0.8;   /* m/s */
static const double braking = 0.3;        /* m/s^2 */
static const double steer_gain = 0.6;     /* m/s per rad */
static const double steer_limit = 0.25;   /* m/s */
static const double yaw_damping = 0.05;   /* m/s per rad/s */
static const double arrived = 0.20;       /* m */
static const double stray_factor = 6.0;   /* times heading_tolerance */

static double distance_to(const RobotState *state, const Pose *target)
{
    double dx = target->x - state->pose.x, dy = target->y - state->pose.y;
    return real_sqrt(dx * dx + dy * dy);
}

/* Bearing of the target seen from the robot, 0 straight ahead. Near the target, the target's own heading counts. */
static double heading_error(const RobotState *state, const Pose *target)
{
    double wanted = target->heading;
    if (distance_to(state, target) > arrived)
        wanted = real_atan2(target->y - state->pose.y, target->x - state->pose.x);
    return real_wrap(wanted - state->pose.heading);
}

void Command_halt(TrackCommand *command)
{
    command->left = 0.0f;
    command->right = 0.0f;
}

void Command_rotate(const RobotState *state, const Pose *target, TrackCommand *command)
{
    double turn = turn_gain * heading_error(state, target) - yaw_damping * state->yaw_rate;
    turn = real_clamp(turn, turn_limit);
    command->left = (float)-turn;
    command->right = (float)turn;
}

void Command_reach(const RobotState *state, const Pose *target, TrackCommand *command)
{
    double distance = distance_to(state, target);
    double steer = steer_gain * heading_error(state, target) - yaw_damping * state->yaw_rate;
    double speed = 0.0;
    if (distance > arrived)
        speed = real_sqrt(2.0 * braking * distance); /* so that the robot can stop at the target */
    speed = real_clamp(speed, cruise_speed) * real_cos(heading_error(state, target));
    steer = real_clamp(steer, steer_limit);
    command->left = (float)(speed - steer);
    command->right = (float)(speed + steer);
}

bool Command_aligned(const RobotState *state, const Pose *target, const double *heading_tolerance)
{
    return real_abs(heading_error(state, target)) <= *heading_tolerance;
}

bool Command_strayed(const RobotState *state, const Pose *target, const double *heading_tolerance)
{
    return real_abs(heading_error(state, target)) > stray_factor * *heading_tolerance;
}
