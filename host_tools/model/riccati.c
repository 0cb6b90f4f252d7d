/* SPDX-License-Identifier: BSD-2-Clause */
/* Discrete algebraic Riccati equation by structured doubling (riccati.h). */
#include "riccati.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "dense.h"

enum { DOUBLINGS = 60 };

/* Relative change of the solution at which the doubling iteration has converged. */
static const double converged = 1e-14;

int riccati_open(riccati *riccati, size_t order)
{
    double **const all[] = {&riccati->a,    &riccati->g,  &riccati->h,    &riccati->w,
                            &riccati->work, &riccati->aw, &riccati->other};
    const size_t count = sizeof all / sizeof *all;
    riccati->order = order;
    riccati->memory = calloc(count * order * order + 1, sizeof *riccati->memory);
    for (size_t i = 0; i < count && riccati->memory; i++)
        *all[i] = riccati->memory + i * order * order;
    return riccati->memory ? 0 : -1;
}

/*
 * Add the increment `next` to the matrix h, the iterate of the Riccati equation's doubling
 * iteration. Returns the largest entry of the increment relative to the largest entry of h, or NAN
 * where an entry is not finite.
 */
static double add_change(riccati *riccati, const double *next)
{
    double change = 0, size = 0;
    for (size_t i = 0; i < riccati->order * riccati->order; i++) {
        riccati->h[i] += next[i];
        change = fmax(change, fabs(next[i]));
        size = fmax(size, fabs(riccati->h[i]));
        if (!isfinite(riccati->h[i]))
            return (double)NAN;
    }
    dense_symmetrise(riccati->h, riccati->order);
    return size > 0 ? change / size : 0;
}

/*
 * Do one iteration of the structured doubling. Returns the relative change of h, or NAN where a
 * matrix is singular.
 *   h becomes h + a' h w a,  g becomes g + a w g a',  a becomes a w a,  with w = (1 + g h)^-1.
 */
static double double_once(riccati *riccati)
{
    const size_t order = riccati->order;
    dense_multiply(riccati->work, riccati->g, riccati->h, order, false);
    for (size_t i = 0; i < order; i++)
        riccati->work[i * order + i] += 1;
    if (dense_invert(riccati->work, riccati->w, order) != 0)
        return (double)NAN;
    dense_multiply(riccati->aw, riccati->a, riccati->w, order, false);
    dense_multiply(riccati->work, riccati->w, riccati->a, order, false);
    dense_multiply(riccati->other, riccati->h, riccati->work, order, false);
    dense_multiply(riccati->work, riccati->a, riccati->other, order, true);
    const double change = add_change(riccati, riccati->work);
    dense_multiply(riccati->work, riccati->aw, riccati->g, order, false);
    for (size_t i = 0; i < order; i++)
        for (size_t j = 0; j < order; j++)
            for (size_t k = 0; k < order; k++)
                riccati->g[i * order + j] +=
                    riccati->work[i * order + k] * riccati->a[j * order + k];
    dense_symmetrise(riccati->g, order);
    dense_multiply(riccati->work, riccati->aw, riccati->a, order, false);
    memcpy(riccati->a, riccati->work, order * order * sizeof *riccati->a);
    return change;
}

int riccati_solve(riccati *riccati)
{
    double change = 1;
    for (int i = 0; i < DOUBLINGS && change > converged; i++)
        change = double_once(riccati);
    return change <= 100 * converged ? 0 : -1;
}

void riccati_close(riccati *riccati)
{
    free(riccati->memory);
}
