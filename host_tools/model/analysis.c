/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Analysis of one scene by the library: stiffness matrix, displacements, influence matrix, results
 * by the scene's names (analysis.h).
 */
#define _POSIX_C_SOURCE 200809L
#include "analysis.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "../../lib/model/electrode.h"
#include "design_build.h"
#include "electrodes.h"
#include "mass.h"
#include "output_calls.h"
#include "ramp.h"
#include "stress_corrected.h"
#include "stress_output.h"
#include "../../lib/core/guard.h"
#include "../../lib/core/linalg.h"
#include "../../lib/model/model.h"

static const char *const unknown_name[7] = {
    "mean u1", "mean u2", "mean u3", "difference u1", "difference u2", "difference u3", "u3M"};

double analysis_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- structure -------------------------------------------------------- */

/*
 * Return the position in the scene file to which messages about missing supports refer: the first
 * support; without supports, the first stack or spring; else the surface.
 */
static scene_at at_of_supports(const design *design)
{
    if (design->supports > 0)
        return design->support[0].at;
    for (int k = 0; k < design->actuators; k++)
        if (design->actuator[k].stacks)
            return design->actuator[k].stacks->at;
    return design->springs > 0 ? design->spring[0].at : design->at;
}

/* Write the error message for a rigid motion of the structure that nothing stops. Returns -1. */
static int explain_loose(const analysis *analysis, pzs_status status, char *error)
{
    const mesh *mesh = &analysis->design.mesh;
    const design *design = &analysis->design;
    const int32_t where = analysis->model.info.where;
    char place[160] = "";
    for (int node = 0; node < mesh->nodes && !*place; node++)
        for (unsigned i = 0; i < mesh->dof_per_node; i++)
            if (mesh->node_dof[(size_t)node * mesh->dof_per_node + i] == where)
                snprintf(place, sizeof place, ": %s at node %s", unknown_name[i],
                         mesh_node_text(mesh, node).text);
    if (mesh->springs.count == 0)
        return scene_fault(at_of_supports(design), error,
                           "%s%s; add supports that stop every rigid motion",
                           pzs_status_text(status), place);
    return scene_fault(
        at_of_supports(design), error,
        "%s%s; the %d supports and the %d springs and stacks leave a motion free, or "
        "are too soft: add supports or springs, or turn some ('along')",
        pzs_status_text(status), place, design->supports, mesh->springs.count);
}

int analysis_explain(const analysis *analysis, pzs_status status, char *error)
{
    const design *design = &analysis->design;
    if (status == PZS_E_LOOSE || status == PZS_E_NEGATIVE)
        return explain_loose(analysis, status, error);
    if (status == PZS_E_CONDITION)
        return scene_fault(
            design->at, error,
            "%s: condition %.2g; supports may leave a motion free, or the shell is too thin",
            pzs_status_text(status), analysis->model.info.condition);
    return scene_fault(design->at, error, "%s", pzs_status_text(status));
}

/*
 * Assemble and factor the stiffness matrix of the structure in the reference state, unless it is
 * already factored.
 */
static pzs_status factor_reference_state(analysis *analysis)
{
    if (analysis->model.state.stage == STAGE_FACTORED)
        return PZS_OK;
    const double begin = analysis_now();
    pzs_status status = pzs_assemble(&analysis->model, NULL, NULL);
    const double assembled = analysis_now();
    if (status == PZS_OK)
        status = pzs_factor(&analysis->model);
    analysis->seconds.assemble = assembled - begin;
    analysis->seconds.factor = analysis_now() - assembled;
    return status == PZS_OK && analysis->electric.state.model
               ? pzs_electric_factor(&analysis->electric)
               : status;
}

static pzs_status start_electrodes(analysis *analysis)
{
    const pzs_electrodes *tables = &analysis->design.electrodes;
    const uint16_t inputs = analysis->design.structure.input.count;
    const size_t bytes = PZS_ELECTRIC_BYTES(tables->count, tables->count, inputs);
    analysis->input_value = calloc(inputs + 1u, sizeof *analysis->input_value);
    analysis->charge = calloc(tables->count + 1u, sizeof *analysis->charge);
    analysis->electric_work = malloc(bytes);
    analysis->modes = calloc(1, sizeof *analysis->modes);
    if (!analysis->modes || !analysis->input_value || !analysis->charge || !analysis->electric_work)
        return PZS_E_WORKSPACE;
    return tables->count > 0 ? pzs_electric_init(&analysis->electric, &analysis->model, tables,
                                                 analysis->electric_work, bytes)
                             : PZS_OK;
}

/*
 * Assemble and factor the stiffness matrix. Where the scene's kinematics is not linear, also set up
 * the equilibrium solver. Returns 0, or -1 with error filled.
 */
static int open_structure(analysis *analysis, char *error)
{
    const pzs_structure *structure = &analysis->design.structure;
    const design *design = &analysis->design;
    analysis->work_bytes = PZS_MODEL_BYTES(
        structure->free_dof, pzs_linalg_reals(structure->first_column, structure->free_dof));
    analysis->work = malloc(analysis->work_bytes);
    pzs_status status = analysis->work ? pzs_model_init(&analysis->model, structure, analysis->work,
                                                        analysis->work_bytes)
                                       : PZS_E_WORKSPACE;
    if (status == PZS_OK && analysis->design.mesh.prescribed_count > 0 &&
        design->kinematics == KINEMATICS_LINEAR)
        return scene_fault(design->support[0].at, error,
                           "kinematics: linear cannot prescribe the value of a support; set "
                           "kinematics: nonlinear");
    if (status == PZS_OK)
        status = start_electrodes(analysis);
    if (status == PZS_OK)
        status = factor_reference_state(analysis);
    if (design->kinematics != KINEMATICS_LINEAR &&
        (status == PZS_OK || design->contact.given || analysis->design.mesh.prescribed_count > 0))
        status = equilibrium_open(&analysis->equilibrium, &analysis->design, &analysis->model);
    return status == PZS_OK ? 0 : analysis_explain(analysis, status, error);
}

static pzs_status displace_structure(analysis *analysis, const double *value, double *displacement)
{
    pzs_status status = factor_reference_state(analysis);
    if (status == PZS_OK)
        status = analysis_electrodes(analysis, value);
    return status == PZS_OK ? pzs_solve(&analysis->model, analysis->input_value, displacement)
                            : status;
}

static pzs_status structure_influence(analysis *analysis)
{
    pzs_status status = factor_reference_state(analysis);
    if (status == PZS_OK)
        status = pzs_influence(&analysis->model, analysis->influence);
    return status == PZS_OK && analysis->electric.state.model
               ? pzs_influence_open(&analysis->electric, analysis->influence)
               : status;
}

const analysis_source analysis_of_structure = {true, open_structure, displace_structure,
                                               structure_influence};

int analysis_prepare(analysis *analysis, const scene *scene, char *error)
{
    memset(analysis, 0, sizeof *analysis);
    analysis->source = scene->influence.given ? &analysis_of_matrix : &analysis_of_structure;
    analysis->is_nonlinear = scene->kinematics == KINEMATICS_NONLINEAR;
    if (design_build(&analysis->design, scene, error) < 0)
        return -1;
    if (analysis->source->open(analysis, error) == 0)
        return 0;
    analysis_free(analysis);
    return -1;
}

int analysis_needs_structure(const analysis *analysis, const char *what, char *error)
{
    const design *design = &analysis->design;
    if (analysis->source->has_structure)
        return 0;
    return scene_fault(design->measured.at, error,
                       "%s needs a structure, and this scene has none: it has a measured influence "
                       "matrix; use check, shape, simulate, or tables --image control",
                       what);
}

pzs_status analysis_displace(analysis *analysis, const double *value, double *displacement)
{
    return analysis->source->displace(analysis, value, displacement);
}

int analysis_ended_early(const analysis *analysis)
{
    return analysis->status == PZS_E_DIVERGED || analysis->status == PZS_E_LIMIT ||
           analysis->status == PZS_E_CONTACT || analysis->status == PZS_E_PENETRATION ||
           analysis->status == PZS_E_SOLVES;
}

/*
 * Fill `error` with the message of the equilibrium solver's last status. Returns -1 for errors and
 * 0 for warnings.
 */
static int explain_equilibrium(const analysis *analysis, char *error)
{
    const pzs_solver *run = &analysis->equilibrium.solver;
    const design *design = &analysis->design;
    const scene_at at = design->equilibrium.at.line ? design->equilibrium.at : design->at;
    const char *plural = run->info.load_steps == 1 ? "" : "s";
    if (!PZS_IS_ERROR(analysis->status))
        return 0;
    if (analysis->status == PZS_E_PENETRATION) {
        char where[SCENE_ERROR];
        equilibrium_penetration_text(&analysis->equilibrium, analysis->status, where);
        return scene_fault(design->contact.at, error,
                           "%s: %s (reached %.4g of the load in %u linear solves)",
                           pzs_status_text(analysis->status), where, run->info.load_factor,
                           run->info.linear_solves);
    }
    if (analysis_ended_early(analysis))
        return scene_fault(at, error,
                           "%s: reached %.4g of the load in %u linear solves, %u load step%s; "
                           "the last equilibrium has %u negative pivots",
                           pzs_status_text(analysis->status), run->info.load_factor,
                           run->info.linear_solves, run->info.load_steps, plural,
                           run->info.negative_pivots);
    return analysis_explain(analysis, analysis->status, error);
}

int analysis_outputs(const analysis *analysis, int k)
{
    const scene_output *output = &analysis->design.output[k];
    switch (scene_output_info_of(output->type)->spread) {
    case SPREAD_NODES: return analysis->design.place_first[k + 1] - analysis->design.place_first[k];
    case SPREAD_ELECTRODES: return output->count;
    default: return 1;
    }
}

int analysis_output_node(const analysis *analysis, int k, int i)
{
    const int entry = analysis->design.place_first[k] + i;
    return entry < analysis->design.place_first[k + 1] ? analysis->design.place_node[entry] : -1;
}

const char *analysis_output_electrode(const analysis *analysis, int k, int i)
{
    const design *design = &analysis->design;
    const scene_output *output = &design->output[k];
    return (output->of_sensor ? design->electrode_name : design->amplifier_name)[output->first + i];
}

bool analysis_output_is_row(const analysis *analysis, int k)
{
    const output_calls *calls = output_calls_of(&analysis->design.output[k]);
    const bool is_curved = calls->in_element || calls->value;
    return calls->add_row && !(is_curved && analysis->is_nonlinear);
}

double analysis_output(const analysis *analysis, int k, int i, const double *value)
{
    const design *design = &analysis->design;
    const output_calls *calls = output_calls_of(&design->output[k]);
    const output_state state = {design, &analysis->equilibrium, &analysis->reactions,
                                analysis->input_value, analysis->charge};
    if (analysis_output_is_row(analysis, k))
        return value[design->named_first[k] + i];
    if (calls->in_element)
        return analysis->recovered ? analysis->recovered[design->place_first[k] + i] : (double)NAN;
    return calls->value(&state, k, i);
}

pzs_status analysis_electrodes(analysis *analysis, const double *value)
{
    memcpy(analysis->input_value,
           analysis->is_nonlinear ? analysis->equilibrium.solver.info.input_value : value,
           analysis->design.structure.input.count * sizeof *analysis->input_value);
    if (analysis->is_nonlinear)
        pzs_charges_at(&analysis->equilibrium.solver, &analysis->design.electrodes,
                       analysis->charge);
    if (analysis->is_nonlinear || !analysis->electric.state.model)
        return PZS_OK;
    const pzs_status status = pzs_open_voltages(&analysis->electric, analysis->input_value);
    return status == PZS_OK
               ? pzs_charges(&analysis->electric, analysis->input_value, analysis->charge)
               : status;
}

static pzs_status reach_nonlinear(analysis *analysis, const double *value, int warm,
                                  double *displacement)
{
    pzs_solver *run = &analysis->equilibrium.solver;
    const double begin = analysis_now();
    if (!warm)
        pzs_solver_reset(run);
    analysis->status =
        warm ? pzs_equilibrium(run, value) : ramp_equilibrium(&analysis->equilibrium, value);
    analysis->seconds.solve = analysis_now() - begin;
    memcpy(displacement, run->info.displacement,
           (size_t)analysis->design.mesh.free_dof * sizeof *displacement);
    (void)analysis_electrodes(analysis, value);
    return analysis->status;
}

static pzs_status reach_linear(analysis *analysis, const double *value, double *displacement)
{
    const double begin = analysis_now();
    analysis->status = analysis_displace(analysis, value, displacement);
    analysis->seconds.solve = analysis_now() - begin;
    return analysis->status;
}

int analysis_reach(analysis *analysis, const double *voltage, int warm, double *displacement,
                   char *error)
{
    const design *design = &analysis->design;
    const size_t inputs = design->structure.input.count, amplifiers = (size_t)design->amplifiers;
    double *value = calloc(inputs + 1, sizeof *value);
    if (!value)
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    for (size_t k = 0; k < amplifiers; k++)
        value[k] = voltage[k];
    for (size_t k = amplifiers; k < inputs; k++)
        value[k] = analysis->is_nonlinear ? analysis->equilibrium.full_input[k]
                                          : k < amplifiers + (size_t)design->loads;
    const pzs_status status = analysis->is_nonlinear
                                  ? reach_nonlinear(analysis, value, warm, displacement)
                                  : reach_linear(analysis, value, displacement);
    free(value);
    if (analysis->is_nonlinear)
        return explain_equilibrium(analysis, error);
    return status == PZS_OK ? 0 : analysis_explain(analysis, status, error);
}

static int solve_applied(analysis *analysis, int warm, double *displacement, char *error)
{
    const design *design = &analysis->design;
    double *voltage = calloc((size_t)design->amplifiers + 1, sizeof *voltage);
    if (!voltage)
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    design_applied(design, voltage);
    const int failed = analysis_reach(analysis, voltage, warm, displacement, error);
    free(voltage);
    return failed;
}

/*
 * Return the norm of the difference of two displacement vectors over the norm of the second. Each
 * entry is divided by the scale of its dof (`state.scale` of the model), about the inverse square
 * root of the diagonal stiffness.
 *   first, second [free_dof] in  displacement vectors
 */
static double distance(const analysis *analysis, const double *first, const double *second)
{
    double apart = 0, size = 0;
    for (int i = 0; i < analysis->design.mesh.free_dof; i++) {
        apart += pow((first[i] - second[i]) / analysis->model.state.scale[i], 2);
        size += pow(second[i] / analysis->model.state.scale[i], 2);
    }
    return size > 0 ? sqrt(apart / size) : 0;
}

/*
 * Compute the displacement with linear and with nonlinear kinematics, and return the linear one
 * where the two differ by no more than the scene's tolerance.
 *   displacement [free_dof] out  displacement vector of the structure
 */
static int solve_auto(analysis *analysis, double *displacement, char *error)
{
    const size_t bytes = (size_t)analysis->design.mesh.free_dof * sizeof *displacement;
    double *linear = malloc(bytes);
    if (!linear)
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    analysis->is_nonlinear = false;
    int failed = solve_applied(analysis, 0, linear, error);
    analysis->is_nonlinear = true;
    if (!failed)
        failed = solve_applied(analysis, 0, displacement, error);
    analysis->linear_error = failed ? (double)NAN : distance(analysis, linear, displacement);
    if (analysis->linear_error <= analysis->design.tolerance) {
        analysis->is_nonlinear = false;
        memcpy(displacement, linear, bytes);
    }
    free(linear);
    return failed;
}

int analysis_stresses(analysis *analysis, const double *displacement, stress_field *field)
{
    const stress_state state = {&analysis->design, displacement, analysis->input_value,
                                analysis->is_nonlinear};
    if (analysis->is_nonlinear || factor_reference_state(analysis) != PZS_OK)
        return stress_recover(field, &state);
    return stress_recover_corrected(field, &state, &analysis->model);
}

/*
 * Compute the strains and stresses that the scene names as outputs, from a displacement of the
 * structure. Returns 0, or -1 with error filled.
 */
static int recover_outputs(analysis *analysis, const double *displacement, char *error)
{
    const design *design = &analysis->design;
    bool is_wanted = false;
    for (int k = 0; k < design->outputs; k++)
        is_wanted |= output_is_recovered(&design->output[k]);
    if (!is_wanted)
        return 0;
    if (!analysis->recovered)
        analysis->recovered =
            calloc((size_t)design->place_first[design->outputs] + 1, sizeof *analysis->recovered);
    stress_field field;
    if (!analysis->recovered)
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    const int status = analysis_stresses(analysis, displacement, &field);
    if (status == 0)
        stress_outputs(&field, analysis->recovered);
    stress_free(&field);
    return status == 0 ? 0 : analysis_explain(analysis, PZS_E_WORKSPACE, error);
}

int analysis_find_reactions(analysis *analysis, const double *displacement, char *error)
{
    const reaction_state state = {&analysis->design, displacement, analysis->input_value,
                                  analysis->is_nonlinear ? &analysis->equilibrium : NULL};
    reactions_free(&analysis->reactions);
    if (reactions_compute(&analysis->reactions, &state) == 0)
        return 0;
    return analysis_explain(analysis, PZS_E_WORKSPACE, error);
}

/*
 * Compute what follows from a displacement: the reactions, and the strains and stresses that the
 * scene names as outputs. If the computation of the displacement has failed, nothing is computed,
 * unless its load steps ended at an equilibrium below the full load.
 *   failed in  return value of the computation of the displacement
 * Returns `failed`, or -1 with error filled.
 */
static int recover_all(analysis *analysis, int failed, const double *displacement, char *error)
{
    if (failed && !analysis_ended_early(analysis))
        return failed;
    if (analysis_find_reactions(analysis, displacement, error) < 0)
        return -1;
    return recover_outputs(analysis, displacement, error) < 0 ? -1 : failed;
}

/*
 * Compute the displacement under the scene's loads, without outputs. Contact and prescribed
 * displacements exist under nonlinear kinematics alone, so no linear solution is computed for them.
 */
static int solve_scene(analysis *analysis, double *displacement, char *error)
{
    const int path_alone =
        analysis->design.contact.given || analysis->design.mesh.prescribed_count > 0;
    if (analysis->design.kinematics == KINEMATICS_AUTO && !path_alone)
        return solve_auto(analysis, displacement, error);
    if (analysis->design.kinematics == KINEMATICS_AUTO) {
        analysis->is_nonlinear = true;
        analysis->linear_error = (double)NAN;
    }
    return solve_applied(analysis, 0, displacement, error);
}

int analysis_solve(analysis *analysis, double *displacement, char *error)
{
    const int failed = solve_scene(analysis, displacement, error);
    return recover_all(analysis, failed, displacement, error);
}

int analysis_continue(analysis *analysis, double *displacement, char *error)
{
    analysis->is_nonlinear = true;
    const int failed = solve_applied(analysis, 1, displacement, error);
    return recover_all(analysis, failed, displacement, error);
}

/*
 * Compute the nonlinear equilibrium with twice as many load steps as the scene asks for.
 *   displacement [free_dof] out  displacement vector of the structure
 *   load_factor             out  part of the load that is reached
 * Returns the status of the solver.
 */
static pzs_status solve_in_more_steps(analysis *analysis, double *displacement, double *load_factor)
{
    pzs_solver *solver = &analysis->equilibrium.solver;
    const pzs_solver_info info = solver->info;
    const pzs_solver_settings settings = solver->settings;
    solver->settings.load_steps = (uint16_t)(2 * settings.load_steps);
    solver->settings.solve_limit = 2 * settings.solve_limit;
    pzs_solver_reset(solver);
    const pzs_status status = pzs_equilibrium(solver, analysis->equilibrium.full_input);
    memcpy(displacement, solver->info.displacement,
           (size_t)analysis->design.mesh.free_dof * sizeof *displacement);
    *load_factor = solver->info.load_factor;
    solver->settings = settings;
    solver->info = info;
    return status;
}

double analysis_path_difference(analysis *analysis, const double *displacement, double *load_factor)
{
    const equilibrium *equilibrium = &analysis->equilibrium;
    double difference = (double)NAN;
    *load_factor = 1;
    if (analysis->design.bare.count > 0)
        return difference;
    double *other = malloc((size_t)analysis->design.mesh.free_dof * sizeof *other);
    void *state = malloc(equilibrium_state_bytes(equilibrium));
    if (other && state) {
        equilibrium_save(equilibrium, state);
        difference = PZS_IS_ERROR(solve_in_more_steps(analysis, other, load_factor))
                         ? HUGE_VAL
                         : distance(analysis, other, displacement);
        equilibrium_restore(&analysis->equilibrium, state);
    }
    free(other);
    free(state);
    return difference;
}

int analysis_linearise(analysis *analysis, char *error)
{
    pzs_solver *solver = &analysis->equilibrium.solver;
    if (solver->info.negative_pivots > 0)
        return scene_fault(analysis->design.at, error,
                           "the equilibrium under the loads is unstable (%u negative pivots): the "
                           "structure has buckled; lower the loads, or add an imperfection",
                           solver->info.negative_pivots);
    linearised_free(&analysis->about);
    kept_modes_free(analysis->modes);
    if (linearised_take(&analysis->about, &analysis->design, solver))
        return 0;
    return analysis_explain(analysis, PZS_E_WORKSPACE, error);
}

/*
 * Compute the influence matrix at the equilibrium that the nonlinear solver has reached, and set up
 * the least-squares problem for the voltages that cause the target minus the displacement there.
 *   displacement  [free_dof] in  displacement vector at the equilibrium
 */
static int influence_at(analysis *analysis, const double *displacement, char *error)
{
    design *design = &analysis->design;
    const pzs_status status = pzs_influence_at(&analysis->equilibrium.solver, analysis->influence);
    if (status != PZS_OK)
        return analysis_explain(analysis, status, error);
    if (analysis_linearise(analysis, error) < 0 ||
        design_control(design, analysis->influence, error) < 0)
        return -1;
    design_shape(design, displacement, design->wanted);
    design_take_free(design, design->wanted);
    for (int i = 0; i < design->targets; i++)
        design->wanted[i] = design->target[i] - design->wanted[i];
    return 0;
}

/*
 * Compute, about the equilibrium under the scene's loads at 0 V, the influence matrix, the
 * least-squares problem for the voltages, the tangent stiffness matrix and the forces of the
 * inputs. Returns 0, or -1 with error filled.
 */
static int influence_under_loads(analysis *analysis, char *error)
{
    const design *design = &analysis->design;
    const bool was_nonlinear = analysis->is_nonlinear;
    double *voltage = calloc((size_t)design->amplifiers + 1, sizeof *voltage),
           *displacement = calloc((size_t)design->mesh.free_dof + 1, sizeof *displacement);
    int failed = voltage && displacement ? 0 : analysis_explain(analysis, PZS_E_WORKSPACE, error);
    analysis->is_nonlinear = true;
    failed = failed || analysis_reach(analysis, voltage, 0, displacement, error) < 0 ||
             influence_at(analysis, displacement, error) < 0;
    analysis->is_nonlinear = was_nonlinear;
    free(voltage);
    free(displacement);
    return failed ? -1 : 0;
}

/*
 * Whether the scene asks for a controller whose influence matrix is that of the structure
 * linearised about the nonlinear equilibrium under its loads.
 */
static bool is_loaded(const design *design)
{
    return design->simulate.influence_at == INFLUENCE_LOADED &&
           design->kinematics != KINEMATICS_LINEAR;
}

int analysis_vibration_of(const analysis *analysis, electrode_circuit circuit, vibration *vibration,
                          int number, char *error)
{
    const linearised *about = analysis->about.tangent ? &analysis->about : NULL;
    return vibration_solve_at(vibration, &analysis->design, about, circuit, number, MASS_LUMPED,
                              error);
}

int analysis_vibration(const analysis *analysis, vibration *vibration, int number, char *error)
{
    const design *design = &analysis->design;
    const int most = vibration_most(design), wanted = number < most ? number : most;
    kept_modes *kept = analysis->modes;
    if (kept && kept_modes_copy(kept, design, wanted, vibration))
        return 0;
    const int failed = analysis_vibration_of(analysis, CIRCUIT_SCENE, vibration, number, error);
    if (!failed && kept)
        kept_modes_add(kept, design, vibration);
    return failed;
}

int analysis_influence(analysis *analysis, char *error)
{
    const pzs_structure *structure = &analysis->design.structure;
    if (analysis->influence)
        return 0;
    analysis->influence = calloc((size_t)structure->input.count * structure->output.count + 1,
                                 sizeof *analysis->influence);
    if (!analysis->influence)
        return analysis_explain(analysis, PZS_E_WORKSPACE, error);
    if (is_loaded(&analysis->design))
        return influence_under_loads(analysis, error);
    const pzs_status status = analysis->source->influence(analysis);
    if (status != PZS_OK)
        return analysis_explain(analysis, status, error);
    return design_control(&analysis->design, analysis->influence, error);
}

/* ---- electrodes --------------------------------------------------------- */

double analysis_capacitance(const analysis *analysis, int k, int is_free)
{
    const pzs_electrodes *tables = &analysis->design.electrodes;
    double sum = 0;
    if (is_free)
        return analysis->electric.state.stage > 0
                   ? analysis->electric.state
                         .sensitivity[(size_t)k * analysis->design.structure.input.count +
                                      tables->input[k]]
                   : (double)NAN;
    for (uint32_t i = tables->direct.start[k]; i < tables->direct.start[k + 1]; i++)
        sum += tables->direct.dof[i] == tables->input[k] ? tables->direct.value[i] : 0;
    return sum;
}

/*
 * Twice the work that the scene's loads, without temperature loads, do on the linear displacement
 * that they cause. Returns NAN where it cannot be computed.
 *   value  [inputs]  work array of input values; in: zeros; out: load factor 1 for each load except
 *          temperature loads
 */
static double work_of_loads(analysis *analysis, double *value)
{
    const design *design = &analysis->design;
    const pzs_rows *in = &design->structure.input;
    double *displacement = calloc((size_t)design->mesh.free_dof, sizeof *displacement), work = 0;
    for (int k = 0; k < design->loads; k++)
        value[design->amplifiers + k] = design->load[k].type != LOAD_TEMPERATURE;
    const pzs_status status =
        displacement ? pzs_solve(&analysis->model, value, displacement) : PZS_E_WORKSPACE;
    for (int k = design->amplifiers; status == PZS_OK && k < design->amplifiers + design->loads;
         k++)
        for (uint32_t entry = in->start[k]; entry < in->start[k + 1]; entry++)
            work += value[k] * in->value[entry] * displacement[in->dof[entry]];
    free(displacement);
    return status == PZS_OK ? work : (double)NAN;
}

/*
 * Method: the ratio of the stiffness with open electrodes to that with short-circuited ones is the
 * inverse ratio of the works of the same loads. The work is smaller with open electrodes, by the
 * sum of open-circuit voltage times short-circuit charge over the electrodes.
 */
double analysis_stiffening(analysis *analysis)
{
    const design *design = &analysis->design;
    const pzs_electrodes *tables = &design->electrodes;
    double *value = calloc(design->structure.input.count + 1u, sizeof *value),
           *charge = calloc(tables->count + 1u, sizeof *charge);
    double work = (double)NAN, released = 0;
    const pzs_model kept = analysis->model; /* linear solves overwrite data in the library's model
                                               of the structure, which are restored from the copy
                                               `kept` afterwards */
    if (value && charge && !analysis->is_nonlinear && tables->count > 0 &&
        pzs_electrode_open_count(tables) > 0 && design->loads > 0) {
        work = work_of_loads(analysis, value);
        const int known = pzs_charges(&analysis->electric, value, charge) == PZS_OK &&
                          pzs_open_voltages(&analysis->electric, value) == PZS_OK;
        for (int k = 0; known && k < tables->count; k++)
            released -= charge[k] * value[tables->input[k]];
        work = known ? work : (double)NAN;
    }
    analysis->model = kept;
    free(value);
    free(charge);
    return work > 0 ? work / (work - released) : (double)NAN;
}

void analysis_free(analysis *analysis)
{
    certificate_free(&analysis->certificate);
    load_path_free(&analysis->load_path);
    equilibrium_close(&analysis->equilibrium);
    design_free(&analysis->design);
    free(analysis->work);
    free(analysis->influence);
    free(analysis->electric_work);
    free(analysis->input_value);
    free(analysis->charge);
    free(analysis->recovered);
    reactions_free(&analysis->reactions);
    linearised_free(&analysis->about);
    if (analysis->modes)
        kept_modes_free(analysis->modes);
    free(analysis->modes);
    memset(analysis, 0, sizeof *analysis);
}
