/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Internals of the linear model that the electrodes and the nonlinear solver share: assembly,
 * gathering and solving over the free degrees of freedom of a structure. In all functions `node` is
 * a list of `count` node numbers, and the degrees of freedom of these nodes are ordered node by
 * node.
 */
#ifndef PZS_LIB_MODEL_H
#define PZS_LIB_MODEL_H

#include "pzs_model.h"

/*
 * Stages of a linear model. STAGE_READY: initialised. STAGE_ASSEMBLED, STAGE_FACTORED: its matrix
 * holds the stiffness of the undeformed state, or the factors of this stiffness. STAGE_AT_SHAPE:
 * its matrix holds the factors of the tangent stiffness at a deformed shape.
 */
enum { STAGE_READY = 1, STAGE_ASSEMBLED = 2, STAGE_FACTORED = 3, STAGE_AT_SHAPE = 4 };

/*
 * Return the checksum of the counts and arrays in the tables of a structure, as stored in their
 * member crc.
 */
uint32_t pzs_structure_crc(const pzs_structure *structure);

/*
 * Return whether the sparse rows in the tables of a structure (such as outputs and force vectors)
 * have no more entries than their sizes allow.
 */
bool pzs_structure_rows_fit(const pzs_structure *structure);

/*
 * Return the factor by which the stiffness of an element is multiplied: that of its element type in
 * the array that was passed to pzs_assemble, or 1 where no factors were passed.
 */
pzs_real pzs_model_type_factor(const pzs_model *model, uint32_t element);

/*
 * Return the rotation matrix of a node at an oblique support, or NULL for a node whose degrees of
 * freedom act along its triad (local axes). Each row of the matrix is the axis of one displacement
 * of the node, in components along the triad.
 */
const pzs_real (*pzs_model_turn(const pzs_structure *structure, uint16_t node))[3];

/*
 * Add a symmetric matrix, whose rows are the degrees of freedom of `count` nodes, times a factor,
 * to the stiffness matrix of the model.
 *   entry [SHELL_PACKED(count dof_per_node)] in  packed lower triangle of the symmetric matrix
 */
void pzs_model_add_matrix(pzs_model *model, const uint16_t *node, unsigned count, pzs_real factor,
                          const pzs_real *entry);

/*
 * Gather the entries of a vector over the free degrees of freedom that belong to some nodes.
 *   vector   [free_dof]           in   vector over the free degrees of freedom
 *   gathered [count dof_per_node] out  its entries; zero at constrained degrees of freedom
 */
void pzs_model_gather(const pzs_model *model, const uint16_t *node, unsigned count,
                      const pzs_real *vector, pzs_real *gathered);

/*
 * Add a vector over the degrees of freedom of some nodes, times a factor, to a vector over the free
 * degrees of freedom of the structure. Entries at constrained degrees of freedom are dropped.
 *   gathered [count dof_per_node] in      entries to add, node by node
 *   vector   [free_dof]           in/out  sum
 */
void pzs_model_scatter(const pzs_model *model, const uint16_t *node, unsigned count,
                       pzs_real factor, const pzs_real *gathered, pzs_real *vector);

/*
 * Compute the displacement under a force by the factors of the scaled stiffness matrix. Both arrays
 * have [free_dof] entries and may be the same.
 */
void pzs_model_backsolve(const pzs_model *model, const pzs_real *force, pzs_real *displacement);

/*
 * A symmetric positive semidefinite matrix that the factors of the model contain in addition to the
 * stiffness matrix, such as a multiple of the mass matrix.
 *   add_term_product  add the product of this matrix with a vector to a force, both [free_dof]
 */
typedef struct pzs_model_term {
    void (*add_term_product)(const struct pzs_model_term *term, const pzs_real *vector,
                             pzs_real *force);
} pzs_model_term;

/*
 * Solve for the displacement under the force in the first vector of the work array of the model. If
 * the structure has element types, the solution is refined by iterations with residuals that are
 * computed from the strains of the elements, and with state.term.
 *   displacement [free_dof] out  solution; may be the sixth vector of the work array
 * Returns PZS_OK, or PZS_E_RESIDUAL: the displacement is the best that was reached.
 */
pzs_status pzs_model_solve_force(pzs_model *model, pzs_real *displacement);

/*
 * Return the squared norm of a force [free_dof] whose entries are multiplied by the scale factors
 * of the rows of the stiffness matrix, so that all rows have the same weight.
 */
pzs_real pzs_model_scaled_norm2(const pzs_model *model, const pzs_real *force);

/*
 * Add `value` times the force vector of input number j to a force [free_dof], except at constrained
 * degrees of freedom.
 */
void pzs_model_add_input(const pzs_model *model, uint32_t j, pzs_real value, pzs_real *force);

/*
 * Return the value of the output with index `row` (such as the displacement of a point) under a
 * displacement [free_dof].
 */
pzs_real pzs_model_observe_row(const pzs_structure *structure, const pzs_real *displacement,
                               uint32_t row);

#endif
