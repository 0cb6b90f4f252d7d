/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Computation of the stability of a scene's control loop (its certificate) from its vibration modes
 * and gains (certificate_make.h).
 */
#include "certificate_make.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/model.h"
#include "certificate_gains.h"
#include "cholesky.h"
#include "estimator.h"
#include "mass.h"
#include "modal.h"

enum {
    EXACT = 40, /* number of squarings of the control loop's transition matrix by which its spectral
                   radius is found at the scene's tick rate */
    QUICK = 16, /* number of squarings of the control loop's transition matrix by which its spectral
                   radius is found at tick rates above and below that of the scene */
    STATE_LIMIT = 300, /* largest number of states of the control loop for which the stability is
                          computed */
    DELAY_LIMIT = 100, /* largest delay of the measurements for which the stability of the control
                          loop is computed (ticks) */
    RATE_LIMIT = 2000, /* largest number of tick rates for which stability of the control loop is
                          checked */
    PHASES = 8, /* number of interval lengths for which stability is tested at one tick rate, if the
                   tick interval is long: more than four periods of the first vibration mode. Each
                   length exceeds the preceding one by 1/PHASES of this period */
    STARTS = 4  /* largest number of tick rates, each a quarter of the one before, that are tried to
                   find one at which the control loop is stable */
};

static const double two_pi = 6.283185307179586;

/*
 * Tick rates for which the stability of the control loop is tested: scan_from is the lowest and
 * scan_to the highest rate; each rate is scan_step times the preceding one.
 *   scan_from  as a multiple of damping ratio times angular frequency of the first vibration mode
 *       (rad/s)
 *   scan_to    as a multiple of the natural frequency of the loop's last vibration mode (Hz)
 */
static const double scan_from = 0.5, scan_step = 1.02, scan_to = 10;

/*
 * Structures on which the control loop must be stable besides the model: static responses to
 * voltages (`responses`) and lowest natural frequencies, relative to the model. Higher frequencies
 * need no test, because they act like the model's at a lower tick rate, and lower tick rates are
 * tested.
 */
static const double responses[] = {0.8, 1, 1.33}, lowest_frequency = 0.9;

/*
 * Natural frequencies, relative to the model's, of the structures on which a loop must be stable if
 * its amplifiers lag. Without lag, a structure with higher frequencies acts like the model at a
 * lower tick rate and needs no test. With lag it does not, because the time constant of the
 * amplifiers stays the same.
 */
static const double frequencies[] = {1, 0.9, 1.1};

/*
 * Smallest regularisation of the voltage optimisation problem (least squares for the voltages)
 * relative to the mean diagonal entry of its Hessian. The regularisation keeps the Hessian positive
 * definite where amplifiers have equal effects.
 */
static const double least_regularisation = 1e-12;

/* ---- gains ------------------------------------------------------------ */

/*
 * Intermediate results for the loop matrix. An entry of this matrix says how far the controller's
 * reaction to one vibration mode displaces the static equilibrium of another mode.
 */
typedef struct gains {
    const analysis *analysis;
    const vibration *vibration;
    size_t modes, moving; /* number of vibration modes, and number of amplifiers that are not held
                             at one voltage */
    size_t *amplifier;    /* [moving] indices of the amplifiers that are not held at one voltage;
                             `moving` is their number */
    double *factor; /* [moving][moving] Cholesky factor of the regularised Hessian of the voltage
                       optimisation problem (least squares for the voltages), for the amplifiers
                       that are not held at one voltage */
    double *shape;  /* [targets] shape of one vibration mode at the target nodes, as the controller
                       measures or estimates it */
    double *gradient; /* [moving] work vector of a vibration mode for the amplifiers that are not
                         held: products of their influence columns with the mode shape (weighted
                         with squared target weights), then the voltages (V) that fit the mode shape
                         by least squares */
    double *modal_response; /* [modes][moving] coordinate of each vibration mode in equilibrium per
                               volt of each amplifier that is not held at one voltage */
    double *answer; /* [modes][moving] voltages (V) that fit each mode shape by least squares */
    double *loop; /* [modes][modes] loop matrix. The controller reacts to a measured unit of mode j
                     by subtracting voltages. Entry (i, j) is the modal coordinate of mode i in
                     static equilibrium under the subtracted voltages. */
    bool assumes_measured; /* true where stability of the control loop is assessed as if every
                              target node were measured */
} gains;

static size_t list_amplifiers(const design *design, size_t *amplifier)
{
    size_t count = 0;
    for (int k = 0; k < design->amplifiers; k++)
        if (design->lower[k] < design->upper[k])
            amplifier[count++] = (size_t)k;
    return count;
}

static bool factor_hessian(gains *gains)
{
    const design *design = &gains->analysis->design;
    double trace = 0;
    for (size_t i = 0; i < gains->moving; i++)
        for (size_t j = 0; j < gains->moving; j++)
            gains->factor[i * gains->moving + j] =
                design->hessian[gains->amplifier[i] * (size_t)design->amplifiers +
                                gains->amplifier[j]];
    for (size_t i = 0; i < gains->moving; i++)
        trace += gains->factor[i * gains->moving + i];
    for (size_t i = 0; i < gains->moving; i++)
        gains->factor[i * gains->moving + i] +=
            design->problem.regularisation + least_regularisation * trace / (double)gains->moving;
    return gains->moving > 0 && cholesky_factor(gains->factor, gains->moving);
}

/*
 * Displacements of the target nodes that the shape estimator computes from the noise-free sensor
 * readings of a structure that is displaced in a mode shape.
 */
static void estimated_shape(const gains *gains, const estimator *estimator,
                            const double *mode_shape)
{
    const design *design = &gains->analysis->design;
    int sensor = 0;
    memset(gains->shape, 0, (size_t)design->targets * sizeof *gains->shape);
    for (int i = 0; i < design->estimate.readings; i++) {
        const int output = design->estimate.reading[i].output;
        for (int row = design->named_first[output]; row < design->named_first[output + 1]; row++) {
            const double shown =
                pzs_model_observe_row(&design->structure, mode_shape, (uint32_t)row);
            for (int target = 0; target < design->targets; target++)
                gains->shape[target] +=
                    estimator->gain[(size_t)target * (size_t)estimator->sensors + (size_t)sensor] *
                    shown;
            sensor++;
        }
    }
}

/*
 * Compute one column of the loop matrix. The structure is displaced in the shape of a vibration
 * mode with the coordinate 1. The controller takes this for an error of the shape and subtracts
 * certain voltages. The column holds the coordinates of all modes in static equilibrium under these
 * voltages.
 */
static void fill_column(gains *gains, const estimator *estimator, size_t mode)
{
    const design *design = &gains->analysis->design;
    const size_t dof = (size_t)design->mesh.free_dof;
    const double *mode_shape =
        gains->vibration->shape + ((size_t)gains->vibration->rigid + mode) * dof;
    if (estimator)
        estimated_shape(gains, estimator, mode_shape);
    else
        design_shape(design, mode_shape, gains->shape);
    for (size_t j = 0; j < gains->moving; j++) {
        gains->gradient[j] = 0;
        for (int target = 0; target < design->targets; target++)
            gains->gradient[j] +=
                design
                    ->influence[(size_t)target * (size_t)design->amplifiers + gains->amplifier[j]] *
                design->weight[target] * design->weight[target] * gains->shape[target];
    }
    cholesky_solve(gains->factor, gains->moving, gains->gradient);
    memcpy(gains->answer + mode * gains->moving, gains->gradient,
           gains->moving * sizeof *gains->answer);
    for (size_t i = 0; i < gains->modes; i++) {
        double sum = 0;
        for (size_t j = 0; j < gains->moving; j++)
            sum += gains->modal_response[i * gains->moving + j] * gains->gradient[j];
        gains->loop[i * gains->modes + mode] = sum;
    }
}

static bool fill_gains(gains *gains)
{
    estimator estimator;
    char ignored[SCENE_ERROR];
    const design *design = &gains->analysis->design;
    gains->moving = list_amplifiers(&gains->analysis->design, gains->amplifier);
    if (!factor_hessian(gains))
        return false;
    for (size_t i = 0; i < gains->modes; i++)
        for (size_t j = 0; j < gains->moving; j++)
            gains->modal_response[i * gains->moving + j] =
                vibration_static(gains->vibration, &gains->analysis->design,
                                 gains->vibration->rigid + (int)i, (int)gains->amplifier[j]);
    const int wanted = design->estimate.given && design->simulate.sight != SIGHT_MEASURED;
    const int estimates = wanted && design_reads_displacements(design) &&
                          estimator_open(&estimator, gains->analysis, ignored) == 0;
    gains->assumes_measured = wanted && !estimates;
    for (size_t mode = 0; mode < gains->modes; mode++)
        fill_column(gains, estimates ? &estimator : NULL, mode);
    if (estimates)
        estimator_close(&estimator);
    return true;
}

/*
 * Compute the loop matrix [modes][modes] of the lowest vibration modes, without rigid motions, and
 * the voltages that the controller subtracts for a measured unit of each of them. Entry (i, j) of
 * the matrix is the modal coordinate of mode i in static equilibrium under the voltages for mode j.
 * Returns whether it could be computed; free_gains releases the arrays in either case.
 */
static bool make_gains(gains *gains, const analysis *analysis, const vibration *vibration,
                       int modes)
{
    const size_t amplifiers = (size_t)analysis->design.amplifiers, count = (size_t)modes;
    memset(gains, 0, sizeof *gains);
    gains->analysis = analysis;
    gains->vibration = vibration;
    gains->modes = count;
    gains->amplifier = malloc(amplifiers * sizeof *gains->amplifier);
    gains->factor = malloc(amplifiers * amplifiers * sizeof *gains->factor);
    gains->gradient = malloc(amplifiers * sizeof *gains->gradient);
    gains->shape = malloc((size_t)analysis->design.targets * sizeof *gains->shape);
    gains->modal_response = malloc(count * amplifiers * sizeof *gains->modal_response);
    gains->answer = malloc(count * amplifiers * sizeof *gains->answer);
    gains->loop = malloc(count * count * sizeof *gains->loop);
    return gains->amplifier && gains->factor && gains->gradient && gains->shape &&
           gains->modal_response && gains->answer && gains->loop && fill_gains(gains);
}

static void free_gains(gains *gains)
{
    free(gains->amplifier);
    free(gains->factor);
    free(gains->gradient);
    free(gains->shape);
    free(gains->modal_response);
    free(gains->answer);
    free(gains->loop);
    memset(gains, 0, sizeof *gains);
}

/* ---- stability --------------------------------------------------------- */

/*
 * Control loop whose stability is tested.
 *   matrix    [modes][modes] loop matrix: entry (i, j) is the static coordinate of mode i under the
 *       voltages that the controller subtracts for a measured unit of mode j
 *   square    [modes] squared angular frequencies (rad^2/s^2)
 *   damping   [modes] damping ratios
 *   delay     delay of the sensor readings (ticks)
 *   lag       time constant of the amplifiers' first-order lag (s); 0: none
 */
typedef struct assessed_loop {
    const double *matrix, *square, *damping;
    int modes, delay;
    double lag;
} assessed_loop;

/*
 * Return the conditions of a stability test on a structure that differs from the model. `frequency`
 * multiplies tick interval and lag, which has the effect of multiplying all natural frequencies.
 *   gain      in  static response of the structure to voltages, relative to the model
 *   frequency in  natural frequencies of the structure, relative to the model
 *   interval  in  time between ticks (s)
 */
static certificate_conditions conditions_at(const assessed_loop *loop, double gain,
                                            double frequency, double interval)
{
    return (certificate_conditions){.gain = gain,
                                    .delay = loop->delay,
                                    .interval = interval * frequency,
                                    .lag = loop->lag * frequency};
}

/*
 * Whether the control loop is stable at a tick interval on all structures to be tested. They differ
 * from the model in their static response to voltages and, where the amplifiers lag, in their
 * natural frequencies.
 */
static bool is_stable_at(const assessed_loop *loop, double interval)
{
    const size_t count = loop->lag > 0 ? sizeof frequencies / sizeof *frequencies : 1;
    for (size_t k = 0; k < count; k++)
        for (size_t i = 0; i < sizeof responses / sizeof *responses; i++) {
            const certificate_conditions conditions =
                conditions_at(loop, responses[i], frequencies[k], interval);
            if (!certificate_decays(loop->matrix, loop->square, loop->modes, loop->damping,
                                    &conditions, QUICK))
                return false;
        }
    return true;
}

/* Return whether the control loop is stable at a tick rate on all structures to be tested. */
static bool is_stable(const assessed_loop *loop, double rate)
{
    /*
     * If a tick interval exceeds four periods of the first mode, it matters in which phase of its
     * vibration a tick finds this mode. Intervals that are longer by k / PHASES of a period are
     * then tested, too.
     */
    const double period = two_pi / sqrt(loop->square[0]), interval = 1 / rate;
    const int phases = interval > 4 * period ? PHASES : 1;
    for (int k = 0; k < phases; k++)
        if (!is_stable_at(loop, interval + period * k / PHASES))
            return false;
    return true;
}

/*
 * Highest tick rate up to which the control loop is stable at every checked rate: 0 where it is
 * unstable at the lowest checked rates, infinite where it is stable at all of them.
 */
static double scan_rates(const assessed_loop *loop)
{
    const double end = scan_to * sqrt(loop->square[loop->modes - 1]) / two_pi;
    double rate = scan_from * loop->damping[0] * sqrt(loop->square[0]), stable = 0;
    for (int i = 0; i < STARTS && !is_stable(loop, rate); i++)
        rate /= 4;
    for (int i = 0; i < RATE_LIMIT && rate < end; i++) {
        if (!is_stable(loop, rate))
            return stable;
        stable = rate;
        rate *= scan_step;
    }
    return rate < end ? stable : HUGE_VAL;
}

/*
 * Return the damping ratio of each vibration mode that is in the loop, as an array [modes] that the
 * caller frees; NULL where memory runs out.
 */
static double *loop_damping(const certificate *certificate, const design *design)
{
    const int first = vibration_first(&certificate->vibration);
    double *damping = malloc((size_t)certificate->modes * sizeof *damping);
    for (int i = 0; damping && i < certificate->modes; i++)
        damping[i] =
            modal_damping(&design->dynamics, i, sqrt(certificate->vibration.square[first + i]));
    return damping;
}

/*
 * Whether the control loop with gains of modes is stable at the tick rate of the scene on all
 * structures to be tested, which differ from the model in static response and frequencies.
 */
static bool are_stable(const certificate_groups *groups, const assessed_loop *loop, double interval)
{
    for (size_t k = 0; k < sizeof frequencies / sizeof *frequencies; k++)
        for (size_t i = 0; i < sizeof responses / sizeof *responses; i++) {
            const certificate_conditions conditions =
                conditions_at(loop, responses[i], frequencies[k], interval);
            if (!certificate_groups_decay(groups, loop->square, loop->damping, &conditions, EXACT))
                return false;
        }
    return true;
}

/*
 * Assess a loop with gains of modes, which never damps vibration, at the tick rate of the scene.
 * Returns whether memory sufficed.
 */
static bool assess_gains(certificate *certificate, const gains *gains, const assessed_loop *loop)
{
    const pzs_modal_gains *tables = &gains->analysis->design.gains.tables;
    const certificate_answers answers = {.modes = gains->modes,
                                         .moving = gains->moving,
                                         .amplifier = gains->amplifier,
                                         .modal_response = gains->modal_response,
                                         .answer = gains->answer};
    certificate_groups groups;
    const bool is_made = certificate_groups_make(&groups, tables, &answers);
    if (is_made && certificate->rate > 0) {
        const double interval = 1 / certificate->rate;
        const certificate_conditions nominal = conditions_at(loop, 1, 1, interval);
        certificate->radius =
            certificate_groups_radius(&groups, loop->square, loop->damping, &nominal, EXACT);
        certificate->stable_rate = are_stable(&groups, loop, interval) ? certificate->rate : 0;
    }
    certificate_groups_free(&groups);
    return is_made;
}

static void assess_step(certificate *certificate, const gains *gains, const assessed_loop *loop)
{
    if (certificate->rate > 0) {
        const certificate_conditions nominal = conditions_at(loop, 1, 1, 1 / certificate->rate);
        certificate->radius = certificate_radius(gains->loop, loop->square, loop->modes,
                                                 loop->damping, &nominal, EXACT);
        certificate->gain = 2 * certificate->damping * sqrt(loop->square[0]) / certificate->rate;
    }
    certificate->stable_rate = (loop->lag > 0 ? 1 : lowest_frequency) * scan_rates(loop);
}

/*
 * Return the largest number of vibration modes with which the transition matrix of the loop has at
 * most STATE_LIMIT states; 0 if a loop with gains of modes exceeds this limit even with one
 * vibration mode.
 */
static int most_modes(const certificate *certificate, const design *design)
{
    const int delay = design->simulate.delay;
    const certificate_conditions conditions = {.delay = delay, .lag = certificate->bandwidth};
    int modes = certificate->vibration.count - vibration_first(&certificate->vibration);
    const int most = STATE_LIMIT / (delay + (certificate->bandwidth > 0 ? 5 : 3));
    size_t moving = 0;
    modes = modes < most ? modes : most;
    for (int k = 0; k < design->amplifiers && design->gains.is_used; k++)
        moving += !design_is_held(design, k);
    while (design->gains.is_used && modes > 0 &&
           certificate_groups_order(&design->gains.tables, (size_t)modes, moving, &conditions) >
               STATE_LIMIT)
        modes--;
    return modes;
}

/*
 * Return whether the loop can be assessed; otherwise certificate->reason says why not, or is empty
 * where there is nothing to assess.
 */
static bool can_assess(certificate *certificate, const design *design)
{
    const int delay = design->simulate.delay;
    int held = 0;
    if (certificate->vibration.count <= vibration_first(&certificate->vibration) ||
        design->problem.inputs == 0)
        return false;
    for (int k = 0; k < design->amplifiers; k++)
        held += design_is_held(design, k);
    const bool can = delay <= DELAY_LIMIT && held < design->amplifiers && certificate->modes > 0;
    if (delay > DELAY_LIMIT)
        snprintf(certificate->reason, sizeof certificate->reason,
                 "delay of %d ticks: at most %d can be assessed; lower control.rate, so that it is "
                 "fewer ticks",
                 delay, DELAY_LIMIT);
    else if (held == design->amplifiers)
        snprintf(certificate->reason, sizeof certificate->reason,
                 "every amplifier is held at one voltage, so that the loop moves nothing");
    else if (!can)
        snprintf(certificate->reason, sizeof certificate->reason,
                 "too many different gains and leaks in control.modal_gains for the test of "
                 "vibration; give several modes the same ones");
    return can;
}

static void assess(certificate *certificate, const analysis *analysis)
{
    const design *design = &analysis->design;
    const int first = vibration_first(&certificate->vibration);
    gains gains;
    certificate->modes = most_modes(certificate, design);
    if (!can_assess(certificate, design))
        return;
    const bool is_made = make_gains(&gains, analysis, &certificate->vibration, certificate->modes);
    double *damping = is_made ? loop_damping(certificate, design) : NULL;
    certificate->assumes_measured = gains.assumes_measured;
    const assessed_loop assessed = {
        .matrix = gains.loop,
        .square = certificate->vibration.square + first,
        .damping = damping,
        .modes = certificate->modes,
        .delay = design->simulate.delay,
        .lag = certificate->bandwidth > 0 ? 1 / (two_pi * certificate->bandwidth) : 0};
    if (!is_made) {
        snprintf(certificate->reason, sizeof certificate->reason,
                 "the optimisation of the voltages is singular; add a regularisation, "
                 "limits.regularisation");
    } else if (!damping) {
        snprintf(certificate->reason, sizeof certificate->reason, "out of memory");
    } else {
        certificate->damping = damping[0];
        certificate->has_gains = design->gains.is_used;
        certificate->is_assessed =
            !certificate->has_gains || assess_gains(certificate, &gains, &assessed);
        if (!certificate->has_gains)
            assess_step(certificate, &gains, &assessed);
    }
    free(damping);
    free_gains(&gains);
}

void certificate_make(certificate *certificate, const analysis *analysis)
{
    const design *design = &analysis->design;
    if (certificate->is_made)
        return;
    memset(certificate, 0, sizeof *certificate);
    certificate->is_made = true;
    certificate->damping = design->dynamics.damping;
    certificate->has_own_damping = design->dynamics.damping_given;
    certificate->rate = design->control.rate;
    certificate->bandwidth = design->simulate.imperfections.bandwidth;
    certificate->radius = certificate->gain = certificate->stable_rate = (double)NAN;
    certificate->has_modes = analysis_vibration(analysis, &certificate->vibration,
                                                design->dynamics.modes, certificate->reason) == 0;
    certificate->is_loaded = analysis->about.tangent != NULL;
    if (certificate->has_modes)
        assess(certificate, analysis);
}
