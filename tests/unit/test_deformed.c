/*
 * Laws of a structure linearised about the equilibrium at its target: modes, influence and offset,
 * and what they tell of a control loop.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/model/deformed.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/storm.h"
#include "../rigs/scene_run.h"

#define PANEL "tests/rigs/scenes/storm-panel.yaml"
#define STRONG "kinematics=nonlinear;limits={voltage: [-1000, 1000], step_limit: 60};"
#define COARSE                                                                                     \
    "mesh.theta1.elements=2;mesh.theta2.elements=2;patches.0.grid=[2, 2];patches.1.grid=[2, 2];"
#define TWO_THICKNESSES "target.value=70e-3*theta1^2*theta2;"

static void open_panel(scene_run *run, const char *changes)
{
    if (scene_run_open(run, PANEL, changes) < 0 ||
        analysis_influence(&run->analysis, run->error) < 0)
        fail_msg("%s", run->error);
}

static void open_deformed(deformed *at, const scene_run *run, int modes)
{
    char error[SCENE_ERROR];
    if (deformed_open(at, &run->analysis, modes, error) < 0)
        fail_msg("%s", error);
}

/*
 * Law: as the target goes to zero, the frequencies go to those of the reference state, and the
 * influence matrix to the linear one. The changes are of first order in the amplitude, at most a
 * few times the displacement over the thickness.
 */
static void test_small_target(void **state)
{
    scene_run run;
    deformed at;
    vibration reference;
    char error[SCENE_ERROR];
    (void)state;
    open_panel(&run, STRONG "target.value=1e-9*theta1^2*theta2;");
    open_deformed(&at, &run, 6);
    assert_int_equal(vibration_solve(&reference, &run.analysis.design, 6, MASS_LUMPED, error), 0);
    assert_true(at.amplitude > 0 && at.amplitude < 1e-6);
    for (int i = 0; i < 6; i++)
        assert_true(fabs(at.vibration.frequency[i] / reference.frequency[i] - 1) < 1e-6);
    const size_t inputs = run.analysis.design.structure.input.count;
    double largest = 0, most = 0;
    for (size_t i = 0; i < (size_t)run.analysis.design.targets * inputs; i++) {
        largest = fmax(largest, fabs(run.analysis.influence[i]));
        most = fmax(most, fabs(at.analysis.influence[i] - run.analysis.influence[i]));
    }
    assert_true(most < 1e-6 * largest);
    vibration_free(&reference);
    deformed_close(&at);
    scene_run_close(&run);
}

/*
 * Law: about a target of two thicknesses the static responses of all modes of the tangent, summed
 * over the mode shapes, are the influence matrix there; and the offset with the influence of the
 * voltages is the shape of the equilibrium, whose distance from the target is the optimum's.
 */
static void test_modes_sum_to_influence(void **state)
{
    scene_run run;
    deformed at;
    (void)state;
    open_panel(&run, STRONG COARSE TWO_THICKNESSES);
    const design *design = &run.analysis.design;
    open_deformed(&at, &run, design->mesh.free_dof);
    const size_t inputs = design->structure.input.count, modes = at.modal.modes;
    assert_int_equal(modes, design->mesh.free_dof);
    assert_true(at.amplitude > 0.5);
    double largest = 0, most = 0, change = 0;
    for (size_t i = 0; i < (size_t)design->targets; i++)
        for (size_t k = 0; k < (size_t)design->amplifiers; k++) {
            const double influence = at.analysis.influence[i * inputs + k];
            double sum = 0;
            for (size_t mode = 0; mode < modes; mode++)
                sum += at.modal.shape[i * modes + mode] *
                       at.modal.response[mode * at.modal.inputs + k];
            largest = fmax(largest, fabs(influence));
            most = fmax(most, fabs(sum - influence));
            change = fmax(change, fabs(influence - run.analysis.influence[i * inputs + k]));
        }
    print_message("    sum of modes to %.1e of the influence, which has changed by %.2f\n",
                  most / largest, change / largest);
    assert_true(most < 1e-9 * largest);
    assert_true(change > 0.02 * largest);
    deformed_close(&at);
    scene_run_close(&run);
}

/*
 * Law: a target beyond the limits, at whose optimum every voltage stays at its limit, so that the
 * method ends with a step that is taken back, has modes and an influence matrix like any other.
 */
static void test_target_beyond_limits(void **state)
{
    scene_run run;
    deformed at;
    (void)state;
    open_panel(&run, "kinematics=nonlinear;limits={voltage: [-2, 2], step_limit: 1};" COARSE
                     "target.value=7*theta1^2*theta2;");
    open_deformed(&at, &run, 6);
    assert_true(at.amplitude > 0 && at.vibration.frequency[0] > 0);
    const size_t inputs = run.analysis.design.structure.input.count;
    double largest = 0, change = 0;
    for (size_t i = 0; i < (size_t)run.analysis.design.targets * inputs; i++) {
        largest = fmax(largest, fabs(run.analysis.influence[i]));
        change = fmax(change, fabs(at.analysis.influence[i] - run.analysis.influence[i]));
    }
    /* The panel moves by a few per cent of its thickness, and its influence changes by as much. */
    assert_true(change > 0 && change < 5 * at.amplitude * largest);
    deformed_close(&at);
    scene_run_close(&run);
}

/*
 * Law: settings of the damped tick that assume readings one tick older than they are damp the panel
 * about its reference state, but not about a target of two thicknesses, at gain 1.33 and frequency
 * 0.9; the default settings damp both.
 */
static void test_settings_at_target(void **state)
{
    scene_run run;
    deformed at;
    storm_rig rig;
    char error[SCENE_ERROR];
    double growth[2][2];
    (void)state;
    open_panel(&run, STRONG TWO_THICKNESSES);
    certificate_make(&run.analysis.certificate, &run.analysis);
    open_deformed(&at, &run, 40);
    assert_int_equal(storm_open(&rig, &run.analysis, NULL, error), 0);
    for (int deform = 0; deform < 2; deform++) {
        assert_true(!deform || storm_deform(&rig, &at));
        for (int later = 0; later < 2; later++) {
            damper_options options = damper_options_of(&run.analysis);
            const estimator none = {0};
            damper damper;
            loop_blocks blocks;
            storm_result result;
            const storm_plant plant = {
                .gain = 1.33, .frequency = 0.9, .step_limit = HUGE_VAL, .seed = 1};
            options.delay += later;
            options.settings.later = later;
            assert_int_equal(damper_make(&damper, &run.analysis, NULL, &options, error), 0);
            loop_blocks_fill(&blocks, &run.analysis.design, &none, &damper);
            storm_use(&rig, blocks.block, blocks.count, options.delay - later);
            assert_int_equal(storm_growth(&rig, &plant, 1500, &result, error), 0);
            growth[deform][later] = result.growth;
            damper_close(&damper);
        }
    }
    print_message("    growth %.5f and %.5f, about the target %.5f and %.5f\n", growth[0][0],
                  growth[0][1], growth[1][0], growth[1][1]);
    assert_true(growth[0][0] < 0.999 && growth[0][1] < 0.999 && growth[1][0] < 0.999);
    assert_true(growth[1][1] > 0.9995);
    storm_close(&rig);
    deformed_close(&at);
    scene_run_close(&run);
}

/*
 * Law: the certificate states for the structure at its target what the storms show there: with the
 * chosen settings and readings one tick older every storm of its first sequence of targets settles,
 * or the certificate says that the loop does not tolerate them.
 */
static void test_older_readings_at_target(void **state)
{
    static const double gain[] = {1, 0.8, 0.8, 1.33, 1.33}, frequency[] = {1, 0.9, 1.1, 0.9, 1.1};
    scene_run run;
    deformed at;
    storm_rig rig;
    damper damper;
    loop_blocks blocks;
    char error[SCENE_ERROR];
    const estimator none = {0};
    int settled = 0;
    (void)state;
    open_panel(&run, STRONG COARSE TWO_THICKNESSES);
    certificate_make(&run.analysis.certificate, &run.analysis);
    if (certify_loop(&run.analysis, error) < 0)
        fail_msg("%s", error);
    const certificate_loop *loop = &run.analysis.certificate.loop;
    assert_true(loop->is_stable && loop->target.is_made);
    open_deformed(&at, &run, 40);
    assert_int_equal(storm_open(&rig, &run.analysis, NULL, error), 0);
    assert_true(storm_deform(&rig, &at));
    const damper_options options = damper_options_of(&run.analysis);
    assert_int_equal(damper_make(&damper, &run.analysis, NULL, &options, error), 0);
    loop_blocks_fill(&blocks, &run.analysis.design, &none, &damper);
    storm_use(&rig, blocks.block, blocks.count, options.delay - options.settings.later);
    for (int i = 0; i < 10; i++) {
        const storm_plant plant = {.gain = gain[i % 5],
                                   .frequency = frequency[i % 5],
                                   .step_limit = i < 5 ? 1 : 0.25,
                                   .more_delay = 1,
                                   .seed = 1,
                                   .is_uninformed = true};
        storm_result result;
        assert_int_equal(storm_run(&rig, &plant, &result, error), 0);
        settled += result.passed;
    }
    print_message("    %d of 10 storms settle with older readings; tolerated %d, undeformed %d\n",
                  settled, loop->target.older, loop->older);
    assert_int_equal(loop->target.older > 0, settled == 10);
    assert_int_equal(certificate_older(loop) > 0, loop->older > 0 && settled == 10);
    storm_close(&rig);
    damper_close(&damper);
    deformed_close(&at);
    scene_run_close(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_small_target), cmocka_unit_test(test_modes_sum_to_influence),
        cmocka_unit_test(test_target_beyond_limits), cmocka_unit_test(test_settings_at_target),
        cmocka_unit_test(test_older_readings_at_target)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
