/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksum of the tables of a structure (pzs_structure_crc and pzs_structure_seal). */
#include "model.h"
#include "../core/guard.h"

uint32_t pzs_structure_crc(const pzs_structure *structure)
{
    const size_t corners = 4u * (size_t)structure->dof_per_node;
    const uint16_t counts[5] = {structure->nodes, structure->elements, structure->types,
                                structure->dof_per_node, structure->free_dof};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    crc = pzs_guard_array_crc(crc, structure->element, structure->elements,
                              sizeof structure->element[0]);
    crc = pzs_guard_array_crc(crc, structure->element_type, structure->elements,
                              sizeof structure->element_type[0]);
    crc = pzs_guard_array_crc(crc, structure->node_dof,
                              (size_t)structure->nodes * structure->dof_per_node,
                              sizeof structure->node_dof[0]);
    crc = pzs_guard_array_crc(crc, structure->first_column, structure->free_dof,
                              sizeof structure->first_column[0]);
    crc = pzs_guard_array_crc(crc, structure->stiffness,
                              structure->types * (corners * (corners + 1u) / 2u),
                              sizeof structure->stiffness[0]);
    crc = pzs_guard_array_crc(crc, structure->type, structure->types, sizeof structure->type[0]);
    crc = pzs_guard_array_crc(crc, structure->compact, structure->types,
                              sizeof structure->compact[0]);
    crc = pzs_guard_array_crc(crc, structure->node, structure->nodes, sizeof structure->node[0]);
    crc = pzs_guard_rows_crc(crc, &structure->input, structure->free_dof);
    crc = pzs_guard_rows_crc(crc, &structure->output, structure->free_dof);
    crc = pzs_guard_rows_crc(crc, &structure->spring, structure->free_dof);
    crc = pzs_guard_array_crc(crc, structure->spring_stiffness, structure->spring.count,
                              sizeof *structure->spring_stiffness);
    crc =
        pzs_guard_array_crc(crc, structure->node_turn, structure->turns > 0 ? structure->nodes : 0,
                            sizeof *structure->node_turn);
    return ~pzs_guard_array_crc(crc, structure->turn, structure->turns, sizeof *structure->turn);
}

bool pzs_structure_rows_fit(const pzs_structure *structure)
{
    return pzs_guard_rows_fit(&structure->input, structure->free_dof) &&
           pzs_guard_rows_fit(&structure->output, structure->free_dof) &&
           pzs_guard_rows_fit(&structure->spring, structure->free_dof);
}

pzs_status pzs_structure_seal(pzs_structure *structure)
{
    if (structure == NULL || structure->nodes == 0 || structure->elements == 0 ||
        structure->types == 0 || !pzs_structure_rows_fit(structure))
        return PZS_E_ARGUMENT;
    structure->format = PZS_TABLE_FORMAT;
    structure->crc = pzs_structure_crc(structure);
    return PZS_OK;
}
