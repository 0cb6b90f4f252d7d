/*
 * Meshes of discs and of parts of spheres without a hole.
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
#include "../../host_tools/quads/vector.h"
#include "../../host_tools/quads/quad_disc.h"
#include "../rigs/quad_shell.h"
#include "../rigs/scene_run.h"

static const double pi = 3.141592653589793;

/* A disc as a shell of one layer. */
static void open_disc(quad_shell *shell, const quad_disc *disc, double thickness)
{
    static const double along[3] = {1, 0, 0};
    quad_shell_init(shell, thickness, 1, 0.3);
    quad_mesh_free(&shell->quads);
    assert_int_equal(quad_disc_make(&shell->quads, disc), 0);
    if (quad_shell_build(shell, along) < 0)
        fail_msg("%s", shell->error);
}

/* Law: every element belongs to one ring or sector, and the sectors of a ring are equal. */
static void test_sets(void **state)
{
    (void)state;
    const quad_disc disc = {
        .radius = 2, .ring = {0.7, 1.2}, .rings = 2, .elements = 6, .sectors = 8};
    quad_mesh mesh;
    assert_int_equal(quad_disc_make(&mesh, &disc), 0);
    int *sets_of = calloc(mesh.elements, sizeof *sets_of);
    assert_int_equal(mesh.element_sets, 1 + 2 * 8);
    for (size_t k = 0; k < mesh.element_sets; k++) {
        const quad_set *set = &mesh.element_set[k];
        assert_true(set->count > 0);
        assert_true(k < 1 || k % 8 == 1 || set->count == set[-1].count);
        for (size_t i = 0; i < set->count; i++)
            sets_of[set->index[i]]++;
    }
    for (size_t e = 0; e < mesh.elements; e++)
        assert_int_equal(sets_of[e], 1);
    const quad_set *rim = quad_set_find(mesh.edge_set, mesh.edge_sets, "rim"),
                   *centre = quad_set_find(mesh.node_set, mesh.node_sets, "centre");
    assert_int_equal(rim->count, 24);
    for (size_t i = 0; i < rim->count; i++)
        for (uint32_t end = 0; end < 2; end++) {
            const uint32_t edge = rim->index[i];
            const double *x = mesh.position[mesh.element[edge / 4][(edge + end) % 4]];
            assert_true(fabs(vector_length(x) - 2) < 1e-14);
        }
    assert_true(vector_length(mesh.position[centre->index[0]]) < 1e-15);
    free(sets_of);
    quad_mesh_free(&mesh);
}

/*
 * Law: the first sector of a ring begins at the x axis, so a quarter of four sectors lies where x
 * and y are positive.
 */
static void test_sectors(void **state)
{
    (void)state;
    const quad_disc disc = {.radius = 2, .ring = {0.7}, .rings = 1, .elements = 4, .sectors = 4};
    quad_mesh mesh;
    assert_int_equal(quad_disc_make(&mesh, &disc), 0);
    const quad_set *set = quad_set_find(mesh.element_set, mesh.element_sets, "ring2-1");
    for (size_t i = 0; i < set->count; i++)
        for (int r = 0; r < 4; r++) {
            const double *x = mesh.position[mesh.element[set->index[i]][r]];
            assert_true(x[0] > -1e-12 && x[1] > -1e-12 && vector_length(x) > 0.7 - 1e-12);
        }
    quad_mesh_free(&mesh);
}

/* A disc of radius 1, its area, and the unit normal of its surface at a point. */
typedef struct disc_shape {
    double sphere, focal;
} disc_shape;

static double exact_area(const disc_shape *shape)
{
    const double s = shape->sphere, f = shape->focal;
    if (s > 0)
        return 2 * pi * s * (s - sqrt(s * s - 1));
    return f > 0 ? 8 * pi * f * f / 3 * (pow(1 + 1 / (4 * f * f), 1.5) - 1) : pi;
}

static void exact_normal(const disc_shape *shape, const double x[3], double normal[3])
{
    const double s = shape->sphere, f = shape->focal;
    const double slope = f > 0 ? -1 / (2 * f) : s > 0;
    normal[0] = slope * x[0];
    normal[1] = slope * x[1];
    normal[2] = s > 0 ? x[2] + sqrt(s * s - 1) : 1;
    vector_normalise(normal);
}

static void check_directors(const quad_mesh *mesh, const disc_shape *shape)
{
    for (size_t n = 0; n < mesh->nodes; n++) {
        const double *x = mesh->position[n];
        double normal[3];
        exact_normal(shape, x, normal);
        for (int i = 0; i < 3; i++)
            assert_true(fabs(normal[i] - mesh->director[n][i]) < 1e-14);
        if (shape->focal > 0)
            assert_true(fabs(4 * shape->focal * x[2] - x[0] * x[0] - x[1] * x[1]) < 1e-14);
    }
}

/*
 * Law: the area of a disc, of a cap and of a paraboloid is exact up to the polygon of the rim,
 * whose error falls by four when the elements are halved; directors are normal to the surface;
 * nothing is refused or reported at a thickness of a thousandth of the radius.
 */
static void test_area(void **state)
{
    (void)state;
    static const disc_shape shape[3] = {{0, 0}, {1.5, 0}, {0, 0.6}};
    for (size_t k = 0; k < sizeof shape / sizeof *shape; k++) {
        double error[2];
        for (int fine = 0; fine < 2; fine++) {
            const quad_disc disc = {.radius = 1,
                                    .sphere = shape[k].sphere,
                                    .focal = shape[k].focal,
                                    .elements = 8 << fine,
                                    .sectors = 1};
            quad_shell shell;
            double area = 0;
            open_disc(&shell, &disc, 1e-3);
            for (int e = 0; e < shell.mesh.elements; e++)
                area += shell.mesh.place[shell.mesh.element_type[e]].area;
            check_directors(&shell.quads, &shape[k]);
            assert_int_equal(shell.mesh.quad_report.locking, 0);
            assert_int_equal(shell.mesh.quad_report.narrow, 0);
            error[fine] = 1 - area / exact_area(&shape[k]);
            quad_shell_close(&shell);
        }
        print_message("area %.4f %% and %.4f %% too small\n", 100 * error[0], 100 * error[1]);
        assert_true(error[0] > 0 && error[0] < 0.01);
        assert_true(fabs(error[0] / error[1] - 4) < 0.3);
    }
}

/* Free curvature of two plies with one Poisson's ratio, of which the upper one strains by `strain`.
 */
static double bimetal(double lower, double upper, double modulus_ratio, double strain)
{
    const double m = upper / lower, n = modulus_ratio, square = (1 + m) * (1 + m);
    return 6 * strain * square /
           ((lower + upper) * (3 * square + (1 + m * n) * (m * m + 1 / (m * n))));
}

/*
 * Law: a clamped disc of two plies of one Poisson's ratio, driven inside the radius r, moves at its
 * centre by (1 + nu)/2 k r^2 ln(R/r), with k the free curvature. Elements of half the size leave a
 * third of the error or less.
 */
static void test_driven_disc(void **state)
{
    (void)state;
    const double strain = 190e-12 * 10 / 0.2e-3,
                 curvature = bimetal(1e-3, 0.2e-3, 63.0 / 64, strain);
    const double exact = 1.3 / 2 * curvature * 9e-3 * 9e-3 * log(25.0 / 9);
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
        char changes[400];
        scene_run run;
        snprintf(changes, sizeof changes,
                 "patches=[{name: first, layer: piezo, sets: [ring1]}, {name: rest, layer: piezo, "
                 "sets: [ring2-*, ring3-*]}];actuators=[{name: v, drives: [{patches: first}], "
                 "applied: 10}];mesh.disc.elements=%d;mesh.disc.sectors=4",
                 8 << fine);
        if (scene_run_open(&run, "tests/rigs/scenes/disc-mirror.yaml", changes) < 0 ||
            scene_run_solve(&run) < 0)
            fail_msg("%s", run.error);
        error[fine] = fabs(scene_run_value(&run, 0)) / exact - 1;
        print_message("driven disc, %2d elements: %.3f %%\n", 8 << fine, 100 * error[fine]);
        scene_run_close(&run);
    }
    assert_true(fabs(error[0]) < 0.01);
    assert_true(fabs(error[1]) < fabs(error[0]) / 3);
}

/* Law: a disc that cannot be made is refused, and the message names the number. */
static void test_refusals(void **state)
{
    (void)state;
    static const char *const row[][2] = {
        {"mesh.disc.elements=5", "5 elements; give an even number"},
        {"mesh.disc.elements=0", "elements"},
        {"mesh.disc.sectors=5", "5 sectors do not divide the 24 elements"},
        {"mesh.disc.rings=[9 mm, 8 mm]", "the radius 0.008 follows 0.009"},
        {"mesh.disc.rings=[9 mm, 26 mm]", "outside the rim of radius 0.025"},
        {"mesh.disc.sphere=25 mm", "more than 0.95 of the sphere's"},
        {"mesh.disc.focal=4 mm", "more than 6 focal lengths of 0.004"},
        {"mesh.disc.focal=4 mm;mesh.disc.sphere=90 mm", "give 'sphere' or 'focal'"},
        {"mesh.disc.radius=0", "radius"},
        {"mesh.disc.elements=60;mesh.disc.radius=1", "use fewer elements"},
        {"surface={type: plate}", "a disc brings its own surface"},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        scene_run run;
        assert_int_equal(scene_run_open(&run, "tests/rigs/scenes/disc-mirror.yaml", row[k][0]), -1);
        if (!strstr(run.error, row[k][1]))
            fail_msg("'%s' is not in: %s", row[k][1], run.error);
        scene_run_close(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sets),     cmocka_unit_test(test_sectors),
        cmocka_unit_test(test_area),     cmocka_unit_test(test_driven_disc),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
