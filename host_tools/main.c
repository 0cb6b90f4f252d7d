/* pzs: host simulation and precomputation. One executable, a function per subcommand. */
#define _POSIX_C_SOURCE 200809L
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "estimator.h"
#include "print.h"
#include "print_simulate.h"
#include "report.h"
#include "report_simulate.h"
#include "tables.h"
#include "voltages.h"

enum { EXIT_USAGE = 2, MOST_SETS = 64, MOST_LIMITS = 16, PATH_ROOM = 4096 };

static const char *const help =
    "pzs - shape control of piezoelectric shells: host simulation and precomputation\n"
    "\n"
    "  pzs list                         the scenes shipped, a line each\n"
    "  pzs check  SCENE                 read a scene and say what is wrong with it\n"
    "  pzs solve  SCENE                 displacement under the scene's loads and applied volts\n"
    "  pzs shape  SCENE                 volts that bring the shape to the scene's target, and its error\n"
    "  pzs tables SCENE -o FILE.h       C tables for a firmware\n"
    "  pzs simulate SCENE               the controller in closed loop with a structure it does not quite know\n"
    "\n"
    "SCENE is a file, or the name of a shipped scene. Options:\n"
    "  --set KEY=VALUE    change the scene: --set mesh.theta1.elements=16 --set element=corrected\n"
    "  --limit V          shape: voltage limit instead of the scene's; repeat it for a comparison\n"
    "  --json             numbers for machines on standard output\n"
    "  --report FILE.html pictures and tables in one page\n"
    "  --vtu FILE.vtu     deformed shape for ParaView\n"
    "  --csv FILE.csv     simulate: a line a tick: tick, time (s), error of the shape over the scene's target, active\n"
    "                     (volts at a limit), passes of the optimiser, status (pzs_status of the tick), lost (1: the\n"
    "                     controller did not run), missed (by the estimate of the shape), then the volts that each\n"
    "                     amplifier gives\n"
    "  --device BOARD     simulate: the firmware of netduinoplus2, mps2-an386 or mps2-an500, under QEMU, is the\n"
    "                     controller; every bit compared with the same C here. host-32, host-64: that C alone\n"
    "  --level IMAGE      tables: control (influence matrix), linear (element matrices) or nonlinear (and the path\n"
    "                     at large rotation; the scene needs kinematics: nonlinear); default control\n"
    "  --prefix NAME      tables: start of every name; default the scene's name\n"
    "  -o FILE            tables: output file, or a folder for it\n"
    "\n"
    "Examples:\n"
    "  pzs solve scordelis-lo --set mesh.theta1.elements=8 --set mesh.theta2.elements=8\n"
    "  pzs shape plate-50-patches --limit 100 --limit 200 --report plate.html\n"
    "  pzs tables plate-50-patches --level linear --prefix plate -o plate.h\n"
    "  pzs simulate plate-closed-loop --report loop.html --csv loop.csv\n"
    "  pzs simulate plate-few-sensors --device mps2-an386\n"
    "  pzs simulate plate-closed-loop --set simulate.plant.d=0.5 --set simulate.ticks=300 --device netduinoplus2\n"
    "\n"
    "Exit code: 0 done, 1 the computation failed, 2 the scene or the command line is wrong.\n";

typedef struct options {
    const char *scene;
    const char *set[MOST_SETS];
    double limit[MOST_LIMITS];
    int sets, limits, as_json;
    const char *report, *vtu, *csv, *output, *prefix;
    const device_board *device;
    tables_image image;
} options;

/* ---- command line ----------------------------------------------------- */

static int usage_error(const char *what, const char *value)
{
    fprintf(stderr, "pzs: %s '%s'; see pzs --help\n", what, value);
    return EXIT_USAGE;
}

/* Tell what went wrong. Returns code. */
static int complain(const char *error, int code)
{
    fprintf(stderr, "pzs: %s\n", error);
    return code;
}

/* Take one option with a value. Returns 0, or an exit code. */
static int take_value(options *o, const char *name, const char *value)
{
    char *end;
    if (strcmp(name, "--set") == 0) {
        if (o->sets == MOST_SETS)
            return usage_error("too many changes at", value);
        o->set[o->sets++] = value;
    } else if (strcmp(name, "--limit") == 0) {
        const double limit = strtod(value, &end);
        if (o->limits == MOST_LIMITS || end == value || *end || !(limit > 0))
            return usage_error("--limit wants a positive voltage, not", value);
        o->limit[o->limits++] = limit;
    } else if (strcmp(name, "--level") == 0) {
        for (o->image = 0; o->image < TABLES_IMAGES && strcmp(value, tables_image_name[o->image]) != 0;)
            o->image++;
        if (o->image == TABLES_IMAGES)
            return usage_error("--level is control, linear or nonlinear, not", value);
    } else if (strcmp(name, "--report") == 0) {
        o->report = value;
    } else if (strcmp(name, "--vtu") == 0) {
        o->vtu = value;
    } else if (strcmp(name, "--csv") == 0) {
        o->csv = value;
    } else if (strcmp(name, "--device") == 0) {
        o->device = device_find(value);
        if (!o->device)
            return usage_error("--device is netduinoplus2, mps2-an386, mps2-an500, host-32 or host-64, not", value);
    } else if (strcmp(name, "--prefix") == 0) {
        o->prefix = value;
    } else if (strcmp(name, "-o") == 0) {
        o->output = value;
    } else {
        return usage_error("unknown option", name);
    }
    return 0;
}

static int parse(options *o, int argc, char **argv)
{
    memset(o, 0, sizeof *o);
    for (int i = 2; i < argc; i++) {
        if (strcmp(argv[i], "--json") == 0) {
            o->as_json = 1;
        } else if (argv[i][0] != '-') {
            if (o->scene)
                return usage_error("one scene at a time; unexpected", argv[i]);
            o->scene = argv[i];
        } else {
            if (i + 1 == argc)
                return usage_error("unknown option, or a value is missing after", argv[i]);
            const int wrong = take_value(o, argv[i], argv[i + 1]);
            if (wrong)
                return wrong;
            i++;
        }
    }
    if (o->prefix && strlen(o->prefix) == 3 && tolower((unsigned char)o->prefix[0]) == 'p'
        && tolower((unsigned char)o->prefix[1]) == 'z' && tolower((unsigned char)o->prefix[2]) == 's')
        return usage_error("the library's own names start with --prefix", o->prefix);
    return o->scene ? 0 : usage_error("name a scene for", argv[1]);
}

/* ---- scenes ----------------------------------------------------------- */

/* Folder of the shipped scenes: beside the source of this build, or PZS_SCENES of the environment. */
static const char *scene_folder(void)
{
    const char *folder = getenv("PZS_SCENES");
    return folder ? folder : SCENE_FOLDER;
}

static void find_scene(const char *name, char path[PATH_ROOM])
{
    const size_t length = strlen(name);
    const int is_file = strchr(name, '/') || (length > 5 && strcmp(name + length - 5, ".yaml") == 0);
    if (is_file)
        snprintf(path, PATH_ROOM, "%s", name);
    else
        snprintf(path, PATH_ROOM, "%s/%s.yaml", scene_folder(), name);
}

static int stat_folder(const char *path, struct stat *there)
{
    char folder[PATH_ROOM];
    const char *const slash = strrchr(path, '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - path + 1) : 1, slash ? path : ".");
    return stat(folder, there);
}

/* Do two paths lead to one file, whichever way they are written? */
static int same_file(const char *a, const char *b)
{
    struct stat s, t;
    const char *const end_a = strrchr(a, '/'), *const end_b = strrchr(b, '/');
    if (strcmp(a, b) == 0)
        return 1;
    if (stat(a, &s) == 0 && stat(b, &t) == 0)
        return S_ISREG(s.st_mode) && s.st_dev == t.st_dev && s.st_ino == t.st_ino;
    return strcmp(end_a ? end_a + 1 : a, end_b ? end_b + 1 : b) == 0 && stat_folder(a, &s) == 0 && stat_folder(b, &t) == 0
        && s.st_dev == t.st_dev && s.st_ino == t.st_ino;
}

/* No file is written over another, nor over the scene. */
static int check_files(const options *o)
{
    char scene_path[PATH_ROOM];
    const char *const file[5] = {scene_path, o->report, o->vtu, o->csv, o->output};
    find_scene(o->scene, scene_path);
    for (int i = 1; i < 5; i++)
        for (int j = 0; j < i; j++)
            if (file[i] && file[j] && same_file(file[i], file[j]))
                return usage_error("two files under one name:", file[i]);
    return 0;
}

/* An option that a command does not know is refused: who gives it waits for what it makes. */
static int check_options(const options *o, const char *command)
{
    const struct {
        const char *name, *commands;
        int given;
    } option[] = {{"--limit", "shape", o->limits > 0}, {"--report", "solve, shape, simulate", o->report != NULL},
                  {"--vtu", "solve, shape", o->vtu != NULL}, {"--csv", "simulate", o->csv != NULL},
                  {"--device", "simulate", o->device != NULL}, {"--prefix", "tables", o->prefix != NULL},
                  {"--level", "tables", o->image != TABLES_CONTROL}, {"-o", "tables", o->output != NULL}};
    for (size_t i = 0; i < sizeof option / sizeof *option; i++)
        if (option[i].given && !strstr(option[i].commands, command)) {
            fprintf(stderr, "pzs: %s belongs to %s, not to %s; see pzs --help\n", option[i].name, option[i].commands, command);
            return EXIT_USAGE;
        }
    if (strcmp(command, "tables") == 0 && !o->output)
        return usage_error("say where to write with -o FILE for", command);
    return 0;
}

static int open_scene(const options *o, scene *s)
{
    char path[PATH_ROOM], error[SCENE_ERROR];
    find_scene(o->scene, path);
    return scene_read(s, path, o->set, o->sets, error) == 0 ? 0 : complain(error, EXIT_USAGE);
}

/* Exit code of an analysis that failed: its path ended early, or the scene is wrong. */
static int failed_code(const analysis *a)
{
    return analysis_ended_early(a) ? 1 : EXIT_USAGE;
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

static int run_on_scene(const options *o, command *run)
{
    scene s;
    analysis a;
    char error[SCENE_ERROR];
    int status = open_scene(o, &s);
    if (status)
        return status;
    if (analysis_prepare(&a, &s, error) == 0 && check_sensors(&a, error) == 0)
        status = run(o, &a);
    else
        status = complain(error, EXIT_USAGE);
    analysis_free(&a);
    scene_free(&s);
    return status;
}

/* ---- files ------------------------------------------------------------ */

/* Files are written under a temporary name and take their own only when complete. */
typedef struct output_file {
    FILE *file;
    char temporary[PATH_ROOM]; /* empty where the path is a device or a pipe, which is written to directly */
    const char *path;
} output_file;

static int file_failed(const char *path)
{
    fprintf(stderr, "pzs: cannot write %s: %s\n", path, strerror(errno));
    return 1;
}

static int output_begin(output_file *f, const char *path)
{
    struct stat there;
    const int direct = stat(path, &there) == 0 && !S_ISREG(there.st_mode);
    f->path = path;
    f->temporary[0] = '\0';
    if (!direct && snprintf(f->temporary, sizeof f->temporary, "%s.part", path) >= PATH_ROOM)
        return usage_error("path too long", path);
    f->file = fopen(direct ? path : f->temporary, "w");
    return f->file ? 0 : file_failed(path);
}

static int output_end(output_file *f, int failed)
{
    failed |= ferror(f->file);
    failed |= fclose(f->file) != 0;
    if (!failed && (!f->temporary[0] || rename(f->temporary, f->path) == 0))
        return 0;
    const int status = file_failed(f->path);
    if (f->temporary[0])
        remove(f->temporary);
    return status;
}

/* A file whose contents never came together. */
static void output_drop(output_file *f)
{
    fclose(f->file);
    if (f->temporary[0])
        remove(f->temporary);
}

/* ---- solve ------------------------------------------------------------ */

static int write_vtu(const analysis *a, const double *u, const char *path)
{
    const mesh *m = &a->design.mesh;
    double *vector = calloc(3 * (size_t)m->nodes, sizeof *vector);
    output_file f;
    const int status = vector ? output_begin(&f, path) : complain("out of memory", 1);
    if (status) {
        free(vector);
        return status;
    }
    report_displacement(m, u, vector);
    const report_field field = {"displacement", vector};
    const int failed = report_vtu(f.file, m, &field, 1);
    free(vector);
    return output_end(&f, failed);
}

static int solved(const options *o, analysis *a, const double *u)
{
    const pzs_structure *s = &a->design.structure;
    double *value = calloc((size_t)s->output.count + 1, sizeof *value);
    output_file f;
    int status = 0;
    if (!value)
        return complain("out of memory", 1);
    pzs_observe(s, u, value);
    (o->as_json ? print_solve_json : print_solve)(a, value);
    if (o->vtu)
        status = write_vtu(a, u, o->vtu);
    if (o->report && status == 0 && (status = output_begin(&f, o->report)) == 0)
        status = output_end(&f, report_solve(f.file, a, u, value));
    free(value);
    return status;
}

static int command_solve(const options *o, analysis *a)
{
    char error[SCENE_ERROR] = "out of memory";
    double *u = calloc((size_t)a->design.mesh.dof, sizeof *u);
    const int failed = u && analysis_solve(a, u, error) == 0 ? 0 : complain(error, 1);
    /* A path that ends early leaves an equilibrium worth seeing. */
    const int status = u && (!failed || a->nonlinear) ? solved(o, a, u) : 0;
    free(u);
    return failed ? failed : status;
}

/* ---- shape ------------------------------------------------------------ */

/* The scene without any volts. */
static int shape_before(shape_run *run, char *error)
{
    const design *d = &run->analysis->design;
    double *none = calloc((size_t)d->amplifiers, sizeof *none);
    const int failed = none ? voltages_given(run->analysis, "no volts", none, &run->before, error)
                            : scene_fault(d->scene, d->scene->limits.at, error, "out of memory");
    free(none);
    return failed;
}

/*
 * Optima without limits and within each limit, clipping and on a nonlinear structure the linear optimum beside,
 * then the scene's volts to compare.
 */
static int shape_results(shape_run *run, const options *o, char *error)
{
    analysis *a = run->analysis;
    const scene *s = a->design.scene;
    const double own[1] = {(double)NAN};
    const double *limit = o->limits ? o->limit : own;
    const int limits = o->limits ? o->limits : 1;
    const size_t most = 1 + 3 * (size_t)limits + (size_t)s->compares;
    run->volts = calloc(most, sizeof *run->volts);
    if (!run->volts)
        return scene_fault(s, s->limits.at, error, "%zu sets of volts do not fit into memory", most);
    if (shape_before(run, error) < 0 || voltages_optimum(a, HUGE_VAL, &run->volts[run->count++], error) < 0)
        return -1;
    for (int i = 0; i < limits; i++)
        if (voltages_optimum(a, limit[i], &run->volts[run->count++], error) < 0
            || (a->nonlinear && voltages_linear(a, limit[i], &run->volts[run->count++], error) < 0)
            || voltages_clipped(a, limit[i], &run->volts[run->count++], error) < 0)
            return -1;
    run->compared = run->count;
    for (int i = 0; i < s->compares; i++)
        if (voltages_given(a, s->compare[i].name, s->compare[i].value, &run->volts[run->count++], error) < 0)
            return -1;
    return modes_run(&run->modes, a, limit, limits, error);
}

static int command_shape(const options *o, analysis *a)
{
    shape_run run;
    char error[SCENE_ERROR];
    output_file f;
    int status = 0;
    memset(&run, 0, sizeof run);
    run.analysis = a;
    a->nonlinear = a->design.scene->kinematics != KINEMATICS_LINEAR;
    if (analysis_influence(a, error) == 0 && shape_results(&run, o, error) == 0) {
        (o->as_json ? print_shape_json : print_shape)(&run);
        status = o->vtu ? write_vtu(a, run.volts[1].u, o->vtu) : 0;
        if (o->report && status == 0 && (status = output_begin(&f, o->report)) == 0)
            status = output_end(&f, report_shape(f.file, a, run.volts, run.count, &run.modes));
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

/* All ticks, then what was best; the lines of a CSV file where one is asked for. Returns 0, or an exit code. */
static int run_simulation(simulation *run, const options *o, simulate_record *record)
{
    char error[SCENE_ERROR];
    output_file csv = {NULL, "", NULL};
    const int status = o->csv ? output_begin(&csv, o->csv) : 0;
    if (status)
        return status;
    if (print_run(run, record, csv.file, isatty(2), error) == 0)
        return o->csv ? output_end(&csv, 0) : 0;
    if (o->csv)
        output_drop(&csv);
    return complain(error, 1);
}

static int command_simulate(const options *o, analysis *a)
{
    const scene *s = a->design.scene;
    simulation run;
    simulate_record record;
    output_file f;
    char error[SCENE_ERROR];
    int status = 0;
    memset(&run, 0, sizeof run);
    memset(&record, 0, sizeof record);
    if (!s->simulate.given)
        scene_fault(s, s->limits.at, error, "nothing to simulate: add `simulate: {ticks: 400}`");
    if (!s->simulate.given || analysis_influence(a, error) < 0 || simulate_open(&run, a, error) < 0) {
        status = complain(error, EXIT_USAGE);
    } else if (o->device && simulate_device(&run, o->device, error) < 0) {
        status = complain(error, 1);
    } else if (record_open(&record, &run) < 0) {
        status = usage_error("out of memory for", o->scene);
    } else if ((status = run_simulation(&run, o, &record)) == 0) {
        (o->as_json ? print_simulation_json : print_simulation)(&run);
        if (o->report && (status = output_begin(&f, o->report)) == 0)
            status = output_end(&f, report_simulate(f.file, &run, &record));
        status |= run.count[LAW_CONTROLLER].beyond > 0 || run.count[LAW_CONTROLLER].not_finite > 0
               || (run.board && run.board->twin && simulate_ran(&run.count[LAW_CONTROLLER]) > run.count[LAW_CONTROLLER].same);
    }
    record_close(&record);
    simulate_close(&run);
    return status;
}

/* ---- tables, check, list ---------------------------------------------- */

/* A C identifier from the prefix given or the scene's name. */
static void table_prefix(const options *o, const scene *s, char prefix[SCENE_NAME])
{
    snprintf(prefix, SCENE_NAME, "%s", o->prefix ? o->prefix : s->name);
    for (char *c = prefix; *c; c++)
        if (!((*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || *c == '_' || (c > prefix && *c >= '0' && *c <= '9')))
            *c = '_';
}

/* The output file; in a folder it takes the prefix as its name. */
static const char *table_path(const options *o, const char *prefix, char path[PATH_ROOM])
{
    struct stat there;
    if (stat(o->output, &there) == 0 && S_ISDIR(there.st_mode))
        snprintf(path, PATH_ROOM, "%s/%s.h", o->output, prefix);
    else
        snprintf(path, PATH_ROOM, "%s", o->output);
    return path;
}

/*
 * Everything the tables hold. A nonlinear image: the scene's equilibrium, and a voltage problem where it has a target. A
 * control image: the influence that the scene's simulation has.
 */
static int prepare_tables(analysis *a, tables_image image, char *error)
{
    const scene *s = a->design.scene;
    if ((image == TABLES_CONTROL || (image == TABLES_LINEAR && s->target.given)) && analysis_influence(a, error) < 0)
        return -1;
    if (image == TABLES_CONTROL && simulate_tables(a, error) < 0)
        return -1;
    if (image != TABLES_NONLINEAR)
        return 0;
    if (s->kinematics == KINEMATICS_LINEAR)
        return scene_fault(s, s->at_surface, error, "a nonlinear image needs kinematics: nonlinear (or auto)");
    double *u = calloc((size_t)a->design.mesh.dof, sizeof *u);
    a->nonlinear = 1;
    const int failed = u ? analysis_solve(a, u, error) : scene_fault(s, s->at_surface, error, "out of memory");
    free(u);
    return failed ? -1 : s->target.given ? analysis_influence(a, error) : 0;
}

static void print_tables(const options *o, const analysis *a, const char *path)
{
    const design *d = &a->design;
    printf("%s: %s image of %s, %d amplifiers, %d target nodes, %d free unknowns\n", path, tables_image_name[o->image], d->scene->name,
           d->amplifiers, d->targets, d->mesh.dof);
    if (o->image == TABLES_NONLINEAR)
        printf("condition %.1e after scaling: %s\n", a->model.condition, tables_fit_float(a) ? "float or double" : "refused in float");
}

static int command_tables(const options *o, analysis *a)
{
    output_file f;
    tables_size size;
    char error[SCENE_ERROR], prefix[SCENE_NAME], path[PATH_ROOM];
    if (prepare_tables(a, o->image, error) < 0)
        return complain(error, failed_code(a));
    table_prefix(o, a->design.scene, prefix);
    int status = output_begin(&f, table_path(o, prefix, path));
    if (status == 0)
        status = output_end(&f, tables_write(f.file, a, o->image, prefix, &size));
    if (status == 0)
        print_tables(o, a, path);
    return status;
}

static int command_check(const options *o, analysis *a)
{
    char error[SCENE_ERROR];
    if (a->design.scene->target.given && analysis_influence(a, error) < 0)
        return complain(error, EXIT_USAGE);
    (o->as_json ? print_check_json : print_check)(a);
    return 0;
}

/* Entries of the scene folder that are scenes. */
static int is_scene(const struct dirent *entry)
{
    const size_t length = strlen(entry->d_name), ending = strlen(".yaml");
    return length > ending && strcmp(entry->d_name + length - ending, ".yaml") == 0;
}

static int list_scene(const char *file)
{
    char name[SCENE_NAME];
    snprintf(name, sizeof name, "%.*s", (int)(strlen(file) - strlen(".yaml")), file);
    const options o = {.scene = name};
    scene s;
    if (open_scene(&o, &s))
        return EXIT_USAGE;
    printf("%-20s %s\n", s.name, s.about ? s.about : "");
    scene_free(&s);
    return 0;
}

static int command_list(void)
{
    struct dirent **entry;
    const int count = scandir(scene_folder(), &entry, is_scene, alphasort);
    int status = count < 0 ? usage_error("cannot read the folder of scenes", scene_folder()) : 0;
    for (int i = 0; i < count; i++) {
        status |= list_scene(entry[i]->d_name);
        free(entry[i]);
    }
    if (count >= 0)
        free(entry);
    return status;
}

static int run_command(int argc, char **argv)
{
    static const struct {
        const char *name;
        command *run;
    } commands[] = {{"solve", command_solve}, {"shape", command_shape}, {"tables", command_tables}, {"check", command_check},
                    {"simulate", command_simulate}};
    if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "help") == 0) {
        fputs(help, argc < 2 ? stderr : stdout);
        return argc < 2 ? EXIT_USAGE : 0;
    }
    if (strcmp(argv[1], "list") == 0)
        return command_list();
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (strcmp(argv[1], commands[i].name) == 0) {
            options o;
            for (int k = 2; k < argc; k++)
                if (strcmp(argv[k], "--help") == 0)
                    return fputs(help, stdout) < 0;
            int wrong = parse(&o, argc, argv);
            wrong = wrong ? wrong : check_options(&o, argv[1]);
            wrong = wrong ? wrong : check_files(&o);
            return wrong ? wrong : run_on_scene(&o, commands[i].run);
        }
    return usage_error("unknown command", argv[1]);
}

int main(int argc, char **argv)
{
    const int status = run_command(argc, argv);
    if (fflush(stdout) == 0 && !ferror(stdout))
        return status;
    perror("pzs: standard output");
    return 1;
}
