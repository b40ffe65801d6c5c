/* Recursions: along a number, two at a time, around two functions, over a tree and over halves of an array.
 *
 * arm-none-eabi-gcc -mcpu=arm7tdmi -O1 -fno-optimize-sibling-calls -g -nostdlib -Wl,--build-id=none \
 *     -ffile-prefix-map=$PWD=. recursion.c -o arm7tdmi.elf -lgcc
 */
int values[16] = {5, 3, 9, 1, 2, 8, 7, 4, 6, 0, 15, 12, 11, 10, 14, 13};

__attribute__((noinline)) int factorial(int n) { return n <= 1 ? 1 : n * factorial(n - 1); }

__attribute__((noinline)) int fibonacci(int n) { return n < 2 ? n : fibonacci(n - 1) + fibonacci(n - 2); }

int odd(int n);
__attribute__((noinline)) int even(int n) { return n == 0 ? 1 : odd(n - 1) ^ values[0]; }
__attribute__((noinline)) int odd(int n) { return n == 0 ? 0 : even(n - 1) ^ values[1]; }

__attribute__((noinline)) int tree(int node)
{
    return node >= 15 ? 0 : values[node] + tree(2 * node + 1) + tree(2 * node + 2);
}

__attribute__((noinline)) void quicksort(int low, int high)
{
    if (low >= high) return;
    int pivot = values[high], at = low;
    for (int i = low; i < high; i++)
        if (values[i] < pivot) {
            int swapped = values[at];
            values[at++] = values[i];
            values[i] = swapped;
        }
    values[high] = values[at];
    values[at] = pivot;
    quicksort(low, at - 1);
    quicksort(at + 1, high);
}

int factorial_of_9(void) { return factorial(9); }
int fibonacci_of_8(void) { return fibonacci(8); }
int even_of_11(void) { return even(11); }
int whole_tree(void) { return tree(0); }
int sorted(void) { quicksort(0, 15); return values[3]; }

void _start(void) { for (;;) values[0] = factorial_of_9() + fibonacci_of_8() + even_of_11() + whole_tree() + sorted(); }
