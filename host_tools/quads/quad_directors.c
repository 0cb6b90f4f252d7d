/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Directors (unit normals) and local axes at the nodes of a mesh of quadrilaterals
 * in any arrangement (quad_steps.h).
 */
#include "quad_steps.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Angle between the normals of neighbouring elements above which their common edge counts as sharp
 * (degrees).
 */
static const double sharp_angle = 40;

static const double degree = 0.017453292519943295;

/* ---- vectors ----------------------------------------------------------- */

static void minus(const double from[3], const double subtracted[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = from[i] - subtracted[i];
}

/* ---- normals of the elements ------------------------------------------- */

/*
 * Compute the normal of an element at one of its corners, not scaled to length 1. Returns the angle
 * between the two sides there (rad).
 */
static double corner_normal(const quad_mesh *mesh, size_t element, int corner, double normal[3])
{
    const uint32_t *node = mesh->element[element];
    double next[3], previous[3];
    minus(mesh->position[node[(corner + 1) % 4]], mesh->position[node[corner]], next);
    minus(mesh->position[node[(corner + 3) % 4]], mesh->position[node[corner]], previous);
    vector_cross(next, previous, normal);
    return atan2(sqrt(vector_dot(normal, normal)), vector_dot(next, previous));
}

/*
 * Compute the unit normal at the centre of an element from its two diagonals. Returns twice the
 * area of the element.
 */
static double centre_normal(const quad_mesh *mesh, size_t element, double normal[3])
{
    const uint32_t *node = mesh->element[element];
    double first[3], second[3];
    minus(mesh->position[node[2]], mesh->position[node[0]], first);
    minus(mesh->position[node[3]], mesh->position[node[1]], second);
    vector_cross(first, second, normal);
    return vector_normalise(normal);
}

/*
 * Refuse elements whose area is below 1e-9 of the squared length of their longer diagonal. Returns
 * 0, or -1 after writing an error message with the name of the mesh file and the element.
 */
static int check_areas(const quad_mesh *mesh, const quad_origin *origin)
{
    for (size_t element = 0; element < mesh->elements; element++) {
        const uint32_t *node = mesh->element[element];
        double normal[3], first[3], second[3];
        const double area = centre_normal(mesh, element, normal);
        minus(mesh->position[node[2]], mesh->position[node[0]], first);
        minus(mesh->position[node[3]], mesh->position[node[1]], second);
        if (!(area > 1e-9 * fmax(vector_dot(first, first), vector_dot(second, second))))
            return quad_fault_at(origin->file, origin->element_at[element],
                                 "element %lld has no area: its nodes lie on a line or on each "
                                 "other; repair the mesh there",
                                 quad_element_label(mesh, element));
    }
    return 0;
}

/* ---- means of the corners ---------------------------------------------- */

static void add_corners(const quad_mesh *mesh)
{
    for (size_t element = 0; element < mesh->elements; element++)
        for (int corner = 0; corner < 4; corner++) {
            double normal[3];
            const double angle = corner_normal(mesh, element, corner, normal);
            double *director = mesh->director[mesh->element[element][corner]];
            if (vector_normalise(normal) > 0)
                for (int i = 0; i < 3; i++)
                    director[i] += angle * normal[i];
        }
}

static int mean_directors(const quad_mesh *mesh, const quad_origin *origin)
{
    add_corners(mesh);
    for (size_t node = 0; node < mesh->nodes; node++)
        if (!(vector_normalise(mesh->director[node]) > 1e-6))
            return quad_fault_at(origin->file, 0,
                                 "the elements at node %lld face opposite ways, so that it has no "
                                 "normal; repair the mesh there",
                                 quad_node_label(mesh, node));
    return 0;
}

/* ---- sharp edges ------------------------------------------------------- */

/*
 * State of the director (unit normal) of a node. INSIDE, ON_FREE_EDGE, ON_SHARP_EDGE: the node lies
 * inside a smooth sheet, on a free edge or on a sharp edge. CONTINUED: the node lies on a free
 * edge, and its director has been extrapolated from the nodes inside.
 */
typedef enum node_state { INSIDE, ON_FREE_EDGE, ON_SHARP_EDGE, CONTINUED } node_state;

/*
 * Mark both nodes of a side of an element as nodes of a free or a sharp edge; a node that is marked
 * as on a sharp edge keeps this mark.
 */
static void mark_edge(const quad_mesh *mesh, size_t element, int side, node_state state,
                      node_state *states)
{
    for (int k = 0; k < 2; k++) {
        node_state *own = &states[mesh->element[element][(side + k) % 4]];
        if (*own != ON_SHARP_EDGE)
            *own = state;
    }
}

/*
 * Find the nodes of the mesh on free and on sharp edges, and report the sharpest edge as a warning.
 */
static void mark_edges(const quad_mesh *mesh, const quad_topology *topology, node_state *states,
                       quad_warnings *warnings)
{
    for (size_t element = 0; element < mesh->elements; element++)
        for (int side = 0; side < 4; side++) {
            const uint32_t other = topology->neighbour[element][side];
            double own[3], next[3], both[3];
            if (other == QUAD_FREE) {
                mark_edge(mesh, element, side, ON_FREE_EDGE, states);
                continue;
            }
            centre_normal(mesh, element, own);
            centre_normal(mesh, other / 4, next);
            vector_cross(own, next, both);
            const double angle =
                atan2(sqrt(vector_dot(both, both)), vector_dot(own, next)) / degree;
            if (angle <= sharp_angle)
                continue;
            mark_edge(mesh, element, side, ON_SHARP_EDGE, states);
            if (angle > warnings->sharp_angle) {
                warnings->sharp_angle = angle;
                warnings->sharp[0] = quad_element_label(mesh, element);
                warnings->sharp[1] = quad_element_label(mesh, other / 4);
            }
        }
}

/* ---- fits of a quadric -------------------------------------------------- */

/*
 * Normal equations of the least-squares fit of a quadric surface around a node, which corrects its
 * director (mean of the corner normals) to second order in the element size. Fitted height of the
 * neighbours above the plane normal to the director, with weights 1/distance^2:
 *   s u + r v + k1 u^2/2 + k12 u v + k2 v^2/2
 *   u, v         tangential coordinates
 *   s, r         slopes of the surface
 *   k1, k12, k2  curvatures of the surface
 */
enum { COEFFICIENTS = 5, EQUATIONS = 15 };
typedef struct quadric {
    double tangent[2][3];     /* unit vectors along the two tangential coordinates u and v of the
                                 quadric surface that is fitted around a node */
    double matrix[EQUATIONS]; /* packed lower triangle of the matrix of the normal equations for the
                                 coefficients of a quadric surface */
    double coefficient[COEFFICIENTS]; /* right-hand side of the normal equations for the
                                         coefficients of a quadric surface; replaced by their
                                         solution, the coefficients */
} quadric;

static void start_quadric(const double director[3], quadric *sum)
{
    memset(sum, 0, sizeof *sum);
    quad_default_axis(director, -1, sum->tangent[0]);
    vector_cross(director, sum->tangent[0], sum->tangent[1]);
}

/*
 * Add a neighbouring node to the normal equations of the quadric that is fitted around a node.
 * Lengths are divided by `size`, the longest diagonal at the node.
 */
static void add_neighbour(const quad_mesh *mesh, size_t node, size_t other, double size,
                          quadric *sum)
{
    double chord[3];
    minus(mesh->position[other], mesh->position[node], chord);
    const double u = vector_dot(sum->tangent[0], chord) / size,
                 v = vector_dot(sum->tangent[1], chord) / size;
    const double w = vector_dot(mesh->director[node], chord) / size;
    const double row[COEFFICIENTS] = {u, v, u * u / 2, u * v, v * v / 2};
    const double weight = 1 / (u * u + v * v + w * w);
    for (int i = 0, k = 0; i < COEFFICIENTS; i++) {
        sum->coefficient[i] += weight * row[i] * w;
        for (int j = 0; j <= i; j++)
            sum->matrix[k++] += weight * row[i] * row[j];
    }
}

/*
 * Factor, by Cholesky's method, the packed matrix of the normal equations for the coefficients of a
 * quadric surface around a node. Returns whether the neighbouring nodes determine all coefficients.
 */
static bool factor_quadric(double factor[EQUATIONS])
{
    for (int i = 0; i < COEFFICIENTS; i++)
        for (int j = 0; j <= i; j++) {
            double *row = factor + i * (i + 1) / 2, *column = factor + j * (j + 1) / 2;
            const double before = row[j];
            for (int k = 0; k < j; k++)
                row[j] -= row[k] * column[k];
            if (j < i)
                row[j] /= column[j];
            else if (!(row[j] > 1e-4 * before))
                return false;
            else
                row[j] = sqrt(row[j]);
        }
    return true;
}

/*
 * Solve the factored normal equations for the coefficients of a quadric surface (solution [5]
 * in/out: right-hand side, replaced by the coefficients).
 */
static void solve_quadric(const double factor[EQUATIONS], double solution[COEFFICIENTS])
{
    for (int i = 0; i < COEFFICIENTS; i++) {
        for (int k = 0; k < i; k++)
            solution[i] -= factor[i * (i + 1) / 2 + k] * solution[k];
        solution[i] /= factor[i * (i + 1) / 2 + i];
    }
    for (int i = COEFFICIENTS - 1; i >= 0; i--) {
        for (int k = i + 1; k < COEFFICIENTS; k++)
            solution[i] -= factor[k * (k + 1) / 2 + i] * solution[k];
        solution[i] /= factor[i * (i + 1) / 2 + i];
    }
}

/*
 * Turn the director (unit normal) of a node by the slopes of the quadric surface that is fitted
 * around the node.
 */
static void turn_director(const quadric *sum, double director[3])
{
    for (int i = 0; i < 3; i++)
        director[i] -=
            sum->coefficient[0] * sum->tangent[0][i] + sum->coefficient[1] * sum->tangent[1][i];
    vector_normalise(director);
}

/*
 * Improve the directors (unit normals) of nodes inside a smooth sheet by fits of quadrics; a
 * director is not changed if its neighbours are too few or badly placed.
 */
static void fit_directors(const quad_mesh *mesh, const node_state *states, quadric *sums,
                          double *size)
{
    for (size_t node = 0; node < mesh->nodes; node++)
        start_quadric(mesh->director[node], &sums[node]);
    for (size_t element = 0; element < mesh->elements; element++)
        for (int corner = 0; corner < 4; corner++) {
            double diagonal[3];
            minus(mesh->position[mesh->element[element][(corner + 2) % 4]],
                  mesh->position[mesh->element[element][corner]], diagonal);
            size[mesh->element[element][corner]] =
                fmax(size[mesh->element[element][corner]], sqrt(vector_dot(diagonal, diagonal)));
        }
    for (size_t element = 0; element < mesh->elements; element++)
        for (int corner = 0; corner < 4; corner++)
            /*
             * Each element adds only the corners after `own` (k = 1) and diagonally opposite (k =
             * 2) to the fit around the node `own`: the corner before `own` is the corner after it
             * in the neighbouring element and would count twice.
             */
            for (int k = 1; k < 3; k++) {
                const uint32_t own = mesh->element[element][corner],
                               other = mesh->element[element][(corner + k) % 4];
                add_neighbour(mesh, own, other, size[own], &sums[own]);
            }
    for (size_t node = 0; node < mesh->nodes; node++)
        if (states[node] == INSIDE && factor_quadric(sums[node].matrix)) {
            solve_quadric(sums[node].matrix, sums[node].coefficient);
            if (hypot(sums[node].coefficient[0], sums[node].coefficient[1]) < 0.5)
                turn_director(&sums[node], mesh->director[node]);
        }
}

/* ---- free edges -------------------------------------------------------- */

/*
 * Normal equations of the slopes s and r of a director (unit normal) n = n0 + s t1 + r t2 on a free
 * edge, with tangents t1 and t2. Every chord c (straight line) to a neighbouring node with the
 * director m contributes (n + m).c = 0, which is exact on planes, spheres and cylinders.
 */
typedef struct slopes {
    double tangent[2][3]; /* tangents t1 and t2, unit vectors along which the director (unit normal)
                             of a node is inclined */
    double matrix[3];     /* entries 11, 12 and 22 of the symmetric matrix of the least-squares
                             equations for the two slopes of a director (unit normal of a node) */
    double right_side[2]; /* right-hand side of the least-squares equations for the slopes of a
                             director (unit normal of a node) along two tangents */
} slopes;

static void add_chord(const quad_mesh *mesh, size_t node, size_t other, slopes *sum)
{
    double chord[3], row[2];
    minus(mesh->position[other], mesh->position[node], chord);
    if (!(vector_normalise(chord) > 0))
        return;
    for (int k = 0; k < 2; k++)
        row[k] = vector_dot(sum->tangent[k], chord);
    const double rest =
        -vector_dot(mesh->director[node], chord) - vector_dot(mesh->director[other], chord);
    sum->matrix[0] += row[0] * row[0];
    sum->matrix[1] += row[0] * row[1];
    sum->matrix[2] += row[1] * row[1];
    sum->right_side[0] += row[0] * rest;
    sum->right_side[1] += row[1] * rest;
}

/*
 * Solve the least-squares equations for the slopes by which the director (unit normal) of a node on
 * a free edge inclines along two tangents, and compute the new director. Returns whether the chords
 * (straight lines) to the neighbouring nodes determine the director.
 *   out [3] out  the new director
 */
static bool solve_slopes(const slopes *sum, const double director[3], double out[3])
{
    const double trace = sum->matrix[0] + sum->matrix[2];
    const double determinant = sum->matrix[0] * sum->matrix[2] - sum->matrix[1] * sum->matrix[1];
    if (!(determinant > 0.01 * trace * trace))
        return false;
    const double slope1 =
        (sum->right_side[0] * sum->matrix[2] - sum->right_side[1] * sum->matrix[1]) / determinant;
    const double slope2 =
        (sum->right_side[1] * sum->matrix[0] - sum->right_side[0] * sum->matrix[1]) / determinant;
    for (int i = 0; i < 3; i++)
        out[i] = director[i] + slope1 * sum->tangent[0][i] + slope2 * sum->tangent[1][i];
    vector_normalise(out);
    return hypot(slope1, slope2) < 1;
}

/*
 * Sum the least-squares equations for the directors (unit normals) n of the nodes on free edges: (n
 * + m).c = 0 for each chord c to a corner, with director m, of the same element. Corners whose
 * director is not yet known, because they are on a free edge too, are left out.
 */
static void sum_chords(const quad_mesh *mesh, const node_state *states, slopes *sums)
{
    for (size_t node = 0; node < mesh->nodes; node++) {
        memset(&sums[node], 0, sizeof *sums);
        quad_default_axis(mesh->director[node], -1, sums[node].tangent[0]);
        vector_cross(mesh->director[node], sums[node].tangent[0], sums[node].tangent[1]);
    }
    for (size_t element = 0; element < mesh->elements; element++)
        for (int corner = 0; corner < 4; corner++)
            for (int k = 1; k < 4; k++) {
                const uint32_t own = mesh->element[element][corner],
                               other = mesh->element[element][(corner + k) % 4];
                if (states[own] == ON_FREE_EDGE &&
                    (states[other] == INSIDE || states[other] == CONTINUED))
                    add_chord(mesh, own, other, &sums[own]);
            }
}

/*
 * Extrapolate the directors (unit normals) of neighbouring nodes to the nodes on free edges. The
 * equations hold for unit vectors: solutions are scaled to length 1 and the equations solved again,
 * STEPS times in all; the last change is below rounding. Returns the number of extrapolated
 * directors.
 */
static size_t continue_round(const quad_mesh *mesh, node_state *states, slopes *sums)
{
    enum { STEPS = 6 };
    size_t changed = 0;
    for (int step = 1; step <= STEPS; step++) {
        sum_chords(mesh, states, sums);
        for (size_t node = 0; node < mesh->nodes; node++) {
            double found[3];
            if (states[node] != ON_FREE_EDGE ||
                !solve_slopes(&sums[node], mesh->director[node], found))
                continue;
            memcpy(mesh->director[node], found, sizeof found);
            states[node] = step == STEPS ? CONTINUED : states[node];
            changed += step == STEPS;
        }
    }
    return changed;
}

/*
 * Extrapolate the directors (unit normals) from the nodes inside the mesh to all nodes on free
 * edges; three repetitions also reach the corners of the mesh.
 */
static void continue_directors(const quad_mesh *mesh, node_state *states, slopes *sums)
{
    for (int round = 0; round < 3; round++)
        if (continue_round(mesh, states, sums) == 0)
            return;
}

/* ---- nodes that are not joined ------------------------------------------ */

typedef struct placed {
    double coordinate;
    uint32_t node;
} placed;

static int by_place(const void *left, const void *right)
{
    const placed *first = left, *second = right;
    if (first->coordinate != second->coordinate)
        return first->coordinate > second->coordinate ? 1 : -1;
    return (first->node > second->node) - (first->node < second->node);
}

/*
 * Count the pairs of nodes on free edges at nearly the same position, in elements that are not
 * connected there, and report the first pair as a warning.
 */
static void find_slit(const quad_mesh *mesh, const node_state *states, placed *list,
                      quad_warnings *warnings)
{
    double first[3];
    size_t count = 0;
    minus(mesh->position[mesh->element[0][2]], mesh->position[mesh->element[0][0]], first);
    const double near = 1e-5 * vector_normalise(first);
    for (size_t node = 0; node < mesh->nodes; node++)
        if (states[node] != INSIDE)
            list[count++] = (placed){mesh->position[node][0], (uint32_t)node};
    qsort(list, count, sizeof *list, by_place);
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count && list[j].coordinate - list[i].coordinate <= near; j++) {
            double gap[3];
            minus(mesh->position[list[i].node], mesh->position[list[j].node], gap);
            if (vector_dot(gap, gap) > near * near)
                continue;
            if (warnings->slits++ > 0)
                continue;
            warnings->slit[0] = quad_node_label(mesh, list[i].node);
            warnings->slit[1] = quad_node_label(mesh, list[j].node);
        }
}

/* ---- the whole ---------------------------------------------------------- */

int quad_directors(quad_mesh *mesh, const quad_origin *origin, const quad_topology *topology,
                   quad_warnings *warnings)
{
    node_state *states = calloc(mesh->nodes, sizeof *states);
    slopes *sums = calloc(mesh->nodes, sizeof *sums);
    placed *list = calloc(mesh->nodes, sizeof *list);
    quadric *fits = calloc(mesh->nodes, sizeof *fits);
    double *size = calloc(mesh->nodes, sizeof *size);
    int status = -1;
    mesh->director = calloc(mesh->nodes, sizeof *mesh->director);
    mesh->axis = calloc(mesh->nodes, sizeof *mesh->axis);
    if (!states || !sums || !list || !fits || !size || !mesh->director || !mesh->axis)
        quad_fault_at(origin->file, 0, "the mesh does not fit into memory; use a coarser one");
    else if (check_areas(mesh, origin) == 0 && mean_directors(mesh, origin) == 0) {
        mark_edges(mesh, topology, states, warnings);
        find_slit(mesh, states, list, warnings);
        fit_directors(mesh, states, fits, size);
        continue_directors(mesh, states, sums);
        const int common = quad_common_axis(mesh);
        for (size_t node = 0; node < mesh->nodes; node++)
            quad_default_axis(mesh->director[node], common, mesh->axis[node]);
        status = 0;
    }
    free(states);
    free(sums);
    free(list);
    free(fits);
    free(size);
    return status;
}
