/*
 * Heaters on patches: each warms the layer on which its patch lies. Laws, each on a scene run as a
 * user runs it.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/scene_assert.h"

#define HEATERS                                                                                    \
    "actuators=[{name: heat, temperature: patches, drives: [{patches: up}, {patches: low}], "      \
    "applied: 7}];"
#define UNIFORM "loads=[{temperature: 7}];"
#define BARE                                                                                       \
    "layers.1.bare=outer;sensors=[{name: s, drives: [{patches: low}]}];"                           \
    "outputs.0={name: phi, potential: upper, at: nodes};"

/*
 * Law: heaters of one temperature on all layers are a uniform temperature: displacements, voltages
 * of open electrodes, potentials of bare faces and charges are equal, linear and nonlinear.
 */
static void test_all_layers(void **state)
{
    (void)state;
    static const char *const variants[5] = {PUBLISHED, IMPROVED, IMPROVED "dof_per_node=6;",
                                            IMPROVED BARE, IMPROVED "kinematics=nonlinear;"};
    for (int k = 0; k < 5; k++) {
        scene_run heaters, uniform;
        char changes[2][1024];
        snprintf(changes[0], sizeof changes[0], "%s" HEATERS, variants[k]);
        snprintf(changes[1], sizeof changes[1], "%s" UNIFORM, variants[k]);
        solve_run(&heaters, PLATE, changes[0]);
        solve_run(&uniform, PLATE, changes[1]);
        for (int output = 0; output < 4; output++) {
            double size = 0;
            for (int i = 0; i < analysis_outputs(&uniform.analysis, output); i++)
                size =
                    fmax(size, fabs(analysis_output(&uniform.analysis, output, i, uniform.output)));
            assert_true(size > 0 || output == 0 || output == 3);
            for (int i = 0; i < analysis_outputs(&uniform.analysis, output); i++)
                assert_true(fabs(analysis_output(&heaters.analysis, output, i, heaters.output) -
                                 analysis_output(&uniform.analysis, output, i, uniform.output)) <
                            (output == 3 ? 1e-12 : 1e-8 * size + 1e-13));
        }
        scene_run_close(&heaters);
        scene_run_close(&uniform);
    }
}

/* Law: the strip of the scene bends by 3 alpha T/(2 t), and its stress is that of the free strain.
 */
static void test_bent_strip(void **state)
{
    (void)state;
    scene_run run;
    for (int e = 0; e < 3; e++) {
        solve_run(&run, "heated-patches",
                  with(elements[e],
                       "outputs.1={name: s, stress: 11, layer: lower, face: outer, at: "
                       "{theta1: 0.05, theta2: 0.01}}"));
        assert_near("end", scene_run_value(&run, 0), -3 * 23e-6 * 10 / (2 * 0.5e-3) * 0.005, 1e-8);
        assert_near("stress", scene_run_value(&run, 1), 70e9 * 23e-6 * 10, 1e-8);
        scene_run_close(&run);
    }
}

/*
 * Law: a heater of any outline acts on each element by the part that it covers: two halves of a
 * strip that a circle and the rest of it cover are together the whole strip.
 */
static void test_outlines(void **state)
{
    (void)state;
    scene_run run[2];
    static const char *const patches[2] = {
        "patches=[{name: up, layer: upper, outlines: ["
        "{grid: {count: [1, 1], from: [0, 0], to: [0.037, 0.02]}}, "
        "{grid: {count: [1, 1], from: [0.037, 0], to: [0.1, 0.02]}}]}];",
        "patches=[{name: up, layer: upper}];"};
    for (int k = 0; k < 2; k++) {
        char changes[1024];
        snprintf(
            changes, sizeof changes,
            "%sactuators=[{name: heat, temperature: patches, drives: [{patches: up}], applied: "
            "10}]",
            patches[k]);
        solve_run(&run[k], "heated-patches", changes);
    }
    assert_near("whole", scene_run_value(&run[0], 0), scene_run_value(&run[1], 0), 1e-9);
    scene_run_close(&run[0]);
    scene_run_close(&run[1]);
}

static void test_refusals(void **state)
{
    (void)state;
    static const refusal bad[] = {
        {"actuators.0={name: heat, temperature: uniform, drives: [{patches: up}]}",
         "write "
         "temperature: patches"},
        {"actuators.0={name: heat, temperature: patches}", "add drives"},
        {"actuators.0={name: v, drives: [{patches: up}]}", "no piezoelectric constants"},
        {"materials.aluminium.alpha=0", "a temperature moves nothing"},
        {"outputs.0={name: c, charge: heat}", "has no patches; voltages and charges"},
        {"actuators=[{name: a, temperature: patches, drives: [{patches: up}]}, {name: b, "
         "temperature: patches, drives: [{patches: up}]}]",
         "driven by 'a' already"},
    };
    assert_refused("heated-patches", bad, sizeof bad / sizeof *bad);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_layers),
        cmocka_unit_test(test_bent_strip),
        cmocka_unit_test(test_outlines),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
