/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Access to the element types of a structure. Their tables hold all data (pzs_element_type) or, to
 * save flash, leave out the members s, t, g_mean and g_diff (pzs_compact_type), which the library
 * then computes from the nodes.
 */
#ifndef PZS_LIB_COMPACT_H
#define PZS_LIB_COMPACT_H

#include "pzs_model.h"

/*
 * Compute the data of an element for one corner and one direction (surface coordinate theta1 or
 * theta2) from the nodes at this corner and at its neighbour in this direction. Derivatives are
 * differences of both nodes, divided by their distance.
 *   inverse_length  in   1 / distance of the nodes (1/m); negative if the surface coordinate is
 *                        smaller at the neighbour
 *   middle          in   height of the middle of the shell above the nodes (m)
 *   s, t            out  derivative of the displacement with respect to the displacements of the
 *                        corner and of the neighbour (1/m)
 *   g_mean          out  base vector in this direction, mean of both faces of the shell
 *                        (dimensionless)
 *   g_diff          out  base vector of the outer face minus that of the inner face, divided by the
 *                        thickness (1/m)
 */
void pzs_corner_tables(const pzs_node *corner, const pzs_node *neighbour, pzs_real inverse_length,
                       pzs_real middle, pzs_real s[3][3], pzs_real t[3][3], pzs_real g_mean[3],
                       pzs_real g_diff[3]);

/*
 * Compute an element type with all its data (pzs_element_type) from tables that leave out what
 * follows from the nodes (pzs_compact_type).
 *   node [nodes] in   nodes of the structure
 */
void pzs_rebuild_type(const pzs_compact_type *compact, const pzs_node *node,
                      pzs_element_type *type);

/*
 * Return true if the tables of a structure contain its element types, in the full form
 * (pzs_element_type) or in the short form (pzs_compact_type); false if they contain none.
 */
bool pzs_structure_has_types(const pzs_structure *structure);

/* Return the thickness of the shell (m), which all element types of a structure share. */
pzs_real pzs_structure_thickness(const pzs_structure *structure);

/*
 * Return the element type of an element of a structure whose tables contain its element types. If
 * the tables leave out what follows from the nodes (pzs_compact_type), the type is computed into
 * the workspace of the model, and the next call replaces it.
 */
const pzs_element_type *pzs_model_element_type(const pzs_model *model, uint32_t element);

#endif
