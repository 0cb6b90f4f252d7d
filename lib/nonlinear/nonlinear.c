/* Equilibrium at large rotation by Newton's method with independent resultants (pzs.h). */
#include "nonlinear.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../model/model.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

enum { STEP_SYSTEMS = 40, MOST_CUTS = 6 }; /* systems of a step, halvings of the first */

static pzs_status fail(pzs_solver *path, pzs_status status, int32_t where)
{
    path->info.where = where;
    return status;
}

/* ---- init ------------------------------------------------------------- */

uint32_t pzs_nonlinear_crc(const pzs_nonlinear *t, const pzs_structure *s)
{
    const uint32_t inputs = s->input.count, entries = t->given.start ? t->given.start[inputs] : 0;
    uint32_t crc = GUARD_CRC_START;
    if (entries > inputs * s->elements || t->given.values > entries ||
        t->prescribed.count > s->free_dof)
        return crc; /* damaged: not to be led astray by it */
    if (entries > 0) {
        crc = pzs_guard_crc(crc, t->given.start, (inputs + 1) * sizeof *t->given.start);
        crc = pzs_guard_crc(crc, t->given.element, entries * sizeof *t->given.element);
        crc = pzs_guard_crc(crc, t->given.which, entries * sizeof *t->given.which);
        crc = pzs_guard_crc(crc, t->given.value, t->given.values * sizeof *t->given.value);
    }
    if (t->prescribed.count > 0) {
        crc = pzs_guard_crc(crc, &t->prescribed.input, sizeof t->prescribed.input);
        crc =
            pzs_guard_crc(crc, t->prescribed.dof, t->prescribed.count * sizeof *t->prescribed.dof);
        crc = pzs_guard_crc(crc, t->prescribed.value,
                            t->prescribed.count * sizeof *t->prescribed.value);
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
        if (t->prescribed.dof[i] >= s->free_dof)
            return 0;
    return t->prescribed.count == 0 || t->prescribed.input < inputs;
}

/* Powers of two that bring K at rest to unit diagonal; all tangents of the path are scaled by them.
 */
static int32_t scale_at_rest(pzs_model *model)
{
    if (pzs_assemble(model, model->state.stiffness_factor, model->state.constrained) != PZS_OK)
        return 0;
    model->state.stage = STAGE_READY;
    return pzs_linalg_scale(&model->state.stiffness, model->state.scale);
}

pzs_status pzs_solver_init(pzs_solver *path, pzs_model *model, const pzs_nonlinear *tables,
                           void *work, size_t bytes)
{
    if (!path || !model || !tables || !work || model->state.stage < STAGE_READY ||
        !model->state.structure->type)
        return PZS_E_ARGUMENT;
    const pzs_structure *s = model->state.structure;
    memset(path, 0, sizeof *path);
    path->info.where = -1;
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != s->scene)
        return PZS_E_FORMAT;
    if (pzs_nonlinear_crc(tables, s) != tables->crc)
        return PZS_E_CRC;
    if (!tables_in_range(tables, s))
        return PZS_E_ARGUMENT;
    const int32_t lacking = guard_missing_bytes(
        work, bytes, PZS_SOLVER_BYTES(s->free_dof, s->elements, s->input.count));
    if (lacking >= 0)
        return fail(path, PZS_E_WORKSPACE, lacking);
    const int32_t loose = scale_at_rest(model);
    if (loose >= 0)
        return fail(path, PZS_E_LOOSE, loose);

    pzs_real *real = work;
    path->state.model = model;
    path->state.tables = tables;
    path->state.displacement = real;
    path->state.kept_displacement = path->state.displacement + s->free_dof;
    path->state.load = path->state.kept_displacement + s->free_dof;
    path->state.input_value = path->state.load + s->free_dof;
    path->state.kept_input_value = path->state.input_value + s->input.count;
    path->state.resultant =
        (pzs_real(*)[SHELL_RESULTANTS])(path->state.kept_input_value + s->input.count);
    path->state.kept_resultant = path->state.resultant + s->elements;
    path->state.prescribed = (pzs_real(*)[SHELL_STRAINS])(path->state.kept_resultant + s->elements);
    path->info.displacement = path->state.displacement;
    path->info.input_value = path->state.input_value;
    path->settings.tolerance = (pzs_real)1e-4;
    path->settings.load_steps = 1;
    path->settings.extrapolated_iterations = 12;
    path->settings.solve_limit = 400;
    pzs_solver_reset(path);
    return PZS_OK;
}

void pzs_solver_reset(pzs_solver *path)
{
    if (!path || !path->state.model)
        return;
    const pzs_structure *s = path->state.model->state.structure;
    memset(path->state.kept_displacement, 0, s->free_dof * sizeof *path->state.displacement);
    memset(path->state.kept_input_value, 0, s->input.count * sizeof *path->state.input_value);
    memset(path->state.kept_resultant, 0, s->elements * sizeof *path->state.resultant);
    memcpy(path->state.displacement, path->state.kept_displacement,
           s->free_dof * sizeof *path->state.displacement);
    memcpy(path->state.input_value, path->state.kept_input_value,
           s->input.count * sizeof *path->state.input_value);
    memcpy(path->state.resultant, path->state.kept_resultant,
           s->elements * sizeof *path->state.resultant);
    memset(path->state.prescribed, 0, s->elements * sizeof *path->state.prescribed);
    path->info.negative_pivots = 0;
    path->info.load_factor = 0;
    path->info.residual = 0;
    path->state.stage = PATH_READY;
    for (pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->rest)
            o->call->rest(o, path);
}

int pzs_nonlinear_is_attached(const pzs_solver *path, const pzs_solver_option *option)
{
    const pzs_solver_option *o = path->state.option;
    while (o && o != option)
        o = o->next;
    return o != NULL;
}

void pzs_nonlinear_attach(pzs_solver *path, pzs_solver_option *option,
                          const struct pzs_solver_option_calls *call)
{
    option->call = call;
    option->next = path->state.option;
    path->state.option = option;
    path->state.stage = PATH_READY;
}

/* ---- inputs ----------------------------------------------------------- */

void pzs_nonlinear_set_given(pzs_solver *path)
{
    const pzs_structure *s = path->state.model->state.structure;
    const pzs_prescribed_resultants *g = &path->state.tables->given;
    memset(path->state.prescribed, 0, s->elements * sizeof *path->state.prescribed);
    for (uint32_t j = 0; g->start && j < s->input.count; j++)
        for (uint32_t t = g->start[j]; path->state.input_value[j] != 0 && t < g->start[j + 1];
             t++) {
            const pzs_real factor = pzs_model_type_factor(path->state.model, g->element[t]);
            for (int i = 0; factor > 0 && i < SHELL_STRAINS; i++)
                path->state.prescribed[g->element[t]][i] +=
                    path->state.input_value[j] / factor * g->value[g->which[t]][i];
        }
}

static int is_given(const pzs_solver *path, uint32_t input)
{
    const uint32_t *start = path->state.tables->given.start;
    return start && start[input + 1] > start[input];
}

void pzs_nonlinear_unit_force(pzs_solver *path, uint32_t input, pzs_real *force)
{
    const pzs_structure *s = path->state.model->state.structure;
    const pzs_prescribed_resultants *g = &path->state.tables->given;
    const int given = is_given(path, input);
    if (!given)
        pzs_model_add_input(path->state.model, input, 1, force);
    for (uint32_t t = given ? g->start[input] : 0; given && t < g->start[input + 1]; t++) {
        const uint16_t *node = s->element[g->element[t]];
        pzs_real u[SHELL_MAX], f[SHELL_MAX], resultant[SHELL_RESULTANTS] = {0};
        memcpy(resultant, g->value[g->which[t]], SHELL_STRAINS * sizeof *resultant);
        pzs_model_gather(path->state.model, node, SHELL_NODES, path->state.displacement, u);
        pzs_shell_force_at(&s->type[s->element_type[g->element[t]]], s->dof_per_node, u, resultant,
                           f);
        pzs_model_scatter(path->state.model, node, SHELL_NODES, -1, f, force);
    }
    for (pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->unit)
            o->call->unit(o, path, input, force);
}

/* ---- one system ------------------------------------------------------- */

void pzs_nonlinear_build(pzs_solver *path, int plain, pzs_real *imbalance)
{
    pzs_model *model = path->state.model;
    const pzs_structure *s = model->state.structure;
    pzs_linalg_clear(&model->state.stiffness);
    model->state.stage = STAGE_READY;
    memset(path->state.load, 0, s->free_dof * sizeof *path->state.load);
    memset(imbalance, 0, s->free_dof * sizeof *imbalance);
    for (uint32_t e = 0; e < s->elements; e++) {
        const pzs_real factor = pzs_model_type_factor(model, e);
        pzs_real u[SHELL_MAX], f[SHELL_MAX], k[SHELL_PACKED(SHELL_MAX)];
        pzs_model_gather(model, s->element[e], SHELL_NODES, path->state.displacement, u);
        pzs_shell_system(&s->type[s->element_type[e]], s->dof_per_node, u,
                         path->state.prescribed[e], plain ? NULL : path->state.resultant[e], f, k);
        pzs_model_add_matrix(model, s->element[e], SHELL_NODES, factor, k);
        pzs_model_scatter(model, s->element[e], SHELL_NODES, -factor, f, imbalance);
    }
    for (uint32_t i = 0; model->state.constrained && i < s->free_dof; i++)
        if (model->state.constrained[i])
            *pzs_linalg_entry(&model->state.stiffness, i, i) = 1;
    for (uint32_t j = 0; j < s->input.count; j++)
        if (path->state.input_value[j] != 0 && !is_given(path, j))
            pzs_model_add_input(model, j, path->state.input_value[j], path->state.load);
    for (pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->add)
            o->call->add(o, path, path->state.load);
    for (uint32_t i = 0; i < s->free_dof; i++)
        imbalance[i] += path->state.load[i];
}

void pzs_nonlinear_prescribe(pzs_envelope *k, uint32_t p, pzs_real value, pzs_real *b)
{
    for (uint32_t i = 0; i < k->n; i++) {
        if (i == p || k->first[i > p ? i : p] > (i > p ? p : i))
            continue;
        pzs_real *entry = pzs_linalg_entry(k, i > p ? i : p, i > p ? p : i);
        b[i] -= *entry * value;
        *entry = 0;
    }
    pzs_real *d = pzs_linalg_entry(k, p, p);
    *d = *d > 0 ? *d : 1;
    b[p] = *d * value;
}

void pzs_nonlinear_clear_prescribed(const pzs_solver *path, pzs_real *f)
{
    const pzs_prescribed_motion *p = &path->state.tables->prescribed;
    for (uint32_t i = 0; i < p->count; i++)
        f[p->dof[i]] = 0;
}

/* Move the prescribed unknowns in b; what held them back, its scaled square, is returned. */
static pzs_real prescribe_all(pzs_solver *path, pzs_real *b)
{
    const pzs_prescribed_motion *p = &path->state.tables->prescribed;
    pzs_real reaction = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        const pzs_real scaled = path->state.model->state.scale[p->dof[i]] * b[p->dof[i]];
        reaction += scaled * scaled;
    }
    for (uint32_t i = 0; i < p->count; i++)
        pzs_nonlinear_prescribe(&path->state.model->state.stiffness, p->dof[i],
                                path->state.input_value[p->input] * p->value[i] -
                                    path->state.displacement[p->dof[i]],
                                b);
    return reaction;
}

int pzs_nonlinear_factor(pzs_solver *path)
{
    pzs_linalg_apply_scale(&path->state.model->state.stiffness, path->state.model->state.scale);
    const linalg_inertia inertia = pzs_linalg_factor(&path->state.model->state.stiffness);
    path->info.negative_pivots = inertia.negative;
    path->info.where = inertia.zero;
    return inertia.zero < 0;
}

pzs_real pzs_nonlinear_norm2(const pzs_solver *path, const pzs_real *x, const pzs_real *y)
{
    const pzs_structure *s = path->state.model->state.structure;
    const pzs_real h = s->type[0].thickness;
    pzs_real sum = 0;
    for (uint32_t i = 0; i < (uint32_t)s->nodes * s->dof_per_node; i++) {
        const uint16_t dof = s->node_dof[i];
        if (dof == PZS_CONSTRAINED)
            continue;
        const pzs_real size = (x[dof] - (y ? y[dof] : 0)) * (i % s->dof_per_node < 3 ? 1 : h);
        sum += size * size;
    }
    return sum;
}

static void extrapolate(pzs_solver *path, const pzs_real *du)
{
    const pzs_structure *s = path->state.model->state.structure;
    for (uint32_t e = 0; e < s->elements; e++) {
        pzs_real u[SHELL_MAX], d[SHELL_MAX];
        pzs_model_gather(path->state.model, s->element[e], SHELL_NODES, path->state.displacement,
                         u);
        if (du)
            pzs_model_gather(path->state.model, s->element[e], SHELL_NODES, du, d);
        pzs_shell_resultants(&s->type[s->element_type[e]], s->dof_per_node, u, du ? d : NULL,
                             path->state.prescribed[e], path->state.resultant[e]);
    }
}

int pzs_nonlinear_condense(pzs_solver *path, uint32_t input, pzs_real *du)
{
    for (pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->condense && !o->call->condense(o, path, input, du))
            return 0;
    return 1;
}

/* Solve one system and move. du [dof] out. Returns 0 where it cannot be done. */
static int move(pzs_solver *path, int plain, pzs_real *du)
{
    const uint32_t n = path->state.model->state.structure->free_dof;
    for (pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->prepare && !o->call->prepare(o, path))
            return 0;
    pzs_nonlinear_build(path, plain, du);
    prescribe_all(path, du);
    if (!pzs_nonlinear_factor(path))
        return 0;
    pzs_model_backsolve(path->state.model, du, du);
    path->info.linear_solves++;
    if (!pzs_nonlinear_condense(path, NEWTON, du) || pzs_guard_nonfinite(du, n) >= 0)
        return 0;
    for (pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->solved)
            o->call->solved(o, path, du);
    extrapolate(path, du);
    for (uint32_t i = 0; i < n; i++)
        path->state.displacement[i] += du[i];
    return 1;
}

/* ---- one load step ---------------------------------------------------- */

/* The error of an option that has not settled, or PZS_OK. */
static pzs_status options_open(pzs_solver *path)
{
    pzs_status open = PZS_OK;
    for (pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->settled && !o->call->settled(o, path))
            open = o->call->unsettled;
    return open;
}

/* Force of actuation at path->u onto f. */
static void add_actuation(const pzs_solver *path, pzs_real *f)
{
    const pzs_structure *s = path->state.model->state.structure;
    for (uint32_t e = 0; e < s->elements; e++) {
        pzs_real u[SHELL_MAX], force[SHELL_MAX], resultant[SHELL_RESULTANTS] = {0};
        memcpy(resultant, path->state.prescribed[e], sizeof path->state.prescribed[e]);
        pzs_model_gather(path->state.model, s->element[e], SHELL_NODES, path->state.displacement,
                         u);
        pzs_shell_force_at(&s->type[s->element_type[e]], s->dof_per_node, u, resultant, force);
        pzs_model_scatter(path->state.model, s->element[e], SHELL_NODES,
                          -pzs_model_type_factor(path->state.model, e), force, f);
    }
}

/* Imbalances of a displacement by rounding are below this part of it, scaled rows. */
#define ROUNDING (256 * PZS_EPSILON)

/*
 * Tangent and residual at path->u, factored; the resultants become the true ones. Returns whether
 * all is finite. next [dof] out the increment that Newton's method would make from here
 */
static int judge(pzs_solver *path, pzs_real *next)
{
    pzs_model *model = path->state.model;
    const uint32_t n = model->state.structure->free_dof;
    pzs_real *applied = model->state.work + n;
    pzs_nonlinear_build(path, 1, next);
    memcpy(applied, path->state.load, n * sizeof *applied);
    add_actuation(path, applied);
    const pzs_real load2 = pzs_model_scaled_norm2(model, applied),
                   reaction2 = prescribe_all(path, next);
    const pzs_real left2 = pzs_model_scaled_norm2(model, next);
    path->info.residual =
        load2 + reaction2 > 0 ? PZS_SQRT(left2 / (load2 + reaction2)) : PZS_SQRT(left2);
    path->state.is_balanced =
        path->info.residual <= 1 ||
        left2 <= ROUNDING * ROUNDING * pzs_nonlinear_norm2(path, path->state.displacement, NULL);
    extrapolate(path, NULL);
    if (!pzs_nonlinear_factor(path))
        return 0;
    pzs_model_backsolve(model, next, next);
    return pzs_nonlinear_condense(path, NEWTON, next) && pzs_guard_nonfinite(next, n) < 0 &&
           pzs_guard_nonfinite(&path->info.residual, 1) < 0;
}

/* Whether an iteration is worth going on: near its end it gets twice the systems; one that moves as
 * far as the whole step four times in a row is lost. */
static int hopeful(const pzs_solver *path, uint32_t wild)
{
    return wild < 4 &&
           path->state.iteration <
               (path->info.relative_increment < (pzs_real)0.01 ? 2 * STEP_SYSTEMS : STEP_SYSTEMS);
}

/*
 * Newton's method at the present amounts: settled when the last increment is below `change` of the
 * step's displacement, and so is the next one that the tangent at the shape reached would make, and
 * the forces left over are no larger than those applied, or rounding. Returns whether it settled;
 * if only an option did not, path->open is its error. A step that moves less than a thousandth of
 * the whole displacement (a tenth in float, whose round-off it would be) is judged by that.
 */
static int settle(pzs_solver *path)
{
    const pzs_real least = PZS_BY_BITS((pzs_real)1e-2, (pzs_real)1e-6),
                   limit2 = path->settings.tolerance * path->settings.tolerance;
    pzs_real *du = path->state.model->state.work;
    uint32_t wild = 0;
    path->info.relative_increment = 1;
    path->state.pending_error = 0;
    path->info.where = -1;
    for (path->state.iteration = 0; hopeful(path, wild); path->state.iteration++) {
        if (path->info.linear_solves >= path->settings.solve_limit ||
            !move(path, path->state.iteration >= path->settings.extrapolated_iterations, du))
            return 0;
        const pzs_real moved2 =
            pzs_nonlinear_norm2(path, path->state.displacement, path->state.kept_displacement) +
            least * pzs_nonlinear_norm2(path, path->state.displacement, NULL);
        const pzs_real last2 = pzs_nonlinear_norm2(path, du, NULL);
        path->info.relative_increment = moved2 > 0 ? PZS_SQRT(last2 / moved2) : 0;
        wild = path->state.iteration > 2 && path->info.relative_increment > (pzs_real)0.9 ? wild + 1
                                                                                          : 0;
        if (!(last2 <= limit2 * moved2))
            continue;
        path->state.pending_error = (uint8_t)options_open(path);
        if (!path->state.pending_error && judge(path, du) && path->state.is_balanced &&
            pzs_nonlinear_norm2(path, du, NULL) <= limit2 * moved2)
            return 1;
    }
    return 0;
}

/* ---- the way ---------------------------------------------------------- */

static void keep(pzs_solver *path)
{
    const pzs_structure *s = path->state.model->state.structure;
    memcpy(path->state.kept_displacement, path->state.displacement,
           s->free_dof * sizeof *path->state.displacement);
    memcpy(path->state.kept_input_value, path->state.input_value,
           s->input.count * sizeof *path->state.input_value);
    memcpy(path->state.kept_resultant, path->state.resultant,
           s->elements * sizeof *path->state.resultant);
    for (pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->keep)
            o->call->keep(o, path);
}

static void restore(pzs_solver *path)
{
    const pzs_structure *s = path->state.model->state.structure;
    memcpy(path->state.displacement, path->state.kept_displacement,
           s->free_dof * sizeof *path->state.displacement);
    memcpy(path->state.input_value, path->state.kept_input_value,
           s->input.count * sizeof *path->state.input_value);
    memcpy(path->state.resultant, path->state.kept_resultant,
           s->elements * sizeof *path->state.resultant);
    pzs_nonlinear_set_given(path);
    for (pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->restore)
            o->call->restore(o, path);
}

/* Do all options let the settled shape stand? Otherwise path->refused is the error of the first
 * that does not. */
static int is_accepted(pzs_solver *path)
{
    path->state.warned = 0;
    for (pzs_solver_option *o = path->state.option; o; o = o->next) {
        const pzs_status status = o->call->refuses ? o->call->refuses(o, path) : PZS_OK;
        if (PZS_IS_ERROR(status)) {
            path->state.refused = (uint8_t)status;
            return 0;
        }
        if (status != PZS_OK)
            path->state.warned = (uint8_t)status;
    }
    return 1;
}

/* One load step towards the amounts, by `part` of the way that is left. Returns whether it settled;
 * only then it is kept. */
static int step(pzs_solver *path, const pzs_real *amount, pzs_real part)
{
    const uint32_t inputs = path->state.model->state.structure->input.count;
    for (uint32_t j = 0; j < inputs; j++)
        path->state.input_value[j] = part < 1
                                         ? path->state.kept_input_value[j] +
                                               part * (amount[j] - path->state.kept_input_value[j])
                                         : amount[j];
    pzs_nonlinear_set_given(path);
    path->state.refused = 0;
    if (!settle(path) || !is_accepted(path))
        return 0;
    keep(path);
    path->info.load_steps++;
    return 1;
}

/* Why a step did not settle, by the state it ended with; negative: pivots of the last equilibrium.
 */
static pzs_status reason(const pzs_solver *path, uint32_t negative)
{
    if (path->state.refused)
        return (pzs_status)path->state.refused;
    for (const pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->adrift && o->call->adrift(o, path))
            return PZS_E_CONTACT;
    if (path->info.linear_solves >= path->settings.solve_limit)
        return PZS_E_SOLVES;
    if (path->state.pending_error)
        return (pzs_status)path->state.pending_error;
    return path->info.where >= 0 || path->info.negative_pivots != negative ? PZS_E_LIMIT
                                                                           : PZS_E_DIVERGED;
}

/* Largest part of the way to the amounts that all options let a load step take. */
static pzs_real longest_part(const pzs_solver *path, const pzs_real *amount)
{
    pzs_real part = 1;
    for (pzs_solver_option *o = path->state.option; o; o = o->next) {
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
static uint32_t next_stride(const pzs_solver *path, way *w, const pzs_real *amount, int *is_short)
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
static pzs_status follow(pzs_solver *path, const pzs_real *amount)
{
    const uint32_t first = 1u << MOST_CUTS;
    way w = {(uint32_t)path->settings.load_steps << MOST_CUTS, 0, first, first};
    uint32_t negative = path->info.negative_pivots;
    while (w.done < w.whole) {
        int is_short;
        const uint32_t take = next_stride(path, &w, amount, &is_short);
        if (take == 0)
            return PZS_E_SOLVES;
        if (step(path, amount, (pzs_real)take / (pzs_real)(w.whole - w.done))) {
            w.done += take;
            w.stride = w.stride < w.longest ? 2 * w.stride : w.stride;
            negative = path->info.negative_pivots;
            path->info.load_factor = (pzs_real)w.done / (pzs_real)w.whole;
            path->info.shortened_steps += (uint32_t)is_short;
            continue;
        }
        const pzs_status why = reason(path, negative);
        restore(path);
        if (w.stride == 1 || path->info.linear_solves >= path->settings.solve_limit)
            return why;
        w.stride /= 2;
    }
    if (path->state.warned)
        return (pzs_status)path->state.warned;
    return path->info.negative_pivots > 0 ? PZS_W_UNSTABLE : PZS_OK;
}

/* Are the choices such that a settled shape is one? */
static int choices_in_range(const pzs_solver *path)
{
    for (const pzs_solver_option *o = path->state.option; o; o = o->next)
        if (o->call->choices_in_range && !o->call->choices_in_range(o))
            return 0;
    return path->settings.load_steps > 0 && path->settings.tolerance > 0 &&
           path->settings.tolerance < 1;
}

pzs_status pzs_equilibrium(pzs_solver *path, const pzs_real *amount)
{
    if (!path || !amount)
        return PZS_E_ARGUMENT;
    if (path->state.stage < PATH_READY)
        return fail(path, PZS_E_STAGE, -1);
    if (!choices_in_range(path))
        return fail(path, PZS_E_ARGUMENT, -1);
    const int32_t bad =
        pzs_guard_nonfinite(amount, path->state.model->state.structure->input.count);
    if (bad >= 0)
        return fail(path, PZS_E_NONFINITE, bad);
    path->info.linear_solves = 0;
    path->info.load_steps = 0;
    path->info.shortened_steps = 0;
    path->state.refused = 0;
    path->state.warned = 0;
    path->state.refused_at = -1;
    path->info.load_factor = 0;
    path->state.stage = PATH_READY;
    const pzs_status status = follow(path, amount);
    if (!PZS_IS_ERROR(status) || judge(path, path->state.model->state.work)) {
        path->state.stage = PATH_SETTLED;
        path->state.model->state.stage = STAGE_AT_SHAPE;
    }
    const int is_refused = PZS_IS_ERROR(status) && status == (pzs_status)path->state.refused;
    return fail(path, status, is_refused ? path->state.refused_at : -1);
}

#endif
