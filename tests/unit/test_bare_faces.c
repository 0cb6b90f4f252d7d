/*
 * Faces of piezoelectric layers without electrode: laws and closed forms of the potentials at their
 * nodes, each on a scene run as a user runs it.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/model/bare_faces.h"
#include "../../lib/model/electrode.h"
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"
#include "../rigs/scene_assert.h"

/* Lowest and highest value of an output over its nodes. */
typedef struct value_range {
    double lowest, highest;
} value_range;

static value_range range_of(const scene_run *run, int output)
{
    value_range range = {HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < analysis_outputs(&run->analysis, output); i++) {
        const double value = analysis_output(&run->analysis, output, i, run->output);
        range.lowest = fmin(range.lowest, value);
        range.highest = fmax(range.highest, value);
    }
    return range;
}

/* ---- uniform curvature ------------------------------------------------ */

/* Changes of the scene PLATE: heat bends the plate, whose material has no pyroelectric charge. */
#define HEATED                                                                                     \
    "materials.ceramic.pyroelectric=0;materials.ceramic.d15=500e-12;outputs=[];"                   \
    "loads=[{temperature: {inner: -10, outer: 10}}];"
#define BARE_PAIR                                                                                  \
    "patches=[];sensors=[];layers.0.bare=inner;layers.1.bare=outer;"                               \
    "outputs=[{name: out, potential: upper, at: nodes}, {name: in, potential: lower, at: nodes}, " \
    "{name: w, u3: middle, at: nodes}];"
#define OPEN_PAIR                                                                                  \
    "sensors=[{name: a, drives: [{patches: up}]}, {name: b, drives: [{patches: low}]}];"           \
    "outputs=[{name: out, voltage: a}, {name: in, voltage: b}, {name: w, u3: middle, at: nodes}];"
/* A mesh of general quadrilaterals of the same plate. */
#define SKEWED                                                                                     \
    "surface={type: formula, x: theta1 + 3*theta1*theta2 - 0.12*theta1*(theta2/0.04)^2, "          \
    "y: theta2 + 2*theta1*theta2*(1 - theta2/0.04), z: 0};mesh.theta1.elements=4;"                 \
    "mesh.theta2={from: 0, to: 0.04, elements: 4};"

/*
 * Law: under a uniform curvature every node of a bare face has the potential of one open electrode
 * over the whole face, and the plate is bent alike, on any mesh and in any formulation.
 */
static void test_uniform_curvature(void **state)
{
    (void)state;
    static const char *const variants[4] = {PUBLISHED, IMPROVED, IMPROVED "dof_per_node=6;",
                                            IMPROVED SKEWED};
    for (int k = 0; k < 4; k++) {
        scene_run bare, open;
        char changes[2][1536];
        snprintf(changes[0], sizeof changes[0], "%s" HEATED BARE_PAIR, variants[k]);
        snprintf(changes[1], sizeof changes[1], "%s" HEATED OPEN_PAIR, variants[k]);
        solve_run(&bare, PLATE, changes[0]);
        solve_run(&open, PLATE, changes[1]);
        for (int output = 0; output < 2; output++) {
            const double sign = output == 0 ? 1 : -1, want = sign * scene_run_value(&open, output);
            const value_range range = range_of(&bare, output);
            assert_near("lowest potential", range.lowest, want, 1e-9);
            assert_near("highest potential", range.highest, want, 1e-9);
        }
        for (int i = 1; i < analysis_outputs(&open.analysis, 2); i++) {
            const double want = analysis_output(&open.analysis, 2, i, open.output);
            assert_true(fabs(analysis_output(&bare.analysis, 2, i, bare.output) - want) <
                        1e-9 * range_of(&open, 2).highest + 1e-9 * fabs(want));
        }
        scene_run_close(&bare);
        scene_run_close(&open);
    }
}

/* Sum of the capacitances between the potentials of two layers, each of which has one bare face. */
static double tied_capacitance(const design *design, int layer, int other)
{
    const pzs_electrodes *tables = &design->electrodes;
    const size_t nodes = (size_t)design->mesh.nodes;
    double sum = 0;
    for (int k = 0; k < tables->count; k++)
        for (uint32_t i = tables->direct.start[k]; i < tables->direct.start[k + 1]; i++) {
            const int first = tables->input[k] - design->bare.first_input,
                      second = tables->direct.dof[i] - design->bare.first_input;
            if (second >= 0 && design->bare.slot[first] / nodes == 2 * (size_t)layer &&
                design->bare.slot[second] / nodes == 2 * (size_t)other)
                sum += tables->direct.value[i];
        }
    return sum;
}

/*
 * Law: the columns of all potentials of a face add up to the column of one electrode over the face,
 * and their capacitances to those of electrodes: potentials that are tied are one open electrode.
 */
static void test_tied_potentials(void **state)
{
    (void)state;
    scene_run bare, open;
    open_run(&bare, PLATE, IMPROVED SKEWED HEATED BARE_PAIR);
    open_run(&open, PLATE, IMPROVED SKEWED HEATED OPEN_PAIR);
    const design *tied = &bare.analysis.design, *whole = &open.analysis.design;
    const pzs_rows *column = &tied->structure.input, *want = &whole->structure.input;
    const size_t dof = (size_t)tied->mesh.free_dof;
    double *sum = calloc(dof, sizeof *sum), size = 0;
    assert_non_null(sum);
    for (int k = 0; k < tied->bare.count; k++) {
        const int input = tied->bare.first_input + k;
        const bool is_outer = tied->bare.slot[k] / (size_t)tied->mesh.nodes == 2;
        for (uint32_t i = column->start[input]; i < column->start[input + 1] && is_outer; i++)
            sum[column->dof[i]] += column->value[i];
    }
    const int electrode = whole->sensor_first;
    for (uint32_t i = want->start[electrode]; i < want->start[electrode + 1]; i++) {
        sum[want->dof[i]] -= want->value[i];
        size = fmax(size, fabs(want->value[i]));
    }
    for (size_t i = 0; i < dof; i++)
        assert_true(fabs(sum[i]) < 1e-11 * size);
    for (int k = 0; k < 4; k++) {
        const uint16_t other = (uint16_t)(electrode + k % 2);
        const double sign = k / 2 == k % 2 ? 1 : -1;
        /* The first electrode lies on the upper layer, the second on the lower one. */
        assert_near("capacitance", sign * tied_capacitance(tied, 1 - k / 2, 1 - k % 2),
                    pzs_electrode_direct(&whole->electrodes, (uint32_t)(k / 2), other), 1e-11);
    }
    free(sum);
    scene_run_close(&bare);
    scene_run_close(&open);
}

/* ---- varying curvature ------------------------------------------------ */

/*
 * Amplitude of the potential of the scene bare-bimorph by beam theory, with the permittivity across
 * the poling over that along it: two equations for curvature and potential (the scene's comment).
 */
static double beam_potential(double ratio)
{
    const double young = 2e9, layer = 0.5e-3, stress = 0.046, permittivity = 1.062e-10;
    const double wave = acos(-1.0) / 0.1, inertia = pow(2 * layer, 3) / 12;
    const double along = permittivity * (1 / layer + ratio * layer * wave * wave / 3);
    const double curvature =
        10 / (wave * wave) / (young * inertia + stress * layer * stress * layer / 2 / along);
    return stress * layer * curvature / 2 / along;
}

static double computed_potential(int size, double ratio, const char *formulation)
{
    char changes[256];
    scene_run run;
    snprintf(changes, sizeof changes,
             "%smesh.theta1.elements=%d;materials.PVDF.permittivity_across=%.17g", formulation,
             size, ratio * 1.062e-10);
    solve_run(&run, "bare-bimorph", changes);
    assert_near("both faces", -scene_run_value(&run, 2), scene_run_value(&run, 1), 1e-9);
    const double value = scene_run_value(&run, 1);
    scene_run_close(&run);
    return value;
}

/*
 * Law: where the curvature varies, the potential follows from the charge of the bending strain, the
 * field across the layer and the field along the surface. The error is of second order, so that two
 * meshes extrapolate to the solution of the differential equation.
 */
static void test_varying_curvature(void **state)
{
    (void)state;
    static const double ratios[2] = {1, 1e4};
    for (int e = 0; e < 2; e++)
        for (int k = 0; k < 2; k++) {
            const double coarse = computed_potential(20, ratios[k], elements[e]),
                         fine = computed_potential(40, ratios[k], elements[e]),
                         want = beam_potential(ratios[k]);
            assert_true(fabs((coarse - want) / (fine - want) - 4) < 0.05);
            assert_near("extrapolated", (4 * fine - coarse) / 3, want, 2e-5);
        }
}

/* ---- fields along the surface ----------------------------------------- */

/* The scene PLATE as one layer without any electrode. */
#define NAKED                                                                                      \
    "patches=[];sensors=[];outputs=[{name: phi, potential: upper, face: outer, at: nodes}, "       \
    "{name: back, potential: upper, face: inner, at: nodes}, "                                     \
    "{name: end, u3: middle, at: {theta1: 0.06, theta2: 0}}, "                                     \
    "{name: pull, stress: 11, layer: upper, at: {theta1: 0.02, theta2: 0.02}}];"

/*
 * Law: a bar that is poled along its axis, insulated and pulled has the field e33 strain
 * /permittivity along its axis, and the stiffness E + e33^2/permittivity; its stress is that of the
 * forces.
 */
static void test_insulated_bar(void **state)
{
    (void)state;
    static const char *const poling[2] = {"1", "2"};
    static const double length[2] = {0.06, 0.04};
    for (int e = 0; e < 3; e++)
        for (int axis = 0; axis < 2; axis++) {
            char changes[1536];
            scene_run run;
            snprintf(changes, sizeof changes,
                     "%smaterials.ceramic={E: 60e9, nu: 0, e33: 20, permittivity: 8e-9};"
                     "layers=[{name: upper, material: ceramic, thickness: 1e-3, bare: both, "
                     "poling: 1, angle: %d}];" NAKED "loads=[{line: theta%s+, u%s: 1e5}, "
                     "{line: theta%s-, u%s: -1e5}]",
                     elements[e], 90 * axis, poling[axis], poling[axis], poling[axis],
                     poling[axis]);
            solve_run(&run, PLATE, changes);
            const double strain = 1e5 / 1e-3 / (60e9 + 20.0 * 20 / 8e-9);
            for (int face = 0; face < 2; face++) {
                const value_range range = range_of(&run, face);
                assert_near("potential along the bar", range.highest - range.lowest,
                            20 * strain / 8e-9 * length[axis], 1e-9);
            }
            assert_near("stress along the bar", scene_run_value(&run, 3), 1e5 / 1e-3, 1e-9);
            scene_run_close(&run);
        }
}

/*
 * Law: a cantilever under a transverse force that is poled across its thickness and insulated has a
 * field along its axis through e15; the shear makes it deflect less by force times length over
 * thickness times 1/G - 1/(G + e15^2/permittivity), whatever flexibility of bending the element
 * adds to its shear.
 */
static void test_insulated_shear(void **state)
{
    (void)state;
    const double shear = 30e9, e15 = 20, permittivity = 9e-9;
    for (int e = 0; e < 3; e++) {
        double end[2];
        for (int coupled = 0; coupled < 2; coupled++) {
            char changes[1536];
            scene_run run;
            snprintf(changes, sizeof changes,
                     "%smaterials.ceramic={E: 60e9, nu: 0, e15: %g, permittivity: 8e-9, "
                     "permittivity_across: 9e-9};layers=[{name: upper, material: ceramic, "
                     "thickness: 4e-3, bare: both}];" NAKED
                     "supports=[{edge: theta1-, fix: clamped}];loads=[{line: theta1+, u3: 1e5}]",
                     elements[e], coupled ? e15 : 1e-9);
            solve_run(&run, PLATE, changes);
            end[coupled] = scene_run_value(&run, 2);
            const value_range range = range_of(&run, 0);
            const double slope = 1e5 / 4e-3 / (shear + e15 * e15 / permittivity);
            if (coupled)
                assert_near("potential along the strip", range.highest - range.lowest,
                            e15 * slope / permittivity * 0.06, 1e-8);
            scene_run_close(&run);
        }
        const double want =
            1e5 * 0.06 / 4e-3 * (1 / shear - 1 / (shear + e15 * e15 / permittivity));
        assert_near("stiffening", end[0] - end[1], want, 1e-7);
    }
}

/*
 * Law: uniform heat gives an insulated pyroelectric disc that is poled along the surface a uniform
 * field along its poling, on general quadrilaterals: the potential is a linear function of the
 * place.
 */
static void test_uniform_field(void **state)
{
    (void)state;
    scene_run run;
    solve_run(&run, "tests/rigs/scenes/bare-disc.yaml", "");
    const mesh *mesh = &run.analysis.design.mesh;
    const double field = 3e-4 * 5 / (8e-9 + 20.0 * 20 / 60e9), degree = acos(-1.0) / 180;
    const double *origin = mesh->point[0].position;
    assert_int_equal(analysis_outputs(&run.analysis, 0), mesh->nodes);
    for (int node = 0; node < mesh->nodes; node++) {
        const double *place = mesh->point[node].position;
        const double along =
            cos(30 * degree) * (place[0] - origin[0]) + sin(30 * degree) * (place[1] - origin[1]);
        const double value = analysis_output(&run.analysis, 0, node, run.output) -
                             analysis_output(&run.analysis, 0, 0, run.output);
        assert_true(fabs(value + field * along) < 1e-9 * field * 0.06);
    }
    scene_run_close(&run);
}

/* ---- energy, symmetry, space ------------------------------------------ */

#define PULLED                                                                                     \
    "materials.ceramic.d15=500e-12;layers.0.poling=1;layers.0.angle=30;"                           \
    "loads=[{line: theta1+, u3: 30}, {line: theta2+, u1: 1e4, on: outer}];"                        \
    "supports=[{edge: theta1-, fix: clamped}];"

#define TWO_BARE "patches=[];sensors=[];layers.0.bare=both;layers.1.bare=both;outputs=[];"
/* An open electrode on the lower layer, beside the bare face of the upper one. */
#define ONE_BARE                                                                                   \
    "patches=[{name: low, layer: lower}];sensors=[{name: s, drives: [{patches: low}]}];"           \
    "layers.1.bare=outer;outputs=[];"

/* Work of the loads on a displacement, halved. */
static double work_of(const scene_run *run)
{
    const design *design = &run->analysis.design;
    const pzs_rows *input = &design->structure.input;
    double work = 0;
    for (int j = design->amplifiers; j < design->amplifiers + design->loads; j++)
        for (uint32_t i = input->start[j]; i < input->start[j + 1]; i++)
            work += input->value[i] * run->u[input->dof[i]] / 2;
    return work;
}

static double elastic_energy(const scene_run *run)
{
    const pzs_structure *structure = &run->analysis.design.structure;
    double sum = 0;
    for (uint32_t e = 0; e < structure->elements; e++) {
        double own[SHELL_MAX], force[SHELL_MAX];
        pzs_model_gather(&run->analysis.model, structure->element[e], SHELL_NODES, run->u, own);
        pzs_shell_force(&structure->type[structure->element_type[e]], structure->dof_per_node, own,
                        force);
        for (unsigned i = 0; i < 4u * structure->dof_per_node; i++)
            sum += own[i] * force[i] / 2;
    }
    return sum;
}

static double electric_energy(const scene_run *run)
{
    const pzs_electrodes *tables = &run->analysis.design.electrodes;
    const double *value = run->analysis.input_value;
    double sum = 0;
    for (uint32_t k = 0; k < tables->count; k++)
        for (uint32_t i = tables->direct.start[k]; i < tables->direct.start[k + 1]; i++)
            sum += value[tables->input[k]] * tables->direct.value[i] *
                   value[tables->direct.dof[i]] / 2;
    return sum;
}

/*
 * Law: the work of the loads is the elastic and the electric energy, no charge comes to a bare
 * face, and the charge of each potential per volt of another is that of the other per volt of the
 * first.
 */
static void test_energy_and_symmetry(void **state)
{
    (void)state;
    static const char *const variants[4] = {PUBLISHED PULLED TWO_BARE, IMPROVED PULLED TWO_BARE,
                                            IMPROVED SKEWED PULLED TWO_BARE,
                                            IMPROVED PULLED ONE_BARE};
    for (int k = 0; k < 4; k++) {
        scene_run run;
        solve_run(&run, PLATE, variants[k]);
        const pzs_electrodes *tables = &run.analysis.design.electrodes;
        const size_t inputs = run.analysis.design.structure.input.count;
        const double *charge = run.analysis.electric.state.sensitivity;
        assert_true(electric_energy(&run) > 1e-3 * work_of(&run));
        assert_near("energy", elastic_energy(&run) + electric_energy(&run), work_of(&run), 1e-10);
        for (size_t i = 0; i < tables->count; i++)
            for (size_t j = 0; j < i; j++)
                assert_true(fabs(charge[i * inputs + tables->input[j]] -
                                 charge[j * inputs + tables->input[i]]) <
                            1e-10 * fabs(charge[i * inputs + tables->input[i]]));
        for (size_t i = 0; i < tables->count; i++)
            assert_true(fabs(run.analysis.charge[i]) <
                        1e-9 * charge[i * inputs + tables->input[i]] *
                                fabs(run.analysis.input_value[tables->input[i]]) +
                            1e-18);
        scene_run_close(&run);
    }
}

/* Law: a structure that is turned in space has the same potentials and normal displacements. */
static void test_turned_in_space(void **state)
{
    (void)state;
    scene_run run[2];
    static const char *const surface[2] = {
        "surface={type: formula, x: theta1, y: theta2, z: 2*theta1^2};",
        "surface={type: formula, x: 0.6*theta1 - 0.8*2*theta1^2, y: 0.28*theta2 + 0.96*(0.8*theta1 "
        "+ 0.6*2*theta1^2), z: -0.96*theta2 + 0.28*(0.8*theta1 + 0.6*2*theta1^2)};"};
    for (int k = 0; k < 2; k++)
        solve_run(&run[k], PLATE, with(surface[k], PULLED BARE_PAIR));
    for (int output = 0; output < 3; output++) {
        const value_range range = range_of(&run[0], output);
        for (int i = 0; i < analysis_outputs(&run[0].analysis, output); i++)
            assert_true(fabs(analysis_output(&run[0].analysis, output, i, run[0].output) -
                             analysis_output(&run[1].analysis, output, i, run[1].output)) <
                        1e-8 * (range.highest - range.lowest));
    }
    scene_run_close(&run[0]);
    scene_run_close(&run[1]);
}

/* ---- large rotation --------------------------------------------------- */

#define ROLLED                                                                                     \
    "materials.PVDF.alpha=1e-4;mesh.theta1.elements=10;equilibrium={tolerance: 1e-10};"            \
    "supports=[{edge: theta1-, fix: clamped}];loads=[{temperature: {inner: -75, outer: 75}}];"

/*
 * Law: heat that is linear through the thickness rolls a strip up; its potential is uniform at any
 * rotation and that of the undeformed strip (to the square of the strain at its faces), and no
 * charge comes to a bare face in equilibrium.
 */
static void test_rolled_strip(void **state)
{
    (void)state;
    scene_run flat, rolled;
    solve_run(&flat, "bare-bimorph", ROLLED);
    solve_run(&rolled, "bare-bimorph", ROLLED "kinematics=nonlinear");
    const value_range range = range_of(&rolled, 3);
    assert_near("uniform", range.lowest, range.highest, 1e-8);
    assert_near("as in the undeformed strip", range.highest, range_of(&flat, 3).highest, 1e-3);
    const pzs_electrodes *tables = &rolled.analysis.design.electrodes;
    const double whole = 1.062e-10 / 0.5e-3 * 0.1 * 0.005 * range.highest;
    for (int k = 0; k < tables->count; k++)
        assert_true(fabs(rolled.analysis.charge[k]) < 1e-9 * whole);
    assert_true(fabs(scene_run_value(&flat, 0)) < 1e-12);
    assert_true(rolled.analysis.equilibrium.solver.info.negative_pivots == 0);
    scene_run_close(&flat);
    scene_run_close(&rolled);
}

/* ---- refusals --------------------------------------------------------- */

static void test_refusals(void **state)
{
    (void)state;
    static const refusal bad[] = {
        {"layers.0.bare=outside", "outside"},
        {"materials.PVDF.permittivity=0", "has no permittivity"},
        {"materials.PVDF.e31=0", "no"},
        {"layers.0.bare=outer", "let 'bare' of both agree"},
        {"outputs.0={name: a, potential: upper, at: nodes, face: inner}", "is not bare"},
        {"outputs.0={name: a, potential: none, at: nodes}", "there is no layer"},
        {"outputs.0={name: a, potential: upper, at: nodes, angle: 45}",
         "'angle' belongs to a strain or stress"},
        {"outputs.0={name: a, potential: upper, at: nodes, reference: 3 mm}",
         "expected that of a voltage"},
        {"layers.0={name: lower, material: PVDF, thickness: 0.5e-3, poling: 1, finger_distance: "
         "1e-3, bare: inner}",
         "interdigitated"},
    };
    assert_refused("bare-bimorph", bad, 2);
    assert_refused("bare-bimorph", bad + 3, 6);
    scene_run run;
    assert_true(scene_run_open(&run, "bare-bimorph",
                               "patches=[{name: p, layer: upper}];actuators=[{name: v, drives: "
                               "[{patches: p}]}]") < 0);
    assert_non_null(strstr(run.error, "has a bare face"));
    scene_run_close(&run);
    assert_true(scene_run_open(&run, "bare-bimorph", "mesh.theta1.elements=600") < 0);
    assert_non_null(strstr(run.error, "at most 2000"));
    scene_run_close(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uniform_curvature),   cmocka_unit_test(test_tied_potentials),
        cmocka_unit_test(test_varying_curvature),   cmocka_unit_test(test_insulated_bar),
        cmocka_unit_test(test_insulated_shear),     cmocka_unit_test(test_uniform_field),
        cmocka_unit_test(test_energy_and_symmetry), cmocka_unit_test(test_turned_in_space),
        cmocka_unit_test(test_rolled_strip),        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
