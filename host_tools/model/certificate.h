/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Certificate of stability: whether the control step, which takes each shape for an equilibrium, is
 * stable on the same structure with mass.
 *
 * The plant is the lowest modes with one damping ratio, voltages that are constant between the
 * ticks, and the static response of the modes left out. The step is that of pzs_tick without
 * limits. Its voltages compensate the disturbance d = y - B v = C (q - g v) measured `delay` ticks
 * before, v' = -F (q - g v),   F = (B'W^2 B + regularisation)^-1 B'W^2 C. In the deviation e = q -
 * g v from the static equilibrium the loop depends on g F alone, for any number of amplifiers.
 * Voltage limits and step limits only slow the growth of vibration down.
 */
#ifndef CERTIFICATE_H
#define CERTIFICATE_H

#include <stdbool.h>
#include "damper_gains.h"
#include "vibration.h"

enum { CERTIFICATE_TEXT = 2000 }; /* length of a certificate's text */

/* Largest distance from the best shape at which a storm has settled, over the size of the target.
 */
#define CERTIFICATE_TOLERANCE 0.05

/*
 * Certificate of a loop with a vibration model, measured with the loop itself around structures
 * that differ from the model: growth of small vibrations, storms, margins (simulate/certify.h).
 */
typedef struct certificate_loop {
    bool is_made;
    bool is_stable;               /* vibrations decay at every corner, and every storm settles */
    int modes;                    /* modes of the structure in these runs */
    int observed;                 /* modes that the damped tick observes */
    double radius;                /* largest growth a tick without limits */
    double at_gain, at_frequency; /* structure with that growth, relative to the model */
    int storms, failed;           /* number of storms, and of those that did not settle */
    double worst; /* largest distance from the best shape at the end of a storm, over the
                     target */
    double worst_gain, worst_frequency, worst_step; /* structure of that storm, and its step limit
                                                       over that of the scene */
    double ticks; /* mean number of ticks of a storm until it has settled */
    int delay;    /* age of the readings that the scene states (ticks) */
    int older;    /* ticks by which every reading may be older than the scene says: vibrations decay
                     and every storm settles with each number of ticks up to this one */
    int newer; /* ticks by which every reading may be newer than the scene says, likewise; at most
                  the delay of the scene */
    bool has_margins;
    double margin_gain;              /* largest stable gain over that of the model */
    bool ends_at_most;               /* `older` is the largest number of ticks that was tried */
    double margin_slow, margin_fast; /* lowest and highest stable frequencies over the model's */
    double rate_from, rate_to;       /* range of stable tick rates around the scene's, with tables
                                        made for each rate; 0: not computed */
} certificate_loop;

typedef struct certificate {
    bool is_made;   /* whether certificate_make has run */
    bool has_modes; /* whether the modes are known, as they are where all densities are given */
    char reason[SCENE_ERROR]; /* why the modes are unknown or the loop was not assessed, and what to
                                 do */
    vibration vibration;
    bool is_assessed; /* whether the members below are known: there are a target and amplifiers */
    bool assumes_measured; /* assessed as if every target node were measured, because some readings
                             are of electrodes */
    int modes;             /* number of modes in the loop */
    double damping;        /* damping ratio of the first mode */
    bool has_own_damping;  /* whether the scene gives the damping ratio; else it is an assumption */
    double rate;           /* ticks per second of the scene; 0: the scene gives none */
    double radius; /* spectral radius at that rate: growth of vibration per tick; NAN without a rate
                    */
    double gain;   /* 2 zeta w1 T: about the largest stable step gain; NAN without a rate */
    bool has_settings;        /* whether `settings` were chosen by storms */
    damper_settings settings; /* settings of the damped tick */
    certificate_loop loop;    /* of the loop with a vibration model */
    double stable_rate; /* all rates up to this one are stable; 0: none was found, infinite: every
                           rate */
} certificate;

void certificate_free(certificate *certificate);

/* Whether the loop is known to be unstable at the scene's rate. */
bool certificate_refuses(const certificate *certificate);

/* First natural frequency without rigid motions; NAN where there is none. */
double certificate_first(const certificate *certificate);

/*
 * Spectral radius of the loop.
 *   loop [modes][modes]  in  g F
 *   square [modes]       in  squares of the angular frequencies, w^2
 *   damping [modes]      in  damping ratios
 *   delay                in  delay of the measurements, ticks
 *   interval             in  time between ticks, s
 * Returns NAN where memory runs out.
 */
double certificate_radius(const double *loop, const double *square, int modes,
                          const double *damping, int delay, double interval, int squarings);

/*
 * Text of the certificate in sentences separated by line feeds; empty where there is nothing to
 * report.
 */
void certificate_text(const certificate *certificate, char text[CERTIFICATE_TEXT]);

#endif
