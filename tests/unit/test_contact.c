/*
 * Bodies and contact in either precision, on small shells made here.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/shell_rig.h"

/* ---- bodies ------------------------------------------------------------- */

#define ASLANT                                                                                     \
    {                                                                                              \
        (pzs_real)(2.0 / 7), (pzs_real)(3.0 / 7), (pzs_real)(6.0 / 7)                              \
    }
static const pzs_body plane = {pzs_gap_plane, {1, 2, 3}, ASLANT, 0, NULL, 0};
static const pzs_body cylinder = {pzs_gap_cylinder, {1, 2, 3}, ASLANT, 2, NULL, 0};
static const pzs_body sphere = {pzs_gap_sphere, {1, 2, 3}, {0, 0, 0}, 2, NULL, 0};

/* Distance by its definition. */
static double gap_in_double(const pzs_body *body, const pzs_real x[3])
{
    double from[3], along = 0, size2 = 0;
    for (int i = 0; i < 3; i++) {
        from[i] = (double)x[i] - (double)body->point[i];
        along += from[i] * (double)body->axis[i];
    }
    for (int i = 0; i < 3; i++)
        size2 += from[i] * from[i];
    const double round =
        sqrt(size2 - (body->gap == pzs_gap_cylinder ? along * along : 0)) - (double)body->radius;
    return body->gap == pzs_gap_plane ? along : round;
}

/* At 1000 random points: the value; its gradient, of length 1; the derivative of that. The third
 * derivatives of a distance are below 10 / r^3, r >= .5 the distance from axis or centre. */
static void gaps_are_distances_with_their_derivatives(void **state)
{
    (void)state;
    const pzs_body *const bodies[3] = {&plane, &cylinder, &sphere};
    const double step = 0.1 * cbrt(EPS), allowed = 200 * EPS / step + 80 * step * step;
    for (int trial = 0, done = 0; done < 1000; trial++) {
        const pzs_body *body = bodies[trial % 3];
        const pzs_real x[3] = {(pzs_real)(1 + 4 * uniform()), (pzs_real)(2 + 4 * uniform()),
                               (pzs_real)(3 + 4 * uniform())};
        pzs_real n[3], h[3][3], moved_n[2][3], ignored[3][3];
        const double gap = (double)body->gap(body, x, n, h);
        if (body != &plane && gap < 0.5 - (double)body->radius)
            continue;
        done++;
        assert_true(fabs(gap - gap_in_double(body, x)) < 100 * EPS);
        assert_true(fabs((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) - 1) < 20 * EPS);
        for (int j = 0; j < 3; j++) {
            double gaps[2];
            volatile pzs_real end[2] = {x[j] - (pzs_real)step, x[j] + (pzs_real)step};
            for (int side = 0; side < 2; side++) {
                pzs_real at[3] = {x[0], x[1], x[2]};
                at[j] = end[side];
                gaps[side] = gap_in_double(body, at);
                body->gap(body, at, moved_n[side], ignored);
            }
            const double span = (double)(end[1] - end[0]);
            assert_true(fabs((gaps[1] - gaps[0]) / span - (double)n[j]) < allowed);
            for (int i = 0; i < 3; i++)
                assert_true(fabs((double)(moved_n[1][i] - moved_n[0][i]) / span - (double)h[i][j]) <
                            allowed);
        }
    }
}

/* On the axis of a cylinder and in the centre of a sphere no direction leads out, and nothing is
 * NaN. */
static void gaps_are_finite_on_axis_and_centre(void **state)
{
    (void)state;
    const pzs_body *const bodies[2] = {&cylinder, &sphere};
    for (int b = 0; b < 2; b++) {
        pzs_real n[3], h[3][3];
        const pzs_real gap = bodies[b]->gap(bodies[b], bodies[b]->point, n, h);
        assert_true(gap == -bodies[b]->radius);
        assert_int_equal(pzs_guard_nonfinite(n, 3), -1);
        assert_int_equal(pzs_guard_nonfinite(h[0], 9), -1);
    }
}

/* ---- contact ------------------------------------------------------------ */

static const double still[3] = {0, 0, 0}, up[3] = {0, 0, 1}, down[3] = {0, 0, -1};

/* Half a ring from its lowest point to its top, in plane strain: free to move up and down. */
static int ring_support(int i, int j, int k)
{
    (void)j;
    return k == 1 || k == 4 || ((i == 0 || i == 12) && (k == 0 || k == 3));
}

/* The same, its top held. */
static int held_ring_support(int i, int j, int k)
{
    return ring_support(i, j, k) || (i == 12 && k == 2);
}

/* A strip clamped at both ends. */
static int strip_support(int i, int j, int k)
{
    (void)j, (void)k;
    return i == 0 || i == 12;
}

static rig *thin_ring_open(fixing *support, double h)
{
    return rig_open(12, 1, 1, acos(-1.0) / 12, 0.3, h, 0, support,
                    support == held_ring_support ? 6 : 12);
}

static rig *ring_open(fixing *support)
{
    return thin_ring_open(support, 0.1);
}

static const pzs_body ground = {pzs_gap_plane, {0, 0, (pzs_real)-1.05}, {0, 0, 1}, 0, NULL, 0};

static pzs_status settle(rig *g, double load, double move)
{
    const pzs_real amount[2] = {(pzs_real)load, (pzs_real)move};
    return pzs_equilibrium(&g->solver, amount);
}

/* Gap of a node of the face at the shape reached. */
static double gap_of(const rig *g, int n)
{
    double x[3];
    pzs_real at[3], normal[3], hessian[3][3];
    for (int i = 0; i < 3; i++) {
        x[i] = g->position[n][i] + g->thickness / 2 * g->frame[n][2][i] -
               (double)g->solver.info.input_value[1] * (double)g->face.motion[i];
        for (int k = 0; k < 3; k++)
            for (int part = 0; part < 2; part++) {
                const uint16_t dof = g->node_dof[n][3 * part + k];
                const double height = part ? g->thickness / 2 : 1;
                if (dof != PZS_CONSTRAINED)
                    x[i] += height * (double)g->solver.info.displacement[dof] * g->frame[n][k][i];
            }
        at[i] = (pzs_real)x[i];
    }
    return (double)g->contact.state.body->gap(g->contact.state.body, at, normal, hessian);
}

/* Gaps are open or closed, pressures push, and no pressure acts across a gap; nodes and force are
 * their sums. */
static void assert_complementary(const rig *g)
{
    const double size = (double)g->face.size, closed = size * fmax(1e-8, 64 * EPS);
    int touching = 0;
    for (int n = 0; n < g->nodes; n++) {
        assert_true(gap_of(g, n) >= -closed);
        assert_true(g->contact.info.pressure[n] >= 0);
        assert_true(g->contact.info.pressure[n] == 0 || gap_of(g, n) <= closed);
        touching += g->contact.info.pressure[n] > 0;
    }
    assert_int_equal(touching, g->contact.info.nodes);
}

/* Force of a contact at path->u onto f. */
static void contact_force(rig *g, pzs_real *f)
{
    memset(f, 0, (size_t)g->dof * sizeof *f);
    g->contact.option.call->add_forces(&g->contact.option, &g->solver, f);
}

/* Where a gap is closed the added matrix is minus the derivative of the force, and `unit` its
 * derivative with respect to the motion: one node anywhere on a sphere of size 1, to the
 * differences' step^2. */
static void contact_tangent_is_the_derivative_of_its_force(void **state)
{
    (void)state;
    const double step = cbrt(EPS), motion[3] = {0.3, -0.5, 0.8};
    for (int trial = 0; trial < 50; trial++) {
        const pzs_real at[2] = {(pzs_real)uniform(), (pzs_real)uniform()};
        const pzs_body ball = {pzs_gap_sphere, {at[0], at[1], -2}, {0, 0, 0}, 1, NULL, 0};
        rig *g = ring_open(nothing);
        pzs_real f[2][7 * MOST_NODES];
        const int n = trial % g->nodes;
        attach_contact(g, &ball, motion);
        set_random(g, 0.3);
        g->solver.state.input_value[1] = (pzs_real)0.1;
        g->body.radius += (pzs_real)gap_of(g, n);
        g->contact.state.touching[n] = 1;
        g->contact.state.pressure[n] = 1;
        g->contact.settings.stiffness = (pzs_real)0.1;
        const double tolerance = 400 * EPS / step + 100 * step * step;
        for (int k = 0; k <= 6; k++) { /* six unknowns of the node, then the motion */
            const uint16_t *dof = g->node_dof[n];
            pzs_real *moved = k < 6 ? &g->solver.state.displacement[dof[k]]
                                    : &g->solver.state.input_value[1],
                     unit[7 * MOST_NODES] = {0};
            const pzs_real at = *moved;
            volatile pzs_real ahead = at + (pzs_real)step, behind = at - (pzs_real)step;
            pzs_real column[6];
            g->contact.option.call->add_unit_force(&g->contact.option, &g->solver, 1, unit);
            pzs_linalg_clear(&g->model.state.stiffness);
            contact_force(g, f[0]);
            for (int i = 0; i < 6; i++) {
                const uint16_t *high = &dof[i > k ? i : k];
                const uint16_t *low = &dof[i > k ? k : i];
                column[i] = k < 6 ? -*pzs_linalg_entry(&g->model.state.stiffness, *high, *low)
                                  : unit[dof[i]];
            }
            *moved = ahead;
            contact_force(g, f[1]);
            *moved = behind;
            contact_force(g, f[0]);
            *moved = at;
            for (int i = 0; i < 6; i++)
                assert_true(fabs((double)((f[1][dof[i]] - f[0][dof[i]]) / (ahead - behind) -
                                          column[i])) < tolerance);
        }
        rig_close(g);
    }
}

static void ring_on_the_ground_carries_its_load(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    assert_int_equal(g->contact.state.is_loose, 1);
    for (int k = 1; k <= 4; k++) {
        assert_int_equal(settle(g, 1e-5 * k, 0), PZS_OK);
        assert_complementary(g);
        assert_true(g->contact.info.nodes > 0);
        assert_true(fabs((double)g->contact.info.force[2] / (1e-5 * k) - 1) <
                    (IS_FLOAT ? 2e-3 : 1e-6));
    }
    rig_close(g);
}

/* Whatever kappa, the same shape and the same pressures: on a thin ring, whose own stiffness is far
 * below kappa's. */
static void answer_does_not_depend_on_the_stiffness(void **state)
{
    (void)state;
    const double kappa[4] = {10, IS_FLOAT ? 1 : 1e-3, 1, 1e4};
    const double h = IS_FLOAT ? 0.1 : 0.01, load = 5e-2 * h * h * h, area = 0.3;
    const pzs_body base = {pzs_gap_plane, {0, 0, (pzs_real)(-1 - h / 2)}, {0, 0, 1}, 0, NULL, 0};
    pzs_real u[7 * MOST_NODES], pressure[MOST_NODES];
    for (int k = 0; k < 4; k++) {
        rig *g = thin_ring_open(ring_support, h);
        attach_contact(g, &base, still);
        g->contact.settings.stiffness = (pzs_real)kappa[k];
        g->solver.settings.tolerance = IS_FLOAT ? (pzs_real)1e-4 : (pzs_real)1e-9;
        assert_int_equal(settle(g, load, 0), PZS_OK);
        assert_complementary(g);
        for (int i = 0; i < g->dof && k > 0; i++)
            assert_true(fabs((double)(g->solver.info.displacement[i] - u[i])) <
                        (IS_FLOAT ? 1e-3 : 1e-6));
        for (int n = 0; n < g->nodes && k > 0; n++)
            assert_true(fabs((double)(g->contact.info.pressure[n] - pressure[n])) <
                        (IS_FLOAT ? 1e-2 : 1e-6) * load / area);
        memcpy(u, g->solver.info.displacement, (size_t)g->dof * sizeof *u);
        memcpy(pressure, g->contact.info.pressure, (size_t)g->nodes * sizeof *pressure);
        rig_close(g);
    }
}

/* A held shell that is pulled away feels nothing of the body: the same bits as without it. */
static void contact_never_pulls(void **state)
{
    (void)state;
    rig *g = ring_open(held_ring_support), *alone = ring_open(held_ring_support);
    attach_contact(g, &ground, down);
    assert_int_equal(g->contact.state.is_loose, 0);
    assert_int_equal(settle(g, 0, -0.01), PZS_OK); /* press first */
    assert_complementary(g);
    assert_true(g->contact.info.force[2] > 0);
    assert_int_equal(settle(g, 5e-5, 1), PZS_OK);
    assert_int_equal(settle(alone, 5e-5, 1), PZS_OK);
    assert_int_equal(g->contact.info.nodes, 0);
    assert_true(g->contact.info.force[2] == 0);
    for (int i = 0; i < g->dof; i++)
        assert_true(fabs((double)(g->solver.info.displacement[i] -
                                  alone->solver.info.displacement[i])) < (IS_FLOAT ? 1e-4 : 1e-9));
    rig_close(g);
    rig_close(alone);
}

/* A loose shell that is pulled off its body has no equilibrium, and the last one stands. */
static void pulled_off_fails_with_a_status(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    g->solver.settings.solve_limit = 200;
    assert_int_equal(settle(g, 3e-5, 0), PZS_OK);
    assert_true(PZS_IS_ERROR(settle(g, -3e-5, 0)));
    assert_int_equal(pzs_guard_nonfinite(g->solver.info.displacement, (uint32_t)g->dof), -1);
    assert_true(g->solver.info.load_factor <= (pzs_real)0.5); /* half of the way is no load at all
                                                               */
    assert_complementary(g);
    rig_close(g);
}

static void restart_settles_at_once(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_true(g->solver.info.linear_solves > 1);
    g->solver.settings.tolerance = (pzs_real)1e-3; /* of a thousandth of the displacement: above the
                                                    rounding of either precision */
    const uint16_t nodes = g->contact.info.nodes;
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_int_equal(g->solver.info.linear_solves, 1);
    assert_int_equal(g->contact.info.nodes, nodes);
    rig_close(g);
}

/* However coarse the increments that are let pass, gaps are closed and no node is left to change.
 */
static void coarse_steps_still_close_the_gaps(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    g->solver.settings.tolerance = (pzs_real)0.9;
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_complementary(g);
    rig_close(g);
}

/* A step that is given up leaves the last equilibrium and its contact, bit by bit. */
static void failed_step_restores_the_contact(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    pzs_real u[7 * MOST_NODES], pressure[MOST_NODES];
    uint8_t touching[MOST_NODES];
    attach_contact(g, &ground, up);
    assert_int_equal(settle(g, 3e-5, 0), PZS_OK);
    memcpy(u, g->solver.info.displacement, (size_t)g->dof * sizeof *u);
    memcpy(pressure, g->contact.info.pressure, (size_t)g->nodes * sizeof *pressure);
    memcpy(touching, g->contact.state.touching, (size_t)g->nodes);
    g->solver.settings.solve_limit = 2;
    assert_int_equal(settle(g, 5e-5, 0.5), PZS_E_SOLVES);
    assert_memory_equal(u, g->solver.info.displacement, (size_t)g->dof * sizeof *u);
    assert_memory_equal(pressure, g->contact.info.pressure, (size_t)g->nodes * sizeof *pressure);
    assert_memory_equal(touching, g->contact.state.touching, (size_t)g->nodes);
    rig_close(g);
}

/* Back at rest nothing of the contact is left, and the same way leads to the same bits. */
static void rest_forgets_the_contact(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    pzs_real u[7 * MOST_NODES];
    attach_contact(g, &ground, still);
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    const uint32_t systems = g->solver.info.linear_solves;
    memcpy(u, g->solver.info.displacement, (size_t)g->dof * sizeof *u);
    pzs_solver_reset(&g->solver);
    assert_int_equal(g->contact.info.nodes, 0);
    assert_true(g->contact.info.force[2] == 0);
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_int_equal(g->solver.info.linear_solves, systems);
    assert_memory_equal(u, g->solver.info.displacement, (size_t)g->dof * sizeof *u);
    rig_close(g);
}

/* A body that penetrates the shell at rest pushes it out; so does one that is moved into it. */
static void penetrating_body_is_pushed_out(void **state)
{
    (void)state;
    const pzs_body ball = {pzs_gap_sphere, {(pzs_real)0.6, (pzs_real)0.15, (pzs_real)(0.05 + 0.98)},
                           {0, 0, 0},      1,
                           NULL,           0};
    rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.1, 0, strip_support, 6);
    attach_contact(g, &ball, down);
    assert_int_equal(settle(g, 0, 0), PZS_OK);
    assert_complementary(g);
    assert_true(g->contact.info.force[2] < 0);
    const pzs_real first = g->contact.info.force[2];
    assert_int_equal(settle(g, 0, 0.03), PZS_OK);
    assert_complementary(g);
    assert_true(g->contact.info.force[2] < first);
    rig_close(g);
}

/* A shell whose face looks away from the body that it lies in is not an equilibrium in contact:
 * the body came from behind. */
static void face_that_looks_away_is_refused(void **state)
{
    (void)state;
    const pzs_body below = {pzs_gap_plane, {0, 0, (pzs_real)0.2}, {0, 0, 1}, 0, NULL, 0};
    rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.1, 0, strip_support, 6);
    attach_contact(g, &below, still);
    assert_int_equal(settle(g, 1e-6, 0), PZS_E_PENETRATION);
    assert_int_equal(g->contact.info.penetration, PZS_PENETRATION_AT_NODE);
    assert_int_equal(g->solver.info.where, 0);
    assert_int_equal(g->contact.info.nodes, 0);
    assert_true(fabs((double)g->contact.info.depth - 0.15) < 1e-6);
    rig_close(g);
}

/* A sphere whose centre is a node of the face: a status, and nothing that is not finite. */
static void centre_on_a_node_stays_finite(void **state)
{
    (void)state;
    const pzs_body ball = {
        pzs_gap_sphere, {(pzs_real)0.6, 0, (pzs_real)0.05}, {0, 0, 0}, (pzs_real)0.15, NULL, 0};
    rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.1, 0, strip_support, 6);
    attach_contact(g, &ball, down);
    settle(g, 1e-5, 0);
    assert_int_equal(pzs_guard_nonfinite(g->solver.info.displacement, (uint32_t)g->dof), -1);
    assert_int_equal(pzs_guard_nonfinite(g->contact.info.pressure, (uint32_t)g->nodes), -1);
    assert_int_equal(pzs_guard_nonfinite(g->contact.info.force, 3), -1);
    rig_close(g);
}

/* Influence of a dead load and of the body's motion on a shell in contact: the change of the
 * equilibrium itself, as far as kappa makes the body rigid. */
static void influence_in_contact_is_the_change_of_the_equilibrium(void **state)
{
    (void)state;
    if (IS_FLOAT)
        return; /* differences of equilibria need the digits */
    const pzs_body drum = {pzs_gap_cylinder, {0, 0, (pzs_real)(-1.05 - 3)}, {0, 1, 0}, 3, NULL, 0};
    rig *g = ring_open(held_ring_support);
    attach_contact(g, &drum, up);
    g->solver.settings.tolerance = (pzs_real)1e-10;
    g->contact.settings.stiffness = 10000;
    pzs_real influence[2];
    assert_int_equal(settle(g, 1e-4, 0.05), PZS_OK);
    assert_in_range(g->contact.info.nodes, 1, 26);
    assert_int_equal(pzs_influence_at(&g->solver, influence), PZS_OK);
    const double step[2] = {1e-7, 1e-5};
    for (int j = 0; j < 2; j++) {
        double y[2];
        for (int side = 0; side < 2; side++) {
            const double change = side ? step[j] : -step[j];
            assert_int_equal(settle(g, 1e-4 + (j == 0) * change, 0.05 + (j == 1) * change), PZS_OK);
            y[side] = (double)g->solver.info.displacement[g->output_dof[0]];
        }
        assert_true(fabs((y[1] - y[0]) / (2 * step[j]) / (double)influence[j] - 1) < 1e-5);
    }
    rig_close(g);
}

static void contact_tables_out_of_range_are_refused(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    pzs_contact_face bad[4] = {g->face, g->face, g->face, g->face};
    const size_t bytes = PZS_CONTACT_BYTES(g->nodes);
    bad[0].input = 2;
    bad[1].face = 2;
    bad[2].size = 0;
    bad[3].area = NULL;
    for (int i = 0; i < 4; i++) {
        bad[i].crc = i < 3 ? pzs_contact_crc(&bad[i], &g->structure) : 0;
        assert_int_equal(
            pzs_attach_contact(&g->solver, &g->contact, &bad[i], &g->body, g->contact_work, bytes),
            PZS_E_ARGUMENT);
    }
    assert_int_equal(
        pzs_attach_contact(&g->solver, &g->contact, &g->face, &g->body, g->contact_work, bytes - 1),
        PZS_E_WORKSPACE);
    assert_int_equal(g->solver.info.where, bytes);
    assert_int_equal(
        pzs_attach_contact(&g->solver, &g->contact, &g->face, &g->body, g->contact_work, bytes),
        PZS_E_ARGUMENT);
    rig_close(g);
}

static pzs_status attach_face(rig *g)
{
    return pzs_attach_contact(&g->solver, &g->contact, &g->face, &g->body, g->contact_work,
                              PZS_CONTACT_BYTES(g->nodes));
}

static void every_bit_of_contact_tables_counts(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    pzs_contact_face *face = &g->face;
    const size_t nodes = (size_t)g->nodes;
    attach_contact(g, &ground, still);
    g->solver.state.option = NULL;
    assert_bits_count(g, &face->format, 3 * sizeof face->format, attach_face);
    assert_bits_count(g, &face->face, sizeof face->face, attach_face);
    assert_bits_count(g, &face->input, sizeof face->input, attach_face);
    assert_bits_count(g, face->motion, sizeof face->motion + sizeof face->size, attach_face);
    assert_bits_count(g, g->place, nodes * sizeof *g->place, attach_face);
    assert_bits_count(g, g->triad, nodes * sizeof *g->triad, attach_face);
    assert_bits_count(g, g->area, nodes * sizeof *g->area, attach_face);
    assert_null(g->solver.state.option);
    assert_int_equal(attach_face(g), PZS_OK);
    rig_close(g);
}

/* A stiffness that holds nothing back is refused before anything is solved. */
static void stiffness_out_of_range_is_refused(void **state)
{
    (void)state;
    const pzs_real bad[4] = {0, -10, (pzs_real)NAN, (pzs_real)HUGE_VAL};
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    for (int i = 0; i < 4; i++) {
        g->contact.settings.stiffness = bad[i];
        assert_int_equal(settle(g, 3e-5, 0), PZS_E_ARGUMENT);
    }
    g->contact.settings.stiffness = 10;
    assert_int_equal(settle(g, 3e-5, 0), PZS_OK);
    rig_close(g);
}

/* Not even sideways. */
static int ring_unsupported(int i, int j, int k)
{
    (void)i, (void)j;
    return k == 1 || k == 4;
}

/* A loose shell that the body does not hold, whatever the reason: apart from it, not pressed onto
 * it, free to slide: in float the stiffness against that is not 0 but rounding. */
static void loose_shell_without_hold_is_told(void **state)
{
    (void)state;
    const double gap[5] = {0.01, 5, 0, 0, 0}, load[5] = {3e-5, 3e-5, 0, -3e-5, 3e-5};
    for (int i = 0; i < (IS_FLOAT ? 4 : 5); i++) {
        const pzs_body away = {
            pzs_gap_plane, {0, 0, (pzs_real)(-1.05 - gap[i])}, {0, 0, 1}, 0, NULL, 0};
        rig *g = ring_open(i < 4 ? ring_support : ring_unsupported);
        attach_contact(g, &away, still);
        assert_int_equal(g->contact.state.is_loose, 1);
        assert_int_equal(settle(g, load[i], 0), PZS_E_CONTACT);
        assert_true(g->solver.info.load_factor == 0);
        for (int d = 0; d < g->dof; d++)
            assert_true(g->solver.info.displacement[d] == 0);
        rig_close(g);
    }
}

/* ---- attacks: contact must not be wrong in silence ------------------------ */

/* A plate of 8 x 8 elements of 0.1, clamped at two sides; what is below is its inner face. */
enum { PLATE = 8, FINE = 24 };

static int plate_support(int i, int j, int k)
{
    (void)j, (void)k;
    return i == 0 || i == PLATE;
}

static rig *plate_open(void)
{
    rig *g = rig_open(PLATE, PLATE, 0, 0.1, 0.1, 0.02, 0, plate_support, 4);
    g->solver.settings.solve_limit = 150;
    return g;
}

/* Place of node n on a face, now, less the motion of the body. */
static void find_place(const rig *g, int n, int side, double x[3])
{
    const double z = side ? g->thickness / 2 : -g->thickness / 2;
    for (int i = 0; i < 3; i++) {
        x[i] = g->position[n][i] + z * g->frame[n][2][i] -
               (double)g->solver.info.input_value[1] * (double)g->face.motion[i];
        for (int k = 0; k < 3; k++)
            for (int part = 0; part < 2; part++) {
                const uint16_t dof = g->node_dof[n][3 * part + k];
                const double height = part ? z : 1;
                if (dof != PZS_CONSTRAINED)
                    x[i] += height * (double)g->solver.info.displacement[dof] * g->frame[n][k][i];
            }
    }
}

/* Least gap of a fine grid of points on every element of both faces, and how many of the outer
 * face are straight above the body. */
static double least_gap(const rig *g, int *above)
{
    double least = HUGE_VAL;
    *above = 0;
    for (int e = 0; e < 2 * g->elements; e++) {
        double corner[4][3];
        for (int r = 0; r < 4; r++)
            find_place(g, g->element[e / 2][r], e % 2, corner[r]);
        for (int p = 0; p <= FINE; p++)
            for (int q = 0; q <= FINE; q++) {
                const double a = (double)p / FINE, b = (double)q / FINE;
                pzs_real x[3], normal[3], hessian[3][3];
                for (int i = 0; i < 3; i++)
                    x[i] = (pzs_real)((1 - b) * ((1 - a) * corner[0][i] + a * corner[1][i]) +
                                      b * ((1 - a) * corner[3][i] + a * corner[2][i]));
                const double gap = (double)g->body.gap(&g->body, x, normal, hessian);
                least = fmin(least, gap);
                *above += e % 2 == 1 && normal[2] > (pzs_real)0.97;
            }
    }
    return least;
}

/* What must hold after a body came down onto the plate: it is still above it, in it by at most the
 * sag of a facet, and an end before the full way is named. */
static void assert_not_passed(const rig *g, pzs_status status, double sag)
{
    int above;
    const double least = least_gap(g, &above);
    assert_int_equal(above, 0);
    assert_true(least >= -sag - (double)g->face.size * fmax(1e-7, 256 * EPS));
    assert_true(!PZS_IS_ERROR(status) == (g->solver.info.load_factor == 1));
    if (!PZS_IS_ERROR(status))
        assert_true(g->contact.info.nodes > 0 && g->contact.info.force[2] < 0);
}

/* Of the bodies that could jump through a plate, sanitizers take every fifth: they run 20 times as
 * long, and their subject is the memory. */
#ifdef __SANITIZE_ADDRESS__
enum { JUMP_STRIDE = 5 };
#else
enum { JUMP_STRIDE = 1 };
#endif

/* Bodies of every size, on nodes and between them, that one load step would carry to the far
 * side of the plate. */
static void no_body_jumps_through_a_plate(void **state)
{
    (void)state;
    const double size[4] = {0.4, 0.1, 0.03, 0.004},
                 place[3][2] = {{0.4, 0.4}, {0.45, 0.45}, {0.43, 0.38}};
    for (int trial = 0; trial < 4 * 3 * 2 * 2; trial += JUMP_STRIDE) {
        const double radius = size[trial % 4], *at = place[trial / 4 % 3],
                     move = trial / 12 % 2 ? 300 : 0.1 + 4 * radius;
        const pzs_body body = {trial < 24 ? pzs_gap_sphere : pzs_gap_cylinder,
                               {(pzs_real)at[0], (pzs_real)at[1], (pzs_real)(0.1 + radius)},
                               {0, trial < 24 ? 0 : 1, 0},
                               (pzs_real)radius,
                               NULL,
                               0};
        rig *g = plate_open();
        attach_contact(g, &body, down);
        const pzs_status status = settle(g, 0, move);
        assert_not_passed(g, status, radius / 5);
        assert_true(g->solver.info.load_factor > 0);
        assert_true(PZS_IS_ERROR(status) || move < 300); /* no plate follows that far */
        rig_close(g);
    }
}

/* A small ball over the middle of an element, between its nodes: refused with the element and
 * the place, just above it. */
static void small_ball_between_nodes_is_refused(void **state)
{
    (void)state;
    const pzs_body ball = {pzs_gap_sphere, {(pzs_real)0.36, (pzs_real)0.55, (pzs_real)0.05},
                           {0, 0, 0},      (pzs_real)0.01,
                           NULL,           0};
    rig *g = plate_open();
    attach_contact(g, &ball, down);
    assert_int_equal(settle(g, 0, 0.035), PZS_E_PENETRATION);
    assert_int_equal(g->solver.info.where, 3 * PLATE + 5);
    assert_int_equal(g->contact.info.element, 3 * PLATE + 5);
    assert_int_equal(g->contact.info.penetration, PZS_PENETRATION_BETWEEN_NODES);
    assert_int_equal(g->contact.info.node, PZS_CONSTRAINED);
    assert_int_equal(g->contact.info.side, 1);
    assert_int_equal(g->contact.info.nodes, 0);
    assert_true(fabs((double)g->contact.info.spot[0] - 0.36) < 0.01 &&
                fabs((double)g->contact.info.spot[1] - 0.55) < 0.01 &&
                fabs((double)g->contact.info.spot[2] - 0.01) < 1e-5);
    assert_true(fabs((double)g->solver.info.load_factor * 0.035 - 0.03) < 0.035 / 32); /* it touches
                                                                                        after 0.03
                                                                                      */
    for (int d = 0; d < g->dof; d++)
        assert_true(g->solver.info.displacement[d] == 0);
    rig_close(g);
}

/* From behind, or across the plate from the start. */
static void body_on_the_wrong_side_is_refused(void **state)
{
    (void)state;
    const double radius[3] = {0.3, 0.05, 0.01};
    for (int trial = 0; trial < 9; trial++) {
        const double r = radius[trial % 3], z[3] = {-0.02 - r, 0.005, 0.0};
        const pzs_body ball = {
            pzs_gap_sphere, {(pzs_real)0.43, (pzs_real)0.38, (pzs_real)z[trial / 3]},
            {0, 0, 0},      (pzs_real)r,
            NULL,           0};
        rig *g = plate_open();
        attach_contact(g, &ball, up);
        const pzs_status status = settle(g, 0, trial < 3 ? 1 : 0);
        if (trial < 6 || r > 0.02) {
            assert_int_equal(status, PZS_E_PENETRATION);
            assert_true(g->solver.info.where >= 0 && g->contact.info.penetration);
        }
        if (trial < 3) {
            int above;
            assert_int_equal(g->contact.info.side, 0);
            assert_true(g->solver.info.load_factor > 0 &&
                        least_gap(g, &above) > -(r > 0.15 ? 0.02 / (4 * r) : 1e-3 * r));
        }
        rig_close(g);
    }
}

/* psi / |grad psi| of an ellipsoid, and of a slab, in whose curvature its thickness does not
 * show. */
static pzs_real gap_ellipsoid(const pzs_body *body, const pzs_real x[3], pzs_real normal[3],
                              pzs_real hessian[3][3])
{
    const pzs_real *axis = body->own;
    pzs_real psi = -1, slope = 0;
    for (int i = 0; i < 3; i++) {
        const pzs_real from = x[i] - body->point[i];
        psi += from * from / (axis[i] * axis[i]);
        normal[i] = 2 * from / (axis[i] * axis[i]);
        slope += normal[i] * normal[i];
    }
    slope = slope > 0 ? PZS_SQRT(slope) : 1;
    for (int i = 0; i < 3; i++) {
        normal[i] /= slope;
        for (int j = 0; j < 3; j++)
            hessian[i][j] = i == j ? 2 / (axis[i] * axis[i] * slope) : 0;
    }
    return psi / slope;
}

static void no_body_by_formula_jumps_through_a_plate(void **state)
{
    (void)state;
    const pzs_real axis[4][3] = {{(pzs_real)0.3, (pzs_real)0.2, (pzs_real)0.1},
                                 {(pzs_real)0.05, (pzs_real)0.1, (pzs_real)0.02},
                                 {1000, 1000, (pzs_real)0.01},
                                 {(pzs_real)0.02, 1000, (pzs_real)0.02}};
    for (int k = 0; k < 4; k++) {
        const pzs_body body = {gap_ellipsoid, {(pzs_real)0.43, (pzs_real)0.38, (pzs_real)0.3},
                               {0, 0, 0},     0,
                               axis[k],       0};
        rig *g = plate_open();
        attach_contact(g, &body, down);
        const pzs_status status = settle(g, 0, 3);
        assert_not_passed(g, status, 0.02);
        assert_true(PZS_IS_ERROR(status));
        rig_close(g);
    }
}

/* The shell that moves, past a body that stays: a strip lifted through a bar above it by its
 * load. */
static void no_shell_jumps_through_a_body(void **state)
{
    (void)state;
    const double radius[3] = {0.05, 0.02, 0.002}, load = -0.003;
    for (int trial = 0; trial < 6; trial++) {
        const double r = radius[trial % 3], x = trial < 3 ? 0.6 : 0.55;
        const pzs_body bar = {pzs_gap_cylinder,
                              {(pzs_real)x, 0, (pzs_real)(0.06 + r)},
                              {0, 1, 0},
                              (pzs_real)r,
                              NULL,
                              0};
        rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.05, 0, strip_support, 6);
        rig *alone = rig_open(12, 1, 0, 0.1, 0.3, 0.05, 0, strip_support, 6);
        assert_false(PZS_IS_ERROR(settle(alone, load, 0)));
        assert_true(alone->solver.info.displacement[alone->output_dof[0]] >
                    (pzs_real)0.25); /* it would move well past the bar */
        attach_contact(g, &bar, still);
        const pzs_status status = settle(g, load, 0);
        assert_not_passed(g, status, r / 5);
        rig_close(g);
        rig_close(alone);
    }
}

/* A body that never touches is free to move however far, in a few load steps, and the shell
 * feels nothing. */
static void body_that_never_touches_is_let_go(void **state)
{
    (void)state;
    const double to[4][3] = {{100, 0, 0}, {0, 0, 1}, {-1e4, 1e4, 0}, {0, 0.05, 0}};
    for (int k = 0; k < 4; k++) {
        const pzs_body ball = {pzs_gap_sphere, {(pzs_real)0.4, (pzs_real)0.4, (pzs_real)0.14},
                               {0, 0, 0},      (pzs_real)0.02,
                               NULL,           0};
        rig *g = plate_open();
        attach_contact(g, &ball, to[k]);
        assert_int_equal(settle(g, 1e-6, 1), PZS_OK);
        assert_int_equal(g->contact.info.nodes, 0);
        assert_true(g->solver.info.load_factor == 1 && g->contact.info.force[2] == 0);
        assert_true(g->solver.info.shortened_steps == 0 && g->solver.info.load_steps == 1);
        rig_close(g);
    }
}

/* Steps are added where the body comes near, within the budget, and counted; pressed gently, it
 * ends in contact. */
static void body_that_moves_far_gets_load_steps(void **state)
{
    (void)state;
    const pzs_body ball = {
        pzs_gap_sphere, {(pzs_real)0.4, (pzs_real)0.4, 10}, {0, 0, 0}, (pzs_real)0.05, NULL, 0};
    for (int trial = 0; trial < 2; trial++) {
        rig *g = plate_open();
        attach_contact(g, &ball, down);
        g->solver.settings.solve_limit = trial ? 3 : 400;
        const pzs_status status = settle(g, 0, 9.95);
        assert_int_equal(status, trial ? PZS_E_SOLVES : PZS_OK);
        assert_true(g->solver.info.linear_solves <= g->solver.settings.solve_limit);
        if (!trial) {
            assert_true(g->solver.info.shortened_steps >= 1 && g->solver.info.load_steps > 1 &&
                        g->solver.info.load_steps < 10);
            assert_complementary(g);
            assert_not_passed(g, status, 0.01);
        }
        rig_close(g);
    }
}

/* Numbers of a body or its motion that are none, or none of a body. */
static void body_out_of_range_is_refused(void **state)
{
    (void)state;
    const pzs_real bad[3] = {(pzs_real)NAN, (pzs_real)HUGE_VAL, (pzs_real)-HUGE_VAL};
    rig *g = ring_open(held_ring_support);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 7; i++) {
            pzs_body body = cylinder;
            double motion[3] = {0, 0, 0};
            pzs_real *const place[7] = {&body.point[0], &body.point[1], &body.point[2],
                                        &body.axis[0],  &body.axis[1],  &body.axis[2],
                                        &body.radius};
            *place[i] = bad[k];
            assert_int_equal(try_contact(g, &body, still), PZS_E_NONFINITE);
            assert_int_equal(g->solver.info.where, i);
            motion[i % 3] = (double)bad[k];
            assert_int_equal(try_contact(g, &ground, motion), PZS_E_ARGUMENT);
        }
    const pzs_real radius[3] = {0, -1, -2};
    for (int k = 0; k < 3; k++) {
        pzs_body body[3] = {sphere, cylinder, cylinder};
        body[0].radius = body[1].radius = radius[k];
        body[2].axis[k] *= 2;
        for (int i = 0; i < 3; i++)
            assert_int_equal(try_contact(g, &body[i], still), PZS_E_ARGUMENT);
    }
    assert_null(g->solver.state.option);
    attach_contact(g, &ground, down);
    assert_int_equal(settle(g, 0, (double)NAN), PZS_E_NONFINITE);
    assert_int_equal(g->solver.info.where, 1);
    rig_close(g);
}

/* A gap function that returns no number is no gap: nothing is called an equilibrium. */
static pzs_real gap_nan(const pzs_body *body, const pzs_real x[3], pzs_real normal[3],
                        pzs_real hessian[3][3])
{
    const pzs_real gap = pzs_gap_plane(body, x, normal, hessian);
    return x[0] > (pzs_real)0.35 && x[0] < (pzs_real)0.45 ? (pzs_real)NAN : gap;
}

static void gap_that_is_no_number_is_refused(void **state)
{
    (void)state;
    const pzs_body body = {gap_nan, {0, 0, (pzs_real)0.5}, {0, 0, -1}, 0, NULL, 0};
    rig *g = plate_open();
    attach_contact(g, &body, down);
    assert_int_equal(settle(g, 1e-6, 0), PZS_E_PENETRATION);
    rig_close(g);
}

static pzs_status attach_body(rig *g)
{
    return pzs_attach_contact(&g->solver, &g->contact, &g->face, &g->body, g->contact_work,
                              PZS_CONTACT_BYTES(g->nodes));
}

static void every_bit_of_a_body_counts(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    g->solver.state.option = NULL;
    assert_bits_count(g, g->body.point,
                      sizeof g->body.point + sizeof g->body.axis + sizeof g->body.radius,
                      attach_body);
    assert_bits_count(g, &g->body.crc, sizeof g->body.crc, attach_body);
    assert_int_equal(attach_body(g), PZS_OK);
    rig_close(g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gaps_are_distances_with_their_derivatives),
        cmocka_unit_test(gaps_are_finite_on_axis_and_centre),
        cmocka_unit_test(contact_tangent_is_the_derivative_of_its_force),
        cmocka_unit_test(ring_on_the_ground_carries_its_load),
        cmocka_unit_test(answer_does_not_depend_on_the_stiffness),
        cmocka_unit_test(contact_never_pulls),
        cmocka_unit_test(pulled_off_fails_with_a_status),
        cmocka_unit_test(restart_settles_at_once),
        cmocka_unit_test(coarse_steps_still_close_the_gaps),
        cmocka_unit_test(failed_step_restores_the_contact),
        cmocka_unit_test(rest_forgets_the_contact),
        cmocka_unit_test(penetrating_body_is_pushed_out),
        cmocka_unit_test(face_that_looks_away_is_refused),
        cmocka_unit_test(centre_on_a_node_stays_finite),
        cmocka_unit_test(influence_in_contact_is_the_change_of_the_equilibrium),
        cmocka_unit_test(contact_tables_out_of_range_are_refused),
        cmocka_unit_test(every_bit_of_contact_tables_counts),
        cmocka_unit_test(stiffness_out_of_range_is_refused),
        cmocka_unit_test(loose_shell_without_hold_is_told),
        cmocka_unit_test(no_body_jumps_through_a_plate),
        cmocka_unit_test(small_ball_between_nodes_is_refused),
        cmocka_unit_test(body_on_the_wrong_side_is_refused),
        cmocka_unit_test(no_body_by_formula_jumps_through_a_plate),
        cmocka_unit_test(no_shell_jumps_through_a_body),
        cmocka_unit_test(body_that_never_touches_is_let_go),
        cmocka_unit_test(body_that_moves_far_gets_load_steps),
        cmocka_unit_test(body_out_of_range_is_refused),
        cmocka_unit_test(gap_that_is_no_number_is_refused),
        cmocka_unit_test(every_bit_of_a_body_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
