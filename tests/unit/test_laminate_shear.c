/*
 * Transverse shear stiffness of laminates from equilibrium.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/mesh/laminate_shear.h"
#include "../rigs/scene_run.h"
#include "../rigs/testdata.h"

static void isotropic(double young, double poisson, double c[6][6])
{
    const double shear = young / (2 * (1 + poisson));
    const double lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    memset(c, 0, 36 * sizeof(double));
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            c[i][j] = (i < 3 && j < 3 ? lame : 0) + (i == j) * (i < 3 ? 2 : 1) * shear;
}

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance * fabs(expected)))
        fail_msg("%.17g, expected %.17g", value, expected);
}

/*
 * Law: an isotropic plate has 5/6 G h, however it is cut into plies and wherever the reference
 * surface lies.
 */
static void test_isotropic(void **state)
{
    (void)state;
    double c[6][6], k[2][2];
    isotropic(2.1, 0.3, c);
    for (int offset = 0; offset < 3; offset++) {
        const double z = 0.4 * offset - 0.5;
        const shear_ply ply[3] = {{{z, z + 0.2}, (const double(*)[6])c},
                                  {{z + 0.2, z + 0.7}, (const double(*)[6])c},
                                  {{z + 0.7, z + 1}, (const double(*)[6])c}};
        assert_int_equal(laminate_shear(ply, 3, k), 0);
        assert_near(k[0][0], 5 / 6.0 * 2.1 / 2.6, 1e-12);
        assert_near(k[1][1], 5 / 6.0 * 2.1 / 2.6, 1e-12);
        assert_true(fabs(k[0][1]) < 1e-12);
    }
}

/*
 * Law: a sandwich whose faces are thin and stiff and whose core carries no bending has the shear
 * stiffness G_c d^2/c, with c the height of the core and d the distance of the faces' middles.
 */
static void test_thin_faces(void **state)
{
    (void)state;
    const double t = 1e-4, ratio = 1e9;
    double face[6][6], core[6][6], k[2][2];
    isotropic(1, 0.3, face);
    isotropic(1 / ratio, 0.3, core);
    const shear_ply ply[3] = {{{-0.5 - t, -0.5}, (const double(*)[6])face},
                              {{-0.5, 0.5}, (const double(*)[6])core},
                              {{0.5, 0.5 + t}, (const double(*)[6])face}};
    assert_int_equal(laminate_shear(ply, 3, k), 0);
    assert_near(k[0][0], (1 + t) * (1 + t) / (2.6 * ratio), 10 / (ratio * t));
}

/* Law: a laminate without stiffness is refused, and nothing is written. */
static void test_void(void **state)
{
    (void)state;
    double c[6][6] = {{0}}, k[2][2] = {{3, 3}, {3, 3}};
    const shear_ply ply = {{0, 1}, (const double(*)[6])c};
    assert_int_equal(laminate_shear(&ply, 1, k), -1);
    assert_int_equal(laminate_shear(&ply, 0, k), -1);
    assert_true(k[0][0] == 3 && k[1][1] == 3);
}

/* Displacement of a sandwich plate of n x n elements; shear "uniform" or "equilibrium". */
static double sandwich(double side, double ratio, const char *shear, int n)
{
    char changes[600];
    scene_run run;
    snprintf(changes, sizeof changes,
             "element={preset: improved, shear: %s};materials={face: {E: 1, nu: 0.3}, core: {E: "
             "%.17g, nu: 0.3}};layers=[{material: face, thickness: %.17g}, {material: core, "
             "thickness: %.17g}, {material: face, thickness: %.17g}];mesh.theta1.elements=%d;"
             "mesh.theta2.elements=%d",
             shear, 1 / ratio, 0.1 / side, 0.8 / side, 0.1 / side, n, n);
    if (scene_run_open(&run, "vlasov-plate", changes) < 0 || scene_run_solve(&run) < 0)
        fail_msg("%s", run.error);
    const double w = scene_run_value(&run, 0);
    scene_run_close(&run);
    return w;
}

/*
 * Law: with the shear from equilibrium a sandwich plate is that of three-dimensional elasticity,
 * from one material to a core of 1e-4 of the faces, as long as its faces do not bend by themselves
 * (the last row of the thick plate). A uniform shear strain is far too stiff for soft cores.
 */
static void test_sandwich(void **state)
{
    (void)state;
    static const double most[8] = {0.02, 0.02, 0.1, 1.5, 0.002, 0.002, 0.005, 0.05};
    FILE *file = fopen("tests/oracle/data/sandwich.txt", "r");
    testdata t;
    int row = 0;
    assert_non_null(file);
    for (; testdata_next(file, &t); row++) {
        const double side = testdata_values(&t, "side")[0], ratio = testdata_values(&t, "ratio")[0];
        const double exact = testdata_values(&t, "w")[0];
        double w[2];
        for (int k = 0; k < 2; k++) {
            const char *shear = k ? "equilibrium" : "uniform";
            w[k] = (4 * sandwich(side, ratio, shear, 16) - sandwich(side, ratio, shear, 8)) / 3;
        }
        print_message("side/height %2.0f, face/core %5.0f: uniform %.3f, equilibrium %.3f\n", side,
                      ratio, w[0] / exact, w[1] / exact);
        assert_true(row < 8 && fabs(w[1] / exact - 1) < most[row]);
        testdata_free(&t);
    }
    fclose(file);
    assert_int_equal(row, 8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_isotropic),
        cmocka_unit_test(test_thin_faces),
        cmocka_unit_test(test_void),
        cmocka_unit_test(test_sandwich),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
