/* SPDX-License-Identifier: BSD-2-Clause */
#include <string.h>
#include "print.h"
#include "../boards/board.h"

void print_text(const char *text)
{
    while (*text)
        board_put(*text++);
}

static void field(const char *name)
{
    board_put(' ');
    print_text(name);
    board_put('=');
}

static void decimal(uint32_t value)
{
    char digits[10];
    int number = 0;
    do
        digits[number++] = (char)('0' + value % 10u);
    while (value /= 10u);
    while (number)
        board_put(digits[--number]);
}

static void hexadecimal(uint32_t value)
{
    for (int shift = 28; shift >= 0; shift -= 4)
        board_put("0123456789abcdef"[value >> shift & 15u]);
}

void print_count(const char *name, uint32_t value)
{
    field(name);
    decimal(value);
}

void print_hex(const char *name, uint32_t value)
{
    field(name);
    print_text("0x");
    hexadecimal(value);
}

static void bits(pzs_real value)
{
    uint32_t word[sizeof(pzs_real) / sizeof(uint32_t)];
    memcpy(word, &value, sizeof word);
    for (size_t i = sizeof word / sizeof *word; i-- > 0;)
        hexadecimal(word[i]);
}

/*
 * Print a number as d.ddde-xx, by repeated multiplication; the last digit may be wrong by rounding.
 */
static void scientific(pzs_real value)
{
    int exponent = 0;
    if (value < 0) {
        board_put('-');
        value = -value;
    }
    if (value > 0) {
        while (value >= 10) {
            value /= 10;
            exponent++;
        }
        while (value < 1) {
            value *= 10;
            exponent--;
        }
    }
    const uint32_t digits = (uint32_t)(value * 1000);
    decimal(digits / 1000u);
    board_put('.');
    for (uint32_t unit = 100u; unit; unit /= 10u)
        board_put((char)('0' + digits / unit % 10u));
    print_text(exponent < 0 ? "e-" : "e+");
    decimal((uint32_t)(exponent < 0 ? -exponent : exponent));
}

void print_real(const char *name, pzs_real value)
{
    field(name);
    print_text("0x");
    bits(value);
    board_put('(');
    if (value - value == 0)
        scientific(value);
    else
        print_text("not finite");
    board_put(')');
}
