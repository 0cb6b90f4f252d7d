/* SPDX-License-Identifier: BSD-2-Clause */
/* Variables of an FMU (fmu_parts.h). */
#include "fmu_parts.h"
#include <stdlib.h>
#include <string.h>
#include "../tables/loop_blocks.h"

/* ---- list ------------------------------------------------------------- */

void fmu_add(fmu *fmu, fmu_variable kind, const char *group, const char *name)
{
    fmu_variable *more =
        realloc(fmu->variable, ((size_t)fmu->variables + 1) * sizeof *fmu->variable);
    if (!more) {
        fmu->is_full = true;
        return;
    }
    fmu->variable = more;
    snprintf(kind.name, sizeof kind.name, "%s%s%s", group, *name ? "." : "", name);
    more[fmu->variables++] = kind;
}

void fmu_add_indexed(fmu *fmu, fmu_variable kind, const char *group, int index)
{
    char name[16];
    snprintf(name, sizeof name, "%d", index);
    fmu_add(fmu, kind, group, name);
}

int fmu_count(const fmu *fmu, fmu_type type)
{
    int count = 0;
    for (int i = 0; i < fmu->variables; i++)
        count += fmu->variable[i].type == type;
    return count;
}

int fmu_count_settable(const fmu *fmu, fmu_type type)
{
    int count = 0;
    for (int i = 0; i < fmu->variables; i++)
        count += fmu->variable[i].type == type && fmu->variable[i].role != FMU_OUTPUT;
    return count;
}

/* ---- groups ----------------------------------------------------------- */

void fmu_add_amplifiers(fmu *fmu, fmu_variable kind, const char *group, const double *start)
{
    words_unit(&fmu->design->units, QUANTITY_VOLTAGE, kind.unit);
    for (int k = 0; k < fmu->design->amplifiers; k++) {
        kind.start = start ? start[k] : 0;
        fmu_add(fmu, kind, group, fmu->design->amplifier_name[k]);
    }
}

/*
 * Append the coordinates of a target node to the description of a variable. For a measured
 * influence matrix they are the coordinates that the scene file gives for the output, if any.
 */
static void add_place(const design *design, int target, char about[FMU_NAME])
{
    const scene_influence *influence = &design->measured;
    const double *place = NULL;
    const size_t used = strlen(about);
    if (!influence->given)
        place = design->mesh.point[design->target_node[target]].position;
    else if (influence->place)
        place = influence->place[target];
    if (place)
        snprintf(about + used, FMU_NAME - used, " at (%.6g, %.6g, %.6g)", place[0], place[1],
                 place[2]);
}

void fmu_add_nodes(fmu *fmu, fmu_variable kind, const char *group, const double *start)
{
    const design *design = fmu->design;
    char about[FMU_NAME];
    snprintf(about, sizeof about, "%s", kind.about);
    words_unit(&fmu->design->units, QUANTITY_LENGTH, kind.unit);
    for (int i = 0; i < design->targets; i++) {
        snprintf(kind.about, sizeof kind.about, "%s", about);
        add_place(design, i, kind.about);
        kind.start = start ? start[i] : 0;
        fmu_add_indexed(fmu, kind, group, i);
    }
}

void fmu_add_readings(fmu *fmu, fmu_role role)
{
    const scene_estimate *estimate = &fmu->design->estimate;
    fmu_variable kind = {.role = role, .about = "reading of a sensor"};
    if (!loop_estimates(fmu->design)) {
        fmu_add_nodes(fmu, kind, "reading", NULL);
        return;
    }
    for (int k = 0; k < estimate->readings; k++) {
        const scene_output *output = &fmu->design->output[estimate->reading[k].output];
        const int count = analysis_outputs(fmu->nominal, estimate->reading[k].output);
        char group[FMU_NAME];
        words_unit(&fmu->design->units, words_of_output(output), kind.unit);
        snprintf(group, sizeof group, "reading.%s", output->name);
        for (int i = 0; i < count && count > 1; i++)
            fmu_add_indexed(fmu, kind, group, i);
        if (count == 1)
            fmu_add(fmu, kind, group, "");
    }
}
