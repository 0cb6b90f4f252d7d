/* SPDX-License-Identifier: BSD-2-Clause */
/* Stresses and strains recovered from displacements (host_tools/model/stress.h). */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../host_tools/mesh/laminate_shear.h"
#include "../../host_tools/model/estimator.h"
#include "../../host_tools/model/strain.h"
#include "../../host_tools/model/stress.h"
#include "../../host_tools/model/stress_equilibrium.h"
#include "../../host_tools/model/stress_output.h"
#include "../../host_tools/model/stress_points.h"
#include "../../host_tools/model/stress_summary.h"
#include "../rigs/scene_assert.h"
#include "../rigs/testdata.h"

static const double pi = 3.14159265358979323846;

/* Stresses of the displacement of a run, without its correction. */
static stress_field recovered(const scene_run *run)
{
    const stress_state state = {&run->analysis.design, run->u, run->analysis.input_value,
                                run->analysis.is_nonlinear};
    stress_field field;
    assert_int_equal(stress_recover(&field, &state), 0);
    return field;
}

static void close_both(stress_field *field, scene_run *run)
{
    stress_free(field);
    scene_run_close(run);
}

/*
 * Solve a scene with changes, and recover its stresses as a user does, with linear kinematics from
 * a corrected displacement; close_both releases both.
 */
static stress_field solved(scene_run *run, const char *name, const char *changes)
{
    stress_field field;
    solve_run(run, name, changes);
    assert_int_equal(analysis_stresses(&run->analysis, run->u, &field), 0);
    return field;
}

/* Largest difference of the in-plane components 11, 22, 12 from the expected ones. */
static double in_plane(const double *found, const double *wanted)
{
    return fmax(fmax(fabs(found[0] - wanted[0]), fabs(found[1] - wanted[1])),
                fabs(found[5] - wanted[5]));
}

static const stress_sample *samples_of(const stress_field *field, int element)
{
    return field->sample + (size_t)element * (size_t)field->layers * STRESS_HEIGHTS;
}

/* ---- constant states ---------------------------------------------------------- */

/*
 * Impose the displacement of constant strains and curvatures on a flat plate whose dof are all
 * free: strains 11 22 12 (engineering), curvatures 11 22 12 (of the tensor), strain 33.
 */
static void impose(scene_run *run, const double state[7])
{
    const mesh *mesh = &run->analysis.design.mesh;
    free(run->u);
    run->u = calloc((size_t)mesh->nodes * mesh->dof_per_node, sizeof *run->u);
    assert_non_null(run->u);
    for (int node = 0; node < mesh->nodes; node++) {
        const double x = mesh->point[node].position[0], y = mesh->point[node].position[1];
        const double value[6] = {
            state[0] * x + state[2] * y,
            state[1] * y,
            -(state[3] * x * x + state[4] * y * y) / 2 - state[5] * x * y,
            state[3] * x + state[5] * y,
            state[4] * y + state[5] * x,
            state[6],
        };
        for (unsigned i = 0; i < mesh->dof_per_node; i++) {
            const size_t dof = (size_t)node * mesh->dof_per_node + i;
            mesh->node_dof[dof] = (uint16_t)dof;
            for (int k = 0; k < 3 && i < 6; k++)
                run->u[dof] += mesh->point[node].triad[i % 3][k] * value[3 * (i / 3) + (unsigned)k];
        }
    }
}

/*
 * Compare one layer of an isotropic plate with the imposed state; the normal stress that all plies
 * share gives the strain 33. Angles count from the axis x.
 */
static void check_layer(const stress_field *field, int element, int layer, const double imposed[7])
{
    const double nu = 0.3, e = 60e9, bulk = e / ((1 + nu) * (1 - 2 * nu));
    const double *axis = field->element[element].axis[0];
    const double s = field->element[element].normal_stress;
    const double angle =
        field->state.design->scene->layer[layer].angle * pi / 180 + atan2(axis[1], axis[0]);
    stress_layer found;
    stress_layer_of(field, element, layer, &found);
    for (int height = 0; height < STRESS_HEIGHTS; height++) {
        const double z = stress_height(field, layer, height);
        double strain[6] = {imposed[0] + z * imposed[3],    imposed[1] + z * imposed[4], 0, 0, 0,
                            imposed[2] + 2 * z * imposed[5]};
        double stress[6] = {0}, turned[6];
        strain[2] = s / (bulk * (1 - nu)) - nu / (1 - nu) * (strain[0] + strain[1]);
        for (int i = 0; i < 3; i++)
            stress[i] = bulk * nu * (strain[0] + strain[1] + strain[2]) + e / (1 + nu) * strain[i];
        stress[5] = e / (2 * (1 + nu)) * strain[5];
        strain_turn(strain, angle, turned);
        assert_true(in_plane(found.at[height].strain, turned) < 1e-14);
        assert_true(fabs(found.at[height].strain[2] - turned[2]) < 1e-14);
        strain_turn_stress(stress, angle, turned);
        assert_true(in_plane(found.at[height].stress, turned) < 1e-14 * e);
    }
}

/*
 * Law: constant membrane strains and curvatures, of a size of 1e-3, are recovered to rounding at
 * every height of every ply, on regular and on skewed meshes, and the stresses are those of Hooke's
 * law in the axes of the plies.
 */
static void test_patch(void **state)
{
    (void)state;
    static const char *const meshes[2] = {
        "", "surface={type: formula, x: theta1*(1+5*theta2)+0.3*theta2, y: theta2*(1+2*theta1), "
            "z: 0};"};
    static const double imposed[7] = {3e-4, -2e-4, 5e-4, 0.02, -0.03, 0.01, 1e-4};
    for (int k = 0; k < 2; k++) {
        scene_run run;
        open_run(&run, PLATE,
                 with(meshes[k], "sensors=[];outputs=[];layers=[{name: lower, material: ceramic, "
                                 "thickness: 1e-3}, {name: upper, material: ceramic, thickness: "
                                 "2e-3, angle: 30}]"));
        impose(&run, imposed);
        stress_field field = recovered(&run);
        for (int i = 0; i < 2 * field.elements; i++)
            check_layer(&field, i / 2, i % 2, imposed);
        close_both(&field, &run);
    }
}

/*
 * Law: a free laminate under a uniform tension has the ply stresses of classical lamination, here
 * with plies that couple tension, bending and twist.
 */
static void test_tension(void **state)
{
    (void)state;
    scene_run run;
    stress_field field =
        solved(&run, "tests/rigs/scenes/patch.yaml",
               IMPROVED "materials={m: {E: 2, nu: 0.3}, c: {E1: 20, E2: 1, G12: 0.6, nu12: 0.3}};"
                        "layers=[{material: m, thickness: 0.02}, {material: c, thickness: 0.01, "
                        "angle: 30}, {material: c, thickness: 0.015, angle: -70}]");
    const laminate *laminate = &run.analysis.design.mesh.laminate;
    shear_ply ply[3];
    double flex[6][6];
    for (int i = 0; i < 3; i++) {
        memcpy(ply[i].z, laminate->ply[i].z, sizeof ply[i].z);
        ply[i].c = laminate->ply[i].c;
    }
    assert_int_equal(laminate_flexure(ply, 3, flex), 0);
    for (int element = 0; element < field.elements; element++)
        for (int i = 0; i < 3 * STRESS_HEIGHTS; i++) {
            const double z = stress_height(&field, i / 3, i % 3);
            double wanted[6], strain[6] = {0};
            stress_layer found;
            for (int k = 0; k < 3; k++)
                strain[k == 2 ? 5 : k] = 0.7 * (flex[k][0] + z * flex[3 + k][0]);
            stress_layer_of(&field, element, i / 3, &found);
            strain_turn(strain, run.scene.layer[i / 3].angle * pi / 180, wanted);
            assert_true(in_plane(found.at[i % 3].strain, wanted) < 1e-10);
            assert_true(fabs(found.at[i % 3].stress[2]) < 1e-10);
        }
    close_both(&field, &run);
}

/* ---- piezoelectric strains ------------------------------------------------------ */

/*
 * Law: a free homogeneous plate between two electrodes has the strains d E, with d the
 * piezoelectric constants and E the electric field, and no stress. The tolerance is 100 times the
 * residual of the solver, 1e-12 of the stress of a clamped plate.
 */
static void test_free_piezo(void **state)
{
    (void)state;
    scene_run run;
    stress_field field = solved(&run, "tests/rigs/scenes/free-bimorph.yaml",
                                IMPROVED "layers.0.poling=3;materials.piezo.d33=-33e-12");
    const double electric = -1 / 0.5e-3, size = 2e9 * 23e-12 * fabs(electric);
    for (int i = 0; i < 2 * field.elements; i++) {
        stress_layer found;
        stress_layer_of(&field, i / 2, i % 2, &found);
        for (int height = 0; height < STRESS_HEIGHTS; height++) {
            assert_near("strain 11", found.at[height].strain[0], 23e-12 * electric, 1e-10);
            assert_near("strain 33", found.at[height].strain[2], -33e-12 * electric, 1e-10);
            for (int k = 0; k < STRESS_COMPONENTS; k++)
                assert_true(fabs(found.at[height].stress[k]) < 1e-10 * size);
        }
        assert_near("field", found.field, electric, 1e-14);
    }
    close_both(&field, &run);
}

/*
 * Law: a free bimorph of plies of thickness t bends with the curvature 3 d V/(4 t^2), and its
 * stress is E/(1 - nu) (z times curvature - free strain): classical lamination, exact.
 */
static void test_bimorph(void **state)
{
    (void)state;
    scene_run run;
    stress_field field = solved(&run, "tests/rigs/scenes/free-bimorph.yaml", IMPROVED);
    const double t = 0.5e-3, d = 23e-12, modulus = 2e9 / 0.7;
    const double curvature = -3 * d * 2 / (4 * t * t);
    for (int i = 0; i < 6 * field.elements; i++) {
        const int layer = i / 3 % 2, height = i % 3;
        const double free_strain = d * (layer ? -1 : 1) / t;
        const double wanted =
            modulus * (stress_height(&field, layer, height) * curvature - free_strain);
        stress_layer found;
        stress_layer_of(&field, i / 6, layer, &found);
        assert_true(fabs(found.at[height].stress[0] - wanted) < 1e-9 * modulus * d / t);
        assert_true(fabs(found.at[height].stress[1] - wanted) < 1e-9 * modulus * d / t);
    }
    close_both(&field, &run);
}

/*
 * Law: the electric displacement integrates to the charge that the library computes, under forces,
 * temperature and voltages; both come from the same strains.
 */
static void test_charge(void **state)
{
    (void)state;
    static const char *const circuits[2] = {"open", "short"};
    for (int k = 0; k < 2; k++) {
        char changes[300];
        scene_run run;
        double charge = 0;
        snprintf(changes, sizeof changes,
                 IMPROVED "sensors.s.circuit=%s;loads=[{line: theta1+, u1: 300}, {line: theta1-, "
                          "u1: -300}, {line: theta1+, u3: 0.4}, {line: theta1-, u3: -0.4}, "
                          "{temperature: 3}]",
                 circuits[k]);
        snprintf(changes + strlen(changes), sizeof changes - strlen(changes), ";supports.0.fix=%s",
                 "clamped");
        stress_field field = solved(&run, PLATE, changes);
        double size = 0;
        for (int element = 0; element < field.elements; element++) {
            const mesh *mesh = &run.analysis.design.mesh;
            stress_layer found;
            stress_layer_of(&field, element, 1, &found);
            charge -= found.displacement * mesh->place[mesh->element_type[element]].area;
            size += fabs(found.displacement) * mesh->place[mesh->element_type[element]].area;
        }
        assert_true(size > 0);
        const double wanted = run.analysis.charge[0];
        if (fabs(charge - wanted) > 1e-10 * fmax(size, fabs(wanted)))
            fail_msg("%s: charge %.15g, should be %.15g", circuits[k], charge, wanted);
        close_both(&field, &run);
    }
}

/* ---- equilibrium ------------------------------------------------------------------ */

/*
 * Law: the stresses of the samples, integrated over the thickness (exactly, as they are quadratic
 * in each ply of a flat plate), are the resultants of the element, and the shears vanish on both
 * faces: angle plies on a skewed mesh, with patches on a part of it.
 */
static void test_resultants(void **state)
{
    (void)state;
    scene_run run;
    stress_field field = solved(
        &run, PLATE,
        IMPROVED "surface={type: formula, x: theta1*(1+5*theta2)+0.3*theta2, y: "
                 "theta2*(1+2*theta1), z: 0};supports.0.fix=clamped;materials.c={E1: 130e9, E2: "
                 "9e9, G12: 5e9, nu12: 0.3};layers=[{name: lower, material: c, thickness: 1e-3, "
                 "angle: 20}, {name: mid, material: c, thickness: 1e-3, angle: -50}, {name: upper, "
                 "material: ceramic, thickness: 0.5e-3, patched: true}];patches=[{name: up, layer: "
                 "upper, theta1: [0, 0.02]}];loads=[{face: outer, pressure: 1000*(1+20*x)}]");
    for (int element = 0; element < field.elements; element++) {
        double sum[STRESS_RESULTANTS] = {0}, wanted[STRESS_RESULTANTS], size[3] = {0, 0, 0};
        const stress_sample *sample = samples_of(&field, element);
        stress_resultants(&field, element, wanted);
        const laminate *laminate = &run.analysis.design.mesh.laminate;
        for (int i = 0; i < field.layers * STRESS_HEIGHTS; i++) {
            const double *z = laminate->ply[i / 3].z;
            const double weight = (z[1] - z[0]) * (i % 3 == 1 ? 4 : 1) / 6;
            const double height =
                stress_height(&field, i / 3, i % 3) - (laminate->z[0] + laminate->z[1]) / 2;
            for (int k = 0; k < 3; k++) {
                sum[k] += weight * sample[i].plane[k];
                sum[3 + k] += weight * height * sample[i].plane[k];
            }
            for (int k = 0; k < 2; k++)
                sum[6 + k] += weight * sample[i].shear[k];
        }
        for (int k = 0; k < STRESS_RESULTANTS; k++)
            size[k / 3] = fmax(size[k / 3], fabs(wanted[k]));
        for (int k = 0; k < STRESS_RESULTANTS; k++)
            if (fabs(sum[k] - wanted[k]) > 1e-9 * fmax(size[k / 3], size[1] / laminate->thickness))
                fail_msg("element %d, resultant %d: %.12g, should be %.12g", element, k, sum[k],
                         wanted[k]);
        const int last = stress_is_present(&field, element, 2) ? 8 : 5;
        for (int k = 0; k < 2; k++) {
            assert_true(fabs(sample[0].shear[k]) < 1e-9 * size[2] / laminate->thickness);
            assert_true(fabs(sample[last].shear[k]) < 1e-9 * size[2] / laminate->thickness);
        }
    }
    close_both(&field, &run);
}

/*
 * Law: a rotation of 0.6 of a whole shell has no Green-Lagrange strains; the equilibrium is settled
 * to 1e-9 of the displacement, which is 0.6 times the radius, over a thickness of 1/100 of it.
 */
static void test_rotation(void **state)
{
    (void)state;
    scene_run run;
    stress_summary summary;
    stress_field field = solved(&run, "tests/rigs/scenes/rigid.yaml", IMPROVED);
    assert_true(field.state.is_nonlinear);
    stress_summarise(&field, &summary);
    for (int i = 0; i < STRESS_COMPONENTS; i++)
        assert_true(fabs(summary.strain[i].value) < 1e-9);
    close_both(&field, &run);
}

/* ---- against three-dimensional elasticity ------------------------------------------- */

/*
 * Errors of recovered stresses 11 22 12 13 23 33 inside a mesh (elements at its edges, whose
 * gradients are one-sided, are left out), over the largest exact value of the component.
 */
typedef enum wave_shape { STRIP, SQUARE, CYLINDER } wave_shape;

typedef struct wave {
    wave_shape shape;
    double side;         /* span or radius over height */
    int count;           /* number of components: 4 of a strip (11 22 13 33), else 6 */
    int rows;            /* number of heights */
    const double *exact; /* [rows][count] */
    double error[6];
} wave;

/* Values of the components at one sample, and the waves along the surface with which they vary. */
static void wave_values(const wave *wave, const stress_field *field, int element,
                        const stress_sample *sample, double found[6], double shape[6])
{
    const double *place = field->element[element].place;
    if (wave->shape == STRIP) {
        const double s = sin(pi * place[0]), c = cos(pi * place[0]);
        const double strip[4] = {sample->plane[0], sample->plane[1], sample->shear[0],
                                 sample->normal},
                     along[4] = {s, s, c, s};
        memcpy(found, strip, sizeof strip);
        memcpy(shape, along, sizeof along);
        return;
    }
    const bool is_flat = wave->shape == SQUARE;
    const double x = place[0] * pi / (is_flat ? 1 : 4);
    const double y = is_flat ? pi * (place[1] - 0.5) : -4 * atan2(place[2], place[1]);
    const double turn = is_flat ? -1 : 1; /* cos(pi y) = -sin(pi (y - 1/2)) */
    const double all[6] = {sample->plane[0], sample->plane[1], sample->plane[2],
                           sample->shear[0], sample->shear[1], sample->normal},
                 along[6] = {sin(x) * cos(y), sin(x) * cos(y),        turn * cos(x) * sin(y),
                             cos(x) * cos(y), turn * sin(x) * sin(y), sin(x) * cos(y)};
    memcpy(found, all, sizeof all);
    memcpy(shape, along, sizeof along);
}

static void compare_wave(wave *wave, const stress_field *field)
{
    const scene_line *line = field->state.design->scene->line;
    double largest[6] = {0};
    memset(wave->error, 0, sizeof wave->error);
    for (int i = 0; i < wave->rows * wave->count; i++)
        largest[i % wave->count] = fmax(largest[i % wave->count], fabs(wave->exact[i]));
    for (int element = 0; element < field->elements; element++) {
        const int i = element / line[1].elements, j = element % line[1].elements;
        const int is_edge = i == 0 || i == line[0].elements - 1 ||
                            (wave->shape != STRIP && (j == 0 || j == line[1].elements - 1));
        for (int row = 0; row < wave->rows && !is_edge; row++) {
            double found[6], shape[6];
            wave_values(wave, field, element, &samples_of(field, element)[row], found, shape);
            for (int k = 0; k < wave->count; k++)
                wave->error[k] = fmax(
                    wave->error[k],
                    fabs(found[k] - shape[k] * wave->exact[row * wave->count + k]) / largest[k]);
        }
    }
}

/* Layers of a scene: two isotropic ones of equal thickness, or three plies at the given angles. */
static int put_layers(char *text, size_t size, const char *plies, double height)
{
    const int outer = strcmp(plies, "around") == 0 ? 90 : 0;
    if (strcmp(plies, "isotropic") == 0)
        return snprintf(text, size,
                        "materials.m={E: 1, nu: 0.3};layers=[{material: m, thickness: %.17g}, "
                        "{material: m, thickness: %.17g}];",
                        height / 2, height / 2);
    return snprintf(text, size,
                    "layers=[{material: graphite/epoxy, thickness: %.17g, angle: %d}, {material: "
                    "graphite/epoxy, thickness: %.17g, angle: %d}, {material: graphite/epoxy, "
                    "thickness: %.17g, angle: %d}];",
                    height / 3, outer, height / 3, 90 - outer, height / 3, outer);
}

/*
 * Solve the strip or cylinder of a wave, 32 elements along the strip or 16 x 16 of the cylinder.
 *   element in  description of the element
 */
static stress_field solve_wave(const wave *wave, const char *plies, const char *element,
                               scene_run *run)
{
    char changes[900];
    static const char *const scene[3] = {"tests/rigs/scenes/sine-strip.yaml", "crossply",
                                         "varadan-cylinder"};
    const int used = put_layers(changes, sizeof changes, plies, 1 / wave->side);
    snprintf(changes + used, sizeof changes - (size_t)used, "element=%s;%s", element,
             wave->shape != CYLINDER ? ""
                                     : "loads=[{face: inner, pressure: "
                                       "sin(pi*theta1/4)*cos(4*theta2), area: true}]");
    return solved(run, scene[wave->shape], changes);
}

/* Elements with both shear stiffnesses. */
static const char *const both_shears[2] = {"improved", "{shear: equilibrium}"};

static wave_shape shape_of(const char *name)
{
    if (strncmp(name, "strip", 5) == 0)
        return STRIP;
    return strncmp(name, "plate", 5) == 0 ? SQUARE : CYLINDER;
}

static void check_wave(const testdata *t, const char *element, const double fourth[6])
{
    const testdata_array *stress = testdata_find(t, "stress");
    wave wave = {.shape = shape_of(t->name),
                 .side = testdata_values(t, "side")[0],
                 .count = stress->columns,
                 .rows = stress->rows,
                 .exact = stress->value};
    scene_run run;
    stress_field field = solve_wave(&wave, testdata_word(t, "plies"), element, &run);
    compare_wave(&wave, &field);
    print_message("%-24s", t->name);
    for (int k = 0; k < wave.count; k++)
        print_message(" %7.4f", wave.error[k]);
    print_message("\n");
    for (int i = 0; i < wave.count; i++) {
        const bool is_normal = i == wave.count - 1, is_plane = i < wave.count / 2;
        const double law = (is_normal ? 0.08 : 0.006) + fourth[i] / pow(wave.side, 4);
        const double wanted = is_plane ? 0.02 : 0.03;
        if (wave.error[i] > (wave.side == 10 ? fmin(law, wanted) : law))
            fail_msg("%s, element %s: component %d is off by %g", t->name, element, i,
                     wave.error[i]);
    }
    close_both(&field, &run);
}

/*
 * Law: the recovered stresses approach three-dimensional elasticity with the fourth power of the
 * thickness over the span or the radius, whatever the shear stiffness of the elements. The bounds
 * are coefficients of this power, and 0.6 % for the mesh; at a span or radius of ten thicknesses
 * in-plane stresses are within 2 %, transverse ones within 3 %. The stress 33 of a thin cylinder is
 * the difference of two terms that are larger by the radius over the thickness; the mesh leaves 8 %
 * of it. The strong plies have a ratio of 50 of the modulus to the transverse shear modulus, the
 * isotropic ones of 2.6.
 */
static void test_exact(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double fourth[6];
    } law[7] = {
        {"strip-isotropic", {0.5, 0.5, 0.5, 0.5}},
        {"strip-cross", {12, 6, 35, 10}},
        {"plate-isotropic", {1, 1, 1, 1, 1, 1}},
        {"plate-cross", {28, 25, 16, 36, 10, 10}},
        {"cylinder-isotropic", {1, 1, 1, 1, 1, 1}},
        {"cylinder-around", {45, 145, 75, 60, 75, 40}},
        {"cylinder-cross", {45, 145, 75, 60, 75, 40}},
    };
    FILE *file = fopen("tests/oracle/data/stress.txt", "r");
    testdata t;
    int cases = 0;
    assert_non_null(file);
    for (; testdata_next(file, &t); cases++) {
        for (int i = 0; i < 7 * 2; i++)
            if (strncmp(t.name, law[i / 2].name, strlen(law[i / 2].name)) == 0)
                check_wave(&t, both_shears[i % 2], law[i / 2].fourth);
        testdata_free(&t);
    }
    fclose(file);
    assert_int_equal(cases, 28);
}

/*
 * Compare the deflection of one cylinder with the exact solution of the first-order theory, and the
 * estimated error of this theory with the true one.
 *   shear in  index of both_shears
 */
static void check_theory(const testdata *t, int shear)
{
    const double *deflection = testdata_values(t, "deflection"),
                 side = testdata_values(t, "side")[0];
    const wave wave = {.shape = CYLINDER, .side = side, .count = 6};
    scene_run run;
    plausible warnings = {.count = 0};
    stress_field field = solve_wave(&wave, testdata_word(t, "plies"), both_shears[shear], &run);
    const double ratio = scene_run_value(&run, 0) / deflection[1 + shear];
    const double error = fabs(deflection[0] / deflection[1 + shear] - 1);
    print_message("%-24s %.4f of the theory, which is off by %.4f; estimated %.4f\n", t->name,
                  ratio, error, field.theory_error);
    plausible_stress(&warnings, &field);
    const int is_known = !field.is_straight;
    const char *rule = warnings.count > 0 ? warnings.warning[0].rule : "";
    assert_true(fabs(ratio - 1) < 0.003);
    assert_int_equal(is_known, side > 4 || strcmp(testdata_word(t, "plies"), "around") != 0);
    if (is_known && fabs(field.theory_error - error) > 2e-4 + 0.5 / (side * side) + error * error)
        fail_msg("%s: the estimated error of the theory is %g", t->name, field.theory_error);
    if (is_known)
        assert_string_equal(rule, field.theory_error > 0.02 ? "shell_theory" : "");
    else
        assert_string_equal(rule, "bent_sections");
    close_both(&field, &run);
}

/*
 * Law: the elements converge to the exact solution of the first-order theory with their shear
 * stiffness, to 0.3 % on the mesh, and the correction of the displacement estimates by how much
 * this theory errs against three-dimensional elasticity: to the square of the error, to the square
 * of the thickness over the radius, with which the exact displacement varies over the thickness,
 * and 0.02 % for the mesh. An error above 2 % causes a warning; so do stresses of bent
 * cross-sections that do not converge, with which the error is unknown.
 */
static void test_theory(void **state)
{
    (void)state;
    FILE *file = fopen("tests/oracle/data/stress.txt", "r");
    testdata t;
    int cases = 0;
    assert_non_null(file);
    while (testdata_next(file, &t)) {
        for (int shear = 0; shear < 2 && testdata_find(&t, "deflection"); shear++, cases++)
            check_theory(&t, shear);
        testdata_free(&t);
    }
    fclose(file);
    assert_int_equal(cases, 24);
}

/* Element of a field whose centre is nearest to the point x, y of a plate. */
static int element_at(const stress_field *field, double x, double y)
{
    int nearest = 0;
    double least = HUGE_VAL;
    for (int element = 0; element < field->elements; element++) {
        const double *place = field->element[element].place;
        const double away = hypot(place[0] - x, place[1] - y);
        nearest = away < least ? element : nearest;
        least = fmin(least, away);
    }
    return nearest;
}

/*
 * Law: the stresses of a laminate and the error of the theory do not depend on whether the mesh
 * follows lines of curvature: a plate of ten thicknesses, of which the soft middle makes the theory
 * wrong by more than a tenth, on straight and on bent mesh lines, to 1 % of the largest stress.
 */
static void test_bent_mesh(void **state)
{
    (void)state;
    static const char *const surfaces[2] = {
        "", "surface={type: formula, x: theta1+0.02*sin(2*pi*theta1)*sin(2*pi*theta2), y: "
            "theta2-0.015*sin(2*pi*theta1)*sin(2*pi*theta2), z: 0};"};
    static const char plies[] =
        "element=improved;materials={hard: {E: 8, nu: 0.3}, soft: {E: 1, nu: 0.3}};layers=["
        "{material: hard, thickness: 0.02}, {material: soft, thickness: 0.06}, {material: hard, "
        "thickness: 0.02}]";
    stress_field field[2];
    scene_run run[2];
    for (int k = 0; k < 2; k++)
        field[k] = solved(&run[k], "crossply", with(surfaces[k], plies));
    assert_true(run[1].analysis.design.mesh.place[0].is_general);
    assert_near("error of the theory", field[1].theory_error, field[0].theory_error, 0.02);
    assert_true(field[0].theory_error > 0.1);
    for (int i = 0; i < 3 * STRESS_HEIGHTS; i++) {
        const stress_sample *centre[2], *edge[2];
        for (int k = 0; k < 2; k++) {
            centre[k] = &samples_of(&field[k], element_at(&field[k], 0.49, 0.49))[i];
            edge[k] = &samples_of(&field[k], element_at(&field[k], 0.01, 0.49))[i];
        }
        assert_true(fabs(centre[1]->plane[0] - centre[0]->plane[0]) < 0.01 * 25.58);
        assert_true(fabs(centre[1]->normal - centre[0]->normal) < 0.01);
        assert_true(fabs(edge[1]->shear[0] - edge[0]->shear[0]) < 0.01 * 1.99);
    }
    for (int k = 0; k < 2; k++)
        close_both(&field[k], &run[k]);
}

/*
 * Law: without correction, stresses are not lost. The displacement of a sandwich with uniform shear
 * strain, which is far too stiff, is not corrected, and a warning says so; with a shear stiffness
 * from equilibrium the error of the theory is small.
 */
static void test_sandwich(void **state)
{
    (void)state;
    for (int shear = 0; shear < 2; shear++) {
        char changes[60];
        scene_run run;
        plausible warnings = {.count = 0};
        snprintf(changes, sizeof changes, "element=%s", both_shears[shear]);
        stress_field field = solved(&run, "tests/bench/error_scenes/sandwich.yaml", changes);
        plausible_stress(&warnings, &field);
        assert_int_equal(field.correction.displacement != NULL, shear == 1);
        assert_int_equal(warnings.count, shear == 0);
        if (shear == 0)
            assert_non_null(strstr(warnings.warning[0].text, "neither displacement nor stresses"));
        close_both(&field, &run);
    }
}

/*
 * Law: the stresses of a square [0/90/0] plate under a sinusoidal pressure, where each component is
 * largest, are those of Pagano (1970, table 1) over the wave at the centre of the element there:
 * at a span of ten thicknesses in-plane stresses within 2 %, shear stresses within 3 %; at fifty
 * and a hundred all within 1 %.
 */
static void test_pagano_plate(void **state)
{
    (void)state;
    static const struct {
        double side, value[5]; /* 11 outer face, 22 outer face of the middle ply, 13 and 23 at mid
                                  height, 12 outer face; each over its power of the side */
    } exact[] = {{10, {0.590, 0.285, 0.357, 0.1228, 0.0289}},
                 {50, {0.541, 0.185, 0.393, 0.0842, 0.0216}},
                 {100, {0.539, 0.181, 0.395, 0.0828, 0.0213}}};
    static const struct {
        double x, y;
        int sample, power;
    } where[5] = {{0.5, 0.5, 8, 2}, {0.5, 0.5, 5, 2}, {0, 0.5, 4, 1}, {0.5, 0, 4, 1}, {0, 0, 8, 2}};
    for (size_t k = 0; k < sizeof exact / sizeof *exact; k++) {
        char changes[700];
        scene_run run;
        const int used = put_layers(changes, sizeof changes, "cross", 1 / exact[k].side);
        snprintf(changes + used, sizeof changes - (size_t)used, "element={shear: equilibrium}");
        stress_field field = solved(&run, "crossply", changes);
        for (int i = 0; i < 5; i++) {
            const int element = element_at(&field, where[i].x, where[i].y);
            const double *place = field.element[element].place;
            const stress_sample *own = &samples_of(&field, element)[where[i].sample];
            const double value[5] = {own->plane[0], own->plane[1], own->shear[0], own->shear[1],
                                     own->plane[2]},
                         x = pi * place[0], y = pi * place[1],
                         wave[5] = {sin(x) * sin(y), sin(x) * sin(y), cos(x) * sin(y),
                                    sin(x) * cos(y), cos(x) * cos(y)};
            const double ratio =
                fabs(value[i]) / pow(exact[k].side, where[i].power) / wave[i] / exact[k].value[i];
            print_message("Pagano, side/thickness %g, component %d: %.4f\n", exact[k].side, i,
                          ratio);
            const double wanted = where[i].power == 2 ? 0.02 : 0.03;
            assert_true(fabs(ratio - 1) < (k > 0 ? 0.01 : wanted));
        }
        close_both(&field, &run);
    }
}

/*
 * Law: at element centres bending moment, stress and shear converge as the square of the element
 * length. The moment of the strip is sin(pi x)/pi^2, its shear force cos(pi x)/pi, whatever the
 * plies; in the middle of the plies the stress and the shear of classical lamination are known.
 */
static void test_order(void **state)
{
    (void)state;
    const double thickness = 0.005; /* so thin that shear does not bend the cross-sections */
    double error[3][2];
    for (int k = 0; k < 3; k++) {
        char changes[600];
        scene_run run;
        const int used = put_layers(changes, sizeof changes, "isotropic", thickness);
        snprintf(changes + used, sizeof changes - (size_t)used, "mesh.theta1.elements=%d", 8 << k);
        stress_field field = solved(&run, "tests/rigs/scenes/sine-strip.yaml", changes);
        memset(error[k], 0, sizeof error[k]);
        for (int element = 0; element < field.elements; element++) {
            const double x = field.element[element].place[0];
            const stress_sample *sample = samples_of(&field, element);
            const double stress = 6 * sin(pi * x) / (pi * pi * thickness * thickness),
                         shear = 1.5 * cos(pi * x) / (pi * thickness);
            error[k][0] = fmax(error[k][0], fabs(sample[5].plane[0] / stress - 1));
            error[k][1] =
                fmax(error[k][1], fabs(sample[2].shear[0] - shear) * pi * thickness / 1.5);
        }
        close_both(&field, &run);
    }
    for (int i = 0; i < 2; i++) {
        print_message("order %s: %.2f %.2f\n", i ? "shear" : "stress 11",
                      log2(error[0][i] / error[1][i]), log2(error[1][i] / error[2][i]));
        assert_true(error[1][i] < 0.01);
        assert_true(log2(error[1][i] / error[2][i]) > 1.9);
    }
}

/* ---- summary, points, outputs ---------------------------------------------------------- */

/*
 * Law: Tsai-Hill with equal strengths and the default shear strength is von Mises in plane stress;
 * tension and compression have their own strengths; maximum stress takes the worst component.
 */
static void test_reserve(void **state)
{
    (void)state;
    const double stress[6] = {30, -40, 0, 0, 0, 15};
    const scene_strength equal = {1, {100, 100}, {100, 100}, 100 / sqrt(3), CRITERION_TSAI_HILL};
    scene_strength own = {1, {60, 10}, {120, 80}, 20, CRITERION_MAXIMUM_STRESS};
    assert_near("von Mises", stress_reserve(&equal, stress), 100 / stress_mises(stress), 1e-14);
    assert_near("maximum stress", stress_reserve(&own, stress), 20.0 / 15, 1e-14);
    own.criterion = CRITERION_TSAI_HILL;
    assert_near("Tsai-Hill", stress_reserve(&own, stress),
                1 / sqrt(0.25 + 30 * 40 / 3600.0 + 0.25 + 0.5625), 1e-14);
}

/* Law: a structure that nothing loads has no stress and no reserve factor; a load gives it both. */
static void test_unloaded(void **state)
{
    (void)state;
    static const char *const changes[2] = {"loads=[];", ""};
    for (int is_loaded = 0; is_loaded < 2; is_loaded++) {
        char all[200];
        scene_run run;
        stress_summary summary;
        snprintf(all, sizeof all,
                 "%smaterials.concrete={E: 4.32e8, nu: 0, strength: {tension: 1e6}}",
                 changes[is_loaded]);
        stress_field field = solved(&run, "scordelis-lo", all);
        stress_summarise(&field, &summary);
        assert_int_equal(stress_is_zero(&summary), !is_loaded);
        assert_int_equal(summary.reserve[0].element >= 0, is_loaded);
        close_both(&field, &run);
    }
}

/*
 * Law: averages at nodes do not mix patches of different voltages: the voltages of the elements,
 * averaged at the points, are those of the elements, and a node between two patches has two points.
 */
static void test_borders(void **state)
{
    (void)state;
    scene_run run;
    stress_points points;
    stress_field field =
        solved(&run, "tests/rigs/scenes/free-bimorph.yaml",
               "patches.1.grid=[3, 1];patches.0.grid=[3, 1];actuators.v.applied=[1, 2, 3]");
    assert_int_equal(stress_points_make(&points, &field), 0);
    double *value = calloc((size_t)points.count * 2, sizeof *value);
    assert_non_null(value);
    assert_int_equal(points.count, 24);
    stress_points_average(&points, &field, field.voltage, 2, value);
    for (int k = 0; k < 4 * field.elements; k++)
        for (int i = 0; i < 2; i++)
            assert_near("voltage", value[2 * points.corner[k / 4][k % 4] + i],
                        field.voltage[2 * (k / 4) + i], 4 * DBL_EPSILON);
    free(value);
    stress_points_free(&points);
    close_both(&field, &run);
}

static const char gauge[] =
    IMPROVED "outputs=[{name: g, strain: 11, layer: upper, face: outer, angle: 25, at: {theta1: "
             "0.02, theta2: 0.025}}, {name: s, stress: 22, layer: upper, face: outer, at: {theta1: "
             "0.02, theta2: 0.025}}];supports.0.fix=clamped;sensors.s.circuit=short;loads=[{line: "
             "theta1+, u3: 1}];";

/*
 * Law: a strain as an output is a row over the dof, whose value is that of the recovered strains
 * without correction of the displacement; a stress as an output is that of the recovered stresses;
 * with large rotation allowed the value is the Green-Lagrange strain, equal for small loads.
 */
static void test_outputs(void **state)
{
    (void)state;
    scene_run run;
    double value[2] = {0}, corrected[2] = {0};
    solve_run(&run, PLATE, gauge);
    stress_field field = recovered(&run);
    stress_outputs(&field, value);
    assert_near("row", run.output[0], value[0], 1e-12);
    assert_near("output", scene_run_value(&run, 0), value[0], 1e-12);
    stress_free(&field);
    assert_int_equal(analysis_stresses(&run.analysis, run.u, &field), 0);
    stress_outputs(&field, corrected);
    assert_near("stress", scene_run_value(&run, 1), corrected[1], 1e-12);
    assert_true(fabs(value[0]) > 1e-9 && fabs(corrected[1]) > 1);
    close_both(&field, &run);
    solve_run(&run, PLATE, with(gauge, "kinematics=nonlinear;equilibrium={tolerance: 1e-9}"));
    assert_near("nonlinear strain", scene_run_value(&run, 0), value[0], 1e-3);
    scene_run_close(&run);
}

/*
 * Law: a stress in the direction `angle` is the stress tensor of the layer in axes turned by the
 * difference to the angle of its material; without `angle` it is the stress in material axes.
 */
static void test_turned_stress(void **state)
{
    (void)state;
    scene_run run;
    solve_run(&run, PLATE,
              with(gauge, "layers.upper.angle=10;outputs=["
                          "{name: a, stress: 11, layer: upper, face: outer, at: {theta1: 0.02, "
                          "theta2: 0.025}}, {name: b, stress: 22, layer: upper, face: outer, at: "
                          "{theta1: 0.02, theta2: 0.025}}, {name: c, stress: 12, layer: upper, "
                          "face: outer, at: {theta1: 0.02, theta2: 0.025}}, {name: t, stress: 11, "
                          "angle: 55, layer: upper, face: outer, at: {theta1: 0.02, theta2: "
                          "0.025}}, {name: own, stress: 12, angle: 10, layer: upper, face: outer, "
                          "at: {theta1: 0.02, theta2: 0.025}}]"));
    const double s11 = scene_run_value(&run, 0), s22 = scene_run_value(&run, 1),
                 s12 = scene_run_value(&run, 2);
    assert_true(fabs(s11 - s22) > 1e-3 * fabs(s11) && fabs(s12) > 0);
    assert_near("turned by 45 degrees", scene_run_value(&run, 3), (s11 + s22) / 2 + s12, 1e-13);
    assert_near("material axes", scene_run_value(&run, 4), s12, 1e-13);
    scene_run_close(&run);
}

/*
 * Law: strain gauges are sensors like any other: with eleven of them the shape of a strip under
 * unknown loads and voltage errors is estimated to 1 % of what these disturbances cause.
 */
static void test_gauges(void **state)
{
    (void)state;
    scene_run run;
    estimator estimator;
    char error[SCENE_ERROR];
    solve_run(&run, "tests/rigs/scenes/gauge-strip.yaml", "");
    assert_int_equal(analysis_influence(&run.analysis, error), 0);
    assert_int_equal(estimator_open(&estimator, &run.analysis, error), 0);
    assert_int_equal(estimator.sensors, 11);
    assert_true(estimator.disturbed > 0);
    assert_true(estimator.remaining < 0.01 * estimator.disturbed);
    estimator_close(&estimator);
    scene_run_close(&run);
}

/*
 * Law: a bimorph that voltages roll by more than 1 rad has the stresses of a straight one, E (z
 * times curvature - free strain), in the turned directions. The Green-Lagrange strain of bending
 * exceeds z times curvature by (z times curvature)^2/2, 0.4 % of the largest strain.
 */
static void test_roll(void **state)
{
    (void)state;
    const double t = 0.5e-3, d = 23e-12, volt = 2e5, modulus = 2e9;
    const double curvature = -3 * d * volt / (4 * t * t);
    scene_run run;
    stress_field field =
        solved(&run, "tests/rigs/scenes/free-bimorph.yaml",
               IMPROVED "materials.piezo={E: 2e9, nu: 0, d31: 23e-12};kinematics=nonlinear;"
                        "actuators.v.applied=2e5;mesh.theta1.elements=12");
    assert_true(fabs(curvature) * 0.1 > 1);
    for (int i = 0; i < 6 * field.elements; i++) {
        const int layer = i / 3 % 2, height = i % 3;
        const double free_strain = d * (layer ? -1 : 1) * volt / (2 * t);
        const double wanted =
            modulus * (stress_height(&field, layer, height) * curvature - free_strain);
        stress_layer found;
        stress_layer_of(&field, i / 6, layer, &found);
        if (fabs(found.at[height].stress[0] - wanted) > 0.005 * modulus * d * volt / (2 * t))
            fail_msg("stress %g, should be %g", found.at[height].stress[0], wanted);
    }
    close_both(&field, &run);
}

/* Law: wrong outputs, readings and strengths are refused with the reason and the cure. */
static void test_refusals(void **state)
{
    (void)state;
    static const refusal bad[] = {
        {"materials.AS4/3501.strength={tension: 0}", "'tension: 0' must be above 0"},
        {"materials.AS4/3501.strength={tension: [2, 1]}",
         "no 'shear' beside the strengths 2 and 1"},
        {"materials.AS4/3501.strength={tension: [4, 4, 4]}",
         "has 3 values; give one, or two, [along 1, along 2]"},
        {"materials.AS4/3501.strength={shear: 1}", "'tension' is missing"},
        {"outputs=[{name: g, strain: 11, layer: no, at: nodes}]", "there is no layer 'no'"},
        {"outputs=[{name: g, strain: 13, at: nodes}]", "'strain: 13' is no"},
        {"outputs=[{name: g, stress: 11, at: nodes}]", "a stress needs one of the"},
        {"outputs=[{name: g, strain: 11}]", "no place in this item"},
        {"outputs=[{name: g, strain: 11, at: {theta1: 5, theta2: 0}}]", "is no node of the mesh"},
        {"outputs=[{name: g, u3: middle, angle: 45, at: nodes}]",
         "'angle' belongs to a strain or stress"},
        {"outputs=[{name: g, u3: middle, face: middle, at: nodes}]",
         "'face' belongs to a strain, stress or potential"},
        {"outputs=[{name: g, strain: 11, support: theta1-, at: nodes}]",
         "'support' belongs to a reaction; remove it"},
        {"outputs=[{name: g, x: middle, layer: up, at: nodes}]", "there is no layer 'up'"},
        {"outputs=[{name: g, strain: 11, u3: middle, at: nodes}]", "an output is one quantity"},
    };
    scene_run run;
    assert_refused("plate-50-patches", bad, sizeof bad / sizeof *bad);
    const char *gauges = "tests/rigs/scenes/gauge-strip.yaml";
    assert_int_equal(scene_run_open(&run, gauges,
                                    "outputs.gauges={name: gauges, stress: 11, layer: "
                                    "upper, at: nodes}"),
                     -1);
    assert_non_null(strstr(run.error, "is a stress, which no sensor measures"));
    scene_run_close(&run);
    assert_int_equal(scene_run_open(&run, gauges, "kinematics=nonlinear"), -1);
    assert_non_null(strstr(run.error, "linear in the displacement only with kinematics: linear"));
    scene_run_close(&run);
    assert_int_equal(
        scene_run_open(&run, gauges, "simulate={ticks: 9, plant: {kinematics: nonlinear}}"), -1);
    assert_non_null(strstr(run.error, "which a nonlinear plant cannot give as a reading"));
    scene_run_close(&run);
    const char *absent = with(gauge, "layers.1.patched=true;patches.0.theta1=[0.04, 0.06]");
    assert_int_equal(scene_run_open(&run, PLATE, absent), -1);
    if (!strstr(run.error, "layer 'upper' of output 'g' is absent at theta1 = 0.02"))
        fail_msg("%s", run.error);
    scene_run_close(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_patch),      cmocka_unit_test(test_tension),
        cmocka_unit_test(test_free_piezo), cmocka_unit_test(test_bimorph),
        cmocka_unit_test(test_charge),     cmocka_unit_test(test_resultants),
        cmocka_unit_test(test_rotation),   cmocka_unit_test(test_exact),
        cmocka_unit_test(test_theory),     cmocka_unit_test(test_bent_mesh),
        cmocka_unit_test(test_sandwich),   cmocka_unit_test(test_pagano_plate),
        cmocka_unit_test(test_order),      cmocka_unit_test(test_reserve),
        cmocka_unit_test(test_unloaded),   cmocka_unit_test(test_borders),
        cmocka_unit_test(test_outputs),    cmocka_unit_test(test_turned_stress),
        cmocka_unit_test(test_refusals),   cmocka_unit_test(test_gauges),
        cmocka_unit_test(test_roll),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
