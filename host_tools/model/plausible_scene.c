/* SPDX-License-Identifier: BSD-2-Clause */
/* Plausibility rules on the numbers of a scene (plausible_parts.h). */
#include "plausible_parts.h"

#include <math.h>
#include <stdio.h>
#include "../scene/scene_units.h"
#include "../scene/surface.h"

static const double quarter = 1.5707963267948966; /* pi/2: a quarter turn around a curved shell
                                                     (rad) */

static const units_unit field_unit = {{-1, 0, 1, 0, 0, 0}, 0, 0};

/* ---- electric fields -------------------------------------------------- */

/*
 * Find the k-th pair of an actuator and a patch grid to which the actuator applies voltages,
 * counted over all actuators of the scene. Returns 0 if there is no such pair.
 */
int plausible_drive(const scene *scene, int k, const scene_actuator **actuator,
                    const scene_drive **drive)
{
    for (int i = 0; i < scene->actuators; i++) {
        const int drives =
            scene_has_electrodes(&scene->actuator[i]) ? scene->actuator[i].drives : 0;
        *actuator = &scene->actuator[i];
        if (k < drives) {
            *drive = &scene->actuator[i].drive[k];
            return 1;
        }
        k -= drives;
    }
    return 0;
}

/*
 * Return the largest absolute voltage that the limits of the scene allow for an amplifier (V).
 * Limits of the amplifier itself take precedence over limits for all amplifiers.
 */
static double allowed(const scene *scene, int amplifier)
{
    double lower = scene->limits.lower, upper = scene->limits.upper;
    scene_own_limits(scene, amplifier, &lower, &upper);
    return fmax(fabs(lower), fabs(upper));
}

/*
 * Return the largest absolute voltage of an actuator's amplifiers (V): the largest one in the array
 * `voltage`, or, if this is NULL, the largest one that the voltage limits allow.
 */
double plausible_voltage(const scene *scene, const scene_actuator *actuator, const double *voltage)
{
    double most = 0;
    for (int k = actuator->first; k < actuator->first + actuator->grid[0] * actuator->grid[1]; k++)
        most = fmax(most, voltage ? fabs(voltage[k]) : allowed(scene, k));
    return most;
}

/*
 * Store in found->value the electric field (V/m) of an actuator's voltage in its patches: voltage
 * over thickness. It stays NAN for materials with a field limit, which limits the voltages, and for
 * films within the voltage of their data sheet, whose field may run along the faces.
 */
void plausible_field(const scene *scene, const scene_drive *drive, double voltage, measured *found)
{
    const scene_layer *layer = &scene->layer[scene->patches[drive->patches].layer];
    const scene_material *material = &scene->material[layer->material];
    const double applied = fabs(voltage * drive->factor);
    if (material->field_limit > 0 || !isfinite(voltage) ||
        (material->film_voltage > 0 && applied <= material->film_voltage))
        return;
    found->value = plausible_si(scene, applied / layer->thickness, &field_unit);
}

int measure_limit_field(const subject *of, int k, measured *found)
{
    const scene_actuator *actuator;
    const scene_drive *drive;
    if (!plausible_drive(of->scene, k, &actuator, &drive))
        return 0;
    const double voltage = plausible_voltage(of->scene, actuator, NULL);
    plausible_field(of->scene, drive, voltage, found);
    found->at = of->scene->limits.at;
    snprintf(found->what, WHAT, "electric field in patches '%s' at the voltage limit %g of '%s'",
             of->scene->patches[drive->patches].name, voltage, actuator->name);
    return 1;
}

int measure_applied_field(const subject *of, int k, measured *found)
{
    const scene_actuator *actuator;
    const scene_drive *drive;
    if (!plausible_drive(of->scene, k, &actuator, &drive))
        return 0;
    plausible_field(of->scene, drive, actuator->applied, found);
    found->at = actuator->at;
    snprintf(found->what, WHAT, "electric field in patches '%s' under %g applied to '%s'",
             of->scene->patches[drive->patches].name, actuator->applied, actuator->name);
    return 1;
}

/* Measure how far the voltage at which an amplifier is held lies beyond limits.voltage (V). */
int measure_held_voltage(const subject *of, int k, measured *found)
{
    const scene_limits *limits = &of->scene->limits;
    char name[SCENE_LABEL];
    if (k >= limits->each_count)
        return 0;
    const scene_limit *each = &limits->each[k];
    if (!each->has_voltage || each->lower != each->upper || !isfinite(limits->lower))
        return 1;
    scene_amplifier_name(of->scene, each->first, name);
    found->value = fmax(each->lower - limits->upper, limits->lower - each->upper);
    found->at = each->at;
    snprintf(found->what, WHAT, "voltage %g at which '%s' is held, beyond limits.voltage %g to %g",
             each->lower, name, limits->lower, limits->upper);
    return 1;
}

/* ---- electrodes ------------------------------------------------------- */

/*
 * Return the area of an electrode as a number of elements. An element that the electrode covers
 * only in part counts as the covered fraction.
 */
static double elements_of(const scene_outlines *outlines, int electrode)
{
    double sum = 0;
    for (size_t i = 0; i < outlines->start[outlines->elements]; i++)
        sum += outlines->electrode_of[i] == electrode ? outlines->share[i] : 0;
    return sum;
}

int measure_electrode(const subject *of, int k, measured *found)
{
    int smallest = 0;
    if (k >= of->scene->patch_grids)
        return 0;
    const scene_patches *patches = &of->scene->patches[k];
    for (int i = 0; patches->outlines && i < patches->outlines->electrodes; i++) {
        const double elements = elements_of(patches->outlines, i);
        if (i > 0 && !(elements < found->value))
            continue;
        found->value = elements;
        smallest = i;
    }
    found->at = patches->at;
    snprintf(found->what, WHAT, "size of electrode %d of patches '%s'", smallest + 1,
             patches->name);
    return 1;
}

/* ---- mesh at local loads ---------------------------------------------- */

/*
 * Return the larger of the two element lengths on both sides of mesh line i, in the direction
 * across the line. At the border there is only one element.
 */
static double element_at(const scene_line *line, int i)
{
    const double before = i > 0 ? line->point[i] - line->point[i - 1] : 0;
    const double after = i < line->elements ? line->point[i + 1] - line->point[i] : 0;
    return fmax(before, after);
}

static double span_of(const scene_line *line)
{
    return line->point[line->elements] - line->point[0];
}

/*
 * Radius, thickness, length and element size of a curved shell near a load, for one of the two
 * directions in which its surface is curved (m).
 */
typedef struct bend {
    double radius, thickness, length; /* radius of curvature, thickness, and length of the shell
                                         across the curved direction */
    double size; /* length of the element at which the load acts, along the curved direction of the
                    shell (m) */
} bend;

/*
 * Return the number of elements that a point force requires on a quarter turn of a curved shell:
 * two for each of the (R/h)^(1/4) (R/L)^(1/2) waves of its dent, at most one for each bending
 * length sqrt(R h). A strip narrower than this length bends like a ring and gives 0.
 *   R, h, L  radius, thickness and length of the shell
 */
static double elements_needed(const bend *bend)
{
    const double slender = bend->radius / bend->thickness,
                 bending = sqrt(bend->radius * bend->thickness);
    if (bend->length < bending)
        return 0;
    return fmin(2 * pow(slender, 0.25) * sqrt(bend->radius / bend->length),
                quarter * sqrt(slender));
}

static bend bend_at(const scene *scene, const int node[2], int direction)
{
    const int across = 1 - direction;
    const surface_point point =
        surface_at(&scene->surface, scene->line[0].point[node[0]], scene->line[1].point[node[1]]);
    bend result = {HUGE_VAL, 0, point.lame[across] * span_of(&scene->line[across]),
                   point.lame[direction] * element_at(&scene->line[direction], node[direction])};
    if (point.curvature[direction] != 0)
        result.radius = 1 / fabs(point.curvature[direction]);
    for (int i = 0; i < scene->layers; i++)
        result.thickness += scene->layer[i].thickness;
    return result;
}

/*
 * Measure whether the mesh resolves the dent under a point force, along one direction. The value is
 * the required number of elements on a quarter turn of the curved shell, divided by the number that
 * the element size at the force corresponds to.
 */
static void measure_point(const scene *scene, const scene_load *load, int direction,
                          measured *found)
{
    const bend bend = bend_at(scene, load->where.node, direction);
    if (!isfinite(bend.radius))
        return;
    const double needed = elements_needed(&bend), there = quarter * bend.radius / bend.size;
    found->value = needed / there;
    snprintf(found->what, WHAT,
             "size of elements at a force, %.3g on a quarter turn along theta%d where about %.0f "
             "are needed (%.0f "
             "on the whole mesh)",
             there, direction + 1, ceil(needed),
             ceil(scene->line[direction].elements * needed / there));
}

/*
 * Measure whether the mesh resolves the bending near a load on an edge. The value is the length of
 * the elements at the edge, at right angles to it, divided by the bending length sqrt(R h). R is
 * the radius of curvature along the edge, h the thickness.
 */
static void measure_edge(const scene *scene, const scene_load *load, int direction, measured *found)
{
    const int is_theta1 =
        load->where.edge == EDGE_THETA1_MINUS || load->where.edge == EDGE_THETA1_PLUS;
    const int is_plus =
        load->where.edge == EDGE_THETA1_PLUS || load->where.edge == EDGE_THETA2_PLUS;
    const int across = is_theta1 ? 0 : 1;
    if (direction != across)
        return;
    int node[2] = {0, 0};
    node[across] = is_plus ? scene->line[across].elements : 0;
    const bend along = bend_at(scene, node, 1 - across), bend = bend_at(scene, node, across);
    if (!isfinite(along.radius))
        return;
    const double bending = sqrt(along.radius * along.thickness);
    found->value = bend.size / bending;
    snprintf(
        found->what, WHAT,
        "size of elements at a load on an edge, %.3g across it where the bending length is %.3g "
        "(%.0f elements along theta%d)",
        bend.size, bending, ceil(scene->line[across].elements * found->value), across + 1);
}

int measure_resolution(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    if (k >= 2 * scene->loads || scene->quads)
        return 0;
    const scene_load *load = &scene->load[k / 2];
    found->at = load->at;
    if (load->type == LOAD_POINT)
        measure_point(scene, load, k % 2, found);
    if (load->type == LOAD_LINE)
        measure_edge(scene, load, k % 2, found);
    return 1;
}

/* ---- surface fitted to points ----------------------------------------- */

int measure_surface_misfit(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    double thickness = 0;
    if (k > 0 || scene->surface.type != SURFACE_POINTS)
        return 0;
    for (int i = 0; i < scene->layers; i++)
        thickness += scene->layer[i].thickness;
    found->at = scene->line[0].at;
    found->value = scene->surface.points.largest / thickness;
    snprintf(found->what, WHAT, "distance of point %zu from the surface fitted to the points",
             scene->surface.points.worst + 1);
    return 1;
}

/* ---- damping ---------------------------------------------------------- */

int measure_damping(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    const scene_dynamics *dynamics = &scene->dynamics;
    const int count = dynamics->dampings > 0 ? dynamics->dampings : 1;
    if (k >= count || !dynamics->damping_given)
        return 0;
    found->at = scene->influence.at;
    found->at.origin = scene->origin;
    if (!dynamics->is_rayleigh)
        found->value = dynamics->dampings > 0 ? dynamics->damping_of_mode[k] : dynamics->damping;
    snprintf(found->what, WHAT, "damping ratio of mode %d", k + 1);
    return 1;
}

/* ---- limits of a control loop ------------------------------------------- */

int measure_missing_limits(const subject *of, int k, measured *found)
{
    const scene *scene = of->scene;
    if (k > 0 || !(scene->control.rate > 0))
        return 0;
    found->at = scene->limits.at;
    found->value = 0;
    for (int i = 0; i < scene->amplifiers; i++)
        found->value += !isfinite(allowed(scene, i));
    snprintf(found->what, WHAT, "voltages without limits in a control loop");
    return 1;
}
