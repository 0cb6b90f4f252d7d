/* SPDX-License-Identifier: BSD-2-Clause */
/* Tables of the compensation of hysteresis and creep of the ceramic (compensation.h). */
#include "compensation.h"
#include <math.h>
#include <string.h>
#include "../../lib/control/hysteresis.h"

/*
 * Tick rate (1/s) that tables and simulations assume if the scene file gives none.
 */
static const double usual_rate = 1000;

static void copy(double *to, const scene_short_list *from)
{
    memcpy(to, from->value, (size_t)from->count * sizeof *to);
}

/*
 * Set the pointers in the hysteresis tables of a compensation to the arrays in its other members.
 */
static void point(compensation *compensation)
{
    pzs_hysteresis *tables = &compensation->tables;
    tables->middle = &compensation->middle;
    tables->half_range = &compensation->half_range;
    tables->offset = &compensation->offset;
    tables->slope = compensation->slope;
    tables->slack = compensation->slack;
    tables->above = compensation->above;
    tables->below = compensation->below;
    tables->creep = compensation->creep;
    tables->creep_rate = compensation->creep_rate;
}

/*
 * Constant (V) that the hysteresis model adds to the equivalent voltage of an electrode, the
 * voltage that would cause the same strain without hysteresis. With this constant an electrode that
 * has always been at 0 V has the equivalent voltage 0.
 */
static double offset_of(const pzs_hysteresis *tables)
{
    double play[SCENE_PLAYS] = {0}, creep[SCENE_CREEPS] = {0};
    const hysteresis_memory memory = {play, creep};
    pzs_hysteresis_rest(tables, 0, memory, 0);
    return -pzs_hysteresis_effect(tables, 0, memory, 0);
}

/*
 * Least permitted ratio of two slopes (change of the strain per volt) of the hysteresis model that
 * a loop inverts: the slope just after a reversal of the voltage over the slope far from a
 * reversal. On a ceramic without hysteresis the inverse then enlarges small changes by at most
 * 1/0.6.
 */
static const double least_after_reversal = 0.6;

/*
 * Weaken the hysteresis model on one side of the middle of the voltage range: weight moves from
 * play operators, smallest slack first, to the slopes, until the smallest slope is
 * `least_after_reversal` times the sum of this slope and all weights.
 *   slope [PZS_HYSTERESIS_SEGMENTS / 2] in/out  slopes of the piecewise linear part (dimensionless)
 *   weight                              in/out  weights of the play operators (dimensionless)
 */
static void weaken_side(double *slope, scene_short_list *weight)
{
    const int segments = PZS_HYSTERESIS_SEGMENTS / 2;
    double least = slope[0], plays = 0;
    for (int i = 1; i < segments; i++)
        least = fmin(least, slope[i]);
    for (int k = 0; k < weight->count; k++)
        plays += weight->value[k];
    double missing = least_after_reversal * (least + plays) - least;
    for (int k = 0; k < weight->count && missing > 0; k++) {
        const double part = fmin(missing, weight->value[k]);
        weight->value[k] -= part;
        missing -= part;
        for (int i = 0; i < segments; i++)
            slope[i] += part;
    }
}

void compensation_weaken(scene_hysteresis *hysteresis)
{
    if (!hysteresis->given)
        return;
    weaken_side(hysteresis->slope.value, &hysteresis->below);
    weaken_side(hysteresis->slope.value + PZS_HYSTERESIS_SEGMENTS / 2, &hysteresis->above);
}

void compensation_fill(compensation *compensation, const scene_hysteresis *hysteresis,
                       const pzs_problem *problem, double rate)
{
    memset(compensation, 0, sizeof *compensation);
    compensation->is_used = hysteresis->given;
    if (!hysteresis->given)
        return;
    point(compensation);
    compensation->middle = (hysteresis->range[0] + hysteresis->range[1]) / 2;
    compensation->half_range = (hysteresis->range[1] - hysteresis->range[0]) / 2;
    copy(compensation->slope, &hysteresis->slope);
    copy(compensation->slack, &hysteresis->slack);
    copy(compensation->above, &hysteresis->above);
    copy(compensation->below, &hysteresis->below);
    copy(compensation->creep, &hysteresis->creep);
    for (int j = 0; j < hysteresis->creep.count; j++) {
        const double ticks = (rate > 0 ? rate : usual_rate) * hysteresis->creep_time.value[j];
        compensation->creep_rate[j] = -expm1(-1 / ticks);
    }
    pzs_hysteresis *tables = &compensation->tables;
    tables->scene = problem->scene;
    tables->inputs = problem->inputs;
    tables->sets = 1;
    tables->plays = (uint16_t)hysteresis->slack.count;
    tables->creeps = (uint16_t)hysteresis->creep.count;
    compensation->offset = offset_of(tables) + hysteresis->offset;
    (void)pzs_hysteresis_seal(tables);
}

void compensation_identify(compensation *compensation, const scene_hysteresis *identified)
{
    if (!compensation->is_used)
        return;
    copy(compensation->identified_slope, &identified->slope);
    copy(compensation->identified_above, &identified->above);
    copy(compensation->identified_below, &identified->below);
    pzs_hysteresis *tables = &compensation->tables, alone = *tables;
    const double none = 0;
    alone.offset = &none;
    alone.slope = compensation->identified_slope;
    alone.above = compensation->identified_above;
    alone.below = compensation->identified_below;
    compensation->identified_offset = offset_of(&alone) + identified->offset;
    tables->identified_offset = &compensation->identified_offset;
    tables->identified_slope = compensation->identified_slope;
    tables->identified_above = compensation->identified_above;
    tables->identified_below = compensation->identified_below;
    (void)pzs_hysteresis_seal(tables);
}
