/* SPDX-License-Identifier: BSD-2-Clause */
/* Generated tables of the equilibrium solver (tables_nonlinear.h). */
#include "tables_nonlinear.h"
#include <stdlib.h>
#include "../../lib/core/guard.h"
#include "../../lib/nonlinear/nonlinear.h"

/*
 * Write the stress resultants that actuators and temperatures prescribe, and the prescribed
 * displacements.
 */
static void write_resultants(emitter *emitter, const pzs_nonlinear *tables, uint16_t inputs)
{
    const int strains = LAMINATE_STRAINS;
    const uint32_t entries = tables->resultants.start ? tables->resultants.start[inputs] : 0;
    emitter->crc32 = GUARD_CRC_START;
    if (entries > 0) {
        emit_comment(emitter, "index of the first prescribed resultant of each input");
        emit_longs(emitter, "resultant_start", tables->resultants.start, inputs + 1u);
        emit_shorts(emitter, "resultant_element", tables->resultants.element, entries,
                    "element in which each prescribed resultant acts");
        emit_shorts(emitter, "resultant_row", tables->resultants.which, entries,
                    "row of the resultant values that each prescribed resultant uses");
        emit_blocks(emitter, "resultant_value", *tables->resultants.value,
                    tables->resultants.values, &strains, 1,
                    "prescribed resultants per unit of an input, times the area of the element");
    }
    if (tables->prescribed.count > 0) {
        emitter->crc32 = pzs_guard_crc(emitter->crc32, &tables->prescribed.input,
                                       sizeof tables->prescribed.input);
        emit_shorts(emitter, "motion_dof", tables->prescribed.dof, tables->prescribed.count,
                    "dof with a prescribed displacement");
        emit_reals(emitter, "motion_value", tables->prescribed.value, tables->prescribed.count,
                   "prescribed displacement of each such dof at an input value of 1");
    }
    emit_begin(emitter, "nonlinear", "nonlinear", tables->scene, tables->crc);
    if (entries > 0)
        fprintf(emitter->file,
                "\n    {%u, %s_resultant_start, %s_resultant_element, %s_resultant_row, "
                "%s_resultant_value},\n",
                tables->resultants.values, emitter->prefix, emitter->prefix, emitter->prefix,
                emitter->prefix);
    else
        fputs("\n    {0, NULL, NULL, NULL, NULL},\n", emitter->file);
    if (tables->prescribed.count > 0)
        fprintf(emitter->file, "    {%u, %u, %s_motion_dof, %s_motion_value},\n};\n\n",
                tables->prescribed.count, tables->prescribed.input, emitter->prefix,
                emitter->prefix);
    else
        fputs("    {0, 0, NULL, NULL},\n};\n\n", emitter->file);
}

/* Checksum of the tables of the follower loads with reals rounded to single precision. */
static uint32_t follower_crc_32(const pzs_follower *tables, const mesh *mesh)
{
    const uint16_t whole[4] = {tables->input, tables->load_face, tables->normal_face,
                               tables->true_area};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, whole, sizeof whole);
    crc = emit_crc_reals(crc, tables->share, 3);
    crc = emit_crc_reals(crc, *tables->area, 4 * (size_t)mesh->types);
    if (tables->lean)
        crc = emit_crc_reals(crc, **tables->lean, 8 * (size_t)mesh->types);
    return ~emit_crc_reals(crc, tables->pressure, (size_t)mesh->nodes);
}

static void write_followers(emitter *emitter, const equilibrium *equilibrium)
{
    const mesh *mesh = &equilibrium->design->mesh;
    const int corners = 4, lean[2] = {4, 2};
    char name[64];
    for (int k = 0; k < equilibrium->followers; k++) {
        snprintf(name, sizeof name, "follower_area_%d", k);
        emit_blocks(emitter, name, *equilibrium->follower[k].area, (size_t)mesh->types, &corners, 1,
                    "area of each corner, for each element type");
        snprintf(name, sizeof name, "follower_lean_%d", k);
        if (equilibrium->follower[k].lean)
            emit_blocks(
                emitter, name, **equilibrium->follower[k].lean, (size_t)mesh->types, lean, 2,
                "inclination of the face's base vectors at each corner, for each element type");
        snprintf(name, sizeof name, "follower_pressure_%d", k);
        emit_reals(emitter, name, equilibrium->follower[k].pressure, (size_t)mesh->nodes,
                   "pressure at each node");
    }
    fprintf(emitter->file, "#define %s_FOLLOWERS %d\n", emitter->upper, equilibrium->followers);
    if (equilibrium->followers > 0)
        fprintf(emitter->file, "static const pzs_follower %s_follower[%d] = {\n", emitter->prefix,
                equilibrium->followers);
    for (int k = 0; k < equilibrium->followers; k++) {
        const pzs_follower *follower = &equilibrium->follower[k];
        fprintf(emitter->file, "    {%uu, 0x%08xu, PZS_BY_BITS(0x%08xu, 0x%08xu), %u, %u, %u, %u, ",
                follower->format, (unsigned)follower->scene,
                (unsigned)follower_crc_32(follower, mesh), (unsigned)follower->crc, follower->input,
                follower->load_face, follower->normal_face, follower->true_area);
        emit_vector(emitter, follower->share);
        fprintf(emitter->file, ", %s_follower_area_%d, ", emitter->prefix, k);
        if (follower->lean)
            fprintf(emitter->file, "%s_follower_lean_%d", emitter->prefix, k);
        else
            fputs("NULL", emitter->file);
        fprintf(emitter->file, ", %s_follower_pressure_%d},\n", emitter->prefix, k);
    }
    fputs(equilibrium->followers > 0 ? "};\n\n" : "\n", emitter->file);
}

/* Checksum of a contact body with reals rounded to single precision. */
static uint32_t body_crc_32(const pzs_body *body)
{
    uint32_t crc = emit_crc_reals(GUARD_CRC_START, body->point, 3);
    crc = emit_crc_reals(crc, body->axis, 3);
    return ~emit_crc_reals(crc, &body->radius, 1);
}

/*
 * Write the tables of the contact of the shell with a rigid body: the face of the shell that may
 * touch the body, and the body. A body that the scene file gives by a formula needs a distance
 * function in the firmware.
 */
static void write_contact(emitter *emitter, const equilibrium *equilibrium)
{
    static const char *const gap[] = {[BODY_PLANE] = "pzs_gap_plane",
                                      [BODY_CYLINDER] = "pzs_gap_cylinder",
                                      [BODY_SPHERE] = "pzs_gap_sphere"};
    static const int matrix[2] = {3, 3};
    const scene_contact *contact = &equilibrium->design->contact;
    const size_t nodes = (size_t)equilibrium->design->mesh.nodes;
    const pzs_contact_face *face = &equilibrium->contact_face;
    if (!contact->given)
        return;
    const uint16_t whole[2] = {face->face, face->input};
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, whole, sizeof whole);
    emitter->crc32 = emit_crc_reals(emitter->crc32, face->motion, 3);
    emitter->crc32 = emit_crc_reals(emitter->crc32, &face->size, 1);
    emit_blocks(emitter, "contact_place", *face->place, nodes, matrix, 1,
                "position of the contact face at each node, undeformed");
    emit_blocks(emitter, "contact_triad", **face->triad, nodes, matrix, 2,
                "unit vectors of the local axes at each node");
    emit_reals(emitter, "contact_area", face->area, nodes, "area of the contact face at each node");
    fprintf(emitter->file,
            "static const pzs_contact_face %s_contact_face = {\n"
            "    %uu, 0x%08xu, PZS_BY_BITS(0x%08xu, 0x%08xu), %u, %u, ",
            emitter->prefix, face->format, (unsigned)face->scene, (unsigned)~emitter->crc32,
            (unsigned)face->crc, face->face, face->input);
    emit_vector(emitter, face->motion);
    fprintf(emitter->file,
            ", PZS_R(%.17g), %s_contact_place, %s_contact_triad, %s_contact_area,\n};\n",
            face->size, emitter->prefix, emitter->prefix, emitter->prefix);
    if (contact->body.type == BODY_PSI)
        fprintf(emitter->file,
                "#ifndef %s_GAP\n#error \"the scene gives the body by a formula: define %s_GAP as "
                "its distance function (pzs_body.gap)\"\n#endif\n",
                emitter->upper, emitter->upper);
    fprintf(emitter->file, "static const pzs_body %s_body = {\n    ", emitter->prefix);
    if (contact->body.type == BODY_PSI)
        fprintf(emitter->file, "%s_GAP, ", emitter->upper);
    else
        fprintf(emitter->file, "%s, ", gap[contact->body.type]);
    emit_vector(emitter, equilibrium->body.point);
    fputs(", ", emitter->file);
    emit_vector(emitter, equilibrium->body.axis);
    fprintf(emitter->file, ", PZS_R(%.17g), NULL, PZS_BY_BITS(0x%08xu, 0x%08xu),\n};\n",
            equilibrium->body.radius, (unsigned)body_crc_32(&equilibrium->body),
            (unsigned)equilibrium->body.crc);
    fprintf(emitter->file,
            "#define %s_CONTACT_BYTES PZS_CONTACT_BYTES(%zu)\n"
            "#define %s_CONTACT_STIFFNESS PZS_R(%.17g)\n\n",
            emitter->upper, nodes, emitter->upper, equilibrium->contact.settings.stiffness);
}

/*
 * Write sizes and settings of the equilibrium solver, and the values of the outputs in the
 * equilibrium that the host computed, for comparison on the device.
 */
static int write_equilibrium(emitter *emitter, const analysis *analysis)
{
    const pzs_structure *structure = &analysis->design.structure;
    const pzs_solver *run = &analysis->equilibrium.solver;
    double *reached = calloc((size_t)structure->output.count + 1, sizeof *reached);
    if (!reached)
        return -1;
    fprintf(emitter->file,
            "#define %s_ALL_INPUTS %u\n#define %s_ALL_OUTPUTS %u\n"
            "#define %s_SOLVER_BYTES PZS_SOLVER_BYTES(%u, %u, %u)\n\n",
            emitter->upper, structure->input.count, emitter->upper, structure->output.count,
            emitter->upper, structure->free_dof, structure->elements, structure->input.count);
    emit_comment(emitter,
                 "settings of the equilibrium solver (pzs_solver_settings) from the scene");
    fprintf(emitter->file,
            "#define %s_LOAD_STEPS %u\n#define %s_EXTRAPOLATED_ITERATIONS %u\n"
            "#define %s_RAMP_SOLVES %u\n#define %s_SOLVE_LIMIT %u\n"
            "#define %s_TOLERANCE PZS_R(%.17g)\n\n",
            emitter->upper, run->settings.load_steps, emitter->upper,
            run->settings.extrapolated_iterations, emitter->upper, run->settings.ramp_solves,
            emitter->upper, (unsigned)run->settings.solve_limit, emitter->upper,
            run->settings.tolerance);
    emit_reals(emitter, "full_input", analysis->equilibrium.full_input, structure->input.count,
               "input values of the scene: applied voltages, loads, extra inputs");
    pzs_observe(structure, run->info.displacement, reached);
    if (structure->output.count > 0)
        emit_reals(emitter, "reached", reached, structure->output.count,
                   "outputs at these input values, as the host computed them in double precision");
    fputs("\n", emitter->file);
    free(reached);
    return 0;
}

int tables_nonlinear(emitter *emitter, const analysis *analysis)
{
    write_resultants(emitter, &analysis->equilibrium.tables,
                     analysis->design.structure.input.count);
    write_followers(emitter, &analysis->equilibrium);
    write_contact(emitter, &analysis->equilibrium);
    return write_equilibrium(emitter, analysis);
}
