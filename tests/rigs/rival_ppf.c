/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Positive position feedback. The coordinate of each of the first modes, fitted to the readings
 * minus the static shape, drives a filter of second order,
 *   x'' + 2 ratio w x' + w^2 x = w^2 (mode's coordinate),  w = filter_frequency * mode's frequency,
 * and the filters' coordinates times `feedback` become static coordinates of the modes, by the
 * pseudo-inverse of the modes' responses to the voltages. Beside it the bounded static optimum for
 * the target minus a disturbance that an integrator estimates.
 */
#include "rival_ppf.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/dense.h"
#include "../../host_tools/model/propagator.h"

/* feedback [inputs][modes] = settings.feedback * pseudo-inverse of the modes' static responses. */
static void fill_feedback(rival *rival)
{
    const size_t modes = rival->settings.modes, inputs = rival->loop.problem.inputs;
    const double *modal = rival->loop.structure->modal;
    double *gram = calloc(2 * modes * modes + 1, sizeof *gram), *inverse = gram + modes * modes;
    assert_non_null(gram);
    for (size_t k = 0; k < modes; k++)
        for (size_t l = 0; l < modes; l++)
            for (size_t j = 0; j < inputs; j++)
                gram[k * modes + l] += modal[k * inputs + j] * modal[l * inputs + j];
    assert_int_equal(dense_invert(gram, inverse, modes), 0);
    for (size_t j = 0; j < inputs; j++)
        for (size_t k = 0; k < modes; k++)
            for (size_t l = 0; l < modes; l++)
                rival->feedback[j * modes + k] +=
                    rival->settings.feedback * modal[l * inputs + j] * inverse[l * modes + k];
    free(gram);
}

void ppf_open(rival *rival)
{
    const damped_loop *loop = &rival->loop;
    assert_true(rival->settings.modes <= loop->modes);
    fill_feedback(rival);
    for (size_t k = 0; k < rival->settings.modes; k++)
        modal_propagator(loop->structure->omega[k] * rival->settings.filter_frequency,
                         rival->settings.filter_ratio, loop->interval, rival->turn + 4 * k);
}

void ppf_reset(rival *rival)
{
    const size_t outputs = rival->loop.problem.outputs, inputs = rival->loop.problem.inputs;
    if (rival->settings.kind != RIVAL_PPF)
        return;
    rival->tick = 0;
    memset(rival->law.disturbance, 0, outputs * sizeof *rival->law.disturbance);
    memset(rival->state, 0, 2 * rival->settings.modes * sizeof *rival->state);
    memset(rival->fixed, 0, inputs * sizeof *rival->fixed);
    memset(rival->history, 0,
           ((size_t)rival->loop.vibration.delay + 1) * outputs * sizeof *rival->history);
}

/* Row of the history that is as old as the readings, and is the next to be written. */
static double *oldest(rival *rival)
{
    const int rows = rival->loop.vibration.delay + 1;
    return rival->history + (size_t)(rival->tick % rows) * rival->loop.problem.outputs;
}

/* Drive the filters with the modal coordinates fitted to deviation [outputs]. */
static void drive_filters(rival *rival, const double *deviation)
{
    const damped_loop *loop = &rival->loop;
    const modal_structure *structure = loop->structure;
    const size_t modes = rival->settings.modes, all = loop->modes;
    double *fit = calloc(all + 1, sizeof *fit);
    assert_non_null(fit);
    for (size_t i = 0; i < structure->outputs; i++)
        for (size_t k = 0; k < all; k++)
            fit[k] += structure->shape[i * structure->modes + k] * deviation[i];
    for (size_t k = 0; k < modes; k++) {
        const double *turn = rival->turn + 4 * k;
        double coordinate = 0;
        for (size_t l = 0; l < all; l++)
            coordinate += loop->gains.explain[k * all + l] * fit[l];
        const double left = rival->state[k] - coordinate, speed = rival->state[modes + k];
        rival->state[k] = coordinate + turn[0] * left + turn[1] * speed;
        rival->state[modes + k] = turn[2] * left + turn[3] * speed;
    }
    free(fit);
}

/* Move the voltages without feedback the part `share` of the way to the bounded static optimum. */
static void move_fixed(rival *rival)
{
    const double *optimum = rival_solve_bounded(rival);
    for (size_t j = 0; j < rival->loop.problem.inputs; j++) {
        const double step = (double)rival->loop.problem.step_limit[j],
                     change = rival->settings.share * (optimum[j] - rival->fixed[j]);
        rival->fixed[j] += fmin(fmax(change, -step), step);
    }
}

void ppf_choose(rival *rival, const pzs_loop_signals *signals)
{
    const size_t outputs = rival->loop.problem.outputs, modes = rival->settings.modes;
    const double *before = oldest(rival);
    double *disturbance = rival->law.disturbance, *deviation = rival->law.required;
    for (size_t i = 0; i < outputs; i++)
        deviation[i] = signals->measured[i] - before[i] - disturbance[i];
    drive_filters(rival, deviation);
    for (size_t i = 0; i < outputs; i++) {
        disturbance[i] += rival->settings.gain * deviation[i];
        rival->law.required[i] = signals->wanted[i] - disturbance[i];
    }
    move_fixed(rival);
    for (size_t j = 0; j < rival->loop.problem.inputs; j++) {
        rival->law.next[j] = rival->fixed[j];
        for (size_t k = 0; k < modes; k++)
            rival->law.next[j] += rival->feedback[j * modes + k] * rival->state[k];
    }
}

void ppf_keep(rival *rival)
{
    const modal_structure *structure = rival->loop.structure;
    double *row = oldest(rival);
    for (size_t i = 0; i < structure->outputs; i++) {
        row[i] = 0;
        for (size_t j = 0; j < structure->inputs; j++)
            row[i] += structure->influence[i * structure->inputs + j] * rival->fixed[j];
    }
    rival->tick++;
}
