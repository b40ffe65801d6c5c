/* A program that starts with known data and computes on: everything its run needs to show. See test_run.py. */
#include <stdint.h>
#include <string.h>

#define DEVICE (*(volatile uint32_t *)0x70001000)

static int32_t words[48];
static uint8_t bytes[64];
static uint32_t seed = 7;
int32_t result;
static int32_t (*handlers[3])(int32_t);
struct node { struct node *next; int32_t value; };
static struct node third = {0, 30}, second = {&third, 20}, first = {&second, 10};
static const char *const names[] = {"one", "three", "seventeen"};

static uint32_t random_word(void) { seed = seed * 1103515245u + 12345u; return seed >> 16; }
static int32_t twice(int32_t x) { return x * 2; }
static int32_t count_down(int32_t x) { int32_t n = 0; while (x > 0) { x -= 3; n++; } return n; }
static int32_t minus(int32_t x) { return -x; }
static int32_t fibonacci(int32_t n) { return n < 2 ? n : fibonacci(n - 1) + fibonacci(n - 2); }

static void fill(void) {
    for (int32_t i = 0; i < 48; i++) words[i] = (int32_t)(random_word() % 1000);
    for (int32_t i = 0; i < 64; i++) bytes[i] = (uint8_t)(i * 7);
    handlers[0] = twice; handlers[1] = count_down; handlers[2] = minus;
}

static void sort(int32_t *a, int32_t n) {
    for (int32_t i = 1; i < n; i++) {
        int32_t x = a[i], j = i;
        while (j > 0 && a[j - 1] > x) { a[j] = a[j - 1]; j--; }
        a[j] = x;
    }
}

static int32_t find(int32_t x) {
    int32_t low = 0, high = 47;
    while (low <= high) { int32_t m = (low + high) / 2; if (words[m] == x) return m; if (words[m] < x) low = m + 1; else high = m - 1; }
    return -1;
}

static int32_t state_machine(void) {
    int32_t state = 0, out = 0;
    for (int32_t i = 0; i < 64; i++)
        switch (state) {
        case 0: state = bytes[i] & 1 ? 3 : 1; break;
        case 1: out += 5; state = 2; break;
        case 2: out ^= bytes[i]; state = bytes[i] & 4 ? 4 : 0; break;
        case 3: out -= 2; state = 2; break;
        case 4: out <<= 1; state = 5; break;
        case 5: out += 9; state = 0; break;
        default: return -1;
        }
    return out;
}

static float mean(void) { float s = 0; for (int32_t i = 0; i < 12; i++) s += (float)words[i] * 0.5f; while (s > 9.0f) s /= 3.0f; return s; }

static int32_t device(void) {
    /* What the device says is unknown: both ways are followed, and every number of rounds up to nine. */
    int32_t n = 0;
    if (DEVICE & 1) n = count_down(12); else n = minus(30);
    for (int32_t i = 0; i < 9; i++) { if (DEVICE == 5) break; n += (int32_t)(DEVICE & 3); }
    switch (DEVICE & 7) { case 0: n++; break; case 1: n += count_down(6); break; case 2: n--; break; case 3: n *= 3; break; case 4: n = 1; break; default: break; }
    return n;
}

void _exit(int number) { (void)number; for (;;) {} } /* the C library asks for it */

int main(void) {
    int32_t copy[48], total = 0;
    fill();
    memcpy(copy, words, sizeof copy);
    sort(words, 48);
    sort(copy + 3, 20);
    for (int32_t i = 0; i < 10; i++) total += find(words[i * 3]) + find(i);
    for (int32_t i = 0; i < 6; i++) total += handlers[i % 3](i + 4);
    for (const struct node *n = &first; n; n = n->next) total += n->value;
    for (int32_t i = 0; i < 3; i++) total += (int32_t)strlen(names[i]);
    total += fibonacci(7) + state_machine() + (int32_t)mean() + device();
    total += (int32_t)(((uint64_t)(uint32_t)total * 12345u) >> 20) / (words[40] + 1);
    result = total;
    return total;
}
