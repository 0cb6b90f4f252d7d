/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions that read places on the mesh (points, edges, regions or sets of nodes), faces of the
 * shell and directions from a scene file, for its supports, loads, contact and outputs.
 */
#include "scene_parts.h"

#include <math.h>
#include <string.h>

const choice place_axes[] = {{"x", COMPONENT_X}, {"y", COMPONENT_Y}, {"z", COMPONENT_Z}, {NULL, 0}};
const choice place_pers[] = {
    {"point", PER_POINT}, {"length", PER_LENGTH}, {"area", PER_AREA}, {NULL, 0}};

const choice place_faces[] = {{"middle", FACE_MIDDLE},
                              {"inner", FACE_INNER},
                              {"outer", FACE_OUTER},
                              {"mean", FACE_MEAN},
                              {NULL, 0}};
const form face_form = {.type = FORM_WORD, .words = place_faces};
const int place_components[] = {COMPONENT_U1, COMPONENT_U2, COMPONENT_U3,
                                COMPONENT_X,  COMPONENT_Y,  COMPONENT_Z};

static const choice edges[] = {{"theta1-", EDGE_THETA1_MINUS},
                               {"theta1+", EDGE_THETA1_PLUS},
                               {"theta2-", EDGE_THETA2_MINUS},
                               {"theta2+", EDGE_THETA2_PLUS},
                               {NULL, 0}};

static int start_where(reader *reader, int node, scene_where *where, scene_where_type type)
{
    if (where->at.column)
        return tree_fault(reader->t, node, "two places; give either 'edge' or 'at'");
    where->at = node_at(reader, node);
    where->type = type;
    return 0;
}

int read_edge(reader *reader, int node, void *to, const void *rule)
{
    scene_where *where = to;
    int edge = 0;
    if (reader->s->quads)
        return read_set(reader, node, to, rule);
    if (start_where(reader, node, where, WHERE_EDGE) != 0 ||
        read_choice(reader, node, &edge, edges) != 0)
        return -1;
    where->edge = (scene_edge)edge;
    return 0;
}

static const field point_fields[] = {
    {"theta1", read_real, offsetof(scene_where, theta[0]), .required = 1, .of = OF_COORDINATE,
     .help = "Coordinate theta1 of a node."},
    {"theta2", read_real, offsetof(scene_where, theta[1]), .required = 1, .of = OF_COORDINATE,
     .help = "Coordinate theta2 of a node."},
    {.key = NULL}};

static const form point_form = {.type = FORM_MAP, .fields = point_fields};

static const field set_fields[] = {
    {"set", read_set, .required = 1, .form = &name_form, .help = "Name of a set of the mesh file."},
    {.key = NULL}};
static const form set_form = {.type = FORM_MAP, .fields = set_fields};
static const form *const nodes[] = {&point_form, &place_form, &set_form, NULL};
const form node_form = {.type = FORM_ANY, .any = nodes};

/*
 * Read the place at which a support, load or output acts on a mesh that comes from a file: {set:
 * name} for a set of that file, or {x, y, z} for the node nearest to this point.
 */
static int read_file_place(reader *reader, int node, scene_where *where)
{
    if (tree_find(reader->t, node, "theta1") || tree_find(reader->t, node, "theta2"))
        return tree_fault(reader->t, node,
                          "a mesh from a file has no theta1 and theta2; write {set: name} or {x: "
                          "..., y: ..., z: ...}");
    if (!tree_find(reader->t, node, "set"))
        return read_place(reader, node, where);
    where->at.column = 0;
    return read_map(reader, node, set_fields, where);
}

int read_point(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    if (start_where(reader, node, to, WHERE_POINT) != 0)
        return -1;
    return reader->s->quads ? read_file_place(reader, node, to)
                            : read_map(reader, node, point_fields, to);
}

static const field region_fields[] = {
    {"theta1", read_pair, offsetof(scene_where, span[0]), .of = OF_COORDINATE,
     .help = "Range of theta1, [from, to]; default the whole mesh."},
    {"theta2", read_pair, offsetof(scene_where, span[1]), .of = OF_COORDINATE,
     .help = "Range of theta2, [from, to]; default the whole mesh."},
    {.key = NULL}};

static const form_case region_cases[] = {{"theta1 ?theta2", NULL}, {"theta2", NULL}, {NULL, NULL}};
static const form region_form = {.type = FORM_MAP, .fields = region_fields, .cases = region_cases};
static const choice all_nodes[] = {{"nodes", 0}, {NULL, 0}};
static const form all_nodes_form = {.type = FORM_WORD, .words = all_nodes};
static const form *const places[] = {&all_nodes_form, &point_form, &region_form,
                                     &place_form,     &set_form,   NULL};
const form at_form = {.type = FORM_ANY, .any = places};
static const form edge_word_form = {.type = FORM_WORD, .words = edges};
static const form *const edge_forms[] = {&edge_word_form, &name_form, NULL};
const form edge_form = {.type = FORM_ANY, .any = edge_forms};

/*
 * Read a rectangular region of the reference surface, given by ranges [from, to] of the coordinates
 * theta1 and theta2; a coordinate whose range is not given is not limited.
 */
static int read_region(reader *reader, int node, scene_where *where)
{
    int k;
    if (start_where(reader, node, where, WHERE_REGION) != 0)
        return -1;
    for (k = 0; k < 2; k++) {
        where->span[k][0] = -HUGE_VAL;
        where->span[k][1] = HUGE_VAL;
    }
    return read_map(reader, node, region_fields, where);
}

static int has_list(const reader *reader, int node)
{
    int i;
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (reader->t->node[i].kind == TREE_LIST)
            return 1;
    return 0;
}

int read_at(reader *reader, int node, void *to, const void *rule)
{
    const char *text = node_text(reader, node);
    if (text && strcmp(text, "nodes") == 0)
        return start_where(reader, node, to, WHERE_NODES);
    if (reader->t->node[node].kind != TREE_MAP)
        return tree_fault(
            reader->t, node,
            "'at: %.60s' is no place; write {theta1: ..., theta2: ...}, nodes, or edge: "
            "theta1+ instead",
            text ? text : "[...]");
    return has_list(reader, node) && !reader->s->quads ? read_region(reader, node, to)
                                                       : read_point(reader, node, to, rule);
}

int require_place(reader *reader, int node, const scene_where *where)
{
    if (where->at.column)
        return 0;
    if (reader->s->quads)
        return tree_fault(
            reader->t, node,
            "no place in this item of %.60s; add set: name, at: nodes or at: {x: ..., "
            "y: ..., z: ...}",
            tree_name(reader->t, node));
    return tree_fault(
        reader->t, node,
        "no place in this item of %.60s; add at: {theta1: ..., theta2: ...}, at: nodes or "
        "edge: theta1+",
        tree_name(reader->t, node));
}
