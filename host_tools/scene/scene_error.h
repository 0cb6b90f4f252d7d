/* SPDX-License-Identifier: BSD-2-Clause */
/* Positions in a scene file, and the size of an error message about such a position. */
#ifndef SCENE_ERROR_H
#define SCENE_ERROR_H

/* Size in bytes of an error message including the terminating NUL. */
enum { SCENE_ERROR = 400 };

/*
 * Position of a value in the scene file for error messages: line and column, counted from 1. Line
 * -(k + 1) stands for change number k of the option --set, and line 0 for the file as a whole.
 */
typedef struct scene_at {
    int line, column;
} scene_at;

#endif
