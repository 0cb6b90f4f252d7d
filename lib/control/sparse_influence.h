/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Sparse influence matrix of the controller's tables (pzs_sparse_influence). The controller calls
 * its functions through a table of pointers, so that a program with a full influence matrix does
 * not link them.
 */
#ifndef PZS_LIB_SPARSE_INFLUENCE_H
#define PZS_LIB_SPARSE_INFLUENCE_H

#include "pzs_control.h"

/*
 * Number of arrays of a sparse influence matrix; they enter the checksum of the controller's
 * tables.
 */
#define SPARSE_PARTS 3u

struct pzs_sparse_calls {
    /*
     * List the arrays of a sparse influence matrix that the checksum of the controller's tables
     * covers: starts of the rows, columns and values of the entries. No array is listed if one is
     * missing or too large to be read.
     */
    void (*list_parts)(const pzs_problem *problem, pzs_table_part part[SPARSE_PARTS]);
    /*
     * Check a sparse influence matrix: the controller's tables must contain the Hessian, and the
     * columns of the entries of each row must be ascending and below the number of inputs. Returns
     * PZS_OK, or PZS_E_ARGUMENT with the index of the wrong row in *where, or with -1 if an array
     * is missing.
     */
    pzs_status (*check)(const pzs_problem *problem, int32_t *where);
    /* Compute product [outputs] = sparse influence matrix times voltages [inputs]. */
    void (*multiply)(const pzs_problem *problem, pzs_real *product, const pzs_real *voltage);
    /* Compute product [inputs] = transposed sparse influence matrix times a vector [outputs]. */
    void (*project)(const pzs_problem *problem, pzs_real *product, const pzs_real *vector);
};

#endif
