/*
 * Storms on nonlinear plants with mass: the target jumps ten times, 40 ticks apart, between 1, -1,
 * 2 and -2 times the scene's target, which then stays. The loop has the settings that its
 * certificate has chosen on a linear plant. Prints, for each structure and plant, the distance of
 * the shape from the target at the end, that of the optimum of the plant, and the vibration that is
 * left.
 *
 *   motion_storms-64                          the first storm
 *   motion_storms-64 full                     all storms
 *   motion_storms-64 ROW [PLANT [MOTION]]     storms of one structure
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
#include "../rigs/uniform.h"

#define PLATE "plate-closed-loop"
#define PANEL "tests/rigs/scenes/storm-panel.yaml"
#define ENDLESS "simulate.amplifiers={step: 0};safety=none;"

/*
 * A structure with its target. is_beyond: the target is so large that `pzs check` warns of it by
 * the rule loop_amplitude or loop_amplitude_certified; the storms need not settle then, and the
 * results are only printed.
 */
typedef struct structure {
    const char *name, *scene, *changes;
    int rest; /* ticks for which the last target stays */
    bool is_beyond;
} structure;

#define STRONG "limits={voltage: [-1000, 1000], step_limit: 60};"
#define UNDEFORMED "simulate.influence=undeformed;"
#define AT_TARGET "simulate.influence=target;"
#define SHELL ENDLESS STRONG "kinematics=nonlinear;"

static const structure structures[] = {
    {"plate, 2 thicknesses, at target", PLATE, ENDLESS, 500, false},
    {"plate, 4 thicknesses, at target", PLATE, ENDLESS STRONG "target.value=0.2*x*(y-0.1);", 500,
     false},
    {"panel, 1 thickness", PANEL, SHELL "target.value=35e-3*theta1^2*theta2;", 300, false},
    {"panel, 3 thicknesses, at target", PANEL,
     SHELL AT_TARGET "target.value=105e-3*theta1^2*theta2;", 300, false},
    {"plate, 2 thicknesses", PLATE, ENDLESS UNDEFORMED, 500, false},
    {"plate, 4 thicknesses", PLATE, ENDLESS STRONG UNDEFORMED "target.value=0.2*x*(y-0.1);", 500,
     true},
    {"plate, 6 thicknesses", PLATE, ENDLESS STRONG UNDEFORMED "target.value=0.3*x*(y-0.1);", 500,
     true},
    {"panel, 2 thicknesses", PANEL, SHELL "target.value=70e-3*theta1^2*theta2;", 1200, false},
};

/* Gain and natural frequencies of the plant relative to the model, and share of the step limit. */
static const double plants[][3] = {
    {1, 1, 1}, {1.33, 0.9, 1}, {0.8, 1.1, 0.25}, {1.33, 1.1, 0.25}, {0.8, 0.9, 1}};

/* Write the schedule of the storm as a change of the scene. */
static void write_storm(char *text, size_t room, const structure *of, bool has_load)
{
    static const double multiple[4] = {1, -1, 2, -2};
    unsigned seed = 11;
    int length = snprintf(text, room, "simulate.ticks=%d;simulate.events=[%s", 440 + of->rest,
                          has_load ? "{at: 0, load: 0, factor: 0}, " : "");
    for (int k = 1; k <= 10; k++)
        length += snprintf(text + length, room - (size_t)length, "{at: %d, target: %g}, ", 40 * k,
                           multiple[(int)(4 * uniform(&seed, 0, 1))]);
    snprintf(text + length, room - (size_t)length, "{at: 440, target: 1}];");
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
    for (int k = 0; k < run.analysis.design.amplifiers; k++)
        run.analysis.design.step_limit[k] *= plant[2];
    run.analysis.design.problem.crc = pzs_problem_crc(&run.analysis.design.problem);
    if (simulate_open(&s, &run.analysis, run.error) < 0)
        return printf("%s\n", run.error), 1;
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
            const int fails =
                run_storm(&structures[i], plants[k], argc > 3 ? argv[3] : "nonlinear");
            failed += fails && !structures[i].is_beyond;
            count += !structures[i].is_beyond;
        }
    printf("%d of %d storms on nonlinear plants end within 5 %% of the optimum\n", count - failed,
           count);
    return failed > 0;
}
