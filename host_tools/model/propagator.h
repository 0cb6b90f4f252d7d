/* SPDX-License-Identifier: BSD-2-Clause */
/* Free vibration of one mode over an interval. */
#ifndef PROPAGATOR_H
#define PROPAGATOR_H

/*
 * Propagator of (deviation d from equilibrium, velocity p = (dd/dt)/w) of one mode over an interval
 * without change of the inputs: d' = r[0] d + r[1] p, p' = r[2] d + r[3] p. It is exact, below and
 * above critical damping.
 */
void modal_propagator(double frequency, double damping, double interval, double r[4]);

#endif
