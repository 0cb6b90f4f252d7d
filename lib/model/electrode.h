/* What electrodes at rest lend to open electrodes at a shape. */
#ifndef PZS_LIB_ELECTRODE_H
#define PZS_LIB_ELECTRODE_H

#include "pzs_model.h"

/* CRC of the arrays of a pzs_electrodes of a structure, as stored in its crc field. */
uint32_t pzs_electrode_crc(const pzs_electrodes *tables, uint32_t inputs);

/* Are the tables complete, undamaged and of this structure? OK, ARGUMENT, FORMAT or CRC. */
pzs_status pzs_electrode_check(const pzs_electrodes *tables, const pzs_structure *structure);

/* Electrode of open electrode number a. */
uint32_t pzs_electrode_open(const pzs_electrodes *tables, uint32_t a);

/* Input of open electrode number a. */
uint16_t pzs_electrode_open_input(const pzs_electrodes *tables, uint32_t a);

/* Number of open electrodes. */
uint32_t pzs_electrode_open_count(const pzs_electrodes *tables);

/* Charge of an electrode per unit of an input while the shell is held. */
pzs_real pzs_electrode_direct(const pzs_electrodes *tables, uint32_t electrode, uint32_t input);

#endif
