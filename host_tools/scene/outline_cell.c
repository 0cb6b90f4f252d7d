/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Cells: elements, and parts of elements, as quadrilaterals in the plane of the outlines of
 * electrodes (outline_cell.h).
 */
#include "outline_cell.h"

#include <math.h>
#include <string.h>
#include "../quads/vector.h"
#include "surface.h"

static const double full_turn = 6.283185307179586476925287;

/*
 * For each plane of electrode outlines, the indices of its two coordinates among the five
 * coordinates x, y, z, theta1, theta2 of a corner of an element.
 */
static const int plane_axes[4][2] = {{3, 4}, {0, 1}, {0, 2}, {1, 2}};

int outline_elements(const scene *scene)
{
    return scene->quads ? (int)scene->quads->mesh.elements
                        : scene->line[0].elements * scene->line[1].elements;
}

/* ---- corners ---------------------------------------------------------- */

static void corners_of_quad(const quad_mesh *mesh, int element, double at[4][OUTLINE_AXES])
{
    for (int corner = 0; corner < 4; corner++) {
        memset(at[corner], 0, sizeof at[corner]);
        memcpy(at[corner], mesh->position[mesh->element[element][corner]],
               3 * sizeof at[corner][0]);
    }
}

/*
 * Find the corners of an element of a mesh whose sides are lines of constant surface coordinates
 * theta1 and theta2; the elements are numbered with theta2 fastest.
 */
static void corners_on_lines(const scene *scene, int element, double at[4][OUTLINE_AXES])
{
    const int i = element / scene->line[1].elements, j = element % scene->line[1].elements;
    for (int corner = 0; corner < 4; corner++) {
        at[corner][3] = scene->line[0].point[i + (corner == 1 || corner == 2)];
        at[corner][4] = scene->line[1].point[j + (corner >= 2)];
        const surface_point point = surface_at(&scene->surface, at[corner][3], at[corner][4]);
        memcpy(at[corner], point.position, sizeof point.position);
    }
}

/* ---- area of the surface over that of the plane ----------------------- */

/*
 * Compute the areas of the parallelogram that the two sides at corner r of a cell (element or part
 * of one) span.
 *   area  [2] out  in space, and in the plane of the outlines; the latter is negative if the
 *                  corners run clockwise there
 */
static void corner_areas(const outline_cell *cell, const int axis[2], int corner, double area[2])
{
    const double *here = cell->at[corner], *next = cell->at[(corner + 1) % 4],
                 *last = cell->at[(corner + 3) % 4];
    double along[3], across[3], normal[3];
    for (int i = 0; i < 3; i++) {
        along[i] = next[i] - here[i];
        across[i] = last[i] - here[i];
    }
    vector_cross(along, across, normal);
    area[0] = vector_length(normal);
    area[1] = (next[axis[0]] - here[axis[0]]) * (last[axis[1]] - here[axis[1]]) -
              (next[axis[1]] - here[axis[1]]) * (last[axis[0]] - here[axis[0]]);
}

/*
 * Fit a linear function, by least squares, to the ratios of two areas at the four corners of a cell
 * (element or part of one): area of the surface over area in the plane of the electrode outlines.
 */
static void fit_ratio(outline_cell *cell, const int axis[2], const double ratio[4])
{
    double square[3] = {0, 0, 0}, right[2] = {0, 0}, mean = 0;
    for (int corner = 0; corner < 4; corner++)
        mean += ratio[corner] / 4;
    for (int corner = 0; corner < 4; corner++) {
        const double u = cell->at[corner][axis[0]] - cell->centre[0],
                     v = cell->at[corner][axis[1]] - cell->centre[1];
        square[0] += u * u;
        square[1] += u * v;
        square[2] += v * v;
        right[0] += u * (ratio[corner] - mean);
        right[1] += v * (ratio[corner] - mean);
    }
    const double determinant = square[0] * square[2] - square[1] * square[1];
    cell->ratio[0] = mean;
    cell->ratio[1] = (square[2] * right[0] - square[1] * right[1]) / determinant;
    cell->ratio[2] = (square[0] * right[1] - square[1] * right[0]) / determinant;
}

double outline_cell_area(const outline_cell *cell, const polygon_sums *sums)
{
    return cell->ratio[0] * sums->area + cell->ratio[1] * sums->moment[0] +
           cell->ratio[2] * sums->moment[1];
}

/*
 * Compute all members of a cell that follow from its corners. A cell is the quadrilateral of an
 * element, or of a part of one, in the plane of the electrode outlines.
 */
static void finish(outline_cell *cell, outline_plane plane)
{
    const double steepest = 0.1; /* smallest permitted cosine of the angle between the surface and
                                    the plane of the electrode outlines: that of 84 degrees */
    const int *axis = plane_axes[plane];
    double ratio[4], sum = 0;
    int turned = 0;
    cell->is_steep = false;
    cell->centre[0] = cell->centre[1] = 0;
    for (int corner = 0; corner < 4; corner++) {
        double area[2];
        corner_areas(cell, axis, corner, area);
        turned += area[1] < 0;
        sum += area[1];
        cell->is_steep |= plane != OUTLINE_THETA && !(fabs(area[1]) > steepest * area[0]);
        ratio[corner] = area[0] / fabs(area[1]);
        for (int direction = 0; direction < 2; direction++)
            cell->centre[direction] += cell->at[corner][axis[direction]] / 4;
    }
    cell->is_steep |= turned % 4 != 0;
    cell->is_mirrored = sum < 0;
    for (int corner = 0; corner < 4; corner++)
        for (int direction = 0; direction < 2; direction++)
            cell->quad[corner][direction] =
                cell->at[cell->is_mirrored ? 3 - corner : corner][axis[direction]];
    cell->box = polygon_box_of((const double(*)[2])cell->quad, 4);
    fit_ratio(cell, axis, ratio);
    const polygon_sums sums = polygon_sums_of((const double(*)[2])cell->quad, 4, cell->centre);
    cell->plane_area = sums.area;
    cell->area = outline_cell_area(cell, &sums);
}

void outline_cell_of(const scene *scene, outline_plane plane, int element, outline_cell *cell)
{
    if (scene->quads)
        corners_of_quad(&scene->quads->mesh, element, cell->at);
    else
        corners_on_lines(scene, element, cell->at);
    finish(cell, plane);
}

static void corner_weights(const double natural[2], double weight[4])
{
    static const double sign[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int corner = 0; corner < 4; corner++)
        weight[corner] =
            (1 + sign[corner][0] * natural[0]) * (1 + sign[corner][1] * natural[1]) / 4;
}

/*
 * Interpolate the coordinates of the corners of a cell (element or part of one) at a point.
 *   natural [2]        in  natural coordinates of the point
 *   at [OUTLINE_AXES]  out  coordinates of the point
 */
static void interpolate(const outline_cell *cell, const double natural[2], double at[OUTLINE_AXES])
{
    double weight[4];
    corner_weights(natural, weight);
    for (int i = 0; i < OUTLINE_AXES; i++) {
        at[i] = 0;
        for (int corner = 0; corner < 4; corner++)
            at[i] += weight[corner] * cell->at[corner][i];
    }
}

void outline_cell_part(const outline_cell *whole, outline_plane plane, const double low[2],
                       const double high[2], outline_cell *part)
{
    const double corner[4][2] = {
        {low[0], low[1]}, {high[0], low[1]}, {high[0], high[1]}, {low[0], high[1]}};
    for (int i = 0; i < 4; i++)
        interpolate(whole, corner[i], part->at[i]);
    finish(part, plane);
}

void outline_cell_shift(outline_cell *cell, const double shift[2])
{
    for (int direction = 0; direction < 2; direction++) {
        for (int corner = 0; corner < 4; corner++)
            cell->quad[corner][direction] += shift[direction];
        cell->centre[direction] += shift[direction];
        cell->box.low[direction] += shift[direction];
        cell->box.high[direction] += shift[direction];
    }
}

/* ---- moves ------------------------------------------------------------ */

bool outline_cell_move(const scene *scene, outline_plane plane, int k, double shift[2])
{
    const int turns[2] = {k % 3, k / 3};
    for (int direction = 0; direction < 2; direction++) {
        shift[direction] = full_turn * (turns[direction] == 2 ? -1 : turns[direction]);
        if (turns[direction] != 0 && (plane != OUTLINE_THETA || scene->quads ||
                                      !surface_closes(&scene->surface, direction + 1)))
            return false;
    }
    return true;
}

/* ---- points inside ---------------------------------------------------- */

/*
 * Compute the bilinear weights of the four corners of a cell (element or part of one) at a point in
 * natural coordinates.
 */
expr_point outline_cell_point(const scene *scene, const outline_cell *cell, const double natural[2])
{
    double at[OUTLINE_AXES];
    interpolate(cell, natural, at);
    if (!scene->quads) {
        const surface_point point = surface_at(&scene->surface, at[3], at[4]);
        memcpy(at, point.position, sizeof point.position);
    }
    return (expr_point){at[0], at[1], at[2], at[3], at[4]};
}

/*
 * Compute the derivatives of all coordinates of a cell (element or part of one) along one natural
 * coordinate. The derivatives are exact, because the coordinates are linear functions of each
 * natural coordinate.
 */
static void derivative(const outline_cell *cell, const double natural[2], int direction,
                       double slope[OUTLINE_AXES])
{
    double low[2] = {natural[0], natural[1]}, high[2] = {natural[0], natural[1]};
    double from[OUTLINE_AXES], to[OUTLINE_AXES];
    low[direction] = -1;
    high[direction] = 1;
    interpolate(cell, low, from);
    interpolate(cell, high, to);
    for (int i = 0; i < OUTLINE_AXES; i++)
        slope[i] = (to[i] - from[i]) / 2;
}

/*
 * A point in the plane of the outlines is a bilinear function of the natural coordinates. Newton's
 * method inverts this function, starting from the middle of the cell (element or part of one). It
 * converges because the cell is convex. The
 * iterations end where rounding lets a step change nothing more.
 */
void outline_cell_natural(const outline_cell *cell, outline_plane plane, const double point[2],
                          double natural[2])
{
    enum { ITERATIONS = 12 };
    const int *axis = plane_axes[plane];
    natural[0] = natural[1] = 0;
    for (int k = 0; k < ITERATIONS; k++) {
        const double before[2] = {natural[0], natural[1]};
        double at[OUTLINE_AXES], along[OUTLINE_AXES], across[OUTLINE_AXES];
        interpolate(cell, natural, at);
        derivative(cell, natural, 0, along);
        derivative(cell, natural, 1, across);
        const double gap[2] = {point[0] - at[axis[0]], point[1] - at[axis[1]]};
        const double determinant =
            along[axis[0]] * across[axis[1]] - along[axis[1]] * across[axis[0]];
        natural[0] += (gap[0] * across[axis[1]] - gap[1] * across[axis[0]]) / determinant;
        natural[1] += (gap[1] * along[axis[0]] - gap[0] * along[axis[1]]) / determinant;
        for (int direction = 0; direction < 2; direction++)
            natural[direction] = fmax(-1, fmin(1, natural[direction]));
        if (memcmp(before, natural, sizeof before) == 0)
            return;
    }
}

double outline_cell_stretch(const outline_cell *cell, const double natural[2])
{
    double along[OUTLINE_AXES], across[OUTLINE_AXES], normal[3];
    derivative(cell, natural, 0, along);
    derivative(cell, natural, 1, across);
    vector_cross(along, across, normal);
    return vector_length(normal);
}
