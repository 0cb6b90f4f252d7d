/* SPDX-License-Identifier: BSD-2-Clause */
/* Mass tables of a structure (element_mass.h). */
#include "element_mass.h"
#include <string.h>
#include "../core/guard.h"
#include "../model/model.h"
#include "../model/shell.h"

#if PZS_MODES

/* Number of entries of an element mass matrix, a packed lower triangle. */
static size_t packed_entries(const pzs_structure *structure)
{
    return SHELL_PACKED(SHELL_NODES * (size_t)structure->dof_per_node);
}

static const pzs_real *element_matrix(const pzs_mass *mass, const pzs_structure *structure,
                                      uint32_t element)
{
    return mass->matrix + mass->element_type[element] * packed_entries(structure);
}

/* ---- tables ------------------------------------------------------------- */

static bool is_complete(const pzs_mass *mass, const pzs_structure *structure)
{
    return mass->types > 0 && mass->types <= structure->elements && mass->element_type &&
           mass->matrix;
}

/* Return the checksum of mass tables, as stored in their member crc. */
static uint32_t table_crc(const pzs_mass *mass, const pzs_structure *structure)
{
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, &mass->types, sizeof mass->types);
    crc = pzs_guard_array_crc(crc, mass->element_type, structure->elements,
                              sizeof *mass->element_type);
    return ~pzs_guard_array_crc(crc, mass->matrix, mass->types * packed_entries(structure),
                                sizeof *mass->matrix);
}

pzs_status pzs_mass_seal(pzs_mass *mass, const pzs_structure *structure)
{
    if (!mass || !structure || !is_complete(mass, structure))
        return PZS_E_ARGUMENT;
    mass->format = PZS_TABLE_FORMAT;
    mass->scene = structure->scene;
    mass->crc = table_crc(mass, structure);
    return PZS_OK;
}

/* Return the first type of mass whose matrix contains NaN or infinity, or -1. */
static int32_t nonfinite_type(const pzs_mass *mass, const pzs_structure *structure)
{
    const size_t entries = packed_entries(structure);
    for (uint16_t type = 0; type < mass->types; type++)
        if (pzs_guard_nonfinite(mass->matrix + type * entries, (uint32_t)entries) >= 0)
            return type;
    return -1;
}

pzs_status pzs_mass_check(const pzs_mass *mass, const pzs_structure *structure, int32_t *where)
{
    *where = -1;
    if (mass->format != PZS_TABLE_FORMAT || mass->scene != structure->scene)
        return PZS_E_FORMAT;
    if (!is_complete(mass, structure))
        return PZS_E_ARGUMENT;
    if (table_crc(mass, structure) != mass->crc)
        return PZS_E_CRC;
    for (uint32_t element = 0; element < structure->elements; element++)
        if (mass->element_type[element] >= mass->types) {
            *where = (int32_t)element;
            return PZS_E_ARGUMENT;
        }
    *where = nonfinite_type(mass, structure);
    return *where < 0 ? PZS_OK : PZS_E_NONFINITE;
}

/* ---- products ----------------------------------------------------------- */

/* The innermost loops run over the entries of the product: no addition waits for the one before. */
void pzs_packed_multiply(const pzs_real *entry, uint32_t count, const pzs_real *vector,
                         pzs_real *product)
{
    memset(product, 0, count * sizeof *product);
    for (uint32_t column = 0; column < count; column++) {
        for (uint32_t i = 0; i < column; i++)
            product[i] += entry[i] * vector[column];
        entry += column;
        const pzs_real *below = entry;
        for (uint32_t i = column; i < count; i++) {
            product[i] += *below * vector[column];
            below += i + 1;
        }
        entry++;
    }
}

void pzs_mass_add_product(const pzs_mass *mass, const pzs_model *model, pzs_real factor,
                          const pzs_real *vector, pzs_real *product)
{
    const pzs_structure *structure = model->state.structure;
    for (uint32_t element = 0; element < structure->elements; element++) {
        pzs_real local[SHELL_MAX], force[SHELL_MAX];
        pzs_model_gather(model, structure->element[element], SHELL_NODES, vector, local);
        pzs_packed_multiply(element_matrix(mass, structure, element),
                            SHELL_NODES * (uint32_t)structure->dof_per_node, local, force);
        pzs_model_scatter(model, structure->element[element], SHELL_NODES, factor, force, product);
    }
}

void pzs_mass_add(const pzs_mass *mass, pzs_model *model, pzs_real factor)
{
    const pzs_structure *structure = model->state.structure;
    for (uint32_t element = 0; element < structure->elements; element++)
        pzs_model_add_matrix(model, structure->element[element], SHELL_NODES, factor,
                             element_matrix(mass, structure, element));
}

void pzs_mass_diagonal(const pzs_mass *mass, const pzs_structure *structure, pzs_real *diagonal)
{
    const uint32_t dof_per_node = structure->dof_per_node;
    memset(diagonal, 0, structure->free_dof * sizeof *diagonal);
    for (uint32_t element = 0; element < structure->elements; element++) {
        const pzs_real *entry = element_matrix(mass, structure, element);
        for (uint32_t i = 0; i < SHELL_NODES * dof_per_node; i++) {
            const uint32_t node = structure->element[element][i / dof_per_node];
            const uint16_t dof = structure->node_dof[node * dof_per_node + i % dof_per_node];
            if (dof != PZS_CONSTRAINED)
                diagonal[dof] += entry[SHELL_PACKED(i) + i];
        }
    }
}

#endif
