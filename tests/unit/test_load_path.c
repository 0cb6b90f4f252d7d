/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Load paths: points are equilibria, limit points and bifurcations lie where theory and literature
 * say, and an equilibrium that depends on the way of loading is named.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/follow_path.h"
#include "../../host_tools/model/path_cause.h"
#include "../rigs/scene_assert.h"

/* 1: also the rows that take seconds each. */
#ifndef SLOW_ROWS
#define SLOW_ROWS 0
#endif

#define ROOF_8 "mesh.theta1.elements=8;mesh.theta2.elements=8"
#define COLUMN "tests/rigs/scenes/column.yaml"
#define COLUMN_OUTPUTS                                                                             \
    "outputs=[{name: back, x: middle, at: {theta1: 100, theta2: 0}}, {name: up, z: middle, at: "   \
    "{theta1: 100, theta2: 0}}]"
#define PULLED "tests/rigs/scenes/pulled-cylinder.yaml"

#define OPEN_COLUMN "tests/rigs/scenes/open-column.yaml"

static void follow(scene_run *run, load_path *path, const char *scene, const char *changes)
{
    open_run(run, scene, changes);
    if (load_path_follow(path, &run->analysis, run->error) < 0 || !path->is_complete)
        fail_msg("%s", run->error);
}

/* First value of output k of the scene at a point of the path. */
static double value_at(const load_path *path, int point, int k)
{
    return path->value[(size_t)point * (size_t)path->outputs + (size_t)k];
}

/* Value of the scene's first output at a point of the path. */
static double output_at(const load_path *path, int point)
{
    return value_at(path, point, 0);
}

/*
 * Solve for a part of the load, in small load steps. Returns output k, or NAN where no equilibrium
 * is found, as above a limit load.
 */
static double output_by_load_steps(const char *scene, const char *changes, double load_factor,
                                   int k)
{
    scene_run run;
    open_run(&run, scene, changes);
    pzs_solver *solver = &run.analysis.equilibrium.solver;
    const uint32_t inputs = run.analysis.design.structure.input.count;
    double *value = calloc(inputs, sizeof *value);
    assert_non_null(value);
    for (uint32_t j = 0; j < inputs; j++)
        value[j] = load_factor * run.analysis.equilibrium.full_input[j];
    solver->settings.load_steps = 8;
    solver->settings.tolerance = 1e-8;
    solver->settings.solve_limit = 10000;
    const pzs_status status = pzs_equilibrium(solver, value);
    assert_true(status == PZS_OK || status == PZS_E_DIVERGED || status == PZS_E_LIMIT);
    assert_int_equal(analysis_electrodes(&run.analysis, value), PZS_OK);
    scene_run_observe(&run, solver->info.displacement);
    const double result = status == PZS_OK ? scene_run_value(&run, k) : (double)NAN;
    free(value);
    scene_run_close(&run);
    return result;
}

static double by_load_steps(const char *scene, const char *changes, double load_factor)
{
    return output_by_load_steps(scene, changes, load_factor, 0);
}

/* Before the first limit point the path consists of the equilibria that load steps find. */
static void test_points_are_equilibria(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, "hinged-roof", ROOF_8);
    for (int i = 4; i < path.event[0].point; i += 4) {
        const double other = by_load_steps("hinged-roof", ROOF_8, path.point[i].load_factor);
        assert_true(fabs(output_at(&path, i) / other - 1) < 1e-7);
        assert_int_equal(path.point[i].negative_pivots, 0);
    }
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * Limit load of the roof of 12.7 mm: 2225 N (Sze, Liu, Lo 2004), within 1 %; the part between the
 * limit points is unstable.
 */
static void test_snap_through(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, "hinged-roof", "");
    assert_int_equal(path.events, 2);
    assert_int_equal(path.event[0].type, LOAD_PATH_LIMIT);
    assert_int_equal(path.event[1].type, LOAD_PATH_LIMIT);
    assert_true(fabs(path.event[0].load_factor * 3000 / 2225 - 1) < 0.01);
    for (int i = 0; i < path.points; i++) {
        const int is_between = i > path.event[0].point && i <= path.event[1].point;
        assert_int_equal(path.point[i].negative_pivots, is_between);
    }
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * The limit point is located to 1e-4 of the load: a load below it by that much still has an
 * equilibrium on the path, no point of the path lies above, and one lies within 1 %; a load above
 * it has none there: load steps end behind the snap-through, or nowhere.
 */
static void test_limit_is_located(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, "hinged-roof", ROOF_8);
    const double limit = path.event[0].load_factor;
    double highest = 0;
    for (int i = 0; i <= path.event[1].point; i++)
        highest = fmax(highest, path.point[i].load_factor);
    assert_true(highest <= limit * (1 + 1e-6) && highest > 0.99 * limit);
    const double there = fabs(path.event_value[0]); /* of the centre, at the limit point */
    assert_true(there > fabs(output_at(&path, path.event[0].point)) &&
                there < fabs(output_at(&path, path.event[0].point + 1)));
    const double below = by_load_steps("hinged-roof", ROOF_8, limit * (1 - 1e-4));
    assert_true(fabs(below) < there);
    const double above = by_load_steps("hinged-roof", ROOF_8, limit * (1 + 1e-4));
    assert_true(isnan(above) || fabs(above) > fabs(output_at(&path, path.event[1].point)));
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * The roof of 6.35 mm snaps back: load and displacement of the centre decrease together, the
 * displacement by more than a tenth of the largest value before.
 */
static void test_snap_back(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    double largest = 0, returned = 0;
    follow(&run, &path, "hinged-roof", ROOF_8 ";layers.0.thickness=6.35");
    for (int i = 1; i < path.points && i <= path.event[1].point; i++) {
        const double step = fabs(output_at(&path, i)) - fabs(output_at(&path, i - 1));
        largest = fmax(largest, fabs(output_at(&path, i)));
        if (path.point[i].load_factor < path.point[i - 1].load_factor && step < 0)
            returned -= step;
    }
    print_message("the centre moves back by %.3f of %.3f mm\n", returned, largest);
    assert_true(returned > 0.1 * largest);
    assert_true(path.event[1].load_factor < 0);
    load_path_free(&path);
    scene_run_close(&run);
}

/* A published point of the curve of a hinged roof: the first maximum of the force. */
typedef struct roof {
    const char *scene, *changes;
    double force;      /* N, of the 3000 N at load factor 1 */
    double deflection; /* of the centre (mm) */
} roof;

#define PLY(h, angle) "{material: ply, thickness: " h "/3, angle: " angle "}"
#define PLIES(h, outer, inner) "layers=[" PLY(h, outer) ", " PLY(h, inner) ", " PLY(h, outer) "]"

static const roof roofs[] = {
    {"hinged-roof-crossply", "", 1085.4, 9.884},
    {"hinged-roof-crossply", PLIES("12.7", "90", "0"), 1791.0, 14.192},
    {"hinged-roof", "", 2226.3, 11.293},
    {"hinged-roof-crossply", PLIES("6.35", "0", "90"), 234.6, 12.280},
    {"hinged-roof-crossply", PLIES("6.35", "90", "0"), 475.5, 15.905},
    {"hinged-roof", "layers.0.thickness=6.35", 585.9, 12.892},
};

/* The load factor (of_load) or the size of the first output of a point of the path. */
static double coordinate(const load_path *path, int point, bool of_load)
{
    return of_load ? path->point[point].load_factor : fabs(output_at(path, point));
}

/*
 * Where the curve of load factor over the first output first reaches a value of one of both
 * coordinates, the value of the other one: from the parabola through the last point before the
 * value and the points before and after that one; NAN where the curve does not reach the value.
 *   of_load in  whether `value` is a load factor, rather than a size of the output
 */
static double curve_at(const load_path *path, double value, bool of_load)
{
    int last = 1;
    double sum = 0;
    while (last + 1 < path->points && coordinate(path, last + 1, of_load) < value)
        last++;
    if (last + 1 >= path->points)
        return (double)NAN;
    for (int j = last - 1; j <= last + 1; j++) {
        double share = coordinate(path, j, !of_load);
        for (int k = last - 1; k <= last + 1; k++)
            if (k != j)
                share *= (value - coordinate(path, k, of_load)) /
                         (coordinate(path, j, of_load) - coordinate(path, k, of_load));
        sum += share;
    }
    return sum;
}

/*
 * Published points lie on the curves of the roofs within 1 %, and every curve goes on through its
 * limit points to the full load.
 */
static void test_published_roofs(void **state)
{
    (void)state;
    const size_t count = SLOW_ROWS ? sizeof roofs / sizeof *roofs : 1;
    for (size_t i = 0; i < count; i++) {
        scene_run run;
        load_path path;
        follow(&run, &path, roofs[i].scene, roofs[i].changes);
        const double force = 3000 * curve_at(&path, roofs[i].deflection, false);
        print_message("%s %s: %.1f N at %g mm, published %.1f\n", roofs[i].scene, roofs[i].changes,
                      force, roofs[i].deflection, roofs[i].force);
        assert_true(fabs(force / roofs[i].force - 1) < 0.01);
        assert_true(path.events >= 2 && path.event[0].type == LOAD_PATH_LIMIT);
        load_path_free(&path);
        scene_run_close(&run);
    }
}

/* Published curve of the scene semi-cylinder: load factor, displacement of the crown (mm). */
static const double half_cylinder[][2] = {
    {.05, 5.421},   {.1, 16.1},     {.125, 22.195}, {.15, 27.657},  {.175, 32.7},
    {.2, 37.582},   {.225, 42.633}, {.25, 48.537},  {.275, 56.355}, {.3, 66.410},
    {.325, 79.810}, {.35, 94.669},  {.4, 113.704},  {.45, 124.751}, {.5, 132.653},
    {.55, 138.920}, {.6, 144.185},  {.65, 148.770}, {.7, 152.863},  {.75, 156.584},
    {.8, 160.015},  {.85, 163.211}, {.9, 166.200},  {.95, 168.973}, {1, 171.505},
};

/*
 * Every published point of the pressed half cylinder up to a load factor lies near the computed
 * curve: in displacement at its load, or, where the curve is flat, in load at its displacement. The
 * curve has no limit point and no bifurcation.
 */
static void test_half_cylinder(void **state)
{
    (void)state;
    const double most = SLOW_ROWS ? 1 : 0.35;
    const double tolerance = SLOW_ROWS ? 0.007 : 0.035;
    scene_run run;
    load_path path;
    follow(&run, &path, "semi-cylinder",
           SLOW_ROWS ? ""
                     : "mesh.theta1={from: 0, to: 304.8, elements: 16};"
                       "mesh.theta2={from: 0, to: pi/2, elements: 16};loads.0.u3=-0.4*1000");
    assert_int_equal(path.events, 0);
    assert_int_equal(path.point[path.points - 1].negative_pivots, 0);
    for (size_t i = 0; i < sizeof half_cylinder / sizeof *half_cylinder; i++) {
        const double *known = half_cylinder[i], part = SLOW_ROWS ? 1 : 0.4;
        if (known[0] > most)
            break;
        const double moved = curve_at(&path, known[0] / part, true),
                     load = part * curve_at(&path, known[1], false);
        const double apart = fmin(fabs(moved / known[1] - 1), fabs(load / known[0] - 1));
        print_message("load factor %.3f: %.3f mm, published %.3f; %.4f apart\n", known[0], moved,
                      known[1], apart);
        assert_true(apart < tolerance);
    }
    load_path_free(&path);
    scene_run_close(&run);
}

#if SLOW_ROWS
#define PLIES_0_90_0                                                                               \
    "layers=[{material: ply, thickness: 1}, {material: ply, thickness: 1, angle: 90}, {material: " \
    "ply, thickness: 1}];"
#define PLIES_90_0_90                                                                              \
    "layers=[{material: ply, thickness: 1, angle: 90}, {material: ply, thickness: 1}, {material: " \
    "ply, thickness: 1, angle: 90}];"

#define FINE_MESH                                                                                  \
    ";mesh.theta1.elements=64;mesh.theta1.grading=0.2;mesh.theta2.elements=40;"                    \
    "mesh.theta2.grading=0.5"

/* Displacement of the crown under the full load, on a path without a critical point. */
static double crown_at_full_load(const char *changes)
{
    scene_run run;
    load_path path;
    follow(&run, &path, "semi-cylinder", changes);
    assert_int_equal(path.events, 0);
    for (int i = 0; i < path.points; i++)
        assert_int_equal(path.point[i].negative_pivots, 0);
    const double crown = output_at(&path, path.points - 1);
    load_path_free(&path);
    scene_run_close(&run);
    return crown;
}

/*
 * Without squared heights in products of displacements the half cylinders of cross plies are
 * followed to their full load, without limit point and bifurcation. A finer mesh moves the end by
 * less than 0.2 %.
 */
static void test_half_cylinder_crossply(void **state)
{
    static const char *const plies[] = {PLIES_0_90_0, PLIES_90_0_90};
    (void)state;
    for (int i = 0; i < 2; i++) {
        char changes[2][512];
        for (int fine = 0; fine < 2; fine++)
            snprintf(changes[fine], sizeof changes[fine], "%selement={quadratic: omitted}%s",
                     plies[i], fine ? FINE_MESH : "");
        const double crown = crown_at_full_load(changes[0]), finer = crown_at_full_load(changes[1]);
        print_message("%s: crown %.3f mm at full load, on the finer mesh %.3f mm\n", plies[i],
                      crown, finer);
        assert_true(fabs(crown / finer - 1) < 0.002);
    }
}

/*
 * With Green's strains of the whole thickness the half cylinder of plies [0/90/0] has a limit point
 * just below its full load on a mesh whose elements at the fold are no longer than the shell is
 * thick: the material softens, because the inner face is compressed by more than a strain of 1/3.
 */
static void test_half_cylinder_material_limit(void **state)
{
    scene_run run;
    load_path path;
    (void)state;
    open_run(&run, "semi-cylinder", PLIES_0_90_0);
    assert_int_equal(load_path_follow(&path, &run.analysis, run.error), 0);
    assert_false(path.is_complete);
    assert_int_equal(path.event[0].type, LOAD_PATH_LIMIT);
    const load_path_point *point = &path.point[path.event[0].point];
    print_message("[0/90/0]: limit point at %.4f, strain %.3f, turn %.1f degrees\n",
                  path.event[0].load_factor, point->compression.strain, point->turn);
    assert_true(path.event[0].load_factor > 0.97 && path.event[0].load_factor < 1);
    assert_true(point->compression.strain < -1. / 3);
    assert_non_null(strstr(run.error, "element: {quadratic: omitted}"));
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * On 32 x 32 equal elements the half cylinder of plies [0/90/0] has its first limit point where it
 * folds at the free end of its straight edge, far from the force: the fold runs through one
 * element, as the message of the path says, and the thickness changes by less than a fifth of the
 * compression of the inner face. With squared heights from the faces the same mesh carries a tenth
 * of the load less, because a compressed strip then loses three times as much of its bending
 * stiffness.
 */
static void test_half_cylinder_softens(void **state)
{
    double limit[2];
    (void)state;
    for (int faces = 0; faces < 2; faces++) {
        char changes[400];
        scene_run run;
        load_path path;
        snprintf(changes, sizeof changes, "%s%s",
                 PLIES_0_90_0 "mesh.theta1={from: 0, to: 304.8, elements: 32};"
                              "mesh.theta2={from: 0, to: pi/2, elements: 32};",
                 faces ? "element={quadratic: off}" : "");
        open_run(&run, "semi-cylinder", changes);
        assert_int_equal(load_path_follow(&path, &run.analysis, run.error), 0);
        assert_false(path.is_complete);
        assert_int_equal(path.event[0].type, LOAD_PATH_LIMIT);
        const load_path_point *point = &path.point[path.event[0].point];
        const mesh *mesh = &run.analysis.design.mesh;
        const double *theta = mesh->theta[mesh->element[point->compression.element][2]];
        limit[faces] = point->load_factor;
        print_message("[0/90/0]: limit point at %.4f, strain %.3f\n", point->load_factor,
                      point->compression.strain);
        assert_int_equal(point->compression.face, 0);
        assert_true(fabs(point->thickness_strain) < 0.2 * fabs(point->compression.strain));
        assert_true(theta[0] > 300 && theta[1] > 1.5);
        assert_true(faces || strstr(run.error, "refine the mesh where it folds sharply"));
        load_path_free(&path);
        scene_run_close(&run);
    }
    assert_true(limit[0] > limit[1] + 0.08);
}

#endif

/*
 * The pulled cylinder with six dof a node: on every mesh one load step, two, and the load path end
 * at the same stable equilibrium, near the published one.
 */
static void test_pulled_cylinder(void **state)
{
    (void)state;
    static const char *const mesh[] = {"mesh.theta1.elements=8;mesh.theta2.elements=12", "",
                                       "mesh.theta1.elements=12;mesh.theta2.elements=16",
                                       "mesh.theta1.elements=16;mesh.theta2.elements=16",
                                       "mesh.theta1.elements=24;mesh.theta2.elements=36"};
    for (int i = 0; i < (SLOW_ROWS ? 5 : 2); i++) {
        double load_factor;
        scene_run run;
        load_path path;
        solve_run(&run, "pulled-cylinder", mesh[i]);
        const double one_step = scene_run_value(&run, 0);
        assert_int_equal(run.analysis.equilibrium.solver.info.negative_pivots, 0);
        assert_true(analysis_path_difference(&run.analysis, run.u, &load_factor) < 1e-4);
        scene_run_close(&run);
        follow(&run, &path, "pulled-cylinder", mesh[i]);
        for (int k = 0; k < path.points; k++)
            assert_int_equal(path.point[k].negative_pivots, 0);
        assert_int_equal(analysis_continue(&run.analysis, run.u, run.error), 0);
        scene_run_observe(&run, run.u);
        assert_true(fabs(scene_run_value(&run, 0) / one_step - 1) < 1e-4);
        assert_true(fabs(one_step / 2.768 - 1) < 0.01);
        load_path_free(&path);
        scene_run_close(&run);
    }
}

/* A column buckles at Euler's force, half the load of the scene, within the error of 16 elements.
 */
static void test_column_of_euler(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, COLUMN, "");
    assert_int_equal(path.events, 1);
    assert_int_equal(path.event[0].type, LOAD_PATH_BIFURCATION);
    assert_true(fabs(path.event[0].load_factor / 0.5 - 1) < 0.005);
    load_path_free(&path);
    scene_run_close(&run);
}

/* Euler's elastica of a cantilever of length 1 that ends there. */
typedef struct elastica {
    double load; /* force over Euler's critical force */
    double back; /* displacement of the tip along the force */
    double up;   /* displacement of the tip across the force */
} elastica;

/*
 * Elastica of a cantilever whose tip turns by an angle, with the complete elliptic integrals K and
 * E of the modulus p = sin(angle/2) by arithmetic-geometric means: the force is (2 K/pi)^2 times
 * the critical one, the tip is at the height 2 p/K and at the length 2 E/K - 1.
 */
static elastica elastica_of(double angle)
{
    const double p = sin(angle / 2);
    double a = 1, b = sqrt(1 - p * p), sum = p * p / 2, weight = 1;
    for (int i = 0; i < 30; i++) {
        const double c = (a - b) / 2, mean = (a + b) / 2;
        b = sqrt(a * b);
        a = mean;
        sum += weight * c * c;
        weight *= 2;
    }
    const double k = acos(-1.0) / (2 * a), ratio = 1 - sum; /* E/K */
    return (elastica){4 * k * k / (acos(-1.0) * acos(-1.0)), 2 - 2 * ratio, 2 * p / k};
}

/* Elastica under a force, over the critical force, by bisection of the angle of the tip. */
static elastica elastica_under(double load)
{
    double low = 0, high = 3;
    for (int i = 0; i < 60; i++) {
        const double middle = (low + high) / 2;
        if (elastica_of(middle).load < load)
            low = middle;
        else
            high = middle;
    }
    return elastica_of(low);
}

/*
 * At Euler's force the load path of a column is left on request: each point of the branch is
 * Euler's elastica within the error of 16 elements, to both sides, and stable, while the straight
 * column is not.
 */
static void test_branch_of_column(void **state)
{
    (void)state;
    for (int branch = -1; branch <= 1; branch += 2) {
        scene_run run;
        load_path path;
        double up = 0;
        open_run(&run, COLUMN, COLUMN_OUTPUTS);
        if (load_path_follow_branch(&path, &run.analysis, branch, run.error) < 0)
            fail_msg("%s", run.error);
        assert_true(path.is_complete && path.branch_point > 0);
        const double critical = path.event[0].load_factor;
        for (int i = path.branch_point + 1; i < path.points; i++) {
            const elastica known = elastica_under(path.point[i].load_factor / critical);
            const double back = -value_at(&path, i, 0) / 100;
            up = value_at(&path, i, 1) / 100;
            assert_int_equal(path.point[i].negative_pivots, 0);
            if (path.point[i].load_factor > 1.01 * critical) {
                assert_true(fabs(back / known.back - 1) < 0.015);
                assert_true(fabs(fabs(up) / known.up - 1) < 0.015);
            }
        }
        assert_true(branch * up > 0);
        load_path_free(&path);
        scene_run_close(&run);
    }
}

/*
 * A whole thin roof, not a quarter, leaves its symmetric path before the limit point, to one side.
 * The branch is a closed curve: it ends where it returns to its bifurcation, with the load there.
 */
static void test_branch_of_roof(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    open_run(&run, "hinged-roof",
             "mesh.theta1={from: -254, to: 254, elements: 4};mesh.theta2={from: -0.2, to: 0.2, "
             "elements: 16};layers.0.thickness=6.35;loads.0.u3=-600;supports=[{edge: theta2-, fix: "
             "[u1 mean, u2 mean, u3 mean]}, {edge: theta2+, fix: [u1 mean, u2 mean, u3 mean]}]");
    if (load_path_follow_branch(&path, &run.analysis, 1, run.error) < 0)
        fail_msg("%s", run.error);
    assert_true(path.is_closed && !path.is_complete);
    assert_non_null(strstr(run.error, "returns to its bifurcation"));
    const double begin = path.event[0].load_factor, end = path.point[path.points - 1].load_factor;
    print_message("begins at %.4f, ends at %.4f after %d points\n", begin, end, path.points);
    assert_true(path.points < 200 && fabs(end / begin - 1) < 0.02);
    load_path_free(&path);
    scene_run_close(&run);
}

/* Scenes whose path has no critical point, so that one load step ends at its end. */
static const struct {
    const char *scene, *changes;
} smooth_paths[] = {
    {"hemisphere", "mesh.theta1.elements=8;mesh.theta2.elements=8"},
    {"torus-isotropic", ""},
    {"hyperboloid-patches", "mesh.theta1.elements=8;mesh.theta2.elements=8"},
};

/*
 * The path ends exactly at the full load, at the equilibrium that one load step finds, without
 * leaving its branch: also with long steps, with follower loads, and with applied voltages.
 */
static void test_path_ends_at_full_load(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof smooth_paths / sizeof *smooth_paths; i++) {
        scene_run run;
        load_path path;
        follow(&run, &path, smooth_paths[i].scene, smooth_paths[i].changes);
        const int last = path.points - 1;
        const double other = by_load_steps(smooth_paths[i].scene, smooth_paths[i].changes, 1);
        assert_int_equal(path.events, 0);
        assert_true(path.point[last].load_factor == 1);
        assert_int_equal(path.point[last].negative_pivots, 0);
        assert_true(fabs(output_at(&path, last) / other - 1) < 1e-6);
        load_path_free(&path);
        scene_run_close(&run);
    }
}

/*
 * Open electrodes stiffen a column of two piezoelectric layers by 1 + q, q = 0.3, and so raise the
 * load at which it buckles: with one electrode for each element, and with outer faces that have a
 * potential at each node.
 */
static void test_open_electrodes_stiffen(void **state)
{
    (void)state;
    static const char *const changes[] = {
        "", "layers.lower.bare=inner;layers.upper.bare=outer;patches=[];sensors=[];outputs=[]"};
    for (int i = 0; i < 2; i++) {
        scene_run run;
        load_path path;
        follow(&run, &path, OPEN_COLUMN, changes[i]);
        assert_int_equal(path.events, 1);
        assert_int_equal(path.event[0].type, LOAD_PATH_BIFURCATION);
        assert_true(fabs(path.event[0].load_factor / (0.5 * 1.3) - 1) < 0.005);
        load_path_free(&path);
        scene_run_close(&run);
    }
}

/*
 * With open electrodes the path consists of the equilibria, displacement and voltage, that load
 * steps find; a temperature brings charges onto the electrodes besides.
 */
static void test_open_electrodes_in_equilibrium(void **state)
{
    (void)state;
    static const char changes[] = "loads=[{line: theta1+, u3: 0.1}, {temperature: 5}];"
                                  "materials.m.pyroelectric=20;sensors.s.drives=[{patches: up}]";
    scene_run run;
    load_path path;
    follow(&run, &path, OPEN_COLUMN, changes);
    for (int i = 6; i < path.points; i += 6)
        for (int k = 0; k < 2; k++) {
            const double other =
                output_by_load_steps(OPEN_COLUMN, changes, path.point[i].load_factor, k);
            assert_true(fabs(value_at(&path, i, k) / other - 1) < 1e-7);
        }
    assert_true(fabs(output_at(&path, path.points - 1)) > 10);
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * With contact the path consists of the equilibria that load steps find, at equal parts of the
 * load, and its points hold the contact force, which at the end is the published one within 0.5 %.
 */
static void test_contact_in_equal_steps(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, "ring-contact", "");
    assert_true(path.has_equal_steps && path.points == 21);
    for (int i = 0; i < path.points; i++)
        assert_true(fabs(path.point[i].load_factor - i / 20.0) < 1e-12);
    for (int k = 0; k < 3; k++) {
        const double other = output_by_load_steps("ring-contact", "", 0.5, k);
        assert_true(fabs(value_at(&path, 10, k) / other - 1) < 1e-6);
    }
    assert_true(fabs(value_at(&path, 20, 1) / run.scene.output[1].reference - 1) < 0.005);
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * The pulled cylinder: one load step ends off the path, which the comparison says; the path leads
 * to the published displacement within 1 %. The comparison leaves the solver as it was.
 */
static void test_answer_off_the_path(void **state)
{
    (void)state;
    double load_factor;
    scene_run run;
    load_path path;
    solve_run(&run, PULLED, "");
    const pzs_solver_info before = run.analysis.equilibrium.solver.info;
    assert_true(analysis_path_difference(&run.analysis, run.u, &load_factor) > 0.01);
    assert_memory_equal(&before, &run.analysis.equilibrium.solver.info, sizeof before);
    assert_memory_equal(run.u, run.analysis.equilibrium.solver.info.displacement,
                        (size_t)run.analysis.design.mesh.free_dof * sizeof *run.u);
    scene_run_close(&run);
    follow(&run, &path, PULLED, "");
    assert_int_equal(analysis_continue(&run.analysis, run.u, run.error), 0);
    scene_run_observe(&run, run.u);
    assert_true(fabs(scene_run_value(&run, 0) / 2.768 - 1) < 0.01);
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * A column of the radius R that is pushed together by a prescribed displacement d: one load step
 * ends off the path, which the comparison says. The path leads to the deflection w (1 - cos(2 pi
 * x/L))/2 of a buckled column with clamped ends under the force N: its line of length L shortens by
 * the compression alone, pi^2 w^2/(4 L) + w L/(2 R) = d - N L/(E A), within 2 % for the shape.
 */
static void test_pushed_column(void **state)
{
    (void)state;
    double load_factor;
    scene_run run;
    load_path path;
    const double pi = 3.14159265358979324, length = 400, push = 0.8, stiffness = 70000 * 80;
    const double radius = 20000;
    solve_run(&run, "tests/rigs/scenes/pushed-column.yaml", "");
    assert_true(analysis_path_difference(&run.analysis, run.u, &load_factor) > 0.01);
    scene_run_close(&run);
    follow(&run, &path, "tests/rigs/scenes/pushed-column.yaml", "");
    const int last = path.points - 1;
    const double w = value_at(&path, last, 0), force = -value_at(&path, last, 1);
    const double longer = pi * pi * w * w / (4 * length) + w * length / (2 * radius);
    assert_int_equal(path.point[last].negative_pivots, 0);
    assert_true(fabs(longer / (push - force * length / stiffness) - 1) < 0.02);
    load_path_free(&path);
    scene_run_close(&run);
}

/* Where the answer does not depend on the way, the difference is of the size of the tolerance. */
static void test_answer_on_the_path(void **state)
{
    (void)state;
    static const char *const scene[] = {"hyperboloid", "ring-contact"};
    static const char *const changes[] = {"mesh.theta1.elements=8;mesh.theta2.elements=8", ""};
    for (int i = 0; i < 2; i++) {
        double load_factor;
        scene_run run;
        solve_run(&run, scene[i], changes[i]);
        assert_true(analysis_path_difference(&run.analysis, run.u, &load_factor) < 1e-4);
        scene_run_close(&run);
    }
}

#define BLOCK "tests/rigs/scenes/block.yaml"

/*
 * Law: a block whose stress is linear in Green's strain, E (l^2 - 1)/2 at the ratio of lengths l,
 * carries the force E l (l^2 - 1)/2 per undeformed area. The force is largest at l = 1/sqrt(3), the
 * strain -1/3, and is E/(3 sqrt(3)) there; the path locates that limit point to 1e-4 and names the
 * compression as its cause. At each point of the path the strain follows from the displacement.
 */
static void test_material_softens(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    char cause[PATH_CAUSE_BYTES];
    int limit = 0;
    follow(&run, &path, BLOCK, "");
    while (limit < path.events && path.event[limit].type != LOAD_PATH_LIMIT)
        limit++;
    assert_true(limit < path.events);
    assert_true(fabs(path.event[limit].load_factor / (4 / (3 * sqrt(3))) - 1) < 1e-4);
    for (int i = 0; i <= path.event[limit].point; i++) {
        const double l = 1 + output_at(&path, i);
        assert_true(fabs(path.point[i].compression.strain - (l * l - 1) / 2) < 1e-12);
        assert_true(fabs(path.point[i].load_factor + 4 * l * (l * l - 1) / 2) < 1e-7);
    }
    assert_true(path_is_softened(&path));
    path_cause(&path, &run.analysis, cause);
    assert_non_null(strstr(cause, "Hooke's law for Green strains softens"));
    load_path_free(&path);
    scene_run_close(&run);
}

/* Supports of the hinged roof of which the hinge is moved by a prescribed displacement. */
static const char moved_hinge[] =
    ROOF_8 ";supports=[{edge: theta1-, fix: symmetric}, {edge: theta2-, fix: symmetric}, {edge: "
           "theta2+, fix: [u1 mean, u2 mean]}, {edge: theta2+, fix: u3 mean, value: -0.01}]";

/*
 * Load control on request: the path of a roof below its limit load has equal load steps, whose
 * points are those of the arc-length method at the same loads; --branch is refused beside it.
 * Displacement control: the force on a pushed centre passes its maximum, which is that limit load.
 */
static void test_control_on_request(void **state)
{
    (void)state;
    static const char *const pushed = ROOF_8
        ";loads=[];supports=[{edge: theta1-, fix: symmetric}, {edge: theta2-, fix: symmetric}, "
        "{edge: theta2+, fix: [u1 mean, u2 mean, u3 mean]}, {name: centre, at: {theta1: 0, "
        "theta2: 0}, fix: u3 mean, value: -20}];outputs=[{name: f, reaction: z, support: "
        "centre}];equilibrium={load_steps: 80}";
    scene_run run;
    load_path path;
    double highest = 0;
    follow(&run, &path, "hinged-roof", ROOF_8);
    const double limit = path.event[0].load_factor * 750;
    load_path_free(&path);
    scene_run_close(&run);
    follow(&run, &path, "hinged-roof",
           ROOF_8 ";loads.0.u3=-500;equilibrium={path: load_steps, tolerance: 1e-8}");
    assert_true(path.has_equal_steps && path.points == 21);
    for (int i = 5; i < path.points; i += 5) {
        const double load = path.point[i].load_factor * 500 / 750;
        assert_true(fabs(output_at(&path, i) / by_load_steps("hinged-roof", ROOF_8, load) - 1) <
                    1e-6);
    }
    load_path_free(&path);
    assert_true(load_path_follow_branch(&path, &run.analysis, 1, run.error) < 0);
    assert_non_null(strstr(run.error, "needs the arc-length method"));
    scene_run_close(&run);
    follow(&run, &path, "hinged-roof", pushed);
    for (int i = 0; i < path.points; i++)
        highest = fmax(highest, fabs(output_at(&path, i)));
    print_message("largest force %.3f, limit load %.3f\n", highest, limit);
    assert_true(highest <= limit * (1 + 1e-4) && highest > 0.998 * limit);
    assert_true(fabs(output_at(&path, path.points - 1)) < 0.5 * limit);
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * A path of equal load steps ends at the limit load of the hinged roof, which it names with the
 * status of the solver and the cure.
 */
static void test_stepped_path_says_why(void **state)
{
    scene_run run;
    load_path path;
    (void)state;
    open_run(&run, "hinged-roof", moved_hinge);
    assert_int_equal(load_path_follow(&path, &run.analysis, run.error), 0);
    assert_true(path.has_equal_steps && !path.is_complete);
    assert_true(fabs(path.point[path.points - 1].load_factor - 0.739) < 0.01);
    assert_non_null(strstr(run.error, "replace the load by a moved body"));
    load_path_free(&path);
    scene_run_close(&run);
}

/* Contact of the hinged roof with a sphere that lies `depth` (mm) below it beside its centre. */
#define SPHERE(depth)                                                                              \
    ROOF_8 ";contact={face: inner, body: {type: sphere, point: [127, 0, 2433.65-" depth            \
           "], radius: 100}};outputs=[{name: centre, u3: middle, at: {theta1: 0, theta2: 0}}, "    \
           "{name: force, contact: z}, {name: sum, reaction: z, at: nodes}]"

/*
 * With contact the arc-length path consists of the equilibria that load steps find: displacement
 * and contact force. The body carries what the supports do not of the quarter of the force, 750 N.
 */
static void test_contact_on_arcs(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    int touching = 0;
    follow(&run, &path, "hinged-roof", SPHERE("3"));
    assert_true(!path.has_equal_steps && path.events == 0);
    for (int i = 1; i < path.points; i++) {
        const double load_factor = path.point[i].load_factor;
        if (value_at(&path, i, 1) > 0)
            for (int k = 0; k < 2; k++, touching++) {
                const double other =
                    output_by_load_steps("hinged-roof", SPHERE("3"), load_factor, k);
                assert_true(fabs(value_at(&path, i, k) / other - 1) < 1e-6);
            }
        assert_true(fabs(value_at(&path, i, 1) + value_at(&path, i, 2) - 750 * load_factor) <
                    1e-6 * 750);
    }
    assert_true(touching >= 4);
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * A body that the roof meets only behind its limit point leaves that limit point where it is
 * without the body; the path passes it, and the body then stops the snap-through: the roof reaches
 * the full load with the body in contact, and its centre stays above that of the roof without the
 * body.
 */
static void test_limit_point_before_contact(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    follow(&run, &path, "hinged-roof", ROOF_8);
    const double limit = path.event[0].load_factor;
    const double free_centre = output_at(&path, path.points - 1);
    load_path_free(&path);
    scene_run_close(&run);
    follow(&run, &path, "hinged-roof", SPHERE("8"));
    const int last = path.points - 1;
    assert_int_equal(path.event[0].type, LOAD_PATH_LIMIT);
    assert_true(fabs(path.event[0].load_factor / limit - 1) < 1e-6);
    assert_int_equal(path.point[last].negative_pivots, 0);
    assert_true(value_at(&path, last, 1) > 0);
    assert_true(fabs(value_at(&path, last, 1) + value_at(&path, last, 2) - 750) < 1e-6 * 750);
    assert_true(fabs(output_at(&path, last)) < 0.5 * fabs(free_centre));
    load_path_free(&path);
    scene_run_close(&run);
}

/*
 * With seven dof a node the path of the pulled cylinder ends where the shell has turned by a right
 * angle, and says so.
 */
static void test_lost_normal(void **state)
{
    (void)state;
    scene_run run;
    load_path path;
    open_run(&run, "pulled-cylinder",
             "dof_per_node=7;mesh.theta1.elements=12;mesh.theta2.elements=16");
    assert_int_equal(load_path_follow(&path, &run.analysis, run.error), 0);
    assert_false(path.is_complete);
    assert_non_null(strstr(run.error, "use dof_per_node: 6"));
    load_path_free(&path);
    scene_run_close(&run);
}

/* Scenes that the method does not follow are refused by name, also one without a load. */
static void test_refusals(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *changes, *says;
    } bad[] = {{"scordelis-lo", "", "needs kinematics"},
               {"hinged-roof", "loads=[]", "no load"},
               {"hinged-roof", "loads.0.u3=0", "no load"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        scene_run run;
        load_path path;
        open_run(&run, bad[i].scene, bad[i].changes);
        assert_int_equal(load_path_follow(&path, &run.analysis, run.error), -1);
        assert_non_null(strstr(run.error, bad[i].says));
        load_path_free(&path);
        scene_run_close(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points_are_equilibria),
        cmocka_unit_test(test_snap_through),
        cmocka_unit_test(test_limit_is_located),
        cmocka_unit_test(test_snap_back),
        cmocka_unit_test(test_column_of_euler),
        cmocka_unit_test(test_branch_of_column),
        cmocka_unit_test(test_branch_of_roof),
        cmocka_unit_test(test_control_on_request),
        cmocka_unit_test(test_answer_off_the_path),
        cmocka_unit_test(test_answer_on_the_path),
        cmocka_unit_test(test_pushed_column),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_material_softens),
        cmocka_unit_test(test_stepped_path_says_why),
        cmocka_unit_test(test_contact_on_arcs),
        cmocka_unit_test(test_limit_point_before_contact),
        cmocka_unit_test(test_lost_normal),
        cmocka_unit_test(test_published_roofs),
        cmocka_unit_test(test_half_cylinder),
        cmocka_unit_test(test_pulled_cylinder),
        cmocka_unit_test(test_path_ends_at_full_load),
        cmocka_unit_test(test_open_electrodes_stiffen),
        cmocka_unit_test(test_open_electrodes_in_equilibrium),
        cmocka_unit_test(test_contact_in_equal_steps),
#if SLOW_ROWS
        cmocka_unit_test(test_half_cylinder_crossply),
        cmocka_unit_test(test_half_cylinder_material_limit),
        cmocka_unit_test(test_half_cylinder_softens),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
