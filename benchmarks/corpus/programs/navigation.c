/* entry: run; inputs: legs each 2B -10000..10000, amount 0..12 */
#include <math.h>
#include <stdint.h>

int16_t legs[12][2] = {{100, 200}, {-300, 50}, {0, -120}, {77, 77}};
uint8_t amount = 4;
static double heading, travelled;

int run(void)
{
    for (uint8_t i = 0; i < amount; i++) {
        double x = legs[i][0], y = legs[i][1];
        double turn = atan2(y, x) - heading;
        while (turn > 3.14159265358979)
            turn -= 2 * 3.14159265358979;
        while (turn < -3.14159265358979)
            turn += 2 * 3.14159265358979;
        heading += turn;
        travelled += sqrt(x * x + y * y) * cos(turn / 4);
    }
    return (int)travelled;
}

int main(void)
{
    return run();
}
