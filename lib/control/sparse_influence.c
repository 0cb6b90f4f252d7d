/* SPDX-License-Identifier: BSD-2-Clause */
/* Sparse influence matrix of the controller's tables (sparse_influence.h). */
#include "sparse_influence.h"
#include "scrub.h"
#include "../core/guard.h"
#include "../core/product.h"

/*
 * Whether the arrays of a sparse influence matrix exist and have a plausible length, so that they
 * may be read.
 */
static bool is_readable(const pzs_problem *problem)
{
    const pzs_rows *rows = &problem->sparse->rows;
    return rows->count == problem->outputs && rows->start != NULL && rows->dof != NULL &&
           rows->value != NULL && pzs_guard_rows_fit(rows, problem->inputs);
}

static void list_parts(const pzs_problem *problem, pzs_table_part part[SPARSE_PARTS])
{
    const pzs_rows *rows = &problem->sparse->rows;
    if (!is_readable(problem))
        return;
    const size_t entries = rows->start[rows->count];
    part[0] = (pzs_table_part){rows->start, (rows->count + 1u) * sizeof *rows->start};
    part[1] = (pzs_table_part){rows->dof, entries * sizeof *rows->dof};
    part[2] = scrub_reals(rows->value, entries);
}

/*
 * Whether the columns of the entries in row i of a sparse influence matrix are ascending and below
 * the number of inputs.
 */
static bool is_row_usable(const pzs_problem *problem, uint32_t i)
{
    const pzs_rows *rows = &problem->sparse->rows;
    const uint32_t end = rows->start[i + 1u];
    uint32_t next = 0;
    if (rows->start[i] > end || end > rows->start[rows->count])
        return false;
    for (uint32_t at = rows->start[i]; at < end; at++) {
        const uint32_t input = rows->dof[at];
        if (input < next || input >= problem->inputs)
            return false;
        next = input + 1u;
    }
    return true;
}

static pzs_status check(const pzs_problem *problem, int32_t *where)
{
    *where = -1;
    if (problem->hessian == NULL || !is_readable(problem) || problem->sparse->rows.start[0] != 0)
        return PZS_E_ARGUMENT;
    for (uint32_t i = 0; i < problem->outputs; i++) {
        if (!is_row_usable(problem, i)) {
            *where = (int32_t)i;
            return PZS_E_ARGUMENT;
        }
    }
    return PZS_OK;
}

static void multiply(const pzs_problem *problem, pzs_real *product, const pzs_real *voltage)
{
    pzs_product_sparse(product, &problem->sparse->rows, voltage, problem->inputs);
}

static void project(const pzs_problem *problem, pzs_real *product, const pzs_real *vector)
{
    pzs_product_sum_sparse(product, &problem->sparse->rows, vector, problem->inputs);
}

const struct pzs_sparse_calls pzs_sparse_influence_calls = {list_parts, check, multiply, project};
