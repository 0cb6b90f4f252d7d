/*
 * Options around the control tick: a shape estimator, feed-forward of known loads, converter steps
 * of the amplifiers, a fault detector for electrodes. A control image links only those that it
 * calls. SPDX-License-Identifier: BSD-2-Clause
 *
 * Order of the calls in one tick:
 *   pzs_feed_forward on the readings (present loads) and on the target (coming loads),
 * pzs_estimate_tick, pzs_tick, pzs_quantise, pzs_fault_detector_tick, then control.info.voltage
 * goes to the amplifiers.
 */
#ifndef PZS_LOOP_H
#define PZS_LOOP_H

#include "pzs_control.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- estimator: the shape from a few sensors (lib/control/estimate.c) -- */

/* Gains of the estimator, computed by the host from the disturbances to expect. All arrays are
 * const, in flash. */
typedef struct pzs_estimator {
    uint32_t format, scene; /* those of the problem */
    uint32_t crc;           /* checksum of everything below; see pzs_estimator_seal */
    uint16_t inputs, outputs, sensors;
    const pzs_real *direct; /* S [sensors][inputs] reading per volt (V/V, C/V, m/V) */
    const pzs_real *gain; /* G [outputs][sensors] shape per deviation of a reading (m/V, m/C, 1) */
} pzs_estimator;

/* Set format and checksum of tables that a firmware has built itself. Errors: ARGUMENT. */
pzs_status pzs_estimator_seal(pzs_estimator *tables);

typedef struct pzs_estimate_info {
    int32_t where; /* index that belongs to the last status, or -1 */
} pzs_estimate_info;

typedef struct pzs_estimate {
    pzs_estimate_info info;
    pzs_estimate_state state;
} pzs_estimate;

/* Bytes of workspace for an estimate. */
#define PZS_ESTIMATE_BYTES(sensors)                                                                \
    (sizeof(pzs_real) * 3u * (((size_t)(sensors) + 3u) / 4u * 4u) + (size_t)(sensors))

/*
 * Lay out an estimate in the workspace; control and tables must outlive it.
 * Errors: ARGUMENT (also tables of other counts), STAGE, FORMAT, CRC, NONFINITE, WORKSPACE (where =
 * bytes needed).
 */
pzs_status pzs_estimate_init(pzs_estimate *estimate, pzs_control *control,
                             const pzs_estimator *tables, void *work, size_t bytes);

/*
 * Before each pzs_tick: estimate the shape from the readings under the present voltages, B v + G (s
 * - S v). The shape is then given to pzs_tick as the measurement. sensed [sensors] in shape
 * [outputs] out (m) A reading that is missing (not finite) or stuck keeps its last deviation.
 * Warnings: SENSOR, HELD (no reading is usable). Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_estimate_tick(pzs_estimate *estimate, const pzs_real *sensed, pzs_real *shape);

/* ---- feed-forward of known loads and temperatures (lib/control/estimate.c) */

/* Shape, or readings, per unit of inputs whose values the firmware knows. In flash. */
typedef struct pzs_feed_forward_table {
    uint32_t format, scene; /* those of the problem; the firmware compares the scene, for a shape
                               carries none */
    uint32_t crc;           /* checksum of everything below; see pzs_feed_forward_seal */
    uint16_t inputs, outputs;
    const pzs_real *sensitivity; /* [outputs][inputs] (m/N, m/Pa, m/K) */
} pzs_feed_forward_table;

/* Set format and checksum of a table that a firmware has built itself. Errors: ARGUMENT. */
pzs_status pzs_feed_forward_seal(pzs_feed_forward_table *table);

/* Check a table once at start-up. Errors: ARGUMENT, FORMAT, CRC, NONFINITE. */
pzs_status pzs_feed_forward_check(const pzs_feed_forward_table *table);

/*
 * Subtract the effect of known inputs from a shape: before a tick from `measured`, with the input
 * values at the time of the measurement, and from `wanted`, with the values to come. With an
 * estimator, subtract it from the readings instead of from `measured`, by a table with one row for
 * each sensor. The controller then sees only what is unknown, and acts on the known part before it
 * shows. value [inputs]  in shape [outputs] in/out (m) Errors: ARGUMENT, NONFINITE (shape
 * untouched).
 */
pzs_status pzs_feed_forward(const pzs_feed_forward_table *table, const pzs_real *value,
                            pzs_real *shape);

/* ---- amplifiers with converter steps and a dead band (lib/control/amplifier.c) */

/*
 * After pzs_tick: replace control.info.voltage by the voltages that the amplifiers will really
 * give, so that the next tick predicts with them. A change of at most dead_band is not made;
 * another change goes to the last multiple of step on the way to the voltage asked for, inside
 * voltage limits and step limits. given     [inputs] in/out  voltages that the amplifiers give; at
 * the start control.info.voltage, then left alone (V) step               in      of the converter
 * (V); 0: none dead_band          in      (V) Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_quantise(pzs_control *control, pzs_real *given, pzs_real step, pzs_real dead_band);

/* ---- fault detector: dead and stuck electrodes (lib/control/faults.c) -- */

/*
 * Finds electrodes that do not follow their amplifiers, from the measured shape alone, and holds
 * them. A suspect is tested for about ten ticks: it is held at two voltages in turn, `amplitude` to
 * either side of where it was, inside all limits, while the control step compensates with the
 * others. At most PZS_TEST_SIGNALS electrodes are tested at a time. An electrode that has lost more
 * than two amplitudes at once, or is asked to move by as much and does not, is detected within 12
 * ticks plus the delay of the sensors: 2 for the suspicion, 9 for the test, 1 to hold it. While
 * more than an eighth of the outputs have no measurement, no electrode is observed. The detector
 * reads static shapes: on a structure that vibrates, or with strong hysteresis, it suspects healthy
 * electrodes.
 */
#define PZS_DELAY_LIMIT 16 /* ticks */

typedef enum pzs_electrode_state {
    PZS_ELECTRODE_OBSERVED = 0,
    PZS_ELECTRODE_TESTED,       /* a test signal is applied */
    PZS_ELECTRODE_CLEARED,      /* passed its test, left alone for a while */
    PZS_ELECTRODE_UNOBSERVABLE, /* its effect is a combination of other electrodes' effects, or
                                   nothing */
    PZS_ELECTRODE_HELD          /* detected, held until pzs_release */
} pzs_electrode_state;

typedef struct pzs_fault_detector_settings {
    pzs_real *amplitude; /* [inputs] of the test signal (V), at most half the step limit; default:
                            just below half the step limit or 1/32 of the voltage range, whichever
                            is smaller; 0: not observed */
} pzs_fault_detector_settings;

typedef struct pzs_fault_detector_info {
    const uint8_t *electrode; /* [inputs] pzs_electrode_state */
    int32_t where;            /* index that belongs to the last status, or -1 */
    uint16_t found;           /* electrodes detected since the start */
    uint16_t unobservable;    /* electrodes that cannot be observed */
} pzs_fault_detector_info;

typedef struct pzs_fault_detector {
    pzs_fault_detector_settings settings;
    pzs_fault_detector_info info;
    pzs_fault_detector_state state;
} pzs_fault_detector;

/* Bytes of workspace for a fault detector. */
#define PZS_FAULT_DETECTOR_BYTES(inputs, outputs, delay)                                           \
    (sizeof(pzs_real) * (PZS_DENSE(inputs) + ((size_t)(delay) + 8u) * (size_t)(inputs) +           \
                         2u * (size_t)(outputs)) +                                                 \
     sizeof(uint32_t) * ((size_t)(inputs) / PZS_TILE + 2u) +                                       \
     (sizeof(uint16_t) + 2u) * (size_t)(inputs) + (size_t)(outputs))

/*
 * Observe the electrodes of a controller, from its present voltages on.
 *   control in/out  must outlive the detector; after pzs_control_init
 *   delay   in      of the measurements, ticks, at most PZS_DELAY_LIMIT: `measured` is the shape of
 * that time plus what the prediction has changed by since; an electrode taken out counts in both
 * with its held voltage Errors: ARGUMENT, STAGE, WORKSPACE (where = bytes needed), NONFINITE.
 */
pzs_status pzs_fault_detector_init(pzs_fault_detector *detector, pzs_control *control,
                                   uint16_t delay, void *work, size_t bytes);

/*
 * After each pzs_tick (and pzs_quantise), with the same measurements.
 * Warnings: ELECTRODE: input `where` was detected (the first of several; all have state
 * PZS_ELECTRODE_HELD). It is held until pzs_release: a dead one at 0 V, another at its last
 * voltage. Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_fault_detector_tick(pzs_fault_detector *detector, const pzs_real *measured);

#ifdef __cplusplus
}
#endif
#endif
