/* entry: run; inputs: line any */
#include <stdint.h>
char line[65] = "x1 = 12 + foo(3, \"a b\") ; // rest";
static uint16_t names, numbers, strings, others;
int run(void)
{
    const char *p = line;
    line[64] = 0;
start:
    switch (*p) {
    case 0: goto end;
    case ' ': case '\t': p++; goto start;
    case '"': p++; goto string;
    case '/': if (p[1] == '/') goto end; goto other;
    default: break;
    }
    if (*p >= '0' && *p <= '9') goto number;
    if ((*p | 32) >= 'a' && (*p | 32) <= 'z') goto name;
other:
    others++; p++; goto start;
number:
    p++;
    if (*p >= '0' && *p <= '9') goto number;
    if (*p == '.') goto number;
    numbers++;
    if ((*p | 32) >= 'a' && (*p | 32) <= 'z') goto name_more;
    goto start;
name:
    names++;
name_more:
    p++;
    if ((*p | 32) >= 'a' && (*p | 32) <= 'z') goto name_more;
    if (*p >= '0' && *p <= '9') goto number;
    goto start;
string:
    if (*p == 0) goto end;
    if (*p == '\\' && p[1]) { p += 2; goto string; }
    if (*p++ != '"') goto string;
    strings++;
    goto start;
end:
    return names | numbers << 8 | strings << 12 | others;
}
int main(void) { return run(); }
