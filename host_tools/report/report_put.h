/* SPDX-License-Identifier: BSD-2-Clause */
/* Writing of escaped text, numbers and tables into HTML and SVG reports in UTF-8. */
#ifndef REPORT_PUT_H
#define REPORT_PUT_H

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
 *   |   begins a cell of a table row, and ^ a cell of its heading. A cell that begins with '<' is
 *       aligned to the left, and one that begins with '~' may wrap
 */
void put(FILE *file, const char *format, ...);

/*
 * Formats for the function put:
 *   PUT_TABLE      beginning of a table with a caption and heading cells; PUT_HEAD without cells
 *   PUT_ROW        row of a table; its first cell begins without '|'
 *   PUT_TABLE_END  end of a table. On a narrow page the table can be scrolled on its own
 *   PUT_TEXT       text in a picture, after a style class, x and y in pixels
 */
#define PUT_TABLE(caption, head) PUT_HEAD(caption) head "<tbody>\n"
#define PUT_HEAD(caption)                                                                          \
    "<figure class=\"table\"><figcaption>" caption                                                 \
    "</figcaption><div class=\"wide\" tabindex=\"0\"><table><thead><tr>"
#define PUT_ROW(cells) "<tr><th scope=\"row\">" cells "\n"
#define PUT_TABLE_END "</table></div></figure>\n"
#define PUT_TEXT(text) "<text class=\"%s\" x=\"%f\" y=\"%f\">" text "</text>\n"

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
