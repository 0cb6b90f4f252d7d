/*
 * Output of words and numbers on the serial line of a board, without stdio. A field has the form "
 * name=value".
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef PRINT_H
#define PRINT_H

#include "pzs.h"

void print_text(const char *text);
void print_count(const char *name, uint32_t value);
void print_hex(const char *name, uint32_t value);

/* Print all bits of a number in hexadecimal, then four decimal digits: 0x3c23d70a(9.999e-03). */
void print_real(const char *name, pzs_real value);

#endif
