/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * All compile-time options of piezoshape, with their defaults. Set an option with -DNAME=value, for
 * the library and the program alike. The names of the init functions contain the precision, so a
 * program and a library of different precision do not link.
 */
#ifndef PZS_CONFIG_H
#define PZS_CONFIG_H

/* Bits of a real number: 32 (float) or 64 (double). */
#ifndef PZS_REAL_BITS
#define PZS_REAL_BITS 64
#endif

/*
 * 1 builds the nonlinear image: element at a deformed shape, equilibrium solver, contact, follower
 * loads and open electrodes.
 */
#ifndef PZS_NONLINEAR
#define PZS_NONLINEAR 0
#endif

/*
 * Rows of a panel of the factor: 4 suits microcontrollers, 8 and 16 suit wide vector units (gcc or
 * clang). With -ffp-contract=off (the default of gcc with -std=c99, to be set for clang) the result
 * has the same bits for every value.
 */
#ifndef PZS_TILE
#define PZS_TILE 4
#endif

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "piezoshape needs NaN and infinity: do not use -ffast-math, -Ofast, -ffinite-math-only"
#endif
#if PZS_REAL_BITS != 32 && PZS_REAL_BITS != 64
#error "PZS_REAL_BITS is 32 or 64"
#endif
#if PZS_TILE != 4 && PZS_TILE != 8 && PZS_TILE != 16
#error "PZS_TILE is 4, 8 or 16"
#endif

#endif
