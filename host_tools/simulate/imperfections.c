/* SPDX-License-Identifier: BSD-2-Clause */
/* Imperfections of amplifiers, cables, ceramic and sensors (imperfections.h). */
#include "imperfections.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "random.h"

/*
 * Width of the hysteresis loop of a soft piezoceramic relative to the voltage range, used where the
 * scene gives no width.
 */
static const double usual_hysteresis = 0.1;

/* Time constants of the three first-order lags of the creep model (s). */
static const double creep_time[CREEPS] = {0.1, 1, 10};

static const scene_imperfections *of(const imperfections *on)
{
    return &on->design->simulate.imperfections;
}

/* ---- actuators -------------------------------------------------------- */

static bool has_bandwidth(const design *design)
{
    return design->simulate.imperfections.bandwidth > 0;
}

/*
 * First-order lag of the amplifiers. The resulting voltage is the mean over the interval.
 *   voltage [amplifiers] in/out  (V)
 */
static void apply_lag(const imperfections *on, double *voltage, double interval)
{
    const double times = 2 * 3.14159265358979323846 * of(on)->bandwidth * interval;
    for (int k = 0; k < on->design->amplifiers; k++) {
        electrode *electrode = &on->electrode[k];
        const double behind = electrode->output - voltage[k];
        electrode->output = voltage[k] + behind * exp(-times);
        voltage[k] += times > 0 ? -behind * expm1(-times) / times : behind;
    }
}

static bool has_swaps(const design *design)
{
    return design->simulate.imperfections.swaps > 0;
}

static void swap_cables(const imperfections *on, double *voltage, double interval)
{
    const scene_imperfections *settings = of(on);
    (void)interval;
    for (int i = 0; i + 1 < settings->swaps; i += 2) {
        double *one = &voltage[settings->swapped[i]], *other = &voltage[settings->swapped[i + 1]];
        const double first = *one;
        *one = *other;
        *other = first;
    }
}

static bool has_reversals(const design *design)
{
    return design->simulate.imperfections.reversals > 0;
}

static void reverse_wires(const imperfections *on, double *voltage, double interval)
{
    const scene_imperfections *settings = of(on);
    (void)interval;
    for (int i = 0; i < settings->reversals; i++)
        voltage[settings->reversed[i]] *= -1;
}

static bool may_fail(const design *design)
{
    (void)design;
    return true;
}

/* Set the voltages of faulty electrodes, which ignore their amplifiers. */
static void set_faulty(const imperfections *on, double *voltage, double interval)
{
    (void)interval;
    for (int k = 0; k < on->design->amplifiers; k++)
        if (on->electrode[k].fault != ELECTRODE_GOOD)
            voltage[k] = on->electrode[k].fault_voltage;
}

static bool has_hysteresis(const design *design)
{
    return imperfections_hysteresis(design) > 0;
}

static double through_play(electrode *electrode, double voltage, double half_range, double share)
{
    double mean = 0;
    for (int i = 0; i < PLAYS; i++) {
        const double slack = half_range * (i + 1) / (2 * PLAYS);
        electrode->play[i] = fmin(fmax(electrode->play[i], voltage - slack), voltage + slack);
        mean += electrode->play[i] / PLAYS;
    }
    return voltage + share * (mean - voltage);
}

/*
 * Apply the hysteresis model to the voltages. After a full cycle the mean output of the play
 * operators has a loop width of 5/16 of the voltage range; the factor 16/5 scales this width to the
 * hysteresis that the scene states.
 */
static void apply_hysteresis(const imperfections *on, double *voltage, double interval)
{
    const design *design = on->design;
    const double share = imperfections_hysteresis(design) * 16 / 5;
    (void)interval;
    for (int k = 0; k < design->amplifiers; k++)
        voltage[k] = through_play(&on->electrode[k], voltage[k],
                                  (design->upper[k] - design->lower[k]) / 2, share);
}

static bool has_creep(const design *design)
{
    return design->simulate.imperfections.creep > 0;
}

static void add_creep(const imperfections *on, double *voltage, double interval)
{
    const double a_decade = of(on)->creep;
    for (int k = 0; k < on->design->amplifiers; k++) {
        double *state = on->electrode[k].creep, sum = 0;
        for (int i = 0; i < CREEPS; i++) {
            sum += state[i];
            state[i] -= expm1(-interval / creep_time[i]) * (a_decade * voltage[k] - state[i]);
        }
        voltage[k] += sum;
    }
}

/* Imperfections between the amplifiers and the ceramic, in the order of their effect. */
static const struct {
    bool (*is_present)(const design *design);
    void (*apply)(const imperfections *on, double *voltage, double interval);
} actuator_stages[] = {{has_bandwidth, apply_lag},         {has_swaps, swap_cables},
                       {has_reversals, reverse_wires},     {may_fail, set_faulty},
                       {has_hysteresis, apply_hysteresis}, {has_creep, add_creep}};
enum { ACTUATOR_STAGES = sizeof actuator_stages / sizeof *actuator_stages };

/* Whether a material strains in an electric field. */
static bool is_piezoelectric(const scene_material *material)
{
    return material->has_d || material->has_e;
}

double imperfections_hysteresis(const design *design)
{
    bool is_active = false;
    if (design->simulate.hysteresis_given)
        return design->simulate.hysteresis;
    for (int i = 0; i < design->layers; i++)
        is_active |= is_piezoelectric(&design->material[design->layer[i].material]);
    for (int k = 0; k < design->amplifiers; k++)
        is_active = is_active && isfinite(design->upper[k] - design->lower[k]);
    return is_active ? usual_hysteresis : 0;
}

bool imperfections_vary(const design *design)
{
    return design->simulate.imperfections.bandwidth > 0;
}

void imperfections_actuate(const imperfections *on, const double *output, double interval,
                           double *effect)
{
    memcpy(effect, output, (size_t)on->design->amplifiers * sizeof *effect);
    for (int i = 0; i < ACTUATOR_STAGES; i++)
        if (actuator_stages[i].is_present(on->design))
            actuator_stages[i].apply(on, effect, interval);
}

/*
 * Compute the voltages that act on the ceramic when all amplifiers have just moved to one of their
 * limits. An infinite limit is passed on unchanged.
 *   electrode [amplifiers] work
 */
static void act_at_limit(const imperfections *on, electrode *electrode, const double *limit,
                         double *effect)
{
    imperfections moved = *on;
    const size_t n = (size_t)on->design->amplifiers;
    moved.electrode = electrode;
    memcpy(electrode, on->electrode, n * sizeof *electrode);
    for (size_t k = 0; k < n; k++)
        effect[k] = electrode[k].output = isfinite(limit[k]) ? limit[k] : 0;
    for (int i = 0; i < ACTUATOR_STAGES; i++)
        if (actuator_stages[i].is_present(on->design))
            actuator_stages[i].apply(&moved, effect, 0);
    for (size_t k = 0; k < n; k++)
        effect[k] = isfinite(limit[k]) ? effect[k] : limit[k];
}

bool imperfections_stroke(const imperfections *on, double *lowest, double *highest)
{
    electrode *copy = malloc((size_t)on->design->amplifiers * sizeof *copy);
    if (!copy)
        return false;
    act_at_limit(on, copy, on->design->lower, lowest);
    act_at_limit(on, copy, on->design->upper, highest);
    for (int k = 0; k < on->design->amplifiers; k++) { /* a reversed wire exchanges lowest and
                                                          highest voltage */
        const double one = lowest[k], other = highest[k];
        lowest[k] = fmin(one, other);
        highest[k] = fmax(one, other);
    }
    free(copy);
    return true;
}

/* ---- sensors ---------------------------------------------------------- */

static double add_drift(const imperfections *on, int sensor, double value)
{
    return value + on->sensor[sensor].slope * on->time;
}

static double add_outlier(const imperfections *on, int sensor, double value)
{
    const scene_imperfections *settings = of(on);
    (void)sensor;
    if (!(settings->outlier_chance > 0) || random_uniform(on->random) >= settings->outlier_chance)
        return value;
    return value + settings->outlier_size * (2 * random_uniform(on->random) - 1);
}

static double quantise(const imperfections *on, int sensor, double value)
{
    const double quantum = of(on)->quantum;
    (void)sensor;
    return quantum > 0 ? quantum * floor(value / quantum + 0.5) : value;
}

/* Imperfections of the sensors, in the order of their effect. */
static double (*const sensor_stages[])(const imperfections *on, int sensor,
                                       double value) = {add_drift, add_outlier, quantise};
enum { SENSOR_STAGES = sizeof sensor_stages / sizeof *sensor_stages };

void imperfections_draw(const imperfections *on)
{
    const double most = of(on)->drift;
    for (int i = 0; i < on->sensors && most > 0; i++)
        on->sensor[i].slope = most * (2 * random_uniform(on->random) - 1);
}

double imperfections_sense(const imperfections *on, int sensor, double value)
{
    for (int i = 0; i < SENSOR_STAGES; i++)
        value = sensor_stages[i](on, sensor, value);
    return value;
}

/* ---- text ------------------------------------------------------------- */

/*
 * Largest deviation from 1 among the gains by which the plant's influence matrix differs from the
 * measured one.
 */
static double largest_gain_error(const design *design)
{
    double most = 0;
    for (int k = 0; k < design->amplifiers && design->simulate.gain; k++)
        most = fmax(most, fabs(design->simulate.gain[k] - 1));
    return most;
}

void imperfections_text(const design *design, char *text, size_t room)
{
    const scene_imperfections *settings = &design->simulate.imperfections;
    const struct {
        const char *format;
        double value;
    } rows[] = {{"entries of the matrix wrong by %g", design->simulate.scatter},
                {"gains of the matrix up to %g off", largest_gain_error(design)},
                {"hysteresis %g of the range", imperfections_hysteresis(design)},
                {"creep %g a decade", settings->creep},
                {"amplifiers of %g Hz", settings->bandwidth},
                {"%g reversed wires", settings->reversals},
                {"%g swapped cables", settings->swaps},
                {"drift of sensors up to %g a second", settings->drift},
                {"outliers in a share of %g of the readings", settings->outlier_chance},
                {"readings in steps of %g", settings->quantum}};
    size_t at = 0;
    text[0] = '\0';
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char part[80];
        if (!(rows[i].value > 0))
            continue;
        snprintf(part, sizeof part, rows[i].format, rows[i].value);
        if (at + strlen(part) + 3 < room)
            at += (size_t)snprintf(text + at, room - at, "%s%s", at ? ", " : "", part);
    }
}
