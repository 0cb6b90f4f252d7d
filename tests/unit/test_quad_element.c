/*
 * The element on any quadrilateral against an independent implementation, and the laws it must
 * obey on distorted and warped meshes.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/mesh/corner_weight.h"
#include "../../host_tools/quads/vector.h"
#include "../../lib/model/shell.h"
#include "../rigs/element_assert.h"
#include "../rigs/mode_stiffness.h"
#include "../rigs/quad_shell.h"
#include "../rigs/testdata.h"
#include "../rigs/uniform.h"

#define DATA "tests/oracle/data"

/* ---- oracle --------------------------------------------------------------- */

static void open_case(quad_shell *shell, const testdata *t)
{
    static const double along[3] = {1, 0, 0};
    const testdata_array *layers = testdata_find(t, "layers");
    quad_shell_init(shell, 1, 1, 0);
    for (int i = 0; i < layers->rows; i++)
        element_layer(&shell->layer[i], &shell->material[i], i, layers->value + 17 * i);
    shell->scene.layers = shell->scene.materials = layers->rows;
    shell->scene.reference_is_middle = false;
    shell->scene.reference = -testdata_values(t, "z")[0];
    shell->scene.element.dof_per_node = (int)testdata_values(t, "unknowns")[0];
    memcpy(shell->quads.region[0].direction, testdata_values(t, "direction"), 3 * sizeof(double));
    quad_shell_single(shell, (const double(*)[3])testdata_values(t, "corners"),
                      (const double(*)[3])testdata_values(t, "directors"),
                      (const double(*)[3])testdata_values(t, "axes"));
    if (quad_shell_build(shell, along) < 0)
        fail_msg("%s: %s", t->name, shell->error);
}

static void check_modes(const testdata *t, const quad_shell *shell)
{
    static const char *const key[4] = {"D00", "D01", "D10", "D11"};
    const double *skew = testdata_values(t, "skew");
    const double weight[4] = {1, 1 / (3 - skew[0] * skew[0]), 1 / (3 - skew[1] * skew[1]), 1 / 9.0};
    for (int mode = 0; mode < 4; mode++) {
        double d[100];
        for (int i = 0; i < 10; i++)
            for (int j = 0; j <= i; j++)
                d[10 * i + j] = d[10 * j + i] = mode_stiffness(&shell->mesh.type[0], mode, i, j) /
                                                (shell->mesh.place[0].area * weight[mode]);
        ASSERT_CLOSE(t->name, key[mode], d, testdata_values(t, key[mode]), 100, 1e-12);
    }
}

static void check_tables(const testdata *t, const quad_shell *shell)
{
    const laminate_place *place = &shell->mesh.place[0];
    const double plain[3] = {4 / 36.0, 2 / 36.0, 1 / 36.0};
    double weight[16];
    for (int r = 0; r < 4; r++)
        for (int s = 0; s < 4; s++) {
            const int is_opposite = (r ^ s) == 2, steps = is_opposite ? 2 : r != s;
            weight[4 * r + s] = plain[steps] + corner_pair_excess(place, r, s);
        }
    ASSERT_CLOSE(t->name, "area", &place->area, testdata_values(t, "area"), 1, 1e-14);
    ASSERT_CLOSE(t->name, "skew", shell->mesh.type[0].skew, testdata_values(t, "skew"), 3, 1e-14);
    ASSERT_CLOSE(t->name, "warp", shell->mesh.type[0].warp, testdata_values(t, "warp"), 9, 1e-12);
    ASSERT_CLOSE(t->name, "share", &place->bubble_share, testdata_values(t, "share"), 1, 1e-12);
    ASSERT_CLOSE(t->name, "weights", weight, testdata_values(t, "weights"), 16, 1e-14);
}

static void check_columns(const testdata *t, const quad_shell *shell)
{
    const int n = 4 * (int)shell->mesh.dof_per_node, layers = shell->scene.layers;
    const double *voltage = testdata_values(t, "volt");
    double h0[10], f[28], reference[28];
    for (int layer = -1; layer < layers; layer++) {
        laminate_unit_resultants(&shell->mesh.laminate, &shell->scene.element,
                                 &shell->mesh.place[0], layer, h0);
        pzs_shell_prescribed_force(&shell->mesh.type[0], shell->mesh.dof_per_node, h0, f);
        for (int i = 0; i < n; i++)
            reference[i] =
                layer < 0 ? testdata_values(t, "kelvin")[i] : voltage[i * layers + layer];
        ASSERT_CLOSE(t->name, "force per volt or kelvin", f, reference, n, 1e-12);
    }
}

static void check_forces(const testdata *t, const quad_shell *shell)
{
    const int n = 4 * (int)shell->mesh.dof_per_node;
    double f[28], k[SHELL_PACKED(28)];
    ASSERT_CLOSE(t->name, "stiffness", shell->mesh.stiffness, testdata_values(t, "K"),
                 SHELL_PACKED(n), 1e-12);
    pzs_shell_system(&shell->mesh.type[0], shell->mesh.dof_per_node, testdata_values(t, "U"), NULL,
                     NULL, f, k);
    ASSERT_CLOSE(t->name, "internal force", f, testdata_values(t, "force"), n, 1e-12);
    ASSERT_CLOSE(t->name, "tangent", k, testdata_values(t, "tangent"), SHELL_PACKED(n), 1e-12);
}

/*
 * Law: tables, matrices, columns, forces and tangents equal those of an independent implementation
 * of the theory, on flat, curved, twisted and warped quadrilaterals.
 */
static void test_oracle(void **state)
{
    (void)state;
    FILE *file = fopen(DATA "/quads.txt", "r");
    testdata t;
    int cases = 0;
    assert_non_null(file);
    while (testdata_next(file, &t)) {
        quad_shell shell;
        open_case(&shell, &t);
        check_tables(&t, &shell);
        check_modes(&t, &shell);
        check_columns(&t, &shell);
        check_forces(&t, &shell);
        quad_shell_close(&shell);
        testdata_free(&t);
        cases++;
    }
    fclose(file);
    assert_int_equal(cases, 9);
}

/* ---- random quadrilaterals ------------------------------------------------ */

/* A warped quadrilateral of size 1, thickness 0.05, with tilted directors. */
static void open_random(quad_shell *shell, unsigned seed, int dof_per_node)
{
    static const double square[4][2] = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
    static const double along[3] = {1, 0, 0};
    double corner[4][3], director[4][3], axis[4][3];
    for (int r = 0; r < 4; r++) {
        for (int i = 0; i < 3; i++) {
            corner[r][i] = (i < 2 ? square[r][i] : 0) + 0.15 * uniform(&seed, -1, 1);
            director[r][i] = (i == 2) + 0.2 * uniform(&seed, -1, 1);
            axis[r][i] = uniform(&seed, -1, 1);
        }
        vector_normalise(director[r]);
        const double lean = vector_dot(axis[r], director[r]);
        for (int i = 0; i < 3; i++)
            axis[r][i] -= lean * director[r][i];
        vector_normalise(axis[r]);
    }
    quad_shell_init(shell, 0.05, 2.1, 0.3);
    shell->scene.element.dof_per_node = dof_per_node;
    shell->accept_irregular = true;
    quad_shell_single(shell, (const double(*)[3])corner, (const double(*)[3])director,
                      (const double(*)[3])axis);
    if (quad_shell_build(shell, along) < 0)
        fail_msg("%s", shell->error);
}

/* Law: a free quadrilateral has exactly six motions without energy, however it is warped. */
static void test_six_zero_modes(void **state)
{
    (void)state;
    for (unsigned seed = 0; seed < 200; seed++) {
        quad_shell shell;
        open_random(&shell, seed, seed % 2 ? 6 : 7);
        assert_six_zero_modes(shell.mesh.stiffness, 4 * (int)shell.mesh.dof_per_node);
        quad_shell_close(&shell);
    }
}

/* Rotation matrix about a random axis. */
static void random_rotation(double angle, unsigned *seed, double q[3][3])
{
    double axis[3];
    for (int i = 0; i < 3; i++)
        axis[i] = uniform(seed, -1, 1);
    vector_normalise(axis);
    for (int j = 0; j < 3; j++) {
        const double e[3] = {j == 0, j == 1, j == 2}, along = vector_dot(axis, e);
        double side[3];
        vector_cross(axis, e, side);
        for (int i = 0; i < 3; i++)
            q[i][j] = cos(angle) * e[i] + sin(angle) * side[i] + (1 - cos(angle)) * along * axis[i];
    }
}

/* Law: a finite rigid rotation by any angle strains no quadrilateral; what is left is rounding. */
static void test_rigid_rotation(void **state)
{
    (void)state;
    for (unsigned trial = 0; trial < 100; trial++) {
        quad_shell shell;
        unsigned seed = trial + 1000;
        double q[3][3], u[28] = {0}, e[4][10];
        open_random(&shell, trial, 7);
        random_rotation(3.1 * uniform(&seed, -1, 1), &seed, q);
        for (int r = 0; r < 4; r++) {
            const surface_point *point = &shell.mesh.point[r];
            double move[3], turn[3];
            for (int i = 0; i < 3; i++) {
                move[i] = vector_dot(q[i], point->position) - point->position[i] + 0.7;
                turn[i] = vector_dot(q[i], point->triad[2]) - point->triad[2][i];
            }
            for (int a = 0; a < 3; a++) {
                u[7 * r + a] = vector_dot(point->triad[a], move);
                u[7 * r + 3 + a] = vector_dot(point->triad[a], turn);
            }
        }
        pzs_shell_strains_at(&shell.mesh.type[0], 7, u, e);
        for (int m = 0; m < 4; m++)
            for (int i = 0; i < 10; i++)
                assert_true(fabs(e[m][i]) < 200 * DBL_EPSILON);
        quad_shell_close(&shell);
    }
}

/*
 * Law: the tangent is the derivative of the residual. The force is a cubic polynomial of the
 * displacement, so the difference quotient of fourth order is exact at any step.
 */
static void test_tangent_is_derivative(void **state)
{
    (void)state;
    for (unsigned trial = 0; trial < 20; trial++) {
        quad_shell shell;
        unsigned seed = trial + 77;
        double u[28], v[28], moved[28], f[5][28], k[SHELL_PACKED(28)], unused[SHELL_PACKED(28)],
            product[28], slope[28];
        open_random(&shell, trial, trial % 2 ? 6 : 7);
        const unsigned dof_per_node = shell.mesh.dof_per_node, n = 4 * dof_per_node;
        for (unsigned i = 0; i < n; i++) {
            u[i] = 0.1 * uniform(&seed, -1, 1);
            v[i] = 0.1 * uniform(&seed, -1, 1);
        }
        for (int step = -2; step <= 2; step++) {
            for (unsigned i = 0; i < n; i++)
                moved[i] = u[i] + step * v[i];
            pzs_shell_system(&shell.mesh.type[0], dof_per_node, moved, NULL, NULL, f[step + 2],
                             step ? unused : k);
        }
        for (unsigned r = 0; r < n; r++) {
            product[r] = 0;
            for (unsigned c = 0; c < n; c++)
                product[r] += k[r >= c ? r * (r + 1) / 2 + c : c * (c + 1) / 2 + r] * v[c];
            slope[r] = (8 * (f[3][r] - f[1][r]) - (f[4][r] - f[0][r])) / 12;
        }
        ASSERT_CLOSE("warped", "tangent times step", product, slope, (int)n, 1e-12);
        quad_shell_close(&shell);
    }
}

/* ---- patch tests ---------------------------------------------------------- */

/* MacNeal's patch of five quadrilaterals, turned in space; every node has a triad of its own. */
static const double patch_node[8][2] = {{0, 0},       {0.24, 0},    {0.24, 0.12}, {0, 0.12},
                                        {0.04, 0.02}, {0.18, 0.03}, {0.16, 0.08}, {0.08, 0.08}};
static const uint32_t patch_element[5][4] = {
    {0, 1, 5, 4}, {5, 1, 2, 6}, {7, 6, 2, 3}, {0, 4, 7, 3}, {4, 5, 6, 7}};
enum { INNER = 4, PATCH_NODES = 8 };
static const double patch_thickness = 0.002;

static void open_patch(quad_shell *shell, double rho, const double q[3][3])
{
    static const double along[3] = {1, 0, 0};
    quad_mesh *quads = &shell->quads;
    unsigned seed = 9;
    quads->nodes = PATCH_NODES;
    quads->elements = 5;
    quads->position = calloc(PATCH_NODES, sizeof *quads->position);
    quads->director = calloc(PATCH_NODES, sizeof *quads->director);
    quads->axis = calloc(PATCH_NODES, sizeof *quads->axis);
    quads->element = calloc(5, sizeof *quads->element);
    memcpy(quads->element, patch_element, sizeof patch_element);
    for (int n = 0; n < PATCH_NODES; n++) {
        const double angle = 3 * uniform(&seed, -1, 1);
        for (int i = 0; i < 3; i++) {
            quads->position[n][i] = q[i][0] * patch_node[n][0] + q[i][1] * patch_node[n][1];
            quads->director[n][i] = q[i][2];
            quads->axis[n][i] = q[i][0] * cos(angle) + q[i][1] * sin(angle);
        }
    }
    shell->scene.element.rho = rho;
    if (quad_shell_build(shell, along) < 0)
        fail_msg("%s", shell->error);
}

/*
 * A state of constant strain: displacement and director change at (x, y), in the axes of the plane.
 *   part 0 to 2: membrane strains 11, 22, 12; 3 to 5: curvatures 11, 22, 12; 6: thickness;
 *   7, 8: transverse shears
 */
enum { STATES = 9 };
static void patch_state(int part, double x, double y, double u[3], double d[3])
{
    const double thinning = -0.3 / 0.7;
    memset(u, 0, 3 * sizeof *u);
    memset(d, 0, 3 * sizeof *d);
    switch (part) {
    case 0:
        u[0] = x;
        d[2] = thinning;
        break;
    case 1:
        u[1] = y;
        d[2] = thinning;
        break;
    case 2:
        u[0] = y / 2;
        u[1] = x / 2;
        break;
    case 3:
        d[0] = x;
        u[2] = -x * x / 2;
        break;
    case 4:
        d[1] = y;
        u[2] = -y * y / 2;
        break;
    case 5:
        d[0] = y;
        d[1] = x;
        u[2] = -x * y;
        break;
    case 6: d[2] = 1; break;
    case 7: u[2] = x; break;
    default: u[2] = y;
    }
}

/* Strain energy per area over E h of the states, nu = 0.3, thickness h. */
static double patch_energy(int part, double h)
{
    const double nu = 0.3, plane = 1 / (1 - nu * nu), shear = 1 / (2 * (1 + nu));
    const double lame = nu / ((1 + nu) * (1 - 2 * nu));
    switch (part) {
    case 0:
    case 1: return plane / 2;
    case 2: return shear / 2;
    case 3:
    case 4: return plane / 2 * h * h / 12;
    case 5: return 4 * shear / 2 * h * h / 12;
    case 6: return (lame + 2 * shear) / 2;
    default: return shear / 2;
    }
}

/*
 * Bound of the rounding error of the nodal forces: 64 epsilon times the largest sum of |K| |u|. The
 * bending forces of a thin plate are far below those of the stretches that its displacements hold.
 */
static double rounding_of(const quad_shell *shell, double u[PATCH_NODES][7])
{
    double largest = 0;
    for (int e = 0; e < 5; e++) {
        const double *k = shell->mesh.stiffness + shell->mesh.element_type[e] * SHELL_PACKED(28);
        for (int r = 0; r < 28; r++) {
            double sum = 0;
            for (int c = 0; c < 28; c++)
                sum += fabs(k[r >= c ? r * (r + 1) / 2 + c : c * (c + 1) / 2 + r] *
                            u[patch_element[e][c / 7]][c % 7]);
            largest = fmax(largest, sum);
        }
    }
    return 64 * DBL_EPSILON * largest;
}

/* Nodal values of a state, and forces of all elements at the nodes. */
static void patch_forces(const quad_shell *shell, const double q[3][3], int part,
                         double u[PATCH_NODES][7], double f[PATCH_NODES][7], double *largest)
{
    memset(f, 0, PATCH_NODES * sizeof *f);
    for (int n = 0; n < PATCH_NODES; n++) {
        double local[2][3], global[2][3];
        patch_state(part, patch_node[n][0], patch_node[n][1], local[0], local[1]);
        u[n][6] = 0;
        for (int i = 0; i < 3; i++)
            for (int v = 0; v < 2; v++)
                global[v][i] = vector_dot(q[i], local[v]);
        for (int a = 0; a < 3; a++) {
            u[n][a] = vector_dot(shell->mesh.point[n].triad[a], global[0]);
            u[n][3 + a] = vector_dot(shell->mesh.point[n].triad[a], global[1]);
        }
    }
    for (int e = 0; e < 5; e++) {
        double own[28], force[28];
        for (int r = 0; r < 4; r++)
            memcpy(own + 7 * r, u[patch_element[e][r]], sizeof *u);
        pzs_shell_force(&shell->mesh.type[shell->mesh.element_type[e]], 7, own, force);
        for (int i = 0; i < 28; i++) {
            f[patch_element[e][i / 7]][i % 7] += force[i];
            *largest = fmax(*largest, fabs(force[i]));
        }
    }
}

/*
 * Forces of the face pressures that a thickness strain of 1 needs, on the differences of u3: stress
 * times thickness times the area that belongs to each node.
 */
static void subtract_pressures(const quad_shell *shell, double f[PATCH_NODES][7])
{
    const double stress = 2 * patch_energy(6, patch_thickness);
    for (int e = 0; e < 5; e++) {
        const laminate_place *place = &shell->mesh.place[shell->mesh.element_type[e]];
        for (int r = 0; r < 4; r++)
            f[patch_element[e][r]][5] -=
                stress * patch_thickness * place->area / 4 * corner_share(place, r);
    }
}

/*
 * Law: under constant membrane strain, curvature, thickness strain and (without the shear
 * flexibility of coarse meshes) transverse shear, the inner nodes of a distorted patch are in
 * equilibrium and the energy is exact. A constant shear without moments needs couples at the nodes,
 * so only its translations are looked at.
 */
static void test_patch(void **state)
{
    (void)state;
    const double h = patch_thickness, area = 0.24 * 0.12;
    for (int part = 0; part < STATES; part++) {
        quad_shell shell;
        unsigned seed = 5;
        double q[3][3], u[PATCH_NODES][7], f[PATCH_NODES][7], largest = 0, energy = 0;
        random_rotation(1.1, &seed, q);
        quad_shell_init(&shell, h, 1, 0.3);
        open_patch(&shell, part < 7 ? 0.09 : 0, (const double(*)[3])q);
        patch_forces(&shell, (const double(*)[3])q, part, u, f, &largest);
        const double most = 1e-10 * largest + rounding_of(&shell, u);
        for (int n = 0; n < PATCH_NODES; n++)
            for (int i = 0; i < 7; i++)
                energy += u[n][i] * f[n][i] / 2;
        if (part == 6)
            subtract_pressures(&shell, f);
        for (int n = INNER; n < PATCH_NODES; n++)
            for (int i = 0; i < (part < 7 ? 7 : 3); i++)
                if (!(fabs(f[n][i]) < most))
                    fail_msg("state %d: force %.3g of %.3g at node %d, dof %d", part, f[n][i],
                             largest, n, i);
        const double expected = patch_energy(part, h) * area * h;
        if (!(fabs(energy / expected - 1) < 1e-10))
            fail_msg("state %d: energy %.17g of %.17g", part, energy, expected);
        quad_shell_close(&shell);
    }
}

/* Two equal layers; the lower one is poled against the upper one if `bends`. */
static void set_piezo(quad_shell *shell, double d31, bool bends)
{
    shell->material[0].has_d = true;
    shell->material[0].d31 = shell->material[0].d32 = d31;
    shell->layer[0].thickness /= 2;
    shell->layer[1] = shell->layer[0];
    shell->layer[0].poling = bends ? -3 : 3;
    shell->scene.layers = 2;
}

/*
 * Law: a free patch under its actuation alone takes the free strain, or of two opposed layers the
 * free curvature 3 e/h, exactly: no force is left at any node, also on distorted elements.
 */
static void test_free_actuation(void **state)
{
    (void)state;
    for (int bends = 0; bends < 2; bends++) {
        quad_shell shell;
        unsigned seed = 21;
        double q[3][3], u[3][PATCH_NODES][7], f[3][PATCH_NODES][7], largest = 0, left = 0;
        const double h = patch_thickness, d31 = 1e-3, strain = -d31 / (h / 2);
        const double size = bends ? 3 * strain / h : strain;
        random_rotation(0.7, &seed, q);
        quad_shell_init(&shell, h, 1, 0.3);
        set_piezo(&shell, d31, bends);
        open_patch(&shell, 0.09, (const double(*)[3])q);
        const int first = bends ? 3 : 0;
        /* Stretches thin the plate elastically, free strains do not: state 6 takes that back. */
        const int states[3] = {first, first + 1, 6};
        for (int k = 0; k < 3; k++)
            patch_forces(&shell, (const double(*)[3])q, states[k], u[k], f[k], &largest);
        const double back = bends ? 0 : 2 * 0.3 / 0.7;
        for (int e = 0; e < 5; e++)
            for (int ply = 0; ply < 2; ply++) {
                const int type = shell.mesh.element_type[e];
                double h0[10], force[28];
                laminate_unit_resultants(&shell.mesh.laminate, &shell.scene.element,
                                         &shell.mesh.place[type], ply, h0);
                pzs_shell_prescribed_force(&shell.mesh.type[type], 7, h0, force);
                for (int i = 0; i < 28; i++)
                    f[0][patch_element[e][i / 7]][i % 7] -= force[i] / size;
            }
        double most = 1e-10 * largest;
        for (int k = 0; k < 3; k++)
            most += rounding_of(&shell, u[k]);
        for (int n = 0; n < PATCH_NODES; n++)
            for (int i = 0; i < 7; i++)
                left = fmax(left, fabs(f[0][n][i] + f[1][n][i] + back * f[2][n][i]));
        if (!(left < most))
            fail_msg("bends %d: force %.3g of %.3g is left", bends, left, largest);
        quad_shell_close(&shell);
    }
}

/* ---- refusals ------------------------------------------------------------- */

static const double upward[3] = {0, 0, 1}, along1[3] = {1, 0, 0};

static void flat_map(const void *data, double s, double t, double x[3], double d[3])
{
    const double *size = data;
    x[0] = size[0] * s;
    x[1] = size[1] * t;
    x[2] = 0;
    memcpy(d, upward, sizeof upward);
}

static void open_flat(quad_shell *shell)
{
    static const double size[2] = {2, 2};
    quad_shell_init(shell, 0.01, 1, 0.3);
    quad_shell_block(shell, 2, 2, flat_map, size, 0, 1);
}

/* The mesh is refused, and the message contains `part`. */
static void assert_refused(quad_shell *shell, const char *part)
{
    assert_int_equal(quad_shell_build(shell, along1), -1);
    if (!strstr(shell->error, part))
        fail_msg("'%s' is not in: %s", part, shell->error);
    quad_shell_close(shell);
}

/* Law: a mesh that the element cannot take is refused, and the message says what is wrong where. */
static void test_refusals(void **state)
{
    (void)state;
    quad_shell shell;
    open_flat(&shell);
    memcpy(shell.quads.position[shell.quads.element[0][2]], (double[3]){0.02, 0.02, 0},
           3 * sizeof(double));
    assert_refused(&shell, "element 0 is nearly a triangle");
    open_flat(&shell);
    memcpy(shell.quads.director[4], (double[3]){0.9, 0, 0.43589}, 3 * sizeof(double));
    assert_refused(&shell, "a director of element 0 is 64 degrees off its normal");
    open_flat(&shell);
    shell.quads.position[4][0] = (double)NAN;
    assert_refused(&shell, "element 0 has no extent");
    open_flat(&shell);
    memcpy(shell.quads.element[1], shell.quads.element[0], sizeof *shell.quads.element);
    assert_refused(&shell, "outer faces on different sides");
    open_flat(&shell);
    memcpy(shell.quads.element[1], shell.quads.element[0], sizeof *shell.quads.element);
    memcpy(shell.quads.element[2], shell.quads.element[0], sizeof *shell.quads.element);
    assert_refused(&shell, "at most two may share an edge");
    open_flat(&shell);
    shell.scene.element = (scene_element){0, 0, 0, 0, 0, 0, 0, 7, 0, 0};
    assert_refused(&shell, "the published element needs a mesh along lines of curvature");
}

static void cylinder_map(const void *data, double s, double t, double x[3], double d[3])
{
    const double *radius = data, angle = 1.5 * t;
    d[0] = 0;
    d[1] = sin(angle);
    d[2] = cos(angle);
    x[0] = s * *radius;
    x[1] = *radius * d[1];
    x[2] = *radius * d[2];
    const double outward[3] = {0, d[1], d[2]};
    memcpy(d, outward, sizeof outward);
}

/*
 * Law: a thin curved shell on a rough mesh is refused unless irregular meshes are accepted, which
 * is then reported; the same shell on a smooth mesh is taken. Thicker shells may be rough.
 */
static void test_thin_irregular(void **state)
{
    (void)state;
    static const double radius = 1;
    static const struct {
        double h, distortion;
        bool accept, is_refused;
    } row[] = {
        {1e-4, 0.35, false, true},
        {1e-4, 0.35, true, false},
        {1e-4, 0, false, false},
        {2e-3, 0.35, false, false},
    };
    for (int k = 0; k < 4; k++) {
        quad_shell shell;
        quad_shell_init(&shell, row[k].h, 1, 0.3);
        shell.accept_irregular = row[k].accept;
        quad_shell_block(&shell, 6, 6, cylinder_map, &radius, row[k].distortion, 7);
        if (row[k].is_refused) {
            assert_refused(&shell, "accept_irregular: true");
            continue;
        }
        if (quad_shell_build(&shell, along1) < 0)
            fail_msg("%s", shell.error);
        assert_int_equal(shell.mesh.quad_report.locking > 0, row[k].accept);
        quad_shell_close(&shell);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_oracle),         cmocka_unit_test(test_six_zero_modes),
        cmocka_unit_test(test_rigid_rotation), cmocka_unit_test(test_tangent_is_derivative),
        cmocka_unit_test(test_patch),          cmocka_unit_test(test_free_actuation),
        cmocka_unit_test(test_refusals),       cmocka_unit_test(test_thin_irregular),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
