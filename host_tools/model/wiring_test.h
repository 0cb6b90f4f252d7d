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
    bool is_used;   /* true where the scene has a self-test; otherwise all other members are zero */
    double *memory; /* one allocation that holds all arrays of the tables */
    pzs_selftest_tables tables;
} wiring_test;

/*
 * Make the tables of the self-test. A pulse lasts as long as the scene says, otherwise six periods
 * of the first mode where the natural frequencies are known, and at least as long as its height and
 * the step limits require.
 *   analysis  in  after design_control, and after certificate_make where the modes matter; must
 *       outlive the self-test
 *   estimator in  estimator of the controller; must outlive the self-test; NULL: every target node
 *       is measured
 * Returns whether memory was available; call wiring_test_close in either case.
 */
bool wiring_test_open(wiring_test *test, const analysis *analysis, const estimator *estimator);
void wiring_test_close(wiring_test *test);

/* Number of ticks of the self-test. */
uint32_t wiring_test_ticks(const wiring_test *test);

/*
 * Describe the self-test in one line: its duration, and the amplifiers whose responses are too
 * small beside the noise that the scene states.
 */
void wiring_test_text(const wiring_test *test, const analysis *analysis, char text[SCENE_ERROR]);

/*
 * List the findings of a self-test as text, separated by semicolons; the text is empty where there
 * are none.
 *   selftest in  self-test on the host, at its end
 */
void wiring_test_findings(const pzs_selftest *selftest, const analysis *analysis,
                          char text[SCENE_ERROR]);

#endif
