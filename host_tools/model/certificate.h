/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Certificate of stability: whether the control loop is stable on a structure with mass, although
 * its step treats each measured shape as an equilibrium. The structure has the lowest vibration
 * modes and the static response of all others. The controller is pzs_tick without voltage limits,
 * because limits only slow the growth of a vibration. In each tick it changes the voltages from v
 * to
 *   -F (q - g v),  F = (B^T W^2 B + regularisation)^-1 B^T W^2 C.
 *   q     modal coordinates that were measured `delay` ticks before
 *   g     static modal coordinates per volt, according to the model
 *   B, C  influence matrix and mode shapes
 *   W     weights of the targets
 * Stability depends on the loop matrix g F alone.
 */
#ifndef CERTIFICATE_H
#define CERTIFICATE_H

#include <stdbool.h>
#include "certificate_matrix.h"
#include "damper_gains.h"
#include "vibration.h"

enum {
    CERTIFICATE_UNIT = 64, /* size of the text that names the unit of shape errors (characters) */
    CERTIFICATE_TEXT = 2500
}; /* largest length of the text that describes the result of the stability tests (characters) */

/*
 * A storm is a simulation with fast jumps of the target. It counts as settled where the distance of
 * the shape from the best shape within the voltage limits is at most this fraction of the norm of
 * the target (dimensionless).
 */
#define CERTIFICATE_TOLERANCE 0.05

/*
 * CERTIFICATE_LOAD_STEP: longest permitted time until 5 % of the effect of a suddenly applied load
 * are left (periods of the first observed mode). It applies where the phase of this mode advances
 * by less than CERTIFICATE_ANGLE (rad) in a tick; otherwise the ticks are too few.
 */
#define CERTIFICATE_LOAD_STEP 2.0
#define CERTIFICATE_ANGLE 0.6

/* Time after which the simulation of a load step ends (periods of the first observed mode). */
#define CERTIFICATE_LOAD_MOST 8.0

/*
 * Certificate of a control loop at its target shape: results of simulations of the structure,
 * linearised there, with the unchanged tables of the firmware. The structures that are tried differ
 * from the model: their static response is 0.8 to 1.33 times, their natural frequencies are 0.9 to
 * 1.1 times those of the model.
 */
typedef struct certificate_target {
    bool is_made;
    char reason[SCENE_ERROR]; /* why the stability of the loop was not tested on the structure
                                 deformed to its target although the scene's kinematics is not
                                 linear; otherwise empty */
    double amplitude; /* largest displacement of a target node where the shell has its target shape,
                         divided by the thickness */
    double first;     /* first natural frequency of the deformed structure, relative to that of the
                         reference state */
    bool is_stable; /* true where, on every structure tried, small vibrations decay and every storm
                       (simulation with fast jumps of the target) settles; the structures have
                       static responses and frequencies above and below those of the model */
    double radius;  /* largest growth factor of small vibrations per tick under the control loop,
                       with no voltage at its limits */
    int storms, failed; /* number of storms (simulations with fast jumps of the target); number of
                           those that did not settle */
    int older, newer; /* stability margins for the age of the sensor readings, each 0 or 1 tick, on
                         the structure deformed to its target. The loop stays stable if all readings
                         are older than the scene file states by `older` ticks, or newer by `newer`
                         ticks. */
    double worst;     /* largest distance of the shape, at the end of a storm (simulation with fast
                         target jumps), from the one at which the loop should come to rest; relative
                         to the norm of the target */
    double at_gain, at_frequency; /* structure on which the loop did worst: its static response to
                                     voltages (at_gain) and its natural frequencies (at_frequency),
                                     over those of the deformed structure. If storms (fast target
                                     jumps) failed, it is the one whose shape ended farthest from
                                     the best shape, otherwise the one whose small vibrations grew
                                     fastest */
} certificate_target;

/* Result of the stability tests of a loop with a sensor gate, which takes wrong readings away. */
typedef struct certificate_gate {
    int storms;   /* number of storms (simulations with fast jumps of the target) in which the gate
                     takes readings away, although no sensor is wrong */
    bool is_made; /* whether sensors were wrong, one after the other, in a simulation; what follows
                     is its result */
    int tried, sensor; /* number of sensors that were wrong, and the one that moved the shape most,
                          from 0 */
    double reading;    /* what this sensor read: the end of its range (unit of the sensor) */
    double moved;      /* by how much it moved the shape within two periods of the first observed
                          mode, in the unit of certificate_loop.worst */
    bool is_stopped;   /* whether the supervisor stopped the loop */
} certificate_gate;

/*
 * Certificate of a control loop with a vibration model: result of simulations with structures that
 * differ from the model (simulate/certify.h). A storm is a simulation with fast jumps of the
 * target.
 */
typedef struct certificate_loop {
    bool is_made;
    bool is_stable; /* true where, on every simulated structure, small vibrations decay and every
                       storm (simulation with fast jumps of the target) settles; the structures have
                       static responses and frequencies above and below those of the model */
    int modes;      /* number of vibration modes of the structure in the simulations that test the
                       stability of the control loop */
    int observed;   /* number of vibration modes that the observer of the control tick estimates */
    bool has_slow_mode; /* true where the phase of the first vibration mode advances little enough
                           in a tick for the observer of the control tick to estimate this vibration
                           mode */
    double observed_from, observed_to; /* lowest and highest natural frequency of the vibration
                                          modes that the control tick observes (Hz) */
    double radius; /* largest growth factor of small vibrations per tick under the control loop,
                      with no voltage at its limits */
    double at_gain, at_frequency; /* static response to voltages and natural frequencies, relative
                                     to the controller's model, of the simulated structure on which
                                     small vibrations grow most */
    int storms, failed; /* number of storms (simulations with fast jumps of the target), and number
                           of storms that did not settle */
    double worst; /* largest distance of the shape from the best shape within the voltage limits, at
                     the end of a storm (simulation with fast target jumps). Its unit is the norm of
                     the target. If this is small, the unit is a fiftieth of the root mean square
                     norm of the shapes that half the voltage range with random signs causes */
    double unit;  /* unit of `worst` over the norm of the target: 1, or more where the target is
                     small beside the shapes that the voltages reach; infinite for a zero target */
    /*
     * The storm (simulation with fast target jumps) with the largest distance `worst`:
     * worst_gain: factor by which its structure responds more to voltages than the model
     * worst_frequency: factor of the model's natural frequencies, the same one for all
     * worst_step: factor of the scene's step limits
     * worst_hysteresis: width of its hysteresis loop relative to the voltage range, which the loop
     *     does not compensate
     */
    double worst_gain, worst_frequency, worst_step, worst_hysteresis;
    double ticks; /* mean number of ticks until the shape has settled after fast jumps of the target
                   */
    double load_step; /* time until 5 % of the effect of a suddenly applied load are left (periods
                         of the first observed vibration mode), the longest of a few loads.
                         Simulations end after 8 periods, so that 8 or more means: not reached. NAN:
                         no mode is observed, or no load can be compensated */
    double angle; /* angle by which the phase of the first observed vibration mode advances in one
                     tick (rad): angular frequency times tick interval; 0: no mode is observed */
    double residual; /* time until the estimate of the controller contains 95 % of a sudden change
                        of the readings that the observed modes do not explain, such as a static
                        error of the model (periods of the first observed mode); NAN: no mode is
                        observed */
    double fading; /* time in which the vibration that the supervisor tolerates after a jump of the
                      target falls by the factor e (periods of the first observed mode); 0: no
                      supervisor, or not tested */
    int alarms;    /* number of storms (simulations with fast jumps of the target) in which the
                      supervisor stops the loop although nothing is wrong with it */
    certificate_gate gate;
    double hysteresis; /* width of the hysteresis loop of the ceramic, relative to the voltage
                          range, in further storms (simulations with fast target jumps), which the
                          loop does not compensate; 0: none, compensated, or not tried */
    int hysteresis_storms, hysteresis_failed; /* number of these storms (simulations with fast
                                                 target jumps), and of those that did not settle;
                                                 they are not part of `storms` and `failed` */
    double unseen; /* largest distance, in the unit of `worst`, between the shape at which a loop
                      with few sensors comes to rest on a ceramic with hysteresis and the best one:
                      sensors do not show all of the effect of hysteresis. 0: all storms
                      (simulations with fast target jumps) come near the best shape */
    double less_hysteresis; /* fraction by which the ceramic has less hysteresis than the scene file
                               says in a third of the storms (simulations with fast target jumps); 0
                               where the loop does not compensate hysteresis */
    int delay;              /* age of the readings that the scene file states (ticks) */
    double bandwidth;       /* corner frequency of the first-order lag of the amplifiers that the
                               scene file states (Hz); 0: no lag */
    double less_bandwidth;  /* part by which this corner frequency is lower in a third of the storms
                               (simulations with fast target jumps), and higher in another third */
    bool models_lag;        /* whether the control tick knows of the lag of the amplifiers */
    int older; /* largest number of ticks by which the sensor readings may be older than the scene
                  file states; at this and every smaller number, vibrations decay and the shape
                  settles after fast jumps of the target */
    int newer; /* largest number of ticks, up to the stated delay, by which the sensor readings may
                  be newer than the scene file states; at this and every smaller number, vibrations
                  decay and the shape settles after fast jumps of the target */
    certificate_target target; /* result of the stability tests of the loop on the structure that is
                                  deformed to its target */
    bool is_free_cause;        /* true where an unstable loop passes all stability tests if the free
                                  functions of the target (shapes that may be added at no cost;
                                  target.free) are left out */
    double cure; /* regularisation of the voltages with which an unstable loop passes all stability
                    tests, relative to the mean diagonal entry of the Hessian; 0: none was found */
    bool is_compensation_cure; /* true where an unstable loop passes all stability tests if it
                                  compensates the hysteresis of the simulated plant */
    double cures_tried; /* if the loop is unstable: largest regularisation of the voltages that was
                           tried in order to make it stable, relative to the mean diagonal entry of
                           the Hessian; 0: none */
    bool has_margins;
    double margin_gain; /* largest static response of the structure to voltages, relative to the
                           controller's model, with which the control loop is stable */
    bool ends_at_most;  /* true where the control loop is stable even with the largest delay of the
                           sensor readings that the simulations have tried */
    double margin_slow, margin_fast; /* lowest and highest natural frequencies of the structure,
                                        relative to the controller's model, with which the control
                                        loop is stable */
    bool has_rates;                  /* true after stable tick rates have been searched */
    double rate_from, rate_to; /* range of tick rates (1/s), around that of the scene or around the
                                  nearest stable one, at which the loop passes the tests of small
                                  vibrations and two storms (fast jumps of the target). Tables are
                                  made for each rate. 0: no such rate was found, or not searched */
} certificate_loop;

typedef struct certificate {
    bool is_made;   /* true after the stability of the control loop has been computed */
    bool has_modes; /* true where the vibration modes could be computed, which needs all densities
                     */
    char reason[SCENE_ERROR]; /* reason why the vibration modes are unknown or the loop was not
                                 assessed, and advice to the user */
    vibration vibration;
    bool is_loaded;    /* true where the vibration modes and the influence matrix belong to the
                          equilibrium under the scene's loads; false: the reference state */
    double load_ratio; /* first natural frequency about the equilibrium under the scene's static
                          loads relative to that of the reference state; 0: not computed, or the
                          equilibrium is unstable */
    bool is_assessed;  /* true where the scene has a target and amplifiers, so that the stability of
                          the control loop was assessed; the members of this struct after this one
                          are valid only then */
    bool assumes_measured; /* true where the stability tests treat every target node as measured,
                              because some of the scene's sensors read electrodes instead of
                              displacements */
    int modes; /* number of vibration modes of the structure in the model that the stability tests
                  use */
    double damping;       /* damping ratio of the structure's first vibration mode */
    bool has_own_damping; /* true where the scene file gives the damping ratio of the first
                             vibration mode; false where it is assumed */
    double bandwidth; /* corner frequency of the first-order lag of the amplifiers that the scene
                         file states (Hz); 0: no lag */
    /*
     * true where the scene has gains and leaks of modes (control.modal_gains). Such a loop never
     * damps vibration, and its stability is assessed at the tick rate of the scene alone:
     * stable_rate is this rate, or 0 if the loop is unstable there
     */
    bool has_gains;
    double rate;   /* tick rate of the scene (1/s); 0 where the scene file gives none */
    double radius; /* spectral radius of the loop at the scene's tick rate, the growth factor of
                      vibrations per tick; NAN without a rate */
    double gain;   /* approximate stability limit of the step gain, the fraction of the way from the
                      present to the optimal voltages that one tick makes. It is 2 x damping ratio x
                      angular frequency x tick interval of the first vibration mode; NAN without a
                      tick rate. */
    bool has_settings; /* true where simulations with fast jumps of the target have chosen the
                          settings of the control tick that damps vibration */
    damper_settings settings;  /* settings of the control tick that damps vibration, chosen by
                                  simulations with fast jumps of the target */
    certificate_loop loop;     /* result of the stability tests of the loop whose control tick damps
                                  vibration */
    certificate_matrix matrix; /* margin of the loop against errors of its influence matrix */
    double stable_rate; /* tick rate (1/s) up to which a loop without a vibration model is stable at
                           all rates tested; 0: none was found; infinite: every rate is stable.
                           Tested are the model, and structures with 0.8 to 1.33 times its response
                           to voltages and 0.9 to 1.1 times its natural frequencies */
} certificate;

void certificate_free(certificate *certificate);

/*
 * Return by how many ticks the sensor readings may be older (certificate_older) or newer
 * (certificate_newer) than the scene file states while the loop is stable. If the loop was also
 * tested at its target shape, both numbers hold there, too.
 */
int certificate_older(const certificate_loop *loop);
int certificate_newer(const certificate_loop *loop);

/* Range of tick rates as text, such as 250 to 32000, or one rate. */
typedef struct certificate_range {
    char text[64];
} certificate_range;

/*
 * Return the tick rates (1/s) at which the control loop passes the tests of small vibrations and
 * two storms (simulations with fast jumps of the target); the text is empty where there are none.
 */
certificate_range certificate_rates(const certificate_loop *loop);

/*
 * Return whether a control tick without a vibration model is known to be unstable at the scene's
 * tick rate, on one of the structures that are tried: the model, structures with 0.8 to 1.33 times
 * its response to voltages, and structures with 0.9 to 1.1 times its frequencies.
 */
bool certificate_refuses(const certificate *certificate);

/*
 * Whether the vibration modes are known, but not the tick rate, without which the control tick gets
 * no vibration model; false where a tick without such a model is stable at every rate.
 */
bool certificate_lacks_rate(const certificate *certificate);

/*
 * Whether the static loads are known to change the first natural frequency by more than 5 %, while
 * the stability tests and the tables of the loop belong to the structure without loads.
 */
bool certificate_is_prestressed(const certificate *certificate);

/*
 * First natural frequency of the structure (Hz) that does not belong to a rigid motion; NAN where
 * there is none.
 */
double certificate_first(const certificate *certificate);

/* Conditions under which the spectral radius of a control loop is computed. */
typedef struct certificate_conditions {
    double gain;     /* static response of the structure to voltages, divided by that of the model
                        (dimensionless) */
    int delay;       /* delay of the sensor readings between measurement and use (ticks) */
    double interval; /* time between ticks (s) */
    double lag;      /* time constant of the first-order lag of the amplifiers (s); 0: none */
} certificate_conditions;

/*
 * Return the spectral radius of the control loop on the vibration modes of a structure; NAN where
 * memory runs out.
 *   loop [modes][modes] in  loop matrix: entry (i, j) is the static coordinate of mode i under the
 *       voltages that the controller subtracts for a measured unit of mode j
 *   square  [modes]     in  squares of the angular frequencies (rad^2/s^2)
 *   damping [modes]     in  damping ratios
 *   conditions          in  static response of the structure relative to the model, delay of the
 *       readings, tick interval, and lag of the amplifiers
 *   squarings           in  number of matrix squarings from which the radius is computed
 */
double certificate_radius(const double *loop, const double *square, int modes,
                          const double *damping, const certificate_conditions *conditions,
                          int squarings);

/*
 * Whether the spectral radius of the control loop's transition matrix is below 1, so that small
 * vibrations decay. Faster than certificate_radius, which computes the radius from the same
 * arguments. Returns false where memory runs out.
 */
bool certificate_decays(const double *loop, const double *square, int modes, const double *damping,
                        const certificate_conditions *conditions, int squarings);

/*
 * Describe the result of the stability tests of a control loop in sentences separated by line
 * feeds; the text is empty where there is nothing to report.
 */
void certificate_text(const certificate *certificate, char text[CERTIFICATE_TEXT]);

/* Name the unit of the shape errors of a certificate (loop.worst), such as "of the target". */
void certificate_unit(const certificate_loop *loop, char text[CERTIFICATE_UNIT]);

#endif
