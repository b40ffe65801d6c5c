/* entry: run; inputs: now each 1B 0..255, mask 0..127 */
#include <stdint.h>

/* A clock chip with two decimal digits per byte: checked, advanced by a second, next alarm by day of the week. */
enum { SECOND, MINUTE, HOUR, WEEKDAY, DAY, MONTH, YEAR, FIELDS };

uint8_t now[FIELDS] = {0x59, 0x59, 0x23, 5, 0x28, 0x02, 0x24};
uint8_t mask = 0x22;

static int from_bcd(uint8_t b)
{
    return (b >> 4) < 10 && (b & 15) < 10 ? (b >> 4) * 10 + (b & 15) : -1;
}

static uint8_t to_bcd(int n)
{
    uint8_t tens = 0;
    while (n >= 10) {
        n -= 10;
        tens++;
    }
    return (uint8_t)(tens << 4 | n);
}

static int month_days(int month, int year)
{
    switch (month) {
    case 2:
        return year % 4 == 0 ? 29 : 28;
    case 4:
    case 6:
    case 9:
    case 11:
        return 30;
    default:
        return 31;
    }
}

static int advance(uint8_t *t)
{
    static const uint8_t least[FIELDS] = {0, 0, 0, 1, 1, 1, 0}, most[FIELDS] = {59, 59, 23, 7, 31, 12, 99};
    int v[FIELDS];

    for (int i = 0; i < FIELDS; i++) {
        v[i] = from_bcd(t[i]);
        if (v[i] < least[i] || v[i] > most[i])
            return -1 - i;
    }
    for (int i = SECOND; i < FIELDS; i++) {
        int end = i == DAY ? month_days(v[MONTH], v[YEAR]) : most[i];
        if (i == WEEKDAY) {
            v[i] = v[i] % 7 + 1;
            continue;
        }
        if (++v[i] <= end)
            break;
        v[i] = least[i];
    }
    for (int i = FIELDS - 1; i >= 0; --i)
        t[i] = to_bcd(v[i]);
    return 0;
}

int run(void)
{
    int status = advance(now);
    if (status < 0)
        return status;
    int day = from_bcd(now[WEEKDAY]) - 1, wait = 0;
    if (mask == 0)
        return 0x7F;
    while (!(mask >> day & 1)) {
        day = day == 6 ? 0 : day + 1;
        wait++;
    }
    uint32_t total = 0;
    for (int month = 1; month < from_bcd(now[MONTH]); month++)
        total += (uint32_t)month_days(month, from_bcd(now[YEAR]));
    return (int)(total << 8) | wait;
}

int main(void)
{
    return run();
}
