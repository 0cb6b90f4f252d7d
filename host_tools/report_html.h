/* Words of the report pages: escaped text, numbers for people, the frame of a page and its style. */
#ifndef REPORT_HTML_H
#define REPORT_HTML_H

#include <stdio.h>

/* Levels of a colour scale: classes s0.. (signed: blue, neutral, orange) and v0.. (size: viridis). */
enum { HTML_LEVELS = 33 };

void html_begin(FILE *file, const char *title);
void html_end(FILE *file);

/* Text with the characters of the markup escaped, and control characters left out. */
void html_text(FILE *file, const char *text);

/* Four significant digits, a power of ten where it is long; a dash for NaN. */
void html_number(FILE *file, double value);

/* Two significant digits, for conditions and residuals. */
void html_rough(FILE *file, double value);

/* Number, space, unit. */
void html_quantity(FILE *file, double value, const char *unit);

/* Percent of a share, three significant digits. */
void html_percent(FILE *file, double share);

#endif
