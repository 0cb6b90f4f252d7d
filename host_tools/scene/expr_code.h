/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Code of a compiled formula: reverse Polish notation for a stack of EXPR_STACK values. It is
 * shared by the evaluation of values (expr.c) and of derivatives (expr_jet.c).
 */
#ifndef EXPR_CODE_H
#define EXPR_CODE_H

#include <stdbool.h>
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
    const char *text; /* copy of the formula's source text, stored after its code */
    int length;
    bool is_constant;
    scatter *scatter; /* function that interpolates between scattered points; NULL for other
                         functions */
    int axes, axis[SCATTER_AXES]; /* number of coordinates of the scattered points, and index of
                                     each among the coordinates x, y, z in space and theta1, theta2
                                     on the surface */
    double spacing; /* median distance of a scattered point to its nearest neighbour, where the
                       function interpolates between points; used to judge how far an interpolated
                       point lies from the data */
    double *list;   /* [rows] values of a function that is given as a list, one for each row of a
                       target (controlled displacement); NULL for other functions */
    int rows;
    instruction code[];
};

/* Return the number of values that an operation of a formula takes from the evaluation stack. */
int expr_arity(operation op);

/*
 * Find the radial order n and the azimuthal order m >= 0 of the Zernike polynomial with Noll index
 * j (position in Noll's sequence of the polynomials).
 */
void expr_zernike_orders(int j, int *n, int *m);

/*
 * Return the coefficient of rho^(n - 2 k) in the radial Zernike polynomial of orders n and m:
 * (-1)^k (n-k)! / (k! ((n+m)/2-k)! ((n-m)/2-k)!).
 */
double expr_zernike_coefficient(int n, int m, int k);

#endif
