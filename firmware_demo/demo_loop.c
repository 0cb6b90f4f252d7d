/*
 * The control image in a loop with a plant at the other end of a stream: an order in, and for a tick its answer out,
 * until the stream ends. All in 32-bit words and reals as the processor holds them.
 *
 *   out, once  bits of a real, inputs, outputs, status of the start; volt [inputs] (V) unless that is an error
 *   in         TICK, 0       wanted [outputs], measured [outputs] (m)
 *   out        status, passes; volt [inputs] (V); state [inputs] of the watch, bytes
 *   in         HOLD, input   volt (V)
 *   in         RELEASE, input
 *   in         WATCH, delay of the measurements: electrodes that do not follow are found from now on
 */
#include "board.h"
#include DEMO_TABLES

#define REALS(bytes) (((bytes) + sizeof(pzs_real) - 1u) / sizeof(pzs_real))

enum { TICK, HOLD, RELEASE, WATCH };

static pzs_real control_work[REALS(DEMO_CONTROL_BYTES)];
static pzs_real watch_work[REALS(PZS_WATCH_BYTES(DEMO_INPUTS, DEMO_OUTPUTS, PZS_MOST_DELAY))];
static pzs_real wanted[DEMO_OUTPUTS], measured[DEMO_OUTPUTS];

typedef struct device {
    pzs_control control;
    pzs_watch watch;
    int watches;
} device;

static int send_volts(const pzs_control *control)
{
    return board_send(control->volt, DEMO_INPUTS * sizeof *control->volt);
}

static int start(device *d)
{
    const pzs_status status = pzs_control_init(&d->control, &demo_problem, NULL, control_work, sizeof control_work);
    const uint32_t about[4] = { PZS_REAL_BITS, DEMO_INPUTS, DEMO_OUTPUTS, status };
    return board_send(about, sizeof about) && !PZS_IS_ERROR(status) && send_volts(&d->control);
}

static int tick(device *d)
{
    if (!board_receive(wanted, sizeof wanted) || !board_receive(measured, sizeof measured)) return 0;
    const pzs_status status = pzs_tick(&d->control, wanted, measured);
    const uint32_t about[2] = { status, d->control.passes };
    static const uint8_t unwatched[DEMO_INPUTS];
    if (d->watches && PZS_IS_ERROR(pzs_watch_tick(&d->watch, measured))) return 0;
    if (!board_send(about, sizeof about) || !send_volts(&d->control)) return 0;
    return board_send(d->watches ? d->watch.state : unwatched, sizeof unwatched);
}

static int watch(device *d, uint32_t delay)
{
    d->watches = pzs_watch_init(&d->watch, &d->control, (uint16_t)delay, watch_work, sizeof watch_work) == PZS_OK;
    return d->watches;
}

static int hold(pzs_control *control, uint32_t input)
{
    pzs_real volt;
    return board_receive(&volt, sizeof volt) && pzs_hold(control, (uint16_t)input, volt) == PZS_OK;
}

int main(void)
{
    device d = { 0 };
    uint32_t order[2];
    int good = start(&d);

    while (good && board_receive(order, sizeof order)) {
        switch (order[0]) {
        case TICK: good = tick(&d); break;
        case HOLD: good = hold(&d.control, order[1]); break;
        case RELEASE: good = pzs_release(&d.control, (uint16_t)order[1]) == PZS_OK; break;
        case WATCH: good = watch(&d, order[1]); break;
        default: good = 0;
        }
    }
    return !good;
}
