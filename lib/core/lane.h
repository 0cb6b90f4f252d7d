/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vector types of gcc and clang, for builds that compute more than four matrix entries side by side
 * (PZS_TILE). Each entry of a vector is computed like a single number, so that the bits of a result
 * do not depend on the vector width.
 */
#ifndef PZS_LIB_LANE_H
#define PZS_LIB_LANE_H

#include "pzs_base.h"

#if PZS_TILE > 4

/*
 * LANE_BYTES: size in bytes of a vector for parallel arithmetic, the smaller of a processor
 * register and PZS_TILE reals. IN_LANE: number of reals in such a vector. IN_TILE: number of such
 * vectors that hold PZS_TILE reals.
 */
#if defined(__AVX512F__)
#define REGISTER 64u
#elif defined(__AVX__)
#define REGISTER 32u
#else
#define REGISTER 16u
#endif
#define LANE_BYTES (REGISTER < PZS_TILE * sizeof(pzs_real) ? REGISTER : PZS_TILE * sizeof(pzs_real))
#define IN_LANE (LANE_BYTES / sizeof(pzs_real))
#define IN_TILE (PZS_TILE / IN_LANE)
typedef pzs_real lane
    __attribute__((vector_size(LANE_BYTES), aligned(sizeof(pzs_real)), may_alias));

#endif
#endif
