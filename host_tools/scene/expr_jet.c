/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Derivatives of expressions (expr_jet.h): every operation acts on a value together with its first
 * and second derivatives.
 */
#include "expr_jet.h"
#include <math.h>
#include <string.h>
#include "expr_code.h"

/* Derivatives of a function of one value. */
typedef struct slope1 {
    double value, first, second;
} slope1;

/* Derivatives of a function of two values a, b: by a, b; by a twice, b twice, both. */
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

static expr_jet chain1(slope1 f, expr_jet a)
{
    static const int pair[3][2] = {{0, 0}, {1, 1}, {0, 1}};
    expr_jet jet = constant(f.value);
    for (int i = 0; i < 2; i++)
        jet.first[i] = f.first * a.first[i];
    for (int k = 0; k < 3; k++)
        jet.second[k] =
            f.first * a.second[k] + f.second * a.first[pair[k][0]] * a.first[pair[k][1]];
    return jet;
}

static expr_jet chain2(slope2 f, expr_jet a, expr_jet b)
{
    static const int pair[3][2] = {{0, 0}, {1, 1}, {0, 1}};
    expr_jet jet = constant(f.value);
    for (int i = 0; i < 2; i++)
        jet.first[i] = f.first[0] * a.first[i] + f.first[1] * b.first[i];
    for (int k = 0; k < 3; k++) {
        const int i = pair[k][0], j = pair[k][1];
        jet.second[k] = f.first[0] * a.second[k] + f.first[1] * b.second[k] +
                        f.second[0] * a.first[i] * a.first[j] +
                        f.second[1] * b.first[i] * b.first[j] +
                        f.second[2] * (a.first[i] * b.first[j] + a.first[j] * b.first[i]);
    }
    return jet;
}

/* ---- functions of one value ------------------------------------------- */

static slope1 trigonometric(operation op, double a)
{
    const double s = sin(a), c = cos(a), t = s / c;
    switch (op) {
    case OP_SIN: return (slope1){s, c, -s};
    case OP_COS: return (slope1){c, -s, -c};
    default: return (slope1){t, 1 + t * t, 2 * t * (1 + t * t)};
    }
}

static slope1 inverse_trigonometric(operation op, double a)
{
    const double root = sqrt(1 - a * a), square = 1 + a * a;
    switch (op) {
    case OP_ASIN: return (slope1){asin(a), 1 / root, a / (root * root * root)};
    case OP_ACOS: return (slope1){acos(a), -1 / root, -a / (root * root * root)};
    default: return (slope1){atan(a), 1 / square, -2 * a / (square * square)};
    }
}

static slope1 slope_of(operation op, double a)
{
    switch (op) {
    case OP_NEGATE: return (slope1){-a, -1, 0};
    case OP_SIN:
    case OP_COS:
    case OP_TAN: return trigonometric(op, a);
    case OP_ASIN:
    case OP_ACOS:
    case OP_ATAN: return inverse_trigonometric(op, a);
    case OP_SQRT: return (slope1){sqrt(a), 0.5 / sqrt(a), -0.25 / (a * sqrt(a))};
    case OP_EXP: return (slope1){exp(a), exp(a), exp(a)};
    case OP_LOG: return (slope1){log(a), 1 / a, -1 / (a * a)};
    default: return (slope1){fabs(a), a < 0 ? -1 : 1, 0};
    }
}

/* Derivatives of a^n for a constant power, also where a is 0 and n is a small whole number. */
static slope1 power_slope(double a, double n)
{
    const double first = n == 0 ? 0 : n * pow(a, n - 1);
    const double second = n == 0 || n == 1 ? 0 : n * (n - 1) * pow(a, n - 2);
    return (slope1){pow(a, n), first, second};
}

/* ---- functions of two values ------------------------------------------ */

static int is_constant(expr_jet a)
{
    return a.first[0] == 0 && a.first[1] == 0 && a.second[0] == 0 && a.second[1] == 0 &&
           a.second[2] == 0;
}

static expr_jet power(expr_jet a, expr_jet b)
{
    if (is_constant(b))
        return chain1(power_slope(a.value, b.value), a);
    const double value = pow(a.value, b.value), l = log(a.value), q = b.value / a.value;
    const slope2 f = {
        value,
        {value * q, value * l},
        {value * q * (b.value - 1) / a.value, value * l * l, value * (1 + b.value * l) / a.value}};
    return chain2(f, a, b);
}

static slope2 quotient(double a, double b)
{
    return (slope2){a / b, {1 / b, -a / (b * b)}, {0, 2 * a / (b * b * b), -1 / (b * b)}};
}

/* Angle of the point (b, a), as atan2(a, b). */
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

static expr_jet combine(operation op, expr_jet a, expr_jet b)
{
    switch (op) {
    case OP_ADD: return chain2((slope2){a.value + b.value, {1, 1}, {0, 0, 0}}, a, b);
    case OP_SUBTRACT: return chain2((slope2){a.value - b.value, {1, -1}, {0, 0, 0}}, a, b);
    case OP_MULTIPLY:
        return chain2((slope2){a.value * b.value, {b.value, a.value}, {0, 0, 1}}, a, b);
    case OP_DIVIDE: return chain2(quotient(a.value, b.value), a, b);
    case OP_POWER:
    case OP_POW: return power(a, b);
    case OP_MIN: return a.value < b.value ? a : b;
    case OP_MAX: return a.value > b.value ? a : b;
    case OP_ATAN2: return chain2(angle(a.value, b.value), a, b);
    default: return chain2(radius(a.value, b.value), a, b);
    }
}

/* ---- Zernike polynomials ---------------------------------------------- */

static expr_jet scaled(expr_jet a, double factor)
{
    return chain1((slope1){factor * a.value, factor, 0}, a);
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
