/* entry: run; inputs: subject any */
#include <stdint.h>

/* Small regular expressions (. * ^ $ and letters) by recursion over constant patterns, and globs by backtracking. */
char subject[40] = "temp=21.5;mode=auto;err=0";
static const char *const expressions[] = {"^temp", "mo.e=a*u", "r=0$", "x*;e"};
static const char *const globs[] = {"temp*", "*auto*", "?em*err=?"};

static int here(const char *re, const char *text);

static int star(char c, const char *re, const char *text)
{
    do {
        if (here(re, text))
            return 1;
    } while (*text != '\0' && (*text++ == c || c == '.'));
    return 0;
}

static int here(const char *re, const char *text)
{
    if (re[0] == '\0')
        return 1;
    if (re[1] == '*')
        return star(re[0], re + 2, text);
    if (re[0] == '$' && re[1] == '\0')
        return *text == '\0';
    if (*text != '\0' && (re[0] == '.' || re[0] == *text))
        return here(re + 1, text + 1);
    return 0;
}

static int match(const char *re, const char *text)
{
    if (re[0] == '^')
        return here(re + 1, text);
    do {
        if (here(re, text))
            return 1;
    } while (*text++ != '\0');
    return 0;
}

static int glob(const char *g, const char *s)
{
    const char *mark = 0, *resume = 0;

    while (*s) {
        if (*g == '*') {
            mark = ++g;
            resume = s;
        } else if (*g == '?' || *g == *s) {
            g++;
            s++;
        } else if (mark) {
            g = mark;
            s = ++resume;
        } else {
            return 0;
        }
    }
    while (*g == '*')
        g++;
    return *g == '\0';
}

int run(void)
{
    int found = 0;
    subject[sizeof subject - 1] = '\0';
    for (unsigned i = 0; i < sizeof expressions / sizeof *expressions; i++)
        found = found << 1 | match(expressions[i], subject);
    for (unsigned i = 0; i < sizeof globs / sizeof *globs; i++)
        found = found << 1 | glob(globs[i], subject);
    return found;
}

int main(void)
{
    return run();
}
