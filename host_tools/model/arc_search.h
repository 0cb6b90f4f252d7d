/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * One step of the arc-length method (Crisfield 1981): from an equilibrium on the load path to the
 * next one at a prescribed distance, with the change of the load factor as an unknown.
 */
#ifndef ARC_SEARCH_H
#define ARC_SEARCH_H

#include "arc_contact.h"

/*
 * State of the arc-length method, which follows the load path (curve of equilibria) step by step.
 * Its vectors have `entries` entries: the free dof of the displacement, then the voltages of the
 * open electrodes. A point of the path is such a vector and a load factor.
 */
typedef struct arc_search {
    pzs_solver *solver;
    pzs_circuit *circuit; /* open electrodes, whose voltages are unknown; NULL: none */
    const double *full;   /* [inputs] input values of the scene at full load */
    size_t free_dof, entries;
    double *memory;
    double *metric;    /* [free dof, then open electrodes] weight of each entry in the norm of a
                          vector: 1 for the means of both faces' displacements, thickness^2 for the
                          other dof, 0 for voltages */
    double *start;     /* [free dof, then open electrodes] displacement, and voltages of the open
                          electrodes, at the last converged point of the load path */
    double *direction; /* [free dof, then open electrodes] increment of displacement and voltages in
                          the last converged step on the load path */
    double *increment; /* [free dof, then open electrodes] increment of displacement and voltages
                          since the last converged point of the load path */
    double *by_residual; /* [free dof, then open electrodes] change of displacement and voltages by
                            the residual forces and charges: inverse tangent matrix times (load
                            minus internal force) */
    double *by_load;     /* [free dof, then open electrodes] change of displacement and voltages per
                            unit of the load factor: inverse tangent matrix times force and charge
                            per unit of the load factor */
    double *origin;      /* [free dof, then open electrodes] displacement and voltages at the
                            bifurcation at which the path was left */
    double *unit;       /* [free dof, then open electrodes] work vector: nodal forces, or changes of
                           displacement and voltages, per unit of one input of the structure */
    double load_factor; /* load factor at the present point of the load path */
    double start_factor; /* load factor at the last converged point of the load path */
    int iterations;
    arc_contact contact; /* contact with a fixed rigid body; empty where the scene has none */
} arc_search;

/* Allocate the vectors of the arc-length method. Returns 0, or -1 where memory runs out. */
int arc_open(arc_search *arc_search, analysis *analysis);

void arc_close(arc_search *arc_search);

/* Return the scalar product of two vectors in the norm of the arc length (metric). */
double arc_product(const arc_search *arc_search, const double *first, const double *second);

/* Return the number of open electrodes, whose voltages are unknown. */
size_t arc_open_electrodes(const arc_search *arc_search);

/*
 * Set the equilibrium solver to the displacement at the last converged point of the load path plus
 * the present increment, at the present load factor and voltages.
 */
void arc_set_point(arc_search *arc_search);

/*
 * Factor the tangent stiffness matrix at the present point of an arc-length step, and solve for the
 * changes of displacement and voltages under the residual forces and per unit of the load factor.
 *   uses_true_resultants in  true: geometric stiffness from the stress resultants of the
 *       displacement; false: from resultants extrapolated from the previous iteration
 * Returns false if the tangent stiffness matrix is singular.
 */
bool arc_solve(arc_search *arc_search, bool uses_true_resultants);

/*
 * Replace nodal forces by the changes of displacement and voltages that they cause at the present
 * point, whose tangent stiffness has been factored.
 *   vector [free dof, then open electrodes] in/out  nodal forces in the first entries, then the
 *       changes
 * Returns false if the voltages of the open electrodes cannot be solved for.
 */
bool arc_respond(arc_search *arc_search, double *vector);

/*
 * Return to the last converged point of the load path and compute its tangent stiffness. Returns
 * whether this has succeeded.
 */
bool arc_restore(arc_search *arc_search);

/*
 * Make a step from the last converged point of the load path, whose tangent stiffness is factored:
 * a first increment, then corrections.
 *   predictor [free dof, then open electrodes] in  vector along the first increment
 *   scale     in  first increment over the predictor
 *   change    in  first change of the load factor
 *   arc       in  length of the step; 0: the load factor stays at its first change
 * Returns whether the step has converged without reversing the path. The tangent stiffness is then
 * that of the new point; `start` is the old point.
 */
bool arc_step(arc_search *arc_search, const double *predictor, double scale, double change,
              double arc);

/*
 * Make a step of the given length on the load path, from its last converged point, whose tangent
 * stiffness has been factored. Returns whether the step has converged. A step that reverses the
 * direction of the path (by more than a right angle) counts as not converged.
 */
bool arc_try_step(arc_search *arc_search, double arc);

/*
 * Repeat a step of the load path that has passed the full load, so that it ends at the full load.
 *   arc out  length of the repeated step
 * Returns whether the step has converged. A step that reverses the direction of the path (by more
 * than a right angle) counts as not converged.
 */
bool arc_land_at_full_load(arc_search *arc_search, double *arc);

/*
 * Make the present point of the load path the last converged point, from which the next step
 * starts.
 */
void arc_accept(arc_search *arc_search);

#endif
