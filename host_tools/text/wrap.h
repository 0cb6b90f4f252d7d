/* SPDX-License-Identifier: BSD-2-Clause */
/* Printing of paragraphs with line breaks for a terminal of 100 columns. */
#ifndef WRAP_H
#define WRAP_H

#include <stdio.h>

/*
 * Print a text from the present column `at` on, with line breaks; all further lines begin in column
 * `indent`.
 */
void wrap_print(FILE *file, const char *text, int at, int indent);

#endif
