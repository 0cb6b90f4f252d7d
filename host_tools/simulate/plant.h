/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The plant of a simulation: the structure of the scene with other material constants, loads of any
 * size and a temperature change. The controller does not know these differences. The plant is
 * quasi-static: each shape is an equilibrium.
 */
#ifndef PLANT_H
#define PLANT_H

#include "../model/voltages.h"

typedef struct plant {
    scene scene; /* copy of the scene with the constants of the plant */
    analysis analysis;
    double *amount; /* [inputs] voltages, loads, temperature change and body inputs of the requested
                       shape */
    double *reached; /* [inputs] inputs of the latest computed shape */
    double *full;    /* [inputs] loads and support displacements as given in the scene */
    double *value;   /* [output rows] output values of the latest shape */
    int temperature; /* index of the temperature input, or -1 */
    int moved;       /* at least one shape has been computed */
    long systems;    /* number of linear systems solved by the nonlinear path */
} plant;

/*
 * Read the scene again and apply the constants and kinematics of its simulate section. All loads
 * have the factor 1 and the temperature change is zero. Returns 0, or -1 with error filled and the
 * plant empty.
 */
int plant_open(plant *plant, const scene *nominal, char *error);
void plant_close(plant *plant);

/* Set the factor of a load (1: the load given in the scene) and the temperature change. */
void plant_load(plant *plant, int load, double amount);
void plant_warm(plant *plant, double kelvin);

/*
 * Reset all loads to the factor 1 and the temperature change to zero; the next shape is computed
 * from the rest shape.
 */
void plant_rest(plant *plant);

/*
 * Shape of the plant under voltages: on a nonlinear structure the equilibrium, computed from the
 * latest shape; on a linear one the sum of the influence columns.
 *   voltage [amplifiers] in  (V)
 *   shape [targets] out  displacements
 */
int plant_shape(plant *plant, const double *voltage, double *shape, char *error);

/*
 * Noise-free readings of the sensors of the scene's `estimate` section in the latest shape.
 *   reading [sensors] out
 */
int plant_readings(plant *plant, double *reading, char *error);

/* Displacement vector of the latest shape. u [dof] out */
int plant_displacement(plant *plant, double *u, char *error);

/*
 * Optimal voltages for a target on this structure under the present loads and temperature, without
 * the step limit.
 *   target [targets] in  wanted displacements
 *   held [amplifiers] in  voltages of faulty electrodes (V), NAN for the others
 *   best out  optimal voltages; release them with voltages_free
 *   shape [targets] out  displacements under the optimal voltages
 */
int plant_optimum(plant *plant, const double *target, const double *held, voltages *best,
                  double *shape, char *error);

#endif
