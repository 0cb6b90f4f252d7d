/* SPDX-License-Identifier: BSD-2-Clause */
/* Transverse stresses from equilibrium through the thickness (stress_equilibrium.h). */
#include "stress_equilibrium.h"
#include <math.h>
#include <string.h>
#include "stress_stencil.h"

/*
 * Number of unknowns in the correction of the transverse shear stresses: gradients of two normal
 * forces (11 and 22) and two bending moments (11 and 22), each along its own direction.
 */
enum { PATTERNS = 4 };

/*
 * Derivatives of the in-plane stresses 11, 22 and 12 along the two directions of principal
 * curvature, at each height at which stresses are recovered (Pa/m): [height][direction][component].
 */
typedef double gradient[STENCIL_SAMPLES][2][3];

/*
 * Transverse shear stresses s_13 and s_23 at each recovered height, times c_1^2 c_2 and c_2^2 c_1
 * (Pa). c_a = 1 + k_a z, with principal curvature k_a and height z, is a length along direction a
 * over that in the reference surface.
 */
typedef double profile[STENCIL_SAMPLES][2];

/* ---- integration through the thickness ---------------------------------------- */

/*
 * Compute the transverse shear stresses s_13 and s_23 from the gradient of the in-plane stresses:
 * integrate the equations of equilibrium (stress_equilibrium.h) from the inner face, where the
 * shear stresses are 0.
 *   out  c_1^2 c_2 s_13 and c_2^2 c_1 s_23 at every height; c_1, c_2: lengths at the height over
 *       those in the reference surface
 */
static void balance(const stress_field *field, const stencil *stencil, gradient slope, profile out)
{
    const int samples = field->layers * STRESS_HEIGHTS;
    for (int a = 0; a < 2; a++) {
        double rate[STENCIL_SAMPLES], sum[STENCIL_SAMPLES];
        for (int i = 0; i < samples; i++) {
            double c[2];
            stencil_stretches(field, stencil, i, c);
            const double along = slope[i][a][a] / c[a], across = slope[i][1 - a][2] / c[1 - a];
            rate[i] = -c[a] * c[a] * c[1 - a] * (along + across);
        }
        stencil_integrate(field, stencil->element, rate, sum);
        for (int i = 0; i < samples; i++)
            out[i][a] = sum[i];
    }
}

/*
 * For a profile of the transverse shear stresses 13 and 23 over the thickness, compute the values
 * at the outer face and the resultants.
 *   left [4] out  stresses 13 and 23 at the outer face of the laminate (Pa), then the shear forces
 *       per length of these two stresses (N/m)
 */
static void resultants_of(const stress_field *field, const stencil *stencil, profile values,
                          double left[4])
{
    const int samples = field->layers * STRESS_HEIGHTS;
    for (int a = 0; a < 2; a++) {
        left[a] = values[samples - 1][a];
        left[2 + a] = 0;
        for (int i = 0; i < samples; i += STRESS_HEIGHTS) {
            const int layer = i / STRESS_HEIGHTS;
            const double *z = field->state.design->mesh.laminate.ply[layer].z;
            double sum = 0;
            for (int k = 0; k < STRESS_HEIGHTS; k++) {
                double c[2];
                stencil_stretches(field, stencil, i + k, c);
                sum += (k == 1 ? 4 : 1) * values[i + k][a] / (c[a] * c[a]);
            }
            if (stress_is_present(field, stencil->element, layer))
                left[2 + a] += sum * (z[1] - z[0]) / 6;
        }
    }
}

/* ---- gradients ------------------------------------------------------------------ */

static void fit_gradient(const stress_field *field, const stencil *stencil, gradient slope)
{
    const stress_sample *own = stencil_samples(field, stencil->element);
    const int samples = field->layers * STRESS_HEIGHTS;
    memset(slope, 0, sizeof(gradient));
    for (int i = 0; i < samples; i++) {
        double here[3];
        stencil_turn_plane(own[i].plane, stencil->angle, here);
        for (int k = 0; k < stencil->count; k++) {
            double there[3];
            stencil_turn_plane(stencil_samples(field, stencil->neighbour[k])[i].plane,
                               -stencil->turn[k], there);
            for (int component = 0; component < 3; component++)
                for (int a = 0; a < 2; a++)
                    slope[i][a][component] +=
                        stencil->weight[k][a] * (there[component] - here[component]);
        }
    }
}

/*
 * Compute the gradient of the in-plane stresses under a unit gradient of one normal force or
 * bending moment of the laminate along its own direction.
 *   flex [6][6]  in   membrane strains and curvatures of the laminate per unit of force and moment
 *   pattern      in   0 or 1: normal force 11 or 22; 2 or 3: bending moment 11 or 22
 *   slope        out  the gradient
 */
static void unit_gradient(const stress_field *field, const stencil *stencil, double flex[6][6],
                          int pattern, gradient slope)
{
    const laminate *laminate = &field->state.design->mesh.laminate;
    const double unit[3] = {pattern % 2 == 0, pattern % 2 == 1, 0};
    double resultant[3], bent[6];
    stencil_turn_plane(unit, -stencil->angle, resultant);
    for (int i = 0; i < 6; i++) {
        bent[i] = 0;
        for (int j = 0; j < 3; j++)
            bent[i] += flex[i][j + 3 * (pattern / 2)] * resultant[j];
    }
    memset(slope, 0, sizeof(gradient));
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const int layer = i / STRESS_HEIGHTS;
        double stress[3];
        if (!stress_is_present(field, stencil->element, layer))
            continue;
        stencil_plane_stress(&laminate->ply[layer], bent,
                             stress_height(field, layer, i % STRESS_HEIGHTS), stress);
        stencil_turn_plane(stress, stencil->angle, slope[i][pattern % 2]);
    }
}

/* ---- transverse shear ------------------------------------------------------------- */

void stress_shear_resultants(const stress_field *field, int element, double shear[2])
{
    const mesh *mesh = &field->state.design->mesh;
    const laminate_place *place = &mesh->place[mesh->element_type[element]];
    const double *natural = field->element[element].resultant + 8;
    for (int i = 0; i < 2; i++) {
        shear[i] = natural[i];
        if (place->is_general)
            shear[i] = place->natural.base[2][2] * (place->natural.base[i][0] * natural[0] +
                                                    place->natural.base[i][1] * natural[1]);
    }
}

/*
 * Solve a small system of PATTERNS linear equations by elimination with row exchanges.
 *   matrix [PATTERNS][PATTERNS + 1] in/out  coefficients, with the right-hand side as the last
 *       column
 *   x      [PATTERNS]               out     solution
 * Returns 0, or -1 if the matrix is singular.
 */
static int solve_system(double matrix[PATTERNS][PATTERNS + 1], double x[PATTERNS])
{
    for (int k = 0; k < PATTERNS; k++) {
        int pivot = k;
        for (int i = k; i < PATTERNS; i++)
            if (fabs(matrix[i][k]) > fabs(matrix[pivot][k]))
                pivot = i;
        for (int j = 0; j <= PATTERNS; j++) {
            const double kept = matrix[k][j];
            matrix[k][j] = matrix[pivot][j];
            matrix[pivot][j] = kept;
        }
        if (!(fabs(matrix[k][k]) > 0))
            return -1;
        for (int i = 0; i < PATTERNS; i++)
            for (int j = PATTERNS; i != k && j >= k; j--)
                matrix[i][j] -= matrix[i][k] / matrix[k][k] * matrix[k][j];
    }
    for (int k = 0; k < PATTERNS; k++)
        x[k] = matrix[k][PATTERNS] / matrix[k][k];
    return 0;
}

/*
 * Correct a profile of transverse shear stresses so that it vanishes at the outer face and has the
 * shear resultants of the element. For this, multiples of four shear profiles are added: those that
 * balance unit gradients of the two normal forces and of the two bending moments. Returns 0, or -1
 * if the plies cannot carry the shear.
 */
static int correct(const stress_field *field, const stencil *stencil, profile values)
{
    const int samples = field->layers * STRESS_HEIGHTS;
    const double thickness = field->state.design->mesh.laminate.thickness;
    double flex[6][6], left[4], wanted[2], system[PATTERNS][PATTERNS + 1], part[PATTERNS];
    gradient slope;
    profile unit[PATTERNS];
    if (stencil_flexure(field, stencil->element, flex) < 0)
        return -1;
    for (int k = 0; k < PATTERNS; k++) {
        unit_gradient(field, stencil, flex, k, slope);
        balance(field, stencil, slope, unit[k]);
        resultants_of(field, stencil, unit[k], left);
        for (int row = 0; row < PATTERNS; row++)
            system[row][k] = left[row] * (row < 2 ? thickness : 1);
    }
    stress_shear_resultants(field, stencil->element, wanted);
    resultants_of(field, stencil, values, left);
    for (int row = 0; row < 2; row++) {
        const double along[2] = {cos(stencil->angle), sin(stencil->angle)};
        const double shear = row == 0 ? along[0] * wanted[0] + along[1] * wanted[1]
                                      : along[0] * wanted[1] - along[1] * wanted[0];
        system[row][PATTERNS] = -left[row] * thickness;
        system[2 + row][PATTERNS] = shear - left[2 + row];
    }
    if (solve_system(system, part) < 0)
        return -1;
    for (int i = 0; i < 2 * samples; i++)
        for (int k = 0; k < PATTERNS; k++)
            values[i / 2][i % 2] += part[k] * unit[k][i / 2][i % 2];
    return 0;
}

static void fill_shear(const stress_field *field, int element)
{
    stress_sample *own = stencil_samples(field, element);
    stencil stencil;
    gradient slope;
    profile values;
    stencil_find(field, element, &stencil);
    fit_gradient(field, &stencil, slope);
    balance(field, &stencil, slope, values);
    if (correct(field, &stencil, values) < 0)
        return;
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        double c[2], shear[2];
        if (!stress_is_present(field, element, i / STRESS_HEIGHTS))
            continue;
        stencil_stretches(field, &stencil, i, c);
        for (int a = 0; a < 2; a++)
            shear[a] = values[i][a] / (c[a] * c[a] * c[1 - a]);
        own[i].shear[0] = cos(stencil.angle) * shear[0] - sin(stencil.angle) * shear[1];
        own[i].shear[1] = sin(stencil.angle) * shear[0] + cos(stencil.angle) * shear[1];
    }
}

/* ---- normal stress -------------------------------------------------------------------- */

/*
 * Compute the derivative of c_1 c_2 s_33 along the thickness at each height at which stresses are
 * recovered (Pa/m). Here s_33 is the normal stress 33, and c_a is a length along direction a at the
 * sample height relative to the reference surface.
 */
static void normal_rate(const stress_field *field, const stencil *stencil, double *rate)
{
    const stress_sample *own = stencil_samples(field, stencil->element);
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        double c[2], here[2], there[2], plane[3], divergence[2] = {0, 0};
        stencil_stretches(field, stencil, i, c);
        stencil_turn_vector(own[i].shear, stencil->angle, here);
        stencil_turn_plane(own[i].plane, stencil->angle, plane);
        for (int k = 0; k < stencil->count; k++) {
            stencil_turn_vector(stencil_samples(field, stencil->neighbour[k])[i].shear,
                                -stencil->turn[k], there);
            for (int a = 0; a < 2; a++)
                divergence[a] += stencil->weight[k][a] * (there[a] - here[a]);
        }
        rate[i] = 0;
        for (int a = 0; a < 2; a++)
            rate[i] += c[1 - a] * (stencil->k[a] * plane[a] - divergence[a]);
    }
}

/*
 * Return the mean, over the thickness of the plies that are present in an element, of values given
 * at the sample heights.
 */
static double mean_of(const stress_field *field, int element, const double *value)
{
    double sum = 0, size = 0;
    for (int layer = 0; layer < field->layers; layer++) {
        const double *z = field->state.design->mesh.laminate.ply[layer].z;
        const double *v = value + layer * STRESS_HEIGHTS;
        if (!stress_is_present(field, element, layer))
            continue;
        sum += (z[1] - z[0]) * (v[0] + 4 * v[1] + v[2]) / 6;
        size += z[1] - z[0];
    }
    return size > 0 ? sum / size : 0;
}

static void fill_normal(const stress_field *field, int element)
{
    stress_sample *own = stencil_samples(field, element);
    stencil stencil;
    double rate[STENCIL_SAMPLES], value[STENCIL_SAMPLES];
    stencil_find(field, element, &stencil);
    if (stencil.count == 0)
        return;
    normal_rate(field, &stencil, rate);
    stencil_integrate(field, element, rate, value);
    const double shift = field->element[element].normal_stress - mean_of(field, element, value);
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        double c[2];
        if (!stress_is_present(field, element, i / STRESS_HEIGHTS))
            continue;
        stencil_stretches(field, &stencil, i, c);
        own[i].normal = (value[i] + shift) / (c[0] * c[1]);
    }
}

void stress_equilibrium(stress_field *field)
{
    for (int element = 0; element < field->elements; element++)
        fill_shear(field, element);
    for (int element = 0; element < field->elements; element++)
        fill_normal(field, element);
}
