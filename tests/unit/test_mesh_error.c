/* SPDX-License-Identifier: BSD-2-Clause */
/* Discretisation error from coarser meshes: laws of the estimate on sequences that are known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>
#include <float.h>
#include <math.h>
#include "../../host_tools/model/mesh_error.h"

/* Values limit + size h^order on meshes with h = 1, 2 and 4, the finest one first. */
static void sequence(double value[3], double limit, double size, double order)
{
    for (int level = 0; level < 3; level++)
        value[level] = limit + size * pow(2, order * level);
}

/* A sequence of second order is extrapolated exactly, from two meshes and from three. */
static void test_second_order_is_exact(void **state)
{
    (void)state;
    double value[3];
    sequence(value, 3, -0.125, 2);
    for (int meshes = 2; meshes <= 3; meshes++) {
        const mesh_estimate estimate = mesh_estimate_from(value, meshes);
        assert_true(fabs(estimate.extrapolated - 3) <= 8 * DBL_EPSILON * 3);
        assert_true(estimate.value == value[0]);
    }
    assert_true(fabs(mesh_estimate_from(value, 3).order - 2) < 64 * DBL_EPSILON);
    assert_true(isnan(mesh_estimate_from(value, 2).order));
}

/* The interval contains the limit of every sequence of one order, from 0.35 to 6, of either sign.
 */
static void test_limit_lies_inside(void **state)
{
    (void)state;
    for (double order = 0.35; order <= 6; order += 0.05)
        for (double size = -0.1; size <= 0.1; size += 0.2) {
            double value[3];
            sequence(value, 1, size, order);
            const mesh_estimate estimate = mesh_estimate_from(value, 3);
            const double rounding = 64 * DBL_EPSILON;
            assert_true(fabs(estimate.extrapolated - 1) <= estimate.uncertainty + rounding);
            assert_true(fabs(estimate.order - order) < 1e-9);
        }
}

/*
 * The interval is no wider than five times the error of the finest mesh where the order is 1 or
 * more: an estimate that says nothing would pass the test before.
 */
static void test_interval_is_useful(void **state)
{
    (void)state;
    for (double order = 1; order <= 2.3; order += 0.1) {
        double value[3];
        sequence(value, 1, 0.01, order);
        assert_true(mesh_estimate_from(value, 3).uncertainty <= 5 * 0.01);
    }
}

/*
 * Where the results turn round, because errors a h and -b h^2 of first and second order compete,
 * the interval contains the limit: with h = 1, 2, 4 the results turn for a between 3 b and 6 b.
 */
static void test_limit_after_turn(void **state)
{
    (void)state;
    for (double ratio = 3.05; ratio < 6; ratio += 0.05)
        for (double b = -0.01; b <= 0.01; b += 0.02) {
            const double a = ratio * b;
            const double value[3] = {1 + a - b, 1 + 2 * a - 4 * b, 1 + 4 * a - 16 * b};
            const mesh_estimate estimate = mesh_estimate_from(value, 3);
            assert_true(isnan(estimate.order));
            assert_true(fabs(estimate.extrapolated - 1) <= estimate.uncertainty + 64 * DBL_EPSILON);
        }
}

/* Values that oscillate, do not change, or diverge have no order and a finite, honest interval. */
static void test_no_convergence(void **state)
{
    (void)state;
    const double oscillating[3] = {1.0, 1.1, 0.9}, constant[3] = {2, 2, 2},
                 diverging[3] = {4, 2, 1};
    const mesh_estimate first = mesh_estimate_from(oscillating, 3);
    assert_true(isnan(first.order) && first.uncertainty >= 0.1 - DBL_EPSILON);
    const mesh_estimate second = mesh_estimate_from(constant, 3);
    assert_true(second.extrapolated == 2 && second.uncertainty < 1e-8 && isnan(second.order));
    const mesh_estimate third = mesh_estimate_from(diverging, 3);
    assert_true(isnan(third.order) && third.uncertainty >= 2 && isfinite(third.uncertainty));
}

/*
 * A result that does not depend on the mesh, as a reaction that equilibrium determines, differs by
 * rounding errors alone: the interval contains the exact result, and no order is observed.
 */
static void test_rounding(void **state)
{
    (void)state;
    for (int k = -8; k <= 8; k++) {
        const double value[3] = {100 * (1 + k * 1e-13), 100 * (1 - 3e-13), 100};
        for (int meshes = 2; meshes <= 3; meshes++) {
            const mesh_estimate estimate = mesh_estimate_from(value, meshes);
            assert_true(fabs(estimate.extrapolated - 100) <= estimate.uncertainty);
            assert_true(estimate.uncertainty < 1e-8 * 100 && isnan(estimate.order));
        }
    }
}

/* Name and number of the results on a coarser mesh in the test below. */
typedef struct other_results {
    const char *name;
    int count;
} other_results;

static int measure_other(const scene *scene, const void *context, mesh_values *values, char *error)
{
    const other_results *other = context;
    (void)scene;
    (void)error;
    for (int k = 0; k < other->count; k++)
        mesh_values_add(values, other->name, 1);
    return 0;
}

/* Results of a coarser mesh with other names, or another number of results, are not compared. */
static void test_other_results(void **state)
{
    (void)state;
    static const struct {
        other_results other;
        const char *says;
    } row[] = {{{"w", 1}, NULL},
               {{"v", 1}, "its result 1 is 'v' instead of 'w'"},
               {{"w", 2}, "it has 2 results instead of 1"}};
    char error[SCENE_ERROR];
    scene scene;
    if (scene_read(&scene, SCENE_FOLDER "/scordelis-lo.yaml", NULL, 0, error) < 0)
        fail_msg("%s", error);
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        mesh_values fine = {.count = 0};
        mesh_error result;
        mesh_values_add(&fine, "w", 1);
        const int status =
            mesh_error_make(&result, &scene, &fine, measure_other, &row[k].other, error);
        assert_int_equal(status, row[k].says ? -1 : 0);
        assert_true(!row[k].says || strstr(error, row[k].says));
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_second_order_is_exact), cmocka_unit_test(test_limit_lies_inside),
        cmocka_unit_test(test_interval_is_useful),    cmocka_unit_test(test_limit_after_turn),
        cmocka_unit_test(test_no_convergence),        cmocka_unit_test(test_rounding),
        cmocka_unit_test(test_other_results),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
