/*
 * Storms on a list of structures: target jumps faster than the voltages can follow, then rest. The
 * structures are simulated in double. The controller is the one of the host tools, or one of the
 * calling program, which may be compiled in single precision.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef STORM_SWEEP_H
#define STORM_SWEEP_H

#include <stdbool.h>
#include <stdint.h>

/* Tables of a loop that damps vibration, in double: members of pzs_problem and pzs_vibration. */
typedef struct storm_tables {
    uint16_t inputs, outputs, sensors, modes, delay;
    uint64_t work_limit;
    const double *influence, *hessian, *weight, *lower, *upper, *step_limit, *reference_voltage;
    double regularisation;
    const double *shape, *reading, *direct, *gain, *precision; /* all but shape may be NULL */
    const double *modal, *turn, *observer, *explain, *damping, *inverse_angle;
    double share, mix, slow;
} storm_tables;

/* A controller that takes the place of the one of the host tools. */
typedef struct storm_controller {
    const char *name; /* its precision, for the messages */
    /* Start the controller at 0 V in place of the one before. Returns whether that succeeded. */
    bool (*start)(const storm_tables *tables);
    /*
     * Run one tick. Returns whether its status is not an error.
     *   wanted   [outputs] in   target shape (m)
     *   measured [sensors] in   readings
     *   voltage  [inputs]  out  voltages (V)
     */
    bool (*tick)(const double *wanted, const double *measured, double *voltage);
} storm_controller;

/*
 * Run ten storms with one delay on three structures, or, where `is_full`, 40 storms with four
 * delays on all structures; print the numbers of storms that do not settle. Without a controller
 * the short run also tries clipped least squares, and the full one all laws. only       in  first
 * characters of the names of the structures of the full run controller in  controller of the damped
 * tick; NULL: the one of the host tools same       in  controller whose storms must have the bits
 * of those of the host tools; NULL: none Returns 0 where every storm of the damped tick settles and
 * no storm of clipped least squares of the short run does.
 */
int bridge_storms(bool is_full, const char *only, const storm_controller *controller,
                  const storm_controller *same);

#endif
