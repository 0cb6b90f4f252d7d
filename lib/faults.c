/*
 * Electrodes that do not follow their amplifiers, found from what the shape does and does not do.
 *
 * Between two shapes the commanded volts change by x and the disturbance, measured - predicted, by
 * d = B f + load: f_j is what electrode j did beyond its command. Least squares give f, x + f is the response.
 * An electrode that follows responds with x times what the model is wrong by; one that does not, with nothing. Two
 * things make a suspect:
 *
 *   it was moved by a full swing and hardly responded (a stuck one, or a dead one called for), or
 *   the shape jumped as if its volts had gone, and mainly its (one that has just died).
 *
 * A load may look like either. So a suspect is probed: held at two volts in turn, a swing to either side of where it
 * was, inside limits and slew, while the step compensates with the others. It is found where the response to its moves is
 * the same every time, as if there were none; what a load does does not move with the probe.
 *
 * Work of a tick: (m + n) n multiply-adds, and less than 40 (m + n) other operations; where measurements are lost or
 * come back, m n^2 / 16 + n^3 / 6 besides. Nothing else depends on the data.
 */
#include <string.h>
#include "boxls.h"
#include "control.h"
#include "electrode.h"
#include "guard.h"
#include "linalg.h"
#include "product.h"
#include "sense.h"

#define READY 1u
#define KEPT PZS_R(0.75)     /* of the sums over past ticks, a tick */
#define SILENT 16            /* a response whose square is below 1/SILENT of the move's is none */
#define RIDGE PZS_R(1e-5)    /* of the diagonal, added to it */
#define CLEAR PZS_R(0.75)    /* least part of an electrode's own volts that least squares must give back */
#define MOVES 8u             /* of a probe, */
#define PATIENCE 24u         /* within so many shapes */
#define REST 100u            /* shapes before an electrode that was cleared is suspected again */
#define NOBODY 0xFFFFu
#define MISSING 8u           /* one output in so many may be without measurement */

enum { LOST = 1, LEFT_OUT = 2 }; /* of an output: without measurement at the shape before; not among the columns */

static pzs_real square(pzs_real x)
{
    return x * x;
}

/* ---- init ------------------------------------------------------------- */

/* Half the volts of a probe: half the slew, at most 1/32 of the limits, and a little less, for rounding. */
static pzs_real default_swing(const pzs_problem *p, uint32_t j)
{
    const pzs_real range = (p->upper[j] - p->lower[j]) / 16, whole = p->slew[j] < range ? p->slew[j] : range;
    return PZS_R(0.49) * whole;
}

static void lay_out(pzs_watch *w, void *work)
{
    const uint32_t n = w->control->problem->inputs, m = w->control->problem->outputs;
    pzs_real *at = work, *const columns = at;
    at += PZS_DENSE(n);
    w->swing = at, at += n;
    w->diagonal = at, at += n;
    w->volt = at, at += (size_t)(w->delay + 1u) * n;
    w->before = at, at += n;
    w->answer = at, at += n;
    w->moved = at, at += n;
    w->response = at, at += n;
    w->lost_volt = at, at += n;
    w->shape = at, at += m;
    w->change = at, at += m;
    electrode_layout(&w->columns, n, columns, at);
    w->state = (uint8_t *)at + sizeof(uint32_t) * (n / PZS_TILE + 2u) + sizeof(uint16_t) * n;
    w->missing = w->state + n;
}

/* Diagonal of B'W^2 B, 1 where an electrode does nothing; the Hessian's holds the effort besides. */
static void take_diagonal(pzs_watch *w)
{
    const pzs_control *c = w->control;
    const uint32_t n = c->problem->inputs;
    for (uint32_t j = 0; j < n; j++) {
        pzs_real sum = 0;
        for (uint32_t i = 0; i < c->problem->outputs; i++)
            sum += square(c->problem->weight[i] * c->influence[(size_t)i * n + j]);
        w->diagonal[j] = sum > 0 ? sum : 1;
        w->state[j] = sum > 0 && boxls_finite(w->swing[j]) && w->swing[j] > 0 ? PZS_WATCHED : PZS_BLIND;
    }
}

/* row [j + 1] = row j of B'W^2 B over the outputs that are not left out, a ridge on its diagonal. */
static void form_row(const pzs_watch *w, uint32_t j, pzs_real *row)
{
    const pzs_control *c = w->control;
    const uint32_t n = c->problem->inputs;
    memcpy(row, c->optimiser.h + (size_t)j * c->optimiser.width, j * sizeof *row);
    row[j] = w->diagonal[j] * (1 + w->ridge);
    for (uint32_t i = 0; i < c->problem->outputs; i++) {
        if (!(w->missing[i] & LEFT_OUT))
            continue;
        const pzs_real *b = c->influence + (size_t)i * n, part = square(c->problem->weight[i]) * b[j];
        for (uint32_t k = 0; k <= j; k++)
            row[k] -= part * b[k];
    }
}

/* Factor it. Returns whether that can be done. */
static int factor(pzs_watch *w)
{
    for (uint32_t j = 0; j < w->columns.n; j++) {
        form_row(w, j, w->answer);
        for (uint32_t k = 0; k <= j; k++)
            *linalg_entry(&w->columns, j, k) = w->answer[k];
    }
    w->stale = linalg_factor(&w->columns).zero >= 0;
    return !w->stale;
}

/* An electrode whose volts least squares do not give back is not watched. */
static void find_blind(pzs_watch *w)
{
    const uint32_t n = w->columns.n;
    for (uint32_t j = 0; j < n; j++) {
        memset(w->answer, 0, n * sizeof *w->answer);
        w->answer[j] = 1;
        linalg_solve(&w->columns, w->answer);
        if (!(1 - w->ridge * w->diagonal[j] * w->answer[j] > CLEAR))
            w->state[j] = PZS_BLIND;
        w->blind = (uint16_t)(w->blind + (w->state[j] == PZS_BLIND));
    }
    memset(w->answer, 0, n * sizeof *w->answer);
}

static pzs_status finish(pzs_watch *w, pzs_status status, int32_t where)
{
    w->where = where;
    return status;
}

pzs_status pzs_watch_init(pzs_watch *watch, pzs_control *control, uint16_t delay, void *work, size_t bytes)
{
    if (watch == NULL)
        return PZS_E_ARGUMENT;
    memset(watch, 0, sizeof *watch);
    const pzs_status status = control == NULL || work == NULL || delay > PZS_MOST_DELAY ? PZS_E_ARGUMENT
                              : control->stage != CONTROL_READY ? PZS_E_STAGE : PZS_OK;
    if (status != PZS_OK)
        return finish(watch, status, -1);
    const pzs_problem *p = control->problem;
    const size_t need = PZS_WATCH_BYTES(p->inputs, p->outputs, delay);
    const int32_t lacking = guard_short(work, bytes, need);
    if (lacking >= 0)
        return finish(watch, PZS_E_WORKSPACE, lacking);
    memset(work, 0, need);
    watch->control = control;
    watch->delay = delay;
    lay_out(watch, work);
    for (uint32_t j = 0; j < p->inputs; j++)
        watch->swing[j] = default_swing(p, j);
    const pzs_real least = 4 * (pzs_real)p->inputs * PZS_EPSILON;
    watch->ridge = least > RIDGE ? least : RIDGE;
    take_diagonal(watch);
    if (!factor(watch))
        return finish(watch, PZS_E_NONFINITE, -1);
    find_blind(watch);
    for (uint32_t k = 0; k <= delay; k++)
        memcpy(watch->volt + (size_t)k * p->inputs, control->volt, p->inputs * sizeof(pzs_real));
    memcpy(watch->before, control->volt, p->inputs * sizeof(pzs_real));
    memset(watch->missing, LOST, p->outputs);
    for (uint32_t k = 0; k < PZS_PROBES; k++)
        watch->probe[k].input = NOBODY;
    watch->stage = READY;
    return finish(watch, PZS_OK, -1);
}

/* ---- response --------------------------------------------------------- */

/*
 * Take the new disturbance; change = W^2 times what it changed by since the last shape, zero where either has no
 * measurement. Returns whether both have enough to tell electrodes apart.
 */
static int compare(pzs_watch *w, const pzs_real *measured)
{
    const pzs_control *c = w->control;
    const uint32_t m = c->problem->outputs;
    uint32_t out = 0;
    for (uint32_t i = 0; i < m; i++) {
        const int lost = sense_lost(&c->frozen[i], measured[i]), left_out = lost || (w->missing[i] & LOST);
        const pzs_real change = c->disturbance[i] - w->shape[i];
        w->change[i] = left_out ? 0 : square(c->problem->weight[i]) * change;
        w->shape[i] = c->disturbance[i];
        w->stale |= !left_out != !(w->missing[i] & LEFT_OUT);
        w->missing[i] = (uint8_t)((lost ? LOST : 0) | (left_out ? LEFT_OUT : 0));
        out += left_out ? 1u : 0u;
    }
    return MISSING * out <= m && (!w->stale || factor(w));
}

/* Fewer measurements than can be left out: the last shape still stands. */
static int too_few(const pzs_watch *w, const pzs_real *measured)
{
    const pzs_control *c = w->control;
    uint32_t lost = 0;
    for (uint32_t i = 0; i < c->problem->outputs; i++)
        lost += sense_lost(&c->frozen[i], measured[i]) ? 1u : 0u;
    return MISSING * lost > c->problem->outputs;
}

/* The volts that made the shape now looked at: the oldest kept. */
static pzs_real *oldest_volts(const pzs_watch *w)
{
    return w->volt + (size_t)w->oldest * w->control->problem->inputs;
}

/* Those of this tick take their place. */
static void keep_volts(pzs_watch *w)
{
    memcpy(oldest_volts(w), w->control->volt, w->control->problem->inputs * sizeof(pzs_real));
    w->oldest = (uint16_t)(w->oldest < w->delay ? w->oldest + 1u : 0);
}

/* answer = f; sums of moves and responses, and what each electrode has lost. Returns |f|^2. */
static pzs_real respond(pzs_watch *w, const pzs_real *volt)
{
    const pzs_control *c = w->control;
    const uint32_t n = c->problem->inputs;
    pzs_real all = 0;
    product_sum_rows(w->answer, c->influence, n, w->change, c->problem->outputs, n);
    linalg_solve(&w->columns, w->answer);
    for (uint32_t j = 0; j < n; j++) {
        const pzs_real move = volt[j] - w->before[j], most = 2 * boxls_size(move);
        all += square(w->answer[j]);
        w->moved[j] = KEPT * w->moved[j] + square(move);
        w->response[j] = KEPT * w->response[j] + square(boxls_cut(move + w->answer[j], -most, most));
        w->lost_volt[j] = KEPT * w->lost_volt[j] + w->answer[j];
    }
    return all;
}

/* ---- probes ----------------------------------------------------------- */

static int held(const pzs_control *c, uint32_t j)
{
    return !(c->lower[j] < c->upper[j]);
}

/* Most of its volts gone in one tick, and no other lost as much: all = |f|^2. */
static int just_died(const pzs_watch *w, uint32_t j, pzs_real volt, pzs_real all)
{
    const pzs_real gone = volt < 0 ? w->answer[j] : -w->answer[j], most = boxls_size(volt);
    return gone > 2 * w->swing[j] && gone > PZS_R(0.4) * most && gone < PZS_R(1.6) * most && 4 * square(gone) >= all;
}

/* How suspicious an electrode is (V^2), 0 where not. */
static pzs_real suspicion(const pzs_watch *w, uint32_t j, pzs_real volt, pzs_real all)
{
    if (w->state[j] != PZS_WATCHED || held(w->control, j))
        return 0;
    if (just_died(w, j, volt, all))
        return square(w->answer[j]);
    return w->moved[j] >= 4 * square(w->swing[j]) && SILENT * w->response[j] < w->moved[j] ? w->moved[j] : 0;
}

/* Begin a probe of input j around its volts, far enough from its limits. */
static void begin(pzs_watch *w, pzs_probe *probe, uint32_t j, const pzs_real *volt)
{
    const pzs_control *c = w->control;
    const pzs_probe fresh = { .input = (uint16_t)j, .lower = c->lower[j], .upper = c->upper[j] };
    *probe = fresh;
    probe->middle = boxls_cut(c->volt[j], c->lower[j] + w->swing[j], c->upper[j] - w->swing[j]);
    probe->is_dead = volt[j] * w->lost_volt[j] < 0 && 2 * boxls_size(w->lost_volt[j]) > boxls_size(volt[j]);
    w->state[j] = PZS_PROBED;
}

static int is_wide(const pzs_watch *w, uint32_t j)
{
    return w->control->upper[j] - w->control->lower[j] > 4 * w->swing[j];
}

/* The most suspicious electrodes into the places that are free. */
static void suspect(pzs_watch *w, const pzs_real *volt, pzs_real all)
{
    for (uint32_t k = 0; k < PZS_PROBES; k++) {
        pzs_real most = 0;
        uint32_t who = NOBODY;
        for (uint32_t j = 0; w->probe[k].input == NOBODY && j < w->control->problem->inputs; j++) {
            const pzs_real now = suspicion(w, j, volt[j], all);
            who = now > most && is_wide(w, j) ? j : who;
            most = now > most && is_wide(w, j) ? now : most;
        }
        if (who != NOBODY)
            begin(w, &w->probe[k], who, volt);
    }
}

/* Hold the suspects at their next volts, inside their limits whatever the swing was changed to. */
static void swing_all(pzs_watch *w)
{
    pzs_control *c = w->control;
    for (uint32_t k = 0; k < PZS_PROBES; k++) {
        pzs_probe *p = &w->probe[k];
        const uint32_t j = p->input;
        if (j == NOBODY)
            continue;
        p->side = !p->side;
        const pzs_real wish = p->middle + (p->side ? w->swing[j] : -w->swing[j]);
        p->set = boxls_cut(boxls_finite(wish) ? wish : c->volt[j], p->lower, p->upper);
        c->lower[j] = c->upper[j] = p->set;
    }
}

/* Its limits back; it rests. */
static void release(pzs_watch *w, pzs_probe *probe)
{
    const uint32_t j = probe->input;
    w->control->lower[j] = probe->lower;
    w->control->upper[j] = probe->upper;
    w->state[j] = REST;
    probe->input = NOBODY;
}

/*
 * Held from now on where it is believed to be, dead at 0 V: volts and prediction agree with what the structure has, so
 * that the next step has nothing to make up for but what the electrode no longer does.
 */
static void remove(pzs_watch *w, pzs_probe *probe)
{
    pzs_control *c = w->control;
    const uint32_t j = probe->input;
    c->volt[j] = probe->is_dead ? boxls_cut(0, probe->lower, probe->upper) : c->volt[j];
    c->lower[j] = c->upper[j] = c->volt[j];
    control_moved(c);
    w->state[j] = PZS_HELD;
    w->found++;
    probe->input = NOBODY;
}

/* Moves of the probe and responses to them, about their means: was there any response? */
static int silent(const pzs_probe *p)
{
    const pzs_real n = (pzs_real)p->moves;
    const pzs_real moves = p->square - square(p->sum) / n;
    const pzs_real responses = p->response_square - square(p->response_sum) / n;
    return SILENT * responses <= moves;
}

/* One more shape for a probe: go on, or come to an end. Returns whether the electrode was found. */
static int examine(pzs_watch *w, pzs_probe *p, const pzs_real *volt)
{
    const uint32_t j = p->input;
    const pzs_real move = volt[j] - w->before[j], response = move + w->answer[j];
    p->shapes++;
    if (boxls_size(move) >= w->swing[j]) {
        p->moves++;
        p->sum += move;
        p->square += square(move);
        p->response_sum += response;
        p->response_square += square(response);
    }
    const int ends = p->moves == MOVES, found = ends && silent(p);
    if (found)
        remove(w, p);
    else if (ends || p->shapes == PATIENCE)
        release(w, p);
    return found;
}

/* Someone else held or released the electrode meanwhile. */
static int taken(const pzs_watch *w, const pzs_probe *p)
{
    const pzs_control *c = w->control;
    const uint32_t j = p->input;
    return c->lower[j] < p->set || c->lower[j] > p->set || c->upper[j] > p->set;
}

/* All probes, by one shape. Returns the first input found, or -1. */
static int32_t run_probes(pzs_watch *w, const pzs_real *volt)
{
    int32_t first = -1;
    for (uint32_t k = 0; k < PZS_PROBES; k++) {
        pzs_probe *p = &w->probe[k];
        const uint32_t j = p->input;
        if (j == NOBODY)
            continue;
        if (taken(w, p)) {
            w->state[j] = REST;
            p->input = NOBODY;
        } else if (examine(w, p, volt) && first < 0) {
            first = (int32_t)j;
        }
    }
    return first;
}

static void rest(pzs_watch *w)
{
    for (uint32_t j = 0; j < w->control->problem->inputs; j++) {
        if (w->state[j] > PZS_WATCHED && w->state[j] <= REST)
            w->state[j]--;
        if (w->state[j] == PZS_HELD && !held(w->control, j))
            w->state[j] = PZS_WATCHED; /* released: another chance */
    }
}

/* All that one shape tells. Returns the first input found, or -1. */
static int32_t judge(pzs_watch *w, const pzs_real *volt)
{
    const pzs_real all = respond(w, volt);
    const int32_t first = run_probes(w, volt);
    suspect(w, volt, all);
    rest(w);
    swing_all(w);
    return first;
}

pzs_status pzs_watch_tick(pzs_watch *w, const pzs_real *measured)
{
    if (w == NULL)
        return PZS_E_ARGUMENT;
    if (w->stage != READY)
        return PZS_E_STAGE;
    const pzs_real *volt = oldest_volts(w);
    int32_t first = -1;
    if (measured != NULL && !too_few(w, measured)) {
        if (compare(w, measured))
            first = judge(w, volt);
        memcpy(w->before, volt, w->columns.n * sizeof(pzs_real));
    }
    keep_volts(w);
    return first >= 0 ? finish(w, PZS_W_ELECTRODE, first) : finish(w, PZS_OK, -1);
}
