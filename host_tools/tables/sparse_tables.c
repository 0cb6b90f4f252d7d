/* SPDX-License-Identifier: BSD-2-Clause */
/* Influence matrix in the tables as sparse rows (sparse_tables.h). */
#include "sparse_tables.h"
#include <math.h>
#include <stdlib.h>

static bool is_stored(double entry)
{
    return fabs(entry) > 0;
}

sparse_facts sparse_tables_count(const design *design, bool are_entries_read)
{
    sparse_facts facts = {.all = (size_t)design->targets * (size_t)design->amplifiers,
                          .are_entries_read = are_entries_read};
    if (!design->measured.given || !design->influence)
        return facts;
    for (size_t k = 0; k < facts.all; k++)
        facts.entries += is_stored(design->influence[k]);
    facts.full_reals = facts.all;
    facts.reals = facts.entries;
    facts.bytes =
        facts.entries * sizeof(uint16_t) + ((size_t)design->targets + 1) * sizeof(uint32_t);
    facts.is_used =
        !are_entries_read && design->problem.hessian && facts.entries * SPARSE_PAYS <= facts.all;
    return facts;
}

int sparse_tables_make(pzs_sparse_influence *sparse, const design *design)
{
    const size_t inputs = (size_t)design->amplifiers, outputs = (size_t)design->targets;
    const size_t entries = sparse_tables_count(design, false).entries;
    uint32_t *start = calloc(outputs + 1, sizeof *start);
    uint16_t *dof = calloc(entries + 1, sizeof *dof);
    double *value = calloc(entries + 1, sizeof *value);
    uint32_t at = 0;
    *sparse =
        (pzs_sparse_influence){&pzs_sparse_influence_calls, {(uint16_t)outputs, start, dof, value}};
    if (!start || !dof || !value)
        return -1;
    for (size_t i = 0; i < outputs; i++) {
        for (size_t k = 0; k < inputs; k++) {
            const double entry = design->influence[i * inputs + k];
            if (!is_stored(entry))
                continue;
            dof[at] = (uint16_t)k;
            value[at++] = entry;
        }
        start[i + 1] = at;
    }
    return 0;
}

void sparse_tables_free(pzs_sparse_influence *sparse)
{
    design_release(sparse->rows.start);
    design_release(sparse->rows.dof);
    design_release(sparse->rows.value);
    *sparse = (pzs_sparse_influence){0};
}
