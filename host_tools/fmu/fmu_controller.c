/* SPDX-License-Identifier: BSD-2-Clause */
/* Controller of a scene as an FMU: variables, tables, sources (fmu_parts.h). */
#include "fmu_parts.h"
#include "../tables/loop_blocks.h"
#include "../tables/tables.h"

static const char *const sources[] = {"include/*.h",
                                      "lib/core/*.[ch]",
                                      "lib/control/*.[ch]",
                                      "host_tools/fmu/component/fmi2.h",
                                      "host_tools/fmu/component/fmi2_functions.c",
                                      "host_tools/fmu/component/fmu_model.h",
                                      "host_tools/fmu/component/controller_model.c",
                                      NULL};

/* Number of loads of the scene whose factors the controller is told. */
static int known_loads(const fmu *fmu)
{
    return loop_feeds(fmu->design) ? fmu->design->loads : 0;
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
    fmu_add(fmu,
            (fmu_variable){.type = FMU_INTEGER,
                           .role = FMU_OUTPUT,
                           .about = "status of the tick, a value of pzs_status; 0: no remark"},
            "status", "");
    fmu_add(fmu,
            (fmu_variable){
                .type = FMU_INTEGER, .role = FMU_OUTPUT, .about = "iterations of the optimiser"},
            "iterations", "");
    fmu_add(fmu,
            (fmu_variable){
                .type = FMU_STRING, .role = FMU_OUTPUT, .about = "status of the tick as a text"},
            "status_text", "");
}

int fmu_fill_controller(fmu *fmu, char *error)
{
    const design *design = fmu->design;
    tables_size size;
    if (design->safety.given)
        return scene_fault(design->limits.at, error,
                           "the controller of an FMU has no inputs for the commands of a "
                           "supervisor; remove the section safety");
    add_variables(fmu);
    FILE *file = fmu_begin_file(fmu, "fmu_tables.h");
    if (file) {
        fmu->is_full |= tables_write(file, fmu->nominal, TABLES_CONTROL, "controller", &size) < 0;
        fprintf(file, "#define CONTROLLER_KNOWN_LOADS %d\n", known_loads(fmu));
        fmu_end_file(fmu);
    }
    return fmu_copy_sources(fmu, sources, error);
}
