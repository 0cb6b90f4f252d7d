/* SPDX-License-Identifier: BSD-2-Clause */
/* Writing of escaped text, numbers and tables into HTML and SVG reports in UTF-8. */
#ifndef REPORT_PUT_H
#define REPORT_PUT_H

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>

/*
 * Write a format with the directives below, and all other characters unchanged. Arguments in order,
 * separated by commas:
 *   %t  const char *                  plain text; characters special to XML are escaped
 *   %s  const char *                  markup, copied unchanged
 *   %d  int                           integer
 *   %f  double                        coordinate in a picture, with one decimal
 *   %n  double                        number with four significant digits; a dash for NaN
 *   %r  double                        condition number or residual, two digits; a dash if negative
 *       (not checked)
 *   %p  double                        fraction, written in percent
 *   %b  double, double                fraction in percent, with a bar; fraction of a full bar
 *   %q  double, const char *          quantity and unit; lengths in the most readable unit
 *   %a  double, double, const char *  quantity, largest quantity of the table column (decides the
 *       written unit), unit
 *   %u  const char *                  unit
 *   %l  const double *, const char *  lower and upper limit [2], unit; a dash for no limits
 */
void put(FILE *file, const char *format, ...);

/*
 * Write a format like the function put. In a row of a table '|' separates the cells.
 *   cell  in  HTML tag of the first cell, which the caller has opened; further cells have the tag
 *       td, in a heading row (tag th scope="col") the same. NULL: the text is no row of a table
 */
void put_list(FILE *file, const char *format, const char *cell, va_list *more);

/*
 * Write a row of a table. In the format, '|' separates the cells; a cell that begins with '<' is
 * aligned to the left, and one that begins with '~' may wrap.
 */
void put_row(FILE *file, const char *format, ...);

/*
 * put_table begins an HTML table, and put_table_end ends it. On a narrow page the table can be
 * scrolled on its own. The caption and the heading cells, separated by '|' ("" for no heading), are
 * formats; the values of their directives follow.
 */
void put_table(FILE *file, const char *caption, const char *head, ...);
void put_table_end(FILE *file);

/*
 * The unit in which a quantity is most readable, and the factor that converts into it: nm, um, mm
 * or m for lengths, otherwise the unit itself. `most` is the largest absolute value to be written.
 */
typedef struct put_unit {
    double factor;
    const char *name;
} put_unit;
put_unit put_unit_of(double most, const char *unit);

#endif
