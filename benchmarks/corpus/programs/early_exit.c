/* entry: run; inputs: grid each 1B 0..9, want 0..30 */
#include <stdint.h>
uint8_t grid[8][8] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
uint8_t want = 17;
static int found_x, found_y, tries;
static int probe(int x, int y) { tries++; return grid[y][x] + grid[x][y] == want ? 2 : grid[y][x] == 9; }
int run(void)
{
    int x, y, r = 0;
    for (y = 0; y < 8; y++) {
        for (x = 0; x < 8; x++) {
            if (y > x) {
                for (int k = y; k > x; k--)
                    if ((r = probe(k - 1, y)) > 1) goto done;
                continue;
            }
            r = probe(x, y);
            if (r == 2) goto done;
            if (r == 1) goto next_row;
        }
    next_row:;
    }
    return -tries;
done:
    found_x = x; found_y = y;
    return tries * 64 + x * 8 + y;
}
int main(void) { return run(); }
