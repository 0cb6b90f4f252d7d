/* SPDX-License-Identifier: BSD-2-Clause */
/* Tables and texts of the self-test of amplifiers, cables and sensors (wiring_test.h). */
#include "wiring_test.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../text/append.h"

/*
 * Duration of a test pulse of the self-test: number of periods of the first vibration mode, and
 * smallest and largest number of ticks. Six periods allow for an error of 10 % in the natural
 * frequency.
 */
static const double periods = 6, fewest_ticks = 64, most_ticks = 60000;

/*
 * Test pulses of the fault detector in a control loop that damps vibration: heights relative to the
 * voltage range of the amplifier, and duration in periods of the first vibration mode. Where the
 * step limit would make the duration longer, the pulses are lower, down to the smallest height.
 */
static const double detector_height = 0.2, least_height = 0.1, detector_periods = 3.2;

/*
 * Fraction of the voltage range and of the step limit of an amplifier that a test pulse uses at
 * most. The fraction is below 1 because the tables hold the limits in single precision, rounded
 * inwards.
 */
static const double margin = 0.99;

/*
 * Noise of a sensor above which the self-test reports the sensor as too noisy, as a multiple of the
 * noise that the scene file states.
 */
static const double noise_margin = 5;

/*
 * Smallest noise above which the self-test reports a sensor as too noisy, relative to the root mean
 * square response of all sensors to a test pulse. This bound is needed where the scene file states
 * little or no noise.
 */
static const double least_noise = 0.02;

/* ---- tables ----------------------------------------------------------- */

/*
 * Return the height of the test pulse of an amplifier (V); 0 if the amplifier cannot change its
 * voltage.
 */
static double height_of(const design *design, int amplifier, double amplitude)
{
    const double range = design->upper[amplifier] - design->lower[amplifier];
    return design->step_limit[amplifier] > 0 ? fmin(amplitude, margin * range / 2) : 0;
}

/*
 * Return the duration of a test pulse of the self-test (ticks).
 *   count in  number of periods of the first vibration mode in a pulse, where the scene file gives
 *       no duration
 */
static uint16_t window_of(const analysis *analysis, const double *height, double count)
{
    const design *design = &analysis->design;
    const certificate *certificate = &analysis->certificate;
    const double rate = design->control.rate;
    double ticks = fewest_ticks;
    if (certificate->has_modes && rate > 0 && certificate_first(certificate) > 0)
        ticks = fmax(ticks, count * rate / certificate_first(certificate));
    if (design->safety.pulse_ticks > 0)
        ticks = design->safety.pulse_ticks;
    for (int k = 0; k < design->amplifiers; k++)
        if (height[k] > 0)
            ticks = fmax(ticks, 4 * height[k] / (margin * design->step_limit[k]));
    return (uint16_t)fmin(ceil(ticks), most_ticks);
}

/*
 * List the noise that the scene file states for each sensor, in the unit of the sensor's reading.
 */
static void list_noise(const design *design, const estimator *estimator, size_t sensors,
                       double *noise)
{
    size_t at = 0;
    for (size_t i = 0; i < sensors; i++)
        noise[i] = design->simulate.noise;
    for (int k = 0; estimator && k < design->estimate.readings; k++) {
        const int output = design->estimate.reading[k].output;
        for (int row = design->named_first[output]; row < design->named_first[output + 1]; row++)
            if (at < sensors)
                noise[at++] = design->estimate.reading[k].noise;
    }
}

/*
 * Return the root mean square, over all sensors and amplifiers, of the response of a sensor to 1 V
 * at an amplifier. Each response is multiplied by a factor of its sensor, the scale, which makes
 * sensors of different units comparable.
 */
static double mean_response(const pzs_selftest_tables *tables, const double *direct,
                            const double *scale)
{
    const size_t inputs = tables->inputs, sensors = tables->sensors;
    double sum = 0;
    for (size_t i = 0; i < sensors; i++)
        for (size_t j = 0; j < inputs; j++)
            sum += pow(scale[i] * direct[i * inputs + j], 2);
    return sqrt(sum / (double)(inputs * sensors));
}

/*
 * Set the scale of each sensor, by which its readings are multiplied, and the noise above which it
 * is reported as too noisy. With the scales, the mean square response of the sensors to 1 V is 1.
 * If the scene file states the noise of the sensors, scales are inversely proportional to it, so
 * that the units of sensors may differ.
 */
static void set_scales(const pzs_selftest_tables *tables, const double *direct, double amplitude,
                       double *scale, double *noise)
{
    double least = HUGE_VAL;
    for (size_t i = 0; i < tables->sensors; i++)
        least = fmin(least, noise[i]);
    for (size_t i = 0; i < tables->sensors; i++)
        scale[i] = least > 0 ? 1 / noise[i] : 1;
    const double mean = mean_response(tables, direct, scale);
    for (size_t i = 0; i < tables->sensors; i++) {
        scale[i] /= mean > 0 ? mean : 1;
        noise[i] = fmax(noise_margin * noise[i], least_noise * amplitude / scale[i]);
    }
}

/*
 * Allocate the tables of the self-test of the wiring, and fill them except for the heights and
 * durations of the test pulses. Returns the array of the heights [inputs], or NULL where memory
 * runs out.
 */
static double *open_tables(wiring_test *test, const design *design, const estimator *estimator)
{
    const size_t inputs = design->problem.inputs;
    const size_t sensors = estimator ? (size_t)estimator->sensors : design->problem.outputs;
    test->memory = calloc(inputs + 3 * sensors + 1, sizeof *test->memory);
    if (!test->memory)
        return NULL;
    double *height = test->memory, *scale = height + inputs, *noise = scale + sensors;
    test->tables = (pzs_selftest_tables){.scene = design->problem.scene,
                                         .inputs = (uint16_t)inputs,
                                         .sensors = (uint16_t)sensors,
                                         .delay = (uint16_t)design->simulate.delay,
                                         .direct = estimator ? estimator->tables.direct : NULL,
                                         .amplitude = height,
                                         .scale = scale,
                                         .noise = noise,
                                         .gain_tolerance = design->safety.gain_tolerance};
    list_noise(design, estimator, sensors, noise);
    test->stated = noise + sensors;
    memcpy(test->stated, noise, sensors * sizeof *noise);
    return height;
}

/*
 * Complete the tables of the self-test of the wiring: scale factors of the sensors, and the noise
 * above which a sensor counts as too noisy. Heights and durations of the test pulses must be set.
 *   amplitude in  height of a test pulse (V); the permitted noise is at least a fixed fraction of
 *       the mean effect of such a pulse on the sensors
 */
static void complete_tables(wiring_test *test, const design *design, double amplitude)
{
    double *scale = test->memory + test->tables.inputs, *noise = scale + test->tables.sensors;
    const double *direct = test->tables.direct ? test->tables.direct : design->problem.influence;
    set_scales(&test->tables, direct, amplitude, scale, noise);
    (void)pzs_selftest_seal(&test->tables);
}

bool wiring_test_open(wiring_test *test, const analysis *analysis, const estimator *estimator)
{
    const design *design = &analysis->design;
    const scene_safety *safety = &design->safety;
    memset(test, 0, sizeof *test);
    test->is_used = safety->given && safety->amplitude > 0;
    if (!test->is_used)
        return true;
    double *height = open_tables(test, design, estimator);
    if (!height)
        return false;
    for (int k = 0; k < design->amplifiers; k++)
        height[k] = height_of(design, k, safety->amplitude);
    test->tables.pulse_ticks = window_of(analysis, height, periods);
    complete_tables(test, design, safety->amplitude);
    return true;
}

bool wiring_test_detector_open(wiring_test *test, const analysis *analysis,
                               const estimator *estimator)
{
    const design *design = &analysis->design;
    double highest = 0;
    memset(test, 0, sizeof *test);
    test->is_used = design->simulate.detects_faults;
    if (!test->is_used)
        return true;
    double *height = open_tables(test, design, estimator);
    if (!height)
        return false;
    for (int k = 0; k < design->amplifiers; k++) {
        const double range = design->upper[k] - design->lower[k];
        height[k] = isfinite(range) ? height_of(design, k, least_height * range) : 0;
    }
    test->tables.pulse_ticks = window_of(analysis, height, detector_periods);
    for (int k = 0; k < design->amplifiers; k++) {
        const double steps = margin * test->tables.pulse_ticks / 4 * design->step_limit[k];
        const double raised = fmin(detector_height / least_height * height[k], steps);
        height[k] = fmax(height[k], raised);
        highest = fmax(highest, height[k]);
    }
    if (!(test->tables.gain_tolerance > 0))
        test->tables.gain_tolerance = 1;
    complete_tables(test, design, highest);
    return true;
}

void wiring_test_close(wiring_test *test)
{
    free(test->memory);
    memset(test, 0, sizeof *test);
}

uint32_t wiring_test_ticks(const wiring_test *test)
{
    const pzs_selftest_tables *tables = &test->tables;
    return PZS_SELFTEST_TICKS(tables->inputs, tables->sensors, tables->pulse_ticks, tables->delay);
}

/* ---- texts ------------------------------------------------------------ */

int wiring_test_tested(const wiring_test *test)
{
    int tested = 0;
    for (size_t j = 0; j < test->tables.inputs; j++)
        tested += test->tables.amplitude[j] > 0 ? 1 : 0;
    return tested;
}

/*
 * Append to the description of a self-test the heights of its lowest and its highest test pulse,
 * and whether the voltage limits have cut a pulse.
 */
static void append_heights(const wiring_test *test, double amplitude, char text[SCENE_ERROR])
{
    double lowest = HUGE_VAL, highest = 0;
    for (size_t j = 0; j < test->tables.inputs; j++) {
        const double height = test->tables.amplitude[j];
        lowest = height > 0 ? fmin(lowest, height) : lowest;
        highest = fmax(highest, height);
    }
    lowest = fmin(lowest, highest);
    text_append(text, SCENE_ERROR, "pulses of %g", lowest);
    if (highest > lowest)
        text_append(text, SCENE_ERROR, " to %g", highest);
    text_append(text, SCENE_ERROR, " V");
    if (lowest < amplitude)
        text_append(text, SCENE_ERROR, " (half the voltage range allows no %g V)", amplitude);
}

void wiring_test_text(const wiring_test *test, const analysis *analysis, char text[SCENE_ERROR])
{
    const double rate = analysis->design.control.rate;
    const uint32_t ticks = wiring_test_ticks(test);
    text[0] = '\0';
    text_append(text, SCENE_ERROR, "self-test before the loop takes control: ");
    append_heights(test, analysis->design.safety.amplitude, text);
    text_append(text, SCENE_ERROR, ", %u ticks each, at most %lu ticks", test->tables.pulse_ticks,
                (unsigned long)ticks);
    if (rate > 0)
        text_append(text, SCENE_ERROR, " (%.3g s)", ticks / rate);
}

/*
 * Return the height of the test pulse of one amplifier (V) at which its response stands out from
 * the noise in the scene file; infinite where the amplifier moves no sensor. The height contains a
 * margin, because the self-test estimates the noise from two samples, which vary by chance.
 */
static double sufficient_height(const wiring_test *test, const double *direct, size_t amplifier)
{
    static const double energy_margin = 4;
    const pzs_selftest_tables *tables = &test->tables;
    double modelled = 0, noise = 0;
    for (size_t i = 0; i < tables->sensors; i++) {
        modelled += pow(tables->scale[i] * direct[i * tables->inputs + amplifier], 2);
        noise += pow(tables->scale[i] * test->stated[i], 2);
    }
    noise *= PZS_SELFTEST_NOISE_ENERGY / tables->pulse_ticks;
    return modelled > 0 ? sqrt(energy_margin * PZS_SELFTEST_JUDGED * noise / modelled) : HUGE_VAL;
}

/*
 * Reason why the self-test of the wiring cannot judge an amplifier: no test pulse is applied to it,
 * its test pulses change no sensor reading, or noise hides the change.
 */
typedef enum doubt { DOUBT_NONE, DOUBT_UNTESTED, DOUBT_UNMOVED, DOUBT_HIDDEN, DOUBTS } doubt;

static doubt doubt_about(const wiring_test *test, const double *direct, size_t amplifier)
{
    const double height = test->tables.amplitude[amplifier];
    const double least = sufficient_height(test, direct, amplifier);
    if (!(height > 0))
        return DOUBT_UNTESTED;
    if (!(least < HUGE_VAL))
        return DOUBT_UNMOVED;
    return height < least ? DOUBT_HIDDEN : DOUBT_NONE;
}

/*
 * Append to the remarks on a self-test which amplitude and duration of the test pulses would
 * suffice, for amplifiers whose response is hidden by noise.
 */
static void append_cure(const wiring_test *test, const design *design, const double *direct,
                        char text[SCENE_ERROR])
{
    double amplitude = 0, ticks = 0, most = HUGE_VAL;
    for (size_t j = 0; j < test->tables.inputs; j++) {
        const double height = test->tables.amplitude[j];
        if (doubt_about(test, direct, j) != DOUBT_HIDDEN)
            continue;
        const double least = sufficient_height(test, direct, j);
        amplitude = fmax(amplitude, least);
        ticks = fmax(ticks, ceil(test->tables.pulse_ticks * pow(least / height, 2)));
        most = fmin(most, margin * (design->upper[j] - design->lower[j]) / 2);
    }
    if (amplitude <= most)
        text_append(text, SCENE_ERROR, "; amplitude: %.3g suffices", 1.01 * amplitude);
    if (ticks <= most_ticks)
        text_append(text, SCENE_ERROR, "; pulse_ticks: %.0f suffices", ticks);
    if (amplitude > most && ticks > most_ticks)
        text_append(text, SCENE_ERROR, "; no pulse suffices, only less noise");
}

void wiring_test_remarks(const wiring_test *test, const analysis *analysis, char text[SCENE_ERROR])
{
    static const char *const words[DOUBTS] = {
        [DOUBT_UNTESTED] = "not tested, because they are held:",
        [DOUBT_UNMOVED] = "no sensor can tell whether these amplifiers work:",
        [DOUBT_HIDDEN] = "noise may hide the response of"};
    const design *design = &analysis->design;
    const double *direct = test->tables.direct ? test->tables.direct : design->problem.influence;
    text[0] = '\0';
    for (int doubt = DOUBT_UNTESTED; doubt < DOUBTS; doubt++) {
        int count = 0;
        for (int k = 0; k < design->amplifiers; k++) {
            if ((int)doubt_about(test, direct, (size_t)k) != doubt)
                continue;
            if (count == 0)
                text_append(text, SCENE_ERROR, "%s%s", *text ? "; " : "", words[doubt]);
            text_append(text, SCENE_ERROR, "%s %s", count ? "," : "", design->amplifier_name[k]);
            count++;
        }
        if (doubt == DOUBT_HIDDEN && count > 0)
            append_cure(test, design, direct, text);
    }
}

/*
 * Append to a text what the self-test of the wiring found about one amplifier or sensor; `other` is
 * the name of the amplifier or sensor with which it has exchanged its cable.
 */
static void append_finding(char text[SCENE_ERROR], const char *name, const pzs_wiring *finding,
                           const char *other)
{
    static const char *const word[] = {
        [PZS_WIRING_SILENT] = "does not respond",        [PZS_WIRING_REVERSED] = "is reversed",
        [PZS_WIRING_SWAPPED] = "is swapped with",        [PZS_WIRING_GAIN] = "has the gain",
        [PZS_WIRING_UNKNOWN] = "responds like no other", [PZS_WIRING_NOISY] = "is too noisy"};
    text_append(text, SCENE_ERROR, "%s%s %s", *text ? "; " : "", name, word[finding->state]);
    if (finding->state == PZS_WIRING_SWAPPED)
        text_append(text, SCENE_ERROR, " %s", other);
    if (finding->state == PZS_WIRING_GAIN)
        text_append(text, SCENE_ERROR, " %.3g", finding->gain);
}

/*
 * Append to a text the names, separated by commas, of all amplifiers to which the self-test of the
 * wiring has assigned a given state, such as dead or reversed.
 */
static void append_names(const pzs_selftest *selftest, const design *design, pzs_wiring_state state,
                         char text[SCENE_ERROR])
{
    const char *separator = " ";
    for (int k = 0; k < design->amplifiers; k++) {
        if (selftest->info.amplifier[k].state != state)
            continue;
        text_append(text, SCENE_ERROR, "%s%s", separator, design->amplifier_name[k]);
        separator = ", ";
    }
}

/* Append to a text what the self-test of the wiring found about each amplifier. */
static void append_amplifiers(const pzs_selftest *selftest, const design *design,
                              char text[SCENE_ERROR])
{
    for (int k = 0; k < design->amplifiers; k++) {
        const pzs_wiring *finding = &selftest->info.amplifier[k];
        const bool has_other = finding->other < design->amplifiers;
        if (finding->state >= PZS_WIRING_SILENT)
            append_finding(text, design->amplifier_name[k], finding,
                           has_other ? design->amplifier_name[finding->other] : "");
    }
}

void wiring_test_findings(const pzs_selftest *selftest, const analysis *analysis,
                          char text[SCENE_ERROR])
{
    const int sensors = selftest->state.tables->sensors;
    text[0] = '\0';
    append_amplifiers(selftest, &analysis->design, text);
    for (int i = 0; i < sensors; i++) {
        const pzs_wiring *finding = &selftest->info.sensor[i];
        char name[SCENE_LABEL], other[SCENE_LABEL];
        snprintf(name, sizeof name, "sensor %d", i);
        snprintf(other, sizeof other, "sensor %d", finding->other);
        if (finding->state >= PZS_WIRING_SILENT)
            append_finding(text, name, finding, other);
    }
    if (selftest->info.verdict == PZS_SELFTEST_DISTURBED) {
        text_append(text, SCENE_ERROR, "vibration or noise hides the response of");
        append_names(selftest, &analysis->design, PZS_WIRING_UNOBSERVABLE, text);
    }
}
