/* SPDX-License-Identifier: BSD-2-Clause */
/* Shape errors of the single shapes of a target that is a list of shapes. */
#ifndef PRINT_MODES_H
#define PRINT_MODES_H

#include "../model/modes.h"
#include "../text/json.h"

/*
 * Print the shape error of each shape of the target, where the scene file lists several shapes for
 * which the voltages are optimised one by one; otherwise print nothing.
 */
void print_modes(const design *design, const modes *modes);
void print_modes_json(json *json, const design *design, const modes *modes);

#endif
