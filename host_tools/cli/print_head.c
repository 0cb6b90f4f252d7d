/* SPDX-License-Identifier: BSD-2-Clause */
/* What the results of all commands begin with (print_head.h). */
#include "print_head.h"
#include <stdio.h>
#include "../../lib/model/model.h"
#include "../tables/tables.h"
#include "../text/words.h"
#include "print_matrix.h"
#include "print_outlines.h"

static const char *precision_needed(const analysis *analysis)
{
    if (tables_allow_float(analysis))
        return "float or double";
    /*
     * Above the condition number 1e14, the stiffness matrix of the undeformed state is too close to
     * singular to be factored.
     */
    if (analysis->model.info.condition > 1e14)
        return "double; loose at rest, held by a contact or by its prescribed displacements alone";
    return analysis->is_nonlinear
               ? "the nonlinear path needs double"
               : "double recommended; in float refined, and refused (PZS_E_CONDITION) "
                 "where that does not converge";
}

/*
 * Return a text that says with which metric strains are integrated through the thickness: the exact
 * metric of the curved shell, or that of a flat plate.
 */
static const char *metric_word(const design *design)
{
    return design->mesh.formulation.metric ? "exact metric" : "flat metric";
}

/* Print how well the sensors of the scene's `estimate` section determine the shape. */
static void print_sensors(const analysis *analysis, const char *influence)
{
    char text[SCENE_ERROR];
    estimator estimator;
    if (!analysis->design.estimate.given || estimator_open(&estimator, analysis, text) < 0)
        return;
    estimator_text(&estimator, analysis, text);
    printf("  %s, %s\n", influence, text);
    estimator_close(&estimator);
}

void print_estimate_json(json *json, const estimator *estimator)
{
    json_open(json, "estimate", '{');
    json_number(json, "sensors", estimator->sensors);
    json_number(json, "rank", estimator->rank);
    json_number(json, "condition", estimator->condition);
    json_number(json, "remaining", estimator->remaining / estimator->disturbed);
    json_number(json, "worst_remaining", estimator->worst_remaining / estimator->worst_disturbed);
    json_close(json, '}');
}

static void json_sensors(json *json, const analysis *analysis)
{
    char text[SCENE_ERROR];
    estimator estimator;
    if (!analysis->design.estimate.given || estimator_open(&estimator, analysis, text) < 0)
        return;
    print_estimate_json(json, &estimator);
    estimator_close(&estimator);
}

/* Print how many nodes of a mesh file belong to no element, and the numbers of the first ones. */
static void print_loose(const quad_loose *loose)
{
    if (loose->count == 0)
        return;
    printf("  nodes of the file without elements, left out: %zu:", loose->count);
    for (size_t i = 0; i < loose->count && i < QUAD_LOOSE; i++)
        printf(" %lld", (long long)loose->label[i]);
    puts(loose->count > QUAD_LOOSE ? " ..." : "");
}

static void json_loose(json *json, const quad_loose *loose)
{
    json_open(json, "nodes_without_element", '{');
    json_number(json, "count", (double)loose->count);
    json_open(json, "first", '[');
    for (size_t i = 0; i < loose->count && i < QUAD_LOOSE; i++)
        json_number(json, NULL, (double)loose->label[i]);
    json_close(json, ']');
    json_close(json, '}');
}

/* Print the size of the mesh, the element type and the condition number of the stiffness matrix. */
static void print_structure(const analysis *analysis)
{
    const design *design = &analysis->design;
    const mesh *mesh = &analysis->design.mesh;
    if (mesh->quads)
        printf("  %d elements from %s", mesh->elements, design->quads->file);
    else
        printf("  %d x %d elements", design->mesh.line[0].elements, design->mesh.line[1].elements);
    printf(" of %d element type%s, %d nodes, %d free dof, half bandwidth %d\n", mesh->types,
           mesh->types == 1 ? "" : "s", mesh->nodes, mesh->free_dof, mesh_half_bandwidth(mesh));
    if (design->quads)
        print_loose(&design->quads->warnings.loose);
    if (mesh->quads)
        printf("  envelope of the factor: %.0f numbers, %.0f a row after renumbering\n",
               mesh_envelope(mesh), mesh_envelope(mesh) / mesh->free_dof);
    if (mesh->fitted)
        printf("  surface: %d x %d pieces through %zu points, which differ from it by %.3g %s rms "
               "and %.3g %s at most\n",
               mesh->fitted->cells[0], mesh->fitted->cells[1], mesh->fitted->points,
               mesh->fitted->rms, design->units.length, mesh->fitted->largest,
               design->units.length);
    printf("  element: %s kinematics, %s through the thickness, %d dof per node\n",
           design->mesh.formulation.cartesian ? "Cartesian" : "local", metric_word(design),
           design->mesh.formulation.dof_per_node);
    print_outlines(design);
    if (analysis->model.info.condition > 0)
        printf("  condition %.1e after scaling: %s\n", analysis->model.info.condition,
               precision_needed(analysis));
}

void print_head(const analysis *analysis, const char *influence)
{
    const design *design = &analysis->design;
    printf("%s: %s\n", design->name, design->about ? design->about : "");
    if (words_unitless(&design->units))
        puts("  units: the scene names none; any consistent ones, angles in rad");
    (analysis->source->has_structure ? print_structure : print_matrix)(analysis);
    print_sensors(analysis, influence);
}

static void json_structure(json *json, const analysis *analysis)
{
    const mesh *mesh = &analysis->design.mesh;
    json_number(json, "elements", mesh->elements);
    if (mesh->fitted) {
        json_number(json, "surface_rms", mesh->fitted->rms);
        json_number(json, "surface_largest", mesh->fitted->largest);
    }
    json_number(json, "element_types", mesh->types);
    json_number(json, "nodes", mesh->nodes);
    if (analysis->design.quads)
        json_loose(json, &analysis->design.quads->warnings.loose);
    json_number(json, "dof", mesh->free_dof);
    json_number(json, "half_bandwidth", mesh_half_bandwidth(mesh));
    json_string(json, "kinematics_of_element",
                analysis->design.mesh.formulation.cartesian ? "cartesian" : "local");
    json_string(json, "metric", analysis->design.mesh.formulation.metric ? "exact" : "flat");
    print_outlines_json(json, &analysis->design);
    json_number(json, "condition", analysis->model.info.condition);
}

void print_head_json(json *json, const analysis *analysis)
{
    json_string(json, "scene", analysis->design.name);
    json_number(json, "real_bits", PZS_REAL_BITS);
    json_string(json, "unit_length", analysis->design.units.length);
    (analysis->source->has_structure ? json_structure : print_matrix_json)(json, analysis);
    plausible_json(json, &analysis->warnings);
    json_sensors(json, analysis);
}
