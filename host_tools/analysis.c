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
#include "model.h"

static const char *const unknown_name[7] = {"mean u1", "mean u2", "mean u3", "difference u1", "difference u2", "difference u3", "u3M"};

/* ---- structure -------------------------------------------------------- */

int analysis_explain(const analysis *a, pzs_status status, char *error)
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

/* Assemble and factor the stiffness at rest, unless that is what the model holds. */
static pzs_status at_rest(analysis *a)
{
    if (a->model.stage == STAGE_FACTORED)
        return PZS_OK;
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
    a->nonlinear = s->kinematics == KINEMATICS_NONLINEAR;
    if (s->kinematics != KINEMATICS_LINEAR && (status == PZS_OK || s->contact.given))
        status = path_open(&a->path, &a->design, &a->model);
    if (status == PZS_OK)
        return 0;
    analysis_explain(a, status, error);
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
    return analysis_explain(a, a->status, error);
}

int analysis_outputs(const analysis *a, int k)
{
    const int rows = a->design.named_first[k + 1] - a->design.named_first[k];
    return rows > 0 ? rows : 1;
}

const char *analysis_unit(const analysis *a, int k)
{
    const scene *s = a->design.scene;
    switch (s->output[k].contact) {
    case CONTACT_NONE:
        return s->unit_length[0] ? s->unit_length : "length";
    case CONTACT_NODES:
        return "nodes";
    case CONTACT_PRESSURE:
        return "of pressure";
    default:
        return s->unit_force[0] ? s->unit_force : "force";
    }
}

double analysis_output(const analysis *a, int k, int i, const double *value)
{
    const scene_output *output = &a->design.scene->output[k];
    return output->contact == CONTACT_NONE ? value[a->design.named_first[k] + i] : path_contact_output(&a->path, output);
}

static pzs_status reach_nonlinear(analysis *a, const double *amount, int warm, double *u)
{
    pzs_path *run = &a->path.run;
    const double begin = now();
    if (!warm)
        pzs_path_rest(run);
    a->status = pzs_equilibrium(run, amount);
    a->seconds = now() - begin;
    memcpy(u, run->u, (size_t)a->design.mesh.dof * sizeof *u);
    return a->status;
}

static pzs_status reach_linear(analysis *a, const double *amount, double *u)
{
    const double begin = now();
    a->status = at_rest(a);
    if (a->status == PZS_OK)
        a->status = pzs_solve(&a->model, amount, u);
    a->seconds = now() - begin;
    return a->status;
}

int analysis_reach(analysis *a, const double *volt, int warm, double *u, char *error)
{
    const design *d = &a->design;
    const size_t inputs = d->structure.input.count, amplifiers = (size_t)d->amplifiers;
    double *amount = calloc(inputs + 1, sizeof *amount);
    if (!amount)
        return analysis_explain(a, PZS_E_WORKSPACE, error);
    for (size_t k = 0; k < inputs; k++)
        amount[k] = k < amplifiers ? volt[k] : a->nonlinear ? a->path.full[k] : k < amplifiers + (size_t)d->loads;
    const pzs_status status = a->nonlinear ? reach_nonlinear(a, amount, warm, u) : reach_linear(a, amount, u);
    free(amount);
    return a->nonlinear ? explain_path(a, error) : status == PZS_OK ? 0 : analysis_explain(a, status, error);
}

int analysis_solve(analysis *a, double *u, char *error)
{
    const design *d = &a->design;
    double *volt = calloc((size_t)d->amplifiers + 1, sizeof *volt);
    if (!volt)
        return analysis_explain(a, PZS_E_WORKSPACE, error);
    for (int k = 0; k < d->scene->actuators; k++)
        for (int c = 0; c < d->scene->actuator[k].grid[0] * d->scene->actuator[k].grid[1]; c++)
            volt[d->scene->actuator[k].first + c] = d->scene->actuator[k].applied;
    const int failed = analysis_reach(a, volt, 0, u, error);
    free(volt);
    return failed;
}

int analysis_influence(analysis *a, char *error)
{
    const pzs_structure *s = &a->design.structure;
    a->influence = calloc((size_t)s->input.count * s->output.count + 1, sizeof *a->influence);
    if (!a->influence)
        return analysis_explain(a, PZS_E_WORKSPACE, error);
    pzs_status status = at_rest(a);
    if (status == PZS_OK)
        status = pzs_influence(&a->model, a->influence);
    if (status != PZS_OK)
        return analysis_explain(a, status, error);
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
