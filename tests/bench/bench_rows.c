/*
 * Voltages of the bimorph mirror of tests/rigs/bimorph (16 actuators, 117 points) against DAQP,
 * double, one thread, cold: within 200 V alone, and with neighbours within 200 and 150 V.
 *
 *   make bench-rows
 *
 * Cold means from zero voltages without active limits. Each case is timed from four starts, in
 * each of which both sides form B'W^2 e with the same routine:
 *
 *   step      the tableau (ours) and the inverse factor of the Hessian (DAQP) are computed before
 *   complete  the same; ours also does what pzs_step leaves to the next call, the update of the
 *             tableau
 *   hessian   from the Hessian: ours pzs_control_init, with its checksum and checks of the tables,
 *             and pzs_step; DAQP's factorisation in memory that it has allocated before
 *   influence from the influence matrix: both form the Hessian with the same routine before that
 *
 * Both sides are timed in turn, each solution directly after an untimed one of the same side, which
 * brings its data into the cache. Shown are means of the middle half of the times, without the time
 * of the clock. Objectives that differ by more than 1e-9 fail. Without WITH_DAQP only our side is
 * measured. With the arguments CASE START SIDE, numbers from 0, the program makes COUNTED solutions
 * of this side in the function `counted`, for a program that counts instructions, such as
 *   valgrind --tool=callgrind --toggle-collect='counted*' build/bench/rows 0 0 0
 * Valgrind does not know AVX-512: for DAQP's count build its library with -march=x86-64-v3.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#define _POSIX_C_SOURCE 200809L
#include "pzs.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../../lib/control/limit_rows.h"
#include "../../lib/core/product.h"
#include "clock.h"
#ifdef WITH_DAQP
#include "api.h"
#include "utils.h"
#endif

enum { N = 16, M = 117, ROWS = N - 1, TURNS = 4001, COUNTED = 200 };

/* What is computed before the time starts, see above. */
enum { STEP, COMPLETE, HESSIAN, INFLUENCE, STARTS };

/* Ours, DAQP, DAQP that first looks at the unconstrained optimum. */
enum { SIDES = 3 };

/* Voltages of the mirror during the last scan (V). */
static const double initial[N] = {-516, -242, -134, 56,  -56, 163, -19,  -30,
                                  -190, -93,  -21,  223, 42,  -94, -344, -360};

static struct {
    double influence[M * N + 8], target[M], weight[M], lower[N], upper[N], step_limit[N], zero[N];
    double hessian[N * N];
    uint32_t start[ROWS + 1];
    uint16_t input[2 * ROWS];
    double value[2 * ROWS], low[ROWS], high[ROWS];
    pzs_limit_rows rows;
    pzs_problem problem[STARTS]; /* that of the start INFLUENCE has no Hessian in its tables */
    pzs_control control, saved;  /* `saved` and saved_work: controller before the first step */
} ours;

/* Workspaces, as a firmware declares them: the compiler aligns large static arrays for vectors. */
enum { WORK = (PZS_CONTROL_BYTES(N, M) + PZS_LIMIT_ROW_BYTES(N, ROWS)) / sizeof(double) + 1 };
static double our_work[WORK], saved_work[WORK];

static double spent[STARTS][SIDES][TURNS]; /* us */

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

/* Wait until the memory that was prepared for a solution is written, so that this is not timed. */
static void settle(void)
{
    __sync_synchronize();
}

static void our_start(int start)
{
    if (pzs_control_init(&ours.control, &ours.problem[start], NULL, our_work, sizeof our_work) !=
        PZS_OK)
        exit(1);
}

/* Set up the tables and a controller; without limits between neighbours if these are 0 V. */
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
    for (int start = INFLUENCE; start >= STEP; start--) {
        ours.problem[start] = (pzs_problem){.inputs = N,
                                            .outputs = M,
                                            .influence = ours.influence,
                                            .hessian = start == INFLUENCE ? NULL : ours.hessian,
                                            .weight = ours.weight,
                                            .lower = ours.lower,
                                            .upper = ours.upper,
                                            .step_limit = ours.step_limit,
                                            .reference_voltage = ours.zero,
                                            .limit_rows = neighbours > 0 ? &ours.rows : NULL};
        if (pzs_problem_seal(&ours.problem[start]) != PZS_OK)
            exit(1);
        our_start(start);
        memcpy(ours.hessian, ours.control.state.optimiser.hessian, sizeof ours.hessian);
    }
    ours.saved = ours.control;
    memcpy(saved_work, our_work, sizeof our_work);
}

static void restore_controller(void)
{
    ours.control = ours.saved;
    memcpy(our_work, saved_work, sizeof our_work);
}

static double our_solution(int start)
{
    restore_controller();
    settle();
    const double from = now();
    if (start >= HESSIAN)
        our_start(start);
    const pzs_status status = pzs_step(&ours.control, ours.target);
    if (start == COMPLETE)
        pzs_control_complete(&ours.control);
    const double time = now() - from;
    if (status != PZS_OK)
        exit(3);
    return time;
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
    double f[N + 8], a[ROWS * N], low[N + ROWS], high[N + ROWS], lam[N + ROWS], x[N];
    int sense[N + ROWS];
} peer;

static void peer_start(double neighbours)
{
    const int rows = neighbours > 0 ? ROWS : 0;
    memset(&peer, 0, sizeof peer);
    for (int k = 0; k < N + ROWS; k++) {
        peer.high[k] = k < N ? 200 : neighbours;
        peer.low[k] = -peer.high[k];
    }
    for (int k = 0; k < ROWS; k++) {
        peer.a[k * N + k] = 1;
        peer.a[k * N + k + 1] = -1;
    }
    peer.problem = (DAQPProblem){.n = N,
                                 .m = N + rows,
                                 .ms = N,
                                 .H = ours.hessian,
                                 .f = peer.f,
                                 .A = rows > 0 ? peer.a : NULL,
                                 .bupper = peer.high,
                                 .blower = peer.low,
                                 .sense = peer.sense};
    peer.result.x = peer.x;
    peer.result.lam = peer.lam;
    if (setup_daqp(&peer.problem, &peer.work, NULL) < 0)
        exit(2);
}

static double peer_solution(int start, int way)
{
    int mask = DAQP_UPDATE_v | DAQP_UPDATE_d | (way > 1 ? DAQP_UPDATE_unconstrained : 0);
    daqp_deactivate_constraints(&peer.work);
    reset_daqp_workspace(&peer.work);
    settle();
    const double from = now();
    if (start == INFLUENCE) {
        (void)pzs_control_form_hessian(&ours.control, NULL);
        memcpy(ours.hessian, ours.control.state.optimiser.hessian, sizeof ours.hessian);
    }
    if (start >= HESSIAN)
        mask |= DAQP_UPDATE_Rinv | DAQP_UPDATE_M;
    pzs_product_sum_rows(peer.f, ours.influence, N, ours.target, M, N);
    for (int i = 0; i < N; i++)
        peer.f[i] = -peer.f[i];
    daqp_update_ldp(mask, &peer.work, &peer.problem);
    daqp_solve(&peer.result, &peer.work);
    const double time = now() - from;
    if (peer.result.exitflag < 1)
        exit(4);
    return time;
}

static int differs(double rms)
{
    return fabs(misfit(peer.x) - rms) > 1e-9 * rms;
}
#else
static void peer_start(double neighbours)
{
    (void)neighbours;
}
static double peer_solution(int start, int way)
{
    (void)start, (void)way;
    return NAN;
}
static int differs(double rms)
{
    (void)rms;
    return 0;
}
#endif

static double solution(int start, int side)
{
    return side == 0 ? our_solution(start) : peer_solution(start, side);
}

/* Make COUNTED solutions, for a program that counts the instructions of this function. */
static void __attribute__((noinline)) counted(int start, int side)
{
    for (int k = 0; k < COUNTED; k++)
        (void)solution(start, side);
}

static void row(double neighbours)
{
    static const char *const name[] = {"step", "complete", "hessian", "influence"};
    const double clock = clock_time();
    peer_start(neighbours);
    for (int turn = 0; turn < TURNS; turn++)
        for (int start = 0; start < STARTS; start++)
            for (int side = SIDES; side-- > 0;) {
                (void)solution(start, side);
                spent[start][side][turn] = solution(start, side) - clock;
            }
    pzs_report report;
    (void)pzs_assess(&ours.control, ours.target, &report);
    const double rms = misfit(ours.control.info.voltage);
    for (int start = 0; start < STARTS; start++) {
        const double mine = middle_mean(spent[start][0], TURNS);
        const double theirs =
            fmin(middle_mean(spent[start][1], TURNS), middle_mean(spent[start][2], TURNS));
        printf("%4g %-9s %10.5f %6d %4d %8.3f %8.3f %6.3f %6d\n", neighbours, name[start], rms,
               report.active_limits, report.active_rows, mine, theirs, mine / theirs,
               ours.control.info.iterations);
    }
    if (differs(rms))
        exit(5);
}

int main(int count, char **argument)
{
    static const double neighbours[] = {0, 200, 150};
    read_mirror();
    if (count == 4) {
        open_problem(neighbours[atoi(argument[1])]);
        peer_start(neighbours[atoi(argument[1])]);
        counted(atoi(argument[2]), atoi(argument[3]));
        return 0;
    }
    puts("bimorph mirror, cold: neighbours within (V, 0: no limit), start, RMS (um), voltages at "
         "limits, rows that bind, us, DAQP, ratio, iterations");
    for (size_t k = 0; k < sizeof neighbours / sizeof *neighbours; k++) {
        open_problem(neighbours[k]);
        row(neighbours[k]);
    }
    return 0;
}
