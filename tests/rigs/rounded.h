/*
 * Tables of a bridge, rounded to the precision of the test program. Include it after cmocka.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef ROUNDED_H
#define ROUNDED_H

#include "pzs.h"
#include <stdlib.h>
#include "bridge.h"
#include "../../lib/core/guard.h"
#include "../../lib/model/model.h"

static inline pzs_real *rounded(const double *x, size_t n)
{
    pzs_real *y = calloc(n + 1, sizeof *y);
    assert_non_null(y);
    for (size_t i = 0; i < n; i++)
        y[i] = (pzs_real)x[i];
    return y;
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
    ROUNDED_ARRAYS
};

static inline void round_structure(const bridge *b, pzs_structure *structure,
                                   pzs_real *owned[ROUNDED_ARRAYS])
{
    const size_t corners = 4 * (size_t)b->unknowns;
    assert_int_equal(b->kind_reals * sizeof(pzs_real), sizeof(pzs_element_type));
    owned[ROUNDED_STIFFNESS] =
        rounded(b->stiffness, (size_t)b->kinds * corners * (corners + 1) / 2);
    owned[ROUNDED_KIND] = rounded(b->kind, (size_t)b->kinds * b->kind_reals);
    structure->format = PZS_TABLE_FORMAT;
    structure->nodes = (uint16_t)b->nodes;
    structure->elements = (uint16_t)b->elements;
    structure->types = (uint16_t)b->kinds;
    structure->dof_per_node = (uint16_t)b->unknowns;
    structure->free_dof = (uint16_t)b->dof;
    structure->element = (const uint16_t(*)[4])(const void *)b->element;
    structure->element_type = b->element_kind;
    structure->node_dof = b->node_dof;
    structure->first_column = b->first;
    structure->stiffness = owned[ROUNDED_STIFFNESS];
    structure->type = (const pzs_element_type *)(const void *)owned[ROUNDED_KIND];
    owned[ROUNDED_INPUT] = round_rows(&b->input, &structure->input);
    owned[ROUNDED_OUTPUT] = round_rows(&b->output, &structure->output);
    owned[ROUNDED_SPRING] = round_rows(&b->spring, &structure->spring);
    owned[ROUNDED_SPRING_STIFFNESS] = rounded(b->spring_stiffness, (size_t)b->spring.count);
    structure->spring_stiffness = owned[ROUNDED_SPRING_STIFFNESS];
    structure->crc = pzs_structure_crc(structure);
}

#endif
