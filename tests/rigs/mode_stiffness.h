/*
 * Entries of the stiffness of an element's strain modes by the numbers of their strains.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef MODE_STIFFNESS_H
#define MODE_STIFFNESS_H

#include "../../lib/model/shell_corner.h"

/*
 * Return the stiffness between strains i and j (0 to 9) of a strain mode, or 0 where the mode does
 * not keep both strains.
 */
static inline pzs_real mode_stiffness(const pzs_element_type *type, int mode, int i, int j)
{
    int row = -1, column = -1;
    for (int k = 0; k < kept_strains[mode]; k++) {
        row = kept_strain[mode][k] == i ? k : row;
        column = kept_strain[mode][k] == j ? k : column;
    }
    if (row < 0 || column < 0)
        return 0;
    const int larger = row > column ? row : column;
    const int smaller = row > column ? column : row;
    return type->d[first_entry[mode] + larger * (larger + 1) / 2 + smaller];
}

#endif
