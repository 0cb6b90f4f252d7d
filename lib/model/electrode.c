/*
 * Electrodes at rest (pzs.h). A volt on an open electrode is an unknown more, coupled to the whole
 * shell under it. It is taken out by a Schur complement on the factor there is: a solve for each
 * electrode gives its charge per unit of every input, a small dense matrix, and what is asked of
 * volts and charges after that is algebra with this matrix.
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

uint32_t pzs_electrode_crc(const pzs_electrodes *t, uint32_t inputs)
{
    const uint32_t entries = t->direct.start[t->count];
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, t->input, t->count * sizeof *t->input);
    crc = pzs_guard_crc(crc, t->open, t->count * sizeof *t->open);
    crc = pzs_guard_crc(crc, t->direct.start, (t->count + 1u) * sizeof *t->direct.start);
    if (entries > (uint32_t)t->count * inputs) /* damaged: not to be led astray by it */
        return crc;
    crc = pzs_guard_crc(crc, t->direct.dof, entries * sizeof *t->direct.dof);
    return ~pzs_guard_crc(crc, t->direct.value, entries * sizeof *t->direct.value);
}

static int in_range(const pzs_electrodes *t, uint32_t inputs)
{
    for (uint32_t k = 0; k < t->count; k++)
        if (t->input[k] >= inputs || (k > 0 && t->input[k] <= t->input[k - 1]) ||
            t->direct.start[k] > t->direct.start[k + 1])
            return 0;
    for (uint32_t i = t->direct.start[0]; i < t->direct.start[t->count]; i++)
        if (t->direct.dof[i] >= inputs)
            return 0;
    return 1;
}

pzs_status pzs_electrode_check(const pzs_electrodes *t, const pzs_structure *s)
{
    if (!t || !t->input || !t->open || !t->direct.start || !t->direct.dof || !t->direct.value ||
        t->direct.count != t->count)
        return PZS_E_ARGUMENT;
    if (t->format != PZS_TABLE_FORMAT || t->scene != s->scene)
        return PZS_E_FORMAT;
    if (pzs_electrode_crc(t, s->input.count) != t->crc)
        return PZS_E_CRC;
    return in_range(t, s->input.count) ? PZS_OK : PZS_E_ARGUMENT;
}

uint32_t pzs_electrode_open_count(const pzs_electrodes *t)
{
    uint32_t open = 0;
    for (uint32_t k = 0; k < t->count; k++)
        open += t->open[k] != 0;
    return open;
}

uint32_t pzs_electrode_open(const pzs_electrodes *t, uint32_t a)
{
    uint32_t k = 0;
    for (; k + 1 < t->count && (!t->open[k] || a > 0); k++)
        a -= t->open[k] != 0;
    return k;
}

uint16_t pzs_electrode_open_input(const pzs_electrodes *t, uint32_t a)
{
    return t->input[pzs_electrode_open(t, a)];
}

pzs_real pzs_electrode_direct(const pzs_electrodes *t, uint32_t electrode, uint32_t input)
{
    pzs_real sum = 0;
    for (uint32_t i = t->direct.start[electrode]; i < t->direct.start[electrode + 1]; i++)
        sum += t->direct.dof[i] == input ? t->direct.value[i] : 0;
    return sum;
}

pzs_status pzs_electrodes_seal(pzs_electrodes *tables, const pzs_structure *structure)
{
    if (!tables || !structure || !tables->input || !tables->open || !tables->direct.start)
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->scene = structure->scene;
    tables->crc = pzs_electrode_crc(tables, structure->input.count);
    return PZS_OK;
}

/* ---- init and factor -------------------------------------------------- */

pzs_status pzs_electric_init(pzs_electric *e, pzs_model *model, const pzs_electrodes *tables,
                             void *work, size_t bytes)
{
    if (!e || !model || !work || model->state.stage < STAGE_READY)
        return PZS_E_ARGUMENT;
    memset(e, 0, sizeof *e);
    e->info.where = -1;
    const pzs_status status = pzs_electrode_check(tables, model->state.structure);
    if (status != PZS_OK)
        return status;
    const uint32_t inputs = model->state.structure->input.count,
                   open = pzs_electrode_open_count(tables);
    const int32_t lacking =
        guard_missing_bytes(work, bytes, PZS_ELECTRIC_BYTES(tables->count, open, inputs));
    if (lacking >= 0)
        return fail(e, PZS_E_WORKSPACE, lacking);
    e->state.model = model;
    e->state.tables = tables;
    e->settings.charge = work;
    e->state.value = e->settings.charge + tables->count;
    e->state.sensitivity = e->state.value + inputs + 1;
    pzs_real *dense = e->state.sensitivity + (size_t)tables->count * inputs;
    pzs_linalg_dense_layout(&e->state.open, open, dense, dense + PZS_DENSE(open));
    memset(e->settings.charge, 0, tables->count * sizeof *e->settings.charge);
    e->state.stage = ELECTRIC_READY;
    return PZS_OK;
}

/* Charge of an electrode per unit of an input. */
static pzs_real *per(const pzs_electric *e, uint32_t electrode, uint32_t input)
{
    return e->state.sensitivity + (size_t)electrode * e->state.model->state.structure->input.count +
           input;
}

/*
 * Charge of electrode k per unit of every input. u = K^-1 f_k, and f_k . K^-1 f_j = f_j . u: one
 * solve for the whole row.
 */
static pzs_status charge_row(const pzs_electric *e, uint32_t k)
{
    const pzs_rows *input = &e->state.model->state.structure->input,
                   *direct = &e->state.tables->direct;
    pzs_real *u = e->state.model->state.work + 5 * (size_t)e->state.model->state.stiffness.n;
    memset(e->state.value, 0, input->count * sizeof *e->state.value);
    e->state.value[e->state.tables->input[k]] = 1;
    const pzs_status status = pzs_solve(e->state.model, e->state.value, u);
    for (uint32_t j = 0; j < input->count; j++) {
        *per(e, k, j) = 0;
        for (uint32_t t = input->start[j]; t < input->start[j + 1]; t++)
            *per(e, k, j) += input->value[t] * u[input->dof[t]];
    }
    for (uint32_t i = direct->start[k]; i < direct->start[k + 1]; i++)
        *per(e, k, direct->dof[i]) += direct->value[i];
    return status;
}

/* Charges of the open electrodes per volt of one another, factored. Returns the first without
 * capacitance, or -1. */
static int32_t factor_open(pzs_electric *e)
{
    pzs_linalg_clear(&e->state.open);
    for (uint32_t a = 0; a < e->state.open.n; a++)
        for (uint32_t b = 0; b <= a; b++)
            *pzs_linalg_entry(&e->state.open, a, b) =
                *per(e, pzs_electrode_open(e->state.tables, a),
                     pzs_electrode_open_input(e->state.tables, b));
    const linalg_inertia inertia = pzs_linalg_factor(&e->state.open);
    const int32_t bad = inertia.zero >= 0 ? inertia.zero : inertia.first_negative;
    return bad < 0 ? -1 : (int32_t)pzs_electrode_open(e->state.tables, (uint32_t)bad);
}

pzs_status pzs_electric_factor(pzs_electric *e)
{
    if (!e || !e->state.model)
        return PZS_E_ARGUMENT;
    if (e->state.model->state.stage != STAGE_FACTORED)
        return fail(e, PZS_E_STAGE, -1);
    e->state.stage = ELECTRIC_READY;
    for (uint32_t k = 0; k < e->state.tables->count; k++) {
        const pzs_status status = charge_row(e, k);
        if (status != PZS_OK)
            return fail(e, status, (int32_t)k);
    }
    const int32_t bad = factor_open(e);
    if (bad >= 0)
        return fail(e, PZS_E_NEGATIVE, bad);
    e->state.stage = ELECTRIC_FACTORED;
    return fail(e, PZS_OK, -1);
}

/* ---- volts and charges ------------------------------------------------ */

static pzs_real charge_of(const pzs_electric *e, uint32_t electrode, const pzs_real *amount)
{
    pzs_real sum = 0;
    for (uint32_t j = 0; j < e->state.model->state.structure->input.count; j++)
        sum += *per(e, electrode, j) * amount[j];
    return sum;
}

static void put_volts(const pzs_electric *e, const pzs_real *voltage, pzs_real *amount)
{
    for (uint32_t a = 0; a < e->state.open.n; a++)
        amount[pzs_electrode_open_input(e->state.tables, a)] = voltage[a];
}

pzs_status pzs_open_voltages(const pzs_electric *e, pzs_real *amount)
{
    if (!e || !amount)
        return PZS_E_ARGUMENT;
    if (e->state.stage != ELECTRIC_FACTORED)
        return PZS_E_STAGE;
    pzs_real *voltage = e->state.value;
    for (uint32_t a = 0; a < e->state.open.n; a++) {
        voltage[a] = amount[pzs_electrode_open_input(e->state.tables, a)];
        amount[pzs_electrode_open_input(e->state.tables, a)] = 0;
    }
    if (pzs_guard_nonfinite(amount, e->state.model->state.structure->input.count) >= 0) {
        put_volts(e, voltage, amount);
        return PZS_E_NONFINITE;
    }
    for (uint32_t a = 0; a < e->state.open.n; a++) {
        const uint32_t k = pzs_electrode_open(e->state.tables, a);
        voltage[a] = e->settings.charge[k] - charge_of(e, k, amount);
    }
    pzs_linalg_solve(&e->state.open, voltage);
    put_volts(e, voltage, amount);
    return PZS_OK;
}

pzs_status pzs_charges(const pzs_electric *e, const pzs_real *amount, pzs_real *charge)
{
    if (!e || !amount || !charge)
        return PZS_E_ARGUMENT;
    if (e->state.stage != ELECTRIC_FACTORED)
        return PZS_E_STAGE;
    for (uint32_t k = 0; k < e->state.tables->count; k++)
        charge[k] = charge_of(e, k, amount);
    return PZS_OK;
}

/* Row by row: the output's part of the open volts, solved for charge, is w; the other columns lose
 * w . charge per unit. */
pzs_status pzs_influence_open(const pzs_electric *e, pzs_real *influence)
{
    if (!e || !influence)
        return PZS_E_ARGUMENT;
    if (e->state.stage != ELECTRIC_FACTORED)
        return PZS_E_STAGE;
    const uint32_t inputs = e->state.model->state.structure->input.count;
    pzs_real *w = e->state.value;
    for (uint32_t i = 0; i < e->state.model->state.structure->output.count; i++) {
        pzs_real *row = influence + (size_t)i * inputs;
        for (uint32_t a = 0; a < e->state.open.n; a++)
            w[a] = row[pzs_electrode_open_input(e->state.tables, a)];
        pzs_linalg_solve(&e->state.open, w);
        for (uint32_t a = 0; a < e->state.open.n; a++)
            for (uint32_t j = 0; j < inputs; j++)
                row[j] -= w[a] * *per(e, pzs_electrode_open(e->state.tables, a), j);
        for (uint32_t a = 0; a < e->state.open.n; a++)
            row[pzs_electrode_open_input(e->state.tables, a)] = w[a];
    }
    return PZS_OK;
}
