/* SPDX-License-Identifier: BSD-2-Clause */
/* Parser of the command line of pzs (options.h). */
#define _POSIX_C_SOURCE 200809L
#include "options.h"
#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "../model/load_path.h"
#include "keys.h"

/* ---- messages --------------------------------------------------------- */

int options_refuse(const char *what, const char *value)
{
    fprintf(stderr, "pzs: %s '%s'; see pzs --help\n", what, value);
    return OPTIONS_WRONG;
}

int options_unknown_command(const char *name)
{
    suggestion near;
    char text[SUGGEST_TEXT];
    suggest_begin(&near, name);
    for (int k = 0; k < COMMANDS; k++)
        suggest_consider(&near, command_table[k].name);
    fprintf(stderr, "pzs: unknown command '%s'%s; see pzs --help\n", name,
            suggest_text(&near, text));
    return OPTIONS_WRONG;
}

static int unknown_section(const char *name)
{
    suggestion near;
    char text[SUGGEST_TEXT];
    suggest_begin(&near, name);
    keys_suggest(&near);
    fprintf(stderr, "pzs: a scene has no section '%s'%s; see pzs keys\n", name,
            suggest_text(&near, text));
    return OPTIONS_WRONG;
}

static int unknown_option(command_id command, const char *name)
{
    suggestion near;
    char text[SUGGEST_TEXT];
    const char *new_name = option_new_name(name);
    if (new_name) {
        fprintf(stderr, "pzs: %s is now %s; see pzs help %s\n", name, new_name,
                command_table[command].name);
        return OPTIONS_WRONG;
    }
    suggest_begin(&near, name);
    for (int k = 0; k < OPTIONS; k++)
        if (command_takes(command, (option_id)k))
            suggest_consider(&near, option_table[k].name);
    fprintf(stderr, "pzs: unknown option '%s'%s; see pzs help %s\n", name,
            suggest_text(&near, text), command_table[command].name);
    return OPTIONS_WRONG;
}

/*
 * Refuse an option that the command does not accept. Ignoring the option would leave the user
 * without the expected output. Returns an exit code.
 */
static int foreign_option(command_id command, option_id option)
{
    const char *between = "";
    fprintf(stderr, "pzs: %s belongs to ", option_table[option].name);
    for (int k = 0; k < COMMANDS; k++)
        if (command_takes((command_id)k, option)) {
            fprintf(stderr, "%s%s", between, command_table[k].name);
            between = ", ";
        }
    fprintf(stderr, "%s, not to %s; see pzs help %s\n", *between ? "" : "pzs itself",
            command_table[command].name, command_table[command].name);
    return OPTIONS_WRONG;
}

/*
 * Refuse an argument of the option or command `name` that is not among the permitted words. Returns
 * an exit code.
 */
static int wrong_choice(const char *name, const char *const *choices, const char *word)
{
    suggestion near;
    char text[SUGGEST_TEXT];
    suggest_begin(&near, word);
    fprintf(stderr, "pzs: %s is ", name);
    for (int k = 0; choices[k]; k++) {
        const char *between = choices[k + 1] ? ", " : " or ";
        fprintf(stderr, "%s%s", k ? between : "", choices[k]);
        suggest_consider(&near, choices[k]);
    }
    fprintf(stderr, ", not '%s'%s; see pzs --help\n", word, suggest_text(&near, text));
    return OPTIONS_WRONG;
}

static int is_choice(const char *const *choices, const char *word)
{
    int k = 0;
    while (choices[k] && strcmp(choices[k], word) != 0)
        k++;
    return choices[k] != NULL;
}

/* ---- parser ----------------------------------------------------------- */

/*
 * Read a finite number that is followed by the character `stop`.
 *   voltage out  the number (V)
 *   end     out  end of the number in the text
 * Returns whether a number was read.
 */
static bool read_voltage(const char *text, char stop, double *voltage, char **end)
{
    *voltage = strtod(text, end);
    return *end != text && **end == stop && isfinite(*voltage);
}

/*
 * Read voltage limits: V means from -V to V, and LOWEST,HIGHEST gives both limits. Returns 0, or an
 * exit code.
 */
static int take_limit(options *options, const char *value)
{
    common_limits limit = {.source = LIMITS_GIVEN};
    char *end;
    if (options->limits == MOST_LIMITS)
        return options_refuse("too many limits at", value);
    if (!strchr(value, ',')) {
        if (!read_voltage(value, '\0', &limit.upper, &end) || !(limit.upper > 0))
            return options_refuse("--limit is a finite voltage above 0, or LOWEST,HIGHEST, not",
                                  value);
        limit.lower = -limit.upper;
    } else {
        if (!read_voltage(value, ',', &limit.lower, &end) ||
            !read_voltage(end + 1, '\0', &limit.upper, &end))
            return options_refuse("--limit LOWEST,HIGHEST is two finite voltages, not", value);
        if (limit.lower > limit.upper)
            return options_refuse(
                "--limit LOWEST,HIGHEST: the lowest voltage is above the highest in", value);
    }
    options->limit[options->limits++] = limit;
    return 0;
}

/* Read a number of samples a second. Returns whether the text is a finite number above 0. */
static bool take_rate(const char *value, double *rate)
{
    char *end;
    *rate = strtod(value, &end);
    return end != value && !*end && isfinite(*rate) && *rate > 0;
}

static int take_sample_rate(options *options, const char *value)
{
    return take_rate(value, &options->sample_rate)
               ? 0
               : options_refuse("--hysteresis is the samples a second of the sweep, not", value);
}

static int take_vibration_rate(options *options, const char *value)
{
    return take_rate(value, &options->vibration_rate)
               ? 0
               : options_refuse("--vibration is the samples a second of the record, not", value);
}

/*
 * Read a number of vibration modes, 1 to 200.
 *   message in  what to answer where the text is no such number, followed by the text
 * Returns 0, or an exit code.
 */
static int take_modes(const char *value, const char *message, int *modes)
{
    enum { MOST_MODES = 200 };
    char *end;
    const long number = strtol(value, &end, 10);
    if (end == value || *end || number < 1 || number > MOST_MODES)
        return options_refuse(message, value);
    *modes = (int)number;
    return 0;
}

static int take_set(options *options, const char *value)
{
    if (options->sets == MOST_SETS)
        return options_refuse("too many changes at", value);
    options->set[options->sets++] = value;
    return 0;
}

static int take_image(options *options, const char *value)
{
    for (options->image = 0;
         options->image < TABLES_IMAGES && strcmp(value, tables_image_name[options->image]) != 0;)
        options->image++;
    return 0;
}

static int take_circuit(options *options, const char *value)
{
    options->circuit = strcmp(value, "open") == 0 ? CIRCUIT_OPEN : CIRCUIT_SHORT;
    return 0;
}

static int take_branch(options *options, const char *value)
{
    char *end;
    const long number = strtol(value, &end, 10);
    if (end == value || *end || number == 0 || labs(number) > LOAD_PATH_EVENTS)
        return options_refuse("--branch is the number of a bifurcation, from 1 to 32 or -1 to "
                              "-32, not",
                              value);
    options->branch = (int)number;
    options->follows_path = true;
    return 0;
}

static int take_file(const char **file, const char *value)
{
    *file = value;
    return 0;
}

/*
 * Store one option with its value, which is NULL for an option without an argument. Returns 0, or
 * an exit code.
 */
static int take_option(options *options, option_id option, const char *value)
{
    const option_entry *entry = &option_table[option];
    if (!command_takes(options->command, option))
        return foreign_option(options->command, option);
    if (entry->kind == ARGUMENT_CHOICE && !is_choice(entry->choices, value))
        return wrong_choice(entry->name, entry->choices, value);
    switch (option) {
    case OPTION_SET: return take_set(options, value);
    case OPTION_LIMIT: return take_limit(options, value);
    case OPTION_NUMBER:
        return take_modes(value, "--number is a whole number from 1 to 200, not", &options->number);
    case OPTION_MODES:
        return take_modes(value, "--modes is a whole number from 1 to 200, not",
                          &options->device_modes);
    case OPTION_ELECTRODES: return take_circuit(options, value);
    case OPTION_IMAGE: return take_image(options, value);
    case OPTION_JSON: options->as_json = true; return 0;
    case OPTION_STRICT: options->is_strict = true; return 0;
    case OPTION_COMPACT: options->is_compact = true; return 0;
    case OPTION_QUASI_STATIC: options->quasi_static = true; return 0;
    case OPTION_PATH: options->follows_path = true; return 0;
    case OPTION_BRANCH: return take_branch(options, value);
    case OPTION_ERROR: options->estimates_error = true; return 0;
    case OPTION_STRESS: options->recovers_stress = true; return 0;
    case OPTION_REPORT: return take_file(&options->report, value);
    case OPTION_SVG: return take_file(&options->svg, value);
    case OPTION_VTU: return take_file(&options->vtu, value);
    case OPTION_CSV: return take_file(&options->csv, value);
    case OPTION_NPZ: return take_file(&options->npz, value);
    case OPTION_CSV_FOLDER: return take_file(&options->csv_folder, value);
    case OPTION_VOLTAGES: return take_file(&options->voltages, value);
    case OPTION_SHAPES: return take_file(&options->shapes, value);
    case OPTION_STANDARD_ERRORS: return take_file(&options->standard_errors, value);
    case OPTION_HYSTERESIS: return take_sample_rate(options, value);
    case OPTION_VIBRATION: return take_vibration_rate(options, value);
    case OPTION_PREFIX: return take_file(&options->prefix, value);
    case OPTION_OUTPUT: return take_file(&options->output, value);
    case OPTION_PLANT: options->wants_plant = true; return 0;
    case OPTION_CONTROLLER: options->wants_controller = true; return 0;
    case OPTION_BUILD: options->builds = true; return 0;
    case OPTION_DEVICE: options->device = device_find(value); return 0;
    case OPTION_MIGRATE:
    case OPTION_HELP:
    case OPTION_VERSION:
    case OPTIONS: break;
    }
    return unknown_option(options->command, entry->name);
}

/*
 * Store an argument of the command line that is not an option. Returns 0, or an exit code after
 * printing an error message.
 */
static int take_word(options *options, const char *word)
{
    const command_entry *entry = &command_table[options->command];
    if (entry->kind == ARGUMENT_NONE)
        return options_refuse("this command takes no argument; unexpected", word);
    if (entry->kind == ARGUMENT_SCENE && options->scene)
        return options_refuse("one scene at a time; unexpected", word);
    if (options->word)
        return options_refuse("one argument at a time; unexpected", word);
    if (entry->kind == ARGUMENT_CHOICE && !is_choice(entry->choices, word))
        return wrong_choice("the argument", entry->choices, word);
    if (entry->kind == ARGUMENT_COMMAND && command_find(word) == COMMANDS)
        return options_unknown_command(word);
    if (entry->kind == ARGUMENT_SECTION && !keys_has(word))
        return unknown_section(word);
    if (entry->kind == ARGUMENT_SCENE)
        options->scene = word;
    else
        options->word = word;
    return 0;
}

/*
 * Whether the prefix that the user has chosen for the names in generated C tables is pzs or PZS,
 * which the library uses for its own names.
 */
static int is_own_prefix(const char *prefix)
{
    return strlen(prefix) == 3 && tolower((unsigned char)prefix[0]) == 'p' &&
           tolower((unsigned char)prefix[1]) == 'z' && tolower((unsigned char)prefix[2]) == 's';
}

static int parse(options *options, int argc, char **argv)
{
    int wrong = 0;
    for (int i = 2; i < argc && !wrong; i++) {
        const option_id option = option_find(argv[i]);
        const int has_value = option < OPTIONS && option_table[option].kind != ARGUMENT_NONE;
        if (argv[i][0] != '-')
            wrong = take_word(options, argv[i]);
        else if (option == OPTIONS)
            wrong = unknown_option(options->command, argv[i]);
        else if (has_value && i + 1 == argc)
            wrong = options_refuse("a value is missing after", argv[i]);
        else
            wrong = take_option(options, option, has_value ? argv[i + 1] : NULL);
        i += has_value;
    }
    return wrong;
}

/*
 * Refuse options of the command calibrate that would be ignored: both --hysteresis and --vibration,
 * --number (of vibration modes) without --vibration, a scene or --standard-errors with either of
 * them, or --set without a scene. Returns 0, or an exit code.
 */
static int check_calibrate(const options *options)
{
    const bool is_sweep = options->sample_rate > 0, has_modes = options->vibration_rate > 0;
    if (is_sweep && has_modes)
        return options_refuse("write either --hysteresis or --vibration for", "calibrate");
    if (options->number && !has_modes)
        return options_refuse("only calibrate --vibration takes", "--number");
    if (options->standard_errors && (is_sweep || has_modes))
        return options_refuse("only a matrix from pokes has", "--standard-errors");
    if (options->scene && (is_sweep || has_modes))
        return options_refuse(is_sweep ? "calibrate --hysteresis takes no scene; unexpected"
                                       : "calibrate --vibration takes no scene; unexpected",
                              options->scene);
    if (!options->scene && options->sets > 0)
        return options_refuse("--set changes a scene, and there is none; unexpected",
                              options->set[0]);
    return 0;
}

/*
 * Check that all required arguments of the command line are present, and that the user's prefix for
 * the names in generated C tables is not reserved for the library. Returns 0, or an exit code.
 */
static int check_words(const options *options)
{
    const command_entry *entry = &command_table[options->command];
    if (options->prefix && is_own_prefix(options->prefix))
        return options_refuse("the library's own names start with --prefix", options->prefix);
    if (entry->kind == ARGUMENT_SCENE && *entry->argument != '[' && !options->scene)
        return options_refuse("name a scene for", entry->name);
    if (options->command == COMMAND_FMU && options->wants_plant == options->wants_controller)
        return options_refuse("write either --plant or --controller for", entry->name);
    if ((options->command == COMMAND_TABLES || options->command == COMMAND_FMU) && !options->output)
        return options_refuse("say where to write with -o FILE for", entry->name);
    return options->command == COMMAND_CALIBRATE ? check_calibrate(options) : 0;
}

/* ---- files ------------------------------------------------------------ */

static int stat_folder(const char *path, struct stat *there)
{
    char folder[OPTIONS_PATH];
    const char *const slash = strrchr(path, '/');
    snprintf(folder, sizeof folder, "%s", ".");
    if (slash)
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - path + 1), path);
    return stat(folder, there);
}

/* Whether two paths lead to one file, even if they are written differently. */
static int same_file(const char *first, const char *second)
{
    struct stat first_status, second_status;
    const char *const end_a = strrchr(first, '/'), *const end_b = strrchr(second, '/');
    if (strcmp(first, second) == 0)
        return 1;
    if (stat(first, &first_status) == 0 && stat(second, &second_status) == 0)
        return S_ISREG(first_status.st_mode) && first_status.st_dev == second_status.st_dev &&
               first_status.st_ino == second_status.st_ino;
    const char *const name_a = end_a ? end_a + 1 : first;
    const char *const name_b = end_b ? end_b + 1 : second;
    return strcmp(name_a, name_b) == 0 && stat_folder(first, &first_status) == 0 &&
           stat_folder(second, &second_status) == 0 &&
           first_status.st_dev == second_status.st_dev &&
           first_status.st_ino == second_status.st_ino;
}

/* Whether the path of an output file, which may be NULL, stands for standard output. */
static bool is_stdout(const char *path)
{
    return path && strcmp(path, "-") == 0;
}

/* Refuse output files that would overwrite each other or the scene. Returns 0, or an exit code. */
static int check_files(const options *options)
{
    char scene_path[OPTIONS_PATH];
    enum { FILES = 10 };
    const char *const file[FILES] = {
        scene_path,   options->report,         options->svg,      options->vtu,
        options->csv, options->output,         options->voltages, options->shapes,
        options->npz, options->standard_errors};
    scene_path[0] = '\0';
    if (options->scene)
        shipped_path(options->scene, scene_path);
    for (int i = 1; i < FILES; i++)
        for (int j = 0; j < i; j++)
            if (file[i] && file[j] && same_file(file[i], file[j]))
                return options_refuse("two files under one name:", file[i]);
    return 0;
}

/*
 * Find out whether an output file is "-", which stands for standard output. Refused are binary
 * files, folders, and a second text (the results as JSON) on standard output. Returns 0, or an exit
 * code.
 */
static int check_stdout(options *options)
{
    const char *const text[] = {options->report, options->svg,    options->vtu,
                                options->csv,    options->output, options->standard_errors};
    const bool is_fmu = options->command == COMMAND_FMU;
    if (is_stdout(options->npz) || (is_fmu && is_stdout(options->output)))
        return options_refuse("a binary file does not go to standard output; name a file, not",
                              "-");
    if (is_stdout(options->csv_folder))
        return options_refuse("several files do not go to standard output; name a folder, not",
                              "-");
    for (size_t k = 0; k < sizeof text / sizeof *text; k++)
        options->uses_stdout |= is_stdout(text[k]);
    if (options->uses_stdout && options->as_json)
        return options_refuse("--json goes to standard output, too; name a file, not", "-");
    return 0;
}

int options_read(options *options, command_id command, int argc, char **argv)
{
    memset(options, 0, sizeof *options);
    options->command = command;
    options->words = argc;
    options->words_given = argv;
    int wrong = parse(options, argc, argv);
    if (!wrong)
        wrong = check_words(options);
    if (!wrong && (options->scene || options->command == COMMAND_CALIBRATE))
        wrong = check_files(options);
    return wrong ? wrong : check_stdout(options);
}
