/*
 * One warm voltage step against DAQP, double, one thread.
 *
 *   sh tests/bench/get_daqp.sh build/daqp
 *   gcc -std=c99 -O3 -march=native -ffp-contract=fast -DPZS_TILE=8 -Iinclude -DWITH_DAQP
 * -Ibuild/daqp/include \ tests/bench/bench_step.c lib/core/guard.c build/daqp/libdaqp.a -lm -o
 * build/bench_step
 *
 * Without WITH_DAQP only our side is measured. n inputs over a grid of m outputs, 200 frames of a
 * slowly moving target, run in a circle so that every start is warm; limits are chosen so
 * that on average 0, 5 or 15 of them are active. Both sides form B'e with the same routine (B'W^2
 * e, pzs_product_sum_rows of lib/core/product.c, included here), then solve; DAQP has its factor of
 * H beforehand and keeps its working set; of its two ways to start (with and without a look at the
 * unlimited optimum) the faster counts, in each column. Our side is one translation unit, DAQP a
 * static library; no step limit is in force. Each frame is timed in TURNS circles, both sides in
 * turn; its time is the median. Shown are the mean and the worst over the frames, from the error to
 * voltages, and of the solver alone. Answers that differ, or a step that does not end, fail.
 * --json: one object a row.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include "pzs.h"
#include <stdio.h>
#include <stdlib.h>
#include "clock.h"
#include "../../lib/control/boxls.c"
#include "../../lib/core/product.c"
#include "../../lib/control/boxls_tableau.c"
#include "../../lib/control/sensor_check.c"
#include "../../lib/control/control.c"
#ifdef WITH_DAQP
#include "api.h"
#include "utils.h"
#include "../../lib/control/control.h"
#endif

#define FRAMES 200
#define TURNS 301
#define MOST_N 50
#define MOST_M 242
#define SAME                                                                                       \
    1e-6        /* of the largest volt, the tolerance that DAQP sets itself: more is a failure     \
                 */
#define SIDES 3 /* ours, DAQP, DAQP that first looks at the unlimited optimum */

static struct {
    int n, m;
    double *b, target[FRAMES][MOST_M], lower[MOST_N], upper[MOST_N];
    double weight[MOST_M], slew[MOST_N], prefer[MOST_N];
    double b_room[MOST_M * MOST_N + 8], work[(PZS_CONTROL_BYTES(MOST_N, MOST_M) + 63) / 64 * 8 + 8];
    pzs_problem problem;
    pzs_control control;
} ours;

static double spent[SIDES][2][FRAMES][TURNS]; /* total, solver (us) */
static double answer[SIDES][FRAMES][MOST_N], disagree;

/* Where the first cache line in it starts, as compilers place large tables. */
static double *line_start(double *room)
{
    return room + (64 - (uintptr_t)room % 64) % 64 / sizeof *room;
}

/* What reading the clock costs (us). */
static double idle(void)
{
    static double x[10001];

    for (int i = 0; i < 10001; i++) {
        const double from = now();
        x[i] = now() - from;
    }
    return median(x, 10001);
}

/* Patches 5 across and n/5 along bend a plate clamped at one end; outputs on a grid 11 across. */
static void make_plate(int n, int m)
{
    const double length = n / 5, rows = m / 11;

    ours.n = n;
    ours.m = m;
    ours.b = line_start(ours.b_room);
    for (int i = 0; i < m; i++) {
        const double x = (i / 11 + 1) / rows * length, y = (i % 11) / 10.0 * 5;
        for (int j = 0; j < n; j++) {
            const double from = j / 5, past = x - from, across = y - (j % 5 + .5);
            const double bend = past <= 0 ? 0 : past < 1 ? past * past / 2 : past - .5;
            ours.b[i * n + j] = .3 * bend * (.15 + exp(-.8 * across * across));
        }
        ours.weight[i] = 1;
        for (int t = 0; t < FRAMES; t++) {
            const double a = 2 * 3.14159265358979 * t / FRAMES, s = x / length, c = y / 5 - .5;
            ours.target[t][i] = 3 * length * length *
                                (s * s * cos(a) + s * c * sin(a) + .6 * s * s * c * c * cos(2 * a) +
                                 .4 * sin(5 * s) * c * sin(3 * a + 1));
        }
    }
}

static void limit(double voltage)
{
    const uint16_t n = (uint16_t)ours.n, m = (uint16_t)ours.m;

    for (int j = 0; j < ours.n; j++) {
        ours.lower[j] = -voltage;
        ours.upper[j] = voltage;
        ours.slew[j] = 1e30;
    }
    ours.problem = (pzs_problem){
        PZS_TABLE_FORMAT, 0,          0,          n,         m,           ours.b, NULL,
        ours.weight,      ours.lower, ours.upper, ours.slew, ours.prefer, 0};
    for (int j = 0; j < ours.n; j++) {
        double square = 0;
        for (int i = 0; i < ours.m; i++)
            square += ours.b[i * ours.n + j] * ours.b[i * ours.n + j];
        ours.problem.regularisation += 1e-3 / ours.n * square;
    }
    ours.problem.crc = pzs_problem_crc(&ours.problem);
    if (pzs_control_init(&ours.control, &ours.problem, NULL, line_start(ours.work),
                         sizeof ours.work - 64) != PZS_OK)
        exit(1);
}

static double mean_active(double voltage)
{
    double sum = 0;

    limit(voltage);
    for (int t = 0; t < FRAMES; t++) {
        pzs_step(&ours.control, ours.target[t]);
        {
            pzs_report r;
            pzs_assess(&ours.control, ours.target[t], &r);
            sum += r.active_limits;
        }
    }
    return sum / FRAMES;
}

/* The limit (V) at which `active` inputs are at theirs on average, by bisection. */
static double limit_for(double active)
{
    double low = 1e-3, high = 1e9;

    for (int k = 0; k < 60 && active > 0; k++) {
        const double middle = sqrt(low * high);
        if (mean_active(middle) > active)
            low = middle;
        else
            high = middle;
    }
    return high;
}

static void our_step(int t, int turn)
{
    const double from = now();
    pzs_optimiser *optimiser = &ours.control.state.optimiser;
    const double missed =
        project(optimiser, &ours.control, ours.target[t], ours.control.info.predicted);
    const double between = now();
    const pzs_status status =
        step_to(optimiser, &ours.control, ours.target[t], ours.control.info.predicted, missed);
    const double end = now();

    spent[0][0][t][turn] = end - from;
    spent[0][1][t][turn] = end - between;
    memcpy(answer[0][t], ours.control.info.voltage, sizeof(double) * (size_t)ours.n);
    if (status != PZS_OK)
        exit(3);
}

#ifdef WITH_DAQP
static struct {
    DAQPWorkspace work;
    DAQPProblem problem;
    DAQPResult result;
    double h[MOST_N * MOST_N], f[MOST_N], lam[MOST_N], x[MOST_N], weighted[MOST_M];
    int sense[MOST_N];
} peer[2];

static void peer_start(int way)
{
    memset(&peer[way], 0, sizeof peer[way]);
    for (int i = 0; i < ours.n; i++)
        memcpy(peer[way].h + i * ours.n,
               ours.control.optimiser.h + (size_t)i * ours.control.optimiser.width,
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

static void peer_step(int way, int t, int turn)
{
    const int mask = DAQP_UPDATE_v | DAQP_UPDATE_d | (way ? DAQP_UPDATE_unconstrained : 0);
    const double from = now();
    for (int i = 0; i < ours.m; i++)
        peer[way].weighted[i] = ours.weight[i] * ours.weight[i] * ours.target[t][i];
    pzs_product_sum_rows(peer[way].f, ours.b, (uint32_t)ours.n, peer[way].weighted,
                         (uint32_t)ours.m, (uint32_t)ours.n);
    const double between = now();
    for (int i = 0; i < ours.n; i++)
        peer[way].f[i] = -peer[way].f[i];
    daqp_update_ldp(mask, &peer[way].work, &peer[way].problem);
    daqp_solve(&peer[way].result, &peer[way].work);
    const double end = now();

    spent[way + 1][0][t][turn] = end - from;
    spent[way + 1][1][t][turn] = end - between;
    memcpy(answer[way + 1][t], peer[way].x, sizeof peer[way].x);
    if (peer[way].result.exitflag < 1)
        exit(4);
}

static void compare_frame(int t)
{
    double most = 0, away = 0;

    for (int j = 0; j < ours.n; j++) {
        most = fmax(most, fabs(answer[0][t][j]));
        for (int way = 0; way < 2; way++)
            away = fmax(away, fabs(answer[0][t][j] - answer[way + 1][t][j]));
    }
    disagree = fmax(disagree, away / most);
}

static void compare(void)
{
    for (int t = 0; t < FRAMES; t++)
        compare_frame(t);
}
#else
static void peer_start(int way)
{
    (void)way;
}
static void peer_step(int way, int t, int turn)
{
    (void)way, (void)t, (void)turn;
}
static void compare(void)
{
}
#endif

/* Mean and worst over the frames of the median over the turns (us), reading the clock taken off. */
static void reduce(int side, int part, double clock, double *mean, double *worst)
{
    *mean = *worst = 0;
    for (int t = 0; t < FRAMES; t++) {
        const double x = median(spent[side][part][t], TURNS) - clock * (part == 0 ? 2 : 1);
        *mean += x / FRAMES;
        *worst = fmax(*worst, x);
    }
}

static void row(int n, int m, int active, int json)
{
    double mean[SIDES][2], worst[SIDES][2];
    const double clock = idle();

    make_plate(n, m);
    limit(limit_for(active));
    disagree = 0;
    for (int way = 0; way < 2; way++)
        peer_start(way);
    for (int t = 0; t < FRAMES; t++) /* the circle's first round is cold */
        our_step(t, 0), peer_step(0, t, 0), peer_step(1, t, 0);
    for (int turn = 0; turn < TURNS; turn++) {
        for (int t = 0; t < FRAMES; t++)
            our_step(t, turn);
        for (int way = 0; way < 2; way++)
            for (int t = 0; t < FRAMES; t++)
                peer_step(way, t, turn);
        compare();
    }
    for (int side = 0; side < SIDES; side++)
        for (int part = 0; part < 2; part++)
            reduce(side, part, clock, &mean[side][part], &worst[side][part]);
    for (int part = 0; part < 2; part++) {
        mean[1][part] = fmin(mean[1][part], mean[2][part]);
        worst[1][part] = fmin(worst[1][part], worst[2][part]);
    }
    const char *form =
        json
            ? "{\"bench\": \"step\", \"n\": %d, \"m\": %d, \"active\": %d, \"us\": %.3f, "
              "\"worst_us\": %.3f, "
              "\"solver_us\": %.3f, \"daqp_us\": %.3f, \"daqp_worst_us\": %.3f, "
              "\"daqp_solver_us\": %.3f, "
              "\"ratio\": %.3f, \"worst_ratio\": %.3f, \"passes_most\": %d, \"difference\": %.1e}\n"
            : "%3d %4d %6d   %6.3f %6.3f %6.3f   %6.3f %6.3f %6.3f   %5.2f %5.2f   %3d %8.1e\n";
    printf(form, n, m, active, mean[0][0], worst[0][0], mean[0][1], mean[1][0], worst[1][0],
           mean[1][1], mean[0][0] / mean[1][0], worst[0][0] / worst[1][0],
           ours.control.info.iterations_most, disagree);
    if (disagree > SAME)
        exit(5);
}

int main(int argc, char **argv)
{
    const int json = argc > 1 && strcmp(argv[1], "--json") == 0;

    if (!json)
        printf("microseconds          ours: all  worst solver   DAQP: all worst solver   ratio "
               "worst  most passes, difference\n");
    for (int n = 25; n <= 50; n += 25)
        for (int k = 0; k < 3; k++)
            row(n, n == 25 ? 121 : 242, k == 0 ? 0 : k == 1 ? 5 : 15, json);
    return 0;
}
