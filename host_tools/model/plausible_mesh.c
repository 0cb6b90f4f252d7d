/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Plausibility rules on an irregular mesh, and on the transverse shear of a laminate
 * (plausible_parts.h).
 */
#include "plausible_parts.h"
#include <math.h>
#include <stdio.h>
#include "../mesh/laminate_bending.h"

/* ---- irregular meshes --------------------------------------------------- */

/*
 * Start a plausibility rule that measures a single number of a mesh of quadrilaterals. Rules are
 * called with k = 0, 1 and so on until they return 0; this one has a number for k = 0 only. Store
 * the number's place in the scene file in `found`. Returns whether k is 0 and the mesh consists of
 * quadrilaterals in any arrangement.
 */
static int is_first(const subject *of, int k, measured *found)
{
    found->at = of->scene->at_surface;
    return k == 0 && of->mesh->quads != NULL;
}

int measure_locking(const subject *of, int k, measured *found)
{
    const quad_report *report = &of->mesh->quad_report;
    if (!is_first(of, k, found))
        return 0;
    found->value = report->locking;
    snprintf(found->what, WHAT,
             "elements too thin for their irregular mesh, curvature x length^2/thickness up to "
             "%.3g, irregularity up to %.2g",
             report->thinness, report->irregularity);
    return 1;
}

int measure_coarse(const subject *of, int k, measured *found)
{
    const quad_report *report = &of->mesh->quad_report;
    if (!is_first(of, k, found))
        return 0;
    found->value = report->coarse;
    snprintf(found->what, WHAT,
             "thin elements of an irregular mesh, curvature x length^2/thickness up to %.3g, "
             "irregularity up to %.2g",
             report->thinness, report->irregularity);
    return 1;
}

int measure_strips(const subject *of, int k, measured *found)
{
    if (!is_first(of, k, found))
        return 0;
    found->value = of->mesh->quad_report.strips;
    snprintf(found->what, WHAT, "distorted elements of a thin twisted strip");
    return 1;
}

int measure_narrow(const subject *of, int k, measured *found)
{
    if (!is_first(of, k, found))
        return 0;
    found->value = of->mesh->quad_report.jacobian;
    snprintf(found->what, WHAT, "smallest area at the corner of an element");
    return 1;
}

/* ---- laminates ---------------------------------------------------------- */

/*
 * Return the shorter side of the structure: the second largest extent of its nodes along the three
 * coordinate axes.
 */
static double shorter_side(const mesh *mesh)
{
    double extent[3];
    mesh_extent(mesh, extent);
    const double largest = fmax(extent[0], fmax(extent[1], extent[2]));
    const double smallest = fmin(extent[0], fmin(extent[1], extent[2]));
    return extent[0] + extent[1] + extent[2] - largest - smallest;
}

/* Whether the positions of the nodes come from a mesh file or from measured points. */
static bool has_file(const subject *of)
{
    return of->scene->quads != NULL || of->scene->surface.type == SURFACE_POINTS;
}

/*
 * Store the ratio of the thickness of the structure to its shorter side in `found`, for a
 * plausibility rule.
 *   is_from_file in  the rule applies only to structures whose node positions come from a mesh file
 *                    or measured points (true), or only to all others (false)
 */
static int measure_thin(const subject *of, int k, bool is_from_file, measured *found)
{
    const double side = shorter_side(of->mesh);
    found->at = of->scene->at_surface;
    if (side > 0 && has_file(of) == is_from_file)
        found->value = of->mesh->laminate.thickness / side;
    snprintf(found->what, WHAT, "thickness over the shorter side of the structure, %g over %g",
             of->mesh->laminate.thickness, side);
    return k == 0;
}

int measure_slenderness(const subject *of, int k, measured *found)
{
    return measure_thin(of, k, false, found);
}

int measure_file_slenderness(const subject *of, int k, measured *found)
{
    return measure_thin(of, k, true, found);
}

int measure_thick_curvature(const subject *of, int k, measured *found)
{
    const mesh *mesh = of->mesh;
    double curvature = 0;
    for (int n = 0; n < mesh->nodes; n++)
        for (int a = 0; a < 2; a++)
            curvature = fmax(curvature, fabs(mesh->point[n].curvature[a]));
    found->at = of->scene->at_surface;
    found->value = mesh->laminate.thickness * curvature;
    snprintf(found->what, WHAT, "thickness over the smallest radius of curvature, %g over %g",
             mesh->laminate.thickness, 1 / curvature);
    return k == 0;
}

int measure_points_height(const subject *of, int k, measured *found)
{
    double extent[3];
    mesh_extent(of->mesh, extent);
    const double side = fmin(extent[0], extent[1]);
    found->at = of->scene->at_surface;
    if (of->scene->surface.type == SURFACE_POINTS && side > 0)
        found->value = extent[2] / side;
    snprintf(found->what, WHAT,
             "range of z of the surface fitted to the points over the shorter range of x and y, %g "
             "over %g",
             extent[2], side);
    return k == 0;
}

/*
 * Compute the bending and shear stiffnesses of the laminate for a plausibility rule on transverse
 * shear. The rule measures a single number, with the index k = 0.
 *   k       in   index of the number that is asked for
 *   bending out  stiffnesses
 *   wave    out  squared wave number of a half sine wave over the shorter side of the structure
 *       (1/m2)
 * Returns whether k is 0 and the stiffnesses could be computed.
 */
static int bending_of(const subject *of, int k, measured *found, laminate_bending *bending,
                      double *wave)
{
    static const double pi = 3.141592653589793;
    const double side = shorter_side(of->mesh);
    found->at = of->scene->at_layers;
    *wave = pi * pi / (side * side);
    return k == 0 && side > 0 && laminate_bending_fill(&of->mesh->laminate, bending) == 0;
}

/*
 * Measure the error of a shear strain that is assumed to be uniform through the thickness, instead
 * of being computed from equilibrium: the part of the deflection that is then missing, relative to
 * the deflection by bending.
 */
int measure_shear(const subject *of, int k, measured *found)
{
    laminate_bending bending;
    double wave;
    if (!bending_of(of, k, found, &bending, &wave) || of->scene->element.equilibrium_shear)
        return 0;
    found->value = wave * bending.bending * (1 / bending.shear - 1 / bending.constant);
    snprintf(found->what, WHAT, "part of the deflection that a uniform shear strain leaves out");
    return 1;
}

int measure_faces(const subject *of, int k, measured *found)
{
    laminate_bending bending;
    double wave;
    if (!bending_of(of, k, found, &bending, &wave) || !of->scene->element.equilibrium_shear)
        return 0;
    found->value = wave * bending.faces / bending.shear;
    snprintf(found->what, WHAT, "bending of the stiff plies by themselves over the shear");
    return 1;
}

/* ---- springs ------------------------------------------------------------ */

/* Return the position in the scene file of a spring entry or of a stack actuator. */
static scene_at at_of_item(const scene *scene, int item)
{
    return item < scene->springs ? scene->spring[item].at
                                 : scene->actuator[item - scene->springs].at;
}

/*
 * Measure how many springs of a spring entry or stack actuator of the scene have no effect, because
 * no free dof elongates them.
 */
int measure_held_spring(const subject *of, int k, measured *found)
{
    const mesh_springs *springs = &of->mesh->springs;
    if (springs->count == 0 || k >= of->scene->springs + of->scene->actuators)
        return 0;
    found->value = 0;
    for (int row = springs->first[k]; row < springs->first[k + 1]; row++)
        found->value += springs->start[row + 1] == springs->start[row];
    found->at = at_of_item(of->scene, k);
    snprintf(found->what, WHAT, "springs or stacks on held displacements, of %d in this item",
             springs->first[k + 1] - springs->first[k]);
    return 1;
}

/*
 * Measure by which factor springs increase the number of entries of the factored stiffness matrix.
 */
int measure_long_spring(const subject *of, int k, measured *found)
{
    const mesh_springs *springs = &of->mesh->springs;
    if (springs->count == 0 || k > 0)
        return 0;
    found->value = mesh_envelope(of->mesh) / springs->envelope_without;
    found->at = of->scene->at_surface;
    snprintf(found->what, WHAT, "stiffness factor with springs between distant nodes, %.0f numbers",
             mesh_envelope(of->mesh));
    return 1;
}
