/*
 * Storms: structures x control laws (storm_sweep.h). Each number is the count of storms, of 40,
 * that do not settle: five structures around the model, delays of 0 to 3 ticks, whole and quarter
 * step limits. The damped tick has its default settings, or those that its certificate chooses;
 * with the latter the storms also run on ceramic with the hysteresis of the scene.
 *
 * A storm settles if the shape at all target nodes ends within 5 % of the target from the bounded
 * optimum of the simulated structure. Also where the loop has eight sensors: these suffice to find
 * the optimum of a structure of another gain. They show only a part of the effect of hysteresis;
 * there the shape need only come to rest (storm.h), and `unseen` tells how far from the optimum.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "storm_sweep.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/storm.h"
#include "../../lib/control/control.h"
#include "scene_run.h"
#include "storm_structures.h"

static const storm_structure structures[] = {
    STORM_STRUCTURES(false, true),
    {"plate, 8 sensors of 121 nodes", "plate-few-sensors", LINEAR, true},
};
enum { STRUCTURES = sizeof structures / sizeof *structures };

/*
 * DAMPED: default settings of the vibration damper; CHOSEN: those that the certificate chooses;
 * HYSTERESIS: the same on ceramic with hysteresis, tried together with CHOSEN.
 */
typedef enum law_kind { STEP, LEAKY, CLIPPED, DAMPED, CHOSEN, HYSTERESIS, LAWS_TRIED } law_kind;
static const char *const law_name[LAWS_TRIED] = {"step",   "leaky",  "clipped",
                                                 "damped", "chosen", "hysteresis"};

static const int delays[] = {0, 1, 2, 3};
static const double gain[] = {1, 0.8, 0.8, 1.33, 1.33}, frequency[] = {1, 0.9, 1.1, 0.9, 1.1};

/* Failed storms, storms, and the worst end of one structure and law. */
typedef struct tally {
    int failed, storms;
    double worst;
    double unseen; /* largest distance from the best shape at which a loop with few sensors comes to
                      rest on ceramic with hysteresis */
} tally;

/* What a sweep runs. */
typedef struct sweep {
    const char *only;                   /* first characters of the structures' names */
    law_kind from;                      /* first of the laws */
    int delays;                         /* number of delays, from the first one on */
    const storm_controller *controller; /* controller of the damped tick; NULL: that of the host */
    const storm_controller *same; /* controller that must have the bits of the host's; or NULL */
    const char *precision;        /* precision of the controller, for messages */
} sweep;

static int complain(const char *name, const char *error)
{
    printf("not ok - %s: %s\n", name, error);
    return -1;
}

/* ---- controller of the calling program ---------------------------------- */

/*
 * Tables of the step block that passes the target and the measured shape to the controller of the
 * calling program, and takes its voltages.
 */
typedef struct passed {
    pzs_problem problem; /* stays the first member: storms put their limits into it */
    const pzs_vibration *vibration;
    const storm_controller *controller;
    double *voltage; /* [inputs] voltages of the controller (V) */
} passed;

static storm_tables tables_of(const passed *p)
{
    const pzs_problem *problem = &p->problem;
    const pzs_vibration *vibration = p->vibration;
    return (storm_tables){.inputs = problem->inputs,
                          .outputs = problem->outputs,
                          .sensors = vibration->sensors,
                          .modes = vibration->modes,
                          .delay = vibration->delay,
                          .work_limit = problem->work_limit,
                          .influence = problem->influence,
                          .hessian = problem->hessian,
                          .weight = problem->weight,
                          .lower = problem->lower,
                          .upper = problem->upper,
                          .step_limit = problem->step_limit,
                          .reference_voltage = problem->reference_voltage,
                          .regularisation = problem->regularisation,
                          .shape = vibration->shape,
                          .reading = vibration->reading,
                          .direct = vibration->direct,
                          .gain = vibration->gain,
                          .precision = vibration->precision,
                          .modal = vibration->modal,
                          .turn = vibration->turn,
                          .observer = vibration->observer,
                          .explain = vibration->explain,
                          .damping = vibration->damping,
                          .inverse_angle = vibration->inverse_angle,
                          .share = vibration->share,
                          .mix = vibration->mix,
                          .slow = vibration->slow};
}

static size_t pass_bytes(const void *tables, const pzs_problem *problem)
{
    return pzs_step_block.block_bytes(tables, problem);
}

static pzs_status pass_init(void *self, const void *tables, pzs_loop_signals *signals)
{
    const passed *p = tables;
    const storm_tables given = tables_of(p);
    if (!p->controller->start(&given))
        return PZS_E_ARGUMENT;
    return pzs_step_block.block_init(self, tables, signals);
}

static pzs_status pass_tick(void *self, pzs_loop_signals *signals)
{
    const passed *p = signals->tables;
    pzs_control *control = signals->control;
    (void)self;
    if (!p->controller->tick(signals->wanted, signals->readings, p->voltage))
        return PZS_E_STAGE;
    for (size_t k = 0; k < p->problem.inputs; k++)
        control->state.voltage[k] =
            fmin(fmax(p->voltage[k], control->info.lower[k]), control->info.upper[k]);
    pzs_control_moved(control);
    return PZS_OK;
}

static const pzs_block_type pass_block = {"controller", PZS_PHASE_STEP, pass_bytes,
                                          pass_init,    pass_tick,      NULL};

/* ---- storms ------------------------------------------------------------ */

/* Ten storms of a rig with its list of blocks, with hysteresis or without. */
static int ten_storms(const storm_rig *rig, bool has_hysteresis, tally *t, const char *name)
{
    char error[SCENE_ERROR];
    for (int i = 0; i < 10; i++) {
        const storm_plant plant = {.gain = gain[i % 5],
                                   .frequency = frequency[i % 5],
                                   .step_limit = i < 5 ? 1 : 0.25,
                                   .seed = 3,
                                   .has_hysteresis = has_hysteresis};
        storm_result result;
        if (storm_run(rig, &plant, &result, error) < 0)
            return complain(name, error);
        t->storms++;
        t->failed += !result.passed;
        t->worst = fmax(t->worst, result.end);
        t->unseen = fmax(t->unseen, result.unseen);
    }
    return 0;
}

/*
 * Storms of a rig with its list of blocks. With the settings that the certificate chooses the same
 * storms follow with hysteresis.
 *   t in/out  tally of the law; that of HYSTERESIS follows that of CHOSEN
 */
static int try_storms(const storm_rig *rig, law_kind kind, tally *t, const char *name)
{
    const int failed = ten_storms(rig, false, t, name);
    return kind == CHOSEN && !failed ? ten_storms(rig, true, t + 1, name) : failed;
}

/* Make the tables of the vibration damper with its default settings, or with the chosen ones. */
static int open_damper(damper *damper, const estimator *few, analysis *analysis, law_kind kind,
                       char *error)
{
    memset(&analysis->certificate.loop, 0, sizeof analysis->certificate.loop);
    analysis->certificate.has_settings = false;
    if (kind == CHOSEN && certify_loop(analysis, error) < 0)
        return -1;
    const damper_options options = damper_options_of(analysis);
    return damper_make(damper, analysis, few, &options, error);
}

/*
 * Storms of the list of blocks with another step block, for a law for comparison.
 *   blocks in/out  blocks of the tick
 */
static int try_other(storm_rig *rig, loop_blocks *blocks, law_kind kind, tally *t, const char *name)
{
    const design *design = blocks->design;
    law law;
    if (!law_open(&law, &design->problem, 0))
        return complain(name, "out of memory");
    law.gain = 0.3;
    law.leak = 0.01;
    const pzs_block other = {kind == LEAKY ? &law_leaky_block : &law_clipped_block, &law};
    for (int k = 0; k < blocks->count; k++)
        if (blocks->block[k].type == &pzs_step_block)
            blocks->block[k] = other;
    storm_use(rig, blocks->block, blocks->count, design->simulate.delay);
    int failed = try_storms(rig, kind, t, name);
    if (law.problem.step_limit != design->problem.step_limit)
        failed = complain(name, "a storm has changed the tables of its control law");
    law_close(&law);
    return failed;
}

/* Storms of the damped tick in the controller of the calling program. */
static int try_controller(storm_rig *rig, const loop_blocks *blocks, const damper *damper,
                          const storm_controller *controller, law_kind kind, tally *t,
                          const char *name)
{
    passed p = {blocks->problem, &damper->tables, controller, NULL};
    p.voltage = calloc(p.problem.inputs, sizeof *p.voltage);
    if (!p.voltage)
        return complain(name, "out of memory");
    const pzs_block block = {&pass_block, &p};
    storm_use(rig, &block, 1, blocks->design->simulate.delay);
    const int failed = try_storms(rig, kind, t, name);
    free(p.voltage);
    return failed;
}

/* Storms of one law with one delay. */
static int try_law(storm_rig *rig, analysis *analysis, law_kind kind, const sweep *sweep, tally *t,
                   const char *name)
{
    const estimator none = {0}, *few = rig->estimator;
    char error[SCENE_ERROR];
    damper damper = {0};
    loop_blocks blocks;
    int failed = 0;
    if (kind >= DAMPED && open_damper(&damper, few, analysis, kind, error) < 0)
        return complain(name, error);
    loop_blocks_fill(&blocks, &analysis->design, few ? few : &none, &damper);
    storm_use(rig, blocks.block, blocks.count, analysis->design.simulate.delay);
    if (kind == LEAKY || kind == CLIPPED)
        failed = try_other(rig, &blocks, kind, t, name);
    else if (kind >= DAMPED && sweep->controller)
        failed = try_controller(rig, &blocks, &damper, sweep->controller, kind, t, name);
    else
        failed = try_storms(rig, kind, t, name);
    if (kind >= DAMPED && sweep->same && !failed) {
        tally other[2] = {{0}}; /* the second is that of HYSTERESIS */
        failed = try_controller(rig, &blocks, &damper, sweep->same, kind, other, name);
        if (!failed && memcmp(&other->worst, &t->worst, sizeof t->worst) != 0)
            failed = complain(name, "the controller of the program has other bits");
    }
    damper_close(&damper);
    return failed;
}

/* Storms of all laws of a sweep on one structure. */
static int try_structure(const storm_structure *s, const sweep *sweep, tally t[LAWS_TRIED])
{
    scene_run run;
    estimator estimator = {0};
    storm_rig rig;
    int failed = 0;
    if (scene_run_open(&run, s->scene, s->changes) < 0 ||
        analysis_influence(&run.analysis, run.error) < 0)
        return complain(s->name, run.error);
    certificate_make(&run.analysis.certificate, &run.analysis);
    const bool has_few = loop_estimates(&run.analysis.design);
    if ((has_few && estimator_open(&estimator, &run.analysis, run.error) < 0) ||
        storm_open(&rig, &run.analysis, has_few ? &estimator : NULL, run.error) < 0)
        return complain(s->name, run.error);
    for (int kind = (int)sweep->from; kind < HYSTERESIS; kind++)
        for (int d = 0; d < sweep->delays; d++) {
            run.analysis.design.simulate.delay = delays[d];
            failed |= try_law(&rig, &run.analysis, (law_kind)kind, sweep, &t[kind], s->name) < 0;
        }
    storm_close(&rig);
    estimator_close(&estimator);
    scene_run_close(&run);
    return failed ? -1 : 0;
}

static int run_full(const sweep *sweep)
{
    int bad = 0, count = 0;
    printf("  %-32s", "storms that do not settle, of 40");
    for (int kind = (int)sweep->from; kind < LAWS_TRIED; kind++)
        printf(" %10s %9s", law_name[kind], "worst");
    putchar('\n');
    for (int i = 0; i < STRUCTURES; i++) {
        tally t[LAWS_TRIED] = {{0}};
        if (strncmp(structures[i].name, sweep->only, strlen(sweep->only)) != 0)
            continue;
        if (try_structure(&structures[i], sweep, t) < 0)
            return 1;
        count++;
        printf("  %-32s", structures[i].name);
        for (int kind = (int)sweep->from; kind < LAWS_TRIED; kind++)
            printf(" %10d %9.2g", t[kind].failed, t[kind].worst);
        if (t[HYSTERESIS].unseen > 0)
            printf("  unseen %.2g", t[HYSTERESIS].unseen);
        putchar('\n');
        fflush(stdout);
        bad += t[DAMPED].failed + t[CHOSEN].failed > 0;
    }
    printf("%s - the damped tick%s settles in every storm on %d of %d structures\n",
           bad || count == 0 ? "not ok" : "ok", sweep->precision, count - bad, count);
    return bad || count == 0;
}

static int run_quick(const sweep *sweep)
{
    int bad = 0;
    for (int i = 0; i < STRUCTURES; i++) {
        tally t[LAWS_TRIED] = {{0}};
        if (!structures[i].is_quick)
            continue;
        if (try_structure(&structures[i], sweep, t) < 0)
            return 1;
        printf("%s: of %d storms %d fail with the damped tick%s, worst %.3g, %d with the settings "
               "that its certificate chooses, worst %.3g, %d with these and hysteresis, worst %.3g",
               structures[i].name, t[DAMPED].storms, t[DAMPED].failed, sweep->precision,
               t[DAMPED].worst, t[CHOSEN].failed, t[CHOSEN].worst, t[HYSTERESIS].failed,
               t[HYSTERESIS].worst);
        if (t[HYSTERESIS].unseen > 0)
            printf(" (from rest, %.3g from the best shape)", t[HYSTERESIS].unseen);
        if (t[CLIPPED].storms > 0)
            printf("; %d with clipped least squares", t[CLIPPED].failed);
        putchar('\n');
        bad += t[DAMPED].failed + t[CHOSEN].failed + t[HYSTERESIS].failed > 0 ||
               t[CLIPPED].failed < t[CLIPPED].storms;
    }
    printf("%s - storms%s\n", bad ? "not ok" : "ok", sweep->precision);
    return bad > 0;
}

int bridge_storms(bool is_full, const char *only, const storm_controller *controller,
                  const storm_controller *same)
{
    const law_kind first = is_full ? STEP : CLIPPED;
    const sweep sweep = {.only = only,
                         .from = controller ? DAMPED : first,
                         .delays = is_full ? (int)(sizeof delays / sizeof *delays) : 1,
                         .controller = controller,
                         .same = same,
                         .precision = controller ? controller->name : ""};
    return is_full ? run_full(&sweep) : run_quick(&sweep);
}
