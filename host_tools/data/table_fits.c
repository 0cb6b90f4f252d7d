/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reading of FITS images (number_table.h) by the library cfitsio: the first image of a file with
 * one to three dimensions. An image of one dimension is one column. A cube becomes a table with one
 * row for each of its planes; a cube of influence functions has one plane for each actuator.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <fitsio.h>
#include "number_table.h"

enum { FITS_DIMENSIONS = 3 };

static int fault(char *error, const char *message)
{
    snprintf(error, NUMBER_ERROR, "%s", message);
    return -1;
}

/* Write an error message with the text of the library cfitsio for an error status. Returns -1. */
static int explain(int status, char *error)
{
    char words[FLEN_STATUS];
    fits_get_errstatus(status, words);
    snprintf(error, NUMBER_ERROR, "cfitsio cannot read it: %s; save the image again", words);
    return -1;
}

/*
 * Move to the first image of a FITS file that contains numbers. Returns 0, or -1 with error filled.
 */
static int find_image(fitsfile *file, int *dimensions, char *error)
{
    int status = 0, units = 0, type;
    fits_get_num_hdus(file, &units, &status);
    for (int unit = 1; unit <= units && status == 0; unit++) {
        *dimensions = 0;
        fits_movabs_hdu(file, unit, &type, &status);
        if (status == 0 && type == IMAGE_HDU)
            fits_get_img_dim(file, dimensions, &status);
        if (*dimensions > 0)
            break;
    }
    if (status != 0)
        return explain(status, error);
    if (*dimensions == 0)
        return fault(error, "no image in the FITS file; save the matrix as an image, not a table");
    if (*dimensions > FITS_DIMENSIONS)
        return fault(error, "the image has more than three dimensions; save it with outputs and "
                            "actuators alone");
    return 0;
}

/*
 * Set the size of a table from the axes of an image, whose first axis runs fastest. Returns 0, or
 * -1 with error filled.
 */
static int take_size(number_table *table, fitsfile *file, int dimensions, char *error)
{
    LONGLONG axis[FITS_DIMENSIONS] = {1, 1, 1};
    LONGLONG count = 1;
    int status = 0;
    fits_get_img_sizell(file, FITS_DIMENSIONS, axis, &status);
    if (status != 0)
        return explain(status, error);
    for (int i = 0; i < dimensions; i++) {
        if (axis[i] < 1 || axis[i] > NUMBER_VALUES / count)
            return fault(error, "its axes are empty or above 8 million numbers; save a smaller "
                                "image");
        count *= axis[i];
    }
    table->columns = dimensions == 1 ? 1 : (size_t)axis[0];
    if (dimensions == FITS_DIMENSIONS)
        table->columns *= (size_t)axis[1];
    table->rows = (size_t)count / table->columns;
    return 0;
}

/*
 * Read the numbers of the present image of a FITS file into a table. Returns 0, or -1 with error
 * filled.
 */
static int read_image(number_table *table, fitsfile *file, int dimensions, char *error)
{
    LONGLONG first[FITS_DIMENSIONS] = {1, 1, 1};
    double blank = (double)NAN; /* Value of pixels that the FITS file marks as undefined. */
    int status = 0, has_blank = 0;
    if (take_size(table, file, dimensions, error) < 0)
        return -1;
    table->value = calloc(table->rows * table->columns, sizeof *table->value);
    if (!table->value)
        return fault(error, "out of memory");
    fits_read_pixll(file, TDOUBLE, first, (LONGLONG)(table->rows * table->columns), &blank,
                    table->value, &has_blank, &status);
    return status == 0 ? 0 : explain(status, error);
}

int table_fits_read(number_table *table, const char *path, char *error)
{
    fitsfile *file = NULL;
    int status = 0, dimensions = 0;
    fits_open_diskfile(&file, path, READONLY, &status);
    if (status != 0 && strstr(path, ".Z"))
        return fault(
            error, "cfitsio takes the \".Z\" in its path for the ending of another format; rename "
                   "the folder or the file");
    if (status != 0)
        return explain(status, error);
    int failed = find_image(file, &dimensions, error);
    if (!failed)
        failed = read_image(table, file, dimensions, error);
    fits_close_file(file, &status);
    return failed;
}
