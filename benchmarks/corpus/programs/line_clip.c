/* entry: run; inputs: lines each 2B -500..500, amount 0..10 */
#include <stdint.h>

enum { LEFT = 1, RIGHT = 2, BELOW = 4, ABOVE = 8 };
enum { X0 = 0, Y0 = 0, X1 = 127, Y1 = 63 };

int16_t lines[10][4] = {{-20, 10, 200, 50}, {5, 5, 60, 60}, {-10, -10, -5, 200}, {0, 100, 127, -20}};
uint8_t amount = 4;

static uint8_t code(int x, int y)
{
    uint8_t c = 0;
    if (x < X0)
        c |= LEFT;
    else if (x > X1)
        c |= RIGHT;
    if (y < Y0)
        c |= BELOW;
    else if (y > Y1)
        c |= ABOVE;
    return c;
}

static int clip(int16_t line[4])
{
    int ax = line[0], ay = line[1], bx = line[2], by = line[3];
    uint8_t ca = code(ax, ay), cb = code(bx, by);

    for (int tries = 0; tries < 6; tries++) {
        if (!(ca | cb)) {
            line[0] = (int16_t)ax, line[1] = (int16_t)ay, line[2] = (int16_t)bx, line[3] = (int16_t)by;
            return 1;
        }
        if (ca & cb)
            return 0;
        uint8_t out = ca ? ca : cb;
        int x = 0, y = 0;
        if (out & (BELOW | ABOVE)) {
            y = out & BELOW ? Y0 : Y1;
            x = by == ay ? ax : ax + (bx - ax) * (y - ay) / (by - ay);
        } else {
            x = out & LEFT ? X0 : X1;
            y = bx == ax ? ay : ay + (by - ay) * (x - ax) / (bx - ax);
        }
        if (out == ca)
            ax = x, ay = y, ca = code(ax, ay);
        else
            bx = x, by = y, cb = code(bx, by);
    }
    return 0;
}

int run(void)
{
    int visible = 0;
    while (amount--)
        visible += clip(lines[amount]);
    return visible;
}

int main(void)
{
    return run();
}
