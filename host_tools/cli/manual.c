/* SPDX-License-Identifier: BSD-2-Clause */
/* Manual page and shell completion of pzs (manual.h). */
#include "manual.h"
#include "keys.h"
#include "commands.h"
#include "pzs.h"

/* ---- manual page ------------------------------------------------------ */

/* Write a text in which all characters with a special meaning in roff are escaped. */
static void roff(FILE *file, const char *text)
{
    if (*text == '.' || *text == '\'')
        fputs("\\&", file);
    for (; *text; text++)
        switch (*text) {
        case '\\': fputs("\\e", file); break;
        case '-': fputs("\\-", file); break;
        case '\'': fputs("\\(aq", file); break;
        case '`': fputs("\\(ga", file); break;
        default: fputc(*text, file);
        }
}

static void bold(FILE *file, const char *text)
{
    fputs("\\fB", file);
    roff(file, text);
    fputs("\\fR", file);
}

static void paragraph(FILE *file, const char *text)
{
    fputs(".PP\n", file);
    roff(file, text);
    fputc('\n', file);
}

/*
 * Write to the manual page, in italics, the commands that accept an option, after the help of the
 * option.
 */
static void page_takers(FILE *file, option_id option)
{
    const char *between = "Commands: ";
    for (int k = 0; k < COMMANDS; k++)
        if (command_takes((command_id)k, option)) {
            fprintf(file, "%s\\fI%s\\fR", between, command_table[k].name);
            between = ", ";
        }
    if (option_table[option].commands)
        fputs(".\n", file);
}

static void page_option(FILE *file, option_id option)
{
    const option_entry *entry = &option_table[option];
    fputs(".TP\n", file);
    bold(file, entry->name);
    if (entry->other) {
        fputs(", ", file);
        bold(file, entry->other);
    }
    fputc(' ', file);
    roff(file, entry->argument);
    fputc('\n', file);
    roff(file, entry->help);
    fputs(".\n", file);
    page_takers(file, option);
}

static void page_command(FILE *file, const command_entry *entry)
{
    fputs(".TP\n", file);
    bold(file, entry->name);
    fputc(' ', file);
    roff(file, entry->argument);
    fputc('\n', file);
    roff(file, entry->about);
    fputc('\n', file);
}

static void page_examples(FILE *file)
{
    for (int k = 0; k < COMMANDS; k++)
        for (int i = 0; command_table[k].example[i]; i++) {
            fputs(".PP\n.nf\n", file);
            roff(file, command_table[k].example[i]);
            fputs("\n.fi\n", file);
        }
}

void manual_page(FILE *file)
{
    fprintf(file, ".TH PZS 1 \"\" \"piezoshape %s\" \"User Commands\"\n.SH NAME\npzs \\- ",
            PZS_VERSION_TEXT);
    roff(file, command_title);
    fputs("\n.SH SYNOPSIS\n.B pzs\n.I COMMAND\n[argument] [options]\n.SH COMMANDS\n", file);
    for (int k = 0; k < COMMANDS; k++)
        page_command(file, &command_table[k]);
    fputs(".SH OPTIONS\n", file);
    for (int k = 0; k < OPTIONS; k++)
        page_option(file, (option_id)k);
    fputs(".SH EXAMPLES\n", file);
    page_examples(file);
    fputs(".SH NOTES\n", file);
    for (int k = 0; command_notes[k]; k++)
        paragraph(file, command_notes[k]);
    fputs(".SH ENVIRONMENT\n.TP\n.B PZS_SCENES\nFolder of the shipped scenes.\n.TP\n.B "
          "PZS_SOURCES\nFolder of the sources, for simulate \\-\\-device.\n.TP\n.B PZS_THREADS\n"
          "Number of threads that test the stability of a loop; default: one for each processor. "
          "The results do not depend on it.\n.TP\n.B TMPDIR\n"
          "Folder for the firmware that simulate \\-\\-device builds; default /tmp.\n",
          file);
}

/* ---- completion ------------------------------------------------------- */

static void choices(FILE *file, const char *const *choice)
{
    for (int k = 0; choice[k]; k++)
        fprintf(file, "%s%s", k ? " " : "", choice[k]);
}

static void command_names(FILE *file)
{
    for (int k = 0; k < COMMANDS; k++)
        fprintf(file, "%s%s", k ? " " : "", command_table[k].name);
}

/* Write the shell completion of the argument of each option. */
static void complete_values(FILE *file)
{
    for (int k = 0; k < OPTIONS; k++) {
        const option_entry *entry = &option_table[k];
        if (entry->kind == ARGUMENT_NONE)
            continue;
        fprintf(file, "    %s)\n        ", entry->name);
        if (entry->kind == ARGUMENT_FILE) {
            fputs("COMPREPLY=($(compgen -f -- \"$word\"))", file);
        } else if (entry->kind == ARGUMENT_CHOICE) {
            fputs("COMPREPLY=($(compgen -W \"", file);
            choices(file, entry->choices);
            fputs("\" -- \"$word\"))", file);
        } else {
            fputs("COMPREPLY=()", file);
        }
        fputs("\n        return ;;\n", file);
    }
}

/* Write the shell completion of the argument of a command: fixed words, or files for a scene. */
static void complete_argument(FILE *file, const command_entry *entry)
{
    switch (entry->kind) {
    case ARGUMENT_SCENE: fputs("$(pzs list 2>/dev/null | cut -d' ' -f1)", file); break;
    case ARGUMENT_COMMAND: command_names(file); break;
    case ARGUMENT_CHOICE: choices(file, entry->choices); break;
    case ARGUMENT_SECTION: keys_names(file); break;
    case ARGUMENT_NONE:
    case ARGUMENT_FILE:
    case ARGUMENT_TEXT: break;
    }
}

static void complete_command(FILE *file, command_id command)
{
    const command_entry *entry = &command_table[command];
    fprintf(file, "    %s)\n        options=\"", entry->name);
    for (int k = 0; k < OPTIONS; k++)
        if (command_takes(command, (option_id)k))
            fprintf(file, "%s ", option_table[k].name);
    fputs("\"\n        words=\"", file);
    complete_argument(file, entry);
    fprintf(file, "\"\n        files=%s ;;\n", entry->kind == ARGUMENT_SCENE ? "yes" : "");
}

void manual_completion(FILE *file)
{
    fputs("# bash completion of pzs, written by `pzs completion`\n_pzs()\n{\n"
          "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} options= "
          "words= files=\n"
          "    COMPREPLY=()\n    if [ \"$COMP_CWORD\" -eq 1 ]; then\n        COMPREPLY=($(compgen "
          "-W \"",
          file);
    command_names(file);
    fprintf(file, " %s %s %s\" -- \"$word\"))\n        return\n    fi\n    case $before in\n",
            option_table[OPTION_HELP].name, option_table[OPTION_VERSION].name,
            option_table[OPTION_MIGRATE].name);
    complete_values(file);
    fputs("    esac\n    case ${COMP_WORDS[1]} in\n", file);
    for (int k = 0; k < COMMANDS; k++)
        complete_command(file, (command_id)k);
    fputs("    esac\n    case $word in\n    -*) COMPREPLY=($(compgen -W \"$options\" -- "
          "\"$word\")) ;;\n"
          "    *) COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
          "       [ -z \"$files\" ] || COMPREPLY+=($(compgen -f -X '!*.yaml' -- \"$word\") "
          "$(compgen -d -- \"$word\")) ;;\n"
          "    esac\n}\ncomplete -o filenames -F _pzs pzs\n",
          file);
}
