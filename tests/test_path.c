/* The nonlinear path on scenes with known answers, its laws, and the loads that it cannot carry. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "model.h"
#include "scene_run.h"
#include "shell.h"

/* 1: also the rows that take seconds each. */
#ifndef SLOW_ROWS
#define SLOW_ROWS 0
#endif

#define SOURCE "element=source;"
#define CORRECTED "element=corrected;"
#define METRIC_OFF "element={kinematics: cartesian, metric: off};"
#define MESH(n1, n2) "mesh.theta1.elements=" #n1 ";mesh.theta2.elements=" #n2 ";"
#define COUNT(a) (sizeof(a) / sizeof *(a))

/* ---- runs ------------------------------------------------------------- */

static void open_run(scene_run *r, const char *scene, const char *changes)
{
    if (scene_run_open(r, scene, changes) < 0)
        fail_msg("%s %s: %s", scene, changes, r->error);
}

static void solve_run(scene_run *r, const char *scene, const char *changes)
{
    open_run(r, scene, changes);
    if (scene_run_solve(r) < 0)
        fail_msg("%s %s: %s", scene, changes, r->error);
}

static pzs_path *path_of(scene_run *r)
{
    return &r->analysis.path.run;
}

static size_t dof_of(const scene_run *r)
{
    return (size_t)r->analysis.design.mesh.dof;
}

static double largest(const double *x, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

/* Largest difference of two vectors over the largest entry of the second. */
static double apart(const double *x, const double *y, size_t n)
{
    double most = 0;
    for (size_t i = 0; i < n; i++)
        most = isfinite(x[i]) ? fmax(most, fabs(x[i] - y[i])) : HUGE_VAL;
    return most / largest(y, n);
}

/* ---- tables ----------------------------------------------------------- */

typedef struct row {
    const char *scene, *changes;
    double expected[3];          /* of the scene's first outputs; 0 ends them */
    double unit[3];              /* an output is expected * unit; 0: 1 */
    double digit;                /* half a unit of the last one known */
    double tolerance;            /* relative */
    uint32_t steps, systems;     /* exactly; at most */
    uint32_t negative;           /* pivots */
} row;

#define RING_UNIT {100, -100}
#define DEAD "loads=[{face: inner, pressure: -3*2.1e7/(12*(1-0.3^2)*100^3)*(1-cos(2*theta1))}];"
#define TRUE_PRESSURE "loads.0.follower=pressure;"
#define STEPS(n) "equilibrium.steps=" #n ";"
#define HALF_TURN "actuators.v.applied=4*0.05^2*(pi/10)/(3*1e-6);"

/* The source's element in one load step: systems as its tables or as a second program needed, whichever is more. */
static const row tables[] = {
    {"hemisphere", SOURCE MESH(4, 4), {-7.046, 3.261}, {0}, 5e-4, 1e-4, 1, 8, 0},
    {"hemisphere", SOURCE MESH(8, 8), {-8.099, 3.9505}, {0}, 5e-4, 1e-4, 1, 8, 0},
    {"hemisphere", SOURCE MESH(16, 16), {-8.1326, 4.0511}, {0}, 5e-5, 1e-4, 1, 8, 0},
    {"annular-plate", SOURCE MESH(2, 4), {12.7389, 16.0252}, {0}, 5e-5, 1e-4, 1, 7, 0},
    {"annular-plate", SOURCE MESH(4, 8), {12.5740, 16.0916}, {0}, 5e-5, 1e-4, 1, 9, 1},
    {"annular-plate", SOURCE MESH(6, 12), {12.926, 16.530}, {0}, 5e-4, 1e-4, 1, 10, 0},
    {"annular-plate", SOURCE MESH(16, 32), {13.6697, 17.3024}, {0}, 5e-5, 1e-4, 1, 11, 0},
    {"annular-plate", SOURCE MESH(10, 40), {13.690, 17.325}, {0}, 5e-4, 1e-4, 1, 12, 0},
    {"annular-plate", SOURCE MESH(10, 80), {13.7603, 17.3975}, {0}, 5e-5, 1e-4, 1, 14, 0},
    {"ring-follower", SOURCE, {.3660, .8391}, RING_UNIT, 5e-5, 1e-4, 1, 8, 0},
    {"ring-follower", SOURCE STEPS(5), {.3660, .8391}, RING_UNIT, 5e-5, 1e-4, 5, 30, 0},
    {"ring-follower", SOURCE STEPS(10), {.3660, .8391}, RING_UNIT, 5e-5, 1e-4, 10, 60, 0},
    {"ring-follower", SOURCE TRUE_PRESSURE, {.3659, .8393}, RING_UNIT, 5e-5, 1e-4, 1, 8, 0},
    {"ring-follower", SOURCE MESH(72, 1), {.3675, .8471}, RING_UNIT, 5e-5, 1e-4, 1, 8, 0},
    {"ring-follower", SOURCE DEAD, {.3554, .8217}, RING_UNIT, 5e-5, 1e-4, 1, 7, 0},
    {"ring-follower", SOURCE DEAD STEPS(5), {.3554, .8217}, RING_UNIT, 5e-5, 1e-4, 5, 23, 0},
    {"ring-follower", SOURCE DEAD STEPS(10), {.3554, .8217}, RING_UNIT, 5e-5, 1e-4, 10, 40, 0},
    {"hyperboloid", SOURCE MESH(8, 8), {2.6651, -3.3148}, {0}, 5e-5, 1e-4, 1, 8, 0},
    {"hyperboloid", SOURCE MESH(16, 16), {2.7598, -3.4755}, {0}, 5e-5, 1e-4, 1, 8, 0},
    {"hyperboloid", SOURCE MESH(28, 28), {2.7815, -3.5175}, {0}, 5e-5, 1e-4, 1, 8, 0},
    {"roll-up", SOURCE HALF_TURN MESH(40, 1), {-10.0038, 6.3646}, {0}, 5e-5, 1e-4, 1, 9, 0},
    {"roll-up", SOURCE MESH(10, 1), {-9.82308, .0098742}, {0}, 5e-6, 1e-4, 1, 13, 0},
    {"roll-up", SOURCE MESH(20, 1), {-9.9535}, {0}, 5e-5, 1e-4, 1, 13, 0},
    {"roll-up", SOURCE MESH(40, 1), {-9.9847, .0001}, {0}, 5e-5, 1e-4, 1, 13, 0},
};

/* Two or three load steps from the start, as the source: at most its six steps; no count of systems is known of it. */
static const row soft[] = {
    {"hyperboloid-soft", SOURCE MESH(8, 8), {3.3942, -4.7741}, {0}, 5e-5, 1e-4, 2, 80, 0},
    {"hyperboloid-soft", SOURCE MESH(16, 16), {3.7629, -5.6421}, {0}, 5e-5, 1e-4, 2, 80, 0},
    {"hyperboloid-soft", SOURCE MESH(28, 28) STEPS(3), {3.8313, -6.0676}, {0}, 5e-5, 1e-4, 3, 120, 0},
};

static const row corrected[] = {
    {"hemisphere", METRIC_OFF MESH(4, 4), {-9.1183, 4.0804}, {0}, 5e-5, 1e-4, 1, 8, 0},
    {"hemisphere", METRIC_OFF MESH(8, 8), {-8.3806, 4.0846}, {0}, 5e-5, 1e-4, 1, 8, 0},
    {"hemisphere", METRIC_OFF MESH(16, 16), {-8.2045, 4.0823}, {0}, 5e-5, 1e-4, 1, 8, 0},
    {"annular-plate", METRIC_OFF MESH(2, 4), {12.5187, 16.2711}, {0}, 5e-5, 1e-4, 1, 9, 0},
    {"annular-plate", METRIC_OFF MESH(4, 8), {13.0419, 16.7341}, {0}, 5e-5, 1e-4, 1, 8, 0},
    {"annular-plate", METRIC_OFF MESH(6, 12), {13.4105, 17.0780}, {0}, 5e-5, 1e-4, 1, 9, 0},
    {"annular-plate", METRIC_OFF MESH(10, 40), {13.7822, 17.4201}, {0}, 5e-5, 1e-4, 1, 10, 0},
    {"hyperboloid", METRIC_OFF MESH(8, 8), {2.786, -3.466}, {0}, 5e-4, 1e-4, 1, 8, 0},
    {"hyperboloid", METRIC_OFF MESH(16, 16), {2.791, -3.514}, {0}, 5e-4, 1e-4, 1, 8, 0},
    {"hyperboloid", METRIC_OFF MESH(28, 28), {2.792, -3.530}, {0}, 5e-4, 1e-4, 1, 8, 0},
};

#define BASE_100 "contact.body={type: cylinder, point: [200.5, 0, 0], axis: [0, 0, 1], radius: 100};"
#define BASE_FLAT "contact.body={type: plane, point: [100.5, 0, 0], normal: [-1, 0, 0]};"
#define PLANE_STRAIN "supports.2={at: nodes, fix: u2};"
#define RING_LOAD {1, -2.1e7 / (120 * 100. * 100) / 2, 1} /* of the resultant's half */
#define CYLINDER_LOAD {1, 1, -2.1e7 * 200 / (120 * .91 * 100. * 100) / 4}

static const row contacts[] = {
    {"ring-contact", SOURCE MESH(30, 1), {-198.021, 88.949, 2}, RING_LOAD, 5e-4, 1e-4, 1, 91, 0},
    {"ring-contact", SOURCE MESH(60, 1), {-198.823, 88.614, 3}, RING_LOAD, 5e-4, 1e-4, 1, 91, 0},
    {"ring-contact", SOURCE MESH(30, 1) BASE_100, {-209.032, 88.977}, RING_LOAD, 5e-4, 1e-4, 1, 91, 0},
    {"ring-contact", SOURCE MESH(60, 1) BASE_100, {-209.773, 88.621}, RING_LOAD, 5e-4, 1e-4, 1, 91, 0},
    {"ring-contact", SOURCE MESH(30, 1) PLANE_STRAIN, {-173.28}, {0}, 5e-3, 1e-4, 1, 91, 0},
    {"ring-contact", SOURCE MESH(60, 1) PLANE_STRAIN, {-174.18}, {0}, 5e-3, 1e-4, 1, 91, 0},
    {"ring-contact", SOURCE MESH(30, 1) PLANE_STRAIN BASE_100, {-193.08}, {0}, 5e-3, 1e-4, 1, 91, 0},
    {"ring-contact", SOURCE MESH(60, 1) PLANE_STRAIN BASE_100, {-193.76}, {0}, 5e-3, 1e-4, 1, 91, 0},
    {"ring-contact", SOURCE MESH(30, 1) PLANE_STRAIN BASE_FLAT, {-170.12}, {0}, 5e-3, 1e-4, 1, 91, 0},
    {"ring-contact", SOURCE MESH(60, 1) PLANE_STRAIN BASE_FLAT, {-170.86}, {0}, 5e-3, 1e-4, 1, 91, 0},
    {"cylinder-contact", SOURCE, {-195.591, -194.816, 87.907}, CYLINDER_LOAD, 5e-4, 1e-3, 1, 28, 0},
    {"cylinder-contact", SOURCE "equilibrium={steps: 5};", {-195.591, -194.816, 87.907}, CYLINDER_LOAD, 5e-4, 1e-3, 5, 259, 0},
};

static const row slow_contacts[] = {
    {"cylinder-contact", SOURCE MESH(20, 60) "equilibrium={steps: 5};", {-196.988, -196.033, 87.602}, CYLINDER_LOAD, 5e-4, 1e-3, 5, 335, 0},
    {"cylinder-contact", SOURCE MESH(20, 60), {-196.988, -196.033, 87.602}, CYLINDER_LOAD, 5e-4, 1e-3, 1, 335, 0},
    {"torus-contact", SOURCE "loads=[{face: inner, pressure: 0.5}];", {-16.9079, -3547.744, 163}, {0}, 5e-4, 1e-3, 2, 34, 14},
};

#define TORUS_DEAD "loads=[{face: inner, pressure: 0.5}];"
#define ROAD "contact.body={type: plane, point: [252.4, 0, 0], normal: [-1, 0, 0]};"
#define COARSE MESH(24, 18)

/* The coarse azimuths of the contact buckle: their answers are those of the second program, their pivots as counted here. */
static const row tori[] = {
    {"torus-pressure", SOURCE MESH(24, 36), {1.2961}, {0}, 5e-5, 1e-3, 1, 6, 0},
    {"torus-pressure", SOURCE MESH(48, 36), {1.2844}, {0}, 5e-5, 1e-3, 1, 6, 0},
    {"torus-pressure", SOURCE MESH(48, 36) TRUE_PRESSURE, {1.2138}, {0}, 5e-5, 1e-3, 1, 6, 0},
    {"torus-pressure", SOURCE MESH(48, 36) TORUS_DEAD, {1.1261}, {0}, 5e-5, 1e-3, 1, 6, 0},
    {"torus-spline", SOURCE MESH(48, 36), {1.28137}, {0}, 5e-6, 1e-3, 1, 6, 0},
    {"torus-contact", SOURCE COARSE, {-16.9294, -4388.304}, {0}, 5e-4, 1e-3, 1, 7, 8},
    {"torus-contact", SOURCE COARSE TORUS_DEAD, {-16.9109, -3724.009}, {0}, 5e-4, 1e-3, 1, 7, 7},
    {"torus-contact", SOURCE COARSE ROAD, {-16.8896, -4671.947}, {0}, 5e-4, 1e-3, 1, 7, 8},
    {"torus-contact", SOURCE COARSE TORUS_DEAD ROAD, {-16.9101, -3975.009}, {0}, 5e-4, 1e-3, 1, 7, 7},
    {"torus-contact", SOURCE, {-16.9213, -4199.927, 175}, {0}, 5e-4, 1e-3, 1, 7, 17},
};

/* Print what is off in a row; returns whether anything is. */
static int row_fails(const row *t)
{
    scene_run r;
    open_run(&r, t->scene, t->changes);
    const pzs_path *path = path_of(&r);
    const int failed = scene_run_solve(&r) < 0;
    int wrong = failed || path->steps_taken != t->steps || path->systems > t->systems || path->negative != t->negative;
    wrong = wrong || r.analysis.status != (t->negative ? PZS_W_UNSTABLE : PZS_OK);
    for (int k = 0; k < 3 && t->expected[k] != 0; k++) {
        const double unit = t->unit[k] != 0 ? t->unit[k] : 1, got = scene_run_value(&r, k) / unit;
        if (!(fabs(got - t->expected[k]) <= fmax(t->digit, t->tolerance * fabs(t->expected[k])))) {
            print_error("%s %s output %d: %.7g, known %.7g\n", t->scene, t->changes, k, got, t->expected[k]);
            wrong = 1;
        }
    }
    if (wrong)
        print_error("%s %s: %u steps of %u, %u systems of %u, %u negative pivots of %u; %s\n", t->scene, t->changes, path->steps_taken,
                    t->steps, path->systems, t->systems, path->negative, t->negative, failed ? r.error : "settled");
    scene_run_close(&r);
    return wrong;
}

static void check_rows(const row *t, size_t count)
{
    int wrong = 0;
    for (size_t i = 0; i < count; i++)
        wrong += row_fails(&t[i]);
    assert_int_equal(wrong, 0);
}

/* Law: the source's tables 1, 2, 3, fig. 8 and the strip rolled up, value by value, in one load step where the source has one. */
static void test_tables(void **state)
{
    (void)state;
    check_rows(tables, COUNT(tables));
    check_rows(soft, COUNT(soft));
}

/* Law: the corrected element on the same shells. */
static void test_corrected_tables(void **state)
{
    (void)state;
    check_rows(corrected, COUNT(corrected));
}

/* Law: tables 4 and 5, rings and cylinders on rigid bases. */
static void test_contact_tables(void **state)
{
    (void)state;
    check_rows(contacts, COUNT(contacts));
    check_rows(slow_contacts, SLOW_ROWS * COUNT(slow_contacts));
}

/* Law: the inflated torus, free and pressed on a road. */
static void test_torus_tables(void **state)
{
    (void)state;
    check_rows(tori, COUNT(tori));
}

/* ---- the way does not matter, and what one step may miss -------------- */

/* Law: 1, 2, 5 and 10 load steps end in one state, stable, where the corrected element is used. */
static void test_steps_agree(void **state)
{
    (void)state;
    static const char *const steps[] = {"2", "5", "10"};
    scene_run one;
    solve_run(&one, "annular-plate", CORRECTED MESH(4, 8) "equilibrium={change: 1e-8};");
    for (size_t i = 0; i < COUNT(steps); i++) {
        char changes[256];
        snprintf(changes, sizeof changes, CORRECTED MESH(4, 8) "equilibrium={change: 1e-8, steps: %s}", steps[i]);
        scene_run r;
        solve_run(&r, "annular-plate", changes);
        assert_int_equal(path_of(&r)->negative, 0);
        assert_true(apart(r.u, one.u, dof_of(&one)) < 1e-7);
        scene_run_close(&r);
    }
    scene_run_close(&one);
}

/*
 * Law: meshes on which the mixed iterates lead astray settle all the same; the plain Newton method reaches the same shape in
 * no fewer load steps.
 */
static void test_astray_meshes(void **state)
{
    (void)state;
    static const char *const mesh[] = {MESH(4, 16), MESH(8, 16), MESH(32, 16)};
    for (size_t i = 0; i < COUNT(mesh); i++) {
        char changes[256];
        snprintf(changes, sizeof changes, SOURCE "%sequilibrium={systems: 1000, change: 1e-7}", mesh[i]);
        scene_run mixed;
        solve_run(&mixed, "annular-plate", changes);
        snprintf(changes, sizeof changes, SOURCE "%sequilibrium={systems: 1000, change: 1e-7, mixed: 0}", mesh[i]);
        scene_run plain;
        solve_run(&plain, "annular-plate", changes);
        print_message("annular plate %s: mixed %u steps %u systems, plain %u steps %u systems\n", mesh[i], path_of(&mixed)->steps_taken,
                      path_of(&mixed)->systems, path_of(&plain)->steps_taken, path_of(&plain)->systems);
        assert_int_equal(mixed.analysis.status, PZS_OK);
        assert_true(path_of(&mixed)->steps_taken < path_of(&plain)->steps_taken);
        assert_true(apart(mixed.u, plain.u, dof_of(&plain)) < 1e-5);
        scene_run_close(&mixed);
        scene_run_close(&plain);
    }
}

/* Law: with extrapolated resultants the hemisphere settles in one load step, the plain Newton method needs more. */
static void test_mixed_beats_plain(void **state)
{
    (void)state;
    scene_run mixed;
    solve_run(&mixed, "hemisphere", SOURCE MESH(4, 4));
    scene_run plain;
    solve_run(&plain, "hemisphere", SOURCE MESH(4, 4) "equilibrium={mixed: 0}");
    assert_int_equal(path_of(&mixed)->steps_taken, 1);
    assert_true(path_of(&plain)->steps_taken > 1);
    assert_true(path_of(&plain)->systems > path_of(&mixed)->systems);
    assert_true(apart(mixed.u, plain.u, dof_of(&plain)) < 1e-4);
    scene_run_close(&mixed);
    scene_run_close(&plain);
}

/* ---- rigid motion ----------------------------------------------------- */

/* Twice the strain energy at u, from strains (*linear: from strains of first order alone). */
static double energy(const scene_run *r, const double *u, int linear)
{
    const pzs_structure *s = &r->analysis.design.structure;
    double sum = 0;
    for (uint32_t e = 0; e < s->elements; e++) {
        const pzs_kind *kind = &s->kind[s->element_kind[e]];
        double v[SHELL_MAX], f[SHELL_MAX], strain[4][10];
        model_gather(&r->analysis.model, s->element[e], SHELL_NODES, u, v);
        shell_force(kind, s->unknowns, v, f);
        for (unsigned i = 0; linear && i < SHELL_NODES * s->unknowns; i++)
            sum += v[i] * f[i];
        shell_strains_at(kind, s->unknowns, v, strain);
        for (int m = 0; !linear && m < 4; m++)
            for (int i = 0; i < 10; i++)
                for (int j = 0; j < 10; j++)
                    sum += strain[m][i] * strain[m][j] * kind->d[m][i > j ? SHELL_PACKED(i) + j : SHELL_PACKED(j) + i];
    }
    return sum;
}

/* Law: a corrected shell follows a finite turn of one edge as a rigid body, without strain energy. */
static void test_rigid_motion(void **state)
{
    (void)state;
    static const char *const element[] = {CORRECTED, METRIC_OFF};
    for (size_t k = 0; k < COUNT(element); k++) {
        scene_run r;
        solve_run(&r, "tests/scenes/rigid.yaml", element[k]);
        const design *d = &r.analysis.design;
        for (int n = 0; n < d->mesh.nodes; n++) {
            const double *x = d->mesh.point[n].x, want[3] = {0, x[1] * (cos(0.6) - 1) - x[2] * sin(0.6), x[1] * sin(0.6) + x[2] * (cos(0.6) - 1)};
            for (int i = 0; i < 3; i++)
                assert_true(fabs(r.output[d->named_first[i] + n] - want[i]) < 1e-11 * 10);
        }
        assert_true(energy(&r, r.u, 0) < 1e-20 * energy(&r, r.u, 1));
        scene_run_close(&r);
    }
}

/* Law: in local components a turned mesh costs energy, which falls with the fourth power of the element size. */
static void test_rigid_motion_of_the_source(void **state)
{
    (void)state;
    double cost[2];
    for (int k = 0; k < 2; k++) {
        char changes[128];
        snprintf(changes, sizeof changes, SOURCE "mesh.theta1.elements=%d;mesh.theta2.elements=%d", 8 << k, 8 << k);
        scene_run r;
        solve_run(&r, "tests/scenes/rigid.yaml", changes);
        cost[k] = energy(&r, r.u, 0);
        scene_run_close(&r);
    }
    print_message("energy of a turned mesh falls by %.3g\n", cost[0] / cost[1]);
    assert_true(cost[0] / cost[1] > 12 && cost[0] / cost[1] < 20);
}

/* ---- prescribed displacements ----------------------------------------- */

/* Internal force at u. f [dof] out */
static void internal_force(const scene_run *r, const double *u, double *f)
{
    const pzs_structure *s = &r->analysis.design.structure;
    memset(f, 0, s->dof * sizeof *f);
    for (uint32_t e = 0; e < s->elements; e++) {
        double v[SHELL_MAX], own[SHELL_MAX], k[SHELL_PACKED(SHELL_MAX)];
        model_gather(&r->analysis.model, s->element[e], SHELL_NODES, u, v);
        shell_system(&s->kind[s->element_kind[e]], s->unknowns, v, NULL, NULL, own, k);
        model_scatter(&r->analysis.model, s->element[e], SHELL_NODES, 1, own, f);
    }
}

/* Law: a strip moved to a place has the shape it has under the force that holds it there, which is its reaction. */
static void test_prescribed_and_reaction(void **state)
{
    (void)state;
    static const char *const element[] = {SOURCE, CORRECTED};
    for (size_t k = 0; k < COUNT(element); k++) {
        char changes[256];
        char mesh[128];
        scene_run force;
        snprintf(mesh, sizeof mesh, "%s", element[k]);
        solve_run(&force, "tests/scenes/strip.yaml", mesh);
        assert_true(scene_run_value(&force, 0) > 5);
        snprintf(changes, sizeof changes, "%sloads.0.u3=0;supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: u3 mean, value: %.17g}]",
                 mesh, scene_run_value(&force, 0));
        scene_run moved;
        open_run(&moved, "tests/scenes/strip.yaml", changes);
        const size_t n = dof_of(&moved);
        assert_int_equal(n, dof_of(&force));
        assert_int_equal(scene_run_solve(&moved), 0);
        assert_int_equal(path_of(&moved)->steps_taken, 1);
        double *f = calloc(n, sizeof *f), reaction = 0;
        internal_force(&moved, moved.u, f);
        for (int i = 0; i < moved.analysis.design.mesh.prescribed_count; i++)
            reaction += f[moved.analysis.design.mesh.prescribed_dof[i]];
        assert_true(fabs(reaction / 2.5 - 1) < 1e-7);
        assert_true(apart(moved.u, force.u, n) < 1e-7);
        free(f);
        scene_run_close(&force);
        scene_run_close(&moved);
    }
}

/* ---- contact ---------------------------------------------------------- */

/* Law: the corrected element passes the whole force on to the base (the half of a ring's, a quarter of a cylinder's). */
static void test_contact_resultant(void **state)
{
    (void)state;
    static const struct { const char *scene, *changes; int output; double force; } cases[] = {
        {"ring-contact", CORRECTED MESH(30, 1), 1, -88.5 * 2.1e7 / (120 * 1e4) / 2},
        {"ring-contact", METRIC_OFF MESH(30, 1) BASE_100, 1, -88.5 * 2.1e7 / (120 * 1e4) / 2},
        {"cylinder-contact", CORRECTED "equilibrium={change: 1e-6};", 2, -87.5 * 2.1e7 * 200 / (120 * .91 * 1e4) / 4},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        scene_run r;
        solve_run(&r, cases[i].scene, cases[i].changes);
        const double got = scene_run_value(&r, cases[i].output);
        if (!(fabs(got / cases[i].force - 1) < 1e-6))
            fail_msg("%s %s: %.9g of %.9g", cases[i].scene, cases[i].changes, got, cases[i].force);
        scene_run_close(&r);
    }
}

/* Law: the state does not depend on the stiffness of contact. */
static void test_contact_stiffness(void **state)
{
    (void)state;
    static const char *const element[] = {SOURCE, CORRECTED};
    static const char *const stiffness[] = {"1e-3", "1e-2", "0.1", "1", "100", "1e3", "1e4"};
    for (size_t e = 0; e < COUNT(element); e++) {
        char changes[256];
        scene_run ten;
        snprintf(changes, sizeof changes, "%sequilibrium.change=1e-8;" BASE_100, element[e]);
        solve_run(&ten, "ring-contact", changes);
        for (size_t k = 0; k < COUNT(stiffness); k++) {
            scene_run r;
            snprintf(changes, sizeof changes, "%sequilibrium.change=1e-8;" BASE_100 "contact.stiffness=%s", element[e], stiffness[k]);
            solve_run(&r, "ring-contact", changes);
            if (!(apart(r.u, ten.u, dof_of(&ten)) < 1e-6))
                fail_msg("%s: shapes apart by %.2g, %u systems", changes, apart(r.u, ten.u, dof_of(&ten)), path_of(&r)->systems);
            scene_run_close(&r);
        }
        scene_run_close(&ten);
    }
}

/* ---- actuation -------------------------------------------------------- */

/* Tip x of a strip in plane strain, whose free curvature 3 d31 V (1 + nu)/(4 t^2) makes `half_turns`, on 40 elements; -10 on many. */
static double tip_of_strip(const char *element, int half_turns, const char *nu)
{
    char changes[512];
    scene_run r;
    snprintf(changes, sizeof changes, "%sactuators.v.applied=4*0.05^2*(%d*pi/10)/(3*1e-6*(1+%s));supports=[{edge: theta1-, fix: clamped}, "
             "{at: nodes, fix: u2}];materials.piezo={E: 1e6, nu: %s, d31: 1e-6, d32: 1e-6}", element, half_turns, nu, nu);
    solve_run(&r, "roll-up", changes);
    const double tip = scene_run_value(&r, 0);
    const uint32_t steps = path_of(&r)->steps_taken;
    scene_run_close(&r);
    assert_true(element[8] == 's' || steps == 1);
    return tip;
}

/*
 * Law: the corrected strip rolls up to half and full circles alike for every nu, in one load step; the source's element is
 * stiff in thickness where its normal has turned.
 */
static void test_thickness_locking(void **state)
{
    (void)state;
    static const char *const nu[] = {"0.3", "0.45", "0.499"};
    for (int half_turns = 1; half_turns <= 2; half_turns++) {
        const double want = tip_of_strip(CORRECTED, half_turns, "0");
        assert_true(fabs(tip_of_strip(SOURCE, half_turns, "0") / want - 1) < 1e-4);
        for (size_t i = 0; i < COUNT(nu); i++)
            assert_true(fabs(tip_of_strip(CORRECTED, half_turns, nu[i]) / want - 1) < 1e-4);
        assert_true(fabs(tip_of_strip(SOURCE, half_turns, "0.3") / want - 1) > 3e-3);
    }
    assert_true(fabs(tip_of_strip(SOURCE, 2, "0.45") / tip_of_strip(CORRECTED, 2, "0") - 1) > 0.05);
}

/* Law: at rest the force of an input's given resultants is its column of the linear structure. */
static void test_given_force_at_rest(void **state)
{
    (void)state;
    static const char *const element[] = {SOURCE, CORRECTED, CORRECTED "unknowns=6;"};
    for (size_t k = 0; k < COUNT(element); k++) {
        char changes[128];
        scene_run r;
        snprintf(changes, sizeof changes, "%skinematics=nonlinear", element[k]);
        open_run(&r, "plate-50-patches", changes);
        const pzs_structure *s = &r.analysis.design.structure;
        const pzs_given *g = &r.analysis.path.tables.given;
        double *f = calloc(s->dof, sizeof *f), *column = calloc(s->dof, sizeof *f), zero[SHELL_MAX] = {0};
        for (uint32_t j = 0; j < 25; j++) {
            memset(f, 0, s->dof * sizeof *f);
            memset(column, 0, s->dof * sizeof *f);
            model_add_input(&r.analysis.model, j, 1, column);
            assert_true(g->start[j + 1] > g->start[j]);
            for (uint32_t t = g->start[j]; t < g->start[j + 1]; t++) {
                double own[SHELL_MAX], resultant[SHELL_RESULTANTS] = {0};
                memcpy(resultant, g->value[g->which[t]], sizeof *g->value);
                shell_force_at(&s->kind[s->element_kind[g->element[t]]], s->unknowns, zero, resultant, own);
                model_scatter(&r.analysis.model, s->element[g->element[t]], SHELL_NODES, -1, own, f);
            }
            assert_true(apart(f, column, s->dof) < 1e-12);
        }
        free(f);
        free(column);
        scene_run_close(&r);
    }
}

/* ---- influence -------------------------------------------------------- */

/* Rows of the outputs at an equilibrium with input j changed by d, from that at the scene's amounts. y [outputs] out */
static void outputs_beside(scene_run *r, uint32_t j, double d, double *y)
{
    pzs_path *path = path_of(r);
    double *amount = r->analysis.path.full;
    const double kept = amount[j];
    amount[j] += d;
    const pzs_status status = pzs_equilibrium(path, amount);
    if (PZS_IS_ERROR(status))
        fail_msg("beside the equilibrium: %s", pzs_status_text(status));
    pzs_observe(&r->analysis.design.structure, path->u, y);
    amount[j] = kept;
}

/* Central difference of the outputs by input j. y [outputs] out */
static void difference(scene_run *r, uint32_t j, double d, double *y)
{
    const size_t outputs = r->analysis.design.structure.output.count;
    double *minus = calloc(outputs, sizeof *minus);
    outputs_beside(r, j, d, y);
    outputs_beside(r, j, -d, minus);
    for (size_t i = 0; i < outputs; i++)
        y[i] = (y[i] - minus[i]) / (2 * d);
    free(minus);
}

typedef struct influence_case {
    const char *scene, *changes;
    double part;                 /* of an amount, the larger of the two differences */
} influence_case;

#define PLACES "outputs=[{name: x, x: middle, at: nodes}, {name: z, z: middle, at: nodes}];"
#define TIGHT "equilibrium={change: 1e-12};"

static const influence_case influences[] = {
    {"roll-up", SOURCE PLACES TIGHT HALF_TURN "loads=[{line: theta1+, u3: 0.02}, {temperature: 100}];"
     "materials.piezo={E: 1e6, nu: 0.3, d31: 1e-6, d32: 1e-6, alpha: 1e-5}", 2e-3},
    {"roll-up", CORRECTED PLACES TIGHT HALF_TURN "loads=[{line: theta1+, u3: 0.02}, {temperature: 100}];"
     "materials.piezo={E: 1e6, nu: 0.3, d31: 1e-6, d32: 1e-6, alpha: 1e-5}", 2e-3},
    {"tests/scenes/strip.yaml", CORRECTED PLACES TIGHT "loads.0.u3=0.5;supports=[{edge: theta1-, fix: clamped}, {edge: theta1+, fix: u3 mean, value: 5}]",
     2e-3},
    {"ring-contact", CORRECTED PLACES "equilibrium.change=1e-12;" BASE_100 "contact.move=[-1, 0, 0]", 1e-3},
};

/*
 * Law: the influence at an equilibrium is the derivative of equilibria. With D(d) the central difference over d, of error c d^2,
 * D(d/2) is off by |D(d) - D(d/2)| / 3; three times that, and the rounding of equilibria settled to 1e-12, are allowed.
 */
static void check_influence(const influence_case *c)
{
    scene_run r;
    solve_run(&r, c->scene, c->changes);
    const pzs_structure *s = &r.analysis.design.structure;
    const size_t rows = s->output.count, inputs = s->input.count;
    double *influence = calloc(rows * inputs, sizeof *influence), *coarse = calloc(rows, sizeof *coarse), *fine = calloc(rows, sizeof *fine);
    assert_int_equal(pzs_influence_at(path_of(&r), influence), PZS_OK);
    for (uint32_t j = 0; j < inputs; j++) {
        const double d = c->part * (r.analysis.path.full[j] != 0 ? r.analysis.path.full[j] : 1);
        difference(&r, j, d, coarse);
        difference(&r, j, d / 2, fine);
        const double scale = largest(fine, rows), rounding = 1e-9 * largest(r.output, rows) / fabs(d);
        double off = 0, allowed = rounding;
        for (size_t i = 0; i < rows; i++) {
            off = fmax(off, fabs(influence[i * inputs + j] - fine[i]));
            allowed = fmax(allowed, fabs(coarse[i] - fine[i]));
        }
        if (!(off <= allowed && allowed < 1e-3 * scale + rounding))
            fail_msg("%s input %u: influence off by %.3g of %.3g, %.3g allowed", c->scene, j, off, scale, allowed);
    }
    free(influence);
    free(coarse);
    free(fine);
    scene_run_close(&r);
}

static void test_influence(void **state)
{
    (void)state;
    for (size_t i = 0; i < 2; i++)
        check_influence(&influences[i]);
}

static void test_influence_of_prescribed(void **state)
{
    (void)state;
    check_influence(&influences[2]);
}

static void test_influence_in_contact(void **state)
{
    (void)state;
    check_influence(&influences[3]);
}

/* Law: at rest it is the linear influence. */
static void test_influence_at_rest(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, "plate-50-patches", CORRECTED "kinematics=nonlinear");
    const pzs_structure *s = &r.analysis.design.structure;
    const size_t size = (size_t)s->output.count * s->input.count;
    double *linear = calloc(size, sizeof *linear), *here = calloc(size, sizeof *here), *none = calloc(s->input.count, sizeof *none);
    assert_int_equal(pzs_equilibrium(path_of(&r), none), PZS_OK);
    assert_int_equal(pzs_influence_at(path_of(&r), here), PZS_OK);
    assert_int_equal(pzs_assemble(&r.analysis.model, NULL, NULL), PZS_OK);
    assert_int_equal(pzs_factor(&r.analysis.model), PZS_OK);
    assert_int_equal(pzs_influence(&r.analysis.model, linear), PZS_OK);
    /* One is refined, one is not. */
    assert_true(apart(here, linear, size) < 10 * PZS_EPSILON * r.analysis.model.condition);
    free(linear);
    free(here);
    free(none);
    scene_run_close(&r);
}

/* ---- budgets ---------------------------------------------------------- */

/* Law: a spent budget is named, and what is left is the last equilibrium, at the part of the way that it says. */
static void test_budget(void **state)
{
    (void)state;
    scene_run short_run, whole;
    open_run(&short_run, "hemisphere", SOURCE MESH(4, 4) "equilibrium={systems: 5}");
    assert_int_equal(scene_run_solve(&short_run), -1);
    assert_int_equal(short_run.analysis.status, PZS_E_SYSTEMS);
    assert_int_equal(path_of(&short_run)->systems, 5);
    assert_true(path_of(&short_run)->factor == 0 && largest(short_run.u, dof_of(&short_run)) == 0);
    scene_run_close(&short_run);

    open_run(&short_run, "hemisphere", SOURCE MESH(4, 4) "equilibrium={systems: 20, steps: 5, change: 1e-8}");
    assert_int_equal(scene_run_solve(&short_run), -1);
    assert_int_equal(short_run.analysis.status, PZS_E_SYSTEMS);
    assert_int_equal(path_of(&short_run)->systems, 20);
    const double factor = path_of(&short_run)->factor;
    assert_true(factor > 0 && factor < 1);
    open_run(&whole, "hemisphere", SOURCE MESH(4, 4) "equilibrium={change: 1e-8}");
    for (uint32_t j = 0; j < whole.analysis.design.structure.input.count; j++)
        whole.analysis.path.full[j] *= factor;
    assert_int_equal(scene_run_solve(&whole), 0);
    assert_true(apart(short_run.u, whole.u, dof_of(&whole)) < 1e-6);
    scene_run_close(&short_run);
    scene_run_close(&whole);
}

/* ---- loads that cannot be carried ------------------------------------- */

/*
 * What any end must be: a named status, systems within the budget, everything finite, and u an equilibrium of the amounts
 * that the path says hold it: started there, with those amounts, it settles at once where it is.
 */
static void check_end(scene_run *r, const char *what)
{
    pzs_path *path = path_of(r);
    const size_t n = dof_of(r);
    const pzs_status status = r->analysis.status;
    print_message("%s: %s, factor %.4g, %u systems, %u steps, %u negative\n", what, pzs_status_text(status), path->factor, path->systems,
                  path->steps_taken, path->negative);
    assert_true(status == PZS_OK || status == PZS_W_UNSTABLE || (status >= PZS_E_DIVERGED && status <= PZS_E_SYSTEMS));
    assert_true(path->systems <= path->systems_allowed && path->factor >= 0 && path->factor <= 1);
    assert_true((path->factor < 1) == PZS_IS_ERROR(status));
    double *u = calloc(n, sizeof *u), *amount = calloc(r->analysis.design.structure.input.count, sizeof *amount);
    memcpy(u, path->u, n * sizeof *u);
    memcpy(amount, path->amount, r->analysis.design.structure.input.count * sizeof *amount);
    assert_true(largest(u, n) < HUGE_VAL && isfinite(path->residual));
    for (size_t i = 0; i < n; i++)
        assert_true(isfinite(u[i]));
    if (largest(u, n) > 0) {
        path->systems_allowed = 400;
        path->steps = 1;
        assert_false(PZS_IS_ERROR(pzs_equilibrium(path, amount)));
        assert_true(apart(path->u, u, n) < 1e-3);
        assert_int_equal(path->steps_taken, 1);
    }
    free(u);
    free(amount);
}

/* Law: a panel at its limit point snaps through to an equilibrium, or stops before it with a status that says so. */
static void test_snap_through(void **state)
{
    (void)state;
    static const char *const load[] = {"-2.2/4", "-2.24/4", "-2.25/4", "-2.3/4", "-3/4"};
    for (size_t i = 0; i < COUNT(load); i++)
        for (int steps = 1; steps <= 10; steps += 9) {
            char changes[128];
            scene_run r;
            snprintf(changes, sizeof changes, SOURCE "loads.0.u3=%s;equilibrium={steps: %d}", load[i], steps);
            open_run(&r, "tests/scenes/cap.yaml", changes);
            scene_run_solve(&r);
            check_end(&r, changes);
            scene_run_close(&r);
        }
}

/* Law: where a ring can carry no more, half way to twice its load, it stops at the limit point and says so. */
static void test_limit_point(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, "ring-contact", SOURCE "equilibrium={change: 1e-6, systems: 800}");
    r.analysis.path.full[0] = r.analysis.path.full[1] = 2;
    assert_int_equal(scene_run_solve(&r), -1);
    assert_int_equal(r.analysis.status, PZS_E_LIMIT);
    assert_true(path_of(&r)->factor >= 0.5 && path_of(&r)->factor < 0.56);
    check_end(&r, "a ring under twice its load");
    scene_run_close(&r);
}

/* Law: without loads nothing moves. */
static void test_no_load(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, "hemisphere", SOURCE MESH(4, 4));
    memset(r.analysis.path.full, 0, r.analysis.design.structure.input.count * sizeof(double));
    assert_int_equal(scene_run_solve(&r), 0);
    assert_int_equal(r.analysis.status, PZS_OK);
    assert_true(largest(r.u, dof_of(&r)) == 0 && path_of(&r)->factor == 1 && path_of(&r)->negative == 0);
    scene_run_close(&r);
}

/* Law: absurd amounts end within the budget at an equilibrium, with a status that says what happened. */
static void test_absurd_loads(void **state)
{
    (void)state;
    static const char *const scenes[] = {"hemisphere", "annular-plate", "ring-follower", "roll-up", "ring-contact", "cylinder-contact"};
    static const char *const mesh[] = {MESH(4, 4), MESH(4, 8), MESH(18, 1), MESH(10, 1), MESH(30, 1), MESH(4, 12)};
    static const double times[] = {1e6, -1e6, 1e-6, 1e300}; /* of every load and volt */
    for (size_t i = 0; i < COUNT(scenes); i++)
        for (size_t k = 0; k < COUNT(times); k++) {
            char what[64];
            scene_run r;
            open_run(&r, scenes[i], mesh[i]);
            for (uint32_t j = 0; j < r.analysis.design.structure.input.count; j++)
                r.analysis.path.full[j] *= times[k];
            r.analysis.status = pzs_equilibrium(path_of(&r), r.analysis.path.full);
            snprintf(what, sizeof what, "%s times %g", scenes[i], times[k]);
            check_end(&r, what);
            scene_run_close(&r);
        }
}

/* Law: an amount that is no number is refused, with its index; the shape and its amounts stay. */
static void test_nan_amounts(void **state)
{
    (void)state;
    static const double bad[] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    scene_run r;
    solve_run(&r, "hemisphere", SOURCE MESH(4, 4));
    for (size_t k = 0; k < COUNT(bad); k++) {
        double amount[2] = {1, bad[k]};
        assert_int_equal(pzs_equilibrium(path_of(&r), amount), PZS_E_NONFINITE);
        assert_int_equal(path_of(&r)->where, 1);
        assert_true(apart(path_of(&r)->u, r.u, dof_of(&r)) == 0);
    }
    assert_int_equal(pzs_equilibrium(path_of(&r), r.analysis.path.full), PZS_OK);
    assert_true(apart(path_of(&r)->u, r.u, dof_of(&r)) < 1e-3);
    scene_run_close(&r);
}

/* Law: a body that starts inside the shell, around it or across it leaves a named status and an equilibrium. */
static void test_misplaced_bodies(void **state)
{
    (void)state;
    static const char *const body[] = {
        "contact.body={type: cylinder, point: [0, 0, 0], axis: [0, 0, 1], radius: 50}",       /* inside the ring */
        "contact.body={type: cylinder, point: [0, 0, 0], axis: [0, 0, 1], radius: 500}",      /* the ring inside it */
        "contact.body={type: cylinder, point: [100.5+990, 0, 0], axis: [0, 0, 1], radius: 1000}", /* 10 deep already */
        "contact.body={type: sphere, point: [100.5, 0, 0.5], radius: 20}",                    /* centred on the shell */
        "contact.body={type: plane, point: [0, 0, 0], normal: [-1, 0, 0]}",                   /* through the middle */
        "contact.body={type: cylinder, point: [3000, 0, 0], axis: [0, 0, 1], radius: 1000}",  /* out of reach */
    };
    for (size_t i = 0; i < COUNT(body); i++) {
        scene_run r;
        open_run(&r, "ring-contact", body[i]);
        scene_run_solve(&r);
        check_end(&r, body[i]);
        scene_run_close(&r);
    }
}

/* Law: a mesh through a pole is refused by name before anything is computed. */
static void test_pole(void **state)
{
    (void)state;
    static const char *const changes[] = {"mesh.theta1.from=0", "mesh.theta1.from=-0.3"};
    static const char *const annular[] = {"mesh.theta1.from=0", "mesh.theta1.from=-1"};
    for (size_t i = 0; i < COUNT(changes); i++) {
        scene_run r;
        assert_int_equal(scene_run_open(&r, "hemisphere", changes[i]), -1);
        assert_true(strlen(r.error) > 20);
        scene_run_close(&r);
        assert_int_equal(scene_run_open(&r, "annular-plate", annular[i]), -1);
        assert_true(strlen(r.error) > 20);
        scene_run_close(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tables), cmocka_unit_test(test_corrected_tables), cmocka_unit_test(test_contact_tables),
        cmocka_unit_test(test_torus_tables), cmocka_unit_test(test_steps_agree), cmocka_unit_test(test_astray_meshes),
        cmocka_unit_test(test_mixed_beats_plain), cmocka_unit_test(test_rigid_motion), cmocka_unit_test(test_rigid_motion_of_the_source),
        cmocka_unit_test(test_prescribed_and_reaction), cmocka_unit_test(test_contact_resultant), cmocka_unit_test(test_contact_stiffness),
        cmocka_unit_test(test_thickness_locking), cmocka_unit_test(test_given_force_at_rest), cmocka_unit_test(test_influence),
        cmocka_unit_test(test_influence_of_prescribed), cmocka_unit_test(test_influence_in_contact), cmocka_unit_test(test_influence_at_rest),
        cmocka_unit_test(test_budget), cmocka_unit_test(test_snap_through), cmocka_unit_test(test_limit_point), cmocka_unit_test(test_no_load),
        cmocka_unit_test(test_absurd_loads), cmocka_unit_test(test_nan_amounts), cmocka_unit_test(test_misplaced_bodies),
        cmocka_unit_test(test_pole),
    };
    return cmocka_run_group_tests_name("path", tests, NULL, NULL);
}
