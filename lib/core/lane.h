/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vectors of the compiler (gcc and clang) for builds with wide tiles. Their entries are computed
 * like single numbers, so the bits do not depend on their width.
 */
#ifndef PZS_LIB_LANE_H
#define PZS_LIB_LANE_H

#include "pzs_base.h"

#if PZS_TILE > 4

/* Entries that a vector register holds, or a tile if that is smaller. */
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
