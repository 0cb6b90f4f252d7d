/* The blocks around the control step that a scene asks for (loop_blocks.h). */
#include "loop_blocks.h"
#include <ctype.h>
#include <string.h>

/* ---- what a scene asks for -------------------------------------------- */

int loop_estimates(const scene *s)
{
    return s->estimate.given && s->simulate.sight != SIGHT_MEASURED;
}

int loop_feeds(const scene *s)
{
    return s->simulate.feeds;
}

int loop_quantises(const scene *s)
{
    return s->simulate.step > 0 || s->simulate.dead_band > 0;
}

static int always(const scene *s)
{
    (void)s;
    return 1;
}

static int finds(const scene *s)
{
    return s->simulate.finds;
}

/* ---- tables for the host ---------------------------------------------- */

static const void *known_tables(loop_blocks *l)
{
    const int few = loop_estimates(l->design->scene);
    l->known.shape = &l->estimator->known_tables;
    l->known.readings = few ? &l->estimator->shown_tables : NULL;
    return &l->known;
}

static const void *estimator_tables(loop_blocks *l)
{
    return &l->estimator->tables;
}

static const void *problem_tables(loop_blocks *l)
{
    return &l->design->problem;
}

static const void *amplifier_tables(loop_blocks *l)
{
    l->amplifier.step = l->design->scene->simulate.step;
    l->amplifier.dead_band = l->design->scene->simulate.dead_band;
    return &l->amplifier;
}

static const void *detection_tables(loop_blocks *l)
{
    l->detection.delay = (uint16_t)l->design->scene->simulate.delay;
    return &l->detection;
}

/* ---- tables as source ------------------------------------------------- */

static void write_known(const emitter *w, const loop_blocks *l)
{
    fprintf(w->file, "static const pzs_known_loads %s_known_loads = {&%s_known, ", w->prefix,
            w->prefix);
    if (l->known.readings)
        fprintf(w->file, "&%s_shown};\n", w->prefix);
    else
        fputs("NULL};\n", w->file);
}

static void write_amplifier(const emitter *w, const loop_blocks *l)
{
    fprintf(w->file,
            "/* step and dead band of the amplifiers (V) */\n"
            "static const pzs_amplifier %s_amplifier = {PZS_R(%.17g), PZS_R(%.17g)};\n",
            w->prefix, l->amplifier.step, l->amplifier.dead_band);
}

static void write_detection(const emitter *w, const loop_blocks *l)
{
    fprintf(w->file,
            "/* delay of the measurements (ticks); amplitude (V), 0: the default */\n"
            "static const pzs_fault_detection %s_fault_detection = {%u, PZS_R(%.17g)};\n",
            w->prefix, l->detection.delay, l->detection.amplitude);
}

/* ---- the table -------------------------------------------------------- */

/* A kind of block. Its tables are PREFIX_tables in a header; bytes is the macro of its memory,
 * after the prefix of the macros that stand as %. */
static const struct {
    const pzs_block_type *type;
    int (*is_present)(const scene *s);
    const void *(*tables)(loop_blocks *l);
    void (*write)(const emitter *w, const loop_blocks *l); /* NULL: written with its arrays */
    const char *type_name, *tables_name, *bytes;
} kinds[] = {
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
enum { KINDS = sizeof kinds / sizeof *kinds };

void loop_blocks_fill(loop_blocks *l, const design *d, const estimator *e)
{
    memset(l, 0, sizeof *l);
    l->design = d;
    l->estimator = e;
    for (int k = 0; k < KINDS; k++)
        if (kinds[k].is_present(d->scene))
            l->block[l->count++] = (pzs_block){kinds[k].type, kinds[k].tables(l)};
}

/* ---- source ----------------------------------------------------------- */

/* A macro's text, the prefix in capitals for each %. */
static void write_macro(const emitter *w, const char *text)
{
    for (; *text; text++) {
        if (*text == '%')
            fputs(w->upper, w->file);
        else
            fputc(*text, w->file);
    }
}

static void write_bytes(const emitter *w, const loop_blocks *l)
{
    fprintf(w->file, "#define %s_LOOP_BYTES \\\n    (PZS_LOOP_BYTES(%s_BLOCKS, %s_INPUTS)",
            w->upper, w->upper, w->upper);
    for (int k = 0; k < KINDS; k++) {
        if (!kinds[k].is_present(l->design->scene))
            continue;
        fputs(" + \\\n     PZS_", w->file);
        write_macro(w, kinds[k].bytes);
    }
    fputs(")\n\n", w->file);
}

void loop_blocks_write(emitter *w, const loop_blocks *l)
{
    const scene *s = l->design->scene;
    for (int k = 0; k < KINDS; k++)
        if (kinds[k].write && kinds[k].is_present(s))
            kinds[k].write(w, l);
    const int readings = loop_estimates(s) ? l->estimator->sensors : l->design->targets;
    fprintf(w->file,
            "/* blocks of the control tick, in its order: those of `pzs simulate` */\n"
            "#define %s_BLOCKS %d\n#define %s_READINGS %d\n#define %s_DELAY %d\n"
            "static const pzs_block %s_blocks[%s_BLOCKS] = {\n",
            w->upper, l->count, w->upper, readings, w->upper, s->simulate.delay, w->prefix,
            w->upper);
    for (int k = 0; k < KINDS; k++)
        if (kinds[k].is_present(s))
            fprintf(w->file, "    {&pzs_%s_block, &%s_%s},\n", kinds[k].type_name, w->prefix,
                    kinds[k].tables_name);
    fputs("};\n", w->file);
    write_bytes(w, l);
}

/* ---- names ------------------------------------------------------------ */

/* PREFIX_KIND_name = index. A name that is no C identifier gets its index behind it, so that two
 * names stay two. */
static void write_index(const emitter *w, const char *kind, const char *name, int index)
{
    int changed = 0;
    fprintf(w->file, "    %s_%s_", w->upper, kind);
    for (; *name; name++) {
        const int fits = isalnum((unsigned char)*name) || *name == '_';
        fputc(fits ? *name : '_', w->file);
        changed |= !fits;
    }
    if (changed)
        fprintf(w->file, "_%d", index);
    fprintf(w->file, " = %d,\n", index);
}

static void write_amplifiers(const emitter *w, const design *d)
{
    char name[SCENE_LABEL];
    fputs("/* indices of the amplifiers: info.voltage, pzs_hold */\nenum {\n", w->file);
    for (int k = 0; k < d->amplifiers; k++) {
        scene_amplifier_name(d->scene, k, name);
        write_index(w, "INPUT", name, k);
    }
    fputs("};\n", w->file);
}

/* Readings of an estimator: NAME, or NAME_1, NAME_2 ... where an output has several. */
static void write_sensors(const emitter *w, const analysis *a)
{
    const scene *s = a->design.scene;
    char name[SCENE_NAME + 16];
    int index = 0;
    if (!loop_estimates(s))
        return;
    fputs("/* indices of the readings */\nenum {\n", w->file);
    for (int r = 0; r < s->estimate.readings; r++) {
        const scene_output *output = &s->output[s->estimate.reading[r].output];
        const int count = analysis_outputs(a, s->estimate.reading[r].output);
        for (int i = 1; i <= count; i++) {
            if (count == 1)
                snprintf(name, sizeof name, "%s", output->name);
            else
                snprintf(name, sizeof name, "%s_%d", output->name, i);
            write_index(w, "SENSOR", name, index++);
        }
    }
    fputs("};\n", w->file);
}

static void write_outputs(const emitter *w, const design *d)
{
    static const char *const component[] = {"u1", "u2", "u3", "x", "y", "z"};
    static const char *const face[] = {[FACE_OUTER] = "outer face",
                                       [FACE_INNER] = "inner face",
                                       [FACE_MIDDLE] = "middle",
                                       [FACE_MEAN] = "mean of the faces"};
    const scene_output *what = &d->scene->target.what;
    fprintf(w->file, "/*\n * Outputs: displacement %s (%s), %s.\n * output  node  theta1  theta2\n",
            component[what->component], d->scene->unit_length, face[what->face]);
    for (int i = 0; i < d->targets; i++) {
        const double *theta = d->mesh.theta[d->target_node[i]];
        fprintf(w->file, " * %6d %5d  %.6g  %.6g\n", i, d->target_node[i], theta[0], theta[1]);
    }
    fputs(" */\n", w->file);
}

void loop_names_write(emitter *w, const analysis *a)
{
    const design *d = &a->design;
    if (d->scene->simulate.given) {
        fprintf(w->file, "#define %s_TICK_RATE PZS_R(", w->upper);
        emit_real(w->file, d->scene->simulate.rate);
        fputs(") /* ticks a second */\n", w->file);
    }
    write_amplifiers(w, d);
    write_sensors(w, a);
    write_outputs(w, d);
    fputs("\n", w->file);
}
