/* Words of the report pages: escaped text, numbers for people, the frame of a page and its style.
 */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include <stdio.h>

/* Levels of a colour scale: classes s0.. (signed: blue, neutral, orange) and v0.. (size: viridis).
 */
enum { HTML_LEVELS = 33 };

void html_begin(FILE *file, const char *title);
void html_end(FILE *file);

/* Text with the characters of the markup escaped, and control characters left out. */
void html_text(FILE *file, const char *text);

/* Four significant digits, a power of ten where it is long; a dash for NaN. */
void html_number(FILE *file, double value);

/* Two significant digits, for conditions and residuals. */
void html_rough(FILE *file, double value);

/* Number, space, unit; the digits of a unit stand raised. */
void html_quantity(FILE *file, double value, const char *unit);

/* The same in the notation of `most`, the largest of a column or a pair: as a plain number, or with
 * its power of ten. */
void html_alike(FILE *file, double value, double most, const char *unit);

/* Space and unit, or nothing where there is no unit. */
void html_unit(FILE *file, const char *unit);

/* Percent of a share, three significant digits. */
void html_percent(FILE *file, double share);

/* A table that scrolls in a box of its own under its caption. caption and head (cells of the first
 * row) are markup, or NULL. */
void html_table_begin(FILE *file, const char *caption, const char *head);
void html_table_end(FILE *file);

#endif
