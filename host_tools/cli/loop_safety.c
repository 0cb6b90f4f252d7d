/* SPDX-License-Identifier: BSD-2-Clause */
/* Errors and warnings about the control loop of a scene (loop_safety.h). */
#include "loop_safety.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "../model/certificate_make.h"
#include "../model/damper.h"
#include "../model/estimator.h"
#include "../model/loaded.h"
#include "../model/voltages.h"
#include "../model/modal_gains.h"
#include "../simulate/certify.h"
#include "../tables/loop_blocks.h"

enum { ADVICE_PART = 190 }; /* characters of one part of the advice in an error message */

/*
 * Whether the control tick of a firmware with the constants that `pzs tables` writes would damp
 * vibration; if not, `reason` says why.
 */
static int is_damped(const analysis *analysis, char *reason)
{
    estimator estimator;
    damper damper;
    if (estimator_open(&estimator, analysis, reason) < 0)
        return 0;
    const int estimates = loop_estimates(&analysis->design);
    int is_used = 0;
    if (damper_open(&damper, analysis, estimates ? &estimator : NULL, reason) == 0) {
        is_used = damper.is_used;
        snprintf(reason, SCENE_ERROR, "%s", damper.reason);
        damper_close(&damper);
    }
    estimator_close(&estimator);
    return is_used;
}

/*
 * Write the end of the error message about an unstable control loop: if the scene file names no
 * sensors, the readings of the loop are the displacements of all target nodes.
 *   text [ADVICE_PART] out  end of the error message; empty where the scene names sensors or has a
 *       measured influence matrix, whose outputs are the sensors
 */
static void assumed_readings(const design *design, char text[ADVICE_PART])
{
    *text = '\0';
    if (!design->estimate.given && !design->measured.given)
        snprintf(text, ADVICE_PART,
                 "; the readings are the displacements of all %d target nodes, because the scene "
                 "names no sensors (section estimate)",
                 design->targets);
}

/*
 * Refuse a loop with gains of modes that is unstable with vibration. Returns -1 with error filled.
 */
static int refuse_gains(const certificate *certificate, const design *design, char *error)
{
    char growth[120] = "it grows on structures with 0.8 to 1.33 of the response or 0.9 to 1.1 of "
                       "the frequencies of the model";
    if (certificate->radius >= 1)
        snprintf(growth, sizeof growth, "it grows %.7g times a tick", certificate->radius);
    return scene_fault(design->control.modal_gains.at, error,
                       "unstable at %g ticks a second: with these gains of modes, which take the "
                       "place of the damping of vibration, %s; lower the gains, or remove "
                       "control.modal_gains so that the tick damps vibration; `pzs tables "
                       "--quasi-static` writes the tables all the same",
                       certificate->rate, growth);
}

int judge_loop(analysis *analysis, char *error)
{
    const certificate *certificate = &analysis->certificate;
    const design *design = &analysis->design;
    char reason[SCENE_ERROR], growth[120];
    if (analysis->design.problem.inputs == 0)
        return 0;
    if (modal_gains_check(design, error) < 0)
        return -1;
    certificate_make(&analysis->certificate, analysis);
    if (analysis->quasi_static || !certificate_refuses(certificate))
        return 0;
    if (certificate->has_gains)
        return refuse_gains(certificate, design, error);
    if (is_damped(analysis, reason))
        return 0;
    if (certificate->radius < 1)
        snprintf(growth, sizeof growth,
                 "vibration grows on structures with 0.8 to 1.33 of the response or 0.9 to 1.1 of "
                 "the frequencies of the model");
    else
        snprintf(growth, sizeof growth, "vibration grows %.4g times a tick", certificate->radius);
    return scene_fault(
        design->simulate.at, error,
        "unstable at %g ticks a second: the control step has no vibration model (%s), first "
        "mode %.4g Hz, %s; stable up to %.3g a second; `pzs tables --quasi-static` writes the "
        "tables all the same",
        certificate->rate, reason, certificate_first(certificate), growth,
        certificate->stable_rate);
}

int judge_rate(const analysis *analysis, char *error)
{
    const certificate *certificate = &analysis->certificate;
    const design *design = &analysis->design;
    char known[ADVICE_PART];
    if (analysis->quasi_static || !certificate_lacks_rate(certificate))
        return 0;
    snprintf(known, sizeof known, "the scene has %s (first mode %.4g Hz), but no tick rate",
             design->measured.given ? "measured modes" : "densities",
             certificate_first(certificate));
    if (certificate->has_gains)
        return scene_fault(design->control.modal_gains.at, error,
                           "%s: without it, nothing tells whether the loop with these gains of "
                           "modes is stable; write control: {rate: ...}, in ticks a "
                           "second, or say --quasi-static",
                           known);
    return scene_fault(design->at, error,
                       "%s: the tables would hold a tick that damps no vibration, stable up to "
                       "%.3g ticks a second; write control: {rate: ...}, in ticks a second, or say "
                       "--quasi-static",
                       known, certificate->stable_rate);
}

/*
 * Largest displacement of the target shape over the thickness of the structure; 0 for a measured
 * influence matrix, of whose structure no thickness is known.
 */
static double target_amplitude(const design *design)
{
    double most = 0;
    if (design->measured.given)
        return 0;
    for (int i = 0; i < design->targets; i++)
        most = fmax(most, fabs(design->target[i]));
    return most / design->mesh.laminate.thickness;
}

/*
 * Largest displacement of the target over the range of the sensors at its nodes; 0 where the scene
 * gives no range, or other sensors.
 */
static double target_over_range(const design *design)
{
    double most = 0;
    if (!(design->simulate.range > 0) || design->estimate.given)
        return 0;
    for (int i = 0; i < design->targets; i++)
        most = fmax(most, fabs(design->target[i]));
    return most / design->simulate.range;
}

int warn_of_target(analysis *analysis, char *error)
{
    const common_limits own = {.source = LIMITS_SCENE};
    voltages best;
    memset(&best, 0, sizeof best);
    if (analysis->design.problem.inputs == 0)
        return 0;
    const int failed = voltages_optimum(analysis, own, &best, error) < 0;
    const plausible_optimum optimum = {
        .target = design_target_rms(&analysis->design) > 0 ? 1 : (double)NAN,
        .error = best.error,
        .reading = target_over_range(&analysis->design),
        .share = (double)NAN};
    if (!failed)
        plausible_target(&analysis->warnings, analysis->design.scene, &optimum);
    voltages_free(&best);
    return failed ? -1 : 0;
}

void warn_of_loads(analysis *analysis)
{
    const design *design = &analysis->design;
    if (design->problem.inputs == 0 || !(design->control.rate > 0) ||
        !loop_supervises(design, analysis->certificate.loop.is_made))
        return;
    plausible_loads(&analysis->warnings, design->scene, loop_loaded_rms(design),
                    loop_reachable_rms(design));
}

void warn_of_loop(analysis *analysis)
{
    const certificate_loop *loop = &analysis->certificate.loop;
    const design *design = &analysis->design;
    const double wanted = design_target_rms(design);
    if (loop->is_made && loop->is_stable)
        plausible_loop(&analysis->warnings, design->scene, certificate_older(loop),
                       target_amplitude(design), wanted > 0 ? design->simulate.noise / wanted : 0);
}

/*
 * Write the advice of the error message about an unstable control loop that concerns its tick rate.
 *   text [ADVICE_PART] out  advice; empty where no other rate may be stable
 */
static void rate_advice(const certificate_loop *loop, char text[ADVICE_PART])
{
    *text = '\0';
    if (!loop->has_rates)
        snprintf(text, ADVICE_PART, "try another rate (`pzs check` searches some), or ");
    else if (loop->rate_to > 0)
        snprintf(text, ADVICE_PART,
                 "try %s ticks a second (growth and two of the storms pass there, so that the loop "
                 "may be stable), or ",
                 certificate_rates(loop).text);
}

/*
 * Write the advice of the error message about an unstable control loop: a change of the scene file
 * with which the loop passes all tests, or what may help where none is known.
 *   text [SCENE_ERROR] out  advice
 */
static void loop_advice(const analysis *analysis, char text[SCENE_ERROR])
{
    const certificate *certificate = &analysis->certificate;
    const certificate_loop *loop = &certificate->loop;
    char rates[ADVICE_PART], readings[ADVICE_PART], tried[ADVICE_PART] = "";
    rate_advice(loop, rates);
    assumed_readings(&analysis->design, readings);
    if (loop->cures_tried > 0)
        snprintf(tried, sizeof tried, "no limits.regularisation up to %g makes it safe; ",
                 loop->cures_tried);
    if (loop->is_free_cause && !certificate_is_prestressed(certificate))
        snprintf(text, SCENE_ERROR,
                 "the cause is target.free: remove it, and the loop is safe; with it, voltages "
                 "that move the free functions cost nothing and excite vibration");
    else if (loop->cure > 0 && !certificate_is_prestressed(certificate))
        snprintf(text, SCENE_ERROR,
                 "write limits: {regularisation: {relative: %g}}, which keeps voltages small that "
                 "hardly move the target%s",
                 loop->cure,
                 loop->is_compensation_cure ? ", or compensate hysteresis (section hysteresis, by "
                                              "`pzs calibrate --hysteresis`)"
                                            : "");
    else if (loop->is_compensation_cure && !certificate_is_prestressed(certificate))
        snprintf(
            text, SCENE_ERROR,
            "%scompensate hysteresis: with a section hysteresis (`pzs calibrate --hysteresis`) "
            "the loop is safe; or state the hysteresis of this ceramic in simulate",
            tried);
    else
        snprintf(text, SCENE_ERROR, "%s%sadd sensors or amplifiers%s", tried, rates, readings);
}

int judge_storms(const analysis *analysis, char *error)
{
    const certificate *certificate = &analysis->certificate;
    char text[SCENE_ERROR], advice[SCENE_ERROR];
    if (!certificate->loop.is_made || certificate->loop.is_stable)
        return 0;
    certify_failure(certificate, text);
    loop_advice(analysis, advice);
    return scene_fault(analysis->design.simulate.at, error,
                       "the damped tick is not safe at %g ticks a second: %s; %s",
                       certificate->rate, text, advice);
}

void warn_of_prestress(analysis *analysis)
{
    const scene *scene = analysis->design.scene;
    certificate *certificate = &analysis->certificate;
    if (!certificate->has_modes || certificate->is_loaded || analysis->design.problem.inputs == 0)
        return;
    const loaded_frequency first = loaded_first(scene);
    plausible_prestress(&analysis->warnings, scene, first.unloaded, first.loaded);
    certificate->load_ratio = first.loaded > 0 ? first.loaded / first.unloaded : 0;
}
