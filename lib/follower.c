/* Follower loads: pressures that turn with a face of the shell (pzs.h). */
#include "face.h"
#include "model.h"
#include "nonlinear.h"
#include "shell.h"
#include <string.h>

/*
 * Direction and size of a pressure at a corner, per reference area: the normal eta itself where it acts on true area,
 * else eta / |eta|.
 *   n [3] in eta, out;  slope [3][12] in that of eta, out; NULL: not wanted
 */
static void to_unit(pzs_real n[3], pzs_real (*slope)[12])
{
    const pzs_real size = PZS_SQRT(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const pzs_real inverse = size > 0 ? 1 / size : 0;
    for (int i = 0; i < 3; i++)
        n[i] *= inverse;
    for (int j = 0; slope && j < 12; j++) {
        const pzs_real along = n[0] * slope[0][j] + n[1] * slope[1][j] + n[2] * slope[2][j];
        for (int i = 0; i < 3; i++)
            slope[i][j] = inverse * (slope[i][j] - along * n[i]);
    }
}

/*
 * Forces of one element at path->u for `amount` of the load, in the frames of its corners.
 *   force [4][3]   out
 *   slope [12][12] out their derivative with respect to the displacement of normal_face; NULL: not wanted
 */
static void element_force(const pzs_follower *t, const pzs_path *path, uint32_t e, pzs_real amount, pzs_real (*force)[3],
                          pzs_real (*slope)[12])
{
    const pzs_structure *s = path->model->structure;
    const uint16_t kind = s->element_kind[e];
    const pzs_real z = face_height(s, t->normal_face);
    pzs_real w[SHELL_NODES][3];
    face_gather(path->model, s->element[e], SHELL_NODES, z, path->u, w);
    memset(force, 0, sizeof(pzs_real[4][3]));
    if (slope)
        memset(slope, 0, sizeof(pzs_real[12][12]));
    for (unsigned from = 0; from < SHELL_NODES; from++) {
        const pzs_real size = amount * t->pressure[s->element[e][from]] * t->area[kind][from];
        pzs_real n[3], n_slope[3][12];
        face_normal(&s->kind[kind], z, (const pzs_real(*)[3])w, from, n, slope ? n_slope : NULL);
        if (!t->true_area)
            to_unit(n, slope ? n_slope : NULL);
        for (unsigned r = 0; r < SHELL_NODES; r++) {
            const pzs_real part = size * t->share[r == from ? 0 : (r ^ from) == 2 ? 2 : 1];
            for (unsigned i = 0; i < 3; i++) {
                force[r][i] += part * n[i];
                for (unsigned j = 0; slope && j < 12; j++)
                    slope[3 * r + i][j] += part * n_slope[i][j];
            }
        }
    }
}

/* Part that element unknown i has in the displacement of a face, component *row of its 12: 1 for a mean, z for a
 * difference, else 0. */
static pzs_real face_part(unsigned i, unsigned unknowns, pzs_real z, unsigned *row)
{
    const unsigned own = i % unknowns;
    *row = 3 * (i / unknowns) + own % 3;
    return own < 3 ? 1 : own < 6 ? z : 0;
}

/* k [packed] = -(S + S')/2 over the element's unknowns, for forces on the face at z_load that turn with that at z. */
static void symmetric_tangent(pzs_real (*slope)[12], unsigned unknowns, pzs_real z_load, pzs_real z, pzs_real *k)
{
    for (unsigned i = 0; i < SHELL_NODES * unknowns; i++)
        for (unsigned j = 0; j <= i; j++, k++) {
            unsigned row, column;
            const pzs_real i_load = face_part(i, unknowns, z_load, &row), i_turn = face_part(i, unknowns, z, &row);
            const pzs_real j_load = face_part(j, unknowns, z_load, &column), j_turn = face_part(j, unknowns, z, &column);
            *k = -(i_load * slope[row][column] * j_turn + j_load * slope[column][row] * i_turn) / 2;
        }
}

static void add(pzs_option *option, pzs_path *path, pzs_real *load)
{
    const pzs_follower *t = ((pzs_follower_load *)option)->tables;
    const pzs_structure *s = path->model->structure;
    const pzs_real amount = path->amount[t->input], z_load = face_height(s, t->load_face);
    for (uint32_t e = 0; amount != 0 && e < s->elements; e++) {
        pzs_real force[SHELL_NODES][3], slope[12][12], k[SHELL_PACKED(SHELL_MAX)];
        element_force(t, path, e, amount, force, slope);
        face_scatter(path->model, s->element[e], SHELL_NODES, z_load, (const pzs_real(*)[3])force, load);
        symmetric_tangent(slope, s->unknowns, z_load, face_height(s, t->normal_face), k);
        model_add_matrix(path->model, s->element[e], SHELL_NODES, 1, k);
    }
}

static void unit(pzs_option *option, pzs_path *path, uint32_t input, pzs_real *out)
{
    const pzs_follower *t = ((pzs_follower_load *)option)->tables;
    const pzs_structure *s = path->model->structure;
    const pzs_real z_load = face_height(s, t->load_face);
    for (uint32_t e = 0; input == t->input && e < s->elements; e++) {
        pzs_real force[SHELL_NODES][3];
        element_force(t, path, e, 1, force, NULL);
        face_scatter(path->model, s->element[e], SHELL_NODES, z_load, (const pzs_real(*)[3])force, out);
    }
}

static const struct pzs_option_calls calls = {.add = add, .unit = unit};

pzs_status pzs_attach_follower(pzs_path *path, pzs_follower_load *load, const pzs_follower *tables)
{
    if (!path || !path->model || !load || !tables || !tables->area || !tables->pressure || tables->load_face > 2
        || tables->normal_face > 1 || tables->input >= path->model->structure->input.count)
        return PZS_E_ARGUMENT;
    load->tables = tables;
    nonlinear_attach(path, &load->option, &calls);
    return PZS_OK;
}
