/* SPDX-License-Identifier: BSD-2-Clause */
/* Coloured surface and lines in the picture of a mesh (report_shell.h). */
#include "report_shell.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/vector.h"

/*
 * Limits of the detail of a picture of a mesh. FINE: largest number of cells (quadrilaterals) whose
 * sides are drawn. SPACE_PIECES, MAP_PIECES: largest number of coloured pieces of all cells in a
 * picture in space and on a map. SIDE_PIECES: largest number of pieces along a side of a cell.
 */
enum { FINE = 3000, SPACE_PIECES = 3000, MAP_PIECES = 6000, SIDE_PIECES = 12 };

/*
 * A cell (quadrilateral) of a picture and its depth, by which cells are sorted: the sum of the
 * coordinates of its corners towards the viewer.
 */
typedef struct shell_depth {
    double depth;
    int cell;
} shell_depth;

/* Let the nodes and elements of the mesh be the points and cells of its picture. */
static void fill_from_elements(shell *shell)
{
    for (int n = 0; n < shell->points; n++) {
        shell->node[n] = n;
        memcpy(shell->place[n], shell->mesh->point[n].position, sizeof shell->place[n]);
    }
    for (int k = 0; k < 4 * shell->cells; k++)
        shell->cell[k / 4][k % 4] = shell->mesh->element[k / 4][k % 4];
}

/*
 * Fill in points and cells (quadrilaterals) of a flat picture (map) over the surface coordinates
 * theta1 and theta2.
 */
static void fill_from_parameters(shell *shell)
{
    const scene_line *line = shell->mesh->line;
    const int rows = line[0].elements, columns = line[1].elements, across = columns + 1;
    shell->points = (rows + 1) * across;
    for (int k = 0; k < shell->points; k++) {
        shell->node[k] = mesh_node(shell->mesh, k / across, k % across);
        shell->place[k][0] = line[0].point[k / across];
        shell->place[k][1] = line[1].point[k % across];
    }
    for (int k = 0; k < shell->cells; k++) {
        const int first = k / columns * across + k % columns;
        const int corner[4] = {first, first + across, first + across + 1, first + 1};
        memcpy(shell->cell[k], corner, sizeof corner);
    }
}

/*
 * Mark the nodes of all supports, except supports that include all nodes, for a picture.
 *   node [nodes] out  work array
 */
static void find_supports(shell *shell, int *node)
{
    const design *design = shell->design;
    for (int s = 0; s < design->supports; s++)
        if (design->support[s].where.type != WHERE_NODES)
            for (int k = mesh_select(shell->mesh, &design->support[s].where, node) - 1; k >= 0; k--)
                shell->is_held[node[k]] = true;
}

int shell_open(shell *shell, FILE *file, const design *design, bool is_map)
{
    const mesh *mesh = &design->mesh;
    const size_t cells = (size_t)mesh->elements + 1, points = 2 * (size_t)mesh->nodes + 2;
    *shell = (struct shell){.file = file,
                            .design = design,
                            .mesh = mesh,
                            .is_map = is_map,
                            .points = mesh->nodes,
                            .cells = mesh->elements};
    shell->node = calloc(points, sizeof *shell->node);
    shell->place = calloc(points, sizeof *shell->place);
    shell->cell = calloc(2 * cells, sizeof *shell->cell);
    shell->is_held = calloc((size_t)mesh->nodes, sizeof *shell->is_held);
    shell->plan = calloc((size_t)design->actuators + 1, sizeof *shell->plan);
    shell->work = calloc(cells, 4 * sizeof(quad_side) + sizeof(shell_depth));
    if (!shell->node || !shell->place || !shell->cell || !shell->is_held || !shell->plan ||
        !shell->work)
        return -1;
    view_begin(&shell->view, mesh, is_map);
    if (!is_map && (mesh->quads != NULL) == mesh->is_from_file)
        find_supports(shell, shell->node);
    if (is_map && view_has_parameters(mesh))
        fill_from_parameters(shell);
    else
        fill_from_elements(shell);
    if (is_map)
        shell_find_plans(shell);
    for (int k = 0; k < shell->points && is_map; k++)
        view_include(&shell->view, shell->place[k]);
    view_fit(&shell->view, SHELL_MAP_WIDTH, SHELL_MAP_WIDTH, 120);
    return 0;
}

void shell_close(shell *shell)
{
    free(shell->node);
    free(shell->place);
    free(shell->cell);
    free(shell->is_held);
    free(shell->plan);
    free(shell->work);
}

void shell_place(const shell *shell, int point, double place[3])
{
    const double *vector = shell->vector ? shell->vector + 3 * shell->node[point] : NULL;
    for (int i = 0; i < 3; i++)
        place[i] = shell->place[point][i] + (vector ? shell->factor * vector[i] : 0);
}

void shell_at(const shell *shell, int point, double at[2])
{
    double place[3];
    shell_place(shell, point, place);
    view_project(&shell->view, place, at);
}

void shell_include(shell *shell)
{
    for (int k = 0; k < shell->points; k++) {
        double place[3];
        shell_place(shell, k, place);
        view_include(&shell->view, place);
        view_include(&shell->view, shell->place[k]);
    }
}

/*
 * Compute the bilinear weights of the four corners of a quadrilateral cell at a point inside.
 *   share [2] in  position of the point along the sides, from 0 to 1
 */
static void corner_weights(const double share[2], double weight[4])
{
    weight[0] = (1 - share[0]) * (1 - share[1]);
    weight[1] = share[0] * (1 - share[1]);
    weight[2] = share[0] * share[1];
    weight[3] = (1 - share[0]) * share[1];
}

void shell_inside(const shell *shell, int cell, const double share[2], double at[2])
{
    double weight[4], corner[2];
    corner_weights(share, weight);
    at[0] = at[1] = 0;
    for (int r = 0; r < 4; r++) {
        shell_at(shell, shell->cell[cell][r], corner);
        for (int i = 0; i < 2; i++)
            at[i] += weight[r] * corner[i];
    }
}

/*
 * Append the part of a quadrilateral cell between two points to an SVG path.
 *   from, to [2] in  opposite corners of the part, as positions from 0 to 1 along the sides of the
 *   cell
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

static void draw_cells(const shell *shell, const char *style)
{
    static const double first[2] = {0, 0}, last[2] = {1, 1};
    draw_path(shell->file, style);
    for (int k = 0; k < shell->cells; k++)
        draw_part(shell, k, first, last);
    draw_path_end(shell->file);
}

void shell_lines(const shell *shell, const char *style)
{
    (shell->mesh->elements > FINE ? shell_edges : draw_cells)(shell, style);
}

void shell_edges(const shell *shell, const char *style)
{
    const int sides = 4 * shell->cells;
    quad_side *side = shell->work;
    for (int k = 0; k < sides; k++) {
        const int *corner = shell->cell[k / 4];
        side[k] =
            quad_side_between((uint32_t)corner[k % 4], (uint32_t)corner[(k + 1) % 4], (uint32_t)k);
    }
    qsort(side, (size_t)sides, sizeof *side, quad_side_compare);
    draw_path(shell->file, style);
    for (int k = 0; k < sides; k++) {
        double ends[2][2];
        if ((k > 0 && quad_side_is_same(&side[k], &side[k - 1])) ||
            (k + 1 < sides && quad_side_is_same(&side[k], &side[k + 1])))
            continue;
        shell_at(shell, (int)side[k].low, ends[0]);
        shell_at(shell, (int)side[k].high, ends[1]);
        draw_polygon(shell->file, (const double(*)[2])ends, 2);
    }
    draw_path_end(shell->file);
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
 * Return the index of the colour at a point inside a cell (quadrilateral of the mesh), whose four
 * corners have the values own [4].
 */
static int level_inside(const double own[4], const draw_scale *scale, double first, double second)
{
    const double share[2] = {first, second};
    double weight[4], value = 0;
    corner_weights(share, weight);
    for (int r = 0; r < 4; r++)
        value += weight[r] * own[r];
    return draw_level(scale, value);
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
        own[r] = value[shell->node[shell->cell[cell][r]]];
    const bool has_values = isfinite(own[0] + own[1] + own[2] + own[3]);
    const int parts = has_values ? pieces : 1;
    const double size = 1.0 / parts;
    for (int j = 0; j < parts; j++)
        for (int i = 0, end; i < parts; i = end) {
            const int level = level_inside(own, scale, (i + 0.5) * size, (j + 0.5) * size);
            for (end = i + 1; end < parts; end++)
                if (level_inside(own, scale, (end + 0.5) * size, (j + 0.5) * size) != level)
                    break;
            const double from[2] = {i * size, j * size}, to[2] = {end * size, (j + 1) * size};
            draw_path(shell->file, draw_class(scale, level));
            draw_part(shell, cell, from, to);
            fputs("\"/>", shell->file);
        }
    return has_values;
}

/* Draw the outline and the supported corners of a cell (quadrilateral) in space. */
static void draw_frame(const shell *shell, int cell)
{
    struct shell single = *shell;
    single.cell = shell->cell + cell;
    single.cells = 1;
    if (shell->mesh->elements <= FINE)
        draw_cells(&single, "edge");
    for (int r = 0; r < 4; r++)
        if (shell->is_held[single.cell[0][r]])
            shell_node(shell, single.cell[0][r], "pin", 2.5);
}

/*
 * Draw the values at the points of a mesh as coloured discs. Of a very large number of points, only
 * every second, third and so on is drawn.
 */
static void draw_points(const shell *shell, const double *value, const draw_scale *scale)
{
    enum { MOST_DOTS = 2500 };
    const double radius = 0.35 * sqrt(shell->view.width * shell->view.height / shell->points);
    for (int k = 0; k < shell->points; k += 1 + shell->points / MOST_DOTS) {
        const double own = value[shell->node[k]];
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
        has_values |= paint_cell(shell, order[k].cell, value, scale, pieces);
        if (!shell->is_map)
            draw_frame(shell, order[k].cell);
    }
    if (!has_values)
        draw_points(shell, value, scale);
    fputs("</g>\n", shell->file);
}
