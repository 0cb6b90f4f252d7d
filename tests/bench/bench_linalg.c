/*
 * Factor and solve of band matrices against OpenBLAS pbtrf and pbtrs, one thread each.
 *
 *   gcc -std=c99 -O3 -march=native -ffp-contract=fast -DPZS_REAL_BITS=64 -DPZS_TILE=8 \
 *       -Iinclude tests/bench/bench_linalg.c lib/core/linalg.c -lopenblas -lm -o bench_linalg
 *
 * with -DPZS_REAL_BITS=32 -DPZS_TILE=16 for float (the quickest tiles with AVX-512).
 * Without -ffp-contract=fast the bits are those of every other target and the factor takes
 * some 15 % longer. OpenBLAS chooses its kernels when it is loaded, so the measurement runs
 * in a child process for each OPENBLAS_CORETYPE and the child with the faster peer counts.
 * Inside a child our code and the peer, upper and lower, take turns, so a disturbed second
 * hurts both; what is shown are medians. Each factor starts from a matrix just copied, each
 * solve follows its factor. --json prints one object a row.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include "pzs.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"
#include "../../lib/core/linalg.h"

#define PEER_FACTOR PZS_BY_BITS(spbtrf_, dpbtrf_)
#define PEER_SOLVE PZS_BY_BITS(spbtrs_, dpbtrs_)
#define SIZES 5
#define MOST_TURNS 400

void spbtrf_(const char *uplo, const int *n, const int *kd, float *ab, const int *ld, int *info);
void dpbtrf_(const char *uplo, const int *n, const int *kd, double *ab, const int *ld, int *info);
void spbtrs_(const char *uplo, const int *n, const int *kd, const int *count, const float *ab,
             const int *ld, float *b, const int *ldb, int *info);
void dpbtrs_(const char *uplo, const int *n, const int *kd, const int *count, const double *ab,
             const int *ld, double *b, const int *ldb, int *info);
void openblas_set_num_threads(int threads);
char *openblas_get_corename(void);

static const struct size {
    int n, band;
    double factor_target; /* peer time over ours, at least */
} sizes[SIZES] = {{175, 48, 1.8}, {434, 27, 1.8}, {847, 90, 1}, {2023, 132, 1}, {12691, 272, 1}};

/* Medians of one size in microseconds, and the largest difference of both solutions over the
 * largest entry. */
struct row {
    double factor, solve, peer_factor, peer_solve, difference;
    char core[32];
};

/* Memory for reals, on a cache line. */
static pzs_real *reals(size_t count)
{
    void *p = NULL;

    if (posix_memalign(&p, 64, count * sizeof(pzs_real)) != 0)
        exit(2);
    memset(p, 0, count * sizeof(pzs_real));
    return p;
}

/* Entry (i, j) of the measured matrix: irregular, diagonally dominant. */
static pzs_real entry(int i, int j, int band)
{
    const uint32_t hash = ((uint32_t)i * 2654435761u ^ (uint32_t)j * 40503u) >> 8;

    return i == j ? (pzs_real)(2 * band + 1) : (pzs_real)(hash % 1000u) / 500 - 1;
}

static pzs_envelope build(int n, int band)
{
    uint16_t *first = calloc((size_t)n, sizeof *first);
    pzs_envelope matrix = {(uint32_t)n, first, calloc((size_t)n / PZS_TILE + 2, sizeof(uint32_t)),
                           NULL, reals((size_t)n)};

    for (int i = 0; i < n; i++)
        first[i] = (uint16_t)(i > band ? i - band : 0);
    matrix.value = reals(pzs_linalg_reals(first, matrix.n));
    pzs_linalg_layout(&matrix);
    pzs_linalg_clear(&matrix);
    for (int i = 0; i < n; i++)
        for (int j = first[i]; j <= i; j++)
            *pzs_linalg_entry(&matrix, (uint32_t)i, (uint32_t)j) = entry(i, j, band);
    return matrix;
}

/* LAPACK band storage, column by column with band + 1 entries each. */
static void build_peer(char uplo, int n, int band, pzs_real *ab)
{
    for (int i = 0; i < n; i++)
        for (int j = i > band ? i - band : 0; j <= i; j++)
            ab[uplo == 'U' ? (size_t)i * (size_t)(band + 1) + (size_t)(band + j - i)
                           : (size_t)j * (size_t)(band + 1) + (size_t)(i - j)] = entry(i, j, band);
}

static struct row measure(int n, int band)
{
    static double t[6][MOST_TURNS];
    const int turns_of_large = n < 5000 ? 60 : 9;
    const int turns = n < 1000 ? MOST_TURNS : turns_of_large;
    const int ld = band + 1;
    const int one = 1;
    const size_t peer_size = (size_t)n * (size_t)ld;
    pzs_envelope matrix = build(n, band);
    const size_t size = pzs_linalg_reals(matrix.first, matrix.n);
    pzs_real *a0 = reals(size), *ab = reals(peer_size),
             *ab0[2] = {reals(peer_size), reals(peer_size)};
    pzs_real *x = reals((size_t)n), *y = reals((size_t)n);
    double difference = 0, largest = 0;
    struct row row;
    int info;

    memcpy(a0, matrix.value, size * sizeof *a0);
    build_peer('U', n, band, ab0[0]);
    build_peer('L', n, band, ab0[1]);
    for (int turn = 0; turn < turns; turn++) {
        double start;
        for (int i = 0; i < n; i++)
            x[i] = (pzs_real)(i % 7 - 3);
        memcpy(matrix.value, a0, size * sizeof *a0);
        start = now();
        pzs_linalg_factor(&matrix);
        t[0][turn] = now() - start;
        start = now();
        pzs_linalg_solve(&matrix, x);
        t[1][turn] = now() - start;
        for (int lower = 0; lower < 2; lower++) {
            for (int i = 0; i < n; i++)
                y[i] = (pzs_real)(i % 7 - 3);
            memcpy(ab, ab0[lower], peer_size * sizeof *ab);
            start = now();
            PEER_FACTOR(lower ? "L" : "U", &n, &band, ab, &ld, &info);
            t[2 + lower][turn] = now() - start;
            start = now();
            PEER_SOLVE(lower ? "L" : "U", &n, &band, &one, ab, &ld, y, &n, &info);
            t[4 + lower][turn] = now() - start;
        }
    }
    for (int i = 0; i < n; i++) {
        largest = fmax(largest, fabs((double)y[i]));
        difference = fmax(difference, fabs((double)x[i] - (double)y[i]));
    }
    row.factor = median(t[0], turns);
    row.solve = median(t[1], turns);
    row.peer_factor = fmin(median(t[2], turns), median(t[3], turns));
    row.peer_solve = fmin(median(t[4], turns), median(t[5], turns));
    row.difference = difference / largest;
    free((void *)matrix.first), free(matrix.start), free(matrix.value), free(matrix.inverse);
    free(a0), free(ab), free(ab0[0]), free(ab0[1]), free(x), free(y);
    return row;
}

static int child(void)
{
    openblas_set_num_threads(1);
    for (int s = 0; s < SIZES; s++) {
        const struct row r = measure(sizes[s].n, sizes[s].band);
        printf("%.17g %.17g %.17g %.17g %.17g %s\n", r.factor, r.solve, r.peer_factor, r.peer_solve,
               r.difference, openblas_get_corename());
    }
    return 0;
}

/* Run this program as a child with OPENBLAS_CORETYPE set, or unset for "". */
static void run(const char *program, const char *core, struct row *rows)
{
    char command[512];
    FILE *pipe;

    snprintf(command, sizeof command, "%s%s %s --child", core[0] ? "OPENBLAS_CORETYPE=" : "", core,
             program);
    pipe = popen(command, "r");
    for (int s = 0; s < SIZES; s++) {
        struct row *r = &rows[s];
        if (!pipe || fscanf(pipe, "%lf %lf %lf %lf %lf %31s", &r->factor, &r->solve,
                            &r->peer_factor, &r->peer_solve, &r->difference, r->core) != 6)
            exit(2);
    }
    pclose(pipe);
}

static int show(int json, const char *what, const struct size *s, double ours, double peer,
                double target, const struct row *r)
{
    static const char *const word[2][2] = {{"FAIL", "pass"}, {"false", "true"}};
    const double ratio = peer / ours;
    printf(json
               ? "{\"task\":\"%s\",\"bits\":%d,\"tile\":%d,\"n\":%d,\"half_bandwidth\":%d,\"us\":%."
                 "2f,\"peer_us\":%.2f,"
                 "\"ratio\":%.2f,\"target\":%.1f,\"pass\":%s,\"core\":\"%s\",\"difference\":%.1e}\n"
               : "%-7s %4d %4d %7d %5d %11.2f %11.2f %7.2f %7.1f  %-5s %-9s %.1e\n",
           what, PZS_REAL_BITS, PZS_TILE, s->n, s->band, ours, peer, ratio, target,
           word[json != 0][ratio >= target], r->core, r->difference);
    return ratio < target;
}

int main(int argc, char **argv)
{
    const int json = argc > 1 && strcmp(argv[1], "--json") == 0;
    struct row rows[2][SIZES];
    int failed = 0;

    if (argc > 1 && strcmp(argv[1], "--child") == 0)
        return child();
    run(argv[0], "", rows[0]);
    run(argv[0], "SkylakeX", rows[1]);
    if (!json)
        printf("%-7s %4s %4s %7s %5s %11s %11s %7s %7s  %-5s %-9s %s\n", "task", "bits", "tile",
               "n", "band", "ours (us)", "peer (us)", "ratio", "target", "", "peer core",
               "difference of solutions");
    for (int s = 0; s < SIZES; s++) {
        const struct row *f = &rows[rows[1][s].peer_factor < rows[0][s].peer_factor][s];
        failed +=
            show(json, "factor", &sizes[s], f->factor, f->peer_factor, sizes[s].factor_target, f);
    }
    for (int s = 0; s < SIZES; s++) {
        const struct row *f = &rows[rows[1][s].peer_solve < rows[0][s].peer_solve][s];
        failed += show(json, "solve", &sizes[s], f->solve, f->peer_solve, 1, f);
    }
    return failed != 0;
}
