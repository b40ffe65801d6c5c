/* CRC-16/CCITT-FALSE: polynomial 0x1021, initial value 0xffff, most significant bit first. */
#ifndef CRC16_H
#define CRC16_H

#include <stdint.h>

enum { CRC16_INITIAL = 0xffff };

uint16_t crc16_byte(uint16_t crc, uint8_t byte);

#endif
