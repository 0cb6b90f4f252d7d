/* SPDX-License-Identifier: BSD-2-Clause */
/* Command line of pzs: arguments, options and the files that they name. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "commands.h"
#include "../simulate/device.h"
#include "../system/shipped.h"
#include "../tables/tables.h"

/*
 * Exit codes and sizes of the command line.
 *   OPTIONS_WRONG  exit code: error in the scene file or in the command line
 *   LOOP_REFUSED   exit code: valid scene, but its control loop is not stable or a tick takes the
 *       processor longer than the tick interval
 *   OPTIONS_PATH   size of a path (characters)
 *   MOST_SETS, MOST_LIMITS  how often the options --set and --limit may be given
 */
enum {
    OPTIONS_WRONG = 2,
    LOOP_REFUSED = 3,
    OPTIONS_PATH = SHIPPED_PATH,
    MOST_SETS = 64,
    MOST_LIMITS = 16
};

typedef struct options {
    command_id command;
    const char *scene; /* scene name or scene file, for a command on a scene */
    const char *word;  /* argument of a command that takes no scene, or NULL */
    const char *set[MOST_SETS];
    common_limits limit[MOST_LIMITS];
    int sets, limits;
    bool as_json, is_strict;
    int number;       /* number of vibration modes that the command line asks for; 0: not given */
    int device_modes; /* number of vibration modes that a firmware computes on the device (option
                         --modes); 0: none */
    electrode_circuit circuit; /* circuits of the electrodes for vibration modes */
    bool is_compact; /* whether to write tables without what the device can compute from the nodes
                        (option --compact) */
    bool quasi_static;
    bool follows_path; /* whether the load path is followed beyond limit points, where the load has
                          an extreme value */
    int branch; /* number of the bifurcation at which pzs changes from the load path to its branch;
                   a negative number takes the branch in the opposite direction; 0: no change */
    bool estimates_error; /* whether to estimate the discretisation error from coarser meshes */
    bool recovers_stress; /* whether to recover stresses and strains from the displacement */
    const char *report, *svg, *vtu, *csv, *output, *prefix;
    bool uses_stdout; /* whether one of the output files that the options name is "-", standard
                         output */
    const char *npz, *csv_folder;  /* NumPy file and folder of CSV files for arrays of numbers; NULL
                                      where they are not wanted */
    const char *voltages, *shapes; /* files of measured voltages and shapes, for the command
                                      calibrate */
    const char *standard_errors;   /* file for the standard errors of the entries of the influence
                                      matrix, of the command calibrate; NULL: none */
    double sample_rate;       /* samples per second of a measured hysteresis sweep, for the command
                                 calibrate; 0: the files contain shapes measured under known
                                 voltages (pokes) */
    double vibration_rate;    /* samples per second of a record of vibration after steps of the
                                 voltages, for the command calibrate; 0: the files contain no such
                                 record */
    int words;                /* number of words of the whole command line, which reports print */
    char *const *words_given; /* [words] words of the whole command line */
    const device_board *device;
    tables_image image;
    bool wants_plant, wants_controller, builds; /* what the command fmu exports, and whether it
                                                   compiles the sources */
} options;

/*
 * Read the arguments after the command in argv[1]. Returns 0, or an exit code after printing an
 * error message.
 */
int options_read(options *options, command_id command, int argc, char **argv);

/*
 * Print an error message about a command-line argument. Returns the exit code for a wrong command
 * line, OPTIONS_WRONG.
 */
int options_refuse(const char *what, const char *value);

/*
 * Print an error message about an unknown command, with the most similar command. Returns the exit
 * code for a wrong command line, OPTIONS_WRONG.
 */
int options_unknown_command(const char *name);

#endif
