/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Evaluation of the self-test of amplifiers, cables and sensors, whose test pulses selftest.c
 * makes.
 */
#ifndef PZS_LIB_SELFTEST_H
#define PZS_LIB_SELFTEST_H

#include "pzs_loop.h"

/*
 * Make one tick of the evaluation of the self-test, from the tick on after all test pulses have
 * been measured. It compares about settings.work_limit entries of the measured responses with the
 * model. The evaluation has ended when selftest->state.core[0].verdict is not PZS_SELFTEST_RUNNING.
 */
void pzs_selftest_evaluate(pzs_selftest *selftest);

/*
 * Whether the self-test moves input j: the tables give the input a pulse of positive height, and
 * pzs_hold does not keep the input at a fixed voltage.
 */
bool pzs_selftest_moves(const pzs_selftest *selftest, uint32_t j);

#endif
