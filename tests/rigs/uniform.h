/*
 * Random numbers for tests, the same on every machine.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef UNIFORM_H
#define UNIFORM_H

/* Between lo and hi, 24 bits of it; the seed goes on. */
static inline double uniform(unsigned *seed, double lo, double hi)
{
    *seed = *seed * 1664525u + 1013904223u;
    return lo + (hi - lo) * (*seed >> 8) / 16777216.0;
}

#endif
