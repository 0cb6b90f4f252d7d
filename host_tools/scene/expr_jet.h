/* SPDX-License-Identifier: BSD-2-Clause */
/* Derivatives of expressions by automatic differentiation. */
#ifndef EXPR_JET_H
#define EXPR_JET_H

#include "expr.h"

/* Value of a function of two parameters, with its first and second derivatives. */
typedef struct expr_jet {
    double value;
    double first[2];  /* by theta1, by theta2 */
    double second[3]; /* by theta1 twice, by theta2 twice, by both */
} expr_jet;

/*
 * Return value and derivatives of an expression of theta1 and theta2. In it x is another name of
 * theta1 and y of theta2; z, and values from a file, are not numbers. Results are not finite where
 * the expression or its derivatives are undefined; the caller must check.
 */
expr_jet expr_jet_at(const expr *expression, double theta1, double theta2);

#endif
