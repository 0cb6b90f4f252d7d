/*
 * How follower loads, contacts and open electrodes take part in the nonlinear path, and what the
 * path lends to them. An option is a structure that begins with a pzs_solver_option, a table of the
 * calls below (NULL: nothing to do), and a function that attaches it to a path.
 */
#ifndef PZS_LIB_NONLINEAR_H
#define PZS_LIB_NONLINEAR_H

#include "pzs_nonlinear.h"

#if PZS_NONLINEAR

struct pzs_solver_option_calls {
    /* Before an equilibrium: are the choices in range? */
    int (*choices_in_range)(const pzs_solver_option *option);
    /* Before each system of a load step: decide what is active. path->iteration counts from 0.
     * Returns 0 where nothing can be solved. */
    int (*prepare)(pzs_solver_option *option, pzs_solver *path);
    /* Forces at path->u onto load [dof], minus their derivative onto the model's matrix. */
    void (*add)(pzs_solver_option *option, pzs_solver *path, pzs_real *load);
    /* After each solve, path->u not yet moved by du [dof] nor the resultants extrapolated along it.
     */
    void (*solved)(pzs_solver_option *option, pzs_solver *path, const pzs_real *du);
    /* Is nothing left to change at path->u? And the error of a path that ends because something
     * always was. */
    int (*settled)(pzs_solver_option *option, pzs_solver *path);
    pzs_status unsettled;
    /* A load step has settled: PZS_OK, a warning, or the error that its shape cannot stand with
     * (sets path->refused_at). */
    pzs_status (*refuses)(pzs_solver_option *option, pzs_solver *path);
    /* Largest part, above 0 and at most 1, of the way to the amounts that the next load step may
     * take. */
    pzs_real (*longest)(pzs_solver_option *option, const pzs_solver *path, const pzs_real *amount);
    /* A load step was given up, in the state it ended with: was it because the option does not hold
     * the shell up? */
    int (*adrift)(const pzs_solver_option *option, const pzs_solver *path);
    /* Remember the present state; go back to it; forget both: the shell is at rest. */
    void (*keep)(pzs_solver_option *option, pzs_solver *path);
    void (*restore)(pzs_solver_option *option, pzs_solver *path);
    void (*rest)(pzs_solver_option *option, pzs_solver *path);
    /* Force at path->u per unit of input j, onto force [dof]. */
    void (*unit)(pzs_solver_option *option, pzs_solver *path, uint32_t input, pzs_real *force);
    /*
     * Unknowns of the option's own: add to du [dof], solved without them by the model's factor,
     * what they make of it. `input` is the one whose unit du answers to, or NEWTON: du answers to
     * the imbalance, or NO_INPUT: to a force alone. Returns whether it can be done. Rows three and
     * four of the model's work are free.
     */
    int (*condense)(pzs_solver_option *option, pzs_solver *path, uint32_t input, pzs_real *du);
    /* y [dof] += factor W x: W the skew part of the derivative of add's forces, which its matrix
     * leaves out.  x [dof] in */
    void (*skew)(pzs_solver_option *option, pzs_solver *path, const pzs_real *x, pzs_real factor,
                 pzs_real *y);
};

enum { NEWTON = 0xFFFF, NO_INPUT = 0xFFFE };

/* PATH_SETTLED: the model holds the factored tangent at path->u. */
enum { PATH_READY = 1, PATH_SETTLED = 2 };

/* ---- tables and options ------------------------------------------------- */

/* CRCs of tables that go with a structure, as stored in their crc fields. An input has at most one
 * entry an element. */
uint32_t pzs_nonlinear_crc(const pzs_nonlinear *tables, const pzs_structure *structure);
uint32_t pzs_follower_crc(const pzs_follower *tables, const pzs_structure *structure);
uint32_t pzs_contact_crc(const pzs_contact_face *tables, const pzs_structure *structure);

/* Once in the list, an option must not come into it again: the list would have no end. */
int pzs_nonlinear_is_attached(const pzs_solver *solver, const pzs_solver_option *option);

/* Put an option in front of those attached; its state counts as that of the last equilibrium. */
void pzs_nonlinear_attach(pzs_solver *solver, pzs_solver_option *option,
                          const struct pzs_solver_option_calls *call);

/* ---- inputs ------------------------------------------------------------- */

/* H0 of every element at the present amounts, per unit of its stiffness factor, into path->given.
 */
void pzs_nonlinear_set_given(pzs_solver *solver);

/* Force at path->u per unit of an input, onto force [dof]: a dead load's row, -L(u)' H0, or that of
 * an option. */
void pzs_nonlinear_unit_force(pzs_solver *solver, uint32_t input, pzs_real *force);

/* ---- one system --------------------------------------------------------- */

/*
 * Tangent into the model's envelope and force imbalance at path->u.
 *   plain     in        geometric part by the true resultants instead of the extrapolated ones
 *   imbalance [dof] out load - internal force; path->load gets the load
 */
void pzs_nonlinear_build(pzs_solver *solver, int plain, pzs_real *imbalance);

/* Take unknown p out of a system: K x = b with x_p = value. Its row becomes d x_p = d value, d its
 * diagonal. */
void pzs_nonlinear_prescribe(pzs_envelope *k, uint32_t p, pzs_real value, pzs_real *b);

/* f [dof] without what it has on prescribed unknowns. */
void pzs_nonlinear_clear_prescribed(const pzs_solver *solver, pzs_real *f);

/* Scale and factor what was built; sets path->negative and where. Returns whether it can be solved.
 */
int pzs_nonlinear_factor(pzs_solver *solver);

/* What the options' own unknowns make of du [dof]. Returns whether it can be done. */
int pzs_nonlinear_condense(pzs_solver *solver, uint32_t input, pzs_real *du);

/* Square of the size of a displacement x, or x - y: mean u, h times difference/h, h times (u3M -
 * mean u3)/h. */
pzs_real pzs_nonlinear_norm2(const pzs_solver *solver, const pzs_real *x, const pzs_real *y);

#endif
#endif
