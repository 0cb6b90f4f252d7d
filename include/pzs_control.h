/*
 * piezoshape, control image: from a target shape and measurements to voltages inside hard limits.
 * SPDX-License-Identifier: BSD-2-Clause
 *
 *     // `pzs tables -o mirror.h` writes the sizes and tables
 *     static pzs_real work[MIRROR_CONTROL_BYTES / sizeof(pzs_real) + 1];
 *     static pzs_control control;
 *
 *     int main(void)
 *     {
 *         pzs_status status = pzs_control_init(&control, &mirror_problem, NULL, work, sizeof work);
 *         while (!PZS_IS_ERROR(status)) {
 *             read_target(wanted);    // [outputs] m
 *             read_sensors(measured); // [outputs] m; NaN where a sensor gives nothing
 *             status = pzs_tick(&control, wanted, measured);
 *             write_amplifiers(control.info.voltage); // [inputs] V, inside every limit, always
 *         }
 *         return status; // pzs_status_text(status) says what happened
 *     }
 *
 * Each tick solves
 *   min |W (B v - e)|^2 + regularisation |v - v0|^2
 *   with lower <= v <= upper, |v - v_last| <= step limit,
 * where e = wanted - (measured - predicted). The control step has no vibration
 * model: `pzs check` prints the range of tick rates at which it is stable on a structure with mass.
 * Options around the tick (estimator, damper of vibration, feed-forward, converter steps, fault
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
    const pzs_real *influence;  /* B [outputs][inputs] (m/V), or NULL: passed to pzs_control_init */
    const pzs_real *hessian;    /* B'W^2 B [inputs][inputs] (m2/V2), or NULL: computed by
                                   pzs_control_init */
    const pzs_real *weight;     /* W [outputs] weight of each output (1) */
    const pzs_real *lower;      /* [inputs] lower voltage limit (V) */
    const pzs_real *upper;      /* [inputs] upper voltage limit (V) */
    const pzs_real *step_limit; /* [inputs] largest change of a voltage in one step (V) */
    const pzs_real *reference_voltage; /* v0 [inputs] voltages towards which the regularisation
                                          pulls (V) */
    pzs_real regularisation;           /* weight of |v - v0|^2 in the objective (m2/V2) */
} pzs_problem;

/*
 * Set format and checksum of tables that a firmware has built or changed itself.
 * Errors: ARGUMENT (NULL, or inputs or outputs are 0).
 */
pzs_status pzs_problem_seal(pzs_problem *problem);

/* Largest number of inputs of a problem. */
#define PZS_INPUT_LIMIT 4096

/* Inputs rounded up to whole tiles: the length of a row of the Hessian and of the tableau. */
#define PZS_CONTROL_WIDTH(inputs) PZS_CEIL(inputs)

/* ---- work of a step --------------------------------------------------- */

/*
 * Work is counted in multiply-adds; a loop over the inputs that compares counts as some of them.
 * The first macros are the parts of a step: a product of the Hessian or of the tableau with a
 * vector; the exchange of an input between free set and active set; an iteration, which makes at
 * most one exchange; the start of a round of iterations. lib/control/boxls.c explains them.
 */
#define PZS_PRODUCT_WORK(inputs) ((uint64_t)(inputs)*PZS_CONTROL_WIDTH(inputs))
#define PZS_EXCHANGE_WORK(inputs)                                                                  \
    (((uint64_t)(inputs) + 6u) * ((uint64_t)(inputs) + 6u) / 2u +                                  \
     (PZS_PENDING + 4u) * PZS_CONTROL_WIDTH(inputs))
#define PZS_ITERATION_LOOPS 8u
#define PZS_ITERATION_WORK(inputs)                                                                 \
    (PZS_EXCHANGE_WORK(inputs) +                                                                   \
     (2u * PZS_PENDING + PZS_ITERATION_LOOPS) * PZS_CONTROL_WIDTH(inputs))
#define PZS_ROUND_LOOPS 16u
#define PZS_ROUND_WORK(inputs)                                                                     \
    (PZS_PRODUCT_WORK(inputs) + PZS_ROUND_LOOPS * PZS_CONTROL_WIDTH(inputs))

/* Least value of work_limit: with it a step makes at least one iteration. */
#define PZS_WORK_LEAST(inputs)                                                                     \
    (4u * PZS_PRODUCT_WORK(inputs) + PZS_ROUND_WORK(inputs) + PZS_ITERATION_WORK(inputs))

/* Default value of work_limit, which only contrived problems reach. */
#define PZS_WORK_LIMIT(inputs)                                                                     \
    (40u * PZS_ROUND_WORK(inputs) + (8u * (uint64_t)(inputs) + 100u) * PZS_ITERATION_WORK(inputs))

/* Most multiply-adds of pzs_tick with a work_limit of at least PZS_WORK_LEAST. */
#define PZS_STEP_WORK(inputs, outputs, work_limit)                                                 \
    ((uint64_t)(work_limit) + 3u * (uint64_t)(inputs) * (outputs) +                                \
     16u * ((uint64_t)(outputs) + PZS_CONTROL_WIDTH(inputs)))

/* ---- controller ------------------------------------------------------- */

/* Settings of the controller that a program may change after pzs_control_init. */
typedef struct pzs_control_settings {
    uint64_t work_limit; /* most multiply-adds of the optimiser in one step, at least
                            PZS_WORK_LEAST; PZS_WORK_LIMIT by default */
} pzs_control_settings;

/* Results of the controller that a program may read. */
typedef struct pzs_control_info {
    const pzs_real *voltage;     /* [inputs] the voltages to give out, always finite and inside the
                                    limits (V) */
    const pzs_real *predicted;   /* [outputs] predicted shape B v of the last tick (m) */
    const pzs_real *disturbance; /* [outputs] measured - predicted shape (m) */
    const pzs_real *lower, *upper; /* [inputs] voltage limits in force: those of the tables,
                                      narrowed by pzs_hold (V) */
    int32_t where;                 /* index that belongs to the last status, or -1 */
    uint16_t iterations;           /* iterations of the last step */
    uint16_t iterations_most;      /* largest number of iterations of a step so far */
    uint64_t work;                 /* multiply-adds of the optimiser in the last step */
    uint64_t work_most;            /* largest number of them in a step so far */
} pzs_control_info;

typedef struct pzs_control {
    pzs_control_settings settings;
    pzs_control_info info;
    pzs_control_state state;
} pzs_control;

/* Bytes of workspace for a controller. */
#define PZS_CONTROL_BYTES(inputs, outputs)                                                         \
    (sizeof(pzs_real) * ((2u * (size_t)(inputs) + 23u + PZS_PENDING) * PZS_CONTROL_WIDTH(inputs) + \
                         5u * (size_t)(outputs)) +                                                 \
     (size_t)(inputs) + (size_t)(outputs))

/*
 * Check the problem and lay out a controller in the workspace. The voltages start at the reference
 * voltage, clamped to the limits.
 *   problem                     in  must outlive the controller
 *   influence [outputs][inputs] in  computed on the device, read in every step (m/V); NULL: that of
 *                                   the problem
 *   work                        in  memory of the caller, aligned for pzs_real, used by the
 *                                   controller from now on
 *   bytes                       in  at least PZS_CONTROL_BYTES
 * Errors: ARGUMENT, FORMAT, CRC, WORKSPACE, LIMITS (also a negative step limit), NONFINITE. After
 * an error the controller cannot be used, even if it was valid before.
 */
pzs_status pzs_control_init(pzs_control *control, const pzs_problem *problem,
                            const pzs_real *influence, void *work, size_t bytes);

/*
 * Start from the voltages that the amplifiers already give, so that no voltage jumps after a reset
 * or after another pzs_control_init. The voltages are clamped to the limits; inputs that were held
 * must be held again.
 *   voltage [inputs] in (V)
 * Errors: ARGUMENT, STAGE, NONFINITE (nothing is changed).
 */
pzs_status pzs_control_start(pzs_control *control, const pzs_real *voltage);

/*
 * One control tick: disturbance = measured - predicted, a step towards wanted - disturbance, then
 * the new prediction.
 *   wanted   [outputs] in  target shape (m)
 *   measured [outputs] in  measured shape (m); NULL: rely on the model
 * A measurement that is not finite, or that does not move although its output should, keeps its
 * last disturbance (warning SENSOR). Without any usable measurement, or with a target that is not
 * finite, the voltages are held inside the limits in force (warning HELD). ITERATIONS and
 * STEP_LIMIT take precedence over SENSOR. Errors: ARGUMENT, STAGE.
 */
pzs_status pzs_tick(pzs_control *control, const pzs_real *wanted, const pzs_real *measured);

/*
 * One voltage step from the last voltages, without measurements.
 *   error [outputs] in  target shape minus the shape at zero voltage (m)
 * The result info.voltage is inside every limit to the last bit. Its objective is no larger than
 * that of the last voltages clamped to the limits, and it is optimal unless a warning says
 * otherwise, both up to a rounding error of epsilon |W B|^2 |v|^2. The work is bounded by
 * work_limit (PZS_STEP_WORK); what it cuts off is continued in the next step. Rounding errors may
 * require to recompute the tableau: this is begun at most once in a step, counts as work, and is
 * continued in the next steps if need be. Warnings: ITERATIONS, STEP_LIMIT. Errors: ARGUMENT,
 * STAGE, NONFINITE (the voltages are held; `where` is -1 after an overflow).
 */
pzs_status pzs_step(pzs_control *control, const pzs_real *error);

/*
 * Hold one input at a voltage (a dead one at 0, a stuck one at its last voltage), clamped to its
 * table limits; release it again. The next step or tick sets this voltage at once: a held voltage
 * takes precedence over the step limit (STEP_LIMIT). Errors: ARGUMENT, STAGE, NONFINITE.
 */
pzs_status pzs_hold(pzs_control *control, uint16_t input, pzs_real voltage);
pzs_status pzs_release(pzs_control *control, uint16_t input);

/* ---- certificate of the voltages -------------------------------------- */

/* Quality of the present voltages. */
typedef struct pzs_report {
    pzs_real relative_error; /* |W (B v - e)| / |W e| */
    pzs_real kkt_violation;  /* largest KKT violation / largest entry of |B'W^2 e| */
    uint16_t active_limits;  /* number of inputs at a limit */
} pzs_report;

/*
 * Assess the present voltages by the influence matrix alone, independently of the optimiser. The
 * call takes 3 inputs*outputs multiply-adds and is not needed in a loop. The limits are those in
 * force; where step limits bind, those of the last step.
 *   error  [outputs] in  as passed to the last pzs_step; after pzs_tick: wanted - info.disturbance
 *                        (m)
 *   report           out unchanged after an error
 * Errors: ARGUMENT, STAGE, NONFINITE.
 */
pzs_status pzs_assess(pzs_control *control, const pzs_real *error, pzs_report *report);

#ifdef __cplusplus
}
#endif
#endif
