/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Springs of a scene (section `springs`), and its stack actuators, which are piezoelectric stacks
 * or voice coils between points of the structure (section `actuators`); see scene_parts.h.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "scene_parts.h"
#include "scene_points.h"

/* ---- directions of springs ---------------------------------------------- */

static const choice components[] = {{"u1", COMPONENT_U1},
                                    {"u2", COMPONENT_U2},
                                    {"u3", COMPONENT_U3},
                                    {"x", COMPONENT_X},
                                    {"y", COMPONENT_Y},
                                    {"z", COMPONENT_Z},
                                    {NULL, 0}};
static const form component_form = {.type = FORM_WORD, .words = components};
static const form *const direction_forms[] = {&component_form, &triple_form, NULL};
const form direction_form = {.type = FORM_ANY, .any = direction_forms};

int read_any_direction(reader *reader, int node, void *to, const void *rule)
{
    scene_direction *direction = to;
    int component = 0;
    direction->given = true;
    if (reader->t->node[node].kind == TREE_LIST)
        return read_unit(reader, node, direction->vector, rule);
    if (read_choice(reader, node, &component, components) != 0)
        return -1;
    direction->component = (scene_component)component;
    return 0;
}

/* ---- attachment points of springs --------------------------------------- */

/*
 * Copy the coordinates of one attachment point of a spring or stack from a row of a table; on a
 * mesh from a file the coordinate z may be missing.
 */
static int copy_point(reader *reader, int node, const number_table *table, size_t row,
                      const int column[SCENE_AXES], double point[SCENE_AXES])
{
    const int is_list = reader->t->node[node].kind == TREE_LIST;
    const double *values = table->value + row * table->columns;
    int given = SCENE_AXES;
    if (is_list) {
        int item = reader->t->node[node].first;
        for (size_t i = 0; i < row; i++)
            item = reader->t->node[item].next;
        given = reader->t->node[item].count;
    }
    for (int axis = 0; axis < SCENE_AXES; axis++) {
        const int is_missing = column[axis] < 0 || axis >= given;
        if (is_missing && axis < 2)
            return tree_fault(reader->t, node, "point %zu has no second coordinate; write [x, y]",
                              row + 1);
        point[axis] = is_missing ? (double)NAN : values[column[axis]];
        if (!is_missing && !isfinite(point[axis]))
            return tree_fault(reader->t, node,
                              "coordinate %d of point %zu is %g; write a finite number", axis + 1,
                              row + 1, point[axis]);
    }
    return 0;
}

int scene_points_read(reader *reader, int node, double (**point)[3], int *points)
{
    number_table table;
    int column[SCENE_AXES];
    int failed = scene_points_table(reader, node, &table, column) != 0;
    if (!failed && table.rows == 0)
        failed = tree_fault(reader->t, node, "'points' is empty; give one, as [[0, 0]]");
    *point = failed ? NULL : calloc(table.rows, sizeof **point);
    if (!failed && !*point)
        failed = tree_fault(reader->t, node, "out of memory");
    for (size_t k = 0; !failed && k < table.rows; k++)
        failed = copy_point(reader, node, &table, k, column, (*point)[k]);
    *points = failed ? 0 : (int)table.rows;
    number_table_free(&table);
    return failed ? -1 : 0;
}

/* Read the points at which springs or stacks are attached; they need not be nodes of the mesh. */
static int read_points(reader *reader, int node, void *to, const void *rule)
{
    scene_spring *spring = to;
    (void)rule;
    return scene_points_read(reader, node, &spring->point, &spring->points);
}

int read_face(reader *reader, int node, void *to, const void *rule)
{
    int face = 0;
    (void)rule;
    if (read_choice(reader, node, &face, place_faces) != 0)
        return -1;
    *(scene_face *)to = (scene_face)face;
    return 0;
}

/* Rows that the tables of keys of a spring and of a stack actuator have in common. */
#define SPRING_ROWS                                                                                \
    PLACE(offsetof(scene_spring, where)),                                                          \
        {"points",                                                                                 \
         read_points,                                                                              \
         0,                                                                                        \
         NULL,                                                                                     \
         0,                                                                                        \
         OF_POINT,                                                                                 \
         &scene_points_form,                                                                       \
         "Points that need not be nodes: [[theta1, theta2], ...], on a mesh from a file [[x, y, "  \
         "z], ...] or, seen along z, [[x, y], ...]; or a file of them."},                          \
        {"to",                                                                                     \
         read_point,                                                                               \
         offsetof(scene_spring, to),                                                               \
         NULL,                                                                                     \
         0,                                                                                        \
         OF_COORDINATE,                                                                            \
         &node_form,                                                                               \
         "Node at the other end; default the ground."},                                            \
        {"along",                                                                                  \
         read_any_direction,                                                                       \
         offsetof(scene_spring, along),                                                            \
         NULL,                                                                                     \
         0,                                                                                        \
         OF_NUMBER,                                                                                \
         &direction_form,                                                                          \
         "Direction that elongates: u1, u2, u3, x, y, z or a vector [x, y, z]; default, with "     \
         "'to', the line from there. It does not turn with the shell."},                           \
    {                                                                                              \
        "on", read_face, offsetof(scene_spring, face), NULL, 0, OF_NOTHING, &face_form,            \
            "Face at which it is attached; middle (default) and mean: the mean of both faces."     \
    }

/* ---- springs ------------------------------------------------------------ */

static const field spring_fields[] = {
    {"name", read_name, offsetof(scene_spring, name), .help = "Name in the results."},
    SPRING_ROWS,
    {"about", read_any_direction, offsetof(scene_spring, about), .of = OF_NUMBER,
     .form = &direction_form,
     .help = "Torsional spring: axis of the rotation that it resists, in the surface."},
    {"per", read_choice, offsetof(scene_spring, per), place_pers,
     .help = "point: each node or point has a spring of this stiffness (default); length: of an "
             "edge; area: of the elements whose nodes are all in the place."},
    {"stiffness", read_real, offsetof(scene_spring, stiffness), &not_negative, 1, .of = OF_SPRING,
     .help = "Force per elongation (per length, per area), or moment per angle in radians."},
    {.key = NULL}};

static const form_case spring_cases[] = {
    {"edge|at|set|points along stiffness ?per ?on ?name", "Springs to the ground."},
    {"edge|at|set|points to ?along stiffness ?on ?name", "Springs to another node."},
    {"edge|at|set|points about stiffness ?name", "Torsional springs to the ground."},
    {NULL, NULL}};
static const form spring_form = {.type = FORM_MAP, .fields = spring_fields, .cases = spring_cases};
const form springs_form = {.type = FORM_LIST, .item = &spring_form};

/*
 * Check which keys an item of springs or stack actuators combines. Returns 0, or -1 after writing
 * an error message about the scene file.
 */
static int check_ends(reader *reader, int node, const scene_spring *spring)
{
    const int has_place = spring->where.at.column != 0, has_other = spring->to.at.column != 0;
    /* The item is attached to nodes of the mesh (at, edge or set) or to points, not to both. */
    if (has_place == (spring->points > 0))
        return tree_fault(reader->t, node,
                          "a spring or stack needs one of at, edge, set and points; give one");
    /* A direction, the node at the other end, or the axis of a torsional spring is required. */
    if (!spring->along.given && !spring->about.given && !has_other)
        return tree_fault(reader->t, node,
                          "no direction in this item of %.60s; add along: z, along: [x, y, z], or "
                          "to: another node",
                          tree_name(reader->t, node));
    if (spring->about.given && (spring->along.given || has_other || spring->face != FACE_MIDDLE))
        return tree_fault(reader->t, node,
                          "'about' is a torsional spring to the ground; remove along, to and on");
    if (spring->per != PER_POINT && (has_other || spring->about.given || spring->points > 0))
        return tree_fault(reader->t, node,
                          "'per: %s' is for springs along a direction, from a place to the ground; "
                          "remove it",
                          place_pers[spring->per].word);
    return 0;
}

static int read_spring(reader *reader, int node, void *item)
{
    scene_spring *spring = item;
    spring->at = node_at(reader, node);
    return read_map(reader, node, spring_fields, spring) != 0 ? -1
                                                              : check_ends(reader, node, spring);
}

int read_springs(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->spring = new_items(reader, node, TREE_LIST, sizeof *scene->spring, &scene->springs);
    return read_items(reader, node, scene->spring, sizeof *scene->spring, read_spring, NULL);
}

/* ---- stack actuators ---------------------------------------------------- */

static const field stack_fields[] = {
    SPRING_ROWS,
    {"stiffness", read_real, offsetof(scene_spring, stiffness), &not_negative, .of = OF_STIFFNESS,
     .help = "Stiffness of one stack; a voice coil has none (default 0)."},
    {"stroke", read_real, offsetof(scene_spring, stroke), .of = OF_STRAIN_CONSTANT,
     .help = "Elongation per volt of a stack without a load."},
    {"force", read_real, offsetof(scene_spring, force), .of = OF_FORCE_CONSTANT,
     .help = "Force per volt, or per unit of the input, of one that cannot elongate."},
    {.key = NULL}};
static const form_case stack_cases[] = {
    {"edge|at|set|points along ?to ?on stiffness stroke", "Piezoelectric stacks."},
    {"edge|at|set|points to ?on stiffness stroke", "Stacks along the line from another node."},
    {"edge|at|set|points along ?to ?on ?stiffness force", "Stacks or voice coils, by force."},
    {"edge|at|set|points to ?on ?stiffness force", "Voice coils along the line from another node."},
    {NULL, NULL}};
const form stacks_form = {.type = FORM_MAP, .fields = stack_fields, .cases = stack_cases};

/*
 * Count the piezoelectric stacks (or voice coils) of a stack actuator: one at each attachment point
 * or node. Returns 0, or -1 after writing an error message about the scene file.
 */
static int count_stacks(reader *reader, int node, const scene_spring *stacks, int *count)
{
    *count = stacks->points;
    if (stacks->points > 0)
        return 0;
    if (!reader->s->quads) {
        *count = 1;
        return stacks->where.type == WHERE_POINT
                   ? 0
                   : tree_fault(
                         reader->t, node,
                         "on mesh lines 'at' is one node of a stack; list several as points: "
                         "[[theta1, theta2], ...]");
    }
    unsigned char *in_set = calloc(reader->s->quads->mesh.nodes, 1);
    if (!in_set)
        return tree_fault(reader->t, node, "out of memory");
    *count = (int)scene_mark_nodes(reader->s, &stacks->where, in_set);
    free(in_set);
    return *count > 0 ? 0 : tree_fault(reader->t, node, "no node of the mesh lies in this place");
}

int read_stacks(reader *reader, int node, void *to, const void *rule)
{
    scene_actuator *actuator = to;
    (void)rule;
    actuator->stacks = calloc(1, sizeof *actuator->stacks);
    scene_spring *stacks = actuator->stacks;
    if (!stacks)
        return tree_fault(reader->t, node, "out of memory");
    stacks->at = node_at(reader, node);
    if (read_map(reader, node, stack_fields, stacks) != 0 || check_ends(reader, node, stacks) != 0)
        return -1;
    const bool has_stroke = tree_find(reader->t, node, "stroke") != 0;
    if (has_stroke == (tree_find(reader->t, node, "force") != 0))
        return tree_fault(reader->t, node,
                          "a stack needs either its stroke or its force per volt; stroke times "
                          "stiffness is the force");
    if (has_stroke && stacks->stiffness <= 0)
        return tree_fault(reader->t, node,
                          "a stack with a stroke needs its stiffness above 0; a voice coil has a "
                          "force instead");
    if (has_stroke)
        stacks->force = stacks->stroke * stacks->stiffness;
    return count_stacks(reader, node, stacks, &actuator->grid[0]);
}
