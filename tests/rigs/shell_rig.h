/*
 * Small shells in the precision of the test program, with an equilibrium solver on each, made
 * without the host tools. Include it after cmocka.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef SHELL_RIG_H
#define SHELL_RIG_H

#include "../../lib/model/shell_corner.h"
#include "pzs.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/guard.h"
#include "../../lib/core/linalg.h"
#include "../../lib/nonlinear/nonlinear.h"
#include "../../lib/model/shell.h"
#include "../../lib/model/model.h"

#define EPS ((double)PZS_EPSILON)
#define IS_FLOAT (PZS_REAL_BITS == 32)

enum { MOST_NODES = 200 };

static uint32_t seed = 1;

/* Random number, uniform between -1 and 1. */
static inline double uniform(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (double)(seed >> 8) / 8388608.0 - 1;
}

/* ---- a rig: n1 x n2 equal elements of one kind ------------------------- */

/*
 * Function that tells whether degree of freedom k of the node at line i of theta1 and line j of
 * theta2 is supported.
 */
typedef int fixing(int i, int j, int k);

/*
 * A flat plate in the plane x, y with e3 upwards, or a cylinder around y with theta1 the angle from
 * below and e3 outwards.
 */
typedef struct rig {
    int n1, n2, closed, nodes, elements, dof;
    double radius, step[2], thickness;
    double position[MOST_NODES][3], frame[MOST_NODES][3][3];
    uint16_t element[MOST_NODES][4], element_type[MOST_NODES], node_dof[MOST_NODES][7],
        first_column[7 * MOST_NODES];
    pzs_element_type type;
    pzs_real stiffness[SHELL_PACKED(SHELL_MAX)];
    uint32_t input_start[3], output_start[2];
    uint16_t load_dof[MOST_NODES], output_dof[1];
    pzs_real load_value[MOST_NODES], output_value[1];
    pzs_structure structure;
    pzs_nonlinear tables;
    pzs_model model;
    pzs_solver solver;
    void *model_work, *solver_work, *contact_work;
    pzs_real place[MOST_NODES][3], triad[MOST_NODES][3][3], area[MOST_NODES];
    pzs_contact_face face;
    pzs_body body;
    pzs_contact contact;
    pzs_real corner_area[1][4], lean[1][4][2], pressure[MOST_NODES];
    pzs_follower follower;
    pzs_follower_load follower_load;
} rig;

static inline int node_at(const rig *shell, int i, int j)
{
    return (shell->closed ? i % shell->n1 : i) * (shell->n2 + 1) + j;
}

static inline void place_nodes(rig *shell)
{
    for (int i = 0; i < shell->n1 + !shell->closed; i++)
        for (int j = 0; j <= shell->n2; j++) {
            const int node = node_at(shell, i, j);
            const double t1 = i * shell->step[0], t2 = j * shell->step[1],
                         cosine = cos(t1 / shell->radius), sine = sin(t1 / shell->radius);
            const double plate[4][3] = {{t1, t2, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
            const double round[4][3] = {{shell->radius * sine, -t2, -shell->radius * cosine},
                                        {cosine, 0, sine},
                                        {0, -1, 0},
                                        {sine, 0, -cosine}};
            memcpy(shell->position[node], shell->radius > 0 ? round[0] : plate[0],
                   sizeof shell->position[node]);
            memcpy(shell->frame[node], shell->radius > 0 ? round[1] : plate[1],
                   sizeof shell->frame[node]);
        }
}

static inline double dot(const double left[3], const double right[3])
{
    return left[0] * right[0] + left[1] * right[1] + left[2] * right[2];
}

/*
 * Compute the coupling matrices of the element type in Cartesian coordinates from the first
 * element; all elements are equal.
 */
static inline void make_kind(rig *shell)
{
    static const double sign[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    for (int corner = 0; corner < 4; corner++)
        for (int direction = 0; direction < 2; direction++) {
            const int own = shell->element[0][corner],
                      other = shell->element[0][direction == 0 ? corner ^ 1 : 3 - corner];
            const double *position = shell->position[other], *from = shell->position[own],
                         chord[3] = {position[0] - from[0], position[1] - from[1],
                                     position[2] - from[2]};
            const double slope = sign[corner][direction] / sqrt(dot(chord, chord));
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++)
                    shell->type.t[corner][direction][i][j] =
                        (pzs_real)(slope * dot(shell->frame[own][i], shell->frame[other][j]));
                shell->type.s[corner][direction][i][i] = (pzs_real)-slope;
                shell->type.g_mean[corner][direction][i] =
                    (pzs_real)(slope * dot(shell->frame[own][i], chord));
                shell->type.g_diff[corner][direction][i] =
                    (pzs_real)(slope *
                               (dot(shell->frame[own][i], shell->frame[other][2]) - (i == 2)));
            }
        }
}

/*
 * Compute the stiffness of an isotropic material with Young's modulus 1 and Poisson's ratio 0.3,
 * for means and differences of the faces.
 */
static inline void make_stiffness(rig *shell)
{
    const double shear = 1 / 2.6, lame = 0.3 / (1.3 * 0.4),
                 part[4] = {1, 1.0 / 3, 1.0 / 3, 1.0 / 9};
    for (int mode = 0; mode < 4; mode++) {
        pzs_real *entry = shell->type.d + first_entry[mode];
        for (int row = 0; row < kept_strains[mode]; row++)
            for (int column = 0; column <= row; column++, entry++) {
                const int i = kept_strain[mode][row], j = kept_strain[mode][column];
                const int both_normal = i < 6 && j < 6 && i % 2 == j % 2;
                const double own = i == j ? shear : 0;
                const double modulus = both_normal ? lame + 2 * own : own;
                *entry =
                    (pzs_real)(part[mode] * shell->step[0] * shell->step[1] * modulus *
                               (i < 8 && i % 2 == 1 ? shell->thickness / 12 : shell->thickness));
            }
    }
    pzs_shell_stiffness(&shell->type, 7, shell->stiffness);
}

static inline void number(rig *shell, fixing *fixed)
{
    for (int i = 0; i < shell->n1 + !shell->closed; i++)
        for (int j = 0; j <= shell->n2; j++)
            for (int k = 0; k < 7; k++)
                shell->node_dof[node_at(shell, i, j)][k] =
                    fixed(i, j, k) ? PZS_CONSTRAINED : (uint16_t)shell->dof++;
    for (int d = 0; d < shell->dof; d++)
        shell->first_column[d] = (uint16_t)d;
    for (int pass = 0; pass < shell->elements; pass++) {
        uint16_t least = PZS_CONSTRAINED;
        for (int i = 0; i < 28; i++) {
            const uint16_t dof = shell->node_dof[shell->element[pass][i / 7]][i % 7];
            least = dof < least ? dof : least;
        }
        for (int i = 0; i < 28; i++) {
            const uint16_t dof = shell->node_dof[shell->element[pass][i / 7]][i % 7];
            if (dof != PZS_CONSTRAINED && least < shell->first_column[dof])
                shell->first_column[dof] = least;
        }
    }
}

/*
 * Make the structure: input 0 is a force of 1 along -e3, shared by the nodes of line `loaded`;
 * input 1 has an empty force vector.
 */
static inline void make_structure(rig *shell, int loaded)
{
    pzs_structure *structure = &shell->structure;
    const pzs_rows input = {2, shell->input_start, shell->load_dof, shell->load_value};
    const pzs_rows output = {1, shell->output_start, shell->output_dof, shell->output_value};
    for (int j = 0; j <= shell->n2; j++) {
        shell->load_dof[j] = shell->node_dof[node_at(shell, loaded, j)][2];
        shell->load_value[j] = (pzs_real)(-1.0 / (shell->n2 + 1));
    }
    shell->input_start[1] = shell->input_start[2] = (uint32_t)(shell->n2 + 1);
    shell->output_dof[0] = shell->load_dof[0];
    shell->output_value[0] = 1;
    shell->output_start[1] = 1;
    const pzs_structure made = {.format = PZS_TABLE_FORMAT,
                                .nodes = (uint16_t)shell->nodes,
                                .elements = (uint16_t)shell->elements,
                                .types = 1,
                                .dof_per_node = 7,
                                .free_dof = (uint16_t)shell->dof,
                                .element = (const uint16_t(*)[4])shell->element,
                                .element_type = shell->element_type,
                                .node_dof = shell->node_dof[0],
                                .first_column = shell->first_column,
                                .stiffness = shell->stiffness,
                                .type = &shell->type,
                                .input = input,
                                .output = output};
    *structure = made;
    structure->crc = pzs_structure_crc(structure);
    shell->tables.format = PZS_TABLE_FORMAT;
    shell->tables.crc = pzs_nonlinear_crc(&shell->tables, structure);
}

/*
 * Make a shell in the undeformed state, with an equilibrium solver.
 *   radius in  radius of the cylinder; 0: plate
 *   step   in  side lengths of an element
 */
static inline rig *rig_open(int n1, int n2, double radius, double step1, double step2,
                            double thickness, int closed, fixing *fixed, int loaded)
{
    rig *shell = calloc(1, sizeof *shell);
    assert_non_null(shell);
    shell->n1 = n1;
    shell->n2 = n2;
    shell->closed = closed;
    shell->radius = radius;
    shell->step[0] = step1;
    shell->step[1] = step2;
    shell->thickness = thickness;
    shell->nodes = (n1 + !closed) * (n2 + 1);
    shell->elements = n1 * n2;
    assert_in_range(shell->nodes, 4, MOST_NODES);
    place_nodes(shell);
    for (int i = 0; i < n1; i++)
        for (int j = 0; j < n2; j++)
            for (int corner = 0; corner < 4; corner++)
                shell->element[i * n2 + j][corner] =
                    (uint16_t)node_at(shell, i + (corner == 1 || corner == 2), j + corner / 2);
    make_kind(shell);
    shell->type.thickness = (pzs_real)thickness;
    shell->type.skew[2] = (pzs_real)(step2 / step1);
    make_stiffness(shell);
    number(shell, fixed);
    make_structure(shell, loaded);
    const size_t bytes =
        PZS_MODEL_BYTES(shell->dof, pzs_linalg_reals(shell->first_column, (uint32_t)shell->dof));
    const size_t path_bytes = PZS_SOLVER_BYTES(shell->dof, shell->elements, 2);
    shell->model_work = malloc(bytes);
    shell->solver_work = malloc(path_bytes);
    assert_int_equal(pzs_model_init(&shell->model, &shell->structure, shell->model_work, bytes),
                     PZS_OK);
    assert_int_equal(pzs_solver_init(&shell->solver, &shell->model, &shell->tables,
                                     shell->solver_work, path_bytes),
                     PZS_OK);
    shell->solver.settings.tolerance = IS_FLOAT ? (pzs_real)1e-4 : (pzs_real)1e-7;
    return shell;
}

static inline void rig_close(rig *shell)
{
    free(shell->model_work);
    free(shell->solver_work);
    free(shell->contact_work);
    free(shell);
}

/*
 * Assert that a single flipped bit, anywhere in `bytes` bytes of tables, keeps the tables from
 * being attached.
 */
typedef pzs_status attaching(rig *g);
static inline void assert_bits_count(rig *shell, void *data, size_t bytes, attaching *attach)
{
    uint8_t *byte = data;
    for (size_t bit = 0; bit < 8 * bytes; bit++) {
        byte[bit / 8] = (uint8_t)(byte[bit / 8] ^ 1u << bit % 8);
        const pzs_status status = attach(shell);
        byte[bit / 8] = (uint8_t)(byte[bit / 8] ^ 1u << bit % 8);
        assert_true(status == PZS_E_CRC || status == PZS_E_FORMAT);
    }
}

/*
 * Make a follower load of pressure 1 at every node, scaled by input 1. Corners share the pressure
 * as in the improved element.
 */
static inline void make_follower(rig *shell, int load_face, int normal_face, int true_area)
{
    pzs_follower *follower = &shell->follower;
    for (int node = 0; node < shell->nodes; node++)
        shell->pressure[node] = 1;
    for (int corner = 0; corner < 4; corner++)
        shell->corner_area[0][corner] = (pzs_real)(shell->step[0] * shell->step[1]);
    follower->input = 1;
    follower->load_face = (uint8_t)load_face;
    follower->normal_face = (uint8_t)normal_face;
    follower->true_area = (uint8_t)true_area;
    follower->share[0] = (pzs_real)0.25;
    follower->area = (const pzs_real(*)[4])shell->corner_area;
    follower->pressure = shell->pressure;
    follower->format = PZS_TABLE_FORMAT;
    follower->crc = pzs_follower_crc(follower, &shell->structure);
}

static inline void attach_follower(rig *shell, int load_face, int normal_face, int true_area)
{
    make_follower(shell, load_face, normal_face, true_area);
    assert_int_equal(pzs_attach_follower(&shell->solver, &shell->follower_load, &shell->follower),
                     PZS_OK);
}

/*
 * Attach a contact of the outer face, which is below a cylinder or above a plate. Input 1 moves the
 * body, of which g->body is a copy.
 */
static inline pzs_status try_contact(rig *shell, const pzs_body *body, const double motion[3])
{
    pzs_contact_face *face = &shell->face;
    const size_t bytes = PZS_CONTACT_BYTES(shell->nodes);
    for (int node = 0; node < shell->nodes; node++)
        for (int i = 0; i < 3; i++) {
            shell->place[node][i] = (pzs_real)(shell->position[node][i] +
                                               shell->thickness / 2 * shell->frame[node][2][i]);
            for (int j = 0; j < 3; j++)
                shell->triad[node][i][j] = (pzs_real)shell->frame[node][i][j];
            face->motion[i] = (pzs_real)motion[i];
        }
    memset(shell->area, 0, sizeof shell->area);
    for (int element = 0; element < shell->elements; element++)
        for (int corner = 0; corner < 4; corner++)
            shell->area[shell->element[element][corner]] +=
                (pzs_real)(shell->step[0] * shell->step[1] / 4);
    face->face = 1;
    face->input = 1;
    face->size = (pzs_real)(shell->radius > 0 ? 2 * shell->radius : shell->n1 * shell->step[0]);
    face->place = (const pzs_real(*)[3])shell->place;
    face->triad = (const pzs_real(*)[3][3])shell->triad;
    face->area = shell->area;
    face->format = PZS_TABLE_FORMAT;
    face->crc = pzs_contact_crc(face, &shell->structure);
    if (!shell->contact_work)
        shell->contact_work = malloc(bytes);
    shell->body = *body;
    shell->body.crc = pzs_body_crc(body);
    return pzs_attach_contact(&shell->solver, &shell->contact, face, &shell->body,
                              shell->contact_work, bytes);
}

static inline void attach_contact(rig *shell, const pzs_body *body, const double motion[3])
{
    assert_int_equal(try_contact(shell, body, motion), PZS_OK);
}

static inline void set_random(rig *shell, double size)
{
    for (int i = 0; i < shell->dof; i++)
        shell->solver.state.displacement[i] = (pzs_real)(size * uniform());
}

/* The supports of a free shell: none. */
static inline int nothing(int i, int j, int k)
{
    (void)i, (void)j, (void)k;
    return 0;
}

#endif
