/* SPDX-License-Identifier: BSD-2-Clause */
/* First and second derivatives of formulas by automatic differentiation. */
#ifndef EXPR_JET_H
#define EXPR_JET_H

#include "expr.h"

/*
 * Value of a function of the two surface parameters theta1 and theta2, with its first and second
 * derivatives.
 */
typedef struct expr_jet {
    double value;
    double first[2];  /* derivatives with respect to the surface parameters theta1 and theta2 */
    double second[3]; /* second derivatives with respect to the surface parameters: twice to theta1,
                         twice to theta2, and mixed */
} expr_jet;

/*
 * Return the value of a formula in theta1 and theta2 (also named x and y), and its derivatives with
 * respect to them. The result is NAN for a formula that uses z or values from a file, and not
 * finite where the formula or a derivative is undefined; the caller must check.
 */
expr_jet expr_jet_at(const expr *expression, double theta1, double theta2);

#endif
