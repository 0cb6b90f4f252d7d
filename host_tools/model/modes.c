/* Modes of a target, one by one (modes.h). */
#include "modes.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../cli/progress.h"

/* Without limits, once for all of them. */
static int run_unlimited(analysis *a, mode *m, char *error)
{
    voltages v;
    const int failed = voltages_optimum(a, (common_limits){.source = LIMITS_NONE}, &v, error);
    m->unlimited = v.error;
    for (int k = 0; !failed && k < v.volts; k++)
        m->volt = fmax(m->volt, fabs(v.volt[k]));
    voltages_free(&v);
    return failed;
}

static int run_limited(analysis *a, common_limits limit, mode_left *left, char *error)
{
    voltages best, cut, tuned;
    memset(&cut, 0, sizeof cut);
    memset(&tuned, 0, sizeof tuned);
    const int failed = voltages_optimum(a, limit, &best, error) < 0 ||
                       voltages_clipped(a, limit, &cut, error) < 0 ||
                       voltages_regularised(a, limit, &tuned, error) < 0;
    memcpy(left->limit, best.limit, sizeof left->limit);
    left->optimum = best.error;
    left->active = best.active;
    left->clipped = cut.error;
    left->regularised = tuned.error;
    voltages_free(&best);
    voltages_free(&cut);
    voltages_free(&tuned);
    return failed ? -1 : 0;
}

/* Root mean square of the target, by its weights. */
static double target_size(const design *d)
{
    double weights = 0;
    for (int i = 0; i < d->targets; i++)
        weights += pow(d->weight[i], 2);
    return sqrt(design_squares(d, d->target, NULL) / weights);
}

/* Mode k of the target in the target's place, what the scene's loads move taken off as there.
 * loaded [targets] in */
static int run_mode(modes *m, int k, analysis *a, const double *loaded, const common_limits *limit,
                    char *error)
{
    design *d = &a->design;
    const scene_mode *wanted = &d->scene->target.mode[k];
    if (design_target_values(d, wanted->value, wanted->at, d->target, error) < 0)
        return -1;
    for (int i = 0; i < d->targets; i++)
        d->wanted[i] = d->target[i] - loaded[i];
    m->mode[k].size = target_size(d);
    int failed = run_unlimited(a, &m->mode[k], error);
    for (int l = 0; !failed && l < m->limits; l++)
        failed = run_limited(a, limit[l], &m->left[k * m->limits + l], error);
    return failed;
}

int modes_run(modes *m, analysis *a, const common_limits *limit, int limits, char *error)
{
    design *d = &a->design;
    const size_t n = (size_t)d->targets, count = (size_t)d->scene->target.modes;
    memset(m, 0, sizeof *m);
    m->limits = limits;
    m->mode = calloc(count + 1, sizeof *m->mode);
    m->left = calloc(count * (size_t)limits + 1, sizeof *m->left);
    double *kept = calloc(3 * n + 1, sizeof *kept); /* target, wanted, and their difference */
    int failed = !m->mode || !m->left || !kept
                     ? scene_fault(d->scene, d->scene->target.what.at, error,
                                   "%zu modes do not fit into memory", count)
                     : 0;
    if (!failed) {
        memcpy(kept, d->target, n * sizeof *kept);
        memcpy(kept + n, d->wanted, n * sizeof *kept);
        for (size_t i = 0; i < n; i++)
            kept[2 * n + i] = kept[i] - kept[n + i];
        for (; !failed && m->count < (int)count; m->count++) {
            progress_count(m->count, (int)count);
            failed = run_mode(m, m->count, a, kept + 2 * n, limit, error);
        }
        memcpy(d->target, kept, n * sizeof *kept);
        memcpy(d->wanted, kept + n, n * sizeof *kept);
    }
    free(kept);
    return failed;
}

void modes_free(modes *m)
{
    free(m->mode);
    free(m->left);
    memset(m, 0, sizeof *m);
}
