/*
 * For tests of elements: layers from test data, assertions that arrays agree and that a free
 * element has six motions without energy. Include it after cmocka.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef ELEMENT_ASSERT_H
#define ELEMENT_ASSERT_H

#include <math.h>
#include <string.h>
#include "../../host_tools/scene/scene.h"

/*
 * Set layer i and its material, number i.
 *   data [17] in  thickness, angle, E (3), G (3), nu (3), d (3) and alpha (3)
 */
static inline void element_layer(scene_layer *layer, scene_material *material, int i,
                                 const double *data)
{
    memset(material, 0, sizeof *material);
    memcpy(material->e, data + 2, sizeof material->e);
    material->g12 = data[5];
    material->g13 = data[6];
    material->g23 = data[7];
    material->nu12 = data[8];
    material->nu13 = data[9];
    material->nu23 = data[10];
    material->has_d = true;
    material->d31 = data[11];
    material->d32 = data[12];
    material->d33 = data[13];
    memcpy(material->alpha, data + 14, sizeof material->alpha);
    memset(layer, 0, sizeof *layer);
    layer->material = i;
    layer->thickness = data[0];
    layer->angle = data[1];
    layer->poling = 3;
}

/* The largest difference over the largest reference value. */
static inline double apart(const double *x, const double *reference, int n)
{
    double largest = 0, difference = 0;
    for (int i = 0; i < n; i++) {
        largest = fmax(largest, fabs(reference[i]));
        difference = fmax(difference, fabs(x[i] - reference[i]));
    }
    return largest > 0 ? difference / largest : difference;
}

#define ASSERT_CLOSE(name, what, x, reference, n, tolerance)                                       \
    do {                                                                                           \
        const double gap = apart(x, reference, n);                                                 \
        if (!(gap <= (tolerance)))                                                                 \
            fail_msg("%s: %s is %.2e apart, more than %.2e", name, what, gap,                      \
                     (double)(tolerance));                                                         \
    } while (0)

/* Eigenvalues of a symmetric matrix a [n][n] by Jacobi rotations, left on its diagonal. */
static inline void eigenvalues(double *a, int n)
{
    for (int sweep = 0; sweep < 12; sweep++)
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) {
                if (fabs(a[p * n + q]) < 1e-300)
                    continue;
                const double t = (a[q * n + q] - a[p * n + p]) / (2 * a[p * n + q]);
                const double tangent = (t >= 0 ? 1 : -1) / (fabs(t) + sqrt(t * t + 1)),
                             c = 1 / sqrt(tangent * tangent + 1), s = tangent * c;
                for (int k = 0; k < n; k++) {
                    const double x = a[k * n + p], y = a[k * n + q];
                    a[k * n + p] = c * x - s * y;
                    a[k * n + q] = s * x + c * y;
                }
                for (int k = 0; k < n; k++) {
                    const double x = a[p * n + k], y = a[q * n + k];
                    a[p * n + k] = c * x - s * y;
                    a[q * n + k] = s * x + c * y;
                }
            }
}

/*
 * Assert that a stiffness matrix, scaled to a diagonal of 1, has six eigenvalues that are zero but
 * for rounding, and positive others.
 *   stiffness in  lower triangle of the n <= 28 rows, row by row
 */
static inline void assert_six_zero_modes(const double *stiffness, int n)
{
    double a[28 * 28], largest = 0;
    int zero = 0, positive = 0;
    for (int r = 0; r < n; r++)
        for (int c = 0; c < n; c++)
            a[r * n + c] = stiffness[r >= c ? r * (r + 1) / 2 + c : c * (c + 1) / 2 + r] /
                           sqrt(stiffness[r * (r + 3) / 2] * stiffness[c * (c + 3) / 2]);
    eigenvalues(a, n);
    for (int r = 0; r < n; r++)
        largest = fmax(largest, a[r * n + r]);
    for (int r = 0; r < n; r++) {
        zero += fabs(a[r * n + r]) < 1e-13 * largest * n;
        positive += a[r * n + r] > 1e-7 * largest;
    }
    assert_int_equal(zero, 6);
    assert_int_equal(positive, n - 6);
}

#endif
