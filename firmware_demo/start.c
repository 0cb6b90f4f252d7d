/*
 * Start-up of a Cortex-M with FPU: vectors, memory, stack painting, exit.
 *
 * The stack lies at the lowest RAM address, so that an overflow leaves RAM
 * and faults instead of running into data. Exit codes reach the shell by
 * semihosting; on a board without a debugger the breakpoint faults and the
 * fault handler waits for the watchdog.
 */
#include "board.h"

int main(void);

/* Laid out by sections.ld. */
extern uint32_t stack_low[], stack_high[];
extern uint32_t data_load[], data_start[], data_end[];
extern uint32_t bss_start[], bss_end[];

#define PAINT 0x57ACCA5Eu /* bytes differ: a memset in its place could not use the stack it paints */
#define FAULT_EXIT 70u

static void semihosting_exit(uint32_t code)
{
    const uint32_t block[2] = { 0x20026u /* the program ended by itself */, code };
    register uint32_t operation __asm("r0") = 0x20u /* SYS_EXIT_EXTENDED */;
    register const uint32_t *argument __asm("r1") = block;
    __asm volatile("bkpt 0xAB" : : "r"(operation), "r"(argument) : "memory");
}

static void fault(void)
{
    semihosting_exit(FAULT_EXIT);
    for (;;) {}
}

static void enable_fpu(void)
{
    volatile uint32_t *cpacr = (volatile uint32_t *)0xE000ED88u;
    *cpacr |= 0xFu << 20;
    __asm volatile("dsb\n\tisb" : : : "memory");
}

static void paint_stack(void)
{
    uintptr_t sp;
    __asm volatile("mov %0, sp" : "=r"(sp));
    for (volatile uint32_t *p = stack_low; (uintptr_t)p < sp; p++) *p = PAINT;
}

uint32_t board_stack_used(void)
{
    const uint32_t *p = stack_low;
    while (p < stack_high && *p == PAINT) p++;
    return (uint32_t)((uintptr_t)stack_high - (uintptr_t)p);
}

static void reset(void)
{
    const uint32_t *from = data_load;
    enable_fpu();
    paint_stack();
    for (uint32_t *p = data_start; p < data_end; p++) *p = *from++;
    for (uint32_t *p = bss_start; p < bss_end; p++) *p = 0;
    semihosting_exit((uint32_t)main());
    for (;;) {}
}

typedef struct vector_table {
    uint32_t *stack;
    void (*handler[15])(void); /* reset, NMI, the faults, SVC, debug, PendSV, SysTick; 0: reserved */
} vector_table;

extern const vector_table vectors;
__attribute__((section(".vectors"), used)) const vector_table vectors = {
    stack_high,
    { reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, fault }
};
