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
 * Fill the matrix that advances the vibration of the structure under the control loop by one tick.
 * Its states are, for each vibration mode just before the tick, the deviation e of the modal
 * coordinate from its static equilibrium and the modal velocity p divided by the angular frequency,
 * then the measured coordinates in equilibrium, h, of past ticks. L is the loop matrix (see
 * `loop`), k the response of the structure to voltages relative to the controller's model, and r[0]
 * to r[3] are the entries 11, 12, 21 and 22 of the matrix that advances e and p of one mode by the
 * free vibration of one tick. The voltages of the tick at time t have the equilibrium -h(t - delay)
 * in the model. The controller measures h(t) = L e(t) + (1 - k) h(t - delay - 1): the vibration,
 * and what the voltages do more or less than the model says. With the change of the equilibrium g =
 * k (h(t - delay) - h(t - delay - 1)), so that delay + 1 past measurements are needed:
 *   e' = r[0] (e + g) + r[1] p
 *   p' = r[2] (e + g) + r[3] p
 *   loop [modes][stride] in  loop matrix L; the first `modes` columns are used. Entry (i, j) is the
 *       static coordinate of mode i under the voltages that the controller subtracts per unit of
 *       mode j
 */
static void fill_loop(const double *loop, int stride, const double *square, int modes,
                      const double *damping, double gain, int delay, double interval,
                      double *matrix)
{
    const size_t m = (size_t)modes, order = m * (size_t)(delay + 3);
    const size_t late = m * (size_t)(delay + 1), later = m * (size_t)(delay + 2);
    memset(matrix, 0, order * order * sizeof *matrix);
    for (size_t i = 0; i < m; i++) {
        double r[4];
        const double *measured = loop + i * (size_t)stride;
        modal_propagator(sqrt(square[i]), damping[i], interval, r);
        for (size_t half = 0; half < 2; half++) {
            double *row = matrix + (half * m + i) * order;
            const double moved = r[2 * half] * gain;
            row[i] += r[2 * half];
            row[m + i] += r[2 * half + 1];
            for (size_t j = 0; j < m && delay == 0; j++)
                row[j] += moved * measured[j];
            row[later + i] -= delay == 0 ? moved * gain : moved;
            if (delay > 0)
                row[late + i] += moved;
        }
        memcpy(matrix + (2 * m + i) * order, measured, m * sizeof *measured);
        matrix[(2 * m + i) * order + later + i] += 1 - gain;
        for (size_t k = 3; k < (size_t)delay + 3; k++)
            matrix[(k * m + i) * order + (k - 1) * m + i] = 1;
    }
}

/*
 * Number of vibration modes whose vibration lasts from tick to tick; the other modes contribute
 * only their static response to the loop.
 */
static int lasting_modes(const double *square, int modes, const double *damping, double interval)
{
    int count = 0;
    while (count < modes && damping[count] * sqrt(square[count]) * interval < decayed)
        count++;
    return count;
}

double certificate_radius(const double *loop, const double *square, int modes,
                          const double *damping, double gain, int delay, double interval,
                          int squarings)
{
    const int count = lasting_modes(square, modes, damping, interval);
    const size_t order = (size_t)count * (size_t)(delay + 3);
    double *matrix = malloc((2 * order * order + 1) * sizeof *matrix), radius = (double)NAN;
    if (matrix) {
        fill_loop(loop, modes, square, count, damping, gain, delay, interval, matrix);
        radius = eigen_radius(matrix, matrix + order * order, order, squarings);
    }
    free(matrix);
    return radius;
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
    if (!loop->is_stable && loop->cure > 0)
        text_append(text, CERTIFICATE_TEXT,
                    "The damped tick is not safe. Some combinations of voltages hardly move the "
                    "target, but they move modes:\nwith limits: {regularisation: {relative: %g}} "
                    "vibration decays and ten storms settle.",
                    loop->cure);
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
        text_append(text, CERTIFICATE_TEXT, "; the amplifiers lag, with a corner of %g Hz",
                    loop->bandwidth);
    text_append(text, CERTIFICATE_TEXT, "):");
    if (loop->storms == 0) {
        text_append(text, CERTIFICATE_TEXT, " none was run.");
        return;
    }
    text_append(text, CERTIFICATE_TEXT,
                "\n%d of %d storms settle; the worst ends %.3g of the target from the best shape "
                "(allowed: %g).",
                loop->storms - loop->failed, loop->storms, loop->worst, CERTIFICATE_TOLERANCE);
}

/*
 * Append the sentences that say by how many ticks the sensor readings may be older or newer than
 * the scene file states while the control loop stays stable.
 */
static void age_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    text_append(
        text, CERTIFICATE_TEXT,
        "\nAge of the readings: every storm settles, too, with readings %d tick%s older%s than "
        "the scene says",
        loop->older, plural(loop->older), loop->ends_at_most ? " (more were not tried)" : "");
    if (loop->delay > 0)
        text_append(text, CERTIFICATE_TEXT, ",\nand %d tick%s newer", loop->newer,
                    plural(loop->newer));
    text_append(text, CERTIFICATE_TEXT, ".");
    if (loop->target.is_made)
        text_append(
            text, CERTIFICATE_TEXT,
            "\nAbout the shape of the target every storm settles %s readings 1 tick older%s",
            loop->target.older > 0 ? "with" : "NOT with", loop->delay > 0 ? "" : ".");
    if (loop->target.is_made && loop->delay > 0)
        text_append(text, CERTIFICATE_TEXT, ", and %s readings 1 tick newer.",
                    loop->target.newer > 0 ? "with" : "NOT with");
    if (certificate_older(loop) == 0)
        text_append(text, CERTIFICATE_TEXT,
                    "\nREADINGS ONE TICK OLDER CAN MAKE THE LOOP SWING WITHOUT END.");
}

/*
 * Append the sentences that say with which static response and natural frequencies of the structure
 * and at which tick rates a control loop with a vibration model stays stable.
 */
static void margin_text(const certificate_loop *loop, char text[CERTIFICATE_TEXT])
{
    if (loop->has_margins)
        text_append(
            text, CERTIFICATE_TEXT,
            "\nMargins of the growth: gain x %.3g, frequencies x %.3g to x %.3g (tried: gain to "
            "x 10,\nfrequencies x 0.1 to x 5).",
            loop->margin_gain, loop->margin_slow, loop->margin_fast);
    if (loop->rate_to > 0)
        text_append(
            text, CERTIFICATE_TEXT,
            "\nTick rates that pass growth and two storms, with tables for each: %.6g to %.6g a "
            "second\n(tried: 1/32 to 32 times the scene's rate).",
            loop->rate_from, loop->rate_to);
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

/* Append all sentences on the stability tests of a control loop with a vibration model. */
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
    text_append(text, CERTIFICATE_TEXT, "%s%s%s", verdict, range,
                certificate->assumes_measured ? "\nJudged as if every target node were measured."
                                              : "");
}
