/* entry: run; inputs: rates any */
#include <math.h>

#define N 12
struct quaternion {
    float w, x, y, z;
};
float rates[N][3] = {{0.1f, 0, 0}, {0, 0.2f, 0}, {0, 0, -0.3f}, {1, 1, 1}};
static struct quaternion attitude = {1, 0, 0, 0};

static struct quaternion multiply(struct quaternion a, struct quaternion b)
{
    struct quaternion r;
    r.w = a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z;
    r.x = a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y;
    r.y = a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x;
    r.z = a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w;
    return r;
}

static void normalise(struct quaternion *q)
{
    float n = sqrtf(q->w * q->w + q->x * q->x + q->y * q->y + q->z * q->z);
    if (!(n > 1e-6f)) {
        *q = (struct quaternion){1, 0, 0, 0};
        return;
    }
    q->w /= n;
    q->x /= n;
    q->y /= n;
    q->z /= n;
}

int run(void)
{
    for (int i = 0; i < N; i++) {
        struct quaternion half = {1, 0.005f * rates[i][0], 0.005f * rates[i][1], 0.005f * rates[i][2]};
        attitude = multiply(attitude, half);
        normalise(&attitude);
    }
    return attitude.w > 0.5f;
}

int main(void)
{
    return run();
}
