/* Voltage problem of a scene (design.h). */
#include "design.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../../lib/core/guard.h"

/* B'W^2 B, and the effort in m2/V2. */
static double build_hessian(design *d)
{
    const size_t n = (size_t)d->amplifiers;
    double trace = 0;
    for (int i = 0; i < d->targets; i++)
        for (size_t j = 0; j < n; j++)
            for (size_t k = 0; k < n; k++)
                d->hessian[j * n + k] += d->weight[i] * d->weight[i] *
                                         d->influence[(size_t)i * n + j] *
                                         d->influence[(size_t)i * n + k];
    for (size_t j = 0; j < n; j++)
        trace += d->hessian[j * n + j];
    return d->scene->limits.effort_is_relative ? d->scene->limits.effort * trace / d->amplifiers
                                               : d->scene->limits.effort;
}

/* ---- limits ----------------------------------------------------------- */

/* Limits of every amplifier under construction. */
typedef struct limits {
    const scene *scene;
    double *lower, *upper; /* [amplifiers] */
} limits;

/* Narrow the limits of one amplifier by the depolarisation field of a patch it drives: a field
 * against the poling. */
static void narrow_by_field(const limits *l, int k, const scene_drive *drive)
{
    const scene_layer *layer = &l->scene->layer[l->scene->patches[drive->patches].layer];
    const double field = l->scene->material[layer->material].field_limit;
    if (field <= 0 || drive->factor == 0)
        return;
    /* E3 = -factor V / h opposes poling along +e3 when factor V > 0. */
    const double most = field * layer->thickness / fabs(drive->factor);
    if ((drive->factor > 0) == (layer->poling > 0))
        l->upper[k] = fmin(l->upper[k], most);
    else
        l->lower[k] = fmax(l->lower[k], -most);
}

static void narrow_by_fields(const limits *l)
{
    for (int a = 0; a < l->scene->actuators; a++) {
        const scene_actuator *actuator = &l->scene->actuator[a];
        for (int c = 0; c < actuator->grid[0] * actuator->grid[1]; c++)
            for (int k = 0; k < actuator->drives; k++)
                narrow_by_field(l, actuator->first + c, &actuator->drive[k]);
    }
}

static void set_all(const limits *l, double lower, double upper)
{
    for (int k = 0; k < l->scene->amplifiers; k++) {
        l->lower[k] = lower;
        l->upper[k] = upper;
    }
}

/*
 * The amplifiers' own limits in place of the common ones; the last item that names an amplifier
 * applies.
 */
static void take_own(const limits *l)
{
    const scene_limits *from = &l->scene->limits;
    for (int i = 0; i < from->each_count; i++)
        for (int k = from->each[i].first; k < from->each[i].first + from->each[i].count; k++) {
            l->lower[k] = from->each[i].lower;
            l->upper[k] = from->each[i].upper;
        }
}

/* Common limits over the others; a held amplifier has one voltage, which they do not move. */
static void narrow_by_common(const limits *l, double lower, double upper)
{
    for (int k = 0; k < l->scene->amplifiers; k++)
        if (l->lower[k] != l->upper[k]) {
            l->lower[k] = fmax(l->lower[k], lower);
            l->upper[k] = fmin(l->upper[k], upper);
        }
}

/* Held amplifiers keep their voltage, the others have no limit. */
static void open_others(const limits *l)
{
    for (int k = 0; k < l->scene->amplifiers; k++)
        if (l->lower[k] != l->upper[k]) {
            l->lower[k] = -HUGE_VAL;
            l->upper[k] = HUGE_VAL;
        }
}

/* Each amplifier must have a voltage left. */
static int check_limits(const limits *l, const char *which, char *error)
{
    for (int k = 0; k < l->scene->amplifiers; k++)
        if (l->lower[k] > l->upper[k]) {
            char name[SCENE_LABEL];
            scene_amplifier_name(l->scene, k, name);
            return scene_fault(
                l->scene, l->scene->limits.at, error,
                "%s has no voltage left between %g and %g: %sits own limits and the material's "
                "field_limit do not overlap; widen one of them",
                name, l->lower[k], l->upper[k], which);
        }
    return 0;
}

/*
 * The limits of the scene: of its amplifiers where they have their own, else common, within the
 * depolarisation fields.
 */
static int build_limits(const design *d, char *error)
{
    const limits l = {d->scene, d->lower, d->upper};
    set_all(&l, d->scene->limits.lower, d->scene->limits.upper);
    take_own(&l);
    narrow_by_fields(&l);
    for (int k = 0; k < d->amplifiers; k++)
        d->slew[k] = d->scene->limits.slew;
    return check_limits(&l, "", error);
}

int design_limits(const design *d, common_limits common, double *lower, double *upper, char *error)
{
    const limits l = {d->scene, lower, upper};
    const size_t bytes = (size_t)d->amplifiers * sizeof *lower;
    memcpy(lower, d->lower, bytes);
    memcpy(upper, d->upper, bytes);
    if (common.source == LIMITS_NONE)
        open_others(&l);
    if (common.source != LIMITS_GIVEN)
        return 0;
    set_all(&l, -HUGE_VAL, HUGE_VAL);
    take_own(&l);
    narrow_by_fields(&l);
    narrow_by_common(&l, common.lower, common.upper);
    return check_limits(&l, "the limits asked for, ", error);
}

bool design_is_held(const design *d, int amplifier)
{
    return d->lower[amplifier] == d->upper[amplifier];
}

/* ---- voltage problem -------------------------------------------------- */

static int allocate_control(design *d)
{
    const size_t n = (size_t)d->amplifiers;
    d->wanted = calloc((size_t)d->targets, sizeof *d->wanted);
    d->influence = calloc((size_t)d->targets * n, sizeof *d->influence);
    d->hessian = calloc(n * n, sizeof *d->hessian);
    d->lower = calloc(n, sizeof *d->lower);
    d->upper = calloc(n, sizeof *d->upper);
    d->slew = calloc(n, sizeof *d->slew);
    d->prefer = calloc(n, sizeof *d->prefer);
    return d->wanted && d->influence && d->hessian && d->lower && d->upper && d->slew && d->prefer;
}

int design_control(design *d, const double *influence, char *error)
{
    const size_t n = (size_t)d->amplifiers, inputs = d->structure.input.count;
    pzs_problem *p = &d->problem;
    if (!d->scene->target.given)
        return scene_fault(d->scene, d->scene->limits.at, error,
                           "no target: add `target: {u3: middle, at: nodes, value: ...}`");
    if (n == 0)
        return scene_fault(d->scene, d->scene->limits.at, error, "no amplifiers: add `actuators`");
    if (!allocate_control(d))
        return scene_fault(d->scene, d->scene->limits.at, error,
                           "%d amplifiers do not fit into memory", d->amplifiers);
    if (d->fixed_rows == d->targets)
        return scene_fault(d->scene, d->scene->target.what.at, error,
                           "all %d target rows lie on constrained dof and "
                           "cannot move; choose other nodes or another direction",
                           d->targets);
    design_influence_free(d, influence, inputs, d->wanted, d->influence);
    for (size_t i = 0; i < (size_t)d->targets; i++) {
        d->wanted[i] = 0;
        for (size_t load = n; load < n + (size_t)d->loads; load++)
            d->wanted[i] += influence[i * inputs + load];
    }
    design_take_free(d, d->wanted);
    for (int i = 0; i < d->targets; i++)
        d->wanted[i] = d->target[i] - d->wanted[i];
    p->regularisation = build_hessian(d);
    if (build_limits(d, error) < 0)
        return -1;
    p->format = PZS_TABLE_FORMAT;
    p->scene = d->scene->hash;
    p->inputs = (uint16_t)n;
    p->outputs = (uint16_t)d->targets;
    p->influence = d->influence;
    p->hessian = d->hessian;
    p->weight = d->weight;
    p->lower = d->lower;
    p->upper = d->upper;
    p->step_limit = d->slew;
    p->reference_voltage = d->prefer;
    p->crc = pzs_problem_crc(p);
    return 0;
}
