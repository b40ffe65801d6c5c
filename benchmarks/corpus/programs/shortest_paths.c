/* entry: run; inputs: weights each 1B 0..50, origin 0..8 */
#include <stdint.h>

#define N 9
#define FAR 0xFFFF

uint8_t weights[N][N] = {{0, 4, 0, 0, 0, 0, 0, 8, 0}, {4, 0, 8, 0, 0, 0, 0, 11, 0}, {0, 8, 0, 7, 0, 4, 0, 0, 2}};
uint8_t origin = 0;
static uint16_t distance[N];
static uint16_t all[N][N];

static void from_one(uint8_t source)
{
    uint8_t done[N] = {0};
    for (int i = 0; i < N; i++)
        distance[i] = FAR;
    distance[source] = 0;
    for (;;) {
        int best = -1;
        for (int i = 0; i < N; i++)
            if (!done[i] && distance[i] != FAR && (best < 0 || distance[i] < distance[best]))
                best = i;
        if (best < 0)
            break;
        done[best] = 1;
        for (int k = 0; k < N; k++) {
            uint8_t w = weights[best][k];
            if (w && distance[best] + w < distance[k])
                distance[k] = distance[best] + w;
        }
    }
}

static void between_all(void)
{
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            all[i][j] = i == j ? 0 : weights[i][j] ? weights[i][j] : FAR / 2;
    for (int k = 0; k < N; k++)
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++)
                if (all[i][k] + all[k][j] < all[i][j])
                    all[i][j] = all[i][k] + all[k][j];
}

int run(void)
{
    from_one(origin);
    between_all();
    int wrong = 0;
    for (int i = 0; i < N; i++)
        wrong += distance[i] != FAR && distance[i] != all[origin][i];
    return wrong;
}

int main(void)
{
    return run();
}
