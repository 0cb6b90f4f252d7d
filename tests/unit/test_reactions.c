/*
 * Reactions of supports: statics, equilibrium with all other forces, prescribed displacements along
 * any direction, prescribed rotations, refusals.
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
#include "../../host_tools/model/follow_path.h"
#include "../../host_tools/quads/vector.h"
#include "../rigs/scene_assert.h"

#define STRIP "tests/rigs/scenes/strip.yaml"
#define FREE_PLATE "tests/rigs/scenes/spring-plate.yaml"
#define DISC "tests/rigs/scenes/spring-disc.yaml"
#define COUNT(list) (sizeof(list) / sizeof *(list))

static const total_force *total_of(const scene_run *r, const char *name)
{
    const reactions *reactions = &r->analysis.reactions;
    for (int k = 0; k < reactions->supports; k++)
        if (strcmp(reactions->support[k].name, name) == 0)
            return &reactions->support[k].total;
    fail_msg("no support '%s'", name);
    return NULL;
}

/* ---- statics ---------------------------------------------------------------- */

/*
 * Law: a cantilever of length 10 under a force of 2.5 across its end has the reaction -2.5 and the
 * moment 25 at its clamp, at small displacements; a support by its name, its edge as a place and
 * the sum of both its nodes agree.
 */
static void test_cantilever(void **state)
{
    (void)state;
    scene_run r;
    solve_run(
        &r, STRIP,
        "kinematics=linear;supports=[{name: root, edge: theta1-, fix: clamped}];outputs=["
        "{name: f, reaction: z, support: root}, {name: m, reaction: moment_y, support: root},"
        " {name: p, reaction: z, edge: theta1-}, {name: q, reaction: moment_y, edge: theta1-},"
        " {name: a, reaction: z, at: {theta1: 0, theta2: 0}}, {name: b, reaction: z, at: "
        "{theta1: 0, theta2: 1}}, {name: n, reaction: z, edge: theta1+}]");
    assert_near("force", scene_run_value(&r, 0), -2.5, 1e-9);
    assert_near("moment", scene_run_value(&r, 1), 25, 1e-9);
    assert_near("force at the edge", scene_run_value(&r, 2), -2.5, 1e-9);
    assert_near("moment at the edge", scene_run_value(&r, 3), 25, 1e-9);
    assert_near("both nodes", scene_run_value(&r, 4) + scene_run_value(&r, 5), -2.5, 1e-9);
    assert_true(scene_run_value(&r, 6) == 0);
    scene_run_close(&r);
}

/*
 * Law: two hinges at the ends of a beam carry two thirds and one third of a load that acts at a
 * third of the length of the beam.
 */
static void test_lever(void **state)
{
    (void)state;
    scene_run r;
    solve_run(&r, STRIP,
              "kinematics=linear;mesh.theta1.elements=9;supports=[{name: left, edge: theta1-, fix: "
              "[u1 mean, u2 mean, u3 mean]}, {name: right, edge: theta1+, fix: u3 "
              "mean}];loads=[{point: {theta1: 3.3333333333333335, theta2: 0}, z: -3}, {point: "
              "{theta1: 3.3333333333333335, theta2: 1}, z: -3}]");
    assert_near("left", total_of(&r, "left")->force[2], 4, 1e-9);
    assert_near("right", total_of(&r, "right")->force[2], 2, 1e-9);
    assert_true(fabs(total_of(&r, "right")->moment[1]) < 1e-9 * 20);
    scene_run_close(&r);
}

/* ---- equilibrium ------------------------------------------------------------- */

#define PLATE_HELD "supports=[{edge: theta1-, fix: clamped}];"
#define GROOVES                                                                                    \
    "supports=[{at: {theta1: 0.5, theta2: 1}, fix: across, direction: [0, 1, 0.3]}, "              \
    "{at: {theta1: 0, theta2: 0.25}, fix: across, direction: [-0.8, -0.5, -0.2]}, "                \
    "{at: {theta1: 1, theta2: 0.25}, fix: across, direction: [0.8, -0.5, 0.4]}];"

/*
 * Scenes whose forces must be in equilibrium, and whether forces of a kind must be present, so that
 * their absence is noticed: loads, springs, contact.
 */
static const struct balanced {
    const char *scene, *changes;
    bool has_load, has_spring, has_contact;
} balanced[] = {
    {FREE_PLATE,
     PLATE_HELD "loads=[{weight: {axis: z, gravity: -9.81}}, {face: outer, pressure: "
                "'100*x'}]",
     true, false, false},
    {FREE_PLATE,
     GROOVES "loads=[{point: {theta1: 0.25, theta2: 0.75}, z: -100}, {point: {theta1: "
             "1, theta2: 0.5}, x: 30}, {point: {theta1: 0.5, theta2: 0.5}, about: x, "
             "moment: 7}]",
     true, false, false},
    {FREE_PLATE,
     PLATE_HELD "springs=[{edge: theta1+, along: [1, 2, 3], stiffness: 1e5}, {at: "
                "{theta1: 0.5, theta2: 0.5}, about: y, stiffness: 1e3}, {edge: theta1-, "
                "along: z, stiffness: 1e6}, {at: {theta1: 1, theta2: 0}, to: {theta1: "
                "0, theta2: 0}, stiffness: 1e5}];loads=[{face: outer, pressure: 100}, "
                "{temperature: {inner: 10, outer: 40}}]",
     true, true, false},
    {FREE_PLATE,
     "supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: clamped}];loads=["
     "{temperature: {inner: 10, outer: 40}}]",
     false, false, false},
    {PLATE,
     "supports=[{edge: theta1-, fix: clamped}, {edge: theta2+, fix: clamped}];loads=[];"
     "sensors=[];outputs=[];actuators=[{name: v, drives: [{patches: up}, "
     "{patches: low, factor: 0.3}], "
     "applied: 150}]",
     false, false, false},
    {DISC,
     "springs=[{at: nodes, along: z, stiffness: 1e8, per: area}];supports=[{set: rim, "
     "fix: along, direction: ['x-y', 'y+x', 3]}, {at: {x: 0, y: 0, z: 0}, "
     "fix: [u1 mean, u2 mean]}];loads=[{face: outer, pressure: '100*(x+2)'}]",
     true, true, false},
    {STRIP,
     "supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: u3 mean, value: 3}];"
     "loads=[{face: outer, pressure: 0.05, follower: pressure}]",
     true, false, false},
    {STRIP, "loads=[{line: theta1+, u3: 1.5}];springs=[{edge: theta1+, along: x, stiffness: 0.3}]",
     true, true, false},
    {"ring-follower", IMPROVED "equilibrium.tolerance=1e-9", true, false, false},
    {"ring-contact", IMPROVED "equilibrium.tolerance=1e-9", true, false, true},
};

/*
 * Compare a sum of forces with what rounding permits: the forces of all elements, times the
 * relative accuracy of the solver.
 */
static void assert_vanishes(const char *what, const double sum[3], double size, double accuracy)
{
    if (!(vector_length(sum) <= accuracy * size))
        fail_msg("%s: sum %.3g of forces of the size %.3g", what, vector_length(sum), size);
}

/*
 * Law: the forces of supports, loads, springs and contact on a shell at rest cancel each other, and
 * so do their moments. A linear solution is exact to rounding; that of Newton's method to the
 * square of its tolerance, as the last increment is below it.
 */
static void test_equilibrium(void **state)
{
    (void)state;
    for (size_t k = 0; k < COUNT(balanced); k++) {
        scene_run r;
        double extent[3];
        solve_run(&r, balanced[k].scene, balanced[k].changes);
        const reactions *own = &r.analysis.reactions;
        const double accuracy = 1e-11;
        mesh_extent(&r.analysis.design.mesh, extent);
        assert_vanishes(balanced[k].changes, own->sum.force, own->internal, accuracy);
        assert_vanishes(balanced[k].changes, own->sum.moment,
                        own->internal * (vector_length(extent)), accuracy);
        assert_int_equal(vector_length(own->load.force) > 1e-6 * own->internal,
                         balanced[k].has_load);
        assert_int_equal(vector_length(own->spring.force) > 0, balanced[k].has_spring);
        assert_int_equal(vector_length(own->contact.force) > 0, balanced[k].has_contact);
        double most = 0;
        for (int node = 0; node < own->nodes; node++)
            most = fmax(most, vector_length(own->node[node]));
        assert_true(0.01 * most > 10 * accuracy * own->internal);
        scene_run_close(&r);
    }
}

/* ---- prescribed displacements and rotations ----------------------------------------- */

/*
 * Law: what a force F along a direction moves by d, a support that prescribes d along this
 * direction moves alike, with the reaction F. The direction is no axis of the shell, and beside it
 * a second support holds another direction at the same node.
 */
static void test_oblique_value(void **state)
{
    (void)state;
    static const char *const held[2] = {
        "", ", {at: {theta1: 10, theta2: 0}, fix: along, direction: [0.2, 1, 0.1]}"};
    const double unit[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
    for (int k = 0; k < 2; k++) {
        scene_run force, moved;
        char changes[1024];
        snprintf(changes, sizeof changes,
                 "supports=[{edge: theta1-, fix: clamped}%s];loads=[{point: {theta1: 10, theta2: "
                 "0}, x: %.17g}, {point: {theta1: 10, theta2: 0}, y: %.17g}, {point: {theta1: 10, "
                 "theta2: 0}, z: %.17g}];outputs=[{name: x, x: mean, at: {theta1: 10, theta2: 0}}, "
                 "{name: y, y: mean, at: {theta1: 10, theta2: 0}}, {name: z, z: mean, at: {theta1: "
                 "10, theta2: 0}}]",
                 held[k], 2 * unit[0], 2 * unit[1], 2 * unit[2]);
        solve_run(&force, STRIP, changes);
        const double u[3] = {scene_run_value(&force, 0), scene_run_value(&force, 1),
                             scene_run_value(&force, 2)};
        assert_true(vector_length(u) > 1);
        snprintf(changes, sizeof changes,
                 "supports=[{edge: theta1-, fix: clamped}, {name: pull, at: {theta1: 10, theta2: "
                 "0}, fix: along, direction: [2, 3, 6], value: %.17g}%s];loads=[];outputs=[{name: "
                 "x, x: mean, at: {theta1: 10, theta2: 0}}, {name: y, y: mean, at: {theta1: 10, "
                 "theta2: 0}}, {name: z, z: mean, at: {theta1: 10, theta2: 0}}]",
                 vector_dot(u, unit), held[k]);
        solve_run(&moved, STRIP, changes);
        for (int i = 0; i < 3; i++)
            assert_true(fabs(scene_run_value(&moved, i) - u[i]) < 1e-7 * vector_length(u));
        if (k == 0)
            for (int i = 0; i < 3; i++)
                assert_near("reaction", total_of(&moved, "pull")->force[i], 2 * unit[i], 1e-6);
        const double root[2] = {total_of(&force, "theta1-")->moment[1],
                                total_of(&moved, "theta1-")->moment[1]};
        assert_near("moment at the root", root[1], root[0], 1e-6);
        scene_run_close(&force);
        scene_run_close(&moved);
    }
}

/*
 * Turn the end of a strip by 60 degrees about an axis.
 *   axis     in  the axis, as the scene file names it
 *   elements in  number of elements along the strip
 *   value [2] out  moment of the support at the end, and displacement of the end across the strip
 */
static void turn_end(const char *axis, int elements, double value[2])
{
    scene_run r;
    char changes[512];
    snprintf(
        changes, sizeof changes,
        "materials.m.nu=0;mesh.theta1.elements=%d;supports=[{edge: theta1-, fix: clamped}, "
        "{edge: theta1+, fix: rotation, about: %s, value: 60 deg}];loads=[];outputs=[{name: z, "
        "z: mean, edge: theta1+}]",
        elements, axis);
    solve_run(&r, STRIP, changes);
    const total_force *end = total_of(&r, "theta1+");
    value[0] = end->moment[1];
    value[1] = scene_run_value(&r, 0);
    assert_near("root", total_of(&r, "theta1-")->moment[1], -end->moment[1], 1e-6);
    assert_true(vector_length(end->force) == 0);
    scene_run_close(&r);
}

/*
 * Law: a strip whose end is turned by the angle a bends into an arc under the moment D b a/L alone,
 * with the bending stiffness D = E h^3/12 for Poisson's ratio 0, as far as the strain of the faces,
 * h a/(2 L), is small against 1. The error falls with the square of the element length. The axis
 * may be named in space or as an axis of the shell.
 */
static void test_rotation(void **state)
{
    (void)state;
    static const char *const axis[3] = {"y", "u2", "[0, 2, 0]"};
    const double angle = acos(-1) / 3, moment = 1e6 * 1e-3 / 12 * angle / 10;
    const double thick = 0.1 * angle / 10;
    for (int k = 0; k < 3; k++) {
        double value[3][2];
        for (int i = 0; i < 3; i++)
            turn_end(axis[k], 5 << i, value[i]);
        for (int i = 0; i < 2; i++) {
            const double ratio = (value[1][i] - value[0][i]) / (value[2][i] - value[1][i]);
            assert_true(ratio > 3.5 && ratio < 4.5);
        }
        assert_near("moment", (4 * value[2][0] - value[1][0]) / 3, moment, 2 * thick * thick);
        assert_near("sag", (4 * value[2][1] - value[1][1]) / 3, -10 / angle * (1 - cos(angle)),
                    2 * thick * thick);
    }
}

/* ---- contact at a place ------------------------------------------------------ */

/*
 * Law: the contact forces at the nodes sum to the force of the whole contact, so that those of two
 * places that share the nodes do, too; where no node touches the force is zero, and so is the
 * force at right angles to the normal of the body.
 */
static void test_contact_at_places(void **state)
{
    (void)state;
    scene_run r;
    double value[9];
    solve_run(&r, "ring-contact",
              "outputs=[{name: all, contact: x}, {name: near, contact: x, edge: theta2-}, {name: "
              "far, contact: x, edge: theta2+}, {name: off, contact: x, at: {theta1: [1, 3.2]}}, "
              "{name: every, contact: x, at: nodes}, {name: n, contact: nodes}, {name: half, "
              "contact: nodes, edge: theta2-}, {name: cross, contact: z, at: nodes}, {name: rest, "
              "contact: nodes, edge: theta2+}]");
    for (int k = 0; k < 9; k++) {
        assert_int_equal(analysis_outputs(&r.analysis, k), 1);
        value[k] = scene_run_value(&r, k);
    }
    assert_true(value[0] < -100);
    assert_near("both edges", value[1] + value[2], value[0], 1e-12);
    assert_near("all nodes", value[4], value[0], 1e-12);
    assert_true(value[3] == 0 && fabs(value[7]) < 1e-12 * fabs(value[0]));
    assert_true(value[5] >= 1 && value[6] + value[8] == value[5]);
    scene_run_close(&r);
}

/* ---- load paths ---------------------------------------------------------------- */

/*
 * Law: on a load path the reaction of a clamped strip is minus the load at every point, and under a
 * prescribed displacement the table gives the force over the displacement.
 */
static void test_path(void **state)
{
    (void)state;
    scene_run r;
    char error[SCENE_ERROR];
    open_run(&r, STRIP,
             "outputs=[{name: tip, u3: mean, at: {theta1: 10, theta2: 0}}, {name: f, reaction: z, "
             "support: theta1-}]");
    load_path *path = &r.analysis.load_path;
    assert_int_equal(load_path_follow(path, &r.analysis, error), 0);
    assert_true(path->points > 3);
    for (int i = 0; i < path->points; i++)
        assert_true(fabs(path->value[2 * i + 1] + 2.5 * path->point[i].load_factor) < 2.5e-6);
    scene_run_close(&r);
}

/* ---- refusals ------------------------------------------------------------------- */

static void test_refusals(void **state)
{
    (void)state;
    static const refusal bad[] = {
        {"outputs=[{name: a, reaction: z}]", "a reaction needs support: name, or a place"},
        {"outputs=[{name: a, reaction: z, support: none}]", "there is no support 'none'"},
        {"outputs=[{name: a, reaction: u3, edge: theta1-}]", "moment_x"},
        {"outputs=[{name: a, reaction: z, u3: mean, edge: theta1-}]", "write a second item"},
        {"outputs=[{name: a, reaction: z, support: theta1-, edge: theta1-}]", "remove one"},
        {"outputs=[{name: a, u3: mean, support: theta1-}]", "belongs to a reaction"},
        {"supports=[{edge: theta1-, fix: rotation}]", "belong together"},
        {"supports=[{edge: theta1-, fix: u3, about: y}]", "belong together"},
        {"supports=[{edge: theta1-, fix: rotation, about: u3}]", "no rotation about its normal"},
        {"supports=[{edge: theta1-, fix: rotation, about: y, direction: [1, 0, 0]}]",
         "remove 'direction'"},
        {"supports=[{edge: theta1-, fix: rotation, about: y, value: 2}]", "less than 90 degrees"},
        {"supports=[{edge: theta1-, fix: rotation, about: y, value: log(-x)}]", "finite number"},
        {"supports=[{edge: theta1-, fix: rotation, about: z}]", "normal to the surface"},
        {"supports=[{edge: theta1-, fix: [rotation, u3], about: y, value: 1}]",
         "an item of its own"},
        {"supports=[{edge: theta1-, fix: across, direction: [1, 0, 1], value: 1}]",
         "single displacement"},
        {"supports=[{edge: theta1-, fix: along, direction: [1, 0, 1], value: log(-x)}]",
         "finite number"},
        {"supports=[{edge: theta1-, fix: along, direction: [1, 0, 1], value: 1}, {edge: theta1-, "
         "fix: along, direction: [2, 0, 2], value: 1.1}]",
         "other supports prescribe 1 along"},
        {"supports=[{edge: theta1-, fix: cone}, {edge: theta1-, fix: along, direction: [1, 0, 1], "
         "value: 1}]",
         "other supports prescribe 0 along"},
        {"supports=[{edge: theta1-, name: '', fix: cone}]", "an empty name"},
    };
    for (size_t i = 0; i < COUNT(bad); i++) {
        scene_run r;
        if (scene_run_open(&r, STRIP, bad[i].set) == 0 || !strstr(r.error, bad[i].expected))
            fail_msg("%s: expected '%s', got '%s'", bad[i].set, bad[i].expected, r.error);
        scene_run_close(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cantilever),        cmocka_unit_test(test_lever),
        cmocka_unit_test(test_equilibrium),       cmocka_unit_test(test_oblique_value),
        cmocka_unit_test(test_rotation),          cmocka_unit_test(test_path),
        cmocka_unit_test(test_contact_at_places), cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
