/* The tableau of the voltage optimiser (boxls_tableau.h). */
#include <string.h>
#include "boxls_tableau.h"
#include "product.h"

pzs_real tableau_own_part(const boxls *b, uint32_t k)
{
    return b->diag[k] > 0 ? b->m[(size_t)k * b->width + k] / b->diag[k] : 0;
}

/* z = factor x. */
static void multiple(pzs_real *restrict z, const pzs_real *restrict x, pzs_real factor, size_t span)
{
    for (size_t i = 0; i < span; i++)
        z[i] = factor * x[i];
}

/* m -= sign s s', symmetric to the last bit: without vectors half of it, mirrored. */
static void rank_one(const boxls *b, pzs_real *restrict m, const pzs_real *restrict s, pzs_real sign)
{
    const size_t span = boxls_span(b), stride = b->width;
    for (uint32_t i = 0; i < b->n; i++) {
        pzs_real *row = m + i * stride;
        const pzs_real f = sign * s[i];
        for (size_t j = 0; j < (BOXLS_WIDE ? span : i + 1u); j++) {
            row[j] -= f * s[j];
            if (!BOXLS_WIDE)
                m[j * stride + i] = row[j];
        }
    }
}

void tableau_sweep(boxls *b, uint32_t k)
{
    pzs_real *row = b->m + (size_t)k * b->width, *s = b->spare;
    const pzs_real pivot = row[k], scale = 1 / PZS_SQRT(boxls_size(pivot));
    multiple(s, row, scale, boxls_span(b));
    rank_one(b, b->m, s, pivot < 0 ? (pzs_real)-1 : (pzs_real)1);
    multiple(row, s, scale, boxls_span(b));
    row[k] = -1 / pivot;
    for (uint32_t j = 0; j < b->n; j++)
        b->m[(size_t)j * b->width + k] = row[j];
    b->free[k] = 1 - b->free[k];
    b->standing = b->free[k] > 0 ? b->standing - 1u : b->standing + 1u;
    b->soft = 0;
    b->proven = 0;
}

/* The most independent standing input whose move is marked, or n. */
static uint32_t next_pivot(const boxls *b)
{
    pzs_real most = b->floor;
    uint32_t next = b->n;
    for (uint32_t k = 0; k < b->n; k++) {
        const pzs_real part = b->move[k] > 0 ? tableau_own_part(b, k) : 0;
        next = part > most ? k : next;
        most = part > most ? part : most;
    }
    return next;
}

void tableau_rebuild(boxls *b)
{
    memcpy(b->m, b->h, (size_t)b->n * b->width * sizeof(pzs_real));
    memcpy(b->move, b->free, b->width * sizeof(pzs_real));
    memset(b->free, 0, b->width * sizeof(pzs_real));
    b->standing = b->n;
    b->soft = 0;
    b->proven = 0;
    uint32_t k = next_pivot(b);
    for (uint32_t count = 0; count < b->n && k < b->n; count++) {
        tableau_sweep(b, k);
        b->move[k] = 0;
        k = next_pivot(b);
    }
}

pzs_real tableau_softness(boxls *b)
{
    if (b->soft > 0)
        return b->soft;
    pzs_real *pivot = b->spare;
    for (uint32_t i = 0; i < b->n; i++)
        pivot[i] = b->m[(size_t)i * b->width + i];
    pzs_real soft = -product_dot(b->free, pivot, b->width);
    for (uint32_t i = 0; b->standing > 0 && i < b->n; i++) {
        const pzs_real least = b->floor * b->diag[i];
        if ((pivot[i] < least) & !(b->free[i] > 0))
            soft += 1 / least;
    }
    b->soft = soft;
    return soft;
}
