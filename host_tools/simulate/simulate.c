/* The closed loop (simulate.h). */
#include "simulate.h"
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/control/control.h"
#include "../model/clipped.h"
#include "../../lib/core/guard.h"
#include "../tables/loop_blocks.h"
#include "simulate_loop.h"
#include "../tables/tables.h"

enum {
    LAST = 20 /* ticks that count as the end of a phase */,
    WINDOW = 1000 /* ticks in which settling is looked for */
};

static const double settled_part = 0.05;

static int no_memory(const analysis *nominal, char *error)
{
    return scene_fault(nominal->design.scene, nominal->design.scene->simulate.at, error,
                       "out of memory");
}

/* ---- open ------------------------------------------------------------- */

static int course_room(simulate_course *c, const design *d)
{
    c->volt = calloc((size_t)d->amplifiers, sizeof *c->volt);
    c->shape = calloc((size_t)d->targets, sizeof *c->shape);
    c->u = calloc((size_t)d->mesh.dof, sizeof *c->u);
    return c->volt && c->shape && c->u;
}

/* A phase from its tick to the end. Returns whether memory was there. */
static int phase_begin(simulation *s, int tick, int first)
{
    const design *d = &s->plant.analysis.design;
    simulate_phase *p = &s->phase[s->phases++];
    if (s->phases > 1)
        p[-1].until = tick;
    p->from = tick;
    p->until = d->scene->simulate.ticks;
    p->first = first;
    p->optimum = (double)NAN;
    bool rooms = true;
    for (int law = 0; law < LAWS; law++)
        rooms = course_room(&p->course[law], d) && rooms;
    p->target = calloc((size_t)d->targets, sizeof *p->target);
    p->amount = calloc((size_t)d->loads + 1, sizeof *p->amount);
    p->held = calloc((size_t)d->amplifiers, sizeof *p->held);
    return rooms && p->target && p->amount && p->held;
}

/* A phase for every tick with events, one for the ticks before them, one for those after the random
 * faults. */
static int lay_out_phases(simulation *s)
{
    const scene_simulate *simulate = &s->nominal->design.scene->simulate;
    int quiet = simulate->fault_chance > 0 && simulate->fault_until < simulate->ticks
                    ? simulate->fault_until
                    : -1,
        good;
    s->phase = calloc((size_t)simulate->events + 2, sizeof *s->phase);
    good = s->phase != NULL && phase_begin(s, 0, 0);
    for (int k = 0; good && k < simulate->events; k++) {
        const int tick = simulate->event[k].tick;
        if (quiet >= 0 && tick >= quiet) {
            good = tick == quiet || phase_begin(s, quiet, k);
            quiet = -1;
        }
        if (good && tick > s->phase[s->phases - 1].from)
            good = phase_begin(s, tick, k);
        s->phase[s->phases - 1].events++;
    }
    return good && quiet >= 0 ? phase_begin(s, quiet, simulate->events) : good;
}

/* Volts and charges of electrodes have no influence at a shape. */
static int check_readings(const design *d, char *error)
{
    const scene_estimate *estimate = &d->scene->estimate;
    for (int r = 0; r < estimate->readings; r++)
        if (d->scene->output[estimate->reading[r].output].electric != ELECTRIC_NONE)
            return scene_fault(d->scene, estimate->reading[r].at, error,
                               "'%s' is read by an electrode, whose gains are made at rest; "
                               "write influence: rest in simulate",
                               d->scene->output[estimate->reading[r].output].name);
    return 0;
}

/* Influence at the best shape of the nonlinear structure that the controller knows. */
int simulate_tables(analysis *nominal, char *error)
{
    design *d = &nominal->design;
    voltages best;
    if (!d->scene->simulate.at_target)
        return 0;
    if (check_readings(d, error) < 0)
        return -1;
    memset(&best, 0, sizeof best);
    nominal->nonlinear = 1;
    int failed =
        voltages_optimum(nominal, (common_limits){.source = LIMITS_SCENE}, &best, error) < 0;
    if (!failed && pzs_influence_at(&nominal->path.run, nominal->influence) != PZS_OK)
        failed = analysis_explain(nominal, PZS_E_NEGATIVE, error);
    double *column = calloc((size_t)d->targets, sizeof *column);
    if (!failed && !column)
        failed = no_memory(nominal, error);
    if (!failed)
        design_influence_free(d, nominal->influence, d->structure.input.count, column,
                              d->influence);
    free(column);
    d->problem.hessian = NULL;
    d->problem.crc = pzs_problem_crc(&d->problem);
    voltages_free(&best);
    return failed ? -1 : 0;
}

/* Loops are measured by the range of the volts. */
static int check_range(const design *d, char *error)
{
    for (int k = 0; k < d->amplifiers; k++)
        if (!isfinite(d->upper[k] - d->lower[k]) && d->scene->simulate.hysteresis > 0)
            return scene_fault(d->scene, d->scene->simulate.at, error,
                               "hysteresis is a part of the range of the volts; add "
                               "limits: {voltage: [lowest, highest]}");
    return 0;
}

/*
 * The fault detector compares measured with predicted displacements, from which free functions have
 * been taken out.
 */
static int check_free(const design *d, char *error)
{
    if (d->free_functions == 0 || !d->scene->simulate.finds)
        return 0;
    return scene_fault(
        d->scene, d->scene->simulate.at, error,
        "told: found does not work with target.free: the fault "
        "detector needs the whole predicted displacement; write told: TICKS or remove target.free");
}

/* What stands beside the controller. Returns 0, or -1 with error filled. */
static int equip(simulation *s, char *error)
{
    const scene *scene = s->nominal->design.scene;
    s->problem = &s->nominal->design.problem;
    s->estimates = loop_estimates(scene);
    s->feeds = loop_feeds(scene);
    s->quantises = loop_quantises(scene);
    if ((s->estimates || s->feeds) && estimator_open(&s->estimator, s->nominal, error) < 0)
        return -1;
    s->blocks = calloc(1, sizeof *s->blocks);
    if (!s->blocks)
        return no_memory(s->nominal, error);
    loop_blocks_fill(s->blocks, &s->nominal->design, &s->estimator);
    return 0;
}

/*
 * The best single parameter for the scene's target, known before the run. Returns 0, or -1 with
 * error filled.
 */
static int regularise(simulation *s, char *error)
{
    const design *d = &s->nominal->design;
    clipped c;
    double *voltage = calloc((size_t)d->amplifiers, sizeof *voltage);
    int failed = clipped_open(&c, d, d->lower, d->upper, d->wanted) < 0 || !voltage
                     ? no_memory(s->nominal, error)
                     : 0;
    const pzs_status status = failed ? PZS_OK : clipped_tune(&c, voltage, &s->regularisation);
    if (status != PZS_OK)
        failed = scene_fault(d->scene, d->scene->limits.at, error, "%s", pzs_status_text(status));
    s->regularised = d->problem;
    s->regularised.regularisation += s->regularisation * c.scale;
    s->regularised.crc = 0;
    s->regularised.crc = pzs_problem_crc(&s->regularised);
    clipped_close(&c);
    free(voltage);
    return failed;
}

int simulate_open(simulation *s, analysis *nominal, char *error)
{
    const design *d = &nominal->design;
    memset(s, 0, sizeof *s);
    s->nominal = nominal;
    if (check_range(d, error) < 0 || check_free(d, error) < 0 ||
        plant_open(&s->plant, d->scene, error) < 0)
        return -1;
    const double squares = design_squares(d, d->target, NULL);
    s->reference = squares > 0 ? sqrt(squares) : 1;
    int failed = lay_out_phases(s) ? 0 : no_memory(nominal, error);
    failed = failed || simulate_tables(nominal, error) < 0 || equip(s, error) < 0 ||
             regularise(s, error) < 0;
    if (failed)
        simulate_close(s);
    return failed ? -1 : 0;
}

static int write_tables(const simulation *s, char *error)
{
    char path[DEVICE_PATH + 16];
    tables_size size;
    snprintf(path, sizeof path, "%s/loop.h", s->folder);
    FILE *file = fopen(path, "w");
    int failed = !file || tables_write(file, s->nominal, TABLES_CONTROL, "demo", &size) < 0;
    failed |= file && fclose(file) != 0;
    if (failed)
        snprintf(error, SCENE_ERROR, "cannot write %.300s", path);
    return failed ? -1 : 0;
}

int simulate_device(simulation *s, const device_board *board, char *error)
{
    if (device_folder(s->folder, error) < 0 || write_tables(s, error) < 0 ||
        device_build(board, s->folder, error) < 0)
        return -1;
    s->board = board;
    return 0;
}

void simulate_close(simulation *s)
{
    for (int k = 0; k < s->phases; k++) {
        for (int law = 0; law < LAWS; law++) {
            free(s->phase[k].course[law].volt);
            free(s->phase[k].course[law].shape);
            free(s->phase[k].course[law].u);
        }
        free(s->phase[k].target);
        free(s->phase[k].amount);
        free(s->phase[k].held);
    }
    free(s->phase);
    estimator_close(&s->estimator);
    free(s->blocks);
    device_remove(s->folder);
    plant_close(&s->plant);
    memset(s, 0, sizeof *s);
}

/* ---- what a phase came to --------------------------------------------- */

typedef struct course_log {
    double *window; /* [WINDOW][targets] shapes at the start of the phase, */
    double *last;   /* [LAST][targets] at its end, */
    double *mean;   /* [targets] the mean of those */
    double error[LAST], missed[LAST];
    double *before; /* [amplifiers] volts before the phase */
    int ticks;
} course_log;

static int log_open(course_log *f, const design *d)
{
    const size_t m = (size_t)d->targets;
    memset(f, 0, sizeof *f);
    f->window = calloc(WINDOW * m, sizeof *f->window);
    f->last = calloc(LAST * m, sizeof *f->last);
    f->mean = calloc(m, sizeof *f->mean);
    f->before = calloc((size_t)d->amplifiers, sizeof *f->before);
    return f->window && f->last && f->mean && f->before;
}

static void log_close(course_log *f)
{
    free(f->window);
    free(f->last);
    free(f->mean);
    free(f->before);
}

static void follow(course_log *f, const loop *l, simulate_course *c)
{
    const size_t m = (size_t)l->design->targets;
    if (f->ticks < WINDOW)
        memcpy(f->window + (size_t)f->ticks * m, l->shape, m * sizeof *f->window);
    memcpy(f->last + (size_t)(f->ticks % LAST) * m, l->shape, m * sizeof *f->last);
    f->error[f->ticks % LAST] = l->error;
    f->missed[f->ticks % LAST] = l->missed;
    c->worst = fmax(c->worst, l->error);
    f->ticks++;
}

/* |W (x - y)| */
static double apart(const design *d, const double *x, const double *y)
{
    return sqrt(design_squares(d, x, y));
}

/* Ticks after which every shape of the window is within a part of the largest distance from the
 * last ones. */
static int settled_after(const course_log *f, const design *d)
{
    const size_t m = (size_t)d->targets;
    const int ticks = f->ticks < WINDOW ? f->ticks : WINDOW;
    double most = 0;
    int after = 0;
    for (int k = 0; k < ticks; k++)
        most = fmax(most, apart(d, f->window + (size_t)k * m, f->mean));
    for (int k = 0; k < ticks; k++)
        if (apart(d, f->window + (size_t)k * m, f->mean) > settled_part * most)
            after = k + 1;
    return after < ticks ? after : -1;
}

/* Means over the last ticks: at most a quarter of the phase. */
static void finish_course(course_log *f, const loop *l, simulate_course *c)
{
    const design *d = l->design;
    const int quarter = (f->ticks + 3) / 4, count = quarter < LAST ? quarter : LAST;
    double squares = 0, missed = 0, slew = 0;
    memset(f->mean, 0, (size_t)d->targets * sizeof *f->mean);
    for (int k = f->ticks - count; k < f->ticks; k++) {
        squares += f->error[k % LAST] * f->error[k % LAST] / count;
        missed += f->missed[k % LAST] * f->missed[k % LAST] / count;
        for (int i = 0; i < d->targets; i++)
            f->mean[i] += f->last[(k % LAST) * d->targets + i] / count;
    }
    for (int k = 0; k < d->amplifiers; k++)
        slew = fmax(slew, fabs(l->given[k] - f->before[k]) / d->slew[k]);
    c->steady = sqrt(squares);
    c->missed = sqrt(missed);
    c->settled = settled_after(f, d);
    c->slew_ticks = (int)fmin(ceil(slew), 1e9);
    memcpy(c->volt, l->given, (size_t)d->amplifiers * sizeof *c->volt);
    memcpy(c->shape, l->shape, (size_t)d->targets * sizeof *c->shape);
    memcpy(f->before, l->given, (size_t)d->amplifiers * sizeof *f->before);
    f->ticks = 0;
}

/* Conditions at the end of a phase, for its optimum. */
static void keep_conditions(const loop *l, simulate_phase *p)
{
    const design *d = l->design;
    memcpy(p->target, l->wanted, (size_t)d->targets * sizeof *p->target);
    memcpy(p->amount, l->load, ((size_t)d->loads + 1) * sizeof *p->amount);
    for (int k = 0; k < d->amplifiers; k++)
        p->held[k] = l->electrode[k].fault == ELECTRODE_GOOD ? (double)NAN : l->electrode[k].held;
}

/* ---- run -------------------------------------------------------------- */

static void tell(const loop *l, simulate_law law, int tick, simulate_watch *watch, void *context)
{
    const simulate_sample sample = {.law = law,
                                    .tick = tick,
                                    .error = l->error,
                                    .missed = l->missed,
                                    .command = l->command,
                                    .volt = l->given,
                                    .active = loop_active(l),
                                    .passes = l->passes,
                                    .status = l->status,
                                    .lost = l->is_lost};
    if (watch)
        watch(context, &sample);
}

static void count_tick(const loop *l, simulate_count *count)
{
    count->beyond += l->beyond;
    count->not_finite += l->not_finite;
    count->lost += l->is_lost;
    if (l->is_lost)
        return;
    count->same += l->same;
    count->found += l->found;
    count->wrong += l->wrong;
    count->search = l->search > count->search ? l->search : count->search;
    count->passes += l->passes;
    count->passes_most = l->passes > count->passes_most ? l->passes : count->passes_most;
    count->status[l->status <= PZS_W_UNSTABLE ? l->status : 0]++;
}

static int run_ticks(simulation *s, loop *l, course_log *f, simulate_law law, simulate_watch *watch,
                     void *context, char *error)
{
    const int ticks = l->design->scene->simulate.ticks;
    simulate_phase *p = s->phase;
    for (int tick = 0; tick < ticks; tick++) {
        if (loop_tick(l, tick, error) < 0)
            return -1;
        follow(f, l, &p->course[law]);
        tell(l, law, tick, watch, context);
        count_tick(l, &s->count[law]);
        if (tick + 1 < p->until)
            continue;
        finish_course(f, l, &p->course[law]);
        if (law == LAW_CONTROLLER)
            keep_conditions(l, p);
        if (plant_displacement(&s->plant, p->course[law].u, error) < 0)
            return -1;
        p++;
    }
    return 0;
}

int simulate_run(simulation *s, simulate_law law, simulate_watch *watch, void *context, char *error)
{
    course_log f;
    loop l;
    const double begin = analysis_now();
    memset(&s->count[law], 0, sizeof s->count[law]);
    for (int k = 0; k < s->phases; k++)
        s->phase[k].course[law].worst = 0;
    int failed = log_open(&f, &s->nominal->design) ? 0 : no_memory(s->nominal, error);
    failed = loop_open(&l, s, law, error) < 0 || failed ||
             run_ticks(s, &l, &f, law, watch, context, error) < 0;
    loop_close(&l);
    log_close(&f);
    s->count[law].seconds = analysis_now() - begin;
    return failed ? -1 : 0;
}

long simulate_ran(const simulate_count *count)
{
    long run = 0;
    for (int k = 0; k <= PZS_W_UNSTABLE; k++)
        run += count->status[k];
    return run;
}

/* ---- optima ----------------------------------------------------------- */

static int same_conditions(const simulation *s, const simulate_phase *a, const simulate_phase *b)
{
    const design *d = &s->nominal->design;
    int same = memcmp(a->target, b->target, (size_t)d->targets * sizeof *a->target) == 0 &&
               memcmp(a->amount, b->amount, ((size_t)d->loads + 1) * sizeof *a->amount) == 0;
    for (int k = 0; k < d->amplifiers; k++)
        same = same && (isnan(a->held[k]) ? isnan(b->held[k]) : a->held[k] == b->held[k]);
    return same;
}

static int find_optimum(simulation *s, simulate_phase *p, double *shape, char *error)
{
    const design *d = &s->nominal->design;
    voltages best;
    memset(&best, 0, sizeof best);
    plant_rest(&s->plant);
    for (int k = 0; k < d->loads; k++)
        plant_load(&s->plant, k, p->amount[k]);
    plant_warm(&s->plant, p->amount[d->loads]);
    const int failed = plant_optimum(&s->plant, p->target, p->held, &best, shape, error) < 0;
    p->optimum = failed ? (double)NAN : apart(d, shape, p->target) / s->reference;
    voltages_free(&best);
    return failed ? -1 : 0;
}

int simulate_optima(simulation *s, char *error)
{
    double *shape = calloc((size_t)s->plant.analysis.design.targets, sizeof *shape);
    int failed = shape ? 0 : no_memory(s->nominal, error);
    for (int k = 0; k < s->phases && !failed; k++) {
        if (k > 0 && same_conditions(s, &s->phase[k], &s->phase[k - 1]))
            s->phase[k].optimum = s->phase[k - 1].optimum;
        else
            failed = find_optimum(s, &s->phase[k], shape, error) < 0;
    }
    free(shape);
    return failed ? -1 : 0;
}
