/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs shape`: the optimal voltages for the target of a scene, and others to compare.
 */
#ifndef COMMAND_SHAPE_H
#define COMMAND_SHAPE_H

#include "options.h"
#include "../model/analysis.h"

/* Run the command on a prepared scene. Returns an exit code. */
int command_shape(const options *options, analysis *analysis);

#endif
