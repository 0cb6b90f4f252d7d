/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksum of the tables of the damper, for those who make them. */
#ifndef PZS_LIB_VIBRATION_H
#define PZS_LIB_VIBRATION_H

#include "pzs_loop.h"

/* CRC of the counts, arrays and settings of the tables, as stored in their crc field. */
uint32_t pzs_vibration_crc(const pzs_vibration *tables);

#endif
