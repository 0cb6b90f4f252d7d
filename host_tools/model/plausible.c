/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Plausibility rules and their table (plausible.h). A new rule is a function that measures a
 * number, and a row of the table `rules`.
 */
#include "plausible.h"

#include <math.h>
#include <string.h>
#include "certificate_matrix.h"
#include "matrix_modes.h"
#include "plausible_parts.h"
#include "stress_summary.h"

/* ---- rules ------------------------------------------------------------ */

typedef enum subject_type {
    SUBJECT_SCENE,
    SUBJECT_MESH,
    SUBJECT_RESULT,
    SUBJECT_VOLTAGES,
    SUBJECT_OPTIMUM,
    SUBJECT_PATH,
    SUBJECT_PRESTRESS,
    SUBJECT_LOADS,
    SUBJECT_LOOP,
    SUBJECT_MATRIX,
    SUBJECT_END,
    SUBJECT_STRESS
} subject_type;

#define CHECK_UNITS                                                                                \
    "compare the number with the scene's units, or write it with a unit of its own, as "
#define COMPARE_MATERIAL                                                                           \
    "compare the units of E and density, or write them with units of their own, as 63 GPa and "    \
    "7800 kg/m3"
#define CHECK_FIELD                                                                                \
    "ceramics depolarise there; lower the voltage, thicken the layer, or give its material a "     \
    "field_limit"

static const struct rule {
    const char *name;
    subject_type of;
    measure *measure;
    double low, high; /* range in which the number that the plausibility rule measures causes no
                         warning; the lowest and the highest value belong to the range */
    const char *unit, *cure;
} rules[] = {
    {"displacement", SUBJECT_RESULT, measure_displacement, 0, 1, "times the thickness",
     "small displacements no longer hold; use kinematics: nonlinear, or auto"},
    {"strain", SUBJECT_RESULT, measure_strain, 0, 0.01, "",
     "linear constants of materials hold for small strains; check loads, voltages and units"},
    {"limit_field", SUBJECT_SCENE, measure_limit_field, 0, 1e6, "V/m", CHECK_FIELD},
    {"held_voltage", SUBJECT_SCENE, measure_held_voltage, -HUGE_VAL, 0, "",
     "limits.voltage does not move a held voltage; hold another one, or widen limits.voltage"},
    {"applied_field", SUBJECT_SCENE, measure_applied_field, 0, 1e6, "V/m", CHECK_FIELD},
    {"depolarising_voltage", SUBJECT_SCENE, measure_depolarisation, -HUGE_VAL, 1 + 1e-9,
     "times the field_limit", "the ceramic depolarises there; lower the voltage"},
    {"field_limit", SUBJECT_SCENE, measure_field_limit, 5e4, 7e8, "V/m", CHECK_UNITS "50 MV/m"},
    {"field_limit_ceramic", SUBJECT_SCENE, measure_ceramic_field_limit, 5e4, 2e7, "V/m",
     CHECK_UNITS "1 MV/m"},
    {"strength", SUBJECT_SCENE, measure_strength, 1e-5, 0.3, "", CHECK_UNITS "400 MPa"},
    {"strength_soft", SUBJECT_SCENE, measure_soft_strength, 1e-4, 30, "", CHECK_UNITS "10 MPa"},
    {"strength_ratio", SUBJECT_SCENE, measure_strength_ratio, 0.01, 100, "",
     "compare their units, or write them with units of their own, as 400 MPa"},
    {"resolution", SUBJECT_SCENE, measure_resolution, 0, 1,
     "times the size that resolves the bending there",
     "the displacement under the load may come out too small; use more elements"},
    {"irregular_mesh", SUBJECT_MESH, measure_locking, 0, 0, "elements",
     "bending is far too stiff there, free edges most of all; smooth or refine the mesh, or mesh "
     "along lines of curvature"},
    {"coarse_mesh", SUBJECT_MESH, measure_coarse, 0, 0, "elements",
     "bending is too stiff there; smooth or refine the mesh, or mesh along lines of curvature"},
    {"twisted_strip", SUBJECT_MESH, measure_strips, 0, 0, "elements",
     "displacements come out too small; use rectangles along the strip"},
    {"narrow_element", SUBJECT_MESH, measure_narrow, 0.3, 1, "of that at its centre",
     "elements that are nearly triangles are inaccurate; use others"},
    {"slenderness", SUBJECT_MESH, measure_slenderness, 1e-5, 0.5, "",
     "compare the units of the thickness with those of the surface or mesh file"},
    {"thick_curvature", SUBJECT_MESH, measure_thick_curvature, 0, 0.2, "",
     "a shell theory leaves out stresses of this order there; compare with a solid model"},
    {"file_slenderness", SUBJECT_MESH, measure_file_slenderness, 1e-4, 0.5, "",
     "compare the unit of the places in the file with that of the scene: write mesh: {unit: mm}, "
     "or the points of the surface in units.length"},
    {"points_height", SUBJECT_MESH, measure_points_height, 0, 3, "",
     "write x, y and z of the points in the scene's unit of length"},
    {"uniform_shear", SUBJECT_MESH, measure_shear, -HUGE_VAL, 0.05, "",
     "the laminate comes out too stiff; use element: {shear: equilibrium}"},
    {"faces", SUBJECT_MESH, measure_faces, 0, 0.05, "",
     "the faces of the sandwich bend by themselves, which the element cannot represent; the "
     "displacement comes out too large"},
    {"held_spring", SUBJECT_MESH, measure_held_spring, 0, 0, "springs",
     "supports hold their ends, so that they carry nothing; remove one of the two"},
    {"long_spring", SUBJECT_MESH, measure_long_spring, 0, 2, "times the numbers without them",
     "the factor takes more memory and time; join nearer nodes"},
    {"small_electrode", SUBJECT_SCENE, measure_electrode, 2, HUGE_VAL, "elements",
     "the electrode is smeared over the elements that it cuts; use smaller elements or a larger "
     "electrode, and compare its unit with that of the surface"},
    {"path", SUBJECT_PATH, measure_path, 0, 0.01, "of the displacement",
     "which equilibrium a structure takes depends on the way of loading; follow it with --path"},
    {"path_end", SUBJECT_PATH, measure_path_end, 1, HUGE_VAL, "of it",
     "which equilibrium a structure takes depends on the way of loading; follow it with --path"},
    {"stability", SUBJECT_PATH, measure_stability, 0, 0, "negative pivots",
     "a structure leaves an unstable equilibrium; use another mesh or more load steps, or follow "
     "the load path with --path"},
    {"found_field", SUBJECT_VOLTAGES, measure_found_field, 0, 1e6, "V/m", CHECK_FIELD},
    {"zero_target", SUBJECT_OPTIMUM, measure_target, 1e-9, HUGE_VAL, "of the target",
     "there is nothing to correct: the target is 0, or a sum of the free functions"},
    {"unreached_target", SUBJECT_OPTIMUM, measure_unreached, 0, 0.9, "of the target",
     "the voltages reach little of it; compare the units of target, limits and structure or "
     "matrix"},
    {"sensor_range", SUBJECT_OPTIMUM, measure_range, 0, 1, "",
     "the loop takes larger readings as missing, and never sees the target reached; write the "
     "range of the sensor in units.length"},
    {"idle_voltages", SUBJECT_OPTIMUM, measure_idle, 1e-4, HUGE_VAL, "times the limit",
     "the target needs almost no voltage; compare the units of target, limits and structure or "
     "matrix"},
    {"dependent_voltages", SUBJECT_OPTIMUM, measure_dependent, 0, 0, "amplifiers",
     "the voltages are not unique, and rounding decides which are found; write regularisation: "
     "{relative: 1e-6}"},
    {"modulus", SUBJECT_SCENE, measure_modulus, 1e5, 2e12, "Pa", CHECK_UNITS "210 GPa"},
    {"density", SUBJECT_SCENE, measure_density, 1, 3e4, "kg/m3", CHECK_UNITS "7800 kg/m3"},
    {"light_material", SUBJECT_SCENE, measure_light_material, 100, HUGE_VAL, "kg/m3",
     CHECK_UNITS "7800 kg/m3"},
    {"piezo_constant", SUBJECT_SCENE, measure_piezo, 1e-13, 1e-8, "m/V", CHECK_UNITS "-210 pm/V"},
    {"permittivity", SUBJECT_SCENE, measure_permittivity, 8.8e-12, 1e-6, "F/m",
     CHECK_UNITS "15 nF/m"},
    {"pyroelectric", SUBJECT_SCENE, measure_pyroelectric, 0, 1e-2, "C/(m2 K)",
     CHECK_UNITS "-300 uC/(m2 K)"},
    {"expansion", SUBJECT_SCENE, measure_expansion, 0, 1e-3, "1/K",
     "no solid expands so much; write the number per kelvin, as 12e-6 for steel"},
    {"wave_speed", SUBJECT_SCENE, measure_wave_speed, 10, 2.5e4, "m/s", COMPARE_MATERIAL},
    {"wave_speed_dense", SUBJECT_SCENE, measure_dense_wave_speed, 380, HUGE_VAL, "m/s",
     COMPARE_MATERIAL},
    {"wave_speed_ply", SUBJECT_SCENE, measure_ply_wave_speed, 500, HUGE_VAL, "m/s",
     COMPARE_MATERIAL},
    {"piezo_coupling", SUBJECT_SCENE, measure_piezo_coupling, 4e-7, 5e-4, "(F/m)^(1/2)",
     "compare the units of E and d, or write them with units of their own, as 63 GPa and "
     "-180 pm/V"},
    {"soft_piezo", SUBJECT_SCENE, measure_soft_piezo, 5e9, HUGE_VAL, "Pa",
     "ceramics are stiffer, and polymers have smaller constants; compare the units of E and d, or "
     "write them with units of their own, as 63 GPa and -180 pm/V"},
    {"uneven_piezo", SUBJECT_SCENE, measure_uneven_piezo, 5e-3, HUGE_VAL, "",
     "compare their units"},
    {"missing_d32", SUBJECT_SCENE, measure_missing_32, 0, 0, "constants",
     "the material then strains along its axis 1 alone; write d32 (or e32), equal to d31 in a "
     "ceramic that is poled through its thickness, or 0"},
    {"stack_stiffness", SUBJECT_SCENE, measure_stack_stiffness, 1, 1.5e10, "N/m",
     CHECK_UNITS "20 N/um"},
    {"stack_stroke", SUBJECT_SCENE, measure_stack_stroke, 1e-10, 5e-5, "m/V",
     CHECK_UNITS "80 nm/V"},
    {"stack_energy", SUBJECT_SCENE, measure_stack_energy, 1e-12, 5e-5, "J/V2",
     "no stack stores so much or so little; compare the units of its stiffness and stroke, or "
     "write them with units of their own, as 20 N/um and 80 nm/V"},
    {"coil_force", SUBJECT_SCENE, measure_coil, 1e-6, 1e3, "N/V", CHECK_UNITS "5 N/V"},
    {"repeated_stack", SUBJECT_MESH, measure_repeated_stack, 0, 0, "stacks",
     "their voltages are not unique; move them, or remove all but one"},
    {"thickness", SUBJECT_SCENE, measure_thickness, 1e-7, 1, "m", CHECK_UNITS "0.3 mm"},
    {"sharp_edge", SUBJECT_SCENE, measure_sharp_edge, 0, 40, "degrees",
     "the two sides share one mean director there; smaller elements at the edge reduce the error"},
    {"distant_place", SUBJECT_SCENE, measure_place, 0, 0.1, "of the diagonal of an element",
     "write the coordinates of a node, or put the point into the mesh (in Gmsh Point{n} In "
     "Surface{m};)"},
    {"slit", SUBJECT_SCENE, measure_slit, 0, 0, "pairs",
     "the surface is open there; where it should not be, mesh with Coherence;"},
    {"influence", SUBJECT_SCENE, measure_matrix_entry, 1e-12, 1e-5, "m/V",
     "compare the matrix with units.length, or write influence.scale, as 1e-6 for micrometres in a "
     "scene in metres"},
    {"influence_shape", SUBJECT_SCENE, measure_matrix_shape, 0, 1, "",
     "the voltages are not unique; if the rows of the file are actuators, write rows: actuators"},
    {"dead_actuator", SUBJECT_SCENE, measure_dead_column, MATRIX_DEAD, HUGE_VAL, "",
     "hold it, as each: [{actuator: NAME, hold: 0}] in limits, or measure it again"},
    {"weak_actuator", SUBJECT_SCENE, measure_weak_column, MATRIX_WEAK, HUGE_VAL, "",
     "a column of noise alone is that of a dead actuator: hold it, as each: [{actuator: NAME, "
     "hold: 0}] in limits, or measure it again"},
    {"surface_points", SUBJECT_SCENE, measure_surface_misfit, 0, 1, "times the thickness",
     "remove the point if it is wrong, keep one of two points at one place, or write more cells"},
    {"damping", SUBJECT_SCENE, measure_damping, 1e-6, 0.1, "",
     "structures have 0.0005 to 0.05; it is a part of critical damping: write 0.01 for 1 %"},
    {"readings_age", SUBJECT_LOOP, measure_age, 1, HUGE_VAL, "ticks",
     "readings one tick older can make the loop swing without end; measure the age, converters and "
     "filters included, and write the largest, or ask for control: {delay_margin: 1}; the "
     "supervisor, unless left out by safety: none, parks the voltages of a loop that swings"},
    {"matrix_errors", SUBJECT_MATRIX, measure_matrix_errors, CERTIFICATE_MATRIX_BAR, HUGE_VAL, "",
     "noise and drift of a measurement can make the voltages grow; write this regularisation, or "
     "average more measurements and state their errors in influence.scatter"},
    {"model_errors", SUBJECT_MATRIX, measure_model_errors, CERTIFICATE_MODEL_BAR, HUGE_VAL, "",
     "few structures agree with a model so well, and the voltages may grow; write this "
     "regularisation, or measure the matrix"},
    {"diverged", SUBJECT_END, measure_divergence, 0, PLAUSIBLE_DIVERGENCE,
     "times that without voltages",
     "the loop is unstable on this plant; compare plant and events with the margins that `pzs "
     "check` prints, also that against errors of the influence matrix"},
    {"sensor_noise", SUBJECT_LOOP, measure_noise, 0, 0.3, "times the target",
     "readings then tell little of the shape, and the supervisor takes as much for healthy; "
     "compare the number with units.length"},
    {"no_voltage_limits", SUBJECT_SCENE, measure_missing_limits, 0, 0, "amplifiers",
     "the loop may ask for any voltage; write limits: {voltage: [-200, 200]}, which no voltage of "
     "the device exceeds"},
    {"selftest_hysteresis", SUBJECT_SCENE, measure_tested_hysteresis, 0, 0.25,
     "of the voltage range",
     "the ceramic hardly follows the small pulses of the self-test, which then calls healthy "
     "amplifiers silent; leave the self-test out"},
    {"loop_amplitude", SUBJECT_LOOP, measure_amplitude, 0, 1.01, "thicknesses",
     "the loop is certified on a linear structure about the undeformed shape, and larger "
     "deformations change its response and its modes; write kinematics: nonlinear, with which it "
     "is certified about the target, too, and simulate: {influence: target}"},
    {"loop_amplitude_certified", SUBJECT_LOOP, measure_amplitude_certified, 0, 2.01, "thicknesses",
     "with tables of the undeformed shape such a loop may settle slowly and far from the best "
     "shape; write simulate: {influence: target}, and simulate it"},
    {"loop_amplitude_at_target", SUBJECT_LOOP, measure_amplitude_at_target, 0, 3.01, "thicknesses",
     "the loop is certified on the linear modes of the undeformed shape, and larger deformations "
     "change them; simulate the loop with kinematics: nonlinear"},
    {"prestress", SUBJECT_PRESTRESS, measure_prestress, 0.95, 1.05, "of that without loads",
     "modes, influence matrix and certificate of the unloaded structure do not hold; write "
     "kinematics: nonlinear, and for a control loop simulate: {influence: loaded}, with which they "
     "belong to the equilibrium under the loads"},
    {"sudden_loads", SUBJECT_LOADS, measure_sudden_loads, 0, 0.3, "of that",
     "the supervisor tolerates the loads of the scene at once, and may raise no alarm where "
     "amplifiers are reversed or fail; write only loads that can appear suddenly, or use stronger "
     "amplifiers"},
    {"shell_theory", SUBJECT_STRESS, measure_theory, 0, 0.02, "",
     "the theory of the elements simplifies these stresses; use element: {shear: equilibrium}, or "
     "compare with a solid model"},
    {"bent_sections", SUBJECT_STRESS, measure_bend, 0, 1.0 / 3, "",
     "the plies bend by themselves, and stresses and displacement are rough; compare with a solid "
     "model"},
    {"stress_reserve", SUBJECT_STRESS, measure_reserve, 1, HUGE_VAL, "",
     "the strength is exceeded there; lower loads or voltages, or thicken the layer"},
    {"strong_actuator", SUBJECT_SCENE, measure_strong_column, 0, 100, "",
     "a column of coordinates is no actuator: name it x, y or z; or measure the actuator again"},
    {"repeated_actuator", SUBJECT_SCENE, measure_repeated_column, 1e-4, HUGE_VAL, "",
     "the two cannot be distinguished; a column may have been written twice"},
    {"modes_share", SUBJECT_SCENE, measure_modes_share, 0.5, HUGE_VAL, "",
     "compare the unit of the responses with that of the matrix, and their order with the "
     "actuators"},
    {"reversed_column", SUBJECT_SCENE, measure_reversed_column, MATRIX_REVERSED, HUGE_VAL, "",
     "one of the two has the wrong sign, and the loop would drive that actuator the wrong way: "
     "change the sign of the column or of the actuator's entries of response"},
    {"mode_share", SUBJECT_SCENE, measure_mode_share, 0, 1, "",
     "a mode cannot be larger than the whole: compare the unit of its response with the matrix, or "
     "leave out one of two modes with nearly equal shapes"},
    {"shuffled_modes", SUBJECT_SCENE, measure_shuffled_modes, 0, 0.95, "",
     "write the outputs of the shapes in the order of the matrix, or give the modes that the "
     "actuators move most"},
    {"swapped_outputs", SUBJECT_SCENE, measure_swapped_outputs, 0, MATRIX_SWAP_BAR, "",
     "write the outputs of the shapes in the order of the matrix"},
};

/*
 * Return whether a measured number is already the subject of a stored warning: one of the same
 * plausibility rule, position in the scene file and value.
 */
static int is_repeated(const plausible_warning *warning, const struct rule *rule,
                       const measured *found)
{
    return strcmp(warning->rule, rule->name) == 0 && warning->at.line == found->at.line &&
           warning->at.column == found->at.column && warning->value == found->value;
}

/*
 * Return the entry of the list of warnings for a new plausibility warning: the warning that the
 * same rule gave on an earlier result, or the next free entry. NULL if the stored warning is at
 * least as severe, or if the list is full.
 */
static plausible_warning *warning_entry(plausible *warnings, const struct rule *rule,
                                        const measured *found)
{
    for (int i = 0; i < warnings->count; i++) {
        if (is_repeated(&warnings->warning[i], rule, found))
            return NULL;
        if (rule->of == SUBJECT_RESULT && strcmp(warnings->warning[i].rule, rule->name) == 0)
            return found->value > warnings->warning[i].value ? &warnings->warning[i] : NULL;
    }
    if (warnings->count == PLAUSIBLE_MOST) {
        warnings->dropped++;
        return NULL;
    }
    return &warnings->warning[warnings->count++];
}

static void warn(plausible *warnings, const struct rule *rule, const measured *found)
{
    const int is_above = found->value > rule->high;
    plausible_warning *warning = warning_entry(warnings, rule, found);
    if (!warning)
        return;
    warning->rule = rule->name;
    warning->value = found->value;
    warning->limit = is_above ? rule->high : rule->low;
    warning->unit = rule->unit;
    warning->at = found->at;
    const char *space = *rule->unit ? " " : "";
    const char *side = is_above ? "above" : "below";
    scene_fault(found->at, warning->text, "%s: %.4g%s%s, %s %g; %s", found->what, found->value,
                space, rule->unit, side, warning->limit, rule->cure);
}

static void apply(plausible *warnings, const struct rule *rule, const subject *of)
{
    measured found;
    for (int k = 0;; k++) {
        memset(&found, 0, sizeof found);
        found.at.origin = of->scene->origin;
        found.value = (double)NAN;
        if (!rule->measure(of, k, &found))
            return;
        if (found.value > rule->high || found.value < rule->low)
            warn(warnings, rule, &found);
    }
}

static void apply_all(plausible *warnings, subject_type type, const subject *of)
{
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (rules[i].of == type)
            apply(warnings, &rules[i], of);
}

void plausible_scene(plausible *warnings, const scene *scene)
{
    const subject of = {.scene = scene, .name = ""};
    apply_all(warnings, SUBJECT_SCENE, &of);
}

void plausible_mesh(plausible *warnings, const mesh *mesh)
{
    const subject of = {.scene = mesh->scene, .mesh = mesh, .name = ""};
    if (mesh->elements > 0)
        apply_all(warnings, SUBJECT_MESH, &of);
}

void plausible_result(plausible *warnings, const mesh *mesh, const double *displacement,
                      int is_linear, const char *name)
{
    if (mesh->elements == 0)
        return; /* a scene with a measured influence matrix has no elements, and thus no thickness
                   or strain that a rule could check */
    const subject of = {.scene = mesh->scene,
                        .mesh = mesh,
                        .displacement = displacement,
                        .is_linear = is_linear,
                        .name = name};
    apply_all(warnings, SUBJECT_RESULT, &of);
}

void plausible_voltages(plausible *warnings, const scene *scene, const double *voltage,
                        const char *name)
{
    const subject of = {.scene = scene, .voltage = voltage, .name = name};
    apply_all(warnings, SUBJECT_VOLTAGES, &of);
}

void plausible_target(plausible *warnings, const scene *scene, const plausible_optimum *optimum)
{
    const subject of = {.scene = scene, .name = "", .optimum = optimum};
    apply_all(warnings, SUBJECT_OPTIMUM, &of);
}

void plausible_path(plausible *warnings, const scene *scene, double difference, double load_factor,
                    unsigned negative_pivots)
{
    const subject of = {.scene = scene,
                        .name = "",
                        .path_difference = difference,
                        .load_factor = load_factor,
                        .negative_pivots = negative_pivots};
    apply_all(warnings, SUBJECT_PATH, &of);
}

void plausible_prestress(plausible *warnings, const scene *scene, double unloaded, double loaded)
{
    const subject of = {.scene = scene, .name = "", .unloaded = unloaded, .loaded = loaded};
    apply_all(warnings, SUBJECT_PRESTRESS, &of);
}

void plausible_loads(plausible *warnings, const scene *scene, double load, double reach)
{
    const subject of = {.scene = scene, .name = "", .load = load, .reach = reach};
    apply_all(warnings, SUBJECT_LOADS, &of);
}

void plausible_loop(plausible *warnings, const scene *scene, int older, double amplitude,
                    double noise)
{
    const subject of = {
        .scene = scene, .name = "", .older = older, .amplitude = amplitude, .noise = noise};
    apply_all(warnings, SUBJECT_LOOP, &of);
}

void plausible_matrix_errors(plausible *warnings, const scene *scene, double margin,
                             const char *cure)
{
    const subject of = {.scene = scene, .name = "", .margin = margin, .cure = cure};
    apply_all(warnings, SUBJECT_MATRIX, &of);
}

void plausible_end(plausible *warnings, const scene *scene, double error, double ratio)
{
    const subject of = {.scene = scene, .name = "", .end_error = error, .divergence = ratio};
    apply_all(warnings, SUBJECT_END, &of);
}

void plausible_stress(plausible *warnings, const stress_field *field)
{
    stress_summary extremes;
    stress_summarise(field, &extremes);
    const subject of = {.scene = field->state.design->mesh.scene,
                        .mesh = &field->state.design->mesh,
                        .name = "",
                        .stress = field,
                        .extremes = &extremes};
    apply_all(warnings, SUBJECT_STRESS, &of);
}

/* ---- output ----------------------------------------------------------- */

void plausible_print(FILE *file, const plausible *warnings)
{
    if (warnings->count == 0)
        return;
    fprintf(file, "\nWarnings:\n");
    for (int i = 0; i < warnings->count; i++)
        fprintf(file, "  %s: %s\n", warnings->warning[i].rule, warnings->warning[i].text);
    if (warnings->dropped > 0)
        fprintf(file, "  and %d more\n", warnings->dropped);
}

void plausible_json(json *json, const plausible *warnings)
{
    json_open(json, "warnings", '[');
    for (int i = 0; i < warnings->count; i++) {
        const plausible_warning *warning = &warnings->warning[i];
        json_open(json, NULL, '{');
        json_string(json, "rule", warning->rule);
        json_number(json, "value", warning->value);
        json_number(json, "limit", warning->limit);
        json_string(json, "unit", warning->unit);
        json_number(json, "line", warning->at.line);
        json_number(json, "column", warning->at.column);
        json_string(json, "text", warning->text);
        json_close(json, '}');
    }
    json_close(json, ']');
}
