/* entry: run; inputs: halls each 1B 0..7, edges 0..24, demand -200..200 */
#include <stdint.h>

/* Six-step commutation: the Hall sensors choose which phases conduct; a ramp limits the duty. */
struct phases {
    int8_t u, v, w;
};
static const struct phases forward[8] = {{0, 0, 0},  {1, -1, 0}, {0, 1, -1}, {1, 0, -1},
                                         {-1, 0, 1}, {0, -1, 1}, {-1, 1, 0}, {0, 0, 0}};

uint8_t halls[24] = {5, 4, 6, 2, 3, 1, 5, 4, 6, 2, 3, 1, 1, 0, 7};
uint8_t edges = 15;
int16_t demand = 120;
static int16_t duty, position;
static uint8_t previous, faults;

static int8_t direction(uint8_t from, uint8_t to)
{
    static const uint8_t ring[6] = {5, 4, 6, 2, 3, 1};
    uint8_t i = 0;
    while (i < 6 && ring[i] != from)
        i++;
    if (i == 6)
        return 0;
    if (ring[(i + 1) % 6] == to)
        return 1;
    return ring[(i + 5) % 6] == to ? -1 : 0;
}

int run(void)
{
    int32_t current = 0;
    for (uint8_t e = 0; e < edges; e++) {
        uint8_t hall = halls[e];
        if (hall == 0 || hall == 7) {
            if (++faults > 3)
                break;
            continue;
        }
        position += direction(previous, hall);
        previous = hall;
        while (duty < demand && duty < 100)
            duty += 5;
        while (duty > demand && duty > -100)
            duty -= 5;
        const struct phases *p = &forward[hall];
        current += duty * (p->u * 3 + p->v * 2 + p->w);
    }
    return current + position;
}

int main(void)
{
    return run();
}
