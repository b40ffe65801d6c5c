/* IG500: the GPS/INS receiver on a serial line.
 *
 *   0xff 0x02 command length(2) payload(length) crc(2) 0x03          big-endian, CRC-16 over command .. payload
 *
 * Command 0x50 is a position fix: time of week in ms (u32), latitude and longitude in 1e-7 degrees (i32), altitude in
 * mm (i32), satellites (u8), fix quality (u8; 0: none). Longer payloads may follow in later firmware.
 */
#include "crc16.h"
#include "realmath.h"
#include "ttrk.h"

enum {
    SYNC = 0xff,
    START = 0x02,
    END = 0x03,
    POSITION_FIX = 0x50,
    HEADER_BYTES = 5,
    TRAILER_BYTES = 3,
    FIX_BYTES = 18,
    PAYLOAD_MAX = 48,
    DEVICE_NAME_MAX = 32,
};

static uint32_t big_endian_16(const uint8_t *p)
{
    return (uint32_t)p[0] << 8 | p[1];
}

static uint32_t big_endian_32(const uint8_t *p)
{
    return big_endian_16(p) << 16 | big_endian_16(p + 2);
}

/* "/dev/ttyS1" is channel 2: the last digit of the name plus one. No digit: channel 0, which is closed. */
void IG500_open(const char *const *device, GpsInbox *inbox)
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

void IG500_close(GpsInbox *inbox)
{
    inbox->count = 0;
    inbox->channel = 0;
}

/* First byte of the next frame's sync pair. The sentinel behind the received bytes ends the scan, which therefore runs
 * at most GPS_INBOX_CAPACITY times: a fact about the data that no counter shows. */
static const uint8_t *find_sync(GpsInbox *inbox)
{
    const uint8_t *scan = inbox->bytes;
    inbox->bytes[inbox->count] = SYNC;
    inbox->bytes[inbox->count + 1] = START;
    while (scan[0] != SYNC || scan[1] != START)
        scan++;
    return scan;
}

/* Drop the first `used` bytes and move the rest to the front. */
static void consume(GpsInbox *inbox, uint32_t used)
{
    uint32_t rest = inbox->count - used;
    if (rest > GPS_INBOX_CAPACITY)
        rest = GPS_INBOX_CAPACITY;
    for (uint32_t i = 0; i < rest; i++)
        inbox->bytes[i] = inbox->bytes[used + i];
    inbox->count = rest;
}

static bool frame_is_valid(const uint8_t *frame, uint32_t length)
{
    uint16_t crc = CRC16_INITIAL;
    if (length > PAYLOAD_MAX)
        return false;
    for (uint32_t i = 2; i < HEADER_BYTES + length; i++)
        crc = crc16_byte(crc, frame[i]);
    const uint8_t *trailer = frame + HEADER_BYTES + length;
    return big_endian_16(trailer) == crc && trailer[2] == END;
}

static void decode_fix(const uint8_t *payload, Position *position)
{
    if (payload[17] == 0)
        return;
    position->latitude = (int32_t)big_endian_32(payload + 4) * (PI / 180.0e7);
    position->longitude = (int32_t)big_endian_32(payload + 8) * (PI / 180.0e7);
    position->altitude = (int32_t)big_endian_32(payload + 12) * 1.0e-3;
    position->stamp = (Time)big_endian_32(payload) * 1000000;
}

/* Handle the first frame in the inbox; the number of bytes that are done with. */
static uint32_t take_frame(GpsInbox *inbox, Position *position)
{
    const uint8_t *frame = find_sync(inbox);
    uint32_t start = (uint32_t)(frame - inbox->bytes);
    uint32_t available = inbox->count - start;
    if (available == 0 && start > 0 && frame[-1] == SYNC)
        return start - 1; /* half a sync pair: the rest may be on its way */
    if (available < HEADER_BYTES)
        return start;
    uint32_t length = big_endian_16(frame + 3);
    if (length <= PAYLOAD_MAX && available < HEADER_BYTES + length + TRAILER_BYTES)
        return start;
    if (!frame_is_valid(frame, length)) {
        inbox->rejected++;
        return start + 2;
    }
    if (frame[2] == POSITION_FIX && length >= FIX_BYTES)
        decode_fix(frame + HEADER_BYTES, position);
    return start + HEADER_BYTES + length + TRAILER_BYTES;
}

/* One frame per activation: the first complete one in the inbox. `position` keeps its value when there is none. */
void IG500_read(GpsInbox *inbox, Position *position)
{
    if (inbox->channel == 0)
        return;
    if (inbox->count > GPS_INBOX_CAPACITY)
        inbox->count = GPS_INBOX_CAPACITY;
    consume(inbox, take_frame(inbox, position));
}
