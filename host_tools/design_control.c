/* Voltage problem of a scene (design.h). */
#include "design.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "guard.h"

/* B'W^2 B, and the effort in m2/V2. */
static double build_hessian(design *d)
{
    const size_t n = (size_t)d->amplifiers;
    double trace = 0;
    for (int i = 0; i < d->targets; i++)
        for (size_t j = 0; j < n; j++)
            for (size_t k = 0; k < n; k++)
                d->hessian[j * n + k] += d->weight[i] * d->weight[i] * d->influence[(size_t)i * n + j] * d->influence[(size_t)i * n + k];
    for (size_t j = 0; j < n; j++)
        trace += d->hessian[j * n + j];
    return d->scene->limits.effort_is_relative ? d->scene->limits.effort * trace / d->amplifiers : d->scene->limits.effort;
}

/* Narrow the limits of one amplifier by the depolarisation field of a patch it drives: a field against the poling. */
static void narrow_by_field(design *d, int k, const scene_drive *drive)
{
    const scene_layer *layer = &d->scene->layer[d->scene->patches[drive->patches].layer];
    const double field = d->scene->material[layer->material].field_limit;
    if (field <= 0 || drive->factor == 0)
        return;
    /* E3 = -factor V / h opposes poling along +e3 when factor V > 0. */
    const double volt = field * layer->thickness / fabs(drive->factor);
    if ((drive->factor > 0) == (layer->poling > 0))
        d->upper[k] = fmin(d->upper[k], volt);
    else
        d->lower[k] = fmax(d->lower[k], -volt);
}

static int build_limits(design *d, char *error)
{
    const scene_limits *limits = &d->scene->limits;
    for (int k = 0; k < d->amplifiers; k++) {
        d->lower[k] = limits->lower;
        d->upper[k] = limits->upper;
        d->slew[k] = limits->slew;
    }
    for (int i = 0; i < limits->each_count; i++)
        for (int k = limits->each[i].first; k < limits->each[i].first + limits->each[i].count; k++) {
            d->lower[k] = limits->each[i].lower;
            d->upper[k] = limits->each[i].upper;
        }
    for (int a = 0; a < d->scene->actuators; a++) {
        const scene_actuator *actuator = &d->scene->actuator[a];
        for (int c = 0; c < actuator->grid[0] * actuator->grid[1]; c++)
            for (int k = 0; k < actuator->drives; k++)
                narrow_by_field(d, actuator->first + c, &actuator->drive[k]);
    }
    for (int k = 0; k < d->amplifiers; k++)
        if (d->lower[k] > d->upper[k]) {
            char name[SCENE_LABEL];
            scene_amplifier_name(d->scene, k, name);
            return scene_fault(d->scene, limits->at, error, "%s has no voltage left between %g and %g; its limits and the material's field_limit do not meet",
                               name, d->lower[k], d->upper[k]);
        }
    return 0;
}

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
        return scene_fault(d->scene, d->scene->limits.at, error, "no target: add `target: {u3: middle, at: nodes, value: ...}`");
    if (n == 0)
        return scene_fault(d->scene, d->scene->limits.at, error, "no amplifiers: add `actuators`");
    if (!allocate_control(d))
        return scene_fault(d->scene, d->scene->limits.at, error, "%d amplifiers do not fit into memory", d->amplifiers);
    for (size_t i = 0; i < (size_t)d->targets; i++) {
        memcpy(d->influence + i * n, influence + i * inputs, n * sizeof *d->influence);
        d->wanted[i] = d->target[i];
        for (size_t load = n; load < n + (size_t)d->loads; load++)
            d->wanted[i] -= influence[i * inputs + load];
    }
    p->effort = build_hessian(d);
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
    p->slew = d->slew;
    p->prefer = d->prefer;
    p->crc = guard_problem_crc(p);
    return 0;
}
