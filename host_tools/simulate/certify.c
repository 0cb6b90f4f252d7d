/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stability tests of a control loop with a vibration model: whether they are needed, their order,
 * and their result as text (certify.h).
 */
#include "certify.h"
#include <stdio.h>
#include <string.h>
#include "../system/progress.h"
#include "../text/append.h"
#include "certify_trial.h"

enum { HYSTERESIS_TEXT = 40 }; /* length of the text that names hysteresis (characters) */

/*
 * Determine whether a tick of the scene's control loop has a block (stage) that damps vibration.
 * Returns 0, or -1 with error filled.
 */
static int has_damper(const analysis *analysis, bool *has, char *error)
{
    estimator estimator;
    damper damper;
    const bool estimates = loop_estimates(&analysis->design);
    *has = false;
    if (analysis->quasi_static || !certificate_refuses(&analysis->certificate))
        return 0;
    memset(&estimator, 0, sizeof estimator);
    if (estimates && estimator_open(&estimator, analysis, error) < 0)
        return -1;
    const int failed = damper_open(&damper, analysis, estimates ? &estimator : NULL, error);
    *has = !failed && damper.is_used;
    damper_close(&damper);
    estimator_close(&estimator);
    return failed;
}

/*
 * Simulate the certified loop with one sensor after the other at the end of its range, where it has
 * a sensor gate (block that takes wrong readings away). Returns 0, or -1 with error filled.
 */
static int try_wrong_sensors(trial *trial, char *error)
{
    certificate_gate *gate = &trial->analysis->certificate.loop.gate;
    const double first = trial->damper.modes > 0 ? trial->damper.frequency[0] : 0;
    wrong_sensor wrong;
    if (!trial->gate.is_used)
        return 0;
    trial->rig.is_supervised = true;
    const int failed = wrong_sensor_run(&trial->rig, &trial->gate.tables, first, &wrong, error);
    trial->rig.is_supervised = false;
    gate->is_made = !failed;
    gate->tried = wrong.tried;
    gate->sensor = wrong.sensor;
    gate->reading = wrong.error;
    gate->moved = wrong.moved;
    gate->is_stopped = wrong.is_stopped;
    return failed;
}

int trial_certify(analysis *analysis, char *error)
{
    trial trial;
    bool has;
    if (has_damper(analysis, &has, error) < 0)
        return -1;
    if (!has)
        return 0;
    progress_stage("storms against the loop");
    int failed = trial_open(&trial, analysis, error);
    failed = failed || trial_open_target(&trial, error) < 0 || trial_choose(&trial, error) < 0;
    if (!failed && analysis->certificate.loop.is_stable)
        failed = trial_choose_fading(&trial, error) || try_wrong_sensors(&trial, error);
    trial_close(&trial);
    return failed ? -1 : 0;
}

int certify_loop(analysis *analysis, char *error)
{
    certificate_loop *loop = &analysis->certificate.loop;
    if (loop->is_made)
        return 0;
    if (trial_certify(analysis, error) < 0)
        return -1;
    if (loop->is_made && !loop->is_stable && !loop->target.is_made)
        trial_find_cure(analysis, loop);
    return 0;
}

/*
 * Write what the structure of the worst storm (simulation with fast jumps of the target) has beside
 * its static response and its frequencies: ceramic with hysteresis.
 *   hysteresis in  width of the hysteresis loop relative to the voltage range; 0: none
 */
static void hysteresis_text(double hysteresis, char text[HYSTERESIS_TEXT])
{
    text[0] = '\0';
    if (hysteresis > 0)
        snprintf(text, HYSTERESIS_TEXT, "%g %% hysteresis, ", 100 * hysteresis);
}

void certify_failure(const certificate *certificate, char text[SCENE_ERROR])
{
    const certificate_loop *loop = &certificate->loop;
    const certificate_target *target = &loop->target;
    char unit[CERTIFICATE_UNIT], hysteresis[HYSTERESIS_TEXT];
    const bool is_target = target->is_made && !target->is_stable;
    certificate_unit(loop, unit);
    hysteresis_text(loop->worst_hysteresis, hysteresis);
    text[0] = '\0';
    if (loop->bandwidth > 0)
        snprintf(text, SCENE_ERROR, "with amplifiers of %g Hz, which may be too slow, ",
                 loop->bandwidth);
    char *rest = text + strlen(text);
    const size_t room = SCENE_ERROR - strlen(text);
    if (is_target)
        snprintf(rest, room,
                 "about the shape of its target, %.3g thicknesses, at gain %g, frequency %g of the "
                 "deformed structure, vibration changes %.5g times a tick and %d of %d storms do "
                 "not settle%s",
                 target->amplitude, target->at_gain, target->at_frequency, target->radius,
                 target->failed, target->storms,
                 certificate_is_prestressed(certificate)
                     ? ""
                     : "; write simulate: {influence: target}, or make the target smaller");
    else if (loop->failed + loop->hysteresis_failed > 0)
        snprintf(
            rest, room,
            "after a storm of targets at %sgain %g, frequency %g, step limit x %g the shape ends "
            "%.3g %s from the best one (allowed: %g); %d of %d storms do not settle",
            hysteresis, loop->worst_gain, loop->worst_frequency, loop->worst_step, loop->worst,
            unit, CERTIFICATE_TOLERANCE, loop->failed + loop->hysteresis_failed,
            loop->storms + loop->hysteresis_storms);
    else
        snprintf(rest, room, "at gain %g, frequency %g vibration grows %.5g times a tick",
                 loop->at_gain, loop->at_frequency, loop->radius);
    if (certificate_is_prestressed(certificate))
        text_append(text, SCENE_ERROR,
                    "; the static loads make the first natural frequency %.3g times as high: write "
                    "kinematics: nonlinear and simulate: {influence: loaded}",
                    certificate->load_ratio);
}
