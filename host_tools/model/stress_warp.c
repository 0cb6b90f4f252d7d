/* SPDX-License-Identifier: BSD-2-Clause */
/* In-plane strains of bent cross-sections (stress_warp.h). */
#include "stress_warp.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "strain.h"
#include "stress_equilibrium.h"
#include "stress_stencil.h"

/* Displacement of the bent cross-sections at each height of an element along its shell axes (m). */
typedef double bend[STENCIL_SAMPLES][2];

/* ---- bent cross-sections --------------------------------------------------------- */

/*
 * Compute the displacement w of the bent cross-section of an element from its transverse shear
 * strains. With c_a, the length along direction a at a height relative to that in the reference
 * surface, w_a/c_a is the integral of (shear strain a3)/c_a over the height, from the inner face.
 */
static void fill_bend(const stress_field *field, const stencil *stencil, bend out)
{
    const int samples = field->layers * STRESS_HEIGHTS;
    double rate[2][STENCIL_SAMPLES], sum[2][STENCIL_SAMPLES], c[2];
    memset(rate, 0, sizeof rate);
    for (int i = 0; i < samples; i++) {
        double shear[2], turned[2];
        if (!stress_is_present(field, stencil->element, i / STRESS_HEIGHTS))
            continue;
        stress_shear_strains(field, stencil->element, i / STRESS_HEIGHTS, i % STRESS_HEIGHTS,
                             shear);
        stencil_turn_vector(shear, stencil->angle, turned);
        stencil_stretches(field, stencil, i, c);
        for (int a = 0; a < 2; a++)
            rate[a][i] = turned[a] / c[a];
    }
    for (int a = 0; a < 2; a++)
        stencil_integrate(field, stencil->element, rate[a], sum[a]);
    for (int i = 0; i < samples; i++) {
        stencil_stretches(field, stencil, i, c);
        const double along[2] = {c[0] * sum[0][i], c[1] * sum[1][i]};
        stencil_turn_vector(along, -stencil->angle, out[i]);
    }
}

/*
 * Compute the in-plane strains 11, 22 and 12 (twice the tensor's) of the gradient of the
 * displacement of the cross-sections, in the shell axes of the element.
 */
static void gradient_strain(const stress_field *field, const stencil *stencil, bend *all,
                            int sample, double strain[3])
{
    double c[2], here[2], slope[2][2] = {{0, 0}, {0, 0}};
    stencil_turn_vector(all[stencil->element][sample], stencil->angle, here);
    stencil_stretches(field, stencil, sample, c);
    for (int k = 0; k < stencil->count; k++) {
        double there[2];
        stencil_turn_vector(all[stencil->neighbour[k]][sample], -stencil->turn[k], there);
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                slope[a][b] += stencil->weight[k][b] * (there[a] - here[a]) / c[b];
    }
    const double turned[6] = {slope[0][0], slope[1][1], 0, 0, 0, slope[0][1] + slope[1][0]};
    double own[6];
    strain_turn(turned, -stencil->angle, own);
    strain[0] = own[0];
    strain[1] = own[1];
    strain[2] = own[5];
}

/*
 * Compute the forces and moments per length of the in-plane stresses that given strains at the
 * sample heights cause (resultant [6] out: 11 22 12 of the forces, then of the moments).
 */
static void resultants_of(const stress_field *field, int element, double (*strain)[3],
                          double resultant[6])
{
    memset(resultant, 0, 6 * sizeof *resultant);
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const int layer = i / STRESS_HEIGHTS, height = i % STRESS_HEIGHTS;
        const laminate_ply *ply = &field->state.design->mesh.laminate.ply[layer];
        const double z = stress_height(field, layer, height);
        const double bent[6] = {strain[i][0], strain[i][1], strain[i][2], 0, 0, 0};
        const double weight = (ply->z[1] - ply->z[0]) * (height == 1 ? 4 : 1) / 6;
        double stress[3];
        if (!stress_is_present(field, element, layer))
            continue;
        stencil_plane_stress(ply, bent, 0, stress);
        for (int k = 0; k < 3; k++) {
            resultant[k] += weight * stress[k];
            resultant[3 + k] += weight * z * stress[k];
        }
    }
}

/*
 * Compute the strains of the bent cross-sections of an element at all sample heights, with the
 * membrane strains and curvatures that keep the resultants of the element.
 */
static void warp_strains(const stress_field *field, int element, bend *all, double (*strain)[3])
{
    double flex[6][6], resultant[6], bent[6] = {0};
    stencil stencil;
    memset(strain, 0, STENCIL_SAMPLES * sizeof *strain);
    if (stencil_flexure(field, element, flex) < 0)
        return;
    stencil_find(field, element, &stencil);
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++)
        gradient_strain(field, &stencil, all, i, strain[i]);
    resultants_of(field, element, strain, resultant);
    for (int i = 0; i < 6; i++)
        for (int j = 0; j < 6; j++)
            bent[i] -= flex[i][j] * resultant[j];
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const double z = stress_height(field, i / STRESS_HEIGHTS, i % STRESS_HEIGHTS);
        for (int k = 0; k < 3; k++)
            strain[i][k] += bent[k] + z * bent[3 + k];
    }
}

/* ---- corrections ------------------------------------------------------------------ */

/*
 * Replace the in-plane strains of the bent cross-section at one sample (height of a layer) of an
 * element. Add to the in-plane stresses there the stresses that this change of the strains causes,
 * and return the sum of the squares of these added stresses.
 */
static double replace_strain(const stress_field *field, int element, int sample,
                             const double strain[3])
{
    const laminate_ply *ply = &field->state.design->mesh.laminate.ply[sample / STRESS_HEIGHTS];
    stress_sample *own = &stencil_samples(field, element)[sample];
    const double change[6] = {strain[0] - own->warp[0], strain[1] - own->warp[1],
                              strain[2] - own->warp[2]};
    double stress[3], square = 0;
    stencil_plane_stress(ply, change, 0, stress);
    for (int k = 0; k < 3; k++) {
        own->warp[k] = strain[k];
        own->plane[k] += stress[k];
        square += stress[k] * stress[k];
    }
    return square;
}

/*
 * Compute the strains of bent cross-sections of all elements from the present shear stresses, and
 * the in-plane stresses with these strains.
 *   bends   [elements] out  work array
 *   factor  in  1, or 0 for straight cross-sections
 * Returns the square root of the sum of the squared changes of the in-plane stresses (Pa).
 */
static double correct(stress_field *field, bend *bends, double factor)
{
    double square = 0;
    for (int element = 0; element < field->elements; element++) {
        stencil stencil;
        stencil_find(field, element, &stencil);
        fill_bend(field, &stencil, bends[element]);
    }
    for (int element = 0; element < field->elements; element++) {
        double strain[STENCIL_SAMPLES][3];
        warp_strains(field, element, bends, strain);
        for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
            const double wanted[3] = {factor * strain[i][0], factor * strain[i][1],
                                      factor * strain[i][2]};
            if (stress_is_present(field, element, i / STRESS_HEIGHTS))
                square += replace_strain(field, element, i, wanted);
        }
    }
    return sqrt(square);
}

int stress_warp(stress_field *field)
{
    bend *bends = calloc((size_t)field->elements, sizeof *bends);
    if (!bends)
        return -1;
    const double first = correct(field, bends, 1);
    stress_equilibrium(field);
    const double second = correct(field, bends, 1);
    if (!(second <= 0.5 * first)) {
        (void)correct(field, bends, 0);
        stress_equilibrium(field);
    }
    free(bends);
    return 0;
}
