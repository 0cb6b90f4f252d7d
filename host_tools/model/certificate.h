/*
 * Whether the control step, which takes each shape for an equilibrium, is stable on the same
 * structure with its mass.
 *
 * The plant is the lowest modes with one damping ratio, held voltages between the ticks, and the
 * static rest of the modes left out. The step is the one of pzs_tick without limits: the voltages
 * that make up for the disturbance
 *   d = y - B v = C (q - g v)
 * measured `delay` ticks before,
 *   v' = -F (q - g v),   F = (B'W^2 B + regularisation)^-1 B'W^2 C.
 * In the deviation e = q - g v from the static equilibrium the loop is closed with g F alone,
 * whatever the number of amplifiers. Limits and the step limit only slow the growth down.
 */
#ifndef CERTIFICATE_H
#define CERTIFICATE_H

#include "vibration.h"

typedef struct certificate {
    int is_made;              /* whether certificate_make has run */
    int has_modes;            /* modes are known: the densities are given */
    char reason[SCENE_ERROR]; /* where they are not, or where a loop cannot be judged: the reason
                                  and the cure */
    vibration vibration;
    int is_assessed;      /* a target and amplifiers: the numbers below are known */
    int assumes_measured; /* judged as if every target node were measured: readings of electrodes
                        are left out */
    int modes;            /* of the loop */
    double damping;       /* ratio */
    int has_own_damping;  /* by the scene; 0: assumed */
    double rate;          /* ticks a second of the scene, 0: it gives none */
    double radius; /* spectral radius at that rate: growth of vibration a tick; NAN without a rate
                    */
    double gain;   /* 2 zeta w1 T: about the largest step gain that is stable; NAN without a rate */
    double stable_rate; /* every rate up to this one is stable; 0: none was found, infinite: all */
} certificate;

void certificate_free(certificate *certificate);

/* Is the loop known to be unstable at the scene's rate? */
int certificate_refuses(const certificate *certificate);

/* First natural frequency, rigid motions left out; NAN where there is none. */
double certificate_first(const certificate *certificate);

/*
 * Spectral radius of the loop.
 *   loop     [modes][modes] in  g F
 *   square   [modes]        in  w^2
 *   damping, delay          in  ratio; ticks
 *   interval                in  of the ticks, s
 * Returns NAN where memory runs out.
 */
double certificate_radius(const double *loop, const double *square, int modes, double damping,
                          int delay, double interval, int squarings);

/*
 * The verdict in sentences, separated by line feeds; empty where nothing
 * is to be said.
 */
void certificate_text(const certificate *certificate, char text[3 * SCENE_ERROR]);

#endif
