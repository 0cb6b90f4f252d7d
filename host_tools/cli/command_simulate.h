/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs simulate`: the control loop of a scene, tick by tick. */
#ifndef COMMAND_SIMULATE_H
#define COMMAND_SIMULATE_H

#include "options.h"
#include "../model/analysis.h"

/* Run the command on a prepared scene. Returns an exit code. */
int command_simulate(const options *options, analysis *analysis);

#endif
