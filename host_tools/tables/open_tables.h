/* SPDX-License-Identifier: BSD-2-Clause */
/* Electrodes that are open while the structure of a device vibrates (pzs_modes_open_electrodes). */
#ifndef OPEN_TABLES_H
#define OPEN_TABLES_H

#include "../model/open_electrodes.h"
#include "emit.h"

typedef struct open_tables {
    pzs_electrodes all; /* electrodes of a design without tables of its own; otherwise empty */
    const pzs_electrodes *electrodes; /* tables of the electrodes: those of the design, or `all` */
    uint8_t *is_open; /* [electrodes->count] 1 where the electrode is open while the structure
                         vibrates */
    uint32_t count;   /* number of electrodes that are open */
} open_tables;

/*
 * Find the electrodes that are open in a circuit. The tables point into the design and into
 * themselves, so that they must not be copied. Returns 0, or -1 with error filled where memory runs
 * out; call open_tables_free in either case.
 */
int open_tables_make(open_tables *open, const design *design, electrode_circuit circuit,
                     char *error);
void open_tables_free(open_tables *open);

/* Write which electrodes are open, and the size of the memory that they take; nothing if none is.
 */
void open_tables_write(emitter *emitter, const open_tables *open, const design *design);

#endif
