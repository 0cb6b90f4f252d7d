/*
 * piezoshape: shape control of piezoelectric shells in static memory. Includes every part:
 *
 *   pzs_control.h    control image: influence matrix to voltages inside limits; the tick
 *   pzs_loop.h       the tick as a list of blocks
 *   pzs_model.h      linear image: element matrices to the influence matrix, on the device
 *   pzs_nonlinear.h  nonlinear image (PZS_NONLINEAR=1): large rotation
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef PZS_H
#define PZS_H

#include "pzs_control.h"
#include "pzs_loop.h"
#include "pzs_model.h"
#include "pzs_nonlinear.h"

#endif
