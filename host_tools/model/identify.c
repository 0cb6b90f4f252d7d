/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Identification of hysteresis and creep of an actuator from a measured sweep (its position while
 * the voltage goes up and down) by bounded least squares (identify.h).
 */
#include "identify.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/hysteresis.h"

enum { SLOPES = PZS_HYSTERESIS_SEGMENTS, CREEPS = 3, LEAST_SAMPLES = 100, MOST_SAMPLES = 60000 };

/*
 * Time constants of the creep model (s), a decade apart, because creep grows with the logarithm of
 * time.
 */
static const double creep_time[CREEPS] = {0.1, 1, 10};

/*
 * Slacks (widths of the backlash) of the play operators of the hysteresis model. Operator k = 1 to
 * n of n operators has the slack widest_slack x (k/n)^slack_power x half of the voltage range.
 */
static const double widest_slack = 0.95, slack_power = 1.3;

/*
 * Smallest slope of the hysteresis model relative to its mean slope; the inverse of the model then
 * multiplies noise by 10 at most.
 */
static const double least_slope = 0.1;

/*
 * Weight of the rows that keep two unknowns alike (struct fit), relative to the rows of measured
 * positions. A small value suffices for unknowns that the measurements cannot distinguish.
 */
static const double likeness = 0.05;

/*
 * Bounded least-squares problem that fits hysteresis and creep of an actuator to its positions
 * under known voltages.
 *   unknowns  slopes of a piecewise linear function of the voltage, weights of the play operators
 *       (elements with backlash) above and below the middle voltage, creep amplitudes, a constant
 *   rows      one for each position; one for each play operator, to keep its two weights alike; one
 *       for each pair of neighbouring creep time constants
 */
typedef struct fit {
    const sweep *sweep;
    size_t plays, unknowns, rows;
    double middle, half_range; /* middle and half width of the range of the voltages that were
                                  applied to the actuator (V) */
    double lowest, highest;    /* lowest and highest measured position of the actuator */
    double unit; /* range of the actuator's measured positions divided by the range of its voltages,
                    by which the unknowns of the hysteresis fit are scaled (unit of the position per
                    V) */
    double slack[SCENE_PLAYS]; /* slack of each play operator, an element with backlash (V) */
    double *matrix; /* [rows][unknowns] matrix of the least-squares problem for the hysteresis model
                     */
    double *wanted, *weight; /* [rows] right-hand side and weights of the least-squares problem for
                                the hysteresis model */
    double *bound; /* [4][unknowns] lower bounds, upper bounds, step limits and reference values of
                      the unknowns of the hysteresis fit */
    double *value; /* [unknowns] fitted parameters of the hysteresis and creep model */
} fit;

static int refuse(char *error, const char *text)
{
    snprintf(error, SCENE_ERROR, "%s", text);
    return -1;
}

/* ---- the sweep -------------------------------------------------------- */

static void find_ranges(fit *fit)
{
    const sweep *sweep = fit->sweep;
    double low = HUGE_VAL, high = -HUGE_VAL;
    fit->lowest = HUGE_VAL;
    fit->highest = -HUGE_VAL;
    for (size_t i = 0; i < sweep->count; i++) {
        low = fmin(low, sweep->voltage[i]);
        high = fmax(high, sweep->voltage[i]);
        fit->lowest = fmin(fit->lowest, sweep->position[i]);
        fit->highest = fmax(fit->highest, sweep->position[i]);
    }
    fit->middle = (low + high) / 2;
    fit->half_range = (high - low) / 2;
    fit->unit = (fit->highest - fit->lowest) / (high - low);
}

/*
 * Slope of the least-squares straight line through the measured positions of the actuator over its
 * voltages (position per volt).
 *   rms out  root mean square difference between samples and line, relative to the range of the
 *       positions
 */
static double straight_line(const fit *fit, double *rms)
{
    const sweep *sweep = fit->sweep;
    const double n = (double)sweep->count;
    double voltage = 0, position = 0, square = 0, product = 0, own = 0;
    for (size_t i = 0; i < sweep->count; i++) {
        voltage += sweep->voltage[i] / n;
        position += sweep->position[i] / n;
    }
    for (size_t i = 0; i < sweep->count; i++) {
        const double v = sweep->voltage[i] - voltage, p = sweep->position[i] - position;
        square += v * v / n;
        product += v * p / n;
        own += p * p / n;
    }
    *rms = sqrt(fmax(own - product * product / square, 0)) / (fit->highest - fit->lowest);
    return product / square;
}

static int check_sweep(const sweep *sweep, int plays, char *error)
{
    if (sweep->count < LEAST_SAMPLES || sweep->count > MOST_SAMPLES) {
        snprintf(error, SCENE_ERROR, "%lu samples of a sweep are out of range (%d to %d)",
                 (unsigned long)sweep->count, LEAST_SAMPLES, MOST_SAMPLES);
        return -1;
    }
    if (!(sweep->rate > 0) || !isfinite(sweep->rate) || plays < 1 || plays > SCENE_PLAYS)
        return refuse(error, "the samples a second of a sweep must be above 0");
    for (size_t i = 0; i < sweep->count; i++)
        if (!isfinite(sweep->voltage[i]) || !isfinite(sweep->position[i])) {
            snprintf(error, SCENE_ERROR, "sample %lu of the sweep is not a number",
                     (unsigned long)i + 1);
            return -1;
        }
    return 0;
}

/* ---- least squares ---------------------------------------------------- */

static bool open_fit(fit *fit)
{
    const size_t columns = fit->unknowns;
    fit->matrix = calloc(fit->rows * columns, sizeof *fit->matrix);
    fit->wanted = calloc(2 * fit->rows, sizeof *fit->wanted);
    fit->bound = calloc(5 * columns, sizeof *fit->bound);
    fit->weight = fit->wanted + fit->rows;
    fit->value = fit->bound + 4 * columns;
    return fit->matrix && fit->wanted && fit->bound;
}

static void close_fit(fit *fit)
{
    free(fit->matrix);
    free(fit->wanted);
    free(fit->bound);
}

/*
 * Split the interval from 0 to s at the borders of the quarters of the voltage range; s is a
 * voltage minus the middle of the range (V).
 *   row [SLOPES] out  length of the part in each quarter (V), negative for s < 0
 */
static void fill_slopes(const fit *fit, double s, double *row)
{
    for (int i = 0; i < SLOPES; i++) {
        const double low = i == 0 ? -HUGE_VAL : (i - 2) * fit->half_range / 2;
        const double high = i == SLOPES - 1 ? HUGE_VAL : (i - 1) * fit->half_range / 2;
        row[i] = fmin(fmax(s, low), high) - fmin(fmax(0, low), high);
    }
}

/*
 * Fill the rows of the least-squares matrix that belong to measured positions. The unknowns are the
 * parameters of a hysteresis model: four slopes of its piecewise linear part, the weights of its
 * plays (elements with backlash), the amplitudes of its creep terms, and a constant. Entry (i, j)
 * is the equivalent voltage (V) that the model gives at sample i of the sweep per unit of parameter
 * j: the voltage that would cause the same position without hysteresis.
 */
static void fill_samples(fit *fit)
{
    const size_t plays = fit->plays;
    const double zero[SCENE_PLAYS + SLOPES] = {0};
    const double ones[CREEPS] = {1, 1, 1};
    double rate[CREEPS], play[SCENE_PLAYS], creep[CREEPS] = {0};
    for (int j = 0; j < CREEPS; j++)
        rate[j] = -expm1(-1 / (fit->sweep->rate * creep_time[j]));
    const pzs_hysteresis tables = {.inputs = 1,
                                   .sets = 1,
                                   .plays = (uint16_t)plays,
                                   .creeps = CREEPS,
                                   .middle = &fit->middle,
                                   .half_range = &fit->half_range,
                                   .offset = zero,
                                   .slope = zero,
                                   .slack = fit->slack,
                                   .above = zero,
                                   .below = zero,
                                   .creep = ones,
                                   .creep_rate = rate};
    const hysteresis_memory memory = {play, creep};
    pzs_hysteresis_rest(&tables, 0, memory, fit->sweep->voltage[0]);
    for (size_t i = 0; i < fit->sweep->count; i++) {
        double *row = fit->matrix + i * fit->unknowns;
        const double voltage = fit->sweep->voltage[i];
        fill_slopes(fit, voltage - fit->middle, row);
        memcpy(row + SLOPES + 2 * plays, creep, sizeof creep);
        pzs_hysteresis_remember(&tables, 0, memory, voltage, 1);
        for (size_t k = 0; k < plays; k++) {
            row[SLOPES + k] = fmax(play[k], 0);
            row[SLOPES + plays + k] = fmin(play[k], 0);
        }
        row[fit->unknowns - 1] = fit->half_range;
        fit->wanted[i] = (fit->sweep->position[i] - fit->sweep->position[0]) / fit->unit;
        fit->weight[i] = 1;
    }
}

/*
 * Fill row i of the least-squares problem for the hysteresis model with a penalty on the difference
 * of two of its unknowns.
 */
static void make_alike(fit *fit, size_t i, size_t one, size_t other)
{
    double *row = fit->matrix + i * fit->unknowns;
    row[one] = fit->half_range;
    row[other] = -fit->half_range;
    fit->weight[i] = likeness * sqrt((double)fit->sweep->count);
}

/*
 * Fill the rows of the least-squares problem that keep unknowns alike: the two weights of each play
 * operator, and the creep amplitudes of neighbouring time constants. A time constant too long to be
 * seen in the measurement thus gets the amplitude of its shorter neighbour.
 */
static void fill_likeness(fit *fit)
{
    const size_t creep = SLOPES + 2 * fit->plays;
    size_t i = fit->sweep->count;
    for (size_t k = 0; k < fit->plays; k++)
        make_alike(fit, i++, SLOPES + k, SLOPES + fit->plays + k);
    for (size_t j = 0; j + 1 < CREEPS; j++)
        make_alike(fit, i++, creep + j, creep + j + 1);
}

/*
 * Set the bounds of the unknowns of the hysteresis fit. The slopes of the piecewise linear function
 * of the voltage are at least least_slope. The weights of the play operators and the creep
 * amplitudes are at least 0. The constant has no bounds.
 */
static void fill_bounds(fit *fit)
{
    double *lower = fit->bound, *upper = lower + fit->unknowns, *step = upper + fit->unknowns;
    for (size_t k = 0; k < fit->unknowns; k++) {
        lower[k] = k < SLOPES ? least_slope : 0;
        upper[k] = step[k] = HUGE_VAL;
    }
    lower[fit->unknowns - 1] = -HUGE_VAL;
}

/*
 * Solve the bounded least-squares problem for the hysteresis model with the optimiser of the
 * control step. Returns 0, or -1 with error filled.
 */
static int solve(fit *fit, char *error)
{
    const uint16_t n = (uint16_t)fit->unknowns, m = (uint16_t)fit->rows;
    pzs_problem problem = {.inputs = n,
                           .outputs = m,
                           .influence = fit->matrix,
                           .weight = fit->weight,
                           .lower = fit->bound,
                           .upper = fit->bound + n,
                           .step_limit = fit->bound + 2 * n,
                           .reference_voltage = fit->bound + 3 * n};
    pzs_control control;
    void *work = malloc(PZS_CONTROL_BYTES(n, m));
    pzs_status status = work ? pzs_problem_seal(&problem) : PZS_E_WORKSPACE;
    if (status == PZS_OK)
        status = pzs_control_init(&control, &problem, NULL, work, PZS_CONTROL_BYTES(n, m));
    if (status == PZS_OK)
        status = pzs_step(&control, fit->wanted);
    if (!PZS_IS_ERROR(status))
        memcpy(fit->value, control.info.voltage, n * sizeof *fit->value);
    free(work);
    if (PZS_IS_ERROR(status))
        snprintf(error, SCENE_ERROR, "fit of the sweep: %s", pzs_status_text(status));
    return PZS_IS_ERROR(status) ? -1 : 0;
}

/* ---- result ----------------------------------------------------------- */

/*
 * Return the mean slope of the hysteresis model, from the lowest to the highest voltage and without
 * creep: change of the equivalent voltage (which would cause the same position without hysteresis)
 * per volt.
 */
static double full_range_gain(const fit *fit)
{
    double sum = 0;
    for (int i = 0; i < SLOPES; i++)
        sum += fit->value[i] / SLOPES;
    for (size_t k = 0; k < fit->plays; k++) {
        /* after a reversal, a play operator stands still for twice its slack */
        const double way = 1 - fit->slack[k] / fit->half_range;
        sum += way * (fit->value[SLOPES + k] + fit->value[SLOPES + fit->plays + k]) / 2;
    }
    return sum;
}

static void take_list(scene_short_list *list, const double *value, size_t count, double factor)
{
    list->count = (int)count;
    for (size_t k = 0; k < count; k++)
        list->value[k] = factor * value[k];
}

/*
 * Equivalent voltage (V) of the fitted model of hysteresis and creep at 0 V, if no other voltage
 * was applied before. The equivalent voltage would cause the same position without hysteresis.
 */
static double effect_at_start(const fit *fit)
{
    const double place = -fit->middle; /* All play operators of the hysteresis model start at 0 V.
                                        */
    double row[SLOPES], sum = fit->value[fit->unknowns - 1] * fit->half_range;
    fill_slopes(fit, place, row);
    for (int i = 0; i < SLOPES; i++)
        sum += fit->value[i] * row[i];
    for (size_t k = 0; k < fit->plays; k++)
        sum += place * fit->value[SLOPES + (place > 0 ? 0 : fit->plays) + k];
    return sum;
}

static void take_result(identification *result, const fit *fit, double gain)
{
    scene_hysteresis *hysteresis = &result->hysteresis;
    result->gain = gain > 0 ? gain : fit->unit * full_range_gain(fit);
    const double factor = fit->unit / result->gain;
    const double *weight = fit->value + SLOPES;
    hysteresis->given = true;
    hysteresis->offset = factor * effect_at_start(fit);
    hysteresis->range[0] = fit->middle - fit->half_range;
    hysteresis->range[1] = fit->middle + fit->half_range;
    take_list(&hysteresis->slope, fit->value, SLOPES, factor);
    take_list(&hysteresis->slack, fit->slack, fit->plays, 1);
    take_list(&hysteresis->above, weight, fit->plays, factor);
    take_list(&hysteresis->below, weight + fit->plays, fit->plays, factor);
    take_list(&hysteresis->creep_time, creep_time, CREEPS, 1);
    take_list(&hysteresis->creep, weight + 2 * fit->plays, CREEPS, factor);
}

static void find_misfit(identification *result, const fit *fit)
{
    const double range = (fit->highest - fit->lowest) / fit->unit;
    double sum = 0;
    for (size_t i = 0; i < fit->sweep->count; i++) {
        double misfit = -fit->wanted[i];
        for (size_t k = 0; k < fit->unknowns; k++)
            misfit += fit->matrix[i * fit->unknowns + k] * fit->value[k];
        sum += misfit * misfit;
        result->largest = fmax(result->largest, fabs(misfit) / range);
    }
    result->rms = sqrt(sum / (double)fit->sweep->count) / range;
}

int identify(identification *result, const sweep *sweep, int plays, double gain, char *error)
{
    fit fit = {.sweep = sweep, .plays = (size_t)plays};
    memset(result, 0, sizeof *result);
    if (check_sweep(sweep, plays, error) < 0)
        return -1;
    find_ranges(&fit);
    if (!(fit.half_range > 0))
        return refuse(error, "the voltage of the sweep is constant");
    if (!(straight_line(&fit, &result->straight) > 0))
        return refuse(error, "the position of the sweep does not rise with the voltage; change its "
                             "sign if the electrode acts in the opposite direction");
    for (int k = 0; k < plays; k++)
        fit.slack[k] = widest_slack * fit.half_range * pow((k + 1.0) / plays, slack_power);
    fit.unknowns = SLOPES + 2 * fit.plays + CREEPS + 1;
    fit.rows = sweep->count + fit.plays + CREEPS - 1;
    int failed = open_fit(&fit) ? 0 : refuse(error, "out of memory");
    if (!failed) {
        fill_samples(&fit);
        fill_likeness(&fit);
        fill_bounds(&fit);
        failed = solve(&fit, error);
    }
    if (!failed) {
        take_result(result, &fit, gain);
        find_misfit(result, &fit);
    }
    close_fit(&fit);
    return failed;
}
