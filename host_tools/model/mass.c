/* SPDX-License-Identifier: BSD-2-Clause */
/* Element mass matrices of a mesh, and products with the mass matrix (mass.h). */
#include "mass.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"
#include "../../lib/modes/element_mass.h"
#include "../mesh/corner_weight.h"
#include "../quads/vector.h"
#include "node_forces.h"

/*
 * FUNCTIONS: number of functions of the height that describe the displacement in a laminate of
 * thickness h; at the height t above its middle they are 1, t and h (1 - 4 t^2/h^2). POINTS: number
 * of Gauss points in a ply.
 */
enum { FUNCTIONS = 3, POINTS = 4 };

/*
 * For each of the 7 dof of a node, the function of the height by which the dof moves the points
 * through the thickness (0: constant, 1: linear, 2: quadratic), and the displacement component.
 */
static const int function_of[7] = {0, 0, 0, 1, 1, 1, 2}, component_of[7] = {0, 1, 2, 0, 1, 2, 2};

/*
 * Points of the Gauss quadrature on [-1, 1], exact for polynomials up to the seventh degree; the
 * integrands of the mass matrix are of the sixth degree.
 */
static const double gauss_x[POINTS] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                       0.8611363115940526};
static const double gauss_w[POINTS] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                       0.3478548451374538};

/*
 * Add the contribution of one height to the moments m of the mass over the thickness: weight times
 * f f'. The vector f holds the displacement functions 1, t and h (1 - 4 t^2/h^2) at the height t
 * above the middle of a laminate of thickness h.
 */
static void add_moments(double t, double h, double weight, double m[FUNCTIONS][FUNCTIONS])
{
    const double f[FUNCTIONS] = {1, t, h * (1 - 4 * t * t / (h * h))};
    for (int i = 0; i < FUNCTIONS; i++)
        for (int j = 0; j < FUNCTIONS; j++)
            m[i][j] += weight * f[i] * f[j];
}

/*
 * Compute integrals over the thickness of an element, per area, for its mass matrix: density times
 * two displacement functions (constant, linear, quadratic in the height z) times (1 + k1 z)(1 + k2
 * z) with the principal curvatures k1, k2. Each ply counts by the fraction of the area that it
 * covers.
 *   m [FUNCTIONS][FUNCTIONS] out  integral for each pair of displacement functions
 */
static void moments(const laminate *laminate, const laminate_place *place, double per_area,
                    double m[FUNCTIONS][FUNCTIONS])
{
    const double middle = (laminate->z[0] + laminate->z[1]) / 2;
    memset(m, 0, sizeof(double[FUNCTIONS][FUNCTIONS]));
    add_moments(0, laminate->thickness, per_area, m);
    for (int layer = 0; layer < laminate->plies; layer++) {
        const laminate_ply *ply = &laminate->ply[layer];
        const double half = (ply->z[1] - ply->z[0]) / 2, centre = (ply->z[0] + ply->z[1]) / 2;
        for (int point = 0; point < POINTS && place->present_plies >> layer & 1u; point++) {
            const double z = centre + half * gauss_x[point];
            const double metric = (1 + place->curvature[0] * z) * (1 + place->curvature[1] * z);
            add_moments(
                z - middle, laminate->thickness,
                half * gauss_w[point] * ply->density * metric * laminate_cover(place, layer), m);
        }
    }
}

/*
 * Entry of an element's mass matrix for two of its corners, divided by the mass of the element. In
 * the consistent matrix the entry follows from bilinear interpolation; in the lumped matrix all
 * mass is at the corners.
 *   lumped in  weight of the lumped matrix in the mean of both matrices, 0 to 1
 */
static double share(const laminate_place *place, int row, int column, double lumped)
{
    const int is_opposite = (row ^ column) == 2;
    const double at_corner = row == column ? 0.25 * corner_share(place, row) : 0;
    double consistent = 2.0 / 36;
    if (row == column)
        consistent = 4.0 / 36;
    if (is_opposite)
        consistent = 1.0 / 36;
    consistent += corner_pair_excess(place, row, column);
    return (1 - lumped) * consistent + lumped * at_corner;
}

/* Cosine of the angle between local axis a of node p and local axis b of node q. */
static double cosine_between(const surface_point *p, int a, const surface_point *q, int b)
{
    return p->triad[a][0] * q->triad[b][0] + p->triad[a][1] * q->triad[b][1] +
           p->triad[a][2] * q->triad[b][2];
}

static void fill_element(const mesh *mesh, int element, double lumped,
                         double m[FUNCTIONS][FUNCTIONS], double *entry)
{
    const int dof_per_node = (int)mesh->dof_per_node;
    const laminate_place *place = &mesh->place[mesh->element_type[element]];
    for (int row = 0; row < 4 * dof_per_node; row++)
        for (int column = 0; column <= row; column++) {
            const int row_corner = row / dof_per_node, column_corner = column / dof_per_node,
                      i = row % dof_per_node, j = column % dof_per_node;
            const surface_point *row_point = &mesh->point[mesh->element[element][row_corner]],
                                *column_point = &mesh->point[mesh->element[element][column_corner]];
            const double cosine =
                cosine_between(row_point, component_of[i], column_point, component_of[j]);
            *entry++ = place->area * share(place, row_corner, column_corner, lumped) *
                       m[function_of[i]][function_of[j]] * cosine;
        }
}

/*
 * Compute the displacement and rotation of a concentrated mass, as vectors in space, for a unit of
 * one dof of a corner of its element. With the normal D and the difference beta of both faces'
 * displacements over the thickness, the rotation is D x beta.
 *   index in  dof of the corner, 0 to 6
 */
static void motion_of_mass(const mesh *mesh, const mesh_mass *mass, int corner, int index,
                           double displacement[3], double rotation[3])
{
    const surface_point *point = &mesh->point[mesh->element[mass->element][corner]];
    const double weight = mass->weight[corner];
    const double height = node_face_height(mass->face, mesh->laminate.thickness);
    const double of_function[FUNCTIONS] = {1, height, 0};
    vector_cross(point->triad[2], point->triad[component_of[index]], rotation);
    for (int i = 0; i < 3; i++) {
        displacement[i] =
            weight * of_function[function_of[index]] * point->triad[component_of[index]][i];
        rotation[i] *= function_of[index] == 1 ? weight : 0;
    }
}

/* Add a concentrated mass to the packed mass matrix of its element. */
static void add_mass(const mesh *mesh, const mesh_mass *mass, double *entry)
{
    const int dof_per_node = (int)mesh->dof_per_node;
    double displacement[SHELL_MAX][3], rotation[SHELL_MAX][3];
    for (int row = 0; row < 4 * dof_per_node; row++) {
        motion_of_mass(mesh, mass, row / dof_per_node, row % dof_per_node, displacement[row],
                       rotation[row]);
        for (int column = 0; column <= row; column++)
            *entry++ += mass->mass * vector_dot(displacement[row], displacement[column]) +
                        mass->inertia * vector_dot(rotation[row], rotation[column]);
    }
}

static size_t entries(const mesh *mesh)
{
    return SHELL_PACKED(4 * (size_t)mesh->dof_per_node);
}

int mass_missing(const design *design, char names[SCENE_ERROR])
{
    int missing = 0;
    size_t length = 0;
    names[0] = '\0';
    for (int k = 0; k < design->materials; k++) {
        int used = 0;
        for (int i = 0; i < design->layers; i++)
            used |= design->layer[i].material == k;
        if (!used || design->material[k].density > 0)
            continue;
        if (length + SCENE_NAME + 8 < SCENE_ERROR / 2)
            length += (size_t)snprintf(names + length, SCENE_ERROR - length, "%s'%s'",
                                       missing ? ", " : "", design->material[k].name);
        missing++;
    }
    return missing;
}

/* Refuse a scene in which a density is missing. Returns 0, or -1 with error filled. */
static int check_densities(const design *design, char *error)
{
    char names[SCENE_ERROR];
    const int missing = mass_missing(design, names);
    if (missing == 0)
        return 0;
    return scene_fault(design->at_layers, error,
                       "no density in %s%.200s: vibration needs the mass; add `density` to "
                       "materials, 7800 for steel in kg/m3",
                       missing == 1 ? "material " : "materials ", names);
}

int mass_build(mass *mass, const design *design, double lumped, char *error)
{
    const mesh *mesh = &design->mesh;
    memset(mass, 0, sizeof *mass);
    if (check_densities(design, error) < 0)
        return -1;
    mass->mesh = mesh;
    mass->entry = malloc((size_t)mesh->elements * entries(mesh) * sizeof *mass->entry);
    if (!mass->entry)
        return scene_fault(design->at, error, "the mass of %d elements does not fit into memory",
                           mesh->elements);
    for (int element = 0; element < mesh->elements; element++) {
        double integral[FUNCTIONS][FUNCTIONS];
        moments(&mesh->laminate, &mesh->place[mesh->element_type[element]],
                design->dynamics.mass_per_area, integral);
        fill_element(mesh, element, lumped, integral,
                     mass->entry + (size_t)element * entries(mesh));
    }
    for (int k = 0; k < mesh->masses; k++)
        add_mass(mesh, &mesh->mass[k], mass->entry + (size_t)mesh->mass[k].element * entries(mesh));
    return 0;
}

void mass_free(mass *mass)
{
    free(mass->entry);
    memset(mass, 0, sizeof *mass);
}

const double *mass_element(const mass *mass, int element)
{
    return mass->entry + (size_t)element * entries(mass->mesh);
}

void mass_multiply(const mass *mass, const pzs_model *model, const double *vector, size_t count,
                   double *product)
{
    const size_t free_dof = (size_t)mass->mesh->free_dof;
    memset(product, 0, count * free_dof * sizeof *product);
    for (int element = 0; element < mass->mesh->elements; element++)
        for (size_t k = 0; k < count; k++) {
            double local[SHELL_MAX], force[SHELL_MAX];
            pzs_model_gather(model, mass->mesh->element[element], SHELL_NODES,
                             vector + k * free_dof, local);
            pzs_packed_multiply(mass_element(mass, element), 4 * mass->mesh->dof_per_node, local,
                                force);
            pzs_model_scatter(model, mass->mesh->element[element], SHELL_NODES, 1, force,
                              product + k * free_dof);
        }
}

/* ---- rigid motion ----------------------------------------------------- */

/*
 * Compute the values of the dof of a node when the structure moves as a rigid body.
 *   shift  [3] in   translation
 *   spin   [3] in   vector of a small rotation about the origin (rad)
 *   unit   [7] out  dof along the local axes: displacement midway between the faces; displacement
 *       of the outer face minus the inner face, over the thickness; seventh dof 0
 */
static void rigid_unknowns(const mesh *mesh, int node, const double shift[3], const double spin[3],
                           double unit[7])
{
    const surface_point *point = &mesh->point[node];
    const double middle = (mesh->laminate.z[0] + mesh->laminate.z[1]) / 2;
    double place[3], turned[3], lean[3];
    for (int i = 0; i < 3; i++)
        place[i] = point->position[i] + middle * point->triad[2][i];
    vector_cross(spin, place, turned);
    vector_cross(spin, point->triad[2], lean);
    memset(unit, 0, 7 * sizeof *unit);
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 3; i++) {
            unit[a] += point->triad[a][i] * (shift[i] + turned[i]);
            unit[3 + a] += point->triad[a][i] * lean[i];
        }
}

double mass_rigid(const mass *mass, const pzs_model *model, const double shift[3],
                  const double spin[3], double *force)
{
    const int dof_per_node = (int)mass->mesh->dof_per_node;
    double sum = 0;
    if (force)
        memset(force, 0, (size_t)mass->mesh->free_dof * sizeof *force);
    for (int element = 0; element < mass->mesh->elements; element++) {
        double unit[SHELL_MAX], product[SHELL_MAX];
        for (int corner = 0; corner < SHELL_NODES; corner++) {
            double of_node[7];
            rigid_unknowns(mass->mesh, mass->mesh->element[element][corner], shift, spin, of_node);
            memcpy(unit + corner * dof_per_node, of_node, (size_t)dof_per_node * sizeof *unit);
        }
        pzs_packed_multiply(mass_element(mass, element), 4 * (uint32_t)dof_per_node, unit, product);
        for (int i = 0; i < 4 * dof_per_node; i++)
            sum += unit[i] * product[i];
        if (force)
            pzs_model_scatter(model, mass->mesh->element[element], SHELL_NODES, 1, product, force);
    }
    return sum;
}
