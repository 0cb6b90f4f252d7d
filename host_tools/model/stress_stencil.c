/* SPDX-License-Identifier: BSD-2-Clause */
/* Gradients along the surface and integrals through the thickness (stress_stencil.h). */
#include "stress_stencil.h"
#include <math.h>
#include <string.h>
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
    const double inverse[3] = {is_row ? a[0] / (trace * trace) : a[2] / det,
                               is_row ? a[1] / (trace * trace) : -a[1] / det,
                               is_row ? a[2] / (trace * trace) : a[0] / det};
    for (int i = 0; i < stencil->count; i++) {
        const double x = stencil->weight[i][0], y = stencil->weight[i][1];
        stencil->weight[i][0] = inverse[0] * x + inverse[1] * y;
        stencil->weight[i][1] = inverse[1] * x + inverse[2] * y;
    }
}

void stencil_find(const stress_field *field, int element, stencil *stencil)
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

stress_sample *stencil_samples(const stress_field *field, int element)
{
    return field->sample + (size_t)element * (size_t)field->layers * STRESS_HEIGHTS;
}

void stencil_turn_vector(const double vector[2], double angle, double turned[2])
{
    turned[0] = cos(angle) * vector[0] + sin(angle) * vector[1];
    turned[1] = cos(angle) * vector[1] - sin(angle) * vector[0];
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
