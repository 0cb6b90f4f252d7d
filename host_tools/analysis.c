/* A scene run through the library (analysis.h). */
#define _POSIX_C_SOURCE 200809L
#include "analysis.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "guard.h"
#include "linalg.h"

static const char *const unknown_name[7] = {"mean u1", "mean u2", "mean u3", "difference u1", "difference u2", "difference u3", "u3M"};

/* ---- structure -------------------------------------------------------- */

/* A message for a status of the library, with the place it names on the mesh. */
static int explain(const analysis *a, pzs_status status, char *error)
{
    const mesh *m = &a->design.mesh;
    const scene *s = a->design.scene;
    if (status == PZS_E_LOOSE || status == PZS_E_NEGATIVE)
        for (int n = 0; n < m->nodes; n++)
            for (unsigned i = 0; i < m->unknowns; i++)
                if (m->node_dof[(size_t)n * m->unknowns + i] == a->model.where)
                    return scene_fault(s, s->at_surface, error, "%s: %s at node theta1 = %g, theta2 = %g; add supports that stop every rigid motion",
                                       pzs_status_text(status), unknown_name[i], m->theta[n][0], m->theta[n][1]);
    if (status == PZS_E_CONDITION)
        return scene_fault(s, s->at_surface, error, "%s: condition %.2g; supports may leave a motion free, or the shell is too thin",
                           pzs_status_text(status), a->model.condition);
    return scene_fault(s, s->at_surface, error, "%s", pzs_status_text(status));
}

/* Assemble and factor the stiffness at rest. */
static pzs_status at_rest(analysis *a)
{
    const pzs_status status = pzs_assemble(&a->model, NULL, NULL);
    return status == PZS_OK ? pzs_factor(&a->model) : status;
}

int analysis_prepare(analysis *a, const scene *s, char *error)
{
    memset(a, 0, sizeof *a);
    if (design_build(&a->design, s, error) < 0)
        return -1;
    const pzs_structure *structure = &a->design.structure;
    a->work_bytes = PZS_MODEL_BYTES(structure->dof, linalg_reals(structure->first, structure->dof));
    a->work = malloc(a->work_bytes);
    pzs_status status = a->work ? pzs_model_init(&a->model, structure, a->work, a->work_bytes) : PZS_E_WORKSPACE;
    if (status == PZS_OK && a->design.mesh.prescribed_count > 0 && s->kinematics == KINEMATICS_LINEAR) {
        scene_fault(s, s->support[0].at, error, "a support with a value needs kinematics: nonlinear");
        analysis_free(a);
        return -1;
    }
    if (status == PZS_OK)
        status = at_rest(a);
    if (s->kinematics != KINEMATICS_LINEAR && (status == PZS_OK || s->contact.given))
        status = path_open(&a->path, &a->design, &a->model);
    if (status == PZS_OK)
        return 0;
    explain(a, status, error);
    analysis_free(a);
    return -1;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* What the nonlinear path met, in words; only errors fail. */
static int explain_path(const analysis *a, char *error)
{
    const pzs_path *run = &a->path.run;
    const scene *s = a->design.scene;
    if (!PZS_IS_ERROR(a->status))
        return 0;
    if (a->status == PZS_E_DIVERGED || a->status == PZS_E_LIMIT || a->status == PZS_E_SYSTEMS)
        return scene_fault(s, s->equilibrium.at, error, "%s: reached %.4g of the load in %u systems, %u load step%s; "
                           "the last equilibrium has %u negative pivots",
                           pzs_status_text(a->status), run->factor, run->systems, run->steps_taken, run->steps_taken == 1 ? "" : "s", run->negative);
    return explain(a, a->status, error);
}

static int solve_path(analysis *a, double *u, char *error)
{
    const double begin = now();
    a->status = pzs_equilibrium(&a->path.run, a->path.full);
    a->seconds = now() - begin;
    memcpy(u, a->path.run.u, (size_t)a->design.mesh.dof * sizeof *u);
    return explain_path(a, error);
}

int analysis_is_nonlinear(const analysis *a)
{
    return a->design.scene->kinematics == KINEMATICS_NONLINEAR;
}

int analysis_outputs(const analysis *a, int k)
{
    const int rows = a->design.named_first[k + 1] - a->design.named_first[k];
    return rows > 0 ? rows : 1;
}

double analysis_output(const analysis *a, int k, int i, const double *value)
{
    const scene_output *output = &a->design.scene->output[k];
    return output->contact == CONTACT_NONE ? value[a->design.named_first[k] + i] : path_contact_output(&a->path, output);
}

int analysis_solve(analysis *a, double *u, char *error)
{
    const design *d = &a->design;
    if (analysis_is_nonlinear(a))
        return solve_path(a, u, error);
    double *amount = calloc((size_t)d->structure.input.count + 1, sizeof *amount);
    if (!amount)
        return explain(a, PZS_E_WORKSPACE, error);
    for (int k = 0; k < d->scene->actuators; k++)
        for (int c = 0; c < d->scene->actuator[k].grid[0] * d->scene->actuator[k].grid[1]; c++)
            amount[d->scene->actuator[k].first + c] = d->scene->actuator[k].applied;
    for (int k = d->amplifiers; k < d->structure.input.count; k++)
        amount[k] = 1;
    const pzs_status status = pzs_solve(&a->model, amount, u);
    free(amount);
    return status == PZS_OK ? 0 : explain(a, status, error);
}

int analysis_influence(analysis *a, char *error)
{
    const pzs_structure *s = &a->design.structure;
    a->influence = calloc((size_t)s->input.count * s->output.count + 1, sizeof *a->influence);
    if (!a->influence)
        return explain(a, PZS_E_WORKSPACE, error);
    const pzs_status status = pzs_influence(&a->model, a->influence);
    if (status != PZS_OK)
        return explain(a, status, error);
    return design_control(&a->design, a->influence, error);
}

void analysis_free(analysis *a)
{
    path_close(&a->path);
    design_free(&a->design);
    free(a->work);
    free(a->influence);
    memset(a, 0, sizeof *a);
}

/* ---- voltages --------------------------------------------------------- */

/* The design's problem with other limits and no slew, in arrays of its own. */
typedef struct trial {
    pzs_problem problem;
    pzs_control control;
    double *bounds; /* [3][amplifiers] lower, upper, slew */
    void *work;
} trial;

static void trial_free(trial *t)
{
    free(t->bounds);
    free(t->work);
}

static pzs_status trial_start(trial *t, const design *d, double limit)
{
    const size_t n = (size_t)d->amplifiers, bytes = PZS_CONTROL_BYTES(d->amplifiers, d->targets);
    memset(t, 0, sizeof *t);
    t->problem = d->problem;
    t->bounds = calloc(3 * n, sizeof *t->bounds);
    t->work = malloc(bytes);
    if (!t->bounds || !t->work)
        return PZS_E_WORKSPACE;
    for (size_t k = 0; k < n; k++) {
        t->bounds[k] = isnan(limit) ? d->lower[k] : -limit;
        t->bounds[n + k] = isnan(limit) ? d->upper[k] : limit;
        t->bounds[2 * n + k] = HUGE_VAL;
    }
    t->problem.lower = t->bounds;
    t->problem.upper = t->bounds + n;
    t->problem.slew = t->bounds + 2 * n;
    t->problem.crc = 0;
    t->problem.crc = guard_problem_crc(&t->problem);
    return pzs_control_init(&t->control, &t->problem, NULL, t->work, bytes);
}

static int volts_start(const analysis *a, analysis_volts *v, const char *name)
{
    memset(v, 0, sizeof *v);
    snprintf(v->name, sizeof v->name, "%s", name);
    v->volt = calloc((size_t)a->design.amplifiers, sizeof *v->volt);
    v->shape = calloc((size_t)a->design.targets, sizeof *v->shape);
    v->optimality = (double)NAN;
    v->limit[0] = -HUGE_VAL;
    v->limit[1] = HUGE_VAL;
    return v->volt && v->shape ? 0 : -1;
}

/* Shape and its error from the volts. */
static void volts_finish(const analysis *a, analysis_volts *v)
{
    const design *d = &a->design;
    double missed = 0, wanted = 0;
    for (int i = 0; i < d->targets; i++) {
        v->shape[i] = d->target[i] - d->wanted[i];
        for (int k = 0; k < d->amplifiers; k++)
            v->shape[i] += d->influence[(size_t)i * (size_t)d->amplifiers + (size_t)k] * v->volt[k];
        missed += pow(d->weight[i] * (v->shape[i] - d->target[i]), 2);
        wanted += pow(d->weight[i] * d->wanted[i], 2);
    }
    v->error = wanted > 0 ? sqrt(missed / wanted) : sqrt(missed);
}

static void note_limits(const trial *t, analysis_volts *v)
{
    for (int k = 0; k < t->problem.inputs; k++) {
        v->limit[0] = fmax(v->limit[0], t->problem.lower[k]);
        v->limit[1] = fmin(v->limit[1], t->problem.upper[k]);
    }
}

static int volts_failed(const analysis *a, trial *t, pzs_status status, char *error)
{
    trial_free(t);
    return scene_fault(a->design.scene, a->design.scene->limits.at, error, "%s", pzs_status_text(status));
}

/* The target is reached in one step without slew; a budget that runs out continues where it stopped. */
int analysis_optimum(analysis *a, double limit, analysis_volts *v, char *error)
{
    trial t;
    pzs_status status = trial_start(&t, &a->design, limit);
    if (status != PZS_OK || volts_start(a, v, isinf(limit) ? "optimum, no limits" : "optimum within limits") < 0)
        return volts_failed(a, &t, status, error);
    for (int again = 0; again < 10; again++) {
        status = pzs_step(&t.control, a->design.wanted);
        v->passes += t.control.passes;
        if (status != PZS_W_PASSES)
            break;
    }
    if (PZS_IS_ERROR(status))
        return volts_failed(a, &t, status, error);
    memcpy(v->volt, t.control.volt, (size_t)a->design.amplifiers * sizeof *v->volt);
    v->optimality = t.control.optimality;
    v->active = t.control.active;
    note_limits(&t, v);
    volts_finish(a, v);
    trial_free(&t);
    return 0;
}

int analysis_clipped(analysis *a, double limit, analysis_volts *v, char *error)
{
    trial t;
    pzs_status status = trial_start(&t, &a->design, limit);
    if (status == PZS_OK && volts_start(a, v, "no limits, then clipped") == 0)
        status = pzs_clipped(&t.control, a->design.wanted, v->volt);
    if (status != PZS_OK)
        return volts_failed(a, &t, status, error);
    for (int k = 0; k < a->design.amplifiers; k++)
        v->active += v->volt[k] == t.problem.lower[k] || v->volt[k] == t.problem.upper[k];
    note_limits(&t, v);
    volts_finish(a, v);
    trial_free(&t);
    return 0;
}

int analysis_given(analysis *a, const char *name, const double *volt, analysis_volts *v, char *error)
{
    if (volts_start(a, v, name) < 0)
        return scene_fault(a->design.scene, a->design.scene->limits.at, error, "volts do not fit into memory");
    memcpy(v->volt, volt, (size_t)a->design.amplifiers * sizeof *v->volt);
    volts_finish(a, v);
    return 0;
}

void analysis_volts_free(analysis_volts *v)
{
    free(v->volt);
    free(v->shape);
    memset(v, 0, sizeof *v);
}
