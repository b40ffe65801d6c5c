/* entry: run; inputs: text each 1B 40..57 */
#include <stdint.h>
char text[24] = "(1+2)*(3-(4/2))";
static const char *p;
static int depth;
static int sum(void);
static int atom(void)
{
    if (*p == '(' && depth < 4) {
        depth++; p++;
        int v = sum();
        depth--;
        if (*p == ')') p++;
        return v;
    }
    int v = 0;
    while (*p >= '0' && *p <= '9' && p < text + 23) v = v * 10 + *p++ - '0';
    return v;
}
static int product(void)
{
    int v = atom();
    while ((*p == '*' || *p == '/') && p < text + 23) { char c = *p++; int w = atom(); v = c == '*' ? v * w : w ? v / w : 0; }
    return v;
}
static int sum(void)
{
    int v = product();
    while ((*p == '+' || *p == '-') && p < text + 23) { char c = *p++; int w = product(); v = c == '+' ? v + w : v - w; }
    return v;
}
int run(void) { text[23] = 0; p = text; depth = 0; return sum(); }
int main(void) { return run(); }
