/* SPDX-License-Identifier: BSD-2-Clause */
/* Exact free vibration of one vibration mode over a time interval. */
#ifndef PROPAGATOR_H
#define PROPAGATOR_H

/*
 * Compute the propagator of one vibration mode over an interval with constant inputs, exact below
 * and above critical damping. With d the deviation from equilibrium and p = (dd/dt)/w,
 *   d after = r[0] d + r[1] p,  p after = r[2] d + r[3] p.
 *   frequency in   angular frequency w (rad/s)
 *   damping   in   damping ratio
 *   interval  in   length of the time interval (s)
 *   r [4]     out  factors in both equations (dimensionless)
 */
void modal_propagator(double frequency, double damping, double interval, double r[4]);

#endif
