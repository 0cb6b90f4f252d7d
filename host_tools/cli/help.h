/* SPDX-License-Identifier: BSD-2-Clause */
/* Help of pzs from its tables of commands and options. */
#ifndef HELP_H
#define HELP_H

#include <stdio.h>
#include "commands.h"

/* All commands, all options, one example of each command. */
void help_all(FILE *file);

/* Usage, purpose, options and examples of one command. */
void help_command(FILE *file, command_id command);

#endif
