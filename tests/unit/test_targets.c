/*
 * Targets of whole scenes: Zernike's modes of a mirror, a shell brought back into shape, plates
 * bent by their layup.
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
#include "../../host_tools/model/modes.h"
#include "../../host_tools/mesh/mesh_shown.h"
#include "../rigs/scene_assert.h"

enum { MODES = 14 };

static void influence_run(scene_run *r, const char *name, const char *changes)
{
    open_run(r, name, changes);
    if (analysis_influence(&r->analysis, r->error) < 0)
        fail_msg("%s", r->error);
}

static void optimum(scene_run *r, common_limits limit, voltages *result)
{
    if (voltages_optimum(&r->analysis, limit, result, r->error) < 0)
        fail_msg("%s", r->error);
}

/* ---- words ------------------------------------------------------------ */

/* Value of one of Zernike's polynomials by the scene's own words. */
static double zernike(int j, double rho, double phi)
{
    char text[64];
    int column;
    const char *why;
    const expr_point at = {0, 0, 0, rho, phi};
    snprintf(text, sizeof text, "zernike(%d, theta1, theta2)", j);
    expr *expression = expr_compile(text, &column, &why);
    assert_non_null(expression);
    const double value = expr_value(expression, &at);
    expr_free(expression);
    return value;
}

/* Law: Zernike's polynomials are orthonormal over the unit disc, in whatever order they are
 * counted. */
static void test_orthonormal(void **state)
{
    (void)state;
    static const double x[6] = {-0.9324695142031521, -0.6612093864662645, -0.2386191860831969,
                                0.2386191860831969,  0.6612093864662645,  0.9324695142031521};
    static const double w[6] = {0.1713244923791704, 0.3607615730481386, 0.4679139345726910,
                                0.4679139345726910, 0.3607615730481386, 0.1713244923791704};
    for (int i = 1; i <= 21; i++)
        for (int j = 1; j <= i; j++) {
            double sum = 0;
            for (int g = 0; g < 6; g++)
                for (int k = 0; k < 12; k++) {
                    const double rho = sqrt((1 + x[g]) / 2),
                                 phi = 0.1 + k * 3.14159265358979324 / 6; /* d(rho^2) dphi / 2 pi */
                    sum += w[g] / 2 / 12 * zernike(i, rho, phi) * zernike(j, rho, phi);
                }
            assert_true(fabs(sum - (i == j)) < 1e-12);
        }
}

/* Law: a rectangle of the mesh takes the nodes in it, its edges among them; a line has no width. */
static void test_region(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, PLATE,
             "mesh.theta2={from: 0, to: 0.04, elements: 4};outputs=[{name: a, x: mean, at: "
             "{theta1: [0.02, 0.06], theta2: [0, 0.01]}}, "
             "{name: b, u3: mean, at: {theta2: [0.03, 0.03]}}, {name: c, u1: mean, at: {theta1: "
             "[-1, 1]}}]");
    assert_int_equal(analysis_outputs(&r.analysis, 0), 3 * 2);
    assert_int_equal(analysis_outputs(&r.analysis, 1), 4);
    assert_int_equal(analysis_outputs(&r.analysis, 2), 4 * 5);
    scene_run_close(&r);
}

/* ---- mirror ----------------------------------------------------------- */

/* Law: a mode in the table is the target asked for alone, and the target itself is what it was. */
static void test_modes(void **state)
{
    (void)state;
    scene_run r, alone;
    modes modes;
    voltages result;
    const common_limits limit[2] = {within(20), scene_limits_alone()};
    influence_run(&r, "mirror", "mesh.theta1.elements=10;mesh.theta2.elements=16");
    const double first = r.analysis.design.target[7];
    assert_int_equal(modes_run(&modes, &r.analysis, limit, 2, r.error), 0);
    assert_true(modes.count == MODES && modes.limits == 2 && r.analysis.design.target[7] == first);
    influence_run(&alone, "mirror",
                  "mesh.theta1.elements=10;mesh.theta2.elements=16;target.modes=[];"
                  "target.value=0.2e-6*zernike(9, theta1/31.8e-3, theta2)");
    for (int l = 0; l < 2; l++) {
        const mode_left *left = &modes.left[7 * 2 + l];
        optimum(&alone, limit[l], &result);
        assert_true(result.error == left->optimum && result.active_limits == left->active_limits &&
                    result.limit[1] == left->limit[1]);
        assert_true(left->limit[1] == (l ? 50 : 20));
        voltages_free(&result);
    }
    optimum(&alone, no_limits(), &result);
    assert_true(result.error == modes.mode[7].unconstrained_error);
    voltages_free(&result);
    modes_free(&modes);
    scene_run_close(&alone);
    scene_run_close(&r);
}

/*
 * Law: within limits is worse than without and better than clipping; turned by a quarter or an
 * eighth of a turn the mirror is itself, and so the two modes of one order and one azimuthal number
 * are alike. And what the mirror reaches.
 */
static void test_mirror(void **state)
{
    (void)state;
    static const int alike[6] = {0, 3, 5, 7, 10, 12}; /* Z2 Z5 Z7 Z9 Z12 Z14, each with the next */
    const common_limits own = scene_limits_alone();
    scene_run r;
    modes modes;
    double clipped = 0;
    influence_run(&r, "mirror", "");
    assert_int_equal(modes_run(&modes, &r.analysis, &own, 1, r.error), 0);
    for (int k = 0; k < MODES; k++) {
        assert_true(modes.mode[k].unconstrained_error <= modes.left[k].optimum * (1 + 1e-9) &&
                    modes.left[k].optimum <= modes.left[k].regularised * (1 + 1e-12) &&
                    modes.left[k].regularised <= modes.left[k].clipped);
        assert_true(modes.mode[k].unconstrained_error < 0.04 && modes.left[k].optimum < 0.16);
        assert_true((modes.left[k].active_limits > 0) == (modes.mode[k].largest_voltage > 50));
        clipped = fmax(clipped, modes.left[k].clipped / modes.left[k].optimum);
    }
    for (int i = 0; i < 6; i++) {
        const int k = alike[i];
        assert_near("no limits", modes.mode[k + 1].unconstrained_error,
                    modes.mode[k].unconstrained_error, 1e-6);
        assert_near("within limits", modes.left[k + 1].optimum, modes.left[k].optimum, 1e-6);
        assert_near("clipped", modes.left[k + 1].clipped, modes.left[k].clipped, 1e-6);
    }
    assert_true(clipped > 50); /* coma: 1 % at best, 85 % clipped */
    modes_free(&modes);
    scene_run_close(&r);
}

/* ---- a shell brought back --------------------------------------------- */

/* Law: the volts found on the nonlinear shell bring A to D back within 5 % of where the forces took
 * them, limits or not. */
static void test_hyperboloid(void **state)
{
    (void)state;
    static const double limit[2] = {HUGE_VAL, 1960};
    scene_run r;
    voltages result;
    double away[4], none[2] = {0, 0};
    influence_run(&r, "hyperboloid-patches", "");
    assert_int_equal(voltages_given(&r.analysis, "none", none, &result, r.error), 0);
    scene_run_observe(&r, result.displacement);
    for (int k = 0; k < 4; k++)
        away[k] = scene_run_value(&r, k);
    voltages_free(&result);
    for (int l = 0; l < 2; l++) {
        optimum(&r, within(limit[l]), &result);
        scene_run_observe(&r, result.displacement);
        for (int k = 0; k < 4; k++)
            assert_true(fabs(away[k]) > 2.5 && fabs(scene_run_value(&r, k)) < 0.05 * fabs(away[k]));
        assert_true(result.relinearised > 1 && result.residual < 1e-6);
        for (int k = 0; k < 2; k++)
            assert_true(fabs(result.voltage[k]) <= limit[l]);
        voltages_free(&result);
    }
    assert_int_equal(voltages_linear(&r.analysis, within(1960), &result, r.error), 0);
    scene_run_observe(&r, result.displacement);
    assert_true(fabs(scene_run_value(&r, 0)) > 0.15 * away[0]); /* the linear model does not know
                                                                   the way */
    voltages_free(&result);
    scene_run_close(&r);
}

/* ---- plates bent by their layup --------------------------------------- */

/*
 * Law: opposite fields above and below bend a plate of plies along and across it without twist;
 * plies turned by +30 degrees twist it, those turned by -30 degrees the other way, by the same.
 */
static void test_twist(void **state)
{
    (void)state;
    static const char *const turned[3] = {
        "layers.1.angle=30;layers.2.angle=30;layers.5.angle=30;layers.6.angle=30",
        "layers.1.angle=-30;layers.2.angle=-30;layers.5.angle=-30;layers.6.angle=-30",
        "layers.1.angle=90;layers.2.angle=90;layers.5.angle=90;layers.6.angle=90"};
    double twist[3], bend[3];
    for (int i = 0; i < 3; i++) {
        scene_run r;
        solve_run(&r, "crawley-lazarus", turned[i]);
        twist[i] = scene_run_value(&r, 5) - scene_run_value(&r, 3);
        bend[i] = scene_run_value(&r, 4);
        scene_run_close(&r);
    }
    assert_true(fabs(twist[0]) > 0.1 * fabs(bend[0]));
    assert_near("twist", twist[1], -twist[0], 1e-8);
    assert_near("bending", bend[1], bend[0], 1e-8);
    assert_true(fabs(twist[2]) < 1e-9 * fabs(bend[2]));
}

/* ---- rows that cannot move, free functions ---------------------------- */

static double largest_difference(const double *x, const double *y, int count)
{
    double most = 0;
    for (int i = 0; i < count; i++)
        most = fmax(most, fabs(x[i] - y[i]));
    return most;
}

/*
 * Law: what is wanted of rows on constrained dof changes neither voltages nor error by one bit.
 * Counted, 11 such rows that miss by s, where |wanted| is w and |misfit| is e w: sqrt((e^2 w^2 + 11
 * s^2) / (w^2 + 11 s^2)).
 */
static void test_fixed_rows(void **state)
{
    (void)state;
    scene_run plain, moved;
    voltages a, b;
    influence_run(&plain, "plate-50-patches", "");
    influence_run(&moved, "plate-50-patches",
                  "target.value=0.1*x*(y-0.1)+max(0, 1e-3-x)"); /* nodes are 0.02 apart */
    const design *design = &plain.analysis.design;
    assert_true(design->fixed_rows == 11 && design->targets == 121);
    for (int i = 0; i < design->targets; i++)
        assert_true((design->mesh.theta[design->target_node[i]][0] < 1e-9) ==
                    (design->weight[i] == 0));
    optimum(&plain, within(200), &a);
    optimum(&moved, within(200), &b);
    assert_true(memcmp(a.voltage, b.voltage, 25 * sizeof *a.voltage) == 0 && a.error == b.error);
    assert_true(a.fixed_off == 0 && a.error_all == a.error && b.fixed_off == 11);
    const double squares = design_squares(design, design->wanted, NULL), fixed = 11 * 1e-6;
    assert_near("counted", b.error_all,
                sqrt((a.error * a.error * squares + fixed) / (squares + fixed)), 1e-13);
    voltages_free(&a);
    voltages_free(&b);
    scene_run_close(&plain);
    scene_run_close(&moved);
    open_run(&moved, "plate-50-patches", "target.at={theta1: [0, 0]}");
    assert_int_equal(analysis_influence(&moved.analysis, moved.error), -1);
    assert_non_null(strstr(moved.error, "all 11 target rows lie on constrained dof"));
    scene_run_close(&moved);
}

#define FREE ";target.free=[piston, tip, tilt, x^2]"

/*
 * Law: a combination of the free functions added to the target changes neither voltages nor error,
 * to rounding of the target through the condition of the voltage optimisation problem; the misfit
 * is orthogonal to each of them under the weights.
 */
static void free_changes_nothing(const char *scene, const char *changes, const char *offset,
                                 double size)
{
    char with_offset[512];
    scene_run r[2];
    voltages result[2];
    snprintf(with_offset, sizeof with_offset, "%s%s", changes, offset);
    for (int k = 0; k < 2; k++) {
        influence_run(&r[k], scene, k ? with_offset : changes);
        optimum(&r[k], within(size), &result[k]);
    }
    const design *design = &r[1].analysis.design;
    assert_true(largest_difference(result[0].voltage, result[1].voltage, result[0].amplifiers) <
                1e-9 * size);
    assert_near("error", result[1].error, result[0].error, 1e-11);
    for (int j = 0; j < 4; j++) {
        double dot = 0, of_misfit = 0, of_free = 0;
        for (int i = 0; i < design->targets; i++) {
            const expr_point at = mesh_place(&design->mesh, design->target_node[i]);
            const double f[4] = {1, at.x, at.y, at.x * at.x},
                         miss = result[1].shape[i] - result[1].aligned_target[i],
                         w = design->weight[i];
            dot += w * w * f[j] * miss;
            of_misfit += pow(w * miss, 2);
            of_free += pow(w * f[j], 2);
        }
        assert_true(fabs(dot) < 1e-12 * sqrt(of_misfit * of_free));
    }
    for (int k = 0; k < 2; k++) {
        voltages_free(&result[k]);
        scene_run_close(&r[k]);
    }
}

static void test_free_functions(void **state)
{
    (void)state;
    free_changes_nothing("plate-50-patches", "target.value=0.1*x*(y-0.1)" FREE,
                         ";target.value=0.1*x*(y-0.1)+2e-3-0.03*x+0.02*y+0.1*x^2", 200);
    free_changes_nothing("plate-50-patches",
                         "target.value=0.1*x*(y-0.1);target.weight=area" FREE
                         ";loads=[{face: outer, pressure: 5}]",
                         ";target.value=0.1*x*(y-0.1)+2e-3-0.03*x+0.02*y+0.1*x^2", 200);
    free_changes_nothing(
        "mirror",
        /* two elements a patch: with one, voltages of alternating sign in a ring have no effect */
        "mesh.theta1.elements=10;mesh.theta2.elements=32;target.modes=[];"
        "target.value=0.2e-6*zernike(7, theta1/31.8e-3, theta2)" FREE,
        ";target.value=0.2e-6*zernike(7, theta1/31.8e-3, theta2)+1e-6+2e-5*x-3e-5*y+1e-3*x^2", 50);
}

/*
 * Law: the same on a nonlinear structure, where the voltages are those of the last relinearisation.
 */
static void test_free_nonlinear(void **state)
{
    (void)state;
    static const char small[] = "kinematics=nonlinear;mesh.theta1.elements=5;mesh.theta2.elements="
                                "5;target.free=[piston, tip]";
    scene_run r[2];
    voltages result[2];
    for (int k = 0; k < 2; k++) {
        influence_run(&r[k], "plate-50-patches",
                      k ? with(small, ";target.value=0.1*x*(y-0.1)+1e-3-0.02*x") : small);
        r[k].analysis.is_nonlinear = true;
        optimum(&r[k], within(200), &result[k]);
    }
    assert_true(largest_difference(result[0].voltage, result[1].voltage, result[0].amplifiers) <
                1e-6 * 200);
    assert_near("error", result[1].error, result[0].error, 1e-8);
    for (int k = 0; k < 2; k++) {
        voltages_free(&result[k]);
        scene_run_close(&r[k]);
    }
}

/*
 * Law: the device's tick with the tables of the control image needs no projection of its own:
 * wanted and measured shapes as they are, a free offset in each, give the optimum of `pzs shape`.
 */
static void test_free_tick(void **state)
{
    (void)state;
    scene_run r;
    voltages result;
    influence_run(&r, "plate-50-patches", "limits.voltage=[-200, 200]" FREE);
    optimum(&r, scene_limits_alone(), &result);
    const design *design = &r.analysis.design;
    const size_t m = (size_t)design->targets, bytes = PZS_CONTROL_BYTES(25, m),
                 inputs = design->structure.input.count;
    void *work = malloc(bytes);
    double *wanted = calloc(2 * m, sizeof *wanted), *measured = wanted + m;
    pzs_control control;
    assert_int_equal(pzs_control_init(&control, &design->problem, NULL, work, bytes), PZS_OK);
    for (int tick = 0; tick < 5; tick++) {
        for (size_t i = 0; i < m; i++) {
            const expr_point at = mesh_place(&design->mesh, design->target_node[i]);
            wanted[i] = 0.1 * at.x * (at.y - 0.1) + 1e-3 * at.x;
            measured[i] = 2e-3 - 0.1 * at.x * at.x;
            for (size_t k = 0; k < 25; k++)
                measured[i] += r.analysis.influence[i * inputs + k] * control.info.voltage[k];
        }
        assert_int_equal(pzs_tick(&control, wanted, measured), PZS_OK);
    }
    assert_true(largest_difference(control.info.voltage, result.voltage, 25) < 1e-8 * 200);
    voltages_free(&result);
    free(wanted);
    free(work);
    scene_run_close(&r);
}

/* Law: a target that is free altogether wants nothing. */
static void test_free_target(void **state)
{
    (void)state;
    scene_run r;
    voltages result;
    influence_run(&r, "plate-50-patches", "target.value=3e-3-0.7*x" FREE);
    optimum(&r, within(200), &result);
    for (int k = 0; k < 25; k++)
        assert_true(result.voltage[k] == 0);
    assert_true(result.error == 0);
    voltages_free(&result);
    scene_run_close(&r);
}

static void test_bad_free(void **state)
{
    (void)state;
    static const refusal bad[] = {{"target.free=piston", "list"},
                                  {"target.free=[pistn]", "unknown name"},
                                  {"target.free=[{a: 1}]", "unknown key 'a'"},
                                  {"target.free=[.nan]", "no number"},
                                  {"target.free=['']", "empty"}};
    static const char *const built[] = {"target.free=[piston, 2]", "target.free=[0]",
                                        "target.free=[tip, tilt, x+y]", "target.free=[1/(x-0.1)]"};
    assert_refused("plate-50-patches", bad, sizeof bad / sizeof *bad);
    for (int k = 0; k < 4; k++) {
        scene_run r;
        assert_int_equal(scene_run_open(&r, "plate-50-patches", built[k]), -1);
        assert_non_null(strstr(r.error, "free function"));
        scene_run_close(&r);
    }
}

/* ---- coordinates in texts ---- */

/*
 * Law: a coordinate of a node that should be 0 is shown as 0, on mesh lines that cross 0 and in a
 * mesh file whose writer has left its rounding errors; all others are shown as they are.
 */
static void test_shown(void **state)
{
    (void)state;
    static const char *const name[] = {"hex-mirror", "hyperboloid"};
    scene_run r;
    int zeros = 0;
    for (int i = 0; i < 2; i++) {
        open_run(&r, name[i], i ? "mesh.theta1={from: -0.3, to: 0.3, elements: 6}" : "");
        const mesh *mesh = &r.analysis.design.mesh;
        const mesh_size size = mesh_size_of(mesh);
        for (int k = 0; k < 3 * mesh->nodes; k++) {
            const double x = mesh->point[k / 3].position[k % 3],
                         shown = mesh_shown(x, size.position);
            const bool is_zero = fabs(x) < 1e-10 * size.position;
            assert_true(is_zero ? shown == 0 : shown == x);
            zeros += is_zero && x != 0;
        }
        scene_run_close(&r);
    }
    assert_true(zeros > 0);
    assert_true(mesh_shown(2.8e-17, 0.2) == 0 && mesh_shown(1e-12, 0.2) == 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shown),          cmocka_unit_test(test_orthonormal),
        cmocka_unit_test(test_region),         cmocka_unit_test(test_modes),
        cmocka_unit_test(test_mirror),         cmocka_unit_test(test_hyperboloid),
        cmocka_unit_test(test_twist),          cmocka_unit_test(test_fixed_rows),
        cmocka_unit_test(test_free_functions), cmocka_unit_test(test_free_nonlinear),
        cmocka_unit_test(test_free_tick),      cmocka_unit_test(test_free_target),
        cmocka_unit_test(test_bad_free),
    };
    return cmocka_run_group_tests_name("targets", tests, NULL, NULL);
}
