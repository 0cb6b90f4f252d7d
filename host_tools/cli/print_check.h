/* SPDX-License-Identifier: BSD-2-Clause */
/* Results of `pzs check`: the memory that a scene needs on a device, and its control loop. */
#ifndef PRINT_CHECK_H
#define PRINT_CHECK_H

#include "print_work.h"

/*
 * Print heights and duration of the test pulses of the self-test, which runs before the control
 * loop starts; then on how many electrodes the fault detector can find faults, with a warning that
 * names the others. Print nothing where the scene has neither self-test nor fault detector.
 */
void print_test_plans(const analysis *analysis);

/*
 * Print the size of the scene and the device memory that the constants of its firmware (`pzs
 * tables`) need.
 */
void print_check(const analysis *analysis, const work_report *work);
void print_check_json(const analysis *analysis, const work_report *work);

#endif
