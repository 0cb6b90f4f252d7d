/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Cubic splines (spline.h) by least squares under linear conditions, one banded linear system for
 * each coordinate. The values y_i and second derivatives m_i at the knots minimise
 *   sum (p_i - y_i)^2 + lambda integral m^2
 * with the given points p_i and the smoothing lambda. Each knot has one condition with a Lagrange
 * multiplier: a continuous slope, or the end condition.
 */
#include "spline.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BAND = 7, ROW = 3 * BAND + 1, VALUE = 0, SECOND = 1, MULTIPLIER = 2 };

struct spline {
    int knots;
    double *parameter;   /* [knots] chord length from the first point to each knot */
    double (*value)[2];  /* [knots] the two coordinates of the spline curve at its knots */
    double (*second)[2]; /* [knots] second derivatives of the two coordinates of the spline curve at
                            its knots */
};

/*
 * Return the address of entry (i, j) of a banded matrix that is stored by rows with room for the
 * fill-in of row exchanges.
 */
static double *entry(double *band, int i, int j)
{
    return &band[(size_t)i * ROW + (size_t)(j - i + BAND)];
}

/*
 * Solve a banded linear system with two right-hand sides by Gaussian elimination with row
 * exchanges.
 *   band      in/out            matrix of BAND entries on each side of the diagonal, with room in
 *                               each row of ROW entries for the row exchanges; overwritten
 *   solution  [rows][2] in/out  right-hand sides, replaced by the solutions
 */
static void solve_band(double *band, double (*solution)[2], int rows)
{
    for (int column = 0; column < rows; column++) {
        const int last = column + BAND < rows ? column + BAND : rows - 1;
        const int right = column + 2 * BAND < rows ? column + 2 * BAND : rows - 1;
        int pivot = column;
        for (int i = column + 1; i <= last; i++)
            if (fabs(*entry(band, i, column)) > fabs(*entry(band, pivot, column)))
                pivot = i;
        for (int j = column; j <= right && pivot != column; j++) {
            const double other = *entry(band, pivot, j);
            *entry(band, pivot, j) = *entry(band, column, j);
            *entry(band, column, j) = other;
        }
        for (int k = 0; k < 2; k++) {
            const double other = solution[pivot][k];
            solution[pivot][k] = solution[column][k];
            solution[column][k] = other;
        }
        for (int i = column + 1; i <= last; i++) {
            const double factor = *entry(band, i, column) / *entry(band, column, column);
            for (int j = column; j <= right; j++)
                *entry(band, i, j) -= factor * *entry(band, column, j);
            for (int k = 0; k < 2; k++)
                solution[i][k] -= factor * solution[column][k];
        }
    }
    for (int i = rows - 1; i >= 0; i--) {
        const int right = i + 2 * BAND < rows ? i + 2 * BAND : rows - 1;
        for (int k = 0; k < 2; k++) {
            for (int j = i + 1; j <= right; j++)
                solution[i][k] -= *entry(band, i, j) * solution[j][k];
            solution[i][k] /= *entry(band, i, i);
        }
    }
}

/*
 * Add `value` to the factor of an unknown of knot j in the linear condition of knot i of a spline,
 * and to the transposed entry of the symmetric matrix. The unknowns of a knot are its ordinate,
 * second derivative and Lagrange multiplier.
 *   kind in  unknown of knot j: VALUE (ordinate) or SECOND (second derivative)
 */
static void condition(double *band, int i, int j, int kind, double value)
{
    *entry(band, 3 * i + MULTIPLIER, 3 * j + kind) += value;
    *entry(band, 3 * j + kind, 3 * i + MULTIPLIER) += value;
}

/*
 * Add the slope of a cubic piece of a spline, multiplied by `sign`, to the linear equation that
 * belongs to a knot. The piece lies between the knots i and i + 1; its slope is taken at its end
 * `at` (i or i + 1).
 */
static void add_slope(double *band, const double *length, int knot, int i, int at, double sign)
{
    const double piece_length = length[i + 1] - length[i];
    condition(band, knot, i, VALUE, -sign / piece_length);
    condition(band, knot, i + 1, VALUE, sign / piece_length);
    condition(band, knot, i, SECOND, at == i ? -sign * piece_length / 3 : sign * piece_length / 6);
    condition(band, knot, i + 1, SECOND,
              at == i ? -sign * piece_length / 6 : sign * piece_length / 3);
}

/*
 * Add a not-a-knot condition: the third derivative is continuous at knot k, so that the two
 * adjacent pieces form one cubic.
 */
static void add_not_a_knot(double *band, const double *length, int knot, int k)
{
    const double before = length[k] - length[k - 1], after = length[k + 1] - length[k];
    condition(band, knot, k - 1, SECOND, -after);
    condition(band, knot, k, SECOND, before + after);
    condition(band, knot, k + 1, SECOND, -before);
}

static void fill_band(double *band, double (*solution)[2], const spline *spline,
                      const double (*tangent)[2], double smoothing)
{
    const int knots = spline->knots;
    for (int i = 0; i < knots; i++) {
        *entry(band, 3 * i + VALUE, 3 * i + VALUE) = 1;
        memcpy(solution[3 * i + VALUE], spline->value[i], sizeof *solution);
    }
    for (int i = 0; i < knots - 1; i++) {
        const double weight = smoothing * (spline->parameter[i + 1] - spline->parameter[i]);
        *entry(band, 3 * i + SECOND, 3 * i + SECOND) += weight / 3;
        *entry(band, 3 * i + SECOND, 3 * i + 3 + SECOND) += weight / 6;
        *entry(band, 3 * i + 3 + SECOND, 3 * i + SECOND) += weight / 6;
        *entry(band, 3 * i + 3 + SECOND, 3 * i + 3 + SECOND) += weight / 3;
    }
    for (int i = 1; i < knots - 1; i++) {
        add_slope(band, spline->parameter, i, i - 1, i, -1);
        add_slope(band, spline->parameter, i, i, i, 1);
    }
    for (int end = 0; end < 2; end++) {
        const int knot = end ? knots - 1 : 0;
        if (!tangent) {
            add_not_a_knot(band, spline->parameter, knot, end ? knots - 2 : 1);
            continue;
        }
        add_slope(band, spline->parameter, knot, end ? knots - 2 : 0, knot, 1);
        for (int k = 0; k < 2; k++)
            solution[3 * knot + MULTIPLIER][k] =
                tangent[end][k] / hypot(tangent[end][0], tangent[end][1]);
    }
}

/*
 * Fit a spline to its points in lengths relative to the total length, so that the result does not
 * depend on the unit of length. Returns 1, or 0 if memory runs out or a number is not finite.
 */
static int fit(spline *spline, const double (*tangent)[2], double smoothing)
{
    const int knots = spline->knots;
    const double whole = spline->parameter[knots - 1];
    double *band = calloc((size_t)knots * 3 * ROW, sizeof *band),
           (*solution)[2] = calloc((size_t)knots * 3, sizeof *solution), sum = 0;
    if (band && solution) {
        for (int i = 0; i < knots; i++) {
            spline->parameter[i] /= whole;
            for (int k = 0; k < 2; k++)
                spline->value[i][k] /= whole;
        }
        fill_band(band, solution, spline, tangent, smoothing / whole / whole / whole);
        solve_band(band, solution, 3 * knots);
        for (int i = 0; i < knots; i++) {
            spline->parameter[i] *= whole;
            for (int k = 0; k < 2; k++) {
                spline->value[i][k] = whole * solution[3 * i + VALUE][k];
                spline->second[i][k] = solution[3 * i + SECOND][k] / whole;
                sum += spline->value[i][k] + spline->second[i][k];
            }
        }
    }
    const int good = band && solution && isfinite(sum);
    free(band);
    free(solution);
    return good;
}

static int start(spline *spline, int knots, const double (*point)[2])
{
    spline->knots = knots;
    spline->parameter = calloc((size_t)knots, sizeof *spline->parameter);
    spline->value = calloc((size_t)knots, sizeof *spline->value);
    spline->second = calloc((size_t)knots, sizeof *spline->second);
    if (!spline->parameter || !spline->value || !spline->second)
        return 0;
    memcpy(spline->value, point, (size_t)knots * sizeof *spline->value);
    for (int i = 1; i < knots; i++) {
        spline->parameter[i] = spline->parameter[i - 1] +
                               hypot(point[i][0] - point[i - 1][0], point[i][1] - point[i - 1][1]);
        if (!(spline->parameter[i] > spline->parameter[i - 1]))
            return 0;
    }
    return 1;
}

spline *spline_fit(int knots, const double (*point)[2], const double (*tangent)[2],
                   double smoothing)
{
    spline *spline = calloc(1, sizeof *spline);
    if (spline && start(spline, knots, point) && fit(spline, tangent, smoothing))
        return spline;
    spline_free(spline);
    return NULL;
}

void spline_free(spline *spline)
{
    if (!spline)
        return;
    free(spline->parameter);
    free(spline->value);
    free(spline->second);
    free(spline);
}

double spline_length(const spline *spline)
{
    return spline->parameter[spline->knots - 1];
}

/*
 * Return the index of the cubic piece of a spline, between two successive knots, in which a
 * parameter value lies.
 */
static int piece(const spline *spline, double parameter)
{
    int low = 0, high = spline->knots - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (spline->parameter[middle] <= parameter)
            low = middle;
        else
            high = middle;
    }
    return low;
}

double spline_next_knot(const spline *spline, double parameter)
{
    if (parameter < spline->parameter[0])
        return spline->parameter[0];
    const int low = piece(spline, parameter);
    return parameter < spline->parameter[low + 1] ? spline->parameter[low + 1] : HUGE_VAL;
}

void spline_at(const spline *spline, double parameter, double x[2], double d1[2], double d2[2])
{
    const int low = piece(spline, parameter), high = low + 1;
    const double h = spline->parameter[high] - spline->parameter[low],
                 b = (parameter - spline->parameter[low]) / h, a = 1 - b;
    for (int k = 0; k < 2; k++) {
        const double y0 = spline->value[low][k], y1 = spline->value[high][k],
                     m0 = spline->second[low][k], m1 = spline->second[high][k];
        x[k] = a * y0 + b * y1 + h * h / 6 * ((a * a * a - a) * m0 + (b * b * b - b) * m1);
        d1[k] = (y1 - y0) / h + h / 6 * ((1 - 3 * a * a) * m0 + (3 * b * b - 1) * m1);
        d2[k] = a * m0 + b * m1;
    }
}
