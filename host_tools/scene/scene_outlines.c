/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Readers of the keys `plane` and `outlines` of patches: electrodes of any outline (scene_parts.h).
 */
#include "scene_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../data/polygon.h"
#include "outline_patterns.h"
#include "scene_file.h"

static const range ring_count = {0, OUTLINE_RINGS, 0, "must be from 0 to 64"};
static const range cell_count = {1, OUTLINE_CELLS, 0, "must be from 1 to 1000"};
static const range any_turn = {-360, 360, 0, "must lie between -360 and 360 degrees"};
static const form real_pair_form = {.type = FORM_LIST, .item = &number_form, .least = 2, .most = 2};
static const form cell_count_form = {.type = FORM_WHOLE, .range = &cell_count};
static const form cell_counts_form = {
    .type = FORM_LIST, .item = &cell_count_form, .least = 2, .most = 2};

static int out_of_memory(reader *reader, int node)
{
    return tree_fault(reader->t, node, "the outlines do not fit into memory; use fewer");
}

/*
 * Refuse a pattern of electrodes whose gap is so wide that no area of some electrode is left;
 * `size` is the smallest width of any electrode of the pattern. Returns 0, or -1 after writing an
 * error message about the scene file.
 */
static int check_gap(reader *reader, int node, double gap, double size)
{
    if (size > 0)
        return 0;
    return tree_fault(
        reader->t, tree_find(reader->t, node, "gap"),
        "a gap of %g leaves no electrode of a cell of %g; compare their units, or use "
        "larger cells or a smaller gap",
        gap, size + gap);
}

/* ---- polygons --------------------------------------------------------- */

/*
 * Refuse a list of points that is not the outline of an area. Returns 0, or -1 after writing an
 * error message about the scene file.
 */
static int check_polygon(reader *reader, int node, const double (*point)[2], size_t count)
{
    size_t at[2];
    switch (polygon_check(point, count, at)) {
    case POLYGON_FEW:
        return tree_fault(reader->t, node, "a polygon of %zu points; give three or more", count);
    case POLYGON_REPEATED:
        return tree_fault(reader->t, node,
                          "points %zu and %zu of the polygon are equal; leave one out, the last "
                          "point is joined to the first",
                          at[0], at[1]);
    case POLYGON_CROSSED:
        return tree_fault(reader->t, node,
                          "the sides from points %zu and %zu of the polygon cross or touch; list "
                          "the points in their order along the outline",
                          at[0], at[1]);
    case POLYGON_FLAT:
        return tree_fault(reader->t, node,
                          "the points of the polygon lie on a line; it has no area");
    case POLYGON_INFINITE:
        return tree_fault(reader->t, node, "point %zu of the polygon is not finite", at[0]);
    case POLYGON_GOOD: break;
    }
    return 0;
}

/* Reverse the order of the points of a polygon where they run clockwise. */
static void run_counterclockwise(double (*point)[2], size_t count)
{
    if (polygon_sums_of((const double(*)[2])point, count, point[0]).area > 0)
        return;
    for (size_t i = 0; i < count / 2; i++) {
        double one[2];
        memcpy(one, point[i], sizeof one);
        memcpy(point[i], point[count - 1 - i], sizeof one);
        memcpy(point[count - 1 - i], one, sizeof one);
    }
}

static int read_polygon(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    if (require_kind(reader, node, TREE_LIST) != 0)
        return -1;
    const size_t count = (size_t)reader->t->node[node].count;
    scene_outline *outline = outline_append(to, node_at(reader, node));
    double(*point)[2] = outline ? outline_polygon(outline, count + 1) : NULL;
    if (!point)
        return out_of_memory(reader, node);
    outline->polygon->count = count;
    size_t k = 0;
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_pair(reader, i, point[k++], NULL) != 0)
            return -1;
    if (check_polygon(reader, node, (const double(*)[2])point, count) != 0)
        return -1;
    run_counterclockwise(point, count);
    return 0;
}

static const form polygon_form = {.type = FORM_LIST, .item = &real_pair_form, .least = 3};

typedef struct circle_text {
    double centre[2], radius;
} circle_text;

static const field circle_fields[] = {
    {"centre", read_pair, offsetof(circle_text, centre), .of = OF_OUTLINE, .form = &real_pair_form,
     .help = "Centre of the circle; default [0, 0]."},
    {"radius", read_real, offsetof(circle_text, radius), &above_zero, 1, .of = OF_OUTLINE,
     .help = "Radius of the circle."},
    {.key = NULL}};
static const form circle_form = {.type = FORM_MAP, .fields = circle_fields};

static int read_circle(reader *reader, int node, void *to, const void *rule)
{
    circle_text text = {{0, 0}, 0};
    (void)rule;
    if (read_map(reader, node, circle_fields, &text) != 0)
        return -1;
    if (outline_circle(to, text.centre, text.radius, node_at(reader, node)) < 0)
        return out_of_memory(reader, node);
    return 0;
}

/* ---- patterns --------------------------------------------------------- */

static const field hexagon_fields[] = {
    {"pitch", read_real, offsetof(hexagon_pattern, pitch), &above_zero, 1, .of = OF_OUTLINE,
     .help = "Distance of the centres of neighbouring hexagons."},
    {"rings", read_int, offsetof(hexagon_pattern, rings), &ring_count, 1, .of = OF_NUMBER,
     .help = "Rings around the hexagon in the middle: 3 make 37 hexagons, 4 make 61, 6 make 127."},
    {"gap", read_real, offsetof(hexagon_pattern, gap), &not_negative, .of = OF_OUTLINE,
     .help = "Distance between neighbouring electrodes; default 0."},
    {"angle", read_real, offsetof(hexagon_pattern, angle), &any_turn, .of = OF_DEGREES,
     .help = "Direction from the middle to the first hexagon of each ring, in degrees; default 0."},
    {"centre", read_pair, offsetof(hexagon_pattern, centre), .of = OF_OUTLINE,
     .form = &real_pair_form, .help = "Centre of the pattern; default [0, 0]."},
    {.key = NULL}};
static const form hexagons_form = {.type = FORM_MAP, .fields = hexagon_fields};

static int read_hexagons(reader *reader, int node, void *to, const void *rule)
{
    hexagon_pattern pattern;
    (void)rule;
    memset(&pattern, 0, sizeof pattern);
    if (read_map(reader, node, hexagon_fields, &pattern) != 0 ||
        check_gap(reader, node, pattern.gap, outline_hexagon_size(&pattern)) != 0)
        return -1;
    return outline_hexagons(to, &pattern, node_at(reader, node)) < 0 ? out_of_memory(reader, node)
                                                                     : 0;
}

static const field outline_grid_fields[] = {
    {"from", read_pair, offsetof(grid_pattern, from), .required = 1, .of = OF_OUTLINE,
     .form = &real_pair_form, .help = "Corner of the rectangle with the smaller coordinates."},
    {"to", read_pair, offsetof(grid_pattern, to), .required = 1, .of = OF_OUTLINE,
     .form = &real_pair_form, .help = "Corner of the rectangle with the larger coordinates."},
    {"count", read_int_pair, offsetof(grid_pattern, count), &cell_count, 1, .of = OF_NUMBER,
     .form = &cell_counts_form,
     .help = "Number of electrodes along the first and the second coordinate."},
    {"gap", read_real, offsetof(grid_pattern, gap), &not_negative, .of = OF_OUTLINE,
     .help = "Distance between neighbouring electrodes; default 0."},
    {"angle", read_real, offsetof(grid_pattern, angle), &any_turn, .of = OF_DEGREES,
     .help = "Turn of the rectangle about its middle, in degrees; default 0."},
    {.key = NULL}};
static const form outline_grid_form = {.type = FORM_MAP, .fields = outline_grid_fields};

static int read_outline_grid(reader *reader, int node, void *to, const void *rule)
{
    grid_pattern pattern;
    (void)rule;
    memset(&pattern, 0, sizeof pattern);
    if (read_map(reader, node, outline_grid_fields, &pattern) != 0)
        return -1;
    for (int direction = 0; direction < 2; direction++)
        if (!(pattern.from[direction] < pattern.to[direction]))
            return tree_fault(reader->t, tree_find(reader->t, node, "to"),
                              "the grid runs from %g to %g; let 'to' be the larger one",
                              pattern.from[direction], pattern.to[direction]);
    if (pattern.count[0] * pattern.count[1] > OUTLINE_MOST)
        return tree_fault(reader->t, node, "%d electrodes; at most %d are possible",
                          pattern.count[0] * pattern.count[1], OUTLINE_MOST);
    if (check_gap(reader, node, pattern.gap, outline_grid_size(&pattern)) != 0)
        return -1;
    ((scene_outlines *)to)->columns = pattern.count[1];
    return outline_grid(to, &pattern, node_at(reader, node)) < 0 ? out_of_memory(reader, node) : 0;
}

/* Read the radii that bound the rings of an electrode pattern, ascending; the first may be 0. */
static int read_ring_radii(reader *reader, int node, void *to, const void *rule)
{
    ring_pattern *pattern = to;
    int k = 0;
    (void)rule;
    if (require_kind(reader, node, TREE_LIST) != 0)
        return -1;
    if (reader->t->node[node].count < 2 || reader->t->node[node].count > OUTLINE_RINGS + 1)
        return tree_fault(reader->t, node, "%d radii; give from 2 to %d, one more than rings",
                          reader->t->node[node].count, OUTLINE_RINGS + 1);
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next, k++) {
        if (read_real(reader, i, &pattern->radius[k], &not_negative) != 0)
            return -1;
        if (k > 0 && !(pattern->radius[k] > pattern->radius[k - 1]))
            return tree_fault(reader->t, i,
                              "the radius %g follows %g; list them from the inside outwards",
                              pattern->radius[k], pattern->radius[k - 1]);
    }
    pattern->rings = k - 1;
    return 0;
}

/*
 * Read the number of sectors of each ring of an electrode pattern, after the radii of the rings
 * have been read.
 */
static int read_ring_sectors(reader *reader, int node, void *to, const void *rule)
{
    ring_pattern *pattern = to;
    int k = 0;
    if (require_kind(reader, node, TREE_LIST) != 0)
        return -1;
    if (reader->t->node[node].count != pattern->rings)
        return tree_fault(reader->t, node, "%d numbers of sectors for %d rings; give one for each",
                          reader->t->node[node].count, pattern->rings);
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_int(reader, i, &pattern->sectors[k++], rule) != 0)
            return -1;
    return 0;
}

static const form ring_radii_form = {.type = FORM_LIST, .item = &not_negative_form, .least = 2};
static const form ring_sectors_form = {.type = FORM_LIST, .item = &cell_count_form, .least = 1};
static const field ring_fields[] = {
    {"radii", read_ring_radii, 0, .required = 1, .of = OF_OUTLINE, .form = &ring_radii_form,
     .help = "Radii that bound the rings, from the inside outwards; the first may be 0."},
    {"sectors", read_ring_sectors, 0, &cell_count, 1, .of = OF_NUMBER, .form = &ring_sectors_form,
     .help = "Number of sectors of each ring, one less than radii."},
    {"gap", read_real, offsetof(ring_pattern, gap), &not_negative, .of = OF_OUTLINE,
     .help = "Distance between neighbouring electrodes; default 0."},
    {"angle", read_real, offsetof(ring_pattern, angle), &any_turn, .of = OF_DEGREES,
     .help = "Direction in which the first sector of each ring begins, in degrees; default 0."},
    {"centre", read_pair, offsetof(ring_pattern, centre), .of = OF_OUTLINE, .form = &real_pair_form,
     .help = "Centre of the rings; default [0, 0]."},
    {.key = NULL}};
static const form outline_rings_form = {.type = FORM_MAP, .fields = ring_fields};

static int read_outline_rings(reader *reader, int node, void *to, const void *rule)
{
    ring_pattern pattern;
    int electrodes = 0;
    (void)rule;
    memset(&pattern, 0, sizeof pattern);
    if (read_map(reader, node, ring_fields, &pattern) != 0)
        return -1;
    for (int k = 0; k < pattern.rings; k++)
        electrodes += pattern.sectors[k];
    if (electrodes > OUTLINE_MOST)
        return tree_fault(reader->t, node, "%d electrodes; at most %d are possible", electrodes,
                          OUTLINE_MOST);
    if (check_gap(reader, node, pattern.gap, outline_ring_size(&pattern)) != 0)
        return -1;
    return outline_rings(to, &pattern, node_at(reader, node)) < 0 ? out_of_memory(reader, node) : 0;
}

/* ---- formulas --------------------------------------------------------- */

static int read_inside(reader *reader, int node, void *to, const void *rule)
{
    scene_outline *outline = outline_append(to, node_at(reader, node));
    if (!outline)
        return out_of_memory(reader, node);
    return read_expr(reader, node, &outline->inside, rule);
}

/* ---- bitmaps ---------------------------------------------------------- */

typedef struct bitmap_text {
    double from[2], to[2], threshold;
    int file; /* YAML node with the name of a picture file (bitmap) whose pixels say to which
                 electrode they belong */
} bitmap_text;

static const field bitmap_fields[] = {
    {"file", read_scalar_node, offsetof(bitmap_text, file), .required = 1, .form = &label_form,
     .help =
         "Picture (PGM) or table of whole numbers beside the scene; its first line is the one "
         "with the largest second coordinate. A pixel of value k belongs to electrode k, one of "
         "value 0 to none."},
    {"from", read_pair, offsetof(bitmap_text, from), .required = 1, .of = OF_OUTLINE,
     .form = &real_pair_form, .help = "Corner of the bitmap with the smaller coordinates."},
    {"to", read_pair, offsetof(bitmap_text, to), .required = 1, .of = OF_OUTLINE,
     .form = &real_pair_form, .help = "Corner of the bitmap with the larger coordinates."},
    {"threshold", read_real, offsetof(bitmap_text, threshold), .of = OF_NUMBER,
     .help =
         "One electrode where the values are above this number, instead of one for each value."},
    {.key = NULL}};
static const form bitmap_form = {.type = FORM_MAP, .fields = bitmap_fields};

/*
 * Return the number, from 1, of the electrode to which a pixel of a bitmap of electrodes belongs;
 * 0: the pixel belongs to no electrode, -1: the value of the pixel names no electrode.
 */
static int label_of(const bitmap_text *text, double value)
{
    if (!isnan(text->threshold))
        return value > text->threshold;
    return value >= 0 && value <= OUTLINE_MOST && value == floor(value) ? (int)value : -1;
}

/*
 * Append to an electrode the rectangle of the pixels from column `from` to column `to` - 1 in a row
 * of a bitmap.
 */
static int add_run(const bitmap_text *text, const number_table *table, size_t row, size_t from,
                   size_t to, scene_outline *outline)
{
    const double rows = (double)table->rows, columns = (double)table->columns;
    const double wide = text->to[0] - text->from[0], high = text->to[1] - text->from[1];
    const double x[2] = {text->from[0] + wide * ((double)from / columns),
                         text->from[0] + wide * ((double)to / columns)};
    const double y[2] = {text->from[1] + high * ((rows - 1 - (double)row) / rows),
                         text->from[1] + high * ((rows - (double)row) / rows)};
    double(*point)[2] = outline_polygon(outline, 4);
    if (!point)
        return -1;
    for (int k = 0; k < 4; k++) {
        point[k][0] = x[k == 1 || k == 2];
        point[k][1] = y[k >= 2];
    }
    return 0;
}

/*
 * Append the pixels of one row of a bitmap to their electrodes; neighbouring pixels of one
 * electrode become one rectangle.
 */
static int add_row(const bitmap_text *text, const number_table *table, size_t row,
                   scene_outline *first)
{
    const double *value = table->value + row * table->columns;
    size_t end;
    for (size_t k = 0; k < table->columns; k = end) {
        const int label = label_of(text, value[k]);
        for (end = k + 1; end < table->columns && label_of(text, value[end]) == label;)
            end++;
        if (label > 0 && add_run(text, table, row, k, end, &first[label - 1]) < 0)
            return -1;
    }
    return 0;
}

/*
 * Return the number of electrodes that the pixels of a bitmap name, or -1 after writing an error
 * message about the scene file.
 */
static int count_labels(reader *reader, const bitmap_text *text, const number_table *table)
{
    int most = 0;
    for (size_t i = 0; i < table->rows * table->columns; i++) {
        const int label = label_of(text, table->value[i]);
        if (label < 0)
            return tree_fault(reader->t, text->file,
                              "row %zu, column %zu of the bitmap is %g; write whole numbers from 0 "
                              "to %d, or give a 'threshold'",
                              i / table->columns + 1, i % table->columns + 1, table->value[i],
                              OUTLINE_MOST);
        most = label > most ? label : most;
    }
    if (most == 0)
        return tree_fault(reader->t, text->file, "no pixel of the bitmap belongs to an electrode");
    return most;
}

static int add_bitmap(reader *reader, const bitmap_text *text, const number_table *table,
                      scene_outlines *outlines)
{
    const int labels = count_labels(reader, text, table), first = outlines->electrodes;
    for (int k = 0; k < labels; k++)
        if (!outline_append(outlines, node_at(reader, text->file)))
            return out_of_memory(reader, text->file);
    for (size_t row = 0; labels > 0 && row < table->rows; row++)
        if (add_row(text, table, row, &outlines->electrode[first]) < 0)
            return out_of_memory(reader, text->file);
    for (int k = 0; k < labels; k++)
        if (outlines->electrode[first + k].polygons == 0)
            return tree_fault(reader->t, text->file,
                              "no pixel of the bitmap has the value %d, but one has %d; number the "
                              "electrodes from 1 without holes, or give a 'threshold'",
                              k + 1, labels);
    return labels < 0 ? -1 : 0;
}

static int read_bitmap(reader *reader, int node, void *to, const void *rule)
{
    bitmap_text text = {{0, 0}, {0, 0}, (double)NAN, 0};
    number_table table;
    (void)rule;
    if (read_map(reader, node, bitmap_fields, &text) != 0)
        return -1;
    for (int direction = 0; direction < 2; direction++)
        if (!(text.from[direction] < text.to[direction]))
            return tree_fault(reader->t, tree_find(reader->t, node, "to"),
                              "the bitmap runs from %g to %g; let 'to' be the larger one",
                              text.from[direction], text.to[direction]);
    if (scene_table_read(reader, text.file, &table) != 0)
        return -1;
    const int status = add_bitmap(reader, &text, &table, to);
    number_table_free(&table);
    return status;
}

/* ---- the list --------------------------------------------------------- */

static const field outline_fields[] = {
    {"polygon", read_polygon, 0, .of = OF_OUTLINE, .form = &polygon_form,
     .help = "One electrode: corners [[x, y], ...] in their order along the outline."},
    {"circle", read_circle, 0, .form = &circle_form, .help = "One electrode: a circle."},
    {"inside", read_inside, 0, .of = OF_NUMBER, .form = &formula_form,
     .help = "One electrode: where a formula of the coordinates is above 0."},
    {"hexagons", read_hexagons, 0, .form = &hexagons_form,
     .help = "Hexagons in rings around one in the middle, which is the first; then ring by ring "
             "from the inside, counterclockwise."},
    {"grid", read_outline_grid, 0, .form = &outline_grid_form,
     .help = "Equal rectangles; the second coordinate runs fastest."},
    {"rings", read_outline_rings, 0, .form = &outline_rings_form,
     .help = "Rings divided into sectors; ring by ring from the inside, counterclockwise."},
    {"bitmap", read_bitmap, 0, .form = &bitmap_form,
     .help = "Electrodes as the pixels of a picture or table, numbered by their values."},
    {.key = NULL}};
static const form_case outline_cases[] = {{"polygon", NULL},  {"circle", NULL}, {"inside", NULL},
                                          {"hexagons", NULL}, {"grid", NULL},   {"rings", NULL},
                                          {"bitmap", NULL},   {NULL, NULL}};
static const form outline_form = {
    .type = FORM_MAP, .fields = outline_fields, .cases = outline_cases};
const form outlines_form = {.type = FORM_LIST, .item = &outline_form, .least = 1};

static const choice planes[] = {{"theta", OUTLINE_THETA},
                                {"xy", OUTLINE_XY},
                                {"xz", OUTLINE_XZ},
                                {"yz", OUTLINE_YZ},
                                {NULL, 0}};
const form plane_form = {.type = FORM_WORD, .words = planes};

int read_plane(reader *reader, int node, void *to, const void *rule)
{
    int plane;
    (void)rule;
    if (read_choice(reader, node, &plane, planes) != 0)
        return -1;
    if (plane == OUTLINE_THETA && reader->s->quads)
        return tree_fault(reader->t, node,
                          "a mesh from a file has no theta1 and theta2; use plane: xy, xz or yz");
    *(outline_plane *)to = (outline_plane)plane;
    return 0;
}

int read_outlines(reader *reader, int node, void *to, const void *rule)
{
    scene_patches *patches = to;
    (void)rule;
    if (require_kind(reader, node, TREE_LIST) != 0)
        return -1;
    patches->outlines = calloc(1, sizeof *patches->outlines);
    if (!patches->outlines)
        return out_of_memory(reader, node);
    patches->outlines->columns = 1;
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        if (require_kind(reader, i, TREE_MAP) != 0)
            return -1;
        if (reader->t->node[i].count != 1)
            return tree_fault(reader->t, i,
                              "%d keys in one item of 'outlines'; give one shape in each",
                              reader->t->node[i].count);
        if (read_map(reader, i, outline_fields, patches->outlines) != 0)
            return -1;
    }
    if (patches->outlines->electrodes == 0)
        return tree_fault(reader->t, node,
                          "'outlines' is empty; give shapes, as [{circle: {radius: 1}}]");
    if (patches->outlines->electrodes > OUTLINE_MOST)
        return tree_fault(reader->t, node, "%d electrodes; at most %d are possible",
                          patches->outlines->electrodes, OUTLINE_MOST);
    outlines_find_boxes(patches->outlines);
    patches->grid[1] = reader->t->node[node].count == 1 ? patches->outlines->columns : 1;
    patches->grid[0] = patches->outlines->electrodes / patches->grid[1];
    return 0;
}
