/* SPDX-License-Identifier: BSD-2-Clause */
/* Checksum of the tables of the supervisor, for those who make them. */
#ifndef PZS_LIB_SUPERVISOR_H
#define PZS_LIB_SUPERVISOR_H

#include "pzs_loop.h"

/* CRC of the counts, settings and arrays, as stored in the crc field. */
uint32_t pzs_supervision_crc(const pzs_supervision *tables);

#endif
