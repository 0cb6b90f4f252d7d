/*
 * The control image in a loop with a plant at the other end of a stream: an order in, and for a
 * tick its answer out, until the stream ends. All in 32-bit words and reals as the processor holds
 * them.
 *
 *   out, once  bits of a real, inputs, outputs, status of the start; volt [inputs] (V) unless that
 * is an error in         TICK, 0       wanted [outputs] (m), measured [outputs] (m), or readings
 * [sensors] once it estimates out        status, passes; volt [inputs] (V); state [inputs] of the
 * watch, bytes in         HOLD, input   volt (V) in         RELEASE, input in         WATCH, delay
 * of the measurements: electrodes that do not follow are found from now on in         ESTIMATE, 0:
 * the shape is estimated from now on, where the tables have gains in         QUANTISE, 0   step,
 * dead band of the amplifiers (V), from now on in         KNOW, 0       amounts at the next
 * measurement [loads], amounts to come [loads]: fed forward from now on
 */
#include <string.h>
#include "../boards/board.h"
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))

/* Tables without gains, or without loads: the order for them ends the loop. */
#ifdef DEMO_SENSORS
#define ESTIMATOR (&demo_estimator)
#ifdef DEMO_LOADS
#define SHOWN (&demo_shown)
#endif
#else
#define DEMO_SENSORS 1
#define ESTIMATOR NULL
#endif
#ifdef DEMO_LOADS
#define KNOWN (&demo_known)
#else
#define DEMO_LOADS 1
#define KNOWN NULL
#endif
#ifndef SHOWN
#define SHOWN NULL
#endif

enum { TICK, HOLD, RELEASE, WATCH, ESTIMATE, QUANTISE, KNOW };

static pzs_real control_work[REALS(DEMO_CONTROL_BYTES)];
static pzs_real
    watch_work[REALS(PZS_FAULT_DETECTOR_BYTES(DEMO_INPUTS, DEMO_OUTPUTS, PZS_DELAY_LIMIT))];
static pzs_real estimate_work[REALS(PZS_ESTIMATE_BYTES(DEMO_SENSORS))];
static pzs_real wanted[DEMO_OUTPUTS], measured[DEMO_OUTPUTS], sensed[DEMO_SENSORS];
static pzs_real given[DEMO_INPUTS];    /* by the amplifiers (V) */
static pzs_real amplifier[2];          /* step, dead band (V) */
static pzs_real amount[2][DEMO_LOADS]; /* of known loads: at the measurement, to come */
static uint8_t state[DEMO_INPUTS];     /* of the watch */

typedef struct device {
    pzs_control control;
    pzs_fault_detector watch;
    pzs_estimate estimate;
    int watches, estimates, quantises, knows;
} device;

static int send_volts(const pzs_control *control)
{
    return board_send(control->info.voltage, DEMO_INPUTS * sizeof *control->info.voltage);
}

static int start(device *d)
{
    const pzs_status status =
        pzs_control_init(&d->control, &demo_problem, NULL, control_work, sizeof control_work);
    const uint32_t about[4] = {PZS_REAL_BITS, DEMO_INPUTS, DEMO_OUTPUTS, status};
    return board_send(about, sizeof about) && !PZS_IS_ERROR(status) && send_volts(&d->control);
}

/*
 * The shape, estimated or measured, less what known loads do. They are taken out of the readings
 * before an estimate, not out of it: the sensors may not show all that they do.
 */
static pzs_status pzs_sensor_check(device *d)
{
    if (d->knows) {
        (void)pzs_feed_forward(d->estimates ? SHOWN : KNOWN, amount[0],
                               d->estimates ? sensed : measured);
        (void)pzs_feed_forward(KNOWN, amount[1], wanted);
    }
    return d->estimates ? pzs_estimate_tick(&d->estimate, sensed, measured) : PZS_OK;
}

/* Feed forward, estimate, step, whole steps of the amplifiers, watch. An error goes before, a
 * warning of the step too. */
static pzs_status run(device *d)
{
    const pzs_status seen = pzs_sensor_check(d);
    if (PZS_IS_ERROR(seen))
        return seen;
    const pzs_status stepped = pzs_tick(&d->control, wanted, measured);
    if (PZS_IS_ERROR(stepped))
        return stepped;
    if (d->quantises)
        (void)pzs_quantise(&d->control, given, amplifier[0], amplifier[1]);
    const pzs_status watched = d->watches ? pzs_fault_detector_tick(&d->watch, measured) : PZS_OK;
    if (PZS_IS_ERROR(watched))
        return watched;
    if (d->watches)
        memcpy(state, d->watch.info.electrode, sizeof state);
    return stepped == PZS_OK ? seen : stepped;
}

static int tick(device *d)
{
    void *const readings = d->estimates ? sensed : measured;
    const size_t bytes = d->estimates ? sizeof sensed : sizeof measured;
    if (!board_receive(wanted, sizeof wanted) || !board_receive(readings, bytes))
        return 0;
    const uint32_t about[2] = {run(d), d->control.info.iterations};
    return board_send(about, sizeof about) && send_volts(&d->control) &&
           board_send(state, sizeof state);
}

static int watch(device *d, uint32_t delay)
{
    d->watches = pzs_fault_detector_init(&d->watch, &d->control, (uint16_t)delay, watch_work,
                                         sizeof watch_work) == PZS_OK;
    return d->watches;
}

static int estimate(device *d)
{
    d->estimates = pzs_estimate_init(&d->estimate, &d->control, ESTIMATOR, estimate_work,
                                     sizeof estimate_work) == PZS_OK;
    return d->estimates;
}

static int quantise(device *d)
{
    memcpy(given, d->control.info.voltage, sizeof given);
    d->quantises = board_receive(amplifier, sizeof amplifier);
    return d->quantises;
}

static int know(device *d)
{
    d->knows = pzs_feed_forward_check(KNOWN) == PZS_OK && board_receive(amount, sizeof amount);
    return d->knows;
}

static int hold(pzs_control *control, uint32_t input)
{
    pzs_real voltage;
    return board_receive(&voltage, sizeof voltage) &&
           pzs_hold(control, (uint16_t)input, voltage) == PZS_OK;
}

int main(void)
{
    device d = {0};
    uint32_t order[2];
    int good = start(&d);

    while (good && board_receive(order, sizeof order)) {
        switch (order[0]) {
        case TICK: good = tick(&d); break;
        case HOLD: good = hold(&d.control, order[1]); break;
        case RELEASE: good = pzs_release(&d.control, (uint16_t)order[1]) == PZS_OK; break;
        case WATCH: good = watch(&d, order[1]); break;
        case ESTIMATE: good = estimate(&d); break;
        case QUANTISE: good = quantise(&d); break;
        case KNOW: good = know(&d); break;
        default: good = 0;
        }
    }
    return !good;
}
