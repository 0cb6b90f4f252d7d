/* SPDX-License-Identifier: BSD-2-Clause */
/* The controller of a scene as an FMU: variables, tables and source files (fmu_parts.h). */
#include "fmu_parts.h"
#include "../tables/loop_blocks.h"
#include "../tables/tables.h"

static const char *const sources[] = {"include/pzs*.h",
                                      "lib/core/?*.[ch]",
                                      "lib/control/?*.[ch]",
                                      "host_tools/fmu/component/fmi2.h",
                                      "host_tools/fmu/component/fmi2_functions.c",
                                      "host_tools/fmu/component/fmu_model.h",
                                      "host_tools/fmu/component/controller_model.c",
                                      NULL};

/*
 * Return the number of loads of the scene whose factors are announced to the controller in advance.
 */
static int known_loads(const fmu *fmu)
{
    return loop_feeds(fmu->design) ? fmu->design->loads : 0;
}

/*
 * Whether the controller of the FMU has a supervisor, which takes commands and has an operating
 * mode.
 */
static bool is_supervised(const fmu *fmu)
{
    return loop_supervises(fmu->design, fmu->nominal->certificate.loop.is_made);
}

/*
 * Append the integer and text variables of a controller to an FMU: status and number of iterations,
 * and, if the scene has a supervisor, the command to the supervisor and its operating mode.
 */
static void add_states(fmu *fmu)
{
    const fmu_variable
        command = {.type = FMU_INTEGER,
                   .role = FMU_INPUT,
                   .about =
                       "command to the supervisor, a value of pzs_supervisor_command; 0: none"},
        status = {.type = FMU_INTEGER,
                  .role = FMU_OUTPUT,
                  .about = "status of the tick, a value of pzs_status; 0: no remark"},
        iterations = {.type = FMU_INTEGER,
                      .role = FMU_OUTPUT,
                      .about = "iterations of the optimiser"},
        mode = {.type = FMU_INTEGER,
                .role = FMU_OUTPUT,
                .about = "mode of the supervisor, a value of pzs_supervisor_mode"},
        text = {.type = FMU_STRING, .role = FMU_OUTPUT, .about = "status of the tick as a text"};
    if (is_supervised(fmu))
        fmu_add(fmu, command, "command", "");
    fmu_add(fmu, status, "status", "");
    fmu_add(fmu, iterations, "iterations", "");
    if (is_supervised(fmu))
        fmu_add(fmu, mode, "mode", "");
    fmu_add(fmu, text, "status_text", "");
}

static void add_variables(fmu *fmu)
{
    const design *design = fmu->design;
    const int loads = known_loads(fmu);
    const fmu_variable now = {.role = FMU_INPUT,
                              .about = "known factor of a load when the readings were taken"};
    const fmu_variable next = {.role = FMU_INPUT,
                               .about = "known factor of a load under the next voltages"};
    fmu_add_nodes(fmu, (fmu_variable){.role = FMU_INPUT, .about = "wanted displacement"}, "target",
                  design->target);
    fmu_add_readings(fmu, FMU_INPUT);
    for (int k = 0; k < loads; k++)
        fmu_add_indexed(fmu, now, "load_now", k);
    for (int k = 0; k < loads; k++)
        fmu_add_indexed(fmu, next, "load_next", k);
    fmu_add_amplifiers(fmu, (fmu_variable){.role = FMU_OUTPUT, .about = "voltage to apply"},
                       "voltage", NULL);
    add_states(fmu);
}

int fmu_fill_controller(fmu *fmu, char *error)
{
    tables_size size;
    add_variables(fmu);
    FILE *file = fmu_begin_file(fmu, "fmu_tables.h");
    if (file) {
        fmu->is_full |= tables_write(file, fmu->nominal, TABLES_CONTROL, "controller", &size) < 0;
        fprintf(file, "#define CONTROLLER_KNOWN_LOADS %d\n#define CONTROLLER_SUPERVISED %d\n",
                known_loads(fmu), is_supervised(fmu));
        fmu_end_file(fmu);
    }
    return fmu_copy_sources(fmu, sources, error);
}
