/* SPDX-License-Identifier: BSD-2-Clause */
/* Search for the modes of a structure in a state that a table of calls describes. */
#ifndef PZS_LIB_MODES_H
#define PZS_LIB_MODES_H

#include "search.h"

#if PZS_MODES

/* Stages of a search for modes. MODES_FOUND: info.square and info.shape hold the modes. */
enum { MODES_READY = 1, MODES_FOUND = 2 };

/* Return the default of settings.solve_limit for a number of modes. */
uint32_t pzs_modes_solve_limit(uint32_t number);

/*
 * Find the lowest modes by the assembly and the linear solves in `call`.
 *   kept_stage in  stage of the model whose factors the search can use if settings.shift is 0; the
 *                  model has this stage again afterwards
 * Returns the statuses of pzs_modes_find.
 */
pzs_status pzs_modes_run(pzs_modes *modes, const struct pzs_modes_calls *call, uint8_t kept_stage);

#endif
#endif
