/* SPDX-License-Identifier: BSD-2-Clause */
/* Sections `element`, `materials`, `layers` and `patches` of a scene. */
#include "scene_parts.h"

#include <math.h>
#include <string.h>

/* ---- element ---- */

const scene_element element_improved = {1, 1, 0.09, 1, 1, 1, 1, 7};
static const scene_element element_published = {0, 0, 0, 0, 0, 0, 0, 7};

static int read_preset(reader *reader, int node, void *to, const void *rule)
{
    static const choice presets[] = {{"improved", 0}, {"published", 1}, {NULL, 0}};
    int is_published = 0;
    (void)rule;
    if (read_choice(reader, node, &is_published, presets) != 0)
        return -1;
    *(scene_element *)to = is_published ? element_published : element_improved;
    return 0;
}

int read_element(reader *reader, int node, void *to, const void *rule)
{
    static const choice kinematics[] = {{"local", 0}, {"cartesian", 1}, {NULL, 0}};
    static const choice area[] = {{"centre", 0}, {"exact", 1}, {NULL, 0}};
    static const field fields[] = {
        {"preset", read_preset, 0, NULL, 0}, /* first row, because the others modify the preset */
        {"kinematics", read_choice, offsetof(scene_element, cartesian), kinematics, 0},
        {"tau", read_real, offsetof(scene_element, tau), &not_negative, 0},
        {"rho", read_real, offsetof(scene_element, rho), &not_negative, 0},
        {"hr", read_flag, offsetof(scene_element, hr), NULL, 0},
        {"lin33", read_flag, offsetof(scene_element, lin33), NULL, 0},
        {"metric", read_flag, offsetof(scene_element, metric), NULL, 0},
        {"area", read_choice, offsetof(scene_element, exact_area), area, 0},
        {NULL, NULL, 0, NULL, 0}};
    scene_element *element = &((scene *)to)->element;
    *element = element_improved;
    return reader->t->node[node].kind == TREE_MAP ? read_map(reader, node, fields, element)
                                                  : read_preset(reader, node, element, rule);
}

/* ---- materials ---- */

static int read_poling(reader *reader, int node, void *to, const void *rule)
{
    static const choice polings[] = {{"3", 3}, {"+3", 3}, {"-3", -3}, {NULL, 0}};
    const char *text = node_text(reader, node);
    (void)rule;
    if (text && strcmp(text, "-3") == 0) { /* choices have no negative values */
        *(int *)to = -3;
        return 0;
    }
    return read_choice(reader, node, to, polings);
}

static int read_alpha(reader *reader, int node, void *to, const void *rule)
{
    double *alpha = to;
    int i, k = 0;
    (void)rule;
    if (reader->t->node[node].kind != TREE_LIST) {
        if (read_real(reader, node, alpha, NULL) != 0)
            return -1;
        alpha[1] = alpha[2] = alpha[0];
        return 0;
    }
    if (reader->t->node[node].count != 3)
        return tree_fault(reader->t, node, "'alpha' has %d values; give one, or three for 1, 2, 3",
                          reader->t->node[node].count);
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_real(reader, i, &alpha[k++], NULL) != 0)
            return -1;
    return 0;
}

/*
 * Elastic constants as given by the user. E and nu define an isotropic material; otherwise,
 * engineering constants that are not given follow from transverse isotropy in the plane 23.
 * Alternatively, the stiffness c11 c22 c33 c12 c13 c23 c44 c55 c66 is given, and missing entries
 * follow from transverse isotropy in the plane 12, as for a ceramic poled along 3.
 */
typedef struct material_text {
    scene_material m;
    double e, nu, c[9];
} material_text;
enum { C11, C22, C33, C12, C13, C23, C44, C55, C66 };

static const char *const isotropic_keys[] = {"E", "nu", NULL};
static const char *const orthotropic_keys[] = {"E1",  "E2",   "E3",   "G12",  "G13",
                                               "G23", "nu12", "nu13", "nu23", NULL};
static const char *const d_keys[] = {"d31", "d32", "d33", "d24", "d15", NULL};
static const char *const e_keys[] = {"e31", "e32", "e33", "e24", "e15", NULL};

static const char *first_given(const reader *reader, int node, const char *const *keys)
{
    for (; *keys; keys++)
        if (tree_find(reader->t, node, *keys))
            return *keys;
    return NULL;
}

static int require(reader *reader, int node, const char *const *keys)
{
    for (; *keys; keys++)
        if (!tree_find(reader->t, node, *keys))
            return tree_fault(reader->t, node, "'%s' is missing in %.60s; add it", *keys,
                              tree_name(reader->t, node));
    return 0;
}

static void set_default(double *v, double value)
{
    if (isnan(*v))
        *v = value;
}

static int elastic_isotropic(reader *reader, int node, material_text *text)
{
    scene_material *material = &text->m;
    if (require(reader, node, isotropic_keys) != 0)
        return -1;
    if (text->nu >= 0.5 || text->nu <= -1)
        return tree_fault(reader->t, tree_find(reader->t, node, "nu"),
                          "'nu: %g' of %.60s leaves no positive definite stiffness; "
                          "use -1 < nu < 0.5, 0.4999 with element: improved for rubber",
                          text->nu, tree_name(reader->t, node));
    material->e[0] = material->e[1] = material->e[2] = text->e;
    material->nu12 = material->nu13 = material->nu23 = text->nu;
    material->g12 = material->g13 = material->g23 = text->e / (2 * (1 + text->nu));
    return 0;
}

/*
 * Return whether a material is stable: all pivots of the compliance scaled to unit diagonal are
 * positive.
 */
static int is_stable(const scene_material *material)
{
    const double a = -material->nu12 * sqrt(material->e[1] / material->e[0]),
                 b = -material->nu13 * sqrt(material->e[2] / material->e[0]),
                 c = -material->nu23 * sqrt(material->e[2] / material->e[1]);
    const double second = 1 - a * a, third = 1 - b * b - (c - a * b) * (c - a * b) / second;
    return second > 1e-9 && third > 1e-9;
}

static int elastic_orthotropic(reader *reader, int node, material_text *text)
{
    static const char *const needed[] = {"E1", "E2", "G12", "nu12", NULL};
    scene_material *material = &text->m;
    if (require(reader, node, needed) != 0)
        return -1;
    set_default(&material->e[2], material->e[1]);
    set_default(&material->g13, material->g12);
    set_default(&material->nu13, material->nu12);
    set_default(&material->nu23, material->nu12);
    if (isnan(material->g23) && material->nu23 <= -1)
        return tree_fault(reader->t, node,
                          "'nu23: %g' of %.60s is not above -1; give G23 or another nu23",
                          material->nu23, tree_name(reader->t, node));
    set_default(&material->g23, material->e[1] / (2 * (1 + material->nu23)));
    if (is_stable(material))
        return 0;
    return tree_fault(
        reader->t, node,
        "nu12 = %g, nu13 = %g, nu23 = %g of %.60s leave no positive definite stiffness; nu12 "
        "is -e2/e1 under a pull along 1: swap or lower them",
        material->nu12, material->nu13, material->nu23, tree_name(reader->t, node));
}

static int read_stiffness(reader *reader, int node, void *to, const void *rule)
{
#define STIFFNESS(key, i, rule, required)                                                          \
    {                                                                                              \
        key, read_real, sizeof(double) * (i), rule, required                                       \
    }
    static const field fields[] = {
        STIFFNESS("c11", C11, &above_zero, 1), STIFFNESS("c12", C12, NULL, 1),
        STIFFNESS("c13", C13, NULL, 1),        STIFFNESS("c33", C33, &above_zero, 1),
        STIFFNESS("c44", C44, &above_zero, 1), STIFFNESS("c22", C22, &above_zero, 0),
        STIFFNESS("c23", C23, NULL, 0),        STIFFNESS("c55", C55, &above_zero, 0),
        STIFFNESS("c66", C66, &above_zero, 0), {NULL, NULL, 0, NULL, 0}};
#undef STIFFNESS
    double *c = to;
    int i;
    (void)rule;
    for (i = 0; i < 9; i++)
        c[i] = (double)NAN;
    if (read_map(reader, node, fields, c) != 0)
        return -1;
    set_default(&c[C22], c[C11]);
    set_default(&c[C23], c[C13]);
    set_default(&c[C55], c[C44]);
    set_default(&c[C66], (c[C11] - c[C12]) / 2);
    return 0;
}

/* Compute the engineering constants from the inverse of a stiffness matrix. */
static int elastic_stiffness(reader *reader, int node, material_text *text)
{
    const double *c = text->c;
    scene_material *material = &text->m;
    const double minor = c[C11] * c[C22] - c[C12] * c[C12], s33 = minor;
    const double s11 = c[C22] * c[C33] - c[C23] * c[C23], s22 = c[C11] * c[C33] - c[C13] * c[C13];
    const double s12 = c[C13] * c[C23] - c[C12] * c[C33], s13 = c[C12] * c[C23] - c[C13] * c[C22];
    const double s23 = c[C12] * c[C13] - c[C23] * c[C11];
    const double all = c[C11] * s11 + c[C12] * s12 + c[C13] * s13;
    if (!(minor > 0 && all > 0 && s11 > 0 && s22 > 0 && c[C66] > 0))
        return tree_fault(reader->t, node,
                          "the stiffness of %.60s is not positive definite; lower c12, c13 or c23",
                          tree_name(reader->t, node));
    material->e[0] = all / s11;
    material->e[1] = all / s22;
    material->e[2] = all / s33;
    material->nu12 = -s12 / s11;
    material->nu13 = -s13 / s11;
    material->nu23 = -s23 / s22;
    material->g23 = c[C44];
    material->g13 = c[C55];
    material->g12 = c[C66];
    return 0;
}

static int check_material(reader *reader, int node, material_text *text)
{
    static const char *const stiffness_key[] = {"stiffness", NULL};
    const char *e = first_given(reader, node, isotropic_keys),
               *e1 = first_given(reader, node, orthotropic_keys);
    const char *c = first_given(reader, node, stiffness_key);
    const char *d = first_given(reader, node, d_keys), *piezo_e = first_given(reader, node, e_keys);
    if (e && e1)
        return tree_fault(reader->t, node,
                          "%.60s has '%s' and '%s'; give E, nu or E1, E2, G12, nu12 ...",
                          tree_name(reader->t, node), e, e1);
    if (c && (e || e1))
        return tree_fault(reader->t, node, "%.60s has 'stiffness' and '%s'; give one or the other",
                          tree_name(reader->t, node), e ? e : e1);
    if (d && piezo_e)
        return tree_fault(reader->t, node,
                          "%.60s has '%s' and '%s'; give strain constants d or stress constants e",
                          tree_name(reader->t, node), d, piezo_e);
    text->m.has_d = d != NULL;
    text->m.has_e = piezo_e != NULL;
    return c    ? elastic_stiffness(reader, node, text)
           : e1 ? elastic_orthotropic(reader, node, text)
                : elastic_isotropic(reader, node, text);
}

static int read_material(reader *reader, int node, scene_material *to)
{
#define ELASTIC(key, member)                                                                       \
    {                                                                                              \
        key, read_real, offsetof(material_text, member), &above_zero, 0                            \
    }
#define NUMBER(key, member)                                                                        \
    {                                                                                              \
        key, read_real, offsetof(material_text, member), NULL, 0                                   \
    }
    static const field fields[] = {
        ELASTIC("E", e),
        NUMBER("nu", nu),
        {"stiffness", read_stiffness, offsetof(material_text, c), NULL, 0},
        ELASTIC("E1", m.e[0]),
        ELASTIC("E2", m.e[1]),
        ELASTIC("E3", m.e[2]),
        ELASTIC("G12", m.g12),
        ELASTIC("G13", m.g13),
        ELASTIC("G23", m.g23),
        NUMBER("nu12", m.nu12),
        NUMBER("nu13", m.nu13),
        NUMBER("nu23", m.nu23),
        NUMBER("d31", m.d31),
        NUMBER("d32", m.d32),
        NUMBER("d33", m.d33),
        NUMBER("d24", m.d24),
        NUMBER("d15", m.d15),
        NUMBER("e31", m.piezo_e[0]),
        NUMBER("e32", m.piezo_e[1]),
        NUMBER("e33", m.piezo_e[2]),
        NUMBER("e24", m.piezo_e[3]),
        NUMBER("e15", m.piezo_e[4]),
        {"permittivity", read_real, offsetof(material_text, m.permittivity), &not_negative, 0},
        NUMBER("pyroelectric", m.pyroelectric),
        {"poling", read_poling, offsetof(material_text, m.poling), NULL, 0},
        {"alpha", read_alpha, offsetof(material_text, m.alpha), NULL, 0},
        {"density", read_real, offsetof(material_text, m.density), &not_negative, 0},
        {"field_limit", read_real, offsetof(material_text, m.field_limit), &not_negative, 0},
        {NULL, NULL, 0, NULL, 0}};
#undef ELASTIC
#undef NUMBER
    material_text text;
    scene_material *material = &text.m;
    memset(&text, 0, sizeof text);
    material->e[2] = material->g13 = material->g23 = material->nu13 = material->nu23 = (double)NAN;
    material->poling = 3;
    if (check_name(reader, reader->t->node[node].key, reader->t->node[node].key_at,
                   material->name) != 0)
        return -1;
    material->at = reader->t->node[node].key_at;
    if (read_map(reader, node, fields, &text) != 0 || check_material(reader, node, &text) != 0)
        return -1;
    *to = text.m;
    return 0;
}

int read_materials(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int i, k = 0;
    (void)rule;
    scene->material = new_items(reader, node, TREE_MAP, sizeof *scene->material, &scene->materials);
    if (!scene->material)
        return -1;
    if (scene->materials == 0)
        return tree_fault(reader->t, node,
                          "no materials; add one, as {steel: {E: 210e9, nu: 0.3}}");
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_material(reader, i, &scene->material[k++]) != 0)
            return -1;
    return 0;
}

/* ---- layers ---- */

static int read_material_of(reader *reader, int node, void *to, const void *rule)
{
    const scene *scene = reader->s;
    char name[SCENE_NAME];
    int i;
    if (read_name(reader, node, name, rule) != 0)
        return -1;
    i = find_named(scene->material, scene->materials, sizeof *scene->material, name);
    if (i < 0)
        return tree_fault(reader->t, node,
                          "there is no material '%s'; add it to materials, or use '%s'", name,
                          scene->material[0].name);
    *(int *)to = i;
    return 0;
}

static int read_layer(reader *reader, int node, scene_layer *layer)
{
    static const range turn = {-360, 360, 0, "must lie between -360 and 360 degrees"};
    static const field fields[] = {
        {"name", read_name, offsetof(scene_layer, name), NULL, 0},
        {"material", read_material_of, offsetof(scene_layer, material), NULL, 1},
        {"thickness", read_real, offsetof(scene_layer, thickness), &above_zero, 1},
        {"angle", read_real, offsetof(scene_layer, angle), &turn, 0},
        {"patched", read_flag, offsetof(scene_layer, patched), NULL, 0},
        {"poling", read_poling, offsetof(scene_layer, poling), NULL, 0},
        {NULL, NULL, 0, NULL, 0}};
    layer->at = node_at(reader, node);
    if (read_map(reader, node, fields, layer) != 0)
        return -1;
    if (layer->poling == 0)
        layer->poling = reader->s->material[layer->material].poling;
    return 0;
}

int read_layers(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int i, k = 0;
    (void)rule;
    scene->at_layers = node_at(reader, node);
    scene->layer = new_items(reader, node, TREE_LIST, sizeof *scene->layer, &scene->layers);
    if (!scene->layer)
        return -1;
    if (scene->layers == 0)
        return tree_fault(reader->t, node,
                          "no layers; add one, as [{material: steel, thickness: 1e-3}]");
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_layer(reader, i, &scene->layer[k++]) != 0)
            return -1;
    return 0;
}

int read_reference(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    const char *text = node_text(reader, node);
    (void)rule;
    scene->reference_is_middle = text && strcmp(text, "middle") == 0;
    return scene->reference_is_middle ? 0
                                      : read_real(reader, node, &scene->reference, &not_negative);
}

/* ---- patches ---- */

static int read_layer_of(reader *reader, int node, void *to, const void *rule)
{
    const scene *scene = reader->s;
    char name[SCENE_NAME];
    int i;
    if (read_name(reader, node, name, rule) != 0)
        return -1;
    i = find_named(scene->layer, scene->layers, sizeof *scene->layer, name);
    if (i < 0)
        return tree_fault(reader->t, node,
                          "there is no layer named '%s'; give one of the layers this name", name);
    *(int *)to = i;
    return 0;
}

static int read_grid(reader *reader, int node, void *to, const void *rule)
{
    double pair[2];
    int i, *grid = to;
    if (read_pair(reader, node, pair, rule) != 0)
        return -1;
    for (i = 0; i < 2; i++) {
        if (pair[i] != floor(pair[i]))
            return tree_fault(reader->t, node,
                              "'grid' must be two whole numbers, [along theta1, along theta2]");
        grid[i] = (int)pair[i];
    }
    return 0;
}

static int read_patch(reader *reader, int node, scene_patches *patches)
{
    static const range counted = {1, 1000, 0, "must be from 1 to 1000"};
    static const field fields[] = {
        {"name", read_name, offsetof(scene_patches, name), NULL, 1},
        {"layer", read_layer_of, offsetof(scene_patches, layer), NULL, 1},
        {"theta1", read_pair, offsetof(scene_patches, theta1), NULL, 0},
        {"theta2", read_pair, offsetof(scene_patches, theta2), NULL, 0},
        {"grid", read_grid, offsetof(scene_patches, grid), &counted, 0},
        {NULL, NULL, 0, NULL, 0}};
    const scene_line *line = reader->s->line;
    patches->at = node_at(reader, node);
    patches->grid[0] = patches->grid[1] = 1;
    patches->theta1[0] = line[0].point[0];
    patches->theta1[1] = line[0].point[line[0].elements];
    patches->theta2[0] = line[1].point[0];
    patches->theta2[1] = line[1].point[line[1].elements];
    if (read_map(reader, node, fields, patches) != 0)
        return -1;
    for (int k = 0; k < 2; k++)
        if (patches->grid[k] > line[k].elements)
            return tree_fault(
                reader->t, node,
                "patches '%s': %d along theta%d, but the mesh has %d elements there; use "
                "fewer patches or more elements",
                patches->name, patches->grid[k], k + 1, line[k].elements);
    return 0;
}

int read_patches(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int i, k = 0;
    (void)rule;
    scene->patches =
        new_items(reader, node, TREE_LIST, sizeof *scene->patches, &scene->patch_grids);
    if (!scene->patches)
        return -1;
    if (scene->patch_grids > 1000)
        return tree_fault(reader->t, node, "%d items; join them into grids, at most 1000",
                          scene->patch_grids);
    for (i = reader->t->node[node].first; i; i = reader->t->node[i].next)
        if (read_patch(reader, i, &scene->patches[k++]) != 0)
            return -1;
    return 0;
}
