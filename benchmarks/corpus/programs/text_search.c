/* entry: run; inputs: haystack any, needle any */
#include <stdint.h>
#include <string.h>

char haystack[100] = "the motor of the other axis stops when the mother board says so";
char needle[8] = "mother";

static int prefix_search(const char *text, int n, const char *pattern, int m)
{
    uint8_t fallback[8] = {0};
    int k = 0;

    if (m == 0)
        return 0;
    for (int i = 1; i < m; i++) {
        while (k > 0 && pattern[k] != pattern[i])
            k = fallback[k - 1];
        if (pattern[k] == pattern[i])
            k++;
        fallback[i] = (uint8_t)k;
    }
    k = 0;
    for (int i = 0; i < n; i++) {
        while (k > 0 && pattern[k] != text[i])
            k = fallback[k - 1];
        if (pattern[k] == text[i])
            k++;
        if (k == m)
            return i - m + 1;
    }
    return -1;
}

static int naive_search(const char *text, int n, const char *pattern, int m)
{
    for (int at = 0; at + m <= n; at++) {
        int j = 0;
        while (j < m && text[at + j] == pattern[j])
            j++;
        if (j == m)
            return at;
    }
    return -1;
}

int run(void)
{
    haystack[99] = '\0';
    needle[7] = '\0';
    int n = (int)strlen(haystack), m = (int)strlen(needle);
    int a = prefix_search(haystack, n, needle, m);
    return a == naive_search(haystack, n, needle, m) ? a : -2;
}

int main(void)
{
    return run();
}
