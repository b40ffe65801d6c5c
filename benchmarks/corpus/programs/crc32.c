/* entry: run; inputs: image any, start 0..31, length 0..160 */
#include <stdint.h>

uint8_t image[192] = "a small block of flash that a loader checks before it jumps there";
uint32_t start = 3, length = 60;

static const uint32_t nibbles[16] = {
    0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4, 0x4DB26158, 0x5005713C,
    0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C, 0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C};

static uint32_t slow(uint32_t crc, uint8_t byte)
{
    crc ^= byte;
    for (int k = 0; k < 8; ++k)
        crc = crc >> 1 ^ (0xEDB88320 & -(crc & 1));
    return crc;
}

int run(void)
{
    uint32_t fast = ~0u, check = ~0u;
    for (uint32_t i = 0; i < length; i++) {
        fast = nibbles[(fast ^ image[start + i]) & 15] ^ fast >> 4;
        fast = nibbles[(fast ^ image[start + i] >> 4) & 15] ^ fast >> 4;
    }
    for (const uint8_t *p = image + start, *stop = p + length; p < stop; p++)
        check = slow(check, *p);
    return fast == check;
}

int main(void)
{
    return run();
}
