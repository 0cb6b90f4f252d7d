/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Storms: simulations of a control loop on a structure with mass while the target jumps (storm.h).
 */
#include "storm.h"
#include <math.h>
#include <string.h>
#include "../../lib/core/product.h"
#include "random.h"
#include "storm_state.h"

enum {
    TARGETS = 10, /* number of targets in a storm (a simulation with fast target jumps) before the
                     last target */
    REST_PERIODS = 12, /* length of the last part of a storm (a simulation with fast target jumps),
                          in which the target no longer jumps, in periods of the first vibration
                          mode */
    EVERY_LEAST = 10,  /* fewest and most ticks between two jumps of the target in a storm (stress
                          test of a control loop) */
    EVERY_MOST = 1200,
    REST_LEAST = 1200, /* fewest ticks at the end of a storm (simulation with fast jumps of the
                          target) during which the target stays the same: six time constants of the
                          controller's low-pass filter */
    REST_MOST = 20000,
    END_LEAST = 20, /* smallest and largest number of ticks, at the end of a storm (simulation with
                       fast jumps of the target), over which the results are averaged */
    END_MOST = 500
};

static const double two_pi = 6.283185307179586;

/*
 * Standard deviation of the sensors' noise, relative to the largest displacement in the best shape
 * that the voltage limits allow.
 */
static const double noise_share = 1e-4;

/*
 * Distance of the shape from the target, relative to the norm of the target, above which the loop
 * counts as diverged.
 */
static const double diverged = 1e6;

static int clamp_ticks(double ticks, int least, int most)
{
    return (int)fmin(fmax(ceil(ticks), least), most);
}

/*
 * Set the next target: the target of the scene, its negative, or the shape under random voltages.
 */
static void set_next_target(storm *storm)
{
    const storm_rig *rig = storm->rig;
    const size_t amplifiers = rig->amplifiers;
    const int kind = random_int(&storm->random, 4);
    if (kind < 2) {
        for (size_t i = 0; i < rig->targets; i++)
            storm->target[i] = kind == 0 ? storm->last_target[i] : -storm->last_target[i];
        return;
    }
    for (size_t k = 0; k < amplifiers; k++) {
        const double part = 2 * random_uniform(&storm->random) - 1, sign = part < 0 ? -1 : 1;
        const double middle = (rig->lower[k] + rig->upper[k]) / 2,
                     half = (rig->upper[k] - rig->lower[k]) / 2;
        storm->previous_voltage[k] = middle + 2 * half * (kind == 2 ? part : sign);
    }
    pzs_product_matrix(storm->target, rig->influence, storm->previous_voltage, rig->targets,
                       amplifiers);
    for (size_t i = 0; i < rig->targets; i++)
        storm->target[i] += storm_offset(storm, i);
}

/*
 * Set the noise of the sensors in proportion to the largest displacement of the best shape that the
 * limits allow.
 */
static void set_noise(storm *storm)
{
    double largest = 0;
    for (size_t i = 0; i < storm->rig->targets; i++)
        largest = fmax(largest, fabs(storm->best_shape[i]));
    storm->noise = noise_share * largest;
}

/* Times of a storm (simulation of a control loop with fast jumps of the target), in ticks. */
typedef struct schedule {
    int every; /* time between two jumps of the target in a storm, a stress test of a control loop
                  (ticks) */
    int jumps; /* number of the tick in which the target jumps for the last time, to the target of
                  the scene */
    int ticks; /* largest number of ticks of the storm (simulation with fast jumps of the target) */
    int rest;  /* number of the tick in which the last quarter of the time without jumps begins */
    int end;   /* number of ticks at the end of the storm (simulation with fast jumps of the target)
                  in which its result is measured */
} schedule;

/*
 * Largest factor by which hysteresis makes the time without jumps longer at the end of a storm
 * (simulation with fast jumps of the target).
 */
static const double longest_rest = 3;

/*
 * Return the factor by which hysteresis makes the time without jumps longer at the end of a storm
 * (simulation with fast jumps of the target). After a reversal the play operators do not move, so
 * that small changes of the voltages have only this part of their effect, by which a control loop
 * settles more slowly:
 *   1 - 16/5 of the width of the hysteresis loop relative to the voltage range (imperfections.h)
 */
static double rest_factor(double width)
{
    return fmin(1 / fmax(1 - width * 16 / 5, 1e-3), longest_rest);
}

static schedule schedule_of(const storm *storm)
{
    const storm_rig *rig = storm->rig;
    const double period = two_pi / (rig->modal.frequency[0] * rig->interval);
    const int every = clamp_ticks(0.6 * period, EVERY_LEAST, EVERY_MOST);
    const int still = clamp_ticks(REST_PERIODS * period, REST_LEAST, REST_MOST);
    const int rest = (int)(still * rest_factor(storm->width));
    return (schedule){.every = every,
                      .jumps = TARGETS * every,
                      .ticks = TARGETS * every + rest,
                      .rest = TARGETS * every + rest - rest / 4,
                      .end = clamp_ticks(period, END_LEAST, END_MOST)};
}

/* Set the target of tick k of a storm (simulation with fast jumps of the target). */
static void set_target(storm *storm, const schedule *schedule, int k)
{
    if (k == schedule->jumps)
        memcpy(storm->target, storm->last_target, storm->rig->targets * sizeof *storm->target);
    else if (k < schedule->jumps && k % schedule->every == 0)
        set_next_target(storm);
}

/* Whether few sensors show the loop only a part of the effect of hysteresis. */
static bool sees_part(const storm *storm)
{
    return storm->width > 0 && storm->rig->estimator != NULL;
}

/*
 * Compute the best shape anew before tick k if that is the tick of the last jump, or the first one
 * in which the result is measured. Where the voltage limits are not symmetric, the best shape
 * depends on the largest voltages so far, which a ceramic with hysteresis remembers.
 */
static pzs_status renew_best(storm *storm, const schedule *schedule, int k)
{
    const bool is_end = k == schedule->ticks - schedule->end && !sees_part(storm);
    const bool is_due = k == schedule->jumps || is_end;
    if (!is_due || !storm_renew_stroke(storm))
        return PZS_OK;
    storm->has_shape = storm->has_vibration = false; /* Their arrays serve as work arrays here. */
    return storm_find_best(storm, storm->previous_voltage);
}

/*
 * Replace the shape with which the shape is compared by the present one. A loop with few sensors
 * cannot correct what these do not show of the effect of hysteresis; it only has to come to rest.
 *   result in/out  result of the storm (simulation with fast jumps of the target)
 */
static void expect_rest(storm *storm, storm_result *result)
{
    const size_t targets = storm->rig->targets;
    storm_compute_shape(storm);
    result->unseen = storm_distance(storm, storm->shape, storm->best_shape) / storm->rig->scale;
    memcpy(storm->best_shape, storm->shape, targets * sizeof *storm->best_shape);
}

/*
 * Whether every voltage stands at a limit on a ceramic with hysteresis. This may keep the structure
 * bent, by more than a small target, where the voltages have one sign.
 */
static bool is_out_of_reach(const storm *storm)
{
    const design *design = &storm->rig->analysis->design;
    bool is_at_limits = storm->width > 0;
    for (size_t k = 0; k < storm->rig->amplifiers && is_at_limits; k++)
        is_at_limits =
            storm->voltage[k] <= design->lower[k] || storm->voltage[k] >= design->upper[k];
    return is_at_limits;
}

/*
 * Return the distance of the shape from the best one. Where all voltages stand at limits, the loop
 * can neither damp nor excite vibration, which then does not count.
 */
static double distance_of(storm *storm)
{
    storm_compute_shape(storm);
    if (is_out_of_reach(storm)) {
        for (size_t i = 0; i < storm->rig->targets; i++)
            storm->shape[i] -= storm->part[i];
        storm->has_shape = false; /* The next tick computes it again, with vibration. */
    }
    return storm_distance(storm, storm->shape, storm->best_shape) / storm->rig->scale;
}

/*
 * Compare the shape after tick k of a storm (simulation with fast jumps of the target) with the
 * best shape that the limits allow. If the shape has stayed near the best one for schedule->end
 * ticks, result->ticks is reduced to end the storm. If the loop has diverged, result->end becomes
 * infinite.
 *   quiet  in/out  number of ticks for which the shape has stayed near the best one
 *   result in/out  result of the storm
 */
static void judge_tick(storm *storm, const schedule *schedule, int k, int *quiet,
                       storm_result *result)
{
    if (k < schedule->jumps && k % 8 != 0)
        return;
    const double distance = distance_of(storm);
    result->peak = fmax(result->peak, distance);
    if (k + schedule->end >= result->ticks)
        result->end = fmax(result->end, distance);
    *quiet = distance < CERTIFICATE_TOLERANCE / 2 && k >= schedule->jumps ? *quiet + 1 : 0;
    if (*quiet > schedule->end) {
        result->end = distance;
        result->ticks = k + 1;
    }
    if (!(distance < diverged))
        result->end = HUGE_VAL;
}

/* Whether the sensor gate of the loop, if there is one, has taken a reading away in this tick. */
static bool has_gated(const storm *storm)
{
    const pzs_sensor_gate_state *gate = pzs_loop_find(&storm->loop, &pzs_sensor_gate_block);
    return gate != NULL && gate->info.count > 0;
}

static pzs_status run_storm(storm *storm, storm_result *result)
{
    const schedule schedule = schedule_of(storm);
    int quiet = 0;
    result->ticks = schedule.ticks;
    for (int k = 0; k < result->ticks && result->end < HUGE_VAL; k++) {
        set_target(storm, &schedule, k);
        pzs_status status = renew_best(storm, &schedule, k);
        if (!PZS_IS_ERROR(status))
            status = storm_tick(storm);
        if (PZS_IS_ERROR(status))
            return status;
        if (status == PZS_W_RAMP) {
            result->is_stopped = true;
            return PZS_OK;
        }
        result->gated += has_gated(storm);
        if (sees_part(storm) && k == schedule.rest)
            expect_rest(storm, result);
        judge_tick(storm, &schedule, k, &quiet, result);
    }
    result->passed = result->end <= CERTIFICATE_TOLERANCE;
    return PZS_OK;
}

int storm_run(const storm_rig *rig, const storm_plant *plant, storm_result *result, char *error)
{
    storm storm;
    memset(result, 0, sizeof *result);
    int failed = storm_begin(&storm, rig, plant, error);
    if (!failed) {
        set_noise(&storm);
        const pzs_status status = run_storm(&storm, result);
        if (PZS_IS_ERROR(status))
            failed = storm_explain(&storm, status, error);
    }
    storm_end(&storm);
    return failed;
}
