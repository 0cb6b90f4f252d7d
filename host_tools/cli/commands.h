/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The commands and options of pzs as data. The parser (options.c), the help (help.c), the shell
 * completion and the manual page (manual.c) are made from these two tables.
 */
#ifndef COMMANDS_H
#define COMMANDS_H

typedef enum command_id {
    COMMAND_LIST,
    COMMAND_CHECK,
    COMMAND_SOLVE,
    COMMAND_SHAPE,
    COMMAND_MODES,
    COMMAND_TABLES,
    COMMAND_SIMULATE,
    COMMAND_NEW,
    COMMAND_COMPLETION,
    COMMAND_MAN,
    COMMAND_HELP,
    COMMANDS
} command_id;

typedef enum option_id {
    OPTION_SET,
    OPTION_LIMIT,
    OPTION_JSON,
    OPTION_STRICT,
    OPTION_REPORT,
    OPTION_SVG,
    OPTION_VTU,
    OPTION_NUMBER,
    OPTION_CSV,
    OPTION_DEVICE,
    OPTION_IMAGE,
    OPTION_QUASI_STATIC,
    OPTION_PREFIX,
    OPTION_OUTPUT,
    OPTION_HELP,
    OPTION_VERSION,
    OPTIONS
} option_id;

/* What the argument of a command or an option is. */
typedef enum argument_kind {
    ARGUMENT_NONE,
    ARGUMENT_SCENE,
    ARGUMENT_COMMAND,
    ARGUMENT_CHOICE,
    ARGUMENT_FILE,
    ARGUMENT_TEXT
} argument_kind;

enum { COMMAND_EXAMPLES = 3 };

typedef struct command_entry {
    const char *name;
    const char *argument; /* as the help writes it, in brackets where it may be left out; "" for
                             none */
    argument_kind kind;
    const char *const *choices;                /* of ARGUMENT_CHOICE, ended by NULL; else NULL */
    const char *summary;                       /* a line of pzs --help */
    const char *about;                         /* a paragraph of pzs help COMMAND */
    const char *example[COMMAND_EXAMPLES + 1]; /* shell commands, ended by NULL */
} command_entry;

typedef struct option_entry {
    const char *name, *other; /* other: a second name, or NULL */
    const char *argument;     /* "" for none */
    argument_kind kind;
    const char *const *choices; /* as above */
    unsigned commands; /* bit k: command k takes it; 0: it stands alone, in the place of a command
                        */
    const char *help;
} option_entry;

extern const command_entry command_table[COMMANDS];
extern const option_entry option_table[OPTIONS];

/* Title, and the paragraphs below the examples; the latter ends with NULL. */
extern const char *const command_title;
extern const char *const command_notes[];

/* Does a command take an option? */
int command_takes(command_id command, option_id option);

/* Command or option of a name, or COMMANDS, OPTIONS where there is none. */
command_id command_find(const char *name);
option_id option_find(const char *name);

/* Present name of an option that was renamed, or NULL where `name` is not a former name. */
const char *option_new_name(const char *name);

#endif
