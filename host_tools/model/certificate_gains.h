/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Spectral radius of a control loop with gains and leaks of modes (pzs_modal_gains) on a structure
 * with mass. Structure, readings and amplifiers are those of certificate.h. The voltages of the
 * controller are divided into parts, one for each pair of gain g and leak l. In each tick, a part v
 * becomes
 *   (1 - g - l) v - g F (q - r)
 *   F  voltages that a step with g = 1, l = 0 subtracts for measured modal coordinates
 *   q  modal coordinates measured `delay` ticks before
 *   r  modal coordinates that the model expects for the voltages of that tick
 */
#ifndef CERTIFICATE_GAINS_H
#define CERTIFICATE_GAINS_H

#include "certificate.h"
#include "modal_gains.h"

/*
 * Voltages with one gain and one leak, described by coordinates: their components along the modes
 * (voltage patterns with gains of their own), or the static coordinates of the vibration modes
 * under these voltages if these are fewer.
 */
typedef struct certificate_group {
    double gain, leak;
    size_t size;    /* number of coordinates by which the voltages of the group are described */
    double *shape;  /* [vibration modes][size] static coordinate of each vibration mode under the
                       voltages that belong to a unit of each coordinate of the group */
    double *answer; /* [size][vibration modes] what the controller subtracts for a measured unit of
                       each vibration mode in a step with gain 1 and leak 0: coordinates of these
                       voltages */
} certificate_group;

typedef struct certificate_groups {
    size_t modes; /* number of vibration modes */
    size_t count;
    certificate_group *group; /* [count] groups of voltages; voltages with gain 0 and leak 0, which
                                 never change, have no group */
} certificate_groups;

/*
 * Model of the control loop in which each step goes all the way to the least-squares voltages (gain
 * 1 and leak 0 of all voltages). Amplifiers that are held at one voltage are left out.
 */
typedef struct certificate_answers {
    size_t modes, moving; /* number of vibration modes, and number of amplifiers that are not held
                             at one voltage */
    const size_t *amplifier; /* [moving] indices of the amplifiers that are not held at one voltage
                              */
    const double *modal_response; /* [modes][moving] static coordinate of each vibration mode per
                                     volt */
    const double *answer; /* [modes][moving] voltages (V) that a control step subtracts if the
                             readings show one unit of a vibration mode */
} certificate_answers;

/*
 * Divide the voltages of the loop into groups of equal gain (part of the wanted change that a tick
 * makes) and equal leak (part of the voltages that a tick removes). Returns whether memory
 * sufficed; certificate_groups_free releases the groups in either case.
 */
bool certificate_groups_make(certificate_groups *groups, const pzs_modal_gains *gains,
                             const certificate_answers *answers);
void certificate_groups_free(certificate_groups *groups);

/* Return the number of states of the loop: the order of its transition matrix. */
size_t certificate_groups_order(const pzs_modal_gains *gains, size_t modes, size_t moving,
                                const certificate_conditions *conditions);

/*
 * Test the stability of a loop whose voltages have gains (parts of the wanted change that a tick
 * makes) and leaks (parts that a tick removes). certificate_groups_radius returns its spectral
 * radius, NAN where memory runs out; certificate_groups_decay returns whether the radius is below
 * 1.
 *   square  [modes]     in  squares of the vibration modes' angular frequencies (rad^2/s^2)
 *   damping [modes]     in  damping ratios
 *   conditions          in  static response of the structure relative to the model, delay of the
 *       readings, tick interval, and lag of the amplifiers
 *   squarings           in  number of matrix squarings from which the radius is computed
 */
double certificate_groups_radius(const certificate_groups *groups, const double *square,
                                 const double *damping, const certificate_conditions *conditions,
                                 int squarings);
bool certificate_groups_decay(const certificate_groups *groups, const double *square,
                              const double *damping, const certificate_conditions *conditions,
                              int squarings);

#endif
