/* entry: run; inputs: stream any, length 0..100 */
#include <stdint.h>

/* The dialogue of a modem: 60 states, one input byte per step. */
uint8_t stream[100] = "ATD0123;OK CONNECT 9600 +++ATH0";
uint8_t length = 30;
static uint8_t state;
static uint16_t errors, retries;

static void step(uint8_t byte)
{
    switch (state) {
    case 0:
        state = byte == '0' ? 20 : 9;
        break;
    case 1:
        if (byte < 32) {
            errors++;
            state = 41;
        } else if (byte & 1) {
            state = 3;
        }
        break;
    case 2:
        retries++;
        state = retries > 4 ? 52 : 6;
        break;
    case 3:
        if (byte != 0)
            state = (uint8_t)(23 + (byte & 3)) % 60;
        break;
    case 4:
        state = byte == '4' ? 58 : 32;
        break;
    case 5:
        if (byte < 32) {
            errors++;
            state = 2;
        } else if (byte & 1) {
            state = 5;
        }
        break;
    case 6:
        retries++;
        state = retries > 8 ? 26 : 15;
        break;
    case 7:
        if (byte != 0)
            state = (uint8_t)(5 + (byte & 3)) % 60;
        break;
    case 8:
        state = byte == '8' ? 3 : 52;
        break;
    case 9:
        if (byte < 32) {
            errors++;
            state = 7;
        } else if (byte & 1) {
            state = 14;
        }
        break;
    case 10:
        retries++;
        state = retries > 5 ? 40 : 3;
        break;
    case 11:
        if (byte != 0)
            state = (uint8_t)(36 + (byte & 3)) % 60;
        break;
    case 12:
        state = byte == '<' ? 3 : 14;
        break;
    case 13:
        if (byte < 32) {
            errors++;
            state = 35;
        } else if (byte & 1) {
            state = 54;
        }
        break;
    case 14:
        retries++;
        state = retries > 2 ? 18 : 9;
        break;
    case 15:
        if (byte != 0)
            state = (uint8_t)(34 + (byte & 3)) % 60;
        break;
    case 16:
        state = byte == '@' ? 19 : 35;
        break;
    case 17:
        if (byte < 32) {
            errors++;
            state = 43;
        } else if (byte & 1) {
            state = 11;
        }
        break;
    case 18:
        retries++;
        state = retries > 6 ? 37 : 40;
        break;
    case 19:
        if (byte != 0)
            state = (uint8_t)(12 + (byte & 3)) % 60;
        break;
    case 20:
        state = byte == 'D' ? 35 : 45;
        break;
    case 21:
        if (byte < 32) {
            errors++;
            state = 36;
        } else if (byte & 1) {
            state = 3;
        }
        break;
    case 22:
        retries++;
        state = retries > 3 ? 13 : 43;
        break;
    case 23:
        if (byte != 0)
            state = (uint8_t)(34 + (byte & 3)) % 60;
        break;
    case 24:
        state = byte == 'H' ? 20 : 29;
        break;
    case 25:
        if (byte < 32) {
            errors++;
            state = 59;
        } else if (byte & 1) {
            state = 29;
        }
        break;
    case 26:
        retries++;
        state = retries > 7 ? 19 : 50;
        break;
    case 27:
        if (byte != 0)
            state = (uint8_t)(11 + (byte & 3)) % 60;
        break;
    case 28:
        state = byte == 'L' ? 15 : 5;
        break;
    case 29:
        if (byte < 32) {
            errors++;
            state = 19;
        } else if (byte & 1) {
            state = 33;
        }
        break;
    case 30:
        retries++;
        state = retries > 4 ? 56 : 46;
        break;
    case 31:
        if (byte != 0)
            state = (uint8_t)(28 + (byte & 3)) % 60;
        break;
    case 32:
        state = byte == 'P' ? 4 : 7;
        break;
    case 33:
        if (byte < 32) {
            errors++;
            state = 26;
        } else if (byte & 1) {
            state = 10;
        }
        break;
    case 34:
        retries++;
        state = retries > 8 ? 21 : 59;
        break;
    case 35:
        if (byte != 0)
            state = (uint8_t)(31 + (byte & 3)) % 60;
        break;
    case 36:
        state = byte == 'T' ? 42 : 4;
        break;
    case 37:
        if (byte < 32) {
            errors++;
            state = 35;
        } else if (byte & 1) {
            state = 36;
        }
        break;
    case 38:
        retries++;
        state = retries > 5 ? 56 : 20;
        break;
    case 39:
        if (byte != 0)
            state = (uint8_t)(21 + (byte & 3)) % 60;
        break;
    case 40:
        state = byte == '0' ? 38 : 31;
        break;
    case 41:
        if (byte < 32) {
            errors++;
            state = 51;
        } else if (byte & 1) {
            state = 29;
        }
        break;
    case 42:
        retries++;
        state = retries > 2 ? 53 : 17;
        break;
    case 43:
        if (byte != 0)
            state = (uint8_t)(30 + (byte & 3)) % 60;
        break;
    case 44:
        state = byte == '4' ? 4 : 3;
        break;
    case 45:
        if (byte < 32) {
            errors++;
            state = 44;
        } else if (byte & 1) {
            state = 19;
        }
        break;
    case 46:
        retries++;
        state = retries > 6 ? 36 : 52;
        break;
    case 47:
        if (byte != 0)
            state = (uint8_t)(28 + (byte & 3)) % 60;
        break;
    case 48:
        state = byte == '8' ? 24 : 56;
        break;
    case 49:
        if (byte < 32) {
            errors++;
            state = 22;
        } else if (byte & 1) {
            state = 1;
        }
        break;
    case 50:
        retries++;
        state = retries > 3 ? 22 : 39;
        break;
    case 51:
        if (byte != 0)
            state = (uint8_t)(7 + (byte & 3)) % 60;
        break;
    case 52:
        state = byte == '<' ? 13 : 49;
        break;
    case 53:
        if (byte < 32) {
            errors++;
            state = 8;
        } else if (byte & 1) {
            state = 47;
        }
        break;
    case 54:
        retries++;
        state = retries > 7 ? 25 : 58;
        break;
    case 55:
        if (byte != 0)
            state = (uint8_t)(55 + (byte & 3)) % 60;
        break;
    case 56:
        state = byte == '@' ? 10 : 28;
        break;
    case 57:
        if (byte < 32) {
            errors++;
            state = 35;
        } else if (byte & 1) {
            state = 17;
        }
        break;
    case 58:
        retries++;
        state = retries > 4 ? 8 : 27;
        break;
    case 59:
        if (byte != 0)
            state = (uint8_t)(55 + (byte & 3)) % 60;
        break;
    default:
        state = 0;
        break;
    }
}

int run(void)
{
    for (uint8_t i = 0; i < length; i++)
        step(stream[i]);
    return errors << 8 | state;
}

int main(void)
{
    return run();
}
