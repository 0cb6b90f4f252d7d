/*
 * Board functions for the Netduino Plus 2 (STM32F405) as QEMU models it: USART1, TIM2 and
 * the independent watchdog IWDG, with clocks and pins in reset state. Real hardware also needs its
 * clocks and pins to be configured.
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
#define IWDG_KR REGISTER(0x40003000u)

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

/*
 * The key 0xCCCC starts the watchdog, 0xAAAA reloads its counter. With prescaler and reload value
 * in reset state (4 and 4095) its time-out is 512 ms at 32 kHz, the nominal frequency of its own
 * oscillator (17 to 47 kHz). A loop with a slower tick writes larger values before. QEMU ignores
 * both keys.
 */
int board_kick(int is_alive)
{
    if (is_alive) {
        IWDG_KR = 0xCCCCu;
        IWDG_KR = 0xAAAAu;
    }
    return is_alive;
}
