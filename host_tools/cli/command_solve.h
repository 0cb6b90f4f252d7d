/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs solve`: displacements, forces and voltages of a structure under its loads. */
#ifndef COMMAND_SOLVE_H
#define COMMAND_SOLVE_H

#include "options.h"
#include "../model/analysis.h"

/* Run the command on a prepared scene. Returns an exit code. */
int command_solve(const options *options, analysis *analysis);

#endif
