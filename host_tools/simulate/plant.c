/* The structure of a simulation (plant.h). */
#include "plant.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- open ------------------------------------------------------------- */

static void scale_material(scene_material *m, double stiffness, double d)
{
    for (int i = 0; i < 3; i++)
        m->e[i] *= stiffness;
    m->g23 *= stiffness;
    m->g13 *= stiffness;
    m->g12 *= stiffness;
    m->d31 *= d;
    m->d32 *= d;
    m->d33 *= d;
    m->d24 *= d;
    m->d15 *= d;
    for (int i = 0; i < 5; i++)
        m->piezo_e[i] *= stiffness * d;
}

/* One more load, of 1 K, after the scene's own. */
static int add_temperature(scene *s)
{
    const char *why;
    int column;
    scene_load *more = realloc(s->load, ((size_t)s->loads + 1) * sizeof *more);
    if (!more)
        return -1;
    s->load = more;
    memset(&more[s->loads], 0, sizeof *more);
    more[s->loads].type = LOAD_TEMPERATURE;
    more[s->loads].value = expr_compile("1", &column, &why);
    return more[s->loads++].value ? 0 : -1;
}

static int warms(const scene_simulate *simulate)
{
    for (int i = 0; i < simulate->events; i++)
        if (simulate->event[i].type == EVENT_TEMPERATURE)
            return 1;
    return 0;
}

static int change_scene(scene *s)
{
    const scene_simulate *simulate = &s->simulate;
    s->kinematics = simulate->kinematics;
    for (int i = 0; i < s->materials; i++)
        scale_material(&s->material[i], simulate->stiffness ? simulate->stiffness[i] : 1,
                       simulate->d ? simulate->d[i] : 1);
    return warms(simulate) ? add_temperature(s) : 0;
}

int plant_open(plant *p, const scene *nominal, char *error)
{
    memset(p, 0, sizeof *p);
    if (scene_read(&p->scene, nominal->path, (const char *const *)nominal->set, nominal->sets,
                   error) < 0)
        return -1;
    p->temperature = -1;
    int failed = change_scene(&p->scene);
    if (failed)
        scene_fault(nominal, nominal->simulate.at, error, "out of memory");
    failed = failed || analysis_prepare(&p->analysis, &p->scene, error) < 0 ||
             analysis_influence(&p->analysis, error) < 0;
    const design *d = &p->analysis.design;
    if (!failed) {
        p->amount = calloc((size_t)d->structure.input.count, sizeof *p->amount);
        p->reached = calloc((size_t)d->structure.input.count, sizeof *p->reached);
        p->full = calloc((size_t)d->structure.input.count, sizeof *p->full);
        p->value = calloc((size_t)d->structure.output.count + 1, sizeof *p->value);
        failed = !p->amount || !p->reached || !p->full || !p->value
                     ? scene_fault(nominal, nominal->simulate.at, error, "out of memory")
                     : 0;
    }
    if (failed) {
        plant_close(p);
        return -1;
    }
    if (p->analysis.nonlinear)
        memcpy(p->full, p->analysis.path.full, (size_t)d->structure.input.count * sizeof *p->full);
    if (warms(&p->scene.simulate))
        p->temperature = d->amplifiers + d->loads - 1;
    plant_rest(p);
    return 0;
}

void plant_close(plant *p)
{
    if (p->analysis.design.scene)
        analysis_free(&p->analysis);
    scene_free(&p->scene);
    free(p->amount);
    free(p->reached);
    free(p->full);
    free(p->value);
    memset(p, 0, sizeof *p);
}

/* ---- loads ------------------------------------------------------------ */

/* Input that carries a load: a follower's is one of the extras, in the order of loads. */
static int input_of(const plant *p, int load)
{
    const design *d = &p->analysis.design;
    int extra = d->amplifiers + d->loads;
    if (!p->analysis.nonlinear || p->scene.load[load].follower == FOLLOWER_NONE)
        return d->amplifiers + load;
    for (int k = 0; k < load; k++)
        extra += p->scene.load[k].follower != FOLLOWER_NONE;
    return extra;
}

void plant_load(plant *p, int load, double amount)
{
    p->amount[input_of(p, load)] = amount;
}

void plant_warm(plant *p, double kelvin)
{
    if (p->temperature >= 0)
        p->amount[p->temperature] = kelvin;
}

void plant_rest(plant *p)
{
    const design *d = &p->analysis.design;
    memcpy(p->amount, p->full, (size_t)d->structure.input.count * sizeof *p->amount);
    for (int k = 0; k < d->loads; k++)
        plant_load(p, k, 1);
    plant_warm(p, 0);
    p->moved = 0;
}

/* ---- shapes ----------------------------------------------------------- */

static void sum_columns(const plant *p, size_t rows, double *shape)
{
    const size_t inputs = p->analysis.design.structure.input.count;
    for (size_t i = 0; i < rows; i++) {
        const double *row = p->analysis.influence + i * inputs;
        shape[i] = 0;
        for (size_t k = 0; k < inputs; k++)
            shape[i] += row[k] * p->amount[k];
    }
}

/* The equilibrium under the amounts, from the last shape; that is it where they are the same. */
static int reach(plant *p, char *error)
{
    analysis *a = &p->analysis;
    pzs_solver *run = &a->path.run;
    const size_t bytes = a->design.structure.input.count * sizeof *p->amount;
    if (p->moved && memcmp(p->amount, p->reached, bytes) == 0)
        return 0;
    if (!p->moved)
        pzs_solver_reset(run);
    a->status = pzs_equilibrium(run, p->amount);
    p->systems += run->info.linear_solves;
    p->moved = 1;
    memcpy(p->reached, p->amount, bytes);
    return PZS_IS_ERROR(a->status) ? analysis_explain(a, a->status, error) : 0;
}

int plant_shape(plant *p, const double *voltage, double *shape, char *error)
{
    memcpy(p->amount, voltage, (size_t)p->analysis.design.amplifiers * sizeof *voltage);
    if (!p->analysis.nonlinear) {
        sum_columns(p, (size_t)p->analysis.design.targets, shape);
        return 0;
    }
    if (reach(p, error) < 0)
        return -1;
    design_shape(&p->analysis.design, p->analysis.path.run.info.displacement, shape);
    return 0;
}

/* All rows, and volts and charges of electrodes where there are some. */
static pzs_status look(plant *p)
{
    analysis *a = &p->analysis;
    if (a->nonlinear)
        pzs_observe(&a->design.structure, a->path.run.info.displacement, p->value);
    else
        sum_columns(p, a->design.structure.output.count, p->value);
    return analysis_electrodes(a, p->amount);
}

int plant_readings(plant *p, double *reading, char *error)
{
    const analysis *a = &p->analysis;
    const scene_estimate *estimate = &p->scene.estimate;
    const pzs_status status = look(p);
    for (int r = 0; r < estimate->readings; r++)
        for (int i = 0; i < analysis_outputs(a, estimate->reading[r].output); i++)
            *reading++ = analysis_output(a, estimate->reading[r].output, i, p->value);
    return status == PZS_OK ? 0 : analysis_explain(a, status, error);
}

int plant_displacement(plant *p, double *u, char *error)
{
    analysis *a = &p->analysis;
    if (a->nonlinear) {
        memcpy(u, a->path.run.info.displacement, (size_t)a->design.mesh.dof * sizeof *u);
        return 0;
    }
    const pzs_status status = pzs_solve(&a->model, p->amount, u);
    return status == PZS_OK ? 0 : analysis_explain(a, status, error);
}

/* ---- optimum ---------------------------------------------------------- */

/* What the volts must do by the linear structure: the target less what the loads do there. */
static void want(plant *p, const double *target)
{
    design *d = &p->analysis.design;
    const size_t inputs = d->structure.input.count;
    for (size_t i = 0; i < (size_t)d->targets; i++) {
        d->target[i] = target[i];
        d->wanted[i] = 0;
        for (int k = 0; k < d->loads; k++)
            d->wanted[i] += p->analysis.influence[i * inputs + (size_t)(d->amplifiers + k)] *
                            p->amount[input_of(p, k)];
    }
    design_take_free(d, d->target);
    design_take_free(d, d->wanted);
    for (int i = 0; i < d->targets; i++)
        d->wanted[i] = d->target[i] - d->wanted[i];
}

int plant_optimum(plant *p, const double *target, const double *held, voltages *best, double *shape,
                  char *error)
{
    analysis *a = &p->analysis;
    design *d = &a->design;
    const size_t n = (size_t)d->amplifiers;
    double *limit = malloc(2 * n * sizeof *limit);
    if (!limit)
        return analysis_explain(a, PZS_E_WORKSPACE, error);
    memcpy(limit, d->lower, n * sizeof *limit);
    memcpy(limit + n, d->upper, n * sizeof *limit);
    for (size_t k = 0; k < n; k++)
        if (!isnan(held[k]))
            d->lower[k] = d->upper[k] = held[k];
    want(p, target);
    if (a->nonlinear)
        memcpy(a->path.full, p->amount, d->structure.input.count * sizeof *p->amount);
    const int failed =
        voltages_optimum(a, (common_limits){.source = LIMITS_SCENE}, best, error) < 0;
    memcpy(d->lower, limit, n * sizeof *limit);
    memcpy(d->upper, limit + n, n * sizeof *limit);
    free(limit);
    p->moved = 0;
    return failed ? -1 : plant_shape(p, best->volt, shape, error);
}
