/* SPDX-License-Identifier: BSD-2-Clause */
/* The manual page and the shell completion of pzs, from its tables of commands and options. */
#ifndef MANUAL_H
#define MANUAL_H

#include <stdio.h>

/* Manual page in roff, with the macros of man(7). */
void manual_page(FILE *file);

/* Script that makes bash complete commands, options, scenes and files. */
void manual_completion(FILE *file);

#endif
