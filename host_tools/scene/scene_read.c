/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Reading of a whole scene file (scene_read in scene.h): the tables of the sections that it may
 * contain, and the default values of sections that it leaves out.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "scene_parts.h"

static const field units_fields[] = {
    {"length", read_name, offsetof(scene, units.length), .help = "Unit of length, such as m."},
    {"force", read_name, offsetof(scene, units.force), .help = "Unit of force, such as N."},
    {"voltage", read_name, offsetof(scene, units.voltage), .help = "Unit of voltage, such as V."},
    {"temperature", read_name, offsetof(scene, units.temperature),
     .help = "Unit of temperature differences, such as K."},
    {.key = NULL}};

static const form units_form = {.type = FORM_MAP, .fields = units_fields};

static int read_units(reader *reader, int node, void *to, const void *rule)
{
    (void)rule;
    return read_map(reader, node, units_fields, to);
}

static const choice dof_counts[] = {{"7", 7}, {"6", 6}, {NULL, 0}};
static const form dof_per_node_form = {.type = FORM_WORD, .words = dof_counts};

static int read_dof_per_node(reader *reader, int node, void *to, const void *rule)
{
    scene_element *element = &((scene *)to)->element;
    (void)rule;
    if (read_choice(reader, node, &element->dof_per_node, dof_counts) != 0)
        return -1;
    if (element->dof_per_node == 7 || element->lin33)
        return 0;
    return tree_fault(reader->t, node,
                      "'dof_per_node: 6' needs lin33; use element: improved, or dof_per_node: 7");
}

static const choice kinematics[] = {{"linear", KINEMATICS_LINEAR},
                                    {"nonlinear", KINEMATICS_NONLINEAR},
                                    {"auto", KINEMATICS_AUTO},
                                    {NULL, 0}};
static const form kinematics_form = {.type = FORM_WORD, .words = kinematics};

static int read_kinematics(reader *reader, int node, void *to, const void *rule)
{
    scene *scene = to;
    int kind = 0;
    if (read_choice(reader, node, &kind, rule) != 0)
        return -1;
    scene->kinematics = (scene_kinematics)kind;
    return 0;
}

static const range relative = {0, 1, 1,
                               "must lie between 0 and 1, ends left out; it is a relative error"};

/*
 * Rows for the tables of the sections of a scene file. These sections may stand in every scene
 * file, with a structural model as well as with a measured influence matrix.
 */
#define NAME_ROWS                                                                                  \
    {"name", read_name, offsetof(scene, name), NULL, 1, OF_NOTHING, NULL, "Name of the scene."},   \
        {"about",                                                                                  \
         read_text,                                                                                \
         offsetof(scene, about),                                                                   \
         NULL,                                                                                     \
         0,                                                                                        \
         OF_NOTHING,                                                                               \
         NULL,                                                                                     \
         "A sentence on what the scene shows and where its numbers come from."},                   \
    {                                                                                              \
        "units", read_units, 0, NULL, 0, OF_NOTHING, &units_form,                                  \
            "Units of the numbers, and labels of the results. Where they are SI units, a number "  \
            "may carry a unit of its own (0.3 mm, 135 GPa, -210 pC/N, 7600 kg/m3) and is "         \
            "converted."                                                                           \
    }
#define CONTROL_ROWS                                                                               \
    {"control",                                                                                    \
     read_control,                                                                                 \
     0,                                                                                            \
     NULL,                                                                                         \
     0,                                                                                            \
     OF_NOTHING,                                                                                   \
     &control_form,                                                                                \
     "The control loop on the device."},                                                           \
        {"safety",                                                                                 \
         read_safety,                                                                              \
         0,                                                                                        \
         NULL,                                                                                     \
         0,                                                                                        \
         OF_NOTHING,                                                                               \
         &safety_form,                                                                             \
         "Supervisor of the control loop, which parks the voltages when control is lost. A loop "  \
         "that damps vibration has one with default settings; none: leave it out."},               \
        {"hysteresis",                                                                             \
         read_hysteresis_section,                                                                  \
         0,                                                                                        \
         NULL,                                                                                     \
         0,                                                                                        \
         OF_NOTHING,                                                                               \
         &hysteresis_form,                                                                         \
         "Hysteresis and creep of the ceramic, which the control loop compensates; pzs calibrate " \
         "--hysteresis prints this section."},                                                     \
    {                                                                                              \
        "limits", read_limits, 0, NULL, 0, OF_NOTHING, &limits_form, "Limits of the amplifiers."   \
    }
#define COMPARE_ROW                                                                                \
    {                                                                                              \
        "compare", read_compare, 0, NULL, 0, OF_NOTHING, &compare_form,                            \
            "Sets of voltages to print beside the optimum."                                        \
    }
#define SIMULATE_ROW                                                                               \
    {                                                                                              \
        "simulate", read_simulate, 0, NULL, 0, OF_NOTHING, &simulate_form,                         \
            "Closed loop of the controller with a plant that differs from the scene."              \
    }

static const field sections[] = {
    NAME_ROWS,
    {"element", read_element, .of = OF_NUMBER, .form = &element_form,
     .help = "Formulation of the element: improved (default: free of locking, exact under rigid "
             "motion), published (that of the published tables), or a mapping whose missing keys "
             "are those of improved."},
    {"dof_per_node", read_dof_per_node, .form = &dof_per_node_form,
     .help = "Degrees of freedom of a node; 6 drops that of the middle surface and needs lin33; "
             "default 6 where lin33 (element: improved) meets nonlinear kinematics, because the "
             "seventh loses its stiffness where a shell turns by a right angle; else 7."},
    {"kinematics", read_kinematics, 0, kinematics, .form = &kinematics_form,
     .help = "linear: small displacements (default); nonlinear: finite displacements; auto: linear "
             "where its error is below the tolerance."},
    {"tolerance", read_real, offsetof(scene, tolerance), &relative, .of = OF_NUMBER,
     .help = "Largest relative error that linear kinematics may cause under kinematics: auto; "
             "default 0.01."},
    {"equilibrium", read_equilibrium, .form = &equilibrium_form,
     .help = "Settings of the solver of the nonlinear equilibrium equations."},
    {"surface", read_surface, .form = &surface_form,
     .help = "Reference surface with its coordinates theta1 and theta2; e3 = e1 x e2 points to the "
             "outer side; a mesh from a file has none."},
    {"mesh", read_mesh, .required = 1, .form = &mesh_form,
     .help = "Mesh lines along theta1 and theta2, or a mesh file; at most 60000 nodes."},
    {"materials", read_materials, .required = 1, .form = &materials_form,
     .help = "Materials by name: E, nu, or E1, E2, G12, nu12 ..., or a stiffness; piezoelectric "
             "materials with d or e constants."},
    {"layers", read_layers, .required = 1, .form = &layers_form,
     .help = "Layers from the inner face (z-) to the outer face (z+)."},
    {"reference", read_reference, .of = OF_LENGTH, .form = &reference_form,
     .help = "Height of the reference surface above the inner face; default middle."},
    {"patches", read_patches, .form = &patches_form,
     .help = "Grids of rectangles of whole elements on a layer; on a layer that is not patched "
             "they are electrodes only."},
    {"actuators", read_actuators, .form = &actuators_form,
     .help = "Amplifiers. A voltage is the potential of the side of a patch towards +e3 minus that "
             "of its other side."},
    {"sensors", read_sensors, .form = &sensors_form,
     .help = "Electrodes without an amplifier, one for each patch of the grids. Their voltages and "
             "charges can be outputs."},
    CONTROL_ROWS,
    {"supports", read_supports, .form = &supports_form,
     .help = "Displacements that are zero or prescribed."},
    {"springs", read_springs, .form = &springs_form,
     .help = "Springs between the shell and the ground, or between two nodes."},
    {"masses", read_masses, .form = &masses_form,
     .help = "Concentrated masses on the shell, such as sensors, mounts and connectors."},
    {"loads", read_loads, .form = &loads_form,
     .help = "Forces, pressures, weight and temperature, one direction each."},
    {"contact", read_contact, .form = &contact_form,
     .help = "A rigid convex body that a face of the shell may touch; needs kinematics: "
             "nonlinear."},
    {"outputs", read_outputs, .form = &outputs_form,
     .help = "Displacements, results of contact, voltages and charges to print and to measure."},
    {"target", read_target, .form = &target_form,
     .help =
         "Shape to reach. The shape error is the weighted RMS misfit over the RMS of the "
         "target less the shape without voltages; nodes on constrained dof, which cannot move, do "
         "not count and are reported."},
    COMPARE_ROW,
    {"estimate", read_estimate, .form = &estimate_form,
     .help = "Estimate of the shape from outputs through the model, for a firmware that cannot "
             "measure the target nodes."},
    {"dynamics", read_dynamics, .form = &dynamics_form,
     .help = "Vibration, where all materials of the layers have a density: natural frequencies, "
             "and the rates at which the control loop is stable."},
    SIMULATE_ROW,
    {.key = NULL}};

/* Table of the sections that a scene file with a measured influence matrix may contain. */
static const field measured_sections[] = {
    NAME_ROWS,
    {"influence", read_influence, .required = 1, .form = &influence_form,
     .help = "Measured influence matrix in the place of a structure."},
    CONTROL_ROWS,
    {"target", read_measured_target, .form = &measured_target_form,
     .help = "Measured matrix: wanted displacement of the outputs of the matrix."},
    COMPARE_ROW,
    SIMULATE_ROW,
    {.key = NULL}};

static const form structure_form = {.type = FORM_MAP, .fields = sections};
static const form measured_form = {.type = FORM_MAP, .fields = measured_sections};
static const form *const scene_forms[] = {&structure_form, &measured_form, NULL};
const form scene_form = {.type = FORM_ANY, .any = scene_forms};

static int has_key(const field *fields, const char *key)
{
    while (fields->key && strcmp(fields->key, key) != 0)
        fields++;
    return fields->key != NULL;
}

/*
 * Refuse a scene file that contains both a measured influence matrix and sections that describe a
 * structural model, such as the mesh.
 */
static int check_sections(const tree *tree)
{
    for (int i = tree->node[tree->root].first; i; i = tree->node[i].next)
        if (has_key(sections, tree->node[i].key) && !has_key(measured_sections, tree->node[i].key))
            return tree_fault_at(tree, tree->node[i].key_at,
                                 "'%.60s' describes a structure, and 'influence' is a measured "
                                 "matrix in its place; remove one of the two",
                                 tree->node[i].key);
    return 0;
}

/* Read and check a scene with a measured influence matrix. */
static int fill_measured(reader *reader, char *error)
{
    scene *scene = reader->s;
    if (check_sections(reader->t) != 0 ||
        read_map(reader, reader->t->root, measured_sections, scene) != 0)
        return -1;
    if (scene_check_names(scene, error) != 0 || scene_check_rows(scene, error) != 0 ||
        scene_check_curves(scene, error) != 0)
        return -1;
    return scene_check_influence(scene, error);
}

static char *duplicate(const char *text)
{
    char *copy = malloc(strlen(text) + 1);
    return copy ? strcpy(copy, text) : NULL;
}

/*
 * Store in a scene the path of its file and the changes from the command line that were applied to
 * it, for error messages after reading.
 */
static int keep_origin(scene *scene, const char *path, const char *const *set, int sets)
{
    scene_origin *origin = calloc(1, sizeof *origin);
    scene->origin = origin;
    if (!origin)
        return -1;
    origin->path = duplicate(path);
    origin->set = calloc((size_t)sets + 1, sizeof *origin->set);
    if (!origin->path || !origin->set)
        return -1;
    for (; origin->sets < sets; origin->sets++) {
        origin->set[origin->sets] = duplicate(set[origin->sets]);
        if (!origin->set[origin->sets])
            return -1;
    }
    return 0;
}

/*
 * Let error messages about sections that the scene file leaves out refer to the file as a whole. A
 * section that is present gets its own position when it is read.
 */
static void set_positions(scene *scene)
{
    scene_at *const at[] = {&scene->equilibrium.at, &scene->line[0].at,     &scene->line[1].at,
                            &scene->contact.at,     &scene->limits.at,      &scene->estimate.at,
                            &scene->simulate.at,    &scene->target.what.at, &scene->influence.at,
                            &scene->at_surface,     &scene->at_layers};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++)
        at[i]->origin = scene->origin;
}

static void set_defaults(scene *scene)
{
    scene->element = element_improved;
    scene->tolerance = 0.01;
    scene->equilibrium.load_steps = 1;
    scene->equilibrium.tolerance = 1e-4;
    scene->equilibrium.extrapolated_iterations = 12;
    scene->equilibrium.linear_solves = 400;
    scene->reference_is_middle = true;
    scene->dynamics.damping = 0.005;
    scene->dynamics.modes = 30;
    scene->safety.timeout = 100;
    scene->safety.ramp_ticks = 50;
    scene->limits.lower = -HUGE_VAL;
    scene->limits.upper = scene->limits.step_limit = HUGE_VAL;
}

/*
 * Choose 6 or 7 dof of a node where the scene file does not state the number. The seventh is the
 * displacement of the middle surface relative to the faces. It is left out at large rotations if
 * plies thicken freely (element option lin33): it then has no effect and could lose its stiffness.
 * A support that names it keeps it.
 */
static void choose_dof_per_node(scene *scene, const tree *tree)
{
    const unsigned seventh = 64, normal = 4 | 32;
    bool is_named = tree_find(tree, tree->root, "dof_per_node") != 0;
    for (int i = 0; i < scene->supports; i++)
        is_named |= scene->support[i].fix & seventh && !(scene->support[i].fix & normal);
    if (!is_named && scene->element.lin33 && scene->kinematics != KINEMATICS_LINEAR)
        scene->element.dof_per_node = 6;
}

static int fill(scene *scene, tree *tree, char *error)
{
    const scene_at whole = {.line = 0};
    reader reader;
    reader.t = tree;
    reader.s = scene;
    reader.of = OF_NOTHING;
    if (keep_origin(scene, tree->path, tree->set, tree->sets) != 0)
        return tree_fault_at(tree, whole, "out of memory");
    scene->hash = tree->hash;
    set_defaults(scene);
    set_positions(scene);
    if (tree->node[tree->root].kind == TREE_MAP && tree_find(tree, tree->root, "influence"))
        return fill_measured(&reader, error);
    if (read_map(&reader, tree->root, sections, scene) != 0)
        return -1;
    choose_dof_per_node(scene, tree);
    return scene_check(scene, error);
}

/*
 * Fill a scene from a YAML tree and release the tree; `status` tells whether the tree was read
 * without errors.
 */
static int take_tree(scene *scene, tree *tree, int status, char *error)
{
    memset(scene, 0, sizeof *scene);
    if (status == 0)
        status = fill(scene, tree, error);
    tree_free(tree);
    if (status != 0)
        scene_free(scene);
    return status;
}

int scene_read(scene *scene, const char *path, const char *const *set, int sets, char *error)
{
    tree tree;
    const int status = tree_read(&tree, path, set, sets, error);
    return take_tree(scene, &tree, status, error);
}

int scene_read_text(scene *scene, const char *path, const char *text, size_t bytes, char *error)
{
    tree tree;
    const int status = tree_read_text(&tree, path, text, bytes, error);
    return take_tree(scene, &tree, status, error);
}
