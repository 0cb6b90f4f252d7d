/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Migration of a scene file to the present scene language: retired keys and words (scene_retired.h)
 * are replaced in the text, and everything else, comments and layout included, is kept.
 */
#ifndef SCENE_MIGRATE_H
#define SCENE_MIGRATE_H

#include <stddef.h>

/*
 * Rewrite the text of a scene file with the present names of keys and words. The retired step limit
 * `slew` (V a tick) becomes a rate limit (V/s), unless the tick rate is missing or rounding would
 * change the limit.
 *   text, bytes                out  new text and its length, to be released with free; NULL after
 *       an error
 *   error        [SCENE_ERROR] out  one line with the position of the fault
 * Returns 0, or -1 with error filled: the file cannot be read, a name cannot be replaced, or the
 * new text is no valid scene.
 */
int scene_migrate(const char *path, char **text, size_t *bytes, char *error);

#endif
