/*
 * Random numbers for tests, with the same values on every machine.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef UNIFORM_H
#define UNIFORM_H

/* Random number between lo and hi, of 24 random bits; the seed advances. */
static inline double uniform(unsigned *seed, double lo, double hi)
{
    *seed = *seed * 1664525u + 1013904223u;
    return lo + (hi - lo) * (*seed >> 8) / 16777216.0;
}

#endif
