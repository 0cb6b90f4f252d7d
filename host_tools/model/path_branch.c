/* SPDX-License-Identifier: BSD-2-Clause */
/* Change to the branch of a load path at a bifurcation (path_branch.h). */
#include "path_branch.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/*
 * Return the entry of a bifurcation mode that has the largest absolute value among the mean
 * displacements of both faces, with its sign.
 */
static double largest_displacement(const arc_search *arc_search, const double *mode)
{
    double largest = 0;
    for (size_t i = 0; i < arc_search->entries; i++)
        if (arc_search->metric[i] == 1 && fabs(mode[i]) > fabs(largest))
            largest = mode[i];
    return largest;
}

/*
 * Scale the mode of a bifurcation so that its largest displacement is 1. Returns false if all its
 * displacements are 0 or one is not finite.
 */
static bool normalise(const arc_search *arc_search, double *mode)
{
    const double largest = largest_displacement(arc_search, mode);
    for (size_t i = 0; i < arc_search->entries; i++)
        mode[i] /= largest;
    return isfinite(largest) && largest != 0;
}

/*
 * Find the mode of a bifurcation, the displacement with the smallest eigenvalue of the tangent
 * stiffness, by inverse iteration. The tangent stiffness at the present point has been factored.
 * The iteration starts with pseudorandom numbers: a symmetric start vector could be orthogonal to
 * the mode.
 */
static bool find_mode(arc_search *arc_search, double *mode)
{
    enum { ITERATIONS = 8 };
    uint32_t random = 1;
    for (size_t i = 0; i < arc_search->entries; i++) {
        random = random * 1664525u + 1013904223u;
        mode[i] = (double)random / UINT32_MAX - 0.5;
    }
    for (int k = 0; k < ITERATIONS; k++) {
        for (size_t i = 0; i < arc_search->entries; i++)
            mode[i] *= arc_search->metric[i];
        if (!arc_respond(arc_search, mode) || !normalise(arc_search, mode))
            return false;
    }
    return true;
}

/* Length of the diagonal of the box around the nodes of a mesh (m). */
static double mesh_size(const mesh *mesh)
{
    double extent[3];
    mesh_extent(mesh, extent);
    return hypot(hypot(extent[0], extent[1]), extent[2]);
}

/*
 * Make a first step from a bifurcation along its mode. Its first increment keeps the load factor of
 * the bifurcation.
 *   amplitude in  largest displacement of the first increment (m). Its sign selects the direction:
 *       along the mode, or opposite to it
 * Returns whether an equilibrium was found on the branch. It lies on the branch if its displacement
 * from the bifurcation encloses less than 45 degrees with the mode; the original path leaves the
 * bifurcation at a larger angle.
 */
static bool try_amplitude(arc_search *arc_search, const double *mode, double amplitude)
{
    const double size = sqrt(arc_product(arc_search, mode, mode)), arc = fabs(amplitude) * size;
    for (size_t i = 0; i < arc_search->entries; i++)
        arc_search->direction[i] = amplitude * mode[i];
    return arc_restore(arc_search) && arc_step(arc_search, mode, amplitude, 0, arc) &&
           arc_product(arc_search, arc_search->direction, arc_search->increment) >
               sqrt(0.5) * arc * arc;
}

bool path_branch_enter(arc_search *arc_search, const mesh *mesh, bool is_opposite, double *arc,
                       double *longest)
{
    static const double thicknesses[] = {0.1, 0.3, 1, 0.03, 0.01};
    const double thickness = arc_search->solver->state.model->state.structure->type[0].thickness;
    double *mode = malloc(arc_search->entries * sizeof *mode);
    bool is_found = false;
    if (mode && find_mode(arc_search, mode)) {
        const double size = sqrt(arc_product(arc_search, mode, mode));
        *longest = size * mesh_size(mesh) / 20;
        for (size_t k = 0; k < sizeof thicknesses / sizeof *thicknesses && !is_found; k++) {
            const double amplitude = thicknesses[k] * thickness;
            *arc = amplitude * size;
            is_found = try_amplitude(arc_search, mode, is_opposite ? -amplitude : amplitude);
        }
    }
    free(mode);
    return is_found;
}
