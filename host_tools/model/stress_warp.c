/* SPDX-License-Identifier: BSD-2-Clause */
/* In-plane strains of bent cross-sections (stress_warp.h). */
#include "stress_warp.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../mesh/invert.h"
#include "stress_bend.h"
#include "stress_equilibrium.h"

/*
 * Number of unit strains of an element: membrane strains 11, 22, 12 and curvatures 11, 22, 12. A
 * combination of them is added to the strains of bent cross-sections, so that these do not change
 * the stress resultants of the element.
 */
enum { UNITS = 6 };

/* In-plane strains 11, 22 and 12 (twice the tensor's) at all heights of an element. */
typedef double strains[STENCIL_SAMPLES][3];

/* ---- resultants ------------------------------------------------------------------- */

/*
 * Compute the in-plane strains at all heights per unit of membrane strain (0 to 2: 11, 22, 12) or
 * curvature (3 to 5), along the directions of principal curvature.
 */
static void unit_strains(const stress_field *field, const stencil *stencil, int unit, strains out)
{
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const double z = stress_height(field, i / STRESS_HEIGHTS, i % STRESS_HEIGHTS);
        double c[2], principal[3] = {0, 0, 0};
        stencil_stretches(field, stencil, i, c);
        const double length[3] = {c[0], c[1], c[0] * c[1]};
        principal[unit % 3] = (unit < 3 ? 1 : z) / length[unit % 3];
        stencil_to_shell_axes(stencil, principal, out[i]);
    }
}

/* Return the work of in-plane stresses on in-plane strains of an element, per area (N/m). */
static double work_of(const stress_field *field, const stencil *stencil, strains stress,
                      strains strain)
{
    double work = 0;
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const double *z = field->state.design->mesh.laminate.ply[i / STRESS_HEIGHTS].z;
        double c[2];
        if (!stress_is_present(field, stencil->element, i / STRESS_HEIGHTS))
            continue;
        stencil_stretches(field, stencil, i, c);
        const double weight = c[0] * c[1] * (z[1] - z[0]) * (i % STRESS_HEIGHTS == 1 ? 4 : 1) / 6;
        for (int k = 0; k < 3; k++)
            work += weight * stress[i][k] * strain[i][k];
    }
    return work;
}

/*
 * Compute the in-plane stresses (Pa) that given in-plane strains cause at all heights of an element
 * where the normal stress 33 is 0.
 */
static void stresses_of(const stress_field *field, strains strain, strains stress)
{
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const laminate_ply *ply = &field->state.design->mesh.laminate.ply[i / STRESS_HEIGHTS];
        const double bent[6] = {strain[i][0], strain[i][1], strain[i][2], 0, 0, 0};
        stencil_plane_stress(ply, bent, 0, stress[i]);
    }
}

/*
 * Add membrane strains and curvatures to in-plane strains of an element, so that the stresses of
 * all these strains and `further` have no resultant forces and moments. Returns 0, or -1 if the
 * plies have no bending stiffness.
 *   strain  in/out  in-plane strains
 *   further in      other in-plane stresses whose resultants are to be balanced, too (Pa)
 */
static int keep_resultants(const stress_field *field, const stencil *stencil, strains strain,
                           strains further)
{
    double matrix[UNITS * UNITS], force[UNITS];
    strains unit[UNITS], stress, total;
    stresses_of(field, strain, total);
    for (int i = 0; i < 3 * field->layers * STRESS_HEIGHTS; i++)
        total[i / 3][i % 3] += further[i / 3][i % 3];
    for (int i = 0; i < UNITS; i++) {
        unit_strains(field, stencil, i, unit[i]);
        force[i] = work_of(field, stencil, total, unit[i]);
    }
    for (int i = 0; i < UNITS; i++) {
        stresses_of(field, unit[i], stress);
        for (int j = 0; j < UNITS; j++)
            matrix[UNITS * i + j] = work_of(field, stencil, stress, unit[j]);
    }
    if (invert(matrix, UNITS, UNITS) < 0)
        return -1;
    for (int i = 0; i < 3 * field->layers * STRESS_HEIGHTS; i++)
        for (int j = 0; j < UNITS * UNITS; j++)
            strain[i / 3][i % 3] -= unit[j / UNITS][i / 3][i % 3] * matrix[j] * force[j % UNITS];
    return 0;
}

/* ---- corrections ------------------------------------------------------------------ */

/*
 * Compute the in-plane stresses (squeeze out, Pa) that the thickness stress causes at every height
 * while the in-plane strains are unchanged: only the part of the recovered normal stress 33 that
 * exceeds the normal stress 33 of the element counts.
 */
static void squeeze_of(const stress_field *field, int element, strains squeeze)
{
    static const int plane[3] = {0, 1, 5};
    const stress_sample *own = stencil_samples(field, element);
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const laminate_ply *ply = &field->state.design->mesh.laminate.ply[i / STRESS_HEIGHTS];
        for (int k = 0; k < 3; k++)
            squeeze[i][k] =
                stress_is_present(field, element, i / STRESS_HEIGHTS)
                    ? ply->c[plane[k]][2] / ply->c[2][2] * (own[i].normal - own[i].own_normal)
                    : 0;
    }
}

/*
 * Store the in-plane stresses that an element leaves out, in the member `lacking` of its samples:
 * stresses of the given strains, plus further stresses.
 */
static void store_lacking(const stress_field *field, int element, strains strain, strains further)
{
    stress_sample *own = stencil_samples(field, element);
    strains stress;
    stresses_of(field, strain, stress);
    for (int i = 0; i < 3 * field->layers * STRESS_HEIGHTS; i++)
        own[i / 3].lacking[i % 3] = stress_is_present(field, element, i / 3 / STRESS_HEIGHTS)
                                        ? stress[i / 3][i % 3] + further[i / 3][i % 3]
                                        : 0;
}

/*
 * Compute two things for one element, at all heights: the in-plane strains of its bent
 * cross-sections, and the in-plane stresses caused by the normal stress 33 (squeeze out). Membrane
 * strains and curvatures are added to these strains, so that the resultants of the element do not
 * change.
 */
static void warp_strains(const stress_field *field, int element, section *all, strains strain,
                         strains squeeze)
{
    const stress_sample *own = stencil_samples(field, element);
    strains excess;
    stencil stencil;
    stencil_find(field, element, &stencil);
    squeeze_of(field, element, squeeze);
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++)
        bend_strain(field, &stencil, all, i, strain[i]);
    store_lacking(field, element, strain, squeeze);
    for (int i = 0; i < 3 * field->layers * STRESS_HEIGHTS; i++) {
        squeeze[i / 3][i % 3] *= field->has_squeeze;
        excess[i / 3][i % 3] = squeeze[i / 3][i % 3] - own[i / 3].balanced[i % 3];
    }
    if (keep_resultants(field, &stencil, strain, excess) == 0)
        return;
    memset(strain, 0, sizeof(strains));
    for (int i = 0; i < 3 * field->layers * STRESS_HEIGHTS; i++)
        squeeze[i / 3][i % 3] = own[i / 3].balanced[i % 3];
}

/*
 * Replace the in-plane strains of the bent cross-section and the stresses caused by the normal
 * stress 33 at one sample (height of a layer) of an element. Add what this changes to the in-plane
 * stresses there, and return the sum of the squares of these added stresses.
 */
static double replace_strain(const laminate_ply *ply, stress_sample *own, const double strain[3],
                             const double squeeze[3])
{
    const double change[6] = {strain[0] - own->warp[0], strain[1] - own->warp[1],
                              strain[2] - own->warp[2]};
    double stress[3], square = 0;
    stencil_plane_stress(ply, change, 0, stress);
    for (int k = 0; k < 3; k++) {
        stress[k] += squeeze[k] - own->squeeze[k];
        own->warp[k] = strain[k];
        own->squeeze[k] = squeeze[k];
        own->plane[k] += stress[k];
        square += stress[k] * stress[k];
    }
    return square;
}

/*
 * At all heights of an element, replace the in-plane strains of the bent cross-section and the
 * stresses caused by the normal stress 33.
 */
static double replace_all(const stress_field *field, int element, strains strain, strains squeeze)
{
    stress_sample *own = stencil_samples(field, element);
    double square = 0;
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++)
        if (stress_is_present(field, element, i / STRESS_HEIGHTS))
            square += replace_strain(&field->state.design->mesh.laminate.ply[i / STRESS_HEIGHTS],
                                     &own[i], strain[i], squeeze[i]);
    return square;
}

/*
 * Compute the strains of bent cross-sections of all elements from the present transverse stresses,
 * and the in-plane stresses with these strains.
 *   all [elements] out  work array
 * Returns the square root of the sum of the squared changes of the in-plane stresses (Pa).
 */
static double correct(stress_field *field, section *all)
{
    double square = 0;
    bend_fill(field, all);
    for (int element = 0; element < field->elements; element++) {
        strains strain, squeeze;
        warp_strains(field, element, all, strain, squeeze);
        square += replace_all(field, element, strain, squeeze);
    }
    return sqrt(square);
}

/* Return the number of samples of all elements. */
static size_t sample_count(const stress_field *field)
{
    return (size_t)field->elements * (size_t)field->layers * STRESS_HEIGHTS;
}

/*
 * Compute the difference of the in-plane stresses at a sample from those of straight cross-sections
 * (stress [3] out, Pa).
 *   index in  index of the sample among those of all elements
 */
static void correction_at(const stress_field *field, const stress_sample *sample, size_t index,
                          double stress[3])
{
    const size_t layer = index / STRESS_HEIGHTS % (size_t)field->layers;
    const double bent[6] = {sample->warp[0], sample->warp[1], sample->warp[2], 0, 0, 0};
    stencil_plane_stress(&field->state.design->mesh.laminate.ply[layer], bent, 0, stress);
    for (int k = 0; k < 3; k++)
        stress[k] += sample->squeeze[k];
}

/*
 * Return the square root of the sum of the squared differences of the in-plane stresses from those
 * of straight cross-sections (Pa).
 */
static double size_of_correction(const stress_field *field)
{
    double square = 0;
    for (size_t i = 0; i < sample_count(field); i++) {
        double stress[3];
        correction_at(field, &field->sample[i], i, stress);
        for (int k = 0; k < 3; k++)
            square += stress[k] * stress[k];
    }
    return sqrt(square);
}

/*
 * Return the ratio of the second change of the in-plane stresses to the first one, as the factor of
 * the first change that comes closest to the second one: negative where the changes alternate.
 *   before [samples] in  samples before the second change
 */
static double ratio_of_changes(const stress_field *field, const stress_sample *before)
{
    double product = 0, square = 0;
    for (size_t i = 0; i < sample_count(field); i++) {
        double first[3];
        correction_at(field, &before[i], i, first);
        for (int k = 0; k < 3; k++) {
            product += first[k] * (field->sample[i].plane[k] - before[i].plane[k]);
            square += first[k] * first[k];
        }
    }
    return square > 0 ? product / square : 0;
}

static void blend(double share, const double before[3], double now[3])
{
    for (int k = 0; k < 3; k++)
        now[k] = before[k] + share * (now[k] - before[k]);
}

/*
 * Multiply the second change of the in-plane stresses by a factor `share`, so that it includes the
 * further changes that would follow. With changes w, r w, r^2 w, ... the sum is w/(1 - r), which is
 * the first change and 1/(1 - r) of the second one. Where the changes do not alternate (r > 0), the
 * factor is 1.
 *   before [samples] in  samples before the second change
 */
static void sum_changes(const stress_field *field, const stress_sample *before)
{
    const double share = 1 / (1 - fmin(ratio_of_changes(field, before), 0));
    for (size_t i = 0; i < sample_count(field); i++) {
        stress_sample *now = &field->sample[i];
        blend(share, before[i].plane, now->plane);
        blend(share, before[i].warp, now->warp);
        blend(share, before[i].squeeze, now->squeeze);
        blend(share, before[i].lacking, now->lacking);
    }
}

/* Return the square root of the sum of the squared in-plane stresses (Pa). */
static double size_of_stresses(const stress_field *field)
{
    double square = 0;
    for (int i = 0; i < 3 * field->elements * field->layers * STRESS_HEIGHTS; i++)
        square += field->sample[i / 3].plane[i % 3] * field->sample[i / 3].plane[i % 3];
    return sqrt(square);
}

/* Set the stresses of all elements back to those with straight cross-sections. */
static void straighten(stress_field *field)
{
    strains none;
    memset(none, 0, sizeof none);
    for (int element = 0; element < field->elements; element++) {
        const stress_sample *own = stencil_samples(field, element);
        strains squeeze;
        for (int i = 0; i < 3 * field->layers * STRESS_HEIGHTS; i++)
            squeeze[i / 3][i % 3] = own[i / 3].balanced[i % 3];
        (void)replace_all(field, element, none, squeeze);
    }
    stress_equilibrium(field);
}

/*
 * Change the in-plane stresses for the second time, from the transverse stresses that follow from
 * the first change.
 *   first  in   size of the first change (Pa)
 *   all, before  work arrays, for [elements] sections and for all samples
 */
static void correct_again(stress_field *field, double first, section *all, stress_sample *before)
{
    const double most = 0.5; /* largest second change over the first one */
    stress_equilibrium(field);
    memcpy(before, field->sample, sample_count(field) * sizeof *before);
    const double second = correct(field, all);
    field->bend_change = first > 0 ? second / first : 0;
    field->is_straight = !(field->bend_change <= most);
    if (field->is_straight)
        straighten(field);
    else
        sum_changes(field, before);
}

int stress_warp(stress_field *field)
{
    section *all = calloc((size_t)field->elements, sizeof *all);
    stress_sample *before = malloc(sample_count(field) * sizeof *before);
    if (all && before) {
        const double whole = size_of_stresses(field);
        (void)correct(field, all);
        const double first = size_of_correction(field);
        field->bend_share = whole > 0 ? first / whole : 0;
        correct_again(field, first, all, before);
    }
    const int status = all && before ? 0 : -1;
    free(all);
    free(before);
    return status;
}
