/* SPDX-License-Identifier: BSD-2-Clause */
/* The command line of pzs: its words, and the files that it names. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "commands.h"
#include "../simulate/device.h"
#include "../system/shipped.h"
#include "../tables/tables.h"

/* OPTIONS_WRONG: exit code where the scene or the command line is wrong. */
enum { OPTIONS_WRONG = 2, OPTIONS_PATH = SHIPPED_PATH, MOST_SETS = 64, MOST_LIMITS = 16 };

typedef struct options {
    command_id command;
    const char *scene; /* of a command on a scene */
    const char *word;  /* argument of another command, NULL where there is none */
    const char *set[MOST_SETS];
    common_limits limit[MOST_LIMITS];
    int sets, limits, as_json, is_strict;
    int number; /* of modes; 0: not given */
    int quasi_static;
    const char *report, *svg, *vtu, *csv, *output, *prefix;
    int words;                /* the whole command line, for the report */
    char *const *words_given; /* [words] */
    const device_board *device;
    tables_image image;
} options;

/* Read the words after the command, argv[1]. Returns 0, or an exit code after saying what is wrong.
 */
int options_read(options *options, command_id command, int argc, char **argv);

/* Say what is wrong with a word of the command line. Returns OPTIONS_WRONG. */
int options_refuse(const char *what, const char *value);

/* Say that a command is not known, and which one it may have been. Returns OPTIONS_WRONG. */
int options_unknown_command(const char *name);

#endif
