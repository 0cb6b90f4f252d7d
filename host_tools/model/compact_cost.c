/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computing times with full element types, and with compact ones, which contain only what a device
 * cannot compute from the nodes (compact_cost.h).
 */
#include "compact_cost.h"
#include <math.h>
#include "../../lib/model/compact.h"
#include "../../lib/model/shell.h"
#include "../mesh/compact_types.h"
#include "analysis.h"

/*
 * MEASUREMENTS: number of measurements of a computing time, of which the shortest counts.
 * ELEMENTS: number of elements that one measurement computes, so few that most measurements are not
 * interrupted by other programs.
 */
enum { MEASUREMENTS = 40, ELEMENTS = 100 };

/*
 * Computation for one element whose duration is measured: nodal forces with a full or a compact
 * element type, or the stiffness matrix.
 */
typedef enum element_work { FORCE_OF_FULL, FORCE_OF_COMPACT, STIFFNESS } element_work;

/*
 * Compute the nodal forces or the stiffness matrix of an element once, to measure how long that
 * takes. Returns a number that depends on the result, so that the compiler cannot leave the
 * computation out.
 */
static double work_on(const mesh *mesh, const compact_types *compact, int type, element_work work)
{
    double vector[SHELL_PACKED(SHELL_MAX)] = {0};
    pzs_element_type rebuilt;
    const pzs_element_type *full = &mesh->type[type];
    for (int i = 0; i < SHELL_MAX; i++)
        vector[i] = 1 + i;
    if (work == FORCE_OF_COMPACT) {
        pzs_rebuild_type(&compact->type[type], compact->node, &rebuilt);
        full = &rebuilt;
    }
    if (work == STIFFNESS)
        pzs_shell_stiffness(full, mesh->dof_per_node, vector);
    else
        pzs_shell_force(full, mesh->dof_per_node, vector, vector);
    return vector[0];
}

/* Measure the time to compute the nodal forces or the stiffness matrix of one element (s). */
static double seconds_of(const mesh *mesh, const compact_types *compact, element_work work)
{
    volatile double sum = 0; /* sum of the numbers that work_on returns; volatile, so that the
                                compiler does not leave out the computations whose time is measured
                              */
    double least = HUGE_VAL;
    for (int i = 0; i < MEASUREMENTS; i++) {
        const double begin = analysis_now();
        for (int element = 0; element < ELEMENTS; element++)
            sum = sum + work_on(mesh, compact, (i * ELEMENTS + element) % mesh->types, work);
        least = fmin(least, (analysis_now() - begin) / ELEMENTS);
    }
    return least;
}

bool compact_cost_measure(const mesh *mesh, compact_cost *cost)
{
    compact_types compact;
    compact_types_make(&compact, mesh);
    if (!compact.type)
        return false;
    cost->full = seconds_of(mesh, &compact, FORCE_OF_FULL);
    cost->compact = seconds_of(mesh, &compact, FORCE_OF_COMPACT);
    cost->matrix = seconds_of(mesh, &compact, STIFFNESS);
    compact_types_free(&compact);
    return true;
}
