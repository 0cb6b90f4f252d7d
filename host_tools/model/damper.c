/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computation of the tables with which the control tick of a scene damps vibration: choice of the
 * observed vibration modes, their shapes, and their sensor readings.
 */
#include "damper.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/model.h"
#include "mass.h"
#include "modal.h"

/*
 * Largest number of vibration modes that are computed. From them, the modes are chosen that the
 * control tick estimates from the sensor readings.
 */
enum { MODE_LIMIT = 200 };

/*
 * Smallest visibility with which the control tick estimates and damps a vibration mode. The
 * visibility is the root mean square displacement of the outputs in the mode, divided by the
 * largest displacement of the mode shape.
 */
static const double visible = 1e-3;

/*
 * Gain per tick of the low-pass filter for the sensor readings where the control tick observes no
 * vibration mode: slow_part x damping ratio x angular frequency x tick interval of the first mode,
 * at most slow_limit. (Where modes are observed, the filter gets the part of the readings that the
 * modes do not explain.)
 */
static const double slow_limit = 0.02, slow_part = 0.5;

static const double two_pi = 6.283185307179586;

/* Intermediate results while the tables of a control tick that damps vibration are made. */
typedef struct builder {
    damper *damper;
    const analysis *analysis;
    const estimator *estimator; /* the controller's estimator of the shape from sensor readings;
                                   NULL: every target node is measured */
    const vibration *vibration;
    vibration more; /* vibration modes that are computed for the vibration damper, where the
                       stability tests of the loop have computed too few of them */
    damper_settings settings;
    damper_model model;
    double interval; /* time between two control ticks (s) */
    int delay;       /* delay of the sensor readings between measurement and use (ticks) */
    size_t targets, sensors, amplifiers;
    size_t *mode; /* [modes] index of each vibration mode that the control tick observes, among the
                     computed vibration modes */
    double *angle, *ratio, *overlap, *lift, *square,
        *precision; /* arrays of the model (damper_model) of the observed vibration modes, and
                       inverse noise variance of each sensor */
    double *column; /* [targets] work vector for one mode shape at the target nodes */
    double *shape, *reading,
        *modal; /* shape [targets][modes]: mode shapes at the outputs; reading [sensors][modes]:
                   reading of each sensor per unit of the coordinate of each vibration mode; modal
                   [modes][amplifiers]: coordinate of each vibration mode in equilibrium per volt */
    damper_gains gains;
} builder;

/* ---- choice of modes -------------------------------------------------- */

/*
 * Displacement of the target nodes in a vibration mode of unit modal mass, without its part along
 * the free functions of the target (shapes that may be added to the target at no cost).
 *   shape [targets] out  displacement of each target node
 */
static void mode_shape(const builder *builder, size_t mode, double *shape)
{
    const design *design = &builder->analysis->design;
    const size_t dof = (size_t)design->mesh.free_dof;
    design_shape(design, builder->vibration->shape + mode * dof, shape);
    design_take_free(design, shape);
}

static double rms(const double *value, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += value[i] * value[i];
    return sqrt(sum / (double)count);
}

static bool is_visible(const builder *builder, size_t mode)
{
    mode_shape(builder, mode, builder->column);
    return rms(builder->column, builder->targets) > visible * builder->vibration->largest[mode];
}

static double angle_of(const builder *builder, size_t mode)
{
    return sqrt(builder->vibration->square[mode]) * builder->interval;
}

/*
 * Largest number of vibration modes that the control tick may observe (estimate from sensor
 * readings). It is the smaller of two numbers: the amplifiers that are not held at one voltage, and
 * the sensors minus 1.
 */
static size_t mode_limit(const builder *builder)
{
    const design *design = &builder->analysis->design;
    size_t moving = 0;
    for (int k = 0; k < design->amplifiers; k++)
        moving += !design_is_held(design, k);
    return moving < builder->sensors ? moving : builder->sensors - 1;
}

/* List the vibration modes that the control tick observes. Returns the number of these modes. */
static size_t list_modes(builder *builder)
{
    const size_t limit = mode_limit(builder), count = (size_t)builder->vibration->count;
    size_t listed = 0;
    for (size_t i = (size_t)vibration_first(builder->vibration); i < count && listed < limit; i++)
        if (angle_of(builder, i) <= builder->settings.observed && is_visible(builder, i))
            builder->mode[listed++] = i;
    return listed;
}

/*
 * Whether more vibration modes must be computed: fewer modes are observed than are possible, and
 * even the highest computed frequency is low enough to be observed.
 */
static bool needs_more(const builder *builder, size_t found)
{
    const int count = builder->vibration->count;
    return found < mode_limit(builder) && count > 0 &&
           angle_of(builder, (size_t)count - 1) <= builder->settings.observed;
}

/*
 * Choose the observed vibration modes, and compute more modes as long as some may be missing.
 * Returns 0, or -1 with error filled.
 */
static int choose_modes(builder *builder, char *error)
{
    const design *design = &builder->analysis->design;
    const int most = vibration_most(design);
    size_t found = list_modes(builder);
    while (needs_more(builder, found) && builder->vibration->count < most &&
           builder->vibration->count < MODE_LIMIT) {
        const int number =
            2 * builder->vibration->count < MODE_LIMIT ? 2 * builder->vibration->count : MODE_LIMIT;
        vibration next;
        if (analysis_vibration(builder->analysis, &next, number, error) < 0)
            return -1;
        vibration_free(&builder->more);
        builder->more = next;
        builder->vibration = &builder->more;
        found = list_modes(builder);
    }
    builder->model.modes = found;
    return 0;
}

/* ---- arrays ----------------------------------------------------------- */

/* One array to be allocated: the address of the pointer to it, and its number of entries. */
typedef struct array {
    double **at;
    size_t count;
} array;

/*
 * Allocate all arrays of the vibration damper's tables and of their intermediate results in one
 * block of memory.
 */
static int take_memory(builder *builder)
{
    damper *damper = builder->damper;
    damper_gains *gains = &builder->gains;
    const size_t modes = builder->model.modes, inputs = builder->amplifiers;
    const array all[] = {{&damper->frequency, modes},
                         {&builder->shape, builder->targets * modes},
                         {&builder->reading, builder->sensors * modes},
                         {&builder->modal, modes * inputs},
                         {&builder->precision, builder->sensors},
                         {&builder->angle, modes},
                         {&builder->ratio, modes},
                         {&builder->overlap, modes * modes},
                         {&builder->lift, inputs * modes},
                         {&builder->square, modes},
                         {&gains->turn, 4 * modes},
                         {&gains->observer, 3 * modes * modes},
                         {&gains->explain, modes * modes},
                         {&gains->damping, modes * inputs},
                         {&gains->inverse_angle, modes},
                         {&gains->lag, 2 + 2 * modes}};
    const size_t arrays = sizeof all / sizeof *all;
    size_t total = 0;
    for (size_t i = 0; i < arrays; i++)
        total += all[i].count + 1;
    double *at = damper->memory = calloc(total, sizeof *at);
    for (size_t i = 0; i < arrays && at; i++) {
        *all[i].at = at;
        at += all[i].count + 1;
    }
    return at ? 0 : -1;
}

static double damping_ratio(const builder *builder, size_t mode)
{
    const int number = (int)mode - vibration_first(builder->vibration);
    return modal_damping(&builder->analysis->design.dynamics, number,
                         sqrt(builder->vibration->square[mode]));
}

/*
 * Compute the readings of the sensors per unit of one vibration mode, and store them as column `k`
 * of builder->reading [sensors][modes].
 *   scale in  factor that scales the mode shape, which has unit modal mass, to one unit of the
 *             modal coordinate
 */
static void fill_readings(builder *builder, size_t mode, size_t k, double scale)
{
    const design *design = &builder->analysis->design;
    const double *mode_shape = builder->vibration->shape + mode * (size_t)design->mesh.free_dof;
    const size_t modes = builder->model.modes;
    size_t sensor = 0;
    for (int reading = 0; reading < design->estimate.readings; reading++) {
        const int output = design->estimate.reading[reading].output;
        for (int row = design->named_first[output]; row < design->named_first[output + 1]; row++)
            builder->reading[sensor++ * modes + k] =
                pzs_model_observe_row(&design->structure, mode_shape, (uint32_t)row) * scale;
    }
}

/*
 * Compute the mode shapes at the outputs, the readings of the sensors and the modal coordinates in
 * equilibrium per volt for all observed vibration modes. A unit of a modal coordinate displaces the
 * outputs by a root mean square of 1.
 */
static void fill_modes(builder *builder)
{
    const design *design = &builder->analysis->design;
    const size_t modes = builder->model.modes;
    for (size_t k = 0; k < modes; k++) {
        const size_t mode = builder->mode[k];
        mode_shape(builder, mode, builder->column);
        const double size = rms(builder->column, builder->targets), scale = 1 / size;
        for (size_t i = 0; i < builder->targets; i++)
            builder->shape[i * modes + k] = builder->column[i] * scale;
        if (builder->estimator)
            fill_readings(builder, mode, k, scale);
        for (size_t j = 0; j < builder->amplifiers; j++)
            builder->modal[k * builder->amplifiers + j] =
                size * vibration_static(builder->vibration, design, (int)mode, (int)j);
        builder->angle[k] = angle_of(builder, mode);
        builder->ratio[k] = damping_ratio(builder, mode);
        builder->damper->frequency[k] = builder->vibration->frequency[mode];
    }
}

/*
 * Standard deviation of the noise of each sensor of the scene's `estimate` section.
 *   noise [sensors] out  standard deviations
 */
static void fill_noise(const builder *builder, double *noise)
{
    const design *design = &builder->analysis->design;
    const scene_estimate *estimate = &design->estimate;
    for (int reading = 0; reading < estimate->readings; reading++) {
        const int output = estimate->reading[reading].output;
        const int rows = design->named_first[output + 1] - design->named_first[output];
        for (int i = 0; i < rows; i++)
            *noise++ = estimate->reading[reading].noise;
    }
}

/*
 * Compute the weight of each sensor in the fit of vibration modes to readings. If the shape is
 * estimated from a few sensors, the weight is the inverse variance of the sensor's noise. If every
 * target node is measured, it is 1, or the squared target weight where the target has free
 * functions (shapes, such as a tilt, that may be added to it at no cost). All weights are then
 * scaled so that the weighted readings of a mode have a root mean square of about 1.
 */
static void fill_precision(builder *builder)
{
    const design *design = &builder->analysis->design;
    const size_t modes = builder->model.modes;
    const double *table = builder->estimator ? builder->reading : builder->shape;
    double sum = 0;
    if (builder->estimator)
        fill_noise(builder, builder->precision);
    for (size_t i = 0; i < builder->sensors; i++) {
        double *precision = &builder->precision[i];
        if (builder->estimator)
            *precision = 1 / (*precision * *precision);
        else
            *precision = design->free_functions > 0 ? design->weight[i] * design->weight[i] : 1;
        for (size_t k = 0; k < modes; k++)
            sum += *precision * table[i * modes + k] * table[i * modes + k];
    }
    const double mean = modes > 0 ? sum / (double)(modes * builder->sensors) : 1;
    for (size_t i = 0; i < builder->sensors; i++)
        builder->precision[i] /= mean;
}

/*
 * Compute three products of the observed vibration modes.
 *   overlap [modes][modes]   readings of two modes, summed over the sensors with their weights
 *   square  [modes]          squared mode shape, summed over the targets with squared weights
 *   lift    [inputs][modes] product of influence matrix and mode shape, summed over the targets
 *           with squared weights
 */
static void fill_products(builder *builder)
{
    const design *design = &builder->analysis->design;
    const size_t modes = builder->model.modes, inputs = builder->amplifiers;
    const double *table = builder->estimator ? builder->reading : builder->shape;
    for (size_t i = 0; i < builder->sensors; i++)
        for (size_t k = 0; k < modes; k++)
            for (size_t input = 0; input < modes; input++)
                builder->overlap[k * modes + input] +=
                    builder->precision[i] * table[i * modes + k] * table[i * modes + input];
    for (size_t i = 0; i < builder->targets; i++) {
        const double square = design->weight[i] * design->weight[i];
        for (size_t k = 0; k < modes; k++) {
            const double weighted = square * builder->shape[i * modes + k];
            builder->square[k] += weighted * builder->shape[i * modes + k];
            for (size_t j = 0; j < inputs; j++)
                builder->lift[j * modes + k] += weighted * design->influence[i * inputs + j];
        }
    }
}

/* ---- tables ----------------------------------------------------------- */

/*
 * Gain of the low-pass filter of the part of the readings that the observed vibration modes do not
 * explain. The gain is smaller where the first mode is not observed and its vibration decays
 * slowly.
 */
static double residual_gain(const builder *builder)
{
    const vibration *vibration = builder->vibration;
    const size_t first = (size_t)vibration_first(vibration);
    if (builder->model.modes > 0 || first >= (size_t)vibration->count)
        return builder->settings.slow;
    const double decay = damping_ratio(builder, first) * angle_of(builder, first);
    return fmin(slow_part * decay, slow_limit);
}

static void fill_tables(builder *builder)
{
    const design *design = &builder->analysis->design;
    const estimator *estimator = builder->estimator;
    const damper_gains *gains = &builder->gains;
    const bool is_weighted = estimator || design->free_functions > 0;
    const pzs_estimator none = {0};
    const pzs_estimator *readings = estimator ? &estimator->tables : &none;
    builder->damper->tables = (pzs_vibration){
        .scene = design->problem.scene,
        .inputs = (uint16_t)builder->amplifiers,
        .outputs = (uint16_t)builder->targets,
        .sensors = (uint16_t)builder->sensors,
        .modes = (uint16_t)builder->model.modes,
        .delay = (uint16_t)builder->delay,
        .shape = builder->shape,
        .direct = readings->direct,
        .gain = readings->gain,
        .modal = builder->modal,
        .turn = gains->turn,
        .observer = gains->observer,
        .explain = gains->explain,
        .damping = gains->damping,
        .inverse_angle = gains->inverse_angle,
        .share = gains->share,
        .mix = gains->mix,
        .slow = gains->slow,
        .lag = builder->model.lag > 0 ? gains->lag : NULL,
    };
    if (estimator)
        builder->damper->tables.reading = builder->reading;
    if (is_weighted)
        builder->damper->tables.precision = builder->precision;
    (void)pzs_vibration_seal(&builder->damper->tables);
}

/*
 * Tick interval over the time constant of the amplifiers' first-order lag; 0 where the control tick
 * needs not know of the lag: there is none, it is shorter than a tick, or no mode is observed.
 */
static double lag_of(const builder *builder)
{
    const double bandwidth = builder->analysis->design.simulate.imperfections.bandwidth;
    const double times = two_pi * bandwidth * builder->interval;
    return builder->model.modes > 0 && times < 1 ? times : 0;
}

static int build(builder *builder, char *error)
{
    const design *design = &builder->analysis->design;
    if (choose_modes(builder, error) < 0)
        return -1;
    if (take_memory(builder) < 0)
        return scene_fault(design->simulate.at, error, "out of memory");
    fill_modes(builder);
    fill_precision(builder);
    fill_products(builder);
    builder->settings.slow = residual_gain(builder);
    damper_model *model = &builder->model;
    model->inputs = builder->amplifiers;
    model->sensors = builder->sensors;
    model->angle = builder->angle;
    model->ratio = builder->ratio;
    model->modal = builder->modal;
    model->overlap = builder->overlap;
    model->lift = builder->lift;
    model->square = builder->square;
    model->lag = lag_of(builder);
    if (damper_compute(&builder->gains, model, &builder->settings) < 0)
        return scene_fault(design->simulate.at, error,
                           "the observer of %zu modes cannot be computed; add sensors or lower "
                           "the rate",
                           model->modes);
    fill_tables(builder);
    builder->damper->modes = (int)model->modes;
    const size_t first = (size_t)vibration_first(builder->vibration);
    builder->damper->has_slow_mode = first < (size_t)builder->vibration->count &&
                                     angle_of(builder, first) <= builder->settings.observed;
    builder->damper->is_used = true;
    return 0;
}

/*
 * Whether the tables for damping of vibration can be made for a control loop that needs them; if
 * not, the member `reason` of the damper says why.
 */
static bool is_possible(damper *damper, const analysis *analysis, const estimator *estimator)
{
    const design *design = &analysis->design;
    if (estimator && !design_reads_displacements(design))
        snprintf(damper->reason, sizeof damper->reason,
                 "a reading of the estimate is electric, which the damper does not observe");
    else if (design->simulate.delay > PZS_DELAY_LIMIT)
        snprintf(damper->reason, sizeof damper->reason,
                 "delay of %d ticks: at most %d; lower control.rate, so that it is fewer ticks",
                 design->simulate.delay, PZS_DELAY_LIMIT);
    return !damper->reason[0];
}

damper_options damper_options_of(const analysis *analysis)
{
    const certificate *certificate = &analysis->certificate;
    const damper_settings settings =
        certificate->has_settings ? certificate->settings : damper_default_settings();
    return (damper_options){certificate->rate, analysis->design.simulate.delay + settings.later,
                            settings};
}

int damper_make(damper *damper, const analysis *analysis, const estimator *estimator,
                const damper_options *options, char *error)
{
    const design *design = &analysis->design;
    memset(damper, 0, sizeof *damper);
    builder builder = {.damper = damper,
                       .analysis = analysis,
                       .estimator = estimator,
                       .vibration = &analysis->certificate.vibration,
                       .settings = options->settings,
                       .interval = 1 / options->rate,
                       .delay = options->delay,
                       .targets = (size_t)design->targets,
                       .amplifiers = (size_t)design->amplifiers};
    builder.sensors = estimator ? (size_t)estimator->sensors : builder.targets;
    damper->rate = options->rate;
    damper->fading_periods = options->settings.fading_periods;
    builder.mode = calloc(builder.amplifiers + 1, sizeof *builder.mode);
    builder.column = calloc(builder.targets + 1, sizeof *builder.column);
    const int failed = builder.mode && builder.column
                           ? build(&builder, error)
                           : scene_fault(design->simulate.at, error, "out of memory");
    free(builder.mode);
    free(builder.column);
    vibration_free(&builder.more);
    if (failed)
        damper_close(damper);
    return failed;
}

int damper_open(damper *damper, const analysis *analysis, const estimator *estimator, char *error)
{
    memset(damper, 0, sizeof *damper);
    if (analysis->quasi_static || analysis->design.gains.is_used ||
        !certificate_refuses(&analysis->certificate) || !is_possible(damper, analysis, estimator))
        return 0;
    const damper_options options = damper_options_of(analysis);
    return damper_make(damper, analysis, estimator, &options, error);
}

void damper_close(damper *damper)
{
    free(damper->memory);
    memset(damper, 0, sizeof *damper);
}

void damper_text(const damper *damper, char text[SCENE_ERROR])
{
    const int modes = damper->modes;
    if (modes == 0)
        snprintf(text, SCENE_ERROR,
                 "The tick follows the static optimum slowly, at %g ticks a second with readings "
                 "taken to be %u ticks old; %s.",
                 damper->rate, damper->tables.delay,
                 damper->has_slow_mode ? "no mode moves the target enough to be observed"
                                       : "every mode is too fast to be observed");
    else
        snprintf(text, SCENE_ERROR,
                 "The tick observes and damps vibration: %d mode%s from %.4g to %.4g Hz, at %g "
                 "ticks a second with readings taken to be %u ticks old.",
                 modes, modes == 1 ? "" : "s", damper->frequency[0], damper->frequency[modes - 1],
                 damper->rate, damper->tables.delay);
}
