/*
 * Calibration on the device: the influence matrix from voltages and readings of the running
 * hardware, by recursive least squares.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 *
 *     pzs_calibration_init(&calibration, &mirror_problem, NULL, NULL, work, sizeof work);
 *     for (uint32_t tick = 0; tick < 100000 && calibration.info.records < 200; tick++) {
 *         read_sensors(readings); // [outputs] m
 *         if (calibration.info.is_settled)
 *             pzs_calibration_record(&calibration, calibration.info.voltage, readings);
 *         pzs_calibration_excite(&calibration);
 *         write_amplifiers(calibration.info.voltage); // [inputs] V, inside every limit, always
 *     }
 *     pzs_calibration_solve(&calibration, influence, spread);
 *     pzs_control_init(&control, &mirror_problem, influence, control_work, sizeof control_work);
 */
#ifndef PZS_CALIBRATE_H
#define PZS_CALIBRATE_H

#include "pzs_control.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Settings of a calibration that a program may change after pzs_calibration_init. */
typedef struct pzs_calibration_settings {
    /*
     * number of records (voltages with their readings) after which an old record hardly counts: a
     * new record reduces the weight of older ones with proportional voltages. At least 2, default
     * infinity
     */
    pzs_real memory;
    pzs_real amplitude; /* amplitude of the test voltages, relative to half of the voltage range of
                           each input, above 0 and at most 1; default 0.25 (dimensionless) */
    uint32_t settle;    /* number of ticks for which the test voltages stay constant before their
                           readings count, at least 1; default 8 */
    pzs_real reading_limit; /* largest plausible absolute value of a reading; a record (voltages
                               with their readings) that contains a larger one is ignored; above 0,
                               default infinity (m) */
    const uint8_t *ignored; /* [outputs] 1 for an output whose readings are not used, 0 for all
                               others; NULL: all readings are used (default) */
} pzs_calibration_settings;

/* Results of a calibration that a program may read. */
typedef struct pzs_calibration_info {
    const pzs_real *voltage; /* [inputs] test voltages to apply, finite and inside the limits (V) */
    const pzs_real *noise; /* [outputs] estimated variance of the noise of each output's readings; 0
                              as long as there are no more records than inputs (m2) */
    uint32_t records; /* number of records (voltages with their readings) that the calibration has
                         used so far */
    /*
     * number of test patterns in a period, in which every pattern occurs once. Over a period the
     * test voltages of any two inputs, each minus its mean, are orthogonal, so that the effects of
     * all inputs can be distinguished
     */
    uint32_t period;
    int32_t where;   /* index of the input or output to which the last status of the calibration
                        refers, or -1 */
    bool is_settled; /* true if the test voltages have been constant for settings.settle ticks, so
                        that readings taken before the next pzs_calibration_excite belong to
                        them */
} pzs_calibration_info;

typedef struct pzs_calibration {
    pzs_calibration_settings settings;
    pzs_calibration_info info;
    pzs_calibration_state state;
} pzs_calibration;

/* Size of the workspace of a calibration (bytes). */
#define PZS_CALIBRATION_BYTES(inputs, outputs)                                                     \
    (sizeof(pzs_real) * (((size_t)(inputs) + 1u) * ((size_t)(inputs) + (size_t)(outputs)) +        \
                         8u * (size_t)(inputs) + (size_t)(outputs)))

/*
 * Start a calibration without records. A record is a set of voltages with the readings under them.
 *   problem                     in  tables with the voltage limits; must outlive the calibration
 *   influence [outputs][inputs] in  influence matrix (m/V) for inputs whose effect the records do
 *                                   not determine; must outlive the calibration; NULL: that of
 *                                   `problem`
 *   voltage [inputs]            in  voltages of the amplifiers (V), clamped to the limits and used
 *                                   as centre of the test voltages; NULL: the reference voltages of
 *                                   `problem`
 *   work                        in  memory of the caller, aligned for pzs_real
 *   bytes                       in  size of this memory, at least PZS_CALIBRATION_BYTES
 * Errors: PZS_E_ARGUMENT, PZS_E_FORMAT, PZS_E_CRC, PZS_E_WORKSPACE, PZS_E_LIMITS, PZS_E_NONFINITE.
 */
pzs_status pzs_calibration_init(pzs_calibration *calibration, const pzs_problem *problem,
                                const pzs_real *influence, const pzs_real *voltage, void *work,
                                size_t bytes);

/*
 * Move the test voltages, calibration.info.voltage, by one tick towards the present test pattern,
 * within all limits. In a pattern every input is at plus or minus its test amplitude; once the
 * voltages have settled, the next pattern begins.
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE, and
 *   PZS_E_LIMITS  input info.where has no finite voltage range
 *   PZS_E_CRC     the limits are damaged; the voltages stay
 */
pzs_status pzs_calibration_excite(pzs_calibration *calibration);

/*
 * Add one record to a calibration: voltages, also those of a running controller, and the readings
 * of the structure in equilibrium under them.
 *   voltage [inputs]  in  voltages of the amplifiers (V)
 *   reading [outputs] in  sensor readings (m); if they have an unknown offset, pass differences of
 *                         readings and of voltages from a reference state
 * Warning, errors: PZS_E_ARGUMENT, PZS_E_STAGE, and
 *   PZS_W_SENSOR     reading info.where is not finite or too large; the record is ignored
 *   PZS_E_NONFINITE  a voltage is not finite, or squares overflow
 */
pzs_status pzs_calibration_record(pzs_calibration *calibration, const pzs_real *voltage,
                                  const pzs_real *reading);

/*
 * Compute the influence matrix that fits the records of a calibration best, for pzs_control_init or
 * pzs_loop_init. The column of an amplifier that is off differs from 0 by its standard errors at
 * most, without a warning: test for this case before use.
 *   influence [outputs][inputs] out  influence matrix (m/V)
 *   spread    [inputs]          out  standard error of entry (i, k) of the matrix is spread[k]
 *                                    times the square root of info.noise[i] (1/V); with a finite
 *                                    settings.memory it is an upper bound
 * Warning, errors: PZS_E_ARGUMENT, PZS_E_STAGE, and
 *   PZS_W_UNOBSERVABLE  The records do not determine the effect of input info.where. Its column is
 *                       that of pzs_calibration_init; its spread and those of inputs that always
 *                       moved with it are infinite.
 */
pzs_status pzs_calibration_solve(pzs_calibration *calibration, pzs_real *influence,
                                 pzs_real *spread);

#ifdef __cplusplus
}
#endif
#endif
