/*
 * The work of control ticks is bounded: on a plate whose Hessian has a condition of 1e5, with
 * targets that jump, electrodes that die and recover, and limits of the work down to the least one.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "../../lib/control/boxls_tableau.h"
#include "../../lib/control/control.h"

#ifndef WORK_TICKS
#define WORK_TICKS 20000
#endif

enum { N = 25, M = 121 };
enum { MOST_INPUTS = N, MOST_OUTPUTS = M };

#include "../rigs/problem_rig.h"

typedef struct rig {
    problem_rig problem;
    pzs_control control;
    pzs_real wanted[M], before[N];
    double work[PZS_CONTROL_BYTES(N, M) / sizeof(double) + 1];
    unsigned seed;
} rig;

/* A plate clamped at one end, 5 x 5 patches that bend it, outputs on a grid of 11 x 11. */
static void fill_influence(rig *r)
{
    for (int i = 0; i < M; i++) {
        const double x = (i / 11 + 1) / 11.0 * 5, y = (i % 11) / 10.0 * 5;
        for (int j = 0; j < N; j++) {
            const double past = fmax(x - j / 5, 0), across = y - (j % 5 + .5);
            const double bend = past < 1 ? past * past / 2 : past - .5;
            r->problem.influence[i * N + j] =
                (pzs_real)(1e-6 * bend * (.15 + exp(-.8 * across * across)));
        }
    }
}

static void open_rig(rig *r, double step_limit)
{
    memset(r, 0, sizeof *r);
    r->seed = 3;
    fill_influence(r);
    problem_open(&r->problem, N, M, -200, 200, step_limit);
    problem_seal(&r->problem);
    assert_int_equal(
        pzs_control_init(&r->control, &r->problem.tables, NULL, r->work, sizeof r->work), PZS_OK);
}

/* A target that voltages within 1.5 times the limits reach. */
static void jump(rig *r)
{
    memset(r->wanted, 0, sizeof r->wanted);
    for (int j = 0; j < N; j++) {
        const double voltage = uniform(&r->seed, -300, 300);
        for (int i = 0; i < M; i++)
            r->wanted[i] += (pzs_real)(voltage * (double)r->problem.influence[i * N + j]);
    }
}

static void disturb(rig *r)
{
    const double chance = uniform(&r->seed, 0, 1);
    const uint16_t input = (uint16_t)uniform(&r->seed, 0, N - 1e-6);
    if (chance < .2)
        jump(r);
    else if (chance < .22)
        assert_int_equal(pzs_hold(&r->control, input, (pzs_real)uniform(&r->seed, -200, 200)),
                         PZS_OK);
    else if (chance < .3)
        assert_int_equal(pzs_release(&r->control, input), PZS_OK);
}

static void assert_feasible(const rig *r)
{
    for (int j = 0; j < N; j++) {
        const pzs_real v = r->control.info.voltage[j];
        assert_true(v >= r->control.info.lower[j] && v <= r->control.info.upper[j]);
    }
}

/* Inputs whose voltages are yet to become free while the tableau is recomputed. */
static int waiting(const rig *r)
{
    const pzs_optimiser *optimiser = &r->control.state.optimiser;
    int count = 0;
    for (int j = 0; optimiser->is_rebuilding && j < N; j++)
        count += optimiser->waiting[j] > 0;
    return count;
}

/* Law: a tick never takes more multiply-adds than the limit, whatever the limit, begins at most one
 * recomputation of the tableau, leaves voltages inside their limits, and gets on: the
 * limit does not end it before an iteration or a part of the recomputation. */
static void test_bound(void **state)
{
    (void)state;
    static rig r;
    static const double step_limit[] = {20, HUGE_VAL};
    for (int k = 0; k < 2; k++) {
        unsigned cut = 0, rebuilds = 0;
        uint64_t most = 0;
        open_rig(&r, step_limit[k]);
        for (int tick = 0; tick < WORK_TICKS / 2; tick++) {
            const uint64_t spare = (uint64_t)(tick % 7) * PZS_ITERATION_WORK(N) * 3u / 2u;
            r.control.settings.work_limit = PZS_WORK_LEAST(N) + spare;
            disturb(&r);
            const int before = waiting(&r);
            const pzs_status status = pzs_tick(&r.control, r.wanted, NULL);
            assert_false(PZS_IS_ERROR(status));
            assert_true(!r.control.state.optimiser.is_cut || r.control.info.iterations > 0 ||
                        waiting(&r) < before || r.control.state.optimiser.rebuilds > 0);
            assert_true(r.control.info.work <= r.control.settings.work_limit);
            assert_true(r.control.state.optimiser.rebuilds <= 1);
            assert_int_equal(r.control.state.optimiser.pending_count, 0);
            assert_feasible(&r);
            cut += status == PZS_W_ITERATIONS;
            rebuilds += r.control.state.optimiser.rebuilds;
            most = r.control.info.work > most ? r.control.info.work : most;
        }
        print_message("  step limit %g V: %u of %d ticks cut, %u recomputations, most work %u\n",
                      step_limit[k], cut, WORK_TICKS / 2, rebuilds, (unsigned)most);
        assert_true(cut > WORK_TICKS / 100);
    }
}

/* |W (B v - e)|^2 of the present voltages. */
static long double objective(const rig *r)
{
    long double sum = 0;
    for (int i = 0; i < M; i++) {
        long double miss = -(long double)r->wanted[i];
        for (int j = 0; j < N; j++)
            miss += (long double)r->problem.influence[i * N + j] * r->control.info.voltage[j];
        sum += miss * miss;
    }
    return sum;
}

/* Law: with the least limit a target that stands still is reached as well as without a limit,
 * monotonically and in a bounded number of ticks. */
static void test_continued(void **state)
{
    (void)state;
    static rig r, free_rig;
    int longest = 0;
    open_rig(&r, HUGE_VAL);
    open_rig(&free_rig, HUGE_VAL);
    r.control.settings.work_limit = 0;
    for (int k = 0; k < WORK_TICKS / 500; k++) {
        jump(&r);
        memcpy(free_rig.wanted, r.wanted, sizeof r.wanted);
        long double last = objective(&r), energy = 0;
        for (int i = 0; i < M; i++)
            energy += (long double)r.wanted[i] * r.wanted[i];
        int ticks = 1;
        while (pzs_tick(&r.control, r.wanted, NULL) == PZS_W_ITERATIONS && ticks < 400) {
            const long double now = objective(&r);
            assert_true(now <= last + 1000 * (long double)PZS_EPSILON * energy);
            last = now;
            ticks++;
        }
        for (int i = 0; i < 3; i++)
            (void)pzs_tick(&r.control, r.wanted, NULL);
        for (int i = 0; i < 3; i++)
            assert_int_equal(pzs_tick(&free_rig.control, r.wanted, NULL), PZS_OK);
        const long double gap = objective(&r) - objective(&free_rig);
        assert_true(gap <= (long double)PZS_BY_BITS(1e-6, 1e-12) * energy);
        longest = ticks > longest ? ticks : longest;
    }
    print_message("  at most %d ticks of the least work to the optimum\n", longest);
    assert_true(longest < 100);
}

/* Law: pzs_step leaves pivot exchanges to the next call, whose voltages have the bits of those
 * after exchanges that were applied at once. */
static void test_collected(void **state)
{
    (void)state;
    static rig late, early;
    unsigned left = 0;
    open_rig(&late, 20);
    open_rig(&early, 20);
    for (int k = 0; k < WORK_TICKS / 20; k++) {
        disturb(&late);
        disturb(&early);
        const pzs_status status = pzs_step(&late.control, late.wanted);
        assert_int_equal(pzs_step(&early.control, early.wanted), status);
        left += late.control.state.optimiser.pending_count > 0;
        tableau_apply_collected(&early.control.state.optimiser);
        assert_int_equal(late.control.info.work, early.control.info.work);
        assert_memory_equal(late.control.info.voltage, early.control.info.voltage,
                            sizeof late.before);
    }
    print_message("  %u of %d steps leave exchanges to the next\n", left, WORK_TICKS / 20);
    assert_true(left > WORK_TICKS / 200);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bound),
        cmocka_unit_test(test_continued),
        cmocka_unit_test(test_collected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
