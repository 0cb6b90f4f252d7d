/* SPDX-License-Identifier: BSD-2-Clause */
/* Areas of electrodes of any outline on standard output, as text and as JSON. */
#ifndef PRINT_OUTLINES_H
#define PRINT_OUTLINES_H

#include "../model/design.h"
#include "../text/json.h"

/*
 * Print a line with the electrodes' areas for each item of the scene's section `patches` that has
 * outlines.
 */
void print_outlines(const design *design);

/*
 * Write the areas of the electrodes of each item of the section `patches` that has outlines, in the
 * order of the electrodes; nothing where no item has outlines.
 */
void print_outlines_json(json *json, const design *design);

#endif
