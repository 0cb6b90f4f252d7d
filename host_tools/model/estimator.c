/* Estimation of the shape from a few sensors (estimator.h). */
#include "estimator.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "eigen.h"
#include "electrodes.h"
#include "../../lib/control/estimate.h"

enum { SWEEPS = 30, POWER = 300 };

/* Everything that is needed on the way. */
typedef struct bench {
    const analysis *a;
    size_t m, n, loads, p, k; /* targets, amplifiers, loads, disturbances, sensors */
    double *sigma;            /* [p] of loads, then amplifiers */
    double *seen;             /* [k][inputs] per unit of every input */
    double *noise;            /* [k] */
    double *shape;            /* W A [m][p] */
    double *clear;            /* N^-1 C [k][p] */
    double *square;           /* [k][k] N^-1 C C' N^-1, then its eigenvalues on the diagonal */
    double *turn;             /* [k][k] its eigenvectors, as columns */
    double *left, *side, *way, *turned; /* [p], [k], [m], [k] work */
} bench;

static int take(bench *b)
{
    const size_t inputs = b->a->design.structure.input.count;
    b->sigma = calloc(b->p + 1, sizeof *b->sigma);
    b->seen = calloc(b->k * inputs + 1, sizeof *b->seen);
    b->noise = calloc(b->k + 1, sizeof *b->noise);
    b->shape = calloc(b->m * b->p + 1, sizeof *b->shape);
    b->clear = calloc(b->k * b->p + 1, sizeof *b->clear);
    b->square = calloc(b->k * b->k + 1, sizeof *b->square);
    b->turn = calloc(b->k * b->k + 1, sizeof *b->turn);
    b->left = calloc(b->p + 1, sizeof *b->left);
    b->side = calloc(b->k + 1, sizeof *b->side);
    b->way = calloc(b->m + 1, sizeof *b->way);
    b->turned = calloc(b->k + 1, sizeof *b->turned);
    return b->sigma && b->seen && b->noise && b->shape && b->clear && b->square && b->turn &&
           b->left && b->side && b->way && b->turned;
}

static void give_back(bench *b)
{
    double *const all[] = {b->sigma, b->seen, b->noise, b->shape, b->clear, b->square,
                           b->turn,  b->left, b->side,  b->way,   b->turned};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        free(all[i]);
}

/* ---- what disturbs, what is seen ------------------------------------- */

/* Input of a disturbance: loads stand behind the amplifiers. */
static size_t input_of(const bench *b, size_t disturbance)
{
    return disturbance < b->loads ? b->n + disturbance : disturbance - b->loads;
}

static void find_sizes(bench *b)
{
    const design *d = &b->a->design;
    const scene_estimate *say = &d->scene->estimate;
    for (size_t i = 0; i < b->p; i++) {
        const double half =
            i < b->loads ? 0 : (d->upper[i - b->loads] - d->lower[i - b->loads]) / 2;
        b->sigma[i] = i < b->loads      ? say->loads
                      : say->volts >= 0 ? say->volts
                      : isfinite(half)  ? half / 10
                                        : 1;
    }
}

/* Readings per unit of one input: displacements from the influence, volts and charges with open
 * electrodes free. */
static int see_input(bench *b, size_t input, double *amount, double *charge)
{
    const analysis *a = b->a;
    const design *d = &a->design;
    const size_t inputs = d->structure.input.count;
    size_t row = 0;
    memset(amount, 0, inputs * sizeof *amount);
    amount[input] = 1;
    if (a->electric.state.model && (pzs_open_voltages(&a->electric, amount) != PZS_OK ||
                                    pzs_charges(&a->electric, amount, charge) != PZS_OK))
        return -1;
    for (int r = 0; r < d->scene->estimate.readings; r++) {
        const int k = d->scene->estimate.reading[r].output;
        const scene_output *output = &d->scene->output[k];
        for (int i = 0; i < analysis_outputs(a, k); i++, row++) {
            const int of = output->electric != ELECTRIC_NONE ? electrodes_input(d, output, i) : -1;
            b->seen[row * inputs + input] =
                output->electric == ELECTRIC_NONE
                    ? a->influence[(size_t)(d->named_first[k] + i) * inputs + input]
                : output->electric == ELECTRIC_VOLTAGE ? amount[of]
                                                       : charge[electrodes_of(d, of)];
            b->noise[row] = d->scene->estimate.reading[r].noise;
        }
    }
    return 0;
}

static int see(bench *b)
{
    const size_t inputs = b->a->design.structure.input.count;
    double *amount = calloc(inputs, sizeof *amount),
           *charge = calloc(b->a->design.electrodes.count + 1u, sizeof *charge);
    int failed = !amount || !charge;
    for (size_t i = 0; !failed && i < b->n + b->loads; i++)
        failed = see_input(b, i, amount, charge);
    free(amount);
    free(charge);
    return failed ? -1 : 0;
}

/* W A, N^-1 C and its square. */
static void form(bench *b)
{
    const design *d = &b->a->design;
    const size_t inputs = d->structure.input.count;
    for (size_t j = 0; j < b->p; j++) {
        for (size_t i = 0; i < b->m; i++)
            b->shape[i * b->p + j] =
                d->weight[i] * b->a->influence[i * inputs + input_of(b, j)] * b->sigma[j];
        for (size_t i = 0; i < b->k; i++)
            b->clear[i * b->p + j] =
                b->seen[i * inputs + input_of(b, j)] * b->sigma[j] / b->noise[i];
    }
    for (size_t i = 0; i < b->k; i++)
        for (size_t l = 0; l < b->k; l++)
            for (size_t j = 0; j < b->p; j++)
                b->square[i * b->k + l] += b->clear[i * b->p + j] * b->clear[l * b->p + j];
}

/* ---- eigenvalues ------------------------------------------------------ */

/* square becomes diagonal, turn its eigenvectors. */
static void diagonalise(bench *b)
{
    eigen_symmetric(b->square, b->turn, b->k, SWEEPS, 0);
}

static double eigenvalue(const bench *b, size_t i)
{
    return fmax(b->square[i * b->k + i], 0);
}

/* side = (1 + square)^-1 side. */
static void filter(bench *b)
{
    const size_t n = b->k;
    for (size_t e = 0; e < n; e++) {
        b->turned[e] = 0;
        for (size_t i = 0; i < n; i++)
            b->turned[e] += b->turn[i * n + e] * b->side[i];
        b->turned[e] /= 1 + eigenvalue(b, e);
    }
    for (size_t i = 0; i < n; i++) {
        b->side[i] = 0;
        for (size_t e = 0; e < n; e++)
            b->side[i] += b->turn[i * n + e] * b->turned[e];
    }
}

/* ---- gains ------------------------------------------------------------ */

/* Row i of G: that of A, C' and the filter; row [m] of A without its weight. */
static void make_gains(bench *b, estimator *e)
{
    const size_t inputs = b->a->design.structure.input.count;
    for (size_t i = 0; i < b->m; i++) {
        for (size_t k = 0; k < b->k; k++) {
            b->side[k] = 0;
            for (size_t j = 0; j < b->p; j++)
                b->side[k] += b->a->influence[i * inputs + input_of(b, j)] * b->sigma[j] *
                              b->clear[k * b->p + j];
        }
        filter(b);
        for (size_t k = 0; k < b->k; k++)
            e->gain[i * b->k + k] = b->side[k] / b->noise[k];
    }
    for (size_t k = 0; k < b->k; k++) {
        memcpy(e->direct + k * b->n, b->seen + k * inputs, b->n * sizeof *e->direct);
        memcpy(e->shown + k * b->loads, b->seen + k * inputs + b->n, b->loads * sizeof *e->shown);
    }
}

/* left [p] = what the sensors do not take from a disturbance: (1 + C'N^-2 C)^-1 left. */
static void miss(bench *b, double *left)
{
    for (size_t k = 0; k < b->k; k++) {
        b->side[k] = 0;
        for (size_t j = 0; j < b->p; j++)
            b->side[k] += b->clear[k * b->p + j] * left[j];
    }
    filter(b);
    for (size_t j = 0; j < b->p; j++)
        for (size_t k = 0; k < b->k; k++)
            left[j] -= b->clear[k * b->p + j] * b->side[k];
}

/* left = A'W way. Returns its length. */
static double pull_back(bench *b, const double *way)
{
    double sum = 0;
    for (size_t j = 0; j < b->p; j++) {
        b->left[j] = 0;
        for (size_t i = 0; i < b->m; i++)
            b->left[j] += b->shape[i * b->p + j] * way[i];
        sum += b->left[j] * b->left[j];
    }
    return sqrt(sum);
}

static double length(const double *x, size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += x[i] * x[i];
    return sqrt(sum);
}

/* What the disturbances do, and what is missed of it, in the mean: the traces of A A' and of what
 * is left. */
static void measure(bench *b, estimator *e)
{
    double all = 0, left = 0;
    for (size_t i = 0; i < b->m; i++) {
        const double *row = b->shape + i * b->p;
        memcpy(b->left, row, b->p * sizeof *row);
        miss(b, b->left);
        for (size_t j = 0; j < b->p; j++) {
            all += row[j] * row[j];
            left += row[j] * b->left[j];
        }
    }
    e->disturbed = sqrt(all);
    e->missed = sqrt(fmax(left, 0));
}

/* The direction missed most, by the power method. */
static void find_worst(bench *b, estimator *e)
{
    for (size_t i = 0; i < b->m; i++)
        b->way[i] = 1 + (double)i / (double)b->m;
    for (int turn = 0; turn < POWER; turn++) {
        const double size = length(b->way, b->m);
        for (size_t i = 0; i < b->m; i++)
            b->way[i] /= size > 0 ? size : 1;
        e->worst_disturbed = pull_back(b, b->way);
        miss(b, b->left);
        for (size_t i = 0; i < b->m; i++) {
            b->way[i] = 0;
            for (size_t j = 0; j < b->p; j++)
                b->way[i] += b->shape[i * b->p + j] * b->left[j];
        }
        e->worst_missed = sqrt(length(b->way, b->m));
    }
    const design *d = &b->a->design;
    for (size_t i = 0; i < b->m; i++) {
        e->worst[i] = d->weight[i] > 0 ? b->way[i] / d->weight[i] : 0;
        if (fabs(e->worst[i]) > fabs(e->worst[e->worst_target]))
            e->worst_target = (int)i;
    }
    const double most = e->worst[e->worst_target];
    for (size_t i = 0; i < b->m && fabs(most) > 0; i++)
        e->worst[i] /= most;
}

static void rate(const bench *b, estimator *e)
{
    double least = HUGE_VAL, most = 0;
    for (size_t i = 0; i < b->k; i++) {
        const double clear = sqrt(eigenvalue(b, i));
        most = fmax(most, clear);
        least = clear > 1 ? fmin(least, clear) : least;
        e->rank += clear > 1;
    }
    e->condition = e->rank > 0 ? most / least : HUGE_VAL;
}

/* ---- open ------------------------------------------------------------- */

static int no_memory(const analysis *a, char *error)
{
    return scene_fault(a->design.scene, a->design.scene->estimate.at, error, "out of memory");
}

static void fill_tables(estimator *e, const design *d)
{
    const pzs_problem *p = &d->problem;
    const pzs_estimator t = {p->format, p->scene, 0, p->inputs, p->outputs, (uint16_t)e->sensors,
                             e->direct, e->gain};
    const pzs_feed_forward_table known = {p->format,          p->scene,   0,
                                          (uint16_t)d->loads, p->outputs, e->known};
    const pzs_feed_forward_table shown = {
        p->format, p->scene, 0, (uint16_t)d->loads, (uint16_t)e->sensors, e->shown};
    e->tables = t;
    e->tables.crc = e->sensors > 0 ? pzs_estimate_crc(&t) : 0;
    e->known_tables = known;
    e->known_tables.crc = pzs_estimate_known_crc(&known);
    e->shown_tables = shown;
    e->shown_tables.crc = pzs_estimate_known_crc(&shown);
}

static int refuse(const estimator *e, const analysis *a, char *error)
{
    const scene_estimate *say = &a->design.scene->estimate;
    char text[SCENE_ERROR];
    if (!(e->disturbed > 0))
        return scene_fault(a->design.scene, say->at, error,
                           "nothing disturbs the shape; give loads, or volts above 0");
    if (!(e->missed > say->tolerance * e->disturbed))
        return 0;
    estimator_text(e, a, text);
    return scene_fault(a->design.scene, say->at, error,
                       "these readings cannot see the shape: %s; add one there, or raise tolerance",
                       text);
}

static int build(bench *b, estimator *e, char *error)
{
    const design *d = &b->a->design;
    const size_t inputs = d->structure.input.count;
    e->known = calloc(b->m * b->loads + 1, sizeof *e->known);
    e->shown = calloc(b->k * b->loads + 1, sizeof *e->shown);
    e->direct = calloc(b->k * b->n + 1, sizeof *e->direct);
    e->gain = calloc(b->m * b->k + 1, sizeof *e->gain);
    e->worst = calloc(b->m + 1, sizeof *e->worst);
    if (!e->known || !e->shown || !e->direct || !e->gain || !e->worst || !take(b))
        return no_memory(b->a, error);
    for (size_t i = 0; i < b->m; i++)
        memcpy(e->known + i * b->loads, b->a->influence + i * inputs + b->n,
               b->loads * sizeof *e->known);
    if (b->k > 0) {
        find_sizes(b);
        if (see(b) < 0)
            return no_memory(b->a, error);
        form(b);
        diagonalise(b);
        make_gains(b, e);
        measure(b, e);
        find_worst(b, e);
        rate(b, e);
    }
    fill_tables(e, d);
    return b->k > 0 ? refuse(e, b->a, error) : 0;
}

int estimator_open(estimator *e, const analysis *a, char *error)
{
    const design *d = &a->design;
    bench b = {.a = a,
               .m = (size_t)d->targets,
               .n = (size_t)d->amplifiers,
               .loads = (size_t)d->loads,
               .p = (size_t)(d->loads + d->amplifiers)};
    memset(e, 0, sizeof *e);
    for (int r = 0; r < d->scene->estimate.readings; r++)
        b.k += (size_t)analysis_outputs(a, d->scene->estimate.reading[r].output);
    e->sensors = (int)b.k;
    e->disturbances = (int)b.p;
    const int failed = build(&b, e, error);
    give_back(&b);
    if (failed)
        estimator_close(e);
    return failed;
}

void estimator_close(estimator *e)
{
    free(e->direct);
    free(e->gain);
    free(e->known);
    free(e->shown);
    free(e->worst);
    memset(e, 0, sizeof *e);
}

void estimator_text(const estimator *e, const analysis *a, char text[SCENE_ERROR])
{
    const mesh *m = &a->design.mesh;
    const double *theta = m->theta[a->design.target_node[e->worst_target]];
    snprintf(
        text, SCENE_ERROR,
        "%d sensors tell %d of %d disturbances from noise (condition %.1e) and miss %.1f%% of the shape; worst "
        "direction missed by %.0f%%, largest at theta1 = %g, theta2 = %g",
        e->sensors, e->rank, e->disturbances, e->condition, 100 * e->missed / e->disturbed,
        100 * e->worst_missed / e->worst_disturbed, theta[0], theta[1]);
}
