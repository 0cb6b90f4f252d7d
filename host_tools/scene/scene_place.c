/* Places, faces and directions: the words that supports, loads, contact and outputs share. */
#include "scene_parts.h"

#include <math.h>
#include <string.h>

const choice place_axes[] = {{"x", COMPONENT_X}, {"y", COMPONENT_Y}, {"z", COMPONENT_Z}, {NULL, 0}};
const choice place_faces[] = {{"middle", FACE_MIDDLE},
                              {"inner", FACE_INNER},
                              {"outer", FACE_OUTER},
                              {"mean", FACE_MEAN},
                              {NULL, 0}};
const int place_components[] = {COMPONENT_U1, COMPONENT_U2, COMPONENT_U3,
                                COMPONENT_X,  COMPONENT_Y,  COMPONENT_Z};

static const choice edges[] = {{"theta1-", EDGE_THETA1_MINUS},
                               {"theta1+", EDGE_THETA1_PLUS},
                               {"theta2-", EDGE_THETA2_MINUS},
                               {"theta2+", EDGE_THETA2_PLUS},
                               {NULL, 0}};

static int start_where(reader *r, int node, scene_where *w, scene_where_type type)
{
    if (w->at.column)
        return tree_fault(r->t, node, "two places; give either 'edge' or 'at'");
    w->at = node_at(r, node);
    w->type = type;
    return 0;
}

int read_edge(reader *r, int node, void *to, const void *rule)
{
    scene_where *w = to;
    int edge = 0;
    (void)rule;
    if (start_where(r, node, w, WHERE_EDGE) != 0 || read_choice(r, node, &edge, edges) != 0)
        return -1;
    w->edge = (scene_edge)edge;
    return 0;
}

int read_point(reader *r, int node, void *to, const void *rule)
{
    static const field fields[] = {{"theta1", read_real, offsetof(scene_where, theta[0]), NULL, 1},
                                   {"theta2", read_real, offsetof(scene_where, theta[1]), NULL, 1},
                                   {NULL, NULL, 0, NULL, 0}};
    (void)rule;
    if (start_where(r, node, to, WHERE_POINT) != 0)
        return -1;
    return read_map(r, node, fields, to);
}

/* [from, to] along both coordinates; one that is left out is whole. */
static int read_region(reader *r, int node, scene_where *w)
{
    static const field fields[] = {{"theta1", read_pair, offsetof(scene_where, span[0]), NULL, 0},
                                   {"theta2", read_pair, offsetof(scene_where, span[1]), NULL, 0},
                                   {NULL, NULL, 0, NULL, 0}};
    int k;
    if (start_where(r, node, w, WHERE_REGION) != 0)
        return -1;
    for (k = 0; k < 2; k++) {
        w->span[k][0] = -HUGE_VAL;
        w->span[k][1] = HUGE_VAL;
    }
    return read_map(r, node, fields, w);
}

static int has_list(const reader *r, int node)
{
    int i;
    for (i = r->t->node[node].first; i; i = r->t->node[i].next)
        if (r->t->node[i].kind == TREE_LIST)
            return 1;
    return 0;
}

int read_at(reader *r, int node, void *to, const void *rule)
{
    const char *text = node_text(r, node);
    if (text && strcmp(text, "nodes") == 0)
        return start_where(r, node, to, WHERE_NODES);
    if (r->t->node[node].kind != TREE_MAP)
        return tree_fault(
            r->t, node,
            "'at: %.60s' is no place; write {theta1: ..., theta2: ...}, nodes, or edge: "
            "theta1+ instead",
            text ? text : "[...]");
    return has_list(r, node) ? read_region(r, node, to) : read_point(r, node, to, rule);
}

int require_place(reader *r, int node, const scene_where *w)
{
    if (w->at.column)
        return 0;
    return tree_fault(
        r->t, node,
        "no place in this item of %.60s; add at: {theta1: ..., theta2: ...}, at: nodes or "
        "edge: theta1+",
        tree_name(r->t, node));
}
