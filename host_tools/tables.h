/* Generated C tables: the arrays of a design as const data for a firmware. */
#ifndef TABLES_H
#define TABLES_H

#include <stdio.h>
#include "analysis.h"

typedef enum tables_image { TABLES_CONTROL, TABLES_LINEAR } tables_image;

/*
 * Write the tables of an image as a C header.
 *   prefix  in  of every name, a C identifier
 * The same scene gives the same bytes: no dates, no paths. Returns 0, or -1 when writing failed.
 */
int tables_write(FILE *file, const analysis *a, tables_image image, const char *prefix);

#endif
