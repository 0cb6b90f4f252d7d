/*
 * Where the nonlinear path ends when it cannot go on: every end is named and leaves an equilibrium.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../rigs/path_run.h"

/* ---- budgets ---------------------------------------------------------- */

/* Law: a spent budget is named, and what is left is the last equilibrium, at the part of the way
 * that it says. */
static void test_budget(void **state)
{
    (void)state;
    scene_run short_run, whole;
    open_run(&short_run, "hemisphere", PUBLISHED MESH(4, 4) "equilibrium={linear_solves: 5}");
    assert_int_equal(scene_run_solve(&short_run), -1);
    assert_int_equal(short_run.analysis.status, PZS_E_SOLVES);
    assert_int_equal(path_of(&short_run)->info.linear_solves, 5);
    assert_true(path_of(&short_run)->info.load_factor == 0 &&
                largest(short_run.u, dof_of(&short_run)) == 0);
    scene_run_close(&short_run);

    open_run(
        &short_run, "hemisphere",
        PUBLISHED MESH(4, 4) "equilibrium={linear_solves: 20, load_steps: 5, tolerance: 1e-8}");
    assert_int_equal(scene_run_solve(&short_run), -1);
    assert_int_equal(short_run.analysis.status, PZS_E_SOLVES);
    assert_int_equal(path_of(&short_run)->info.linear_solves, 20);
    const double factor = path_of(&short_run)->info.load_factor;
    assert_true(factor > 0 && factor < 1);
    open_run(&whole, "hemisphere", PUBLISHED MESH(4, 4) "equilibrium={tolerance: 1e-8}");
    for (uint32_t j = 0; j < whole.analysis.design.structure.input.count; j++)
        whole.analysis.equilibrium.full_input[j] *= factor;
    assert_int_equal(scene_run_solve(&whole), 0);
    assert_true(apart(short_run.u, whole.u, dof_of(&whole)) < 1e-6);
    scene_run_close(&short_run);
    scene_run_close(&whole);
}

/* ---- loads that cannot be carried ------------------------------------- */

/*
 * What any end must be: a named status, systems within the budget, everything finite, and u an
 * equilibrium of the amounts that the path says hold it: started there, with those amounts, it
 * settles at once where it is.
 */
static void check_end(scene_run *r, const char *what)
{
    pzs_solver *solver = path_of(r);
    const size_t n = dof_of(r);
    const pzs_status status = r->analysis.status;
    print_message("%s: %s, factor %.4g, %u systems, %u steps, %u negative\n", what,
                  pzs_status_text(status), solver->info.load_factor, solver->info.linear_solves,
                  solver->info.load_steps, solver->info.negative_pivots);
    assert_true(status == PZS_OK || status == PZS_W_UNSTABLE || status == PZS_W_BEHIND ||
                (status >= PZS_E_DIVERGED && status <= PZS_E_SOLVES));
    assert_true(solver->info.linear_solves <= solver->settings.solve_limit &&
                solver->info.load_factor >= 0 && solver->info.load_factor <= 1);
    assert_true((solver->info.load_factor < 1) == PZS_IS_ERROR(status));
    double *u = calloc(n, sizeof *u),
           *amount = calloc(r->analysis.design.structure.input.count, sizeof *amount);
    memcpy(u, solver->info.displacement, n * sizeof *u);
    memcpy(amount, solver->info.input_value,
           r->analysis.design.structure.input.count * sizeof *amount);
    assert_true(largest(u, n) < HUGE_VAL && isfinite(solver->info.residual));
    for (size_t i = 0; i < n; i++)
        assert_true(isfinite(u[i]));
    if (largest(u, n) > 0) {
        solver->settings.solve_limit = 400;
        solver->settings.load_steps = 1;
        assert_false(PZS_IS_ERROR(pzs_equilibrium(solver, amount)));
        assert_true(apart(solver->info.displacement, u, n) < 1e-3);
        assert_int_equal(solver->info.load_steps, 1);
    }
    free(u);
    free(amount);
}

/* Euler's load (2 k - 1)^2 pi^2 E I/(4 L^2), k = 1, of tests/rigs/scenes/strip.yaml with nu = 0. */
static const double euler = 2.0561675835602830;

/* A strip of n elements pressed along by `times` Euler's load (input 0) and across by 1 (input 1).
 */
static void open_column(scene_run *r, int n, double times)
{
    char changes[256];
    snprintf(changes, sizeof changes,
             IMPROVED "mesh.theta1.elements=%d;materials.m={E: 1e6, nu: 0};"
                      "loads=[{line: theta1+, u1: %.17g}, {line: theta1+, u3: 1}]",
             n, -times * euler);
    open_run(r, "tests/rigs/scenes/strip.yaml", changes);
}

/* Law: a strip pressed along stays straight if nothing turns it, and has as many negative pivots as
 * it has passed Euler loads. */
static void test_straight_column(void **state)
{
    (void)state;
    static const double times[] = {
        0.9, 1.1, 8.5, 9.5, 24, 26}; /* critical: 1, 9, 25; more by the mesh, less by shear */
    static const uint32_t passed[] = {0, 1, 1, 2, 2, 3};
    for (size_t i = 0; i < COUNT(times); i++) {
        const double along[] = {1, 0};
        scene_run r;
        open_column(&r, 40, times[i]);
        r.analysis.status = pzs_equilibrium(path_of(&r), along);
        scene_run_observe(&r, path_of(&r)->info.displacement);
        assert_int_equal(path_of(&r)->info.negative_pivots, passed[i]);
        assert_int_equal(r.analysis.status, passed[i] > 0 ? PZS_W_UNSTABLE : PZS_OK);
        assert_true(fabs(scene_run_value(&r, 0)) < 1e-12);
        scene_run_close(&r);
    }
}

/* Law: turned aside while it is pressed and then let go, it takes the shape of the elastica, to
 * second order in its elements. */
static void test_buckled_column(void **state)
{
    (void)state;
    static const struct {
        double times, along, across;
    } elastica[] = {
        /* tip over length, end slope 40, 60, 80 degrees */
        {1.0636632663994, 0.8812035117260, 0.4222403401212},
        {1.1517196204691, 0.7410196060764, 0.5932076461649},
        {1.2938893238823, 0.5593959189512, 0.7194971047317},
    };
    static const double way[][2] = {{1, 0.5}, {1, 0}};
    for (int n = 10; n <= 40; n *= 2)
        for (size_t i = 0; i < COUNT(elastica); i++) {
            scene_run r;
            open_column(&r, n, elastica[i].times);
            for (size_t k = 0; k < COUNT(way); k++)
                assert_int_equal(pzs_equilibrium(path_of(&r), way[k]), PZS_OK);
            scene_run_observe(&r, path_of(&r)->info.displacement);
            assert_true(fabs(1 + scene_run_value(&r, 1) / 10 - elastica[i].along) < 2. / (n * n));
            assert_true(fabs(scene_run_value(&r, 0) / 10 - elastica[i].across) < 2. / (n * n));
            scene_run_close(&r);
        }
}

/* Law: a panel at its limit point snaps through to an equilibrium, or stops before it with a status
 * that says so. */
static void test_snap_through(void **state)
{
    (void)state;
    static const char *const load[] = {"-2.2/4", "-2.24/4", "-2.25/4", "-2.3/4", "-3/4"};
    for (size_t i = 0; i < COUNT(load); i++)
        for (int steps = 1; steps <= 10; steps += 9) {
            char changes[128];
            scene_run r;
            snprintf(changes, sizeof changes,
                     PUBLISHED "loads.0.u3=%s;equilibrium={load_steps: %d}", load[i], steps);
            open_run(&r, "tests/rigs/scenes/cap.yaml", changes);
            scene_run_solve(&r);
            check_end(&r, changes);
            scene_run_close(&r);
        }
}

/* Law: where a ring can carry no more, half way to twice its load, it stops at the limit point and
 * says so. */
static void test_limit_point(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, "ring-contact", PUBLISHED "equilibrium={tolerance: 1e-6, linear_solves: 800}");
    r.analysis.equilibrium.full_input[0] = r.analysis.equilibrium.full_input[1] = 2;
    assert_int_equal(scene_run_solve(&r), -1);
    assert_int_equal(r.analysis.status, PZS_E_LIMIT);
    assert_true(path_of(&r)->info.load_factor >= 0.5 && path_of(&r)->info.load_factor < 0.56);
    check_end(&r, "a ring under twice its load");
    scene_run_close(&r);
}

/* Law: without loads nothing moves. */
static void test_no_load(void **state)
{
    (void)state;
    scene_run r;
    open_run(&r, "hemisphere", PUBLISHED MESH(4, 4));
    memset(r.analysis.equilibrium.full_input, 0,
           r.analysis.design.structure.input.count * sizeof(double));
    assert_int_equal(scene_run_solve(&r), 0);
    assert_int_equal(r.analysis.status, PZS_OK);
    assert_true(largest(r.u, dof_of(&r)) == 0 && path_of(&r)->info.load_factor == 1 &&
                path_of(&r)->info.negative_pivots == 0);
    scene_run_close(&r);
}

/* Law: absurd amounts end within the budget at an equilibrium, with a status that says what
 * happened. */
static void test_absurd_loads(void **state)
{
    (void)state;
    static const char *const scenes[] = {"hemisphere", "annular-plate", "ring-follower",
                                         "roll-up",    "ring-contact",  "cylinder-contact"};
    static const char *const mesh[] = {MESH(4, 4),  MESH(4, 8),  MESH(18, 1),
                                       MESH(10, 1), MESH(30, 1), MESH(4, 12)};
    static const double times[] = {1e6, -1e6, 1e-6, 1e300}; /* of every load and volt */
    for (size_t i = 0; i < COUNT(scenes); i++)
        for (size_t k = 0; k < COUNT(times); k++) {
            char what[64];
            scene_run r;
            open_run(&r, scenes[i], mesh[i]);
            for (uint32_t j = 0; j < r.analysis.design.structure.input.count; j++)
                r.analysis.equilibrium.full_input[j] *= times[k];
            r.analysis.status = pzs_equilibrium(path_of(&r), r.analysis.equilibrium.full_input);
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
    solve_run(&r, "hemisphere", PUBLISHED MESH(4, 4));
    for (size_t k = 0; k < COUNT(bad); k++) {
        double amount[2] = {1, bad[k]};
        assert_int_equal(pzs_equilibrium(path_of(&r), amount), PZS_E_NONFINITE);
        assert_int_equal(path_of(&r)->info.where, 1);
        assert_true(apart(path_of(&r)->info.displacement, r.u, dof_of(&r)) == 0);
    }
    assert_int_equal(pzs_equilibrium(path_of(&r), r.analysis.equilibrium.full_input), PZS_OK);
    assert_true(apart(path_of(&r)->info.displacement, r.u, dof_of(&r)) < 1e-3);
    scene_run_close(&r);
}

/* Law: a body that starts inside the shell, around it or across it leaves a named status and an
 * equilibrium. */
static void test_misplaced_bodies(void **state)
{
    (void)state;
    static const char *const body[] = {
        "contact.body={type: cylinder, point: [0, 0, 0], axis: [0, 0, 1], radius: "
        "50}", /* inside
                  the ring
                */
        "contact.body={type: cylinder, point: [0, 0, 0], axis: [0, 0, 1], radius: "
        "500}", /* the ring
                   inside
                   it */
        "contact.body={type: cylinder, point: [100.5+990, 0, 0], axis: [0, 0, 1], "
        "radius: 1000}",
        "contact.body={type: sphere, point: [100.5, 0, 0.5], radius: 20}",
        "contact.body={type: plane, point: [0, 0, 0], normal: [-1, 0, 0]}",
        "contact.body={type: cylinder, point: [3000, 0, 0], axis: [0, 0, 1], "
        "radius: 1000}",
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

/* Law: small increments do not make an equilibrium of a shape whose forces left over exceed those
 * applied. */
static void test_small_increments(void **state)
{
    (void)state;
    static const char *const points[] = {"[0, 1e-4, pi/4, pi/2]", "[0, 1e-5, pi/4, pi/2]",
                                         "[0, 1e-6, pi/4, pi/2]"};
    for (size_t i = 0; i < COUNT(points); i++) {
        char changes[256];
        scene_run r;
        snprintf(changes, sizeof changes,
                 PUBLISHED "mesh.theta1.elements=6;mesh.theta2={points: %s};", points[i]);
        solve_run(&r, "hemisphere", changes);
        assert_true(path_of(&r)->info.residual <= 1);
        scene_run_close(&r);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_budget),           cmocka_unit_test(test_straight_column),
        cmocka_unit_test(test_buckled_column),   cmocka_unit_test(test_snap_through),
        cmocka_unit_test(test_limit_point),      cmocka_unit_test(test_no_load),
        cmocka_unit_test(test_absurd_loads),     cmocka_unit_test(test_nan_amounts),
        cmocka_unit_test(test_misplaced_bodies), cmocka_unit_test(test_pole),
        cmocka_unit_test(test_small_increments),
    };
    return cmocka_run_group_tests_name("path_ends", tests, NULL, NULL);
}
