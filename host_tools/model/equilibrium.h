/*
 * What the nonlinear path needs of a scene besides its structure: given resultants, prescribed
 * displacements, follower loads and contact as the library's tables, and a path that runs on them.
 */
#ifndef EQUILIBRIUM_H
#define EQUILIBRIUM_H

#include "design.h"

typedef struct equilibrium {
    const design *design;
    pzs_nonlinear tables;
    pzs_follower *follower;           /* [followers] */
    pzs_follower_load *follower_load; /* [followers] */
    int followers;
    pzs_contact_face contact_face;
    pzs_body body;
    pzs_contact contact; /* attached where the scene has one */
    pzs_circuit circuit; /* attached where the scene has an open electrode */
    pzs_solver solver;
    double *full_input; /* [inputs] the scene's loads and applied volts */
    void *work, *contact_work, *circuit_work;
    size_t work_bytes, contact_bytes, circuit_bytes; /* of each */
} equilibrium;

/*
 * Build the tables and a path at rest.
 *   d      in     design of a scene whose kinematics is not linear; must outlive the path
 *   model  in/out initialised on d's structure
 * Returns PZS_OK, or the library's status; on failure *p is empty.
 */
pzs_status equilibrium_open(equilibrium *equilibrium, const design *design, pzs_model *model);
void equilibrium_close(equilibrium *equilibrium);

/*
 * Copy what a path has reached, to come back to it.
 *   state [equilibrium_state_bytes] out, in
 */
size_t equilibrium_state_bytes(const equilibrium *equilibrium);
void equilibrium_save(const equilibrium *equilibrium, void *state);
void equilibrium_restore(equilibrium *equilibrium, const void *state);

/*
 * Value of an output of contact.
 *   output in  its contact is not CONTACT_NONE
 *   node   in  of a contact pressure; not read for the others
 */
double equilibrium_contact_output(const equilibrium *equilibrium, const scene_output *output,
                                  int node);

/*
 * Where and how the body of the contact lies in the shell, and the cure, as the last load step that
 * was refused or warned of found it.
 *   status in   PZS_E_PENETRATION or PZS_W_BEHIND
 *   text   out  [SCENE_ERROR]
 */
void equilibrium_penetration_text(const equilibrium *equilibrium, pzs_status status, char *text);

#endif
