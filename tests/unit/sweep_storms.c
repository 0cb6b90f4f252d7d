/*
 * Storms: structures x control laws. Each number is the count of storms, of 30, that do not settle:
 * five structures around the model, delays of 0, 1 and 3 ticks, whole and quarter step limits.
 *
 *   storms        the damped tick and clipped least squares on two structures with one delay
 *   storms full   all structures and laws, as a table
 *
 * The damped tick has its default settings, or those that its certificate chooses.
 * Returns 0 where the damped tick settles in every storm, and in the short run clipped least
 * squares in none.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/simulate/certify.h"
#include "../../host_tools/simulate/storm.h"
#include "../rigs/scene_run.h"

#define LINEAR                                                                                     \
    "kinematics=linear;simulate.influence=undeformed;simulate.plant.kinematics=linear;"            \
    "simulate.sensors.noise=0;simulate.amplifiers.step=0;simulate.events=[];"
#define MIRROR                                                                                     \
    "dynamics={damping: 0.01};limits={voltage: [-50, 50], step_limit: 3.3};simulate={ticks: 10};"
#define RIGS "tests/rigs/scenes/"

/* Structures, with a tick rate each. */
static const struct structure {
    const char *name, *scene, *changes;
    bool is_quick; /* part of the short run */
} structures[] = {
    {"plate, 15 Hz, 1 kHz", "plate-closed-loop", LINEAR, false},
    {"near-equal modes, 41 Hz, 1 kHz", RIGS "storm-twins.yaml", "", true},
    {"panel, 54 and 63 Hz, 500 Hz", RIGS "storm-panel.yaml", "control.rate=500", false},
    {"panel, 1 kHz", RIGS "storm-panel.yaml", "", true},
    {"panel, 2 kHz", RIGS "storm-panel.yaml", "control.rate=2000", false},
    {"panel, 5 kHz", RIGS "storm-panel.yaml", "control.rate=5000", false},
    {"mirror, 1.6 kHz, 2 kHz", "mirror", MIRROR "control={rate: 2000}", false},
    {"mirror, 5 kHz", "mirror", MIRROR "control={rate: 5000}", false},
    {"mirror, 10 kHz", "mirror", MIRROR "control={rate: 10000}", false},
    {"mirror, 20 kHz", "mirror", MIRROR "control={rate: 20000}", false},
    {"soft plate, 0.5 Hz, 100 Hz", "plate-closed-loop",
     LINEAR "materials.AS4/3501.density=1440000;materials.G1195.density=6840000;control.rate=100;"
            "limits={voltage: [-300, 300], step_limit: 20}",
     false},
};
enum { STRUCTURES = sizeof structures / sizeof *structures };

/* DAMPED: default settings of the vibration damper; CHOSEN: those that the certificate chooses. */
typedef enum law_kind { STEP, LEAKY, CLIPPED, DAMPED, CHOSEN, LAWS_TRIED } law_kind;
static const char *const law_name[LAWS_TRIED] = {"step", "leaky", "clipped", "damped", "chosen"};

static const int delays[] = {0, 1, 3};
static const double gain[] = {1, 0.8, 0.8, 1.33, 1.33}, frequency[] = {1, 0.9, 1.1, 0.9, 1.1};

/* Failed storms, storms, and the worst end of one structure and law. */
typedef struct tally {
    int failed, storms;
    double worst;
} tally;

static int complain(const char *name, const char *error)
{
    printf("not ok - %s: %s\n", name, error);
    return -1;
}

/* Ten storms of a rig with its list of blocks. */
static int ten_storms(const storm_rig *rig, tally *t, const char *name)
{
    char error[SCENE_ERROR];
    for (int i = 0; i < 10; i++) {
        const storm_plant plant = {.gain = gain[i % 5],
                                   .frequency = frequency[i % 5],
                                   .step_limit = i < 5 ? 1 : 0.25,
                                   .seed = 3};
        storm_result result;
        if (storm_run(rig, &plant, &result, error) < 0)
            return complain(name, error);
        t->storms++;
        t->failed += !result.passed;
        t->worst = result.end > t->worst ? result.end : t->worst;
    }
    return 0;
}

/* Make the tables of the vibration damper with its default settings, or with the chosen ones. */
static int open_damper(damper *damper, analysis *analysis, law_kind kind, char *error)
{
    memset(&analysis->certificate.loop, 0, sizeof analysis->certificate.loop);
    analysis->certificate.has_settings = false;
    if (kind == CHOSEN && certify_loop(analysis, error) < 0)
        return -1;
    const damper_options options = damper_options_of(analysis);
    return damper_make(damper, analysis, NULL, &options, error);
}

/* Storms of one law with one delay. */
static int try_law(storm_rig *rig, analysis *analysis, law_kind kind, tally *t, const char *name)
{
    const estimator none = {0};
    char error[SCENE_ERROR];
    damper damper = {0};
    loop_blocks blocks;
    law law;
    if (kind >= DAMPED && open_damper(&damper, analysis, kind, error) < 0)
        return complain(name, error);
    loop_blocks_fill(&blocks, &analysis->design, &none, &damper);
    if (!law_open(&law, &analysis->design.problem, 0))
        return complain(name, "out of memory");
    law.gain = 0.3;
    law.leak = 0.01;
    const pzs_block other = {kind == LEAKY ? &law_leaky_block : &law_clipped_block, &law};
    for (int k = 0; k < blocks.count && (kind == LEAKY || kind == CLIPPED); k++)
        if (blocks.block[k].type == &pzs_step_block)
            blocks.block[k] = other;
    storm_use(rig, blocks.block, blocks.count, analysis->design.simulate.delay);
    int failed = ten_storms(rig, t, name);
    if (law.problem.step_limit != analysis->design.problem.step_limit)
        failed = complain(name, "a storm has changed the tables of its control law");
    law_close(&law);
    damper_close(&damper);
    return failed;
}

/* Storms of all laws on one structure, with the first `count` delays. */
static int try_structure(const struct structure *s, int count, law_kind from, tally t[LAWS_TRIED])
{
    scene_run run;
    storm_rig rig;
    int failed = 0;
    if (scene_run_open(&run, s->scene, s->changes) < 0 ||
        analysis_influence(&run.analysis, run.error) < 0)
        return complain(s->name, run.error);
    certificate_make(&run.analysis.certificate, &run.analysis);
    if (storm_open(&rig, &run.analysis, NULL, run.error) < 0)
        return complain(s->name, run.error);
    for (int kind = (int)from; kind < LAWS_TRIED; kind++)
        for (int d = 0; d < count; d++) {
            run.analysis.design.simulate.delay = delays[d];
            failed |= try_law(&rig, &run.analysis, (law_kind)kind, &t[kind], s->name) < 0;
        }
    storm_close(&rig);
    scene_run_close(&run);
    return failed ? -1 : 0;
}

static int run_full(void)
{
    int bad = 0;
    printf("  %-32s", "storms that do not settle, of 30");
    for (int kind = 0; kind < LAWS_TRIED; kind++)
        printf(" %9s %9s", law_name[kind], "worst");
    putchar('\n');
    for (int i = 0; i < STRUCTURES; i++) {
        tally t[LAWS_TRIED] = {{0}};
        if (try_structure(&structures[i], 3, STEP, t) < 0)
            return 1;
        printf("  %-32s", structures[i].name);
        for (int kind = 0; kind < LAWS_TRIED; kind++)
            printf(" %9d %9.2g", t[kind].failed, t[kind].worst);
        putchar('\n');
        fflush(stdout);
        bad += t[DAMPED].failed + t[CHOSEN].failed > 0;
    }
    printf("%s - the damped tick settles in every storm on %d of %d structures\n",
           bad ? "not ok" : "ok", STRUCTURES - bad, STRUCTURES);
    return bad > 0;
}

static int run_quick(void)
{
    int bad = 0;
    for (int i = 0; i < STRUCTURES; i++) {
        tally t[LAWS_TRIED] = {{0}};
        if (!structures[i].is_quick)
            continue;
        if (try_structure(&structures[i], 1, CLIPPED, t) < 0)
            return 1;
        printf("%s: of %d storms %d fail with the damped tick, worst %.3g, %d with the settings "
               "that its certificate chooses, worst %.3g; %d with clipped least squares\n",
               structures[i].name, t[DAMPED].storms, t[DAMPED].failed, t[DAMPED].worst,
               t[CHOSEN].failed, t[CHOSEN].worst, t[CLIPPED].failed);
        bad += t[DAMPED].failed + t[CHOSEN].failed > 0 || t[CLIPPED].failed < t[CLIPPED].storms;
    }
    printf("%s - storms\n", bad ? "not ok" : "ok");
    return bad > 0;
}

int main(int argc, char **argv)
{
    return argc > 1 && strcmp(argv[1], "full") == 0 ? run_full() : run_quick();
}
