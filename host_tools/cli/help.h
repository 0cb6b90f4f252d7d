/* SPDX-License-Identifier: BSD-2-Clause */
/* Help texts of pzs, generated from its tables of commands and options. */
#ifndef HELP_H
#define HELP_H

#include <stdio.h>
#include "commands.h"

/* Print all commands, all options and one example of each command. */
void help_all(FILE *file);

/* Print usage, purpose, options and examples of one command. */
void help_command(FILE *file, command_id command);

#endif
