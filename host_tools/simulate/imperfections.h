/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Imperfections of the hardware in a simulation. Those of amplifiers, cables and ceramic change the
 * voltages that act on the structure. Those of sensors change the readings that the controller
 * receives. `pzs simulate` and the plants that `pzs fmu` exports use these functions.
 */
#ifndef IMPERFECTIONS_H
#define IMPERFECTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "../model/actuator_effect.h"

enum { PLAYS = 4, CREEPS = 3 };

typedef enum electrode_fault { ELECTRODE_GOOD, ELECTRODE_DEAD, ELECTRODE_STUCK } electrode_fault;

/*
 * State of the electrode that an amplifier drives on the piezoelectric ceramic. Models:
 *   hysteresis  Prandtl-Ishlinskii: play operators with half widths of 1/8 to 4/8 of half the
 *       voltage range. The loop of a full cycle is as wide as the scene's hysteresis times the
 *       voltage range
 *   creep       three first-order lags, with time constants that differ by factors of ten
 */
typedef struct electrode {
    electrode_fault fault;
    double fault_voltage; /* constant voltage that a faulty electrode keeps, whatever its amplifier
                             does (V) */
    double output;        /* output of the amplifier's first-order lag (V) */
    double play[PLAYS];   /* output of each play operator of the hysteresis model (V) */
    double creep[CREEPS]; /* output of each first-order lag of the creep model (V) */
    int failed_at;        /* number of the tick in which the latest fault of the electrode began */
    int announced_at, repaired_at; /* announced_at: number of the tick in which the fault is
                                      announced to the controller; repaired_at: number of the tick
                                      in which the fault ends by itself; -1: never */
    bool is_held; /* true: the controller treats the electrode as having a fixed voltage, because
                     its fault was announced or detected */
} electrode;

/*
 * State of a sensor: the ticks until which the sensor gives no reading (NaN), repeats a stuck
 * reading or reads too much, and the drift of the sensor.
 */
typedef struct sensor {
    int nan_until, stuck_until, wrong_until;
    double error; /* what is added to the reading of a wrong sensor (unit of the reading) */
    double slope; /* drift of the sensor's reading (unit of the reading per second) */
} sensor;

/*
 * Constants of the imperfections of the hardware around a simulated plant (amplifiers, cables,
 * ceramic, sensors). Where a constant is 0, the hardware does not have the imperfection.
 */
typedef struct imperfection_tables {
    int amplifiers;
    const double *lower, *upper; /* [amplifiers] lower and upper voltage limits of the amplifiers
                                    (V) */
    double hysteresis; /* width of the ceramic's hysteresis loop relative to the voltage range */
    double bandwidth;  /* corner frequency of the amplifiers' first-order lag (Hz) */
    double creep;   /* creep of the ceramic: increase of strain per decade of time, as a fraction of
                       the strain that the voltage causes */
    double drift;   /* largest drift of a sensor (unit of the reading per second) */
    double quantum; /* quantisation step of the sensor readings (unit of the reading) */
    double outlier_chance; /* probability that a sensor reading is an outlier */
    double outlier_size;   /* largest error of a sensor reading that is an outlier (unit of the
                              reading) */
    int reversals;         /* number of amplifiers whose two wires are exchanged */
    const int *reversed; /* [reversals] indices of the amplifiers whose two wires are exchanged, so
                            that their polarity is wrong */
    int swaps;           /* number of amplifiers whose cables are exchanged in pairs */
    const int *swapped;  /* [swaps] indices of the amplifiers with exchanged cables: the first is
                            exchanged with the second, the third with the fourth */
    actuator_curves curves; /* curves of actuators that are not linear: effect of a voltage, to
                               which the displacement is proportional */
} imperfection_tables;

/*
 * Number of equal parts into which the simulation divides the time between two ticks if voltages or
 * loads vary during this time.
 */
enum { IMPERFECTION_PARTS = 8 };

/*
 * State of the hardware in a running simulation that has imperfections: its electrodes, its sensors
 * and the time.
 */
typedef struct imperfections {
    imperfection_tables tables;
    electrode *electrode; /* [amplifiers] state of the electrode of each amplifier: faults, outputs
                             of amplifier lag, hysteresis and creep */
    sensor *sensor;       /* [sensors] state of each sensor: its faults and its drift */
    int sensors;
    uint64_t *random; /* state of the random number generator of the simulation */
    double time;      /* time since the start of the simulation (s) */
} imperfections;

/*
 * Advance the first-order lag of an amplifier by a time interval with a constant command. Returns
 * the mean output voltage over the interval, or for length 0 the present one (V).
 *   output    in/out  output voltage of the amplifier (V)
 *   command   in      commanded output voltage (V)
 *   bandwidth in      corner frequency of the lag (Hz)
 *   interval  in      length of the interval (s)
 */
double amplifier_lag(double *output, double command, double bandwidth, double interval);

/*
 * Return the voltage that acts on the ceramic of an electrode with hysteresis (V).
 *   play [PLAYS] in/out  outputs of the play operators of the electrode (V)
 *   voltage      in      voltage of the electrode (V)
 *   half_range   in      half the range of the voltages (V)
 *   hysteresis   in      width of the hysteresis loop of a full cycle relative to this range
 */
double imperfections_play(double play[PLAYS], double voltage, double half_range, double hysteresis);

/*
 * Return whether the voltages on the ceramic vary between two ticks, because the amplifiers have a
 * first-order lag.
 */
bool imperfections_vary(const imperfection_tables *tables);

/*
 * Advance the amplifiers and electrodes by a time interval with constant commands.
 *   output [amplifiers] in   commanded output voltages of the amplifiers (V)
 *   interval            in   length of the interval (s)
 *   effect [amplifiers] out  mean voltages that act on the ceramic in the interval (V); for length
 *                            0 the present ones. For actuators whose displacement is a curve over
 *                            the voltage: the value of that curve at these voltages
 */
void imperfections_actuate(const imperfections *imperfections, const double *output,
                           double interval, double *effect);

/*
 * Compute the lowest and highest voltages that act on the ceramic if all amplifiers move to their
 * voltage limits at once. Hysteresis, creep and faults make them differ from the limits. The states
 * of the electrodes do not change.
 *   lowest, highest [amplifiers] out  voltages on the ceramic (V), infinite where the voltage limit
 *       is infinite, equal for a faulty electrode
 * Returns whether memory was available.
 */
bool imperfections_stroke(const imperfections *imperfections, double *lowest, double *highest);

/* Draw the drift of each sensor at random, before the first tick of a simulation. */
void imperfections_draw(const imperfections *imperfections);

/*
 * Return the reading of a sensor after drift, outliers and quantisation.
 *   value in  true value plus noise
 */
double imperfections_sense(const imperfections *imperfections, int sensor, double value);

/*
 * Compute the readings that the controller receives at a tick, with noise, imperfections and
 * faults.
 *   noise   [sensors] in      standard deviation of the noise (unit of each reading)
 *   exact   [sensors] in      readings without noise and imperfections
 *   reading [sensors] in/out  latest reading of each sensor, also of a missing one; a stuck sensor
 *       repeats it bit for bit
 *   sensed  [sensors] out     readings for the controller, NaN where a sensor gives nothing
 */
void imperfections_read(const imperfections *imperfections, int tick, const double *noise,
                        const double *exact, double *reading, double *sensed);

#endif
