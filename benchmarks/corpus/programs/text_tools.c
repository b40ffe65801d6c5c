/* entry: run; inputs: line any */
#include <ctype.h>
#include <stdint.h>
#include <string.h>

char line[48] = "  set speed 120 ; reverse off  ";
static char copy[48];
static char *arguments[8];

static char *trim(char *s)
{
    char *end = s + strlen(s);
    while (end > s && isspace((unsigned char)end[-1]))
        end--;
    *end = '\0';
    while (isspace((unsigned char)*s))
        s++;
    return s;
}

static int split(char *s)
{
    int n = 0;
    while (*s && n < 8) {
        arguments[n++] = s;
        while (*s && *s != ' ')
            s++;
        while (*s == ' ')
            *s++ = '\0';
    }
    return n;
}

static int same(const char *a, const char *b)
{
    while (*a && tolower((unsigned char)*a) == tolower((unsigned char)*b))
        a++, b++;
    return *a == *b;
}

int run(void)
{
    static const char *const commands[] = {"get", "set", "reset", "help"};
    line[47] = '\0';
    strcpy(copy, line);
    int n = split(trim(copy));
    if (n == 0)
        return -1;
    for (unsigned i = 0; i < sizeof commands / sizeof commands[0]; i++)
        if (same(arguments[0], commands[i]))
            return (int)i << 8 | n;
    return -2;
}

int main(void)
{
    return run();
}
