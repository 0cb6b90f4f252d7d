/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Single readings of measured shapes that contradict all others, such as a reading of the wrong
 * unit. Two tests find them:
 *   leave-one-out  The residual e of a reading, after the least-squares fit of all voltages and of
 *                  a linear drift, is compared with the scatter s of the residuals of the same
 *                  output without this reading: t = e/(s sqrt(1 - h)), with the leverage h of the
 *                  shape. A t that chance reaches in less than one of a million calibrations
 * counts. The test needs at least two more shapes than there are actuators and trends. size Where
 * shapes are too few for this, a reading counts that is OUTLIER_SIZE times as large, per volt, as
 * every other reading of its shape and of its output.
 */
#ifndef POKE_OUTLIERS_H
#define POKE_OUTLIERS_H

#include <stdbool.h>
#include "pokes.h"

#define OUTLIER_SIZE 30.0

enum { POKE_OUTLIERS = 8 };

typedef struct poke_outlier {
    size_t poke, output; /* indices of the shape and of the reading in it */
    double times;        /* by what factor the reading is farther off than the other ones: t of the
                            leave-one-out test, or the ratio of sizes */
    bool is_size;        /* true where the size was compared, false: the leave-one-out test */
} poke_outlier;

typedef struct poke_outliers {
    size_t count; /* number of outliers, of which the first POKE_OUTLIERS are stored */
    poke_outlier outlier[POKE_OUTLIERS];
} poke_outliers;

/* Find the outliers among the readings of pokes. Returns 0, or -1 where memory runs out. */
int poke_outliers_find(poke_outliers *found, const pokes *pokes);

#endif
