/* SPDX-License-Identifier: BSD-2-Clause */
/* Principal strains of both faces of a shell (face_strain.h). */
#include "face_strain.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/vector.h"
#include "design.h"

/*
 * One face of a quadrilateral element: its two mean edge vectors (`position`), and their changes
 * under the displacement (`displacement`).
 */
typedef struct cell {
    double position[2][3], displacement[2][3];
} cell;

/*
 * Compute the positions of both faces of the shell at all nodes, undeformed and displaced.
 *   point, moved [nodes][2][3] out  undeformed and displaced positions of both faces at each node
 */
static void face_points(const mesh *mesh, const double *displacement, double (*point)[2][3],
                        double (*moved)[2][3])
{
    static const scene_face faces[2] = {FACE_INNER, FACE_OUTER};
    for (int node = 0; node < mesh->nodes; node++)
        for (int face = 0; face < 2; face++)
            for (int i = 0; i < 3; i++) {
                const scene_component axis = (scene_component)((int)COMPONENT_X + i);
                point[node][face][i] = mesh->point[node].position[i] +
                                       mesh->laminate.z[face] * mesh->point[node].triad[2][i];
                moved[node][face][i] =
                    design_displacement(mesh, displacement, node, axis, faces[face]);
            }
}

static cell cell_of(const mesh *mesh, int element, int face, double (*point)[2][3],
                    double (*moved)[2][3])
{
    static const double sign[2][4] = {{-0.5, 0.5, 0.5, -0.5}, {-0.5, -0.5, 0.5, 0.5}};
    cell result;
    memset(&result, 0, sizeof result);
    for (int axis = 0; axis < 2; axis++)
        for (int corner = 0; corner < 4; corner++)
            for (int i = 0; i < 3; i++) {
                const int node = mesh->element[element][corner];
                result.position[axis][i] += sign[axis][corner] * point[node][face][i];
                result.displacement[axis][i] += sign[axis][corner] * moved[node][face][i];
            }
    return result;
}

/*
 * Compute both principal strains of one face of an element: the eigenvalues of e x = lambda g x
 * with the strain tensor e and metric tensor g, 2 x 2 in the basis of the two vectors between the
 * midpoints of opposite edges.
 *   strain [2] out  the lower and the higher principal strain
 */
static void principal_strains(const cell *cell, bool is_linear, double strain[2])
{
    double g[2][2], e[2][2];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            g[a][b] = vector_dot(cell->position[a], cell->position[b]);
            e[a][b] = (vector_dot(cell->position[a], cell->displacement[b]) +
                       vector_dot(cell->position[b], cell->displacement[a])) /
                      2;
            if (!is_linear)
                e[a][b] += vector_dot(cell->displacement[a], cell->displacement[b]) / 2;
        }
    const double area = g[0][0] * g[1][1] - g[0][1] * g[0][1];
    const double half = (g[1][1] * e[0][0] + g[0][0] * e[1][1] - 2 * g[0][1] * e[0][1]) / area / 2;
    const double product = (e[0][0] * e[1][1] - e[0][1] * e[0][1]) / area;
    const double root = sqrt(fmax(half * half - product, 0));
    strain[0] = half - root;
    strain[1] = half + root;
}

/*
 * Include the principal strains of one face of an element in the extreme strains of the shell.
 *   strain  [2] in  the lower and the higher principal strain
 */
static void include_strains(face_strains *found, const double strain[2], int element, int face)
{
    const double largest = fmax(fabs(strain[0]), fabs(strain[1]));
    if (largest > found->largest.strain)
        found->largest = (face_strain){largest, element, face};
    if (strain[0] < found->lowest.strain)
        found->lowest = (face_strain){strain[0], element, face};
}

bool face_strains_find(const mesh *mesh, const double *displacement, bool is_linear,
                       face_strains *found)
{
    double(*point)[2][3] = calloc((size_t)mesh->nodes, sizeof *point);
    double(*moved)[2][3] = calloc((size_t)mesh->nodes, sizeof *moved);
    const bool has_memory = point && moved;
    if (has_memory) {
        *found = (face_strains){{-1, 0, 0}, {HUGE_VAL, 0, 0}};
        face_points(mesh, displacement, point, moved);
    }
    for (int k = 0; has_memory && k < 2 * mesh->elements; k++) {
        const cell cell = cell_of(mesh, k / 2, k % 2, point, moved);
        double strain[2];
        principal_strains(&cell, is_linear, strain);
        include_strains(found, strain, k / 2, k % 2);
    }
    free(point);
    free(moved);
    return has_memory;
}

double face_strain_of_thickness(const mesh *mesh, const double *displacement, int element)
{
    const double thickness = mesh->laminate.thickness;
    double sum = 0;
    for (int corner = 0; corner < 4; corner++) {
        const int node = mesh->element[element][corner];
        double line[3];
        for (int i = 0; i < 3; i++) {
            const scene_component axis = (scene_component)((int)COMPONENT_X + i);
            line[i] = mesh->point[node].triad[2][i] +
                      (design_displacement(mesh, displacement, node, axis, FACE_OUTER) -
                       design_displacement(mesh, displacement, node, axis, FACE_INNER)) /
                          thickness;
        }
        sum += (vector_dot(line, line) - 1) / 2;
    }
    return sum / 4;
}
