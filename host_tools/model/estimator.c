/* SPDX-License-Identifier: BSD-2-Clause */
/* Gains for the estimation of the shape from a few sensors, and their errors (estimator.h). */
#include "estimator.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/modes/eigen.h"
#include "output_calls.h"
#include "../../lib/control/estimate.h"

enum { SWEEPS = 30, POWER = 300 };

/*
 * Intermediate results of the computation of the gains of the shape estimator. A disturbance is a
 * load or a deviation of an amplifier's voltage.
 */
typedef struct estimation {
    const analysis *analysis;
    size_t targets, amplifiers, loads, disturbances, sensors;
    double *sigma; /* [disturbances] standard deviations of the disturbances: first those of the
                      loads, then those of the amplifiers' voltages */
    double *sensitivity; /* [sensors][inputs] reading of each sensor per unit of each input */
    double *noise;       /* [sensors] standard deviation of the noise of each sensor */
    double *shape; /* [targets][disturbances] displacement of each target node times its target
                      weight, per standard deviation of each disturbance (load or voltage error) */
    double *scaled_reading; /* [sensors][disturbances] reading per standard deviation of each
                               disturbance (load or voltage error), divided by the sensor's noise */
    double *square; /* [sensors][sensors] covariance of the sensor readings, each divided by the
                       noise of its sensor, under the disturbances (loads and voltage errors); later
                       its eigenvalues on the diagonal */
    double *eigenvector; /* [sensors][sensors] eigenvectors, as columns, of the covariance of the
                            sensor readings, each reading divided by the noise of its sensor */
    double *target_part, *side, *direction,
        *rotated; /* work arrays. direction [targets]: weights of a weighted sum of target
                     displacements. target_part [disturbances]: value of this sum under each
                     disturbance. side [sensors]: right-hand side b, then solution x, of (1 + C) x =
                     b, where C is the covariance of the sensor readings, each divided by the noise
                     of its sensor. rotated [sensors]: coefficients of `side` for the eigenvectors
                     of C */
} estimation;

static int allocate(estimation *estimation)
{
    const size_t inputs = estimation->analysis->design.structure.input.count;
    estimation->sigma = calloc(estimation->disturbances + 1, sizeof *estimation->sigma);
    estimation->sensitivity =
        calloc(estimation->sensors * inputs + 1, sizeof *estimation->sensitivity);
    estimation->noise = calloc(estimation->sensors + 1, sizeof *estimation->noise);
    estimation->shape =
        calloc(estimation->targets * estimation->disturbances + 1, sizeof *estimation->shape);
    estimation->scaled_reading = calloc(estimation->sensors * estimation->disturbances + 1,
                                        sizeof *estimation->scaled_reading);
    estimation->square =
        calloc(estimation->sensors * estimation->sensors + 1, sizeof *estimation->square);
    estimation->eigenvector =
        calloc(estimation->sensors * estimation->sensors + 1, sizeof *estimation->eigenvector);
    estimation->target_part = calloc(estimation->disturbances + 1, sizeof *estimation->target_part);
    estimation->side = calloc(estimation->sensors + 1, sizeof *estimation->side);
    estimation->direction = calloc(estimation->targets + 1, sizeof *estimation->direction);
    estimation->rotated = calloc(estimation->sensors + 1, sizeof *estimation->rotated);
    return estimation->sigma && estimation->sensitivity && estimation->noise && estimation->shape &&
           estimation->scaled_reading && estimation->square && estimation->eigenvector &&
           estimation->target_part && estimation->side && estimation->direction &&
           estimation->rotated;
}

static void release(estimation *estimation)
{
    double *const all[] = {estimation->sigma,       estimation->sensitivity,    estimation->noise,
                           estimation->shape,       estimation->scaled_reading, estimation->square,
                           estimation->eigenvector, estimation->target_part,    estimation->side,
                           estimation->direction,   estimation->rotated};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
}

/* ---- disturbances and readings ---------------------------------------- */

/*
 * Index of the input that belongs to a disturbance. The first disturbances are loads, whose inputs
 * follow those of the amplifiers.
 */
static size_t input_of(const estimation *estimation, size_t disturbance)
{
    return disturbance < estimation->loads ? estimation->amplifiers + disturbance
                                           : disturbance - estimation->loads;
}

/*
 * Standard deviation of the voltage of an amplifier where the scene file gives none: a tenth of
 * half the range between its limits, or 1 V without limits.
 */
static double default_deviation(const design *design, size_t amplifier)
{
    const double half = (design->upper[amplifier] - design->lower[amplifier]) / 2;
    return isfinite(half) ? half / 10 : 1;
}

static void find_sizes(estimation *estimation)
{
    const design *design = &estimation->analysis->design;
    const scene_estimate *settings = &design->estimate;
    const size_t loads = estimation->loads;
    for (size_t i = 0; i < loads; i++)
        estimation->sigma[i] = settings->loads;
    for (size_t i = loads; i < estimation->disturbances; i++)
        estimation->sigma[i] =
            settings->voltages >= 0 ? settings->voltages : default_deviation(design, i - loads);
}

/*
 * Compute the readings of all sensors per unit of one input. Displacements are taken from the
 * influence matrix; for voltages and charges, the voltages of the open electrodes under this input
 * are computed first.
 */
static int fill_sensitivity(estimation *estimation, size_t input, double *value, double *charge)
{
    const analysis *analysis = estimation->analysis;
    const design *design = &analysis->design;
    const size_t inputs = design->structure.input.count;
    const output_state state = {.design = design, .input_value = value, .charge = charge};
    size_t row = 0;
    memset(value, 0, inputs * sizeof *value);
    value[input] = 1;
    if (analysis->electric.state.model &&
        (pzs_open_voltages(&analysis->electric, value) != PZS_OK ||
         pzs_charges(&analysis->electric, value, charge) != PZS_OK))
        return -1;
    for (int index = 0; index < design->estimate.readings; index++) {
        const int k = design->estimate.reading[index].output;
        const scene_output *output = &design->output[k];
        for (int i = 0; i < analysis_outputs(analysis, k); i++, row++) {
            double *reading = &estimation->sensitivity[row * inputs + input];
            if (output_has_rows(output))
                *reading =
                    analysis->influence[(size_t)(design->named_first[k] + i) * inputs + input];
            else
                *reading = output_calls_of(output)->value(&state, k, i);
            estimation->noise[row] = design->estimate.reading[index].noise;
        }
    }
    return 0;
}

static int fill_sensitivities(estimation *estimation)
{
    const size_t inputs = estimation->analysis->design.structure.input.count;
    double *value = calloc(inputs, sizeof *value),
           *charge = calloc(estimation->analysis->design.electrodes.count + 1u, sizeof *charge);
    int failed = !value || !charge;
    for (size_t i = 0; !failed && i < estimation->amplifiers + estimation->loads; i++)
        failed = fill_sensitivity(estimation, i, value, charge);
    free(value);
    free(charge);
    return failed ? -1 : 0;
}

/*
 * For each disturbance (load or voltage error) of one standard deviation, compute the displacements
 * of the target nodes times the target weights, and the sensor readings divided by the noise of the
 * sensors. Also compute the covariance of these readings.
 */
static void form_covariance(estimation *estimation)
{
    const design *design = &estimation->analysis->design;
    const size_t inputs = design->structure.input.count;
    for (size_t j = 0; j < estimation->disturbances; j++) {
        for (size_t i = 0; i < estimation->targets; i++)
            estimation->shape[i * estimation->disturbances + j] =
                design->weight[i] *
                estimation->analysis->influence[i * inputs + input_of(estimation, j)] *
                estimation->sigma[j];
        for (size_t i = 0; i < estimation->sensors; i++)
            estimation->scaled_reading[i * estimation->disturbances + j] =
                estimation->sensitivity[i * inputs + input_of(estimation, j)] *
                estimation->sigma[j] / estimation->noise[i];
    }
    for (size_t i = 0; i < estimation->sensors; i++)
        for (size_t sensor = 0; sensor < estimation->sensors; sensor++)
            for (size_t j = 0; j < estimation->disturbances; j++)
                estimation->square[i * estimation->sensors + sensor] +=
                    estimation->scaled_reading[i * estimation->disturbances + j] *
                    estimation->scaled_reading[sensor * estimation->disturbances + j];
}

/* ---- eigenvalues ------------------------------------------------------ */

/*
 * Compute eigenvalues and eigenvectors of the covariance of the sensor readings, each reading
 * divided by the noise of its sensor. The eigenvalues replace the diagonal of the matrix `square`;
 * the eigenvectors are stored in `eigenvector`.
 */
static void diagonalise(estimation *estimation)
{
    pzs_eigen_symmetric(estimation->square, estimation->eigenvector, estimation->sensors, SWEEPS,
                        0);
}

static double eigenvalue(const estimation *estimation, size_t i)
{
    return fmax(estimation->square[i * estimation->sensors + i], 0);
}

/*
 * Solve (1 + C) x = side by the eigenvectors of C, and store x in `side` [sensors]. C is the
 * covariance that the disturbances (loads and voltage errors) cause between the sensor readings,
 * each reading divided by the noise of its sensor.
 */
static void apply_filter(estimation *estimation)
{
    const size_t sensors = estimation->sensors;
    for (size_t row = 0; row < sensors; row++) {
        estimation->rotated[row] = 0;
        for (size_t i = 0; i < sensors; i++)
            estimation->rotated[row] +=
                estimation->eigenvector[i * sensors + row] * estimation->side[i];
        estimation->rotated[row] /= 1 + eigenvalue(estimation, row);
    }
    for (size_t i = 0; i < sensors; i++) {
        estimation->side[i] = 0;
        for (size_t row = 0; row < sensors; row++)
            estimation->side[i] +=
                estimation->eigenvector[i * sensors + row] * estimation->rotated[row];
    }
}

/* ---- gains ------------------------------------------------------------ */

/*
 * Compute the gains of the shape estimator, one row for each controlled displacement, and the
 * sensor readings per volt and per unit of each load.
 */
static void make_gains(estimation *estimation, estimator *estimator)
{
    const size_t inputs = estimation->analysis->design.structure.input.count;
    for (size_t i = 0; i < estimation->targets; i++) {
        for (size_t k = 0; k < estimation->sensors; k++) {
            estimation->side[k] = 0;
            for (size_t j = 0; j < estimation->disturbances; j++)
                estimation->side[k] +=
                    estimation->analysis->influence[i * inputs + input_of(estimation, j)] *
                    estimation->sigma[j] *
                    estimation->scaled_reading[k * estimation->disturbances + j];
        }
        apply_filter(estimation);
        for (size_t k = 0; k < estimation->sensors; k++)
            estimator->gain[i * estimation->sensors + k] =
                estimation->side[k] / estimation->noise[k];
    }
    for (size_t k = 0; k < estimation->sensors; k++) {
        memcpy(estimator->direct + k * estimation->amplifiers, estimation->sensitivity + k * inputs,
               estimation->amplifiers * sizeof *estimator->direct);
        memcpy(estimator->reading_per_load + k * estimation->loads,
               estimation->sensitivity + k * inputs + estimation->amplifiers,
               estimation->loads * sizeof *estimator->reading_per_load);
    }
}

/*
 * Subtract from a combination x of disturbances (loads and voltage errors) the part that the shape
 * estimator infers from the sensor readings: x - C'(1 + C C')^-1 C x with C = scaled_reading
 * [sensors][disturbances].
 *   left [disturbances] in   combination x
 *                     out  part of x that is not known
 */
static void remove_observed_part(estimation *estimation, double *left)
{
    for (size_t k = 0; k < estimation->sensors; k++) {
        estimation->side[k] = 0;
        for (size_t j = 0; j < estimation->disturbances; j++)
            estimation->side[k] +=
                estimation->scaled_reading[k * estimation->disturbances + j] * left[j];
    }
    apply_filter(estimation);
    for (size_t j = 0; j < estimation->disturbances; j++)
        for (size_t k = 0; k < estimation->sensors; k++)
            left[j] -=
                estimation->scaled_reading[k * estimation->disturbances + j] * estimation->side[k];
}

/*
 * Compute the scalar products of a vector `direction` [targets] with the shapes of all disturbances
 * (loads and voltage errors), weighted with the target weights. They are stored in target_part
 * [disturbances]. Returns their norm.
 */
static double project_to_disturbances(estimation *estimation, const double *direction)
{
    double sum = 0;
    for (size_t j = 0; j < estimation->disturbances; j++) {
        estimation->target_part[j] = 0;
        for (size_t i = 0; i < estimation->targets; i++)
            estimation->target_part[j] +=
                estimation->shape[i * estimation->disturbances + j] * direction[i];
        sum += estimation->target_part[j] * estimation->target_part[j];
    }
    return sqrt(sum);
}

static double length(const double *vector, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += vector[i] * vector[i];
    return sqrt(sum);
}

/*
 * Compute two expected norms under the disturbances (loads and voltage errors): that of the
 * weighted shape, and that of the weighted error of its estimate. Each is the square root of the
 * trace of a covariance.
 */
static void measure_errors(estimation *estimation, estimator *estimator)
{
    double all = 0, left = 0;
    for (size_t i = 0; i < estimation->targets; i++) {
        const double *row = estimation->shape + i * estimation->disturbances;
        memcpy(estimation->target_part, row, estimation->disturbances * sizeof *row);
        remove_observed_part(estimation, estimation->target_part);
        for (size_t j = 0; j < estimation->disturbances; j++) {
            all += row[j] * row[j];
            left += row[j] * estimation->target_part[j];
        }
    }
    estimator->disturbed = sqrt(all);
    estimator->remaining = sqrt(fmax(left, 0));
}

/*
 * Find the shape in which the error of the estimated shape is largest, by the power method
 * (repeated multiplication with the covariance of the error).
 */
static void find_worst(estimation *estimation, estimator *estimator)
{
    for (size_t i = 0; i < estimation->targets; i++)
        estimation->direction[i] = 1 + (double)i / (double)estimation->targets;
    for (int turn = 0; turn < POWER; turn++) {
        const double size = length(estimation->direction, estimation->targets);
        for (size_t i = 0; i < estimation->targets; i++)
            estimation->direction[i] /= size > 0 ? size : 1;
        estimator->worst_disturbed = project_to_disturbances(estimation, estimation->direction);
        remove_observed_part(estimation, estimation->target_part);
        for (size_t i = 0; i < estimation->targets; i++) {
            estimation->direction[i] = 0;
            for (size_t j = 0; j < estimation->disturbances; j++)
                estimation->direction[i] += estimation->shape[i * estimation->disturbances + j] *
                                            estimation->target_part[j];
        }
        estimator->worst_remaining = sqrt(length(estimation->direction, estimation->targets));
    }
    const design *design = &estimation->analysis->design;
    for (size_t i = 0; i < estimation->targets; i++) {
        estimator->worst[i] =
            design->weight[i] > 0 ? estimation->direction[i] / design->weight[i] : 0;
        if (fabs(estimator->worst[i]) > fabs(estimator->worst[estimator->worst_target]))
            estimator->worst_target = (int)i;
    }
    const double most = estimator->worst[estimator->worst_target];
    for (size_t i = 0; i < estimation->targets && fabs(most) > 0; i++)
        estimator->worst[i] /= most;
}

static void measure_sensors(const estimation *estimation, estimator *estimator)
{
    double least = HUGE_VAL, most = 0;
    for (size_t i = 0; i < estimation->sensors; i++) {
        const double clear = sqrt(eigenvalue(estimation, i));
        most = fmax(most, clear);
        least = clear > 1 ? fmin(least, clear) : least;
        estimator->rank += clear > 1;
    }
    estimator->condition = estimator->rank > 0 ? most / least : HUGE_VAL;
}

/* ---- open ------------------------------------------------------------- */

static int no_memory(const analysis *analysis, char *error)
{
    return scene_fault(analysis->design.estimate.at, error,
                       "the estimator does not fit into memory; use fewer target nodes");
}

static void fill_tables(estimator *estimator, const design *design)
{
    const pzs_problem *problem = &design->problem;
    const pzs_estimator tables = {problem->format,   problem->scene,   0,
                                  problem->inputs,   problem->outputs, (uint16_t)estimator->sensors,
                                  estimator->direct, estimator->gain};
    const pzs_feed_forward_table known = {
        problem->format,         problem->scene,   0,
        (uint16_t)design->loads, problem->outputs, estimator->shape_per_load};
    const pzs_feed_forward_table shown = {problem->format,
                                          problem->scene,
                                          0,
                                          (uint16_t)design->loads,
                                          (uint16_t)estimator->sensors,
                                          estimator->reading_per_load};
    estimator->tables = tables;
    estimator->tables.crc = estimator->sensors > 0 ? pzs_estimate_crc(&tables) : 0;
    estimator->shape_table = known;
    estimator->shape_table.crc = pzs_estimate_known_crc(&known);
    estimator->reading_table = shown;
    estimator->reading_table.crc = pzs_estimate_known_crc(&shown);
}

static int check_observability(const estimator *estimator, const analysis *analysis, char *error)
{
    const scene_estimate *settings = &analysis->design.estimate;
    char text[SCENE_ERROR];
    if (!(estimator->disturbed > 0))
        return scene_fault(
            settings->at, error,
            "nothing disturbs the shape: the standard deviations of all loads and voltages are "
            "0; give a load, or a voltage deviation above 0");
    if (!(estimator->remaining > settings->tolerance * estimator->disturbed))
        return 0;
    estimator_text(estimator, analysis, text);
    return scene_fault(
        settings->at, error,
        "these readings do not determine the shape: %s; add a reading there, or raise tolerance",
        text);
}

static int build_estimator(estimation *estimation, estimator *estimator, char *error)
{
    const design *design = &estimation->analysis->design;
    const size_t inputs = design->structure.input.count;
    estimator->shape_per_load =
        calloc(estimation->targets * estimation->loads + 1, sizeof *estimator->shape_per_load);
    estimator->reading_per_load =
        calloc(estimation->sensors * estimation->loads + 1, sizeof *estimator->reading_per_load);
    estimator->direct =
        calloc(estimation->sensors * estimation->amplifiers + 1, sizeof *estimator->direct);
    estimator->gain =
        calloc(estimation->targets * estimation->sensors + 1, sizeof *estimator->gain);
    estimator->worst = calloc(estimation->targets + 1, sizeof *estimator->worst);
    if (!estimator->shape_per_load || !estimator->reading_per_load || !estimator->direct ||
        !estimator->gain || !estimator->worst || !allocate(estimation))
        return no_memory(estimation->analysis, error);
    for (size_t i = 0; i < estimation->targets; i++)
        memcpy(estimator->shape_per_load + i * estimation->loads,
               estimation->analysis->influence + i * inputs + estimation->amplifiers,
               estimation->loads * sizeof *estimator->shape_per_load);
    if (estimation->sensors > 0) {
        find_sizes(estimation);
        if (fill_sensitivities(estimation) < 0)
            return no_memory(estimation->analysis, error);
        form_covariance(estimation);
        diagonalise(estimation);
        make_gains(estimation, estimator);
        measure_errors(estimation, estimator);
        find_worst(estimation, estimator);
        measure_sensors(estimation, estimator);
    }
    fill_tables(estimator, design);
    return estimation->sensors > 0 ? check_observability(estimator, estimation->analysis, error)
                                   : 0;
}

int estimator_open(estimator *estimator, const analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    estimation estimation = {.analysis = analysis,
                             .targets = (size_t)design->targets,
                             .amplifiers = (size_t)design->amplifiers,
                             .loads = (size_t)design->loads,
                             .disturbances = (size_t)(design->loads + design->amplifiers)};
    memset(estimator, 0, sizeof *estimator);
    for (int reading = 0; reading < design->estimate.readings; reading++)
        estimation.sensors +=
            (size_t)analysis_outputs(analysis, design->estimate.reading[reading].output);
    estimator->sensors = (int)estimation.sensors;
    estimator->disturbances = (int)estimation.disturbances;
    const int failed = build_estimator(&estimation, estimator, error);
    release(&estimation);
    if (failed)
        estimator_close(estimator);
    return failed;
}

void estimator_close(estimator *estimator)
{
    free(estimator->direct);
    free(estimator->gain);
    free(estimator->shape_per_load);
    free(estimator->reading_per_load);
    free(estimator->worst);
    memset(estimator, 0, sizeof *estimator);
}

void estimator_text(const estimator *estimator, const analysis *analysis, char text[SCENE_ERROR])
{
    const mesh *mesh = &analysis->design.mesh;
    const int worst = analysis->design.target_node[estimator->worst_target];
    snprintf(text, SCENE_ERROR,
             "%d sensors distinguish %d of %d disturbances from noise (condition %.1e) and leave "
             "%.1f%% of the shape "
             "unobserved; worst direction unobserved by %.0f%%, largest at %s",
             estimator->sensors, estimator->rank, estimator->disturbances, estimator->condition,
             100 * estimator->remaining / estimator->disturbed,
             100 * estimator->worst_remaining / estimator->worst_disturbed,
             mesh_node_text(mesh, worst).text);
}
