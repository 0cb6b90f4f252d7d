/*
 * Laws of patches that end within elements, whose stiffness is smeared over them.
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
#include "../../host_tools/mesh/invert.h"
#include "../../host_tools/model/electrodes.h"
#include "../../host_tools/model/mass.h"
#include "../../host_tools/model/stress.h"
#include "../../host_tools/model/vibration.h"
#include "../../host_tools/scene/outline_shares.h"
#include "../../lib/model/electrode.h"
#include "../rigs/scene_assert.h"

#define PATCHED "tests/rigs/scenes/smeared-plate.yaml"
#define NO_ELECTRODES "actuators=[];sensors=[];outputs=[{name: w, u3: middle, at: nodes}];"
#define ONE_FACE                                                                                   \
    "layers=[{name: base, material: steel, thickness: 1e-3}, {name: upper, material: ceramic, "    \
    "thickness: 1e-3, patched: true}];sensors=[];outputs=[{name: w, z: middle, at: {theta1: 0.2, " \
    "theta2: 0}}];"
#define DISC "tests/rigs/scenes/disc-mirror.yaml"
#define PATCHED_DISC                                                                               \
    "layers=[{name: glass, material: glass, thickness: 1e-3}, {name: piezo, material: ceramic, "   \
    "thickness: 0.2e-3, patched: true}];actuators=[{name: v, drives: [{patches: p}]}];"
#define SMEARED(name, layer, outline)                                                              \
    "{name: " name ", layer: " layer ", stiffness: smeared, outlines: [{" outline "}]}"

static const double pi = 3.14159265358979323846;
enum { N = LAMINATE_STRAINS, M33 = 4 };

static void open_patches(scene_run *r, const char *name, const char *before, const char *patches)
{
    char changes[4000];
    snprintf(changes, sizeof changes, "%s;patches=[%s]", before, patches);
    open_run(r, name, changes);
}

static void solve_patches(scene_run *r, const char *name, const char *before, const char *patches)
{
    open_patches(r, name, before, patches);
    if (scene_run_solve(r) < 0)
        fail_msg("%s", r->error);
}

/* ---- patches along elements ------------------------------------------- */

static void assert_same_rows(const pzs_rows *one, const pzs_rows *other)
{
    assert_int_equal(one->count, other->count);
    assert_memory_equal(one->start, other->start, (one->count + 1u) * sizeof *one->start);
    assert_memory_equal(one->dof, other->dof, one->start[one->count] * sizeof *one->dof);
    assert_memory_equal(one->value, other->value, one->start[one->count] * sizeof *one->value);
}

static void assert_same_types(const mesh *one, const mesh *other)
{
    assert_int_equal(one->types, other->types);
    assert_memory_equal(one->type, other->type, (size_t)one->types * sizeof *one->type);
    assert_memory_equal(one->element_type, other->element_type,
                        (size_t)one->elements * sizeof *one->element_type);
}

static void assert_same_masses(const design *one, const design *other)
{
    mass first, second;
    char error[SCENE_ERROR] = "";
    assert_int_equal(mass_build(&first, one, MASS_LUMPED, error), 0);
    assert_int_equal(mass_build(&second, other, MASS_LUMPED, error), 0);
    const size_t order = 4 * one->mesh.dof_per_node;
    for (int e = 0; e < one->mesh.elements; e++)
        assert_memory_equal(mass_element(&first, e), mass_element(&second, e),
                            order * (order + 1) / 2 * sizeof(double));
    mass_free(&first);
    mass_free(&second);
}

static void assert_same_resultants(const scene_run *one, const scene_run *other)
{
    const pzs_prescribed_resultants *g = &one->analysis.equilibrium.tables.resultants,
                                    *h = &other->analysis.equilibrium.tables.resultants;
    const uint32_t inputs = one->analysis.design.structure.input.count;
    assert_int_equal(g->values, h->values);
    assert_memory_equal(g->start, h->start, (inputs + 1u) * sizeof *g->start);
    assert_memory_equal(g->which, h->which, g->start[inputs] * sizeof *g->which);
    assert_memory_equal(g->value, h->value, g->values * sizeof *g->value);
}

/* Two descriptions of the same patches on one scene, which must give the same bits. */
static void assert_same(const char *name, const char *before, const char *whole,
                        const char *outlined)
{
    scene_run one, other;
    open_patches(&one, name, before, whole);
    open_patches(&other, name, before, outlined);
    const design *a = &one.analysis.design, *b = &other.analysis.design;
    assert_same_types(&a->mesh, &b->mesh);
    assert_same_rows(&a->structure.input, &b->structure.input);
    assert_same_rows(&a->electrodes.direct, &b->electrodes.direct);
    assert_same_masses(a, b);
    if (one.scene.kinematics != KINEMATICS_LINEAR)
        assert_same_resultants(&one, &other);
    scene_run_close(&one);
    scene_run_close(&other);
}

#define RECTANGLE(x0, x1, y0, y1) "grid: {from: [" x0 ", " y0 "], to: [" x1 ", " y1 "], count: "
#define WHOLE_PAIR                                                                                 \
    "{name: up, layer: upper, theta1: [-0.1, 0.1], theta2: [-0.05, 0.1], grid: [2, 3]}, {name: "   \
    "low, layer: lower, theta1: [-0.05, 0.15], theta2: [-0.1, 0.1]}"
#define OUTLINED_PAIR                                                                              \
    SMEARED("up", "upper", RECTANGLE("-0.1", "0.1", "-0.05", "0.1") "[2, 3]}")                     \
    ", " SMEARED("low", "lower", RECTANGLE("-0.05", "0.15", "-0.1", "0.1") "[1, 1]}")

/*
 * Law: smeared patches whose outlines follow the sides of elements, on both faces, have the element
 * types, mass matrices, inputs, charges and prescribed resultants of patches of whole elements, to
 * the last bit: on plates, on cylinders, on surfaces by formula and on meshes of general
 * quadrilaterals, with every formulation of the element.
 */
static void test_whole_elements(void **state)
{
    (void)state;
    static const char *const before[] = {
        "kinematics=nonlinear;loads=[{temperature: 10}]",
        "element=published",
        "element={shear: equilibrium}",
        "surface={type: cylinder, radius: 0.3, axial: theta1};loads=[{weight: {axis: z, gravity: "
        "-9.81}}]",
        "surface={type: formula, z: 2*x*y};outputs=[{name: q, charge: s}]",
    };
    for (size_t k = 0; k < sizeof before / sizeof *before; k++)
        assert_same(PATCHED, before[k], WHOLE_PAIR, OUTLINED_PAIR);
    assert_same(DISC, PATCHED_DISC "mesh={disc: {radius: 25 mm, elements: 6}}",
                "{name: p, layer: piezo, sets: [ring1]}", SMEARED("p", "piezo", "inside: 1"));
}

/*
 * Law: a part of an element below 1e-12 of its area is none, and a patch that lacks such a part is
 * whole.
 */
static void test_slivers(void **state)
{
    (void)state;
    static const char *const before = NO_ELECTRODES "loads=[{temperature: 10}]";
    static const char *const whole =
        "{name: up, layer: upper, theta1: [-0.1, 0.1], theta2: [-0.05, 0.1]}, {name: low, layer: "
        "lower}";
    assert_same(PATCHED, before, whole,
                SMEARED("up", "upper",
                        "polygon: [[-0.1, -0.05], [0.100000000000005, -0.05], [0.100000000000005, "
                        "0.1], [-0.1, 0.1]]") ", {name: low, layer: lower}");
    assert_same(PATCHED, before, whole,
                SMEARED("up", "upper",
                        "polygon: [[-0.1, -0.05], [0.099999999999995, -0.05], [0.099999999999995, "
                        "0.1], [-0.1, 0.1]]") ", {name: low, layer: lower}");
}

/* ---- one element ------------------------------------------------------ */

/* Three plies, of which the upper one covers a part of an element of area 1. */
static laminate_place place_of(double cover)
{
    laminate_place place = {.present_plies = cover > 0 ? 7 : 3, .chord = {1, 1}, .area = 1};
    place.absent[2] = cover > 0 ? 1 - cover : 0;
    return place;
}

static void element_stiffness(const scene_run *r, const laminate *laminate, double cover,
                              double stiffness[N][N])
{
    double packed[4][LAMINATE_PACKED];
    const laminate_place place = place_of(cover);
    assert_int_equal(laminate_modes(laminate, &r->scene.element, &place, packed), 0);
    for (int i = 0; i < N; i++)
        for (int j = 0; j <= i; j++)
            stiffness[i][j] = stiffness[j][i] = packed[0][i * (i + 1) / 2 + j];
}

/* Stiffness without a normal force: the mean thickness strain is condensed. */
static void condense(double stiffness[N][N])
{
    double column[N];
    for (int i = 0; i < N; i++)
        column[i] = stiffness[i][M33];
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            stiffness[i][j] -= column[i] * column[j] / column[M33];
}

static double largest_of(double matrix[N][N])
{
    double largest = 0;
    for (int i = 0; i < N * N; i++)
        largest = fmax(largest, fabs(matrix[i / N][i % N]));
    return largest;
}

static const char *const formulation[3] = {PUBLISHED, IMPROVED "layers.1.angle=0",
                                           "element={shear: equilibrium}"};

/*
 * Law: without a normal force, the stiffness of an element with a smeared ply is that of a ply that
 * covers the element and whose moduli are multiplied by the covered fraction: in the plane, in
 * bending about the common and about its own height, in their coupling, and in transverse shear,
 * uniform or from equilibrium.
 */
static void test_moduli(void **state)
{
    (void)state;
    for (int e = 0; e < 3; e++)
        for (double cover = 1.0 / 64; cover < 1; cover *= 4) {
            scene_run r;
            double smeared[N][N], softer[N][N];
            solve_patches(&r, PATCHED, formulation[e], WHOLE_PAIR);
            laminate scaled = r.analysis.design.mesh.laminate;
            for (int i = 0; i < 36; i++)
                scaled.ply[2].c[i / 6][i % 6] *= cover;
            element_stiffness(&r, &r.analysis.design.mesh.laminate, cover, smeared);
            element_stiffness(&r, &scaled, 1, softer);
            condense(smeared);
            condense(softer);
            const double size = largest_of(softer);
            for (int i = 0; i < N; i++)
                for (int j = 0; j < N; j++)
                    if (i != M33 && i != M33 + 1 && j != M33 && j != M33 + 1)
                        assert_true(fabs(smeared[i][j] - softer[i][j]) < 1e3 * DBL_EPSILON * size);
            scene_run_close(&r);
        }
}

/*
 * Law: as the covered fraction goes to 0 or to 1, the stiffness goes to that without the ply or
 * with the whole ply: the difference is of the size of the fraction.
 */
static void test_limits(void **state)
{
    (void)state;
    for (int e = 0; e < 3; e++) {
        scene_run r;
        double limit[N][N], near[N][N];
        solve_patches(&r, PATCHED, formulation[e], WHOLE_PAIR);
        for (int is_whole = 0; is_whole < 2; is_whole++)
            for (double part = 1e-3; part > 1e-9; part /= 10) {
                const laminate *laminate = &r.analysis.design.mesh.laminate;
                element_stiffness(&r, laminate, is_whole, limit);
                element_stiffness(&r, laminate, is_whole ? 1 - part : part, near);
                for (int i = 0; i < N * N; i++)
                    assert_true(fabs(near[i / N][i % N] - limit[i / N][i % N]) <
                                10 * part * largest_of(limit));
            }
        scene_run_close(&r);
    }
}

/* Resultants and charge of a field in the upper ply, which covers a part of an element. */
typedef struct response {
    double resultants[N], charge;
} response;

/*
 * Response to one unit of a field where the ply is. With the element option lin33 the mean
 * thickness strain is free; otherwise it is 0.
 */
static response response_to(const scene_run *r, double cover, int axis)
{
    const laminate *laminate = &r->analysis.design.mesh.laminate;
    const laminate_place place = place_of(cover);
    const laminate_field field = {.ply = 2, .axis = axis};
    double stiffness[N][N];
    response found;
    element_stiffness(r, laminate, cover, stiffness);
    laminate_resultants(laminate, &r->scene.element, &place, &field, found.resultants);
    found.charge = cover * laminate_charge(laminate, &r->scene.element, &place, 2, &field);
    for (int i = 0; i < N; i++)
        found.resultants[i] *= cover;
    const double normal = found.resultants[M33], flexibility = 1 / stiffness[M33][M33];
    if (!r->scene.element.lin33)
        return found;
    found.charge += normal * flexibility * normal;
    for (int i = 0; i < N; i++)
        found.resultants[i] -= stiffness[i][M33] * flexibility * normal;
    return found;
}

/*
 * Law: at free thickness, the resultants and the charge of a voltage across a smeared ply, or of
 * its heat, are the covered fraction of those of a ply that covers the element.
 */
static void test_prescribed(void **state)
{
    (void)state;
    for (int e = 0; e < 3; e++) {
        scene_run r;
        solve_patches(&r, PATCHED, formulation[e], WHOLE_PAIR);
        for (int axis = LAMINATE_HEATED_PLY; axis <= LAMINATE_ACROSS; axis++) {
            const response whole = response_to(&r, 1, axis);
            double size = 0;
            for (int i = 0; i < N; i++)
                size = fmax(size, fabs(whole.resultants[i]));
            for (double cover = 1.0 / 64; cover < 1; cover *= 4) {
                const response part = response_to(&r, cover, axis);
                for (int i = 0; i < N; i++)
                    assert_true(fabs(part.resultants[i] - cover * whole.resultants[i]) <
                                1e3 * DBL_EPSILON * size);
                if (axis == LAMINATE_ACROSS)
                    assert_near("charge", part.charge, cover * whole.charge, 1e3 * DBL_EPSILON);
            }
        }
        scene_run_close(&r);
    }
}

/* ---- whole structures ------------------------------------------------- */

#define FREE                                                                                       \
    "supports=[{at: {theta1: -0.2, theta2: -0.2}, fix: [u1 mean, u2 mean, u3 mean, u1 "            \
    "difference, u2 difference]}, {at: {theta1: 0.2, theta2: -0.2}, fix: [u2 mean]}];"

/*
 * Law: a free plate of plies with one thermal expansion expands without stress under a uniform
 * temperature, wherever its patches end.
 */
static void test_free_expansion(void **state)
{
    (void)state;
    for (int e = 0; e < 3; e++) {
        scene_run r;
        char before[1200];
        stress_field field;
        snprintf(before, sizeof before,
                 "%smaterials.ceramic.alpha=12e-6;loads=[{temperature: 50}];" FREE
                 "actuators=[];sensors=[];outputs=[{name: x, u1: mean, at: nodes}, {name: z, u3: "
                 "outer, at: nodes}]",
                 elements[e]);
        solve_patches(&r, PATCHED, before,
                      SMEARED("up", "upper", "circle: {radius: 0.1}") ", " SMEARED(
                          "low", "lower", "polygon: [[-0.18, -0.1], [0.19, -0.07], [0, 0.18]]"));
        const mesh *mesh = &r.analysis.design.mesh;
        for (int n = 0; n < mesh->nodes; n++) {
            const double want = 600e-6 * (mesh->point[n].position[0] + 0.2);
            assert_true(fabs(r.output[n] - want) < 1e-11 * 600e-6);
            assert_true(fabs(r.output[mesh->nodes + n] - 750e-9) < 1e-9 * 750e-9 + 1e-12);
        }
        const stress_state solved = {&r.analysis.design, r.u, r.analysis.input_value, false};
        assert_int_equal(stress_recover(&field, &solved), 0);
        for (int k = 0; k < mesh->elements * 3; k++) {
            stress_layer layer;
            if (!stress_is_present(&field, k / 3, k % 3))
                continue;
            stress_layer_of(&field, k / 3, k % 3, &layer);
            for (int i = 0; i < STRESS_COMPONENTS; i++)
                assert_true(fabs(layer.at[1].stress[i]) < 1e-9 * 200e9 * 600e-6);
        }
        stress_free(&field);
        scene_run_close(&r);
    }
}

/* Mass of a structure in a translation along x. */
static double mass_of(const scene_run *r)
{
    mass mass;
    char error[SCENE_ERROR] = "";
    const double shift[3] = {1, 0, 0}, still[3] = {0, 0, 0};
    assert_int_equal(mass_build(&mass, &r->analysis.design, MASS_LUMPED, error), 0);
    const double found = mass_rigid(&mass, NULL, shift, still, NULL);
    mass_free(&mass);
    return found;
}

/*
 * Law: the mass is area times thickness times density, whatever elements an outline cuts, and so is
 * the weight that the supports carry.
 */
static void test_mass(void **state)
{
    (void)state;
    static const struct {
        const char *outline;
        double area;
    } row[] = {
        {"circle: {radius: 0.11, centre: [0.01, -0.02]}", 0.0380132711084365},
        {"polygon: [[-0.1, -0.13], [0.13, -0.04], [0, 0.12]]", 0.02425},
        {"grid: {from: [-0.15, -0.1], to: [0.15, 0.1], count: [3, 2], gap: 0.01, angle: 17}",
         6 * 0.09 * 0.09},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        scene_run r;
        char patches[400];
        snprintf(patches, sizeof patches, SMEARED("up", "upper", "%s"), row[k].outline);
        solve_patches(&r, PATCHED,
                      ONE_FACE
                      "actuators=[];loads=[{weight: {axis: z, gravity: -9.81}}];supports=[{name: "
                      "root, edge: theta1-, fix: clamped}];outputs=[{name: f, reaction: "
                      "z, support: root}]",
                      patches);
        const double want = 0.16 * 1e-3 * 7800 + row[k].area * 1e-3 * 7700;
        assert_near("mass", mass_of(&r), want, 1e-12);
        assert_near("weight", scene_run_value(&r, 0), 9.81 * want, 1e-9);
        scene_run_close(&r);
    }
    scene_run disc;
    open_patches(&disc, DISC, PATCHED_DISC "materials.glass.density=1e-9",
                 SMEARED("p", "piezo", "circle: {radius: 0.0133, centre: [0.002, 0.001]}"));
    assert_near("mass on a disc", mass_of(&disc), pi * 0.0133 * 0.0133 * 0.2e-3 * 7800, 1e-11);
    scene_run_close(&disc);
}

/*
 * Law: patches that divide another one act together as it does alone, also where an element has
 * two of them, and under nonlinear kinematics.
 */
static void test_divided(void **state)
{
    (void)state;
    static const char *const part[2] = {
        SMEARED("up", "upper",
                "polygon: [[-0.13, -0.1], [0.14, -0.1], [0.14, 0.11], [-0.13, "
                "0.11]]"),
        "{name: up, layer: upper, stiffness: smeared, outlines: [{polygon: [[-0.13, -0.1], [0.14, "
        "-0.1], [-0.13, 0.11]]}, {polygon: [[0.14, -0.1], [0.14, 0.11], [-0.13, 0.11]]}]}"};
    scene_run r[2];
    double most = 0, gap = 0;
    for (int k = 0; k < 2; k++)
        solve_patches(&r[k], PATCHED,
                      ONE_FACE
                      "kinematics=nonlinear;equilibrium={tolerance: 1e-10};actuators.0.applied=300",
                      part[k]);
    for (int i = 0; i < r[0].analysis.design.mesh.free_dof; i++) {
        most = fmax(most, fabs(r[0].u[i]));
        gap = fmax(gap, fabs(r[0].u[i] - r[1].u[i]));
    }
    assert_true(most > 0 && gap < 1e-9 * most);
    scene_run_close(&r[0]);
    scene_run_close(&r[1]);
}

/* Charge of the electrode `of` on one face under 100 V on the electrode `by` on the other face. */
static double transferred(const char *by, const char *of)
{
    scene_run r;
    char before[400];
    snprintf(before, sizeof before,
             "actuators.0.drives=[{patches: %s}];sensors.0.drives=[{patches: "
             "%s}]",
             by, of);
    solve_patches(
        &r, PATCHED, before,
        SMEARED("up", "upper", "circle: {radius: 0.1, centre: [0.03, 0.01]}") ", " SMEARED(
            "low", "lower", "polygon: [[-0.18, -0.1], [0.19, -0.07], [0, 0.18]]"));
    const double charge = scene_run_value(&r, 1);
    scene_run_close(&r);
    return charge;
}

/* Law: the charge on one face by a voltage on the other is that of the other by the one. */
static void test_reciprocity(void **state)
{
    (void)state;
    const double charge = transferred("up", "low");
    assert_true(fabs(charge) > 1e-9);
    assert_near("reciprocity", transferred("low", "up"), charge, 1e-9);
}

/*
 * Law: in elements that a patch covers in part, the voltage across its material is that of its
 * electrode.
 */
static void test_voltage(void **state)
{
    (void)state;
    scene_run r;
    stress_field field;
    int cut = 0;
    solve_patches(&r, PATCHED, ONE_FACE, SMEARED("up", "upper", "circle: {radius: 0.11}"));
    const stress_state solved = {&r.analysis.design, r.u, r.analysis.input_value, false};
    assert_int_equal(stress_recover(&field, &solved), 0);
    for (int e = 0; e < field.elements; e++) {
        if (!stress_is_present(&field, e, 1))
            continue;
        cut += outline_smeared_share(&r.scene, 1, e) < 1;
        assert_near("voltage", field.voltage[2 * e + 1], 100, 1e-9);
    }
    assert_true(cut > 8);
    stress_free(&field);
    scene_run_close(&r);
}

/*
 * Law: where all mean strains are held at 0, the plies thicken under temperature and voltage such
 * that the thickness, as a mean over the covered parts of an element, does not change.
 */
static void test_held_thickness(void **state)
{
    (void)state;
    scene_run r;
    stress_field field;
    solve_patches(&r, PATCHED,
                  "supports=[{at: nodes, fix: [u1, u2, u3 difference]}, {edge: theta1-, fix: [u3 "
                  "mean]}];loads=[{temperature: 20}]",
                  SMEARED("up", "upper", "circle: {radius: 0.1}") ", " SMEARED(
                      "low", "lower", "polygon: [[-0.18, -0.1], [0.19, -0.07], [0, 0.18]]"));
    const mesh *mesh = &r.analysis.design.mesh;
    const stress_state solved = {&r.analysis.design, r.u, r.analysis.input_value, false};
    assert_int_equal(stress_recover(&field, &solved), 0);
    for (int e = 0; e < mesh->elements; e++) {
        double sum = 0, size = 0;
        for (int k = 0; k < 3; k++) {
            stress_layer layer;
            const double *z = mesh->laminate.ply[k].z,
                         cover = laminate_cover(&mesh->place[mesh->element_type[e]], k);
            if (!stress_is_present(&field, e, k))
                continue;
            stress_layer_of(&field, e, k, &layer);
            const double thickening = cover * (z[1] - z[0]) * layer.at[1].strain[2];
            sum += thickening;
            size = fmax(size, fabs(thickening));
        }
        assert_true(fabs(sum) <= 1e-9 * size + 1e-20);
    }
    stress_free(&field);
    scene_run_close(&r);
}

/* ---- what is said ----------------------------------------------------- */

/* Law: the elements that a patch covers in part are counted, with their extreme fractions. */
static void test_cuts(void **state)
{
    (void)state;
    scene_run r;
    open_patches(
        &r, PATCHED, ONE_FACE,
        SMEARED(
            "up", "upper",
            RECTANGLE(
                "-0.1", "0.11", "-0.1",
                "0.105") "[1, 1]}") ", {name: more, "
                                    "layer: upper, theta1: [0.15, 0.2], theta2: [-0.2, -0.15]}");
    const outline_cuts cuts = outline_cuts_of(&r.scene, 1, 64);
    assert_int_equal(cuts.elements, 4 + 4 + 1);
    assert_near("least", cuts.least, 0.02, 1e-12);
    assert_near("most", cuts.most, 0.2, 1e-12);
    assert_true(outline_is_smeared(&r.scene, 1) && !outline_is_smeared(&r.scene, 0));
    scene_run_close(&r);
}

/* Law: what cannot be meant is refused with the finding and the cure. */
static void test_refusals(void **state)
{
    (void)state;
    static const char *const row[][2] = {
        {"patches.0.stiffness=smear", "'stiffness: smear' is not known; did you mean 'smeared'?"},
        {"patches.0.stiffness=1", "'stiffness: 1' is not known"},
        {"patches.0.stiffness=continuous",
         "the layer 'upper' is patched: its material ends where patches end, and outlines do not "
         "follow elements; add 'stiffness: smeared'"},
        {"layers.2.patched=false",
         "the layer 'upper' is continuous, so that its stiffness does not end at outlines; give "
         "the layer 'patched: true', or remove 'stiffness'"},
        {"layers.2.bare=outer",
         "the layer 'upper' has a bare face, whose patches are whole elements; remove 'bare'"},
        {"patches.0={name: up, layer: upper, stiffness: smeared}",
         "'stiffness' belongs to 'outlines'; add them, or remove it"},
        {"patches.0.outlines=[{circle: {radius: 0.25}}]", "lie outside the surface"},
        {"layers.1.patched=true", "this layer is patched but no patches lie on it"},
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        char error[SCENE_ERROR] = "no fault";
        scene scene;
        const int status = scene_read(&scene, PATCHED, &row[k][0], 1, error);
        if (status == 0)
            scene_free(&scene);
        if (status == 0 || !strstr(error, row[k][1]))
            fail_msg("%s: expected '%s', got '%s'", row[k][0], row[k][1], error);
    }
}

/* ---- convergence ------------------------------------------------------ */

/*
 * Mesh of a square plate whose sides follow a circle: a block of n x n elements in its middle, four
 * between this block and the circle, and four between the circle and the sides of the plate.
 */
enum { BLOCKS = 9, FINE = 16, MESH_NODES = BLOCKS * (FINE + 1) * (FINE + 1) };
static const double plate = 0.2, circle = 0.1, core = 0.055;

typedef struct circle_mesh {
    int n, nodes, elements;
    double x[MESH_NODES][2];
    int element[BLOCKS * FINE * FINE][4];
    bool is_inside[BLOCKS * FINE * FINE];
} circle_mesh;

/* Point s (0 to 1) on a quarter of three closed lines: the core, the circle, the plate's edge. */
static void point_of_line(int line, int quarter, double s, double x[2])
{
    const double angle = pi / 2 * s - pi / 4, side = line == 0 ? core : plate;
    double own[2] = {side * (line == 0 ? 1 + 0.12 * sin(pi * s) : 1), side * (2 * s - 1)};
    if (line == 1) {
        own[0] = circle * cos(angle);
        own[1] = circle * sin(angle);
    }
    for (int k = 0; k < quarter; k++) {
        const double turned = -own[1];
        own[1] = own[0];
        own[0] = turned;
    }
    memcpy(x, own, sizeof own);
}

/* Point of block b: 0 is the core, 1 to 4 lie inside of the circle, 5 to 8 outside. */
static void point_of_block(int b, double s, double t, double x[2])
{
    double low[2], high[2], left[2], right[2];
    if (b > 0) {
        point_of_line((b - 1) / 4, (b - 1) % 4, t, low);
        point_of_line((b - 1) / 4 + 1, (b - 1) % 4, t, high);
        for (int i = 0; i < 2; i++)
            x[i] = (1 - s) * low[i] + s * high[i];
        return;
    }
    point_of_line(0, 3, s, low);
    point_of_line(0, 1, 1 - s, high);
    point_of_line(0, 2, 1 - t, left);
    point_of_line(0, 0, t, right);
    const double bilinear[2] = {core * (2 * s - 1), core * (2 * t - 1)};
    for (int i = 0; i < 2; i++)
        x[i] = (1 - t) * low[i] + t * high[i] + (1 - s) * left[i] + s * right[i] - bilinear[i];
}

static int node_at(circle_mesh *mesh, const double x[2])
{
    for (int k = 0; k < mesh->nodes; k++)
        if (hypot(mesh->x[k][0] - x[0], mesh->x[k][1] - x[1]) < 1e-9)
            return k;
    memcpy(mesh->x[mesh->nodes], x, sizeof *mesh->x);
    return mesh->nodes++;
}

static void fill_mesh(circle_mesh *mesh, int n)
{
    static const int corner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh->n = n;
    mesh->nodes = mesh->elements = 0;
    for (int b = 0; b < BLOCKS; b++)
        for (int i = 0; i < n * n; i++) {
            for (int k = 0; k < 4; k++) {
                double x[2];
                point_of_block(b, (i / n + corner[k][0]) / (double)n,
                               (i % n + corner[k][1]) / (double)n, x);
                mesh->element[mesh->elements][k] = node_at(mesh, x);
            }
            mesh->is_inside[mesh->elements++] = b < 5;
        }
}

static void write_mesh(const circle_mesh *mesh, const char *path)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("*NODE\n", file);
    for (int k = 0; k < mesh->nodes; k++)
        fprintf(file, "%d, %.17g, %.17g, 0\n", k + 1, mesh->x[k][0], mesh->x[k][1]);
    for (int inside = 0; inside < 2; inside++) {
        fprintf(file, "*ELEMENT, TYPE=S4, ELSET=%s\n", inside ? "disc" : "rest");
        for (int k = 0; k < mesh->elements; k++)
            if (mesh->is_inside[k] == inside)
                fprintf(file, "%d, %d, %d, %d, %d\n", k + 1, mesh->element[k][0] + 1,
                        mesh->element[k][1] + 1, mesh->element[k][2] + 1, mesh->element[k][3] + 1);
    }
    fputs("*NSET, NSET=root\n", file);
    for (int k = 0; k < mesh->nodes; k++)
        if (mesh->x[k][0] < -plate + 1e-9)
            fprintf(file, "%d,\n", k + 1);
    fclose(file);
}

/* Displacement of the free edge under a pressure and under a voltage, and first frequency. */
enum { PRESSURE, VOLTAGE, FREQUENCY, RESULTS };

static void results_of(const char *scene, const char *before, const char *patches,
                       double value[RESULTS])
{
    for (int k = 0; k < RESULTS; k++) {
        static const char *const load[RESULTS] = {
            "actuators.0.applied=0;loads=[{face: outer, pressure: 10}];", "", ""};
        scene_run r;
        char changes[1600];
        snprintf(changes, sizeof changes, ONE_FACE "%s%s", load[k], before);
        solve_patches(&r, scene, changes, patches);
        value[k] = scene_run_value(&r, 0);
        if (k == FREQUENCY) {
            vibration v;
            char error[SCENE_ERROR] = "";
            assert_int_equal(vibration_solve(&v, &r.analysis.design, 1, MASS_LUMPED, error), 0);
            value[k] = v.frequency[0];
            vibration_free(&v);
        }
        scene_run_close(&r);
    }
}

/* Copy the scene of the plate without the lines of its surface and mesh, which come from a file. */
static void copy_scene(const char *path)
{
    FILE *from = fopen(PATCHED, "r"), *to = fopen(path, "w");
    char line[400];
    assert_true(from && to);
    while (fgets(line, sizeof line, from))
        if (!strstr(line, "surface:") && !strstr(line, "mesh:") && !strstr(line, "  theta"))
            fputs(line, to);
    fputs("mesh: {file: circle.inp, direction: [1, 0, 0]}\n", to);
    fclose(from);
    fclose(to);
}

/* Results with a mesh that follows the circle, extrapolated from 8 and 16 elements on a block. */
static void follow_circle(double value[RESULTS])
{
    circle_mesh *mesh = malloc(sizeof *mesh);
    char folder[] = "/tmp/test_smeared_XXXXXX", file[80], scene[80];
    double coarse[RESULTS];
    assert_non_null(mesh);
    assert_non_null(mkdtemp(folder));
    snprintf(file, sizeof file, "%s/circle.inp", folder);
    snprintf(scene, sizeof scene, "%s/circle.yaml", folder);
    copy_scene(scene);
    for (int fine = 0; fine < 2; fine++) {
        fill_mesh(mesh, FINE / 2 << fine);
        write_mesh(mesh, file);
        results_of(scene,
                   "supports=[{set: root, fix: clamped}];outputs=[{name: w, z: middle, at: {x: "
                   "0.2, y: 0, z: 0}}]",
                   "{name: up, layer: upper, sets: [disc]}", fine ? value : coarse);
    }
    for (int k = 0; k < RESULTS; k++)
        value[k] += (value[k] - coarse[k]) / 3;
    unlink(file);
    unlink(scene);
    rmdir(folder);
    free(mesh);
}

/*
 * Law: displacements and the first frequency of a plate with a circular patch that its mesh does
 * not follow converge to those of a mesh that follows the circle, about with the first power of the
 * size of the elements.
 */
static void test_convergence(void **state)
{
    (void)state;
    static const char *const name[RESULTS] = {"pressure", "voltage", "frequency"};
    static const double size[RESULTS] = {0.25, 1.25, 0.125}; /* error times number of elements */
    double exact[RESULTS], error[3][RESULTS];
    follow_circle(exact);
    for (int k = 0; k < 3; k++) {
        char before[100];
        double value[RESULTS];
        snprintf(before, sizeof before, "mesh.theta1.elements=%d;mesh.theta2.elements=%d", 8 << k,
                 8 << k);
        results_of(PATCHED, before, SMEARED("up", "upper", "circle: {radius: 0.1}"), value);
        for (int i = 0; i < RESULTS; i++) {
            error[k][i] = fabs(value[i] / exact[i] - 1);
            print_message("%s, %d elements: %.2f %%\n", name[i], 8 << k, 100 * error[k][i]);
            assert_true(error[k][i] < size[i] / (8 << k));
            assert_true(k == 0 || error[k][i] < 0.75 * error[k - 1][i]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole_elements), cmocka_unit_test(test_slivers),
        cmocka_unit_test(test_moduli),         cmocka_unit_test(test_limits),
        cmocka_unit_test(test_prescribed),     cmocka_unit_test(test_free_expansion),
        cmocka_unit_test(test_mass),           cmocka_unit_test(test_divided),
        cmocka_unit_test(test_reciprocity),    cmocka_unit_test(test_voltage),
        cmocka_unit_test(test_held_thickness), cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_refusals),       cmocka_unit_test(test_convergence),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
