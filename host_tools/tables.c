/*
 * Generated C tables (tables.h). Numbers have 17 significant digits and are rounded once, by
 * the device's compiler, to its own real; the checksum is therefore given for both precisions.
 */
#include "tables.h"
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include "electrode.h"
#include "estimator.h"
#include "guard.h"
#include "shell.h"

const char *const tables_image_name[TABLES_IMAGES] = {"control", "linear", "nonlinear"};

/* ---- checksums -------------------------------------------------------- */

static uint32_t crc_reals_32(uint32_t crc, const double *x, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const float rounded = (float)x[i];
        crc = guard_crc(crc, &rounded, sizeof rounded);
    }
    return crc;
}

/* ---- arrays ----------------------------------------------------------- */

typedef struct writer {
    FILE *file;
    const char *prefix;
    char upper[64]; /* the prefix in capitals, for macros */
    uint32_t crc32; /* over what was written, reals rounded to float */
    tables_size size;
} writer;

/* Numbers that were written enter the checksum and the size. */
static void count_reals(writer *w, const double *x, size_t n)
{
    w->crc32 = crc_reals_32(w->crc32, x, n);
    w->size.reals += n;
}

static void count_bytes(writer *w, const void *x, size_t bytes)
{
    w->crc32 = guard_crc(w->crc32, x, bytes);
    w->size.bytes += bytes;
}

static void write_real(FILE *file, double x)
{
    if (isinf(x))
        fprintf(file, "%sHUGE_VAL", x < 0 ? "-" : "");
    else if (x == 0 && signbit(x)) /* -0 would be the integer 0 */
        fputs("-0.0", file);
    else
        fprintf(file, "%.17g", x);
}

/* Values of an initialiser, `columns` a line. */
static void list_reals(FILE *file, const double *x, size_t n, size_t columns)
{
    for (size_t i = 0; i < n; i++) {
        fputs(i % columns == 0 ? "\n    PZS_R(" : " PZS_R(", file);
        write_real(file, x[i]);
        fputs("),", file);
    }
}

static void write_reals(writer *w, const char *name, const double *x, size_t n, const char *meaning)
{
    fprintf(w->file, "/* %s */\nstatic const pzs_real %s_%s[%zu] = {", meaning, w->prefix, name, n ? n : 1);
    list_reals(w->file, x, n, 4);
    fputs(n ? "\n};\n" : "0};\n", w->file);
    count_reals(w, x, n);
}

/* Largest float not above x, or not below it. */
static double float_inside(double x, int upper)
{
    const float nearest = (float)x;
    const int outside = upper ? (double)nearest > x : (double)nearest < x;
    return (double)(outside ? nextafterf(nearest, upper ? -HUGE_VALF : HUGE_VALF) : nearest);
}

/* Limits: in float rounded towards the inside, so that no voltage passes the scene's own limit. */
static void write_limits(writer *w, const char *name, const double *x, size_t n, int upper, const char *meaning)
{
    fprintf(w->file, "/* %s */\nstatic const pzs_real %s_%s[%zu] = {", meaning, w->prefix, name, n);
    for (size_t i = 0; i < n; i++) {
        const double inside = float_inside(x[i], upper);
        fputs(i % 4 == 0 ? "\n    PZS_R(" : " PZS_R(", w->file);
        if (inside < x[i] || inside > x[i])
            fprintf(w->file, "PZS_BY_BITS(%.17g, %.17g)", inside, x[i]);
        else
            write_real(w->file, x[i]);
        fputs("),", w->file);
        count_reals(w, &inside, 1);
    }
    fputs("\n};\n", w->file);
}

static void write_shorts(writer *w, const char *name, const uint16_t *x, size_t n, const char *meaning)
{
    fprintf(w->file, "/* %s */\nstatic const uint16_t %s_%s[%zu] = {", meaning, w->prefix, name, n ? n : 1);
    for (size_t i = 0; i < n; i++)
        fprintf(w->file, "%s%u,", i % 16 == 0 ? "\n    " : " ", x[i]);
    fputs(n ? "\n};\n" : "0};\n", w->file);
    count_bytes(w, x, n * sizeof *x);
}

static void write_longs(writer *w, const char *name, const uint32_t *x, size_t n)
{
    fprintf(w->file, "static const uint32_t %s_%s[%zu] = {", w->prefix, name, n ? n : 1);
    for (size_t i = 0; i < n; i++)
        fprintf(w->file, "%s%uu,", i % 12 == 0 ? "\n    " : " ", (unsigned)x[i]);
    fputs(n ? "\n};\n" : "0};\n", w->file);
    count_bytes(w, x, n * sizeof *x);
}

/* Begin a table of the library: its format, scene, and checksum in either precision. */
static void begin_table(const writer *w, const char *type, const char *name, uint32_t scene, uint32_t crc)
{
    fprintf(w->file, "static const pzs_%s %s_%s = {\n    %uu, 0x%08xu, PZS_BY_BITS(0x%08xu, 0x%08xu),", type, w->prefix, name,
            PZS_TABLE_FORMAT, (unsigned)scene, (unsigned)~w->crc32, (unsigned)crc);
}

/* ---- structure -------------------------------------------------------- */

static void write_elements(writer *w, const mesh *m)
{
    fprintf(w->file, "/* nodes of each element */\nstatic const uint16_t %s_element[%d][4] = {", w->prefix, m->elements);
    for (int e = 0; e < m->elements; e++)
        fprintf(w->file, "%s{%u, %u, %u, %u},", e % 4 == 0 ? "\n    " : " ",
                m->element[e][0], m->element[e][1], m->element[e][2], m->element[e][3]);
    fputs("\n};\n", w->file);
    count_bytes(w, m->element, (size_t)m->elements * sizeof *m->element);
}

/*
 * Nested initialiser of an array with up to four lengths: every value in braces of its place.
 *   length [depth] in
 */
static const double *nested(FILE *file, const double *x, const int *length, int depth)
{
    fputs("{", file);
    for (int i = 0; i < length[0]; i++) {
        if (depth > 1) {
            x = nested(file, x, length + 1, depth - 1);
        } else {
            fputs("PZS_R(", file);
            write_real(file, *x++);
            fputs(")", file);
        }
        fputs(i + 1 < length[0] ? depth > 2 ? ",\n     " : ", " : "", file);
    }
    fputs("}", file);
    return x;
}

/* Corner tables of every kind, member by member in the order of pzs_kind. */
static void write_kinds(writer *w, const mesh *m)
{
    static const int coupling[4] = {4, 2, 3, 3}, base[3] = {4, 2, 3}, modes[2] = {4, LAMINATE_PACKED};
    fprintf(w->file, "/* corner tables of each element kind */\nstatic const pzs_kind %s_kind[%d] = {", w->prefix, m->kinds);
    for (int k = 0; k < m->kinds; k++) {
        const pzs_kind *kind = &m->kind[k];
        fputs("{\n    ", w->file);
        nested(w->file, &kind->s[0][0][0][0], coupling, 4);
        fputs(",\n    ", w->file);
        nested(w->file, &kind->t[0][0][0][0], coupling, 4);
        fputs(",\n    ", w->file);
        nested(w->file, &kind->g_mean[0][0][0], base, 3);
        fputs(",\n    ", w->file);
        nested(w->file, &kind->g_diff[0][0][0], base, 3);
        fputs(",\n    ", w->file);
        nested(w->file, kind->d[0], modes, 2);
        fputs(", PZS_R(", w->file);
        write_real(w->file, kind->thickness);
        fputs("), PZS_R(", w->file);
        write_real(w->file, kind->twist);
        fputs(")\n}, ", w->file);
        count_reals(w, (const double *)kind, sizeof *kind / sizeof(double));
    }
    fputs("\n};\n", w->file);
}

static void write_rows(writer *w, const char *name, const pzs_rows *rows, uint16_t count, const char *meaning)
{
    char array[64];
    if (count == 0)
        return;
    const uint32_t terms = rows->start[count];
    fprintf(w->file, "/* %s */\n", meaning);
    snprintf(array, sizeof array, "%s_start", name);
    write_longs(w, array, rows->start, count + 1u);
    snprintf(array, sizeof array, "%s_dof", name);
    write_shorts(w, array, rows->dof, terms, "free unknowns");
    snprintf(array, sizeof array, "%s_value", name);
    write_reals(w, array, rows->value, terms, "their weights");
}

static void name_rows(const writer *w, const char *name, uint16_t count)
{
    if (count == 0)
        fputs("    {0, NULL, NULL, NULL},\n", w->file);
    else
        fprintf(w->file, "    {%u, %s_%s_start, %s_%s_dof, %s_%s_value},\n", count, w->prefix, name, w->prefix, name, w->prefix, name);
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
    s.crc = guard_structure_crc(&s);
    return s;
}

static void write_structure(writer *w, const analysis *a, tables_image image)
{
    const mesh *m = &a->design.mesh;
    const int whole = image == TABLES_NONLINEAR || a->design.electrodes.count > 0;
    const pzs_structure s = whole ? a->design.structure : controlled(a);
    const size_t packed = SHELL_PACKED(4 * (size_t)m->unknowns);
    const uint16_t counts[5] = {s.nodes, s.elements, s.kinds, s.unknowns, s.dof};
    w->crc32 = guard_crc(GUARD_CRC_START, counts, sizeof counts);
    write_elements(w, m);
    write_shorts(w, "element_kind", m->element_kind, (size_t)m->elements, "kind of each element");
    write_shorts(w, "node_dof", m->node_dof, (size_t)m->nodes * m->unknowns, "free unknown of each nodal unknown, or PZS_FIXED");
    write_shorts(w, "first", m->first, (size_t)m->dof, "first column of each row of the factor");
    write_reals(w, "stiffness", m->stiffness, (size_t)m->kinds * packed, "element matrices, packed lower triangles (N/m, N)");
    write_kinds(w, m);
    write_rows(w, "input", &s.input, s.input.count, whole ? "force per unit of each amplifier, load and extra input" : "force per volt of each amplifier");
    write_rows(w, "output", &s.output, s.output.count, whole ? "displacement of each target node and output" : "displacement of each target node");
    fprintf(w->file,
            "#define %s_DOF %d\n"
            "#define %s_MODEL_BYTES PZS_MODEL_BYTES(%d, PZS_BY_TILE(%zu, %zu, %zu))\n",
            w->upper, m->dof, w->upper, m->dof, padded_entries(m, 4), padded_entries(m, 8), padded_entries(m, 16));
    begin_table(w, "structure", "structure", s.scene, s.crc);
    fprintf(w->file, " %u, %u, %u, %u, %u,\n    %s_element, %s_element_kind, %s_node_dof, %s_first, %s_stiffness, %s_kind,\n",
            s.nodes, s.elements, s.kinds, s.unknowns, s.dof, w->prefix, w->prefix, w->prefix, w->prefix, w->prefix, w->prefix);
    name_rows(w, "input", s.input.count);
    name_rows(w, "output", s.output.count);
    fputs("};\n\n", w->file);
}

/* ---- electrodes ------------------------------------------------------- */

/* Nothing where the scene has no sensors and asks for no charge. The workspaces: at rest, and at a shape. */
static void write_electrodes(writer *w, const analysis *a)
{
    const pzs_electrodes *t = &a->design.electrodes;
    if (t->count == 0)
        return;
    const uint32_t entries = t->direct.start[t->count], open = electrode_open_count(t);
    w->crc32 = GUARD_CRC_START;
    write_shorts(w, "electrode_input", t->input, t->count, "input whose amount is the volts of each electrode");
    fprintf(w->file, "static const uint8_t %s_electrode_open[%u] = {", w->prefix, t->count);
    for (int k = 0; k < t->count; k++)
        fprintf(w->file, "%u,%s", t->open[k], k % 16 == 15 ? "\n    " : " ");
    fputs("};\n", w->file);
    count_bytes(w, t->open, t->count);
    write_longs(w, "electrode_start", t->direct.start, t->count + 1u);
    write_shorts(w, "electrode_dof", t->direct.dof, entries, "inputs that draw charge while the shell is held");
    write_reals(w, "electrode_value", t->direct.value, entries, "how much (C/V, C/K)");
    fprintf(w->file, "#define %s_ELECTRODES %u\n#define %s_ELECTRIC_BYTES PZS_ELECTRIC_BYTES(%u, %u, %u)\n"
            "#define %s_CIRCUIT_BYTES PZS_CIRCUIT_BYTES(%u, %u)\n",
            w->upper, t->count, w->upper, t->count, (unsigned)open, a->design.structure.input.count, w->upper, t->count, (unsigned)open);
    begin_table(w, "electrodes", "electrodes", t->scene, t->crc);
    fprintf(w->file, " %u, %s_electrode_input, %s_electrode_open,\n    {%u, %s_electrode_start, %s_electrode_dof, %s_electrode_value},\n};\n\n",
            t->count, w->prefix, w->prefix, t->count, w->prefix, w->prefix, w->prefix);
}

/* ---- nonlinear path --------------------------------------------------- */

/* n blocks of reals. length [depth] in: those of one block. */
static void write_blocks(writer *w, const char *name, const double *x, size_t n, const int *length, int depth, const char *meaning)
{
    size_t size = 1;
    fprintf(w->file, "/* %s */\nstatic const pzs_real %s_%s[%zu]", meaning, w->prefix, name, n);
    for (int i = 0; i < depth; i++) {
        fprintf(w->file, "[%d]", length[i]);
        size *= (size_t)length[i];
    }
    fputs(" = {", w->file);
    for (size_t i = 0; i < n; i++) {
        fputs("\n    ", w->file);
        nested(w->file, x + i * size, length, depth);
        fputs(",", w->file);
    }
    fputs("\n};\n", w->file);
    count_reals(w, x, n * size);
}

/* Actuation, temperature and prescribed displacements. */
static void write_path(writer *w, const pzs_nonlinear *t, uint16_t inputs)
{
    const int strains = LAMINATE_STRAINS;
    const uint32_t entries = t->given.start ? t->given.start[inputs] : 0;
    w->crc32 = GUARD_CRC_START;
    if (entries > 0) {
        fputs("/* elements on which each input acts by resultants */\n", w->file);
        write_longs(w, "given_start", t->given.start, inputs + 1u);
        write_shorts(w, "given_element", t->given.element, entries, "element");
        write_shorts(w, "given_which", t->given.which, entries, "row of the resultants");
        write_blocks(w, "given_value", *t->given.value, t->given.values, &strains, 1, "resultants per unit of an input (N m)");
    }
    if (t->prescribed.count > 0) {
        w->crc32 = guard_crc(w->crc32, &t->prescribed.input, sizeof t->prescribed.input);
        write_shorts(w, "prescribed_dof", t->prescribed.dof, t->prescribed.count, "free unknowns that are moved");
        write_reals(w, "prescribed_value", t->prescribed.value, t->prescribed.count, "by");
    }
    begin_table(w, "nonlinear", "nonlinear", t->scene, t->crc);
    if (entries > 0)
        fprintf(w->file, "\n    {%u, %s_given_start, %s_given_element, %s_given_which, %s_given_value},\n", t->given.values,
                w->prefix, w->prefix, w->prefix, w->prefix);
    else
        fputs("\n    {0, NULL, NULL, NULL, NULL},\n", w->file);
    if (t->prescribed.count > 0)
        fprintf(w->file, "    {%u, %u, %s_prescribed_dof, %s_prescribed_value},\n};\n\n", t->prescribed.count, t->prescribed.input,
                w->prefix, w->prefix);
    else
        fputs("    {0, 0, NULL, NULL},\n};\n\n", w->file);
}

static void list_vector(writer *w, const double x[3])
{
    const int length = 3;
    nested(w->file, x, &length, 1);
}

/* CRC of a follower load's tables, reals rounded to float. */
static uint32_t follower_crc_32(const pzs_follower *t, const mesh *m)
{
    const uint16_t whole[4] = {t->input, t->load_face, t->normal_face, t->true_area};
    uint32_t crc = guard_crc(GUARD_CRC_START, whole, sizeof whole);
    crc = crc_reals_32(crc, t->share, 3);
    crc = crc_reals_32(crc, *t->area, 4 * (size_t)m->kinds);
    if (t->lean)
        crc = crc_reals_32(crc, **t->lean, 8 * (size_t)m->kinds);
    return ~crc_reals_32(crc, t->pressure, (size_t)m->nodes);
}

static void write_followers(writer *w, const path *p)
{
    const mesh *m = &p->design->mesh;
    const int corners = 4, lean[2] = {4, 2};
    char name[64];
    for (int k = 0; k < p->followers; k++) {
        snprintf(name, sizeof name, "follower_area_%d", k);
        write_blocks(w, name, *p->follower[k].area, (size_t)m->kinds, &corners, 1, "area of each corner, by kind");
        snprintf(name, sizeof name, "follower_lean_%d", k);
        if (p->follower[k].lean)
            write_blocks(w, name, **p->follower[k].lean, (size_t)m->kinds, lean, 2, "lean of the base vectors of each corner, by kind");
        snprintf(name, sizeof name, "follower_pressure_%d", k);
        write_reals(w, name, p->follower[k].pressure, (size_t)m->nodes, "pressure of each node");
    }
    fprintf(w->file, "#define %s_FOLLOWERS %d\n", w->upper, p->followers);
    if (p->followers > 0)
        fprintf(w->file, "static const pzs_follower %s_follower[%d] = {\n", w->prefix, p->followers);
    for (int k = 0; k < p->followers; k++) {
        const pzs_follower *f = &p->follower[k];
        fprintf(w->file, "    {%uu, 0x%08xu, PZS_BY_BITS(0x%08xu, 0x%08xu), %u, %u, %u, %u, ", f->format, (unsigned)f->scene,
                (unsigned)follower_crc_32(f, m), (unsigned)f->crc, f->input, f->load_face, f->normal_face, f->true_area);
        list_vector(w, f->share);
        fprintf(w->file, ", %s_follower_area_%d, ", w->prefix, k);
        if (f->lean)
            fprintf(w->file, "%s_follower_lean_%d", w->prefix, k);
        else
            fputs("NULL", w->file);
        fprintf(w->file, ", %s_follower_pressure_%d},\n", w->prefix, k);
    }
    fputs(p->followers > 0 ? "};\n\n" : "\n", w->file);
}

/* The face that may touch, and the body; a body given by a formula wants a distance function of the firmware's own. */
static void write_contact(writer *w, const path *p)
{
    static const char *const gap[] = {[BODY_PLANE] = "pzs_gap_plane", [BODY_CYLINDER] = "pzs_gap_cylinder", [BODY_SPHERE] = "pzs_gap_sphere"};
    static const int matrix[2] = {3, 3};
    const scene_contact *contact = &p->design->scene->contact;
    const size_t nodes = (size_t)p->design->mesh.nodes;
    const pzs_contact_face *face = &p->face;
    if (!contact->given)
        return;
    const uint16_t whole[2] = {face->face, face->input};
    w->crc32 = guard_crc(GUARD_CRC_START, whole, sizeof whole);
    w->crc32 = crc_reals_32(w->crc32, face->motion, 3);
    w->crc32 = crc_reals_32(w->crc32, &face->size, 1);
    write_blocks(w, "contact_place", *face->place, nodes, matrix, 1, "places of the face that may touch, at rest");
    write_blocks(w, "contact_triad", **face->triad, nodes, matrix, 2, "their triads");
    write_reals(w, "contact_area", face->area, nodes, "their areas");
    fprintf(w->file, "static const pzs_contact_face %s_contact_face = {\n    %uu, 0x%08xu, PZS_BY_BITS(0x%08xu, 0x%08xu), %u, %u, ",
            w->prefix, face->format, (unsigned)face->scene, (unsigned)~w->crc32, (unsigned)face->crc, face->face, face->input);
    list_vector(w, face->motion);
    fprintf(w->file, ", PZS_R(%.17g), %s_contact_place, %s_contact_triad, %s_contact_area,\n};\n",
            face->size, w->prefix, w->prefix, w->prefix);
    if (contact->body.type == BODY_PSI)
        fprintf(w->file, "#ifndef %s_GAP\n#error \"the body is a formula: define %s_GAP as its distance function (pzs_body.gap)\"\n#endif\n",
                w->upper, w->upper);
    fprintf(w->file, "static const pzs_body %s_body = {\n    %s%s, ", w->prefix,
            contact->body.type == BODY_PSI ? w->upper : gap[contact->body.type], contact->body.type == BODY_PSI ? "_GAP" : "");
    list_vector(w, p->body.point);
    fputs(", ", w->file);
    list_vector(w, p->body.axis);
    fprintf(w->file, ", PZS_R(%.17g), NULL,\n};\n#define %s_CONTACT_BYTES PZS_CONTACT_BYTES(%zu)\n"
            "#define %s_CONTACT_STIFFNESS PZS_R(%.17g)\n\n", p->body.radius, w->upper, nodes, w->upper, p->contact.stiffness);
}

/* Sizes and choices of the path, and what the host found with them. */
static int write_equilibrium(writer *w, const analysis *a)
{
    const pzs_structure *s = &a->design.structure;
    const pzs_path *run = &a->path.run;
    double *reached = calloc((size_t)s->output.count + 1, sizeof *reached);
    if (!reached)
        return -1;
    fprintf(w->file,
            "#define %s_ALL_INPUTS %u\n#define %s_ALL_OUTPUTS %u\n#define %s_PATH_BYTES PZS_PATH_BYTES(%u, %u, %u)\n\n"
            "/* choices of the scene, for the path */\n#define %s_STEPS %u\n#define %s_MIXED %u\n#define %s_SYSTEMS %u\n"
            "#define %s_CHANGE PZS_R(%.17g)\n\n",
            w->upper, s->input.count, w->upper, s->output.count, w->upper, s->dof, s->elements, s->input.count,
            w->upper, run->steps, w->upper, run->mixed, w->upper, (unsigned)run->systems_allowed, w->upper, run->change);
    write_reals(w, "full", a->path.full, s->input.count, "amounts of the scene: applied volts, loads, extra inputs");
    pzs_observe(s, run->u, reached);
    if (s->output.count > 0)
        write_reals(w, "reached", reached, s->output.count, "outputs under these amounts, as the host found them in double");
    fputs("\n", w->file);
    free(reached);
    return 0;
}

static int write_nonlinear(writer *w, const analysis *a)
{
    write_structure(w, a, TABLES_NONLINEAR);
    write_electrodes(w, a);
    write_path(w, &a->path.tables, a->design.structure.input.count);
    write_followers(w, &a->path);
    write_contact(w, &a->path);
    return write_equilibrium(w, a);
}

/* ---- voltage problem -------------------------------------------------- */

static void write_problem(writer *w, const analysis *a, tables_image image)
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
    w->crc32 = guard_crc(GUARD_CRC_START, counts, sizeof counts);
    if (influence) {
        write_reals(w, "influence", p.influence, m * n, "displacement of target node (row) per volt (column)");
        if (p.hessian)
            write_reals(w, "hessian", p.hessian, n * n, "B'W^2 B");
    }
    write_reals(w, "weight", d->weight, m, "W");
    write_limits(w, "lower", d->lower, n, 0, "voltage limits (V)");
    write_limits(w, "upper", d->upper, n, 1, "(V)");
    write_limits(w, "slew", d->slew, n, 1, "most change a step (V)");
    write_reals(w, "prefer", d->prefer, n, "voltages preferred by the effort term (V)");
    w->crc32 = crc_reals_32(w->crc32, &p.effort, 1);
    begin_table(w, "problem", "problem", p.scene, guard_problem_crc(&p));
    fprintf(w->file, " %zu, %zu,\n    %s%s, %s%s, %s_weight, %s_lower, %s_upper, %s_slew, %s_prefer, PZS_R(%.17g),\n};\n\n", n, m,
            influence ? w->prefix : "NULL", influence ? "_influence" : "", p.hessian ? w->prefix : "NULL", p.hessian ? "_hessian" : "",
            w->prefix, w->prefix, w->prefix, w->prefix, w->prefix, p.effort);
    if (image == TABLES_NONLINEAR)
        write_reals(w, "target", d->target, m, "displacement wanted of each target node, under the loads");
    else
        write_reals(w, "target", d->wanted, m, "displacement of each target node that the volts must make");
}

/* ---- memory of the device --------------------------------------------- */

/* Workspace and stack of an image in bytes, by the macros a firmware uses; `real` is what pzs_real is there. */
#define NEED(real, k)                                                                                                       \
    {                                                                                                                      \
        typedef real pzs_real;                                                                                             \
        if (controlled)                                                                                                    \
            need.work[k] += PZS_CONTROL_BYTES(d->amplifiers, d->targets);                                                  \
        if (image != TABLES_CONTROL)                                                                                       \
            need.work[k] += PZS_MODEL_BYTES(s->dof, padded_entries(&d->mesh, PZS_TILE));                                   \
        if (image == TABLES_LINEAR && controlled) /* the influence matrix made there */                                    \
            need.work[k] += sizeof(pzs_real) * (size_t)d->amplifiers * (size_t)d->targets;                                 \
        if (image == TABLES_NONLINEAR)                                                                                     \
            need.work[k] += PZS_PATH_BYTES(s->dof, s->elements, s->input.count)                                            \
                          + sizeof(pzs_real) * (size_t)s->input.count * s->output.count                                    \
                          + (d->scene->contact.given ? PZS_CONTACT_BYTES(s->nodes) : 0);                                   \
        if (image == TABLES_LINEAR && d->electrodes.count > 0)                                                             \
            need.work[k] += PZS_ELECTRIC_BYTES(d->electrodes.count, open, s->input.count);                                 \
        if (image == TABLES_NONLINEAR && d->electrodes.count > 0)                                                          \
            need.work[k] += PZS_CIRCUIT_BYTES(d->electrodes.count, open);                                                  \
        need.stack[k] = image == TABLES_NONLINEAR ? PZS_STACK_NONLINEAR : PZS_STACK_LINEAR;                                \
    }

tables_memory tables_need(const analysis *a, tables_image image)
{
    const design *d = &a->design;
    const pzs_structure *s = &d->structure;
    const int controlled = d->problem.inputs > 0;
    const uint32_t open = electrode_open_count(&d->electrodes);
    tables_memory need = {{0, 0}, {0, 0}};
    NEED(float, 0)
    NEED(double, 1)
    return need;
}

/* ---- beside the controller -------------------------------------------- */

/* Gains of the estimator. */
static void write_estimator(writer *w, const estimator *e)
{
    const pzs_estimator *t = &e->tables;
    const uint16_t counts[3] = {t->inputs, t->outputs, t->sensors};
    w->crc32 = guard_crc(GUARD_CRC_START, counts, sizeof counts);
    write_reals(w, "direct", e->direct, (size_t)t->sensors * t->inputs, "what sensors (rows) show per volt (columns)");
    write_reals(w, "gain", e->gain, (size_t)t->outputs * t->sensors, "shape (rows) per what sensors (columns) show besides");
    fprintf(w->file, "#define %s_SENSORS %u\n", w->upper, t->sensors);
    begin_table(w, "estimator", "estimator", t->scene, t->crc);
    fprintf(w->file, " %u, %u, %u, %s_direct, %s_gain,\n};\n\n", t->inputs, t->outputs, t->sensors, w->prefix, w->prefix);
}

/* The shape, or what the sensors show, under each load of the scene, to be fed forward. */
static void write_known(writer *w, const char *name, const pzs_known *t, const char *meaning)
{
    char array[64];
    const uint16_t counts[2] = {t->amounts, t->outputs};
    w->crc32 = guard_crc(GUARD_CRC_START, counts, sizeof counts);
    snprintf(array, sizeof array, "%s_per_load", name);
    write_reals(w, array, t->per, (size_t)t->outputs * t->amounts, meaning);
    begin_table(w, "known", name, t->scene, t->crc);
    fprintf(w->file, " %u, %u, %s_%s,\n};\n\n", t->amounts, t->outputs, w->prefix, array);
}

static int write_beside(writer *w, const analysis *a)
{
    estimator e;
    char error[SCENE_ERROR];
    if (estimator_open(&e, a, error) < 0)
        return -1;
    if (e.known_tables.amounts > 0) {
        fprintf(w->file, "#define %s_LOADS %u\n", w->upper, e.known_tables.amounts);
        write_known(w, "known", &e.known_tables, "displacement of target node (row) per load (column), 1: as the scene says");
    }
    if (e.known_tables.amounts > 0 && e.sensors > 0)
        write_known(w, "shown", &e.shown_tables, "what sensors (rows) show per load (column)");
    if (e.sensors > 0)
        write_estimator(w, &e);
    estimator_close(&e);
    return 0;
}

/* ---- header ----------------------------------------------------------- */

static void write_head(const writer *w, const analysis *a, const char *image)
{
    const scene *s = a->design.scene;
    fprintf(w->file,
            "/*\n * Tables of scene %s, %s image. Made by `pzs tables`; do not edit.\n * %s\n"
            " * Lengths in %s, forces in %s, volts in %s.\n */\n"
            "#ifndef %s_TABLES_H\n#define %s_TABLES_H\n\n#include \"pzs.h\"\n\n"
            "#if PZS_TABLE_FORMAT != %u\n#error \"these tables were made for another version of the library: run `pzs tables` again\"\n#endif\n\n",
            s->name, image, s->about ? s->about : "", s->unit_length, s->unit_force, s->unit_voltage, w->upper, w->upper, PZS_TABLE_FORMAT);
}

/* What a nonlinear image asks of its compilation. */
static void write_demands(const writer *w, const analysis *a)
{
    fputs("#if !PZS_NONLINEAR\n#error \"a nonlinear image: compile library and firmware with -DPZS_NONLINEAR=1\"\n#endif\n", w->file);
    if (!tables_fit_float(a))
        fprintf(w->file, "#if PZS_REAL_BITS == 32\n#error \"condition %.1e: above %.0e the nonlinear path needs double, -DPZS_REAL_BITS=64\"\n"
                "#endif\n", a->model.condition, TABLES_FLOAT_CONDITION);
    fputs("\n", w->file);
}

int tables_fit_float(const analysis *a)
{
    return a->model.condition < TABLES_FLOAT_CONDITION;
}

int tables_write(FILE *file, const analysis *a, tables_image image, const char *prefix, tables_size *size)
{
    const int controlled = a->design.problem.inputs > 0;
    writer w = {file, prefix, "", 0, {0, 0}};
    int status = 0;
    for (size_t i = 0; prefix[i] && i + 1 < sizeof w.upper; i++)
        w.upper[i] = (char)toupper((unsigned char)prefix[i]);
    write_head(&w, a, tables_image_name[image]);
    if (image == TABLES_NONLINEAR)
        write_demands(&w, a);
    if (controlled)
        fprintf(file, "#define %s_INPUTS %d\n#define %s_OUTPUTS %d\n#define %s_CONTROL_BYTES PZS_CONTROL_BYTES(%d, %d)\n\n",
                w.upper, a->design.amplifiers, w.upper, a->design.targets, w.upper, a->design.amplifiers, a->design.targets);
    if (image == TABLES_NONLINEAR) {
        status = write_nonlinear(&w, a);
    } else if (image == TABLES_LINEAR) {
        write_structure(&w, a, image);
        write_electrodes(&w, a);
        fprintf(file, "#define %s_LINEAR 1\n", w.upper);
        if (a->design.electrodes.count > 0)
            fprintf(file, "/* columns of the influence made on the device; the first %s_INPUTS are the amplifiers' */\n#define %s_ALL_INPUTS %u\n",
                    w.upper, w.upper, a->design.structure.input.count);
        fputs("\n", file);
    }
    if (controlled) {
        write_problem(&w, a, image);
        status = status == 0 ? write_beside(&w, a) : status;
    }
    fputs("#endif\n", file);
    *size = w.size;
    return ferror(file) ? -1 : status;
}
