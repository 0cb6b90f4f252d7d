/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Contact with a fixed rigid body on a load path of the arc-length method: the set of nodes that
 * touch the body and their pressures follow the corrections of each step.
 */
#ifndef ARC_CONTACT_H
#define ARC_CONTACT_H

#include "analysis.h"

/* Contact of a structure on a load path of the arc-length method. */
typedef struct arc_contact {
    pzs_contact *contact; /* contact of the equilibrium solver with the rigid body; NULL: the scene
                             has no contact */
    pzs_solver *solver;   /* equilibrium solver to which the contact is attached */
    void *pressures; /* contact pressures and set of nodes in contact at the last converged point of
                        the load path */
    size_t bytes;    /* size of the array `pressures` (bytes) */
    pzs_status refused; /* reason why the contact refused the last converged step of the load path;
                           PZS_OK: not refused */
} arc_contact;

/*
 * Return whether the arc-length method follows the contact of a scene: its body is fixed, and the
 * supports alone hold the shell.
 */
bool arc_contact_fits(const analysis *analysis);

/*
 * Prepare the contact of an analysis, if it has one, for a load path of the arc-length method.
 * Returns 0, or -1 where memory runs out.
 */
int arc_contact_open(arc_contact *contact, analysis *analysis);
void arc_contact_close(arc_contact *contact);

/*
 * Choose the nodes in contact at the present displacement of the solver, before one of the Newton
 * corrections of a step along the load path.
 *   iteration in  number of this correction within the step, from 0
 *   increment in  norm of the preceding correction over the norm of the whole displacement change
 *       in the step so far; 1 for the first correction
 */
void arc_contact_prepare(const arc_contact *contact, int iteration, double increment);

/*
 * Predict the contact pressures after a change du [free_dof] of the displacement, which the
 * solver's displacement does not contain yet.
 */
void arc_contact_predict(const arc_contact *contact, const double *du);

/* Return whether the contact has converged at the present displacement of the solver. */
bool arc_contact_has_converged(const arc_contact *contact);

/*
 * Return whether the rigid body stays outside the shell between the nodes, too, at the converged
 * displacement of the solver. If not, the reason is stored in contact->refused.
 */
bool arc_contact_accepts(arc_contact *contact);

/*
 * Functions for steps of the load path that may be refused. arc_contact_save stores the present
 * contact as that of the last converged point; arc_contact_restore returns to the stored contact.
 */
void arc_contact_save(const arc_contact *contact);
void arc_contact_restore(const arc_contact *contact);

/*
 * arc_contact_keep copies the present contact pressures to the array contact->pressures;
 * arc_contact_take_back copies them back.
 */
void arc_contact_keep(const arc_contact *contact);
void arc_contact_take_back(const arc_contact *contact);

#endif
