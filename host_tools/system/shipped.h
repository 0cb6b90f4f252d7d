/* SPDX-License-Identifier: BSD-2-Clause */
/* Scenes shipped with the program: folder, files and list of names. */
#ifndef SHIPPED_H
#define SHIPPED_H

#include "../text/suggest.h"

/* Size of the memory for a path (characters). */
enum { SHIPPED_PATH = 4096 };

/*
 * Return the folder of the shipped scenes, valid until the next call: the first one available of
 *   1. the value of the environment variable PZS_SCENES, without a check
 *   2. share/piezoshape/scenes beside the folder of this program, for an installed program
 *   3. the scenes of the source tree that contains the build folder of this program
 *   4. the scenes of the source tree at the time of the build, without a check
 */
const char *shipped_folder(void);

/*
 * Return the folder of the sources, which the build of a firmware requires: the value of the
 * environment variable PZS_SOURCES if it is set, otherwise the first existing folder in the order
 * in which shipped_folder searches the scenes. The text is valid until the next call.
 */
const char *shipped_sources(void);

/*
 * Write the path of a scene file. If `name` is a path or ends with .yaml, the result is `name`;
 * otherwise it is the path of the shipped scene with this name, relative to the current folder if
 * the file lies below this folder.
 */
void shipped_path(const char *name, char path[SHIPPED_PATH]);

/* Return whether `name` is the name of a shipped scene and not of a file. */
int shipped_is_name(const char *name);

/* Find the shipped scene whose name is most similar to a mistyped name. */
void shipped_suggest(suggestion *suggestion, const char *name);

/*
 * Function that shipped_each calls with the name of each shipped scene, in alphabetical order.
 * shipped_each returns the sum of the values that the calls return, or -1 if the folder of the
 * scenes does not exist.
 */
typedef int shipped_visit(void *context, const char *name);
int shipped_each(shipped_visit *visit, void *context);

#endif
