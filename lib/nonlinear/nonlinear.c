/* Equilibrium at large rotation by Newton's method with independent resultants (pzs.h). */
#include "nonlinear.h"
#include "../core/guard.h"
#include "../core/linalg.h"
#include "../model/model.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

enum { STEP_SYSTEMS = 40, MOST_CUTS = 6 }; /* systems of a step, halvings of the first */

static pzs_status fail(pzs_solver *solver, pzs_status status, int32_t where)
{
    solver->info.where = where;
    return status;
}

/* ---- init ------------------------------------------------------------- */

uint32_t pzs_nonlinear_crc(const pzs_nonlinear *tables, const pzs_structure *structure)
{
    const uint32_t inputs = structure->input.count,
                   entries = tables->given.start ? tables->given.start[inputs] : 0;
    uint32_t crc = GUARD_CRC_START;
    if (entries > inputs * structure->elements || tables->given.values > entries ||
        tables->prescribed.count > structure->free_dof)
        return crc; /* damaged: not to be led astray by it */
    if (entries > 0) {
        crc = pzs_guard_crc(crc, tables->given.start, (inputs + 1) * sizeof *tables->given.start);
        crc = pzs_guard_crc(crc, tables->given.element, entries * sizeof *tables->given.element);
        crc = pzs_guard_crc(crc, tables->given.which, entries * sizeof *tables->given.which);
        crc = pzs_guard_crc(crc, tables->given.value,
                            tables->given.values * sizeof *tables->given.value);
    }
    if (tables->prescribed.count > 0) {
        crc = pzs_guard_crc(crc, &tables->prescribed.input, sizeof tables->prescribed.input);
        crc = pzs_guard_crc(crc, tables->prescribed.dof,
                            tables->prescribed.count * sizeof *tables->prescribed.dof);
        crc = pzs_guard_crc(crc, tables->prescribed.value,
                            tables->prescribed.count * sizeof *tables->prescribed.value);
    }
    return ~crc;
}

static int tables_in_range(const pzs_nonlinear *tables, const pzs_structure *structure)
{
    const uint32_t inputs = structure->input.count,
                   entries = tables->given.start ? tables->given.start[inputs] : 0;
    for (uint32_t j = 0; entries > 0 && j < inputs; j++)
        if (tables->given.start[j] > tables->given.start[j + 1])
            return 0;
    for (uint32_t i = 0; i < entries; i++)
        if (tables->given.element[i] >= structure->elements ||
            tables->given.which[i] >= tables->given.values)
            return 0;
    for (uint32_t i = 0; i < tables->prescribed.count; i++)
        if (tables->prescribed.dof[i] >= structure->free_dof)
            return 0;
    return tables->prescribed.count == 0 || tables->prescribed.input < inputs;
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

pzs_status pzs_solver_init(pzs_solver *solver, pzs_model *model, const pzs_nonlinear *tables,
                           void *work, size_t bytes)
{
    if (!solver || !model || !tables || !work || model->state.stage < STAGE_READY ||
        !model->state.structure->type)
        return PZS_E_ARGUMENT;
    const pzs_structure *structure = model->state.structure;
    memset(solver, 0, sizeof *solver);
    solver->info.where = -1;
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != structure->scene)
        return PZS_E_FORMAT;
    if (pzs_nonlinear_crc(tables, structure) != tables->crc)
        return PZS_E_CRC;
    if (!tables_in_range(tables, structure))
        return PZS_E_ARGUMENT;
    const int32_t lacking = guard_missing_bytes(
        work, bytes,
        PZS_SOLVER_BYTES(structure->free_dof, structure->elements, structure->input.count));
    if (lacking >= 0)
        return fail(solver, PZS_E_WORKSPACE, lacking);
    const int32_t loose = scale_at_rest(model);
    if (loose >= 0)
        return fail(solver, PZS_E_LOOSE, loose);

    pzs_real *real = work;
    solver->state.model = model;
    solver->state.tables = tables;
    solver->state.displacement = real;
    solver->state.kept_displacement = solver->state.displacement + structure->free_dof;
    solver->state.load = solver->state.kept_displacement + structure->free_dof;
    solver->state.input_value = solver->state.load + structure->free_dof;
    solver->state.kept_input_value = solver->state.input_value + structure->input.count;
    solver->state.resultant =
        (pzs_real(*)[SHELL_RESULTANTS])(solver->state.kept_input_value + structure->input.count);
    solver->state.kept_resultant = solver->state.resultant + structure->elements;
    solver->state.prescribed =
        (pzs_real(*)[SHELL_STRAINS])(solver->state.kept_resultant + structure->elements);
    solver->info.displacement = solver->state.displacement;
    solver->info.input_value = solver->state.input_value;
    solver->settings.tolerance = (pzs_real)1e-4;
    solver->settings.load_steps = 1;
    solver->settings.extrapolated_iterations = 12;
    solver->settings.solve_limit = 400;
    pzs_solver_reset(solver);
    return PZS_OK;
}

void pzs_solver_reset(pzs_solver *solver)
{
    if (!solver || !solver->state.model)
        return;
    const pzs_structure *structure = solver->state.model->state.structure;
    memset(solver->state.kept_displacement, 0,
           structure->free_dof * sizeof *solver->state.displacement);
    memset(solver->state.kept_input_value, 0,
           structure->input.count * sizeof *solver->state.input_value);
    memset(solver->state.kept_resultant, 0, structure->elements * sizeof *solver->state.resultant);
    memcpy(solver->state.displacement, solver->state.kept_displacement,
           structure->free_dof * sizeof *solver->state.displacement);
    memcpy(solver->state.input_value, solver->state.kept_input_value,
           structure->input.count * sizeof *solver->state.input_value);
    memcpy(solver->state.resultant, solver->state.kept_resultant,
           structure->elements * sizeof *solver->state.resultant);
    memset(solver->state.prescribed, 0, structure->elements * sizeof *solver->state.prescribed);
    solver->info.negative_pivots = 0;
    solver->info.load_factor = 0;
    solver->info.residual = 0;
    solver->state.stage = PATH_READY;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->rest)
            option->call->rest(option, solver);
}

int pzs_nonlinear_is_attached(const pzs_solver *solver, const pzs_solver_option *option)
{
    const pzs_solver_option *o = solver->state.option;
    while (o && o != option)
        o = o->next;
    return o != NULL;
}

void pzs_nonlinear_attach(pzs_solver *solver, pzs_solver_option *option,
                          const struct pzs_solver_option_calls *call)
{
    option->call = call;
    option->next = solver->state.option;
    solver->state.option = option;
    solver->state.stage = PATH_READY;
}

/* ---- inputs ----------------------------------------------------------- */

void pzs_nonlinear_set_given(pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_prescribed_resultants *g = &solver->state.tables->given;
    memset(solver->state.prescribed, 0, structure->elements * sizeof *solver->state.prescribed);
    for (uint32_t j = 0; g->start && j < structure->input.count; j++)
        for (uint32_t t = g->start[j]; solver->state.input_value[j] != 0 && t < g->start[j + 1];
             t++) {
            const pzs_real factor = pzs_model_type_factor(solver->state.model, g->element[t]);
            for (int i = 0; factor > 0 && i < SHELL_STRAINS; i++)
                solver->state.prescribed[g->element[t]][i] +=
                    solver->state.input_value[j] / factor * g->value[g->which[t]][i];
        }
}

static int is_given(const pzs_solver *solver, uint32_t input)
{
    const uint32_t *start = solver->state.tables->given.start;
    return start && start[input + 1] > start[input];
}

void pzs_nonlinear_unit_force(pzs_solver *solver, uint32_t input, pzs_real *force)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_prescribed_resultants *g = &solver->state.tables->given;
    const int given = is_given(solver, input);
    if (!given)
        pzs_model_add_input(solver->state.model, input, 1, force);
    for (uint32_t t = given ? g->start[input] : 0; given && t < g->start[input + 1]; t++) {
        const uint16_t *node = structure->element[g->element[t]];
        pzs_real u[SHELL_MAX], f[SHELL_MAX], resultant[SHELL_RESULTANTS] = {0};
        memcpy(resultant, g->value[g->which[t]], SHELL_STRAINS * sizeof *resultant);
        pzs_model_gather(solver->state.model, node, SHELL_NODES, solver->state.displacement, u);
        pzs_shell_force_at(&structure->type[structure->element_type[g->element[t]]],
                           structure->dof_per_node, u, resultant, f);
        pzs_model_scatter(solver->state.model, node, SHELL_NODES, -1, f, force);
    }
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->unit)
            option->call->unit(option, solver, input, force);
}

/* ---- one system ------------------------------------------------------- */

void pzs_nonlinear_build(pzs_solver *solver, int plain, pzs_real *imbalance)
{
    pzs_model *model = solver->state.model;
    const pzs_structure *structure = model->state.structure;
    pzs_linalg_clear(&model->state.stiffness);
    model->state.stage = STAGE_READY;
    memset(solver->state.load, 0, structure->free_dof * sizeof *solver->state.load);
    memset(imbalance, 0, structure->free_dof * sizeof *imbalance);
    for (uint32_t e = 0; e < structure->elements; e++) {
        const pzs_real factor = pzs_model_type_factor(model, e);
        pzs_real u[SHELL_MAX], f[SHELL_MAX], k[SHELL_PACKED(SHELL_MAX)];
        pzs_model_gather(model, structure->element[e], SHELL_NODES, solver->state.displacement, u);
        pzs_shell_system(&structure->type[structure->element_type[e]], structure->dof_per_node, u,
                         solver->state.prescribed[e], plain ? NULL : solver->state.resultant[e], f,
                         k);
        pzs_model_add_matrix(model, structure->element[e], SHELL_NODES, factor, k);
        pzs_model_scatter(model, structure->element[e], SHELL_NODES, -factor, f, imbalance);
    }
    for (uint32_t i = 0; model->state.constrained && i < structure->free_dof; i++)
        if (model->state.constrained[i])
            *pzs_linalg_entry(&model->state.stiffness, i, i) = 1;
    for (uint32_t j = 0; j < structure->input.count; j++)
        if (solver->state.input_value[j] != 0 && !is_given(solver, j))
            pzs_model_add_input(model, j, solver->state.input_value[j], solver->state.load);
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->add)
            option->call->add(option, solver, solver->state.load);
    for (uint32_t i = 0; i < structure->free_dof; i++)
        imbalance[i] += solver->state.load[i];
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

void pzs_nonlinear_clear_prescribed(const pzs_solver *solver, pzs_real *f)
{
    const pzs_prescribed_motion *p = &solver->state.tables->prescribed;
    for (uint32_t i = 0; i < p->count; i++)
        f[p->dof[i]] = 0;
}

/* Move the prescribed unknowns in b; what held them back, its scaled square, is returned. */
static pzs_real prescribe_all(pzs_solver *solver, pzs_real *b)
{
    const pzs_prescribed_motion *p = &solver->state.tables->prescribed;
    pzs_real reaction = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        const pzs_real scaled = solver->state.model->state.scale[p->dof[i]] * b[p->dof[i]];
        reaction += scaled * scaled;
    }
    for (uint32_t i = 0; i < p->count; i++)
        pzs_nonlinear_prescribe(&solver->state.model->state.stiffness, p->dof[i],
                                solver->state.input_value[p->input] * p->value[i] -
                                    solver->state.displacement[p->dof[i]],
                                b);
    return reaction;
}

int pzs_nonlinear_factor(pzs_solver *solver)
{
    pzs_linalg_apply_scale(&solver->state.model->state.stiffness, solver->state.model->state.scale);
    const linalg_inertia inertia = pzs_linalg_factor(&solver->state.model->state.stiffness);
    solver->info.negative_pivots = inertia.negative;
    solver->info.where = inertia.zero;
    return inertia.zero < 0;
}

pzs_real pzs_nonlinear_norm2(const pzs_solver *solver, const pzs_real *x, const pzs_real *y)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_real h = structure->type[0].thickness;
    pzs_real sum = 0;
    for (uint32_t i = 0; i < (uint32_t)structure->nodes * structure->dof_per_node; i++) {
        const uint16_t dof = structure->node_dof[i];
        if (dof == PZS_CONSTRAINED)
            continue;
        const pzs_real size =
            (x[dof] - (y ? y[dof] : 0)) * (i % structure->dof_per_node < 3 ? 1 : h);
        sum += size * size;
    }
    return sum;
}

static void extrapolate(pzs_solver *solver, const pzs_real *du)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    for (uint32_t e = 0; e < structure->elements; e++) {
        pzs_real u[SHELL_MAX], d[SHELL_MAX];
        pzs_model_gather(solver->state.model, structure->element[e], SHELL_NODES,
                         solver->state.displacement, u);
        if (du)
            pzs_model_gather(solver->state.model, structure->element[e], SHELL_NODES, du, d);
        pzs_shell_resultants(&structure->type[structure->element_type[e]], structure->dof_per_node,
                             u, du ? d : NULL, solver->state.prescribed[e],
                             solver->state.resultant[e]);
    }
}

int pzs_nonlinear_condense(pzs_solver *solver, uint32_t input, pzs_real *du)
{
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->condense && !option->call->condense(option, solver, input, du))
            return 0;
    return 1;
}

/* Solve one system and move. du [dof] out. Returns 0 where it cannot be done. */
static int move(pzs_solver *solver, int plain, pzs_real *du)
{
    const uint32_t n = solver->state.model->state.structure->free_dof;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->prepare && !option->call->prepare(option, solver))
            return 0;
    pzs_nonlinear_build(solver, plain, du);
    prescribe_all(solver, du);
    if (!pzs_nonlinear_factor(solver))
        return 0;
    pzs_model_backsolve(solver->state.model, du, du);
    solver->info.linear_solves++;
    if (!pzs_nonlinear_condense(solver, NEWTON, du) || pzs_guard_nonfinite(du, n) >= 0)
        return 0;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->solved)
            option->call->solved(option, solver, du);
    extrapolate(solver, du);
    for (uint32_t i = 0; i < n; i++)
        solver->state.displacement[i] += du[i];
    return 1;
}

/* ---- one load step ---------------------------------------------------- */

/* The error of an option that has not settled, or PZS_OK. */
static pzs_status options_open(pzs_solver *solver)
{
    pzs_status open = PZS_OK;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->settled && !option->call->settled(option, solver))
            open = option->call->unsettled;
    return open;
}

/* Force of actuation at path->u onto f. */
static void add_actuation(const pzs_solver *solver, pzs_real *f)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    for (uint32_t e = 0; e < structure->elements; e++) {
        pzs_real u[SHELL_MAX], force[SHELL_MAX], resultant[SHELL_RESULTANTS] = {0};
        memcpy(resultant, solver->state.prescribed[e], sizeof solver->state.prescribed[e]);
        pzs_model_gather(solver->state.model, structure->element[e], SHELL_NODES,
                         solver->state.displacement, u);
        pzs_shell_force_at(&structure->type[structure->element_type[e]], structure->dof_per_node, u,
                           resultant, force);
        pzs_model_scatter(solver->state.model, structure->element[e], SHELL_NODES,
                          -pzs_model_type_factor(solver->state.model, e), force, f);
    }
}

/* Imbalances of a displacement by rounding are below this part of it, scaled rows. */
#define ROUNDING (256 * PZS_EPSILON)

/*
 * Tangent and residual at path->u, factored; the resultants become the true ones. Returns whether
 * all is finite. next [dof] out the increment that Newton's method would make from here
 */
static int judge(pzs_solver *solver, pzs_real *next)
{
    pzs_model *model = solver->state.model;
    const uint32_t n = model->state.structure->free_dof;
    pzs_real *applied = model->state.work + n;
    pzs_nonlinear_build(solver, 1, next);
    memcpy(applied, solver->state.load, n * sizeof *applied);
    add_actuation(solver, applied);
    const pzs_real load2 = pzs_model_scaled_norm2(model, applied),
                   reaction2 = prescribe_all(solver, next);
    const pzs_real left2 = pzs_model_scaled_norm2(model, next);
    solver->info.residual =
        load2 + reaction2 > 0 ? PZS_SQRT(left2 / (load2 + reaction2)) : PZS_SQRT(left2);
    solver->state.is_balanced =
        solver->info.residual <= 1 ||
        left2 <=
            ROUNDING * ROUNDING * pzs_nonlinear_norm2(solver, solver->state.displacement, NULL);
    extrapolate(solver, NULL);
    if (!pzs_nonlinear_factor(solver))
        return 0;
    pzs_model_backsolve(model, next, next);
    return pzs_nonlinear_condense(solver, NEWTON, next) && pzs_guard_nonfinite(next, n) < 0 &&
           pzs_guard_nonfinite(&solver->info.residual, 1) < 0;
}

/* Whether an iteration is worth going on: near its end it gets twice the systems; one that moves as
 * far as the whole step four times in a row is lost. */
static int hopeful(const pzs_solver *solver, uint32_t wild)
{
    return wild < 4 &&
           solver->state.iteration <
               (solver->info.relative_increment < (pzs_real)0.01 ? 2 * STEP_SYSTEMS : STEP_SYSTEMS);
}

/*
 * Newton's method at the present amounts: settled when the last increment is below `change` of the
 * step's displacement, and so is the next one that the tangent at the shape reached would make, and
 * the forces left over are no larger than those applied, or rounding. Returns whether it settled;
 * if only an option did not, path->open is its error. A step that moves less than a thousandth of
 * the whole displacement (a tenth in float, whose round-off it would be) is judged by that.
 */
static int settle(pzs_solver *solver)
{
    const pzs_real least = PZS_BY_BITS((pzs_real)1e-2, (pzs_real)1e-6),
                   limit2 = solver->settings.tolerance * solver->settings.tolerance;
    pzs_real *du = solver->state.model->state.work;
    uint32_t wild = 0;
    solver->info.relative_increment = 1;
    solver->state.pending_error = 0;
    solver->info.where = -1;
    for (solver->state.iteration = 0; hopeful(solver, wild); solver->state.iteration++) {
        if (solver->info.linear_solves >= solver->settings.solve_limit ||
            !move(solver, solver->state.iteration >= solver->settings.extrapolated_iterations, du))
            return 0;
        const pzs_real moved2 =
            pzs_nonlinear_norm2(solver, solver->state.displacement,
                                solver->state.kept_displacement) +
            least * pzs_nonlinear_norm2(solver, solver->state.displacement, NULL);
        const pzs_real last2 = pzs_nonlinear_norm2(solver, du, NULL);
        solver->info.relative_increment = moved2 > 0 ? PZS_SQRT(last2 / moved2) : 0;
        wild = solver->state.iteration > 2 && solver->info.relative_increment > (pzs_real)0.9
                   ? wild + 1
                   : 0;
        if (!(last2 <= limit2 * moved2))
            continue;
        solver->state.pending_error = (uint8_t)options_open(solver);
        if (!solver->state.pending_error && judge(solver, du) && solver->state.is_balanced &&
            pzs_nonlinear_norm2(solver, du, NULL) <= limit2 * moved2)
            return 1;
    }
    return 0;
}

/* ---- the way ---------------------------------------------------------- */

static void keep(pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    memcpy(solver->state.kept_displacement, solver->state.displacement,
           structure->free_dof * sizeof *solver->state.displacement);
    memcpy(solver->state.kept_input_value, solver->state.input_value,
           structure->input.count * sizeof *solver->state.input_value);
    memcpy(solver->state.kept_resultant, solver->state.resultant,
           structure->elements * sizeof *solver->state.resultant);
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->keep)
            option->call->keep(option, solver);
}

static void restore(pzs_solver *solver)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    memcpy(solver->state.displacement, solver->state.kept_displacement,
           structure->free_dof * sizeof *solver->state.displacement);
    memcpy(solver->state.input_value, solver->state.kept_input_value,
           structure->input.count * sizeof *solver->state.input_value);
    memcpy(solver->state.resultant, solver->state.kept_resultant,
           structure->elements * sizeof *solver->state.resultant);
    pzs_nonlinear_set_given(solver);
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->restore)
            option->call->restore(option, solver);
}

/* Do all options let the settled shape stand? Otherwise path->refused is the error of the first
 * that does not. */
static int is_accepted(pzs_solver *solver)
{
    solver->state.warned = 0;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next) {
        const pzs_status status =
            option->call->refuses ? option->call->refuses(option, solver) : PZS_OK;
        if (PZS_IS_ERROR(status)) {
            solver->state.refused = (uint8_t)status;
            return 0;
        }
        if (status != PZS_OK)
            solver->state.warned = (uint8_t)status;
    }
    return 1;
}

/* One load step towards the amounts, by `part` of the way that is left. Returns whether it settled;
 * only then it is kept. */
static int step(pzs_solver *solver, const pzs_real *amount, pzs_real part)
{
    const uint32_t inputs = solver->state.model->state.structure->input.count;
    for (uint32_t j = 0; j < inputs; j++)
        solver->state.input_value[j] =
            part < 1 ? solver->state.kept_input_value[j] +
                           part * (amount[j] - solver->state.kept_input_value[j])
                     : amount[j];
    pzs_nonlinear_set_given(solver);
    solver->state.refused = 0;
    if (!settle(solver) || !is_accepted(solver))
        return 0;
    keep(solver);
    solver->info.load_steps++;
    return 1;
}

/* Why a step did not settle, by the state it ended with; negative: pivots of the last equilibrium.
 */
static pzs_status reason(const pzs_solver *solver, uint32_t negative)
{
    if (solver->state.refused)
        return (pzs_status)solver->state.refused;
    for (const pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->adrift && option->call->adrift(option, solver))
            return PZS_E_CONTACT;
    if (solver->info.linear_solves >= solver->settings.solve_limit)
        return PZS_E_SOLVES;
    if (solver->state.pending_error)
        return (pzs_status)solver->state.pending_error;
    return solver->info.where >= 0 || solver->info.negative_pivots != negative ? PZS_E_LIMIT
                                                                               : PZS_E_DIVERGED;
}

/* Largest part of the way to the amounts that all options let a load step take. */
static pzs_real longest_part(const pzs_solver *solver, const pzs_real *amount)
{
    pzs_real part = 1;
    for (pzs_solver_option *option = solver->state.option; option; option = option->next) {
        const pzs_real most =
            option->call->longest ? option->call->longest(option, solver, amount) : 1;
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
static uint32_t next_stride(const pzs_solver *solver, way *w, const pzs_real *amount, int *is_short)
{
    const pzs_real part = longest_part(solver, amount);
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
static pzs_status follow(pzs_solver *solver, const pzs_real *amount)
{
    const uint32_t first = 1u << MOST_CUTS;
    way w = {(uint32_t)solver->settings.load_steps << MOST_CUTS, 0, first, first};
    uint32_t negative = solver->info.negative_pivots;
    while (w.done < w.whole) {
        int is_short;
        const uint32_t take = next_stride(solver, &w, amount, &is_short);
        if (take == 0)
            return PZS_E_SOLVES;
        if (step(solver, amount, (pzs_real)take / (pzs_real)(w.whole - w.done))) {
            w.done += take;
            w.stride = w.stride < w.longest ? 2 * w.stride : w.stride;
            negative = solver->info.negative_pivots;
            solver->info.load_factor = (pzs_real)w.done / (pzs_real)w.whole;
            solver->info.shortened_steps += (uint32_t)is_short;
            continue;
        }
        const pzs_status why = reason(solver, negative);
        restore(solver);
        if (w.stride == 1 || solver->info.linear_solves >= solver->settings.solve_limit)
            return why;
        w.stride /= 2;
    }
    if (solver->state.warned)
        return (pzs_status)solver->state.warned;
    return solver->info.negative_pivots > 0 ? PZS_W_UNSTABLE : PZS_OK;
}

/* Are the choices such that a settled shape is one? */
static int choices_in_range(const pzs_solver *solver)
{
    for (const pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->choices_in_range && !option->call->choices_in_range(option))
            return 0;
    return solver->settings.load_steps > 0 && solver->settings.tolerance > 0 &&
           solver->settings.tolerance < 1;
}

pzs_status pzs_equilibrium(pzs_solver *solver, const pzs_real *amount)
{
    if (!solver || !amount)
        return PZS_E_ARGUMENT;
    if (solver->state.stage < PATH_READY)
        return fail(solver, PZS_E_STAGE, -1);
    if (!choices_in_range(solver))
        return fail(solver, PZS_E_ARGUMENT, -1);
    const int32_t bad =
        pzs_guard_nonfinite(amount, solver->state.model->state.structure->input.count);
    if (bad >= 0)
        return fail(solver, PZS_E_NONFINITE, bad);
    solver->info.linear_solves = 0;
    solver->info.load_steps = 0;
    solver->info.shortened_steps = 0;
    solver->state.refused = 0;
    solver->state.warned = 0;
    solver->state.refused_at = -1;
    solver->info.load_factor = 0;
    solver->state.stage = PATH_READY;
    const pzs_status status = follow(solver, amount);
    if (!PZS_IS_ERROR(status) || judge(solver, solver->state.model->state.work)) {
        solver->state.stage = PATH_SETTLED;
        solver->state.model->state.stage = STAGE_AT_SHAPE;
    }
    const int is_refused = PZS_IS_ERROR(status) && status == (pzs_status)solver->state.refused;
    return fail(solver, status, is_refused ? solver->state.refused_at : -1);
}

#endif
