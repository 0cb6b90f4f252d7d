/* SPDX-License-Identifier: BSD-2-Clause */
/* Blocks of the control tick that a scene needs (loop_blocks.h). */
#include "loop_blocks.h"
#include <ctype.h>
#include <string.h>

/* ---- conditions -------------------------------------------------------- */

int loop_estimates(const scene *scene)
{
    return scene->estimate.given && scene->simulate.sight != SIGHT_MEASURED;
}

int loop_feeds(const scene *scene)
{
    return scene->simulate.feeds;
}

int loop_quantises(const scene *scene)
{
    return scene->simulate.step > 0 || scene->simulate.dead_band > 0;
}

static int always(const scene *scene)
{
    (void)scene;
    return 1;
}

static int finds(const scene *scene)
{
    return scene->simulate.finds;
}

/* ---- tables for the host ---------------------------------------------- */

static const void *known_tables(loop_blocks *blocks)
{
    const int few = loop_estimates(blocks->design->scene);
    blocks->known_loads.shape = &blocks->estimator->shape_table;
    blocks->known_loads.readings = few ? &blocks->estimator->reading_table : NULL;
    return &blocks->known_loads;
}

static const void *estimator_tables(loop_blocks *blocks)
{
    return &blocks->estimator->tables;
}

static const void *problem_tables(loop_blocks *blocks)
{
    return &blocks->design->problem;
}

static const void *amplifier_tables(loop_blocks *blocks)
{
    blocks->amplifier.step = blocks->design->scene->simulate.step;
    blocks->amplifier.dead_band = blocks->design->scene->simulate.dead_band;
    return &blocks->amplifier;
}

static const void *detection_tables(loop_blocks *blocks)
{
    blocks->detection.delay = (uint16_t)blocks->design->scene->simulate.delay;
    return &blocks->detection;
}

/* ---- tables as source ------------------------------------------------- */

static void write_known(const emitter *emitter, const loop_blocks *blocks)
{
    fprintf(emitter->file,
            "/* feed-forward tables of shape and readings */\n"
            "static const pzs_known_loads %s_known_loads = {&%s_shape_feed_forward, ",
            emitter->prefix, emitter->prefix);
    if (blocks->known_loads.readings)
        fprintf(emitter->file, "&%s_reading_feed_forward};\n", emitter->prefix);
    else
        fputs("NULL};\n", emitter->file);
}

static void write_amplifier(const emitter *emitter, const loop_blocks *blocks)
{
    fprintf(emitter->file,
            "/* converter step and dead band of the amplifiers (V) */\n"
            "static const pzs_amplifier %s_amplifier = {PZS_R(%.17g), PZS_R(%.17g)};\n",
            emitter->prefix, blocks->amplifier.step, blocks->amplifier.dead_band);
}

static void write_detection(const emitter *emitter, const loop_blocks *blocks)
{
    fprintf(
        emitter->file,
        "/* delay of the measurements (ticks), amplitude of the test signal (V; 0: default) */\n"
        "static const pzs_fault_detection %s_fault_detection = {%u, PZS_R(%.17g)};\n",
        emitter->prefix, blocks->detection.delay, blocks->detection.amplitude);
}

/* ---- the table -------------------------------------------------------- */

/*
 * Types of blocks. The tables of a block are PREFIX_ and `tables_name` in a header; `bytes` is the
 * macro of its memory without PZS_, with % for the prefix in capitals.
 */
static const struct {
    const pzs_block_type *type;
    int (*is_present)(const scene *s);
    const void *(*tables)(loop_blocks *l);
    void (*write)(const emitter *w, const loop_blocks *l); /* NULL: the tables are written with
                                                              their arrays */
    const char *type_name, *tables_name, *bytes;
} block_types[] = {
    {&pzs_feed_forward_block, loop_feeds, known_tables, write_known, "feed_forward", "known_loads",
     "FEED_FORWARD_BLOCK_BYTES(%_READINGS, %_OUTPUTS)"},
    {&pzs_estimator_block, loop_estimates, estimator_tables, NULL, "estimator", "estimator",
     "ESTIMATOR_BLOCK_BYTES(%_READINGS, %_OUTPUTS)"},
    {&pzs_step_block, always, problem_tables, NULL, "step", "problem",
     "STEP_BLOCK_BYTES(%_INPUTS, %_OUTPUTS)"},
    {&pzs_amplifier_block, loop_quantises, amplifier_tables, write_amplifier, "amplifier",
     "amplifier", "AMPLIFIER_BLOCK_BYTES(%_INPUTS)"},
    {&pzs_fault_detector_block, finds, detection_tables, write_detection, "fault_detector",
     "fault_detection", "FAULT_DETECTOR_BLOCK_BYTES(%_INPUTS, %_OUTPUTS, %_DELAY)"},
};
enum { BLOCK_TYPES = sizeof block_types / sizeof *block_types };

void loop_blocks_fill(loop_blocks *blocks, const design *design, const estimator *estimator)
{
    memset(blocks, 0, sizeof *blocks);
    blocks->design = design;
    blocks->estimator = estimator;
    for (int k = 0; k < BLOCK_TYPES; k++)
        if (block_types[k].is_present(design->scene))
            blocks->block[blocks->count++] =
                (pzs_block){block_types[k].type, block_types[k].tables(blocks)};
}

/* ---- source ----------------------------------------------------------- */

/* Write the text of a macro with the prefix in capitals for each %. */
static void write_macro(const emitter *emitter, const char *text)
{
    for (; *text; text++) {
        if (*text == '%')
            fputs(emitter->upper, emitter->file);
        else
            fputc(*text, emitter->file);
    }
}

static void write_bytes(const emitter *emitter, const loop_blocks *blocks)
{
    fprintf(emitter->file, "#define %s_LOOP_BYTES \\\n    (PZS_LOOP_BYTES(%s_BLOCKS, %s_INPUTS)",
            emitter->upper, emitter->upper, emitter->upper);
    for (int k = 0; k < BLOCK_TYPES; k++) {
        if (!block_types[k].is_present(blocks->design->scene))
            continue;
        fputs(" + \\\n     PZS_", emitter->file);
        write_macro(emitter, block_types[k].bytes);
    }
    fputs(")\n\n", emitter->file);
}

void loop_blocks_write(emitter *emitter, const loop_blocks *blocks)
{
    const scene *scene = blocks->design->scene;
    for (int k = 0; k < BLOCK_TYPES; k++)
        if (block_types[k].write && block_types[k].is_present(scene))
            block_types[k].write(emitter, blocks);
    const int readings =
        loop_estimates(scene) ? blocks->estimator->sensors : blocks->design->targets;
    fprintf(emitter->file,
            "/* blocks of the control tick in the order in which they run; `pzs simulate` runs the "
            "same list */\n"
            "#define %s_BLOCKS %d\n#define %s_READINGS %d\n#define %s_DELAY %d\n"
            "static const pzs_block %s_blocks[%s_BLOCKS] = {\n",
            emitter->upper, blocks->count, emitter->upper, readings, emitter->upper,
            scene->simulate.delay, emitter->prefix, emitter->upper);
    for (int k = 0; k < BLOCK_TYPES; k++)
        if (block_types[k].is_present(scene))
            fprintf(emitter->file, "    {&pzs_%s_block, &%s_%s},\n", block_types[k].type_name,
                    emitter->prefix, block_types[k].tables_name);
    fputs("};\n", emitter->file);
    write_bytes(emitter, blocks);
}

/* ---- names ------------------------------------------------------------ */

/*
 * Write PREFIX_KIND_name = index. A name that is not a C identifier gets its index as a suffix, so
 * that different names stay different.
 */
static void write_index(const emitter *emitter, const char *kind, const char *name, int index)
{
    int changed = 0;
    fprintf(emitter->file, "    %s_%s_", emitter->upper, kind);
    for (; *name; name++) {
        const int fits = isalnum((unsigned char)*name) || *name == '_';
        fputc(fits ? *name : '_', emitter->file);
        changed |= !fits;
    }
    if (changed)
        fprintf(emitter->file, "_%d", index);
    fprintf(emitter->file, " = %d,\n", index);
}

static void write_amplifiers(const emitter *emitter, const design *design)
{
    char name[SCENE_LABEL];
    fputs("/* index of each amplifier in info.voltage and for pzs_hold */\nenum {\n",
          emitter->file);
    for (int k = 0; k < design->amplifiers; k++) {
        scene_amplifier_name(design->scene, k, name);
        write_index(emitter, "INPUT", name, k);
    }
    fputs("};\n", emitter->file);
}

/*
 * Indices of the estimator's readings: NAME, or NAME_1, NAME_2 ... where an output has several
 * values.
 */
static void write_sensors(const emitter *emitter, const analysis *analysis)
{
    const scene *scene = analysis->design.scene;
    char name[SCENE_NAME + 16];
    int index = 0;
    if (!loop_estimates(scene))
        return;
    fputs("/* index of each reading of the sensors */\nenum {\n", emitter->file);
    for (int r = 0; r < scene->estimate.readings; r++) {
        const scene_output *output = &scene->output[scene->estimate.reading[r].output];
        const int count = analysis_outputs(analysis, scene->estimate.reading[r].output);
        for (int i = 1; i <= count; i++) {
            if (count == 1)
                snprintf(name, sizeof name, "%s", output->name);
            else
                snprintf(name, sizeof name, "%s_%d", output->name, i);
            write_index(emitter, "SENSOR", name, index++);
        }
    }
    fputs("};\n", emitter->file);
}

static void write_outputs(const emitter *emitter, const design *design)
{
    static const char *const component[] = {"u1", "u2", "u3", "x", "y", "z"};
    static const char *const face[] = {[FACE_OUTER] = "outer face",
                                       [FACE_INNER] = "inner face",
                                       [FACE_MIDDLE] = "middle",
                                       [FACE_MEAN] = "mean of the faces"};
    const scene_output *what = &design->scene->target.what;
    fprintf(emitter->file,
            "/*\n * Outputs: displacement %s (%s), %s.\n * output  node  theta1  theta2\n",
            component[what->component], design->scene->unit_length, face[what->face]);
    for (int i = 0; i < design->targets; i++) {
        const double *theta = design->mesh.theta[design->target_node[i]];
        fprintf(emitter->file, " * %6d %5d  %.6g  %.6g\n", i, design->target_node[i], theta[0],
                theta[1]);
    }
    fputs(" */\n", emitter->file);
}

void loop_names_write(emitter *emitter, const analysis *analysis)
{
    const design *design = &analysis->design;
    if (design->scene->control.rate > 0) {
        fprintf(emitter->file, "#define %s_TICK_RATE PZS_R(", emitter->upper);
        emit_real(emitter->file, design->scene->control.rate);
        fputs(") /* ticks per second */\n", emitter->file);
    }
    write_amplifiers(emitter, design);
    write_sensors(emitter, analysis);
    write_outputs(emitter, design);
    fputs("\n", emitter->file);
}
