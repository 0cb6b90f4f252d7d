/*
 * Growth of the controller with the number of inputs, against OpenBLAS, double, one thread.
 *
 * A square mirror of n actuators with Gaussian influence functions on m = 4 n outputs. Shown are,
 * in microseconds and as a multiple of the peer's time:
 *   start   pzs_control_init with the Hessian in the tables, as `pzs tables` writes it, against the
 *           Cholesky factor of the Hessian: checksum and check of 32 MB of tables (1024 inputs),
 *           copies, and the inverse, which takes three times the multiply-adds of the factor
 *   formed  pzs_control_init without it, as after the influence matrix was computed on the device,
 *           against the symmetric product B'B and the factor
 *   warm    pzs_tick on a slowly moving target       against one product with the influence matrix
 *   jump    pzs_step on a target that jumps          (mean and worst; frames out of work)
 *   sparse  pzs_tick on a slowly moving target, on a mirror whose influence functions end at 1e-3
 * of their peak: sparse influence matrix (and full matrix), against one product of the peer with
 * the full matrix; the part of the entries that is not zero and, below, the exponents of a power of
 * n fitted from one row to the next.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include "pzs.h"
#include <cblas.h>
/* LAPACK: Cholesky factor of a matrix by columns. */
void dpotrf_(const char *uplo, const int *n, double *a, const int *stride, int *info);

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "clock.h"

#define WIDTH 1.2      /* of an influence function, in actuator pitches */
#define WIDE 200.0     /* exponent at which an influence function ends, to save no underflow */
#define NARROW 6.9     /* exponent at which an influence function ends, 1e-3 of its peak */
#define LIMIT 0.6      /* voltage limit (V); targets have the size 1 */
#define FRAMES 12      /* frames of the jumping target */
#define REPEATS 5      /* repetitions of a measurement, of which the median counts */
#define SOFTENING 1e-6 /* regularisation over the mean diagonal of the Hessian */

enum { START, CHOLESKY, FORMED, FORM, WARM, PRODUCT, JUMP, WORST, FULL, SPARSE, TIMES };

typedef struct mirror {
    int n, m;
    double *influence, *hessian, *weight, *lower, *upper, *step_limit, *reference, *wanted;
    void *work;
    size_t bytes;
    pzs_sparse_influence sparse;
    pzs_problem problem;
    pzs_control control;
} mirror;

static uint64_t seed = 1;

static double uniform(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1;
}

static double *reals(size_t count)
{
    void *memory = NULL;
    if (posix_memalign(&memory, 64, (count + 8) * sizeof(double)) != 0)
        exit(1);
    return memset(memory, 0, (count + 8) * sizeof(double));
}

/*
 * Fill the influence matrix with Gaussian functions exp(-far), which end at an exponent `end`: zero
 * farther away.
 */
static void fill_influence(mirror *a, double end)
{
    const int side = (int)ceil(sqrt(a->n));
    for (int i = 0; i < a->m; i++) {
        const double radius = sqrt((i + .5) / a->m) * side / 2, angle = 2.399963 * i;
        const double x = radius * cos(angle), y = radius * sin(angle);
        for (int j = 0; j < a->n; j++) {
            const double dx = x - (j % side - (side - 1) / 2.0);
            const double dy = y - (j / side - (side - 1) / 2.0);
            const double far = (dx * dx + dy * dy) / (WIDTH * WIDTH);
            /* Products of numbers that far from the actuator would underflow, which takes time. */
            a->influence[(size_t)i * a->n + j] = far < end ? exp(-far) : 0;
        }
    }
}

static void open_mirror(mirror *a, int n, double end)
{
    memset(a, 0, sizeof *a);
    a->n = n;
    a->m = 4 * n;
    a->influence = reals((size_t)n * a->m);
    a->hessian = reals((size_t)n * n);
    a->weight = reals(a->m);
    a->lower = reals(n);
    a->upper = reals(n);
    a->step_limit = reals(n);
    a->reference = reals(n);
    a->wanted = reals(a->m);
    fill_influence(a, end);
    cblas_dsyrk(CblasRowMajor, CblasLower, CblasTrans, n, a->m, 1, a->influence, n, 0, a->hessian,
                n);
    double trace = 0;
    for (int j = 0; j < n; j++) {
        trace += a->hessian[(size_t)j * n + j];
        for (int k = 0; k < j; k++)
            a->hessian[(size_t)k * n + j] = a->hessian[(size_t)j * n + k];
        a->lower[j] = -LIMIT;
        a->upper[j] = LIMIT;
        a->step_limit[j] = HUGE_VAL;
    }
    for (int i = 0; i < a->m; i++)
        a->weight[i] = 1;
    a->bytes = PZS_CONTROL_BYTES(n, a->m);
    a->work = reals(a->bytes / sizeof(double) + 1);
    a->problem = (pzs_problem){.inputs = (uint16_t)n,
                               .outputs = (uint16_t)a->m,
                               .influence = a->influence,
                               .hessian = a->hessian,
                               .weight = a->weight,
                               .lower = a->lower,
                               .upper = a->upper,
                               .step_limit = a->step_limit,
                               .reference_voltage = a->reference,
                               .regularisation = SOFTENING * trace / n};
    if (pzs_problem_seal(&a->problem) != PZS_OK)
        exit(1);
}

static void close_mirror(mirror *a)
{
    double *array[] = {a->influence,  a->hessian,   a->weight, a->lower, a->upper,
                       a->step_limit, a->reference, a->wanted, a->work};
    for (size_t k = 0; k < sizeof array / sizeof *array; k++)
        free(array[k]);
}

/* Store the entries of the influence matrix that are not zero as sparse rows. */
static void compress(mirror *a)
{
    const size_t most = (size_t)a->n * (size_t)a->m;
    uint32_t *start = calloc((size_t)a->m + 1, sizeof *start), entries = 0;
    uint16_t *dof = calloc(most, sizeof *dof);
    double *value = reals(most);
    if (start == NULL || dof == NULL)
        exit(1);
    for (int i = 0; i < a->m; i++) {
        for (int j = 0; j < a->n; j++) {
            const double entry = a->influence[(size_t)i * a->n + j];
            if (entry == 0)
                continue;
            dof[entries] = (uint16_t)j;
            value[entries++] = entry;
        }
        start[i + 1] = entries;
    }
    a->sparse =
        (pzs_sparse_influence){&pzs_sparse_influence_calls, {(uint16_t)a->m, start, dof, value}};
    a->problem.influence = NULL;
    a->problem.sparse = &a->sparse;
    if (pzs_problem_seal(&a->problem) != PZS_OK)
        exit(1);
}

static double time_start(mirror *a)
{
    double spent[REPEATS];
    for (int k = 0; k < REPEATS; k++) {
        const double from = processor_time();
        if (pzs_control_init(&a->control, &a->problem, NULL, a->work, a->bytes) != PZS_OK)
            exit(1);
        spent[k] = processor_time() - from;
    }
    return median(spent, REPEATS);
}

/* Time of a start that forms the Hessian from the influence matrix. */
static double time_formed(mirror *a)
{
    a->problem.hessian = NULL;
    if (pzs_problem_seal(&a->problem) != PZS_OK)
        exit(1);
    const double time = time_start(a);
    a->problem.hessian = a->hessian;
    if (pzs_problem_seal(&a->problem) != PZS_OK)
        exit(1);
    return time;
}

static double time_symmetric_product(const mirror *a)
{
    double spent[REPEATS], *product = reals((size_t)a->n * a->n);
    for (int k = 0; k < REPEATS; k++) {
        const double from = processor_time();
        cblas_dsyrk(CblasRowMajor, CblasLower, CblasTrans, a->n, a->m, 1, a->influence, a->n, 0,
                    product, a->n);
        spent[k] = processor_time() - from;
    }
    free(product);
    return median(spent, REPEATS);
}

static double time_cholesky(const mirror *a)
{
    double spent[REPEATS], *factor = reals((size_t)a->n * a->n);
    int info;
    for (int k = 0; k < REPEATS; k++) {
        memcpy(factor, a->hessian, (size_t)a->n * a->n * sizeof *factor);
        for (int j = 0; j < a->n; j++)
            factor[(size_t)j * a->n + j] += a->problem.regularisation;
        const double from = processor_time();
        dpotrf_("L", &a->n, factor, &a->n, &info);
        spent[k] = processor_time() - from;
        if (info != 0)
            exit(1);
    }
    free(factor);
    return median(spent, REPEATS);
}

static double time_product(const mirror *a)
{
    double spent[4 * REPEATS], *y = reals(a->m), *x = reals(a->n);
    for (int k = 0; k < 4 * REPEATS; k++) {
        x[0] = k;
        const double from = processor_time();
        cblas_dgemv(CblasRowMajor, CblasNoTrans, a->m, a->n, 1, a->influence, a->n, x, 1, 0, y, 1);
        spent[k] = processor_time() - from;
    }
    free(x);
    free(y);
    return median(spent, 4 * REPEATS);
}

/* A smooth target of size 1: waves across the mirror with the given amplitudes. */
static void want(mirror *a, const double *amplitude)
{
    for (int i = 0; i < a->m; i++) {
        const double radius = sqrt((i + .5) / a->m), angle = 2.399963 * i;
        const double x = radius * cos(angle), y = radius * sin(angle);
        a->wanted[i] = amplitude[0] * x + amplitude[1] * y + amplitude[2] * (x * x - y * y) +
                       amplitude[3] * 2 * x * y + amplitude[4] * sin(5 * x + 3 * y) +
                       amplitude[5] * cos(6 * y - 2 * x) + amplitude[6] * sin(9 * x) * cos(8 * y);
        a->wanted[i] *= WIDTH * WIDTH;
    }
}

static double time_warm(mirror *a)
{
    double spent[4 * REPEATS];
    for (int k = -4; k < 4 * REPEATS; k++) {
        const double amplitude[7] = {.1 + 1e-4 * k, .1, .1, .1 - 1e-4 * k};
        want(a, amplitude);
        const double from = processor_time();
        const pzs_status status = pzs_tick(&a->control, a->wanted, NULL);
        if (k >= 0)
            spent[k] = processor_time() - from;
        if (status != PZS_OK)
            exit(2);
    }
    return median(spent, 4 * REPEATS);
}

/* Mean and worst time of a jumping target. Returns how many frames were out of work. */
static int time_jumps(mirror *a, double *mean, double *worst)
{
    int cut = 0;
    *mean = *worst = 0;
    for (int k = 0; k < FRAMES; k++) {
        double amplitude[7];
        for (int j = 0; j < 7; j++)
            amplitude[j] = uniform();
        want(a, amplitude);
        const double from = processor_time();
        cut += pzs_step(&a->control, a->wanted) != PZS_OK;
        const double spent = processor_time() - from;
        *mean += spent / FRAMES;
        *worst = spent > *worst ? spent : *worst;
    }
    return cut;
}

/*
 * Time ticks with the full and with the sparse matrix of narrow influence functions, whose voltages
 * must have the same bits. Returns the part of the entries that is not zero.
 */
static double time_sparse(int n, double time[TIMES])
{
    mirror a;
    open_mirror(&a, n, NARROW);
    double *voltage = reals(n);
    (void)time_start(&a);
    time[FULL] = time_warm(&a);
    memcpy(voltage, a.control.info.voltage, (size_t)n * sizeof *voltage);
    compress(&a);
    (void)time_start(&a);
    time[SPARSE] = time_warm(&a);
    if (memcmp(voltage, a.control.info.voltage, (size_t)n * sizeof *voltage) != 0)
        exit(3);
    const double density = (double)a.sparse.rows.start[a.m] / ((double)n * a.m);
    free((void *)a.sparse.rows.start);
    free((void *)a.sparse.rows.dof);
    free((void *)a.sparse.rows.value);
    free(voltage);
    close_mirror(&a);
    return density;
}

int main(void)
{
    static const char *const name[TIMES] = {"start", "potrf", "formed", "syrk", "warm",
                                            "gemv",  "jump",  "worst",  "full", "sparse"};
    double time[2][TIMES];
    int failed = 0;
    puts("   n     m      start (potrf)     formed (syrk, potrf)   warm (gemv)        jump: mean, "
         "worst, most, cut    sparse (full) (gemv), entries");
    for (int n = 16, k = 0; n <= 1024; n *= 2, k++) {
        mirror a;
        double *now_time = time[k % 2];
        const double *before = time[(k + 1) % 2];
        open_mirror(&a, n, WIDE);
        now_time[FORMED] = time_formed(&a);
        now_time[FORM] = time_symmetric_product(&a);
        now_time[START] = time_start(&a);
        now_time[CHOLESKY] = time_cholesky(&a);
        now_time[PRODUCT] = time_product(&a);
        now_time[WARM] = time_warm(&a);
        const int cut = time_jumps(&a, &now_time[JUMP], &now_time[WORST]);
        const double density = time_sparse(n, now_time);
        const double peer = now_time[FORM] + now_time[CHOLESKY];
        printf("%4d %5d %10.1f (%5.2f) %10.1f (%5.2f) %10.2f (%5.2f) %10.1f %10.1f %6d %3d "
               "%10.2f (%5.2f) (%5.2f) %5.1f %%\n",
               n, a.m, now_time[START], now_time[START] / now_time[CHOLESKY], now_time[FORMED],
               now_time[FORMED] / peer, now_time[WARM], now_time[WARM] / now_time[PRODUCT],
               now_time[JUMP], now_time[WORST], a.control.info.iterations_most, cut,
               now_time[SPARSE], now_time[SPARSE] / now_time[FULL],
               now_time[SPARSE] / now_time[PRODUCT], 100 * density);
        failed |= cut > 0;
        for (int j = 0; k > 0 && j < TIMES; j++)
            printf("%s%s %.2f", j == 0 ? "            exponents: " : ", ", name[j],
                   log2(now_time[j] / before[j]));
        puts(k > 0 ? "" : "");
        close_mirror(&a);
    }
    return failed;
}
