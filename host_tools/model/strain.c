/* SPDX-License-Identifier: BSD-2-Clause */
/* Strains of elements, and strains at nodes as linear functions of the free dof (strain.h). */
#include "strain.h"
#include <math.h>
#include <string.h>
#include "../../lib/model/shell.h"

/*
 * Number of equal intervals of the thickness of a layer: from its inner face to its middle, and
 * from its middle to its outer face.
 */
enum { INTERVALS = 2 };

/* ---- strains of an element ------------------------------------------------ */

void strain_turn_stress(const double stress[6], double angle, double turned[6])
{
    const double c = cos(angle), s = sin(angle);
    const double in[6] = {stress[0], stress[1], stress[2], stress[3], stress[4], stress[5]};
    turned[0] = c * c * in[0] + s * s * in[1] + 2 * c * s * in[5];
    turned[1] = s * s * in[0] + c * c * in[1] - 2 * c * s * in[5];
    turned[2] = in[2];
    turned[3] = c * in[3] - s * in[4];
    turned[4] = c * in[4] + s * in[3];
    turned[5] = c * s * (in[1] - in[0]) + (c * c - s * s) * in[5];
}

void strain_turn(const double strain[6], double angle, double turned[6])
{
    double tensor[6];
    for (int i = 0; i < 6; i++)
        tensor[i] = strain[i] / (i < 3 ? 1 : 2);
    strain_turn_stress(tensor, angle, turned);
    for (int i = 3; i < 6; i++)
        turned[i] *= 2;
}

/* Index of the means of the in-plane strains 11, 22 and 12 among the ten strains of an element. */
static const int in_plane_mean[HEIGHT_ROWS] = {0, 2, 6};

/*
 * Compute the strains of an element, nonlinear in the displacement. An in-plane strain at height z
 * contains a term m z^2. The element adds it to the mean of the strain over both faces as a m, with
 * a constant a (pzs_element_type.height_squared). The strains are therefore computed twice, with
 * two values of a; m is the difference of the mean strains divided by that of a. With the element
 * option `quadratic: omitted` the caller replaces m by the part that follows from the strains.
 */
static void nonlinear_strains(const pzs_element_type *type, unsigned dof_per_node,
                              const double *displacement, double strain[STRAIN_COUNT])
{
    const double change = type->thickness * type->thickness;
    double modes[4][10], changed[4][10];
    pzs_element_type other = *type;
    for (int row = 0; row < HEIGHT_ROWS; row++)
        other.height_squared[0][row] += change;
    pzs_shell_strains_at(type, dof_per_node, displacement, modes);
    pzs_shell_strains_at(&other, dof_per_node, displacement, changed);
    memcpy(strain, modes[0], sizeof modes[0]);
    for (int row = 0; row < HEIGHT_ROWS; row++) {
        const int mean = in_plane_mean[row];
        strain[STRAIN_QUADRATIC + row] = (changed[0][mean] - modes[0][mean]) / change;
    }
}

/*
 * Compute the part of an element's in-plane strains that is quadratic in the height. It follows
 * from two numbers that the element has for each strain: the mean of its values at the outer and at
 * the inner face, and the difference between them.
 */
static void linear_quadratic_part(const laminate_heights *heights, double strain[STRAIN_COUNT])
{
    for (int row = 0; row < HEIGHT_ROWS; row++) {
        strain[STRAIN_QUADRATIC + row] = 0;
        for (int column = 0; column < HEIGHT_ROWS; column++)
            strain[STRAIN_QUADRATIC + row] +=
                heights->of_mean[row][column] * strain[in_plane_mean[column]] +
                heights->of_difference[row][column] * strain[in_plane_mean[column] + 1];
    }
}

static void heights_of(const mesh *mesh, int element, laminate_heights *heights)
{
    laminate_heights_of(&mesh->laminate, &mesh->formulation,
                        &mesh->place[mesh->element_type[element]], heights);
}

void strain_of_element(const mesh *mesh, int element, const double *displacement, bool is_nonlinear,
                       double strain[STRAIN_COUNT])
{
    const pzs_element_type *type = &mesh->type[mesh->element_type[element]];
    const unsigned dof = 4 * mesh->dof_per_node;
    double modes[2][4][10], scaled[SHELL_MAX], largest = 0;
    laminate_heights heights;
    for (unsigned i = 0; i < dof; i++)
        largest = fmax(largest, fabs(displacement[i]));
    if (is_nonlinear || !(largest > 0)) {
        nonlinear_strains(type, mesh->dof_per_node, displacement, strain);
        if (mesh->formulation.quadratic == SQUARES_OMITTED) {
            heights_of(mesh, element, &heights);
            linear_quadratic_part(&heights, strain);
        }
        return;
    }
    const double factor = 1e-6 * fmin(1, type->thickness) / largest;
    for (int side = 0; side < 2; side++) {
        for (unsigned i = 0; i < dof; i++)
            scaled[i] = (side ? -factor : factor) * displacement[i];
        pzs_shell_strains_at(type, mesh->dof_per_node, scaled, modes[side]);
    }
    for (int i = 0; i < 10; i++)
        strain[i] = (modes[0][0][i] - modes[1][0][i]) / (2 * factor);
    heights_of(mesh, element, &heights);
    linear_quadratic_part(&heights, strain);
}

void strain_at_height(const mesh *mesh, int element, const double strain[STRAIN_COUNT], double z,
                      double at_z[6])
{
    static const int mean[6] = {0, 2, 4, -1, -1, 6}, quadratic[6] = {0, 1, -1, -1, -1, 2};
    double map[6][6], natural[6] = {0};
    laminate_heights heights;
    heights_of(mesh, element, &heights);
    const double height = z - heights.middle;
    for (int i = 0; i < 6; i++) {
        if (mean[i] >= 0)
            natural[i] = strain[mean[i]] + height / heights.thickness * strain[mean[i] + 1];
        if (quadratic[i] >= 0 && mesh->formulation.quadratic != SQUARES_OF_FACES)
            natural[i] += laminate_height_excess(&heights, height, quadratic[i]) *
                          strain[STRAIN_QUADRATIC + quadratic[i]];
    }
    laminate_strain_map(&mesh->formulation, &mesh->place[mesh->element_type[element]], z, map);
    for (int i = 0; i < 6; i++) {
        at_z[i] = 0;
        for (int j = 0; j < 6; j++)
            at_z[i] += map[i][j] * natural[j];
    }
}

/* ---- outputs ---------------------------------------------------------------- */

/*
 * Return the height above the reference surface at which an output of the scene measures strain or
 * stress (m). It lies in the layer that the output names, or in the whole laminate if the output
 * names no layer.
 */
static double height_of(const mesh *mesh, const scene_output *output)
{
    const double *z = output->layer >= 0 ? mesh->laminate.ply[output->layer].z : mesh->laminate.z;
    return z[0] + (z[1] - z[0]) * output->height / INTERVALS;
}

bool strain_is_in(const mesh *mesh, const scene_output *output, int element, int node)
{
    const uint32_t present = mesh->place[mesh->element_type[element]].present_plies;
    const uint16_t *corner = mesh->element[element];
    const bool is_there =
        corner[0] == node || corner[1] == node || corner[2] == node || corner[3] == node;
    return is_there && (output->layer < 0 || (present >> output->layer & 1u));
}

double strain_area(const mesh *mesh, const scene_output *output, int node)
{
    double area = 0;
    for (int element = 0; element < mesh->elements; element++)
        if (strain_is_in(mesh, output, element, node))
            area += mesh->place[mesh->element_type[element]].area;
    return area;
}

double strain_of_output(const mesh *mesh, const scene_output *output, int element,
                        const double strain[STRAIN_COUNT])
{
    static const int component[] = {0, 1, 5}; /* indices of the strains 11, 22 and 12 in the Voigt
                                                 order 11 22 33 23 13 12 */
    double in_plane[STRAIN_COUNT], all[6], turned[6];
    memcpy(in_plane, strain, sizeof in_plane);
    in_plane[4] = in_plane[5] = 0; /* a gauge on the surface does not see the thickness strain */
    strain_at_height(mesh, element, in_plane, height_of(mesh, output), all);
    strain_turn(all, output->angle * 0.017453292519943295, turned);
    return turned[component[output->part]];
}

/*
 * Add the strain that an output of the scene has in one element, as a linear function of the
 * displacements, to a dense row.
 *   factor            in      factor by which the strain is multiplied
 *   dense  [free_dof] in/out  strain per unit of each free dof
 */
static void add_element(const mesh *mesh, const scene_output *output, int element, double factor,
                        double *dense)
{
    for (unsigned k = 0; k < 4 * mesh->dof_per_node; k++) {
        const unsigned corner = k / mesh->dof_per_node;
        const uint16_t node = mesh->element[element][corner],
                       dof = mesh->node_dof[node * mesh->dof_per_node + k % mesh->dof_per_node];
        double strain[STRAIN_COUNT], unit[SHELL_MAX] = {0};
        if (dof == PZS_CONSTRAINED)
            continue;
        unit[k] = 1;
        mesh_turn_to_triad(mesh, node, unit + corner * mesh->dof_per_node);
        strain_of_element(mesh, element, unit, false, strain);
        dense[dof] += factor * strain_of_output(mesh, output, element, strain);
    }
}

void strain_row(const mesh *mesh, const scene_output *output, int node, double *dense)
{
    const double area = strain_area(mesh, output, node);
    for (int element = 0; element < mesh->elements; element++)
        if (strain_is_in(mesh, output, element, node))
            add_element(mesh, output, element, mesh->place[mesh->element_type[element]].area / area,
                        dense);
}

int strain_check(const mesh *mesh, const scene_output *output, int node, char *error)
{
    if (strain_area(mesh, output, node) > 0)
        return 0;
    return scene_fault(output->where.at, error,
                       "layer '%s' of output '%s' is absent at %s, where it has no patch; choose "
                       "another place or another layer",
                       mesh->scene->layer[output->layer].name, output->name,
                       mesh_node_text(mesh, node).text);
}
