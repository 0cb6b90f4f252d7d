/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Optimal voltages for a target shape within the voltage limits, and voltages of other methods for
 * comparison (voltages.h).
 */
#include "voltages.h"
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../../lib/control/limit_rows.h"
#include "clipped.h"
#include "curves.h"
#include "design_rows.h"
#include "../../lib/core/guard.h"

enum { MOST_RELINEARISED = 40, MOST_REFUSED = 8 };

/* ---- the voltage optimisation problem with other limits ---------------------------- */

typedef struct trial {
    pzs_problem problem;
    pzs_control control;
    double *limits; /* [6][amplifiers] six arrays: lower and upper limits of the effects (values to
                       which the displacements of the actuators are proportional; V), step limits
                       (V, largest change in one tick), voltages inside all limits (V), lower and
                       upper voltage limits (V) */
    const double *lower, *upper; /* [amplifiers] voltage limits (V) */
    pzs_limit_rows rows;
    void *work;
} trial;

static void trial_free(trial *trial)
{
    free(trial->limits);
    free(trial->work);
}

/*
 * Set up a controller that minimises the shape error under voltage limits that the caller chooses.
 *   influence  [targets][amplifiers] in  influence matrix; NULL: that of the reference state
 *   common                           in  limits that all amplifiers share: those of the scene file,
 *                                        two given voltages, or none (limits_source)
 * Returns the status of the library; PZS_E_LIMITS with error filled if an amplifier has no
 * permitted voltage.
 */
static pzs_status trial_start(trial *trial, const design *design, common_limits common,
                              const double *influence, char *error)
{
    const size_t amplifiers = (size_t)design->amplifiers,
                 bytes = pzs_control_bytes(&design->problem);
    memset(trial, 0, sizeof *trial);
    trial->problem = design->problem;
    trial->limits = calloc(6 * amplifiers, sizeof *trial->limits);
    trial->work = malloc(bytes);
    if (!trial->limits || !trial->work)
        return PZS_E_WORKSPACE;
    double *lower = trial->limits + 4 * amplifiers, *upper = trial->limits + 5 * amplifiers;
    if (design_limits(design, common, lower, upper, error) < 0)
        return PZS_E_LIMITS;
    trial->lower = lower;
    trial->upper = upper;
    curves_limits(design, lower, trial->limits);
    curves_limits(design, upper, trial->limits + amplifiers);
    for (size_t k = 0; k < amplifiers; k++)
        trial->limits[2 * amplifiers + k] = HUGE_VAL;
    trial->problem.lower = trial->limits;
    trial->problem.upper = trial->limits + amplifiers;
    trial->problem.step_limit = trial->limits + 2 * amplifiers;
    if (common.source == LIMITS_NONE)
        trial->problem.limit_rows = NULL;
    if (trial->problem.limit_rows) {
        trial->rows = *trial->problem.limit_rows;
        trial->rows.safe = trial->limits + 3 * amplifiers;
        trial->problem.limit_rows = &trial->rows;
        if (design_rows_safe(design, trial->problem.lower, trial->problem.upper,
                             trial->limits + 3 * amplifiers, error) < 0)
            return PZS_E_LIMITS;
    }
    if (influence) {
        trial->problem.influence = influence;
        trial->problem.hessian = NULL;
    }
    trial->problem.crc = 0;
    trial->problem.crc = pzs_problem_crc(&trial->problem);
    return pzs_control_init(&trial->control, &trial->problem, NULL, trial->work, bytes);
}

/*
 * Store in a result how the voltage limits act: the widest voltage range of any amplifier, the
 * number of held amplifiers (limits that allow only one voltage), the number of amplifiers with a
 * narrower range, and the number of voltages at a limit.
 */
static void note_limits(const trial *trial, voltages *result)
{
    const int inputs = trial->problem.inputs;
    const double *lower = trial->lower, *upper = trial->upper, *voltage = result->voltage;
    double lowest = HUGE_VAL, highest = -HUGE_VAL;
    memcpy(result->bounds, lower, (size_t)inputs * sizeof *result->bounds);
    memcpy(result->bounds + inputs, upper, (size_t)inputs * sizeof *result->bounds);
    result->active_limits = result->held = result->narrowed = 0;
    for (int k = 0; k < inputs; k++) {
        if (lower[k] == upper[k]) {
            result->held++;
            continue;
        }
        lowest = fmin(lowest, lower[k]);
        highest = fmax(highest, upper[k]);
        result->at_limit[k] = voltage[k] == lower[k] || voltage[k] == upper[k];
        result->active_limits += result->at_limit[k];
    }
    for (int k = 0; k < inputs; k++)
        result->narrowed += lower[k] != upper[k] && (lower[k] > lowest || upper[k] < highest);
    result->limit[0] = fmin(lowest, highest); /* The stored pair is the lowest and the highest limit
                                                 of all amplifiers that are not held at one voltage.
                                                 If there is no such amplifier, `lowest` is still
                                                 +infinity and `highest` -infinity, and they are
                                                 stored in exchanged order: -infinity, +infinity. */
    result->limit[1] = fmax(lowest, highest);
}

/*
 * Fill `error` with the message for the status with which the optimisation of the voltages has
 * failed. Returns -1.
 */
static int explain(const analysis *analysis, pzs_status status, char *error)
{
    if (status == PZS_E_LIMITS)
        return -1; /* design_limits has already written the message into `error` */
    return scene_fault(analysis->design.limits.at, error, "%s", pzs_status_text(status));
}

/*
 * Compute the optimal voltages within the limits by a control step. Further steps follow if the
 * active-set solver uses up its iterations before it reaches the optimum.
 *   influence [targets][amplifiers] in      influence matrix; NULL: that of the reference state
 *   wanted    [targets]             in      displacements that the voltages are to cause
 *   reach                           in      largest change of any voltage (V), or INFINITY
 *   result                          in/out  voltages before and after (V), and how the limits act
 */
static pzs_status optimise_voltages(const design *design, common_limits common,
                                    const double *influence, const double *wanted, double reach,
                                    voltages *result, char *error)
{
    trial trial;
    const double *voltage = result->voltage;
    pzs_status status = trial_start(&trial, design, common, influence, error);
    for (int k = 0; status == PZS_OK && isfinite(reach) && k < design->amplifiers; k++) {
        trial.control.state.lower[k] = fmax(trial.problem.lower[k], voltage[k] - reach);
        trial.control.state.upper[k] = fmin(trial.problem.upper[k], voltage[k] + reach);
    }
    if (status == PZS_OK && isfinite(reach))
        status = pzs_control_start(&trial.control, voltage);
    for (int again = 0; status == PZS_OK && again < 10; again++) {
        status = pzs_step(&trial.control, wanted);
        result->iterations += trial.control.info.iterations;
        if (status != PZS_W_ITERATIONS)
            break;
        status = PZS_OK;
    }
    if (!PZS_IS_ERROR(status)) {
        curves_voltages(design, trial.control.info.voltage, trial.lower, trial.upper,
                        result->voltage);
        pzs_report report;
        (void)pzs_assess(&trial.control, wanted, &report);
        result->optimality = report.kkt_violation;
        note_limits(&trial, result);
        result->active_rows =
            trial.problem.limit_rows ? design_rows_active(design, result->voltage) : 0;
        status = PZS_OK;
    }
    trial_free(&trial);
    return status;
}

/* ---- voltages and their shape ----------------------------------------- */

static int open_result(const analysis *analysis, voltages *result, const char *name)
{
    const size_t amplifiers = (size_t)analysis->design.amplifiers;
    memset(result, 0, sizeof *result);
    snprintf(result->name, sizeof result->name, "%s", name);
    result->amplifiers = analysis->design.amplifiers;
    result->voltage = calloc(amplifiers, sizeof *result->voltage);
    result->at_limit = calloc(amplifiers, sizeof *result->at_limit);
    result->bounds = calloc(2 * amplifiers, sizeof *result->bounds);
    result->shape = calloc((size_t)analysis->design.targets, sizeof *result->shape);
    result->aligned_target =
        calloc((size_t)analysis->design.targets, sizeof *result->aligned_target);
    result->displacement =
        calloc((size_t)analysis->design.mesh.free_dof, sizeof *result->displacement);
    result->optimality = (double)NAN;
    result->limit[0] = -HUGE_VAL;
    result->limit[1] = HUGE_VAL;
    for (size_t k = 0; k < 2 * amplifiers && result->bounds; k++)
        result->bounds[k] = k < amplifiers ? -HUGE_VAL : HUGE_VAL;
    const bool has_memory = result->voltage && result->at_limit && result->bounds &&
                            result->shape && result->aligned_target && result->displacement;
    return has_memory ? 0 : -1;
}

static int out_of_memory(const analysis *analysis, char *error)
{
    return analysis_explain(analysis, PZS_E_WORKSPACE, error);
}

/*
 * Weighted sum of squares of the target displacements that no voltage can reach, because a support
 * prescribes the displacement.
 */
static double wanted_fixed(const design *design)
{
    double sum = 0;
    for (int i = 0; i < design->targets; i++)
        sum += pow(design->fixed_weight[i] * design->wanted[i], 2);
    return sum;
}

static double relative(double misfit, double wanted)
{
    return wanted > 0 ? sqrt(misfit / wanted) : sqrt(misfit);
}

/*
 * Compute the weighted root mean square and the peak-to-valley value of a shape error.
 *   misfit [targets] in  reached minus target value of each controlled displacement
 *   squares          in  weighted sum of the squares of the misfits
 */
static void measure_misfit(const design *design, const double *misfit, double squares,
                           voltages *result)
{
    double low = HUGE_VAL, high = -HUGE_VAL, weight = 0;
    for (int i = 0; i < design->targets; i++) {
        weight += design->weight[i] * design->weight[i];
        if (!(design->weight[i] > 0))
            continue;
        low = fmin(low, misfit[i]);
        high = fmax(high, misfit[i]);
    }
    result->rms = sqrt(squares / weight);
    result->valley = high - low;
}

/*
 * Compute three results from the displacement vector: the shape (controlled displacements), the
 * target with the best fit of its free functions (shapes that may be added at no cost), and the
 * shape errors.
 */
static void measure_errors(const analysis *analysis, voltages *result)
{
    const design *design = &analysis->design;
    double most = 0;
    design_shape(design, result->displacement, result->shape);
    const double misfit = design_squares(design, result->shape, design->target),
                 wanted = design_squares(design, design->wanted, NULL);
    const double missed_fixed =
        design_misfit(design, result->shape, design->target, result->aligned_target);
    measure_misfit(design, result->aligned_target, misfit, result);
    result->fixed_off = 0;
    for (int i = 0; i < design->targets; i++)
        most = fmax(most, fabs(design->target[i]));
    for (int i = 0; i < design->targets; i++)
        result->fixed_off +=
            design->fixed_weight[i] > 0 && fabs(result->aligned_target[i]) > 1e-9 * most;
    for (int i = 0; i < design->targets; i++)
        result->aligned_target[i] = result->shape[i] - result->aligned_target[i];
    result->error = relative(misfit, wanted);
    result->error_all = relative(misfit + missed_fixed, wanted + wanted_fixed(design));
}

/*
 * Compute the displacement under the voltages of a result, and its shape errors, on the structure
 * that analysis->is_nonlinear selects (1: nonlinear, 0: linear).
 *   warm in  1: the equilibrium solver starts from the last shape; 0: from the reference state
 * Returns 0, or -1 with error filled.
 */
static int evaluate(analysis *analysis, voltages *result, int warm, char *error)
{
    const design *design = &analysis->design;
    double *effect = calloc((size_t)design->amplifiers + 1, sizeof *effect);
    if (!effect)
        return out_of_memory(analysis, error);
    curves_effects(design, result->voltage, effect);
    const int failed = analysis_reach(analysis, effect, warm, result->displacement, error);
    free(effect);
    if (failed < 0)
        return -1;
    measure_errors(analysis, result);
    result->residual = analysis->is_nonlinear ? analysis->equilibrium.solver.info.residual
                                              : analysis->model.info.residual;
    result->linear_solves +=
        analysis->is_nonlinear ? (int)analysis->equilibrium.solver.info.linear_solves : 0;
    return 0;
}

/*
 * Compute the displacement under the voltages of a result and its shape errors; the load steps
 * start from the reference state. Where the load steps end early, the shape error is NAN and the
 * shape is that of the last equilibrium found.
 */
static int evaluate_or_none(analysis *analysis, voltages *result, char *error)
{
    if (evaluate(analysis, result, 0, error) == 0)
        return 0;
    measure_errors(analysis, result);
    result->error = result->error_all = (double)NAN;
    return analysis->is_nonlinear && analysis_ended_early(analysis) ? 0 : -1;
}

int voltages_linear(analysis *analysis, common_limits common, voltages *result, char *error)
{
    if (open_result(analysis, result,
                    common.source == LIMITS_NONE ? "linear optimum, no limits"
                                                 : "linear optimum in limits") < 0)
        return out_of_memory(analysis, error);
    const pzs_status status = optimise_voltages(&analysis->design, common, NULL,
                                                analysis->design.wanted, HUGE_VAL, result, error);
    if (status != PZS_OK)
        return explain(analysis, status, error);
    if (evaluate_or_none(analysis, result, error) < 0)
        return -1;
    if (analysis->is_nonlinear)
        result->optimality = (double)NAN; /* the violation of the optimality (KKT) conditions is not
                                             known, because voltages of the linear model need not be
                                             optimal on the nonlinear structure */
    return 0;
}

int voltages_linear_error(const design *design, common_limits common, double *shape_error,
                          char *error)
{
    const size_t amplifiers = (size_t)design->amplifiers, targets = (size_t)design->targets;
    voltages result = {.voltage = calloc(amplifiers + 1, sizeof *result.voltage),
                       .at_limit = calloc(amplifiers + 1, sizeof *result.at_limit),
                       .bounds = calloc(2 * amplifiers + 1, sizeof *result.bounds),
                       .shape = calloc(targets + 1, sizeof *result.shape)};
    double *effect = calloc(amplifiers + 1, sizeof *effect);
    pzs_status status = PZS_E_WORKSPACE;
    result.amplifiers = design->amplifiers;
    if (result.voltage && result.at_limit && result.bounds && result.shape && effect)
        status = optimise_voltages(design, common, NULL, design->wanted, HUGE_VAL, &result, error);
    if (status == PZS_OK) {
        curves_effects(design, result.voltage, effect);
        for (size_t i = 0; i < targets; i++)
            for (size_t k = 0; k < amplifiers; k++)
                result.shape[i] += design->problem.influence[i * amplifiers + k] * effect[k];
        *shape_error = relative(design_squares(design, result.shape, design->wanted),
                                design_squares(design, design->wanted, NULL));
    }
    free(effect);
    voltages_free(&result);
    return status == PZS_OK ? 0 : -1;
}

/*
 * Compute voltages by least squares without limits, then clip each to its limits.
 *   tuned in  true: the least squares are regularised, with the parameter for which the clipped
 *       voltages leave the smallest shape error of the linear model
 */
static pzs_status clip_voltages(const design *design, common_limits common, bool tuned,
                                voltages *result, char *error)
{
    trial trial;
    clipped clipped;
    memset(&clipped, 0, sizeof clipped);
    pzs_status status = trial_start(&trial, design, common, NULL, error);
    if (status == PZS_OK && clipped_open(&clipped, design, trial.problem.lower, trial.problem.upper,
                                         design->wanted) < 0)
        status = PZS_E_WORKSPACE;
    if (status == PZS_OK && tuned)
        status = clipped_tune(&clipped, result->voltage, &result->regularisation);
    else if (status == PZS_OK && !clipped_solve(&clipped, 0, result->voltage))
        status = PZS_E_NONFINITE;
    if (status == PZS_OK && trial.problem.limit_rows) {
        (void)pzs_scale_back_rows(&trial.problem, trial.rows.safe, result->voltage);
        result->active_rows = design_rows_active(design, result->voltage);
    }
    if (status == PZS_OK) {
        curves_voltages(design, result->voltage, trial.lower, trial.upper, result->voltage);
        note_limits(&trial, result);
    }
    if (status == PZS_OK && !tuned)
        result->dependent = (int)fmax(0, design->amplifiers - result->held - clipped.solver.rank);
    clipped_close(&clipped);
    trial_free(&trial);
    return status;
}

static int clipped_result(analysis *analysis, common_limits common, bool tuned, voltages *result,
                          char *error)
{
    if (open_result(analysis, result,
                    tuned ? "regularised, then clipped" : "clipped least squares") < 0)
        return out_of_memory(analysis, error);
    const pzs_status status = clip_voltages(&analysis->design, common, tuned, result, error);
    if (status != PZS_OK)
        return explain(analysis, status, error);
    return evaluate_or_none(analysis, result, error);
}

int voltages_clipped(analysis *analysis, common_limits common, voltages *result, char *error)
{
    return clipped_result(analysis, common, false, result, error);
}

int voltages_regularised(analysis *analysis, common_limits common, voltages *result, char *error)
{
    return clipped_result(analysis, common, true, result, error);
}

int voltages_given(analysis *analysis, const char *name, const double *voltage, voltages *result,
                   char *error)
{
    if (open_result(analysis, result, name) < 0)
        return out_of_memory(analysis, error);
    memcpy(result->voltage, voltage, (size_t)analysis->design.amplifiers * sizeof *result->voltage);
    return evaluate_or_none(analysis, result, error);
}

void voltages_free(voltages *result)
{
    free(result->voltage);
    free(result->at_limit);
    free(result->bounds);
    free(result->shape);
    free(result->aligned_target);
    free(result->displacement);
    memset(result, 0, sizeof *result);
}

/* ---- Gauss-Newton on the nonlinear structure -------------------------- */

/*
 * Objective of the optimisation of the voltages: the given weighted sum of squared shape errors
 * plus the regularisation term, a multiple of the squared distance of the voltages from their
 * reference voltages.
 */
static double with_regularisation(const analysis *analysis, const voltages *result, double sum)
{
    const design *design = &analysis->design;
    for (int k = 0; k < design->amplifiers; k++)
        sum += design->problem.regularisation *
               pow(result->voltage[k] - design->reference_voltage[k], 2);
    return sum;
}

/*
 * Objective of the optimisation of the voltages for a result: weighted sum of its squared shape
 * errors plus the regularisation term of its voltages.
 */
static double objective(const analysis *analysis, const voltages *result)
{
    return with_regularisation(
        analysis, result,
        design_squares(&analysis->design, result->shape, analysis->design.target));
}

/*
 * Arrays of the Gauss-Newton method that finds the optimal voltages on a nonlinear structure, in
 * one allocation that begins at `full_influence`.
 */
typedef struct newton {
    double *full_influence; /* [outputs][inputs] influence matrix of the nonlinear structure at the
                               last computed shape */
    double *influence; /* [targets][amplifiers] influence matrix from the voltages to the controlled
                          displacements in the linearised problem */
    double *wanted;    /* [targets] displacements that the voltages are to cause in the linearised
                          problem */
    double *work;      /* [targets] work array for displacements of the target nodes */
    double trust_radius; /* largest change of any voltage in one iteration of the nonlinear
                            optimisation (V) */
    void *state; /* saved state of the equilibrium solver for the result with the smallest objective
                    so far */
    voltages best; /* voltages and shape with the smallest objective of all iterations so far */
} newton;

/*
 * Copy a result (voltages, and the shape that they cause) with the values of its arrays into the
 * memory of another result.
 */
static void copy_result(const analysis *analysis, const voltages *from, voltages *to)
{
    const size_t amplifiers = (size_t)analysis->design.amplifiers;
    const size_t targets = (size_t)analysis->design.targets;
    const size_t dof = (size_t)analysis->design.mesh.free_dof;
    const voltages own = *to;
    *to = *from;
    to->voltage = memcpy(own.voltage, from->voltage, amplifiers * sizeof *own.voltage);
    to->at_limit = memcpy(own.at_limit, from->at_limit, amplifiers * sizeof *own.at_limit);
    to->bounds = memcpy(own.bounds, from->bounds, 2 * amplifiers * sizeof *own.bounds);
    to->shape = memcpy(own.shape, from->shape, targets * sizeof *own.shape);
    to->aligned_target =
        memcpy(own.aligned_target, from->aligned_target, targets * sizeof *own.aligned_target);
    to->displacement = memcpy(own.displacement, from->displacement, dof * sizeof *own.displacement);
}

/*
 * Return to the saved result with the smallest objective, and to the state of the equilibrium
 * solver that belongs to it. The counts of iterations and linear solves go on.
 */
static void restore_best(analysis *analysis, const newton *newton, voltages *result)
{
    const int iterations = result->iterations, linear_solves = result->linear_solves;
    equilibrium_restore(&analysis->equilibrium, newton->state);
    copy_result(analysis, &newton->best, result);
    result->iterations = iterations;
    result->linear_solves = linear_solves;
}

/*
 * Linearise the nonlinear structure at the last shape: compute its influence matrix there, and the
 * displacements that the voltages are to cause in the linearised problem.
 */
static pzs_status relinearise(analysis *analysis, newton *newton, voltages *result)
{
    const design *design = &analysis->design;
    const size_t amplifiers = (size_t)design->amplifiers;
    const pzs_status status =
        pzs_influence_at(&analysis->equilibrium.solver, newton->full_influence);
    if (status == PZS_OK)
        design_influence_free(design, newton->full_influence, design->structure.input.count,
                              newton->work, newton->influence);
    for (size_t i = 0; status == PZS_OK && i < (size_t)design->targets; i++) {
        newton->wanted[i] = result->aligned_target[i] - result->shape[i];
        for (size_t k = 0; k < amplifiers; k++)
            newton->wanted[i] += newton->influence[i * amplifiers + k] * result->voltage[k];
    }
    result->relinearised++;
    equilibrium_save(&analysis->equilibrium, newton->state);
    copy_result(analysis, result, &newton->best);
    return status;
}

/*
 * Objective (weighted squared shape error plus regularisation term) that the linearisation at the
 * present shape predicts for the voltages of a result.
 */
static double predicted_objective(const analysis *analysis, const newton *newton,
                                  const voltages *result)
{
    const design *design = &analysis->design;
    double sum = 0;
    for (int i = 0; i < design->targets; i++) {
        double miss = -newton->wanted[i];
        for (int k = 0; k < design->amplifiers; k++)
            miss += newton->influence[(size_t)i * (size_t)design->amplifiers + (size_t)k] *
                    result->voltage[k];
        sum += pow(design->weight[i] * miss, 2);
    }
    return with_regularisation(analysis, result, sum);
}

static double largest_change(const analysis *analysis, const newton *newton, const voltages *result)
{
    double most = 0;
    for (int k = 0; k < analysis->design.amplifiers; k++)
        most = fmax(most, fabs(result->voltage[k] - newton->best.voltage[k]));
    return most;
}

/*
 * Move the voltages to the optimum of the linearised structure within the trust radius, the largest
 * change of any voltage. Returns the relative decrease of the objective; 0 if no step decreases it.
 */
static double make_trust_region_step(analysis *analysis, common_limits common, newton *newton,
                                     voltages *result, pzs_status *status, char *error)
{
    const double before = objective(analysis, result);
    for (int refused = 0; refused < MOST_REFUSED; refused++) {
        *status = optimise_voltages(&analysis->design, common, newton->influence, newton->wanted,
                                    newton->trust_radius, result, error);
        if (*status != PZS_OK)
            return 0;
        const double change = largest_change(analysis, newton, result),
                     promise = predicted_objective(analysis, newton, result);
        const int reached = evaluate(analysis, result, 1, error) == 0;
        const double kept = (before - objective(analysis, result)) / (before - promise);
        /*
         * The trust radius (largest change of a voltage in a step) grows where the objective has
         * decreased as predicted, and shrinks where it has not.
         */
        if (!reached || !(kept > 0.75))
            newton->trust_radius = change / (kept > 0.25 && reached ? 1 : 4);
        else if (change >= 0.99 * newton->trust_radius)
            newton->trust_radius = 2 * change;
        if (reached && objective(analysis, result) < before)
            return 1 - objective(analysis, result) / before;
        /*
         * A step that does not decrease the objective is undone, and repeated with a smaller trust
         * radius.
         */
        restore_best(analysis, newton, result);
    }
    return 0;
}

static int gauss_newton(analysis *analysis, common_limits common, voltages *result, char *error)
{
    const design *design = &analysis->design;
    const size_t amplifiers = (size_t)design->amplifiers, targets = (size_t)design->targets,
                 inputs = design->structure.input.count;
    const size_t all = (size_t)design->structure.output.count * inputs;
    double fell = 1;
    newton newton = {.trust_radius = HUGE_VAL,
                     .full_influence = calloc(all + targets * amplifiers + 2 * targets,
                                              sizeof *newton.full_influence),
                     .state = malloc(equilibrium_state_bytes(&analysis->equilibrium))};
    newton.influence = newton.full_influence + all;
    newton.wanted = newton.influence + targets * amplifiers;
    newton.work = newton.wanted + targets;
    pzs_status status =
        open_result(analysis, &newton.best, "") == 0 && newton.full_influence && newton.state
            ? PZS_OK
            : PZS_E_WORKSPACE;
    while (status == PZS_OK && fell > 1e-3 && result->relinearised < MOST_RELINEARISED) {
        status = relinearise(analysis, &newton, result);
        if (status == PZS_OK)
            fell = make_trust_region_step(analysis, common, &newton, result, &status, error);
    }
    voltages_free(&newton.best);
    free(newton.state);
    free(newton.full_influence);
    return status == PZS_OK ? 0 : analysis_explain(analysis, status, error);
}

/*
 * Halve the voltages, within their limits, until the nonlinear structure has an equilibrium under
 * them.
 */
static int halve_voltages(analysis *analysis, common_limits common, voltages *result, char *error)
{
    trial trial;
    const pzs_status status = trial_start(&trial, &analysis->design, common, NULL, error);
    int failed = -1;
    for (int tries = 0; status == PZS_OK && failed && tries < MOST_REFUSED; tries++) {
        for (int k = 0; k < result->amplifiers; k++)
            result->voltage[k] =
                fmin(fmax(result->voltage[k] / 2, trial.problem.lower[k]), trial.problem.upper[k]);
        failed = evaluate(analysis, result, 0, error);
    }
    trial_free(&trial);
    return failed;
}

int voltages_influence_at(analysis *analysis, voltages *optimum, double *influence, char *error)
{
    if (!equilibrium_is_factored(&analysis->equilibrium) &&
        evaluate(analysis, optimum, 1, error) < 0)
        return -1;
    const pzs_status status = pzs_influence_at(&analysis->equilibrium.solver, influence);
    return status == PZS_OK ? 0 : analysis_explain(analysis, status, error);
}

int voltages_optimum(analysis *analysis, common_limits common, voltages *result, char *error)
{
    if (voltages_linear(analysis, common, result, error) < 0 ||
        (isnan(result->error) && halve_voltages(analysis, common, result, error) < 0))
        return -1;
    const char *none =
        curves_are_used(&analysis->design) ? "optimum, ends of curves" : "optimum, no limits";
    snprintf(result->name, sizeof result->name, "%s",
             common.source == LIMITS_NONE ? none : "optimum within limits");
    return analysis->is_nonlinear ? gauss_newton(analysis, common, result, error) : 0;
}
