/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * How follower loads, contacts and open electrodes take part in the equilibrium solver, and the
 * internals of the solver that they use. An option is a struct that begins with a
 * pzs_solver_option, a table of the calls below (NULL: nothing to do), and a function that attaches
 * the option to a solver.
 */
#ifndef PZS_LIB_NONLINEAR_H
#define PZS_LIB_NONLINEAR_H

#include "pzs_nonlinear.h"

#if PZS_NONLINEAR

struct pzs_solver_option_calls {
    /* Before an equilibrium: whether the settings of the option are in range. */
    bool (*settings_in_range)(const pzs_solver_option *option);
    /*
     * Before each linear solve of a load step: choose the active set. state.iteration counts the
     * linear solves of the load step from 0. Returns false if nothing can be solved.
     */
    bool (*prepare_solve)(pzs_solver_option *option, pzs_solver *solver);
    /*
     * Add the forces at the present displacement to load [free_dof], and subtract their derivative
     * from the matrix of the model.
     */
    void (*add_forces)(pzs_solver_option *option, pzs_solver *solver, pzs_real *load);
    /*
     * After each linear solve, before the displacement is moved by du [free_dof] and the resultants
     * are extrapolated along it.
     */
    void (*after_solve)(pzs_solver_option *option, pzs_solver *solver, const pzs_real *du);
    /*
     * Whether the option has converged at the present displacement, and the status of a solver that
     * ends because it has not.
     */
    bool (*has_converged)(pzs_solver_option *option, pzs_solver *solver);
    pzs_status not_converged;
    /*
     * After a load step has converged: PZS_OK, a warning, or the error for which the shape is
     * refused (then state.refused_at is set).
     */
    pzs_status (*check_step)(pzs_solver_option *option, pzs_solver *solver);
    /*
     * Largest part of the remaining way to the input values `value` that the next load step may
     * take, above 0 and at most 1.
     */
    pzs_real (*largest_part)(pzs_solver_option *option, const pzs_solver *solver,
                             const pzs_real *value);
    /*
     * After a load step has failed: whether it failed because the option does not support the
     * shell.
     */
    bool (*is_unsupported)(const pzs_solver_option *option, const pzs_solver *solver);
    /*
     * Save the present state as that of the last equilibrium; restore that state; return to the
     * undeformed state.
     */
    void (*save)(pzs_solver_option *option, pzs_solver *solver);
    void (*restore)(pzs_solver_option *option, pzs_solver *solver);
    void (*reset)(pzs_solver_option *option, pzs_solver *solver);
    /* Add the force at the present displacement per unit of input j to force [free_dof]. */
    void (*add_unit_force)(pzs_solver_option *option, pzs_solver *solver, uint32_t input,
                           pzs_real *force);
    /*
     * For an option with unknowns of its own: add their effect to du [free_dof], which was solved
     * by the factor of the model without them. `input` is the input to whose unit du is the
     * response, or NEWTON if du is the response to the force imbalance, or NO_INPUT if it is the
     * response to any other force. Returns false if the unknowns cannot be solved for. Rows three
     * and four of the work of the model are free.
     */
    bool (*condense)(pzs_solver_option *option, pzs_solver *solver, uint32_t input, pzs_real *du);
    /*
     * y [free_dof] += factor W x. W is the skew-symmetric part of the derivative of the forces of
     * add_forces, which the matrix leaves out. x [free_dof] in.
     */
    void (*add_skew)(pzs_solver_option *option, pzs_solver *solver, const pzs_real *x,
                     pzs_real factor, pzs_real *y);
};

enum { NEWTON = 0xFFFF, NO_INPUT = 0xFFFE };

/*
 * Values of state.stage. SOLVER_CONVERGED: the model holds the factored tangent at the equilibrium.
 */
enum { SOLVER_READY = 1, SOLVER_CONVERGED = 2 };

/* ---- tables and options ------------------------------------------------- */

/*
 * Checksums of the tables that belong to a structure, as stored in their crc fields. An input has
 * at most one entry for each element.
 */
uint32_t pzs_nonlinear_crc(const pzs_nonlinear *tables, const pzs_structure *structure);
uint32_t pzs_follower_crc(const pzs_follower *tables, const pzs_structure *structure);
uint32_t pzs_contact_crc(const pzs_contact_face *tables, const pzs_structure *structure);

/*
 * Whether the option is in the list of the solver. An option must not be attached twice, because
 * the list would then have no end.
 */
bool pzs_nonlinear_is_attached(const pzs_solver *solver, const pzs_solver_option *option);

/*
 * Put an option in front of those attached. Its present state counts as that of the last
 * equilibrium.
 */
void pzs_nonlinear_attach(pzs_solver *solver, pzs_solver_option *option,
                          const struct pzs_solver_option_calls *call);

/* ---- forces of the inputs ----------------------------------------------- */

/*
 * Write the prescribed resultants H0 of every element at the present input values, per unit of its
 * stiffness factor, to state.prescribed.
 */
void pzs_nonlinear_set_prescribed(pzs_solver *solver);

/*
 * Add the force per unit of an input at the present displacement to force [free_dof]: the row of a
 * dead load, -L(u)' H0 of an actuation, or the force of an option.
 */
void pzs_nonlinear_unit_force(pzs_solver *solver, uint32_t input, pzs_real *force);

/* ---- one linear solve --------------------------------------------------- */

/*
 * Assemble the tangent in the envelope of the model, and the force imbalance at the present
 * displacement.
 *   uses_true_resultants in  geometric part from the true instead of the extrapolated resultants
 *   imbalance [free_dof] out load - internal force
 * state.load receives the load.
 */
void pzs_nonlinear_build(pzs_solver *solver, bool uses_true_resultants, pzs_real *imbalance);

/*
 * Prescribe x_p = value in the linear equations K x = b: row p becomes d x_p = d value, with d the
 * diagonal entry.
 */
void pzs_nonlinear_prescribe(pzs_envelope *matrix, uint32_t dof, pzs_real value,
                             pzs_real *right_side);

/* Set the entries of internal_force [free_dof] at the dof of the prescribed motion to zero. */
void pzs_nonlinear_clear_prescribed(const pzs_solver *solver, pzs_real *internal_force);

/*
 * Scale and factor the tangent; set info.negative_pivots and info.where. Returns false if it is
 * singular.
 */
bool pzs_nonlinear_factor(pzs_solver *solver);

/*
 * Add the effect of the options' own unknowns to du [free_dof]. Returns false if they cannot be
 * solved for.
 */
bool pzs_nonlinear_condense(pzs_solver *solver, uint32_t input, pzs_real *du);

/*
 * Squared norm of a displacement x, or of x - y, in units of length: mean u, h times difference/h,
 * h times (u3M - mean u3)/h.
 */
pzs_real pzs_nonlinear_norm2(const pzs_solver *solver, const pzs_real *vector,
                             const pzs_real *other);

#endif
#endif
