/* The tableau of the voltage optimiser (boxls_tableau.h). */
#include <string.h>
#include "boxls_tableau.h"
#include "../core/numbers.h"
#include "../core/product.h"

pzs_real pzs_tableau_independence(const pzs_optimiser *b, uint32_t k)
{
    return b->diagonal[k] > 0 ? b->tableau[(size_t)k * b->width + k] / b->diagonal[k] : 0;
}

/* z = factor x. */
static void multiple(pzs_real *restrict z, const pzs_real *restrict x, pzs_real factor, size_t span)
{
    for (size_t i = 0; i < span; i++)
        z[i] = factor * x[i];
}

/* m -= sign s s', symmetric to the last bit. Without vectors one half is computed and mirrored. */
static void rank_one(const pzs_optimiser *b, pzs_real *restrict m, const pzs_real *restrict s,
                     pzs_real sign)
{
    const size_t span = optimiser_span(b), stride = b->width;
    for (uint32_t i = 0; i < b->inputs; i++) {
        pzs_real *row = m + i * stride;
        const pzs_real f = sign * s[i];
        for (size_t j = 0; j < (OPTIMISER_WIDE ? span : i + 1u); j++) {
            row[j] -= f * s[j];
            if (!OPTIMISER_WIDE)
                m[j * stride + i] = row[j];
        }
    }
}

void pzs_tableau_sweep(pzs_optimiser *b, uint32_t k)
{
    pzs_real *row = b->tableau + (size_t)k * b->width, *s = b->scratch;
    const pzs_real pivot = row[k], scale = 1 / PZS_SQRT(number_absolute(pivot));
    multiple(s, row, scale, optimiser_span(b));
    rank_one(b, b->tableau, s, pivot < 0 ? (pzs_real)-1 : (pzs_real)1);
    multiple(row, s, scale, optimiser_span(b));
    row[k] = -1 / pivot;
    for (uint32_t j = 0; j < b->inputs; j++)
        b->tableau[(size_t)j * b->width + k] = row[j];
    b->free_set[k] = 1 - b->free_set[k];
    b->active_count = b->free_set[k] > 0 ? b->active_count - 1u : b->active_count + 1u;
    b->inverse_trace = 0;
    b->is_verified = false;
}

/* Most independent active input that is still marked in `direction`, or the number of inputs. */
static uint32_t next_pivot(const pzs_optimiser *b)
{
    pzs_real most = b->pivot_floor;
    uint32_t next = b->inputs;
    for (uint32_t k = 0; k < b->inputs; k++) {
        const pzs_real part = b->direction[k] > 0 ? pzs_tableau_independence(b, k) : 0;
        next = part > most ? k : next;
        most = part > most ? part : most;
    }
    return next;
}

void pzs_tableau_rebuild(pzs_optimiser *b)
{
    memcpy(b->tableau, b->hessian, (size_t)b->inputs * b->width * sizeof(pzs_real));
    memcpy(b->direction, b->free_set, b->width * sizeof(pzs_real));
    memset(b->free_set, 0, b->width * sizeof(pzs_real));
    b->active_count = b->inputs;
    b->inverse_trace = 0;
    b->is_verified = false;
    uint32_t k = next_pivot(b);
    for (uint32_t count = 0; count < b->inputs && k < b->inputs; count++) {
        pzs_tableau_sweep(b, k);
        b->direction[k] = 0;
        k = next_pivot(b);
    }
}

pzs_real pzs_tableau_inverse_trace(pzs_optimiser *b)
{
    if (b->inverse_trace > 0)
        return b->inverse_trace;
    pzs_real *pivot = b->scratch;
    for (uint32_t i = 0; i < b->inputs; i++)
        pivot[i] = b->tableau[(size_t)i * b->width + i];
    pzs_real soft = -pzs_product_dot(b->free_set, pivot, b->width);
    for (uint32_t i = 0; b->active_count > 0 && i < b->inputs; i++) {
        const pzs_real least = b->pivot_floor * b->diagonal[i];
        if ((pivot[i] < least) & !(b->free_set[i] > 0))
            soft += 1 / least;
    }
    b->inverse_trace = soft;
    return soft;
}
