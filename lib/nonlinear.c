/* Equilibrium at large rotation by Newton's method with independent resultants (pzs.h). */
#include "nonlinear.h"
#include "guard.h"
#include "linalg.h"
#include "model.h"
#include "shell.h"
#include <string.h>

#if PZS_NONLINEAR

enum { STEP_SYSTEMS = 40, MOST_CUTS = 6 }; /* systems of a step, halvings of the first */

static pzs_status fail(pzs_path *path, pzs_status status, int32_t where)
{
    path->where = where;
    return status;
}

/* ---- init ------------------------------------------------------------- */

uint32_t nonlinear_crc(const pzs_nonlinear *t, const pzs_structure *s)
{
    const uint32_t inputs = s->input.count, entries = t->given.start ? t->given.start[inputs] : 0;
    uint32_t crc = GUARD_CRC_START;
    if (entries > inputs * s->elements || t->given.values > entries || t->prescribed.count > s->dof)
        return crc; /* damaged: not to be led astray by it */
    if (entries > 0) {
        crc = guard_crc(crc, t->given.start, (inputs + 1) * sizeof *t->given.start);
        crc = guard_crc(crc, t->given.element, entries * sizeof *t->given.element);
        crc = guard_crc(crc, t->given.which, entries * sizeof *t->given.which);
        crc = guard_crc(crc, t->given.value, t->given.values * sizeof *t->given.value);
    }
    if (t->prescribed.count > 0) {
        crc = guard_crc(crc, &t->prescribed.input, sizeof t->prescribed.input);
        crc = guard_crc(crc, t->prescribed.dof, t->prescribed.count * sizeof *t->prescribed.dof);
        crc = guard_crc(crc, t->prescribed.value, t->prescribed.count * sizeof *t->prescribed.value);
    }
    return ~crc;
}

static int tables_in_range(const pzs_nonlinear *t, const pzs_structure *s)
{
    const uint32_t inputs = s->input.count, entries = t->given.start ? t->given.start[inputs] : 0;
    for (uint32_t j = 0; entries > 0 && j < inputs; j++)
        if (t->given.start[j] > t->given.start[j + 1])
            return 0;
    for (uint32_t i = 0; i < entries; i++)
        if (t->given.element[i] >= s->elements || t->given.which[i] >= t->given.values)
            return 0;
    for (uint32_t i = 0; i < t->prescribed.count; i++)
        if (t->prescribed.dof[i] >= s->dof)
            return 0;
    return t->prescribed.count == 0 || t->prescribed.input < inputs;
}

/* Powers of two that bring K at rest to unit diagonal; all tangents of the path are scaled by them. */
static int32_t scale_at_rest(pzs_model *model)
{
    if (pzs_assemble(model, model->stiffness_factor, model->held) != PZS_OK)
        return 0;
    model->stage = STAGE_READY;
    return linalg_scale(&model->k, model->scale);
}

pzs_status pzs_path_init(pzs_path *path, pzs_model *model, const pzs_nonlinear *tables, void *work, size_t bytes)
{
    if (!path || !model || !tables || !work || model->stage < STAGE_READY || !model->structure->kind)
        return PZS_E_ARGUMENT;
    const pzs_structure *s = model->structure;
    memset(path, 0, sizeof *path);
    path->where = -1;
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != s->scene)
        return PZS_E_FORMAT;
    if (nonlinear_crc(tables, s) != tables->crc)
        return PZS_E_CRC;
    if (!tables_in_range(tables, s))
        return PZS_E_ARGUMENT;
    const int32_t lacking = guard_short(work, bytes, PZS_PATH_BYTES(s->dof, s->elements, s->input.count));
    if (lacking >= 0)
        return fail(path, PZS_E_WORKSPACE, lacking);
    const int32_t loose = scale_at_rest(model);
    if (loose >= 0)
        return fail(path, PZS_E_LOOSE, loose);

    pzs_real *real = work;
    path->model = model;
    path->tables = tables;
    path->u = real;
    path->kept_u = path->u + s->dof;
    path->load = path->kept_u + s->dof;
    path->amount = path->load + s->dof;
    path->kept_amount = path->amount + s->input.count;
    path->resultant = (pzs_real (*)[SHELL_RESULTANTS])(path->kept_amount + s->input.count);
    path->kept_resultant = path->resultant + s->elements;
    path->given = (pzs_real (*)[SHELL_STRAINS])(path->kept_resultant + s->elements);
    path->change = (pzs_real)1e-4;
    path->steps = 1;
    path->mixed = 12;
    path->systems_allowed = 400;
    pzs_path_rest(path);
    return PZS_OK;
}

void pzs_path_rest(pzs_path *path)
{
    if (!path || !path->model)
        return;
    const pzs_structure *s = path->model->structure;
    memset(path->kept_u, 0, s->dof * sizeof *path->u);
    memset(path->kept_amount, 0, s->input.count * sizeof *path->amount);
    memset(path->kept_resultant, 0, s->elements * sizeof *path->resultant);
    memcpy(path->u, path->kept_u, s->dof * sizeof *path->u);
    memcpy(path->amount, path->kept_amount, s->input.count * sizeof *path->amount);
    memcpy(path->resultant, path->kept_resultant, s->elements * sizeof *path->resultant);
    memset(path->given, 0, s->elements * sizeof *path->given);
    path->negative = 0;
    path->factor = 0;
    path->residual = 0;
    path->stage = PATH_READY;
    for (pzs_option *o = path->option; o; o = o->next)
        if (o->call->rest)
            o->call->rest(o, path);
}

int nonlinear_is_attached(const pzs_path *path, const pzs_option *option)
{
    const pzs_option *o = path->option;
    while (o && o != option)
        o = o->next;
    return o != NULL;
}

void nonlinear_attach(pzs_path *path, pzs_option *option, const struct pzs_option_calls *call)
{
    option->call = call;
    option->next = path->option;
    path->option = option;
    path->stage = PATH_READY;
}

/* ---- inputs ----------------------------------------------------------- */

void nonlinear_set_given(pzs_path *path)
{
    const pzs_structure *s = path->model->structure;
    const pzs_given *g = &path->tables->given;
    memset(path->given, 0, s->elements * sizeof *path->given);
    for (uint32_t j = 0; g->start && j < s->input.count; j++)
        for (uint32_t t = g->start[j]; path->amount[j] != 0 && t < g->start[j + 1]; t++) {
            const pzs_real factor = model_kind_factor(path->model, g->element[t]);
            for (int i = 0; factor > 0 && i < SHELL_STRAINS; i++)
                path->given[g->element[t]][i] += path->amount[j] / factor * g->value[g->which[t]][i];
        }
}

static int is_given(const pzs_path *path, uint32_t input)
{
    const uint32_t *start = path->tables->given.start;
    return start && start[input + 1] > start[input];
}

void nonlinear_unit_force(pzs_path *path, uint32_t input, pzs_real *force)
{
    const pzs_structure *s = path->model->structure;
    const pzs_given *g = &path->tables->given;
    const int given = is_given(path, input);
    if (!given)
        model_add_input(path->model, input, 1, force);
    for (uint32_t t = given ? g->start[input] : 0; given && t < g->start[input + 1]; t++) {
        const uint16_t *node = s->element[g->element[t]];
        pzs_real u[SHELL_MAX], f[SHELL_MAX], resultant[SHELL_RESULTANTS] = {0};
        memcpy(resultant, g->value[g->which[t]], SHELL_STRAINS * sizeof *resultant);
        model_gather(path->model, node, SHELL_NODES, path->u, u);
        shell_force_at(&s->kind[s->element_kind[g->element[t]]], s->unknowns, u, resultant, f);
        model_scatter(path->model, node, SHELL_NODES, -1, f, force);
    }
    for (pzs_option *o = path->option; o; o = o->next)
        if (o->call->unit)
            o->call->unit(o, path, input, force);
}

/* ---- one system ------------------------------------------------------- */

void nonlinear_build(pzs_path *path, int plain, pzs_real *imbalance)
{
    pzs_model *model = path->model;
    const pzs_structure *s = model->structure;
    linalg_clear(&model->k);
    model->stage = STAGE_READY;
    memset(path->load, 0, s->dof * sizeof *path->load);
    memset(imbalance, 0, s->dof * sizeof *imbalance);
    for (uint32_t e = 0; e < s->elements; e++) {
        const pzs_real factor = model_kind_factor(model, e);
        pzs_real u[SHELL_MAX], f[SHELL_MAX], k[SHELL_PACKED(SHELL_MAX)];
        model_gather(model, s->element[e], SHELL_NODES, path->u, u);
        shell_system(&s->kind[s->element_kind[e]], s->unknowns, u, path->given[e], plain ? NULL : path->resultant[e], f, k);
        model_add_matrix(model, s->element[e], SHELL_NODES, factor, k);
        model_scatter(model, s->element[e], SHELL_NODES, -factor, f, imbalance);
    }
    for (uint32_t i = 0; model->held && i < s->dof; i++)
        if (model->held[i])
            *linalg_entry(&model->k, i, i) = 1;
    for (uint32_t j = 0; j < s->input.count; j++)
        if (path->amount[j] != 0 && !is_given(path, j))
            model_add_input(model, j, path->amount[j], path->load);
    for (pzs_option *o = path->option; o; o = o->next)
        if (o->call->add)
            o->call->add(o, path, path->load);
    for (uint32_t i = 0; i < s->dof; i++)
        imbalance[i] += path->load[i];
}

void nonlinear_prescribe(pzs_envelope *k, uint32_t p, pzs_real value, pzs_real *b)
{
    for (uint32_t i = 0; i < k->n; i++) {
        if (i == p || k->first[i > p ? i : p] > (i > p ? p : i))
            continue;
        pzs_real *entry = linalg_entry(k, i > p ? i : p, i > p ? p : i);
        b[i] -= *entry * value;
        *entry = 0;
    }
    pzs_real *d = linalg_entry(k, p, p);
    *d = *d > 0 ? *d : 1;
    b[p] = *d * value;
}

void nonlinear_clear_prescribed(const pzs_path *path, pzs_real *f)
{
    const pzs_prescribed *p = &path->tables->prescribed;
    for (uint32_t i = 0; i < p->count; i++)
        f[p->dof[i]] = 0;
}

/* Move the prescribed unknowns in b; what held them back, its scaled square, is returned. */
static pzs_real prescribe_all(pzs_path *path, pzs_real *b)
{
    const pzs_prescribed *p = &path->tables->prescribed;
    pzs_real reaction = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        const pzs_real scaled = path->model->scale[p->dof[i]] * b[p->dof[i]];
        reaction += scaled * scaled;
    }
    for (uint32_t i = 0; i < p->count; i++)
        nonlinear_prescribe(&path->model->k, p->dof[i], path->amount[p->input] * p->value[i] - path->u[p->dof[i]], b);
    return reaction;
}

int nonlinear_factor(pzs_path *path)
{
    linalg_apply_scale(&path->model->k, path->model->scale);
    const linalg_inertia inertia = linalg_factor(&path->model->k);
    path->negative = inertia.negative;
    path->where = inertia.zero;
    return inertia.zero < 0;
}

pzs_real nonlinear_size2(const pzs_path *path, const pzs_real *x, const pzs_real *y)
{
    const pzs_structure *s = path->model->structure;
    const pzs_real h = s->kind[0].thickness;
    pzs_real sum = 0;
    for (uint32_t i = 0; i < (uint32_t)s->nodes * s->unknowns; i++) {
        const uint16_t dof = s->node_dof[i];
        if (dof == PZS_FIXED)
            continue;
        const pzs_real size = (x[dof] - (y ? y[dof] : 0)) * (i % s->unknowns < 3 ? 1 : h);
        sum += size * size;
    }
    return sum;
}

static void extrapolate(pzs_path *path, const pzs_real *du)
{
    const pzs_structure *s = path->model->structure;
    for (uint32_t e = 0; e < s->elements; e++) {
        pzs_real u[SHELL_MAX], d[SHELL_MAX];
        model_gather(path->model, s->element[e], SHELL_NODES, path->u, u);
        if (du)
            model_gather(path->model, s->element[e], SHELL_NODES, du, d);
        shell_resultants(&s->kind[s->element_kind[e]], s->unknowns, u, du ? d : NULL, path->given[e], path->resultant[e]);
    }
}

int nonlinear_condense(pzs_path *path, uint32_t input, pzs_real *du)
{
    for (pzs_option *o = path->option; o; o = o->next)
        if (o->call->condense && !o->call->condense(o, path, input, du))
            return 0;
    return 1;
}

/* Solve one system and move. du [dof] out. Returns 0 where it cannot be done. */
static int move(pzs_path *path, int plain, pzs_real *du)
{
    const uint32_t n = path->model->structure->dof;
    for (pzs_option *o = path->option; o; o = o->next)
        if (o->call->prepare && !o->call->prepare(o, path))
            return 0;
    nonlinear_build(path, plain, du);
    prescribe_all(path, du);
    if (!nonlinear_factor(path))
        return 0;
    model_backsolve(path->model, du, du);
    path->systems++;
    if (!nonlinear_condense(path, NEWTON, du) || guard_nonfinite(du, n) >= 0)
        return 0;
    for (pzs_option *o = path->option; o; o = o->next)
        if (o->call->solved)
            o->call->solved(o, path, du);
    extrapolate(path, du);
    for (uint32_t i = 0; i < n; i++)
        path->u[i] += du[i];
    return 1;
}

/* ---- one load step ---------------------------------------------------- */

/* The error of an option that has not settled, or PZS_OK. */
static pzs_status options_open(pzs_path *path)
{
    pzs_status open = PZS_OK;
    for (pzs_option *o = path->option; o; o = o->next)
        if (o->call->settled && !o->call->settled(o, path))
            open = o->call->unsettled;
    return open;
}

/* Force of actuation at path->u onto f. */
static void add_actuation(const pzs_path *path, pzs_real *f)
{
    const pzs_structure *s = path->model->structure;
    for (uint32_t e = 0; e < s->elements; e++) {
        pzs_real u[SHELL_MAX], force[SHELL_MAX], resultant[SHELL_RESULTANTS] = {0};
        memcpy(resultant, path->given[e], sizeof path->given[e]);
        model_gather(path->model, s->element[e], SHELL_NODES, path->u, u);
        shell_force_at(&s->kind[s->element_kind[e]], s->unknowns, u, resultant, force);
        model_scatter(path->model, s->element[e], SHELL_NODES, -model_kind_factor(path->model, e), force, f);
    }
}

/* Imbalances of a displacement by rounding are below this part of it, scaled rows. */
#define ROUNDING (256 * PZS_EPSILON)

/*
 * Tangent and residual at path->u, factored; the resultants become the true ones. Returns whether all is finite.
 *   next [dof] out the increment that Newton's method would make from here
 */
static int judge(pzs_path *path, pzs_real *next)
{
    pzs_model *model = path->model;
    const uint32_t n = model->structure->dof;
    pzs_real *applied = model->work + n;
    nonlinear_build(path, 1, next);
    memcpy(applied, path->load, n * sizeof *applied);
    add_actuation(path, applied);
    const pzs_real load2 = model_scaled_norm2(model, applied), reaction2 = prescribe_all(path, next);
    const pzs_real left2 = model_scaled_norm2(model, next);
    path->residual = load2 + reaction2 > 0 ? PZS_SQRT(left2 / (load2 + reaction2)) : PZS_SQRT(left2);
    path->balanced = path->residual <= 1 || left2 <= ROUNDING * ROUNDING * nonlinear_size2(path, path->u, NULL);
    extrapolate(path, NULL);
    if (!nonlinear_factor(path))
        return 0;
    model_backsolve(model, next, next);
    return nonlinear_condense(path, NEWTON, next) && guard_nonfinite(next, n) < 0 && guard_nonfinite(&path->residual, 1) < 0;
}

/* Whether an iteration is worth going on: near its end it gets twice the systems; one that moves as far as the whole step
 * four times in a row is lost. */
static int hopeful(const pzs_path *path, uint32_t wild)
{
    return wild < 4 && path->iteration < (path->quiet < (pzs_real)0.01 ? 2 * STEP_SYSTEMS : STEP_SYSTEMS);
}

/*
 * Newton's method at the present amounts: settled when the last increment is below `change` of the step's displacement,
 * and so is the next one that the tangent at the shape reached would make, and the forces left over are no larger than
 * those applied, or rounding. Returns whether it settled; if only an option did not, path->open is its error. A step that
 * moves less than a thousandth of the whole displacement (a tenth in float, whose round-off it would be) is judged by that.
 */
static int settle(pzs_path *path)
{
    const pzs_real least = PZS_BY_BITS((pzs_real)1e-2, (pzs_real)1e-6), limit2 = path->change * path->change;
    pzs_real *du = path->model->work;
    uint32_t wild = 0;
    path->quiet = 1;
    path->open = 0;
    path->where = -1;
    for (path->iteration = 0; hopeful(path, wild); path->iteration++) {
        if (path->systems >= path->systems_allowed || !move(path, path->iteration >= path->mixed, du))
            return 0;
        const pzs_real moved2 = nonlinear_size2(path, path->u, path->kept_u)
                              + least * nonlinear_size2(path, path->u, NULL);
        const pzs_real last2 = nonlinear_size2(path, du, NULL);
        path->quiet = moved2 > 0 ? PZS_SQRT(last2 / moved2) : 0;
        wild = path->iteration > 2 && path->quiet > (pzs_real)0.9 ? wild + 1 : 0;
        if (!(last2 <= limit2 * moved2))
            continue;
        path->open = (uint8_t)options_open(path);
        if (!path->open && judge(path, du) && path->balanced && nonlinear_size2(path, du, NULL) <= limit2 * moved2)
            return 1;
    }
    return 0;
}

/* ---- the way ---------------------------------------------------------- */

static void keep(pzs_path *path)
{
    const pzs_structure *s = path->model->structure;
    memcpy(path->kept_u, path->u, s->dof * sizeof *path->u);
    memcpy(path->kept_amount, path->amount, s->input.count * sizeof *path->amount);
    memcpy(path->kept_resultant, path->resultant, s->elements * sizeof *path->resultant);
    for (pzs_option *o = path->option; o; o = o->next)
        if (o->call->keep)
            o->call->keep(o, path);
}

static void restore(pzs_path *path)
{
    const pzs_structure *s = path->model->structure;
    memcpy(path->u, path->kept_u, s->dof * sizeof *path->u);
    memcpy(path->amount, path->kept_amount, s->input.count * sizeof *path->amount);
    memcpy(path->resultant, path->kept_resultant, s->elements * sizeof *path->resultant);
    nonlinear_set_given(path);
    for (pzs_option *o = path->option; o; o = o->next)
        if (o->call->restore)
            o->call->restore(o, path);
}

/* Do all options let the settled shape stand? Otherwise path->refused is the error of the first
 * that does not. */
static int is_accepted(pzs_path *path)
{
    path->warned = 0;
    for (pzs_option *o = path->option; o; o = o->next) {
        const pzs_status status = o->call->refuses ? o->call->refuses(o, path) : PZS_OK;
        if (PZS_IS_ERROR(status)) {
            path->refused = (uint8_t)status;
            return 0;
        }
        if (status != PZS_OK)
            path->warned = (uint8_t)status;
    }
    return 1;
}

/* One load step towards the amounts, by `part` of the way that is left. Returns whether it settled; only then it is kept. */
static int step(pzs_path *path, const pzs_real *amount, pzs_real part)
{
    const uint32_t inputs = path->model->structure->input.count;
    for (uint32_t j = 0; j < inputs; j++)
        path->amount[j] = part < 1 ? path->kept_amount[j] + part * (amount[j] - path->kept_amount[j]) : amount[j];
    nonlinear_set_given(path);
    path->refused = 0;
    if (!settle(path) || !is_accepted(path))
        return 0;
    keep(path);
    path->steps_taken++;
    return 1;
}

/* Why a step did not settle, by the state it ended with; negative: pivots of the last equilibrium. */
static pzs_status reason(const pzs_path *path, uint32_t negative)
{
    if (path->refused)
        return (pzs_status)path->refused;
    for (const pzs_option *o = path->option; o; o = o->next)
        if (o->call->adrift && o->call->adrift(o, path))
            return PZS_E_CONTACT;
    if (path->systems >= path->systems_allowed)
        return PZS_E_SYSTEMS;
    if (path->open)
        return (pzs_status)path->open;
    return path->where >= 0 || path->negative != negative ? PZS_E_LIMIT : PZS_E_DIVERGED;
}

/* Largest part of the way to the amounts that all options let a load step take. */
static pzs_real longest_part(const pzs_path *path, const pzs_real *amount)
{
    pzs_real part = 1;
    for (pzs_option *o = path->option; o; o = o->next) {
        const pzs_real most = o->call->longest ? o->call->longest(o, path, amount) : 1;
        part = most < part ? most : part;
    }
    return part;
}

/* The way to the amounts in equal units: the whole, what is done, the next load step, the
 * longest one. */
typedef struct way {
    uint32_t whole, done, stride, longest;
} way;

/* Divide the units further, until a load step by `part` of what is left can be halved as often
 * as the first one. */
static void refine(way *w, pzs_real part)
{
    const pzs_real enough = (pzs_real)(1u << MOST_CUTS);
    while (part * (pzs_real)(w->whole - w->done) < enough && w->whole < 1u << 30) {
        w->whole *= 2;
        w->done *= 2;
        w->stride *= 2;
        w->longest *= 2;
    }
}

/* Units of the next load step, 0 if the options allow none; *is_short = they shorten it. */
static uint32_t next_stride(const pzs_path *path, way *w, const pzs_real *amount, int *is_short)
{
    const pzs_real part = longest_part(path, amount);
    if (part < 1)
        refine(w, part);
    const uint32_t left = w->whole - w->done, take = w->stride < left ? w->stride : left;
    const pzs_real most = part * (pzs_real)left;
    *is_short = part < 1 && (pzs_real)take > most;
    if (*is_short)
        w->stride = (uint32_t)most;
    return *is_short ? w->stride : take;
}

/*
 * All load steps: in units of 1/(steps 2^MOST_CUTS) of the way or less, so that the end is met
 * exactly. A step that does not settle is halved; one that does is doubled, up to the first size.
 */
static pzs_status follow(pzs_path *path, const pzs_real *amount)
{
    const uint32_t first = 1u << MOST_CUTS;
    way w = {(uint32_t)path->steps << MOST_CUTS, 0, first, first};
    uint32_t negative = path->negative;
    while (w.done < w.whole) {
        int is_short;
        const uint32_t take = next_stride(path, &w, amount, &is_short);
        if (take == 0)
            return PZS_E_SYSTEMS;
        if (step(path, amount, (pzs_real)take / (pzs_real)(w.whole - w.done))) {
            w.done += take;
            w.stride = w.stride < w.longest ? 2 * w.stride : w.stride;
            negative = path->negative;
            path->factor = (pzs_real)w.done / (pzs_real)w.whole;
            path->steps_short += (uint32_t)is_short;
            continue;
        }
        const pzs_status why = reason(path, negative);
        restore(path);
        if (w.stride == 1 || path->systems >= path->systems_allowed)
            return why;
        w.stride /= 2;
    }
    if (path->warned)
        return (pzs_status)path->warned;
    return path->negative > 0 ? PZS_W_UNSTABLE : PZS_OK;
}

/* Are the choices such that a settled shape is one? */
static int choices_in_range(const pzs_path *path)
{
    for (const pzs_option *o = path->option; o; o = o->next)
        if (o->call->choices_in_range && !o->call->choices_in_range(o))
            return 0;
    return path->steps > 0 && path->change > 0 && path->change < 1;
}

pzs_status pzs_equilibrium(pzs_path *path, const pzs_real *amount)
{
    if (!path || !amount)
        return PZS_E_ARGUMENT;
    if (path->stage < PATH_READY)
        return fail(path, PZS_E_STAGE, -1);
    if (!choices_in_range(path))
        return fail(path, PZS_E_ARGUMENT, -1);
    const int32_t bad = guard_nonfinite(amount, path->model->structure->input.count);
    if (bad >= 0)
        return fail(path, PZS_E_NONFINITE, bad);
    path->systems = 0;
    path->steps_taken = 0;
    path->steps_short = 0;
    path->refused = 0;
    path->warned = 0;
    path->refused_at = -1;
    path->factor = 0;
    path->stage = PATH_READY;
    const pzs_status status = follow(path, amount);
    if (!PZS_IS_ERROR(status) || judge(path, path->model->work)) {
        path->stage = PATH_SETTLED;
        path->model->stage = STAGE_AT_SHAPE;
    }
    const int is_refused = PZS_IS_ERROR(status) && status == (pzs_status)path->refused;
    return fail(path, status, is_refused ? path->refused_at : -1);
}

#endif
