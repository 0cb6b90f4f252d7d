/*
 * Rotations of the normal as outputs of a scene: closed forms, reciprocity with moments, prescribed
 * rotations, readings, refusals.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/scene_assert.h"

#define A_NODE "{theta1: 6.25, theta2: 20*pi/180}"
#define B_NODE "{theta1: 12.5, theta2: 30*pi/180}"
#define COUNT(list) (sizeof(list) / sizeof *(list))

/*
 * Law: under linear kinematics a bimorph strip that its voltage bends to the curvature k rotates by
 * -k x about y at x, and not about x. Poisson's ratio is 0, so that the elements have this
 * displacement exactly.
 */
static void test_bending(void **state)
{
    (void)state;
    scene_run r;
    solve_run(&r, "roll-up",
              "kinematics=linear;actuators.v.applied=4*0.05^2*(pi/10)/(3*1e-6);outputs=["
              "{name: y, rotation: y, at: nodes}, {name: u2, rotation: u2, at: nodes}, "
              "{name: x, rotation: x, at: nodes}]");
    const mesh *mesh = &r.analysis.design.mesh;
    assert_int_equal(analysis_outputs(&r.analysis, 0), mesh->nodes);
    for (int node = 0; node < mesh->nodes; node++) {
        const double want = -3.14159265358979323846 / 10 * mesh->theta[node][0];
        const int place = analysis_output_node(&r.analysis, 0, node);
        assert_int_equal(place, node);
        assert_near("about y", analysis_output(&r.analysis, 0, node, r.output), want, 1e-9);
        assert_near("about u2", analysis_output(&r.analysis, 1, node, r.output), want, 1e-9);
        assert_true(fabs(analysis_output(&r.analysis, 2, node, r.output)) < 1e-9);
    }
    scene_run_close(&r);
}

/*
 * Law (Maxwell): on a cylindrical roof the rotation at A about one axis under a unit moment at B
 * about another equals the rotation at B under the moment at A; a rotation is the work of a moment
 * over the moment.
 */
static void test_reciprocity(void **state)
{
    (void)state;
    static const char *const first[] = {"u1", "u2", "x", "y"}, *const second[] = {"u2", "u1", "z",
                                                                                  "x"};
    for (size_t i = 0; i < COUNT(first); i++) {
        double value[2];
        for (int turn = 0; turn < 2; turn++) {
            const char *const axis[2] = {turn ? second[i] : first[i], turn ? first[i] : second[i]};
            const char *const place[2] = {turn ? B_NODE : A_NODE, turn ? A_NODE : B_NODE};
            char changes[512];
            scene_run r;
            snprintf(changes, sizeof changes,
                     "loads=[{point: %s, about: %s, moment: 1}];outputs=[{name: r, rotation: %s, "
                     "at: %s}]",
                     place[1], axis[1], axis[0], place[0]);
            solve_run(&r, "scordelis-lo", changes);
            value[turn] = scene_run_value(&r, 0);
            scene_run_close(&r);
        }
        assert_true(value[0] != 0);
        assert_near("rotation", value[1], value[0], 1e-8);
    }
}

/*
 * Law: the rotation that a support prescribes at the end of a strip, under nonlinear kinematics, is
 * the output there, at any angle below 90 degrees; the unclamped strip between bends to a circle,
 * on which the rotation is linear in x.
 */
static void test_prescribed(void **state)
{
    (void)state;
    static const double angle[] = {-0.01, 0.7, -1.4};
    for (size_t i = 0; i < COUNT(angle); i++) {
        char changes[512];
        scene_run r;
        snprintf(changes, sizeof changes,
                 "loads=[];equilibrium={tolerance: 1e-9};supports=[{edge: theta1-, fix: clamped}, "
                 "{edge: theta1+, fix: rotation, about: y, value: %g}];outputs=[{name: end, "
                 "rotation: y, at: {theta1: 10, theta2: 0}}, {name: half, rotation: u2, at: "
                 "{theta1: 5, theta2: 0}}]",
                 angle[i]);
        solve_run(&r, "cantilever", changes);
        assert_near("end", scene_run_value(&r, 0), angle[i], 1e-9);
        assert_near("half", scene_run_value(&r, 1), angle[i] / 2, 1e-3);
        scene_run_close(&r);
    }
}

/* Law: an inclinometer is a reading of the estimator under linear kinematics, and refused else. */
static void test_readings(void **state)
{
    (void)state;
    static const char *const strip = "tests/rigs/scenes/gauge-strip.yaml",
                             *const slopes =
                                 "outputs.gauges={name: gauges, rotation: u2, at: nodes}";
    scene_run r;
    open_run(&r, strip, slopes);
    assert_true(design_reads_displacements(&r.analysis.design));
    scene_run_close(&r);
    assert_int_equal(scene_run_open(&r, strip, with(slopes, ";kinematics=nonlinear")), -1);
    assert_non_null(strstr(r.error, "'gauges' is a rotation, which is linear in the"));
    scene_run_close(&r);
}

static void test_refusals(void **state)
{
    (void)state;
    static const refusal bad[] = {
        {"outputs=[{name: a, rotation: u3, at: nodes}]", "'rotation: u3' is no"},
        {"outputs=[{name: a, rotation: u1}]", "no place in this item"},
        {"outputs=[{name: a, rotation: u1, x: middle, at: nodes}]", "an output is one quantity"},
        {"outputs=[{name: a, rotation: u1, angle: 3, at: nodes}]", "'angle' belongs to a strain"},
    };
    assert_refused("cantilever", bad, COUNT(bad));
    scene_run r;
    assert_int_equal(
        scene_run_open(&r, "cantilever", "outputs=[{name: a, rotation: z, at: nodes}]"), -1);
    assert_non_null(strstr(r.error, "'a' is normal to the shell at theta1 = 0"));
    scene_run_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bending),    cmocka_unit_test(test_reciprocity),
        cmocka_unit_test(test_prescribed), cmocka_unit_test(test_readings),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
