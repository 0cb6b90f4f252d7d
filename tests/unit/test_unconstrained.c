/* Laws of least squares without voltage limits (host_tools/model/unconstrained.h). */
#include "pzs.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "../../host_tools/model/unconstrained.h"
#include "../rigs/testdata.h"

enum { INPUTS = 6, OUTPUTS = 11 };

static double influence[OUTPUTS * INPUTS], weight[OUTPUTS], reference[INPUTS], error[OUTPUTS];

/* A problem of full rank whose weights, references and errors all differ. */
static pzs_problem full_rank(void)
{
    for (int i = 0; i < OUTPUTS; i++) {
        weight[i] = 1 + .1 * i;
        error[i] = sin(2.0 * i);
        for (int k = 0; k < INPUTS; k++)
            influence[i * INPUTS + k] = cos((i + 1) * (k + .5)) + (i == k);
    }
    for (int k = 0; k < INPUTS; k++)
        reference[k] = .3 * k - 1;
    return (pzs_problem){.inputs = INPUTS,
                         .outputs = OUTPUTS,
                         .influence = influence,
                         .weight = weight,
                         .reference_voltage = reference};
}

/* Largest |B'W^2 (B v - e) + r (v - v0)| over largest |B'W^2 e|. */
static double violation(double regularisation, const double *voltage)
{
    double largest = 0, scale = 0;
    for (int j = 0; j < INPUTS; j++) {
        double sum = regularisation * (voltage[j] - reference[j]), target = 0;
        for (int i = 0; i < OUTPUTS; i++) {
            const double factor = weight[i] * weight[i] * influence[i * INPUTS + j];
            double misfit = -error[i];
            for (int k = 0; k < INPUTS; k++)
                misfit += influence[i * INPUTS + k] * voltage[k];
            sum += factor * misfit;
            target += factor * error[i];
        }
        largest = fmax(largest, fabs(sum));
        scale = fmax(scale, fabs(target));
    }
    return largest / scale;
}

/* Law: the voltages meet their normal equations to rounding, with every regularisation. */
static void test_normal_equations(void **state)
{
    (void)state;
    static const double regularisation[] = {0, 1e-6, 1, 1e6};
    const pzs_problem problem = full_rank();
    unconstrained solver;
    double voltage[INPUTS];
    assert_true(unconstrained_open(&solver, &problem));
    for (int k = 0; k < 4; k++) {
        unconstrained_factor(&solver, regularisation[k]);
        assert_int_equal(solver.rank, INPUTS);
        assert_true(unconstrained_solve(&solver, error, voltage));
        assert_true(violation(regularisation[k], voltage) <
                    16 * OUTPUTS * DBL_EPSILON * (1 + regularisation[k]));
    }
    unconstrained_close(&solver);
}

/* Law: dependent columns and columns of zeros are left at 0 V, and the others are still optimal. */
static void test_dependent_columns(void **state)
{
    (void)state;
    const pzs_problem problem = full_rank();
    unconstrained solver;
    double voltage[INPUTS];
    for (int i = 0; i < OUTPUTS; i++) {
        influence[i * INPUTS + 1] = 0;
        influence[i * INPUTS + 4] = -2 * influence[i * INPUTS + 2];
    }
    assert_true(unconstrained_open(&solver, &problem));
    assert_int_equal(solver.rank, INPUTS - 2);
    assert_true(unconstrained_solve(&solver, error, voltage));
    assert_true(voltage[1] == 0 && (voltage[2] == 0) != (voltage[4] == 0));
    assert_true(violation(0, voltage) < 16 * OUTPUTS * DBL_EPSILON);
    unconstrained_close(&solver);
}

/* Law: bad numbers are reported, an error of 0 without regularisation gives 0 V. */
static void test_bad_numbers(void **state)
{
    (void)state;
    static const double bad[] = {(double)NAN, HUGE_VAL, -HUGE_VAL};
    const pzs_problem problem = full_rank();
    unconstrained solver;
    double voltage[INPUTS], spoilt[OUTPUTS] = {0};
    assert_true(unconstrained_open(&solver, &problem));
    assert_true(unconstrained_solve(&solver, spoilt, voltage));
    for (int k = 0; k < INPUTS; k++)
        assert_true(voltage[k] == 0);
    for (int k = 0; k < 3; k++) {
        spoilt[5] = bad[k];
        assert_false(unconstrained_solve(&solver, spoilt, voltage));
    }
    unconstrained_close(&solver);
}

/* Law: the plate with 25 patches has the voltages of an independent program, unregularised. */
static void test_known_plate(void **state)
{
    (void)state;
    static double one[121], zero[25], target[121];
    FILE *file = fopen("tests/oracle/data/table7.txt", "r");
    testdata d;
    unconstrained solver;
    double voltage[25];
    assert_non_null(file);
    assert_int_equal(testdata_next(file, &d), 1);
    (void)fclose(file);
    for (int i = 0; i < 121; i++) {
        one[i] = 1;
        target[i] = .1 * .02 * (i / 11) * (.02 * (i % 11) - .1);
    }
    const pzs_problem problem = {.inputs = 25,
                                 .outputs = 121,
                                 .influence = testdata_values(&d, "influence"),
                                 .weight = one,
                                 .reference_voltage = zero};
    assert_true(unconstrained_open(&solver, &problem));
    assert_true(unconstrained_solve(&solver, target, voltage));
    for (int k = 0; k < 25; k++)
        assert_true(fabs(voltage[k] - testdata_values(&d, "least_squares")[k]) < 1e-3);
    unconstrained_close(&solver);
    testdata_free(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_normal_equations),
        cmocka_unit_test(test_dependent_columns),
        cmocka_unit_test(test_bad_numbers),
        cmocka_unit_test(test_known_plate),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
