/* SPDX-License-Identifier: BSD-2-Clause */
/* Stresses with a corrected displacement (stress_corrected.h). */
#include "stress_corrected.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../mesh/invert.h"
#include "node_forces.h"
#include "stress_equilibrium.h"
#include "stress_stencil.h"

enum { SHEAR = 8 }; /* index of the transverse shears 13 and 23 among the ten strains */

/* Transverse shear stresses 13 and 23, or shear strains, at all heights of an element. */
typedef double shears[STENCIL_SAMPLES][2];

/* ---- transverse shear ------------------------------------------------------------- */

/* Shear strains 13 and 23 of a ply under shear stresses 13 and 23 (strain [2] out). */
static void shear_strain(const laminate_ply *ply, const double stress[2], double strain[2])
{
    const double size = ply->c[3][3] * ply->c[4][4] - ply->c[3][4] * ply->c[4][3];
    strain[0] = (ply->c[3][3] * stress[0] - ply->c[3][4] * stress[1]) / size;
    strain[1] = (ply->c[4][4] * stress[1] - ply->c[4][3] * stress[0]) / size;
}

/*
 * Compute the transverse shear stresses (1/m) that balance a bending moment which grows along its
 * own direction with the gradient 1, in a flat laminate. direction = 0: moment 11 along direction
 * 1; direction = 1: moment 22 along direction 2.
 */
static void unit_shears(const stress_field *field, int element, double flex[6][6], int direction,
                        shears out)
{
    double rate[2][STENCIL_SAMPLES], sum[2][STENCIL_SAMPLES], bent[6];
    memset(rate, 0, sizeof rate);
    for (int i = 0; i < 6; i++)
        bent[i] = flex[i][3 + direction];
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const int layer = i / STRESS_HEIGHTS;
        double stress[3];
        stencil_plane_stress(&field->state.design->mesh.laminate.ply[layer], bent,
                             stress_height(field, layer, i % STRESS_HEIGHTS), stress);
        rate[direction][i] = -stress[direction];
        rate[1 - direction][i] = -stress[2];
    }
    for (int a = 0; a < 2; a++) {
        stencil_integrate(field, element, rate[a], sum[a]);
        for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++)
            out[i][a] = sum[a][i];
    }
}

/*
 * Return the work, per area, of given shear stresses on the shear strains that other shear stresses
 * cause. It is exact where both are quadratic in the height within each ply.
 */
static double shear_work(const stress_field *field, int element, shears first, shears second)
{
    static const double share[3][3] = {{4, 2, -1}, {2, 16, 2}, {-1, 2, 4}};
    double work = 0;
    for (int layer = 0; layer < field->layers; layer++) {
        const laminate_ply *ply = &field->state.design->mesh.laminate.ply[layer];
        for (int i = 0; i < 9 && stress_is_present(field, element, layer); i++) {
            const double *stress = first[layer * STRESS_HEIGHTS + i / 3];
            double strain[2];
            shear_strain(ply, second[layer * STRESS_HEIGHTS + i % 3], strain);
            work += share[i / 3][i % 3] / 30 * (ply->z[1] - ply->z[0]) *
                    (stress[0] * strain[0] + stress[1] * strain[1]);
        }
    }
    return work;
}

/*
 * Compute the transverse shear flexibility (m/N) of an element whose theory assumes shear strains
 * that are uniform through the thickness. Returns 0, or -1 if the plies cannot carry shear.
 */
static int uniform_flexibility(const stress_field *field, int element, double flexibility[2][2])
{
    memset(flexibility, 0, 4 * sizeof(double));
    for (int layer = 0; layer < field->layers; layer++) {
        const laminate_ply *ply = &field->state.design->mesh.laminate.ply[layer];
        for (int i = 0; i < 4 && stress_is_present(field, element, layer); i++)
            flexibility[i / 2][i % 2] += (ply->z[1] - ply->z[0]) * ply->c[4 - i / 2][4 - i % 2];
    }
    return invert(&flexibility[0][0], 2, 2);
}

/*
 * Compute the mean shear strains 13 and 23 that an element leaves out, in its shell axes: strains
 * of the recovered shear stresses minus strains that follow from its shear forces and its shear
 * flexibility. Returns 0, or -1 if the plies cannot carry shear.
 *   contrast in/out  largest ratio so far, over the elements, of the shear flexibility from
 *       equilibrium to that of the element
 */
static int lacking_shear(const stress_field *field, int element, double lacking[2],
                         double *contrast)
{
    const stress_sample *own = stencil_samples(field, element);
    double flex[6][6], flexibility[2][2], balanced[2], force[2];
    shears unit[2], recovered;
    if (stencil_flexure(field, element, flex) < 0)
        return -1;
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++)
        memcpy(recovered[i], own[i].shear, sizeof recovered[i]);
    for (int a = 0; a < 2; a++)
        unit_shears(field, element, flex, a, unit[a]);
    for (int i = 0; i < 4; i++)
        flexibility[i / 2][i % 2] = shear_work(field, element, unit[i / 2], unit[i % 2]);
    for (int a = 0; a < 2; a++)
        balanced[a] = flexibility[a][a];
    if (!field->state.design->mesh.formulation.equilibrium_shear &&
        uniform_flexibility(field, element, flexibility) < 0)
        return -1;
    stress_shear_resultants(field, element, force);
    for (int a = 0; a < 2; a++) {
        lacking[a] = shear_work(field, element, unit[a], recovered) - flexibility[a][0] * force[0] -
                     flexibility[a][1] * force[1];
        *contrast = fmax(*contrast, balanced[a] / flexibility[a][a]);
    }
    return 0;
}

/*
 * Add stress resultants to those of the correction for an element: minus the element's stiffness
 * times the shear strains that it leaves out (lacking_shear).
 *   resultant [10] in/out  resultants per area (N/m)
 *   contrast       in/out  largest ratio so far, over the elements, of the shear flexibility from
 *       equilibrium to that of the element
 */
static void add_shear(const stress_field *field, int element, double resultant[10],
                      double *contrast)
{
    const mesh *mesh = &field->state.design->mesh;
    const int type = mesh->element_type[element];
    const laminate_place *place = &mesh->place[type];
    double lacking[2], natural[2];
    if (lacking_shear(field, element, lacking, contrast) < 0)
        return;
    memcpy(natural, lacking, sizeof natural);
    for (int a = 0; a < 2 && place->is_general; a++)
        natural[a] = place->natural.base[2][2] * (place->natural.base[0][a] * lacking[0] +
                                                  place->natural.base[1][a] * lacking[1]);
    for (int i = 0; i < 10; i++)
        for (int a = 0; a < 2; a++) {
            const int shear = SHEAR + a, row = i > shear ? i : shear;
            const int column = i + shear - row;
            resultant[i] -=
                mesh->type[type].d[row * (row + 1) / 2 + column] / place->area * natural[a];
        }
}

/* ---- in-plane stresses ---------------------------------------------------------------- */

/*
 * Store the in-plane stresses that the straight cross-sections and the uniform normal stress 33 of
 * an element leave out, and add their resultants to those of the correction.
 *   lacking   [layers][STRESS_HEIGHTS] out     these stresses 11, 22 and 12 (Pa)
 *   resultant [10]                     in/out  resultants per area (N/m)
 */
static void add_plane(const stress_field *field, int element, double (*lacking)[3],
                      double resultant[10])
{
    static const int plane[3] = {0, 1, 5}, mean[3] = {0, 2, 6};
    const mesh *mesh = &field->state.design->mesh;
    const laminate_place *place = &mesh->place[mesh->element_type[element]];
    const double middle = (mesh->laminate.z[0] + mesh->laminate.z[1]) / 2;
    for (int i = 0; i < field->layers * STRESS_HEIGHTS; i++) {
        const int layer = i / STRESS_HEIGHTS, height = i % STRESS_HEIGHTS;
        const laminate_ply *ply = &mesh->laminate.ply[layer];
        const double z = stress_height(field, layer, height);
        double map[6][6];
        laminate_strain_map(&mesh->formulation, place, z, map);
        memcpy(lacking[i], stencil_samples(field, element)[i].lacking, sizeof lacking[i]);
        const double weight = laminate_cover(place, layer) * (ply->z[1] - ply->z[0]) *
                              (height == 1 ? 4 : 1) / 6 *
                              laminate_area_ratio(&mesh->formulation, place, z);
        for (int k = 0; k < 9; k++) {
            const double part = weight * map[plane[k / 3]][plane[k % 3]] * lacking[i][k / 3];
            resultant[mean[k % 3]] += part;
            resultant[mean[k % 3] + 1] += part * (z - middle) / mesh->laminate.thickness;
        }
    }
}

/* ---- displacement ------------------------------------------------------------------- */

/*
 * Return the largest displacement of all nodes (m). The displacement of a node is the mean of both
 * faces.
 */
static double largest(const mesh *mesh, const double *displacement)
{
    double square = 0;
    for (int node = 0; node < mesh->nodes; node++) {
        const uint16_t *dof = mesh->node_dof + (size_t)node * mesh->dof_per_node;
        double sum = 0;
        for (int i = 0; i < 3; i++)
            sum += dof[i] == PZS_CONSTRAINED ? 0 : displacement[dof[i]] * displacement[dof[i]];
        square = fmax(square, sum);
    }
    return sqrt(square);
}

static int allocate(const stress_field *field, stress_correction *correction)
{
    const size_t elements = (size_t)field->elements, layers = (size_t)field->layers;
    memset(correction, 0, sizeof *correction);
    correction->displacement =
        calloc((size_t)field->state.design->mesh.free_dof + 1, sizeof *correction->displacement);
    correction->resultant = calloc(elements, sizeof *correction->resultant);
    correction->lacking = calloc(elements * layers * STRESS_HEIGHTS, sizeof *correction->lacking);
    correction->electric = calloc(elements * layers, sizeof *correction->electric);
    return correction->displacement && correction->resultant && correction->lacking &&
                   correction->electric
               ? 0
               : -1;
}

static void release(stress_correction *correction)
{
    free(correction->displacement);
    free(correction->resultant);
    free(correction->lacking);
    free(correction->electric);
}

/*
 * Fill the correction of one element from its recovered stresses, and add the nodal forces of the
 * prescribed resultants to correction->displacement.
 *   contrast in/out  largest ratio so far, over the elements, of the shear flexibility from
 *       equilibrium to that of the element
 */
static void fill_element(const stress_field *field, int element, stress_correction *correction,
                         double *contrast)
{
    const mesh *mesh = &field->state.design->mesh;
    const size_t layers = (size_t)field->layers, first = (size_t)element * layers;
    double *resultant = correction->resultant[element], whole[10];
    add_shear(field, element, resultant, contrast);
    if (!field->is_straight)
        add_plane(field, element, correction->lacking + first * STRESS_HEIGHTS, resultant);
    for (int i = 0; i < 10; i++)
        whole[i] = resultant[i] * mesh->place[mesh->element_type[element]].area;
    node_add_resultants(mesh, element, whole, correction->displacement);
    for (int layer = 0; layer < field->layers; layer++) {
        stress_layer found;
        if (!stress_is_present(field, element, layer))
            continue;
        stress_layer_of(field, element, layer, &found);
        correction->electric[first + (size_t)layer] = found.displacement;
    }
}

/*
 * Compute the correction of a displacement from the stresses recovered from it, and the estimated
 * error of the displacement (field->theory_error). Returns whether the correction may be used.
 *
 * The correction assumes that the shear forces stay nearly the same. Where the structure prescribes
 * a shear strain instead, as in a corner between two clamped edges, the corrected shear strain is
 * wrong by the factor `contrast`: the shear flexibility from equilibrium over that of
 * the element. Laminates with a large contrast are therefore left uncorrected.
 */
static bool fill_correction(stress_field *field, const pzs_model *model,
                            stress_correction *correction)
{
    const double most = 3; /* largest ratio, over all elements, of the shear flexibility from
                              equilibrium to that of the element */
    const mesh *mesh = &field->state.design->mesh;
    double *change = correction->displacement, contrast = 0;
    for (int element = 0; element < field->elements; element++)
        fill_element(field, element, correction, &contrast);
    pzs_model_backsolve(model, change, change);
    const double size = largest(mesh, field->state.displacement);
    field->theory_error = size > 0 ? largest(mesh, change) / size : 0;
    for (int i = 0; i < mesh->free_dof; i++)
        change[i] += field->state.displacement[i];
    return contrast <= most && isfinite(field->theory_error);
}

/*
 * Replace recovered stresses by those of the corrected displacement, whose arrays the field then
 * owns. The recovered stresses are kept if they contain the stresses of bent cross-sections, but
 * those of the corrected displacement did not converge. Returns 0, or -1 if memory runs out.
 */
static int replace_by_corrected(stress_field *field, const stress_state *state,
                                const stress_correction *correction)
{
    const double theory_error = field->theory_error;
    stress_field corrected;
    const int status = stress_recover_with(&corrected, state, correction);
    stress_field *worse =
        status < 0 || (corrected.is_straight && !field->is_straight) ? &corrected : field;
    stress_free(worse);
    if (worse == field)
        *field = corrected;
    field->theory_error = theory_error;
    return status;
}

int stress_recover_corrected(stress_field *field, const stress_state *state, const pzs_model *model)
{
    stress_correction correction;
    if (stress_recover(field, state) < 0)
        return -1;
    const int status = allocate(field, &correction);
    if (status == 0 && fill_correction(field, model, &correction))
        return replace_by_corrected(field, state, &correction);
    release(&correction);
    return status;
}
