/*
 * Calibration on the device: recursive least squares against those of the host, forgetting and its
 * bounds, a million records of every bad kind, inputs that never move, test voltages inside all
 * limits, and a controller with the new matrix.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/bridge.h"

enum { MOST_INPUTS = 16, MOST_OUTPUTS = 24, MOST_RECORDS = 96 };

#include "../rigs/problem_rig.h"

#define EPSILON ((double)PZS_EPSILON)
#ifndef RECORDS
#define RECORDS                                                                                    \
    30000 /* number of records of every kind in test_million; a million with `make check-long` */
#endif

typedef struct rig {
    unsigned seed;
    uint16_t inputs, outputs;
    problem_rig problem;
    double truth[MOST_OUTPUTS * MOST_INPUTS];
    pzs_calibration calibration;
    double work[(PZS_CALIBRATION_BYTES(MOST_INPUTS, MOST_OUTPUTS) + 7) / 8];
    /* voltages (V) and readings (m) of the last record */
    pzs_real voltage[MOST_INPUTS], reading[MOST_OUTPUTS];
    /*
     * influence matrix (m/V) and spreads of its columns (1/V) from the last pzs_calibration_solve
     */
    pzs_real found[MOST_OUTPUTS * MOST_INPUTS], spread[MOST_INPUTS];
} rig;

static void start(rig *r)
{
    problem_seal(&r->problem);
    assert_int_equal(pzs_calibration_init(&r->calibration, &r->problem.tables, NULL, NULL, r->work,
                                          sizeof r->work),
                     PZS_OK);
}

static void open_rig(rig *r, unsigned seed, uint16_t inputs, uint16_t outputs)
{
    memset(r, 0, sizeof *r);
    r->seed = seed;
    r->inputs = inputs;
    r->outputs = outputs;
    problem_open(&r->problem, inputs, outputs, -100, 100, 8);
    for (int i = 0; i < outputs * inputs; i++) {
        r->problem.influence[i] = (pzs_real)uniform(&r->seed, -1e-6, 1e-6);
        r->truth[i] = uniform(&r->seed, -1e-6, 1e-6);
    }
    start(r);
}

/* Normal number by the sum of twelve uniform ones. */
static double normal(unsigned *seed)
{
    double sum = -6;
    for (int i = 0; i < 12; i++)
        sum += uniform(seed, 0, 1);
    return sum;
}

/* Compute the readings that belong to the voltages of the next record, with noise. */
static void measure(rig *r, double noise)
{
    for (int i = 0; i < r->outputs; i++) {
        double sum = noise * normal(&r->seed);
        for (int k = 0; k < r->inputs; k++)
            sum += r->truth[i * r->inputs + k] * (double)r->voltage[k];
        r->reading[i] = (pzs_real)sum;
    }
}

static pzs_status record(rig *r)
{
    return pzs_calibration_record(&r->calibration, r->voltage, r->reading);
}

static void draw_voltages(rig *r, double most)
{
    for (int k = 0; k < r->inputs; k++)
        r->voltage[k] = (pzs_real)uniform(&r->seed, -most, most);
}

static pzs_status solve(rig *r)
{
    return pzs_calibration_solve(&r->calibration, r->found, r->spread);
}

/*
 * Largest difference of the computed influence matrix from another one, relative to the largest
 * entry of the other one.
 */
static double apart(const rig *r, const double *other)
{
    double most = 0, size = 0;
    for (int i = 0; i < r->outputs * r->inputs; i++) {
        most = fmax(most, fabs((double)r->found[i] - other[i]));
        size = fmax(size, fabs(other[i]));
    }
    return most / size;
}

/* Entry of the triangular factor of a calibration (V). */
static double factor(const rig *r, int row, int column)
{
    const size_t width = (size_t)r->inputs + r->outputs;
    return (double)r->calibration.state.factor[(size_t)row * width + (size_t)column];
}

/*
 * Compute the information matrix [inputs][inputs]: the product of the transposed triangular factor
 * and the factor (V2).
 */
static void information(const rig *r, double *matrix)
{
    for (int i = 0; i < r->inputs; i++)
        for (int j = 0; j < r->inputs; j++) {
            matrix[i * r->inputs + j] = 0;
            for (int k = 0; k <= i && k <= j; k++)
                matrix[i * r->inputs + j] += factor(r, k, i) * factor(r, k, j);
        }
}

/* ---- against the host --------------------------------------------------- */

/*
 * Law: without forgetting, matrix, noise and standard errors are those of the host's least squares
 * for the same records. The voltages of random records have condition numbers below 8; each record
 * adds a rounding error of epsilon in each of the rotations, so that the difference is of the size
 * of epsilon times the condition number times the square root of the number of records.
 */
static void test_host(void **state)
{
    static const int count[] = {12, 13, 40, MOST_RECORDS};
    (void)state;
    for (int trial = 0; trial < 4; trial++) {
        static rig r;
        static double voltage[MOST_RECORDS * MOST_INPUTS], shape[MOST_RECORDS * MOST_OUTPUTS],
            influence[MOST_OUTPUTS * MOST_INPUTS], error[MOST_INPUTS];
        const int records = count[trial];
        open_rig(&r, 3u + (unsigned)trial, 12, 20);
        for (int record_index = 0; record_index < records; record_index++) {
            draw_voltages(&r, 100);
            if (record_index < 12) /* The addition makes the voltages well-conditioned, also where
                                      there are only as many records as inputs. */
                r.voltage[record_index] += 300;
            measure(&r, 1e-7);
            assert_int_equal(record(&r), PZS_OK);
            for (int k = 0; k < 12; k++)
                voltage[record_index * 12 + k] = (double)r.voltage[k];
            for (int i = 0; i < 20; i++)
                shape[record_index * 20 + i] = (double)r.reading[i];
        }
        const double noise =
            bridge_calibrate((size_t)records, 12, 20, voltage, shape, influence, error);
        const double tolerance = 2 * EPSILON * 8 * sqrt(records);
        assert_int_equal(solve(&r), PZS_OK);
        assert_true(apart(&r, influence) < tolerance);
        assert_int_equal(r.calibration.info.records, records);
        if (records == 12) {
            assert_true(isnan(noise) && r.calibration.info.noise[0] == 0);
            continue;
        }
        double squares = 0;
        for (int i = 0; i < 20; i++)
            squares += (double)r.calibration.info.noise[i] / 20;
        /*
         * The residuals of 1e-7 are differences of readings of 1e-4, whose rounding errors are
         * larger by 1e3.
         */
        assert_true(fabs(sqrt(squares) / noise - 1) < 1e3 * tolerance);
        for (int k = 0; k < 12; k++)
            assert_true(fabs((double)r.spread[k] * noise / error[k] - 1) < tolerance);
    }
}

/*
 * Law: the errors made are the standard errors told. Over 50 calibrations of 288 entries the root
 * mean square of their ratio is 1 within four standard deviations of its sampling error,
 * 4/sqrt(2 14400); the noise has 28 degrees of freedom for each output.
 */
static void test_standard_errors(void **state)
{
    enum { RUNS = 50 };
    double squares = 0, noise = 0;
    (void)state;
    for (unsigned seed = 0; seed < RUNS; seed++) {
        static rig r;
        open_rig(&r, 100 + seed, 12, 24);
        for (int i = 0; i < 40; i++) {
            draw_voltages(&r, 100);
            measure(&r, 2e-6);
            assert_int_equal(record(&r), PZS_OK);
        }
        assert_int_equal(solve(&r), PZS_OK);
        for (int i = 0; i < 24; i++) {
            noise += (double)r.calibration.info.noise[i] / (24 * RUNS);
            for (int k = 0; k < 12; k++)
                squares += pow(((double)r.found[i * 12 + k] - r.truth[i * 12 + k]) /
                                   ((double)r.spread[k] * 2e-6),
                               2) /
                           (24 * 12 * RUNS);
        }
    }
    assert_true(fabs(sqrt(squares) - 1) < 4 / sqrt(2.0 * 24 * 12 * RUNS));
    assert_true(fabs(sqrt(noise) / 2e-6 - 1) < 4 / sqrt(2.0 * 24 * 28 * RUNS));
}

/* ---- forgetting --------------------------------------------------------- */

/*
 * Draw voltages of one of the kinds in which a controller may leave a calibration: varied, tiny,
 * constant, zero, one input alone.
 */
static void draw_kind(rig *r, int kind)
{
    const int input = (int)uniform(&r->seed, 0, r->inputs);
    switch (kind) {
    case 0: draw_voltages(r, 100); break;
    case 1: draw_voltages(r, 1e-3); break;
    case 2: break; /* The voltages of the last record are used again. */
    case 3: memset(r->voltage, 0, sizeof r->voltage); break;
    case 4:
        memset(r->voltage, 0, sizeof r->voltage);
        r->voltage[input] = 50;
        break;
    default: draw_voltages(r, 10); r->voltage[input] = 100;
    }
}

/*
 * Law: with forgetting, the information matrix I becomes I - f (Iv)(Iv)'/(v'Iv) + v v' with
 * f = min(1/memory, |v|^4/(v'Iv)); its determinant never decreases, and no diagonal entry exceeds
 * the larger one of its former value and V^2 memory, with V the largest norm of voltages.
 */
static void test_directional(void **state)
{
    enum { N = 5, STEPS = 2000 };
    static rig r;
    double before[N * N], after[N * N], determinant = 0, norm = 0;
    (void)state;
    open_rig(&r, 7, N, 3);
    r.calibration.settings.memory = 20;
    for (int step = 0; step < STEPS; step++) {
        double image[N] = {0}, size = 0, strength = 0, product = 1;
        draw_kind(&r, step < N ? 4 : (int)uniform(&r.seed, 0, 6));
        if (step < N) {
            memset(r.voltage, 0, sizeof r.voltage);
            r.voltage[step] = 70;
        }
        measure(&r, 1e-7);
        information(&r, before);
        assert_int_equal(record(&r), PZS_OK);
        information(&r, after);
        for (int i = 0; i < N; i++) {
            size += pow((double)r.voltage[i], 2);
            for (int j = 0; j < N; j++)
                image[i] += before[i * N + j] * (double)r.voltage[j];
            strength += image[i] * (double)r.voltage[i];
            product *= pow(factor(&r, i, i), 2);
        }
        norm = fmax(norm, size);
        const double part = strength > 0 ? fmin(1 / 20.0, size * size / strength) : 0;
        for (int i = 0; i < N; i++) {
            assert_true(after[i * N + i] <= norm * 20 * (1 + 100 * EPSILON));
            for (int j = 0; j < N && strength > 0; j++) {
                const double wanted = before[i * N + j] - part * image[i] * image[j] / strength +
                                      (double)r.voltage[i] * (double)r.voltage[j];
                assert_true(fabs(after[i * N + j] - wanted) < 64 * EPSILON * norm * 20);
            }
        }
        if (step >= N) /* Each of the 3 N rotations may change the determinant by a few machine
                          epsilons. */
            assert_true(product >= determinant * (1 - 64 * N * EPSILON));
        determinant = product;
    }
}

/*
 * Law: pokes of one input after the other are forgotten by the factor 1 - 1/memory with each poke
 * of the same input, so that the matrix is the exponentially weighted mean of its pokes.
 */
static void test_memory(void **state)
{
    enum { N = 4, POKES = 60 };
    static rig r;
    const double kept = 1 - 1 / 10.0;
    double mean[3 * N] = {0}, sum = 0;
    (void)state;
    open_rig(&r, 9, N, 3);
    r.calibration.settings.memory = 10;
    for (int poke = 0; poke < POKES; poke++) {
        if (poke == POKES / 2)
            for (int i = 0; i < 3 * N; i++)
                r.truth[i] *= 2;
        sum = kept * sum + 1;
        for (int i = 0; i < 3 * N; i++)
            mean[i] += (r.truth[i] - mean[i]) / sum;
        for (int k = 0; k < N; k++) {
            memset(r.voltage, 0, sizeof r.voltage);
            r.voltage[k] = 64;
            measure(&r, 0);
            assert_int_equal(record(&r), PZS_OK);
        }
        assert_int_equal(solve(&r), PZS_OK);
        assert_true(apart(&r, mean) < 16 * EPSILON * sqrt(poke + 1));
    }
}

/* ---- attacks -------------------------------------------------------------- */

/* Return a reading that is no measurement: missing, infinite or absurdly large (m). */
static pzs_real absurd(unsigned *seed)
{
    const pzs_real value[] = {(pzs_real)NAN, (pzs_real)INFINITY, PZS_BY_BITS(1e38f, 1e300),
                              PZS_R(-1e12), 1};
    return value[(int)uniform(seed, 0, 5)];
}

/*
 * Law: a million records of every kind (useful ones, constant ones, zeros, a tiny dither, missing
 * and absurd readings) leave the factor finite with positive pivots; the input that never moved
 * keeps its column, bit for bit; and the other columns are known to what the noise allows.
 */
static void test_million(void **state)
{
    enum { N = 4, STILL = 2 };
    static rig r;
    uint32_t ignored = 0;
    (void)state;
    open_rig(&r, 11, N, 2);
    r.calibration.settings.memory = 50;
    r.calibration.settings.reading_limit = PZS_R(1e-3);
    for (int step = 0; step < RECORDS; step++) {
        draw_kind(&r, step < 100 ? 0 : step / 1000 % 6);
        r.voltage[STILL] = 0;
        measure(&r, 1e-8);
        const bool is_absurd = step % 7 == 3;
        if (is_absurd)
            r.reading[step % 2] = absurd(&r.seed);
        const pzs_status status = record(&r);
        ignored += is_absurd;
        assert_int_equal(status, is_absurd ? PZS_W_SENSOR : PZS_OK);
        for (int k = 0; k < N; k++)
            assert_true(fabs(factor(&r, k, k)) < HUGE_VAL &&
                        (k == STILL || step < 100 || fabs(factor(&r, k, k)) > 1));
    }
    assert_int_equal(r.calibration.info.records, RECORDS - ignored);
    assert_int_equal(solve(&r), PZS_W_UNOBSERVABLE);
    assert_int_equal(r.calibration.info.where, STILL);
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < N; k++) {
            const double value = (double)r.found[i * N + k], error = value - r.truth[i * N + k];
            if (k == STILL)
                assert_true(r.found[i * N + k] == r.problem.influence[i * N + k]);
            else
                assert_true(fabs(error) < 6e-8 * (double)r.spread[k] + 2e4 * EPSILON * 1e-6);
        }
    assert_true(isinf(r.spread[STILL]) && isfinite(r.spread[0]));
}

/*
 * Law: readings as large as squares allow leave the covariance untouched, and are forgotten like
 * all others; larger ones are refused and change nothing.
 */
static void test_huge(void **state)
{
    enum { N = 3 };
    static rig r, copy;
    (void)state;
    open_rig(&r, 13, N, 2);
    r.calibration.settings.memory = 4;
    for (int step = 0; step < 3000; step++) {
        draw_voltages(&r, 100);
        measure(&r, 0);
        if (step == 100)
            r.reading[0] = PZS_BY_BITS(1e13f, 1e25);
        assert_int_equal(record(&r), PZS_OK);
    }
    assert_int_equal(solve(&r), PZS_OK);
    assert_true(apart(&r, r.truth) < 256 * EPSILON);
    copy = r;
    r.reading[0] = PZS_BY_BITS(1e16f, 1e160);
    assert_int_equal(record(&r), PZS_E_NONFINITE);
    assert_int_equal(solve(&r), PZS_OK);
    assert_memory_equal(r.found, copy.found, sizeof r.found);
    assert_memory_equal(r.spread, copy.spread, sizeof r.spread);
    r.voltage[1] = PZS_BY_BITS(1e30f, 1e200);
    r.reading[0] = 0;
    assert_int_equal(record(&r), PZS_E_NONFINITE);
    r.voltage[1] = (pzs_real)NAN;
    assert_int_equal(record(&r), PZS_E_NONFINITE);
    assert_int_equal(r.calibration.info.where, 1);
    assert_int_equal(solve(&r), PZS_OK);
    assert_memory_equal(r.found, copy.found, sizeof r.found);
    assert_int_equal(r.calibration.info.records, 3000);
}

/*
 * Law: of two inputs that always move together only the sum of their effects is known: both
 * standard errors are infinite, the later one keeps its column, and the sum is right. An output
 * that is ignored keeps its row, whatever it reads.
 */
static void test_together(void **state)
{
    enum { N = 4, M = 3 };
    static rig r;
    static const uint8_t ignored[M] = {0, 1, 0};
    (void)state;
    open_rig(&r, 17, N, M);
    r.calibration.settings.ignored = ignored;
    for (int step = 0; step < 400; step++) {
        draw_voltages(&r, 100);
        r.voltage[3] = r.voltage[1];
        measure(&r, 0);
        r.reading[1] = (pzs_real)NAN;
        assert_int_equal(record(&r), PZS_OK);
    }
    assert_int_equal(solve(&r), PZS_W_UNOBSERVABLE);
    assert_int_equal(r.calibration.info.where, 3);
    assert_true(isinf(r.spread[1]) && isinf(r.spread[3]));
    assert_true(isfinite(r.spread[0]) && isfinite(r.spread[2]));
    assert_memory_equal(r.found + N, r.problem.influence + N, N * sizeof *r.found);
    for (int i = 0; i < M; i += 2) {
        const double sum = (double)r.found[i * N + 1] + (double)r.found[i * N + 3],
                     wanted = r.truth[i * N + 1] + r.truth[i * N + 3];
        assert_true(fabs(sum - wanted) < 1e-6 * 400 * EPSILON);
        assert_true(r.found[i * N + 3] == r.problem.influence[i * N + 3]);
    }
}

/*
 * Law: inputs that moved together, or not at all, and later on their own, are known as well as the
 * host's least squares know them, in whatever order they come. Until then the third input has the
 * least-squares result for the others together.
 */
static void test_late(void **state)
{
    enum { N = 5, M = 2, TOGETHER = 40, RECORDS_OF_ALL = 80 };
    (void)state;
    for (int first = 0; first < N; first++) {
        static rig r;
        static double voltage[RECORDS_OF_ALL * N], shape[RECORDS_OF_ALL * M], influence[M * N],
            error[N];
        const int second = (first + 2) % N, still = (first + 1) % N, third = (first + 3) % N;
        open_rig(&r, 31 + (unsigned)first, N, M);
        for (int step = 0; step < RECORDS_OF_ALL; step++) {
            draw_voltages(&r, 100);
            if (step < TOGETHER) {
                r.voltage[second] = r.voltage[first];
                r.voltage[still] = 0;
            }
            measure(&r, 1e-8);
            assert_int_equal(record(&r), PZS_OK);
            for (int k = 0; k < N; k++)
                voltage[step * N + k] = (double)r.voltage[k];
            for (int i = 0; i < M; i++)
                shape[step * M + i] = (double)r.reading[i];
            if (step + 1 == TOGETHER) {
                assert_int_equal(solve(&r), PZS_W_UNOBSERVABLE);
                assert_true(isinf(r.spread[first]) && isinf(r.spread[second]));
                assert_true(isinf(r.spread[still]) && isfinite(r.spread[third]));
                for (int i = 0; i < M; i++)
                    assert_true(fabs((double)r.found[i * N + third] - r.truth[i * N + third]) <
                                6e-8 * (double)r.spread[third] + 1e-6 * 64 * EPSILON);
            }
        }
        assert_true(bridge_calibrate(RECORDS_OF_ALL, N, M, voltage, shape, influence, error) > 0);
        assert_int_equal(solve(&r), PZS_OK);
        assert_true(apart(&r, influence) < 2 * EPSILON * 8 * sqrt(RECORDS_OF_ALL));
    }
}

/* ---- test voltages --------------------------------------------------------- */

/*
 * Law: with any limits, step limits and voltages at the start, every test voltage is finite, inside
 * its limits and within its step limit of the one before.
 */
static void test_inside(void **state)
{
    (void)state;
    for (unsigned seed = 0; seed < 200; seed++) {
        static rig r;
        pzs_real at[MOST_INPUTS], given[MOST_INPUTS];
        open_rig(&r, 1000 + seed, (uint16_t)(1 + seed % MOST_INPUTS), 2);
        for (int k = 0; k < r.inputs; k++) {
            const double low = uniform(&r.seed, -300, 300), range = uniform(&r.seed, -50, 400);
            r.problem.lower[k] = (pzs_real)low;
            r.problem.upper[k] = (pzs_real)(low + fmax(range, 0));
            r.problem.step_limit[k] = (pzs_real)fmax(uniform(&r.seed, -5, 60), 0);
            at[k] = (pzs_real)uniform(&r.seed, -400, 400);
        }
        assert_int_equal(pzs_problem_seal(&r.problem.tables), PZS_OK);
        assert_int_equal(pzs_calibration_init(&r.calibration, &r.problem.tables, NULL, at, r.work,
                                              sizeof r.work),
                         PZS_OK);
        r.calibration.settings.amplitude = (pzs_real)uniform(&r.seed, 0.01, 1);
        memcpy(given, r.calibration.info.voltage, r.inputs * sizeof *given);
        for (int tick = 0; tick < 300; tick++) {
            assert_int_equal(pzs_calibration_excite(&r.calibration), PZS_OK);
            for (int k = 0; k < r.inputs; k++) {
                const pzs_real v = r.calibration.info.voltage[k];
                assert_true(isfinite(v) && v >= r.problem.lower[k] && v <= r.problem.upper[k]);
                assert_true((v < given[k] ? given[k] - v : v - given[k]) <=
                            r.problem.step_limit[k]);
                given[k] = v;
            }
        }
    }
}

/*
 * Law: test voltages keep limits between inputs, here of the differences of neighbours, and settle
 * where these limits stop them; the records still determine the matrix.
 */
static void test_limit_rows(void **state)
{
    enum { N = 5, ROWS = N - 1 };
    static rig r;
    static const pzs_real low[ROWS] = {-30, -30, -30, -30}, high[ROWS] = {30, 30, 30, 30},
                          safe[N] = {0};
    uint32_t start_of[ROWS + 1] = {0};
    uint16_t input[2 * ROWS];
    pzs_real value[2 * ROWS];
    (void)state;
    for (int row = 0; row < ROWS; row++) {
        start_of[row + 1] = 2 * (uint32_t)row + 2;
        input[2 * row] = (uint16_t)row;
        input[2 * row + 1] = (uint16_t)(row + 1);
        value[2 * row] = 1;
        value[2 * row + 1] = -1;
    }
    const pzs_limit_rows rows = {.call = &pzs_limit_rows_calls,
                                 .sums = {ROWS, start_of, input, value},
                                 .lower = low,
                                 .upper = high,
                                 .safe = safe};
    open_rig(&r, 37, N, 3);
    r.problem.tables.limit_rows = &rows;
    start(&r);
    for (int tick = 0; r.calibration.info.records < 2 * r.calibration.info.period; tick++) {
        assert_true(tick < 2000);
        if (r.calibration.info.is_settled) {
            memcpy(r.voltage, r.calibration.info.voltage, N * sizeof *r.voltage);
            measure(&r, 0);
            assert_int_equal(record(&r), PZS_OK);
        }
        assert_int_equal(pzs_calibration_excite(&r.calibration), PZS_OK);
        for (int k = 0; k < ROWS; k++) {
            const pzs_real *voltage = r.calibration.info.voltage;
            assert_true(fabs((double)voltage[k] - (double)voltage[k + 1]) <= 30);
        }
    }
    assert_int_equal(solve(&r), PZS_OK);
    assert_true(apart(&r, r.truth) < 64 * EPSILON);
}

/*
 * Law: the test voltages of a period are orthogonal to each other and to a constant, so that a
 * period determines the matrix in spite of an unknown constant shape. Readings count after the
 * voltages have been constant for the ticks asked for.
 */
static void test_patterns(void **state)
{
    enum { N = 11, M = 5 };
    static rig r;
    double gram[N + 1][N + 1] = {{0}};
    pzs_real given[N] = {0};
    uint32_t constant = 0, count = 0;
    (void)state;
    open_rig(&r, 19, N, M);
    assert_int_equal(r.calibration.info.period, 16);
    for (int tick = 0; count < 16; tick++) {
        assert_true(tick < 1000);
        if (r.calibration.info.is_settled) {
            double extended[N + 1];
            assert_true(constant >= r.calibration.settings.settle);
            memcpy(r.voltage, r.calibration.info.voltage, sizeof given);
            measure(&r, 0);
            for (int i = 0; i < M; i++)
                r.reading[i] += PZS_R(3e-4);
            assert_int_equal(record(&r), PZS_OK);
            for (int k = 0; k <= N; k++)
                extended[k] = k < N ? (double)r.voltage[k] : 1;
            for (int i = 0; i <= N; i++)
                for (int k = 0; k <= N; k++)
                    gram[i][k] += extended[i] * extended[k];
            count++;
        }
        assert_int_equal(pzs_calibration_excite(&r.calibration), PZS_OK);
        const bool moved = memcmp(given, r.calibration.info.voltage, sizeof given) != 0;
        constant = moved ? 0 : constant + 1;
        memcpy(given, r.calibration.info.voltage, sizeof given);
    }
    for (int i = 0; i <= N; i++)
        for (int k = 0; k < i; k++)
            assert_true(gram[i][k] == 0);
    assert_true(gram[0][0] == 16 * 25.0 * 25.0);
    assert_int_equal(solve(&r), PZS_OK);
    assert_true(apart(&r, r.truth) < 3e-4 / (25 * 1e-6) * 64 * EPSILON);
}

/*
 * Law: a test voltage reaches its whole amplitude before it counts as settled, also where its step
 * limit is smaller than the change that counts as rest.
 */
static void test_slow(void **state)
{
    static rig r;
    (void)state;
    open_rig(&r, 23, 2, 1); /* limits of -100 V and 100 V, test voltages of 25 V */
    for (int k = 0; k < r.inputs; k++)
        r.problem.step_limit[k] = PZS_R(4e-3);
    assert_int_equal(pzs_problem_seal(&r.problem.tables), PZS_OK);
    start(&r);
    for (int tick = 0; !r.calibration.info.is_settled; tick++) {
        assert_true(tick < 10000);
        assert_int_equal(pzs_calibration_excite(&r.calibration), PZS_OK);
    }
    for (int k = 0; k < r.inputs; k++)
        assert_true(fabs(fabs((double)r.calibration.info.voltage[k]) - 25) < 0.25);
}

/* ---- use, and wrong calls -------------------------------------------------- */

/*
 * Law: a controller with the calibrated influence matrix knows the structure: without limits in
 * force, its first tick reaches a shape that the structure can have.
 */
static void test_control(void **state)
{
    enum { N = 6, M = 20 };
    static rig r;
    static double work[(PZS_CONTROL_BYTES(N, M) + 7) / 8];
    static pzs_control control;
    pzs_real target[M];
    (void)state;
    open_rig(&r, 23, N, M);
    for (int k = 0; k < N; k++)
        r.problem.step_limit[k] = 200;
    start(&r);
    for (int step = 0; step < 40; step++) {
        draw_voltages(&r, 60);
        measure(&r, 0);
        assert_int_equal(record(&r), PZS_OK);
    }
    draw_voltages(&r, 60);
    measure(&r, 0);
    memcpy(target, r.reading, sizeof target);
    assert_int_equal(solve(&r), PZS_OK);
    assert_int_equal(pzs_control_init(&control, &r.problem.tables, r.found, work, sizeof work),
                     PZS_OK);
    assert_int_equal(pzs_tick(&control, target, NULL), PZS_OK);
    for (int k = 0; k < N; k++)
        assert_true(fabs((double)(control.info.voltage[k] - r.voltage[k])) < 60 * 1e3 * EPSILON);
}

/* Law: wrong calls are refused and change nothing. */
static void test_wrong(void **state)
{
    static rig r;
    pzs_calibration *c = &r.calibration;
    (void)state;
    open_rig(&r, 29, 3, 2);
    assert_int_equal(
        pzs_calibration_init(NULL, &r.problem.tables, NULL, NULL, r.work, sizeof r.work),
        PZS_E_ARGUMENT);
    assert_int_equal(pzs_calibration_init(c, NULL, NULL, NULL, r.work, sizeof r.work),
                     PZS_E_ARGUMENT);
    assert_int_equal(record(&r), PZS_E_STAGE);
    assert_int_equal(solve(&r), PZS_E_STAGE);
    assert_int_equal(pzs_calibration_excite(c), PZS_E_STAGE);
    const size_t need = PZS_CALIBRATION_BYTES(3, 2);
    assert_int_equal(pzs_calibration_init(c, &r.problem.tables, NULL, NULL, r.work, need - 1),
                     PZS_E_WORKSPACE);
    assert_int_equal(c->info.where, need);
    r.problem.reference_voltage[1] = (pzs_real)NAN;
    assert_int_equal(
        pzs_calibration_init(c, &r.problem.tables, NULL, r.problem.reference_voltage, r.work, need),
        PZS_E_CRC);
    r.problem.reference_voltage[1] = 0;
    r.problem.tables.crc++;
    assert_int_equal(pzs_calibration_init(c, &r.problem.tables, NULL, NULL, r.work, need),
                     PZS_E_CRC);
    start(&r);
    c->settings.memory = 1;
    assert_int_equal(record(&r), PZS_E_ARGUMENT);
    c->settings.memory = (pzs_real)NAN;
    assert_int_equal(record(&r), PZS_E_ARGUMENT);
    c->settings.memory = 20;
    c->settings.reading_limit = (pzs_real)NAN;
    assert_int_equal(record(&r), PZS_E_ARGUMENT);
    c->settings.reading_limit = 0;
    assert_int_equal(record(&r), PZS_E_ARGUMENT);
    c->settings.amplitude = (pzs_real)NAN;
    assert_int_equal(pzs_calibration_excite(c), PZS_E_ARGUMENT);
    c->settings.amplitude = PZS_R(0.5);
    c->settings.settle = 0;
    assert_int_equal(pzs_calibration_excite(c), PZS_E_ARGUMENT);
    c->settings.settle = 1;
    assert_int_equal(pzs_calibration_record(c, NULL, r.reading), PZS_E_ARGUMENT);
    assert_int_equal(pzs_calibration_record(c, r.voltage, NULL), PZS_E_ARGUMENT);
    assert_int_equal(pzs_calibration_solve(c, NULL, r.spread), PZS_E_ARGUMENT);
    assert_int_equal(c->info.records, 0);
    r.problem.upper[2] = (pzs_real)HUGE_VAL; /* The limits in flash are damaged: first to an
                                        infinite range, then to another finite one. */
    const pzs_real before = c->info.voltage[0];
    assert_int_equal(pzs_calibration_excite(c), PZS_E_LIMITS);
    assert_int_equal(c->info.where, 2);
    r.problem.upper[2] = 90;
    assert_int_equal(pzs_calibration_excite(c), PZS_E_CRC);
    assert_true(c->info.voltage[0] == before);
    assert_int_equal(solve(&r), PZS_W_UNOBSERVABLE);
    assert_memory_equal(r.found, r.problem.influence, 6 * sizeof *r.found);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_host),        cmocka_unit_test(test_standard_errors),
        cmocka_unit_test(test_directional), cmocka_unit_test(test_memory),
        cmocka_unit_test(test_million),     cmocka_unit_test(test_huge),
        cmocka_unit_test(test_together),    cmocka_unit_test(test_late),
        cmocka_unit_test(test_inside),      cmocka_unit_test(test_limit_rows),
        cmocka_unit_test(test_patterns),    cmocka_unit_test(test_slow),
        cmocka_unit_test(test_control),     cmocka_unit_test(test_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
