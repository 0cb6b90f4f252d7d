/* SPDX-License-Identifier: BSD-2-Clause */
/* Coloured surface and lines in the picture of a mesh (report_shell.h). */
#include "report_shell.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/vector.h"

/*
 * Limits of the detail of a picture of a mesh.
 *   FINE                      largest number of cells (quadrilaterals) whose sides are drawn
 *   SPACE_PIECES, MAP_PIECES  largest number of coloured pieces in a picture in space and on a map
 *   SIDE_PIECES               largest number of pieces along a side of a cell
 */
enum { FINE = 3000, SPACE_PIECES = 3000, MAP_PIECES = 6000, SIDE_PIECES = 12 };

/*
 * A cell (quadrilateral of a picture), and the sum of the coordinates of its corners towards the
 * viewer, by which cells are sorted.
 */
typedef struct shell_depth {
    double depth;
    int cell;
} shell_depth;

/*
 * Fill in points and cells (quadrilaterals) of a picture of the mesh in space: its nodes and its
 * elements.
 */
static void fill_from_elements(shell *shell)
{
    for (int n = 0; n < shell->points; n++) {
        shell->point[n].node = n;
        memcpy(shell->point[n].place, shell->mesh->point[n].position, sizeof(double[3]));
    }
    for (int k = 0; k < 4 * shell->cells; k++)
        shell->cell[k / 4][k % 4] = shell->mesh->element[k / 4][k % 4];
}

/*
 * Fill in points and cells (quadrilaterals) of a flat picture, a map over the surface coordinates
 * theta1 and theta2.
 */
static void fill_from_parameters(shell *shell)
{
    const scene_line *line = shell->mesh->line;
    const int rows = line[0].elements, columns = line[1].elements, across = columns + 1;
    shell->points = (rows + 1) * across;
    for (int k = 0; k < shell->points; k++)
        shell->point[k] =
            (shell_point){.node = mesh_node(shell->mesh, k / across, k % across),
                          .place = {line[0].point[k / across], line[1].point[k % across], 0}};
    for (int k = 0; k < shell->cells; k++) {
        const int first = k / columns * across + k % columns;
        const int corner[4] = {first, first + across, first + across + 1, first + 1};
        memcpy(shell->cell[k], corner, sizeof corner);
    }
}

/* Mark the nodes of all supports, except supports that include all nodes. */
static void find_supports(shell *shell)
{
    const design *design = shell->design;
    int *node = shell->work;
    for (int s = 0; s < design->supports; s++)
        if (design->support[s].where.type != WHERE_NODES)
            for (int k = mesh_select(shell->mesh, &design->support[s].where, node) - 1; k >= 0; k--)
                shell->point[node[k]].is_held = true;
}

int shell_open(shell *shell, FILE *file, const design *design, bool is_map)
{
    const mesh *mesh = &design->mesh;
    const size_t cells = (size_t)mesh->elements + 1, points = 2 * (size_t)mesh->nodes + 2;
    *shell = (struct shell){file, design, mesh, .points = mesh->nodes, .cells = mesh->elements};
    shell->is_map = is_map;
    shell->point = calloc(points, sizeof *shell->point);
    shell->cell = calloc(2 * cells, sizeof *shell->cell);
    shell->plan = calloc((size_t)design->actuators + 1, sizeof *shell->plan);
    shell->work = calloc(cells + points, 4 * sizeof(quad_side) + sizeof(shell_depth));
    if (!shell->point || !shell->cell || !shell->plan || !shell->work)
        return -1;
    view_begin(&shell->view, mesh, is_map);
    (is_map && view_has_parameters(mesh) ? fill_from_parameters : fill_from_elements)(shell);
    if (!is_map && (mesh->quads != NULL) == mesh->is_from_file)
        find_supports(shell);
    if (is_map)
        shell_find_plans(shell);
    for (int k = 0; k < shell->points && is_map; k++)
        view_include(&shell->view, shell->point[k].place);
    view_fit(&shell->view, SHELL_MAP_WIDTH, SHELL_MAP_WIDTH, 120);
    return 0;
}

void shell_close(shell *shell)
{
    free(shell->point);
    free(shell->cell);
    free(shell->plan);
    free(shell->work);
}

void shell_place(const shell *shell, int point, double place[3])
{
    const shell_point *own = &shell->point[point];
    const double *vector = shell->vector ? shell->vector + 3 * own->node : NULL;
    for (int i = 0; i < 3; i++)
        place[i] = own->place[i] + (vector ? shell->factor * vector[i] : 0);
}

void shell_at(const shell *shell, int point, double at[2])
{
    double place[3];
    shell_place(shell, point, place);
    view_project(&shell->view, place, at);
}

void shell_node(const shell *shell, const double *vector, int node, const char *style,
                double radius)
{
    struct shell drawn = *shell;
    double at[2];
    drawn.vector = vector;
    shell_at(&drawn, node, at);
    draw_disc(shell->file, style, at, radius);
}

void shell_include(shell *shell)
{
    for (int k = 0; k < shell->points; k++) {
        double place[3];
        shell_place(shell, k, place);
        view_include(&shell->view, place);
        view_include(&shell->view, shell->point[k].place);
    }
}

/*
 * Interpolate values at the four corners of a cell (quadrilateral of a picture) bilinearly at a
 * point inside (shell_inside).
 */
static double interpolate(const double corner[4], const double share[2])
{
    const double a = share[0], b = share[1];
    return (1 - a) * (1 - b) * corner[0] + a * (1 - b) * corner[1] + a * b * corner[2] +
           (1 - a) * b * corner[3];
}

void shell_inside(const shell *shell, int cell, const double share[2], double at[2])
{
    double corner[2][4];
    for (int r = 0; r < 4; r++) {
        shell_at(shell, shell->cell[cell][r], at);
        corner[0][r] = at[0];
        corner[1][r] = at[1];
    }
    at[0] = interpolate(corner[0], share);
    at[1] = interpolate(corner[1], share);
}

/*
 * Append a rectangular part of a cell (quadrilateral of a picture), given by two opposite corners
 * in the coordinates of shell_inside, to an SVG path.
 */
static void draw_part(const shell *shell, int cell, const double from[2], const double to[2])
{
    const double share[4][2] = {
        {from[0], from[1]}, {to[0], from[1]}, {to[0], to[1]}, {from[0], to[1]}};
    double at[4][2];
    for (int r = 0; r < 4; r++)
        shell_inside(shell, cell, share[r], at[r]);
    draw_polygon(shell->file, (const double(*)[2])at, 4);
}

/* Draw the outlines of several cells (quadrilaterals) of a picture, from the index `first` on. */
static void draw_cells(const shell *shell, int first, int count, const char *style)
{
    put(shell->file, DRAW_PATH, style);
    for (int k = first; k < first + count; k++)
        draw_part(shell, k, (const double[2]){0, 0}, (const double[2]){1, 1});
    put(shell->file, DRAW_PATH_END);
}

void shell_lines(const shell *shell, const double *vector, const char *style)
{
    struct shell drawn = *shell;
    drawn.vector = vector;
    if (shell->mesh->elements > FINE)
        shell_edges(shell, vector, style);
    else
        draw_cells(&drawn, 0, shell->cells, style);
}

int shell_outer_sides(const shell *shell)
{
    const int sides = 4 * shell->cells;
    int outer = 0;
    quad_side *side = shell->work;
    for (int k = 0; k < sides; k++) {
        const int *corner = shell->cell[k / 4];
        side[k] =
            quad_side_between((uint32_t)corner[k % 4], (uint32_t)corner[(k + 1) % 4], (uint32_t)k);
    }
    qsort(side, (size_t)sides, sizeof *side, quad_side_compare);
    for (int k = 0, end; k < sides; k = end) {
        for (end = k + 1; end < sides && quad_side_is_same(&side[k], &side[end]);)
            end++;
        if (end == k + 1)
            side[outer++] = side[k];
    }
    return outer;
}

void shell_outer_side(const shell *shell, int index, double ends[2][2])
{
    const quad_side *side = shell->work;
    shell_at(shell, (int)side[index].low, ends[0]);
    shell_at(shell, (int)side[index].high, ends[1]);
}

void shell_edges(const shell *shell, const double *vector, const char *style)
{
    struct shell drawn = *shell;
    drawn.vector = vector;
    const int sides = shell_outer_sides(shell);
    put(shell->file, DRAW_PATH, style);
    for (int k = 0; k < sides; k++) {
        double ends[2][2];
        shell_outer_side(&drawn, k, ends);
        draw_polygon(shell->file, (const double(*)[2])ends, 2);
    }
    put(shell->file, DRAW_PATH_END);
}

static int farther_first(const void *one, const void *other)
{
    const shell_depth *a = one, *b = other;
    if (a->depth != b->depth)
        return a->depth > b->depth ? 1 : -1;
    return (a->cell > b->cell) - (a->cell < b->cell);
}

/* Return the cells (quadrilaterals) of a mesh, sorted from the farthest to the nearest. */
static const shell_depth *sort_cells(const shell *shell)
{
    shell_depth *order = shell->work;
    for (int k = 0; k < shell->cells; k++) {
        order[k] = (shell_depth){0, k};
        for (int r = 0; r < 4; r++) {
            double place[3];
            shell_place(shell, shell->cell[k][r], place);
            order[k].depth += vector_dot(shell->view.axis[2], place);
        }
    }
    qsort(order, (size_t)shell->cells, sizeof *order, farther_first);
    return order;
}

/*
 * Draw a cell (quadrilateral) of a mesh in pieces, each in the colour of the value at its middle;
 * neighbouring pieces of the same colour in a row are drawn as one. Returns whether the cell has
 * values at all corners.
 */
static bool paint_cell(const shell *shell, int cell, const double *value, const draw_scale *scale,
                       int pieces)
{
    double own[4];
    for (int r = 0; r < 4; r++)
        own[r] = value[shell->point[shell->cell[cell][r]].node];
    const bool has_values = isfinite(own[0] + own[1] + own[2] + own[3]);
    const int parts = has_values ? pieces : 1;
    const double size = 1.0 / parts;
    for (int k = 0, end; k < parts * parts; k = end) {
        const int i = k % parts, j = k / parts;
        double middle[2] = {(i + 0.5) * size, (j + 0.5) * size};
        const char *colour = draw_colour(scale, interpolate(own, middle));
        for (end = k + 1; end % parts; end++) {
            middle[0] = (end % parts + 0.5) * size;
            if (draw_colour(scale, interpolate(own, middle)) != colour)
                break;
        }
        const double from[2] = {i * size, j * size}, to[2] = {(i + end - k) * size, (j + 1) * size};
        put(shell->file, DRAW_PATH, colour);
        draw_part(shell, cell, from, to);
        fputs("\"/>", shell->file);
    }
    return has_values;
}

/* Draw the values at the points as coloured discs; of very many, only every second or so on. */
static void draw_points(const shell *shell, const double *value, const draw_scale *scale)
{
    enum { MOST_DOTS = 2500 };
    const double radius = 0.35 * sqrt(shell->view.width * shell->view.height / shell->points);
    for (int k = 0; k < shell->points; k += 1 + shell->points / MOST_DOTS) {
        const double own = value[shell->point[k].node];
        double at[2];
        shell_at(shell, k, at);
        if (isfinite(own))
            draw_disc(shell->file, draw_colour(scale, own), at, fmin(fmax(radius, 1.5), 11));
    }
}

void shell_surface(const shell *shell, const double *value, const draw_scale *scale)
{
    const int most = shell->is_map ? MAP_PIECES : SPACE_PIECES;
    int pieces = 1;
    bool has_values = false;
    while (pieces < SIDE_PIECES && (pieces + 1) * (pieces + 1) * shell->cells <= most)
        pieces++;
    const shell_depth *order = sort_cells(shell);
    fputs("<g class=\"cells\">\n", shell->file);
    for (int k = 0; k < shell->cells; k++) {
        const int cell = order[k].cell;
        has_values |= paint_cell(shell, cell, value, scale, pieces);
        if (!shell->is_map && shell->mesh->elements <= FINE)
            draw_cells(shell, cell, 1, "edge");
        for (int r = 0; r < 4; r++)
            if (shell->point[shell->cell[cell][r]].is_held)
                shell_node(shell, shell->vector, shell->cell[cell][r], "pin", 2.5);
    }
    if (!has_values)
        draw_points(shell, value, scale);
    fputs("</g>\n", shell->file);
}
