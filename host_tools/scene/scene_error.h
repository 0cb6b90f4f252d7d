/* SPDX-License-Identifier: BSD-2-Clause */
/* Places in a scene file, and the room for one error message about such a place. */
#ifndef SCENE_ERROR_H
#define SCENE_ERROR_H

/* Bytes of an error message with its final NUL. */
enum { SCENE_ERROR = 400 };

/* The place of a value in the scene file, for error messages: line and column from 1. Line -(k+1)
 * is the change set[k] of the command line, line 0 the file as a whole. */
typedef struct scene_at {
    int line, column;
} scene_at;

#endif
