/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Code of a compiled expression: reverse Polish notation on a stack of EXPR_STACK values. Shared by
 * the evaluation of values (expr.c) and of derivatives (expr_jet.c).
 */
#ifndef EXPR_CODE_H
#define EXPR_CODE_H

#include "../data/scatter.h"

enum { EXPR_STACK = 64 };

typedef enum operation {
    OP_NUMBER,
    OP_X,
    OP_Y,
    OP_Z,
    OP_THETA1,
    OP_THETA2,
    OP_OPEN,
    OP_ADD,
    OP_SUBTRACT,
    OP_MULTIPLY,
    OP_DIVIDE,
    OP_NEGATE,
    OP_POWER,
    OP_SIN,
    OP_COS,
    OP_TAN,
    OP_ASIN,
    OP_ACOS,
    OP_ATAN,
    OP_SQRT,
    OP_EXP,
    OP_LOG,
    OP_ABS,
    OP_MIN,
    OP_MAX,
    OP_ATAN2,
    OP_POW,
    OP_HYPOT,
    OP_ZERNIKE
} operation;

typedef struct instruction {
    operation op;
    double number;
} instruction;

struct expr {
    const char *text; /* copy of the source text, stored after the code */
    int length, constant;
    scatter *scatter;             /* function through scattered points, or NULL */
    int axes, axis[SCATTER_AXES]; /* its coordinates */
    double spacing;               /* usual distance of its points */
    double *list;                 /* [rows] values of a list, or NULL */
    int rows;
    instruction code[];
};

/* Number of values that an operation takes from the stack. */
int expr_arity(operation op);

/* Orders n and m of the Zernike polynomial of Noll index j, m >= 0. */
void expr_zernike_orders(int j, int *n, int *m);

/*
 * Coefficient of rho^(n - 2 k) in the radial Zernike polynomial:
 * (-1)^k (n-k)! / (k! ((n+m)/2-k)! ((n-m)/2-k)!).
 */
double expr_zernike_coefficient(int n, int m, int k);

#endif
