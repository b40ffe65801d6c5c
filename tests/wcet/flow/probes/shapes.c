/* Loops whose number of passes follows from the shape of what they do: halving, doubling, bits, division, searches. */
#include <stdint.h>
#define P __attribute__((noinline, used))
#define CLAMP(n, most) if ((n) > (most)) (n) = (most)

P int32_t search(const int32_t *a, int32_t x) { int32_t lo = 0, hi = 63; while (lo <= hi) { int32_t m = (lo + hi) / 2; if (a[m] == x) return m; if (a[m] < x) lo = m + 1; else hi = m - 1; } return -1; }
P int32_t search_half(const int32_t *a, int32_t x) { uint32_t lo = 0, hi = 64; while (lo < hi) { uint32_t m = lo + (hi - lo) / 2; if (a[m] < x) lo = m + 1; else hi = m; } return lo; }
P int32_t search_n(const int32_t *a, int32_t n, int32_t x) { CLAMP(n, 64); int32_t lo = 0, hi = n - 1; while (lo <= hi) { int32_t m = lo + ((hi - lo) >> 1); if (a[m] == x) return m; if (a[m] < x) lo = m + 1; else hi = m - 1; } return -1; }
P int32_t search_base(const int32_t *a, int32_t x) { const int32_t *base = a; uint32_t n = 64; while (n > 1) { uint32_t half = n / 2; if (base[half] <= x) base += half; n -= half; } return *base; }
P int32_t search_step(const int32_t *a, int32_t x) { int32_t at = -1; for (int32_t step = 32; step > 0; step >>= 1) while (at + step < 64 && a[at + step] < x) at += step; return at; }
P int32_t table_lookup(const int32_t *xs, int32_t x) { uint16_t lo = 0, hi = 31; while (hi - lo > 1) { uint16_t m = (lo + hi) >> 1; if (xs[m] > x) hi = m; else lo = m; } return lo; }
P int32_t halving(uint32_t x) { int32_t n = 0; while (x) { n++; x >>= 1; } return n; }
P int32_t halving_signed(int32_t x) { int32_t n = 0; while (x) { n++; x /= 2; } return n; }
P int32_t digits(uint32_t x, char *s) { int32_t n = 0; do { s[n++] = '0' + x % 10; x /= 10; } while (x); return n; }
P int32_t digits_signed(int32_t x) { int32_t n = 0; do { n++; x /= 10; } while (x != 0); return n; }
P int32_t digits_base(uint32_t x, uint32_t base) { int32_t n = 0; if (base < 2 || base > 36) base = 10; do { n++; x /= base; } while (x); return n; }
P int32_t digits_wide(uint64_t x) { int32_t n = 0; while (x > 9) { x /= 10; n++; } return n; }
P int32_t wide_halving(uint64_t x) { int32_t n = 0; while (x) { n += x & 1; x >>= 1; } return n; }
P int32_t wide_bits(uint64_t x) { int32_t n = 0; while (x) { n++; x &= x - 1; } return n; }
P int32_t doubling(uint32_t limit) { int32_t n = 0; CLAMP(limit, 5000); for (uint32_t i = 1; i < limit; i <<= 1) n++; return n; }
P int32_t doubling_any(uint32_t limit) { int32_t n = 0; for (uint32_t i = 1; i && i < limit; i <<= 1) n++; return n; }
P int32_t bits(uint32_t x) { int32_t n = 0; while (x) { x &= x - 1; n++; } return n; }
P int32_t bits_8(uint8_t x) { int32_t n = 0; while (x) { x &= x - 1; n++; } return n; }
P int32_t bits_lowest(uint32_t x) { int32_t n = 0; while (x) { uint32_t low = x & -x; n += low; x ^= low; } return n; }
P int32_t mask_walk(uint32_t x) { int32_t n = 0; for (uint32_t m = 1u << 31; m; m >>= 1) if (x & m) n++; return n; }
P int32_t mask_walk_8(uint8_t x) { int32_t n = 0; for (uint8_t m = 1; m; m <<= 1) if (x & m) n++; return n; }
P int32_t leading(uint32_t x) { int32_t n = 0; if (!x) return 32; while (!(x & 0x80000000u)) { x <<= 1; n++; } return n; }
P int32_t leading_cap(uint32_t x) { int32_t n = 0; while (n < 32 && !(x & 0x80000000u)) { x <<= 1; n++; } return n; }
P uint32_t isqrt(uint32_t x) { uint32_t r = 0, bit = 1u << 30; while (bit > x) bit >>= 2; while (bit) { if (x >= r + bit) { x -= r + bit; r = (r >> 1) + bit; } else r >>= 1; bit >>= 2; } return r; }
P uint32_t newton(uint32_t x) { uint32_t r = x ? x : 1; for (int32_t i = 0; i < 20; i++) { uint32_t next = (r + x / r) / 2; if (next >= r) break; r = next; } return r; }
P uint32_t newton_down(uint32_t x) { if (x < 2) return x; uint32_t r = x / 2, next = (r + x / r) / 2; while (next < r) { r = next; next = (r + x / r) / 2; } return r; }
P uint32_t gcd(uint32_t a, uint32_t b) { while (b) { uint32_t t = a % b; a = b; b = t; } return a; }
P int32_t gcd_signed(int32_t a, int32_t b) { if (a < 0) a = -a; if (b < 0) b = -b; while (b != 0) { int32_t t = a % b; a = b; b = t; } return a; }
P uint32_t gcd_small(uint16_t a, uint16_t b) { while (b) { uint16_t t = a % b; a = b; b = t; } return a; }
P uint32_t gcd_subtract(uint8_t a, uint8_t b) { if (!a || !b) return a | b; while (a != b) { if (a > b) a -= b; else b -= a; } return a; }
P uint32_t gcd_binary(uint32_t a, uint32_t b) { uint32_t k = 0; if (!a || !b) return a | b; while (!((a | b) & 1)) { a >>= 1; b >>= 1; k++; } while (!(a & 1)) a >>= 1; while (b) { while (!(b & 1)) b >>= 1; if (a > b) { uint32_t t = a; a = b; b = t; } b -= a; } return a << k; }
P uint32_t power(uint32_t x, uint32_t n) { uint32_t r = 1; while (n) { if (n & 1) r *= x; x *= x; n >>= 1; } return r; }
P uint32_t power_mod(uint32_t x, uint32_t n, uint32_t m) { uint32_t r = 1; if (!m) m = 1; while (n > 0) { if (n & 1) r = (uint64_t)r * x % m; x = (uint64_t)x * x % m; n >>= 1; } return r; }
P int32_t collatz(uint32_t x) { int32_t n = 0; while (x != 1 && n < 100) { x = x & 1 ? 3 * x + 1 : x / 2; n++; } return n; }
P uint32_t divide(uint32_t a, uint32_t b) { uint32_t q = 0; if (!b) return 0; uint32_t s = b; while (s <= a / 2) s <<= 1; while (s >= b) { q <<= 1; if (a >= s) { a -= s; q |= 1; } s >>= 1; } return q; }
P uint32_t multiply(uint32_t a, uint32_t b) { uint32_t r = 0; while (b != 0) { if (b & 1) r += a; a <<= 1; b >>= 1; } return r; }
P int32_t sift(int32_t *a, int32_t i) { int32_t n = 60; if (i < 0 || i >= n) return 0; for (;;) { int32_t c = 2 * i + 1; if (c >= n) break; if (c + 1 < n && a[c + 1] > a[c]) c++; if (a[i] >= a[c]) break; int32_t t = a[i]; a[i] = a[c]; a[c] = t; i = c; } return i; }
P int32_t sift_up(int32_t *a, uint32_t i) { CLAMP(i, 60); while (i > 0) { uint32_t p = (i - 1) / 2; if (a[p] >= a[i]) break; int32_t t = a[i]; a[i] = a[p]; a[p] = t; i = p; } return i; }
P int32_t fenwick_sum(const int32_t *a, uint32_t i) { int32_t s = 0; CLAMP(i, 64); while (i > 0) { s += a[i]; i -= i & -i; } return s; }
P int32_t fenwick_add(int32_t *a, uint32_t i) { i &= 63; for (i++; i <= 64; i += i & -i) a[i & 63]++; return 0; }
P int32_t varint(const uint8_t *p, uint32_t *out) { uint32_t r = 0; int32_t shift = 0; do { r |= (uint32_t)(*p & 0x7F) << shift; shift += 7; } while (*p++ & 0x80 && shift < 35); *out = r; return shift; }
P int32_t varint_put(uint8_t *p, uint32_t x) { int32_t n = 0; while (x >= 0x80) { p[n++] = x | 0x80; x >>= 7; } p[n++] = x; return n; }
P int32_t gray(uint32_t x) { for (int32_t s = 16; s; s >>= 1) x ^= x >> s; return x; }
P uint16_t crc(const uint8_t *p, uint8_t n) { uint16_t c = 0xFFFF; while (n--) { c ^= *p++ << 8; for (int32_t i = 0; i < 8; i++) c = c & 0x8000 ? (c << 1) ^ 0x1021 : c << 1; } return c; }
P int32_t lfsr(uint32_t seed, uint32_t n) { CLAMP(n, 70); while (n--) seed = (seed >> 1) ^ (-(seed & 1) & 0xD0000001u); return seed; }
P int32_t fibonacci(uint32_t limit) { uint32_t a = 1, b = 1; int32_t n = 0; CLAMP(limit, 100000); while (b < limit) { uint32_t t = a + b; a = b; b = t; n++; } return n; }
P int32_t ladder(uint32_t x) { int32_t n = 0; while (x > 1) { x = x & 1 ? (x - 1) : (x >> 1); n++; } return n; }
P int32_t geometric(uint32_t x) { int32_t n = 0; while (x > 10) { x -= x / 4; n++; } return n; }
