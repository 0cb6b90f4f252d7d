/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Access to the tables of the electrodes (charges and open electrodes). These functions are shared
 * by the computation at the undeformed shape and by the one at a deformed shape.
 */
#ifndef PZS_LIB_ELECTRODE_H
#define PZS_LIB_ELECTRODE_H

#include "pzs_model.h"

/* Checksum of the arrays of a pzs_electrodes, as stored in its crc field. */
uint32_t pzs_electrode_crc(const pzs_electrodes *tables, uint32_t inputs);

/*
 * Check that the tables are complete, undamaged and made for this structure. Returns PZS_OK,
 * PZS_E_ARGUMENT, PZS_E_FORMAT or PZS_E_CRC.
 */
pzs_status pzs_electrode_check(const pzs_electrodes *tables, const pzs_structure *structure);

/* Index, among all electrodes, of open electrode number a. */
uint32_t pzs_electrode_open(const pzs_electrodes *tables, uint32_t open);

/* Index, among all inputs, of the voltage of open electrode number a. */
uint16_t pzs_electrode_open_input(const pzs_electrodes *tables, uint32_t open);

/* Number of open electrodes. */
uint32_t pzs_electrode_open_count(const pzs_electrodes *tables);

/* Charge of an electrode per unit of an input while the shell cannot deform (C/V, C/K). */
pzs_real pzs_electrode_direct(const pzs_electrodes *tables, uint32_t electrode, uint32_t input);

#endif
