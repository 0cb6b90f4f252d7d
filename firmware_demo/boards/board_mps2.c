/*
 * Board functions for the Arm MPS2 with the images AN386 (Cortex-M4F) and AN500 (Cortex-M7): CMSDK
 * UART 0 and FPGAIO counter.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "board.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define UART_DATA REGISTER(0x40004000u)
#define UART_STATE REGISTER(0x40004004u)
#define UART_CTRL REGISTER(0x40004008u)
#define UART_BAUDDIV REGISTER(0x40004010u)
#define FPGAIO_COUNTER REGISTER(0x40028018u)
#define FPGAIO_PRESCALE REGISTER(0x4002801Cu)

void board_start(void)
{
    UART_BAUDDIV = 16u;
    UART_CTRL = 1u;        /* enable the transmitter */
    FPGAIO_PRESCALE = 24u; /* divide 25 MHz by 25 */
}

void board_put(char character)
{
    while (UART_STATE & 1u) {
    }
    UART_DATA = (uint8_t)character;
}

uint32_t board_count(void)
{
    return FPGAIO_COUNTER;
}

/*
 * The counter runs at 1 MHz, and with -icount shift=10 QEMU executes one instruction in 1.024 us.
 */
uint32_t board_instructions(uint32_t from, uint32_t to)
{
    return (uint32_t)((uint64_t)(to - from) * 125u / 128u);
}

/* The watchdog of this board is left off. */
int board_kick(int is_alive)
{
    return is_alive;
}
