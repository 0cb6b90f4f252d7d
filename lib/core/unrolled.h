/* UNROLLED before a loop of a constant, small count: its sums are then held in registers. Only
 * speed depends on it. */
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
