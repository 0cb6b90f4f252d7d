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
    pzs_follower *follower;  /* [followers] */
    pzs_follower_load *load; /* [followers] */
    int followers;
    pzs_contact_face face;
    pzs_body body;
    pzs_contact contact; /* attached where the scene has one */
    pzs_circuit circuit; /* attached where the scene has an open electrode */
    pzs_solver run;
    double *full; /* [inputs] the scene's loads and applied volts */
    void *work, *contact_work, *circuit_work;
    size_t bytes, contact_bytes, circuit_bytes; /* of each */
} equilibrium;

/*
 * Build the tables and a path at rest.
 *   d      in     design of a scene whose kinematics is not linear; must outlive the path
 *   model  in/out initialised on d's structure
 * Returns PZS_OK, or the library's status; on failure *p is empty.
 */
pzs_status path_open(equilibrium *p, const design *design, pzs_model *model);
void path_close(equilibrium *p);

/*
 * Copy what a path has reached, to come back to it.
 *   state [path_state_bytes] out, in
 */
size_t path_state_bytes(const equilibrium *p);
void path_keep(const equilibrium *p, void *state);
void path_return(equilibrium *p, const void *state);

/*
 * Value of an output of contact.
 *   output in  its contact is not CONTACT_NONE
 *   node   in  of a contact pressure; not read for the others
 */
double path_contact_output(const equilibrium *p, const scene_output *output, int node);

/*
 * Where and how the body of the contact lies in the shell, and the cure, as the last load step that
 * was refused or warned of found it.
 *   status in   PZS_E_PENETRATION or PZS_W_BEHIND
 *   text   out  [SCENE_ERROR]
 */
void path_penetration(const equilibrium *p, pzs_status status, char *text);

#endif
