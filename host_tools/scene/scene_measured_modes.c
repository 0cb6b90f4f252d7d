/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Key `modes` of the section `influence` of a scene: vibration modes of a structure whose influence
 * matrix is measured.
 */
#include "scene_file.h"
#include "scene_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_MODES = 200 };

/* One vibration mode of a structure with a measured influence matrix, as a scene file states it. */
typedef struct mode_text {
    double frequency, damping; /* natural frequency of the vibration mode (Hz), and damping ratio,
                                  which is 0 if the scene file gives none */
    int shape, response;       /* YAML nodes of the keys `shape` (displacement of each output in the
                                  vibration mode) and `response` (static response of the mode to 1 V
                                  of each actuator, as a multiple of the shape); 0: no such key */
} mode_text;

static const range ratio = {
    0, 1, 1,
    "must lie between 0 and 1, ends left out; it is a part of critical damping: "
    "write 0.01 for 1 %"};

static const field mode_fields[] = {
    {"frequency", read_real, offsetof(mode_text, frequency), &above_zero, 1, .of = OF_RATE,
     .help = "Natural frequency of the mode."},
    {"damping", read_real, offsetof(mode_text, damping), &ratio, .of = OF_NUMBER,
     .help = "Damping of the mode as a ratio to critical damping; default 0.005."},
    {"shape", read_node, offsetof(mode_text, shape), .required = 1, .of = OF_NUMBER,
     .form = &numbers_form,
     .help = "Displacement of each output of the matrix in the mode, ignored ones included, in any "
             "unit: a list or {file: ..., column: ...}."},
    {"response", read_node, offsetof(mode_text, response), .of = OF_NUMBER, .form = &numbers_form,
     .help = "Static part of the mode in the response to 1 V of each actuator, as a multiple of "
             "its shape; default from the matrix, by least squares of all modes."},
    {.key = NULL}};

static const form mode_form = {.type = FORM_MAP, .fields = mode_fields};
const form measured_modes_form = {
    .type = FORM_LIST, .item = &mode_form, .least = 1, .most = MOST_MODES};

/*
 * Read a list of numbers of a given length. Returns NULL after writing an error message about the
 * scene file.
 */
static double *read_numbers(reader *reader, int node, int count, const char *what)
{
    scene_numbers list;
    reader->of = OF_NUMBER;
    if (scene_numbers_read(reader, node, &list) != 0)
        return NULL;
    if (list.count == count)
        return list.value;
    tree_fault(reader->t, node, "%d values for %d %s of the matrix; give one for each%s",
               list.count, count, what, scene_transposed_hint(reader->s));
    free(list.value);
    return NULL;
}

/*
 * Remove the displacements of outputs that the scene ignores from the shape of a vibration mode.
 *   shape [outputs of the file] in/out  displacement of each output of the influence matrix in the
 *       file; afterwards those of the outputs that the scene uses come first
 */
static void drop_ignored(const scene_influence *influence, double *shape)
{
    for (int i = 0; i < influence->outputs; i++)
        shape[i] = shape[influence->row[i]];
}

static bool is_zero(const double *value, int count)
{
    int zeros = 0;
    while (zeros < count && fpclassify(value[zeros]) == FP_ZERO)
        zeros++;
    return zeros == count;
}

static int read_mode(reader *reader, int node, void *item)
{
    scene *scene = reader->s;
    scene_influence *influence = &scene->influence;
    scene_measured_mode *mode = item;
    mode_text text = {0, 0, 0, 0};
    if (read_map(reader, node, mode_fields, &text) != 0)
        return -1;
    if (mode > influence->mode && text.frequency < mode[-1].frequency)
        return tree_fault(reader->t, node,
                          "a mode of %g Hz after one of %g Hz; write the modes in the order of "
                          "their frequencies",
                          text.frequency, mode[-1].frequency);
    mode->frequency = text.frequency;
    scene->dynamics.damping_given |= text.damping > 0;
    scene->dynamics.damping_of_mode[mode - influence->mode] =
        text.damping > 0 ? text.damping : scene->dynamics.damping;
    mode->shape = read_numbers(reader, text.shape, influence->file_outputs, "outputs");
    if (!mode->shape)
        return -1;
    drop_ignored(influence, mode->shape);
    if (is_zero(mode->shape, influence->outputs))
        return tree_fault(reader->t, text.shape,
                          "the shape of mode %d is 0 at every output that is used; leave the mode "
                          "out, or correct its column and scale",
                          (int)(mode - influence->mode) + 1);
    if (!text.response != !influence->mode[0].response && mode > influence->mode)
        return tree_fault(reader->t, node,
                          "some modes have a response and some have none; give that of every mode, "
                          "or none to have them fitted to the matrix");
    if (!text.response)
        return 0;
    const int actuators = influence->tied > 0 ? influence->tied : scene->amplifiers;
    mode->response = read_numbers(reader, text.response, actuators, "actuators");
    if (!mode->response)
        return -1;
    scene_tied_sum(influence, mode->response);
    return 0;
}

int read_measured_modes(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    scene_influence *influence = &scene->influence;
    scene_dynamics *dynamics = &scene->dynamics;
    (void)rule;
    influence->mode =
        new_items(reader, node, TREE_LIST, sizeof *influence->mode, &influence->modes);
    if (!influence->mode)
        return -1;
    if (influence->modes < 1 || influence->modes > MOST_MODES)
        return tree_fault(reader->t, node, "%d modes are out of range (1 to %d)", influence->modes,
                          MOST_MODES);
    dynamics->dampings = influence->modes;
    dynamics->damping_of_mode = calloc((size_t)influence->modes, sizeof *dynamics->damping_of_mode);
    if (!dynamics->damping_of_mode)
        return tree_fault(reader->t, node, "out of memory");
    if (read_items(reader, node, influence->mode, sizeof *influence->mode, read_mode, NULL) != 0)
        return -1;
    dynamics->damping = dynamics->damping_of_mode[0];
    return 0;
}
