/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksum of the tables of the supervisor, for the functions that generate the tables. */
#ifndef PZS_LIB_SUPERVISOR_H
#define PZS_LIB_SUPERVISOR_H

#include "pzs_loop.h"

/*
 * Return the checksum of the settings and arrays of supervisor tables, which their member crc must
 * equal.
 */
uint32_t pzs_supervision_crc(const pzs_supervision *tables);

#endif
