/* SPDX-License-Identifier: BSD-2-Clause */
/* Computation of the stability of a scene's control loop, whose result is its certificate. */
#ifndef CERTIFICATE_MAKE_H
#define CERTIFICATE_MAKE_H

#include "analysis.h"

/*
 * Compute the vibration modes of the scene and the stability of its control loop in the reference
 * state. A certificate that is already computed is not changed. A scene without modes or without a
 * control loop is not an error; members of the certificate say what is unknown and why.
 *   analysis in  analysis of the scene in the reference state; where the scene has a target, its
 *                influence matrix must be computed, and not yet be replaced by that of the deformed
 *                structure
 */
void certificate_make(certificate *certificate, const analysis *analysis);

#endif
