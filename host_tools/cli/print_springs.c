/* SPDX-License-Identifier: BSD-2-Clause */
/* Forces of springs and stack actuators on standard output (print_springs.h). */
#include "print_springs.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "../model/spring_forces.h"
#include "../text/words.h"

/*
 * Return the number of spring entries and actuators of the scene; actuators may consist of stacks,
 * which are springs.
 */
static int items_of(const design *design)
{
    return design->springs + design->actuators;
}

static double force_of(const analysis *analysis, int row, const double *displacement)
{
    return spring_force(&analysis->design, row, displacement, analysis->input_value);
}

static void print_item(const analysis *analysis, int item, const double *displacement)
{
    const mesh_springs *springs = &analysis->design.mesh.springs;
    const int first = springs->first[item], end = springs->first[item + 1];
    double sum = 0, largest = 0;
    char name[SCENE_LABEL];
    for (int row = first; row < end; row++) {
        const double force = force_of(analysis, row, displacement);
        sum += force;
        largest = fabs(force) > fabs(largest) ? force : largest;
    }
    spring_item_name(&analysis->design, item, name);
    printf("  %-20s %8d %18.9e %18.9e\n", name, end - first, sum, largest);
}

void print_springs(const analysis *analysis, const double *displacement)
{
    const design *design = &analysis->design;
    const mesh_springs *springs = &analysis->design.mesh.springs;
    char unit[WORDS_UNIT];
    if (springs->count == 0)
        return;
    words_unit(&design->units, QUANTITY_FORCE, unit);
    printf("\n  %-20s %8s %18s %18s\n", "force on the shell", "springs", "sum", "largest");
    for (int item = 0; item < items_of(design); item++)
        if (springs->first[item + 1] > springs->first[item])
            print_item(analysis, item, displacement);
    if (*unit)
        printf("  forces in %s along the direction of each spring, moments of torsional springs\n",
               unit);
}

void print_springs_json(json *json, const analysis *analysis, const double *displacement)
{
    const design *design = &analysis->design;
    const mesh_springs *springs = &analysis->design.mesh.springs;
    double *force = calloc((size_t)springs->count + 1, sizeof *force);
    if (springs->count == 0 || !force) {
        free(force);
        return;
    }
    for (int row = 0; row < springs->count; row++)
        force[row] = force_of(analysis, row, displacement);
    json_open(json, "springs", '{');
    for (int item = 0; item < items_of(design); item++) {
        const int first = springs->first[item], count = springs->first[item + 1] - first;
        char name[SCENE_LABEL];
        spring_item_name(design, item, name);
        if (count > 0)
            json_numbers(json, name, force + first, count);
    }
    json_close(json, '}');
    free(force);
}
