/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Charges and open electrodes in the undeformed state (pzs_model.h). One solve for each electrode
 * gives its charge per unit of every input. The small dense matrix of these charges then gives the
 * voltages of all open electrodes, by a Schur complement, and all charges.
 */
#include "electrode.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "model.h"
#include <string.h>

enum { ELECTRIC_READY = 1, ELECTRIC_FACTORED = 2 };

static pzs_status fail(pzs_electric *electric, pzs_status status, int32_t where)
{
    electric->info.where = where;
    return status;
}

/* ---- tables ----------------------------------------------------------- */

uint32_t pzs_electrode_crc(const pzs_electrodes *tables, uint32_t inputs)
{
    const uint32_t entries = tables->direct.start[tables->count];
    uint32_t crc =
        pzs_guard_crc(GUARD_CRC_START, tables->input, tables->count * sizeof *tables->input);
    crc = pzs_guard_crc(crc, tables->open, tables->count * sizeof *tables->open);
    crc = pzs_guard_crc(crc, tables->direct.start,
                        (tables->count + 1u) * sizeof *tables->direct.start);
    /*
     * More entries than count * inputs are impossible and show damage. The arrays of entries, whose
     * length is then unknown, are left out of the checksum, so that it reads nothing beyond the
     * tables.
     */
    if (entries > (uint32_t)tables->count * inputs)
        return crc;
    crc = pzs_guard_crc(crc, tables->direct.dof, entries * sizeof *tables->direct.dof);
    return ~pzs_guard_crc(crc, tables->direct.value, entries * sizeof *tables->direct.value);
}

static bool indices_in_range(const pzs_electrodes *tables, uint32_t inputs)
{
    for (uint32_t k = 0; k < tables->count; k++)
        if (tables->input[k] >= inputs || (k > 0 && tables->input[k] <= tables->input[k - 1]) ||
            tables->direct.start[k] > tables->direct.start[k + 1])
            return false;
    for (uint32_t i = tables->direct.start[0]; i < tables->direct.start[tables->count]; i++)
        if (tables->direct.dof[i] >= inputs)
            return false;
    return true;
}

pzs_status pzs_electrode_check(const pzs_electrodes *tables, const pzs_structure *structure)
{
    if (!tables || !tables->input || !tables->open || !tables->direct.start ||
        !tables->direct.dof || !tables->direct.value || tables->direct.count != tables->count)
        return PZS_E_ARGUMENT;
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != structure->scene)
        return PZS_E_FORMAT;
    if (!pzs_guard_rows_fit(&tables->direct, structure->input.count) ||
        pzs_electrode_crc(tables, structure->input.count) != tables->crc)
        return PZS_E_CRC;
    return indices_in_range(tables, structure->input.count) ? PZS_OK : PZS_E_ARGUMENT;
}

uint32_t pzs_electrode_open_count(const pzs_electrodes *tables)
{
    uint32_t open = 0;
    for (uint32_t k = 0; k < tables->count; k++)
        open += tables->open[k] != 0;
    return open;
}

uint32_t pzs_electrode_open(const pzs_electrodes *tables, uint32_t open)
{
    uint32_t k = 0;
    for (; k + 1 < tables->count && (!tables->open[k] || open > 0); k++)
        open -= tables->open[k] != 0;
    return k;
}

uint16_t pzs_electrode_open_input(const pzs_electrodes *tables, uint32_t open)
{
    return tables->input[pzs_electrode_open(tables, open)];
}

pzs_real pzs_electrode_direct(const pzs_electrodes *tables, uint32_t electrode, uint32_t input)
{
    pzs_real sum = 0;
    for (uint32_t i = tables->direct.start[electrode]; i < tables->direct.start[electrode + 1]; i++)
        sum += tables->direct.dof[i] == input ? tables->direct.value[i] : 0;
    return sum;
}

pzs_status pzs_electrodes_seal(pzs_electrodes *tables, const pzs_structure *structure)
{
    if (!tables || !structure || !tables->input || !tables->open || !tables->direct.start ||
        tables->direct.count != tables->count ||
        !pzs_guard_rows_fit(&tables->direct, structure->input.count))
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->scene = structure->scene;
    tables->crc = pzs_electrode_crc(tables, structure->input.count);
    return PZS_OK;
}

/* ---- init and factor -------------------------------------------------- */

pzs_status pzs_electric_init(pzs_electric *electric, pzs_model *model, const pzs_electrodes *tables,
                             void *work, size_t bytes)
{
    if (!electric || !model || !work || model->state.stage < STAGE_READY)
        return PZS_E_ARGUMENT;
    memset(electric, 0, sizeof *electric);
    electric->info.where = -1;
    const pzs_status status = pzs_electrode_check(tables, model->state.structure);
    if (status != PZS_OK)
        return status;
    const uint32_t inputs = model->state.structure->input.count,
                   open = pzs_electrode_open_count(tables);
    const int32_t missing =
        guard_missing_bytes(work, bytes, PZS_ELECTRIC_BYTES(tables->count, open, inputs));
    if (missing >= 0)
        return fail(electric, PZS_E_WORKSPACE, missing);
    electric->state.model = model;
    electric->state.tables = tables;
    electric->settings.charge = work;
    electric->state.value = electric->settings.charge + tables->count;
    electric->state.sensitivity = electric->state.value + inputs + 1;
    pzs_real *dense = electric->state.sensitivity + (size_t)tables->count * inputs;
    pzs_linalg_dense_layout(&electric->state.open, open, dense, dense + PZS_DENSE(open));
    memset(electric->settings.charge, 0, tables->count * sizeof *electric->settings.charge);
    electric->state.stage = ELECTRIC_READY;
    return PZS_OK;
}

/*
 * Return the address of an entry in the matrix [electrodes][inputs] of charges: the charge of one
 * electrode per unit of one input (C/V, C/K or C/N).
 */
static pzs_real *sensitivity(const pzs_electric *electric, uint32_t electrode, uint32_t input)
{
    return electric->state.sensitivity +
           (size_t)electrode * electric->state.model->state.structure->input.count + input;
}

/*
 * Compute the charge of electrode k per unit of every input with one solve, because the stiffness
 * matrix K is symmetric:
 *   charge per unit of input j = f_j . u,  u = K^-1 f_k
 *   f_j, f_k  force per unit of input j, force per volt on electrode k
 */
static pzs_status charge_row(const pzs_electric *electric, uint32_t k)
{
    const pzs_rows *input = &electric->state.model->state.structure->input,
                   *direct = &electric->state.tables->direct;
    pzs_real *displacement =
        electric->state.model->state.work + 5 * (size_t)electric->state.model->state.stiffness.n;
    memset(electric->state.value, 0, input->count * sizeof *electric->state.value);
    electric->state.value[electric->state.tables->input[k]] = 1;
    const pzs_status status = pzs_solve(electric->state.model, electric->state.value, displacement);
    for (uint32_t j = 0; j < input->count; j++) {
        *sensitivity(electric, k, j) = 0;
        for (uint32_t entry = input->start[j]; entry < input->start[j + 1]; entry++)
            *sensitivity(electric, k, j) += input->value[entry] * displacement[input->dof[entry]];
    }
    // Add the charge that inputs cause directly, at fixed displacement.
    for (uint32_t i = direct->start[k]; i < direct->start[k + 1]; i++)
        *sensitivity(electric, k, direct->dof[i]) += direct->value[i];
    return status;
}

/*
 * Compute and factor a matrix with a row and a column for each open electrode: the charge of the
 * electrode in the row per volt on the electrode in the column. Returns the index of the first
 * electrode without capacitance, or -1.
 */
static int32_t factor_open(pzs_electric *electric)
{
    pzs_linalg_clear(&electric->state.open);
    for (uint32_t open = 0; open < electric->state.open.n; open++)
        for (uint32_t other = 0; other <= open; other++)
            *pzs_linalg_entry(&electric->state.open, open, other) =
                *sensitivity(electric, pzs_electrode_open(electric->state.tables, open),
                             pzs_electrode_open_input(electric->state.tables, other));
    const linalg_inertia inertia = pzs_linalg_factor(&electric->state.open);
    const int32_t bad = inertia.zero >= 0 ? inertia.zero : inertia.first_negative;
    return bad < 0 ? -1 : (int32_t)pzs_electrode_open(electric->state.tables, (uint32_t)bad);
}

pzs_status pzs_electric_factor(pzs_electric *electric)
{
    if (!electric || !electric->state.model)
        return PZS_E_ARGUMENT;
    if (electric->state.model->state.stage != STAGE_FACTORED)
        return fail(electric, PZS_E_STAGE, -1);
    electric->state.stage = ELECTRIC_READY;
    for (uint32_t k = 0; k < electric->state.tables->count; k++) {
        const pzs_status status = charge_row(electric, k);
        if (status != PZS_OK)
            return fail(electric, status, (int32_t)k);
    }
    const int32_t bad = factor_open(electric);
    if (bad >= 0)
        return fail(electric, PZS_E_NEGATIVE, bad);
    electric->state.stage = ELECTRIC_FACTORED;
    return fail(electric, PZS_OK, -1);
}

/* ---- voltages and charges --------------------------------------------- */

static pzs_real charge_under(const pzs_electric *electric, uint32_t electrode,
                             const pzs_real *value)
{
    pzs_real sum = 0;
    for (uint32_t j = 0; j < electric->state.model->state.structure->input.count; j++)
        sum += *sensitivity(electric, electrode, j) * value[j];
    return sum;
}

static void write_open_voltages(const pzs_electric *electric, const pzs_real *voltage,
                                pzs_real *value)
{
    for (uint32_t open = 0; open < electric->state.open.n; open++)
        value[pzs_electrode_open_input(electric->state.tables, open)] = voltage[open];
}

pzs_status pzs_open_voltages(const pzs_electric *electric, pzs_real *value)
{
    if (!electric || !value)
        return PZS_E_ARGUMENT;
    if (electric->state.stage != ELECTRIC_FACTORED)
        return PZS_E_STAGE;
    pzs_real *voltage = electric->state.value;
    for (uint32_t open = 0; open < electric->state.open.n; open++) {
        voltage[open] = value[pzs_electrode_open_input(electric->state.tables, open)];
        value[pzs_electrode_open_input(electric->state.tables, open)] = 0;
    }
    if (pzs_guard_nonfinite(value, electric->state.model->state.structure->input.count) >= 0) {
        write_open_voltages(electric, voltage, value);
        return PZS_E_NONFINITE;
    }
    for (uint32_t open = 0; open < electric->state.open.n; open++) {
        const uint32_t k = pzs_electrode_open(electric->state.tables, open);
        voltage[open] = electric->settings.charge[k] - charge_under(electric, k, value);
    }
    pzs_linalg_solve(&electric->state.open, voltage);
    write_open_voltages(electric, voltage, value);
    return PZS_OK;
}

pzs_status pzs_charges(const pzs_electric *electric, const pzs_real *value, pzs_real *charge)
{
    if (!electric || !value || !charge)
        return PZS_E_ARGUMENT;
    if (electric->state.stage != ELECTRIC_FACTORED)
        return PZS_E_STAGE;
    for (uint32_t k = 0; k < electric->state.tables->count; k++)
        charge[k] = charge_under(electric, k, value);
    return PZS_OK;
}

/*
 * Convert the influence matrix from voltages of the open electrodes to their charges, which are
 * prescribed.
 */
pzs_status pzs_influence_open(const pzs_electric *electric, pzs_real *influence)
{
    if (!electric || !influence)
        return PZS_E_ARGUMENT;
    if (electric->state.stage != ELECTRIC_FACTORED)
        return PZS_E_STAGE;
    const uint32_t inputs = electric->state.model->state.structure->input.count;
    pzs_real *per_charge = electric->state.value;
    for (uint32_t i = 0; i < electric->state.model->state.structure->output.count; i++) {
        pzs_real *row = influence + (size_t)i * inputs;
        for (uint32_t open = 0; open < electric->state.open.n; open++)
            per_charge[open] = row[pzs_electrode_open_input(electric->state.tables, open)];
        // Convert the entries per volt on the open electrodes to entries per unit of their charge.
        pzs_linalg_solve(&electric->state.open, per_charge);
        // For each other input j, subtract its effect on the charges of the open electrodes: its
        // column is then the effect at constant charges. The charges that input j would cause at
        // constant voltages, times the outputs per unit of charge, are subtracted from its outputs.
        for (uint32_t open = 0; open < electric->state.open.n; open++)
            for (uint32_t j = 0; j < inputs; j++)
                row[j] -=
                    per_charge[open] *
                    *sensitivity(electric, pzs_electrode_open(electric->state.tables, open), j);
        for (uint32_t open = 0; open < electric->state.open.n; open++)
            row[pzs_electrode_open_input(electric->state.tables, open)] = per_charge[open];
    }
    return PZS_OK;
}
