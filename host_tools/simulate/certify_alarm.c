/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Storms (simulations with fast jumps of the target) with the supervisor of the loop, which must
 * not take control away while the loop is in order (certify_trial.h). After a jump of the target
 * the supervisor tolerates a larger deviation of the shape; this tolerance decays with the fading
 * time.
 */
#include <math.h>
#include "certify_trial.h"

/*
 * Largest time in which the supervisor's tolerance after a jump of the target may fall by a factor
 * e (periods of the first observed mode); longer times are not tried.
 */
static const double longest_fading = 128;

/*
 * The default fading time of the supervisor's tolerance is replaced by the decay time of the
 * slowest vibration if that is longer by at least this factor.
 */
static const double slower = 1.5;

/* Alarms of the supervisor in several storms (simulations with fast jumps of the target). */
typedef struct alarms {
    int count;
    int enough; /* number of alarms after which no further storm (simulation with fast jumps of the
                   target) is run */
} alarms;

static bool visit_alarm(void *context, const storm_task *task, const storm_result *result)
{
    alarms *alarms = context;
    (void)task;
    alarms->count += result->is_stopped;
    return alarms->count < alarms->enough;
}

/*
 * Count the storms (simulations with fast jumps of the target) in which the supervisor takes
 * control away from the loop; no further storm is run after `enough` of them. Returns 0, or -1 with
 * error filled.
 */
static int count_alarms(const storm_rig *rig, int enough, int *count, char *error)
{
    alarms alarms = {0, enough};
    storm_task task[STORMS];
    for (int i = 0; i < STORMS; i++)
        task[i] = (storm_task){.plant = trial_plant(i, 0)};
    const int failed = storm_batch_run(rig, task, STORMS, visit_alarm, &alarms, error);
    *count = alarms.count;
    return failed;
}

/*
 * After a jump of the target the supervisor tolerates vibration that fades with a time constant.
 * Return the time constant with which the search for a suitable one begins (periods): that of the
 * slowest vibration on all structures that the stability tests simulate, or the default unless the
 * former is much longer.
 */
static double first_fading(const trial *trial, double usual)
{
    const double radius = trial->analysis->certificate.loop.radius,
                 period = trial->damper.rate / trial->damper.frequency[0];
    const double needed = radius > 0 && radius < 1 ? -1 / (log(radius) * period) : longest_fading;
    return needed > slower * usual ? fmin(needed, longest_fading) : usual;
}

/*
 * Run the storms (simulations with fast jumps of the target) with one fading time of the
 * supervisor's tolerance, and count the alarms. Returns 0, or -1 with error filled.
 */
static int try_fading(trial *trial, const damper_options *options, int *alarms, char *error)
{
    const bool is_last = 2 * options->settings.fading_periods > longest_fading;
    if (trial_use(trial, options, error) < 0)
        return -1;
    trial->rig.is_supervised = true;
    const int failed = count_alarms(&trial->rig, is_last ? STORMS : 1, alarms, error);
    trial->rig.is_supervised = false;
    return failed;
}

int trial_choose_fading(trial *trial, char *error)
{
    certificate *certificate = &trial->analysis->certificate;
    certificate_loop *loop = &certificate->loop;
    damper_options options = damper_options_of(trial->analysis);
    if (trial_use(trial, &options, error) < 0)
        return -1;
    if (trial->rig.supervision == NULL || trial->damper.modes == 0)
        return 0;
    options.settings.fading_periods = first_fading(trial, options.settings.fading_periods);
    int failed = try_fading(trial, &options, &loop->alarms, error);
    while (!failed && loop->alarms > 0 && 2 * options.settings.fading_periods <= longest_fading) {
        options.settings.fading_periods *= 2;
        failed = try_fading(trial, &options, &loop->alarms, error);
    }
    loop->fading = options.settings.fading_periods;
    certificate->settings = options.settings;
    certificate->has_settings = true;
    return failed;
}
