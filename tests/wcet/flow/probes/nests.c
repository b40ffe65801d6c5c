/* Nests: dependent bounds, shared counters, sorts, matrices, parsers, state machines. */
#include <stdint.h>
#define P __attribute__((noinline, used))
#define CLAMP(n, most) if ((n) > (most)) (n) = (most)

P int32_t triangle(const int32_t *a) { int32_t s = 0; for (int32_t i = 0; i < 30; i++) for (int32_t j = 0; j < i; j++) s += a[i] * a[j]; return s; }
P int32_t triangle_n(const int32_t *a, int32_t n) { CLAMP(n, 40); int32_t s = 0; for (int32_t i = 0; i < n; i++) for (int32_t j = i + 1; j < n; j++) s += a[i] * a[j]; return s; }
P int32_t bubble(int32_t *a) { for (int32_t i = 0; i < 29; i++) for (int32_t j = 0; j < 29 - i; j++) if (a[j] > a[j + 1]) { int32_t t = a[j]; a[j] = a[j + 1]; a[j + 1] = t; } return 0; }
P int32_t bubble_flag(int32_t *a, int32_t n) { CLAMP(n, 30); int32_t swapped; do { swapped = 0; for (int32_t j = 1; j < n; j++) if (a[j - 1] > a[j]) { int32_t t = a[j]; a[j] = a[j - 1]; a[j - 1] = t; swapped = 1; } n--; } while (swapped && n > 0); return 0; }
P int32_t insertion(int32_t *a) { for (int32_t i = 1; i < 32; i++) { int32_t x = a[i], j = i; while (j > 0 && a[j - 1] > x) { a[j] = a[j - 1]; j--; } a[j] = x; } return 0; }
P int32_t insertion_n(int32_t *a, int32_t n) { CLAMP(n, 32); for (int32_t i = 1; i < n; i++) { int32_t x = a[i], j = i - 1; while (j >= 0 && a[j] > x) { a[j + 1] = a[j]; j = j - 1; } a[j + 1] = x; } return 0; }
P int32_t selection(int32_t *a, int32_t n) { CLAMP(n, 24); for (int32_t i = 0; i < n - 1; i++) { int32_t m = i; for (int32_t j = i + 1; j < n; j++) if (a[j] < a[m]) m = j; int32_t t = a[i]; a[i] = a[m]; a[m] = t; } return 0; }
P int32_t shell(int32_t *a) { for (int32_t gap = 32; gap > 0; gap /= 2) for (int32_t i = gap; i < 64; i++) { int32_t x = a[i], j = i; for (; j >= gap && a[j - gap] > x; j -= gap) a[j] = a[j - gap]; a[j] = x; } return 0; }
P int32_t comb(int32_t *a) { int32_t gap = 40, swapped = 1, rounds = 0; while ((gap > 1 || swapped) && rounds++ < 50) { gap = gap * 10 / 13; if (gap < 1) gap = 1; swapped = 0; for (int32_t i = 0; i + gap < 40; i++) if (a[i] > a[i + gap]) { int32_t t = a[i]; a[i] = a[i + gap]; a[i + gap] = t; swapped = 1; } } return 0; }
P int32_t heapsort(int32_t *a) {
    int32_t n = 48;
    for (int32_t start = n / 2 - 1; start >= 0; start--) { int32_t i = start; for (;;) { int32_t c = 2 * i + 1; if (c >= n) break; if (c + 1 < n && a[c] < a[c + 1]) c++; if (a[i] >= a[c]) break; int32_t t = a[i]; a[i] = a[c]; a[c] = t; i = c; } }
    for (int32_t end = n - 1; end > 0; end--) { int32_t t = a[0]; a[0] = a[end]; a[end] = t; int32_t i = 0; while (2 * i + 1 < end) { int32_t c = 2 * i + 1; if (c + 1 < end && a[c] < a[c + 1]) c++; if (a[i] >= a[c]) break; t = a[i]; a[i] = a[c]; a[c] = t; i = c; } }
    return 0;
}
P int32_t merge_up(int32_t *a, int32_t *b) {
    for (int32_t width = 1; width < 32; width *= 2) {
        for (int32_t i = 0; i < 32; i += 2 * width) {
            int32_t m = i + width < 32 ? i + width : 32, r = i + 2 * width < 32 ? i + 2 * width : 32, p = i, q = m;
            for (int32_t k = i; k < r; k++) b[k] = p < m && (q >= r || a[p] <= a[q]) ? a[p++] : a[q++];
        }
        for (int32_t i = 0; i < 32; i++) a[i] = b[i];
    }
    return 0;
}
P int32_t merge(const int32_t *a, const int32_t *b, int32_t *c) { int32_t i = 0, j = 0, k = 0; while (i < 20 && j < 25) c[k++] = a[i] < b[j] ? a[i++] : b[j++]; while (i < 20) c[k++] = a[i++]; while (j < 25) c[k++] = b[j++]; return k; }
P int32_t quick(int32_t *a) {
    struct { int8_t lo, hi; } stack[16]; int32_t top = 0, rounds = 0; stack[top].lo = 0; stack[top++].hi = 31;
    while (top > 0 && rounds++ < 64) { int32_t lo = stack[--top].lo, hi = stack[top].hi; if (lo >= hi) continue; int32_t x = a[hi], i = lo; for (int32_t j = lo; j < hi; j++) if (a[j] < x) { int32_t t = a[i]; a[i] = a[j]; a[j] = t; i++; }
        a[hi] = a[i]; a[i] = x; if (top < 14) { stack[top].lo = lo; stack[top++].hi = i - 1; stack[top].lo = i + 1; stack[top++].hi = hi; } }
    return rounds;
}
P int32_t matrix(const int32_t (*a)[8], const int32_t (*b)[8], int32_t (*c)[8]) { for (int32_t i = 0; i < 8; i++) for (int32_t j = 0; j < 8; j++) { int32_t s = 0; for (int32_t k = 0; k < 8; k++) s += a[i][k] * b[k][j]; c[i][j] = s; } return 0; }
P int32_t matrix_n(const int32_t *a, const int32_t *b, int32_t *c, uint32_t n) { CLAMP(n, 6); for (uint32_t i = 0; i < n; i++) for (uint32_t j = 0; j < n; j++) { int32_t s = 0; for (uint32_t k = 0; k < n; k++) s += a[i * n + k] * b[k * n + j]; c[i * n + j] = s; } return 0; }
P int32_t lu(float (*a)[10]) { for (int32_t k = 0; k < 10; k++) for (int32_t i = k + 1; i < 10; i++) { a[i][k] /= a[k][k]; for (int32_t j = k + 1; j < 10; j++) a[i][j] -= a[i][k] * a[k][j]; } return 0; }
P int32_t convolve(const int32_t *x, const int32_t *h, int32_t *y) { for (int32_t n = 0; n < 40; n++) { int32_t s = 0; for (int32_t k = 0; k < 9; k++) if (n - k >= 0) s += h[k] * x[n - k]; y[n] = s; } return 0; }
P int32_t convolve_edges(const int32_t *x, const int32_t *h, int32_t *y) { for (int32_t n = 0; n < 40; n++) { int32_t s = 0; int32_t lo = n < 9 ? 0 : n - 8, hi = n < 31 ? n : 31; for (int32_t k = lo; k <= hi; k++) s += h[n - k] * x[k]; y[n] = s; } return 0; }
P int32_t fft_like(int32_t *a) { for (int32_t size = 2; size <= 32; size *= 2) for (int32_t i = 0; i < 32; i += size) for (int32_t k = 0; k < size / 2; k++) { int32_t t = a[i + k + size / 2]; a[i + k + size / 2] = a[i + k] - t; a[i + k] += t; } return 0; }
P int32_t bit_reverse(int32_t *a) { for (int32_t i = 1, j = 0; i < 64; i++) { int32_t bit = 32; for (; j & bit; bit >>= 1) j ^= bit; j ^= bit; if (i < j) { int32_t t = a[i]; a[i] = a[j]; a[j] = t; } } return 0; }
P int32_t tokens(const char *s) { int32_t i = 0, n = 0; while (i < 60) { while (i < 60 && s[i] == ' ') i++; if (i >= 60) break; n++; while (i < 60 && s[i] != ' ') i++; } return n; }
P int32_t numbers(const char *s, int32_t n) { CLAMP(n, 60); int32_t i = 0, sum = 0; while (i < n) { int32_t v = 0; if (s[i] < '0' || s[i] > '9') { i++; continue; } while (i < n && s[i] >= '0' && s[i] <= '9') v = v * 10 + s[i++] - '0'; sum += v; } return sum; }
P int32_t run_length(const uint8_t *a, uint8_t *b) { int32_t i = 0, k = 0; while (i < 64) { int32_t r = 1; while (i + r < 64 && r < 255 && a[i + r] == a[i]) r++; b[k++] = r; b[k++] = a[i]; i += r; } return k; }
P int32_t expand(const uint8_t *a, uint8_t *b) { int32_t k = 0; for (int32_t i = 0; i < 32; i += 2) for (uint8_t r = a[i]; r && k < 256; r--) b[k++] = a[i + 1]; return k; }
P int32_t machine(const uint8_t *s, int32_t n) {
    CLAMP(n, 50); int32_t state = 0, i = 0, out = 0;
    while (i < n) { switch (state) { case 0: if (s[i] == '{') state = 1; i++; break; case 1: if (s[i] == '"') state = 2; else if (s[i] == '}') state = 0; i++; break;
        case 2: if (s[i] == '\\') { i++; state = 3; } else if (s[i] == '"') { state = 1; i++; } else { out++; i++; } break; case 3: i++; state = 2; break; default: state = 0; i++; } }
    return out;
}
P int32_t machine_60(const uint8_t *s) {
    int32_t state = 0, i = 0, out = 0;
#define S(k) case k: out += s[i] ^ k; state = s[i] & 1 ? (k + 7) % 60 : (k + 1) % 60; break;
#define S6(k) S(k) S(k + 1) S(k + 2) S(k + 3) S(k + 4) S(k + 5)
    while (i < 100) { switch (state) { S6(0) S6(6) S6(12) S6(18) S6(24) S6(30) S6(36) S6(42) S6(48) S6(54) default: state = 0; } i++; }
    return out;
}
P int32_t interpreter(const uint8_t *code, int32_t *stack) {
    int32_t pc = 0, sp = 0, steps = 0;
    while (steps < 80) { steps++; uint8_t op = code[pc & 63]; pc++; switch (op & 7) { case 0: stack[sp++ & 15] = op >> 3; break; case 1: sp--; stack[(sp - 1) & 15] += stack[sp & 15]; break; case 2: if (stack[sp & 15]) pc += op >> 3; break;
        case 3: pc -= op >> 3; break; case 4: stack[sp & 15] = -stack[sp & 15]; break; case 5: return sp; case 6: sp = 0; break; default: break; } }
    return sp;
}
P int32_t string_find(const char *s, const char *t) { for (int32_t i = 0; i < 40; i++) { int32_t j = 0; while (j < 8 && t[j] && s[i + j] == t[j]) j++; if (j == 8 || !t[j]) return i; } return -1; }
P int32_t flood(uint8_t (*m)[16]) { int32_t changed = 1, rounds = 0; while (changed && rounds < 16) { changed = 0; rounds++; for (int32_t y = 1; y < 15; y++) for (int32_t x = 1; x < 15; x++) if (!m[y][x] && (m[y - 1][x] | m[y + 1][x] | m[y][x - 1] | m[y][x + 1])) { m[y][x] = 1; changed = 1; } } return rounds; }
P int32_t dijkstra(const uint8_t (*w)[12], int32_t *d) { uint8_t done[12] = {0}; for (int32_t i = 0; i < 12; i++) d[i] = 9999; d[0] = 0; for (int32_t r = 0; r < 12; r++) { int32_t u = -1; for (int32_t i = 0; i < 12; i++) if (!done[i] && (u < 0 || d[i] < d[u])) u = i; if (u < 0) break; done[u] = 1; for (int32_t v = 0; v < 12; v++) if (w[u][v] && d[u] + w[u][v] < d[v]) d[v] = d[u] + w[u][v]; } return 0; }
P int32_t sieve(uint8_t *f) { int32_t n = 0; for (int32_t i = 0; i < 100; i++) f[i] = 1; for (int32_t i = 2; i < 100; i++) if (f[i]) { n++; for (int32_t k = i + i; k < 100; k += i) f[k] = 0; } return n; }
P int32_t sieve_square(uint8_t *f) { for (int32_t i = 2; i * i < 200; i++) if (f[i]) for (int32_t k = i * i; k < 200; k += i) f[k] = 0; return 0; }
P int32_t deep(const int32_t *a) {
    int32_t s = 0;
    for (int32_t b = 0; b < 3; b++) for (int32_t c = 0; c < 3; c++) for (int32_t d = 0; d < 3; d++) for (int32_t e = 0; e < 3; e++) for (int32_t f = 0; f < 3; f++) for (int32_t g = 0; g < 3; g++)
    for (int32_t h = 0; h < 3; h++) for (int32_t i = 0; i < 3; i++) for (int32_t j = 0; j < 3; j++) for (int32_t k = 0; k < 3; k++) for (int32_t l = 0; l < 3; l++) for (int32_t m = 0; m < 3; m++) s += a[(b + c + d + e + f + g + h + i + j + k + l + m) & 7];
    return s;
}
static int32_t plus(int32_t a) { return a + 1; } static int32_t twice(int32_t a) { for (int32_t i = 0; i < 7; i++) a += i * a; return a; } static int32_t minus(int32_t a) { return a - 1; } static int32_t nothing(int32_t a) { return a; }
typedef int32_t (*step)(int32_t);
static const step steps[4] = {plus, twice, minus, nothing};
P int32_t dispatch(const uint8_t *s) { int32_t a = 1; for (int32_t i = 0; i < 20; i++) a = steps[s[i] & 3](a); return a; }
P int32_t dispatch_checked(uint32_t k, int32_t a) { if (k < 4) return steps[k](a); return 0; }
typedef struct { const char *name; step run; } command;
static const command commands[3] = {{"plus", plus}, {"twice", twice}, {"minus", minus}};
P int32_t dispatch_struct(const uint8_t *s) { int32_t a = 1; for (int32_t i = 0; i < 3; i++) if (s[i] == commands[i].name[0]) a = commands[i].run(a); return a; }
P int32_t apply(step f, int32_t n) { int32_t s = 0; CLAMP(n, 10); for (int32_t i = 0; i < n; i++) s += f(i); return s; }
P int32_t callback(int32_t n) { return apply(twice, n) + apply(minus, n); }
P int32_t length(const char *s, int32_t most) { int32_t n = 0; while (n < most && s[n]) n++; return n; }
P int32_t call_length(const char *s) { return length(s, 24) + length(s + 3, 16); }
P int32_t copy(char *d, const char *s, uint32_t n) { uint32_t i; for (i = 0; i + 1 < n && s[i]; i++) d[i] = s[i]; if (n) d[i] = 0; return i; }
P int32_t call_copy(const char *s) { char d[20]; return copy(d, s, sizeof d) + d[3]; }
P int32_t exclusive(const int32_t *a, int32_t mode) { int32_t s = 0; if (mode == 1) for (int32_t i = 0; i < 30; i++) s += a[i]; s ^= 5; if (mode == 2) for (int32_t i = 0; i < 40; i++) s -= a[i]; s ^= 7; if (mode == 3) for (int32_t i = 0; i < 50; i++) s ^= a[i]; return s; }
P int32_t fact(int32_t n) { return n <= 1 ? 1 : n * fact(n - 1); }
P int32_t recursion(void) { return fact(9); }
