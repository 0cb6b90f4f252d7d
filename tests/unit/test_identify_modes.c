/*
 * Identification of vibration modes from steps of the voltages: frequencies, damping ratios and
 * shapes of a plate, with noise; close pairs; modes that the noise hides; records that show none.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/identify_modes.h"
#include "../rigs/uniform.h"

enum { ALONG = 6, ACROSS = 5, OUTPUTS = ALONG * ACROSS, ACTUATORS = 4, MOST_MODES = 8 };

static const double pi = 3.14159265358979323846;

/*
 * One mode of a simply supported plate: numbers of half waves along and across the plate, natural
 * frequency (Hz), damping ratio.
 */
typedef struct plate_mode {
    int along, across;
    double frequency, damping;
} plate_mode;

static const plate_mode plate[] = {{1, 1, 48.8, 0.01},
                                   {2, 1, 108.8, 0.006},
                                   {1, 2, 135.2, 0.015},
                                   {2, 2, 195.2, 0.008},
                                   {3, 1, 208.8, 0.02}};

typedef struct record {
    pokes samples;
    double rate;
    double *voltage, *reading;
    double shape[MOST_MODES][OUTPUTS]; /* displacement of each output in each mode, with a root mean
                                          square of 1 */
    double response[MOST_MODES][ACTUATORS]; /* static response of each mode to 1 V of each actuator,
                                               as a multiple of its shape (m/V) */
    double size;                            /* root mean square of all readings (m) */
} record;

static double wave(const plate_mode *mode, double x, double y)
{
    return sin(mode->along * pi * x) * sin(mode->across * pi * y);
}

static void fill_shapes(record *r, const plate_mode *mode, int modes)
{
    for (int k = 0; k < modes; k++) {
        double squares = 0;
        for (int i = 0; i < OUTPUTS; i++) {
            r->shape[k][i] = wave(&mode[k], (i % ALONG + 0.6) / (ALONG + 0.2),
                                  (i / ALONG + 0.7) / (ACROSS + 0.4));
            squares += pow(r->shape[k][i], 2) / OUTPUTS;
        }
        for (int i = 0; i < OUTPUTS; i++)
            r->shape[k][i] /= sqrt(squares);
    }
}

/*
 * Fill a record of voltages and readings. Every `hold` samples the voltages step to another
 * pattern; each mode answers the step of its static coordinate by free vibration, and the rest of
 * the structure follows without delay. The noise is relative to the root mean square of the
 * readings. The voltages act `late` samples after they are recorded.
 */
static void fill_late_record(record *r, const plate_mode *mode, int modes, size_t count,
                             size_t hold, double noise, size_t late)
{
    double deviation[MOST_MODES] = {0}, speed[MOST_MODES] = {0}, coordinate[MOST_MODES] = {0};
    unsigned seed = 3;
    memset(r, 0, sizeof *r);
    r->rate = 2000;
    r->voltage = calloc(count * ACTUATORS, sizeof *r->voltage);
    r->reading = calloc(count * OUTPUTS, sizeof *r->reading);
    assert_true(r->voltage && r->reading);
    r->samples = (pokes){count, ACTUATORS, OUTPUTS, r->voltage, r->reading, 0};
    fill_shapes(r, mode, modes);
    for (size_t t = 0; t < count; t++) {
        double voltage[ACTUATORS];
        const size_t acting = t > late ? t - late : 0;
        for (size_t k = 0; k < ACTUATORS; k++) {
            voltage[k] = acting / hold % ACTUATORS == k && acting >= hold / 4 ? 50 : 0;
            r->voltage[t * ACTUATORS + k] = t / hold % ACTUATORS == k && t >= hold / 4 ? 50 : 0;
        }
        for (int k = 0; k < modes; k++) {
            const double before = coordinate[k], natural = 2 * pi * mode[k].frequency,
                         damped = natural * sqrt(1 - pow(mode[k].damping, 2)),
                         decay = exp(-mode[k].damping * natural / r->rate),
                         cosine = cos(damped / r->rate), sine = sin(damped / r->rate);
            const double slope =
                speed[k] / damped + mode[k].damping * natural / damped * deviation[k];
            const double next = decay * (deviation[k] * cosine + slope * sine);
            speed[k] = decay * damped * (slope * cosine - deviation[k] * sine) -
                       mode[k].damping * natural * next;
            deviation[k] = next;
            coordinate[k] = 0;
            for (int j = 0; j < ACTUATORS; j++) {
                r->response[k][j] = 1e-7 / (1 + k) * wave(&mode[k], 0.2 + 0.17 * j, 0.3 + 0.11 * j);
                coordinate[k] += voltage[j] * r->response[k][j];
            }
            deviation[k] -= coordinate[k] - before;
        }
        for (int i = 0; i < OUTPUTS; i++) {
            double sum = 1e-9 * voltage[i % ACTUATORS];
            for (int k = 0; k < modes; k++)
                sum += r->shape[k][i] * (coordinate[k] + deviation[k]);
            r->reading[t * OUTPUTS + (size_t)i] = sum;
            r->size += sum * sum / (double)(count * OUTPUTS);
        }
    }
    r->size = sqrt(r->size);
    for (size_t i = 0; i < count * OUTPUTS; i++) {
        double sum = -6;
        for (int k = 0; k < 12; k++)
            sum += uniform(&seed, 0, 1);
        r->reading[i] += noise * r->size * sum;
    }
}

static void fill_record(record *r, const plate_mode *mode, int modes, size_t count, size_t hold,
                        double noise)
{
    fill_late_record(r, mode, modes, count, hold, noise, 0);
}

static void close_record(record *r)
{
    free(r->voltage);
    free(r->reading);
}

/* Sine of the angle between a found shape and a true one. */
static double turned(const double *found, const double *truth)
{
    double product = 0;
    for (int i = 0; i < OUTPUTS; i++)
        product += found[i] * truth[i] / OUTPUTS;
    return sqrt(fmax(1 - product * product, 0));
}

/*
 * Identify the modes of a record, compare them with the true modes, and print the largest errors.
 */
static void assert_found(const char *what, const record *r, const plate_mode *mode, int modes,
                         int most, double frequency, double damping, double shape)
{
    char error[SCENE_ERROR];
    identified_modes found;
    double worst[3] = {0, 0, 0};
    if (identify_modes(&found, &r->samples, r->rate, most, error) < 0)
        fail_msg("%s: %s", what, error);
    if (found.modes != modes)
        fail_msg("%s: %d modes found, not %d", what, found.modes, modes);
    for (int k = 0; k < modes; k++) {
        worst[0] = fmax(worst[0], fabs(found.frequency[k] / mode[k].frequency - 1));
        worst[1] = fmax(worst[1], fabs(found.damping[k] / mode[k].damping - 1));
        worst[2] = fmax(worst[2], turned(found.shape + k * OUTPUTS, r->shape[k]));
    }
    print_message("    %s: frequency %.2g, damping %.2g, shape %.2g, noise %.3g of %.3g\n", what,
                  worst[0], worst[1], worst[2], found.noise, r->size);
    assert_true(worst[0] < frequency && worst[1] < damping && worst[2] < shape);
    for (int k = 0; k < modes && found.noise > 1e-6 * r->size; k++) {
        assert_true(fabs(found.frequency[k] - mode[k].frequency) < 5 * found.frequency_error[k]);
        assert_true(fabs(found.damping[k] - mode[k].damping) < 5 * found.damping_error[k]);
    }
    identified_modes_free(&found);
}

/*
 * Law: without noise the modes are exact; with noise of 1e-3 and 1e-2 of the readings frequencies
 * are within 1 % and damping ratios within 20 %, and the errors are within five of the standard
 * errors told. Asked for more modes than there are, it invents none.
 */
static void test_plate(void **state)
{
    static const double noise[] = {0, 1e-3, 1e-2};
    (void)state;
    for (int k = 0; k < 3; k++) {
        record r;
        char what[40];
        snprintf(what, sizeof what, "plate, noise %g", noise[k]);
        fill_record(&r, plate, 5, 1600, 400, noise[k]);
        assert_found(what, &r, plate, 5, k == 1 ? 7 : 5, k ? 0.01 : 1e-7, k ? 0.2 : 1e-5,
                     k ? 0.1 : 1e-4);
        close_record(&r);
    }
}

/* Law: two modes that lie 2 % apart, less than the width of their peaks, are told apart. */
static void test_close_pair(void **state)
{
    static const plate_mode pair[] = {{2, 1, 100, 0.012}, {1, 2, 102, 0.012}, {3, 1, 260, 0.01}};
    record r;
    (void)state;
    fill_record(&r, pair, 3, 1600, 400, 1e-3);
    assert_found("pair 2 % apart", &r, pair, 3, 3, 0.01, 0.2, 0.1);
    close_record(&r);
}

/*
 * Law: two modes of equal frequency and damping, as a round mirror has, are both found: the static
 * displacement of every output under 1 V of every actuator that the pair causes is that of the true
 * pair, within the noise.
 */
static void test_twins(void **state)
{
    static const plate_mode twins[] = {
        {1, 1, 48.8, 0.01}, {3, 1, 135.2, 0.008}, {1, 3, 135.2, 0.008}, {2, 2, 195.2, 0.01}};
    static const double noise[] = {1e-3, 2e-2};
    (void)state;
    for (int k = 0; k < 2; k++) {
        record r;
        identified_modes found;
        double apart = 0, size = 0;
        char error[SCENE_ERROR];
        fill_record(&r, twins, 4, 1600, 400, noise[k]);
        assert_int_equal(identify_modes(&found, &r.samples, r.rate, 6, error), 0);
        assert_int_equal(found.modes, 4);
        assert_int_equal(found.twins, 1);
        assert_true(found.frequency[1] == found.frequency[2] && found.responses.is_found);
        for (int i = 0; i < OUTPUTS; i++)
            for (int j = 0; j < ACTUATORS; j++) {
                double told = 0, truth = 0;
                for (int mode = 1; mode <= 2; mode++) {
                    told += found.shape[mode * OUTPUTS + i] *
                            found.responses.value[mode * ACTUATORS + j];
                    truth += r.shape[mode][i] * r.response[mode][j];
                }
                apart += pow(told - truth, 2);
                size += pow(truth, 2);
            }
        print_message("    pair of 135.2 Hz: displacements %.2g off\n", sqrt(apart / size));
        assert_true(sqrt(apart / size) < noise[k]);
        identified_modes_free(&found);
        close_record(&r);
    }
}

/*
 * Law: a mode whose response is far below the noise is left out and does not disturb the others; a
 * pair 1 % apart is told apart in spite of 5 % of noise.
 */
static void test_noise(void **state)
{
    static const plate_mode weak[] = {{1, 1, 60, 0.01}, {2, 1, 140, 0.01}, {6, 5, 400, 0.01}};
    static const plate_mode pair[] = {{2, 1, 100, 0.008}, {1, 2, 101, 0.012}};
    record r;
    (void)state;
    fill_record(&r, weak, 2, 1600, 400, 5e-2);
    for (size_t t = 0; t < r.samples.count; t++)
        for (int i = 0; i < OUTPUTS; i++)
            r.reading[t * OUTPUTS + (size_t)i] += 1e-4 * r.size *
                                                  wave(&weak[2], 0.1 * i, 0.07 * i) *
                                                  sin(2 * pi * 400 * (double)t / r.rate);
    assert_found("hidden mode", &r, weak, 2, 3, 0.01, 0.2, 0.1);
    close_record(&r);
    fill_record(&r, pair, 2, 1600, 400, 5e-2);
    assert_found("pair 1 % apart, noise 5 %", &r, pair, 2, 2, 0.01, 0.2, 0.1);
    close_record(&r);
}

/*
 * Law: the static responses of the modes to each actuator, and the delay of the voltages, follow
 * from the vibration that the steps of the voltages add. Without noise they are exact but for the
 * refinement of the modes; with noise of 1e-2 of the readings they are within five standard errors
 * and 5 % of the largest response. The sign of a response is that of its shape.
 */
static void test_responses(void **state)
{
    static const struct {
        size_t late;
        double noise, tolerance;
    } cases[] = {{0, 0, 1e-6}, {2, 0, 1e-6}, {1, 1e-2, 0.05}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        record r;
        identified_modes found;
        char error[SCENE_ERROR];
        double worst = 0;
        fill_late_record(&r, plate, 5, 1600, 400, cases[i].noise, cases[i].late);
        assert_int_equal(identify_modes(&found, &r.samples, r.rate, 5, error), 0);
        assert_int_equal(found.modes, 5);
        if (!found.responses.is_found)
            fail_msg("%s", found.responses.reason);
        for (int k = 0; k < 5; k++) {
            double product = 0;
            for (int o = 0; o < OUTPUTS; o++)
                product += found.shape[k * OUTPUTS + o] * r.shape[k][o];
            const double sign = product < 0 ? -1 : 1;
            for (int j = 0; j < ACTUATORS; j++) {
                const double off =
                    fabs(sign * found.responses.value[k * ACTUATORS + j] - r.response[k][j]);
                worst = fmax(worst, off / 1e-7);
                assert_true(cases[i].noise <= 0 ||
                            off < 5 * found.responses.error[k * ACTUATORS + j]);
            }
        }
        print_message("    responses %.2g, delay %.6f of %zu samples\n", worst,
                      found.responses.delay * r.rate, cases[i].late);
        assert_true(worst < cases[i].tolerance);
        assert_true(fabs(found.responses.delay * r.rate - (double)cases[i].late) <
                    cases[i].tolerance);
        identified_modes_free(&found);
        close_record(&r);
    }
}

/*
 * Law: responses that the record does not determine are not given, and the reason is: an actuator
 * that moves with another one, and vibration that does not begin with the steps of the voltages.
 */
static void test_no_responses(void **state)
{
    identified_modes found;
    char error[SCENE_ERROR];
    record r;
    (void)state;
    fill_record(&r, plate, 2, 1600, 400, 0);
    for (size_t t = 0; t < r.samples.count; t++)
        r.voltage[t * ACTUATORS + 2] = -2 * r.voltage[t * ACTUATORS + 1];
    assert_int_equal(identify_modes(&found, &r.samples, r.rate, 2, error), 0);
    assert_false(found.responses.is_found);
    assert_non_null(strstr(found.responses.reason, "do not move column 3 of the voltages"));
    identified_modes_free(&found);
    close_record(&r);
    fill_record(&r, plate, 2, 1600, 400, 0);
    for (size_t t = 0; t < r.samples.count; t++) /* The voltages are recorded a third of a holding
                                                    time early. */
        for (size_t k = 0; k < ACTUATORS; k++)
            r.voltage[t * ACTUATORS + k] = t >= 60 && (t + 130) / 400 % ACTUATORS == k ? 50 : 0;
    assert_int_equal(identify_modes(&found, &r.samples, r.rate, 2, error), 0);
    assert_false(found.responses.is_found);
    assert_non_null(strstr(found.responses.reason, "does not begin with the steps"));
    identified_modes_free(&found);
    close_record(&r);
}

/*
 * Law: a record shows frequencies from two periods in the longest interval to half the samples a
 * second; a rate with which no structure vibrates in this range is refused with the range.
 */
static void test_range(void **state)
{
    static const double wrong[] = {1e-9, 1e-4, 1e12};
    static const char *const range[] = {"from 5e-12 to 5e-10 Hz", "from 5e-07 to 5e-05 Hz",
                                        "from 5e+09 to 5e+11 Hz"};
    identified_modes found;
    char error[SCENE_ERROR];
    record r;
    (void)state;
    fill_record(&r, plate, 2, 1600, 400, 0);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(identify_modes(&found, &r.samples, wrong[i], 2, error), -1);
        if (!strstr(error, range[i]))
            fail_msg("%g: %s", wrong[i], error);
        identified_modes_free(&found);
    }
    assert_int_equal(identify_modes(&found, &r.samples, r.rate, 2, error), 0);
    assert_true(fabs(found.shown[0] - 10) < 1e-9 && fabs(found.shown[1] - 1000) < 1e-9);
    identified_modes_free(&found);
    close_record(&r);
}

/* Law: a single reading is enough to identify frequencies and damping ratios. */
static void test_one_reading(void **state)
{
    record r;
    identified_modes found;
    char error[SCENE_ERROR];
    (void)state;
    fill_record(&r, plate, 2, 1600, 800, 1e-3);
    r.samples.outputs = 1;
    for (size_t t = 0; t < r.samples.count; t++)
        r.reading[t] = r.reading[t * OUTPUTS + 8];
    assert_int_equal(identify_modes(&found, &r.samples, r.rate, 2, error), 0);
    assert_int_equal(found.modes, 2);
    for (int k = 0; k < 2; k++) {
        assert_true(fabs(found.frequency[k] / plate[k].frequency - 1) < 0.01);
        assert_true(fabs(found.damping[k] / plate[k].damping - 1) < 0.2);
    }
    identified_modes_free(&found);
    close_record(&r);
}

/*
 * Law: a record without vibration, or without steps that are followed by constant voltages, is
 * refused with a message of one line.
 */
static void test_refused(void **state)
{
    identified_modes found;
    char error[SCENE_ERROR];
    record r;
    unsigned seed = 5;
    (void)state;
    fill_record(&r, plate, 2, 800, 400, 0);
    for (size_t i = 0; i < r.samples.count * OUTPUTS; i++)
        r.reading[i] = uniform(&seed, -1e-6, 1e-6);
    assert_int_equal(identify_modes(&found, &r.samples, r.rate, 3, error), -1);
    assert_non_null(strstr(error, "no vibration stands out"));
    identified_modes_free(&found);
    memset(r.reading, 0, r.samples.count * OUTPUTS * sizeof *r.reading);
    assert_int_equal(identify_modes(&found, &r.samples, r.rate, 3, error), -1);
    assert_non_null(strstr(error, "no vibration stands out"));
    identified_modes_free(&found);
    for (size_t t = 0; t < r.samples.count; t++)
        r.voltage[t * ACTUATORS] = (double)(t / 20);
    assert_int_equal(identify_modes(&found, &r.samples, r.rate, 3, error), -1);
    assert_non_null(strstr(error, "more than 40 samples"));
    identified_modes_free(&found);
    assert_int_equal(identify_modes(&found, &r.samples, r.rate, 21, error), -1);
    assert_non_null(strstr(error, "21 modes are out of range (1 to 20)"));
    identified_modes_free(&found);
    close_record(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_twins),      cmocka_unit_test(test_plate),
        cmocka_unit_test(test_close_pair), cmocka_unit_test(test_noise),
        cmocka_unit_test(test_responses),  cmocka_unit_test(test_no_responses),
        cmocka_unit_test(test_range),      cmocka_unit_test(test_one_reading),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
