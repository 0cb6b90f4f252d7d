/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Polarity test of the supervisor: a structure whose shape is opposite to its prediction is
 * suspected of amplifiers of the wrong polarity, and its answer to ramps of the voltages tells
 * whether they are wrong or a load is the cause.
 */
#ifndef PZS_LIB_POLARITY_TEST_H
#define PZS_LIB_POLARITY_TEST_H

#include "pzs_loop.h"

/*
 * Whether the shape of this tick is one that the polarity test compares: one tick in
 * POLARITY_STRIDE, in which the other monitors leave the time of a scalar product to it. Call this
 * once a tick.
 */
bool pzs_polarity_test_has_turn(pzs_polarity_test_state *test);

/*
 * Compare the measured with the predicted shape, in a tick in which pzs_polarity_test_has_turn has
 * returned true.
 *   predicted [outputs] in  predicted shape without free functions of the target (m)
 *   measured  [outputs] in  measured shape (m)
 */
void pzs_polarity_test_compare(pzs_polarity_test_state *test, const pzs_supervision *tables,
                               const pzs_real *predicted, const pzs_real *measured,
                               uint32_t outputs);

/*
 * Whether the shape has been opposite to its prediction for so long that a test is due.
 *   is_counting in  whether another monitor counts ticks until an alarm
 */
bool pzs_polarity_test_is_due(const pzs_polarity_test_state *test, const pzs_supervision *tables,
                              bool is_counting);

/*
 * Begin a test.
 *   direction [count] out  memory for the direction in which motions are compared
 *   predicted [count] in   predicted shape or readings under the present voltages
 */
void pzs_polarity_test_begin(pzs_polarity_test_state *test, pzs_real *direction,
                             const pzs_real *predicted, uint32_t count);

/* Number of ticks of a pause before or after a ramp of the voltages, with readings of this age. */
uint32_t pzs_polarity_test_pause(const pzs_supervision *tables, uint32_t delay);

/* What a polarity test compares: shapes, or where the loop damps vibration, readings. */
typedef struct polarity_test_shapes {
    pzs_real *direction;       /* [count] direction in which motions are compared */
    const pzs_real *predicted; /* [count] static prediction under the present voltages */
    const pzs_real *measured;  /* [count] measurements */
    uint32_t count;            /* number of outputs or sensors */
    uint32_t delay;            /* age of the measurements (ticks) */
} polarity_test_shapes;

/*
 * Add the measurements of one tick to the average of a pause.
 *   tick in  number of the tick in the pause, from 0
 */
void pzs_polarity_test_average(pzs_polarity_test_state *test, const polarity_test_shapes *shapes,
                               uint32_t tick);

/* What the answers of a structure to the ramps so far tell about the polarity of its amplifiers. */
typedef enum polarity_verdict {
    POLARITY_UNDECIDED,
    POLARITY_RIGHT, /* right, or the test has ended without result */
    POLARITY_WRONG
} polarity_verdict;

/*
 * Judge the answer of the structure to the last ramp at the end of the pause after it.
 *   ramps in  number of ramps so far; 0: this is the pause before the first
 */
polarity_verdict pzs_polarity_test_judge(pzs_polarity_test_state *test,
                                         const pzs_supervision *tables, uint32_t ramps);

/*
 * Let a time pass until the next test, after one in which the structure has answered rightly.
 *   lasted in  duration of the test (ticks)
 */
void pzs_polarity_test_end(pzs_polarity_test_state *test, const pzs_supervision *tables,
                           uint32_t lasted);

/* Forget how long the shape was opposite to the prediction: at the start, and after a ramp. */
void pzs_polarity_test_forget(pzs_polarity_test_state *test);

/*
 * Tolerate the vibration at the end of a test.
 *   deviation in  its amplitude (m)
 */
void pzs_polarity_test_tolerate(pzs_polarity_test_state *test, pzs_real deviation);

#endif
