/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Follower loads: pressures that turn with a face of the shell (pzs_nonlinear.h). At a corner of an
 * element the pressure acts on the loaded face along the normal n of the curved shell. The flat
 * element is inclined to the shell there. The part of its normal that n leaves out is `side`; the
 * force in this direction acts on the middle surface:
 *
 *    n = U_1 x U_2  with  U_a = G_a - (g_a . e3) t
 *   side = lean_1 t x U_2 + lean_2 U_1 x t
 *   g_a, G_a  undeformed and deformed base vectors of the face in the surface direction a
 *   e3, t     normal and director of the shell
 *   lean_a    pzs_follower.lean, component along e3 of the base vector of the flat element in
 *             direction a, which n leaves out
 */
#include "face.h"
#include "../core/guard.h"
#include "../model/compact.h"
#include "../model/model.h"
#include "nonlinear.h"
#include "../model/shell.h"
#include <string.h>

#if PZS_NONLINEAR

/*
 * A vector at a corner of an element (a base vector, or a direction of the follower pressure) with
 * its 15 derivatives: with respect to the displacement of the loaded face at the four corners (12
 * columns), then with respect to the director of the corner (3 columns).
 */
enum { BY_DIRECTOR = 12, VARIABLES = 15 };
typedef struct vector_slope {
    pzs_real value[3], slope[3][VARIABLES];
} vector_slope;

/*
 * Number of degrees of freedom of an element that move a face of the shell: mean displacement and
 * difference over the thickness, six for each of the four corners.
 */
enum { CORNER_DOF = 6, FACE_DOF = 24 };

/*
 * Add the vector product of two vectors at a corner of an element, times a factor, to the vector
 * `sum`. The vectors are base vectors or directions of a follower pressure. The derivatives of the
 * product by displacements and director of the corner are added to the derivatives of `sum`.
 */
static void add_cross(pzs_real factor, const vector_slope *left, const vector_slope *right,
                      vector_slope *sum)
{
    pzs_real left_part[3], right_part[3];
    pzs_face_cross(left->value, right->value, left_part);
    for (int i = 0; i < 3; i++)
        sum->value[i] += factor * left_part[i];
    for (int j = 0; j < VARIABLES; j++) {
        const pzs_real dx[3] = {left->slope[0][j], left->slope[1][j], left->slope[2][j]};
        const pzs_real dy[3] = {right->slope[0][j], right->slope[1][j], right->slope[2][j]};
        pzs_face_cross(dx, right->value, left_part);
        pzs_face_cross(left->value, dy, right_part);
        for (int i = 0; i < 3; i++)
            sum->slope[i][j] += factor * (left_part[i] + right_part[i]);
    }
}

/*
 * Divide the direction of a follower pressure by `size`, the length of the normal of the deformed
 * face, so that the pressure counts per undeformed area. The derivatives of the direction with
 * respect to the displacement are updated, too.
 */
static void normalise(const vector_slope *normal, pzs_real size, vector_slope *vector)
{
    const pzs_real inverse = size > 0 ? 1 / size : 0;
    for (int i = 0; i < 3; i++)
        vector->value[i] *= inverse;
    for (int j = 0; j < VARIABLES; j++) {
        const pzs_real relative = inverse * (normal->value[0] * normal->slope[0][j] +
                                             normal->value[1] * normal->slope[1][j] +
                                             normal->value[2] * normal->slope[2][j]);
        for (int i = 0; i < 3; i++)
            vector->slope[i][j] = inverse * (vector->slope[i][j] - relative * vector->value[i]);
    }
}

/*
 * Set the vector U_a = G_a - (g_a . e3) t in surface direction a at one corner of the loaded face,
 * with its derivatives. The follower pressure acts along U_1 x U_2.
 *   face_base [3] in   deformed base vector G_a of the face; g_a: the undeformed one
 *   director      in   director t of the shell; e3: its normal
 *   base          out  U_a
 */
static void set_base(const pzs_element_type *type, pzs_real height, unsigned corner,
                     unsigned direction, const pzs_real face_base[3], const vector_slope *director,
                     vector_slope *base)
{
    const unsigned neighbour = direction == 0 ? corner ^ 1u : 3u - corner;
    const pzs_real lean =
        type->g_mean[corner][direction][2] + height * type->g_diff[corner][direction][2];
    memset(base, 0, sizeof *base);
    for (unsigned i = 0; i < 3; i++) {
        base->value[i] = face_base[i] - lean * director->value[i];
        base->slope[i][BY_DIRECTOR + i] = -lean;
        for (unsigned j = 0; j < 3; j++) {
            base->slope[i][3 * corner + j] = type->s[corner][direction][i][j];
            base->slope[i][3 * neighbour + j] = type->t[corner][direction][i][j];
        }
    }
}

/* Element on which a follower pressure acts, at its present displacement. */
typedef struct pressed_element {
    const pzs_element_type *type;
    const pzs_real (*lean)[2]; /* [4] for each corner of the element: components of its two base
                                  vectors along the director, from pzs_follower.lean; NULL: not
                                  taken into account */
    pzs_real height;           /* height of the loaded face above the middle of the shell (m) */
    pzs_real displacement[SHELL_NODES][3]; /* displacement of the loaded face at the corners (m) */
} pressed_element;

/*
 * Compute the directions of the two forces of a follower pressure at one corner of an element, with
 * their derivatives. Where the pressure counts per deformed area, both are multiplied by the ratio
 * of deformed to undeformed area.
 *   displacement [4][3] in   displacement of the face at the corners (m)
 *   director_at  [3]    in   director of the corner
 *   normal              out  direction of the force on the loaded face: its normal
 *   side                out  direction of the force on the middle surface; zero on a flat shell,
 *                            where the edges are at right angles to the director
 */
static void pressure_force(const pzs_follower *load, const pressed_element *element,
                           const pzs_real director_at[3], unsigned corner, vector_slope *normal,
                           vector_slope *side)
{
    pzs_real face_base[2][3];
    vector_slope director = {{director_at[0], director_at[1], director_at[2]}, {{0}}}, base[2];
    pzs_face_base(element->type, element->height, (const pzs_real(*)[3])element->displacement,
                  corner, face_base);
    for (unsigned i = 0; i < 3; i++)
        director.slope[i][BY_DIRECTOR + i] = 1;
    for (unsigned direction = 0; direction < 2; direction++)
        set_base(element->type, element->height, corner, direction, face_base[direction], &director,
                 &base[direction]);
    memset(normal, 0, sizeof *normal);
    memset(side, 0, sizeof *side);
    add_cross(1, &base[0], &base[1], normal);
    if (element->lean) {
        add_cross(element->lean[corner][0], &director, &base[1], side);
        add_cross(element->lean[corner][1], &base[0], &director, side);
    }
    if (!load->true_area) {
        const vector_slope unscaled = *normal;
        const pzs_real size =
            PZS_SQRT(normal->value[0] * normal->value[0] + normal->value[1] * normal->value[1] +
                     normal->value[2] * normal->value[2]);
        normalise(&unscaled, size, side);
        normalise(&unscaled, size, normal);
    }
}

/*
 * Add to the force [24] on an element the force of the follower pressure at one corner, `part`
 * times its direction. It acts on the six degrees of freedom of the corner `loaded_corner`. The
 * derivatives of this force with respect to the displacement are added to slope [24][24], which may
 * be NULL.
 */
static void add_corner_force(const vector_slope *vector, pzs_real part, pzs_real z_load,
                             pzs_real height, unsigned corner, unsigned loaded_corner,
                             pzs_real *force, pzs_real (*slope)[FACE_DOF])
{
    for (unsigned i = 0; i < 6; i++) {
        const pzs_real factor = i < 3 ? part : part * z_load;
        force[CORNER_DOF * loaded_corner + i] += factor * vector->value[i % 3];
        for (unsigned j = 0; slope && factor != 0 && j < VARIABLES; j++) {
            const unsigned column = j < BY_DIRECTOR ? CORNER_DOF * (j / 3) + j % 3
                                                    : CORNER_DOF * corner + j - BY_DIRECTOR + 3;
            const pzs_real change = factor * vector->slope[i % 3][j];
            slope[CORNER_DOF * loaded_corner + i][column] += change;
            if (j < BY_DIRECTOR)
                slope[CORNER_DOF * loaded_corner + i][column + 3] += height * change;
        }
    }
}

/*
 * Return the index in pzs_follower.share of the part of the pressure at `corner` of an element that
 * acts on the node at `loaded_corner`: 0 if the two corners are the same, 1 if they are neighbours,
 * 2 if they are opposite.
 */
static unsigned share_index(unsigned loaded_corner, unsigned corner)
{
    if (loaded_corner == corner)
        return 0;
    return (loaded_corner ^ corner) == 2 ? 2 : 1;
}

/*
 * Compute the forces of a follower load (pressure that turns with the shell) on one element at the
 * present displacement, in the frames of its corners.
 *   load_value     in   input value that scales the load
 *   force [24]     out  forces (N and N m)
 *   slope [24][24] out  derivatives of the forces with respect to the displacement; NULL: not
 *                       computed
 */
static void element_forces(const pzs_follower *load, const pzs_solver *solver, uint32_t element,
                           pzs_real load_value, pzs_real *force, pzs_real (*slope)[FACE_DOF])
{
    const pzs_structure *structure = solver->state.model->state.structure;
    const uint16_t *node = structure->element[element], type = structure->element_type[element];
    const pzs_real height = pzs_face_height(structure, load->normal_face),
                   z_load = pzs_face_height(structure, load->load_face);
    pressed_element pressed = {.type = pzs_model_element_type(solver->state.model, element),
                               .lean = load->lean ? load->lean[type] : NULL,
                               .height = height};
    pzs_real gathered[SHELL_MAX];
    pzs_model_gather(solver->state.model, node, SHELL_NODES, solver->state.displacement, gathered);
    pzs_face_gather(solver->state.model, node, SHELL_NODES, height, solver->state.displacement,
                    pressed.displacement);
    memset(force, 0, FACE_DOF * sizeof *force);
    if (slope)
        memset(slope, 0, FACE_DOF * sizeof *slope);
    for (unsigned corner = 0; corner < SHELL_NODES; corner++) {
        const pzs_real size = load_value * load->pressure[node[corner]] * load->area[type][corner],
                       *difference = gathered + corner * structure->dof_per_node + 3;
        const pzs_real director[3] = {difference[0], difference[1], 1 + difference[2]};
        vector_slope normal, side;
        pressure_force(load, &pressed, director, corner, &normal, &side);
        for (unsigned loaded_corner = 0; loaded_corner < SHELL_NODES; loaded_corner++) {
            const pzs_real part = size * load->share[share_index(loaded_corner, corner)];
            if (part != 0)
                add_corner_force(&normal, part, z_load, height, corner, loaded_corner, force,
                                 slope);
            if (part != 0 && load->lean)
                add_corner_force(&side, part, 0, height, corner, loaded_corner, force, slope);
        }
    }
}

/* ---- over the dof of an element ---------------------------------------- */

/*
 * Return the index of degree of freedom i of an element among the 24 that move a face of the shell
 * (0 to 23). The seventh degree of freedom of a node moves no face; for it FACE_DOF is returned.
 */
static unsigned face_dof_of(unsigned i, unsigned dof_per_node)
{
    return i % dof_per_node < CORNER_DOF ? i / dof_per_node * CORNER_DOF + i % dof_per_node
                                         : FACE_DOF;
}

/*
 * Add the nodal forces [24] of a follower load on an element, times a factor, to `vector`
 * [free_dof].
 */
static void scatter_forces(const pzs_solver *solver, uint32_t element, pzs_real factor,
                           const pzs_real *force, pzs_real *vector)
{
    const pzs_structure *structure = solver->state.model->state.structure;
    pzs_real all[SHELL_MAX];
    for (unsigned i = 0; i < SHELL_NODES * (unsigned)structure->dof_per_node; i++)
        all[i] = face_dof_of(i, structure->dof_per_node) < FACE_DOF
                     ? force[face_dof_of(i, structure->dof_per_node)]
                     : 0;
    pzs_model_scatter(solver->state.model, structure->element[element], SHELL_NODES, factor, all,
                      vector);
}

/*
 * Compute the symmetric part of the tangent stiffness of a follower load on an element, as a packed
 * lower triangle. With the derivatives S of the forces by the displacement it is -(S + S') / 2,
 * where S' is the transpose of S.
 */
static void symmetric_tangent(pzs_real (*slope)[FACE_DOF], unsigned dof_per_node, pzs_real *k)
{
    unsigned face_dof[SHELL_MAX];
    for (unsigned i = 0; i < SHELL_NODES * dof_per_node; i++) {
        face_dof[i] = face_dof_of(i, dof_per_node);
        for (unsigned j = 0; j <= i; j++)
            *k++ = face_dof[i] < FACE_DOF && face_dof[j] < FACE_DOF
                       ? -(slope[face_dof[i]][face_dof[j]] + slope[face_dof[j]][face_dof[i]]) / 2
                       : 0;
    }
}

/* ---- calls -------------------------------------------------------------- */

static void add_forces(pzs_solver_option *option, pzs_solver *solver, pzs_real *load)
{
    const pzs_follower *tables = ((pzs_follower_load *)option)->state.tables;
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_real load_value = solver->state.input_value[tables->input];
    for (uint32_t element = 0; load_value != 0 && element < structure->elements; element++) {
        pzs_real force[FACE_DOF], slope[FACE_DOF][FACE_DOF], k[SHELL_PACKED(SHELL_MAX)];
        element_forces(tables, solver, element, load_value, force, slope);
        scatter_forces(solver, element, 1, force, load);
        symmetric_tangent(slope, structure->dof_per_node, k);
        pzs_model_add_matrix(solver->state.model, structure->element[element], SHELL_NODES, 1, k);
    }
}

static void add_unit_force(pzs_solver_option *option, pzs_solver *solver, uint32_t input,
                           pzs_real *out)
{
    const pzs_follower *tables = ((pzs_follower_load *)option)->state.tables;
    for (uint32_t element = 0;
         input == tables->input && element < solver->state.model->state.structure->elements;
         element++) {
        pzs_real force[FACE_DOF];
        element_forces(tables, solver, element, 1, force, NULL);
        scatter_forces(solver, element, 1, force, out);
    }
}

/*
 * Add the product A x, times a factor, to y [free_dof]. A is the skew-symmetric part of the
 * derivative of the forces of a follower load, and x [free_dof] is a displacement.
 */
static void add_skew(pzs_solver_option *option, pzs_solver *solver, const pzs_real *x,
                     pzs_real factor, pzs_real *y)
{
    const pzs_follower *tables = ((pzs_follower_load *)option)->state.tables;
    const pzs_structure *structure = solver->state.model->state.structure;
    const pzs_real load_value = solver->state.input_value[tables->input];
    for (uint32_t element = 0; load_value != 0 && element < structure->elements; element++) {
        pzs_real force[FACE_DOF], slope[FACE_DOF][FACE_DOF], gathered[SHELL_MAX], x_face[FACE_DOF];
        element_forces(tables, solver, element, load_value, force, slope);
        pzs_model_gather(solver->state.model, structure->element[element], SHELL_NODES, x,
                         gathered);
        for (unsigned i = 0; i < FACE_DOF; i++) {
            x_face[i] = gathered[i / CORNER_DOF * structure->dof_per_node + i % CORNER_DOF];
            force[i] = 0;
        }
        for (unsigned i = 0; i < FACE_DOF; i++)
            for (unsigned j = 0; j < FACE_DOF; j++)
                force[i] += (slope[i][j] - slope[j][i]) * x_face[j];
        scatter_forces(solver, element, factor / 2, force, y);
    }
}

static const struct pzs_solver_option_calls calls = {
    .add_forces = add_forces, .add_unit_force = add_unit_force, .add_skew = add_skew};

uint32_t pzs_follower_crc(const pzs_follower *tables, const pzs_structure *structure)
{
    const uint16_t counts[4] = {tables->input, tables->load_face, tables->normal_face,
                                tables->true_area};
    uint32_t crc = pzs_guard_crc(GUARD_CRC_START, counts, sizeof counts);
    crc = pzs_guard_crc(crc, tables->share, sizeof tables->share);
    crc = pzs_guard_crc(crc, tables->area, structure->types * sizeof *tables->area);
    if (tables->lean)
        crc = pzs_guard_crc(crc, tables->lean, structure->types * sizeof *tables->lean);
    return ~pzs_guard_crc(crc, tables->pressure, structure->nodes * sizeof *tables->pressure);
}

pzs_status pzs_follower_seal(pzs_follower *tables, const pzs_structure *structure)
{
    if (!tables || !structure || !tables->area || !tables->pressure)
        return PZS_E_ARGUMENT;
    tables->format = PZS_TABLE_FORMAT;
    tables->scene = structure->scene;
    tables->crc = pzs_follower_crc(tables, structure);
    return PZS_OK;
}

static pzs_status check_tables(const pzs_follower *tables, const pzs_structure *structure)
{
    if (!tables->area || !tables->pressure)
        return PZS_E_ARGUMENT;
    if (tables->format != PZS_TABLE_FORMAT || tables->scene != structure->scene)
        return PZS_E_FORMAT;
    if (pzs_follower_crc(tables, structure) != tables->crc)
        return PZS_E_CRC;
    return tables->load_face <= 2 && tables->normal_face <= 1 &&
                   tables->input < structure->input.count
               ? PZS_OK
               : PZS_E_ARGUMENT;
}

pzs_status pzs_attach_follower(pzs_solver *solver, pzs_follower_load *load,
                               const pzs_follower *tables)
{
    if (!solver || !solver->state.model || !load || !tables ||
        pzs_nonlinear_is_attached(solver, &load->option))
        return PZS_E_ARGUMENT;
    const pzs_status status = check_tables(tables, solver->state.model->state.structure);
    if (status != PZS_OK)
        return status;
    load->state.tables = tables;
    pzs_nonlinear_attach(solver, &load->option, &calls);
    return PZS_OK;
}

#endif
