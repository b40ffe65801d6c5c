/* Types and codels of the TTRK robot, as ttrk.mauve declares them.
 *
 * How a declaration in ttrk.mauve becomes a C prototype
 *   - The function of codel `c` of component `C` is `C_c`.
 *   - Its parameters are the names after `reads`, then those after `writes`, in the order written: one pointer each,
 *     `const` for a name that is only read. A name that is read and written is one pointer, where it is read.
 *   - An in port with a buffered connection gives two parameters: a pointer to an array, oldest element first, and
 *     `uint32_t <port>_count`, the elements in it, at most the `size` of the connection (the codel may rely on that;
 *     the ones here clamp it all the same). An unbuffered port gives the last value; who must know whether it is new
 *     compares its stamp with the one seen before.
 *   - `returns bool` and `returns LinkStatus` are the C return type.
 *   - `time` is an int64_t in nanoseconds, `string` a pointer to characters.
 *   - A codel allocates nothing and has no variables outside its frame except constants: what must last is a variable
 *     of its component and comes in as a parameter. Distinct parameters are distinct objects.
 */
#ifndef TTRK_H
#define TTRK_H

#include <stdbool.h>
#include <stdint.h>

typedef int64_t Time;

/* ------------------------------------------------------------------------------------------------ data on ports */

/* Geodetic position: radians, radians, metres. A stamp of 0 is "no fix yet". */
typedef struct {
    double latitude, longitude, altitude;
    Time stamp;
} Position;

/* Attitude angles in radians. */
typedef struct {
    float roll, pitch, yaw;
    Time stamp;
} Attitude;

/* Place in the local tangent plane, metres east and north of the first fix; heading in radians, counter-clockwise. */
typedef struct {
    double x, y, heading;
} Pose;

typedef struct {
    Pose pose;
    float speed;    /* m/s */
    float yaw_rate; /* rad/s */
} RobotState;

/* Speeds of the tracks in m/s. */
typedef struct {
    float left, right;
} TrackCommand;

typedef enum { OK, TIMEOUT, BAD_FRAME } LinkStatus;

/* ---------------------------------------------------------------------------------------- variables of components */

/* What a serial driver has received and the codel has not consumed. `bytes` has room for the largest `count` and two
 * more bytes, where the reading codel puts a sentinel. */
enum { GPS_INBOX_CAPACITY = 254, IMU_INBOX_CAPACITY = 62, SENTINEL = 2 };

typedef struct {
    uint8_t bytes[GPS_INBOX_CAPACITY + SENTINEL];
    uint32_t count;
    uint32_t channel;  /* 0: closed */
    uint32_t rejected; /* frames thrown away since `open` */
} GpsInbox;

typedef struct {
    uint8_t bytes[IMU_INBOX_CAPACITY + SENTINEL];
    uint32_t count;
    uint32_t channel;
    uint32_t rejected;
} ImuInbox;

/* Extended Kalman filter over (x, y, heading, speed). */
enum { FILTER_STATES = 4, ATTITUDE_QUEUE = 16 };

typedef struct {
    double state[FILTER_STATES];
    double covariance[FILTER_STATES][FILTER_STATES];
    double origin_latitude, origin_longitude, origin_scale; /* scale: cosine of the origin's latitude */
    double yaw;                                             /* last yaw of the inertial unit */
    Time fix_stamp;                                         /* stamp of the last fix that was used; 0: none */
    uint32_t yaw_known;
} FusionFilter;

/* One frame on its way to the track controller. The driver sets `count` to 0 when the last byte has left. */
enum { OUTBOX_CAPACITY = 20 };

typedef struct {
    uint8_t bytes[OUTBOX_CAPACITY];
    uint32_t count;
    uint32_t sequence;
} Outbox;

/* ------------------------------------------------------------------------------------------------------- codels */

void IG500_open(const char *const *device, GpsInbox *inbox);
void IG500_read(GpsInbox *inbox, Position *position);
void IG500_close(GpsInbox *inbox);

void CHR6dm_open(const char *const *device, ImuInbox *inbox);
void CHR6dm_read(ImuInbox *inbox, Attitude *attitude);

void StateFusion_reset(FusionFilter *filter, RobotState *state);
void StateFusion_fuse(const Position *position, const Attitude *attitude, uint32_t attitude_count,
                      const double *gps_weight, FusionFilter *filter, RobotState *state);

void Command_halt(TrackCommand *command);
void Command_rotate(const RobotState *state, const Pose *target, TrackCommand *command);
void Command_reach(const RobotState *state, const Pose *target, TrackCommand *command);
bool Command_aligned(const RobotState *state, const Pose *target, const double *heading_tolerance);
bool Command_strayed(const RobotState *state, const Pose *target, const double *heading_tolerance);

LinkStatus CICAS_send_frame(const TrackCommand *command, Outbox *outbox);

#endif
