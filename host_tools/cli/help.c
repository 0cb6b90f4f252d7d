/* SPDX-License-Identifier: BSD-2-Clause */
/* Help texts of pzs (help.h). */
#include "help.h"
#include "keys.h"
#include "../text/wrap.h"
#include <string.h>

enum { OPTION_COLUMN = 22, COMMAND_COLUMN = 30 };

/*
 * Print the commands that accept an option before the help of the option. Nothing is printed if all
 * commands that take a scene accept the option, or in the help of a single command. Returns the
 * number of characters printed.
 */
static int print_takers(FILE *file, option_id option)
{
    int taken = 0, width = 0;
    for (int k = COMMAND_CHECK; k <= COMMAND_SIMULATE; k++)
        taken += command_takes((command_id)k, option);
    if (taken == 0 || taken > 4)
        return 0;
    for (int k = COMMAND_CHECK; k <= COMMAND_SIMULATE; k++)
        if (command_takes((command_id)k, option))
            width += fprintf(file, "%s%s", width ? ", " : "", command_table[k].name);
    return width + fprintf(file, ": ");
}

static void print_option(FILE *file, option_id option, int with_takers)
{
    const option_entry *entry = &option_table[option];
    char head[OPTION_COLUMN + 16];
    snprintf(head, sizeof head, "%s %s", entry->name, entry->argument);
    if (entry->other)
        snprintf(head, sizeof head, "%s, %s %s", entry->other, entry->name, entry->argument);
    fprintf(file, "  %-*s ", OPTION_COLUMN - 3, head);
    const int width = with_takers ? print_takers(file, option) : 0;
    wrap_print(file, entry->help, OPTION_COLUMN + width, OPTION_COLUMN);
}

void help_all(FILE *file)
{
    fprintf(file, "pzs - %s\n\n", command_title);
    for (int k = 0; k < COMMANDS; k++) {
        char head[COMMAND_COLUMN + 16];
        snprintf(head, sizeof head, "pzs %s %s", command_table[k].name, command_table[k].argument);
        if (strlen(head) > COMMAND_COLUMN)
            snprintf(head, sizeof head, "pzs %s ...", command_table[k].name);
        fprintf(file, "  %-*s %s\n", COMMAND_COLUMN + 1, head, command_table[k].summary);
    }
    fputs("\nSCENE is a file, or the name of a shipped scene. Options:\n", file);
    for (int k = 0; k < OPTIONS; k++)
        print_option(file, (option_id)k, 1);
    fputs("\nExamples:\n", file);
    for (int k = COMMAND_CHECK; k <= COMMAND_SIMULATE; k++)
        fprintf(file, "  %s\n", command_table[k].example[0]);
    for (int k = 0; command_notes[k]; k++) {
        fputc('\n', file);
        wrap_print(file, command_notes[k], 0, 0);
    }
}

void help_command(FILE *file, command_id command)
{
    const command_entry *entry = &command_table[command];
    fprintf(file, "usage: pzs %s%s%s [options]\n\n", entry->name, *entry->argument ? " " : "",
            entry->argument);
    wrap_print(file, entry->about, 0, 0);
    fputs("\nOptions:\n", file);
    for (int k = 0; k < OPTIONS; k++)
        if (command_takes(command, (option_id)k))
            print_option(file, (option_id)k, 0);
    fputs("\nExamples:\n", file);
    for (int k = 0; entry->example[k]; k++)
        fprintf(file, "  %s\n", entry->example[k]);
    if (command == COMMAND_KEYS) {
        fputs("\nKeys:\n", file);
        keys_print(file, NULL);
    }
}
