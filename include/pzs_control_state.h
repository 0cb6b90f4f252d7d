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

/*
 * Active-set method for box-constrained least squares. Vectors are [width]: the inputs rounded up
 * to whole tiles. The free set holds the inputs that may move together, the active set those that
 * stay where they are.
 */
typedef struct pzs_optimiser {
    uint32_t inputs, width;
    uint32_t iteration_limit, iterations;
    pzs_real *hessian;       /* [inputs][width] H (m2/V2) */
    pzs_real *tableau;       /* [inputs][width] H with the free set swept */
    pzs_real *voltage;       /* v (V) */
    pzs_real *lower, *upper; /* bounds of this step (V) */
    pzs_real *free_set;      /* 1 in the free set, 0 in the active set; reals, because vector loops
                                multiply by them */
    pzs_real *base;          /* voltages around which the gradient is linearised (V) */
    pzs_real *regularisation_gradient; /* regularisation (base - reference voltage) (m2/V) */
    pzs_real *target_gradient;         /* B'W^2 (e - B base) (m2/V) */
    pzs_real *model_gradient; /* H (v - base) + regularisation gradient; after a direct iteration as
                                 predicted (m2/V) */
    pzs_real *gradient;       /* model gradient - target gradient (m2/V) */
    pzs_real *direction;      /* free set: search direction (V); active set: gradient after the step
                                 (m2/V) */
    pzs_real *diagonal;       /* of H (m2/V2) */
    pzs_real *start_voltage;  /* voltages at the start of a round (V) */
    pzs_real *start_gradient; /* gradient there (m2/V) */
    pzs_real *next_voltage;   /* voltages after the search direction (V); before it the gradient of
                                 the free set */
    pzs_real *scratch;        /* for any sum; after the search direction next_voltage - base */
    pzs_real inverse_trace;   /* trace of the inverse of H on the free set (V2/m2), 0 if unknown */
    pzs_real inverse_trace_bound; /* upper bound of it that follows from the regularisation, 0 if
                                     unknown */
    pzs_real pivot_floor; /* a pivot below this part of its diagonal counts as linearly dependent */
    pzs_real model_rounding;  /* rounding-error bound of the model gradient (m2/V) */
    pzs_real target_rounding; /* rounding-error bound of the target gradient (m2/V) */
    pzs_real target_energy;   /* |W e|^2, the scale of the objective (m2) */
    pzs_real kkt_violation;   /* largest KKT violation of those measured (m2/V) */
    pzs_real rounding_bound;  /* the part of it that may be rounding (m2/V) */
    uint32_t active_count;    /* inputs in the active set */
    uint32_t checked_next;    /* input whose gradient is measured next, to verify the tableau */
    bool is_verified;         /* the last round with this tableau ended at the optimum */
    bool is_optimal;
} pzs_optimiser;

/* What has to be renewed because voltages were changed outside a step. */
typedef enum pzs_control_behind {
    PZS_BEHIND_NOTHING = 0,
    PZS_BEHIND_PREDICTION, /* info.predicted */
    PZS_BEHIND_GRADIENT    /* info.predicted and the gradient */
} pzs_control_behind;

typedef struct pzs_control_state {
    const struct pzs_problem *problem;
    const pzs_real *influence; /* [outputs][inputs] B in use (m/V) */
    pzs_optimiser optimiser;
    pzs_real *lower, *upper; /* [inputs] limits in force (V): those of the table, narrowed by
                                pzs_hold */
    pzs_real *voltage;       /* [inputs] (V) */
    pzs_real *predicted;     /* [outputs] (m) */
    pzs_real *disturbance;   /* [outputs] (m) */
    pzs_real *measured;      /* [outputs] last measurements (m) */
    pzs_real *step_limit;    /* [inputs] (V) */
    pzs_real *weighted;      /* [2][outputs] W^2 (e - B base), and the measurements to expect (m) */
    uint8_t *repeats; /* [outputs] ticks in which a measurement stood still although it should have
                         moved */
    pzs_real base_energy;    /* |W B base|^2 (m2) */
    pzs_real largest_column; /* square root of the largest diagonal entry of H (m/V) */
    bool has_step_limits; /* some step limit is shorter than the distance between the voltage limits
                           */
    pzs_control_behind behind;
    uint8_t stage;
} pzs_control_state;

/* One test signal of the fault detector: an electrode moved between two voltages to see whether it
 * responds. */
typedef struct pzs_test_signal {
    uint16_t input;         /* 0xFFFF: none */
    uint8_t shapes, moves;  /* seen so far */
    bool is_upper, is_dead; /* the upper of the two voltages is set; the electrode looks dead rather
                               than stuck */
    pzs_real middle, set;   /* mean of the two voltages, voltage now set (V) */
    pzs_real lower, upper;  /* limits of the electrode before the test (V) */
    pzs_real sum, square, response_sum, response_square; /* sums over moves and responses (V, V2) */
} pzs_test_signal;

#define PZS_TEST_SIGNALS 4 /* electrodes under test at the same time */

typedef struct pzs_fault_detector_state {
    struct pzs_control *control;
    pzs_envelope columns;     /* B'W^2 B over the outputs measured, factored */
    pzs_real *diagonal;       /* [inputs] of B'W^2 B over all outputs */
    pzs_real *voltage;        /* [delay + 1][inputs] of the last ticks (V) */
    pzs_real *voltage_before; /* [inputs] that made the shape before (V) */
    pzs_real *deviation; /* [inputs] voltage that each electrode acted by beyond its command, least
                            squares (V) */
    pzs_real *moved, *response; /* [inputs] fading sums of squares of moves and responses (V2) */
    pzs_real *lost_voltage;     /* [inputs] fading sum of the deviation (V) */
    pzs_real *disturbance;      /* [outputs] at the shape before (m) */
    pzs_real *change;           /* [outputs] W^2 times the change of the disturbance (m) */
    uint8_t *electrode;         /* [inputs] pzs_electrode_state */
    uint8_t *missing; /* [outputs] bit 0: no measurement at the shape before, bit 1: not among the
                         columns */
    uint8_t *pause; /* [inputs] shapes for which an electrode that passed its test is left alone */
    pzs_test_signal test[PZS_TEST_SIGNALS];
    pzs_real ridge; /* part of the diagonal added to it */
    uint16_t delay, oldest;
    bool is_stale; /* the factored columns are those of other outputs */
    uint8_t stage;
} pzs_fault_detector_state;

typedef struct pzs_estimate_state {
    struct pzs_control *control;
    const struct pzs_estimator *tables;
    pzs_real *expected;   /* [sensors] S v */
    pzs_real *sensed;     /* [sensors] last readings */
    pzs_real *difference; /* [sensors] reading - expected */
    uint8_t *repeats;     /* [sensors] ticks in which a reading stood still although it should have
                             moved */
    uint8_t stage;
} pzs_estimate_state;

typedef struct pzs_feed_forward_state {
    const struct pzs_known_loads *tables;
    pzs_real *readings; /* [sensors] without the known loads */
    pzs_real *wanted;   /* [outputs] without the known loads (m) */
} pzs_feed_forward_state;

typedef struct pzs_amplifier_state {
    const struct pzs_amplifier *tables;
    pzs_real *given; /* [inputs] voltages that the amplifiers give (V) */
} pzs_amplifier_state;

typedef struct pzs_loop_state {
    const struct pzs_block *blocks; /* [count] */
    void **self;                    /* [count] memory of each block */
    pzs_real *voltage;              /* [inputs] of the last tick without an error (V) */
    uint16_t sensors;               /* length of the readings */
    uint8_t count, stage;
} pzs_loop_state;

#endif
