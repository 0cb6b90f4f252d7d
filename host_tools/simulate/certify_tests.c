/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Single tests of the stability of a control loop: growth of small vibrations, storms (simulations
 * with fast jumps of the target), age of the readings (certify_trial.h).
 */
#include <math.h>
#include <string.h>
#include "certify_trial.h"

enum {
    CORNERS = 9,  /* number of simulated structures for which the growth of small vibrations is
                     measured: all combinations of three static responses and three scales of the
                     frequencies */
    PERIODS = 24, /* periods of the first vibration mode during which the growth of vibrations is
                     measured */
    TICKS_LEAST = 600, /* fewest (TICKS_LEAST) and most (TICKS_MOST) ticks of a simulation that
                          measures the growth of small vibrations */
    TICKS_MOST = 3000
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

/* ---- growth of small vibrations --------------------------------------- */

/* Number of ticks during which the growth of vibrations is measured. */
static int growth_ticks(const storm_rig *rig)
{
    const double period = two_pi / (rig->modal.frequency[0] * rig->interval);
    return (int)fmin(fmax(PERIODS * period, TICKS_LEAST), TICKS_MOST);
}

storm_task trial_growth_task(const storm_rig *rig, double gain, double frequency, int more_delay)
{
    return (storm_task){.plant = {.gain = gain,
                                  .frequency = frequency,
                                  .step_limit = HUGE_VAL,
                                  .more_delay = more_delay,
                                  .seed = 1},
                        .growth_ticks = growth_ticks(rig)};
}

bool trial_has_passed(const storm_task *task, const storm_result *result)
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
    growth->is_stable = growth->is_stable && trial_has_passed(task, result);
    if (!(result->growth <= loop->radius)) {
        loop->radius = result->growth;
        loop->at_gain = task->plant.gain;
        loop->at_frequency = task->plant.frequency;
    }
    return true;
}

int trial_measure_growth(const storm_rig *rig, certificate_loop *loop, bool *is_stable, char *error)
{
    growth growth = {.loop = loop, .is_stable = true};
    storm_task task[CORNERS];
    loop->radius = 0;
    for (int i = 0; i < CORNERS; i++)
        task[i] = trial_growth_task(rig, gains[i / 3], frequencies[i % 3], 0);
    const int failed = storm_batch_run(rig, task, CORNERS, visit_growth, &growth, error);
    *is_stable = growth.is_stable;
    return failed;
}

/* ---- simulations with fast target jumps ------------------------------- */

storm_plant trial_plant(int i, int older)
{
    const int sequence = i / PLANTS / 2;
    storm_plant plant = {.gain = storm_gain[i % PLANTS],
                         .frequency = storm_frequency[i % PLANTS],
                         .step_limit = i / PLANTS % 2 ? 0.25 : 1,
                         .more_delay = older,
                         .seed = (uint64_t)(sequence + 1),
                         .is_uninformed = true};
    if (sequence == 1) {
        plant.less_hysteresis = TRIAL_LESS_HYSTERESIS;
        plant.less_bandwidth = TRIAL_LESS_BANDWIDTH;
    }
    if (sequence == SEEDS - 1) {
        plant.missed_share = missed_share;
        plant.less_bandwidth = -TRIAL_LESS_BANDWIDTH;
    }
    return plant;
}

/*
 * Sum of the results of `count` storms (simulations with fast jumps of the target) while they come
 * in one after the other: numbers of storms and failures, mean settling time, worst storm.
 */
typedef struct storms {
    certificate_loop *loop;
    int count;
    int enough;        /* number of failed simulations after which no further one is run */
    double hysteresis; /* width of the hysteresis loop that the loop does not compensate, relative
                          to the voltage range */
} storms;

static bool visit_storm(void *context, const storm_task *task, const storm_result *result)
{
    const storms *storms = context;
    certificate_loop *loop = storms->loop;
    loop->storms++;
    loop->failed += !result->passed;
    loop->gate.storms += result->gated > 0;
    loop->unseen = fmax(loop->unseen, result->unseen);
    loop->ticks += (double)result->ticks / storms->count;
    if (result->end > loop->worst) {
        loop->worst = result->end;
        loop->worst_gain = task->plant.gain;
        loop->worst_frequency = task->plant.frequency;
        loop->worst_step = task->plant.step_limit;
        loop->worst_hysteresis = task->plant.has_hysteresis ? storms->hysteresis : 0;
    }
    return loop->failed < storms->enough;
}

int trial_run_storms(const storm_rig *rig, int count, int enough, certificate_loop *loop,
                     char *error)
{
    storms storms = {.loop = loop, .count = count, .enough = enough, .hysteresis = rig->play};
    storm_task task[STORMS];
    for (int i = 0; i < count; i++)
        task[i] = (storm_task){.plant = trial_plant(i, 0)};
    return storm_batch_run(rig, task, count, visit_storm, &storms, error);
}

int trial_run_hysteresis(const storm_rig *rig, int enough, certificate_loop *loop, char *error)
{
    certificate_loop own = {.worst = loop->worst};
    storms storms = {
        .loop = &own, .count = HYSTERESIS_STORMS, .enough = enough, .hysteresis = rig->play};
    storm_task task[HYSTERESIS_STORMS];
    if (!(rig->play > 0))
        return 0;
    for (int i = 0; i < HYSTERESIS_STORMS; i++) {
        task[i] = (storm_task){.plant = trial_plant(i % SEEDS * 2 * PLANTS + i, 0)};
        task[i].plant.has_hysteresis = true;
    }
    if (storm_batch_run(rig, task, HYSTERESIS_STORMS, visit_storm, &storms, error) < 0)
        return -1;
    loop->hysteresis = rig->play;
    loop->hysteresis_storms = own.storms;
    loop->hysteresis_failed = own.failed;
    loop->unseen = own.unseen;
    if (!(own.worst > loop->worst))
        return 0;
    loop->worst = own.worst;
    loop->worst_gain = own.worst_gain;
    loop->worst_frequency = own.worst_frequency;
    loop->worst_step = own.worst_step;
    loop->worst_hysteresis = own.worst_hysteresis;
    return 0;
}

int trial_certify_target(const trial *trial, int enough, certificate_target *target, char *error)
{
    certificate_loop loop;
    bool is_stable = false;
    memset(&loop, 0, sizeof loop);
    memcpy(target->reason, trial->no_target, sizeof target->reason);
    if (!trial->has_target)
        return 0;
    const storm_rig *rig = &trial->at_target;
    /*
     * The structure at its target shape is tested with a third of the storms (simulations with fast
     * jumps of the target): those of the first of three random sequences of targets.
     */
    if (trial_measure_growth(rig, &loop, &is_stable, error) < 0 ||
        (is_stable && trial_run_storms(rig, STORMS / SEEDS, enough, &loop, error) < 0))
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

/* ---- age of the readings ---------------------------------------------- */

bool trial_visit_pass(void *context, const storm_task *task, const storm_result *result)
{
    bool *passed = context;
    *passed = trial_has_passed(task, result);
    return *passed;
}

int trial_try_age(const storm_rig *rig, int storms, int older, bool *settles, char *error)
{
    storm_task task[STORMS + PLANTS];
    for (int i = 0; i < storms; i++)
        task[i] = (storm_task){.plant = trial_plant(storms - 1 - i, older)};
    for (int i = 0; i < PLANTS; i++)
        task[storms + i] = trial_growth_task(rig, storm_gain[i], storm_frequency[i], older);
    *settles = true;
    return storm_batch_run(rig, task, storms + PLANTS, trial_visit_pass, settles, error);
}

int trial_count_ages(const storm_rig *rig, int storms, int sign, int most, int *stood, char *error)
{
    bool settles = true;
    while (settles && *stood < most) {
        if (trial_try_age(rig, storms, sign * (*stood + 1), &settles, error) < 0)
            return -1;
        *stood += settles;
    }
    return 0;
}

int trial_try_neighbouring_ages(const trial *trial, certificate_loop *loop, char *error)
{
    const int newest = loop->delay < 1 ? 0 : 1, few = STORMS / SEEDS;
    certificate_target *target = &loop->target;
    if (trial_count_ages(&trial->rig, STORMS, 1, 1, &loop->older, error) < 0 ||
        trial_count_ages(&trial->rig, STORMS, -1, newest, &loop->newer, error) < 0)
        return -1;
    if (!target->is_made)
        return 0;
    return trial_count_ages(&trial->at_target, few, 1, 1, &target->older, error) < 0 ||
                   trial_count_ages(&trial->at_target, few, -1, newest, &target->newer, error) < 0
               ? -1
               : 0;
}
