/* SPDX-License-Identifier: BSD-2-Clause */
/* Positions in a scene file, and error messages about such a position. */
#ifndef SCENE_ERROR_H
#define SCENE_ERROR_H

/* Size in bytes of an error message including the terminating NUL. */
enum { SCENE_ERROR = 600 };

/*
 * Sources of the values of a scene, which error messages name: its file and the changes of the
 * command-line option --set.
 */
typedef struct scene_origin {
    char *path; /* path of the scene file */
    char **set; /* [sets] changes of the form key=value that are applied to the scene file */
    int sets;
} scene_origin;

/*
 * Position of a value in the scene file for error messages: line and column, counted from 1. Line
 * -(k + 1) stands for change number k of the option --set, and line 0 for the file as a whole.
 */
typedef struct scene_at {
    int line, column;
    const scene_origin *origin; /* text in which line and column count: the scene file, or the texts
                                   of the options --set. NULL for values that come from no file.
                                   NULL also while a YAML text is read, because its reader knows the
                                   path of the file */
} scene_at;

/*
 * Write an error message of the form file:line:column: text for a fault that is found after reading
 * the scene; without a file (member `origin` NULL) the message is the text alone. Returns -1.
 */
int scene_fault(scene_at at, char *error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
