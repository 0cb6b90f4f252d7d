/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksums of the tables of estimation and feed-forward, for those who make them. */
#ifndef PZS_LIB_ESTIMATE_H
#define PZS_LIB_ESTIMATE_H

#include "pzs_loop.h"

/* CRC of the counts and arrays of a table, as stored in its crc field. */
uint32_t pzs_estimate_crc(const pzs_estimator *tables);
uint32_t pzs_estimate_known_crc(const pzs_feed_forward_table *tables);

#endif
