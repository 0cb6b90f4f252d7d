/* The command line (options.h). */
#define _POSIX_C_SOURCE 200809L
#include "options.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

const char *const options_help =
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
    "  pzs simulate plate-closed-loop --set 'simulate.events=[]' --set simulate.ticks=300 --device netduinoplus2\n"
    "\n"
    "The solver residual and the solver error estimate of `pzs solve` are those of the linear solve. The discretisation error\n"
    "is not in them: solve on a second, finer mesh and compare.\n"
    "\n"
    "Exit code: 0 done, 1 the computation failed, 2 the scene or the command line is wrong.\n";

/* ---- command line ----------------------------------------------------- */

int options_refuse(const char *what, const char *value)
{
    fprintf(stderr, "pzs: %s '%s'; see pzs --help\n", what, value);
    return OPTIONS_WRONG;
}

/* Take one option with a value. Returns 0, or an exit code. */
static int take_value(options *o, const char *name, const char *value)
{
    char *end;
    if (strcmp(name, "--set") == 0) {
        if (o->sets == MOST_SETS)
            return options_refuse("too many changes at", value);
        o->set[o->sets++] = value;
    } else if (strcmp(name, "--limit") == 0) {
        const double limit = strtod(value, &end);
        if (o->limits == MOST_LIMITS || end == value || *end || !(limit > 0))
            return options_refuse("--limit wants a positive voltage, not", value);
        o->limit[o->limits++] = limit;
    } else if (strcmp(name, "--level") == 0) {
        for (o->image = 0; o->image < TABLES_IMAGES && strcmp(value, tables_image_name[o->image]) != 0;)
            o->image++;
        if (o->image == TABLES_IMAGES)
            return options_refuse("--level is control, linear or nonlinear, not", value);
    } else if (strcmp(name, "--report") == 0) {
        o->report = value;
    } else if (strcmp(name, "--vtu") == 0) {
        o->vtu = value;
    } else if (strcmp(name, "--csv") == 0) {
        o->csv = value;
    } else if (strcmp(name, "--device") == 0) {
        o->device = device_find(value);
        if (!o->device)
            return options_refuse("--device is netduinoplus2, mps2-an386, mps2-an500, host-32 or host-64, not", value);
    } else if (strcmp(name, "--prefix") == 0) {
        o->prefix = value;
    } else if (strcmp(name, "-o") == 0) {
        o->output = value;
    } else {
        return options_refuse("unknown option", name);
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
                return options_refuse("one scene at a time; unexpected", argv[i]);
            o->scene = argv[i];
        } else {
            if (i + 1 == argc)
                return options_refuse("unknown option, or a value is missing after", argv[i]);
            const int wrong = take_value(o, argv[i], argv[i + 1]);
            if (wrong)
                return wrong;
            i++;
        }
    }
    if (o->prefix && strlen(o->prefix) == 3 && tolower((unsigned char)o->prefix[0]) == 'p'
        && tolower((unsigned char)o->prefix[1]) == 'z' && tolower((unsigned char)o->prefix[2]) == 's')
        return options_refuse("the library's own names start with --prefix", o->prefix);
    return o->scene ? 0 : options_refuse("name a scene for", argv[1]);
}

/* ---- scenes ----------------------------------------------------------- */

const char *options_folder(void)
{
    const char *folder = getenv("PZS_SCENES");
    return folder ? folder : SCENE_FOLDER;
}

void options_scene_path(const char *name, char path[OPTIONS_PATH])
{
    const size_t length = strlen(name);
    const int is_file = strchr(name, '/') || (length > 5 && strcmp(name + length - 5, ".yaml") == 0);
    if (is_file)
        snprintf(path, OPTIONS_PATH, "%s", name);
    else
        snprintf(path, OPTIONS_PATH, "%s/%s.yaml", options_folder(), name);
}

static int stat_folder(const char *path, struct stat *there)
{
    char folder[OPTIONS_PATH];
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
    char scene_path[OPTIONS_PATH];
    const char *const file[5] = {scene_path, o->report, o->vtu, o->csv, o->output};
    options_scene_path(o->scene, scene_path);
    for (int i = 1; i < 5; i++)
        for (int j = 0; j < i; j++)
            if (file[i] && file[j] && same_file(file[i], file[j]))
                return options_refuse("two files under one name:", file[i]);
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
            return OPTIONS_WRONG;
        }
    if (strcmp(command, "tables") == 0 && !o->output)
        return options_refuse("say where to write with -o FILE for", command);
    return 0;
}

int options_read(options *o, int argc, char **argv)
{
    int wrong = parse(o, argc, argv);
    wrong = wrong ? wrong : check_options(o, argv[1]);
    return wrong ? wrong : check_files(o);
}
