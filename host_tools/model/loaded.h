/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Vibration modes of a structure under its static loads, and how far the loads move the first
 * natural frequency. The modes are those about the nonlinear equilibrium, whose prestress changes
 * them, as in a membrane under tension or a plate under compression.
 */
#ifndef LOADED_H
#define LOADED_H

#include "coupling.h"

/* First natural frequency of a structure without and with its loads. */
typedef struct loaded_frequency {
    double unloaded, loaded; /* first natural frequency (Hz). unloaded: in the reference state;
                                loaded: about the equilibrium under the scene's loads at 0 V, or 0
                                if that equilibrium is unstable. NAN where there is none */
} loaded_frequency;

/*
 * Compute the first natural frequency of a scene without and with its loads, with nonlinear
 * kinematics whatever the scene says. Both are NAN without loads, densities or a structure, or
 * where an equilibrium was not found.
 */
loaded_frequency loaded_first(const scene *scene);

/*
 * Vibration modes of a scene: about the equilibrium under its loads where its kinematics is
 * nonlinear, otherwise about the reference state.
 */
typedef struct loaded_modes {
    analysis analysis; /* analysis of the scene. Without loads, or with linear kinematics, only its
                          member `design` (numerical model) is filled: no equilibrium is computed,
                          and the structure may have rigid motions. */
    vibration vibration;
    electrode_circuit circuit; /* circuits of the electrodes of the modes */
    bool is_loaded; /* true: the modes are those about the equilibrium under the scene's loads and
                       applied voltages; false: those of the reference state */
    loaded_frequency first;
    coupling coupling;     /* coupling factors of the modes where electrodes are open, otherwise
                              empty; bare faces are no electrodes */
    mesh_error mesh_error; /* estimated discretisation error of the frequencies; empty unless the
                              user has asked for this estimate */
    plausible warnings;
} loaded_modes;

/* Vibration modes that a user asks for. */
typedef struct modes_request {
    int number;                /* number of modes, reduced to the number that the structure has */
    electrode_circuit circuit; /* circuits of the electrodes while the structure vibrates */
} modes_request;

/*
 * Compute the vibration modes of a scene: about the deformed equilibrium if its kinematics is not
 * linear and loads, applied voltages or prescribed displacements deform it; otherwise about the
 * reference state. Returns 0, or -1 with error filled; call loaded_modes_close in either case.
 */
int loaded_modes_open(loaded_modes *modes, const scene *scene, const modes_request *request,
                      char *error);
void loaded_modes_close(loaded_modes *modes);

#endif
