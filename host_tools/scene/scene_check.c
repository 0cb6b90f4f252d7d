/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Checks of a scene that involve several sections: names, poles of surfaces, thickness, mesh lines,
 * overlapping patches, and the requirements of loads.
 */
#include "scene_parts.h"

#include <math.h>
#include <string.h>
#include "surface.h"
#include "surface_types.h"
#include "surface_formula.h"

/*
 * Relative rounding limit of geometric checks. A coordinate lies on a mesh line if its distance
 * from the line is at most this fraction of the range of the coordinate over the mesh.
 */
static const double on_line = 1e-9;

static const double full_turn = 6.283185307179586;

/* ---- names ---- */

/*
 * Report an error if two items have the same name. The array has count items of `stride` bytes
 * each, and the first member of every item is its name. Returns 0, or -1 with error filled.
 */
static int check_names(const char *what, const void *items, int count, size_t stride,
                       size_t at_offset, char *error)
{
    const char *first = items;
    int i, j;
    for (i = 0; i < count; i++) {
        const char *name = first + (size_t)i * stride;
        scene_at at;
        for (j = 0; j < i && *name; j++)
            if (strcmp(name, first + (size_t)j * stride) == 0)
                break;
        if (j == i || !*name)
            continue;
        memcpy(&at, name + at_offset, sizeof at);
        return scene_fault(at, error, "there are two %s named '%s'; rename one", what, name);
    }
    return 0;
}

#define CHECK_NAMES(what, items, count, type)                                                      \
    check_names(what, scene->items, scene->count, sizeof(type), offsetof(type, at), error)

int scene_check_names(const scene *scene, char *error)
{
    int i, first, count;
    if (CHECK_NAMES("layers", layer, layers, scene_layer) != 0 ||
        CHECK_NAMES("patches", patches, patch_grids, scene_patches) != 0 ||
        CHECK_NAMES("actuators", actuator, actuators, scene_actuator) != 0 ||
        CHECK_NAMES("sensors", sensor, sensors, scene_actuator) != 0 ||
        CHECK_NAMES("springs", spring, springs, scene_spring) != 0 ||
        CHECK_NAMES("masses", mass, masses, scene_mass) != 0 ||
        CHECK_NAMES("outputs", output, outputs, scene_output) != 0 ||
        CHECK_NAMES("compare items", compare, compares, scene_compare) != 0 ||
        CHECK_NAMES("modes", target.mode, target.modes, scene_mode) != 0)
        return -1;
    for (i = 0; i < scene->actuators; i++)
        if (scene_find_amplifier(scene, scene->actuator[i].name, &first, &count) &&
            first != scene->actuator[i].first)
            return scene_fault(scene->actuator[i].at, error,
                               "'%s' is also the name of an amplifier of another "
                               "actuator; rename it",
                               scene->actuator[i].name);
    for (i = 0; i < scene->sensors; i++)
        if (scene_find_amplifier(scene, scene->sensor[i].name, &first, &count) ||
            (scene_find_sensor(scene, scene->sensor[i].name, &first, &count) &&
             first != scene->sensor[i].first))
            return scene_fault(scene->sensor[i].at, error,
                               "'%s' is also the name of another electrode; rename it",
                               scene->sensor[i].name);
    return 0;
}

/* ---- surface and mesh ---- */

/*
 * Number of intervals into which the range of a surface coordinate is divided for checks of the
 * surface's geometry; the checks are made at the ends of the intervals. A practical surface curves
 * little within one interval.
 */
enum { SAMPLES = 2000 };

static double sample(const scene_line *line, int i)
{
    const double from = line->point[0], to = line->point[line->elements];
    return i == SAMPLES ? to : from + (to - from) * i / SAMPLES;
}

/*
 * Reject a mesh that contains a pole: a point at which a surface of revolution has no positive
 * radius.
 */
static int check_poles(const scene *scene, char *error)
{
    const scene_line *line = &scene->line[0];
    double largest = 0, least = HUGE_VAL, at = 0;
    int i;
    for (i = 0; i <= SAMPLES; i++) {
        double theta1 = sample(line, i), radius;
        if (surface_closes(&scene->surface, 1) &&
            i < SAMPLES) /* On a torus the distance from the axis of revolution is smallest where
                            theta1 is an odd multiple of half a turn. Where such an angle lies
                            between sample i of theta1 and the next one, the distance is checked at
                            this angle instead of sample i. */
            theta1 = fmax(theta1, fmin(sample(line, i + 1),
                                       (2 * floor(theta1 / full_turn) + 1) * full_turn / 2));
        radius = surface_at(&scene->surface, theta1, 0).lame[1];
        largest = fmax(largest, fabs(radius));
        if (radius < least)
            at = theta1;
        least = fmin(least, radius);
    }
    if (least > 1e-12 * largest)
        return 0;
    return scene_fault(line->at, error, "the mesh reaches a pole, where A2 = 0; %s (theta1 = %g)",
                       surface_type_of(&scene->surface)->pole_cure, at);
}

/*
 * Reject a meridian with a turning point at which its arc length per unit of the spline parameter
 * (chord length) is nearly 0.
 */
static int check_meridian(const scene *scene, char *error)
{
    int i;
    for (i = 0; i <= SAMPLES && scene->surface.meridian; i++) {
        const double theta1 = sample(&scene->line[0], i);
        if (surface_at(&scene->surface, theta1, 0).lame[0] < 0.05)
            return scene_fault(scene->at_surface, error,
                               "the meridian turns back on itself near theta1 = %g; give more "
                               "points there, or smooth less",
                               theta1);
    }
    return 0;
}

/*
 * Check that the centres of curvature of the surface lie outside the shell: 1 + k z > 0 for both
 * principal curvatures k at the heights z of both faces.
 */
static int check_depth(const scene *scene, double thickness, char *error)
{
    const double height[2] = {-scene->reference, thickness - scene->reference};
    int i, direction, face;
    for (i = 0; i <= SAMPLES; i++) {
        const surface_point point =
            surface_at(&scene->surface, sample(&scene->line[0], i), sample(&scene->line[1], i));
        for (direction = 0; direction < 2; direction++)
            for (face = 0; face < 2; face++)
                if (!(1 + point.curvature[direction] * height[face] > on_line))
                    return scene_fault(
                        scene->at_layers, error,
                        "the layers reach %g %s the reference surface, past the "
                        "axis or centre of curvature at %g; use thinner layers or a larger radius",
                        fabs(height[face]), face ? "above" : "below",
                        fabs(1 / point.curvature[direction]));
    }
    return 0;
}

/*
 * Check a surface given by formulas: its points are finite, it has a normal everywhere, and its
 * coordinate lines meet at more than 15 degrees.
 */
static int check_formula(const scene *scene, char *error)
{
    enum { STRIDE = SAMPLES / 40 };
    const double most = 0.966;
    if (surface_is_general(&scene->surface) && !scene->element.cartesian)
        return scene_fault(scene->at_surface, error,
                           "the published element needs coordinates along lines of curvature; use "
                           "`element: improved` on a surface given by formulas");
    for (int i = 0; i <= SAMPLES && surface_is_general(&scene->surface); i += STRIDE)
        for (int j = 0; j <= SAMPLES; j += STRIDE) {
            const double theta1 = sample(&scene->line[0], i), theta2 = sample(&scene->line[1], j);
            const surface_point point = surface_at(&scene->surface, theta1, theta2);
            const double cosine = surface_formula_cosine(&scene->surface, theta1, theta2);
            if (!isfinite(point.position[0] + point.position[1] + point.position[2] +
                          point.curvature[0] + point.curvature[1]) ||
                isnan(cosine))
                return scene_fault(scene->at_surface, error,
                                   "the formulas have no finite position, normal and curvature at "
                                   "theta1 = %g, theta2 = %g; correct them, or leave the point out "
                                   "of the mesh",
                                   theta1, theta2);
            if (fabs(cosine) > most)
                return scene_fault(scene->at_surface, error,
                                   "the coordinate lines meet at an angle of %.3g degrees at "
                                   "theta1 = %g, theta2 = %g; at least 15 are needed",
                                   acos(fabs(cosine)) * 57.29577951308232, theta1, theta2);
        }
    return 0;
}

/* Reject a mesh that reaches beyond the measured points to which its surface is fitted. */
static int check_points(const scene *scene, char *error)
{
    const scene_line *line = scene->line;
    for (int i = 0; scene->surface.type == SURFACE_POINTS && i <= line[0].elements; i++)
        for (int j = 0; j <= line[1].elements; j++) {
            const double x = line[0].point[i], y = line[1].point[j];
            if (!bicubic_is_known(&scene->surface.points, x, y))
                return scene_fault(line[0].at, error,
                                   "the mesh reaches x = %g, y = %g, where the surface has no "
                                   "points nearby; measure there, let the mesh end before, or let "
                                   "'cells' be fewer",
                                   x, y);
        }
    return 0;
}

static int check_turn(const scene *scene, int direction, char *error)
{
    const scene_line *line = &scene->line[direction - 1];
    const double span = line->point[line->elements] - line->point[0];
    if (!surface_closes(&scene->surface, direction) || span <= full_turn * (1 + on_line))
        return 0;
    return scene_fault(
        line->at, error,
        "theta%d spans %g, more than a full turn; angles of a surface are radians: write "
        "90*pi/180 for 90 degrees",
        direction, span);
}

static int check_surface(const scene *scene, char *error)
{
    double thickness = 0;
    int i;
    for (i = 0; i < scene->layers; i++)
        thickness += scene->layer[i].thickness;
    if (surface_revolves(&scene->surface) && check_poles(scene, error) != 0)
        return -1;
    if (check_formula(scene, error) != 0 || check_meridian(scene, error) != 0 ||
        check_points(scene, error) != 0 || check_depth(scene, thickness, error) != 0)
        return -1;
    return check_turn(scene, 1, error) != 0 ? -1 : check_turn(scene, 2, error);
}

/*
 * Return the number of the mesh line nearest to a coordinate. If the coordinate lies on that line
 * within rounding, *coordinate becomes the coordinate of the line and *is_on becomes 1,
 * otherwise 0.
 */
static int snap(const scene_line *line, double *coordinate, int *is_on)
{
    const double span = line->point[line->elements] - line->point[0];
    int low = 0, high = line->elements;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (line->point[middle] <= *coordinate)
            low = middle;
        else
            high = middle;
    }
    if (fabs(line->point[high] - *coordinate) < fabs(line->point[low] - *coordinate))
        low = high;
    *is_on = fabs(line->point[low] - *coordinate) <= on_line * span;
    if (*is_on)
        *coordinate = line->point[low];
    return low;
}

/* ---- places ---- */

/*
 * Check that a rectangular region contains at least one mesh line of each surface coordinate. The
 * limits of the region are widened by a tolerance for rounding errors.
 */
static int check_region(const scene *scene, scene_where *where, char *error)
{
    int k, i, found = 1;
    for (k = 0; k < 2; k++) {
        const scene_line *line = &scene->line[k];
        const double slack = on_line * (line->point[line->elements] - line->point[0]);
        where->span[k][0] -= slack;
        where->span[k][1] += slack;
        for (i = 0; i <= line->elements &&
                    !(line->point[i] >= where->span[k][0] && line->point[i] <= where->span[k][1]);)
            i++;
        found &= i <= line->elements;
    }
    if (found)
        return 0;
    return scene_fault(
        where->at, error,
        "no node of the mesh lies in this rectangle; write [from, to], ascending and within the "
        "mesh");
}

static int check_where(const scene *scene, scene_where *where, char *error)
{
    const double wanted[2] = {where->theta[0], where->theta[1]};
    int k, on[2];
    if (where->type == WHERE_REGION)
        return check_region(scene, where, error);
    if (where->type != WHERE_POINT)
        return 0;
    for (k = 0; k < 2; k++)
        where->node[k] = snap(&scene->line[k], &where->theta[k], &on[k]);
    if (on[0] && on[1])
        return 0;
    return scene_fault(where->at, error, "(%g, %g) is no node of the mesh; the nearest is (%g, %g)",
                       wanted[0], wanted[1], scene->line[0].point[where->node[0]],
                       scene->line[1].point[where->node[1]]);
}

/*
 * Check that both ends of springs or stack actuators lie at points that the mesh has. Returns 0, or
 * -1 with error filled.
 */
static int check_spring(const scene *scene, scene_spring *spring, char *error)
{
    if (spring->where.at.column && check_where(scene, &spring->where, error) != 0)
        return -1;
    return spring->to.at.column ? check_where(scene, &spring->to, error) : 0;
}

static int check_places(scene *scene, char *error)
{
    int i;
    for (i = 0; i < scene->supports; i++)
        if (check_where(scene, &scene->support[i].where, error) != 0)
            return -1;
    for (i = 0; i < scene->springs; i++)
        if (check_spring(scene, &scene->spring[i], error) != 0)
            return -1;
    for (i = 0; i < scene->masses; i++)
        if (scene->mass[i].where.at.column && check_where(scene, &scene->mass[i].where, error) != 0)
            return -1;
    for (i = 0; i < scene->actuators; i++)
        if (scene->actuator[i].stacks && check_spring(scene, scene->actuator[i].stacks, error) != 0)
            return -1;
    for (i = 0; i < scene->loads; i++)
        if ((scene->load[i].type == LOAD_POINT || scene->load[i].type == LOAD_MOMENT) &&
            check_where(scene, &scene->load[i].where, error) != 0)
            return -1;
    for (i = 0; i < scene->outputs; i++)
        if (check_where(scene, &scene->output[i].where, error) != 0)
            return -1;
    return scene->target.given ? check_where(scene, &scene->target.what.where, error) : 0;
}

/* ---- layers and patches ---- */

static int check_layers(scene *scene, char *error)
{
    double thickness = 0;
    int i, grid, whole = 0;
    for (i = 0; i < scene->layers; i++) {
        thickness += scene->layer[i].thickness;
        whole += !scene->layer[i].patched;
        for (grid = 0; grid < scene->patch_grids; grid++)
            if (scene->patches[grid].layer == i)
                break;
        if (scene->layer[i].patched && grid == scene->patch_grids)
            return scene_fault(scene->layer[i].at, error,
                               "this layer is patched but no patches lie on it; add patches "
                               "or remove 'patched'");
    }
    if (whole == 0)
        return scene_fault(scene->at_layers, error,
                           "every layer is patched; at least one must cover the whole surface");
    if (scene->reference_is_middle)
        scene->reference = thickness / 2;
    if (scene->reference <= thickness * (1 + on_line))
        return 0;
    return scene_fault(scene->at_layers, error,
                       "'reference: %g' lies above the outer face at %g; use middle or a "
                       "height within the layers",
                       scene->reference, thickness);
}

static int check_edges(const scene *scene, const scene_patches *patches, int direction,
                       double theta[2], char *error)
{
    const scene_line *line = &scene->line[direction];
    int i, on;
    if (!(theta[0] < theta[1]))
        return scene_fault(patches->at, error,
                           "patches '%s': theta%d runs from %g to %g; write [from, to] ascending",
                           patches->name, direction + 1, theta[0], theta[1]);
    for (i = 0; i <= patches->grid[direction]; i++) {
        double edge = theta[0] + (theta[1] - theta[0]) * i / patches->grid[direction];
        const double wanted = edge;
        const int near = snap(line, &edge, &on);
        if (!on)
            return scene_fault(
                patches->at, error,
                "patches '%s': the edge theta%d = %g is no mesh line, the nearest is "
                "%g; move it or choose elements to fit",
                patches->name, direction + 1, wanted, line->point[near]);
    }
    for (i = 0; i < 2; i++)
        snap(line, &theta[i], &on);
    return 0;
}

static int overlap(const scene_patches *patches, const scene_patches *other)
{
    return patches->layer == other->layer && patches->theta1[0] < other->theta1[1] &&
           other->theta1[0] < patches->theta1[1] && patches->theta2[0] < other->theta2[1] &&
           other->theta2[0] < patches->theta2[1];
}

static int check_patches(scene *scene, char *error)
{
    int i, j;
    for (i = 0; i < scene->patch_grids; i++) {
        scene_patches *patches = &scene->patches[i];
        if (patches->outlines)
            continue;
        if (check_edges(scene, patches, 0, patches->theta1, error) != 0 ||
            check_edges(scene, patches, 1, patches->theta2, error) != 0)
            return -1;
        for (j = 0; j < i; j++)
            if (!scene->patches[j].outlines && overlap(patches, &scene->patches[j]))
                return scene_fault(patches->at, error,
                                   "patches '%s' and '%s' overlap on one layer; move one",
                                   scene->patches[j].name, patches->name);
    }
    return 0;
}

/* ---- loads ---- */

static int any_material(const scene *scene, int (*has)(const scene_material *))
{
    int i;
    for (i = 0; i < scene->layers; i++)
        if (has(&scene->material[scene->layer[i].material]))
            return 1;
    return 0;
}

static int has_density(const scene_material *material)
{
    return material->density > 0;
}

static int expands(const scene_material *material)
{
    return material->alpha[0] != 0 || material->alpha[1] != 0 || material->alpha[2] != 0;
}

int scene_expands(const scene *scene)
{
    return any_material(scene, expands);
}

static int is_pyroelectric(const scene_material *material)
{
    return material->pyroelectric != 0;
}

static int check_loads(const scene *scene, char *error)
{
    int i;
    for (i = 0; i < scene->loads; i++) {
        if (scene->load[i].type == LOAD_WEIGHT && scene->masses == 0 &&
            !any_material(scene, has_density))
            return scene_fault(scene->load[i].at, error,
                               "weight without density; give a layer's material 'density'");
        if (scene->load[i].type == LOAD_TEMPERATURE && !scene_expands(scene) &&
            !any_material(scene, is_pyroelectric))
            return scene_fault(scene->load[i].at, error,
                               "a temperature moves nothing; give a layer's material 'alpha'");
    }
    for (i = 0; i < scene->actuators; i++)
        if (scene->actuator[i].is_temperature && !scene_expands(scene) &&
            !any_material(scene, is_pyroelectric))
            return scene_fault(scene->actuator[i].at, error,
                               "a temperature moves nothing; give a layer's material 'alpha'");
    return 0;
}

/* ---- bare faces ---- */

/*
 * Check two neighbouring layers of which each has at least one bare face (face without electrode).
 * The face that the two layers have in common must be bare in both descriptions, or in none; in the
 * latter case it is an electrode at 0 V. Returns 0, or -1 with error filled.
 */
static int check_bare_faces(const scene *scene, char *error)
{
    for (int i = 1; i < scene->layers; i++) {
        const scene_layer *below = &scene->layer[i - 1], *above = &scene->layer[i];
        const bool lower = below->bare & BARE_OUTER, upper = above->bare & BARE_INNER;
        if (below->bare == BARE_NONE || above->bare == BARE_NONE || lower == upper)
            continue;
        return scene_fault(above->at, error,
                           "the face between the layers %d and %d is bare for one of them and an "
                           "electrode at 0 V for the other; let 'bare' of both agree (both where "
                           "both faces are bare)",
                           i, i + 1);
    }
    return 0;
}

/* ---- kinematics ---- */

/*
 * Refuse sensor readings of a nonlinear plant that are linear functions of the displacement only
 * under linear kinematics, such as strains.
 */
static int check_readings(const scene *scene, char *error)
{
    const bool is_nonlinear =
        scene->simulate.given && scene->simulate.kinematics != KINEMATICS_LINEAR;
    for (int i = 0; i < scene->estimate.readings && is_nonlinear; i++) {
        const scene_output *output = &scene->output[scene->estimate.reading[i].output];
        const scene_output_info *info = scene_output_info_of(output->type);
        if (info->reading == READING_LINEAR)
            return scene_fault(scene->estimate.reading[i].at, error,
                               "'%s' is a %s, which a nonlinear plant cannot give as a reading; "
                               "write plant: {kinematics: linear} in simulate",
                               output->name, info->word);
    }
    return 0;
}

static int check_kinematics(const scene *scene, char *error)
{
    int i;
    if (check_readings(scene, error) != 0)
        return -1;
    if (scene->kinematics != KINEMATICS_LINEAR)
        return 0;
    for (i = 0; i < scene->supports; i++)
        if (scene->support[i].value)
            return scene_fault(scene->support[i].at, error,
                               "a support with a 'value' needs kinematics: nonlinear");
    if (scene->contact.given)
        return scene_fault(scene->contact.at, error, "contact needs kinematics: nonlinear");
    return 0;
}

/*
 * Check the geometry of a scene: the mesh lines and patches on its surface, or the regions and
 * supports of its mesh file.
 */
static int check_geometry(scene *scene, char *error)
{
    if (scene->quads)
        return check_regions(scene, error) != 0 ? -1 : check_triads(scene, error);
    if (check_surface(scene, error) != 0 || check_patches(scene, error) != 0)
        return -1;
    return check_places(scene, error);
}

int scene_check(scene *scene, char *error)
{
    if (scene_check_names(scene, error) != 0 || check_layers(scene, error) != 0 ||
        check_geometry(scene, error) != 0)
        return -1;
    if (check_outlines(scene, error) != 0)
        return -1;
    if (check_bare_faces(scene, error) != 0)
        return -1;
    if (check_loads(scene, error) != 0 || scene_check_rows(scene, error) != 0)
        return -1;
    return check_kinematics(scene, error);
}
