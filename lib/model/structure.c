/* Checksum of a structure (model.h). */
#include "model.h"
#include "../core/guard.h"

uint32_t pzs_structure_crc(const pzs_structure *s)
{
    const size_t corners = 4u * (size_t)s->dof_per_node;
    const uint16_t counts[5] = {s->nodes, s->elements, s->types, s->dof_per_node, s->free_dof};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    crc = pzs_guard_array_crc(crc, s->element, s->elements, sizeof s->element[0]);
    crc = pzs_guard_array_crc(crc, s->element_type, s->elements, sizeof s->element_type[0]);
    crc = pzs_guard_array_crc(crc, s->node_dof, (size_t)s->nodes * s->dof_per_node,
                              sizeof s->node_dof[0]);
    crc = pzs_guard_array_crc(crc, s->first_column, s->free_dof, sizeof s->first_column[0]);
    crc = pzs_guard_array_crc(crc, s->stiffness, s->types * (corners * (corners + 1u) / 2u),
                              sizeof s->stiffness[0]);
    crc = pzs_guard_array_crc(crc, s->type, s->types, sizeof s->type[0]);
    crc = pzs_guard_rows_crc(crc, &s->input, s->free_dof);
    return ~pzs_guard_rows_crc(crc, &s->output, s->free_dof);
}

pzs_status pzs_structure_seal(pzs_structure *structure)
{
    if (structure == NULL || structure->nodes == 0 || structure->elements == 0 ||
        structure->types == 0)
        return PZS_E_ARGUMENT;
    structure->format = PZS_TABLE_FORMAT;
    structure->crc = pzs_structure_crc(structure);
    return PZS_OK;
}
