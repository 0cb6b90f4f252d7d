/* SPDX-License-Identifier: BSD-2-Clause */
/* Section `estimate` of a scene: the outputs from which the firmware estimates the shape. */
#include "scene_parts.h"

#include <math.h>

static int read_output_of(reader *reader, int node, void *to, const void *rule)
{
    const scene *scene = reader->s;
    char name[SCENE_NAME];
    int i;
    if (read_name(reader, node, name, rule) != 0)
        return -1;
    i = find_named(scene->output, scene->outputs, sizeof *scene->output, name);
    if (i < 0)
        return tree_fault(reader->t, node, "there is no output '%s'; add it to outputs", name);
    if (scene->output[i].contact != CONTACT_NONE)
        return tree_fault(
            reader->t, node,
            "'%s' is of a contact; an estimate reads displacements, voltages and charges", name);
    *(int *)to = i;
    return 0;
}

static int read_readings(reader *reader, int node, void *to, const void *rule)
{
    static const range noisy = {0, HUGE_VAL, 1, "must be above 0; no sensor is exact"};
    static const field fields[] = {
        {"output", read_output_of, offsetof(scene_reading, output), NULL, 1},
        {"noise", read_real, offsetof(scene_reading, noise), &noisy, 1},
        {NULL, NULL, 0, NULL, 0}};
    scene_estimate *estimate = to;
    int i, k = 0;
    (void)rule;
    estimate->reading =
        new_items(reader, node, TREE_LIST, sizeof *estimate->reading, &estimate->readings);
    if (!estimate->reading)
        return -1;
    if (estimate->readings == 0)
        return tree_fault(reader->t, node,
                          "'readings' is empty; write [{output: name, noise: 1e-6}]");
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++) {
        estimate->reading[k].at = node_at(reader, i);
        if (read_map(reader, i, fields, &estimate->reading[k]) != 0)
            return -1;
    }
    return 0;
}

int read_estimate(reader *reader, int node, void *to, const void *rule)
{
    static const range part = {
        0, 1, 1, "must lie between 0 and 1, ends left out; it is a part of the disturbance"};
    static const field fields[] = {
        {"readings", read_readings, 0, NULL, 1},
        {"loads", read_real, offsetof(scene_estimate, loads), &not_negative, 0},
        {"voltages", read_real, offsetof(scene_estimate, voltages), &not_negative, 0},
        {"tolerance", read_real, offsetof(scene_estimate, tolerance), &part, 0},
        {NULL, NULL, 0, NULL, 0}};
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
    if (read_map(reader, node, fields, &scene->estimate) != 0)
        return -1;
    scene->estimate.given = 1;
    return 0;
}
