/*
 * Laws of the responses of a structure to electrodes of any outline.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/modes.h"
#include "../rigs/scene_assert.h"

#define OUTLINE_PLATE "tests/rigs/scenes/outline-plate.yaml"
#define DISC "tests/rigs/scenes/disc-mirror.yaml"
#define DISC_DRIVE "actuators=[{name: v, drives: [{patches: p}], applied: 10}];"

static void open_outlines(scene_run *r, const char *name, const char *before, const char *patches)
{
    char changes[4000];
    snprintf(changes, sizeof changes, "%s;patches=%s", before, patches);
    open_run(r, name, changes);
}

/* Free curvature of two plies with one Poisson's ratio, of which the upper one strains. */
static double bimetal(double lower, double upper, double modulus_ratio, double strain)
{
    const double m = upper / lower, n = modulus_ratio, square = (1 + m) * (1 + m);
    return 6 * strain * square /
           ((lower + upper) * (3 * square + (1 + m * n) * (m * m + 1 / (m * n))));
}

/* Displacement of the centre of the disc under an electrode of some outline. */
static double disc_response(const char *outline, int elements)
{
    scene_run r;
    char changes[700];
    snprintf(
        changes, sizeof changes,
        "mesh={disc: {radius: 25 mm, elements: %d}};patches=[{name: p, layer: piezo, outlines: "
        "[{%s}]}];" DISC_DRIVE,
        elements, outline);
    solve_run(&r, DISC, changes);
    const double value = fabs(scene_run_value(&r, 0));
    scene_run_close(&r);
    return value;
}

/*
 * Law: a clamped disc of two plies of one Poisson's ratio, driven inside the radius r, moves at its
 * centre by (1 + nu)/2 k r^2 ln(R/r), with k the free curvature, although no side of an element
 * follows the electrode. The error is within 2 % (8/n)^2 on n elements, and so within 1 % on 12,
 * for a circle and for a formula.
 */
static void test_circle(void **state)
{
    (void)state;
    const double curvature = bimetal(1e-3, 0.2e-3, 63.0 / 64, 190e-12 * 10 / 0.2e-3);
    for (int k = 0; k < 3; k++) {
        static const double radii[3] = {7.3e-3, 7.3e-3, 10.4e-3};
        const double radius = radii[k],
                     exact = 1.3 / 2 * curvature * radius * radius * log(25e-3 / radius);
        char outline[80];
        snprintf(outline, sizeof outline,
                 k == 1 ? "inside: %.4f^2 - x^2 - y^2" : "circle: {radius: %.4f}", radius);
        for (int elements = 6; elements <= 24; elements *= 2) {
            const double error = disc_response(outline, elements) / exact - 1;
            print_message("%s, %2d elements: %.3f %%\n", outline, elements, 100 * error);
            assert_true(fabs(error) < 0.02 * 64 / (elements * elements));
        }
    }
}

/*
 * Law: on a clamped disc a square electrode moves the centre by the same amount in whatever
 * direction it points; the differences between directions fall with the square of the elements.
 */
static void test_turned_square(void **state)
{
    (void)state;
    double spread[2];
    for (int fine = 0; fine < 2; fine++) {
        double least = HUGE_VAL, most = 0;
        for (int k = 0; k < 5; k++) {
            char outline[120];
            snprintf(outline, sizeof outline,
                     "grid: {from: [-7e-3, -7e-3], to: [7e-3, 7e-3], count: [1, 1], angle: %d}",
                     9 * k + 4);
            const double value = disc_response(outline, 8 << fine);
            least = fmin(least, value);
            most = fmax(most, value);
        }
        spread[fine] = most / least - 1;
    }
    print_message("turned square: %.2e and %.2e of the response\n", spread[0], spread[1]);
    assert_true(spread[0] < 1e-2 && spread[1] < spread[0] / 2.5);
}

/*
 * Law: the response of a clamped plate to a rotated square converges with the square of the
 * elements, as that to an electrode along the elements does.
 */
static void test_refinement(void **state)
{
    (void)state;
    double value[4];
    for (int k = 0; k < 4; k++) {
        scene_run r;
        char changes[200];
        snprintf(changes, sizeof changes,
                 "mesh.theta1.elements=%d;mesh.theta2.elements=%d;outputs=[{name: w, u3: middle, "
                 "at: {theta1: 0.4, theta2: 0.15}}]",
                 4 << k, 4 << k);
        open_outlines(&r, OUTLINE_PLATE, changes,
                      "[{name: up, layer: upper, outlines: [{grid: {from: [0.1, 0.05], to: [0.3, "
                      "0.25], count: [1, 1], angle: 27}}]}]");
        if (scene_run_solve(&r) < 0)
            fail_msg("%s", r.error);
        value[k] = scene_run_value(&r, 0);
        scene_run_close(&r);
    }
    const double step[3] = {value[1] / value[3] - 1, value[2] / value[3] - 1,
                            value[0] / value[3] - 1};
    print_message("rotated square on a plate: %.3f %.3f %.3f %% from 32 x 32\n", 100 * step[2],
                  100 * step[0], 100 * step[1]);
    assert_true(fabs(step[0]) < 0.01 && fabs(step[1]) < 0.003);
}

/*
 * Law: under nonlinear kinematics too, electrodes that divide an electrode act together as it does
 * alone.
 */
static void test_divided_electrode(void **state)
{
    (void)state;
    static const char *const part[2] = {
        "[{name: up, layer: upper, outlines: [{polygon: [[0.1, 0.05], [0.33, 0.05], [0.33, 0.24], "
        "[0.1, 0.24]]}]}]",
        "[{name: up, layer: upper, outlines: [{polygon: [[0.1, 0.05], [0.33, 0.05], [0.1, 0.24]]}, "
        "{polygon: [[0.33, 0.05], [0.33, 0.24], [0.1, 0.24]]}]}]"};
    scene_run r[2];
    for (int k = 0; k < 2; k++) {
        open_outlines(
            &r[k], OUTLINE_PLATE,
            "kinematics=nonlinear;equilibrium={tolerance: 1e-10};actuators.0.applied=4000",
            part[k]);
        if (scene_run_solve(&r[k]) < 0)
            fail_msg("%s", r[k].error);
    }
    double most = 0, gap = 0;
    for (int i = 0; i < r[0].analysis.design.mesh.free_dof; i++) {
        most = fmax(most, fabs(r[0].u[i]));
        gap = fmax(gap, fabs(r[0].u[i] - r[1].u[i]));
    }
    assert_true(gap < 1e-9 * most);
    scene_run_close(&r[0]);
    scene_run_close(&r[1]);
}

/*
 * Law: the charges of short-circuited electrodes that divide another one add up to its charge, and
 * its voltage as an open electrode follows from the charge that its own voltage brings back.
 */
static void test_sensor_charges(void **state)
{
    (void)state;
    static const char *const part[2] = {
        "[{name: up, layer: upper}, {name: low, layer: lower, outlines: [{polygon: [[0.03, 0.05], "
        "[0.33, 0.05], [0.33, 0.24], [0.03, 0.24]]}]}]",
        "[{name: up, layer: upper}, {name: low, layer: lower, outlines: [{polygon: [[0.03, 0.05], "
        "[0.33, 0.05], [0.03, 0.24]]}, {polygon: [[0.33, 0.05], [0.33, 0.24], [0.03, 0.24]]}]}]"};
    double charge[3], voltage = 0;
    for (int k = 0; k < 3; k++) {
        scene_run r;
        char change[200];
        snprintf(change, sizeof change,
                 "sensors=[{name: s, drives: [{patches: low}], circuit: %s}];outputs=[{name: a, "
                 "charge: s}, {name: b, voltage: s}]",
                 k == 2 ? "open" : "short");
        open_outlines(&r, OUTLINE_PLATE, change, part[k == 1]);
        if (scene_run_solve(&r) < 0)
            fail_msg("%s", r.error);
        charge[k] = 0;
        for (uint32_t i = 1; i < r.analysis.design.electrodes.count; i++)
            charge[k] += r.analysis.charge[i];
        if (k == 2)
            voltage = scene_run_value(&r, 1);
        scene_run_close(&r);
    }
    assert_near("divided charge", charge[1], charge[0], 1e-10);
    assert_true(fabs(charge[2]) < 1e-9 * fabs(charge[0]));
    assert_true(fabs(voltage) > 1);
}

/* ---- mirrors ---------------------------------------------------------- */

/*
 * Law: 37, 61 and 127 hexagons leave less and less of each of Noll's modes 4 to 15 without limits
 * on a clamped disc, in the mean by more than a half each time. The pattern turns into itself under
 * 60 degrees, and the mesh does not: the two modes of each pair that such a turn mixes keep the
 * same error within a thousandth of the mode.
 */
static void test_hexagon_mirrors(void **state)
{
    (void)state;
    static const struct {
        int rings, electrodes;
        double pitch;
    } row[3] = {{3, 37, 7.2e-3}, {4, 61, 6e-3}, {6, 127, 4.2e-3}};
    static const int pair[4][2] = {{1, 2}, {3, 4}, {8, 9}, {10, 11}};
    double sum[3] = {0, 0, 0}, error[3][12];
    for (int k = 0; k < 3; k++) {
        char changes[300];
        scene_run r;
        modes modes;
        const common_limits none = no_limits();
        snprintf(changes, sizeof changes,
                 "patches.0.outlines.0.hexagons={pitch: %g, rings: %d, gap: "
                 "0.2 mm}",
                 row[k].pitch, row[k].rings);
        open_run(&r, "disc-61-hexagons", changes);
        assert_int_equal(r.analysis.design.amplifiers, row[k].electrodes);
        if (analysis_influence(&r.analysis, r.error) < 0 ||
            modes_run(&modes, &r.analysis, &none, 1, r.error) < 0)
            fail_msg("%s", r.error);
        assert_int_equal(modes.count, 12);
        for (int i = 0; i < 12; i++) {
            error[k][i] = modes.mode[i].unconstrained_error;
            sum[k] += error[k][i] / 12;
        }
        print_message("%3d hexagons: %.3f %% of modes 4 to 15\n", row[k].electrodes, 100 * sum[k]);
        modes_free(&modes);
        scene_run_close(&r);
        for (int i = 0; i < 4; i++)
            assert_true(fabs(error[k][pair[i][0]] - error[k][pair[i][1]]) < 1e-3);
        for (int i = 0; i < 12 && k > 0; i++)
            assert_true(error[k][i] < error[k - 1][i]);
    }
    assert_true(sum[1] < sum[0] / 2 && sum[2] < sum[1] / 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_circle),         cmocka_unit_test(test_turned_square),
        cmocka_unit_test(test_refinement),     cmocka_unit_test(test_divided_electrode),
        cmocka_unit_test(test_sensor_charges), cmocka_unit_test(test_hexagon_mirrors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
