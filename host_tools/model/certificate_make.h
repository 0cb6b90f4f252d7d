/* SPDX-License-Identifier: BSD-2-Clause */
/* Computation of the stability of a scene's control loop, whose result is its certificate. */
#ifndef CERTIFICATE_MAKE_H
#define CERTIFICATE_MAKE_H

#include "analysis.h"

/*
 * Compute the vibration modes of the scene and the stability of its control loop in the reference
 * state, unless the certificate has them. What is unknown, and why, is stored in the certificate;
 * it is no error.
 *   analysis in  analysis of the scene in the reference state; a target needs the influence matrix,
 *       not yet replaced by that of the deformed structure
 */
void certificate_make(certificate *certificate, const analysis *analysis);

#endif
