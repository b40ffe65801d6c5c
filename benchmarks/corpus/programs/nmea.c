/* entry: run; inputs: line any */
#include <stdint.h>

#define LINE 82

char line[LINE] = "$GPRMC,081836,A,3751.65,S,14507.36,E,000.0,360.0,130998,011.3,E*62";

struct fix {
    uint8_t hour, minute, second, valid;
    int32_t latitude, longitude;
};

static struct fix fix;
static const char *fields[20];
static uint8_t field_count;

static int hex(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return -1;
}

static int checksum_ok(const char *text, int size)
{
    uint8_t sum = 0;
    int i = 1;

    if (text[0] != '$')
        return 0;
    while (i < size && text[i] != '*' && text[i] != '\0')
        sum ^= (uint8_t)text[i++];
    if (i + 2 >= size || text[i] != '*')
        return 0;
    return hex(text[i + 1]) == sum >> 4 && hex(text[i + 2]) == (sum & 15);
}

static void split(char *text, int size)
{
    field_count = 0;
    fields[field_count++] = text;
    for (int i = 0; i < size; i++) {
        if (text[i] == '*' || text[i] == '\0')
            break;
        if (text[i] == ',') {
            text[i] = '\0';
            if (field_count == 20)
                return;
            fields[field_count++] = &text[i + 1];
        }
    }
}

static int32_t number(const char *digits, int most)
{
    int32_t value = 0;
    while (most-- > 0 && *digits >= '0' && *digits <= '9')
        value = value * 10 + (*digits++ - '0');
    return value;
}

static int32_t angle(const char *text, char side)
{
    int32_t whole = 0, part = 0, scale = 1000;
    const char *p = text;

    while (p - text < 6 && *p >= '0' && *p <= '9')
        whole = whole * 10 + (*p++ - '0');
    if (*p == '.') {
        p++;
        while (scale && *p >= '0' && *p <= '9') {
            part += (*p++ - '0') * scale;
            scale /= 10;
        }
    }
    int32_t result = (whole / 100) * 600000 + (whole % 100) * 10000 + part;
    return side == 'S' || side == 'W' ? -result : result;
}

int run(void)
{
    line[LINE - 1] = '\0';
    if (!checksum_ok(line, LINE))
        return -1;
    split(line, LINE);
    if (field_count < 7)
        return -2;
    fix.hour = (uint8_t)number(fields[1], 2);
    fix.minute = (uint8_t)number(fields[1] + 2, 2);
    fix.second = (uint8_t)number(fields[1] + 4, 2);
    fix.valid = fields[2][0] == 'A';
    fix.latitude = angle(fields[3], fields[4][0]);
    fix.longitude = angle(fields[5], fields[6][0]);
    return fix.valid;
}

int main(void)
{
    return run();
}
