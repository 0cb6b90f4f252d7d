/* SPDX-License-Identifier: BSD-2-Clause */
/* Choice of the settings of the vibration damper (certify_trial.h). */
#include <math.h>
#include <string.h>
#include "certify_trial.h"
#include "load_step.h"

static const double two_pi = 6.283185307179586;

/*
 * Settings of the vibration damper, of which the stability tests choose one row. The first three
 * rows compensate a load step fast; of these, rows with less noise in the voltages come first. The
 * other rows stay stable with larger errors of the assumed delay of the readings. Units are those
 * of damper_settings.
 *   damping  strength of the damping
 *   mix      weight of the change of velocity in a tick in the estimate of a mode's deviation from
 *            equilibrium; the mode's position has the weight 1 - mix
 *   follow   speed at which the voltages approach the statically optimal voltages
 *   drift    random change of the loads that the observer assumes: a larger value estimates a load
 *            faster, with more sensor noise in the voltages
 *   kick     random change of the first mode's velocity in a tick that the observer assumes
 *   later    assumed additional age of the sensor readings (ticks)
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
 * How much slower a loop may settle after fast target jumps if its settings tolerate larger errors
 * of the readings' delay: factor of the settling time with the first settings that passed all
 * tests.
 */
static const double slowest = 1.25;

/*
 * Gains of the low-pass filter for residual readings (damper_settings.slow) that are tried after a
 * row of settings is chosen, the largest first. Each is this number times the phase angle (rad) by
 * which the first observed mode advances in a tick. With the first number the filter leaves 5 % of
 * a residual after 3.2 periods of the mode.
 */
static const double residual_part[] = {0.15, 0.075, 0.0375};
static const double residual_limit = 0.15; /* largest gain of the low-pass filter of the residual
                                              readings (dimensionless) */

/*
 * With a faster filter of the residual readings, small vibrations must still decay on a structure
 * whose static response to voltages is this multiple of the model's. It is more than the 1.33 of
 * the other tests, so that the filter does not use up the margin of the loop.
 */
static const double residual_margin = 1.6;

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
 * Measure the time in which the loop compensates a suddenly applied load, with the settings in one
 * row of the table `choices`.
 *   periods out  time (periods of the first observed mode); NAN where no mode is observed, or where
 *                no load can be compensated
 * Returns 0, or -1 with error filled.
 */
static int measure_load_step(trial *trial, int choice, double *periods, char *error)
{
    damper_options options;
    set_options(trial, choice, &options);
    *periods = (double)NAN;
    if (trial_use(trial, &options, error) < 0)
        return -1;
    if (trial->damper.modes == 0)
        return 0;
    return load_step_periods(&trial->rig, trial->damper.frequency[0], periods, error);
}

/*
 * Time after which the low-pass filter of the residual readings leaves 5 % of a sudden residual
 * (periods of the first observed mode).
 *   angle in  phase angle of this mode in a tick (rad); 0: no mode is observed, and the time NAN
 *   gain  in  gain of the filter
 */
static double residual_periods(double angle, double gain)
{
    return angle > 0 ? log(0.05) / log1p(-gain) * angle / two_pi : (double)NAN;
}

/* Number of storms (simulations with fast jumps of the target) in which a loop does not settle. */
static int count_failures(const certificate_loop *loop)
{
    return loop->failed + loop->hysteresis_failed + loop->target.failed;
}

/*
 * Number of storms (simulations with fast jumps of the target) that may fail to settle with the
 * next choice of settings. With one more failure it is no better than the best choice so far.
 */
static int enough_failures(const certificate_loop *best)
{
    const int failed = best->is_stable ? 0 : count_failures(best);
    if (!best->is_made || failed > ENOUGH)
        return ENOUGH;
    return failed > 0 ? failed : 1;
}

/*
 * Test the stability of the control loop with given settings of the vibration damper by
 * simulations, which end where the loop is no better than the best one so far.
 *   options in  options of the vibration damper with these settings
 *   older   in  1: the loop is known to tolerate readings that are one tick older; otherwise 0
 * Returns 0, or -1 with error filled.
 */
static int try_settings(trial *trial, const damper_options *options, int older,
                        certificate_loop *loop, char *error)
{
    const int enough = enough_failures(&trial->analysis->certificate.loop);
    bool is_stable;
    memset(loop, 0, sizeof *loop);
    if (trial_use(trial, options, error) < 0 ||
        trial_measure_growth(&trial->rig, loop, &is_stable, error) < 0 ||
        (is_stable && trial_run_storms(&trial->rig, STORMS, enough, loop, error) < 0) ||
        (is_stable && loop->failed == 0 &&
         trial_run_hysteresis(&trial->rig, enough, loop, error) < 0))
        return -1;
    loop->is_made = true;
    loop->is_stable = is_stable && loop->failed + loop->hysteresis_failed == 0;
    if (loop->is_stable && trial_certify_target(trial, enough, &loop->target, error) < 0)
        return -1;
    loop->is_stable = loop->is_stable && (!loop->target.is_made || loop->target.is_stable);
    loop->unit = storm_unit(&trial->rig);
    loop->modes = (int)trial->rig.modal.modes;
    loop->observed = trial->damper.modes;
    loop->has_slow_mode = trial->damper.has_slow_mode;
    if (loop->observed > 0) {
        loop->observed_from = trial->damper.frequency[0];
        loop->observed_to = trial->damper.frequency[loop->observed - 1];
    }
    loop->delay = trial->analysis->design.simulate.delay;
    loop->bandwidth = trial->analysis->design.simulate.imperfections.bandwidth;
    loop->less_bandwidth = TRIAL_LESS_BANDWIDTH;
    loop->models_lag = trial->damper.tables.lag != NULL;
    loop->older = older;
    loop->angle = first_angle(trial);
    loop->residual = residual_periods(loop->angle, trial->damper.tables.slow);
    loop->less_hysteresis = trial->blocks.compensation.is_used ? TRIAL_LESS_HYSTERESIS : 0;
    return loop->is_stable ? trial_try_neighbouring_ages(trial, loop, error) : 0;
}

/*
 * Return a score for how well a loop tolerates a change of the readings' delay by one tick: 2 if it
 * is stable with a longer delay, plus 1 with a shorter one. Longer delays count more: filters and
 * queues outside the model lengthen the delay.
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
 * tests is better than one that fails.
 *   fastest in  mean number of ticks until the shape settles, with the first settings that pass
 */
static bool is_better(const certificate_loop *loop, const certificate_loop *best, double fastest)
{
    if (!best->is_made || loop->is_stable != best->is_stable)
        return !best->is_made || loop->is_stable;
    /*
     * Of two loops that fail the stability tests, the one with fewer failed storms (fast jumps of
     * the target) is better.
     */
    if (!loop->is_stable)
        return count_failures(loop) < count_failures(best);
    /*
     * Of two loops that pass the stability tests, the better one tolerates the larger error of the
     * assumed delay of the readings. It may settle somewhat later than the first loop that passed
     * (`slowest`).
     */
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
    if (trial_use(trial, &options, error) < 0)
        return -1;
    return trial_try_age(&trial->rig, STORMS, 1, tolerates, error);
}

/*
 * Test one row of the table `choices` of damper settings, and keep it if it is better than the best
 * one so far.
 *   load_step in      time in which the loop compensates a load step with these settings (periods
 *                     of the first mode)
 *   fastest   in/out  mean number of ticks until the shape settles after a storm (fast jumps of the
 *                     target), with the first settings that passed; 0 as long as none have passed
 * Returns 0, or -1 with error filled.
 */
static int compare_choice(trial *trial, int choice, double load_step, double *fastest, char *error)
{
    certificate *certificate = &trial->analysis->certificate;
    certificate_loop loop;
    damper_options options;
    bool tolerates = true;
    const bool has_stable = certificate->loop.is_stable;
    /*
     * Once some settings have passed all tests, others can only be better if they also work with
     * readings that are one tick older than the scene file states. This test takes little time and
     * comes first.
     */
    if (has_stable && try_older(trial, choice, &tolerates, error) < 0)
        return -1;
    if (!tolerates)
        return 0;
    set_options(trial, choice, &options);
    if (try_settings(trial, &options, has_stable, &loop, error) < 0)
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
    double load_step; /* time until the loop has compensated a load that appears at once, with the
                         settings of this row (periods of the first vibration mode that the loop
                         observes) */
} candidate;

/*
 * Test the damper settings in one row of the table `choices`, once, and keep them if they are
 * better than the best ones so far. Settings that assume readings older than PZS_DELAY_LIMIT ticks
 * are left out.
 *   only_fast in      true: leave out settings that need more than CERTIFICATE_LOAD_STEP periods to
 *       compensate a load step
 *   candidate in/out  results so far of this row
 *   fastest   in/out  mean number of ticks of a storm (fast jumps of the target) with the first
 *       settings that pass
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
 * Determine whether the loop with its present tables keeps its margin: small vibrations decay at
 * the static response `residual_margin`. Returns 0, or -1 with error filled.
 */
static int keeps_margin(const trial *trial, bool *keeps, char *error)
{
    const storm_task task = trial_growth_task(&trial->rig, residual_margin, 1, 0);
    *keeps = true;
    return storm_batch_run(&trial->rig, &task, 1, trial_visit_pass, keeps, error);
}

/*
 * Test the chosen settings with another gain of the low-pass filter of the residual readings. Keep
 * this gain if the loop still passes the tests that it passed before: growth of small vibrations,
 * fast jumps of the target, sudden loads, and readings one tick older or newer.
 *   is_kept out  whether the gain is kept
 * Returns 0, or -1 with error filled.
 */
static int try_residual(trial *trial, double gain, bool *is_kept, char *error)
{
    certificate *certificate = &trial->analysis->certificate;
    const certificate_loop *best = &certificate->loop;
    damper_options options = damper_options_of(trial->analysis);
    certificate_loop loop;
    double load_step;
    bool keeps;
    options.settings.slow = gain;
    *is_kept = false;
    if (trial_use(trial, &options, error) < 0 || keeps_margin(trial, &keeps, error) < 0)
        return -1;
    if (!keeps)
        return 0;
    if (load_step_periods(&trial->rig, trial->damper.frequency[0], &load_step, error) < 0)
        return -1;
    if (load_step > fmax(best->load_step, CERTIFICATE_LOAD_STEP))
        return 0;
    if (try_settings(trial, &options, 0, &loop, error) < 0)
        return -1;
    *is_kept = loop.is_stable && certificate_older(&loop) >= certificate_older(best) &&
               certificate_newer(&loop) >= certificate_newer(best);
    if (!*is_kept)
        return 0;
    loop.load_step = load_step;
    certificate->loop = loop;
    certificate->settings = options.settings;
    return 0;
}

/*
 * Choose the largest gain of the low-pass filter of the residual readings with which the chosen
 * loop still passes its tests. The fixed gain of the default settings would take many periods of
 * the first observed mode where a period has few ticks. Returns 0, or -1 with error filled.
 */
static int choose_residual(trial *trial, char *error)
{
    const certificate *certificate = &trial->analysis->certificate;
    const size_t parts = sizeof residual_part / sizeof *residual_part;
    bool is_kept = false;
    for (size_t i = 0; i < parts && certificate->loop.angle > 0 && !is_kept; i++) {
        const double gain = fmin(residual_part[i] * certificate->loop.angle, residual_limit);
        if (gain <= certificate->settings.slow)
            return 0;
        if (try_residual(trial, gain, &is_kept, error) < 0)
            return -1;
    }
    return 0;
}

/*
 * Choose a row of the table `choices`, as trial_choose does. Returns 0, or -1 with error filled.
 */
static int choose_row(trial *trial, char *error)
{
    const certificate_loop *best = &trial->analysis->certificate.loop;
    const scene_control *control = &trial->analysis->design.control;
    candidate of[CHOICES] = {{false, false, 0}};
    double fastest = 0;
    damper_options first;
    set_options(trial, 0, &first);
    if (trial_use(trial, &first, error) < 0)
        return -1;
    const double angle = first_angle(trial);
    /*
     * Settings must compensate load steps fast if a period of the first mode has enough ticks,
     * unless the scene file asks for tolerance of older readings (delay_margin).
     */
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

int trial_choose(trial *trial, char *error)
{
    if (choose_row(trial, error) < 0)
        return -1;
    return trial->analysis->certificate.loop.is_stable ? choose_residual(trial, error) : 0;
}
