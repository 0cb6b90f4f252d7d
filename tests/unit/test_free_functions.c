/*
 * Free functions of the target in a loop with a supervisor: healthy structures, which move along
 * free functions as far as they like, are never parked; structures of which control is lost are
 * parked within 250 ticks. Scenes with a measured influence matrix and with a model, with and
 * without a vibration damper, and with limits on one side of 0 V.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _XOPEN_SOURCE 700
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/cli/templates.h"
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/simulate/storm.h"
#include "../../host_tools/tables/loop_blocks.h"
#include "../rigs/scene_run.h"
#include "../rigs/test_folder.h"
#include "../rigs/uniform.h"

#ifndef FREE_TICKS
#define FREE_TICKS 6000 /* healthy ticks of each loop without a damper */
#endif
enum { LATEST = 250 };

static const char *const functions[] = {"[piston]", "[tip]", "[tilt]", "[piston, tip, tilt]",
                                        "[x*y]"};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

/* ---- files of the measured scene ------------------------------------------ */

/* Write a template of `pzs new` to a file. */
static void write_template(const char *name, const char *file_name)
{
    const char *text = templates_text(name);
    assert_non_null(text);
    write_text(file_name, "%s", text);
}

static int write_scene(void **state)
{
    if (make_test_folder(state) < 0)
        return -1;
    write_template("measured", "measured.yaml");
    write_template("measured-matrix", "measured-matrix.csv");
    return 0;
}

/* ---- quasi-static plants --------------------------------------------------- */

/* A loop of a scene on a plant that follows its voltages at once. */
typedef struct rig {
    scene_run run;
    loop_parts parts;
    pzs_loop loop;
    pzs_supervisor *supervisor;
    void *work;
    double *matrix; /* [targets][amplifiers] influence of the plant */
    double *wanted, *measured;
    double noise;
    unsigned seed;
} rig;

static void open_rig(rig *r, const char *scene, const char *changes)
{
    memset(r, 0, sizeof *r);
    r->seed = 1;
    if (scene_run_open(&r->run, scene, changes) < 0 ||
        analysis_influence(&r->run.analysis, r->run.error) < 0)
        fail_msg("%s, %s: %s", scene, changes, r->run.error);
    certificate_make(&r->run.analysis.certificate, &r->run.analysis);
    if (loop_parts_open(&r->parts, &r->run.analysis, r->run.error) < 0)
        fail_msg("%s, %s: %s", scene, changes, r->run.error);
    const design *design = &r->run.analysis.design;
    const size_t targets = (size_t)design->targets;
    r->matrix = calloc(targets * (size_t)design->amplifiers, sizeof *r->matrix);
    r->wanted = calloc(targets, sizeof *r->wanted);
    r->measured = calloc(targets, sizeof *r->measured);
    r->work = malloc(loop_blocks_bytes(&r->parts.blocks, false));
    r->noise = 1e-3 * design_target_rms(design);
    assert_true(r->matrix && r->wanted && r->measured && r->work);
}

static void close_rig(rig *r)
{
    free(r->matrix);
    free(r->wanted);
    free(r->measured);
    free(r->work);
    loop_parts_close(&r->parts);
    scene_run_close(&r->run);
}

/* Start the loop on a plant with this gain, whose influences are wrong by up to `scatter`. */
static void start(rig *r, double gain, double scatter)
{
    const design *design = &r->run.analysis.design;
    const size_t targets = (size_t)design->targets, amplifiers = (size_t)design->amplifiers,
                 stride = design->structure.input.count,
                 bytes = loop_blocks_bytes(&r->parts.blocks, false);
    for (size_t i = 0; i < targets; i++)
        for (size_t k = 0; k < amplifiers; k++)
            r->matrix[i * amplifiers + k] = gain * r->run.analysis.influence[i * stride + k] *
                                            (1 + uniform(&r->seed, -scatter, scatter));
    memcpy(r->wanted, design->target, targets * sizeof *r->wanted);
    assert_int_equal(pzs_loop_init(&r->loop, r->parts.blocks.block, (size_t)r->parts.blocks.count,
                                   NULL, r->work, bytes),
                     PZS_OK);
    r->supervisor = pzs_loop_find(&r->loop, &pzs_supervisor_block);
    assert_non_null(r->supervisor);
}

static bool is_parked(const rig *r)
{
    const pzs_supervisor_mode mode = r->supervisor->info.mode;
    return mode == PZS_MODE_STOPPING || mode == PZS_MODE_LATCHED;
}

static void tick(rig *r)
{
    const size_t targets = (size_t)r->run.analysis.design.targets,
                 amplifiers = (size_t)r->run.analysis.design.amplifiers;
    for (size_t i = 0; i < targets; i++) {
        double sum = uniform(&r->seed, -r->noise, r->noise);
        for (size_t k = 0; k < amplifiers; k++)
            sum += r->matrix[i * amplifiers + k] * r->loop.info.voltage[k];
        r->measured[i] = sum;
    }
    (void)pzs_loop_tick(&r->loop, r->wanted, r->measured);
}

/* Let the target jump: to a part of that of the scene, or to the shape of random voltages. */
static void jump(rig *r)
{
    const design *design = &r->run.analysis.design;
    const size_t targets = (size_t)design->targets, amplifiers = (size_t)design->amplifiers;
    const double factor = uniform(&r->seed, -1, 1);
    const bool is_shape = uniform(&r->seed, 0, 1) < 0.3;
    for (size_t i = 0; i < targets; i++)
        r->wanted[i] = is_shape ? 0 : factor * design->target[i];
    for (size_t k = 0; k < amplifiers && is_shape; k++) {
        const double voltage = uniform(&r->seed, design->lower[k], design->upper[k]);
        for (size_t i = 0; i < targets; i++)
            r->wanted[i] +=
                r->run.analysis.influence[i * design->structure.input.count + k] * voltage;
    }
}

/* Run a healthy loop. Returns the tick in which it was parked, or -1. */
static int run_healthy(rig *r, int ticks)
{
    for (int t = 0; t < ticks; t++) {
        if (t % 97 == 96)
            jump(r);
        tick(r);
        if (is_parked(r))
            return t;
    }
    return -1;
}

static int ticks_to_park(rig *r)
{
    int t = 0;
    while (!is_parked(r) && t <= LATEST) {
        tick(r);
        t++;
    }
    return t;
}

/* A scene without a damper; its plants differ from the model by up to `scatter` in each entry. */
typedef struct quasi_static {
    const char *scene, *changes;
    double scatter;
    bool is_hard; /* whether the loop diverges on a plant of three times the gain */
} quasi_static;

static void try_loop(const quasi_static *of, const char *function, const char *limits)
{
    static const double gain[] = {1, 0.8, 1.33}, lost[] = {-1, -0.5, 3};
    static rig r;
    char changes[400];
    int latest = 0;
    snprintf(changes, sizeof changes,
             "target.free=%s;limits.voltage=%s;simulate={ticks: 10};safety={};%s", function, limits,
             of->changes);
    open_rig(&r, of->scene[0] ? of->scene : path_of("measured.yaml"), changes);
    assert_false(r.parts.damper.is_used);
    for (int k = 0; k < 3; k++) {
        start(&r, gain[k], of->scatter);
        assert_int_equal(run_healthy(&r, FREE_TICKS / 3), -1);
    }
    for (int k = 0; k < (of->is_hard ? 3 : 2); k++) {
        start(&r, lost[k], of->scatter);
        const int ticks = ticks_to_park(&r);
        latest = ticks > latest ? ticks : latest;
    }
    print_message("%s, free %s, limits %s: %d ticks without an alarm, lost control: alarm after %d "
                  "ticks at most\n",
                  of->scene[0] ? of->scene : "measured", function, limits, FREE_TICKS / 3 * 3,
                  latest);
    assert_in_range(latest, 1, LATEST);
    close_rig(&r);
}

/*
 * Law: without a damper a healthy loop, on plants of 0.8 to 1.33 of the gain and 5 % wrong entries
 * of a measured matrix, is never parked, whatever it moves along free functions; reversed
 * amplifiers, also with half the response, and a loop that diverges are parked within 250 ticks.
 */
static void quasi_static_loops(void **state)
{
    static const quasi_static loops[] = {
        {"", "", 0.05, false},
        {"stack-mirror", "control={rate: 50};", 0, true},
    };
    static const char *const limits[] = {"[-60, 60]", "[0, 60]"};
    (void)state;
    for (size_t k = 0; k < sizeof loops / sizeof *loops; k++)
        for (int f = 0; f < FUNCTIONS; f++)
            for (int l = 0; l < 2; l++)
                try_loop(&loops[k], functions[f], limits[l]);
}

/* ---- a plant with vibration modes -------------------------------------------- */

/* Storm on a plant of this gain and these frequencies, with the supervisor. */
static storm_result run_storm(const storm_rig *rig, double gain, double frequency, double limit)
{
    const storm_plant plant = {
        .gain = gain, .frequency = frequency, .step_limit = limit, .seed = 5};
    char error[SCENE_ERROR];
    storm_result result;
    if (storm_run(rig, &plant, &result, error) < 0)
        fail_msg("%s", error);
    return result;
}

/*
 * Law: in a loop that damps vibration no storm in the box of the certificate raises an alarm, and
 * with reversed amplifiers a storm does.
 */
static void damped_loops(void **state)
{
    static const double gain[] = {1, 0.8, 0.8, 1.33, 1.33}, frequency[] = {1, 0.9, 1.1, 0.9, 1.1};
    (void)state;
    for (int f = 0; f < FUNCTIONS; f++) {
        static rig r;
        storm_rig storms;
        char changes[400];
        snprintf(changes, sizeof changes,
                 "kinematics=linear;simulate={ticks: 10, influence: undeformed};target.free=%s",
                 functions[f]);
        open_rig(&r, "plate-closed-loop", changes);
        assert_int_equal(storm_open(&storms, &r.run.analysis, NULL, r.run.error), 0);
        storm_use(&storms, r.parts.blocks.block, r.parts.blocks.count,
                  r.run.analysis.design.simulate.delay);
        assert_non_null(storms.supervision);
        storms.is_supervised = true;
        for (int i = 0; i < 10; i++)
            assert_false(
                run_storm(&storms, gain[i % 5], frequency[i % 5], i < 5 ? 1 : 0.25).is_stopped);
        assert_true(run_storm(&storms, -1, 1, 1).is_stopped);
        storm_close(&storms);
        close_rig(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(quasi_static_loops),
                                       cmocka_unit_test(damped_loops)};
    return cmocka_run_group_tests_name("free functions", tests, write_scene, remove_test_folder);
}
