/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Areas of electrodes of any outline, and elements with smeared stiffness, on standard output, as
 * text and as JSON. In an element that a patch covers in part, smeared stiffness counts the patch
 * by the covered fraction of the area.
 */
#ifndef PRINT_OUTLINES_H
#define PRINT_OUTLINES_H

#include "../model/design.h"
#include "../text/json.h"

/*
 * Print a line with the electrodes' areas for each item of the scene's section `patches` that has
 * outlines, and a line for each layer whose stiffness is smeared where its patches end.
 */
void print_outlines(const design *design);

/*
 * Write the areas of electrodes with outlines, for each item of the section `patches`. For each
 * layer with smeared stiffness, write the number of elements that its patches cover in part, and
 * the smallest and largest covered fraction.
 */
void print_outlines_json(json *json, const design *design);

#endif
