/*
 * Box-constrained least squares: volts inside limits to the optimum, in passes that are each safe to stop after.
 *
 *   min (v - base)'H (v - base) / 2 + (bias - want)'(v - base),   lo <= v <= hi
 *
 * half of |W (B v - e)|^2 + effort |v - prefer|^2 but for a constant. H may be singular. Vectors are
 * [width], width = n rounded up to whole tiles; their entries from n on stay zero.
 */
#ifndef PZS_BOXLS_H
#define PZS_BOXLS_H

#include "pzs.h"

#define BOXLS_VECTORS 14u /* of width entries each, laid out by boxls_place */

typedef struct boxls {
    uint32_t n, width;
    uint32_t allowed, used; /* passes */
    const pzs_real *h;      /* [n][width] Hessian (m2/V2) */
    pzs_real *m;            /* [n][width] tableau */
    pzs_real *v;            /* volts */
    pzs_real *lo, *hi;      /* limits (V) */
    pzs_real *free;         /* 1 swept, 0 standing */
    pzs_real *base;         /* volts around which the gradient is known best (V) */
    pzs_real *bias;         /* effort (base - prefer) */
    pzs_real *want;         /* B'W^2 (e - B base) */
    pzs_real *pull;         /* H (v - base) */
    pzs_real *grad;         /* pull + bias - want, the gradient at v */
    pzs_real *move;         /* swept: way to go (V); standing: gradient after it */
    pzs_real *diag;         /* of H */
    pzs_real *start, *start_grad; /* of the round */
    pzs_real *next;         /* grad on F, 0 on S; after boxls_aim the volts aimed at */
    pzs_real *spare;
    pzs_real soft;          /* trace of the inverse of H on F (V2/m2), 0 where not known */
    pzs_real floor;         /* pivots below this part of their diagonal count as dependent */
    pzs_real rough;         /* epsilon times what rounding of pull is made of (m2/V) */
    pzs_real exact;         /* the same of want */
    pzs_real energy;        /* |W e|^2, the scale of the objective (m2) */
    pzs_real left;          /* largest violated optimality condition (m2/V) */
    pzs_real noise;         /* what of it may be rounding */
    int done;               /* nonzero at the optimum */
} boxls;

/* Point the vectors that the optimiser keeps into work [BOXLS_VECTORS][width]; n and width are set. */
void boxls_place(boxls *b, pzs_real *work);

/* y [cols] = sum over the rows of x_i times row i of a [rows][stride]. */
void boxls_sum_rows(pzs_real *restrict y, const pzs_real *restrict a, size_t stride, const pzs_real *restrict x, size_t rows,
                    size_t cols);

/* x . y; and the largest of x, not below zero: there n is a multiple of 4. */
pzs_real boxls_dot(const pzs_real *x, const pzs_real *y, size_t n);
pzs_real boxls_largest(const pzs_real *x, size_t n);

/* Sweep anew from H every input marked as swept. */
void boxls_rebuild(boxls *b);

/* grad from pull, its part on F in next; and the same with pull and rough from H. */
void boxls_gradient(boxls *b);
void boxls_true_gradient(boxls *b);

/* move from grad, its part in next and the tableau; next = v after it. Returns how many inputs that leaves unsettled. */
uint32_t boxls_aim(boxls *b, pzs_real noise);

/* From a true gradient to the optimum; adds to used, sets left, noise and done. Volts never leave lo..hi. */
void boxls_optimise(boxls *b);

/* Whether rounding in H (v - base) may cost more than epsilon of the energy. */
int boxls_coarse(boxls *b);

/* width, which is whole tiles: a loop over so many has no remainder, which this tells the compiler. */
static inline size_t boxls_whole(uint32_t width)
{
    return width & ~(PZS_TILE - 1u);
}

static inline pzs_real boxls_size(pzs_real x)
{
    return x < 0 ? -x : x;
}

static inline pzs_real boxls_cut(pzs_real x, pzs_real lo, pzs_real hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

static inline int boxls_finite(pzs_real x)
{
    const pzs_real none = x - x;
    return none <= 0;
}

#endif
