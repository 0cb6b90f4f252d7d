/* SPDX-License-Identifier: BSD-2-Clause */
/* Margin of a scene's control loop against errors of its influence matrix (certify_matrix.h). */
#include "certify_matrix.h"
#include <math.h>
#include <string.h>
#include "../model/certificate_make.h"
#include "../model/voltages.h"
#include "../system/progress.h"
#include "certify_trial.h"
#include "matrix_errors.h"
#include "simulation.h"

enum { STATIC_TICKS = 400 }; /* length of a simulation on a structure without mass (ticks) */

/*
 * Regularisations of the voltages that are tried for a loop whose margin is too small, relative to
 * the mean diagonal entry of the Hessian.
 */
static const double cures[] = {1e-7, 3e-7, 1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2};

/* ---- loop of the scene --------------------------------------------------- */

/* Tables of the loop of a scene, and the structure on which it runs. */
typedef struct matrix_loop {
    estimator estimator;
    damper damper;
    loop_blocks blocks;
    storm_rig rig;
    int ticks; /* length of a simulation (ticks) */
} matrix_loop;

/*
 * Use the blocks of the tick up to the one that chooses the voltages, which all errors of the
 * matrix pass. Those of actuator curves and hysteresis are left out: the structure gets the effects
 * of the voltages, to which its displacements are proportional.
 */
static void use_blocks(matrix_loop *loop, int delay)
{
    pzs_block block[PZS_BLOCK_LIMIT];
    int count = 0;
    for (int k = 0; k < loop->blocks.count; k++) {
        const pzs_block_type *type = loop->blocks.block[k].type;
        const bool is_test = type->phase == PZS_PHASE_COMMISSION || type->phase > PZS_PHASE_STEP;
        if (!is_test && type != &pzs_curve_block && type != &pzs_effect_block)
            block[count++] = loop->blocks.block[k];
    }
    storm_use(&loop->rig, block, count, delay);
}

static int open_loop(matrix_loop *loop, const analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    memset(loop, 0, sizeof *loop);
    if ((loop_estimates(design) || loop_feeds(design)) &&
        estimator_open(&loop->estimator, analysis, error) < 0)
        return -1;
    const estimator *few = loop_estimates(design) ? &loop->estimator : NULL;
    if (damper_open(&loop->damper, analysis, few, error) < 0)
        return -1;
    const bool is_damped = loop->damper.is_used;
    if ((is_damped ? storm_open : storm_open_static)(&loop->rig, analysis, few, error) < 0)
        return -1;
    const damper_options options = damper_options_of(analysis);
    loop_blocks_fill(&loop->blocks, design, &loop->estimator, &loop->damper);
    use_blocks(loop, is_damped ? options.delay - options.settings.later : options.delay);
    loop->ticks = is_damped ? trial_growth_task(&loop->rig, 1, 1, 0).growth_ticks : STATIC_TICKS;
    return 0;
}

static void close_loop(matrix_loop *loop)
{
    storm_close(&loop->rig);
    damper_close(&loop->damper);
    estimator_close(&loop->estimator);
}

/*
 * Find the margin of the loop. Returns 0, or -1 with error filled.
 *   is_unstable out  whether the loop grows with the exact matrix, too
 */
static int find_margin(const analysis *analysis, double *margin, bool *is_unstable, char *error)
{
    matrix_loop loop;
    const int failed = open_loop(&loop, analysis, error) < 0 ||
                       matrix_errors_margin(&loop.rig, loop.ticks, margin, is_unstable, error) < 0;
    close_loop(&loop);
    return failed ? -1 : 0;
}

/* ---- cure ---------------------------------------------------------------- */

/*
 * Relative RMS error of the shape that the optimal voltages of the linear model within the limits
 * leave; NAN where the limits allow no voltages.
 */
static double shape_error(const design *design)
{
    const common_limits own = {.source = LIMITS_SCENE};
    char ignored[SCENE_ERROR];
    double found = (double)NAN;
    (void)voltages_linear_error(design, own, &found, ignored);
    return found;
}

/* What a regularisation of the voltages gives. */
typedef struct cured {
    double margin; /* margin against errors of the matrix */
    double error;  /* relative RMS error of the shape that the optimal voltages leave */
} cured;

/*
 * Compute everything anew for a scene with another regularisation: its tables, the stability tests
 * of its loop, and what it gives. Returns whether the loop passes its tests.
 */
static bool try_scene(const scene *scene, cured *result)
{
    analysis analysis;
    char error[SCENE_ERROR];
    memset(&analysis, 0, sizeof analysis);
    bool is_unstable;
    bool passes =
        analysis_prepare(&analysis, scene, error) == 0 && analysis_influence(&analysis, error) == 0;
    const certificate_loop *loop = &analysis.certificate.loop;
    if (passes) {
        result->error = shape_error(&analysis.design);
        certificate_make(&analysis.certificate, &analysis);
        passes = trial_certify(&analysis, error) == 0 && (!loop->is_made || loop->is_stable) &&
                 find_margin(&analysis, &result->margin, &is_unstable, error) == 0;
    }
    analysis_free(&analysis);
    return passes;
}

/* Change the regularisation of the tables of a loop. */
static void set_regularisation(pzs_problem *problem, double regularisation)
{
    problem->regularisation = regularisation;
    (void)pzs_problem_seal(problem);
}

/*
 * Determine what a regularisation, relative to the mean diagonal entry of the Hessian, gives.
 * Settings of a vibration damper and gains of modes depend on it and are made anew. Returns whether
 * the loop passes its tests.
 */
static bool try_cure(analysis *analysis, double relative, cured *result)
{
    design *design = &analysis->design;
    scene changed = *design->scene;
    char ignored[SCENE_ERROR];
    bool is_unstable;
    changed.limits.regularisation_is_relative = true;
    changed.limits.regularisation = relative;
    if (analysis->certificate.loop.is_made || design->gains.is_used)
        return try_scene(&changed, result);
    const double present = design->problem.regularisation;
    set_regularisation(&design->problem, relative * design_mean_diagonal(design));
    result->error = shape_error(design);
    const bool passes = find_margin(analysis, &result->margin, &is_unstable, ignored) == 0;
    set_regularisation(&design->problem, present);
    return passes;
}

/*
 * Find by bisection the smallest of the regularisations `cures` with which the margin reaches the
 * bar.
 */
static void find_cure(analysis *analysis, certificate_matrix *matrix)
{
    const int count = sizeof cures / sizeof *cures;
    const double present =
        analysis->design.problem.regularisation / design_mean_diagonal(&analysis->design);
    int first = 0, end = count;
    progress_stage("regularisation against errors of the matrix");
    matrix->error = shape_error(&analysis->design);
    while (first < count && !(cures[first] > present))
        first++;
    matrix->cures_tried = first < count ? cures[count - 1] : 0;
    while (first < end) {
        const int middle = (first + end) / 2;
        cured result = {.margin = 0};
        if (try_cure(analysis, cures[middle], &result) &&
            result.margin >= certificate_matrix_bar(matrix)) {
            matrix->cure = cures[middle];
            matrix->cure_margin = result.margin;
            matrix->cure_error = result.error;
            end = middle;
        } else {
            first = middle + 1;
        }
    }
}

int certify_matrix(analysis *analysis, char *error)
{
    certificate_matrix *matrix = &analysis->certificate.matrix;
    const certificate_loop *loop = &analysis->certificate.loop;
    const design *design = &analysis->design;
    if (matrix->is_made || design->problem.inputs == 0 || (loop->is_made && !loop->is_stable))
        return 0;
    progress_stage("errors of the influence matrix");
    matrix->is_measured = design->measured.given;
    matrix->stated = matrix->is_measured ? design->measured.scatter : 0;
    if (find_margin(analysis, &matrix->margin, &matrix->is_unstable, error) < 0)
        return -1;
    matrix->is_made = !matrix->is_unstable || design->measured.drop_below > 0;
    if (!matrix->is_unstable && matrix->margin < certificate_matrix_bar(matrix))
        find_cure(analysis, matrix);
    return 0;
}
