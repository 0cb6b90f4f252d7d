/* SPDX-License-Identifier: BSD-2-Clause */
/* Propagator of the free vibration of one vibration mode over an interval (propagator.h). */
#include "propagator.h"
#include <math.h>

/*
 * Compute two fundamental solutions of x'' + 2 damping w x' + w^2 x = 0 at w t = angle (angular
 * frequency w, time t): exponential decay times the cosine, and times the sine over the square root
 * of |1 - damping^2|; hyperbolic functions above critical damping.
 */
static void solutions(double damping, double angle, double *cosine, double *sine)
{
    const double square = 1 - damping * damping, root = sqrt(fabs(square));
    if (square > 0) {
        *cosine = exp(-damping * angle) * cos(root * angle);
        *sine = exp(-damping * angle) * sin(root * angle) / root;
        return;
    }
    const double slow = exp((root - damping) * angle), fast = exp(-(root + damping) * angle);
    *cosine = (slow + fast) / 2;
    *sine = root > 0 ? (slow - fast) / (2 * root) : angle * slow;
}

void modal_propagator(double frequency, double damping, double interval, double r[4])
{
    double c, s;
    solutions(damping, frequency * interval, &c, &s);
    r[0] = c + damping * s;
    r[1] = s;
    r[2] = -s;
    r[3] = c - damping * s;
}
