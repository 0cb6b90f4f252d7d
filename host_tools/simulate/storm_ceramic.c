/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Amplifiers, hysteresis and creep of the ceramic in storms, simulations of a control loop on a
 * structure with mass (storm_state.h).
 */
#include <string.h>
#include "../../lib/control/hysteresis.h"
#include "imperfections.h"
#include "storm_state.h"

/*
 * State of the ceramic of electrode k in the hysteresis model of the scene file: the outputs of its
 * play operators (hysteresis) and of its lags (creep).
 */
static hysteresis_memory memory_of(const storm *storm, size_t k)
{
    const hysteresis_memory memory = {storm->play + k * PZS_PLAY_LIMIT,
                                      storm->creep + k * PZS_CREEP_LIMIT};
    return memory;
}

/*
 * Return the equivalent voltage that the ceramic of electrode k has after its voltage has moved
 * from the present one to another, in a loop that does not compensate hysteresis.
 */
static double effect_at(const storm *storm, size_t k, double voltage)
{
    const design *design = &storm->rig->analysis->design;
    double play[PLAYS];
    memcpy(play, storm->play + k * PZS_PLAY_LIMIT, sizeof play);
    return imperfections_play(play, voltage, (design->upper[k] - design->lower[k]) / 2,
                              storm->width);
}

bool storm_renew_stroke(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers;
    const design *design = &storm->rig->analysis->design;
    bool has_changed = false;
    for (size_t k = 0; k < amplifiers && storm->width > 0; k++) {
        double *stroke = storm->stroke + k;
        const double low = effect_at(storm, k, design->lower[k]);
        const double high = effect_at(storm, k, design->upper[k]);
        has_changed |= low < stroke[0] || low > stroke[0] || high < stroke[amplifiers] ||
                       high > stroke[amplifiers];
        stroke[0] = low;
        stroke[amplifiers] = high;
    }
    return has_changed;
}

/*
 * Width of the hysteresis loop of the ceramic in a simulation whose loop does not compensate
 * hysteresis. Simulations without limits have none, because it is relative to the voltage range.
 */
static double width_of(const storm *storm)
{
    const bool has_play = storm->plant->has_hysteresis && !storm->plant->ceramic;
    return has_play && !storm_is_free(storm) ? storm->rig->play : 0;
}

void storm_start_ceramic(storm *storm)
{
    const size_t amplifiers = storm->rig->amplifiers;
    const storm_ceramic *ceramic = storm->plant->ceramic;
    const double *lower = storm->rig->analysis->design.problem.lower,
                 *upper = storm->rig->analysis->design.problem.upper;
    for (int k = 0; k < storm->blocks; k++)
        if (storm->block[k].type == &pzs_effect_block)
            storm->hysteresis = &storm->rig->ceramic.tables;
    storm->width = width_of(storm);
    for (size_t k = 0; k < amplifiers; k++) {
        double *stroke = storm->stroke + k;
        stroke[0] = ceramic ? ceramic->lowest[k] : lower[k];
        stroke[amplifiers] = ceramic ? ceramic->highest[k] : upper[k];
        if (ceramic || !storm->hysteresis)
            continue;
        const hysteresis_memory memory = memory_of(storm, k);
        pzs_hysteresis_rest(storm->hysteresis, (uint32_t)k, memory, 0);
        stroke[0] = pzs_hysteresis_effect(storm->hysteresis, (uint32_t)k, memory, lower[k]);
        stroke[amplifiers] =
            pzs_hysteresis_effect(storm->hysteresis, (uint32_t)k, memory, upper[k]);
    }
    (void)storm_renew_stroke(storm);
}

/*
 * Advance the output voltages of the amplifiers, which follow their commands with a lag, by one
 * tick interval.
 */
static void drive_amplifiers(storm *storm)
{
    const double bandwidth = storm->rig->bandwidth * (1 - storm->plant->less_bandwidth);
    for (size_t k = 0; k < storm->rig->amplifiers; k++)
        storm->driven[k] = bandwidth > 0 ? amplifier_lag(&storm->output[k], storm->voltage[k],
                                                         bandwidth, storm->rig->interval)
                                         : storm->voltage[k];
}

/*
 * Return the voltage (V) that would act on the ceramic of electrode k if it had no hysteresis. It
 * is a linear function of the amplifier's mean output voltage. At the lower and at the upper
 * voltage limit it equals the voltage that acts with hysteresis (storm->stroke).
 */
static double straight_effect(const storm *storm, size_t k)
{
    const size_t amplifiers = storm->rig->amplifiers;
    const pzs_problem *problem = &storm->rig->analysis->design.problem;
    const double low = storm->stroke[k], high = storm->stroke[amplifiers + k];
    const double range = problem->upper[k] - problem->lower[k];
    const double part = range > 0 ? (storm->driven[k] - problem->lower[k]) / range : 0;
    return low + part * (high - low);
}

/* Apply the hysteresis of a ceramic that the loop does not compensate. */
static void apply_play(storm *storm)
{
    const design *design = &storm->rig->analysis->design;
    for (size_t k = 0; k < storm->rig->amplifiers; k++)
        storm->acting[k] =
            imperfections_play(storm->play + k * PZS_PLAY_LIMIT, storm->driven[k],
                               (design->upper[k] - design->lower[k]) / 2, storm->width);
}

void storm_advance_ceramic(storm *storm)
{
    const storm_ceramic *ceramic = storm->plant->ceramic;
    drive_amplifiers(storm);
    memcpy(storm->acting, storm->driven, storm->rig->amplifiers * sizeof *storm->acting);
    if (ceramic) {
        ceramic->act(ceramic->state, storm->driven, storm->acting);
        return;
    }
    if (storm->width > 0)
        apply_play(storm);
    for (size_t k = 0; k < storm->rig->amplifiers && storm->hysteresis; k++) {
        const hysteresis_memory memory = memory_of(storm, k);
        const double straight = straight_effect(storm, k);
        const double bent =
            pzs_hysteresis_effect(storm->hysteresis, (uint32_t)k, memory, storm->driven[k]);
        storm->acting[k] = bent + storm->plant->less_hysteresis * (straight - bent);
        pzs_hysteresis_remember(storm->hysteresis, (uint32_t)k, memory, storm->driven[k], 1);
    }
}
