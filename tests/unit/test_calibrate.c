/*
 * Influence matrices from pokes: least squares, with a model where pokes are few, dead electrodes,
 * reversed wires and swapped cables.
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
#include "../../host_tools/model/calibrate_model.h"
#include "../../host_tools/model/poke_drift.h"
#include "../../host_tools/model/poke_outliers.h"
#include "../rigs/scene_assert.h"
#include "../rigs/uniform.h"

/* ---- pokes ------------------------------------------------------------ */

static uint32_t random_state = 7;

/* Normal number by the sum of twelve uniform ones. */
static double draw_normal(void)
{
    double sum = -6;
    for (int i = 0; i < 12; i++)
        sum += uniform(&random_state, 0, 1);
    return sum;
}

typedef struct experiment {
    pokes pokes;
    double *voltage, *shape;
    double *truth; /* [outputs][actuators] */
} experiment;

typedef enum excitation { ONE_BY_ONE, RANDOM_SIGNS, HADAMARD } excitation;

static double voltage_at(excitation type, size_t poke, size_t actuator)
{
    size_t bits = poke & actuator;
    int parity = 0;
    for (; bits; bits >>= 1)
        parity ^= (int)(bits & 1);
    switch (type) {
    case ONE_BY_ONE: return poke == actuator ? 100 : 0;
    case HADAMARD: return parity ? -100 : 100;
    default: return uniform(&random_state, 0, 1) < 0.5 ? -100 : 100;
    }
}

static void open_experiment(experiment *e, size_t count, size_t actuators, size_t outputs,
                            excitation type)
{
    e->voltage = calloc(count * actuators, sizeof *e->voltage);
    e->shape = calloc(count * outputs, sizeof *e->shape);
    e->truth = calloc(outputs * actuators, sizeof *e->truth);
    assert_true(e->voltage && e->shape && e->truth);
    for (size_t p = 0; p < count; p++)
        for (size_t k = 0; k < actuators; k++)
            e->voltage[p * actuators + k] = voltage_at(type, p, k);
    e->pokes = (pokes){count, actuators, outputs, e->voltage, e->shape, 0};
}

static void close_experiment(experiment *e)
{
    free(e->voltage);
    free(e->shape);
    free(e->truth);
}

/* Fill the shapes: the truth times the voltages, with noise relative to the RMS of the shapes. */
static double measure(experiment *e, double noise)
{
    const pokes *p = &e->pokes;
    double squares = 0;
    for (size_t r = 0; r < p->count; r++)
        for (size_t i = 0; i < p->outputs; i++) {
            double sum = 0;
            for (size_t k = 0; k < p->actuators; k++)
                sum += e->truth[i * p->actuators + k] * e->voltage[r * p->actuators + k];
            e->shape[r * p->outputs + i] = sum;
            squares += sum * sum;
        }
    const double sigma = noise * sqrt(squares / (double)(p->count * p->outputs));
    for (size_t i = 0; i < p->count * p->outputs; i++)
        e->shape[i] += sigma * draw_normal();
    return sigma;
}

/* |B - truth| / |truth| */
static double error_of(const experiment *e, const double *influence)
{
    double apart = 0, size = 0;
    for (size_t i = 0; i < e->pokes.outputs * e->pokes.actuators; i++) {
        apart += pow(influence[i] - e->truth[i], 2);
        size += pow(e->truth[i], 2);
    }
    return sqrt(apart / size);
}

static void run(calibration *c, const experiment *e, const double *model)
{
    char error[SCENE_ERROR];
    if (calibrate(c, &e->pokes, model, error) < 0)
        fail_msg("%s", error);
}

/* ---- without a model --------------------------------------------------- */

enum { ACTUATORS = 16, OUTPUTS = 60 };

static void random_truth(experiment *e)
{
    for (size_t i = 0; i < e->pokes.outputs * e->pokes.actuators; i++)
        e->truth[i] = 1e-8 * (2 * uniform(&random_state, 0, 1) - 1);
}

/* Law: without noise, as many independent pokes as actuators give the matrix to rounding. */
static void test_exact(void **state)
{
    (void)state;
    for (excitation type = ONE_BY_ONE; type <= HADAMARD; type++) {
        experiment e;
        calibration c;
        open_experiment(&e, type == RANDOM_SIGNS ? 24 : ACTUATORS, ACTUATORS, OUTPUTS, type);
        random_truth(&e);
        measure(&e, 0);
        run(&c, &e, NULL);
        assert_true(error_of(&e, c.influence) < 1e-12);
        assert_int_equal(c.rank, ACTUATORS);
        calibration_free(&c);
        close_experiment(&e);
    }
}

/*
 * Law: with noise s, the standard error of an entry is s sqrt([(V'V)^-1]_kk): s/100 V for pokes one
 * by one, s/(100 V sqrt(pokes)) for Hadamard pokes. The noise found is s within its own sampling
 * error, and the errors made are the standard errors told.
 */
static void test_noise_floor(void **state)
{
    (void)state;
    static const struct {
        excitation type;
        size_t count;
    } runs[] = {{HADAMARD, 32}, {HADAMARD, 128}, {HADAMARD, 4096}, {RANDOM_SIGNS, 64}};
    for (size_t k = 0; k < sizeof runs / sizeof *runs; k++) {
        experiment e;
        calibration c;
        double made = 0, told = 0;
        open_experiment(&e, runs[k].count, ACTUATORS, OUTPUTS, runs[k].type);
        random_truth(&e);
        const double sigma = measure(&e, 1e-3);
        run(&c, &e, NULL);
        for (size_t i = 0; i < OUTPUTS * ACTUATORS; i++)
            made += pow(c.influence[i] - e.truth[i], 2) / (OUTPUTS * ACTUATORS);
        for (size_t a = 0; a < ACTUATORS; a++) {
            told += c.error[a] * c.error[a] / ACTUATORS;
            if (runs[k].type == HADAMARD) /* to the sampling error of the noise that was found */
                assert_near("standard error", c.error[a],
                            c.noise / (100 * sqrt((double)runs[k].count)), 1e-9);
        }
        const double left = (double)((runs[k].count - ACTUATORS) * OUTPUTS);
        assert_near("noise", c.noise, sigma, 5 / sqrt(2 * left));
        assert_near("error", sqrt(made), sqrt(told), 5 / sqrt(2.0 * OUTPUTS * ACTUATORS));
        calibration_free(&c);
        close_experiment(&e);
    }
}

/*
 * Law: where outputs have noise of their own, the standard errors of their entries differ as it
 * does. The noise of one output is found within the sampling error of its readings and of the share
 * that the noise of all outputs has in it.
 */
static void test_noise_of_outputs(void **state)
{
    (void)state;
    enum { POKES = 512, LEFT = POKES - ACTUATORS };
    static const double level[] = {1, 3, 10};
    experiment e;
    calibration c;
    open_experiment(&e, POKES, ACTUATORS, OUTPUTS, HADAMARD);
    random_truth(&e);
    measure(&e, 0);
    for (size_t i = 0; i < (size_t)POKES * OUTPUTS; i++)
        e.shape[i] += 1e-9 * level[i % OUTPUTS % 3] * draw_normal();
    run(&c, &e, NULL);
    const double sampling = 5 / sqrt(2.0 * LEFT);
    for (size_t i = 0; i < OUTPUTS; i++) {
        const double noise = 1e-9 * level[i % 3];
        const double share = NOISE_POKES * pow(c.noise / noise, 2) / (2 * LEFT);
        assert_near("noise of an output", calibration_output_noise(&c, &e.pokes, i), noise,
                    sampling + share);
        assert_near("error of an entry", calibration_entry_error(&c, &e.pokes, i, 2),
                    noise / (100 * sqrt(POKES)), sampling + share);
    }
    calibration_free(&c);
    close_experiment(&e);
}

/* Law: pokes that leave actuators open are refused without a model, with the count. */
static void test_too_few(void **state)
{
    (void)state;
    experiment e;
    calibration c;
    char error[SCENE_ERROR];
    open_experiment(&e, 5, ACTUATORS, OUTPUTS, RANDOM_SIGNS);
    random_truth(&e);
    measure(&e, 0);
    assert_int_equal(calibrate(&c, &e.pokes, NULL, error), -1);
    assert_non_null(strstr(error, "5 pokes tell 5 of 16 actuators apart"));
    calibration_free(&c);
    close_experiment(&e);
}

/* Law: a dead electrode is known by its column, and no other one is. */
static void test_dead_column(void **state)
{
    (void)state;
    experiment e;
    calibration c;
    open_experiment(&e, 32, ACTUATORS, OUTPUTS, HADAMARD);
    random_truth(&e);
    for (size_t i = 0; i < OUTPUTS; i++)
        e.truth[i * ACTUATORS + 5] = 0;
    measure(&e, 1e-3);
    run(&c, &e, NULL);
    for (size_t a = 0; a < ACTUATORS; a++)
        assert_int_equal(calibration_is_dead(&c, &e.pokes, a), a == 5);
    calibration_free(&c);
    close_experiment(&e);
}

/*
 * Law: with a model of independent errors, more pokes never harm, the error starts at that of the
 * model and ends at the noise floor; and what is told as standard error is made.
 */
static void test_with_model(void **state)
{
    (void)state;
    static const size_t counts[] = {1, 4, 8, 16, 64};
    double before = 1;
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        experiment e;
        calibration c;
        double model[OUTPUTS * ACTUATORS], made = 0, told = 0;
        random_state = 11;
        open_experiment(&e, counts[k], ACTUATORS, OUTPUTS, HADAMARD);
        random_truth(&e);
        for (size_t i = 0; i < OUTPUTS * ACTUATORS; i++)
            model[i] = e.truth[i] + 1e-9 * draw_normal();
        measure(&e, 1e-3);
        run(&c, &e, model);
        const double error = error_of(&e, c.influence);
        assert_true(error < before);
        before = error;
        for (size_t i = 0; i < OUTPUTS * ACTUATORS; i++) {
            made += pow(c.influence[i] - e.truth[i], 2);
            told += pow(c.error[i % ACTUATORS], 2);
        }
        /* Hadamard pokes are orthogonal: up to the number of actuators, noise cannot be told. */
        assert_int_equal(isnan(c.noise), counts[k] <= ACTUATORS);
        if (counts[k] == 4 || counts[k] == 8 || counts[k] == 64)
            assert_near("error", sqrt(made), sqrt(told), 0.2);
        calibration_free(&c);
        close_experiment(&e);
    }
    assert_true(before < 1e-3);
}

/* ---- drift and memory -------------------------------------------------- */

/* Add h B v_(k-1) to the shape of each poke k, and an offset and a drift to all outputs. */
static void disturb(experiment *e, double memory, double offset, double slope)
{
    const pokes *p = &e->pokes;
    for (size_t r = 0; r < p->count; r++)
        for (size_t i = 0; i < p->outputs; i++) {
            double *shape = &e->shape[r * p->outputs + i];
            *shape += (1 + 0.1 * (double)i) * (offset + slope * (double)r);
            for (size_t k = 0; k < p->actuators && r > 0; k++)
                *shape += memory * e->truth[i * p->actuators + k] *
                          e->voltage[(r - 1) * p->actuators + k];
        }
}

/*
 * Law: drift, offset and memory of pokes are found within five standard errors, the drift is taken
 * out, and the matrix is then as good as without drift. Of pokes with noise alone neither is found.
 * The standard errors told are those made, within their sampling errors; that of the matrix leaves
 * out the error of the drift, which in 64 pokes of 16 actuators adds at most a tenth.
 */
static void test_drift(void **state)
{
    (void)state;
    static const struct {
        double memory, offset, slope; /* offset and slope over the noise */
    } cases[] = {{0, 0, 0}, {0.03, 0, 0}, {0, 30, 0}, {0, 0, 2}, {-0.02, 5, -3}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int seed = 0; seed < 40; seed++) {
            experiment e;
            poke_drift drift;
            calibration c;
            double made = 0, told = 0, slopes = 0;
            double *steady = calloc(64 * OUTPUTS, sizeof *steady);
            assert_non_null(steady);
            open_experiment(&e, 64, ACTUATORS, OUTPUTS, RANDOM_SIGNS);
            random_truth(&e);
            const double sigma = measure(&e, 1e-3);
            disturb(&e, cases[k].memory, cases[k].offset * sigma, cases[k].slope * sigma);
            assert_int_equal(poke_drift_remove(&drift, &e.pokes, steady), 0);
            assert_true(drift.drifts == (cases[k].offset != 0 || cases[k].slope != 0));
            assert_true(drift.has_memory == (cases[k].memory != 0));
            assert_true(fabs(drift.memory - cases[k].memory) < 5 * drift.memory_error);
            for (size_t i = 0; i < OUTPUTS && drift.drifts; i++)
                slopes += pow(drift.slope[i] - (1 + 0.1 * (double)i) * cases[k].slope * sigma, 2) /
                          OUTPUTS;
            if (drift.drifts)
                assert_near("drift", sqrt(slopes), drift.drift_error, 5 / sqrt(2.0 * OUTPUTS));
            e.pokes.shape = steady;
            e.pokes.trends = drift.drifts ? drift.trends : 0;
            run(&c, &e, NULL);
            for (size_t i = 0; i < OUTPUTS * ACTUATORS; i++) {
                made += pow(c.influence[i] - e.truth[i], 2) / (OUTPUTS * ACTUATORS);
                told += pow(c.error[i % ACTUATORS], 2) / (OUTPUTS * ACTUATORS);
            }
            if (cases[k].memory == 0)
                assert_near("noise", c.noise, sigma, 5 / sqrt(2.0 * OUTPUTS * 46));
            if (cases[k].memory == 0)
                assert_near("error", sqrt(made), sqrt(told),
                            5 / sqrt(2.0 * OUTPUTS * ACTUATORS) + 0.1);
            calibration_free(&c);
            poke_drift_free(&drift);
            free(steady);
            close_experiment(&e);
        }
}

/*
 * Law: of 64 pokes of 16 actuators one reading that is off by 15 times the noise is named by
 * its shape and its output; noise, drift, memory and an output with ten times the noise are not.
 */
static void test_outliers(void **state)
{
    (void)state;
    for (int seed = 0; seed < 40; seed++) {
        experiment e;
        poke_outliers found;
        const size_t poke = (size_t)(seed * 7) % 64, output = (size_t)(seed * 5) % OUTPUTS;
        open_experiment(&e, 64, ACTUATORS, OUTPUTS, seed % 2 ? HADAMARD : RANDOM_SIGNS);
        random_truth(&e);
        const double sigma = measure(&e, 1e-3);
        disturb(&e, seed % 4 == 0 ? 0.03 : 0, 3 * sigma, -2 * sigma);
        for (size_t i = 0; i < 64; i++)
            e.shape[i * OUTPUTS + (output + 1) % OUTPUTS] += 10 * sigma * draw_normal();
        assert_int_equal(poke_outliers_find(&found, &e.pokes), 0);
        assert_int_equal(found.count, 0);
        e.shape[poke * OUTPUTS + output] += (seed % 4 == 0 ? 1000 : 15) * sigma;
        assert_int_equal(poke_outliers_find(&found, &e.pokes), 0);
        assert_int_equal(found.count, 1);
        assert_int_equal(found.outlier[0].poke, poke);
        assert_int_equal(found.outlier[0].output, output);
        close_experiment(&e);
    }
}

/*
 * Law: of as many pokes as actuators, where no residual is left, a reading 1000 times too large is
 * named; where every actuator moves its own output alone, none is.
 */
static void test_large_readings(void **state)
{
    static const excitation types[] = {ONE_BY_ONE, HADAMARD};
    (void)state;
    for (int k = 0; k < 2; k++) {
        experiment e;
        poke_outliers found;
        open_experiment(&e, ACTUATORS, ACTUATORS, OUTPUTS, types[k]);
        random_truth(&e);
        measure(&e, 1e-3);
        assert_int_equal(poke_outliers_find(&found, &e.pokes), 0);
        assert_int_equal(found.count, 0);
        double *reading = e.shape + 3 * OUTPUTS + 5;
        *reading = 1000 * fmax(fabs(*reading), 1e-6);
        assert_int_equal(poke_outliers_find(&found, &e.pokes), 0);
        assert_int_equal(found.count, 1);
        assert_true(found.outlier[0].is_size);
        assert_int_equal(found.outlier[0].poke, 3);
        assert_int_equal(found.outlier[0].output, 5);
        memset(e.truth, 0, OUTPUTS * ACTUATORS * sizeof *e.truth);
        for (size_t i = 0; i < ACTUATORS; i++)
            e.truth[i * ACTUATORS + i] = 1e-6;
        measure(&e, 1e-6);
        assert_int_equal(poke_outliers_find(&found, &e.pokes), 0);
        assert_int_equal(found.count, 0);
        close_experiment(&e);
    }
}

/* Law: of as many pokes as actuators nothing is known of drift, and the shapes are kept. */
static void test_no_drift_known(void **state)
{
    (void)state;
    experiment e;
    poke_drift drift;
    double steady[ACTUATORS * OUTPUTS];
    open_experiment(&e, ACTUATORS, ACTUATORS, OUTPUTS, HADAMARD);
    random_truth(&e);
    measure(&e, 1e-3);
    assert_int_equal(poke_drift_remove(&drift, &e.pokes, steady), 0);
    assert_true(isnan(drift.drift) && isnan(drift.memory) && !drift.drifts && !drift.has_memory);
    assert_memory_equal(steady, e.shape, sizeof steady);
    poke_drift_free(&drift);
    close_experiment(&e);
}

/* ---- cross-talk --------------------------------------------------------- */

/*
 * Law: an amplifier that also acts on another electrode is named with the part of its voltage;
 * errors of single entries and wrong gains are not called cross-talk.
 */
static void test_crosstalk(void **state)
{
    (void)state;
    for (int seed = 0; seed < 40; seed++) {
        experiment e;
        calibration c;
        crosstalk found[WIRING_FAULTS];
        double model[OUTPUTS * ACTUATORS];
        const double part = seed % 2 ? 0.05 : 0;
        /* errors of the model over the norm of a column of uniform entries up to 1e-8 */
        const double doubt = 1e-11 / (1e-8 * sqrt(OUTPUTS / 3.0));
        open_experiment(&e, 64, ACTUATORS, OUTPUTS, RANDOM_SIGNS);
        random_truth(&e);
        for (size_t i = 0; i < OUTPUTS * ACTUATORS; i++)
            model[i] = e.truth[i] + 1e-11 * draw_normal();
        for (size_t i = 0; i < OUTPUTS; i++) {
            e.truth[i * ACTUATORS + 7] *= 0.8;
            e.truth[i * ACTUATORS + 3] += part * e.truth[i * ACTUATORS + 11];
        }
        measure(&e, 1e-3);
        run(&c, &e, model);
        assert_int_equal(crosstalk_find(found, &c, &e.pokes, model), part > 0);
        if (part > 0) {
            assert_int_equal(found[0].actuator, 3);
            assert_int_equal(found[0].other, 11);
            assert_true(fabs(found[0].part - part) < 5 * (found[0].error + doubt));
        }
        calibration_free(&c);
        close_experiment(&e);
    }
}

/* ---- a scene as the model ---------------------------------------------- */

#define COARSE                                                                                     \
    "element=improved;mesh.theta1.elements=5;mesh.theta2.elements=5;"                              \
    "limits={voltage: [-600, 600]};"
#define SOFTER                                                                                     \
    "materials.AS4/3501={E1: 129.807e9, E2: 8.685e9, E3: 8.685e9, G12: 3.726e9, G13: 3.726e9, "    \
    "G23: 3.105e9, nu12: 0.3, nu13: 0.3, nu23: 0.3};"                                              \
    "materials.G1195={E: 63e9, nu: 0.3, d31: 304.8e-12, d32: 304.8e-12}"

/* The pokes of a plate whose laminate is 10 % softer and whose d31 is 20 % larger than the scene's.
 */
static void open_plate(experiment *e, scene_run *nominal, size_t count, excitation type)
{
    scene_run true_plate;
    open_run(nominal, "plate-50-patches", COARSE);
    open_run(&true_plate, "plate-50-patches", COARSE SOFTER);
    if (analysis_influence(&nominal->analysis, nominal->error) < 0 ||
        analysis_influence(&true_plate.analysis, true_plate.error) < 0)
        fail_msg("%s%s", nominal->error, true_plate.error);
    const design *d = &true_plate.analysis.design;
    open_experiment(e, count, (size_t)d->amplifiers, (size_t)d->targets, type);
    for (int i = 0; i < d->targets; i++)
        for (int k = 0; k < d->amplifiers; k++)
            e->truth[i * d->amplifiers + k] =
                true_plate.analysis.influence[i * d->structure.input.count + k];
    scene_run_close(&true_plate);
}

static void fit_model(calibration_model *model, const scene_run *nominal, const experiment *e)
{
    char error[SCENE_ERROR];
    if (calibration_model_fit(model, &nominal->scene, &e->pokes, error) < 0)
        fail_msg("%s", error);
}

/* Root mean square of the measured shapes over that of the shapes under the voltages of a matrix.
 */
static double size_over(const pokes *p, const double *influence, size_t stride)
{
    double measured = 0, predicted = 0;
    for (size_t poke = 0; poke < p->count; poke++)
        for (size_t i = 0; i < p->outputs; i++) {
            double shape = 0;
            for (size_t k = 0; k < p->actuators; k++)
                shape += influence[i * stride + k] * p->voltage[poke * p->actuators + k];
            predicted += shape * shape;
            measured += pow(p->shape[poke * p->outputs + i], 2);
        }
    return sqrt(measured / predicted);
}

/*
 * Law: four random pokes of 25 actuators with 1e-3 of noise bring the error of the influence from
 * about 20 % to below 1 %, by the factors of the materials.
 */
static void test_few_pokes(void **state)
{
    (void)state;
    experiment e;
    scene_run nominal;
    calibration_model model;
    calibration c;
    random_state = 3;
    open_plate(&e, &nominal, 4, RANDOM_SIGNS);
    measure(&e, 1e-3);
    fit_model(&model, &nominal, &e);
    pokes acting = e.pokes;
    acting.voltage = model.voltage;
    char error[SCENE_ERROR];
    assert_int_equal(calibrate(&c, &acting, model.influence, error), 0);
    const double *b0 = nominal.analysis.influence;
    double apart = 0, size = 0;
    const size_t stride = nominal.analysis.design.structure.input.count;
    assert_near("size of the shapes", model.size, size_over(&e.pokes, b0, stride), 1e-9);
    assert_true(!calibration_is_idle(&e.pokes, 0));
    for (size_t i = 0; i < e.pokes.outputs; i++)
        for (size_t k = 0; k < e.pokes.actuators; k++) {
            const double truth = e.truth[i * e.pokes.actuators + k];
            apart += pow(b0[i * nominal.analysis.design.structure.input.count + k] - truth, 2);
            size += truth * truth;
        }
    const double before = sqrt(apart / size), fitted = error_of(&e, model.influence),
                 after = error_of(&e, c.influence);
    print_message("influence error: scene %.4f, factors fitted %.5f, calibrated %.5f\n", before,
                  fitted, after);
    assert_int_equal(model.faults, 0);
    assert_true(before > 0.15);
    assert_true(fitted < 0.01);
    assert_true(after < 0.01);
    calibration_free(&c);
    calibration_model_free(&model);
    scene_run_close(&nominal);
    close_experiment(&e);
}

/* Exchange two columns of the truth, as swapped cables do; or clear one. */
static void swap_columns(experiment *e, size_t a, size_t b)
{
    for (size_t i = 0; i < e->pokes.outputs; i++) {
        double *row = e->truth + i * e->pokes.actuators;
        const double kept = row[a];
        row[a] = row[b];
        row[b] = kept;
    }
}

static void scale_column(experiment *e, size_t a, double factor)
{
    for (size_t i = 0; i < e->pokes.outputs; i++)
        e->truth[i * e->pokes.actuators + a] *= factor;
}

static bool has_fault(const calibration_model *model, wiring_fault_type type, size_t a, size_t b)
{
    for (int f = 0; f < model->faults; f++)
        if (model->fault[f].type == type && model->fault[f].actuator == a &&
            model->fault[f].other == b)
            return true;
    return false;
}

/*
 * Law: a dead electrode, a reversed wire and two swapped cables are named, and nothing else; the
 * matrix as it is wired is then right to 1 %.
 */
static void test_faults(void **state)
{
    (void)state;
    static const struct {
        size_t count;
        excitation type;
    } runs[] = {{8, RANDOM_SIGNS}, {25, ONE_BY_ONE}};
    for (int k = 0; k < 2; k++) {
        experiment e;
        scene_run nominal;
        calibration_model model;
        random_state = 21;
        open_plate(&e, &nominal, runs[k].count, runs[k].type);
        swap_columns(&e, 2, 17);
        scale_column(&e, 8, 0);
        scale_column(&e, 13, -1);
        measure(&e, 1e-3);
        fit_model(&model, &nominal, &e);
        assert_int_equal(model.faults, 3);
        assert_true(has_fault(&model, WIRING_SWAPPED, 2, 17));
        assert_true(has_fault(&model, WIRING_DEAD, 8, 8));
        assert_true(has_fault(&model, WIRING_REVERSED, 13, 13));
        double none[25] = {0};
        wiring_matrix(model.fault, model.faults, &e.pokes, model.influence, none);
        assert_true(error_of(&e, model.influence) < 0.01);
        calibration_model_free(&model);
        scene_run_close(&nominal);
        close_experiment(&e);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact),
        cmocka_unit_test(test_noise_floor),
        cmocka_unit_test(test_noise_of_outputs),
        cmocka_unit_test(test_too_few),
        cmocka_unit_test(test_dead_column),
        cmocka_unit_test(test_with_model),
        cmocka_unit_test(test_few_pokes),
        cmocka_unit_test(test_faults),
        cmocka_unit_test(test_drift),
        cmocka_unit_test(test_outliers),
        cmocka_unit_test(test_large_readings),
        cmocka_unit_test(test_no_drift_known),
        cmocka_unit_test(test_crosstalk),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
