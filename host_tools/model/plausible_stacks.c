/* SPDX-License-Identifier: BSD-2-Clause */
/* Plausibility rules on stacks and voice coils (plausible_parts.h). */
#include "plausible_parts.h"

#include <math.h>
#include <stdio.h>
#include "../scene/scene_units.h"

static const units_unit stiffness_unit = {{-1, 1, 0, 0, 0, 0}, 0, 0};
static const units_unit stroke_unit = {{1, 0, -1, 0, 0, 0}, 0, 0};
static const units_unit force_unit = {{0, 1, -1, 0, 0, 0}, 0, 0};
static const units_unit energy_unit = {{1, 1, -2, 0, 0, 0}, 0, 0};

/*
 * Find the stacks or voice coils of actuator k and set the result found->at to their position in
 * the scene file. Returns 0 if the scene has no actuator k; *stacks is NULL if the actuator drives
 * patches.
 */
static int stacks_of(const subject *of, int k, const scene_spring **stacks, measured *found)
{
    if (k >= of->scene->actuators)
        return 0;
    *stacks = of->scene->actuator[k].stacks;
    if (*stacks)
        found->at = (*stacks)->at;
    return 1;
}

int measure_stack_stiffness(const subject *of, int k, measured *found)
{
    const scene_spring *stacks;
    if (!stacks_of(of, k, &stacks, found))
        return 0;
    if (stacks && stacks->stiffness > 0)
        found->value = plausible_si(of->scene, stacks->stiffness, &stiffness_unit);
    snprintf(found->what, WHAT, "stiffness of the stacks '%s'", of->scene->actuator[k].name);
    return 1;
}

/*
 * Measure the free stroke of stack actuators per volt. It is 0 for stacks that are defined without
 * stroke and force.
 */
int measure_stack_stroke(const subject *of, int k, measured *found)
{
    const scene_spring *stacks;
    if (!stacks_of(of, k, &stacks, found))
        return 0;
    const bool is_idle = stacks && stacks->stroke == 0 && stacks->force == 0;
    if (stacks && (stacks->stroke != 0 || is_idle))
        found->value = plausible_si(of->scene, fabs(stacks->stroke), &stroke_unit);
    snprintf(found->what, WHAT, "stroke of the stacks '%s'", of->scene->actuator[k].name);
    return 1;
}

/*
 * Measure the stiffness of a stack times the square of its stroke per volt (F). This is the
 * difference between the capacitances of the free and of the clamped stack. Divided by the
 * capacitance of the free stack it is the squared coupling factor of the ceramic, which has an
 * upper limit.
 */
int measure_stack_energy(const subject *of, int k, measured *found)
{
    const scene_spring *stacks;
    if (!stacks_of(of, k, &stacks, found))
        return 0;
    if (stacks && stacks->stroke != 0)
        found->value = plausible_si(of->scene, stacks->stiffness * stacks->stroke * stacks->stroke,
                                    &energy_unit);
    snprintf(found->what, WHAT, "stiffness times squared stroke of the stacks '%s'",
             of->scene->actuator[k].name);
    return 1;
}

/*
 * Measure the force per volt of a voice coil, or of a stack for which the scene file gives a force.
 */
int measure_coil(const subject *of, int k, measured *found)
{
    const scene_spring *stacks;
    if (!stacks_of(of, k, &stacks, found))
        return 0;
    if (stacks && stacks->stroke == 0 && stacks->force != 0 &&
        !of->scene->actuator[k].is_temperature)
        found->value = plausible_si(of->scene, fabs(stacks->force), &force_unit);
    snprintf(found->what, WHAT, "force of the stacks '%s'", of->scene->actuator[k].name);
    return 1;
}

/* ---- stacks at one point ------------------------------------------------ */

/* Return whether two springs are elongated by the same displacements of the structure. */
static bool acts_alike(const mesh_springs *springs, int one, int other)
{
    const uint32_t entries = springs->start[one + 1] - springs->start[one];
    if (entries == 0 || springs->start[other + 1] - springs->start[other] != entries)
        return false;
    for (uint32_t i = 0; i < entries; i++) {
        const uint32_t at = springs->start[one] + i, other_at = springs->start[other] + i;
        if (springs->dof[at] != springs->dof[other_at] ||
            !(fabs(springs->value[at] - springs->value[other_at]) <= 1e-9))
            return false;
    }
    return true;
}

/*
 * Among the stacks from `first` to `row` - 1, find the first one that the same displacements
 * elongate as the stack `row`. Returns its number, or -1 if there is none.
 */
static int stack_like(const mesh_springs *springs, int first, int row)
{
    for (int other = first; other < row; other++)
        if (acts_alike(springs, other, row))
            return other;
    return -1;
}

/*
 * Measure how many stacks of actuator k act at the same point and in the same direction as an
 * earlier stack.
 */
int measure_repeated_stack(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    const mesh_springs *springs = &of->mesh->springs;
    if (springs->count == 0 || k >= scene->actuators)
        return 0;
    const int *first = springs->first + scene->springs;
    int example = 0;
    if (!scene->actuator[k].stacks)
        return 1;
    found->value = 0;
    for (int row = first[k]; row < first[k + 1]; row++) {
        if (stack_like(springs, first[0], row) < 0)
            continue;
        example = found->value > 0 ? example : row - first[k] + 1;
        found->value++;
    }
    found->at = scene->actuator[k].stacks->at;
    snprintf(found->what, WHAT,
             "stacks of '%s' at the point and in the direction of another (the first is number %d)",
             scene->actuator[k].name, example);
    return 1;
}
