/*
 * Oblique rigid supports: frame invariance, statically determinate mounts, conical seats, limit of
 * stiff springs, refusals.
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
#include "../../host_tools/model/vibration.h"
#include "../../host_tools/quads/vector.h"
#include "../../lib/model/model.h"
#include "../rigs/scene_assert.h"

#define FREE_PLATE "tests/rigs/scenes/spring-plate.yaml"
#define DISC "tests/rigs/scenes/spring-disc.yaml"
#define HEAT "loads=[{temperature: 100}];"

enum { TEXT = 4096 };

/* Directions of the supports and of the load of the structure that is turned in space. */
enum { GROOVE_A, GROOVE_B, ALONG_C, ALONG_D, LOAD, DIRECTIONS };
static const double direction[DIRECTIONS][3] = {
    {1, 0.3, 0.5}, {-0.5, 0.8, 0.4}, {0.3, 0.2, 1}, {1, -1, 2}, {300, -200, 500}};

/* ---- a structure that is turned in space ------------------------------------- */

/* Compute the matrix of the rotation by an angle (rad) about a unit vector. */
static void rotation_about(const double axis[3], double angle, double matrix[3][3])
{
    const double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int k = 3 - i - j;
            const double sign = (j - i + 3) % 3 == 1 ? -1 : 1;
            matrix[i][j] = axis[i] * axis[j] * (1 - c) + (i == j ? c : sign * s * axis[k]);
        }
}

static void turn_vector(const double matrix[3][3], const double vector[3], double turned[3])
{
    for (int i = 0; i < 3; i++)
        turned[i] = vector_dot(matrix[i], vector);
}

/*
 * Write the changes of the scene FREE_PLATE that make it a saddle on two grooves and two oblique
 * supports under a force, all of it turned by a rotation.
 */
static void write_turned(const double matrix[3][3], const char *kinematics, char text[TEXT])
{
    double turned[DIRECTIONS][3];
    int at = snprintf(text, TEXT, "kinematics=%s;surface={type: formula", kinematics);
    for (int i = 0; i < 3; i++)
        at += snprintf(text + at, TEXT - (size_t)at,
                       ", %c: '%.17g*theta1+(%.17g)*theta2+(%.17g)*0.4*theta1*theta2'", "xyz"[i],
                       matrix[i][0], matrix[i][1], matrix[i][2]);
    for (int k = 0; k < DIRECTIONS; k++)
        turn_vector(matrix, direction[k], turned[k]);
    at += snprintf(text + at, TEXT - (size_t)at, "};loads=[");
    for (int i = 0; i < 3; i++)
        at += snprintf(text + at, TEXT - (size_t)at,
                       "%s{point: {theta1: 0.75, theta2: 0.5}, %c: %.17g}", i ? ", " : "", "xyz"[i],
                       turned[LOAD][i]);
    at += snprintf(text + at, TEXT - (size_t)at, "];outputs=[");
    for (int i = 0; i < 3; i++)
        at += snprintf(text + at, TEXT - (size_t)at,
                       "%s{name: %c, %c: mean, at: {theta1: 1, theta2: 1}}, {name: s%c, %c: mean, "
                       "at: {theta1: 0.75, theta2: 0}}",
                       i ? ", " : "", "xyz"[i], "xyz"[i], "xyz"[i], "xyz"[i]);
    static const char *const fix[4] = {"across", "across", "along", "along"};
    static const char *const place[4] = {"theta1: 0, theta2: 0", "theta1: 0.75, theta2: 0",
                                         "theta1: 0.5, theta2: 1", "theta1: 0.25, theta2: 0.75"};
    at += snprintf(text + at, TEXT - (size_t)at, "];supports=[");
    for (int k = 0; k < LOAD; k++)
        at += snprintf(text + at, TEXT - (size_t)at,
                       "%s{at: {%s}, fix: %s, direction: [%.17g, %.17g, %.17g]}", k ? ", " : "",
                       place[k], fix[k], turned[k][0], turned[k][1], turned[k][2]);
    assert_true(at + 2 < TEXT);
    strcat(text, "]");
}

static const double none[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/*
 * Solve the saddle and read the displacements of its free corner and of a node in a groove
 * (moved [2][3] out).
 */
static void solve_turned(const double matrix[3][3], const char *kinematics, double moved[2][3])
{
    char text[TEXT];
    scene_run r;
    write_turned(matrix, kinematics, text);
    solve_run(&r, FREE_PLATE, text);
    assert_int_equal(r.analysis.design.mesh.turns, 4);
    for (int i = 0; i < 6; i++)
        moved[i % 2][i / 2] = scene_run_value(&r, i);
    scene_run_close(&r);
}

/*
 * Law: a structure that is turned in space with its supports and loads has the same displacements,
 * turned, at small and at large displacements. In a groove the displacement is along the groove.
 */
static void test_turned_structure(void **state)
{
    (void)state;
    static const char *const kinematics[2] = {"linear", "nonlinear"};
    const double axis[3] = {2.0 / 7, 3.0 / 7, -6.0 / 7};
    for (int kind = 0; kind < 2; kind++) {
        double moved[2][3];
        solve_turned(none, kinematics[kind], moved);
        const double size = vector_length(moved[0]);
        double across[3];
        vector_cross(moved[1], direction[GROOVE_B], across);
        assert_true(vector_length(moved[1]) > 1e-3 * size);
        assert_true(vector_length(across) < 1e-12 * vector_length(moved[1]));
        for (int k = 1; k <= 3; k++) {
            double matrix[3][3], turned[2][3], expected[3];
            rotation_about(axis, 1.1 * k, matrix);
            solve_turned((const double(*)[3])matrix, kinematics[kind], turned);
            for (int node = 0; node < 2; node++) {
                turn_vector((const double(*)[3])matrix, moved[node], expected);
                assert_true(vector_distance(turned[node], expected) < 1e-10 * size);
            }
        }
    }
}

/* Law: the natural frequencies of a structure do not depend on how it is turned in space. */
static void test_turned_modes(void **state)
{
    (void)state;
    const double axis[3] = {2.0 / 7, 3.0 / 7, -6.0 / 7};
    double square[2][4], matrix[3][3];
    rotation_about(axis, 1.1, matrix);
    for (int k = 0; k < 2; k++) {
        char text[TEXT], error[SCENE_ERROR] = "";
        scene_run r;
        vibration modes;
        write_turned(k ? (const double(*)[3])matrix : none, "linear", text);
        open_run(&r, FREE_PLATE, text);
        if (vibration_solve(&modes, &r.analysis.design, 4, 0, error) < 0)
            fail_msg("%s", error);
        assert_int_equal(modes.rigid, 0);
        memcpy(square[k], modes.square, sizeof square[k]);
        vibration_free(&modes);
        scene_run_close(&r);
    }
    for (int i = 0; i < 4; i++)
        assert_near("frequency", square[0][i], square[1][i], 1e-9);
}

/* ---- free thermal expansion ----------------------------------------------------- */

/* Mean displacement of a node as a vector in space. */
static void displacement_of(const scene_run *r, int node, double moved[3])
{
    const mesh *mesh = &r->analysis.design.mesh;
    double mean[3];
    for (int a = 0; a < 3; a++) {
        const uint16_t dof = mesh->node_dof[(size_t)node * mesh->dof_per_node + (size_t)a];
        mean[a] = dof == PZS_CONSTRAINED ? 0 : r->u[dof];
    }
    mesh_turn_to_triad(mesh, node, mean);
    for (int i = 0; i < 3; i++)
        moved[i] = mean[0] * mesh->point[node].triad[0][i] +
                   mean[1] * mesh->point[node].triad[1][i] +
                   mean[2] * mesh->point[node].triad[2][i];
}

/*
 * Largest difference between the strain of a line from corner to corner of an element and the free
 * thermal strain, relative to the thermal strain, over all sides and diagonals of all elements.
 */
static double excess_of(const char *name, const char *changes)
{
    scene_run r;
    solve_run(&r, name, changes);
    const mesh *mesh = &r.analysis.design.mesh;
    double most = 0;
    for (int e = 0; e < mesh->elements; e++)
        for (int k = 0; k < 16; k++) {
            const int own = mesh->element[e][k % 4], other = mesh->element[e][k / 4];
            double u[2][3], step[3], stretch[3];
            displacement_of(&r, own, u[0]);
            displacement_of(&r, other, u[1]);
            for (int i = 0; i < 3; i++) {
                step[i] = mesh->point[other].position[i] - mesh->point[own].position[i];
                stretch[i] = u[1][i] - u[0][i];
            }
            if (own != other)
                most = fmax(
                    most,
                    fabs(vector_dot(step, stretch) / vector_dot(step, step) / (1.2e-5 * 100) - 1));
        }
    scene_run_close(&r);
    return most;
}

/*
 * Law: three grooves at 120 degrees, whatever their slope, hold a structure by six displacements,
 * so that it expands without stress: a plate, and a disc from a mesh file. A shallow panel keeps
 * what its elements leave of the thermal strain, as on soft springs.
 */
static void test_grooves(void **state)
{
    (void)state;
    const char *const plate =
        HEAT "supports=[{at: {theta1: 0.5, theta2: 1}, fix: across, direction: [0, 1, 0.3]}, {at: "
             "{theta1: 0, theta2: 0.25}, fix: across, direction: [-0.866025403784, -0.5, -0.2]}, "
             "{at: {theta1: 1, theta2: 0.25}, fix: across, direction: [0.866025403784, -0.5, "
             "0.1]}];";
    const char *const disc = HEAT
        "springs=[];supports=[{at: {x: 0.5, y: 0, z: 0}, fix: across, direction: [1, 0, 0.2]}, "
        "{at: {x: -0.5, y: 0, z: 0}, fix: across, direction: [-1, -0.5, 0.3]}, {at: {x: 0, y: 1, "
        "z: 0}, fix: across, direction: ['x', 'y', 0.4]}]";
    char panel[TEXT];
    assert_true(excess_of(FREE_PLATE, plate) < 1e-10);
    assert_true(excess_of(DISC, disc) < 1e-10);
    snprintf(panel, sizeof panel, "%ssurface={type: cylinder, radius: 0.8, axial: theta1}", plate);
    const double held = excess_of(FREE_PLATE, panel);
    const double soft =
        excess_of(FREE_PLATE,
                  HEAT "surface={type: cylinder, radius: 0.8, axial: theta1};springs=[{at: nodes, "
                       "along: x, stiffness: 1, per: area}, {at: nodes, along: y, stiffness: 1, "
                       "per: area}, {at: nodes, along: z, stiffness: 1, per: area}]");
    assert_true(fabs(held - soft) < 1e-9);
}

/*
 * Law: a flat ring whose edges lie on two conical seats slides along them when it is heated. Where
 * the seats have a common apex, the free expansion about the apex keeps both edges on their seats,
 * so that the ring has no stress. A cylindrical wall instead of the inner seat stresses the ring.
 */
static void test_conical_seats(void **state)
{
    (void)state;
    const char *const ring =
        HEAT "outputs=[];surface={type: polar};mesh.theta1={from: 0.5, to: 1, elements: 2};"
             "mesh.theta2={from: 0, to: 6.283185307179586, elements: 12};supports=[{edge: theta1+, "
             "fix: along, direction: ['0.7*x', '0.7*y', '-(x^2+y^2)']}, {edge: theta1-, fix: "
             "along, direction: %s}, {at: {theta1: 1, theta2: 0}, fix: "
             "u2 mean}]";
    char text[TEXT];
    snprintf(text, sizeof text, ring, "['0.7*x', '0.7*y', '-(x^2+y^2)']");
    assert_true(excess_of(FREE_PLATE, text) < 1e-10);
    snprintf(text, sizeof text, ring, "['x', 'y', 0]");
    assert_true(excess_of(FREE_PLATE, text) > 1e-3);
}

/* ---- springs ---------------------------------------------------------------------- */

/*
 * Law: a rigid support is the limit of a stiff spring along its direction. The difference between
 * both is inversely proportional to the stiffness.
 */
static void test_stiff_spring(void **state)
{
    (void)state;
    static const char *const loads =
        "loads=[{point: {theta1: 1, theta2: 1}, z: 3}, {point: {theta1: 1, theta2: 1}, x: 5}];"
        "supports=[{edge: theta1-, fix: clamped}%s];springs=[%s]";
    static const char *const rigid =
        ", {edge: theta1+, fix: along, direction: [1, 0.2, 0.5]}, {at: {theta1: 0.5, theta2: 0}, "
        "fix: across, direction: [0, 1, 1]}";
    double moved[3];
    for (int k = 0; k < 3; k++) {
        char text[TEXT], springs[512];
        const double stiffness = k == 1 ? 1e12 : 1e13;
        scene_run r;
        snprintf(springs, sizeof springs,
                 "{edge: theta1+, along: [1, 0.2, 0.5], stiffness: %g}, {at: {theta1: 0.5, theta2: "
                 "0}, along: [0, 1, -1], stiffness: %g}, {at: {theta1: 0.5, theta2: 0}, along: x, "
                 "stiffness: %g}",
                 stiffness, stiffness, stiffness);
        snprintf(text, sizeof text, loads, k ? "" : rigid, k ? springs : "");
        solve_run(&r, FREE_PLATE, text);
        moved[k] = scene_run_value(&r, 2);
        scene_run_close(&r);
    }
    assert_near("stiff", moved[2], moved[0], 1e-2);
    assert_near("limit", (moved[1] - moved[0]) / (moved[2] - moved[0]), 10, 2e-2);
}

/* ---- directions at one node ---------------------------------------------------------- */

/* Displacement of the first output, and the number of nodes with rotated axes. */
static double first_output(const char *changes, int *turns)
{
    scene_run r;
    solve_run(&r, FREE_PLATE, changes);
    const double value = scene_run_value(&r, 0);
    *turns = r.analysis.design.mesh.turns;
    scene_run_close(&r);
    return value;
}

/*
 * Law: what a node is held by is the space of its directions, however many supports name them:
 * three directions are a cone, a repeated direction counts once, and directions along the axes of
 * the triad need no rotated axes.
 */
static void test_same_space(void **state)
{
    (void)state;
#define EDGE                                                                                       \
    "loads=[{point: {theta1: 0, theta2: 0}, z: 3}];supports=[{edge: theta1+, fix: clamped}, "
#define AT "{at: {theta1: 0.5, theta2: 0}, fix: "
    static const struct {
        const char *first, *second;
        int turns;
    } equal[] = {
        {EDGE AT "cone}]",
         EDGE AT "along, direction: [1, 0, 1]}, " AT "across, direction: [1, 0, 1]}]", 0},
        {EDGE AT "cone}]", EDGE AT "vee}, " AT "along, direction: [0, 3, 1]}]", 0},
        {EDGE AT "along, direction: [1, 2, 1]}]",
         EDGE AT "along, direction: [1, 2, 1]}, " AT "along, direction: [-2, -4, -2]}]", 1},
        {EDGE AT "flat}]", EDGE AT "along, direction: [0, 0, -2]}]", 0},
        {EDGE AT "vee}]", EDGE AT "across, direction: [0, 1, 0]}]", 0},
        {EDGE AT "across, direction: [1, 2, 1]}]",
         EDGE AT "along, direction: [2, -1, 0]}, " AT "along, direction: [0, 1, -2]}]", 1},
    };
    for (size_t k = 0; k < sizeof equal / sizeof *equal; k++) {
        int turns;
        const double first = first_output(equal[k].first, &turns);
        assert_near("displacement", first_output(equal[k].second, &turns), first, 1e-11);
        assert_int_equal(turns, equal[k].turns);
    }
}

/* ---- the library ----------------------------------------------------------------------- */

/*
 * Law: tables without stiffness matrices give the same influence matrix, because the library
 * computes each matrix from its element type, along the rotated axes.
 */
static void test_compact(void **state)
{
    (void)state;
    char text[TEXT];
    scene_run r;
    write_turned(none, "linear", text);
    solve_run(&r, FREE_PLATE, text);
    const pzs_model *first = &r.analysis.model;
    pzs_structure structure = r.analysis.design.structure;
    structure.stiffness = NULL;
    structure.crc = pzs_structure_crc(&structure);
    const size_t bytes = PZS_MODEL_BYTES(
        structure.free_dof, mesh_envelope(&r.analysis.design.mesh) + 64.0 * structure.free_dof);
    void *work = malloc(bytes);
    double *u = calloc(structure.free_dof, sizeof *u);
    pzs_model model;
    assert_int_equal(pzs_model_init(&model, &structure, work, bytes), PZS_OK);
    assert_int_equal(pzs_assemble(&model, NULL, NULL), PZS_OK);
    assert_int_equal(pzs_factor(&model), PZS_OK);
    assert_int_equal(pzs_solve(&model, r.analysis.input_value, u), PZS_OK);
    assert_near("condition", model.info.condition, first->info.condition, 1e-6);
    double most = 0, worst = 0;
    for (int i = 0; i < structure.free_dof; i++) {
        most = fmax(most, fabs(r.u[i]));
        worst = fmax(worst, fabs(u[i] - r.u[i]));
    }
    assert_true(worst < 1e-12 * most);
    free(u);
    free(work);
    scene_run_close(&r);
}

/* Law: tables whose rotations are out of range or absent are refused. */
static void test_damaged(void **state)
{
    (void)state;
    char text[TEXT];
    scene_run r;
    double work[1];
    pzs_model model;
    write_turned(none, "linear", text);
    open_run(&r, FREE_PLATE, text);
    const pzs_structure whole = r.analysis.design.structure;
    pzs_structure bad = whole;
    bad.turns = 3;
    bad.crc = pzs_structure_crc(&bad);
    assert_int_equal(pzs_model_init(&model, &bad, work, sizeof work), PZS_E_ARGUMENT);
    bad = whole;
    bad.turn = NULL;
    assert_int_equal(pzs_model_init(&model, &bad, work, sizeof work), PZS_E_ARGUMENT);
    bad = whole;
    bad.node_turn = NULL;
    assert_int_equal(pzs_model_init(&model, &bad, work, sizeof work), PZS_E_ARGUMENT);
    bad = whole;
    bad.turns = 0xFFFF;
    assert_int_equal(pzs_model_init(&model, &bad, work, sizeof work), PZS_E_ARGUMENT);
    bad = whole;
    bad.turns = 0;
    assert_int_equal(pzs_model_init(&model, &bad, work, sizeof work), PZS_E_CRC);
    assert_int_equal(pzs_model_init(&model, &whole, work, sizeof work), PZS_E_WORKSPACE);
    scene_run_close(&r);
}

/* ---- refusals ---------------------------------------------------------------------------- */

static void test_refusals(void **state)
{
    (void)state;
    static const refusal bad[] = {
        {AT "along}", "need a direction"},
        {AT "along, direction: [0, 0, 0]}", "has no direction"},
        {AT "along, direction: ['x-0.5', 'y', 0]}", "no finite vector other than zero"},
        {AT "along, direction: ['log(y)', 0, 1]}", "no finite vector other than zero"},
        {AT "along, direction: [1, 'x']}", "three"},
        {AT "u1 mean, direction: ['x', 1, 0]}", "formulas as direction need"},
        {AT "[along, x], direction: [1, 1, 0]}", "a direction of a mesh from a file"},
        {AT "across, direction: [1, 1, 0], value: 1}", "single displacement"},
        {AT "along, direction: [1, 0, 1]}, " AT "along, direction: [1, 0.001, 1]}",
         "deviates by 0.041 degrees"},
        {AT "vee}, " AT "along, direction: [1, 0.001, 1]}", "deviates by 0.041 degrees"},
        {AT "u1 mean, value: 0.1}, " AT "along, direction: [1, 0, 0]}", "other supports prescribe"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[TEXT];
        scene_run r;
        snprintf(text, sizeof text,
                 "kinematics=nonlinear;supports=[{edge: theta1+, fix: clamped}, %s]", bad[i].set);
        if (scene_run_open(&r, FREE_PLATE, text) == 0 || !strstr(r.error, bad[i].expected))
            fail_msg("%s: expected '%s', got '%s'", bad[i].set, bad[i].expected, r.error);
        scene_run_close(&r);
    }
    scene_run r;
    assert_true(scene_run_open(&r, DISC,
                               "supports=[{at: {x: 0.5, y: 0, z: 0}, fix: [along, z], direction: "
                               "[1, 0, 1]}]") < 0);
    assert_non_null(strstr(r.error, "do not share a direction"));
    scene_run_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_turned_structure), cmocka_unit_test(test_turned_modes),
        cmocka_unit_test(test_grooves),          cmocka_unit_test(test_conical_seats),
        cmocka_unit_test(test_stiff_spring),     cmocka_unit_test(test_same_space),
        cmocka_unit_test(test_compact),          cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
