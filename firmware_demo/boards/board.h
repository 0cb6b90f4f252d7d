/*
 * Functions of a board that the demonstrations use. One file for each family of boards implements
 * them, and one for the host.
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

/*
 * Memory section for large work arrays, which the linker script places and start-up does not clear.
 */
#define BOARD_LARGE __attribute__((section(".bss.large")))

void board_start(void);          /* switch on the serial line and the counter */
void board_put(char character);  /* send one character and wait until it is accepted */
uint32_t board_count(void);      /* free-running counter; 0 on a board without one */
uint32_t board_stack_used(void); /* largest stack use so far (bytes); 0 on the host */

/*
 * Number of instructions executed between two values of board_count. Under QEMU with the -icount
 * setting of firmware.mk the number is exact on netduinoplus2 and rounded to one on mps2. It is no
 * number of clock cycles.
 */
uint32_t board_instructions(uint32_t from, uint32_t to);

/*
 * Restart the hardware watchdog, if the board has one, when is_alive is not 0. The first restart
 * starts the watchdog, so that start-up may take as long as needed. Returns is_alive.
 */
int board_kick(int is_alive);

/*
 * Exchange bytes with the computer that runs or debugs the board, by semihosting or by standard
 * input and output. Both functions return whether all bytes were transferred; 0 means the end of
 * the stream.
 */
int board_receive(void *to, size_t bytes);
int board_send(const void *from, size_t bytes);

#ifdef __cplusplus
}
#endif

#endif
