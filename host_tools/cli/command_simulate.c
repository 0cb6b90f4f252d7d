/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs simulate`: the control loop of a scene, tick by tick (command_simulate.h). */
#include "command_simulate.h"
#include <stdio.h>
#include <string.h>
#include "../model/certificate_make.h"
#include "../system/progress.h"
#include "command_parts.h"
#include "export.h"
#include "loop_safety.h"
#include "outfile.h"
#include "print_simulate.h"

/*
 * Write the ticks that were simulated before an error (for example until the supervisor had parked
 * the voltages) to the files of --csv, --npz and --csv-dir. Print how many ticks there are, or
 * which options write them.
 *   csv in/out  open file of --csv; it is closed, and removed where no tick was simulated
 */
static void write_first_ticks(const simulation *run, const options *options, outfile *csv,
                              const history *history)
{
    const long ticks = simulate_ran(&run->count[LAW_CONTROLLER]);
    const bool is_wanted = options->csv || export_is_wanted(options);
    if (options->csv && ticks == 0)
        outfile_drop(csv);
    if (ticks == 0)
        return;
    const int failed = options->csv ? outfile_end(csv, 0) : 0;
    if (failed || export_simulation(options, run, history))
        return;
    fprintf(stderr,
            is_wanted ? "pzs: the %ld ticks before are written\n"
                      : "pzs: --csv FILE.csv or --npz FILE.npz writes the %ld ticks before\n",
            ticks);
}

/*
 * Run all ticks of a simulation, with a CSV file where the options request one, then compute the
 * optimal voltages of each phase (interval between events of the scene).
 *   history out  results of every tick of the controller
 * Returns 0, or an exit code.
 */
static int run_simulation(simulation *run, const options *options, simulate_record *record,
                          history *history)
{
    char error[SCENE_ERROR];
    outfile csv = {NULL, NULL, "", -1};
    const int status = options->csv ? outfile_begin(&csv, options->csv) : 0;
    if (status)
        return status;
    const simulate_sinks sinks = {record, csv.file, history->room > 0 ? history : NULL};
    if (print_run(run, &sinks, error) == 0)
        return options->csv ? outfile_end(&csv, 0) : 0;
    if (options->as_json)
        print_refusal_json(run);
    const int status_of_run = complain(error, 1);
    write_first_ticks(run, options, &csv, history);
    return status_of_run;
}

/*
 * Add warnings about implausible displacements of the plant in a simulation, for example
 * displacements too large for linear kinematics. The displacements at the end of each phase
 * (interval between events of the scene) under the controller are checked.
 */
static void check_phases(plausible *warnings, const simulation *run)
{
    const analysis *analysis = &run->plant.analysis;
    for (int k = 0; k < run->phases; k++) {
        const double *displacement = run->phase[k].course[LAW_CONTROLLER].displacement;
        if (displacement)
            plausible_result(warnings, &analysis->design.mesh, displacement,
                             !analysis->is_nonlinear, "the plant");
    }
}

/* A simulation of the control loop with its record of every tick. */
typedef struct simulated {
    const simulation *run;
    const simulate_record *record;
} simulated;

static int write_simulate(const report_job *job, const void *result)
{
    const simulated *simulated = result;
    return report_simulate(job, simulated->run, simulated->record);
}

/*
 * Make the tables of the loop and the plant of a simulation. Returns 0, or an exit code after
 * printing an error message; the simulation must be closed in either case.
 */
static int open_simulation(simulation *run, const options *options, analysis *analysis)
{
    char error[SCENE_ERROR];
    memset(run, 0, sizeof *run);
    if (!analysis->design.simulate.given) {
        scene_fault(analysis->design.limits.at, error,
                    "nothing to simulate: add `simulate: {ticks: 400}`");
        return complain(error, OPTIONS_WRONG);
    }
    progress_stage("influence matrix");
    if (analysis_influence(analysis, error) < 0)
        return complain(error, OPTIONS_WRONG);
    progress_stage("stability of the loop");
    certificate_make(&analysis->certificate, analysis);
    warn_of_prestress(analysis);
    analysis->quasi_static = options->quasi_static;
    progress_stage("tables of the controller");
    if (simulate_open(run, analysis, error) < 0)
        return complain(error, OPTIONS_WRONG);
    const bool has_device = !options->device || simulate_device(run, options->device, error) == 0;
    return has_device ? 0 : complain(error, 1);
}

/*
 * Whether voltages of the controller were beyond a limit or not finite, or whether those of a board
 * differed from those of its twin on the host.
 */
static bool has_failed(const simulation *run)
{
    const simulate_count *count = &run->count[LAW_CONTROLLER];
    const bool has_twin = run->board && run->board->twin;
    return count->beyond_limits > 0 || count->beyond_rows > 0 || count->not_finite > 0 ||
           (has_twin && simulate_ran(count) > count->agreeing_ticks);
}

/* Add a warning where the simulated loop has diverged. Returns whether it has. */
static bool check_end(plausible *warnings, simulation *run)
{
    const double ratio = simulate_divergence(run);
    const simulate_phase *last = &run->phase[run->phases - 1];
    plausible_end(warnings, run->nominal->design.scene, last->course[LAW_CONTROLLER].steady, ratio);
    return ratio > PLAUSIBLE_DIVERGENCE;
}

/*
 * Print a finished simulation and write it to files. Returns an exit code, that of a failure where
 * the loop has diverged; but a tick without a vibration model that the options ask for may diverge.
 */
static int write_simulation(simulation *run, const options *options, const simulate_record *record,
                            const history *history, plausible *warnings)
{
    const simulated result = {run, record};
    check_phases(warnings, run);
    const bool has_diverged = check_end(warnings, run) && !options->quasi_static;
    progress_stop();
    (options->as_json ? print_simulation_json : print_simulation)(run, record);
    int status = write_reports(options, write_simulate, &result);
    if (status == 0)
        status = export_simulation(options, run, history);
    return status | (has_diverged || has_failed(run));
}

int command_simulate(const options *options, analysis *analysis)
{
    simulation run;
    simulate_record record;
    history history = {.ticks = 0};
    memset(&record, 0, sizeof record);
    int status = open_simulation(&run, options, analysis);
    if (status == 0 && (record_open(&record, &run) < 0 ||
                        (export_is_wanted(options) && !history_open(&history, &analysis->design))))
        status = options_refuse("out of memory for", options->scene);
    if (status == 0)
        status = run_simulation(&run, options, &record, &history);
    if (status == 0)
        status = write_simulation(&run, options, &record, &history, &analysis->warnings);
    record_close(&record);
    history_close(&history);
    simulate_close(&run);
    return status;
}
