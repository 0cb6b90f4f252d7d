/* Plausibility of the numbers of a scene (plausible_parts.h). */
#include "plausible_parts.h"

#include <math.h>
#include <stdio.h>
#include "scene_units.h"

/* ---- units ------------------------------------------------------------ */

static const units_unit modulus_unit = {{-2, 1, 0, 0, 0, 0}, 0, 0};
static const units_unit density_unit = {{-4, 1, 0, 0, 2, 0}, 0, 0};
static const units_unit piezo_unit = {{1, 0, -1, 0, 0, 0}, 0, 0};
static const units_unit field_unit = {{-1, 0, 1, 0, 0, 0}, 0, 0};
static const units_unit length_unit = {{1, 0, 0, 0, 0, 0}, 0, 0};

/* A number of the scene in SI units, NAN where the scene's own are not known. */
static double in_si(const scene *s, double value, const units_unit *unit)
{
    int ten;
    return scene_units_ten(s, unit, &ten) < 0 ? value * pow(10, -ten) : (double)NAN;
}

/* ---- constants of materials and layers -------------------------------- */

enum { MODULI = 6, CONSTANTS = 5 };

static int is_isotropic(const scene_material *m)
{
    const int is_cubic = m->e[0] == m->e[1] && m->e[1] == m->e[2] && m->g12 == m->g13
                         && m->g13 == m->g23 && m->nu12 == m->nu13 && m->nu13 == m->nu23;
    return is_cubic && m->g12 == m->e[0] / (2 * (1 + m->nu12));
}

/* In the isotropic case the shear modulus follows from E and is not judged. */
int measure_modulus(const subject *of, int k, measured *found)
{
    static const char *const name[MODULI] = {"E1", "E2", "E3", "G12", "G13", "G23"};
    const scene *s = of->scene;
    if (k >= MODULI * s->materials)
        return 0;
    const scene_material *m = &s->material[k / MODULI];
    const double value[MODULI] = {m->e[0], m->e[1], m->e[2], m->g12, m->g13, m->g23};
    const int isotropic = is_isotropic(m);
    const int i = k % MODULI;
    if (isotropic && i > 0)
        return 1;
    found->value = in_si(s, value[i], &modulus_unit);
    found->at = m->at;
    snprintf(found->what, WHAT, "%s of material '%s', %g in the scene's units",
             isotropic ? "E" : name[i], m->name, value[i]);
    return 1;
}

int measure_density(const subject *of, int k, measured *found)
{
    const scene *s = of->scene;
    if (k >= s->materials)
        return 0;
    const scene_material *m = &s->material[k];
    if (m->density > 0)
        found->value = in_si(s, m->density, &density_unit);
    found->at = m->at;
    snprintf(found->what, WHAT, "density of material '%s', %g in the scene's units", m->name,
             m->density);
    return 1;
}

/* Strain constants, or stress constants over the largest modulus, which are about as large. */
int measure_piezo(const subject *of, int k, measured *found)
{
    static const char *const name[CONSTANTS] = {"31", "32", "33", "24", "15"};
    const scene *s = of->scene;
    if (k >= CONSTANTS * s->materials)
        return 0;
    const scene_material *m = &s->material[k / CONSTANTS];
    const double d[CONSTANTS] = {m->d31, m->d32, m->d33, m->d24, m->d15};
    const double stiff = fmax(m->e[0], fmax(m->e[1], m->e[2]));
    const int i = k % CONSTANTS;
    const double value = m->has_e ? m->piezo_e[i] / stiff : d[i];
    if (value != 0)
        found->value = in_si(s, fabs(value), &piezo_unit);
    found->at = m->at;
    snprintf(found->what, WHAT, "|%s%s%s| of material '%s', %g in the scene's units",
             m->has_e ? "e" : "d", name[i], m->has_e ? "/E" : "", m->name, fabs(value));
    return 1;
}

int measure_thickness(const subject *of, int k, measured *found)
{
    const scene *s = of->scene;
    if (k >= s->layers)
        return 0;
    found->value = in_si(s, s->layer[k].thickness, &length_unit);
    found->at = s->layer[k].at;
    snprintf(found->what, WHAT,
             "thickness of layer %d (from the inner face, the first is 0), %g in the scene's units",
             k, s->layer[k].thickness);
    return 1;
}

/* ---- electric fields -------------------------------------------------- */

/* The k-th pair of an actuator of voltages and a grid of patches that it drives; returns 0 where
 * there is none. */
int plausible_drive(const scene *s, int k, const scene_actuator **actuator,
                    const scene_drive **drive)
{
    for (int i = 0; i < s->actuators; i++) {
        *actuator = &s->actuator[i];
        if (k < s->actuator[i].drives) {
            *drive = &s->actuator[i].drive[k];
            return 1;
        }
        k -= s->actuator[i].drives;
    }
    return 0;
}

/* Largest voltage that the scene's limits allow an amplifier, without its sign; its own limits go
 * before the common ones. */
static double allowed(const scene *s, int amplifier)
{
    double most = fmax(fabs(s->limits.lower), fabs(s->limits.upper));
    for (int i = 0; i < s->limits.each_count; i++) {
        const scene_limit *own = &s->limits.each[i];
        if (amplifier >= own->first && amplifier < own->first + own->count)
            most = fmax(fabs(own->lower), fabs(own->upper));
    }
    return most;
}

/* The largest of a property of the amplifiers of an actuator: of volt, or where it is NULL what
 * their limits allow. */
double plausible_voltage(const scene *s, const scene_actuator *a, const double *volt)
{
    double most = 0;
    for (int k = a->first; k < a->first + a->grid[0] * a->grid[1]; k++)
        most = fmax(most, volt ? fabs(volt[k]) : allowed(s, k));
    return most;
}

/* Field of a voltage in the layer of a drive; none where the material has a limit of its own, which
 * the design keeps. */
void plausible_field(const scene *s, const scene_drive *drive, double voltage, measured *found)
{
    const scene_layer *layer = &s->layer[s->patches[drive->patches].layer];
    const scene_material *m = &s->material[layer->material];
    if (m->field_limit > 0 || !isfinite(voltage))
        return;
    found->value = in_si(s, fabs(voltage * drive->factor) / layer->thickness, &field_unit);
}

int measure_limit_field(const subject *of, int k, measured *found)
{
    const scene_actuator *a;
    const scene_drive *drive;
    if (!plausible_drive(of->scene, k, &a, &drive))
        return 0;
    const double voltage = plausible_voltage(of->scene, a, NULL);
    plausible_field(of->scene, drive, voltage, found);
    found->at = of->scene->limits.at;
    snprintf(found->what, WHAT, "electric field in patches '%s' at the voltage limit %g of '%s'",
             of->scene->patches[drive->patches].name, voltage, a->name);
    return 1;
}

int measure_applied_field(const subject *of, int k, measured *found)
{
    const scene_actuator *a;
    const scene_drive *drive;
    if (!plausible_drive(of->scene, k, &a, &drive))
        return 0;
    plausible_field(of->scene, drive, a->applied, found);
    found->at = a->at;
    snprintf(found->what, WHAT, "electric field in patches '%s' under %g applied to '%s'",
             of->scene->patches[drive->patches].name, a->applied, a->name);
    return 1;
}
