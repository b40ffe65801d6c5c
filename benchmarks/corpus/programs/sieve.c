/* entry: run; inputs: top 2..500 */
#include <stdint.h>
#include <string.h>

uint16_t top = 300;
static uint8_t composite[501];

int run(void)
{
    int primes = 0;
    memset(composite, 0, sizeof composite);
    for (uint16_t i = 2; i * i <= top; i++) {
        if (composite[i])
            continue;
        for (uint16_t k = i * i; k <= top; k += i)
            composite[k] = 1;
    }
    for (uint16_t i = 2; i <= top; i++)
        primes += !composite[i];
    return primes;
}

int main(void)
{
    return run();
}
