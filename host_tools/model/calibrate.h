/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Influence matrix from measurements. A poke is a measurement of the shape under known voltages of
 * all actuators, so that S = V B' + noise. Without a model, B is the least-squares solution, from
 * as many independent pokes as actuators. With a model, fewer pokes suffice:
 *   B' = B0' + V' (V V' + q I)^-1 (S - V B0').
 *   S   [pokes][outputs] measured shapes
 *   V   [pokes][actuators] voltages
 *   B   [outputs][actuators] influence matrix, B0 that of the model; ' is the transpose
 *   q   variance of the noise over that of independent errors of the entries of B0, chosen by
 *       maximum likelihood
 */
#ifndef CALIBRATE_H
#define CALIBRATE_H

#include <stdbool.h>
#include "../scene/scene.h"
#include "pokes.h"

typedef struct calibration {
    double *influence; /* [outputs][actuators] computed influence matrix (unit of the outputs per
                          volt) */
    double *error;     /* [actuators] standard error of the entries of each column of the influence
                          matrix. Without a model it is NAN where the measured shapes are too few to
                          determine the noise */
    double noise; /* standard deviation of the noise of the measured shapes; NAN where there are too
                     few measurements to separate the noise from errors of the influence matrix */
    double spread; /* standard deviation by which the entries of the model's influence matrix differ
                      from those of the true one; 0 without a model */
    int rank; /* number of linearly independent combinations of actuators that the voltages of the
                 measured shapes (pokes) excite */
    double residual; /* root mean square difference between the measured shapes and those that the
                        computed influence matrix predicts */
} calibration;

/*
 * Compute the influence matrix from pokes (shapes measured under known voltages).
 *   model [outputs][actuators] in   influence matrix of a model, or NULL
 *   error [SCENE_ERROR]        out  message
 * Returns 0, or -1 with error filled: memory ran out, or there is no model and the pokes do not
 * determine every actuator. Call calibration_free in either case.
 */
int calibrate(calibration *result, const pokes *pokes, const double *model, char *error);
void calibration_free(calibration *result);

/*
 * Displacement of one output that an influence matrix predicts for the voltages of one measured
 * shape.
 */
double calibration_predict(const pokes *pokes, const double *influence, size_t poke, size_t output);

/*
 * Return the standard deviation of the noise of one output: root mean square of its readings minus
 * those that the influence matrix predicts. With few pokes (measured shapes) this is inaccurate.
 * The result is therefore a mean, in which the noise of all outputs has the weight of NOISE_POKES
 * further pokes. If the pokes leave no information on noise, it is the noise of all outputs, which
 * may be NAN.
 */
#define NOISE_POKES 4
double calibration_output_noise(const calibration *result, const pokes *pokes, size_t output);

/*
 * Return the standard error of one entry of the influence matrix, in the unit of the outputs per
 * volt. It is the standard error of the column. If the noise is known, it is multiplied by the
 * noise of the entry's output over the noise of all outputs.
 */
double calibration_entry_error(const calibration *result, const pokes *pokes, size_t output,
                               size_t actuator);

/*
 * Root mean square of the measured shapes relative to that of the shapes that a model predicts.
 *   model [outputs][actuators] in  influence matrix of the model
 * Returns infinity where the model predicts zeros.
 */
double calibration_size(const pokes *pokes, const double *model);

/* ---- faults ----------------------------------------------------------- */

typedef enum wiring_fault_type {
    WIRING_DEAD,     /* wiring fault: the electrode does not act on the structure */
    WIRING_REVERSED, /* wiring fault: the electrode acts with the opposite sign */
    WIRING_SWAPPED /* wiring fault: the cables of this electrode and of the electrode with the index
                      `other` are exchanged */
} wiring_fault_type;

typedef struct wiring_fault {
    wiring_fault_type type;
    size_t actuator, other;
} wiring_fault;

enum { WIRING_FAULTS = 16 };

/*
 * Find faults of electrodes and cables that explain the difference between measured shapes and a
 * model: first pairs of exchanged cables, if that lowers the sum of squared differences by at least
 * the fraction WIRING_GAIN; then electrodes that do not act or act with the opposite sign.
 *   fault          out  faults found, each with the index of its electrode
 *   model [outputs][actuators] in  influence matrix of the model
 * Returns the number of faults, or -1 where memory runs out.
 */
#define WIRING_GAIN 0.3
int wiring_find(wiring_fault fault[WIRING_FAULTS], const pokes *pokes, const double *model);

/*
 * Compute the voltages that reach the electrodes in all pokes (measurements of the shape under
 * known voltages) if the wiring has the given faults.
 *   voltage  [pokes][actuators] out  voltages at the electrodes in each poke (V)
 */
void wiring_apply(const wiring_fault *fault, int faults, const pokes *pokes, double *voltage);

/*
 * Convert an influence matrix whose columns belong to electrodes into one whose columns belong to
 * the amplifiers, with the given wiring faults.
 *   influence [outputs][actuators] in/out  matrix before and after the conversion
 *   error     [actuators]          in/out  standard errors of the columns; 0 for dead electrodes
 */
void wiring_matrix(const wiring_fault *fault, int faults, const pokes *pokes, double *influence,
                   double *error);

/* Cross-talk: the voltage of one amplifier also acts on the electrode of another one. */
typedef struct crosstalk {
    size_t actuator, other; /* actuator: index of an amplifier; other: index of the amplifier on
                               whose electrode the voltage of the first one also acts */
    double part, error;     /* part of the amplifier's voltage that acts on the other amplifier's
                               electrode (dimensionless), and its standard error */
} crosstalk;

/*
 * Find cross-talk by fitting each column of the computed influence matrix by its own column of the
 * model and the one other column that fits best.
 *   found        out  cross-talk found, at most one for each amplifier
 *   size         in   pokes (shapes measured under known voltages), from which only the numbers of
 *                     actuators and outputs are used
 *   model [outputs][actuators] in  influence matrix of the model, of the amplifiers as wired
 * Cross-talk counts on three conditions: the other column explains at least CROSSTALK_SHARE of the
 * sum of squares that the own column leaves unexplained; its factor is at least CROSSTALK_PART; and
 * this factor is at least five times its standard error. Returns the number found; 0 where the
 * pokes (measured shapes) do not determine the noise or an actuator.
 */
#define CROSSTALK_PART 0.03
#define CROSSTALK_SHARE 0.8
int crosstalk_find(crosstalk found[WIRING_FAULTS], const calibration *result, const pokes *size,
                   const double *model);

/*
 * Whether the voltage of an actuator is 0 in all measurements (pokes), which then contain no
 * information on this actuator.
 */
bool calibration_is_idle(const pokes *pokes, size_t actuator);

/*
 * Whether an actuator seems to have no effect, in an influence matrix that was computed without a
 * model: its column is below 5 % of the median column and not above four standard errors.
 */
bool calibration_is_dead(const calibration *result, const pokes *pokes, size_t actuator);

#endif
