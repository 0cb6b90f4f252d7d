/* SPDX-License-Identifier: BSD-2-Clause */
/* Pictures of a mesh from a file (report_quads.h). */
#include "report_quads.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/quad_side.h"

enum { FINE = 3000, SPACE_PIECES = 3000, MAP_PIECES = 6000 };

/* ---- views ------------------------------------------------------------- */

static const draw_view *view_of(const shell *s)
{
    return s->view ? s->view : &s->plane.flat;
}

static void place_node(const shell *s, int node, double at[2])
{
    double x[3];
    draw_place(s->m, node, s->view ? s->vector : NULL, s->factor, x);
    draw_project(view_of(s), x, at);
}

/* Mean of the directors. Returns its length: 1 for a plate, 0 for a closed surface. */
static double mean_normal(const mesh *mesh, double normal[3])
{
    normal[0] = normal[1] = normal[2] = 0;
    for (int n = 0; n < mesh->nodes; n++)
        for (int i = 0; i < 3; i++)
            normal[i] += mesh->point[n].e[2][i] / mesh->nodes;
    return sqrt(draw_dot3(normal, normal));
}

/* Axes of a view along a normal: y points up, or z where the normal is along y. */
static void look_along(draw_view *view, const double normal[3], double length)
{
    double(*axis)[3] = view->axis;
    for (int i = 0; i < 3; i++)
        axis[2][i] = normal[i] / length;
    const int up = fabs(axis[2][1]) > 0.9 ? 2 : 1;
    double size = 0;
    for (int i = 0; i < 3; i++) {
        axis[1][i] = (i == up) - axis[2][up] * axis[2][i];
        size += axis[1][i] * axis[1][i];
    }
    for (int i = 0; i < 3; i++)
        axis[1][i] /= sqrt(size);
    for (int i = 0; i < 3; i++)
        axis[0][i] = axis[1][(i + 1) % 3] * axis[2][(i + 2) % 3] -
                     axis[1][(i + 2) % 3] * axis[2][(i + 1) % 3];
}

void quads_plane(shell_plane *plane, const mesh *mesh)
{
    double normal[3];
    const double length = mean_normal(mesh, normal);
    draw_view_begin(&plane->flat, mesh);
    if (length > 0.3)
        look_along(&plane->flat, normal, length);
    draw_view_mesh(&plane->flat, mesh, NULL, 0);
    draw_view_fit(&plane->flat, SHELL_PLANE_WIDTH, SHELL_PLANE_WIDTH);
    plane->width = plane->flat.width;
    plane->height = plane->flat.height;
    plane->picture_height = plane->height + 20;
}

void quads_words(const shell *s)
{
    const double *along = s->plane.flat.axis[2];
    put(s->file, "<text class=\"value\" x=\"160\" y=\"%f\">seen along (%n, %n, %n)</text>\n",
        s->plane.height + 14, along[0], along[1], along[2]);
}

/* ---- sides -------------------------------------------------------------- */

/* List the sides of the elements of a patch, or of all elements where `patch` is NULL. */
static size_t list_sides(const mesh *mesh, const int *patch, int wanted, quad_side *list)
{
    size_t count = 0;
    for (int e = 0; e < mesh->elements; e++)
        for (int k = 0; k < 4 && (!patch || patch[e] == wanted); k++)
            list[count++] = quad_side_between(mesh->element[e][k], mesh->element[e][(k + 1) % 4],
                                              4 * (uint32_t)e + (uint32_t)k);
    qsort(list, count, sizeof *list, quad_side_compare);
    return count;
}

/* Draw sides that occur once, and those that occur twice as well unless only_free. */
static void draw_sides(const shell *s, const quad_side *list, size_t count, bool only_free)
{
    for (size_t i = 0; i < count; i++) {
        const bool is_second = i > 0 && quad_side_is_same(&list[i], &list[i - 1]);
        const bool is_first = i + 1 < count && quad_side_is_same(&list[i], &list[i + 1]);
        double from[2], to[2];
        if (is_second || (is_first && only_free))
            continue;
        place_node(s, (int)list[i].low, from);
        place_node(s, (int)list[i].high, to);
        draw_line(s->file, from, to);
    }
}

bool quads_is_thinned(const mesh *mesh)
{
    return mesh->elements > FINE;
}

void quads_lines(const shell *s, const char *style, bool only_free)
{
    quad_side *list = calloc(4 * (size_t)s->m->elements, sizeof *list);
    if (!list)
        return;
    draw_path(s->file, style);
    draw_sides(s, list, list_sides(s->m, NULL, 0, list), only_free || quads_is_thinned(s->m));
    draw_path_end(s->file);
    free(list);
}

/* ---- surface ------------------------------------------------------------ */

typedef struct far_element {
    double depth;
    int element;
} far_element;

static int farther_first(const void *x, const void *y)
{
    const far_element *a = x, *b = y;
    if (a->depth != b->depth)
        return a->depth > b->depth ? 1 : -1;
    return (a->element > b->element) - (a->element < b->element);
}

/* List the elements from the farthest to the nearest. */
static void list_elements(const shell *s, far_element *list)
{
    for (int e = 0; e < s->m->elements; e++) {
        list[e] = (far_element){0, e};
        for (int r = 0; r < 4; r++) {
            double x[3];
            draw_place(s->m, s->m->element[e][r], s->view ? s->vector : NULL, s->factor, x);
            list[e].depth += draw_dot3(view_of(s)->axis[2], x);
        }
    }
    qsort(list, (size_t)s->m->elements, sizeof *list, farther_first);
}

/* Bilinear weights of the four corners at (a, b) in [0, 1]. */
static void corner_weights(double a, double b, double weight[4])
{
    weight[0] = (1 - a) * (1 - b);
    weight[1] = a * (1 - b);
    weight[2] = a * b;
    weight[3] = (1 - a) * b;
}

static void place_inside(const double corner[4][2], double a, double b, double at[2])
{
    double weight[4];
    corner_weights(a, b, weight);
    for (int i = 0; i < 2; i++) {
        at[i] = 0;
        for (int r = 0; r < 4; r++)
            at[i] += weight[r] * corner[r][i];
    }
}

void quads_inside(const shell *s, int element, const double natural[2], double at[2])
{
    double corner[4][2];
    for (int r = 0; r < 4; r++)
        place_node(s, s->m->element[element][r], corner[r]);
    place_inside((const double(*)[2])corner, (1 + natural[0]) / 2, (1 + natural[1]) / 2, at);
}

/* Paint an element in pieces x pieces parts, each in the colour of the value at its middle. */
static void paint_element(const shell *s, int element, const double *value, const draw_scale *scale,
                          int pieces)
{
    const uint16_t *node = s->m->element[element];
    double corner[4][2], weight[4];
    for (int r = 0; r < 4; r++)
        place_node(s, node[r], corner[r]);
    for (int k = 0; k < pieces * pieces; k++) {
        const double size = 1.0 / pieces, a = k / pieces * size, b = k % pieces * size;
        double at[4][2], own = 0;
        corner_weights(a + size / 2, b + size / 2, weight);
        for (int r = 0; r < 4; r++)
            own += weight[r] * value[node[r]];
        place_inside((const double(*)[2])corner, a, b, at[0]);
        place_inside((const double(*)[2])corner, a + size, b, at[1]);
        place_inside((const double(*)[2])corner, a + size, b + size, at[2]);
        place_inside((const double(*)[2])corner, a, b + size, at[3]);
        draw_path(s->file, draw_class(scale, draw_level(scale, own)));
        draw_polygon(s->file, (const double(*)[2])at, 4);
        fputs("\"/>", s->file);
    }
    if (!s->view || quads_is_thinned(s->m))
        return;
    draw_path(s->file, "edge");
    draw_polygon(s->file, (const double(*)[2])corner, 4);
    draw_path_end(s->file);
}

/* Draw the sides of an element whose nodes are supported as thick lines. */
static void draw_supports(const shell *s, int element, const unsigned char *held)
{
    const uint16_t *node = s->m->element[element];
    for (int k = 0; k < 4; k++) {
        double from[2], to[2];
        if (!held[node[k]] || !held[node[(k + 1) % 4]])
            continue;
        place_node(s, node[k], from);
        place_node(s, node[(k + 1) % 4], to);
        draw_path(s->file, "held");
        draw_line(s->file, from, to);
        draw_path_end(s->file);
    }
}

/* Mark the nodes of all supports. held [nodes] out, one [nodes] work */
static void mark_supports(const mesh *mesh, unsigned char *held, unsigned char *one)
{
    for (int k = 0; k < mesh->scene->supports; k++) {
        scene_mark_nodes(mesh->scene, &mesh->scene->support[k].where, one);
        for (int n = 0; n < mesh->nodes; n++)
            held[n] |= one[n];
    }
}

static void paint_all(const shell *s, const far_element *list, const unsigned char *held,
                      const double *value, const draw_scale *scale)
{
    const int most = s->view ? SPACE_PIECES : MAP_PIECES;
    int pieces = 1;
    while (pieces < 6 && (pieces + 1) * (pieces + 1) * s->m->elements <= most)
        pieces++;
    fputs("<g class=\"cells\">\n", s->file);
    for (int i = 0; i < s->m->elements; i++) {
        paint_element(s, list[i].element, value, scale, pieces);
        if (s->view)
            draw_supports(s, list[i].element, held);
    }
    for (int n = 0; n < s->m->nodes; n++) {
        double at[2];
        bool is_lone = s->view && held[n];
        for (int e = 0; e < s->m->elements && is_lone; e++)
            for (int k = 0; k < 4; k++)
                if (s->m->element[e][k] == n &&
                    (held[s->m->element[e][(k + 1) % 4]] || held[s->m->element[e][(k + 3) % 4]]))
                    is_lone = false;
        if (!is_lone)
            continue;
        place_node(s, n, at);
        draw_disc(s->file, "pin", at, 4);
    }
    fputs("</g>\n", s->file);
}

int quads_surface(const shell *s, const double *value, const draw_scale *scale)
{
    const size_t nodes = (size_t)s->m->nodes;
    far_element *list = calloc((size_t)s->m->elements, sizeof *list);
    unsigned char *held = calloc(nodes, 1), *one = calloc(nodes, 1);
    const int status = list && held && one ? 0 : -1;
    if (status == 0) {
        list_elements(s, list);
        if (s->m->scene->quads)
            mark_supports(s->m, held, one);
        paint_all(s, list, held, value, scale);
    }
    free(list);
    free(held);
    free(one);
    return status;
}

/* ---- patches ------------------------------------------------------------ */

bool quads_overlap(const scene *scene, const scene_patches *x, const scene_patches *y)
{
    for (size_t e = 0; e < scene->quads->mesh.elements; e++)
        if (x->patch[e] >= 0 && y->patch[e] >= 0)
            return true;
    return false;
}

void quads_patch(const shell *s, const scene_patches *patches, int patch)
{
    for (int e = 0; e < s->m->elements; e++) {
        double at[4][2];
        if (patches->patch[e] != patch)
            continue;
        for (int r = 0; r < 4; r++)
            place_node(s, s->m->element[e][r], at[r]);
        draw_polygon(s->file, (const double(*)[2])at, 4);
    }
}

void quads_patch_outline(const shell *s, const scene_patches *patches, int patch)
{
    quad_side *list = calloc(4 * (size_t)s->m->elements, sizeof *list);
    if (list)
        draw_sides(s, list, list_sides(s->m, patches->patch, patch, list), true);
    free(list);
}

void quads_patch_room(const shell *s, const scene_patches *patches, int patch, double at[2],
                      double *size)
{
    double area = 0, sum[2] = {0, 0};
    for (int e = 0; e < s->m->elements; e++) {
        double corner[4][2], middle[2];
        if (patches->patch[e] != patch)
            continue;
        for (int r = 0; r < 4; r++)
            place_node(s, s->m->element[e][r], corner[r]);
        place_inside((const double(*)[2])corner, 0.5, 0.5, middle);
        const double own = fabs((corner[2][0] - corner[0][0]) * (corner[3][1] - corner[1][1]) -
                                (corner[2][1] - corner[0][1]) * (corner[3][0] - corner[1][0])) /
                               2 +
                           DBL_MIN;
        area += own;
        for (int i = 0; i < 2; i++)
            sum[i] += own * middle[i];
    }
    for (int i = 0; i < 2; i++)
        at[i] = sum[i] / area;
    *size = sqrt(area);
}
