/*
 * Voltage steps against DAQP, double, one thread: warm steps of slowly moving targets on a plate,
 * and steps to targets that jump on a deformable mirror.
 *
 *   make bench-step, or
 *   sh tests/bench/get_daqp.sh build/daqp
 *   gcc -std=c99 -O2 -DPZS_WIDE=1 -Iinclude -DWITH_DAQP -Ibuild/daqp/include
 *       tests/bench/bench_step.c lib/core/[^s]*.c lib/control/[^l]*.c build/daqp/libdaqp.a -lm
 *
 * Without WITH_DAQP only our side is measured. Both sides form B'W^2 e with the same routine, then
 * solve; DAQP has its factor of H beforehand. Of its two ways to start (with and without a look at
 * the unconstrained optimum) the faster counts, in each column. Each frame is timed in several
 * turns, both sides in turn; its time is the median. Shown are the mean and the worst over the
 * frames, from the error to voltages. Objectives that differ by more than 1e-9 of |W e|^2, or a
 * step that does not end, fail.
 *
 * The plate has patches 5 across and n/5 along, and outputs on a grid; its targets move slowly in a
 * circle, so that every start is warm. The mirror has 140 actuators on a grid of 12 x 12 without
 * its corners, Gaussian influence functions, and 351 outputs on its disc; `width` sets the decay of
 * the singular values, with a condition of B of 4e2, 4e2 and 5e3. Its targets are random
 * combinations of twelve smooth shapes. Steps start warm at the last voltages or cold at zero,
 * where DAQP starts without constraints.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include "pzs.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/product.h"
#include "clock.h"
#ifdef WITH_DAQP
#include "api.h"
#include "utils.h"
#endif

#define FRAMES 200
#define MOST_TURNS 31
#define MOST_N 140
#define MOST_M 351
#define SAME 1e-9 /* largest difference of the objectives, over |W e|^2 */
#define SIDES 3   /* ours, DAQP, DAQP that first looks at the unconstrained optimum */

typedef struct test_case {
    int is_mirror, is_cold, n, m, turns;
    double active; /* plate: mean number of active limits; mirror: voltage limit */
    double width;  /* mirror: width of an influence function, in pitches */
} test_case;

static struct {
    int n, m;
    double influence[MOST_M * MOST_N + 8], target[FRAMES][MOST_M];
    double weight[MOST_M], lower[MOST_N], upper[MOST_N], step_limit[MOST_N], reference[MOST_N];
    double work[PZS_CONTROL_BYTES(MOST_N, MOST_M) / sizeof(double) + 1];
    pzs_problem problem;
    pzs_control control;
} ours;

static double spent[SIDES][FRAMES][MOST_TURNS]; /* us */
static double answer[SIDES][MOST_N], difference;
static uint64_t seed = 1;

/* Wall-clock time of short steps of the plate; processor time of longer ones (us). */
static double clock_of_case(void)
{
    return ours.n < 100 ? now() : processor_time();
}

static double uniform(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-52 - 1;
}

/* ---- cases --------------------------------------------------------------- */

static void make_plate(void)
{
    const double length = ours.n / 5, rows = ours.m / 11;
    for (int i = 0; i < ours.m; i++) {
        const double x = (i / 11 + 1) / rows * length, y = (i % 11) / 10.0 * 5;
        for (int j = 0; j < ours.n; j++) {
            const double past = fmax(x - j / 5, 0), across = y - (j % 5 + .5);
            const double bend = past < 1 ? past * past / 2 : past - .5;
            ours.influence[i * ours.n + j] = .3 * bend * (.15 + exp(-.8 * across * across));
        }
        for (int t = 0; t < FRAMES; t++) {
            const double a = 2 * 3.14159265358979 * t / FRAMES, s = x / length, c = y / 5 - .5;
            ours.target[t][i] = 3 * length * length *
                                (s * s * cos(a) + s * c * sin(a) + .6 * s * s * c * c * cos(2 * a) +
                                 .4 * sin(5 * s) * c * sin(3 * a + 1));
        }
    }
}

static void make_mirror(double width)
{
    for (int i = 0; i < ours.m; i++) {
        const double radius = sqrt((i + .5) / ours.m) * 6, angle = i * 2.399963;
        for (int j = 0; j < ours.n; j++) {
            const int place = j + 1 + (j >= 10) + (j >= 130);
            const double x = radius * cos(angle) - (place % 12 - 5.5);
            const double y = radius * sin(angle) - (place / 12 - 5.5);
            ours.influence[i * ours.n + j] = exp(-2 * (x * x + y * y) / (width * width));
        }
    }
    for (int t = 0; t < FRAMES; t++) {
        double c[12];
        for (int k = 0; k < 12; k++)
            c[k] = uniform() + uniform();
        for (int i = 0; i < ours.m; i++) {
            const double square = (i + .5) / ours.m, angle = i * 2.399963;
            const double x = sqrt(square) * cos(angle), y = sqrt(square) * sin(angle);
            ours.target[t][i] =
                2 * (c[0] * x + c[1] * y + c[2] * (2 * square - 1) + c[3] * 2 * x * y +
                     c[4] * (x * x - y * y) + (c[5] * x + c[6] * y) * (3 * square - 2) +
                     .5 * c[7] * sin(5 * x + c[8]) + .5 * c[9] * cos(6 * y + c[10]) +
                     .3 * c[11] * sin(8 * x * y));
        }
    }
}

static void limit(double voltage, double softening)
{
    for (int j = 0; j < ours.n; j++) {
        ours.lower[j] = -voltage;
        ours.upper[j] = voltage;
        ours.step_limit[j] = HUGE_VAL;
    }
    ours.problem = (pzs_problem){.inputs = (uint16_t)ours.n,
                                 .outputs = (uint16_t)ours.m,
                                 .influence = ours.influence,
                                 .weight = ours.weight,
                                 .lower = ours.lower,
                                 .upper = ours.upper,
                                 .step_limit = ours.step_limit,
                                 .reference_voltage = ours.reference};
    for (int i = 0; i < ours.m * ours.n; i++)
        ours.problem.regularisation += softening / ours.n * ours.influence[i] * ours.influence[i];
    if (pzs_problem_seal(&ours.problem) != PZS_OK ||
        pzs_control_init(&ours.control, &ours.problem, NULL, ours.work, sizeof ours.work) != PZS_OK)
        exit(1);
}

static double mean_active(void)
{
    double sum = 0;
    for (int t = 0; t < FRAMES; t++) {
        pzs_report report;
        (void)pzs_step(&ours.control, ours.target[t]);
        (void)pzs_assess(&ours.control, ours.target[t], &report);
        sum += report.active_limits;
    }
    return sum / FRAMES;
}

/* Find the limit (V) at which `active` inputs are at theirs on average, by bisection. */
static void find_limit(double active)
{
    double low = 1e-3, high = 1e9;
    for (int k = 0; k < 60 && active > 0; k++) {
        const double middle = sqrt(low * high);
        limit(middle, 1e-3);
        if (mean_active() > active)
            low = middle;
        else
            high = middle;
    }
    limit(high, 1e-3);
}

static void open_case(const test_case *test)
{
    ours.n = test->n;
    ours.m = test->m;
    for (int i = 0; i < ours.m; i++)
        ours.weight[i] = 1;
    if (test->is_mirror) {
        make_mirror(test->width);
        limit(test->active, 1e-7);
    } else {
        make_plate();
        find_limit(test->active);
    }
}

/* ---- steps --------------------------------------------------------------- */

static void our_step(int t, int turn, int is_cold)
{
    if (is_cold)
        (void)pzs_control_start(&ours.control, ours.reference);
    const double from = clock_of_case();
    const pzs_status status = pzs_step(&ours.control, ours.target[t]);
    spent[0][t][turn] = clock_of_case() - from;
    memcpy(answer[0], ours.control.info.voltage, sizeof(double) * (size_t)ours.n);
    if (status != PZS_OK)
        exit(3);
}

/* |W (B v - e)|^2 + regularisation |v|^2 */
static double objective(const double *v, const double *target)
{
    double sum = 0;
    for (int i = 0; i < ours.m; i++) {
        double miss = -target[i];
        for (int j = 0; j < ours.n; j++)
            miss += ours.influence[i * ours.n + j] * v[j];
        sum += miss * miss;
    }
    for (int j = 0; j < ours.n; j++)
        sum += ours.problem.regularisation * v[j] * v[j];
    return sum;
}

#ifdef WITH_DAQP
static struct {
    DAQPWorkspace work;
    DAQPProblem problem;
    DAQPResult result;
    double h[MOST_N * MOST_N], f[MOST_N + 8], lam[MOST_N], x[MOST_N], weighted[MOST_M];
    int sense[MOST_N];
} peer[2];

static void peer_start(int way)
{
    const pzs_optimiser *optimiser = &ours.control.state.optimiser;
    memset(&peer[way], 0, sizeof peer[way]);
    for (int i = 0; i < ours.n; i++)
        memcpy(peer[way].h + i * ours.n, optimiser->hessian + (size_t)i * optimiser->width,
               sizeof(double) * (size_t)ours.n);
    peer[way].problem = (DAQPProblem){.n = ours.n,
                                      .m = ours.n,
                                      .ms = ours.n,
                                      .H = peer[way].h,
                                      .f = peer[way].f,
                                      .bupper = ours.upper,
                                      .blower = ours.lower,
                                      .sense = peer[way].sense};
    peer[way].result.x = peer[way].x;
    peer[way].result.lam = peer[way].lam;
    if (setup_daqp(&peer[way].problem, &peer[way].work, NULL) < 0)
        exit(2);
}

static void peer_step(int way, int t, int turn, int is_cold)
{
    const int mask = DAQP_UPDATE_v | DAQP_UPDATE_d | (way ? DAQP_UPDATE_unconstrained : 0);
    if (is_cold) {
        daqp_deactivate_constraints(&peer[way].work);
        reset_daqp_workspace(&peer[way].work);
    }
    const double from = clock_of_case();
    for (int i = 0; i < ours.m; i++)
        peer[way].weighted[i] = ours.weight[i] * ours.weight[i] * ours.target[t][i];
    pzs_product_sum_rows(peer[way].f, ours.influence, (uint32_t)ours.n, peer[way].weighted,
                         (uint32_t)ours.m, (uint32_t)ours.n);
    for (int i = 0; i < ours.n; i++)
        peer[way].f[i] = -peer[way].f[i];
    daqp_update_ldp(mask, &peer[way].work, &peer[way].problem);
    daqp_solve(&peer[way].result, &peer[way].work);
    spent[way + 1][t][turn] = clock_of_case() - from;
    memcpy(answer[way + 1], peer[way].x, sizeof(double) * (size_t)ours.n);
    if (peer[way].result.exitflag < 1)
        exit(4);
}

static void compare(int t)
{
    double energy = 0;
    for (int i = 0; i < ours.m; i++)
        energy += ours.target[t][i] * ours.target[t][i];
    const double best = objective(answer[0], ours.target[t]);
    for (int way = 1; way < SIDES; way++) {
        const double gap = fabs(best - objective(answer[way], ours.target[t])) / energy;
        difference = fmax(difference, gap);
    }
}
#else
static void peer_start(int way)
{
    (void)way;
}
static void peer_step(int way, int t, int turn, int is_cold)
{
    (void)way, (void)t, (void)turn, (void)is_cold;
}
static void compare(int t)
{
    (void)t;
}
#endif

/* Mean and worst over the frames of the median over the turns (us). */
static void reduce(int side, int turns, double *mean, double *worst)
{
    *mean = *worst = 0;
    for (int t = 0; t < FRAMES; t++) {
        const double time = median(spent[side][t], turns);
        *mean += time / FRAMES;
        *worst = fmax(*worst, time);
    }
}

static void row(const test_case *test)
{
    double mean[SIDES], worst[SIDES];
    open_case(test);
    difference = 0;
    for (int way = 0; way < 2; way++)
        peer_start(way);
    for (int turn = -1; turn < test->turns; turn++) { /* the first turn only warms up */
        for (int t = 0; t < FRAMES; t++) {
            our_step(t, turn < 0 ? 0 : turn, test->is_cold);
            for (int way = 0; way < 2; way++)
                peer_step(way, t, turn < 0 ? 0 : turn, test->is_cold);
            compare(t);
        }
    }
    for (int side = 0; side < SIDES; side++)
        reduce(side, test->turns, &mean[side], &worst[side]);
    const double peer_mean = fmin(mean[1], mean[2]), peer_worst = fmin(worst[1], worst[2]);
    printf("%-6s %-4s %4d %4d %7.1f   %8.2f %8.2f   %8.2f %8.2f   %5.2f %5.2f   %4d %8.1e\n",
           test->is_mirror ? "mirror" : "plate", test->is_cold ? "cold" : "warm", test->n, test->m,
           mean_active(), mean[0], worst[0], peer_mean, peer_worst, mean[0] / peer_mean,
           worst[0] / peer_worst, ours.control.info.iterations_most, difference);
    if (difference > SAME)
        exit(5);
}

/* Without an argument all cases are measured, with a number only that case, counted from 0. */
int main(int count, char **argument)
{
    static const test_case tests[] = {
        {0, 0, 25, 121, 31, 0, 0},    {0, 0, 25, 121, 31, 5, 0},    {0, 0, 25, 121, 31, 15, 0},
        {0, 0, 50, 242, 31, 0, 0},    {0, 0, 50, 242, 31, 5, 0},    {0, 0, 50, 242, 31, 15, 0},
        {1, 0, 140, 351, 5, .5, 1.2}, {1, 0, 140, 351, 5, 1, 1.6},  {1, 0, 140, 351, 5, 2, 1.6},
        {1, 0, 140, 351, 5, 1, 2},    {1, 1, 140, 351, 5, .5, 1.2}, {1, 1, 140, 351, 5, 1, 1.6},
        {1, 1, 140, 351, 5, 2, 1.6},  {1, 1, 140, 351, 5, 1, 2},
    };
    puts("microseconds            active       ours    worst       DAQP    worst   ratio worst   "
         "iterations, difference");
    for (size_t k = 0; k < sizeof tests / sizeof *tests; k++)
        if (count < 2 || k == strtoul(argument[1], NULL, 10))
            row(&tests[k]);
    return 0;
}
