/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Motion of a shell with mass at large rotation, computed by energy-momentum steps
 * (shell_motion.h).
 */
#include "shell_motion.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/guard.h"
#include "../../lib/core/linalg.h"
#include "../../lib/core/product.h"
#include "../../lib/model/model.h"
#include "../../lib/model/shell.h"
#include "../../lib/model/spring.h"
#include "../../lib/nonlinear/nonlinear.h"
#include "../model/modal.h"

/*
 * Largest number of linear solves in one time step of the motion of a shell. A time step that needs
 * more is divided into two halves.
 */
enum { SOLVES_MOST = 16 };

/*
 * Convergence tolerance of Newton's method in a time step: largest norm of the last increment
 * relative to the change of the displacement in half the step. If the structure hardly moves,
 * least_change times the norm of the displacement replaces the change.
 */
static const double tolerance = 1e-7, least_change = 1e-3;

/*
 * Tolerances of a time step, for the last Newton increment.
 *   balanced            largest size of the increment, relative to the change of the displacement
 *       in half the step, at which no further linear solve is needed
 *   largest_correction  largest factor of the increment that balance_energy may add; a larger one
 *       requires another linear solve
 */
static const double balanced = 1e-6, largest_correction = 0.1;

/*
 * Newton's method uses the factors of its matrix again for the next linear solve of a time step on
 * two conditions: the relative increment is below small_increment, and it has decreased to at most
 * slow_decrease times the one before.
 */
static const double small_increment = 1e-3, slow_decrease = 0.2;

/*
 * Largest phase (rad) by which a vibration mode may advance: in a time step, so that the step
 * resolves the mode (step_phase), and in a control tick, so that a controller can damp it
 * (tick_phase).
 */
static const double step_phase = 0.5, tick_phase = 2;

static const pzs_structure *structure_of(const shell_motion *motion)
{
    return motion->solver.state.model->state.structure;
}

/* ---- preparation of the motion ---------------------------------------- */

static bool take_memory(shell_motion *motion)
{
    const pzs_structure *structure = structure_of(motion);
    const size_t dof = structure->free_dof, elements = structure->elements,
                 inputs = structure->input.count;
    const size_t vectors = 10 * dof + inputs;
    motion->memory = calloc(vectors + (22 + 22 + 10) * elements, sizeof *motion->memory);
    if (!motion->memory)
        return false;
    double *at = motion->memory;
    double **const of_dof[] = {
        &motion->displacement,     &motion->velocity,       &motion->acceleration,
        &motion->half_change,      &motion->increment,      &motion->end,
        &motion->scratch,          &motion->last_increment, &motion->solver.state.displacement,
        &motion->solver.state.load};
    for (size_t i = 0; i < sizeof of_dof / sizeof *of_dof; i++, at += dof)
        *of_dof[i] = at;
    motion->solver.state.input_value = at;
    at += inputs;
    motion->start_resultant = (double(*)[22])at;
    motion->solver.state.resultant = motion->start_resultant + elements;
    motion->solver.state.prescribed = (double(*)[10])(motion->solver.state.resultant + elements);
    return true;
}

/*
 * Return the number of vibration modes, without rigid motions, whose phase advances by at most half
 * a radian in a time step. The time steps resolve only these modes.
 */
static size_t count_followed(const vibration *vibration, double step)
{
    size_t count = 0;
    for (int mode = vibration->rigid; mode < vibration->count; mode++)
        count += sqrt(vibration->square[mode]) * step <= step_phase * (1 + 1e-9);
    return count;
}

/*
 * Choose the viscosity b (s) where the scene file states damping ratios. A viscosity damps a
 * vibration mode of angular frequency w with the ratio b w/2. The largest viscosity is chosen with
 * which no mode that the time steps resolve exceeds its stated damping ratio.
 */
static double viscosity_of(const shell_motion *motion, const scene_dynamics *dynamics)
{
    double viscosity = HUGE_VAL;
    for (size_t i = 0; i < motion->modes; i++) {
        const double frequency =
            sqrt(motion->vibration->square[(size_t)motion->vibration->rigid + i]);
        viscosity = fmin(viscosity, 2 * modal_damping(dynamics, (int)i, frequency) / frequency);
    }
    return isfinite(viscosity) ? viscosity : 0;
}

/*
 * Prepare the damping of the motion from the section `dynamics` of the scene. Returns whether
 * memory was available.
 */
static bool prepare_damping(shell_motion *motion, const scene_dynamics *dynamics)
{
    const vibration *vibration = motion->vibration;
    const size_t dof = structure_of(motion)->free_dof;
    if (dynamics->is_rayleigh) {
        motion->mass_damping = dynamics->rayleigh[0];
        motion->viscosity = dynamics->rayleigh[1];
        return true;
    }
    motion->modes = count_followed(vibration, motion->step_most);
    motion->viscosity = viscosity_of(motion, dynamics);
    motion->mode_damping = calloc(motion->modes + 1, sizeof *motion->mode_damping);
    motion->mode_force = calloc(motion->modes * dof + 1, sizeof *motion->mode_force);
    if (!motion->mode_damping || !motion->mode_force)
        return false;
    for (size_t i = 0; i < motion->modes; i++) {
        const size_t mode = (size_t)vibration->rigid + i;
        const double frequency = sqrt(vibration->square[mode]);
        const double of_scene = 2 * modal_damping(dynamics, (int)i, frequency) * frequency;
        const double by_viscosity = motion->viscosity * vibration->square[mode];
        motion->mode_damping[i] = fmax(0, of_scene - by_viscosity);
        mass_multiply(&motion->mass, motion->solver.state.model, vibration->shape + mode * dof, 1,
                      motion->mode_force + i * dof);
    }
    return true;
}

int shell_motion_open(shell_motion *motion, const equilibrium *equilibrium,
                      const vibration *vibration, double step_most, char *error)
{
    const design *design = equilibrium->design;
    memset(motion, 0, sizeof *motion);
    motion->vibration = vibration;
    motion->solver = equilibrium->solver;
    motion->step_most = step_most;
    if (mass_build(&motion->mass, design, MASS_LUMPED, error) < 0)
        return -1;
    if (!take_memory(motion) || (vibration && !prepare_damping(motion, &design->dynamics)))
        return scene_fault(design->simulate.at, error, "out of memory");
    return 0;
}

void shell_motion_close(shell_motion *motion)
{
    mass_free(&motion->mass);
    free(motion->mode_damping);
    free(motion->mode_force);
    free(motion->memory);
    memset(motion, 0, sizeof *motion);
}

double shell_motion_step(const vibration *vibration, double interval)
{
    double fastest = 0;
    for (int mode = vibration->rigid; mode < vibration->count; mode++) {
        const double phase = sqrt(vibration->square[mode]) * interval;
        if (fastest == 0 || phase <= tick_phase)
            fastest = phase;
    }
    return interval / fmax(1, ceil(fastest / step_phase));
}

/* ---- forces and tangents of elements ---------------------------------- */

/*
 * Compute the stress resultants of one element at a displacement, without the prescribed ones.
 * Given an increment, they are linearly extrapolated along it.
 *   displacement [4 dof_per_node] in   nodal displacement: translations (m) and dimensionless dof
 *   increment    [4 dof_per_node] in   increment of the displacement; NULL: none
 *   resultant    [22]             out  stress resultants times the area of the element (N m), of
 *       its constant, linear and bilinear strains
 */
static void elastic_resultants(const shell_motion *motion, uint32_t element,
                               const double *displacement, const double *increment,
                               double resultant[22])
{
    const pzs_structure *structure = structure_of(motion);
    pzs_shell_resultants(&structure->type[structure->element_type[element]],
                         structure->dof_per_node, displacement, increment, NULL, resultant);
}

static void gather(const shell_motion *motion, uint32_t element, const double *vector,
                   double gathered[SHELL_MAX])
{
    pzs_model_gather(motion->solver.state.model, structure_of(motion)->element[element],
                     SHELL_NODES, vector, gathered);
}

/*
 * Return the factor 1 + b/h by which viscosity b (motion->viscosity, s) increases the elastic part
 * of an element's tangent stiffness in a time step of length h (s). Viscosity adds b/2 times the
 * rate of the stress resultants to them.
 */
static double tangent_factor(const shell_motion *motion, double step)
{
    return 1 + motion->viscosity / step;
}

/*
 * Return the time (h + b)/2 (s) by which the change of velocity enters the change of displacement
 * in a time step of length h with viscosity b (motion->viscosity):
 *   u1 - u0 = h v0 + (h + b)/2 (v1 - v0).
 *   u0, v0, u1, v1  displacement and velocity at the start and at the end of the step
 */
static double response_time(const shell_motion *motion, double step)
{
    return (step + motion->viscosity) / 2;
}

/*
 * Return the factor of the mass matrix in the tangent matrix of a time step (1/s2): derivative of
 * acceleration plus mass_damping times velocity with respect to the unknown, the change of the
 * displacement in half the step.
 */
static double mass_factor(const shell_motion *motion, double step)
{
    return 2 / (step * response_time(motion, step)) + 2 * motion->mass_damping / step;
}

/*
 * Compute the stress resultants of an element that act at half a time step, with viscosity and with
 * the prescribed resultants of voltages and temperature.
 *   resultant  [22] out  stress resultants times the area of the element (N m), of its constant,
 *                        linear and bilinear strains
 */
static void acting_resultants(const shell_motion *motion, uint32_t element, double step,
                              double resultant[22])
{
    double displacement[SHELL_MAX], at_end[22];
    const double *at_start = motion->start_resultant[element];
    gather(motion, element, motion->end, displacement);
    elastic_resultants(motion, element, displacement, NULL, at_end);
    for (int i = 0; i < 22; i++)
        /*
         * Mean of the stress resultants at both ends of the time step, plus viscosity/2 times the
         * rate at which they change.
         */
        resultant[i] = (at_start[i] + at_end[i]) / 2 +
                       motion->viscosity / (2 * step) * (at_end[i] - at_start[i]);
    for (int i = 0; i < SHELL_STRAINS; i++)
        resultant[i] += motion->solver.state.prescribed[element][i];
}

/*
 * Add the tangent stiffness and the mass of one element to the matrix of a time step. The geometric
 * part of the tangent stiffness is computed from motion->solver.state.resultant: stress resultants
 * that are linearly extrapolated to the present displacement (extrapolate).
 */
static void add_tangent(shell_motion *motion, uint32_t element, double step)
{
    pzs_model *model = motion->solver.state.model;
    const pzs_structure *structure = structure_of(motion);
    const double elastic = tangent_factor(motion, step);
    double displacement[SHELL_MAX], force[SHELL_MAX], tangent[SHELL_PACKED(SHELL_MAX)],
        geometric[22];
    gather(motion, element, motion->solver.state.displacement, displacement);
    for (int i = 0; i < 22; i++)
        geometric[i] = motion->solver.state.resultant[element][i] / elastic;
    pzs_shell_system(&structure->type[structure->element_type[element]], structure->dof_per_node,
                     displacement, NULL, geometric, force, tangent);
    pzs_model_add_matrix(model, structure->element[element], SHELL_NODES,
                         pzs_model_type_factor(model, element) * elastic, tangent);
    pzs_model_add_matrix(model, structure->element[element], SHELL_NODES, mass_factor(motion, step),
                         mass_element(&motion->mass, (int)element));
}

/*
 * Subtract the internal force of one element at half the time step from the force imbalance. Store
 * the stress resultants that act there in motion->solver.state.resultant. After the next linear
 * solve, extrapolate() adds their first-order change to them.
 */
static void subtract_internal_force(shell_motion *motion, uint32_t element, double step,
                                    double *imbalance)
{
    pzs_model *model = motion->solver.state.model;
    const pzs_structure *structure = structure_of(motion);
    double displacement[SHELL_MAX], force[SHELL_MAX], acting[22];
    gather(motion, element, motion->solver.state.displacement, displacement);
    acting_resultants(motion, element, step, acting);
    pzs_shell_force_at(&structure->type[structure->element_type[element]], structure->dof_per_node,
                       displacement, acting, force);
    pzs_model_scatter(model, structure->element[element], SHELL_NODES,
                      -pzs_model_type_factor(model, element), force, imbalance);
    memcpy(motion->solver.state.resultant[element], acting, sizeof acting);
}

/*
 * For all elements, extrapolate the stress resultants at half the time step along the last Newton
 * increment.
 */
static void extrapolate(shell_motion *motion, double step)
{
    const double elastic = tangent_factor(motion, step);
    for (uint32_t element = 0; element < structure_of(motion)->elements; element++) {
        double displacement[SHELL_MAX], increment[SHELL_MAX], before[22], after[22];
        gather(motion, element, motion->solver.state.displacement, displacement);
        gather(motion, element, motion->increment, increment);
        elastic_resultants(motion, element, displacement, NULL, before);
        elastic_resultants(motion, element, displacement, increment, after);
        for (int i = 0; i < 22; i++)
            motion->solver.state.resultant[element][i] += elastic * (after[i] - before[i]);
    }
}

/* ---- one linear solve of a time step ------------------------------------ */

/*
 * Whether an input, such as a voltage or a temperature, acts by prescribed stress resultants and
 * not by a load.
 */
static bool is_actuation(const shell_motion *motion, uint32_t input)
{
    const uint32_t *start = motion->solver.state.tables->resultants.start;
    return start && start[input + 1] > start[input];
}

/*
 * Add the nodal forces of all loads to the force imbalance at half the time step: value of each
 * input times its nodal forces per unit. For a load that follows the deformed shell, these are the
 * forces at the displacement at half the step.
 */
static void add_loads(shell_motion *motion, double *imbalance)
{
    pzs_solver *solver = &motion->solver;
    const uint32_t dof = structure_of(motion)->free_dof;
    double *const unit = motion->scratch;
    for (uint32_t input = 0; input < structure_of(motion)->input.count; input++) {
        const double value = solver->state.input_value[input];
        if (value == 0 || is_actuation(motion, input))
            continue;
        memset(unit, 0, dof * sizeof *unit);
        pzs_nonlinear_unit_force(solver, input, unit);
        for (uint32_t i = 0; i < dof; i++)
            imbalance[i] += value * unit[i];
    }
}

/* Subtract the derivative of the follower loads from the matrix of a time step. */
static void subtract_load_tangent(shell_motion *motion)
{
    pzs_solver *solver = &motion->solver;
    memset(motion->scratch, 0, structure_of(motion)->free_dof * sizeof *motion->scratch);
    for (pzs_solver_option *option = solver->state.option; option; option = option->next)
        if (option->call->add_forces)
            option->call->add_forces(option, solver, motion->scratch);
}

/*
 * Subtract inertia, mass-proportional damping, and the damping of individual modes from the force
 * imbalance of a time step. The matrix of the step leaves out the damping of individual modes,
 * which would make it dense. In these modes a Newton iteration therefore multiplies an error by
 * about the damping ratio of the mode.
 */
static void subtract_inertia(shell_motion *motion, double step, double *imbalance)
{
    const size_t dof = structure_of(motion)->free_dof;
    double *const acceleration = motion->scratch;
    const double factor = mass_factor(motion, step), time = response_time(motion, step);
    for (size_t i = 0; i < dof; i++)
        acceleration[i] = factor * motion->half_change[i] - motion->velocity[i] / time;
    mass_multiply(&motion->mass, motion->solver.state.model, acceleration, 1, motion->increment);
    for (size_t i = 0; i < dof; i++)
        imbalance[i] -= motion->increment[i];
    for (size_t mode = 0; mode < motion->modes; mode++) {
        const double *force = motion->mode_force + mode * dof;
        const double speed = 2 / step * pzs_linalg_inner(force, motion->half_change, (uint32_t)dof);
        for (size_t i = 0; i < dof; i++)
            imbalance[i] -= motion->mode_damping[mode] * speed * force[i];
    }
}

/*
 * Compute the force imbalance of a time step at the present displacement at half the step, and the
 * displacement at the end of the step.
 *   imbalance [free_dof] out  force imbalance (N and N m)
 */
static void compute_imbalance(shell_motion *motion, double step, double *imbalance)
{
    pzs_solver *solver = &motion->solver;
    const pzs_structure *structure = structure_of(motion);
    double *const strained = motion->scratch;
    memset(imbalance, 0, structure->free_dof * sizeof *imbalance);
    for (uint32_t i = 0; i < structure->free_dof; i++) {
        motion->end[i] = motion->displacement[i] + 2 * motion->half_change[i];
        strained[i] =
            solver->state.displacement[i] + motion->viscosity / step * motion->half_change[i];
    }
    for (uint32_t element = 0; element < structure->elements; element++)
        subtract_internal_force(motion, element, step, imbalance);
    pzs_model_add_spring_force(solver->state.model, -1, strained, imbalance);
    add_loads(motion, imbalance);
    subtract_inertia(motion, step, imbalance);
    pzs_nonlinear_clear_prescribed(solver, imbalance);
}

/*
 * Assemble the matrix of a time step for the displacement at half the step, and factor it. Returns
 * whether the matrix is regular.
 */
static bool factor_matrix(shell_motion *motion, double step)
{
    pzs_solver *solver = &motion->solver;
    pzs_model *model = solver->state.model;
    const pzs_prescribed_motion *held = &solver->state.tables->prescribed;
    pzs_linalg_clear(&model->state.stiffness);
    model->state.stage = STAGE_READY;
    for (uint32_t element = 0; element < structure_of(motion)->elements; element++)
        add_tangent(motion, element, step);
    pzs_model_add_springs(model);
    subtract_load_tangent(motion);
    for (uint32_t i = 0; i < held->count; i++)
        pzs_nonlinear_prescribe(&model->state.stiffness, held->dof[i], 0, motion->scratch);
    motion->factorisations++;
    return pzs_nonlinear_factor(solver);
}

/*
 * Make one linear solve of Newton's method in a time step, and update the displacement and the
 * stress resultants.
 *   is_new in  true: factor the matrix at the present displacement first; false: use the factors of
 *              the last call
 * Returns false where the matrix is singular or a result is not finite.
 */
static bool solve_and_update(shell_motion *motion, double step, bool is_new)
{
    pzs_solver *solver = &motion->solver;
    const uint32_t dof = structure_of(motion)->free_dof;
    double *const imbalance = solver->state.load;
    motion->linear_solves++;
    if (is_new && !factor_matrix(motion, step))
        return false;
    compute_imbalance(motion, step, imbalance);
    motion->work = pzs_linalg_inner(imbalance, motion->half_change, dof);
    pzs_model_backsolve(solver->state.model, imbalance, motion->increment);
    if (pzs_guard_nonfinite(motion->increment, dof) >= 0)
        return false;
    extrapolate(motion, step);
    for (uint32_t i = 0; i < dof; i++) {
        motion->half_change[i] += motion->increment[i];
        solver->state.displacement[i] = motion->displacement[i] + motion->half_change[i];
    }
    return true;
}

/* ---- one time step ------------------------------------------------------ */

/*
 * Begin a time step: predict the displacement at half the step from the velocity and the
 * acceleration of the last step, and compute the stress resultants at the start.
 */
static void begin_step(shell_motion *motion, double step)
{
    const pzs_structure *structure = structure_of(motion);
    const pzs_prescribed_motion *held = &motion->solver.state.tables->prescribed;
    for (uint32_t i = 0; i < structure->free_dof; i++)
        motion->half_change[i] =
            step / 2 * (motion->velocity[i] + step / 2 * motion->acceleration[i]);
    for (uint32_t i = 0; i < held->count; i++)
        motion->half_change[held->dof[i]] = 0;
    for (uint32_t i = 0; i < structure->free_dof; i++)
        motion->solver.state.displacement[i] = motion->displacement[i] + motion->half_change[i];
    for (uint32_t element = 0; element < structure->elements; element++) {
        double displacement[SHELL_MAX];
        gather(motion, element, motion->displacement, displacement);
        elastic_resultants(motion, element, displacement, NULL, motion->start_resultant[element]);
    }
}

static void end_step(shell_motion *motion, double step)
{
    const double time = response_time(motion, step);
    for (uint32_t i = 0; i < structure_of(motion)->free_dof; i++) {
        const double change = 2 * motion->half_change[i];
        motion->displacement[i] += change;
        motion->acceleration[i] = (change - step * motion->velocity[i]) / (time * step);
        motion->velocity[i] += step * motion->acceleration[i];
    }
}

/*
 * Return the norm of the last Newton increment, relative to the change of the displacement in half
 * the time step. Where the structure hardly moves, a small fraction of the displacement takes the
 * place of this change.
 */
static double relative_increment(const shell_motion *motion)
{
    const pzs_solver *solver = &motion->solver;
    const double last2 = pzs_nonlinear_norm2(solver, motion->increment, NULL),
                 moved2 = pzs_nonlinear_norm2(solver, motion->half_change, NULL),
                 whole2 = pzs_nonlinear_norm2(solver, solver->state.displacement, NULL);
    const double size2 = moved2 + least_change * least_change * whole2;
    return size2 > 0 ? sqrt(last2 / size2) : 0;
}

/*
 * Remove the energy error that Newton's last force imbalance leaves in a time step, by adding a
 * multiple of the last increment to the displacement change. Momentum is conserved. Returns false,
 * with the displacement unchanged, if the multiple exceeds largest_correction.
 */
static bool balance_energy(shell_motion *motion, double step)
{
    const uint32_t dof = structure_of(motion)->free_dof;
    double *const imbalance = motion->solver.state.load;
    memcpy(motion->last_increment, motion->increment, dof * sizeof *motion->increment);
    compute_imbalance(motion, step, imbalance);
    /*
     * The energy error of the time step is the work of the remaining force imbalance along the
     * displacement change. A multiple of the last increment is added that makes this work zero.
     */
    const double left = pzs_linalg_inner(imbalance, motion->half_change, dof);
    const double part = left / motion->work;
    if (!(fabs(part) <= largest_correction))
        return false;
    for (uint32_t i = 0; i < dof; i++)
        motion->half_change[i] += part * motion->last_increment[i];
    motion->corrections++;
    return true;
}

/*
 * Try one time step. Newton's method factors its matrix anew until the increments are small, and
 * later where they decrease too slowly. Returns whether the method has converged; otherwise the
 * motion is unchanged.
 */
static bool try_step(shell_motion *motion, double step)
{
    double before = 1;
    bool is_new = true;
    begin_step(motion, step);
    for (int solves = 1; solves <= SOLVES_MOST; solves++) {
        if (!solve_and_update(motion, step, is_new))
            return false;
        const double size = relative_increment(motion);
        is_new = size > small_increment || size > slow_decrease * before;
        before = size;
        const bool is_balanced = size <= balanced && balance_energy(motion, step);
        if (!is_balanced && !(size <= tolerance))
            continue;
        end_step(motion, step);
        motion->steps++;
        motion->solves_most = solves > motion->solves_most ? solves : motion->solves_most;
        return true;
    }
    return false;
}

bool shell_motion_advance(shell_motion *motion, const double *value, double seconds)
{
    const uint32_t whole = 1u << SHELL_MOTION_HALVINGS;
    const double count = ceil(seconds / motion->step_most * (1 - 1e-9));
    uint32_t left = count > 1 ? (uint32_t)count * whole : whole, stride = whole;
    const double unit = seconds / left;
    memcpy(motion->solver.state.input_value, value,
           structure_of(motion)->input.count * sizeof *value);
    pzs_nonlinear_set_prescribed(&motion->solver);
    while (left > 0 && seconds > 0) {
        stride = stride < left ? stride : left;
        if (try_step(motion, stride * unit)) {
            left -= stride;
            stride = 2 * stride < whole ? 2 * stride : whole;
        } else if (stride == 1) {
            return false;
        } else {
            stride /= 2;
        }
    }
    return true;
}

/* ---- state of the motion ------------------------------------------------ */

void shell_motion_rest(shell_motion *motion, const double *displacement, const double *value)
{
    const pzs_structure *structure = structure_of(motion);
    memcpy(motion->displacement, displacement, structure->free_dof * sizeof *displacement);
    memset(motion->velocity, 0, structure->free_dof * sizeof *motion->velocity);
    memset(motion->acceleration, 0, structure->free_dof * sizeof *motion->acceleration);
    memcpy(motion->solver.state.input_value, value, structure->input.count * sizeof *value);
    pzs_nonlinear_set_prescribed(&motion->solver);
    for (uint32_t element = 0; element < structure->elements; element++) {
        double of_element[SHELL_MAX];
        gather(motion, element, motion->displacement, of_element);
        elastic_resultants(motion, element, of_element, NULL,
                           motion->solver.state.resultant[element]);
        for (int i = 0; i < SHELL_STRAINS; i++)
            motion->solver.state.resultant[element][i] +=
                motion->solver.state.prescribed[element][i];
    }
}

void shell_motion_kick(shell_motion *motion, uint32_t input, double seconds)
{
    pzs_solver *solver = &motion->solver;
    pzs_model *model = solver->state.model;
    const pzs_structure *structure = structure_of(motion);
    const pzs_prescribed_motion *held = &solver->state.tables->prescribed;
    double *const force = motion->increment;
    memset(force, 0, structure->free_dof * sizeof *force);
    memcpy(solver->state.displacement, motion->displacement, structure->free_dof * sizeof *force);
    pzs_nonlinear_unit_force(solver, input, force);
    pzs_linalg_clear(&model->state.stiffness);
    model->state.stage = STAGE_READY;
    for (uint32_t element = 0; element < structure->elements; element++)
        pzs_model_add_matrix(model, structure->element[element], SHELL_NODES, 1,
                             mass_element(&motion->mass, (int)element));
    for (uint32_t i = 0; i < held->count; i++)
        pzs_nonlinear_prescribe(&model->state.stiffness, held->dof[i], 0, force);
    pzs_nonlinear_factor(solver);
    pzs_model_backsolve(model, force, force);
    for (uint32_t i = 0; i < structure->free_dof; i++)
        motion->velocity[i] += seconds * force[i];
}

const double *shell_motion_deviation(shell_motion *motion, const double *value)
{
    pzs_solver *solver = &motion->solver;
    const pzs_structure *structure = structure_of(motion);
    const pzs_prescribed_motion *held = &solver->state.tables->prescribed;
    const size_t bytes = structure->free_dof * sizeof *motion->increment;
    double *const deviation = motion->increment;
    memcpy(solver->state.displacement, motion->displacement, bytes);
    memcpy(solver->state.input_value, value, structure->input.count * sizeof *value);
    pzs_nonlinear_set_prescribed(solver);
    pzs_nonlinear_build(solver, true, deviation);
    for (uint32_t i = 0; i < held->count; i++)
        pzs_nonlinear_prescribe(&solver->state.model->state.stiffness, held->dof[i], 0, deviation);
    const bool is_regular = pzs_nonlinear_factor(solver);
    pzs_model_backsolve(solver->state.model, deviation, deviation);
    if (!is_regular || pzs_guard_nonfinite(deviation, structure->free_dof) >= 0)
        memset(deviation, 0, bytes);
    for (uint32_t i = 0; i < structure->free_dof; i++)
        deviation[i] = -deviation[i];
    return deviation;
}

/* ---- energy ------------------------------------------------------------- */

double shell_motion_kinetic(shell_motion *motion)
{
    const uint32_t dof = structure_of(motion)->free_dof;
    mass_multiply(&motion->mass, motion->solver.state.model, motion->velocity, 1, motion->scratch);
    return pzs_linalg_inner(motion->velocity, motion->scratch, dof) / 2;
}

/*
 * Return the work of constant stress resultants of one element from the undeformed state to the
 * present displacement u (N m): u times the internal force of the resultants at u/2. Reason: the
 * strains are quadratic in u, and equal L(u/2) u with the strain-displacement matrix L.
 */
static double work_of(const shell_motion *motion, uint32_t element, const double resultant[22])
{
    const pzs_structure *structure = structure_of(motion);
    const unsigned rows = SHELL_NODES * (unsigned)structure->dof_per_node;
    double displacement[SHELL_MAX], half[SHELL_MAX], force[SHELL_MAX];
    gather(motion, element, motion->displacement, displacement);
    for (unsigned i = 0; i < rows; i++)
        half[i] = displacement[i] / 2;
    pzs_shell_force_at(&structure->type[structure->element_type[element]], structure->dof_per_node,
                       half, resultant, force);
    return pzs_model_type_factor(motion->solver.state.model, element) *
           pzs_linalg_inner(displacement, force, rows);
}

double shell_motion_strain_energy(shell_motion *motion)
{
    const pzs_structure *structure = structure_of(motion);
    double sum = 0;
    for (uint32_t element = 0; element < structure->elements; element++) {
        double displacement[SHELL_MAX], resultant[22];
        gather(motion, element, motion->displacement, displacement);
        elastic_resultants(motion, element, displacement, NULL, resultant);
        sum += work_of(motion, element, resultant) / 2;
    }
    memset(motion->scratch, 0, structure->free_dof * sizeof *motion->scratch);
    pzs_model_add_spring_force(motion->solver.state.model, 1, motion->displacement,
                               motion->scratch);
    return sum + pzs_linalg_inner(motion->displacement, motion->scratch, structure->free_dof) / 2;
}

double shell_motion_potential(shell_motion *motion, const double *value)
{
    const pzs_structure *structure = structure_of(motion);
    double sum = 0;
    memcpy(motion->solver.state.input_value, value, structure->input.count * sizeof *value);
    pzs_nonlinear_set_prescribed(&motion->solver);
    for (uint32_t element = 0; element < structure->elements; element++) {
        double resultant[22] = {0};
        memcpy(resultant, motion->solver.state.prescribed[element],
               sizeof motion->solver.state.prescribed[element]);
        sum += work_of(motion, element, resultant);
    }
    memset(motion->scratch, 0, structure->free_dof * sizeof *motion->scratch);
    for (uint32_t input = 0; input < structure->input.count; input++)
        if (!is_actuation(motion, input))
            pzs_model_add_input(motion->solver.state.model, input, value[input], motion->scratch);
    return sum - pzs_linalg_inner(motion->displacement, motion->scratch, structure->free_dof);
}
