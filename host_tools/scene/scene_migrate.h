/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Migration of a scene file to the present scene language: retired keys and words (scene_retired.h)
 * are replaced in the text, and everything else, comments and layout included, is kept.
 */
#ifndef SCENE_MIGRATE_H
#define SCENE_MIGRATE_H

#include <stddef.h>

/*
 * Rewrite the text of the scene file at a path. A step limit (V a tick) under its old name slew
 * becomes the rate limit (V/s) that is its product with the tick rate. It keeps the form of a step
 * limit if the scene file gives no tick rate, or if rounding would change it (rate limit/tick rate
 * is not exactly the step limit).
 *   text, bytes  out                new text and its length, to be released with free; NULL after
 *       an error
 *   error        [SCENE_ERROR] out  one line with the position of the fault
 * Returns 0, or -1 with error filled: the file cannot be read, a name cannot be replaced in the
 * text, or the new text is no valid scene.
 */
int scene_migrate(const char *path, char **text, size_t *bytes, char *error);

#endif
