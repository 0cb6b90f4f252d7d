/* SPDX-License-Identifier: BSD-2-Clause */
/* Stability margins of a control loop with a vibration model (certify.h). */
#include <math.h>
#include <string.h>
#include "../system/parallel.h"
#include "../system/progress.h"
#include "certify.h"
#include "certify_trial.h"

enum {
    HALVINGS = 5,   /* number of bisections with which a stability margin is determined */
    OLDER_MOST = 4, /* largest change of the sensor readings' delay that the stability tests try
                       (ticks) */
    OCTAVES = 5     /* octaves of tick rates that are tried on either side of the scene's rate */
};

/*
 * Limits of the search for stability margins: largest static response to voltages, lowest frequency
 * and highest frequency of the structure, relative to the model.
 */
static const double gain_most = 10, slow_least = 0.1, fast_most = 5;

/*
 * Search for a stability margin of the loop: how far a factor of the structure's static response to
 * voltages (gain), or of its natural frequencies, may differ from 1 in one direction before small
 * vibrations grow.
 */
typedef struct margin {
    const storm_rig *rig;
    bool is_gain;   /* true: the margin of the gain is searched; false: that of the frequencies */
    double end;     /* factor of the gain or of the frequencies at which the search ends; the search
                       begins at 1 */
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
    const double gain = margin->is_gain ? factor : 1;
    const double frequency = margin->is_gain ? 1 : factor;
    const storm_task task = trial_growth_task(margin->rig, gain, frequency, 0);
    storm_result result;
    if (storm_growth(margin->rig, &task.plant, task.growth_ticks, &result, margin->error) < 0)
        return -1;
    *passed = trial_has_passed(&task, &result);
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
 * Find three margins, in parallel threads: largest static response to voltages (gain), lowest and
 * highest natural frequencies of the structure, relative to the controller's model, with which
 * small vibrations decay. Returns 0, or -1 with error filled.
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
    if ((loop->older > 0 &&
         trial_count_ages(rig, STORMS, 1, OLDER_MOST, &loop->older, error) < 0) ||
        (loop->newer > 0 && trial_count_ages(rig, STORMS, -1, newest, &loop->newer, error) < 0))
        return -1;
    loop->ends_at_most = loop->older == OLDER_MOST;
    return 0;
}

/*
 * Determine whether the control loop is stable at a tick rate, with tables made for this rate.
 * Small vibrations must decay on the modelled structure and on two others. These have 1.33 times
 * its static response and 0.9 or 1.1 times its natural frequencies. On them the shape must also
 * settle after fast jumps of the target. Returns 0, or -1 with error filled.
 */
static int try_rate(trial *trial, double rate, bool *is_stable, char *error)
{
    static const int structure[] = {0, 3, 4}; /* indices of trial_plant: the model, and two
                                                 structures with 1.33 times its static response and
                                                 0.9 or 1.1 times its natural frequencies */
    const storm_rig *rig = &trial->rig;
    damper_options options = damper_options_of(trial->analysis);
    storm_task task[2 * PLANTS];
    int count = 0;
    options.rate = rate;
    *is_stable = false;
    if (trial_use(trial, &options, error) < 0)
        return -1;
    for (size_t i = 0; i < sizeof structure / sizeof *structure; i++) {
        const storm_plant plant = trial_plant(structure[i], 0);
        const double gain = plant.gain, frequency = plant.frequency;
        task[count++] = trial_growth_task(rig, gain, frequency, 0);
        if (i > 0)
            task[count++] = (storm_task){
                .plant = {.gain = gain, .frequency = frequency, .step_limit = 0.25, .seed = 1}};
    }
    return storm_batch_run(rig, task, count, trial_visit_pass, is_stable, error);
}

/*
 * Find how far the tick rate can be raised (factor 2) or lowered (factor 1/2) until the control
 * loop is no longer stable, to half an octave.
 *   from in   stable tick rate (1/s)
 *   rate out  last rate at which the loop is stable (1/s), at most OCTAVES octaves from `from`
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
    if (trial_use(trial, &options, error) < 0 || find_factors(&trial->rig, loop, error) < 0 ||
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
    loop->has_rates = true;
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
    int failed = trial_open(&trial, analysis, error);
    failed = failed || (analysis->certificate.loop.is_stable && find_margins(&trial, error) < 0) ||
             (with_rates && find_rates(&trial, error) < 0);
    trial_close(&trial);
    return failed ? -1 : 0;
}
