/* The first code of every image. */
int main(void);

void _start(void)
{
    main();
    for (;;) {
    }
}
