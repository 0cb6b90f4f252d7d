/*
 * Every compile-time choice of piezoshape, with its default. Nothing else
 * is configured anywhere. Set one with -DNAME=value for the library and the
 * program alike; the precision is part of the names of the entry functions,
 * so a program and a library that disagree on it do not link.
 */
#ifndef PZS_CONFIG_H
#define PZS_CONFIG_H

/* Bits of the working real number: 32 (float) or 64 (double). */
#ifndef PZS_REAL_BITS
#define PZS_REAL_BITS 64
#endif

/* 1 builds the element at a deformed shape: strains quadratic in the displacement and their
 * tangent. */
#ifndef PZS_NONLINEAR
#define PZS_NONLINEAR 0
#endif

/* Rows of the factor kept together: 4 suits microcontrollers, 8 and 16 wide vector units (gcc or
 * clang). With -ffp-contract=off (gcc's default with -std=c99; clang wants it said) the result has
 * the same bits for every value. */
#ifndef PZS_TILE
#define PZS_TILE 4
#endif

/* Most passes of the voltage optimiser in one step; a step that needs more stops
 * with PZS_W_ITERATIONS, its volts allowed and no worse than before. */
#ifndef PZS_STEP_ITERATIONS
#define PZS_STEP_ITERATIONS 200
#endif

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error                                                                                             \
    "piezoshape relies on NaN and infinity: compile without -ffast-math, -Ofast and -ffinite-math-only"
#endif
#if PZS_STEP_ITERATIONS < 1 || PZS_STEP_ITERATIONS > 65535
#error "PZS_STEP_ITERATIONS is 1 to 65535"
#endif
#if PZS_REAL_BITS != 32 && PZS_REAL_BITS != 64
#error "PZS_REAL_BITS is 32 or 64"
#endif
#if PZS_TILE != 4 && PZS_TILE != 8 && PZS_TILE != 16
#error "PZS_TILE is 4, 8 or 16"
#endif

#endif
