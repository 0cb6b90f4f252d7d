/*
 * Laws of the dual method, which optimises the voltages of many inputs: optima against a
 * certificate in long double, limits of the work, and damaged memory.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include "../rigs/control_bench.h"

enum { N = 64, M = 160, JUMPS = 6 };

static bench desk;

/* Choose a new target, and let some inputs be held or released. */
static void disturb(bench *trial)
{
    for (unsigned i = 0; i < M; i++)
        trial->error[i] = (pzs_real)draw(trial, -1, 1);
    for (unsigned k = 0; k < 3; k++) {
        const uint16_t input = (uint16_t)below(trial, N);
        const pzs_real voltage = (pzs_real)draw(trial, -1, 1);
        if (chance(trial, .5))
            assert_int_equal(pzs_hold(&trial->control, input, voltage), PZS_OK);
        else
            assert_int_equal(pzs_release(&trial->control, input), PZS_OK);
    }
}

static void open_desk(unsigned seed, double limit, double step_limit)
{
    plain(&desk, seed, N, M, limit);
    for (unsigned i = 0; i < N; i++)
        desk.problem.step_limit[i] = (pzs_real)step_limit;
    assert_int_equal(start(&desk), PZS_OK);
    assert_true(desk.control.state.optimiser.is_dual);
}

static void the_tableau_is_the_inverse(void **state)
{
    (void)state; /* law: at the start the tableau times the Hessian is minus the identity, for every
                    number of inputs that the method serves */
    enum { MOST = 160 };
    static pzs_real influence[MOST * MOST], one[MOST], lower[MOST], upper[MOST], zero[MOST];
    static double work[PZS_CONTROL_BYTES(MOST, MOST) / sizeof(double) + 1];
    static pzs_control control;
    const pzs_optimiser *optimiser = &control.state.optimiser;
    for (unsigned n = PZS_DUAL_INPUTS; n <= MOST; n += n < 80 ? 1 : 13) {
        const pzs_problem plan = {.inputs = (uint16_t)n,
                                  .outputs = (uint16_t)n,
                                  .influence = influence,
                                  .weight = one,
                                  .lower = lower,
                                  .upper = upper,
                                  .step_limit = upper,
                                  .reference_voltage = zero};
        pzs_problem problem = plan;
        for (unsigned i = 0; i < n; i++) {
            lower[i] = -1;
            one[i] = upper[i] = 1;
            for (unsigned j = 0; j < n; j++)
                influence[i * n + j] = (pzs_real)(draw(&desk, -.5, .5) / n + (i == j ? 1 : 0));
        }
        assert_int_equal(pzs_problem_seal(&problem), PZS_OK);
        assert_int_equal(pzs_control_init(&control, &problem, NULL, work, sizeof work), PZS_OK);
        assert_true(optimiser->is_dual);
        for (unsigned i = 0; i < n; i++)
            for (unsigned j = 0; j < n; j++) {
                wide sum = i == j ? 1 : 0;
                for (unsigned k = 0; k < n; k++)
                    sum += (wide)optimiser->tableau[i * optimiser->width + k] *
                           optimiser->hessian[k * optimiser->width + j];
                assert_true(fabsl(sum) <= 16 * n * (wide)PZS_EPSILON);
            }
    }
}

static void the_hessian_is_the_sum_of_products(void **state)
{
    (void)state; /* law: without a Hessian in the tables, each of its entries is the sum over the
                    outputs, one after the other, of the products that define it, to the last bit,
                    for every number of inputs and outputs that leaves a part of a block */
    enum { COLUMNS = 75, ROWS = 150 };
    static pzs_real influence[ROWS * COLUMNS], weight[ROWS];
    static pzs_real zero[COLUMNS];
    static double work[PZS_CONTROL_BYTES(COLUMNS, ROWS) / sizeof(double) + 1];
    static pzs_control control;
    for (unsigned i = 0; i < ROWS * COLUMNS; i++)
        influence[i] = (pzs_real)draw(&desk, -1, 1);
    for (unsigned i = 0; i < ROWS; i++)
        weight[i] = (pzs_real)draw(&desk, .5, 2);
    for (unsigned n = 40; n <= COLUMNS; n += 5) {
        const unsigned outputs = 2 * n;
        pzs_problem problem = {.inputs = (uint16_t)n,
                               .outputs = (uint16_t)outputs,
                               .influence = influence,
                               .weight = weight,
                               .lower = zero,
                               .upper = zero,
                               .step_limit = zero,
                               .reference_voltage = zero,
                               .regularisation = PZS_R(0.1)};
        assert_int_equal(pzs_problem_seal(&problem), PZS_OK);
        assert_int_equal(pzs_control_init(&control, &problem, NULL, work, sizeof work), PZS_OK);
        const pzs_optimiser *optimiser = &control.state.optimiser;
        for (unsigned k = 0; k < n; k++)
            for (unsigned j = k; j < n; j++) {
                pzs_real sum = 0;
                for (unsigned i = 0; i < outputs; i++) {
                    const pzs_real left = weight[i] * weight[i] * influence[i * n + k];
                    sum += left * influence[i * n + j];
                }
                sum += j == k ? problem.regularisation : 0;
                const pzs_real upper = optimiser->hessian[k * optimiser->width + j];
                const pzs_real lower = optimiser->hessian[j * optimiser->width + k];
                assert_memory_equal(&upper, &sum, sizeof sum);
                assert_memory_equal(&lower, &sum, sizeof sum);
            }
    }
}

static void targets_that_jump(void **state)
{
    (void)state; /* law: after every jump of the target the voltages are those of the optimum */
    static const double limit[] = {1e-3, .01, .03, .1, 1};
    static const double step_limit[] = {HUGE_VAL, .02};
    wide worst = 0;
    unsigned active = 0;
    for (unsigned k = 0; k < 10; k++) {
        open_desk(k + 1, limit[k % 5], step_limit[k / 5]);
        for (unsigned jump = 0; jump < JUMPS; jump++) {
            disturb(&desk);
            note_limits(&desk);
            assert_false(PZS_IS_ERROR(pzs_step(&desk.control, desk.error)));
            assert_feasible(&desk);
            const wide found = excess(&desk);
            worst = found > worst ? found : worst;
            active += desk.control.state.optimiser.active_count;
        }
    }
    print_message("excess at most %.2Lg of what is allowed, %u active inputs a step\n", worst,
                  active / (10 * JUMPS));
    assert_true(worst <= 1 && active > 0);
    assert_true(desk.control.state.optimiser.is_dual);
}

static void a_jump_to_limits_is_short(void **state)
{
    (void)state; /* law: a target that brings most voltages to limits takes fewer iterations than a
                    quarter of these, because the active set is estimated as a whole */
    for (unsigned k = 0; k < 4; k++) {
        open_desk(40 + k, 3e-3, HUGE_VAL);
        for (unsigned jump = 0; jump < JUMPS; jump++) {
            for (unsigned i = 0; i < M; i++)
                desk.error[i] = (pzs_real)draw(&desk, -1, 1);
            note_limits(&desk);
            assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
            assert_true(excess(&desk) <= 1);
            const uint32_t active = desk.control.state.optimiser.active_count;
            assert_true(active > N / 2);
            assert_true(4u * desk.control.info.iterations < active);
        }
    }
}

static void warm_and_cold_agree(void **state)
{
    (void)state; /* law: a warm step and a step from zero voltages end at the same objective */
    for (unsigned k = 0; k < 4; k++) {
        open_desk(20 + k, .03, HUGE_VAL);
        for (unsigned jump = 0; jump < JUMPS; jump++) {
            for (unsigned i = 0; i < M; i++)
                desk.error[i] = (pzs_real)draw(&desk, -1, 1);
            assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
        }
        const wide warm = objective_at(&desk, desk.control.info.voltage);
        assert_int_equal(start(&desk), PZS_OK);
        assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
        const wide cold = objective_at(&desk, desk.control.info.voltage);
        assert_true(fabsl(warm - cold) <= 2 * allowance(&desk));
    }
}

static void a_cut_is_continued(void **state)
{
    (void)state; /* law: with any limit of the work a step keeps to it, stays inside the bounds and
                    does not raise the objective; the steps that follow reach the optimum */
    unsigned most = 0;
    for (unsigned k = 0; k < 6; k++) {
        open_desk(40 + k, .03, HUGE_VAL);
        desk.control.settings.work_limit = PZS_WORK_LEAST(N) + k * PZS_PRODUCT_WORK(N) / 3u;
        wide last = objective_at(&desk, desk.control.info.voltage);
        pzs_status status = PZS_W_ITERATIONS;
        unsigned steps = 0;
        for (; status == PZS_W_ITERATIONS && steps < 4 * N; steps++) {
            note_limits(&desk);
            status = pzs_step(&desk.control, desk.error);
            assert_feasible(&desk);
            assert_true(desk.control.info.work <= desk.control.settings.work_limit);
            const wide now = objective_at(&desk, desk.control.info.voltage);
            assert_true(now <= last + allowance(&desk));
            last = now;
        }
        assert_int_equal(status, PZS_OK);
        assert_true(excess(&desk) <= 1);
        most = steps > most ? steps : most;
    }
    print_message("at most %u steps of the least work to the optimum\n", most);
    assert_true(most > 1);
}

/* Flip one bit of the factor, the sides or the order of the active set. */
static void flip_bit(bench *trial)
{
    uint8_t *memory = (uint8_t *)trial->control.state.optimiser.factor;
    const unsigned bit = below(trial, (unsigned)(8 * sizeof(pzs_real) * PZS_DUAL_REALS(N)));
    memory[bit / 8u] = (uint8_t)(memory[bit / 8u] ^ 1u << bit % 8u);
}

static void damage_is_overcome(void **state)
{
    (void)state; /* law: whatever happens to the memory of the active set, voltages stay inside
                    their bounds, and ten steps after the damage they are optimal */
    open_desk(60, .03, HUGE_VAL);
    for (unsigned k = 0; k < 300; k++) {
        for (unsigned i = 0; i < M; i++)
            desk.error[i] = (pzs_real)draw(&desk, -1, 1);
        flip_bit(&desk);
        for (unsigned step = 0; step < 10; step++) {
            note_limits(&desk);
            assert_false(PZS_IS_ERROR(pzs_step(&desk.control, desk.error)));
            assert_feasible(&desk);
        }
        if (k % 10 == 0)
            assert_true(excess(&desk) <= 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tableau_is_the_inverse),
        cmocka_unit_test(the_hessian_is_the_sum_of_products),
        cmocka_unit_test(targets_that_jump),
        cmocka_unit_test(a_jump_to_limits_is_short),
        cmocka_unit_test(warm_and_cold_agree),
        cmocka_unit_test(a_cut_is_continued),
        cmocka_unit_test(damage_is_overcome),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
