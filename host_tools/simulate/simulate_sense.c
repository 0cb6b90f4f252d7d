/* What the controller gets to know of a closed loop: sensors, the shape from few of them, known
 * loads (simulate_loop.h). */
#include "simulate_loop.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Mean 0, variance 1: the sum of twelve shares less six; no function of libm, so the same bits
 * everywhere. */
static double draw_noise(loop *l)
{
    double sum = -6;
    for (int i = 0; i < 12; i++)
        sum += loop_draw(l);
    return sum;
}

/* ---- open ------------------------------------------------------------- */

/* A standard deviation for every sensor. */
static void take_noise(loop *l)
{
    const simulation *s = l->simulation;
    const scene *scene = l->design->scene;
    double *noise = l->noise;
    for (int i = 0; i < l->sensors && !s->estimates; i++)
        noise[i] = scene->simulate.noise;
    for (int r = 0; r < scene->estimate.readings && s->estimates; r++)
        for (int i = 0; i < analysis_outputs(s->nominal, scene->estimate.reading[r].output); i++)
            *noise++ = scene->estimate.reading[r].noise;
}

int sense_open(loop *l)
{
    const simulation *s = l->simulation;
    const design *d = l->design;
    l->sensors = s->estimates ? s->estimator.sensors : d->targets;
    const size_t n = (size_t)d->amplifiers, m = (size_t)d->targets, loads = (size_t)d->loads,
                 k = (size_t)l->sensors;
    const size_t kept = (size_t)d->scene->simulate.delay + 1;
    double *at = l->sense_memory =
        calloc((5 + kept) * k + kept * (n + loads) + m + 2 * loads + 1, sizeof *at);
    l->sensor = calloc(k + 1, sizeof *l->sensor);
    if (!at || !l->sensor)
        return 0;
    double **const of_sensors[] = {&l->noise, &l->reading, &l->sensed, &l->expected, &l->said};
    for (int i = 0; i < 5; i++, at += k)
        *of_sensors[i] = at;
    l->late_reading = at, at += kept * k;
    l->late_command = at, at += kept * n;
    l->late_known = at, at += kept * loads;
    l->predicted = at, at += m;
    l->known = at, at += loads;
    l->coming = at;
    take_noise(l);
    return 1;
}

void sense_close(loop *l)
{
    free(l->sense_memory);
    free(l->sensor);
}

/* ---- sensors ---------------------------------------------------------- */

/* y [rows] = table [rows][amplifiers] volt */
static void multiply(const loop *l, double *y, const double *table, int rows, const double *voltage)
{
    const size_t n = (size_t)l->design->amplifiers;
    for (size_t i = 0; i < (size_t)rows; i++) {
        y[i] = 0;
        for (size_t k = 0; k < n; k++)
            y[i] += table[i * n + k] * voltage[k];
    }
}

/* What the model says that the sensors show under some volts. */
static void expect(const loop *l, double *reading, const double *voltage)
{
    const simulation *s = l->simulation;
    multiply(l, reading, s->estimates ? s->estimator.direct : s->problem->influence, l->sensors,
             voltage);
}

void sense_predict(loop *l)
{
    multiply(l, l->predicted, l->simulation->problem->influence, l->design->targets, l->command);
}

/* Place of a tick among those kept for the delay, vectors of length n. */
static double *late(const loop *l, double *kept, int tick, int n)
{
    return kept + (size_t)(tick % (l->design->scene->simulate.delay + 1)) * (size_t)n;
}

void sense_taken_out(loop *l, int amplifier, int since, int tick)
{
    const int delay = l->design->scene->simulate.delay;
    for (int then = tick > delay ? tick - delay : 0; then <= tick; then++)
        if (then >= since)
            late(l, l->late_command, then, l->design->amplifiers)[amplifier] =
                l->command[amplifier];
}

/* The plant's readings, volts and known loads of a tick, for when they are late. */
static int keep(loop *l, int tick, char *error)
{
    const design *d = l->design;
    double *reading = late(l, l->late_reading, tick, l->sensors);
    memcpy(late(l, l->late_command, tick, d->amplifiers), l->command,
           (size_t)d->amplifiers * sizeof *l->command);
    memcpy(late(l, l->late_known, tick, d->loads), l->known, (size_t)d->loads * sizeof *l->known);
    if (l->simulation->estimates)
        return plant_readings(&l->simulation->plant, reading, error);
    memcpy(reading, l->shape, (size_t)l->sensors * sizeof *reading);
    return 0;
}

/*
 * What the sensors say of `delay` ticks ago; what the model has moved by since is added, so that
 * the controller compares readings and prediction of the same tick. A reading that stands still to
 * the last bit is handed on standing still.
 */
static void read_sensors(loop *l, int tick)
{
    const int delay = l->design->scene->simulate.delay, then = tick > delay ? tick - delay : 0;
    const double *shown = late(l, l->late_reading, then, l->sensors);
    expect(l, l->expected, l->command);
    expect(l, l->said, late(l, l->late_command, then, l->design->amplifiers));
    for (int i = 0; i < l->sensors; i++) {
        const double noise = l->noise[i] > 0 ? l->noise[i] * draw_noise(l) : 0;
        const double reading = tick < l->sensor[i].frozen_until ? l->reading[i] : shown[i] + noise;
        if (delay == 0)
            l->sensed[i] = reading;
        else if (tick == 0 || reading < l->reading[i] || reading > l->reading[i] ||
                 isnan(l->sensed[i]))
            l->sensed[i] = reading + (l->expected[i] - l->said[i]);
        l->reading[i] = reading;
        if (tick < l->sensor[i].nan_until)
            l->sensed[i] = (double)NAN;
    }
}

int sense_tick(loop *l, int tick, char *error)
{
    if (keep(l, tick, error) < 0)
        return -1;
    read_sensors(l, tick);
    return 0;
}

/* ---- shape ------------------------------------------------------------ */

const double *sense_known(const loop *l, int tick)
{
    const int delay = l->design->scene->simulate.delay;
    return late(l, l->late_known, tick > delay ? tick - delay : 0, l->design->loads);
}

/* |W (shape - measured)| over the scene's target, with the loads known now put back; what has no
 * measurement counts as seen. */
void sense_missed(loop *l)
{
    const design *d = l->design;
    const simulation *s = l->simulation;
    for (int i = 0; i < d->targets; i++) {
        double left = l->shape[i] - l->controller.info.measured[i];
        for (int k = 0; k < d->loads && s->feeds; k++)
            left -= s->estimator.known[i * d->loads + k] * l->known[k];
        l->wish[i] = isnan(left) ? 0 : left;
    }
    l->missed = sqrt(design_squares(d, l->wish, NULL)) / s->reference;
}
