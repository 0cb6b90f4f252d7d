/* SPDX-License-Identifier: BSD-2-Clause */
/* The arrays of a voltage problem in the order of its checksum. */
#ifndef PZS_LIB_PROBLEM_H
#define PZS_LIB_PROBLEM_H

#include "pzs_control.h"
#include "scrub.h"

#define PROBLEM_PARTS 10u

void pzs_problem_parts(const pzs_problem *problem, scrub_part part[PROBLEM_PARTS]);

#endif
