/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Changes of a scene that make its unstable control loop stable (certify_trial.h). Each change is
 * made in a copy of the scene. For this copy everything is computed and tested anew, from the mesh
 * on, so that a change is only named if the changed scene file passes all tests, too.
 */
#include <string.h>
#include "../model/certificate_make.h"
#include "../system/progress.h"
#include "certify_trial.h"
#include "imperfections_scene.h"
#include "simulation.h"

/*
 * Relative regularisations of the voltages (factors of the mean diagonal entry of the Hessian) that
 * are tried for an unstable loop. They suppress combinations of voltages that hardly move the
 * target but excite vibration modes.
 */
static const double cures[] = {1e-4, 1e-2};

/*
 * Compute everything that the stability tests of a scene's control loop need, and run them. Returns
 * 0, or -1 with error filled.
 *   analysis in/out  prepared analysis of the scene
 */
static int certify_scene(analysis *analysis, char *error)
{
    if (analysis_influence(analysis, error) < 0)
        return -1;
    certificate_make(&analysis->certificate, analysis);
    if (analysis->design.simulate.given && certificate_refuses(&analysis->certificate) &&
        simulate_tables(analysis, error) < 0)
        return -1;
    return trial_certify(analysis, error);
}

/*
 * Whether the control loop of a scene passes all stability tests. A scene that cannot be computed
 * does not pass them.
 */
static bool is_certified(const scene *scene)
{
    analysis analysis;
    char error[SCENE_ERROR];
    memset(&analysis, 0, sizeof analysis);
    if (analysis_prepare(&analysis, scene, error) < 0)
        return false;
    const certificate *certificate = &analysis.certificate;
    const bool is_tested = certify_scene(&analysis, error) == 0 && certificate->is_assessed;
    const bool is_stable =
        certificate->loop.is_made ? certificate->loop.is_stable : !certificate_refuses(certificate);
    analysis_free(&analysis);
    return is_tested && is_stable;
}

/*
 * Whether the control loop passes all stability tests if the scene's target has no free functions.
 * Free functions are shapes, such as a tilt, that may be added to the target at no cost.
 */
static bool is_stable_without_free(const design *design)
{
    scene changed = *design->scene;
    if (changed.target.frees == 0)
        return false;
    changed.target.frees = 0;
    return is_certified(&changed);
}

/*
 * Make the section `hysteresis` of a scene file that describes the hysteresis of the simulated
 * plant. Returns false where no such section compensates it: there is no hysteresis, the amplifiers
 * differ in their limits, or the loop has limits between amplifiers.
 */
static bool make_section(const design *design, scene_hysteresis *section)
{
    const double share = imperfections_hysteresis(design) * 16 / 5;
    const double low = design->lower[0], high = design->upper[0];
    bool is_common = true;
    for (int k = 1; k < design->amplifiers; k++)
        is_common = is_common && !(design->lower[k] < low) && !(design->lower[k] > low) &&
                    !(design->upper[k] < high) && !(design->upper[k] > high);
    if (!(share > 0) || !(share < 1) || !is_common || design->problem.limit_rows != NULL)
        return false;
    *section = (scene_hysteresis){.given = true, .range = {low, high}};
    section->slope.count = PZS_HYSTERESIS_SEGMENTS;
    section->slack.count = section->above.count = section->below.count = PLAYS;
    for (uint32_t i = 0; i < PZS_HYSTERESIS_SEGMENTS; i++)
        section->slope.value[i] = 1 - share;
    for (int i = 0; i < PLAYS; i++) {
        section->slack.value[i] = (high - low) / 2 * (i + 1) / (2 * PLAYS);
        section->above.value[i] = section->below.value[i] = share / PLAYS;
    }
    return true;
}

/*
 * Whether the control loop passes all stability tests if it compensates the hysteresis of the
 * simulated plant.
 */
static bool is_stable_compensated(const design *design)
{
    scene changed = *design->scene;
    return make_section(design, &changed.hysteresis) && is_certified(&changed);
}

/* Find the smallest of the regularisations `cures` with which the control loop is stable. */
static void find_regularisation(const design *design, certificate_loop *loop)
{
    scene changed = *design->scene;
    changed.limits.regularisation_is_relative = true;
    for (size_t i = 0; i < sizeof cures / sizeof *cures && !(loop->cure > 0); i++) {
        if (!(cures[i] * design_mean_diagonal(design) > design->problem.regularisation))
            continue;
        changed.limits.regularisation = cures[i];
        loop->cures_tried = cures[i];
        if (is_certified(&changed))
            loop->cure = cures[i];
    }
}

void trial_find_cure(const analysis *analysis, certificate_loop *loop)
{
    progress_stage("changes that make the loop stable");
    loop->is_free_cause = is_stable_without_free(&analysis->design);
    if (!loop->is_free_cause)
        find_regularisation(&analysis->design, loop);
    if (!loop->is_free_cause && loop->worst_hysteresis > 0)
        loop->is_compensation_cure = is_stable_compensated(&analysis->design);
}
