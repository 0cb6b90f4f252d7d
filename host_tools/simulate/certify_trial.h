/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A control loop on trial: its tables for one choice of settings, and the single tests of its
 * stability. The files of the certificate (certify.h) share this header.
 */
#ifndef CERTIFY_TRIAL_H
#define CERTIFY_TRIAL_H

#include "../model/analysis.h"
#include "storm_batch.h"
#include "wrong_sensor.h"

enum {
    PLANTS = 5, /* number of structures on which storms (simulations with fast jumps of the target)
                   are run: the model and four that differ from it */
    ENOUGH = 3, /* largest number of failures (simulations with fast target jumps that do not
                   settle) after which no further simulation is run */
    SEEDS = 3,  /* number of random sequences of targets for the simulations with fast target jumps
                 */
    STORMS = PLANTS * 2 * SEEDS,
    HYSTERESIS_STORMS = PLANTS * 2 /* number of storms (simulations with fast target jumps) on
                                      ceramic with hysteresis that the loop does not compensate */
};

/*
 * Fraction (0 to 1) of the scene's hysteresis that the simulated ceramic lacks in storms (fast
 * target jumps) with the second random sequence of targets. The controller then compensates twice
 * the true hysteresis, so that small voltage changes act more strongly than it assumes.
 */
#define TRIAL_LESS_HYSTERESIS 0.5

/*
 * Part by which the amplifiers are slower than the scene file states in storms (fast target jumps)
 * with the second random sequence of targets, and faster with the third.
 */
#define TRIAL_LESS_BANDWIDTH 0.3

/*
 * A control loop on trial: its generated tables for one choice of settings of the vibration damper
 * and one tick rate.
 */
typedef struct trial {
    analysis *analysis;
    estimator estimator;
    const estimator *few; /* estimator that computes the shape from few sensors; NULL: every target
                             node is measured */
    damper damper;
    sensor_gate gate;
    loop_blocks blocks;
    storm_rig rig;       /* storms (simulations with fast jumps of the target) on the structure that
                            vibrates about its undeformed state */
    storm_rig at_target; /* storms (simulations with fast jumps of the target) on the structure that
                            vibrates about the equilibrium at its target shape */
    deformed deformed;
    bool has_target; /* true where the structure was linearised about the equilibrium at its target,
                        so that `at_target` and `deformed` may be used */
    char no_target[SCENE_ERROR]; /* where the scene's kinematics is nonlinear: reason why the loop
                                    could not be simulated on the structure linearised about the
                                    equilibrium at its target */
} trial;

/* ---- tables of the control loop (certify_trial.c) ----------------------- */

/*
 * Replace the tables of the control loop by those for another tick rate and other settings of the
 * vibration damper (stage of the tick that damps vibration). Returns 0, or -1 with error filled.
 */
int trial_use(trial *trial, const damper_options *options, char *error);

/*
 * Prepare a control loop for its tests on the undeformed structure. Returns 0, or -1 with error
 * filled; call trial_close in either case.
 */
int trial_open(trial *trial, analysis *analysis, char *error);

/*
 * Prepare storms (simulations with fast jumps of the target) on the structure linearised about the
 * equilibrium at its target, where the scene's kinematics is not linear. Where there is no
 * equilibrium at the target, the reason is kept. Returns 0, or -1 with error filled.
 */
int trial_open_target(trial *trial, char *error);

void trial_close(trial *trial);

/* ---- single tests (certify_tests.c) ------------------------------------- */

/*
 * Simulation that measures the growth of small vibrations of the control loop on one structure.
 */
storm_task trial_growth_task(const storm_rig *rig, double gain, double frequency, int more_delay);

/*
 * Whether a simulation of a batch has passed. One that measures the growth of small vibrations has
 * passed if their amplitude grows by less than an eighth in its second half. The measurement cannot
 * distinguish smaller growth from none.
 */
bool trial_has_passed(const storm_task *task, const storm_result *result);

/*
 * Measure the growth of small vibrations of the control loop on structures with all combinations of
 * static responses of 0.8, 1 and 1.33 and natural frequencies of 0.9, 1 and 1.1, both relative to
 * the controller's model. Returns 0, or -1 with error filled.
 */
int trial_measure_growth(const storm_rig *rig, certificate_loop *loop, bool *is_stable,
                         char *error);

/*
 * Return structure, step limits and targets of the i-th storm (simulation with fast jumps of the
 * target), with readings `older` ticks older than the scene file states. The last sequence of
 * targets also misses some ticks without informing the loop.
 */
storm_plant trial_plant(int i, int older);

/*
 * Run the first `count` storms (simulations with fast jumps of the target, which differ in
 * structure, limits and targets).
 *   enough  in  number of storms that fail to settle after which the others are left out
 * Returns 0, or -1 with error filled.
 */
int trial_run_storms(const storm_rig *rig, int count, int enough, certificate_loop *loop,
                     char *error);

/*
 * Run storms (simulations with fast jumps of the target) on ceramic with the hysteresis of the
 * simulated plant, where the loop does not compensate it: each structure with each step limit, on
 * the three sequences of targets in turn. The results are added to those of the other storms.
 *   enough  in  number of storms that fail to settle after which the others are left out
 * Returns 0, or -1 with error filled.
 */
int trial_run_hysteresis(const storm_rig *rig, int enough, certificate_loop *loop, char *error);

/*
 * Test the stability of the loop on the structure linearised about the equilibrium at its target
 * shape. If there is no such equilibrium, store only the reason in `target`.
 *   enough  in  number of failed storms (simulations with fast jumps of the target) after which the
 *       others are left out
 * Returns 0, or -1 with error filled.
 */
int trial_certify_target(const trial *trial, int enough, certificate_target *target, char *error);

/*
 * Store in `context` whether a simulation of the loop has passed. Returns whether the next
 * simulation is to be run: no further one is run after the first that fails.
 */
bool trial_visit_pass(void *context, const storm_task *task, const storm_result *result);

/*
 * Test the control loop with sensor readings that are `older` ticks older than the scene file
 * states, on the model and on structures with other static responses and frequencies.
 *   storms  in   number of storms (simulations with fast jumps of the target) to run
 *   settles out  whether small vibrations decay and the shape settles after the jumps
 * Returns 0, or -1 with error filled.
 */
int trial_try_age(const storm_rig *rig, int storms, int older, bool *settles, char *error);

/*
 * Count by how many ticks the sensor readings may be older (sign = 1) or newer (sign = -1) than the
 * scene file states, with the loop still stable.
 *   storms  in      number of storms (simulations with fast jumps of the target) for each age
 *   most    in      largest number of ticks to try
 *   stood   in/out  number of ticks with which the loop has passed the tests of trial_try_age
 * Returns 0, or -1 with error filled.
 */
int trial_count_ages(const storm_rig *rig, int storms, int sign, int most, int *stood, char *error);

/*
 * Determine whether a loop that has passed its tests also passes with readings one tick older, or
 * one tick newer, than the scene file states: on the undeformed structure and, if tested there
 * before (target->is_made), at the target shape. Returns 0, or -1 with error filled.
 */
int trial_try_neighbouring_ages(const trial *trial, certificate_loop *loop, char *error);

/* ---- choice of the settings (certify_choice.c) -------------------------- */

/*
 * Choose the settings of the vibration damper from the table `choices`: preferably ones that pass
 * all tests and compensate a load step fast enough. If the scene file requires delay_margin, they
 * must also pass with readings one tick older. Then the low-pass filter of the residual readings is
 * made as fast as the same tests permit. Returns 0, or -1 with error filled.
 */
int trial_choose(trial *trial, char *error);

/* ---- storms with the supervisor (certify_alarm.c) ------------------------ */

/*
 * Choose the time in which the supervisor's tolerance after a jump of the target decays. It is the
 * default time or, for a loop that damps slowly, the decay time of its slowest vibration; it is
 * doubled until no storm (simulation with fast jumps of the target) ends in an alarm. Results: the
 * settings of the certificate, loop.fading and loop.alarms. A loop without supervisor or observed
 * modes is left unchanged. Returns 0, or -1 with error filled.
 */
int trial_choose_fading(trial *trial, char *error);

/* ---- changes that make a loop stable (certify_cure.c) ------------------- */

/*
 * For a loop that is not stable, find a change of the scene with which the loop is stable: without
 * the free functions of the target (shapes that may be added to it at no cost), with a larger
 * regularisation of the voltages, or with compensation of hysteresis. The results are
 * loop->is_free_cause, loop->cure, loop->cures_tried and loop->is_compensation_cure.
 */
void trial_find_cure(const analysis *analysis, certificate_loop *loop);

/* ---- tests of one loop, in their order (certify.c) ---------------------- */

/*
 * Choose the settings of the vibration damper and test the stability of the loop as certify_loop
 * does, but search for no change of the scene that makes an unstable loop stable.
 * Returns 0, or -1 with error filled.
 */
int trial_certify(analysis *analysis, char *error);

#endif
