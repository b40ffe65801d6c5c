/* Walks to the end of a string, and loops as long as one is: what ends them, and what only seems to. */
#include <stddef.h>
#include <stdint.h>

#define N 24
char text[N] = "  12 left, 7 right";
static char copy[N + 1];
size_t strlen(const char *s);

/* Two loops, the second from where the first ends. */
int digits(void)
{
    const char *p = text;
    int sum = 0;
    text[N - 1] = 0;
    while (*p == ' ')
        p++;
    while (*p >= '0' && *p <= '9')
        sum = sum * 10 + *p++ - '0';
    return sum;
}

/* Stores on the way, elsewhere; an escape takes two bytes, both of which are looked at. */
int unescape(void)
{
    int n = 0;
    text[N - 1] = 0;
    for (int i = 0; text[i]; i++) {
        if (text[i] == '\\' && text[i + 1])
            i++;
        copy[n++] = text[i];
    }
    return n;
}

/* As many passes as a string is long, by the library's strlen. */
int pairs(void)
{
    int n, found = 0;
    text[N - 1] = 0;
    n = (int)strlen(text);
    for (int i = 0; i < n; i++)
        for (int k = i + 1; k < n; k++)
            found += text[i] == text[k];
    return found;
}

/* Two bytes at a time, one of which is looked at: this may pass the end by. */
int hasty(void)
{
    const char *p = text;
    text[N - 1] = 0;
    while (*p && p < text + 1000)
        p += 2;
    return (int)(p - text);
}

/* The end is there at the start of every pass, and not where it is looked at. */
int restored(void)
{
    int n = 0;
    for (const char *p = text;; p++, n++) {
        text[N - 1] = 'x';
        if (!*(volatile const char *)p || n > 100)
            break;
        text[N - 1] = 0;
    }
    return n;
}

/* The end is overwritten on the way. */
int erased(void)
{
    const char *p = text;
    text[N - 1] = 0;
    while (*p && p < text + 300) {
        text[N - 1] = 'y';
        p++;
    }
    return (int)(p - text);
}

/* Stores go over the end, a byte ahead of what is looked at. */
int overrun(void)
{
    static char both[8 + N + 300];
    char *in = both + 8;
    int i = 0;
    for (int k = 0; k < N; k++)
        in[k] = text[k];
    in[N - 1] = 0;
    while (in[i] && i < 200) {
        in[i + 1] = 'z';
        i++;
    }
    return i;
}

int main(void)
{
    return overrun() + digits() + unescape() + pairs() + hasty() + restored() + erased();
}
