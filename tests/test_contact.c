/* Bodies and contact in either precision, on small shells made here. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "shell_rig.h"

/* ---- bodies ------------------------------------------------------------- */

#define ASLANT {(pzs_real)(2.0 / 7), (pzs_real)(3.0 / 7), (pzs_real)(6.0 / 7)}
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
    const double round = sqrt(size2 - (body->gap == pzs_gap_cylinder ? along * along : 0)) - (double)body->radius;
    return body->gap == pzs_gap_plane ? along : round;
}

/* At 1000 random points: the value; its gradient, of length 1; the derivative of that. The third derivatives of a
 * distance are below 10 / r^3, r >= .5 the distance from axis or centre. */
static void gaps_are_distances_with_their_derivatives(void **state)
{
    (void)state;
    const pzs_body *const bodies[3] = {&plane, &cylinder, &sphere};
    const double step = 0.1 * cbrt(EPS), allowed = 200 * EPS / step + 80 * step * step;
    for (int trial = 0, done = 0; done < 1000; trial++) {
        const pzs_body *body = bodies[trial % 3];
        const pzs_real x[3] = {(pzs_real)(1 + 4 * uniform()), (pzs_real)(2 + 4 * uniform()), (pzs_real)(3 + 4 * uniform())};
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
                assert_true(fabs((double)(moved_n[1][i] - moved_n[0][i]) / span - (double)h[i][j]) < allowed);
        }
    }
}

/* On the axis of a cylinder and in the centre of a sphere no direction leads out, and nothing is NaN. */
static void gaps_are_finite_on_axis_and_centre(void **state)
{
    (void)state;
    const pzs_body *const bodies[2] = {&cylinder, &sphere};
    for (int b = 0; b < 2; b++) {
        pzs_real n[3], h[3][3];
        const pzs_real gap = bodies[b]->gap(bodies[b], bodies[b]->point, n, h);
        assert_true(gap == -bodies[b]->radius);
        assert_int_equal(guard_nonfinite(n, 3), -1);
        assert_int_equal(guard_nonfinite(h[0], 9), -1);
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
    return rig_open(12, 1, 1, acos(-1.0) / 12, 0.3, h, 0, support, support == held_ring_support ? 6 : 12);
}

static rig *ring_open(fixing *support)
{
    return thin_ring_open(support, 0.1);
}

static const pzs_body ground = {pzs_gap_plane, {0, 0, (pzs_real)-1.05}, {0, 0, 1}, 0, NULL, 0};

static pzs_status settle(rig *g, double load, double move)
{
    const pzs_real amount[2] = {(pzs_real)load, (pzs_real)move};
    return pzs_equilibrium(&g->path, amount);
}

/* Gap of a node of the face at the shape reached. */
static double gap_of(const rig *g, int n)
{
    double x[3];
    pzs_real at[3], normal[3], hessian[3][3];
    for (int i = 0; i < 3; i++) {
        x[i] = g->x[n][i] + g->h / 2 * g->e[n][2][i] - (double)g->path.amount[1] * (double)g->face.motion[i];
        for (int k = 0; k < 3; k++)
            for (int part = 0; part < 2; part++) {
                const uint16_t dof = g->node_dof[n][3 * part + k];
                x[i] += dof == PZS_FIXED ? 0 : (part ? g->h / 2 : 1) * (double)g->path.u[dof] * g->e[n][k][i];
            }
        at[i] = (pzs_real)x[i];
    }
    return (double)g->contact.body->gap(g->contact.body, at, normal, hessian);
}

/* Gaps are open or closed, pressures push, and no pressure acts across a gap; nodes and force are their sums. */
static void assert_complementary(const rig *g)
{
    const double size = (double)g->face.size, closed = size * fmax(1e-8, 64 * EPS);
    int touching = 0;
    for (int n = 0; n < g->nodes; n++) {
        assert_true(gap_of(g, n) >= -closed);
        assert_true(g->contact.pressure[n] >= 0);
        assert_true(g->contact.pressure[n] == 0 || gap_of(g, n) <= closed);
        touching += g->contact.pressure[n] > 0;
    }
    assert_int_equal(touching, g->contact.nodes);
}

/* Force of a contact at path->u onto f. */
static void contact_force(rig *g, pzs_real *f)
{
    memset(f, 0, (size_t)g->dof * sizeof *f);
    g->contact.option.call->add(&g->contact.option, &g->path, f);
}

/* Where a gap is closed the added matrix is minus the derivative of the force, and `unit` its derivative with respect
 * to the motion: one node anywhere on a sphere of size 1, to the differences' step^2. */
static void contact_tangent_is_the_derivative_of_its_force(void **state)
{
    (void)state;
    const double step = cbrt(EPS), motion[3] = {0.3, -0.5, 0.8};
    for (int trial = 0; trial < 50; trial++) {
        const pzs_body ball = {pzs_gap_sphere, {(pzs_real)uniform(), (pzs_real)uniform(), -2}, {0, 0, 0}, 1, NULL, 0};
        rig *g = ring_open(nothing);
        pzs_real f[2][7 * MOST_NODES];
        const int n = trial % g->nodes;
        attach_contact(g, &ball, motion);
        set_random(g, 0.3);
        g->path.amount[1] = (pzs_real)0.1;
        g->body.radius += (pzs_real)gap_of(g, n);
        g->contact.touching[n] = 1;
        g->contact.pressure[n] = 1;
        g->contact.stiffness = (pzs_real)0.1;
        const double tolerance = 400 * EPS / step + 100 * step * step;
        for (int k = 0; k <= 6; k++) { /* six unknowns of the node, then the motion */
            const uint16_t *dof = g->node_dof[n];
            pzs_real *moved = k < 6 ? &g->path.u[dof[k]] : &g->path.amount[1], unit[7 * MOST_NODES] = {0};
            const pzs_real at = *moved;
            volatile pzs_real ahead = at + (pzs_real)step, behind = at - (pzs_real)step;
            pzs_real column[6];
            g->contact.option.call->unit(&g->contact.option, &g->path, 1, unit);
            linalg_clear(&g->model.k);
            contact_force(g, f[0]);
            for (int i = 0; i < 6; i++) {
                const uint16_t *high = &dof[i > k ? i : k], *low = &dof[i > k ? k : i];
                column[i] = k < 6 ? -*linalg_entry(&g->model.k, *high, *low) : unit[dof[i]];
            }
            *moved = ahead;
            contact_force(g, f[1]);
            *moved = behind;
            contact_force(g, f[0]);
            *moved = at;
            for (int i = 0; i < 6; i++)
                assert_true(fabs((double)((f[1][dof[i]] - f[0][dof[i]]) / (ahead - behind) - column[i])) < tolerance);
        }
        rig_close(g);
    }
}

static void ring_on_the_ground_carries_its_load(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    assert_int_equal(g->contact.loose, 1);
    for (int k = 1; k <= 4; k++) {
        assert_int_equal(settle(g, 1e-5 * k, 0), PZS_OK);
        assert_complementary(g);
        assert_true(g->contact.nodes > 0);
        assert_true(fabs((double)g->contact.force[2] / (1e-5 * k) - 1) < (IS_FLOAT ? 2e-3 : 1e-6));
    }
    rig_close(g);
}

/* Whatever kappa, the same shape and the same pressures: on a thin ring, whose own stiffness is far below kappa's. */
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
        g->contact.stiffness = (pzs_real)kappa[k];
        g->path.change = IS_FLOAT ? (pzs_real)1e-4 : (pzs_real)1e-9;
        assert_int_equal(settle(g, load, 0), PZS_OK);
        assert_complementary(g);
        for (int i = 0; i < g->dof && k > 0; i++)
            assert_true(fabs((double)(g->path.u[i] - u[i])) < (IS_FLOAT ? 1e-3 : 1e-6));
        for (int n = 0; n < g->nodes && k > 0; n++)
            assert_true(fabs((double)(g->contact.pressure[n] - pressure[n])) < (IS_FLOAT ? 1e-2 : 1e-6) * load / area);
        memcpy(u, g->path.u, (size_t)g->dof * sizeof *u);
        memcpy(pressure, g->contact.pressure, (size_t)g->nodes * sizeof *pressure);
        rig_close(g);
    }
}

/* A held shell that is pulled away feels nothing of the body: the same bits as without it. */
static void contact_never_pulls(void **state)
{
    (void)state;
    rig *g = ring_open(held_ring_support), *alone = ring_open(held_ring_support);
    attach_contact(g, &ground, down);
    assert_int_equal(g->contact.loose, 0);
    assert_int_equal(settle(g, 0, -0.01), PZS_OK); /* press first */
    assert_complementary(g);
    assert_true(g->contact.force[2] > 0);
    assert_int_equal(settle(g, 5e-5, 1), PZS_OK);
    assert_int_equal(settle(alone, 5e-5, 1), PZS_OK);
    assert_int_equal(g->contact.nodes, 0);
    assert_true(g->contact.force[2] == 0);
    for (int i = 0; i < g->dof; i++)
        assert_true(fabs((double)(g->path.u[i] - alone->path.u[i])) < (IS_FLOAT ? 1e-4 : 1e-9));
    rig_close(g);
    rig_close(alone);
}

/* A loose shell that is pulled off its body has no equilibrium, and the last one stands. */
static void pulled_off_fails_with_a_status(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    g->path.systems_allowed = 200;
    assert_int_equal(settle(g, 3e-5, 0), PZS_OK);
    assert_true(PZS_IS_ERROR(settle(g, -3e-5, 0)));
    assert_int_equal(guard_nonfinite(g->path.u, (uint32_t)g->dof), -1);
    assert_true(g->path.factor <= (pzs_real)0.5); /* half of the way is no load at all */
    assert_complementary(g);
    rig_close(g);
}

static void restart_settles_at_once(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_true(g->path.systems > 1);
    g->path.change = (pzs_real)1e-3; /* of a thousandth of the displacement: above the rounding of either precision */
    const uint16_t nodes = g->contact.nodes;
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_int_equal(g->path.systems, 1);
    assert_int_equal(g->contact.nodes, nodes);
    rig_close(g);
}

/* However coarse the increments that are let pass, gaps are closed and no node is left to change. */
static void coarse_steps_still_close_the_gaps(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    g->path.change = (pzs_real)0.9;
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
    memcpy(u, g->path.u, (size_t)g->dof * sizeof *u);
    memcpy(pressure, g->contact.pressure, (size_t)g->nodes * sizeof *pressure);
    memcpy(touching, g->contact.touching, (size_t)g->nodes);
    g->path.systems_allowed = 2;
    assert_int_equal(settle(g, 5e-5, 0.5), PZS_E_SYSTEMS);
    assert_memory_equal(u, g->path.u, (size_t)g->dof * sizeof *u);
    assert_memory_equal(pressure, g->contact.pressure, (size_t)g->nodes * sizeof *pressure);
    assert_memory_equal(touching, g->contact.touching, (size_t)g->nodes);
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
    const uint32_t systems = g->path.systems;
    memcpy(u, g->path.u, (size_t)g->dof * sizeof *u);
    pzs_path_rest(&g->path);
    assert_int_equal(g->contact.nodes, 0);
    assert_true(g->contact.force[2] == 0);
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_int_equal(g->path.systems, systems);
    assert_memory_equal(u, g->path.u, (size_t)g->dof * sizeof *u);
    rig_close(g);
}

/* A body that penetrates the shell at rest pushes it out; so does one that is moved into it. */
static void penetrating_body_is_pushed_out(void **state)
{
    (void)state;
    const pzs_body ball = {pzs_gap_sphere, {(pzs_real)0.6, (pzs_real)0.15, (pzs_real)(0.05 + 0.98)}, {0, 0, 0}, 1, NULL, 0};
    rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.1, 0, strip_support, 6);
    attach_contact(g, &ball, down);
    assert_int_equal(settle(g, 0, 0), PZS_OK);
    assert_complementary(g);
    assert_true(g->contact.force[2] < 0);
    const pzs_real first = g->contact.force[2];
    assert_int_equal(settle(g, 0, 0.03), PZS_OK);
    assert_complementary(g);
    assert_true(g->contact.force[2] < first);
    rig_close(g);
}

/* A face that looks away from the body is left alone, however deep it lies in it: it is the far side of the shell. */
static void face_that_looks_away_is_left_alone(void **state)
{
    (void)state;
    const pzs_body below = {pzs_gap_plane, {0, 0, (pzs_real)0.2}, {0, 0, 1}, 0, NULL, 0};
    rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.1, 0, strip_support, 6);
    attach_contact(g, &below, still);
    assert_int_equal(settle(g, 1e-6, 0), PZS_OK);
    assert_int_equal(g->contact.nodes, 0);
    rig_close(g);
}

/* A sphere whose centre is a node of the face: a status, and nothing that is not finite. */
static void centre_on_a_node_stays_finite(void **state)
{
    (void)state;
    const pzs_body ball = {pzs_gap_sphere, {(pzs_real)0.6, 0, (pzs_real)0.05}, {0, 0, 0}, (pzs_real)0.15, NULL, 0};
    rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.1, 0, strip_support, 6);
    attach_contact(g, &ball, down);
    settle(g, 1e-5, 0);
    assert_int_equal(guard_nonfinite(g->path.u, (uint32_t)g->dof), -1);
    assert_int_equal(guard_nonfinite(g->contact.pressure, (uint32_t)g->nodes), -1);
    assert_int_equal(guard_nonfinite(g->contact.force, 3), -1);
    rig_close(g);
}

/* Influence of a dead load and of the body's motion on a shell in contact: the change of the equilibrium itself, as far
 * as kappa makes the body rigid. */
static void influence_in_contact_is_the_change_of_the_equilibrium(void **state)
{
    (void)state;
    if (IS_FLOAT)
        return; /* differences of equilibria need the digits */
    const pzs_body drum = {pzs_gap_cylinder, {0, 0, (pzs_real)(-1.05 - 3)}, {0, 1, 0}, 3, NULL, 0};
    rig *g = ring_open(held_ring_support);
    attach_contact(g, &drum, up);
    g->path.change = (pzs_real)1e-10;
    g->contact.stiffness = 10000;
    pzs_real influence[2];
    assert_int_equal(settle(g, 1e-4, 0.05), PZS_OK);
    assert_in_range(g->contact.nodes, 1, 26);
    assert_int_equal(pzs_influence_at(&g->path, influence), PZS_OK);
    const double step[2] = {1e-7, 1e-5};
    for (int j = 0; j < 2; j++) {
        double y[2];
        for (int side = 0; side < 2; side++) {
            const double change = side ? step[j] : -step[j];
            assert_int_equal(settle(g, 1e-4 + (j == 0) * change, 0.05 + (j == 1) * change), PZS_OK);
            y[side] = (double)g->path.u[g->output_dof[0]];
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
        bad[i].crc = i < 3 ? contact_crc(&bad[i], &g->structure) : 0;
        assert_int_equal(pzs_attach_contact(&g->path, &g->contact, &bad[i], &g->body, g->contact_work, bytes),
                         PZS_E_ARGUMENT);
    }
    assert_int_equal(pzs_attach_contact(&g->path, &g->contact, &g->face, &g->body, g->contact_work, bytes - 1),
                     PZS_E_WORKSPACE);
    assert_int_equal(g->path.where, bytes);
    assert_int_equal(pzs_attach_contact(&g->path, &g->contact, &g->face, &g->body, g->contact_work, bytes), PZS_E_ARGUMENT);
    rig_close(g);
}

static pzs_status attach_face(rig *g)
{
    return pzs_attach_contact(&g->path, &g->contact, &g->face, &g->body, g->contact_work, PZS_CONTACT_BYTES(g->nodes));
}

static void every_bit_of_contact_tables_counts(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    pzs_contact_face *f = &g->face;
    const size_t nodes = (size_t)g->nodes;
    attach_contact(g, &ground, still);
    g->path.option = NULL;
    assert_bits_count(g, &f->format, 3 * sizeof f->format, attach_face);
    assert_bits_count(g, &f->face, sizeof f->face, attach_face);
    assert_bits_count(g, &f->input, sizeof f->input, attach_face);
    assert_bits_count(g, f->motion, sizeof f->motion + sizeof f->size, attach_face);
    assert_bits_count(g, g->place, nodes * sizeof *g->place, attach_face);
    assert_bits_count(g, g->triad, nodes * sizeof *g->triad, attach_face);
    assert_bits_count(g, g->area, nodes * sizeof *g->area, attach_face);
    assert_null(g->path.option);
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
        g->contact.stiffness = bad[i];
        assert_int_equal(settle(g, 3e-5, 0), PZS_E_ARGUMENT);
    }
    g->contact.stiffness = 10;
    assert_int_equal(settle(g, 3e-5, 0), PZS_OK);
    rig_close(g);
}

/* Not even sideways. */
static int ring_unsupported(int i, int j, int k)
{
    (void)i, (void)j;
    return k == 1 || k == 4;
}

/* A loose shell that the body does not hold, whatever the reason: apart from it, not pressed onto it, free to slide: in
 * float the stiffness against that is not 0 but rounding. */
static void loose_shell_without_hold_is_told(void **state)
{
    (void)state;
    const double gap[5] = {0.01, 5, 0, 0, 0}, load[5] = {3e-5, 3e-5, 0, -3e-5, 3e-5};
    for (int i = 0; i < (IS_FLOAT ? 4 : 5); i++) {
        const pzs_body away = {pzs_gap_plane, {0, 0, (pzs_real)(-1.05 - gap[i])}, {0, 0, 1}, 0, NULL, 0};
        rig *g = ring_open(i < 4 ? ring_support : ring_unsupported);
        attach_contact(g, &away, still);
        assert_int_equal(g->contact.loose, 1);
        assert_int_equal(settle(g, load[i], 0), PZS_E_CONTACT);
        assert_true(g->path.factor == 0);
        for (int d = 0; d < g->dof; d++)
            assert_true(g->path.u[d] == 0);
        rig_close(g);
    }
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
        cmocka_unit_test(face_that_looks_away_is_left_alone),
        cmocka_unit_test(centre_on_a_node_stays_finite),
        cmocka_unit_test(influence_in_contact_is_the_change_of_the_equilibrium),
        cmocka_unit_test(contact_tables_out_of_range_are_refused),
        cmocka_unit_test(every_bit_of_contact_tables_counts),
        cmocka_unit_test(stiffness_out_of_range_is_refused),
        cmocka_unit_test(loose_shell_without_hold_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
