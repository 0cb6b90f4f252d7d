/* SPDX-License-Identifier: BSD-2-Clause */
/* Plausibility rules on computed voltages, displacements and load paths (plausible_parts.h). */
#include "plausible_parts.h"

#include <math.h>
#include <stdio.h>
#include "design.h"
#include "face_strain.h"
#include "plausible.h"

/* ---- voltages --------------------------------------------------------- */

/*
 * Measure the electric field that the computed voltages cause. This plausibility rule applies only
 * if the electric field at the voltage limits of the scene causes no warning.
 */
int measure_found_field(const subject *of, int k, measured *found)
{
    const scene_actuator *actuator;
    const scene_drive *drive;
    if (!plausible_drive(of->scene, k, &actuator, &drive))
        return 0;
    const double voltage = plausible_voltage(of->scene, actuator, of->voltage),
                 most = plausible_voltage(of->scene, actuator, NULL);
    if (isinf(most) || most < voltage)
        plausible_field(of->scene, drive, voltage, found);
    found->at = actuator->at;
    snprintf(found->what, WHAT, "electric field in patches '%s' under %g of '%s' (%s)",
             of->scene->patches[drive->patches].name, voltage, actuator->name, of->name);
    return 1;
}

/* ---- displacement and strain ------------------------------------------ */

int measure_displacement(const subject *of, int k, measured *found)
{
    double most = 0;
    int where = 0;
    if (k > 0)
        return 0;
    for (int node = 0; of->is_linear && node < of->mesh->nodes; node++) {
        const double size =
            fabs(design_displacement(of->mesh, of->displacement, node, COMPONENT_U3, FACE_MIDDLE));
        where = size > most ? node : where;
        most = fmax(most, size);
    }
    found->value = most / of->mesh->laminate.thickness;
    snprintf(found->what, WHAT, "normal displacement of %s, %g at %s", of->name, most,
             mesh_node_text(of->mesh, where).text);
    return 1;
}

double plausible_strain(const mesh *mesh, const double *displacement, int is_linear, int *where)
{
    face_strains found;
    if (!face_strains_find(mesh, displacement, is_linear, &found))
        return (double)NAN;
    *where = found.largest.element;
    return found.largest.strain;
}

int measure_strain(const subject *of, int k, measured *found)
{
    int where = 0;
    if (k > 0)
        return 0;
    found->value = plausible_strain(of->mesh, of->displacement, of->is_linear, &where);
    snprintf(found->what, WHAT, "principal strain of %s at %s", of->name,
             mesh_element_text(of->mesh, where).text);
    return 1;
}

/* ---- load path -------------------------------------------------------- */

int measure_path(const subject *of, int k, measured *found)
{
    found->value = of->path_difference;
    snprintf(found->what, WHAT,
             "twice as many load steps end at another equilibrium, which differs by");
    return k == 0 && isfinite(of->path_difference);
}

int measure_path_end(const subject *of, int k, measured *found)
{
    found->value = of->load_factor;
    snprintf(found->what, WHAT, "twice as many load steps end before the full load");
    return k == 0 && isinf(of->path_difference);
}

int measure_stability(const subject *of, int k, measured *found)
{
    found->value = of->negative_pivots;
    snprintf(found->what, WHAT, "the equilibrium is unstable");
    return k == 0;
}

/* ---- optimum of a target ---------------------------------------------- */

int measure_target(const subject *of, int k, measured *found)
{
    found->at = of->scene->target.what.at;
    found->value = of->optimum->target;
    snprintf(found->what, WHAT,
             "root mean square of what is left of the target beside the free functions");
    return k == 0;
}

int measure_unreached(const subject *of, int k, measured *found)
{
    found->at = of->scene->target.what.at;
    found->value = of->optimum->target > 0 ? of->optimum->error : (double)NAN;
    snprintf(found->what, WHAT, "shape error of the optimum within the limits");
    return k == 0;
}

int measure_range(const subject *of, int k, measured *found)
{
    found->at = of->scene->simulate.at;
    found->value = of->optimum->reading;
    snprintf(found->what, WHAT,
             "largest displacement of the target over simulate.sensors.range, %g",
             of->scene->simulate.range);
    return k == 0;
}

int measure_idle(const subject *of, int k, measured *found)
{
    found->at = of->scene->target.what.at;
    found->value = of->optimum->target > 0 ? of->optimum->share : (double)NAN;
    snprintf(found->what, WHAT, "largest voltage of the optimum");
    return k == 0;
}

/* ---- prestress by loads ------------------------------------------------- */

int measure_prestress(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    found->value = of->unloaded > 0 ? of->loaded / of->unloaded : (double)NAN;
    if (scene->loads > 0)
        found->at = scene->load[0].at;
    if (of->loaded > 0)
        snprintf(found->what, WHAT,
                 "the static loads move the first natural frequency from %.4g Hz to %.4g Hz",
                 of->unloaded, of->loaded);
    else
        snprintf(found->what, WHAT,
                 "the structure buckles under its static loads; first natural frequency");
    return k == 0;
}

/* ---- loads against voltages ------------------------------------------- */

int measure_sudden_loads(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    found->value = of->reach > 0 ? of->load / of->reach : (double)NAN;
    if (scene->loads > 0)
        found->at = scene->load[0].at;
    snprintf(found->what, WHAT,
             "the loads move the target nodes by %.4g (root mean square), half the voltage range "
             "of all amplifiers with random signs by %.4g",
             of->load, of->reach);
    return k == 0;
}

/* ---- certified loop --------------------------------------------------- */

/*
 * Measure the largest displacement of the target of a control loop, divided by the thickness of the
 * structure, for a plausibility rule.
 *   applies in  false: the rule does not apply to the loop, and the measured number is NAN
 */
static int measure_target_amplitude(const subject *of, int k, bool applies, measured *found)
{
    found->value = applies ? of->amplitude : (double)NAN;
    found->at = of->scene->target.what.at;
    snprintf(found->what, WHAT,
             "largest displacement of the target of a loop that damps vibration");
    return k == 0;
}

/*
 * Whether the stability of the control loop is tested for the structure linearised about the
 * equilibrium at its target, besides the structure in its reference state.
 */
static bool is_certified_at_target(const subject *of)
{
    return of->scene->kinematics != KINEMATICS_LINEAR;
}

int measure_amplitude(const subject *of, int k, measured *found)
{
    const bool has_tables_at_target = of->scene->simulate.influence_at == INFLUENCE_TARGET;
    return measure_target_amplitude(of, k, !has_tables_at_target && !is_certified_at_target(of),
                                    found);
}

int measure_amplitude_certified(const subject *of, int k, measured *found)
{
    const bool has_tables_at_target = of->scene->simulate.influence_at == INFLUENCE_TARGET;
    return measure_target_amplitude(of, k, !has_tables_at_target && is_certified_at_target(of),
                                    found);
}

int measure_amplitude_at_target(const subject *of, int k, measured *found)
{
    return measure_target_amplitude(of, k, of->scene->simulate.influence_at == INFLUENCE_TARGET,
                                    found);
}

int measure_age(const subject *of, int k, measured *found)
{
    found->value = of->older;
    found->at = of->scene->simulate.at;
    snprintf(found->what, WHAT, "readings may be older than simulate.sensors.delay, %d, by",
             of->scene->simulate.delay);
    return k == 0;
}

int measure_noise(const subject *of, int k, measured *found)
{
    found->value = of->noise;
    found->at = of->scene->simulate.at;
    snprintf(found->what, WHAT, "noise of the sensors, simulate.sensors.noise, %g",
             of->scene->simulate.noise);
    return k == 0;
}

/* Measure the margin of the loop against errors of a matrix that is measured, or that is not. */
static int measure_margin(const subject *of, int k, bool is_measured, measured *found)
{
    found->value = of->scene->influence.given == is_measured ? of->margin : (double)NAN;
    if (is_measured)
        found->at = of->scene->influence.at;
    snprintf(
        found->what, WHAT,
        "relative errors of the influence matrix (standard deviation) that the loop bears (%s)",
        of->cure);
    return k == 0;
}

int measure_matrix_errors(const subject *of, int k, measured *found)
{
    return measure_margin(of, k, true, found);
}

int measure_model_errors(const subject *of, int k, measured *found)
{
    return measure_margin(of, k, false, found);
}

int measure_divergence(const subject *of, int k, measured *found)
{
    found->value = of->divergence;
    found->at = of->scene->simulate.at;
    snprintf(found->what, WHAT, "shape error at the end of the simulation, %.4g %% of the target",
             100 * of->end_error);
    return k == 0;
}

int measure_tested_hysteresis(const subject *of, int k, measured *found)
{
    const bool has_test = of->scene->safety.amplitude > 0;
    found->value = has_test ? of->scene->simulate.hysteresis : (double)NAN;
    found->at = of->scene->simulate.at;
    snprintf(found->what, WHAT, "hysteresis of actuators that the self-test moves");
    return k == 0;
}

int measure_dependent(const subject *of, int k, measured *found)
{
    found->at = of->scene->limits.at;
    found->value = of->optimum->dependent;
    snprintf(found->what, WHAT, "some voltages change nothing in the target together");
    return k == 0;
}
