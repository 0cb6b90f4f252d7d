/* SPDX-License-Identifier: BSD-2-Clause */
/* Growth of a control loop whose influence matrix has errors (matrix_errors.h). */
#include "matrix_errors.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../model/certificate.h"
#include "random.h"
#include "storm_state.h"

enum {
    SEEDS = 16,   /* number of random sequences of errors */
    HALVINGS = 9, /* number of bisections */
    JUMPS = 10,   /* number of jumps of the target */
    FIRST = 8     /* number of rounds whose largest change of the voltages is the reference of the
                     growth */
};

/* Smallest standard deviation of the relative errors that is tried. */
static const double least = 1e-4;

/* Factor of growth or decay at which a simulation ends. */
static const double enough = 1e6;

/*
 * Smallest growth, as a logarithm over the whole simulation, that is distinguished from none (as in
 * trial_has_passed of certify_trial.h).
 */
static const double least_growth = 0.25;

/*
 * Largest movement of the shape that counts as rest, relative to the unit of shape errors
 * (rig->scale).
 */
static const double rest_tolerance = CERTIFICATE_TOLERANCE;

/* ---- structure with errors --------------------------------------------- */

/* The matrix of a rig that holds the static response of its readings to the amplifiers. */
static tick_matrix *wrong_matrix(storm_rig *wrong)
{
    return wrong->estimator ? &wrong->static_reading : &wrong->static_shape;
}

/*
 * Copy a rig, and multiply the static response of each of its readings to each amplifier by a
 * random factor near 1. The copy shares all but these responses with the original; only the matrix
 * returned by wrong_matrix is its own. Returns false where memory runs out.
 */
static bool open_wrong(storm_rig *wrong, const storm_rig *rig, double scatter, uint64_t seed)
{
    const double *right = rig->estimator ? rig->direct : rig->influence;
    const size_t entries = rig->sensors * rig->amplifiers;
    double *matrix = malloc((entries + 1) * sizeof *matrix);
    uint64_t random = seed;
    *wrong = *rig;
    memset(wrong_matrix(wrong), 0, sizeof(tick_matrix));
    if (!matrix)
        return false;
    for (size_t i = 0; i < entries; i++)
        matrix[i] = right[i] * (1 + scatter * random_noise(&random));
    const bool fits = tick_matrix_open(wrong_matrix(wrong), matrix, rig->amplifiers, NULL,
                                       rig->sensors, rig->amplifiers);
    free(matrix);
    return fits;
}

/* ---- growth without limits ----------------------------------------------- */

/* Logarithm of the norm of the change of the voltages in the last tick. */
static double log_change(const storm *storm)
{
    double squares = 0;
    for (size_t k = 0; k < storm->rig->amplifiers; k++) {
        const double change = storm->voltage[k] - storm->previous_voltage[k];
        squares += change * change;
    }
    return log(fmax(sqrt(squares), 1e-300));
}

/*
 * Run the ticks of a round: as many as a reading is old, and one. With late readings a loop without
 * a damper consists of so many independent ones, which take turns; one alone has been moved.
 *   size out  logarithm of the largest change of the voltages
 */
static pzs_status run_round(storm *storm, double *size)
{
    pzs_status status = PZS_OK;
    *size = -HUGE_VAL;
    for (int k = 0; k <= storm->rig->delay && !PZS_IS_ERROR(status); k++) {
        status = storm_tick(storm);
        *size = fmax(*size, log_change(storm));
    }
    return status;
}

/*
 * Let the voltages follow a random target for one tick, then a zero target. Every direction of the
 * voltages is then moved, the weakest ones most.
 *   size [ticks] out  work array: logarithms of the changes of the voltages in each round
 *   grows        out  whether they grow in the second half
 */
static pzs_status run_free(storm *storm, int ticks, double *size, bool *grows)
{
    const storm_rig *rig = storm->rig;
    const int most = ticks / (rig->delay + 1);
    double reference = -HUGE_VAL;
    int count = 0;
    for (size_t i = 0; i < rig->targets; i++)
        storm->target[i] = 1e-3 * rig->scale * random_noise(&storm->random);
    pzs_status status = storm_tick(storm);
    memset(storm->target, 0, rig->targets * sizeof *storm->target);
    bool is_clear = false;
    while (count < most && !is_clear && !PZS_IS_ERROR(status)) {
        status = run_round(storm, &size[count]);
        if (count < FIRST)
            reference = fmax(reference, size[count]);
        else
            is_clear = fabs(size[count] - reference) > log(enough);
        count++;
    }
    *grows = storm_slope(size + count / 2, count - count / 2) > least_growth / most;
    return PZS_IS_ERROR(status) ? status : PZS_OK;
}

/* ---- limit cycles -------------------------------------------------------- */

/* Set the target to the shape under random voltages of up to twice the limits. */
static void jump(storm *storm)
{
    const storm_rig *rig = storm->rig;
    double *voltage = storm->previous_voltage;
    for (size_t k = 0; k < rig->amplifiers; k++)
        voltage[k] =
            2 * (rig->lower[k] + random_uniform(&storm->random) * (rig->upper[k] - rig->lower[k]));
    tick_matrix_multiply(&rig->static_shape, voltage, storm->target);
}

/*
 * Let the target jump, then rest at that of the scene, within the limits of the voltages.
 *   work [targets] out  work array: a shape
 *   grows          out  whether the shape still moves at the end
 */
static pzs_status run_limited(storm *storm, int ticks, double *work, bool *grows)
{
    const storm_rig *rig = storm->rig;
    const int interval = ticks / (4 * JUMPS), jumps = JUMPS * interval, last = ticks * 3 / 4;
    double moved = 0;
    for (int k = 0; k < ticks; k++) {
        if (k < jumps && k % interval == 0)
            jump(storm);
        if (k == jumps)
            memcpy(storm->target, storm->last_target, rig->targets * sizeof *storm->target);
        const pzs_status status = storm_tick(storm);
        if (PZS_IS_ERROR(status))
            return status;
        if (k < last)
            continue;
        storm_compute_shape(storm);
        if (k == last)
            memcpy(work, storm->shape, rig->targets * sizeof *work);
        moved = fmax(moved, storm_distance(storm, storm->shape, work));
    }
    *grows = !(moved <= rest_tolerance * rig->scale);
    return PZS_OK;
}

/* ---- one structure ------------------------------------------------------- */

/*
 * Run one simulation on a structure whose matrix has errors. Returns 0, or -1 with error filled.
 *   is_limited in  true: with the limits of the voltages; false: without
 */
static int run(const storm_rig *rig, bool is_limited, uint64_t seed, int ticks, bool *grows,
               char *error)
{
    const storm_plant plant = {
        .gain = 1, .frequency = 1, .step_limit = is_limited ? 1 : HUGE_VAL, .seed = seed};
    storm storm;
    double *work = malloc(((size_t)ticks + rig->targets) * sizeof *work);
    int failed = storm_begin(&storm, rig, &plant, error);
    if (!failed && !work)
        failed = storm_no_memory(rig->analysis, error);
    if (!failed) {
        const pzs_status status = (is_limited ? run_limited : run_free)(&storm, ticks, work, grows);
        failed = PZS_IS_ERROR(status) ? storm_explain(&storm, status, error) : 0;
    }
    storm_end(&storm);
    free(work);
    return failed;
}

int matrix_errors_try(const matrix_errors *errors, double scatter, uint64_t seed, bool *grows,
                      char *error)
{
    const int ticks = errors->ticks;
    storm_rig wrong;
    int failed = open_wrong(&wrong, errors->rig, scatter, seed)
                     ? 0
                     : storm_no_memory(errors->rig->analysis, error);
    failed = failed || run(&wrong, false, seed, ticks, grows, error) < 0;
    if (!failed && !*grows && errors->is_limited)
        failed = run(&wrong, true, seed, ticks, grows, error) < 0;
    tick_matrix_close(wrong_matrix(&wrong));
    return failed ? -1 : 0;
}

/* ---- margin ------------------------------------------------------------- */

/*
 * Reduce the margin to the largest standard deviation of the errors at which the loop does not grow
 * with one random sequence of errors. Returns 0, or -1 with error filled.
 */
static int reduce_margin(const matrix_errors *errors, uint64_t seed, double *margin, char *error)
{
    double stable = least, unstable = *margin;
    bool grows;
    if (matrix_errors_try(errors, unstable, seed, &grows, error) < 0)
        return -1;
    if (!grows)
        return 0;
    if (matrix_errors_try(errors, stable, seed, &grows, error) < 0)
        return -1;
    for (int i = 0; i < HALVINGS && !grows; i++) {
        const double scatter = sqrt(stable * unstable);
        bool grows_here;
        if (matrix_errors_try(errors, scatter, seed, &grows_here, error) < 0)
            return -1;
        if (grows_here)
            unstable = scatter;
        else
            stable = scatter;
    }
    *margin = grows ? 0 : stable;
    return 0;
}

/* Whether every voltage has finite limits. */
static bool has_limits(const storm_rig *rig)
{
    const design *design = &rig->analysis->design;
    for (size_t k = 0; k < rig->amplifiers; k++)
        if (!isfinite(design->upper[k] - design->lower[k]))
            return false;
    return true;
}

int matrix_errors_margin(const storm_rig *rig, int ticks, double *margin, bool *is_unstable,
                         char *error)
{
    matrix_errors errors = {.rig = rig, .ticks = ticks};
    bool moves = true;
    if (has_limits(rig) && run(rig, true, 1, ticks, &moves, error) < 0)
        return -1;
    errors.is_limited = !moves;
    *is_unstable = false;
    *margin = CERTIFICATE_MATRIX_MOST;
    for (uint64_t seed = 1; seed <= SEEDS && *margin > 0; seed++)
        if (reduce_margin(&errors, seed, margin, error) < 0)
            return -1;
    return *margin > 0 ? 0 : run(rig, false, 1, ticks, is_unstable, error);
}
