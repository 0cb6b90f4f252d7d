/*
 * Storms on nonlinear plants with mass: the target jumps ten times, 40 ticks apart, between random
 * multiples of the scene's target, then the target stays. The loop has the settings that its
 * certificate has chosen on a linear plant. Prints, for each structure and plant, the distance of
 * the shape from the optimum of that plant at the end, and the vibration that is left, both over
 * the target. With the argument `full` all rows run, otherwise the first.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#include "pzs.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "../../host_tools/model/certificate_make.h"
#include "../../host_tools/simulate/simulation.h"
#include "../../lib/control/control.h"
#include "../rigs/scene_run.h"

#define PLATE "plate-closed-loop"
#define PANEL "tests/rigs/scenes/storm-panel.yaml"
#define ENDLESS "simulate.amplifiers={step: 0};"

/*
 * A structure with its target: largest normal displacement of the target over the thickness, scene,
 * changes of it, and the multiple of the scene's target to which the storm leads.
 */
typedef struct structure {
    const char *name, *scene, *changes;
    double scale;
    int rest; /* ticks for which the last target stays */
} structure;

#define STRONG "limits={voltage: [-1000, 1000], step_limit: 60};"
#define UNDEFORMED "simulate.influence=undeformed;"

static const structure structures[] = {
    {"plate, 2 thicknesses, at target", PLATE, ENDLESS, 1, 500},
    {"plate, 2 thicknesses", PLATE, ENDLESS UNDEFORMED, 1, 500},
    {"plate, 3 thicknesses", PLATE, ENDLESS STRONG UNDEFORMED "target.value=0.15*x*(y-0.1);", 1,
     500},
    {"plate, 4 thicknesses", PLATE, ENDLESS STRONG UNDEFORMED "target.value=0.2*x*(y-0.1);", 1,
     500},
    {"plate, 6 thicknesses", PLATE, ENDLESS STRONG UNDEFORMED "target.value=0.3*x*(y-0.1);", 1,
     500},
    {"plate, 6 thicknesses, at target", PLATE, ENDLESS STRONG "target.value=0.3*x*(y-0.1);", 1,
     500},
    {"plate, dish of 4 thicknesses", PLATE, ENDLESS STRONG UNDEFORMED "target.value=0.1*x*x;", 1,
     500},
    {"panel, 0.1 thicknesses", PANEL, ENDLESS "kinematics=nonlinear;", 1, 300},
    {"panel, 1 thickness", PANEL,
     ENDLESS STRONG "kinematics=nonlinear;target.value=35e-3*theta1^2*theta2;", 1, 300},
    {"panel, 2 thicknesses", PANEL,
     ENDLESS STRONG "kinematics=nonlinear;target.value=70e-3*theta1^2*theta2;", 1, 300},
};

/* Gain and natural frequencies of the plant relative to the model, and share of the step limit. */
static const double plants[][3] = {
    {1, 1, 1}, {1.33, 0.9, 1}, {0.8, 1.1, 0.25}, {1.33, 1.1, 0.25}, {0.8, 0.9, 1}};

static double draw(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / 16777216.0;
}

/* Write the schedule of the storm as a change of the scene. */
static void write_storm(char *text, size_t room, const structure *of, bool has_load)
{
    static const double multiple[4] = {1, -1, 2, -2};
    unsigned seed = 11;
    int length = snprintf(text, room, "simulate.ticks=%d;simulate.events=[%s", 440 + of->rest,
                          has_load ? "{at: 0, load: 0, factor: 0}, " : "");
    for (int k = 1; k <= 10; k++)
        length += snprintf(text + length, room - (size_t)length, "{at: %d, target: %g}, ", 40 * k,
                           of->scale * multiple[(int)(4 * draw(&seed))]);
    snprintf(text + length, room - (size_t)length, "{at: 440, target: %g}];", of->scale);
}

/* Run a storm. Returns 0 where the shape ends within 5 % of the target of the plant's optimum. */
static int run_storm(const structure *of, const double plant[3], const char *motion)
{
    char changes[1800], storm[900];
    scene_run run;
    simulation s;
    write_storm(storm, sizeof storm, of, of->scene[0] == 'p');
    snprintf(
        changes, sizeof changes,
        "%s%ssimulate.plant={kinematics: nonlinear, hysteresis: 0, motion: %s, stiffness: %g, d: "
        "%g}",
        of->changes, storm, motion, plant[1] * plant[1], plant[0]);
    if (scene_run_open(&run, of->scene, changes) < 0)
        return printf("%s\n", run.error), 1;
    if (analysis_influence(&run.analysis, run.error) < 0)
        return printf("%s\n", run.error), 1;
    certificate_make(&run.analysis.certificate, &run.analysis);
    if (simulate_open(&s, &run.analysis, run.error) < 0)
        return printf("%s\n", run.error), 1;
    for (int k = 0; k < run.analysis.design.amplifiers; k++)
        run.analysis.design.step_limit[k] *= plant[2];
    run.analysis.design.problem.crc = pzs_problem_crc(&run.analysis.design.problem);
    int failed = simulate_run(&s, LAW_CONTROLLER, NULL, NULL, run.error) < 0;
    if (failed)
        printf("%s\n", run.error);
    simulation last = s;
    last.phase = s.phase + s.phases - 1;
    last.phases = 1;
    failed = failed || simulate_optima(&last, run.error) < 0;
    const simulate_course *course = &last.phase->course[LAW_CONTROLLER];
    double peak = 0;
    for (int k = 0; k < s.phases; k++)
        peak = fmax(peak, s.phase[k].course[LAW_CONTROLLER].worst);
    printf("%-36s %-9s gain %-4g f %-3g step %-4g: optimum %.4f end %.4f vibration %.5f of %.3f, "
           "settled %d, peak %.1f, certificate %s, %.2f solves a step\n",
           of->name, motion, plant[0], plant[1], plant[2], last.phase->optimum, course->steady,
           course->vibration, course->vibration_worst, course->settled, peak,
           run.analysis.certificate.loop.is_stable ? "stable" : "UNSTABLE",
           s.plant.shell_motion.steps
               ? (double)s.plant.shell_motion.linear_solves / (double)s.plant.shell_motion.steps
               : 0);
    fflush(stdout);
    failed = failed || course->steady > last.phase->optimum + 0.05 || course->vibration > 0.05;
    simulate_close(&s);
    scene_run_close(&run);
    return failed;
}

int main(int argc, char **argv)
{
    const bool is_full = argc > 1 && strcmp(argv[1], "full") == 0;
    const int only = argc > 1 && !is_full ? atoi(argv[1]) : -1;
    const int one = argc > 2 ? atoi(argv[2]) : -1;
    int failed = 0, count = 0;
    for (int i = 0; i < (int)(sizeof structures / sizeof *structures); i++)
        for (int k = 0; k < (int)(sizeof plants / sizeof *plants); k++) {
            if ((only >= 0 && i != only) || (one >= 0 && k != one) ||
                (!is_full && only < 0 && i + k > 0))
                continue;
            failed += run_storm(&structures[i], plants[k], argc > 3 ? argv[3] : "nonlinear");
            count++;
        }
    printf("%d of %d storms on nonlinear plants end within 5 %% of the optimum\n", count - failed,
           count);
    return failed > 0;
}
