/* entry: run; inputs: line any */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* A console: words by strtok, numbers by strtol, commands by a table of names and functions. */
char line[64] = "move 120 -0x10 fast";
static int32_t position, speed;

static int move(int argc, char **argv)
{
    if (argc < 3)
        return -1;
    position += strtol(argv[1], 0, 0);
    speed = strtol(argv[2], 0, 0);
    return 0;
}

static int stop(int argc, char **argv)
{
    (void)argv;
    speed = 0;
    return argc;
}

static int echo(int argc, char **argv)
{
    int n = 0;
    while (--argc > 0)
        n += (int)strlen(*++argv);
    return n;
}

static const struct command {
    const char *name;
    int (*run)(int argc, char **argv);
} commands[] = {{"move", move}, {"stop", stop}, {"echo", echo}, {0, 0}};

int run(void)
{
    char *words[8];
    int n = 0;

    line[sizeof line - 1] = '\0';
    for (char *w = strtok(line, " \t"); w && n < 8; w = strtok(0, " \t"))
        words[n++] = w;
    if (!n)
        return 0;
    for (const struct command *c = commands; c->name; c++)
        if (strcmp(c->name, words[0]) == 0)
            return c->run(n, words);
    return -2;
}

int main(void)
{
    return run();
}
