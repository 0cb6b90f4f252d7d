/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Spectral radius of a control loop on a structure with mass, and text of its certificate, the
 * result of its stability tests (certificate.h).
 */
#include "certificate.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../text/append.h"
#include "eigen.h"
#include "modal.h"

/*
 * Exponent of the decay of vibration between two ticks above which a vibration mode counts as
 * static: its amplitude falls to less than exp(-20) = 2e-9.
 */
static const double decayed = 20;

/* ---- the loop --------------------------------------------------------- */

/*
 * Transition matrix of a control loop, while it is filled. It maps the states just before one tick
 * to the states just before the next tick. Terms:
 *   correction         voltages that the controller subtracts in answer to a measurement; the
 *       commanded voltages are minus the correction for the measurement `delay` ticks before
 *   static coordinate  of a vibration mode under some voltages: modal coordinate in equilibrium
 *       under them, according to the model
 * States, each for all modes in turn:
 *   e       deviation of the modal coordinate from equilibrium under the mean output voltages
 *   p       modal velocity divided by the angular frequency
 *   h       [delay + 1] static coordinates under the corrections for the last delay + 1
 *       measurements, newest first
 *   output  only where the amplifiers lag: static coordinates under their output voltages at the
 *       tick, and under their mean output voltages in the interval before it
 */
typedef struct transition {
    const double *loop; /* [modes][stride] loop matrix. The voltages that the controller subtracts
                           for a measured unit of mode j are called the correction. Entry (i, j) is
                           the static coordinate of mode i under it: its modal coordinate in
                           equilibrium, by the model */
    size_t stride, modes, order;
    const certificate_conditions *conditions;
    double kept, behind; /* kept: fraction of the difference between command and output voltage of
                            an amplifier that is left after a tick interval; behind: mean of this
                            fraction over the interval */
    double *matrix;      /* [order][order] transition matrix of the control loop over one tick */
} transition;

/* Number of states of the transition matrix for each vibration mode. */
static size_t states_of(const certificate_conditions *conditions)
{
    return (size_t)conditions->delay + (conditions->lag > 0 ? 5 : 3);
}

/*
 * Add to a row of the transition matrix `factor` times a modal coordinate of vibration mode i: the
 * one in equilibrium (static coordinate) under the voltages that the controller subtracts because
 * of the measurement at the coming tick. This coordinate is the sum of two terms:
 *   - loop matrix times the deviations of the coordinates of all modes from equilibrium;
 *   - static coordinate of the structure under its voltages, minus the static coordinate that the
 *     model predicts for these voltages.
 */
static void add_measured(const transition *transition, double *row, size_t i, double factor)
{
    const size_t m = transition->modes, delay = (size_t)transition->conditions->delay;
    const double gain = transition->conditions->gain;
    const bool lags = transition->conditions->lag > 0;
    for (size_t j = 0; j < m; j++)
        row[j] += factor * transition->loop[i * transition->stride + j];
    row[m * (delay + 2) + i] += lags ? factor : factor * (1 - gain);
    if (lags)
        row[m * (delay + 4) + i] += factor * gain;
}

/*
 * Add to a row of the transition matrix `factor` times the static coordinate (modal coordinate in
 * equilibrium) of vibration mode i under the voltages commanded at the coming tick. The commanded
 * voltages are minus the controller's correction for the measurement `delay` ticks before. The
 * static coordinate under this correction is a state.
 */
static void add_command(const transition *transition, double *row, size_t i, double factor)
{
    const size_t delay = (size_t)transition->conditions->delay;
    if (delay == 0)
        add_measured(transition, row, i, -factor);
    else
        row[transition->modes * (delay + 1) + i] -= factor;
}

/*
 * Add to a row of the transition matrix `factor` times the static coordinate of vibration mode i
 * under the amplifiers' mean output voltages in the coming tick interval. The static coordinate is
 * the modal coordinate in equilibrium, computed with the model.
 */
static void add_driven(const transition *transition, double *row, size_t i, double factor)
{
    const size_t output = transition->modes * ((size_t)transition->conditions->delay + 3);
    add_command(transition, row, i, factor * (1 - transition->behind));
    if (transition->conditions->lag > 0)
        row[output + i] += factor * transition->behind;
}

/*
 * Fill two rows of vibration mode i in the transition matrix: those of e, the deviation of its
 * modal coordinate from equilibrium, and of p, its modal velocity divided by the angular frequency.
 * At the tick the equilibrium moves by `change`; then the mode vibrates freely until the next tick:
 *   e' = turn[0] (e - change) + turn[1] p
 *   p' = turn[2] (e - change) + turn[3] p
 *   turn    2 x 2 propagator of free vibration over a tick interval
 *   change  static coordinate (modal coordinate in equilibrium) after the tick minus that before,
 *           times conditions->gain
 */
static void fill_vibration(const transition *transition, size_t i, const double turn[4])
{
    const size_t m = transition->modes, delay = (size_t)transition->conditions->delay;
    for (size_t half = 0; half < 2; half++) {
        double *row = transition->matrix + (half * m + i) * transition->order;
        const double moved = turn[2 * half] * transition->conditions->gain;
        row[i] += turn[2 * half];
        row[m + i] += turn[2 * half + 1];
        add_driven(transition, row, i, -moved);
        if (transition->conditions->lag > 0)
            row[m * (delay + 4) + i] += moved;
        else
            row[m * (delay + 2) + i] -= moved;
    }
}

/*
 * Fill those rows of vibration mode i in the transition matrix whose states are static coordinates
 * of the mode, its modal coordinates in equilibrium under certain voltages:
 *   - the controller's corrections for the newest measurement and for `delay` older ones; each row
 *     for an older measurement copies the state of the next newer one
 *   - if the amplifiers lag, their output voltages and their mean output voltages
 */
static void fill_memory(const transition *transition, size_t i)
{
    const size_t m = transition->modes, order = transition->order,
                 delay = (size_t)transition->conditions->delay;
    double *row = transition->matrix + i * order;
    add_measured(transition, row + 2 * m * order, i, 1);
    for (size_t k = 3; k < delay + 3; k++)
        row[k * m * order + (k - 1) * m + i] = 1;
    if (!(transition->conditions->lag > 0))
        return;
    double *output = row + (delay + 3) * m * order;
    add_command(transition, output, i, 1 - transition->kept);
    output[(delay + 3) * m + i] += transition->kept;
    add_driven(transition, row + (delay + 4) * m * order, i, 1);
}

/*
 * Fill the transition matrix, which advances the vibration of the structure under the control loop
 * by one tick.
 */
static void fill_loop(transition *transition, const double *square, const double *damping)
{
    const certificate_conditions *conditions = transition->conditions;
    memset(transition->matrix, 0, transition->order * transition->order * sizeof(double));
    if (conditions->lag > 0) {
        const double times = conditions->interval / conditions->lag;
        transition->kept = exp(-times);
        transition->behind = -expm1(-times) / times;
    }
    for (size_t i = 0; i < transition->modes; i++) {
        double turn[4];
        modal_propagator(sqrt(square[i]), damping[i], conditions->interval, turn);
        fill_vibration(transition, i, turn);
        fill_memory(transition, i);
    }
}

/*
 * Return the number of vibration modes that still vibrate when the next tick comes: damping ratio
 * times angular frequency times tick interval is below `decayed`. The other modes have reached
 * their static equilibrium by then.
 */
static int lasting_modes(const double *square, int modes, const double *damping, double interval)
{
    int count = 0;
    while (count < modes && damping[count] * sqrt(square[count]) * interval < decayed)
        count++;
    return count;
}

/*
 * Allocate and fill the transition matrix of a control loop, and behind it a work array of the same
 * size. The caller frees the matrix; it is NULL where memory runs out.
 */
static transition make_transition(const double *loop, const double *square, int modes,
                                  const double *damping, const certificate_conditions *conditions)
{
    const int count = lasting_modes(square, modes, damping, conditions->interval);
    transition transition = {.loop = loop,
                             .stride = (size_t)modes,
                             .modes = (size_t)count,
                             .order = (size_t)count * states_of(conditions),
                             .conditions = conditions};
    const size_t entries = transition.order * transition.order;
    transition.matrix = malloc((2 * entries + 1) * sizeof *transition.matrix);
    if (transition.matrix)
        fill_loop(&transition, square, damping);
    return transition;
}

double certificate_radius(const double *loop, const double *square, int modes,
                          const double *damping, const certificate_conditions *conditions,
                          int squarings)
{
    const transition made = make_transition(loop, square, modes, damping, conditions);
    double radius = (double)NAN;
    if (made.matrix)
        radius =
            eigen_radius(made.matrix, made.matrix + made.order * made.order, made.order, squarings);
    free(made.matrix);
    return radius;
}

bool certificate_decays(const double *loop, const double *square, int modes, const double *damping,
                        const certificate_conditions *conditions, int squarings)
{
    const transition made = make_transition(loop, square, modes, damping, conditions);
    const bool decays =
        made.matrix &&
        eigen_decays(made.matrix, made.matrix + made.order * made.order, made.order, squarings);
    free(made.matrix);
    return decays;
}

void certificate_free(certificate *certificate)
{
    vibration_free(&certificate->vibration);
    memset(certificate, 0, sizeof *certificate);
}

int certificate_older(const certificate_loop *loop)
{
    const bool is_less = loop->target.is_made && loop->target.older < loop->older;
    return is_less ? loop->target.older : loop->older;
}

int certificate_newer(const certificate_loop *loop)
{
    const bool is_less = loop->target.is_made && loop->target.newer < loop->newer;
    return is_less ? loop->target.newer : loop->newer;
}

bool certificate_refuses(const certificate *certificate)
{
    const bool is_stable = certificate->radius < 1 && certificate->rate <= certificate->stable_rate;
    return certificate->is_assessed && certificate->rate > 0 && !is_stable;
}

bool certificate_lacks_rate(const certificate *certificate)
{
    return certificate->is_assessed && certificate->has_modes && !(certificate->rate > 0) &&
           !isinf(certificate->stable_rate);
}

bool certificate_is_prestressed(const certificate *certificate)
{
    const double ratio = certificate->load_ratio;
    return !certificate->is_loaded && ratio > 0 && fabs(ratio - 1) > 0.05;
}

double certificate_first(const certificate *certificate)
{
    const int first = vibration_first(&certificate->vibration);
    return certificate->has_modes && first < certificate->vibration.count
               ? certificate->vibration.frequency[first]
               : (double)NAN;
}

/* ---- text -------------------------------------------------------------- */

/* Write a text on the range of tick rates at which the control loop is stable. */
static void range_text(const certificate *certificate, char text[SCENE_ERROR])
{
    if (!isfinite(certificate->stable_rate))
        snprintf(text, SCENE_ERROR, "Every rate is stable.");
    else if (certificate->stable_rate <= 0)
        snprintf(text, SCENE_ERROR,
                 "No rate was found at which it is stable; wait for a vibration model.");
    else if (certificate_refuses(certificate))
        snprintf(text, SCENE_ERROR,
                 "Run it at most at %.3g ticks a second, or wait for a vibration model.",
                 certificate->stable_rate);
    else
        snprintf(text, SCENE_ERROR,
                 "Every rate up to %.3g ticks a second is stable, also where the response to "
                 "voltages\nis 0.8 to 1.33 and frequencies are 0.9 to 1.1 of the model's.",
                 certificate->stable_rate);
}

/*
 * Append the sentences on the stability of a control loop in which each mode has a gain (part of
 * its wanted change that a tick makes) and a leak (part that a tick removes). It is assessed at the
 * tick rate of the scene alone.
 */
static void gains_text(const certificate *certificate, char text[CERTIFICATE_TEXT])
{
    text_append(text, CERTIFICATE_TEXT,
                "The control step has gains and leaks of modes (control.modal_gains), and does not "
                "damp vibration.\n");
    if (!(certificate->rate > 0))
        text_append(text, CERTIFICATE_TEXT,
                    "Its stability is assessed where the scene gives control: {rate: ...}.");
    else if (!certificate_refuses(certificate))
        text_append(text, CERTIFICATE_TEXT,
                    "At %g ticks a second it is stable: what is left after a tick is at most %.4g "
                    "of the error, also of\nvibration; it is stable, too, where the response to "
                    "voltages is 0.8 to 1.33 and frequencies are\n0.9 to 1.1 of the model's.",
                    certificate->rate, certificate->radius);
    else if (certificate->radius < 1)
        text_append(text, CERTIFICATE_TEXT,
                    "At %g ticks a second vibration decays on the model, but it grows on "
                    "structures whose response to\nvoltages is 0.8 to 1.33 or whose frequencies "
                    "are 0.9 to 1.1 of the model's.",
                    certificate->rate);
    else
        text_append(text, CERTIFICATE_TEXT,
                    "At %g ticks a second it is unstable: vibration grows %.7g times a tick.",
                    certificate->rate, certificate->radius);
    if (certificate_refuses(certificate))
        text_append(text, CERTIFICATE_TEXT,
                    "\nLower the gains, or remove control.modal_gains, and the tick damps "
                    "vibration instead.");
}

/* Write a text on the stability of the control loop at the tick rate of the scene. */
static void rate_text(const certificate *certificate, char text[SCENE_ERROR])
{
    if (certificate_refuses(certificate) && certificate->radius < 1)
        snprintf(
            text, SCENE_ERROR,
            "The control step has no vibration model. At %g ticks a second vibration decays on\n"
            "the model, but it grows on structures whose response to voltages is 0.8 to 1.33 or\n"
            "whose frequencies are 0.9 to 1.1 of the model's.\n",
            certificate->rate);
    else if (certificate_refuses(certificate))
        snprintf(
            text, SCENE_ERROR,
            "The control step has no vibration model. At %g ticks a second (T = %g s) a structure\n"
            "with first mode %.4g Hz and damping ratio %g is stable only at step gain below about\n"
            "2 zeta w1 T = %.2g; the step limit does not help: vibration grows %.4g times a "
            "tick.\n",
            certificate->rate, 1 / certificate->rate, certificate_first(certificate),
            certificate->damping, certificate->gain, certificate->radius);
    else
        snprintf(
            text, SCENE_ERROR,
            "The control step has no vibration model. At %g ticks a second the loop is stable:\n"
            "vibration decays to %.4g of itself a tick.\n",
            certificate->rate, certificate->radius);
}

static const char *plural(int count)
{
    return count == 1 ? "" : "s";
}

/*
 * Append the first sentence on a control loop with a vibration model: whether it is stable, and
 * which vibration modes its control tick damps.
 */
static void verdict_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    if (!loop->is_stable && loop->is_free_cause)
        text_append(text, CERTIFICATE_TEXT,
                    "The damped tick is not safe. The free functions of the target are the cause: "
                    "without target.free\nit passes all tests.");
    else if (!loop->is_stable && loop->cure > 0)
        text_append(text, CERTIFICATE_TEXT,
                    "The damped tick is not safe. Some combinations of voltages hardly move the "
                    "target, but they move modes:\nwith limits: {regularisation: {relative: %g}} "
                    "it passes all tests.",
                    loop->cure);
    else if (!loop->is_stable && loop->is_compensation_cure)
        text_append(text, CERTIFICATE_TEXT,
                    "The damped tick is not safe. Hysteresis of %g %% is the cause: where it is "
                    "compensated\n(section hysteresis) the loop passes all tests.",
                    100 * loop->hysteresis);
    else if (!loop->is_stable && loop->cures_tried > 0)
        text_append(text, CERTIFICATE_TEXT,
                    "The damped tick is not safe, and no regularisation of the voltages up to %g "
                    "makes it so.",
                    loop->cures_tried);
    else if (!loop->is_stable)
        text_append(text, CERTIFICATE_TEXT, "The damped tick is not safe.");
    else if (loop->observed > 0)
        text_append(text, CERTIFICATE_TEXT,
                    "The damped tick is stable and damps %d mode%s from %.4g to %.4g Hz.",
                    loop->observed, plural(loop->observed), loop->observed_from, loop->observed_to);
    else if (loop->has_slow_mode)
        text_append(
            text, CERTIFICATE_TEXT,
            "The tick is stable and damps no mode, because none moves the target, without its free "
            "functions,\nor none can be observed with so few amplifiers and sensors:\n"
            "it follows the static optimum so slowly that vibration decays by itself.");
    else
        text_append(
            text, CERTIFICATE_TEXT,
            "The tick is stable and damps no mode, because each turns by more than 2 rad in a "
            "tick:\nit follows the static optimum so slowly that vibration decays by itself.");
}

/*
 * Append the sentences on the storms (stress tests: simulations with fast jumps of the target) of a
 * loop with a vibration model.
 */
static void storm_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    text_append(
        text, CERTIFICATE_TEXT,
        "\nStorms (stress tests: targets jump faster than the voltages can follow, then the last "
        "one stands;\nin a third of them 5 %% of the ticks are missed%s",
        loop->less_hysteresis > 0 ? ", in another the ceramic has half the hysteresis" : "");
    if (loop->bandwidth > 0)
        text_append(text, CERTIFICATE_TEXT,
                    "; the amplifiers lag, with a corner of %g Hz,\n%g %% lower in a third of the "
                    "storms and higher in another%s",
                    loop->bandwidth, 100 * loop->less_bandwidth,
                    loop->models_lag ? "; the tick knows of the lag" : "");
    text_append(text, CERTIFICATE_TEXT, "):");
    if (loop->storms == 0) {
        text_append(text, CERTIFICATE_TEXT, " none was run.");
        return;
    }
    char unit[CERTIFICATE_UNIT];
    certificate_unit(loop, unit);
    text_append(text, CERTIFICATE_TEXT,
                "\n%d of %d storms settle; the worst ends %.3g %s from the best shape (allowed: "
                "%g).",
                loop->storms - loop->failed, loop->storms, loop->worst, unit,
                CERTIFICATE_TOLERANCE);
    if (loop->hysteresis > 0)
        text_append(
            text, CERTIFICATE_TEXT,
            "\nWith %g %% hysteresis of the ceramic, not compensated, %d of %d more settle.",
            100 * loop->hysteresis, loop->hysteresis_storms - loop->hysteresis_failed,
            loop->hysteresis_storms);
    if (loop->unseen > CERTIFICATE_TOLERANCE)
        text_append(
            text, CERTIFICATE_TEXT,
            "\nHYSTERESIS THAT THE SENSORS DO NOT SHOW LEAVES UP TO %.2g %s; add sensors, or "
            "the section\nhysteresis.",
            loop->unseen, unit);
    if (loop->unit > 1 && isfinite(loop->unit))
        text_append(text, CERTIFICATE_TEXT,
                    "\nA 50th of the shapes under half the voltage range is as large as %.3g "
                    "targets, and is the unit.",
                    loop->unit);
}

void certificate_unit(const certificate_loop *loop, char text[CERTIFICATE_UNIT])
{
    if (loop->unit > 1 && isfinite(loop->unit))
        snprintf(text, CERTIFICATE_UNIT, "of %.3g targets", loop->unit);
    else
        snprintf(text, CERTIFICATE_UNIT, "of %s",
                 loop->unit > 1 ? "a 50th of the shapes under half the voltage range"
                                : "the target");
}

/*
 * Append the sentence that says whether the supervisor takes control away from the loop in storms
 * (simulations with fast jumps of the target).
 */
static void alarm_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    if (loop->fading > 0 && loop->alarms == 0)
        text_append(text, CERTIFICATE_TEXT,
                    "\nSupervisor: no alarm in these storms. The vibration that it tolerates after "
                    "a jump of the\ntarget falls by e in %.3g periods of the first observed mode.",
                    loop->fading);
    else if (loop->fading > 0)
        text_append(text, CERTIFICATE_TEXT,
                    "\nSUPERVISOR: %d OF THESE STORMS END%s IN A FALSE ALARM, which parks the "
                    "voltages.",
                    loop->alarms, loop->alarms == 1 ? "S" : "");
}

/*
 * Append the sentences that say what the sensor gate (block that takes wrong readings away) does in
 * storms (simulations with fast jumps of the target), and what one wrong sensor does to the shape.
 */
static void gate_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    const certificate_gate *gate = &loop->gate;
    char unit[CERTIFICATE_UNIT];
    if (!gate->is_made)
        return;
    certificate_unit(loop, unit);
    if (gate->storms > 0)
        text_append(text, CERTIFICATE_TEXT,
                    "\nSENSOR GATE: IN %d OF THESE STORMS IT TAKES HEALTHY READINGS AWAY; state "
                    "larger ranges.",
                    gate->storms);
    else
        text_append(text, CERTIFICATE_TEXT,
                    "\nSensor gate: no reading is taken away in these storms.");
    if (gate->tried > 0)
        text_append(text, CERTIFICATE_TEXT,
                    "\nOne sensor that suddenly reads the end of its range moves the shape by at "
                    "most %.2g %s\n(%d sensors tried; sensor %d reads %.3g)%s.",
                    gate->moved, unit, gate->tried, gate->sensor, gate->reading,
                    gate->is_stopped ? ", AND THE SUPERVISOR PARKS THE VOLTAGES" : "");
}

/*
 * Append the sentence that says how fast the control loop compensates a suddenly applied load, and,
 * where this takes long, why.
 */
static void load_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    if (!isfinite(loop->load_step)) {
        text_append(text, CERTIFICATE_TEXT,
                    loop->observed > 0 ? "\nLoad step: not tried, because voltages compensate none "
                                         "of the loads."
                                       : "");
        return;
    }
    text_append(text, CERTIFICATE_TEXT,
                "\nLoad step: 5 %% of the effect of a suddenly applied load are left after %s%.3g "
                "periods of the\nfirst observed mode (five loads that 30 %% of the voltage range "
                "compensate).",
                loop->load_step < CERTIFICATE_LOAD_MOST ? "" : "more than ", loop->load_step);
    if (loop->angle >= CERTIFICATE_ANGLE)
        text_append(text, CERTIFICATE_TEXT,
                    "\nThis mode turns by %.3g rad in a tick, more than %g: the tick is a slow "
                    "low-pass by design;\na higher rate is faster.",
                    loop->angle, CERTIFICATE_ANGLE);
    else if (loop->load_step > CERTIFICATE_LOAD_STEP)
        text_append(text, CERTIFICATE_TEXT,
                    "\nNo settings that pass all required tests need at most %g periods.",
                    CERTIFICATE_LOAD_STEP);
}

/*
 * Append the sentence that says how fast the control loop follows the part of the readings that the
 * observed modes do not explain.
 */
static void residual_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    if (loop->observed > 0 && loop->residual > 0)
        text_append(text, CERTIFICATE_TEXT,
                    "\nWhat the observed modes do not explain (loads that only faster modes show, "
                    "static errors of the\nmodel): 5 %% of it are left in the estimate after %.3g "
                    "periods.",
                    loop->residual);
}

/*
 * Append the sentences that say by how many ticks the sensor readings may be older or newer than
 * the scene file states while the control loop stays stable.
 */
static void age_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    /*
     * Only `pzs check` searches for the largest age of the readings with which the loop is stable;
     * other commands try readings that are at most one tick older.
     */
    const bool is_open = loop->ends_at_most || (!loop->has_margins && loop->older > 0);
    text_append(
        text, CERTIFICATE_TEXT,
        "\nAge of the readings: every storm settles, too, with readings %d tick%s older%s than "
        "the scene says",
        loop->older, plural(loop->older), is_open ? " (more were not tried)" : "");
    if (loop->delay > 0)
        text_append(text, CERTIFICATE_TEXT, ",\nand %d tick%s newer", loop->newer,
                    plural(loop->newer));
    text_append(text, CERTIFICATE_TEXT, ".");
    const char *end = loop->delay > 0 ? "" : ".";
    if (loop->target.is_made)
        text_append(
            text, CERTIFICATE_TEXT,
            "\nAbout the shape of the target every storm settles %s readings 1 tick older%s",
            loop->target.older > 0 ? "with" : "NOT with", end);
    if (loop->target.is_made && loop->delay > 0)
        text_append(text, CERTIFICATE_TEXT, ", and %s readings 1 tick newer.",
                    loop->target.newer > 0 ? "with" : "NOT with");
    if (certificate_older(loop) == 0)
        text_append(text, CERTIFICATE_TEXT,
                    "\nREADINGS ONE TICK OLDER CAN MAKE THE LOOP SWING WITHOUT END.");
}

certificate_range certificate_rates(const certificate_loop *loop)
{
    certificate_range range = {""};
    if (loop->rate_to > loop->rate_from)
        snprintf(range.text, sizeof range.text, "%.6g to %.6g", loop->rate_from, loop->rate_to);
    else if (loop->rate_to > 0)
        snprintf(range.text, sizeof range.text, "%.6g", loop->rate_to);
    return range;
}

/*
 * Append the sentence on the tick rates at which a control loop with a vibration model passes the
 * tests of small vibrations and two storms (simulations with fast jumps of the target).
 */
static void rates_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    static const char tried[] = "(tried: 1/32 to 32 times the scene's rate)";
    if (!loop->has_rates)
        return;
    if (!(loop->rate_to > 0))
        text_append(text, CERTIFICATE_TEXT,
                    "\nNo other tick rate passes growth and two storms\n%s.", tried);
    else if (loop->is_stable)
        text_append(
            text, CERTIFICATE_TEXT,
            "\nTick rates that pass growth and two storms, with tables for each: %.6g to %.6g a "
            "second\n%s.",
            loop->rate_from, loop->rate_to, tried);
    else
        text_append(text, CERTIFICATE_TEXT,
                    "\nThe tick may be stable at %s ticks a second, where growth and two of the "
                    "storms\npass %s; check one with all tests.",
                    certificate_rates(loop).text, tried);
}

/*
 * Append the sentences on the stability margins of a control loop with a vibration model: the
 * static response and the natural frequencies of the structure, and the tick rates, with which the
 * loop stays stable.
 */
static void margin_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    if (loop->has_margins)
        text_append(
            text, CERTIFICATE_TEXT,
            "\nMargins of the growth: gain x %.3g, frequencies x %.3g to x %.3g (tried: gain to "
            "x 10,\nfrequencies x 0.1 to x 5).",
            loop->margin_gain, loop->margin_slow, loop->margin_fast);
    rates_text(loop, text);
}

/*
 * Append the sentences on the stability of the control loop on the structure linearised about the
 * equilibrium at its target shape.
 */
static void target_text(const certificate_target *target, char text[CERTIFICATE_TEXT])
{
    if (target->reason[0])
        text_append(text, CERTIFICATE_TEXT, "\nNot tried about the shape of the target: %.300s.",
                    target->reason);
    if (!target->is_made)
        return;
    text_append(
        text, CERTIFICATE_TEXT,
        "\nAbout the shape of the target (%.3g thicknesses, first frequency x %.3g): growth "
        "at most %.5g,\nat gain %g, frequency %g; %d of %d storms settle.",
        target->amplitude, target->first, target->radius, target->at_gain, target->at_frequency,
        target->storms - target->failed, target->storms);
}

/* Append to `text` a description of all stability tests of a control loop that damps vibration. */
static void loop_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    verdict_text(loop, text);
    text_append(
        text, CERTIFICATE_TEXT,
        "\nTried on structures with %d modes whose response to voltages is 0.8 to 1.33 of the "
        "model's (gain)\nand whose frequencies are 0.9 to 1.1 of the model's.\n"
        "Growth (factor by which small vibrations change in a tick; they decay below 1): at most "
        "%.5g,\nat gain %g, frequency %g.",
        loop->modes, loop->radius, loop->at_gain, loop->at_frequency);
    storm_text(loop, text);
    alarm_text(loop, text);
    gate_text(loop, text);
    load_text(loop, text);
    residual_text(loop, text);
    target_text(&loop->target, text);
    if (loop->is_stable)
        age_text(loop, text);
    margin_text(loop, text);
}

void certificate_text(const certificate *certificate, char text[CERTIFICATE_TEXT])
{
    char verdict[SCENE_ERROR] = "The control step has no vibration model; the tables get one where "
                                "the scene gives control: {rate: ...}.\n",
         range[SCENE_ERROR];
    text[0] = '\0';
    if (certificate->is_made && certificate->has_modes && !certificate->is_assessed &&
        certificate->reason[0])
        snprintf(text, CERTIFICATE_TEXT, "The stability of the control loop is not known: %s",
                 certificate->reason);
    if (!certificate->is_assessed)
        return;
    if (certificate->is_loaded)
        text_append(text, CERTIFICATE_TEXT,
                    "Tables, modes and structures are those about the equilibrium under the "
                    "loads.\n");
    if (certificate->loop.is_made) {
        loop_text(&certificate->loop, text);
        return;
    }
    if (certificate->rate > 0)
        rate_text(certificate, verdict);
    range_text(certificate, range);
    if (certificate->bandwidth > 0)
        text_append(text, CERTIFICATE_TEXT, "The amplifiers lag, with a corner of %g Hz.\n",
                    certificate->bandwidth);
    if (certificate->has_gains)
        gains_text(certificate, text);
    else
        text_append(text, CERTIFICATE_TEXT, "%s%s", verdict, range);
    if (certificate->assumes_measured)
        text_append(text, CERTIFICATE_TEXT, "\nJudged as if every target node were measured.");
}
