/* Loops and branches that single-precision numbers decide: what a run knows of an FPU's registers. */

#include <stdint.h>

static volatile float inputs[6] = {2.0f, 9.75f, 1.0e-3f, 40.0f, 0.6f, 1234.5f};
int32_t results[32];
float samples[24];

/* Newton's iteration: as many steps as the number needs. */
__attribute__((noinline)) float root(float x, float eps)
{
    float guess = x > 1.0f ? x : 1.0f;
    while (__builtin_fabsf(guess * guess - x) > eps * x)
        guess = 0.5f * (guess + x / guess);
    return guess;
}

/* A number that becomes the bound of a loop. */
__attribute__((noinline)) int triangle(float height)
{
    int rows = (int)(height * 1.25f), sum = 0;
    for (int i = 0; i < rows; i++)
        sum += i ^ rows;
    return sum;
}

/* Halving until nothing is left: goes through the subnormal numbers. */
__attribute__((noinline)) int halvings(float x)
{
    int count = 0;
    while (x > 0.0f) {
        x *= 0.5f;
        count++;
    }
    return count;
}

/* Integers kept in FPU registers across a call, as compilers spill; a comparison with a NaN is never true. */
__attribute__((noinline)) int kept(int n, float zero)
{
    int sum = 0;
    float nan = zero / zero;
    for (int i = 0; i < n; i++) {
        register float keep __asm__("s16");
        __asm__ volatile("vmov %0, %1" : "=t"(keep) : "r"(i));
        sum += triangle((float)n);
        int back;
        __asm__ volatile("vmov %0, %1" : "=r"(back) : "t"(keep));
        i = back;
        while (nan < (float)i)
            sum++;
    }
    return sum;
}

/* Values in arrays and structs, moved in pairs; a filter that settles. */
__attribute__((noinline)) int settles(float target)
{
    float state[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    int steps = 0;
    while (state[3] < 0.99f * target && steps < 500) {
        state[0] += 0.3f * (target - state[0]);
        for (int i = 1; i < 4; i++)
            state[i] += 0.5f * (state[i - 1] - state[i]);
        steps++;
    }
    return steps;
}

/* Sorted by the numbers' order. */
__attribute__((noinline)) void sort(float *data, int n)
{
    for (int i = 1; i < n; i++) {
        float moved = data[i];
        int j = i;
        while (j > 0 && data[j - 1] > moved) {
            data[j] = data[j - 1];
            j--;
        }
        data[j] = moved;
    }
}

int main(void)
{
    int at = 0;
    for (int i = 0; i < 6; i++) {
        float root_of = root(inputs[i], 1.0e-5f);
        results[at++] = (int32_t)(root_of * 256.0f);
        results[at++] = triangle(root_of);
        results[at++] = settles(inputs[i]);
    }
    results[at++] = halvings(inputs[1]);
    results[at++] = kept((int)inputs[0] + 3, inputs[2] - inputs[2]);
    float x = inputs[4];
    for (int i = 0; i < 24; i++) {
        x = 3.9f * x * (1.0f - x);
        samples[i] = (float)(uint32_t)(x * 4096.0f) * 0.125f - 100.0f;
    }
    sort(samples, 24);
    return results[0] + (int)samples[3];
}
