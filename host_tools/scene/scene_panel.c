/* SPDX-License-Identifier: BSD-2-Clause */
/* Mesh of a panel with a hole: the key `panel` in the section `mesh` (scene_parts.h). */
#include <math.h>
#include <string.h>
#include "../quads/quad_panel.h"
#include "scene_parts.h"

static const range quarter_elements = {4, 64, 0, "must be from 4 to 64"};
static const form centre_form = {.type = FORM_LIST, .item = &number_form, .least = 2, .most = 2};

static const field panel_fields[] = {
    {"length", read_real, offsetof(quad_panel, length), &above_zero, .required = 1, .of = OF_LENGTH,
     .help = "Extent along x."},
    {"width", read_real, offsetof(quad_panel, width), &above_zero, .required = 1, .of = OF_LENGTH,
     .help = "Extent along y, on a cylinder along its circumference."},
    {"hole", read_real, offsetof(quad_panel, hole), &above_zero, .required = 1, .of = OF_LENGTH,
     .help = "Radius of the hole, on a cylinder measured along the surface."},
    {"centre", read_pair, offsetof(quad_panel, centre), .of = OF_LENGTH, .form = &centre_form,
     .help = "Centre of the hole along x and along the width, from the middle of the panel; "
             "default [0, 0]."},
    {"cylinder", read_real, offsetof(quad_panel, cylinder), &above_zero, .of = OF_LENGTH,
     .help = "Radius of the cylinder along x of which the panel is a part, its middle up; "
             "default: flat."},
    {"elements", read_int, offsetof(quad_panel, elements), &quarter_elements, .required = 1,
     .of = OF_NUMBER, .help = "Elements along a quarter of the hole's rim."},
    {.key = NULL}};
static const form panel_form = {.type = FORM_MAP, .fields = panel_fields};

/*
 * Limits of a panel with a hole. most_hole: largest ratio of the hole's radius to the distance of
 * its centre from an edge. most_angle: largest angle (rad) that a panel on a cylinder extends to
 * either side of its middle.
 */
static const double most_hole = 0.8, most_angle = 3;

static int check_panel(reader *reader, int node, const quad_panel *panel)
{
    const double extent[2] = {panel->length, panel->width};
    for (int axis = 0; axis < 2; axis++) {
        const double free = extent[axis] / 2 - fabs(panel->centre[axis]);
        if (!(free > 0))
            return tree_fault(reader->t, tree_find(reader->t, node, "centre"),
                              "the centre [%g, %g] of the hole is not on the panel, which extends "
                              "%g and %g from its middle; move it",
                              panel->centre[0], panel->centre[1], extent[0] / 2, extent[1] / 2);
        if (!(panel->hole <= most_hole * free))
            return tree_fault(reader->t, tree_find(reader->t, node, "hole"),
                              "the hole of radius %g has its centre %g from an edge, and its "
                              "radius may be at most %g of that; use a smaller hole, or a mesh "
                              "file",
                              panel->hole, free, most_hole);
    }
    if (panel->cylinder > 0 && !(panel->width <= 2 * most_angle * panel->cylinder))
        return tree_fault(reader->t, tree_find(reader->t, node, "cylinder"),
                          "the width %g goes around the cylinder of radius %g; at most %g fits",
                          panel->width, panel->cylinder, 2 * most_angle * panel->cylinder);
    if (panel->elements < quad_panel_least_elements(panel))
        return tree_fault(reader->t, tree_find(reader->t, node, "elements"),
                          "%d elements along a quarter of the hole are too long for the curvature "
                          "of the cylinder; use at least %d",
                          panel->elements, quad_panel_least_elements(panel));
    return quad_panel_nodes(panel) <= SCENE_NODES
               ? 0
               : tree_fault(reader->t, node,
                            "a panel of %zu nodes has more than %d; use fewer elements or a "
                            "larger hole",
                            quad_panel_nodes(panel), SCENE_NODES);
}

static int read_panel(reader *reader, int node, void *to, const void *rule)
{
    quad_panel *panel = to;
    (void)rule;
    return read_map(reader, node, panel_fields, panel) != 0 ? -1 : check_panel(reader, node, panel);
}

typedef struct panel_text {
    quad_panel panel;
    block_options options;
} panel_text;

static const field mesh_panel_fields[] = {
    {"panel", read_panel, offsetof(panel_text, panel), .required = 1, .form = &panel_form,
     .help = "A rectangular panel with a circular hole, in place of a surface and a mesh file."},
    BLOCK_ROWS(offsetof(panel_text, options)),
    {.key = NULL}};
const form mesh_panel_form = {.type = FORM_MAP, .fields = mesh_panel_fields};

int read_mesh_panel(reader *reader, int node, void *to, const void *rule)
{
    panel_text text;
    quad_mesh mesh;
    (void)rule;
    memset(&text, 0, sizeof text);
    if (read_map(reader, node, mesh_panel_fields, &text) != 0)
        return -1;
    if (quad_panel_make(&mesh, &text.panel) < 0)
        return tree_fault(reader->t, node, "out of memory");
    return scene_take_block(reader, node, to, "panel", &mesh, &text.options);
}
