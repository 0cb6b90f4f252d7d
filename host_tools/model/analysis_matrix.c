/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Displacements of a scene with a measured influence matrix in place of a structure (analysis.h).
 * The dof are the outputs, so that the displacement is the matrix times the voltages.
 */
#include <string.h>
#include "analysis.h"

static int open(analysis *analysis, char *error)
{
    (void)analysis;
    (void)error;
    return 0;
}

static pzs_status displace(analysis *analysis, const double *value, double *displacement)
{
    const scene *scene = analysis->design.scene;
    const size_t inputs = (size_t)scene->amplifiers;
    for (size_t i = 0; i < (size_t)scene->influence.outputs; i++) {
        displacement[i] = 0;
        for (size_t k = 0; k < inputs; k++)
            displacement[i] += scene->influence.matrix[i * inputs + k] * value[k];
    }
    return PZS_OK;
}

static pzs_status influence(analysis *analysis)
{
    const scene *scene = analysis->design.scene;
    memcpy(analysis->influence, scene->influence.matrix,
           (size_t)scene->influence.outputs * (size_t)scene->amplifiers * sizeof(double));
    return PZS_OK;
}

const analysis_source analysis_of_matrix = {false, open, displace, influence};
