/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Derivatives of formulas (expr_jet.h): every operation acts on a value together with its first and
 * second derivatives.
 */
#include "expr_jet.h"
#include <math.h>
#include <string.h>
#include "expr_code.h"

/*
 * Value, first and second derivative of a function of one variable, with which the chain rule is
 * applied to formulas.
 */
typedef struct slope1 {
    double value, first, second;
} slope1;

/*
 * Value and derivatives of a function of two variables a and b. `first`: derivatives with respect
 * to a and to b; `second`: twice with respect to a, twice to b, and mixed.
 */
typedef struct slope2 {
    double value, first[2], second[3];
} slope2;

static expr_jet constant(double value)
{
    const expr_jet jet = {value, {0, 0}, {0, 0, 0}};
    return jet;
}

static expr_jet parameter(int index, double value)
{
    expr_jet jet = constant(value);
    jet.first[index] = 1;
    return jet;
}

/* ---- chain rule ------------------------------------------------------- */

static expr_jet chain1(slope1 function, expr_jet a)
{
    static const int pair[3][2] = {{0, 0}, {1, 1}, {0, 1}};
    expr_jet jet = constant(function.value);
    for (int i = 0; i < 2; i++)
        jet.first[i] = function.first * a.first[i];
    for (int k = 0; k < 3; k++)
        jet.second[k] = function.first * a.second[k] +
                        function.second * a.first[pair[k][0]] * a.first[pair[k][1]];
    return jet;
}

static expr_jet chain2(slope2 function, expr_jet a, expr_jet b)
{
    static const int pair[3][2] = {{0, 0}, {1, 1}, {0, 1}};
    expr_jet jet = constant(function.value);
    for (int i = 0; i < 2; i++)
        jet.first[i] = function.first[0] * a.first[i] + function.first[1] * b.first[i];
    for (int k = 0; k < 3; k++) {
        const int i = pair[k][0], j = pair[k][1];
        jet.second[k] = function.first[0] * a.second[k] + function.first[1] * b.second[k] +
                        function.second[0] * a.first[i] * a.first[j] +
                        function.second[1] * b.first[i] * b.first[j] +
                        function.second[2] * (a.first[i] * b.first[j] + a.first[j] * b.first[i]);
    }
    return jet;
}

/* ---- functions of one value ------------------------------------------- */

static slope1 trigonometric(operation op, double argument)
{
    const double sine = sin(argument), cosine = cos(argument), tangent = sine / cosine;
    switch (op) {
    case OP_SIN: return (slope1){sine, cosine, -sine};
    case OP_COS: return (slope1){cosine, -sine, -cosine};
    default: return (slope1){tangent, 1 + tangent * tangent, 2 * tangent * (1 + tangent * tangent)};
    }
}

static slope1 inverse_trigonometric(operation op, double argument)
{
    const double root = sqrt(1 - argument * argument), square = 1 + argument * argument;
    switch (op) {
    case OP_ASIN: return (slope1){asin(argument), 1 / root, argument / (root * root * root)};
    case OP_ACOS: return (slope1){acos(argument), -1 / root, -argument / (root * root * root)};
    default: return (slope1){atan(argument), 1 / square, -2 * argument / (square * square)};
    }
}

static slope1 slope_of(operation op, double argument)
{
    switch (op) {
    case OP_NEGATE: return (slope1){-argument, -1, 0};
    case OP_SIN:
    case OP_COS:
    case OP_TAN: return trigonometric(op, argument);
    case OP_ASIN:
    case OP_ACOS:
    case OP_ATAN: return inverse_trigonometric(op, argument);
    case OP_SQRT:
        return (slope1){sqrt(argument), 0.5 / sqrt(argument), -0.25 / (argument * sqrt(argument))};
    case OP_EXP: return (slope1){exp(argument), exp(argument), exp(argument)};
    case OP_LOG: return (slope1){log(argument), 1 / argument, -1 / (argument * argument)};
    default: return (slope1){fabs(argument), argument < 0 ? -1 : 1, 0};
    }
}

/*
 * Return the value of base^exponent for a constant exponent with its first and second derivatives
 * with respect to the base; they are exact also where the base is 0 and the exponent is a small
 * integer.
 */
static slope1 power_slope(double base, double exponent)
{
    const double first = exponent == 0 ? 0 : exponent * pow(base, exponent - 1);
    const double second =
        exponent == 0 || exponent == 1 ? 0 : exponent * (exponent - 1) * pow(base, exponent - 2);
    return (slope1){pow(base, exponent), first, second};
}

/* ---- functions of two values ------------------------------------------ */

static int is_constant(expr_jet jet)
{
    return jet.first[0] == 0 && jet.first[1] == 0 && jet.second[0] == 0 && jet.second[1] == 0 &&
           jet.second[2] == 0;
}

static expr_jet power(expr_jet base, expr_jet exponent)
{
    if (is_constant(exponent))
        return chain1(power_slope(base.value, exponent.value), base);
    const double value = pow(base.value, exponent.value), logarithm = log(base.value),
                 quotient_of_values = exponent.value / base.value;
    const slope2 slopes = {value,
                           {value * quotient_of_values, value * logarithm},
                           {value * quotient_of_values * (exponent.value - 1) / base.value,
                            value * logarithm * logarithm,
                            value * (1 + exponent.value * logarithm) / base.value}};
    return chain2(slopes, base, exponent);
}

static slope2 quotient(double a, double b)
{
    return (slope2){a / b, {1 / b, -a / (b * b)}, {0, 2 * a / (b * b * b), -1 / (b * b)}};
}

/*
 * Return the value of atan2(a, b), the polar angle of the point with abscissa b and ordinate a,
 * with its derivatives with respect to a and b.
 */
static slope2 angle(double a, double b)
{
    const double r2 = a * a + b * b, r4 = r2 * r2;
    return (slope2){
        atan2(a, b), {b / r2, -a / r2}, {-2 * a * b / r4, 2 * a * b / r4, (a * a - b * b) / r4}};
}

static slope2 radius(double a, double b)
{
    const double r = hypot(a, b), r3 = r * r * r;
    return (slope2){r, {a / r, b / r}, {b * b / r3, a * a / r3, -a * b / r3}};
}

static expr_jet combine(operation op, expr_jet left, expr_jet right)
{
    switch (op) {
    case OP_ADD: return chain2((slope2){left.value + right.value, {1, 1}, {0, 0, 0}}, left, right);
    case OP_SUBTRACT:
        return chain2((slope2){left.value - right.value, {1, -1}, {0, 0, 0}}, left, right);
    case OP_MULTIPLY:
        return chain2((slope2){left.value * right.value, {right.value, left.value}, {0, 0, 1}},
                      left, right);
    case OP_DIVIDE: return chain2(quotient(left.value, right.value), left, right);
    case OP_POWER:
    case OP_POW: return power(left, right);
    case OP_MIN: return left.value < right.value ? left : right;
    case OP_MAX: return left.value > right.value ? left : right;
    case OP_ATAN2: return chain2(angle(left.value, right.value), left, right);
    default: return chain2(radius(left.value, right.value), left, right);
    }
}

/* ---- Zernike polynomials ---------------------------------------------- */

static expr_jet scaled(expr_jet jet, double factor)
{
    return chain1((slope1){factor * jet.value, factor, 0}, jet);
}

static expr_jet zernike(expr_jet number, expr_jet rho, expr_jet phi)
{
    int n, m;
    const int j = (int)number.value;
    if (!is_constant(number) || !(number.value >= 1 && number.value <= 1000) || j != number.value)
        return constant((double)NAN);
    expr_zernike_orders(j, &n, &m);
    expr_jet sum = constant(0);
    for (int k = 0; k <= (n - m) / 2; k++) {
        const expr_jet term = chain1(power_slope(rho.value, n - 2 * k), rho);
        sum = combine(OP_ADD, sum, scaled(term, expr_zernike_coefficient(n, m, k)));
    }
    if (m == 0)
        return scaled(sum, sqrt(n + 1));
    const expr_jet turn = scaled(phi, m);
    const expr_jet round = chain1(slope_of(j % 2 ? OP_SIN : OP_COS, turn.value), turn);
    return scaled(combine(OP_MULTIPLY, sum, round), sqrt(2 * (n + 1)));
}

/* ---- evaluation ------------------------------------------------------- */

static expr_jet operand(const instruction *code, double theta1, double theta2)
{
    switch (code->op) {
    case OP_NUMBER: return constant(code->number);
    case OP_X:
    case OP_THETA1: return parameter(0, theta1);
    case OP_Y:
    case OP_THETA2: return parameter(1, theta2);
    default: return constant((double)NAN);
    }
}

expr_jet expr_jet_at(const expr *expression, double theta1, double theta2)
{
    expr_jet stack[EXPR_STACK + 1] = {constant((double)NAN)};
    int top = 0;
    for (int i = 0; i < expression->length; i++) {
        const instruction *code = &expression->code[i];
        const int count = expr_arity(code->op);
        top -= count;
        if (count == 3)
            stack[top] = zernike(stack[top], stack[top + 1], stack[top + 2]);
        else if (count == 2)
            stack[top] = combine(code->op, stack[top], stack[top + 1]);
        else if (count == 1)
            stack[top] = chain1(slope_of(code->op, stack[top].value), stack[top]);
        else
            stack[top] = operand(code, theta1, theta2);
        top++;
    }
    return stack[0];
}
