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
 * Each tick chooses the voltages v that solve
 *   minimise   |W (B v - e)|^2 + regularisation |v - v0|^2
 *   subject to lower <= v <= upper,  |v - v_last| <= step limit
 *   B          influence matrix (m/V)
 *   W          output weights
 *   e          target error: wanted - (measured - predicted shape)
 *   v0, v_last reference voltages; voltages of the last tick
 *
 * The control step has no model of vibration; `pzs check` prints the tick rates at which it is
 * stable on a structure with mass. pzs_loop.h has options such as a vibration damper.
 */
#ifndef PZS_CONTROL_H
#define PZS_CONTROL_H

#include "pzs_limit_rows.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- tables ----------------------------------------------------------- */

/*
 * Functions of the optimiser for many inputs; PZS_DUAL_METHOD tells from how many inputs on they
 * are used.
 */
extern const struct pzs_dual_calls pzs_dual_method;

/*
 * Sparse influence matrix, of which only chosen entries are stored. If all other entries are zero,
 * the controller finds the same voltages as with the full matrix, to the last bit, in fewer
 * multiply-adds.
 */
typedef struct pzs_sparse_influence {
    const struct pzs_sparse_calls *call; /* functions that implement sparse influence matrices:
                                            always &pzs_sparse_influence_calls */
    pzs_rows rows; /* stored entries of the influence matrix (m/V): one sparse row for each output,
                      in which `dof` holds the indices of the inputs, in ascending order, and
                      `value` the entries */
} pzs_sparse_influence;

/*
 * Functions with which the controller checks a sparse influence matrix (pzs_sparse_influence) and
 * multiplies it by vectors.
 */
extern const struct pzs_sparse_calls pzs_sparse_influence_calls;

/*
 * Tables of the voltage optimisation problem, which the controller solves in each tick to find the
 * voltages that give a target shape: influence matrix, weights and limits. All arrays may stay in
 * flash.
 */
typedef struct pzs_problem {
    uint32_t format; /* format number of the controller's tables, PZS_TABLE_FORMAT */
    uint32_t scene;  /* hash of the scene file from which the controller's tables were generated */
    uint32_t crc; /* checksum of the controller's tables and arrays, computed by pzs_problem_seal */
    uint16_t inputs, outputs;
    const pzs_real *influence; /* [outputs][inputs] influence matrix B: displacement of each output
                                  per volt on each input (m/V); NULL: the matrix is in `sparse`, or
                                  is passed to pzs_control_init */
    const pzs_real *hessian;   /* [inputs][inputs] Hessian B'W^2 B of the influence matrix B and the
                                  output weights W (m2/V2); NULL: pzs_control_init computes it */
    const pzs_real *weight;    /* [outputs] weight of each output in the objective
                                  (dimensionless) */
    const pzs_real *lower;     /* [inputs] lower limit of the voltage on each input (V) */
    const pzs_real *upper;     /* [inputs] upper limit of the voltage on each input (V) */
    const pzs_real *step_limit;        /* [inputs] largest change of each voltage in a tick (V) */
    const pzs_real *reference_voltage; /* [inputs] voltages towards which the regularisation pulls
                                          the solution (V) */
    pzs_real regularisation; /* regularisation weight: factor of the squared distance of the
                                voltages from the reference voltages in the objective (m2/V2) */
    uint64_t work_limit; /* largest number of multiply-adds of the optimiser in a tick by default;
                            0: PZS_WORK_LIMIT */
    const pzs_limit_rows *limit_rows; /* limits of weighted sums of voltages, for inputs with finite
                                         voltage limits; NULL: no sum is limited */
    const struct pzs_dual_calls *dual_method; /* PZS_DUAL_METHOD(inputs): functions of the optimiser
                                                 for at least PZS_DUAL_INPUTS inputs, else NULL;
                                                 without them the optimisation of many inputs takes
                                                 more time */
    const pzs_sparse_influence *sparse; /* sparse influence matrix in place of `influence`, which is
                                           then NULL, while `hessian` must be given; NULL: the
                                           matrix is not sparse. Stages of the loop that read single
                                           entries of the influence matrix refuse a sparse one */
} pzs_problem;

/*
 * Write the format number and the checksum into the tables of a voltage optimisation problem that a
 * firmware has built or changed itself. Errors: PZS_E_ARGUMENT for NULL or for tables without
 * inputs or outputs.
 */
pzs_status pzs_problem_seal(pzs_problem *problem);

/* Largest number of inputs (voltages) that the controller accepts. */
#define PZS_INPUT_LIMIT 4096

/*
 * Number of inputs rounded up to a multiple of PZS_TILE: the length of a matrix row in the
 * optimiser.
 */
#define PZS_CONTROL_WIDTH(inputs) PZS_CEIL(inputs)

/* ---- work of a step --------------------------------------------------- */

/*
 * Smallest useful work limit of the optimiser (number of multiply-adds that it may use in a tick):
 * with this limit, the optimiser makes at least one iteration in each tick, also in a tick whose
 * first round ends because limits have moved past voltages.
 */
#define PZS_WORK_LEAST(inputs)                                                                     \
    (((size_t)(inputs) < PZS_DUAL_INPUTS ? 2u * PZS_PRODUCT_WORK(inputs) + PZS_ROUND_WORK(inputs)  \
                                         : 14u * PZS_PRODUCT_WORK(inputs)) +                       \
     PZS_ROUND_WORK(inputs) + PZS_ITERATION_WORK(inputs))

/*
 * Default of the optimiser's work limit: number of multiply-adds that the optimiser may use in a
 * tick. Practical problems need fewer; only problems that are constructed to take many iterations
 * reach the limit.
 */
#define PZS_WORK_LIMIT(inputs)                                                                     \
    (40u * PZS_ROUND_WORK(inputs) + (8u * (uint64_t)(inputs) + 100u) * PZS_ITERATION_WORK(inputs))

/*
 * Upper bound of the multiply-adds of a whole control tick, if work_limit is the number of
 * multiply-adds that the optimiser may use in the tick, at least PZS_WORK_LEAST.
 */
#define PZS_STEP_WORK(inputs, outputs, work_limit)                                                 \
    ((uint64_t)(work_limit) + 3u * (uint64_t)(inputs) * (outputs) +                                \
     16u * ((uint64_t)(outputs) + PZS_CONTROL_WIDTH(inputs)))

/* ---- controller ------------------------------------------------------- */

/* Settings of the controller that a program may change after pzs_control_init. */
typedef struct pzs_control_settings {
    uint64_t work_limit; /* largest number of multiply-adds that the optimiser may use in a tick, at
                            least PZS_WORK_LEAST; a loop cuts it to the default, pzs_problem's */
} pzs_control_settings;

/* Results of the controller that a program may read. */
typedef struct pzs_control_info {
    const pzs_real *voltage; /* [inputs] the voltages to apply, always finite and inside the limits
                                (V) */
    const pzs_real *predicted;   /* [outputs] shape that the model predicts for the voltages of the
                                    last tick (m) */
    const pzs_real *disturbance; /* [outputs] measured shape minus predicted shape in the last tick
                                    (m) */
    const pzs_real *lower, *upper; /* [inputs] present voltage limits: those of the tables; for an
                                      input that pzs_hold keeps at a voltage, both limits are this
                                      voltage (V) */
    int32_t where;       /* index of the input or output to which the last status refers, or -1 */
    uint16_t iterations; /* number of iterations of the optimiser in the last tick */
    uint16_t iterations_most; /* largest number of iterations of the optimiser in any tick so far */
    uint64_t work;            /* number of multiply-adds of the optimiser in the last tick */
    uint64_t work_most; /* largest number of multiply-adds of the optimiser in any tick so far */
} pzs_control_info;

typedef struct pzs_control {
    pzs_control_settings settings;
    pzs_control_info info;
    pzs_control_state state;
} pzs_control;

/* Size of the workspace of a controller (bytes). */
#define PZS_CONTROL_BYTES(inputs, outputs)                                                         \
    (sizeof(pzs_real) * (PZS_CONTROL_ROWS(inputs) * PZS_CONTROL_WIDTH(inputs) +                    \
                         PZS_DUAL_REALS(inputs) + 5u * (size_t)(outputs)) +                        \
     (size_t)(inputs) + (size_t)(outputs))

/*
 * Return the size of the workspace of a controller for given tables, including the memory for
 * limits of sums of voltages (bytes).
 */
size_t pzs_control_bytes(const pzs_problem *problem);

/*
 * Check the tables of a voltage optimisation problem and initialise a controller in the workspace.
 * The voltages start at the reference voltages, clamped to the limits.
 *   problem                     in  tables; must outlive the controller
 *   influence [outputs][inputs] in  influence matrix computed on the device (m/V), read in every
 *                                   tick; NULL: that of the tables
 *   work                        in  memory of the caller, aligned for pzs_real; the controller uses
 *                                   it from now on
 *   bytes                       in  size of the workspace, at least PZS_CONTROL_BYTES, with limits
 *                                   of sums of voltages also PZS_LIMIT_ROW_BYTES
 * Errors, after which the controller cannot be used: PZS_E_FORMAT, PZS_E_CRC, PZS_E_WORKSPACE,
 * PZS_E_NONFINITE, and
 *   PZS_E_ARGUMENT  also for the sparse influence of output info.where, if its columns are not
 *                   ascending or not below the number of inputs
 *   PZS_E_LIMITS    also for a negative step limit; for the limit of sum k, info.where = inputs + k
 */
pzs_status pzs_control_init(pzs_control *control, const pzs_problem *problem,
                            const pzs_real *influence, void *work, size_t bytes);

/*
 * Set the present voltages of a controller to those that the amplifiers already give, clamped to
 * the present limits, so that no voltage jumps after a reset. Repeat earlier calls of pzs_hold
 * afterwards.
 *   voltage [inputs] in  voltages that the amplifiers give (V)
 * Errors, which change nothing: PZS_E_ARGUMENT, PZS_E_STAGE, PZS_E_NONFINITE.
 */
pzs_status pzs_control_start(pzs_control *control, const pzs_real *voltage);

/*
 * Run one control tick: compute the disturbance (measured minus predicted shape), change the
 * voltages towards those that give the target minus the disturbance, and predict the shape of the
 * new voltages.
 *   wanted   [outputs] in  target shape (m)
 *   measured [outputs] in  measured shape (m); NULL: no measurement, the last disturbance is kept
 * Warnings, the first that applies; errors: PZS_E_ARGUMENT, PZS_E_STAGE.
 *   PZS_W_HELD    no measurement is usable or the target is not finite; the voltages are kept
 *                 inside the present limits
 *   PZS_W_ITERATIONS, PZS_W_STEP_LIMIT, PZS_W_LIMIT_ROWS
 *   PZS_W_SENSOR  a measurement is not finite, or stays constant although its output should move;
 *                 its last disturbance is kept
 */
pzs_status pzs_tick(pzs_control *control, const pzs_real *wanted, const pzs_real *measured);

/*
 * Compute the voltages of a tick without measurements: change the last voltages towards those that
 * are optimal for a target error. The result, info.voltage, is inside every limit to the last bit.
 * A step limit bounds the voltage by (last voltage +- limit), rounded to nearest.
 *   error [outputs] in  target shape minus the shape at zero voltage (m)
 * Warnings: PZS_W_ITERATIONS, PZS_W_STEP_LIMIT. Errors: PZS_E_ARGUMENT, PZS_E_STAGE,
 * PZS_E_NONFINITE (the voltages stay; info.where is -1 after an overflow).
 *   - Without a warning the result is the optimum; otherwise its objective is not larger than that
 *     of the last voltages clamped to the limits. Both hold up to a rounding error of
 *     epsilon |W B|^2 |v|^2  (machine epsilon, output weights W, influence matrix B, voltages v).
 *   - The work is at most PZS_STEP_WORK; the next call continues where this limit stops the
 *     optimiser.
 *   - The voltages are returned before the tableau (pivoted Hessian) of the optimiser is updated:
 *     the next call does this first, with at most PZS_PENDING * PZS_PRODUCT_WORK multiply-adds that
 *     the work of this call contains already. pzs_tick leaves nothing to the next call.
 */
pzs_status pzs_step(pzs_control *control, const pzs_real *error);

/*
 * pzs_hold fixes the voltage of one input, for example of a dead electrode at 0 V; pzs_release lets
 * the controller choose it again.
 *   voltage in  voltage (V), clamped to the limits of the tables
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE, PZS_E_NONFINITE.
 *   - The next pzs_tick or pzs_step applies the voltage, even beyond the step limit (warning
 *     PZS_W_STEP_LIMIT).
 *   - Where sums of voltages are limited, the voltage is reached gradually within all limits
 *     (warning PZS_W_LIMIT_ROWS), while the others move towards the safe voltages of
 *     pzs_limit_rows.
 */
pzs_status pzs_hold(pzs_control *control, uint16_t input, pzs_real voltage);
pzs_status pzs_release(pzs_control *control, uint16_t input);

/* ---- certificate of the voltages -------------------------------------- */

/*
 * How well the present voltages of a controller reach the target, and how near they are to the
 * optimum; pzs_assess computes it.
 */
typedef struct pzs_report {
    pzs_real relative_error; /* weighted norm of (reached shape - target) divided by the weighted
                                norm of the target (dimensionless) */
    pzs_real kkt_violation; /* largest violation of the optimality (KKT) conditions, relative to the
                               largest entry of the gradient at zero voltage (dimensionless) */
    uint16_t active_limits; /* number of inputs whose voltage is at its lower or upper limit */
    uint16_t active_rows; /* number of limits of sums of voltages that hold with equality and have a
                             Lagrange multiplier */
} pzs_report;

/*
 * Assess the present voltages of a controller from the influence matrix alone, independently of the
 * optimiser, with 3 inputs*outputs multiply-adds. The limits are the present ones, narrowed by the
 * step limits of the last tick.
 *   error  [outputs] in   error passed to the last pzs_step, or, after pzs_tick, target minus
 *                         info.disturbance (m)
 *   report           out  unchanged after an error
 * Errors: PZS_E_ARGUMENT, PZS_E_STAGE, PZS_E_NONFINITE.
 */
pzs_status pzs_assess(pzs_control *control, const pzs_real *error, pzs_report *report);

#ifdef __cplusplus
}
#endif
#endif
