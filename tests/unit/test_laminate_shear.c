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
#include "../../host_tools/mesh/invert.h"
#include "../../host_tools/mesh/laminate.h"
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

/* Order of classical lamination, 11 22 12 of forces before moments, in the strains of an element.
 */
static const int classical[6] = {0, 2, 6, 1, 3, 7};

/* Compliance of a flat element of area 1 without normal force: strains per resultants. */
static void plate_compliance(const scene_run *run, double compliance[6][6])
{
    const laminate *laminate = &run->analysis.design.mesh.laminate;
    const laminate_place place = {
        .present_plies = 7, .chord = {1, 1}, .area = 1, .bubble_share = 1};
    double packed[4][LAMINATE_PACKED], stiffness[LAMINATE_STRAINS][LAMINATE_STRAINS];
    assert_int_equal(laminate_modes(laminate, &run->scene.element, &place, packed), 0);
    for (int i = 0; i < LAMINATE_STRAINS; i++)
        for (int j = 0; j <= i; j++)
            stiffness[i][j] = stiffness[j][i] = packed[0][i * (i + 1) / 2 + j];
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            compliance[i][j] =
                stiffness[classical[i]][classical[j]] -
                stiffness[classical[i]][4] * stiffness[4][classical[j]] / stiffness[4][4];
    assert_int_equal(invert(&compliance[0][0], 6, 6), 0);
}

/*
 * Law: without a normal force a flat package is that of classical lamination, whatever Poisson's
 * ratios its plies have; a bimetal bends as Timoshenko's. With a thickness strain linear through
 * the package, as in the published element, it does not.
 */
static void test_plies_thicken_freely(void **state)
{
    (void)state;
    for (int is_published = 0; is_published < 2; is_published++) {
        double flex[6][6], own[6][6], off = 0, largest = 0;
        char changes[600];
        scene_run run;
        snprintf(changes, sizeof changes,
                 "element=%s;materials={a: {E: 63, nu: 0.31}, b: {E: 64, nu: 0.1}, c: {E1: 130, "
                 "E2: 9, E3: 11, G12: 4.8, G13: 4.4, G23: 3.2, nu12: 0.31, nu13: 0.02, nu23: "
                 "0.45}};layers=[{material: a, thickness: 0.02}, {material: c, thickness: 0.05, "
                 "angle: 30}, {material: b, thickness: 0.03}]",
                 is_published ? "published" : "improved");
        if (scene_run_open(&run, "vlasov-plate", changes) < 0)
            fail_msg("%s", run.error);
        const laminate *laminate = &run.analysis.design.mesh.laminate;
        shear_ply ply[3];
        for (int i = 0; i < 3; i++) {
            memcpy(ply[i].z, laminate->ply[i].z, sizeof ply[i].z);
            ply[i].c = laminate->ply[i].c;
        }
        assert_int_equal(laminate_flexure(ply, 3, flex), 0);
        plate_compliance(&run, own);
        for (int i = 0; i < 6; i++)
            for (int j = 0; j < 6; j++) {
                const double unit = pow(laminate->thickness, -(i / 3) - j / 3);
                off = fmax(off, fabs(own[i][j] * unit - flex[i][j]));
                largest = fmax(largest, fabs(flex[i][j]));
            }
        assert_true(is_published ? off > 1e-3 * largest : off <= 1e-12 * largest);
        scene_run_close(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_isotropic), cmocka_unit_test(test_thin_faces),
        cmocka_unit_test(test_void),      cmocka_unit_test(test_plies_thicken_freely),
        cmocka_unit_test(test_sandwich),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
