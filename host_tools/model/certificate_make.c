/* Stability of the control loop of a scene (certificate_make.h). */
#include "certificate_make.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/model.h"
#include "estimator.h"
#include "mass.h"

enum {
    EXACT = 40,        /* matrix squarings for the spectral radius at the scene's rate */
    QUICK = 16,        /* matrix squarings for the spectral radius at a scanned rate */
    STATE_LIMIT = 300, /* largest number of states of the loop */
    DELAY_LIMIT = 100, /* largest delay in ticks */
    RATE_LIMIT = 2000, /* largest number of scanned rates */
    PHASES = 8,        /* intervals tried within one period of the first mode */
    STARTS = 4         /* attempts to find a first stable rate */
};

static const double two_pi = 6.283185307179586;

/* Scan of the rates: first rate over zeta w1, ratio of neighbours, last rate over the highest
 * frequency of the loop. */
static const double scan_from = 0.5, scan_step = 1.02, scan_to = 10;

/* Smallest regularisation relative to the mean diagonal of B'W^2 B; it keeps the matrix positive
 * definite where amplifiers have the same effect. */
static const double least_regularisation = 1e-12;

/* ---- gains ------------------------------------------------------------ */

/* Cholesky factor of a [n][n] in its lower triangle. Returns success. */
static int cholesky(double *a, size_t n)
{
    for (size_t j = 0; j < n; j++) {
        for (size_t i = j; i < n; i++)
            for (size_t k = 0; k < j; k++)
                a[i * n + j] -= a[i * n + k] * a[j * n + k];
        if (!(a[j * n + j] > 0))
            return 0;
        const double pivot = sqrt(a[j * n + j]);
        for (size_t i = j; i < n; i++)
            a[i * n + j] /= pivot;
    }
    return 1;
}

/* x = (L L')^-1 x */
static void cholesky_solve(const double *l, size_t n, double *x)
{
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < i; k++)
            x[i] -= l[i * n + k] * x[k];
        x[i] /= l[i * n + i];
    }
    for (size_t i = n; i-- > 0;) {
        for (size_t k = i + 1; k < n; k++)
            x[i] -= l[k * n + i] * x[k];
        x[i] /= l[i * n + i];
    }
}

/* What the gains are made from. */
typedef struct gains {
    const analysis *a;
    const vibration *v;
    size_t modes, n;   /* n: amplifiers that can move */
    size_t *amplifier; /* [n] */
    double *factor;    /* [n][n] B'W^2 B and its regularisation, factored */
    double *shape;     /* [targets] what the controller takes for a mode's shape */
    double *x;         /* [n] */
    double *given;     /* [modes][n] modal coordinates per unit of voltage */
    double *loop;      /* [modes][modes] */
    int as_measured;   /* an estimate's sensors are left out */
} gains;

static size_t list_amplifiers(const design *design, size_t *amplifier)
{
    size_t n = 0;
    for (int k = 0; k < design->amplifiers; k++)
        if (design->lower[k] < design->upper[k])
            amplifier[n++] = (size_t)k;
    return n;
}

static int factor_hessian(gains *g)
{
    const design *design = &g->a->design;
    double trace = 0;
    for (size_t i = 0; i < g->n; i++)
        for (size_t j = 0; j < g->n; j++)
            g->factor[i * g->n + j] =
                design->hessian[g->amplifier[i] * (size_t)design->amplifiers + g->amplifier[j]];
    for (size_t i = 0; i < g->n; i++)
        trace += g->factor[i * g->n + i];
    for (size_t i = 0; i < g->n; i++)
        g->factor[i * g->n + i] +=
            design->problem.regularisation + least_regularisation * trace / (double)g->n;
    return g->n > 0 && cholesky(g->factor, g->n);
}

/*
 * Does every reading of the estimate show a displacement? Then its rows are those of the structure.
 */
static int reads_displacements(const scene *scene)
{
    for (int i = 0; i < scene->estimate.readings; i++)
        if (scene->output[scene->estimate.reading[i].output].electric != ELECTRIC_NONE)
            return 0;
    return 1;
}

/* The shape estimated from what the sensors show of a displacement u. */
static void estimated_shape(const gains *g, const estimator *estimator, const double *u)
{
    const design *design = &g->a->design;
    const scene *scene = design->scene;
    int sensor = 0;
    memset(g->shape, 0, (size_t)design->targets * sizeof *g->shape);
    for (int i = 0; i < scene->estimate.readings; i++) {
        const int output = scene->estimate.reading[i].output;
        for (int row = design->named_first[output]; row < design->named_first[output + 1]; row++) {
            const double shown = pzs_model_observe_row(&design->structure, u, (uint32_t)row);
            for (int t = 0; t < design->targets; t++)
                g->shape[t] +=
                    estimator->gain[(size_t)t * (size_t)estimator->sensors + (size_t)sensor] *
                    shown;
            sensor++;
        }
    }
}

/* Column of g F that belongs to a mode. */
static void fill_column(gains *g, const estimator *estimator, size_t mode)
{
    const design *design = &g->a->design;
    const size_t dof = (size_t)design->mesh.dof;
    const double *u = g->v->shape + ((size_t)g->v->rigid + mode) * dof;
    if (estimator)
        estimated_shape(g, estimator, u);
    else
        design_shape(design, u, g->shape);
    for (size_t j = 0; j < g->n; j++) {
        g->x[j] = 0;
        for (int t = 0; t < design->targets; t++)
            g->x[j] += design->influence[(size_t)t * (size_t)design->amplifiers + g->amplifier[j]] *
                       design->weight[t] * design->weight[t] * g->shape[t];
    }
    cholesky_solve(g->factor, g->n, g->x);
    for (size_t i = 0; i < g->modes; i++) {
        double sum = 0;
        for (size_t j = 0; j < g->n; j++)
            sum += g->given[i * g->n + j] * g->x[j];
        g->loop[i * g->modes + mode] = sum;
    }
}

static int fill_gains(gains *g)
{
    estimator estimator;
    char ignored[SCENE_ERROR];
    const scene *scene = g->a->design.scene;
    g->n = list_amplifiers(&g->a->design, g->amplifier);
    if (!factor_hessian(g))
        return 0;
    for (size_t i = 0; i < g->modes; i++)
        for (size_t j = 0; j < g->n; j++)
            g->given[i * g->n + j] =
                vibration_static(g->v, &g->a->design, g->v->rigid + (int)i, (int)g->amplifier[j]);
    const int wanted = scene->estimate.given && scene->simulate.sight != SIGHT_MEASURED;
    const int estimates =
        wanted && reads_displacements(scene) && estimator_open(&estimator, g->a, ignored) == 0;
    g->as_measured = wanted && !estimates;
    for (size_t mode = 0; mode < g->modes; mode++)
        fill_column(g, estimates ? &estimator : NULL, mode);
    if (estimates)
        estimator_close(&estimator);
    return 1;
}

/* g F of the lowest modes that are no rigid motion, to be freed; NULL where it cannot be made. */
static double *loop_gains(const analysis *analysis, const vibration *vibration, int modes,
                          int *as_measured)
{
    const size_t amplifiers = (size_t)analysis->design.amplifiers;
    gains g = {.a = analysis, .v = vibration, .modes = (size_t)modes};
    g.amplifier = malloc(amplifiers * sizeof *g.amplifier);
    g.factor = malloc(amplifiers * amplifiers * sizeof *g.factor);
    g.x = malloc(amplifiers * sizeof *g.x);
    g.shape = malloc((size_t)analysis->design.targets * sizeof *g.shape);
    g.given = malloc(g.modes * amplifiers * sizeof *g.given);
    g.loop = malloc(g.modes * g.modes * sizeof *g.loop);
    const int filled =
        g.amplifier && g.factor && g.x && g.shape && g.given && g.loop && fill_gains(&g);
    free(g.amplifier);
    free(g.factor);
    free(g.x);
    free(g.shape);
    free(g.given);
    *as_measured = g.as_measured;
    if (filled)
        return g.loop;
    free(g.loop);
    return NULL;
}

/* ---- verdict ---------------------------------------------------------- */

/* What the radius is judged with. */
typedef struct judged_loop {
    const double *loop, *square;
    int modes, delay;
    double damping;
} judged_loop;

/*
 * Is the loop stable at a rate? Between ticks many periods apart the phase of the first mode, not
 * the decay alone, decides: then the intervals up to one period longer have to be stable too.
 */
static int is_stable(const judged_loop *l, double rate)
{
    const double period = two_pi / sqrt(l->square[0]), interval = 1 / rate;
    const int phases = interval > 4 * period ? PHASES : 1;
    for (int k = 0; k < phases; k++) {
        const double longer = interval + period * k / PHASES;
        if (!(certificate_radius(l->loop, l->square, l->modes, l->damping, l->delay, longer,
                                 QUICK) < 1))
            return 0;
    }
    return 1;
}

/*
 * The rate up to which every rate scanned is stable: 0 where the first ones are not, infinite where
 * all are.
 */
static double scan_rates(const judged_loop *l)
{
    const double end = scan_to * sqrt(l->square[l->modes - 1]) / two_pi;
    double rate = scan_from * l->damping * sqrt(l->square[0]), stable = 0;
    for (int i = 0; i < STARTS && !is_stable(l, rate); i++)
        rate /= 4;
    for (int i = 0; i < RATE_LIMIT && rate < end; i++) {
        if (!is_stable(l, rate))
            return stable;
        stable = rate;
        rate *= scan_step;
    }
    return rate < end ? stable : HUGE_VAL;
}

static void judge(certificate *certificate, const analysis *analysis)
{
    const scene *scene = analysis->design.scene;
    const int first = vibration_first(&certificate->vibration), delay = scene->simulate.delay,
              most = STATE_LIMIT / (delay + 3);
    const double *square = certificate->vibration.square + first;
    certificate->modes = certificate->vibration.count - first;
    certificate->modes = certificate->modes < most ? certificate->modes : most;
    if (certificate->modes < 1 || analysis->design.problem.inputs == 0)
        return;
    if (delay > DELAY_LIMIT) {
        snprintf(certificate->why_not, sizeof certificate->why_not,
                 "sensors %d ticks late: at most %d can be judged", delay, DELAY_LIMIT);
        return;
    }
    double *loop = loop_gains(analysis, &certificate->vibration, certificate->modes,
                              &certificate->as_measured);
    if (!loop) {
        snprintf(certificate->why_not, sizeof certificate->why_not,
                 "its gains cannot be computed; add a regularisation, limits.effort");
        return;
    }
    certificate->is_judged = 1;
    if (certificate->rate > 0) {
        certificate->radius =
            certificate_radius(loop, square, certificate->modes, certificate->damping, delay,
                               1 / certificate->rate, EXACT);
        certificate->gain = 2 * certificate->damping * sqrt(square[0]) / certificate->rate;
    }
    const judged_loop judged = {loop, square, certificate->modes, delay, certificate->damping};
    certificate->rate_to = scan_rates(&judged);
    free(loop);
}

void certificate_make(certificate *certificate, const analysis *analysis)
{
    const scene *scene = analysis->design.scene;
    if (certificate->made)
        return;
    memset(certificate, 0, sizeof *certificate);
    certificate->made = 1;
    certificate->damping = scene->dynamics.damping;
    certificate->damping_given = scene->dynamics.damping_given;
    certificate->rate = scene->simulate.given ? scene->simulate.rate : 0;
    certificate->radius = certificate->gain = certificate->rate_to = (double)NAN;
    certificate->vibrates =
        vibration_solve(&certificate->vibration, &analysis->design, scene->dynamics.modes,
                        MASS_LUMPED, certificate->why_not) == 0;
    if (certificate->vibrates)
        judge(certificate, analysis);
}
