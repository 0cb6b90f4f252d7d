/* SPDX-License-Identifier: BSD-2-Clause */
/* Sections `supports`, `loads` and `contact` of a scene file. */
#include "scene_file.h"
#include "scene_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/vector.h"

/* ---- supports ---- */

/*
 * Bit that stands for the word `rotation` in the key `fix` of a support. The bit is replaced by the
 * dof of the rotation when the axis of the rotation has been read.
 */
enum { FIX_ROTATION = 1 << 20 };

enum {
    MEAN_1 = 1,
    MEAN_2 = 2,
    MEAN_3 = 4,
    DIFFERENCE_1 = 8,
    DIFFERENCE_2 = 16,
    DIFFERENCE_3 = 32,
    SEVENTH = 64,
    GLOBAL = FIX_X | FIX_Y | FIX_Z,
    U1 = MEAN_1 | DIFFERENCE_1,
    U2 = MEAN_2 | DIFFERENCE_2,
    U3 = MEAN_3 | DIFFERENCE_3 | SEVENTH
};

static const choice fixes[] = {{"clamped", U1 | U2 | U3},
                               {"simple", FIX_SIMPLE},
                               {"symmetric", FIX_SYMMETRIC},
                               {"x", FIX_X},
                               {"y", FIX_Y},
                               {"z", FIX_Z},
                               {"free", 0},
                               {"cone", MEAN_1 | MEAN_2 | MEAN_3},
                               {"vee", MEAN_1 | MEAN_3},
                               {"flat", MEAN_3},
                               {"along", FIX_ALONG},
                               {"across", FIX_ACROSS},
                               {"rotation", FIX_ROTATION},
                               {"u1", U1},
                               {"u2", U2},
                               {"u3", U3},
                               {"u1 mean", MEAN_1},
                               {"u2 mean", MEAN_2},
                               {"u3 mean", MEAN_3},
                               {"u1 difference", DIFFERENCE_1},
                               {"u2 difference", DIFFERENCE_2},
                               {"u3 difference", DIFFERENCE_3},
                               {"u3M", SEVENTH},
                               {NULL, 0}};

/*
 * Return the dof, as bits, to which a support applies its prescribed displacement: the mean
 * displacement of both faces if the scene file names a displacement component u1, u2 or u3,
 * otherwise the single dof that the scene file names.
 */
static unsigned moved_by(int fix)
{
    switch (fix) {
    case U1: return MEAN_1;
    case U2: return MEAN_2;
    case U3: return MEAN_3;
    default: return (unsigned)fix;
    }
}

/*
 * Find the dof that a word such as `simple` or `symmetric` constrains at an edge of a surface.
 * Returns 0, or -1 after an error message about the scene.
 */
static int fix_edge(reader *reader, int node, const scene_support *support, int *fix)
{
    const int across_1 =
        support->where.edge == EDGE_THETA1_MINUS || support->where.edge == EDGE_THETA1_PLUS;
    if (*fix & GLOBAL)
        return tree_fault(reader->t, node,
                          "'%s' is a direction of a mesh from a file; on a surface name u1, u2 or "
                          "u3",
                          node_text(reader, node));
    if (support->where.type != WHERE_EDGE)
        return tree_fault(
            reader->t, node,
            "'%s' depends on an edge; give edge: theta1+ or list the displacements, as [u2, "
            "u3]",
            node_text(reader, node));
    if (*fix == FIX_SIMPLE)
        *fix = (across_1 ? U2 : U1) | U3;
    else
        *fix = across_1 ? U1 : U2;
    return 0;
}

/*
 * Return whether a word of the scene file names a single displacement component or a rotation,
 * which may have a prescribed value.
 */
static bool is_single(int fix)
{
    const unsigned of[3] = {U1, U2, U3};
    int found = 0;
    if (fix == FIX_ALONG || fix == FIX_ROTATION)
        return true;
    for (int i = 0; i < 3; i++)
        found += ((unsigned)fix & of[i]) != 0;
    return found == 1 && !((unsigned)fix & (FIX_SIMPLE | FIX_SYMMETRIC | GLOBAL | FIX_OBLIQUE));
}

static int read_fix_word(reader *reader, int node, scene_support *support)
{
    const int special = FIX_SIMPLE | FIX_SYMMETRIC | GLOBAL;
    int fix = 0;
    if (read_choice(reader, node, &fix, fixes) != 0)
        return -1;
    if (support->value && !is_single(fix))
        return tree_fault(reader->t, node,
                          "'%s' is no single displacement to give a value; name one, as fix: u3",
                          node_text(reader, node));
    if (support->value)
        support->move |= moved_by(fix);
    if (fix & special && !reader->s->quads && fix_edge(reader, node, support, &fix) != 0)
        return -1;
    support->fix |= (unsigned)fix;
    return 0;
}

static int read_fix(reader *reader, int node, void *to, const void *rule)
{
    int i;
    (void)rule;
    if (reader->t->node[node].kind != TREE_LIST)
        return read_fix_word(reader, node, to);
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_fix_word(reader, i, to) != 0)
            return -1;
    return 0;
}

static const form fix_word_form = {.type = FORM_WORD, .words = fixes};
static const form fix_words_form = {.type = FORM_LIST, .item = &fix_word_form};
static const form *const fix_forms[] = {&fix_word_form, &fix_words_form, NULL};
static const form fix_form = {.type = FORM_ANY, .any = fix_forms};

/* Return whether the three entries of a YAML list are numbers. */
static bool is_numbers(const reader *reader, int node)
{
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        const char *text = node_text(reader, i);
        char *end = NULL;
        if (!text || (strtod(text, &end), *end != '\0'))
            return false;
    }
    return true;
}

/*
 * Read a direction that varies from node to node: a list of three formulas of the position of the
 * node. Returns 0, or -1 after an error message about the scene.
 */
static int read_formulas(reader *reader, int node, scene_support *support)
{
    int axis = 0;
    if (reader->t->node[node].kind != TREE_LIST || reader->t->node[node].count != 3)
        return read_unit(reader, node, support->direction, NULL);
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_expr(reader, i, &support->formula[axis++], NULL) != 0)
            return -1;
    return 0;
}

/*
 * Read the direction of a support: the first local axis at its nodes, or the direction of an
 * oblique support. The element formulation `published` of the scene file allows no such direction.
 * Returns 0, or -1 after an error message about the scene.
 */
static int read_direction_of(reader *reader, int node, void *to, const void *rule)
{
    scene_support *support = to;
    if (reader->s->element.cartesian)
        return is_numbers(reader, node) ? read_unit(reader, node, support->direction, rule)
                                        : read_formulas(reader, node, support);
    return tree_fault_at(reader->t, reader->t->node[node].key_at,
                         "'direction' needs element: improved; remove it");
}

static const form support_direction_form = {
    .type = FORM_LIST, .item = &formula_form, .least = 3, .most = 3};

static const field support_fields[] = {
    {"name", read_name, offsetof(scene_support, name),
     .help =
         "Name of the support beside its reactions; default the name of its set or edge, or its "
         "number. Reactions of supports with one name are added."},
    {"set", read_set_pattern, offsetof(scene_support, where), .form = &name_form,
     .help = "Mesh from a file: nodes of a set of the file, be it of nodes, edges or elements. A "
             "name with *, as bolt_*, stands for one support on each set that fits."},
    PLACE_ON_SURFACE(offsetof(scene_support, where)),
    {"about", read_any_direction, offsetof(scene_support, about), .of = OF_NUMBER,
     .form = &direction_form,
     .help =
         "Axis of fix: rotation, in the surface: u1, u2, x, y, z or a vector [x, y, z], of which "
         "the projection on the surface counts."},
    {"direction", read_direction_of, .of = OF_NUMBER, .form = &support_direction_form,
     .help = "Vector [x, y, z] whose projection on the surface is e1 of the nodes, so that u1 acts "
             "along it; default what the support needs, or theta1. With along and across: the "
             "direction itself, of any length; its components may be formulas."},
    {"value", read_place_function, offsetof(scene_support, value), .of = OF_SUPPORT,
     .form = &place_function_form,
     .help = "Prescribed displacement at full load, instead of 0; needs kinematics: nonlinear. u1, "
             "u2, u3 move both faces alike; along moves the mean of the faces along the direction; "
             "rotation turns by this angle, below 90 degrees; words for several displacements have "
             "no value."},
    {"fix", read_fix, .required = 1, .form = &fix_form,
     .help =
         "clamped: all displacements; simple: along the edge and u3 (a diaphragm); symmetric: "
         "across the edge; or displacements by name, where u1 alone means mean and difference "
         "of both faces, and u3M is the dof of the middle surface. Mesh from a file: also x, y "
         "and z. Points on a ball: cone holds three mean displacements, vee those along u3 and "
         "u1 (the direction across its groove), flat that along u3. along: the mean displacement "
         "along any direction in space; across: both mean displacements normal to it. rotation: "
         "that about the axis 'about'."},
    {.key = NULL}};

static const form_case support_cases[] = {{"edge|at|set fix", NULL}, {NULL, NULL}};
static const form support_form = {
    .type = FORM_MAP, .fields = support_fields, .cases = support_cases};
const form supports_form = {.type = FORM_LIST, .item = &support_form};

/*
 * Check the keys of a support that concern directions: `along` and `across` in the key `fix` need
 * the key `direction`, and exclude other words of `fix` with directions. Only they accept formulas
 * as `direction`. Returns 0, or -1 after writing an error message about the scene file.
 */
static int check_oblique(reader *reader, int node, const scene_support *support)
{
    const bool is_oblique = support->fix & FIX_OBLIQUE;
    const bool has_direction =
        support->formula[0] || support->direction[0] * support->direction[0] +
                                       support->direction[1] * support->direction[1] +
                                       support->direction[2] * support->direction[2] >
                                   0;
    if (support->formula[0] && !is_oblique)
        return tree_fault(reader->t, node,
                          "formulas as direction need fix: along, or fix: across; write numbers");
    if (is_oblique && !has_direction)
        return tree_fault(reader->t, node,
                          "'along' and 'across' need a direction; add direction: [x, y, z]");
    if (is_oblique && support->fix & (FIX_SIMPLE | FIX_SYMMETRIC | GLOBAL))
        return tree_fault(reader->t, node,
                          "'along' and 'across' do not share a direction with another word; make "
                          "that word an item of its own");
    return 0;
}

/*
 * Replace the word `rotation` in the key `fix` of a support by bits of the dof that the support
 * holds: the difference of both faces' displacements along e1 for a rotation about e2, along e2 for
 * one about e1. Returns 0, or -1 after writing an error message about the scene file.
 */
static int find_rotation(reader *reader, int node, scene_support *support)
{
    const scene_component axis = support->about.component;
    const bool is_vector = vector_length(support->about.vector) > 0;
    const bool is_second = !is_vector && axis == COMPONENT_U2;
    const unsigned bit = is_second ? DIFFERENCE_1 : DIFFERENCE_2;
    if (!(support->fix & FIX_ROTATION) && !support->about.given)
        return 0;
    if (!(support->fix & FIX_ROTATION) || !support->about.given)
        return tree_fault(reader->t, node,
                          "'rotation' and its axis belong together; write fix: rotation and about: "
                          "y, or another axis");
    if (support->value && support->fix != FIX_ROTATION)
        return tree_fault(
            reader->t, node,
            "the value of a rotation is an angle; make 'rotation' an item of its own");
    if (support->direction[0] != 0 || support->direction[1] != 0 || support->direction[2] != 0)
        return tree_fault(reader->t, node, "'about' names the axis; remove 'direction'");
    if (!is_vector && axis == COMPONENT_U3)
        return tree_fault(reader->t, node,
                          "a shell has no rotation about its normal u3; choose an axis in the "
                          "surface");
    if (!reader->s->element.cartesian && (is_vector || axis >= COMPONENT_X))
        return tree_fault(reader->t, node,
                          "this axis needs element: improved; choose u1 or u2 with published");
    /*
     * An axis of rotation that is given in space determines the local axis e1 of the nodes: its
     * projection on the surface.
     */
    if (is_vector)
        memcpy(support->direction, support->about.vector, sizeof support->direction);
    else if (axis >= COMPONENT_X)
        support->direction[axis - COMPONENT_X] = 1;
    /*
     * A prescribed angle also prescribes the difference of the normal displacements, so that the
     * rotated director keeps its length.
     */
    support->move = support->value ? bit | DIFFERENCE_3 : 0;
    support->fix = (support->fix & ~(unsigned)FIX_ROTATION) | bit | support->move;
    /*
     * A rotation about e1 moves the outer face along -e2 relative to the inner face, hence the sign
     * -1.
     */
    support->turn = is_second ? 1 : -1;
    return 0;
}

/*
 * Give a name to a support that has none in the scene file: the name of its set or edge, or else
 * "support" with its number.
 */
static void name_support(const scene *scene, scene_support *support)
{
    static const char *const edge_name[] = {[EDGE_THETA1_MINUS] = "theta1-",
                                            [EDGE_THETA1_PLUS] = "theta1+",
                                            [EDGE_THETA2_MINUS] = "theta2-",
                                            [EDGE_THETA2_PLUS] = "theta2+"};
    const int number = (int)(support - scene->support) + 1;
    if (support->name[0])
        return;
    if (support->where.type == WHERE_SET)
        memcpy(support->name, support->where.set, sizeof support->name);
    else if (support->where.type == WHERE_EDGE)
        snprintf(support->name, sizeof support->name, "%s", edge_name[support->where.edge]);
    else
        snprintf(support->name, sizeof support->name, "support %d", number);
}

static int read_support(reader *reader, int node, void *item)
{
    scene_support *support = item;
    support->at = node_at(reader, node);
    if (read_map(reader, node, support_fields, support) != 0 ||
        check_oblique(reader, node, support) != 0 || find_rotation(reader, node, support) != 0)
        return -1;
    return require_place(reader, node, &support->where);
}

/*
 * Return the number of supports that one item of the list of supports describes. If the name of its
 * set contains *, which stands for any text, each set of the mesh file with a matching name gets a
 * support of its own; all other items describe one support.
 */
static int supports_of(const reader *reader, int node)
{
    const int set = reader->t->node[node].kind == TREE_MAP ? tree_find(reader->t, node, "set") : 0;
    const char *pattern = set ? node_text(reader, set) : NULL;
    char first[SCENE_NAME];
    if (!pattern || !reader->s->quads || !strchr(pattern, '*'))
        return 1;
    const int count = scene_fitting_set(reader->s, pattern, 0, first);
    return count > 1 ? count : 1;
}

/*
 * Read one item of the list `supports`. An item whose set is a name with * stands for several
 * supports, one for each set that fits.
 *   support [supports_of the item] out  these supports
 * Returns 0, or -1 after an error message about the scene.
 */
static int read_item(reader *reader, int node, scene_support *support)
{
    const int count = supports_of(reader, node);
    for (int k = 0; k < count; k++) {
        if (read_support(reader, node, &support[k]) != 0)
            return -1;
        if (strchr(support[k].where.set, '*'))
            (void)scene_fitting_set(reader->s, support[k].where.set, k, support[k].where.set);
        name_support(reader->s, &support[k]);
    }
    return 0;
}

int read_supports(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int items = 0, count = 0, first = 0;
    (void)rule;
    scene->support = new_items(reader, node, TREE_LIST, sizeof *scene->support, &items);
    if (!scene->support)
        return -1;
    free(scene->support);
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        count += supports_of(reader, i);
    scene->support = calloc((size_t)count + 1, sizeof *scene->support);
    if (!scene->support)
        return tree_fault(reader->t, node, "out of memory");
    scene->supports = count;
    for (int i = reader->t->node[node].first; i; i = reader->t->node[i].next) {
        if (read_item(reader, i, &scene->support[first]) != 0)
            return -1;
        first += supports_of(reader, i);
    }
    return 0;
}

/* ---- loads ---- */

typedef struct load_text {
    scene_load *load;
    int types, directions;
    bool area_given, is_pressure;
} load_text;

/*
 * Key of the scene that names the type of a load, and the function that reads the value of this
 * key.
 */
typedef struct load_key {
    scene_load_type type;
    int (*read)(reader *reader, int node, scene_load *load);
} load_key;

static int read_constant(reader *reader, int node, void *to, const void *rule)
{
    expr **expression = to;
    if (read_expr(reader, node, to, rule) != 0)
        return -1;
    if (expr_is_constant(*expression))
        return 0;
    return tree_fault(reader->t, node,
                      "'%.60s: %.60s' varies over the surface; a constant is wanted here",
                      tree_name(reader->t, node), node_text(reader, node));
}

/* Read the direction in which gravity acts on the shell: a global axis or a vector. */
static int read_weight_axis(reader *reader, int node, void *to, const void *rule)
{
    scene_load *load = to;
    int axis = 0;
    load->component = COMPONENT_X;
    if (reader->t->node[node].kind == TREE_LIST)
        return read_unit(reader, node, load->vector, rule);
    if (read_choice(reader, node, &axis, place_axes) != 0)
        return -1;
    load->component = (scene_component)axis;
    return 0;
}

static const form weight_axis_word_form = {.type = FORM_WORD, .words = place_axes};
static const form *const weight_axis_forms[] = {&weight_axis_word_form, &triple_form, NULL};
static const form weight_axis_form = {.type = FORM_ANY, .any = weight_axis_forms};
static const field weight_fields[] = {
    {"axis", read_weight_axis, .required = 1, .of = OF_NUMBER, .form = &weight_axis_form,
     .help = "Global axis, or a vector [x, y, z]."},
    {"gravity", read_constant, offsetof(scene_load, value), .required = 1, .of = OF_ACCELERATION,
     .form = &number_form, .help = "Acceleration along the axis."},
    {.key = NULL}};
static const form weight_form = {.type = FORM_MAP, .fields = weight_fields};

static const field temperature_fields[] = {
    {"inner", read_constant, offsetof(scene_load, value), .required = 1, .of = OF_TEMPERATURE,
     .form = &number_form, .help = "Temperature of the inner face."},
    {"outer", read_constant, offsetof(scene_load, outer), .required = 1, .of = OF_TEMPERATURE,
     .form = &number_form, .help = "Temperature of the outer face."},
    {.key = NULL}};
static const form temperatures_form = {.type = FORM_MAP, .fields = temperature_fields};
static const form *const temperature_forms[] = {&number_form, &temperatures_form, NULL};
static const form temperature_form = {.type = FORM_ANY, .any = temperature_forms};

/*
 * Read the temperature change of a temperature load: one value for the whole shell, or one value
 * for each face.
 */
static int read_temperature(reader *reader, int node, scene_load *load)
{
    return reader->t->node[node].kind == TREE_MAP ? read_map(reader, node, temperature_fields, load)
                                                  : read_constant(reader, node, &load->value, NULL);
}

/*
 * Refuse a set of the mesh file that contains no edges if a load acts on edges, or no elements if a
 * load acts on elements.
 */
static int require_set(reader *reader, int node, const scene_where *where, bool of_elements)
{
    const quad_mesh *mesh = &reader->s->quads->mesh;
    const quad_set *set = of_elements
                              ? quad_set_find(mesh->element_set, mesh->element_sets, where->set)
                              : quad_set_find(mesh->edge_set, mesh->edge_sets, where->set);
    if (set && set->count > 0)
        return 0;
    return tree_fault(reader->t, node, "set '%s' of the mesh has no %s, which this load needs",
                      where->set, of_elements ? "elements" : "edges");
}

static int read_load_point(reader *reader, int node, scene_load *load)
{
    const scene_where *where = &load->where;
    size_t count = 1;
    if (read_point(reader, node, &load->where, NULL) != 0)
        return -1;
    if (where->type == WHERE_SET) {
        unsigned char *in_set = calloc(reader->s->quads->mesh.nodes, 1);
        if (!in_set)
            return tree_fault(reader->t, node, "out of memory");
        count = scene_mark_nodes(reader->s, where, in_set);
        free(in_set);
    }
    if (count == 1)
        return 0;
    return tree_fault(reader->t, node,
                      "set '%s' has %zu nodes; a point load acts on one: name its place, or let "
                      "line or face name the set",
                      where->set, count);
}

static int read_load_line(reader *reader, int node, scene_load *load)
{
    if (read_edge(reader, node, &load->where, NULL) != 0)
        return -1;
    return reader->s->quads ? require_set(reader, node, &load->where, false) : 0;
}

static int read_load_face(reader *reader, int node, scene_load *load)
{
    int face = 0;
    if (read_choice(reader, node, &face, place_faces) != 0)
        return -1;
    load->face = (scene_face)face;
    return 0;
}

static int read_weight(reader *reader, int node, scene_load *load)
{
    return read_map(reader, node, weight_fields, load);
}

static const load_key point_key = {LOAD_POINT, read_load_point};
static const load_key line_key = {LOAD_LINE, read_load_line};
static const load_key face_key = {LOAD_FACE, read_load_face};
static const load_key weight_key = {LOAD_WEIGHT, read_weight};
static const load_key temperature_key = {LOAD_TEMPERATURE, read_temperature};

static int read_load_type(reader *reader, int node, void *to, const void *rule)
{
    load_text *text = to;
    const load_key *key = rule;
    if (text->types++)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "a load is one of point, line, face, weight, temperature; "
                             "write a second item");
    text->load->type = key->type;
    return key->read(reader, node, text->load);
}

static int read_direction(reader *reader, int node, void *to, const void *rule)
{
    load_text *text = to;
    if (text->load->value && !text->directions)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "weight and temperature say all; remove '%s'",
                             reader->t->node[node].key);
    if (text->directions++)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "a load has one direction; write a second item for '%s'",
                             reader->t->node[node].key);
    text->load->component = (scene_component) * (const int *)rule;
    return read_place_function(reader, node, &text->load->value, NULL);
}

/*
 * Read the axis of a moment from the key `about`. A point load with this key is a moment; without
 * the key it is a force.
 */
static int read_about(reader *reader, int node, void *to, const void *rule)
{
    load_text *text = to;
    if (text->load->type != LOAD_POINT || text->directions)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "'about' is the axis of a moment at a point, without a force; write a "
                             "second item");
    text->load->type = LOAD_MOMENT;
    return read_any_direction(reader, node, &text->load->about, rule);
}

static int read_moment(reader *reader, int node, void *to, const void *rule)
{
    load_text *text = to;
    if (text->load->type != LOAD_MOMENT)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "'moment' needs a point and its axis; add about: x");
    text->directions++;
    return read_place_function(reader, node, &text->load->value, rule);
}

static int read_pressure(reader *reader, int node, void *to, const void *rule)
{
    load_text *text = to;
    (void)rule;
    if (text->load->type != LOAD_FACE)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "'pressure' acts on a face; add face: outer, inner or middle");
    text->is_pressure = true;
    return read_direction(reader, node, to, &place_components[COMPONENT_U3]);
}

static const choice areas[] = {{"reference", 0}, {"true", 1}, {NULL, 0}};
static const form area_form = {.type = FORM_WORD, .words = areas};

static int read_area(reader *reader, int node, void *to, const void *rule)
{
    load_text *text = to;
    (void)rule;
    if (text->load->type != LOAD_FACE)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "'area' belongs to a load on a face; remove it");
    text->area_given = true;
    return read_either(reader, node, &text->load->true_area, areas);
}

static const choice followers[] = {{"normal", FOLLOWER_NORMAL},
                                   {"pressure", FOLLOWER_PRESSURE},
                                   {"none", FOLLOWER_NONE},
                                   {NULL, 0}};
static const form follower_form = {.type = FORM_WORD, .words = followers};

static int read_follower(reader *reader, int node, void *to, const void *rule)
{
    load_text *text = to;
    scene_load *load = text->load;
    int kind = 0;
    (void)rule;
    if (!text->is_pressure)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "'follower' belongs to a pressure on a face; write pressure: "
                             "value instead of a direction, or remove it");
    if (read_choice(reader, node, &kind, followers) != 0)
        return -1;
    if (kind == FOLLOWER_NONE)
        return 0;
    if (kind == FOLLOWER_PRESSURE && load->face != FACE_INNER && load->face != FACE_OUTER)
        return tree_fault(
            reader->t, node,
            "'follower: pressure' acts on one face; write face: inner or face: outer");
    if (text->area_given && load->true_area != (kind == FOLLOWER_PRESSURE))
        return tree_fault(reader->t, node, "'follower: %s' is per %s area; remove 'area'",
                          followers[kind - 1].word,
                          kind == FOLLOWER_PRESSURE ? "deformed" : "reference");
    load->follower = (scene_follower)kind;
    load->true_area = kind == FOLLOWER_PRESSURE;
    return 0;
}

/*
 * Read the face of the shell on which a load acts. If the scene file names no face, half of a point
 * load or line load acts on each face.
 */
static int read_on(reader *reader, int node, void *to, const void *rule)
{
    load_text *text = to;
    int face = 0;
    (void)rule;
    if (text->load->type != LOAD_POINT && text->load->type != LOAD_LINE)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "'on' belongs to a point or line load; remove it");
    if (read_choice(reader, node, &face, place_faces) != 0)
        return -1;
    text->load->face = (scene_face)face;
    return 0;
}

/* Read the name of the element set to which a load on a face is limited. */
static int read_load_set(reader *reader, int node, void *to, const void *rule)
{
    load_text *text = to;
    if (text->load->type != LOAD_FACE)
        return tree_fault_at(reader->t, reader->t->node[node].key_at,
                             "'set' limits a load on a face; a point or a line names its own set");
    if (text->load->follower != FOLLOWER_NONE)
        return tree_fault(reader->t, node,
                          "a follower pressure acts on the whole face; remove 'set'");
    if (read_set(reader, node, &text->load->where, rule) != 0)
        return -1;
    return require_set(reader, node, &text->load->where, true);
}

static const field load_fields[] = {
    {"point", read_load_type, 0, &point_key, .of = OF_COORDINATE, .form = &node_form,
     .help = "Node on which a force acts; on a mesh from a file the node nearest to {x, y, z}."},
    {"line", read_load_type, 0, &line_key, .form = &edge_form,
     .help = "Edge, or edge set of a mesh file, on which a force per length acts."},
    {"face", read_load_type, 0, &face_key, .form = &face_form,
     .help = "Face on which a force per area acts; middle and mean: half on each face."},
    {"weight", read_load_type, 0, &weight_key, .of = OF_ACCELERATION, .form = &weight_form,
     .help = "Weight: the force per volume is density * gravity along a global axis."},
    {"temperature", read_load_type, 0, &temperature_key, .of = OF_TEMPERATURE,
     .form = &temperature_form,
     .help = "Temperature above that of the stress-free shape: one number, or {inner, outer}, "
             "linear between the faces."},
    DIRECTIONS(read_direction, OF_LOAD, &place_function_form, "Force (per length, per area)"),
    {"about", read_about, .of = OF_NUMBER, .form = &direction_form,
     .help = "Axis of a moment at a point, in the surface: u1, u2, x, y, z or [x, y, z]."},
    {"moment", read_moment, .of = OF_MOMENT, .form = &place_function_form,
     .help = "Moment about the axis: two opposite forces on the faces, which keep their "
             "directions."},
    {"pressure", read_pressure, .of = OF_LOAD, .form = &place_function_form,
     .help = "Force per area along +e3, on a face."},
    {"area", read_area, .form = &area_form,
     .help = "Area on which a face load counts: of the reference surface (default), or true: of "
             "the loaded face itself."},
    {"follower", read_follower, .form = &follower_form,
     .help = "Pressure that turns with the shell. none: it keeps its direction (default); normal: "
             "constant per reference area, along the unit normal of the outer face; pressure: per "
             "deformed area of the loaded face, inner or outer."},
    {"on", read_on, .form = &face_form,
     .help = "Face on which a point or line load acts; middle (default) and mean: half on each "
             "face."},
    {"set", read_load_set, .form = &name_form,
     .help = "Element set of a mesh file on which a face load acts; default all elements."},
    {.key = NULL}};

static const form_case load_cases[] = {
    {"point u1|u2|u3|x|y|z ?on", "A force at a node."},
    {"point about moment", "A moment at a node."},
    {"line u1|u2|u3|x|y|z ?on", "A force per length of an edge."},
    {"face u1|u2|u3|x|y|z ?area ?set", "A force per area of a face."},
    {"face pressure ?area ?follower ?set", "A pressure on a face."},
    {"weight", "Weight by the densities of the materials."},
    {"temperature", "A change of temperature, by the thermal expansion of the materials."},
    {NULL, NULL}};
static const form load_form = {.type = FORM_MAP, .fields = load_fields, .cases = load_cases};
const form loads_form = {.type = FORM_LIST, .item = &load_form};

static int read_load(reader *reader, int node, void *item)
{
    scene_load *load = item;
    load_text text = {0};
    text.load = load;
    load->at = node_at(reader, node);
    if (read_map(reader, node, load_fields, &text) != 0)
        return -1;
    if (text.types == 0)
        return tree_fault(
            reader->t, node,
            "a load needs one of point: {theta1, theta2}, line: edge, face: outer, weight: "
            "{axis, gravity}, temperature: value");
    if (!load->value)
        return tree_fault(
            reader->t, node,
            "a load needs a direction and value, as u3: -1 or z: -1 (or pressure: 1 on a face)");
    return 0;
}

int read_loads(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->load = new_items(reader, node, TREE_LIST, sizeof *scene->load, &scene->loads);
    return read_items(reader, node, scene->load, sizeof *scene->load, read_load, NULL);
}

/* ---- contact ---- */

static const choice body_types[] = {{"plane", BODY_PLANE},
                                    {"cylinder", BODY_CYLINDER},
                                    {"sphere", BODY_SPHERE},
                                    {"psi", BODY_PSI},
                                    {NULL, 0}};

static int read_psi(reader *reader, int node, void *to, const void *rule)
{
    expr **expression = to;
    if (read_expr(reader, node, to, rule) != 0)
        return -1;
    if (expr_is_constant(*expression))
        return tree_fault(
            reader->t, node,
            "'value: %.60s' is the same everywhere; give a function of x, y, z that is above 0 "
            "outside the body",
            node_text(reader, node));
    if (!expr_uses_theta(*expression))
        return 0;
    return tree_fault(reader->t, node,
                      "'value: %.60s' uses theta1 or theta2; a body in space knows x, y, z only",
                      node_text(reader, node));
}

typedef struct body_text {
    int type;
    scene_body body;
} body_text;

static const field body_fields[] = {
    {"type", read_choice, offsetof(body_text, type), body_types, 1, .help = "Type of the body."},
    {"point", read_vector, offsetof(body_text, body.point), .of = OF_LENGTH, .form = &triple_form,
     .help = "Point [x, y, z] on a plane, on the axis of a cylinder, or the centre of a sphere."},
    {"normal", read_unit, offsetof(body_text, body.normal), .of = OF_NUMBER, .form = &triple_form,
     .help = "Direction [x, y, z] out of the body, towards the shell; of any length."},
    {"axis", read_unit, offsetof(body_text, body.axis), .of = OF_NUMBER, .form = &triple_form,
     .help = "Direction [x, y, z] of the axis; of any length."},
    {"radius", read_real, offsetof(body_text, body.radius), &above_zero, .of = OF_LENGTH,
     .help = "Radius of a cylinder or sphere."},
    {"value", read_psi, offsetof(body_text, body.value), .of = OF_NUMBER, .form = &formula_form,
     .help = "Function of x, y, z that is above 0 outside the body."},
    {.key = NULL}};

static const form_case body_cases[] = {
    {"type=plane point normal", "All that lies behind a plane."},
    {"type=cylinder point axis radius", "An endless circular cylinder."},
    {"type=sphere point radius", "A ball."},
    {"type=psi value", "Any convex body."},
    {NULL, NULL}};
static const form body_form = {.type = FORM_MAP, .fields = body_fields, .cases = body_cases};

static int read_body(reader *reader, int node, void *to, const void *rule)
{
    scene_contact *contact = to;
    body_text text;
    int status;
    (void)rule;
    memset(&text, 0, sizeof text);
    status = read_map(reader, node, body_fields, &text);
    contact->body = text.body;
    contact->body.type = (scene_body_type)text.type;
    if (status != 0)
        return -1;
    return check_type_case(reader, node, body_cases, body_types[text.type].word);
}

static const range stiff = {0, HUGE_VAL, 1, "must be above 0; 10 serves, 100 for cord and rubber"};
static const choice touching[] = {{"outer", FACE_OUTER}, {"inner", FACE_INNER}, {NULL, 0}};

typedef struct contact_text {
    int face;
    scene_contact contact;
} contact_text;

static const field contact_fields[] = {
    {"face", read_choice, offsetof(contact_text, face), touching, 1,
     .help = "Face of the shell that touches the body."},
    {"body", read_body, offsetof(contact_text, contact), .required = 1, .of = OF_LENGTH,
     .form = &body_form, .help = "Rigid body before it moves."},
    {"move", read_vector, offsetof(contact_text, contact.move), .of = OF_LENGTH,
     .form = &triple_form, .help = "Displacement [x, y, z] of the body at full load; default 0."},
    {"stiffness", read_real, offsetof(contact_text, contact.stiffness), &stiff, .of = OF_NUMBER,
     .help = "Penalty factor of the contact relative to the stiffness of the structure; the result "
             "does not depend on it; default 10, 100 for cord and rubber."},
    {.key = NULL}};

const form contact_form = {.type = FORM_MAP, .fields = contact_fields};

int read_contact(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    contact_text text;
    int status;
    (void)rule;
    memset(&text, 0, sizeof text);
    text.contact.stiffness = 10;
    status = read_map(reader, node, contact_fields, &text);
    scene->contact = text.contact;
    scene->contact.face = (scene_face)text.face;
    scene->contact.at = node_at(reader, node);
    scene->contact.given = status == 0;
    return status;
}
