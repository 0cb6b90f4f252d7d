/*
 * Laws of surfaces fitted to points: linear functions exactly, smooth functions with fourth order,
 * derivatives of the fitted function, means of noise, refusals.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/plausible.h"
#include "../../host_tools/scene/bicubic.h"
#include "../rigs/scene_assert.h"

enum { MOST = 16384 };
static double point[MOST][3];
static const int by_itself[2] = {0, 0};

/* Uniform random number from 0 to 1. */
static double uniform(void)
{
    static uint32_t seed = 7;
    seed = seed * 1664525u + 1013904223u;
    return seed / 4294967296.0;
}

static double smooth(double x, double y)
{
    return sin(2 * x) * exp(y) + x * y * y;
}

static double linear(double x, double y)
{
    return 3 - 2 * x + 5 * y;
}

/* Fill `count` random points of the rectangle from (-1, 0) to (1, 1), its corners among them. */
static void scatter_points(int count, double (*height)(double, double), double noise)
{
    for (int i = 0; i < count; i++) {
        point[i][0] = i < 4 ? 2 * (i % 2) - 1 : 2 * uniform() - 1;
        point[i][1] = i < 4 ? i / 2 : uniform();
        point[i][2] = height(point[i][0], point[i][1]) + noise * (2 * uniform() - 1);
    }
}

/* Fit the points and return the largest error at random places inside. */
static double fit_error(int count, const int cells[2], double (*height)(double, double))
{
    bicubic function;
    double worst = 0;
    assert_int_equal(bicubic_fit(&function, (size_t)count, (const double(*)[3])point, cells), 0);
    for (int i = 0; i < 2000; i++) {
        const double x = 1.8 * uniform() - 0.9, y = 0.05 + 0.9 * uniform();
        worst = fmax(worst, fabs(bicubic_at(&function, x, y).value - height(x, y)));
    }
    bicubic_free(&function);
    return worst;
}

/*
 * Law: a linear function is reproduced from 3 points as from many: the penalty does not act on it.
 * With few points the equations are as badly conditioned as the penalty is small, 1e-6, and an
 * eigenvalue that falls with the fourth power of the cells across makes it smaller by 16^4.
 */
static void test_linear(void **state)
{
    static const int cells[2] = {16, 16};
    (void)state;
    for (int count = 4; count <= 4096; count *= 4) {
        scatter_points(count, linear, 0);
        assert_true(fit_error(count, by_itself, linear) < 1e6 * 65536 * 10 * DBL_EPSILON);
        assert_true(fit_error(count, cells, linear) < 1e6 * 65536 * 10 * DBL_EPSILON);
    }
}

/* Law: the error on a smooth function falls with the fourth power of the size of the cells. */
static void test_order(void **state)
{
    (void)state;
    double error[3];
    for (int k = 0; k < 3; k++) {
        const int cells[2] = {8 << k, 4 << k};
        scatter_points(MOST, smooth, 0);
        error[k] = fit_error(MOST, cells, smooth);
    }
    print_message("errors %.2e %.2e %.2e\n", error[0], error[1], error[2]);
    for (int k = 0; k < 2; k++)
        assert_true(log2(error[k] / error[k + 1]) > 3.5);
}

/* Law: the derivatives are those of the value, by differences: to the square of the step. */
static void test_derivatives(void **state)
{
    const double step = 1e-4;
    bicubic function;
    (void)state;
    scatter_points(1000, smooth, 0);
    assert_int_equal(bicubic_fit(&function, 1000, (const double(*)[3])point, by_itself), 0);
    for (int i = 0; i < 200; i++) {
        const double x = 2 * uniform() - 1, y = uniform();
        const bicubic_jet jet = bicubic_at(&function, x, y);
        bicubic_jet side[4];
        for (int k = 0; k < 4; k++)
            side[k] = bicubic_at(&function, x + (k < 2 ? step * (2 * k - 1) : 0),
                                 y + (k < 2 ? 0 : step * (2 * k - 5)));
        /* Third derivatives are below 20 and jump between cells. */
        assert_true(fabs((side[1].value - side[0].value) / (2 * step) - jet.first[0]) < 1e-6);
        assert_true(fabs((side[3].value - side[2].value) / (2 * step) - jet.first[1]) < 1e-6);
        assert_true(fabs((side[1].first[0] - side[0].first[0]) / (2 * step) - jet.second[0]) <
                    20 * step);
        assert_true(fabs((side[3].first[1] - side[2].first[1]) / (2 * step) - jet.second[1]) <
                    20 * step);
        assert_true(fabs((side[3].first[0] - side[2].first[0]) / (2 * step) - jet.second[2]) <
                    20 * step);
    }
    bicubic_free(&function);
}

/*
 * Law: the difference that is reported is the noise of the points, 1/sqrt(3) of its bound, when
 * there are far more points than coefficients, and the fit is better than the noise by the root of
 * their ratio: 16384 points, 11 x 7 coefficients.
 */
static void test_noise(void **state)
{
    static const int cells[2] = {8, 4};
    const double noise = 0.03;
    bicubic function;
    (void)state;
    scatter_points(MOST, linear, noise);
    assert_int_equal(bicubic_fit(&function, MOST, (const double(*)[3])point, cells), 0);
    assert_true(fabs(function.rms / (noise / sqrt(3)) - 1) < 0.02);
    assert_true(function.largest < 1.2 * noise);
    bicubic_free(&function);
    assert_true(fit_error(MOST, cells, linear) < 5 * noise / sqrt(3) * sqrt(11 * 7.0 / MOST));
}

/*
 * Law: points on a line, also with coordinates rounded to a thousandth, two points and one point
 * repeated are refused; nothing is left behind.
 */
static void test_refused(void **state)
{
    static const double line[4][3] = {{0, 0, 1}, {1, 2, 1}, {2, 4, 0}, {3, 6, 2}},
                        rounded[4][3] = {{0, 0, 1}, {1, 2.001, 1}, {2, 3.999, 0}, {3, 6, 2}},
                        strip[4][3] = {{0, 0, 1}, {1, 2.1, 1}, {2, 3.9, 0}, {3, 6, 2}},
                        same[3][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    bicubic function;
    (void)state;
    assert_int_equal(bicubic_fit(&function, 4, line, by_itself), -1);
    assert_null(function.coefficient);
    assert_int_equal(bicubic_fit(&function, 4, rounded, by_itself), -1);
    assert_int_equal(bicubic_fit(&function, 4, strip, by_itself), 0);
    bicubic_free(&function);
    assert_int_equal(bicubic_fit(&function, 2, line, by_itself), -1);
    assert_int_equal(bicubic_fit(&function, 3, same, by_itself), -1);
    assert_int_equal(bicubic_fit(&function, 0, line, by_itself), -1);
}

/* Law: places away from all points are known as such. */
static void test_known(void **state)
{
    static const int cells[2] = {16, 16};
    bicubic function;
    (void)state;
    for (int i = 0; i < 2000; i++) { /* points of a disc */
        const double radius = sqrt(uniform()), angle = 6.283185307179586 * uniform();
        point[i][0] = radius * cos(angle);
        point[i][1] = radius * sin(angle);
        point[i][2] = 1;
    }
    assert_int_equal(bicubic_fit(&function, 2000, (const double(*)[3])point, cells), 0);
    assert_true(bicubic_is_known(&function, 0, 0));
    assert_true(bicubic_is_known(&function, 0.7, 0.7));
    assert_false(bicubic_is_known(&function, 0.98, 0.98));
    bicubic_free(&function);
}

/* A scene whose surface is the points of `height` on a grid, or the formula of the same height. */
static const char *const of_formula =
    "surface={type: formula, z: '0.2*x^2 + 0.1*x*y'};mesh.theta1.from=-0.9;mesh.theta1.to=0.9;"
    "mesh.theta2.from=-0.9;mesh.theta2.to=0.9;supports=[{edge: theta1-, fix: clamped}];"
    "outputs=[{name: w, z: middle, at: {theta1: 0.9, theta2: 0.9}}];loads=[{line: theta1+, z: 1}]";

/*
 * Law: a quadratic surface given by points has the displacements of the formula: its bicubic spline
 * is exact but for the penalty, 1e-6, and the decimals of the points.
 */
static void test_scene(void **state)
{
    char changes[3600], list[3000] = "";
    scene_run run;
    double value[2];
    (void)state;
    for (int k = 0; k < 81; k++) {
        const double x = -1 + 0.25 * (k % 9), y = -1 + 0.25 * (k / 9);
        char one[64];
        snprintf(one, sizeof one, "%s[%g,%g,%.9g]", k ? "," : "", x, y, 0.2 * x * x + 0.1 * x * y);
        strcat(list, one);
    }
    for (int k = 0; k < 2; k++) {
        const char *rest = strchr(of_formula, ';');
        snprintf(changes, sizeof changes,
                 k ? "surface={type: points, cells: [4, 4], points: [%s]}%s" : "%.0s%s", list,
                 k ? rest : of_formula);
        if (scene_run_open(&run, "hyperbolic-paraboloid", changes) < 0 || scene_run_solve(&run) < 0)
            fail_msg("%s", run.error);
        value[k] = scene_run_value(&run, 0);
        scene_run_close(&run);
    }
    print_message("formula %.9g, points %.9g\n", value[0], value[1]);
    assert_true(fabs(value[1] / value[0] - 1) < 1e-5);
}

/* Measured influence matrix of a shipped example: nine columns, the first two named x and y. */
#define MATRIX "../../firmware_demo/examples/measured/mirror-matrix.csv"

/*
 * Law: an empty list of points, a coordinate in two columns and names of columns that a file does
 * not have are refused in one line.
 */
static void test_refused_points(void **state)
{
    static const refusal bad[] = {
        {"surface={type: points, points: []}", "the list of points is empty; write [[x, y, z]"},
        {"surface={type: points, points: [[0, 0, 1], [1, 1], [0, 1, 0]]}", "three coordinates"},
        {"surface={type: points, points: {file: " MATRIX ", "
         "columns: [x, y, z, q, z]}}",
         "columns 3 and 5 of the points are both named z"},
        {"surface={type: points, points: {file: " MATRIX ", "
         "columns: [x, y, z, a, b, c, d, e, f, g]}}",
         "'columns' names more columns than the 9 of"},
    };
    (void)state;
    assert_refused("hyperbolic-paraboloid", bad, sizeof bad / sizeof *bad);
}

/*
 * Law: a point as far from the fitted surface as the shell is thick is warned of: pairs of points
 * at one place, a distance above and below a plane, leave a surface at that distance from each.
 */
static void test_misfit(void **state)
{
    static const double distance[2] = {0.00101, 0.00099};
    (void)state;
    for (int k = 0; k < 2; k++) {
        char changes[1200] = "surface={type: points, cells: [1, 1], points: [";
        for (int i = 0; i < 8; i++) {
            char one[64];
            snprintf(one, sizeof one, "%s[%g, %g, %g]", i ? ", " : "", i & 1 ? 0.5 : -0.5,
                     i & 2 ? 0.5 : 0.0, i & 4 ? distance[k] : -distance[k]);
            strcat(changes, one);
        }
        strcat(changes, "]}");
        scene_run run;
        plausible warnings = {0};
        open_run(&run, "hyperbolic-paraboloid", changes);
        plausible_scene(&warnings, &run.scene);
        assert_int_equal(warnings.count, k == 0);
        if (k == 0) {
            assert_string_equal(warnings.warning[0].rule, "surface_points");
            assert_near("misfit in thicknesses", warnings.warning[0].value, 1.01, 1e-12);
        }
        scene_run_close(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_linear),      cmocka_unit_test(test_order),
        cmocka_unit_test(test_derivatives), cmocka_unit_test(test_noise),
        cmocka_unit_test(test_refused),     cmocka_unit_test(test_known),
        cmocka_unit_test(test_scene),       cmocka_unit_test(test_refused_points),
        cmocka_unit_test(test_misfit),
    };
    return cmocka_run_group_tests_name("bicubic", tests, NULL, NULL);
}
