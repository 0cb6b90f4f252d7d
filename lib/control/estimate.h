/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksum of the tables of the shape estimator, for the functions that generate the tables. */
#ifndef PZS_LIB_ESTIMATE_H
#define PZS_LIB_ESTIMATE_H

#include "pzs_loop.h"

/*
 * Return the checksum of the counts and arrays of estimator tables, which their member crc must
 * equal.
 */
uint32_t pzs_estimate_crc(const pzs_estimator *tables);
uint32_t pzs_estimate_known_crc(const pzs_feed_forward_table *tables);

#endif
