/* entry: run; inputs: source any */
#include <stdint.h>

enum kind { OBJECT, ARRAY, STRING, NUMBER, WORD };
struct token {
    uint8_t kind, depth;
    uint8_t start, end;
};

char source[120] = "{\"id\": 17, \"axes\": [1, -2.5, 3e2], \"ok\": true, \"name\": \"a\\\"b\"}";
static struct token tokens[24];

static int is_delimiter(char c)
{
    return c == ',' || c == ']' || c == '}' || c == ':' || c == ' ' || c == '\n' || c == '\0';
}

static int tokenize(const char *js, int length)
{
    int used = 0, depth = 0, at = 0;

    while (at < length && js[at] != '\0') {
        struct token *t = &tokens[used];
        char c = js[at];
        if (c == ' ' || c == ',' || c == ':' || c == '\n' || c == '\t') {
            at++;
            continue;
        }
        if (c == '}' || c == ']') {
            if (--depth < 0)
                return -1;
            at++;
            continue;
        }
        if (used == 24)
            return -2;
        t->depth = (uint8_t)depth;
        t->start = (uint8_t)at;
        switch (c) {
        case '{':
        case '[':
            t->kind = c == '{' ? OBJECT : ARRAY;
            depth++;
            at++;
            break;
        case '"':
            t->kind = STRING;
            for (at++; at < length && js[at] != '"'; at++)
                if (js[at] == '\\')
                    at++;
            at++;
            break;
        default:
            t->kind = (c >= '0' && c <= '9') || c == '-' ? NUMBER : WORD;
            while (at < length && !is_delimiter(js[at]))
                at++;
            break;
        }
        t->end = (uint8_t)at;
        used++;
    }
    return depth == 0 ? used : -3;
}

int run(void)
{
    return tokenize(source, sizeof source);
}

int main(void)
{
    return run();
}
