/* SPDX-License-Identifier: BSD-2-Clause */
/* Imperfections of amplifiers, cables, ceramic and sensors (imperfections.h). */
#include "imperfections.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "random.h"

/* Time constants of the three first-order lags of the creep model (s). */
static const double creep_time[CREEPS] = {0.1, 1, 10};

/* ---- imperfections of amplifiers and ceramic -------------------------- */

static bool has_bandwidth(const imperfection_tables *tables)
{
    return tables->bandwidth > 0;
}

double amplifier_lag(double *output, double command, double bandwidth, double interval)
{
    const double times = 2 * 3.14159265358979323846 * bandwidth * interval;
    const double behind = *output - command;
    *output = command + behind * exp(-times);
    return command + (times > 0 ? -behind * expm1(-times) / times : behind);
}

/*
 * Apply the first-order lag of the amplifiers to their voltages. The result is the mean voltage
 * over a time interval.
 *   voltage [amplifiers] in/out  commands to the amplifiers in, mean output voltages out (V)
 */
static void apply_lag(const imperfections *on, double *voltage, double interval)
{
    for (int k = 0; k < on->tables.amplifiers; k++)
        voltage[k] =
            amplifier_lag(&on->electrode[k].output, voltage[k], on->tables.bandwidth, interval);
}

static bool has_swaps(const imperfection_tables *tables)
{
    return tables->swaps > 0;
}

static void swap_cables(const imperfections *on, double *voltage, double interval)
{
    const imperfection_tables *tables = &on->tables;
    (void)interval;
    for (int i = 0; i + 1 < tables->swaps; i += 2) {
        double *one = &voltage[tables->swapped[i]], *other = &voltage[tables->swapped[i + 1]];
        const double first = *one;
        *one = *other;
        *other = first;
    }
}

static bool has_reversals(const imperfection_tables *tables)
{
    return tables->reversals > 0;
}

static void reverse_wires(const imperfections *on, double *voltage, double interval)
{
    const imperfection_tables *tables = &on->tables;
    (void)interval;
    for (int i = 0; i < tables->reversals; i++)
        voltage[tables->reversed[i]] *= -1;
}

static bool may_fail(const imperfection_tables *tables)
{
    (void)tables;
    return true;
}

/*
 * Set the output voltages of faulty electrodes, which are dead or stuck and ignore their
 * amplifiers.
 */
static void set_faulty(const imperfections *on, double *voltage, double interval)
{
    (void)interval;
    for (int k = 0; k < on->tables.amplifiers; k++)
        if (on->electrode[k].fault != ELECTRODE_GOOD)
            voltage[k] = on->electrode[k].fault_voltage;
}

static bool has_hysteresis(const imperfection_tables *tables)
{
    return tables->hysteresis > 0;
}

/*
 * After a full cycle the mean output of the play operators has a loop whose width is 5/16 of the
 * voltage range. The factor 16/5 scales this width to the hysteresis that the scene file states.
 */
double imperfections_play(double play[PLAYS], double voltage, double half_range, double hysteresis)
{
    const double share = hysteresis * 16 / 5;
    double mean = 0;
    for (int i = 0; i < PLAYS; i++) {
        const double slack = half_range * (i + 1) / (2 * PLAYS);
        play[i] = fmin(fmax(play[i], voltage - slack), voltage + slack);
        mean += play[i] / PLAYS;
    }
    return voltage + share * (mean - voltage);
}

static void apply_hysteresis(const imperfections *on, double *voltage, double interval)
{
    const imperfection_tables *tables = &on->tables;
    (void)interval;
    for (int k = 0; k < tables->amplifiers; k++)
        voltage[k] =
            imperfections_play(on->electrode[k].play, voltage[k],
                               (tables->upper[k] - tables->lower[k]) / 2, tables->hysteresis);
}

static bool has_creep(const imperfection_tables *tables)
{
    return tables->creep > 0;
}

static void add_creep(const imperfections *on, double *voltage, double interval)
{
    const double a_decade = on->tables.creep;
    for (int k = 0; k < on->tables.amplifiers; k++) {
        double *state = on->electrode[k].creep, sum = 0;
        for (int i = 0; i < CREEPS; i++) {
            sum += state[i];
            state[i] -= expm1(-interval / creep_time[i]) * (a_decade * voltage[k] - state[i]);
        }
        voltage[k] += sum;
    }
}

static bool has_curves(const imperfection_tables *tables)
{
    return tables->curves.sets > 0;
}

static void apply_curves(const imperfections *on, double *voltage, double interval)
{
    (void)interval;
    for (int k = 0; k < on->tables.amplifiers; k++)
        voltage[k] = actuator_effect(&on->tables.curves, k, voltage[k]);
}

/*
 * Table of the imperfections between the amplifiers and the ceramic, in the order in which they
 * act.
 */
static const struct {
    bool (*is_present)(const imperfection_tables *tables);
    void (*apply)(const imperfections *on, double *voltage, double interval);
} actuator_stages[] = {{has_bandwidth, apply_lag},         {has_swaps, swap_cables},
                       {has_reversals, reverse_wires},     {may_fail, set_faulty},
                       {has_hysteresis, apply_hysteresis}, {has_creep, add_creep},
                       {has_curves, apply_curves}};
enum { ACTUATOR_STAGES = sizeof actuator_stages / sizeof *actuator_stages };

bool imperfections_vary(const imperfection_tables *tables)
{
    return tables->bandwidth > 0;
}

void imperfections_actuate(const imperfections *on, const double *output, double interval,
                           double *effect)
{
    memcpy(effect, output, (size_t)on->tables.amplifiers * sizeof *effect);
    for (int i = 0; i < ACTUATOR_STAGES; i++)
        if (actuator_stages[i].is_present(&on->tables))
            actuator_stages[i].apply(on, effect, interval);
}

/*
 * Compute the voltages that act on the ceramic just after all amplifiers have moved to their lower
 * limits, or all to their upper limits. If a limit is infinite, the voltage that acts is infinite
 * too.
 *   electrode [amplifiers] out  work array for copies of the states of the electrodes
 */
static void act_at_limit(const imperfections *on, electrode *electrode, const double *limit,
                         double *effect)
{
    imperfections moved = *on;
    const size_t n = (size_t)on->tables.amplifiers;
    moved.electrode = electrode;
    memcpy(electrode, on->electrode, n * sizeof *electrode);
    for (size_t k = 0; k < n; k++)
        effect[k] = electrode[k].output = isfinite(limit[k]) ? limit[k] : 0;
    for (int i = 0; i < ACTUATOR_STAGES; i++)
        if (actuator_stages[i].is_present(&on->tables))
            actuator_stages[i].apply(&moved, effect, 0);
    for (size_t k = 0; k < n; k++)
        effect[k] = isfinite(limit[k]) ? effect[k] : limit[k];
}

bool imperfections_stroke(const imperfections *on, double *lowest, double *highest)
{
    electrode *copy = malloc((size_t)on->tables.amplifiers * sizeof *copy);
    if (!copy)
        return false;
    act_at_limit(on, copy, on->tables.lower, lowest);
    act_at_limit(on, copy, on->tables.upper, highest);
    for (int k = 0; k < on->tables.amplifiers; k++) { /* The output of an amplifier with exchanged
                                                         wires has the opposite sign. Its voltage at
                                                         the lower limit is then the larger one. */
        const double one = lowest[k], other = highest[k];
        lowest[k] = fmin(one, other);
        highest[k] = fmax(one, other);
    }
    free(copy);
    return true;
}

/* ---- imperfections of sensors ----------------------------------------- */

static double add_drift(const imperfections *on, int sensor, double value)
{
    return value + on->sensor[sensor].slope * on->time;
}

static double add_outlier(const imperfections *on, int sensor, double value)
{
    const imperfection_tables *tables = &on->tables;
    (void)sensor;
    if (!(tables->outlier_chance > 0) || random_uniform(on->random) >= tables->outlier_chance)
        return value;
    return value + tables->outlier_size * (2 * random_uniform(on->random) - 1);
}

static double quantise(const imperfections *on, int sensor, double value)
{
    const double quantum = on->tables.quantum;
    (void)sensor;
    return quantum > 0 ? quantum * floor(value / quantum + 0.5) : value;
}

/*
 * Table of the functions that apply drift, outliers, quantisation and the other imperfections of
 * the sensors, in the order in which they act.
 */
static double (*const sensor_stages[])(const imperfections *on, int sensor,
                                       double value) = {add_drift, add_outlier, quantise};
enum { SENSOR_STAGES = sizeof sensor_stages / sizeof *sensor_stages };

void imperfections_draw(const imperfections *on)
{
    const double most = on->tables.drift;
    for (int i = 0; i < on->sensors && most > 0; i++)
        on->sensor[i].slope = most * (2 * random_uniform(on->random) - 1);
}

double imperfections_sense(const imperfections *on, int sensor, double value)
{
    for (int i = 0; i < SENSOR_STAGES; i++)
        value = sensor_stages[i](on, sensor, value);
    return value;
}

void imperfections_read(const imperfections *on, int tick, const double *noise, const double *exact,
                        double *reading, double *sensed)
{
    for (int i = 0; i < on->sensors; i++) {
        const double error = noise[i] > 0 ? noise[i] * random_noise(on->random) : 0;
        const bool is_stuck = tick < on->sensor[i].stuck_until;
        const bool is_missing = tick < on->sensor[i].nan_until;
        if (!is_stuck)
            reading[i] = imperfections_sense(on, i, exact[i] + error) +
                         (tick < on->sensor[i].wrong_until ? on->sensor[i].error : 0);
        sensed[i] = is_missing ? (double)NAN : reading[i];
    }
}
