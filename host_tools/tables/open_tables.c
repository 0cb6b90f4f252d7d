/* SPDX-License-Identifier: BSD-2-Clause */
/* Electrodes that are open while the structure of a device vibrates (open_tables.h). */
#include "open_tables.h"
#include <stdlib.h>
#include <string.h>
#include "../model/electrodes.h"

int open_tables_make(open_tables *open, const design *design, electrode_circuit circuit,
                     char *error)
{
    const bool has_tables = design->electrodes.count > 0;
    memset(open, 0, sizeof *open);
    if (!has_tables && circuit == CIRCUIT_OPEN &&
        electrodes_build_all(design, &open->all, error) < 0)
        return -1;
    open->electrodes = has_tables ? &design->electrodes : &open->all;
    open->is_open = calloc((size_t)open->electrodes->count + 1, sizeof *open->is_open);
    if (!open->is_open)
        return scene_fault(design->at, error, "out of memory");
    open->count = open_electrodes_mark(design, open->electrodes, circuit, open->is_open);
    return 0;
}

void open_tables_free(open_tables *open)
{
    electrodes_free(&open->all);
    free(open->is_open);
    memset(open, 0, sizeof *open);
}

void open_tables_write(emitter *emitter, const open_tables *open, const design *design)
{
    const char *upper = emitter->upper, *prefix = emitter->prefix;
    if (open->count == 0)
        return;
    emit_bytes(emitter, "modes_open", open->is_open, open->electrodes->count,
               "1 where the electrode is open while the structure vibrates");
    emit_comment(emitter,
                 "number of open electrodes, and memory of pzs_modes_open_electrodes, which takes "
                 "%s_electrodes and %s_modes_open after pzs_modes_init",
                 prefix, prefix);
    fprintf(emitter->file,
            "#define %s_MODES_OPEN %u\n#define %s_MODES_OPEN_BYTES PZS_MODES_OPEN_BYTES(%d, %u)\n",
            upper, (unsigned)open->count, upper, design->mesh.free_dof, (unsigned)open->count);
}
