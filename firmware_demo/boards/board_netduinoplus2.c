/*
 * Board functions for the Netduino Plus 2 (STM32F405) as QEMU models it: USART1 and TIM2, with
 * clocks and pins in reset state. Real hardware also needs its clocks and pins to be configured.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "board.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define USART_SR REGISTER(0x40011000u)
#define USART_DR REGISTER(0x40011004u)
#define USART_CR1 REGISTER(0x4001100Cu)
#define TIM2_CR1 REGISTER(0x40000000u)
#define TIM2_CNT REGISTER(0x40000024u)

void board_start(void)
{
    USART_CR1 = 1u << 13 | 1u << 3; /* enable the UART and its transmitter */
    TIM2_CR1 = 1u;
}

void board_put(char character)
{
    while (!(USART_SR & 1u << 7)) {
    }
    USART_DR = (uint8_t)character;
}

uint32_t board_count(void)
{
    return TIM2_CNT;
}

/* TIM2 runs at 1 GHz, and with -icount shift=0 QEMU executes one instruction in 1 ns. */
uint32_t board_instructions(uint32_t from, uint32_t to)
{
    return to - from;
}
