/* Tables of the nonlinear path (tables_path.h). */
#include "tables_path.h"
#include <stdlib.h>
#include "../../lib/core/guard.h"
#include "../../lib/nonlinear/nonlinear.h"

/* Actuation, temperature and prescribed displacements. */
static void write_path(emitter *w, const pzs_nonlinear *t, uint16_t inputs)
{
    const int strains = LAMINATE_STRAINS;
    const uint32_t entries = t->given.start ? t->given.start[inputs] : 0;
    w->crc32 = GUARD_CRC_START;
    if (entries > 0) {
        fputs("/* elements on which each input acts by resultants */\n", w->file);
        emit_longs(w, "given_start", t->given.start, inputs + 1u);
        emit_shorts(w, "given_element", t->given.element, entries, "element");
        emit_shorts(w, "given_which", t->given.which, entries, "row of the resultants");
        emit_blocks(w, "given_value", *t->given.value, t->given.values, &strains, 1,
                    "resultants per unit of an input (N m)");
    }
    if (t->prescribed.count > 0) {
        w->crc32 = pzs_guard_crc(w->crc32, &t->prescribed.input, sizeof t->prescribed.input);
        emit_shorts(w, "prescribed_dof", t->prescribed.dof, t->prescribed.count,
                    "free unknowns that are moved");
        emit_reals(w, "prescribed_value", t->prescribed.value, t->prescribed.count, "by");
    }
    emit_begin(w, "nonlinear", "nonlinear", t->scene, t->crc);
    if (entries > 0)
        fprintf(w->file,
                "\n    {%u, %s_given_start, %s_given_element, %s_given_which, %s_given_value},\n",
                t->given.values, w->prefix, w->prefix, w->prefix, w->prefix);
    else
        fputs("\n    {0, NULL, NULL, NULL, NULL},\n", w->file);
    if (t->prescribed.count > 0)
        fprintf(w->file, "    {%u, %u, %s_prescribed_dof, %s_prescribed_value},\n};\n\n",
                t->prescribed.count, t->prescribed.input, w->prefix, w->prefix);
    else
        fputs("    {0, 0, NULL, NULL},\n};\n\n", w->file);
}

/* CRC of a follower load's tables, reals rounded to float. */
static uint32_t follower_crc_32(const pzs_follower *t, const mesh *m)
{
    const uint16_t whole[4] = {t->input, t->load_face, t->normal_face, t->true_area};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, whole, sizeof whole);
    crc = emit_crc_reals(crc, t->share, 3);
    crc = emit_crc_reals(crc, *t->area, 4 * (size_t)m->kinds);
    if (t->lean)
        crc = emit_crc_reals(crc, **t->lean, 8 * (size_t)m->kinds);
    return ~emit_crc_reals(crc, t->pressure, (size_t)m->nodes);
}

static void write_followers(emitter *w, const path *p)
{
    const mesh *m = &p->design->mesh;
    const int corners = 4, lean[2] = {4, 2};
    char name[64];
    for (int k = 0; k < p->followers; k++) {
        snprintf(name, sizeof name, "follower_area_%d", k);
        emit_blocks(w, name, *p->follower[k].area, (size_t)m->kinds, &corners, 1,
                    "area of each corner, by kind");
        snprintf(name, sizeof name, "follower_lean_%d", k);
        if (p->follower[k].lean)
            emit_blocks(w, name, **p->follower[k].lean, (size_t)m->kinds, lean, 2,
                        "lean of the base vectors of each corner, by kind");
        snprintf(name, sizeof name, "follower_pressure_%d", k);
        emit_reals(w, name, p->follower[k].pressure, (size_t)m->nodes, "pressure of each node");
    }
    fprintf(w->file, "#define %s_FOLLOWERS %d\n", w->upper, p->followers);
    if (p->followers > 0)
        fprintf(w->file, "static const pzs_follower %s_follower[%d] = {\n", w->prefix,
                p->followers);
    for (int k = 0; k < p->followers; k++) {
        const pzs_follower *f = &p->follower[k];
        fprintf(w->file, "    {%uu, 0x%08xu, PZS_BY_BITS(0x%08xu, 0x%08xu), %u, %u, %u, %u, ",
                f->format, (unsigned)f->scene, (unsigned)follower_crc_32(f, m), (unsigned)f->crc,
                f->input, f->load_face, f->normal_face, f->true_area);
        emit_vector(w, f->share);
        fprintf(w->file, ", %s_follower_area_%d, ", w->prefix, k);
        if (f->lean)
            fprintf(w->file, "%s_follower_lean_%d", w->prefix, k);
        else
            fputs("NULL", w->file);
        fprintf(w->file, ", %s_follower_pressure_%d},\n", w->prefix, k);
    }
    fputs(p->followers > 0 ? "};\n\n" : "\n", w->file);
}

/* CRC of a body, reals rounded to float. */
static uint32_t body_crc_32(const pzs_body *body)
{
    uint32_t crc = emit_crc_reals(GUARD_CRC_START, body->point, 3);
    crc = emit_crc_reals(crc, body->axis, 3);
    return ~emit_crc_reals(crc, &body->radius, 1);
}

/* The face that may touch, and the body; a body given by a formula wants a distance function of the
 * firmware's own. */
static void write_contact(emitter *w, const path *p)
{
    static const char *const gap[] = {[BODY_PLANE] = "pzs_gap_plane",
                                      [BODY_CYLINDER] = "pzs_gap_cylinder",
                                      [BODY_SPHERE] = "pzs_gap_sphere"};
    static const int matrix[2] = {3, 3};
    const scene_contact *contact = &p->design->scene->contact;
    const size_t nodes = (size_t)p->design->mesh.nodes;
    const pzs_contact_face *face = &p->face;
    if (!contact->given)
        return;
    const uint16_t whole[2] = {face->face, face->input};
    w->crc32 = pzs_guard_crc(GUARD_CRC_START, whole, sizeof whole);
    w->crc32 = emit_crc_reals(w->crc32, face->motion, 3);
    w->crc32 = emit_crc_reals(w->crc32, &face->size, 1);
    emit_blocks(w, "contact_place", *face->place, nodes, matrix, 1,
                "places of the face that may touch, at rest");
    emit_blocks(w, "contact_triad", **face->triad, nodes, matrix, 2, "their triads");
    emit_reals(w, "contact_area", face->area, nodes, "their areas");
    fprintf(
        w->file,
        "static const pzs_contact_face %s_contact_face = {\n    %uu, 0x%08xu, PZS_BY_BITS(0x%08xu, 0x%08xu), %u, %u, ",
        w->prefix, face->format, (unsigned)face->scene, (unsigned)~w->crc32, (unsigned)face->crc,
        face->face, face->input);
    emit_vector(w, face->motion);
    fprintf(w->file, ", PZS_R(%.17g), %s_contact_place, %s_contact_triad, %s_contact_area,\n};\n",
            face->size, w->prefix, w->prefix, w->prefix);
    if (contact->body.type == BODY_PSI)
        fprintf(
            w->file,
            "#ifndef %s_GAP\n#error \"the body is a formula: define %s_GAP as its distance function (pzs_body.gap)\"\n#endif\n",
            w->upper, w->upper);
    fprintf(w->file, "static const pzs_body %s_body = {\n    %s%s, ", w->prefix,
            contact->body.type == BODY_PSI ? w->upper : gap[contact->body.type],
            contact->body.type == BODY_PSI ? "_GAP" : "");
    emit_vector(w, p->body.point);
    fputs(", ", w->file);
    emit_vector(w, p->body.axis);
    fprintf(w->file, ", PZS_R(%.17g), NULL, PZS_BY_BITS(0x%08xu, 0x%08xu),\n};\n", p->body.radius,
            (unsigned)body_crc_32(&p->body), (unsigned)p->body.crc);
    fprintf(w->file,
            "#define %s_CONTACT_BYTES PZS_CONTACT_BYTES(%zu)\n"
            "#define %s_CONTACT_STIFFNESS PZS_R(%.17g)\n\n",
            w->upper, nodes, w->upper, p->contact.settings.stiffness);
}

/* Sizes and choices of the path, and what the host found with them. */
static int write_equilibrium(emitter *w, const analysis *a)
{
    const pzs_structure *s = &a->design.structure;
    const pzs_solver *run = &a->path.run;
    double *reached = calloc((size_t)s->output.count + 1, sizeof *reached);
    if (!reached)
        return -1;
    fprintf(
        w->file,
        "#define %s_ALL_INPUTS %u\n#define %s_ALL_OUTPUTS %u\n#define %s_PATH_BYTES PZS_SOLVER_BYTES(%u, %u, %u)\n\n"
        "/* choices of the scene, for the path */\n#define %s_STEPS %u\n#define %s_MIXED %u\n#define %s_SYSTEMS %u\n"
        "#define %s_CHANGE PZS_R(%.17g)\n\n",
        w->upper, s->input.count, w->upper, s->output.count, w->upper, s->free_dof, s->elements,
        s->input.count, w->upper, run->settings.load_steps, w->upper,
        run->settings.extrapolated_iterations, w->upper, (unsigned)run->settings.solve_limit,
        w->upper, run->settings.tolerance);
    emit_reals(w, "full", a->path.full, s->input.count,
               "amounts of the scene: applied volts, loads, extra inputs");
    pzs_observe(s, run->info.displacement, reached);
    if (s->output.count > 0)
        emit_reals(w, "reached", reached, s->output.count,
                   "outputs under these amounts, as the host found them in double");
    fputs("\n", w->file);
    free(reached);
    return 0;
}

int tables_path(emitter *w, const analysis *a)
{
    write_path(w, &a->path.tables, a->design.structure.input.count);
    write_followers(w, &a->path);
    write_contact(w, &a->path);
    return write_equilibrium(w, a);
}
