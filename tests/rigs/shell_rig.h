/*
 * Small shells in the precision of the test program, with an equilibrium solver on each, made
 * without the host tools. Include it after cmocka.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef SHELL_RIG_H
#define SHELL_RIG_H

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
    double radius, step[2], h;
    double x[MOST_NODES][3], e[MOST_NODES][3][3];
    uint16_t element[MOST_NODES][4], element_kind[MOST_NODES], node_dof[MOST_NODES][7],
        first[7 * MOST_NODES];
    pzs_element_type kind;
    pzs_real stiffness[SHELL_PACKED(SHELL_MAX)];
    uint32_t input_start[3], output_start[2];
    uint16_t load_dof[MOST_NODES], output_dof[1];
    pzs_real load_value[MOST_NODES], output_value[1];
    pzs_structure structure;
    pzs_nonlinear tables;
    pzs_model model;
    pzs_solver path;
    void *model_work, *path_work, *contact_work;
    pzs_real place[MOST_NODES][3], triad[MOST_NODES][3][3], area[MOST_NODES];
    pzs_contact_face face;
    pzs_body body;
    pzs_contact contact;
    pzs_real corner_area[1][4], lean[1][4][2], pressure[MOST_NODES];
    pzs_follower follower;
    pzs_follower_load follower_load;
} rig;

static inline int node_at(const rig *g, int i, int j)
{
    return (g->closed ? i % g->n1 : i) * (g->n2 + 1) + j;
}

static inline void place_nodes(rig *g)
{
    for (int i = 0; i < g->n1 + !g->closed; i++)
        for (int j = 0; j <= g->n2; j++) {
            const int n = node_at(g, i, j);
            const double t1 = i * g->step[0], t2 = j * g->step[1], c = cos(t1 / g->radius),
                         s = sin(t1 / g->radius);
            const double plate[4][3] = {{t1, t2, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
            const double round[4][3] = {
                {g->radius * s, -t2, -g->radius * c}, {c, 0, s}, {0, -1, 0}, {s, 0, -c}};
            memcpy(g->x[n], g->radius > 0 ? round[0] : plate[0], sizeof g->x[n]);
            memcpy(g->e[n], g->radius > 0 ? round[1] : plate[1], sizeof g->e[n]);
        }
}

static inline double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/*
 * Compute the coupling matrices of the element type in Cartesian coordinates from the first
 * element; all elements are equal.
 */
static inline void make_kind(rig *g)
{
    static const double sign[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    for (int r = 0; r < 4; r++)
        for (int a = 0; a < 2; a++) {
            const int own = g->element[0][r], other = g->element[0][a == 0 ? r ^ 1 : 3 - r];
            const double *x = g->x[other], *from = g->x[own],
                         chord[3] = {x[0] - from[0], x[1] - from[1], x[2] - from[2]};
            const double slope = sign[r][a] / sqrt(dot(chord, chord));
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++)
                    g->kind.t[r][a][i][j] = (pzs_real)(slope * dot(g->e[own][i], g->e[other][j]));
                g->kind.s[r][a][i][i] = (pzs_real)-slope;
                g->kind.g_mean[r][a][i] = (pzs_real)(slope * dot(g->e[own][i], chord));
                g->kind.g_diff[r][a][i] =
                    (pzs_real)(slope * (dot(g->e[own][i], g->e[other][2]) - (i == 2)));
            }
        }
}

/*
 * Compute the stiffness of an isotropic material with Young's modulus 1 and Poisson's ratio 0.3,
 * for means and differences of the faces.
 */
static inline void make_stiffness(rig *g)
{
    const double shear = 1 / 2.6, lame = 0.3 / (1.3 * 0.4),
                 part[4] = {1, 1.0 / 3, 1.0 / 3, 1.0 / 9};
    for (int m = 0; m < 4; m++) {
        pzs_real *d = g->kind.d[m];
        for (int i = 0; i < 10; i++)
            for (int j = 0; j <= i; j++, d++) {
                const int both_normal = i < 6 && j < 6 && i % 2 == j % 2;
                const double c = both_normal ? lame + (i == j ? 2 * shear : 0) : i == j ? shear : 0;
                *d = (pzs_real)(part[m] * g->step[0] * g->step[1] * c *
                                (i < 8 && i % 2 == 1 ? g->h / 12 : g->h));
            }
    }
    pzs_shell_stiffness(&g->kind, 7, g->stiffness);
}

static inline void number(rig *g, fixing *fixed)
{
    for (int i = 0; i < g->n1 + !g->closed; i++)
        for (int j = 0; j <= g->n2; j++)
            for (int k = 0; k < 7; k++)
                g->node_dof[node_at(g, i, j)][k] =
                    fixed(i, j, k) ? PZS_CONSTRAINED : (uint16_t)g->dof++;
    for (int d = 0; d < g->dof; d++)
        g->first[d] = (uint16_t)d;
    for (int pass = 0; pass < g->elements; pass++) {
        uint16_t least = PZS_CONSTRAINED;
        for (int i = 0; i < 28; i++) {
            const uint16_t dof = g->node_dof[g->element[pass][i / 7]][i % 7];
            least = dof < least ? dof : least;
        }
        for (int i = 0; i < 28; i++) {
            const uint16_t dof = g->node_dof[g->element[pass][i / 7]][i % 7];
            if (dof != PZS_CONSTRAINED && least < g->first[dof])
                g->first[dof] = least;
        }
    }
}

/*
 * Make the structure: input 0 is a force of 1 along -e3, shared by the nodes of line `loaded`;
 * input 1 has an empty force vector.
 */
static inline void make_structure(rig *g, int loaded)
{
    pzs_structure *structure = &g->structure;
    const pzs_rows input = {2, g->input_start, g->load_dof, g->load_value};
    const pzs_rows output = {1, g->output_start, g->output_dof, g->output_value};
    for (int j = 0; j <= g->n2; j++) {
        g->load_dof[j] = g->node_dof[node_at(g, loaded, j)][2];
        g->load_value[j] = (pzs_real)(-1.0 / (g->n2 + 1));
    }
    g->input_start[1] = g->input_start[2] = (uint32_t)(g->n2 + 1);
    g->output_dof[0] = g->load_dof[0];
    g->output_value[0] = 1;
    g->output_start[1] = 1;
    const pzs_structure made = {.format = PZS_TABLE_FORMAT,
                                .nodes = (uint16_t)g->nodes,
                                .elements = (uint16_t)g->elements,
                                .types = 1,
                                .dof_per_node = 7,
                                .free_dof = (uint16_t)g->dof,
                                .element = (const uint16_t(*)[4])g->element,
                                .element_type = g->element_kind,
                                .node_dof = g->node_dof[0],
                                .first_column = g->first,
                                .stiffness = g->stiffness,
                                .type = &g->kind,
                                .input = input,
                                .output = output};
    *structure = made;
    structure->crc = pzs_structure_crc(structure);
    g->tables.format = PZS_TABLE_FORMAT;
    g->tables.crc = pzs_nonlinear_crc(&g->tables, structure);
}

/*
 * Make a shell in the undeformed state, with an equilibrium solver.
 *   radius in  radius of the cylinder; 0: plate
 *   step   in  side lengths of an element
 */
static inline rig *rig_open(int n1, int n2, double radius, double step1, double step2, double h,
                            int closed, fixing *fixed, int loaded)
{
    rig *g = calloc(1, sizeof *g);
    assert_non_null(g);
    g->n1 = n1;
    g->n2 = n2;
    g->closed = closed;
    g->radius = radius;
    g->step[0] = step1;
    g->step[1] = step2;
    g->h = h;
    g->nodes = (n1 + !closed) * (n2 + 1);
    g->elements = n1 * n2;
    assert_in_range(g->nodes, 4, MOST_NODES);
    place_nodes(g);
    for (int i = 0; i < n1; i++)
        for (int j = 0; j < n2; j++)
            for (int r = 0; r < 4; r++)
                g->element[i * n2 + j][r] = (uint16_t)node_at(g, i + (r == 1 || r == 2), j + r / 2);
    make_kind(g);
    g->kind.thickness = (pzs_real)h;
    g->kind.skew[2] = (pzs_real)(step2 / step1);
    make_stiffness(g);
    number(g, fixed);
    make_structure(g, loaded);
    const size_t bytes = PZS_MODEL_BYTES(g->dof, pzs_linalg_reals(g->first, (uint32_t)g->dof));
    const size_t path_bytes = PZS_SOLVER_BYTES(g->dof, g->elements, 2);
    g->model_work = malloc(bytes);
    g->path_work = malloc(path_bytes);
    assert_int_equal(pzs_model_init(&g->model, &g->structure, g->model_work, bytes), PZS_OK);
    assert_int_equal(pzs_solver_init(&g->path, &g->model, &g->tables, g->path_work, path_bytes),
                     PZS_OK);
    g->path.settings.tolerance = IS_FLOAT ? (pzs_real)1e-4 : (pzs_real)1e-7;
    return g;
}

static inline void rig_close(rig *g)
{
    free(g->model_work);
    free(g->path_work);
    free(g->contact_work);
    free(g);
}

/*
 * Assert that a single flipped bit, anywhere in `bytes` bytes of tables, keeps the tables from
 * being attached.
 */
typedef pzs_status attaching(rig *g);
static inline void assert_bits_count(rig *g, void *data, size_t bytes, attaching *attach)
{
    uint8_t *byte = data;
    for (size_t bit = 0; bit < 8 * bytes; bit++) {
        byte[bit / 8] = (uint8_t)(byte[bit / 8] ^ 1u << bit % 8);
        const pzs_status status = attach(g);
        byte[bit / 8] = (uint8_t)(byte[bit / 8] ^ 1u << bit % 8);
        assert_true(status == PZS_E_CRC || status == PZS_E_FORMAT);
    }
}

/*
 * Make a follower load of pressure 1 at every node, which input 1 scales, with the shares of the
 * improved element.
 */
static inline void make_follower(rig *g, int load_face, int normal_face, int true_area)
{
    pzs_follower *follower = &g->follower;
    for (int n = 0; n < g->nodes; n++)
        g->pressure[n] = 1;
    for (int r = 0; r < 4; r++)
        g->corner_area[0][r] = (pzs_real)(g->step[0] * g->step[1]);
    follower->input = 1;
    follower->load_face = (uint8_t)load_face;
    follower->normal_face = (uint8_t)normal_face;
    follower->true_area = (uint8_t)true_area;
    follower->share[0] = (pzs_real)0.25;
    follower->area = (const pzs_real(*)[4])g->corner_area;
    follower->pressure = g->pressure;
    follower->format = PZS_TABLE_FORMAT;
    follower->crc = pzs_follower_crc(follower, &g->structure);
}

static inline void attach_follower(rig *g, int load_face, int normal_face, int true_area)
{
    make_follower(g, load_face, normal_face, true_area);
    assert_int_equal(pzs_attach_follower(&g->path, &g->follower_load, &g->follower), PZS_OK);
}

/*
 * Attach a contact of the outer face, which is below a cylinder or above a plate. Input 1 moves the
 * body, of which g->body is a copy.
 */
static inline pzs_status try_contact(rig *g, const pzs_body *body, const double motion[3])
{
    pzs_contact_face *face = &g->face;
    const size_t bytes = PZS_CONTACT_BYTES(g->nodes);
    for (int n = 0; n < g->nodes; n++)
        for (int i = 0; i < 3; i++) {
            g->place[n][i] = (pzs_real)(g->x[n][i] + g->h / 2 * g->e[n][2][i]);
            for (int j = 0; j < 3; j++)
                g->triad[n][i][j] = (pzs_real)g->e[n][i][j];
            face->motion[i] = (pzs_real)motion[i];
        }
    memset(g->area, 0, sizeof g->area);
    for (int e = 0; e < g->elements; e++)
        for (int r = 0; r < 4; r++)
            g->area[g->element[e][r]] += (pzs_real)(g->step[0] * g->step[1] / 4);
    face->face = 1;
    face->input = 1;
    face->size = (pzs_real)(g->radius > 0 ? 2 * g->radius : g->n1 * g->step[0]);
    face->place = (const pzs_real(*)[3])g->place;
    face->triad = (const pzs_real(*)[3][3])g->triad;
    face->area = g->area;
    face->format = PZS_TABLE_FORMAT;
    face->crc = pzs_contact_crc(face, &g->structure);
    if (!g->contact_work)
        g->contact_work = malloc(bytes);
    g->body = *body;
    g->body.crc = pzs_body_crc(body);
    return pzs_attach_contact(&g->path, &g->contact, face, &g->body, g->contact_work, bytes);
}

static inline void attach_contact(rig *g, const pzs_body *body, const double motion[3])
{
    assert_int_equal(try_contact(g, body, motion), PZS_OK);
}

static inline void set_random(rig *g, double size)
{
    for (int i = 0; i < g->dof; i++)
        g->path.state.displacement[i] = (pzs_real)(size * uniform());
}

/* The supports of a free shell: none. */
static inline int nothing(int i, int j, int k)
{
    (void)i, (void)j, (void)k;
    return 0;
}

#endif
