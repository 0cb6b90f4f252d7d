/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Section control.modal_gains of a scene file. Each mode (a shape) has a gain, the part of a wanted
 * change that a control tick makes, and a leak, the part of the mode's coordinate that is lost in a
 * tick.
 */
#include "scene_file.h"
#include "scene_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_MODES = 4096 };

/* The section control.modal_gains as it is written in the scene file. */
typedef struct modal_gains_text {
    int modes, gain, leak; /* YAML nodes of the keys `modes`, `gain` and `leak`; 0 for a key that is
                              absent */
    double other_gain, other_leak; /* gain and leak of the voltages that belong to no mode; NAN
                                      where the scene file does not give them */
} modal_gains_text;

static const range gain_range = {
    0, 2, 0, "must be from 0 to 2, and below 2 together with the leak; 1 goes all the way"};
static const range leak_range = {0, 1, 0, "must be from 0 (no leak) to 1 (no memory)"};
static const range mode_range = {1, MOST_MODES, 0, "must be from 1 to 4096"};

/* ---- modes ---------------------------------------------------------------- */

static const field modes_file_fields[] = {
    {"file", read_scalar_node, 0, NULL, 1, .form = &label_form,
     .help = "File with a row for each output or target node and a column for each mode, beside "
             "the scene file."},
    {.key = NULL}};

/*
 * Make mode k from a column of a table. Returns 0, or -1 after writing an error message about the
 * scene file.
 */
static int take_column(reader *reader, int node, const number_table *table, int k, scene_mode *mode)
{
    double *value = calloc(table->rows + 1, sizeof *value);
    if (!value)
        return tree_fault(reader->t, node, "out of memory");
    int failed = 0;
    for (size_t row = 0; row < table->rows && !failed; row++) {
        char place[NUMBER_NAME];
        value[row] = table->value[row * table->columns + (size_t)k];
        number_table_place(table, row, (size_t)k, place);
        if (!isfinite(value[row]))
            failed = tree_fault(reader->t, node, "%s of %.80s is not a finite number; correct it",
                                place, node_text(reader, node));
    }
    mode->at = node_at(reader, node);
    if (table->column_name)
        snprintf(mode->name, sizeof mode->name, "%.60s", table->column_name[k]);
    else
        snprintf(mode->name, sizeof mode->name, "column %d", k + 1);
    if (!failed)
        mode->value = expr_from_list(mode->name, table->rows, value);
    free(value);
    if (!failed && !mode->value)
        failed = tree_fault(reader->t, node, "out of memory");
    return failed;
}

/* Read modes from a file, one from each column. */
static int read_modes_file(reader *reader, int node, scene_modal_gains *gains)
{
    number_table table;
    int file = 0;
    if (read_map(reader, node, modes_file_fields, &file) != 0 ||
        scene_table_read(reader, file, &table) != 0)
        return -1;
    int failed = 0;
    if (table.columns < 1 || table.columns > MOST_MODES)
        failed = tree_fault(reader->t, file, "%d columns are out of range (1 to %d modes)",
                            (int)table.columns, MOST_MODES);
    if (!failed)
        gains->function = calloc(table.columns, sizeof *gains->function);
    if (!failed && !gains->function)
        failed = tree_fault(reader->t, file, "out of memory");
    for (int k = 0; !failed && k < (int)table.columns; k++) {
        gains->functions = k + 1;
        failed = take_column(reader, file, &table, k, &gains->function[k]);
    }
    number_table_free(&table);
    return failed;
}

static int read_modes_list(reader *reader, int node, scene_modal_gains *gains)
{
    int count;
    gains->function = new_items(reader, node, TREE_LIST, sizeof *gains->function, &count);
    if (!gains->function)
        return -1;
    if (count < 1 || count > MOST_MODES)
        return tree_fault(reader->t, node,
                          "%d modes are out of range (1 to %d); leave 'modes' out for one gain and "
                          "leak of everything",
                          count, MOST_MODES);
    return read_items(reader, node, gains->function, sizeof *gains->function, read_shape_function,
                      &gains->functions);
}

/* Read the modes: their number, a list of functions, or a file with a column for each. */
static int read_modes(reader *reader, int node, scene_modal_gains *gains)
{
    int failed = 0;
    if (reader->t->node[node].kind == TREE_LIST)
        failed = read_modes_list(reader, node, gains);
    else if (reader->t->node[node].kind == TREE_MAP)
        failed = read_modes_file(reader, node, gains);
    else
        return read_int(reader, node, &gains->modes, &mode_range);
    gains->modes = gains->functions;
    return failed;
}

/* ---- gains and leaks ------------------------------------------------------ */

static int check_range(reader *reader, int node, int k, double value, const range *range)
{
    if (value >= range->low && value <= range->high)
        return 0;
    return tree_fault(reader->t, node, "%g of mode %d %s", value, k + 1, range->must);
}

/*
 * Read one number for each mode of control.modal_gains, from a list or a file: the gains of the
 * modes in the control loop (part of a wanted change that a tick makes), or their leaks (part of
 * the mode's coordinate that is lost in a tick).
 */
static int read_each(reader *reader, int node, int modes, const range *range, double *value)
{
    scene_numbers list = {0, NULL};
    reader->of = OF_NUMBER;
    int failed = scene_numbers_read(reader, node, &list) != 0 ? -1 : 0;
    if (!failed && modes == 0)
        failed = tree_fault(reader->t, node,
                            "a list needs modes: their number, functions, or {file: ...}; add "
                            "modes, or write one number for everything");
    else if (!failed && list.count != modes)
        failed = tree_fault(reader->t, node,
                            "%d values for %d modes; give one for each, or one "
                            "number for all",
                            list.count, modes);
    for (int k = 0; k < modes && !failed; k++) {
        failed = check_range(reader, node, k, list.value[k], range);
        value[k] = list.value[k];
    }
    free(list.value);
    return failed;
}

/*
 * Read the gains or the leaks of the modes.
 *   node   in   YAML node of the key; 0: the key is absent, and every value is `absent`
 *   value  out  value of each mode; if the scene has no modes, one value, that of all shapes
 */
static int read_values(reader *reader, int node, int modes, const range *range, double absent,
                       double *value)
{
    double one = absent;
    if (node && reader->t->node[node].kind != TREE_SCALAR)
        return read_each(reader, node, modes, range, value);
    if (node && read_real(reader, node, &one, range) != 0)
        return -1;
    for (int k = 0; k < (modes > 0 ? modes : 1); k++)
        value[k] = one;
    return 0;
}

/*
 * Check that a gain (part of the wanted change that a control tick makes) and a leak (part that a
 * tick removes) allow the loop to come to rest. Returns 0, or -1 after writing an error message
 * about the scene file.
 */
static int check_sum(reader *reader, int node, const char *of, double gain, double leak)
{
    if (gain + leak < 2)
        return 0;
    return tree_fault(reader->t, node,
                      "gain %g plus leak %g%s is %g; it must be below 2, or the shape swings with "
                      "growing amplitude",
                      gain, leak, of, gain + leak);
}

static int check_sums(reader *reader, int node, const scene_modal_gains *gains)
{
    char of[40];
    for (int k = 0; k < gains->modes; k++) {
        snprintf(of, sizeof of, " of mode %d", k + 1);
        if (check_sum(reader, node, of, gains->gain[k], gains->leak[k]) != 0)
            return -1;
    }
    return check_sum(reader, node, gains->modes > 0 ? " (other_gain, other_leak)" : "",
                     gains->other_gain, gains->other_leak);
}

/*
 * Set other_gain and other_leak, the gain and the leak of all voltages that belong to no mode. If
 * the scene has no modes, these are all voltages, and the keys `gain` and `leak` give the two
 * numbers.
 */
static int take_others(reader *reader, int node, const modal_gains_text *text,
                       scene_modal_gains *gains)
{
    const bool is_given = !isnan(text->other_gain) || !isnan(text->other_leak);
    if (gains->modes == 0 && is_given)
        return tree_fault(reader->t, node,
                          "other_gain and other_leak are those of what is not in the modes, but "
                          "there are none; add modes, or write gain and leak alone");
    gains->other_gain = isnan(text->other_gain) ? 1 : text->other_gain;
    gains->other_leak = isnan(text->other_leak) ? 0 : text->other_leak;
    if (gains->modes == 0) {
        gains->other_gain = gains->gain[0];
        gains->other_leak = gains->leak[0];
    }
    return 0;
}

static const form whole_form = {.type = FORM_WHOLE, .range = &mode_range};
static const form functions_form = {
    .type = FORM_LIST, .item = &row_function_form, .least = 1, .most = MOST_MODES};
static const form modes_file_form = {.type = FORM_MAP, .fields = modes_file_fields};
static const form *const modes_forms[] = {&whole_form, &functions_form, &modes_file_form, NULL};
static const form modes_form = {.type = FORM_ANY, .any = modes_forms};

static const form gain_form = {.type = FORM_NUMBER, .range = &gain_range};
static const form leak_form = {.type = FORM_NUMBER, .range = &leak_range};
static const form gain_list_form = {.type = FORM_LIST, .item = &gain_form, .least = 1};
static const form leak_list_form = {.type = FORM_LIST, .item = &leak_form, .least = 1};
static const form *const gain_forms[] = {&gain_form, &gain_list_form, &list_file_form, NULL};
static const form *const leak_forms[] = {&leak_form, &leak_list_form, &list_file_form, NULL};
static const form gains_form = {.type = FORM_ANY, .any = gain_forms};
static const form leaks_form = {.type = FORM_ANY, .any = leak_forms};

static const field modal_gains_fields[] = {
    {"modes", read_node, offsetof(modal_gains_text, modes), .of = OF_NUMBER, .form = &modes_form,
     .help = "Modes with gains and leaks of their own: so many singular vectors of the influence "
             "matrix, those with the largest singular values; or functions such as piston, tip, "
             "tilt, zernike(4, x/0.1, y/0.1); or a file. Functions are made orthonormal in their "
             "order, as far as the actuators can make them. Default: no modes, one gain and leak "
             "of everything."},
    {"gain", read_node, offsetof(modal_gains_text, gain), .of = OF_NUMBER, .form = &gains_form,
     .help = "Part of the way to the optimum that a tick goes in each mode, 0 to below 2: one "
             "number, or a list or file with one for each mode; default 1."},
    {"leak", read_node, offsetof(modal_gains_text, leak), .of = OF_NUMBER, .form = &leaks_form,
     .help = "Part of the way back to the reference voltages that a tick goes in each mode, 0 to "
             "1: one number, or a list or file with one for each mode; default 0."},
    {"other_gain", read_real, offsetof(modal_gains_text, other_gain), &gain_range, .of = OF_NUMBER,
     .help = "Gain of all that is not in the modes; default 1; 0 leaves them out of the control."},
    {"other_leak", read_real, offsetof(modal_gains_text, other_leak), &leak_range, .of = OF_NUMBER,
     .help = "Leak of all that is not in the modes; default 0."},
    {.key = NULL}};

const form modal_gains_form = {.type = FORM_MAP, .fields = modal_gains_fields};

int read_modal_gains(reader *reader, int node, void *to, const void *rule)
{
    scene_modal_gains *gains = &reader->s->control.modal_gains;
    modal_gains_text text = {.other_gain = (double)NAN, .other_leak = (double)NAN};
    (void)to;
    (void)rule;
    gains->at = node_at(reader, node);
    if (read_map(reader, node, modal_gains_fields, &text) != 0 ||
        (text.modes && read_modes(reader, text.modes, gains) != 0))
        return -1;
    gains->gain = calloc((size_t)gains->modes + 1, sizeof *gains->gain);
    gains->leak = calloc((size_t)gains->modes + 1, sizeof *gains->leak);
    if (!gains->gain || !gains->leak)
        return tree_fault(reader->t, node, "out of memory");
    gains->given = true;
    if (read_values(reader, text.gain, gains->modes, &gain_range, 1, gains->gain) != 0 ||
        read_values(reader, text.leak, gains->modes, &leak_range, 0, gains->leak) != 0 ||
        take_others(reader, node, &text, gains) != 0)
        return -1;
    return check_sums(reader, node, gains);
}
