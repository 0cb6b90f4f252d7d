/*
 * The nonlinear path in either precision, on tables made in double by the host tools, against the
 * host's answer in double.
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
#include "../../lib/core/linalg.h"
#include "../../lib/nonlinear/nonlinear.h"
#include "../rigs/rounded.h"
#include "../../lib/model/shell.h"

#define IS_FLOAT (PZS_REAL_BITS == 32)
#define COUNT(a) (sizeof(a) / sizeof *(a))

/* ---- a device: the structure rounded to the working precision --------- */

typedef struct device {
    bridge bridge;
    pzs_structure structure;
    pzs_nonlinear tables;
    pzs_model model;
    pzs_solver path;
    pzs_real *owned[ROUNDED_ARRAYS], *given, *amount;
    void *work, *path_work;
} device;

static void round_path(device *d)
{
    const bridge *b = &d->bridge;
    d->given = rounded(b->given_value, 10 * (size_t)b->given_values);
    d->amount = rounded(b->full_input, (size_t)b->input.count);
    d->tables.format = PZS_TABLE_FORMAT;
    d->tables.resultants.values = (uint16_t)b->given_values;
    d->tables.resultants.start = b->given_start;
    d->tables.resultants.element = b->given_element;
    d->tables.resultants.which = b->given_which;
    d->tables.resultants.value = (const pzs_real(*)[10])(const void *)d->given;
    d->tables.crc = pzs_nonlinear_crc(&d->tables, &d->structure);
}

/* Returns the status of pzs_solver_init. */
static pzs_status device_open(device *d, const char *scene, const char *const *set, int sets)
{
    char error[400] = "";
    memset(d, 0, sizeof *d);
    if (bridge_open(&d->bridge, scene, set, sets, error) < 0)
        fail_msg("%s", error);
    const bridge *b = &d->bridge;
    round_structure(b, &d->structure, d->owned);
    round_path(d);
    const size_t bytes =
        PZS_MODEL_BYTES(b->dof, pzs_linalg_reals(b->first_column, (uint32_t)b->dof));
    const size_t path_bytes = PZS_SOLVER_BYTES(b->dof, b->elements, b->input.count);
    d->work = malloc(bytes);
    d->path_work = malloc(path_bytes);
    assert_int_equal(pzs_model_init(&d->model, &d->structure, d->work, bytes), PZS_OK);
    return pzs_solver_init(&d->path, &d->model, &d->tables, d->path_work, path_bytes);
}

static void device_close(device *d)
{
    bridge_close(&d->bridge);
    for (int k = 0; k < ROUNDED_ARRAYS; k++)
        free(d->owned[k]);
    free(d->given);
    free(d->amount);
    free(d->work);
    free(d->path_work);
}

/* Largest error of any unknown, as a displacement of the faces, over the largest displacement. */
static double off(const device *d)
{
    const bridge *b = &d->bridge;
    double most = 0, size = 0;
    for (int n = 0; n < b->nodes; n++)
        for (int k = 0; k < b->dof_per_node; k++) {
            const uint16_t dof = b->node_dof[n * b->dof_per_node + k];
            const double weight = k < 3 ? 1 : (double)d->structure.type[0].thickness;
            if (dof == PZS_CONSTRAINED)
                continue;
            most = fmax(
                most, weight * fabs((double)d->path.info.displacement[dof] - b->displacement[dof]));
            size = fmax(size, weight * fabs(b->displacement[dof]));
        }
    return most / size;
}

typedef struct outcome {
    pzs_status status;
    double condition, error;
    unsigned systems, wanted;
} outcome;

enum { MOST_CHANGES = 3 };

/*
 * Solve a scene on the simulated device.
 *   tolerance  in  largest relative increment to which a device in float settles; a device in
 * double takes the scene's
 */
static outcome run(const char *scene, const char *const *change, double tolerance)
{
    int sets = 0;
    device d;
    outcome o;
    while (sets < MOST_CHANGES && change[sets])
        sets++;
    memset(&o, 0, sizeof o);
    o.status = device_open(&d, scene, change, sets);
    d.path.settings.tolerance = (pzs_real)(IS_FLOAT ? tolerance : d.bridge.tolerance);
    if (o.status == PZS_OK)
        o.status = pzs_equilibrium(&d.path, d.amount);
    o.condition = d.bridge.condition;
    o.error = off(&d);
    o.systems = d.path.info.linear_solves;
    o.wanted = d.bridge.linear_solves;
    print_message("%-24s %-22s %-24s condition %.1e  off by %.1e, %u systems of %u: %s\n", scene,
                  change[0], sets > 1 ? change[1] : "", o.condition, o.error, o.systems, o.wanted,
                  pzs_status_text(o.status));
    device_close(&d);
    return o;
}

typedef struct shell_case {
    const char *scene, *change[MOST_CHANGES];
} shell_case;

#define HEMISPHERE(element, n)                                                                     \
    {                                                                                              \
        "hemisphere",                                                                              \
        {                                                                                          \
            "element=" element, "mesh.theta1.elements=" #n, "mesh.theta2.elements=" #n             \
        }                                                                                          \
    }
/* As thick as told, its forces 200 and the cube of that. */
#define THIN_HEMISPHERE(element, h, force)                                                         \
    {                                                                                              \
        "hemisphere",                                                                              \
        {                                                                                          \
            "element=" element, "layers.0.thickness=" #h,                                          \
                "loads=[{point: {theta1: pi/2, theta2: 0}, u3: -" #force                           \
                "}, {point: {theta1: pi/2, theta2: pi/2}, u3: " #force "}]"                        \
        }                                                                                          \
    }
#define ROLL_UP(element, n)                                                                        \
    {                                                                                              \
        "roll-up",                                                                                 \
        {                                                                                          \
            "element=" element, "mesh.theta1.elements=" #n                                         \
        }                                                                                          \
    }
#define ANNULAR(element, n1, n2)                                                                   \
    {                                                                                              \
        "annular-plate",                                                                           \
        {                                                                                          \
            "element=" element, "mesh.theta1.elements=" #n1, "mesh.theta2.elements=" #n2           \
        }                                                                                          \
    }
/* At its 2.2, near the limit load, a change of load moves the cap 5.5 times as much: roundings too.
 */
#define CAP(element)                                                                               \
    {                                                                                              \
        "tests/rigs/scenes/cap.yaml",                                                              \
        {                                                                                          \
            "element=" element, "loads.0.u3=-2.0/4"                                                \
        }                                                                                          \
    }
#define STRIP "tests/rigs/scenes/strip.yaml"

/* ---- what float does -------------------------------------------------- */

static const shell_case good[] = {
    HEMISPHERE("published", 4),
    HEMISPHERE("published", 8),
    HEMISPHERE("improved", 4),
    ROLL_UP("published", 10),
    ROLL_UP("improved", 10),
    {"hyperboloid", {"element=published", "mesh.theta1.elements=8", "mesh.theta2.elements=8"}},
    {"hyperboloid", {"element=improved", "mesh.theta1.elements=8", "mesh.theta2.elements=8"}},
    {STRIP, {"element=published"}},
    {STRIP, {"element=improved"}},
    CAP("published"),
    CAP("improved"),
};

/*
 * Law: on these shells, of conditions up to 3e7 at rest, a device in float reaches the shape that
 * double reaches to some roundings, if its iterations are to settle to 1e-6; a device in double
 * does what the host does.
 */
static void test_well_conditioned(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT(good); i++) {
        const outcome o = run(good[i].scene, good[i].change, 1e-6);
        assert_int_equal(o.status, PZS_OK);
        assert_true(o.error < (IS_FLOAT ? 8 * (double)PZS_EPSILON : 1e-12));
        assert_true(IS_FLOAT || o.systems == o.wanted);
    }
}

static const shell_case hard[] = {
    HEMISPHERE("improved", 8),
    HEMISPHERE("published", 16),
    HEMISPHERE("improved", 16),
    ROLL_UP("published", 40),
    ROLL_UP("improved", 40),
    ANNULAR("published", 2, 4),
    ANNULAR("published", 6, 12),
    ANNULAR("improved", 2, 4),
    ANNULAR("improved", 6, 12),
    {STRIP, {"element=published", "layers.0.thickness=0.01", "loads.0.u3=0.0025"}},
    {STRIP, {"element=improved", "layers.0.thickness=0.01", "loads.0.u3=0.0025"}},
    THIN_HEMISPHERE("published", 0.02, 25),
    THIN_HEMISPHERE("published", 0.01, 3.125),
    THIN_HEMISPHERE("published", 0.005, 0.390625),
    THIN_HEMISPHERE("improved", 0.02, 25),
    THIN_HEMISPHERE("improved", 0.01, 3.125),
    THIN_HEMISPHERE("improved", 0.005, 0.390625),
};

/* Law: beyond, a shape that is called an equilibrium is one, to ten times the change that the step
 * was to settle to; others are named. */
static void test_ill_conditioned(void **state)
{
    (void)state;
    int refused = 0;
    for (size_t i = 0; i < COUNT(hard); i++) {
        const outcome o = run(hard[i].scene, hard[i].change, 1e-4);
        if (o.status == PZS_OK)
            assert_true(o.error < (IS_FLOAT ? 1e-3 : 1e-12));
        else
            assert_true(o.status >= PZS_E_DIVERGED && o.status <= PZS_E_SOLVES);
        refused += o.status != PZS_OK;
    }
    assert_true(IS_FLOAT || refused == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_well_conditioned),
                                       cmocka_unit_test(test_ill_conditioned)};
    return cmocka_run_group_tests_name("path_precision", tests, NULL, NULL);
}
