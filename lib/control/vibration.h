/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksum of the tables of the vibration damper, for the functions that generate the tables. */
#ifndef PZS_LIB_VIBRATION_H
#define PZS_LIB_VIBRATION_H

#include "pzs_loop.h"

/*
 * Return the checksum of the counts, arrays and settings of vibration tables, which their member
 * crc must equal.
 */
uint32_t pzs_vibration_crc(const pzs_vibration *tables);

#endif
