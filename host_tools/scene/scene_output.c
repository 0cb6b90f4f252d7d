/* SPDX-License-Identifier: BSD-2-Clause */
/* Section `outputs` of a scene file (scene_output.h), by the table in output_types.h. */
#include "scene_output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- quantities ---- */

/*
 * Count the keys of an output that name its quantity, such as `u3` or `reaction`. Exactly one is
 * permitted. Returns 0, or -1 after writing an error message about the scene file if there is a
 * second one.
 */
static int count_quantity(reader *reader, int node, output_text *text)
{
    if (text->quantities++ == 0)
        return 0;
    return tree_fault_at(reader->t, reader->t->node[node].key_at,
                         "an output is one quantity; write a second item for '%s'",
                         reader->t->node[node].key);
}

int read_displacement(reader *reader, int node, void *to, const void *rule)
{
    output_text *text = to;
    int face = 0;
    if (count_quantity(reader, node, text) != 0 ||
        read_choice(reader, node, &face, place_faces) != 0)
        return -1;
    text->output.component = (scene_component) * (const int *)rule;
    text->output.face = (scene_face)face;
    return 0;
}

/*
 * Read the word that selects a component of the output's quantity, such as x, y or z of a reaction.
 * In the list of words, the value of a word is the type of the output. Its component is the number
 * of earlier words with the same value.
 *   rule in  list of words (choice) of the key
 */
static int read_quantity(reader *reader, int node, void *to, const void *rule)
{
    output_text *text = to;
    int type = 0;
    if (count_quantity(reader, node, text) != 0 || read_choice(reader, node, &type, rule) != 0)
        return -1;
    text->output.type = (scene_output_type)type;
    text->output.part = 0;
    for (const choice *word = rule; strcmp(word->word, node_text(reader, node)) != 0; word++)
        text->output.part += word->value == type;
    return 0;
}

static const choice strains[] = {
    {"11", OUTPUT_STRAIN}, {"22", OUTPUT_STRAIN}, {"12", OUTPUT_STRAIN}, {NULL, 0}};
static const choice stresses[] = {
    {"11", OUTPUT_STRESS}, {"22", OUTPUT_STRESS}, {"33", OUTPUT_STRESS},    {"23", OUTPUT_STRESS},
    {"13", OUTPUT_STRESS}, {"12", OUTPUT_STRESS}, {"mises", OUTPUT_STRESS}, {NULL, 0}};
static const choice reactions[] = {{"x", OUTPUT_REACTION_FORCE},
                                   {"y", OUTPUT_REACTION_FORCE},
                                   {"z", OUTPUT_REACTION_FORCE},
                                   {"moment_x", OUTPUT_REACTION_MOMENT},
                                   {"moment_y", OUTPUT_REACTION_MOMENT},
                                   {"moment_z", OUTPUT_REACTION_MOMENT},
                                   {NULL, 0}};
static const choice contact_results[] = {
    {"x", OUTPUT_CONTACT_FORCE},           {"y", OUTPUT_CONTACT_FORCE},
    {"z", OUTPUT_CONTACT_FORCE},           {"nodes", OUTPUT_CONTACT_NODES},
    {"pressure", OUTPUT_CONTACT_PRESSURE}, {NULL, 0}};
static const choice rotations[] = {{"u1", OUTPUT_ROTATION}, {"u2", OUTPUT_ROTATION},
                                   {"x", OUTPUT_ROTATION},  {"y", OUTPUT_ROTATION},
                                   {"z", OUTPUT_ROTATION},  {NULL, 0}};
static const form rotation_form = {.type = FORM_WORD, .words = rotations};
static const form strain_form = {.type = FORM_WORD, .words = strains};
static const form stress_form = {.type = FORM_WORD, .words = stresses};
static const form reaction_form = {.type = FORM_WORD, .words = reactions};
static const form contact_result_form = {.type = FORM_WORD, .words = contact_results};

static int read_contact_output(reader *reader, int node, void *to, const void *rule)
{
    if (reader->s->contact.given)
        return read_quantity(reader, node, to, rule);
    return tree_fault_at(reader->t, reader->t->node[node].key_at,
                         "no contact in this scene; add contact: {face: outer, body: ...}");
}

/* Return whether the scene has a support with a given name. */
static bool has_support(const scene *scene, const char *name)
{
    bool found = false;
    for (int k = 0; k < scene->supports; k++)
        found |= strcmp(scene->support[k].name, name) == 0;
    return found;
}

/* Read the name of the supports whose reaction is an output. */
static int read_support_of(reader *reader, int node, void *to, const void *rule)
{
    const scene *scene = reader->s;
    char *name = to;
    if (read_name(reader, node, name, rule) != 0)
        return -1;
    if (has_support(scene, name))
        return 0;
    if (scene->supports == 0)
        return tree_fault(reader->t, node, "there is no support '%s'; give a support this name",
                          name);
    return tree_fault(reader->t, node,
                      "there is no support '%s'; the first is %s; give a support this name", name,
                      scene->support[0].name);
}

/*
 * Check that the amplifiers of an actuator that an electric output names have patches. Returns 0,
 * or -1 after writing an error message about the scene file.
 */
static int check_patches(reader *reader, int node, int first, const char *name)
{
    for (int i = 0; i < reader->s->actuators; i++) {
        const scene_actuator *actuator = &reader->s->actuator[i];
        if (!scene_has_electrodes(actuator) && first >= actuator->first &&
            first < actuator->first + actuator->grid[0])
            return tree_fault(reader->t, node,
                              "'%s' has no patches; voltages and charges are those of patches",
                              name);
    }
    return 0;
}

/*
 * Read an electric output: the voltages or the charges of the electrodes of a sensor or an
 * actuator.
 *   rule in  type of the output
 */
static int read_electrodes(reader *reader, int node, void *to, const void *rule)
{
    output_text *text = to;
    scene_output *output = &text->output;
    char name[SCENE_NAME];
    if (count_quantity(reader, node, text) != 0 || read_name(reader, node, name, NULL) != 0)
        return -1;
    output->type = *(const scene_output_type *)rule;
    output->of_sensor = scene_find_sensor(reader->s, name, &output->first, &output->count);
    if (output->of_sensor)
        return 0;
    if (scene_find_amplifier(reader->s, name, &output->first, &output->count))
        return check_patches(reader, node, output->first, name);
    return tree_fault(reader->t, node, "there is no sensor or actuator '%s'; add it to sensors",
                      name);
}

/* Read the name of the layer of the shell in which an output gives a strain or stress. */
static int read_layer_of(reader *reader, int node, void *to, const void *rule)
{
    const scene *scene = reader->s;
    output_text *text = to;
    char name[SCENE_NAME];
    if (read_name(reader, node, name, rule) != 0)
        return -1;
    for (int i = 0; i < scene->layers; i++)
        if (strcmp(scene->layer[i].name, name) == 0) {
            text->output.layer = i;
            return 0;
        }
    return tree_fault(reader->t, node,
                      "there is no layer '%s'; name a layer of layers, as {name: %s, ...}", name,
                      name);
}

/*
 * Read an output that is the electric potential of a bare face (without electrode) of a layer; the
 * layer is given by its name.
 */
static int read_potential(reader *reader, int node, void *to, const void *rule)
{
    output_text *text = to;
    if (count_quantity(reader, node, text) != 0)
        return -1;
    text->output.type = OUTPUT_POTENTIAL;
    return read_layer_of(reader, node, to, rule);
}

/* Read a reference value, whose dimension is that of the quantity of the output. */
static int read_reference_value(reader *reader, int node, void *to, const void *rule)
{
    output_text *text = to;
    reader->of = scene_output_info_of(text->output.type)->of;
    return read_real(reader, node, &text->output.reference, rule);
}

/* ---- checks of complete outputs ---- */

/*
 * Function that completes and checks an output of one type after all its keys have been read.
 * Returns 0, or -1 after writing an error message about the scene file.
 */
typedef int output_finish(reader *reader, int node, output_text *text);

/* Complete an output that is measured at nodes of the mesh, such as a displacement. */
static int finish_at_place(reader *reader, int node, output_text *text)
{
    if (text->quantities == 0)
        return tree_fault(reader->t, node,
                          "no direction in this item of %.60s; add one, as u3: middle or z: outer",
                          tree_name(reader->t, node));
    return require_place(reader, node, &text->output.where);
}

/*
 * Complete an output that is a total over some nodes, or over the whole structure. Every such
 * output is valid.
 */
static int finish_total(reader *reader, int node, output_text *text)
{
    (void)reader;
    (void)node;
    (void)text;
    return 0;
}

/* Complete a reaction. It belongs either to the supports of one name or to nodes of the mesh. */
static int finish_reaction(reader *reader, int node, output_text *text)
{
    const scene_output *output = &text->output;
    if (output->support[0] && output->where.at.column == 0)
        return 0;
    if (output->support[0])
        return tree_fault_at(reader->t, output->where.at,
                             "a reaction is that of a support or that at a place; remove one");
    if (output->where.at.column == 0)
        return tree_fault(reader->t, node,
                          "a reaction needs support: name, or a place: edge, at or set");
    return 0;
}

/*
 * Complete an output of voltages or charges of electrodes, for which no place on the mesh may be
 * given.
 */
static int finish_electrodes(reader *reader, int node, output_text *text)
{
    (void)node;
    if (text->output.where.at.column == 0)
        return 0;
    return tree_fault_at(reader->t, text->output.where.at,
                         "an electrode has one voltage and one charge; remove the place");
}

/*
 * Complete an electric potential of a layer's bare face (without electrode). Where the scene file
 * does not say which face, and only one is bare, the output is that of this face.
 */
static int finish_potential(reader *reader, int node, output_text *text)
{
    scene_output *output = &text->output;
    const int bare = reader->s->layer[output->layer].bare;
    const int face = tree_find(reader->t, node, "face");
    if (!face && bare == BARE_BOTH)
        return tree_fault(reader->t, node,
                          "both faces of the layer '%s' are bare; add face: inner or outer",
                          reader->s->layer[output->layer].name);
    if (!face)
        output->height = bare == BARE_INNER ? 0 : 2;
    if (!(output->height == 0 && bare & BARE_INNER) && !(output->height == 2 && bare & BARE_OUTER))
        return tree_fault(reader->t, node,
                          "this face of the layer '%s' is not bare; add bare: inner, outer or both "
                          "to the layer",
                          reader->s->layer[output->layer].name);
    return require_place(reader, node, &output->where);
}

/*
 * Complete a strain. If the scene file does not give the angle of the axes, it is that of the
 * layer, or 0 without a layer.
 */
static int finish_strain(reader *reader, int node, output_text *text)
{
    scene_output *output = &text->output;
    if (isnan(output->angle))
        output->angle = output->layer >= 0 ? reader->s->layer[output->layer].angle : 0;
    return require_place(reader, node, &output->where);
}

/*
 * Complete a stress. If the scene file does not name a layer, the shell must have a single one,
 * which is taken.
 */
static int finish_stress(reader *reader, int node, output_text *text)
{
    const int layers = reader->s->layers;
    if (text->output.layer < 0 && layers > 1)
        return tree_fault(reader->t, node,
                          "a stress needs one of the %d layers; add layer: and its name", layers);
    if (text->output.layer < 0)
        text->output.layer = 0;
    return finish_strain(reader, node, text);
}

#define INFO_OF(type, word, keys, of, quantity, spread, reading, finish, calls)                    \
    [type] = {word, keys, of, spread, reading},
#define FINISH_OF(type, word, keys, of, quantity, spread, reading, finish, calls) [type] = finish,
static const scene_output_info infos[OUTPUT_TYPE_COUNT] = {OUTPUT_TYPES(INFO_OF)};
static output_finish *const finishes[OUTPUT_TYPE_COUNT] = {OUTPUT_TYPES(FINISH_OF)};

const scene_output_info *scene_output_info_of(scene_output_type type)
{
    return &infos[type];
}

/* Whether a list of keys, separated by blanks, contains a key. */
static bool lists_key(const char *keys, const char *key)
{
    case_item item;
    bool found = false;
    while (case_next(&keys, &item))
        found |= case_item_has(&item, key);
    return found;
}

static bool takes_key(const scene_output_info *info, const char *key)
{
    return lists_key(info->keys, key);
}

void scene_output_words(output_test *is_named, const char *key, char *text, size_t size)
{
    const char *word[OUTPUT_TYPE_COUNT];
    int words = 0;
    for (int type = 0; type < OUTPUT_TYPE_COUNT; type++) {
        const bool is_repeated = words > 0 && strcmp(word[words - 1], infos[type].word) == 0;
        if (is_named(&infos[type], key) && !is_repeated)
            word[words++] = infos[type].word;
    }
    *text = '\0';
    for (int i = 0; i < words; i++) {
        const size_t length = strlen(text);
        const char *const between = i + 1 < words ? ", " : " or ";
        snprintf(text + length, size - length, "%s%s", i > 0 ? between : "", word[i]);
    }
}

/*
 * Refuse the keys that only outputs of other types take, such as the layer of a strain in an output
 * of a displacement.
 */
static int refuse_foreign_keys(reader *reader, int node, const scene_output *output)
{
    static const char *const keys[] = {"support", "layer", "face", "angle"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        const int found = tree_find(reader->t, node, keys[i]);
        char owners[SCENE_OUTPUT_WORDS];
        if (!found || takes_key(&infos[output->type], keys[i]))
            continue;
        scene_output_words(takes_key, keys[i], owners, sizeof owners);
        return tree_fault_at(reader->t, reader->t->node[found].key_at,
                             "'%s' belongs to a %s; remove it", keys[i], owners);
    }
    return 0;
}

int finish_output(reader *reader, int node, output_text *text)
{
    text->output.at = node_at(reader, node);
    if (refuse_foreign_keys(reader, node, &text->output) != 0)
        return -1;
    return finishes[text->output.type](reader, node, text);
}

/* ---- keys ---- */

static const scene_output_type electric[] = {OUTPUT_VOLTAGE, OUTPUT_CHARGE};

static const choice heights[] = {{"inner", 0}, {"middle", 1}, {"outer", 2}, {NULL, 0}};

static const field output_fields[] = {
    {"name", read_name, offsetof(output_text, output.name), .required = 1,
     .help = "Name of the output in the results."},
    DIRECTIONS(read_displacement, OF_NOTHING, &face_form, "Displacement of a face"),
    {"rotation", read_quantity, 0, rotations, .form = &rotation_form,
     .help = "Rotation of the normal of the shell at nodes about an axis, as of an inclinometer or "
             "an autocollimator, in radians up to pi: u1 or u2 in the surface, or x, y or z."},
    {"reaction", read_quantity, 0, reactions, .form = &reaction_form,
     .help = "Force of supports on the shell along a global axis, or its moment about the mean "
             "position of their nodes: the sum over a place, or over the supports of one name; pzs "
             "solve alone."},
    {"support", read_support_of, offsetof(output_text, output.support), .form = &name_form,
     .help = "Name of the supports whose reaction it is."},
    {"contact", read_contact_output, 0, contact_results, .form = &contact_result_form,
     .help =
         "Result of the contact: resultant force on the shell along a global axis, or number of "
         "nodes in contact, of the whole shell or of the nodes of a place; or the contact "
         "pressure at a place."},
    {"voltage", read_electrodes, 0, &electric[0], .form = &name_form,
     .help = "Voltages of a sensor or actuator, or of one of its electrodes, such as s_1_2."},
    {"charge", read_electrodes, 0, &electric[1], .form = &name_form,
     .help = "Charges of a sensor or actuator, or of one of its electrodes, on the side towards "
             "+e3."},
    {"potential", read_potential, .form = &name_form,
     .help = "Electric potential of the bare face of a layer at nodes, by the name of the layer."},
    {"strain", read_quantity, 0, strains, .form = &strain_form,
     .help = "Strain at nodes, as of a strain gauge or of a fibre, in the axes of the layer's "
             "material: 11, 22 or 12 (twice the tensor's)."},
    {"stress", read_quantity, 0, stresses, .form = &stress_form,
     .help = "Stress at nodes in the axes of the layer's material, or mises; pzs solve alone."},
    {"layer", read_layer_of, .form = &name_form,
     .help = "Layer of a strain or stress; a strain without layer is one of the whole package."},
    {"face", read_choice, offsetof(output_text, output.height), heights,
     .help = "Height of a strain or stress in the layer: inner, middle (default) or outer; of a "
             "potential the bare face: inner or outer."},
    {"angle", read_real, offsetof(output_text, output.angle), .of = OF_DEGREES,
     .help = "Direction 1 of a strain or stress, from the axis 1 of the shell towards 2, in "
             "degrees; default that of the layer's material."},
    PLACE(offsetof(output_text, output.where)),
    {"reference", read_reference_value, .of = OF_OUTPUT, .form = &number_form,
     .help = "Value to print beside the result."},
    {.key = NULL}};

static const form_case output_cases[] = {
    {"u1|u2|u3|x|y|z edge|at|set", "A displacement."},
    {"rotation edge|at|set", "A rotation of the normal at nodes."},
    {"strain edge|at|set ?layer ?face ?angle", "A strain at nodes."},
    {"stress edge|at|set ?layer ?face ?angle", "A stress at nodes."},
    {"reaction edge|at|set|support", "A reaction at a place, or of supports."},
    {"contact=pressure edge|at|set", "The contact pressure at a place."},
    {"contact=x/y/z/nodes", "A result of the whole contact."},
    {"contact=x/y/z/nodes edge|at|set", "A result of the contact at a place."},
    {"voltage|charge", "Voltages or charges of electrodes."},
    {"potential edge|at|set ?face", "The potential of a bare face at nodes."},
    {NULL, NULL}};
static const form output_form = {.type = FORM_MAP, .fields = output_fields, .cases = output_cases};
const form outputs_form = {.type = FORM_LIST, .item = &output_form};

static int read_output(reader *reader, int node, void *item)
{
    scene_output *to = item;
    output_text text;
    memset(&text, 0, sizeof text);
    text.output.reference = text.output.angle = (double)NAN;
    text.output.layer = -1;
    text.output.height = 1;
    if (read_map(reader, node, output_fields, &text) != 0 ||
        finish_output(reader, node, &text) != 0)
        return -1;
    *to = text.output;
    return 0;
}

int read_outputs(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->output = new_items(reader, node, TREE_LIST, sizeof *scene->output, &scene->outputs);
    return read_items(reader, node, scene->output, sizeof *scene->output, read_output, NULL);
}
