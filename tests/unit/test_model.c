/*
 * The linear image in either precision, on tables made in double by the host tools.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../lib/model/electrode.h"
#include "../../lib/core/guard.h"
#include "../../lib/core/linalg.h"
#include "../rigs/rounded.h"
#include "../rigs/testdata.h"
#include "../../lib/model/model.h"

#ifndef DATA
#define DATA "tests/oracle/data"
#endif

#define EPS ((double)PZS_EPSILON)
#define IS_FLOAT (PZS_REAL_BITS == 32)

/* ---- a device: the structure rounded to the working precision --------- */

typedef struct device {
    bridge bridge;
    pzs_structure structure;
    pzs_model model;
    pzs_real *owned[ROUNDED_ARRAYS], *u, *amount;
    void *work;
    size_t bytes;
} device;

static void device_open(device *d, const char *scene, const char *const *set, int sets)
{
    char error[400] = "";
    memset(d, 0, sizeof *d);
    if (bridge_open(&d->bridge, scene, set, sets, error) < 0)
        fail_msg("%s", error);
    const bridge *b = &d->bridge;
    round_structure(b, &d->structure, d->owned);
    d->bytes = PZS_MODEL_BYTES(b->dof, pzs_linalg_reals(b->first_column, (uint32_t)b->dof));
    d->work = malloc(d->bytes);
    d->u = calloc((size_t)b->dof, sizeof *d->u);
    d->amount = calloc((size_t)b->input.count + 1, sizeof *d->amount);
    for (int i = b->amplifiers; i < b->input.count; i++)
        d->amount[i] = 1;
}

static void device_close(device *d)
{
    bridge_close(&d->bridge);
    for (int k = 0; k < ROUNDED_ARRAYS; k++)
        free(d->owned[k]);
    free(d->u);
    free(d->amount);
    free(d->work);
}

static pzs_status start(device *d)
{
    pzs_status status = pzs_model_init(&d->model, &d->structure, d->work, d->bytes);
    if (status == PZS_OK)
        status = pzs_assemble(&d->model, NULL, NULL);
    return status == PZS_OK ? pzs_factor(&d->model) : status;
}

/* The largest error of the displacement over its largest entry; means and differences in their own
 * scale. */
static double solution_error(const device *d)
{
    double error[2] = {0, 0}, largest[2] = {0, 0};
    for (int n = 0; n < d->bridge.nodes; n++)
        for (int i = 0; i < d->bridge.dof_per_node; i++) {
            const uint16_t dof = d->bridge.node_dof[n * d->bridge.dof_per_node + i];
            if (dof == PZS_CONSTRAINED)
                continue;
            const int is_difference = i >= 3;
            error[is_difference] =
                fmax(error[is_difference], fabs((double)d->u[dof] - d->bridge.displacement[dof]));
            largest[is_difference] =
                fmax(largest[is_difference], fabs(d->bridge.displacement[dof]));
        }
    return fmax(error[0] / largest[0], error[1] / largest[1]);
}

/* ---- numerical stability ---------------------------------------------- */

typedef struct outcome {
    pzs_status plain, refined;
    double condition, plain_error, refined_error, residual;
    int passes;
} outcome;

static outcome thin_plate(const char *element, double thickness)
{
    char thick[64], formulation[64];
    const char *set[] = {thick, formulation, "mesh.theta1.elements=8", "mesh.theta2.elements=8"};
    device d;
    outcome o;
    snprintf(thick, sizeof thick, "layers.0.thickness=%g", thickness);
    snprintf(formulation, sizeof formulation, "element=%s", element);
    device_open(&d, "clamped-plate", set, 4);
    memset(&o, 0, sizeof o);
    o.plain_error = o.refined_error = NAN;
    o.condition = d.bridge.condition;
    o.refined = start(&d);
    if (o.refined == PZS_OK)
        o.refined = pzs_solve(&d.model, d.amount, d.u);
    if (o.refined == PZS_OK) {
        o.refined_error = solution_error(&d);
        o.residual = (double)d.model.info.residual;
        o.passes = d.model.info.refinements;
    }
    d.structure.type = NULL;
    d.structure.crc = pzs_structure_crc(&d.structure);
    o.plain = start(&d);
    if (o.plain == PZS_OK)
        o.plain = pzs_solve(&d.model, d.amount, d.u);
    if (o.plain == PZS_OK)
        o.plain_error = solution_error(&d);
    device_close(&d);
    return o;
}

static void report(const char *element, double thickness, const outcome *o)
{
    print_message("  %-9s h/L %.0e  condition %8.1e  plain %8.1e (%s)  refined %8.1e, %d passes, "
                  "residual %.1e (%s)\n",
                  element, thickness, o->condition, o->plain_error,
                  o->plain == PZS_OK ? "ok" : "refused", o->refined_error, o->passes, o->residual,
                  o->refined == PZS_OK ? "ok" : "refused");
}

/*
 * Law: with (mean, difference/h) unknowns the condition grows with (L/h)^2 and the error with it;
 * a device that says ok is right, whatever the thickness, and one that cannot be says so.
 */
static void test_stability_published(void **state)
{
    (void)state;
    static const double thickness[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5},
                        known[] = {0, 1.1e5, 7e6, 6e8, 1e11};
    for (int i = 0; i < 5; i++) {
        const outcome o = thin_plate("published", thickness[i]);
        report("published", thickness[i], &o);
        if (known[i] > 0)
            assert_true(o.condition > known[i] / 2 && o.condition < 6 * known[i]);
        if (o.condition * EPS < 0.3)
            assert_true(o.plain == PZS_OK && o.plain_error < 2 * o.condition * EPS + 100 * EPS);
        if (o.condition * EPS > 5)
            assert_true(o.plain != PZS_OK);
        if (o.condition * EPS < 10) /* the refined answer keeps what the strains of u can hold */
            assert_true(o.refined == PZS_OK);
        if (o.refined == PZS_OK)
            assert_true(o.refined_error < 0.01 * sqrt(o.condition) * EPS + 1e3 * EPS);
    }
}

/* Law: the improved element's condition does not depend on the thickness of a plate, so float
 * serves thin plates. */
static void test_stability_improved(void **state)
{
    (void)state;
    double first = 0;
    for (double thickness = 1e-2; thickness > 0.5e-5; thickness /= 10) {
        const outcome o = thin_plate("improved", thickness);
        report("improved", thickness, &o);
        first = first > 0 ? first : o.condition;
        assert_true(o.condition > first / 2 && o.condition < 2 * first);
        assert_true(o.plain == PZS_OK && o.plain_error < o.condition * EPS);
        assert_true(o.refined == PZS_OK && o.refined_error < 1e3 * EPS);
    }
}

/* ---- influence -------------------------------------------------------- */

/* Law: the influence of 25 pairs of patches equals that of an independent program, in the precision
 * of the device. */
static void test_influence(void **state)
{
    (void)state;
    FILE *file = fopen(DATA "/table7.txt", "r");
    testdata t;
    device d;
    assert_non_null(file);
    assert_int_equal(testdata_next(file, &t), 1);
    fclose(file);
    const double *expected = testdata_values(&t, "influence");
    device_open(&d, "plate-50-patches", NULL, 0);
    d.structure.output.count = 121;
    d.structure.crc = pzs_structure_crc(&d.structure);
    pzs_real *b = calloc(121 * 25, sizeof *b);
    assert_int_equal(start(&d), PZS_OK);
    assert_int_equal(pzs_influence(&d.model, b), PZS_OK);
    double largest = 0, difference = 0;
    for (int i = 0; i < 121 * 25; i++) {
        largest = fmax(largest, fabs(expected[i]));
        difference = fmax(difference, fabs((double)b[i] - expected[i]));
    }
    print_message("  influence of 25 pairs on 121 nodes: %.1e from the witness, residual %.1e\n",
                  difference / largest, (double)d.model.info.residual);
    assert_true(difference / largest < (IS_FLOAT ? 20 * EPS : 0) + 1e-6);
    free(b);
    testdata_free(&t);
    device_close(&d);
}

/* ---- compact tables ----------------------------------------------------- */

/*
 * Law: without the stiffness matrices in the tables the model computes them from the element types:
 * in double the factors have the same bits, also where types are weakened and dof held; in float
 * they differ by the rounding of the tables, and the refined displacements by that of the types.
 */
static void test_compact(void **state)
{
    (void)state;
    device d;
    device_open(&d, "scordelis-lo", NULL, 0);
    pzs_real *factor = calloc((size_t)d.bridge.types, sizeof *factor), *expected = malloc(d.bytes),
             *plain = calloc((size_t)d.bridge.dof, sizeof *plain);
    uint8_t *held = calloc((size_t)d.bridge.dof, 1);
    for (int k = 0; k < d.bridge.types; k++)
        factor[k] = 1 + (pzs_real)k / 8;
    held[5] = 1;
    for (int compact = 0; compact < 2; compact++) {
        if (compact)
            d.structure.stiffness = NULL;
        d.structure.crc = pzs_structure_crc(&d.structure);
        assert_int_equal(pzs_model_init(&d.model, &d.structure, d.work, d.bytes), PZS_OK);
        assert_int_equal(pzs_assemble(&d.model, factor, held), PZS_OK);
        assert_int_equal(pzs_factor(&d.model), PZS_OK);
        if (!compact)
            memcpy(expected, d.work, d.bytes);
        assert_int_equal(pzs_solve(&d.model, d.amount, compact ? d.u : plain), PZS_OK);
    }
    const pzs_real *value = d.model.state.stiffness.value;
    const size_t count = pzs_linalg_reals(d.structure.first_column, (uint32_t)d.bridge.dof);
    for (size_t i = 0; i < count; i++)
        assert_true(IS_FLOAT || memcmp(&value[i], &expected[i], sizeof *value) == 0);
    double largest = 0, difference = 0;
    for (int i = 0; i < d.bridge.dof; i++) {
        largest = fmax(largest, fabs((double)plain[i]));
        difference = fmax(difference, fabs((double)(d.u[i] - plain[i])));
    }
    assert_true(difference <= (IS_FLOAT ? 64 * EPS : 0) * largest);
    d.structure.type = NULL;
    d.structure.crc = pzs_structure_crc(&d.structure);
    assert_int_equal(pzs_model_init(&d.model, &d.structure, d.work, d.bytes), PZS_E_ARGUMENT);
    free(factor);
    free(expected);
    free(plain);
    free(held);
    device_close(&d);
}

/*
 * Use the compact form of the element types of a device, whose full types and stiffness matrices
 * are left out.
 */
static void use_compact_types(device *d, const rounded_compact *compact)
{
    d->structure.stiffness = NULL;
    d->structure.type = NULL;
    d->structure.compact = compact->type;
    d->structure.node = compact->node;
    d->structure.crc = pzs_structure_crc(&d->structure);
    d->bytes += PZS_COMPACT_BYTES;
    d->work = realloc(d->work, d->bytes);
    assert_non_null(d->work);
}

/*
 * Law: on a general mesh the library completes compact element types to the full ones, in double to
 * the bits. In float the nodes are rounded by EPS of the size of the mesh; on elements 1/20 as long
 * this changes strains, and with them displacements, by at most 40 EPS.
 */
static void test_compact_types(void **state)
{
    (void)state;
    device d;
    rounded_compact compact;
    device_open(&d, "wing-panel", NULL, 0);
    pzs_real *plain = calloc((size_t)d.bridge.dof, sizeof *plain);
    assert_int_equal(d.bridge.compact_types, d.bridge.types);
    round_compact(&d.bridge, &compact);
    assert_int_equal(start(&d), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, plain), PZS_OK);
    use_compact_types(&d, &compact);
    assert_int_equal(start(&d), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_OK);
    double largest = 0, difference = 0;
    for (int i = 0; i < d.bridge.dof; i++) {
        largest = fmax(largest, fabs((double)plain[i]));
        difference = fmax(difference, fabs((double)(d.u[i] - plain[i])));
    }
    print_message("  compact types: displacement off by %.1e of the largest\n",
                  difference / largest);
    assert_true(difference <= (IS_FLOAT ? 64 * EPS : 0) * largest);
    assert_int_equal(pzs_model_init(&d.model, &d.structure, d.work, d.bytes - 1), PZS_E_WORKSPACE);
    compact.type[7].corner[2] = (uint16_t)d.bridge.nodes;
    assert_int_equal(start(&d), PZS_E_CRC);
    d.structure.crc = pzs_structure_crc(&d.structure);
    assert_int_equal(start(&d), PZS_E_ARGUMENT);
    d.structure.node = NULL;
    assert_int_equal(start(&d), PZS_E_ARGUMENT);
    free_compact(&compact);
    free(plain);
    device_close(&d);
}

/* ---- what may change in the field ------------------------------------- */

/* Law: twice the stiffness everywhere halves the displacement, to the bit, since two is a power of
 * two. */
static void test_stiffness_factor(void **state)
{
    (void)state;
    device d;
    device_open(&d, "clamped-plate", NULL, 0);
    pzs_real *twice = calloc((size_t)d.bridge.types, sizeof *twice),
             *single = calloc((size_t)d.bridge.dof, sizeof *single);
    for (int k = 0; k < d.bridge.types; k++)
        twice[k] = 2;
    assert_int_equal(start(&d), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, single), PZS_OK);
    assert_int_equal(pzs_assemble(&d.model, twice, NULL), PZS_OK);
    assert_int_equal(pzs_factor(&d.model), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_OK);
    for (int i = 0; i < d.bridge.dof; i++)
        assert_true(fabs((double)(2 * d.u[i] - single[i])) <=
                    64 * EPS * fabs((double)single[i]) + 1e-30 * EPS);
    free(twice);
    free(single);
    device_close(&d);
}

/* Law: an unknown held in the field stays at zero, and the structure is stiffer for it. */
static void test_held_unknown(void **state)
{
    (void)state;
    device d;
    device_open(&d, "clamped-plate", NULL, 0);
    uint8_t *held = calloc((size_t)d.bridge.dof, 1);
    assert_int_equal(start(&d), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_OK);
    const uint16_t middle =
        d.bridge.node_dof[(size_t)(d.bridge.nodes / 2) * (size_t)d.bridge.dof_per_node + 2];
    assert_int_not_equal(middle, PZS_CONSTRAINED);
    const double before = (double)d.u[d.bridge.node_dof[2]];
    held[middle] = 1;
    assert_int_equal(pzs_assemble(&d.model, NULL, held), PZS_OK);
    assert_int_equal(pzs_factor(&d.model), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_OK);
    assert_true(d.u[middle] == 0);
    assert_true(fabs((double)d.u[d.bridge.node_dof[2]]) < fabs(before));
    free(held);
    device_close(&d);
}

/* ---- springs ---------------------------------------------------------- */

/* A free plate on springs between nodes and to another node, pushed by two stacks. */
static const char *const on_springs[] = {
    "springs=[{points: [[0.1, 0.1], [0.9, 0.1], [0.5, 0.93]], along: [0.1, 0.2, 1], "
    "stiffness: 1e7}, "
    "{at: {theta1: 0, theta2: 0}, to: {theta1: 1, theta2: 1}, along: z, stiffness: 1e6}, {edge: "
    "theta1-, along: x, stiffness: 1e8, per: length}, "
    "{edge: theta1-, along: y, stiffness: 1e8, per: length}]",
    "actuators=[{name: s, stacks: {points: [[0.3, 0.3], [0.6, 0.6]], along: z, stiffness: 1e7, "
    "stroke: 1e-6}, applied: [10, -20]}]",
    "loads=[{point: {theta1: 0.5, theta2: 0.5}, z: -10}]"};

/*
 * Law: a device computes the displacement on springs as the host does, in either precision, and a
 * dof that is held in the field elongates no spring.
 */
static void test_springs(void **state)
{
    (void)state;
    device d;
    device_open(&d, "tests/rigs/scenes/spring-plate.yaml", on_springs, 3);
    for (int i = 0; i < d.bridge.input.count; i++)
        d.amount[i] = (pzs_real)d.bridge.input_value[i];
    assert_int_equal(start(&d), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_OK);
    const double error = solution_error(&d);
    print_message("  plate on springs: %.1e from the host, condition %.1e\n", error,
                  (double)d.model.info.condition);
    assert_true(error < 64 * EPS);
    uint8_t *held = calloc((size_t)d.bridge.dof, 1);
    const uint16_t dof = d.bridge.spring.dof[0];
    held[dof] = 1;
    assert_int_equal(pzs_assemble(&d.model, NULL, held), PZS_OK);
    assert_int_equal(pzs_factor(&d.model), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_OK);
    assert_true(d.u[dof] == 0);
    free(held);
    device_close(&d);
}

/*
 * Law: a device computes the displacement on oblique supports as the host does, in either
 * precision, with stiffness matrices from the tables and with computed ones.
 */
static void test_oblique_supports(void **state)
{
    (void)state;
    static const char *const oblique[] = {
        "supports=[{edge: theta1-, fix: along, direction: [1, 2, 2]}, {edge: theta1+, fix: across, "
        "direction: [1, 0.3, -0.2]}, {at: {theta1: 0, theta2: 0}, fix: [cone, u2 difference]}]",
        "loads=[{point: {theta1: 0.5, theta2: 0.5}, z: -10}]"};
    for (int compact = 0; compact < 2; compact++) {
        device d;
        device_open(&d, "tests/rigs/scenes/spring-plate.yaml", oblique, 2);
        assert_int_equal(d.structure.turns, 9);
        if (compact)
            d.structure.stiffness = NULL;
        d.structure.crc = pzs_structure_crc(&d.structure);
        assert_int_equal(start(&d), PZS_OK);
        assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_OK);
        const double error = solution_error(&d);
        print_message("  plate on oblique supports: %.1e from the host, condition %.1e\n", error,
                      (double)d.model.info.condition);
        assert_true(error < 64 * EPS);
        device_close(&d);
    }
}

/*
 * Law: a stiffness that is negative or not a number, and a spring outside the envelope, are refused
 * where the checksum is right, and any change where it is not.
 */
static void test_bad_springs(void **state)
{
    (void)state;
    static const double bad[3] = {-1, (double)NAN, (double)INFINITY};
    device d;
    device_open(&d, "tests/rigs/scenes/spring-plate.yaml", on_springs, 3);
    pzs_real *stiffness = d.owned[ROUNDED_SPRING_STIFFNESS];
    const pzs_real kept = stiffness[1];
    stiffness[1] *= 2;
    assert_int_equal(start(&d), PZS_E_CRC);
    for (int i = 0; i < 3; i++) {
        stiffness[1] = (pzs_real)bad[i];
        d.structure.crc = pzs_structure_crc(&d.structure);
        assert_int_equal(start(&d), PZS_E_ARGUMENT);
    }
    stiffness[1] = kept;
    const uint32_t begin = d.bridge.spring.start[3], end = d.bridge.spring.start[4];
    uint16_t last = 0; /* of the spring between two corners, which alone needs its first column */
    for (uint32_t i = begin; i < end; i++)
        last = d.bridge.spring.dof[i] > last ? d.bridge.spring.dof[i] : last;
    ((uint16_t *)(uintptr_t)d.bridge.first_column)[last]++;
    d.structure.crc = pzs_structure_crc(&d.structure);
    assert_int_equal(start(&d), PZS_E_ARGUMENT);
    ((uint16_t *)(uintptr_t)d.bridge.first_column)[last]--;
    d.structure.crc = pzs_structure_crc(&d.structure);
    assert_int_equal(start(&d), PZS_OK);
    d.structure.spring_stiffness = NULL;
    assert_int_equal(start(&d), PZS_E_ARGUMENT);
    device_close(&d);
}

/* Law: a load on an unknown that is held moves nothing there, and what remains is the answer of the
 * held structure. */
static void test_load_on_held_unknown(void **state)
{
    (void)state;
    device d;
    device_open(&d, "clamped-plate", NULL, 0);
    uint8_t *held = calloc((size_t)d.bridge.dof, 1);
    const uint32_t load = d.bridge.input.start[d.bridge.amplifiers];
    held[d.bridge.input.dof[load]] = 1;
    assert_int_equal(pzs_model_init(&d.model, &d.structure, d.work, d.bytes), PZS_OK);
    assert_int_equal(pzs_assemble(&d.model, NULL, held), PZS_OK);
    assert_int_equal(pzs_factor(&d.model), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_OK);
    for (int i = 0; i < d.bridge.dof; i++) /* the only load is on the held unknown */
        assert_true(fabs((double)d.u[i]) <= 0);
    free(held);
    device_close(&d);
}

/* Law: the answer scales with the load to the last bit, by any power of two that a real number
 * holds. */
static void test_load_scaling(void **state)
{
    (void)state;
    static const int power[] = {-60, 60};
    device d;
    device_open(&d, "clamped-plate", NULL, 0);
    pzs_real *single = calloc((size_t)d.bridge.dof, sizeof *single);
    assert_int_equal(start(&d), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, single), PZS_OK);
    for (int k = 0; k < 2; k++) {
        const pzs_real factor = (pzs_real)ldexp(1, power[k]);
        d.amount[d.bridge.amplifiers] = factor;
        assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_OK);
        for (int i = 0; i < d.bridge.dof; i++)
            assert_true(!(d.u[i] < factor * single[i]) && !(d.u[i] > factor * single[i]));
    }
    free(single);
    device_close(&d);
}

/* Law: a structure that is not stable at rest, and one with a number that is none, are refused by
 * name. */
static void test_unsound_tables(void **state)
{
    (void)state;
    device d;
    device_open(&d, "clamped-plate", NULL, 0);
    const pzs_real kept = d.owned[ROUNDED_INPUT][0];
    d.owned[ROUNDED_INPUT][0] = (pzs_real)NAN;
    d.structure.crc = pzs_structure_crc(&d.structure);
    assert_int_equal(start(&d), PZS_OK);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_E_RESIDUAL);
    d.owned[ROUNDED_INPUT][0] = kept;
    const size_t corners = 4 * (size_t)d.bridge.dof_per_node;
    for (size_t i = 0, entry = 0; i < corners; i++)
        for (size_t j = 0; j <= i; j++, entry++)
            if (i != j)
                d.owned[ROUNDED_STIFFNESS][entry] *= 3;
    d.structure.crc = pzs_structure_crc(&d.structure);
    assert_int_equal(start(&d), PZS_E_NEGATIVE);
    assert_true(d.model.info.where >= 0 && d.model.info.where < d.bridge.dof);
    assert_true(d.model.info.negative_pivots > 0);
    device_close(&d);
}

/* ---- nothing lost ----------------------------------------------------- */

/* Law: every way to misuse the model has its status, and outputs stay as they were. */
static void test_misuse(void **state)
{
    (void)state;
    device d;
    device_open(&d, "clamped-plate", NULL, 0);
    pzs_structure *structure = &d.structure;
    pzs_real *before = calloc((size_t)d.bridge.dof, sizeof *before);
    assert_int_equal(pzs_model_init(NULL, structure, d.work, d.bytes), PZS_E_ARGUMENT);
    assert_int_equal(pzs_model_init(&d.model, NULL, d.work, d.bytes), PZS_E_ARGUMENT);
    assert_int_equal(pzs_model_init(&d.model, structure, NULL, d.bytes), PZS_E_ARGUMENT);
    assert_int_equal(pzs_model_init(&d.model, structure, d.work, d.bytes - 1), PZS_E_WORKSPACE);
    assert_int_equal(d.model.info.where, d.bytes);
    assert_int_equal(pzs_model_init(&d.model, structure, (char *)d.work + 1, d.bytes),
                     PZS_E_WORKSPACE);
    assert_int_equal(pzs_assemble(&d.model, NULL, NULL), PZS_E_STAGE);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_E_STAGE);
    structure->format++;
    assert_int_equal(pzs_model_init(&d.model, structure, d.work, d.bytes), PZS_E_FORMAT);
    structure->format--;
    d.owned[ROUNDED_STIFFNESS][5] += 1;
    assert_int_equal(pzs_model_init(&d.model, structure, d.work, d.bytes), PZS_E_CRC);
    d.owned[ROUNDED_STIFFNESS][5] -= 1;
    structure->free_dof = PZS_CONSTRAINED;
    assert_int_equal(pzs_model_init(&d.model, structure, d.work, d.bytes), PZS_E_ARGUMENT);
    structure->free_dof = (uint16_t)d.bridge.dof;
    structure->crc = pzs_structure_crc(structure);
    assert_int_equal(pzs_model_init(&d.model, structure, d.work, d.bytes), PZS_OK);
    assert_int_equal(pzs_factor(&d.model), PZS_E_STAGE);
    pzs_real factor[2] = {(pzs_real)NAN, (pzs_real)NAN};
    assert_int_equal(pzs_assemble(&d.model, factor, NULL), PZS_E_NONFINITE);
    factor[0] = factor[1] = -1;
    assert_int_equal(pzs_assemble(&d.model, factor, NULL), PZS_E_ARGUMENT);
    factor[0] = factor[1] = 0;
    assert_int_equal(pzs_assemble(&d.model, factor, NULL), PZS_OK);
    assert_int_equal(pzs_factor(&d.model), PZS_E_LOOSE);
    assert_int_equal(d.model.info.where, 0);
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_E_STAGE);
    assert_int_equal(start(&d), PZS_OK);
    d.amount[0] = (pzs_real)INFINITY;
    assert_int_equal(pzs_solve(&d.model, d.amount, d.u), PZS_E_NONFINITE);
    assert_int_equal(d.model.info.where, 0);
    assert_memory_equal(d.u, before, (size_t)d.bridge.dof * sizeof *before);
    free(before);
    device_close(&d);
}

/* Law: tables whose checksum is right but whose indices are not are refused before anything is read
 * through them. */
static void test_indices_out_of_range(void **state)
{
    (void)state;
    device d;
    device_open(&d, "clamped-plate", NULL, 0);
    uint16_t *const array[] = {
        (uint16_t *)(uintptr_t)d.bridge.element,   (uint16_t *)(uintptr_t)d.bridge.element_type,
        (uint16_t *)(uintptr_t)d.bridge.node_dof,  (uint16_t *)(uintptr_t)d.bridge.first_column,
        (uint16_t *)(uintptr_t)d.bridge.input.dof, (uint16_t *)(uintptr_t)d.bridge.output.dof};
    for (int i = 0; i < 6; i++) {
        const uint16_t kept = array[i][0];
        array[i][0] = 0xFFFE;
        d.structure.crc = pzs_structure_crc(&d.structure);
        assert_int_equal(pzs_model_init(&d.model, &d.structure, d.work, d.bytes), PZS_E_ARGUMENT);
        array[i][0] = kept;
    }
    uint16_t *first = array[3];
    const int last = d.bridge.dof - 1;
    first[last] = (uint16_t)last; /* the envelope no longer holds the last element */
    d.structure.crc = pzs_structure_crc(&d.structure);
    assert_int_equal(pzs_model_init(&d.model, &d.structure, d.work, d.bytes), PZS_E_ARGUMENT);
    device_close(&d);
}

/* Law: open electrodes float at the same volts in either precision, the refined solve's rounding
 * apart. */
static void test_open_electrodes(void **state)
{
    (void)state;
    static const char *const set[] = {
        "loads=[{line: theta1+, u1: 1e4, on: outer}, {line: theta1-, u1: -1e4, on: outer}]",
        "patches=[{name: up, layer: upper, grid: [3, 1]}, {name: low, layer: lower}]",
        "sensors.1={name: t, drives: [{patches: low}]}"};
    device d;
    device_open(&d, "tests/rigs/scenes/piezo-plate.yaml", set, 3);
    const bridge *b = &d.bridge;
    pzs_electrodes tables = {PZS_TABLE_FORMAT,  0,  0, (uint16_t)b->electrodes, b->electrode_input,
                             b->electrode_open, {0}};
    pzs_real *direct = round_rows(&b->direct, &tables.direct),
             *charge = calloc((size_t)b->electrodes, sizeof *charge);
    tables.crc = pzs_electrode_crc(&tables, (uint32_t)b->input.count);
    const size_t bytes = PZS_ELECTRIC_BYTES(b->electrodes, b->electrodes, b->input.count);
    void *work = malloc(bytes);
    pzs_electric electric;
    assert_int_equal(b->electrodes, 4);
    assert_int_equal(pzs_model_init(&d.model, &d.structure, d.work, d.bytes), PZS_OK);
    assert_int_equal(pzs_electric_init(&electric, &d.model, &tables, work, bytes), PZS_OK);
    assert_int_equal(pzs_electric_factor(&electric), PZS_E_STAGE);
    assert_int_equal(pzs_assemble(&d.model, NULL, NULL), PZS_OK);
    assert_int_equal(pzs_factor(&d.model), PZS_OK);
    assert_int_equal(pzs_electric_factor(&electric), PZS_OK);
    for (int k = 0; k < b->electrodes; k++)
        d.amount[b->electrode_input[k]] = 0;
    assert_int_equal(pzs_open_voltages(&electric, d.amount), PZS_OK);
    assert_int_equal(pzs_charges(&electric, d.amount, charge), PZS_OK);
    for (int k = 0; k < b->electrodes; k++) {
        const int input = b->electrode_input[k];
        assert_true(fabs(b->input_value[input]) > 1);
        assert_true(fabs((double)d.amount[input] - b->input_value[input]) <
                    100 * EPS * fabs(b->input_value[input]));
        assert_true(fabs((double)charge[k]) <
                    100 * EPS *
                        fabs((double)electric.state.sensitivity[k * b->input.count + input] *
                             b->input_value[input]));
    }
    free(direct);
    free(charge);
    free(work);
    device_close(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_stability_published),
        cmocka_unit_test(test_stability_improved),
        cmocka_unit_test(test_influence),
        cmocka_unit_test(test_compact),
        cmocka_unit_test(test_compact_types),
        cmocka_unit_test(test_stiffness_factor),
        cmocka_unit_test(test_held_unknown),
        cmocka_unit_test(test_springs),
        cmocka_unit_test(test_oblique_supports),
        cmocka_unit_test(test_bad_springs),
        cmocka_unit_test(test_misuse),
        cmocka_unit_test(test_load_on_held_unknown),
        cmocka_unit_test(test_load_scaling),
        cmocka_unit_test(test_unsound_tables),
        cmocka_unit_test(test_indices_out_of_range),
        cmocka_unit_test(test_open_electrodes),
    };
    return cmocka_run_group_tests_name("model", tests, NULL, NULL);
}
