/*
 * Models of piezoelectric ceramic with hysteresis and creep, of other families than the plays that
 * the library compensates: Bouc-Wen, Preisach with a skew density, and the plays of the simulation.
 * Each is followed by creep.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef CERAMICS_H
#define CERAMICS_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum {
    RELAY_LINES = 64,
    RELAYS = RELAY_LINES * (RELAY_LINES - 1) / 2,
    CERAMIC_PLAYS = 4,
    LAGS = 3
};

typedef enum ceramic_family { BOUC_WEN, PREISACH, PLAYS_FAMILY, FAMILIES } ceramic_family;

typedef struct test_ceramic {
    ceramic_family family;
    double limit; /* largest voltage (V) */
    double width; /* width of the hysteresis loop, relative to the range */
    double creep; /* final creep of each time constant, relative to the voltage */
    double lag[LAGS];
    double voltage, memory; /* Bouc-Wen model: last voltage and hysteretic voltage (V) */
    double up[RELAYS], down[RELAYS], weight[RELAYS]; /* Preisach model: thresholds of the relays (V)
                                                        and their density */
    double state[RELAYS];       /* Preisach model: state of each relay, 1 or -1 */
    double share;               /* Preisach model: part of the effect that the relays make */
    double play[CERAMIC_PLAYS]; /* model of plays: positions of the plays (V) */
} test_ceramic;

/*
 * Make the relays of a Preisach model, on a triangle of thresholds. Their density decreases away
 * from a ridge and is larger for positive voltages, so that no hysteresis loop is symmetric. Their
 * share gives the wanted width at 0 V.
 */
static inline void open_relays(test_ceramic *ceramic)
{
    double sum = 0, rising = 0, falling = 0;
    int k = 0;
    for (int i = 0; i < RELAY_LINES; i++)
        for (int j = 0; j < i; j++, k++) {
            const double up = (i + 0.5) / RELAY_LINES * 2 - 1;
            const double down = (j + 0.5) / RELAY_LINES * 2 - 1;
            const double ridge = (up - down - 0.5) / 0.25;
            ceramic->up[k] = up * ceramic->limit;
            ceramic->down[k] = down * ceramic->limit;
            ceramic->weight[k] = exp(-ridge * ridge / 2) * (1 + 0.45 * (up + down) / 2);
            ceramic->state[k] = up + down > 0 ? -1 : 1;
            ceramic->state[k] = up + down == 0 ? 0 : ceramic->state[k];
            sum += ceramic->weight[k];
            rising += ceramic->weight[k] * (up < 0 ? 1 : -1);
            falling += ceramic->weight[k] * (down > 0 ? -1 : 1);
        }
    for (k = 0; k < RELAYS; k++)
        ceramic->weight[k] /= sum;
    ceramic->share = fmin(ceramic->width / (fabs(falling - rising) / sum / 2), 0.9);
}

static inline void open_test_ceramic(test_ceramic *ceramic, ceramic_family family, double limit,
                                     double width, double creep)
{
    memset(ceramic, 0, sizeof *ceramic);
    ceramic->family = family;
    ceramic->limit = limit;
    ceramic->width = width;
    ceramic->creep = creep;
    if (family == PREISACH)
        open_relays(ceramic);
}

static inline double bouc_wen(test_ceramic *ceramic, double voltage)
{
    enum { PARTS_OF_MOVE = 8 };
    const double move = (voltage - ceramic->voltage) / PARTS_OF_MOVE;
    for (int i = 0; i < PARTS_OF_MOVE; i++)
        ceramic->memory +=
            2.5 * (ceramic->width * move - fabs(move) * ceramic->memory / ceramic->limit);
    ceramic->voltage = voltage;
    return (1 + ceramic->width) * voltage - ceramic->memory;
}

static inline double preisach(test_ceramic *ceramic, double voltage)
{
    double sum = 0;
    for (int k = 0; k < RELAYS; k++) {
        if (voltage > ceramic->up[k])
            ceramic->state[k] = 1;
        else if (voltage < ceramic->down[k])
            ceramic->state[k] = -1;
        sum += ceramic->weight[k] * ceramic->state[k];
    }
    return (1 - ceramic->share) * voltage + ceramic->share * ceramic->limit * sum;
}

static inline double parallel_plays(test_ceramic *ceramic, double voltage)
{
    double sum = voltage;
    for (int i = 0; i < CERAMIC_PLAYS; i++) {
        const double slack = ceramic->limit * (i + 1) / (2 * CERAMIC_PLAYS);
        ceramic->play[i] = fmin(fmax(ceramic->play[i], voltage - slack), voltage + slack);
        sum += ceramic->width * 16 / 5 * (ceramic->play[i] - voltage) / CERAMIC_PLAYS;
    }
    return sum;
}

/* Return the effect (V) of a voltage that is applied for some seconds from now on. */
static inline double ceramic_act(test_ceramic *ceramic, double voltage, double seconds)
{
    static const double time[LAGS] = {0.1, 1, 10};
    double effect;
    if (ceramic->family == BOUC_WEN)
        effect = bouc_wen(ceramic, voltage);
    else if (ceramic->family == PREISACH)
        effect = preisach(ceramic, voltage);
    else
        effect = parallel_plays(ceramic, voltage);
    for (int j = 0; j < LAGS; j++) {
        effect += ceramic->lag[j];
        ceramic->lag[j] -= expm1(-seconds / time[j]) * (ceramic->creep * voltage - ceramic->lag[j]);
    }
    return effect;
}

#endif
