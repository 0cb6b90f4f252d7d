/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * A structure linearised about a nonlinear equilibrium: the tangent stiffness matrix there, which
 * contains the prestress, and the forces of the inputs. Vibration modes about the equilibrium are
 * computed from these two (vibration_solve_at).
 */
#ifndef LINEARISED_H
#define LINEARISED_H

#include "design.h"
#include "pzs_nonlinear.h"

typedef struct linearised {
    double *tangent; /* entries of the tangent stiffness matrix, stored like the stiffness matrix of
                        the library's model; rows and columns of prescribed displacements are those
                        of the unit matrix */
    size_t entries;  /* number of stored entries of the tangent stiffness matrix */
    double *force;   /* [inputs][free_dof] nodal forces per unit of each input (voltage, load factor
                        or temperature) at the equilibrium */
} linearised;

/*
 * Compute the tangent stiffness matrix and the forces of all inputs at the equilibrium of a solver.
 * This overwrites the factors of the tangent stiffness in the solver's model, so the influence
 * matrix at this equilibrium must be computed before.
 *   solver in/out  equilibrium solver of the structure, at an equilibrium
 * Returns whether memory sufficed; call linearised_free in either case.
 */
bool linearised_take(linearised *linearised, const design *design, pzs_solver *solver);
void linearised_free(linearised *linearised);

/*
 * Compute the nodal forces per unit of an input. Entries of dof with prescribed displacements are
 * 0. about            in   NULL: reference state force [free_dof] out  nodal forces
 */
void linearised_force(const linearised *about, const design *design, uint32_t input, double *force);

/*
 * Return the work that the nodal forces per unit of an input do on a displacement.
 *   about                   in  NULL: reference state
 *   displacement [free_dof] in  displacement vector; 0 at dof with prescribed displacements
 */
double linearised_work(const linearised *about, const design *design, uint32_t input,
                       const double *displacement);

#endif
