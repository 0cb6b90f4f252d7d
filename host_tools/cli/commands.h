/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tables of the commands and options of pzs. The parser (options.c), the help (help.c), and the
 * shell completion and manual page (manual.c) are generated from these two tables.
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
    COMMAND_FMU,
    COMMAND_NEW,
    COMMAND_CALIBRATE,
    COMMAND_MIGRATE,
    COMMAND_KEYS,
    COMMAND_SCHEMA,
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
    OPTION_ERROR,
    OPTION_STRESS,
    OPTION_PATH,
    OPTION_BRANCH,
    OPTION_REPORT,
    OPTION_SVG,
    OPTION_VTU,
    OPTION_NUMBER,
    OPTION_ELECTRODES,
    OPTION_CSV,
    OPTION_NPZ,
    OPTION_CSV_FOLDER,
    OPTION_VOLTAGES,
    OPTION_SHAPES,
    OPTION_STANDARD_ERRORS,
    OPTION_HYSTERESIS,
    OPTION_VIBRATION,
    OPTION_DEVICE,
    OPTION_IMAGE,
    OPTION_COMPACT,
    OPTION_MODES,
    OPTION_QUASI_STATIC,
    OPTION_PREFIX,
    OPTION_PLANT,
    OPTION_CONTROLLER,
    OPTION_BUILD,
    OPTION_OUTPUT,
    OPTION_MIGRATE,
    OPTION_HELP,
    OPTION_VERSION,
    OPTIONS
} option_id;

/* Type of the argument of a command or an option. */
typedef enum argument_kind {
    ARGUMENT_NONE,
    ARGUMENT_SCENE,
    ARGUMENT_COMMAND,
    ARGUMENT_CHOICE,
    ARGUMENT_SECTION,
    ARGUMENT_FILE,
    ARGUMENT_TEXT
} argument_kind;

enum { COMMAND_EXAMPLES = 4 };

typedef struct command_entry {
    const char *name;
    const char *argument; /* name of the command's argument as the help prints it, in brackets where
                             the argument is optional; "": no argument */
    argument_kind kind;
    const char *const *choices; /* permitted words as argument of the command, ended by NULL, where
                                   the argument must be one of certain words; NULL where it is
                                   anything else */
    const char *summary; /* summary of the command in one line, for the output of pzs --help */
    const char *about;   /* description of the command in one paragraph, for the output of pzs help
                            COMMAND */
    const char *example[COMMAND_EXAMPLES + 1]; /* example shell commands for the help of a command,
                                                  ended by NULL */
} command_entry;

typedef struct option_entry {
    const char *name, *other; /* name of an option, and its second name, or NULL */
    const char *argument; /* name of the option's argument as the help prints it; "": no argument */
    argument_kind kind;
    const char *const *choices; /* permitted words as argument of the option, ended by NULL, where
                                   the argument must be one of certain words; NULL where it is
                                   anything else */
    unsigned commands; /* commands that accept the option: bit k is set for command number k; 0: the
                          option is used without a command */
    const char *help;
} option_entry;

extern const command_entry command_table[COMMANDS];
extern const option_entry option_table[OPTIONS];

/* Title of the help text of pzs, and the paragraphs below its examples, ended by NULL. */
extern const char *const command_title;
extern const char *const command_notes[];

/* Whether a command accepts an option. */
int command_takes(command_id command, option_id option);

/*
 * Find a command or an option by its name. Returns its index; where there is none, the number of
 * all commands (COMMANDS) or of all options (OPTIONS).
 */
command_id command_find(const char *name);
option_id option_find(const char *name);

/* New name of a renamed option, or NULL where `name` is not a former name of an option. */
const char *option_new_name(const char *name);

#endif
