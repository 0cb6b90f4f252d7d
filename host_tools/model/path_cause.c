/* SPDX-License-Identifier: BSD-2-Clause */
/* Cause of the critical points or of the end of a load path (path_cause.h). */
#include "path_cause.h"
#include <stdio.h>

/*
 * Green's strain in a face of the shell below which the material counts as softened. With stress
 * linear in Green's strain, a compressive force has its maximum at -1/3. The threshold is closer to
 * 0, because strains at element centres are smaller in size than the largest.
 */
static const double soft_strain = -0.3;

/*
 * Choose the point of a load path at which the cause of its critical behaviour is examined: the one
 * before the first limit point, otherwise before the first bifurcation, otherwise the last point.
 * Returns the index of this point.
 */
static int critical_point(const load_path *path)
{
    int index = 0;
    while (index < path->events && path->event[index].type != LOAD_PATH_LIMIT)
        index++;
    if (index == path->events)
        index = 0;
    return index < path->events ? path->event[index].point : path->points - 1;
}

bool path_is_softened(const load_path *path)
{
    return path->points > 0 && path->point[critical_point(path)].compression.strain < soft_strain;
}

bool path_has_lost_normal(const load_path *path, const mesh *mesh)
{
    const double most = 70;
    return mesh->dof_per_node == 7 && path->points > 0 && path->point[path->points - 1].tilt > most;
}

/*
 * Write the cause of a load path's end into `text`: the shell has turned so far that the seventh
 * dof of a node, along the undeformed normal, has lost its stiffness. The text names the element
 * options without this dof.
 *   index in  index of the last point of the path
 */
static void name_tilt(const load_path_point *point, int index, const mesh *mesh, char *text)
{
    snprintf(text, PATH_CAUSE_BYTES,
             "at point %d the shell has turned by %.3g degrees from its undeformed normal (%s), "
             "along which the seventh dof of a node has lost its stiffness: use %s",
             index + 1, point->tilt, mesh_node_text(mesh, point->tilt_node).text,
             mesh->formulation.cartesian ? "dof_per_node: 6"
                                         : "element: improved with dof_per_node: 6");
}

/*
 * Write the strongest compression of the shell at a point of the load path into a text, as the
 * cause of the path's end or critical points.
 *   index  in  index of the point
 */
static void name_compression(const load_path_point *point, int index, const mesh *mesh, char *text)
{
    const face_strain *strongest = &point->compression;
    const char *advice = mesh->formulation.quadratic == SQUARES_OMITTED
                             ? ""
                             : "; large strains linear in the height (element: {quadratic: "
                               "omitted}) soften later in bending";
    snprintf(text, PATH_CAUSE_BYTES,
             "at point %d the %s face is compressed by a Green strain of %.3g within an element "
             "(%s; thickness strain %.2g): Hooke's law for Green strains softens below about %.1g, "
             "on every mesh; reduce the load, or the thickness%s",
             index + 1, strongest->face ? "outer" : "inner", strongest->strain,
             mesh_element_text(mesh, strongest->element).text, point->thickness_strain, soft_strain,
             advice);
}

/*
 * Write a message into a text: at a given point of the load path the shell bends so sharply within
 * one element that the mesh must be refined there. This explains why the path has ended or has
 * critical points.
 *   index  in  index of the point
 */
static void name_bend(const load_path_point *point, int index, const mesh *mesh, char *text)
{
    snprintf(text, PATH_CAUSE_BYTES,
             "at point %d the shell bends by up to %.3g degrees within an element (%s): refine the "
             "mesh where it folds sharply",
             index + 1, point->turn, mesh_element_text(mesh, point->turn_element).text);
}

/*
 * Write into `text` why a load path of equal load steps has ended, from the last status of the
 * equilibrium solver, and what the user can do.
 */
static void name_status(const load_path *path, const analysis *analysis, char *text)
{
    char where[SCENE_ERROR];
    if (path->status == PZS_E_PENETRATION) {
        equilibrium_penetration_text(&analysis->equilibrium, path->status, where);
        snprintf(text, PATH_CAUSE_BYTES, "%s: %s", pzs_status_text(path->status), where);
    } else
        snprintf(text, PATH_CAUSE_BYTES,
                 "%s; equal load steps, which prescribed displacements, a moved body and a shell "
                 "held by contact alone need, pass no limit point of a load: replace the load by a "
                 "moved body (contact.move) or by a moved support (value), or raise "
                 "equilibrium.load_steps",
                 pzs_status_text(path->status));
}

void path_cause(const load_path *path, const analysis *analysis, char text[PATH_CAUSE_BYTES])
{
    const int index = critical_point(path);
    if (path->has_equal_steps || PZS_IS_ERROR(path->status))
        name_status(path, analysis, text);
    else if (path_has_lost_normal(path, &analysis->design.mesh))
        name_tilt(&path->point[path->points - 1], path->points - 1, &analysis->design.mesh, text);
    else if (path_is_softened(path))
        name_compression(&path->point[index], index, &analysis->design.mesh, text);
    else
        name_bend(&path->point[index], index, &analysis->design.mesh, text);
}
