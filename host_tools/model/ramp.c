/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Nonlinear equilibrium with an automatic choice of how slowly the loads of a load step rise
 * (ramp.h).
 */
#include "ramp.h"
#include <stdlib.h>
#include <string.h>
#include "../../lib/nonlinear/nonlinear.h"

/*
 * Settings for the second try to compute an equilibrium, with loads that rise more slowly.
 *   LONG_RAMP        number of linear solves at the start of a load step over which the loads rise.
 *       It suffices for a soft hyperboloid shell to converge in one load step on every mesh
 *   SOLVES_PER_STEP  largest number of linear solves for each load step that the scene asks for,
 *       three times as many as the hyperboloid needs
 */
enum { LONG_RAMP = 8, SOLVES_PER_STEP = 40 };

/* Relative distance up to which two displacements belong to the same equilibrium. */
static const double same_within = 1e-3;

/*
 * Return whether a second try with more slowly rising loads may find a better equilibrium: the
 * first one failed or shortened load steps. It does not help with contact, which limits the load
 * steps, nor at limit points, beyond which there may be no equilibrium.
 */
static bool may_help(const equilibrium *equilibrium, pzs_status status)
{
    const pzs_solver *solver = &equilibrium->solver;
    const scene_equilibrium *choice = &equilibrium->design->equilibrium;
    const bool has_failed = status == PZS_E_DIVERGED || status == PZS_E_SOLVES;
    return choice->ramp_solves == 0 && solver->settings.ramp_solves < LONG_RAMP &&
           solver->settings.extrapolated_iterations > 0 && !equilibrium->design->contact.given &&
           (has_failed ||
            (!PZS_IS_ERROR(status) && solver->info.load_steps > solver->settings.load_steps));
}

/*
 * Solve for the equilibrium from the reference state. In each load step, the loads rise in equal
 * parts over the first LONG_RAMP linear solves. Returns whether this has led to an equilibrium in
 * no more load steps than the scene asks for.
 */
static bool try_long_ramp(pzs_solver *solver, const double *value, pzs_status *status)
{
    const uint32_t solve_limit = solver->settings.solve_limit,
                   enough = (uint32_t)SOLVES_PER_STEP * solver->settings.load_steps;
    solver->settings.ramp_solves = LONG_RAMP;
    solver->settings.solve_limit = enough < solve_limit ? enough : solve_limit;
    pzs_solver_reset(solver);
    *status = pzs_equilibrium(solver, value);
    solver->settings.solve_limit = solve_limit;
    return !PZS_IS_ERROR(*status) && solver->info.load_steps == solver->settings.load_steps;
}

/*
 * Compute an equilibrium a second time with loads that rise more slowly. The second result is kept
 * if it converges and the first try failed, or if both have the same displacement; otherwise the
 * first is restored.
 *   status in             status of the first try
 *   first  [free_dof] in  displacement of the first try
 *   state  in             state of the equilibrium solver after the first try
 * Returns the status of the result that is kept.
 */
static pzs_status second_try(equilibrium *equilibrium, const double *value, pzs_status status,
                             const double *first, const void *state)
{
    pzs_solver *solver = &equilibrium->solver;
    pzs_status ramped;
    if (try_long_ramp(solver, value, &ramped)) {
        const double *displacement = solver->info.displacement;
        if ((PZS_IS_ERROR(status) && ramped == PZS_OK) ||
            pzs_nonlinear_norm2(solver, displacement, first) <=
                same_within * same_within * pzs_nonlinear_norm2(solver, first, NULL))
            return ramped;
    }
    equilibrium_restore(equilibrium, state);
    if (PZS_IS_ERROR(status))
        return status;
    /*
     * The saved state of the solver does not contain the factors of the tangent stiffness, which
     * are needed at an equilibrium. They are computed again by the same linear solves, which give
     * the same bits.
     */
    pzs_solver_reset(solver);
    return pzs_equilibrium(solver, value);
}

pzs_status ramp_equilibrium(equilibrium *equilibrium, const double *value)
{
    const size_t bytes =
        (size_t)equilibrium->design->mesh.free_dof * sizeof *equilibrium->solver.info.displacement;
    pzs_status status = pzs_equilibrium(&equilibrium->solver, value);
    if (!may_help(equilibrium, status))
        return status;
    double *first = malloc(bytes);
    void *state = malloc(equilibrium_state_bytes(equilibrium));
    if (first && state) {
        memcpy(first, equilibrium->solver.info.displacement, bytes);
        equilibrium_save(equilibrium, state);
        status = second_try(equilibrium, value, status, first, state);
    }
    free(first);
    free(state);
    return status;
}
