/*
 * Control laws on the plate of the demonstration with inertia: 25 inputs, 121 outputs, 100 modes
 * with a damping ratio of 0.005, 1000 ticks a second, limits of 300 V, step limit of 20 V. One row
 * for each law, in the markup of README.md. Every law obeys the same limits and step limits, to the
 * last bit. Its settings are those that pass the most storms; of these, the fastest if they pass
 * all, else those whose storms end closest to the optimum. They are searched for each age of the
 * readings (0, 1 and 3 ticks) anew, along the axes of a grid in turn, until no axis improves them.
 * The vibration damper has the settings of its name, those that its certificate chooses, and for
 * comparison those of such a search.
 *
 *   laws NUMBER    the row of one law, numbered from 1
 *   laws           how many laws there are
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/simulate/certify.h"
#include "../rigs/loop_tests.h"
#include "../rigs/rival.h"
#include "../rigs/scene_run.h"

enum {
    MODES = 100,
    DELAYS = 3,
    RUN = 2000,         /* ticks of a step; a law that has not settled then never does */
    FREE_RUN = 8000,    /* ticks after an impulse: more than the plate's own damping takes */
    OFFSET_RUN = 10000, /* ticks after which the offset is measured */
    MOST_VALUES = 8,
    MOST_AXES = 6,
    SWEEPS = 6, /* most searches along all axes of a grid */
    OTHER_SEEDS = 5
};
static const int delays[DELAYS] = {0, 1, 3}; /* age of the readings (ticks) */
static const double interval = 1e-3, step_limit = 20;

/* ---- grids of settings -------------------------------------------------- */

/* Settings of a rival that a grid varies. */
typedef enum axis_name {
    SHARE = 1,
    REGULARISATION,
    GAIN,
    LEAK,
    WEIGHT,
    KICK,
    DRIFT,
    PPF_MODES,
    FEEDBACK,
    FILTER_RATIO,
    FILTER_FREQUENCY,
    DAMPING,
    STRENGTH,
    MIX,
    FOLLOW
} axis_name;

static const char *const axis_text[] = {
    [SHARE] = "share",
    [REGULARISATION] = "regularisation",
    [GAIN] = "gain",
    [LEAK] = "leak",
    [WEIGHT] = "weight",
    [KICK] = "kick",
    [DRIFT] = "drift",
    [PPF_MODES] = "modes",
    [FEEDBACK] = "feedback",
    [FILTER_RATIO] = "filter damping",
    [STRENGTH] = "damping",
    [MIX] = "mix",
    [FOLLOW] = "follow",
    [DAMPING] = "damping",
    [FILTER_FREQUENCY] = "filter frequency",
};

typedef struct axis {
    axis_name name; /* 0: end of the axes */
    int count;
    double value[MOST_VALUES];
} axis;

typedef enum preset { TUNED, DEFAULT, PROVABLE, CERTIFIED } preset;

/* clang-format off */
static const struct law_row {
    const char *name;
    rival_kind kind;
    preset preset;   /* TUNED: by a search in the grid of `axes`; else: settings of the damper */
    double cut;      /* of RIVAL_WISH */
    double governor;
    axis axes[MOST_AXES];
} laws[] = {
    {"control step without damper", RIVAL_STEP, TUNED, 0, 0,
     {{SHARE, 1, {1}}}},
    {"the same, going a part of the way in a tick", RIVAL_STEP, TUNED, 0, 0,
     {{SHARE, 8, {0.1, 0.03, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002}}}},
    {"leaky integrator", RIVAL_LEAKY, TUNED, 0, 0,
     {{GAIN, 8, {0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0005, 0.0002}},
      {LEAK, 6, {0, 1e-5, 1e-4, 1e-3, 1e-2, 0.1}}}},
    {"pseudo-inverse and clip", RIVAL_CLIPPED, TUNED, 0, 0,
     {{SHARE, 8, {1, 0.1, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002}},
      {REGULARISATION, 4, {0, 1e-4, 1e-3, 1e-2}}}},
    {"LQG and clip", RIVAL_LQG, TUNED, 0, 0,
     {{WEIGHT, 8, {1, 10, 30, 100, 300, 1000, 3000, 10000}},
      {KICK, 5, {0.12, 0.25, 0.5, 1, 2}},
      {DRIFT, 6, {0.05, 0.1, 0.21, 0.38, 0.7, 1.4}}}},
    {"LQG about the optimum within the limits, and clip", RIVAL_LQG_BOUNDED, TUNED, 0, 0,
     {{WEIGHT, 8, {1, 10, 30, 100, 300, 1000, 3000, 10000}},
      {KICK, 5, {0.12, 0.25, 0.5, 1, 2}},
      {DRIFT, 6, {0.05, 0.1, 0.21, 0.38, 0.7, 1.4}}}},
    {"the same with governor", RIVAL_LQG_BOUNDED, TUNED, 0, 0.5,
     {{WEIGHT, 8, {1, 10, 30, 100, 300, 1000, 3000, 10000}},
      {KICK, 5, {0.12, 0.25, 0.5, 1, 2}},
      {DRIFT, 6, {0.05, 0.1, 0.21, 0.38, 0.7, 1.4}}}},
    {"positive position feedback and integrator", RIVAL_PPF, TUNED, 0, 0,
     {{PPF_MODES, 4, {2, 3, 5, 9}},
      {FEEDBACK, 5, {0.1, 0.2, 0.4, 0.6, 0.8}},
      {FILTER_RATIO, 5, {0.1, 0.2, 0.4, 0.6, 0.9}},
      {FILTER_FREQUENCY, 5, {0.8, 1, 1.2, 1.5, 2}},
      {GAIN, 6, {0.0005, 0.001, 0.002, 0.005, 0.01, 0.02}},
      {SHARE, 5, {1, 0.1, 0.05, 0.03, 0.01}}}},
    {"S", RIVAL_WISH, TUNED, 0, 0,
     {{DAMPING, 5, {1, 0.7, 0.5, 0.35, 0.25}},
      {DRIFT, 5, {0.38, 0.21, 0.1, 0.05, 0.02}},
      {KICK, 4, {1, 0.5, 0.25, 0.12}}}},
    {"S2", RIVAL_WISH, TUNED, 0.7, 0,
     {{DAMPING, 5, {1, 0.7, 0.5, 0.35, 0.25}},
      {DRIFT, 5, {0.38, 0.21, 0.1, 0.05, 0.02}},
      {KICK, 4, {1, 0.5, 0.25, 0.12}}}},
    {"E0: damper in the form with a proof", RIVAL_DAMPER, PROVABLE, 0, 0, {{0}}},
    {"E: damper, default settings", RIVAL_DAMPER, DEFAULT, 0, 0, {{0}}},
    {"E: damper, settings that its certificate chooses", RIVAL_DAMPER, CERTIFIED, 0, 0, {{0}}},
    {"the same with governor", RIVAL_DAMPER, CERTIFIED, 0, 0.5, {{0}}},
    {"E: damper, settings of a search", RIVAL_DAMPER, TUNED, 0, 0,
     {{STRENGTH, 5, {0.35, 0.5, 0.75, 1, 1.2}},
      {MIX, 4, {0, 0.3, 0.65, 1}},
      {FOLLOW, 5, {0.2, 0.25, 0.317, 0.4, 0.5}},
      {DRIFT, 5, {0.1, 0.21, 0.38, 0.7, 1.4}},
      {KICK, 5, {0.06, 0.12, 0.25, 0.5, 1}}}},
};
/* clang-format on */
enum { LAWS = sizeof laws / sizeof *laws };

static void set_axis(rival_settings *settings, axis_name name, double value)
{
    switch (name) {
    case SHARE: settings->share = value; break;
    case REGULARISATION: settings->regularisation = value; break;
    case GAIN: settings->gain = value; break;
    case LEAK: settings->leak = value; break;
    case WEIGHT: settings->weight = value; break;
    case KICK: settings->damper.kick = value; break;
    case DRIFT: settings->damper.drift = value; break;
    case PPF_MODES: settings->modes = (size_t)value; break;
    case FEEDBACK: settings->feedback = value; break;
    case FILTER_RATIO: settings->filter_ratio = value; break;
    case FILTER_FREQUENCY: settings->filter_frequency = value; break;
    case DAMPING: settings->damping = value; break;
    case STRENGTH: settings->damper.damping = value; break;
    case MIX: settings->damper.mix = value; break;
    case FOLLOW: settings->damper.follow = value; break;
    }
}

/* A point of a law's grid: number of the value on each axis. */
typedef struct grid_point {
    int at[MOST_AXES];
} grid_point;

static int axes_of(const struct law_row *law)
{
    int count = 0;
    while (count < MOST_AXES && law->axes[count].count > 0)
        count++;
    return count;
}

static rival_settings settings_at(const struct law_row *law, const grid_point *point)
{
    const bool is_damper = law->kind == RIVAL_DAMPER;
    rival_settings settings = {.kind = law->kind,
                               .share = 1,
                               .damper = is_damper ? damper_default_settings()
                                                   : rival_observer(0.25, 0.21),
                               .cut = law->cut,
                               .governor = law->governor};
    for (int i = 0; i < axes_of(law); i++)
        set_axis(&settings, law->axes[i].name, law->axes[i].value[point->at[i]]);
    return settings;
}

/* ---- measurements ------------------------------------------------------- */

/* Storms of a law on five plants, with the whole and a quarter of the step limit. */
static void ten_storms(const modal_structure *plate, const rival_settings *settings, int believed,
                       int delay, unsigned seed, int enough, storm_tally *tally)
{
    for (int quarter = 0; quarter < 2 && tally->failed < enough; quarter++) {
        rival rival;
        rival_open(&rival, plate, interval, step_limit / (quarter ? 4 : 1), believed, settings);
        loop_storms(&rival.loop, delay, seed, enough, tally);
        rival_close(&rival);
    }
}

/* Times in ticks until 5 % are left. */
typedef struct speed {
    int target, load, load_alone, impulse;
    double offset[2]; /* distance from the bounded optimum in the end, relative to the goal: for the
                         goal, and for twice the goal, where voltages are at their limits */
    double noise;     /* RMS voltage that noise causes, over the voltage limit */
} speed;

/* Steps of the target and of the load that stays on it, and an impulse. */
static speed measure_speed(const modal_structure *plate, const rival_settings *settings, int delay)
{
    rival rival;
    speed speed = {0};
    damped_loop *loop = &rival.loop;
    rival_open(&rival, plate, interval, step_limit, delay, settings);
    loop->error.delay = delay;
    damped_loop_reset(loop, loop->error);
    speed.target = loop_settle(loop, plate->goal, RUN);
    loop->load = loop_moderate_load(plate);
    speed.load = loop_settle(loop, plate->goal, RUN);
    speed.impulse = loop_impulse(loop, FREE_RUN);
    rival_close(&rival);
    return speed;
}

/* Load step without target, offsets, and noise. */
static void measure_rest(const modal_structure *plate, const rival_settings *settings, speed *speed)
{
    rival rival;
    damped_loop *loop = &rival.loop;
    double *best = calloc(2 * plate->outputs, sizeof *best), *wanted = best + plate->outputs;
    rival_open(&rival, plate, interval, step_limit, 0, settings);
    speed->load_alone = loop_load_step(loop, RUN);
    for (int size = 1; size <= 2; size++) {
        for (size_t i = 0; i < plate->outputs; i++)
            wanted[i] = size * plate->goal[i];
        damped_loop_reset(loop, loop->error);
        loop->load = loop_moderate_load(plate);
        (void)loop_settle(loop, wanted, OFFSET_RUN);
        damped_loop_optimum(loop, wanted, best);
        speed->offset[size - 1] = damped_loop_distance(loop, best);
    }
    speed->noise = loop_noise(loop);
    rival_close(&rival);
    free(best);
}

static double sine(const modal_structure *plate, const rival_settings *settings)
{
    rival rival;
    rival_open(&rival, plate, interval, step_limit, 1, settings);
    rival.loop.error.delay = 1;
    const double error = loop_tracking_error(&rival.loop, 10);
    rival_close(&rival);
    return error;
}

/* Mean multiply-adds of a tick, in a storm on the model. */
static double work(const modal_structure *plate, const rival_settings *settings)
{
    rival rival;
    rival_open(&rival, plate, interval, step_limit, 0, settings);
    (void)loop_storm(&rival.loop, EXACT_PLANT, LOOP_SEED, 1200);
    const double mean = rival.work / fmax((double)rival.ticks, 1);
    const double fixed = rival_work(&rival);
    rival_close(&rival);
    return fixed + mean;
}

/* ---- choice of the settings --------------------------------------------- */

typedef struct choice {
    rival_settings settings;
    grid_point point;
    storm_tally storms;
    int ticks; /* sum of the times of target step, load step and impulse */
    bool is_made;
} choice;

/*
 * Whether settings pass more storms than the best so far; of settings with which storms fail,
 * whether these end closer to the optimum; of those that pass all storms, whether they are faster.
 */
static bool is_better(const choice *next, const choice *best)
{
    if (!best->is_made || next->storms.failed != best->storms.failed)
        return !best->is_made || next->storms.failed < best->storms.failed;
    return next->storms.failed > 0 ? next->storms.worst < best->storms.worst
                                   : next->ticks < best->ticks;
}

/* Try one point of the grid, and keep it if it is the best so far. Returns whether it is. */
static bool try_point(const modal_structure *plate, const struct law_row *law, int delay,
                      const grid_point *point, choice *best)
{
    choice next = {.settings = settings_at(law, point), .point = *point, .is_made = true};
    const int enough = best->is_made ? best->storms.failed + 1 : INT_MAX;
    ten_storms(plate, &next.settings, delay, delay, LOOP_SEED, enough, &next.storms);
    if (next.storms.failed >= enough)
        return false;
    const speed speed = measure_speed(plate, &next.settings, delay);
    next.ticks = speed.target + speed.load + speed.impulse;
    if (!is_better(&next, best))
        return false;
    *best = next;
    return true;
}

/* Search along the axes of a law's grid in turn, from the middle of the grid. */
static choice tune(const modal_structure *plate, const struct law_row *law, int delay)
{
    choice best = {.is_made = false};
    grid_point middle = {{0}};
    bool has_changed = true;
    for (int i = 0; i < axes_of(law); i++)
        middle.at[i] = law->axes[i].count / 2;
    (void)try_point(plate, law, delay, &middle, &best);
    for (int sweep = 0; sweep < SWEEPS && has_changed; sweep++) {
        has_changed = false;
        for (int i = 0; i < axes_of(law); i++) {
            const grid_point from = best.point;
            for (int k = 0; k < law->axes[i].count; k++) {
                grid_point point = from;
                point.at[i] = k;
                if (k != from.at[i])
                    has_changed |= try_point(plate, law, delay, &point, &best);
            }
        }
    }
    return best;
}

/* Settings that the certificate of the damper chooses for one age of the readings. */
static damper_settings certified(int delay)
{
    static const char changes[] =
        "kinematics=linear;simulate.influence=undeformed;simulate.plant.kinematics=linear;"
        "simulate.sensors.noise=0;simulate.amplifiers.step=0;simulate.events=[]";
    scene_run run;
    if (scene_run_open(&run, "plate-closed-loop", changes) < 0 ||
        analysis_influence(&run.analysis, run.error) < 0)
        exit((fprintf(stderr, "%s\n", run.error), 1));
    certificate_make(&run.analysis.certificate, &run.analysis);
    run.analysis.design.simulate.delay = delay;
    if (certify_loop(&run.analysis, run.error) < 0 || !run.analysis.certificate.has_settings)
        exit((fprintf(stderr, "%s\n", run.error), 1));
    const damper_settings settings = run.analysis.certificate.settings;
    scene_run_close(&run);
    return settings;
}

static damper_settings preset_settings(preset preset, int delay)
{
    damper_settings settings = damper_default_settings();
    if (preset == CERTIFIED)
        return certified(delay);
    if (preset == PROVABLE) {
        settings.damping = 0.5;
        settings.mix = 0;
        settings.is_gradient = true;
    }
    return settings;
}

static choice choose(const modal_structure *plate, const struct law_row *law, int delay)
{
    if (law->preset == TUNED)
        return tune(plate, law, delay);
    choice choice = {.settings = {.kind = law->kind,
                                  .governor = law->governor,
                                  .damper = preset_settings(law->preset, delay)}};
    ten_storms(plate, &choice.settings, delay, delay, LOOP_SEED, INT_MAX, &choice.storms);
    return choice;
}

/* ---- table -------------------------------------------------------------- */

static void print_time(int ticks, int run)
{
    if (ticks < run)
        printf(" | %d", ticks);
    else
        printf(" | never");
}

static void print_settings(const struct law_row *law, const choice of[DELAYS])
{
    if (law->preset != TUNED)
        printf("-");
    for (int i = 0; i < axes_of(law); i++) {
        printf("%s%s", i ? "; " : "", axis_text[law->axes[i].name]);
        for (int d = 0; d < DELAYS; d++)
            printf("%s%g", d ? ", " : " ", law->axes[i].value[of[d].point.at[i]]);
    }
}

/* Storms of the settings chosen for each age of the readings. */
typedef struct outcome {
    storm_tally storms, others, older; /* those of the search; other seeds; readings 1 tick older */
} outcome;

static void run_storms(const modal_structure *plate, const choice of[DELAYS], outcome *all)
{
    memset(all, 0, sizeof *all);
    for (int d = 0; d < DELAYS; d++) {
        const rival_settings *settings = &of[d].settings;
        const int delay = delays[d];
        all->storms.failed += of[d].storms.failed;
        all->storms.worst = fmax(all->storms.worst, of[d].storms.worst);
        ten_storms(plate, settings, delay, delay + 1, LOOP_SEED, INT_MAX, &all->older);
        for (unsigned k = 1; k <= OTHER_SEEDS; k++)
            ten_storms(plate, settings, delay, delay, LOOP_SEED + k, INT_MAX, &all->others);
    }
}

static void print_row(const modal_structure *plate, const struct law_row *law)
{
    choice of[DELAYS];
    outcome all;
    for (int d = 0; d < DELAYS; d++)
        of[d] = choose(plate, law, delays[d]);
    run_storms(plate, of, &all);
    speed speed = measure_speed(plate, &of[0].settings, 0);
    measure_rest(plate, &of[0].settings, &speed);
    printf("| %s | %d | %.2g | %d | %d", law->name, all.storms.failed, all.storms.worst,
           all.others.failed, all.older.failed);
    print_time(speed.target, RUN);
    print_time(speed.load, RUN);
    print_time(speed.load_alone, RUN);
    if (speed.impulse < FREE_RUN)
        printf(" | %.3g", (double)loop_undamped_ticks(plate, interval) / speed.impulse);
    else
        printf(" | never");
    printf(" | %.1g | %.1g | %.3f | %.1g | %.0f | ", speed.offset[0], speed.offset[1],
           sine(plate, &of[1].settings), speed.noise, work(plate, &of[0].settings));
    print_settings(law, of);
    printf(" |\n");
    fflush(stdout);
}

int main(int count, char **argument)
{
    modal_structure plate;
    const long number = count > 1 ? strtol(argument[1], NULL, 10) : 0;
    if (number < 1 || number > LAWS) {
        printf("%d\n", LAWS);
        return count > 1;
    }
    structure_of_plate(&plate, MODES);
    print_row(&plate, &laws[number - 1]);
    structure_close(&plate);
    return 0;
}
