/* SPDX-License-Identifier: BSD-2-Clause */
/* List of the keys of a scene, made from the tables of keys of the reader. */
#ifndef KEYS_H
#define KEYS_H

#include <stdbool.h>
#include <stdio.h>
#include "../text/suggest.h"

/*
 * Print the keys with the kind of their values and a help sentence each.
 *   section  in  key of a section, or NULL for all
 */
void keys_print(FILE *file, const char *section);

/* Whether a scene has a section of this key. */
bool keys_has(const char *section);

/* Print the keys of all sections, separated by blanks. */
void keys_names(FILE *file);

/* Consider the keys of all sections as a suggestion. */
void keys_suggest(suggestion *near);

#endif
