/* Loops whose number of passes follows from counters: widths, signs, steps, rotation, memory, 64 bits. */
#include <stdint.h>
#define P __attribute__((noinline, used))
#define CLAMP(n, most) if ((n) > (most)) (n) = (most)

P uint32_t u8_argument(const uint8_t *a, uint8_t n) { uint32_t s = 0; for (uint8_t i = 0; i < n; i++) s += a[i]; return s; }
P uint32_t u16_argument(const uint8_t *a, uint16_t n) { uint32_t s = 0; for (uint16_t i = 0; i < n; i++) s += a[i & 63]; return s; }
P uint32_t u8_down(const uint8_t *a, uint8_t n) { uint32_t s = 0; while (n--) s += *a++; return s; }
P uint32_t i8_argument(const uint8_t *a, int8_t n) { uint32_t s = 0; for (int8_t i = 0; i < n; i++) s += a[i]; return s; }
P int32_t clamped(const int32_t *a, int32_t n) { CLAMP(n, 100); int32_t s = 0; for (int32_t i = 0; i < n; i++) s += a[i]; return s; }
P int32_t masked(const int32_t *a, uint32_t n) { int32_t s = 0; for (uint32_t i = 0; i < (n & 31); i++) s += a[i]; return s; }
P int32_t variable_step(const int32_t *a, int32_t n, int32_t k) { int32_t s = 0; if (k < 1) k = 1; CLAMP(n, 200); for (int32_t i = 0; i < n; i += k) s += a[i]; return s; }
P int32_t data_step(const uint8_t *a) { int32_t s = 0; for (int32_t i = 0; i < 120; i += 1 + (a[i] & 7)) s ^= a[i]; return s; }
P int32_t down_subs(const int32_t *a) { int32_t s = 0, n = 37; do { s += *a++; } while (--n); return s; }
P int32_t down_three(const int32_t *a) { int32_t s = 0; for (int32_t i = 99; i >= 0; i -= 3) s += a[i]; return s; }
P int32_t pointer_end(const int32_t *a) { int32_t s = 0; for (const int32_t *p = a, *e = a + 40; p != e; p++) s += *p; return s; }
P int32_t pointer_end_n(const int32_t *a, uint32_t n) { CLAMP(n, 48); int32_t s = 0; const int32_t *e = a + n; while (a < e) s += *a++; return s; }
P int32_t wide_counter(const int32_t *a, uint32_t n) { CLAMP(n, 50); int32_t s = 0; for (uint64_t i = 0; i < n; i++) s += a[i]; return s; }
P int32_t wide_constant(const int32_t *a) { int32_t s = 0; for (int64_t i = 0; i < 60; i++) s += a[i]; return s; }
P int32_t wide_down(const int32_t *a) { int32_t s = 0; for (int64_t i = 45; i > 0; i--) s += a[i]; return s; }
P int32_t wide_volume(uint32_t x) { int32_t s = 0; uint64_t acc = x; while (acc < 0x1000000000ull) { acc = acc * 2 + 1; s++; } return s; }
P int32_t two_indices(const int32_t *a, int32_t x) { int32_t lo = 0, hi = 63; while (lo < hi) { if (a[lo] + a[hi] < x) lo++; else hi--; } return lo; }
P int32_t reverse(int32_t *a, int32_t n) { CLAMP(n, 64); int32_t i = 0, j = n - 1; while (i < j) { int32_t t = a[i]; a[i++] = a[j]; a[j--] = t; } return 0; }
P int32_t early_exit(const int32_t *a, int32_t x) { for (int32_t i = 0; i < 64; i++) if (a[i] == x) return i; return -1; }
P int32_t two_limits(const uint8_t *a, int32_t n) { CLAMP(n, 80); int32_t i = 0; while (i < n && a[i] && a[i] != 7) i++; return i; }
P int32_t duff(uint8_t *to, const uint8_t *from, uint32_t count) {
    CLAMP(count, 60); if (!count) return 0;
    uint32_t n = (count + 7) / 8;
    switch (count % 8) { case 0: do { *to++ = *from++; case 7: *to++ = *from++; case 6: *to++ = *from++; case 5: *to++ = *from++; case 4: *to++ = *from++;
    case 3: *to++ = *from++; case 2: *to++ = *from++; case 1: *to++ = *from++; } while (--n > 0); }
    return 0;
}
static uint32_t budget; static struct { uint16_t left; uint8_t used; int32_t log[8]; } counters_in_memory;
P int32_t global_counter(const int32_t *a) { int32_t s = 0; for (budget = 30; budget > 0; budget--) s += a[budget]; return s; }
P int32_t struct_counter(const int32_t *a) { counters_in_memory.left = 25; int32_t s = 0; while (counters_in_memory.left) { s += a[counters_in_memory.left]; counters_in_memory.left--; } return s; }
struct cursor { const uint8_t *at; int32_t left; uint32_t sum; };
P int32_t cursor_field(struct cursor *c) { c->left = 40; while (c->left > 0) { c->sum += 3; c->left--; } return 0; }
P int32_t cursor_clamped(struct cursor *c) { CLAMP(c->left, 40); while (c->left > 0) { c->sum += c->left; c->left -= 2; } return 0; }
P void touch(uint32_t *x) { *x += 1; }
P int32_t across_calls(uint32_t *x) { int32_t i; for (i = 0; i < 33; i++) touch(x); return i; }
P int32_t address_taken(void) { uint32_t sum = 0; for (uint32_t i = 0; i < 21; i++) touch(&sum); return sum; }
P float float_inside(const float *a) { float s = 0; for (int32_t i = 0; i < 32; i++) s = s * 0.5f + a[i]; return s; }
P double double_inside(const float *a) { double s = 0; int32_t i = 28; while (i-- > 0) s = s / 1.5 + a[i]; return s; }
P float float_counter(float x) { float t = 0; int32_t n = 0; for (float f = 0.0f; f < 10.0f && n < 50; f += 0.25f, n++) t += f * x; return t; }
P int32_t ring(const int32_t *a, uint32_t head) { int32_t s = 0; head &= 15; for (int32_t k = 0; k < 16; k++) { s += a[head]; head = (head + 1) & 15; } return s; }
P int32_t ring_until(const int32_t *a, uint32_t head, uint32_t tail) { int32_t s = 0; head &= 15; tail &= 15; while (head != tail) { s += a[head]; head = (head + 1) & 15; } return s; }
P int32_t ring_reset(const int32_t *a, uint32_t head, uint32_t tail) { int32_t s = 0; head %= 20; tail %= 20; while (head != tail) { s += a[head]; if (++head == 20) head = 0; } return s; }
P int32_t ring_modulo(const int32_t *a, uint32_t head, uint32_t tail) { int32_t s = 0; head %= 20; tail %= 20; while (head != tail) { s += a[head]; head = (head + 1) % 20; } return s; }
P int32_t retry(volatile int32_t *port) { int32_t tries = 0; while (*port != 3 && tries < 12) tries++; return tries; }
P int32_t retry_down(volatile int32_t *port) { uint8_t left = 12; do { if (*port == 3) break; } while (--left); return left; }
P int32_t flagged(const int32_t *a) { int32_t done = 0, i = 0; while (!done) { i++; if (a[i] == 5 || i >= 40) done = 1; } return i; }
P int32_t both_ways(const int32_t *a) { int32_t n = 50, s = 0; for (;;) { if (n <= 0) break; if (a[n] & 1) n -= 2; else n -= 1; s++; } return s; }
P int32_t shared(const int32_t *a) { int32_t i = 0, s = 0; while (i < 90) { if (a[i] > 3) { s++; i += 3; } else if (a[i] > 1) { i += 2; s += 2; } else { i++; } } return s; }
P int32_t overflow_safe(int32_t from, int32_t to) { int32_t s = 0; if (to - from > 30 || to < from || from < -1000 || to > 1000) return 0; for (int32_t i = from; i <= to; i++) s += i; return s; }
P int32_t window(const int32_t *a, int32_t at) { int32_t s = 0; if (at < 3) at = 3; if (at > 60) at = 60; for (int32_t i = at - 3; i <= at + 3; i++) s += a[i]; return s; }
P int32_t window_any(uint32_t at, uint32_t n) { int32_t s = 0; n &= 15; for (uint32_t i = at; i != at + n; i++) s += i * 7; return s; }
