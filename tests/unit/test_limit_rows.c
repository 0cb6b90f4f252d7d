/*
 * Laws of limit rows, the limits of weighted sums of voltages. Arguments (both optional): a file to
 * which problems and voltages are written for tests/oracle/limit_rows.py, and how many of the
 * random problems.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../rigs/control_bench.h"
#include "../rigs/damage_block.h"
#include "../../lib/control/limit_rows.h"

#ifndef RANDOM_PROBLEMS
#define RANDOM_PROBLEMS 1500
#endif
#ifndef FLIPS
#define FLIPS 20000
#endif
#define MOST_ROWS 128
#define MOST_ENTRIES (MOST_ROWS * 32)
/*
 * Tolerance of the objective, relative to |W e|^2, and the part of the steps that may miss it. In
 * float some tableaux of dependent rows lose all digits: such a step ends above the optimum.
 * Measured over 10,000 problems: in float 1 of 24,983 steps, in double none. With limits of sums of
 * absolute values no step of 5,000 random problems misses it (12,469 steps), and in their corners
 * 3 of 12,561 steps in float, none in double.
 */
#define ROW_TOLERANCE PZS_BY_BITS(1e-3L, 1e-9L)
#define MISSED_PART PZS_BY_BITS(3e-4, 0)
/* That part of a few hundred problems, of which one may miss: 1 of 250 does in float. */
#define MISSED_CUT PZS_BY_BITS(1e-2, 0)
/*
 * Part of the problems that steps with the least work limit may never solve: in float a step
 * without progress starts anew, for which this work is too small. With limits of sums of absolute
 * values there is more work: none of the random problems is missed, and 1 of 150 corners.
 */
#define MISSED_LEAST PZS_BY_BITS(.03, 0)

/* A voltage optimisation problem with limit rows. */
typedef struct rig {
    bench b;
    pzs_limit_rows rows;
    uint32_t start[MOST_ROWS + 1];
    uint16_t input[MOST_ENTRIES];
    pzs_real value[MOST_ENTRIES], low[MOST_ROWS], high[MOST_ROWS], safe[MOST_INPUTS];
    double work[(PZS_CONTROL_BYTES(MOST_INPUTS, MOST_OUTPUTS) +
                 PZS_LIMIT_ROW_BYTES(MOST_INPUTS, MOST_ROWS)) /
                    8 +
                2];
} rig;

static rig one, copy;
static FILE *dump;
static long dump_count;

/* ---- problems -------------------------------------------------------------- */

static void begin_row(rig *r, double low, double high)
{
    const uint32_t k = r->rows.sums.count;
    assert_true(k < MOST_ROWS);
    r->low[k] = (pzs_real)low;
    r->high[k] = (pzs_real)high;
    r->rows.sums.count++;
    r->start[k + 1] = r->start[k];
}

static void add_entry(rig *r, unsigned input, double value)
{
    uint32_t *end = &r->start[r->rows.sums.count];
    assert_true(*end < MOST_ENTRIES);
    r->input[*end] = (uint16_t)input;
    r->value[*end] = (pzs_real)value;
    ++*end;
}

static void add_difference(rig *r, unsigned left, unsigned right, double limit)
{
    begin_row(r, -limit, limit);
    add_entry(r, left, 1);
    add_entry(r, right, -1);
}

/* Limit the weighted sum of the absolute values of the inputs that add_entry names. */
static void begin_absolute(rig *r, double limit)
{
    begin_row(r, -HUGE_VAL, limit);
    r->rows.absolute_count++;
}

/* Limit the sum of the absolute values of all inputs. */
static void add_absolute(rig *r, double limit)
{
    begin_absolute(r, limit);
    for (unsigned j = 0; j < r->b.problem.tables.inputs; j++)
        add_entry(r, j, 1);
}

/* Limit the differences of consecutive inputs. */
static void add_chain(rig *r, double limit)
{
    for (unsigned j = 0; j + 1 < r->b.problem.tables.inputs; j++)
        add_difference(r, j, j + 1, limit);
}

/* Seal the problem and initialise the controller. */
static pzs_status open_rig(rig *r)
{
    pzs_problem *problem = &r->b.problem.tables;
    r->rows.call = &pzs_limit_rows_calls;
    r->rows.absolute_call = r->rows.absolute_count > 0 ? &pzs_absolute_rows_calls : NULL;
    r->rows.sums.start = r->start;
    r->rows.sums.dof = r->input;
    r->rows.sums.value = r->value;
    r->rows.lower = r->low;
    r->rows.upper = r->high;
    r->rows.safe = r->safe;
    problem->limit_rows = r->rows.sums.count > 0 ? &r->rows : NULL;
    problem->weight = r->b.problem.weight;
    problem->lower = r->b.problem.lower;
    problem->upper = r->b.problem.upper;
    problem->step_limit = r->b.problem.step_limit;
    problem->reference_voltage = r->b.problem.reference_voltage;
    assert_int_equal(pzs_problem_seal(problem), PZS_OK);
    return pzs_control_init(&r->b.control, problem, NULL, r->work, sizeof r->work);
}

static void random_error(rig *r)
{
    for (unsigned i = 0; i < r->b.problem.tables.outputs; i++)
        r->b.error[i] = (pzs_real)draw(&r->b, -1, 1);
}

/* Influence matrices of full and of deficient rank, smooth or random. */
static void random_matrix(rig *r)
{
    const unsigned n = r->b.problem.tables.inputs, m = r->b.problem.tables.outputs,
                   kind = below(&r->b, 5);
    for (unsigned i = 0; i < m; i++)
        for (unsigned j = 0; j < n; j++) {
            const double x = (i + .5) / m - (j + .5) / n;
            const double bump = exp(-x * x * n * n / 4);
            r->b.problem.influence[i * n + j] = (pzs_real)(kind < 2 ? bump : draw(&r->b, -1, 1));
        }
    for (unsigned i = 0; kind == 3 && i < m; i++) /* columns that repeat, with another size */
        for (unsigned j = n / 2; j < n; j++)
            r->b.problem.influence[i * n + j] = -2 * r->b.problem.influence[i * n + j - n / 2];
    for (unsigned i = 0; kind == 4 && i < m; i++) /* an input without effect */
        r->b.problem.influence[i * n + n / 2] = 0;
}

/* Rows of one kind: chains, pairs, sums, repeated rows, rows equal to a bound, rows of zeros. */
static void random_rows(rig *r, double limit)
{
    const unsigned n = r->b.problem.tables.inputs, kind = below(&r->b, 8);
    const double reach = limit * pow(10, draw(&r->b, -2, .3));
    if (kind < 4 || n < 3)
        add_chain(r, reach);
    for (unsigned k = 0; kind >= 2 && kind < 6 && k < 1 + n / 4; k++) {
        begin_row(r, chance(&r->b, .5) ? -HUGE_VAL : -reach * 3, reach * (1 + below(&r->b, 3)));
        for (unsigned j = below(&r->b, 4); j < n && j < 14; j += 1 + below(&r->b, 3))
            add_entry(r, j, chance(&r->b, .5) ? 1 : draw(&r->b, -2, 2));
    }
    for (unsigned k = 0; kind == 6 && k < 2; k++)
        add_chain(r, reach);
    for (unsigned j = 0; kind == 7 && j < n && j < 40; j++) {
        begin_row(r, -HUGE_VAL, limit);
        add_entry(r, j, 1);
        begin_row(r, -1, 1);
        add_entry(r, j, 0);
    }
}

static void random_problem(rig *r, uint64_t seed)
{
    memset(r, 0, sizeof *r);
    r->b.seed = seed * 7919 + 17;
    const unsigned n = 2 + below(&r->b, chance(&r->b, .1) ? 63 : 20);
    r->b.problem.tables.inputs = (uint16_t)n;
    r->b.problem.tables.outputs = (uint16_t)(1 + below(&r->b, 2 * n + 4));
    r->b.problem.tables.influence = r->b.problem.influence;
    random_matrix(r);
    if (chance(&r->b, .5))
        r->b.problem.tables.regularisation = (pzs_real)pow(10, draw(&r->b, -6, 0));
    const double limit = pow(10, draw(&r->b, -1.5, .5));
    const double step = chance(&r->b, .4) ? limit * draw(&r->b, .05, .6) : HUGE_VAL;
    for (unsigned i = 0; i < r->b.problem.tables.outputs; i++)
        r->b.problem.weight[i] = (pzs_real)draw(&r->b, .2, 1);
    for (unsigned j = 0; j < n; j++) {
        const bool is_fixed = chance(&r->b, .03);
        r->b.problem.upper[j] = (pzs_real)(is_fixed ? 0 : limit * draw(&r->b, .5, 1));
        r->b.problem.lower[j] = (pzs_real)(is_fixed ? 0 : -limit * draw(&r->b, .5, 1));
        r->b.problem.step_limit[j] = (pzs_real)step;
    }
    random_error(r);
    random_rows(r, limit);
}

/*
 * Limits of sums of absolute values: of all inputs, of a part, or of two parts that share inputs;
 * from a limit that never binds to one that keeps most voltages at 0 V.
 */
static void random_absolutes(rig *r, uint64_t seed)
{
    random_problem(r, seed);
    const unsigned n = r->b.problem.tables.inputs, count = 1 + below(&r->b, 3);
    for (unsigned k = 0; k < count; k++) {
        double most = 0;
        const bool is_weighted = chance(&r->b, .5);
        begin_absolute(r, 0);
        for (unsigned j = k > 0 ? below(&r->b, n) : 0; j < n && j < 60; j++) {
            const double weight = is_weighted ? draw(&r->b, .01, 3) : 1;
            add_entry(r, j, weight);
            most += weight * (double)r->b.problem.upper[j];
        }
        r->high[r->rows.sums.count - 1] = (pzs_real)(.001 + most * pow(10, draw(&r->b, -2, .1)));
    }
}

/*
 * Remove all limit rows and let half of the voltages have limits of one sign, so that the safe
 * voltages are those nearest to 0 V.
 */
static void exclude_zero(rig *r)
{
    r->rows.sums.count = 0;
    for (unsigned j = 0; j < r->b.problem.tables.inputs; j++) {
        const pzs_real nearest = r->b.problem.upper[j] * (pzs_real)draw(&r->b, 0, .5);
        r->b.problem.step_limit[j] = (pzs_real)HUGE_VAL;
        r->safe[j] = 0;
        if (chance(&r->b, .25))
            r->safe[j] = r->b.problem.lower[j] = nearest;
        else if (chance(&r->b, .33))
            r->safe[j] = r->b.problem.upper[j] = -nearest;
        if (r->b.problem.lower[j] > r->b.problem.upper[j])
            r->b.problem.lower[j] = r->b.problem.upper[j];
    }
}

/*
 * Limit the sum of the absolute values of the inputs from `from` to `to` - 1, a part of them with
 * the weight 0, to `part` of the sum of the largest values. The safe voltages stay inside.
 */
static void add_window(rig *r, unsigned from, unsigned to, double weightless, double part)
{
    double most = 0, least = 0;
    begin_absolute(r, 0);
    for (unsigned j = from; j < to; j++) {
        const double weight = chance(&r->b, weightless) ? 0 : 1 + (j % 3) * .5;
        add_entry(r, j, weight);
        most += weight * fmax((double)r->b.problem.upper[j], -(double)r->b.problem.lower[j]);
        least += weight * fabs((double)r->safe[j]);
    }
    r->high[r->rows.sums.count - 1] = (pzs_real)(.001 + least * 1.001 + (most - least) * part);
}

/*
 * Corners of limits of sums of absolute values: nearly all voltages at 0 V; weights of 0; the same
 * limit three times; five sums that overlap; voltage limits that exclude 0 V; step limits so small
 * that a voltage cannot return to 0 V.
 */
static void absolute_corners(rig *r, uint64_t seed)
{
    random_problem(r, 100000 + seed);
    const unsigned n = r->b.problem.tables.inputs, kind = (unsigned)(seed % 6);
    const double part = pow(10, draw(&r->b, -3, -.5));
    if (kind == 4)
        exclude_zero(r);
    for (unsigned j = 0; kind == 5 && j < n; j++)
        r->b.problem.step_limit[j] = r->b.problem.upper[j] * PZS_R(.03);
    for (unsigned k = 0; kind == 3 && k < 5; k++)
        add_window(r, k * n / 8, n / 2 + k * n / 8, 0, part);
    if (kind != 3)
        add_window(r, 0, n, kind == 1 ? .5 : 0, kind == 0 ? .001 : part);
    for (unsigned k = 0; kind == 2 && k < 2; k++)
        add_window(r, 0, n, 0, part);
}

/* ---- checks ---------------------------------------------------------------- */

/* Assert that the voltages are inside all bounds and rows to the last bit. */
static void assert_inside(const rig *r)
{
    assert_feasible(&r->b);
    for (unsigned k = 0; k < r->rows.sums.count; k++) {
        const pzs_real sum = pzs_limit_rows_sum(&r->rows, k, r->b.control.info.voltage);
        assert_true(sum >= r->low[k] && sum <= r->high[k]);
    }
}

/*
 * Twice the largest value, over the voltages x inside the bounds of input j, of
 * gradient (voltage - x) + force (|voltage| - |x|). It is reached at a bound or at 0 V.
 */
static wide gap_of_input(const rig *r, unsigned j, wide voltage, wide gradient, wide force)
{
    const wide low = r->b.lower_bound[j], high = r->b.upper_bound[j];
    const wide place[] = {low, high, clip(0, low, high)};
    wide most = 0;
    for (unsigned k = 0; k < 3; k++)
        most = fmaxl(most,
                     gradient * (voltage - place[k]) + force * (fabsl(voltage) - fabsl(place[k])));
    return 2 * most;
}

/*
 * Upper bound of objective minus optimum, by duality: for any multipliers of the right sign, it is
 * at most 2 max over the box of (gradient - A' multipliers) . (v - x) + 2 |multipliers| . slack,
 * and for the multiplier of a sum of absolute values with |v| - |x| in place of v - x.
 */
static wide duality_gap(const rig *r)
{
    const pzs_row_solver *solver = r->b.control.state.row_solver;
    wide voltage[MOST_INPUTS] = {0}, gradient[MOST_INPUTS], force[MOST_INPUTS] = {0}, gap = 0;
    const unsigned n = r->b.problem.tables.inputs;
    for (unsigned j = 0; j < n; j++)
        voltage[j] = r->b.control.info.voltage[j];
    (void)objective(&r->b, voltage, gradient);
    for (unsigned k = 0; k < r->rows.sums.count; k++) {
        const bool is_active = !(solver->extended.free_set[n + k] > 0);
        wide multiplier =
            is_active ? (wide)solver->scale[n + k] * solver->extended.direction[n + k] : 0;
        if (multiplier > 0 ? isinf(r->low[k]) : isinf(r->high[k]))
            multiplier = 0;
        const wide sum = pzs_limit_rows_sum(&r->rows, k, r->b.control.info.voltage);
        if (multiplier > 0)
            gap += 2 * multiplier * (sum - (wide)r->low[k]);
        else if (multiplier < 0)
            gap -= 2 * multiplier * ((wide)r->high[k] - sum);
        wide *into = limit_row_is_absolute(&r->rows, k) ? force : gradient;
        for (uint32_t at = r->start[k]; at < r->start[k + 1]; at++)
            into[r->input[at]] -= (wide)r->value[at] * multiplier;
    }
    for (unsigned j = 0; j < n; j++)
        gap += gap_of_input(r, j, voltage[j], gradient[j], force[j]);
    return gap;
}

/*
 * Largest part of the objective that the margins of the limit rows cost, by which the optimiser
 * narrows them for rounding errors: twice the multiplier, the derivative of half the objective,
 * times two margins, because voltages within a margin of a narrowed limit count as at the limit.
 */
static wide cost_of_margins(const rig *r)
{
    const pzs_row_solver *solver = r->b.control.state.row_solver;
    wide cost = 0;
    for (unsigned row = r->b.problem.tables.inputs; row < solver->extended.inputs; row++)
        if (!(solver->extended.free_set[row] > 0))
            cost += 4 * fabsl((wide)solver->extended.direction[row]) * (wide)solver->margin[row];
    return cost;
}

/* Objective at which the tolerance is measured. */
static wide scale_of(const rig *r)
{
    return fmaxl(energy(&r->b), objective_at(&r->b, r->b.control.info.voltage));
}

static void write_reals(const pzs_real *x, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        const double number = (double)x[i];
        fwrite(&number, sizeof number, 1, dump);
    }
}

/*
 * Write inputs, outputs, rows, rows of absolute values, regularisation, arrays, dense rows, limits
 * and voltages as doubles.
 */
static void write_problem(const rig *r)
{
    const unsigned n = r->b.problem.tables.inputs, m = r->b.problem.tables.outputs,
                   count = r->rows.sums.count;
    const double head[] = {n, m, count, r->rows.absolute_count,
                           (double)r->b.problem.tables.regularisation};
    fwrite(head, sizeof *head, 5, dump);
    write_reals(r->b.problem.influence, n * m);
    write_reals(r->b.problem.weight, m);
    write_reals(r->b.error, m);
    write_reals(r->b.lower_bound, n);
    write_reals(r->b.upper_bound, n);
    write_reals(r->b.problem.reference_voltage, n);
    for (unsigned k = 0; k < count; k++) {
        double row[MOST_INPUTS] = {0};
        for (uint32_t at = r->start[k]; at < r->start[k + 1]; at++)
            row[r->input[at]] += (double)r->value[at];
        fwrite(row, sizeof *row, n, dump);
    }
    write_reals(r->low, count);
    write_reals(r->high, count);
    write_reals(r->b.control.info.voltage, n);
}

/* Return the smallest work limit of a step (multiply-adds). */
static uint64_t least_work(const rig *r)
{
    const unsigned n = r->b.problem.tables.inputs, rows = r->rows.sums.count;
    return PZS_LIMIT_ROW_WORK_LEAST(n, rows) +
           PZS_ABSOLUTE_ROW_WORK(n, rows, r->rows.absolute_count);
}

/* ---- laws ------------------------------------------------------------------ */

/*
 * Law: every step ends inside all limits at the optimum, by the duality gap: random problems with
 * chains, pairs and sums, repeated and zero rows, rows equal to bounds, deficient rank, step
 * limits, and targets that jump between warm steps.
 */
static void check_random(unsigned count, double part, void make(rig *, uint64_t))
{
    unsigned most = 0, steps = 0, iterations = 0, active = 0, missed = 0;
    wide worst = 0;
    for (unsigned k = 0; k < count; k++) {
        make(&one, k);
        assert_int_equal(open_rig(&one), PZS_OK);
        for (unsigned left = 1 + below(&one.b, 4); left > 0; left--, steps++) {
            note_limits(&one.b);
            const pzs_status status = pzs_step(&one.b.control, one.b.error);
            assert_inside(&one);
            const wide allowed = ROW_TOLERANCE * scale_of(&one) + cost_of_margins(&one);
            const wide excess = duality_gap(&one) / allowed;
            const bool is_missed = status != PZS_OK || excess > 1;
            missed += is_missed;
            worst = excess > worst && !is_missed ? excess : worst;
            iterations += one.b.control.info.iterations;
            pzs_report report;
            assert_int_equal(pzs_assess(&one.b.control, one.b.error, &report), PZS_OK);
            active += report.active_rows;
            if (left > 1)
                random_error(&one);
        }
        most =
            one.b.control.info.iterations_most > most ? one.b.control.info.iterations_most : most;
        /* scipy takes a hundred times as long for a problem with absolute values */
        if (dump != NULL && make != absolute_corners &&
            (long)k < dump_count / (one.rows.absolute_count > 0 ? 50 : 1))
            write_problem(&one);
    }
    print_message(
        "%d problems, %u steps: gap at most %.2Lg of what is allowed, missed in %u steps, "
        "%.1f rows bind, %.1f iterations a step, at most %u\n",
        count, steps, worst, missed, (double)active / steps, (double)iterations / steps, most);
    assert_true(missed <= part * steps);
}

static void test_random_problems(void **state)
{
    (void)state;
    check_random(RANDOM_PROBLEMS, MISSED_PART, random_problem);
}

/* Law: the same with limits of sums of absolute values beside those of sums. */
static void test_random_absolutes(void **state)
{
    (void)state;
    check_random(RANDOM_PROBLEMS / 2, 0, random_absolutes);
}

/* Law: the same in corners of limits of sums of absolute values. */
static void test_absolute_corners(void **state)
{
    (void)state;
    check_random(RANDOM_PROBLEMS / 2, MISSED_PART, absolute_corners);
}

/*
 * Law: wherever the work limit cuts a step, the voltages are inside all limits and no worse than
 * before, and the work is within the limit; with enough work the step ends at the optimum.
 */
static void check_cuts(unsigned count, double part, void make(rig *, uint64_t))
{
    unsigned cuts = 0, missed = 0;
    for (unsigned k = 0; k < count; k++) {
        make(&one, 50000 + k);
        assert_int_equal(open_rig(&one), PZS_OK);
        (void)pzs_step(&one.b.control, one.b.error);
        random_error(&one);
        memcpy(&copy, &one, sizeof copy);
        const wide first = objective_at(&one.b, one.b.control.info.voltage);
        const unsigned n = one.b.problem.tables.inputs, rows = one.rows.sums.count;
        const uint64_t least = least_work(&one);
        pzs_status status = PZS_W_ITERATIONS;
        for (unsigned allowed = 0; status == PZS_W_ITERATIONS; allowed++, cuts++) {
            memcpy(&one, &copy, sizeof one);
            note_limits(&one.b);
            one.b.control.settings.work_limit = least + allowed * PZS_ITERATION_WORK(n + rows);
            status = pzs_step(&one.b.control, one.b.error);
            assert_inside(&one);
            assert_true(one.b.control.info.work <= one.b.control.settings.work_limit);
            assert_true(objective_at(&one.b, one.b.control.info.voltage) <=
                        first + 64 * MOST_INPUTS * (wide)PZS_EPSILON * (scale_of(&one) + first));
            assert_true(allowed < 2000);
        }
        missed += duality_gap(&one) > ROW_TOLERANCE * scale_of(&one) + cost_of_margins(&one);
    }
    print_message("%u cuts, %u of %u ends above the optimum\n", cuts, missed, count);
    assert_true(missed <= part * count);
}

static void test_cuts(void **state)
{
    (void)state;
    check_cuts(250, MISSED_CUT, random_problem);
    check_cuts(110, 0, random_absolutes);
    check_cuts(110, 0, absolute_corners);
}

/*
 * Law: steps with the least work limit, repeated for one target, reach the optimum.
 *   margins  1 where the limits of sums are so low that their margins cost more than the tolerance
 */
static void check_least(unsigned count, double part, wide margins, void make(rig *, uint64_t))
{
    unsigned most = 0, missed = 0;
    for (unsigned k = 0; k < count; k++) {
        make(&one, 70000 + k);
        for (unsigned j = 0; j < one.b.problem.tables.inputs; j++)
            one.b.problem.step_limit[j] = (pzs_real)HUGE_VAL;
        assert_int_equal(open_rig(&one), PZS_OK);
        one.b.control.settings.work_limit = least_work(&one);
        note_limits(&one.b);
        unsigned steps = 1;
        while (pzs_step(&one.b.control, one.b.error) == PZS_W_ITERATIONS && steps < 2000) {
            assert_inside(&one);
            steps++;
        }
        most = steps > most ? steps : most;
        const wide allowed = ROW_TOLERANCE * scale_of(&one) + margins * cost_of_margins(&one);
        missed += steps == 2000 || duality_gap(&one) > allowed;
    }
    print_message("least work: at most %u steps to the optimum, %u of %u above it\n", most, missed,
                  count);
    assert_true(missed <= part * count);
}

static void test_least_work(void **state)
{
    (void)state;
    check_least(150, MISSED_LEAST, 0, random_problem);
    check_least(150, 0, 0, random_absolutes);
    check_least(150, MISSED_LEAST, 1, absolute_corners);
}

/* A chain of 8 inputs within 100 V, neighbours within `limit`, 12 outputs. */
static void open_chain(rig *r, uint64_t seed, double limit, double step)
{
    memset(r, 0, sizeof *r);
    r->b.seed = seed;
    r->b.problem.tables.inputs = 8;
    r->b.problem.tables.outputs = 12;
    r->b.problem.tables.influence = r->b.problem.influence;
    for (unsigned i = 0; i < 12; i++) {
        r->b.problem.weight[i] = 1;
        for (unsigned j = 0; j < 8; j++)
            r->b.problem.influence[i * 8 + j] = (pzs_real)draw(&r->b, -.01, .01);
    }
    for (unsigned j = 0; j < 8; j++) {
        r->b.problem.upper[j] = 100;
        r->b.problem.lower[j] = -100;
        r->b.problem.step_limit[j] = (pzs_real)step;
    }
    random_error(r);
    add_chain(r, limit);
}

/*
 * Law: degenerate corners do not make the optimiser cycle: every row three times, rows equal to the
 * bounds, rows that fix a sum to rounding, and limits so thin that all rows bind.
 */
static void test_degenerate(void **state)
{
    (void)state;
    unsigned most = 0, missed = 0;
    for (unsigned k = 0; k < 300; k++) {
        const double thin = k % 3 == 0 ? PZS_BY_BITS(5, .05) : 100;
        open_chain(&one, k, thin, HUGE_VAL);
        add_chain(&one, thin);
        add_chain(&one, thin);
        for (unsigned j = 0; j < 8; j++) {
            begin_row(&one, -100, 100);
            add_entry(&one, j, 1);
        }
        begin_row(&one, k % 2 ? -.05 : -HUGE_VAL, k % 2 ? .05 : 0);
        for (unsigned j = 0; j < 8; j++)
            add_entry(&one, j, 1);
        begin_row(&one, -1, 1);
        assert_int_equal(open_rig(&one), PZS_OK);
        for (unsigned jump = 0; jump < 6; jump++) {
            note_limits(&one.b);
            const wide before = scale_of(&one);
            const pzs_status status = pzs_step(&one.b.control, one.b.error);
            assert_inside(&one);
            missed += status != PZS_OK || duality_gap(&one) > ROW_TOLERANCE * before;
            for (unsigned i = 0; i < 12; i++) /* corners of the limits, reached exactly */
                one.b.error[i] = (pzs_real)(jump % 2 ? 0 : draw(&one.b, -9, 9));
        }
        most =
            one.b.control.info.iterations_most > most ? one.b.control.info.iterations_most : most;
    }
    print_message("degenerate: at most %u iterations, missed %u of 1800\n", most, missed);
    assert_true(missed <= MISSED_CUT * 1800);
}

static double largest_excess(const rig *r, const pzs_real *voltage)
{
    double most = 0;
    for (unsigned k = 0; k < r->rows.sums.count; k++) {
        const double sum = (double)pzs_limit_rows_sum(&r->rows, k, voltage);
        most = fmax(most, fmax(sum - (double)r->high[k], (double)r->low[k] - sum));
    }
    return most;
}

/*
 * Law: an input that is held far from its voltage takes its neighbours along: in every step all
 * rows and step limits hold, and after as many steps as its way needs the input has arrived.
 */
static void test_hold(void **state)
{
    (void)state;
    open_chain(&one, 5, 30, 10);
    for (unsigned i = 0; i < 12; i++)
        one.b.error[i] *= 100;
    assert_int_equal(open_rig(&one), PZS_OK);
    for (unsigned t = 0; t < 20; t++)
        (void)pzs_step(&one.b.control, one.b.error);
    pzs_real before[8], way = 0;
    unsigned far = 0;
    for (unsigned j = 0; j < 8; j++)
        if (fabs((double)one.b.control.info.voltage[j]) > (double)way) {
            way = (pzs_real)fabs((double)one.b.control.info.voltage[j]);
            far = j;
        }
    assert_true(way > 40);
    assert_int_equal(pzs_hold(&one.b.control, (uint16_t)far, 0), PZS_OK);
    unsigned steps = 0;
    for (pzs_status status = PZS_W_LIMIT_ROWS; status == PZS_W_LIMIT_ROWS; steps++) {
        memcpy(before, one.b.control.info.voltage, sizeof before);
        status = pzs_step(&one.b.control, one.b.error);
        assert_true(largest_excess(&one, one.b.control.info.voltage) <= 0);
        for (unsigned j = 0; j < 8; j++)
            assert_true(one.b.control.info.voltage[j] - before[j] <= 10 &&
                        before[j] - one.b.control.info.voltage[j] <= 10);
        if (status == PZS_W_LIMIT_ROWS)
            assert_int_equal(one.b.control.info.where, far);
        assert_true(steps < 20);
    }
    assert_true(fabs((double)one.b.control.info.voltage[far]) <= 0);
    assert_int_equal(steps, (unsigned)ceil((double)way / 10));
}

/*
 * Law: voltages of the amplifiers at the start may violate rows; each step then violates each row
 * less, until all hold.
 */
static void test_start(void **state)
{
    (void)state;
    open_chain(&one, 6, 30, 10);
    add_absolute(&one, 100);
    assert_int_equal(open_rig(&one), PZS_OK);
    const pzs_real given[8] = {100, -100, 100, -100, 90, 80, -80, 0};
    assert_int_equal(pzs_control_start(&one.b.control, given), PZS_OK);
    double last = largest_excess(&one, one.b.control.info.voltage);
    assert_true(last >= 540);
    for (unsigned t = 0; last > 0; t++) {
        (void)pzs_step(&one.b.control, one.b.error);
        const double now = largest_excess(&one, one.b.control.info.voltage);
        assert_true(now < last);
        last = now;
        assert_true(t < 12);
    }
}

/* Law: wrong tables are refused with the number of inputs plus that of the row. */
static void test_refusals(void **state)
{
    (void)state;
    open_chain(&one, 7, 30, 10);
    one.low[3] = 31;
    assert_int_equal(open_rig(&one), PZS_E_LIMITS);
    assert_int_equal(one.b.control.info.where, 8 + 3);
    open_chain(&one, 7, 30, 10);
    one.value[2 * 2] = (pzs_real)NAN;
    assert_int_equal(open_rig(&one), PZS_E_LIMITS);
    assert_int_equal(one.b.control.info.where, 8 + 2);
    open_chain(&one, 7, 30, 10);
    one.input[2 * 5] = 8;
    assert_int_equal(open_rig(&one), PZS_E_LIMITS);
    assert_int_equal(one.b.control.info.where, 8 + 5);
    open_chain(&one, 7, 30, 10);
    one.b.problem.upper[4] = (pzs_real)HUGE_VAL;
    assert_int_equal(open_rig(&one), PZS_E_LIMITS);
    assert_int_equal(one.b.control.info.where, 8 + 3);
    open_chain(&one, 7, 30, 10);
    one.safe[1] = 31;
    assert_int_equal(open_rig(&one), PZS_E_LIMITS);
    assert_int_equal(one.b.control.info.where, -1);
    for (unsigned k = 0; k < 3; k++) { /* a negative weight, a lower limit, an upper limit of 0 */
        open_chain(&one, 7, 30, 10);
        add_absolute(&one, k == 2 ? 0 : 200);
        one.value[2 * 7 + 1] = k == 0 ? -1 : 1;
        one.low[7] = k == 1 ? -200 : -(pzs_real)HUGE_VAL;
        assert_int_equal(open_rig(&one), PZS_E_LIMITS);
        assert_int_equal(one.b.control.info.where, 8 + 7);
    }
    open_chain(&one, 7, 30, 10);
    assert_int_equal(open_rig(&one), PZS_OK);
    one.high[0] = 31;
    assert_int_equal(
        pzs_control_init(&one.b.control, &one.b.problem.tables, NULL, one.work, sizeof one.work),
        PZS_E_CRC);
}

/* ---- the loop ----------------------------------------------------------------- */

/*
 * Law: through the last gate no voltages leave that violate a limit row or a step limit, whatever
 * bit of the workspace flips between control step and gate, with and without converter steps; and
 * the loop follows its target again afterwards.
 */
static void test_gate(void **state)
{
    (void)state;
    static double work[30000];
    static pzs_loop loop;
    static flip_damage damage;
    const pzs_amplifier amplifier = {.step = 0.75, .dead_band = 0.125};
    for (unsigned kind = 0; kind < 2; kind++) {
        open_chain(&one, 9 + kind, 30, 10);
        if (kind == 1)
            add_absolute(&one, 120);
        assert_int_equal(open_rig(&one), PZS_OK);
        const pzs_block blocks[] = {{&pzs_step_block, &one.b.problem.tables},
                                    {&pzs_amplifier_block, &amplifier},
                                    {&flip_block, &damage}};
        const pzs_block plain[] = {blocks[0], blocks[2]};
        damage = (flip_damage){.bytes = pzs_control_bytes(&one.b.problem.tables) - 16};
        assert_int_equal(
            pzs_loop_init(&loop, kind ? blocks : plain, kind ? 3 : 2, NULL, work, sizeof work),
            PZS_OK);
        pzs_real last[8] = {0};
        unsigned warned = 0;
        for (unsigned t = 0; t < FLIPS; t++) {
            if (t % 16 == 0)
                for (unsigned i = 0; i < 12; i++)
                    one.b.error[i] = (pzs_real)draw(&one.b, -3, 3);
            damage.is_due = t % 16 == 3 && t + 32 < FLIPS;
            damage.bit = bits(&one.b);
            const pzs_status status = pzs_loop_tick(&loop, one.b.error, NULL);
            warned += status == PZS_W_OUTPUT;
            assert_true(t + 16 < FLIPS || status == PZS_OK);
            assert_true(largest_excess(&one, (const pzs_real *)loop.info.voltage) <= 0);
            for (unsigned j = 0; j < 8; j++) {
                const pzs_real voltage = loop.info.voltage[j];
                assert_true(voltage >= -100 && voltage <= 100);
                assert_true(voltage - last[j] <= 10 && last[j] - voltage <= 10);
                last[j] = voltage;
            }
        }
        print_message("%u flips, %u of them met the voltages\n", FLIPS / 16, warned);
        assert_true(warned > 0);
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_problems),
                                       cmocka_unit_test(test_random_absolutes),
                                       cmocka_unit_test(test_absolute_corners),
                                       cmocka_unit_test(test_cuts),
                                       cmocka_unit_test(test_least_work),
                                       cmocka_unit_test(test_degenerate),
                                       cmocka_unit_test(test_hold),
                                       cmocka_unit_test(test_start),
                                       cmocka_unit_test(test_refusals),
                                       cmocka_unit_test(test_gate)};
    if (argc > 1)
        dump = fopen(argv[1], "wb");
    dump_count = argc > 2 ? atol(argv[2]) : RANDOM_PROBLEMS;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    if (dump != NULL && fclose(dump) != 0)
        return 1;
    return failed;
}
