/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The voltage optimiser (boxls.c) and its tableau (boxls_tableau.c), compiled a second time for
 * processors with AVX2 (option PZS_WIDE), where pzs_boxls_optimise calls this version. Fused
 * multiply-adds, which round differently, are not used, so that the voltages have the same bits.
 */
#include "pzs_control.h"

#if PZS_WIDE

#define IS_WIDE true

#define pzs_tableau_independence pzs_tableau_independence_wide
#define pzs_tableau_read_pivots pzs_tableau_read_pivots_wide
#define pzs_tableau_row pzs_tableau_row_wide
#define pzs_tableau_exchange pzs_tableau_exchange_wide
#define pzs_tableau_apply pzs_tableau_apply_wide
#define pzs_tableau_complete pzs_tableau_complete_wide
#define pzs_tableau_reset pzs_tableau_reset_wide
#define pzs_tableau_collect pzs_tableau_collect_wide
#define pzs_tableau_rebuild pzs_tableau_rebuild_wide
#define pzs_tableau_inverse_trace pzs_tableau_inverse_trace_wide

#define pzs_boxls_place pzs_boxls_place_wide
#define pzs_boxls_gradient pzs_boxls_gradient_wide
#define pzs_boxls_true_gradient pzs_boxls_true_gradient_wide
#define pzs_boxls_find_direction pzs_boxls_find_direction_wide
#define pzs_boxls_enforce_limits pzs_boxls_enforce_limits_wide
#define pzs_boxls_optimise pzs_boxls_optimise_wide
#define pzs_boxls_has_decreased pzs_boxls_has_decreased_wide
#define pzs_boxls_shorten pzs_boxls_shorten_wide
#define pzs_boxls_violation pzs_boxls_violation_wide
#define pzs_boxls_needs_new_base pzs_boxls_needs_new_base_wide

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC optimize("O3", "no-trapping-math")
#pragma GCC target("avx2")
#endif

/* Products compiled for AVX2, without asking the processor again whether it has AVX2. */
#include "../core/product.h"
#include "../core/product_inline.h"
#define pzs_product_dot product_dot
#define pzs_product_dot_size product_dot_size
#define pzs_product_largest product_largest
#define pzs_product_sum_rows pzs_wide_sum_rows
#define pzs_product_subtract_rows pzs_wide_subtract_rows

#include "boxls_tableau.c"
#undef TOGETHER
#include "boxls.c"

#if defined(__clang__)
#pragma clang attribute pop
#endif

#endif
