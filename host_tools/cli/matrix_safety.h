/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Margin of a control loop against errors of its influence matrix (certificate_matrix.h): text,
 * JSON, warning and refusal, with the regularisation that gives the margin.
 */
#ifndef MATRIX_SAFETY_H
#define MATRIX_SAFETY_H

#include "../model/analysis.h"

/* Print the margin, in sentences; nothing where it was not computed. */
void print_matrix_errors(const certificate_matrix *matrix);

/* Write the margin as the JSON member `matrix_errors`. */
void print_matrix_errors_json(json *json, const certificate_matrix *matrix);

/* Add a warning where the margin is below its bar. */
void warn_of_matrix(analysis *analysis);

/*
 * Refuse a loop that grows with the errors that a measured matrix must be expected to have. Returns
 * 0, or -1 with error filled.
 */
int judge_matrix(const analysis *analysis, char *error);

#endif
