/* entry: run; inputs: events each 1B 0..5, amount 0..50 */
#include <stdint.h>

enum state { CLOSED, OPENING, OPEN, CLOSING, BLOCKED, HOMING, FAULT, LOCKED, SERVICE, RESET };
enum event { NONE, BUTTON, TOP, BOTTOM, BEAM, TIMEOUT };

uint8_t events[50] = {1, 2, 0, 5, 4, 2, 0, 1, 3, 1, 2, 5, 3};
uint8_t amount = 13;
static enum state state = RESET;
static uint16_t cycles, faults;
static uint8_t patience;

static enum state next(enum state now, enum event event)
{
    switch (now) {
    case CLOSED:
        return event == BUTTON ? OPENING : CLOSED;
    case OPENING:
        if (event == TOP)
            return OPEN;
        return event == TIMEOUT ? FAULT : OPENING;
    case OPEN:
        return event == BUTTON || event == TIMEOUT ? CLOSING : OPEN;
    case CLOSING:
        if (event == BEAM) {
            patience = 3;
            return BLOCKED;
        }
        if (event == BOTTOM)
            cycles++;
        return event == BOTTOM ? CLOSED : CLOSING;
    case BLOCKED:
        return --patience == 0 ? OPENING : BLOCKED;
    case HOMING:
        return event == BOTTOM ? CLOSED : event == TIMEOUT ? FAULT : HOMING;
    case FAULT:
        faults++;
        return faults > 10 ? LOCKED : HOMING;
    case LOCKED:
        return event == BUTTON ? SERVICE : LOCKED;
    case SERVICE:
        faults = 0;
        return RESET;
    case RESET:
    default:
        return HOMING;
    }
}

int run(void)
{
    const uint8_t *event = events;
    while (amount) {
        state = next(state, (enum event)*event++);
        amount--;
    }
    return (int)state | cycles << 8;
}

int main(void)
{
    return run();
}
