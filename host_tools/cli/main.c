/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The program pzs: reads the command line and runs a command. The longer commands have files of
 * their own, command_NAME.c.
 */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "../fmu/fmu.h"
#include "../model/certificate_make.h"
#include "../scene/scene_migrate.h"
#include "../simulate/certify.h"
#include "../simulate/certify_matrix.h"
#include "../system/interrupt.h"
#include "../system/progress.h"
#include "../tables/tables_modes.h"
#include "command_calibrate.h"
#include "command_modes.h"
#include "command_parts.h"
#include "command_shape.h"
#include "command_simulate.h"
#include "command_solve.h"
#include "help.h"
#include "keys.h"
#include "loop_safety.h"
#include "manual.h"
#include "matrix_safety.h"
#include "outfile.h"
#include "print_check.h"
#include "print_vibration.h"
#include "schema.h"
#include "templates.h"

/* ---- scenes ----------------------------------------------------------- */

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
 * that is not stable, or that errors of a measured influence matrix make unstable. Returns 0, or an
 * exit code with error filled.
 */
static int certify_tables(analysis *analysis, char *error)
{
    if (analysis->design.problem.inputs == 0)
        return 0;
    if (!analysis->quasi_static) {
        if (judge_rate(analysis, error) < 0)
            return LOOP_REFUSED;
        if (certify_loop(analysis, error) < 0 || certify_margins(analysis, false, error) < 0)
            return failed_code(analysis);
        warn_of_loop(analysis);
        if (judge_storms(analysis, error) < 0)
            return LOOP_REFUSED;
    }
    if (certify_matrix(analysis, error) < 0)
        return failed_code(analysis);
    warn_of_matrix(analysis);
    return judge_matrix(analysis, error) < 0 ? LOOP_REFUSED : 0;
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

/* Print the memory that electrodes take that are open while the structure of a device vibrates. */
static void print_open_memory(const open_tables *open, const design *design)
{
    if (open->count == 0)
        return;
    size_t single, twice;
    {
        typedef float pzs_real;
        single = PZS_MODES_OPEN_BYTES(design->mesh.free_dof, open->count);
    }
    twice = PZS_MODES_OPEN_BYTES(design->mesh.free_dof, open->count);
    printf("%u open electrodes: workspace %.1f KB more in float, %.1f in double\n",
           (unsigned)open->count, (double)single / 1024, (double)twice / 1024);
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
    print_open_memory(&modes->open, design);
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

/*
 * Refuse options about vibration modes on the device that do not fit. Returns 0, or an exit code.
 */
static int check_device_modes(const options *options)
{
    if (options->device_modes > 0 && options->image == TABLES_CONTROL)
        return options_refuse("tables --modes needs --image linear or nonlinear, not", "control");
    if (options->device_modes == 0 && options->circuit != CIRCUIT_SCENE)
        return options_refuse("tables --electrodes needs", "--modes");
    return 0;
}

static int command_tables(const options *options, analysis *analysis)
{
    tables_modes modes;
    char error[SCENE_ERROR];
    analysis->quasi_static = options->quasi_static;
    analysis->is_compact = options->is_compact;
    if (check_device_modes(options))
        return OPTIONS_WRONG;
    progress_stage("tables");
    int status = prepare_tables(analysis, options->image, error);
    if (status)
        return complain(error, status);
    memset(&modes, 0, sizeof modes);
    if (options->device_modes > 0 &&
        tables_modes_make(&modes, analysis, options->circuit, options->image == TABLES_NONLINEAR,
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
    if (certify_loop(analysis, error) < 0 || certify_margins(analysis, true, error) < 0 ||
        certify_matrix(analysis, error) < 0)
        return complain(error, OPTIONS_WRONG);
    warn_of_matrix(analysis);
    warn_of_loop(analysis);
    warn_of_loads(analysis);
    progress_stop();
    work_report_make(&work, analysis);
    work_report_search(&work, analysis);
    (options->as_json ? print_check_json : print_check)(analysis, &work);
    if (judge_loop(analysis, error) < 0 || judge_storms(analysis, error) < 0 ||
        judge_matrix(analysis, error) < 0 || work_report_check(&work, &analysis->design, error) < 0)
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
    case COMMAND_MODES: return command_modes(options);
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
