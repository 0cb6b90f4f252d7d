/* SPDX-License-Identifier: BSD-2-Clause */
/* Random numbers that are the same bits on every computer: no function of libm is used. */
#ifndef RANDOM_H
#define RANDOM_H

#include <stdint.h>

/* Next 64 bits of the generator splitmix64. state in/out; its first value is the seed */
uint64_t random_bits(uint64_t *state);

/* Uniform in [0, 1). */
double random_uniform(uint64_t *state);

/* Integer from 0 to count - 1. */
int random_int(uint64_t *state, int count);

/* Mean 0 and variance 1: the sum of twelve uniform numbers minus six. */
double random_noise(uint64_t *state);

#endif
