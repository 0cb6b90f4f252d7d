/*
 * Tables of a bridge, rounded to the precision of the test program. Include it after cmocka.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef ROUNDED_H
#define ROUNDED_H

#include "pzs.h"
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include "bridge.h"
#include "../../lib/core/guard.h"
#include "../../lib/model/model.h"

static inline pzs_real *rounded(const double *from, size_t count)
{
    pzs_real *to = calloc(count + 1, sizeof *to);
    assert_non_null(to);
    for (size_t i = 0; i < count; i++)
        to[i] = (pzs_real)from[i];
    return to;
}

static inline pzs_real *round_rows(const bridge_rows *from, pzs_rows *to)
{
    pzs_real *value = rounded(from->value, from->count ? from->start[from->count] : 0);
    to->count = (uint16_t)from->count;
    to->start = from->start;
    to->dof = from->dof;
    to->value = value;
    return value;
}

/* Arrays of rounded reals of a structure, which the test has to free. */
enum {
    ROUNDED_STIFFNESS,
    ROUNDED_KIND,
    ROUNDED_INPUT,
    ROUNDED_OUTPUT,
    ROUNDED_SPRING,
    ROUNDED_SPRING_STIFFNESS,
    ROUNDED_TURN,
    ROUNDED_ARRAYS
};

static inline void round_structure(const bridge *tables, pzs_structure *structure,
                                   pzs_real *owned[ROUNDED_ARRAYS])
{
    const size_t corners = 4 * (size_t)tables->dof_per_node;
    assert_int_equal(tables->type_reals * sizeof(pzs_real), sizeof(pzs_element_type));
    owned[ROUNDED_STIFFNESS] =
        rounded(tables->stiffness, (size_t)tables->types * corners * (corners + 1) / 2);
    owned[ROUNDED_KIND] = rounded(tables->type_values, (size_t)tables->types * tables->type_reals);
    structure->format = PZS_TABLE_FORMAT;
    structure->nodes = (uint16_t)tables->nodes;
    structure->elements = (uint16_t)tables->elements;
    structure->types = (uint16_t)tables->types;
    structure->dof_per_node = (uint16_t)tables->dof_per_node;
    structure->free_dof = (uint16_t)tables->dof;
    structure->element = (const uint16_t(*)[4])(const void *)tables->element;
    structure->element_type = tables->element_type;
    structure->node_dof = tables->node_dof;
    structure->first_column = tables->first_column;
    structure->stiffness = owned[ROUNDED_STIFFNESS];
    structure->type = (const pzs_element_type *)(const void *)owned[ROUNDED_KIND];
    owned[ROUNDED_INPUT] = round_rows(&tables->input, &structure->input);
    owned[ROUNDED_OUTPUT] = round_rows(&tables->output, &structure->output);
    owned[ROUNDED_SPRING] = round_rows(&tables->spring, &structure->spring);
    owned[ROUNDED_SPRING_STIFFNESS] =
        rounded(tables->spring_stiffness, (size_t)tables->spring.count);
    structure->spring_stiffness = owned[ROUNDED_SPRING_STIFFNESS];
    owned[ROUNDED_TURN] = rounded(tables->turn, 9 * (size_t)tables->turns);
    structure->turns = (uint16_t)tables->turns;
    structure->node_turn = tables->node_turn;
    structure->turn = (const pzs_real(*)[3][3])(const void *)owned[ROUNDED_TURN];
    structure->crc = pzs_structure_crc(structure);
}

/*
 * Compact element types and nodes of a bridge whose mesh has them, in the precision of the test. A
 * structure with compact types needs PZS_COMPACT_BYTES more of workspace.
 */
typedef struct rounded_compact {
    pzs_compact_type *type;
    pzs_node *node;
} rounded_compact;

static inline void round_compact(const bridge *tables, rounded_compact *compact)
{
    const size_t types = (size_t)tables->compact_types, nodes = (size_t)tables->nodes;
    assert_int_equal(BRIDGE_COMPACT * sizeof(pzs_real), offsetof(pzs_compact_type, corner));
    compact->type = calloc(types + 1, sizeof *compact->type);
    compact->node = calloc(nodes + 1, sizeof *compact->node);
    assert_non_null(compact->type);
    assert_non_null(compact->node);
    for (size_t k = 0; k < types; k++) {
        pzs_real *value = rounded(tables->compact_value + k * BRIDGE_COMPACT, BRIDGE_COMPACT);
        memcpy(&compact->type[k], value, BRIDGE_COMPACT * sizeof *value);
        memcpy(compact->type[k].corner, tables->compact_corner + 4 * k,
               sizeof compact->type[k].corner);
        free(value);
    }
    pzs_real *value = rounded(tables->node_value, 12 * nodes);
    memcpy(compact->node, value, nodes * sizeof *compact->node);
    free(value);
}

static inline void free_compact(rounded_compact *compact)
{
    free(compact->type);
    free(compact->node);
}

#endif
