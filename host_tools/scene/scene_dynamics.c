/* SPDX-License-Identifier: BSD-2-Clause */
/* Sections `dynamics` (data for vibration in addition to the densities) and `control`. */
#include "scene_parts.h"

int read_dynamics(reader *reader, int node, void *to, const void *rule)
{
    static const range ratio = {
        0, 1, 1, "must lie between 0 and 1, ends left out; it is a part of critical damping"};
    static const range counted = {1, 200, 0, "must be from 1 to 200"};
    static const field fields[] = {
        {"damping", read_real, offsetof(scene_dynamics, damping), &ratio, 0},
        {"modes", read_int, offsetof(scene_dynamics, modes), &counted, 0},
        {"mass_per_area", read_real, offsetof(scene_dynamics, mass_per_area), &not_negative, 0},
        {NULL, NULL, 0, NULL, 0}};
    scene *scene = to;
    (void)rule;
    scene->dynamics.damping_given = tree_find(reader->t, node, "damping") != 0;
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
