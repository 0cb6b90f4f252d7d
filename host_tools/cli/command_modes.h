/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs modes`: natural frequencies and mode shapes of the structure alone. */
#ifndef COMMAND_MODES_H
#define COMMAND_MODES_H

#include "options.h"

/*
 * Run the command. Unlike others it accepts supports that permit rigid motions. Returns an exit
 * code.
 */
int command_modes(const options *options);

#endif
