/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The structure as it is, for a simulation: the scene's with other constants, loads of any amount
 * and a temperature. Its controller knows none of that. Quasi-static: each shape is an equilibrium.
 */
#ifndef PLANT_H
#define PLANT_H

#include "../model/voltages.h"

typedef struct plant {
    scene scene; /* its own copy */
    analysis analysis;
    double *amount;  /* [inputs] voltages, loads, temperature, body: of the shape asked for */
    double *reached; /* [inputs] of the shape reached last */
    double *full;    /* [inputs] loads and moving supports as the scene says */
    double *value;   /* [output rows] of the last shape */
    int temperature; /* input of the temperature, or -1 */
    int moved;       /* some shape has been reached */
    long systems;    /* linear systems solved by the nonlinear path */
} plant;

/*
 * Read the scene once more and give it the constants and kinematics of its simulate section.
 * All loads act in full, no temperature. Returns 0, or -1 with error filled and *p empty.
 */
int plant_open(plant *plant, const scene *nominal, char *error);
void plant_close(plant *plant);

/* Change the amount of a load (1: as the scene says) and the temperature. */
void plant_load(plant *plant, int load, double amount);
void plant_warm(plant *plant, double kelvin);

/* Back to all loads in full, no temperature; the next shape is reached from rest. */
void plant_rest(plant *plant);

/*
 * Shape under voltages: the equilibrium from the last shape, or the linear sum.
 *   volt [amplifiers] in, shape [targets] out
 */
int plant_shape(plant *plant, const double *voltage, double *shape, char *error);

/* What the readings of the scene's estimate show of the last shape, without noise. reading
 * [sensors] out */
int plant_readings(plant *plant, double *reading, char *error);

/* Displacement of the last shape. u [dof] out */
int plant_displacement(plant *plant, double *u, char *error);

/*
 * The best voltages for a target on this structure under the loads and temperature in force, step
 * limit left out. target [targets] in held   [amplifiers] in  voltages of electrodes that cannot be
 * chosen, NAN for the others best   out  voltages_free it shape  [targets] out  under them
 */
int plant_optimum(plant *plant, const double *target, const double *held, voltages *best,
                  double *shape, char *error);

#endif
