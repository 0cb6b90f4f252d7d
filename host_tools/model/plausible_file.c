/* SPDX-License-Identifier: BSD-2-Clause */
/* Plausibility rules on a mesh from a file (plausible_parts.h). */
#include "plausible_parts.h"

#include <stdio.h>

int measure_sharp_edge(const subject *of, int k, measured *found)
{
    const scene_quads *quads = of->scene->quads;
    if (k > 0 || !quads || !(quads->warnings.sharp_angle > 0))
        return 0;
    found->at = quads->at;
    found->value = quads->warnings.sharp_angle;
    snprintf(found->what, WHAT, "angle between elements %lld and %lld of the mesh file",
             (long long)quads->warnings.sharp[0], (long long)quads->warnings.sharp[1]);
    return 1;
}

int measure_place(const subject *of, int k, measured *found)
{
    const scene_quads *quads = of->scene->quads;
    if (k > 0 || !quads || !(quads->place_gap > 0))
        return 0;
    found->at = quads->place_at;
    found->value = quads->place_gap;
    snprintf(found->what, WHAT, "distance of the place from the nearest node%s%.0lld, used instead",
             quads->place_node ? " " : "", (long long)quads->place_node);
    return 1;
}

int measure_slit(const subject *of, int k, measured *found)
{
    const scene_quads *quads = of->scene->quads;
    if (k > 0 || !quads)
        return 0;
    found->at = quads->at;
    found->value = (double)quads->warnings.slits;
    snprintf(found->what, WHAT,
             "nodes of the mesh file at one place that are not joined, first %lld and %lld",
             (long long)quads->warnings.slit[0], (long long)quads->warnings.slit[1]);
    return 1;
}
