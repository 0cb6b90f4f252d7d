/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Pseudo-random numbers that are bit-identical on every computer, because no function of the
 * mathematical library is used.
 */
#ifndef RANDOM_H
#define RANDOM_H

#include <stdint.h>

/*
 * Next 64 bits of the generator splitmix64.
 *   state in/out  state of the generator; its first value is the seed
 */
uint64_t random_bits(uint64_t *state);

/* Pseudo-random number with uniform distribution in [0, 1). */
double random_uniform(uint64_t *state);

/* Pseudo-random integer from 0 to count - 1. */
int random_int(uint64_t *state, int count);

/* Pseudo-random number with mean 0 and variance 1: the sum of twelve uniform numbers minus six. */
double random_noise(uint64_t *state);

#endif
