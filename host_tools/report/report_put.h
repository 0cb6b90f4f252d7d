/* SPDX-License-Identifier: BSD-2-Clause */
/* Text of the report pages: escaped words, numbers, tables. It is UTF-8 and well-formed XML. */
#ifndef REPORT_PUT_H
#define REPORT_PUT_H

#include <stdbool.h>
#include <stdio.h>

/*
 * Write a format with these directives; everything else is copied as it stands.
 *   %t  const char *          text, its markup escaped
 *   %s  const char *          markup
 *   %d  int
 *   %f  double                coordinate in a picture, one decimal
 *   %n  double                number of four significant digits; a dash for NaN
 *   %r  double                the same of two digits, for conditions and residuals
 *   %p  double                share, in percent
 *   %q  double, const char *  quantity and unit; lengths in a readable unit
 *   %a  double, double, const char *  quantity, largest of its column, unit: in that one's notation
 *   %u  const char *          unit
 */
void put(FILE *file, const char *format, ...);

/*
 * A row of a table; '|' separates the cells, '<' begins one aligned to the left, '~' a wrapped
 * one.
 */
void put_row(FILE *file, const char *format, ...);

/*
 * A table that scrolls in a box of its own. caption: markup; head: its cells as in put_row, or ""
 */
void put_table(FILE *file, const char *caption, const char *head);
void put_table_end(FILE *file);

/* The unit in which a quantity reads best, and the factor into it: nm, um, mm or m for lengths. */
typedef struct put_unit {
    double factor;
    const char *name;
} put_unit;
put_unit put_unit_of(double most, const char *unit);

#endif
