/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Equilibrium of a scene under nonlinear kinematics: a solver and its tables, which describe
 * prescribed resultants (of voltages and temperatures at zero strain), prescribed displacements,
 * follower loads and contact.
 */
#ifndef EQUILIBRIUM_H
#define EQUILIBRIUM_H

#include "design.h"

typedef struct equilibrium {
    const design *design;
    pzs_nonlinear tables;
    pzs_follower *follower; /* [followers] tables of the follower loads: loads whose direction
                               follows the rotation of the shell */
    pzs_follower_load *follower_load; /* [followers] state of each follower load (load whose
                                         direction follows the rotation of the shell) in the solver
                                       */
    int followers;
    pzs_contact_face contact_face;
    pzs_body body;
    pzs_contact contact; /* state of the contact with a rigid body; used where the scene has a
                            contact */
    pzs_circuit circuit; /* electrodes with unknown voltage; used where the scene has an open
                            electrode */
    pzs_solver solver;
    double *full_input; /* [inputs] input values of the scene at full load: load factors and applied
                           voltages (V) */
    void *work, *contact_work, *circuit_work;
    size_t work_bytes, contact_bytes, circuit_bytes; /* sizes of three workspaces (bytes): of the
                                                        equilibrium solver, of the contact, and of
                                                        the open electrodes, whose unknown voltages
                                                        are computed */
} equilibrium;

/*
 * Build the tables of prescribed resultants, follower loads and contact, and an equilibrium solver
 * in the reference state.
 *   design in      numerical model of a scene whose kinematics is not linear; must outlive
 *       `equilibrium`
 *   model  in/out  model initialised on the structure of the design
 * Returns PZS_OK or the status of the library; after an error `equilibrium` is empty.
 */
pzs_status equilibrium_open(equilibrium *equilibrium, const design *design, pzs_model *model);
void equilibrium_close(equilibrium *equilibrium);

/*
 * equilibrium_state_bytes returns the size of the solver's state in bytes, equilibrium_save copies
 * the state into a buffer, equilibrium_restore sets the solver to a saved state.
 *   state in/out  buffer of the size that equilibrium_state_bytes returns
 */
size_t equilibrium_state_bytes(const equilibrium *equilibrium);
void equilibrium_save(const equilibrium *equilibrium, void *state);
void equilibrium_restore(equilibrium *equilibrium, const void *state);

/*
 * Whether the solver has the factors of the tangent stiffness matrix at its equilibrium, which
 * pzs_influence_at needs; not after equilibrium_restore.
 */
bool equilibrium_is_factored(const equilibrium *equilibrium);

/*
 * Compute the force of the contact body on one node of the shell along x, y and z (N), at the
 * present equilibrium of the solver.
 */
void equilibrium_contact_force(const equilibrium *equilibrium, int node, double force[3]);

/*
 * Describe how the contact's body came to lie inside the shell and what the user can do, for the
 * last load step that was refused or led to a warning.
 *   status             in   PZS_E_PENETRATION or PZS_W_BEHIND
 *   text [SCENE_ERROR] out  the description
 */
void equilibrium_penetration_text(const equilibrium *equilibrium, pzs_status status, char *text);

#endif
