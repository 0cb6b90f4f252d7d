/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Access to the tables of the electrodes, shared by the computation of charges at the undeformed
 * shape and at a deformed shape.
 */
#ifndef PZS_LIB_ELECTRODE_H
#define PZS_LIB_ELECTRODE_H

#include "pzs_model.h"

/*
 * Return the checksum of the arrays in the tables of the electrodes, as stored in their member crc.
 */
uint32_t pzs_electrode_crc(const pzs_electrodes *tables, uint32_t inputs);

/*
 * Check that electrode tables are complete, undamaged and made for a structure. Returns PZS_OK,
 * PZS_E_ARGUMENT, PZS_E_FORMAT or PZS_E_CRC.
 */
pzs_status pzs_electrode_check(const pzs_electrodes *tables, const pzs_structure *structure);

/*
 * Return the index, among all electrodes, of the open electrode with number `open` (0 to the number
 * of open electrodes - 1).
 */
uint32_t pzs_electrode_open(const pzs_electrodes *tables, uint32_t open);

/*
 * Return the index of the input of the model that stands for the voltage of open electrode number
 * `open` (0 to the number of open electrodes - 1).
 */
uint16_t pzs_electrode_open_input(const pzs_electrodes *tables, uint32_t open);

/* Return the number of open electrodes, those whose voltage is not prescribed. */
uint32_t pzs_electrode_open_count(const pzs_electrodes *tables);

/*
 * Return the charge of an electrode per unit of an input while the shell cannot deform (C/V or
 * C/K).
 */
pzs_real pzs_electrode_direct(const pzs_electrodes *tables, uint32_t electrode, uint32_t input);

#endif
