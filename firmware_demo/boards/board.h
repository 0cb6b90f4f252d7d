/*
 * What the demonstration asks of a board. One file per board family implements it, and one the
 * host.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Large work arrays: placed by the linker script, not cleared at start-up. */
#define BOARD_LARGE __attribute__((section(".bss.large")))

void board_start(void);          /* serial line and counter on */
void board_put(char character);  /* one character, waiting until it is taken */
uint32_t board_count(void);      /* free-running counter; always 0 where there is none */
uint32_t board_stack_used(void); /* bytes, the deepest so far; 0 on the host */

/* Instructions executed between two counts. Under QEMU with the -icount setting of firmware.mk
 * this is exact on netduinoplus2 and rounded to one on mps2; it says nothing of cycles. */
uint32_t board_instructions(uint32_t from, uint32_t to);

/* A stream of bytes to the computer this runs under, by semihosting or standard input and output.
 * Return whether all bytes went; 0 at its end. */
int board_receive(void *to, size_t bytes);
int board_send(const void *from, size_t bytes);

#ifdef __cplusplus
}
#endif

#endif
