/*
 * Internal state of the controller and its optional blocks. The types are here so that a program
 * can reserve their memory; their members belong to the library and may change in every version.
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

/* Exchanges between free set and active set that are collected before the tableau is updated. */
#define PZS_PENDING PZS_BY_TILE(4u, 32u, 32u)

/* One collected exchange; its vector is in pzs_optimiser.pending. */
typedef struct pzs_exchange {
    uint32_t input;
    pzs_real sign;  /* sign of the diagonal entry on which the tableau is exchanged */
    pzs_real scale; /* 1 / square root of the size of the pivot */
    pzs_real pivot; /* diagonal entry of the input after the exchange */
} pzs_exchange;

/*
 * Active-set method for box-constrained least squares. Vectors are [width], the number of inputs
 * rounded up to whole tiles. The free set holds the inputs that may move; the active set holds
 * those that stay where they are.
 */
typedef struct pzs_optimiser {
    uint32_t inputs, width;
    uint32_t iterations;
    uint64_t work, work_limit; /* multiply-adds of this step, and the most that are allowed */
    pzs_real *hessian;         /* [inputs][width] H (m2/V2) */
    pzs_real *tableau;         /* [inputs][width] H after the exchange of the free set, without the
                                  pending exchanges */
    pzs_real *pivot;           /* diagonal of the tableau with the pending exchanges */
    pzs_real *pending;         /* [PZS_PENDING][width] vectors of the pending exchanges */
    pzs_real *waiting;         /* 1 for inputs that are to join the free set when the tableau is
                                  recomputed */
    pzs_real *voltage;         /* v, voltages (V) */
    pzs_real *lower, *upper;   /* lower and upper bound of the voltages in this step (V) */
    pzs_real *free_set; /* 1 in the free set, 0 in the active set; real numbers, because vector
                           loops multiply by them */
    pzs_real *base;     /* voltages around which the gradient is linearised (V) */
    pzs_real *regularisation_gradient; /* regularisation * (base - reference voltage) (m2/V) */
    pzs_real *target_gradient;         /* B'W^2 (e - B base) (m2/V) */
    pzs_real *model_gradient; /* H (v - base) + regularisation gradient, as predicted after a direct
                                 iteration (m2/V) */
    pzs_real *gradient;       /* model gradient - target gradient (m2/V) */
    pzs_real *direction;      /* free set: search direction (V); active set: gradient after the step
                                 (m2/V) */
    pzs_real *diagonal;       /* diagonal of H (m2/V2) */
    pzs_real *start_voltage;  /* voltages at the start of a round (V) */
    pzs_real *start_gradient; /* gradient at the start of a round (m2/V) */
    pzs_real *next_voltage;   /* voltages after the search direction (V); before it, the gradient of
                                 the free set */
    pzs_real *scratch;        /* work; after the search direction next_voltage - base */
    pzs_real inverse_trace;   /* trace of the inverse of H on the free set (V2/m2), 0 if unknown */
    pzs_real inverse_trace_bound; /* upper bound of inverse_trace that follows from the
                                     regularisation (V2/m2), 0 if unknown */
    pzs_real pivot_floor;     /* a pivot below this part of its diagonal entry counts as linearly
                                 dependent */
    pzs_real model_rounding;  /* rounding-error bound of the model gradient (m2/V) */
    pzs_real start_rounding;  /* model_rounding at the start of a round (m2/V) */
    pzs_real target_rounding; /* rounding-error bound of the target gradient (m2/V) */
    pzs_real target_energy;   /* |W e|^2, the scale of the objective (m2) */
    pzs_real kkt_violation;   /* largest KKT violation among the measured inputs (m2/V) */
    pzs_real rounding_bound;  /* rounding-error bound of kkt_violation (m2/V) */
    uint32_t active_count;    /* number of inputs in the active set */
    uint32_t checked_next;    /* input whose gradient is measured next to verify the tableau */
    uint32_t pending_count;   /* number of pending exchanges */
    uint32_t exchanges;       /* exchanges since the tableau was last computed from H */
    uint32_t rebuilds;        /* recomputations of the tableau that were begun in this step */
    pzs_exchange exchange[PZS_PENDING];
    bool is_rebuilding; /* inputs are waiting: the tableau is not yet complete */
    bool is_predicted;  /* model_gradient was predicted by the tableau, in a round: at its start */
    bool is_cut;        /* the last step stopped at its work limit before the optimum was reached */
    bool is_fresh;      /* no round has ended at the optimum since the last recomputation */
    bool is_verified;   /* the last round with this tableau ended at the optimum */
    bool is_optimal;
} pzs_optimiser;

/*
 * Progress of a scrub: a slice of some tables is read in each tick, and their checksum is compared
 * after each pass over all of them.
 */
typedef struct pzs_scrub {
    uint32_t position; /* byte at which the next slice starts */
    uint32_t crc;      /* checksum of the bytes before it */
    bool has_failed;   /* the last pass had a wrong checksum */
} pzs_scrub;

/* What must be renewed because voltages were changed outside a step. */
typedef enum pzs_control_behind {
    PZS_BEHIND_NOTHING = 0,
    PZS_BEHIND_PREDICTION, /* info.predicted must be renewed */
    PZS_BEHIND_GRADIENT    /* info.predicted and the gradient must be renewed */
} pzs_control_behind;

typedef struct pzs_control_state {
    const struct pzs_problem *problem;
    const pzs_real *influence; /* [outputs][inputs] influence matrix: that of the program, or of the
                                  problem (m/V) */
    pzs_optimiser optimiser;
    pzs_real *lower, *upper; /* [inputs] limits in force (V): those of the table, narrowed by
                                pzs_hold */
    pzs_real *held[3];       /* [inputs] voltage at which an input is held (V), NaN: not held; three
                                copies, of which two outvote a damaged third */
    pzs_real *voltage;       /* [inputs] present voltages (V) */
    pzs_real *predicted;     /* [outputs] predicted shape B v (m) */
    pzs_real *disturbance;   /* [outputs] measured - predicted shape (m) */
    pzs_real *measured;      /* [outputs] last measurements (m) */
    pzs_real *step_limit;    /* [inputs] largest change of a voltage in one step (V) */
    pzs_real *weighted;      /* [2][outputs] weighted error W^2 (e - B base), and the expected
                                measurements (m) */
    uint8_t *repeats; /* [outputs] ticks in which a measurement repeated although it should have
                         moved */
    const pzs_real *damping; /* [inputs] damping gradient of a damped tick (m2/V); NULL: undamped */
    pzs_real *carry;         /* [inputs] parts of earlier changes that the amplifiers have not given
                                (V); NULL: none is carried on */
    pzs_real share;          /* part of the static gradient that a damped tick follows */
    pzs_real base_energy;    /* |W B base|^2 (m2) */
    pzs_real largest_column; /* square root of the largest diagonal entry of H (m/V) */
    bool has_step_limits; /* some step limit is shorter than the distance between the voltage limits
                           */
    pzs_control_behind behind;
    uint16_t scrub_row; /* row of the Hessian that is compared next with its source */
    void *work;         /* workspace */
    uint8_t stage;
} pzs_control_state;

/*
 * One test signal of the fault detector: an electrode is moved between two voltages to see whether
 * it responds.
 */
typedef struct pzs_test_signal {
    uint16_t input;         /* input under test; 0xFFFF: none */
    uint8_t shapes, moves;  /* number of shapes and of moves in this test so far */
    bool is_upper, is_dead; /* is_upper: the upper of the two voltages is set; is_dead: the
                               electrode seems dead rather than stuck */
    pzs_real middle, set;   /* mean of the two voltages, and the voltage now set (V) */
    pzs_real lower, upper;  /* limits of the electrode before the test (V) */
    pzs_real sum, square, response_sum, response_square; /* sums over the moves and over the
                                                            responses (V, V2) */
} pzs_test_signal;

#define PZS_TEST_SIGNALS 4 /* most electrodes under test at the same time */

typedef struct pzs_fault_detector_state {
    struct pzs_control *control;
    pzs_envelope columns;     /* B'W^2 B over the measured outputs, factored */
    pzs_real *diagonal;       /* [inputs] diagonal of B'W^2 B over all outputs (m2/V2) */
    pzs_real *voltage;        /* [delay + 1][inputs] voltages of the last ticks (V) */
    pzs_real *voltage_before; /* [inputs] voltages that belong to the last shape (V) */
    pzs_real *deviation; /* [inputs] voltage by which each electrode acted beyond its command, by
                            least squares (V) */
    pzs_real *moved, *response; /* [inputs] fading sums of the squares of moves and of responses
                                   (V2) */
    pzs_real *lost_voltage; /* [inputs] voltage that an electrode lacks: its deviation, summed over
                               the ticks with a factor below 1 for each tick that has passed (V) */
    pzs_real *disturbance;  /* [outputs] disturbance at the last shape (m) */
    pzs_real *change; /* [outputs] W^2 times the change of the disturbance since the last shape (m)
                       */
    uint8_t *electrode; /* [inputs] state of each electrode, a pzs_electrode_state */
    uint8_t *missing; /* [outputs] bit 0: no measurement at the last shape; bit 1: excluded from the
                         least squares */
    uint8_t *pause; /* [inputs] shapes for which an electrode that passed its test is not suspected
                     */
    pzs_test_signal test[PZS_TEST_SIGNALS];
    pzs_real ridge; /* regularisation of the least squares, relative to the diagonal */
    uint16_t delay, oldest;
    bool is_stale; /* the factored matrix belongs to another set of measured outputs */
    uint8_t stage;
} pzs_fault_detector_state;

typedef struct pzs_estimate_state {
    struct pzs_control *control;
    const struct pzs_estimator *tables;
    pzs_real *expected;   /* [sensors] readings S v that the voltages make */
    pzs_real *sensed;     /* [sensors] last readings */
    pzs_real *difference; /* [sensors] reading - expected reading */
    uint8_t *repeats; /* [sensors] ticks in which a reading repeated although it should have moved
                       */
    uint8_t stage;
} pzs_estimate_state;

typedef struct pzs_damper_state {
    struct pzs_control *control;
    const struct pzs_vibration *tables;
    pzs_real *late; /* [3][width] position, velocity over angular frequency and static position by
                       loads of each mode when the readings of the present tick were taken (m) */
    pzs_real *now;  /* [3][width] the same at the present tick (m) */
    pzs_real *velocity_before; /* [width] velocity over angular frequency at the last tick (m) */
    pzs_real *residual_modes;  /* [width] part of `residual` that is subtracted mode by mode (m) */
    pzs_real *work;            /* [2][width] modal vectors of one computation */
    pzs_real *equilibrium; /* [delay + 1][width] static position by the voltages of the last ticks
                              (m) */
    pzs_real *expected;    /* [delay + 1][sensors] static readings under the voltages of the last
                              ticks */
    pzs_real *predicted;   /* [sensors] readings that voltages and modes predict */
    pzs_real *innovation;  /* [sensors] reading - predicted reading */
    pzs_real *sensed;      /* [sensors] last readings */
    pzs_real *residual;    /* [sensors] low-passed innovation */
    pzs_real *damping;     /* [inputs] damping gradient handed to the control step (m2/V) */
    pzs_real *carry;  /* [inputs] parts of earlier changes that the amplifiers have not given (V) */
    uint8_t *repeats; /* [sensors] ticks in which a reading repeated although it should have moved
                       */
    uint16_t newest;  /* row of `equilibrium` and `expected` that belongs to the present voltages */
    uint8_t stage;
} pzs_damper_state;

typedef struct pzs_feed_forward_state {
    const struct pzs_known_loads *tables;
    pzs_real *readings; /* [sensors] readings without the effect of known loads */
    pzs_real *wanted;   /* [outputs] target without the effect of known loads (m) */
} pzs_feed_forward_state;

/* What a supervisor decides by; 32-bit words without gaps, because three copies are compared. */
typedef struct pzs_supervisor_core {
    uint32_t mode;      /* pzs_supervisor_mode */
    uint32_t obeyed;    /* command word that has been carried out last */
    uint32_t is_flat;   /* 1: the target of ramps is the reference voltages, 0: the park voltages */
    uint32_t remaining; /* ticks until the end of the ramp */
    uint32_t silent;    /* ticks in a row without a usable frame of readings */
    uint32_t over;      /* counter of ticks in which the shape was implausible */
    uint32_t cause;     /* pzs_supervisor_event that has taken control away, or 0 */
} pzs_supervisor_core;

/* Divergence monitor of a supervisor. */
typedef struct pzs_monitor_state {
    pzs_real *slow;        /* [outputs] low-passed disturbance (m) */
    pzs_real *disturbance; /* [outputs] disturbance of the last tick (m) */
    pzs_real *predicted;   /* [outputs] predicted shape of the last tick (m) */
    pzs_real *move;        /* [outputs] change of the predicted shape in the last tick (m) */
    pzs_real *wanted;      /* [outputs] target of the last tick (m) */
    pzs_real amplitude;    /* largest deviation of the last ticks, fading (m) */
    pzs_real envelope;     /* deviation that changes of the target explain (m) */
    pzs_real moved;        /* fading sum of squares of predicted changes of the shape (m2) */
    pzs_real answered;     /* fading sum of products of predicted and measured changes (m2) */
    uint32_t fixed;        /* number of fixed inputs in the last tick (monitor.c) */
    bool is_started;
} pzs_monitor_state;

typedef struct pzs_supervisor_state {
    pzs_supervisor_core core[3]; /* three copies, of which two outvote a damaged third */
    /* Three copies of a number that grows with each command, times 256, plus the command. Only the
       program writes them. */
    volatile uint32_t command[3];
    const struct pzs_supervision *tables;
    const struct pzs_problem *problem;
    pzs_monitor_state monitor;
} pzs_supervisor_state;

typedef struct pzs_amplifier_state {
    const struct pzs_amplifier *tables;
    pzs_real *given; /* [inputs] voltages that the amplifiers give (V) */
} pzs_amplifier_state;

/* What a tick needs to find everything else. All of it stays as it is from tick to tick. */
typedef struct pzs_loop_core {
    const struct pzs_block *blocks; /* [count] the list of blocks */
    uint8_t *memory;                /* workspace, from its first multiple of 8 bytes on */
    struct pzs_control *control;
    void *control_work;         /* workspace of the controller */
    const pzs_real *influence;  /* [outputs][inputs] B of the controller (m/V) */
    const pzs_real *known_now;  /* [loads] as passed to pzs_loop_know, or NULL */
    const pzs_real *known_next; /* [loads] */
    uint32_t limit_sum;         /* checksum of voltage limits and step limits */
    uint32_t influence_crc;     /* checksum of an influence matrix computed on the device */
    uint16_t sensors;           /* number of readings */
    uint8_t count, stage;
} pzs_loop_core;

typedef struct pzs_loop_state {
    pzs_loop_core core[3]; /* three copies, of which two outvote a damaged third */
    pzs_scrub problem_scrub, influence_scrub;
} pzs_loop_state;

#endif
