/* SPDX-License-Identifier: BSD-2-Clause */
/* Products, lengths and scaling of vectors in space. */
#ifndef VECTOR_H
#define VECTOR_H

#include <math.h>

static inline double vector_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vector_length(const double vector[3])
{
    return sqrt(vector_dot(vector, vector));
}

/* Compute the cross product of two vectors in space. */
static inline void vector_cross(const double a[3], const double b[3], double product[3])
{
    for (int i = 0; i < 3; i++)
        product[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* Return the distance between two points in space. */
static inline double vector_distance(const double a[3], const double b[3])
{
    const double difference[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return vector_length(difference);
}

/*
 * Scale a vector to length 1. Returns its former length. A vector whose length is 0 or not finite
 * is not changed, and the function returns 0.
 */
static inline double vector_normalise(double vector[3])
{
    const double length = vector_length(vector);
    if (!(length > 0) || !isfinite(length))
        return 0;
    for (int i = 0; i < 3; i++)
        vector[i] /= length;
    return length;
}

#endif
