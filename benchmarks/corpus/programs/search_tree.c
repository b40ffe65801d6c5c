/* entry: run; inputs: keys any, count 0..20 */
#include <stdint.h>

/* A binary search tree in a pool: insertion through a link, deletion, walk with an own stack, depth by recursion. */
struct node {
    int16_t key;
    struct node *left, *right;
};

int16_t keys[20] = {50, 30, 70, 20, 40, 60, 80, 35, 45, 65};
uint8_t count = 10;
static struct node pool[20], *root;
static int16_t sorted[20];
static uint8_t used;

static void insert(int16_t key)
{
    struct node **link = &root;
    while (*link) {
        if ((*link)->key == key)
            return;
        link = key < (*link)->key ? &(*link)->left : &(*link)->right;
    }
    struct node *n = &pool[used++];
    n->key = key;
    n->left = n->right = 0;
    *link = n;
}

static void erase(int16_t key)
{
    struct node **link = &root;
    while (*link && (*link)->key != key)
        link = key < (*link)->key ? &(*link)->left : &(*link)->right;
    struct node *n = *link;
    if (!n)
        return;
    if (n->left && n->right) {
        struct node **least = &n->right;
        while ((*least)->left)
            least = &(*least)->left;
        n->key = (*least)->key;
        *least = (*least)->right;
    } else {
        *link = n->left ? n->left : n->right;
    }
}

static int walk(void)
{
    struct node *stack[20], *at = root;
    int top = 0, n = 0;

    while (at || top) {
        while (at) {
            stack[top++] = at;
            at = at->left;
        }
        at = stack[--top];
        sorted[n++] = at->key;
        at = at->right;
    }
    return n;
}

static int depth(const struct node *n)
{
    if (!n)
        return 0;
    int l = depth(n->left), r = depth(n->right);
    return 1 + (l > r ? l : r);
}

int run(void)
{
    used = 0;
    root = 0;
    for (uint8_t i = 0; i < count; i++)
        insert(keys[i]);
    for (uint8_t i = 0; i < count; i += 3)
        erase(keys[i]);
    return walk() << 8 | depth(root);
}

int main(void)
{
    return run();
}
