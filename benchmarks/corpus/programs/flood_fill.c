/* entry: run; inputs: grid each 1B 0..1, start 0..79 */
#include <stdint.h>

#define W 10
#define H 8
uint8_t grid[H * W] = {0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 1, 1, 1, 1, 0};
uint8_t start = 0;
static uint8_t stack[H * W];

/* A cell is marked when it is pushed: none is pushed twice. */
int run(void)
{
    uint8_t used = 0;
    int filled = 0;

    if (grid[start])
        return 0;
    grid[start] = 2;
    stack[used++] = start;
    while (used > 0) {
        uint8_t at = stack[--used], x = at % W;
        filled++;
        if (x > 0 && grid[at - 1] == 0) {
            grid[at - 1] = 2;
            stack[used++] = at - 1;
        }
        if (x < W - 1 && grid[at + 1] == 0) {
            grid[at + 1] = 2;
            stack[used++] = at + 1;
        }
        if (at >= W && grid[at - W] == 0) {
            grid[at - W] = 2;
            stack[used++] = at - W;
        }
        if (at < W * (H - 1) && grid[at + W] == 0) {
            grid[at + W] = 2;
            stack[used++] = at + W;
        }
    }
    return filled;
}

int main(void)
{
    return run();
}
