/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Internals of the linear model that the electrodes and the nonlinear solver use: assembly,
 * gathering and solving over the free dof of a structure. In all functions `node` lists `count`
 * nodes, and P selects the dof of these nodes, node after node.
 */
#ifndef PZS_LIB_MODEL_H
#define PZS_LIB_MODEL_H

#include "pzs_model.h"

/*
 * Stages of a model. READY: laid out; ASSEMBLED, FACTORED: stiffness of the undeformed state;
 * AT_SHAPE: the factor is that of a tangent at a deformed shape.
 */
enum { STAGE_READY = 1, STAGE_ASSEMBLED = 2, STAGE_FACTORED = 3, STAGE_AT_SHAPE = 4 };

/* Checksum of the counts and arrays of a structure, as stored in its crc field. */
uint32_t pzs_structure_crc(const pzs_structure *structure);

/* Whether the rows of inputs and outputs have no more entries than they can have. */
bool pzs_structure_rows_fit(const pzs_structure *structure);

/* Stiffness factor of the type of an element; 1 if no factors were passed to the assembly. */
pzs_real pzs_model_type_factor(const pzs_model *model, uint32_t element);

/*
 * K += factor P' A P.
 *   entry [packed lower triangle of count dof_per_node rows] in A
 */
void pzs_model_add_matrix(pzs_model *model, const uint16_t *node, unsigned count, pzs_real factor,
                          const pzs_real *entry);

/* gathered [count dof_per_node] = P p, zero at constrained dof.  vector [free_dof] in */
void pzs_model_gather(const pzs_model *model, const uint16_t *node, unsigned count,
                      const pzs_real *vector, pzs_real *gathered);

/* f += factor P' u, except at constrained dof.  vector [free_dof] in/out */
void pzs_model_scatter(const pzs_model *model, const uint16_t *node, unsigned count,
                       pzs_real factor, const pzs_real *gathered, pzs_real *vector);

/* z = S (L D L')^-1 S r: apply the factor as inverse of the unscaled matrix. z may be r. */
void pzs_model_backsolve(const pzs_model *model, const pzs_real *force, pzs_real *displacement);

/* Squared norm of a force force [free_dof] in scaled rows, which all have the same weight. */
pzs_real pzs_model_scaled_norm2(const pzs_model *model, const pzs_real *force);

/* force [free_dof] += value times the force of input j, except at constrained dof */
void pzs_model_add_input(const pzs_model *model, uint32_t j, pzs_real value, pzs_real *force);

/* Output number `row` of a displacement displacement [free_dof]. */
pzs_real pzs_model_observe_row(const pzs_structure *structure, const pzs_real *displacement,
                               uint32_t row);

#endif
