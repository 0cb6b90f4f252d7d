/* SPDX-License-Identifier: BSD-2-Clause */
/* Plausibility rules on depolarisation fields and strengths (plausible_parts.h). */
#include "plausible_parts.h"

#include <math.h>
#include <stdio.h>
#include "design.h"

static const units_unit field_unit = {{-1, 0, 1, 0, 0, 0}, 0, 0};
static const units_unit piezo_unit = {{1, 0, -1, 0, 0, 0}, 0, 0};

/* ---- depolarisation fields -------------------------------------------- */

/*
 * Whether the piezoelectric constants of a material across the poling exceed those of polymers and
 * nitrides, as those of ceramics, crystals and composites of them do.
 */
static bool is_strong(const scene *scene, const scene_material *material)
{
    static const double strongest_polymer = 6e-11; /* m/V */
    const double stiff = fmax(material->e[0], fmax(material->e[1], material->e[2]));
    const double strain = fmax(fabs(material->d31), fabs(material->d32));
    const double stress = fmax(fabs(material->piezo_e[0]), fabs(material->piezo_e[1]));
    const double constant = material->has_e ? stress / stiff : strain;
    return plausible_si(scene, constant, &piezo_unit) > strongest_polymer;
}

/* Depolarisation field of a material, if the material is as strong as ceramics or weaker. */
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
 * Depolarisation field of a polymer, nitride or weak crystal. Coercive fields: quartz has none,
 * lithium niobate 21 MV/m, PVDF 50 to 100 MV/m, aluminium scandium nitride up to 600 MV/m.
 */
int measure_field_limit(const subject *of, int k, measured *found)
{
    return measure_limit_of(of, k, false, found);
}

/*
 * Depolarisation field of a ceramic, strong crystal or fibre composite. Coercive fields: barium
 * titanate 0.1 MV/m, PMN-PT 0.2 MV/m, bulk PZT 0.6 to 3 MV/m, thin films of PZT up to 10 MV/m.
 */
int measure_ceramic_field_limit(const subject *of, int k, measured *found)
{
    return measure_limit_of(of, k, true, found);
}

/*
 * Applied voltage of an actuator (V) that is the largest multiple of the given voltage, which is
 * not 0; a voltage of the opposite sign counts as a negative multiple.
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
 * Applied voltage of an actuator relative to the voltage that reaches the depolarisation field in
 * the patches of one of its drives; negative where the voltage is along the poling.
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
