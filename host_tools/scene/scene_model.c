/* SPDX-License-Identifier: BSD-2-Clause */
/* Sections `element`, `materials`, `layers` and `patches` of a scene file. */
#include "scene_film.h"
#include "scene_parts.h"

#include <math.h>
#include <stdlib.h>
#include <stdio.h>
#include <string.h>

/* ---- element ---- */

const scene_element element_improved = {1, 1, 0.09, 1, 1, 1, 1, 7, 0, SQUARES_FITTED};
static const scene_element element_published = {0, 0, 0, 0, 0, 0, 0, 7, 0, SQUARES_OF_FACES};

static const choice presets[] = {{"improved", 0}, {"published", 1}, {NULL, 0}};
static const form preset_form = {.type = FORM_WORD, .words = presets};

static int read_preset(reader *reader, int node, void *to, const void *rule)
{
    int is_published = 0;
    (void)rule;
    if (read_choice(reader, node, &is_published, presets) != 0)
        return -1;
    *(scene_element *)to = is_published ? element_published : element_improved;
    return 0;
}

static const choice strain_kinematics[] = {{"local", 0}, {"cartesian", 1}, {NULL, 0}};
static const choice shears[] = {{"uniform", 0}, {"equilibrium", 1}, {NULL, 0}};
static const choice areas[] = {{"centre", 0}, {"exact", 1}, {NULL, 0}};
static const choice squares[] = {
    {"true", SQUARES_FITTED},     {"on", SQUARES_FITTED},
    {"yes", SQUARES_FITTED},      {"false", SQUARES_OF_FACES},
    {"off", SQUARES_OF_FACES},    {"no", SQUARES_OF_FACES},
    {"omitted", SQUARES_OMITTED}, {NULL, 0},
};

/*
 * The key `preset` is the first row of the table of the section `element` and is read first,
 * because the other keys modify the preset.
 */
static const field element_fields[] = {
    {"preset", read_preset, .form = &preset_form,
     .help = "Formulation that the other keys modify; default improved."},
    {"kinematics", read_either, offsetof(scene_element, cartesian), strain_kinematics,
     .help = "Strains from Cartesian differences of the displacement vectors of the corners, or "
             "from derivatives in the local triad."},
    {"tau", read_real, offsetof(scene_element, tau), &not_negative, .of = OF_NUMBER,
     .help = "Factor of the warping correction of the membrane shear strain; 0: without."},
    {"rho", read_real, offsetof(scene_element, rho), &not_negative, .of = OF_NUMBER,
     .help = "Factor of the bending flexibility that is added to the transverse shear compliance; "
             "0: without."},
    {"hr", read_flag, offsetof(scene_element, hr),
     .help = "Condense the compliance in the strain modes 01, 10 and 11."},
    {"lin33", read_flag, offsetof(scene_element, lin33),
     .help = "Condense the linear part of the normal strain e33."},
    {"shear", read_either, offsetof(scene_element, equilibrium_shear), shears,
     .help = "Transverse shear strain constant through the thickness (uniform, default), or shear "
             "stiffness from the equilibrium of the plies, for laminates with a soft core."},
    {"metric", read_flag, offsetof(scene_element, metric),
     .help = "Exact variation of the surface metric through the thickness."},
    {"area", read_either, offsetof(scene_element, exact_area), areas,
     .help = "Exact element area, or the area from the metric at the element centre."},
    {"quadratic", read_choice, offsetof(scene_element, quadratic), squares,
     .help = "Average the part of the in-plane strains that is quadratic in the height over the "
             "stiffness of the plies (true), take it at the two faces (false), or leave it out "
             "of products of displacements (omitted), for folds as sharp as the thickness."},
    {.key = NULL}};

static const form element_map_form = {.type = FORM_MAP, .fields = element_fields};
static const form *const element_forms[] = {&preset_form, &element_map_form, NULL};
const form element_form = {.type = FORM_ANY, .any = element_forms};

int read_element(reader *reader, int node, void *to, const void *rule)
{
    scene_element *element = &((scene *)to)->element;
    *element = element_improved;
    return reader->t->node[node].kind == TREE_MAP ? read_map(reader, node, element_fields, element)
                                                  : read_preset(reader, node, element, rule);
}

/* ---- materials ---- */

static const choice polings[] = {{"1", 1},   {"+1", 1}, {"-1", -1}, {"2", 2},   {"+2", 2},
                                 {"-2", -2}, {"3", 3},  {"+3", 3},  {"-3", -3}, {NULL, 0}};
static const form poling_form = {.type = FORM_WORD, .words = polings};

static int read_poling(reader *reader, int node, void *to, const void *rule)
{
    const char *text = node_text(reader, node);
    (void)rule;
    for (int axis = 1; text && axis <= 3; axis++)
        if (text[0] == '-' && text[1] == '0' + axis && text[2] == 0) {
            *(int *)to = -axis; /* The general reader for words maps each word to a number from 0
                                   on. A poling against an axis, such as "-3", is therefore read
                                   here, as a negative number. */
            return 0;
        }
    return read_choice(reader, node, to, polings);
}

static const form *const alpha_forms[] = {&number_form, &triple_form, NULL};
static const form alpha_form = {.type = FORM_ANY, .any = alpha_forms};

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
 * Elastic constants of a material as the user gives them, in one of three forms:
 *   E, nu      isotropic
 *   E1 ...     engineering constants; missing ones follow from transverse isotropy in the plane 23
 *   c11 c22 c33 c12 c13 c23 c44 c55 c66  stiffnesses; missing ones follow from transverse isotropy
 *       in the plane 12, as for a ceramic poled along 3
 */
typedef struct material_text {
    scene_material material;
    double modulus, nu, stiffness[9];
    scene_film film;
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

/*
 * Check that the scene file gives all keys of a list for a material. Returns 0, or -1 after writing
 * an error message about the scene file, which names the first missing key and all keys of the
 * list.
 */
static int require(reader *reader, int node, const char *const *keys)
{
    char all[64] = "";
    for (int i = 0; keys[i]; i++)
        snprintf(all + strlen(all), sizeof all - strlen(all), "%s%s", i ? ", " : "", keys[i]);
    for (; *keys; keys++)
        if (!tree_find(reader->t, node, *keys))
            return tree_fault(reader->t, node, "'%s' is missing in %.60s; add it (needed: %s)",
                              *keys, tree_name(reader->t, node), all);
    return 0;
}

static void set_default(double *member, double value)
{
    if (isnan(*member))
        *member = value;
}

static int elastic_isotropic(reader *reader, int node, material_text *text)
{
    scene_material *material = &text->material;
    if (require(reader, node, isotropic_keys) != 0)
        return -1;
    if (text->nu >= 0.5 || text->nu <= -1)
        return tree_fault(reader->t, tree_find(reader->t, node, "nu"),
                          "'nu: %g' of %.60s leaves no positive definite stiffness; "
                          "use -1 < nu < 0.5, 0.4999 with element: improved for rubber",
                          text->nu, tree_name(reader->t, node));
    material->e[0] = material->e[1] = material->e[2] = text->modulus;
    material->nu12 = material->nu13 = material->nu23 = text->nu;
    material->g12 = material->g13 = material->g23 = text->modulus / (2 * (1 + text->nu));
    return 0;
}

/*
 * Return whether the elastic energy of a material is positive: all pivots of its compliance matrix,
 * scaled to unit diagonal, are positive.
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
    const int from_film = text->film.force > 0;
    scene_material *material = &text->material;
    if (require(reader, node, needed + from_film) != 0)
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

#define STIFFNESS(key, i, rule, required, help)                                                    \
    {                                                                                              \
        key, read_real, sizeof(double) * (i), rule, required, OF_STRESS, NULL, help                \
    }
static const field stiffness_fields[] = {
    STIFFNESS("c11", C11, &above_zero, 1, "Stiffness c11."),
    STIFFNESS("c12", C12, NULL, 1, "Stiffness c12."),
    STIFFNESS("c13", C13, NULL, 1, "Stiffness c13."),
    STIFFNESS("c33", C33, &above_zero, 1, "Stiffness c33."),
    STIFFNESS("c44", C44, &above_zero, 1, "Shear stiffness in the plane 23."),
    STIFFNESS("c22", C22, &above_zero, 0, "Stiffness c22; default c11."),
    STIFFNESS("c23", C23, NULL, 0, "Stiffness c23; default c13."),
    STIFFNESS("c55", C55, &above_zero, 0, "Shear stiffness in the plane 13; default c44."),
    STIFFNESS("c66", C66, &above_zero, 0,
              "Shear stiffness in the plane 12; default (c11 - c12)/2."),
    {.key = NULL}};
#undef STIFFNESS

static const form stiffness_form = {.type = FORM_MAP, .fields = stiffness_fields};

static int read_stiffness(reader *reader, int node, void *to, const void *rule)
{
    double *stiffness = to;
    int i;
    (void)rule;
    for (i = 0; i < 9; i++)
        stiffness[i] = (double)NAN;
    if (read_map(reader, node, stiffness_fields, stiffness) != 0)
        return -1;
    set_default(&stiffness[C22], stiffness[C11]);
    set_default(&stiffness[C23], stiffness[C13]);
    set_default(&stiffness[C55], stiffness[C44]);
    set_default(&stiffness[C66], (stiffness[C11] - stiffness[C12]) / 2);
    return 0;
}

/*
 * Compute the engineering constants of a material from the inverse of its stiffness matrix. Returns
 * 0, or -1 after writing an error message about the scene file if the matrix is not positive
 * definite.
 */
static int elastic_stiffness(reader *reader, int node, material_text *text)
{
    const double *stiffness = text->stiffness;
    scene_material *material = &text->material;
    const double minor = stiffness[C11] * stiffness[C22] - stiffness[C12] * stiffness[C12],
                 s33 = minor;
    const double s11 = stiffness[C22] * stiffness[C33] - stiffness[C23] * stiffness[C23],
                 s22 = stiffness[C11] * stiffness[C33] - stiffness[C13] * stiffness[C13];
    const double s12 = stiffness[C13] * stiffness[C23] - stiffness[C12] * stiffness[C33],
                 s13 = stiffness[C12] * stiffness[C23] - stiffness[C13] * stiffness[C22];
    const double s23 = stiffness[C12] * stiffness[C13] - stiffness[C23] * stiffness[C11];
    const double all = stiffness[C11] * s11 + stiffness[C12] * s12 + stiffness[C13] * s13;
    if (!(minor > 0 && all > 0 && s11 > 0 && s22 > 0 && stiffness[C66] > 0))
        return tree_fault(reader->t, node,
                          "the stiffness of %.60s is not positive definite; lower c12, c13 or c23",
                          tree_name(reader->t, node));
    material->e[0] = all / s11;
    material->e[1] = all / s22;
    material->e[2] = all / s33;
    material->nu12 = -s12 / s11;
    material->nu13 = -s13 / s11;
    material->nu23 = -s23 / s22;
    material->g23 = stiffness[C44];
    material->g13 = stiffness[C55];
    material->g12 = stiffness[C66];
    return 0;
}

/* Compute the material constants of a film, a thin actuator with fibres, from its data sheet. */
static int take_film(reader *reader, int node, material_text *text)
{
    static const char *const modulus_keys[] = {"E1", "E", "nu", "stiffness", NULL};
    scene_material *material = &text->material;
    const char *modulus = first_given(reader, node, modulus_keys);
    if (text->film.thickness <= 0)
        return 0;
    if (first_given(reader, node, d_keys) || first_given(reader, node, e_keys))
        return tree_fault(reader->t, node,
                          "%.60s has a film and piezoelectric constants; give one or the other",
                          tree_name(reader->t, node));
    if (modulus && text->film.force > 0)
        return tree_fault(reader->t, node,
                          "%.60s has '%s' and the blocking force of a film, which gives E1; write "
                          "E2, G12, nu12 beside the force, or leave the force out",
                          tree_name(reader->t, node), modulus);
    if (text->film.force > 0)
        material->e[0] = scene_film_modulus(&text->film);
    material->film_voltage = text->film.voltage;
    material->d31 = scene_film_constant(&text->film, 0);
    material->d32 = scene_film_constant(&text->film, 1);
    material->film_thickness = text->film.thickness;
    return 0;
}

static int check_material(reader *reader, int node, material_text *text)
{
    static const char *const stiffness_key[] = {"stiffness", NULL};
    const char *isotropic = first_given(reader, node, isotropic_keys),
               *orthotropic = first_given(reader, node, orthotropic_keys);
    const char *stiffness = first_given(reader, node, stiffness_key);
    const char *strain_constant = first_given(reader, node, d_keys),
               *stress_constant = first_given(reader, node, e_keys);
    if (isotropic && orthotropic)
        return tree_fault(reader->t, node,
                          "%.60s has '%s' and '%s'; give E, nu or E1, E2, G12, nu12 ...",
                          tree_name(reader->t, node), isotropic, orthotropic);
    if (stiffness && (isotropic || orthotropic))
        return tree_fault(reader->t, node, "%.60s has 'stiffness' and '%s'; give one or the other",
                          tree_name(reader->t, node), isotropic ? isotropic : orthotropic);
    if (strain_constant && stress_constant)
        return tree_fault(reader->t, node,
                          "%.60s has '%s' and '%s'; give strain constants d or stress constants e",
                          tree_name(reader->t, node), strain_constant, stress_constant);
    if (take_film(reader, node, text) != 0)
        return -1;
    text->material.has_d = strain_constant != NULL || text->film.thickness > 0;
    text->material.has_e = stress_constant != NULL;
    text->material.lacks_32 =
        (tree_find(reader->t, node, "d31") && !tree_find(reader->t, node, "d32")) ||
        (tree_find(reader->t, node, "e31") && !tree_find(reader->t, node, "e32"));
    if (stiffness)
        return elastic_stiffness(reader, node, text);
    if (orthotropic || text->film.force > 0)
        return elastic_orthotropic(reader, node, text);
    if (isotropic)
        return elastic_isotropic(reader, node, text);
    return tree_fault(reader->t, node,
                      "no stiffness in %.60s; give E and nu, or E1, E2, G12 and nu12, or stiffness",
                      tree_name(reader->t, node));
}

static const form pair_form = {.type = FORM_LIST, .item = &above_zero_form, .least = 2, .most = 2};
static const form *const axes_forms[] = {&above_zero_form, &pair_form, NULL};
static const form axes_form = {.type = FORM_ANY, .any = axes_forms};

/* Read a strength along the axes 1 and 2: one number for both axes, or a list of two. */
static int read_axes(reader *reader, int node, void *to, const void *rule)
{
    double *strength = to;
    const tree_node *list = &reader->t->node[node];
    if (list->kind == TREE_LIST && list->count != 2)
        return tree_fault(reader->t, node,
                          "'%.60s' has %d values; give one, or two, [along 1, along 2]",
                          tree_name(reader->t, node), list->count);
    if (list->kind == TREE_LIST)
        return read_pair(reader, node, strength, rule);
    if (read_real(reader, node, strength, rule) != 0)
        return -1;
    strength[1] = strength[0];
    return 0;
}

static const choice criteria[] = {
    {"tsai-hill", CRITERION_TSAI_HILL}, {"maximum-stress", CRITERION_MAXIMUM_STRESS}, {NULL, 0}};

static const field strength_fields[] = {
    {"tension", read_axes, offsetof(scene_strength, tension), &above_zero, 1, .of = OF_STRESS,
     .form = &axes_form,
     .help = "Strength under tension: one number, or [along 1, along 2] of the material."},
    {"compression", read_axes, offsetof(scene_strength, compression), &above_zero, .of = OF_STRESS,
     .form = &axes_form,
     .help = "Strength under compression, positive, as tension; default that under tension."},
    {"shear", read_real, offsetof(scene_strength, shear), &above_zero, .of = OF_STRESS,
     .help = "Strength under shear in the plane 12; default tension/sqrt(3), where tension is one "
             "number."},
    {"criterion", read_choice, offsetof(scene_strength, criterion), criteria,
     .help = "tsai-hill (default): the stresses act together; maximum-stress: each by itself."},
    {.key = NULL}};
static const form strength_form = {.type = FORM_MAP, .fields = strength_fields};

/*
 * Read the strengths of a material. If the tensile strength is equal for both axes and no shear
 * strength is given, the shear strength is chosen so that the Tsai-Hill criterion equals that of
 * von Mises.
 */
static int read_strength(reader *reader, int node, void *to, const void *rule)
{
    scene_strength *strength = to;
    const tree *const text = reader->t;
    (void)rule;
    if (read_map(reader, node, strength_fields, strength) != 0)
        return -1;
    strength->given = true;
    if (!tree_find(text, node, "compression"))
        memcpy(strength->compression, strength->tension, sizeof strength->compression);
    if (tree_find(text, node, "shear"))
        return 0;
    if (text->node[tree_find(text, node, "tension")].kind == TREE_LIST)
        return tree_fault(reader->t, node,
                          "no 'shear' beside the strengths %g and %g along 1 and 2; add it",
                          strength->tension[0], strength->tension[1]);
    strength->shear = strength->tension[0] / sqrt(3);
    return 0;
}

static const range poisson = {-1, 0.5, 1, NULL};
static const form poisson_form = {.type = FORM_NUMBER, .range = &poisson};

#define NUMBER(key, member, rule, of, help)                                                        \
    {                                                                                              \
        key, read_real, offsetof(material_text, member), rule, 0, of, NULL, help                   \
    }
static const field material_fields[] = {
    NUMBER("E", modulus, &above_zero, OF_STRESS, "Young's modulus of an isotropic material."),
    {"nu", read_real, offsetof(material_text, nu), .of = OF_NUMBER, .form = &poisson_form,
     .help = "Poisson's ratio of an isotropic material, between -1 and 0.5."},
    {"stiffness", read_stiffness, offsetof(material_text, stiffness), .form = &stiffness_form,
     .help = "Stiffness at constant field instead of moduli, by default isotropic in the plane 12 "
             "as of a ceramic poled along 3; the indices 4, 5, 6 are 23, 13, 12."},
    NUMBER("E1", material.e[0], &above_zero, OF_STRESS, "Modulus along the fibres."),
    NUMBER("E2", material.e[1], &above_zero, OF_STRESS, "Modulus across the fibres."),
    NUMBER("E3", material.e[2], &above_zero, OF_STRESS,
           "Modulus through the thickness; default E2."),
    NUMBER("G12", material.g12, &above_zero, OF_STRESS, "Shear modulus in the plane 12."),
    NUMBER("G13", material.g13, &above_zero, OF_STRESS,
           "Shear modulus in the plane 13; default G12."),
    NUMBER("G23", material.g23, &above_zero, OF_STRESS,
           "Shear modulus in the plane 23; default E2/(2(1 + nu23))."),
    NUMBER("nu12", material.nu12, NULL, OF_NUMBER,
           "Poisson's ratio -e2/e1 under a stress along 1."),
    NUMBER("nu13", material.nu13, NULL, OF_NUMBER,
           "Poisson's ratio -e3/e1 under a stress along 1; default nu12."),
    NUMBER("nu23", material.nu23, NULL, OF_NUMBER,
           "Poisson's ratio -e3/e2 under a stress along 2; default nu12."),
    NUMBER("d31", material.d31, NULL, OF_STRAIN_CONSTANT,
           "Piezoelectric strain constant: strain per field along the poling; default 0."),
    NUMBER(
        "d32", material.d32, NULL, OF_STRAIN_CONSTANT,
        "Piezoelectric strain constant: strain per field along the poling; default 0, never d31: "
        "a ceramic poled through its thickness has d32 equal to d31."),
    NUMBER("d33", material.d33, NULL, OF_STRAIN_CONSTANT,
           "Piezoelectric strain constant: strain per field along the poling; default 0."),
    NUMBER("d24", material.d24, NULL, OF_STRAIN_CONSTANT,
           "Piezoelectric strain constant: strain per field along the poling; default 0."),
    NUMBER("d15", material.d15, NULL, OF_STRAIN_CONSTANT,
           "Piezoelectric strain constant: strain per field along the poling; default 0."),
    NUMBER(
        "e31", material.piezo_e[0], NULL, OF_STRESS_CONSTANT,
        "Piezoelectric stress constant: charge per area and strain; instead of the d constants."),
    NUMBER(
        "e32", material.piezo_e[1], NULL, OF_STRESS_CONSTANT,
        "Piezoelectric stress constant: charge per area and strain; instead of the d constants."),
    NUMBER(
        "e33", material.piezo_e[2], NULL, OF_STRESS_CONSTANT,
        "Piezoelectric stress constant: charge per area and strain; instead of the d constants."),
    NUMBER(
        "e24", material.piezo_e[3], NULL, OF_STRESS_CONSTANT,
        "Piezoelectric stress constant: charge per area and strain; instead of the d constants."),
    NUMBER(
        "e15", material.piezo_e[4], NULL, OF_STRESS_CONSTANT,
        "Piezoelectric stress constant: charge per area and strain; instead of the d constants."),
    NUMBER("permittivity", material.permittivity, &not_negative, OF_PERMITTIVITY,
           "Permittivity at constant strain, along the poling; sensors need it."),
    NUMBER("permittivity_across", material.permittivity_across, &not_negative, OF_PERMITTIVITY,
           "Permittivity at constant strain across the poling; default that along the poling."),
    NUMBER("pyroelectric", material.pyroelectric, NULL, OF_PYROELECTRIC,
           "Pyroelectric constant along the poling, at constant strain."),
    {"film", read_film, offsetof(material_text, film), .form = &film_form,
     .help = "Data sheet of a thin actuator, such as a macro fibre composite, instead of the "
             "piezoelectric constants."},
    {"poling", read_poling, offsetof(material_text, material.poling), .form = &poling_form,
     .help = "Axis of the layer along which it is poled, 1, 2 or 3 (e3, default), or -1, -2, -3. "
             "Elastic constants stay in the axes of the layer; d33 is along the poling, d31 along "
             "e3 (under a poling of 3, along 1), d15 is the shear of both."},
    {"alpha", read_alpha, offsetof(material_text, material.alpha), .of = OF_EXPANSION,
     .form = &alpha_form, .help = "Thermal expansion; one number, or three for the axes 1, 2, 3."},
    NUMBER("density", material.density, &not_negative, OF_DENSITY,
           "Mass per volume; needed for natural frequencies and for weight."),
    NUMBER("field_limit", material.field_limit, &not_negative, OF_FIELD,
           "Field that depolarises the material; voltages stay below it; 0: no limit."),
    {"strength", read_strength, offsetof(material_text, material.strength), .form = &strength_form,
     .help = "Strengths of the material; pzs solve --stress prints the reserve factors."},
    {.key = NULL}};
#undef NUMBER

static const form_case material_cases[] = {
    {"E nu ?film", "An isotropic material."},
    {"E1 E2 G12 nu12 ?film ?E3 ?G13 ?G23 ?nu13 ?nu23", "An orthotropic material, such as a ply."},
    {"E2 G12 nu12 film ?E3 ?G13 ?G23 ?nu13 ?nu23", "A film whose blocking force gives E1."},
    {"stiffness ?film", "A material by its stiffness."},
    {NULL, NULL}};
static const form material_form = {
    .type = FORM_MAP, .fields = material_fields, .cases = material_cases};
const form materials_form = {.type = FORM_NAMED, .item = &material_form, .least = 1};

static int read_material(reader *reader, int node, void *item)
{
    scene_material *to = item;
    material_text text;
    scene_material *material = &text.material;
    memset(&text, 0, sizeof text);
    material->e[2] = material->g13 = material->g23 = material->nu13 = material->nu23 = (double)NAN;
    material->poling = 3;
    material->permittivity_across = (double)NAN;
    if (check_name(reader, reader->t->node[node].key, reader->t->node[node].key_at,
                   material->name) != 0)
        return -1;
    material->at = reader->t->node[node].key_at;
    material->at.origin = reader->s->origin;
    if (read_map(reader, node, material_fields, &text) != 0 ||
        check_material(reader, node, &text) != 0)
        return -1;
    set_default(&material->permittivity_across, material->permittivity);
    *to = text.material;
    return 0;
}

int read_materials(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->material = new_items(reader, node, TREE_MAP, sizeof *scene->material, &scene->materials);
    if (!scene->material)
        return -1;
    if (scene->materials == 0)
        return tree_fault(reader->t, node,
                          "no materials; add one, as {steel: {E: 210e9, nu: 0.3}}");
    return read_items(reader, node, scene->material, sizeof *scene->material, read_material, NULL);
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

static const choice bare_faces[] = {
    {"inner", BARE_INNER}, {"outer", BARE_OUTER}, {"both", BARE_BOTH}, {NULL, 0}};
static const range turn = {-360, 360, 0, "must lie between -360 and 360 degrees"};

static const field layer_fields[] = {
    {"name", read_name, offsetof(scene_layer, name),
     .help = "Name of the layer; needed where patches lie on it."},
    {"material", read_material_of, offsetof(scene_layer, material), .required = 1,
     .form = &name_form, .help = "Name of a material."},
    {"thickness", read_real, offsetof(scene_layer, thickness), &above_zero, 1, .of = OF_LENGTH,
     .help = "Thickness of the layer."},
    {"angle", read_real, offsetof(scene_layer, angle), &turn, .of = OF_DEGREES,
     .help = "Angle of the axis 1 of the material, in degrees from theta1 towards theta2; default "
             "0."},
    {"patched", read_flag, offsetof(scene_layer, patched),
     .help = "The layer exists only where a patch lies; default false."},
    {"sets", read_layer_sets, .form = &labels_form,
     .help = "Mesh from a file: element sets in which the layer exists; default everywhere."},
    {"poling", read_poling, offsetof(scene_layer, poling), .form = &poling_form,
     .help =
         "Axis of the layer along which it is poled, 1, 2, 3, -1, -2 or -3; default that of the "
         "material."},
    {"finger_distance", read_real, offsetof(scene_layer, finger_distance), &above_zero,
     .of = OF_LENGTH,
     .help = "Distance of interdigitated electrodes on a layer that is poled along 1 or 2: the "
             "field of a voltage is along the poling; default: electrodes cover the faces, the "
             "field is along e3."},
    {"bare", read_choice, offsetof(scene_layer, bare), bare_faces,
     .help = "Faces of a piezoelectric layer without electrode, inner, outer or both, whose "
             "potential is computed at each node; the other face is an electrode at 0 V. Default: "
             "no face is bare."},
    {.key = NULL}};

static const form layer_form = {.type = FORM_MAP, .fields = layer_fields};
const form layers_form = {.type = FORM_LIST, .item = &layer_form, .least = 1};

/*
 * Check a piezoelectric layer with bare faces (without electrodes): its material needs
 * piezoelectric constants and permittivities, and interdigitated electrodes contradict a bare face.
 * Returns 0, or -1 after writing an error message about the scene file.
 */
static int check_bare(reader *reader, int node, const scene_layer *layer)
{
    const scene_material *material = &reader->s->material[layer->material];
    const int key = tree_find(reader->t, node, "bare");
    if (layer->bare == BARE_NONE)
        return 0;
    if (!material->has_d && !material->has_e)
        return tree_fault(reader->t, key,
                          "this layer is of '%s', which has no piezoelectric constants; give it "
                          "d31 or e31, or remove 'bare'",
                          material->name);
    if (!(material->permittivity > 0 && material->permittivity_across > 0))
        return tree_fault(reader->t, key,
                          "this layer is of '%s', which has no permittivity; a bare face needs it",
                          material->name);
    if (layer->finger_distance > 0)
        return tree_fault(reader->t, key,
                          "this layer has interdigitated electrodes on its faces; remove 'bare' or "
                          "'finger_distance'");
    return 0;
}

static int read_layer(reader *reader, int node, void *item)
{
    scene_layer *layer = item;
    layer->at = node_at(reader, node);
    if (read_map(reader, node, layer_fields, layer) != 0)
        return -1;
    if (layer->poling == 0)
        layer->poling = reader->s->material[layer->material].poling;
    if (layer->finger_distance > 0 && abs(layer->poling) == 3)
        return tree_fault(
            reader->t, tree_find(reader->t, node, "finger_distance"),
            "this layer is poled along e3, but interdigitated electrodes have a field "
            "along the surface; give it 'poling: 1' or 2, or remove "
            "'finger_distance'");
    if (check_bare(reader, node, layer) != 0)
        return -1;
    const double film = reader->s->material[layer->material].film_thickness;
    if (film <= 0 || fabs(film - layer->thickness) <= 1e-9 * film)
        return 0;
    return tree_fault(reader->t, node,
                      "this layer is %g thick, but its material is a film of %g; give both the "
                      "same thickness",
                      layer->thickness, film);
}

int read_layers(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    (void)rule;
    scene->at_layers = node_at(reader, node);
    scene->layer = new_items(reader, node, TREE_LIST, sizeof *scene->layer, &scene->layers);
    if (!scene->layer)
        return -1;
    if (scene->layers == 0)
        return tree_fault(reader->t, node,
                          "no layers; add one, as [{material: steel, thickness: 1e-3}]");
    return read_items(reader, node, scene->layer, sizeof *scene->layer, read_layer, NULL);
}

static const choice middle[] = {{"middle", 1}, {NULL, 0}};
static const form middle_form = {.type = FORM_WORD, .words = middle};
static const form *const reference_forms[] = {&middle_form, &not_negative_form, NULL};
const form reference_form = {.type = FORM_ANY, .any = reference_forms};

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
    (void)rule;
    return read_index(reader, node, scene->layer, scene->layers, sizeof *scene->layer,
                      "there is no layer named '%s'; give one of the layers this name", to);
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

static const range patch_count = {1, 1000, 0, "must be from 1 to 1000"};
static const form patch_count_form = {.type = FORM_WHOLE, .range = &patch_count};
static const form grid_form = {.type = FORM_LIST, .item = &patch_count_form, .least = 2, .most = 2};

static const choice ceramics[] = {{"continuous", 0}, {"smeared", 1}, {NULL, 0}};

static const field patch_fields[] = {
    {"name", read_name, offsetof(scene_patches, name), .required = 1,
     .help = "Name of the grid; its patches are name_1_1 ..., with the first index along theta1."},
    {"layer", read_layer_of, offsetof(scene_patches, layer), .required = 1, .form = &name_form,
     .help = "Name of a layer."},
    {"theta1", read_pair, offsetof(scene_patches, theta1), .of = OF_COORDINATE,
     .help = "Range of the grid along theta1, [from, to]; default the whole mesh."},
    {"theta2", read_pair, offsetof(scene_patches, theta2), .of = OF_COORDINATE,
     .help = "Range of the grid along theta2, [from, to]; default the whole mesh."},
    {"grid", read_grid, offsetof(scene_patches, grid), &patch_count, .of = OF_NUMBER,
     .form = &grid_form, .help = "Number of patches along theta1 and theta2; default [1, 1]."},
    {"sets", read_patch_sets, .form = &labels_form,
     .help = "Mesh from a file: element sets, each of which is a patch; * stands for any text."},
    {"plane", read_plane, offsetof(scene_patches, plane), .form = &plane_form,
     .help = "Plane of the outlines: theta (theta1, theta2; default on mesh lines), or the surface "
             "seen along an axis: xy (default on a mesh from a file), xz, yz."},
    {"cut", read_flag, offsetof(scene_patches, cut),
     .help = "Of an outline that reaches beyond the surface, keep the part on it; default false: "
             "refuse it."},
    {"outlines", read_outlines, .form = &outlines_form,
     .help = "Electrodes of any outline, in place of ranges and sets; they may end anywhere in an "
             "element and are name_1_1, name_2_1 ... in their order. The layer is continuous, or "
             "patched with stiffness: smeared."},
    {"stiffness", read_either, offsetof(scene_patches, is_smeared), ceramics,
     .help = "Of outlines: continuous (default), the layer is there everywhere; smeared, a patched "
             "layer ends at the outlines, and stiffness, mass and thermal expansion of an element "
             "are means over its area; the error near an outline is of the size of an element."},
    {.key = NULL}};

static const form patch_form = {.type = FORM_MAP, .fields = patch_fields};
const form patches_form = {.type = FORM_LIST, .item = &patch_form, .most = 1000};

/*
 * Check that patches whose electrodes are given by outlines lie on a layer of the right kind: with
 * smeared stiffness the layer is patched and has no bare face (without electrode), otherwise it is
 * continuous. Returns 0, or -1 after writing an error message about the scene file.
 */
static int check_outlined_layer(reader *reader, int node, const scene_patches *patches)
{
    const scene_layer *layer = &reader->s->layer[patches->layer];
    const int key = tree_find(reader->t, node, "layer");
    if (layer->patched && !patches->is_smeared)
        return tree_fault(reader->t, key,
                          "the layer '%s' is patched: its material ends where patches end, and "
                          "outlines do not follow elements; add 'stiffness: smeared', remove "
                          "'patched', or use patches without 'outlines'",
                          layer->name);
    if (patches->is_smeared && !layer->patched)
        return tree_fault(reader->t, tree_find(reader->t, node, "stiffness"),
                          "the layer '%s' is continuous, so that its stiffness does not end at "
                          "outlines; give the layer 'patched: true', or remove 'stiffness'",
                          layer->name);
    if (patches->is_smeared && layer->bare != BARE_NONE)
        return tree_fault(reader->t, tree_find(reader->t, node, "stiffness"),
                          "the layer '%s' has a bare face, whose patches are whole elements; "
                          "remove 'bare' from the layer, or use patches without 'outlines'",
                          layer->name);
    return 0;
}

/*
 * Check and read patches whose electrodes are given by outlines. They may have neither coordinate
 * ranges nor element sets. Returns 0, or -1 after writing an error message about the scene file.
 */
static int read_outlined(reader *reader, int node, scene_patches *patches)
{
    static const char *const foreign[] = {"theta1", "theta2", "grid", "sets"};
    patches->plane = reader->s->quads ? OUTLINE_XY : OUTLINE_THETA;
    for (int i = 0; i < 4; i++)
        if (tree_find(reader->t, node, foreign[i]))
            return tree_fault(reader->t, tree_find(reader->t, node, foreign[i]),
                              "'%s' belongs to patches of whole elements; remove it, or 'outlines'",
                              foreign[i]);
    if (read_map(reader, node, patch_fields, patches) != 0)
        return -1;
    return check_outlined_layer(reader, node, patches);
}

/* Read patches on a mesh from a file, where each patch is an element set. */
static int read_set_patch(reader *reader, int node, scene_patches *patches)
{
    static const char *const foreign[] = {"theta1", "theta2", "grid"};
    for (int i = 0; i < 3; i++)
        if (tree_find(reader->t, node, foreign[i]))
            return tree_fault(reader->t, tree_find(reader->t, node, foreign[i]),
                              "'%s' belongs to mesh lines; on a mesh from a file name element "
                              "sets: sets: [name, ...]",
                              foreign[i]);
    if (!tree_find(reader->t, node, "sets"))
        return tree_fault(reader->t, node,
                          "'sets' is missing in patches; name the element sets of the mesh file, "
                          "or give 'outlines'");
    return read_map(reader, node, patch_fields, patches);
}

static int read_patch(reader *reader, int node, void *item)
{
    static const char *const of_outlines[] = {"plane", "cut", "stiffness"};
    scene_patches *patches = item;
    const scene_line *line = reader->s->line;
    patches->at = node_at(reader, node);
    patches->grid[0] = patches->grid[1] = 1;
    if (tree_find(reader->t, node, "outlines"))
        return read_outlined(reader, node, patches);
    for (int i = 0; i < 3; i++)
        if (tree_find(reader->t, node, of_outlines[i]))
            return tree_fault(reader->t, tree_find(reader->t, node, of_outlines[i]),
                              "'%s' belongs to 'outlines'; add them, or remove it", of_outlines[i]);
    if (reader->s->quads)
        return read_set_patch(reader, node, patches);
    patches->theta1[0] = line[0].point[0];
    patches->theta1[1] = line[0].point[line[0].elements];
    patches->theta2[0] = line[1].point[0];
    patches->theta2[1] = line[1].point[line[1].elements];
    if (read_map(reader, node, patch_fields, patches) != 0)
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
    (void)rule;
    scene->patches =
        new_items(reader, node, TREE_LIST, sizeof *scene->patches, &scene->patch_grids);
    if (!scene->patches)
        return -1;
    if (scene->patch_grids > 1000)
        return tree_fault(reader->t, node, "%d items; join them into grids, at most 1000",
                          scene->patch_grids);
    return read_items(reader, node, scene->patches, sizeof *scene->patches, read_patch, NULL);
}
