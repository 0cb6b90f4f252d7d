/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Electrodes whose faults a fault detector with test pulses can find from the sensors of a scene
 * (detection.h). The library's fault detector itself decides which electrodes the sensors observe.
 */
#include "detection.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/test_pulse.h"
#include "../text/append.h"

/*
 * Smallest signal-to-noise ratio at which a fault is found reliably: response to a test pulse,
 * divided by the standard deviation of its noise. A dead electrode counts as faulty if its measured
 * gain is below 0.35 of the gain of a healthy one; this difference must be at least six standard
 * deviations.
 */
static const double least_ratio = 6 / 0.35;

/*
 * Return the response of all sensors to the test pulse of an electrode, divided by the standard
 * deviation that the noise of the readings causes in this response; infinite without noise.
 */
static double ratio_of(const wiring_test *test, const double *direct, size_t electrode)
{
    const pzs_selftest_tables *tables = &test->tables;
    double pulse = 0, weights = 0, response = 0, noise = 0;
    for (uint32_t tick = 0; tick < tables->pulse_ticks; tick++) {
        const double place = test_pulse_place(tick, tables->pulse_ticks);
        pulse += test_pulse_even(place) * test_pulse_at(place);
        weights += pow(test_pulse_even(place), 2);
    }
    for (size_t i = 0; i < tables->sensors; i++) {
        const double scaled = tables->scale[i] * direct[i * tables->inputs + electrode];
        response += pow(scaled, 2);
        noise += pow(scaled * tables->scale[i] * test->stated[i], 2);
    }
    response *= tables->amplitude[electrode] * pulse;
    noise = sqrt(noise * weights);
    return noise > 0 ? response / noise : HUGE_VAL;
}

/*
 * Find out on which electrodes the fault detector can detect a fault. The result holds their
 * number, the reason for every other electrode, and the electrode with the smallest ratio of
 * response to noise.
 *   state [electrodes] in  initial state in the fault detector (pzs_electrode_state)
 */
static void judge(detection *detection, const wiring_test *test, const double *direct,
                  const uint8_t *state)
{
    for (int k = 0; k < detection->electrodes; k++) {
        if (state[k] == PZS_ELECTRODE_UNOBSERVABLE) {
            detection->doubt[k] = DETECTION_UNOBSERVABLE;
            continue;
        }
        const double ratio = ratio_of(test, direct, (size_t)k);
        const bool is_hidden = ratio < least_ratio;
        detection->doubt[k] = is_hidden ? DETECTION_HIDDEN : DETECTION_SURE;
        detection->detectable += is_hidden ? 0 : 1;
        if (!(detection->ratio > 0) || ratio < detection->ratio) {
            detection->ratio = ratio;
            detection->weakest = k;
        }
    }
}

bool detection_of(detection *detection, const loop_blocks *blocks)
{
    const wiring_test *test = blocks->pulses;
    const design *design = blocks->design;
    const size_t count = (size_t)blocks->count;
    pzs_loop loop;
    double none;
    memset(detection, 0, sizeof *detection);
    (void)pzs_loop_init(&loop, blocks->block, count, NULL, &none, 0);
    const size_t need = (size_t)loop.info.where;
    void *work = malloc(need);
    detection->electrodes = design->amplifiers;
    detection->sensors = test->tables.sensors;
    detection->ticks = test->tables.pulse_ticks;
    detection->motion = (int)PZS_SUSPICION_TICKS(test->tables.pulse_ticks, test->tables.delay);
    detection->proof = (int)PZS_PROOF_TICKS(test->tables.pulse_ticks, test->tables.delay);
    detection->doubt = calloc((size_t)design->amplifiers + 1, sizeof *detection->doubt);
    const bool has_memory = work && detection->doubt;
    if (has_memory && !PZS_IS_ERROR(pzs_loop_init(&loop, blocks->block, count, NULL, work, need))) {
        const pzs_pulse_detector *detector = pzs_loop_find(&loop, &pzs_pulse_detector_block);
        const double *direct =
            test->tables.direct ? test->tables.direct : design->problem.influence;
        judge(detection, test, direct, detector->info.electrode);
        detection->is_used = true;
    }
    free(work);
    return has_memory;
}

bool detection_make(detection *detection, const analysis *analysis)
{
    const design *design = &analysis->design;
    char ignored[SCENE_ERROR];
    loop_parts parts;
    bool has_memory = true;
    memset(detection, 0, sizeof *detection);
    if (!design->simulate.detects_faults || design->targets == 0 ||
        design->problem.influence == NULL || loop_parts_open(&parts, analysis, ignored) < 0)
        return true;
    if (parts.damper.is_used && parts.pulses.is_used)
        has_memory = detection_of(detection, &parts.blocks);
    loop_parts_close(&parts);
    return has_memory;
}

void detection_close(detection *detection)
{
    free(detection->doubt);
    memset(detection, 0, sizeof *detection);
}

void detection_text(const detection *detection, const design *design, char text[SCENE_ERROR])
{
    text[0] = '\0';
    text_append(text, SCENE_ERROR,
                "fault detector: finds faults of %d of %d electrodes from %d sensors, by test "
                "pulses of %d ticks; a fault is suspected within %d ticks of motion, and proved %d "
                "ticks after it",
                detection->detectable, detection->electrodes, detection->sensors, detection->ticks,
                detection->motion, detection->proof);
    if (detection->ratio > 0 && detection->ratio < HUGE_VAL)
        text_append(text, SCENE_ERROR, "; the weakest response, of %s, is %.3g times its noise",
                    design->amplifier_name[detection->weakest], detection->ratio);
}

void detection_remarks(const detection *detection, const design *design, char text[SCENE_ERROR])
{
    static const char *const words[DETECTION_DOUBTS] = {
        [DETECTION_UNOBSERVABLE] = "the sensors do not show faults of",
        [DETECTION_HIDDEN] = "noise hides the response of"};
    text[0] = '\0';
    for (int doubt = DETECTION_UNOBSERVABLE; doubt < DETECTION_DOUBTS; doubt++) {
        int count = 0;
        for (int k = 0; k < detection->electrodes; k++) {
            if ((int)detection->doubt[k] != doubt)
                continue;
            if (count == 0)
                text_append(text, SCENE_ERROR, "%s%s", *text ? "; " : "", words[doubt]);
            text_append(text, SCENE_ERROR, "%s %s", count ? "," : "", design->amplifier_name[k]);
            count++;
        }
    }
    if (detection->sensors < (int)PZS_PULSE_SENSORS)
        text_append(text, SCENE_ERROR, "; a proof needs %u sensors or more", PZS_PULSE_SENSORS);
}

void detection_json(const detection *detection, const design *design, json *json)
{
    if (!detection->is_used)
        return;
    json_open(json, "fault_detector", '{');
    json_number(json, "electrodes", detection->electrodes);
    json_number(json, "detectable", detection->detectable);
    json_number(json, "sensors", detection->sensors);
    json_number(json, "pulse_ticks", detection->ticks);
    json_number(json, "motion_ticks", detection->motion);
    json_number(json, "proof_ticks", detection->proof);
    if (detection->ratio > 0 && detection->ratio < HUGE_VAL) {
        json_number(json, "response_to_noise", detection->ratio);
        json_string(json, "weakest", design->amplifier_name[detection->weakest]);
    }
    json_open(json, "undetectable", '[');
    for (int k = 0; k < detection->electrodes; k++)
        if (detection->doubt[k] != DETECTION_SURE)
            json_string(json, NULL, design->amplifier_name[k]);
    json_close(json, ']');
    json_close(json, '}');
}
