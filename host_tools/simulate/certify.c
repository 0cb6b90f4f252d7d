/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Stability tests of a control loop with a vibration model: choice of settings, growth of small
 * vibrations, simulations with fast jumps of the target, margins (certify.h).
 */
#include "certify.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "../system/parallel.h"
#include "../system/progress.h"
#include "../text/append.h"
#include "load_step.h"
#include "storm_batch.h"

enum {
    PLANTS = 5, /* number of structures on which storms (simulations with fast jumps of the target)
                   are run: the model and four that differ from it */
    ENOUGH = 3, /* largest number of failures (simulations with fast target jumps that do not
                   settle) after which no further simulation is run */
    SEEDS = 3,  /* number of random sequences of targets for the simulations with fast target jumps
                 */
    STORMS = PLANTS * 2 * SEEDS,
    CORNERS = 9,  /* number of simulated structures for which the growth of small vibrations is
                     measured: all combinations of three static responses and three scales of the
                     frequencies */
    PERIODS = 24, /* periods of the first vibration mode during which the growth of vibrations is
                     measured */
    TICKS_LEAST = 600, /* fewest (TICKS_LEAST) and most (TICKS_MOST) ticks of a simulation that
                          measures the growth of small vibrations */
    TICKS_MOST = 3000,
    HALVINGS = 5,   /* number of bisections with which a stability margin is determined */
    OLDER_MOST = 4, /* largest change of the sensor readings' delay that the stability tests try
                       (ticks) */
    OCTAVES = 5     /* octaves of tick rates that are tried on either side of the scene's rate */
};

static const double two_pi = 6.283185307179586;

/*
 * Static responses to voltages (gains) and natural frequencies, relative to the controller's model,
 * of the structures on which fast jumps of the target are simulated.
 */
static const double storm_gain[PLANTS] = {1, 0.8, 0.8, 1.33, 1.33},
                    storm_frequency[PLANTS] = {1, 0.9, 1.1, 0.9, 1.1};

/*
 * Fraction of the ticks that are missed in the last third of the storms, to test the control loop
 * with missed ticks. A storm is a simulation with fast jumps of the target.
 */
static const double missed_share = 0.05;

/*
 * Static responses to voltages (gains) and natural frequencies, relative to the controller's model,
 * of the simulated structures on which the growth of small vibrations is measured; every
 * combination of both is used.
 */
static const double gains[3] = {0.8, 1, 1.33}, frequencies[3] = {0.9, 1, 1.1};

/*
 * Limits of the search for stability margins: largest static response to voltages, lowest frequency
 * and highest frequency of the structure, relative to the model.
 */
static const double gain_most = 10, slow_least = 0.1, fast_most = 5;

/*
 * Settings of the vibration damper (stage of the control tick that damps vibration) from which the
 * stability tests choose one row.
 *   damping  strength of the damping
 *   mix      weight of the change of velocity in the computed deviation from equilibrium
 *   follow   speed at which the voltages approach the statically optimal voltages
 *   drift    random change of the loads that the observer assumes
 *   kick     random change of the velocity that the observer assumes
 *   later    assumed additional age of the sensor readings (ticks)
 * Units and definitions are those of damper_settings.
 *
 * The first three settle a load step fast. The larger `drift` is, the faster the observer estimates
 * a load, and the more the noise of the sensors moves the voltages: smaller ones come first. The
 * other settings tolerate larger deviations of the readings' delay.
 */
static const struct {
    double damping, mix, follow, drift, kick;
    int later;
} choices[] = {{0.75, 0.75, 0.317, 0.21, 0.25, 0}, {0.7, 0.65, 0.31, 0.38, 0.12, 0},
               {0.65, 0.5, 0.317, 0.5, 0.12, 0},   {0.75, 0, 0.317, 0.21, 0.25, 0},
               {0.5, 0, 0.317, 0.21, 0.25, 0},     {0.5, 0, 0.317, 0.1, 0.25, 0},
               {0.35, 0, 0.317, 0.05, 0.25, 0},    {0.75, 0.75, 0.317, 0.21, 0.25, 1},
               {0.5, 0.75, 0.317, 0.21, 0.25, 1}};
enum { CHOICES = sizeof choices / sizeof *choices };

/*
 * Largest acceptable ratio of the settling time after fast target jumps to that of the first
 * settings that passed all tests. Up to this ratio, settings that tolerate a larger deviation of
 * the readings' delay are preferred to these.
 */
static const double slowest = 1.25;

/*
 * Regularisations of the voltages, relative to the mean diagonal entry of the Hessian, that are
 * tried for a loop that is not stable. Some combinations of voltages hardly move the target, but
 * they move vibration modes. Without regularisation the controller uses large voltages of this kind
 * to reduce small errors of the shape, which excites the modes. Regularisation keeps these voltages
 * small.
 */
static const double cures[] = {1e-4, 1e-2};

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
    loop_blocks blocks;
    storm_rig rig;       /* storms (simulations with fast jumps of the target) on the structure that
                            vibrates about its undeformed state */
    storm_rig at_target; /* storms (simulations with fast jumps of the target) on the structure that
                            vibrates about the equilibrium at its target shape */
    deformed deformed;
    bool has_target; /* true where the structure was linearised about the equilibrium at its target,
                        so that `at_target` and `deformed` may be used */
    char no_target[SCENE_ERROR]; /* why the loop cannot be simulated on the structure about the
                                    equilibrium at its target, where the scene's kinematics is not
                                    linear */
} trial;

/* ---- tables of the control loop --------------------------------------- */

/*
 * Replace the tables of the control loop by those for another tick rate and other settings of the
 * vibration damper (stage of the tick that damps vibration). Returns 0, or -1 with error filled.
 */
static int retable(trial *trial, const damper_options *options, char *error)
{
    damper_close(&trial->damper);
    if (damper_make(&trial->damper, trial->analysis, trial->few, options, error) < 0)
        return -1;
    loop_blocks_fill(&trial->blocks, &trial->analysis->design, &trial->estimator, &trial->damper);
    storm_rig *const rig[] = {&trial->rig, &trial->at_target};
    for (int i = 0; i < 1 + trial->has_target; i++) {
        storm_use(rig[i], trial->blocks.block, trial->blocks.count,
                  options->delay - options->settings.later);
        rig[i]->interval = 1 / options->rate;
    }
    return 0;
}

static int open_trial(trial *trial, analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    memset(trial, 0, sizeof *trial);
    trial->analysis = analysis;
    const bool needs_estimator = loop_estimates(design) || loop_feeds(design);
    if (needs_estimator && estimator_open(&trial->estimator, analysis, error) < 0)
        return -1;
    trial->few = loop_estimates(design) ? &trial->estimator : NULL;
    return storm_open(&trial->rig, analysis, trial->few, error);
}

/*
 * Prepare storms (simulations with fast jumps of the target) on the structure linearised about the
 * equilibrium at its target, where the scene's kinematics is not linear. Where there is no
 * equilibrium at the target, the reason is kept. Returns 0, or -1 with error filled.
 */
static int open_target(trial *trial, char *error)
{
    const design *design = &trial->analysis->design;
    if (design->kinematics == KINEMATICS_LINEAR)
        return 0;
    const int modes = (int)trial->rig.modal.modes;
    if (deformed_open(&trial->deformed, trial->analysis, modes, trial->no_target) < 0)
        return 0;
    if (storm_open(&trial->at_target, trial->analysis, trial->few, error) < 0)
        return -1;
    if (!storm_deform(&trial->at_target, &trial->deformed))
        return scene_fault(design->simulate.at, error, "out of memory");
    trial->has_target = true;
    return 0;
}

static void close_trial(trial *trial)
{
    storm_close(&trial->at_target);
    deformed_close(&trial->deformed);
    storm_close(&trial->rig);
    damper_close(&trial->damper);
    estimator_close(&trial->estimator);
}

/* ---- growth of small vibrations --------------------------------------- */

/* Number of ticks during which the growth of vibrations is measured. */
static int growth_ticks(const storm_rig *rig)
{
    const double period = two_pi / (rig->modal.frequency[0] * rig->interval);
    return (int)fmin(fmax(PERIODS * period, TICKS_LEAST), TICKS_MOST);
}

/*
 * Simulation that measures the growth of small vibrations of the control loop on one structure.
 */
static storm_task growth_task(const storm_rig *rig, double gain, double frequency, int more_delay)
{
    return (storm_task){.plant = {.gain = gain,
                                  .frequency = frequency,
                                  .step_limit = HUGE_VAL,
                                  .more_delay = more_delay,
                                  .seed = 1},
                        .growth_ticks = growth_ticks(rig)};
}

/*
 * Whether a simulation of a batch has passed. One that measures the growth of small vibrations has
 * passed if their amplitude grows by less than an eighth in its second half. The measurement cannot
 * distinguish smaller growth from none.
 */
static bool has_passed(const storm_task *task, const storm_result *result)
{
    return task->growth_ticks > 0 ? log(result->growth) < 0.25 / task->growth_ticks
                                  : result->passed;
}

/* Results of the simulations that measure the growth of small vibrations on several structures. */
typedef struct growth {
    certificate_loop *loop;
    bool is_stable; /* true while small vibrations have decayed on every structure so far */
} growth;

static bool visit_growth(void *context, const storm_task *task, const storm_result *result)
{
    growth *growth = context;
    certificate_loop *loop = growth->loop;
    growth->is_stable = growth->is_stable && has_passed(task, result);
    if (!(result->growth <= loop->radius)) {
        loop->radius = result->growth;
        loop->at_gain = task->plant.gain;
        loop->at_frequency = task->plant.frequency;
    }
    return true;
}

/*
 * Measure the growth of small vibrations of the control loop on structures with all combinations of
 * static responses in `gains` and natural frequencies in `frequencies`, both relative to the
 * controller's model. Returns 0, or -1 with error filled.
 */
static int measure_growth(const storm_rig *rig, certificate_loop *loop, bool *is_stable,
                          char *error)
{
    growth growth = {.loop = loop, .is_stable = true};
    storm_task task[CORNERS];
    loop->radius = 0;
    for (int i = 0; i < CORNERS; i++)
        task[i] = growth_task(rig, gains[i / 3], frequencies[i % 3], 0);
    const int failed = storm_batch_run(rig, task, CORNERS, visit_growth, &growth, error);
    *is_stable = growth.is_stable;
    return failed;
}

/* ---- simulations with fast target jumps ------------------------------- */

/*
 * Fraction (0 to 1) of the hysteresis in the scene file that the simulated ceramic lacks. It is
 * used in those storms (simulations with fast target jumps) that run the second random sequence of
 * targets. The controller compensates the full hysteresis, twice that of the ceramic, so that small
 * voltage changes act more strongly than it assumes.
 */
static const double less_hysteresis = 0.5;

/*
 * Return the structure, the step limits and the targets of the i-th storm (simulation with fast
 * jumps of the target), with readings that are `older` ticks older than the scene file states. In
 * storms with the last sequence of targets some ticks are missed, and the loop is not informed of
 * them.
 */
static storm_plant plant_of(int i, int older)
{
    const int sequence = i / PLANTS / 2;
    return (storm_plant){.gain = storm_gain[i % PLANTS],
                         .frequency = storm_frequency[i % PLANTS],
                         .step_limit = i / PLANTS % 2 ? 0.25 : 1,
                         .more_delay = older,
                         .seed = (uint64_t)(sequence + 1),
                         .less_hysteresis = sequence == 1 ? less_hysteresis : 0,
                         .missed_share = sequence == SEEDS - 1 ? missed_share : 0,
                         .is_uninformed = true};
}

/*
 * Sum of the results of `count` storms (simulations with fast jumps of the target) while they come
 * in one after the other: numbers of storms and failures, mean settling time, worst storm.
 */
typedef struct storms {
    certificate_loop *loop;
    int count;
    int enough; /* number of failures after which no further storm is run */
} storms;

static bool visit_storm(void *context, const storm_task *task, const storm_result *result)
{
    const storms *storms = context;
    certificate_loop *loop = storms->loop;
    loop->storms++;
    loop->failed += !result->passed;
    loop->ticks += (double)result->ticks / storms->count;
    if (result->end > loop->worst) {
        loop->worst = result->end;
        loop->worst_gain = task->plant.gain;
        loop->worst_frequency = task->plant.frequency;
        loop->worst_step = task->plant.step_limit;
    }
    return loop->failed < storms->enough;
}

/*
 * Run the first `count` storms (simulations with fast jumps of the target, which differ in
 * structure, limits and targets).
 *   enough  in  number of storms that fail to settle after which the others are left out
 * Returns 0, or -1 with error filled.
 */
static int run_storms(const storm_rig *rig, int count, int enough, certificate_loop *loop,
                      char *error)
{
    storms storms = {.loop = loop, .count = count, .enough = enough};
    storm_task task[STORMS];
    for (int i = 0; i < count; i++)
        task[i] = (storm_task){.plant = plant_of(i, 0)};
    return storm_batch_run(rig, task, count, visit_storm, &storms, error);
}

/*
 * Test the stability of the loop on the structure linearised about the equilibrium at its target
 * shape. The growth of small vibrations is measured on structures with other static responses and
 * frequencies than this one. If the vibrations decay on all of them, a third of the storms
 * (simulations with fast jumps of the target) are run: those with the first of three random
 * sequences of targets. If the structure has no such equilibrium, only the reason is stored.
 *   enough  in  number of storms that fail to settle after which the others are left out
 * Returns 0, or -1 with error filled.
 */
static int certify_target(const trial *trial, int enough, certificate_target *target, char *error)
{
    certificate_loop loop;
    bool is_stable = false;
    memset(&loop, 0, sizeof loop);
    memcpy(target->reason, trial->no_target, sizeof target->reason);
    if (!trial->has_target)
        return 0;
    const storm_rig *rig = &trial->at_target;
    if (measure_growth(rig, &loop, &is_stable, error) < 0 ||
        (is_stable && run_storms(rig, STORMS / SEEDS, enough, &loop, error) < 0))
        return -1;
    target->is_made = true;
    target->amplitude = trial->deformed.amplitude;
    target->first = rig->modal.frequency[0] / trial->rig.modal.frequency[0];
    target->is_stable = is_stable && loop.failed == 0;
    target->radius = loop.radius;
    target->storms = loop.storms;
    target->failed = loop.failed;
    target->worst = loop.worst;
    target->at_gain = loop.failed > 0 ? loop.worst_gain : loop.at_gain;
    target->at_frequency = loop.failed > 0 ? loop.worst_frequency : loop.at_frequency;
    return 0;
}

/*
 * Store in `context` whether a simulation of the loop has passed. Returns whether the next
 * simulation is to be run: the first that fails decides.
 */
static bool visit_pass(void *context, const storm_task *task, const storm_result *result)
{
    bool *passed = context;
    *passed = has_passed(task, result);
    return *passed;
}

/*
 * Test the control loop with sensor readings that are `older` ticks older than the scene file
 * states. The structures are the model, and others with higher or lower static responses and
 * frequencies.
 *   storms  in   number of storms (simulations with fast jumps of the target) to run
 *   settles out  whether small vibrations decay and the shape settles after the jumps
 * Returns 0, or -1 with error filled.
 */
static int try_age(const storm_rig *rig, int storms, int older, bool *settles, char *error)
{
    storm_task task[STORMS + PLANTS];
    for (int i = 0; i < storms; i++)
        task[i] = (storm_task){.plant = plant_of(storms - 1 - i, older)};
    for (int i = 0; i < PLANTS; i++)
        task[storms + i] = growth_task(rig, storm_gain[i], storm_frequency[i], older);
    *settles = true;
    return storm_batch_run(rig, task, storms + PLANTS, visit_pass, settles, error);
}

/*
 * Count by how many ticks the sensor readings may be older (sign = 1) or newer (sign = -1) than the
 * scene file states. The count ends where small vibrations grow, or where the shape no longer
 * settles after fast jumps of the target.
 *   storms  in  number of storms (simulations with fast jumps of the target) for each age
 *   most    in  largest number of ticks to try
 *   stood   in/out  number of ticks with which the loop has passed these tests
 */
static int count_ages(const storm_rig *rig, int storms, int sign, int most, int *stood, char *error)
{
    bool settles = true;
    while (settles && *stood < most) {
        if (try_age(rig, storms, sign * (*stood + 1), &settles, error) < 0)
            return -1;
        *stood += settles;
    }
    return 0;
}

/*
 * Determine whether a loop that has passed its tests also passes them with sensor readings one tick
 * older, or one tick newer, than the scene file states. It is tested on the undeformed structure.
 * If the loop was also tested on the structure at its target shape (target->is_made), this test is
 * repeated there, too. Returns 0, or -1 with error filled.
 */
static int try_neighbouring_ages(const trial *trial, certificate_loop *loop, char *error)
{
    const int newest = loop->delay < 1 ? 0 : 1, few = STORMS / SEEDS;
    certificate_target *target = &loop->target;
    if (count_ages(&trial->rig, STORMS, 1, 1, &loop->older, error) < 0 ||
        count_ages(&trial->rig, STORMS, -1, newest, &loop->newer, error) < 0)
        return -1;
    if (!target->is_made)
        return 0;
    return count_ages(&trial->at_target, few, 1, 1, &target->older, error) < 0 ||
                   count_ages(&trial->at_target, few, -1, newest, &target->newer, error) < 0
               ? -1
               : 0;
}

/* ---- choice of the settings of the vibration damper ------------------- */

/*
 * Angle by which the phase of the first vibration mode that the loop observes advances in one tick
 * (rad): angular frequency times tick interval. 0 where the loop observes no mode.
 */
static double first_angle(const trial *trial)
{
    const damper *damper = &trial->damper;
    return damper->modes > 0 ? two_pi * damper->frequency[0] / damper->rate : 0;
}

/*
 * Set the options of the vibration damper to the settings in one row of the table `choices`.
 *   choice in  index of the row
 */
static void set_options(const trial *trial, int choice, damper_options *options)
{
    damper_settings settings = damper_default_settings();
    settings.damping = choices[choice].damping;
    settings.mix = choices[choice].mix;
    settings.follow = choices[choice].follow;
    settings.drift = choices[choice].drift;
    settings.kick = choices[choice].kick;
    settings.later = choices[choice].later;
    *options = damper_options_of(trial->analysis);
    options->settings = settings;
    options->delay = trial->analysis->design.simulate.delay + settings.later;
}

/*
 * Measure the time in which the loop with one choice of settings compensates a load step.
 *   periods out  time (periods of the first observed mode); NAN where no mode is observed, or where
 *                no load can be compensated
 * Returns 0, or -1 with error filled.
 */
static int measure_load_step(trial *trial, int choice, double *periods, char *error)
{
    damper_options options;
    set_options(trial, choice, &options);
    *periods = (double)NAN;
    if (retable(trial, &options, error) < 0)
        return -1;
    if (trial->damper.modes == 0)
        return 0;
    return load_step_periods(&trial->rig, trial->damper.frequency[0], periods, error);
}

/*
 * Number of storms (simulations with fast jumps of the target) that may fail to settle with the
 * next choice of settings until it is known to be no better than the best one so far.
 */
static int enough_failures(const certificate_loop *best)
{
    const int failed = best->is_stable ? 0 : best->failed + best->target.failed;
    if (!best->is_made || failed > ENOUGH)
        return ENOUGH;
    return failed > 0 ? failed : 1;
}

/*
 * Test the stability of the control loop with one choice of settings of the vibration damper by
 * simulations. They end where the loop is no better than the best one so far.
 *   older   in   1: the loop is known to tolerate readings that are one tick older; otherwise 0
 *   options out  options of the vibration damper with these settings
 * Returns 0, or -1 with error filled.
 */
static int try_choice(trial *trial, int choice, int older, damper_options *options,
                      certificate_loop *loop, char *error)
{
    const int enough = enough_failures(&trial->analysis->certificate.loop);
    bool is_stable;
    memset(loop, 0, sizeof *loop);
    set_options(trial, choice, options);
    if (retable(trial, options, error) < 0 ||
        measure_growth(&trial->rig, loop, &is_stable, error) < 0 ||
        (is_stable && run_storms(&trial->rig, STORMS, enough, loop, error) < 0))
        return -1;
    loop->is_made = true;
    loop->is_stable = is_stable && loop->failed == 0;
    if (loop->is_stable && certify_target(trial, enough, &loop->target, error) < 0)
        return -1;
    loop->is_stable = loop->is_stable && (!loop->target.is_made || loop->target.is_stable);
    loop->modes = (int)trial->rig.modal.modes;
    loop->observed = trial->damper.modes;
    loop->has_slow_mode = trial->damper.has_slow_mode;
    if (loop->observed > 0) {
        loop->observed_from = trial->damper.frequency[0];
        loop->observed_to = trial->damper.frequency[loop->observed - 1];
    }
    loop->delay = trial->analysis->design.simulate.delay;
    loop->bandwidth = trial->analysis->design.simulate.imperfections.bandwidth;
    loop->older = older;
    loop->angle = first_angle(trial);
    loop->less_hysteresis = trial->blocks.compensation.is_used ? less_hysteresis : 0;
    return loop->is_stable ? try_neighbouring_ages(trial, loop, error) : 0;
}

/*
 * Return a score for how well a loop tolerates a change of the readings' delay by one tick: 2 if it
 * is stable with a longer delay on every simulated structure, plus 1 if it is stable with a shorter
 * one. Longer delays count more, because filters and queues outside the model lengthen the delay.
 */
static int tolerance_of(const certificate_loop *loop)
{
    return 2 * (certificate_older(loop) > 0) + (certificate_newer(loop) > 0);
}

/*
 * Whether a loop stays stable with readings that are one tick older and one tick newer than the
 * scene file states, so that no further settings need to be tried. If the scene file states
 * readings without delay, newer readings are not required, because there are none.
 */
static bool tolerates_all(const certificate_loop *loop)
{
    return loop->is_stable && tolerance_of(loop) == 2 + (loop->delay > 0);
}

/*
 * Whether a loop with other settings is better than the best loop so far. A loop that passes all
 * tests is better than one that does not. Among loops that fail, that with fewer failed storms
 * (simulations with fast jumps of the target) is better. Among loops that pass, that which
 * tolerates the larger deviation of the readings' delay is better, unless it settles much later.
 *   fastest in  mean number of ticks until the shape settles, with the first settings that pass
 */
static bool is_better(const certificate_loop *loop, const certificate_loop *best, double fastest)
{
    if (!best->is_made || loop->is_stable != best->is_stable)
        return !best->is_made || loop->is_stable;
    if (!loop->is_stable)
        return loop->failed + loop->target.failed < best->failed + best->target.failed;
    return tolerance_of(loop) > tolerance_of(best) && loop->ticks <= slowest * fastest;
}

/*
 * Determine whether the loop with one choice of settings of the vibration damper tolerates readings
 * that are one tick older than the scene file states. Returns 0, or -1 with error filled.
 */
static int try_older(trial *trial, int choice, bool *tolerates, char *error)
{
    damper_options options;
    set_options(trial, choice, &options);
    if (retable(trial, &options, error) < 0)
        return -1;
    return try_age(&trial->rig, STORMS, 1, tolerates, error);
}

/*
 * Test one choice of settings of the vibration damper, and keep it where it is better than the best
 * one so far. Once settings have passed all tests, others can only be better by tolerating readings
 * that are one tick older, which is then tested first.
 *   load_step in      time in which the loop compensates a load step with these settings (periods)
 *   fastest   in/out  mean number of ticks of a storm with the first settings that pass
 * Returns 0, or -1 with error filled.
 */
static int compare_choice(trial *trial, int choice, double load_step, double *fastest, char *error)
{
    certificate *certificate = &trial->analysis->certificate;
    certificate_loop loop;
    damper_options options;
    bool tolerates = true;
    const bool has_stable = certificate->loop.is_stable;
    if (has_stable && try_older(trial, choice, &tolerates, error) < 0)
        return -1;
    if (!tolerates)
        return 0;
    if (try_choice(trial, choice, has_stable, &options, &loop, error) < 0)
        return -1;
    loop.load_step = load_step;
    if (!is_better(&loop, &certificate->loop, *fastest))
        return 0;
    if (!certificate->loop.is_stable)
        *fastest = loop.ticks;
    certificate->loop = loop;
    certificate->settings = options.settings;
    certificate->has_settings = true;
    return 0;
}

/*
 * Results so far of one row of the table `choices` (settings of the vibration damper), while the
 * best settings are searched.
 */
typedef struct candidate {
    bool is_measured, is_tried;
    double load_step; /* time until the loop with these settings has compensated a load that appears
                         at once (periods of the first vibration mode that the loop observes) */
} candidate;

/*
 * Test the settings of the vibration damper in one row of the table `choices`, and keep them if
 * they are better than the best ones so far. They are not tested twice, nor if they assume readings
 * older than PZS_DELAY_LIMIT ticks.
 *   only_fast in      true: leave out settings that compensate a load step more slowly than in
 *       CERTIFICATE_LOAD_STEP periods
 *   candidate in/out  results so far of this row
 *   fastest   in/out  mean number of ticks in which storms (simulations with fast jumps of the
 *       target) settle with the first settings that passed all tests
 * Returns 0, or -1 with error filled.
 */
static int consider(trial *trial, int choice, bool only_fast, candidate *candidate, double *fastest,
                    char *error)
{
    const int delay = trial->analysis->design.simulate.delay + choices[choice].later;
    if (candidate->is_tried || delay > PZS_DELAY_LIMIT)
        return 0;
    if (!candidate->is_measured &&
        measure_load_step(trial, choice, &candidate->load_step, error) < 0)
        return -1;
    candidate->is_measured = true;
    if (only_fast && !(candidate->load_step <= CERTIFICATE_LOAD_STEP))
        return 0;
    candidate->is_tried = true;
    return compare_choice(trial, choice, candidate->load_step, fastest, error);
}

/*
 * Choose the settings of the vibration damper: settings that compensate a load step fast enough and
 * pass all tests, or, if there are none, other settings that pass. Fast compensation is not
 * required in two cases: if the phase of the first observed mode advances by CERTIFICATE_ANGLE or
 * more in a tick, or if the scene file requires a margin of the readings' delay (delay_margin). In
 * the latter case the loop must pass with readings one tick older. Returns 0, or -1 with error
 * filled.
 */
static int choose(trial *trial, char *error)
{
    const certificate_loop *best = &trial->analysis->certificate.loop;
    const scene_control *control = &trial->analysis->design.control;
    candidate of[CHOICES] = {{false, false, 0}};
    double fastest = 0;
    damper_options first;
    set_options(trial, 0, &first);
    if (retable(trial, &first, error) < 0)
        return -1;
    const double angle = first_angle(trial);
    const bool asks = angle > 0 && angle < CERTIFICATE_ANGLE && control->delay_margin == 0;
    for (int i = 0; i < CHOICES && asks && !tolerates_all(best); i++)
        if (consider(trial, i, true, &of[i], &fastest, error) < 0)
            return -1;
    if (best->is_stable)
        return 0;
    for (int i = 0; i < CHOICES && !tolerates_all(best); i++)
        if (consider(trial, i, false, &of[i], &fastest, error) < 0)
            return -1;
    if (control->delay_margin > 0 && best->is_stable && certificate_older(best) == 0)
        return scene_fault(control->margin_at, error,
                           "delay_margin 1: no settings of the loop stay stable with readings one "
                           "tick older; write the largest age as simulate.sensors.delay");
    return 0;
}

/*
 * Mean diagonal entry of the Hessian of the voltage optimisation problem, to which a relative
 * regularisation of the scene refers.
 */
static double mean_diagonal(const design *design)
{
    const size_t amplifiers = (size_t)design->amplifiers;
    double trace = 0;
    for (size_t k = 0; k < amplifiers; k++)
        trace += design->hessian[k * amplifiers + k];
    return trace / (double)amplifiers;
}

/*
 * For a loop that is not stable, find a regularisation with which small vibrations decay and the
 * first ten storms (simulations with fast jumps of the target) settle. The vibration damper has its
 * default settings. Returns 0, or -1 with error filled.
 */
static int find_cure(trial *trial, certificate_loop *loop, char *error)
{
    const design *design = &trial->analysis->design;
    const damper_options options = {trial->analysis->certificate.rate, design->simulate.delay,
                                    damper_default_settings()};
    for (size_t i = 0; i < sizeof cures / sizeof *cures && !(loop->cure > 0); i++) {
        const double regularisation = cures[i] * mean_diagonal(design);
        certificate_loop other;
        bool is_stable;
        if (!(regularisation > design->problem.regularisation))
            continue;
        memset(&other, 0, sizeof other);
        if (retable(trial, &options, error) < 0)
            return -1;
        trial->blocks.problem.regularisation = regularisation;
        if (measure_growth(&trial->rig, &other, &is_stable, error) < 0 ||
            (is_stable && run_storms(&trial->rig, STORMS / SEEDS, 1, &other, error) < 0))
            return -1;
        if (is_stable && other.failed == 0)
            loop->cure = cures[i];
    }
    return 0;
}

/*
 * Determine whether a tick of the scene's control loop has a block (stage) that damps vibration.
 * Returns 0, or -1 with error filled.
 */
static int has_damper(const analysis *analysis, bool *has, char *error)
{
    estimator estimator;
    damper damper;
    const bool estimates = loop_estimates(&analysis->design);
    *has = false;
    if (analysis->quasi_static || !certificate_refuses(&analysis->certificate))
        return 0;
    memset(&estimator, 0, sizeof estimator);
    if (estimates && estimator_open(&estimator, analysis, error) < 0)
        return -1;
    const int failed = damper_open(&damper, analysis, estimates ? &estimator : NULL, error);
    *has = !failed && damper.is_used;
    damper_close(&damper);
    estimator_close(&estimator);
    return failed;
}

int certify_loop(analysis *analysis, char *error)
{
    trial trial;
    bool has;
    if (analysis->certificate.loop.is_made)
        return 0;
    if (has_damper(analysis, &has, error) < 0)
        return -1;
    if (!has)
        return 0;
    progress_stage("storms against the loop");
    int failed = open_trial(&trial, analysis, error);
    failed = failed || open_target(&trial, error) < 0 || choose(&trial, error) < 0;
    certificate_loop *loop = &analysis->certificate.loop;
    if (!failed && loop->is_made && !loop->is_stable && !loop->target.is_made)
        failed = find_cure(&trial, loop, error) < 0;
    close_trial(&trial);
    return failed ? -1 : 0;
}

/* ---- stability margins ------------------------------------------------ */

/*
 * Search for a stability margin of the loop: how far a factor of the structure's static response to
 * voltages (gain), or of its natural frequencies, may differ from 1 in one direction before small
 * vibrations grow.
 */
typedef struct margin {
    const storm_rig *rig;
    bool is_gain; /* true: the gain varies; false: the frequencies */
    double end; /* factor of the gain or of the frequencies at which the search ends; it begins at 1
                 */
    double *factor; /* result: factor of the gain or of the frequencies farthest from 1 with which
                       small vibrations still decay */
    bool has_failed;
    char error[SCENE_ERROR];
} margin;

/*
 * Determine whether small vibrations decay if the structure's gain (static response to voltages) or
 * its frequencies are multiplied by a factor. Returns 0, or -1 with the error filled.
 */
static int try_factor(margin *margin, double factor, bool *passed)
{
    const storm_task task =
        growth_task(margin->rig, margin->is_gain ? factor : 1, margin->is_gain ? 1 : factor, 0);
    storm_result result;
    if (storm_growth(margin->rig, &task.plant, task.growth_ticks, &result, margin->error) < 0)
        return -1;
    *passed = has_passed(&task, &result);
    return 0;
}

/*
 * Find by bisection how far the factor of the structure's gain or frequencies may differ from 1
 * before small vibrations grow. Returns 0, or -1 with the error filled.
 */
static int bisect(margin *margin)
{
    double stable = 1, unstable = margin->end;
    bool passed;
    if (try_factor(margin, margin->end, &passed) < 0)
        return -1;
    *margin->factor = margin->end;
    if (passed)
        return 0;
    for (int i = 0; i < HALVINGS; i++) {
        const double factor = sqrt(stable * unstable);
        if (try_factor(margin, factor, &passed) < 0)
            return -1;
        if (passed)
            stable = factor;
        else
            unstable = factor;
    }
    *margin->factor = stable;
    return 0;
}

static void run_search(void *context, int i)
{
    margin *const margin = (struct margin *)context + i;
    margin->has_failed = bisect(margin) < 0;
}

static bool accept_search(void *context, int i)
{
    const margin *const margin = (struct margin *)context + i;
    return !margin->has_failed;
}

/*
 * Find three stability margins of the loop, in parallel threads: the largest static response to
 * voltages (gain), the lowest and the highest natural frequencies of the structure, all relative to
 * the controller's model, with which small vibrations decay. Returns 0, or -1 with error filled.
 */
static int find_factors(const storm_rig *rig, certificate_loop *loop, char *error)
{
    margin all[] = {{.rig = rig, .is_gain = true, .end = gain_most, .factor = &loop->margin_gain},
                    {.rig = rig, .end = slow_least, .factor = &loop->margin_slow},
                    {.rig = rig, .end = fast_most, .factor = &loop->margin_fast}};
    const int count = sizeof all / sizeof *all;
    const parallel_work work = {.context = all, .run = run_search, .accept = accept_search};
    parallel_run(&work, count);
    for (int i = 0; i < count; i++)
        if (all[i].has_failed) {
            memcpy(error, all[i].error, sizeof all[i].error);
            return -1;
        }
    return 0;
}

/*
 * Find by how many ticks the sensor readings may be older, and by how many newer, than the scene
 * file states while the control loop passes its tests. Returns 0, or -1 with error filled.
 */
static int find_ages(const trial *trial, certificate_loop *loop, char *error)
{
    const int newest = loop->delay < OLDER_MOST ? loop->delay : OLDER_MOST;
    const storm_rig *rig = &trial->rig;
    if ((loop->older > 0 && count_ages(rig, STORMS, 1, OLDER_MOST, &loop->older, error) < 0) ||
        (loop->newer > 0 && count_ages(rig, STORMS, -1, newest, &loop->newer, error) < 0))
        return -1;
    loop->ends_at_most = loop->older == OLDER_MOST;
    return 0;
}

/*
 * Determine whether the control loop is stable at a tick rate, with tables made for this rate.
 * Small vibrations must decay on the model, and on structures with 1.33 of its response to voltages
 * and 0.9 or 1.1 of its natural frequencies. On the latter, the shape must also settle after fast
 * jumps of the target. Returns 0, or -1 with error filled.
 */
static int try_rate(trial *trial, double rate, bool *is_stable, char *error)
{
    static const int structure[] = {0, 3, 4}; /* indices into storm_gain and storm_frequency: the
                                                 model, and two structures with the largest static
                                                 response, one with lower and one with higher
                                                 frequencies */
    const storm_rig *rig = &trial->rig;
    damper_options options = damper_options_of(trial->analysis);
    storm_task task[2 * PLANTS];
    int count = 0;
    options.rate = rate;
    *is_stable = false;
    if (retable(trial, &options, error) < 0)
        return -1;
    for (size_t i = 0; i < sizeof structure / sizeof *structure; i++) {
        const double gain = storm_gain[structure[i]], frequency = storm_frequency[structure[i]];
        task[count++] = growth_task(rig, gain, frequency, 0);
        if (i > 0)
            task[count++] = (storm_task){
                .plant = {.gain = gain, .frequency = frequency, .step_limit = 0.25, .seed = 1}};
    }
    return storm_batch_run(rig, task, count, visit_pass, is_stable, error);
}

/*
 * Find how far the tick rate can be raised (factor 2) or lowered (factor 1/2) until the control
 * loop is no longer stable. Starting from a stable rate, the rate is multiplied by `factor` as long
 * as the loop stays stable. Then the geometric mean of the last
 * stable and the first unstable rate is tried.
 *   from in   stable tick rate (1/s)
 *   rate out  last rate at which the loop is stable (1/s)
 * Returns 0, or -1 with error filled.
 */
static int find_rate(trial *trial, double from, double factor, double *rate, char *error)
{
    bool is_stable = true;
    *rate = from;
    for (int i = 0; i < OCTAVES && is_stable; i++) {
        if (try_rate(trial, *rate * factor, &is_stable, error) < 0)
            return -1;
        if (is_stable)
            *rate *= factor;
    }
    if (is_stable)
        return 0;
    if (try_rate(trial, *rate * sqrt(factor), &is_stable, error) < 0)
        return -1;
    *rate *= is_stable ? sqrt(factor) : 1;
    return 0;
}

static int find_margins(trial *trial, char *error)
{
    certificate_loop *loop = &trial->analysis->certificate.loop;
    const damper_options options = damper_options_of(trial->analysis);
    if (retable(trial, &options, error) < 0 || find_factors(&trial->rig, loop, error) < 0 ||
        find_ages(trial, loop, error) < 0)
        return -1;
    loop->has_margins = true;
    return 0;
}

/*
 * Find the stable tick rate of the control loop that is nearest, in octaves, to the rate of the
 * scene file; lower rates are tried first.
 *   rate out  tick rate (1/s), 0 if none of the tried rates is stable
 * Returns 0, or -1 with error filled.
 */
static int find_stable_rate(trial *trial, double *rate, char *error)
{
    const double given = trial->analysis->certificate.rate;
    for (int i = 1; i <= OCTAVES; i++)
        for (int side = -1; side <= 1; side += 2) {
            bool is_stable;
            *rate = given * pow(2, side * i);
            if (try_rate(trial, *rate, &is_stable, error) < 0)
                return -1;
            if (is_stable)
                return 0;
        }
    *rate = 0;
    return 0;
}

/*
 * Find the range of tick rates at which the control loop is stable, around the rate of the scene
 * file or around the nearest stable one. Returns 0, or -1 with error filled.
 */
static int find_rates(trial *trial, char *error)
{
    certificate_loop *loop = &trial->analysis->certificate.loop;
    double rate = trial->analysis->certificate.rate;
    progress_stage("stable tick rates");
    if (!loop->is_stable && find_stable_rate(trial, &rate, error) < 0)
        return -1;
    if (rate <= 0)
        return 0;
    return find_rate(trial, rate, 0.5, &loop->rate_from, error) < 0 ||
                   find_rate(trial, rate, 2, &loop->rate_to, error) < 0
               ? -1
               : 0;
}

int certify_margins(analysis *analysis, bool with_rates, char *error)
{
    trial trial;
    if (!analysis->certificate.loop.is_made)
        return 0;
    progress_stage("margins of the loop");
    int failed = open_trial(&trial, analysis, error);
    failed = failed || (analysis->certificate.loop.is_stable && find_margins(&trial, error) < 0) ||
             (with_rates && find_rates(&trial, error) < 0);
    close_trial(&trial);
    return failed ? -1 : 0;
}

void certify_failure(const certificate *certificate, char text[SCENE_ERROR])
{
    const certificate_loop *loop = &certificate->loop;
    const certificate_target *target = &loop->target;
    text[0] = '\0';
    if (loop->bandwidth > 0)
        snprintf(text, SCENE_ERROR, "with amplifiers of %g Hz, which may be too slow, ",
                 loop->bandwidth);
    char *rest = text + strlen(text);
    const size_t room = SCENE_ERROR - strlen(text);
    if (target->is_made && !target->is_stable)
        snprintf(rest, room,
                 "about the shape of its target, %.3g thicknesses, at gain %g, frequency %g of the "
                 "deformed structure, vibration changes %.5g times a tick and %d of %d storms do "
                 "not settle%s",
                 target->amplitude, target->at_gain, target->at_frequency, target->radius,
                 target->failed, target->storms,
                 certificate_is_prestressed(certificate)
                     ? ""
                     : "; write simulate: {influence: target}, or make the target smaller");
    else if (loop->failed > 0)
        snprintf(
            rest, room,
            "after a storm of targets at gain %g, frequency %g, step limit x %g the shape ends "
            "%.3g of the target from the best one (allowed: %g); %d of %d storms do not settle",
            loop->worst_gain, loop->worst_frequency, loop->worst_step, loop->worst,
            CERTIFICATE_TOLERANCE, loop->failed, loop->storms);
    else
        snprintf(rest, room, "at gain %g, frequency %g vibration grows %.5g times a tick",
                 loop->at_gain, loop->at_frequency, loop->radius);
    if (certificate_is_prestressed(certificate))
        text_append(text, SCENE_ERROR,
                    "; the static loads make the first natural frequency %.3g times as high: write "
                    "kinematics: nonlinear and simulate: {influence: loaded}",
                    certificate->load_ratio);
}
