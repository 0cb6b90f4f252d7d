/* SPDX-License-Identifier: BSD-2-Clause */
/* Names of critical points, and release of the memory of a load path (load_path.h). */
#include "load_path.h"
#include <stdlib.h>
#include <string.h>

const char *load_path_event_name(load_path_event_type type)
{
    static const char *const name[] = {[LOAD_PATH_LIMIT] = "limit point",
                                       [LOAD_PATH_BIFURCATION] = "bifurcation",
                                       [LOAD_PATH_STABILITY] = "change of stability"};
    typedef char all_named[sizeof name / sizeof *name == LOAD_PATH_EVENT_TYPES ? 1 : -1];
    (void)sizeof(all_named);
    return name[type];
}

void load_path_free(load_path *path)
{
    free(path->value);
    free(path->event_value);
    free(path->row);
    memset(path, 0, sizeof *path);
}
