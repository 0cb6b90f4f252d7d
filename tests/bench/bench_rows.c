/*
 * Voltages within limits between amplifiers against DAQP, double, one thread, cold: the bimorph
 * mirror of tests/rigs/bimorph (16 actuators, 117 points) within 200 V, neighbours within 200 and
 * 150 V.
 *
 *   make bench-rows
 *
 * Both sides form B'W^2 e with the same routine, then solve from zero voltages without active
 * limits; our tableau and DAQP's factor of the Hessian are computed beforehand. Both are timed in
 * turn; shown are medians. Objectives that differ by more than 1e-9 fail. Without WITH_DAQP only
 * our side is measured.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include "pzs.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/limit_rows.h"
#include "../../lib/core/product.h"
#include "clock.h"
#ifdef WITH_DAQP
#include "api.h"
#include "utils.h"
#endif

enum { N = 16, M = 117, ROWS = N - 1, TURNS = 4001 };

/* Voltages of the mirror during the last scan (V). */
static const double initial[N] = {-516, -242, -134, 56,  -56, 163, -19,  -30,
                                  -190, -93,  -21,  223, 42,  -94, -344, -360};

static struct {
    double influence[M * N + 8], target[M], weight[M], lower[N], upper[N], step_limit[N], zero[N];
    uint32_t start[ROWS + 1];
    uint16_t input[2 * ROWS];
    double value[2 * ROWS], low[ROWS], high[ROWS];
    double work[(PZS_CONTROL_BYTES(N, M) + PZS_LIMIT_ROW_BYTES(N, ROWS)) / sizeof(double) + 1];
    pzs_limit_rows rows;
    pzs_problem problem;
    pzs_control control;
} ours;

static double spent[2][TURNS]; /* us */

/* Read the scans; the target is the mean height, without the piston of each column. */
static void read_mirror(void)
{
    FILE *file = fopen("tests/rigs/bimorph/scans.csv", "r");
    double scan[M][N + 1], mean[N + 1] = {0};
    int rows = 0;
    char line[4096];
    while (file && rows < M && fgets(line, sizeof line, file)) {
        char *at = line;
        int k = 0;
        for (char *end; k <= N; k++, at = *end == ',' ? end + 1 : end) {
            scan[rows][k] = strtod(at, &end);
            if (end == at)
                break;
        }
        rows += k == N + 1;
    }
    if (rows != M)
        exit(1);
    fclose(file);
    for (int i = 0; i < M; i++) {
        double target = -scan[i][N];
        for (int k = 0; k < N; k++) {
            ours.influence[i * N + k] = (scan[i][k + 1] - scan[i][k]) / -100;
            target += ours.influence[i * N + k] * initial[k];
            mean[k] += ours.influence[i * N + k] / M;
        }
        ours.target[i] = target;
        mean[N] += target / M;
    }
    for (int i = 0; i < M; i++) {
        for (int k = 0; k < N; k++)
            ours.influence[i * N + k] -= mean[k];
        ours.target[i] -= mean[N];
    }
}

static void open_problem(double neighbours)
{
    for (int j = 0; j < N; j++) {
        ours.lower[j] = -200;
        ours.upper[j] = 200;
        ours.step_limit[j] = HUGE_VAL;
    }
    for (int i = 0; i < M; i++)
        ours.weight[i] = 1;
    for (uint32_t k = 0; k < ROWS; k++) {
        ours.start[k + 1] = 2 * k + 2;
        ours.input[2 * k] = (uint16_t)k;
        ours.input[2 * k + 1] = (uint16_t)(k + 1);
        ours.value[2 * k] = 1;
        ours.value[2 * k + 1] = -1;
        ours.low[k] = -neighbours;
        ours.high[k] = neighbours;
    }
    ours.rows = (pzs_limit_rows){.call = &pzs_limit_rows_calls,
                                 .sums = {ROWS, ours.start, ours.input, ours.value},
                                 .lower = ours.low,
                                 .upper = ours.high,
                                 .safe = ours.zero};
    ours.problem = (pzs_problem){.inputs = N,
                                 .outputs = M,
                                 .influence = ours.influence,
                                 .weight = ours.weight,
                                 .lower = ours.lower,
                                 .upper = ours.upper,
                                 .step_limit = ours.step_limit,
                                 .reference_voltage = ours.zero,
                                 .limit_rows = &ours.rows};
    if (pzs_problem_seal(&ours.problem) != PZS_OK ||
        pzs_control_init(&ours.control, &ours.problem, NULL, ours.work, sizeof ours.work) != PZS_OK)
        exit(1);
}

static void our_step(int turn)
{
    (void)pzs_control_start(&ours.control, ours.zero);
    ours.rows.call->prepare(&ours.control);
    const double from = now();
    const pzs_status status = pzs_step(&ours.control, ours.target);
    spent[0][turn] = now() - from;
    if (status != PZS_OK)
        exit(3);
}

/* Return the root mean square of the misfit (um). */
static double misfit(const double *voltage)
{
    double sum = 0;
    for (int i = 0; i < M; i++) {
        double miss = -ours.target[i];
        for (int j = 0; j < N; j++)
            miss += ours.influence[i * N + j] * voltage[j];
        sum += miss * miss;
    }
    return sqrt(sum / M);
}

#ifdef WITH_DAQP
static struct {
    DAQPWorkspace work;
    DAQPProblem problem;
    DAQPResult result;
    double h[N * N], f[N + 8], a[ROWS * N], low[N + ROWS], high[N + ROWS], lam[N + ROWS], x[N];
    int sense[N + ROWS];
} peer;

static void peer_start(double neighbours)
{
    const pzs_optimiser *optimiser = &ours.control.state.optimiser;
    memset(&peer, 0, sizeof peer);
    for (int i = 0; i < N; i++)
        memcpy(peer.h + i * N, optimiser->hessian + (size_t)i * optimiser->width,
               sizeof(double) * N);
    for (int k = 0; k < N + ROWS; k++) {
        peer.high[k] = k < N ? 200 : neighbours;
        peer.low[k] = -peer.high[k];
    }
    for (int k = 0; k < ROWS; k++) {
        peer.a[k * N + k] = 1;
        peer.a[k * N + k + 1] = -1;
    }
    peer.problem = (DAQPProblem){.n = N,
                                 .m = N + ROWS,
                                 .ms = N,
                                 .H = peer.h,
                                 .f = peer.f,
                                 .A = peer.a,
                                 .bupper = peer.high,
                                 .blower = peer.low,
                                 .sense = peer.sense};
    peer.result.x = peer.x;
    peer.result.lam = peer.lam;
    if (setup_daqp(&peer.problem, &peer.work, NULL) < 0)
        exit(2);
}

static void peer_step(int turn)
{
    daqp_deactivate_constraints(&peer.work);
    reset_daqp_workspace(&peer.work);
    const double from = now();
    pzs_product_sum_rows(peer.f, ours.influence, N, ours.target, M, N);
    for (int i = 0; i < N; i++)
        peer.f[i] = -peer.f[i];
    daqp_update_ldp(DAQP_UPDATE_v | DAQP_UPDATE_d, &peer.work, &peer.problem);
    daqp_solve(&peer.result, &peer.work);
    spent[1][turn] = now() - from;
    if (peer.result.exitflag < 1)
        exit(4);
}
#else
static void peer_start(double neighbours)
{
    (void)neighbours;
}
static void peer_step(int turn)
{
    spent[1][turn] = NAN;
}
#endif

int main(void)
{
    const double neighbours[] = {200, 150};
    read_mirror();
    puts("bimorph mirror, cold: neighbours within (V), RMS (um), rows that bind, us, DAQP, ratio, "
         "iterations");
    for (int k = 0; k < 2; k++) {
        pzs_report report;
        open_problem(neighbours[k]);
        peer_start(neighbours[k]);
        for (int turn = 0; turn < TURNS; turn++) {
            our_step(turn);
            peer_step(turn);
        }
        (void)pzs_assess(&ours.control, ours.target, &report);
        const double rms = misfit(ours.control.info.voltage);
        const double mine = median(spent[0], TURNS), theirs = median(spent[1], TURNS);
        printf("%4g %10.5f %4d %8.2f %8.2f %6.2f %4d\n", neighbours[k], rms, report.active_rows,
               mine, theirs, mine / theirs, ours.control.info.iterations);
#ifdef WITH_DAQP
        if (fabs(misfit(peer.x) - rms) > 1e-9 * rms)
            exit(5);
#endif
    }
    return 0;
}
