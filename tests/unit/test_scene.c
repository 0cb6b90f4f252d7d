/*
 * Laws of the scene reader: every shipped scene reads; every fault is one line that says where,
 * what and the cure.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>
#include "../../host_tools/scene/scene.h"
#include "../../host_tools/scene/scene_fields.h"

#ifndef MUTATIONS
#define MUTATIONS 500
#endif

#ifndef SCENES
#define SCENES "host_tools/scenes"
#endif

enum { LINES = 13, TEXT = 20000 };

static const char *scenes = SCENES;
static char file[] = "/tmp/test_scene_XXXXXX";

/* A small scene; a case replaces one of its lines. */
static const char *const base[LINES] = {
    "name: t",
    "surface: {type: plate}",
    "mesh: {theta1: {from: 0, to: 2, elements: 4}, theta2: {points: [0, 0.5, 1]}}",
    "materials: {steel: {E: 200e9, nu: 0.3, density: 7800}, pzt: {E: 60e9, nu: 0.3, d31: 1e-10}}",
    "layers: [{name: bottom, material: steel, thickness: 1e-3}, {name: top, material: pzt, "
    "thickness: 1e-3}]",
    "patches: [{name: p, layer: top, grid: [2, 1]}]",
    "actuators: [{name: v, drives: [{patches: p}]}]",
    "limits: {voltage: [-100, 100]}",
    "supports: [{edge: theta1-, fix: clamped}]",
    "loads: [{face: outer, pressure: 1}]",
    "outputs: [{name: tip, u3: middle, at: {theta1: 2, theta2: 0}}]",
    "target: {u3: middle, at: nodes, value: x*y}",
    "compare: [{name: c, values: [1, 2]}]",
};

/* The same for the noise, with the words of large displacements. */
static const char *const rich[LINES] = {
    "name: t",
    "kinematics: auto",
    "surface: {type: revolution, meridian: [[5, 0], [6, -1], [6, -2], [5, -3]], smoothing: 0.1, "
    "ends: [[1, 0], [-1, 0]]}",
    "mesh: {theta1: {elements: 4, centre: 0.6}, theta2: {from: 0, to: 2*pi, elements: 4, slit: "
    "true}}",
    "materials: {steel: {E: 200e9, nu: 0.3}}",
    "layers: [{material: steel, thickness: 1e-3}]",
    "equilibrium: {load_steps: 2, tolerance: 1e-6, extrapolated_iterations: 0, linear_solves: 50}",
    "tolerance: 0.1",
    "supports: [{edge: theta1-, fix: clamped}, {edge: theta1+, fix: u3, value: x}]",
    "loads: [{face: inner, pressure: 1, follower: pressure}]",
    "contact: {face: outer, body: {type: psi, value: x^2+y-1}, move: [1, 0, 0], stiffness: 5}",
    "outputs: [{name: N, contact: x}, {name: p, contact: pressure, at: nodes}, {name: e, contact: "
    "nodes, edge: theta1-}]",
    "about: noise",
};

static void write_bytes(const char *bytes, size_t count)
{
    FILE *out = fopen(file, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(bytes, 1, count, out), count);
    fclose(out);
}

static void write_base(int line, const char *text)
{
    char all[TEXT];
    size_t n = 0;
    int i;
    for (i = 0; i < LINES; i++)
        n += (size_t)snprintf(all + n, sizeof all - n, "%s\n", i == line - 1 ? text : base[i]);
    write_bytes(all, n);
}

static void write_lines(const char *const *lines)
{
    FILE *out = fopen(file, "wb");
    int i;
    assert_non_null(out);
    for (i = 0; i < LINES; i++)
        fprintf(out, "%s\n", lines[i]);
    fclose(out);
}

static void expect_fault(const char *const *set, int sets, const char *expected)
{
    char error[SCENE_ERROR];
    scene scene;
    int status = scene_read(&scene, file, set, sets, error);
    if (status == 0)
        scene_free(&scene);
    if (status == 0 || !strstr(error, expected))
        fail_msg("expected '%s', got '%s'", expected, status == 0 ? "no fault" : error);
    assert_null(strchr(error, '\n'));
}

static void expect_good(scene *scene, const char *path, const char *const *set, int sets)
{
    char error[SCENE_ERROR];
    if (scene_read(scene, path, set, sets, error) != 0)
        fail_msg("%s", error);
}

/* ---- faults ---- */

#define CONTACT "contact: {face: outer, body: {type: sphere, point: [0, 0, 9], radius: 1}}\n"

typedef struct bad_line {
    int line;
    const char *text, *expected;
} bad_line;

static const bad_line bad_lines[] = {
    /* words */
    {1, "name: t\ncontrol: {rate: 9, delay: 2}",
     ":2:20: unknown key 'delay' in control; it is a key of simulate.sensors; known: rate,"},
    {1, "nam: t", ":1:1: unknown key 'nam' in scene; did you mean 'name'?"},
    {1, "about: t", ":1:1: 'name' is missing in scene"},
    {1, "name: t*/", ":1:7: the name 't*/' holds a quote, backslash, comment"},
    {1, "name: t\nabout: x */ y", ":2:8: 'about' holds /* or */"},
    {1, "name: [t]", ":1:7: 'name' must be a single value, not a list"},
    {1, "name: ''", ":1:7: an empty name"},
    {1, "name: t\nname: u", ":2:1: 'name' is given twice (first on line 1)"},
    {1, "name: t\nkinematics: large",
     ":2:13: 'kinematics: large' is not known; known: linear, nonlinear, auto"},
    {1, "name: t\nkinematics: [auto]", ":2:13: 'kinematics' must be a single value, not a list"},
    {1, "name: t\ntolerance: 0", ":2:12: 'tolerance: 0' must lie between 0 and 1, ends left out"},
    {1, "name: t\ntolerance: 1", ":2:12: 'tolerance: 1' must lie between 0 and 1"},
    {1, "name: t\ntolerance: {relative: 1}",
     ":2:12: 'tolerance' must be a single value, not a mapping"},
    {1, "name: t\nequilibrium: 5",
     ":2:14: 'equilibrium' must be a mapping {key: value}, not a single value"},
    {1, "name: t\nequilibrium: {step: 5}",
     ":2:15: unknown key 'step' in equilibrium; it is a key of simulate.amplifiers; known: "},
    {1, "name: t\nequilibrium: {load_steps: 0}", ":2:27: 'load_steps: 0' must be from 1 to 10000"},
    {1, "name: t\nequilibrium: {load_steps: 10001}",
     ":2:27: 'load_steps: 10001' must be from 1 to 10000"},
    {1, "name: t\nequilibrium: {load_steps: 1.5}",
     ":2:27: 'load_steps: 1.5' must be a whole number"},
    {1, "name: t\nequilibrium: {tolerance: 0}",
     ":2:26: 'tolerance: 0' must lie between 1e-12 and 0.1"},
    {1, "name: t\nequilibrium: {tolerance: 0.2}",
     ":2:26: 'tolerance: 0.2' must lie between 1e-12 and 0.1"},
    {1, "name: t\nequilibrium: {ramp_solves: 0}", ":2:28: 'ramp_solves: 0' must be from 1 to 20"},
    {1, "name: t\nequilibrium: {extrapolated_iterations: -1}",
     ":2:40: 'extrapolated_iterations: -1' must be from 0 (plain Newton) to 1000"},
    {1, "name: t\nequilibrium: {extrapolated_iterations: 1001}",
     ":2:40: 'extrapolated_iterations: 1001' must be from 0 (plain Newton) to 1000"},
    {1, "name: t\nequilibrium: {linear_solves: 0}",
     ":2:30: 'linear_solves: 0' must be from 1 to 1000000"},
    {1, "name: t\nequilibrium: {linear_solves: 1000001}",
     ":2:30: 'linear_solves: 1000001' must be from 1 to 1000000"},
    {1, "name: t\nequilibrium: {linear_solves: x}",
     ":2:30: 'linear_solves: x' varies over the surface"},
    {1, "name: t\nelement: publish",
     ":2:10: 'element: publish' is not known; did you mean 'published'?"},
    {1, "name: t\nelement: {rho: -1}", ":2:16: 'rho: -1' must not be below 0"},
    {1, "name: t\nelement: published\ndof_per_node: 6", ":3:15: 'dof_per_node: 6' needs lin33"},
    {1, "name: t\ndof_per_node: 5", ":2:15: 'dof_per_node: 5' is not known; known: 7, 6"},
    {1, "name: t\nreference: 1", "'reference: 1' lies above the outer face at 0.002"},
    /* YAML */
    {1, "name: [t", ":2:8: not YAML: while parsing a flow sequence"},
    {1, "name: t\n---\nname: u", ":2:1: a second document"},
    {1, "name: &a [*a]", ":1:11: *a contains itself"},
    {1, "name: *a", ":1:7: *a stands for nothing"},
    {1, "name: [[[[[[[[[[[[[[[[[[[[[[[[[[", ":1:30: nested more than 24 deep"},
    {1, "name: t\xff", ":1:8: not text"},
    {1, "{a: b}: t", ":1:1: a key must be a plain word"},
    {1, "- t", "not YAML"},
    /* numbers */
    {3, "mesh: {theta1: {from: 0, to: x, elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     ":3:30: 'to: x' varies over the surface"},
    {3, "mesh: {theta1: {from: 0, to: 2*, elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     ":3:30: 'to: 2*' is no number or formula, at its character 3"},
    {3, "mesh: {theta1: {from: 0, to: 1/0, elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     ":3:30: 'to: 1/0' is not finite"},
    {3, "mesh: {theta1: {from: 0, to: .nan, elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     ":3:30: 'to: .nan' is no number"},
    {3, "mesh: {theta1: {from: 0, to: 1e308, elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     ":3:30: 'to: 1e308' is out of range"},
    {3, "mesh: {theta1: {from: 0, to: 1e999, elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     "the number is too large"},
    {3, "mesh: {theta1: {from: 0, to: , elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     "'to' is empty"},
    /* surface and mesh */
    {2, "surface: {type: saddle}", ":2:17: 'type: saddle' is not known; known: plate, polar"},
    {2, "surface: {type: cylinder, radius: 1}",
     ":2:10: 'axial' is missing in surface; a cylinder needs it"},
    {2, "surface: {type: plate, radius: 1}", ":2:24: 'radius' has no meaning for a plate"},
    {2, "surface: {type: sphere, radius: 0}", ":2:33: 'radius: 0' must be above 0"},
    {2, "surface: {type: polar}",
     ":3:16: the mesh reaches a pole, where A2 = 0; let theta1 (the radius) start above 0"},
    {2, "surface: {type: sphere, radius: 1}",
     ":3:16: the mesh reaches a pole, where A2 = 0; let theta1 run inside 0 and pi"},
    {2, "surface: {type: cone, radius: 1, angle: -45}",
     ":3:16: the mesh reaches a pole, where A2 = 0; keep radius"},
    {2, "surface: {type: cone, radius: 1, angle: 90}",
     ":2:41: 'angle: 90' must lie between -90 and 90"},
    {2, "surface: {type: cylinder, radius: 1e-3, axial: theta1}", "past the axis"},
    {2, "surface: {type: hyperboloid, waist: 1}",
     ":2:10: 'height' is missing in surface; a hyperboloid needs it"},
    {2, "surface: {type: hyperboloid, height: 1}",
     ":2:10: 'waist' is missing in surface; a hyperboloid needs it"},
    {2, "surface: {type: hyperboloid, waist: 0, height: 1}", ":2:37: 'waist: 0' must be above 0"},
    {2, "surface: {type: hyperboloid, waist: 1, height: -1}",
     ":2:48: 'height: -1' must be above 0"},
    {2, "surface: {type: hyperboloid, waist: 1, height: 1, tube: 1}",
     ":2:51: 'tube' has no meaning for a hyperboloid"},
    {2, "surface: {type: hyperboloid, waist: 1, height: 1e-2}",
     ":5:9: the layers reach 0.001 above the reference surface, past the axis or centre of "
     "curvature at 0.0001"},
    {2, "surface: {type: torus, radius: 5}",
     ":2:10: 'tube' is missing in surface; a torus needs it"},
    {2, "surface: {type: torus, tube: 5}",
     ":2:10: 'radius' is missing in surface; a torus needs it"},
    {2, "surface: {type: torus, radius: 5, tube: 0}", ":2:41: 'tube: 0' must be above 0"},
    {2, "surface: {type: torus, radius: 0, tube: 1}", ":2:32: 'radius: 0' must be above 0"},
    {2, "surface: {type: torus, radius: 1, tube: 3}",
     ":3:16: the mesh reaches a pole, where A2 = 0; keep radius + tube cos(theta1) above 0"},
    {2, "surface: {type: torus, radius: 5, tube: 1, axial: theta1}",
     ":2:44: 'axial' has no meaning for a torus"},
    {2, "surface: {type: revolution}",
     ":2:10: 'meridian' is missing in surface; a revolution needs it"},
    {2, "surface: {type: revolution, meridian: 5}",
     ":2:39: 'meridian' must be a list [...], not a single value"},
    {2, "surface: {type: revolution, meridian: [1, 2]}",
     ":2:40: an item of 'meridian' must be a list [...], not a single value"},
    {2, "surface: {type: revolution, meridian: [[1, 2, 3]]}",
     ":2:40: an item of 'meridian' has 3 values; give two, [r, z]"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [1, 1], [1, 2]]}",
     ":2:39: 'meridian' has 3 points; give at least 4"},
    {2, "surface: {type: revolution, meridian: [[1, 0]], ends: [[0, 1], [0, 1]]}",
     ":2:39: 'meridian' has 1 points; give at least 2"},
    {2, "surface: {type: revolution, meridian: []}",
     ":2:39: 'meridian' has 0 points; give at least 4"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [-1, 1]]}",
     ":2:49: 'meridian: -1' is a radius and must not be below 0"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [1, 0], [1, 1], [1, 2]]}",
     ":2:48: point [1, 0] follows itself; drop one"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [1, 1], [1, 2], [1, 3]], smoothing: -1}",
     ":2:84: 'smoothing: -1' must not be below 0"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [1, 1], [1, 2], [1, 3]], ends: natural}",
     ":2:79: 'ends: natural' is not known; known: not-a-knot"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [1, 1], [1, 2], [1, 3]], ends: [[0, 1]]}",
     ":2:79: 'ends' has 1 items; give not-a-knot or the directions"},
    {2,
     "surface: {type: revolution, meridian: [[1, 0], [1, 1], [1, 2], [1, 3]], ends: [[0, 1], [0, "
     "0]]}",
     ":2:79: 'ends': [0, 0] has no direction"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [1, 1], [1, 2], [1, 2.5]], radius: 1}",
     ":2:75: 'radius' has no meaning for a revolution"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [1, 1/2], [1, 1], [1, 1.5]]}",
     ":3:16: theta1 runs from 0 to 2, but the surface from 0 to 1.5; leave 'from' and 'to' out"},
    {2, "surface: {type: revolution, meridian: [[0, 0], [1, 0], [2, 0], [3, 0]]}",
     ":3:16: the mesh reaches a pole, where A2 = 0; let theta1 stay where the meridian's radius is "
     "above 0 (theta1 = 0)"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [0, 1], [0, 2], [1, 3]]}",
     "the mesh reaches a pole"},
    {2, "surface: {type: revolution, meridian: [[1, 0], [2, 0]], ends: [[-1, 0], [-1, 0]]}",
     "'to' out"},
    {2, "surface: {type: revolution, meridian: [[5, 0], [8, 0]], ends: [[-1, 0], [-1, 0]]}",
     ":2:10: the meridian turns back on itself near theta1 = 0."},
    {2, "surface: {type: spiral, inner: 1, outer: 2, turns: 2}",
     ":2:10: 'axial' is missing in surface; a spiral needs it"},
    {2, "surface: {type: spiral, outer: 2, turns: 2, axial: theta2}",
     ":2:10: 'inner' is missing in surface; a spiral needs it"},
    {2, "surface: {type: spiral, inner: 1, turns: 2, axial: theta2}",
     ":2:10: 'outer' is missing in surface; a spiral needs it"},
    {2, "surface: {type: spiral, inner: 1, outer: 2, axial: theta2}",
     ":2:10: 'turns' is missing in surface; a spiral needs it"},
    {2, "surface: {type: spiral, inner: 0, outer: 2, turns: 2, axial: theta2}",
     ":2:32: 'inner: 0' must be above 0"},
    {2, "surface: {type: spiral, inner: 1, outer: 0, turns: 2, axial: theta2}",
     ":2:42: 'outer: 0' must be above 0"},
    {2, "surface: {type: spiral, inner: 1, outer: 2, turns: 0, axial: theta2}",
     ":2:52: 'turns: 0' must be above 0"},
    {2, "surface: {type: spiral, inner: 1, outer: 2, turns: 0.1, axial: theta2}",
     ":3:16: theta1 runs from 0 to 2, but the surface from 0 to 0.628319"},
    {2, "surface: {type: spiral, inner: 1, outer: 2, turns: 2, axial: x}",
     ":2:62: 'axial: x' is not known"},
    {3, "mesh: {theta1: {from: 0, elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     ":3:16: 'to' is missing in theta1; add it"},
    {3, "mesh: {theta1: {elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     ":3:16: 'from' is missing in theta1; add it"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 4, centre: 0}, theta2: {points: [0, 0.5, 1]}}",
     ":3:54: 'centre: 0' must lie between 0 and 1.5, ends left out"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 4, centre: 1.5}, theta2: {points: [0, 0.5, 1]}}",
     ":3:54: 'centre: 1.5' must lie between 0 and 1.5"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 4, centre: [1]}, theta2: {points: [0, 0.5, 1]}}",
     ":3:54: 'centre' must be a single value, not a list"},
    {3,
     "mesh: {theta1: {from: 0, to: 2, elements: 4, grading: 2, centre: 0.6}, theta2: {points: [0, "
     "0.5, 1]}}",
     ":3:58: 'centre' and 'grading' both space the elements; keep one"},
    {3, "mesh: {theta1: {points: [0, 1, 2], centre: 0.6}, theta2: {points: [0, 0.5, 1]}}",
     ":3:16: 'points' says all; remove the other keys"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 4, slit: true}, theta2: {points: [0, 0.5, 1]}}",
     ":3:52: theta1 of this surface never comes back to its start; remove 'slit'"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 4, slit: 2}, theta2: {points: [0, 0.5, 1]}}",
     ":3:52: 'slit: 2' is not known"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 0}, theta2: {points: [0, 0.5, 1]}}",
     ":3:43: 'elements: 0' must be from 1 to 60000"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 1.5}, theta2: {points: [0, 0.5, 1]}}",
     ":3:43: 'elements: 1.5' must be a whole number"},
    {3, "mesh: {theta1: {from: 2, to: 0, elements: 4}, theta2: {points: [0, 0.5, 1]}}",
     "'to' must be above 'from'"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 400}, theta2: {from: 0, to: 1, elements: 400}}",
     ":3:7: a mesh of 400 x 400 elements has more than 60000 nodes"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 4}, theta2: {points: [0, 0.5, 0.5]}}",
     ":3:73: point 0.5 does not ascend after 0.5"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 4}, theta2: {points: [0]}}",
     "'points' must be a list of at least two"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 4}, theta2: {points: [0, 1], elements: 2}}",
     "'points' says all"},
    {3, "mesh: {theta1: {from: 0, to: 2, elements: 4}}", ":3:7: 'theta2' is missing in mesh"},
    /* materials and layers */
    {4, "materials: {steel: {E: 2, nu: 0}, pzt: {E: 1, nu: 0, d31: 1, permittivity: -1}}",
     "'permittivity: -1' must not be below 0"},
    {4, "materials: {steel: {E: 2, nu: 0}, pzt: {E: 1, nu: 0, d31: 1, pyroelectric: [1]}}",
     "'pyroelectric' must be a single value"},
    {5, "layers: [{material: steel, thickness: 1, finger_distance: 1}]",
     "this layer is poled along e3, but interdigitated electrodes have a field along the surface"},
    {1, "name: t\nelement: corrected", ":2:10: 'element: corrected' is now called 'improved'"},
    {2, "surface: {type: plate}\nelement: {preset: source}",
     ":3:19: 'preset: source' is now called 'published'"},
    {2, "surface: {type: plate}\nelement: {preset: best}",
     ":3:19: 'preset: best' is not known; known: improved, published"},
    {4, "materials: {steel: {E: 200e9, nu: 0.5}, pzt: {E: 60e9, nu: 0.3}}",
     ":4:35: 'nu: 0.5' of steel leaves no positive definite stiffness"},
    {4, "materials: {steel: {E: 200e9}, pzt: {E: 60e9, nu: 0.3}}",
     ":4:20: 'nu' is missing in steel"},
    {4, "materials: {steel: {E: 0, nu: 0}, pzt: {E: 60e9, nu: 0.3}}",
     ":4:24: 'E: 0' must be above 0"},
    {4, "materials: {steel: {E: 1, E1: 2, nu: 0}, pzt: {E: 60e9, nu: 0.3}}",
     "steel has 'E' and 'E1'"},
    {4, "materials: {steel: {E1: 1, E2: 25, G12: 1, nu12: 0.25}, pzt: {E: 60e9, nu: 0.3}}",
     "leave no positive definite stiffness; nu12 is -e2/e1"},
    {4, "materials: {steel: {E: 1, nu: 0, d31: 1, e31: 1}, pzt: {E: 60e9, nu: 0.3}}",
     "steel has 'd31' and 'e31'"},
    {4, "materials: {steel: {E: 1, nu: 0, alpha: [1, 2]}, pzt: {E: 60e9, nu: 0.3}}",
     "'alpha' has 2 values"},
    {4, "materials: {steel: {E: 1, nu: 0}, pzt: {E: 60e9, nu: 0.3}}",
     ":7:32: patches 'p' are of 'pzt', which has no piezoelectric constants"},
    {4, "materials: {}", ":4:12: no materials"},
    {5, "layers: [{material: wood, thickness: 1e-3}]", ":5:21: there is no material 'wood'"},
    {5, "layers: [{material: steel, thickness: -1}]", ":5:39: 'thickness: -1' must be above 0"},
    {5, "layers: [{material: steel, thicknes: 1}]",
     ":5:28: unknown key 'thicknes' in layers; did you mean 'thickness'?"},
    {5, "layers: [[a, b]]",
     ":5:10: an item of 'layers' must be a mapping {key: value}, not a list [...]"},
    {6, "patches: [[a, b]]", ":6:11: an item of 'patches' must be a mapping"},
    {5, "layers: []", ":5:9: no layers"},
    {5,
     "layers: [{name: top, material: pzt, thickness: 1}, {name: top, material: pzt, thickness: 1}]",
     ":5:52: there are two layers named 'top'"},
    {5, "layers: [{name: top, material: pzt, thickness: 1, patched: true}]",
     "every layer is patched"},
    {5,
     "layers: [{name: top, material: pzt, thickness: 1}, {material: pzt, thickness: 1, patched: "
     "on}]",
     ":5:52: this layer is patched but no patches"},
    {5, "layers: [{name: top, material: pzt, thickness: 1, poling: 4}]",
     ":5:59: 'poling: 4' is not known"},
    /* patches, actuators, limits */
    {6, "patches: [{name: p, layer: up}]", ":6:28: there is no layer named 'up'"},
    {6, "patches: [{name: p, layer: top, theta1: [0, 0.7], grid: [2, 1]}]",
     ":6:11: patches 'p': the edge theta1 = 0.35 is no mesh line, the nearest is 0.5"},
    {6, "patches: [{name: p, layer: top, theta1: [1, 0], grid: [2, 1]}]",
     "write [from, to] ascending"},
    {6, "patches: [{name: p, layer: top, theta2: [0, 0.5], grid: [1, 2]}]",
     "the edge theta2 = 0.25 is no mesh line"},
    {6, "patches: [{name: p, layer: top, grid: [1, 3]}]",
     "3 along theta2, but the mesh has 2 elements there"},
    {6, "patches: [{name: p, layer: top, grid: [2, 1]}, {name: q, layer: top}]",
     ":6:48: patches 'p' and 'q' overlap"},
    {7, "actuators: [{name: v, drives: [{patches: q}]}]", ":7:42: there are no patches named 'q'"},
    {7, "actuators: [{name: v, drives: [{patches: p}, {patches: p}]}]",
     ":7:46: patches 'p' are driven by 'v' already"},
    {7, "actuators: [{name: v}]", ":7:13: actuator 'v' needs one of drives"},
    {7, "actuators: [{name: v, temperature: uniform}]", "1 amplifiers; give one for each"},
    {8, "limits: {voltage: [100, -100]}", ":8:19: voltage from 100 to -100 is empty"},
    {8, "limits: {voltage: [100]}", ":8:19: 'voltage' has 1 values; give two"},
    {8, "limits: {step_limit: 0}", ":8:22: 'step_limit: 0' must be above 0"},
    {8, "limits: {regularisation: -1}", ":8:26: 'regularisation: -1' must not be below 0"},
    {8, "limits: {each: [{actuator: w, hold: 0}]}",
     ":8:28: there is no actuator 'w'; the first one is 'v_1_1'"},
    {8, "limits: {each: [{actuator: v_3_1, hold: 0}]}", "there is no actuator 'v_3_1'"},
    {8, "limits: {each: [{actuator: v}]}", ":8:17: an item of 'each' needs either voltage"},
    {8, "limits: {each: [{actuator: v, hold: 0, step_limit: 1}]}", "'hold' keeps the voltage"},
    {8, "limits: {each: [{actuator: v, step_limit: 0}]}", "'step_limit: 0' must be above 0"},
    {8, "limits: {each: [{actuator: v, rate_limit: 5}]}", "but the scene has no tick rate"},
    {7, "actuators: []\nsensors: [{drives: [{patches: p}]}]",
     ":8:11: 'name' is missing in sensors"},
    {7, "actuators: []\nsensors: [{name: s}]", ":8:11: 'drives' is missing in sensors"},
    {7, "actuators: []\nsensors: [{name: s, drives: [{patches: q}]}]",
     ":8:40: there are no patches named 'q'"},
    {7, "actuators: []\nsensors: [{name: s, drives: []}]",
     ":8:29: 'drives' is empty; name the patches"},
    {7, "actuators: []\nsensors: [{name: s, drives: [{patches: p, factor: x}]}]",
     ":8:51: 'factor: x' varies over the surface"},
    {7, "actuators: []\nsensors: [{name: s, drives: [{patches: p}], circuit: closed}]",
     ":8:54: 'circuit: closed' is not known; known: open, short"},
    {7, "actuators: []\nsensors: [{name: s, temperature: uniform}]",
     ":8:21: unknown key 'temperature' in sensors"},
    {7, "actuators: []\nsensors: [{name: s, drives: [{patches: p}]}]",
     ":8:30: patches 'p' are of 'pzt', which has no permittivity; a sensor needs it"},
    {7, "actuators: []\nsensors: s", ":8:10: 'sensors' must be a list [...], not a single value"},
    {7,
     "actuators: [{name: v, drives: [{patches: p}]}]\nsensors: [{name: s, drives: [{patches: p}]}]",
     ":8:30: patches 'p' are driven by 'v' already"},
    /* supports, loads, outputs, target, compare */
    {9, "supports: [{edge: left, fix: clamped}]",
     ":9:19: 'edge: left' is not known; known: theta1-"},
    {9, "supports: [{fix: clamped}]", ":9:12: no place in this item of supports"},
    {9, "supports: [{at: nodes, edge: theta1-, fix: clamped}]", "two places"},
    {9, "supports: [{at: nodes, fix: simple}]", ":9:29: 'simple' depends on an edge"},
    {9, "supports: [{at: {theta1: 0.1, theta2: 0}, fix: clamped}]",
     ":9:17: (0.1, 0) is no node of the mesh; the nearest is (0, 0)"},
    {9, "supports: [{edge: theta1-, fix: [u4]}]", ":9:34: 'fix: u4' is not known; known: clamped"},
    {9, "supports: [{edge: theta1+, fix: u3, value: 1}]",
     ":9:12: a support with a 'value' needs kinematics: nonlinear"},
    {9, "supports: [{edge: theta1+, fix: u3, value: }]", ":9:44: 'value' is empty"},
    {9, "supports: [{edge: theta1+, fix: u3, value: [1]}]",
     ":9:44: 'value' must be a single value, not a list"},
    {9, "supports: [{edge: theta1+, fix: u3, value: w}]",
     ":9:44: 'value: w' is no number or formula, at its character 1: unknown name"},
    {9, "supports: [{edge: theta1+, fix: clamped, value: 1}]",
     ":9:33: 'clamped' is no single displacement to give a value; name one, as fix: u3"},
    {9, "supports: [{edge: theta1+, fix: [u1, symmetric], value: 1}]",
     ":9:38: 'symmetric' is no single displacement"},
    {9, "supports: [{edge: theta1+, fix: free, value: 1}]",
     ":9:33: 'free' is no single displacement"},
    {9, "supports: [{edge: theta1+, value: 1}]", ":9:12: 'fix' is missing in supports"},
    {10, "loads: [{face: inner, pressure: 1, follower: wind}]",
     ":10:46: 'follower: wind' is not known; known: normal, pressure"},
    {10, "loads: [{face: inner, pressure: 1, follower: [normal]}]",
     ":10:46: 'follower' must be a single value, not a list"},
    {10, "loads: [{face: inner, u3: 1, follower: normal}]",
     ":10:30: 'follower' belongs to a pressure on a face"},
    {10, "loads: [{line: theta1+, u3: 1, follower: normal}]",
     ":10:32: 'follower' belongs to a pressure on a face"},
    {10, "loads: [{face: middle, pressure: 1, follower: pressure}]",
     ":10:47: 'follower: pressure' acts on one face; write face: inner or face: outer"},
    {10, "loads: [{face: inner, pressure: 1, follower: pressure, area: reference}]",
     ":10:46: 'follower: pressure' is per deformed area; remove 'area'"},
    {10, "loads: [{face: inner, pressure: 1, follower: normal, area: true}]",
     ":10:46: 'follower: normal' is per reference area; remove 'area'"},
    {10, "loads: []\ncontact: {face: outer, body: {type: sphere, point: [0, 0, 9], radius: 1}}",
     ":11:10: contact needs kinematics: nonlinear"},
    {10, "loads: []\ncontact: 1",
     ":11:10: 'contact' must be a mapping {key: value}, not a single value"},
    {10, "loads: []\ncontact: {body: {type: sphere, point: [0, 0, 9], radius: 1}}",
     ":11:10: 'face' is missing in contact"},
    {10, "loads: []\ncontact: {face: outer}", ":11:10: 'body' is missing in contact"},
    {10, "loads: []\ncontact: {face: middle, body: {type: sphere, point: [0, 0, 9], radius: 1}}",
     ":11:17: 'face: middle' is not known; known: outer, inner"},
    {10, "loads: []\ncontact: {face: outer, body: plane}",
     ":11:30: 'body' must be a mapping {key: value}, not a single value"},
    {10, "loads: []\ncontact: {face: outer, body: {point: [0, 0, 9]}}",
     ":11:30: 'type' is missing in body"},
    {10, "loads: []\ncontact: {face: outer, body: {type: box}}",
     ":11:37: 'type: box' is not known; known: plane, cylinder, sphere, psi"},
    {10, "loads: []\ncontact: {face: outer, body: {type: plane, point: [0, 0, 9]}}",
     ":11:30: 'normal' is missing in body; a plane needs it"},
    {10, "loads: []\ncontact: {face: outer, body: {type: plane, point: [0, 0], normal: [0, 0, 1]}}",
     ":11:51: 'point' has 2 values; give three, [x, y, z]"},
    {10, "loads: []\ncontact: {face: outer, body: {type: plane, point: 0, normal: [0, 0, 1]}}",
     ":11:51: 'point' must be a list [...], not a single value"},
    {10,
     "loads: []\ncontact: {face: outer, body: {type: plane, point: [0, 0, x], normal: [0, 0, 1]}}",
     ":11:58: 'point: x' varies over the surface"},
    {10,
     "loads: []\ncontact: {face: outer, body: {type: plane, point: [0, 0, 9], normal: [0, 0, 0]}}",
     ":11:70: 'normal: [0, 0, 0]' has no direction"},
    {10,
     "loads: []\ncontact: {face: outer, body: {type: plane, point: [0, 0, 9], normal: [0, 0, 1], "
     "radius: 1}}",
     ":11:81: 'radius' has no meaning for a plane"},
    {10, "loads: []\ncontact: {face: outer, body: {type: cylinder, point: [0, 0, 9], radius: 1}}",
     ":11:30: 'axis' is missing in body; a cylinder needs it"},
    {10,
     "loads: []\ncontact: {face: outer, body: {type: cylinder, point: [0, 0, 9], axis: [0, 0, 0], "
     "radius: 1}}",
     ":11:71: 'axis: [0, 0, 0]' has no direction"},
    {10, "loads: []\ncontact: {face: outer, body: {type: sphere, point: [0, 0, 9], radius: 0}}",
     ":11:71: 'radius: 0' must be above 0"},
    {10, "loads: []\ncontact: {face: outer, body: {type: psi}}",
     ":11:30: 'value' is missing in body; a psi needs it"},
    {10, "loads: []\ncontact: {face: outer, body: {type: psi, value: 1}}",
     ":11:49: 'value: 1' is the same everywhere; give a function of x, y, z"},
    {10, "loads: []\ncontact: {face: outer, body: {type: psi, value: theta1+x}}",
     ":11:49: 'value: theta1+x' uses theta1 or theta2"},
    {10, "loads: []\ncontact: {face: outer, body: {type: psi, value: x+}}",
     ":11:49: 'value: x+' is no number or formula"},
    {10,
     "loads: []\ncontact: {face: outer, body: {type: sphere, point: [0, 0, 9], radius: 1}, move: "
     "2}",
     ":11:81: 'move' must be a list [...], not a single value"},
    {10,
     "loads: []\ncontact: {face: outer, body: {type: sphere, point: [0, 0, 9], radius: 1}, "
     "stiffness: 0}",
     ":11:86: 'stiffness: 0' must be above 0"},
    {10, "loads: [{pressure: 1}]", "'pressure' acts on a face"},
    {10, "loads: [{face: outer, x: 1, y: 1}]", ":10:29: a load has one direction"},
    {10, "loads: [{face: outer, line: theta1-, x: 1}]", "a load is one of point, line, face"},
    {10, "loads: [{face: outer}]", ":10:9: a load needs a direction"},
    {10, "loads: [{}]", ":10:9: a load needs one of point"},
    {10, "loads: [{weight: {axis: z, gravity: x}}]", "'gravity: x' varies"},
    {10, "loads: [{weight: {axis: z, gravity: 1}, x: 2}]", "weight and temperature say all"},
    {10, "loads: [{temperature: 20}]", ":10:9: a temperature moves nothing"},
    {10, "loads: [{face: outer, z: sin()}]",
     ":10:26: 'z: sin()' is no number or formula, at its character 5"},
    {10, "loads:", "'loads' must be a list [...], not empty"},
    {11, "outputs: [{name: tip, at: nodes}]", ":11:11: no direction in this item of outputs"},
    {11, "outputs: [{name: tip, u3: top, at: nodes}]",
     ":11:27: 'u3: top' is not known; known: middle"},
    {11, "outputs: [{name: tip, u3: inner, at: {theta1: 3, theta2: 0}}]",
     ":11:38: (3, 0) is no node of the mesh; the nearest is (2, 0)"},
    {11, "outputs: [{name: a, u3: inner, at: nodes}, {name: a, u2: inner, at: nodes}]",
     ":11:44: there are two outputs named 'a'"},
    {11, "outputs: [{name: N, contact: x}]",
     ":11:21: no contact in this scene; add contact: {face: outer, body: ...}"},
    {11, CONTACT "outputs: [{name: N, contact: u}]",
     ":12:30: 'contact: u' is not known; known: x, y, z, nodes, pressure"},
    {11, CONTACT "outputs: [{name: N, contact: x, u3: middle}]",
     ":12:21: an output is one quantity; write a second item"},
    {11, CONTACT "outputs: [{name: N, contact: x, at: {theta1: 0.1, theta2: 0}}]",
     ":12:37: (0.1, 0) is no node of the mesh"},
    {11, CONTACT "outputs: [{name: N, contact: pressure}]",
     ":12:11: no place in this item of outputs"},
    {11, CONTACT "outputs: [{name: N, contact: pressure, at: {theta1: 0.1, theta2: 0}}]",
     ":12:44: (0.1, 0) is no node of the mesh"},
    {11, CONTACT "outputs: [{name: N, contact: [x]}]",
     ":12:30: 'contact' must be a single value, not a list"},
    {12, "target: {u3: middle, contact: x, at: nodes, value: x}",
     ":12:22: unknown key 'contact' in target"},
    {12, "target: {u3: middle, at: nodes, value: w}",
     ":12:40: 'value: w' is no number or formula, at its character 1: unknown name"},
    {12, "target: {u3: middle, at: nodes}", ":12:9: 'value' is missing in target"},
    {10, "loads: [{temperature: {inner: 1}}]", ":10:23: 'outer' is missing in temperature"},
    {10, "loads: [{temperature: {inner: 1, outer: 2, middle: 3}}]",
     ":10:44: unknown key 'middle' in temperature"},
    {11, "outputs: [{name: q, charge: s}]",
     ":11:29: there is no sensor or actuator 's'; add it to sensors"},
    {11, "outputs: [{name: q, voltage: v_9_9}]", ":11:30: there is no sensor or actuator 'v_9_9'"},
    {11, "outputs: [{name: q, charge: v, at: nodes}]",
     ":11:36: an electrode has one voltage and one charge; remove the place"},
    {11, "outputs: [{name: q, u3: middle, charge: v}]", ":11:33: an output is one quantity"},
    {11, "outputs: [{name: q, u3: middle, at: {theta1: [1.1, 1.4]}}]",
     ":11:37: no node of the mesh lies in this rectangle"},
    {11, "outputs: [{name: q, u3: middle, at: {theta1: [1, 0]}}]",
     ":11:37: no node of the mesh lies in this rectangle; write [from, to], ascending"},
    {11, "outputs: [{name: q, u3: middle, at: {theta1: [0, 1], theta2: 0}}]",
     ":11:62: 'theta2' must be a list"},
    {11, "outputs: [{name: q, u3: middle, at: {theta1: [0]}}]",
     ":11:46: 'theta1' has 1 values; give two"},
    {11, "outputs: [{name: q, u3: middle, at: {theta3: [0, 1]}}]",
     ":11:38: unknown key 'theta3' in at"},
    {12, "target: {u3: middle, at: nodes, value: x, modes: 3}", ":12:50: 'modes' must be a list"},
    {12, "target: {u3: middle, at: nodes, value: x, modes: [{value: x}]}",
     ":12:51: 'name' is missing in modes"},
    {12, "target: {u3: middle, at: nodes, value: x, modes: [{name: a}]}",
     ":12:51: 'value' is missing in modes"},
    {12,
     "target: {u3: middle, at: nodes, value: x, modes: [{name: a, value: x}, {name: a, value: y}]}",
     ":12:72: there are two modes named 'a'"},
    {12, "target: {u3: middle, at: nodes, value: \"zernike(4, x)\"}",
     "this function needs three arguments"},
    {12, "target: {u3: middle, at: nodes, value: \"zernike(4, x, y, 1)\"}", "too many arguments"},
    {13, "compare: [{name: c, values: [1]}]", ":13:29: 1 values for 2 amplifiers"},
};

/* A wrong line gives its own place, the offending word and a cure. */
static void test_bad_lines(void **state)
{
    size_t i;
    (void)state;
    for (i = 0; i < sizeof bad_lines / sizeof *bad_lines; i++) {
        write_base(bad_lines[i].line, bad_lines[i].text);
        expect_fault(NULL, 0, bad_lines[i].expected);
    }
}

static const struct {
    const char *set, *expected;
} bad_sets[] = {
    {"mesh", "--set mesh: no '='"},
    {"=1", "--set : write --set a.b.c=value"},
    {"mesh=", "--set mesh: no value"},
    {"mesh.theta3=1", "--set mesh.theta3: unknown key 'theta3' in mesh; did you mean 'theta1'?"},
    {"mesh.theta1.elements=0", "--set mesh.theta1.elements: 'elements: 0' must be from 1"},
    {"layers.9.thickness=1", "--set layers.9.thickness: 'layers' has no item '9'; it has 2"},
    {"layers.roof.thickness=1", "'layers' has no item 'roof'"},
    {"no.such=1", "there is no 'no' in scene"},
    {"name.x=1", "'name' is a single value"},
    {"materials.steel.nu=0.5", "--set materials.steel.nu: 'nu: 0.5' of steel"},
    {"name=[", "--set name: not YAML"},
    {"outputs.tip.at={theta1: 7, theta2: 0}", "--set outputs.tip.at: (7, 0) is no node"},
    {"hysteresis={range: [-9, 9], slopes: [1, 1, 1, 1], slack: [2, 1], above: [0, 0]}",
     "'slack' must rise; 1 follows 2"},
    {"hysteresis={range: [-9, 9], slopes: [1, 1, 1, 1], slack: [1, 2], above: [0, 0, 0]}",
     "'slack' has 2 plays, 'above' 3 and 'below' 3"},
    {"hysteresis={range: [-9, 9], slopes: [1, 1, 1, 1], slack: [1], above: [-0.1]}",
     "'above: -0.1' must be from 0 to 100"},
    {"hysteresis={range: [-9, 9], slopes: [1, 1, 1, 1], slack: [1], above: [0], creep: [0.1]}",
     "'creep' has 1 numbers, 'creep_time' 0"},
    {"hysteresis={range: [-9, 9], slopes: [1, 1, 1, 1], slack: [], above: [0]}",
     "the list has 0 numbers; it needs 1"},
    {"hysteresis={range: [-9, 9], slopes: [1, 1, 1, 1], slack: 1, above: [0]}",
     "write a list of 1 to 32 numbers here"},
    {"hysteresis={range: [9, -9], slopes: [1, 1, 1, 1], slack: [1], above: [0]}",
     "'range: [9, -9]' must rise"},
    {"hysteresis={range: [-9, 9], slopes: [1, 1, 0], slack: [1], above: [0]}",
     "'slopes: 0' must be from 0.001 to 100"},
    {"hysteresis={range: [-9, 9], slopes: [1, 1, 1], slack: [1], above: [0]}",
     "the list has 3 numbers; it needs 4"},
};

/* A wrong change names itself. */
static void test_bad_sets(void **state)
{
    size_t i;
    (void)state;
    write_base(0, "");
    for (i = 0; i < sizeof bad_sets / sizeof *bad_sets; i++)
        expect_fault(&bad_sets[i].set, 1, bad_sets[i].expected);
}

/* What is no scene file at all is refused by name. */
static void test_bad_files(void **state)
{
    static const char nul[] = "name: a\0b\n";
    char error[SCENE_ERROR];
    scene scene;
    (void)state;
    write_bytes("", 0);
    expect_fault(NULL, 0, ":1:1: the file is empty");
    write_bytes("# only a comment\n", 17);
    expect_fault(NULL, 0, ":1:1: the file is empty");
    write_bytes("steel\n", 6);
    expect_fault(NULL, 0, ":1:1: 'scene' must be a mapping");
    write_bytes(nul, sizeof nul - 1);
    expect_fault(NULL, 0, ":1:8: not text");
    assert_int_equal(truncate(file, 100000000), 0);
    expect_fault(NULL, 0, "larger than 4 MB");
    assert_int_equal(scene_read(&scene, "/tmp", NULL, 0, error), -1);
    assert_string_equal(error, "/tmp: is not a file; give the path of a scene file");
    assert_int_equal(scene_read(&scene, "/no/such.yaml", NULL, 0, error), -1);
    assert_non_null(strstr(error, "/no/such.yaml: cannot be opened"));
}

/* ---- good scenes ---- */

/* Every shipped scene reads and bears its file's name. */
static void test_shipped(void **state)
{
    DIR *folder = opendir(scenes);
    struct dirent *entry;
    int count = 0;
    (void)state;
    assert_non_null(folder);
    while ((entry = readdir(folder)) != NULL) {
        const size_t n = strlen(entry->d_name);
        char path[600];
        scene scene;
        if (n < 6 || strcmp(entry->d_name + n - 5, ".yaml") != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", scenes, entry->d_name);
        expect_good(&scene, path, NULL, 0);
        assert_int_equal(strlen(scene.name), n - 5);
        assert_memory_equal(scene.name, entry->d_name, n - 5);
        scene_free(&scene);
        count++;
    }
    closedir(folder);
    assert_true(count >= 20);
}

/* What is written is what is read: the plate with 50 patches. */
static void test_meaning(void **state)
{
    char path[600], name[SCENE_LABEL];
    const expr_point at = {0.2, 0.2, 0, 0.2, 0.2};
    scene scene;
    int first, count;
    (void)state;
    snprintf(path, sizeof path, "%s/plate-50-patches.yaml", scenes);
    expect_good(&scene, path, NULL, 0);
    assert_int_equal(scene.layers, 6);
    assert_int_equal(scene.amplifiers, 25);
    assert_int_equal(scene.line[0].elements, 10);
    assert_true(scene.element.cartesian == 0 && scene.element.tau == 0 &&
                scene.element.exact_area == 0 && scene.element.dof_per_node == 7);
    assert_true(scene.layer[1].angle == 90 && scene.layer[0].patched && !scene.layer[1].patched &&
                scene.layer[5].poling == 3);
    assert_true(scene.material[1].e[2] == 63e9 && fabs(scene.material[1].g23 - 63e9 / 2.6) < 1 &&
                scene.material[1].has_d);
    assert_true(fabs(scene.reference - 0.5e-3) < 1e-15);
    assert_int_equal(scene.support[0].fix, 0x7f);
    assert_true(fabs(expr_value(scene.target.value, &at) - 0.002) < 1e-15);
    assert_true(scene.compare[0].value[1] == -181);
    assert_true(scene.output[0].where.node[0] == 10 && scene.output[0].where.node[1] == 10 &&
                isnan(scene.output[0].reference));
    scene_amplifier_name(&scene, 1, name);
    assert_string_equal(name, "v_1_2");
    assert_true(scene_find_amplifier(&scene, "v_5_5", &first, &count) && first == 24 && count == 1);
    assert_true(scene_find_amplifier(&scene, "v", &first, &count) && first == 0 && count == 25);
    assert_false(scene_find_amplifier(&scene, "v_05_5", &first, &count));
    scene_free(&scene);
}

static unsigned fix_of(const char *text)
{
    scene scene;
    unsigned fix;
    write_base(9, text);
    expect_good(&scene, file, NULL, 0);
    fix = scene.support[0].fix;
    scene_free(&scene);
    return fix;
}

/* Supports fix the unknowns: means u1 u2 u3, differences u1 u2 u3, seventh. */
static void test_supports(void **state)
{
    (void)state;
    assert_int_equal(fix_of("supports: [{edge: theta1-, fix: simple}]"), 0x76);
    assert_int_equal(fix_of("supports: [{edge: theta2+, fix: simple}]"), 0x6d);
    assert_int_equal(fix_of("supports: [{edge: theta1+, fix: symmetric}]"), 0x09);
    assert_int_equal(fix_of("supports: [{edge: theta2-, fix: symmetric}]"), 0x12);
    assert_int_equal(fix_of("supports: [{edge: theta1-, fix: free}]"), 0);
    assert_int_equal(fix_of("supports: [{at: nodes, fix: [u1 mean, u2 difference, u3M]}]"), 0x51);
    assert_int_equal(fix_of("supports: [{at: {theta1: 1/2, theta2: 0.5}, fix: u3}]"), 0x64);
}

/* Changes replace and add, reach items by number and by name, and alter the hash. */
static void test_changes(void **state)
{
    static const char *const set[] = {
        "mesh.theta2={from: 0, to: 2, elements: 8, grading: 4}",
        "layers.top.thickness=2e-3",
        "layers.0.angle=45",
        "materials.pzt.nu=1/4",
        "limits.regularisation={relative: 0.5}",
        "limits.each=[{actuator: v_2_1, hold: 5}, {actuator: v, voltage: [-1, 1], step_limit: "
        "3}, {actuator: v_1_1, step_limit: 2}]",
        "supports.1={at: nodes, fix: [u2]}",
        "element=published",
        "actuators.v.applied=3",
        "loads=[{weight: {axis: z, gravity: -9.81}}]"};
    scene plain, scene;
    (void)state;
    write_base(0, "");
    expect_good(&plain, file, NULL, 0);
    expect_good(&scene, file, set, (int)(sizeof set / sizeof *set));
    assert_int_not_equal(plain.hash, scene.hash);
    assert_int_equal(scene.line[1].elements, 8);
    assert_true(fabs((scene.line[1].point[8] - scene.line[1].point[7]) / scene.line[1].point[1] -
                     4) < 1e-12);
    assert_true(scene.layer[1].thickness == 2e-3 && scene.layer[0].angle == 45 &&
                scene.material[1].nu12 == 0.25);
    assert_true(scene.limits.regularisation_is_relative && scene.limits.regularisation == 0.5);
    assert_true(scene.limits.each_count == 3 && scene.limits.each[0].first == 1 &&
                scene.limits.each[0].lower == 5 && scene.limits.each[1].count == 2);
    assert_true(isinf(scene.limits.each[0].step_limit) && scene.limits.each[1].step_limit == 3 &&
                scene.limits.each[2].step_limit == 2 && !scene.limits.each[2].has_voltage);
    assert_true(scene.supports == 2 && scene.element.exact_area == 0 &&
                scene.actuator[0].applied == 3);
    assert_true(scene.load[0].type == LOAD_WEIGHT && scene.load[0].component == COMPONENT_Z);
    assert_true(plain.element.exact_area == 1 && plain.element.rho == 0.09 &&
                isinf(plain.limits.step_limit) && plain.reference_is_middle);
    scene_free(&plain);
    scene_free(&scene);
}

/* The words of large displacements mean what they say; what is not said has its default. */
static void test_nonlinear_words(void **state)
{
    static const char *const set[] = {
        "kinematics=auto",
        "tolerance=1/50",
        "equilibrium={load_steps: 3, tolerance: 1e-6, extrapolated_iterations: 0, ramp_solves: 4, "
        "linear_solves: 50}",
        "supports.1={edge: theta1+, fix: [u3, u1 mean], value: 2*x}",
        "loads=[{face: inner, pressure: 2, follower: pressure}, "
        "{face: middle, pressure: 1, follower: normal}]",
        "contact={face: inner, body: {type: cylinder, point: [1, 2, "
        "3], axis: [0, 3, 4], radius: 5}, move: [0, 0, -1]}",
        "outputs.1={name: N, contact: z, reference: 7}",
        "outputs.2={name: p, contact: pressure, at: nodes}",
        "mesh.theta1={from: -1, to: 3, elements: 4, centre: 0.6}",
        "outputs.tip.at.theta1=3",
        "patches=[]",
        "actuators=[]",
        "compare=[]"};
    static const char *const bodies[] = {
        "contact.body={type: plane, point: [0, 0, 1], normal: [0, 0, 2]}",
        "contact.body={type: sphere, point: [0, 0, 1], radius: 2}",
        "contact.body={type: psi, value: x^2+y^2+z^2-1}"};
    const expr_point at = {1, 2, 3, 0, 0};
    scene scene;
    int i;
    (void)state;
    write_base(12, "");
    expect_good(&scene, file, set, (int)(sizeof set / sizeof *set));
    assert_true(scene.kinematics == KINEMATICS_AUTO && scene.tolerance == 0.02);
    assert_true(scene.equilibrium.load_steps == 3 && scene.equilibrium.tolerance == 1e-6 &&
                scene.equilibrium.extrapolated_iterations == 0 &&
                scene.equilibrium.ramp_solves == 4 && scene.equilibrium.linear_solves == 50);
    assert_true(scene.support[1].fix == 0x65 && scene.support[1].move == 0x05 &&
                expr_value(scene.support[1].value, &at) == 2 && !scene.support[0].value);
    assert_true(scene.load[0].follower == FOLLOWER_PRESSURE && scene.load[0].true_area &&
                scene.load[1].follower == FOLLOWER_NORMAL && !scene.load[1].true_area);
    assert_true(scene.contact.given && scene.contact.face == FACE_INNER &&
                scene.contact.body.type == BODY_CYLINDER && scene.contact.stiffness == 10);
    assert_true(scene.contact.body.point[2] == 3 && scene.contact.body.axis[2] == 0.8 &&
                scene.contact.body.radius == 5 && scene.contact.move[2] == -1);
    assert_true(scene.output[0].type == OUTPUT_DISPLACEMENT &&
                scene.output[1].type == OUTPUT_CONTACT_FORCE && scene.output[1].part == 2 &&
                scene.output[1].reference == 7);
    assert_true(scene.output[2].type == OUTPUT_CONTACT_PRESSURE &&
                scene.output[2].where.type == WHERE_NODES);
    for (i = 0; i <= 4; i++) { /* 1 + 2 (0.6 s + 0.4 s^3) */
        const double x = i / 2.0 - 1;
        assert_true(fabs(scene.line[0].point[i] - (1 + 2 * (0.6 * x + 0.4 * x * x * x))) < 1e-15);
    }
    scene_free(&scene);
    for (i = 0; i < 3; i++) {
        static const scene_body_type types[] = {BODY_PLANE, BODY_SPHERE, BODY_PSI};
        const char *const both[] = {set[0], set[5], bodies[i]};
        write_base(0, "");
        expect_good(&scene, file, both, 3);
        assert_true(scene.contact.body.type == types[i] &&
                    (i != 0 || scene.contact.body.normal[2] == 1));
        assert_true(i != 2 || expr_value(scene.contact.body.value, &at) == 13);
        scene_free(&scene);
    }
    expect_good(&scene, file, NULL, 0);
    assert_true(scene.kinematics == KINEMATICS_LINEAR && scene.tolerance == 0.01 &&
                !scene.contact.given && scene.load[0].follower == FOLLOWER_NONE);
    assert_true(scene.equilibrium.load_steps == 1 && scene.equilibrium.tolerance == 1e-4 &&
                scene.equilibrium.extrapolated_iterations == 12 &&
                scene.equilibrium.ramp_solves == 0 && scene.equilibrium.linear_solves == 400);
    scene_free(&scene);
}

/* ---- expressions ---- */

/* Expressions keep the rules of arithmetic. */
static void test_expressions(void **state)
{
    static const struct {
        const char *text;
        double value;
    } good[] = {{"1+2*3", 7},
                {"(1+2)*3", 9},
                {"-2^2", -4},
                {"2^3^2", 512},
                {"2^-1", 0.5},
                {"6/3/2", 1},
                {"1-2-3", -4},
                {"--2", 2},
                {"2*-3+1", -5},
                {" 40 * pi / 180", 40 * 3.14159265358979323846 / 180},
                {"x+10*y+100*z", 321},
                {"theta1*theta2", 20},
                {"sqrt(16)+abs(-1)", 5},
                {"min(3, 2)+max(1, 2)*10", 22},
                {"hypot(3,4)", 5},
                {"pow(2,10)", 1024},
                {"atan2(0,1)", 0},
                {"exp(log(2))", 2},
                {"zernike(1, 0.3, 2)", 1},
                {"zernike(4, 1, 0)^2", 3},
                {"zernike(2, 0.5, 0)", 1},
                {"zernike(3, 0.5, pi/2)", 1},
                {"zernike(5, 1, pi/4)^2", 6},
                {"zernike(6, 1, 0)^2", 6},
                {"zernike(11, 0, 5)^2", 5},
                {"zernike(7, 1, pi/2)^2", 8},
                {"1e3", 1000},
                {".5", 0.5}};
    static const struct {
        const char *text;
        int column;
    } bad[] = {{"", 1},     {"1+", 3},    {"1 2", 3},    {"(1", 3},       {"1)", 2},
               {"w", 1},    {"sin 1", 5}, {"min(1)", 6}, {"sin(1,2)", 6}, {"1,2", 2},
               {"2**3", 2}, {"0x10", 1},  {"1e999", 1},  {"\"", 1}};
    const expr_point at = {1, 2, 3, 4, 5};
    char deep[201];
    const char *why;
    size_t i;
    int column;
    (void)state;
    for (i = 0; i < sizeof good / sizeof *good; i++) {
        expr *expression = expr_compile(good[i].text, &column, &why);
        if (!expression)
            fail_msg("%s: %s", good[i].text, why);
        if (fabs(expr_value(expression, &at) - good[i].value) > 1e-12 * fabs(good[i].value))
            fail_msg("%s = %g", good[i].text, expr_value(expression, &at));
        expr_free(expression);
    }
    for (i = 0; i < sizeof bad / sizeof *bad; i++) {
        if (expr_compile(bad[i].text, &column, &why))
            fail_msg("'%s' compiles", bad[i].text);
        if (column != bad[i].column)
            fail_msg("'%s': column %d, %s", bad[i].text, column, why);
    }
    memset(deep, '(', 200);
    deep[200] = 0;
    assert_null(expr_compile(deep, &column, &why));
}

/* ---- units ---- */

/* The base scene with units, as --set changes; what a case adds comes behind them. */
static const char *const metric = "units={length: m, force: N, voltage: V, temperature: K}";
static const char *const milli = "units={length: mm, force: N, voltage: V, temperature: K}";
static const char *const kilo = "units={length: cm, force: kN, voltage: kV, temperature: mK}";

typedef struct unit_case {
    const char *units, *with_unit, *plain;
} unit_case;

/*
 * Both ways of typing a number; the plain one is worked out by hand from the definitions of the
 * units. Both sides go through strtod once, so that the scenes must agree in every bit.
 */
static const unit_case unit_cases[] = {
    {"m", "layers.0.thickness=0.3 mm", "layers.0.thickness=0.3e-3"},
    {"m", "layers.0.thickness=300um", "layers.0.thickness=300e-6"},
    {"m", "layers.0.thickness=30\xc2\xb5m", "layers.0.thickness=30e-6"},
    {"mm", "layers.0.thickness=0.3 mm", "layers.0.thickness=0.3"},
    {"mm", "layers.0.thickness=1.7e-4 m", "layers.0.thickness=1.7e-1"},
    {"cm", "layers.0.thickness=0.3 mm", "layers.0.thickness=0.3e-1"},
    {"m", "materials.steel.E=135 GPa", "materials.steel.E=135e9"},
    {"mm", "materials.steel.E=135 GPa", "materials.steel.E=135e3"},
    {"mm", "materials.steel.E=7.1e10 N/m^2", "materials.steel.E=7.1e4"},
    {"cm", "materials.steel.E=135.3 GPa", "materials.steel.E=135.3e2"},
    {"m", "materials.steel.density=7600 kg/m3", "materials.steel.density=7600"},
    {"mm", "materials.steel.density=7600 kg/m3", "materials.steel.density=7600e-12"},
    {"mm", "materials.steel.density=7.6 g*cm^-3", "materials.steel.density=7.6e-9"},
    {"mm", "materials.steel.density=7.6e-9 t/mm3", "materials.steel.density=7.6e-9"},
    {"cm", "materials.steel.density=7600 kg/m3", "materials.steel.density=7600e-11"},
    {"m", "materials.pzt.d31=-210 pC/N", "materials.pzt.d31=-210e-12"},
    {"mm", "materials.pzt.d31=-210 pC/N", "materials.pzt.d31=-210e-9"},
    {"mm", "materials.pzt.d31=-0.21 nm/V", "materials.pzt.d31=-0.21e-6"},
    {"cm", "materials.pzt.d31=-210 pC/N", "materials.pzt.d31=-210e-7"},
    {"m", "materials.pzt={E: 1, nu: 0, e31: 25.1 C/m2}", "materials.pzt={E: 1, nu: 0, e31: 25.1}"},
    {"mm", "materials.pzt={E: 1, nu: 0, e31: 25.1 C/m2}",
     "materials.pzt={E: 1, nu: 0, e31: 25.1e-3}"},
    {"mm", "materials.pzt.permittivity=15.3 nF/m", "materials.pzt.permittivity=15.3e-9"},
    {"cm", "materials.pzt.permittivity=15.3 nF/m", "materials.pzt.permittivity=15.3e-6"},
    {"mm", "materials.pzt.pyroelectric=-0.3 mC/(m2 K)", "materials.pzt.pyroelectric=-0.3e-6"},
    {"mm", "materials.pzt.pyroelectric=-0.3 mC/m2/K", "materials.pzt.pyroelectric=-0.3e-6"},
    {"cm", "materials.pzt.alpha=12.1e-6 1/K", "materials.pzt.alpha=12.1e-9"},
    {"mm", "materials.pzt.field_limit=0.7 MV/m", "materials.pzt.field_limit=0.7e3"},
    {"m", "layers.0.angle=17.3 deg", "layers.0.angle=17.3"},
    {"m", "layers.0.angle=0.3 rad", "layers.0.angle=0.3*180/pi"},
    {"m", "surface={type: cone, radius: 900 mm, angle: 10 deg}",
     "surface={type: cone, radius: 900e-3, angle: 10}"},
    {"cm", "limits.voltage=[-0.1 kV, 100 V]", "limits.voltage=[-0.1, 100e-3]"},
    {"mm", "loads.0.pressure=1.3 kPa", "loads.0.pressure=1.3e-3"},
    {"mm", "loads=[{line: theta1+, u3: 0.7 N/m}]", "loads=[{line: theta1+, u3: 0.7e-3}]"},
    {"cm", "loads=[{point: {theta1: 2 cm, theta2: 0}, u3: 0.7 N}]",
     "loads=[{point: {theta1: 2, theta2: 0}, u3: 0.7e-3}]"},
    {"mm", "loads=[{weight: {axis: z, gravity: -9.81 m/s2}}]",
     "loads=[{weight: {axis: z, gravity: -9.81e3}}]"},
    {"mm", "outputs.tip.reference=3.3 um", "outputs.tip.reference=3.3e-3"},
    {"mm", "target.value=3.3 um", "target.value=3.3e-3"},
    {"cm", "compare.c.values=[10.1 V, 2 kV]", "compare.c.values=[10.1e-3, 2]"},
    {"m", "simulate={ticks: 9, sensors: {noise: 0.7 um}}",
     "simulate={ticks: 9, sensors: {noise: 0.7e-6}}"},
};

/* Expressions by their value at a point. */
static double value_of(const expr *expression)
{
    const expr_point at = {1, 2, 3, 4, 5};
    return expression ? expr_value(expression, &at) : 0;
}

static void assert_same_numbers(const scene *a, const scene *b, const char *what)
{
    const scene_load *p = a->load, *q = b->load;
    int same = a->materials == b->materials && a->layers == b->layers;
    for (int i = 0; same && i < a->materials; i++)
        same = memcmp(&a->material[i], &b->material[i], offsetof(scene_material, at)) == 0;
    for (int i = 0; same && i < a->layers; i++)
        same = memcmp(&a->layer[i], &b->layer[i], offsetof(scene_layer, at)) == 0;
    same &= a->surface.radius == b->surface.radius && a->surface.angle == b->surface.angle;
    same &= a->limits.lower == b->limits.lower && a->limits.upper == b->limits.upper;
    same &= value_of(p->value) == value_of(q->value) && p->where.theta[0] == q->where.theta[0];
    same &= memcmp(&a->output->reference, &b->output->reference, sizeof a->output->reference) == 0;
    same &= value_of(a->target.value) == value_of(b->target.value);
    same &= memcmp(a->compare->value, b->compare->value, 2 * sizeof *a->compare->value) == 0;
    same &= a->control.rate == b->control.rate && a->simulate.noise == b->simulate.noise;
    if (!same)
        fail_msg("%s: not the same bits as without a unit", what);
}

static const char *units_named(const char *name)
{
    if (strcmp(name, "m") == 0)
        return metric;
    return strcmp(name, "mm") == 0 ? milli : kilo;
}

/* A number with a unit is the same double as one typed in the scene's units. */
static void test_units(void **state)
{
    (void)state;
    write_base(0, "");
    for (size_t i = 0; i < sizeof unit_cases / sizeof *unit_cases; i++) {
        const unit_case *c = &unit_cases[i];
        const char *const units = units_named(c->units);
        const char *const with_unit[] = {units, c->with_unit}, *const plain[] = {units, c->plain};
        scene a, b;
        expect_good(&a, file, with_unit, 2);
        expect_good(&b, file, plain, 2);
        assert_same_numbers(&a, &b, c->with_unit);
        scene_free(&a);
        scene_free(&b);
    }
}

/* Degrees in a coordinate are what the formula says; a coordinate that is a length refuses them. */
static void test_unit_angles(void **state)
{
    static const char *const set[] = {"surface={type: cylinder, radius: 1, axial: theta1}",
                                      "mesh.theta2={points: [0, 10 deg, 0.5 rad]}",
                                      "supports.1={at: {theta1: 0, theta2: 10 deg}, fix: u3}"};
    const char *const flat[] = {set[1]};
    scene scene;
    (void)state;
    write_base(0, "");
    expect_good(&scene, file, set, 3); /* angles need no units of the scene */
    assert_true(scene.line[1].point[1] == 10 * 3.14159265358979323846 / 180 &&
                scene.line[1].point[2] == 0.5);
    scene_free(&scene);
    expect_fault(flat, 1,
                 "'points: 10 deg' has the unit of an angle; expected that of a length, as mm");
}

static const struct {
    const char *units, *set, *expected;
} bad_units[] = {
    {"m", "layers.0.thickness=3 V",
     "'thickness: 3 V' has the unit of a voltage; expected that of a length, as mm"},
    {"m", "layers.0.thickness=3 furlong",
     "'furlong' is no unit: known are m N V K Pa C F s Hz kg g t rad deg"},
    {"m", "layers.0.thickness=3 mm mm",
     "'thickness: 3 mm mm' has the unit 'mm mm'; expected that of a length"},
    {"m", "layers.0.thickness=3 m0", "a power of a unit runs from 1 to 9"},
    {"m", "layers.0.thickness=3 m10", "a power of a unit runs from 1 to 9"},
    {"m", "layers.0.thickness=3 m^x", "a power is a whole number, as m^2"},
    {"m", "layers.0.thickness=3 m/", "the name of a unit is missing"},
    {"m", "layers.0.thickness=1/3 mm", "'thickness: 1/3 mm' is no number or formula"},
    {"m", "layers.0.thickness=-3 mm", "'thickness: -3 mm' must be above 0"},
    {"m", "layers.0.thickness=3e99999 mm", "is too long a number; give fewer digits"},
    {"m", "layers.0.thickness=3e9998 mm", "the number is too large"},
    {"m", "layers.0.thickness=3e70 mm", "'thickness: 3e70 mm' is out of range"},
    {"m", "materials.steel.nu=0.3 mm",
     "'nu: 0.3 mm' has the unit of a length; expected a number without a unit"},
    {"m", "materials.steel.E=135 GN",
     "'E: 135 GN' has the unit of a force; expected that of a stress or pressure, as MPa"},
    {"m", "materials.steel.density=7600 kg",
     "'density: 7600 kg' has the unit of a mass; expected that of a density, as kg/m3"},
    {"m", "materials.pzt.pyroelectric=3 C/m2 K", "a product after '/' needs brackets, as C/(m2 K)"},
    {"m", "materials.pzt.pyroelectric=3 C/(m2 K", "a ')' is missing"},
    {"m", "materials.pzt.alpha=3 1/m",
     "'alpha: 3 1/m' has the unit '1/m'; expected that of a thermal expansion, as 1/K"},
    {"m", "materials.steel.alpha=1 kdeg", "'kdeg' is no unit"},
    {"m", "loads=[{temperature: 20 degC}]",
     "a temperature is a difference to the undeformed state; give it in K"},
    {"m", "loads.0.pressure=1 N/m",
     "'pressure: 1 N/m' has the unit of a force per length; expected that of a stress"},
    {"m", "loads=[{line: theta1+, u3: 1 N}]",
     "'u3: 1 N' has the unit of a force; expected that of a force per length, as N/m"},
    {"m", "target.value=1 mm*x", "'mm*x' is no unit"},
    {"m", "mesh.theta1.elements=4 m",
     "'elements: 4 m' has the unit of a length; expected a number without a unit"},
    {"none", "layers.0.thickness=3 mm",
     "'thickness: 3 mm' has a unit but the scene has no unit of length; add length: mm to units"},
    {"none", "limits.voltage=[0, 3 V]",
     "has a unit but the scene has no unit of voltage; add voltage: V to units"},
    {"inch", "layers.0.thickness=3 mm",
     "'length: inch' of the scene's units is no SI unit of a length; write one as mm"},
    {"celsius", "materials.steel.alpha=3 1/K",
     "'temperature: C' of the scene's units is no SI unit of a temperature; write one as K"},
};

/* A unit that cannot be read or converted is refused by its name, with what is expected. */
static void test_bad_units(void **state)
{
    (void)state;
    write_base(0, "");
    for (size_t i = 0; i < sizeof bad_units / sizeof *bad_units; i++) {
        const char *units = metric;
        if (strcmp(bad_units[i].units, "none") == 0)
            units = "units={force: N}";
        if (strcmp(bad_units[i].units, "inch") == 0)
            units = "units={length: inch, force: N}";
        if (strcmp(bad_units[i].units, "celsius") == 0)
            units = "units={length: m, temperature: C}";
        const char *const set[] = {units, bad_units[i].set};
        expect_fault(set, 2, bad_units[i].expected);
    }
}

/* ---- tables of keys ---- */

/* Keys of the tables, and what is missing in them. */
typedef struct table_walk {
    int keys, numbers, faults;
} table_walk;

static void walk_form(table_walk *walk, const form *form, const field *of);

/* Whether numbers are among the values of a form, apart from the values of keys below it. */
static int has_numbers(const form *form)
{
    switch (form->type) {
    case FORM_NUMBER:
    case FORM_WHOLE:
    case FORM_FORMULA: return 1;
    case FORM_LIST:
    case FORM_NAMED: return has_numbers(form->item);
    case FORM_ANY:
        for (int i = 0; form->any[i]; i++)
            if (has_numbers(form->any[i]))
                return 1;
        return 0;
    default: return 0;
    }
}

static void miss(table_walk *walk, const field *field, const char *what)
{
    print_error("'%s' (%s) has no %s\n", field->key, field->help ? field->help : "", what);
    walk->faults++;
}

static void walk_field(table_walk *walk, const field *field)
{
    const form own = field_form(field);
    const size_t length = field->help ? strlen(field->help) : 0;
    walk->keys++;
    walk->numbers += has_numbers(&own);
    if (has_numbers(&own) && field->of == OF_NOTHING)
        miss(walk, field, "dimension");
    if (length < 8 || field->help[length - 1] != '.')
        miss(walk, field, "help sentence");
    if (own.type == FORM_WORD && !own.words)
        miss(walk, field, "words");
    walk_form(walk, &own, field);
}

/* Every key of a combination is in the table. */
static void check_case(table_walk *walk, const form *form, const char *keys, const field *of)
{
    case_item item;
    while (case_next(&keys, &item)) {
        size_t start = 0;
        while (start < item.length) {
            const size_t length = strcspn(item.text + start, "| ?=");
            const field *field = form->fields;
            while (field->key && (strlen(field->key) != length ||
                                  strncmp(field->key, item.text + start, length) != 0))
                field++;
            if (!field->key)
                miss(walk, of, item.text);
            start += length + 1;
        }
    }
}

static void walk_form(table_walk *walk, const form *form, const field *of)
{
    if (form->type == FORM_LIST || form->type == FORM_NAMED)
        walk_form(walk, form->item, of);
    for (int i = 0; form->type == FORM_ANY && form->any[i]; i++)
        walk_form(walk, form->any[i], of);
    if (form->type != FORM_MAP)
        return;
    for (const form_case *one = form->cases; one && one->keys; one++)
        check_case(walk, form, one->keys, of);
    for (const field *field = form->fields; field->key; field++)
        walk_field(walk, field);
}

/*
 * Every key of the tables has a help sentence, and a dimension if its values are numbers; the
 * combinations of keys name keys of their table.
 */
static void test_tables(void **state)
{
    static const field whole = {.key = "scene"};
    table_walk walk = {0, 0, 0};
    (void)state;
    walk_form(&walk, &scene_form, &whole);
    assert_int_equal(walk.faults, 0);
    assert_true(walk.keys > 180 && walk.numbers > 100);
}

/* ---- noise ---- */

static unsigned next_random(unsigned *state, unsigned below)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state % below;
}

static size_t mutate(char *text, size_t n, unsigned *state)
{
    static const char *const tokens[] = {"{",   "]",     ": ",      ",",     "&a ",  "*a",
                                         "'",   "\n",    "  ",      "1e308", ".nan", "-1",
                                         "1/0", "nodes", "theta1-", "\xff",  "((((", "[[[["};
    const char *token = tokens[next_random(state, sizeof tokens / sizeof *tokens)];
    const size_t at = next_random(state, (unsigned)n), length = strlen(token);
    if (next_random(state, 3) == 0) {
        text[at] = (char)next_random(state, 256);
        return n;
    }
    memmove(text + at + length, text + at, n - at);
    memcpy(text + at, token, length);
    return n + length;
}

/* Whatever the text, reading ends with a scene or with one line about the file. */
static void test_noise(void **state)
{
    unsigned random = 12345;
    scene whole;
    int i;
    (void)state;
    write_lines(rich);
    expect_good(&whole, file, NULL, 0);
    scene_free(&whole);
    for (i = 0; i < MUTATIONS; i++) {
        const char *const *lines = i % 2 ? rich : base;
        char text[TEXT], error[SCENE_ERROR];
        size_t n = 0, k;
        scene scene;
        for (k = 0; k < LINES; k++)
            n += (size_t)snprintf(text + n, sizeof text - n, "%s\n", lines[k]);
        for (k = next_random(&random, 3) + 1; k > 0; k--)
            n = mutate(text, n, &random);
        write_bytes(text, n);
        if (scene_read(&scene, file, NULL, 0, error) == 0) {
            scene_free(&scene);
            continue;
        }
        assert_int_equal(strncmp(error, file, strlen(file)), 0);
        assert_null(strchr(error, '\n'));
    }
}

int main(int arguments, char **argument)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_lines),   cmocka_unit_test(test_bad_sets),
        cmocka_unit_test(test_bad_files),   cmocka_unit_test(test_shipped),
        cmocka_unit_test(test_meaning),     cmocka_unit_test(test_supports),
        cmocka_unit_test(test_changes),     cmocka_unit_test(test_nonlinear_words),
        cmocka_unit_test(test_expressions), cmocka_unit_test(test_units),
        cmocka_unit_test(test_unit_angles), cmocka_unit_test(test_bad_units),
        cmocka_unit_test(test_tables),      cmocka_unit_test(test_noise),
    };
    int descriptor = mkstemp(file), failed;
    if (descriptor < 0)
        return 1;
    close(descriptor);
    if (arguments > 1)
        scenes = argument[1];
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(file);
    return failed;
}
