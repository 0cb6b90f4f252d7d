/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Written before a loop with a small constant number of iterations, the macro UNROLLED asks the
 * compiler to unroll the loop, so that its sums stay in registers. It affects only the speed.
 */
#ifndef PZS_LIB_UNROLLED_H
#define PZS_LIB_UNROLLED_H

#if defined(__clang__)
#define UNROLLED _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#define UNROLLED _Pragma("GCC unroll 32")
#else
#define UNROLLED
#endif

#endif
