/* SPDX-License-Identifier: BSD-2-Clause */
/* Gradients along the surface and integrals through the thickness (stress_stencil.h). */
#include "stress_stencil.h"
#include <math.h>
#include <string.h>
#include "../mesh/invert.h"
#include "../mesh/laminate_shear.h"
#include "../quads/vector.h"
#include "strain.h"

/* ---- geometry --------------------------------------------------------------- */

static const laminate_place *place_of(const stress_field *field, int element)
{
    const mesh *mesh = &field->state.design->mesh;
    return &mesh->place[mesh->element_type[element]];
}

void stencil_turn_plane(const double stress[3], double angle, double turned[3])
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
    stencil_turn_plane(k, stencil->angle, turned);
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
static void linear_weights(const stress_field *field, stencil *stencil)
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

/*
 * Compute the position of a neighbouring element from the centre of the element along both
 * directions of principal curvature.
 */
static void offset_of(const stress_field *field, const stencil *stencil, int neighbour,
                      double offset[2])
{
    const double *own = field->element[stencil->element].place;
    const double *other = field->element[neighbour].place;
    const double away[3] = {other[0] - own[0], other[1] - own[1], other[2] - own[2]};
    offset[0] = vector_dot(away, stencil->axis[0]);
    offset[1] = vector_dot(away, stencil->axis[1]);
}

/*
 * Return whether the neighbours lie on one side of the element along some direction, as at an edge
 * of the mesh. A linear fit would then give the gradient halfway between the element and its
 * neighbours, not at the element.
 *   size out  mean distance of the neighbours (m)
 */
static bool is_one_sided(const stress_field *field, const stencil *stencil, double *size)
{
    double sum[2] = {0, 0}, absolute[2] = {0, 0};
    *size = 0;
    for (int i = 0; i < stencil->count; i++) {
        double offset[2];
        offset_of(field, stencil, stencil->neighbour[i], offset);
        *size += hypot(offset[0], offset[1]) / stencil->count;
        for (int a = 0; a < 2; a++) {
            sum[a] += offset[a];
            absolute[a] += fabs(offset[a]);
        }
    }
    return fabs(sum[0]) > 0.5 * absolute[0] || fabs(sum[1]) > 0.5 * absolute[1];
}

/*
 * Append the neighbours of an element's neighbours to its list of neighbours, except those with
 * other plies or voltages than the element.
 */
static void add_second_ring(const stress_field *field, stencil *stencil)
{
    const int first = stencil->count;
    for (int i = 0; i < first; i++) {
        int list[STRESS_NEIGHBOURS];
        const int count = stress_neighbours(field, stencil->neighbour[i], list);
        for (int k = 0; k < count && stencil->count < STRESS_NEIGHBOURS; k++) {
            bool is_listed = list[k] == stencil->element;
            for (int m = 0; m < stencil->count; m++)
                is_listed |= stencil->neighbour[m] == list[k];
            if (!is_listed && stress_are_neighbours(field, stencil->element, list[k]))
                stencil->neighbour[stencil->count++] = list[k];
        }
    }
}

/*
 * Compute the weights of the neighbouring elements by which the gradient at an element is formed:
 * that of a quadratic polynomial, which has the value of the element at its centre and fits the
 * neighbours by least squares. Second derivatives that the neighbours do not determine are zero.
 *   size in  length that makes the offsets dimensionless (m)
 */
static void quadratic_weights(const stress_field *field, stencil *stencil, double size)
{
    enum { TERMS = 5 };
    const double least[TERMS] = {1e-12, 1e-12, 1e-8, 1e-8,
                                 1e-8}; /* regularisation of the least-squares fit: numbers that are
                                           added to the diagonal of its matrix, as fractions of the
                                           largest diagonal entry. Coefficients that the neighbours
                                           do not determine then become zero */
    double matrix[TERMS * TERMS] = {0}, term[STRESS_NEIGHBOURS][TERMS], largest = 0;
    for (int i = 0; i < stencil->count; i++) {
        double at[2];
        offset_of(field, stencil, stencil->neighbour[i], at);
        const double x = at[0] / size, y = at[1] / size;
        const double polynomial[TERMS] = {x, y, x * x / 2, x * y, y * y / 2};
        memcpy(term[i], polynomial, sizeof polynomial);
        for (int k = 0; k < TERMS * TERMS; k++)
            matrix[k] += polynomial[k / TERMS] * polynomial[k % TERMS] / (x * x + y * y);
    }
    for (int k = 0; k < TERMS; k++)
        largest = fmax(largest, matrix[k * (TERMS + 1)]);
    for (int k = 0; k < TERMS; k++)
        matrix[k * (TERMS + 1)] += least[k] * largest;
    if (invert(matrix, TERMS, TERMS) < 0)
        return;
    for (int i = 0; i < stencil->count; i++)
        for (int a = 0; a < 2; a++) {
            double sum = 0;
            for (int k = 0; k < TERMS; k++)
                sum += matrix[a * TERMS + k] * term[i][k];
            const double square = term[i][0] * term[i][0] + term[i][1] * term[i][1];
            stencil->weight[i][a] = sum / (square * size);
        }
}

void stencil_find(const stress_field *field, int element, stencil *stencil)
{
    double size;
    memset(stencil, 0, sizeof *stencil);
    stencil->element = element;
    find_directions(field, stencil);
    stencil->count = stress_neighbours(field, element, stencil->neighbour);
    const bool has_quadratic = is_one_sided(field, stencil, &size);
    if (has_quadratic)
        add_second_ring(field, stencil);
    for (int i = 0; i < stencil->count; i++) {
        const double *axis = field->element[stencil->neighbour[i]].axis[0];
        stencil->turn[i] =
            atan2(vector_dot(axis, stencil->axis[1]), vector_dot(axis, stencil->axis[0]));
    }
    linear_weights(field, stencil);
    if (has_quadratic)
        quadratic_weights(field, stencil, size);
}

stress_sample *stencil_samples(const stress_field *field, int element)
{
    return field->sample + (size_t)element * (size_t)field->layers * STRESS_HEIGHTS;
}

void stencil_turn_vector(const double vector[2], double angle, double turned[2])
{
    turned[0] = cos(angle) * vector[0] + sin(angle) * vector[1];
    turned[1] = cos(angle) * vector[1] - sin(angle) * vector[0];
}

void stencil_to_shell_axes(const stencil *stencil, const double principal[3], double own[3])
{
    const double all[6] = {principal[0], principal[1], 0, 0, 0, principal[2]};
    double turned[6];
    strain_turn(all, -stencil->angle, turned);
    own[0] = turned[0];
    own[1] = turned[1];
    own[2] = turned[5];
}

/* ---- plies ------------------------------------------------------------------ */

void stencil_stretches(const stress_field *field, const stencil *stencil, int sample, double c[2])
{
    const double z = stress_height(field, sample / STRESS_HEIGHTS, sample % STRESS_HEIGHTS);
    c[0] = 1 + stencil->k[0] * z;
    c[1] = 1 + stencil->k[1] * z;
}

void stencil_integrate(const stress_field *field, int element, const double *rate, double *sum)
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

void stencil_plane_stress(const laminate_ply *ply, const double bent[6], double z, double stress[3])
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

int stencil_flexure(const stress_field *field, int element, double flex[6][6])
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
