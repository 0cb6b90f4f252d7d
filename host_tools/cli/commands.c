/* SPDX-License-Identifier: BSD-2-Clause */
/* Tables of the commands and options of pzs (commands.h). */
#include "commands.h"
#include <string.h>
#include "../simulate/device.h"

#define BIT(command) (1u << (command))
#define ANALYSES                                                                                   \
    (BIT(COMMAND_CHECK) | BIT(COMMAND_SOLVE) | BIT(COMMAND_SHAPE) | BIT(COMMAND_SIMULATE))
#define ON_SCENE                                                                                   \
    (ANALYSES | BIT(COMMAND_MODES) | BIT(COMMAND_TABLES) | BIT(COMMAND_FMU) |                      \
     BIT(COMMAND_CALIBRATE))

const char *const command_title =
    "shape control of piezoelectric shells: host simulation and precomputation";

static const char *const starts[] = {"plate",           "mirror",        "panel",       "measured",
                                     "measured-matrix", "poke-voltages", "poke-shapes", NULL};
static const char *const shells[] = {"bash", NULL};
static const char *const circuits[] = {"open", "short", NULL};
static const char *const images[] = {"control", "linear", "nonlinear", NULL};
#define NAME_OF(name, machine, bits, twin) name,
#define NAME_IN_TEXT(name, machine, bits, twin) name ", "
static const char *const boards[] = {DEVICE_BOARDS(NAME_OF) "host-32", "host-64", NULL};

const command_entry command_table[COMMANDS] = {
    [COMMAND_LIST] = {"list",
                      "",
                      ARGUMENT_NONE,
                      NULL,
                      "the scenes shipped, a line each",
                      "Name and purpose of each shipped scene. A name of this list is accepted "
                      "wherever a command takes a SCENE.",
                      {"pzs list", NULL}},
    [COMMAND_CHECK] =
        {"check",
         "SCENE",
         ARGUMENT_SCENE,
         NULL,
         "read a scene and say what is wrong with it",
         "Reads the scene, builds its mesh and factors its stiffness. The first mistake is "
         "reported with file, line and column. A valid scene is answered with the size of its "
         "mesh, its condition and what each image needs of a device: tables in flash, workspace in "
         "RAM, stack. Where the materials have densities, the first natural frequencies, and up to "
         "what rate the control loop is stable.",
         {"pzs check plate-50-patches", NULL}},
    [COMMAND_SOLVE] =
        {"solve",
         "SCENE",
         ARGUMENT_SCENE,
         NULL,
         "displacement under the scene's loads and applied voltages",
         "Displacement under the loads and applied voltages of the scene, and the values of its "
         "outputs. An output at several "
         "nodes is a table with a row for each node, one of several electrodes a row for each "
         "electrode. The solver residual "
         "and the solver error estimate are those of the linear solve; the discretisation error is "
         "not in them: --error estimates it from coarser meshes. A nonlinear solution is repeated "
         "with twice as many load steps; a warning says where the answer depends on them, or is "
         "unstable; --path then follows the load path. --stress recovers stresses and strains.",
         {"pzs solve scordelis-lo --error", "pzs solve hinged-roof --path",
          "pzs solve crossply --stress --set mesh.theta1.elements=8",
          "pzs solve hemisphere --report hemisphere.html --vtu hemisphere.vtu", NULL}},
    [COMMAND_SHAPE] =
        {"shape",
         "SCENE",
         ARGUMENT_SCENE,
         NULL,
         "voltages that bring the shape to the scene's target, and its error",
         "Voltages that bring the structure closest to the target of the scene: without limits, "
         "within the limits, and for comparison clipped least squares, and regularised, then "
         "clipped (see the notes of pzs --help). The narrowest limit of an amplifier always wins: "
         "the common limits, its own limits and held voltage (limits.each), and the depolarisation "
         "field of its material (field_limit). The shape error is the weighted RMS misfit over the "
         "RMS of the wanted change of shape: the target less the shape without voltages, which "
         "loads cause. Target nodes on constrained dof, which cannot move, do not count; "
         "shape reports them where they are not as wanted, and the error with them. target.free: "
         "functions that are taken out of target and error (piston, tip, tilt, or formulas). The "
         "discretisation error of the mesh is not in the shape error: --error estimates it.",
         {"pzs shape plate-50-patches --limit 100 --limit 200 --report plate.html", NULL}},
    [COMMAND_MODES] =
        {"modes",
         "SCENE",
         ARGUMENT_SCENE,
         NULL,
         "natural frequencies and mode shapes",
         "Natural frequencies and mode shapes; every material needs a density. With nonlinear "
         "kinematics they are those about the equilibrium under the loads, otherwise those of the "
         "reference state. Electrodes of amplifiers are short-circuited, those of sensors as the "
         "scene says; --electrodes open or short changes that. For each mode: the mass that takes "
         "part in a motion along x, y and z, and the input that moves it most; with --json its "
         "damping ratio, what each input moves by it, and each output while its largest "
         "displacement is one unit of length.",
         {"pzs modes plate-50-patches --number 5 --vtu modes.vtu",
          "pzs modes bimorph-sensor --set materials.PVDF.density=1780 --electrodes open", NULL}},
    [COMMAND_TABLES] =
        {"tables",
         "SCENE -o FILE.h",
         ARGUMENT_SCENE,
         NULL,
         "C tables for a firmware",
         "Writes a C header with the tables of the scene for the library on a device. The image "
         "says how much of the computation the device does itself. Where the materials have "
         "densities and vibration would make the control step unstable at the scene's rate, the "
         "tick observes and damps the vibration modes; --quasi-static leaves that out, and must be "
         "said where the scene gives no rate. "
         "target.free needs the control image.",
         {"pzs tables plate-closed-loop --prefix loop -o .",
          "pzs tables plate-50-patches --image linear --quasi-static --prefix plate -o plate.h",
          "pzs tables plate-50-patches --image linear --quasi-static --modes 5 -o plate.h", NULL}},
    [COMMAND_SIMULATE] =
        {"simulate",
         "SCENE",
         ARGUMENT_SCENE,
         NULL,
         "the controller in closed loop with a plant that differs from the model",
         "Runs the controller in closed loop with a plant that differs from its model in "
         "stiffness, piezoelectric constants and hysteresis, with noise, faults and events as the "
         "scene's simulate section says. For comparison: clipped least squares, and regularised, "
         "then clipped (see the notes of pzs --help). The plant vibrates where all densities are "
         "given, unless simulate.plant.inertia is false, and the controller is that of pzs tables: "
         "with a vibration model where the loop needs one, after storms (stress tests: fast jumps "
         "of the target) that choose its settings.",
         {"pzs simulate plate-closed-loop --report loop.html --csv loop.csv",
          "pzs simulate plate-few-sensors --device mps2-an386",
          "pzs simulate plate-closed-loop --set 'simulate.events=[]' --set simulate.ticks=300 "
          "--device netduinoplus2",
          NULL}},
    [COMMAND_FMU] =
        {"fmu",
         "SCENE -o FILE.fmu",
         ARGUMENT_SCENE,
         NULL,
         "plant or controller as an FMU, for Simulink, Modelica and Python",
         "Writes a functional mock-up unit (FMI 2.0 for co-simulation) with complete C sources: "
         "the plant of pzs simulate (linear; voltages and loads in, readings, displacements and "
         "amplifier voltages out) or the controller of pzs tables (target and readings in, "
         "voltages and status out). A step is a tick. Both coupled in turn, controller first, give "
         "the bits of pzs simulate.",
         {"pzs fmu plate-closed-loop --plant --set simulate.plant.kinematics=linear -o plant.fmu",
          "pzs fmu plate-closed-loop --controller -o controller.fmu", NULL}},
    [COMMAND_NEW] = {"new",
                     "[plate|mirror|panel|measured|measured-matrix|poke-voltages|poke-shapes]",
                     ARGUMENT_CHOICE,
                     starts,
                     "a commented scene to start from, on standard output",
                     "Writes a commented scene to start from: a plate with patches on both faces "
                     "(the one without an argument), a "
                     "deformable mirror in polar coordinates, or a curved composite panel under "
                     "pressure, or a mirror without a model, from its measured influence matrix; "
                     "measured-matrix is the file of numbers that the last one names, "
                     "poke-voltages and poke-shapes are files for pzs calibrate.",
                     {"pzs new mirror > new.yaml",
                      "pzs new measured > measured.yaml; pzs new measured-matrix > "
                      "measured-matrix.csv",
                      NULL}},
    [COMMAND_MIGRATE] =
        {"migrate",
         "SCENE",
         ARGUMENT_SCENE,
         NULL,
         "the scene file with today's keys, on standard output",
         "Rewrites a scene file of an older version: keys and words that have been replaced get "
         "their new names, slew (V a tick) becomes rate_limit (V/s) where the scene gives a tick "
         "rate and step_limit where it does not, and simulate.rate moves to control.rate. Comments "
         "and layout stay. A scene that needs nothing is printed unchanged. The result is read "
         "back before it is printed.",
         {"pzs migrate plate-50-patches > new.yaml", NULL}},
    [COMMAND_KEYS] = {"keys",
                      "[SECTION]",
                      ARGUMENT_SECTION,
                      NULL,
                      "the keys of a scene, with their values and a sentence each",
                      "Lists the keys of a scene in the order in which they are read, with the "
                      "kind and range of their values, a unit as an example, and a sentence each; "
                      "with SECTION those of one section. Keys of a mapping stand indented below "
                      "it.",
                      {"pzs keys limits", NULL}},
    [COMMAND_SCHEMA] = {"schema",
                        "",
                        ARGUMENT_NONE,
                        NULL,
                        "JSON schema of scenes, for editors",
                        "Writes the JSON schema of scenes, with which an editor completes, "
                        "explains and checks keys. It is made from the tables of keys of the "
                        "reader; the file scene.schema.json beside the shipped scenes is its "
                        "output.",
                        {"pzs schema > scene.schema.json", NULL}},
    [COMMAND_CALIBRATE] =
        {"calibrate",
         "[SCENE]",
         ARGUMENT_SCENE,
         NULL,
         "influence matrix from measured pokes, with its errors",
         "Computes an influence matrix from pokes: a file of voltages and one of shapes, with a "
         "line for each poke and a column for each actuator and each output, of any excitation "
         "(one by one, Hadamard, random). Without a scene by least squares, which needs as many "
         "independent pokes as actuators. With a scene as the model, fewer suffice: of a "
         "structure, whose target nodes are the outputs, factors of stiffness and piezoelectric "
         "constants are "
         "fitted first; a measured matrix is taken as it is. Dead electrodes are named, and "
         "with a model reversed wires, swapped cables and cross-talk. With three pokes more "
         "than actuators or more, drift and a constant offset of the shapes are taken out, in "
         "the order of the lines, and what earlier voltages leave (hysteresis) is stated. The "
         "matrix is that of the amplifiers as they are wired.",
         {"pzs new poke-voltages > voltages.csv; pzs new poke-shapes > shapes.csv",
          "pzs calibrate --voltages voltages.csv --shapes shapes.csv -o matrix.csv", NULL}},
    [COMMAND_COMPLETION] =
        {"completion",
         "[SHELL]",
         ARGUMENT_CHOICE,
         shells,
         "completion of these commands for a shell (bash)",
         "Writes a script that completes commands, options, scenes and files. Without SHELL: for "
         "bash. Load it with "
         "`. ./pzs.bash`, or install it as share/bash-completion/completions/pzs.",
         {"pzs completion > pzs.bash", NULL}},
    [COMMAND_MAN] = {"man",
                     "",
                     ARGUMENT_NONE,
                     NULL,
                     "the manual page, in roff",
                     "Writes the manual page in roff on standard output; `man -l pzs.1` shows it.",
                     {"pzs man > pzs.1", NULL}},
    [COMMAND_HELP] = {
        "help",
        "[COMMAND]",
        ARGUMENT_COMMAND,
        NULL,
        "this help, or that of one command",
        "Usage, options and examples of one command; without COMMAND a line for each.",
        {"pzs help shape", NULL}}};

const option_entry option_table[OPTIONS] = {
    [OPTION_SET] =
        {"--set", NULL, "KEY=VALUE", ARGUMENT_TEXT, NULL, ON_SCENE,
         "change the scene: --set mesh.theta1.elements=16 --set element=improved; list items by "
         "number from 0 or by name"},
    [OPTION_LIMIT] =
        {"--limit", NULL, "V|LO,HI", ARGUMENT_TEXT, NULL, BIT(COMMAND_SHAPE),
         "common voltage limits, -V to V or LO to HI, instead of limits.voltage of the scene; an "
         "amplifier's own limits and held voltage (limits.each) and the depolarisation field "
         "(field_limit) apply besides, so that the narrowest limit always wins; repeat it for a "
         "comparison"},
    [OPTION_JSON] = {"--json", NULL, "", ARGUMENT_NONE, NULL,
                     ANALYSES | BIT(COMMAND_MODES) | BIT(COMMAND_CALIBRATE),
                     "numbers for machines on standard output"},
    [OPTION_STRICT] = {"--strict", NULL, "", ARGUMENT_NONE, NULL, ANALYSES | BIT(COMMAND_MODES),
                       "warnings on implausible numbers end with exit code 1"},
    [OPTION_ERROR] = {"--error", NULL, "", ARGUMENT_NONE, NULL,
                      BIT(COMMAND_SOLVE) | BIT(COMMAND_SHAPE) | BIT(COMMAND_MODES),
                      "estimate the discretisation error: repeats the computation on meshes with a "
                      "half and, where possible, a quarter of the elements in each direction; for "
                      "about a third more work; of shape that of the shape error and of the "
                      "influence matrix"},
    [OPTION_STRESS] = {"--stress", NULL, "", ARGUMENT_NONE, NULL, BIT(COMMAND_SOLVE),
                       "stresses and strains of each layer: the largest ones with their places, "
                       "reserve factors against strength and depolarisation; with --vtu, --npz and "
                       "--report also their fields"},
    [OPTION_PATH] = {"--path", NULL, "", ARGUMENT_NONE, NULL, BIT(COMMAND_SOLVE),
                     "follow the load path from the reference state by the arc-length method, "
                     "through limit points, and name limit points and bifurcations; with a moved "
                     "contact body or prescribed displacements in equal load steps"},
    [OPTION_BRANCH] = {"--branch", NULL, "N", ARGUMENT_TEXT, NULL, BIT(COMMAND_SOLVE),
                       "follow the load path, leave it at its bifurcation N (1: the first) along "
                       "the mode of the bifurcation, and follow this branch; -N: against the mode"},
    [OPTION_REPORT] = {"--report", NULL, "FILE.html", ARGUMENT_FILE, NULL,
                       BIT(COMMAND_SOLVE) | BIT(COMMAND_SHAPE) | BIT(COMMAND_MODES) |
                           BIT(COMMAND_SIMULATE),
                       "pictures and tables in one page"},
    [OPTION_SVG] =
        {"--svg", NULL, "FILE.svg", ARGUMENT_FILE, NULL,
         BIT(COMMAND_SOLVE) | BIT(COMMAND_SHAPE) | BIT(COMMAND_MODES) | BIT(COMMAND_SIMULATE),
         "the main picture alone, for a README or a paper; of modes the first six shapes"},
    [OPTION_VTU] = {"--vtu", NULL, "FILE.vtu", ARGUMENT_FILE, NULL,
                    BIT(COMMAND_SOLVE) | BIT(COMMAND_SHAPE) | BIT(COMMAND_MODES),
                    "deformed shape for ParaView; of modes the mode shapes"},
    [OPTION_NUMBER] = {"--number", NULL, "N", ARGUMENT_TEXT, NULL,
                       BIT(COMMAND_MODES) | BIT(COMMAND_CALIBRATE),
                       "how many modes, 1 to 200; default 10; of calibrate --vibration at most "
                       "20, default 5"},
    [OPTION_ELECTRODES] =
        {"--electrodes", NULL, "CIRCUIT", ARGUMENT_CHOICE, circuits,
         BIT(COMMAND_MODES) | BIT(COMMAND_TABLES),
         "circuit of all electrodes while the structure vibrates: open or short; default: sensors "
         "as the scene says, amplifiers short. Where electrodes are open, modes prints the "
         "short-circuit frequencies and coupling factors, too; with tables --modes the firmware "
         "opens them on the device"},
    [OPTION_CSV] =
        {"--csv", NULL, "FILE.csv", ARGUMENT_FILE, NULL, BIT(COMMAND_SIMULATE),
         "a line a tick: tick, time (s), error and vibration of the shape over the scene's "
         "target, active (voltages at a limit), iterations of "
         "the optimiser, status (pzs_status of the tick), missed_tick (1: the controller "
         "did not run), measurement_error (of the estimate of "
         "the shape), then the voltages that each amplifier gives"},
    [OPTION_DEVICE] = {"--device", NULL, "BOARD", ARGUMENT_CHOICE, boards, BIT(COMMAND_SIMULATE),
                       "the firmware of a board under QEMU is the controller, and every bit is "
                       "compared with the same C here: " DEVICE_BOARDS(
                           NAME_IN_TEXT) "or that C alone: host-32, host-64"},
    [OPTION_IMAGE] = {"--image", NULL, "IMAGE", ARGUMENT_CHOICE, images, BIT(COMMAND_TABLES),
                      "control (influence matrix), linear (element matrices) or nonlinear (and "
                      "the equilibrium solver at large rotation; "
                      "the scene needs kinematics: nonlinear); default control"},
    [OPTION_COMPACT] =
        {"--compact", NULL, "", ARGUMENT_NONE, NULL, BIT(COMMAND_TABLES),
         "a linear or nonlinear image without the stiffness matrices and the geometry "
         "of the element types: a fifth of its tables on a mesh from a file; the "
         "device computes them from the nodes"},
    [OPTION_MODES] = {"--modes", NULL, "N", ARGUMENT_TEXT, NULL, BIT(COMMAND_TABLES),
                      "a linear or nonlinear image that also computes the N lowest natural "
                      "frequencies and mode shapes on the device (1 to 200): adds element mass "
                      "matrices and the size of the workspace; all materials need a density"},
    [OPTION_QUASI_STATIC] =
        {"--quasi-static", NULL, "", ARGUMENT_NONE, NULL,
         BIT(COMMAND_TABLES) | BIT(COMMAND_SIMULATE) | BIT(COMMAND_FMU),
         "a tick without vibration model, also where vibration makes it unstable at the scene's "
         "rate, or the scene gives no rate; the header then says so and defines "
         "PREFIX_QUASI_STATIC"},
    [OPTION_PREFIX] = {"--prefix", NULL, "NAME", ARGUMENT_TEXT, NULL, BIT(COMMAND_TABLES),
                       "start of every name; default the scene's name"},
    [OPTION_PLANT] = {"--plant", NULL, "", ARGUMENT_NONE, NULL, BIT(COMMAND_FMU),
                      "the plant with amplifiers, ceramic and sensors, as the scene's simulate "
                      "section says"},
    [OPTION_CONTROLLER] = {"--controller", NULL, "", ARGUMENT_NONE, NULL, BIT(COMMAND_FMU),
                           "the control loop of the library with the tables of the scene"},
    [OPTION_BUILD] = {"--build", NULL, "", ARGUMENT_NONE, NULL, BIT(COMMAND_FMU),
                      "also compile the sources, with the C compiler that CC names, to a library "
                      "for 64-bit Linux in the FMU"},
    [OPTION_NPZ] =
        {"--npz", NULL, "FILE.npz", ARGUMENT_FILE, NULL,
         BIT(COMMAND_SOLVE) | BIT(COMMAND_SHAPE) | BIT(COMMAND_MODES) | BIT(COMMAND_SIMULATE),
         "arrays for numpy.load: places, target, influence, limits, voltages, shapes and "
         "misfits (a row for each set of voltages), displacements, mode shapes, the "
         "ticks of simulate; the array units names their units"},
    [OPTION_CSV_FOLDER] = {"--csv-dir", NULL, "FOLDER", ARGUMENT_FILE, NULL,
                           BIT(COMMAND_SOLVE) | BIT(COMMAND_SHAPE) | BIT(COMMAND_MODES) |
                               BIT(COMMAND_SIMULATE),
                           "the same arrays, a CSV file for each"},
    [OPTION_VOLTAGES] = {"--voltages", NULL, "FILE", ARGUMENT_FILE, NULL, BIT(COMMAND_CALIBRATE),
                         "voltages of the pokes (V): text or .npy, a line for each poke"},
    [OPTION_SHAPES] = {"--shapes", NULL, "FILE", ARGUMENT_FILE, NULL, BIT(COMMAND_CALIBRATE),
                       "measured shapes, in the order of the voltages, in the scene's unit of "
                       "length; without a scene in any unit, then the matrix is in it, per volt"},
    [OPTION_STANDARD_ERRORS] =
        {"--standard-errors", NULL, "FILE", ARGUMENT_FILE, NULL, BIT(COMMAND_CALIBRATE),
         "the standard error of each entry of the matrix, a table like the matrix"},
    [OPTION_HYSTERESIS] =
        {"--hysteresis", NULL, "RATE", ARGUMENT_TEXT, NULL, BIT(COMMAND_CALIBRATE),
         "hysteresis and creep from a sweep of RATE samples a second, in place of "
         "a matrix: prints the section hysteresis of a scene"},
    [OPTION_VIBRATION] =
        {"--vibration", NULL, "RATE", ARGUMENT_TEXT, NULL, BIT(COMMAND_CALIBRATE),
         "vibration modes from a record of RATE samples a second with steps of the voltages, in "
         "place of a matrix: prints the key modes of the section influence of a scene"},
    [OPTION_OUTPUT] = {"-o", NULL, "FILE", ARGUMENT_FILE, NULL,
                       BIT(COMMAND_TABLES) | BIT(COMMAND_CALIBRATE) | BIT(COMMAND_FMU),
                       "output file, or a folder for it; - is standard output"},
    [OPTION_MIGRATE] = {"--migrate", NULL, "SCENE", ARGUMENT_FILE, NULL, 0,
                        "the same as pzs migrate SCENE"},
    [OPTION_HELP] = {"--help", "-h", "", ARGUMENT_NONE, NULL, BIT(COMMANDS) - 1u,
                     "this help; behind a command that of the command"},
    [OPTION_VERSION] = {"--version", NULL, "", ARGUMENT_NONE, NULL, 0,
                        "version of pzs and of its library"}};

const char *const command_notes[] = {
    "Compared in shape and simulate. Clipped least squares: voltages without limits, cut to the "
    "limits. Regularised, then clipped: the same with the one parameter that leaves the smallest "
    "error of the linear model, chosen knowing the answer.",
    "The solver residual and the solver error estimate of `pzs solve` are those of the linear "
    "solve. The discretisation "
    "error is not in them: --error estimates it.",
    "Exit code: 0 done, 1 the computation failed, 2 the scene or the command line is wrong, 3 the "
    "control loop is refused: not stable at its tick rate, or longer than a tick (check, tables, "
    "fmu).",
    NULL};

int command_takes(command_id command, option_id option)
{
    return (option_table[option].commands & BIT(command)) != 0;
}

command_id command_find(const char *name)
{
    int k = 0;
    while (k < COMMANDS && strcmp(command_table[k].name, name) != 0)
        k++;
    return (command_id)k;
}

const char *option_new_name(const char *name)
{
    return strcmp(name, "--level") == 0 ? option_table[OPTION_IMAGE].name : NULL;
}

option_id option_find(const char *name)
{
    for (int k = 0; k < OPTIONS; k++) {
        const char *other = option_table[k].other;
        if (strcmp(option_table[k].name, name) == 0 || (other && strcmp(other, name) == 0))
            return (option_id)k;
    }
    return OPTIONS;
}
