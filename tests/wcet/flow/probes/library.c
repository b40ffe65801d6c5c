/* Calls of the C library with lengths that are known in an interval. */
#include <stdint.h>
#include <string.h>
#include <stdlib.h>
#define P __attribute__((noinline, used))
#define CLAMP(n, most) if ((n) > (most)) (n) = (most)
P int32_t memset_n(uint8_t *a, uint32_t n) { CLAMP(n, 100); memset(a, 3, n); return 0; }
P int32_t memcpy_n(uint8_t *a, const uint8_t *b, uint32_t n) { CLAMP(n, 100); memcpy(a, b, n); return 0; }
P int32_t memmove_n(uint8_t *a, const uint8_t *b, uint32_t n) { CLAMP(n, 100); memmove(a, b, n); return 0; }
P int32_t memcmp_n(const uint8_t *a, const uint8_t *b, uint32_t n) { CLAMP(n, 100); return memcmp(a, b, n); }
P int32_t memchr_n(const uint8_t *a, uint32_t n) { CLAMP(n, 100); return memchr(a, 3, n) != 0; }
P int32_t strncmp_n(const char *a, const char *b, uint32_t n) { CLAMP(n, 60); return strncmp(a, b, n); }
P int32_t strncpy_n(char *a, const char *b, uint32_t n) { CLAMP(n, 60); strncpy(a, b, n); return 0; }
P int32_t strnlen_n(const char *a, uint32_t n) { CLAMP(n, 60); return strnlen(a, n); }
P int32_t memset_any(uint8_t *a, uint32_t n) { memset(a, 3, n & 127); return 0; }
P int32_t strlen_literal(int32_t k) { return strlen(k ? "hello" : "a longer string"); }
P int32_t divide_all(const int32_t *a, int32_t d) { int32_t s = 0; for (int32_t i = 0; i < 16; i++) s += a[i] / d + a[i] % 7; return s; }
P uint64_t divide_wide(const uint64_t *a, uint64_t d) { uint64_t s = 0; for (int32_t i = 0; i < 8; i++) s += a[i] / d; return s; }
static int compare(const void *a, const void *b) { return *(const int32_t *)a - *(const int32_t *)b; }
P int32_t bsearch_16(const int32_t *a, int32_t x) { return bsearch(&x, a, 16, 4, compare) != 0; }
P int32_t abs_sum(const int32_t *a) { int32_t s = 0; for (int32_t i = 0; i < 16; i++) s += abs(a[i]); return s; }
