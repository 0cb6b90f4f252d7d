/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Products of two vectors (product.h) as inline functions. A file that is compiled for wider
 * vectors of the processor includes them, so that they are compiled for these vectors, too. The
 * bits of the results are the same at any vector width.
 */
#ifndef PZS_LIB_PRODUCT_INLINE_H
#define PZS_LIB_PRODUCT_INLINE_H

#include "pzs_base.h"
#include "unrolled.h"

/*
 * PRODUCT_LANES: number of partial sums of a scalar product that are computed side by side.
 * PRODUCT_ADD_LANES: expression that adds the partial sums in the array `sum`, always in the same
 * order.
 */
#define PRODUCT_LANES 8u
#define PRODUCT_ADD_LANES(sum)                                                                     \
    (((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7])))

/*
 * Define a function that returns the sum of the expression TERM over the entries of two vectors,
 * with the same bits at any vector width. Entry i of each group of PRODUCT_LANES entries is added
 * to partial sum i. Zeros that pad the end of the vectors do not change the sum.
 */
#define PRODUCT_SUM_OF(name, TERM)                                                                 \
    static inline pzs_real name(const pzs_real *left, const pzs_real *right, size_t count)         \
    {                                                                                              \
        pzs_real sum[PRODUCT_LANES] = {0};                                                         \
        size_t i = 0;                                                                              \
        for (; i + PRODUCT_LANES <= count; i += PRODUCT_LANES) {                                   \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < PRODUCT_LANES; k++)                                           \
                sum[k] += TERM(left[i + k], right[i + k]);                                         \
        }                                                                                          \
        for (; i + 4u <= count; i += 4u) {                                                         \
            UNROLLED                                                                               \
            for (unsigned k = 0; k < 4u; k++)                                                      \
                sum[k] += TERM(left[i + k], right[i + k]);                                         \
        }                                                                                          \
        for (; i < count; i++)                                                                     \
            sum[0] += TERM(left[i], right[i]);                                                     \
        return PRODUCT_ADD_LANES(sum);                                                             \
    }

#define PRODUCT_TERM(x, y) (x) * (y)
#define PRODUCT_SIZE_TERM(x, y) (x) * PZS_ABS(y)
#define PRODUCT_SQUARE_TERM(x, y) ((x) * (y)) * ((x) * (y))
PRODUCT_SUM_OF(product_dot, PRODUCT_TERM)
PRODUCT_SUM_OF(product_dot_size, PRODUCT_SIZE_TERM)
PRODUCT_SUM_OF(product_energy, PRODUCT_SQUARE_TERM)

/*
 * Inline form of pzs_product_weigh (product.h): compute the differences of two vectors times
 * squared weights, and return their weighted sum of squares.
 */
static inline pzs_real product_weigh(pzs_real *restrict weighted_difference,
                                     const pzs_real *restrict weight, const pzs_real *restrict left,
                                     const pzs_real *restrict right, size_t count)
{
    pzs_real sum[PRODUCT_LANES] = {0};
    size_t i = 0;
    for (; i + PRODUCT_LANES <= count; i += PRODUCT_LANES) {
        UNROLLED
        for (unsigned k = 0; k < PRODUCT_LANES; k++) {
            const pzs_real miss = left[i + k] - right[i + k],
                           weighted = weight[i + k] * weight[i + k] * miss;
            weighted_difference[i + k] = weighted;
            sum[k] += weighted * miss;
        }
    }
    for (; i < count; i++) {
        const pzs_real miss = left[i] - right[i];
        weighted_difference[i] = weight[i] * weight[i] * miss;
        sum[0] += weighted_difference[i] * miss;
    }
    return PRODUCT_ADD_LANES(sum);
}

/*
 * Inline form of pzs_product_largest (product.h): return the largest entry of a vector, at least
 * zero.
 */
static inline pzs_real product_largest(const pzs_real *vector, size_t count)
{
    pzs_real s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    for (size_t i = 0; i < count; i += 4u) {
        s0 = vector[i] > s0 ? vector[i] : s0;
        s1 = vector[i + 1u] > s1 ? vector[i + 1u] : s1;
        s2 = vector[i + 2u] > s2 ? vector[i + 2u] : s2;
        s3 = vector[i + 3u] > s3 ? vector[i + 3u] : s3;
    }
    s0 = s1 > s0 ? s1 : s0;
    s2 = s3 > s2 ? s3 : s2;
    return s2 > s0 ? s2 : s0;
}

#endif
