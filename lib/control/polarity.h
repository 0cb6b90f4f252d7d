/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Polarity monitor of the supervisor, for loops with a vibration damper: detects that the structure
 * moves against its prediction, as with amplifiers of the wrong polarity.
 */
#ifndef PZS_LIB_POLARITY_H
#define PZS_LIB_POLARITY_H

#include "pzs_loop.h"

/*
 * Smallest change of the target that counts as a jump (m, RMS over the outputs): 2 load + 6 noise
 * of the supervisor's tables.
 */
pzs_real pzs_polarity_least(const pzs_supervision *tables);

/*
 * Judge the motion of the shape along a jump of the target, from the next tick on.
 *   wanted [outputs] in  target shape after the jump (m)
 *   before [outputs] in  target shape before the jump (m)
 *   shaken           in  vibration that earlier changes of the target explain (m, RMS)
 */
void pzs_polarity_begin(pzs_polarity_state *polarity, const pzs_supervision *tables,
                        const pzs_real *wanted, const pzs_real *before, uint32_t outputs,
                        pzs_real shaken);

/*
 * Whether the structure has moved against its prediction since the last jump of the target, or not
 * at all. Call this once a tick; the first two calls after a jump note the shapes with which later
 * ones are compared.
 *   predicted [outputs] in  predicted shape (m)
 *   measured  [outputs] in  measured shape without vibration (m)
 */
bool pzs_polarity_is_opposed(pzs_polarity_state *polarity, const pzs_real *predicted,
                             const pzs_real *measured, uint32_t outputs);

/* Let a tick pass in which pzs_polarity_is_opposed is not called. */
void pzs_polarity_pass(pzs_polarity_state *polarity);

#endif
