/* SPDX-License-Identifier: BSD-2-Clause */
/* Electrodes whose area is given by a formula (outline_formula.h). */
#include "outline_formula.h"

#include <math.h>
#include <string.h>

static double grid_line(int i)
{
    return -1 + 2.0 * i / FORMULA_GRID;
}

int formula_sample(const scene *scene, const outline_cell *cell, const scene_outline *outline,
                   formula_grid value, char *error)
{
    for (int i = 0; i <= FORMULA_GRID; i++)
        for (int j = 0; j <= FORMULA_GRID; j++) {
            const double natural[2] = {grid_line(i), grid_line(j)};
            const expr_point point = outline_cell_point(scene, cell, natural);
            value[i][j] = expr_value(outline->inside, &point);
            if (!isfinite(value[i][j]))
                return scene_fault(outline->at, error,
                                   "the outline '%.60s' is not a finite number at x = %g, y = %g, "
                                   "z = %g; correct its formula",
                                   expr_text(outline->inside), point.x, point.y, point.z);
        }
    return 0;
}

/*
 * Find the corners of triangle k (0 or 1) of the square in column i and row j of the grid into
 * which an element is divided.
 *   corner [3][2] out  column and row of the grid point at each corner
 */
static void triangle_of(int i, int j, int k, int corner[3][2])
{
    static const int offset[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
    for (int vertex = 0; vertex < 3; vertex++) {
        corner[vertex][0] = i + offset[k][vertex][0];
        corner[vertex][1] = j + offset[k][vertex][1];
    }
}

/*
 * Return the fraction (0 to 1) of the area of a triangle in which a linear function is positive.
 * value [3]: the function at the corners
 */
static double positive_part(const double value[3])
{
    int positive = 0, lone = 0;
    for (int vertex = 0; vertex < 3; vertex++)
        positive += value[vertex] > 0;
    for (int vertex = 0; vertex < 3; vertex++)
        if ((value[vertex] > 0) == (positive == 1))
            lone = vertex;
    if (positive == 0 || positive == 3)
        return positive / 3;
    const double own = value[lone], next = value[(lone + 1) % 3], last = value[(lone + 2) % 3];
    const double part = own / (own - next) * (own / (own - last));
    return positive == 1 ? part : 1 - part;
}

double formula_share(const outline_cell *cell, formula_grid value)
{
    double inside = 0, all = 0;
    for (int i = 0; i < FORMULA_GRID; i++)
        for (int j = 0; j < FORMULA_GRID; j++) {
            const double middle[2] = {grid_line(i) + 1.0 / FORMULA_GRID,
                                      grid_line(j) + 1.0 / FORMULA_GRID};
            const double area = outline_cell_stretch(cell, middle);
            all += area;
            for (int k = 0; k < 2; k++) {
                int corner[3][2];
                double own[3];
                triangle_of(i, j, k, corner);
                for (int vertex = 0; vertex < 3; vertex++)
                    own[vertex] = value[corner[vertex][0]][corner[vertex][1]];
                inside += area * positive_part(own) / 2;
            }
        }
    return inside / all;
}

/* ---- pieces ----------------------------------------------------------- */

/*
 * Find the point on the side from corner a to corner b at which a linear function with the values
 * of_a and of_b is 0.
 */
static void crossing(const double a[2], const double b[2], double of_a, double of_b, double at[2])
{
    for (int i = 0; i < 2; i++)
        at[i] = a[i] + of_a / (of_a - of_b) * (b[i] - a[i]);
}

/*
 * Draw, in a picture of an electrode, the part of a triangle in which a linear function is
 * positive, or the line on which it is 0. value [3]: the function at the corners
 */
static void draw_triangle(const double (*corner)[2], const double value[3], int element,
                          bool draws_outline, outline_draw *draw, void *context)
{
    double area[4][2], line[2][2];
    size_t points = 0, ends = 0;
    for (int vertex = 0; vertex < 3; vertex++) {
        const int next = (vertex + 1) % 3;
        if (value[vertex] > 0)
            memcpy(area[points++], corner[vertex], sizeof *area);
        if ((value[vertex] > 0) == (value[next] > 0))
            continue;
        crossing(corner[vertex], corner[next], value[vertex], value[next], line[ends]);
        memcpy(area[points++], line[ends++], sizeof *area);
    }
    if (draws_outline && ends == 2)
        draw(context, element, (const double(*)[2])line, ends);
    else if (!draws_outline && points >= 3)
        draw(context, element, (const double(*)[2])area, points);
}

void formula_pieces(formula_grid value, int element, bool draws_outline, outline_draw *draw,
                    void *context)
{
    for (int k = 0; k < 2 * FORMULA_GRID * FORMULA_GRID; k++) {
        int corner[3][2];
        double at[3][2], own[3];
        triangle_of(k / 2 / FORMULA_GRID, k / 2 % FORMULA_GRID, k % 2, corner);
        for (int vertex = 0; vertex < 3; vertex++) {
            own[vertex] = value[corner[vertex][0]][corner[vertex][1]];
            for (int direction = 0; direction < 2; direction++)
                at[vertex][direction] = grid_line(corner[vertex][direction]);
        }
        draw_triangle((const double(*)[2])at, own, element, draws_outline, draw, context);
    }
}
