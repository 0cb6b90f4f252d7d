/* A mirror without a model: its measured influence matrix stands in this file. The firmware makes
 * the voltage problem itself and seals it. SPDX-License-Identifier: BSD-2-Clause */
#include "board.h"
#include "pzs.h"

enum { INPUTS = 3, OUTPUTS = 6 };

/* Measured: displacement of each output (row, um) per volt of each amplifier (column). */
static const pzs_real influence[OUTPUTS * INPUTS] = {
    PZS_R(0.021), PZS_R(0.004), PZS_R(-0.001), PZS_R(0.018),  PZS_R(0.009), PZS_R(0.000),
    PZS_R(0.009), PZS_R(0.019), PZS_R(0.006),  PZS_R(0.005),  PZS_R(0.020), PZS_R(0.011),
    PZS_R(0.001), PZS_R(0.008), PZS_R(0.019),  PZS_R(-0.001), PZS_R(0.003), PZS_R(0.022),
};
static const pzs_real weight[OUTPUTS] = {1, 1, 1, 1, 1, 1};
static const pzs_real lower[INPUTS] = {-60, -60, -60};                  /* V */
static const pzs_real upper[INPUTS] = {60, 60, 60};                     /* V */
static const pzs_real step_limit[INPUTS] = {5, 5, 5};                   /* V in a tick */
static const pzs_real reference[INPUTS] = {0, 0, 0};                    /* V */
static const pzs_real wanted[OUTPUTS] = {2, 1, 0, -1, -1, PZS_R(-0.5)}; /* um */

static pzs_problem problem = {.inputs = INPUTS,
                              .outputs = OUTPUTS,
                              .influence = influence,
                              .weight = weight,
                              .lower = lower,
                              .upper = upper,
                              .step_limit = step_limit,
                              .reference_voltage = reference};
static pzs_real work[PZS_CONTROL_BYTES(INPUTS, OUTPUTS) / sizeof(pzs_real) + 1];
static pzs_control control;

/* Stands for the sensors: the plant is a tenth weaker than the measured matrix. */
static void read_sensors(pzs_real *measured)
{
    for (int i = 0; i < OUTPUTS; i++) {
        measured[i] = 0;
        for (int k = 0; k < INPUTS; k++)
            measured[i] += PZS_R(0.9) * influence[i * INPUTS + k] * control.info.voltage[k];
    }
}

int main(void)
{
    pzs_real measured[OUTPUTS];
    board_start();
    pzs_status status = pzs_problem_seal(&problem);
    if (status == PZS_OK)
        status = pzs_control_init(&control, &problem, NULL, work, sizeof work);
    for (int tick = 0; tick < 100 && !PZS_IS_ERROR(status); tick++) {
        read_sensors(measured);
        status = pzs_tick(&control, wanted, measured);
    }
    for (const char *text = pzs_status_text(status); *text; text++)
        board_put(*text);
    board_put('\n');
    const pzs_real first = control.info.voltage[0]; /* it raises the first two outputs */
    return status != PZS_OK || !(first > 30 && first <= upper[0]);
}
