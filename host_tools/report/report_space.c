/* A shell in space (report_space.h). */
#include "report_space.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "report_html.h"

enum { MOST_CELLS = 48, MOST_PIECES = 1100, MOST_WIRES = 24, MOST_BENDS = 80 };

static void node_at(const space *f, int node, double at[2])
{
    double x[3];
    draw_place(f->m, node, f->vector, f->factor, x);
    draw_project(f->view, x, at);
}

/* ---- marks of nodes --------------------------------------------------- */

static int node_of(const space *f, const scene_where *point)
{
    return mesh_node(f->m, point->node[0], point->node[1]);
}

static void circle(const space *f, const char *style, const double at[2], double radius)
{
    if (isfinite(at[0]) && isfinite(at[1]))
        fprintf(f->file, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>\n", style,
                at[0], at[1], radius);
}

/* ---- surface ---------------------------------------------------------- */

/* A cell of the drawing: some whole elements; corners in the order of an element. */
typedef struct cell {
    double depth;
    int index, node[4];
    int line[2][2]; /* mesh lines around it */
} cell;

static int farther_first(const void *x, const void *y)
{
    const cell *a = x, *b = y;
    if (a->depth != b->depth)
        return a->depth < b->depth ? -1 : 1;
    return (a->index > b->index) - (a->index < b->index);
}

static void cell_place(const space *f, cell *c, const int line[2][2])
{
    static const int side[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    c->depth = 0;
    memcpy(c->line, line, sizeof c->line);
    for (int r = 0; r < 4; r++) {
        double x[3];
        c->node[r] = mesh_node(f->m, line[0][side[r][0]], line[1][side[r][1]]);
        draw_place(f->m, c->node[r], f->vector, f->factor, x);
        c->depth += draw_dot3(f->view->axis[2], x) / 4;
    }
}

/* Cells from far to near. cells [MOST_CELLS squared] out. Returns their number. */
static int cell_list(const space *f, cell *cells)
{
    const int n[2] = {f->m->scene->line[0].elements, f->m->scene->line[1].elements};
    const int step[2] = {draw_stride(n[0], MOST_CELLS), draw_stride(n[1], MOST_CELLS)};
    int count = 0;
    for (int i = 0; i < n[0]; i += step[0])
        for (int j = 0; j < n[1]; j += step[1]) {
            const int line[2][2] = {{i, draw_next(i, step[0], n[0])},
                                    {j, draw_next(j, step[1], n[1])}};
            cell_place(f, &cells[count], line);
            cells[count].index = count;
            count++;
        }
    qsort(cells, (size_t)count, sizeof *cells, farther_first);
    return count;
}

/* One cell: pieces coloured by the value at their middle, then its outline. */
static void cell_paint(const space *f, const cell *c, const double *given, const draw_scale *scale,
                       int pieces)
{
    const double d = 1.0 / pieces;
    double x[4], y[4], value[4];
    for (int r = 0; r < 4; r++) {
        double at[2];
        node_at(f, c->node[r], at);
        x[r] = at[0];
        y[r] = at[1];
        value[r] = given[c->node[r]];
    }
    for (int i = 0; i < pieces; i++)
        for (int j = 0; j < pieces; j++) {
            const double s[4] = {i * d, i * d + d, i * d + d, i * d},
                         t[4] = {j * d, j * d, j * d + d, j * d + d};
            draw_path(f->file, scale,
                      draw_level(scale, draw_between(value, s[0] + d / 2, t[0] + d / 2)));
            for (int r = 0; r < 4; r++)
                fprintf(f->file, "%c%.1f %.1f", r ? 'L' : 'M', draw_between(x, s[r], t[r]),
                        draw_between(y, s[r], t[r]));
            fputs("z\"/>", f->file);
        }
    fputs("<path class=\"edge\" d=\"", f->file);
    for (int r = 0; r < 4; r++)
        fprintf(f->file, "%c%.1f %.1f", r ? 'L' : 'M', x[r], y[r]);
    fputs("z\"/>\n", f->file);
}

/* Does a cell lie on that edge of the mesh? */
static int on_edge(const space *f, const cell *c, scene_edge edge)
{
    const int a = edge == EDGE_THETA2_MINUS || edge == EDGE_THETA2_PLUS,
              plus = edge == EDGE_THETA1_PLUS || edge == EDGE_THETA2_PLUS;
    return c->line[a][plus] == (plus ? f->m->scene->line[a].elements : 0);
}

/* Supports on a cell: thick sides, dots. */
static void cell_supports(const space *f, const cell *c)
{
    static const int corner[5][2] = {{0, 0}, {3, 0}, {1, 2}, {0, 1}, {3, 2}}; /* ends of each edge
                                                                               */
    for (int k = 0; k < f->m->scene->supports; k++) {
        const scene_where *where = &f->m->scene->support[k].where;
        double from[2], to[2];
        if (where->type == WHERE_EDGE && on_edge(f, c, where->edge)) {
            node_at(f, c->node[corner[where->edge][0]], from);
            node_at(f, c->node[corner[where->edge][1]], to);
            fprintf(f->file, "<path class=\"held\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n", from[0],
                    from[1], to[0], to[1]);
        } else if (where->type == WHERE_POINT && where->node[0] >= c->line[0][0] &&
                   where->node[0] <= c->line[0][1] && where->node[1] >= c->line[1][0] &&
                   where->node[1] <= c->line[1][1]) {
            node_at(f, node_of(f, where), from);
            circle(f, "pin", from, 4);
        }
    }
}

/* Nodes with a value where the surface cannot show it. */
static void lone_values(const space *f, const double *value, const draw_scale *scale)
{
    for (int i = 0; i < f->m->lines[0]; i++)
        for (int j = 0; j < f->m->lines[1]; j++)
            if (draw_is_lone(f->m, value, i, j)) {
                const int n = mesh_node(f->m, i, j);
                double at[2];
                node_at(f, n, at);
                draw_disc(f->file, scale, value[n], at);
            }
}

int space_surface(const space *f, const double *value, const draw_scale *scale)
{
    cell *cells = calloc((size_t)MOST_CELLS * MOST_CELLS, sizeof *cells);
    if (!cells)
        return -1;
    const int count = cell_list(f, cells);
    int pieces = 1;
    while (pieces < 6 && (pieces + 1) * (pieces + 1) * count <= MOST_PIECES)
        pieces++;
    fputs("<g class=\"cells\">\n", f->file);
    for (int k = 0; k < count; k++) {
        cell_paint(f, &cells[k], value, scale, pieces);
        cell_supports(f, &cells[k]);
    }
    lone_values(f, value, scale);
    fputs("</g>\n", f->file);
    free(cells);
    return 0;
}

int space_is_thinned(const mesh *mesh)
{
    return mesh->lines[0] > MOST_WIRES + 1 || mesh->lines[1] > MOST_WIRES + 1;
}

/* ---- lines ------------------------------------------------------------ */

/* Append one mesh line to an open path: along direction a at line `at` of the other. */
static void trace(const space *f, int a, int at)
{
    const int n = f->m->scene->line[a].elements, step = draw_stride(n, MOST_BENDS);
    int drawing = 0;
    for (int k = 0;; k = draw_next(k, step, n)) {
        double x[2];
        node_at(f, a == 0 ? mesh_node(f->m, k, at) : mesh_node(f->m, at, k), x);
        const int here = isfinite(x[0]) && isfinite(x[1]);
        if (here)
            fprintf(f->file, "%c%.1f %.1f", drawing ? 'L' : 'M', x[0], x[1]);
        drawing = here;
        if (k == n)
            break;
    }
}

void space_wires(const space *f, const char *style)
{
    fprintf(f->file, "<path class=\"%s\" d=\"", style);
    for (int a = 0; a < 2; a++) {
        const int across = f->m->scene->line[1 - a].elements,
                  step = draw_stride(across, MOST_WIRES);
        for (int at = 0;; at = draw_next(at, step, across)) {
            trace(f, a, at);
            if (at == across)
                break;
        }
    }
    fputs("\"/>\n", f->file);
}

void space_outline(const space *f)
{
    fputs("<path class=\"outline\" d=\"", f->file);
    for (int a = 0; a < 2; a++) {
        trace(f, a, 0);
        trace(f, a, f->m->scene->line[1 - a].elements);
    }
    fputs("\"/>\n", f->file);
}

/* ---- marks ------------------------------------------------------------ */

void space_dot(const space *f, int node)
{
    double at[2];
    node_at(f, node, at);
    circle(f, "dot", at, 3.5);
}

/* Direction of a load in the picture; its length is that of a unit vector seen from here. */
static void load_way(const space *f, const scene_load *load, int node, double way[2])
{
    const expr_point place = mesh_place(f->m, node);
    const double sign = expr_value(load->value, &place) < 0 ? -1 : 1;
    double c[3];
    draw_direction(&f->m->point[node], load->component, c);
    way[0] = sign * draw_dot3(f->view->axis[0], c);
    way[1] = -sign * draw_dot3(f->view->axis[1], c);
}

/* Arrow of a fixed length in space that ends at the loaded node. */
static void arrow(const space *f, const double tip[2], const double way[2])
{
    const double size = sqrt(way[0] * way[0] + way[1] * way[1]), shaft = 46, head = 9, half = 3.5;
    const double x = way[0] / size, y = way[1] / size;
    fprintf(f->file,
            "<path class=\"force\" d=\"M%.1f %.1fL%.1f %.1fM%.1f %.1fL%.1f %.1fL%.1f %.1fz\"/>\n",
            tip[0] - shaft * way[0], tip[1] - shaft * way[1], tip[0] - head * x, tip[1] - head * y,
            tip[0] - x, tip[1] - y, tip[0] - head * x - half * y, tip[1] - head * y + half * x,
            tip[0] - head * x + half * y, tip[1] - head * y - half * x);
}

void space_loads(const space *f)
{
    for (int k = 0; k < f->m->scene->loads; k++) {
        const scene_load *load = &f->m->scene->load[k];
        double tip[2], way[2];
        if (load->type != LOAD_POINT)
            continue;
        node_at(f, node_of(f, &load->where), tip);
        load_way(f, load, node_of(f, &load->where), way);
        if (fabs(way[0]) + fabs(way[1]) < 0.25)
            circle(f, "force", tip, 4);
        else
            arrow(f, tip, way);
    }
}

/* Is the node of output k marked already by an earlier one? */
static int marked(const space *f, int k)
{
    const scene_output *output = f->m->scene->output;
    for (int other = 0; other < k; other++)
        if (output[other].where.type == WHERE_POINT &&
            node_of(f, &output[other].where) == node_of(f, &output[k].where))
            return 1;
    return 0;
}

void space_outputs(const space *f)
{
    const scene *scene = f->m->scene;
    for (int k = 0; k < scene->outputs; k++) {
        double at[2];
        if (scene->output[k].where.type != WHERE_POINT || marked(f, k))
            continue;
        const int node = node_of(f, &scene->output[k].where);
        node_at(f, node, at);
        const int left = at[0] > f->view->width * 0.65;
        space_dot(f, node);
        fprintf(f->file, "<text class=\"tag\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">",
                at[0] + (left ? -8 : 8), at[1] + 14, left ? "end" : "start");
        for (int other = k, first = 1; other < scene->outputs; other++)
            if (scene->output[other].where.type == WHERE_POINT &&
                node_of(f, &scene->output[other].where) == node) {
                fputs(first ? "" : ", ", f->file);
                html_text(f->file, scene->output[other].name);
                first = 0;
            }
        fputs("</text>\n", f->file);
    }
}

void space_axes(const space *f)
{
    const double x = 34, y = f->view->height - 20, length = 22;
    for (int i = 0; i < 3; i++) {
        const double dx = length * f->view->axis[0][i], dy = -length * f->view->axis[1][i];
        fprintf(
            f->file,
            "<path class=\"axis\" d=\"M%.1f %.1fl%.1f %.1f\"/><text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%c</text>",
            x, y, dx, dy, x + 1.4 * dx, y + 1.4 * dy + 4, "xyz"[i]);
    }
    fputc('\n', f->file);
}
