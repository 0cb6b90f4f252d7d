/* SPDX-License-Identifier: BSD-2-Clause */
/* Surfaces given by formulas: the same answers as the surfaces that they describe, and refusals. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <string.h>
#include "../../host_tools/scene/surface_formula.h"
#include "../rigs/scene_assert.h"

#define SADDLE "hyperbolic-paraboloid"

static double first_output(const char *scene, const char *changes)
{
    scene_run run;
    solve_run(&run, scene, changes);
    const double value = scene_run_value(&run, 0);
    scene_run_close(&run);
    return value;
}

/*
 * Law: along lines of curvature the general element equals that of line meshes. Solutions of the
 * same structure differ by rounding times its condition, 1e8 at most here.
 */
static void test_equal_surfaces(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *formula;
    } same[] = {
        {"clamped-plate", "surface={type: formula, z: 0}"},
        {"clamped-plate", "surface={type: formula, x: theta1, y: theta2, z: \"0*x\"}"},
        {"scordelis-lo",
         "surface={type: formula, x: theta1, y: 25*sin(theta2), z: 25*cos(theta2)}"},
    };
    for (size_t k = 0; k < sizeof same / sizeof *same; k++) {
        const double line = first_output(same[k].scene, IMPROVED);
        const double general = first_output(same[k].scene, with(IMPROVED, same[k].formula));
        assert_true(fabs(general / line - 1) < 1e8 * DBL_EPSILON);
    }
}

/* Law: position, normal, normal curvatures and area of a sphere. */
static void test_geometry_of_a_sphere(void **state)
{
    (void)state;
    int column;
    const char *why;
    scene_surface sphere;
    memset(&sphere, 0, sizeof sphere);
    sphere.type = SURFACE_FORMULA;
    static const char *const text[3] = {"2*sin(theta1)*cos(theta2)", "2*sin(theta1)*sin(theta2)",
                                        "2*cos(theta1)"};
    for (int i = 0; i < 3; i++) {
        sphere.formula[i] = expr_compile(text[i], &column, &why);
        assert_non_null(sphere.formula[i]);
    }
    const surface_point point = surface_at(&sphere, 0.7, 0.4);
    for (int i = 0; i < 3; i++)
        assert_true(fabs(point.triad[2][i] - point.position[i] / 2) < 8 * DBL_EPSILON);
    for (int a = 0; a < 2; a++)
        assert_true(fabs(point.curvature[a] - 0.5) < 16 * DBL_EPSILON);
    assert_true(fabs(point.lame[1] - 2 * sin(0.7)) < 8 * DBL_EPSILON);
    const double theta1[2] = {0.3, 1.2}, theta2[2] = {0.1, 0.9};
    const double area = 4 * (cos(0.3) - cos(1.2)) * 0.8;
    assert_true(fabs(surface_area(&sphere, theta1, theta2) / area - 1) < 1e-13);
    for (int i = 0; i < 3; i++)
        expr_free(sphere.formula[i]);
}

/*
 * The saddle of Bathe, Iosilevich and Chapelle, 6.3941 mm at thickness over length 1/1000: within
 * 2.5 % on 16 x 8 and 1.5 % on 32 x 16 elements.
 */
static void test_saddle(void **state)
{
    (void)state;
    const double coarse = first_output(SADDLE, "mesh.theta1.elements=16;mesh.theta2.elements=8");
    const double fine = first_output(SADDLE, "");
    assert_true(fabs(coarse / -6.3941e-3 - 1) < 0.025);
    assert_true(fabs(fine / -6.3941e-3 - 1) < 0.015);
}

/*
 * Law: the answer does not depend on the parameters that describe a surface. The saddle clamped
 * around, under uniform load: coordinate lines that are crowded and curved give the deflection of
 * the middle that straight ones give, within the error of the mesh.
 */
static void test_other_coordinates(void **state)
{
    (void)state;
#define CLAMPED                                                                                    \
    "supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: clamped}, {edge: theta2-, "     \
    "fix: clamped}, {edge: theta2+, fix: clamped}];outputs=[{name: m, z: middle, at: {theta1: 0, " \
    "theta2: 0}}];layers.0.thickness=0.01;mesh.theta1={from: -0.5, to: 0.5, elements: "            \
    "12};mesh.theta2={from: -0.5, to: 0.5, elements: 12};surface="
    const double lines = first_output(SADDLE, CLAMPED "{type: formula, z: x^2-y^2}");
    const double skewed = first_output(
        SADDLE, CLAMPED "{type: formula, x: theta1+0.2*sin(pi*theta1)*cos(pi*theta2)/pi, y: "
                        "theta2, z: (theta1+0.2*sin(pi*theta1)*cos(pi*theta2)/pi)^2-theta2^2}");
    assert_true(fabs(skewed / lines - 1) < 0.02);
}

/* Each refusal names its cause. */
static void test_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *changes, *says;
    } bad[] = {
        {"surface={type: formula, z: sqrt(x)}", "no finite position"},
        {"surface={type: formula, x: theta1+theta2, y: 0.1*theta2, z: 0}", "angle of 5.71 degrees"},
        {"surface={type: formula, x: 5, y: theta2, z: 0}", "no finite position"},
        {"surface={type: formula, x: theta1}", "'z' is missing"},
        {"surface={type: formula, z: 0, radius: 3}", "has no meaning"},
        {"surface={type: formula, z: zz}", "unknown name"},
        {"element=published", "published element"},
        {"surface={type: formula, x: theta1+0.5*theta2, y: theta2, z: 0}", "90 degrees"},
        {"layers.0.thickness=3", "centre of curvature"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        scene_run run;
        if (scene_run_open(&run, SADDLE, bad[k].changes) == 0)
            fail_msg("accepted: %s", bad[k].changes);
        if (!strstr(run.error, bad[k].says))
            fail_msg("%s: %s", bad[k].changes, run.error);
        scene_run_close(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equal_surfaces), cmocka_unit_test(test_geometry_of_a_sphere),
        cmocka_unit_test(test_saddle),         cmocka_unit_test(test_other_coordinates),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
