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

#define BOXLS_VECTORS 14u /* of width entries each */

/* Whether the machine works on whole vectors: only speed depends on it. */
#define BOXLS_WIDE (PZS_TILE > 4)

typedef pzs_optimiser boxls;

/* Point all vectors but v into work [BOXLS_VECTORS][width]; n and width are set. */
void boxls_place(boxls *b, pzs_real *work);

#define BOXLS_DEPENDENT 256 /* most that floor may grow, over its start 4 n epsilon */

/* grad from pull, its part on F in next; and the same with pull and rough from H. */
void boxls_gradient(boxls *b);
void boxls_true_gradient(boxls *b);

/* move from grad, its part in next and the tableau; next = v after it. Returns how many inputs that leaves unsettled. */
uint32_t boxls_aim(boxls *b, pzs_real noise);

/* Cut volts that are outside to lo..hi; returns nonzero where some were, with the true gradient there. */
int boxls_come_inside(boxls *b);

/* From a gradient to the optimum; adds to used, sets left, noise and done. Volts come inside lo..hi and stay there. */
void boxls_optimise(boxls *b);

/* Largest violated optimality condition at v, where the gradient is grad; uses spare. */
pzs_real boxls_violation(const boxls *b, const pzs_real *v, const pzs_real *grad);

/* Whether rounding in H (v - base) may cost more than epsilon of the energy. */
int boxls_coarse(boxls *b);

/*
 * How far loops over entries go. For vectors it is the width, which is whole tiles: a loop over so many has no
 * remainder, which this tells the compiler.
 */
static inline size_t boxls_span(const boxls *b)
{
    return BOXLS_WIDE ? b->width & ~(PZS_TILE - 1u) : b->n;
}

static inline pzs_real boxls_size(pzs_real x)
{
    return PZS_ABS(x);
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
