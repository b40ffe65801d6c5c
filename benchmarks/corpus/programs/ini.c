/* entry: run; inputs: file any */
#include <ctype.h>
#include <stdint.h>
#include <string.h>

char file[160] = "; motor\n[motor]\nspeed=120\nlimit = 40\n\n[radio]\nchannel=11\n";

struct setting {
    const char *section, *key;
    int32_t value;
};
static struct setting settings[] = {{"motor", "speed", 10}, {"motor", "limit", 20}, {"radio", "channel", 1}};

static void store(const char *section, const char *key, int32_t value)
{
    for (unsigned i = 0; i < sizeof settings / sizeof settings[0]; i++)
        if (strcmp(settings[i].section, section) == 0 && strcmp(settings[i].key, key) == 0)
            settings[i].value = value;
}

static int word(const char *from, const char *end, char *to, int room)
{
    int n = 0;
    while (from < end && isspace((unsigned char)*from))
        from++;
    while (from < end && isalnum((unsigned char)*from) && n < room - 1)
        to[n++] = *from++;
    to[n] = '\0';
    return n;
}

int run(void)
{
    char section[12] = "", key[12];
    const char *p = file, *const end = file + sizeof file;

    while (p < end && *p) {
        const char *eol = memchr(p, '\n', (size_t)(end - p));
        if (eol == NULL)
            eol = end;
        if (*p == '[') {
            word(p + 1, eol, section, sizeof section);
        } else if (*p != ';' && word(p, eol, key, sizeof key) > 0) {
            const char *q = p;
            int32_t value = 0;
            while (q < eol && *q != '=')
                q++;
            for (q++; q < eol; q++)
                if (isdigit((unsigned char)*q))
                    value = value * 10 + *q - '0';
            store(section, key, value);
        }
        p = eol < end ? eol + 1 : end;
    }
    return settings[0].value + settings[1].value + settings[2].value;
}

int main(void)
{
    return run();
}
