/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Interface between the equilibrium solver and its options (follower loads, contacts, open
 * electrodes). An option is a struct that begins with a pzs_solver_option and is attached by a
 * function pzs_attach_...; its functions are in pzs_solver_option_calls, NULL where it has nothing
 * to do.
 */
#ifndef PZS_LIB_NONLINEAR_H
#define PZS_LIB_NONLINEAR_H

#include "pzs_nonlinear.h"

#if PZS_NONLINEAR

struct pzs_solver_option_calls {
    /*
     * Function of a solver option (such as a contact), called before an equilibrium is computed:
     * return whether the settings of the option are in range.
     */
    bool (*settings_in_range)(const pzs_solver_option *option);
    /*
     * Function of a solver option (such as a contact), called before each linear solve: prepare the
     * option, for example choose the nodes that a contact holds on its body. state.iteration counts
     * the linear solves of the load step from 0. Returns false if no linear solve is possible.
     */
    bool (*prepare_solve)(pzs_solver_option *option, pzs_solver *solver);
    /*
     * Add the forces of a solver option (such as a contact) at the present displacement to load
     * [free_dof], and subtract their derivative with respect to the displacement from the stiffness
     * matrix of the model.
     */
    void (*add_forces)(pzs_solver_option *option, pzs_solver *solver, pzs_real *load);
    /*
     * Function of a solver option (such as a contact), called after each linear solve, before the
     * increment du [free_dof] is added to the displacement and the stress resultants are
     * extrapolated along it.
     */
    void (*after_solve)(pzs_solver_option *option, pzs_solver *solver, const pzs_real *du);
    /*
     * has_converged returns whether a solver option (such as a contact) has converged at the
     * present displacement. not_converged is the status of a solver that ends because the option
     * has not converged.
     */
    bool (*has_converged)(pzs_solver_option *option, pzs_solver *solver);
    pzs_status not_converged;
    /*
     * Function of a solver option (such as a contact), called after a load step has converged:
     * return PZS_OK, a warning, or the error for which the shape is rejected. With an error the
     * function sets state.refused_at.
     */
    pzs_status (*check_step)(pzs_solver_option *option, pzs_solver *solver);
    /*
     * Function of a solver option (such as a contact): return how far the next load step may go, as
     * the largest part (above 0, at most 1) of the way from the last equilibrium to the input
     * values `value`.
     */
    pzs_real (*largest_part)(pzs_solver_option *option, const pzs_solver *solver,
                             const pzs_real *value);
    /*
     * Function of a solver option (such as a contact), called after a load step has failed: return
     * whether it failed because the supports leave the shell loose and the contact body does not
     * hold it.
     */
    bool (*is_unsupported)(const pzs_solver_option *option, const pzs_solver *solver);
    /*
     * For a solver option such as a contact, save stores its state as that of the last equilibrium,
     * restore returns to that state, and reset returns to the undeformed state.
     */
    void (*save)(pzs_solver_option *option, pzs_solver *solver);
    void (*restore)(pzs_solver_option *option, pzs_solver *solver);
    void (*reset)(pzs_solver_option *option, pzs_solver *solver);
    /*
     * For a solver option (such as a contact) that an input moves or scales: add its force per unit
     * of the input, at the present displacement, to force [free_dof].
     */
    void (*add_unit_force)(pzs_solver_option *option, pzs_solver *solver, uint32_t input,
                           pzs_real *force);
    /*
     * For a solver option with unknowns of its own, such as the voltages of open electrodes: add
     * the displacement that these unknowns cause to one computed without them. May use the third
     * and fourth vector of the model's work array.
     *   input         in      load that has caused du: an input index for a unit of this input;
     *                         NEWTON for the force imbalance; NO_INPUT for another force
     *   du [free_dof] in/out  displacement
     * Returns false if the unknowns cannot be solved for.
     */
    bool (*condense)(pzs_solver_option *option, pzs_solver *solver, uint32_t input, pzs_real *du);
    /*
     * Add the product W x, times a factor, to y. W is the skew-symmetric part of the derivative of
     * the forces of a solver option (such as a follower load), which the stiffness matrix leaves
     * out.
     *   x [free_dof] in      vector
     *   y [free_dof] in/out  sum
     */
    void (*add_skew)(pzs_solver_option *option, pzs_solver *solver, const pzs_real *x,
                     pzs_real factor, pzs_real *y);
};

enum { NEWTON = 0xFFFF, NO_INPUT = 0xFFFE };

/*
 * Stages of the equilibrium solver. SOLVER_READY: initialised. SOLVER_CONVERGED: the equilibrium is
 * found, and the linear model holds the factors of the tangent matrix there.
 */
enum { SOLVER_READY = 1, SOLVER_CONVERGED = 2 };

/* ---- tables and options ------------------------------------------------- */

/*
 * Return the checksum of the tables of an equilibrium solver, of a follower load or of a contact
 * face, as stored in their member crc. The tables must belong to the structure.
 */
uint32_t pzs_nonlinear_crc(const pzs_nonlinear *tables, const pzs_structure *structure);
uint32_t pzs_follower_crc(const pzs_follower *tables, const pzs_structure *structure);
uint32_t pzs_contact_crc(const pzs_contact_face *tables, const pzs_structure *structure);

/*
 * Return whether an option (such as a contact) is already in the linked list of options of an
 * equilibrium solver. Attaching an option twice would make the list endless.
 */
bool pzs_nonlinear_is_attached(const pzs_solver *solver, const pzs_solver_option *option);

/*
 * Put an option (such as a contact) at the front of the linked list of options of an equilibrium
 * solver. The present state of the option counts as that of the last equilibrium.
 */
void pzs_nonlinear_attach(pzs_solver *solver, pzs_solver_option *option,
                          const struct pzs_solver_option_calls *call);

/* ---- forces of the inputs ----------------------------------------------- */

/*
 * Compute the stress resultants that the present input values prescribe in every element
 * (piezoelectric actuation, temperature) into state.prescribed. They are divided by the factor of
 * the element's stiffness that was passed to pzs_assemble, because the element computations
 * multiply by it.
 */
void pzs_nonlinear_set_prescribed(pzs_solver *solver);

/*
 * Add the force per unit of an input, at the present displacement, to force [free_dof]. For a load
 * of constant direction it is the force vector of the input. For an actuation it is the force of
 * the prescribed stress resultants. A solver option, such as a follower load, adds its own force.
 */
void pzs_nonlinear_unit_force(pzs_solver *solver, uint32_t input, pzs_real *force);

/* ---- one linear solve --------------------------------------------------- */

/*
 * Assemble the tangent matrix, and compute the force imbalance at the present displacement and the
 * applied load state.load.
 *   uses_true_resultants in   true: the geometric part of the matrix uses the stress resultants of
 *                             the present displacement; false: those extrapolated by Newton's
 *                             method
 *   imbalance [free_dof] out  load minus internal force (N and N m)
 */
void pzs_nonlinear_build(pzs_solver *solver, bool uses_true_resultants, pzs_real *imbalance);

/*
 * Extrapolate the stress resultants of every element from the present displacement along an
 * increment of the displacement, to first order, into state.resultant.
 *   du [free_dof] in  increment of the displacement; NULL: 0, so that the resultants are those of
 *                     the present displacement
 */
void pzs_nonlinear_extrapolate(pzs_solver *solver, const pzs_real *du);

/*
 * Prescribe the value of one unknown in a symmetric system of linear equations: its row and column
 * become zero apart from the diagonal, and the right-hand side is changed accordingly.
 *   dof                in      index of the unknown
 *   value              in      prescribed value
 *   right_side [rows]  in/out  right-hand side
 */
void pzs_nonlinear_prescribe(pzs_envelope *matrix, uint32_t dof, pzs_real value,
                             pzs_real *right_side);

/*
 * Set to zero the entries of a force [free_dof] at those degrees of freedom whose displacement an
 * input prescribes.
 */
void pzs_nonlinear_clear_prescribed(const pzs_solver *solver, pzs_real *internal_force);

/*
 * Scale and factor the tangent matrix, and set info.negative_pivots (number of negative pivots) and
 * info.where (index of the free degree of freedom with a zero pivot, or -1). Returns false if the
 * matrix is singular.
 */
bool pzs_nonlinear_factor(pzs_solver *solver);

/*
 * Add the displacement that the additional unknowns of all solver options (voltages of open
 * electrodes) cause to du [free_dof], a displacement that was computed without them. Returns false
 * if the unknowns cannot be solved for.
 */
bool pzs_nonlinear_condense(pzs_solver *solver, uint32_t input, pzs_real *du);

/*
 * Return the squared norm (m2) of a displacement [free_dof], or of the difference of two. The
 * degrees of freedom that are differences over the thickness count times the thickness. `other` may
 * be NULL.
 */
pzs_real pzs_nonlinear_norm2(const pzs_solver *solver, const pzs_real *vector,
                             const pzs_real *other);

#endif
#endif
