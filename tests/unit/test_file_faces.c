/*
 * Laws of pressure that follows a face, and of contact, on irregular meshes from files: the
 * resultants are those of statics, and a structure turned in space gives turned results.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _XOPEN_SOURCE 700
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
#include "../rigs/mesh_writer.h"
#include "../rigs/scene_run.h"
#include "../rigs/test_folder.h"
#include "../../lib/nonlinear/nonlinear.h"

static grid_mesh grid;
static const double pi = 3.14159265358979323846, thickness = 0.02;
enum { SIDE = 8 };

/* Rotation of the structure in space, by rows. */
static double turn[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/* ---- structures ---------------------------------------------------------- */

static void turned(const double x[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = turn[i][0] * x[0] + turn[i][1] * x[1] + turn[i][2] * x[2];
}

/* Move a point of the unit square such that no element inside is a parallelogram. */
static void distort(double *u, double *v)
{
    const double along = *u, across = *v;
    *u += 0.1 * sin(pi * along) * sin(2 * pi * across);
    *v += 0.1 * sin(2 * pi * along) * sin(pi * across);
}

static void square(double u, double v, double x[3])
{
    distort(&u, &v);
    const double flat[3] = {u - 0.5, v - 0.5, 0};
    turned(flat, x);
}

/* A part of the sphere of radius 1 around the origin, with its middle on +z. */
static void cap(double u, double v, double x[3])
{
    distort(&u, &v);
    const double a = 1.2 * (u - 0.5), b = 1.2 * (v - 0.5), size = sqrt(1 + a * a + b * b);
    const double point[3] = {a / size, b / size, 1 / size};
    turned(point, x);
}

/* Springs of stiffness 200 N/m along x, y and z at the nodes of the rim, and no other support. */
#define RIM(set, axis) "  - {set: " set ", along: " axis ", stiffness: 200}\n"
#define RIMS(set) RIM(set, "x") RIM(set, "y") RIM(set, "z")
#define SPRINGS "springs:\n" RIMS("low1") RIMS("high1") RIMS("low2") RIMS("high2")

/* A run holds pointers to itself and must stay where it was opened. */
static void open_scene(scene_run *run, void (*point)(double, double, double[3]), const char *more)
{
    FILE *file = write_file("grid.msh");
    grid_fill(&grid, SIDE, SIDE, point, 0);
    grid_write(&grid, MSH4_BINARY, file);
    fclose(file);
    file = write_file("scene.yaml");
    fprintf(file,
            "name: test\nkinematics: nonlinear\ndof_per_node: 7\nequilibrium: {tolerance: 1e-9}\n"
            "mesh: {file: grid.msh}\nmaterials:\n  rubber: {E: 2e3, nu: 0.4}\n"
            "layers: [{material: rubber, thickness: %g}]\n" SPRINGS "%s",
            thickness, more);
    fclose(file);
    if (scene_run_open(run, path_of("scene.yaml"), "") < 0)
        fail_msg("%s", run->error);
    assert_int_equal(run->analysis.design.mesh.free_dof, run->analysis.design.mesh.nodes * 7);
}

static void solve(scene_run *run)
{
    if (scene_run_solve(run) < 0)
        fail_msg("%s", run->error);
}

/* ---- statics --------------------------------------------------------------- */

/* Global components of entries `first` to `first + 2` of a vector [free_dof] at a node. */
static void at_node(const mesh *mesh, int node, unsigned first, const double *dense, double out[3])
{
    memset(out, 0, 3 * sizeof *out);
    for (unsigned axis = 0; axis < 3; axis++) {
        const uint16_t dof = mesh->node_dof[(unsigned)node * mesh->dof_per_node + first + axis];
        for (int i = 0; i < 3; i++)
            out[i] += dense[dof] * mesh->point[node].triad[axis][i];
    }
}

/* Sum of the forces of a vector [free_dof] over all nodes (N). */
static void resultant(const mesh *mesh, const double *force, double out[3])
{
    memset(out, 0, 3 * sizeof *out);
    for (int node = 0; node < mesh->nodes; node++) {
        double part[3];
        at_node(mesh, node, 0, force, part);
        for (int i = 0; i < 3; i++)
            out[i] += part[i];
    }
}

/* Number in the mesh of a node of the grid: reading the file renumbers the nodes. */
static int node_at(const mesh *mesh, int column, int row)
{
    const double *wanted = grid.x[column * (SIDE + 1) + row];
    for (int node = 0; node < mesh->nodes; node++)
        if (memcmp(mesh->point[node].position, wanted, 3 * sizeof *wanted) == 0)
            return node;
    fail_msg("node %d %d is not in the mesh", column, row);
    return -1;
}

/* Sum of the forces of the springs on the shell (N). A corner node belongs to two sides. */
static void spring_resultant(const mesh *mesh, const double *displacement, double out[3])
{
    memset(out, 0, 3 * sizeof *out);
    for (int k = 0; k < (SIDE + 1) * (SIDE + 1); k++) {
        const int column = k / (SIDE + 1), row = k % (SIDE + 1);
        const int sides = (column % SIDE == 0) + (row % SIDE == 0);
        const int node = node_at(mesh, column, row);
        double part[3];
        at_node(mesh, node, 0, displacement, part);
        for (int i = 0; i < 3; i++)
            out[i] -= 200 * sides * part[i];
    }
}

/* Position of the inner (-1) or outer (1) face at a node of the deformed shell (m). */
static void face_position(const mesh *mesh, int node, int side, const double *u, double out[3])
{
    double mean[3], difference[3];
    at_node(mesh, node, 0, u, mean);
    at_node(mesh, node, 3, u, difference);
    for (int i = 0; i < 3; i++)
        out[i] = mesh->point[node].position[i] + mean[i] +
                 side * thickness / 2 * (mesh->point[node].triad[2][i] + difference[i]);
}

/* Number of node k = 0 .. 4 SIDE - 1 of the rim, once around. */
static int rim_node(const mesh *mesh, int k)
{
    const int side = k / SIDE % 4, along = k % SIDE;
    const int column[4] = {along, SIDE, SIDE - along, 0}, row[4] = {0, along, SIDE, SIDE - along};
    return node_at(mesh, column[side], row[side]);
}

/* Vector area that the polygon of the deformed rim of a face encloses (m2). */
static void rim_area(const mesh *mesh, int side, const double *u, double area[3])
{
    memset(area, 0, 3 * sizeof *area);
    for (int k = 0; k < 4 * SIDE; k++) {
        double a[3], b[3];
        face_position(mesh, rim_node(mesh, k), side, u, a);
        face_position(mesh, rim_node(mesh, k + 1), side, u, b);
        for (int i = 0; i < 3; i++)
            area[i] += (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]) / 2;
    }
}

static void assert_vector(const char *what, const double got[3], const double expected[3],
                          double scale, double part)
{
    for (int i = 0; i < 3; i++)
        if (!(fabs(got[i] - expected[i]) <= part * scale))
            fail_msg("%s, axis %d: %.12g, expected %.12g within %.1e of %.3g", what, i, got[i],
                     expected[i], part, scale);
}

/* ---- pressure ----------------------------------------------------------- */

static const char *const pressure_on[2] = {
    "loads: [{face: inner, pressure: 3, follower: pressure}]\n",
    "loads: [{face: outer, pressure: 3, follower: pressure}]\n"};

/* Uniform random number from -1 to 1. */
static double uniform(void)
{
    static uint32_t seed = 12345;
    seed = seed * 1664525u + 1013904223u;
    return seed / 2147483648.0 - 1;
}

/*
 * Law: the forces of a uniform pressure on a face of a plane irregular mesh add up to the pressure
 * times the vector area that the rim of the face encloses, however the shell is deformed: the faces
 * of a closed shell, such as a pillow of two such sheets, leave no force. Each of 64 elements adds
 * 12 products with a few rounding errors each.
 */
static void test_pillow(void **state)
{
    (void)state;
    for (int side = 0; side < 2; side++) {
        scene_run run;
        open_scene(&run, square, pressure_on[side]);
        equilibrium *balance = &run.analysis.equilibrium;
        const mesh *mesh = &run.analysis.design.mesh;
        pzs_solver_option *option = &balance->follower_load[0].option;
        for (int trial = 0; trial < 5; trial++) {
            double area[3], force[3];
            double *sum = calloc((size_t)mesh->free_dof, sizeof *sum);
            assert_non_null(sum);
            for (int i = 0; i < mesh->free_dof; i++)
                balance->solver.state.displacement[i] = run.u[i] = 0.2 * trial * uniform();
            option->call->add_unit_force(option, &balance->solver, balance->follower[0].input, sum);
            resultant(mesh, sum, force);
            rim_area(mesh, side ? 1 : -1, run.u, area);
            for (int i = 0; i < 3; i++)
                area[i] *= 3;
            assert_vector("pressure", force, area, 3, 64 * 12 * 8 * DBL_EPSILON);
            free(sum);
        }
        scene_run_close(&run);
    }
}

/*
 * Law: a sheet on springs that a pressure inflates, with rotations of half a radian, is in
 * equilibrium as a whole: the springs carry the pressure times the vector area of the deformed rim.
 * The solver stops at 1e-9 of the displacement.
 */
static void test_inflated_sheet(void **state)
{
    (void)state;
    scene_run run;
    open_scene(&run, square,
               "loads: [{face: inner, pressure: 12, follower: pressure}]\n"
               "outputs: [{name: w, z: middle, at: {x: 0, y: 0, z: 0}}]\n");
    double springs[3], area[3];
    const mesh *mesh = &run.analysis.design.mesh;
    solve(&run);
    spring_resultant(mesh, run.u, springs);
    rim_area(mesh, -1, run.u, area);
    for (int i = 0; i < 3; i++)
        area[i] *= -12;
    print_message("rise %.3f of the width, resultant %.6g N\n", scene_run_value(&run, 0),
                  springs[2]);
    assert_true(scene_run_value(&run, 0) > 0.1);
    assert_vector("springs", springs, area, 12, 1e-6);
    scene_run_close(&run);
}

/*
 * Law: the resultant of a pressure on a curved face differs from the pressure times the vector area
 * of the true rim, four arcs of great circles, by less than a twelfth of the squared angle that the
 * largest element spans, 0.2 rad: the part by which an arc exceeds its chord twice over.
 */
static double true_cap_area(double radius)
{
    static const double corner[4][2] = {{-0.6, -0.6}, {0.6, -0.6}, {0.6, 0.6}, {-0.6, 0.6}};
    double area = 0;
    for (int k = 0; k < 4; k++) {
        const double *a = corner[k], *b = corner[(k + 1) % 4];
        const double cross[3] = {a[1] - b[1], b[0] - a[0], a[0] * b[1] - a[1] * b[0]};
        const double size = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
        area += atan2(size, a[0] * b[0] + a[1] * b[1] + 1) * cross[2] / size / 2;
    }
    return radius * radius * area;
}

static void test_curved_face(void **state)
{
    (void)state;
    for (int side = 0; side < 2; side++) {
        scene_run run;
        open_scene(&run, cap, pressure_on[side]);
        equilibrium *balance = &run.analysis.equilibrium;
        pzs_solver_option *option = &balance->follower_load[0].option;
        double *sum = calloc((size_t)run.analysis.design.mesh.free_dof, sizeof *sum), force[3];
        assert_non_null(sum);
        option->call->add_unit_force(option, &balance->solver, balance->follower[0].input, sum);
        resultant(&run.analysis.design.mesh, sum, force);
        const double expected[3] = {0, 0,
                                    3 * true_cap_area(1 + (side ? thickness : -thickness) / 2)};
        assert_vector("cap", force, expected, expected[2], 0.2 * 0.2 / 12);
        free(sum);
        scene_run_close(&run);
    }
}

/* ---- contact -------------------------------------------------------------- */

static void set_turn(double about_x, double about_z)
{
    const double cx = cos(about_x), sx = sin(about_x), cz = cos(about_z), sz = sin(about_z);
    const double rows[3][3] = {{cz, -sz * cx, sz * sx}, {sz, cz * cx, -cz * sx}, {0, sx, cx}};
    memcpy(turn, rows, sizeof turn);
}

/* Press a ball of radius 0.5 by 0.15 onto the cap and solve. */
static void press_ball(scene_run *run, double force[3])
{
    const double above[3] = {0.05, 0.02, 1.5 + 0.02}, down[3] = {0, 0, -0.15};
    double centre[3], move[3];
    char more[800];
    turned(above, centre);
    turned(down, move);
    snprintf(more, sizeof more,
             "contact: {face: outer, body: {type: sphere, point: [%.17g, %.17g, %.17g],\n"
             "          radius: 0.5}, move: [%.17g, %.17g, %.17g]}\n"
             "outputs: [{name: Fx, contact: x}, {name: Fy, contact: y}, {name: Fz, contact: z},\n"
             "          {name: nodes, contact: nodes}]\n",
             centre[0], centre[1], centre[2], move[0], move[1], move[2]);
    open_scene(run, cap, more);
    solve(run);
    for (int i = 0; i < 3; i++)
        force[i] = scene_run_value(run, i);
    assert_true(scene_run_value(run, 3) >= 1);
}

/*
 * Law: a ball pressed onto a dome on springs: springs and contact are in equilibrium, and a dome
 * and a ball turned in space give the turned force. The triads of the nodes, which the mesh chooses
 * by the axes of space, are then others.
 */
static void test_ball_on_dome(void **state)
{
    (void)state;
    double force[2][3], straight[3];
    for (int k = 0; k < 2; k++) {
        double springs[3];
        set_turn(k ? 0.7 : 0, k ? 2 : 0);
        scene_run run;
        press_ball(&run, force[k]);
        const double size =
            sqrt(force[k][0] * force[k][0] + force[k][1] * force[k][1] + force[k][2] * force[k][2]);
        spring_resultant(&run.analysis.design.mesh, run.u, springs);
        for (int i = 0; i < 3; i++)
            springs[i] = -springs[i];
        print_message("ball on a dome: force %.6g N, %g nodes\n", size, scene_run_value(&run, 3));
        assert_vector("contact", force[k], springs, size, 1e-6);
        if (k) {
            turned(force[0], straight);
            assert_vector("turned", force[1], straight, size, 1e-6);
        }
        scene_run_close(&run);
    }
    set_turn(0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pillow),
        cmocka_unit_test(test_inflated_sheet),
        cmocka_unit_test(test_curved_face),
        cmocka_unit_test(test_ball_on_dome),
    };
    return cmocka_run_group_tests_name("faces of file meshes", tests, make_test_folder,
                                       remove_test_folder);
}
