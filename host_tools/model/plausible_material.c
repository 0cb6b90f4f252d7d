/* SPDX-License-Identifier: BSD-2-Clause */
/* Plausibility rules on the constants of materials and layers (plausible_parts.h). */
#include "plausible_parts.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include "../scene/scene_units.h"

/* ---- units ------------------------------------------------------------ */

static const units_unit modulus_unit = {{-2, 1, 0, 0, 0, 0}, 0, 0};
static const units_unit density_unit = {{-4, 1, 0, 0, 2, 0}, 0, 0};
static const units_unit piezo_unit = {{1, 0, -1, 0, 0, 0}, 0, 0};
static const units_unit permittivity_unit = {{0, 1, -2, 0, 0, 0}, 0, 0};
static const units_unit pyroelectric_unit = {{-1, 1, -1, -1, 0, 0}, 0, 0};
static const units_unit expansion_unit = {{0, 0, 0, -1, 0, 0}, 0, 0};
static const units_unit length_unit = {{1, 0, 0, 0, 0, 0}, 0, 0};

double plausible_si(const scene *scene, double value, const units_unit *unit)
{
    int ten;
    return scene_units_ten(scene, unit, &ten) < 0 ? value * pow(10, -ten) : (double)NAN;
}

/* ---- constants of materials and layers -------------------------------- */

enum { MODULI = 6, CONSTANTS = 5, AXES = 3 };

static int is_isotropic(const scene_material *material)
{
    const int is_cubic = material->e[0] == material->e[1] && material->e[1] == material->e[2] &&
                         material->g12 == material->g13 && material->g13 == material->g23 &&
                         material->nu12 == material->nu13 && material->nu13 == material->nu23;
    return is_cubic && material->g12 == material->e[0] / (2 * (1 + material->nu12));
}

/*
 * Measure the Young's moduli and shear moduli of a material. The shear modulus of an isotropic
 * material is left out, because it follows from Young's modulus.
 */
int measure_modulus(const subject *of, int k, measured *found)
{
    static const char *const name[MODULI] = {"E1", "E2", "E3", "G12", "G13", "G23"};
    const scene *scene = of->scene;
    if (k >= MODULI * scene->materials)
        return 0;
    const scene_material *material = &scene->material[k / MODULI];
    const double value[MODULI] = {material->e[0], material->e[1], material->e[2],
                                  material->g12,  material->g13,  material->g23};
    const int isotropic = is_isotropic(material);
    const int i = k % MODULI;
    if (isotropic && i > 0)
        return 1;
    found->value = plausible_si(scene, value[i], &modulus_unit);
    found->at = material->at;
    snprintf(found->what, WHAT, "%s of material '%s', %g in the scene's units",
             isotropic ? "E" : name[i], material->name, value[i]);
    return 1;
}

/*
 * Copy one constant of the material with index k into `found`, for a plausibility rule that
 * compares it with usual values. Returns whether there is a material k.
 *   name, unit in  name and physical dimension of the constant
 *   constant   in  offset of the constant, a double, in scene_material
 */
static int measure_constant(const subject *of, int k, const char *name, size_t constant,
                            const units_unit *unit, measured *found)
{
    const scene *scene = of->scene;
    if (k >= scene->materials)
        return 0;
    const scene_material *material = &scene->material[k];
    double value;
    memcpy(&value, (const char *)material + constant, sizeof value);
    if (fabs(value) > 0)
        found->value = plausible_si(scene, fabs(value), unit);
    found->at = material->at;
    snprintf(found->what, WHAT, "%s of material '%s', %g in the scene's units", name,
             material->name, fabs(value));
    return 1;
}

int measure_density(const subject *of, int k, measured *found)
{
    return measure_constant(of, k, "density", offsetof(scene_material, density), &density_unit,
                            found);
}

/* Measure the permittivity of a material. No permittivity is smaller than that of vacuum. */
int measure_permittivity(const subject *of, int k, measured *found)
{
    return measure_constant(of, k, "permittivity", offsetof(scene_material, permittivity),
                            &permittivity_unit, found);
}

/* Measure the absolute pyroelectric constant of a material. */
int measure_pyroelectric(const subject *of, int k, measured *found)
{
    return measure_constant(of, k, "|pyroelectric|", offsetof(scene_material, pyroelectric),
                            &pyroelectric_unit, found);
}

/* Return the largest Young's modulus of a material (Pa). */
static double stiffest(const scene *scene, const scene_material *material)
{
    const double most = fmax(material->e[0], fmax(material->e[1], material->e[2]));
    return plausible_si(scene, most, &modulus_unit);
}

/*
 * Measure the density of a material whose Young's modulus exceeds 1 GPa. Softer materials are left
 * out, because foams may have lower densities.
 */
int measure_light_material(const subject *of, int k, measured *found)
{
    if (!measure_density(of, k, found))
        return 0;
    if (!(stiffest(of->scene, &of->scene->material[k]) > 1e9))
        found->value = (double)NAN;
    return 1;
}

/*
 * Measure the piezoelectric strain constants of a material. Stress constants are divided by the
 * largest Young's modulus, which gives numbers of similar size.
 */
int measure_piezo(const subject *of, int k, measured *found)
{
    static const char *const name[CONSTANTS] = {"31", "32", "33", "24", "15"};
    const scene *scene = of->scene;
    if (k >= CONSTANTS * scene->materials)
        return 0;
    const scene_material *material = &scene->material[k / CONSTANTS];
    const double constant[CONSTANTS] = {material->d31, material->d32, material->d33, material->d24,
                                        material->d15};
    const double stiff = fmax(material->e[0], fmax(material->e[1], material->e[2]));
    const int i = k % CONSTANTS;
    const double value = material->has_e ? material->piezo_e[i] / stiff : constant[i];
    if (value != 0)
        found->value = plausible_si(scene, fabs(value), &piezo_unit);
    found->at = material->at;
    const char *format = material->has_e ? "|e%s/E| of material '%s', %g in the scene's units"
                                         : "|d%s| of material '%s', %g in the scene's units";
    snprintf(found->what, WHAT, format, name[i], material->name, fabs(value));
    return 1;
}

/* Absolute thermal expansion coefficients of a material along its axes 1, 2 and 3. */
int measure_expansion(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    if (k >= AXES * scene->materials)
        return 0;
    const scene_material *material = &scene->material[k / AXES];
    const double alpha = fabs(material->alpha[k % AXES]);
    found->value = plausible_si(scene, alpha, &expansion_unit);
    found->at = material->at;
    snprintf(found->what, WHAT, "|alpha| of material '%s' along one of its axes, %g per kelvin",
             material->name, alpha);
    return 1;
}

/* ---- constants of a material compared with each other ----------------- */

/*
 * Return the speed of longitudinal waves in a material, sqrt(E/density) with the largest Young's
 * modulus E (m/s). In solids the speed lies between 20 m/s (soft rubber) and 17,500 m/s (diamond).
 * NAN without a density.
 */
static double wave_speed(const scene *scene, const scene_material *material)
{
    const double density = plausible_si(scene, material->density, &density_unit);
    return density > 0 ? sqrt(stiffest(scene, material) / density) : (double)NAN;
}

static int has_material(const subject *of, int k, measured *found)
{
    if (k >= of->scene->materials)
        return 0;
    found->at = of->scene->material[k].at;
    return 1;
}

static void describe_speed(const scene_material *material, const char *which, measured *found)
{
    snprintf(found->what, WHAT, "speed of sound sqrt(E/density) in %smaterial '%s'", which,
             material->name);
}

int measure_wave_speed(const subject *of, int k, measured *found)
{
    if (!has_material(of, k, found))
        return 0;
    const scene_material *material = &of->scene->material[k];
    found->value = wave_speed(of->scene, material);
    describe_speed(material, "", found);
    return 1;
}

/*
 * Measure the speed of sound in a material that is denser than filled polymers. Such a material is
 * a metal, a glass or a ceramic, in which sound is fast.
 */
int measure_dense_wave_speed(const subject *of, int k, measured *found)
{
    static const double densest_polymer = 2150; /* largest density of a filled polymer (kg/m3); a
                                                   denser material is a metal, glass or ceramic */
    if (!has_material(of, k, found))
        return 0;
    const scene_material *material = &of->scene->material[k];
    if (plausible_si(of->scene, material->density, &density_unit) > densest_polymer)
        found->value = wave_speed(of->scene, material);
    describe_speed(material, "the dense ", found);
    return 1;
}

/*
 * Measure the speed of sound along the fibres of a ply. A material counts as a ply if it is denser
 * than wood and at least three times as stiff along direction 1 as along direction 2.
 */
int measure_ply_wave_speed(const subject *of, int k, measured *found)
{
    static const double densest_wood = 1000; /* largest density of wood (kg/m3); a denser material
                                                may be a ply with fibres */
    if (!has_material(of, k, found))
        return 0;
    const scene_material *material = &of->scene->material[k];
    if (material->e[0] >= 3 * material->e[1] &&
        plausible_si(of->scene, material->density, &density_unit) > densest_wood)
        found->value = wave_speed(of->scene, material);
    describe_speed(material, "the ply ", found);
    return 1;
}

/*
 * Return the largest piezoelectric strain constant of a material (m/V), from d31, d32, d33, d24 and
 * d15, or from the stress constants divided by the largest Young's modulus.
 */
static double strongest_piezo(const scene *scene, const scene_material *material)
{
    const double most = fmax(material->e[0], fmax(material->e[1], material->e[2]));
    const double constant[CONSTANTS] = {material->d31, material->d32, material->d33, material->d24,
                                        material->d15};
    double strongest = 0;
    for (int i = 0; i < CONSTANTS; i++)
        strongest =
            fmax(strongest, fabs(material->has_e ? material->piezo_e[i] / most : constant[i]));
    return plausible_si(scene, strongest, &piezo_unit);
}

/*
 * Measure the largest piezoelectric strain constant of a material times the square root of its
 * largest Young's modulus: the electromechanical coupling factor times the square root of the
 * permittivity. From quartz and PVDF to single crystals it varies by little more than a factor of
 * 100.
 */
int measure_piezo_coupling(const subject *of, int k, measured *found)
{
    if (!has_material(of, k, found))
        return 0;
    const scene_material *material = &of->scene->material[k];
    const double strongest = strongest_piezo(of->scene, material);
    if (strongest > 0)
        found->value = strongest * sqrt(stiffest(of->scene, material));
    snprintf(found->what, WHAT,
             "|d| sqrt(E) of material '%s', largest piezoelectric constant and modulus",
             material->name);
    return 1;
}

/*
 * Measure the largest Young's modulus of a material whose piezoelectric constants d31 and d32
 * exceed those of polymers. Such a material is a ceramic, a crystal or a composite of them.
 */
int measure_soft_piezo(const subject *of, int k, measured *found)
{
    static const double strongest_polymer = 6e-11; /* largest constant d31 of a piezoelectric
                                                      polymer (m/V); larger ones are those of
                                                      ceramics and crystals */
    if (!has_material(of, k, found))
        return 0;
    const scene_material *material = &of->scene->material[k];
    const double across = fmax(fabs(material->d31), fabs(material->d32));
    if (material->has_d && plausible_si(of->scene, across, &piezo_unit) > strongest_polymer)
        found->value = stiffest(of->scene, material);
    snprintf(found->what, WHAT, "E of the piezoelectric material '%s' with |d31| or |d32| %g",
             material->name, across);
    return 1;
}

/*
 * Measure the ratio of the smaller to the larger of the piezoelectric constants d31 and d32 of a
 * material, where neither is 0. In drawn polymers and crystals the two constants differ by a factor
 * of up to 50.
 */
int measure_uneven_piezo(const subject *of, int k, measured *found)
{
    if (!has_material(of, k, found))
        return 0;
    const scene_material *material = &of->scene->material[k];
    const double one = fabs(material->d31), other = fabs(material->d32);
    if (one > 0 && other > 0)
        found->value = fmin(one, other) / fmax(one, other);
    snprintf(found->what, WHAT, "smaller over larger of |d31| and |d32| of material '%s'",
             material->name);
    return 1;
}

int measure_missing_32(const subject *of, int k, measured *found)
{
    if (!has_material(of, k, found))
        return 0;
    const scene_material *material = &of->scene->material[k];
    const char letter = material->has_e ? 'e' : 'd';
    const double one = material->has_e ? material->piezo_e[0] : material->d31;
    if (material->lacks_32 && one != 0)
        found->value = 1;
    snprintf(found->what, WHAT, "constants of material '%s' that are 0 because %c31 is given alone",
             material->name, letter);
    return 1;
}

/* ---- layers ----------------------------------------------------------- */

int measure_thickness(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    if (k >= scene->layers)
        return 0;
    found->value = plausible_si(scene, scene->layer[k].thickness, &length_unit);
    found->at = scene->layer[k].at;
    snprintf(found->what, WHAT,
             "thickness of layer %d (from the inner face, the first is 0), %g in the scene's units",
             k, scene->layer[k].thickness);
    return 1;
}
