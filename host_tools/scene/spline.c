/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Cubic splines (spline.h).
 * A coordinate is described by its values y_i and second derivatives m_i at the knots. They
 * minimise sum (p_i - y_i)^2 + lambda integral m^2 under one condition for each knot: a continuous
 * slope at inner knots, and the end conditions at the outer knots. The values, second derivatives
 * and Lagrange multipliers of the knots, interleaved, are the variables of one banded linear
 * system.
 */
#include "spline.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BAND = 7, ROW = 3 * BAND + 1, VALUE = 0, SECOND = 1, MULTIPLIER = 2 };

struct spline {
    int n;
    double *t;               /* chord length from the first point to each knot [n] */
    double (*y)[2], (*m)[2]; /* values and second derivatives at the knots [n] */
};

/*
 * Return the address of entry (i, j) of a banded matrix that has room for the fill-in of row
 * exchanges.
 */
static double *entry(double *band, int i, int j)
{
    return &band[(size_t)i * ROW + (size_t)(j - i + BAND)];
}

/*
 * Solve a banded linear system by Gaussian elimination with row exchanges.
 *   x  [rows][2] in: right-hand sides, out: solutions
 */
static void solve_band(double *band, double (*x)[2], int rows)
{
    for (int c = 0; c < rows; c++) {
        const int last = c + BAND < rows ? c + BAND : rows - 1;
        const int right = c + 2 * BAND < rows ? c + 2 * BAND : rows - 1;
        int pivot = c;
        for (int i = c + 1; i <= last; i++)
            if (fabs(*entry(band, i, c)) > fabs(*entry(band, pivot, c)))
                pivot = i;
        for (int j = c; j <= right && pivot != c; j++) {
            const double other = *entry(band, pivot, j);
            *entry(band, pivot, j) = *entry(band, c, j);
            *entry(band, c, j) = other;
        }
        for (int k = 0; k < 2; k++) {
            const double other = x[pivot][k];
            x[pivot][k] = x[c][k];
            x[c][k] = other;
        }
        for (int i = c + 1; i <= last; i++) {
            const double factor = *entry(band, i, c) / *entry(band, c, c);
            for (int j = c; j <= right; j++)
                *entry(band, i, j) -= factor * *entry(band, c, j);
            for (int k = 0; k < 2; k++)
                x[i][k] -= factor * x[c][k];
        }
    }
    for (int i = rows - 1; i >= 0; i--) {
        const int right = i + 2 * BAND < rows ? i + 2 * BAND : rows - 1;
        for (int k = 0; k < 2; k++) {
            for (int j = i + 1; j <= right; j++)
                x[i][k] -= *entry(band, i, j) * x[j][k];
            x[i][k] /= *entry(band, i, i);
        }
    }
}

/* Add a value to the coefficient of the variable `kind` of knot j in the condition of knot i. */
static void condition(double *band, int i, int j, int kind, double value)
{
    *entry(band, 3 * i + MULTIPLIER, 3 * j + kind) += value;
    *entry(band, 3 * j + kind, 3 * i + MULTIPLIER) += value;
}

/*
 * Add the slope of piece i (from knot i to i + 1) at its end `at` (i or i + 1), multiplied by sign,
 * to the condition of knot c.
 */
static void add_slope(double *band, const double *t, int c, int i, int at, double sign)
{
    const double h = t[i + 1] - t[i];
    condition(band, c, i, VALUE, -sign / h);
    condition(band, c, i + 1, VALUE, sign / h);
    condition(band, c, i, SECOND, at == i ? -sign * h / 3 : sign * h / 6);
    condition(band, c, i + 1, SECOND, at == i ? -sign * h / 6 : sign * h / 3);
}

/*
 * Add a not-a-knot condition: the third derivative is continuous at knot k, so that the two
 * adjacent pieces form one cubic.
 */
static void add_not_a_knot(double *band, const double *t, int c, int k)
{
    const double before = t[k] - t[k - 1], after = t[k + 1] - t[k];
    condition(band, c, k - 1, SECOND, -after);
    condition(band, c, k, SECOND, before + after);
    condition(band, c, k + 1, SECOND, -before);
}

static void fill_band(double *band, double (*x)[2], const spline *spline,
                      const double (*tangent)[2], double smoothing)
{
    const int n = spline->n;
    for (int i = 0; i < n; i++) {
        *entry(band, 3 * i + VALUE, 3 * i + VALUE) = 1;
        memcpy(x[3 * i + VALUE], spline->y[i], sizeof *x);
    }
    for (int i = 0; i < n - 1; i++) {
        const double h = smoothing * (spline->t[i + 1] - spline->t[i]);
        *entry(band, 3 * i + SECOND, 3 * i + SECOND) += h / 3;
        *entry(band, 3 * i + SECOND, 3 * i + 3 + SECOND) += h / 6;
        *entry(band, 3 * i + 3 + SECOND, 3 * i + SECOND) += h / 6;
        *entry(band, 3 * i + 3 + SECOND, 3 * i + 3 + SECOND) += h / 3;
    }
    for (int i = 1; i < n - 1; i++) {
        add_slope(band, spline->t, i, i - 1, i, -1);
        add_slope(band, spline->t, i, i, i, 1);
    }
    for (int end = 0; end < 2; end++) {
        const int c = end ? n - 1 : 0;
        if (!tangent) {
            add_not_a_knot(band, spline->t, c, end ? n - 2 : 1);
            continue;
        }
        add_slope(band, spline->t, c, end ? n - 2 : 0, c, 1);
        for (int k = 0; k < 2; k++)
            x[3 * c + MULTIPLIER][k] = tangent[end][k] / hypot(tangent[end][0], tangent[end][1]);
    }
}

/*
 * Fit a spline in lengths relative to the total length, so that the result is independent of the
 * unit of length.
 */
static int fit(spline *spline, const double (*tangent)[2], double smoothing)
{
    const int n = spline->n;
    const double whole = spline->t[n - 1];
    double *band = calloc((size_t)n * 3 * ROW, sizeof *band),
           (*x)[2] = calloc((size_t)n * 3, sizeof *x), sum = 0;
    if (band && x) {
        for (int i = 0; i < n; i++) {
            spline->t[i] /= whole;
            for (int k = 0; k < 2; k++)
                spline->y[i][k] /= whole;
        }
        fill_band(band, x, spline, tangent, smoothing / whole / whole / whole);
        solve_band(band, x, 3 * n);
        for (int i = 0; i < n; i++) {
            spline->t[i] *= whole;
            for (int k = 0; k < 2; k++) {
                spline->y[i][k] = whole * x[3 * i + VALUE][k];
                spline->m[i][k] = x[3 * i + SECOND][k] / whole;
                sum += spline->y[i][k] + spline->m[i][k];
            }
        }
    }
    const int good = band && x && isfinite(sum);
    free(band);
    free(x);
    return good;
}

static int start(spline *spline, int n, const double (*point)[2])
{
    spline->n = n;
    spline->t = calloc((size_t)n, sizeof *spline->t);
    spline->y = calloc((size_t)n, sizeof *spline->y);
    spline->m = calloc((size_t)n, sizeof *spline->m);
    if (!spline->t || !spline->y || !spline->m)
        return 0;
    memcpy(spline->y, point, (size_t)n * sizeof *spline->y);
    for (int i = 1; i < n; i++) {
        spline->t[i] =
            spline->t[i - 1] + hypot(point[i][0] - point[i - 1][0], point[i][1] - point[i - 1][1]);
        if (!(spline->t[i] > spline->t[i - 1]))
            return 0;
    }
    return 1;
}

spline *spline_fit(int n, const double (*point)[2], const double (*tangent)[2], double smoothing)
{
    spline *spline = calloc(1, sizeof *spline);
    if (spline && start(spline, n, point) && fit(spline, tangent, smoothing))
        return spline;
    spline_free(spline);
    return NULL;
}

void spline_free(spline *spline)
{
    if (!spline)
        return;
    free(spline->t);
    free(spline->y);
    free(spline->m);
    free(spline);
}

double spline_length(const spline *spline)
{
    return spline->t[spline->n - 1];
}

/* Return the index of the piece that contains the parameter t. */
static int piece(const spline *spline, double t)
{
    int low = 0, high = spline->n - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (spline->t[middle] <= t)
            low = middle;
        else
            high = middle;
    }
    return low;
}

double spline_next_knot(const spline *spline, double t)
{
    if (t < spline->t[0])
        return spline->t[0];
    const int low = piece(spline, t);
    return t < spline->t[low + 1] ? spline->t[low + 1] : HUGE_VAL;
}

void spline_at(const spline *spline, double t, double x[2], double d1[2], double d2[2])
{
    const int low = piece(spline, t), high = low + 1;
    const double h = spline->t[high] - spline->t[low], b = (t - spline->t[low]) / h, a = 1 - b;
    for (int k = 0; k < 2; k++) {
        const double y0 = spline->y[low][k], y1 = spline->y[high][k], m0 = spline->m[low][k],
                     m1 = spline->m[high][k];
        x[k] = a * y0 + b * y1 + h * h / 6 * ((a * a * a - a) * m0 + (b * b * b - b) * m1);
        d1[k] = (y1 - y0) / h + h / 6 * ((1 - 3 * a * a) * m0 + (3 * b * b - 1) * m1);
        d2[k] = a * m0 + b * m1;
    }
}
