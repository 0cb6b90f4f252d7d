/* pzs: host simulation and precomputation. One executable, a function per subcommand. */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "../model/estimator.h"
#include "help.h"
#include "interrupt.h"
#include "manual.h"
#include "../model/mass.h"
#include "options.h"
#include "outfile.h"
#include "print.h"
#include "print_simulate.h"
#include "print_vibration.h"
#include "progress.h"
#include "../report/report.h"
#include "../report/report_simulate.h"
#include "templates.h"
#include "../model/voltages.h"

/* Tell what went wrong. Returns code. */
static int complain(const char *error, int code)
{
    progress_stop();
    fprintf(stderr, "pzs: %s\n", error);
    return code;
}

/* ---- scenes ----------------------------------------------------------- */

/* No such shipped scene: say which one may have been meant. */
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

static int open_scene(const options *o, scene *s)
{
    char path[OPTIONS_PATH], error[SCENE_ERROR];
    struct stat there;
    shipped_path(o->scene, path);
    if (shipped_is_name(o->scene) && stat(path, &there) != 0)
        return no_scene(o->scene);
    return scene_read(s, path, o->set, o->sets, error) == 0 ? 0 : complain(error, OPTIONS_WRONG);
}

/* Exit code of an analysis that failed: its path ended early, or the scene is wrong. */
static int failed_code(const analysis *a)
{
    return analysis_ended_early(a) ? 1 : OPTIONS_WRONG;
}

/* Sensors that cannot see the shape are refused before anything runs. */
static int check_sensors(analysis *a, char *error)
{
    estimator e;
    if (!a->design.scene->estimate.given)
        return 0;
    if (analysis_influence(a, error) < 0 || estimator_open(&e, a, error) < 0)
        return -1;
    estimator_close(&e);
    return 0;
}

/* A command on a scene that is ready for it. Returns an exit code. */
typedef int command(const options *o, analysis *a);

/* Warnings stand at the end of the text, or in the JSON; under --strict they are failures. */
static int run_with_warnings(const options *o, analysis *a, command *run)
{
    plausible_scene(&a->warnings, a->design.scene);
    const int status = run(o, a);
    if (!o->as_json)
        plausible_print(stdout, &a->warnings);
    return status == 0 && o->is_strict && a->warnings.count > 0 ? 1 : status;
}

static int run_on_scene(const options *o, command *run)
{
    scene s;
    analysis a;
    char error[SCENE_ERROR];
    int status = open_scene(o, &s);
    if (status)
        return status;
    progress_start();
    progress_stage("assembling and factoring");
    if (analysis_prepare(&a, &s, error) == 0 && check_sensors(&a, error) == 0)
        status = run_with_warnings(o, &a, run);
    else
        status = complain(error, OPTIONS_WRONG);
    analysis_free(&a);
    scene_free(&s);
    return status;
}

/* ---- solve ------------------------------------------------------------ */

static int write_vtu(const analysis *a, const double *u, const char *path)
{
    const mesh *m = &a->design.mesh;
    double *vector = calloc(3 * (size_t)m->nodes, sizeof *vector);
    outfile f;
    const int status = vector ? outfile_begin(&f, path) : complain("out of memory", 1);
    if (status) {
        free(vector);
        return status;
    }
    report_displacement(m, u, vector);
    const report_field field = {"displacement", vector};
    const int failed = report_vtu(f.file, m, &field, 1);
    free(vector);
    return outfile_end(&f, failed);
}

static int solved(const options *o, analysis *a, const double *u)
{
    const pzs_structure *s = &a->design.structure;
    double *value = calloc((size_t)s->output.count + 1, sizeof *value);
    outfile f;
    int status = 0;
    if (!value)
        return complain("out of memory", 1);
    pzs_observe(s, u, value);
    plausible_result(&a->warnings, &a->design.mesh, u, !a->nonlinear, "the solution");
    progress_stop();
    (o->as_json ? print_solve_json : print_solve)(a, value);
    if (o->vtu)
        status = write_vtu(a, u, o->vtu);
    if (o->report && status == 0 && (status = outfile_begin(&f, o->report)) == 0)
        status = outfile_end(&f, report_solve(f.file, a, u, value));
    free(value);
    return status;
}

static int command_solve(const options *o, analysis *a)
{
    char error[SCENE_ERROR] = "out of memory";
    double *u = calloc((size_t)a->design.mesh.dof, sizeof *u);
    progress_stage(a->nonlinear ? "equilibrium" : "solving");
    progress_solves(a->nonlinear ? &a->path.run.info.linear_solves : NULL);
    const int failed = u && analysis_solve(a, u, error) == 0 ? 0 : complain(error, 1);
    /* A path that ends early leaves an equilibrium worth seeing. */
    const int status = u && (!failed || a->nonlinear) ? solved(o, a, u) : 0;
    free(u);
    return failed ? failed : status;
}

/* ---- shape ------------------------------------------------------------ */

/* The scene without any voltages. */
static int shape_before(shape_run *run, char *error)
{
    const design *d = &run->analysis->design;
    double *none = calloc((size_t)d->amplifiers, sizeof *none);
    const int failed = none
                           ? voltages_given(run->analysis, "no voltages", none, &run->before, error)
                           : scene_fault(d->scene, d->scene->limits.at, error, "out of memory");
    free(none);
    return failed;
}

/*
 * Optima without limits and within each limit, on a nonlinear structure the linear optimum beside,
 * least squares clipped, and regularised before with the best parameter, then the scene's volts to
 * compare.
 */
static int shape_results(shape_run *run, const options *o, char *error)
{
    analysis *a = run->analysis;
    const scene *s = a->design.scene;
    const common_limits own = {.source = LIMITS_SCENE}, none = {.source = LIMITS_NONE};
    const common_limits *limit = o->limits ? o->limit : &own;
    const int limits = o->limits ? o->limits : 1;
    const size_t most = 1 + 4 * (size_t)limits + (size_t)s->compares;
    run->volts = calloc(most, sizeof *run->volts);
    if (!run->volts)
        return scene_fault(s, s->limits.at, error, "%zu sets of voltages do not fit into memory",
                           most);
    progress_stage("voltages");
    if (shape_before(run, error) < 0 ||
        voltages_optimum(a, none, &run->volts[run->count++], error) < 0)
        return -1;
    for (int i = 0; i < limits; i++) {
        progress_count(i, limits);
        if (voltages_optimum(a, limit[i], &run->volts[run->count++], error) < 0 ||
            (a->nonlinear && voltages_linear(a, limit[i], &run->volts[run->count++], error) < 0) ||
            voltages_clipped(a, limit[i], &run->volts[run->count++], error) < 0 ||
            voltages_regularised(a, limit[i], &run->volts[run->count++], error) < 0)
            return -1;
    }
    run->compared = run->count;
    for (int i = 0; i < s->compares; i++)
        if (voltages_given(a, s->compare[i].name, s->compare[i].value, &run->volts[run->count++],
                           error) < 0)
            return -1;
    progress_stage("modes of the target");
    return modes_run(&run->modes, a, limit, limits, error);
}

static int command_shape(const options *o, analysis *a)
{
    shape_run run;
    char error[SCENE_ERROR];
    outfile f;
    int status = 0;
    memset(&run, 0, sizeof run);
    run.analysis = a;
    a->nonlinear = a->design.scene->kinematics != KINEMATICS_LINEAR;
    progress_stage("influence matrix");
    if (analysis_influence(a, error) == 0 && shape_results(&run, o, error) == 0) {
        const voltages *best = &run.volts[1];
        plausible_voltages(&a->warnings, a->design.scene, best->volt, best->name);
        plausible_result(&a->warnings, &a->design.mesh, best->u, !a->nonlinear, best->name);
        progress_stop();
        (o->as_json ? print_shape_json : print_shape)(&run);
        status = o->vtu ? write_vtu(a, run.volts[1].u, o->vtu) : 0;
        if (o->report && status == 0 && (status = outfile_begin(&f, o->report)) == 0)
            status = outfile_end(&f, report_shape(f.file, a, run.volts, run.count, &run.modes));
    } else {
        status = complain(error, failed_code(a));
    }
    for (int i = 0; i < run.count; i++)
        voltages_free(&run.volts[i]);
    free(run.volts);
    voltages_free(&run.before);
    modes_free(&run.modes);
    return status;
}

/* ---- simulate --------------------------------------------------------- */

/* All ticks, then what was best; the lines of a CSV file where one is asked for. Returns 0, or an
 * exit code. */
static int run_simulation(simulation *run, const options *o, simulate_record *record)
{
    char error[SCENE_ERROR];
    outfile csv = {NULL, NULL, "", -1};
    const int status = o->csv ? outfile_begin(&csv, o->csv) : 0;
    if (status)
        return status;
    if (print_run(run, record, csv.file, error) == 0)
        return o->csv ? outfile_end(&csv, 0) : 0;
    if (o->csv)
        outfile_drop(&csv);
    return complain(error, 1);
}

/* The plant's displacements under the controller, at the end of each phase. */
static void check_phases(plausible *warnings, const simulation *run)
{
    const analysis *a = &run->plant.analysis;
    for (int k = 0; k < run->phases; k++) {
        const double *u = run->phase[k].course[LAW_CONTROLLER].u;
        if (u)
            plausible_result(warnings, &a->design.mesh, u, !a->nonlinear, "the plant");
    }
}

static int command_simulate(const options *o, analysis *a)
{
    const scene *s = a->design.scene;
    simulation run;
    simulate_record record;
    outfile f;
    char error[SCENE_ERROR];
    int status = 0;
    memset(&run, 0, sizeof run);
    memset(&record, 0, sizeof record);
    if (!s->simulate.given)
        scene_fault(s, s->limits.at, error, "nothing to simulate: add `simulate: {ticks: 400}`");
    progress_stage("influence matrix");
    const int has_influence = s->simulate.given && analysis_influence(a, error) == 0;
    progress_stage("stability of the loop");
    if (has_influence)
        certificate_make(&a->certificate, a);
    a->quasi_static = 1;
    progress_stage("tables of the controller");
    if (!has_influence || simulate_open(&run, a, error) < 0) {
        status = complain(error, OPTIONS_WRONG);
    } else if (o->device && simulate_device(&run, o->device, error) < 0) {
        status = complain(error, 1);
    } else if (record_open(&record, &run) < 0) {
        status = options_refuse("out of memory for", o->scene);
    } else if ((status = run_simulation(&run, o, &record)) == 0) {
        check_phases(&a->warnings, &run);
        progress_stop();
        (o->as_json ? print_simulation_json : print_simulation)(&run);
        if (o->report && (status = outfile_begin(&f, o->report)) == 0)
            status = outfile_end(&f, report_simulate(f.file, &run, &record));
        status |= run.count[LAW_CONTROLLER].beyond > 0 ||
                  run.count[LAW_CONTROLLER].not_finite > 0 ||
                  (run.board && run.board->twin &&
                   simulate_ran(&run.count[LAW_CONTROLLER]) > run.count[LAW_CONTROLLER].same);
    }
    record_close(&record);
    simulate_close(&run);
    return status;
}

/* ---- modes ------------------------------------------------------------ */

/* A field of the VTU file for each mode. */
static int write_modes(const vibration *v, const mesh *m, const char *path)
{
    const size_t length = 3 * (size_t)m->nodes, count = (size_t)v->count;
    double *vector = calloc(length * count, sizeof *vector);
    report_field *field = calloc(count, sizeof *field);
    char(*name)[32] = calloc(count, sizeof *name);
    outfile f;
    int status = vector && field && name ? outfile_begin(&f, path) : complain("out of memory", 1);
    if (status == 0) {
        for (size_t i = 0; i < count; i++) {
            snprintf(name[i], sizeof name[i], "mode_%zu", i + 1);
            report_displacement(m, v->shape + i * (size_t)m->dof, vector + i * length);
            field[i] = (report_field){name[i], vector + i * length};
        }
        status = outfile_end(&f, report_vtu(f.file, m, field, v->count));
    }
    free(vector);
    free(field);
    free(name);
    return status;
}

/* Frequencies and mode shapes of a structure that is ready for them. Returns an exit code. */
static int modes_of(const options *o, const design *d)
{
    enum { USUAL_NUMBER = 10 };
    vibration v;
    char error[SCENE_ERROR];
    const int number = o->number ? o->number : USUAL_NUMBER;
    progress_stage("natural frequencies");
    if (vibration_solve(&v, d, number, MASS_LUMPED, error) < 0)
        return complain(error, OPTIONS_WRONG);
    progress_stop();
    (o->as_json ? print_vibration_json : print_vibration)(d, &v);
    const int status = o->vtu ? write_modes(&v, &d->mesh, o->vtu) : 0;
    vibration_free(&v);
    return status;
}

/* The structure alone, which supports may leave loose. */
static int run_modes(const options *o)
{
    scene s;
    design d;
    char error[SCENE_ERROR];
    int status = open_scene(o, &s);
    if (status)
        return status;
    progress_start();
    progress_stage("mesh and elements");
    if (design_build(&d, &s, error) < 0)
        status = complain(error, OPTIONS_WRONG);
    else
        status = modes_of(o, &d);
    design_free(&d);
    scene_free(&s);
    return status;
}

/* ---- tables, check, list ---------------------------------------------- */

/* A C identifier from the prefix given or the scene's name. */
static void table_prefix(const options *o, const scene *s, char prefix[SCENE_NAME])
{
    snprintf(prefix, SCENE_NAME, "%s", o->prefix ? o->prefix : s->name);
    for (char *c = prefix; *c; c++)
        if (!((*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || *c == '_' ||
              (c > prefix && *c >= '0' && *c <= '9')))
            *c = '_';
}

/* The output file; in a folder it takes the prefix as its name. */
static const char *table_path(const options *o, const char *prefix, char path[OPTIONS_PATH])
{
    struct stat there;
    if (stat(o->output, &there) == 0 && S_ISDIR(there.st_mode))
        snprintf(path, OPTIONS_PATH, "%s/%s.h", o->output, prefix);
    else
        snprintf(path, OPTIONS_PATH, "%s", o->output);
    return path;
}

/* A control loop that vibration makes unstable is not handed to a firmware unasked. Returns 0, or
 * -1 with error filled. */
static int judge_loop(analysis *a, char *error)
{
    const certificate *c = &a->certificate;
    const scene *s = a->design.scene;
    if (a->design.problem.inputs == 0)
        return 0;
    certificate_make(&a->certificate, a);
    if (a->quasi_static || !certificate_refuses(c))
        return 0;
    return scene_fault(
        s, s->simulate.at, error,
        "unstable at %g ticks a second: the control step has no vibration model, first "
        "mode %.4g Hz, vibration grows %.4g times a tick; stable up to %.3g a second; --quasi-static writes "
        "the tables all the same",
        c->rate, certificate_first(c), c->radius, c->rate_to);
}

/*
 * Everything the tables hold. A nonlinear image: the scene's equilibrium, and a voltage problem
 * where it has a target. A control image: the influence that the scene's simulation has.
 */
static int prepare_tables(analysis *a, tables_image image, char *error)
{
    const scene *s = a->design.scene;
    if ((image == TABLES_CONTROL || (image == TABLES_LINEAR && s->target.given)) &&
        analysis_influence(a, error) < 0)
        return -1;
    if (judge_loop(a, error) < 0)
        return -1;
    if (image == TABLES_CONTROL && simulate_tables(a, error) < 0)
        return -1;
    if (image != TABLES_CONTROL && s->target.frees > 0)
        return scene_fault(s, s->target.free[0].at, error,
                           "target.free is taken out of the influence matrix of a control "
                           "image; the device makes that of a %s image itself: use --level control "
                           "or remove target.free",
                           tables_image_name[image]);
    if (image != TABLES_NONLINEAR)
        return 0;
    if (s->kinematics == KINEMATICS_LINEAR)
        return scene_fault(s, s->at_surface, error,
                           "a nonlinear image needs kinematics: nonlinear (or auto)");
    double *u = calloc((size_t)a->design.mesh.dof, sizeof *u);
    a->nonlinear = 1;
    const int failed =
        u ? analysis_solve(a, u, error) : scene_fault(s, s->at_surface, error, "out of memory");
    free(u);
    if (failed || (s->target.given && analysis_influence(a, error) < 0))
        return -1;
    return judge_loop(a, error);
}

static void print_tables(const options *o, const analysis *a, const char *path)
{
    const design *d = &a->design;
    printf("%s: %s image of %s, %d amplifiers, %d target nodes, %d free unknowns\n", path,
           tables_image_name[o->image], d->scene->name, d->amplifiers, d->targets, d->mesh.dof);
    if (o->image == TABLES_NONLINEAR)
        printf("condition %.1e after scaling: %s\n", a->model.info.condition,
               tables_fit_float(a) ? "float or double" : "refused in float");
}

static int command_tables(const options *o, analysis *a)
{
    outfile f;
    tables_size size;
    char error[SCENE_ERROR], prefix[SCENE_NAME], path[OPTIONS_PATH];
    a->quasi_static = o->quasi_static;
    progress_stage("tables");
    if (prepare_tables(a, o->image, error) < 0)
        return complain(error, failed_code(a));
    table_prefix(o, a->design.scene, prefix);
    int status = outfile_begin(&f, table_path(o, prefix, path));
    if (status == 0)
        status = outfile_end(&f, tables_write(f.file, a, o->image, prefix, &size));
    progress_stop();
    if (status == 0)
        print_tables(o, a, path);
    return status;
}

static int command_check(const options *o, analysis *a)
{
    char error[SCENE_ERROR];
    progress_stage("influence matrix");
    if (a->design.scene->target.given && analysis_influence(a, error) < 0)
        return complain(error, OPTIONS_WRONG);
    progress_stage("stability of the loop");
    certificate_make(&a->certificate, a);
    progress_stop();
    (o->as_json ? print_check_json : print_check)(a);
    return 0;
}

/* Name and purpose in at most 100 columns, cut after a word. */
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
    const options o = {.scene = name};
    scene s;
    (void)context;
    if (open_scene(&o, &s))
        return 1;
    list_line(s.name, s.about ? s.about : "");
    scene_free(&s);
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

static int command_new(const options *o)
{
    const char *text = templates_text(o->word ? o->word : templates_name[0]);
    if (!text)
        return options_refuse(
            "scenes from measured influence matrices come with a later release; write plate, mirror or panel, not",
            o->word);
    return fputs(text, stdout) < 0;
}

/* ---- commands --------------------------------------------------------- */

static int print_help(const options *o)
{
    if (o->word)
        help_command(stdout, command_find(o->word));
    else
        help_all(stdout);
    return 0;
}

static int run_command(command_id id, const options *o)
{
    switch (id) {
    case COMMAND_LIST: return command_list();
    case COMMAND_CHECK: return run_on_scene(o, command_check);
    case COMMAND_SOLVE: return run_on_scene(o, command_solve);
    case COMMAND_SHAPE: return run_on_scene(o, command_shape);
    case COMMAND_MODES: return run_modes(o);
    case COMMAND_TABLES: return run_on_scene(o, command_tables);
    case COMMAND_SIMULATE: return run_on_scene(o, command_simulate);
    case COMMAND_NEW: return command_new(o);
    case COMMAND_COMPLETION: manual_completion(stdout); return 0;
    case COMMAND_MAN: manual_page(stdout); return 0;
    case COMMAND_HELP: return print_help(o);
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

static int run_line(int argc, char **argv)
{
    options o;
    if (argc < 2) {
        help_all(stderr);
        return OPTIONS_WRONG;
    }
    const option_id alone = option_find(argv[1]);
    const command_id id = command_find(argv[1]);
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
    const int wrong = options_read(&o, id, argc, argv);
    return wrong ? wrong : run_command(id, &o);
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
