/*
 * piezoshape, control image: from a target shape and measurements to voltages inside hard limits.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 *     static pzs_real work[MIRROR_CONTROL_BYTES / sizeof(pzs_real) + 1];   // sizes and tables: pzs
 * tables -o mirror.h static pzs_control control;
 *
 *     int main(void)
 *     {
 *         pzs_status status = pzs_control_init(&control, &mirror_problem, NULL, work, sizeof work);
 *         while (!PZS_IS_ERROR(status)) {
 *             read_target(wanted);                            // [outputs] m
 *             read_sensors(measured);                         // [outputs] m; NaN where a sensor
 * gives nothing status = pzs_tick(&control, wanted, measured);
 *             write_amplifiers(control.info.voltage);         // [inputs] V, inside every limit
 * whatever the status
 *         }
 *         return status;                                      // pzs_status_text(status) says what
 * happened
 *     }
 *
 * Each tick solves  min |W (B v - e)|^2 + regularisation |v - v0|^2,  lower <= v <= upper,  |v -
 * v_last| <= step limit, with e = wanted - (measured - predicted). The control step has no
 * vibration model: `pzs check` prints the range of tick rates at which it is stable on a structure
 * with mass. Options that work around the tick (estimator, feed-forward, converter steps, fault
 * detector) are declared in pzs_loop.h.
 */
#ifndef PZS_CONTROL_H
#define PZS_CONTROL_H

#include "pzs_control_state.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- tables ----------------------------------------------------------- */

/* The voltage problem. All arrays are const and stay in flash. */
typedef struct pzs_problem {
    uint32_t format; /* PZS_TABLE_FORMAT */
    uint32_t scene;  /* hash of the scene that the tables were made from */
    uint32_t crc;    /* checksum of everything below; see pzs_problem_seal */
    uint16_t inputs, outputs;
    const pzs_real *influence;  /* B [outputs][inputs] (m/V), or NULL: given to pzs_control_init */
    const pzs_real *hessian;    /* B'W^2 B [inputs][inputs] (m2/V2), or NULL: computed by
                                   pzs_control_init */
    const pzs_real *weight;     /* W [outputs] (1) */
    const pzs_real *lower;      /* [inputs] lower voltage limit (V) */
    const pzs_real *upper;      /* [inputs] upper voltage limit (V) */
    const pzs_real *step_limit; /* [inputs] largest change in one step (V) */
    const pzs_real *reference_voltage; /* v0 [inputs] (V) */
    pzs_real regularisation;           /* (m2/V2) */
} pzs_problem;

/*
 * Set format and checksum of tables that a firmware has built or changed itself.
 * Errors: ARGUMENT (NULL, or inputs or outputs are 0).
 */
pzs_status pzs_problem_seal(pzs_problem *problem);

/* Problems with more inputs are refused. */
#define PZS_INPUT_LIMIT 4096

/* ---- controller ------------------------------------------------------- */

/* What a program may set after pzs_control_init. */
typedef struct pzs_control_settings {
    uint16_t iteration_limit; /* iterations of the optimiser in one step, at most
                                 PZS_STEP_ITERATIONS (the default) */
} pzs_control_settings;

/* What a program may read. */
typedef struct pzs_control_info {
    const pzs_real *voltage;     /* [inputs] the voltages to give out: always finite and inside the
                                    limits (V) */
    const pzs_real *predicted;   /* [outputs] B v as of the last tick (m) */
    const pzs_real *disturbance; /* [outputs] measured - predicted (m) */
    const pzs_real *lower, *upper; /* [inputs] voltage limits in force: those of the tables,
                                      narrowed by pzs_hold (V) */
    int32_t where;                 /* index that belongs to the last status, or -1 */
    uint16_t iterations;           /* of the last step */
    uint16_t iterations_most;      /* largest number so far */
} pzs_control_info;

typedef struct pzs_control {
    pzs_control_settings settings;
    pzs_control_info info;
    pzs_control_state state;
} pzs_control;

/* Inputs rounded up to whole tiles: the length of a row of the Hessian and of the tableau. */
#define PZS_CONTROL_WIDTH(inputs) PZS_CEIL(inputs)

/* Bytes of workspace for a controller. */
#define PZS_CONTROL_BYTES(inputs, outputs)                                                         \
    (sizeof(pzs_real) *                                                                            \
         ((2u * (size_t)(inputs) + 18u) * PZS_CONTROL_WIDTH(inputs) + 5u * (size_t)(outputs)) +    \
     (size_t)(inputs) + (size_t)(outputs))

/*
 * Check the problem and lay out a controller in the workspace. The voltages start at the reference
 * voltage, clamped to the limits. problem   in  must outlive the controller influence
 * [outputs][inputs] in  computed on the device, read in every step (m/V); NULL: that of the problem
 *   work      in  memory of the caller, aligned for pzs_real; the controller's from now on
 *   bytes     in  at least PZS_CONTROL_BYTES
 * Errors: ARGUMENT, FORMAT, CRC, WORKSPACE, LIMITS (also a negative step limit), NONFINITE. After
 * an error the controller cannot be used, whatever it was before.
 */
pzs_status pzs_control_init(pzs_control *control, const pzs_problem *problem,
                            const pzs_real *influence, void *work, size_t bytes);

/*
 * Start from the voltages that the amplifiers give already, so that nothing jumps: after a reset,
 * or after a second pzs_control_init. They are clamped to the limits; inputs that were held have to
 * be held again. voltage [inputs] in (V) Errors: ARGUMENT, STAGE, NONFINITE (nothing changed).
 */
pzs_status pzs_control_start(pzs_control *control, const pzs_real *voltage);

/*
 * One control tick: disturbance = measured - predicted, a step towards wanted - disturbance,
 * prediction. wanted   [outputs] in  target shape (m) measured [outputs] in  measured shape (m);
 * NULL: rely on the model A measurement that is not finite, or that stands still although its
 * output should move, keeps its last disturbance (SENSOR). Without any usable measurement, or with
 * a target that is not finite, the voltages are held inside the limits now in force (HELD).
 * ITERATIONS and STEP_LIMIT take precedence over SENSOR. Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_tick(pzs_control *control, const pzs_real *wanted, const pzs_real *measured);

/*
 * One voltage step from the last voltages, without measurements.
 *   error [outputs] in  wanted shape minus the shape at zero voltage (m)
 * info.voltage holds the result: inside every limit to the last bit, with an objective no larger
 * than that of the last voltages clamped to the limits, and optimal unless a warning says
 * otherwise; "no larger" and "optimal" up to rounding, epsilon |W B|^2 |v|^2. Work is bounded:
 * iteration_limit iterations of at most inputs^2 multiply-adds, and at most 16 recomputations of
 * the tableau of inputs^3 each, which only rounding errors can ask for. Warnings: ITERATIONS,
 * STEP_LIMIT. Errors: ARGUMENT, STAGE, NONFINITE (voltages held; `where` is -1 after an overflow).
 */
pzs_status pzs_step(pzs_control *control, const pzs_real *error);

/*
 * Hold one input at a voltage (dead: 0, stuck: its last), clamped to its table limits; release it
 * again. The next step or tick goes there at once: a held voltage takes precedence over the step
 * limit (STEP_LIMIT). Errors: ARGUMENT, STAGE, NONFINITE.
 */
pzs_status pzs_hold(pzs_control *control, uint16_t input, pzs_real voltage);
pzs_status pzs_release(pzs_control *control, uint16_t input);

/* ---- certificate ------------------------------------------------------ */

/* Quality of the present voltages. */
typedef struct pzs_report {
    pzs_real relative_error; /* |W (B v - e)| / |W e| */
    pzs_real kkt_violation;  /* largest KKT violation / largest entry of |B'W^2 e| */
    uint16_t active_limits;  /* inputs at a limit */
} pzs_report;

/*
 * Assess the present voltages from the influence matrix alone, independently of the optimiser. It
 * takes 3 inputs*outputs multiply-adds and is not needed in a loop. The limits are those in force;
 * where step limits bind, those of the last step. error  [outputs] in  as given to the last
 * pzs_step; after pzs_tick: wanted - info.disturbance (m) report out           untouched after an
 * error Errors: ARGUMENT, STAGE, NONFINITE.
 */
pzs_status pzs_assess(pzs_control *control, const pzs_real *error, pzs_report *report);

#ifdef __cplusplus
}
#endif
#endif
