/* entry: run; inputs: seconds any */
#include <stdint.h>

struct date {
    uint16_t year;
    uint8_t month, day, hour, minute, second, weekday;
};

uint32_t seconds = 1700000000u;
static struct date date;

static int leap(unsigned year)
{
    return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
}

int run(void)
{
    static const uint8_t lengths[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    uint32_t days = seconds / 86400, rest = seconds % 86400;

    date.hour = (uint8_t)(rest / 3600);
    date.minute = (uint8_t)(rest / 60 % 60);
    date.second = (uint8_t)(rest % 60);
    date.weekday = (uint8_t)((days + 4) % 7);
    date.year = 1970;
    while (days >= (leap(date.year) ? 366u : 365u)) {
        days -= leap(date.year) ? 366u : 365u;
        date.year++;
    }
    for (date.month = 0; date.month < 12; date.month++) {
        uint8_t length = lengths[date.month];
        if (date.month == 1 && leap(date.year))
            length++;
        if (days < length)
            break;
        days -= length;
    }
    date.day = (uint8_t)(days + 1);
    return date.year * 10000 + (date.month + 1) * 100 + date.day;
}

int main(void)
{
    return run();
}
