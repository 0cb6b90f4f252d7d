/*
 * Internal state of the controller and of the blocks (stages of a tick) of the control loop. The
 * types are public only so that a program can reserve memory for them; the library alone uses their
 * members, which may change in every version.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef PZS_CONTROL_STATE_H
#define PZS_CONTROL_STATE_H

#include "pzs_base.h"

struct pzs_problem;
struct pzs_control;
struct pzs_estimator;
struct pzs_known_loads;
struct pzs_amplifier;
struct pzs_block;
struct pzs_limit_row_calls;
struct pzs_dual_calls;
struct pzs_absolute_row_calls;
struct pzs_sparse_calls;

/*
 * Value of pzs_problem.dual_method for a number of inputs (voltages). From PZS_DUAL_INPUTS inputs
 * on it is the dual active-set method, the optimiser's method for many inputs, else NULL.
 */
#define PZS_DUAL_METHOD(inputs) ((size_t)(inputs) >= PZS_DUAL_INPUTS ? &pzs_dual_method : NULL)

/*
 * Number of pivot exchanges that the optimiser collects before it applies them together to its
 * matrix, the tableau (pivoted Hessian). A pivot exchange moves an input between the set of free
 * voltages and the set of voltages kept at a bound.
 */
#define PZS_PENDING PZS_BY_TILE(4u, 32u, 32u)

/*
 * Numbers of multiply-adds of the optimiser; a loop over the inputs that only compares counts as a
 * few.
 *   PZS_PRODUCT_WORK    product of the Hessian with a vector
 *   PZS_EXCHANGE_WORK   move of one input between the free set and the active set
 *   PZS_ITERATION_WORK  one iteration, with at most one such move
 *   PZS_ROUND_WORK      start of a round, before its first iteration; a round is a sequence of
 *                       iterations that ends with a gradient computed from the Hessian
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

/*
 * Number of vectors at the start of a controller's workspace, each with one real number for each
 * input and padded to the length PZS_CONTROL_WIDTH(inputs).
 */
#define PZS_CONTROL_ROWS(inputs) (2u * (size_t)(inputs) + 23u + PZS_PENDING)

/*
 * Number of real numbers in the memory of the optimiser's method for many inputs, the dual
 * active-set method: a packed triangular Cholesky factor with a row for each input, and two
 * vectors; 0 for fewer than PZS_DUAL_INPUTS inputs, for which the method is not used.
 */
#define PZS_DUAL_REALS(inputs)                                                                     \
    ((size_t)(inputs) < PZS_DUAL_INPUTS ? 0u : (size_t)(inputs) * ((size_t)(inputs) + 5u) / 2u)

/*
 * One pivot exchange of the optimiser's matrix, the tableau (pivoted Hessian): it moves an input
 * between the set of free voltages and the set of voltages kept at a bound.
 */
typedef struct pzs_exchange {
    uint32_t input;
    pzs_real sign;  /* sign (+1 or -1) of the pivot, the diagonal entry that the pivoted Hessian had
                       before the exchange of this input */
    pzs_real scale; /* 1 / square root of the absolute value of the pivot, the diagonal entry that
                       the pivoted Hessian had before the exchange of this input */
    pzs_real pivot; /* diagonal entry that the pivoted Hessian has after the exchange of this input
                     */
} pzs_exchange;

/*
 * State of the optimiser, an active-set method for bounded least squares. Arrays with an entry for
 * each input are padded with zeros to the length `width`, so that vector loops need no remainder.
 *   free set    inputs whose voltages may change
 *   active set  inputs whose voltages are kept at a bound or, for the present, between the bounds
 *   tableau     Hessian after one pivot exchange for each input of the free set
 *   round       sequence of iterations that ends with a gradient computed from the Hessian
 */
typedef struct pzs_optimiser {
    const struct pzs_dual_calls *dual; /* functions of the dual active-set method; NULL: the
                                          optimiser uses its primal active-set method */
    uint32_t inputs, width;
    uint32_t iterations;
    uint64_t work, work_limit; /* number of multiply-adds that the optimiser has used in this tick,
                                  and the largest number that it may use */
    pzs_real *hessian; /* [inputs][width >= inputs] Hessian H of the objective that the optimiser
                          minimises (m2/V2) */
    pzs_real *tableau; /* [inputs][width >= inputs] the optimiser's tableau: the Hessian after one
                          pivot exchange for each input whose voltage is free, without the exchanges
                          that are collected in `pending` */
    pzs_real *pivot;   /* [width >= inputs] diagonal of the optimiser's tableau (pivoted Hessian)
                          after all pivot exchanges, also after those that are still in `pending` */
    pzs_real *pending; /* [PZS_PENDING][width >= inputs] rank-one updates of the tableau (pivoted
                          Hessian): one vector for each pivot exchange that is collected but not yet
                          applied to the tableau */
    pzs_exchange *exchange; /* [pending_most] pivot exchanges that are collected but not yet applied
                               to the tableau (pivoted Hessian); their rank-one updates are in the
                               array `pending` */
    /*
     * [width >= inputs] marks of inputs, 1 or 0. Meaning of 1 in the different parts of the
     * optimiser:
     *   computation of the tableau (pivoted Hessian)  voltage that is to become free again
     *   dual active-set method                        ignored input: only rounding errors move it
     *                                                 out of its bounds
     *   primal method                                 free input whose voltage would pass a bound
     */
    pzs_real *waiting;
    pzs_real *factor;  /* [inputs (inputs + 1) / 2] Cholesky factor of the inverse of the Hessian
                          restricted to the inputs whose voltages are at a bound, lower triangle row
                          by row; the dual active-set method uses it */
    pzs_real *side;    /* [inputs] bound at which the dual active-set method keeps the voltage of an
                          input: -1 for the lower and +1 for the upper bound */
    uint16_t *order;   /* [inputs] index of the input to which each row of the Cholesky factor
                          `factor` belongs; the dual active-set method uses it */
    pzs_real *voltage; /* [width >= inputs] present voltages of the optimiser (V) */
    pzs_real *lower, *upper; /* [width >= inputs] lower and upper bounds of the voltages in the
                                present tick (V) */
    pzs_real *free_set; /* [width >= inputs] 1 for an input whose voltage is free, 0 for one whose
                           voltage is kept, mostly at a bound; real numbers, because vector loops
                           multiply by them */
    pzs_real *base; /* [width >= inputs] base voltages (V): the optimiser computes the gradient of
                       the objective as its value at these voltages plus the Hessian times (voltages
                       - base voltages) */
    pzs_real *regularisation_gradient; /* [width >= inputs] part of half the gradient of the
                                          objective: regularisation weight times (`base` voltages -
                                          reference voltages) (m2/V) */
    pzs_real *target_gradient; /* [width >= inputs] part of half the gradient of the objective
                                  that depends on the target error e (m2/V): B'W^2 (e - B v),
                                  with the influence matrix B, the output weights W, and the
                                  voltages v in the array `base`. Half the gradient is
                                  model_gradient minus this array */
    pzs_real *model_gradient;  /* [width >= inputs] first part of half the gradient of the
                                  optimiser's objective (m2/V): Hessian * (present voltages -
                                  base voltages) + regularisation weight * (base voltages -
                                  reference voltages). The base voltages are those in the array
                                  `base` */
    pzs_real *gradient;  /* [width >= inputs] half the gradient of the objective with respect to the
                            voltages: model_gradient minus target_gradient (m2/V) */
    pzs_real *direction; /* [width >= inputs] for an input whose voltage is free, the optimiser's
                            search direction (V); for an input whose voltage is kept at a bound,
                            half the gradient of the objective after the step (m2/V) */
    pzs_real *diagonal;  /* [width >= inputs] diagonal of the Hessian of the objective (m2/V2) */
    pzs_real *start_voltage;  /* [width >= inputs] voltages at the start of the present round, a
                                 sequence of iterations of the optimiser that ends with a gradient
                                 computed from the Hessian (V) */
    pzs_real *start_gradient; /* [width >= inputs] half the gradient of the optimiser's objective at
                                 the start of the present round, a sequence of iterations (m2/V) */
    /*
     * [width >= inputs] voltages after a full step along the optimiser's search direction (V);
     * before the direction is known, the gradient of the inputs whose voltages are free (m2/V)
     */
    pzs_real *next_voltage;
    pzs_real *scratch; /* [width >= inputs] work array of the optimiser; after the search direction
                          is known, differences between the voltages after a full step and the
                          voltages `base`, around which the gradient is computed (V) */
    pzs_real inverse_trace; /* trace of the inverse of the Hessian restricted to the inputs whose
                               voltages are free (V2/m2), which tells how much an error of the
                               gradient raises the objective; 0: not computed */
    pzs_real inverse_trace_bound; /* upper bound of `inverse_trace` that follows from the
                                     regularisation weight alone (V2/m2); 0: there is none.
                                     `inverse_trace` is the trace of the inverse of the Hessian
                                     restricted to the inputs whose voltages are free */
    pzs_real whole_inverse_trace; /* trace of the inverse of the whole Hessian (V2/m2), an upper
                                     bound of `inverse_trace`; 0: not computed, because the effects
                                     of some inputs are combinations of others */
    /*
     * threshold of linear dependence (dimensionless): an input counts as a combination of the
     * inputs whose voltages are free if its pivot, divided by its diagonal entry of the Hessian, is
     * below this number
     */
    pzs_real pivot_floor;
    pzs_real pivot_rounding; /* estimated rounding error of the pivots that belong to limits of sums
                                of voltages in the dual active-set method (V2/m2); 0: no sums are
                                limited */
    /*
     * largest gradient of a free voltage at the start of the present round of iterations, plus the
     * changes of the multipliers of all inputs that become active in it (m2/V). Where sums of
     * voltages are limited, the rounding errors of the voltages are estimated from it
     */
    pzs_real multiplier_change;
    pzs_real model_rounding;  /* rounding-error bound of each entry of model_gradient (m2/V). The
                                 array model_gradient is the part of half the gradient of the
                                 objective that depends on the voltages */
    pzs_real start_rounding;  /* rounding-error bound of each entry of start_gradient (m2/V). The
                                 array start_gradient is half the gradient of the objective at
                                 the start of the present round (sequence of iterations) */
    pzs_real target_rounding; /* rounding-error bound of each entry of target_gradient (m2/V).
                                 The array target_gradient is the part of half the gradient of
                                 the objective that depends on the target shape */
    pzs_real target_energy;   /* scale of the objective, with which its rounding errors are compared
                                 (m2): weighted squared norm of the target shape minus the shape
                                 without voltages */
    /*
     * how far the present voltages are from the optimality (KKT) conditions (m2/V), compared with
     * `rounding_bound`: the largest violation by an input. If the tableau (pivoted Hessian) has
     * predicted the gradient, which then violates nothing, it is an estimate of the prediction
     * error: two entries of the gradient are computed from the Hessian, too, and their absolute
     * errors added
     */
    pzs_real kkt_violation;
    pzs_real rounding_bound; /* rounding-error bound of a violation of the optimality (KKT)
                                conditions: a smaller violation counts as zero (m2/V) */
    uint32_t active_count;   /* number of inputs in the active set, whose voltages are kept constant
                              */
    uint32_t active_most;  /* largest number of inputs that the dual active-set method may keep at a
                              bound */
    uint32_t checked_next; /* index of the next input whose gradient is computed from the Hessian,
                              to verify the gradient that the tableau (pivoted Hessian) predicts */
    uint32_t pending_count; /* number of pivot exchanges collected but not yet applied to the
                               tableau (pivoted Hessian) */
    uint32_t pending_most;  /* largest number of pivot exchanges that are collected before they are
                               applied to the tableau (pivoted Hessian) */
    /*
     * number of pivot exchanges (moves of an input between the set of free voltages and the set of
     * voltages at a bound) since the tableau (pivoted Hessian) was last computed from the Hessian
     */
    uint32_t exchanges;
    uint32_t rebuilds; /* number of times that the tableau (pivoted Hessian) was computed anew from
                          the Hessian in this tick */
    pzs_exchange collected[PZS_PENDING];
    bool is_rebuilding; /* whether the tableau (pivoted Hessian) is incomplete, because some inputs
                           whose voltages are to become free again are not yet exchanged */
    bool is_predicted;  /* whether model_gradient, the part of the gradient that depends on the
                           voltages, was predicted by the tableau (pivoted Hessian) and not computed
                           from the Hessian */
    bool is_cut;        /* whether the optimiser, in the last tick, reached its largest number of
                           multiply-adds before the optimum */
    bool is_fresh; /* whether the tableau (pivoted Hessian) was computed anew from the Hessian after
                      the optimiser last found an optimum */
    bool is_verified; /* whether the optimiser has found an optimum with the present tableau
                         (pivoted Hessian), so that the next tick may predict most of the gradient
                         from the tableau */
    bool is_dual; /* whether the optimiser uses the dual active-set method, for which the tableau
                     (pivoted Hessian) stays the negative inverse of the whole Hessian */
    bool is_optimal;
} pzs_optimiser;

/*
 * Optimiser for a problem that limits not only the voltages but also weighted sums of voltages.
 * Each vector has one entry for each input, followed by one for each of the `rows` limited sums,
 * and is padded to the length `width`.
 */
typedef struct pzs_row_solver {
    pzs_optimiser extended; /* state of the active-set optimiser; in its matrices and vectors the
                               entries of the inputs come first, those of the limited sums of
                               voltages follow */
    /*
     * [width >= inputs + rows] first an entry for each input, then one for each limited sum of
     * voltages:
     *   input  where absolute values are limited: 1 if the voltage must not become negative in the
     *          present iterations, -1 if it must not become positive
     *   sum    factor of this sum in the optimiser: reciprocal of its largest absolute coefficient
     */
    pzs_real *scale;
    /*
     * [width >= inputs + rows] safety margin against rounding errors (V). For a limited sum of
     * voltages: the distance by which the optimiser narrows its limits. For an input: the largest
     * of these distances of all limited sums
     */
    pzs_real *margin;
    pzs_real gap; /* duality gap: upper bound of how far half the optimiser's objective is above its
                     minimum (m2) */
    /*
     * duality gap at the start of the optimiser's last round of iterations, if this round lowered
     * the objective by no more than its rounding error; else infinity (m2). The gap is an upper
     * bound of how far half the objective is above its minimum
     */
    pzs_real last_gap;
    /*
     * shift of the diagonal of a nearly singular Hessian, which makes it regular, as a ratio
     * (dimensionless): (regularisation weight + number added to each diagonal entry) / largest
     * diagonal entry; 0: no shift
     */
    pzs_real least_curvature;
    pzs_real least_rounding; /* rounding-error bound of a violation of the optimality (KKT)
                                conditions at the start of the tick (m2/V); 0: not yet computed */
    uint32_t failures; /* number of rounds (sequences of iterations of the optimiser) in this tick
                          that did not lower the objective */
} pzs_row_solver;

/*
 * One array of a constant table whose checksum is verified while the control loop runs; an absent
 * array has 0 bytes.
 */
typedef struct pzs_table_part {
    const void *data;
    size_t bytes;
} pzs_table_part;

/* Largest number of arrays in the constant tables of a block (stage of the control tick). */
#define PZS_TABLE_PARTS 14u

/*
 * Progress of a scrub, a check of constant tables for damage while the control loop runs: each tick
 * reads one slice of the tables, and after the last slice the checksum of all slices is compared
 * with the stored one.
 */
typedef struct pzs_scrub {
    uint32_t position; /* offset of the next slice to be checked from the start of the constant
                          tables (bytes) */
    uint32_t crc; /* running checksum of the slices of constant tables read since the start of the
                     tables */
    bool has_failed; /* whether the last complete check of the constant tables found a wrong
                        checksum */
} pzs_scrub;

/*
 * Results of the controller that are out of date because voltages were changed otherwise than by
 * the optimiser.
 */
typedef enum pzs_control_behind {
    PZS_BEHIND_NOTHING = 0,
    PZS_BEHIND_PREDICTION, /* only info.predicted is out of date, the shape that the controller
                              predicts for its voltages */
    /*
     * two results are out of date: info.predicted, the shape that the controller predicts for its
     * voltages, and the gradient of its optimiser
     */
    PZS_BEHIND_GRADIENT
} pzs_control_behind;

/*
 * Function by which a block (stage of the tick) changes the gradient of the objective in a tick
 * (target_gradient of the optimiser), for example by gains of modes. The struct must be the first
 * member of the block's memory.
 *   missed in  scale of the gradient's rounding errors before the change, as the weighted squared
 *              norm of a shape (m2)
 * Returns this scale after the change (m2).
 */
typedef struct pzs_step_filter {
    pzs_real (*filter_step)(struct pzs_control *control, struct pzs_step_filter *filter,
                            pzs_real missed);
} pzs_step_filter;

typedef struct pzs_control_state {
    const struct pzs_problem *problem;
    const pzs_real *influence; /* [outputs][inputs] influence matrix in use: the one passed to
                                  pzs_control_init, or that of pzs_problem (m/V); NULL: the sparse
                                  influence matrix of pzs_problem is in use */
    pzs_optimiser optimiser;
    pzs_real *lower, *upper; /* [inputs] present voltage limits: those of pzs_problem; for an input
                                that pzs_hold keeps at a voltage, both limits are this voltage (V)
                              */
    pzs_real *held[3]; /* [inputs] voltage at which pzs_hold keeps an input (V); NaN: pzs_hold does
                          not keep it. Three copies are stored, so that two outvote a damaged third
                        */
    pzs_real *voltage; /* [inputs] present voltages of the controller (V) */
    pzs_real *predicted;   /* [outputs] shape predicted for the present voltages (m) */
    pzs_real *disturbance; /* [outputs] measured shape minus predicted shape (m) */
    pzs_real *measured;    /* [outputs] measured shape of the last tick (m) */
    pzs_real *step_limit;  /* [inputs] step limits: largest change of the voltage on each input in
                              one tick (V) */
    /*
     * [2][outputs] first row: work array for the squared output weights times the difference
     * between target shape and expected shape (m). Second row: expected measurements (m), that is,
     * the predicted shape plus the last difference between measured and predicted shape
     */
    pzs_real *weighted;
    uint8_t *repeats; /* [outputs] number of ticks in which a measurement stayed constant although
                         its output should have moved, plus 128 while it is missing */
    uint8_t *faulty;  /* [inputs] 1: the fault detector keeps the voltage of the input constant
                         because the shape did not respond to it; otherwise 0 */
    const pzs_real *damping; /* [inputs] damping gradient (m2/V); NULL: no damping. It is subtracted
                                from half the gradient of the objective, so that the optimal
                                voltages also take energy out of the vibration */
    pzs_real *carry; /* [inputs] parts of earlier voltage changes that the amplifiers have not made
                        because of their converter steps and dead band (V); NULL: such parts are
                        ignored */
    pzs_real share; /* factor, from 0 to 1, by which a tick that also damps vibration multiplies the
                       gradient of the objective */
    pzs_step_filter *filter; /* block that changes the gradient of the objective in this tick, with
                                its function; NULL: none */
    pzs_real base_energy;    /* weighted squared norm of the shape that the model predicts for the
                                voltages pzs_optimiser.base; the scale of the objective is computed
                                from it (m2) */
    pzs_real largest_column; /* square root of the largest diagonal entry of the Hessian: the
                                largest weighted norm of a column of the influence matrix (m/V) */
    bool is_paused; /* true while a fault detector measures the response to a test pulse: the ticks
                       of the loop then damp vibration, but do not follow target and loads */
    bool is_taken_over; /* true after a tick in which the supervisor, not the control step,
                           determined the voltages: a fault detector then ends its tests */
    bool is_led; /* true after a tick in which the supervisor moved the voltages, on a ramp or in a
                    polarity test: the optimiser then does the least work */
    bool is_stuck; /* true while the supervisor finds all readings stuck: a vibration damper then
                      ignores them until one of them changes */
    bool has_step_limits; /* whether a step limit (largest change of a voltage in a tick) is shorter
                             than the distance between the voltage limits of its input */
    pzs_control_behind behind;
    uint32_t predicted_sum; /* exclusive or of the words of the array `predicted` */
    uint16_t scrub_row; /* index of the row of the optimiser's Hessian that the next tick compares
                           with the constant tables from which it was computed, to find and repair
                           damaged memory */
    void *work;         /* workspace (memory of the caller) that was passed to pzs_control_init */
    pzs_row_solver *row_solver; /* optimiser where weighted sums of voltages are limited; NULL: no
                                   sums are limited */
    uint8_t stage;
} pzs_control_state;

/*
 * One test of the fault detector for electrodes: the voltage of an electrode alternates between two
 * values to see whether the shape responds.
 */
typedef struct pzs_test_signal {
    uint16_t input;         /* index of the input whose electrode is tested; 0xFFFF: no test */
    uint8_t shapes, moves;  /* shapes: number of measured shapes, and moves: number of voltage
                               changes, since the test of the electrode began */
    bool is_upper, is_dead; /* is_upper: whether the upper of the two test voltages of an electrode
                               is applied now; is_dead: whether the electrode seems to be at 0 V
                               rather than stuck at another voltage */
    pzs_real middle, set;   /* mean of the two test voltages of an electrode, and the test voltage
                               applied now (V) */
    pzs_real lower, upper;  /* lower and upper voltage limit that an electrode has when the fault
                               detector does not test it (V) */
    pzs_real sum, square, response_sum,
        response_square; /* sums over the voltage changes of the electrode that the fault detector
                            tests (V, V2): of the commanded changes (sum) and of their squares
                            (square), of the changes that the measured shape indicates
                            (response_sum) and of their squares (response_square) */
} pzs_test_signal;

/* Largest number of electrodes that the fault detector tests at the same time. */
#define PZS_TEST_SIGNALS 4

typedef struct pzs_fault_detector_state {
    struct pzs_control *control;
    /*
     * L D L^T factors of a matrix (m2/V2) by which the fault detector estimates electrode voltages
     * from the measured shape (least squares): B'W^2 B plus regularisation, with influence matrix B
     * and output weights W, over the outputs that are measured
     */
    pzs_envelope columns;
    pzs_real *diagonal; /* [inputs] diagonal of the matrix B'W^2 B over all outputs, with influence
                           matrix B and output weights W (m2/V2) */
    pzs_real *voltage;  /* [delay + 1][inputs] ring buffer with the voltages of the last delay + 1
                           ticks (delay: age of the measured shapes in ticks) (V) */
    pzs_real *voltage_before; /* [inputs] voltages at the time of the previous measured shape (V) */
    pzs_real *deviation; /* [inputs] unexplained voltage change of each electrode since the last
                            measured shape (V): the change that a least-squares fit to the shape
                            indicates, minus the commanded change */
    pzs_real *moved, *response; /* [inputs] exponentially decaying sums over the measured shapes of
                                   squared voltage changes of each electrode: `moved` of the
                                   commanded changes, `response` of the changes that the shape
                                   indicates (V2) */
    /*
     * [inputs] voltage that each electrode seems to have lost: exponentially decaying sum of the
     * differences between two changes of its voltage, the one that the measured shape indicates and
     * the commanded one (V)
     */
    pzs_real *lost_voltage;
    pzs_real *disturbance; /* [outputs] measured minus predicted shape at the time of the last
                              measured shape (m) */
    pzs_real *change;      /* [outputs] squared output weight times the change of (measured minus
                              predicted shape) since the last measured shape (m) */
    uint8_t *electrode;    /* [inputs] state of each electrode in the fault detector, a value of
                              pzs_electrode_state */
    uint8_t *missing; /* [outputs] bit 0: the output was not measured in the last measured shape;
                         bit 1: the output is excluded from the least-squares estimate of the
                         electrode voltages */
    uint8_t *pause;   /* [inputs] number of measured shapes to come in which an electrode that has
                         passed its test is not suspected */
    pzs_test_signal test[PZS_TEST_SIGNALS];
    pzs_real ridge; /* regularisation weight when electrode voltages are estimated from the measured
                       shape by least squares, relative to the diagonal of the normal matrix
                       (dimensionless) */
    uint16_t delay, oldest;
    bool is_stale; /* whether the matrix of the least-squares estimate of electrode voltages must be
                      factored anew, because other outputs are measured than before */
    uint8_t stage;
} pzs_fault_detector_state;

/*
 * Number of unknown factors in the least-squares fit of the readings during a test pulse: those of
 * three modelled responses, and the vibration of the first mode.
 */
#define PZS_PULSE_COLUMNS 4u
/* Number of equal parts of a test pulse over which its course in time is summed. */
#define PZS_PULSE_PARTS 16u
/* Largest number of electrodes that a fault detector suspects at the same time. */
#define PZS_PULSE_CANDIDATES 2u

/*
 * Least-squares fit of the measured response to a test pulse (changes of the readings, each times
 * the scale factor of its sensor, so that they are numbers without unit) by four columns: modelled
 * responses to the suspected electrode, to the healthy reference electrode and to all other
 * electrodes, and the readings of a vibration of the first mode.
 */
typedef struct pzs_pulse_fit {
    /*
     * lower triangle of the matrix of scalar products over the sensors (dimensionless) between the
     * columns. After the factorisation: its L D L^T factors
     */
    pzs_real matrix[PZS_PULSE_COLUMNS][PZS_PULSE_COLUMNS];
    /*
     * scalar products over the sensors (dimensionless) of the measured response with the columns.
     * After the solution: the gains (measured divided by modelled response), and the weighted sum
     * of the vibration
     */
    pzs_real response[PZS_PULSE_COLUMNS];
    pzs_real own;    /* squared norm over the sensors of the modelled response to the suspected
                        electrode (dimensionless) */
    pzs_real energy; /* squared norm over the sensors of the measured response (dimensionless) */
} pzs_pulse_fit;

/*
 * Result of one test pulse that two electrodes make together: the one suspected of a fault [0] and
 * a healthy one with which it is compared [1].
 */
typedef struct pzs_pulse_response {
    pzs_real gain[2];   /* gain of each electrode: measured divided by modelled response to the test
                           pulse (dimensionless) */
    pzs_real jumped[2]; /* jump of the readings in the middle of the test pulse, for example by a
                           load, as a multiple of the modelled response to each electrode
                           (dimensionless). A large jump makes the gains unreliable */
    /*
     * course error of each electrode (dimensionless): largest change within the pulse of the
     * voltage that the readings show and that its pulse and gain do not explain, divided by the
     * height of the pulse; means over a period of vibration. A load that comes and goes during the
     * pulse makes it large
     */
    pzs_real course_error[2];
    pzs_real unexplained; /* unexplained part of the measured response (dimensionless): sum of
                             squares of the part that neither modelled responses nor a vibration of
                             the first mode explain, divided by the sum of squares of the modelled
                             response */
    bool is_measured; /* whether the gains (measured over modelled response) can be trusted; false:
                         a load or a motion has disturbed the test pulse, or readings were missing
                       */
} pzs_pulse_response;

/*
 * Course in time of the responses to a test pulse that two electrodes make together, the one
 * suspected of a fault [0] and a healthy one [1]: sums over the ticks of each part of the pulse.
 */
typedef struct pzs_pulse_course {
    /*
     * scalar products over the sensors of two responses (1/V): modelled response per volt, without
     * its part in the shape of the first vibration mode, and change of the readings since the first
     * tick of the pulse (shown), or the part of it that the model expects of all other electrodes
     * (others). A response is a change of the readings times their scale factors
     */
    pzs_real shown[2][PZS_PULSE_PARTS], others[2][PZS_PULSE_PARTS];
    pzs_real given[2][PZS_PULSE_PARTS]; /* change of the voltage of the electrode since the first
                                           tick of the pulse (V) */
} pzs_pulse_course;

typedef struct pzs_pulse_detector_state {
    struct pzs_control *control;
    const struct pzs_compensator *compensator; /* memory of the compensation of hysteresis; NULL:
                                                  the loop does not compensate hysteresis */
    const struct pzs_selftest_tables *tables;
    const pzs_real *direct; /* [sensors][inputs] static reading of each sensor per volt on each
                               input (unit of each sensor / V) */
    const pzs_real *mode; /* [sensors] entries at intervals of mode_step: reading of each sensor per
                             coordinate of the first vibration mode (unit of the sensor per m);
                             NULL: not known */
    size_t mode_step;     /* distance of two entries of `mode` */
    /*
     * L D L^T factors of D'S^2 D + ridge (1/V2), with which the fault detector estimates by least
     * squares the voltage error of each electrode (voltage that the readings show minus the given
     * one). D [sensors][inputs]: static readings per volt; S: scales of the sensors
     */
    pzs_envelope columns;
    /*
     * [inputs] squared norm of the scaled static readings per volt on each input (1/V2): diagonal
     * of D'S^2 D, with the static readings D per volt and the scales S of the sensors
     */
    pzs_real *diagonal;
    pzs_real *first_voltage; /* [inputs] voltages in the first tick of the present window (interval
                                in which readings are averaged) or test pulse; after a window its
                                mean voltages (V) */
    /*
     * [inputs] weighted sum over the ticks of each voltage minus its value in the first tick (V).
     * In a window (an interval in which readings are averaged) the weights add up to 1, so that it
     * is a mean deviation. In a test pulse the weights are symmetric in time about its middle
     */
    pzs_real *voltage;
    /*
     * [inputs] second weighted sum of voltage deviations (V). In a test pulse the weights are
     * antisymmetric in time about its middle. In a window (an interval in which readings are
     * averaged) it is the sum `voltage` of the next window, which begins half a window later
     */
    pzs_real *late_voltage;
    pzs_real *effect; /* [inputs] equivalent voltages of the last tick (V): the voltages that would
                         move the structure as far without hysteresis, according to the measured
                         hysteresis model */
    pzs_real *cleared_loss;  /* [inputs] size of the voltage error of each electrode when the fault
                                detector last suspected it (V): absolute difference between the
                                voltage given to the electrode and the voltage that the readings
                                showed */
    pzs_real *base_voltage;  /* [inputs] base voltages: mean voltages of an interval in which the
                                target shape stood still, with which later ones are compared (V) */
    pzs_real *still_voltage; /* [inputs] mean voltages of the last window (interval in which
                                readings are averaged) in which the target shape stood still and no
                                electrode was suspected (V) */
    pzs_real *move; /* [inputs] change of the mean voltages from the base interval, in which the
                       target shape stood still, to the last window (interval in which readings are
                       averaged) (V); while a test pulse is evaluated, work array */
    pzs_real *loss; /* [inputs] voltage error of each electrode since an interval in which the
                       target shape stood still (V): change that the averaged readings show, minus
                       the change that the amplifier was given */
    /*
     * [inputs] part of the true voltage changes `move` that the sensors can resolve (V): resolution
     * matrix of the estimate times `move`
     */
    pzs_real *resolved;
    /*
     * [inputs] scalar products over the sensors (1/V2) of the scaled modelled response per volt of
     * each electrode with that of the suspected electrode [0], and of the reference electrode [1].
     * From the first test pulse on their part in the shape of the first vibration mode is left out
     */
    pzs_real *product[2];
    pzs_real *vibrating; /* [inputs] part of the modelled response of each electrode in the shape of
                            the first vibration mode that is left out, as a coordinate of this mode
                            per volt (m/V) */
    pzs_real mode_square; /* squared norm of the scaled readings per coordinate of the first
                             vibration mode (1/m2), times 1 + PZS_PULSE_MODE_WEIGHT (pulse_fit.h) */
    /*
     * [inputs] resolution of each electrode by the sensors (0 to 1): part of a missing voltage that
     * the least-squares estimate finds at the electrode itself, if no other electrode lacks a
     * voltage. The estimate spreads the rest over other electrodes
     */
    pzs_real *resolution;
    pzs_real *last_reading; /* [sensors] last usable reading of each sensor (unit of each sensor) */
    pzs_real *first_reading; /* [sensors] readings in the first tick of the present window (interval
                                in which readings are averaged) or test pulse; after a window its
                                mean readings (unit of each sensor) */
    /*
     * [sensors] weighted sum over the ticks of each reading minus its value in the first tick (unit
     * of each sensor). In a window (an interval in which readings are averaged) the weights add up
     * to 1, so that it is a mean deviation. In a test pulse the weights are symmetric in time about
     * its middle
     */
    pzs_real *reading;
    pzs_real *late_reading; /* [sensors] second weighted sum of deviations of the readings, with the
                               weights of late_voltage (unit of each sensor) */
    pzs_real *base_reading; /* [sensors] base readings: mean readings of an interval in which the
                               target shape stood still, with which later ones are compared (unit of
                               each sensor) */
    pzs_real *difference; /* [sensors] change of the readings, since an interval in which the target
                             shape stood still, that the voltages do not explain (unit of each
                             sensor); while a test pulse is evaluated, work array */
    pzs_real *wanted;   /* [outputs] target shape of the last tick in which the target moved (m) */
    uint8_t *electrode; /* [inputs] state of each electrode, a value of pzs_electrode_state */
    uint8_t *fault;     /* [inputs] fault of each electrode, a value of pzs_electrode_fault */
    uint8_t *pause; /* [inputs] number of further windows (intervals in which readings are averaged)
                       during which an electrode that has passed its test is not suspected; larger
                       numbers repeat the state of one that is tested or unobservable */
    uint8_t *is_missing; /* [sensors] bits: 1: a reading was missing in the present half window or
                            test pulse; 2: in the half window before. Readings are averaged over
                            windows; the second half of one is the first half of the next */
    pzs_real ridge; /* regularisation weight (1/V2) when the fault detector estimates the voltage
                       errors of all electrodes by least squares. The voltage error of an
                       electrode is the voltage that the readings show minus the one that its
                       amplifier gave */
    pzs_real share_factor; /* factor, at least 1, by which the fault detector raises a threshold
                              where the sensors are few (dimensionless). The threshold is the part
                              of the change of the readings that the fault of an electrode must
                              explain to make the electrode suspected */
    pzs_real least_energy; /* smallest response of the shape to a full test pulse (m2): sum of the
                              squared weighted changes of the outputs, for the input for which it is
                              smallest */
    pzs_real start[2], set[2]; /* voltages of two electrodes, the one suspected of a fault and the
                                  healthy one with which it is compared: before their test pulses
                                  (start), and in the next tick (set) (V) */
    pzs_real set_copy[2];      /* copy of `set`, because of damaged memory (V) */
    pzs_real height[2]; /* heights of the voltage pulses that test two electrodes: the one suspected
                           of a fault [0] and the healthy one with which it is compared [1] (V) */
    pzs_pulse_fit fit;  /* fit of the readings of the last test pulse */
    pzs_pulse_course course;     /* course in time of the responses to the last test pulse */
    pzs_pulse_response response; /* result of the last test pulse */
    /*
     * Numbers that distinguish a dead from a stuck electrode, for each candidate, and last for the
     * electrode with which the first one is compared (V): mean voltage of the interval in which it
     * was suspected; its change from an interval in which the target shape stood still; and voltage
     * error, the voltage that the readings showed minus the one given
     */
    pzs_real mean_voltage[PZS_PULSE_CANDIDATES + 1u];
    pzs_real mean_move[PZS_PULSE_CANDIDATES + 1u], mean_loss[PZS_PULSE_CANDIDATES + 1u];
    pzs_real common; /* part of every voltage change that seems to be missing because the gain of
                        the structure differs from the model (dimensionless) */
    pzs_real rest; /* part of the change of the readings that no voltage errors explain, in the last
                      comparison with an interval in which the target shape stood still (V2) */
    uint32_t position; /* number of ticks since the fault detector began its present half window
                          (readings are averaged over windows), pause or test pulse */
    uint32_t still;    /* number of ticks since the target shape last changed */
    uint32_t sum;      /* checksum of what the fault detector has derived from its tables */
    uint16_t suspect, reference; /* inputs of the electrodes under test: the one suspected of a
                                    fault, and the healthy one with which it is compared; 0xFFFF:
                                    none */
    uint16_t candidate[PZS_PULSE_CANDIDATES]; /* inputs that are tested one after the other, or two
                                                 together, the most likely faulty one first; 0xFFFF:
                                                 none */
    uint8_t phase; /* present activity of the fault detector, such as averaging readings or making
                      test pulses */
    uint8_t tries; /* number of unsuccessful test pulses in the test of a suspected electrode: those
                      that were disturbed, and those to which the electrode taken as healthy did not
                      respond */
    uint8_t silent;  /* number of test pulses in a row to which the electrode suspected of a fault
                        has not responded */
    bool is_grown;   /* whether the fault detector makes test pulses higher than usual, because
                        neither electrode under test responded to pulses of the usual height */
    bool is_moving;  /* whether the target shape has changed in the present half window; readings
                        are averaged over windows */
    bool has_half;   /* whether the first half of the present window has been averaged */
    bool half_moved; /* whether the target shape changed in the first half of the present window */
    bool was_moving; /* whether the target shape changed in the window whose means are compared */
    bool has_base, has_taken; /* has_base: whether there was an interval in which the target shape
                                 stood still, with which later readings are compared; has_taken:
                                 whether the fault detector, and not the controller, sets the
                                 voltages of the two electrodes under test */
} pzs_pulse_detector_state;

/* Largest age of measured shapes or readings that a control loop accepts (ticks). */
#define PZS_DELAY_LIMIT 16

typedef struct pzs_estimate_state {
    struct pzs_control *control;
    const struct pzs_estimator *tables;
    pzs_real *expected;   /* [sensors] readings that the model expects under the present voltages
                             (unit of each sensor) */
    pzs_real *sensed;     /* [sensors] readings of the last tick (unit of each sensor) */
    pzs_real *difference; /* [sensors] reading minus the reading that the model expects (unit of
                             each sensor) */
    uint8_t *repeats; /* [sensors] number of ticks in which a reading stayed constant although it
                         should have moved, plus 128 while it is missing */
    uint8_t stage;
} pzs_estimate_state;

typedef struct pzs_damper_state {
    struct pzs_control *control;
    const struct pzs_vibration *tables;
    /*
     * [2][4][width >= modes] what the damper keeps of the vibration modes from tick to tick, twice
     * against damaged memory: their estimated state at the time of the readings (modal position,
     * modal velocity divided by angular frequency, static modal position under the loads), then
     * `residual_modes` (m)
     */
    pzs_real *late;
    pzs_real *now; /* [3][width >= modes] estimated state of the vibration modes at the present
                      tick: modal position, modal velocity divided by angular frequency, and static
                      modal position under the loads (m) */
    pzs_real *velocity_before; /* [width >= modes] velocity of each vibration mode divided by its
                                  angular frequency, at the last tick (m) */
    pzs_real *residual_modes; /* [width >= modes] low-passed coordinates of the vibration modes that
                                 fit the innovations, which are readings minus predicted readings
                                 (m); part of `late` */
    pzs_real *work;        /* [2][width >= modes] work array for two vectors with an entry for each
                              vibration mode */
    pzs_real *equilibrium; /* [delay + 1][width >= modes] ring buffer: static position of each
                              vibration mode under the voltages of the last delay + 1 ticks (delay:
                              age of the readings in ticks) (m) */
    pzs_real *expected;  /* [delay + 1][sensors] ring buffer: static readings of the structure under
                            the voltages of the last delay + 1 ticks (delay: age of the readings in
                            ticks) (unit of each sensor) */
    pzs_real *predicted; /* [sensors] readings predicted from the voltages and the vibration modes
                            (unit of each sensor) */
    pzs_real *innovation; /* [sensors] reading minus predicted reading (unit of each sensor) */
    pzs_real *sensed;     /* [sensors] readings of the last tick (unit of each sensor) */
    pzs_real *residual; /* [sensors] low-passed innovation: reading minus predicted reading (unit of
                           each sensor) */
    /*
     * bound of the norm of `residual` (unit of the sensors), which only damaged memory exceeds: the
     * norms of the innovations, low-passed like the innovations themselves
     */
    pzs_real residual_most;
    /* norm of the innovations of this tick (unit of the sensors) */
    pzs_real innovation_norm;
    /*
     * [inputs] damping gradient: term that a tick which damps vibration subtracts from half the
     * gradient of its objective, so that the voltages take energy out of the vibration (m2/V)
     */
    pzs_real *damping;
    pzs_real *carry; /* [inputs] parts of earlier voltage changes that the amplifiers have not yet
                        made (V) */
    /*
     * [2][FOURS(modes) + FOURS(sensors)] where the amplifiers lag: static position of each
     * vibration mode (m), then static reading of each sensor, under the present output voltages of
     * the amplifiers; twice, against damaged memory. NULL: the amplifiers do not lag
     */
    pzs_real *output;
    pzs_real *behind; /* [width >= modes] where the amplifiers lag: static position of each
                         vibration mode under their output voltages at the last tick, minus that
                         under the voltages commanded then (m) */
    uint8_t *repeats; /* [sensors] number of ticks in which a reading stayed constant although it
                         should have moved, plus 128 while it is missing */
    uint16_t newest; /* index of the row for the present voltages in two ring buffers with a row for
                        each tick: `equilibrium` (static positions of the vibration modes) and
                        `expected` (static readings of the sensors) */
    uint8_t stage;
    uint32_t row_sum[PZS_DELAY_LIMIT + 1]; /* exclusive or of the words in each row of the ring
                                              buffers, in a loop whose readings are late */
    uint32_t late_sum;   /* exclusive or of the words of the first copy in `late` */
    uint32_t output_sum; /* exclusive or of the words of the first copy in `output` */
} pzs_damper_state;

typedef struct pzs_compensator_state {
    const struct pzs_hysteresis *tables;
    pzs_real *effect;  /* [inputs] effects of the voltages of the last tick: the voltages that
                          electrodes without hysteresis would need for the same displacement (V) */
    pzs_real *lower;   /* [inputs] lowest voltage that the voltage limits and step limits allow in
                          this tick (V) */
    pzs_real *upper;   /* [inputs] highest voltage that the voltage limits and step limits allow in
                          this tick (V) */
    pzs_real *present; /* [inputs] effects that the voltages of the last tick have in this tick,
                          after the creep since then: the voltages that electrodes without
                          hysteresis would need for the same displacement (V) */
    pzs_real *play;  /* [inputs][plays] positions of the plays (elements with backlash, which model
                        the hysteresis), relative to the middle of the voltage range (V) */
    pzs_real *creep; /* [inputs][creeps] present values of the creep terms of the hysteresis model:
                        the voltages by which creep changes the effect of each electrode (voltage
                        that an electrode without hysteresis would need) (V) */
} pzs_compensator_state;

typedef struct pzs_reading_delay_state {
    const struct pzs_reading_delay *tables;
    struct pzs_control *control;
    pzs_real *voltage;    /* [delay + 1][inputs] ring buffer with the voltages of the last delay + 1
                             ticks (delay: age of the readings in ticks) (V) */
    pzs_real *expected;   /* [delay + 1][sensors] ring buffer with the readings that the model
                             predicts for the voltages of the last delay + 1 ticks (delay: age of
                             the readings in ticks) (unit of each sensor) */
    pzs_real *sensed;     /* [sensors] readings of the last tick (unit of each sensor) */
    pzs_real *difference; /* [sensors] reading minus the reading that the model expected when the
                             reading was taken (unit of each sensor) */
    pzs_real *corrected;  /* [sensors] corrected readings: late readings plus the changes that the
                             model predicts since they were taken (unit of each sensor) */
    uint8_t *repeats; /* [sensors] number of ticks in which a reading stayed constant although it
                         should have moved, plus 128 while it is missing */
    uint16_t newest;  /* index of the row for the present tick in two ring buffers with a row for
                         each tick: `voltage` (voltages) and `expected` (readings that the model
                         predicts) */
} pzs_reading_delay_state;

/*
 * State of a reading in the sensor gate. Values above PZS_READING_MISSING: the gate has taken the
 * reading away.
 */
typedef enum pzs_reading_state {
    PZS_READING_USED = 0,    /* a reading that the next blocks get */
    PZS_READING_MISSING,     /* a reading that has not arrived (NaN or infinity) */
    PZS_READING_RANGE,       /* a reading beyond its range */
    PZS_READING_CONTRADICTED /* a reading that contradicts the others, or did so less than
                                pzs_sensor_gate.patience ticks ago */
} pzs_reading_state;

/* Results of the sensor gate that a program may read. */
typedef struct pzs_sensor_gate_info {
    const uint8_t *reading; /* [sensors] state of each reading in the last tick with readings, a
                               value of pzs_reading_state */
    uint16_t count;      /* number of readings that the sensor gate has taken away in this tick */
    bool is_unexplained; /* whether readings contradict each other so that no few wrong sensors
                            explain it: a load that the tables do not know, or more wrong
                            sensors than the sensor gate can find */
} pzs_sensor_gate_info;

#define PZS_SENSOR_GATE_LIMIT 8u /* largest value of pzs_sensor_gate.most */

/* Memory of the sensor gate, the stage of the control tick that takes wrong readings away. */
typedef struct pzs_sensor_gate_state {
    pzs_sensor_gate_info info;
    const struct pzs_sensor_gate *tables;
    pzs_real *gated;   /* [sensors] readings; NaN for those that are missing or gated (unit of each
                          sensor) */
    pzs_real *match;   /* [sensors] scalar product of each row of the parity table with `parity` */
    pzs_real *parity;  /* [relations] values of the parity relations, without what errors of the
                          excluded sensors explain */
    pzs_real *column;  /* [most][relations] orthonormal rows of the parity table of the excluded
                          sensors */
    pzs_real *factor;  /* [most][most] coefficients of the rows of these sensors in `column` */
    uint8_t *reading;  /* [sensors] state of each reading, a value of pzs_reading_state */
    uint16_t suspects; /* number of sensors that are gated, or suspected to be wrong */
    uint16_t suspect[PZS_SENSOR_GATE_LIMIT];  /* these sensors, the gated ones first */
    uint16_t distrust[PZS_SENSOR_GATE_LIMIT]; /* number of ticks in which each of them must still
                             agree with the others; 0: it is only suspected, and its reading is used
                           */
} pzs_sensor_gate_state;

typedef struct pzs_modal_gains_state {
    pzs_step_filter filter; /* function that changes the gradient of the control step, so that each
                               mode goes only a part (gain) of its way and loses a part (leak) of
                               its coordinate; set in each tick, because memory may be damaged */
    const struct pzs_modal_gains *tables;
    pzs_real *gradient; /* [inputs] work array (m2/V): first half the gradient of the objective with
                           its sign changed, before gains act on it; then the correction of this
                           gradient in the modes */
    pzs_real *deviation; /* [inputs] present voltages minus reference voltages (V), of which each
                            tick removes a part, the leak; padded with zeros; 0 for an input whose
                            voltage is fixed */
    pzs_real *product;   /* [inputs] product of the Hessian of the optimisation with `deviation`
                            (m2/V) */
    pzs_real *step; /* [modes] wanted change of the coordinate of each mode in this tick (m), minus
                       the change that the gain and the leak of the voltages which belong to no mode
                       would give it */
    pzs_real *coordinate; /* [modes] present coordinate of each mode (m), 0 at the reference
                             voltages */
} pzs_modal_gains_state;

/*
 * Memory of the block that removes from shapes their components along the free functions, shapes
 * that may be added to the target at no cost.
 */
typedef struct pzs_free_functions_state {
    const struct pzs_free_functions *tables;
    pzs_real *coordinate; /* [count] component (m) of a shape along each free function, a shape that
                             may be added to the target at no cost */
    pzs_real *shape;      /* [PZS_FREE_SHAPES][outputs] shapes (m) whose components along the free
                             functions (shapes that may be added to the target at no cost) have been
                             removed */
} pzs_free_functions_state;

typedef struct pzs_feed_forward_state {
    const struct pzs_known_loads *tables;
    pzs_real *readings; /* [sensors] sensor readings minus the effect of known loads on the sensors
                           (unit of each sensor) */
    pzs_real *wanted; /* [outputs] target shape minus the effect of known loads on the shape (m) */
} pzs_feed_forward_state;

/*
 * Variables on which the supervisor bases its decisions; it decides in each tick whether the loop
 * controls the voltages. All are 32-bit words without padding, because three copies of the struct
 * are compared word by word.
 */
typedef struct pzs_supervisor_core {
    uint32_t mode;   /* present operating mode of the supervisor, a value of pzs_supervisor_mode */
    uint32_t obeyed; /* last command of the program that the supervisor has carried out: 256 times a
                        command counter plus the command */
    uint32_t is_flat; /* target of the ramps on which the supervisor moves the voltages in steps: 1:
                         reference voltages of the optimisation (pzs_problem); 0: park voltages
                         (safe voltages in the supervisor's tables) */
    uint32_t remaining; /* number of ticks that the supervisor still needs to move the voltages in
                           steps (a ramp) to their target; 0: it does not move them */
    uint32_t silent;    /* number of consecutive ticks without usable readings */
    /*
     * counter of implausible shapes, which leads to an alarm: a tick with an implausible measured
     * shape raises it by one, or by up to 4 if the structure moves against its prediction; any
     * other tick lowers it by two
     */
    uint32_t over;
    /*
     * event, a value of pzs_supervisor_event, for which the supervisor (safety monitor of the loop)
     * has replaced the voltages of the controller by its own; 0: none
     */
    uint32_t cause;
    /*
     * Polarity test, in which the supervisor moves the voltages to the park voltages and back to
     * find out whether amplifiers have the wrong polarity: number of ramps begun, number of ticks
     * since the last one has ended, and length of a whole ramp (ticks)
     */
    uint32_t test_ramp, test_tick, test_length;
} pzs_supervisor_core;

/*
 * State of the polarity monitor, with which the supervisor of a loop that damps vibration detects a
 * structure that moves against its prediction.
 */
typedef struct pzs_polarity_state {
    pzs_real *direction; /* [outputs] last jump of the target shape (m) */
    pzs_real least; /* smallest change of a scalar product (jump `direction` times shape) from which
                       the monitor judges in which direction the structure moves (m2) */
    pzs_real most_idle; /* largest absolute change of the scalar product of the jump `direction`
                           with the predicted shape at which hysteresis may keep the structure from
                           moving (m2) */
    pzs_real before[2]; /* scalar products of the jump of the target (`direction`) with the
                           predicted shape [0] and with the measured shape [1], both at the time of
                           the jump (m2) */
    pzs_real now[2];    /* present scalar products of the target's last jump (`direction`) with the
                           predicted shape [0] and the measured shape [1] (m2); one tick updates
                           the first product, the next tick the second, and so on */
    uint32_t remaining; /* number of further ticks in which the polarity monitor judges the motion
                           after the last jump of the target (it detects motion against the
                           prediction); the first two ticks after a jump only compute the two
                           products in `before` */
    uint32_t first; /* start value of `remaining`: number of ticks in which the motion after a jump
                       of the target is judged */
} pzs_polarity_state;

/*
 * State of the stuck monitor, with which the supervisor of a loop that damps vibration detects that
 * all readings repeat although the structure should move.
 */
typedef struct pzs_stuck_state {
    pzs_real *reference; /* [outputs] predicted shape when the last reading changed (m) */
    uint32_t repeats; /* number of successive ticks in which all readings have repeated. It counts
                         up while `reference` is stored, a part in each tick; after that it only
                         tells which part the tick compares */
    uint32_t moved; /* number of ticks, since the last reading changed, in which the predicted shape
                       differed from `reference` by more than repeated readings allow */
} pzs_stuck_state;

/* Counter with its bitwise complement, by which a flipped bit of either is noticed. */
typedef struct pzs_checked_count {
    uint32_t value;
    uint32_t complement;
} pzs_checked_count;

/*
 * State of the polarity test, with which the supervisor of the loop finds out whether a shape that
 * is opposite to the prediction is the effect of amplifiers of the wrong polarity or of a load.
 */
typedef struct pzs_polarity_test_state {
    pzs_real before[2]; /* scalar products of the predicted shape at the start of the test with the
                           predicted shape [0] and with the mean measured shape [1], before the last
                           ramp of the voltages (m2) */
    pzs_real now[2];    /* the same products after the last ramp (m2); the one with the measured
                           shape is the sum of the ticks so far */
    pzs_real answer; /* motion of the structure after the last ramp of the voltages, relative to the
                        predicted one */
    pzs_real square; /* square of the norm of the predicted shape at the start of the test (m2) */
    pzs_real tolerated; /* amplitude of vibration (m) that is tolerated besides the threshold,
                           because the last test has excited it; decays with time */
    uint32_t turn;      /* counter of ticks, which tells in which of them shapes are compared */
    pzs_checked_count opposed; /* counter of ticks in which the shape is opposite to the prediction;
                                  others lower it by two */
    pzs_checked_count rest;    /* number of ticks until the next test may begin */
    uint32_t confirmed; /* number of successive ramps with the same answer as the ramp before */
    uint32_t tests;     /* number of tests in which the structure answered as predicted */
} pzs_polarity_test_state;

/* Largest number of vibration modes whose motion the gain monitor compares. */
#define PZS_GAIN_MODES 4u

/* Estimated state of the vibration modes that the gain monitor compares. */
typedef struct pzs_gain_filter {
    pzs_real position[PZS_GAIN_MODES]; /* modal coordinates (m) */
    pzs_real velocity[PZS_GAIN_MODES]; /* modal velocities divided by angular frequencies (m) */
    pzs_real load[PZS_GAIN_MODES];     /* static modal coordinates under loads (m) */
} pzs_gain_filter;

/*
 * State of the gain monitor, with which the supervisor of a loop that damps vibration estimates how
 * strongly, and with which sign, the structure follows the voltages.
 */
typedef struct pzs_gain_state {
    pzs_gain_filter measured;  /* observer of the measured motion that knows no voltages */
    pzs_gain_filter predicted; /* state of such an observer of the model's motion, less that motion
                                */
    pzs_real moved;   /* decaying sum of squares of the model's motion, as the observer filters it
                         (m2) */
    pzs_real product; /* decaying sum of products of the model's motion with the deviation from it,
                         both filtered (m2) */
    pzs_real deviation; /* decaying sum of squares of the filtered deviation (m2) */
    /*
     * corrections of position, velocity and load of each mode per prediction error of its observer;
     * each tick computes those of one mode again, so that damaged ones do not last
     */
    pzs_real correction[PZS_GAIN_MODES][3];
    uint32_t turn;     /* counter of ticks, which tells whose corrections the next one computes */
    uint32_t reversed; /* counter of ticks in which the gain is that of amplifiers of the wrong
                          polarity; others lower it by two */
} pzs_gain_state;

/*
 * State of the divergence monitor, with which the supervisor of the loop detects a measured shape
 * that the model cannot explain.
 */
typedef struct pzs_monitor_state {
    pzs_real *slow; /* [outputs] low-pass filtered difference between measured and predicted shape
                       (m) */
    pzs_real *disturbance; /* [outputs] measured minus predicted shape of the last tick (m) */
    pzs_real *predicted;   /* [outputs] predicted shape of the last tick (m) */
    pzs_real *move;        /* [outputs] change of the predicted shape in the last tick (m) */
    pzs_real *wanted;      /* [outputs] target shape of the last tick (m) */
    pzs_real amplitude;    /* largest recent deviation (measured minus predicted shape): each tick
                              multiplies it by a factor below 1, or replaces it by the deviation of
                              this tick if that is larger (m) */
    pzs_real envelope;     /* deviation (measured minus predicted shape) that recent changes of the
                              target explain; decays with time (m) */
    pzs_real moved; /* exponentially decaying sum of the squared predicted changes of the shape in
                       the last ticks (m2), to which `answered` is compared */
    pzs_real answered; /* exponentially decaying sum of predicted times measured change of the shape
                          in the last ticks (m2); divided by `moved`, the decaying sum of the
                          squared predicted changes, it tells how well the structure follows its
                          model */
    /*
     * number by which the divergence monitor notices that voltages were fixed or released, or that
     * a test signal began or ended, so that the predicted shape may have jumped: 2 * (number of
     * inputs with equal lower and upper limit in the last tick), plus 1 during a test signal
     */
    uint32_t fixed;
    pzs_real earlier; /* largest amplitude of vibration in the half period of the first vibration
                         mode before the present one (m), in a loop with a vibration damper */
    pzs_real later; /* largest amplitude of vibration so far in the present half period of the first
                       vibration mode (m), in a loop with a vibration damper */
    uint32_t vibrating; /* counter of ticks in which the amplitude of vibration is above the
                           threshold: each other tick lowers it by two, and a half period in which
                           the vibration has fallen sets it to the number of ticks of a half period
                         */
    pzs_polarity_state polarity;
    pzs_polarity_test_state test;
    pzs_stuck_state stuck;
    pzs_gain_state gain;
    bool is_opposed; /* whether the structure has moved opposite to the predicted direction, by more
                        than loads and noise explain, as with reversed amplifiers */
    bool is_stuck;   /* whether the last tick found all readings stuck */
    bool is_first;   /* whether the last tick was the first one of a loop with a vibration damper */
    bool is_started;
} pzs_monitor_state;

typedef struct pzs_supervisor_state {
    pzs_supervisor_core core[3]; /* three copies of the variables on which the supervisor bases its
                                    decisions, so that two outvote a damaged third */
    /*
     * Three copies of the last command to the supervisor, which is 256 times a command counter plus
     * the command. Only the program writes them, through pzs_supervisor_give.
     */
    volatile uint32_t command[3];
    const struct pzs_supervision *tables;
    const struct pzs_problem *problem;
    pzs_monitor_state monitor;
} pzs_supervisor_state;

typedef struct pzs_amplifier_state {
    const struct pzs_amplifier *tables;
    pzs_real *given; /* [inputs] voltages that the amplifiers really give, after converter steps and
                        dead band (V) */
} pzs_amplifier_state;

/*
 * Progress of a self-test, which tests amplifiers, electrodes, cables and sensors by test pulses.
 * All members are 32-bit words without padding, because three copies of the struct are compared
 * word by word.
 */
typedef struct pzs_selftest_core {
    uint32_t position;  /* number of ticks of the self-test so far */
    uint32_t verdict;   /* result of the self-test, a value of pzs_selftest_verdict */
    uint32_t disturbed; /* 1: noise or vibration hides the response of at least one amplifier to its
                           test pulse */
    /*
     * number of the present stage, from 0, of the self-test's evaluation, which compares measured
     * with modelled responses of the sensors to the amplifiers
     */
    uint32_t stage;
    uint32_t step; /* number of comparisons that the self-test has made so far in the present stage
                      of its evaluation, which compares measured with modelled responses of the
                      sensors to the amplifiers */
    /*
     * number of the amplifier or sensor of which the self-test checks whether its cable is
     * exchanged with that of another one. Amplifiers and sensors are numbered in one list, in which
     * the sensors come first if there are fewer of them
     */
    uint32_t pair;
    uint32_t nearest;  /* index of the amplifier (or sensor) whose modelled response is nearest,
                          among those compared so far, to the measured response that the self-test
                          examines */
    uint32_t searches; /* number of faults that the self-test has found by searching for the
                          amplifier or sensor whose measured response differs most from the model */
} pzs_selftest_core;

/*
 * Sums with which the self-test compares a measured and a modelled response: of all sensors to one
 * amplifier, or of one sensor to all amplifiers. A response is the change of a reading per volt of
 * a test pulse, times the scale factor of the sensor (1/V).
 */
typedef struct pzs_selftest_sums {
    pzs_real product; /* scalar product of measured and modelled response (1/V2). Both are vectors:
                         the response of all sensors to one amplifier, or of one sensor to all
                         amplifiers, as change of a reading per volt, times the scale factor of its
                         sensor (1/V) */
    /*
     * sum over the entries of |measured response * modelled response| (1/V2), from which the gain
     * is computed. The responses are vectors: the scaled change of a reading per volt (1/V) of all
     * sensors to one amplifier, or of one sensor to all amplifiers
     */
    pzs_real size;
    pzs_real measured; /* squared norm of the vector of measured responses (1/V2). The vector
                          holds the responses of all sensors to one amplifier, or of one sensor
                          to all amplifiers. A response is the change of the reading per volt,
                          times the scale factor of the sensor (1/V) */
    pzs_real modelled; /* squared norm of the vector of modelled responses (1/V2). The vector
                          holds the responses of all sensors to one amplifier, or of one sensor
                          to all amplifiers. A response is the change of the reading per volt,
                          times the scale factor of the sensor (1/V) */
    pzs_real noise; /* part that noise and vibration are expected to contribute to the squared norm
                       of the measured response (1/V2); a response is the change of a reading per
                       volt, times the scale factor of its sensor (1/V) */
} pzs_selftest_sums;

typedef struct pzs_selftest_state {
    pzs_selftest_core core[3]; /* progress of the self-test in three copies, so that two outvote a
                                  copy in damaged memory */
    const struct pzs_selftest_tables *tables;
    struct pzs_control *control;
    const pzs_real *direct; /* [sensors][inputs] static reading of each sensor per volt on each
                               input (unit of each sensor / V) */
    struct pzs_wiring *amplifier; /* [inputs] finding of the self-test about each amplifier */
    struct pzs_wiring *sensor;    /* [sensors] finding of the self-test about each sensor */
    pzs_real *response; /* [inputs][sensors] measured response of each sensor to the test pulse of
                           each amplifier: change of the reading per volt, times the factor that
                           makes sensors of different units comparable (1/V) */
    pzs_real *first; /* [sensors] first finite reading of each sensor in the self-test (unit of each
                        sensor) */
    pzs_real *last;  /* [sensors] last finite reading of each sensor in the self-test; NaN: there is
                        none yet (unit of each sensor) */
    pzs_real *change; /* [sensors] change of the reading of each sensor in the last tick (unit of
                         each sensor) */
    pzs_real *noise;  /* [sensors] sum of the squared second differences of the readings of each
                         sensor; after the measurement the variance of its noise (squared unit of
                         each sensor) */
    pzs_real *even;   /* [sensors] weighted sum of the readings of each sensor over the ticks of the
                         present test pulse (unit of each sensor); the weights are symmetric in time
                         about the middle of the pulse */
    pzs_real *odd;    /* [sensors] weighted sum of the readings of each sensor over the ticks of the
                         present test pulse (unit of each sensor); the weights are antisymmetric in
                         time about the middle of the pulse, so that the sum measures noise and
                         vibration */
    pzs_real *null;   /* [sensors] largest squared response that noise and vibration cause in each
                         sensor, measured in intervals as long as a test pulse while no amplifier
                         moves (squared unit of each sensor) */
    pzs_real *start;  /* [inputs] voltages before the self-test, to which each amplifier returns
                         after its test pulse (V) */
    /*
     * largest deviation from the model found so far (1/V2): [0] of an amplifier, [1] of a sensor:
     *   |measured response - mean gain of all amplifiers * modelled response|^2 - noise
     *   noise  part that noise and vibration are expected to contribute
     * The response of an amplifier has an entry for each sensor, that of a sensor for each
     * amplifier (scaled readings per volt, 1/V)
     */
    pzs_real difference[2];
    /*
     * squared sine of the smallest angle found so far between the modelled response of the
     * amplifier (or sensor) under examination and the modelled response of another one, both taken
     * as vectors (dimensionless). The start value is the angle below which the self-test would not
     * notice exchanged cables
     */
    pzs_real least_angle;
    pzs_selftest_sums own, nearest; /* comparisons of the measured response of the amplifier (or
                                       sensor) under evaluation: with the modelled response of the
                                       same one (own), and with the nearest modelled response of all
                                       found so far (nearest) */
    /*
     * two comparisons for another amplifier (or sensor), the partner, whose cable may be exchanged
     * with that of the one under evaluation: the measured response of the partner is compared with
     * its own modelled response (partner_own), and with the modelled response of the one under
     * evaluation (partner_nearest)
     */
    pzs_selftest_sums partner_own, partner_nearest;
    uint16_t worst[2]; /* index of the amplifier [0] and of the sensor [1] whose response differs
                          most from the model; PZS_WIRING_NONE: none differs */
    pzs_real pulse; /* weighted sum of the voltage of a test pulse divided by its height, over the
                       ticks of the pulse so far (dimensionless); the weights are symmetric in time
                       about the middle of the pulse */
} pzs_selftest_state;

typedef struct pzs_calibration_state {
    const struct pzs_problem *problem;
    const pzs_real *influence; /* [outputs][inputs] influence matrix from which a calibration takes
                                  the columns that its records do not determine (m/V) */
    /*
     * [inputs + 1][inputs + outputs] least-squares problem of a calibration; plane rotations of its
     * rows add a record. First `inputs` columns (V): triangular factor R, where R'R is the sum of v
     * v' over the recorded voltages v. Other columns (m): the recorded readings after the same
     * rotations. Last row: the record that is being added
     */
    pzs_real *factor;
    /*
     * [inputs] work vector of a calibration with two uses. While a record is added: product of the
     * triangular factor R and the voltages of the record (V2), where R'R is the sum of v v' over
     * the recorded voltages v. While the test voltages move: the test voltages of the last tick (V)
     */
    pzs_real *direction;
    pzs_real *noise;    /* [outputs] variance of the noise of each output's readings (m2) */
    pzs_real *centre;   /* [inputs] voltages around which the test voltages of a calibration lie (V)
                         */
    pzs_real *proposal; /* [inputs] test voltages that a calibration has chosen for the present
                           tick, before they are clamped to all limits (V). While the influence
                           matrix is computed: reciprocals of the diagonal entries of the
                           triangular factor in the array `factor` (1/V) */
    pzs_real *free;  /* [inputs] array filled with NaN, which a calibration hands to pzs_output_gate
                        in the place of the voltages at which pzs_hold keeps inputs. NaN means that
                        no voltage is fixed */
    pzs_real *least; /* [inputs] size below which a diagonal entry of the triangular factor
                        (`factor`) of a calibration counts as zero (V) */
    pzs_real *last[3];  /* [inputs] three copies of the test voltages of a calibration, so that two
                           outvote a damaged third (V) */
    uint32_t limit_sum; /* checksum of the voltage limits and the step limits of a calibration */
    uint32_t pattern;   /* number of the present test pattern of a calibration, from 0 */
    uint32_t rest; /* number of consecutive ticks in which the test voltages of a calibration have
                      been constant */
    uint32_t surplus; /* number of records of a calibration in excess of those that are needed to
                         determine the influence matrix */
    uint8_t stage;
} pzs_calibration_state;

/*
 * Pointers and sizes from which a tick of the control loop finds its blocks (stages of the tick),
 * arrays and tables; they stay constant from tick to tick.
 */
typedef struct pzs_loop_core {
    const struct pzs_block *blocks; /* [count] list of the blocks of the control loop, which are the
                                       stages of its tick */
    uint8_t *memory; /* start of the workspace of the loop, rounded up to a multiple of 8 bytes */
    struct pzs_control *control;
    void *control_work; /* workspace of the controller, a part of the workspace of the loop */
    const pzs_real *influence;  /* [outputs][inputs] influence matrix of the controller (m/V) */
    const pzs_real *known_now;  /* [loads] values of the known loads at the time of the readings, as
                                   passed to pzs_loop_know, or NULL */
    const pzs_real *known_next; /* [loads] values of the known loads under the next voltages, as
                                   passed to pzs_loop_know, or NULL */
    uint32_t limit_sum; /* checksum of the voltage limits and the step limits in the controller's
                           tables */
    uint32_t influence_crc; /* checksum of the influence matrix, where the device has computed this
                               matrix */
    uint16_t sensors;       /* number of sensor readings in a tick */
    uint8_t count, stage;
} pzs_loop_core;

typedef struct pzs_loop_state {
    pzs_loop_core core[3]; /* three copies of the pointers and sizes of the loop, so that two
                              outvote a damaged third */
    pzs_scrub problem_scrub, influence_scrub;
    /*
     * check of the constant tables of the blocks (stages of the control tick) against their
     * checksums, one slice in each tick; the tables of the optimisation are checked by
     * problem_scrub
     */
    pzs_scrub block_scrub;
    uint16_t scrubbed_block;  /* index, in the list of the blocks (stages) of the control tick, of
                                 the block whose tables are compared with their checksum at present
                               */
    uint16_t scrubbed_number; /* number of the table that is compared with its checksum at present,
                                 among the tables of its block (stage of the control tick) */
    uint32_t missed; /* number of ticks missed since the last tick, as announced by pzs_loop_skip */
    /*
     * one of two words that tell whether a heartbeat waits for pzs_loop_take_heartbeat. They differ
     * in many bits, so that a flipped bit makes no heartbeat. Any other word shows damaged memory
     * and ends the heartbeats.
     */
    volatile uint32_t heartbeat;
} pzs_loop_state;

#endif
