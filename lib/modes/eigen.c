/* SPDX-License-Identifier: BSD-2-Clause */
/* Eigenvalues of small dense symmetric matrices by Jacobi's method (eigen.h). */
#include "eigen.h"
#include <string.h>

#if PZS_MODES

/* Rotate the pair (x, y) by the angle with cosine c and sine s. */
static void rotate_pair(pzs_real *x, pzs_real *y, pzs_real c, pzs_real s)
{
    const pzs_real before = *x;
    *x = c * before - s * *y;
    *y = s * before + c * *y;
}

/*
 * Rotate rows and columns p and q of the symmetric matrix a [n][n] so that its entry (p, q) becomes
 * 0, and apply the rotation to the columns of the eigenvector matrix v [n][n].
 */
static void rotate(pzs_real *a, pzs_real *v, size_t n, size_t p, size_t q)
{
    const pzs_real theta = (a[q * n + q] - a[p * n + p]) / (2 * a[p * n + q]);
    const pzs_real sign = theta < 0 ? -1 : 1;
    const pzs_real t = sign / (PZS_ABS(theta) + PZS_SQRT(theta * theta + 1)),
                   c = 1 / PZS_SQRT(t * t + 1), s = t * c;
    for (size_t i = 0; i < n; i++) {
        rotate_pair(&a[i * n + p], &a[i * n + q], c, s);
        rotate_pair(&v[i * n + p], &v[i * n + q], c, s);
    }
    for (size_t i = 0; i < n; i++)
        rotate_pair(&a[p * n + i], &a[q * n + i], c, s);
}

/* Run one sweep over all entries above the diagonal. Returns whether any was not negligible. */
static bool sweep(pzs_real *a, pzs_real *v, size_t n, pzs_real negligible)
{
    bool has_rotated = false;
    for (size_t p = 0; p < n; p++)
        for (size_t q = p + 1; q < n; q++)
            if (PZS_ABS(a[p * n + q]) > negligible) {
                rotate(a, v, n, p, q);
                has_rotated = true;
            }
    return has_rotated;
}

void pzs_eigen_symmetric(pzs_real *a, pzs_real *v, size_t n, int sweeps, pzs_real negligible)
{
    memset(v, 0, n * n * sizeof *v);
    for (size_t i = 0; i < n; i++)
        v[i * n + i] = 1;
    bool has_rotated = true;
    for (int i = 0; i < sweeps && has_rotated; i++)
        has_rotated = sweep(a, v, n, negligible);
}

#endif
