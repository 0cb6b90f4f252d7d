/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Damped wish: the control step with the target minus the shape of the modes times damping factor
 * and velocity over angular frequency. The best damping factor of a mode, up to 1, is the one with
 * which the mode dies fastest if its static equilibrium follows the target at once.
 */
#include "rival_wish.h"
#include <math.h>
#include <string.h>

enum { FACTORS = 200 }; /* number of damping factors up to 1 that are tried */

/* Spectral radius of a real 2 x 2 matrix. */
static double radius(const double a[4])
{
    const double half = (a[0] + a[3]) / 2, determinant = a[0] * a[3] - a[1] * a[2],
                 root = half * half - determinant;
    return root < 0 ? sqrt(determinant) : fabs(half) + sqrt(root);
}

/*
 * Damping factor up to 1 with which a mode of propagator r dies fastest: the equilibrium moves by
 * minus the factor times the velocity p, thus d + 1 and p of the next tick by (r0 - 1) factor p and
 * r2 factor p.
 */
static double best_factor(const double r[4])
{
    double best = 0, least = HUGE_VAL;
    for (int k = 0; k <= FACTORS; k++) {
        const double factor = (double)k / FACTORS;
        const double moved[4] = {r[0], r[1] + (r[0] - 1) * factor, r[2], r[3] + r[2] * factor};
        const double size = radius(moved);
        if (size < least - 1e-9) {
            least = size;
            best = factor;
        }
    }
    return best;
}

void wish_open(rival *rival)
{
    const damped_loop *loop = &rival->loop;
    const double cut = rival->settings.cut;
    for (size_t k = 0; k < loop->modes; k++) {
        const double angle = loop->structure->omega[k] * loop->interval;
        const double fade = cut > 0 ? fmin(fmax(2 - angle / cut, 0), 1) : 1;
        double r[4];
        for (size_t i = 0; i < 4; i++)
            r[i] = loop->gains.turn[i * loop->modes + k];
        rival->feedback[k] = rival->settings.damping * fade * best_factor(r);
    }
}

void wish_change(const rival *rival, const pzs_real *wanted, pzs_real *changed)
{
    const modal_structure *structure = rival->loop.structure;
    const pzs_real *velocity = rival_estimates(rival)->velocity;
    memmove(changed, wanted, structure->outputs * sizeof *changed);
    for (size_t i = 0; i < structure->outputs; i++)
        for (size_t k = 0; k < rival->loop.modes; k++)
            changed[i] -=
                structure->shape[i * structure->modes + k] * rival->feedback[k] * velocity[k];
}
