/* SPDX-License-Identifier: BSD-2-Clause */
/* Contact on a load path of the arc-length method (arc_contact.h). */
#include "arc_contact.h"
#include <stdlib.h>
#include <string.h>
#include "../../lib/nonlinear/nonlinear.h"

bool arc_contact_fits(const analysis *analysis)
{
    const design *design = &analysis->design;
    bool moves = false;
    for (int i = 0; i < 3; i++)
        moves |= design->contact.move[i] != 0;
    return !design->contact.given || (!moves && !analysis->equilibrium.contact.state.is_loose);
}

int arc_contact_open(arc_contact *contact, analysis *analysis)
{
    equilibrium *equilibrium = &analysis->equilibrium;
    memset(contact, 0, sizeof *contact);
    if (!analysis->design.contact.given)
        return 0;
    contact->pressures = malloc(equilibrium->contact_bytes);
    if (!contact->pressures)
        return -1;
    contact->contact = &equilibrium->contact;
    contact->solver = &equilibrium->solver;
    contact->bytes = equilibrium->contact_bytes;
    return 0;
}

void arc_contact_close(arc_contact *contact)
{
    free(contact->pressures);
    memset(contact, 0, sizeof *contact);
}

void arc_contact_prepare(const arc_contact *contact, int iteration, double increment)
{
    if (!contact->contact)
        return;
    pzs_solver_option *option = &contact->contact->option;
    contact->solver->state.iteration = (uint16_t)iteration;
    contact->solver->info.relative_increment = increment;
    (void)option->call->prepare_solve(option, contact->solver);
}

void arc_contact_predict(const arc_contact *contact, const double *du)
{
    if (contact->contact)
        contact->contact->option.call->after_solve(&contact->contact->option, contact->solver, du);
}

bool arc_contact_has_converged(const arc_contact *contact)
{
    return !contact->contact ||
           contact->contact->option.call->has_converged(&contact->contact->option, contact->solver);
}

bool arc_contact_accepts(arc_contact *contact)
{
    contact->refused = PZS_OK;
    if (!contact->contact)
        return true;
    pzs_solver_option *option = &contact->contact->option;
    const pzs_status status = option->call->check_step(option, contact->solver);
    contact->refused = PZS_IS_ERROR(status) ? status : PZS_OK;
    return contact->refused == PZS_OK;
}

void arc_contact_save(const arc_contact *contact)
{
    if (contact->contact)
        contact->contact->option.call->save(&contact->contact->option, contact->solver);
}

void arc_contact_restore(const arc_contact *contact)
{
    if (contact->contact)
        contact->contact->option.call->restore(&contact->contact->option, contact->solver);
}

void arc_contact_keep(const arc_contact *contact)
{
    if (contact->contact)
        memcpy(contact->pressures, contact->contact->state.pressure, contact->bytes);
}

void arc_contact_take_back(const arc_contact *contact)
{
    if (contact->contact)
        memcpy(contact->contact->state.pressure, contact->pressures, contact->bytes);
}
