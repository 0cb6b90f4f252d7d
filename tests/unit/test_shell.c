/*
 * The element against an independent implementation, and the laws it must obey. Double; tables made
 * by the host tools.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/mesh/mesh.h"
#include "../../lib/model/shell.h"
#include "../rigs/element_assert.h"
#include "../rigs/mode_stiffness.h"
#include "../rigs/testdata.h"
#include "../rigs/uniform.h"
#include "../../host_tools/mesh/warp.h"

#ifndef DATA
#define DATA "tests/oracle/data"
#endif

/* One element as a scene, made by hand. */
typedef struct one {
    scene scene;
    mesh mesh;
    double point[2][2];
    scene_layer layer[8];
    scene_material material[8];
} one;

static const scene_element published = {0, 0, 0, 0, 0, 0, 0, 7, 0, 0};
static const scene_element improved = {1, 1, 0.09, 1, 1, 1, 1, 7, 0, 1};

static void set_surface(scene_surface *surface, const char *name, const double *number)
{
    static const char *const names[] = {"plate", "polar", "cylinder", "ring", "cone", "sphere"};
    static const scene_surface_type types[] = {SURFACE_PLATE,    SURFACE_POLAR, SURFACE_CYLINDER,
                                               SURFACE_CYLINDER, SURFACE_CONE,  SURFACE_SPHERE};
    for (int i = 0; i < 6; i++)
        if (strcmp(name, names[i]) == 0)
            surface->type = types[i];
    surface->axial = strcmp(name, "ring") == 0 ? 2 : 1;
    surface->radius = number && surface->type != SURFACE_CONE ? number[0] : 0;
    surface->angle = surface->type == SURFACE_CONE ? number[0] * 180 / acos(-1) : 0;
}

static void build(one *o, const scene_element *element, const char *surface, const double *number,
                  const double cell[4], const double *layers, int count, double z_inner)
{
    char error[SCENE_ERROR];
    memset(&o->scene, 0, sizeof o->scene);
    memcpy(o->point, cell, sizeof o->point);
    for (int a = 0; a < 2; a++) {
        o->scene.line[a].elements = 1;
        o->scene.line[a].point = o->point[a];
    }
    for (int i = 0; i < count; i++)
        element_layer(&o->layer[i], &o->material[i], i, layers + 17 * i);
    o->scene.element = *element;
    set_surface(&o->scene.surface, surface, number);
    o->scene.layers = o->scene.materials = count;
    o->scene.layer = o->layer;
    o->scene.material = o->material;
    o->scene.reference = -z_inner;
    assert_int_equal(mesh_build(&o->mesh, &o->scene, error), 0);
}

static const double mode_weight[4] = {1, 1 / 3.0, 1 / 3.0, 1 / 9.0};

/* Full 10 x 10 of a mode per unit of area. */
static void unpack_mode(const one *o, int mode, double d[100])
{
    for (int i = 0; i < 10; i++)
        for (int j = 0; j <= i; j++)
            d[10 * i + j] = d[10 * j + i] = mode_stiffness(&o->mesh.type[0], mode, i, j) /
                                            (o->mesh.place[0].area * mode_weight[mode]);
}

static void check_modes(const testdata *t, const one *o)
{
    static const char *const key[4] = {"D00", "D01", "D10", "D11"};
    for (int mode = 0; mode < 4; mode++) {
        double d[100];
        unpack_mode(o, mode, d);
        ASSERT_CLOSE(t->name, key[mode], d, testdata_values(t, key[mode]), 100, 1e-12);
    }
}

static void check_columns(const testdata *t, const one *o, int layers)
{
    const int n = 4 * (int)o->mesh.dof_per_node;
    const testdata_array *voltage = testdata_find(t, "volt");
    double h0[10], f[28], reference[28];
    for (int layer = 0; layer < layers; layer++) {
        laminate_unit_resultants(&o->mesh.laminate, &o->scene.element, &o->mesh.place[0], layer,
                                 h0);
        pzs_shell_prescribed_force(&o->mesh.type[0], o->mesh.dof_per_node, h0, f);
        for (int i = 0; i < n; i++)
            reference[i] = voltage->value[i * layers + layer];
        ASSERT_CLOSE(t->name, "force per volt", f, reference, n, 1e-12);
    }
    laminate_unit_resultants(&o->mesh.laminate, &o->scene.element, &o->mesh.place[0], -1, h0);
    pzs_shell_prescribed_force(&o->mesh.type[0], o->mesh.dof_per_node, h0, f);
    ASSERT_CLOSE(t->name, "force per kelvin", f, testdata_values(t, "kelvin"), n, 1e-12);
}

/* Strains that each mode keeps, in the order of D: the resultants' order. */
static const int kept_count[4] = {10, 5, 5, 2};
static const int kept[4][10] = {
    {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, {0, 1, 4, 5, 8}, {2, 3, 4, 5, 9}, {4, 5}};

/* Strain energy, half of strains times resultants. */
static double energy_at(const pzs_element_type *type, unsigned dof_per_node, const double *u)
{
    double e[4][10], h[SHELL_RESULTANTS], energy = 0, *resultant = h;
    pzs_shell_strains_at(type, dof_per_node, u, e);
    pzs_shell_resultants(type, dof_per_node, u, NULL, NULL, h);
    for (int m = 0; m < 4; m++)
        for (int i = 0; i < kept_count[m]; i++)
            energy += e[m][kept[m][i]] * *resultant++ / 2;
    return energy;
}

/* Internal force, energy and tangent at a displacement. */
static void check_at_shape(const testdata *t, const one *o)
{
    const unsigned dof_per_node = o->mesh.dof_per_node;
    const int n = 4 * (int)dof_per_node;
    const double *u = testdata_values(t, "U"),
                 energy = energy_at(&o->mesh.type[0], dof_per_node, u);
    double f[28], k[SHELL_PACKED(28)];
    pzs_shell_system(&o->mesh.type[0], dof_per_node, u, NULL, NULL, f, k);
    ASSERT_CLOSE(t->name, "energy", &energy, testdata_values(t, "energy"), 1, 1e-12);
    ASSERT_CLOSE(t->name, "internal force", f, testdata_values(t, "force"), n, 1e-12);
    ASSERT_CLOSE(t->name, "tangent", k, testdata_values(t, "tangent"), SHELL_PACKED(n), 1e-12);
}

/* Element witnessed by another program: D is given, geometry is compared node by node. */
static void check_witness(const testdata *t, one *o)
{
    static const double any[17] = {1, 0, 1, 1, 1, 1, 1, 1};
    const double *z = testdata_values(t, "z"), *d = testdata_values(t, "D"),
                 *nodes = testdata_values(t, "nodes");
    const testdata_array *number = testdata_find(t, "surface");
    double layer[17];
    memcpy(layer, any, sizeof layer);
    layer[0] = z[1] - z[0];
    build(o, &published, testdata_word(t, "surface"), number ? number->value : NULL,
          testdata_values(t, "cell"), layer, 1, z[0]);
    for (int r = 0; r < 4; r++) {
        const surface_point *p = &o->mesh.point[o->mesh.element[0][r]];
        const double here[6] = {p->lame[0],      p->lame[1],     p->curvature[0],
                                p->curvature[1], p->geodesic[0], p->geodesic[1]};
        ASSERT_CLOSE(t->name, "node geometry", here, nodes + 6 * r, 6, 1e-14);
    }
    for (int mode = 0; mode < 4; mode++) {
        double *entry = o->mesh.type[0].d + first_entry[mode];
        for (int i = 0; i < kept_strains[mode]; i++)
            for (int j = 0; j <= i; j++)
                *entry++ = d[10 * kept_strain[mode][i] + kept_strain[mode][j]] *
                           o->mesh.place[0].area * mode_weight[mode];
    }
    check_at_shape(t, o);
}

/* Law: element matrices, columns, forces and tangents equal those of an independent implementation
 * of the theory. */
static void test_oracle(void **state)
{
    (void)state;
    FILE *file = fopen(DATA "/elements.txt", "r");
    testdata t;
    int cases = 0;
    assert_non_null(file);
    while (testdata_next(file, &t)) {
        one o;
        if (strncmp(t.name, "published-witness", 17) == 0) {
            check_witness(&t, &o);
        } else {
            const testdata_array *layers = testdata_find(&t, "layers"),
                                 *number = testdata_find(&t, "surface");
            scene_element element =
                strcmp(testdata_word(&t, "element"), "published") == 0 ? published : improved;
            element.dof_per_node = (int)testdata_values(&t, "unknowns")[0];
            build(&o, &element, testdata_word(&t, "surface"), number ? number->value : NULL,
                  testdata_values(&t, "cell"), layers->value, layers->rows,
                  testdata_values(&t, "z")[0]);
            ASSERT_CLOSE(t.name, "area", &o.mesh.place[0].area, testdata_values(&t, "area"), 1,
                         1e-14);
            check_modes(&t, &o);
            ASSERT_CLOSE(t.name, "stiffness", o.mesh.stiffness, testdata_values(&t, "K"),
                         SHELL_PACKED(4 * element.dof_per_node), 1e-12);
            check_columns(&t, &o, layers->rows);
            check_at_shape(&t, &o);
        }
        mesh_free(&o.mesh);
        testdata_free(&t);
        cases++;
    }
    fclose(file);
    assert_int_equal(cases, 46);
}

/* ---- laws ------------------------------------------------------------- */

static const double steel[17] = {0.08,   0,      2.1, 2.1, 2.1, 0.8, 0.8, 0.8, 0.3125,
                                 0.3125, 0.3125, 0,   0,   0,   0,   0,   0};
static const double plies[34] = {0.05, 30,   25,   1,    1, 0.5,  0.5, 0.2, 0.25, 0.25, 0.25, 0,
                                 0,    0,    0,    0,    0, 0.03, 80,  25,  1,    1,    0.5,  0.5,
                                 0.2,  0.25, 0.25, 0.25, 0, 0,    0,   0,   0,    0};
static const double radius[1] = {2}, half_angle[1] = {0.5};

typedef struct sample {
    const char *surface;
    const double *number;
    double cell[4];
} sample;
static const sample samples[] = {
    {"plate", NULL, {0.1, 0.8, -0.2, 0.3}},   {"polar", NULL, {1, 1.6, 0.2, 0.7}},
    {"cylinder", radius, {0, 0.8, 0.1, 0.6}}, {"ring", radius, {0.1, 0.6, 0, 0.8}},
    {"cone", half_angle, {2, 2.7, 0.2, 0.8}}, {"sphere", radius, {0.6, 1.1, 0.2, 0.8}},
};
enum { SAMPLES = sizeof samples / sizeof *samples };

static void build_sample(one *o, const sample *s, const scene_element *element)
{
    build(o, element, s->surface, s->number, s->cell, plies, 2, -0.03);
}

/* Law: a free element has exactly six motions without energy, on every surface, in every
 * formulation. */
static void test_six_zero_modes(void **state)
{
    (void)state;
    scene_element formulations[3] = {published, improved, improved};
    formulations[2].dof_per_node = 6;
    for (int f = 0; f < 3; f++)
        for (int i = 0; i < SAMPLES; i++) {
            one o;
            build_sample(&o, &samples[i], &formulations[f]);
            assert_six_zero_modes(o.mesh.stiffness, 4 * formulations[f].dof_per_node);
            mesh_free(&o.mesh);
        }
}

/* Inverse of a mode's kept block of d [10][10], zero elsewhere; positive definite. */
static void invert_kept(const double *d, int mode, double *inverse)
{
    double a[10][20] = {{0}};
    const int n = kept_count[mode];
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            a[i][j] = d[10 * kept[mode][i] + kept[mode][j]];
        a[i][n + i] = 1;
    }
    for (int p = 0; p < n; p++)
        for (int i = 0; i < n; i++) {
            const double factor = i == p ? (a[p][p] - 1) / a[p][p] : a[i][p] / a[p][p];
            for (int j = 0; j < 2 * n; j++)
                a[i][j] -= factor * a[p][j];
        }
    memset(inverse, 0, 100 * sizeof *inverse);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            inverse[10 * kept[mode][i] + kept[mode][j]] = a[i][n + j];
}

/* y = K x, K a packed lower triangle of n rows. */
static void times(const double *k, const double *x, int n, double *y)
{
    for (int r = 0; r < n; r++) {
        y[r] = 0;
        for (int c = 0; c < n; c++)
            y[r] += k[r >= c ? r * (r + 1) / 2 + c : c * (c + 1) / 2 + r] * x[c];
    }
}

static void fill(double *x, int n, double size, unsigned *seed)
{
    for (int i = 0; i < n; i++)
        x[i] = size * uniform(seed, -1, 1);
}

/* Elements under the laws at a shape: every surface in both formulations, improved with 7 and 6
 * unknowns. */
enum { SHAPES = 3 * SAMPLES };

/*
 * Any nine shares in the warp, also those that are 0 on these surfaces, and any skew: the laws hold
 * for all.
 */
static void set_warp_and_skew(one *o)
{
    unsigned seed = 11;
    fill(o->mesh.type[0].warp, 9, 0.5, &seed);
    fill(o->mesh.type[0].skew, 2, 0.4, &seed);
    pzs_shell_stiffness(&o->mesh.type[0], o->mesh.dof_per_node, o->mesh.stiffness);
}

static unsigned build_shape(one *o, int shape)
{
    scene_element element = shape % 3 == 0 ? published : improved;
    element.dof_per_node = shape % 3 == 2 ? 6 : 7;
    build_sample(o, &samples[shape / 3], &element);
    if (element.cartesian)
        set_warp_and_skew(o);
    return (unsigned)element.dof_per_node;
}

/*
 * Law: the 12 mean of mode 00 grows by the nine shares times their strains, nothing else changes,
 * before the skew is taken into account.
 */
static void test_warp_shares(void **state)
{
    (void)state;
    static const int row[9][2] = {{0, 7}, {1, 8}, {2, 9}, {0, 8}, {0, 9},
                                  {0, 1}, {1, 1}, {0, 3}, {2, 3}};
    for (int i = 0; i < SHAPES; i++) {
        one o;
        unsigned seed = 5;
        const unsigned dof_per_node = build_shape(&o, i);
        double u[28], with_warp[4][10], plain[4][10];
        fill(u, 4 * (int)dof_per_node, 0.2, &seed);
        memset(o.mesh.type[0].skew, 0, 2 * sizeof(double));
        pzs_shell_strains_at(&o.mesh.type[0], dof_per_node, u, with_warp);
        const pzs_element_type type = o.mesh.type[0];
        memset(o.mesh.type[0].warp, 0, sizeof type.warp);
        pzs_shell_strains_at(&o.mesh.type[0], dof_per_node, u, plain);
        for (int k = 0; k < 9; k++)
            plain[0][6] += type.warp[k] * plain[row[k][0]][row[k][1]];
        ASSERT_CLOSE(samples[i / 3].surface, "strains with the warp", &with_warp[0][0],
                     &plain[0][0], 40, 1e-15);
        mesh_free(&o.mesh);
    }
}

/*
 * Law: the warp holds no director at rest. Tilted directors leave the 12 mean what g_diff gives
 * it, on every surface, thick and thin. The published element has no warp.
 */
static void test_warp_is_free_of_directors(void **state)
{
    (void)state;
    for (int i = 0; i < SAMPLES; i++)
        for (int thin = 0; thin < 2; thin++) {
            one o;
            double layer[17], k[9], u[28], e[4][10], plain[4][10];
            unsigned seed = 3;
            memcpy(layer, steel, sizeof layer);
            layer[0] = thin ? 1e-5 : 0.08;
            build(&o, &improved, samples[i].surface, samples[i].number, samples[i].cell, layer, 1,
                  -layer[0] / 2);
            memset(u, 0, sizeof u);
            for (int p = 0; p < 4; p++)
                fill(u + 7 * p + 3, 2, 1e-6, &seed);
            pzs_shell_strains_at(&o.mesh.type[0], 7, u, e);
            memcpy(k, o.mesh.type[0].warp, sizeof k);
            memset(o.mesh.type[0].warp, 0, sizeof k);
            pzs_shell_strains_at(&o.mesh.type[0], 7, u, plain);
            if (fabs(k[0]) > 0) /* what is left is quadratic in u */
                assert_true(fabs(e[0][6] - plain[0][6]) < 1e-5 * fabs(k[0] * plain[0][7]));
            mesh_free(&o.mesh);
            build(&o, &published, samples[i].surface, samples[i].number, samples[i].cell, layer, 1,
                  -layer[0] / 2);
            for (int j = 0; j < 9; j++)
                assert_true(o.mesh.type[0].warp[j] == 0);
            mesh_free(&o.mesh);
        }
}

/* Law: no warp comes of a table with a number that is not finite. */
static void test_bad_warp(void **state)
{
    (void)state;
    static const double bad[] = {NAN, INFINITY};
    one o;
    build_sample(&o, &samples[2], &improved);
    for (int i = 0; i < 2; i++) {
        pzs_element_type type = o.mesh.type[0];
        type.g_mean[1][0][0] = bad[i];
        assert_int_equal(warp_fill(&type, 0.3), -1);
        assert_int_equal(warp_fill(&type, 0), 0);
        for (int k = 0; k < 9; k++)
            assert_true(type.warp[k] == 0);
    }
    mesh_free(&o.mesh);
}

/* Law: rho adds to the shear compliance of whole modes, 00 01 10, and to nothing else. */
static void test_shear_compliance(void **state)
{
    (void)state;
    scene_element stiff = improved;
    stiff.rho = 0;
    for (int i = 0; i < SAMPLES; i++) {
        one with_rho, without;
        build_sample(&with_rho, &samples[i], &improved);
        build_sample(&without, &samples[i], &stiff);
        for (int mode = 0; mode < 4; mode++) {
            double d[2][100], s[2][100];
            unpack_mode(&with_rho, mode, d[0]);
            unpack_mode(&without, mode, d[1]);
            invert_kept(d[0], mode, s[0]);
            invert_kept(d[1], mode, s[1]);
            for (int r = 0; r < 10; r++)
                for (int c = 0; c < 10; c++) {
                    const int shear = r == c && r >= 8 && (mode == 0 || r == 7 + mode);
                    const double more = s[0][10 * r + c] - s[1][10 * r + c];
                    const double size = sqrt(s[1][11 * r] * s[1][11 * c]);
                    assert_true(shear ? more > 0.01 * size : fabs(more) <= 1e-13 * size);
                }
        }
        mesh_free(&with_rho.mesh);
        mesh_free(&without.mesh);
    }
}

/* Law: the tangent under the true resultants, given ones among them, is the derivative of the
 * internal force. Forces are cubic in u, so a four-point difference is exact. */
static void test_tangent_is_derivative(void **state)
{
    (void)state;
    static const double point[4] = {1, -1, 2, -2},
                        weight[4] = {8 / 12.0, -8 / 12.0, -1 / 12.0, 1 / 12.0};
    for (int i = 0; i < SHAPES; i++) {
        one o;
        unsigned seed = 7;
        const unsigned dof_per_node = build_shape(&o, i);
        const pzs_element_type *type = &o.mesh.type[0];
        const int n = 4 * (int)dof_per_node;
        double u[28], v[28], given[10], derivative[28] = {0}, product[28], f[28],
                                        k[SHELL_PACKED(28)], ignored[SHELL_PACKED(28)];
        fill(u, n, 0.2, &seed);
        fill(v, n, 0.1, &seed);
        fill(given, 10, 0.01, &seed);
        pzs_shell_system(type, dof_per_node, u, given, NULL, f, k);
        times(k, v, n, product);
        for (int p = 0; p < 4; p++) {
            double moved[28];
            for (int j = 0; j < n; j++)
                moved[j] = u[j] + point[p] * v[j];
            pzs_shell_system(type, dof_per_node, moved, given, NULL, f, ignored);
            for (int j = 0; j < n; j++)
                derivative[j] += weight[p] * f[j];
        }
        ASSERT_CLOSE(samples[i / 3].surface, "tangent times v", product, derivative, n, 1e-13);
        mesh_free(&o.mesh);
    }
}

/* Law: the geometric part is the derivative of the force of resultants that stay; that force is
 * linear in u. */
static void test_geometric_part(void **state)
{
    (void)state;
    for (int i = 0; i < SHAPES; i++) {
        one o;
        unsigned seed = 11;
        const unsigned dof_per_node = build_shape(&o, i);
        const pzs_element_type *type = &o.mesh.type[0];
        const int n = 4 * (int)dof_per_node;
        const double none[SHELL_RESULTANTS] = {0};
        double u[28], v[28], moved[28], resultant[SHELL_RESULTANTS], product[28], f[28], here[28],
            there[28];
        double k[SHELL_PACKED(28)], material[SHELL_PACKED(28)];
        fill(u, n, 0.2, &seed);
        fill(v, n, 0.1, &seed);
        fill(resultant, SHELL_RESULTANTS, 1, &seed);
        for (int j = 0; j < n; j++)
            moved[j] = u[j] + v[j];
        pzs_shell_force_at(type, dof_per_node, u, resultant, here);
        pzs_shell_force_at(type, dof_per_node, moved, resultant, there);
        pzs_shell_system(type, dof_per_node, u, NULL, resultant, f, k);
        pzs_shell_system(type, dof_per_node, u, NULL, none, f, material);
        for (int j = 0; j < SHELL_PACKED(n); j++)
            k[j] -= material[j];
        for (int j = 0; j < n; j++)
            there[j] -= here[j];
        times(k, v, n, product);
        ASSERT_CLOSE(samples[i / 3].surface, "geometric part times v", product, there, n, 1e-13);
        mesh_free(&o.mesh);
    }
}

/* Law: strains are quadratic, e(u + du) = e(u) + L(u) du + (e(du) - L(0) du), so extrapolated
 * resultants are those of the new shape without the quadratic term; given resultants of mode 00 are
 * added as they are. */
static void test_extrapolation(void **state)
{
    (void)state;
    for (int i = 0; i < SHAPES; i++) {
        one o;
        unsigned seed = 5;
        const unsigned dof_per_node = build_shape(&o, i);
        const pzs_element_type *type = &o.mesh.type[0];
        const double zero[28] = {0};
        double u[28], du[28], sum[28], given[10];
        double there[SHELL_RESULTANTS], ahead[SHELL_RESULTANTS], alone[SHELL_RESULTANTS],
            linear[SHELL_RESULTANTS];
        fill(u, 28, 0.2, &seed);
        fill(du, 28, 0.2, &seed);
        fill(given, 10, 0.01, &seed);
        for (int j = 0; j < 28; j++)
            sum[j] = u[j] + du[j];
        pzs_shell_resultants(type, dof_per_node, u, du, given, ahead);
        pzs_shell_resultants(type, dof_per_node, sum, NULL, given, there);
        pzs_shell_resultants(type, dof_per_node, du, NULL, NULL, alone);
        pzs_shell_resultants(type, dof_per_node, zero, du, NULL, linear);
        for (int j = 0; j < SHELL_RESULTANTS; j++)
            there[j] -= alone[j] - linear[j];
        ASSERT_CLOSE(samples[i / 3].surface, "extrapolated resultants", ahead, there,
                     SHELL_RESULTANTS, 1e-14);
        pzs_shell_resultants(type, dof_per_node, u, du, NULL, linear);
        for (int j = 0; j < SHELL_RESULTANTS; j++)
            linear[j] += j < 10 ? given[j] : 0;
        ASSERT_CLOSE(samples[i / 3].surface, "given resultants", ahead, linear, SHELL_RESULTANTS,
                     0);
        mesh_free(&o.mesh);
    }
}

/* Law: the table matrix is the tangent at zero, and the strain-based force is that matrix times u.
 */
static void test_table_is_tangent_at_zero(void **state)
{
    (void)state;
    for (int i = 0; i < SHAPES; i++) {
        one o;
        unsigned seed = 3;
        const unsigned dof_per_node = build_shape(&o, i);
        const int n = 4 * (int)dof_per_node;
        const double zero[28] = {0};
        double k[SHELL_PACKED(28)], u[28], f[28], product[28];
        pzs_shell_system(&o.mesh.type[0], dof_per_node, zero, NULL, NULL, f, k);
        ASSERT_CLOSE(samples[i / 3].surface, "table matrix", o.mesh.stiffness, k, SHELL_PACKED(n),
                     8 * 2.2e-16);
        ASSERT_CLOSE(samples[i / 3].surface, "force at rest", f, zero, n, 0);
        fill(u, n, 1, &seed);
        pzs_shell_force(&o.mesh.type[0], dof_per_node, u, f);
        times(k, u, n, product);
        ASSERT_CLOSE(samples[i / 3].surface, "strain-based force", f, product, n, 28 * 8 * 2.2e-16);
        mesh_free(&o.mesh);
    }
}

/* A finite rotation about a skew axis, and a shift. */
static const double turn_axis[3] = {2 / 7.0, 3 / 7.0, 6 / 7.0}, turn_angle = 2.2,
                    shift[3] = {0.3, -1.1, 0.7};

/* (R - I) x by Rodrigues' formula. */
static void turned(const double x[3], double out[3])
{
    const double along = turn_axis[0] * x[0] + turn_axis[1] * x[1] + turn_axis[2] * x[2];
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = sin(turn_angle) * (turn_axis[j] * x[k] - turn_axis[k] * x[j]) +
                 (1 - cos(turn_angle)) * (turn_axis[i] * along - x[i]);
    }
}

static void in_triad(const surface_point *p, const double v[3], double out[3])
{
    for (int a = 0; a < 3; a++)
        out[a] = p->triad[a][0] * v[0] + p->triad[a][1] * v[1] + p->triad[a][2] * v[2];
}

/* Unknowns of a node under the rigid motion. */
static void rigid_node(const one *o, const surface_point *p, double u[7])
{
    const double middle = (o->mesh.laminate.z[0] + o->mesh.laminate.z[1]) / 2;
    double x[3], v[3];
    for (int i = 0; i < 3; i++)
        x[i] = p->position[i] + middle * p->triad[2][i];
    turned(x, v);
    for (int i = 0; i < 3; i++)
        v[i] += shift[i];
    in_triad(p, v, u);
    turned(p->triad[2], v);
    in_triad(p, v, u + 3);
    u[6] = 0;
}

/* Law: with exact derivatives the strains of any finite rigid motion vanish at a point, on every
 * surface. */
static void test_rigid_motion_at_a_point(void **state)
{
    (void)state;
    static const int neighbour[4][2] = {{1, 3}, {0, 2}, {3, 1}, {2, 0}};
    static const double sign[4][4] = {{1, 1, 1, 1}, {-1, -1, 1, 1}, {-1, 1, 1, -1}, {1, -1, 1, -1}};
    for (int i = 0; i < SAMPLES; i++)
        for (int r = 0; r < 4; r++) {
            one o;
            double u[28] = {0}, e[4][10];
            build_sample(&o, &samples[i], &published);
            const pzs_element_type *type = &o.mesh.type[0];
            const surface_point *p = &o.mesh.point[o.mesh.element[0][r]];
            rigid_node(&o, p, u + 7 * r);
            for (int a = 0; a < 2; a++) { /* choose the neighbour so that the corner sees the exact
                                             derivative */
                const double z = (o.mesh.laminate.z[0] + o.mesh.laminate.z[1]) / 2;
                double v[3], lam[3];
                turned(p->triad[a], v);
                in_triad(p, v, lam);
                for (int part = 0; part < 2; part++)
                    for (int row = 0; row < 3; row++) {
                        double rest =
                            lam[row] * (part == 0 ? 1 + p->curvature[a] * z : p->curvature[a]);
                        for (int c = 0; c < 3; c++)
                            rest -= type->s[r][a][row][c] * u[7 * r + 3 * part + c];
                        u[7 * neighbour[r][a] + 3 * part + row] = rest / type->t[r][a][row][row];
                    }
            }
            pzs_shell_strains_at(type, 7, u, e);
            for (int k = 0; k < 10; k++) {
                double strain = 0;
                for (int m = 0; m < 4; m++)
                    strain += sign[m][r] * e[m][k];
                assert_true(fabs(strain) < 500 * 2.2e-16);
            }
            mesh_free(&o.mesh);
        }
}

/* Energy of the rigid motion of one element, over that of a strain of 1. */
static double rigid_energy(const sample *s, const scene_element *element)
{
    one o;
    double u[28], scale = 0;
    build_sample(&o, s, element);
    for (int r = 0; r < 4; r++)
        rigid_node(&o, &o.mesh.point[o.mesh.element[0][r]], u + 7 * r);
    const double energy = energy_at(&o.mesh.type[0], 7, u);
    for (int i = 0; i < 10; i++)
        scale += o.mesh.type[0].d[i * (i + 3) / 2];
    mesh_free(&o.mesh);
    return energy / scale;
}

/* The same element over `share` of its parameter ranges. */
static sample shrunk(const sample *s, double share)
{
    sample small = *s;
    small.cell[1] = s->cell[0] + share * (s->cell[1] - s->cell[0]);
    small.cell[3] = s->cell[2] + share * (s->cell[3] - s->cell[2]);
    return small;
}

/* Law: a finite rigid motion of the mesh costs the improved element nothing; the published one pays
 * d^4 on curved meshes. */
static void test_rigid_motion_of_the_mesh(void **state)
{
    (void)state;
    for (int i = 0; i < SAMPLES; i++) {
        const sample *s = &samples[i], small = shrunk(s, 0.0625), smaller = shrunk(s, 0.03125);
        assert_true(rigid_energy(s, &improved) < 1e-28);
        if (strcmp(s->surface, "plate") == 0) {
            assert_true(rigid_energy(s, &published) < 1e-28);
            continue;
        }
        const double order =
            log2(rigid_energy(&small, &published) / rigid_energy(&smaller, &published));
        assert_true(rigid_energy(s, &published) > 1e-6);
        if (!(order > 3.8 && order < 4.2))
            fail_msg("%s: energy falls with power %.2f", s->surface, order);
    }
}

/* An improved element with 6 unknowns and its finite rigid motion, u [24]; h of the sample
 * multiplied by `thin`. */
static void build_rigid(one *o, const sample *s, double thin, double u[24])
{
    scene_element element = improved;
    double thin_plies[34], node[7];
    element.dof_per_node = 6;
    memcpy(thin_plies, plies, sizeof plies);
    thin_plies[0] *= thin;
    thin_plies[17] *= thin;
    build(o, &element, s->surface, s->number, s->cell, thin_plies, 2, -0.03 * thin);
    for (int r = 0; r < 4; r++) {
        rigid_node(o, &o->mesh.point[o->mesh.element[0][r]], node);
        memcpy(u + 6 * r, node, 6 * sizeof *node);
    }
}

/* Turn the vectors of x [24] with the element, each in its node's triad. */
static void turn_unknowns(const one *o, const double x[24], double y[24])
{
    for (int i = 0; i < 8; i++) {
        const surface_point *p = &o->mesh.point[o->mesh.element[0][i / 2]];
        double v[3], change[3];
        for (int c = 0; c < 3; c++)
            v[c] = x[3 * i] * p->triad[0][c] + x[3 * i + 1] * p->triad[1][c] +
                   x[3 * i + 2] * p->triad[2][c];
        turned(v, change);
        in_triad(p, change, y + 3 * i);
        for (int c = 0; c < 3; c++)
            y[3 * i + c] += x[3 * i + c];
    }
}

/* Law: no force holds an improved element after a finite rigid motion. A row of K u sums 24
 * products of 40 terms. */
static void test_rigid_motion_without_force(void **state)
{
    (void)state;
    for (int i = 0; i < SAMPLES; i++) {
        one o;
        double u[24], f[24], k[SHELL_PACKED(24)], scale = 0, largest = 0;
        build_rigid(&o, &samples[i], 1, u);
        pzs_shell_system(&o.mesh.type[0], 6, u, NULL, NULL, f, k);
        for (int r = 0; r < 24; r++) {
            double row = 0;
            for (int c = 0; c < 24; c++)
                row += fabs(o.mesh.stiffness[r >= c ? r * (r + 1) / 2 + c : c * (c + 1) / 2 + r] *
                            u[c]);
            scale = fmax(scale, row);
            largest = fmax(largest, fabs(f[r]));
        }
        if (!(largest <= 40 * 2.2e-16 * scale))
            fail_msg("%s: force %.2e of stiffness times displacement", samples[i].surface,
                     largest / scale);
        mesh_free(&o.mesh);
    }
}

/* Law: strains do not see a finite rigid motion put on top of a displacement, and differences
 * between the faces keep their digits on a thin shell (h/L = 1e-5), where the faces themselves
 * agree to five of them. */
static void test_strains_of_a_thin_shell(void **state)
{
    (void)state;
    for (int i = 0; i < SAMPLES; i++) {
        one o;
        unsigned seed = 13;
        double rigid[24], v[24], u[24], e[4][10], reference[4][10];
        build_rigid(&o, &samples[i], 1e-4, rigid);
        fill(v, 24, 0.1, &seed);
        turn_unknowns(&o, v, u);
        for (int j = 0; j < 24; j++)
            u[j] += rigid[j];
        pzs_shell_strains_at(&o.mesh.type[0], 6, u, e);
        pzs_shell_strains_at(&o.mesh.type[0], 6, v, reference);
        for (int s = 0; s < 10; s++) {
            double x[4], y[4];
            for (int m = 0; m < 4; m++) {
                x[m] = e[m][s];
                y[m] = reference[m][s];
            }
            ASSERT_CLOSE(samples[i].surface, "strain", x, y, 4,
                         10 * 40 * 2.2e-16); /* v is a tenth of the motion */
        }
        mesh_free(&o.mesh);
    }
}

/* Law: an element moved as a rigid body has the stiffness of rest, turned with it; on a thin shell
 * (h/L = 1e-5) this holds for the part of each single strain to the last digits. */
static void test_tangent_of_a_thin_shell(void **state)
{
    (void)state;
    for (int i = 0; i < SAMPLES; i++)
        for (int s = 0; s < 10; s++) {
            one o;
            unsigned seed = 17;
            double rigid[24], v[24], u[24], f[24], there[24], expected[24], k[SHELL_PACKED(24)];
            build_rigid(&o, &samples[i], 1e-4, rigid);
            pzs_element_type *type = &o.mesh.type[0];
            memset(type->d, 0, sizeof type->d);
            for (int m = 0; m < 4; m++)
                for (int k = 0; k < kept_strains[m]; k++)
                    if (kept_strain[m][k] == s)
                        type->d[first_entry[m] + k * (k + 3) / 2] = 1;
            fill(v, 24, 1, &seed);
            turn_unknowns(&o, v, u);
            pzs_shell_system(type, 6, rigid, NULL, NULL, f, k);
            times(k, u, 24, there);
            pzs_shell_stiffness(type, 6, k);
            times(k, v, 24, f);
            turn_unknowns(&o, f, expected);
            ASSERT_CLOSE(samples[i].surface, "turned stiffness", there, expected, 24,
                         100 * 2.2e-16);
            mesh_free(&o.mesh);
        }
}

/* Law: a free element strained by its actuation alone takes the free strain exactly (no stress is
 * left). */
static void test_free_expansion(void **state)
{
    (void)state;
    double layer[17];
    memcpy(layer, steel, sizeof layer);
    layer[14] = layer[15] = layer[16] = 1e-3;
    for (int f = 0; f < 2; f++) {
        one o;
        double u[28] = {0}, h0[10], given[28], force[28];
        build(&o, f ? &improved : &published, "plate", NULL, samples[0].cell, layer, 1, -0.04);
        for (int r = 0; r < 4; r++) {
            const surface_point *p = &o.mesh.point[o.mesh.element[0][r]];
            u[7 * r] = 1e-3 * p->position[0];
            u[7 * r + 1] = 1e-3 * p->position[1];
            u[7 * r + 5] = 1e-3;
        }
        laminate_unit_resultants(&o.mesh.laminate, &o.scene.element, &o.mesh.place[0], -1, h0);
        pzs_shell_prescribed_force(&o.mesh.type[0], 7, h0, given);
        pzs_shell_force(&o.mesh.type[0], 7, u, force);
        ASSERT_CLOSE("plate", "force of free expansion", force, given, 28, 1e-13);
        mesh_free(&o.mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_oracle),
        cmocka_unit_test(test_six_zero_modes),
        cmocka_unit_test(test_tangent_is_derivative),
        cmocka_unit_test(test_geometric_part),
        cmocka_unit_test(test_extrapolation),
        cmocka_unit_test(test_table_is_tangent_at_zero),
        cmocka_unit_test(test_rigid_motion_at_a_point),
        cmocka_unit_test(test_rigid_motion_of_the_mesh),
        cmocka_unit_test(test_rigid_motion_without_force),
        cmocka_unit_test(test_strains_of_a_thin_shell),
        cmocka_unit_test(test_tangent_of_a_thin_shell),
        cmocka_unit_test(test_free_expansion),
        cmocka_unit_test(test_warp_shares),
        cmocka_unit_test(test_warp_is_free_of_directors),
        cmocka_unit_test(test_shear_compliance),
        cmocka_unit_test(test_bad_warp),
    };
    return cmocka_run_group_tests_name("shell", tests, NULL, NULL);
}
