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
    const design *design = &b->a->design;
    const scene_estimate *say = &design->scene->estimate;
    for (size_t i = 0; i < b->p; i++) {
        const double half =
            i < b->loads ? 0 : (design->upper[i - b->loads] - design->lower[i - b->loads]) / 2;
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
    const analysis *analysis = b->a;
    const design *design = &analysis->design;
    const size_t inputs = design->structure.input.count;
    size_t row = 0;
    memset(amount, 0, inputs * sizeof *amount);
    amount[input] = 1;
    if (analysis->electric.state.model &&
        (pzs_open_voltages(&analysis->electric, amount) != PZS_OK ||
         pzs_charges(&analysis->electric, amount, charge) != PZS_OK))
        return -1;
    for (int r = 0; r < design->scene->estimate.readings; r++) {
        const int k = design->scene->estimate.reading[r].output;
        const scene_output *output = &design->scene->output[k];
        for (int i = 0; i < analysis_outputs(analysis, k); i++, row++) {
            const int of =
                output->electric != ELECTRIC_NONE ? electrodes_input(design, output, i) : -1;
            b->seen[row * inputs + input] =
                output->electric == ELECTRIC_NONE
                    ? analysis->influence[(size_t)(design->named_first[k] + i) * inputs + input]
                : output->electric == ELECTRIC_VOLTAGE ? amount[of]
                                                       : charge[electrodes_of(design, of)];
            b->noise[row] = design->scene->estimate.reading[r].noise;
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
    const design *design = &b->a->design;
    const size_t inputs = design->structure.input.count;
    for (size_t j = 0; j < b->p; j++) {
        for (size_t i = 0; i < b->m; i++)
            b->shape[i * b->p + j] =
                design->weight[i] * b->a->influence[i * inputs + input_of(b, j)] * b->sigma[j];
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
static void make_gains(bench *b, estimator *estimator)
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
            estimator->gain[i * b->k + k] = b->side[k] / b->noise[k];
    }
    for (size_t k = 0; k < b->k; k++) {
        memcpy(estimator->direct + k * b->n, b->seen + k * inputs,
               b->n * sizeof *estimator->direct);
        memcpy(estimator->shown + k * b->loads, b->seen + k * inputs + b->n,
               b->loads * sizeof *estimator->shown);
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
static void measure(bench *b, estimator *estimator)
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
    estimator->disturbed = sqrt(all);
    estimator->missed = sqrt(fmax(left, 0));
}

/* The direction missed most, by the power method. */
static void find_worst(bench *b, estimator *estimator)
{
    for (size_t i = 0; i < b->m; i++)
        b->way[i] = 1 + (double)i / (double)b->m;
    for (int turn = 0; turn < POWER; turn++) {
        const double size = length(b->way, b->m);
        for (size_t i = 0; i < b->m; i++)
            b->way[i] /= size > 0 ? size : 1;
        estimator->worst_disturbed = pull_back(b, b->way);
        miss(b, b->left);
        for (size_t i = 0; i < b->m; i++) {
            b->way[i] = 0;
            for (size_t j = 0; j < b->p; j++)
                b->way[i] += b->shape[i * b->p + j] * b->left[j];
        }
        estimator->worst_missed = sqrt(length(b->way, b->m));
    }
    const design *design = &b->a->design;
    for (size_t i = 0; i < b->m; i++) {
        estimator->worst[i] = design->weight[i] > 0 ? b->way[i] / design->weight[i] : 0;
        if (fabs(estimator->worst[i]) > fabs(estimator->worst[estimator->worst_target]))
            estimator->worst_target = (int)i;
    }
    const double most = estimator->worst[estimator->worst_target];
    for (size_t i = 0; i < b->m && fabs(most) > 0; i++)
        estimator->worst[i] /= most;
}

static void rate(const bench *b, estimator *estimator)
{
    double least = HUGE_VAL, most = 0;
    for (size_t i = 0; i < b->k; i++) {
        const double clear = sqrt(eigenvalue(b, i));
        most = fmax(most, clear);
        least = clear > 1 ? fmin(least, clear) : least;
        estimator->rank += clear > 1;
    }
    estimator->condition = estimator->rank > 0 ? most / least : HUGE_VAL;
}

/* ---- open ------------------------------------------------------------- */

static int no_memory(const analysis *analysis, char *error)
{
    return scene_fault(analysis->design.scene, analysis->design.scene->estimate.at, error,
                       "out of memory");
}

static void fill_tables(estimator *estimator, const design *design)
{
    const pzs_problem *problem = &design->problem;
    const pzs_estimator tables = {problem->format,   problem->scene,   0,
                                  problem->inputs,   problem->outputs, (uint16_t)estimator->sensors,
                                  estimator->direct, estimator->gain};
    const pzs_feed_forward_table known = {
        problem->format,         problem->scene,   0,
        (uint16_t)design->loads, problem->outputs, estimator->known};
    const pzs_feed_forward_table shown = {
        problem->format, problem->scene, 0, (uint16_t)design->loads, (uint16_t)estimator->sensors,
        estimator->shown};
    estimator->tables = tables;
    estimator->tables.crc = estimator->sensors > 0 ? pzs_estimate_crc(&tables) : 0;
    estimator->known_tables = known;
    estimator->known_tables.crc = pzs_estimate_known_crc(&known);
    estimator->shown_tables = shown;
    estimator->shown_tables.crc = pzs_estimate_known_crc(&shown);
}

static int refuse(const estimator *estimator, const analysis *analysis, char *error)
{
    const scene_estimate *say = &analysis->design.scene->estimate;
    char text[SCENE_ERROR];
    if (!(estimator->disturbed > 0))
        return scene_fault(analysis->design.scene, say->at, error,
                           "nothing disturbs the shape; give loads, or volts above 0");
    if (!(estimator->missed > say->tolerance * estimator->disturbed))
        return 0;
    estimator_text(estimator, analysis, text);
    return scene_fault(analysis->design.scene, say->at, error,
                       "these readings cannot see the shape: %s; add one there, or raise tolerance",
                       text);
}

static int build(bench *b, estimator *estimator, char *error)
{
    const design *design = &b->a->design;
    const size_t inputs = design->structure.input.count;
    estimator->known = calloc(b->m * b->loads + 1, sizeof *estimator->known);
    estimator->shown = calloc(b->k * b->loads + 1, sizeof *estimator->shown);
    estimator->direct = calloc(b->k * b->n + 1, sizeof *estimator->direct);
    estimator->gain = calloc(b->m * b->k + 1, sizeof *estimator->gain);
    estimator->worst = calloc(b->m + 1, sizeof *estimator->worst);
    if (!estimator->known || !estimator->shown || !estimator->direct || !estimator->gain ||
        !estimator->worst || !take(b))
        return no_memory(b->a, error);
    for (size_t i = 0; i < b->m; i++)
        memcpy(estimator->known + i * b->loads, b->a->influence + i * inputs + b->n,
               b->loads * sizeof *estimator->known);
    if (b->k > 0) {
        find_sizes(b);
        if (see(b) < 0)
            return no_memory(b->a, error);
        form(b);
        diagonalise(b);
        make_gains(b, estimator);
        measure(b, estimator);
        find_worst(b, estimator);
        rate(b, estimator);
    }
    fill_tables(estimator, design);
    return b->k > 0 ? refuse(estimator, b->a, error) : 0;
}

int estimator_open(estimator *estimator, const analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    bench b = {.a = analysis,
               .m = (size_t)design->targets,
               .n = (size_t)design->amplifiers,
               .loads = (size_t)design->loads,
               .p = (size_t)(design->loads + design->amplifiers)};
    memset(estimator, 0, sizeof *estimator);
    for (int r = 0; r < design->scene->estimate.readings; r++)
        b.k += (size_t)analysis_outputs(analysis, design->scene->estimate.reading[r].output);
    estimator->sensors = (int)b.k;
    estimator->disturbances = (int)b.p;
    const int failed = build(&b, estimator, error);
    give_back(&b);
    if (failed)
        estimator_close(estimator);
    return failed;
}

void estimator_close(estimator *estimator)
{
    free(estimator->direct);
    free(estimator->gain);
    free(estimator->known);
    free(estimator->shown);
    free(estimator->worst);
    memset(estimator, 0, sizeof *estimator);
}

void estimator_text(const estimator *estimator, const analysis *analysis, char text[SCENE_ERROR])
{
    const mesh *mesh = &analysis->design.mesh;
    const double *theta = mesh->theta[analysis->design.target_node[estimator->worst_target]];
    snprintf(
        text, SCENE_ERROR,
        "%d sensors tell %d of %d disturbances from noise (condition %.1e) and miss %.1f%% of the shape; worst "
        "direction missed by %.0f%%, largest at theta1 = %g, theta2 = %g",
        estimator->sensors, estimator->rank, estimator->disturbances, estimator->condition,
        100 * estimator->missed / estimator->disturbed,
        100 * estimator->worst_missed / estimator->worst_disturbed, theta[0], theta[1]);
}
