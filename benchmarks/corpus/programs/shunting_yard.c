/* entry: run; inputs: formula any, variables any */
#include <stdint.h>

char formula[64] = "(a + 12) * 3 - b / (2 - 7) % 4 << 1";
int32_t variables[4] = {5, 60, -7, 1000};

struct stack {
    int32_t item[16];
    int8_t top;
};

static struct stack values, operators;

static int rank(char c)
{
    switch (c) {
    case '<':
        return 1;
    case '+':
    case '-':
        return 2;
    case '*':
    case '/':
    case '%':
        return 3;
    default:
        return 0;
    }
}

static int push(struct stack *s, int32_t v)
{
    if (s->top == 16)
        return 0;
    s->item[s->top++] = v;
    return 1;
}

static int apply(void)
{
    if (values.top < 2 || operators.top < 1)
        return 0;
    int32_t b = values.item[--values.top], a = values.item[--values.top];
    switch (operators.item[--operators.top]) {
    case '+':
        a = (int32_t)((uint32_t)a + (uint32_t)b);
        break;
    case '-':
        a = (int32_t)((uint32_t)a - (uint32_t)b);
        break;
    case '*':
        a = (int32_t)((uint32_t)a * (uint32_t)b);
        break;
    case '/':
    case '%':
        if (b == 0 || b == -1)
            return 0;
        a = operators.item[operators.top] == '/' ? a / b : a % b;
        break;
    case '<':
        a = (int32_t)((uint32_t)a << (b & 31));
        break;
    default:
        return 0;
    }
    return push(&values, a);
}

static int evaluate(const char *s, const char *end, int32_t *result)
{
    values.top = operators.top = 0;
    while (s < end && *s) {
        if (*s >= '0' && *s <= '9') {
            uint32_t n = 0;
            do
                n = n * 10 + (uint32_t)(*s++ - '0');
            while (s < end && *s >= '0' && *s <= '9');
            if (!push(&values, (int32_t)n))
                return -1;
            continue;
        }
        if (*s >= 'a' && *s <= 'd') {
            if (!push(&values, variables[*s - 'a']))
                return -1;
        } else if (*s == '(') {
            if (!push(&operators, '('))
                return -2;
        } else if (*s == ')') {
            while (operators.top && operators.item[operators.top - 1] != '(')
                if (!apply())
                    return -3;
            if (!operators.top)
                return -4;
            operators.top--;
        } else if (rank(*s)) {
            while (operators.top && rank((char)operators.item[operators.top - 1]) >= rank(*s))
                if (!apply())
                    return -3;
            if (!push(&operators, *s))
                return -2;
            if (*s == '<')
                s++;
        } else if (*s != ' ') {
            return -5;
        }
        s++;
    }
    while (operators.top > 0)
        if (!apply())
            return -6;
    if (values.top != 1)
        return -7;
    *result = values.item[0];
    return 0;
}

int run(void)
{
    int32_t result = 0;
    int status = evaluate(formula, formula + sizeof formula, &result);
    return status ? status : (int)result;
}

int main(void)
{
    return run();
}
