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
    const design *design = &analysis->design;
    const size_t inputs = (size_t)design->amplifiers;
    for (size_t i = 0; i < (size_t)design->measured.outputs; i++) {
        displacement[i] = 0;
        for (size_t k = 0; k < inputs; k++)
            displacement[i] += design->measured.matrix[i * inputs + k] * value[k];
    }
    return PZS_OK;
}

static pzs_status influence(analysis *analysis)
{
    const design *design = &analysis->design;
    memcpy(analysis->influence, design->measured.matrix,
           (size_t)design->measured.outputs * (size_t)design->amplifiers * sizeof(double));
    return PZS_OK;
}

const analysis_source analysis_of_matrix = {false, open, displace, influence};
