/* SPDX-License-Identifier: BSD-2-Clause */
/* Work of the optimiser in the longest of many simulated control ticks. */
#ifndef TICK_WORK_H
#define TICK_WORK_H

#include "analysis.h"

enum {
    TICK_WORK_TICKS = 1998
}; /* number of control ticks that are simulated to find the longest one */

/*
 * Return the largest number of multiply-adds of the optimiser in one control step: maximum over
 * TICK_WORK_TICKS simulated steps without damping of vibration, with targets that jump between the
 * shapes of random voltages; 0 where memory runs out.
 *   design in  model of a scene with amplifiers, target and influence matrix
 *   limit  in  limit of the optimiser's work in a tick (multiply-adds)
 */
uint64_t tick_work_longest(const design *design, uint64_t limit);

#endif
