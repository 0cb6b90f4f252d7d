/*
 * Programs that a start-up must carry or end properly; PROGRAM chooses one.
 *   1  data copied, bss cleared, FPU on, stack painted: exit 0
 *   2  an exit code of main reaches the shell: 3
 *   3  a read from nowhere ends in the fault handler
 *   4  a stack overflow ends the run too, and not in someone's data:
 *   5  a write right below the stack does
 *   6  a write far below it does, as of a large frame
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "../../firmware_demo/boards/board.h"

int main(void);

extern uint32_t stack_low[]; /* sections.ld */

static volatile uint32_t copied = 0x12345678u;
static volatile uint32_t cleared;
static volatile float factor = 1.5f;

static int carried(void)
{
    const float product = factor * factor;
    return copied != 0x12345678u || cleared != 0 || !(product > 2.2f && product < 2.3f) ||
           board_stack_used() == 0 || board_stack_used() > 1024u;
}

static int read_nowhere(void)
{
    return (int)*(volatile uint32_t *)0xF0000000u;
}

/* Returns only where nothing stops it. */
static int write_below(uint32_t bytes)
{
    *(volatile uint32_t *)((uintptr_t)stack_low - bytes) = 0;
    return 0;
}

/* Deeper than any stack; the volatile array keeps it from becoming a loop. */
static uint32_t overflow(uint32_t depth)
{
    volatile uint32_t frame[16];
    frame[0] = depth;
    if (depth == 0)
        return 0;
    return overflow(depth - 1u) + frame[0];
}

int main(void)
{
    board_start();
    switch (PROGRAM) {
    case 1: return carried();
    case 2: return 3;
    case 3: return read_nowhere();
    case 5: return write_below(4u);
    case 6:
        return write_below(0x1FE00000u); /* into the vectors' memory, where that can be written */
    default: return (int)overflow(10000000u);
    }
}
