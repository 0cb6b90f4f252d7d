/*
 * Electrodes at rest (pzs.h). A volt on an open electrode is an unknown more, coupled to the whole shell under it. It is
 * taken out by a Schur complement on the factor there is: a solve for each electrode gives its charge per unit of every
 * input, a small dense matrix, and what is asked of volts and charges after that is algebra with this matrix.
 */
#include "electrode.h"
#include "guard.h"
#include "linalg.h"
#include "model.h"
#include <string.h>

enum { ELECTRIC_READY = 1, ELECTRIC_FACTORED = 2 };

static pzs_status fail(pzs_electric *electric, pzs_status status, int32_t where)
{
    electric->where = where;
    return status;
}

/* ---- tables ----------------------------------------------------------- */

uint32_t electrode_crc(const pzs_electrodes *t, uint32_t inputs)
{
    const uint32_t entries = t->direct.start[t->count];
    uint32_t crc = guard_crc(GUARD_CRC_START, t->input, t->count * sizeof *t->input);
    crc = guard_crc(crc, t->open, t->count * sizeof *t->open);
    crc = guard_crc(crc, t->direct.start, (t->count + 1u) * sizeof *t->direct.start);
    if (entries > (uint32_t)t->count * inputs) /* damaged: not to be led astray by it */
        return crc;
    crc = guard_crc(crc, t->direct.dof, entries * sizeof *t->direct.dof);
    return ~guard_crc(crc, t->direct.value, entries * sizeof *t->direct.value);
}

static int in_range(const pzs_electrodes *t, uint32_t inputs)
{
    for (uint32_t k = 0; k < t->count; k++)
        if (t->input[k] >= inputs || (k > 0 && t->input[k] <= t->input[k - 1])
            || t->direct.start[k] > t->direct.start[k + 1])
            return 0;
    for (uint32_t i = t->direct.start[0]; i < t->direct.start[t->count]; i++)
        if (t->direct.dof[i] >= inputs)
            return 0;
    return 1;
}

pzs_status electrode_check(const pzs_electrodes *t, const pzs_structure *s)
{
    if (!t || !t->input || !t->open || !t->direct.start || !t->direct.dof || !t->direct.value || t->direct.count != t->count)
        return PZS_E_ARGUMENT;
    if (t->format != PZS_TABLE_FORMAT || t->scene != s->scene)
        return PZS_E_FORMAT;
    if (electrode_crc(t, s->input.count) != t->crc)
        return PZS_E_CRC;
    return in_range(t, s->input.count) ? PZS_OK : PZS_E_ARGUMENT;
}

uint32_t electrode_open_count(const pzs_electrodes *t)
{
    uint32_t open = 0;
    for (uint32_t k = 0; k < t->count; k++)
        open += t->open[k] != 0;
    return open;
}

uint32_t electrode_open(const pzs_electrodes *t, uint32_t a)
{
    uint32_t k = 0;
    for (; k + 1 < t->count && (!t->open[k] || a > 0); k++)
        a -= t->open[k] != 0;
    return k;
}

uint16_t electrode_open_input(const pzs_electrodes *t, uint32_t a)
{
    return t->input[electrode_open(t, a)];
}

pzs_real electrode_direct(const pzs_electrodes *t, uint32_t electrode, uint32_t input)
{
    pzs_real sum = 0;
    for (uint32_t i = t->direct.start[electrode]; i < t->direct.start[electrode + 1]; i++)
        sum += t->direct.dof[i] == input ? t->direct.value[i] : 0;
    return sum;
}

void electrode_layout(pzs_envelope *dense, uint32_t n, pzs_real *work, void *index)
{
    uint32_t *start = index;
    uint16_t *first = (uint16_t *)(start + n / PZS_TILE + 2);
    memset(first, 0, n * sizeof *first);
    dense->n = n;
    dense->first = first;
    dense->start = start;
    dense->inverse = work;
    dense->value = work + n;
    linalg_layout(dense);
}

/* ---- init and factor -------------------------------------------------- */

pzs_status pzs_electric_init(pzs_electric *e, pzs_model *model, const pzs_electrodes *tables, void *work, size_t bytes)
{
    if (!e || !model || !work || model->stage < STAGE_READY)
        return PZS_E_ARGUMENT;
    memset(e, 0, sizeof *e);
    e->where = -1;
    const pzs_status status = electrode_check(tables, model->structure);
    if (status != PZS_OK)
        return status;
    const uint32_t inputs = model->structure->input.count, open = electrode_open_count(tables);
    const int32_t lacking = guard_short(work, bytes, PZS_ELECTRIC_BYTES(tables->count, open, inputs));
    if (lacking >= 0)
        return fail(e, PZS_E_WORKSPACE, lacking);
    e->model = model;
    e->tables = tables;
    e->charge = work;
    e->amount = e->charge + tables->count;
    e->per = e->amount + inputs + 1;
    pzs_real *dense = e->per + (size_t)tables->count * inputs;
    electrode_layout(&e->open, open, dense, dense + PZS_DENSE(open));
    memset(e->charge, 0, tables->count * sizeof *e->charge);
    e->stage = ELECTRIC_READY;
    return PZS_OK;
}

/* Charge of an electrode per unit of an input. */
static pzs_real *per(const pzs_electric *e, uint32_t electrode, uint32_t input)
{
    return e->per + (size_t)electrode * e->model->structure->input.count + input;
}

/*
 * Charge of electrode k per unit of every input. u = K^-1 f_k, and f_k . K^-1 f_j = f_j . u: one solve for the whole row.
 */
static pzs_status charge_row(const pzs_electric *e, uint32_t k)
{
    const pzs_rows *input = &e->model->structure->input, *direct = &e->tables->direct;
    pzs_real *u = e->model->work + 5 * (size_t)e->model->k.n;
    memset(e->amount, 0, input->count * sizeof *e->amount);
    e->amount[e->tables->input[k]] = 1;
    const pzs_status status = pzs_solve(e->model, e->amount, u);
    for (uint32_t j = 0; j < input->count; j++) {
        *per(e, k, j) = 0;
        for (uint32_t t = input->start[j]; t < input->start[j + 1]; t++)
            *per(e, k, j) += input->value[t] * u[input->dof[t]];
    }
    for (uint32_t i = direct->start[k]; i < direct->start[k + 1]; i++)
        *per(e, k, direct->dof[i]) += direct->value[i];
    return status;
}

/* Charges of the open electrodes per volt of one another, factored. Returns the first without capacitance, or -1. */
static int32_t factor_open(pzs_electric *e)
{
    linalg_clear(&e->open);
    for (uint32_t a = 0; a < e->open.n; a++)
        for (uint32_t b = 0; b <= a; b++)
            *linalg_entry(&e->open, a, b) = *per(e, electrode_open(e->tables, a), electrode_open_input(e->tables, b));
    const linalg_inertia inertia = linalg_factor(&e->open);
    const int32_t bad = inertia.zero >= 0 ? inertia.zero : inertia.first_negative;
    return bad < 0 ? -1 : (int32_t)electrode_open(e->tables, (uint32_t)bad);
}

pzs_status pzs_electric_factor(pzs_electric *e)
{
    if (!e || !e->model)
        return PZS_E_ARGUMENT;
    if (e->model->stage != STAGE_FACTORED)
        return fail(e, PZS_E_STAGE, -1);
    e->stage = ELECTRIC_READY;
    for (uint32_t k = 0; k < e->tables->count; k++) {
        const pzs_status status = charge_row(e, k);
        if (status != PZS_OK)
            return fail(e, status, (int32_t)k);
    }
    const int32_t bad = factor_open(e);
    if (bad >= 0)
        return fail(e, PZS_E_NEGATIVE, bad);
    e->stage = ELECTRIC_FACTORED;
    return fail(e, PZS_OK, -1);
}

/* ---- volts and charges ------------------------------------------------ */

static pzs_real charge_of(const pzs_electric *e, uint32_t electrode, const pzs_real *amount)
{
    pzs_real sum = 0;
    for (uint32_t j = 0; j < e->model->structure->input.count; j++)
        sum += *per(e, electrode, j) * amount[j];
    return sum;
}

static void put_volts(const pzs_electric *e, const pzs_real *volt, pzs_real *amount)
{
    for (uint32_t a = 0; a < e->open.n; a++)
        amount[electrode_open_input(e->tables, a)] = volt[a];
}

pzs_status pzs_open_volts(const pzs_electric *e, pzs_real *amount)
{
    if (!e || !amount)
        return PZS_E_ARGUMENT;
    if (e->stage != ELECTRIC_FACTORED)
        return PZS_E_STAGE;
    pzs_real *volt = e->amount;
    for (uint32_t a = 0; a < e->open.n; a++) {
        volt[a] = amount[electrode_open_input(e->tables, a)];
        amount[electrode_open_input(e->tables, a)] = 0;
    }
    if (guard_nonfinite(amount, e->model->structure->input.count) >= 0) {
        put_volts(e, volt, amount);
        return PZS_E_NONFINITE;
    }
    for (uint32_t a = 0; a < e->open.n; a++) {
        const uint32_t k = electrode_open(e->tables, a);
        volt[a] = e->charge[k] - charge_of(e, k, amount);
    }
    linalg_solve(&e->open, volt);
    put_volts(e, volt, amount);
    return PZS_OK;
}

pzs_status pzs_charges(const pzs_electric *e, const pzs_real *amount, pzs_real *charge)
{
    if (!e || !amount || !charge)
        return PZS_E_ARGUMENT;
    if (e->stage != ELECTRIC_FACTORED)
        return PZS_E_STAGE;
    for (uint32_t k = 0; k < e->tables->count; k++)
        charge[k] = charge_of(e, k, amount);
    return PZS_OK;
}

/* Row by row: the output's part of the open volts, solved for charge, is w; the other columns lose w . charge per unit. */
pzs_status pzs_influence_open(const pzs_electric *e, pzs_real *influence)
{
    if (!e || !influence)
        return PZS_E_ARGUMENT;
    if (e->stage != ELECTRIC_FACTORED)
        return PZS_E_STAGE;
    const uint32_t inputs = e->model->structure->input.count;
    pzs_real *w = e->amount;
    for (uint32_t i = 0; i < e->model->structure->output.count; i++) {
        pzs_real *row = influence + (size_t)i * inputs;
        for (uint32_t a = 0; a < e->open.n; a++)
            w[a] = row[electrode_open_input(e->tables, a)];
        linalg_solve(&e->open, w);
        for (uint32_t a = 0; a < e->open.n; a++)
            for (uint32_t j = 0; j < inputs; j++)
                row[j] -= w[a] * *per(e, electrode_open(e->tables, a), j);
        for (uint32_t a = 0; a < e->open.n; a++)
            row[electrode_open_input(e->tables, a)] = w[a];
    }
    return PZS_OK;
}
