/* entry: run; inputs: array any, size 0..48 */
#include <stdint.h>
#include <string.h>

int32_t array[48] = {38, 27, 43, 3, 9, 82, 10, -5, 14, 0, 61};
uint32_t size = 11;
static int32_t buffer[48];

static void merge(uint32_t from, uint32_t middle, uint32_t to)
{
    uint32_t i = from, j = middle;
    for (uint32_t k = from; k < to; k++) {
        if (i < middle && (j >= to || array[i] <= array[j]))
            buffer[k] = array[i++];
        else
            buffer[k] = array[j++];
    }
}

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

int run(void)
{
    for (uint32_t width = 1; width < size; width *= 2) {
        for (uint32_t at = 0; at < size; at += 2 * width)
            merge(at, least(at + width, size), least(at + 2 * width, size));
        memcpy(array, buffer, size * sizeof array[0]);
    }
    return array[0];
}

int main(void)
{
    return run();
}
