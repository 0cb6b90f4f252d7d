/* SPDX-License-Identifier: BSD-2-Clause */
/* What the results of all commands begin with, as text and as JSON. */
#ifndef PRINT_HEAD_H
#define PRINT_HEAD_H

#include "../model/estimator.h"
#include "../text/json.h"

/*
 * Print name, mesh and condition number of the scene, and what the sensors of its `estimate`
 * section observe.
 *   influence in  text that names the shape at which the influence matrix is computed
 */
void print_head(const analysis *analysis, const char *influence);

void print_head_json(json *json, const analysis *analysis);

/* Write how well the sensors determine the shape as the JSON member `estimate`. */
void print_estimate_json(json *json, const estimator *estimator);

#endif
