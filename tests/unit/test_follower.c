/*
 * Follower loads in either precision, on small shells made here; what every option and choice of a
 * path must be.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../../lib/model/model.h"
#include "../rigs/shell_rig.h"

/* ---- follower loads ----------------------------------------------------- */

/* What counts of the lean x of each chord: (1 - x cot x)/x. */
static void count_lean(rig *g)
{
    const double z = g->follower.normal_face ? g->thickness / 2 : -g->thickness / 2;
    for (int r = 0; r < 4; r++)
        for (int a = 0; a < 2; a++) {
            double chord[3];
            for (int i = 0; i < 3; i++)
                chord[i] = (double)g->type.g_mean[r][a][i] + z * (double)g->type.g_diff[r][a][i];
            const double flat = hypot(chord[0], chord[1]), x = atan2(chord[2], flat);
            g->lean[0][r][a] = (pzs_real)(fabs(x) > 1e-6 ? flat * (1 / x - 1 / tan(x)) : 0);
        }
    g->follower.lean = (const pzs_real(*)[4][2])g->lean;
}

static void follower_force(rig *g, pzs_real *force)
{
    memset(force, 0, (size_t)g->dof * sizeof *force);
    g->follower_load.option.call->add_unit_force(&g->follower_load.option, &g->solver, 1, force);
}

/* Largest difference of the added matrix from minus the symmetric part of dF/dU, over the largest
 * entry. */
static double tangent_error(rig *g, double step)
{
    const int n = g->dof;
    pzs_real *derivative = calloc((size_t)n * (size_t)n, sizeof *derivative),
             *f = calloc(2 * (size_t)n, sizeof *f);
    double worst = 0, largest = 0;
    for (int j = 0; j < n; j++) {
        const pzs_real at = g->solver.info.displacement[j];
        volatile pzs_real ahead = at + (pzs_real)step, behind = at - (pzs_real)step;
        g->solver.state.displacement[j] = ahead;
        follower_force(g, f);
        g->solver.state.displacement[j] = behind;
        follower_force(g, f + n);
        g->solver.state.displacement[j] = at;
        for (int i = 0; i < n; i++)
            derivative[i * n + j] = (f[i] - f[n + i]) / (ahead - behind);
    }
    g->solver.state.input_value[1] = 1;
    pzs_linalg_clear(&g->model.state.stiffness);
    memset(f, 0, (size_t)n * sizeof *f);
    g->follower_load.option.call->add_forces(&g->follower_load.option, &g->solver, f);
    follower_force(g, f + n);
    assert_memory_equal(f, f + n, (size_t)n * sizeof *f);
    for (int i = 0; i < n; i++)
        for (int j = g->first_column[i]; j <= i; j++) {
            const double wanted = -(double)(derivative[i * n + j] + derivative[j * n + i]) / 2;
            worst = fmax(worst, fabs((double)*pzs_linalg_entry(&g->model.state.stiffness,
                                                               (uint32_t)i, (uint32_t)j) -
                                     wanted));
            largest = fmax(largest, fabs(wanted));
        }
    free(derivative);
    free(f);
    return worst / largest;
}

static void tangent_is_the_symmetric_part_of_the_derivative(void **state)
{
    (void)state;
    for (int radius = 0; radius < 2; radius++)
        for (int load_face = 0; load_face < 3; load_face++)
            for (int kind = 0; kind < 8; kind++) {
                rig *g = rig_open(2, 2, radius, 0.5, 0.7, 0.1, 0, nothing, 0);
                attach_follower(g, load_face, kind / 2 % 2, kind % 2);
                if (kind / 4)
                    count_lean(g);
                set_random(g, 0.2);
                /* True area is quadratic in u; the unit normal leaves step^2 of its third
                 * derivative, eta being about 1. */
                const double step = kind % 2 ? 0.2 : cbrt(EPS), rounding = 100 * EPS / step;
                assert_true(tangent_error(g, step) <
                            (kind % 2 ? rounding : rounding + 100 * step * step));
                rig_close(g);
            }
}

/* y = what the symmetric matrix and the skew part that goes with it make of x: the derivative of
 * the force along x. */
static void derivative_along(rig *g, const pzs_real *x, pzs_real *y)
{
    memset(y, 0, (size_t)g->dof * sizeof *y);
    pzs_linalg_clear(&g->model.state.stiffness);
    g->solver.state.input_value[1] = 1;
    g->follower_load.option.call->add_forces(&g->follower_load.option, &g->solver, y);
    memset(y, 0, (size_t)g->dof * sizeof *y);
    for (int i = 0; i < g->dof; i++)
        for (int j = g->first_column[i]; j <= i; j++) {
            const pzs_real k =
                *pzs_linalg_entry(&g->model.state.stiffness, (uint32_t)i, (uint32_t)j);
            y[i] -= k * x[j];
            y[j] -= j < i ? k * x[i] : 0;
        }
    g->follower_load.option.call->add_skew(&g->follower_load.option, &g->solver, x, 1, y);
}

static void skew_part_completes_the_derivative(void **state)
{
    (void)state;
    for (int load_face = 0; load_face < 3; load_face++)
        for (int kind = 0; kind < 8; kind++) {
            rig *g = rig_open(2, 2, 1, 0.5, 0.7, 0.1, 0, nothing, 0);
            const size_t n = (size_t)g->dof;
            pzs_real *x = calloc(5 * n, sizeof *x), *y = x + n, *f = y + n, *middle = f + 2 * n;
            double worst = 0, largest = 0, along = 0;
            attach_follower(g, load_face, kind / 2 % 2, kind % 2);
            if (kind / 4)
                count_lean(g);
            set_random(g, 0.2);
            for (size_t i = 0; i < n; i++) {
                x[i] = (pzs_real)uniform();
                middle[i] = g->solver.info.displacement[i];
            }
            derivative_along(g, x, y);
            const double step = kind % 2 ? 0.2 : 0.3 * cbrt(EPS), rounding = 200 * EPS / step;
            for (int side = 0; side < 2; side++) {
                for (size_t i = 0; i < n; i++)
                    g->solver.state.displacement[i] =
                        middle[i] + (pzs_real)(side ? step : -step) * x[i];
                follower_force(g, f + (size_t)side * n);
            }
            for (size_t i = 0; i < n; i++) {
                worst = fmax(worst, fabs((double)(f[n + i] - f[i]) / (2 * step) - (double)y[i]));
                largest = fmax(largest, fabs((double)y[i]));
            }
            assert_true(worst < (kind % 2 ? rounding : rounding + 100 * step * step) * largest);
            /* A skew matrix takes no work out of any motion. */
            memset(y, 0, n * sizeof *y);
            g->follower_load.option.call->add_skew(&g->follower_load.option, &g->solver, x, 1, y);
            for (size_t i = 0; i < n; i++)
                along += (double)x[i] * (double)y[i];
            assert_true(fabs(along) < 100 * EPS * largest);
            free(x);
            rig_close(g);
        }
}

/* Set path->u to a rotation about the origin by a unit vector q and angle. */
static void rotate(rig *g, const double q[3], double angle, double turn[3][3])
{
    const double c = cos(angle), s = sin(angle),
                 cross[3][3] = {{0, -q[2], q[1]}, {q[2], 0, -q[0]}, {-q[1], q[0], 0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            turn[i][j] = c * (i == j) + s * cross[i][j] + (1 - c) * q[i] * q[j];
    for (int n = 0; n < g->nodes; n++)
        for (int k = 0; k < 6; k++) {
            const double *v = k < 3 ? g->position[n] : g->frame[n][2];
            const double moved[3] = {dot(turn[0], v) - v[0], dot(turn[1], v) - v[1],
                                     dot(turn[2], v) - v[2]};
            g->solver.state.displacement[g->node_dof[n][k]] =
                (pzs_real)dot(g->frame[n][k % 3], moved);
        }
}

/* Force on a node in global axes; from = 3: what goes with its difference. */
static void force_at(const rig *g, const pzs_real *force, int n, int from, double global[3])
{
    for (int i = 0; i < 3; i++) {
        global[i] = 0;
        for (int k = 0; k < 3; k++)
            global[i] += g->frame[n][k][i] * (double)force[g->node_dof[n][from + k]];
    }
}

/* A rigid rotation turns every nodal force with it and changes no size, for the unit normal and for
 * true area. */
static void force_turns_with_the_shell(void **state)
{
    (void)state;
    const double q[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
    for (int radius = 0; radius < 2; radius++)
        for (int kind = 0; kind < 4; kind++) {
            const int true_area = kind % 2;
            rig *g = rig_open(3, 2, radius, 0.5, 0.7, 0.1, 0, nothing, 0);
            pzs_real *rest = calloc(2 * (size_t)g->dof, sizeof *rest), *turned = rest + g->dof;
            double turn[3][3];
            attach_follower(g, 0, 1, true_area);
            if (kind / 2)
                count_lean(g);
            follower_force(g, rest);
            rotate(g, q, 2, turn);
            follower_force(g, turned);
            for (int n = 0; n < g->nodes; n++) {
                double before[3], after[3];
                force_at(g, rest, n, 0, before);
                force_at(g, turned, n, 0, after);
                for (int i = 0; i < 3; i++)
                    assert_true(fabs(after[i] - dot(turn[i], before)) < 100 * EPS);
            }
            free(rest);
            rig_close(g);
        }
}

/* On a flat patch the pressure at rest adds up to p A along e3; stretched by a and b, true pressure
 * to p A a b. */
static void pressure_on_a_flat_patch_is_its_area(void **state)
{
    (void)state;
    rig *g = rig_open(3, 2, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    pzs_real *f = calloc((size_t)g->dof, sizeof *f);
    attach_follower(g, 0, 0, 1);
    for (int stretched = 0; stretched < 2; stretched++) {
        double sum[3] = {0, 0, 0};
        for (int n = 0; n < g->nodes && stretched; n++) {
            g->solver.state.displacement[g->node_dof[n][0]] = (pzs_real)(0.3 * g->position[n][0]);
            g->solver.state.displacement[g->node_dof[n][1]] = (pzs_real)(0.2 * g->position[n][1]);
        }
        follower_force(g, f);
        for (int n = 0; n < g->nodes; n++)
            for (int i = 0; i < 3; i++)
                sum[i] += (double)f[g->node_dof[n][i]];
        const double area = 1.5 * 1.4 * (stretched ? 1.3 * 1.2 : 1);
        assert_true(fabs(sum[0]) < 50 * EPS && fabs(sum[1]) < 50 * EPS &&
                    fabs(sum[2] - area) < 50 * EPS);
    }
    free(f);
    rig_close(g);
}

/* The published weights: a pressure on one corner gives 4, 2, 1, 2 parts of 36 to it, its
 * neighbours, the opposite corner. */
static void pressure_is_shared_with_consistent_weights(void **state)
{
    (void)state;
    rig *g = rig_open(1, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    pzs_real *f = calloc((size_t)g->dof, sizeof *f);
    attach_follower(g, 2, 0, 0);
    for (int k = 0; k < 3; k++)
        g->follower.share[k] = (pzs_real)((4 >> k) / 36.0);
    for (int from = 0; from < 4; from++) {
        static const double part[4] = {4, 2, 1, 2};
        memset(g->pressure, 0, sizeof g->pressure);
        g->pressure[g->element[0][from]] = 36;
        follower_force(g, f);
        for (int r = 0; r < 4; r++) {
            const uint16_t *dof = g->node_dof[g->element[0][r]];
            assert_true(fabs((double)f[dof[2]] - 0.35 * part[(r - from + 4) % 4]) < 20 * EPS);
            assert_true(f[dof[5]] == 0); /* half on each face */
        }
    }
    free(f);
    rig_close(g);
}

/*
 * Pressure p on an arc of radius R from angle 0 to phi, cut into any number of sides: the resultant
 * is that on its chord, 2 p R sin(phi/2) across it, with the moment p R^2 (1 - cos phi) about an
 * end, on whatever face it acts.
 */
static void pressure_on_an_arc_is_that_on_its_chord(void **state)
{
    (void)state;
    for (int n = 1; n <= 16; n *= 2)
        for (int load_face = 0; load_face < 3; load_face++) {
            const double phi = 2, width = 0.7, exact[3] = {1 - cos(phi), sin(phi), 1 - cos(phi)};
            rig *g = rig_open(n, 1, 1, phi / n, width, 0.1, 0, nothing, 0);
            pzs_real *f = calloc((size_t)g->dof, sizeof *f);
            double got[3] = {0, 0, 0}; /* along x, against z, moment about the first node */
            attach_follower(g, load_face, 1, 0);
            count_lean(g);
            follower_force(g, f);
            for (int i = 0; i < g->nodes; i++) {
                const double arm[2] = {g->position[i][0] - g->position[0][0],
                                       g->position[i][2] - g->position[0][2]};
                double force[3], couple[3];
                force_at(g, f, i, 0, force);
                force_at(g, f, i, 3, couple);
                got[0] += force[0] / width;
                got[1] -= force[2] / width;
                got[2] += (arm[0] * force[2] - arm[1] * force[0]) / width;
                got[2] += (g->frame[i][2][0] * couple[2] - g->frame[i][2][2] * couple[0]) / width;
            }
            for (int i = 0; i < 3; i++)
                assert_true(fabs(fabs(got[i]) - fabs(exact[i])) < 100 * EPS);
            free(f);
            rig_close(g);
        }
}

/*
 * A closed ring, pushed anyhow in its plane: true pressure is a closed polygon turned by 90 degrees
 * and adds up to 0, and so does what counts of the lean, of two neighbours along their one
 * director.
 */
static void closed_ring_adds_up(int leaning)
{
    rig *g = rig_open(12, 1, 1, 2 * acos(-1.0) / 12, 0.5, 0.1, 1, nothing, 0);
    pzs_real *f = calloc((size_t)g->dof, sizeof *f);
    attach_follower(g, 0, 1, 1);
    if (leaning)
        count_lean(g);
    for (int i = 0; i < 12; i++)
        for (int k = 0; k < 6; k++) {
            const double push = k % 3 == 1 ? 0 : 0.3 * uniform();
            for (int j = 0; j < 2; j++)
                g->solver.state.displacement[g->node_dof[node_at(g, i, j)][k]] = (pzs_real)push;
        }
    follower_force(g, f);
    double sum[3] = {0, 0, 0}, size = 0;
    for (int n = 0; n < g->nodes; n++) {
        double force[3];
        force_at(g, f, n, 0, force);
        for (int i = 0; i < 3; i++)
            sum[i] += force[i];
        size += sqrt(dot(force, force));
    }
    assert_true(size > 1);
    assert_true(sqrt(dot(sum, sum)) < 20 * EPS * size);
    free(f);
    rig_close(g);
}

static void true_pressure_on_a_closed_ring_adds_up_to_nothing(void **state)
{
    (void)state;
    closed_ring_adds_up(0);
    closed_ring_adds_up(1);
}

static void follower_tables_out_of_range_are_refused(void **state)
{
    (void)state;
    rig *g = rig_open(2, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    attach_follower(g, 0, 0, 0);
    pzs_follower bad[4] = {g->follower, g->follower, g->follower, g->follower};
    bad[0].input = 2;
    bad[1].load_face = 3;
    bad[2].normal_face = 2;
    bad[3].pressure = NULL;
    for (int i = 0; i < 4; i++) {
        bad[i].crc = i < 3 ? pzs_follower_crc(&bad[i], &g->structure) : 0;
        assert_int_equal(pzs_attach_follower(&g->solver, &g->follower_load, &bad[i]),
                         PZS_E_ARGUMENT);
    }
    rig_close(g);
}

static pzs_status attach_load(rig *g)
{
    return pzs_attach_follower(&g->solver, &g->follower_load, &g->follower);
}

static void every_bit_of_follower_tables_counts(void **state)
{
    (void)state;
    rig *g = rig_open(2, 1, 1, 0.5, 0.7, 0.1, 0, nothing, 0);
    pzs_follower *follower = &g->follower;
    make_follower(g, 0, 1, 1);
    count_lean(g);
    follower->crc = pzs_follower_crc(follower, &g->structure);
    assert_bits_count(g, &follower->format, 3 * sizeof follower->format, attach_load);
    assert_bits_count(g, &follower->input, sizeof follower->input, attach_load);
    assert_bits_count(g, &follower->load_face, 3 * sizeof follower->load_face, attach_load);
    assert_bits_count(g, follower->share, sizeof follower->share, attach_load);
    assert_bits_count(g, g->corner_area, sizeof g->corner_area, attach_load);
    assert_bits_count(g, g->lean, sizeof g->lean, attach_load);
    assert_bits_count(g, g->pressure, (size_t)g->nodes * sizeof *g->pressure, attach_load);
    assert_null(g->solver.state.option);
    assert_int_equal(attach_load(g), PZS_OK);
    rig_close(g);
}

static pzs_status open_path(rig *g)
{
    return pzs_solver_init(&g->solver, &g->model, &g->tables, g->solver_work,
                           PZS_SOLVER_BYTES(g->dof, g->elements, 2));
}

static void every_bit_of_prescribed_displacements_counts(void **state)
{
    (void)state;
    uint16_t dof[2] = {1, 3};
    pzs_real value[2] = {1, 2};
    rig *g = rig_open(2, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    const pzs_prescribed_motion moved = {2, 1, dof, value};
    g->tables.prescribed = moved;
    g->tables.crc = pzs_nonlinear_crc(&g->tables, &g->structure);
    assert_bits_count(g, &g->tables.prescribed.input, sizeof moved.input, open_path);
    assert_bits_count(g, dof, sizeof dof, open_path);
    assert_bits_count(g, value, sizeof value, open_path);
    assert_int_equal(open_path(g), PZS_OK);
    rig_close(g);
}

/* An option twice in the list would be a list without end. */
static void options_are_attached_once(void **state)
{
    (void)state;
    const pzs_real amount[2] = {0, (pzs_real)1e-5};
    rig *g = rig_open(2, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    pzs_follower_load other;
    attach_follower(g, 0, 0, 0);
    assert_int_equal(pzs_attach_follower(&g->solver, &other, &g->follower), PZS_OK);
    assert_int_equal(pzs_attach_follower(&g->solver, &g->follower_load, &g->follower),
                     PZS_E_ARGUMENT);
    assert_int_equal(pzs_attach_follower(&g->solver, &other, &g->follower), PZS_E_ARGUMENT);
    g->solver.settings.solve_limit = 3;
    pzs_equilibrium(&g->solver, amount);
    assert_true(g->solver.info.linear_solves <= 3);
    rig_close(g);
}

/* Choices that would call any shape settled, or none, are refused; a path that never was is left
 * alone. */
static void choices_out_of_range_are_refused(void **state)
{
    (void)state;
    const pzs_real amount[2] = {(pzs_real)1e-5, 0},
                   bad[5] = {0, -1, 1, (pzs_real)NAN, (pzs_real)HUGE_VAL};
    pzs_solver never = {0};
    rig *g = rig_open(2, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 2);
    for (int i = 0; i < 5; i++) {
        g->solver.settings.tolerance = bad[i];
        assert_int_equal(pzs_equilibrium(&g->solver, amount), PZS_E_ARGUMENT);
    }
    pzs_solver_reset(&never);
    assert_int_equal(pzs_equilibrium(&never, amount), PZS_E_STAGE);
    rig_close(g);
}

/* The checksum of damaged tables is not led past them by their own counts. */
static void damaged_counts_are_not_followed(void **state)
{
    (void)state;
    static const uint16_t element[1], which[1];
    static const pzs_real value[1][10];
    static const uint32_t start[2][3] = {{0, 1, 1}, {0, 1, 0x40000001u}};
    rig *g = rig_open(2, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    const pzs_nonlinear sound = {
        PZS_TABLE_FORMAT, 0, 0, {1, start[0], element, which, value}, {0, 0, NULL, NULL}};
    pzs_nonlinear bad[3] = {sound, sound, sound};
    bad[0].resultants.start = start[1];
    bad[1].resultants.values = 0x8001u;
    bad[2].prescribed.count = 0x8000u;
    for (int i = 0; i < 3; i++)
        bad[i].crc = pzs_nonlinear_crc(&sound, &g->structure);
    for (int i = 0; i < 3; i++) {
        pzs_solver solver;
        pzs_real work[8];
        assert_int_equal(pzs_solver_init(&solver, &g->model, &bad[i], work, sizeof work),
                         PZS_E_CRC);
    }
    pzs_structure damaged[2] = {g->structure, g->structure};
    damaged[0].types |= 0x8000u;
    damaged[1].nodes |= 0x8000u;
    for (int i = 0; i < 2; i++)
        assert_int_equal(pzs_model_init(&g->model, &damaged[i], g->model_work, 8), PZS_E_ARGUMENT);
    rig_close(g);
}

/* ---- influence under follower loads ------------------------------------ */

static int clamped(int i, int j, int k)
{
    (void)j, (void)k;
    return i == 0;
}

/* A cantilever arc under a dead load and a pressure that turns with it, settled; every unknown is
 * an output. */
static rig *pressed_arc_open(uint32_t *start, uint16_t *dof, pzs_real *value)
{
    const pzs_real amount[2] = {(pzs_real)1e-5, (pzs_real)3e-5};
    rig *g = rig_open(12, 1, 1, 2.0 / 12, 0.3, 0.1, 0, clamped, 12);
    attach_follower(g, 0, 1, 0);
    count_lean(g);
    assert_int_equal(pzs_equilibrium(&g->solver, amount), PZS_OK);
    for (int i = 0; i < g->dof; i++) {
        start[i] = (uint32_t)i;
        dof[i] = (uint16_t)i;
        value[i] = 1;
    }
    start[g->dof] = (uint32_t)g->dof;
    const pzs_rows all = {(uint16_t)g->dof, start, dof, value};
    g->structure.output = all;
    return g;
}

/* Every column x solves (K - W) x = f: x = K^-1 (f + W x), to the rounding of x and of a solve. */
static void influence_solves_the_unsymmetric_system(void **state)
{
    (void)state;
    static uint32_t start[7 * MOST_NODES + 1];
    static uint16_t dof[7 * MOST_NODES];
    static pzs_real value[7 * MOST_NODES], influence[2 * 7 * MOST_NODES], x[7 * MOST_NODES],
        y[7 * MOST_NODES];
    rig *g = pressed_arc_open(start, dof, value);
    assert_int_equal(pzs_influence_at(&g->solver, influence), PZS_OK);
    for (uint32_t j = 0; j < 2; j++) {
        double worst = 0, largest = 0, skew = 0;
        memset(y, 0, sizeof y);
        for (int i = 0; i < g->dof; i++)
            x[i] = influence[2 * i + (int)j];
        g->follower_load.option.call->add_skew(&g->follower_load.option, &g->solver, x, 1, y);
        pzs_model_backsolve(&g->model, y, y);
        for (int i = 0; i < g->dof; i++)
            skew = fmax(skew, fabs((double)y[i]));
        memset(y, 0, sizeof y);
        pzs_nonlinear_unit_force(&g->solver, j, y);
        g->follower_load.option.call->add_skew(&g->follower_load.option, &g->solver, x, 1, y);
        pzs_model_backsolve(&g->model, y, y);
        for (int i = 0; i < g->dof; i++) {
            worst = fmax(worst, fabs((double)(y[i] - x[i])));
            largest = fmax(largest, fabs((double)x[i]));
        }
        assert_true(skew > 1e-3 * largest);
        assert_true(worst < 1000 * EPS * largest);
    }
    rig_close(g);
}

static void no_force(pzs_solver_option *option, pzs_solver *solver, pzs_real *load)
{
    (void)option, (void)solver, (void)load;
}

/* A symmetric matrix that outweighs K. */
static void not_skew(pzs_solver_option *option, pzs_solver *solver, const pzs_real *x,
                     pzs_real factor, pzs_real *y)
{
    (void)option;
    for (uint32_t i = 0; i < solver->state.model->state.structure->free_dof; i++)
        y[i] += 10 * factor * x[i] /
                (solver->state.model->state.scale[i] * solver->state.model->state.scale[i]);
}

/* Passes that do not converge are an error at the input they belong to. */
static void skew_part_that_is_none_is_told(void **state)
{
    (void)state;
    static const struct pzs_solver_option_calls calls = {.add_forces = no_force,
                                                         .add_skew = not_skew};
    static pzs_solver_option option;
    const pzs_real amount[2] = {(pzs_real)1e-5, 0}; /* far from loads that leave more than one
                                                       equilibrium within reach */
    pzs_real influence[2];
    rig *g = rig_open(12, 1, 1, 2.0 / 12, 0.3, 0.1, 0, clamped, 12);
    pzs_nonlinear_attach(&g->solver, &option, &calls);
    assert_int_equal(pzs_equilibrium(&g->solver, amount), PZS_OK);
    assert_int_equal(pzs_influence_at(&g->solver, influence), PZS_E_RESIDUAL);
    assert_int_equal(g->solver.info.where, 0);
    rig_close(g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tangent_is_the_symmetric_part_of_the_derivative),
        cmocka_unit_test(skew_part_completes_the_derivative),
        cmocka_unit_test(force_turns_with_the_shell),
        cmocka_unit_test(pressure_on_a_flat_patch_is_its_area),
        cmocka_unit_test(pressure_is_shared_with_consistent_weights),
        cmocka_unit_test(pressure_on_an_arc_is_that_on_its_chord),
        cmocka_unit_test(influence_solves_the_unsymmetric_system),
        cmocka_unit_test(skew_part_that_is_none_is_told),
        cmocka_unit_test(true_pressure_on_a_closed_ring_adds_up_to_nothing),
        cmocka_unit_test(follower_tables_out_of_range_are_refused),
        cmocka_unit_test(every_bit_of_follower_tables_counts),
        cmocka_unit_test(every_bit_of_prescribed_displacements_counts),
        cmocka_unit_test(options_are_attached_once),
        cmocka_unit_test(choices_out_of_range_are_refused),
        cmocka_unit_test(damaged_counts_are_not_followed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
