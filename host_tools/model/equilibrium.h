/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Equilibrium of a scene under nonlinear kinematics: prescribed resultants, prescribed
 * displacements, follower loads and contact as the library's tables, and an equilibrium solver that
 * runs on them.
 */
#ifndef EQUILIBRIUM_H
#define EQUILIBRIUM_H

#include "design.h"

typedef struct equilibrium {
    const design *design;
    pzs_nonlinear tables;
    pzs_follower *follower;           /* [followers] tables of the follower loads */
    pzs_follower_load *follower_load; /* [followers] state of the follower loads */
    int followers;
    pzs_contact_face contact_face;
    pzs_body body;
    pzs_contact contact; /* attached where the scene has a contact */
    pzs_circuit circuit; /* attached where the scene has an open electrode */
    pzs_solver solver;
    double *full_input; /* [inputs] input values of the scene: loads and applied voltages */
    void *work, *contact_work, *circuit_work;
    size_t work_bytes, contact_bytes, circuit_bytes; /* sizes of the three workspaces */
} equilibrium;

/*
 * Build the tables and a solver in the reference state.
 *   design in      design of a scene whose kinematics is not linear; must outlive the result
 *   model  in/out  initialised on the structure of the design
 * Returns PZS_OK or the library's status; after an error the result is empty.
 */
pzs_status equilibrium_open(equilibrium *equilibrium, const design *design, pzs_model *model);
void equilibrium_close(equilibrium *equilibrium);

/*
 * Copy the state of a solver, to restore it later.
 *   state [equilibrium_state_bytes]  out, in
 */
size_t equilibrium_state_bytes(const equilibrium *equilibrium);
void equilibrium_save(const equilibrium *equilibrium, void *state);
void equilibrium_restore(equilibrium *equilibrium, const void *state);

/*
 * Value of an output of the contact.
 *   output in  its member `contact` is not CONTACT_NONE
 *   node   in  node of a contact pressure; ignored for other outputs
 */
double equilibrium_contact_output(const equilibrium *equilibrium, const scene_output *output,
                                  int node);

/*
 * Text on the position of the contact's body inside the shell and on what to do, from the last load
 * step that was refused or warned of.
 *   status  in   PZS_E_PENETRATION or PZS_W_BEHIND
 *   text    out  [SCENE_ERROR]
 */
void equilibrium_penetration_text(const equilibrium *equilibrium, pzs_status status, char *text);

#endif
