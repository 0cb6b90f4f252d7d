/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tables of the gains and leaks of modes (modal_gains.h). H is the Hessian of the voltage
 * optimisation problem, B'W^2 B + regularisation I, over the amplifiers that are not held at one
 * voltage. A mode is a vector p_k of voltages. The modes are orthonormal in H: p_i'H p_k is 1
 * if i and k are equal, otherwise 0. They are
 *   - eigenvectors of B'W^2 B, which are the right singular vectors of W B;
 *   - or least-squares voltages for the functions of the scene, orthonormalised in their order.
 */
#include "modal_gains.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "cholesky.h"
#include "dense.h"
#include "design.h"
#include "../../lib/modes/eigen.h"
#include "eigen.h"

enum {
    SWEEPS = 40,     /* largest number of sweeps of the eigenvalue solver over the matrix */
    SQUARINGS = 40,  /* number of squarings from which a growth factor is computed */
    BISECTIONS = 50, /* number of halvings of an interval of gains */
    MOST_DELAY = 64  /* largest delay for which a growth factor is computed (ticks) */
};

/*
 * A function of the scene is refused as a mode in two cases. The remainder of its voltages, after
 * removal of the components along earlier modes, has less than least_part of its norm. Or the
 * actuators can make less than least_made of the function (norm over that of the function).
 */
static const double least_part = 1e-6, least_made = 1e-3;

/*
 * Rank test: an eigenvalue counts as 0 if it is below this number times DBL_EPSILON times the
 * number of eigenvalues, relative to the largest eigenvalue.
 */
static const double rank_floor = 16;

/* Smallest diagonal term, over the mean diagonal entry, that keeps the Hessian invertible. */
static const double least_regularisation = 1e-13;

/* Modes of the voltages, and the work arrays with which they are computed. */
typedef struct builder {
    const design *design;
    const scene_modal_gains *scene;
    size_t *amplifier; /* [moving] amplifiers that are not held at one voltage */
    size_t moving, modes;
    double *hessian; /* [moving][moving] Hessian H of the voltage optimisation problem */
    double *work;    /* [moving][moving] work matrix: eigenvalues on its diagonal, or the Cholesky
                        factor of H */
    double *vector;  /* [moving][moving] eigenvectors as columns */
    double *column;  /* [targets] a function of the scene at the target nodes */
    double *pattern; /* [modes][moving] voltages of each mode */
    double *effect;  /* [modes][moving] product of the Hessian H and the voltages of each mode */
    double *left; /* [modes] for a mode made from a function: norm of what the actuators cannot make
                     of the function, over its norm */
} builder;

/* ---- Hessian -------------------------------------------------------------- */

static double influence_at(const builder *builder, size_t target, size_t k)
{
    const design *design = builder->design;
    return design->influence[target * (size_t)design->amplifiers + builder->amplifier[k]];
}

/* Compute the Hessian B'W^2 B, still without the regularisation (influence matrix B, weights W). */
static void fill_hessian(builder *builder)
{
    const design *design = builder->design;
    const size_t n = builder->moving;
    for (size_t target = 0; target < (size_t)design->targets; target++)
        for (size_t j = 0; j < n; j++) {
            const double factor =
                design->weight[target] * design->weight[target] * influence_at(builder, target, j);
            for (size_t k = 0; k < n && fabs(factor) > 0; k++)
                builder->hessian[j * n + k] += factor * influence_at(builder, target, k);
        }
}

static void multiply(const builder *builder, const double *voltage, double *product)
{
    const size_t n = builder->moving;
    for (size_t j = 0; j < n; j++) {
        product[j] = 0;
        for (size_t k = 0; k < n; k++)
            product[j] += builder->hessian[j * n + k] * voltage[k];
    }
}

/* ---- singular vectors ------------------------------------------------------ */

/* Return the index of the largest eigenvalue that no earlier mode has taken, and mark it taken. */
static size_t take_largest(const builder *builder, bool *is_taken)
{
    const size_t n = builder->moving;
    size_t best = n;
    for (size_t k = 0; k < n; k++)
        if (!is_taken[k] &&
            (best == n || builder->work[k * n + k] > builder->work[best * n + best]))
            best = k;
    is_taken[best] = true;
    return best;
}

/*
 * Set the voltages of a mode to an eigenvector, whose entry of largest size is made positive, so
 * that its sign does not depend on the solver.
 */
static void take_vector(builder *builder, size_t mode, size_t index)
{
    const size_t n = builder->moving;
    const double size =
        sqrt(fmax(builder->work[index * n + index], 0) + builder->design->problem.regularisation);
    double *pattern = builder->pattern + mode * n;
    size_t most = 0;
    for (size_t k = 0; k < n; k++) {
        pattern[k] = builder->vector[k * n + index];
        most = fabs(pattern[k]) > fabs(pattern[most]) ? k : most;
    }
    const double scale = (pattern[most] < 0 ? -1 : 1) / size;
    for (size_t k = 0; k < n; k++)
        pattern[k] *= scale;
}

/*
 * Make the modes from singular vectors of the influence matrix. Returns 0, or -1 with error filled
 * where it has too few.
 */
static int make_vectors(builder *builder, bool *is_taken, char *error)
{
    const size_t n = builder->moving;
    double largest = 0;
    memcpy(builder->work, builder->hessian, n * n * sizeof *builder->work);
    for (size_t k = 0; k < n; k++)
        largest = fmax(largest, builder->work[k * n + k]);
    pzs_eigen_symmetric(builder->work, builder->vector, n, SWEEPS,
                        DBL_EPSILON * DBL_EPSILON * largest);
    for (size_t mode = 0; mode < builder->modes; mode++) {
        const size_t index = take_largest(builder, is_taken);
        const double value = builder->work[index * n + index];
        largest = mode == 0 ? value : largest;
        if (!(value > rank_floor * DBL_EPSILON * (double)n * largest))
            return scene_fault(builder->scene->at, error,
                               "modes: %zu modes, but the influence matrix has rank %zu; write at "
                               "most %zu",
                               builder->modes, mode, mode);
        take_vector(builder, mode, index);
    }
    return 0;
}

/* ---- functions --------------------------------------------------------------- */

/*
 * Replace builder->work by the Cholesky factor of the Hessian H. A small multiple of the trace is
 * added to its diagonal first, so that rounding errors cannot make H indefinite.
 */
static bool factor_hessian(builder *builder)
{
    const size_t n = builder->moving;
    double *a = builder->work, trace = 0;
    memcpy(a, builder->hessian, n * n * sizeof *a);
    for (size_t k = 0; k < n; k++)
        trace += a[k * n + k];
    for (size_t k = 0; k < n; k++)
        a[k * n + k] += least_regularisation * trace;
    return cholesky_factor(a, n);
}

/*
 * Compute the voltages that approximate a function, given by its values at the target nodes in
 * builder->column, by least squares. Returns the norm of the misfit over that of the function; 1
 * for a function that is 0 at all nodes.
 */
static double fit(builder *builder, double *voltage)
{
    const design *design = builder->design;
    const size_t n = builder->moving;
    double all = 0, misfit = 0;
    for (size_t k = 0; k < n; k++)
        voltage[k] = 0;
    for (size_t i = 0; i < (size_t)design->targets; i++) {
        const double weighted = design->weight[i] * design->weight[i] * builder->column[i];
        all += weighted * builder->column[i];
        for (size_t k = 0; k < n; k++)
            voltage[k] += weighted * influence_at(builder, i, k);
    }
    cholesky_solve(builder->work, n, voltage);
    for (size_t i = 0; i < (size_t)design->targets; i++) {
        double difference = builder->column[i];
        for (size_t k = 0; k < n; k++)
            difference -= voltage[k] * influence_at(builder, i, k);
        misfit += pow(design->weight[i] * difference, 2);
    }
    return all > 0 ? sqrt(misfit / all) : 1;
}

/*
 * Subtract from the voltages of a mode its components along the preceding modes, twice because of
 * rounding errors, and scale the remainder to norm 1. Returns the norm of the remainder over the
 * norm that the voltages had before.
 */
static double orthonormalise(builder *builder, size_t mode)
{
    const size_t n = builder->moving;
    double *pattern = builder->pattern + mode * n, *effect = builder->effect + mode * n;
    multiply(builder, pattern, effect);
    const double before = sqrt(fmax(dense_dot(pattern, effect, n), 0));
    for (int again = 0; again < 2; again++)
        for (size_t other = 0; other < mode; other++) {
            const double part = dense_dot(builder->effect + other * n, pattern, n);
            for (size_t k = 0; k < n; k++)
                pattern[k] -= part * builder->pattern[other * n + k];
        }
    multiply(builder, pattern, effect);
    const double after = sqrt(fmax(dense_dot(pattern, effect, n), 0));
    for (size_t k = 0; k < n && after > 0; k++) {
        pattern[k] /= after;
        effect[k] /= after;
    }
    return before > 0 ? after / before : 0;
}

/*
 * Make a mode, a pattern of voltages, whose shape comes as close as possible to a function that the
 * scene file gives. Returns 0, or -1 with error filled.
 */
static int make_function(builder *builder, size_t mode, char *error)
{
    const scene_mode *from = &builder->scene->function[mode];
    double *pattern = builder->pattern + mode * builder->moving;
    if (design_target_values(builder->design, from->value, from->at, builder->column, error) < 0)
        return -1;
    builder->left[mode] = fit(builder, pattern);
    if (1 - pow(builder->left[mode], 2) < pow(least_made, 2))
        return scene_fault(from->at, error,
                           "mode %zu, '%s': the actuators cannot make it (%.3g of it is left); "
                           "remove it",
                           mode + 1, from->name, builder->left[mode]);
    if (orthonormalise(builder, mode) > least_part)
        return 0;
    return scene_fault(from->at, error,
                       "mode %zu, '%s': what the actuators can make of it is a combination of the "
                       "modes before it; remove it",
                       mode + 1, from->name);
}

static int make_functions(builder *builder, char *error)
{
    if (!factor_hessian(builder))
        return scene_fault(builder->scene->at, error,
                           "the optimisation of the voltages is singular; add a regularisation, "
                           "limits.regularisation");
    for (size_t mode = 0; mode < builder->modes; mode++)
        if (make_function(builder, mode, error) < 0)
            return -1;
    return 0;
}

/* ---- tables ------------------------------------------------------------------ */

/*
 * Compute the modes, and add the regularisation to the Hessian: after the eigenvectors, which do
 * not depend on it, but before the modes of functions. Returns 0, or -1 with error filled.
 */
static int make_modes(builder *builder, char *error)
{
    const size_t n = builder->moving;
    if (builder->modes > n)
        return scene_fault(builder->scene->at, error,
                           "modes: %zu modes, but %zu amplifiers can move; write at most %zu",
                           builder->modes, n, n);
    fill_hessian(builder);
    bool *is_taken = calloc(n + 1, sizeof *is_taken);
    int failed = is_taken ? 0 : scene_fault(builder->scene->at, error, "out of memory");
    if (!failed && builder->scene->functions == 0)
        failed = make_vectors(builder, is_taken, error);
    free(is_taken);
    for (size_t k = 0; k < n; k++)
        builder->hessian[k * n + k] += builder->design->problem.regularisation;
    if (!failed && builder->scene->functions > 0)
        failed = make_functions(builder, error);
    for (size_t mode = 0; mode < builder->modes && !failed; mode++)
        multiply(builder, builder->pattern + mode * n, builder->effect + mode * n);
    return failed;
}

/*
 * Copy the modes to the tables, with 0 at amplifiers that are held at one voltage, and with the
 * gains and leaks of the scene. Returns whether memory sufficed.
 */
static bool fill_tables(const builder *builder, modal_gains *gains)
{
    const size_t inputs = (size_t)builder->design->amplifiers, modes = builder->modes;
    const size_t n = builder->moving;
    gains->memory = calloc(2 * modes * inputs + 3 * modes + 1, sizeof *gains->memory);
    if (!gains->memory)
        return false;
    double *pattern = gains->memory, *effect = pattern + modes * inputs;
    double *gain = effect + modes * inputs, *leak = gain + modes;
    gains->left = leak + modes;
    for (size_t mode = 0; mode < modes; mode++) {
        for (size_t k = 0; k < n; k++) {
            pattern[mode * inputs + builder->amplifier[k]] = builder->pattern[mode * n + k];
            effect[mode * inputs + builder->amplifier[k]] = builder->effect[mode * n + k];
        }
        gain[mode] = builder->scene->gain[mode];
        leak[mode] = builder->scene->leak[mode];
        gains->left[mode] = builder->left[mode];
    }
    gains->tables = (pzs_modal_gains){.scene = builder->design->problem.scene,
                                      .inputs = (uint16_t)inputs,
                                      .modes = (uint16_t)modes,
                                      .other_gain = builder->scene->other_gain,
                                      .other_leak = builder->scene->other_leak};
    if (modes > 0) {
        gains->tables.pattern = pattern;
        gains->tables.effect = effect;
        gains->tables.gain = gain;
        gains->tables.leak = leak;
    }
    gains->is_used = pzs_modal_gains_seal(&gains->tables) == PZS_OK;
    return gains->is_used;
}

static void free_builder(builder *builder)
{
    free(builder->amplifier);
    free(builder->hessian);
    free(builder->work);
    free(builder->vector);
    free(builder->column);
    free(builder->pattern);
    free(builder->effect);
    free(builder->left);
}

/* Allocate the work arrays, and list the amplifiers that can move. */
static bool allocate(builder *builder)
{
    const design *design = builder->design;
    const size_t amplifiers = (size_t)design->amplifiers, modes = builder->modes;
    builder->amplifier = calloc(amplifiers + 1, sizeof *builder->amplifier);
    if (!builder->amplifier)
        return false;
    for (int k = 0; k < design->amplifiers; k++)
        if (!design_is_held(design, k))
            builder->amplifier[builder->moving++] = (size_t)k;
    const size_t n = builder->moving;
    builder->hessian = calloc(n * n + 1, sizeof *builder->hessian);
    builder->work = calloc(n * n + 1, sizeof *builder->work);
    builder->vector = calloc(n * n + 1, sizeof *builder->vector);
    builder->column = calloc((size_t)design->targets + 1, sizeof *builder->column);
    builder->pattern = calloc(modes * n + 1, sizeof *builder->pattern);
    builder->effect = calloc(modes * n + 1, sizeof *builder->effect);
    builder->left = calloc(modes + 1, sizeof *builder->left);
    return builder->hessian && builder->work && builder->vector && builder->column &&
           builder->pattern && builder->effect && builder->left;
}

int modal_gains_make(design *design, char *error)
{
    builder builder = {.design = design,
                       .scene = &design->control.modal_gains,
                       .modes = (size_t)design->control.modal_gains.modes};
    free(design->gains.memory);
    memset(&design->gains, 0, sizeof design->gains);
    if (!builder.scene->given)
        return 0;
    int failed = allocate(&builder) ? 0 : -1;
    if (failed)
        scene_fault(builder.scene->at, error, "out of memory");
    if (!failed && builder.modes > 0)
        failed = make_modes(&builder, error);
    if (!failed && !fill_tables(&builder, &design->gains))
        failed = scene_fault(builder.scene->at, error, "out of memory");
    free_builder(&builder);
    return failed;
}

/* ---- stability without vibration ------------------------------------------------ */

/*
 * Structures on which the loop must be stable: their static response to voltages over that of the
 * model, as in the stability tests of loops that damp vibration.
 */
static const double responses[] = {0.8, 1, 1.33};

/*
 * Return the factor by which the error of a mode grows in each tick, on a structure whose response
 * to voltages is `response` times that of the model. The step corrects readings that are `delay`
 * ticks old by what the model predicts. In each tick the coordinate c of the mode changes to
 *   (1 - gain - leak) c - gain (response - 1) c_delay
 *   c_delay  coordinate `delay` ticks before
 */
static double growth_at(double gain, double leak, int delay, double response)
{
    double matrix[(MOST_DELAY + 1) * (MOST_DELAY + 1)];
    double work[(MOST_DELAY + 1) * (MOST_DELAY + 1)];
    const size_t order = (size_t)delay + 1;
    memset(matrix, 0, order * order * sizeof *matrix);
    matrix[0] = 1 - gain - leak;
    matrix[order - 1] -= gain * (response - 1);
    for (size_t i = 1; i < order; i++)
        matrix[i * order + i - 1] = 1;
    return eigen_radius(matrix, work, order, SQUARINGS);
}

double modal_gains_growth(double gain, double leak, int delay)
{
    double most = 0;
    for (size_t i = 0; i < sizeof responses / sizeof *responses; i++)
        most = fmax(most, growth_at(gain, leak, delay, responses[i]));
    return most;
}

/*
 * Return whether the error of a mode decays from tick to tick. A mode with gain 0 and leak 0, whose
 * voltages never change, counts as stable, too.
 */
static bool is_stable(double gain, double leak, int delay)
{
    return (!(gain > 0) && !(leak > 0)) || modal_gains_growth(gain, leak, delay) < 1;
}

/*
 * Return, by bisection, the largest gain (part of the wanted change that a tick makes) with which a
 * mode is stable if each tick removes the part `leak` of its coordinate.
 */
static double largest_gain(double leak, int delay)
{
    double low = 0, high = 2;
    for (int i = 0; i < BISECTIONS; i++) {
        const double middle = (low + high) / 2;
        if (is_stable(middle, leak, delay))
            low = middle;
        else
            high = middle;
    }
    return low;
}

/*
 * Refuse the gain and the leak of a mode if its error would grow from tick to tick. Mode numbers
 * count from 1; `mode` = 0 stands for the voltages that belong to no mode.
 */
static int check_mode(const design *design, double gain, double leak, size_t mode, char *error)
{
    const int delay = design->simulate.delay;
    char which[40] = "what is not in the modes";
    if (delay > MOST_DELAY || is_stable(gain, leak, delay))
        return 0;
    if (mode > 0)
        snprintf(which, sizeof which, "mode %zu", mode);
    return scene_fault(design->control.modal_gains.at, error,
                       "gain %g and leak %g of %s are unstable, with readings %d ticks old, on "
                       "structures with 0.8 to 1.33 of the response of the model: its error grows "
                       "%.4g times a tick; write a gain of at most %.3g",
                       gain, leak, which, delay, modal_gains_growth(gain, leak, delay),
                       floor(largest_gain(leak, delay) * 1000) / 1000);
}

int modal_gains_check(const design *design, char *error)
{
    const pzs_modal_gains *tables = &design->gains.tables;
    if (!design->gains.is_used)
        return 0;
    for (size_t k = 0; k < tables->modes; k++)
        if (check_mode(design, tables->gain[k], tables->leak[k], k + 1, error) < 0)
            return -1;
    return check_mode(design, tables->other_gain, tables->other_leak, 0, error);
}
