/*
 * Start-up code of a Cortex-M with FPU: vector table, memory, stack measurement, exit, and a stream
 * of bytes to the debugging host.
 *
 * The stack lies at the lowest RAM addresses, below which nothing can be written: either the bus of
 * the part ends there, or the memory protection unit (MPU) forbids it. A stack overflow thus causes
 * a fault instead of overwriting data or code. Exit codes and the stream reach the host by
 * semihosting. On a board without a debugger the breakpoint causes a fault, and the fault handler
 * waits for the watchdog.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "board.h"

int main(void);

/* The linker script sections.ld defines these addresses. */
extern uint32_t stack_low[], stack_high[];
extern uint32_t data_load[], data_start[], data_end[];
extern uint32_t bss_start[], bss_end[];

/*
 * Word with which unused stack is filled. Its bytes differ, so that the compiler cannot fill by
 * memset, whose own stack frame would be overwritten.
 */
#define PAINT 0x57ACCA5Eu
#define FAULT_EXIT 70u
#define BY_ITSELF 0x20026u /* semihosting code of an exit: the program has ended */

enum { SYS_OPEN = 0x01, SYS_WRITE = 0x05, SYS_READ = 0x06, SYS_EXIT_EXTENDED = 0x20 };

static uint32_t semihosting(uint32_t operation, const uint32_t *block)
{
    register uint32_t answer __asm("r0") = operation;
    register const uint32_t *argument __asm("r1") = block;
    __asm volatile("bkpt 0xAB" : "+r"(answer) : "r"(argument) : "memory");
    return answer;
}

/* Open standard input (mode 0) or standard output (mode 4) of the host. */
static uint32_t open_terminal(uint32_t mode)
{
    static const char name[] = ":tt";
    const uint32_t block[3] = {(uint32_t)(uintptr_t)name, mode, sizeof name - 1u};
    return semihosting(SYS_OPEN, block);
}

int board_receive(void *to, size_t bytes)
{
    static uint32_t file;
    uint32_t left = bytes, before = 0;
    if (file == 0)
        file = open_terminal(0);
    while (left != 0 && left != before) { /* no further bytes: the end of the stream */
        const uint32_t block[3] = {file, (uint32_t)(uintptr_t)to + (bytes - left), left};
        before = left;
        left = semihosting(SYS_READ, block);
    }
    return left == 0;
}

int board_send(const void *from, size_t bytes)
{
    static uint32_t file;
    if (file == 0)
        file = open_terminal(4u);
    const uint32_t block[3] = {file, (uint32_t)(uintptr_t)from, bytes};
    return semihosting(SYS_WRITE, block) == 0;
}

/* The argument block is in flash, because the stack may be the cause of the fault. */
static void fault(void)
{
    static const uint32_t block[2] = {BY_ITSELF, FAULT_EXIT};
    (void)semihosting(SYS_EXIT_EXTENDED, block);
    for (;;) {
    }
}

static void enable_fpu(void)
{
    volatile uint32_t *cpacr = (volatile uint32_t *)0xE000ED88u;
    *cpacr |= 0xFu << 20;
    __asm volatile("dsb\n\tisb" : : : "memory");
}

/*
 * Make all addresses below 0x20000000 (half a gigabyte) read-only and executable; elsewhere memory
 * behaves as without an MPU.
 */
static void guard_stack(void)
{
    volatile uint32_t *mpu = (volatile uint32_t *)0xE000ED94u; /* registers of the MPU: control,
                                                                  region number, region base, region
                                                                  attributes */
    mpu[1] = 0;
    mpu[2] = 0;
    mpu[3] = 6u << 24 | 1u << 17 | 28u << 1 | 1u; /* read-only, cached like flash, 2^29 bytes,
                                                     enabled */
    mpu[0] = 1u << 2 | 1u;
    __asm volatile("dsb\n\tisb" : : : "memory");
}

static void paint_stack(void)
{
    uintptr_t sp;
    __asm volatile("mov %0, sp" : "=r"(sp));
    for (volatile uint32_t *word = stack_low; (uintptr_t)word < sp; word++)
        *word = PAINT;
}

uint32_t board_stack_used(void)
{
    const uint32_t *word = stack_low;
    while (word < stack_high && *word == PAINT)
        word++;
    return (uint32_t)((uintptr_t)stack_high - (uintptr_t)word);
}

static void reset(void)
{
    const uint32_t *from = data_load;
    enable_fpu();
    guard_stack();
    paint_stack();
    for (uint32_t *word = data_start; word < data_end; word++)
        *word = *from++;
    for (uint32_t *word = bss_start; word < bss_end; word++)
        *word = 0;
    const uint32_t block[2] = {BY_ITSELF, (uint32_t)main()};
    (void)semihosting(SYS_EXIT_EXTENDED, block);
    for (;;) {
    }
}

typedef struct vector_table {
    uint32_t *stack;
    void (*handler[15])(void); /* reset, NMI, faults, SVC, debug, PendSV, SysTick; 0: reserved */
} vector_table;

extern const vector_table vectors;
__attribute__((section(".vectors"), used)) const vector_table vectors = {
    stack_high,
    {reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, fault}};
