/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Written before a loop with a small constant number of iterations, the macro UNROLLED asks the
 * compiler to unroll the loop, so that its sums stay in registers. UNROLLED_TWICE asks it to make
 * two iterations of a loop of any length at a time. Both affect only the speed.
 */
#ifndef PZS_LIB_UNROLLED_H
#define PZS_LIB_UNROLLED_H

#if defined(__clang__)
#define UNROLLED _Pragma("clang loop unroll(full)")
#define UNROLLED_TWICE _Pragma("clang loop unroll_count(2)")
#elif defined(__GNUC__)
#define UNROLLED _Pragma("GCC unroll 32")
#define UNROLLED_TWICE _Pragma("GCC unroll 2")
#else
#define UNROLLED
#define UNROLLED_TWICE
#endif

#endif
