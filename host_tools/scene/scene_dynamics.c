/* SPDX-License-Identifier: BSD-2-Clause */
/* Sections `dynamics` (data for vibration in addition to the densities) and `control`. */
#include "scene_parts.h"

static const range ratio = {
    0, 1, 1, "must lie between 0 and 1, ends left out; it is a part of critical damping"};

static int read_list(reader *reader, int node, scene_dynamics *dynamics)
{
    int i, k = 0;
    dynamics->damping_of_mode =
        new_items(reader, node, TREE_LIST, sizeof *dynamics->damping_of_mode, &dynamics->dampings);
    if (!dynamics->damping_of_mode)
        return -1;
    if (dynamics->dampings == 0)
        return tree_fault(reader->t, node,
                          "'damping' is an empty list; give a ratio for each of "
                          "the first modes");
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++)
        if (read_real(reader, i, &dynamics->damping_of_mode[k], &ratio) != 0)
            return -1;
    dynamics->damping = dynamics->damping_of_mode[0];
    return 0;
}

static int read_rayleigh(reader *reader, int node, void *to, const void *rule)
{
    scene_dynamics *dynamics = to;
    dynamics->is_rayleigh = 1;
    return read_pair(reader, node, dynamics->rayleigh, rule);
}

/* Read one ratio, a list of ratios, or {rayleigh: [a, b]}. */
static int read_damping(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {{"rayleigh", read_rayleigh, 0, &not_negative, 1},
                                   {NULL, NULL, 0, NULL, 0}};
    scene_dynamics *dynamics = to;
    (void)rule;
    dynamics->damping_given = 1;
    if (reader->t->node[node].kind == TREE_LIST)
        return read_list(reader, node, dynamics);
    if (reader->t->node[node].kind != TREE_MAP)
        return read_real(reader, node, &dynamics->damping, &ratio);
    if (read_map(reader, node, fields, dynamics) != 0)
        return -1;
    if (dynamics->rayleigh[0] + dynamics->rayleigh[1] > 0)
        return 0;
    return tree_fault(reader->t, node, "both of Rayleigh's coefficients are 0; one must be above");
}

int read_dynamics(reader *reader, int node, void *to, const void *rule)
{
    static const range counted = {1, 200, 0, "must be from 1 to 200"};
    static const field fields[] = {
        {"damping", read_damping, 0, NULL, 0},
        {"modes", read_int, offsetof(scene_dynamics, modes), &counted, 0},
        {"mass_per_area", read_real, offsetof(scene_dynamics, mass_per_area), &not_negative, 0},
        {NULL, NULL, 0, NULL, 0}};
    scene *scene = to;
    (void)rule;
    return read_map(reader, node, fields, &scene->dynamics);
}

int read_control(reader *reader, int node, void *to, const void *rule)
{
    static const field fields[] = {
        {"rate", read_real, offsetof(scene_control, rate), &above_zero, 0},
        {NULL, NULL, 0, NULL, 0}};
    scene *scene = to;
    (void)rule;
    return read_map(reader, node, fields, &scene->control);
}
