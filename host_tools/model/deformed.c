/* SPDX-License-Identifier: BSD-2-Clause */
/* A structure linearised about the equilibrium at its target (deformed.h). */
#include "deformed.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "mass.h"
#include "modal.h"
#include "voltages.h"

/*
 * Fill deformed->offset, the outputs extrapolated linearly to 0 V: outputs at the best voltages,
 * minus influence matrix times these voltages. Also store in deformed->amplitude the largest
 * displacement of the target nodes at the best voltages, divided by the thickness of the shell.
 */
static void fill_offset(deformed *deformed, const voltages *best)
{
    const design *design = &deformed->analysis.design;
    const size_t inputs = design->structure.input.count;
    pzs_observe(&design->structure, best->displacement, deformed->offset);
    for (int i = 0; i < design->targets; i++)
        deformed->amplitude = fmax(deformed->amplitude, fabs(deformed->offset[i]));
    deformed->amplitude /= design->mesh.laminate.thickness;
    for (size_t i = 0; i < design->structure.output.count; i++)
        for (size_t k = 0; k < (size_t)design->amplifiers; k++)
            deformed->offset[i] -= deformed->analysis.influence[i * inputs + k] * best->voltage[k];
}

/*
 * Compute the influence matrix, the vibration modes and the displacements of the outputs at 0 V for
 * the structure linearised about the deformed equilibrium that its nonlinear solver has reached.
 */
static int linearise(deformed *deformed, voltages *best, int modes, char *error)
{
    analysis *analysis = &deformed->analysis;
    const design *design = &analysis->design;
    pzs_solver *solver = &analysis->equilibrium.solver;
    if (voltages_influence_at(analysis, best, analysis->influence, error) < 0)
        return -1;
    if (solver->info.negative_pivots > 0)
        return scene_fault(design->goal.what.at, error,
                           "the equilibrium at the target is unstable");
    deformed->offset = calloc(design->structure.output.count + 1, sizeof *deformed->offset);
    if (!deformed->offset)
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    fill_offset(deformed, best);
    if (!linearised_take(&deformed->about, design, solver))
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    if (vibration_solve_at(&deformed->vibration, design, &deformed->about, CIRCUIT_SCENE, modes,
                           MASS_LUMPED, error) < 0)
        return -1;
    const size_t amplifiers = (size_t)design->amplifiers;
    if (!modal_open(&deformed->modal, design, &deformed->vibration, amplifiers))
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    return 0;
}

int deformed_open(deformed *deformed, const analysis *nominal, int modes, char *error)
{
    voltages best;
    memset(deformed, 0, sizeof *deformed);
    memset(&best, 0, sizeof best);
    if (analysis_prepare(&deformed->analysis, nominal->design.scene, error) < 0 ||
        analysis_influence(&deformed->analysis, error) < 0)
        return -1;
    deformed->analysis.is_nonlinear = true;
    const common_limits limits = {.source = LIMITS_SCENE};
    const int failed = voltages_optimum(&deformed->analysis, limits, &best, error) < 0 ||
                       linearise(deformed, &best, modes, error) < 0;
    voltages_free(&best);
    return failed ? -1 : 0;
}

void deformed_close(deformed *deformed)
{
    modal_close(&deformed->modal);
    vibration_free(&deformed->vibration);
    linearised_free(&deformed->about);
    free(deformed->offset);
    if (deformed->analysis.source)
        analysis_free(&deformed->analysis);
    memset(deformed, 0, sizeof *deformed);
}
