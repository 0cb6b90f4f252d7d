/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Arrays in the tables of the controller (pzs_problem), in the order in which their checksum covers
 * them.
 */
#ifndef PZS_LIB_PROBLEM_H
#define PZS_LIB_PROBLEM_H

#include "pzs_control.h"
#include "limit_rows.h"
#include "scrub.h"
#include "sparse_influence.h"

/* Number of arrays and numbers in the controller's tables that their checksum covers. */
#define PROBLEM_PARTS (11u + LIMIT_ROW_PARTS + SPARSE_PARTS)

void pzs_problem_parts(const pzs_problem *problem, pzs_table_part part[PROBLEM_PARTS]);

#endif
