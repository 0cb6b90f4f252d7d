/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The program pzs: simulation and precomputation on the host, with one function for each command.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "../model/certificate_make.h"
#include "../model/loaded.h"
#include "../model/design_build.h"
#include "../model/follow_path.h"
#include "../simulate/certify.h"
#include "../tables/tables_modes.h"
#include "command_calibrate.h"
#include "export.h"
#include "../fmu/fmu.h"
#include "help.h"
#include "keys.h"
#include "loop_safety.h"
#include "schema.h"
#include "../system/interrupt.h"
#include "manual.h"
#include "../model/mesh_measure.h"
#include "../scene/scene_migrate.h"
#include "options.h"
#include "outfile.h"
#include "print.h"
#include "print_path.h"
#include "print_simulate.h"
#include "print_vibration.h"
#include "../system/progress.h"
#include "../report/report.h"
#include "../vtk/vtk.h"
#include "templates.h"
#include "../model/voltages.h"

/* Print an error message. Returns the exit code `code`. */
static int complain(const char *error, int code)
{
    progress_stop();
    fprintf(stderr, "pzs: %s\n", error);
    return code;
}

/* ---- scenes ----------------------------------------------------------- */

/* Print that a shipped scene does not exist, with the most similar name. Returns an exit code. */
static int no_scene(const char *name)
{
    suggestion near;
    char text[SUGGEST_TEXT];
    shipped_suggest(&near, name);
    fprintf(stderr,
            "pzs: no shipped scene '%s'%s; see pzs list; a file needs its ending, as %s.yaml\n",
            name, suggest_text(&near, text), name);
    return OPTIONS_WRONG;
}

/*
 * Find the file of a scene that is given as a path or as the name of a shipped scene. Returns an
 * exit code.
 */
static int find_scene(const options *options, char path[OPTIONS_PATH])
{
    struct stat there;
    shipped_path(options->scene, path);
    if (shipped_is_name(options->scene) && stat(path, &there) != 0)
        return no_scene(options->scene);
    return 0;
}

static int open_scene(const options *options, scene *scene)
{
    char path[OPTIONS_PATH], error[SCENE_ERROR];
    const int status = find_scene(options, path);
    if (status)
        return status;
    return scene_read(scene, path, options->set, options->sets, error) == 0
               ? 0
               : complain(error, OPTIONS_WRONG);
}

/*
 * Exit code of a failed analysis: the nonlinear load steps ended early, or the scene contains an
 * error.
 */
static int failed_code(const analysis *analysis)
{
    return analysis_ended_early(analysis) ? 1 : OPTIONS_WRONG;
}

/*
 * Refuse sensors from which the shape cannot be estimated, before any other computation. Returns 0,
 * or -1 with error filled.
 */
static int check_sensors(analysis *analysis, char *error)
{
    estimator estimator;
    if (!analysis->design.estimate.given)
        return 0;
    if (analysis_influence(analysis, error) < 0 || estimator_open(&estimator, analysis, error) < 0)
        return -1;
    estimator_close(&estimator);
    return 0;
}

/*
 * Function that runs a command of pzs on a scene whose analysis is prepared. Returns an exit code.
 */
typedef int command(const options *o, analysis *a);

/*
 * Run a command of pzs, then print the plausibility warnings at the end of the text or in the JSON
 * document. With --strict, a warning leads to the exit code of a failure.
 */
static int run_with_warnings(const options *options, analysis *analysis, command *run)
{
    plausible_scene(&analysis->warnings, analysis->design.scene);
    plausible_mesh(&analysis->warnings, &analysis->design.mesh);
    const int status = run(options, analysis);
    if (!options->as_json)
        plausible_print(stdout, &analysis->warnings);
    return status == 0 && options->is_strict && analysis->warnings.count > 0 ? 1 : status;
}

static int run_on_scene(const options *options, command *run)
{
    scene scene;
    analysis analysis;
    char error[SCENE_ERROR];
    int status = open_scene(options, &scene);
    if (status)
        return status;
    progress_start();
    progress_stage("assembling and factoring");
    if (analysis_prepare(&analysis, &scene, error) == 0 && check_sensors(&analysis, error) == 0)
        status = run_with_warnings(options, &analysis, run);
    else
        status = complain(error, OPTIONS_WRONG);
    analysis_free(&analysis);
    scene_free(&scene);
    return status;
}

/* ---- discretisation error ---------------------------------------------- */

/*
 * Estimate the discretisation error of results where the options ask for it. Returns 0, or an exit
 * code after printing an error message.
 */
static int estimate_error(const options *options, const scene *scene, const mesh_values *values,
                          mesh_measure *measure, const void *context, mesh_error *result)
{
    char error[SCENE_ERROR];
    if (!options->estimates_error)
        return 0;
    progress_stage("coarser meshes");
    if (mesh_error_make(result, scene, values, measure, context, error) < 0)
        return complain(error, OPTIONS_WRONG);
    return 0;
}

/* ---- reports ---------------------------------------------------------- */

/*
 * Function that writes one report (an HTML page or an SVG picture) of the results of a command.
 * Returns 0, or -1.
 */
typedef int write_report(const report_job *job, const void *result);

/* Write the HTML page and the SVG picture that the options request. Returns an exit code. */
static int write_reports(const options *options, write_report *write, const void *result)
{
    const char *const path[2] = {options->report, options->svg};
    int status = 0;
    for (int k = 0; k < 2 && status == 0; k++) {
        outfile output;
        if (!path[k])
            continue;
        status = outfile_begin(&output, path[k]);
        if (status)
            break;
        const report_job job = {output.file, k == 1, options->words, options->words_given};
        status = outfile_end(&output, write(&job, result));
    }
    return status;
}

/* ---- solve ------------------------------------------------------------ */

/*
 * Solution of a scene under its loads: displacement vector [free_dof], the values of all outputs of
 * the scene computed from it, and the stresses recovered from it, or NULL where the user has not
 * asked for them.
 */
typedef struct solution {
    const analysis *analysis;
    const double *displacement, *value;
    const stress_field *stress;
} solution;

static int write_solve(const report_job *job, const void *result)
{
    const solution *solution = result;
    return report_solve(job, solution->analysis, solution->displacement, solution->value,
                        solution->stress);
}

static int write_vtu(const vtk_solution *solution, const char *path)
{
    outfile output;
    if (outfile_begin(&output, path))
        return 1;
    return outfile_end(&output, vtk_write_solution(output.file, solution));
}

/* Estimate the discretisation error of the outputs. Returns an exit code. */
static int solve_error(const options *options, analysis *analysis, const double *value)
{
    mesh_values values = {.count = 0};
    mesh_values_add_outputs(&values, analysis, value);
    return estimate_error(options, analysis->design.scene, &values,
                          options->follows_path ? mesh_measure_path : mesh_measure_solve,
                          &options->branch, &analysis->mesh_error);
}

/*
 * Add plausibility warnings where the equilibrium is unstable or depends on the number of load
 * steps.
 */
static void check_path(analysis *analysis, const double *displacement)
{
    const int is_followed = analysis->load_path.points > 0;
    const int is_reached = !PZS_IS_ERROR(analysis->status);
    progress_stage("load path");
    double difference = (double)NAN, load_factor = 1;
    if (is_reached && !is_followed)
        difference = analysis_path_difference(analysis, displacement, &load_factor);
    plausible_path(&analysis->warnings, analysis->design.scene, difference, load_factor,
                   analysis->equilibrium.solver.info.negative_pivots);
}

/*
 * Print the displacements, forces and voltages of a structure under its loads (command solve) and
 * write them to the files that the options name. Returns an exit code.
 */
static int write_solution(const options *options, analysis *analysis, solution *result)
{
    int status = 0;
    (options->as_json ? print_solve_json : print_solve)(analysis, result->displacement,
                                                        result->value, result->stress);
    if (options->vtu)
        status = write_vtu(&(vtk_solution){.analysis = result->analysis,
                                           .displacement = result->displacement,
                                           .voltage = result->analysis->input_value,
                                           .stress = result->stress},
                           options->vtu);
    if (status == 0)
        status = write_reports(options, write_solve, result);
    return status == 0 ? export_solve(options, analysis, result->displacement, result->value,
                                      result->stress)
                       : status;
}

/*
 * Compute the stresses that belong to a displacement of the structure, and write the result of `pzs
 * solve` with both, the displacement and the stresses.
 */
static int write_stressed(const options *options, analysis *analysis, solution *result)
{
    stress_field field;
    int status = analysis_stresses(analysis, result->displacement, &field) < 0
                     ? complain("out of memory", 1)
                     : 0;
    result->stress = &field;
    if (status == 0)
        plausible_stress(&analysis->warnings, &field);
    if (status == 0)
        status = write_solution(options, analysis, result);
    stress_free(&field);
    return status;
}

static int solved(const options *options, analysis *analysis, const double *displacement)
{
    const pzs_structure *structure = &analysis->design.structure;
    double *value = calloc((size_t)structure->output.count + 1, sizeof *value);
    solution result = {analysis, displacement, value, NULL};
    if (!value)
        return complain("out of memory", 1);
    pzs_observe(structure, displacement, value);
    plausible_result(&analysis->warnings, &analysis->design.mesh, displacement,
                     !analysis->is_nonlinear, "the solution");
    if (analysis->is_nonlinear)
        check_path(analysis, displacement);
    int status = solve_error(options, analysis, value);
    progress_stop();
    if (status == 0)
        status = (options->recovers_stress ? write_stressed : write_solution)(options, analysis,
                                                                              &result);
    free(value);
    return status;
}

/*
 * Compute the displacement of the scene, along the load path where the options ask for it. Returns
 * 0, or an exit code after printing an error message.
 */
static int solve_scene(const options *options, analysis *analysis, double *displacement)
{
    char error[SCENE_ERROR];
    if (!options->follows_path)
        return analysis_solve(analysis, displacement, error) == 0 ? 0 : complain(error, 1);
    if (load_path_follow_branch(&analysis->load_path, analysis, options->branch, error) < 0)
        return complain(error, OPTIONS_WRONG);
    if (!analysis->load_path.is_complete) {
        progress_stop();
        (options->as_json ? print_ended_path_json : print_load_path)(analysis,
                                                                     &analysis->load_path);
        return complain(error, 1);
    }
    return analysis_continue(analysis, displacement, error) == 0 ? 0 : complain(error, 1);
}

static int command_solve(const options *options, analysis *analysis)
{
    char error[SCENE_ERROR];
    if (analysis_needs_structure(analysis, "pzs solve", error) < 0)
        return complain(error, OPTIONS_WRONG);
    double *displacement = calloc((size_t)analysis->design.mesh.free_dof, sizeof *displacement);
    progress_stage(analysis->is_nonlinear ? "equilibrium" : "solving");
    progress_solves(analysis->is_nonlinear ? &analysis->equilibrium.solver.info.linear_solves
                                           : NULL);
    const int failed =
        displacement ? solve_scene(options, analysis, displacement) : complain("out of memory", 1);
    /* Nonlinear load steps that end early still provide an equilibrium, which is printed. */
    const int has_shape = !failed || (analysis->is_nonlinear && !options->follows_path);
    const int status = displacement && has_shape ? solved(options, analysis, displacement) : 0;
    free(displacement);
    return failed ? failed : status;
}

/* ---- shape ------------------------------------------------------------ */

/* Compute the displacements and the shape error of a scene with all voltages zero. */
static int shape_before(shape_run *run, char *error)
{
    const design *design = &run->analysis->design;
    double *none = calloc((size_t)design->amplifiers, sizeof *none);
    const int failed = none
                           ? voltages_given(run->analysis, "no voltages", none, &run->before, error)
                           : scene_fault(design->limits.at, error, "out of memory");
    free(none);
    return failed;
}

/* Compute the voltages of all results of `pzs shape`, in the order of shape_run.results. */
static int shape_results(shape_run *run, const options *options, char *error)
{
    analysis *analysis = run->analysis;
    const design *design = &analysis->design;
    const common_limits own = {.source = LIMITS_SCENE}, none = {.source = LIMITS_NONE};
    const common_limits *limit = options->limits ? options->limit : &own;
    const int limits = options->limits ? options->limits : 1;
    const size_t most = 1 + 4 * (size_t)limits + (size_t)design->compares;
    run->results = calloc(most, sizeof *run->results);
    if (!run->results)
        return scene_fault(design->limits.at, error, "%zu sets of voltages do not fit into memory",
                           most);
    progress_stage("voltages");
    if (shape_before(run, error) < 0 ||
        voltages_optimum(analysis, none, &run->results[run->count++], error) < 0)
        return -1;
    for (int i = 0; i < limits; i++) {
        progress_count(i, limits);
        if (voltages_optimum(analysis, limit[i], &run->results[run->count++], error) < 0 ||
            (analysis->is_nonlinear &&
             voltages_linear(analysis, limit[i], &run->results[run->count++], error) < 0) ||
            voltages_clipped(analysis, limit[i], &run->results[run->count++], error) < 0 ||
            voltages_regularised(analysis, limit[i], &run->results[run->count++], error) < 0)
            return -1;
    }
    run->compared = run->count;
    for (int i = 0; i < design->compares; i++)
        if (voltages_given(analysis, design->compare[i].name, design->compare[i].value,
                           &run->results[run->count++], error) < 0)
            return -1;
    progress_stage("modes of the target");
    return modes_run(&run->modes, analysis, limit, limits, error);
}

static int write_shape(const report_job *job, const void *result)
{
    const shape_run *run = result;
    return report_shape(job, run->analysis, run->results, run->count, &run->modes);
}

/*
 * Estimate the discretisation error of the shape error that the optimal voltages leave. The voltage
 * limits are those of the first option --limit, or those of the scene file where no such option is
 * given. Returns an exit code.
 */
static int shape_error(shape_run *run, const options *options)
{
    const common_limits own = {.source = LIMITS_SCENE};
    mesh_values values = {.count = 0};
    char error[SCENE_ERROR];
    if (!options->estimates_error)
        return 0;
    mesh_values_add(&values, mesh_shape_name, run->results[1].error);
    if (mesh_values_add_influence(&values, run->analysis, error) < 0)
        return complain(error, 1);
    return estimate_error(options, run->analysis->design.scene, &values, mesh_measure_shape,
                          options->limits ? &options->limit[0] : &own, &run->analysis->mesh_error);
}

/*
 * Return the numbers that the plausibility warnings on the target use:
 *   - the size of the target;
 *   - the error and the largest voltage (relative to its limit) of the optimum within the first
 *     limits, those of --limit or of the scene;
 *   - the largest number of linearly dependent amplifiers in any result.
 */
static plausible_optimum optimum_of(const shape_run *run)
{
    const design *design = &run->analysis->design;
    const voltages *best = &run->results[1];
    const double limit = fmax(fabs(best->limit[0]), fabs(best->limit[1]));
    double largest = 0, entry = 0;
    int dependent = 0;
    for (int i = 0; i < run->count; i++)
        dependent = run->results[i].dependent > dependent ? run->results[i].dependent : dependent;
    for (int i = 0; i < design->targets; i++)
        entry = fmax(entry, fabs(design->wanted[i]));
    for (int k = 0; k < best->amplifiers; k++)
        largest = fmax(largest, fabs(best->voltage[k]));
    const double share = isfinite(limit) && limit > 0 ? largest / limit : (double)NAN;
    return (plausible_optimum){
        .target = entry > 0 ? run->before.rms / entry : 0,
        .error = best->error,
        .share = share,
        .dependent = dependent,
    };
}

static int command_shape(const options *options, analysis *analysis)
{
    shape_run run;
    char error[SCENE_ERROR];
    int status = 0;
    memset(&run, 0, sizeof run);
    run.analysis = analysis;
    analysis->is_nonlinear = analysis->design.kinematics != KINEMATICS_LINEAR;
    progress_stage("influence matrix");
    if (analysis_influence(analysis, error) == 0 && shape_results(&run, options, error) == 0) {
        const voltages *best = &run.results[1];
        plausible_voltages(&analysis->warnings, analysis->design.scene, best->voltage, best->name);
        plausible_result(&analysis->warnings, &analysis->design.mesh, best->displacement,
                         !analysis->is_nonlinear, best->name);
        const plausible_optimum optimum = optimum_of(&run);
        plausible_target(&analysis->warnings, analysis->design.scene, &optimum);
        status = shape_error(&run, options);
        progress_stop();
        if (status == 0)
            (options->as_json ? print_shape_json : print_shape)(&run);
        if (status == 0 && options->vtu)
            status = write_vtu(&(vtk_solution){.analysis = analysis,
                                               .displacement = best->displacement,
                                               .voltage = best->voltage,
                                               .shape = best->shape,
                                               .target = best->aligned_target},
                               options->vtu);
        if (status == 0)
            status = write_reports(options, write_shape, &run);
        if (status == 0)
            status = export_shape(options, &run);
    } else {
        status = complain(error, failed_code(analysis));
    }
    for (int i = 0; i < run.count; i++)
        voltages_free(&run.results[i]);
    free(run.results);
    voltages_free(&run.before);
    modes_free(&run.modes);
    return status;
}

/* ---- simulate --------------------------------------------------------- */

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

static int command_simulate(const options *options, analysis *analysis)
{
    const design *design = &analysis->design;
    simulation run;
    simulate_record record;
    history history = {.ticks = 0};
    const simulated result = {&run, &record};
    char error[SCENE_ERROR];
    int status = 0;
    memset(&run, 0, sizeof run);
    memset(&record, 0, sizeof record);
    if (!design->simulate.given)
        scene_fault(design->limits.at, error, "nothing to simulate: add `simulate: {ticks: 400}`");
    progress_stage("influence matrix");
    const int has_influence = design->simulate.given && analysis_influence(analysis, error) == 0;
    progress_stage("stability of the loop");
    if (has_influence) {
        certificate_make(&analysis->certificate, analysis);
        warn_of_prestress(analysis);
    }
    analysis->quasi_static = options->quasi_static;
    progress_stage("tables of the controller");
    if (!has_influence || simulate_open(&run, analysis, error) < 0) {
        status = complain(error, OPTIONS_WRONG);
    } else if (options->device && simulate_device(&run, options->device, error) < 0) {
        status = complain(error, 1);
    } else if (record_open(&record, &run) < 0 ||
               (export_is_wanted(options) && !history_open(&history, design))) {
        status = options_refuse("out of memory for", options->scene);
    } else if ((status = run_simulation(&run, options, &record, &history)) == 0) {
        check_phases(&analysis->warnings, &run);
        progress_stop();
        (options->as_json ? print_simulation_json : print_simulation)(&run, &record);
        status = write_reports(options, write_simulate, &result);
        if (status == 0)
            status = export_simulation(options, &run, &history);
        status |=
            run.count[LAW_CONTROLLER].beyond_limits > 0 ||
            run.count[LAW_CONTROLLER].beyond_rows > 0 || run.count[LAW_CONTROLLER].not_finite > 0 ||
            (run.board && run.board->twin &&
             simulate_ran(&run.count[LAW_CONTROLLER]) > run.count[LAW_CONTROLLER].agreeing_ticks);
    }
    record_close(&record);
    history_close(&history);
    simulate_close(&run);
    return status;
}

/* ---- modes ------------------------------------------------------------ */

/* Write a VTU file with one displacement field for each vibration mode. */
static int write_modes(const vibration *vibration, const design *design, const char *path)
{
    outfile output;
    if (outfile_begin(&output, path))
        return 1;
    return outfile_end(&output, vtk_write_modes(output.file, design, vibration));
}

static int write_vibration(const report_job *job, const void *result)
{
    return report_modes(job, result);
}

/* Estimate the discretisation error of the natural frequencies. Returns an exit code. */
static int modes_error(const options *options, const scene *scene, const vibration *vibration,
                       const modes_request *request, mesh_error *result)
{
    mesh_values values = {.count = 0};
    for (int i = 0; i < vibration->count; i++) {
        char name[SCENE_LABEL];
        mesh_mode_name(i, name);
        mesh_values_add(&values, name, vibration->frequency[i]);
    }
    return estimate_error(options, scene, &values, mesh_measure_modes, request, result);
}

/* Refuse circuits of electrodes for a measured influence matrix. Returns 0, or an exit code. */
static int check_circuit(const options *options, const scene *scene)
{
    if (options->circuit == CIRCUIT_SCENE || !scene->influence.given)
        return 0;
    return options_refuse("--electrodes needs a structure, but the scene has a measured influence "
                          "matrix:",
                          options->scene);
}

/*
 * Compute natural frequencies and mode shapes of a structure: about the reference state with linear
 * kinematics, otherwise about the equilibrium under the scene's loads and voltages. Returns 0, or
 * an exit code after the message on the error.
 *   modes out  modes, and the first natural frequency without and with the loads
 */
static int find_modes(const options *options, const scene *scene, loaded_modes *modes)
{
    enum { USUAL_NUMBER = 10 };
    char error[SCENE_ERROR];
    const modes_request request = {options->number ? options->number : USUAL_NUMBER,
                                   options->circuit};
    memset(modes, 0, sizeof *modes);
    if (check_circuit(options, scene))
        return OPTIONS_WRONG;
    progress_stage("natural frequencies");
    if (loaded_modes_open(modes, scene, &request, error) < 0)
        return complain(error, OPTIONS_WRONG);
    plausible_scene(&modes->warnings, scene);
    plausible_mesh(&modes->warnings, &modes->analysis.design.mesh);
    const modes_request computed = {modes->vibration.count, request.circuit};
    const int status =
        modes_error(options, scene, &modes->vibration, &computed, &modes->mesh_error);
    if (!modes->is_loaded) {
        modes->first = loaded_first(scene);
        plausible_prestress(&modes->warnings, scene, modes->first.unloaded, modes->first.loaded);
    }
    progress_stop();
    return status;
}

/*
 * Run the command `modes` on the structure alone. Unlike other commands, this one accepts supports
 * that permit rigid motions.
 */
static int run_modes(const options *options)
{
    scene scene;
    loaded_modes modes;
    int status = open_scene(options, &scene);
    if (status)
        return status;
    progress_start();
    status = find_modes(options, &scene, &modes);
    if (status == 0)
        (options->as_json ? print_vibration_json : print_vibration)(&modes);
    if (status == 0 && options->vtu)
        status = write_modes(&modes.vibration, &modes.analysis.design, options->vtu);
    if (status == 0)
        status = write_reports(options, write_vibration, &modes);
    if (status == 0)
        status = export_modes(options, &modes);
    if (status == 0 && options->is_strict && modes.warnings.count > 0)
        status = 1;
    loaded_modes_close(&modes);
    scene_free(&scene);
    return status;
}

/* ---- tables, check, list ---------------------------------------------- */

/*
 * Make the prefix of the names in a generated C file, a C identifier: from the prefix that the
 * options give, or else from the name of the scene.
 */
static void table_prefix(const options *options, const char *name, char prefix[SCENE_NAME])
{
    snprintf(prefix, SCENE_NAME, "%s", options->prefix ? options->prefix : name);
    for (char *letter = prefix; *letter; letter++)
        if (!((*letter >= 'a' && *letter <= 'z') || (*letter >= 'A' && *letter <= 'Z') ||
              *letter == '_' || (letter > prefix && *letter >= '0' && *letter <= '9')))
            *letter = '_';
}

/*
 * Path of the output file. Where the options name a folder, the file in that folder has the given
 * name and ending.
 */
static const char *output_path(const options *options, const char *name, const char *ending,
                               char path[OPTIONS_PATH])
{
    struct stat there;
    if (stat(options->output, &there) == 0 && S_ISDIR(there.st_mode))
        snprintf(path, OPTIONS_PATH, "%s/%s%s", options->output, name, ending);
    else
        snprintf(path, OPTIONS_PATH, "%s", options->output);
    return path;
}

/*
 * Test the stability of the control loop in the tables that `pzs tables` writes, and refuse a loop
 * that is not stable. Returns 0, or an exit code with error filled.
 */
static int certify_tables(analysis *analysis, char *error)
{
    if (analysis->design.problem.inputs == 0 || analysis->quasi_static)
        return 0;
    if (judge_rate(analysis, error) < 0)
        return LOOP_REFUSED;
    if (certify_loop(analysis, error) < 0 || certify_margins(analysis, false, error) < 0)
        return failed_code(analysis);
    warn_of_loop(analysis);
    return judge_storms(analysis, error) < 0 ? LOOP_REFUSED : 0;
}

/*
 * Refuse a target with free functions (shapes that may be added to it at no cost) for a device that
 * computes the influence matrix itself, because only the host takes these functions out of the
 * matrix. Returns 0, or -1 with error filled.
 */
static int refuse_free(const design *design, tables_image image, char *error)
{
    if (design->goal.frees == 0)
        return 0;
    return scene_fault(design->goal.free[0].at, error,
                       "target.free is taken out of the influence matrix of a control "
                       "image; the device makes that of a %s image itself: use --image control "
                       "or remove target.free",
                       tables_image_name[image]);
}

/*
 * Prepare the tables of a firmware with the nonlinear solver: compute the equilibrium of the scene,
 * and there the influence matrix and the stability of the control loop. Returns 0, or an exit code
 * with error filled.
 */
static int prepare_nonlinear(analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    if (design->kinematics == KINEMATICS_LINEAR) {
        scene_fault(design->at, error, "a nonlinear image needs kinematics: nonlinear (or auto)");
        return OPTIONS_WRONG;
    }
    double *displacement = calloc((size_t)analysis->design.mesh.free_dof, sizeof *displacement);
    analysis->is_nonlinear = true;
    const int failed = displacement ? analysis_solve(analysis, displacement, error)
                                    : scene_fault(design->at, error, "out of memory");
    free(displacement);
    if (failed || (design->goal.given && analysis_influence(analysis, error) < 0))
        return failed_code(analysis);
    return judge_loop(analysis, error) < 0 ? LOOP_REFUSED : certify_tables(analysis, error);
}

/*
 * Refuse the key `influence: loaded` for a device that computes the influence matrix itself,
 * because the influence matrix at the loaded equilibrium must be computed on the host. Returns 0,
 * or -1 with error filled.
 */
static int refuse_loaded(const design *design, char *error)
{
    if (design->simulate.influence_at != INFLUENCE_LOADED)
        return 0;
    return scene_fault(design->simulate.at, error,
                       "'influence: loaded' is made on the computer, and the device of this image "
                       "makes its influence matrix itself: use --image control or leave it out");
}

/*
 * Compute what `pzs tables` writes as constants for a firmware: for the controller alone, the
 * influence matrix that the simulation uses; for the nonlinear solver, the equilibrium and, with a
 * target, the least-squares problem of the voltages. Returns 0, or an exit code with error filled.
 */
static int prepare_tables(analysis *analysis, tables_image image, char *error)
{
    const design *design = &analysis->design;
    if (image != TABLES_CONTROL && (analysis_needs_structure(analysis, "this image", error) < 0 ||
                                    refuse_loaded(design, error) < 0))
        return failed_code(analysis);
    if ((image == TABLES_CONTROL || (image == TABLES_LINEAR && design->goal.given)) &&
        analysis_influence(analysis, error) < 0)
        return failed_code(analysis);
    if (image == TABLES_CONTROL && warn_of_target(analysis, error) < 0)
        return failed_code(analysis);
    if (judge_loop(analysis, error) < 0)
        return LOOP_REFUSED;
    warn_of_prestress(analysis);
    if (image == TABLES_CONTROL && simulate_tables(analysis, error) < 0)
        return failed_code(analysis);
    const int status = image == TABLES_NONLINEAR ? 0 : certify_tables(analysis, error);
    if (status)
        return status;
    if (image != TABLES_CONTROL && refuse_free(design, image, error) < 0)
        return OPTIONS_WRONG;
    return image == TABLES_NONLINEAR ? prepare_nonlinear(analysis, error) : 0;
}

/* Print the memory that vibration modes on the device take, where the tables hold them. */
static void print_modes_memory(const analysis *analysis)
{
    const tables_modes *modes = analysis->device_modes;
    const design *design = &analysis->design;
    if (!modes)
        return;
    const double packed = 4.0 * design->mesh.dof_per_node * (4 * design->mesh.dof_per_node + 1) / 2,
                 real = (double)sizeof(double),
                 work = (double)PZS_MODES_BYTES(design->mesh.free_dof, modes->vectors) -
                        2.0 * modes->vectors;
    printf("%d vibration modes, %d Lanczos vectors: workspace %.1f KB in float, %.1f in double; "
           "element mass matrices: %d, flash %.1f KB in float, %.1f in double\n",
           modes->vibration.count, modes->vectors, work / 2048, work / 1024,
           modes->mass.tables.types, packed * modes->mass.tables.types * real / 2048,
           packed * modes->mass.tables.types * real / 1024);
}

static void print_tables(const options *options, const analysis *analysis, const char *path)
{
    const design *design = &analysis->design;
    printf("%s: %s image of %s, %d amplifiers, ", path, tables_image_name[options->image],
           design->name, design->amplifiers);
    if (design->scene->influence.given)
        printf("%d outputs\n", design->targets);
    else
        printf("%d target nodes, %d free dof\n", design->targets, design->mesh.free_dof);
    if (options->image == TABLES_NONLINEAR)
        printf("condition %.1e after scaling: %s\n", analysis->model.info.condition,
               tables_allow_float(analysis) ? "float or double" : "refused in float");
    print_modes_memory(analysis);
    print_vibration_summary(&analysis->certificate, analysis->quasi_static);
    print_test_plans(analysis);
}

/* Write the tables to the output file. Returns 0, or an exit code. */
static int write_tables(const options *options, analysis *analysis)
{
    outfile output;
    tables_size size;
    work_report work;
    char error[SCENE_ERROR], prefix[SCENE_NAME], path[OPTIONS_PATH];
    work_report_make(&work, analysis);
    if (work_report_check(&work, &analysis->design, error) < 0)
        return complain(error, LOOP_REFUSED);
    table_prefix(options, analysis->design.name, prefix);
    int status = outfile_begin(&output, output_path(options, prefix, ".h", path));
    if (status == 0)
        status = outfile_end(&output,
                             tables_write(output.file, analysis, options->image, prefix, &size));
    progress_stop();
    if (status == 0)
        print_tables(options, analysis, path);
    return status;
}

static int command_tables(const options *options, analysis *analysis)
{
    tables_modes modes;
    char error[SCENE_ERROR];
    analysis->quasi_static = options->quasi_static;
    analysis->is_compact = options->is_compact;
    if (options->device_modes > 0 && options->image == TABLES_CONTROL)
        return options_refuse("tables --modes needs --image linear or nonlinear, not", "control");
    progress_stage("tables");
    int status = prepare_tables(analysis, options->image, error);
    if (status)
        return complain(error, status);
    memset(&modes, 0, sizeof modes);
    if (options->device_modes > 0 &&
        tables_modes_make(&modes, analysis, options->image == TABLES_NONLINEAR,
                          options->device_modes, error) < 0) {
        tables_modes_free(&modes);
        return complain(error, failed_code(analysis));
    }
    analysis->device_modes = options->device_modes > 0 ? &modes : NULL;
    status = write_tables(options, analysis);
    analysis->device_modes = NULL;
    tables_modes_free(&modes);
    return status;
}

/* ---- fmu ---------------------------------------------------------------- */

static void print_fmu(const char *path, const char *what, const char *scene,
                      const fmu_summary *summary)
{
    printf("%s: %s of %s, FMI 2.0 co-simulation, %d inputs, %d outputs, tick %.9g s\n", path, what,
           scene, summary->inputs, summary->outputs, summary->period);
    if (summary->left_out > 0)
        printf("events of the scene that are left out, as they are neither target, load nor "
               "temperature: %d\n",
               summary->left_out);
}

static int command_fmu(const options *options, analysis *analysis)
{
    outfile output;
    fmu_summary summary;
    char error[SCENE_ERROR], name[FMU_IDENTIFIER], path[OPTIONS_PATH];
    const fmu_kind kind = options->wants_plant ? FMU_PLANT : FMU_CONTROLLER;
    if (fmu_check(&analysis->design, error) < 0)
        return complain(error, OPTIONS_WRONG);
    analysis->quasi_static = options->quasi_static;
    progress_stage("tables");
    if (kind == FMU_PLANT && analysis_influence(analysis, error) < 0)
        return complain(error, failed_code(analysis));
    int status = kind == FMU_CONTROLLER ? prepare_tables(analysis, TABLES_CONTROL, error) : 0;
    if (status)
        return complain(error, status);
    fmu_identifier(&analysis->design, kind, name);
    status = outfile_begin(&output, output_path(options, name, ".fmu", path));
    if (status)
        return status;
    progress_stage(options->builds ? "compiling" : "sources");
    if (fmu_write(output.file, analysis, kind, options->builds, &summary, error) < 0) {
        outfile_drop(&output);
        return complain(error, OPTIONS_WRONG);
    }
    status = outfile_end(&output, 0);
    progress_stop();
    if (status == 0)
        print_fmu(path, kind == FMU_PLANT ? "plant" : "controller", analysis->design.name,
                  &summary);
    return status;
}

static int command_check(const options *options, analysis *analysis)
{
    work_report work;
    char error[SCENE_ERROR];
    progress_stage("influence matrix");
    if (analysis->design.goal.given && analysis_influence(analysis, error) < 0)
        return complain(error, OPTIONS_WRONG);
    if (analysis->design.goal.given && warn_of_target(analysis, error) < 0)
        return complain(error, OPTIONS_WRONG);
    progress_stage("stability of the loop");
    certificate_make(&analysis->certificate, analysis);
    warn_of_prestress(analysis);
    if (analysis->design.simulate.given && certificate_refuses(&analysis->certificate) &&
        simulate_tables(analysis, error) < 0)
        return complain(error, OPTIONS_WRONG);
    if (certify_loop(analysis, error) < 0 || certify_margins(analysis, true, error) < 0)
        return complain(error, OPTIONS_WRONG);
    warn_of_loop(analysis);
    warn_of_loads(analysis);
    progress_stop();
    work_report_make(&work, analysis);
    work_report_search(&work, analysis);
    (options->as_json ? print_check_json : print_check)(analysis, &work);
    if (judge_loop(analysis, error) < 0 || judge_storms(analysis, error) < 0 ||
        work_report_check(&work, &analysis->design, error) < 0)
        return complain(error, LOOP_REFUSED);
    return 0;
}

/* Print name and purpose of a scene in one line of at most 100 columns, cut off after a word. */
static void list_line(const char *name, const char *about)
{
    enum { COLUMNS = 100 };
    const int head = printf("%-20s ", name), length = (int)strlen(about);
    int end = length;
    if (head + length > COLUMNS)
        for (end = COLUMNS - head - 3; end > 0 && about[end] != ' ';)
            end--;
    while (end > 0 && end < length && strchr(" ,;:", about[end - 1]))
        end--;
    printf("%.*s%s\n", end, about, end < length ? "..." : "");
}

static int list_scene(void *context, const char *name)
{
    const options options = {.scene = name};
    scene scene;
    (void)context;
    if (open_scene(&options, &scene))
        return 1;
    list_line(scene.name, scene.about ? scene.about : "");
    scene_free(&scene);
    return 0;
}

static int command_list(void)
{
    const int failed = shipped_each(list_scene, NULL);
    if (failed < 0)
        return options_refuse("PZS_SCENES names the folder of scenes; cannot read",
                              shipped_folder());
    return failed ? OPTIONS_WRONG : 0;
}

/* Run the command `calibrate`, with a scene as the model if the command line names one. */
static int run_calibrate(const options *options)
{
    scene scene;
    if (!options->scene)
        return command_calibrate(options, NULL);
    int status = open_scene(options, &scene);
    if (status)
        return status;
    status = command_calibrate(options, &scene);
    scene_free(&scene);
    return status;
}

static int command_new(const options *options)
{
    const char *text = templates_text(options->word ? options->word : templates_name[0]);
    return fputs(text, stdout) < 0;
}

static int command_migrate(const options *options)
{
    char path[OPTIONS_PATH], error[SCENE_ERROR], *text;
    size_t bytes;
    const int status = find_scene(options, path);
    if (status)
        return status;
    if (scene_migrate(path, &text, &bytes, error) != 0)
        return complain(error, OPTIONS_WRONG);
    const size_t written = fwrite(text, 1, bytes, stdout);
    free(text);
    return written != bytes;
}

/* ---- commands --------------------------------------------------------- */

static int print_help(const options *options)
{
    if (options->word)
        help_command(stdout, command_find(options->word));
    else
        help_all(stdout);
    return 0;
}

static int run_command(command_id id, const options *options)
{
    switch (id) {
    case COMMAND_LIST: return command_list();
    case COMMAND_CHECK: return run_on_scene(options, command_check);
    case COMMAND_SOLVE: return run_on_scene(options, command_solve);
    case COMMAND_SHAPE: return run_on_scene(options, command_shape);
    case COMMAND_MODES: return run_modes(options);
    case COMMAND_TABLES: return run_on_scene(options, command_tables);
    case COMMAND_FMU: return run_on_scene(options, command_fmu);
    case COMMAND_SIMULATE: return run_on_scene(options, command_simulate);
    case COMMAND_CALIBRATE: return run_calibrate(options);
    case COMMAND_NEW: return command_new(options);
    case COMMAND_MIGRATE: return command_migrate(options);
    case COMMAND_KEYS: keys_print(stdout, options->word); return 0;
    case COMMAND_SCHEMA: schema_write(stdout); return 0;
    case COMMAND_COMPLETION: manual_completion(stdout); return 0;
    case COMMAND_MAN: manual_page(stdout); return 0;
    case COMMAND_HELP: return print_help(options);
    case COMMANDS: break;
    }
    return OPTIONS_WRONG;
}

static int asks_for(option_id option, int argc, char **argv, int from)
{
    for (int i = from; i < argc; i++)
        if (option_find(argv[i]) == option)
            return 1;
    return 0;
}

/*
 * Check that all output files that the options name can be begun. Returns 0, or 1 if one of them
 * cannot.
 */
static int check_outputs(const options *options)
{
    const char *const paths[] = {options->report, options->svg, options->vtu,       options->csv,
                                 options->output, options->npz, options->csv_folder};
    int failed = 0;
    for (size_t i = 0; i < sizeof paths / sizeof *paths && !failed; i++)
        if (paths[i] && !(options->uses_stdout && strcmp(paths[i], "-") == 0))
            failed = outfile_check(paths[i]);
    return failed;
}

static int run_line(int argc, char **argv)
{
    options options;
    if (argc < 2) {
        help_all(stderr);
        return OPTIONS_WRONG;
    }
    const option_id alone = option_find(argv[1]);
    const command_id id = alone == OPTION_MIGRATE ? COMMAND_MIGRATE : command_find(argv[1]);
    if (alone == OPTION_VERSION)
        return printf("pzs %s\n", PZS_VERSION_TEXT) < 0;
    if (alone == OPTION_HELP) {
        help_all(stdout);
        return 0;
    }
    if (id == COMMANDS)
        return options_unknown_command(argv[1]);
    if (asks_for(OPTION_HELP, argc, argv, 2)) {
        help_command(stdout, id);
        return 0;
    }
    const int wrong = options_read(&options, id, argc, argv);
    if (wrong)
        return wrong;
    if (options.uses_stdout && outfile_take_stdout() != 0)
        return 1;
    if (check_outputs(&options) != 0)
        return 1;
    return run_command(id, &options);
}

int main(int argc, char **argv)
{
    interrupt_install();
    const int status = run_line(argc, argv);
    progress_stop();
    if (fflush(stdout) == 0 && !ferror(stdout))
        return status;
    perror("pzs: standard output");
    return 1;
}
