/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Gains of the control tick that damps vibration (damper_gains.h). The Riccati equation of the
 * observer is solved by structured doubling. The damping gradient is the term that the tick
 * subtracts from the gradient of its objective to damp vibration.
 */
#include "damper_gains.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "dense.h"
#include "propagator.h"
#include "riccati.h"

/*
 * Variance of the process noise that the vibration observer, a Kalman filter, assumes for the
 * position of a vibration mode in one tick; it keeps the Riccati equation regular.
 */
static const double position_noise = 1e-12;

/*
 * Regularisation of the least-squares fit of modal coordinates to readings, relative to the mean
 * diagonal entry of the normal matrix: the resolution of single precision.
 */
static const double ridge = 1e-7;

/*
 * Amplifiers that lag respond to a vibration mode with less amplitude, by a factor r, and with a
 * later phase. The damping gradient makes up for the phase, and for the part r^(lead_loss - 1) of
 * the amplitude: with 1 the mode is damped more weakly by the factor r, with 0 the noise of the
 * sensors moves the voltages by 1/r more and the step limits bind more often. With 0.5 all storms
 * of tests/unit/test_lag.c settle, and loads are compensated fastest.
 */
static const double lead_loss = 0.5;

damper_settings damper_default_settings(void)
{
    return (damper_settings){.damping = 0.75,
                             .cut = 0.6,
                             .observed = 2,
                             .follow = 0.317,
                             .follow_limit = 0.15,
                             .mix = 0.75,
                             .kick = 0.25,
                             .drift = 0.21,
                             .slow = 0.005,
                             .fading_periods = 2,
                             .later = 0,
                             .is_gradient = false};
}

/* ---- Riccati equation ------------------------------------------------- */

/*
 * Set the matrices of the Riccati equation of the vibration observer: transposed transition matrix,
 * measurement information and process noise of the vibration modes.
 */
static void start_riccati(riccati *riccati, const damper_model *model,
                          const damper_settings *settings)
{
    const size_t modes = model->modes, all = 3 * modes;
    for (size_t i = 0; i < modes; i++) {
        double r[4];
        const double fall = model->angle[0] / model->angle[i] / sqrt((double)model->sensors);
        const double kick = settings->kick * fall, drift = settings->drift * fall;
        modal_propagator(model->angle[i], model->ratio[i], 1, r);
        riccati->a[i * all + i] = r[0];
        riccati->a[(modes + i) * all + i] = r[1];
        riccati->a[(2 * modes + i) * all + i] = 1 - r[0];
        riccati->a[i * all + modes + i] = r[2];
        riccati->a[(modes + i) * all + modes + i] = r[3];
        riccati->a[(2 * modes + i) * all + modes + i] = -r[2];
        riccati->a[(2 * modes + i) * all + 2 * modes + i] = 1;
        riccati->h[i * all + i] = position_noise;
        riccati->h[(modes + i) * all + modes + i] = kick * kick;
        riccati->h[(2 * modes + i) * all + 2 * modes + i] = drift * drift;
        for (size_t j = 0; j < modes; j++)
            riccati->g[i * all + j] = model->overlap[i * modes + j];
    }
}

/*
 * Compute the gains of the observer of vibration modes from the covariance of the observer's error.
 *   observer [3 modes][modes] out  gains by which the position, the velocity and the static
 *                                  position under loads of each mode are corrected
 */
static int fill_observer(double *observer, riccati *riccati, const damper_model *model)
{
    const size_t modes = model->modes, all = 3 * modes;
    for (size_t i = 0; i < modes; i++)
        for (size_t j = 0; j < modes; j++) {
            double sum = i == j ? 1 : 0;
            for (size_t k = 0; k < modes; k++)
                sum += model->overlap[i * modes + k] * riccati->h[k * all + j];
            riccati->work[i * modes + j] = sum;
        }
    if (dense_invert(riccati->work, riccati->w, modes) != 0)
        return -1;
    for (size_t i = 0; i < all; i++)
        for (size_t j = 0; j < modes; j++) {
            observer[i * modes + j] = 0;
            for (size_t k = 0; k < modes; k++)
                observer[i * modes + j] += riccati->h[i * all + k] * riccati->w[k * modes + j];
        }
    return 0;
}

static int solve_observer(damper_gains *gains, const damper_model *model,
                          const damper_settings *settings)
{
    riccati riccati;
    int failed = riccati_open(&riccati, 3 * model->modes);
    if (!failed) {
        start_riccati(&riccati, model, settings);
        failed = riccati_solve(&riccati);
    }
    if (!failed)
        failed = fill_observer(gains->observer, &riccati, model);
    if (!failed && gains->covariance)
        memcpy(gains->covariance, riccati.h, riccati.order * riccati.order * sizeof *riccati.h);
    riccati_close(&riccati);
    return failed;
}

/*
 * Compute the matrix that fits modal coordinates to readings by least squares: the inverse of the
 * slightly regularised normal matrix model->overlap.
 *   explain [modes][modes] out  this matrix
 */
static int fill_explain(double *explain, const damper_model *model)
{
    const size_t modes = model->modes;
    double *copy = malloc((modes * modes + 1) * sizeof *copy), trace = 0;
    if (!copy)
        return -1;
    memcpy(copy, model->overlap, modes * modes * sizeof *copy);
    for (size_t i = 0; i < modes; i++)
        trace += copy[i * modes + i];
    for (size_t i = 0; i < modes; i++)
        copy[i * modes + i] += ridge * trace / (double)modes;
    const int failed = dense_invert(copy, explain, modes);
    free(copy);
    return failed;
}

/* ---- damping ---------------------------------------------------------- */

/*
 * Change of a vibration mode's static equilibrium that the control tick commands to damp the mode,
 * per unit of the mode's deviation from its equilibrium.
 *   angle in  phase angle of the mode in a tick, angular frequency times tick interval (rad)
 */
static double damping_of(double angle, const damper_settings *settings)
{
    const double fade = fmin(fmax(2 - angle / settings->cut, 0), 1);
    return settings->damping * angle * fade;
}

static void fill_damping(double *damping, const damper_model *model,
                         const damper_settings *settings)
{
    for (size_t i = 0; i < model->modes; i++) {
        const double part = damping_of(model->angle[i], settings);
        for (size_t j = 0; j < model->inputs; j++) {
            const double gradient = settings->is_gradient
                                        ? model->square[i] * model->modal[i * model->inputs + j]
                                        : model->lift[j * model->modes + i];
            damping[i * model->inputs + j] = part * gradient;
        }
    }
}

/*
 * Compute the lag of the amplifiers in a tick, and the weights that advance the phase of each
 * vibration mode's damping by that of the lag; multiply the damping gradient by the gain of this
 * advance (lib/control/vibration.c).
 */
static void fill_lag(damper_gains *gains, const damper_model *model, double mix)
{
    const size_t modes = model->modes;
    const double kept = exp(-model->lag), moved = -expm1(-model->lag), mean = moved / model->lag;
    double *by_velocity = gains->lag + 2, *by_lag = by_velocity + modes;
    gains->lag[0] = kept;
    gains->lag[1] = mean;
    for (size_t i = 0; i < modes; i++) {
        const double angle = model->angle[i];
        const double in_phase = (1 - kept * cos(angle)) / moved, ahead = kept * sin(angle) / moved;
        const double part = pow(hypot(in_phase, ahead), -lead_loss);
        by_velocity[i] = ahead / in_phase;
        by_lag[i] = kept * (1 - mean + (mean - kept) * cos(angle)) / moved / in_phase +
                    (1 - mix) * (mean - kept);
        for (size_t j = 0; j < model->inputs; j++)
            gains->damping[i * model->inputs + j] *= in_phase * part;
    }
}

int damper_compute(damper_gains *gains, const damper_model *model, const damper_settings *settings)
{
    const size_t modes = model->modes;
    for (size_t i = 0; i < modes; i++) {
        double r[4];
        modal_propagator(model->angle[i], model->ratio[i], 1, r);
        for (size_t k = 0; k < 4; k++)
            gains->turn[k * modes + i] = r[k];
        gains->inverse_angle[i] = 1 / model->angle[i];
    }
    fill_damping(gains->damping, model, settings);
    gains->share = settings->follow_limit;
    if (modes > 0)
        gains->share = fmin(settings->follow * model->angle[0], settings->follow_limit);
    gains->mix = settings->mix;
    if (model->lag > 0)
        fill_lag(gains, model, settings->mix);
    gains->slow = settings->slow;
    if (modes == 0)
        return 0;
    return solve_observer(gains, model, settings) == 0 ? fill_explain(gains->explain, model) : -1;
}
