/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Forces and moments of the supports on the shell, and their balance with loads, springs and
 * contact, on standard output.
 */
#ifndef PRINT_REACTIONS_H
#define PRINT_REACTIONS_H

#include "../model/analysis.h"
#include "../text/json.h"

/*
 * Print a table of the reactions of the supports in the last solution. Without supports nothing is
 * printed.
 */
void print_reactions(const analysis *analysis);

/* Write the reactions of the last solution as an object of a JSON document. */
void print_reactions_json(json *json, const analysis *analysis);

#endif
