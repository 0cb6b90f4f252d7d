/* SPDX-License-Identifier: BSD-2-Clause */
/* Derivatives of expressions: against difference quotients, and against identities. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include "../../host_tools/scene/expr_jet.h"

static expr *compile(const char *text)
{
    int column;
    const char *why;
    expr *expression = expr_compile(text, &column, &why);
    if (!expression)
        fail_msg("%s: column %d: %s", text, column, why);
    return expression;
}

static double value_at(const expr *expression, double x, double y)
{
    const expr_point at = {x, y, 0, x, y};
    return expr_value(expression, &at);
}

/* Every operation once or more; each expression is smooth at the points of the test. */
static const char *const smooth[] = {"theta1^2*theta2",
                                     "sin(x)*cos(2*y)",
                                     "exp(x*y)/(1+x^2)",
                                     "sqrt(1+x^2+y^2)",
                                     "atan2(y,x)",
                                     "hypot(x,y)",
                                     "x^y",
                                     "pow(2,x)*log(3+y)",
                                     "abs(x-2)*tan(y/3)",
                                     "asin(x/3)+acos(y/4)+atan(x*y)",
                                     "zernike(8,hypot(x,y),atan2(y,x))",
                                     "zernike(11,x,y)",
                                     "min(x,y-5)*max(x,y-7)",
                                     "-x^3-+y"};

/*
 * Law: first and second derivatives are the limits of central difference quotients. The quotients
 * of step h err by h^2 of the fourth derivative and by eps/h^2 of the value.
 */
static void test_difference_quotients(void **state)
{
    (void)state;
    const double h = 1e-3;
    for (size_t k = 0; k < sizeof smooth / sizeof *smooth; k++)
        for (double x = 0.5; x < 0.95; x += 0.2)
            for (double y = 0.3; y < 0.9; y += 0.25) {
                expr *f = compile(smooth[k]);
                const expr_jet jet = expr_jet_at(f, x, y);
                const double middle = value_at(f, x, y), east = value_at(f, x + h, y),
                             west = value_at(f, x - h, y), north = value_at(f, x, y + h),
                             south = value_at(f, x, y - h);
                const double cross = (value_at(f, x + h, y + h) - value_at(f, x + h, y - h) -
                                      value_at(f, x - h, y + h) + value_at(f, x - h, y - h)) /
                                     (4 * h * h);
                const double tolerance = 2e-4 * (1 + fabs(middle) + fabs(cross));
                assert_true(fabs(jet.value - middle) <= 64 * DBL_EPSILON * (1 + fabs(middle)));
                assert_true(fabs(jet.first[0] - (east - west) / (2 * h)) < tolerance);
                assert_true(fabs(jet.first[1] - (north - south) / (2 * h)) < tolerance);
                assert_true(fabs(jet.second[0] - (east - 2 * middle + west) / (h * h)) <
                            tolerance * 10);
                assert_true(fabs(jet.second[1] - (north - 2 * middle + south) / (h * h)) <
                            tolerance * 10);
                assert_true(fabs(jet.second[2] - cross) < tolerance * 10);
                expr_free(f);
            }
}

/* Law: expressions that are equal have equal derivatives, to rounding. */
static void test_identities(void **state)
{
    (void)state;
    static const char *const equal[][2] = {{"sin(x)^2+cos(x)^2", "1"},
                                           {"exp(log(x)*y)", "x^y"},
                                           {"sqrt(x^2+y^2)", "hypot(x,y)"},
                                           {"tan(x)", "sin(x)/cos(x)"},
                                           {"atan2(x,y)", "atan(x/y)"},
                                           {"acos(x)", "pi/2-asin(x)"},
                                           {"zernike(4,x,y)", "sqrt(3)*(2*x^2-1)"},
                                           {"(x+y)^3", "x^3+3*x^2*y+3*x*y^2+y^3"}};
    for (size_t k = 0; k < sizeof equal / sizeof *equal; k++) {
        expr *f = compile(equal[k][0]), *g = compile(equal[k][1]);
        const expr_jet a = expr_jet_at(f, 0.6, 0.35), b = expr_jet_at(g, 0.6, 0.35);
        const double rounding = 1e-13 * (1 + fabs(a.second[0]) + fabs(a.second[1]));
        for (int i = 0; i < 2; i++)
            assert_true(fabs(a.first[i] - b.first[i]) <= rounding);
        for (int i = 0; i < 3; i++)
            assert_true(fabs(a.second[i] - b.second[i]) <= rounding);
        expr_free(f);
        expr_free(g);
    }
}

/* Whole powers have derivatives at 0; z and an index that varies have none. */
static void test_special_points(void **state)
{
    (void)state;
    expr *square = compile("x^2+x*y+0*y^0"), *height = compile("z"),
         *varying = compile("zernike(x,1,1)");
    const expr_jet jet = expr_jet_at(square, 0, 0);
    assert_true(jet.value == 0 && jet.first[0] == 0 && jet.second[0] == 2 && jet.second[2] == 1);
    assert_true(isnan(expr_jet_at(height, 1, 1).value));
    assert_true(isnan(expr_jet_at(varying, 1, 1).value));
    expr_free(square);
    expr_free(height);
    expr_free(varying);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_difference_quotients),
                                       cmocka_unit_test(test_identities),
                                       cmocka_unit_test(test_special_points)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
