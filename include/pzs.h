/*
 * piezoshape: shape control of piezoelectric shells in static memory. This header includes all
 * others. An image is the part of the library that a firmware uses:
 *
 *   pzs_control.h    control image: from an influence matrix to voltages inside limits
 *   pzs_loop.h       the control loop as a list of blocks
 *   pzs_calibrate.h  the influence matrix from voltages and readings, on the device
 *   pzs_model.h      linear image: from element matrices to the influence matrix, on the device
 *   pzs_nonlinear.h  nonlinear image (PZS_NONLINEAR=1): equilibrium at large rotation
 *   pzs_modes.h      option (PZS_MODES=1): natural frequencies and mode shapes
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef PZS_H
#define PZS_H

#include "pzs_calibrate.h"
#include "pzs_control.h"
#include "pzs_loop.h"
#include "pzs_model.h"
#include "pzs_nonlinear.h"
#include "pzs_modes.h"

#endif
