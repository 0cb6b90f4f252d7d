/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Export of a scene as a functional mock-up unit (FMU) by FMI 2.0 for Co-Simulation: its plant as
 * `pzs simulate` runs it, or its controller as `pzs tables` writes it. An FMU is a ZIP archive with
 * a description of its variables, C sources and, if wanted, their shared library.
 */
#ifndef FMU_H
#define FMU_H

#include <stdbool.h>
#include <stdio.h>
#include "../model/analysis.h"

typedef enum fmu_kind { FMU_PLANT, FMU_CONTROLLER } fmu_kind;

/*
 * Write the name of an FMU: a C identifier made from the name of the scene and the type of the FMU
 * (plant or controller).
 *   name [FMU_IDENTIFIER] out  the identifier
 */
enum { FMU_IDENTIFIER = SCENE_NAME + 16 };
void fmu_identifier(const design *design, fmu_kind kind, char *name);

/* Numbers that describe a written FMU, for a message to the user. */
typedef struct fmu_summary {
    int inputs, outputs; /* number of input variables, and number of output variables, of the FMU */
    int left_out; /* number of simulation events of the scene that the FMU does not contain, such as
                     faults of electrodes and sensors */
    double period; /* period of a control tick, the length of each step of the FMU (s) */
} fmu_summary;

/*
 * Check, before anything is computed, that an FMU can be made of a scene: it needs a tick rate.
 * Returns 0, or -1 with a message in `error`.
 */
int fmu_check(const design *design, char *error);

/*
 * Write an FMU of a scene that fmu_check accepts, as a ZIP archive. The same scene gives the same
 * bytes, unless a shared library is built.
 *   nominal  in   analysis of the scene with influence matrix; for a controller, also with the
 *       tables of its firmware
 *   builds   in   true: compile the sources of the FMU with the C compiler of this computer
 *   summary  out  numbers that describe the FMU
 * Returns 0, or -1 with a message in `error`.
 */
int fmu_write(FILE *file, const analysis *nominal, fmu_kind kind, bool builds, fmu_summary *summary,
              char *error);

#endif
