/* SPDX-License-Identifier: BSD-2-Clause */
/* Natural frequencies and the stability of the control loop on standard output. */
#ifndef PRINT_VIBRATION_H
#define PRINT_VIBRATION_H

#include "../model/loaded.h"
#include "../text/json.h"

/*
 * Print the results of `pzs modes`: natural frequency, participating mass, and the input that moves
 * each vibration mode most, then the estimated discretisation error of the frequencies, and
 * warnings.
 */
void print_vibration(const loaded_modes *modes);
void print_vibration_json(const loaded_modes *modes);

/*
 * Print which vibration modes the control tick damps and in how many simulated tests with fast
 * target jumps the shape settles, or why the tick has no vibration model.
 */
void print_vibration_summary(const certificate *certificate, bool is_quasi_static);

/*
 * Print the first natural frequency and the stability of the control loop, or why they could not be
 * computed. Nothing is printed before the stability has been computed.
 */
void print_certificate(const certificate *certificate);
void print_certificate_json(json *json, const certificate *certificate);

#endif
