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
    bool is_used; /* true if the scene asks for a self-test; otherwise all other members are zero */
    double *memory; /* memory for all arrays of the self-test tables, in one allocation */
    double *stated; /* [sensors] RMS noise of each sensor that the scene file states (unit of each
                       sensor) */
    pzs_selftest_tables tables;
} wiring_test;

/*
 * Make the tables of the self-test of amplifiers, cables and sensors. A test pulse lasts as long as
 * the scene file says. If the scene file gives no duration, the pulse lasts six periods of the
 * first vibration mode, where the natural frequencies are known. In any case it lasts long enough
 * for its height under the step limits of the amplifiers.
 *   analysis  in  analysis whose voltage problem is computed, and whose certificate is computed if
 *                 the pulse is to follow the natural frequencies; must outlive the self-test
 *   estimator in  estimator of the controller, which must outlive the self-test; NULL: every target
 *                 node is measured
 * Returns whether memory was available; call wiring_test_close in either case.
 */
bool wiring_test_open(wiring_test *test, const analysis *analysis, const estimator *estimator);

/*
 * Make the tables of the test pulses with which the fault detector of a loop that damps vibration
 * finds faulty electrodes. The heights are a part of the voltage ranges, and a pulse lasts four
 * periods of the first vibration mode. The member is_used is true if the scene asks for detected
 * faults.
 *   analysis  in  analysis whose voltage problem and stability certificate are computed; must
 *                 outlive the tables
 *   estimator in  estimator of the controller, which must outlive the tables; NULL: every target
 *                 node is measured
 * Returns whether memory was available; call wiring_test_close in either case.
 */
bool wiring_test_detector_open(wiring_test *test, const analysis *analysis,
                               const estimator *estimator);
void wiring_test_close(wiring_test *test);

/* Return the duration of the whole self-test (ticks). */
uint32_t wiring_test_ticks(const wiring_test *test);

/* Return the number of amplifiers that the self-test moves. */
int wiring_test_tested(const wiring_test *test);

/*
 * Describe the self-test in one line: heights and duration of the test pulses, and duration of the
 * whole test.
 */
void wiring_test_text(const wiring_test *test, const analysis *analysis, char text[SCENE_ERROR]);

/*
 * List as text what the self-test cannot detect: amplifiers that it does not move, amplifiers that
 * move no sensor, and amplifiers whose response the noise in the scene file may hide, with an
 * amplitude and a duration of the pulses that suffice. The text is empty where there is nothing to
 * list.
 */
void wiring_test_remarks(const wiring_test *test, const analysis *analysis, char text[SCENE_ERROR]);

/*
 * List what a self-test has found as text, separated by semicolons; the text is empty if nothing
 * was found.
 *   selftest in  self-test that has run to its end on the host
 */
void wiring_test_findings(const pzs_selftest *selftest, const analysis *analysis,
                          char text[SCENE_ERROR]);

#endif
