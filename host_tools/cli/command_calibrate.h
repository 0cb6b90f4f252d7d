/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The command `pzs calibrate`: computes the influence matrix from shapes that were measured under
 * known voltages.
 */
#ifndef COMMAND_CALIBRATE_H
#define COMMAND_CALIBRATE_H

#include "options.h"

/*
 * Compute an influence matrix from the files of voltages and shapes that the options name.
 *   scene in  scene that serves as a model, or NULL
 * Returns an exit code after printing the result or an error message.
 */
int command_calibrate(const options *options, const scene *scene);

#endif
