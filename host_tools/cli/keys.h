/* SPDX-License-Identifier: BSD-2-Clause */
/* List of the keys of a scene file, generated from the tables of keys of the scene reader. */
#ifndef KEYS_H
#define KEYS_H

#include <stdbool.h>
#include <stdio.h>
#include "../text/suggest.h"

/*
 * Print the keys of a scene file, each with the type of its value and a help sentence.
 *   section in  key of a section, or NULL for all sections
 */
void keys_print(FILE *file, const char *section);

/* Whether scenes may have a section with this key. */
bool keys_has(const char *section);

/* Print the keys of all sections that a scene file may have, separated by blanks. */
void keys_names(FILE *file);

/*
 * Compare the keys of all sections of a scene file with a misspelt word, to suggest the most
 * similar key.
 */
void keys_suggest(suggestion *near);

#endif
