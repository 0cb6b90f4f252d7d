/* Outputs along mesh lines as curves, for the page of `pzs solve`. */
#ifndef REPORT_LINES_H
#define REPORT_LINES_H

#include <stdio.h>
#include "../model/analysis.h"

/* A section of the page with a picture for each coordinate that outputs run along; nothing where
 * none does. output as in report_solve */
void lines_section(FILE *file, const analysis *analysis, const double *output);

#endif
