/* SPDX-License-Identifier: BSD-2-Clause */
/* The plant of a scene as an FMU: variables, tables and source files (fmu_parts.h). */
#include "fmu_parts.h"
#include <math.h>
#include <stdlib.h>
#include "../model/output_calls.h"
#include "../simulate/imperfections_scene.h"
#include "../simulate/plant.h"
#include "../tables/loop_blocks.h"

static const char *const sources[] = {"include/pzs_base.h",
                                      "include/pzs_config.h",
                                      "include/pzs_version.h",
                                      "lib/core/product.[ch]",
                                      "lib/core/product_inline.h",
                                      "lib/core/product_vfp.h",
                                      "lib/core/product_wide.h",
                                      "lib/core/linalg_wide.h",
                                      "lib/core/lane.h",
                                      "lib/core/unrolled.h",
                                      "host_tools/model/actuator_effect.[ch]",
                                      "host_tools/model/modal_tables.h",
                                      "host_tools/model/propagator.[ch]",
                                      "host_tools/simulate/amplifier.[ch]",
                                      "host_tools/simulate/imperfections.[ch]",
                                      "host_tools/simulate/inertia.[ch]",
                                      "host_tools/simulate/influence_sum.[ch]",
                                      "host_tools/simulate/random.[ch]",
                                      "host_tools/fmu/component/fmi2.h",
                                      "host_tools/fmu/component/fmi2_functions.c",
                                      "host_tools/fmu/component/fmu_model.h",
                                      "host_tools/fmu/component/plant_model.c",
                                      NULL};

/* ---- checks ----------------------------------------------------------- */

/*
 * Refuse a plant whose response cannot be written as constant matrices: a plant with a nonlinear
 * structure, or with sensors of charge, voltage or contact. Returns 0, or -1 with a message in
 * `error`.
 */
static int check_plant(const fmu *fmu, const plant *plant, char *error)
{
    const design *design = fmu->design;
    for (int i = 0; i < design->estimate.readings && loop_estimates(design); i++) {
        const scene_output *output = &design->output[design->estimate.reading[i].output];
        if (!output_has_rows(output))
            return scene_fault(design->estimate.reading[i].at, error,
                               "the plant of an FMU has sensors that are linear in the "
                               "displacement; '%s' is a %s",
                               output->name, scene_output_info_of(output->type)->word);
    }
    if (plant->analysis.is_nonlinear)
        return scene_fault(design->simulate.at, error,
                           "the plant of an FMU is linear; write simulate: {plant: {kinematics: "
                           "linear}}, or add --set simulate.plant.kinematics=linear");
    return imperfections_check(fmu->design, error);
}

/*
 * Return the number of simulation events of the scene that a simulator cannot repeat by setting the
 * inputs of the plant.
 */
static int count_left_out(const scene_simulate *simulate)
{
    int count = simulate->fault_chance > 0;
    for (int i = 0; i < simulate->events; i++) {
        const scene_event_type type = simulate->event[i].type;
        count += type != EVENT_TARGET && type != EVENT_VALUE && type != EVENT_LOAD &&
                 type != EVENT_TEMPERATURE;
    }
    return count;
}

/* ---- variables -------------------------------------------------------- */

/*
 * Return the value of a load factor before the first step of the FMU, which is 1 unless events of
 * the scene change it at tick 0. The index after the last load stands for the temperature change
 * (K), which is 0 unless events change it.
 *   load in  index of the load
 */
static double first_load(const fmu *fmu, int load)
{
    const scene_simulate *simulate = &fmu->design->simulate;
    const int loads = fmu->design->loads;
    double value = load < loads ? 1 : 0;
    for (int i = 0; i < simulate->events && simulate->event[i].tick == 0; i++) {
        const scene_event *event = &simulate->event[i];
        if (load < loads ? event->type == EVENT_LOAD && event->load == load
                         : event->type == EVENT_TEMPERATURE)
            value = event->size;
    }
    return value;
}

static void add_variables(fmu *fmu, const plant *plant, const double *start)
{
    fmu_variable load = {.role = FMU_INPUT,
                         .about = "factor of a load of the scene from the end of the step on"};
    fmu_variable heat = {.role = FMU_INPUT,
                         .about = "temperature change from the end of the step on"};
    fmu_add_amplifiers(fmu, (fmu_variable){.role = FMU_INPUT, .about = "command to an amplifier"},
                       "voltage", start);
    for (int k = 0; k < fmu->design->loads; k++) {
        load.start = first_load(fmu, k);
        fmu_add_indexed(fmu, load, "load", k);
    }
    heat.start = first_load(fmu, fmu->design->loads);
    words_unit(&fmu->design->units, QUANTITY_TEMPERATURE, heat.unit);
    if (plant->temperature >= 0)
        fmu_add(fmu, heat, "temperature", "");
    fmu_add_readings(fmu, FMU_OUTPUT);
    fmu_add_nodes(fmu, (fmu_variable){.role = FMU_OUTPUT, .about = "displacement"}, "shape", NULL);
    fmu_add_amplifiers(fmu, (fmu_variable){.role = FMU_OUTPUT, .about = "output of an amplifier"},
                       "amplifier", NULL);
    fmu_add(fmu,
            (fmu_variable){.type = FMU_INTEGER,
                           .role = FMU_PARAMETER,
                           .about = "seed of noise, drift and outliers",
                           .start = fmu->design->simulate.seed},
            "seed", "");
}

/* ---- tables ----------------------------------------------------------- */

/*
 * Rows of the matrices that describe the response of a plant, which are displacements of the target
 * nodes and, if the scene estimates the shape from sensors, displacements at these sensors.
 */
typedef struct plant_rows {
    int count, sensors, first_sensor; /* number of outputs that the FMU contains, number of sensors,
                                         and index of the first output that belongs to a sensor */
    int *row; /* [count] for each output that the FMU contains, its number among all outputs of the
                 structure */
    double *noise; /* [sensors] standard deviation of the noise of each sensor (unit of the reading)
                    */
    double *influence; /* [count][inputs] influence matrix: static displacement of each output that
                          the FMU contains per unit of each input */
    double *shape; /* [count][modes] displacement of each output that the FMU contains per unit of
                      the coordinate of each vibration mode */
} plant_rows;

static void close_rows(plant_rows *rows)
{
    free(rows->row);
    free(rows->noise);
    free(rows->influence);
    free(rows->shape);
}

/*
 * Append the outputs of the sensors from which the scene estimates the shape to the outputs that
 * the FMU of the plant contains.
 */
static void list_sensors(plant_rows *rows, const plant *plant)
{
    const scene_estimate *estimate = &plant->analysis.design.estimate;
    rows->first_sensor = rows->count;
    for (int k = 0; k < estimate->readings; k++) {
        const int output = estimate->reading[k].output;
        for (int i = 0; i < analysis_outputs(&plant->analysis, output); i++) {
            rows->row[rows->count++] = plant->analysis.design.named_first[output] + i;
            rows->noise[rows->sensors++] = estimate->reading[k].noise;
        }
    }
}

/*
 * Copy the rows of those outputs that the FMU contains from the influence matrix and from the
 * matrix of vibration mode shapes of the plant.
 */
static void copy_rows(plant_rows *rows, const plant *plant)
{
    const design *design = &plant->analysis.design;
    const size_t all = design->structure.input.count, modes = plant->modal.modes,
                 inputs = (size_t)(design->amplifiers + design->loads);
    for (size_t i = 0; i < (size_t)rows->count; i++) {
        const size_t row = (size_t)rows->row[i];
        for (size_t k = 0; k < inputs; k++)
            rows->influence[i * inputs + k] = plant->analysis.influence[row * all + k];
        for (size_t k = 0; k < modes; k++)
            rows->shape[i * modes + k] = plant->modal.shape[row * modes + k];
    }
}

static bool open_rows(plant_rows *rows, const plant *plant)
{
    const design *design = &plant->analysis.design;
    const size_t most = (size_t)design->targets + design->structure.output.count + 1;
    *rows = (plant_rows){.count = design->targets};
    rows->row = calloc(most, sizeof *rows->row);
    rows->noise = calloc(most, sizeof *rows->noise);
    rows->influence =
        calloc(most * (size_t)(design->amplifiers + design->loads), sizeof *rows->influence);
    rows->shape = calloc(most * (plant->modal.modes + 1), sizeof *rows->shape);
    if (!rows->row || !rows->noise || !rows->influence || !rows->shape)
        return false;
    for (int i = 0; i < design->targets; i++) {
        rows->row[i] = i;
        rows->noise[i] = plant->analysis.design.simulate.noise;
    }
    if (loop_estimates(&plant->analysis.design))
        list_sensors(rows, plant);
    else
        rows->sensors = design->targets;
    copy_rows(rows, plant);
    return true;
}

static void write_sizes(const plant *plant, const plant_rows *rows, FILE *file)
{
    const design *design = &plant->analysis.design;
    const scene_simulate *simulate = &plant->analysis.design.simulate;
    fprintf(
        file,
        "/* Tables of the plant (simulated structure): response to voltages and loads, vibration "
        "modes, amplifiers, sensors. Generated by `pzs fmu`; do not edit. */\n"
        "#define PLANT_AMPLIFIERS %d\n#define PLANT_LOADS %d\n#define PLANT_SENSORS %d\n"
        "#define PLANT_TARGETS %d\n#define PLANT_ROWS %d\n#define PLANT_FIRST_SENSOR %d\n"
        "#define PLANT_MODES %zu\n"
        "/* age of a sensor reading when a tick uses it (ticks) */\n#define PLANT_DELAY %d\n"
        "/* resolution of the amplifiers (V); dead band of the amplifiers (V) */\n"
        "#define PLANT_RESOLUTION %.17g\n#define PLANT_DEAD_BAND %.17g\n",
        design->amplifiers, design->loads, rows->sensors, design->targets, rows->count,
        rows->first_sensor, plant->modal.modes, simulate->delay, simulate->step,
        simulate->dead_band);
}

static void write_list(const char *name, const int *value, int count, FILE *file)
{
    fprintf(file, "static const int plant_%s[%d] = {0", name, count > 0 ? count : 1);
    for (int i = 0; i < count; i++)
        fprintf(file, i ? ", %d" : " + %d", value[i]);
    fputs("};\n", file);
}

static void write_imperfections(const imperfection_tables *tables, FILE *file)
{
    const actuator_curves *curves = &tables->curves;
    write_list("reversed", tables->reversed, tables->reversals, file);
    write_list("swapped", tables->swapped, tables->swaps, file);
    fprintf(file,
            "static const imperfection_tables plant_imperfections = {\n"
            "    .amplifiers = PLANT_AMPLIFIERS, .lower = plant_lower, .upper = plant_upper,\n"
            "    .hysteresis = %.17g, .bandwidth = %.17g, .creep = %.17g, .drift = %.17g,\n"
            "    .quantum = %.17g, .outlier_chance = %.17g, .outlier_size = %.17g,\n"
            "    .reversals = %d, .reversed = plant_reversed, .swaps = %d, .swapped = "
            "plant_swapped,\n"
            "    .curves = {%d, %d, plant_curve_voltage, plant_curve_effect, %s, %.17g}};\n",
            tables->hysteresis, tables->bandwidth, tables->creep, tables->drift, tables->quantum,
            tables->outlier_chance, tables->outlier_size, tables->reversals, tables->swaps,
            curves->sets, curves->points, curves->bend ? "plant_curve_bend" : "0", curves->error);
}

/* Write the arrays of the actuator curves; a plant with linear actuators has empty ones. */
static void write_curves(emitter *emitter, const actuator_curves *curves)
{
    const size_t sets = (size_t)curves->sets, points = sets * (size_t)curves->points;
    emit_reals(emitter, "curve_voltage", curves->voltage, points,
               "voltages of the points of each actuator curve (V)");
    emit_reals(emitter, "curve_effect", curves->effect, points, "effects at these points (V)");
    if (curves->bend)
        emit_reals(emitter, "curve_bend", curves->bend, points - sets,
                   "bends of the segments of each actuator curve");
}

static void write_arrays(emitter *emitter, const design *nominal, const plant_rows *rows,
                         const modal *modal, size_t inputs)
{
    const size_t amplifiers = (size_t)nominal->amplifiers, modes = modal->modes;
    emit_reals(emitter, "influence", rows->influence, (size_t)rows->count * inputs,
               "static displacement of each row per unit of each input (column)");
    emit_reals(emitter, "lower", nominal->lower, amplifiers, "lowest voltages (V)");
    emit_reals(emitter, "upper", nominal->upper, amplifiers, "highest voltages (V)");
    emit_reals(emitter, "step_limit", nominal->step_limit, amplifiers,
               "largest changes of the voltages in a tick (V)");
    emit_reals(emitter, "noise", rows->noise, (size_t)rows->sensors,
               "standard deviations of the noise of the sensors");
    emit_reals(emitter, "frequency", modal->frequency, modes, "angular frequencies (rad/s)");
    emit_reals(emitter, "damping", modal->damping, modes, "damping ratios of the modes");
    emit_reals(emitter, "mode_shape", rows->shape, (size_t)rows->count * modes,
               "displacement of each row per unit of each modal coordinate (column)");
    emit_reals(emitter, "response", modal->response, modes * inputs,
               "modal coordinate in equilibrium (row) per unit of each input (column)");
    fprintf(emitter->file,
            "static const modal plant_modal = {\n"
            "    PLANT_MODES, PLANT_ROWS, PLANT_AMPLIFIERS + PLANT_LOADS,\n"
            "    (double *)plant_frequency, (double *)plant_damping, (double *)plant_mode_shape,\n"
            "    (double *)plant_response};\n");
}

/*
 * Write the tables of the plant as a C header into the FMU. Returns whether memory was available.
 */
static bool write_tables(fmu *fmu, const plant *plant)
{
    const design *nominal = fmu->design, *design = &plant->analysis.design;
    const size_t inputs = (size_t)(design->amplifiers + design->loads);
    const imperfection_tables imperfections = imperfections_of_scene(nominal);
    plant_rows rows;
    FILE *file = open_rows(&rows, plant) ? fmu_begin_file(fmu, "fmu_tables.h") : NULL;
    if (file) {
        emitter emitter = {file, "plant", "PLANT", 0, 0, 0};
        write_sizes(plant, &rows, file);
        write_arrays(&emitter, nominal, &rows, &plant->modal, inputs);
        write_curves(&emitter, &imperfections.curves);
        write_imperfections(&imperfections, file);
        fmu_end_file(fmu);
    }
    close_rows(&rows);
    return file != NULL;
}

/* ---- the FMU ---------------------------------------------------------- */

/*
 * Return the voltages of the controller before its first tick (V): the reference voltages, clamped
 * to the voltage limits. The result is allocated memory, or NULL if memory runs out.
 */
static double *first_voltages(const design *design)
{
    double *voltage = calloc((size_t)design->amplifiers + 1, sizeof *voltage);
    for (int k = 0; k < design->amplifiers && voltage; k++)
        voltage[k] = fmin(fmax(design->reference_voltage[k], design->lower[k]), design->upper[k]);
    return voltage;
}

static int fill(fmu *fmu, const plant *plant, char *error)
{
    double *start = first_voltages(fmu->design);
    if (check_plant(fmu, plant, error) < 0) {
        free(start);
        return -1;
    }
    if (start)
        add_variables(fmu, plant, start);
    fmu->is_full |= !start || !write_tables(fmu, plant);
    free(start);
    return fmu_copy_sources(fmu, sources, error);
}

int fmu_fill_plant(fmu *fmu, fmu_summary *summary, char *error)
{
    plant plant;
    if (!fmu->design->simulate.given)
        return scene_fault(fmu->design->limits.at, error,
                           "no plant without the section simulate: add `simulate: {ticks: 400}`");
    if (plant_open(&plant, fmu->design, error) < 0)
        return -1;
    const int failed = fill(fmu, &plant, error);
    plant_close(&plant);
    summary->left_out = count_left_out(&fmu->design->simulate);
    return failed;
}
