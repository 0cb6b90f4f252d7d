/*
 * What the linear model lends to the nonlinear path: assembly, gathering and solving over the
 * free unknowns of a structure. `node` lists `count` nodes, whose unknowns stand one after the
 * other.
 */
#ifndef PZS_LIB_MODEL_H
#define PZS_LIB_MODEL_H

#include "pzs_model.h"

/* READY: laid out; ASSEMBLED, FACTORED: stiffness at rest; AT_SHAPE: the factor is that of a
 * tangent. */
enum { STAGE_READY = 1, STAGE_ASSEMBLED = 2, STAGE_FACTORED = 3, STAGE_AT_SHAPE = 4 };

/* Checksum of the counts and arrays of a structure, as stored in its crc field. */
uint32_t pzs_structure_crc(const pzs_structure *structure);

/* Stiffness factor of an element's kind, 1 if none was given. */
pzs_real pzs_model_type_factor(const pzs_model *model, uint32_t element);

/* K += factor P' A P.  entry [packed lower triangle of count * unknowns] in A */
void pzs_model_add_matrix(pzs_model *model, const uint16_t *node, unsigned count, pzs_real factor,
                          const pzs_real *entry);

/* u [count unknowns] = P p, zero where fixed or held.  p [dof] in */
void pzs_model_gather(const pzs_model *model, const uint16_t *node, unsigned count,
                      const pzs_real *p, pzs_real *u);

/* f += factor P' u.  f [dof] in/out */
void pzs_model_scatter(const pzs_model *model, const uint16_t *node, unsigned count,
                       pzs_real factor, const pzs_real *u, pzs_real *f);

/* z = S (L D L')^-1 S r: the factor as inverse of the unscaled matrix, exact or as a
 * preconditioner. z may be r. */
void pzs_model_backsolve(const pzs_model *model, const pzs_real *r, pzs_real *z);

/* Square of the norm of a force in the scaled unknowns, where every row weighs alike. */
pzs_real pzs_model_scaled_norm2(const pzs_model *model, const pzs_real *r);

/* f += amount times the force of input j, nothing where held */
void pzs_model_add_input(const pzs_model *model, uint32_t j, pzs_real amount, pzs_real *f);

/* One output of a displacement. */
pzs_real pzs_model_observe_row(const pzs_structure *structure, const pzs_real *u, uint32_t row);

#endif
