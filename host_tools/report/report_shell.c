/* SPDX-License-Identifier: BSD-2-Clause */
/* Surface, mesh lines and marks in the picture of a shell (report_shell.h). */
#include "report_shell.h"
#include <math.h>
#include <stdlib.h>
#include "report_quads.h"

enum {
    MOST_CELLS = 48,
    MOST_PIECES = 1100,
    PLANE_PIECES = 6000,
    MOST_LINES = 24,
    MOST_BENDS = 80,
    MOST_DOTS = 2500
};

/* ---- places and values between nodes ---------------------------------- */

/*
 * The four nodes around a point given in mesh-line coordinates, and their bilinear weights. A
 * mesh-line coordinate is the index of a mesh line, with fractions between two lines.
 */
static void nodes_around(const mesh *mesh, const double line[2], int node[4], double weight[4])
{
    int at[2];
    double share[2];
    for (int a = 0; a < 2; a++) {
        at[a] = (int)fmin(line[a], mesh->scene->line[a].elements - 1);
        share[a] = line[a] - at[a];
    }
    for (int r = 0; r < 4; r++) {
        const int i = r / 2, j = r % 2;
        node[r] = mesh_node(mesh, at[0] + i, at[1] + j);
        weight[r] = fabs(1 - i - share[0]) * fabs(1 - j - share[1]);
    }
}

static double value_at(const mesh *mesh, const double *value, double i, double j)
{
    const double line[2] = {i, j};
    int node[4];
    double weight[4], sum = 0;
    nodes_around(mesh, line, node, weight);
    for (int r = 0; r < 4; r++)
        sum += weight[r] > 0 ? weight[r] * value[node[r]] : 0;
    return sum;
}

/* Position in space of a point given in mesh-line coordinates. */
static void position_at(const shell *s, double i, double j, double x[3])
{
    const double line[2] = {i, j};
    int node[4];
    double weight[4], corner[3];
    nodes_around(s->m, line, node, weight);
    x[0] = x[1] = x[2] = 0;
    for (int r = 0; r < 4; r++) {
        draw_place(s->m, node[r], s->vector, s->factor, corner);
        for (int k = 0; k < 3; k++)
            x[k] += weight[r] > 0 ? weight[r] * corner[k] : 0;
    }
}

static void place_at(const shell *s, double i, double j, double at[2])
{
    double x[3];
    if (s->view) {
        position_at(s, i, j, x);
        draw_project(s->view, x, at);
    } else {
        plane_at(&s->plane, plane_theta(s->m, 0, i), plane_theta(s->m, 1, j), at);
    }
}

static void node_at(const shell *s, int node, double at[2])
{
    double x[3];
    draw_place(s->m, node, s->vector, s->factor, x);
    draw_project(s->view, x, at);
}

/* ---- surface ---------------------------------------------------------- */

/* A block of whole elements that is drawn at once, between two mesh lines of each direction. */
typedef struct cell {
    double depth;
    int index, line[2][2];
} cell;

static int farther_first(const void *x, const void *y)
{
    const cell *a = x, *b = y;
    if (a->depth < b->depth)
        return -1;
    return a->depth > b->depth ? 1 : (a->index > b->index) - (a->index < b->index);
}

/*
 * List the cells of the mesh, from the farthest to the nearest.
 *   cells [MOST_CELLS * MOST_CELLS]  out
 * Returns their number.
 */
static int cell_list(const shell *s, cell *cells)
{
    const int n[2] = {s->m->scene->line[0].elements, s->m->scene->line[1].elements};
    const int stride[2] = {draw_stride(n[0], MOST_CELLS), draw_stride(n[1], MOST_CELLS)};
    int count = 0;
    for (int i = 0; i < n[0]; i += stride[0])
        for (int j = 0; j < n[1]; j += stride[1]) {
            const int i_end = draw_next(i, stride[0], n[0]), j_end = draw_next(j, stride[1], n[1]);
            double x[3] = {0, 0, 0};
            if (s->view)
                position_at(s, (i + i_end) / 2.0, (j + j_end) / 2.0, x);
            const double depth = s->view ? draw_dot3(s->view->axis[2], x) : 0;
            cells[count] = (cell){depth, count, {{i, i_end}, {j, j_end}}};
            count++;
        }
    qsort(cells, (size_t)count, sizeof *cells, farther_first);
    return count;
}

/*
 * Draw the outline of the rectangle of mesh-line coordinates with the opposite corners `from` and
 * `to`.
 */
static void outline(const shell *s, const double from[2], const double to[2])
{
    double at[4][2];
    place_at(s, from[0], from[1], at[0]);
    place_at(s, to[0], from[1], at[1]);
    place_at(s, to[0], to[1], at[2]);
    place_at(s, from[0], to[1], at[3]);
    draw_polygon(s->file, (const double(*)[2])at, 4);
}

/*
 * Index of the colour at the middle of piece (i, j) of a cell, or -2 if the piece is beyond the
 * last row of the cell.
 */
static int piece_level(const shell *s, const cell *c, const double *value, const draw_scale *scale,
                       const double size[2], int i, int j)
{
    const double row = c->line[0][0] + (i + 0.5) * size[0],
                 column = c->line[1][0] + (j + 0.5) * size[1];
    return row > c->line[0][1] ? -2 : draw_level(scale, value_at(s->m, value, row, column));
}

/*
 * Draw one cell: divided into pieces, each in the colour of the value at its middle, where
 * neighbours of equal colour along theta1 are drawn as one; then the outline of the cell.
 */
static void cell_paint(const shell *s, const cell *c, const double *value, const draw_scale *scale,
                       int pieces)
{
    const double first[2] = {c->line[0][0], c->line[1][0]},
                 last[2] = {c->line[0][1], c->line[1][1]};
    const double size[2] = {(last[0] - first[0]) / pieces, (last[1] - first[1]) / pieces};
    for (int j = 0; j < pieces; j++)
        for (int i = 0, end; i < pieces; i = end) {
            const int level = piece_level(s, c, value, scale, size, i, j);
            for (end = i + 1; piece_level(s, c, value, scale, size, end, j) == level;)
                end++;
            const double from[2] = {first[0] + i * size[0], first[1] + j * size[1]};
            const double to[2] = {first[0] + end * size[0], first[1] + (j + 1) * size[1]};
            draw_path(s->file, draw_class(scale, level));
            outline(s, from, to);
            fputs("\"/>", s->file);
        }
    if (!s->view)
        return;
    draw_path(s->file, "edge");
    outline(s, first, last);
    draw_path_end(s->file);
}

static bool is_around(const cell *c, const int node[2])
{
    return node[0] >= c->line[0][0] && node[0] <= c->line[0][1] && node[1] >= c->line[1][0] &&
           node[1] <= c->line[1][1];
}

/* Draw a support on a cell: an edge as a thick line, a point as a disc. */
static void cell_support(const shell *s, const cell *c, const scene_where *where)
{
    const int a = where->edge == EDGE_THETA2_MINUS || where->edge == EDGE_THETA2_PLUS;
    const int plus = where->edge == EDGE_THETA1_PLUS || where->edge == EDGE_THETA2_PLUS;
    const int edge = plus ? s->m->scene->line[a].elements : 0;
    double from[2], to[2];
    if (where->type == WHERE_EDGE && c->line[a][plus] == edge) {
        place_at(s, c->line[0][a == 0 && plus], c->line[1][a == 1 && plus], from);
        place_at(s, c->line[0][a == 1 || plus], c->line[1][a == 0 || plus], to);
        draw_path(s->file, "held");
        draw_line(s->file, from, to);
        draw_path_end(s->file);
    } else if (where->type == WHERE_POINT && is_around(c, where->node)) {
        place_at(s, where->node[0], where->node[1], from);
        draw_disc(s->file, "pin", from, 4);
    }
}

/* Whether every element has a corner without a value, so that no element can be coloured. */
static bool is_without_elements(const mesh *mesh, const double *value)
{
    for (int e = 0; e < mesh->elements; e++) {
        const uint16_t *node = mesh->element[e];
        if (isfinite(value[node[0]] + value[node[1]] + value[node[2]] + value[node[3]]))
            return false;
    }
    return true;
}

/* Draw the values of a single point or of an edge as coloured discs at the nodes. */
static void draw_values(const shell *s, const double *value, const draw_scale *scale)
{
    for (int i = 0; i < s->m->lines[0]; i++)
        for (int j = 0; j < s->m->lines[1]; j++) {
            const double own = value[mesh_node(s->m, i, j)];
            double at[2];
            place_at(s, i, j, at);
            if (isfinite(own))
                draw_disc(s->file, draw_class(scale, draw_level(scale, own)), at, 4);
        }
}

/* Draw the values of a mesh of points as coloured discs; of very many points not every one. */
static void draw_points(const shell *s, const double *value, const draw_scale *scale)
{
    const mesh *mesh = s->m;
    const double width = s->view ? s->view->width : s->plane.width,
                 height = s->view ? s->view->height : s->plane.height;
    const double radius = fmin(fmax(0.35 * sqrt(width * height / mesh->nodes), 1.5), 11);
    fputs("<g class=\"cells\">\n", s->file);
    for (int n = 0; n < mesh->nodes; n += draw_stride(mesh->nodes, MOST_DOTS)) {
        double at[2];
        if (s->view)
            node_at(s, n, at);
        else
            plane_at(&s->plane, mesh->point[n].x[1], mesh->point[n].x[0], at);
        if (isfinite(value[n]))
            draw_disc(s->file, draw_class(scale, draw_level(scale, value[n])), at, radius);
    }
    fputs("</g>\n", s->file);
}

int shell_surface(const shell *s, const double *value, const draw_scale *scale)
{
    if (s->m->elements == 0) {
        draw_points(s, value, scale);
        return 0;
    }
    if (s->m->quads)
        return quads_surface(s, value, scale);
    cell *cells = calloc((size_t)MOST_CELLS * MOST_CELLS, sizeof *cells);
    if (!cells)
        return -1;
    const int count = cell_list(s, cells), most = s->view ? MOST_PIECES : PLANE_PIECES;
    int pieces = 1;
    while (pieces < (s->view ? 6 : 16) && (pieces + 1) * (pieces + 1) * count <= most)
        pieces++;
    fputs("<g class=\"cells\">\n", s->file);
    for (int k = 0; k < count; k++) {
        cell_paint(s, &cells[k], value, scale, pieces);
        for (int i = 0; s->view && i < s->m->scene->supports; i++)
            cell_support(s, &cells[k], &s->m->scene->support[i].where);
    }
    if (is_without_elements(s->m, value))
        draw_values(s, value, scale);
    fputs("</g>\n", s->file);
    free(cells);
    return 0;
}

/* ---- lines ------------------------------------------------------------ */

/*
 * Append one mesh line to an open path: the line runs along direction a, at index `across` of the
 * other direction.
 */
static void trace(const shell *s, int a, int across)
{
    const int last = s->m->scene->line[a].elements, stride = draw_stride(last, MOST_BENDS);
    const double step = s->plane.is_polar && a == 1 ? last / 96.0 : stride;
    bool is_drawing = false;
    for (int k = 0; k <= ceil(last / step - 1e-9); k++) {
        double at[2];
        double line[2] = {across, across};
        line[a] = fmin(k * step, last);
        place_at(s, line[0], line[1], at);
        draw_step(s->file, &is_drawing, at);
    }
}

bool shell_is_thinned(const mesh *mesh)
{
    if (mesh->quads)
        return quads_is_thinned(mesh);
    return mesh->lines[0] > MOST_LINES + 1 || mesh->lines[1] > MOST_LINES + 1;
}

static void lines_at_most(const shell *s, const char *style, int most)
{
    if (s->m->elements == 0)
        return;
    if (s->m->quads) {
        quads_lines(s, style, most == 0);
        return;
    }
    draw_path(s->file, style);
    for (int a = 0; a < 2; a++) {
        const int last = s->m->scene->line[1 - a].elements,
                  stride = most ? draw_stride(last, most) : last;
        for (int across = 0, previous = -1; across > previous;
             across = draw_next(across, stride, last)) {
            trace(s, a, across);
            previous = across;
        }
    }
    draw_path_end(s->file);
}

void shell_lines(const shell *s, const char *style)
{
    lines_at_most(s, style, MOST_LINES);
}

void shell_edges(const shell *s, const char *style)
{
    lines_at_most(s, style, 0);
}

/* ---- marks ------------------------------------------------------------ */

static int node_of(const shell *s, const scene_where *point)
{
    return mesh_point_node(s->m, point);
}

void shell_dot(const shell *s, int node)
{
    double at[2];
    node_at(s, node, at);
    draw_disc(s->file, "dot", at, 3.5);
}

/* Direction of a point load in the picture: its unit vector in space, projected to the picture. */
static void load_direction(const shell *s, const scene_load *load, int node, double way[2])
{
    const expr_point place = mesh_place(s->m, node);
    const double sign = expr_value(load->value, &place) < 0 ? -1 : 1;
    double along[3];
    draw_component(&s->m->point[node], load->component, along);
    way[0] = sign * draw_dot3(s->view->axis[0], along);
    way[1] = -sign * draw_dot3(s->view->axis[1], along);
}

/* Draw an arrow whose tip is at the loaded node. Its length in space is the same for all loads. */
static void arrow(const shell *s, const double tip[2], const double way[2])
{
    const double size = hypot(way[0], way[1]), shaft = 46, head = 9, half = 3.5;
    const double x = way[0] / size, y = way[1] / size;
    const double tail[2] = {tip[0] - shaft * way[0], tip[1] - shaft * way[1]};
    const double neck[2] = {tip[0] - head * x, tip[1] - head * y};
    const double point[3][2] = {{tip[0] - x, tip[1] - y},
                                {neck[0] - half * y, neck[1] + half * x},
                                {neck[0] + half * y, neck[1] - half * x}};
    draw_path(s->file, "force");
    draw_line(s->file, tail, neck);
    draw_polygon(s->file, point, 3);
    draw_path_end(s->file);
}

void shell_loads(const shell *s)
{
    for (int k = 0; k < s->m->scene->loads; k++) {
        const scene_load *load = &s->m->scene->load[k];
        double tip[2], way[2];
        if (load->type != LOAD_POINT)
            continue;
        node_at(s, node_of(s, &load->where), tip);
        load_direction(s, load, node_of(s, &load->where), way);
        if (fabs(way[0]) + fabs(way[1]) < 0.25)
            draw_disc(s->file, "force", tip, 4);
        else
            arrow(s, tip, way);
    }
}

void shell_outputs(const shell *s)
{
    const scene_output *output = s->m->scene->output;
    for (int k = 0; k < s->m->scene->outputs; k++) {
        int before = 0; /* number of earlier outputs at the same node */
        double at[2];
        if (output[k].where.type != WHERE_POINT && output[k].where.type != WHERE_PLACE)
            continue;
        const int node = node_of(s, &output[k].where);
        for (int i = 0; i < k; i++)
            before +=
                (output[i].where.type == WHERE_POINT || output[i].where.type == WHERE_PLACE) &&
                node_of(s, &output[i].where) == node;
        if (before == 0)
            shell_dot(s, node);
        node_at(s, node, at);
        const bool is_left = at[0] > s->view->width * 0.65;
        at[0] += is_left ? -8 : 8;
        put(s->file, "<text class=\"tag%s\" x=\"%f\" y=\"%f\">%t</text>\n", is_left ? " end" : "",
            at[0], at[1] + 14 + 13 * before, output[k].name);
    }
}

void shell_directions(const shell *s)
{
    static const char *const name[3] = {"x", "y", "z"};
    const double x = 34, y = s->view->height - 20, length = 22;
    for (int i = 0; i < 3; i++) {
        const double dx = length * s->view->axis[0][i], dy = -length * s->view->axis[1][i];
        put(s->file, "<path class=\"axis\" d=\"M%f %fl%f %f\"/>", x, y, dx, dy);
        put(s->file, "<text class=\"value\" x=\"%f\" y=\"%f\">%s</text>\n", x + 1.4 * dx,
            y + 1.4 * dy + 4, name[i]);
    }
}
