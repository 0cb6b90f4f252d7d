/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Lanczos search for the lowest vibration modes. In the comments K is the stiffness and M the mass
 * matrix, and
 *   A = unit (K + shift M)^-1 M
 * is the operator of the search, whose largest eigenvalues belong to the lowest modes; unit is a
 * power of two that brings these eigenvalues near 1. The projection of A onto the basis and its
 * eigenvalues and eigenvectors (Ritz values and vectors) approximate those of A.
 */
#ifndef PZS_LIB_SEARCH_H
#define PZS_LIB_SEARCH_H

#include "pzs_modes.h"
#include "../core/linalg.h"

#if PZS_MODES

/*
 * How the search assembles and solves: in the undeformed state (undeformed.c) or about an
 * equilibrium (at_equilibrium.c).
 */
struct pzs_modes_calls {
    /*
     * Assemble the stiffness matrix K, not scaled, in the memory of the model. Returns PZS_OK or an
     * error.
     */
    pzs_status (*assemble_stiffness)(pzs_modes *modes);
    /*
     * Solve (K + shift M) u = f by the factors in the model. The force f is the first vector of the
     * work array of the model, the displacement u becomes the sixth.
     */
    pzs_status (*solve_force)(pzs_modes *modes);
    /*
     * Return the squared angular frequency of a mode shape.
     *   shape [free_dof] in  mode shape of unit modal mass
     *   ritz             in  squared angular frequency by the Ritz value
     */
    pzs_real (*squared_frequency)(const pzs_modes *modes, const pzs_real *shape, pzs_real ritz);
    /* Add the force per unit of an input to force [free_dof]. */
    void (*add_input_force)(const pzs_modes *modes, uint32_t input, pzs_real *force);
    /*
     * true: the matrix is factored at the begin of every search, with the scale factors of its rows
     * that the model holds; false: only with a shift, and with new scale factors.
     */
    bool keeps_scale;
    /*
     * Fix degrees of freedom whose displacement is prescribed: in the assembled matrix K + c M, and
     * in a product with M [free_dof]. NULL: there are none.
     */
    void (*fix_matrix)(pzs_modes *modes);
    void (*fix_product)(const pzs_modes *modes, pzs_real *product);
};

/*
 * What the search asks of open electrodes (open_electrodes.c). The table is present in a program
 * that calls pzs_modes_open_electrodes alone. In the comments A is the matrix K + shift M at
 * prescribed voltages.
 */
struct pzs_modes_open_calls {
    /*
     * Prepare linear solves, with the factors of A in the model. Returns PZS_OK or the error of a
     * linear solve.
     *   inertia in/out  pivots of A; out: of the matrix with open electrodes
     */
    pzs_status (*prepare_open)(pzs_modes *modes, linalg_inertia *inertia);
    /*
     * Turn the pivots of K - bound M, whose factors the model holds, into those of the matrix with
     * open electrodes. Overwrites the capacitances that hold_open has factored, which energy_open
     * and respond_open need.
     */
    void (*count_open)(pzs_modes *modes, linalg_inertia *inertia);
    /* Solve with open electrodes; force, displacement and errors as in pzs_modes_calls. */
    pzs_status (*solve_open)(pzs_modes *modes);
    /* Factor the capacitances. Returns PZS_OK, PZS_E_NONFINITE or PZS_E_CAPACITANCE. */
    pzs_status (*hold_open)(pzs_modes *modes);
    /*
     * Return twice the electric energy that a displacement [free_dof] stores in the open
     * electrodes. Overwrites the first vector of the work array of the model.
     */
    pzs_real (*energy_open)(const pzs_modes *modes, const pzs_real *displacement);
    /*
     * Turn static modal coordinates at prescribed voltages into those with open electrodes.
     *   response [inputs] in/out
     */
    void (*respond_open)(const pzs_modes *modes, pzs_real *response);
};

/* Begin a search with an empty basis. */
void pzs_search_begin(pzs_modes *modes);

/*
 * Append to the basis A times a start vector [free_dof], or A times a random vector where `start`
 * is NULL, in which the lowest modes dominate. The basis stays as it is if it is full or if the new
 * vector depends on it. Returns PZS_OK or the error of the linear solve.
 */
pzs_status pzs_search_append(pzs_modes *modes, const pzs_real *start);

/*
 * Extend the basis until `wanted` modes have converged, and those whose frequencies cannot be
 * distinguished from the last of them. info.converged is the number of these modes. Returns PZS_OK,
 * PZS_E_MODES, or the error of a linear solve.
 */
pzs_status pzs_search_converge(pzs_modes *modes, uint32_t wanted);

/* Squared angular frequency by the Ritz value of mode i, which is below state.done. */
pzs_real pzs_search_square(const pzs_modes *modes, uint32_t i);

/*
 * Number of the wanted modes, info.number, and of those whose frequencies cannot be
 * distinguished from that of the last of them.
 */
uint32_t pzs_search_found(const pzs_modes *modes);

/*
 * Bound of the squared angular frequency above the modes that pzs_search_found counts and, where
 * the next mode is known, below it.
 *   distance out  smallest distance of the bound from a mode, relative to the bound plus the shift
 */
pzs_real pzs_search_bound(const pzs_modes *modes, pzs_real *distance);

/*
 * Ratio of the eigenvalue of A of the last mode that pzs_search_found counts to its largest one.
 */
pzs_real pzs_search_range(const pzs_modes *modes);

/*
 * Replace the basis by its first `keep` Ritz vectors and `remainders` of the basis vectors to which
 * A has not been applied.
 */
void pzs_search_restart(pzs_modes *modes, uint32_t keep, uint32_t remainders);

/*
 * Multiply the mass matrix with a vector, both [free_dof] and in different arrays. The product is
 * zero at fixed degrees of freedom.
 */
void pzs_search_multiply(const pzs_modes *modes, const pzs_real *vector, pzs_real *product);

#endif
#endif
