/* Start of a program on the Cortex-M4 of qemu's board mps2-an386: vectors, FPU, memory, main. */
#include <stdint.h>
#include <stdlib.h>

extern uint32_t data_begin, data_end, data_load, bss_begin, bss_end, stack_top;
extern int main(void);
extern void initialise_monitor_handles(void);

void reset(void);
void fault(void);
void _init(void);
void _fini(void);

void reset(void)
{
    volatile uint32_t *const access = (volatile uint32_t *)0xE000ED88U;
    const uint32_t *from = &data_load;
    uint32_t *to;

    *access |= 0xFU << 20U; /* the floating-point unit */
    for (to = &data_begin; to < &data_end; to++) {
        *to = *from;
        from++;
    }
    for (to = &bss_begin; to < &bss_end; to++) {
        *to = 0U;
    }
    initialise_monitor_handles();
    exit(main());
}

void fault(void)
{
    exit(3);
}

/* The library calls both; there is nothing to do. */
void _init(void)
{
}

void _fini(void)
{
}

struct vectors {
    const uint32_t *stack;
    void (*handlers[15])(void);
};

extern const struct vectors vectors;

__attribute__((section(".vectors"), used)) const struct vectors vectors = {
    &stack_top, { reset, fault, fault, fault, fault, fault }
};
