/* SPDX-License-Identifier: BSD-2-Clause */
/* Plausibility rules on depolarisation fields and strengths (plausible_parts.h). */
#include "plausible_parts.h"

#include <math.h>
#include <stdio.h>
#include "stress_summary.h"

static const units_unit field_unit = {{-1, 0, 1, 0, 0, 0}, 0, 0};
static const units_unit piezo_unit = {{1, 0, -1, 0, 0, 0}, 0, 0};

static const units_unit modulus_unit = {{-2, 1, 0, 0, 0, 0}, 0, 0};

/* ---- depolarisation fields -------------------------------------------- */

/*
 * Whether the transverse piezoelectric strain constants (d31 and d32, or e31 and e32 over the
 * largest modulus) exceed those of all polymers and nitrides. This is so in piezoelectric ceramics,
 * relaxor crystals and fibre composites.
 */
static bool is_strong(const scene *scene, const scene_material *material)
{
    static const double strongest_polymer = 6e-11; /* largest transverse piezoelectric strain
                                                      constant of a polymer (m/V) */
    const double stiff = fmax(material->e[0], fmax(material->e[1], material->e[2]));
    const double strain = fmax(fabs(material->d31), fabs(material->d32));
    const double stress = fmax(fabs(material->piezo_e[0]), fabs(material->piezo_e[1]));
    const double constant = material->has_e ? stress / stiff : strain;
    return plausible_si(scene, constant, &piezo_unit) > strongest_polymer;
}

/*
 * Measure the depolarisation field of material k (V/m), for a plausibility rule. found->value is
 * set only if the material has such a field and the rule applies to it; otherwise it stays NAN.
 *   wants_strong in  true: the rule applies to materials with large transverse piezoelectric
 *       constants (is_strong); false: to the others
 * Returns 0 if there is no material k, otherwise 1.
 */
static int measure_limit_of(const subject *of, int k, bool wants_strong, measured *found)
{
    const scene *scene = of->scene;
    if (k >= scene->materials)
        return 0;
    const scene_material *material = &scene->material[k];
    if (material->field_limit > 0 && is_strong(scene, material) == wants_strong)
        found->value = plausible_si(scene, material->field_limit, &field_unit);
    found->at = material->at;
    snprintf(found->what, WHAT, "field_limit of material '%s', %g in the scene's units",
             material->name, material->field_limit);
    return 1;
}

/*
 * Measure the depolarisation field of a material with small piezoelectric constants: polymers,
 * nitrides, and crystals such as lithium niobate. The plausible range follows from coercive fields:
 * lithium niobate 21 MV/m, PVDF 50 to 100 MV/m, aluminium scandium nitride up to 600 MV/m. Quartz
 * has none.
 */
int measure_field_limit(const subject *of, int k, measured *found)
{
    return measure_limit_of(of, k, false, found);
}

/*
 * Measure the depolarisation field of a material with large piezoelectric constants: ceramics,
 * relaxor crystals and fibre composites. The plausible range follows from coercive fields: barium
 * titanate 0.1 MV/m, PMN-PT 0.2 MV/m, bulk PZT 0.6 to 3 MV/m, thin films of PZT up to 10 MV/m.
 */
int measure_ceramic_field_limit(const subject *of, int k, measured *found)
{
    return measure_limit_of(of, k, true, found);
}

/*
 * Return the applied voltage of an actuator that comes closest to a critical voltage, or exceeds it
 * most: the one with the largest ratio to it. Voltages of the opposite sign have negative ratios.
 *   voltage in  critical voltage (V), not 0
 */
static double worst_voltage(const scene_actuator *actuator, double voltage)
{
    double worst = actuator->each ? actuator->each[0] : actuator->applied;
    for (int i = 1; actuator->each && i < actuator->grid[0] * actuator->grid[1]; i++)
        if (actuator->each[i] / voltage > worst / voltage)
            worst = actuator->each[i];
    return worst;
}

/*
 * Measure the applied voltage of an actuator over the voltage at which the field in its patches is
 * the depolarisation field; negative for a field along the poling. An actuator has one ratio for
 * each of its patch grids.
 */
int measure_depolarisation(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    const scene_actuator *actuator;
    const scene_drive *drive;
    if (!plausible_drive(scene, k, &actuator, &drive))
        return 0;
    const scene_layer *layer = &scene->layer[scene->patches[drive->patches].layer];
    const double most = design_depolarising_voltage(scene, drive);
    const double worst = worst_voltage(actuator, most);
    found->value = worst / most;
    found->at = actuator->at;
    snprintf(found->what, WHAT,
             "field against the poling in layer '%s' of material '%s' under %g applied to '%s'",
             layer->name, scene->material[layer->material].name, worst, actuator->name);
    return 1;
}

/* ---- strengths -------------------------------------------------------- */

/*
 * Number of strengths of a material: under tension and under compression along its axes 1 and 2,
 * and under shear in the plane of both axes.
 */
enum { STRENGTHS = 5 };

/*
 * Compute the strength of a material over the elastic modulus in the same direction, for a
 * plausibility rule, if the rule applies to the material.
 *   k          in  STRENGTHS m + i: strength i (0 to 4) of material m
 *   wants_soft in  true: the rule applies to soft materials (rubbers, foams); false: to all others;
 *       with unknown units all materials count as soft
 * Returns 0 if k is beyond the last material, otherwise 1.
 */
static int measure_strength_of(const subject *of, int k, bool wants_soft, measured *found)
{
    static const char *const name[STRENGTHS] = {"tension 1", "tension 2", "compression 1",
                                                "compression 2", "shear"};
    static const double softest_solid = 5e8; /* smallest Young's modulus of a material that is not
                                                soft (Pa) */
    const scene *scene = of->scene;
    const int i = k % STRENGTHS;
    if (k >= STRENGTHS * scene->materials)
        return 0;
    const scene_material *material = &scene->material[k / STRENGTHS];
    const scene_strength *strength = &material->strength;
    const double value[STRENGTHS] = {strength->tension[0], strength->tension[1],
                                     strength->compression[0], strength->compression[1],
                                     strength->shear};
    const double modulus = i == STRENGTHS - 1 ? material->g12 : material->e[i % 2];
    const bool is_soft = !(plausible_si(scene, modulus, &modulus_unit) > softest_solid);
    found->at = material->at;
    if (strength->given && is_soft == wants_soft)
        found->value = value[i] / modulus;
    snprintf(found->what, WHAT,
             "strength of material '%s' over its modulus (%s: %g over %g in the scene's units)",
             material->name, name[i], value[i], modulus);
    return 1;
}

/*
 * Measure the tensile strength of a material over its modulus. Usual values: bulk ceramics 5e-4,
 * soft metals and concrete 1e-4 to 1e-3, strong metals and plies 0.01, polymers 0.03, fibres and
 * silicon 0.05.
 */
int measure_strength(const subject *of, int k, measured *found)
{
    return measure_strength_of(of, k, false, found);
}

/*
 * Measure the strength of a soft material over its modulus. Usual values: foams 0.03, rubbers up to
 * 10.
 */
int measure_soft_strength(const subject *of, int k, measured *found)
{
    return measure_strength_of(of, k, true, found);
}

/*
 * Measure the strength of a material under compression over that under tension, along one axis.
 * Ceramics, glasses, concrete and stones reach 5 to 40.
 */
int measure_strength_ratio(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    if (k >= 2 * scene->materials)
        return 0;
    const scene_material *material = &scene->material[k / 2];
    const scene_strength *strength = &material->strength;
    found->at = material->at;
    if (strength->given)
        found->value = strength->compression[k % 2] / strength->tension[k % 2];
    snprintf(
        found->what, WHAT,
        "strength of material '%s' under compression over that under tension along %d, %g over "
        "%g in the scene's units",
        material->name, k % 2 + 1, strength->compression[k % 2], strength->tension[k % 2]);
    return 1;
}

/* ---- reserve factors -------------------------------------------------- */

/*
 * Find the in-plane stress component (11, 22 or 12) that is closest to its strength: alone, it has
 * the smallest reserve factor. Returns its index in the order 11 22 33 23 13 12.
 */
static int governing_component(const scene_strength *strength, const stress_point *point)
{
    static const int plane[3] = {0, 1, 5};
    double least = (double)INFINITY;
    int governing = 0;
    for (int i = 0; i < 3; i++) {
        double single[STRESS_COMPONENTS] = {0};
        single[plane[i]] = point->stress[plane[i]];
        const double reserve = stress_reserve(strength, single);
        if (!(reserve < least))
            continue;
        least = reserve;
        governing = plane[i];
    }
    return governing;
}

/* Smallest reserve factor of layer k against the strength of its material. */
int measure_reserve(const subject *of, int k, measured *found)
{
    if (k >= of->stress->layers)
        return 0;
    const scene_layer *layer = &of->scene->layer[k];
    const scene_material *material = &of->scene->material[layer->material];
    const stress_extreme *least = &of->extremes->reserve[k];
    stress_layer result;
    if (!material->strength.given || least->element < 0)
        return 1;
    stress_layer_of(of->stress, least->element, k, &result);
    const int component = governing_component(&material->strength, &result.at[least->height]);
    found->value = least->value;
    found->at = layer->at;
    snprintf(found->what, WHAT,
             "least reserve factor of '%s', layer '%s', most by stress %s (%s, %s)", material->name,
             layer->name, stress_component_name[component], stress_height_name[least->height],
             mesh_element_text(of->mesh, least->element).text);
    return 1;
}
