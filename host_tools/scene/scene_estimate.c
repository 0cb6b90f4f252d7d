/* SPDX-License-Identifier: BSD-2-Clause */
/* Section `estimate` of a scene file: the outputs from which the firmware estimates the shape. */
#include "scene_output.h"

#include <math.h>

static bool is_readable(const scene_output_info *info, const char *key)
{
    (void)key;
    return info->reading != READING_NEVER;
}

/*
 * Check that a sensor of the device can measure an output, by the table of the types of outputs:
 * stresses and reactions never, strains only under linear kinematics. Returns 0, or -1 after
 * writing an error message about the scene file.
 */
static int check_reading(reader *reader, int node, const scene_output *output)
{
    const scene_output_info *info = scene_output_info_of(output->type);
    char readable[SCENE_OUTPUT_WORDS];
    scene_output_words(is_readable, NULL, readable, sizeof readable);
    if (info->reading == READING_NEVER)
        return tree_fault(reader->t, node, "'%s' is a %s, which no sensor measures; use a %s",
                          output->name, info->word, readable);
    if (info->reading == READING_LINEAR && reader->s->kinematics != KINEMATICS_LINEAR)
        return tree_fault(reader->t, node,
                          "'%s' is a %s, which is linear in the displacement only with "
                          "kinematics: linear; remove this reading",
                          output->name, info->word);
    return 0;
}

static int read_output_of(reader *reader, int node, void *to, const void *rule)
{
    const scene *scene = reader->s;
    int *index = to;
    (void)rule;
    if (read_index(reader, node, scene->output, scene->outputs, sizeof *scene->output,
                   "there is no output '%s'; add it to outputs", index) != 0)
        return -1;
    const scene_output *output = &scene->output[*index];
    return check_reading(reader, node, output);
}

static const range noisy = {0, HUGE_VAL, 1, "must be above 0; no sensor is exact"};

static const field reading_fields[] = {
    {"output", read_output_of, offsetof(scene_reading, output), .required = 1, .form = &name_form,
     .help = "Name of an output that a sensor of the firmware measures."},
    {"noise", read_real, offsetof(scene_reading, noise), &noisy, 1, .of = OF_READING,
     .help = "Standard deviation of the noise, in the unit of the output."},
    {"range", read_real, offsetof(scene_reading, range), &above_zero, .of = OF_READING,
     .help = "Largest believable size of the reading, in the unit of the output; the loop takes a "
             "larger one as missing. Default: four times what voltages and loads can make, where "
             "the scene has control.sensor_gate; otherwise none."},
    {.key = NULL}};

static int read_reading(reader *reader, int node, void *item)
{
    scene_reading *reading = item;
    reading->at = node_at(reader, node);
    return read_map(reader, node, reading_fields, reading);
}

static int read_readings(reader *reader, int node, void *to, const void *rule)
{
    scene_estimate *estimate = to;
    (void)rule;
    estimate->reading =
        new_items(reader, node, TREE_LIST, sizeof *estimate->reading, &estimate->readings);
    if (!estimate->reading)
        return -1;
    if (estimate->readings == 0)
        return tree_fault(reader->t, node,
                          "'readings' is empty; write [{output: name, noise: 1e-6}]");
    return read_items(reader, node, estimate->reading, sizeof *estimate->reading, read_reading,
                      NULL);
}

static const range part = {
    0, 1, 1, "must lie between 0 and 1, ends left out; it is a part of the disturbance"};
static const form reading_form = {.type = FORM_MAP, .fields = reading_fields};
static const form readings_form = {.type = FORM_LIST, .item = &reading_form, .least = 1};

static const field estimate_fields[] = {
    {"readings", read_readings, 0, .required = 1, .form = &readings_form,
     .help = "Measurements of the firmware; an output with several values is as many sensors."},
    {"loads", read_real, offsetof(scene_estimate, loads), &not_negative, .of = OF_NUMBER,
     .help = "Standard deviation of the factor of every load, which may disturb the shape; "
             "default 1, the load as the scene states it."},
    {"voltages", read_real, offsetof(scene_estimate, voltages), &not_negative, .of = OF_VOLTAGE,
     .help = "Standard deviation of the voltage error of every electrode; default a tenth of half "
             "the voltage range, or 1 V without limits."},
    {"tolerance", read_real, offsetof(scene_estimate, tolerance), &part, .of = OF_NUMBER,
     .help = "Largest part of the disturbance that the estimate may leave unobserved; the readings "
             "are refused if more remains; default 0.5."},
    {.key = NULL}};

const form estimate_form = {.type = FORM_MAP, .fields = estimate_fields};

int read_estimate(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->estimate.at = node_at(reader, node);
    scene->estimate.loads = 1;
    scene->estimate.voltages = -1;
    scene->estimate.tolerance = 0.5;
    if (!scene->target.given)
        return tree_fault(reader->t, node,
                          "an estimate needs a target, whose nodes it is for; add target: {u3: "
                          "middle, at: nodes, "
                          "value: ...}");
    if (read_map(reader, node, estimate_fields, &scene->estimate) != 0)
        return -1;
    scene->estimate.given = true;
    return 0;
}
