/* SPDX-License-Identifier: BSD-2-Clause */
/* Transverse stresses from equilibrium through the thickness (stress_equilibrium.h). */
#include "stress_equilibrium.h"
#include <math.h>
#include <string.h>
#include "../mesh/laminate_shear.h"
#include "../quads/vector.h"
#include "strain.h"

/*
 * SAMPLES: largest number of heights at which an element has recovered stresses. PATTERNS: number
 * of unknowns in the correction of the transverse shear stresses: gradients of two normal forces
 * (11 and 22) and two bending moments (11 and 22), each along its own direction.
 */
enum { SAMPLES = LAMINATE_LAYERS * STRESS_HEIGHTS, PATTERNS = 4 };

/*
 * Directions of principal curvature at the centre of an element, and the neighbouring elements from
 * which the gradients of the stresses along these directions are formed.
 */
typedef struct stencil {
    int element;
    double axis[2][3]; /* unit vectors along the two directions of principal curvature */
    double angle;      /* angle from shell axis 1 of the element to the first direction of principal
                          curvature (rad) */
    double k[2];       /* principal curvatures of the surface along their two directions (1/m) */
    int count; /* number of neighbouring elements from which the gradients of stresses are formed */
    int neighbour[STRESS_NEIGHBOURS];
    double turn[STRESS_NEIGHBOURS]; /* angle from the first direction of principal curvature to the
                                       shell axis 1 of each neighbouring element (rad) */
    double weight[STRESS_NEIGHBOURS][2]; /* [neighbouring element][direction] weights (1/m) that
                                            approximate the derivative of a quantity along a
                                            direction of principal curvature: the derivative is the
                                            sum of weight x (value at the neighbour - value at the
                                            element) */
} stencil;

/*
 * Derivatives of the in-plane stresses 11, 22 and 12 along the two directions of principal
 * curvature, at each height at which stresses are recovered (Pa/m): [height][direction][component].
 */
typedef double gradient[SAMPLES][2][3];

/*
 * Transverse shear stresses s_13 and s_23 at each recovered height, times c_1^2 c_2 and c_2^2 c_1
 * (Pa). c_a = 1 + k_a z, with principal curvature k_a and height z, is a length along direction a
 * over that in the reference surface.
 */
typedef double profile[SAMPLES][2];

/* ---- geometry --------------------------------------------------------------- */

static const laminate_place *place_of(const stress_field *field, int element)
{
    const mesh *mesh = &field->state.design->mesh;
    return &mesh->place[mesh->element_type[element]];
}

/*
 * Compute the components 11, 22 and 12 of an in-plane stress in axes that are turned by an angle
 * (rad) against the axes of the given components.
 */
static void turn_plane(const double stress[3], double angle, double turned[3])
{
    const double all[6] = {stress[0], stress[1], 0, 0, 0, stress[2]};
    double out[6];
    strain_turn_stress(all, angle, out);
    turned[0] = out[0];
    turned[1] = out[1];
    turned[2] = out[5];
}

/*
 * Compute the curvatures 11, 22 and 12 of the surface of an element in its shell axes (1/m). In a
 * nonlinear state they are the curvatures of the deformed surface.
 */
static void curvatures(const stress_field *field, int element, double k[3])
{
    const laminate_place *place = place_of(field, element);
    const double(*base)[3] = (const double(*)[3])place->natural.base;
    const double(*slope)[3] = (const double(*)[3])place->natural.slope;
    const double *strain = field->element[element].strain;
    const double thickness = field->state.design->mesh.laminate.thickness;
    double map[6][6];
    k[0] = place->curvature[0];
    k[1] = place->curvature[1];
    k[2] = 0;
    if (place->is_general) {
        const double size = base[0][0] * base[1][1] - base[0][1] * base[1][0];
        k[0] = (slope[0][0] * base[1][1] - slope[0][1] * base[1][0]) / size;
        k[1] = (slope[1][1] * base[0][0] - slope[1][0] * base[0][1]) / size;
        k[2] = (slope[0][1] * base[0][0] - slope[0][0] * base[0][1] + slope[1][0] * base[1][1] -
                slope[1][1] * base[1][0]) /
               (2 * size);
    }
    if (!field->state.is_nonlinear)
        return;
    laminate_strain_map(&field->state.design->mesh.formulation, place, 0, map);
    for (int i = 0; i < 3; i++) {
        const double *row = map[i == 2 ? 5 : i];
        k[i] += (row[0] * strain[1] + row[1] * strain[3] + row[5] * strain[7]) /
                (thickness * (i == 2 ? 2 : 1));
    }
}

/*
 * Find the two directions of principal curvature of an element. If the surface has a negligible
 * twist (curvature 12), the shell axes are used as these directions.
 */
static void find_directions(const stress_field *field, stencil *stencil)
{
    const double negligible = 1e-4; /* largest product of the twist of the surface (1/m) and the
                                       thickness (m) that is treated as zero */
    const stress_element *own = &field->element[stencil->element];
    double k[3], turned[3];
    curvatures(field, stencil->element, k);
    if (fabs(k[2]) * field->state.design->mesh.laminate.thickness > negligible)
        stencil->angle = atan2(2 * k[2], k[0] - k[1]) / 2;
    turn_plane(k, stencil->angle, turned);
    for (int a = 0; a < 2; a++) {
        const double angle = stencil->angle + a * 1.5707963267948966;
        stencil->k[a] = turned[a];
        for (int i = 0; i < 3; i++)
            stencil->axis[a][i] = cos(angle) * own->axis[0][i] + sin(angle) * own->axis[1][i];
    }
}

/*
 * Compute the weights of the neighbouring elements in the least-squares fit of a gradient. If all
 * neighbours lie on one line through the element, only the component of the gradient along this
 * line is not zero.
 */
static void find_weights(const stress_field *field, stencil *stencil)
{
    const double *own = field->element[stencil->element].place;
    double a[3] = {0, 0, 0};
    for (int i = 0; i < stencil->count; i++) {
        const double *other = field->element[stencil->neighbour[i]].place;
        const double away[3] = {other[0] - own[0], other[1] - own[1], other[2] - own[2]};
        const double x = vector_dot(away, stencil->axis[0]), y = vector_dot(away, stencil->axis[1]);
        const double square = x * x + y * y;
        stencil->weight[i][0] = x / square;
        stencil->weight[i][1] = y / square;
        a[0] += x * x / square;
        a[1] += x * y / square;
        a[2] += y * y / square;
    }
    const double trace = a[0] + a[2], det = a[0] * a[2] - a[1] * a[1];
    const bool is_row = det < 1e-6 * trace * trace;
    const double of_row[3] = {a[0] / (trace * trace), a[1] / (trace * trace),
                              a[2] / (trace * trace)};
    const double of_matrix[3] = {a[2] / det, -a[1] / det, a[0] / det};
    const double *inverse = is_row ? of_row : of_matrix;
    for (int i = 0; i < stencil->count; i++) {
        const double x = stencil->weight[i][0], y = stencil->weight[i][1];
        stencil->weight[i][0] = inverse[0] * x + inverse[1] * y;
        stencil->weight[i][1] = inverse[1] * x + inverse[2] * y;
    }
}

static void find_stencil(const stress_field *field, int element, stencil *stencil)
{
    memset(stencil, 0, sizeof *stencil);
    stencil->element = element;
    find_directions(field, stencil);
    stencil->count = stress_neighbours(field, element, stencil->neighbour);
    for (int i = 0; i < stencil->count; i++) {
        const double *axis = field->element[stencil->neighbour[i]].axis[0];
        stencil->turn[i] =
            atan2(vector_dot(axis, stencil->axis[1]), vector_dot(axis, stencil->axis[0]));
    }
    find_weights(field, stencil);
}

static stress_sample *samples_of(const stress_field *field, int element)
{
    return field->sample + (size_t)element * (size_t)field->layers * STRESS_HEIGHTS;
}

/* ---- integration through the thickness ---------------------------------------- */

/*
 * Compute the factors c_1 and c_2 at a sample height: lengths along the two directions of principal
 * curvature at this height relative to lengths on the reference surface.
 */
static void stretches(const stress_field *field, const stencil *stencil, int sample, double c[2])
{
    const double z = stress_height(field, sample / STRESS_HEIGHTS, sample % STRESS_HEIGHTS);
    c[0] = 1 + stencil->k[0] * z;
    c[1] = 1 + stencil->k[1] * z;
}

/*
 * Integrate values at the sample heights over the thickness of the laminate, from its inner face.
 * The integral is exact where the values are quadratic within each layer. Absent layers add
 * nothing.
 *   rate [samples] in   values to be integrated
 *   sum  [samples] out  integral from the inner face to each sample height
 */
static void integrate(const stress_field *field, int element, const double *rate, double *sum)
{
    double value = 0;
    for (int layer = 0; layer < field->layers; layer++) {
        const double *z = field->state.design->mesh.laminate.ply[layer].z;
        const double *r = rate + layer * STRESS_HEIGHTS;
        double *s = sum + layer * STRESS_HEIGHTS;
        const double size = stress_is_present(field, element, layer) ? z[1] - z[0] : 0;
        s[0] = value;
        s[1] = value + size / 24 * (5 * r[0] + 8 * r[1] - r[2]);
        s[2] = value + size / 6 * (r[0] + 4 * r[1] + r[2]);
        value = s[2];
    }
}

/*
 * Compute the transverse shear stresses from the gradient of the in-plane stresses: integrate the
 * equations of equilibrium (stress_equilibrium.h) from the inner face, where the stresses vanish.
 *   out  products c_1^2 c_2 s_13 and c_2^2 c_1 s_23 (profile)
 */
static void balance(const stress_field *field, const stencil *stencil, gradient slope, profile out)
{
    const int samples = field->layers * STRESS_HEIGHTS;
    for (int a = 0; a < 2; a++) {
        double rate[SAMPLES], sum[SAMPLES];
        for (int i = 0; i < samples; i++) {
            double c[2];
            stretches(field, stencil, i, c);
            const double along = slope[i][a][a] / c[a], across = slope[i][1 - a][2] / c[1 - a];
            rate[i] = -c[a] * c[a] * c[1 - a] * (along + across);
        }
        integrate(field, stencil->element, rate, sum);
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
                stretches(field, stencil, i + k, c);
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
    const stress_sample *own = samples_of(field, stencil->element);
    const int samples = field->layers * STRESS_HEIGHTS;
    memset(slope, 0, sizeof(gradient));
    for (int i = 0; i < samples; i++) {
        double here[3];
        turn_plane(own[i].plane, stencil->angle, here);
        for (int k = 0; k < stencil->count; k++) {
            double there[3];
            turn_plane(samples_of(field, stencil->neighbour[k])[i].plane, -stencil->turn[k], there);
            for (int component = 0; component < 3; component++)
                for (int a = 0; a < 2; a++)
                    slope[i][a][component] +=
                        stencil->weight[k][a] * (there[component] - here[component]);
        }
    }
}

/*
 * Compute the in-plane stresses 11, 22 and 12 of a ply at height z from the membrane strains and
 * curvatures of the laminate. The normal stress 33 is zero.
 *   bent [6] in  membrane strains 11 22 12, then curvatures 11 22 12 (1/m)
 */
static void plane_stress(const laminate_ply *ply, const double bent[6], double z, double stress[3])
{
    static const int plane[3] = {0, 1, 5};
    for (int i = 0; i < 3; i++) {
        stress[i] = 0;
        for (int j = 0; j < 3; j++)
            stress[i] += (ply->c[plane[i]][plane[j]] -
                          ply->c[plane[i]][2] * ply->c[2][plane[j]] / ply->c[2][2]) *
                         (bent[j] + z * bent[3 + j]);
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
    turn_plane(unit, -stencil->angle, resultant);
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
        plane_stress(&laminate->ply[layer], bent, stress_height(field, layer, i % STRESS_HEIGHTS),
                     stress);
        turn_plane(stress, stencil->angle, slope[i][pattern % 2]);
    }
}

/* ---- transverse shear ------------------------------------------------------------- */

void stress_shear_resultants(const stress_field *field, int element, double shear[2])
{
    const laminate_place *place = place_of(field, element);
    const double *natural = field->element[element].resultant + 8;
    for (int i = 0; i < 2; i++) {
        shear[i] = natural[i];
        if (place->is_general)
            shear[i] = place->natural.base[2][2] * (place->natural.base[i][0] * natural[0] +
                                                    place->natural.base[i][1] * natural[1]);
    }
}

/*
 * Compute the membrane strains and curvatures that a unit of each force and moment causes in the
 * plies of an element. Returns 0, or -1 if the plies have no bending stiffness.
 */
static int flexure_of(const stress_field *field, int element, double flex[6][6])
{
    const laminate *laminate = &field->state.design->mesh.laminate;
    shear_ply ply[LAMINATE_LAYERS];
    int plies = 0;
    for (int layer = 0; layer < field->layers; layer++)
        if (stress_is_present(field, element, layer)) {
            memcpy(ply[plies].z, laminate->ply[layer].z, sizeof ply[plies].z);
            ply[plies++].c = laminate->ply[layer].c;
        }
    return laminate_flexure(ply, plies, flex);
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
 * shear resultants of the element, by adding the shear stresses of four gradients: of both normal
 * forces and both bending moments. Returns 0, or -1 if the plies cannot carry the shear.
 */
static int correct(const stress_field *field, const stencil *stencil, profile values)
{
    const int samples = field->layers * STRESS_HEIGHTS;
    const double thickness = field->state.design->mesh.laminate.thickness;
    double flex[6][6], left[4], wanted[2], system[PATTERNS][PATTERNS + 1], part[PATTERNS];
    gradient slope;
    profile unit[PATTERNS];
    if (flexure_of(field, stencil->element, flex) < 0)
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
    stress_sample *own = samples_of(field, element);
    stencil stencil;
    gradient slope;
    profile values;
    find_stencil(field, element, &stencil);
    fit_gradient(field, &stencil, slope);
    balance(field, &stencil, slope, values);
    if (correct(field, &stencil, values) < 0)
        return;
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        double c[2], shear[2];
        if (!stress_is_present(field, element, i / STRESS_HEIGHTS))
            continue;
        stretches(field, &stencil, i, c);
        for (int a = 0; a < 2; a++)
            shear[a] = values[i][a] / (c[a] * c[a] * c[1 - a]);
        own[i].shear[0] = cos(stencil.angle) * shear[0] - sin(stencil.angle) * shear[1];
        own[i].shear[1] = sin(stencil.angle) * shear[0] + cos(stencil.angle) * shear[1];
    }
}

/* ---- normal stress -------------------------------------------------------------------- */

/*
 * Compute the components of an in-plane vector in axes that are turned by an angle (rad) against
 * the axes of the given components.
 */
static void turn_vector(const double vector[2], double angle, double turned[2])
{
    turned[0] = cos(angle) * vector[0] + sin(angle) * vector[1];
    turned[1] = cos(angle) * vector[1] - sin(angle) * vector[0];
}

/*
 * Compute the derivative of c_1 c_2 s_33 along the thickness at each height at which stresses are
 * recovered (Pa/m). Here s_33 is the normal stress 33, and c_a is a length along direction a at the
 * sample height relative to the reference surface.
 */
static void normal_rate(const stress_field *field, const stencil *stencil, double *rate)
{
    const stress_sample *own = samples_of(field, stencil->element);
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        double c[2], here[2], there[2], plane[3], divergence[2] = {0, 0};
        stretches(field, stencil, i, c);
        turn_vector(own[i].shear, stencil->angle, here);
        turn_plane(own[i].plane, stencil->angle, plane);
        for (int k = 0; k < stencil->count; k++) {
            turn_vector(samples_of(field, stencil->neighbour[k])[i].shear, -stencil->turn[k],
                        there);
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
    stress_sample *own = samples_of(field, element);
    stencil stencil;
    double rate[SAMPLES], value[SAMPLES];
    find_stencil(field, element, &stencil);
    if (stencil.count == 0)
        return;
    normal_rate(field, &stencil, rate);
    integrate(field, element, rate, value);
    const double shift = field->element[element].normal_stress - mean_of(field, element, value);
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        double c[2];
        if (!stress_is_present(field, element, i / STRESS_HEIGHTS))
            continue;
        stretches(field, &stencil, i, c);
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
