/* Calibrate a plate whose wiring differs from the tables, then hold a shape with the new matrix.
 * SPDX-License-Identifier: BSD-2-Clause */
#define PLATE_REAL_BITS 32 /* this program is for float: it does not compile with double */
#include "board.h"
#include "plate.h"

enum { N = PLATE_INPUTS, M = PLATE_OUTPUTS };
static pzs_real calibration_work[PZS_CALIBRATION_BYTES(N, M) / sizeof(pzs_real) + 1];
static pzs_real work[PLATE_LOOP_BYTES / sizeof(pzs_real) + 1];
static pzs_real influence[M * N], spread[N], readings[M];
static pzs_calibration calibration;
static pzs_loop loop;

/* Simulate a plate that responds 30 % less than the tables say, with electrode 3 reversed. */
static void read_sensors(const pzs_real *voltage)
{
    for (int i = 0; i < M; i++) {
        readings[i] = 0;
        for (int k = 0; k < N; k++)
            readings[i] += plate_influence[i * N + k] * voltage[k] * PZS_R(k == 3 ? -0.7 : 0.7);
    }
}

/* Apply a period of test patterns and compute the matrix from their readings. */
static pzs_status calibrate(void)
{
    pzs_status status = pzs_calibration_init(&calibration, &plate_problem, NULL, NULL,
                                             calibration_work, sizeof calibration_work);
    while (!PZS_IS_ERROR(status) && calibration.info.records < calibration.info.period) {
        read_sensors(calibration.info.voltage);
        if (calibration.info.is_settled)
            (void)pzs_calibration_record(&calibration, calibration.info.voltage, readings);
        status = pzs_calibration_excite(&calibration);
    }
    return status == PZS_OK ? pzs_calibration_solve(&calibration, influence, spread) : status;
}

int main(void)
{
    pzs_real wrong = 0, size = 0; /* sums of squares: measured minus predicted shape, and target */
    board_start();
    pzs_status status = calibrate();
    if (status == PZS_OK)
        status = pzs_loop_init(&loop, plate_blocks, PLATE_BLOCKS, influence, work, sizeof work);
    (void)pzs_loop_start(&loop, calibration.info.voltage);
    for (int tick = 0; tick < 50 && !PZS_IS_ERROR(status); tick++) {
        read_sensors(loop.info.voltage);
        status = pzs_loop_tick(&loop, plate_target, readings);
    }
    for (int i = 0; i < M && status == PZS_OK; i++) {
        wrong += loop.info.control->info.disturbance[i] * loop.info.control->info.disturbance[i];
        size += plate_target[i] * plate_target[i];
    }
    const int matches = wrong < PZS_R(1e-8) * size;
    const char *text = matches ? pzs_status_text(status) : "the matrix is wrong";
    while (*text)
        board_put(*text++);
    board_put('\n');
    return status != PZS_OK || !matches;
}
