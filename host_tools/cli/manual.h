/* SPDX-License-Identifier: BSD-2-Clause */
/* Manual page and shell completion of pzs, generated from its tables of commands and options. */
#ifndef MANUAL_H
#define MANUAL_H

#include <stdio.h>

/* Write the manual page in roff with the macros of man(7). */
void manual_page(FILE *file);

/* Write a bash script that completes commands, options, scene names and file names. */
void manual_completion(FILE *file);

#endif
