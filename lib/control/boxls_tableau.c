/* SPDX-License-Identifier: BSD-2-Clause */
/* The tableau of the voltage optimiser (boxls_tableau.h). */
#include <string.h>
#include "boxls_tableau.h"
#include "../core/numbers.h"
#include "../core/product.h"

pzs_real pzs_tableau_independence(const pzs_optimiser *optimiser, uint32_t k)
{
    return optimiser->diagonal[k] > 0
               ? optimiser->tableau[(size_t)k * optimiser->width + k] / optimiser->diagonal[k]
               : 0;
}

/* z = factor x. */
static void multiple(pzs_real *restrict z, const pzs_real *restrict x, pzs_real factor, size_t span)
{
    for (size_t i = 0; i < span; i++)
        z[i] = factor * x[i];
}

/* m -= sign s s', symmetric to the last bit. Without vectors one half is computed and mirrored. */
static void rank_one(const pzs_optimiser *optimiser, pzs_real *restrict m,
                     const pzs_real *restrict s, pzs_real sign)
{
    const size_t span = optimiser_span(optimiser), stride = optimiser->width;
    for (uint32_t i = 0; i < optimiser->inputs; i++) {
        pzs_real *row = m + i * stride;
        const pzs_real f = sign * s[i];
        for (size_t j = 0; j < (OPTIMISER_WIDE ? span : i + 1u); j++) {
            row[j] -= f * s[j];
            if (!OPTIMISER_WIDE)
                m[j * stride + i] = row[j];
        }
    }
}

void pzs_tableau_sweep(pzs_optimiser *optimiser, uint32_t k)
{
    pzs_real *row = optimiser->tableau + (size_t)k * optimiser->width, *s = optimiser->scratch;
    const pzs_real pivot = row[k], scale = 1 / PZS_SQRT(number_absolute(pivot));
    multiple(s, row, scale, optimiser_span(optimiser));
    rank_one(optimiser, optimiser->tableau, s, pivot < 0 ? (pzs_real)-1 : (pzs_real)1);
    multiple(row, s, scale, optimiser_span(optimiser));
    row[k] = -1 / pivot;
    for (uint32_t j = 0; j < optimiser->inputs; j++)
        optimiser->tableau[(size_t)j * optimiser->width + k] = row[j];
    optimiser->free_set[k] = 1 - optimiser->free_set[k];
    optimiser->active_count =
        optimiser->free_set[k] > 0 ? optimiser->active_count - 1u : optimiser->active_count + 1u;
    optimiser->inverse_trace = 0;
    optimiser->is_verified = false;
}

/* Most independent active input that is still marked in `direction`, or the number of inputs. */
static uint32_t next_pivot(const pzs_optimiser *optimiser)
{
    pzs_real most = optimiser->pivot_floor;
    uint32_t next = optimiser->inputs;
    for (uint32_t k = 0; k < optimiser->inputs; k++) {
        const pzs_real part =
            optimiser->direction[k] > 0 ? pzs_tableau_independence(optimiser, k) : 0;
        next = part > most ? k : next;
        most = part > most ? part : most;
    }
    return next;
}

void pzs_tableau_rebuild(pzs_optimiser *optimiser)
{
    memcpy(optimiser->tableau, optimiser->hessian,
           (size_t)optimiser->inputs * optimiser->width * sizeof(pzs_real));
    memcpy(optimiser->direction, optimiser->free_set, optimiser->width * sizeof(pzs_real));
    memset(optimiser->free_set, 0, optimiser->width * sizeof(pzs_real));
    optimiser->active_count = optimiser->inputs;
    optimiser->inverse_trace = 0;
    optimiser->is_verified = false;
    uint32_t k = next_pivot(optimiser);
    for (uint32_t count = 0; count < optimiser->inputs && k < optimiser->inputs; count++) {
        pzs_tableau_sweep(optimiser, k);
        optimiser->direction[k] = 0;
        k = next_pivot(optimiser);
    }
}

pzs_real pzs_tableau_inverse_trace(pzs_optimiser *optimiser)
{
    if (optimiser->inverse_trace > 0)
        return optimiser->inverse_trace;
    pzs_real *pivot = optimiser->scratch;
    for (uint32_t i = 0; i < optimiser->inputs; i++)
        pivot[i] = optimiser->tableau[(size_t)i * optimiser->width + i];
    pzs_real soft = -pzs_product_dot(optimiser->free_set, pivot, optimiser->width);
    for (uint32_t i = 0; optimiser->active_count > 0 && i < optimiser->inputs; i++) {
        const pzs_real least = optimiser->pivot_floor * optimiser->diagonal[i];
        if ((pivot[i] < least) & !(optimiser->free_set[i] > 0))
            soft += 1 / least;
    }
    optimiser->inverse_trace = soft;
    return soft;
}
