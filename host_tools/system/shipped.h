/* SPDX-License-Identifier: BSD-2-Clause */
/* The scenes that are shipped: their folder, their files, the list of them. */
#ifndef SHIPPED_H
#define SHIPPED_H

#include "../text/suggest.h"

/* Room for a path. */
enum { SHIPPED_PATH = 4096 };

/*
 * Folder of the shipped scenes, the first of: PZS_SCENES of the environment;
 * share/piezoshape/scenes beside the folder of this program (installed); that of the clone around
 * the build folder of this program; that of the clone at the time of the build. The text is valid
 * until the next call.
 */
const char *shipped_folder(void);

/* Folder of the sources, for the firmware: PZS_SOURCES of the environment, then as above. Valid
 * until the next call. */
const char *shipped_sources(void);

/* The file of a scene: itself where `name` is a path or ends with .yaml, or that of a shipped one.
 */
void shipped_path(const char *name, char path[SHIPPED_PATH]);

/* Does `name` mean a shipped scene, not a file? */
int shipped_is_name(const char *name);

/* The shipped scene that a name was most likely meant to be. */
void shipped_suggest(suggestion *s, const char *name);

/* Call with the name of each shipped scene, in alphabetical order. Returns the sum of its results,
 * or -1: no such folder. */
typedef int shipped_visit(void *context, const char *name);
int shipped_each(shipped_visit *visit, void *context);

#endif
