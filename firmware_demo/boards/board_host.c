/*
 * Board functions for the host, so that the bits of the demonstrations there can be compared with
 * those of a target.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <stdio.h>
#include "board.h"

void board_start(void)
{
}

void board_put(char character)
{
    putchar(character);
}

uint32_t board_count(void)
{
    return 0;
}

uint32_t board_stack_used(void)
{
    return 0;
}

uint32_t board_instructions(uint32_t from, uint32_t to)
{
    return to - from;
}

int board_receive(void *to, size_t bytes)
{
    return fread(to, 1, bytes, stdin) == bytes;
}

int board_send(const void *from, size_t bytes)
{
    return fwrite(from, 1, bytes, stdout) == bytes && fflush(stdout) == 0;
}

/* The host has no watchdog. */
int board_kick(int is_alive)
{
    return is_alive;
}
