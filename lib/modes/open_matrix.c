/* SPDX-License-Identifier: BSD-2-Clause */
/* Matrices of the electrodes that are open while a structure vibrates (open_matrix.h). */
#include "open_matrix.h"
#include "../core/guard.h"
#include "../model/electrode.h"

#if PZS_MODES

static bool is_open_at(const pzs_electrodes *tables, const uint8_t *is_open, uint32_t electrode)
{
    return (is_open ? is_open[electrode] : tables->open[electrode]) != 0;
}

uint16_t pzs_open_matrix_count(const pzs_electrodes *tables, const uint8_t *is_open)
{
    uint16_t count = 0;
    for (uint32_t k = 0; k < tables->count; k++)
        count = (uint16_t)(count + is_open_at(tables, is_open, k));
    return count;
}

void pzs_open_matrix_begin(pzs_modes_electrodes *open, const pzs_electrodes *tables,
                           const uint8_t *is_open, void *work)
{
    const uint16_t count = pzs_open_matrix_count(tables, is_open);
    open->tables = tables;
    open->count = 0;
    if (count == 0)
        return;
    open->work = work;
    open->voltage = open->work + count;
    pzs_real *held = open->voltage + count, *moving = held + PZS_DENSE(count);
    uint32_t *index = (uint32_t *)(void *)(moving + PZS_DENSE(count));
    /* Both matrices have the same rows, whose index they share. */
    pzs_linalg_dense_layout(&open->held, count, held, index);
    pzs_linalg_dense_layout(&open->moving, count, moving, index);
    open->electrode = (uint16_t *)(void *)(index + count / PZS_TILE + 2u) + count;
    for (uint32_t k = 0; k < tables->count; k++) {
        if (!is_open_at(tables, is_open, k))
            continue;
        open->electrode[open->count] = (uint16_t)k;
        open->count++;
    }
}

uint16_t pzs_open_matrix_input(const pzs_modes_electrodes *open, uint32_t i)
{
    return open->tables->input[open->electrode[i]];
}

/* Return the first open electrode with a charge in the tables that is NaN or infinite, or -1. */
static int32_t nonfinite_electrode(const pzs_modes_electrodes *open)
{
    const pzs_rows *direct = &open->tables->direct;
    for (uint32_t i = 0; i < open->count; i++) {
        const uint32_t k = open->electrode[i], first = direct->start[k];
        if (pzs_guard_nonfinite(direct->value + first, direct->start[k + 1] - first) >= 0)
            return (int32_t)k;
    }
    return -1;
}

pzs_status pzs_open_matrix_hold(pzs_modes_electrodes *open, int32_t *where)
{
    *where = nonfinite_electrode(open);
    if (*where >= 0)
        return PZS_E_NONFINITE;
    pzs_linalg_clear(&open->held);
    for (uint32_t i = 0; i < open->count; i++)
        for (uint32_t j = 0; j <= i; j++)
            pzs_open_matrix_set(open, &open->held, i, j, 0);
    const linalg_inertia inertia = pzs_linalg_factor(&open->held);
    const int32_t bad = inertia.zero >= 0 ? inertia.zero : inertia.first_negative;
    *where = bad < 0 ? -1 : open->electrode[bad];
    return bad < 0 ? PZS_OK : PZS_E_CAPACITANCE;
}

void pzs_open_matrix_set(const pzs_modes_electrodes *open, pzs_envelope *matrix, uint32_t i,
                         uint32_t j, pzs_real work)
{
    *pzs_linalg_entry(matrix, i, j) =
        pzs_electrode_direct(open->tables, open->electrode[i], pzs_open_matrix_input(open, j)) +
        work;
}

void pzs_open_matrix_factor(pzs_envelope *matrix, linalg_inertia *inertia)
{
    const linalg_inertia own = pzs_linalg_factor(matrix);
    if (own.zero >= 0)
        inertia->zero = 0;
    inertia->negative -= own.negative < inertia->negative ? own.negative : inertia->negative;
}

pzs_real pzs_open_matrix_follow(const pzs_modes_electrodes *open)
{
    pzs_real sum = 0;
    for (uint32_t i = 0; i < open->count; i++)
        open->voltage[i] = -open->work[i];
    pzs_linalg_solve(&open->held, open->voltage);
    for (uint32_t i = 0; i < open->count; i++)
        sum -= open->voltage[i] * open->work[i];
    return sum;
}

void pzs_open_matrix_respond(const pzs_modes_electrodes *open, pzs_real *row)
{
    const pzs_rows *direct = &open->tables->direct;
    for (uint32_t i = 0; i < open->count; i++)
        open->work[i] = row[pzs_open_matrix_input(open, i)];
    pzs_open_matrix_follow(open);
    for (uint32_t i = 0; i < open->count; i++) {
        const uint32_t k = open->electrode[i];
        for (uint32_t entry = direct->start[k]; entry < direct->start[k + 1]; entry++)
            row[direct->dof[entry]] += open->voltage[i] * direct->value[entry];
    }
    for (uint32_t i = 0; i < open->count; i++)
        row[pzs_open_matrix_input(open, i)] = -open->voltage[i];
}

#endif
