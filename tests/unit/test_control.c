/*
 * Laws of the voltage controller. Arguments (both optional): a file to which problems and
 * answers are written for tests/oracle/boxls.py, and how many of the random problems.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../rigs/control_bench.h"
#include "../rigs/testdata.h"
#include "../../lib/control/control.h"

#ifndef WALK_TICKS
#define WALK_TICKS 200000 /* fewer under an emulator */
#endif
#ifndef RANDOM_PROBLEMS
#define RANDOM_PROBLEMS 10000
#endif
#define KKT_TOLERANCE PZS_BY_BITS(1e-2, 1e-9)

static bench desk, other;
static FILE *dump;
static long dump_count;

/* ---- random problems --------------------------------------------------------------- */

static void random_influence(bench *t)
{
    const unsigned n = t->problem.tables.inputs, m = t->problem.tables.outputs,
                   rank = 1 + below(t, n), kind = below(t, 6);
    for (unsigned i = 0; i < m; i++)
        for (unsigned j = 0; j < n; j++) {
            const double smooth = cos(3.1 * (double)((i + 1) * (j % rank + 1)) / m);
            const double x = kind == 0 ? smooth : draw(t, -1, 1);
            t->problem.influence[i * n + j] = (pzs_real)(kind == 1 ? x * pow(10, -2.0 * j / n) : x);
        }
    for (unsigned i = 0; kind == 2 && i < m; i++) /* rank-deficient to the last bit: repeated
                                                     columns */
        for (unsigned j = rank; j < n; j++)
            t->problem.influence[i * n + j] =
                (j % 3 ? -2 : 1) * t->problem.influence[i * n + j % rank];
    for (unsigned i = 0; kind == 3 && i < m; i++) /* sums of columns: to rounding */
        for (unsigned j = rank; j < n; j++)
            t->problem.influence[i * n + j] = t->problem.influence[i * n + j % rank] +
                                              t->problem.influence[i * n + (j + 1) % rank];
    for (unsigned i = 0; kind == 4 && i < m; i++) /* a zero column */
        t->problem.influence[i * n + rank - 1] = 0;
}

static void random_limits(bench *t)
{
    static const double reach[] = {.02, .1, .3, .6, 1, 3};
    const double limit = reach[below(t, 6)];
    const double dead = chance(t, .3) ? .3 : 0;
    const double endless = chance(t, .1) && t->problem.tables.regularisation > 0 ? .3 : 0;
    const double slew = chance(t, .4) ? limit * draw(t, .05, .6) : HUGE_VAL;
    const int preferred = chance(t, .5);
    for (unsigned j = 0; j < t->problem.tables.inputs; j++) {
        t->problem.lower[j] = (pzs_real)(chance(t, endless) ? -HUGE_VAL : -limit * draw(t, .1, 1));
        t->problem.upper[j] = (pzs_real)(chance(t, endless) ? HUGE_VAL : limit * draw(t, .1, 1));
        if (chance(t, .05))
            t->problem.lower[j] = 0;
        if (chance(t, dead))
            t->problem.lower[j] = t->problem.upper[j] = 0;
        t->problem.step_limit[j] = (pzs_real)slew;
        t->problem.reference_voltage[j] = (pzs_real)(preferred ? draw(t, -.5, .5) : 0);
    }
}

static void random_error(bench *t, double part)
{
    for (unsigned i = 0; i < t->problem.tables.outputs; i++)
        t->error[i] = (pzs_real)((1 - part) * (double)t->error[i] + part * draw(t, -1, 1));
}

static void random_problem(bench *t, uint64_t seed)
{
    memset(t, 0, sizeof *t);
    t->seed = seed;
    const unsigned n = chance(t, .1) ? 40 + below(t, 25) : 1 + below(t, 24);
    t->problem.tables.inputs = (uint16_t)n;
    t->problem.tables.outputs = (uint16_t)(1 + below(t, 2 * n + 4));
    t->problem.tables.influence = t->problem.influence;
    random_influence(t);
    const double effort = chance(t, .5) ? pow((double)PZS_EPSILON, draw(t, .1, .5)) : 0;
    t->problem.tables.regularisation = (pzs_real)(effort * t->problem.tables.outputs / 3);
    random_limits(t);
    for (unsigned i = 0; i < t->problem.tables.outputs; i++)
        t->problem.weight[i] = (pzs_real)(chance(t, .1) ? 0 : draw(t, .2, 2));
    t->problem.weight[below(t, t->problem.tables.outputs)] = 1;
    random_error(t, 1);
}

/* Change the problem as a running system does: another target, a held or a released input. */
static void disturb(bench *t)
{
    random_error(t, chance(t, .5) ? .05 : .7);
    if (chance(t, .2))
        assert_int_equal(pzs_hold(&t->control, (uint16_t)below(t, t->problem.tables.inputs),
                                  (pzs_real)draw(t, -1, 1)),
                         PZS_OK);
    if (chance(t, .2))
        assert_int_equal(pzs_release(&t->control, (uint16_t)below(t, t->problem.tables.inputs)),
                         PZS_OK);
}

/* How good the volts of the last step are. */
static pzs_report assess(bench *t)
{
    pzs_report report = {0};
    assert_int_equal(pzs_assess(&t->control, t->error, &report), PZS_OK);
    return report;
}

static void put(double x)
{
    assert_int_equal(fwrite(&x, sizeof x, 1, dump), 1);
}

static void put_all(const pzs_real *x, unsigned n)
{
    for (unsigned i = 0; i < n; i++)
        put((double)x[i]);
}

/* n m effort tolerance B W e lo hi prefer volt, all as double. */
static void write_problem(const bench *t)
{
    const unsigned n = t->problem.tables.inputs, m = t->problem.tables.outputs;
    put(n), put(m), put((double)t->problem.tables.regularisation),
        put((double)(allowance(t) / energy(t)));
    put_all(t->problem.influence, n * m), put_all(t->problem.weight, m), put_all(t->error, m);
    put_all(t->lower_bound, n), put_all(t->upper_bound, n),
        put_all(t->problem.reference_voltage, n), put_all(t->control.info.voltage, n);
}

/* One checked step. Returns the certified excess. */
static wide checked_step(bench *t)
{
    note_limits(t);
    const pzs_status status = pzs_step(&t->control, t->error);
    assert_true(status == PZS_OK || status == PZS_W_STEP_LIMIT);
    assert_feasible(t);
    return excess(t);
}

static void random_problems_are_solved(void **state)
{
    (void)state; /* law: every step ends at the optimum, by the duality gap; cold, warm,
                    rank-deficient, degenerate, infeasible start */
    wide worst = 0;
    unsigned passes = 0, steps = 0, most = 0;
    double kkt = 0;
    for (unsigned k = 0; k < RANDOM_PROBLEMS; k++) {
        random_problem(&desk, k);
        assert_int_equal(start(&desk), PZS_OK);
        for (unsigned left = 1 + below(&desk, 4); left > 0; left--, steps++) {
            const wide here = checked_step(&desk);
            worst = here > worst ? here : worst;
            kkt = fmax(kkt, (double)assess(&desk).kkt_violation);
            passes += desk.control.info.iterations;
            if (left > 1)
                disturb(&desk);
        }
        most = desk.control.info.iterations_most > most ? desk.control.info.iterations_most : most;
        if (dump != NULL && (long)k < dump_count)
            write_problem(&desk);
    }
    print_message("%d problems, %u steps: excess at most %.2Lg of what is allowed, optimality "
                  "%.1e, %.1f passes a step, at most %u\n",
                  RANDOM_PROBLEMS, steps, worst, kkt, (double)passes / steps, most);
    assert_true(worst <= 1 && kkt <= KKT_TOLERANCE);
}

static void a_cut_after_any_pass_is_safe(void **state)
{
    (void)state; /* law: after any number of passes the volts are allowed and the objective no worse
                    than at the clamped start */
    unsigned cuts = 0;
    for (unsigned k = 0; k < 300; k++) {
        random_problem(&desk, 20000 + k);
        assert_int_equal(start(&desk), PZS_OK);
        (void)checked_step(&desk);
        disturb(&desk);
        memcpy(&other, &desk, sizeof other); /* the controller's pointers go on into desk */
        note_limits(&desk);
        wide v[MOST_INPUTS] = {0}, gradient[MOST_INPUTS], before = 0;
        for (unsigned i = 0; i < desk.problem.tables.inputs; i++)
            v[i] = clip(desk.last[i], desk.lower_bound[i], desk.upper_bound[i]);
        const wide first = objective(&desk, v, gradient), scale = energy(&desk) + first;
        pzs_status status = PZS_W_ITERATIONS;
        for (unsigned allowed = 0; status == PZS_W_ITERATIONS; allowed++, cuts++) {
            memcpy(&desk, &other, sizeof desk);
            note_limits(&desk);
            const uint64_t limit = PZS_WORK_LEAST(desk.problem.tables.inputs) +
                                   allowed * PZS_ITERATION_WORK(desk.problem.tables.inputs) / 2;
            desk.control.settings.work_limit = limit;
            status = pzs_step(&desk.control, desk.error);
            assert_feasible(&desk);
            assert_true(desk.control.info.work <= limit);
            before = objective_at(&desk, desk.control.info.voltage);
            assert_true(before <= first + 32 * MOST_INPUTS * (wide)PZS_EPSILON * scale);
            assert_true(allowed < 1000);
        }
        assert_true(excess(&desk) <= 1);
    }
    print_message("%u cuts\n", cuts);
}

static void endless_and_dependent(void **state)
{
    (void)state; /* law: dependent inputs without limits or effort, where the optimum is no point,
                    keep finite volts and the least error */
    double farthest = 0;
    for (unsigned k = 0; k < 400; k++) {
        random_problem(&desk, 30000 + k);
        desk.problem.tables.regularisation = 0;
        for (unsigned i = 0; i < desk.problem.tables.inputs; i++) {
            desk.problem.upper[i] = desk.problem.step_limit[i] = (pzs_real)HUGE_VAL;
            desk.problem.lower[i] = (pzs_real)-HUGE_VAL;
        }
        assert_int_equal(start(&desk), PZS_OK);
        for (unsigned s = 0; s < 4; s++) {
            note_limits(&desk);
            const wide before = objective_at(&desk, desk.control.info.voltage),
                       scale = energy(&desk) + before;
            assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
            assert_feasible(&desk);
            assert_true(objective_at(&desk, desk.control.info.voltage) <=
                        before + 64 * (wide)PZS_EPSILON * scale);
            for (unsigned i = 0; i < desk.problem.tables.inputs; i++)
                farthest = fmax(farthest, fabs((double)desk.control.info.voltage[i]));
            random_error(&desk, .5);
        }
    }
    print_message("endless: farthest %.1e V, natural size 1 V\n", farthest);
    assert_true(farthest < 1e4);
}

static void a_long_walk_does_not_drift(void **state)
{
    (void)state; /* law: rounding does not gather: all ticks of a wandering target, 200,000 on the
                    host, stay allowed and optimal */
    plain(&desk, 7, 12, 20, .6);
    desk.problem.tables.regularisation = (pzs_real).1;
    for (unsigned i = 0; i < 12; i++)
        desk.problem.step_limit[i] = (pzs_real).05;
    assert_int_equal(start(&desk), PZS_OK);
    double kkt = 0;
    wide worst = 0;
    unsigned active = 0;
    for (unsigned t = 0; t < WALK_TICKS; t++) {
        for (unsigned i = 0; i < 20; i++)
            desk.error[i] = (pzs_real)(.98 * (double)desk.error[i] + draw(&desk, -.3, .3));
        note_limits(&desk);
        const pzs_status status =
            t % 2 ? pzs_step(&desk.control, desk.error) : pzs_tick(&desk.control, desk.error, NULL);
        assert_int_equal(status, PZS_OK);
        assert_feasible(&desk);
        const pzs_report report = assess(&desk);
        kkt = fmax(kkt, (double)report.kkt_violation);
        active += report.active_limits;
        if (t % 101 == 0) {
            const wide here = excess(&desk),
                       away = fabsl((wide)report.relative_error - shape_error_of(&desk));
            worst = here > worst ? here : worst;
            assert_true(away < 4 * sqrtl((wide)PZS_EPSILON));
        }
    }
    print_message(
        "walk: excess %.2Lg of what is allowed, optimality %.1e, %.1f active, at most %u passes\n",
        worst, kkt, active / 200000., desk.control.info.iterations_most);
    assert_true(worst <= 1 && kkt <= KKT_TOLERANCE);
}

static void measurement_removes_a_disturbance(void **state)
{
    (void)state; /* law: with measured = B v + d the volts become optimal for wanted - d */
    pzs_real wanted[20], d[20], measured[20];
    plain(&desk, 11, 8, 20, .7);
    assert_int_equal(start(&desk), PZS_OK);
    for (unsigned i = 0; i < 20; i++) {
        wanted[i] = (pzs_real)draw(&desk, -1, 1);
        d[i] = (pzs_real)draw(&desk, -.3, .3);
        desk.error[i] = wanted[i] - d[i];
    }
    for (unsigned t = 0; t < 3; t++) {
        note_limits(&desk);
        for (unsigned i = 0; i < 20; i++)
            measured[i] = desk.control.info.predicted[i] + d[i];
        assert_int_equal(pzs_tick(&desk.control, wanted, measured), PZS_OK);
    }
    assert_true(excess(&desk) <= 100); /* measured - predicted is rounded */
    for (unsigned i = 0; i < 20; i++)
        assert_true(fabs((double)(desk.control.info.disturbance[i] - d[i])) <
                    16 * (double)PZS_EPSILON);
    assert_int_equal(pzs_tick(&desk.control, wanted, NULL), PZS_OK); /* without measurement the
                                                                  disturbance stays */
    assert_true(fabs((double)(desk.control.info.disturbance[3] - d[3])) < 16 * (double)PZS_EPSILON);
}

static void a_lost_sensor_keeps_its_disturbance(void **state)
{
    (void)state; /* law: a measurement that is not finite, or frozen while its output moves, changes
                    nothing but the status */
    pzs_real wanted[10], measured[10];
    plain(&desk, 13, 4, 10, 5);
    assert_int_equal(start(&desk), PZS_OK);
    unsigned flagged = 0;
    for (unsigned t = 0; t < 40; t++) {
        for (unsigned i = 0; i < 10; i++) {
            wanted[i] = (pzs_real)sin(.3 * t + i);
            measured[i] = desk.control.info.predicted[i] + (pzs_real).01;
        }
        if (t >= 5 && t < 10)
            measured[3] = (pzs_real)(t % 2 ? -HUGE_VAL : HUGE_VAL - HUGE_VAL);
        if (t >= 12 && t < 30)
            measured[6] = (pzs_real).25;
        const pzs_real before = desk.control.info.disturbance[3];
        const pzs_status status = pzs_tick(&desk.control, wanted, measured);
        if (t >= 5 && t < 10) {
            assert_int_equal(status, PZS_W_SENSOR);
            assert_int_equal(desk.control.info.where, 3);
            assert_true(desk.control.info.disturbance[3] >= before &&
                        desk.control.info.disturbance[3] <= before);
        } else if (t >= 12 && t < 30) {
            flagged += status == PZS_W_SENSOR && desk.control.info.where == 6;
        } else {
            assert_int_equal(status, PZS_OK);
            assert_true(fabs((double)desk.control.info.disturbance[6] - .01) <
                        64 * (double)PZS_EPSILON);
        }
    }
    assert_true(flagged >= 8 && flagged <= 12); /* seen after eight repetitions, and until the end
                                                 */
}

static void a_sensor_at_rest_is_not_frozen(void **state)
{
    (void)state; /* law: repeating bits are no fault where nothing moves */
    pzs_real wanted[10], measured[10];
    plain(&desk, 17, 4, 10, 5);
    assert_int_equal(start(&desk), PZS_OK);
    for (unsigned i = 0; i < 10; i++) {
        wanted[i] = (pzs_real)draw(&desk, -1, 1);
        measured[i] = wanted[i];
    }
    for (unsigned t = 0; t < 50; t++) {
        assert_int_equal(pzs_tick(&desk.control, wanted, NULL), PZS_OK);
        memcpy(measured, desk.control.info.predicted, sizeof measured);
        assert_int_equal(pzs_tick(&desk.control, wanted, measured), PZS_OK);
    }
}

static void bad_numbers_hold_the_volts(void **state)
{
    (void)state; /* law: no input leads to volts that are not finite or not allowed */
    static const double poison[] = {NAN,    HUGE_VAL, -HUGE_VAL, 1e308,  -1e308, 1e200,
                                    5e-324, -1e-310,  0,         3.4e38, 1e-45};
    pzs_real wanted[20], measured[20], last[12];
    for (unsigned k = 0; k < 4000; k++) {
        random_problem(&desk, 40000 + k % 50);
        assert_int_equal(start(&desk), PZS_OK);
        const unsigned n = desk.problem.tables.inputs, m = desk.problem.tables.outputs;
        if (n > 12 || m > 20)
            continue;
        desk.seed += k;
        for (unsigned t = 0; t < 6; t++) {
            for (unsigned i = 0; i < m; i++) {
                wanted[i] =
                    (pzs_real)(chance(&desk, .1) ? poison[below(&desk, 11)] : draw(&desk, -1, 1));
                measured[i] =
                    (pzs_real)(chance(&desk, .1) ? poison[below(&desk, 11)] : draw(&desk, -1, 1));
            }
            note_limits(&desk);
            memcpy(last, desk.control.info.voltage, n * sizeof last[0]);
            const pzs_status status = chance(&desk, .5) ? pzs_tick(&desk.control, wanted, measured)
                                                        : pzs_step(&desk.control, wanted);
            assert_feasible(&desk);
            if (status == PZS_W_HELD || PZS_IS_ERROR(status))
                assert_memory_equal(last, desk.control.info.voltage, n * sizeof last[0]);
            for (unsigned i = 0; i < m; i++)
                assert_true(isfinite(desk.control.info.predicted[i]));
        }
        for (unsigned i = 0; i < m; i++)
            desk.error[i] = (pzs_real)draw(&desk, -1, 1);
        (void)pzs_release(&desk.control, 0);
        (void)pzs_step(&desk.control, desk.error); /* and it recovers */
        note_limits(&desk);
        assert_true(pzs_step(&desk.control, desk.error) != PZS_W_HELD);
        assert_feasible(&desk);
    }
}

static void held_without_anything_to_go_by(void **state)
{
    (void)state; /* law: no finite measurement at all, or a target that is not finite, holds the
                    volts and says so */
    pzs_real wanted[6] = {1, 1, 1, 1, 1, 1}, measured[6], last[3];
    plain(&desk, 19, 3, 6, 1);
    assert_int_equal(start(&desk), PZS_OK);
    assert_int_equal(pzs_tick(&desk.control, wanted, NULL), PZS_OK);
    memcpy(last, desk.control.info.voltage, sizeof last);
    for (unsigned i = 0; i < 6; i++)
        measured[i] = (pzs_real)NAN;
    assert_int_equal(pzs_tick(&desk.control, wanted, measured), PZS_W_HELD);
    wanted[4] = (pzs_real)-HUGE_VAL;
    assert_int_equal(pzs_tick(&desk.control, wanted, NULL), PZS_W_HELD);
    assert_int_equal(desk.control.info.where, 4);
    assert_int_equal(pzs_step(&desk.control, wanted), PZS_E_NONFINITE);
    assert_int_equal(desk.control.info.where, 4);
    assert_memory_equal(last, desk.control.info.voltage, sizeof last);
}

static void holding_and_releasing(void **state)
{
    (void)state; /* law: a held input stands at its voltage, the rest is optimal around it; where
                    slew and limit do not meet the limit wins */
    plain(&desk, 23, 6, 15, 1);
    desk.problem.step_limit[2] = (pzs_real).125;
    assert_int_equal(start(&desk), PZS_OK);
    assert_int_equal(pzs_hold(&desk.control, 2, (pzs_real).75), PZS_OK);
    note_limits(&desk);
    assert_int_equal(pzs_step(&desk.control, desk.error), PZS_W_STEP_LIMIT);
    assert_int_equal(desk.control.info.where, 2);
    assert_true(desk.control.info.voltage[2] >= (pzs_real).75 &&
                desk.control.info.voltage[2] <= (pzs_real).75);
    assert_true(excess(&desk) <= 1);
    assert_true(assess(&desk).active_limits >= 1);
    assert_int_equal(pzs_hold(&desk.control, 3, 99), PZS_OK); /* cut to the table's limit */
    assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
    assert_true(desk.control.info.voltage[3] >= 1 && desk.control.info.voltage[3] <= 1);
    assert_int_equal(pzs_release(&desk.control, 2), PZS_OK);
    assert_int_equal(pzs_release(&desk.control, 3), PZS_OK);
    for (unsigned t = 0; t < 20; t++) {
        note_limits(&desk);
        assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
        assert_feasible(&desk);
    }
    assert_true(excess(&desk) <= 1);
    assert_int_equal(pzs_hold(&desk.control, 6, 0), PZS_E_ARGUMENT);
    assert_int_equal(pzs_hold(&desk.control, 1, (pzs_real)NAN), PZS_E_NONFINITE);
    assert_int_equal(pzs_release(&desk.control, 6), PZS_E_ARGUMENT);
}

static void another_influence_without_a_jump(void **state)
{
    (void)state; /* law: started from the volts that are given, no tick moves by more than the slew
                    from them; the optimum is that of a cold start */
    pzs_real given[8], optimum[8], bad[8];
    plain(&desk, 77, 8, 20, .5);
    for (unsigned j = 0; j < 8; j++)
        desk.problem.step_limit[j] = (pzs_real).03125;
    assert_int_equal(start(&desk), PZS_OK);
    for (unsigned k = 0; k < 60; k++)
        assert_false(PZS_IS_ERROR(pzs_tick(&desk.control, desk.error, NULL)));
    memcpy(given, desk.control.info.voltage, sizeof given);

    for (unsigned i = 0; i < 8 * 20; i++)
        desk.problem.influence[i] *= (pzs_real)draw(&desk, .8, 1.2);
    assert_int_equal(start(&desk), PZS_OK);
    memcpy(bad, given, sizeof bad);
    bad[5] = (pzs_real)NAN;
    assert_int_equal(pzs_control_start(&desk.control, bad), PZS_E_NONFINITE);
    assert_true(desk.control.info.where == 5 && desk.control.info.voltage[0] == 0);
    assert_int_equal(pzs_control_start(&desk.control, NULL), PZS_E_ARGUMENT);
    assert_int_equal(pzs_control_start(&desk.control, given), PZS_OK);
    for (unsigned j = 0; j < 8; j++)
        assert_true(desk.control.info.voltage[j] == given[j]);
    (void)pzs_tick(&desk.control, desk.error, NULL);
    for (unsigned j = 0; j < 8; j++)
        assert_true(fabs((double)(desk.control.info.voltage[j] - given[j])) <= .03125);
    for (unsigned k = 0; k < 60; k++)
        (void)pzs_tick(&desk.control, desk.error, NULL);
    memcpy(optimum, desk.control.info.voltage, sizeof optimum);
    assert_int_equal(start(&desk), PZS_OK);
    for (unsigned k = 0; k < 60; k++)
        (void)pzs_tick(&desk.control, desk.error, NULL);
    for (unsigned j = 0; j < 8; j++)
        assert_true(fabs((double)(desk.control.info.voltage[j] - optimum[j])) <
                    1e3 * (double)PZS_EPSILON);

    given[3] = 2; /* beyond its limit */
    assert_int_equal(pzs_control_start(&desk.control, given), PZS_OK);
    assert_true(desk.control.info.voltage[3] == desk.problem.upper[3]);
}

static void all_dead_and_zero_influence(void **state)
{
    (void)state; /* law: nothing to move, or nothing that moving changes, is no fault */
    plain(&desk, 29, 5, 9, 0);
    assert_int_equal(start(&desk), PZS_OK);
    assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
    for (unsigned i = 0; i < 5; i++)
        assert_true(desk.control.info.voltage[i] >= 0 && desk.control.info.voltage[i] <= 0);
    assert_int_equal(assess(&desk).active_limits, 5);
    plain(&desk, 29, 5, 9, HUGE_VAL);
    memset(desk.problem.influence, 0, sizeof desk.problem.influence);
    desk.problem.reference_voltage[1] = 3;
    assert_int_equal(start(&desk), PZS_OK);
    for (unsigned t = 0; t < 3; t++)
        assert_int_equal(pzs_tick(&desk.control, desk.error, NULL), PZS_OK);
    assert_true(desk.control.info.voltage[1] >= 3 && desk.control.info.voltage[1] <= 3);
    assert_true(fabs((double)assess(&desk).relative_error - 1) < 4 * (double)PZS_EPSILON);
    plain(&desk, 29, 5, 9, HUGE_VAL);
    memset(desk.error, 0, sizeof desk.error);
    assert_int_equal(start(&desk), PZS_OK);
    assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
}

static void errors_are_reported(void **state)
{
    (void)state; /* law: what cannot be right is refused with its status, and nothing is touched */
    plain(&desk, 31, 4, 7, 1);
    assert_int_equal(pzs_step(&desk.control, desk.error), PZS_E_STAGE);
    assert_int_equal(pzs_hold(&desk.control, 0, 0), PZS_E_STAGE);
    assert_int_equal(start(&desk), PZS_OK);
    const size_t need = PZS_CONTROL_BYTES(4, 7);
    pzs_control control;
    memset(&control, 0, sizeof control);
    assert_int_equal(pzs_control_init(NULL, &desk.problem.tables, NULL, desk.work, need),
                     PZS_E_ARGUMENT);
    assert_int_equal(pzs_control_init(&control, NULL, NULL, desk.work, need), PZS_E_ARGUMENT);
    assert_int_equal(pzs_control_init(&control, &desk.problem.tables, NULL, NULL, need),
                     PZS_E_ARGUMENT);
    assert_int_equal(pzs_control_init(&control, &desk.problem.tables, NULL, desk.work, need - 1),
                     PZS_E_WORKSPACE);
    assert_int_equal(control.info.where, need);
    assert_int_equal(
        pzs_control_init(&control, &desk.problem.tables, NULL, (char *)desk.work + 1, need + 8),
        PZS_E_WORKSPACE);
    assert_int_equal(control.state.stage, 0);
    assert_int_equal(pzs_control_init(&control, &desk.problem.tables, NULL, desk.work, need),
                     PZS_OK);
    assert_int_equal(pzs_step(NULL, desk.error), PZS_E_ARGUMENT);
    assert_int_equal(pzs_step(&control, NULL), PZS_E_ARGUMENT);
    assert_int_equal(pzs_tick(&control, NULL, NULL), PZS_E_ARGUMENT);
    desk.problem.tables.format = 99;
    assert_int_equal(pzs_control_init(&control, &desk.problem.tables, NULL, desk.work, need),
                     PZS_E_FORMAT);
    desk.problem.tables.format = PZS_TABLE_FORMAT;
    desk.problem.influence[5] += 1;
    assert_int_equal(pzs_control_init(&control, &desk.problem.tables, NULL, desk.work, need),
                     PZS_E_CRC);
    desk.problem.tables.influence = NULL;
    assert_int_equal(pzs_control_init(&control, &desk.problem.tables, NULL, desk.work, need),
                     PZS_E_ARGUMENT);
    assert_int_equal(start(&desk), PZS_OK); /* influence computed on the device */
}

/* Start with one entry of a table spoilt. */
static pzs_status start_with(pzs_real *entry, double value, int32_t *where)
{
    plain(&desk, 37, 4, 7, 1);
    *entry = (pzs_real)value;
    const pzs_status status = start(&desk);
    *where = desk.control.info.where;
    return status;
}

static void bad_tables_are_refused(void **state)
{
    (void)state; /* law: limits that hold no voltage, and numbers that are none, are named by index
                  */
    int32_t where;
    assert_int_equal(start_with(&desk.problem.lower[2], 2, &where), PZS_E_LIMITS);
    assert_int_equal(where, 2);
    assert_int_equal(start_with(&desk.problem.upper[3], NAN, &where), PZS_E_LIMITS);
    assert_int_equal(where, 3);
    assert_int_equal(start_with(&desk.problem.lower[1], HUGE_VAL, &where), PZS_E_LIMITS);
    assert_int_equal(start_with(&desk.problem.step_limit[1], -1, &where), PZS_E_LIMITS);
    assert_int_equal(start_with(&desk.problem.step_limit[0], NAN, &where), PZS_E_LIMITS);
    assert_int_equal(start_with(&desk.problem.influence[9], NAN, &where), PZS_E_NONFINITE);
    assert_int_equal(where, 9);
    assert_int_equal(start_with(&desk.problem.weight[6], HUGE_VAL, &where), PZS_E_NONFINITE);
    assert_int_equal(where, 6);
    assert_int_equal(start_with(&desk.problem.reference_voltage[1], NAN, &where), PZS_E_NONFINITE);
    assert_int_equal(start_with(&desk.problem.influence[0], PZS_BY_BITS(1e30, 1e300), &where),
                     PZS_E_NONFINITE); /* its square overflows */
    assert_int_equal(start_with(&desk.problem.tables.regularisation, -1, &where), PZS_E_ARGUMENT);
    assert_int_equal(start_with(&desk.problem.lower[0], -HUGE_VAL, &where), PZS_OK);
}

static void table_hessian_and_own_hessian_agree(void **state)
{
    (void)state; /* law: B'W^2 B from the table gives the volts that the one formed at init gives */
    static pzs_real table[36], first[6];
    plain(&desk, 41, 6, 14, .4);
    desk.problem.tables.regularisation = (pzs_real).01;
    for (unsigned j = 0; j < 36; j++)
        for (unsigned i = 0; i < 14; i++)
            table[j] +=
                desk.problem.influence[i * 6 + j / 6] * desk.problem.influence[i * 6 + j % 6];
    assert_int_equal(start(&desk), PZS_OK);
    assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
    memcpy(first, desk.control.info.voltage, sizeof first);
    desk.problem.tables.hessian = table;
    assert_int_equal(start(&desk), PZS_OK);
    assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
    for (unsigned j = 0; j < 6; j++)
        assert_true(fabs((double)(first[j] - desk.control.info.voltage[j])) <
                    1000 * (double)PZS_EPSILON);
}

/* The plate with 25 pairs of patches at a limit (V): active inputs and shape error. */
static void plate(const testdata *d, double limit, unsigned active, double error)
{
    memset(&desk, 0, sizeof desk);
    desk.problem.tables.inputs = 25;
    desk.problem.tables.outputs = 121;
    desk.problem.tables.influence = desk.problem.influence;
    for (unsigned i = 0; i < 121 * 25; i++)
        desk.problem.influence[i] = (pzs_real)testdata_values(d, "influence")[i];
    for (unsigned i = 0; i < 121; i++) {
        desk.problem.weight[i] = 1;
        desk.error[i] = (pzs_real)(.1 * .02 * (i / 11) * (.02 * (i % 11) - .1));
    }
    for (unsigned j = 0; j < 25; j++) {
        desk.problem.upper[j] = (pzs_real)limit;
        desk.problem.lower[j] = (pzs_real)-limit;
        desk.problem.step_limit[j] = (pzs_real)HUGE_VAL;
    }
    assert_int_equal(start(&desk), PZS_OK);
    note_limits(&desk);
    assert_int_equal(pzs_tick(&desk.control, desk.error, NULL), PZS_OK);
    assert_true(excess(&desk) <= 1);
    assert_int_equal(assess(&desk).active_limits, active);
    assert_true(fabs((double)assess(&desk).relative_error - error) < .0005);
    wide gradient[MOST_INPUTS], zero[MOST_INPUTS] = {0};
    const double exact = (double)sqrtl(objective_at(&desk, desk.control.info.voltage) /
                                       objective(&desk, zero, gradient));
    assert_true(fabs((double)assess(&desk).relative_error - exact) <
                16 * sqrt((double)PZS_EPSILON) * exact);
}

static void known_plate(void **state)
{
    (void)state; /* law: the published plate with 25 patches has the active limits and shape errors
                    found by another program */
    FILE *file = fopen("tests/oracle/data/table7.txt", "r");
    testdata d;
    assert_non_null(file);
    assert_int_equal(testdata_next(file, &d), 1);
    plate(&d, 100, 18, .361);
    plate(&d, 125, 14, .253);
    plate(&d, 250, 2, .0598);
    plate(&d, 200, 6, .090);
    for (unsigned j = 0; j < 25; j++)
        assert_true(fabs((double)desk.control.info.voltage[j] - testdata_values(&d, "box_200")[j]) <
                    PZS_BY_BITS(.5, 1e-3));
    pzs_real clipped[25];
    for (unsigned j = 0; j < 25; j++)
        clipped[j] = (pzs_real)fmin(fmax(testdata_values(&d, "least_squares")[j], -200), 200);
    assert_true(objective_at(&desk, clipped) >
                1.5L * objective_at(&desk, desk.control.info.voltage)); /* clipping is no optimum */
    testdata_free(&d);
    (void)fclose(file);
}

static void checksum_of_known_text(void **state)
{
    (void)state; /* law: CRC-32 of "123456789" is CBF43926, in one piece or two; every table entry
                    counts */
    assert_int_equal(~pzs_guard_crc(GUARD_CRC_START, "123456789", 9), 0xCBF43926u);
    assert_int_equal(~pzs_guard_crc(pzs_guard_crc(GUARD_CRC_START, "1234", 4), "56789", 5),
                     0xCBF43926u);
    const pzs_real x[] = {1, -2, 0, (pzs_real)NAN, (pzs_real)HUGE_VAL};
    assert_int_equal(pzs_guard_nonfinite(x, 3), -1);
    assert_int_equal(pzs_guard_nonfinite(x, 5), 3);
    assert_int_equal(pzs_guard_nonfinite(x + 4, 1), 0);
    plain(&desk, 43, 3, 4, 1);
    assert_int_equal(start(&desk), PZS_OK);
    const uint32_t crc = desk.problem.tables.crc;
    pzs_real *const entry[] = {&desk.problem.influence[11], &desk.problem.weight[3],
                               &desk.problem.lower[2],      &desk.problem.upper[0],
                               &desk.problem.step_limit[1], &desk.problem.reference_voltage[2]};
    for (unsigned i = 0; i < 6; i++) {
        const pzs_real was = *entry[i];
        *entry[i] = 17;
        assert_int_not_equal(pzs_problem_crc(&desk.problem.tables), crc);
        *entry[i] = was;
    }
    assert_int_equal(pzs_problem_crc(&desk.problem.tables), crc);
}

static void every_status_has_words(void **state)
{
    (void)state; /* law: each status has a text of its own, warnings and errors are apart */
    const char *unknown = pzs_status_text((pzs_status)(PZS_E_CAPACITANCE + 1));
    int known = 0;
    for (int i = PZS_OK; i <= PZS_E_CAPACITANCE; i++) {
        const char *text = pzs_status_text((pzs_status)i);
        known += strcmp(text, unknown) != 0;
        for (int j = PZS_OK; j < i; j++)
            assert_true(strcmp(text, unknown) == 0 ||
                        strcmp(text, pzs_status_text((pzs_status)j)) != 0);
    }
    assert_int_equal(known, PZS_W_POLARITY + 1 + PZS_E_CAPACITANCE - PZS_E_ARGUMENT + 1);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(checksum_of_known_text),
        cmocka_unit_test(every_status_has_words),
        cmocka_unit_test(errors_are_reported),
        cmocka_unit_test(bad_tables_are_refused),
        cmocka_unit_test(table_hessian_and_own_hessian_agree),
        cmocka_unit_test(known_plate),
        cmocka_unit_test(holding_and_releasing),
        cmocka_unit_test(another_influence_without_a_jump),
        cmocka_unit_test(all_dead_and_zero_influence),
        cmocka_unit_test(measurement_removes_a_disturbance),
        cmocka_unit_test(a_lost_sensor_keeps_its_disturbance),
        cmocka_unit_test(a_sensor_at_rest_is_not_frozen),
        cmocka_unit_test(held_without_anything_to_go_by),
        cmocka_unit_test(bad_numbers_hold_the_volts),
        cmocka_unit_test(a_cut_after_any_pass_is_safe),
        cmocka_unit_test(endless_and_dependent),
        cmocka_unit_test(a_long_walk_does_not_drift),
        cmocka_unit_test(random_problems_are_solved),
    };
    if (argc > 1) {
        dump = fopen(argv[1], "wb");
        dump_count = argc > 2 ? atol(argv[2]) : RANDOM_PROBLEMS;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    if (dump != NULL)
        (void)fclose(dump);
    return failed;
}
