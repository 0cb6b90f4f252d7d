/*
 * Laws of vibration modes on the device with open electrodes, in either precision: against the
 * host's modes in double, against exact solutions, on springs with known frequencies, and about an
 * equilibrium; and bad input.
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
#include "../rigs/modes_device.h"

#define BAR "tests/rigs/scenes/coupled-bar.yaml"
#define BIMORPH "tests/rigs/scenes/coupled-bimorph.yaml"
#define PLATE "plate-50-patches"
#define COARSE "mesh.theta1.elements=5;mesh.theta2.elements=5;materials.G1195.permittivity=7.3e-9;"
#define DRIVEN "actuators=[{name: v, drives: [{patches: faces}]}];sensors=[];"

/* ---- against the host ------------------------------------------------- */

typedef struct host_case {
    const char *scene, *changes;
    bridge_circuit circuit;
    int number, open;
    double shift;
} host_case;

static const host_case host_cases[] = {
    {BAR, "", BRIDGE_SCENE, 4, 1, 0},
    {BAR, DRIVEN, BRIDGE_OPEN, 4, 1, 0},
    {BIMORPH, "", BRIDGE_SCENE, 4, 1, 0},
    {BIMORPH, "patches.0.grid=[4, 1];patches.1.grid=[4, 1]", BRIDGE_OPEN, 5, 4, 0},
    {BIMORPH, "supports=[];patches.0.grid=[4, 1];patches.1.grid=[4, 1]", BRIDGE_OPEN, 9, 4, 3e6},
    {PLATE, COARSE, BRIDGE_OPEN, 8, 25, 0},
    {PLATE, COARSE "element=published", BRIDGE_OPEN, 8, 25, 0},
    {"bare-bimorph", "mesh.theta1.elements=12;materials.PVDF.density=1780", BRIDGE_SHORT, 4, 52, 0},
};

/*
 * Bound of the relative error of squared frequency i by rounding of the charges that a mode shape x
 * brings to the open electrodes, and of the force entries of which these are sums: twice the sum
 * over the electrodes of voltage times error of the charge, error of the charge = 2 epsilon (sum
 * over the dof of |force per volt| |x|). A response of the host at an open electrode is this
 * voltage over the squared frequency.
 */
static double charge_rounding_of(const device *d, int i)
{
    const bridge_rows *input = &d->bridge.input;
    const double *shape = d->host.shape + (size_t)i * (size_t)d->bridge.dof;
    double sum = 0;
    for (int k = 0; k < d->host.electrodes; k++) {
        const int j = d->host.electrode_input[k];
        double size = 0;
        for (uint32_t entry = input->start[j]; entry < input->start[j + 1]; entry++)
            size += fabs(input->value[entry] * shape[input->dof[entry]]);
        sum += d->host.is_open[k] ? size * fabs(d->host.response[i * input->count + j]) : 0;
    }
    return 4 * (double)PZS_EPSILON * sum;
}

static void open_case(device *d, const host_case *c)
{
    device_open_at(d, c->scene, c->changes, c->circuit, c->number,
                   PZS_MODES_VECTORS(c->number) + (c->shift > 0 ? 6 : 0), false);
    const pzs_status status = find(d, c->shift);
    if (PZS_IS_ERROR(status))
        fail_msg("%s %s: %s (%d)", c->scene, c->changes, pzs_status_text(status),
                 d->modes.info.where);
    assert_int_equal(d->modes.state.open.count, c->open);
    assert_true(d->modes.info.below == d->modes.info.converged || status == PZS_W_MODE_COUNT);
}

/*
 * Law: frequencies with open electrodes are those of the host in double, to the rounding errors of
 * the sums of strain energies and charges and to the square of the tolerance of the mode shapes.
 */
static void test_host(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof host_cases / sizeof *host_cases; k++) {
        const host_case *c = &host_cases[k];
        device d;
        double worst = 0, largest = 0;
        open_case(&d, c);
        assert_int_equal(d.modes.info.rigid, d.host.rigid);
        for (int i = 0; i < c->number; i++) {
            const double tolerance = (double)d.modes.settings.tolerance,
                         bound =
                             rounding_of(&d) + tolerance * tolerance + charge_rounding_of(&d, i),
                         error = i < d.host.rigid ? square_of(&d, i)
                                                  : fabs(square_of(&d, i) / d.host.square[i] - 1);
            worst = fmax(worst, error / bound);
            largest = fmax(largest, error);
        }
        print_message("    case %zu: %d dof, %d open, %u solves, %u counts, condition %.1e, off by "
                      "%.1e, %.2f of the bound\n",
                      k, d.bridge.dof, c->open, d.modes.info.linear_solves, d.modes.info.counts,
                      (double)d.modes.info.condition, largest, worst);
        assert_true(worst < 1);
        device_close(&d);
    }
}

/*
 * Law: static responses, per unit of charge where the input is an open electrode, are the host's,
 * to the tolerance of the mode shapes.
 */
static void test_response(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof host_cases / sizeof *host_cases; k++) {
        device d;
        open_case(&d, &host_cases[k]);
        const int inputs = d.bridge.input.count;
        pzs_real *response = calloc((size_t)(host_cases[k].number * inputs), sizeof *response);
        assert_non_null(response);
        assert_int_equal(pzs_modes_response(&d.modes, response), PZS_OK);
        for (int j = 0; j < inputs; j++)
            assert_true(d.host.rigid == 0 || isnan((double)response[j]));
        for (int i = d.host.rigid; i < d.host.rigid + 3; i++) {
            double most = 0, same = 0, other = 0;
            for (int j = 0; j < inputs; j++) {
                const double own = (double)response[i * inputs + j],
                             host = d.host.response[i * inputs + j];
                most = fmax(most, fabs(host));
                same = fmax(same, fabs(own - host));
                other = fmax(other, fabs(own + host));
            }
            if (!(fmin(same, other) < 10 * (double)d.modes.settings.tolerance * most))
                fail_msg("case %zu, mode %d: off by %.2e of %.2e", k, i, fmin(same, other), most);
        }
        free(response);
        device_close(&d);
    }
}

/* ---- exact solutions -------------------------------------------------- */

enum { MODES = 3, ELEMENTS = 16 };

/* Squared electric over elastic stiffness of the ceramic of the bar, k31^2/(1 - k31^2). */
static const double coupling_ratio = 12 * 12 / (60e9 * 8e-9);

/*
 * Characteristic function of a bar of one electrode that is fixed at one end, whose root x gives
 * the angular frequency x sqrt(E/density)/length.
 */
static double open_bar(double x)
{
    return x * cos(x) + coupling_ratio * sin(x);
}

static double root_between(double from, double to)
{
    for (int i = 0; i < 200; i++) {
        const double middle = (from + to) / 2;
        if (open_bar(from) * open_bar(middle) > 0)
            from = middle;
        else
            to = middle;
    }
    return from;
}

/*
 * Law: the first three open frequencies of the bar on 16 and 32 elements, extrapolated to the order
 * 2, are the exact ones to the fourth power of the angle by which the mode turns in an element, and
 * to rounding.
 */
static void test_exact_bar(void **state)
{
    double found[2][MODES], rounding = 0;
    (void)state;
    for (int fine = 0; fine < 2; fine++) {
        char changes[80];
        device d;
        snprintf(changes, sizeof changes, "mesh.theta1.elements=%d",
                 fine ? 2 * ELEMENTS : ELEMENTS);
        const host_case c = {BAR, changes, BRIDGE_SCENE, MODES, 1, 0};
        open_case(&d, &c);
        for (int i = 0; i < MODES; i++) {
            found[fine][i] = (double)pzs_modes_frequency(&d.modes, (uint16_t)i);
            rounding = fmax(rounding, rounding_of(&d) + charge_rounding_of(&d, i));
        }
        device_close(&d);
    }
    for (int i = 0; i < MODES; i++) {
        const double pi = 3.14159265358979323846, x = root_between((i + 0.5) * pi, (i + 1) * pi),
                     exact = x * sqrt(60e9 / 7600) / 0.05 / (2 * pi),
                     limit = (4 * found[1][i] - found[0][i]) / 3;
        print_message("    %.4f Hz: error %.1e\n", exact, limit / exact - 1);
        assert_true(fabs(limit / exact - 1) < pow(x / ELEMENTS, 4) + 2 * rounding);
    }
}

/* ---- springs ---------------------------------------------------------- */

enum { DOF = 28, VECTORS = 24 };

/*
 * One element whose 28 dof each stand on a spring of their own, carry a mass of their own and feel
 * the force of electrodes per volt.
 */
typedef struct springs {
    pzs_structure structure;
    pzs_mass mass;
    pzs_model model;
    pzs_modes modes;
    pzs_electrodes electrodes;
    uint16_t element[1][4], type[1], node_dof[DOF], first[DOF], dof[DOF];
    uint32_t start[DOF + 1];
    pzs_real stiffness[SHELL_PACKED(DOF)], matrix[SHELL_PACKED(DOF)], one[DOF], spring[DOF];
    uint16_t input[DOF], force_dof[DOF * DOF], charge_dof[DOF * DOF];
    uint8_t open[DOF];
    uint32_t force_start[DOF + 1], charge_start[DOF + 1];
    pzs_real force[DOF * DOF], charge[DOF * DOF];
    pzs_real work[PZS_MODEL_BYTES(DOF, DOF * 32) / sizeof(pzs_real) + 1];
    pzs_real modes_work[PZS_MODES_BYTES(DOF, VECTORS) / sizeof(pzs_real) + 1];
    pzs_real open_work[PZS_MODES_OPEN_BYTES(DOF, DOF) / sizeof(pzs_real) + 1];
} springs;

/* Seal the tables of the springs, and assemble the model. */
static void springs_begin(springs *o)
{
    assert_int_equal(pzs_structure_seal(&o->structure), PZS_OK);
    assert_int_equal(pzs_mass_seal(&o->mass, &o->structure), PZS_OK);
    assert_int_equal(pzs_electrodes_seal(&o->electrodes, &o->structure), PZS_OK);
    assert_int_equal(pzs_model_init(&o->model, &o->structure, o->work, sizeof o->work), PZS_OK);
    assert_int_equal(pzs_assemble(&o->model, NULL, NULL), PZS_OK);
}

/*
 * Build the springs.
 *   square [DOF]        in  squared frequency of each dof without electrodes; mass 1, 2 or 3
 *   count               in  number of electrodes, all open
 *   force [count][DOF]  in  force of each electrode on each dof per volt
 *   charge [count][count] in  capacitances
 */
static void springs_make(springs *o, const double *square, int count, const double *force,
                         const double *charge)
{
    memset(o, 0, sizeof *o);
    for (uint16_t i = 0; i < DOF; i++) {
        o->element[0][i / 7] = (uint16_t)(i / 7);
        o->node_dof[i] = o->dof[i] = i;
        o->start[i] = i;
        o->one[i] = 1;
        o->matrix[SHELL_PACKED(i) + i] = (pzs_real)(i % 3 + 1);
        o->spring[i] = (pzs_real)(square[i] * (i % 3 + 1));
    }
    o->start[DOF] = DOF;
    for (uint16_t k = 0; k < count; k++) {
        o->input[k] = k;
        o->open[k] = 1;
        for (uint16_t i = 0; i < DOF; i++) {
            o->force_dof[k * DOF + i] = i;
            o->force[k * DOF + i] = (pzs_real)force[k * DOF + i];
        }
        for (uint16_t j = 0; j < count; j++) {
            o->charge_dof[k * count + j] = j;
            o->charge[k * count + j] = (pzs_real)charge[k * count + j];
        }
        o->force_start[k + 1] = (k + 1u) * DOF;
        o->charge_start[k + 1] = (k + 1u) * (uint32_t)count;
    }
    o->structure =
        (pzs_structure){.nodes = 4,
                        .elements = 1,
                        .types = 1,
                        .dof_per_node = 7,
                        .free_dof = DOF,
                        .element = (const uint16_t(*)[4])o->element,
                        .element_type = o->type,
                        .node_dof = o->node_dof,
                        .first_column = o->first,
                        .stiffness = o->stiffness,
                        .input = {(uint16_t)count, o->force_start, o->force_dof, o->force},
                        .spring = {DOF, o->start, o->dof, o->one},
                        .spring_stiffness = o->spring};
    o->mass.types = 1;
    o->mass.element_type = o->type;
    o->mass.matrix = o->matrix;
    o->electrodes.count = (uint16_t)count;
    o->electrodes.input = o->input;
    o->electrodes.open = o->open;
    o->electrodes.direct = (pzs_rows){(uint16_t)count, o->charge_start, o->charge_dof, o->charge};
    springs_begin(o);
}

/* Prepare a search for `number` modes. */
static void springs_init(springs *o, uint16_t number)
{
    assert_int_equal(pzs_modes_init(&o->modes, &o->model, &o->mass, number, VECTORS, o->modes_work,
                                    sizeof o->modes_work),
                     PZS_OK);
}

static pzs_status springs_open(springs *o, const uint8_t *is_open)
{
    return pzs_modes_open_electrodes(&o->modes, &o->electrodes, is_open, o->open_work,
                                     sizeof o->open_work);
}

/* Find `number` modes with the electrodes open. */
static void springs_find(springs *o, uint16_t number)
{
    springs_init(o, number);
    assert_int_equal(springs_open(o, NULL), PZS_OK);
    assert_int_equal(pzs_assemble(&o->model, NULL, NULL), PZS_OK);
    assert_int_equal(pzs_factor(&o->model), PZS_OK);
    const pzs_status status = pzs_modes_find(&o->modes);
    if (status != PZS_OK)
        fail_msg("%s (%d)", pzs_status_text(status), o->modes.info.where);
}

/*
 * Whether the first squared frequencies are those expected. The projection onto the Lanczos vectors
 * has a rounding error for each of them, relative to its largest eigenvalue.
 *   condition in  number by which further rounding errors are multiplied
 */
static void assert_squares(const springs *o, const double *expected, int number, double condition)
{
    const double tolerance = (double)o->modes.settings.tolerance;
    for (int i = 0; i < number; i++)
        if (!(fabs((double)o->modes.info.square[i] / expected[i] - 1) <
              4 * (double)PZS_EPSILON *
                      (o->modes.state.vectors * expected[i] / expected[0] + condition) +
                  tolerance * tolerance))
            fail_msg("mode %d: %.9g instead of %.9g", i, (double)o->modes.info.square[i],
                     expected[i]);
}

/* Law: without an open electrode the modes have the bits of a search that knows no electrodes. */
static void test_all_short(void **state)
{
    static const uint8_t none[25];
    device d;
    pzs_real before[5], *shape;
    (void)state;
    device_open_at(&d, PLATE, COARSE, BRIDGE_OPEN, 5, 18, false);
    const size_t bytes = 5 * (size_t)d.bridge.dof * sizeof *shape;
    shape = malloc(bytes);
    assert_non_null(shape);
    assert_int_equal(pzs_factor(&d.model), PZS_OK);
    for (int round = 0; round < 3; round++) {
        if (round > 0)
            assert_int_equal(pzs_modes_open_electrodes(&d.modes, &d.electrodes,
                                                       round == 1 ? none : NULL, NULL, 0),
                             PZS_OK);
        else
            assert_int_equal(
                pzs_modes_init(&d.modes, &d.model, &d.mass, 5, 18, d.modes_work, d.modes_bytes),
                PZS_OK);
        assert_int_equal(d.modes.settings.solve_limit, 200);
        assert_false(PZS_IS_ERROR(pzs_modes_find(&d.modes)));
        if (round == 0) {
            memcpy(before, d.modes.info.square, sizeof before);
            memcpy(shape, d.modes.info.shape, bytes);
        }
        assert_memory_equal(before, d.modes.info.square, sizeof before);
        assert_memory_equal(shape, d.modes.info.shape, bytes);
    }
    free(shape);
    device_close(&d);
}

/* Law: the search leaves the factors at prescribed voltages as it found them, to the bit. */
static void test_factors_remain(void **state)
{
    device d;
    (void)state;
    device_open_at(&d, PLATE, COARSE, BRIDGE_OPEN, 5, 18, false);
    const size_t reals = pzs_linalg_reals(d.bridge.first_column, (uint32_t)d.bridge.dof);
    assert_int_equal(pzs_factor(&d.model), PZS_OK);
    pzs_real *before = malloc(reals * sizeof *before);
    assert_non_null(before);
    memcpy(before, d.model.state.stiffness.value, reals * sizeof *before);
    assert_false(PZS_IS_ERROR(pzs_modes_find(&d.modes)));
    assert_int_equal(d.modes.info.counts > 0, d.modes.info.below > 0);
    assert_memory_equal(before, d.model.state.stiffness.value, reals * sizeof *before);
    free(before);
    device_close(&d);
}

/*
 * Law: an electrode of capacitance c and force b per volt on a dof of stiffness k and mass m leaves
 * it the squared frequency (k + b^2/c)/m; here one for each dof, of every choice of open ones.
 */
static void test_each_dof(void **state)
{
    double square[DOF], force[DOF * DOF] = {0}, charge[DOF * DOF] = {0}, expected[DOF];
    (void)state;
    for (int period = 1; period <= 4; period++) {
        springs o;
        uint8_t is_open[DOF];
        for (int i = 0; i < DOF; i++) {
            square[i] = 1 + i;
            force[i * DOF + i] = 3 * (i % 3 + 1);
            charge[i * DOF + i] = 4 * (i % 3 + 1);
            is_open[i] = i % period == 0;
            expected[i] = square[i] + (is_open[i] ? 2.25 : 0);
        }
        for (int i = 1; i < DOF; i++)
            for (int j = i; j > 0 && expected[j] < expected[j - 1]; j--) {
                const double swapped = expected[j];
                expected[j] = expected[j - 1];
                expected[j - 1] = swapped;
            }
        springs_make(&o, square, DOF, force, charge);
        springs_init(&o, 8);
        assert_int_equal(springs_open(&o, is_open), PZS_OK);
        assert_int_equal(o.modes.state.open.count, (DOF + period - 1) / period);
        assert_int_equal(pzs_factor(&o.model), PZS_OK);
        assert_int_equal(pzs_modes_find(&o.modes), PZS_OK);
        assert_int_equal(o.modes.info.below, o.modes.info.converged);
        assert_squares(&o, expected, 8, 1);
    }
}

/* Law: an electrode without force has no effect: the bits are those of the short-circuited one. */
static void test_no_coupling(void **state)
{
    static const uint8_t none[1];
    double square[DOF];
    const double force[DOF] = {0}, charge = 2;
    springs o;
    pzs_real before[6];
    (void)state;
    for (int i = 0; i < DOF; i++)
        square[i] = 1 + i / 2;
    springs_make(&o, square, 1, force, &charge);
    springs_find(&o, 6);
    assert_squares(&o, square, 6, 1);
    memcpy(before, o.modes.info.square, sizeof before);
    assert_int_equal(springs_open(&o, none), PZS_OK);
    assert_int_equal(pzs_modes_find(&o.modes), PZS_OK);
    assert_memory_equal(before, o.modes.info.square, sizeof before);
}

/*
 * Law: two electrodes of nearly the same force and charge, C = c ((1, 1 - d), (1 - d, 1)), stiffen
 * by 2 b^2/(c (2 - d)). The error is that of the difference d, and where it is a rounding error the
 * second electrode is refused.
 */
static void test_near_electrodes(void **state)
{
    const double least = 16 * (double)PZS_EPSILON;
    double square[DOF], force[2 * DOF] = {0};
    springs o;
    (void)state;
    for (int i = 0; i < DOF; i++)
        square[i] = 4 + i;
    force[0] = force[DOF] = 2;
    for (double d = 0.5; d > least; d /= 4) {
        const double charge[4] = {1, 1 - d, 1 - d, 1};
        double expected[DOF];
        memcpy(expected, square, sizeof expected);
        expected[0] += 8 / (2 - d);
        for (int i = 0; i + 1 < DOF && expected[i] > expected[i + 1]; i++) {
            const double swapped = expected[i];
            expected[i] = expected[i + 1];
            expected[i + 1] = swapped;
        }
        springs_make(&o, square, 2, force, charge);
        springs_find(&o, 6);
        assert_squares(&o, expected, 6, 1 / d);
    }
    const double same[4] = {1, 1, 1, 1};
    springs_make(&o, square, 2, force, same);
    springs_init(&o, 6);
    assert_int_equal(springs_open(&o, NULL), PZS_E_CAPACITANCE);
    assert_int_equal(o.modes.info.where, 1);
}

/*
 * Law: no mode is missed. Electrodes raise the lowest dofs above the others, and the start vector
 * has no part in the modes that are then the lowest: the count finds them.
 */
static void test_count(void **state)
{
    double square[DOF], force[3 * DOF] = {0}, charge[9] = {0}, expected[DOF];
    pzs_real start[DOF] = {0};
    springs o;
    (void)state;
    for (int i = 0; i < DOF; i++)
        square[i] = 1 + i;
    for (int k = 0; k < 3; k++) {
        force[k * DOF + k] = 10 * (k % 3 + 1);
        charge[4 * k] = k % 3 + 1;
    }
    for (int i = 0; i < DOF - 3; i++)
        expected[i] = square[i + 3];
    springs_make(&o, square, 3, force, charge);
    springs_init(&o, 2);
    assert_int_equal(springs_open(&o, NULL), PZS_OK);
    start[5] = start[6] = 1;
    o.modes.settings.start = start;
    assert_int_equal(pzs_factor(&o.model), PZS_OK);
    assert_int_equal(pzs_modes_find(&o.modes), PZS_OK);
    assert_int_equal(o.modes.info.below, o.modes.info.converged);
    assert_squares(&o, expected, 2, 1);
}

/*
 * Law: frequencies that come up to nine times, half of them by electrodes, are found in every
 * number; some only after a count has shown that modes are missing.
 */
static void test_repeated(void **state)
{
    double force[DOF * DOF] = {0}, charge[DOF * DOF] = {0};
    int recounted = 0;
    (void)state;
    for (int i = 0; i < DOF; i++) {
        force[i * DOF + i] = i % 2 ? 3 * (i % 3 + 1) : 0;
        charge[i * DOF + i] = 4 * (i % 3 + 1);
    }
    for (int times = 1; times <= 9; times += 2) {
        double square[DOF], expected[DOF];
        springs o;
        for (int i = 0; i < DOF; i++) {
            expected[i] = 4 * pow(1 + i / times, 2);
            square[i] = expected[i] - (i % 2 ? 2.25 : 0);
        }
        springs_make(&o, square, DOF, force, charge);
        for (uint16_t number = 1; number <= 11; number++) {
            springs_find(&o, number);
            assert_squares(&o, expected, number, 1);
            assert_int_equal(o.modes.info.converged, o.modes.info.below);
            recounted += o.modes.info.counts > 1;
        }
    }
    assert_true(recounted > 0);
}

/*
 * Law: what is unstable at prescribed voltages may be stable with open electrodes, as the pivots of
 * both matrices together say, and with a capacitance that is too large it is not. Two dofs have the
 * stiffness ((5, 6), (6, 5)), and the electrode acts along (1, -1), where that is -1.
 */
static void test_stabilised(void **state)
{
    static const double expected[4] = {3, 6, 7, 9};
    double square[DOF], force[DOF] = {0};
    (void)state;
    for (int i = 0; i < DOF; i++)
        square[i] = i == 3 ? 5 : 5 + i;
    force[0] = sqrt(2);
    force[3] = -force[0];
    for (int stable = 0; stable < 2; stable++) {
        springs o;
        const double charge = stable ? 1 : 8;
        springs_make(&o, square, 1, force, &charge);
        o.stiffness[SHELL_PACKED(3)] = 6;
        springs_begin(&o);
        springs_init(&o, 4);
        o.modes.settings.shift = (pzs_real)0.25;
        assert_int_equal(pzs_modes_find(&o.modes), PZS_E_NEGATIVE);
        assert_int_equal(springs_open(&o, NULL), PZS_OK);
        if (!stable) {
            assert_int_equal(pzs_modes_find(&o.modes), PZS_E_NEGATIVE);
            assert_int_equal(o.modes.info.where, 3);
            continue;
        }
        assert_int_equal(pzs_modes_find(&o.modes), PZS_OK);
        assert_int_equal(o.modes.info.below, o.modes.info.converged);
        assert_squares(&o, expected, 4, 12);
    }
}

/* ---- about an equilibrium ----------------------------------------------- */

#define BENT "kinematics=nonlinear;loads=[{line: theta1+, u3: 3e5}];"
#define THICK "layers.0.thickness=5e-3;layers.1.thickness=5e-3;"
#define FOUR "patches.0.grid=[4, 1];patches.1.grid=[4, 1];"
#define COLUMN "tests/rigs/scenes/open-column.yaml"

static const host_case bent_cases[] = {
    {BIMORPH, BENT THICK, BRIDGE_SCENE, 4, 1, 0},
    {BIMORPH, BENT THICK FOUR, BRIDGE_SCENE, 4, 4, 0},
    {BIMORPH, BENT THICK FOUR, BRIDGE_SCENE, 4, 4, 1e8},
    {BIMORPH, BENT THICK FOUR, BRIDGE_SHORT, 4, 0, 0},
};

/*
 * Find the modes about the equilibrium, and check that they are the host's, to the rounding errors
 * of unrefined linear solves: condition number times machine epsilon.
 */
static void check_at(bent_device *d, const host_case *c)
{
    pzs_modes *modes = &d->device.modes;
    double worst = 0;
    assert_int_equal(modes->state.open.count, c->open);
    modes->settings.shift = (pzs_real)c->shift;
    const pzs_status status = pzs_modes_find_at(modes, &d->solver);
    if (PZS_IS_ERROR(status))
        fail_msg("%s %s: %s (%d)", c->scene, c->changes, pzs_status_text(status),
                 modes->info.where);
    for (int i = 0; i < c->number; i++)
        worst = fmax(worst, fabs(square_of(&d->device, i) / d->device.host.square[i] - 1));
    const double bound = 4 * (double)PZS_EPSILON * (double)modes->info.condition;
    print_message("    %d open, off by %.1e of %.1e, %u solves, %.6g Hz\n", c->open, worst, bound,
                  modes->info.linear_solves, (double)pzs_modes_frequency(modes, 0));
    assert_true(worst < bound);
}

/* Law: modes with open electrodes about an equilibrium are those of the host there. */
static void test_equilibrium(void **state)
{
    (void)state;
    for (size_t k = 0; k < sizeof bent_cases / sizeof *bent_cases; k++) {
        const host_case *c = &bent_cases[k];
        bent_device d;
        assert_int_equal(bent_open(&d, c->scene, c->changes, c->circuit, c->number), PZS_OK);
        check_at(&d, c);
        bent_close(&d);
    }
}

/*
 * Law: a column under 1.1 times the load at which it would buckle short-circuited vibrates about
 * its equilibrium with open electrodes, which carry 1.3 times that load, and is unstable without
 * them.
 */
static void test_stable_column(void **state)
{
    const host_case c = {COLUMN, "loads.0.u1=-22.618;materials.m.density=1", BRIDGE_SCENE, 3, 16,
                         0};
    bent_device d;
    (void)state;
    if (IS_FLOAT) /* The column is too slender for unrefined solves in float. */
        return;
    assert_int_equal(bent_open(&d, c.scene, c.changes, c.circuit, c.number), PZS_OK);
    check_at(&d, &c);
    assert_int_equal(d.device.modes.info.below, d.device.modes.info.converged);
    const uint8_t none[16] = {0};
    assert_int_equal(
        pzs_modes_open_electrodes(&d.device.modes, &d.device.electrodes, none, NULL, 0), PZS_OK);
    assert_int_equal(pzs_modes_find_at(&d.device.modes, &d.solver), PZS_E_NEGATIVE);
    bent_close(&d);
}

/* ---- bad input -------------------------------------------------------- */

/* Law: an open electrode without a positive and finite capacitance is refused by its index. */
static void test_bad_capacitance(void **state)
{
    static const struct {
        double charge;
        pzs_status status;
    } bad[] = {{0, PZS_E_CAPACITANCE},
               {-1, PZS_E_CAPACITANCE},
               {(double)NAN, PZS_E_NONFINITE},
               {HUGE_VAL, PZS_E_NONFINITE}};
    double square[DOF], force[3 * DOF] = {0};
    (void)state;
    for (int i = 0; i < DOF; i++)
        square[i] = 1 + i;
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        static const uint8_t others[3] = {1, 0, 1};
        const double charge[9] = {1, 0, 0, 0, bad[k].charge, 0, 0, 0, 1};
        springs o;
        springs_make(&o, square, 3, force, charge);
        springs_init(&o, 4);
        assert_int_equal(springs_open(&o, NULL), bad[k].status);
        assert_int_equal(o.modes.info.where, 1);
        assert_int_equal(pzs_factor(&o.model), PZS_OK);
        assert_int_equal(pzs_modes_find(&o.modes), PZS_OK);
        assert_squares(&o, square, 4, 1);
        assert_int_equal(springs_open(&o, others), PZS_OK);
        assert_int_equal(o.modes.info.where, -1);
    }
}

/*
 * Law: null pointers, foreign or damaged tables and a byte of memory less are errors that change
 * nothing.
 */
static void test_bad_call(void **state)
{
    const double force[DOF] = {2}, charge = 1, expected[1] = {5};
    double square[DOF];
    springs o;
    pzs_modes *const modes = &o.modes;
    const size_t bytes = PZS_MODES_OPEN_BYTES(DOF, 1);
    (void)state;
    for (int i = 0; i < DOF; i++)
        square[i] = i == 0 ? 1 : 9 + i;
    springs_make(&o, square, 1, force, &charge);
    void *const work = o.open_work;
    assert_int_equal(springs_open(&o, NULL), PZS_E_STAGE);
    springs_init(&o, 1);
    assert_int_equal(springs_open(&o, NULL), PZS_OK);
    pzs_electrodes damaged = o.electrodes;
    assert_int_equal(pzs_modes_open_electrodes(NULL, &damaged, NULL, work, bytes), PZS_E_ARGUMENT);
    assert_int_equal(pzs_modes_open_electrodes(modes, NULL, NULL, work, bytes), PZS_E_ARGUMENT);
    assert_int_equal(pzs_modes_open_electrodes(modes, &damaged, NULL, NULL, bytes), PZS_E_ARGUMENT);
    assert_int_equal(pzs_modes_open_electrodes(modes, &damaged, NULL, work, bytes - 1),
                     PZS_E_WORKSPACE);
    assert_int_equal(modes->info.where, (int)bytes);
    assert_int_equal(pzs_modes_open_electrodes(modes, &damaged, NULL, (char *)work + 1, bytes),
                     PZS_E_WORKSPACE);
    damaged.crc ^= 1u;
    assert_int_equal(pzs_modes_open_electrodes(modes, &damaged, NULL, work, bytes), PZS_E_CRC);
    damaged.scene++;
    assert_int_equal(pzs_modes_open_electrodes(modes, &damaged, NULL, work, bytes), PZS_E_FORMAT);
    o.input[0] = 1;
    damaged = o.electrodes;
    assert_int_equal(pzs_electrodes_seal(&damaged, &o.structure), PZS_OK);
    assert_int_equal(pzs_modes_open_electrodes(modes, &damaged, NULL, work, bytes), PZS_E_ARGUMENT);
    o.input[0] = 0;
    assert_int_equal(pzs_factor(&o.model), PZS_OK);
    assert_int_equal(pzs_modes_find(modes), PZS_OK);
    assert_squares(&o, expected, 1, 1);
    assert_int_equal(springs_open(&o, NULL), PZS_OK);
    pzs_real response;
    assert_int_equal(pzs_modes_response(modes, &response), PZS_E_STAGE);
}

/* Law: the search ends at its limit on linear solves, which counts both solves of a step. */
static void test_solve_limit(void **state)
{
    device d;
    (void)state;
    device_open_at(&d, PLATE, COARSE, BRIDGE_OPEN, 5, 18, false);
    assert_int_equal(d.modes.settings.solve_limit, 2 * (100 + 20 * 5) + 25);
    assert_int_equal(pzs_factor(&d.model), PZS_OK);
    d.modes.settings.solve_limit = 25 + 7;
    assert_int_equal(pzs_modes_find(&d.modes), PZS_E_MODES);
    assert_int_equal(d.modes.info.linear_solves, 25 + 8);
    device_close(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_host),           cmocka_unit_test(test_response),
        cmocka_unit_test(test_exact_bar),      cmocka_unit_test(test_all_short),
        cmocka_unit_test(test_factors_remain), cmocka_unit_test(test_each_dof),
        cmocka_unit_test(test_no_coupling),    cmocka_unit_test(test_near_electrodes),
        cmocka_unit_test(test_count),          cmocka_unit_test(test_repeated),
        cmocka_unit_test(test_stabilised),     cmocka_unit_test(test_stable_column),
        cmocka_unit_test(test_equilibrium),    cmocka_unit_test(test_bad_capacitance),
        cmocka_unit_test(test_bad_call),       cmocka_unit_test(test_solve_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
