/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Tables of the self-test with which a firmware checks amplifiers, cables and sensors before the
 * control loop takes over (pzs_selftest_tables), from the key `safety.selftest` of a scene.
 */
#ifndef WIRING_TEST_H
#define WIRING_TEST_H

#include <stdbool.h>
#include "estimator.h"

typedef struct wiring_test {
    bool is_used; /* true if the scene file asks for a self-test of the wiring; otherwise all other
                     members are zero */
    double *memory; /* memory for all arrays of the self-test tables, in one allocation */
    double *stated; /* [sensors] RMS noise of each sensor that the scene file states (unit of each
                       sensor) */
    pzs_selftest_tables tables;
} wiring_test;

/*
 * Make the tables of the self-test of amplifiers, cables and sensors. A test pulse lasts as the
 * scene file says, or six periods of the first vibration mode where known; longer if step limits
 * require it.
 *   analysis  in  analysis with influence matrix and, for the six periods, vibration modes; must
 *       outlive the self-test
 *   estimator in  shape estimator of the controller, which must outlive the self-test; NULL: every
 *       target node is measured
 * Returns whether memory was available; call wiring_test_close in either case.
 */
bool wiring_test_open(wiring_test *test, const analysis *analysis, const estimator *estimator);

/*
 * Make the tables of the test pulses with which a loop that damps vibration finds faulty
 * electrodes. Heights are a part of the voltage ranges; a pulse lasts 3.2 periods of the first
 * mode. The member is_used tells whether the scene file lets the controller itself detect electrode
 * faults.
 *   analysis  in  analysis with influence matrix and vibration modes; must outlive the tables
 *   estimator in  shape estimator of the controller, which must outlive the tables; NULL: every
 *       target node is measured
 * Returns whether memory was available; call wiring_test_close in either case.
 */
bool wiring_test_detector_open(wiring_test *test, const analysis *analysis,
                               const estimator *estimator);
void wiring_test_close(wiring_test *test);

/* Return the largest duration of the whole self-test of the wiring (ticks). */
uint32_t wiring_test_ticks(const wiring_test *test);

/* Return the number of amplifiers to which the self-test of the wiring applies test pulses. */
int wiring_test_tested(const wiring_test *test);

/*
 * Describe the self-test of the wiring in one line: heights and duration of the test pulses, and
 * duration of the whole test.
 */
void wiring_test_text(const wiring_test *test, const analysis *analysis, char text[SCENE_ERROR]);

/*
 * List as text what the self-test of the wiring cannot detect: amplifiers without a test pulse,
 * amplifiers without effect on a reading, and amplifiers whose response may be hidden by the
 * scene's noise. For the last ones, the text also states which height and which duration of the
 * test pulses suffice. Empty where there is nothing to list.
 */
void wiring_test_remarks(const wiring_test *test, const analysis *analysis, char text[SCENE_ERROR]);

/*
 * List the faults that a self-test of the wiring has found as text, separated by semicolons; the
 * text is empty if there are none.
 *   selftest in  self-test that has run to its end on the host
 */
void wiring_test_findings(const pzs_selftest *selftest, const analysis *analysis,
                          char text[SCENE_ERROR]);

#endif
