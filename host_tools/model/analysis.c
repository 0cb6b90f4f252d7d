/* A scene run through the library (analysis.h). */
#define _POSIX_C_SOURCE 200809L
#include "analysis.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "../../lib/model/electrode.h"
#include "electrodes.h"
#include "../../lib/core/guard.h"
#include "../../lib/core/linalg.h"
#include "../../lib/model/model.h"

static const char *const unknown_name[7] = {
    "mean u1", "mean u2", "mean u3", "difference u1", "difference u2", "difference u3", "u3M"};

double analysis_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- structure -------------------------------------------------------- */

int analysis_explain(const analysis *a, pzs_status status, char *error)
{
    const mesh *m = &a->design.mesh;
    const scene *s = a->design.scene;
    if (status == PZS_E_LOOSE || status == PZS_E_NEGATIVE)
        for (int n = 0; n < m->nodes; n++)
            for (unsigned i = 0; i < m->unknowns; i++)
                if (m->node_dof[(size_t)n * m->unknowns + i] == a->model.info.where)
                    return scene_fault(
                        s, s->at_surface, error,
                        "%s: %s at node theta1 = %g, theta2 = %g; add supports that stop every rigid motion",
                        pzs_status_text(status), unknown_name[i], m->theta[n][0], m->theta[n][1]);
    if (status == PZS_E_CONDITION)
        return scene_fault(
            s, s->at_surface, error,
            "%s: condition %.2g; supports may leave a motion free, or the shell is too thin",
            pzs_status_text(status), a->model.info.condition);
    return scene_fault(s, s->at_surface, error, "%s", pzs_status_text(status));
}

/* Assemble and factor the stiffness at rest, unless that is what the model holds. */
static pzs_status at_rest(analysis *a)
{
    if (a->model.state.stage == STAGE_FACTORED)
        return PZS_OK;
    const double begin = analysis_now();
    pzs_status status = pzs_assemble(&a->model, NULL, NULL);
    const double assembled = analysis_now();
    if (status == PZS_OK)
        status = pzs_factor(&a->model);
    a->seconds.assemble = assembled - begin;
    a->seconds.factor = analysis_now() - assembled;
    return status == PZS_OK && a->electric.state.model ? pzs_electric_factor(&a->electric) : status;
}

static pzs_status open_electrodes(analysis *a)
{
    const pzs_electrodes *t = &a->design.electrodes;
    const uint16_t inputs = a->design.structure.input.count;
    const size_t bytes = PZS_ELECTRIC_BYTES(t->count, t->count, inputs);
    a->amount = calloc(inputs + 1u, sizeof *a->amount);
    a->charge = calloc(t->count + 1u, sizeof *a->charge);
    a->electric_work = malloc(bytes);
    if (!a->amount || !a->charge || !a->electric_work)
        return PZS_E_WORKSPACE;
    return t->count > 0 ? pzs_electric_init(&a->electric, &a->model, t, a->electric_work, bytes)
                        : PZS_OK;
}

int analysis_prepare(analysis *a, const scene *s, char *error)
{
    memset(a, 0, sizeof *a);
    if (design_build(&a->design, s, error) < 0)
        return -1;
    const pzs_structure *structure = &a->design.structure;
    a->work_bytes = PZS_MODEL_BYTES(structure->free_dof,
                                    pzs_linalg_reals(structure->first_column, structure->free_dof));
    a->work = malloc(a->work_bytes);
    pzs_status status =
        a->work ? pzs_model_init(&a->model, structure, a->work, a->work_bytes) : PZS_E_WORKSPACE;
    if (status == PZS_OK && a->design.mesh.prescribed_count > 0 &&
        s->kinematics == KINEMATICS_LINEAR) {
        scene_fault(s, s->support[0].at, error,
                    "a support with a value needs kinematics: nonlinear");
        analysis_free(a);
        return -1;
    }
    if (status == PZS_OK)
        status = open_electrodes(a);
    if (status == PZS_OK)
        status = at_rest(a);
    a->nonlinear = s->kinematics == KINEMATICS_NONLINEAR;
    if (s->kinematics != KINEMATICS_LINEAR &&
        (status == PZS_OK || s->contact.given || a->design.mesh.prescribed_count > 0))
        status = path_open(&a->path, &a->design, &a->model);
    if (status == PZS_OK)
        return 0;
    analysis_explain(a, status, error);
    analysis_free(a);
    return -1;
}

int analysis_ended_early(const analysis *a)
{
    return a->status == PZS_E_DIVERGED || a->status == PZS_E_LIMIT || a->status == PZS_E_CONTACT ||
           a->status == PZS_E_PENETRATION || a->status == PZS_E_SOLVES;
}

/* What the nonlinear path met, in words; only errors fail. */
static int explain_path(const analysis *a, char *error)
{
    const pzs_solver *run = &a->path.run;
    const scene *s = a->design.scene;
    if (!PZS_IS_ERROR(a->status))
        return 0;
    if (a->status == PZS_E_PENETRATION) {
        char where[SCENE_ERROR];
        path_penetration(&a->path, a->status, where);
        return scene_fault(
            s, s->contact.at, error, "%s: %s (reached %.4g of the load in %u linear solves)",
            pzs_status_text(a->status), where, run->info.load_factor, run->info.linear_solves);
    }
    if (analysis_ended_early(a))
        return scene_fault(s, s->equilibrium.at.line ? s->equilibrium.at : s->at_surface, error,
                           "%s: reached %.4g of the load in %u systems, %u load step%s; "
                           "the last equilibrium has %u negative pivots",
                           pzs_status_text(a->status), run->info.load_factor,
                           run->info.linear_solves, run->info.load_steps,
                           run->info.load_steps == 1 ? "" : "s", run->info.negative_pivots);
    return analysis_explain(a, a->status, error);
}

int analysis_outputs(const analysis *a, int k)
{
    const int places = a->design.place_first[k + 1] - a->design.place_first[k];
    const scene_output *output = &a->design.scene->output[k];
    if (output->electric != ELECTRIC_NONE)
        return output->count;
    return places > 0 ? places : 1; /* the whole contact has no place and one value */
}

int analysis_output_node(const analysis *a, int k, int i)
{
    const int entry = a->design.place_first[k] + i;
    return entry < a->design.place_first[k + 1] ? a->design.place_node[entry] : -1;
}

void analysis_output_electrode(const analysis *a, int k, int i, char name[SCENE_LABEL])
{
    const scene_output *output = &a->design.scene->output[k];
    if (output->of_sensor)
        scene_sensor_name(a->design.scene, output->first + i, name);
    else
        scene_amplifier_name(a->design.scene, output->first + i, name);
}

double analysis_output(const analysis *a, int k, int i, const double *value)
{
    const scene_output *output = &a->design.scene->output[k];
    if (output->electric != ELECTRIC_NONE) {
        const int input = electrodes_input(&a->design, output, i);
        return output->electric == ELECTRIC_VOLTAGE ? a->amount[input]
                                                    : a->charge[electrodes_of(&a->design, input)];
    }
    if (output->contact == CONTACT_NONE)
        return value[a->design.named_first[k] + i];
    return path_contact_output(&a->path, output, analysis_output_node(a, k, i));
}

pzs_status analysis_electrodes(analysis *a, const double *amount)
{
    memcpy(a->amount, a->nonlinear ? a->path.run.info.input_value : amount,
           a->design.structure.input.count * sizeof *a->amount);
    if (a->nonlinear)
        pzs_charges_at(&a->path.run, &a->design.electrodes, a->charge);
    if (a->nonlinear || !a->electric.state.model)
        return PZS_OK;
    const pzs_status status = pzs_open_voltages(&a->electric, a->amount);
    return status == PZS_OK ? pzs_charges(&a->electric, a->amount, a->charge) : status;
}

static pzs_status reach_nonlinear(analysis *a, const double *amount, int warm, double *u)
{
    pzs_solver *run = &a->path.run;
    const double begin = analysis_now();
    if (!warm)
        pzs_solver_reset(run);
    a->status = pzs_equilibrium(run, amount);
    a->seconds.solve = analysis_now() - begin;
    memcpy(u, run->info.displacement, (size_t)a->design.mesh.dof * sizeof *u);
    (void)analysis_electrodes(a, amount);
    return a->status;
}

static pzs_status reach_linear(analysis *a, const double *amount, double *u)
{
    a->status = at_rest(a);
    const double begin = analysis_now();
    if (a->status == PZS_OK)
        a->status = analysis_electrodes(a, amount);
    if (a->status == PZS_OK)
        a->status = pzs_solve(&a->model, a->amount, u);
    a->seconds.solve = analysis_now() - begin;
    return a->status;
}

int analysis_reach(analysis *a, const double *voltage, int warm, double *u, char *error)
{
    const design *d = &a->design;
    const size_t inputs = d->structure.input.count, amplifiers = (size_t)d->amplifiers;
    double *amount = calloc(inputs + 1, sizeof *amount);
    if (!amount)
        return analysis_explain(a, PZS_E_WORKSPACE, error);
    for (size_t k = 0; k < inputs; k++)
        amount[k] = k < amplifiers ? voltage[k]
                    : a->nonlinear ? a->path.full[k]
                                   : k < amplifiers + (size_t)d->loads;
    const pzs_status status =
        a->nonlinear ? reach_nonlinear(a, amount, warm, u) : reach_linear(a, amount, u);
    free(amount);
    return a->nonlinear       ? explain_path(a, error)
           : status == PZS_OK ? 0
                              : analysis_explain(a, status, error);
}

static int solve_applied(analysis *a, double *u, char *error)
{
    const design *d = &a->design;
    double *voltage = calloc((size_t)d->amplifiers + 1, sizeof *voltage);
    if (!voltage)
        return analysis_explain(a, PZS_E_WORKSPACE, error);
    design_applied(d, voltage);
    const int failed = analysis_reach(a, voltage, 0, u, error);
    free(voltage);
    return failed;
}

/* Difference of two displacements over the size of the second, every unknown by its stiffness. */
static double distance(const analysis *a, const double *x, const double *y)
{
    double apart = 0, size = 0;
    for (int i = 0; i < a->design.mesh.dof; i++) {
        apart += pow((x[i] - y[i]) / a->model.state.scale[i], 2);
        size += pow(y[i] / a->model.state.scale[i], 2);
    }
    return size > 0 ? sqrt(apart / size) : 0;
}

/* Run both, keep the cheaper one where it differs from the other by no more than the scene's
 * tolerance. */
static int solve_auto(analysis *a, double *u, char *error)
{
    const size_t bytes = (size_t)a->design.mesh.dof * sizeof *u;
    double *linear = malloc(bytes);
    if (!linear)
        return analysis_explain(a, PZS_E_WORKSPACE, error);
    a->nonlinear = 0;
    int failed = solve_applied(a, linear, error);
    a->nonlinear = 1;
    if (!failed)
        failed = solve_applied(a, u, error);
    a->cost = failed ? (double)NAN : distance(a, linear, u);
    if (a->cost <= a->design.scene->tolerance) {
        a->nonlinear = 0;
        memcpy(u, linear, bytes);
    }
    free(linear);
    return failed;
}

/* Contact and moved supports are the path's alone: there is nothing linear to compare it with. */
int analysis_solve(analysis *a, double *u, char *error)
{
    const int path_alone = a->design.scene->contact.given || a->design.mesh.prescribed_count > 0;
    if (a->design.scene->kinematics == KINEMATICS_AUTO && !path_alone)
        return solve_auto(a, u, error);
    if (a->design.scene->kinematics == KINEMATICS_AUTO) {
        a->nonlinear = 1;
        a->cost = (double)NAN;
    }
    return solve_applied(a, u, error);
}

int analysis_influence(analysis *a, char *error)
{
    const pzs_structure *s = &a->design.structure;
    if (a->influence)
        return 0;
    a->influence = calloc((size_t)s->input.count * s->output.count + 1, sizeof *a->influence);
    if (!a->influence)
        return analysis_explain(a, PZS_E_WORKSPACE, error);
    pzs_status status = at_rest(a);
    if (status == PZS_OK)
        status = pzs_influence(&a->model, a->influence);
    if (status == PZS_OK && a->electric.state.model)
        status = pzs_influence_open(&a->electric, a->influence);
    if (status != PZS_OK)
        return analysis_explain(a, status, error);
    return design_control(&a->design, a->influence, error);
}

/* ---- electrodes --------------------------------------------------------- */

double analysis_capacitance(const analysis *a, int k, int is_free)
{
    const pzs_electrodes *t = &a->design.electrodes;
    double sum = 0;
    if (is_free)
        return a->electric.state.stage > 0
                   ? a->electric.state
                         .sensitivity[(size_t)k * a->design.structure.input.count + t->input[k]]
                   : (double)NAN;
    for (uint32_t i = t->direct.start[k]; i < t->direct.start[k + 1]; i++)
        sum += t->direct.dof[i] == t->input[k] ? t->direct.value[i] : 0;
    return sum;
}

/* Twice the work of the loads, temperatures left out. amount [inputs] in: zeros, out: 1 for each
 * load */
static double work_of_loads(analysis *a, double *amount)
{
    const design *d = &a->design;
    const pzs_rows *in = &d->structure.input;
    double *u = calloc((size_t)d->mesh.dof, sizeof *u), work = 0;
    for (int k = 0; k < d->loads; k++)
        amount[d->amplifiers + k] = d->scene->load[k].type != LOAD_TEMPERATURE;
    const pzs_status status = u ? pzs_solve(&a->model, amount, u) : PZS_E_WORKSPACE;
    for (int k = d->amplifiers; status == PZS_OK && k < d->amplifiers + d->loads; k++)
        for (uint32_t t = in->start[k]; t < in->start[k + 1]; t++)
            work += amount[k] * in->value[t] * u[in->dof[t]];
    free(u);
    return status == PZS_OK ? work : (double)NAN;
}

/* The work of the same forces falls by what the volts that open electrodes take on do against the
 * charges of the short circuit. */
double analysis_stiffening(analysis *a)
{
    const design *d = &a->design;
    const pzs_electrodes *t = &d->electrodes;
    double *amount = calloc(d->structure.input.count + 1u, sizeof *amount),
           *charge = calloc(t->count + 1u, sizeof *charge);
    double work = (double)NAN, fallen = 0;
    const pzs_model kept = a->model; /* what it says of the last solve */
    if (amount && charge && !a->nonlinear && t->count > 0 && pzs_electrode_open_count(t) > 0 &&
        d->loads > 0) {
        work = work_of_loads(a, amount);
        const int known = pzs_charges(&a->electric, amount, charge) == PZS_OK &&
                          pzs_open_voltages(&a->electric, amount) == PZS_OK;
        for (int k = 0; known && k < t->count; k++)
            fallen -= charge[k] * amount[t->input[k]];
        work = known ? work : (double)NAN;
    }
    a->model = kept;
    free(amount);
    free(charge);
    return work > 0 ? work / (work - fallen) : (double)NAN;
}

void analysis_free(analysis *a)
{
    certificate_free(&a->certificate);
    path_close(&a->path);
    design_free(&a->design);
    free(a->work);
    free(a->influence);
    free(a->electric_work);
    free(a->amount);
    free(a->charge);
    memset(a, 0, sizeof *a);
}
