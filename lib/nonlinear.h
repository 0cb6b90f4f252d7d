/*
 * How follower loads and contacts take part in the nonlinear path. An option is a structure that begins with a
 * pzs_option, a table of the calls below (NULL: nothing to do), and a function that attaches it to a path.
 */
#ifndef PZS_NONLINEAR_H
#define PZS_NONLINEAR_H

#include "pzs.h"

struct pzs_option_calls {
    /* Before each system of a load step: decide what is active. path->iteration counts from 0. */
    void (*prepare)(pzs_option *option, pzs_path *path);
    /* Forces at path->u onto load [dof], minus their derivative onto the model's matrix. */
    void (*add)(pzs_option *option, pzs_path *path, pzs_real *load);
    /* After each solve, path->u not yet moved by du [dof] nor the resultants extrapolated along it. */
    void (*solved)(pzs_option *option, pzs_path *path, const pzs_real *du);
    /* Is nothing left to change at path->u? */
    int (*settled)(pzs_option *option, pzs_path *path);
    /* Remember the present state; go back to it; forget both: the shell is at rest. */
    void (*keep)(pzs_option *option, pzs_path *path);
    void (*restore)(pzs_option *option, pzs_path *path);
    void (*rest)(pzs_option *option, pzs_path *path);
    /* Force at path->u per unit of input j, onto force [dof]. */
    void (*unit)(pzs_option *option, pzs_path *path, uint32_t input, pzs_real *force);
    /*
     * Unknowns of the option's own: add to du [dof], solved without them by the model's factor, what they make of it.
     * `input` is the one whose unit du answers to, or NEWTON: du answers to the imbalance, or NO_INPUT: to a force alone.
     * Returns whether it can be done. Rows three and four of the model's work are free.
     */
    int (*condense)(pzs_option *option, pzs_path *path, uint32_t input, pzs_real *du);
    /* y [dof] += factor W x: W the skew part of the derivative of add's forces, which its matrix leaves out.  x [dof] in */
    void (*skew)(pzs_option *option, pzs_path *path, const pzs_real *x, pzs_real factor, pzs_real *y);
};

enum { NEWTON = 0xFFFF, NO_INPUT = 0xFFFE };

/* CRC of the arrays of a pzs_nonlinear, as stored in its crc field. An input has at most one entry an element. */
uint32_t nonlinear_crc(const pzs_nonlinear *tables, const pzs_structure *structure);

/* H0 of every element at the present amounts, per unit of its stiffness factor, into path->given. */
void nonlinear_set_given(pzs_path *path);

/* Force at path->u per unit of an input, onto force [dof]: a dead load's row, -L(u)' H0, or that of an option. */
void nonlinear_unit_force(pzs_path *path, uint32_t input, pzs_real *force);

/* Once in the list, an option must not come into it again: the list would have no end. */
int nonlinear_is_attached(const pzs_path *path, const pzs_option *option);

/* Put an option in front of those attached; its state counts as that of the last equilibrium. */
void nonlinear_attach(pzs_path *path, pzs_option *option, const struct pzs_option_calls *call);

#endif
