/* arm-none-eabi-gcc -mcpu=cortex-m3 -mthumb -O2 -fno-builtin -nostartfiles -Wl,-Ttext=0x8000 -Wl,-S \
   angle.c -lm -o angle-cortex-m3.elf */
#include <math.h>

volatile double value;

double angle(double x) { return 2.0 * sin(x); }

void _start(void) { value = angle(value); }
