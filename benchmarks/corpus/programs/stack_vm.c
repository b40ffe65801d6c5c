/* entry: run; inputs: operand any */
#include <stdint.h>

enum { PUSH, ADD, SUB, MUL, DUP, SWAP, JNZ, LOAD, STORE, HALT, LESS, JMP };

int32_t operand = 12;
static int32_t stack[16], memory[8];

/* memory[1] = factorial-like product of the low bits of the operand, by a loop that counts memory[0] down */
static const int8_t code[] = {PUSH, 10, STORE, 0, PUSH, 1,    STORE, 1, LOAD, 1, LOAD, 0,  MUL, PUSH, 7,
                              ADD,  STORE, 1, LOAD, 0, PUSH, 1, SUB, DUP, STORE, 0, JNZ, 8, LOAD, 1, HALT};

static int32_t execute(const int8_t *program)
{
    int32_t *top = stack;
    const int8_t *pc = program;

    memory[2] = operand;
    for (int budget = 400; budget > 0; budget--) {
        switch (*pc++) {
        case PUSH:
            *top++ = *pc++;
            break;
        case ADD:
            top--;
            top[-1] += top[0];
            break;
        case SUB:
            top--;
            top[-1] -= top[0];
            break;
        case MUL:
            top--;
            top[-1] *= top[0];
            break;
        case DUP:
            top[0] = top[-1];
            top++;
            break;
        case SWAP: {
            int32_t t = top[-1];
            top[-1] = top[-2];
            top[-2] = t;
            break;
        }
        case JNZ:
            pc = *--top ? program + *pc : pc + 1;
            break;
        case LOAD:
            *top++ = memory[*pc++ & 7];
            break;
        case STORE:
            memory[*pc++ & 7] = *--top;
            break;
        case LESS:
            top--;
            top[-1] = top[-1] < top[0];
            break;
        case JMP:
            pc = program + *pc;
            break;
        case HALT:
            return top[-1];
        default:
            return -1;
        }
    }
    return -2;
}

int run(void)
{
    return execute(code);
}

int main(void)
{
    return run();
}
