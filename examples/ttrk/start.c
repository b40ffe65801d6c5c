/* Entry of the image. It holds the codels only: the scheduler that calls them is added where the robot is built. */
void _start(void);

void _start(void)
{
    for (;;)
        ;
}
