/* entry: run; inputs: incoming any, received 0..40, drain 0..20 */
#include <stdbool.h>
#include <stdint.h>

#define SIZE 32
struct ring {
    uint8_t data[SIZE];
    volatile uint8_t head, tail;
};

uint8_t incoming[40] = "0123456789abcdefghijklmnopqrstuvwxyz";
uint8_t received = 36, drain = 12;
static struct ring uart = {.head = 5, .tail = 5};
static uint16_t lost;

static bool put(struct ring *r, uint8_t byte)
{
    uint8_t next = (r->head + 1) & (SIZE - 1);
    if (next == r->tail)
        return false;
    r->data[r->head] = byte;
    r->head = next;
    return true;
}

static int get(struct ring *r)
{
    if (r->head == r->tail)
        return -1;
    uint8_t byte = r->data[r->tail];
    r->tail = (r->tail + 1) & (SIZE - 1);
    return byte;
}

int run(void)
{
    int sum = 0, byte;

    for (uint8_t i = 0; i < received; i++)
        if (!put(&uart, incoming[i]))
            lost++;
    for (uint8_t i = 0; i < drain; i++) {
        byte = get(&uart);
        if (byte < 0)
            break;
        sum += byte;
    }
    while ((byte = get(&uart)) >= 0)
        sum ^= byte;
    return sum + lost;
}

int main(void)
{
    return run();
}
