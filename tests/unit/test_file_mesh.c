/*
 * Laws of scenes whose mesh comes from a file: the same numbers as with mesh lines, closed forms on
 * irregular meshes, supports by set and their triads, patches and layers by set, refusals.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _XOPEN_SOURCE 700
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/mesh_writer.h"
#include "../rigs/scene_run.h"
#include "../rigs/test_folder.h"

static grid_mesh grid;
static const double pi = 3.14159265358979323846;

/* ---- scenes ------------------------------------------------------------- */

#define MATERIALS                                                                                  \
    "materials:\n"                                                                                 \
    "  ceramic: {E: 63e9, nu: 0.3, d31: 190e-12, d32: 190e-12, alpha: 1e-5, density: 7600}\n"      \
    "  ply: {E1: 130e9, E2: 9e9, G12: 5e9, nu12: 0.3}\n"

#define LAYERS                                                                                     \
    "layers:\n"                                                                                    \
    "  - {name: lower, material: ceramic, thickness: 1e-3}\n"                                      \
    "  - {name: upper, material: ceramic, thickness: 1e-3}\n"

/* The same scene with mesh lines and with a file, in the words of each. */
static const char *const bodies[2] = {
    "surface: {type: plate}\n"
    "mesh: {theta1: {from: 0, to: 2, elements: 8}, theta2: {from: 0, to: 1, elements: 6}}\n"
    "patches: [{name: p, layer: upper, theta1: [0, 1]}]\n"
    "supports: [{edge: theta1-, fix: clamped}, {edge: theta2-, fix: simple},\n"
    "           {edge: theta1+, fix: symmetric}]\n"
    "loads:\n"
    "  - {face: outer, pressure: 1e3*x}\n"
    "  - {line: theta2+, z: 50*x}\n"
    "  - {point: {theta1: 1, theta2: 1}, x: 70}\n"
    "  - {temperature: {inner: 1, outer: 3}}\n"
    "  - {weight: {axis: z, gravity: -9.8}}\n"
    "outputs:\n"
    "  - {name: mid, u3: middle, at: {theta1: 1, theta2: 0.5}}\n"
    "  - {name: side, x: outer, at: {theta1: 1, theta2: 1}}\n",
    "mesh: {file: grid.msh}\n"
    "patches: [{name: p, layer: upper, sets: [first]}]\n"
    "supports: [{set: low1, fix: clamped}, {edge: low2, fix: simple},\n"
    "           {set: high1, fix: symmetric}]\n"
    "loads:\n"
    "  - {face: outer, pressure: 1e3*x}\n"
    "  - {line: high2, z: 50*x}\n"
    "  - {point: {x: 1, y: 1, z: 0.5}, x: 70}\n"
    "  - {temperature: {inner: 1, outer: 3}}\n"
    "  - {weight: {axis: z, gravity: -9.8}}\n"
    "outputs:\n"
    "  - {name: mid, u3: middle, at: {x: 1, y: 0.5, z: 0.5}}\n"
    "  - {name: side, x: outer, at: {x: 1, y: 1, z: 0.5}}\n"};

static void write_scene(const char *body, const char *layers)
{
    FILE *file = write_file("scene.yaml");
    fprintf(file, "name: test\n%s%s%s", MATERIALS, layers, body);
    fclose(file);
}

static void write_grid(mesh_format format)
{
    FILE *file = write_file("grid.msh");
    grid_write(&grid, format, file);
    fclose(file);
}

static scene_run run_scene(const char *body, const char *layers)
{
    scene_run r;
    write_scene(body, layers);
    if (scene_run_open(&r, path_of("scene.yaml"), "") < 0 || scene_run_solve(&r) < 0)
        fail_msg("%s", r.error);
    return r;
}

/* The scene is refused with a message that contains `says`. */
static void assert_scene_refused(const char *body, const char *layers, const char *says)
{
    scene_run r;
    write_scene(body, layers);
    if (scene_run_open(&r, path_of("scene.yaml"), "") == 0 || !strstr(r.error, says))
        fail_msg("'%s', expected '%s'", r.error, says);
    scene_run_close(&r);
}

static void plate(double u, double v, double x[3])
{
    x[0] = 2 * u;
    x[1] = v;
    x[2] = 0.5;
}

static void assert_near(const char *what, double got, double expected, double part)
{
    if (!(fabs(got - expected) <= part * fabs(expected)))
        fail_msg("%s: %.12g, expected %.12g within %.1e", what, got, expected, part);
}

/* ---- the same numbers ----------------------------------------------------- */

/*
 * Law: a plate of rectangles gives the same displacements from a file as from mesh lines, whatever
 * the order of nodes and elements in the file, with all supports, loads and one actuator. The files
 * hold coordinates to the last bit; what differs is the order of the sums.
 */
static void test_same_plate(void **state)
{
    (void)state;
    const char *const actuator = "actuators: [{name: v, drives: [{patches: p}], applied: 100}]\n";
    double expected[2];
    for (int k = 0; k < 2; k++)
        for (unsigned order = 0; order < (k ? 2 : 1); order++) {
            char body[2000];
            snprintf(body, sizeof body, "%s%s", bodies[k], actuator);
            grid_fill(&grid, 8, 6, plate, order);
            if (order)
                grid_flip(&grid, 3);
            write_grid(k && order ? MSH2_BINARY : MSH4_TEXT);
            scene_run r = run_scene(body, LAYERS);
            const bool is_flipped = r.analysis.design.mesh.point[0].triad[2][2] < 0;
            const double sign = k && is_flipped ? -1 : 1;
            for (int i = 0; i < 2 && sign > 0; i++) {
                const double value = scene_run_value(&r, i);
                if (k == 0)
                    expected[i] = value;
                else
                    assert_near("file against lines", value, expected[i], 1e-9);
            }
            if (k)
                assert_int_equal(r.analysis.design.mesh.types, 2);
            scene_run_close(&r);
        }
}

/* ---- closed forms ---------------------------------------------------------- */

/* A disc of radius 1 from a square, with elements of every shape. */
static void disc(double u, double v, double x[3])
{
    const double a = 2 * u - 1, b = 2 * v - 1;
    x[0] = a * sqrt(1 - b * b / 2);
    x[1] = b * sqrt(1 - a * a / 2);
    x[2] = 0;
}

static double disc_centre(int elements, const char *fix)
{
    char body[600];
    grid_fill(&grid, elements, elements, disc, 11);
    write_grid(MSH4_BINARY);
    snprintf(body, sizeof body,
             "mesh: {file: grid.msh}\n"
             "supports: [{set: low1, fix: %s}, {set: high1, fix: %s}, {set: low2, fix: %s},\n"
             "           {set: high2, fix: %s}]\n"
             "loads: [{face: middle, pressure: 1}]\n"
             "outputs: [{name: w, z: middle, at: {x: 0, y: 0, z: 0}}]\n",
             fix, fix, fix, fix);
    scene_run r = run_scene(body, "layers: [{material: ceramic, thickness: 0.01}]\n");
    const double w = scene_run_value(&r, 0);
    scene_run_close(&r);
    return w;
}

/*
 * Law: the centre of a clamped disc moves by p R^4/(64 D) (thin: the shear adds 3e-4), with second
 * order: the error falls by about 4 where the elements are halved. The corners of the square map to
 * quadrilaterals whose corner is open to 135 degrees and more.
 */
static void test_disc(void **state)
{
    (void)state;
    const double d = 63e9 * 1e-6 / (12 * (1 - 0.09)), exact = 1 / (64 * d);
    const double coarse = fabs(disc_centre(8, "clamped") / exact - 1);
    const double fine = fabs(disc_centre(16, "clamped") / exact - 1);
    if (fine > 0.012 || fine > coarse / 2.5)
        fail_msg("errors %.4f and %.4f", coarse, fine);
}

static double rig_value(const char *path)
{
    scene_run r;
    if (scene_run_open(&r, path, "") < 0 || scene_run_solve(&r) < 0)
        fail_msg("%s", r.error);
    const double value = scene_run_value(&r, 0);
    scene_run_close(&r);
    return value;
}

/*
 * Law: a box beam bends by F L^3/(3 E I) + F L/(G A), A the area of the webs: sharp edges with one
 * mean director carry over. 2 %: 3 elements across a flange, and sections that stay in shape only
 * in beam theory.
 */
static void test_box_beam(void **state)
{
    (void)state;
    const double b = 0.03, h = 0.05, t = 0.0005, length = 0.5, e = 200e9, g = e / 2.6;
    const double inertia = b * t * h * h / 2 + t * h * h * h / 6;
    const double theory = 100 * pow(length, 3) / (3 * e * inertia) + 100 * length / (g * 2 * h * t);
    assert_near("tip of a box beam", rig_value("tests/rigs/scenes/box-beam.yaml"), theory, 0.02);
}

/*
 * Law: a hemisphere without a hole moves by 0.0924 under two pairs of forces; an irregular mesh of
 * 212 elements by Gmsh is within 1 %. (436, 1196, 3100 elements: 0.52, 0.13, 0.00 %.)
 */
static void test_hemisphere(void **state)
{
    (void)state;
    assert_near("hemisphere", rig_value("tests/rigs/scenes/octant.yaml"), 0.0924, 0.01);
}

/*
 * Law: the directors of an off-axis paraboloid z = r^2/(4 f), meshed by Gmsh from CAD, are those of
 * its surface. The slope turns by 0.08 rad over an element; a fitted quadric leaves a cubic part of
 * (0.08)^3/6 and the rounding of the spline, below 1e-3.
 */
static void test_dish_directors(void **state)
{
    (void)state;
    const double focal = 0.5;
    scene_run r;
    double worst = 0;
    if (scene_run_open(&r, "tests/rigs/scenes/dish.yaml", "") < 0)
        fail_msg("%s", r.error);
    const mesh *mesh = &r.analysis.design.mesh;
    for (int n = 0; n < mesh->nodes; n++) {
        const double *x = mesh->point[n].position, *d = mesh->point[n].triad[2];
        double exact[3] = {-x[0] / (2 * focal), -x[1] / (2 * focal), 1};
        const double length = sqrt(exact[0] * exact[0] + exact[1] * exact[1] + 1);
        const double sign = d[2] > 0 ? 1 : -1;
        double square = 0;
        for (int i = 0; i < 3; i++)
            square += pow(sign * d[i] - exact[i] / length, 2);
        worst = fmax(worst, sqrt(square));
    }
    scene_run_close(&r);
    if (worst > 1e-3)
        fail_msg("a director is off by %.3g", worst);
}

/* ---- supports --------------------------------------------------------------- */

static void quarter(double u, double v, double x[3])
{
    x[0] = 0.5 * u;
    x[1] = 0.3 * v;
    x[2] = 0;
}

static void whole(double u, double v, double x[3])
{
    x[0] = u - 0.5;
    x[1] = 0.6 * v - 0.3;
    x[2] = 0;
}

static double plate_centre(int n, void (*point)(double, double, double[3]), const char *supports)
{
    char body[600];
    grid_fill(&grid, n, n, point, 5);
    write_grid(MSH2_TEXT);
    snprintf(body, sizeof body,
             "mesh: {file: grid.msh}\n%sloads: [{face: middle, pressure: 1}]\n"
             "outputs: [{name: w, z: middle, at: {x: 0, y: 0, z: 0}}]\n",
             supports);
    scene_run r = run_scene(body, "layers: [{material: ceramic, thickness: 0.01}]\n");
    const double w = scene_run_value(&r, 0);
    scene_run_close(&r);
    return w;
}

/* Law: a quarter with symmetry planes, given by edges or by their normals, moves like the whole. */
static void test_symmetry(void **state)
{
    (void)state;
    const double full =
        plate_centre(8, whole,
                     "supports: [{set: low1, fix: simple}, {set: high1, fix: simple},"
                     " {set: low2, fix: clamped}, {set: high2, fix: clamped}]\n");
    const double part = plate_centre(
        4, quarter,
        "supports: [{set: low1, fix: symmetric}, {set: low2, fix: symmetric, direction: [0, 1, 0]},"
        " {set: high1, fix: simple}, {set: high2, fix: clamped}]\n");
    assert_near("quarter against whole", part, full, 1e-9);
    const double global = plate_centre(
        4, quarter,
        "supports: [{set: low1, fix: x}, {set: low2, fix: y}, {set: high1, fix: [y, z]},"
        " {set: high2, fix: clamped}]\n");
    assert_near("global axes against edges", global, full, 1e-9);
}

/*
 * Law: on a plate whose normal is z, a support along x and y together holds what one along x and
 * one along y hold, and leaves z free.
 */
static void test_plane_support(void **state)
{
    (void)state;
    const double apart = plate_centre(4, quarter,
                                      "supports: [{set: low1, fix: clamped}, {set: high1, fix: x},"
                                      " {set: high1, fix: y}]\n");
    const double together = plate_centre(
        4, quarter, "supports: [{set: low1, fix: clamped}, {set: high1, fix: [x, y]}]\n");
    assert_near("x and y together", together, apart, 1e-12);
}

/*
 * Law: a support on a set named low* is a support on each set that fits, with its name; the sum of
 * their reactions is the load.
 */
static void test_support_pattern(void **state)
{
    (void)state;
    grid_fill(&grid, 4, 4, plate, 0);
    write_grid(MSH4_TEXT);
    scene_run r = run_scene("mesh: {file: grid.msh}\nsupports: [{set: low*, fix: clamped},"
                            " {name: far, set: high*, fix: u3}]\n"
                            "loads: [{face: outer, z: -7}]\n",
                            "layers: [{material: ceramic, thickness: 0.01}]\n");
    const design *design = &r.analysis.design;
    const reactions *reactions = &r.analysis.reactions;
    assert_int_equal(design->supports, 4);
    assert_string_equal(design->support[0].name, "low1");
    assert_string_equal(design->support[1].name, "low2");
    assert_string_equal(design->support[3].where.set, "high2");
    assert_int_equal(reactions->supports, 3);
    assert_string_equal(reactions->support[2].name, "far");
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += reactions->support[k].total.force[2];
    assert_near("sum", sum, -reactions->load.force[2], 1e-9);
    scene_run_close(&r);
}

/* ---- layers and patches by set ------------------------------------------------ */

/* Law: a layer with sets exists in them alone, so that its mass is theirs. */
static void test_layer_sets(void **state)
{
    (void)state;
    grid_fill(&grid, 4, 2, plate, 0);
    write_grid(INP);
    scene_run r = run_scene("mesh: {file: grid.msh}\nsupports: [{set: low1, fix: clamped}]\n",
                            "layers: [{material: ceramic, thickness: 1e-3},"
                            " {material: ceramic, thickness: 2e-3, sets: [second]}]\n");
    const mesh *mesh = &r.analysis.design.mesh;
    assert_int_equal(mesh->types, 2);
    for (int e = 0; e < 8; e++)
        assert_int_equal(mesh->place[mesh->element_type[e]].present_plies, e < 4 ? 1 : 3);
    scene_run_close(&r);
}

/* Law: the angle of a ply is measured from the projected direction, whatever the element's sides.
 */
static void test_direction(void **state)
{
    (void)state;
    double value[3];
    static const char *const words[3] = {"direction: [1, 0, 0]", "direction: [0, 3, 0]",
                                         "flip: off"};
    static const int angle[3] = {30, -60, 30};
    for (int k = 0; k < 3; k++) {
        char body[400], layers[100];
        grid_fill(&grid, 8, 6, plate, k == 1 ? 7 : 0);
        write_grid(MSH4_TEXT);
        snprintf(body, sizeof body,
                 "mesh: {file: grid.msh, %s}\nsupports: [{set: low1, fix: clamped}]\n"
                 "loads: [{line: high1, z: 1}]\n"
                 "outputs: [{name: w, z: middle, at: {x: 2, y: 0, z: 0.5}}]\n",
                 words[k]);
        snprintf(layers, sizeof layers, "layers: [{material: ply, thickness: 0.01, angle: %d}]\n",
                 angle[k]);
        scene_run r = run_scene(body, layers);
        value[k] = scene_run_value(&r, 0);
        scene_run_close(&r);
    }
    assert_near("direction y less 90 degrees", value[1], value[0], 1e-9);
    assert_near("first side of the elements", value[2], value[0], 1e-9);
}

static void cylinder(double u, double v, double x[3])
{
    x[0] = cos(pi / 2 * u);
    x[1] = sin(pi / 2 * u);
    x[2] = 2 * v;
}

/* Return the displacement of a quarter cylinder of plies in a direction, with the angle of a ply.
 */
static double of_plies(const char *direction, int angle)
{
    char body[400], layers[100];
    grid_fill(&grid, 8, 6, cylinder, 0);
    write_grid(MSH4_TEXT);
    snprintf(body, sizeof body,
             "mesh: {file: grid.msh, direction: %s}\nsupports: [{set: low2, fix: clamped}]\n"
             "loads: [{line: high2, x: 1}]\n"
             "outputs: [{name: w, z: middle, at: {x: 1, y: 0, z: 2}}]\n",
             direction);
    snprintf(layers, sizeof layers, "layers: [{material: ply, thickness: 0.01, angle: %d}]\n",
             angle);
    scene_run r = run_scene(body, layers);
    const double value = scene_run_value(&r, 0);
    scene_run_close(&r);
    return value;
}

/*
 * Law: the direction around a cylinder is that across its axis, be it given by formulas or by the
 * arc at its end.
 */
static void test_direction_field(void **state)
{
    (void)state;
    const double across = of_plies("[0, 0, 1]", -60);
    assert_near("formulas", of_plies("['-y', 'x', 0]", 30), across, 1e-9);
    assert_near("edges", of_plies("low2", 30), across, 1e-9);
    assert_near("edges along the axis", of_plies("high1", -60), across, 1e-9);
    assert_true(fabs(of_plies("[0, 0, 1]", -50) / across - 1) > 0.01);
}

/*
 * Law: on a disc of blocks, whose first sides turn, a ply needs a direction with a projection; an
 * isotropic layer takes any.
 */
static void test_direction_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *direction, *layers, *says; /* says: NULL if the scene is valid */
    } row[] = {
        {"", "layers: [{material: ply, thickness: 0.01}]\n", "the first sides of the elements"},
        {", direction: [0, 0, 1]", "layers: [{material: ply, thickness: 0.01}]\n",
         "the direction is normal to element"},
        {", direction: ['x/0', 0, 0]", "layers: [{material: ply, thickness: 0.01}]\n",
         "or no finite vector"},
        {", direction: ['theta1', 0, 0]", "layers: [{material: ply, thickness: 0.01}]\n",
         "no theta1 and theta2"},
        {", direction: ring1", "layers: [{material: ply, thickness: 0.01}]\n",
         "no set of edges 'ring1'"},
        {", direction: rim",
         "layers: [{material: ply, thickness: 0.01}, {material: ceramic, thickness: 1e-3, "
         "poling: 1}]\n",
         "have no sense"},
        {", direction: [0, 1]", "layers: [{material: ply, thickness: 0.01}]\n", "has 2 values"},
        {", direction: rim", "layers: [{material: ply, thickness: 0.01}]\n", NULL},
        {", direction: ['-y', 'x', 0]", "layers: [{material: ply, thickness: 0.01}]\n", NULL},
        {", direction: [0, 0, 1]", "layers: [{material: ceramic, thickness: 0.01}]\n", NULL},
        {"", "layers: [{material: ceramic, thickness: 0.01}]\n", NULL},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        char body[300];
        snprintf(body, sizeof body,
                 "mesh: {disc: {radius: 1, elements: 4}%s}\nsupports: [{set: rim, fix: clamped}]\n",
                 row[k].direction);
        if (row[k].says) {
            assert_scene_refused(body, row[k].layers, row[k].says);
        } else {
            scene_run r = run_scene(body, row[k].layers);
            scene_run_close(&r);
        }
    }
}

/* ---- refusals -------------------------------------------------------------------- */

static const struct {
    const char *body, *says;
} refused[] = {
    {"mesh: {file: none.msh}\n", ":8:14: none.msh: No such file"},
    {"surface: {type: plate}\nmesh: {file: grid.msh}\n", "remove 'surface'"},
    {"mesh: {file: grid.msh, unit: mm}\n", "needs the scene's own unit"},
    {"mesh: {file: grid.msh, unit: kg}\n", "'unit: kg' is no unit of length"},
    {"mesh: {file: grid.msh, direction: [0, 0, 0]}\n", "has no direction"},
    {"mesh: {theta1: {from: 0, to: 1, elements: 2}}\n", "'surface' is missing in"},
    {"mesh: {file: grid.msh}\nsupports: [{set: rot, fix: clamped}]\n",
     "the mesh file has no set 'rot'; it has all, first, second, low1, high1, low2, high2, origin"},
    {"mesh: {file: grid.msh}\nsupports: [{set: bolt_*, fix: clamped}]\n",
     "the mesh file has no set 'bolt_*'; it has all"},
    {"mesh: {file: grid.msh}\nsupports: [{at: {set: low*}, fix: clamped}]\n",
     "'low*' stands for 2 sets, and one is needed here; name one of low1, low2"},
    {"mesh: {file: grid.msh}\nloads: [{line: low*, z: 1}]\n",
     "'low*' stands for 2 sets, and one is needed here; name one of low1, low2"},
    {"mesh: {disc: {radius: 1, rings: [0.5], elements: 4}}\nsupports: [{set: rin, fix: clamped}]\n",
     "the disc has no set 'rin'; it has ring1, ring2, rim, centre"},
    {"mesh: {disc: {radius: 1, elements: 4}}\npatches: [{name: p, layer: upper, sets: [rung1]}]\n",
     "the disc has no element set 'rung1'; it has ring1"},
    {"mesh: {file: grid.msh}\npatches: [{name: p, layer: upper, sets: [pzt_*, first, low1]}]\n",
     "no element set of the mesh fits 'pzt_*', 'low1'; the other names stand for first"},
    {"mesh: {file: grid.msh}\npatches: [{name: p, layer: upper, sets: [low1]}]\n",
     "set 'low1' of the mesh file holds edges or nodes, and a patch needs elements (in Gmsh a "
     "physical surface); it has the element sets all, first, second"},
    {"mesh: {file: grid.msh}\nsupports: [{at: {theta1: 0, theta2: 0}, fix: clamped}]\n",
     "a mesh from a file has no theta1 and theta2"},
    {"mesh: {file: grid.msh}\nsupports: [{set: low1, fix: u1}]\n",
     "u1 and u2 are directions in the surface that a mesh from a file does not have"},
    {"mesh: {file: grid.msh}\nsupports: [{set: low2, fix: x}]\n",
     "x is neither in the surface nor along the director; fix [x, y, z], or u3"},
    {"mesh: {file: grid.msh}\nsupports: [{set: low2, fix: symmetric, direction: [1, 0, 0]}]\n",
     "node 1 of the mesh file stands across the symmetry plane"},
    {"mesh: {file: grid.msh}\nsupports: [{set: high2, fix: symmetric, direction: [1, 1, 9]}]\n",
     "a symmetry plane is flat"},
    {"mesh: {file: grid.msh}\nsupports: [{set: low2, fix: [u1], direction: [0, 0, 1]},"
     " {set: low1, fix: u1, direction: [0, 1, 1]}]\n",
     "node 1 of the mesh file has another support whose direction is turned by 45.0 degrees"},
    {"mesh: {file: grid.msh}\nsupports: [{set: origin, fix: simple}]\n", "this set has no edges"},
    {"mesh: {file: grid.msh}\nloads: [{line: all, z: 1}]\n", "set 'all' of the mesh has no edges"},
    {"mesh: {file: grid.msh}\nloads: [{point: {set: low1}, z: 1}]\n", "set 'low1' has 4 nodes"},
    {"mesh: {file: grid.msh}\nloads: [{point: {x: 5, y: 0, z: 0}, z: 1}]\n",
     "(5, 0, 0) is not on the mesh; the nearest node is (1, 0, 0)"},
    {"mesh: {file: grid.msh}\nloads: [{face: outer, pressure: theta1}]\n",
     "a mesh from a file has x, y, z"},
    {"mesh: {file: grid.msh}\npatches: [{name: p, layer: upper, grid: [2, 2]}]\n",
     "'grid' belongs to mesh lines"},
    {"mesh: {file: grid.msh}\npatches: [{name: p, layer: upper, sets: [first, all]}]\n",
     "set 'all' shares element 1 with another set"},
    {"mesh: {file: grid.msh}\npatches: [{name: p, layer: upper, sets: [first]},"
     " {name: q, layer: upper, sets: [all]}]\n",
     "patches 'p' and 'q' overlap on one layer, in element 1"},
    {"mesh: {file: grid.msh}\nelement: published\nsupports: [{set: low1, fix: clamped}]\n",
     "the published element needs a mesh along lines of curvature"},
};

/* Law: what a mesh from a file cannot do is refused with the place in the scene, by node or set. */
static void test_refused_scenes(void **state)
{
    (void)state;
    grid_fill(&grid, 6, 3, cylinder, 0);
    write_grid(MSH4_TEXT);
    for (size_t k = 0; k < sizeof refused / sizeof *refused; k++)
        assert_scene_refused(refused[k].body, LAYERS, refused[k].says);
}

/*
 * Law: a node without element stops a scene that names its set, with or without *, and no other
 * scene.
 */
static void test_loose_node(void **state)
{
    (void)state;
    static const char *const places[3] = {"supports: [{set: ref, fix: clamped}]\n",
                                          "supports: [{set: r*, fix: clamped}]\n",
                                          "outputs: [{name: w, z: middle, at: {set: ref}}]\n"};
    FILE *file = write_file("grid.msh");
    fputs("*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n70, 5, 5, 5\n"
          "*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n*NSET, NSET=ref\n70, 2\n*NSET, NSET=end\n1, 4\n",
          file);
    fclose(file);
    for (int k = 0; k < 3; k++) {
        char body[200];
        scene_run r;
        snprintf(body, sizeof body, "mesh: {file: grid.msh}\n%s", places[k]);
        write_scene(body, LAYERS);
        if (scene_run_open(&r, path_of("scene.yaml"), "") == 0 ||
            !strstr(r.error,
                    "nodes without element in set 'ref' of the mesh file: 1 (70); take them"))
            fail_msg("case %d: '%s'", k, r.error);
        scene_run_close(&r);
    }
    scene_run r = run_scene("mesh: {file: grid.msh}\nsupports: [{set: end, fix: clamped}]\n"
                            "loads: [{face: outer, z: 1}]\n",
                            LAYERS);
    assert_int_equal(r.scene.quads->warnings.loose.count, 1);
    scene_run_close(&r);
}

/* Law: the hash of a scene changes with the bytes of its mesh file. */
static void test_hash(void **state)
{
    (void)state;
    uint32_t hash[2];
    for (int k = 0; k < 2; k++) {
        grid_fill(&grid, 2, 2, plate, 0);
        grid.x[4][0] += k * 1e-12;
        write_grid(MSH4_BINARY);
        scene_run r =
            run_scene("mesh: {file: grid.msh}\nsupports: [{set: low1, fix: clamped}]\n", LAYERS);
        hash[k] = r.scene.hash;
        scene_run_close(&r);
    }
    assert_int_not_equal(hash[0], hash[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_plate),
        cmocka_unit_test(test_disc),
        cmocka_unit_test(test_box_beam),
        cmocka_unit_test(test_hemisphere),
        cmocka_unit_test(test_dish_directors),
        cmocka_unit_test(test_symmetry),
        cmocka_unit_test(test_plane_support),
        cmocka_unit_test(test_support_pattern),
        cmocka_unit_test(test_layer_sets),
        cmocka_unit_test(test_direction),
        cmocka_unit_test(test_direction_field),
        cmocka_unit_test(test_direction_refusals),
        cmocka_unit_test(test_refused_scenes),
        cmocka_unit_test(test_loose_node),
        cmocka_unit_test(test_hash),
    };
    return cmocka_run_group_tests_name("file mesh", tests, make_test_folder, remove_test_folder);
}
