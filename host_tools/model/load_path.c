/* SPDX-License-Identifier: BSD-2-Clause */
/* Release of the memory of a load path (load_path.h). */
#include "load_path.h"
#include <stdlib.h>
#include <string.h>

void load_path_free(load_path *path)
{
    free(path->value);
    free(path->event_value);
    free(path->row);
    memset(path, 0, sizeof *path);
}
