/* SPDX-License-Identifier: BSD-2-Clause */
/* Displacement of bent and stretched cross-sections (stress_bend.h). */
#include "stress_bend.h"
#include <string.h>

/* Return the thickness strain 33 of a ply at one height. */
static double thickness_strain(const laminate_ply *ply, const stress_sample *own)
{
    static const int plane[3] = {0, 1, 5};
    double stress = own->normal - own->own_normal;
    for (int k = 0; k < 3; k++)
        stress -= ply->c[2][plane[k]] * own->warp[k];
    return own->thickening + stress / ply->c[2][2];
}

/*
 * Compute how far the plies of an element move along the normal: the integral of their thickness
 * strains from the inner face.
 */
static void fill_rise(const stress_field *field, int element, section out)
{
    const int samples = field->layers * STRESS_HEIGHTS;
    const stress_sample *own = stencil_samples(field, element);
    double rate[STENCIL_SAMPLES], sum[STENCIL_SAMPLES];
    for (int i = 0; i < samples; i++) {
        const laminate_ply *ply = &field->state.design->mesh.laminate.ply[i / STRESS_HEIGHTS];
        rate[i] = field->has_squeeze && stress_is_present(field, element, i / STRESS_HEIGHTS)
                      ? thickness_strain(ply, &own[i])
                      : 0;
    }
    stencil_integrate(field, element, rate, sum);
    for (int i = 0; i < samples; i++)
        out[i].rise = sum[i];
}

/*
 * Gradient of the normal displacement at one height of an element (dimensionless), along the two
 * directions of principal curvature.
 */
static void rise_gradient(const stencil *stencil, section *all, int sample, double slope[2])
{
    const double here = all[stencil->element][sample].rise;
    slope[0] = slope[1] = 0;
    for (int k = 0; k < stencil->count; k++)
        for (int a = 0; a < 2; a++)
            slope[a] += stencil->weight[k][a] * (all[stencil->neighbour[k]][sample].rise - here);
}

/*
 * Return the integral of the product of two quantities over the thickness of the plies of an
 * element.
 */
static double integral_of(const stress_field *field, int element, const double *first,
                          const double *second)
{
    double sum = 0;
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const double *z = field->state.design->mesh.laminate.ply[i / STRESS_HEIGHTS].z;
        if (stress_is_present(field, element, i / STRESS_HEIGHTS))
            sum += (z[1] - z[0]) * (i % STRESS_HEIGHTS == 1 ? 4 : 1) / 6 * first[i] * second[i];
    }
    return sum;
}

/*
 * Compute the stress along a direction of principal curvature under the unit force (moment 0) or
 * the unit bending moment (moment 1) along this direction.
 */
static void unit_stress(const stress_field *field, const stencil *stencil, double flex[6][6],
                        int direction, int moment, double *out)
{
    const double unit[3] = {direction == 0, direction == 1, 0};
    double resultant[3], bent[6];
    stencil_turn_plane(unit, -stencil->angle, resultant);
    for (int i = 0; i < 6; i++) {
        bent[i] = 0;
        for (int j = 0; j < 3; j++)
            bent[i] += flex[i][3 * moment + j] * resultant[j];
    }
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        double stress[3], turned[3];
        stencil_plane_stress(&field->state.design->mesh.laminate.ply[i / STRESS_HEIGHTS], bent,
                             stress_height(field, i / STRESS_HEIGHTS, i % STRESS_HEIGHTS), stress);
        stencil_turn_plane(stress, stencil->angle, turned);
        out[i] = turned[direction];
    }
}

/*
 * Subtract from the displacement of a cross-section along one direction a straight line a + b z,
 * the part that the element itself can make. The line is chosen so that the remainder does no work
 * on the stresses of a unit force and of a unit bending moment along this direction.
 */
static void remove_straight(const stress_field *field, const stencil *stencil, double flex[6][6],
                            int direction, double *along)
{
    double one[STENCIL_SAMPLES], height[STENCIL_SAMPLES], stress[STENCIL_SAMPLES], row[2][3];
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        one[i] = 1;
        height[i] = stress_height(field, i / STRESS_HEIGHTS, i % STRESS_HEIGHTS);
    }
    for (int moment = 0; moment < 2; moment++) {
        unit_stress(field, stencil, flex, direction, moment, stress);
        row[moment][0] = integral_of(field, stencil->element, stress, one);
        row[moment][1] = integral_of(field, stencil->element, stress, height);
        row[moment][2] = integral_of(field, stencil->element, stress, along);
    }
    const double size = row[0][0] * row[1][1] - row[0][1] * row[1][0];
    const double a = (row[0][2] * row[1][1] - row[0][1] * row[1][2]) / size,
                 b = (row[0][0] * row[1][2] - row[0][2] * row[1][0]) / size;
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++)
        along[i] -= a + b * height[i];
}

/*
 * Compute the in-plane displacement w_a of the bent cross-section of an element from its transverse
 * shear strains and the gradient of the displacement w_3 along the normal. With c_a, the length
 * along direction a at a height relative to that in the reference surface, w_a/c_a is the integral
 * over the height of (shear strain a3 - w_3,a/c_a)/c_a, from the inner face.
 *   all [elements] in/out  in: w_3 (member `rise`) of all elements; out: w_a of this element
 */
static void fill_bend(const stress_field *field, const stencil *stencil, section *all)
{
    const int samples = field->layers * STRESS_HEIGHTS;
    double rate[2][STENCIL_SAMPLES], along[2][STENCIL_SAMPLES], c[2], flex[6][6];
    memset(rate, 0, sizeof rate);
    if (stencil_flexure(field, stencil->element, flex) < 0)
        return;
    for (int i = 0; i < samples; i++) {
        double shear[2], turned[2], slope[2];
        if (!stress_is_present(field, stencil->element, i / STRESS_HEIGHTS))
            continue;
        stress_shear_strains(field, stencil->element, i / STRESS_HEIGHTS, i % STRESS_HEIGHTS,
                             shear);
        stencil_turn_vector(shear, stencil->angle, turned);
        rise_gradient(stencil, all, i, slope);
        stencil_stretches(field, stencil, i, c);
        for (int a = 0; a < 2; a++)
            rate[a][i] = (turned[a] - slope[a] / c[a]) / c[a];
    }
    for (int a = 0; a < 2; a++) {
        stencil_integrate(field, stencil->element, rate[a], along[a]);
        for (int i = 0; i < samples; i++) {
            stencil_stretches(field, stencil, i, c);
            along[a][i] *= c[a];
        }
        remove_straight(field, stencil, flex, a, along[a]);
    }
    for (int i = 0; i < samples; i++) {
        const double both[2] = {along[0][i], along[1][i]};
        stencil_turn_vector(both, -stencil->angle, all[stencil->element][i].along);
    }
}

void bend_strain(const stress_field *field, const stencil *stencil, section *all, int sample,
                 double strain[3])
{
    const bend *own = &all[stencil->element][sample];
    double c[2], here[2], slope[2][2] = {{0, 0}, {0, 0}};
    stencil_turn_vector(own->along, stencil->angle, here);
    stencil_stretches(field, stencil, sample, c);
    for (int k = 0; k < stencil->count; k++) {
        double there[2];
        stencil_turn_vector(all[stencil->neighbour[k]][sample].along, -stencil->turn[k], there);
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                slope[a][b] += stencil->weight[k][b] * (there[a] - here[a]) / c[b];
    }
    const double principal[3] = {slope[0][0] + stencil->k[0] * own->rise / c[0],
                                 slope[1][1] + stencil->k[1] * own->rise / c[1],
                                 slope[0][1] + slope[1][0]};
    stencil_to_shell_axes(stencil, principal, strain);
}

void bend_fill(const stress_field *field, section *all)
{
    for (int element = 0; element < field->elements; element++)
        fill_rise(field, element, all[element]);
    for (int element = 0; element < field->elements; element++) {
        stencil stencil;
        stencil_find(field, element, &stencil);
        fill_bend(field, &stencil, all);
    }
}
