/* CICAS: frames for the ARM7 that drives the tracks.
 *
 *   0x7e  stuffed( sequence, 0x11, left(2), right(2), crc(2) )  0x7e                             big-endian
 *
 * Speeds are signed, in mm/s. CRC-16 over the bytes before it. Inside the frame 0x7e and 0x7d are sent as 0x7d followed
 * by the byte with bit 5 inverted.
 */
#include "crc16.h"
#include "ttrk.h"

enum { FLAG = 0x7e, ESCAPE = 0x7d, ESCAPE_BIT = 0x20, SET_SPEEDS = 0x11, BODY_BYTES = 6, CONTENT_BYTES = 8 };

static const float speed_limit = 2.0f; /* m/s */

static bool in_range(float speed)
{
    return speed >= -speed_limit && speed <= speed_limit;
}

static void put_speed(uint8_t *to, float speed)
{
    uint32_t millimetres = (uint32_t)(int32_t)(speed * 1000.0f);
    to[0] = (uint8_t)(millimetres >> 8);
    to[1] = (uint8_t)millimetres;
}

/* TIMEOUT while the frame before is still on its way; BAD_FRAME for a speed out of range or not a number. */
LinkStatus CICAS_send_frame(const TrackCommand *command, Outbox *outbox)
{
    uint8_t content[CONTENT_BYTES];
    uint16_t crc = CRC16_INITIAL;
    uint32_t at = 0;
    if (outbox->count != 0)
        return TIMEOUT;
    if (!in_range(command->left) || !in_range(command->right))
        return BAD_FRAME;
    content[0] = (uint8_t)outbox->sequence++;
    content[1] = SET_SPEEDS;
    put_speed(content + 2, command->left);
    put_speed(content + 4, command->right);
    for (int i = 0; i < BODY_BYTES; i++)
        crc = crc16_byte(crc, content[i]);
    content[6] = (uint8_t)(crc >> 8);
    content[7] = (uint8_t)crc;

    outbox->bytes[at++] = FLAG;
    for (int i = 0; i < CONTENT_BYTES; i++) {
        if (content[i] == FLAG || content[i] == ESCAPE) {
            outbox->bytes[at++] = ESCAPE;
            outbox->bytes[at++] = content[i] ^ ESCAPE_BIT;
        } else {
            outbox->bytes[at++] = content[i];
        }
    }
    outbox->bytes[at++] = FLAG;
    outbox->count = at;
    return OK;
}
