/*
 * Laws of warm voltage steps: the straight pass along a proven tableau, damage to it, limits that
 * change in between, the certificate of pzs_assess. With the argument `bits` it prints a checksum
 * of the volts of long walks instead, which is the same whatever the tile (tests/gates/tiles.sh).
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
#include "../../lib/control/control.h"

#define STEPS 1000
#define PERIOD 200

static bench desk, other;

/* The error of a step: two shapes that turn into each other. */
static void aim(bench *t, int step, double size)
{
    const double turn = 2 * 3.14159265358979 * step / PERIOD;
    for (unsigned i = 0; i < t->problem.tables.outputs; i++)
        t->error[i] = (pzs_real)(size * (cos(turn) * sin(.07 * i + .3) + sin(turn) * cos(.11 * i)));
}

/* A plain problem with a little effort, started, and warm for the targets of aim. */
static void warm(bench *t, unsigned n, unsigned m, double limit, double slew)
{
    plain(t, 11, n, m, limit);
    t->problem.tables.regularisation = (pzs_real)(1e-3 * m);
    for (unsigned j = 0; j < n; j++)
        t->problem.step_limit[j] = (pzs_real)slew;
    assert_int_equal(start(t), PZS_OK);
    for (int step = -20; step < 0; step++) {
        aim(t, step, 1);
        (void)pzs_step(&t->control, t->error);
    }
}

static wide checked_step(bench *t)
{
    note_limits(t);
    assert_int_equal(pzs_step(&t->control, t->error), PZS_OK);
    assert_feasible(t);
    return excess(t);
}

static pzs_report assess(bench *t)
{
    pzs_report report = {0};
    assert_int_equal(pzs_assess(&t->control, t->error, &report), PZS_OK);
    return report;
}

static int same_volts(const bench *a, const bench *b)
{
    return memcmp(a->control.info.voltage, b->control.info.voltage,
                  a->problem.tables.inputs * sizeof *a->control.info.voltage) == 0;
}

static void straight_passes_are_optimal(void **state)
{
    (void)state; /* law: where nothing is in the way a warm step is one pass, each ends at the
                    optimum, and errors do not pile up */
    static const unsigned inputs[] = {1, 2, 3, 25, 50, 64};
    for (unsigned k = 0; k < 6; k++) {
        wide worst = 0;
        warm(&desk, inputs[k], 121, HUGE_VAL, HUGE_VAL);
        for (int step = 0; step < STEPS; step++) {
            aim(&desk, step, 1);
            assert_true(desk.control.state.optimiser.is_verified);
            const wide here = checked_step(&desk);
            worst = here > worst ? here : worst;
            assert_true(desk.control.info.iterations <= 1);
        }
        assert_true(worst <= 1);
    }
}

static void every_input_is_measured_in_turn(void **state)
{
    (void)state; /* law: straight passes measure two inputs each, and all of them within n/2 + 1
                    passes */
    unsigned char measured[25] = {0};
    warm(&desk, 25, 121, HUGE_VAL, HUGE_VAL);
    for (int step = 0; step < 25 / 2 + 1; step++) {
        const uint32_t one = desk.control.state.optimiser.checked_next;
        aim(&desk, step, 1);
        (void)checked_step(&desk);
        measured[one] = measured[(one + 1u) % 25u] = 1;
    }
    assert_null(memchr(measured, 0, sizeof measured));
}

static void limits_that_bind_are_met(void **state)
{
    (void)state; /* law: warm steps of which some change the working set end at the optimum, with
                    slews and without */
    for (unsigned slewing = 0; slewing < 2; slewing++) {
        unsigned straight = 0;
        wide worst = 0;
        warm(&desk, 25, 121, .03, slewing ? .004 : HUGE_VAL);
        for (int step = 0; step < STEPS; step++) {
            straight += desk.control.state.optimiser.is_verified;
            aim(&desk, step, 1);
            const wide here = checked_step(&desk);
            worst = here > worst ? here : worst;
        }
        assert_true(assess(&desk).active_limits > 0 && straight > STEPS / 2);
        assert_true(worst <= 1);
    }
}

/* Something happens to the tableau. */
static void damage(bench *t, unsigned kind)
{
    const uint32_t n = t->control.state.optimiser.inputs, width = t->control.state.optimiser.width,
                   row = below(t, n), column = below(t, n);
    pzs_real *entry = t->control.state.optimiser.tableau + (size_t)row * width + column;
    switch (kind) {
    case 0: *entry *= (pzs_real)1.5; break;
    case 1: *entry = (pzs_real)NAN; break;
    case 2:
        memset(t->control.state.optimiser.tableau + (size_t)row * width, 0, n * sizeof *entry);
        break;
    default: *entry = (pzs_real)HUGE_VAL; break;
    }
}

static void a_damaged_tableau_is_found(void **state)
{
    (void)state; /* law: whatever happens to the tableau, volts stay allowed, and no more than n/2 +
                    1 steps in a row miss the optimum */
    for (unsigned k = 0; k < 8; k++) {
        const unsigned kind = k / 2;
        unsigned missed = 0, most = 0, all = 0;
        warm(&desk, 24, 121, k % 2 ? HUGE_VAL : .1, HUGE_VAL);
        for (int step = 0; step < STEPS; step++) {
            if (step % 50 == 0)
                damage(&desk, kind);
            aim(&desk, step, 1);
            note_limits(&desk);
            assert_false(PZS_IS_ERROR(pzs_step(&desk.control, desk.error)));
            assert_feasible(&desk);
            missed = excess(&desk) > 1 ? missed + 1 : 0;
            most = missed > most ? missed : most;
            all += missed > 0;
        }
        print_message("damage %u%s: %u steps of %u missed the optimum, at most %u in a row\n", kind,
                      k % 2 ? ", no limits" : "", all, STEPS, most);
        assert_true(most <= 24 / 2 + 1);
    }
}

static void limits_may_change_in_between(void **state)
{
    (void)state; /* law: an input held, and one whose limits are narrowed behind the controller's
                    back, are inside in the next step */
    warm(&desk, 25, 121, 1, HUGE_VAL);
    for (int step = 0; step < STEPS; step++) {
        const uint16_t j = (uint16_t)below(&desk, 25);
        if (step % 5 == 0)
            assert_int_equal(pzs_hold(&desk.control, j, (pzs_real)draw(&desk, -1, 1)), PZS_OK);
        else if (step % 5 == 2)
            desk.control.state.lower[j] =
                (desk.control.state.upper[j] = (pzs_real)draw(&desk, -.5, .5)) - (pzs_real).1;
        else
            assert_int_equal(pzs_release(&desk.control, j), PZS_OK);
        aim(&desk, step, 1);
        assert_true(checked_step(&desk) <= 1);
    }
}

static void assessment_is_true_and_changes_nothing(void **state)
{
    (void)state; /* law: error and optimality are those of the definition; steps with and without
                    assessments have the same bits */
    warm(&desk, 25, 121, .03, HUGE_VAL);
    warm(&other, 25, 121, .03, HUGE_VAL);
    for (int step = 0; step < 300; step++) {
        aim(&desk, step, 1);
        aim(&other, step, 1);
        (void)checked_step(&desk);
        assert_int_equal(pzs_step(&other.control, other.error), PZS_OK);
        const pzs_report report = assess(&desk);
        unsigned active = 0;
        for (unsigned j = 0; j < 25; j++)
            active += !(desk.control.info.voltage[j] > desk.lower_bound[j] &&
                        desk.control.info.voltage[j] < desk.upper_bound[j]);
        assert_int_equal(report.active_limits, active);
        assert_true(fabsl((wide)report.relative_error - shape_error_of(&desk)) <
                    32 * (wide)PZS_EPSILON);
        assert_true((double)report.kkt_violation < PZS_BY_BITS(1e-3, 1e-11));
        assert_true(same_volts(&desk, &other));
    }
}

static void bad_volts_are_seen(void **state)
{
    (void)state; /* law: volts away from the optimum have the optimality of their gradient */
    wide v[MOST_INPUTS] = {0}, gradient[MOST_INPUTS], wrong = 0, most = 0;
    pzs_real zero[25] = {0};
    warm(&desk, 25, 121, 1, HUGE_VAL);
    assert_int_equal(pzs_control_start(&desk.control, zero), PZS_OK);
    (void)objective(&desk, v, gradient);
    for (unsigned j = 0; j < 25; j++) {
        wrong = fmaxl(wrong, fabsl(gradient[j])); /* of B'W^2 e besides: volts and preferred volts
                                                     are 0 */
        most = fmaxl(most, fabsl(gradient[j]));
    }
    const pzs_report report = assess(&desk);
    assert_true(fabsl((wide)report.kkt_violation - wrong / most) < 32 * (wide)PZS_EPSILON);
    assert_true(fabs((double)report.relative_error - 1) < 4 * (double)PZS_EPSILON);
    assert_int_equal(report.active_limits, 0);
}

static void assessment_refuses(void **state)
{
    (void)state; /* law: an error leaves the report as it was */
    pzs_report report = {.relative_error = 7, .kkt_violation = 8, .active_limits = 9};
    pzs_control fresh = {0};
    warm(&desk, 25, 121, 1, HUGE_VAL);
    assert_int_equal(pzs_assess(NULL, desk.error, &report), PZS_E_ARGUMENT);
    assert_int_equal(pzs_assess(&desk.control, NULL, &report), PZS_E_ARGUMENT);
    assert_int_equal(pzs_assess(&desk.control, desk.error, NULL), PZS_E_ARGUMENT);
    assert_int_equal(pzs_assess(&fresh, desk.error, &report), PZS_E_STAGE);
    desk.error[5] = (pzs_real)NAN;
    assert_int_equal(pzs_assess(&desk.control, desk.error, &report), PZS_E_NONFINITE);
    assert_int_equal(desk.control.info.where, 5);
    assert_true(report.relative_error >= 7 && report.kkt_violation >= 8 &&
                report.active_limits == 9);
    memset(desk.error, 0, sizeof desk.error);
    assert_int_equal(pzs_assess(&desk.control, desk.error, &report), PZS_OK);
    assert_true(report.relative_error <= 0 && report.kkt_violation <= 0);
}

/* Columns that are nearly the same, in a problem without effort. */
static void nearly_dependent(bench *t, unsigned seed, double limit)
{
    plain(t, seed, 2 + seed % 12, 20, limit);
    for (unsigned i = 0; i < t->problem.tables.outputs; i++)
        for (unsigned j = 1; j < t->problem.tables.inputs; j++)
            t->problem.influence[i * t->problem.tables.inputs + j] =
                t->problem.influence[i * t->problem.tables.inputs] +
                PZS_R(1e-3) * t->problem.influence[i * t->problem.tables.inputs + j];
    assert_int_equal(start(t), PZS_OK);
}

static void random_error(bench *t)
{
    for (unsigned i = 0; i < t->problem.tables.outputs; i++)
        t->error[i] = (pzs_real)draw(t, -1, 1);
}

static void far_limits_do_not_draw_volts(void **state)
{
    (void)state; /* law: with columns of condition 1e3 and limits out of reach a step that says OK
                    at most doubles |W e|^2, in float too */
    static const double limits[] = {1, 100, 1e5, 1e30};
    for (unsigned k = 0; k < 4; k++) {
        wide worst = 0;
        for (unsigned seed = 0; seed < 1000; seed++) {
            nearly_dependent(&desk, seed, limits[k]);
            for (unsigned step = 0; step < 3; step++) {
                random_error(&desk);
                note_limits(&desk);
                const pzs_status status = pzs_step(&desk.control, desk.error);
                assert_feasible(&desk);
                worst = status == PZS_OK
                            ? fmaxl(worst,
                                    objective_at(&desk, desk.control.info.voltage) / energy(&desk))
                            : worst;
            }
        }
        print_message("limits %.0e: at most %.4Lg of |W e|^2 is left\n", limits[k], worst);
        assert_true(worst < 2);
    }
}

/* |predicted - B volt| over the largest of either. */
static double prediction_gap(const bench *t)
{
    double gap = 0, most = 1e-30;
    for (unsigned i = 0; i < t->problem.tables.outputs; i++) {
        double sum = 0, size = 0;
        for (unsigned j = 0; j < t->problem.tables.inputs; j++) {
            sum += (double)t->problem.influence[i * t->problem.tables.inputs + j] *
                   (double)t->control.info.voltage[j];
            size += fabs((double)t->problem.influence[i * t->problem.tables.inputs + j] *
                         (double)t->control.info.voltage[j]);
        }
        gap = fmax(gap, fabs((double)t->control.info.predicted[i] - sum));
        most = fmax(most, size);
    }
    return gap / most;
}

static void predictions_follow_the_volts(void **state)
{
    (void)state; /* law: after a tick predicted is B volt, whatever steps, converter steps and new
                    starts came before */
    pzs_real given[14] = {0};
    for (unsigned seed = 0; seed < 300; seed++) {
        nearly_dependent(&desk, seed, 100);
        memcpy(given, desk.control.info.voltage, desk.problem.tables.inputs * sizeof *given);
        for (unsigned round = 0; round < 12; round++) {
            random_error(&desk);
            if (round % 4 == 1)
                (void)pzs_step(&desk.control, desk.error);
            if (round % 4 == 2)
                assert_int_equal(pzs_quantise(&desk.control, given, PZS_R(.25), 0), PZS_OK);
            if (round % 4 == 3)
                assert_int_equal(pzs_control_start(&desk.control, given), PZS_OK);
            if (round % 3 == 0)
                (void)pzs_step(&desk.control, desk.error);
            assert_false(PZS_IS_ERROR(pzs_tick(&desk.control, desk.error, NULL)));
            assert_true(prediction_gap(&desk) < 32 * (double)PZS_EPSILON);
            (void)pzs_step(&desk.control, desk.error);
            assert_true(desk.control.state.behind ||
                        prediction_gap(&desk) < 32 * (double)PZS_EPSILON);
        }
    }
}

static void a_step_after_converter_steps(void **state)
{
    (void)state; /* law: a step starts from the volts that the converter gave, and ends at the
                    optimum */
    pzs_real given[25];
    warm(&desk, 25, 121, .1, HUGE_VAL);
    memcpy(given, desk.control.info.voltage, sizeof given);
    for (int step = 0; step < 300; step++) {
        assert_int_equal(pzs_quantise(&desk.control, given, PZS_R(.01), 0), PZS_OK);
        aim(&desk, step, 1);
        assert_true(checked_step(&desk) <= 1);
    }
}

static void limits_narrowed_by_a_few_roundings_are_met(void **state)
{
    (void)state; /* law: volts at rest come inside limits that close in by 1 to 1000 epsilon */
    warm(&desk, 25, 121, 1, HUGE_VAL);
    for (unsigned k = 0; k < 2000; k++) {
        const uint32_t j = below(&desk, 25);
        const pzs_real v = desk.control.info.voltage[j],
                       inward = (1 + (pzs_real)below(&desk, 1000)) * PZS_EPSILON *
                                (pzs_real)fabs((double)v);
        aim(&desk, 0, 1);
        assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
        if (desk.control.info.voltage[j] > 0)
            desk.control.state.upper[j] = desk.control.state.voltage[j] - inward;
        else
            desk.control.state.lower[j] = desk.control.state.voltage[j] + inward;
        assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
        assert_true(desk.control.info.voltage[j] >= desk.control.info.lower[j] &&
                    desk.control.info.voltage[j] <= desk.control.info.upper[j]);
        assert_int_equal(pzs_release(&desk.control, (uint16_t)j), PZS_OK);
    }
}

static void assessment_before_the_first_step(void **state)
{
    (void)state; /* law: with slews too, limits before any step, and after a start from given volts,
                    are those in force */
    pzs_real half[25];
    plain(&desk, 3, 25, 121, 1);
    for (unsigned j = 0; j < 25; j++) {
        desk.problem.step_limit[j] = PZS_R(.1);
        half[j] = PZS_R(.5);
    }
    assert_int_equal(start(&desk), PZS_OK);
    assert_int_equal(assess(&desk).active_limits, 0);
    assert_true(assess(&desk).kkt_violation > PZS_R(.5));
    assert_int_equal(pzs_control_start(&desk.control, half), PZS_OK);
    assert_int_equal(assess(&desk).active_limits, 0);
    assert_int_equal(pzs_control_init(&desk.control, &desk.problem.tables, NULL, NULL, 0),
                     PZS_E_ARGUMENT);
    assert_int_equal(pzs_step(&desk.control, desk.error), PZS_E_STAGE);
}

static void a_slew_of_a_few_roundings_is_kept(void **state)
{
    (void)state; /* law: a slew between a tenth and four roundings of the volt is never exceeded,
                    and never taken for a clash */
    for (unsigned seed = 0; seed < 2000; seed++) {
        plain(&desk, seed, 1 + seed % 3, 4, 200);
        for (unsigned j = 0; j < desk.problem.tables.inputs; j++) {
            desk.problem.reference_voltage[j] = (pzs_real)draw(&desk, -199, 199);
            desk.problem.step_limit[j] =
                (pzs_real)(draw(&desk, .1, 4) * (double)PZS_EPSILON *
                           fabs((double)desk.problem.reference_voltage[j]));
        }
        assert_int_equal(start(&desk), PZS_OK);
        for (unsigned step = 0; step < 5; step++) {
            random_error(&desk);
            note_limits(&desk);
            assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
            for (unsigned j = 0; j < desk.problem.tables.inputs; j++)
                assert_true(fabs((double)desk.control.info.voltage[j] - (double)desk.last[j]) <=
                            (double)desk.problem.step_limit[j]);
        }
    }
}

static void a_target_that_vanishes_is_followed(void **state)
{
    (void)state; /* law: with the target gone volts go to rounding of zero in one step or tick, no
                    warning then or later */
    for (unsigned ticks = 0; ticks < 2; ticks++) {
        warm(&desk, 25, 121, HUGE_VAL, HUGE_VAL);
        desk.problem.tables.regularisation = 0;
        desk.problem.tables.crc = pzs_problem_crc(&desk.problem.tables);
        assert_int_equal(pzs_control_init(&desk.control, &desk.problem.tables, NULL, desk.work,
                                          sizeof desk.work),
                         PZS_OK);
        for (int step = 0; step < 50; step++) {
            aim(&desk, step, step < 10 ? 50 : 0);
            assert_int_equal(ticks ? pzs_tick(&desk.control, desk.error, NULL)
                                   : pzs_step(&desk.control, desk.error),
                             PZS_OK);
            for (unsigned j = 0; step >= 10 && j < 25; j++)
                assert_true(fabs((double)desk.control.info.voltage[j]) <
                            50 * 64 * (double)PZS_EPSILON);
        }
    }
}

static void converter_steps_stay_inside(void **state)
{
    (void)state; /* law: limits in force come before whole converter steps and the dead band */
    pzs_real given[25];
    warm(&desk, 25, 121, 1, HUGE_VAL);
    for (unsigned k = 0; k < 500; k++) {
        const uint16_t j = (uint16_t)below(&desk, 25);
        assert_int_equal(pzs_hold(&desk.control, j, (pzs_real)draw(&desk, -1, 1)), PZS_OK);
        aim(&desk, (int)k, 1);
        assert_int_equal(pzs_step(&desk.control, desk.error), PZS_OK);
        memset(given, 0, sizeof given);
        assert_int_equal(pzs_quantise(&desk.control, given, PZS_R(.125), PZS_R(.3)), PZS_OK);
        for (unsigned i = 0; i < 25; i++)
            assert_true(desk.control.info.voltage[i] >= desk.control.info.lower[i] &&
                        desk.control.info.voltage[i] <= desk.control.info.upper[i]);
        assert_int_equal(pzs_release(&desk.control, j), PZS_OK);
    }
}

/* Checksum of the volts of steps and ticks with all that may happen in between. */
static uint32_t walk(unsigned n, double limit, double slew)
{
    uint32_t crc = GUARD_CRC_START;
    warm(&desk, n, 121, limit, slew);
    for (int step = 0; step < STEPS; step++) {
        aim(&desk, step, 1 + .2 * (step % 7));
        if (step % 31 == 0)
            (void)pzs_hold(&desk.control, (uint16_t)below(&desk, n), 0);
        if (step % 31 == 9)
            for (uint16_t j = 0; j < n; j++)
                (void)pzs_release(&desk.control, j);
        if (step / 100 % 2)
            (void)pzs_step(&desk.control, desk.error);
        else
            (void)pzs_tick(&desk.control, desk.error, NULL);
        crc = pzs_guard_crc(crc, desk.control.info.voltage, n * sizeof *desk.control.info.voltage);
    }
    return ~crc;
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_passes_are_optimal),
        cmocka_unit_test(every_input_is_measured_in_turn),
        cmocka_unit_test(limits_that_bind_are_met),
        cmocka_unit_test(a_damaged_tableau_is_found),
        cmocka_unit_test(limits_may_change_in_between),
        cmocka_unit_test(assessment_is_true_and_changes_nothing),
        cmocka_unit_test(bad_volts_are_seen),
        cmocka_unit_test(assessment_refuses),
        cmocka_unit_test(assessment_before_the_first_step),
        cmocka_unit_test(far_limits_do_not_draw_volts),
        cmocka_unit_test(predictions_follow_the_volts),
        cmocka_unit_test(a_step_after_converter_steps),
        cmocka_unit_test(limits_narrowed_by_a_few_roundings_are_met),
        cmocka_unit_test(a_slew_of_a_few_roundings_is_kept),
        cmocka_unit_test(a_target_that_vanishes_is_followed),
        cmocka_unit_test(converter_steps_stay_inside),
    };
    if (argc > 1 && strcmp(argv[1], "bits") == 0) {
        for (unsigned n = 1; n <= 64; n += 7)
            printf("%u: %08x %08x\n", n, (unsigned)walk(n, .03, HUGE_VAL),
                   (unsigned)walk(n, .03, .004));
        return 0;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
