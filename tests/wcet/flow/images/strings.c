/* arm-none-eabi-gcc -mcpu=cortex-m3 -mthumb -O2 -fno-builtin -nostartfiles -Wl,-Ttext=0x8000 -Wl,-S \
   strings.c -o strings-cortex-m3.elf */
#include <stdlib.h>
#include <string.h>

volatile int out;
char name[32];

int parse(const char *line)
{
    int n = (int)strlen(line);
    if (line[0] == '$')
        n += atoi(line + 4);
    return n;
}

int copies(char *to, const char *from)
{
    strcpy(to, from);
    return strcmp(to, name);
}

int breaks(char *line)
{
    line[3] = 'x';
    return (int)strlen(line);
}

int keeps(char *line)
{
    line[3] = 0;
    return (int)strlen(line);
}

int appends(char *to, const char *from)
{
    strcat(to, from);
    return 1;
}

int local(int k)
{
    char buffer[24];
    buffer[k & 15] = 1;
    buffer[23] = 0;
    return (int)strlen(buffer);
}

int global(void) { return (int)strlen(name); }

void _start(void)
{
    out = parse(name) + copies(name, name) + breaks(name) + keeps(name) + appends(name, name) + local(out) + global();
}
