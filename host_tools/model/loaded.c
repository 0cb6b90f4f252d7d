/* SPDX-License-Identifier: BSD-2-Clause */
/* Vibration modes of a structure under its static loads (loaded.h). */
#include "loaded.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "design_build.h"
#include "mass.h"

/* ---- first natural frequency under load -------------------------------- */

/* Whether a scene has loads or prescribed displacements, which may cause prestress. */
static bool has_loads(const scene *scene)
{
    bool has = scene->loads > 0;
    for (int k = 0; k < scene->supports; k++)
        has |= scene->support[k].value != NULL;
    return has;
}

/*
 * Compute the first natural frequency of an analysed structure: about the equilibrium under its
 * loads where the analysis has computed one, otherwise in the reference state.
 *   first out  frequency (Hz), 0 for a rigid motion
 * Returns 0, or -1 with error filled.
 */
static int find_first(const analysis *analysis, electrode_circuit circuit, double *first,
                      char *error)
{
    vibration vibration;
    if (analysis_vibration_of(analysis, circuit, &vibration, 1, error) < 0)
        return -1;
    *first = vibration.frequency[0];
    vibration_free(&vibration);
    return 0;
}

/* Compute the first natural frequencies of an analysis with nonlinear kinematics. */
static loaded_frequency compare_first(analysis *analysis)
{
    char ignored[SCENE_ERROR];
    loaded_frequency first = {(double)NAN, (double)NAN};
    double *voltage = calloc((size_t)analysis->design.amplifiers + 1, sizeof *voltage),
           *displacement = calloc((size_t)analysis->design.mesh.free_dof + 1, sizeof *displacement);
    if (voltage && displacement &&
        find_first(analysis, CIRCUIT_SCENE, &first.unloaded, ignored) == 0 &&
        analysis_reach(analysis, voltage, 0, displacement, ignored) == 0) {
        const bool is_stable = analysis->equilibrium.solver.info.negative_pivots == 0;
        if (!is_stable)
            first.loaded = 0;
        else if (analysis_linearise(analysis, ignored) == 0)
            (void)find_first(analysis, CIRCUIT_SCENE, &first.loaded, ignored);
    }
    free(voltage);
    free(displacement);
    return first;
}

loaded_frequency loaded_first(const scene *given)
{
    loaded_frequency first = {(double)NAN, (double)NAN};
    char ignored[SCENE_ERROR];
    analysis analysis;
    scene nonlinear = *given;
    nonlinear.kinematics = KINEMATICS_NONLINEAR;
    if (given->influence.given || !has_loads(given) ||
        analysis_prepare(&analysis, &nonlinear, ignored) < 0)
        return first;
    first = compare_first(&analysis);
    analysis_free(&analysis);
    return first;
}

/* ---- modes of a scene --------------------------------------------------- */

/* Whether a scene applies voltages, which may cause prestress. */
static bool has_voltages(const scene *scene)
{
    bool has = false;
    for (int k = 0; k < scene->actuators; k++)
        has |= scene->actuator[k].applied != 0;
    return has;
}

/*
 * Compute the vibration modes about the equilibrium under the scene's loads and applied voltages.
 * Returns 0, or -1 with error filled.
 */
static int solve_loaded(loaded_modes *modes, const scene *scene, const modes_request *request,
                        char *error)
{
    analysis *analysis = &modes->analysis;
    if (analysis_prepare(analysis, scene, error) < 0 ||
        find_first(analysis, request->circuit, &modes->first.unloaded, error) < 0)
        return -1;
    modes->is_loaded = true;
    double *displacement = calloc((size_t)analysis->design.mesh.free_dof + 1, sizeof *displacement);
    if (!displacement)
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    const int failed = analysis_continue(analysis, displacement, error) < 0 ||
                       analysis_linearise(analysis, error) < 0;
    free(displacement);
    if (failed || analysis_vibration_of(analysis, request->circuit, &modes->vibration,
                                        request->number, error) < 0)
        return -1;
    modes->first.loaded = modes->vibration.frequency[0];
    return 0;
}

/*
 * Compute the vibration modes about the reference state. The stiffness matrix alone is not
 * factored: its condition number and the residual of its solves are unknown, -1. Returns 0, or -1
 * with error filled.
 */
static int solve_unloaded(loaded_modes *modes, const scene *scene, const modes_request *request,
                          char *error)
{
    modes->analysis.source = scene->influence.given ? &analysis_of_matrix : &analysis_of_structure;
    modes->analysis.model.info.condition = -1;
    modes->analysis.model.info.error_estimate = -1;
    if (design_build(&modes->analysis.design, scene, error) < 0)
        return -1;
    return analysis_vibration_of(&modes->analysis, request->circuit, &modes->vibration,
                                 request->number, error);
}

int loaded_modes_open(loaded_modes *modes, const scene *scene, const modes_request *request,
                      char *error)
{
    const bool is_linear = scene->kinematics == KINEMATICS_LINEAR || scene->influence.given;
    const bool is_loaded = !is_linear && (has_loads(scene) || has_voltages(scene));
    memset(modes, 0, sizeof *modes);
    modes->circuit = request->circuit;
    modes->first = (loaded_frequency){(double)NAN, (double)NAN};
    if ((is_loaded ? solve_loaded : solve_unloaded)(modes, scene, request, error) < 0)
        return -1;
    if (modes->vibration.open == modes->vibration.bare)
        return 0;
    return coupling_find(&modes->coupling, &modes->analysis, &modes->vibration, error);
}

void loaded_modes_close(loaded_modes *modes)
{
    vibration_free(&modes->vibration);
    coupling_free(&modes->coupling);
    analysis_free(&modes->analysis);
}
