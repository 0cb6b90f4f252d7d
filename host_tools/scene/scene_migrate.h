/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Migration of a scene file: retired keys and words (scene_retired.h) are replaced in the text, and
 * everything else, comments and layout included, stays as it is.
 */
#ifndef SCENE_MIGRATE_H
#define SCENE_MIGRATE_H

#include <stddef.h>

/*
 * Rewrite the scene file at a path. A step limit that was called slew becomes a rate limit where
 * the scene gives a tick rate and the quotient of the two is exactly the step limit.
 *   text, bytes  out  the new text, to be released with free; NULL after an error
 *   error        out  [SCENE_ERROR] as scene_read
 * Returns 0, or -1 with error filled: the file cannot be read, a name cannot be replaced in the
 * text, or the new text is no valid scene.
 */
int scene_migrate(const char *path, char **text, size_t *bytes, char *error);

#endif
