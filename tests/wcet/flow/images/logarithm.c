/* arm-none-eabi-gcc -mcpu=arm7tdmi|cortex-m3 -marm|-mthumb -O2 -fno-builtin -nostartfiles -Wl,-Ttext=0x8000 -Wl,-S \
   logarithm.c -lm -o logarithm-CORE.elf */
#include <math.h>

volatile double value;

double logarithm(double x) { return log(x); }

void _start(void) { value = logarithm(value); }
