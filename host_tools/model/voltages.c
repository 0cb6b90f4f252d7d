/* Voltages for a target (voltages.h). */
#include "voltages.h"
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "clipped.h"
#include "../../lib/core/guard.h"

enum { MOST_RELINEARISED = 40, MOST_REFUSED = 8 };

/* ---- the voltage problem with other limits ---------------------------- */

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

/*
 * influence [targets][amplifiers] in, or NULL: the design's, at rest. error is filled where limits
 * do not overlap.
 */
static pzs_status trial_start(trial *t, const design *d, common_limits common,
                              const double *influence, char *error)
{
    const size_t n = (size_t)d->amplifiers, bytes = PZS_CONTROL_BYTES(d->amplifiers, d->targets);
    memset(t, 0, sizeof *t);
    t->problem = d->problem;
    t->bounds = calloc(3 * n, sizeof *t->bounds);
    t->work = malloc(bytes);
    if (!t->bounds || !t->work)
        return PZS_E_WORKSPACE;
    if (design_limits(d, common, t->bounds, t->bounds + n, error) < 0)
        return PZS_E_LIMITS;
    for (size_t k = 0; k < n; k++)
        t->bounds[2 * n + k] = HUGE_VAL;
    t->problem.lower = t->bounds;
    t->problem.upper = t->bounds + n;
    t->problem.step_limit = t->bounds + 2 * n;
    if (influence) {
        t->problem.influence = influence;
        t->problem.hessian = NULL;
    }
    t->problem.crc = 0;
    t->problem.crc = pzs_problem_crc(&t->problem);
    return pzs_control_init(&t->control, &t->problem, NULL, t->work, bytes);
}

/*
 * The widest range of any amplifier, how many have less or are held, and how many of `volt` are at
 * a limit.
 */
static void note_limits(const pzs_problem *p, const double *voltage, voltages *v)
{
    double lowest = HUGE_VAL, highest = -HUGE_VAL;
    v->active = v->held = v->narrower = 0;
    for (int k = 0; k < p->inputs; k++) {
        if (p->lower[k] == p->upper[k]) {
            v->held++;
            continue;
        }
        lowest = fmin(lowest, p->lower[k]);
        highest = fmax(highest, p->upper[k]);
        v->active += voltage[k] == p->lower[k] || voltage[k] == p->upper[k];
    }
    for (int k = 0; k < p->inputs; k++)
        v->narrower +=
            p->lower[k] != p->upper[k] && (p->lower[k] > lowest || p->upper[k] < highest);
    v->limit[0] = fmin(lowest, highest); /* every amplifier held: from -INFINITY to INFINITY */
    v->limit[1] = fmax(lowest, highest);
}

/* The message of a status that is about the voltage problem. Returns -1. */
static int explain(const analysis *a, pzs_status status, char *error)
{
    if (status == PZS_E_LIMITS)
        return -1; /* design_limits has named the amplifier */
    return scene_fault(a->design.scene, a->design.scene->limits.at, error, "%s",
                       pzs_status_text(status));
}

/*
 * The bounded optimum: reached in one step; a budget that runs out continues where it stopped.
 *   influence as in trial_start
 *   wanted [targets] in     what B volt should be
 *   reach            in     most change of any volt from `volt`, or INFINITY
 *   volt [amplifiers] in/out
 */
static pzs_status best_volts(const design *d, common_limits common, const double *influence,
                             const double *wanted, double reach, voltages *v, double *voltage,
                             char *error)
{
    trial t;
    pzs_status status = trial_start(&t, d, common, influence, error);
    for (int k = 0; status == PZS_OK && isfinite(reach) && k < d->amplifiers; k++) {
        t.control.state.lower[k] = fmax(t.problem.lower[k], voltage[k] - reach);
        t.control.state.upper[k] = fmin(t.problem.upper[k], voltage[k] + reach);
    }
    if (status == PZS_OK && isfinite(reach))
        status = pzs_control_start(&t.control, voltage);
    for (int again = 0; status == PZS_OK && again < 10; again++) {
        status = pzs_step(&t.control, wanted);
        v->passes += t.control.info.iterations;
        if (status != PZS_W_ITERATIONS)
            break;
        status = PZS_OK;
    }
    if (!PZS_IS_ERROR(status)) {
        memcpy(voltage, t.control.info.voltage, (size_t)d->amplifiers * sizeof *voltage);
        pzs_report report;
        (void)pzs_assess(&t.control, wanted, &report);
        v->optimality = report.kkt_violation;
        note_limits(&t.problem, voltage, v);
        status = PZS_OK;
    }
    trial_free(&t);
    return status;
}

/* ---- volts and their shape -------------------------------------------- */

static int start(const analysis *a, voltages *v, const char *name)
{
    memset(v, 0, sizeof *v);
    snprintf(v->name, sizeof v->name, "%s", name);
    v->volts = a->design.amplifiers;
    v->volt = calloc((size_t)a->design.amplifiers, sizeof *v->volt);
    v->shape = calloc((size_t)a->design.targets, sizeof *v->shape);
    v->aim = calloc((size_t)a->design.targets, sizeof *v->aim);
    v->u = calloc((size_t)a->design.mesh.dof, sizeof *v->u);
    v->optimality = (double)NAN;
    v->limit[0] = -HUGE_VAL;
    v->limit[1] = HUGE_VAL;
    return v->volt && v->shape && v->aim && v->u ? 0 : -1;
}

static int out_of_memory(const analysis *a, char *error)
{
    return analysis_explain(a, PZS_E_WORKSPACE, error);
}

/* Weighted squares of what is wanted in the rows that cannot move. */
static double wanted_fixed(const design *d)
{
    double sum = 0;
    for (int i = 0; i < d->targets; i++)
        sum += pow(d->fixed_weight[i] * d->wanted[i], 2);
    return sum;
}

static double relative(double missed, double wanted)
{
    return wanted > 0 ? sqrt(missed / wanted) : sqrt(missed);
}

/* v->shape, v->aim and the errors of v->u. */
static void measure(const analysis *a, voltages *v)
{
    const design *d = &a->design;
    double most = 0;
    design_shape(d, v->u, v->shape);
    const double missed = design_squares(d, v->shape, d->target),
                 wanted = design_squares(d, d->wanted, NULL);
    const double missed_fixed = design_misfit(d, v->shape, d->target, v->aim);
    v->fixed_off = 0;
    for (int i = 0; i < d->targets; i++)
        most = fmax(most, fabs(d->target[i]));
    for (int i = 0; i < d->targets; i++)
        v->fixed_off += d->fixed_weight[i] > 0 && fabs(v->aim[i]) > 1e-9 * most;
    for (int i = 0; i < d->targets; i++)
        v->aim[i] = v->shape[i] - v->aim[i];
    v->error = relative(missed, wanted);
    v->error_all = relative(missed + missed_fixed, wanted + wanted_fixed(d));
}

/* Shape of v->volt on the structure asked about. */
static int reach(analysis *a, voltages *v, int warm, char *error)
{
    if (analysis_reach(a, v->volt, warm, v->u, error) < 0)
        return -1;
    measure(a, v);
    v->residual = a->nonlinear ? a->path.run.info.residual : a->model.info.residual;
    v->systems += a->nonlinear ? (int)a->path.run.info.linear_solves : 0;
    return 0;
}

/* The same from rest; where the load steps end early, error is NAN and the shape the last
 * equilibrium. */
static int reach_or_none(analysis *a, voltages *v, char *error)
{
    if (reach(a, v, 0, error) == 0)
        return 0;
    measure(a, v);
    v->error = v->error_all = (double)NAN;
    return a->nonlinear && analysis_ended_early(a) ? 0 : -1;
}

int voltages_linear(analysis *a, common_limits common, voltages *v, char *error)
{
    if (start(a, v,
              common.source == LIMITS_NONE ? "linear optimum, no limits"
                                           : "linear optimum in limits") < 0)
        return out_of_memory(a, error);
    const pzs_status status =
        best_volts(&a->design, common, NULL, a->design.wanted, HUGE_VAL, v, v->volt, error);
    if (status != PZS_OK)
        return explain(a, status, error);
    if (reach_or_none(a, v, error) < 0)
        return -1;
    if (a->nonlinear)
        v->optimality = (double)NAN; /* no claim on another structure than the one it was found for
                                      */
    return 0;
}

/*
 * Least squares cut to the limits; tuned: regularised by the lambda that leaves the smallest error
 * of the linear model.
 */
static pzs_status clipped_volts(const design *d, common_limits common, bool tuned, voltages *v,
                                char *error)
{
    trial t;
    clipped c;
    memset(&c, 0, sizeof c);
    pzs_status status = trial_start(&t, d, common, NULL, error);
    if (status == PZS_OK && clipped_open(&c, d, t.problem.lower, t.problem.upper, d->wanted) < 0)
        status = PZS_E_WORKSPACE;
    if (status == PZS_OK)
        status =
            tuned ? clipped_tune(&c, v->volt, &v->regularisation) : clipped_solve(&c, 0, v->volt);
    if (status == PZS_OK)
        note_limits(&t.problem, v->volt, v);
    clipped_close(&c);
    trial_free(&t);
    return status;
}

static int clip(analysis *a, common_limits common, bool tuned, voltages *v, char *error)
{
    if (start(a, v, tuned ? "regularised, then clipped" : "clipped least squares") < 0)
        return out_of_memory(a, error);
    const pzs_status status = clipped_volts(&a->design, common, tuned, v, error);
    if (status != PZS_OK)
        return explain(a, status, error);
    return reach_or_none(a, v, error);
}

int voltages_clipped(analysis *a, common_limits common, voltages *v, char *error)
{
    return clip(a, common, false, v, error);
}

int voltages_regularised(analysis *a, common_limits common, voltages *v, char *error)
{
    return clip(a, common, true, v, error);
}

int voltages_given(analysis *a, const char *name, const double *voltage, voltages *v, char *error)
{
    if (start(a, v, name) < 0)
        return out_of_memory(a, error);
    memcpy(v->volt, voltage, (size_t)a->design.amplifiers * sizeof *v->volt);
    return reach_or_none(a, v, error);
}

void voltages_free(voltages *v)
{
    free(v->volt);
    free(v->shape);
    free(v->aim);
    free(v->u);
    memset(v, 0, sizeof *v);
}

/* ---- Gauss-Newton on the nonlinear structure -------------------------- */

/* A misfit and the effort in its unit. */
static double with_effort(const analysis *a, const voltages *v, double sum)
{
    const design *d = &a->design;
    for (int k = 0; k < d->amplifiers; k++)
        sum += d->problem.regularisation * pow(v->volt[k] - d->prefer[k], 2);
    return sum;
}

/* What the optimum makes small. */
static double objective(const analysis *a, const voltages *v)
{
    return with_effort(a, v, design_squares(&a->design, v->shape, a->design.target));
}

/* Arrays of one Gauss-Newton run; one allocation, at `all`. */
typedef struct newton {
    double *all;       /* [outputs][inputs] influence at the shape reached */
    double *influence; /* [targets][amplifiers] its part */
    double *wanted;    /* [targets] what influence times volts should be */
    double *column;    /* [targets] room */
    double reach;      /* most change of any volt for which the influence is trusted */
    void *state;       /* of the path at the shape reached */
    voltages best;     /* there */
} newton;

/* What v holds is the best so far; and back to it. */
static void keep(const analysis *a, newton *g, const voltages *v)
{
    const voltages own = g->best;
    path_keep(&a->path, g->state);
    g->best = *v;
    g->best.volt = memcpy(own.volt, v->volt, (size_t)v->volts * sizeof *v->volt);
    g->best.shape = memcpy(own.shape, v->shape, (size_t)a->design.targets * sizeof *v->shape);
    g->best.aim = memcpy(own.aim, v->aim, (size_t)a->design.targets * sizeof *v->aim);
    g->best.u = memcpy(own.u, v->u, (size_t)a->design.mesh.dof * sizeof *v->u);
}

static void go_back(analysis *a, const newton *g, voltages *v)
{
    path_return(&a->path, g->state);
    memcpy(v->volt, g->best.volt, (size_t)v->volts * sizeof *v->volt);
    memcpy(v->shape, g->best.shape, (size_t)a->design.targets * sizeof *v->shape);
    memcpy(v->u, g->best.u, (size_t)a->design.mesh.dof * sizeof *v->u);
    memcpy(v->aim, g->best.aim, (size_t)a->design.targets * sizeof *v->aim);
    v->error = g->best.error;
    v->error_all = g->best.error_all;
    v->fixed_off = g->best.fixed_off;
    v->residual = g->best.residual;
    v->active = g->best.active;
    v->optimality = g->best.optimality;
}

/* Influence at the shape reached. */
static pzs_status relinearise(analysis *a, newton *g, voltages *v)
{
    const design *d = &a->design;
    const size_t n = (size_t)d->amplifiers;
    const pzs_status status = pzs_influence_at(&a->path.run, g->all);
    if (status == PZS_OK)
        design_influence_free(d, g->all, d->structure.input.count, g->column, g->influence);
    for (size_t i = 0; status == PZS_OK && i < (size_t)d->targets; i++) {
        g->wanted[i] = v->aim[i] - v->shape[i];
        for (size_t k = 0; k < n; k++)
            g->wanted[i] += g->influence[i * n + k] * v->volt[k];
    }
    v->relinearised++;
    keep(a, g, v);
    return status;
}

/* The objective that the linearised structure promises for v->volt. */
static double promised(const analysis *a, const newton *g, const voltages *v)
{
    const design *d = &a->design;
    double sum = 0;
    for (int i = 0; i < d->targets; i++) {
        double miss = -g->wanted[i];
        for (int k = 0; k < d->amplifiers; k++)
            miss += g->influence[(size_t)i * (size_t)d->amplifiers + (size_t)k] * v->volt[k];
        sum += pow(d->weight[i] * miss, 2);
    }
    return with_effort(a, v, sum);
}

static double largest_change(const analysis *a, const newton *g, const voltages *v)
{
    double most = 0;
    for (int k = 0; k < a->design.amplifiers; k++)
        most = fmax(most, fabs(v->volt[k] - g->best.volt[k]));
    return most;
}

/*
 * Move to the linearised optimum within reach; the reach follows how well the last promise was
 * kept, and a move that helps nothing is taken back and tried again closer. Returns the part of the
 * objective it fell by; 0: nothing helps.
 */
static double improve(analysis *a, common_limits common, newton *g, voltages *v, pzs_status *status,
                      char *error)
{
    const double before = objective(a, v);
    for (int refused = 0; refused < MOST_REFUSED; refused++) {
        *status =
            best_volts(&a->design, common, g->influence, g->wanted, g->reach, v, v->volt, error);
        if (*status != PZS_OK)
            return 0;
        const double change = largest_change(a, g, v), promise = promised(a, g, v);
        const int reached = reach(a, v, 1, error) == 0;
        const double kept = (before - objective(a, v)) / (before - promise);
        if (!reached || !(kept > 0.75))
            g->reach = change / (kept > 0.25 && reached ? 1 : 4);
        else if (change >= 0.99 * g->reach)
            g->reach = 2 * change;
        if (reached && objective(a, v) < before)
            return 1 - objective(a, v) / before;
        go_back(a, g, v);
    }
    return 0;
}

static int gauss_newton(analysis *a, common_limits common, voltages *v, char *error)
{
    const design *d = &a->design;
    const size_t n = (size_t)d->amplifiers, m = (size_t)d->targets,
                 inputs = d->structure.input.count;
    const size_t all = (size_t)d->structure.output.count * inputs;
    double fell = 1;
    newton g = {.reach = HUGE_VAL,
                .all = calloc(all + m * n + 2 * m, sizeof *g.all),
                .state = malloc(path_state_bytes(&a->path))};
    g.influence = g.all + all;
    g.wanted = g.influence + m * n;
    g.column = g.wanted + m;
    pzs_status status = start(a, &g.best, "") == 0 && g.all && g.state ? PZS_OK : PZS_E_WORKSPACE;
    while (status == PZS_OK && fell > 1e-3 && v->relinearised < MOST_RELINEARISED) {
        status = relinearise(a, &g, v);
        if (status == PZS_OK)
            fell = improve(a, common, &g, v, &status, error);
    }
    voltages_free(&g.best);
    free(g.state);
    free(g.all);
    return status == PZS_OK ? 0 : analysis_explain(a, status, error);
}

/* Halve the volts, within their limits, until there is an equilibrium. */
static int retreat(analysis *a, common_limits common, voltages *v, char *error)
{
    trial t;
    const pzs_status status = trial_start(&t, &a->design, common, NULL, error);
    int failed = -1;
    for (int tries = 0; status == PZS_OK && failed && tries < MOST_REFUSED; tries++) {
        for (int k = 0; k < v->volts; k++)
            v->volt[k] = fmin(fmax(v->volt[k] / 2, t.problem.lower[k]), t.problem.upper[k]);
        failed = reach(a, v, 0, error);
    }
    trial_free(&t);
    return failed;
}

int voltages_optimum(analysis *a, common_limits common, voltages *v, char *error)
{
    if (voltages_linear(a, common, v, error) < 0 ||
        (isnan(v->error) && retreat(a, common, v, error) < 0))
        return -1;
    snprintf(v->name, sizeof v->name, "%s",
             common.source == LIMITS_NONE ? "optimum, no limits" : "optimum within limits");
    return a->nonlinear ? gauss_newton(a, common, v, error) : 0;
}
