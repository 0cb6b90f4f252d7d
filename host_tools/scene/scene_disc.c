/* SPDX-License-Identifier: BSD-2-Clause */
/* Mesh of a disc: the key `disc` in the section `mesh` of a scene file (scene_parts.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/quad_disc.h"
#include "scene_parts.h"

static const range even_elements = {2, 64, 0, "must be from 2 to 64"};
static const range whole_sectors = {1, 64, 0, "must be from 1 to 64"};

/* ---- the disc ----------------------------------------------------------- */

/* Read a list of radii of concentric circles, which must ascend. */
static int read_rings(reader *reader, int node, void *to, const void *rule)
{
    quad_disc *disc = to;
    (void)rule;
    if (require_kind(reader, node, TREE_LIST) != 0)
        return -1;
    if (reader->t->node[node].count > QUAD_RINGS)
        return tree_fault(reader->t, node, "%d circles; at most %d are possible",
                          reader->t->node[node].count, QUAD_RINGS);
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        double *ring = &disc->ring[disc->rings];
        if (read_real(reader, i, ring, &above_zero) != 0)
            return -1;
        if (disc->rings > 0 && !(*ring > ring[-1]))
            return tree_fault(reader->t, i,
                              "the radius %g follows %g; list circles from the inside "
                              "outwards",
                              *ring, ring[-1]);
        disc->rings++;
    }
    return 0;
}

static const form rings_form = {.type = FORM_LIST, .item = &above_zero_form, .most = QUAD_RINGS};
static const field disc_fields[] = {
    {"radius", read_real, offsetof(quad_disc, radius), &above_zero, .required = 1, .of = OF_LENGTH,
     .help = "Radius of the rim."},
    {"sphere", read_real, offsetof(quad_disc, sphere), &above_zero, .of = OF_LENGTH,
     .help = "Radius of the sphere of which the disc is a part, its middle up; default: flat."},
    {"focal", read_real, offsetof(quad_disc, focal), &above_zero, .of = OF_LENGTH,
     .help = "Focal length of the paraboloid z = (x^2+y^2)/(4 focal) of which the disc is a part, "
             "in place of 'sphere'."},
    {"rings", read_rings, 0, .of = OF_LENGTH, .form = &rings_form,
     .help = "Radii of circles between which patches may end, from the inside outwards."},
    {"elements", read_int, offsetof(quad_disc, elements), &even_elements, .required = 1,
     .of = OF_NUMBER,
     .help = "Elements along a side of the block in the middle, an even number; four times as many "
             "along a circle."},
    {"sectors", read_int, offsetof(quad_disc, sectors), &whole_sectors, .of = OF_NUMBER,
     .help = "Parts of equal angle of each ring outside the first circle; default 1."},
    {.key = NULL}};
static const form disc_form = {.type = FORM_MAP, .fields = disc_fields};

static int check_disc(reader *reader, int node, const quad_disc *disc)
{
    if (disc->elements % 2)
        return tree_fault(reader->t, tree_find(reader->t, node, "elements"),
                          "%d elements; give an even number", disc->elements);
    if (4 * disc->elements % disc->sectors)
        return tree_fault(reader->t, tree_find(reader->t, node, "sectors"),
                          "%d sectors do not divide the %d elements along a circle", disc->sectors,
                          4 * disc->elements);
    if (disc->rings > 0 && !(disc->ring[disc->rings - 1] < disc->radius))
        return tree_fault(reader->t, tree_find(reader->t, node, "rings"),
                          "the circle of radius %g lies outside the rim of radius %g",
                          disc->ring[disc->rings - 1], disc->radius);
    if (disc->sphere > 0 && !(disc->radius <= 0.95 * disc->sphere))
        return tree_fault(reader->t, tree_find(reader->t, node, "sphere"),
                          "the radius %g of the rim is more than 0.95 of the sphere's %g; use a "
                          "flatter part of the sphere",
                          disc->radius, disc->sphere);
    if (disc->focal > 0 && disc->sphere > 0)
        return tree_fault(
            reader->t, tree_find(reader->t, node, "focal"),
            "a disc is part of a sphere or of a paraboloid; give 'sphere' or 'focal'");
    if (disc->focal > 0 && !(disc->radius <= 6 * disc->focal))
        return tree_fault(reader->t, tree_find(reader->t, node, "focal"),
                          "the radius %g of the rim is more than 6 focal lengths of %g; use a "
                          "flatter part of the paraboloid",
                          disc->radius, disc->focal);
    return 0;
}

static int read_disc(reader *reader, int node, void *to, const void *rule)
{
    quad_disc *disc = to;
    (void)rule;
    disc->sectors = 1;
    return read_map(reader, node, disc_fields, disc) != 0 ? -1 : check_disc(reader, node, disc);
}

/* ---- the section mesh --------------------------------------------------- */

typedef struct disc_text {
    quad_disc disc;
    block_options options;
} disc_text;

static const field mesh_disc_fields[] = {
    {"disc", read_disc, offsetof(disc_text, disc), .required = 1, .form = &disc_form,
     .help = "A disc without a hole, in place of a surface and a mesh file."},
    BLOCK_ROWS(offsetof(disc_text, options)),
    {.key = NULL}};
const form mesh_disc_form = {.type = FORM_MAP, .fields = mesh_disc_fields};

int scene_take_block(reader *reader, int node, scene *scene, const char *key, quad_mesh *mesh,
                     const block_options *options)
{
    char *name = calloc(strlen(key) + 1, 1);
    scene->quads = calloc(1, sizeof *scene->quads);
    if (!scene->quads || !name) {
        free(name);
        quad_mesh_free(mesh);
        return tree_fault(reader->t, node, "out of memory");
    }
    memcpy(name, key, strlen(key));
    scene->quads->mesh = *mesh;
    scene->quads->file = name;
    scene->quads->at = node_at(reader, node);
    scene->quads->accept_irregular = options->accept_irregular;
    scene->at_surface = scene->line[0].at = scene->line[1].at = scene->quads->at;
    if (tree_find(reader->t, reader->t->root, "surface"))
        return tree_fault(reader->t, tree_find(reader->t, node, key),
                          "a %s brings its own surface; remove 'surface'", key);
    if (mesh->nodes > SCENE_NODES)
        return tree_fault(reader->t, node, "a %s of %zu nodes has more than %d; use fewer elements",
                          key, mesh->nodes, SCENE_NODES);
    return 0;
}

int read_mesh_disc(reader *reader, int node, void *to, const void *rule)
{
    disc_text text;
    quad_mesh mesh;
    (void)rule;
    memset(&text, 0, sizeof text);
    if (read_map(reader, node, mesh_disc_fields, &text) != 0)
        return -1;
    if (quad_disc_make(&mesh, &text.disc) < 0)
        return tree_fault(reader->t, node, "out of memory");
    return scene_take_block(reader, node, to, "disc", &mesh, &text.options);
}
