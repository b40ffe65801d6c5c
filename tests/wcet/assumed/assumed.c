/* What facts can assume: arguments in registers and on the stack, numbers in memory, elements of arrays.
 *
 * arm-none-eabi-gcc -mcpu=arm7tdmi -O1 -g -nostdlib -Wl,--build-id=none -ffile-prefix-map=$PWD=. assumed.c -o arm7tdmi.elf
 * arm-none-eabi-gcc -mcpu=cortex-m3 -mthumb -O2 -g -nostdlib -Wl,--build-id=none -ffile-prefix-map=$PWD=. assumed.c \
 *     -o cortex-m3.elf
 */
#include <stdint.h>

uint8_t levels[40] = {9, 9, 9};
int16_t offsets[8];
uint32_t length = 5;
volatile int source;

int in_register(int a, int times)
{
    int s = a;
    for (int i = 0; i < times; i++) s += source;
    return s;
}

int on_stack(int a, int b, int c, int d, int times)
{
    int s = a + b + c + d;
    for (int i = 0; i < times; i++) s += source;
    return s;
}

int global(void)
{
    int s = 0;
    for (uint32_t i = 0; i < length; i++) s += source;
    return s;
}

int element(int k)
{
    int s = 0;
    for (int i = 0; i < offsets[k & 7]; i++) s += source;
    return s;
}

int byte(void)
{
    int s = 0, most = levels[2];
    for (int i = 0; i < most; i++) s += source;
    return s;
}

__attribute__((noinline)) int callee(int times) { return in_register(1, times); }

int calls_with_nine(void) { return callee(9); }

void _start(void)
{
    for (;;) source = on_stack(1, 2, 3, 4, source) + global() + element(source) + byte() + calls_with_nine();
}
