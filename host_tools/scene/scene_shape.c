/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Sections `surface` and `mesh` of a scene file: the reference surface of the shell, and the
 * coordinates of the mesh lines on that surface.
 */
#include "scene_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "scene_points.h"
#include "surface.h"
#include "surface_types.h"

/* ---- surface ---- */

/*
 * List of pairs of numbers as read from a scene file: points (r, z) of the meridian of a surface of
 * revolution, or the tangent directions at the two ends of the meridian.
 */
typedef struct pairs_text {
    int count;
    double (*pair)[2];
} pairs_text;

typedef struct surface_text {
    int type;
    scene_surface surface;
    pairs_text points, tangents;
    double smoothing;
    int cells[2]; /* numbers of cells, along x and along y, of the piecewise bicubic function that
                     is fitted to the points of a surface; 0: not given */
} surface_text;

static int read_pairs(reader *reader, int node, pairs_text *list, const range *first)
{
    int i, k = 0, child;
    list->pair = new_items(reader, node, TREE_LIST, sizeof *list->pair, &list->count);
    if (!list->pair)
        return -1;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++) {
        if (require_kind(reader, i, TREE_LIST) != 0)
            return -1;
        if (reader->t->node[i].count != 2)
            return tree_fault(reader->t, i, "an item of '%.60s' has %d values; give two, [r, z]",
                              tree_name(reader->t, node), reader->t->node[i].count);
        child = reader->t->node[i].first;
        if (read_real(reader, child, &list->pair[k][0], first) != 0 ||
            read_real(reader, reader->t->node[child].next, &list->pair[k][1], NULL) != 0)
            return -1;
    }
    return 0;
}

static const range meridian_radius = {0, HUGE_VAL, 0, "is a radius and must not be below 0"};
static const form meridian_radius_form = {.type = FORM_NUMBER, .range = &meridian_radius};
static const form meridian_point_form = {
    .type = FORM_LIST, .item = &number_form, .first = &meridian_radius_form, .least = 2, .most = 2};
static const form meridian_form = {.type = FORM_LIST, .item = &meridian_point_form, .least = 2};
static const form pair_form = {.type = FORM_LIST, .item = &number_form, .least = 2, .most = 2};

static int read_meridian(reader *reader, int node, void *to, const void *rule)
{
    pairs_text *list = to;
    int i, k = 0;
    (void)rule;
    if (read_pairs(reader, node, list, &meridian_radius) != 0)
        return -1;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++)
        if (k > 0 && list->pair[k][0] == list->pair[k - 1][0] &&
            list->pair[k][1] == list->pair[k - 1][1])
            return tree_fault(reader->t, i, "point [%g, %g] follows itself; drop one",
                              list->pair[k][0], list->pair[k][1]);
    return 0;
}

static const choice end_words[] = {{"not-a-knot", 0}, {NULL, 0}};
static const form end_word_form = {.type = FORM_WORD, .words = end_words};
static const form tangents_form = {.type = FORM_LIST, .item = &pair_form, .least = 2, .most = 2};
static const form *const ends_forms[] = {&end_word_form, &tangents_form, NULL};
static const form ends_form = {.type = FORM_ANY, .any = ends_forms};

static int read_ends(reader *reader, int node, void *to, const void *rule)
{
    pairs_text *list = to;
    int k, unused;
    (void)rule;
    if (reader->t->node[node].kind != TREE_LIST)
        return read_choice(reader, node, &unused, end_words);
    if (read_pairs(reader, node, list, NULL) != 0)
        return -1;
    if (list->count != 2)
        return tree_fault(
            reader->t, node,
            "'ends' has %d items; give not-a-knot or the directions at the first and last point, "
            "[[r', z'], [r', z']]",
            list->count);
    for (k = 0; k < 2; k++)
        if (list->pair[k][0] == 0 && list->pair[k][1] == 0)
            return tree_fault(reader->t, node,
                              "'ends': [0, 0] has no direction; give one, as [1, 0]");
    return 0;
}

static int fit_meridian(reader *reader, int node, surface_text *text)
{
    const int least = text->tangents.count ? 2 : 4;
    node = tree_find(reader->t, node, "meridian");
    if (text->points.count < least)
        return tree_fault(
            reader->t, node,
            "'meridian' has %d points; give at least %d (4, or 2 with directions at its ends)",
            text->points.count, least);
    text->surface.meridian = spline_fit(
        text->points.count, (const double(*)[2])text->points.pair,
        text->tangents.count ? (const double(*)[2])text->tangents.pair : NULL, text->smoothing);
    if (text->surface.meridian)
        return 0;
    return tree_fault(
        reader->t, node,
        "no spline goes through the points of 'meridian'; space them more evenly, smooth less");
}

/* ---- surface fitted to points ---- */

static const range cell_count = {1, BICUBIC_CELLS, 0, "must be from 1 to 64"};
static const form cell_form = {.type = FORM_WHOLE, .range = &cell_count};
static const form cells_form = {.type = FORM_LIST, .item = &cell_form, .least = 2, .most = 2};

static int fit_points(reader *reader, int node, surface_text *text)
{
    return scene_points_fit(reader, tree_find(reader->t, node, "points"), text->cells,
                            &text->surface.points);
}

/* ---- keys of the surface ---- */

static int skip_value(reader *reader, int node, void *to, const void *rule)
{
    (void)reader;
    (void)node;
    (void)to;
    (void)rule;
    return 0;
}

#define WORD(type, word, keys, at, meridian, area, closed, angles, cure, help) {word, type},
static const choice surface_types[] = {SURFACE_TYPES(WORD){NULL, 0}};
#undef WORD

static const choice axes[] = {{"theta1", 1}, {"theta2", 2}, {NULL, 0}};
static const range acute = {
    -90, 90, 1, "must lie between -90 and 90 degrees, ends left out; use polar for a flat ring"};

#define NUMBER(key, range, of, help)                                                               \
    {#key, read_real, offsetof(surface_text, surface.key), &range, 0, of, NULL, help},
static const field surface_fields[] = {
    {"type", read_choice, offsetof(surface_text, type), surface_types, 1,
     .help = "Type of the surface."},
    SURFACE_NUMBERS(NUMBER){"axial", read_choice, offsetof(surface_text, surface.axial), axes,
                            .help = "Coordinate along the axis of a cylinder or spiral."},
    {"meridian", read_meridian, offsetof(surface_text, points), .of = OF_LENGTH,
     .form = &meridian_form,
     .help = "Points [radius, z] of the meridian in order; at least 4, or 2 with directions at the "
             "ends."},
    {"smoothing", read_real, offsetof(surface_text, smoothing), &not_negative, .of = OF_VOLUME,
     .help = "Factor lambda of sum |p - s(t)|^2 + lambda integral |s''|^2 dt; 0 (default) passes "
             "through the points."},
    {"ends", read_ends, offsetof(surface_text, tangents), .of = OF_NUMBER, .form = &ends_form,
     .help = "not-a-knot (default: the two pieces at each end are one cubic), or the directions "
             "[[r', z'], [r', z']] at the first and last point."},
    {"x", read_expr, offsetof(surface_text, surface.formula[0]), .of = OF_NUMBER,
     .form = &formula_form,
     .help = "Surface by formula: x of theta1 and theta2; theta1 if left out."},
    {"y", read_expr, offsetof(surface_text, surface.formula[1]), .of = OF_NUMBER,
     .form = &formula_form,
     .help = "Surface by formula: y of theta1 and theta2; theta2 if left out."},
    {"z", read_expr, offsetof(surface_text, surface.formula[2]), .of = OF_NUMBER,
     .form = &formula_form,
     .help = "Surface by formula: z of theta1 and theta2, of which x and y are other names."},
    {"points", skip_value, 0, .of = OF_LENGTH, .form = &scene_points_form,
     .help = "Points [[x, y, z], ...] of a surface fitted to points, or a file of them, in the "
             "scene's unit of length."},
    {"cells", read_int_pair, offsetof(surface_text, cells), &cell_count, .form = &cells_form,
     .of = OF_NUMBER,
     .help = "Numbers of pieces along x and y of a surface fitted to points; fewer pieces smooth "
             "more. Default: about four points to a piece."},
    {.key = NULL}};
#undef NUMBER

#define KEYS(type, word, keys, at, meridian, area, closed, angles, cure, help)                     \
    {"type=" word keys, help},
static const form_case surface_cases[] = {SURFACE_TYPES(KEYS){NULL, NULL}};
#undef KEYS
const form surface_form = {.type = FORM_MAP, .fields = surface_fields, .cases = surface_cases};

static const char *word_of(int type)
{
    const choice *one = surface_types;
    while (one->value != type)
        one++;
    return one->word;
}

static int read_surface_text(reader *reader, int node, surface_text *text)
{
    if (read_map(reader, node, surface_fields, text) != 0)
        return -1;
    text->surface.type = (scene_surface_type)text->type;
    if (check_type_case(reader, node, surface_cases, word_of(text->type)) != 0)
        return -1;
    if (tree_find(reader->t, node, "points"))
        return fit_points(reader, node, text);
    return tree_find(reader->t, node, "meridian") ? fit_meridian(reader, node, text) : 0;
}

int read_surface(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    surface_text text;
    int status;
    (void)rule;
    memset(&text, 0, sizeof text);
    scene->at_surface = node_at(reader, node);
    status = read_surface_text(reader, node, &text);
    scene->surface = text.surface;
    free(text.points.pair);
    free(text.tangents.pair);
    return status;
}

/* ---- mesh ---- */

static int make_points(reader *reader, int node, scene_line *line, int elements)
{
    line->point = calloc((size_t)elements + 1, sizeof *line->point);
    if (!line->point)
        return tree_fault(reader->t, node, "out of memory");
    line->elements = elements;
    return 0;
}

static int read_points(reader *reader, int node, scene_line *line)
{
    int i, k = 0, list = tree_find(reader->t, node, "points");
    const tree_node *points = &reader->t->node[list];
    if (reader->t->node[node].count > 1)
        return tree_fault(reader->t, node, "'points' says all; remove the other keys");
    if (points->kind != TREE_LIST || points->count < 2)
        return tree_fault(reader->t, list,
                          "'points' must be a list of at least two, [0, 0.1, ...]");
    if (points->count > SCENE_NODES)
        return tree_fault(reader->t, list, "%d points; a mesh has at most %d nodes", points->count,
                          SCENE_NODES);
    if (make_points(reader, list, line, points->count - 1) != 0)
        return -1;
    for (i = points->first; i; i = reader->t->node[i].next, k++) {
        if (read_real(reader, i, &line->point[k], NULL) != 0)
            return -1;
        if (k > 0 && !(line->point[k] > line->point[k - 1]))
            return tree_fault(
                reader->t, i,
                "point %g does not ascend after %g; the mesh would fold, sort the points and "
                "drop repeated ones",
                line->point[k], line->point[k - 1]);
    }
    return 0;
}

static int check_ascending(reader *reader, int node, const scene_line *line)
{
    int i;
    for (i = 1; i <= line->elements; i++)
        if (!(line->point[i] > line->point[i - 1]))
            return tree_fault(reader->t, node, "elements of %.60s shrink to nothing; use fewer",
                              tree_name(reader->t, node));
    return 0;
}

/*
 * Divide a range of the surface coordinate theta1 or theta2 into elements whose lengths form a
 * geometric progression.
 *   grading in  length of the last element over that of the first
 */
static int divide(reader *reader, int node, scene_line *line, double from, double to, int elements,
                  double grading)
{
    double step = 1, at = 0, ratio = elements > 1 ? pow(grading, 1.0 / (elements - 1)) : 1;
    int i;
    if (make_points(reader, node, line, elements) != 0)
        return -1;
    for (i = 1; i <= elements; i++) {
        at += step;
        line->point[i] = at;
        step *= ratio;
    }
    for (i = 0; i <= elements; i++)
        line->point[i] = grading == 1 ? from + (to - from) * i / elements
                                      : from + (to - from) * (line->point[i] / at);
    line->point[elements] = to;
    return check_ascending(reader, node, line);
}

/*
 * Divide a range of the surface coordinate theta1 or theta2, with middle m and half length h, into
 * elements that are smaller or larger in the middle. The mesh lines lie at m + h (c s + (1 - c)
 * s^3) with the parameter `centre` as c, for equidistant s from -1 to 1.
 */
static int concentrate(reader *reader, int node, scene_line *line, double from, double to,
                       int elements, double centre)
{
    int i;
    if (make_points(reader, node, line, elements) != 0)
        return -1;
    for (i = 0; i <= elements; i++) {
        const double s = (2.0 * i - elements) / elements;
        line->point[i] =
            (from + to) / 2 + (to - from) / 2 * (centre * s + (1 - centre) * s * s * s);
    }
    line->point[0] = from;
    line->point[elements] = to;
    return check_ascending(reader, node, line);
}

typedef struct line_text {
    double from, to, grading, centre;
    int elements;
    bool slit;
} line_text;

/*
 * Check that the first and the last coordinate of the mesh in a direction lie in the range in
 * which the surface is defined.
 */
static int check_ends(reader *reader, int node, int direction, double from, double to)
{
    const char *name = tree_name(reader->t, node);
    double own[2];
    if (surface_range(&reader->s->surface, direction, own) &&
        (from < own[0] - 1e-9 * own[1] || to > own[1] * (1 + 1e-9)))
        return tree_fault(
            reader->t, node,
            "%.60s runs from %g to %g, but the surface from %g to %g; leave 'from' and 'to' out "
            "for the whole of it",
            name, from, to, own[0], own[1]);
    if (to > from)
        return 0;
    return tree_fault(reader->t, node, "%.60s runs from %g to %g; 'to' must be above 'from'", name,
                      from, to);
}

/*
 * Find the first and last coordinate of the mesh along the surface coordinate theta1 or theta2.
 * Where the scene file does not give one of them, the end of the surface is taken; a surface
 * without an end in this direction is an error.
 */
static int find_ends(reader *reader, int node, int direction, line_text *text)
{
    const int from = tree_find(reader->t, node, "from"), to = tree_find(reader->t, node, "to");
    double own[2];
    if (!surface_range(&reader->s->surface, direction, own) && (!from || !to))
        return tree_fault(reader->t, node, "'%s' is missing in %.60s; add it", from ? "to" : "from",
                          tree_name(reader->t, node));
    if (!from)
        text->from = own[0];
    if (!to)
        text->to = own[1];
    return check_ends(reader, node, direction, text->from, text->to);
}

static const range element_count = {1, SCENE_NODES, 0, "must be from 1 to 60000"};
static const range grading_range = {1e-3, 1e3, 0, "must lie between 0.001 and 1000"};
static const range centre_range = {
    0, 1.5, 1, "must lie between 0 and 1.5, ends left out; 0.6 is finer in the middle"};
static const form points_form = {.type = FORM_LIST, .item = &number_form, .least = 2};

static const field line_fields[] = {
    {"from", read_real, offsetof(line_text, from), .of = OF_COORDINATE,
     .help = "Start of the mesh; may be left out, as 'to', along the meridian of a revolution and "
             "the angle of a spiral."},
    {"to", read_real, offsetof(line_text, to), .of = OF_COORDINATE,
     .help = "End of the mesh, above 'from'."},
    {"elements", read_int, offsetof(line_text, elements), &element_count, 1, .of = OF_NUMBER,
     .help = "Number of elements."},
    {"grading", read_real, offsetof(line_text, grading), &grading_range, .of = OF_NUMBER,
     .help = "Length of the last element over that of the first; default 1."},
    {"centre", read_real, offsetof(line_text, centre), &centre_range, .of = OF_NUMBER,
     .help = "Length of the elements in the middle over the mean length: the lines lie at middle + "
             "half (centre s + (1 - centre) s^3), s from -1 to 1; not with grading."},
    {"slit", read_flag, offsetof(line_text, slit),
     .help = "The ends of a full turn are not joined; default false."},
    {"points", NULL, .of = OF_COORDINATE, .form = &points_form,
     .help = "Ascending coordinates of all mesh lines, instead of the other keys."},
    {.key = NULL}};

static const form_case line_cases[] = {
    {"elements ?from ?to ?grading ?slit", "Graded elements."},
    {"elements centre ?from ?to ?slit", "Elements of another length in the middle."},
    {"points", "Every mesh line by itself."},
    {NULL, NULL}};
static const form line_form = {.type = FORM_MAP, .fields = line_fields, .cases = line_cases};

static int read_line(reader *reader, int node, void *to, const void *rule)
{
    scene_line *line = to;
    line_text text = {0, 0, 1, 1, 0, 0};
    const int *direction = rule;
    int centre;
    line->at = node_at(reader, node);
    if (reader->t->node[node].kind == TREE_MAP && tree_find(reader->t, node, "points"))
        return read_points(reader, node, line) == 0
                   ? check_ends(reader, node, *direction, line->point[0],
                                line->point[line->elements])
                   : -1;
    if (read_map(reader, node, line_fields, &text) != 0 ||
        find_ends(reader, node, *direction, &text) != 0)
        return -1;
    line->slit = text.slit;
    if (text.slit && !surface_closes(&reader->s->surface, *direction))
        return tree_fault(reader->t, tree_find(reader->t, node, "slit"),
                          "%.60s of this surface never comes back to its start; remove "
                          "'slit'",
                          tree_name(reader->t, node));
    centre = tree_find(reader->t, node, "centre");
    if (!centre)
        return divide(reader, node, line, text.from, text.to, text.elements, text.grading);
    if (tree_find(reader->t, node, "grading"))
        return tree_fault_at(reader->t, reader->t->node[centre].key_at,
                             "'centre' and 'grading' both space the elements; keep one");
    return concentrate(reader, node, line, text.from, text.to, text.elements, text.centre);
}

static const int directions[] = {1, 2};
static const field mesh_fields[] = {
    {"theta1", read_line, offsetof(scene, line[0]), &directions[0], 1, .of = OF_COORDINATE,
     .form = &line_form, .help = "Mesh lines along theta1."},
    {"theta2", read_line, offsetof(scene, line[1]), &directions[1], 1, .of = OF_COORDINATE,
     .form = &line_form, .help = "Mesh lines along theta2."},
    {.key = NULL}};

static const form lines_form = {.type = FORM_MAP, .fields = mesh_fields};
static const form *const mesh_forms[] = {&lines_form, &mesh_file_form, &mesh_disc_form,
                                         &mesh_panel_form, NULL};
const form mesh_form = {.type = FORM_ANY, .any = mesh_forms};

int read_mesh(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    if (reader->t->node[node].kind == TREE_MAP && tree_find(reader->t, node, "file"))
        return read_mesh_file(reader, node, to, rule);
    if (reader->t->node[node].kind == TREE_MAP && tree_find(reader->t, node, "disc"))
        return read_mesh_disc(reader, node, to, rule);
    if (reader->t->node[node].kind == TREE_MAP && tree_find(reader->t, node, "panel"))
        return read_mesh_panel(reader, node, to, rule);
    if (!tree_find(reader->t, reader->t->root, "surface"))
        return tree_fault(reader->t, reader->t->root,
                          "'surface' is missing in %.60s; add it, or a mesh file: mesh: {file: "
                          "name.msh}",
                          tree_name(reader->t, reader->t->root));
    if (read_map(reader, node, mesh_fields, to) != 0)
        return -1;
    if ((scene->line[0].elements + 1.0) * (scene->line[1].elements + 1.0) <= SCENE_NODES)
        return 0;
    return tree_fault(reader->t, node,
                      "a mesh of %d x %d elements has more than %d nodes; use fewer elements",
                      scene->line[0].elements, scene->line[1].elements, SCENE_NODES);
}
