/*
 * A closed loop on the host: the library's controller with the tables of the scene, a plant it does
 * not quite know, sensors and amplifiers with their faults, and the scene's schedule. Quasi-static,
 * one shape a tick:
 *
 *   events, shape under the volts of the tick before, measurement, controller, amplifiers
 *
 * The controller is the library's own here, or a firmware with the same tables on a board
 * (simulate_device). The same scene gives the same bits in every run. Beside the controller the
 * same loop runs with what is often done instead: least squares without limits, cut to limits and
 * step limit; and the same with the regularisation parameter that is the best one for the scene's
 * target and limits on the controller's own model.
 */
#ifndef SIMULATE_H
#define SIMULATE_H

#include "simulate_types.h"

/*
 * Read the plant, lay out the phases.
 *   nominal in  after analysis_influence, of a scene with a simulate section; must outlive the
 * simulation Returns 0, or -1 with error filled and *s empty.
 */
int simulate_open(simulation *simulation, analysis *nominal, char *error);
void simulate_close(simulation *simulation);

/*
 * Make the tables of an analysis those of its scene's controller: nothing to do, or where the scene
 * asks for it the influence of all inputs at the nonlinear optimum that it believes in. Returns 0,
 * or -1 with error filled.
 */
int simulate_tables(analysis *nominal, char *error);

/*
 * The firmware of a board in place of the controller: built now, run by QEMU in simulate_run. Its
 * twin, the same C in the same precision on this computer, answers beside it, and every bit is
 * compared. Returns 0, or -1 with error filled.
 */
int simulate_device(simulation *simulation, const device_board *board, char *error);

/* Run all ticks under a law. watch may be NULL. Returns 0, or -1 with error filled. */
int simulate_run(simulation *simulation, simulate_law law, simulate_watch *watch, void *context,
                 char *error);

/* The optimum of each phase, after simulate_run. Returns 0, or -1 with error filled. */
int simulate_optima(simulation *simulation, char *error);

/* Ticks in which the law ran. */
long simulate_ran(const simulate_count *count);

#endif
