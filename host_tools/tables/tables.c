/* Generated C tables (tables.h). */
#include "tables.h"
#include <ctype.h>
#include <stdlib.h>
#include "../../lib/model/electrode.h"
#include "../../lib/control/control.h"
#include "../../lib/model/model.h"
#include "../../lib/core/guard.h"
#include "../../lib/model/shell.h"
#include "loop_blocks.h"
#include "tables_path.h"

const char *const tables_image_name[TABLES_IMAGES] = {"control", "linear", "nonlinear"};

/* ---- structure -------------------------------------------------------- */

static void write_elements(emitter *w, const mesh *m)
{
    fprintf(w->file, "/* nodes of each element */\nstatic const uint16_t %s_element[%d][4] = {",
            w->prefix, m->elements);
    for (int e = 0; e < m->elements; e++)
        fprintf(w->file, "%s{%u, %u, %u, %u},", e % 4 == 0 ? "\n    " : " ", m->element[e][0],
                m->element[e][1], m->element[e][2], m->element[e][3]);
    fputs("\n};\n", w->file);
    emit_count_bytes(w, m->element, (size_t)m->elements * sizeof *m->element);
}

/* Corner tables of every kind, member by member in the order of pzs_element_type. */
static void write_kinds(emitter *w, const mesh *m)
{
    static const int coupling[4] = {4, 2, 3, 3}, base[3] = {4, 2, 3};
    static const int modes[2] = {4, LAMINATE_PACKED}, warps[1] = {9};
    fprintf(
        w->file,
        "/* corner tables of each element kind */\nstatic const pzs_element_type %s_kind[%d] = {",
        w->prefix, m->kinds);
    for (int k = 0; k < m->kinds; k++) {
        const pzs_element_type *kind = &m->kind[k];
        fputs("{\n    ", w->file);
        emit_nested(w->file, &kind->s[0][0][0][0], coupling, 4);
        fputs(",\n    ", w->file);
        emit_nested(w->file, &kind->t[0][0][0][0], coupling, 4);
        fputs(",\n    ", w->file);
        emit_nested(w->file, &kind->g_mean[0][0][0], base, 3);
        fputs(",\n    ", w->file);
        emit_nested(w->file, &kind->g_diff[0][0][0], base, 3);
        fputs(",\n    ", w->file);
        emit_nested(w->file, kind->d[0], modes, 2);
        fputs(", PZS_R(", w->file);
        emit_real(w->file, kind->thickness);
        fputs("),\n    ", w->file);
        emit_nested(w->file, kind->warp, warps, 1);
        fputs("\n}, ", w->file);
        emit_count_reals(w, (const double *)kind, sizeof *kind / sizeof(double));
    }
    fputs("\n};\n", w->file);
}

static void write_rows(emitter *w, const char *name, const pzs_rows *rows, uint16_t count,
                       const char *meaning)
{
    char array[64];
    if (count == 0)
        return;
    const uint32_t terms = rows->start[count];
    fprintf(w->file, "/* %s */\n", meaning);
    snprintf(array, sizeof array, "%s_start", name);
    emit_longs(w, array, rows->start, count + 1u);
    snprintf(array, sizeof array, "%s_dof", name);
    emit_shorts(w, array, rows->dof, terms, "free unknowns");
    snprintf(array, sizeof array, "%s_value", name);
    emit_reals(w, array, rows->value, terms, "their weights");
}

static void name_rows(const emitter *w, const char *name, uint16_t count)
{
    if (count == 0)
        fputs("    {0, NULL, NULL, NULL},\n", w->file);
    else
        fprintf(w->file, "    {%u, %s_%s_start, %s_%s_dof, %s_%s_value},\n", count, w->prefix, name,
                w->prefix, name, w->prefix, name);
}

/* Padded entries of the factor for a tile of rows, the rule of linalg.h. */
static size_t padded_entries(const mesh *m, int tile)
{
    size_t entries = 0;
    for (int row = 0; row < m->dof; row += tile) {
        int left = row;
        for (int i = row; i < m->dof && i < row + tile; i++)
            if (m->first[i] < left)
                left = m->first[i];
        entries += (size_t)(row + tile - left / tile * tile) * (size_t)tile;
    }
    return entries;
}

/* The structure with its control part only: amplifiers as inputs, target nodes as outputs. */
static pzs_structure controlled(const analysis *a)
{
    pzs_structure s = a->design.structure;
    s.input.count = (uint16_t)a->design.amplifiers;
    s.output.count = (uint16_t)a->design.targets;
    s.crc = pzs_structure_crc(&s);
    return s;
}

static void write_structure(emitter *w, const analysis *a, tables_image image)
{
    const mesh *m = &a->design.mesh;
    const int whole = image == TABLES_NONLINEAR || a->design.electrodes.count > 0;
    const pzs_structure s = whole ? a->design.structure : controlled(a);
    const size_t packed = SHELL_PACKED(4 * (size_t)m->unknowns);
    const uint16_t counts[5] = {s.nodes, s.elements, s.types, s.dof_per_node, s.free_dof};
    w->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    write_elements(w, m);
    emit_shorts(w, "element_kind", m->element_kind, (size_t)m->elements, "kind of each element");
    emit_shorts(w, "node_dof", m->node_dof, (size_t)m->nodes * m->unknowns,
                "free unknown of each nodal unknown, or PZS_CONSTRAINED");
    emit_shorts(w, "first", m->first, (size_t)m->dof, "first column of each row of the factor");
    emit_reals(w, "stiffness", m->stiffness, (size_t)m->kinds * packed,
               "element matrices, packed lower triangles (N/m, N)");
    write_kinds(w, m);
    write_rows(w, "input", &s.input, s.input.count,
               whole ? "force per unit of each amplifier, load and extra input"
                     : "force per volt of each amplifier");
    write_rows(w, "output", &s.output, s.output.count,
               whole ? "displacement of each target node and output"
                     : "displacement of each target node");
    fprintf(w->file,
            "#define %s_DOF %d\n"
            "#define %s_MODEL_BYTES PZS_MODEL_BYTES(%d, PZS_BY_TILE(%zu, %zu, %zu))\n",
            w->upper, m->dof, w->upper, m->dof, padded_entries(m, 4), padded_entries(m, 8),
            padded_entries(m, 16));
    emit_begin(w, "structure", "structure", s.scene, s.crc);
    fprintf(
        w->file,
        " %u, %u, %u, %u, %u,\n    %s_element, %s_element_kind, %s_node_dof, %s_first, %s_stiffness, %s_kind,\n",
        s.nodes, s.elements, s.types, s.dof_per_node, s.free_dof, w->prefix, w->prefix, w->prefix,
        w->prefix, w->prefix, w->prefix);
    name_rows(w, "input", s.input.count);
    name_rows(w, "output", s.output.count);
    fputs("};\n\n", w->file);
}

/* ---- electrodes ------------------------------------------------------- */

/* Nothing where the scene has no sensors and asks for no charge. The workspaces: at rest, and at a
 * shape. */
static void write_electrodes(emitter *w, const analysis *a)
{
    const pzs_electrodes *t = &a->design.electrodes;
    if (t->count == 0)
        return;
    const uint32_t entries = t->direct.start[t->count], open = pzs_electrode_open_count(t);
    w->crc32 = GUARD_CRC_START;
    emit_shorts(w, "electrode_input", t->input, t->count,
                "input whose amount is the volts of each electrode");
    fprintf(w->file, "static const uint8_t %s_electrode_open[%u] = {", w->prefix, t->count);
    for (int k = 0; k < t->count; k++)
        fprintf(w->file, "%u,%s", t->open[k], k % 16 == 15 ? "\n    " : " ");
    fputs("};\n", w->file);
    emit_count_bytes(w, t->open, t->count);
    emit_longs(w, "electrode_start", t->direct.start, t->count + 1u);
    emit_shorts(w, "electrode_dof", t->direct.dof, entries,
                "inputs that draw charge while the shell is held");
    emit_reals(w, "electrode_value", t->direct.value, entries, "how much (C/V, C/K)");
    fprintf(w->file,
            "#define %s_ELECTRODES %u\n#define %s_ELECTRIC_BYTES PZS_ELECTRIC_BYTES(%u, %u, %u)\n"
            "#define %s_CIRCUIT_BYTES PZS_CIRCUIT_BYTES(%u, %u)\n",
            w->upper, t->count, w->upper, t->count, (unsigned)open, a->design.structure.input.count,
            w->upper, t->count, (unsigned)open);
    emit_begin(w, "electrodes", "electrodes", t->scene, t->crc);
    fprintf(
        w->file,
        " %u, %s_electrode_input, %s_electrode_open,\n    {%u, %s_electrode_start, %s_electrode_dof, %s_electrode_value},\n};\n\n",
        t->count, w->prefix, w->prefix, t->count, w->prefix, w->prefix, w->prefix);
}

/* ---- nonlinear image -------------------------------------------------- */

static int write_nonlinear(emitter *w, const analysis *a)
{
    write_structure(w, a, TABLES_NONLINEAR);
    write_electrodes(w, a);
    return tables_path(w, a);
}

/* ---- voltage problem -------------------------------------------------- */

static void write_problem(emitter *w, const analysis *a, tables_image image)
{
    const design *d = &a->design;
    const size_t n = (size_t)d->amplifiers, m = (size_t)d->targets;
    const int influence = image == TABLES_CONTROL;
    pzs_problem p = d->problem;
    if (!influence) {
        p.influence = NULL;
        p.hessian = NULL;
    }
    const uint16_t counts[2] = {p.inputs, p.outputs};
    w->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    if (influence) {
        emit_reals(w, "influence", p.influence, m * n,
                   d->free_functions > 0 ? "displacement of target node (row) per volt (column), "
                                           "free functions of the target taken out"
                                         : "displacement of target node (row) per volt (column)");
        if (p.hessian)
            emit_reals(w, "hessian", p.hessian, n * n, "B'W^2 B");
    }
    emit_reals(w, "weight", d->weight, m, "W");
    emit_limits(w, "lower", d->lower, n, 0, "voltage limits (V)");
    emit_limits(w, "upper", d->upper, n, 1, "(V)");
    emit_limits(w, "slew", d->slew, n, 1, "most change a step (V)");
    emit_reals(w, "prefer", d->prefer, n, "voltages preferred by the effort term (V)");
    w->crc32 = emit_crc_reals(w->crc32, &p.regularisation, 1);
    emit_begin(w, "problem", "problem", p.scene, pzs_problem_crc(&p));
    fprintf(
        w->file,
        " %zu, %zu,\n    %s%s, %s%s, %s_weight, %s_lower, %s_upper, %s_slew, %s_prefer, PZS_R(%.17g),\n};\n\n",
        n, m, influence ? w->prefix : "NULL", influence ? "_influence" : "",
        p.hessian ? w->prefix : "NULL", p.hessian ? "_hessian" : "", w->prefix, w->prefix,
        w->prefix, w->prefix, w->prefix, p.regularisation);
    if (image == TABLES_NONLINEAR)
        emit_reals(w, "target", d->target, m,
                   "displacement wanted of each target node, under the loads");
    else
        emit_reals(w, "target", d->wanted, m,
                   "displacement of each target node that the volts must make");
}

/* ---- memory of the device --------------------------------------------- */

/* Workspace and stack of an image in bytes, by the macros a firmware uses; `real` is what pzs_real
 * is there. */
#define NEED(real, k)                                                                              \
    {                                                                                              \
        typedef real pzs_real;                                                                     \
        if (controlled)                                                                            \
            need.work[k] += PZS_CONTROL_BYTES(d->amplifiers, d->targets);                          \
        if (image != TABLES_CONTROL)                                                               \
            need.work[k] += PZS_MODEL_BYTES(s->free_dof, padded_entries(&d->mesh, PZS_TILE));      \
        if (image == TABLES_LINEAR && controlled) /* the influence matrix made there */            \
            need.work[k] += sizeof(pzs_real) * (size_t)d->amplifiers * (size_t)d->targets;         \
        if (image == TABLES_NONLINEAR)                                                             \
            need.work[k] += PZS_SOLVER_BYTES(s->free_dof, s->elements, s->input.count) +           \
                            sizeof(pzs_real) * (size_t)s->input.count * s->output.count +          \
                            (d->scene->contact.given ? PZS_CONTACT_BYTES(s->nodes) : 0);           \
        if (image == TABLES_LINEAR && d->electrodes.count > 0)                                     \
            need.work[k] += PZS_ELECTRIC_BYTES(d->electrodes.count, open, s->input.count);         \
        if (image == TABLES_NONLINEAR && d->electrodes.count > 0)                                  \
            need.work[k] += PZS_CIRCUIT_BYTES(d->electrodes.count, open);                          \
        need.stack[k] = image == TABLES_NONLINEAR ? PZS_STACK_NONLINEAR : PZS_STACK_LINEAR;        \
    }

tables_memory tables_need(const analysis *a, tables_image image)
{
    const design *d = &a->design;
    const pzs_structure *s = &d->structure;
    const int controlled = d->problem.inputs > 0;
    const uint32_t open = pzs_electrode_open_count(&d->electrodes);
    tables_memory need = {{0, 0}, {0, 0}};
    NEED(float, 0)
    NEED(double, 1)
    return need;
}

/* ---- beside the controller -------------------------------------------- */

/* Gains of the estimator. */
static void write_estimator(emitter *w, const estimator *e)
{
    const pzs_estimator *t = &e->tables;
    const uint16_t counts[3] = {t->inputs, t->outputs, t->sensors};
    w->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    emit_reals(w, "direct", e->direct, (size_t)t->sensors * t->inputs,
               "what sensors (rows) show per volt (columns)");
    emit_reals(w, "gain", e->gain, (size_t)t->outputs * t->sensors,
               "shape (rows) per what sensors (columns) show besides");
    fprintf(w->file, "#define %s_SENSORS %u\n", w->upper, t->sensors);
    emit_begin(w, "estimator", "estimator", t->scene, t->crc);
    fprintf(w->file, " %u, %u, %u, %s_direct, %s_gain,\n};\n\n", t->inputs, t->outputs, t->sensors,
            w->prefix, w->prefix);
}

/* The shape, or what the sensors show, under each load of the scene, to be fed forward. */
static void write_known(emitter *w, const char *name, const pzs_feed_forward_table *t,
                        const char *meaning)
{
    char array[64];
    const uint16_t counts[2] = {t->inputs, t->outputs};
    w->crc32 = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    snprintf(array, sizeof array, "%s_per_load", name);
    emit_reals(w, array, t->sensitivity, (size_t)t->outputs * t->inputs, meaning);
    emit_begin(w, "feed_forward_table", name, t->scene, t->crc);
    fprintf(w->file, " %u, %u, %s_%s,\n};\n\n", t->inputs, t->outputs, w->prefix, array);
}

static int write_beside(emitter *w, const analysis *a)
{
    estimator e;
    loop_blocks blocks;
    char error[SCENE_ERROR];
    if (estimator_open(&e, a, error) < 0)
        return -1;
    if (e.known_tables.inputs > 0) {
        fprintf(w->file, "#define %s_LOADS %u\n", w->upper, e.known_tables.inputs);
        write_known(w, "known", &e.known_tables,
                    "displacement of target node (row) per load (column), 1: as the scene says");
    }
    if (e.known_tables.inputs > 0 && e.sensors > 0)
        write_known(w, "shown", &e.shown_tables, "what sensors (rows) show per load (column)");
    if (e.sensors > 0)
        write_estimator(w, &e);
    loop_blocks_fill(&blocks, &a->design, &e);
    loop_blocks_write(w, &blocks);
    loop_names_write(w, a);
    estimator_close(&e);
    return 0;
}

/* ---- header ----------------------------------------------------------- */

static void write_head(const emitter *w, const analysis *a, const char *image)
{
    const scene *s = a->design.scene;
    fprintf(
        w->file,
        "/*\n * Tables of scene %s, %s image. Made by `pzs tables`; do not edit.\n * %s\n"
        " * Lengths in %s, forces in %s, volts in %s.\n */\n"
        "#ifndef %s_TABLES_H\n#define %s_TABLES_H\n\n#include \"pzs.h\"\n\n"
        "#if PZS_TABLE_FORMAT != %u\n#error \"these tables were made for another version of the library: run `pzs tables` again\"\n#endif\n"
        "/* a program that needs one precision defines this as 32 or 64 before it includes the tables */\n"
        "#if defined(%s_REAL_BITS) && %s_REAL_BITS != PZS_REAL_BITS\n"
        "#error \"the program needs another precision: compile it and the library with its -DPZS_REAL_BITS\"\n#endif\n\n",
        s->name, image, s->about ? s->about : "", s->unit_length, s->unit_force, s->unit_voltage,
        w->upper, w->upper, PZS_TABLE_FORMAT, w->upper, w->upper);
}

/* What vibration makes of the control loop, in the words of the certificate. */
static void write_certificate(const emitter *w, const certificate *c)
{
    char text[3 * SCENE_ERROR];
    certificate_text(c, text);
    if (!text[0])
        return;
    fprintf(w->file, "/*\n * ");
    for (const char *p = text; *p; p++)
        fprintf(w->file, *p == '\n' ? "\n * " : "%c", *p);
    fputs("\n */\n", w->file);
    if (certificate_refuses(c))
        fprintf(w->file, "#define %s_QUASI_STATIC 1\n", w->upper);
    fputs("\n", w->file);
}

/* What a nonlinear image asks of its compilation. */
static void write_demands(const emitter *w, const analysis *a)
{
    fputs(
        "#if !PZS_NONLINEAR\n#error \"a nonlinear image: compile library and firmware with -DPZS_NONLINEAR=1\"\n#endif\n",
        w->file);
    if (!tables_fit_float(a))
        fprintf(
            w->file,
            "#if PZS_REAL_BITS == 32\n#error \"condition %.1e: above %.0e the nonlinear path needs double, -DPZS_REAL_BITS=64\"\n"
            "#endif\n",
            a->model.info.condition, TABLES_FLOAT_CONDITION);
    fputs("\n", w->file);
}

int tables_fit_float(const analysis *a)
{
    return a->model.info.condition < TABLES_FLOAT_CONDITION;
}

int tables_write(FILE *file, const analysis *a, tables_image image, const char *prefix,
                 tables_size *size)
{
    const int controlled = a->design.problem.inputs > 0;
    emitter w = {file, prefix, "", 0, 0, 0};
    int status = 0;
    for (size_t i = 0; prefix[i] && i + 1 < sizeof w.upper; i++)
        w.upper[i] = (char)toupper((unsigned char)prefix[i]);
    write_head(&w, a, tables_image_name[image]);
    if (image == TABLES_NONLINEAR)
        write_demands(&w, a);
    if (controlled)
        write_certificate(&w, &a->certificate);
    if (controlled)
        fprintf(
            file,
            "#define %s_INPUTS %d\n#define %s_OUTPUTS %d\n#define %s_CONTROL_BYTES PZS_CONTROL_BYTES(%d, %d)\n\n",
            w.upper, a->design.amplifiers, w.upper, a->design.targets, w.upper,
            a->design.amplifiers, a->design.targets);
    if (image == TABLES_NONLINEAR) {
        status = write_nonlinear(&w, a);
    } else if (image == TABLES_LINEAR) {
        write_structure(&w, a, image);
        write_electrodes(&w, a);
        fprintf(file, "#define %s_LINEAR 1\n", w.upper);
        if (a->design.electrodes.count > 0)
            fprintf(
                file,
                "/* columns of the influence made on the device; the first %s_INPUTS are the amplifiers' */\n#define %s_ALL_INPUTS %u\n",
                w.upper, w.upper, a->design.structure.input.count);
        fputs("\n", file);
    }
    if (controlled) {
        write_problem(&w, a, image);
        status = status == 0 ? write_beside(&w, a) : status;
    }
    fputs("#endif\n", file);
    *size = (tables_size){w.reals, w.bytes};
    return ferror(file) ? -1 : status;
}
