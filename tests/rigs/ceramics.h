/*
 * Ceramics with hysteresis and creep of other families than the plays that the library compensates:
 * Bouc-Wen, Preisach with a skew density, and the plays of the simulation, each followed by creep.
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
    double width; /* width of the hysteresis */
    double creep; /* final creep of each time constant over the voltage */
    double lag[LAGS];
    double voltage, memory; /* Bouc-Wen: last voltage, hysteretic voltage (V) */
    double up[RELAYS], down[RELAYS], weight[RELAYS]; /* Preisach: thresholds (V), density */
    double state[RELAYS];                            /* Preisach: 1 or -1 */
    double share;                                    /* Preisach: part of the relays */
    double play[CERAMIC_PLAYS];                      /* plays: positions (V) */
} test_ceramic;

/*
 * Relays on a triangle of thresholds. Their density falls away from a ridge and is larger for
 * positive voltages, so no loop is symmetric. Their share gives the wanted width at 0 V.
 */
static inline void open_relays(test_ceramic *c)
{
    double sum = 0, rising = 0, falling = 0;
    int k = 0;
    for (int i = 0; i < RELAY_LINES; i++)
        for (int j = 0; j < i; j++, k++) {
            const double up = (i + 0.5) / RELAY_LINES * 2 - 1;
            const double down = (j + 0.5) / RELAY_LINES * 2 - 1;
            const double ridge = (up - down - 0.5) / 0.25;
            c->up[k] = up * c->limit;
            c->down[k] = down * c->limit;
            c->weight[k] = exp(-ridge * ridge / 2) * (1 + 0.45 * (up + down) / 2);
            c->state[k] = up + down > 0 ? -1 : 1;
            c->state[k] = up + down == 0 ? 0 : c->state[k];
            sum += c->weight[k];
            rising += c->weight[k] * (up < 0 ? 1 : -1);
            falling += c->weight[k] * (down > 0 ? -1 : 1);
        }
    for (k = 0; k < RELAYS; k++)
        c->weight[k] /= sum;
    c->share = fmin(c->width / (fabs(falling - rising) / sum / 2), 0.9);
}

static inline void open_test_ceramic(test_ceramic *c, ceramic_family family, double limit,
                                     double width, double creep)
{
    memset(c, 0, sizeof *c);
    c->family = family;
    c->limit = limit;
    c->width = width;
    c->creep = creep;
    if (family == PREISACH)
        open_relays(c);
}

static inline double bouc_wen(test_ceramic *c, double voltage)
{
    enum { PARTS_OF_MOVE = 8 };
    const double move = (voltage - c->voltage) / PARTS_OF_MOVE;
    for (int i = 0; i < PARTS_OF_MOVE; i++)
        c->memory += 2.5 * (c->width * move - fabs(move) * c->memory / c->limit);
    c->voltage = voltage;
    return (1 + c->width) * voltage - c->memory;
}

static inline double preisach(test_ceramic *c, double voltage)
{
    double sum = 0;
    for (int k = 0; k < RELAYS; k++) {
        if (voltage > c->up[k])
            c->state[k] = 1;
        else if (voltage < c->down[k])
            c->state[k] = -1;
        sum += c->weight[k] * c->state[k];
    }
    return (1 - c->share) * voltage + c->share * c->limit * sum;
}

static inline double parallel_plays(test_ceramic *c, double voltage)
{
    double sum = voltage;
    for (int i = 0; i < CERAMIC_PLAYS; i++) {
        const double slack = c->limit * (i + 1) / (2 * CERAMIC_PLAYS);
        c->play[i] = fmin(fmax(c->play[i], voltage - slack), voltage + slack);
        sum += c->width * 16 / 5 * (c->play[i] - voltage) / CERAMIC_PLAYS;
    }
    return sum;
}

/* Effect (V) of a voltage that stands for some seconds from now on. */
static inline double ceramic_act(test_ceramic *c, double voltage, double seconds)
{
    static const double time[LAGS] = {0.1, 1, 10};
    double effect = c->family == BOUC_WEN   ? bouc_wen(c, voltage)
                    : c->family == PREISACH ? preisach(c, voltage)
                                            : parallel_plays(c, voltage);
    for (int j = 0; j < LAGS; j++) {
        effect += c->lag[j];
        c->lag[j] -= expm1(-seconds / time[j]) * (c->creep * voltage - c->lag[j]);
    }
    return effect;
}

#endif
