/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Refusal of FITS files by a program that was built without the library cfitsio (number_table.h).
 */
#include <stdio.h>
#include "number_table.h"

int table_fits_read(number_table *table, const char *path, char *error)
{
    (void)table;
    (void)path;
    snprintf(error, NUMBER_ERROR,
             "a FITS file, and pzs was built without cfitsio; install libcfitsio-dev and build pzs "
             "again, or save the array as .npy");
    return -1;
}
