/* The command line of pzs: its words, its help, the files that it names. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "device.h"
#include "tables.h"

/* OPTIONS_WRONG: exit code where the scene or the command line is wrong. */
enum { OPTIONS_WRONG = 2, OPTIONS_PATH = 4096, MOST_SETS = 64, MOST_LIMITS = 16 };

typedef struct options {
    const char *scene;
    const char *set[MOST_SETS];
    common_limits limit[MOST_LIMITS];
    int sets, limits, as_json, is_strict;
    int number;       /* of modes; 0: not given */
    int quasi_static;
    const char *report, *vtu, *csv, *output, *prefix;
    const device_board *device;
    tables_image image;
} options;

extern const char *const options_help;

/* Read the words after the command, argv[1]. Returns 0, or an exit code after saying what is wrong. */
int options_read(options *o, int argc, char **argv);

/* Say what is wrong with a word of the command line. Returns OPTIONS_WRONG. */
int options_refuse(const char *what, const char *value);

/* Folder of the shipped scenes: beside the source of this build, or PZS_SCENES of the environment. */
const char *options_folder(void);

/* The file of a scene: itself, or that of a shipped one. */
void options_scene_path(const char *name, char path[OPTIONS_PATH]);

#endif
