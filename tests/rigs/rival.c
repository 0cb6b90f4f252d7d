/* SPDX-License-Identifier: BSD-2-Clause */
/* Control laws to compare the vibration damper with, as blocks of the control tick (rival.h). */
#include "rival.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../lib/control/control.h"
#include "rival_lqg.h"
#include "rival_ppf.h"
#include "rival_wish.h"

damper_settings rival_observer(double kick, double drift)
{
    damper_settings settings = damper_default_settings();
    settings.damping = 0;
    settings.follow = 1e6;
    settings.follow_limit = 1;
    settings.kick = kick;
    settings.drift = drift;
    return settings;
}

/* ---- blocks ------------------------------------------------------------ */

/* The rival whose law computes the voltages of a loop: its first member is the loop's problem. */
static rival *rival_of(const pzs_loop_signals *signals)
{
    return (rival *)(void *)(uintptr_t)signals->control->state.problem;
}

static size_t block_bytes(const void *tables, const pzs_problem *problem)
{
    return pzs_step_block.block_bytes(tables, problem);
}

static pzs_status block_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const pzs_status status = pzs_step_block.block_init(self, tables, signals);
    if (status == PZS_OK) {
        lqg_reset(rival_of(signals));
        ppf_reset(rival_of(signals));
    }
    return status;
}

/* The library's control step, with its work counted. */
static pzs_status counted_tick(void *self, pzs_loop_signals *signals)
{
    rival *rival = rival_of(signals);
    const pzs_status status = pzs_step_block.block_tick(self, signals);
    rival->work += (double)signals->control->info.work;
    rival->ticks++;
    return status;
}

/* Control step that goes a part of the way. */
static pzs_status step_tick(void *self, pzs_loop_signals *signals)
{
    const rival *rival = rival_of(signals);
    if (rival->settings.share < 1)
        pzs_control_damp(signals->control, (pzs_real)rival->settings.share, rival->gradient, NULL);
    return counted_tick(self, signals);
}

static pzs_status wish_tick(void *self, pzs_loop_signals *signals)
{
    rival *rival = rival_of(signals);
    wish_change(rival, signals->wanted, rival->law.required);
    signals->wanted = rival->law.required;
    return counted_tick(self, signals);
}

static pzs_status lqg_tick(void *self, pzs_loop_signals *signals)
{
    rival *rival = rival_of(signals);
    (void)self;
    pzs_control_predict(signals->control);
    lqg_choose(rival, signals);
    law_set_voltages(&rival->law, signals);
    rival->ticks++;
    return PZS_OK;
}

static pzs_status ppf_tick(void *self, pzs_loop_signals *signals)
{
    rival *rival = rival_of(signals);
    (void)self;
    ppf_choose(rival, signals);
    law_set_voltages(&rival->law, signals);
    ppf_keep(rival);
    rival->ticks++;
    return PZS_OK;
}

static const pzs_block_type step_law = {"slow step", PZS_PHASE_STEP, block_bytes,
                                        block_init,  step_tick,      NULL};
static const pzs_block_type counted_law = {"step",     PZS_PHASE_STEP, block_bytes,
                                           block_init, counted_tick,   NULL};
static const pzs_block_type wish_law = {"damped wish", PZS_PHASE_STEP, block_bytes,
                                        block_init,    wish_tick,      NULL};
static const pzs_block_type lqg_law = {"regulator", PZS_PHASE_STEP, block_bytes,
                                       block_init,  lqg_tick,       NULL};
static const pzs_block_type ppf_law = {"position feedback", PZS_PHASE_STEP, block_bytes,
                                       block_init,          ppf_tick,       NULL};

/* How each kind runs in the loop. */
static const struct {
    const pzs_block_type *law;
    bool is_observed;  /* the loop has the observer of the vibration damper */
    bool is_corrected; /* the loop has the library's correction of late readings */
} way[] = {
    [RIVAL_STEP] = {&step_law, false, true},
    [RIVAL_LEAKY] = {&law_leaky_block, false, true},
    [RIVAL_CLIPPED] = {&law_clipped_block, false, true},
    [RIVAL_LQG] = {&lqg_law, true, false},
    [RIVAL_LQG_BOUNDED] = {&lqg_law, true, false},
    [RIVAL_PPF] = {&ppf_law, false, false},
    [RIVAL_WISH] = {&wish_law, true, false},
    [RIVAL_DAMPER] = {&counted_law, true, false},
};

/* ---- set-up ------------------------------------------------------------ */

static void open_bounded(rival *rival)
{
    const size_t bytes = pzs_control_bytes(&rival->loop.problem);
    rival->bounded_problem = rival->loop.problem;
    rival->bounded_problem.step_limit = rival->wide;
    assert_int_equal(pzs_problem_seal(&rival->bounded_problem), PZS_OK);
    rival->bounded_work = malloc(bytes);
    assert_int_equal(pzs_control_init(&rival->bounded, &rival->bounded_problem, NULL,
                                      rival->bounded_work, bytes),
                     PZS_OK);
}

static void take_memory(rival *rival)
{
    const size_t inputs = rival->loop.problem.inputs, outputs = rival->loop.problem.outputs,
                 modes = rival->loop.modes, delays = (size_t)rival->loop.vibration.delay + 1,
                 states = 2 * modes + inputs;
    double *at = rival->memory =
        calloc(5 * inputs + inputs * states + 4 * modes + states + delays * outputs,
               sizeof *rival->memory);
    assert_non_null(at);
    rival->wide = at, at += inputs;
    rival->gradient = at, at += inputs;
    rival->reference = at, at += inputs;
    rival->aim = at, at += inputs;
    rival->fixed = at, at += inputs;
    rival->feedback = at, at += inputs * states;
    rival->turn = at, at += 4 * modes;
    rival->state = at, at += states;
    rival->history = at;
    for (size_t j = 0; j < inputs; j++)
        rival->wide[j] = HUGE_VAL;
}

static void open_law(rival *rival)
{
    const rival_settings *settings = &rival->settings;
    const double scale = rival_scale(rival);
    assert_true(law_open(&rival->law, &rival->loop.problem, settings->regularisation * scale));
    rival->law.gain = settings->gain;
    rival->law.leak = settings->leak;
    rival->law.share = settings->share;
    open_bounded(rival);
    if (settings->kind == RIVAL_LQG || settings->kind == RIVAL_LQG_BOUNDED)
        lqg_open(rival);
    if (settings->kind == RIVAL_PPF)
        ppf_open(rival);
    if (settings->kind == RIVAL_WISH)
        wish_open(rival);
}

void rival_open(rival *rival, const modal_structure *structure, double interval, double step_limit,
                int delay, const rival_settings *settings)
{
    const bool has_observer = way[settings->kind].is_observed;
    const damper_settings none = damper_default_settings();
    memset(rival, 0, sizeof *rival);
    rival->settings = *settings;
    damped_loop_open(&rival->loop, structure, interval, step_limit,
                     delay + (has_observer ? settings->damper.later : 0), NULL, 0,
                     has_observer ? &settings->damper : &none);
    take_memory(rival);
    open_law(rival);
    if (settings->kind == RIVAL_DAMPER)
        rival->loop.governor.part = (pzs_real)settings->governor;
    const pzs_block block = {way[settings->kind].law, &rival->law};
    damped_loop_replace(&rival->loop, &block, has_observer, way[settings->kind].is_corrected);
}

void rival_close(rival *rival)
{
    damped_loop_close(&rival->loop);
    law_close(&rival->law);
    free(rival->bounded_work);
    free(rival->memory);
}

/* ---- work -------------------------------------------------------------- */

double rival_work(const rival *rival)
{
    const double inputs = rival->loop.problem.inputs, outputs = rival->loop.problem.outputs,
                 modes = (double)rival->loop.modes, matrix = inputs * outputs,
                 observer = 6 * modes * outputs + matrix + 2 * inputs * modes + 4 * modes * modes;
    switch (rival->settings.kind) {
    case RIVAL_STEP: return 2 * matrix; /* predicted shape, gradient */
    case RIVAL_LEAKY:
    case RIVAL_CLIPPED: return matrix; /* pseudo-inverse times error */
    case RIVAL_LQG:
    case RIVAL_LQG_BOUNDED: return observer + matrix + inputs * (2 * modes + inputs);
    case RIVAL_PPF:
        return 2 * matrix + modes * outputs + (double)rival->settings.modes * (modes + inputs);
    default: return observer + matrix; /* gradient */
    }
}
