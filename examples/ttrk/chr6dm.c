/* CHR6dm: the inertial measurement unit on a serial line.
 *
 *   's' 'n' 'p' type length payload(length) sum(2)           big-endian, sum of all bytes before it, modulo 65536
 *
 * Type 0xb7 carries sensor data: a mask of channels (u16, bit 15 = channel 0), then one i16 per set bit. Channels 0, 1
 * and 2 are yaw, pitch and roll; the others are rates and raw sensors that this driver skips.
 */
#include "realmath.h"
#include "ttrk.h"

enum {
    SENSOR_DATA = 0xb7,
    HEADER_BYTES = 5,
    TRAILER_BYTES = 2,
    CHANNELS = 15,
    PAYLOAD_MAX = 2 + 2 * CHANNELS,
    DEVICE_NAME_MAX = 32,
};

static const float angle_unit = (float)(0.0109863 * PI / 180.0);
static const Time sample_period = 1000000; /* ns */

static uint32_t big_endian_16(const uint8_t *p)
{
    return (uint32_t)p[0] << 8 | p[1];
}

void CHR6dm_open(const char *const *device, ImuInbox *inbox)
{
    const char *name = *device;
    uint32_t channel = 0;
    for (int i = 0; i < DEVICE_NAME_MAX && name[i] != '\0'; i++)
        if (name[i] >= '0' && name[i] <= '9')
            channel = (uint32_t)(name[i] - '0') + 1;
    inbox->count = 0;
    inbox->rejected = 0;
    inbox->channel = channel;
}

/* First byte of the next packet. As for the receiver, a sentinel ends the scan: at most IMU_INBOX_CAPACITY turns. */
static const uint8_t *find_packet(ImuInbox *inbox)
{
    const uint8_t *scan = inbox->bytes;
    inbox->bytes[inbox->count] = 's';
    inbox->bytes[inbox->count + 1] = 'n';
    while (scan[0] != 's' || scan[1] != 'n')
        scan++;
    return scan;
}

static void consume(ImuInbox *inbox, uint32_t used)
{
    uint32_t rest = inbox->count - used;
    if (rest > IMU_INBOX_CAPACITY)
        rest = IMU_INBOX_CAPACITY;
    for (uint32_t i = 0; i < rest; i++)
        inbox->bytes[i] = inbox->bytes[used + i];
    inbox->count = rest;
}

static bool packet_is_valid(const uint8_t *packet, uint32_t length)
{
    uint16_t sum = 0;
    if (length > PAYLOAD_MAX)
        return false;
    for (uint32_t i = 0; i < HEADER_BYTES + length; i++)
        sum = (uint16_t)(sum + packet[i]);
    return packet[2] == 'p' && big_endian_16(packet + HEADER_BYTES + length) == sum;
}

/* The channels that the mask announces, in order; false where the payload is too short for the mask. */
static bool decode_channels(const uint8_t *payload, uint32_t length, int16_t value[CHANNELS])
{
    uint32_t mask = big_endian_16(payload), at = 2;
    for (int channel = 0; channel < CHANNELS; channel++) {
        value[channel] = 0;
        if ((mask & 0x8000u >> channel) == 0)
            continue;
        if (at + 2 > length)
            return false;
        value[channel] = (int16_t)big_endian_16(payload + at);
        at += 2;
    }
    return (mask >> 13 & 7) == 7;
}

/* Handle the first packet in the inbox; the number of bytes that are done with. */
static uint32_t take_packet(ImuInbox *inbox, Attitude *attitude)
{
    int16_t value[CHANNELS];
    const uint8_t *packet = find_packet(inbox);
    uint32_t start = (uint32_t)(packet - inbox->bytes);
    uint32_t available = inbox->count - start;
    if (available == 0 && start > 0 && packet[-1] == 's')
        return start - 1; /* half a mark: the rest may be on its way */
    if (available < HEADER_BYTES)
        return start;
    uint32_t length = packet[4];
    if (length <= PAYLOAD_MAX && available < HEADER_BYTES + length + TRAILER_BYTES)
        return start;
    if (!packet_is_valid(packet, length)) {
        inbox->rejected++;
        return start + 2;
    }
    if (packet[3] == SENSOR_DATA && length >= 2 && decode_channels(packet + HEADER_BYTES, length, value)) {
        attitude->yaw = value[0] * angle_unit;
        attitude->pitch = value[1] * angle_unit;
        attitude->roll = value[2] * angle_unit;
    }
    return start + HEADER_BYTES + length + TRAILER_BYTES;
}

/* One packet per activation: the first complete one. The stamp counts sample periods, since the unit sends no time. */
void CHR6dm_read(ImuInbox *inbox, Attitude *attitude)
{
    if (inbox->channel == 0)
        return;
    if (inbox->count > IMU_INBOX_CAPACITY)
        inbox->count = IMU_INBOX_CAPACITY;
    attitude->stamp += sample_period;
    consume(inbox, take_packet(inbox, attitude));
}
