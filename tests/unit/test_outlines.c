/*
 * Laws of electrodes of any outline: areas, shares of elements, inputs, capacitances, refusals.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include "pzs.h"
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>
#include "../../host_tools/data/polygon.h"
#include "../../host_tools/model/electrodes.h"
#include "../../host_tools/scene/outline_shares.h"
#include "../../lib/model/electrode.h"
#include "../rigs/scene_assert.h"
#include "../rigs/uniform.h"

#define OUTLINE_PLATE "tests/rigs/scenes/outline-plate.yaml"
#define DISC "tests/rigs/scenes/disc-mirror.yaml"
#define DISC_DRIVE "actuators=[{name: v, drives: [{patches: p}], applied: 10}];"
#define NO_ACTUATOR "actuators=[];"

static const double pi = 3.14159265358979323846;
static unsigned seed = 1;

/* ---- polygons --------------------------------------------------------- */

enum { STAR = 9, STAR_ROOM = POLYGON_ROOM(STAR) };

/* Random polygon around the origin, in general not convex. */
static void random_star(double size, double (*point)[2])
{
    for (int k = 0; k < STAR; k++) {
        const double angle = 2 * pi * (k + uniform(&seed, 0.1, 0.9)) / STAR,
                     radius = size * uniform(&seed, 0.2, 1);
        point[k][0] = radius * cos(angle);
        point[k][1] = radius * sin(angle);
    }
}

/* Random convex quadrilateral, counterclockwise. */
static void random_quad(double (*quad)[2])
{
    const double middle[2] = {uniform(&seed, -1, 1), uniform(&seed, -1, 1)};
    for (int k = 0; k < 4; k++) {
        const double angle = pi / 2 * (k + uniform(&seed, -0.25, 0.25));
        quad[k][0] = middle[0] + 0.5 * cos(angle);
        quad[k][1] = middle[1] + 0.5 * sin(angle);
    }
}

/* Return whether a point lies inside a polygon, by counting the sides to the right of the point. */
static bool contains(const double (*point)[2], size_t count, double x, double y)
{
    bool is_inside = false;
    for (size_t i = 0; i < count; i++) {
        const double *a = point[i], *b = point[(i + 1) % count];
        if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            is_inside = !is_inside;
    }
    return is_inside;
}

/*
 * Law: the part of a random polygon in a random quadrilateral has the area that 200 x 200 points
 * find, and the area that the sums over pairs of sides find. The parts of a polygon in squares
 * that divide the plane add up to its area.
 */
static void test_clip(void **state)
{
    (void)state;
    for (int k = 0; k < 40; k++) {
        double star[STAR][2], quad[4][2], work[STAR_ROOM][2], out[STAR_ROOM][2], found = 0;
        const double origin[2] = {0, 0};
        enum { SIDE = 200 };
        random_star(1, star);
        random_quad(quad);
        const size_t count =
            polygon_clip((const double(*)[2])star, STAR, (const double(*)[2])quad, work, out);
        const double area = polygon_sums_of((const double(*)[2])out, count, origin).area;
        for (int i = 0; i < SIDE * SIDE; i++) {
            const double x = -1 + 2 * (i % SIDE + 0.5) / SIDE, y = -1 + 2 * (i / SIDE + 0.5) / SIDE;
            found += contains((const double(*)[2])star, STAR, x, y) &&
                     contains((const double(*)[2])quad, 4, x, y);
        }
        assert_true(fabs(area - 4 * found / (SIDE * SIDE)) < 8.0 / SIDE / SIDE * 20);
        const polygon one = {STAR, star}, other = {4, quad};
        assert_true(fabs(polygon_common_area(&one, &other) - area) < 100 * DBL_EPSILON);
        double sum = 0;
        for (int i = 0; i < 64; i++) {
            const double x = -1 + 0.25 * (i % 8), y = -1 + 0.25 * (i / 8);
            const double cell[4][2] = {{x, y}, {x + 0.25, y}, {x + 0.25, y + 0.25}, {x, y + 0.25}};
            const size_t points = polygon_clip((const double(*)[2])star, STAR, cell, work, out);
            sum += polygon_sums_of((const double(*)[2])out, points, cell[0]).area;
        }
        assert_true(fabs(sum - polygon_sums_of((const double(*)[2])star, STAR, origin).area) <
                    100 * DBL_EPSILON);
    }
}

/* Law: the area that two polygons have in common is symmetric, and that of a polygon with itself
 * is its own. */
static void test_common_area(void **state)
{
    (void)state;
    for (int k = 0; k < 100; k++) {
        double a[STAR][2], b[STAR][2];
        const double origin[2] = {0, 0};
        random_star(1, a);
        random_star(0.7, b);
        const polygon one = {STAR, a}, other = {STAR, b};
        const double own = polygon_sums_of((const double(*)[2])a, STAR, origin).area;
        assert_true(fabs(polygon_common_area(&one, &one) - own) < 200 * DBL_EPSILON);
        assert_true(fabs(polygon_common_area(&one, &other) - polygon_common_area(&other, &one)) <
                    200 * DBL_EPSILON);
    }
}

/* Law: lists of points that are no outline are told apart by their fault. */
static void test_polygon_faults(void **state)
{
    (void)state;
    static const struct {
        size_t count;
        double point[5][2];
        polygon_fault fault;
    } row[] = {
        {2, {{0, 0}, {1, 0}}, POLYGON_FEW},
        {4, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, POLYGON_GOOD},
        {4, {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, POLYGON_CROSSED},
        {4, {{0, 0}, {2, 0}, {1, 0}, {1, 1}}, POLYGON_CROSSED}, /* a side runs back on itself */
        {5, {{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}, POLYGON_CROSSED}, /* a corner on a side */
        {3, {{0, 0}, {1, 1}, {2, 2}}, POLYGON_FLAT},
        {4, {{0, 0}, {1, 0}, {1, 0}, {0, 1}}, POLYGON_REPEATED},
        {4, {{0, 0}, {1, 0}, {1, 1}, {0, 0}}, POLYGON_REPEATED},
        {3, {{0, 0}, {1, (double)NAN}, {0, 1}}, POLYGON_INFINITE},
        {3, {{0, 0}, {(double)INFINITY, 0}, {0, 1}}, POLYGON_INFINITE},
        {5, {{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}}, POLYGON_GOOD}, /* a corner in a straight line
                                                                      */
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        size_t at[2];
        assert_int_equal(polygon_check(row[k].point, row[k].count, at), row[k].fault);
    }
}

/* ---- areas ------------------------------------------------------------ */

static const scene_outlines *outlines_of(const scene_run *r, int item)
{
    return r->scene.patches[item].outlines;
}

/* Area of an electrode: its shares times the areas of the elements. */
static double electrode_area(const scene_run *r, int item, int electrode)
{
    const mesh *mesh = &r->analysis.design.mesh;
    double area = 0;
    for (int e = 0; e < mesh->elements; e++)
        area += outline_share(outlines_of(r, item), electrode, e) *
                mesh->place[mesh->element_type[e]].area;
    return area;
}

static void open_outlines(scene_run *r, const char *name, const char *before, const char *patches)
{
    char changes[4000];
    snprintf(changes, sizeof changes, "%s;patches=%s", before, patches);
    open_run(r, name, changes);
}

/* Area of a sector between two radii, whose two sides lie half a gap inside of its radii. */
static double keystone_area(double inner, double outer, double angle, double gap)
{
    double area = 0;
    enum { STEPS = 20000 };
    for (int k = 0; k < STEPS; k++) {
        const double r = inner + (outer - inner) * (k + 0.5) / STEPS;
        area += r * (angle - 2 * asin(gap / 2 / r)) * (outer - inner) / STEPS;
    }
    return area;
}

/*
 * Law: the shares of an electrode add up to its true area: polygons, hexagons and rectangles to
 * rounding, circles too (their polygon has the same area), keystones within 1e-5 (arcs of half a
 * degree), formulas within the square of a sixteenth of an element.
 */
static void test_areas(void **state)
{
    (void)state;
    static const struct {
        const char *outline;
        double area, tolerance;
    } row[] = {
        {"polygon: [[0.1, 0.02], [0.33, 0.11], [0.2, 0.27]]", 0.02425, 1e-12},
        {"polygon: [[0.2, 0.27], [0.33, 0.11], [0.1, 0.02]]", 0.02425, 1e-12},
        {"polygon: [[0.1, 0.1], [0.3, 0.1], [0.3, 0.2], [0.2, 0.13], [0.1, 0.2]]", 0.013, 1e-12},
        {"circle: {centre: [0.21, 0.14], radius: 0.11}", 0.0380132711084365, 1e-12},
        {"hexagons: {pitch: 0.2, gap: 0.01, rings: 0, angle: 7, centre: [0.2, 0.15]}",
         0.03126351707661016, 1e-12},
        {"grid: {from: [0.1, 0.1], to: [0.3, 0.2], count: [1, 1], gap: 0.02, angle: 33}", 0.0144,
         1e-12},
        {"rings: {radii: [0.05, 0.12], sectors: [1], centre: [0.2, 0.15]}", 0.0373849525777, 1e-11},
        {"inside: 0.11^2 - (x - 0.21)^2 - (y - 0.14)^2", 0.0380132711084365, 3e-4},
        {"circle: {centre: [21 cm, 140 mm], radius: 110 mm}", 0.0380132711084365, 1e-12},
        {"inside: x - 0.123", 0.3 * (0.4 - 0.123), 1e-12},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        scene_run r;
        char patches[300];
        snprintf(patches, sizeof patches, "[{name: up, layer: upper, outlines: [{%s}]}]",
                 row[k].outline);
        open_outlines(&r, OUTLINE_PLATE, "name=areas", patches);
        assert_near(row[k].outline, electrode_area(&r, 0, 0), row[k].area, row[k].tolerance);
        scene_run_close(&r);
    }
}

/*
 * Law: the electrodes of rings with gaps are keystones with parallel sides, those of a ring alike,
 * numbered from the inside and from the given direction; hexagons are numbered ring by ring.
 */
static void test_patterns(void **state)
{
    (void)state;
    scene_run r;
    open_outlines(&r, OUTLINE_PLATE, NO_ACTUATOR,
                  "[{name: up, layer: upper, outlines: [{rings: {centre: [0.2, 0.15], radii: [0, "
                  "0.04, 0.13], sectors: [3, 8], gap: 0.006, angle: 20}}]}]");
    assert_int_equal(outlines_of(&r, 0)->electrodes, 11);
    for (int k = 0; k < 11; k++) {
        const double inner = k < 3 ? 0.003 / sin(pi / 3) : 0.043;
        const double outer = k < 3 ? 0.037 : 0.127;
        const double exact = keystone_area(inner, outer, 2 * pi / (k < 3 ? 3 : 8), 0.006);
        assert_near("keystone", electrode_area(&r, 0, k), exact, 1e-5);
        const scene_outline *outline = &outlines_of(&r, 0)->electrode[k];
        const double origin[2] = {0.2, 0.15};
        const polygon_sums sums = polygon_sums_of((const double(*)[2])outline->polygon->point,
                                                  outline->polygon->count, origin);
        const double along = 20 + (k < 3 ? 120 * (k + 0.5) : 45 * (k - 3 + 0.5));
        const double angle = atan2(sums.moment[1], sums.moment[0]) * 180 / pi;
        assert_true(fabs(remainder(angle - along, 360)) < 1e-6);
    }
    scene_run_close(&r);
    open_outlines(&r, OUTLINE_PLATE, NO_ACTUATOR,
                  "[{name: up, layer: upper, outlines: [{hexagons: {centre: [0.2, 0.15], pitch: "
                  "0.05, rings: 2, gap: 0.002, angle: 10}}]}]");
    assert_int_equal(outlines_of(&r, 0)->electrodes, 19);
    for (int k = 0; k < 19; k++) {
        const scene_outline *outline = &outlines_of(&r, 0)->electrode[k];
        const double origin[2] = {0.2, 0.15};
        const polygon_sums sums =
            polygon_sums_of((const double(*)[2])outline->polygon->point, 6, origin);
        const double far = hypot(sums.moment[0], sums.moment[1]) / sums.area,
                     angle = atan2(sums.moment[1], sums.moment[0]) * 180 / pi;
        double wanted = 0;
        if (k > 0)
            wanted = k < 7 ? 0.05 : 0.1;
        if (k >= 7 && k % 2 == 0) /* hexagons between the corners of ring 2 */
            wanted = 0.05 * sqrt(3);
        assert_true(fabs(far - wanted) < 1e-14);
        if (k > 0)
            assert_true(fabs(remainder(angle - 10 - (k < 7 ? 60 * (k - 1) : 30 * (k - 7)), 360)) <
                        1e-9);
        assert_near("hexagon", electrode_area(&r, 0, k), 0.048 * 0.048 * sqrt(3) / 2, 1e-12);
    }
    scene_run_close(&r);
}

/*
 * Law: an outline in theta1 and theta2 has the area of the surface inside of it: exactly on
 * cylinders and polar meshes, to second order on a sphere, also across the seam of a closed
 * coordinate. A circle in the plane xy has its area on a polar mesh, to second order.
 */
static void test_curved_areas(void **state)
{
    (void)state;
#define CURVED(type, more, to, turn)                                                               \
    "surface={type: " type more "};mesh={theta1: {from: 0.5, to: 1, elements: 6}, theta2: {from: " \
    "0, to: " to ", elements: " turn "}};supports=[{edge: theta1-, fix: clamped}];" NO_ACTUATOR
    static const struct {
        const char *before, *outline, *plane;
        double area, tolerance;
    } row[] = {
        {CURVED("cylinder", ", radius: 2, axial: theta1", "1", "5"),
         "polygon: [[0.61, 0.1], [0.9, 0.35], [0.7, 0.9]]", "theta", 2 * 0.10475, 1e-12},
        {CURVED("cylinder", ", radius: 2, axial: theta1", "1", "5"),
         "grid: {from: [610 mm, 10 deg], to: [0.9 m, 40 deg], count: [1, 1]}", "theta",
         0.29 * 2 * 3.14159265358979 / 6, 1e-12},
        {CURVED("polar", "", "2*pi", "24"),
         "grid: {from: [0.6, -0.5], to: [0.9, 0.4], count: [1, "
         "1]}",
         "theta", 0.9 * (0.81 - 0.36) / 2, 1e-12},
        {CURVED("polar", "", "2*pi", "48"), "circle: {centre: [0.75, 0], radius: 0.2}", "xy",
         0.04 * 3.14159265358979, 4e-3},
        {CURVED("sphere", ", radius: 2", "1", "5"),
         "grid: {from: [0.61, 0.1], to: [0.93, 0.77], "
         "count: [1, 1]}",
         "theta", 4 * 0.67 * (0.819648033 - 0.597834056), 2e-4},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        scene_run r;
        char patches[400];
        snprintf(patches, sizeof patches,
                 "[{name: up, layer: upper, plane: %s, outlines: [{%s}]}];outputs=[];"
                 "layers=[{name: lower, material: ceramic, thickness: 1e-3}, {name: upper, "
                 "material: ceramic, thickness: 1e-3}]",
                 row[k].plane, row[k].outline);
        open_outlines(&r, OUTLINE_PLATE, row[k].before, patches);
        assert_near(row[k].outline, electrode_area(&r, 0, 0), row[k].area, row[k].tolerance);
        scene_run_close(&r);
    }
}

/*
 * Law: a circle around the axis of a cap has the area of the cap inside of it, by second order in
 * the size of the elements, although the elements are seen in the plane xy.
 */
static void test_cap(void **state)
{
    (void)state;
    const double sphere = 50e-3, radius = 14.3e-3;
    const double exact = 2 * pi * sphere * (sphere - sqrt(sphere * sphere - radius * radius));
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
        scene_run r;
        char changes[200];
        snprintf(changes, sizeof changes,
                 "mesh={disc: {radius: 25 mm, sphere: 50 mm, elements: %d}};outputs=[];" DISC_DRIVE,
                 8 << fine);
        open_outlines(&r, DISC, changes,
                      "[{name: p, layer: piezo, outlines: [{circle: {radius: 14.3 mm}}]}]");
        error[fine] = electrode_area(&r, 0, 0) / exact - 1;
        scene_run_close(&r);
    }
    print_message("cap: area off by %.2e and %.2e\n", error[0], error[1]);
    assert_true(fabs(error[0]) < 2e-3 && fabs(error[1]) < fabs(error[0]) / 3);
}

/*
 * Law: on a closed box the plane of an outline shows two walls, which is refused with the cure.
 */
static void test_box(void **state)
{
    (void)state;
    static const char *const change[4] = {
        "materials={steel: {E: 200 GPa, nu: 0.3}, piezo: {E: 60e9, nu: 0.3, d31: 1e-10}}",
        "layers=[{material: steel, thickness: 0.5 mm}, {name: top, material: piezo, thickness: 0.1 "
        "mm}]",
        "patches=[{name: p, layer: top, outlines: [{circle: {centre: [0.2, 0.015], radius: "
        "0.009}}]}]",
        "outputs=[]"};
    char error[SCENE_ERROR] = "no fault";
    scene scene;
    assert_int_equal(scene_read(&scene, "tests/rigs/scenes/box-beam.yaml", change, 4, error), -1);
    if (!strstr(error, "meets the surface twice") || !strstr(error, "'sets' on one side alone"))
        fail_msg("%s", error);
}

/* ---- shares ----------------------------------------------------------- */

/* Assert that the shares of all electrodes of the first item add up to 1 in every element. */
static void assert_divided(const scene_run *r, double tolerance)
{
    const scene_outlines *outlines = outlines_of(r, 0);
    for (int element = 0; element < outlines->elements; element++) {
        double sum = 0;
        for (size_t i = outlines->start[element]; i < outlines->start[element + 1]; i++)
            sum += outlines->share[i];
        assert_true(fabs(sum - 1) < tolerance);
    }
}

/*
 * Law: electrodes that divide the surface leave nothing of any element: their shares add up to 1,
 * for polygons, a formula and its opposite, rectangles, hexagons and keystones, on mesh lines and
 * on a disc.
 */
static void test_partition(void **state)
{
    (void)state;
    static const char *const plate[] = {
        ("{polygon: [[0, 0], [0.4, 0], [0.4, 0.1], [0, 0.23]]}, {polygon: [[0, 0.23], [0.4, 0.1], "
         "[0.4, 0.3], [0, 0.3]]}"),
        "{inside: sin(20*x) - 7*y + 1}, {inside: 7*y - 1 - sin(20*x)}",
        "{grid: {from: [0, 0], to: [0.4, 0.3], count: [3, 7]}}",
        "{hexagons: {pitch: 0.3, rings: 1, centre: [0.2, 0.15]}}",
    };
    scene_run r;
    for (size_t k = 0; k < 4; k++) {
        char patches[400];
        snprintf(patches, sizeof patches, "[{name: up, layer: upper, cut: true, outlines: [%s]}]",
                 plate[k]);
        open_outlines(&r, OUTLINE_PLATE, NO_ACTUATOR, patches);
        assert_divided(&r, 64 * DBL_EPSILON);
        scene_run_close(&r);
    }
    open_outlines(&r, DISC, DISC_DRIVE,
                  "[{name: p, layer: piezo, outlines: [{rings: {radii: [0, 7e-3, 13e-3, 26e-3], "
                  "sectors: [1, 5, 12], angle: 11}}], cut: true}]");
    assert_divided(&r, 1e-12); /* corners of the rings' polygons are rounded */
    scene_run_close(&r);
}

/* Law: the shares of random polygons on a distorted mesh are those that 100 x 100 points in each
 * element find. */
static void test_random_shares(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        double star[STAR][2];
        char patches[1200];
        int length =
            snprintf(patches, sizeof patches, "[{name: p, layer: piezo, outlines: [{polygon: [");
        random_star(0.02, star);
        for (int i = 0; i < STAR; i++)
            length += snprintf(patches + length, sizeof patches - (size_t)length,
                               "%s[%.17g, %.17g]", i ? ", " : "", star[i][0], star[i][1]);
        snprintf(patches + length, sizeof patches - (size_t)length, "]}]}]");
        scene_run r;
        open_outlines(&r, DISC, DISC_DRIVE, patches);
        const mesh *mesh = &r.analysis.design.mesh;
        enum { SIDE = 100 };
        for (int e = 0; e < mesh->elements; e++) {
            double inside = 0, all = 0;
            for (int i = 0; i < SIDE * SIDE; i++) {
                const double a = (i % SIDE + 0.5) / SIDE, b = (i / SIDE + 0.5) / SIDE;
                const double weight[4] = {(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b};
                double x[2] = {0, 0}, along[2] = {0, 0}, across[2] = {0, 0};
                const double slope_a[4] = {b - 1, 1 - b, b, -b}, slope_b[4] = {a - 1, -a, a, 1 - a};
                for (int n = 0; n < 4; n++)
                    for (int c = 0; c < 2; c++) {
                        const double at = mesh->point[mesh->element[e][n]].position[c];
                        x[c] += weight[n] * at;
                        along[c] += slope_a[n] * at;
                        across[c] += slope_b[n] * at;
                    }
                const double area = along[0] * across[1] - along[1] * across[0];
                all += area;
                inside += contains((const double(*)[2])star, STAR, x[0], x[1]) ? area : 0;
            }
            assert_true(fabs(outline_share(outlines_of(&r, 0), 0, e) - inside / all) < 0.02);
        }
        scene_run_close(&r);
    }
}

/*
 * Law: a bitmap is the union of its pixels, its first line on top: the shares are those of the
 * rectangles, from a table and from both formats of PGM; a threshold makes one electrode.
 */
static void test_bitmaps(void **state)
{
    (void)state;
    static const char *const file[3] = {"labels.csv", "labels.pgm", "binary.pgm"};
    char folder[] = "/tmp/test_outlines_XXXXXX", path[3][80];
    assert_non_null(mkdtemp(folder));
    static const char *const text[3] = {"1,1,2\n0,3,3\n", "P2\n# labels\n3 2\n255\n1 1 2\n0 3 3\n",
                                        "P5 3 2 255\n\1\1\2\0\3\3"};
    static const size_t bytes[3] = {12, 33, 17};
    scene_run exact;
    open_outlines(&exact, OUTLINE_PLATE, NO_ACTUATOR,
                  "[{name: up, layer: upper, outlines: [{polygon: [[0.05, 0.15], [0.25, 0.15], "
                  "[0.25, 0.25], [0.05, 0.25]]}, {polygon: [[0.25, 0.15], [0.35, 0.15], [0.35, "
                  "0.25], [0.25, 0.25]]}, {polygon: [[0.15, 0.05], [0.35, 0.05], [0.35, 0.15], "
                  "[0.15, 0.15]]}]}]");
    for (int k = 0; k < 3; k++) {
        scene_run r;
        char patches[400];
        snprintf(path[k], sizeof path[k], "%s/%s", folder, file[k]);
        FILE *out = fopen(path[k], "wb");
        assert_non_null(out);
        fwrite(text[k], 1, bytes[k], out);
        fclose(out);
        snprintf(patches, sizeof patches,
                 "[{name: up, layer: upper, outlines: [{bitmap: {file: %s, from: [0.05, 0.05], to: "
                 "[0.35, 0.25]}}]}]",
                 path[k]);
        open_outlines(&r, OUTLINE_PLATE, NO_ACTUATOR, patches);
        assert_int_equal(outlines_of(&r, 0)->electrodes, 3);
        for (int i = 0; i < 3; i++)
            for (int e = 0; e < outlines_of(&r, 0)->elements; e++)
                assert_true(fabs(outline_share(outlines_of(&r, 0), i, e) -
                                 outline_share(outlines_of(&exact, 0), i, e)) < 1e-12);
        scene_run_close(&r);
        snprintf(patches, sizeof patches,
                 "[{name: up, layer: upper, outlines: [{bitmap: {file: %s, from: [0.05, 0.05], to: "
                 "[0.35, 0.25], threshold: 1.5}}]}]",
                 path[k]);
        open_outlines(&r, OUTLINE_PLATE, NO_ACTUATOR, patches);
        assert_int_equal(outlines_of(&r, 0)->electrodes, 1);
        assert_near("threshold", electrode_area(&r, 0, 0), 0.03, 1e-12);
        scene_run_close(&r);
        unlink(path[k]);
    }
    scene_run_close(&exact);
    rmdir(folder);
}

/* ---- inputs ----------------------------------------------------------- */

static void assert_same_rows(const pzs_rows *one, const pzs_rows *other)
{
    assert_int_equal(one->count, other->count);
    assert_memory_equal(one->start, other->start, (one->count + 1u) * sizeof *one->start);
    assert_memory_equal(one->dof, other->dof, one->start[one->count] * sizeof *one->dof);
    assert_memory_equal(one->value, other->value, one->start[one->count] * sizeof *one->value);
}

/*
 * Law: outlines along the sides of elements give the inputs, the charges and the prescribed
 * resultants of patches of whole elements, to the last bit.
 */
static void test_whole_elements(void **state)
{
    (void)state;
    static const char *const change =
        "kinematics=nonlinear;sensors=[{name: s, drives: [{patches: low}]}];outputs=[{name: a, "
        "charge: s}];loads=[{temperature: 10}]";
    scene_run whole, outlined;
    open_outlines(&whole, OUTLINE_PLATE, change,
                  "[{name: up, layer: upper, theta1: [0.1, 0.3], grid: [2, 3]}, {name: low, layer: "
                  "lower, theta1: [0.05, 0.25]}]");
    open_outlines(&outlined, OUTLINE_PLATE, change,
                  "[{name: up, layer: upper, outlines: [{grid: {from: [0.1, 0], to: [0.3, 0.3], "
                  "count: [2, 3]}}]}, {name: low, layer: lower, outlines: [{polygon: [[0.05, 0], "
                  "[0.25, 0], [0.25, 0.3], [0.05, 0.3]]}]}]");
    const design *a = &whole.analysis.design, *b = &outlined.analysis.design;
    assert_same_rows(&a->structure.input, &b->structure.input);
    assert_same_rows(&a->electrodes.direct, &b->electrodes.direct);
    const pzs_prescribed_resultants *g = &whole.analysis.equilibrium.tables.resultants,
                                    *h = &outlined.analysis.equilibrium.tables.resultants;
    const uint32_t entries = g->start[a->structure.input.count];
    assert_int_equal(g->values, h->values);
    assert_memory_equal(g->start, h->start, (a->structure.input.count + 1u) * sizeof *g->start);
    assert_memory_equal(g->element, h->element, entries * sizeof *g->element);
    assert_memory_equal(g->which, h->which, entries * sizeof *g->which);
    assert_memory_equal(g->value, h->value, g->values * sizeof *g->value);
    char name[2][SCENE_LABEL];
    scene_amplifier_name(&whole.scene, 4, name[0]);
    scene_amplifier_name(&outlined.scene, 4, name[1]);
    assert_string_equal(name[0], name[1]); /* a single grid keeps its two indices */
    scene_run_close(&whole);
    scene_run_close(&outlined);
}

/* ---- charges ---------------------------------------------------------- */

/* Charge of electrode k per volt of electrode j while the shell does not deform. */
static double direct_charge(const scene_run *r, uint32_t k, uint32_t j)
{
    const pzs_electrodes *tables = &r->analysis.design.electrodes;
    return pzs_electrode_direct(tables, k, tables->input[j]);
}

/*
 * Law: the capacitance of an electrode is its area times that of the layer per area; electrodes of
 * one layer have none between them, those of two layers the one of the area in common, and the
 * matrix is symmetric.
 */
static void test_capacitance(void **state)
{
    (void)state;
    scene_run whole, r;
    static const char *const change =
        "sensors=[{name: s, drives: [{patches: low}], circuit: short}];outputs=[{name: a, charge: "
        "s}]";
    open_outlines(&whole, OUTLINE_PLATE, change,
                  "[{name: up, layer: upper}, {name: low, layer: lower}]");
    open_outlines(
        &r, OUTLINE_PLATE, change,
        "[{name: up, layer: upper, outlines: [{polygon: [[0.1, 0.02], [0.33, 0.11], [0.2, "
        "0.27]]}, {polygon: [[0.02, 0.02], [0.07, 0.02], [0.02, 0.2]]}]}, {name: low, "
        "layer: lower, outlines: [{grid: {from: [0.11, 0], to: [0.3, 0.3], count: [1, "
        "1]}}]}]");
    const double area[3] = {0.02425, 0.0045, 0.057};
    for (uint32_t k = 0; k < 3; k++) {
        const double full = direct_charge(&whole, k / 2, k / 2) / 0.12;
        assert_near("capacitance", direct_charge(&r, k, k), full * area[k], 1e-12);
    }
    assert_true(fabs(direct_charge(&r, 0, 1)) <= 0);
    const double cross = direct_charge(&whole, 0, 1) / 0.12;
    const double triangle[3][2] = {{0.1, 0.02}, {0.33, 0.11}, {0.2, 0.27}};
    const double strip[4][2] = {{0.11, 0}, {0.3, 0}, {0.3, 0.3}, {0.11, 0.3}};
    double work[POLYGON_ROOM(3)][2], out[POLYGON_ROOM(3)][2];
    const size_t count = polygon_clip(triangle, 3, strip, work, out);
    const double common = polygon_sums_of((const double(*)[2])out, count, strip[0]).area;
    assert_near("coupling", direct_charge(&r, 0, 2), cross * common, 1e-9);
    assert_near("symmetry", direct_charge(&r, 2, 0), direct_charge(&r, 0, 2), 1e-12);
    scene_run_close(&whole);
    scene_run_close(&r);
}

/* ---- refusals --------------------------------------------------------- */

/* Law: an outline that cannot be meant is refused with the electrode, the finding and the cure. */
static void test_refusals(void **state)
{
    (void)state;
#define UP(text) "[{name: up, layer: upper, outlines: [" text "]}]"
    static const char *const row[][2] = {
        {UP("{polygon: [[0, 0], [0.1, 0]]}"), "a polygon of 2 points; give three or more"},
        {UP("{polygon: [[0.1, 0.1], [0.2, 0.2], [0.2, 0.1], [0.1, 0.2]]}"),
         "the sides from points 1 and 3 of the polygon cross or touch"},
        {UP("{polygon: [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]]}"), "lie on a line"},
        {UP("{polygon: [[0.1, 0.1], [0.2, nan], [0.3, 0.3]]}"), "nan"},
        {UP("{polygon: [[0.1, 0.1], [0.2, 1/0], [0.3, 0.3]]}"), "is not finite"},
        {UP("{polygon: [[0.1, 0.1], [0.2, 0.1], [0.2, 0.1], [0.1, 0.2]]}"),
         "points 2 and 3 of the polygon are equal"},
        {UP("{circle: {radius: 0}}"), "must be above 0"},
        {UP("{circle: {radius: 3 V}}"), "expected that of a length"},
        {UP("{circle: {radius: -1}}"), "must be above 0"},
        {UP("{circle: {centre: [2, 2], radius: 0.1}}"),
         "electrode 1 of patches 'up' lies outside the surface"},
        {UP("{circle: {centre: [200, 0], radius: 0.1}}"),
         "move it; all electrodes lie within [200, -0.1] to [200, 0.1], the surface within [0, 0] "
         "to [0.4, 0.3]: compare their units and centres"},
        {UP("{hexagons: {pitch: 60, rings: 1}}"), "compare their units and centres"},
        {UP("{grid: {from: [0, 0], to: [400, 300], count: [2, 2]}}"),
         "compare their units and centres"},
        {UP("{rings: {radii: [0, 60, 100], sectors: [1, 2]}}"), "compare their units and centres"},
        {UP("{circle: {centre: [0.35, 0.15], radius: 0.1}}"),
         "19.6 % of electrode 1 of patches 'up' lie outside the surface or the layer; move or "
         "shrink it, or keep the part inside by 'cut: true'"},
        {UP("{circle: {centre: [0.1, 0.1], radius: 0.05}}, {circle: {centre: [0.15, 0.1], radius: "
            "0.05}}"),
         "electrode 1 of patches 'up' and electrode 2 of patches 'up' overlap on one layer"},
        {UP("{circle: {centre: [0.1, 0.1], radius: 0.05}}, {inside: 0.05^2 - (x-0.17)^2 - "
            "(y-0.1)^2}"),
         "electrode 1 of patches 'up' and electrode 2 of patches 'up' overlap on one layer"},
        {"[{name: up, layer: upper, outlines: [{circle: {centre: [0.1, 0.1], radius: 0.05}}]}, "
         "{name: two, layer: upper, theta1: [0.1, 0.4]}]",
         "electrode 1 of patches 'up' and patches 'two' overlap on one layer"},
        {UP("{hexagons: {pitch: 0.1, gap: 0.1, rings: 1}}"),
         "a gap of 0.1 leaves no electrode of a cell of 0.1; compare their units"},
        {UP("{grid: {from: [0, 0], to: [0.1, 0.1], count: [10, 1], gap: 0.02}}"),
         "a gap of 0.02 leaves no electrode of a cell of 0.01"},
        {UP("{grid: {from: [0.2, 0], to: [0.1, 0.1], count: [1, 1]}}"), "let 'to' be the larger"},
        {UP("{rings: {radii: [0, 0.1], sectors: [1, 2]}}"), "2 numbers of sectors for 1 rings"},
        {UP("{rings: {radii: [0, 0.1, 0.05], sectors: [1, 2]}}"), "follows 0.1"},
        {UP("{inside: sqrt(x - 0.2)}"), "is not a finite number"},
        {UP("{inside: -1}"), "lies outside the surface"},
        {UP("{circle: {radius: 0.1}, inside: x}"), "2 keys in one item of 'outlines'"},
        {UP(""), "'outlines' is empty"},
        {"[{name: up, layer: upper, grid: [1, 1], outlines: [{inside: x}]}]",
         "'grid' belongs to patches of whole elements"},
        {"[{name: up, layer: upper, plane: xy}]", "'plane' belongs to 'outlines'"},
        {"[{name: up, layer: upper, plane: xz, outlines: [{circle: {centre: [0.2, 0], radius: "
         "0.01}}]}]",
         "stands upright on the plane"},
        {UP("{bitmap: {file: none.pgm, from: [0, 0], to: [1, 1]}}"), "cannot read it"},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        char change[700], error[SCENE_ERROR] = "no fault";
        const char *set[1] = {change};
        scene scene;
        snprintf(change, sizeof change, "patches=%s", row[k][0]);
        const int status = scene_read(&scene, OUTLINE_PLATE, set, 1, error);
        if (status == 0)
            scene_free(&scene);
        if (status == 0 || !strstr(error, row[k][1]))
            fail_msg("%s: expected '%s', got '%s'", row[k][0], row[k][1], error);
    }
    static const char *const patched[] = {
        "layers=[{name: lower, material: ceramic, thickness: 1e-3}, {name: upper, material: "
        "ceramic, thickness: 1e-3, patched: true}]"};
    char error[SCENE_ERROR] = "no fault";
    scene scene;
    assert_int_equal(scene_read(&scene, OUTLINE_PLATE, patched, 1, error), -1);
    assert_non_null(strstr(error, "the layer 'upper' is patched"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_clip),
        cmocka_unit_test(test_common_area),
        cmocka_unit_test(test_polygon_faults),
        cmocka_unit_test(test_areas),
        cmocka_unit_test(test_patterns),
        cmocka_unit_test(test_curved_areas),
        cmocka_unit_test(test_cap),
        cmocka_unit_test(test_box),
        cmocka_unit_test(test_partition),
        cmocka_unit_test(test_random_shares),
        cmocka_unit_test(test_bitmaps),
        cmocka_unit_test(test_whole_elements),
        cmocka_unit_test(test_capacitance),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
