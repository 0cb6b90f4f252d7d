/*
 * Structural and piezoelectric cases with known answers, each a scene run as a user runs it.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/clipped.h"
#include "../rigs/scene_assert.h"
#include "../rigs/testdata.h"
#include "../../host_tools/model/voltages.h"

#ifndef DATA
#define DATA "tests/oracle/data"
#endif

/* Value of the first row of the scene's k-th output over its reference; n > 0 sets both numbers of
 * elements. */
static double ratio(const char *scene_name, const char *changes, int n, int k)
{
    char all[2048];
    scene_run r;
    snprintf(all, sizeof all, n > 0 ? "%s;mesh.theta1.elements=%d;mesh.theta2.elements=%d" : "%s",
             changes, n, n);
    solve_run(&r, scene_name, all);
    const double value = scene_run_value(&r, k) / r.scene.output[k].reference;
    scene_run_close(&r);
    return value;
}

/* ---- tables of ratios ------------------------------------------------- */

#define LOCAL_CURED                                                                                \
    "element={kinematics: local, tau: 0, rho: 0, metric: off, area: centre, quadratic: off}"

typedef struct row {
    const char *scene, *changes;
    int size[4];     /* elements a side */
    double ratio[4]; /* to the digits known */
    double digit;    /* half a unit of the last one */
} row;

static const row rows[] = {
    {"scordelis-lo", PUBLISHED, {4, 8, 16, 32}, {.8614, .9582, .9853, .9927}, 5e-5},
    {"scordelis-lo", LOCAL_CURED, {4, 8, 16, 32}, {.8614, .9582, .9853, .9927}, 5e-5},
    {"scordelis-lo", METRIC_OFF, {4, 8, 16}, {.9241, .9749, .9899}, 5e-5},
    {"pinched-cylinder", PUBLISHED, {4, 8, 16, 32}, {.8485, .9158, .9757, 1.0000}, 5e-5},
    {"pinched-cylinder", LOCAL_CURED, {4, 8, 16}, {.8989, .9449, .9878}, 5e-5},
    {"pinched-cylinder", METRIC_OFF, {4, 8, 16}, {.7029, .9161, .9845}, 5e-5},
    {"pinched-cylinder", IMPROVED, {4, 8, 16}, {.7024, .9155, .9839}, 5e-5},
    {"hemisphere-linear", PUBLISHED, {4, 8, 16, 32}, {.8764, .9591, .9899, 1.0012}, 5e-5},
    {"hemisphere-linear", LOCAL_CURED, {4, 8, 16}, {.8849, .9625, .9914}, 5e-5},
    {"hemisphere-linear", METRIC_OFF, {4, 8, 16}, {1.0329, 1.0040, 1.0027}, 5e-5},
    {"clamped-plate", PUBLISHED, {4, 8, 16}, {.941, .981, .996}, 5e-4},
    {"clamped-plate", LOCAL_CURED, {4, 8, 16}, {.9748, .9973, 1.0036}, 5e-5},
    {"clamped-plate", IMPROVED, {4, 8, 16}, {.9889, 1.0014, 1.0048}, 5e-5},
};

/* The plate's stiffness D changes with nu, its reference not: E keeps D at 1. */
#define NU_49 ";materials.plate={E: 12e6*(1-.49^2), nu: .49}"
#define NU_4999 ";materials.plate={E: 12e6*(1-.4999^2), nu: .4999}"

static const row locking[] = {
    {"clamped-plate", PUBLISHED NU_49, {4, 8, 16}, {.428, .705, .862}, 5e-4},
    {"clamped-plate", LOCAL_CURED NU_49, {4, 8, 16}, {.9784, .9992, 1.0052}, 5e-5},
    {"clamped-plate", IMPROVED NU_49, {4, 8, 16}, {.9952, 1.0042, 1.0066}, 5e-5},
    {"clamped-plate", PUBLISHED NU_4999, {4, 8, 16}, {.011, .036, .119}, 5e-4},
    {"clamped-plate", LOCAL_CURED NU_4999, {4, 8, 16}, {.9786, .9993, 1.0053}, 5e-5},
    {"clamped-plate", IMPROVED NU_4999, {4, 8, 16}, {.9957, 1.0044, 1.0067}, 5e-5},
};

static void check_rows(const row *table, size_t count)
{
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 4 && table[i].size[k]; k++) {
            const double got = ratio(table[i].scene, table[i].changes, table[i].size[k], 0);
            if (!(fabs(got - table[i].ratio[k]) < 1.02 * table[i].digit))
                fail_msg("%s %s, %d elements: %.5f, known %.4f", table[i].scene, table[i].changes,
                         table[i].size[k], got, table[i].ratio[k]);
        }
}

/* Law: linear shells converge as known, mesh by mesh, for the published element and the improved
 * one. */
static void test_linear_shells(void **state)
{
    (void)state;
    check_rows(rows, sizeof rows / sizeof *rows);
}

typedef struct error_row {
    const char *scene;
    double limit;      /* of fine meshes over the scene's reference */
    int size[4];       /* elements a side */
    double percent[4]; /* error against the limit, to .1 */
} error_row;

static const error_row errors[] = {
    {"scordelis-lo", .9960, {4, 8, 16}, {-7.2, -2.1, -.6}},
    {"pinched-cylinder", 1.0120, {4, 8, 16}, {-30.6, -9.5, -2.8}},
    {"hemisphere-linear", 1.0063, {4, 8}, {2.6, -.2}},
};

/*
 * Normal displacement of the middle of a ring in plane strain (nu = 0) under the pull cos 2 theta
 * on its outer face, from the stress function (a r^2 + b r^4 + c/r^2 + d) cos 2 theta of the theory
 * of elasticity. The four equations are that shear is 0 at both faces, and that the radial stress
 * is 1 at the outer face and 0 at the inner one.
 */
static double elastic_ring(double radius, double thickness, double modulus)
{
    double matrix[4][5] = {{0}};
    for (int row = 0; row < 4; row++) {
        const double r = 1 + (row / 2 ? -0.5 : 0.5) * thickness / radius;
        const double radial[4] = {-2, 0, -6 / pow(r, 4), -4 / (r * r)},
                     shear[4] = {2, 6 * r * r, -6 / pow(r, 4), -2 / (r * r)};
        memcpy(matrix[row], row % 2 ? shear : radial, sizeof radial);
        matrix[row][4] = row == 0;
    }
    for (int step = 0; step < 4; step++)
        for (int i = 0; i < 4; i++) {
            const double factor = matrix[i][step] / matrix[step][step];
            for (int k = 0; k < 5 && i != step; k++)
                matrix[i][k] -= factor * matrix[step][k];
        }
    double value = 0;
    const double displacement[4] = {-2, 0, 2, 4};
    for (int i = 0; i < 4; i++)
        value += displacement[i] * matrix[i][4] / matrix[i][i];
    return value * radius / modulus;
}

/*
 * Law: a thick ring under a pull cos 2 theta on its outer face is as soft as an elastic body, up to
 * a thirtieth of the square of thickness over radius. The scene's loads act on the area of the
 * middle surface.
 */
static void test_thick_rings(void **state)
{
    (void)state;
    for (int k = 1; k <= 3; k++) {
        const double thick = 0.1 * k, area = 1 + thick / 2;
        char changes[512];
        scene_run run;
        snprintf(changes, sizeof changes,
                 "kinematics=linear;element={preset: improved, shear: equilibrium};"
                 "mesh.theta1.elements=128;materials.steel={E: 1e3, nu: 0};"
                 "layers=[{material: steel, thickness: %g}];"
                 "loads=[{face: outer, pressure: %.17g*cos(2*theta1)}]",
                 100 * thick, area);
        solve_run(&run, "ring-follower", changes);
        const double exact = elastic_ring(100, 100 * thick, 1e3);
        for (int i = 0; i < 2; i++) {
            const double error = fabs(scene_run_value(&run, i) / exact) - 1;
            print_message("ring of thickness %g radii: %.5f too soft\n", thick, error);
            assert_true(fabs(error) < thick * thick / 30);
        }
        scene_run_close(&run);
    }
}

/*
 * Law: with linear kinematics a thick ring moves alike whether the squared height is averaged over
 * the plies or left out of products of displacements, because the part that the curvature of the
 * undeformed ring causes is the same. The part amounts to 0.7 % and 6 % of the displacement.
 */
static void test_squares_of_rings(void **state)
{
    (void)state;
    static const char *const option[] = {"on", "omitted"};
    for (int thickness = 10; thickness <= 30; thickness += 20) {
        double value[2][2];
        for (int k = 0; k < 2; k++) {
            char changes[300];
            scene_run run;
            snprintf(changes, sizeof changes,
                     "kinematics=linear;element={preset: improved, quadratic: %s};"
                     "layers.0.thickness=%d",
                     option[k], thickness);
            solve_run(&run, "ring-follower", changes);
            for (int i = 0; i < 2; i++)
                value[k][i] = scene_run_value(&run, i);
            scene_run_close(&run);
        }
        for (int i = 0; i < 2; i++)
            assert_true(fabs(value[1][i] / value[0][i] - 1) < 1e-9);
    }
}

/* Law: the improved element has the errors that a second program, in numpy, has on these shells. */
static void test_linear_errors(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof errors / sizeof *errors; i++)
        for (int k = 0; k < 4 && errors[i].size[k]; k++) {
            const double got =
                ratio(errors[i].scene, IMPROVED, errors[i].size[k], 0) / errors[i].limit;
            const double percent = 100 * (got - 1), known = errors[i].percent[k];
            if (!(fabs(percent - known) <= .05))
                fail_msg("%s, %d elements: %.2f %%, known %.1f", errors[i].scene, errors[i].size[k],
                         percent, known);
        }
}

/* ---- slender beams and plates --------------------------------------------- */

#define SLENDER "tests/rigs/scenes/thin.yaml"

/* Mean of the first two outputs of the scene SLENDER after changes. */
static double slender(const char *changes)
{
    scene_run r;
    solve_run(&r, SLENDER, changes);
    const double mean = (scene_run_value(&r, 0) + scene_run_value(&r, 1)) / 2;
    scene_run_close(&r);
    return mean;
}

static void assert_percent(const char *what, double value, double reference, double percent)
{
    const double error = 100 * (value / reference - 1);
    print_message("%s: %.2f %%\n", what, error);
    if (!(fabs(error - percent) <= .05))
        fail_msg("%s: %.2f %%, known %.1f", what, error, percent);
}

/* MacNeal's quarter circle of a bar 0.2 wide and 0.1 thick, six elements along it. */
#define CURVED_BEAM                                                                                \
    "surface={type: polar};materials.m={E: 1e7, nu: 0.25};layers.0.thickness=0.1;"                 \
    "mesh={theta1: {from: 4.12, to: 4.32, elements: 1}, "                                          \
    "theta2: {from: 0, to: pi/2, elements: 6}};"                                                   \
    "supports=[{edge: theta2-, fix: clamped}];loads=[{line: theta2+, u3: 5}];"                     \
    "outputs=[{name: a, u3: middle, at: {theta1: 4.12, theta2: pi/2}}, "                           \
    "{name: b, u3: middle, at: {theta1: 4.32, theta2: pi/2}}];"

/* A quarter of MacNeal's clamped plate of 2 x 10, h/a = 5e-5, under a force 4e-4 at its centre. */
#define LONG_PLATE                                                                                 \
    "surface={type: plate};materials.m={E: 1.7472e7, nu: 0.3};layers.0.thickness=1e-4;"            \
    "mesh={theta1: {from: 0, to: 1, elements: %d}, theta2: {from: 0, to: 5, elements: %d}};"       \
    "supports=[{edge: theta1-, fix: symmetric}, {edge: theta2-, fix: symmetric}, "                 \
    "{edge: theta1+, fix: clamped}, {edge: theta2+, fix: clamped}];"                               \
    "loads=[{point: {theta1: 0, theta2: 0}, u3: 1e-4}];"                                           \
    "outputs=[{name: a, u3: middle, at: {theta1: 0, theta2: 0}}, "                                 \
    "{name: b, u3: middle, at: {theta1: 0, theta2: 0}}];"

/*
 * Law: long elements and very thin plates bend as the second program says: MacNeal's curved beam
 * out of its plane against 0.5022, his long plate against Timoshenko's 0.00722 P a^2/D with D
 * = 1.6e-6, a = 2, P = 4e-4.
 */
static void test_slender_errors(void **state)
{
    (void)state;
    static const double percent[2] = {-9.1, -2.1};
    assert_percent("curved beam", slender(CURVED_BEAM), .5022, -3.9);
    for (int k = 0; k < 2; k++) {
        char changes[1024];
        snprintf(changes, sizeof changes, LONG_PLATE, 4 << k, 4 << k);
        assert_percent("long plate", slender(changes), 7.22, percent[k]);
    }
}

/* Law: near nu = 1/2 the published element locks as known, the improved one does not. */
static void test_volumetric_locking(void **state)
{
    (void)state;
    check_rows(locking, sizeof locking / sizeof *locking);
}

/* Law: without the seventh unknown the improved element gives the same answer. */
static void test_six_unknowns(void **state)
{
    (void)state;
    static const char *const scenes[] = {"scordelis-lo", "pinched-cylinder", "hemisphere-linear",
                                         "clamped-plate", "bimorph-actuator"};
    for (int i = 0; i < 5; i++) {
        const int n = i < 4 ? 8 : 0;
        assert_true(fabs(ratio(scenes[i], IMPROVED "dof_per_node=6", n, 0) /
                             ratio(scenes[i], IMPROVED, n, 0) -
                         1) < 1e-7);
    }
}

/* ---- three-dimensional references ------------------------------------- */

typedef struct limit_row {
    const char *scene, *changes;
    double exact, ratio, digit;
} limit_row;

#define GRAPHITE(h) "{material: graphite/epoxy, thickness: " h ", angle: "
#define CROSS(h) ";layers=[" GRAPHITE(h) "0}, " GRAPHITE(h) "90}, " GRAPHITE(h) "0}]"

/* Exact mid-surface deflections computed by a 3-D propagator; the ratios are limits of fine meshes.
 */
static const limit_row limits[] = {
    {"vlasov-plate", ";layers.0.thickness=1/4", 2.3443125, 1.0404, 5e-5},
    {"vlasov-plate", ";layers.0.thickness=1/10", 29.424744, 1.0073, 5e-5},
    {"vlasov-plate", ";layers.0.thickness=1/20", 227.01255, 1.0019, 5e-5},
    {"vlasov-plate", ";layers.0.thickness=1/50", 3510.2796, 1.0003, 5e-5},
    {"crossply", CROSS("1/12"), 1.2837827, .797, 5e-4},
    {"crossply", CROSS("1/30"), 7.5303004, .842, 5e-4},
    {"crossply", CROSS("1/60"), 41.311061, .935, 5e-4},
    {"crossply", CROSS("1/150"), 556.38914, .9875, 5e-5},
    {"crossply", CROSS("1/300"), 4347.2197, .9968, 5e-5},
    {"varadan-cylinder", ";layers=[" GRAPHITE("0.02") "90}]", 269.233635, 1.0058, 5e-5},
    {"varadan-cylinder", ";layers=[" GRAPHITE("0.01") "90}, " GRAPHITE("0.01") "0}]", 1065.87006,
     1.0059, 5e-5},
    {"varadan-cylinder", "", 274.766805, .9899, 5e-5},
    {"varadan-cylinder", ";loads.0.area=true;layers=[" GRAPHITE("0.02") "90}]", 269.233635, .9958,
     5e-5},
    {"varadan-cylinder", ";loads.0.area=true", 274.766805, .9800, 5e-5},
};

/* Limit of fine meshes from 16 and 32 elements a side, order h^2. */
static double fine_limit(const limit_row *l)
{
    double w[2];
    for (int i = 0; i < 2; i++) {
        char changes[512];
        snprintf(changes, sizeof changes, PUBLISHED "%s;outputs.0.reference=%.9g", l->changes,
                 l->exact);
        w[i] = ratio(l->scene, changes, 16 << i, 0);
    }
    return (4 * w[1] - w[0]) / 3;
}

/* Law: against three-dimensional elasticity the element is as far off as a seven-parameter shell
 * must be, no more. */
static void test_three_dimensional(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        const double got = fine_limit(&limits[i]);
        if (!(fabs(got - limits[i].ratio) < 1.1 * limits[i].digit))
            fail_msg("%s %s: %.5f, known %.4f", limits[i].scene, limits[i].changes, got,
                     limits[i].ratio);
    }
}

/* Law: a ring under uniform inner pressure expands alike on every mesh, for both elements. */
static void test_pressure_on_a_ring(void **state)
{
    (void)state;
    for (int e = 0; e < 2; e++) {
        const double coarse = ratio("tests/rigs/scenes/ring.yaml", elements[e], 4, 0),
                     fine = ratio("tests/rigs/scenes/ring.yaml", elements[e], 16, 0);
        assert_true(fabs(coarse / fine - 1) < 1e-4);
        assert_true(fabs(fine - 1) < 0.005);
    }
}

/* ---- patch tests ------------------------------------------------------ */

/* Rows of named output k against a function of the node's position. */
static double patch_error(const scene_run *r, int k, double (*exact)(double x, double y))
{
    const design *design = &r->analysis.design;
    double error = 0, largest = 0;
    for (int n = 0; n < design->mesh.nodes; n++) {
        const double *x = design->mesh.point[n].position, want = exact(x[0], x[1]);
        largest = fmax(largest, fabs(want));
        error = fmax(error, fabs(r->output[design->named_first[k] + n] - want));
    }
    return error / largest;
}

static double stretch_1(double x, double y)
{
    return 0.7 / (2 * 0.05) * x + 0 * y;
}
static double stretch_2(double x, double y)
{
    return -0.3 * 0.7 / (2 * 0.05) * y + 0 * x;
}

/* Moment 0.7 x 0.05 a length on I = h^3/12; curvature across by Poisson. */
static double bending(double x, double y)
{
    const double kappa = 0.7 * 0.05 * 12 / (2 * pow(0.05, 3));
    return -kappa * (x * x - 0.3 * y * y) / 2;
}

/* Law: constant membrane strain and constant curvature are exact on a mesh of unequal rectangles.
 */
static void test_patch(void **state)
{
    (void)state;
    for (int e = 0; e < 3; e++) {
        char changes[512];
        scene_run r;
        solve_run(&r, "tests/rigs/scenes/patch.yaml", elements[e]);
        assert_true(patch_error(&r, 0, stretch_1) < 1e-12);
        assert_true(patch_error(&r, 1, stretch_2) < 1e-12);
        scene_run_close(&r);
        snprintf(
            changes, sizeof changes,
            "%s;loads=[{line: theta1+, u1: 0.7, on: outer}, {line: theta1+, u1: -0.7, on: inner}, "
            "{line: theta1-, u1: -0.7, on: outer}, {line: theta1-, u1: 0.7, on: inner}];"
            "supports=[{at: {theta1: 0, theta2: 0}, fix: [u1 mean, u2 mean, u3 mean, u1 "
            "difference, u2 difference]}, "
            "{at: {theta1: 1.2, theta2: 0}, fix: [u2 mean]}]",
            elements[e]);
        solve_run(&r, "tests/rigs/scenes/patch.yaml", changes);
        assert_true(patch_error(&r, 2, bending) < 1e-12);
        scene_run_close(&r);
    }
}

/* ---- piezoelectric closed forms --------------------------------------- */

static double free_curvature(double x, double y)
{
    return 3 * 23e-12 * 2 / (4 * 0.5e-3 * 0.5e-3) * (x * x + y * y) / 2;
}

/* Law: a free bimorph takes the curvature 3 d31 V/(4 t^2) in both directions for any nu. */
static void test_free_bimorph(void **state)
{
    (void)state;
    static const char *const changes[] = {PUBLISHED, PUBLISHED "materials.piezo.nu=.45", IMPROVED,
                                          IMPROVED "materials.piezo.nu=.45",
                                          IMPROVED "dof_per_node=6"};
    for (int i = 0; i < 5; i++) {
        scene_run r;
        solve_run(&r, "tests/rigs/scenes/free-bimorph.yaml", changes[i]);
        assert_true(patch_error(&r, 0, free_curvature) < 1e-6);
        scene_run_close(&r);
    }
}

/* Law: the tip of a cantilever bimorph moves 3 d31 V L^2/(4 t^2) on any mesh. */
static void test_bimorph_tip(void **state)
{
    (void)state;
    static const char *const changes[] = {PUBLISHED "mesh.theta1.elements=1",
                                          PUBLISHED "mesh.theta1.elements=40", IMPROVED,
                                          IMPROVED "dof_per_node=6"};
    for (int i = 0; i < 4; i++)
        assert_true(fabs(ratio("bimorph-actuator", changes[i], 0, 0) - 1) < 1e-6);
}

static void shape_of(scene_run *r, const char *changes, voltages *result)
{
    char error[SCENE_ERROR] = "";
    solve_run(r, "bimorph-actuator", changes);
    if (analysis_influence(&r->analysis, error) < 0 ||
        voltages_optimum(&r->analysis, no_limits(), result, error) < 0)
        fail_msg("%s", error);
}

#define FIVE                                                                                       \
    ";mesh.theta1.elements=40;patches.low.grid=[5, 1];patches.up.grid=[5, "                        \
    "1];actuators.v.drives=[{patches: up, factor: 1}, {patches: low, factor: 1}]"

/* Law: a parabola of unit curvature asks the same voltage, 4 E t^2/(3 e31) across each layer's
 * half, of every electrode. */
static void test_equal_voltages(void **state)
{
    (void)state;
    scene_run r;
    voltages result;
    shape_of(&r, PUBLISHED FIVE ";target={u3: middle, at: nodes, value: x^2/2}", &result);
    assert_int_equal(r.analysis.design.amplifiers, 5);
    for (int k = 0; k < 5; k++)
        assert_true(fabs(2 * result.voltage[k] / 14492.7536231884 - 1) < 1e-6);
    assert_true(result.error < 1e-8);
    voltages_free(&result);
    scene_run_close(&r);
}

/*
 * Law: the volts against a tip force are the least squares of beam theory. The optimum is soft: the
 * last volt moves by 1 % between forty elements and the continuum, the residual shape by 1e-5 of
 * the deflection.
 */
static void test_tip_force(void **state)
{
    (void)state;
    static const double beam[5] = {-1615.4, -1186.3, -884.5, -512.3, -190.4};
    scene_run r;
    voltages result;
    shape_of(&r,
             PUBLISHED FIVE
             ";actuators.v.applied=0;target={u3: middle, at: nodes, value: 0, weight: area}"
             ";loads=[{point: {theta1: 0.1, theta2: 0}, u3: 0.5e-3}, {point: {theta1: 0.1, theta2: "
             "0.005}, u3: 0.5e-3}]",
             &result);
    for (int k = 0; k < 5; k++)
        assert_true(fabs(2 * result.voltage[k] / beam[k] - 1) < (k < 4 ? 1.2e-3 : 1e-2));
    assert_true(fabs(result.error - 0.00053) < 1e-5);
    voltages_free(&result);
    scene_run_close(&r);
}

/* ---- heat --------------------------------------------------------------- */

/* The voltages or temperatures that shape the target of a scene within its limits. */
static void shape_scene(scene_run *r, voltages *result, const char *scene, const char *changes)
{
    solve_run(r, scene, changes);
    if (analysis_influence(&r->analysis, r->error) < 0 ||
        voltages_optimum(&r->analysis, scene_limits_alone(), result, r->error) < 0)
        fail_msg("%s", r->error);
}

/*
 * Law: against a temperature that is linear through a free bimorph every voltage is
 * alpha T t/(3 d31), T the difference between the faces and t the thickness of a layer, and the
 * bimorph becomes flat. (In the published element the strain across the thickness cannot follow the
 * voltage of a single layer.)
 */
static void test_voltages_against_heat(void **state)
{
    (void)state;
    const double expected = 3.5e-6 * 20 * 0.5e-3 / (3 * 190e-12);
    for (int e = 1; e < 3; e++) {
        scene_run r;
        voltages result;
        shape_scene(&r, &result, "thermal-bimorph", elements[e]);
        for (int k = 0; k < 16; k++)
            assert_true(fabs(result.voltage[k] / expected - 1) < 1e-6);
        assert_true(result.error < 1e-9);
        voltages_free(&result);
        scene_run_close(&r);
    }
}

/*
 * Law: the temperature that bends a strip of two metals into a given curvature is that of
 * Timoshenko's formula; a limit below it binds.
 */
static void test_heater_bends_a_bimetal(void **state)
{
    (void)state;
    const double m = 1.5, n = 0.35, expansion = 11e-6, height = 1e-3, whole = (1 + m) * (1 + m);
    const double curvature =
        6 * expansion * whole / (height * (3 * whole + (1 + m * n) * (m * m + 1 / (m * n))));
    scene_run r;
    voltages result;
    shape_scene(&r, &result, "heated-bimetal", "");
    assert_true(fabs(result.voltage[0] * curvature / 0.5 - 1) < 1e-6);
    assert_true(result.error < 1e-6 && !result.at_limit[0]);
    voltages_free(&result);
    scene_run_close(&r);
    shape_scene(&r, &result, "heated-bimetal", "limits.voltage=[0, 20]");
    assert_true(result.voltage[0] == 20 && result.at_limit[0]);
    assert_true(strcmp(design_inputs_of(&r.analysis.design).name, "temperature") == 0 &&
                strcmp(design_unit(&r.analysis.design, 0), "K") == 0);
    assert_true(fabs(result.error - (1 - 20 * curvature / 0.5)) < 1e-6);
    voltages_free(&result);
    scene_run_close(&r);
}

/* ---- the plate with 25 pairs of patches ------------------------------- */

/* No voltage beyond its limit by even one bit; KKT to 1e-9; shape errors as known. */
static void check_plate(analysis *analysis, double limit, double shape_error, int active)
{
    char error[SCENE_ERROR] = "";
    voltages result;
    if (voltages_optimum(analysis, within(limit), &result, error) < 0)
        fail_msg("%s", error);
    for (int k = 0; k < 25; k++)
        assert_true(result.voltage[k] >= -limit && result.voltage[k] <= limit);
    if (!(fabs(result.error - shape_error) < 1e-5))
        fail_msg("limit %g: shape error %.6f, known %.5f", limit, result.error, shape_error);
    assert_int_equal(result.active_limits, active);
    assert_true(result.optimality <= 1e-9);
    voltages_free(&result);
}

/* Law: the bounded optimum of the plate is that of an independent program, with and without limits.
 */
static void test_plate_shapes(void **state)
{
    (void)state;
    scene_run r;
    voltages result;
    char error[SCENE_ERROR] = "";
    solve_run(&r, "plate-50-patches", "");
    assert_int_equal(analysis_influence(&r.analysis, error), 0);
    check_plate(&r.analysis, HUGE_VAL, .05538, 0);
    check_plate(&r.analysis, 500, .05560, 2);
    check_plate(&r.analysis, 200, .08975, 6);
    check_plate(&r.analysis, 100, .36114, 18);
    assert_int_equal(voltages_clipped(&r.analysis, within(200), &result, error), 0);
    assert_true(fabs(result.error - .520) < 5e-4);
    voltages_free(&result);
    assert_int_equal(
        voltages_given(&r.analysis, "published", r.scene.compare[0].value, &result, error), 0);
    assert_true(fabs(result.error - .0706) < 5e-5);
    voltages_free(&result);
    scene_run_close(&r);
}

/* Law: the volts themselves equal the witness's: least squares, damped, and within 200 V. */
static void test_plate_volts(void **state)
{
    (void)state;
    static const char *const key[3] = {"least_squares", "tikhonov", "box_200"};
    static const char *const changes[3] = {"", "limits.regularisation={relative: 1e-3}", ""};
    FILE *file = fopen(DATA "/table7.txt", "r");
    testdata t;
    assert_non_null(file);
    assert_int_equal(testdata_next(file, &t), 1);
    fclose(file);
    for (int i = 0; i < 3; i++) {
        scene_run r;
        voltages result;
        char error[SCENE_ERROR] = "";
        const double *known = testdata_values(&t, key[i]);
        solve_run(&r, "plate-50-patches", changes[i]);
        assert_int_equal(analysis_influence(&r.analysis, error), 0);
        assert_int_equal(
            voltages_optimum(&r.analysis, i == 2 ? within(200) : no_limits(), &result, error), 0);
        for (int k = 0; k < 25; k++) /* the witness's influence carries 1e-6, the weakest direction
                                        is 250 times softer */
            assert_true(fabs(result.voltage[k] - known[k]) < 250 * 1e-6 * 570);
        voltages_free(&result);
        scene_run_close(&r);
    }
    testdata_free(&t);
}

/* Law: a field against the poling is limited, one along it is not: +e3 poled, a positive voltage
 * opposes it. */
static void test_depolarisation(void **state)
{
    (void)state;
    for (int poling = -3; poling <= 3; poling += 6)
        for (int factor = -1; factor <= 1; factor += 2) {
            char changes[256], error[SCENE_ERROR] = "";
            scene_run r;
            snprintf(changes, sizeof changes,
                     "materials.G1195.field_limit=4e5;layers.upper.poling=%d;"
                     "actuators.v.drives=[{patches: up, factor: %d}]",
                     poling, factor);
            solve_run(&r, "plate-50-patches", changes);
            assert_int_equal(analysis_influence(&r.analysis, error), 0);
            const design *design = &r.analysis.design;
            const int against = poling * factor > 0; /* the positive voltage is the dangerous one */
            assert_true(fabs(design->upper[7] - (against ? 100 : 600)) < 1e-9);
            assert_true(fabs(design->lower[7] - (against ? -600 : -100)) < 1e-9);
            scene_run_close(&r);
        }
}

/* Limits of amplifier k under common limits, of the plate with these changes. */
static void limits_are(const char *changes, common_limits common, int k, double lower, double upper)
{
    double low[25], high[25];
    scene_run r;
    solve_run(&r, "plate-50-patches", changes);
    if (analysis_influence(&r.analysis, r.error) < 0 ||
        design_limits(&r.analysis.design, common, low, high, r.error) < 0)
        fail_msg("%s", r.error);
    if (low[k] != lower || high[k] != upper)
        fail_msg("%s: limits %g .. %g, should be %g .. %g", changes, low[k], high[k], lower, upper);
    scene_run_close(&r);
}

/*
 * Law: the limits of an amplifier are the intersection of the common ones, its own and those of the
 * field; common limits asked for replace those of the scene; a held amplifier keeps its voltage,
 * whatever is asked for.
 */
static void test_narrowest_limit(void **state)
{
    (void)state;
    static const char own[] = "limits.each=[{actuator: v_1_2, voltage: [-30, 700]}]";
    /* 100 V against the poling: of one patch of the pair at +V, of the other at -V */
    static const char field[] = "materials.G1195.field_limit=4e5";
    static const char hold[] = "limits.each=[{actuator: v_1_2, hold: 40}]";
    const common_limits scene = scene_limits_alone(), none = no_limits();
    const common_limits wide = {LIMITS_GIVEN, -60, 1000}, narrow = {LIMITS_GIVEN, -20, 10};
    limits_are("", scene, 1, -600, 600);
    limits_are("", wide, 1, -60, 1000);
    limits_are("", none, 1, -HUGE_VAL, HUGE_VAL);
    limits_are(own, scene, 1, -30, 700);
    limits_are(own, wide, 1, -30, 700);
    limits_are(own, narrow, 1, -20, 10);
    limits_are(own, wide, 2, -60, 1000);
    limits_are(own, none, 1, -HUGE_VAL, HUGE_VAL);
    limits_are(field, scene, 1, -4e5 * 0.25e-3, 4e5 * 0.25e-3);
    limits_are(field, wide, 1, -60, 4e5 * 0.25e-3);
    limits_are(field, narrow, 1, -20, 10);
    limits_are(hold, scene, 1, 40, 40);
    limits_are(hold, wide, 1, 40, 40);
    limits_are(hold, narrow, 1, 40, 40);
    limits_are(hold, none, 1, 40, 40);
    limits_are(hold, narrow, 0, -20, 10);
    limits_are(
        "limits.each=[{actuator: v, voltage: [0, 30]}, {actuator: v_1_2, voltage: [-5, 90]}]",
        scene, 1, 0, 30);
    limits_are(
        "limits.each=[{actuator: v_1_2, voltage: [-5, 90]}, {actuator: v, voltage: [0, 30]}]",
        scene, 1, 0, 30);
    limits_are("limits.each=[{actuator: v_1_2, hold: 40}, {actuator: v, voltage: [0, 90]}]", scene,
               1, 40, 40);
}

/* Law: items of limits.each for one amplifier that do not overlap are refused with its name. */
static void test_limits_of_one_apart(void **state)
{
    (void)state;
    scene_run r;
    solve_run(&r, "plate-50-patches",
              "limits.each=[{actuator: v_1_2, hold: 40}, {actuator: v, voltage: [0, 30]}]");
    assert_int_equal(analysis_influence(&r.analysis, r.error), -1);
    assert_non_null(strstr(r.error, "v_1_2 has no voltage left between 40 and 30: "
                                    "its items of limits.each do not overlap"));
    scene_run_close(&r);
}

/*
 * Law: a held electrode keeps its voltage in every set, to the bit, and no other leaves its own
 * limits.
 */
static void test_held_electrode(void **state)
{
    (void)state;
    const common_limits all[4] = {
        no_limits(), within(200), {LIMITS_GIVEN, -50, 300}, scene_limits_alone()};
    scene_run r;
    solve_run(&r, "plate-50-patches",
              "limits.each=[{actuator: v_1_1, hold: 0}, {actuator: v_1_5, voltage: [-80, 20]}]");
    assert_int_equal(analysis_influence(&r.analysis, r.error), 0);
    for (int i = 0; i < 4; i++) {
        voltages best, clipped;
        assert_int_equal(voltages_optimum(&r.analysis, all[i], &best, r.error), 0);
        assert_int_equal(voltages_clipped(&r.analysis, all[i], &clipped, r.error), 0);
        assert_true(best.voltage[0] == 0 && clipped.voltage[0] == 0);
        assert_true(best.held == 1 && best.narrowed == (i > 0));
        assert_true(i == 0 || (best.voltage[4] >= -80 && best.voltage[4] <= 20 &&
                               clipped.voltage[4] >= -80 && clipped.voltage[4] <= 20));
        assert_true(best.error <= clipped.error * (1 + 1e-12));
        assert_true(i == 3 || i == 0 || best.limit[1] == all[i].upper);
        voltages_free(&best);
        voltages_free(&clipped);
    }
    scene_run_close(&r);
}

/*
 * Law: limits that leave an amplifier no voltage are refused, and the message names the amplifier.
 */
static void test_no_voltage_left(void **state)
{
    (void)state;
    voltages result;
    scene_run r;
    solve_run(&r, "plate-50-patches", "limits.each=[{actuator: v_2_3, voltage: [-80, 20]}]");
    assert_int_equal(analysis_influence(&r.analysis, r.error), 0);
    assert_int_equal(
        voltages_optimum(&r.analysis, (common_limits){LIMITS_GIVEN, 30, 90}, &result, r.error), -1);
    assert_non_null(strstr(
        r.error, "v_2_3 has no voltage left between 30 and 20: the limits asked for, its own"));
    voltages_free(&result);
    scene_run_close(&r);
}

/* |B'W^2 (B v - wanted) + lambda s v| of amplifier j of the plate. */
static double gradient(const clipped *clipped, double lambda, const double *voltage, int j)
{
    const design *design = clipped->design;
    double sum = lambda * clipped->scale * voltage[j];
    for (int i = 0; i < design->targets; i++) {
        double miss = -design->wanted[i];
        for (int k = 0; k < 25; k++)
            miss += design->influence[i * 25 + k] * voltage[k];
        sum += design->weight[i] * design->weight[i] * design->influence[i * 25 + j] * miss;
    }
    return fabs(sum);
}

/*
 * Law: regularised least squares meet their normal equations in every amplifier that is not held,
 * held ones at their voltage; cut, no voltage leaves its limits, and those inside are the ones from
 * before.
 */
static void test_regularised_equations(void **state)
{
    (void)state;
    static const double lambda[4] = {0, 1e-6, 1e-3, 1};
    double lower[25], upper[25], open[25], cut[25], scale = 0;
    scene_run r;
    clipped clipped;
    solve_run(&r, "plate-50-patches", "");
    assert_int_equal(analysis_influence(&r.analysis, r.error), 0);
    const design *design = &r.analysis.design;
    const double nothing[25] = {0};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 25; k++) {
            lower[k] = -(upper[k] = HUGE_VAL);
            if (k == 7)
                lower[k] = upper[k] = 35;
        }
        assert_int_equal(clipped_open(&clipped, design, lower, upper, design->wanted), 0);
        assert_true(clipped_solve(&clipped, lambda[i], open));
        for (int k = 0; k < 25; k++)
            scale = fmax(scale, gradient(&clipped, 0, nothing, k));
        assert_true(open[7] == 35);
        for (int k = 0; k < 25; k++)
            assert_true(k == 7 || gradient(&clipped, lambda[i], open, k) < 1e-11 * scale);
        clipped_close(&clipped);
        for (int k = 0; k < 25; k++)
            if (k != 7)
                lower[k] = -(upper[k] = 90);
        assert_int_equal(clipped_open(&clipped, design, lower, upper, design->wanted), 0);
        assert_true(clipped_solve(&clipped, lambda[i], cut));
        for (int k = 0; k < 25; k++)
            assert_true(cut[k] == fmin(fmax(open[k], lower[k]), upper[k]));
        clipped_close(&clipped);
    }
    scene_run_close(&r);
}

/*
 * Law: the tuned parameter leaves no more error than any other of a fine grid, to the width of the
 * search, no less than the optimum within the limits, and where no limit matters the same. And the
 * numbers of the README.
 */
static void test_tuned(void **state)
{
    (void)state;
    static const double limit[4] = {100, 200, 500, 2000},
                        known[4] = {.48979, .15939, .05560, .05538};
    scene_run r;
    solve_run(&r, "plate-50-patches", "");
    assert_int_equal(analysis_influence(&r.analysis, r.error), 0);
    const design *design = &r.analysis.design;
    for (int i = 0; i < 4; i++) {
        voltages tuned, plain, best, other;
        double lower[25], upper[25], voltage[25];
        clipped clipped;
        assert_int_equal(voltages_regularised(&r.analysis, within(limit[i]), &tuned, r.error), 0);
        assert_int_equal(voltages_clipped(&r.analysis, within(limit[i]), &plain, r.error), 0);
        assert_int_equal(voltages_optimum(&r.analysis, within(limit[i]), &best, r.error), 0);
        assert_true(fabs(tuned.error - known[i]) < 1e-5);
        assert_true(tuned.error <= plain.error && tuned.error >= best.error * (1 - 1e-12));
        assert_int_equal(design_limits(design, within(limit[i]), lower, upper, r.error), 0);
        assert_int_equal(clipped_open(&clipped, design, lower, upper, design->wanted), 0);
        for (int k = -400; k <= 40; k++) {
            assert_true(clipped_solve(&clipped, pow(10, k / 40.0), voltage));
            assert_int_equal(voltages_given(&r.analysis, "other", voltage, &other, r.error), 0);
            assert_true(other.error >= tuned.error * (1 - 1e-4));
            voltages_free(&other);
        }
        clipped_close(&clipped);
        voltages_free(&tuned);
        voltages_free(&plain);
        voltages_free(&best);
    }
    scene_run_close(&r);
}

/*
 * Law: weights by area, of rows that can move and of others, have mean square 1 and follow the
 * nodes' shares on an uneven mesh.
 */
static void test_area_weights(void **state)
{
    (void)state;
    scene_run r;
    double sum = 0;
    solve_run(&r, "tests/rigs/scenes/free-bimorph.yaml",
              "mesh.theta1={points: [0, 0.03, 0.05, 0.1]};target={u3: mean, at: nodes, value: 0, "
              "weight: area}");
    const design *design = &r.analysis.design;
    for (int i = 0; i < design->targets; i++)
        sum += design->weight[i] * design->weight[i] +
               design->fixed_weight[i] * design->fixed_weight[i];
    assert_true(fabs(sum / design->targets - 1) < 1e-14);
    const double corner = 0.03 * 0.1 / 3 / 4, area = 0.01; /* first node, of a plate 0.1 x 0.1 */
    assert_true(fabs(pow(design->weight[0] + design->fixed_weight[0], 2) -
                     corner / area * design->targets) < 1e-13);
    scene_run_close(&r);
}

/* Law: what the loads do is taken off the target that the volts, here and on a device, have to
 * reach. */
static void test_target_under_load(void **state)
{
    (void)state;
    scene_run r;
    char error[SCENE_ERROR] = "";
    solve_run(&r, "plate-50-patches", "loads=[{face: outer, pressure: 5}]");
    assert_int_equal(analysis_influence(&r.analysis, error), 0);
    const design *design = &r.analysis.design;
    for (int i = 0; i < design->targets; i++)
        assert_true(fabs(design->wanted[i] - (design->target[i] - r.output[i])) < 1e-12 * 0.002);
    assert_true(fabs(r.output[design->targets - 1]) > 1e-6);
    scene_run_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_linear_shells),
        cmocka_unit_test(test_linear_errors),
        cmocka_unit_test(test_slender_errors),
        cmocka_unit_test(test_thick_rings),
        cmocka_unit_test(test_squares_of_rings),
        cmocka_unit_test(test_volumetric_locking),
        cmocka_unit_test(test_six_unknowns),
        cmocka_unit_test(test_three_dimensional),
        cmocka_unit_test(test_pressure_on_a_ring),
        cmocka_unit_test(test_patch),
        cmocka_unit_test(test_free_bimorph),
        cmocka_unit_test(test_bimorph_tip),
        cmocka_unit_test(test_equal_voltages),
        cmocka_unit_test(test_tip_force),
        cmocka_unit_test(test_voltages_against_heat),
        cmocka_unit_test(test_heater_bends_a_bimetal),
        cmocka_unit_test(test_plate_shapes),
        cmocka_unit_test(test_plate_volts),
        cmocka_unit_test(test_depolarisation),
        cmocka_unit_test(test_narrowest_limit),
        cmocka_unit_test(test_limits_of_one_apart),
        cmocka_unit_test(test_held_electrode),
        cmocka_unit_test(test_no_voltage_left),
        cmocka_unit_test(test_regularised_equations),
        cmocka_unit_test(test_tuned),
        cmocka_unit_test(test_area_weights),
        cmocka_unit_test(test_target_under_load),
    };
    return cmocka_run_group_tests_name("cases", tests, NULL, NULL);
}
