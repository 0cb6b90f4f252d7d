/* SPDX-License-Identifier: BSD-2-Clause */
/* Natural frequencies and the stability of the control loop on standard output. */
#ifndef PRINT_VIBRATION_H
#define PRINT_VIBRATION_H

#include "../model/certificate.h"
#include "../text/json.h"

/* Modes of `pzs modes`: frequency, mass that takes part, and the input that moves each most. */
void print_vibration(const design *design, const vibration *vibration);
void print_vibration_json(const design *design, const vibration *vibration);

/*
 * First frequency and verdict on the loop, or why they are not known; nothing where
 * certificate_make has not run.
 */
void print_certificate(const certificate *certificate);
void print_certificate_json(json *json, const certificate *certificate);

#endif
