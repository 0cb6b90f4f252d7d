/*
 * Springs, stacks and kinematic supports: closed forms, energy, reactions, refusals.
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
#include "../../host_tools/mesh/springs.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/plausible.h"
#include "../../host_tools/model/spring_forces.h"
#include "../../host_tools/model/vibration.h"
#include "../../host_tools/quads/vector.h"
#include "../rigs/scene_assert.h"

#define FREE_PLATE "tests/rigs/scenes/spring-plate.yaml"

/* Springs in the plane of a square plate of side 1, which stop its in-plane rigid motions. */
#define IN_PLANE                                                                                   \
    "{at: {theta1: 0, theta2: 0}, along: [1, 1, 0], stiffness: 1e7}, "                             \
    "{at: {theta1: 1, theta2: 0}, along: [-1, 1, 0], stiffness: 1e7}, "                            \
    "{at: {theta1: 0, theta2: 1}, along: x, stiffness: 1e7}"

/* Springs in the plane of a square plate of side 1.4, which stop its in-plane rigid motions. */
#define IN_PLANE_WIDE                                                                              \
    "{at: {theta1: 0, theta2: 0}, along: [1, 1, 0], stiffness: 1e7}, "                             \
    "{at: {theta1: 1.4, theta2: 0}, along: [-1, 1, 0], stiffness: 1e7}, "                          \
    "{at: {theta1: 0, theta2: 1.4}, along: x, stiffness: 1e7}"

static const double pi = 3.141592653589793;

/* Force of the first spring of an item on the structure. */
static double force_of(const scene_run *r, int item)
{
    const design *design = &r->analysis.design;
    return spring_force(design, design->mesh.springs.first[item], r->u, r->analysis.input_value);
}

/*
 * Displacement of the first output of a scene under its loads; under a unit load the compliance
 * there.
 */
static double first_output(const char *name, const char *changes)
{
    scene_run r;
    solve_run(&r, name, changes);
    const double value = scene_run_value(&r, 0);
    scene_run_close(&r);
    return value;
}

/* ---- rigid bodies ---------------------------------------------------------- */

/*
 * Law: a plate on three springs carries a load by statics alone, and its surface is the plane
 * through the tops of the springs, whose elongations are force over stiffness. The springs stand
 * between nodes. The linear and the nonlinear solution agree, because the motion is tiny.
 */
static void test_three_springs(void **state)
{
    (void)state;
    static const char *const kinematics[2] = {"linear", "nonlinear"};
    const double third = 0.4 / 0.83, first = (1 - third) / 2;
    const double u[3] = {-1e-6 * first, -1e-6 * first / 2, -1e-6 * third / 3};
    const double by_x = (u[1] - u[0]) / 0.8, by_y = (u[2] - (u[0] + u[1]) / 2) / 0.83;
    const double corner = u[0] - 0.1 * by_x - 0.1 * by_y;
    for (int k = 0; k < 2; k++) {
        scene_run r;
        char changes[1024];
        snprintf(changes, sizeof changes,
                 "kinematics=%s;loads=[{point: {theta1: 0.5, theta2: 0.5}, z: -1e-3}];springs=["
                 "{points: [[0.1, 0.1]], along: z, stiffness: 1000}, {points: [[0.9, 0.1]], along: "
                 "z, stiffness: 2000}, {points: [[0.5, 0.93]], along: z, stiffness: "
                 "3000}, " IN_PLANE "]",
                 kinematics[k]);
        solve_run(&r, FREE_PLATE, changes);
        assert_near("first spring", force_of(&r, 0), 1e-3 * first, 1e-8);
        assert_near("second spring", force_of(&r, 1), 1e-3 * first, 1e-8);
        assert_near("third spring", force_of(&r, 2), 1e-3 * third, 1e-8);
        /*
         * The plate itself bends by about F L^2/(16 D), with F the load, L the side and D the
         * bending stiffness: 1e-3 of the elongation of the springs.
         */
        assert_near("corner", scene_run_value(&r, 0), corner, 2e-3);
        assert_near("along x", scene_run_value(&r, 1), corner + by_x, 2e-3);
        assert_near("across", scene_run_value(&r, 2), corner + by_x + by_y, 2e-3);
        scene_run_close(&r);
    }
}

/*
 * Law: a rigid plate of mass m, side L and thickness h on four equal corner springs k heaves with
 * omega^2 = 4 k/m and rolls with omega^2 = 4 k (L/2)^2/(m (L^2 + h^2)/12), as far as the springs
 * are soft against the plate.
 */
static void test_soft_mount(void **state)
{
    (void)state;
    scene_run r;
    vibration modes;
    char error[SCENE_ERROR] = "";
    const double mass = 8000 * 0.02, heave = 4 * 10 / mass,
                 roll = 4 * 10 * 0.25 / (mass * (1 + 4e-4) / 12);
    open_run(&r, FREE_PLATE,
             "springs=[{points: [[0, 0], [1, 0], [0, 1], [1, 1]], along: u3, stiffness: "
             "10}, " IN_PLANE "]");
    if (vibration_solve(&modes, &r.analysis.design, 3, 0, error) < 0)
        fail_msg("%s", error);
    assert_near("heave", modes.square[0], heave, 1e-4);
    assert_near("roll about x", modes.square[1], roll, 1e-4);
    assert_near("roll about y", modes.square[2], roll, 1e-4);
    assert_int_equal(modes.rigid, 0);
    vibration_free(&modes);
    scene_run_close(&r);
}

/*
 * Law: a uniform pressure p on a foundation of stiffness k per area lifts a free plate by p/k and
 * does not bend it, at any size of the displacement, because the springs keep their direction. The
 * tolerance is epsilon times the stiffness of an element over that of the softest springs.
 */
static void test_uniform_foundation(void **state)
{
    (void)state;
    static const char *const kinematics[2] = {"linear", "nonlinear"};
    static const double stiffness[2] = {1e6, 10}; /* foundations whose displacements are 1e-5 and 1
                                                     plate width */
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 2; i++) {
            char changes[512];
            snprintf(changes, sizeof changes,
                     "kinematics=%s;loads=[{face: middle, z: 10}];springs=[{at: nodes, along: z, "
                     "stiffness: %g, per: area}, {at: nodes, along: x, stiffness: 1e6, per: area}, "
                     "{at: nodes, along: y, stiffness: 1e6, per: area}]",
                     kinematics[k], stiffness[i]);
            assert_near(kinematics[k], first_output(FREE_PLATE, changes), 10 / stiffness[i], 1e-6);
        }
}

/* ---- series and parallel ---------------------------------------------------- */

#define CLAMPED "supports=[{edge: theta1-, fix: clamped}];"
#define AT_CORNER "loads=[{point: {theta1: 1, theta2: 1}, z: 1}];"
#define CORNER "outputs=[{name: c, z: mean, at: {theta1: 1, theta2: 1}}];"

/*
 * Law: a spring of stiffness k beside a structure of compliance c gives the compliance 1/(1/c + k);
 * the stiffnesses of two springs at one node add, and so do their forces.
 */
static void test_parallel(void **state)
{
    (void)state;
    const double c = first_output(FREE_PLATE, CLAMPED AT_CORNER CORNER), k = 0.7 / c;
    char changes[512];
    scene_run r;
    snprintf(changes, sizeof changes,
             CLAMPED AT_CORNER CORNER
             "springs=[{at: {theta1: 1, theta2: 1}, along: z, stiffness: %.17g}, {at: {theta1: 1, "
             "theta2: 1}, along: u3, stiffness: %.17g}]",
             k, 2 * k);
    solve_run(&r, FREE_PLATE, changes);
    const double u = scene_run_value(&r, 0);
    assert_near("corner", u, 1 / (1 / c + 3 * k), 1e-10);
    assert_near("first spring", force_of(&r, 0), -k * u, 1e-12);
    assert_near("both springs", force_of(&r, 1), -2 * k * u, 1e-12);
    scene_run_close(&r);
}

/*
 * Law: a spring of stiffness k between two points of a structure changes the displacement u by -C n
 * (n'u)/(1/k + n'C n), where C is the compliance matrix of the structure and n takes the difference
 * of the two points. The spring and the structure between its ends are in series. The envelope of
 * the factor reaches from one end to the other.
 */
static void test_series(void **state)
{
    (void)state;
    const char *const both =
        "outputs=[{name: b, z: mean, at: {theta1: 1, theta2: 0}}, {name: c, z: mean, at: {theta1: "
        "1, theta2: 1}}];";
    const char *const set[3] = {AT_CORNER, "loads=[{point: {theta1: 1, theta2: 0}, z: 1}];", ""};
    double c[2][2], moved[2];
    for (int k = 0; k < 3; k++) {
        char changes[512];
        scene_run r;
        snprintf(changes, sizeof changes, CLAMPED "%s%s%s", both, k < 2 ? set[k] : AT_CORNER,
                 k < 2 ? ""
                       : "springs=[{at: {theta1: 1, theta2: 1}, to: {theta1: 1, theta2: 0}, along: "
                         "z, stiffness: 1e5}]");
        solve_run(&r, FREE_PLATE, changes);
        for (int i = 0; i < 2; i++)
            *(k < 2 ? &c[k][i] : &moved[i]) = scene_run_value(&r, i);
        if (k == 2)
            assert_near("force", force_of(&r, 0), -1e5 * (moved[1] - moved[0]), 1e-12);
        scene_run_close(&r);
    }
    const double n[2] = {c[1][0] - c[0][0], c[1][1] - c[0][1]}; /* -C n at both points, with C the
                                                                   compliance matrix and n the
                                                                   difference of the points */
    const double through = (c[0][1] - c[0][0]) / (1e-5 + n[0] - n[1]);
    assert_near("near end", moved[1], c[0][1] + n[1] * through, 1e-9);
    assert_near("far end", moved[0], c[0][0] + n[0] * through, 1e-9);
}

/* ---- stacks ------------------------------------------------------------------ */

/*
 * Law: a stack of stiffness k and free stroke s V against a structure of stiffness 1/c moves the
 * structure by s V k/(k + 1/c). A stack that is given by its force f per volt alone has no
 * stiffness and moves the structure by c f V.
 */
static void test_stack_stroke(void **state)
{
    (void)state;
    const double c = first_output(FREE_PLATE, CLAMPED AT_CORNER CORNER), k = 2.5 / c;
    char changes[512];
    scene_run r;
    snprintf(changes, sizeof changes,
             CLAMPED CORNER "actuators=[{name: s, stacks: {at: {theta1: 1, theta2: 1}, along: z, "
                            "stiffness: %.17g, stroke: 1e-7}, applied: 30}]",
             k);
    solve_run(&r, FREE_PLATE, changes);
    const double moved = 30e-7 * k / (k + 1 / c);
    assert_near("stroke", scene_run_value(&r, 0), moved, 1e-10);
    assert_near("force", force_of(&r, 0), moved / c, 1e-9);
    scene_run_close(&r);
    assert_near("voice coil",
                first_output(FREE_PLATE,
                             CLAMPED CORNER "actuators=[{name: s, stacks: {at: {theta1: 1, theta2: "
                                            "1}, along: z, force: 5}, applied: 3}]"),
                15 * c, 1e-10);
}

/*
 * Law: stacks with equal forces per volt have a symmetric influence matrix at their own points
 * (Maxwell and Betti), also at a nonlinear equilibrium.
 */
static void test_reciprocity(void **state)
{
    (void)state;
    static const char *const kinematics[2] = {"linear", "nonlinear"};
    for (int k = 0; k < 2; k++) {
        char changes[1024], error[SCENE_ERROR] = "";
        scene_run r;
        snprintf(changes, sizeof changes,
                 "kinematics=%s;" CLAMPED
                 "target={z: mean, at: {theta1: [0.5, 1], theta2: [0, 0.5]}, value: x};"
                 "actuators=[{name: s, stacks: {points: [[0.5, 0], [0.5, 0.25], [0.5, 0.5], [0.75, "
                 "0], [0.75, 0.25], [0.75, 0.5], [1, 0], [1, 0.25], [1, 0.5]], along: z, "
                 "stiffness: 1e6, stroke: 1e-6}, applied: 1000}]",
                 kinematics[k]);
        solve_run(&r, FREE_PLATE, changes);
        const pzs_structure *structure = &r.analysis.design.structure;
        const size_t n = structure->input.count;
        double *influence = calloc(n * structure->output.count, sizeof *influence);
        assert_non_null(influence);
        const pzs_status status = k ? pzs_influence_at(&r.analysis.equilibrium.solver, influence)
                                    : pzs_influence(&r.analysis.model, influence);
        assert_int_equal(status, PZS_OK);
        for (size_t i = 0; i < 9; i++)
            for (size_t j = 0; j < i; j++)
                assert_near("influence", influence[i * n + j], influence[j * n + i], 1e-9);
        assert_string_equal(error, "");
        free(influence);
        scene_run_close(&r);
    }
}

/*
 * Kelvin's function kei(x) = Im K0(x (1 + i)/sqrt(2)), by the integral of exp(-x (1 + i)/sqrt(2)
 * cosh t) over t from 0; the trapezoidal rule converges exponentially.
 */
static double kelvin(double x)
{
    const double step = 0.01, part = x / sqrt(2);
    double sum = 0;
    for (int i = 0; i < 4000; i++) {
        const double along = part * cosh(i * step);
        sum -= (i ? 1 : 0.5) * step * exp(-along) * sin(along);
    }
    return sum;
}

/*
 * Law (Hertz): a plate of bending stiffness D on many soft stacks of stiffness k at the pitch p
 * behaves as on a foundation of stiffness k/p^2 per area: one stack raises the plate by a multiple
 * of kei(r/l) at the distance r, with l = (D p^2/k)^(1/4). The influence function of the middle one
 * of 169 stacks agrees within 2 % of its height, on a lattice of pitch l/1.5 with two elements a
 * pitch.
 */
static void test_influence_width(void **state)
{
    (void)state;
    const double pitch = 0.1, length = 1.5 * pitch;
    const double bending = 2.1e11 * pow(0.005, 3) / 12 / (1 - 0.09);
    const double stiffness = bending * pitch * pitch / pow(length, 4);
    char *changes = malloc(4096);
    scene_run r;
    assert_non_null(changes);
    int at =
        snprintf(changes, 4096,
                 "mesh={theta1: {from: 0, to: 1.4, elements: 28}, theta2: {from: 0, to: 1.4, "
                 "elements: 28}};layers.0.thickness=0.005;springs=[" IN_PLANE_WIDE "];outputs=["
                 "{name: a, z: mean, at: {theta1: 0.7, theta2: 0.7}}, {name: b, z: mean, at: "
                 "{theta1: 0.8, theta2: 0.7}}, {name: c, z: mean, at: {theta1: 0.9, theta2: "
                 "0.7}}, {name: d, z: mean, at: {theta1: 0.9, theta2: 0.8}}];"
                 "actuators=[{name: s, stacks: {along: z, stiffness: %.17g, stroke: 1e-6, "
                 "points: [",
                 stiffness);
    for (int k = 0; k < 169; k++)
        at += snprintf(changes + at, 4096 - (size_t)at, "%s[%g,%g]", k ? "," : "",
                       pitch * (1 + k / 13), pitch * (1 + k % 13));
    at += snprintf(changes + at, 4096 - (size_t)at, "]}, applied: [");
    for (int k = 0; k < 169; k++)
        at += snprintf(changes + at, 4096 - (size_t)at, "%s%d", k ? "," : "", k == 84);
    snprintf(changes + at, 4096 - (size_t)at, "]}]");
    solve_run(&r, FREE_PLATE, changes);
    const double distance[4] = {0, 1, 2, sqrt(5)};
    const double top = stiffness * 1e-6 * length * length / bending / (2 * pi);
    for (int i = 0; i < 4; i++) {
        const double exact = -top * kelvin(fmax(distance[i] * pitch / length, 1e-9));
        const double value = scene_run_value(&r, i);
        print_message("  %.2f pitches from the stack: %.4f of the stroke, foundation %.4f\n",
                      distance[i], value / 1e-6, exact / 1e-6);
        assert_true(fabs(value - exact) < 0.02 * top * pi / 4);
    }
    free(changes);
    scene_run_close(&r);
}

/*
 * Law: the forces of springs and stacks balance the loads; without loads they balance one another.
 */
static void test_balance(void **state)
{
    (void)state;
    for (int loaded = 0; loaded < 2; loaded++) {
        char changes[1024];
        scene_run r;
        snprintf(changes, sizeof changes,
                 "loads=[{face: outer, z: %d}];springs=[{edge: theta2-, along: z, stiffness: 1e5, "
                 "per: length}, " IN_PLANE "];actuators=[{name: s, stacks: {points: [[0.3, 0.8], "
                 "[0.7, 0.9]], along: z, stiffness: 1e6, stroke: 1e-6}, applied: [100, -50]}]",
                 loaded * 40);
        solve_run(&r, FREE_PLATE, changes);
        const mesh_springs *springs = &r.analysis.design.mesh.springs;
        double sum = 0, size = 0;
        for (int row = 0; row < springs->count; row++) {
            const double force = spring_force(&r.analysis.design, row, r.u, r.analysis.input_value);
            const int in_plane = row >= springs->first[1] && row < springs->first[4];
            sum += in_plane ? 0 : force;
            size += fabs(force);
        }
        assert_true(fabs(sum + loaded * 40) < 1e-10 * size);
        scene_run_close(&r);
    }
}

/* ---- foundations -------------------------------------------------------------- */

/*
 * Deflection under the middle of a beam of length 2, width 0.1, thickness 0.002 and E = 2.1e11 on a
 * foundation of 1e5 N/m3, that carries 1 N in the middle. By symmetry one half is modelled, with a
 * number of elements along it.
 */
static double beam_on_foundation(int elements, const char *on_edges)
{
    char changes[1024];
    snprintf(changes, sizeof changes,
             "mesh={theta1: {from: 0, to: 1, elements: %d}, theta2: {from: 0, to: 0.1, elements: "
             "1}};materials.steel.nu=0;layers.0.thickness=0.002;"
             "supports=[{edge: theta1-, fix: symmetric}, {edge: theta2-, "
             "fix: u2}];loads=[{line: theta1-, z: 5}];outputs=[{name: w, z: mean, at: {theta1: 0, "
             "theta2: 0}}];springs=[%s]",
             elements, on_edges);
    return first_output(FREE_PLATE, changes);
}

/*
 * Law (Hetenyi): a force P in the middle of a free beam of length l and bending stiffness E I, on a
 * foundation of stiffness k per length, causes the deflection P b/(2 k) (2 + cosh(b l) + cos(b
 * l))/(sinh(b l) + sin(b l)), with b = (k/(4 E I))^(1/4). Springs at the nodes converge to this
 * deflection with the second order. Springs per area and springs per length on both edges are
 * equivalent.
 */
static void test_winkler_beam(void **state)
{
    (void)state;
    const double k = 1e5 * 0.1, bending = 2.1e11 * 0.1 * 8e-9 / 12;
    const double lambda = pow(k / (4 * bending), 0.25), l = 2 * lambda;
    const double exact = lambda / (2 * k) * (2 + cosh(l) + cos(l)) / (sinh(l) + sin(l));
    const char *const area = "{at: nodes, along: z, stiffness: 1e5, per: area}";
    const char *const edges = "{edge: theta2-, along: z, stiffness: 5e3, per: length}, {edge: "
                              "theta2+, along: z, stiffness: 5e3, per: length}";
    double error[3];
    for (int i = 0; i < 3; i++) {
        const double value = beam_on_foundation(16 << i, area);
        error[i] = value / exact - 1;
        assert_near("per length", beam_on_foundation(16 << i, edges), value, 1e-9);
    }
    print_message("  beam on foundation, 16, 32, 64 elements: %.4f %.4f %.4f of the exact one\n",
                  1 + error[0], 1 + error[1], 1 + error[2]);
    assert_true(fabs(error[2]) < 0.005);
    assert_true(fabs(error[0]) > 3 * fabs(error[1]) && fabs(error[1]) > 3 * fabs(error[2]));
}

/* Sum of the stiffness of all springs of an item. */
static double sum_of(const scene_run *r, int item)
{
    const mesh_springs *springs = &r->analysis.design.mesh.springs;
    double sum = 0;
    for (int row = springs->first[item]; row < springs->first[item + 1]; row++)
        sum += springs->stiffness[row];
    return sum;
}

#define DISC "tests/rigs/scenes/spring-disc.yaml"

/*
 * Law: on a mesh from a file, the springs of a foundation per area add up to its stiffness times
 * the area of the elements, and springs per length of the rim to their stiffness times its length.
 */
static void test_shares(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, DISC,
             "springs=[{at: nodes, along: z, stiffness: 5, per: area}, {set: rim, along: z, "
             "stiffness: 5, per: length}, {at: nodes, along: x, stiffness: 1}, {at: nodes, along: "
             "y, stiffness: 1}, {set: ring2-1, along: z, stiffness: 8, per: area}]");
    const double chord = 32 * 2 * sin(pi / 32),
                 area = 16 * sin(2 * pi / 32); /* length and area of a regular polygon of 32 sides
                                                  in a circle of radius 1 */
    assert_near("rim", sum_of(&r, 1), 5 * chord, 1e-12);
    assert_near("area", sum_of(&r, 0), 5 * area, 1e-12);
    assert_near("set", sum_of(&r, 4), 8 * area * (1 - 0.25) / 4, 1e-12);
    scene_run_close(&r);
}

/*
 * Law: a spring in the direction n at any point X of a mesh from a file has the elongation n . (t +
 * w x X) under a rigid motion of translation t and rotation w.
 */
static void test_points(void **state)
{
    (void)state;
    static const double place[4][2] = {{0.11, 0.23}, {-0.4, 0.3}, {0.05, -0.93}, {0, 0}};
    scene_run r;
    open_run(&r, DISC,
             "springs=[{points: [[0.11, 0.23], [-0.4, 0.3, 0], [0.05, -0.93], [0, 0]], along: z, "
             "stiffness: 1}, {at: nodes, along: x, stiffness: 1}, {at: nodes, along: y, stiffness: "
             "1}]");
    const mesh *mesh = &r.analysis.design.mesh;
    for (int n = 0; n < mesh->nodes; n++)
        for (unsigned i = 0; i < 3; i++) {
            const double *x = mesh->point[n].position;
            const double z = 0.5 + 0.2 * x[1] - 0.3 * x[0];
            r.u[mesh->node_dof[(size_t)n * mesh->dof_per_node + i]] =
                z * mesh->point[n].triad[i][2];
        }
    for (int k = 0; k < 4; k++)
        assert_near("point", springs_elongation(&mesh->springs, k, r.u),
                    0.5 + 0.2 * place[k][1] - 0.3 * place[k][0], 1e-12);
    scene_run_close(&r);
}

/*
 * Law: under a rotation w about y the outer face of a plate of thickness h moves by w h/2 along x,
 * which is the elongation of a spring along x on that face; a spring on the mean of both faces is
 * not elongated.
 */
static void test_face(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, DISC,
             "springs=[{at: {x: 0, y: 0, z: 0}, along: x, stiffness: 1, on: outer}, {at: {x: 0, y: "
             "0, z: 0}, along: x, stiffness: 1, on: inner}, {at: {x: 0, y: 0, z: 0}, along: x, "
             "stiffness: 1}, {at: nodes, along: z, stiffness: 1}, {at: nodes, along: y, stiffness: "
             "1}]");
    const mesh *mesh = &r.analysis.design.mesh;
    const double turn[3] = {0, 0.125, 0};
    for (int n = 0; n < mesh->nodes; n++)
        for (unsigned i = 0; i < 3; i++) {
            const surface_point *point = &mesh->point[n];
            double lean[3];
            vector_cross(turn, point->triad[2], lean);
            r.u[mesh->node_dof[(size_t)n * mesh->dof_per_node + 3 + i]] =
                vector_dot(lean, point->triad[i]);
        }
    assert_near("outer", springs_elongation(&mesh->springs, 0, r.u), 0.125 * 0.01, 1e-12);
    assert_near("inner", springs_elongation(&mesh->springs, 1, r.u), -0.125 * 0.01, 1e-12);
    assert_true(fabs(springs_elongation(&mesh->springs, 2, r.u)) < 1e-15);
    scene_run_close(&r);
}

/* ---- kinematic supports --------------------------------------------------------- */

#define HEAT "loads=[{temperature: 100}];"

/* Mean displacement of a node as a vector in space. */
static void displacement_of(const scene_run *r, int node, double moved[3])
{
    const mesh *mesh = &r->analysis.design.mesh;
    for (int i = 0; i < 3; i++) {
        moved[i] = 0;
        for (int a = 0; a < 3; a++) {
            const uint16_t dof = mesh->node_dof[(size_t)node * mesh->dof_per_node + (size_t)a];
            moved[i] += dof == PZS_CONSTRAINED ? 0 : r->u[dof] * mesh->point[node].triad[a][i];
        }
    }
}

/*
 * Largest difference between the strain of a line from corner to corner of an element and the free
 * thermal strain, relative to the thermal strain, over all sides and diagonals of all elements.
 */
static double strain_excess(const scene_run *r)
{
    const mesh *mesh = &r->analysis.design.mesh;
    double most = 0;
    for (int e = 0; e < mesh->elements; e++)
        for (int k = 0; k < 16; k++) {
            const int own = mesh->element[e][k % 4], other = mesh->element[e][k / 4];
            double u[2][3], stretch = 0, square = 0;
            displacement_of(r, own, u[0]);
            displacement_of(r, other, u[1]);
            for (int i = 0; i < 3 && own != other; i++) {
                const double step = mesh->point[other].position[i] - mesh->point[own].position[i];
                stretch += step * (u[1][i] - u[0][i]);
                square += step * step;
            }
            if (own != other)
                most = fmax(most, fabs(stretch / square / (1.2e-5 * 100) - 1));
        }
    return most;
}

/*
 * Law: six springs that just stop the rigid motions let a plate expand freely: no force, and the
 * strain is alpha times the temperature everywhere. The directions are arbitrary.
 */
static void test_kinematic_springs(void **state)
{
    (void)state;
    scene_run r;
    solve_run(&r, FREE_PLATE,
              HEAT "springs=[{points: [[0.2, 0.2]], along: [1, 0.2, 1], stiffness: 1e8}, {points: "
                   "[[0.2, 0.2]], along: [-1, 0.2, 1], stiffness: 1e8}, {points: [[0.2, 0.2]], "
                   "along: [0, -1, 1], stiffness: 1e8}, {points: [[0.9, 0.1]], along: [0, 1, 1], "
                   "stiffness: 1e8}, {points: [[0.9, 0.1]], along: [0, -1, 1], stiffness: 1e8}, "
                   "{points: [[0.4, 0.8]], along: [0.1, 0, 1], stiffness: 1e8}]");
    for (int k = 0; k < 6; k++)
        assert_true(fabs(force_of(&r, k)) < 1e-9 * 1e8 * 1.2e-3); /* stiffness of a spring times the
                                                                     thermal expansion of the plate
                                                                   */
    assert_true(strain_excess(&r) < 1e-10);
    scene_run_close(&r);
}

#define PANEL "surface={type: cylinder, radius: 0.8, axial: theta1};"

/*
 * Largest relative difference between the strains of a heated structure and its free thermal
 * strain.
 */
static double excess_of(const char *scene, const char *changes)
{
    scene_run r;
    solve_run(&r, scene, changes);
    const double excess = strain_excess(&r);
    scene_run_close(&r);
    return excess;
}

/*
 * Law: a cone, a vee and a flat hold a structure by six displacements and let it expand as if it
 * were free: without stress on a plate and on a disc of a general mesh. On a cylindrical panel,
 * whose elements of 0.25 rad leave 1e-4 of the thermal strain, cone, vee and flat leave what soft
 * springs leave.
 */
static void test_kinematic_supports(void **state)
{
    (void)state;
    const char *const mount =
        HEAT "supports=[{at: {theta1: 0.25, theta2: 0}, fix: cone}, {at: {theta1: 0.75, theta2: "
             "0.25}, fix: vee, direction: [-1, 2, 0]}, {at: {theta1: 0.5, theta2: 1}, fix: flat}];";
    char changes[1024];
    assert_true(excess_of(FREE_PLATE, mount) < 1e-10);
    assert_true(excess_of(DISC, HEAT "springs=[];supports=[{at: {x: 0.5, y: 0, z: 0}, fix: cone}, "
                                     "{at: {x: -0.5, y: 0, z: 0}, fix: vee, direction: [0, 1, 0]}, "
                                     "{at: {x: 0, y: 1, z: 0}, fix: flat}]") < 1e-10);
    snprintf(changes, sizeof changes, "%s" PANEL, mount);
    const double held = excess_of(FREE_PLATE, changes);
    const double soft = excess_of(
        FREE_PLATE, HEAT PANEL "springs=[{at: nodes, along: x, stiffness: 1, per: area}, {at: "
                               "nodes, along: y, stiffness: 1, per: area}, {at: nodes, along: z, "
                               "stiffness: 1, per: area}]");
    assert_true(fabs(held - soft) < 1e-9);
}

/*
 * Law: a support with a direction holds the displacement along this direction and no other. A plate
 * on a cone, a vee and a flat moves under loads as on springs of nearly infinite stiffness that
 * hold the same six displacements.
 */
static void test_direction(void **state)
{
    (void)state;
    static const char *const held[2] = {
        "supports=[{at: {theta1: 0.25, theta2: 0}, fix: cone}, {at: {theta1: 0.75, theta2: 0.25}, "
        "fix: vee, direction: [-1, 2, 0]}, {at: {theta1: 0.5, theta2: 1}, fix: flat}]",
        "springs=[{at: {theta1: 0.25, theta2: 0}, along: x, stiffness: 1e15}, {at: {theta1: 0.25, "
        "theta2: 0}, along: y, stiffness: 1e15}, {at: {theta1: 0.25, theta2: 0}, along: z, "
        "stiffness: 1e15}, {at: {theta1: 0.75, theta2: 0.25}, along: [-1, 2, 0], stiffness: 1e15}, "
        "{at: {theta1: 0.75, theta2: 0.25}, along: z, stiffness: 1e15}, {at: {theta1: 0.5, theta2: "
        "1}, along: z, stiffness: 1e15}]"};
    double moved[2][4];
    for (int k = 0; k < 2; k++) {
        char changes[1024];
        scene_run r;
        snprintf(changes, sizeof changes,
                 "loads=[{point: {theta1: 1, theta2: 0}, z: 3}, {point: {theta1: 1, theta2: 1}, x: "
                 "5}];%s",
                 held[k]);
        solve_run(&r, FREE_PLATE, changes);
        for (int i = 0; i < 4; i++)
            moved[k][i] = scene_run_value(&r, i);
        scene_run_close(&r);
    }
    for (int i = 0; i < 4; i++)
        assert_near("corner", moved[0][i], moved[1][i], 1e-5);
}

/* Law: the reactions of six springs follow from statics, whatever their stiffness. */
static void test_determinate(void **state)
{
    (void)state;
    double force[2][6];
    for (int i = 0; i < 2; i++) {
        char changes[1024];
        scene_run r;
        snprintf(changes, sizeof changes,
                 "loads=[{point: {theta1: 0.25, theta2: 0.75}, z: -100}, {point: {theta1: 1, "
                 "theta2: 0.5}, x: 30}];springs=[{points: [[0.2, 0.2]], along: x, stiffness: 1e6}, "
                 "{points: [[0.2, 0.2]], along: y, stiffness: 1e7}, {points: [[0.2, 0.2]], along: "
                 "z, stiffness: %g}, {points: [[0.9, 0.1]], along: y, stiffness: %g}, {points: "
                 "[[0.9, 0.1]], along: z, stiffness: 1e7}, {points: [[0.4, 0.8]], along: z, "
                 "stiffness: 1e6}]",
                 i ? 1e8 : 1e5, i ? 2e5 : 3e8);
        solve_run(&r, FREE_PLATE, changes);
        for (int k = 0; k < 6; k++)
            force[i][k] = force_of(&r, k);
        scene_run_close(&r);
    }
    for (int k = 0; k < 6; k++)
        assert_true(fabs(force[0][k] - force[1][k]) < 1e-8 * 100);
    assert_near("x", force[0][0], -30, 1e-8);
    assert_near("z", force[0][2] + force[0][4] + force[0][5], 100, 1e-8);
}

/* ---- moments and weight ------------------------------------------------------------- */

/*
 * Law: a moment M about y at a node does the work M times the rotation. A rigid plate on two rows
 * of springs at the distance 1, of stiffness 1 in all corners, turns by M, and its edges move by
 * M/2 up and down. With a torsional spring of stiffness c beside the springs the plate turns by
 * M/(1 + c).
 */
static void test_moment(void **state)
{
    (void)state;
    static const double torsion[2] = {0, 3};
    for (int i = 0; i < 2; i++) {
        scene_run r;
        char changes[1024];
        snprintf(
            changes, sizeof changes,
            "loads=[{point: {theta1: 0.25, theta2: 0.5}, about: y, moment: 1e-3}];springs=["
            "{points: [[0, 0], [0, 1], [1, 0], [1, 1]], along: z, stiffness: 1}, {at: {theta1: "
            "0.75, theta2: 0.5}, about: [0, 1, 0], stiffness: %g}, " IN_PLANE "]",
            torsion[i]);
        solve_run(&r, FREE_PLATE, changes);
        const double turn = 1e-3 / (1 + torsion[i]);
        assert_near("left", scene_run_value(&r, 0), turn / 2, 1e-4);
        assert_near("right", scene_run_value(&r, 1), -turn / 2, 1e-4);
        assert_near("torsion", force_of(&r, 1) + 1, 1 - torsion[i] * turn, 1e-4);
        scene_run_close(&r);
    }
}

/* Law: weight along a vector is the sum of its components along the axes. */
static void test_weight(void **state)
{
    (void)state;
    scene_run r;
    const double weight = 8000 * 0.02 * 9.81;
    solve_run(&r, FREE_PLATE,
              "loads=[{weight: {axis: [0.6, 0, -0.8], gravity: 9.81}}];springs=[{at: nodes, along: "
              "z, stiffness: 1e6, per: area}, {at: nodes, along: x, stiffness: 1e6, per: area}, "
              "{at: nodes, along: y, stiffness: 1e6, per: area}]");
    double sum[3] = {0, 0, 0};
    const mesh_springs *springs = &r.analysis.design.mesh.springs;
    for (int item = 0; item < 3; item++)
        for (int row = springs->first[item]; row < springs->first[item + 1]; row++)
            sum[item] += spring_force(&r.analysis.design, row, r.u, r.analysis.input_value);
    assert_near("z", sum[0], 0.8 * weight, 1e-9);
    assert_near("x", sum[1], -0.6 * weight, 1e-9);
    assert_true(fabs(sum[2]) < 1e-9 * weight);
    scene_run_close(&r);
}

/* ---- films --------------------------------------------------------------------------- */

/*
 * Law: a film has the free strains of its data sheet at the voltage of the data sheet, along and
 * across its fibres. With an end on a spring of stiffness k a film of length L pushes with F k/(k +
 * F/(s L)), where F is the blocking force and s the free strain: with F itself between rigid walls.
 */
static void test_film(void **state)
{
    (void)state;
    static const double stiffness[3] = {1e-3, 2e6, 1e13};
    const double force = 923, strain = 1.8e-3, own = force / (strain * 0.1);
    for (int k = 0; k < 3; k++) {
        scene_run r;
        char changes[2048];
        snprintf(
            changes, sizeof changes,
            "surface={type: plate};mesh={theta1: {from: 0, to: 0.1, elements: 2}, theta2: "
            "{from: 0, to: 0.057, elements: 2}};materials={mfc: {E2: 15.9e9, G12: 5.5e9, "
            "nu12: 0.31, film: {voltage: 2000, strain: [1.8e-3, -0.9e-3], thickness: 0.3e-3, "
            "blocking_force: 923, width: 57e-3}}};layers=[{name: l, material: mfc, thickness: "
            "0.3e-3}];patches=[{name: p, layer: l}];actuators=[{name: v, drives: [{patches: "
            "p}], applied: 2000}];supports=[{edge: theta1-, fix: u1}, {at: nodes, fix: [u3 "
            "mean, u1 difference, u2 difference]}, {at: {theta1: 0, theta2: 0}, fix: u2 "
            "mean}];springs=[{edge: theta1+, along: x, stiffness: %.17g, per: length}];outputs=["
            "{name: u, x: mean, at: {theta1: 0.1, theta2: 0.057}}, {name: v, y: mean, at: "
            "{theta1: 0.1, theta2: 0.057}}]",
            stiffness[k] / 0.057);
        solve_run(&r, FREE_PLATE, changes);
        double push = 0;
        for (int row = 0; row < r.analysis.design.mesh.springs.count; row++)
            push -= spring_force(&r.analysis.design, row, r.u, r.analysis.input_value);
        assert_near("force", push, force * stiffness[k] / (stiffness[k] + own), 1e-8);
        const double along = strain - push / force * strain;
        if (k < 2)
            assert_near("along", scene_run_value(&r, 0), along * 0.1, 1e-8);
        if (k == 0)
            assert_near("across", scene_run_value(&r, 1), -0.9e-3 * 0.057, 1e-8);
        scene_run_close(&r);
    }
}

/* ---- refusals -------------------------------------------------------------------- */

#define STRIP                                                                                      \
    "outputs=[];mesh={theta1: {from: 0, to: 1, elements: 50}, theta2: {from: 0, to: 0.1, "         \
    "elements: 1}};"

/* Whether a rule warns of the mesh of a clamped strip of 50 elements with these springs. */
static bool is_warned(const char *rule, const char *springs)
{
    char changes[512];
    plausible warnings = {.count = 0};
    scene_run r;
    bool found = false;
    snprintf(changes, sizeof changes, CLAMPED STRIP "springs=[%s]", springs);
    open_run(&r, FREE_PLATE, changes);
    plausible_mesh(&warnings, &r.analysis.design.mesh);
    for (int k = 0; k < warnings.count; k++)
        found |= strcmp(warnings.warning[k].rule, rule) == 0;
    scene_run_close(&r);
    return found;
}

/*
 * Law: a warning names springs whose place is held by a support, and springs between so distant
 * nodes that the stiffness factor has more than twice the numbers.
 */
static void test_warnings(void **state)
{
    (void)state;
    const char *const all = "{at: nodes, along: z, stiffness: 1}";
    const char *const near = "{edge: theta1+, along: z, stiffness: 1}";
    const char *const far =
        "{edge: theta2-, to: {theta1: 0.02, theta2: 0.1}, along: [1, 2, 3], stiffness: 1}";
    assert_true(is_warned("held_spring", all));
    assert_false(is_warned("held_spring", near));
    assert_false(is_warned("long_spring", all));
    assert_false(is_warned("long_spring", near));
    assert_true(is_warned("long_spring", far));
}

static void test_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *set, *expected;
    } bad[] = {
        {"springs=[{at: nodes, along: z, stiffness: -1}]", "must not be below 0"},
        {"supports=[];springs=[{points: [[0.3, 0.3]], along: z, stiffness: 1}]",
         "the 0 supports and the 1 springs and stacks leave a motion free"},
        {"supports=[];actuators=[{name: s, stacks: {points: [[0.1, 0.1], [0.3, 0.3]], along: z, "
         "stiffness: 1, stroke: 1}}]",
         "the 0 supports and the 2 springs and stacks leave a motion free"},
        {"springs=[{at: nodes, along: z, stiffness: .nan}]", "stiffness"},
        {"springs=[{at: nodes, along: z, stiffness: 1e999}]", "stiffness"},
        {"springs=[{at: nodes, along: z}]", "stiffness"},
        {"springs=[{points: [[0.3, 0.3]], along: z, stiffness: 1e30}]",
         "times that of the elements"},
        {"springs=[{at: nodes, about: x, stiffness: 1e30}]", "times that of the elements"},
        {"springs=[{along: z, stiffness: 1}]", "needs one of at, edge, set and points"},
        {"springs=[{at: nodes, stiffness: 1}]", "no direction"},
        {"springs=[{at: nodes, along: [0, 0, 0], stiffness: 1}]", "has no direction"},
        {"springs=[{at: nodes, along: [0, 1], stiffness: 1}]", "give three"},
        {"springs=[{at: {theta1: 0, theta2: 0}, to: {theta1: 0, theta2: 0}, stiffness: 1}]",
         "both ends of the spring are at theta1 = 0, theta2 = 0"},
        {"springs=[{points: [[0.25, 0]], to: {theta1: 0.25, theta2: 0}, along: z, stiffness: 1}]",
         "both ends"},
        {"springs=[{points: [[2, 2]], along: z, stiffness: 1}]", "is not on the mesh"},
        {"springs=[{points: [[2]], along: z, stiffness: 1}]", "no second coordinate"},
        {"springs=[{points: [], along: z, stiffness: 1}]", "'points' is empty"},
        {"springs=[{at: nodes, about: z, stiffness: 1}]", "normal to the surface"},
        {"springs=[{at: nodes, about: x, along: z, stiffness: 1}]", "torsional spring"},
        {"springs=[{at: nodes, along: z, stiffness: 1, per: length}]", "needs an edge"},
        {"springs=[{at: {theta1: 0, theta2: 0}, along: z, stiffness: 1, per: area}]",
         "has no area"},
        {"springs=[{at: nodes, along: z, stiffness: 3 N}]", "that of a stiffness"},
        {"springs=[{name: a, at: nodes, along: z, stiffness: 3 N/m, per: area}]",
         "that of a stiffness per area"},
        {"actuators=[{name: s, stacks: {at: nodes, along: z, force: 1}}]", "one node of a stack"},
        {"actuators=[{name: s, stacks: {at: {theta1: 0, theta2: 0}, along: z}}]",
         "either its stroke or its force"},
        {"actuators=[{name: s, stacks: {at: {theta1: 0, theta2: 0}, along: z, stroke: 1e-6}}]",
         "stiffness above 0"},
        {"actuators=[{name: s, stacks: {at: {theta1: 0, theta2: 0}, along: z, stiffness: 1, "
         "stroke: 1e-6, force: 2}}]",
         "either its stroke or its force"},
        {"actuators=[{name: s}]", "stacks"},
        {"supports=[{at: {theta1: 0, theta2: 0}, fix: vee, direction: [0, 0, 1]}]",
         "normal to the surface"},
        {"supports=[{edge: theta1-, fix: symmetric}, {at: {theta1: 0, theta2: 0}, fix: vee, "
         "direction: [1, 1, 0]}]",
         "another support has turned u1 and u2"},
        {"element=published;supports=[{at: nodes, fix: vee, direction: [1, 1, 0]}]",
         "needs element: improved"},
        {"supports=[{at: {theta1: 0, theta2: 0}, fix: vee, direction: [1, 1, 0]}];loads=[{face: "
         "outer, u1: 1}]",
         "along x, y or z"},
        {"materials.steel.film={voltage: 100, strain: [1e-3, 0], thickness: 0.01}",
         "its material is a film of 0.01"},
        {"materials.steel.film={voltage: 0, strain: [1e-3, 0], thickness: 0.02}", "above 0"},
        {"materials.steel.film={voltage: 1, strain: [1e-3, 0], thickness: 0.02, width: 1}",
         "belong together"},
        {"materials.steel.film={voltage: 1, strain: [1e-3, 0], thickness: 0.02};materials.steel."
         "d31=1e-12",
         "give one or the other"},
        {"materials.steel.film={voltage: 1, strain: [1e-3, 0], thickness: 0.02, blocking_force: 1, "
         "width: 1}",
         "'E' and the blocking force of a film, which gives E1"},
        {"materials.steel={film: {voltage: 1, strain: [1e-3, 0], thickness: 0.02, blocking_force: "
         "1, width: 1}}",
         "'E2' is missing in steel; add it (needed: E2, G12, nu12)"},
        {"materials.steel={density: 1}", "no stiffness in steel; give E and nu"},
        {"loads=[{point: {theta1: 0, theta2: 0}, about: z, moment: 1}]", "normal to the surface"},
        {"loads=[{point: {theta1: 0, theta2: 0}, about: y}]", "needs a direction"},
        {"loads=[{point: {theta1: 0, theta2: 0}, moment: 1}]", "add about"},
        {"loads=[{point: {theta1: 0, theta2: 0}, about: y, z: 1}]", "without a force"},
        {"loads=[{weight: {axis: [0, 0, 0], gravity: 1}}]", "has no direction"},
        {"supports=[{edge: theta1-, fix: vee, value: 1}];kinematics=nonlinear",
         "single displacement"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char changes[512];
        scene_run r;
        snprintf(changes, sizeof changes, CLAMPED "%s", bad[i].set);
        if (scene_run_open(&r, FREE_PLATE, changes) == 0 || !strstr(r.error, bad[i].expected))
            fail_msg("%s: expected '%s', got '%s'", bad[i].set, bad[i].expected, r.error);
        scene_run_close(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_three_springs),
        cmocka_unit_test(test_soft_mount),
        cmocka_unit_test(test_uniform_foundation),
        cmocka_unit_test(test_parallel),
        cmocka_unit_test(test_series),
        cmocka_unit_test(test_stack_stroke),
        cmocka_unit_test(test_reciprocity),
        cmocka_unit_test(test_influence_width),
        cmocka_unit_test(test_balance),
        cmocka_unit_test(test_winkler_beam),
        cmocka_unit_test(test_shares),
        cmocka_unit_test(test_points),
        cmocka_unit_test(test_face),
        cmocka_unit_test(test_kinematic_springs),
        cmocka_unit_test(test_kinematic_supports),
        cmocka_unit_test(test_direction),
        cmocka_unit_test(test_determinate),
        cmocka_unit_test(test_moment),
        cmocka_unit_test(test_weight),
        cmocka_unit_test(test_film),
        cmocka_unit_test(test_warnings),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
