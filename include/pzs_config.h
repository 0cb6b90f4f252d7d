/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * All compile-time options of piezoshape, with their defaults. Compile the library and the program
 * with the same -DNAME=value. The names of the init functions contain the precision, so that a
 * program does not link with a library of the other precision.
 */
#ifndef PZS_CONFIG_H
#define PZS_CONFIG_H

/* PZS_REAL_BITS: number of bits of a real number, 32 (float) or 64 (double). */
#ifndef PZS_REAL_BITS
#define PZS_REAL_BITS 64
#endif

/*
 * PZS_NONLINEAR: 1 builds the part of the library for large rotations (shell element at a deformed
 * shape, equilibrium solver, contact, follower loads, open electrodes); 0 leaves it out.
 */
#ifndef PZS_NONLINEAR
#define PZS_NONLINEAR 0
#endif

/*
 * PZS_MODES: 1 builds the part of the library for vibration modes (pzs_modes.h); 0 leaves it out.
 */
#ifndef PZS_MODES
#define PZS_MODES 0
#endif

/*
 * PZS_TILE: number of matrix rows that the factorisation processes together: 4 suits
 * microcontrollers, 8 and 16 the wide vector units of gcc and clang. The results have the same bits
 * for each of these numbers if the compiler does not contract floating-point operations
 * (-ffp-contract=off; gcc implies it by -std=c99).
 */
#ifndef PZS_TILE
#define PZS_TILE 4
#endif

/*
 * PZS_DUAL_INPUTS: number of inputs from which on the optimiser of the voltages uses its dual
 * active-set method (lib/control/boxls_dual.c), which is faster there and takes a quarter more
 * memory. A number above PZS_INPUT_LIMIT leaves the method out.
 */
#ifndef PZS_DUAL_INPUTS
#define PZS_DUAL_INPUTS 64u
#endif

/*
 * PZS_WIDE: 1 compiles the innermost loops of factorisations and products in double also for x86-64
 * processors with the vector unit AVX2, which the library looks for at run time. It is for hosts:
 * results have the same bits and take about half the time. It needs gcc or clang and PZS_TILE 4.
 */
#ifndef PZS_WIDE
#define PZS_WIDE 0
#endif

/*
 * PZS_VFP: 1 computes products of matrices and vectors with assembler instructions of the Arm
 * floating-point unit, to the same bits as the C code in about 0.6 times the instructions. Default:
 * 1 with gcc or clang, Thumb-2, an FPU, PZS_REAL_BITS 32 and PZS_TILE 4.
 */
#ifndef PZS_VFP
#if defined(__GNUC__) && defined(__thumb2__) && defined(__ARM_FP) && PZS_REAL_BITS == 32 &&        \
    PZS_TILE == 4
#define PZS_VFP 1
#else
#define PZS_VFP 0
#endif
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
#if PZS_WIDE && (PZS_REAL_BITS != 64 || PZS_TILE != 4 || !defined(__x86_64__))
#error "PZS_WIDE needs PZS_REAL_BITS 64, PZS_TILE 4 and an x86-64 processor"
#endif
#if PZS_VFP && (PZS_REAL_BITS != 32 || PZS_TILE != 4 || !defined(__thumb2__))
#error "PZS_VFP needs PZS_REAL_BITS 32, PZS_TILE 4 and a processor with Thumb-2 and an FPU"
#endif

#endif
