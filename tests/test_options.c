/* Follower loads and contact in either precision, on small shells made here. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "face.h"
#include "guard.h"
#include "linalg.h"
#include "model.h"
#include "nonlinear.h"
#include "shell.h"

#define EPS ((double)PZS_EPSILON)
#define IS_FLOAT (PZS_REAL_BITS == 32)

enum { MOST_NODES = 200 };

static uint32_t seed = 1;

/* Uniform in -1 ... 1. */
static double uniform(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (double)(seed >> 8) / 8388608.0 - 1;
}

/* ---- a rig: n1 x n2 equal elements of one kind ------------------------- */

/* Whether unknown k of the node at line i of theta1 and j of theta2 is supported. */
typedef int fixing(int i, int j, int k);

/* A flat plate in x, y with e3 up, or a cylinder of radius R around y, theta1 the angle from below, e3 outwards. */
typedef struct rig {
    int n1, n2, closed, nodes, elements, dof;
    double radius, step[2], h;
    double x[MOST_NODES][3], e[MOST_NODES][3][3];
    uint16_t element[MOST_NODES][4], element_kind[MOST_NODES], node_dof[MOST_NODES][7], first[7 * MOST_NODES];
    pzs_kind kind;
    pzs_real stiffness[SHELL_PACKED(SHELL_MAX)];
    uint32_t input_start[3], output_start[2];
    uint16_t load_dof[MOST_NODES], output_dof[1];
    pzs_real load_value[MOST_NODES], output_value[1];
    pzs_structure structure;
    pzs_nonlinear tables;
    pzs_model model;
    pzs_path path;
    void *model_work, *path_work, *contact_work;
    pzs_real place[MOST_NODES][3], triad[MOST_NODES][3][3], area[MOST_NODES];
    pzs_contact_face face;
    pzs_contact contact;
    pzs_real corner_area[1][4], lean[1][4][2], pressure[MOST_NODES];
    pzs_follower follower;
    pzs_follower_load follower_load;
} rig;

static int node_at(const rig *g, int i, int j)
{
    return (g->closed ? i % g->n1 : i) * (g->n2 + 1) + j;
}

static void place_nodes(rig *g)
{
    for (int i = 0; i < g->n1 + !g->closed; i++)
        for (int j = 0; j <= g->n2; j++) {
            const int n = node_at(g, i, j);
            const double t1 = i * g->step[0], t2 = j * g->step[1], c = cos(t1 / g->radius), s = sin(t1 / g->radius);
            const double plate[4][3] = {{t1, t2, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
            const double round[4][3] = {{g->radius * s, -t2, -g->radius * c}, {c, 0, s}, {0, -1, 0}, {s, 0, -c}};
            memcpy(g->x[n], g->radius > 0 ? round[0] : plate[0], sizeof g->x[n]);
            memcpy(g->e[n], g->radius > 0 ? round[1] : plate[1], sizeof g->e[n]);
        }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Corner tables in Cartesian differences of the first element, like all others. */
static void make_kind(rig *g)
{
    static const double sign[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    for (int r = 0; r < 4; r++)
        for (int a = 0; a < 2; a++) {
            const int own = g->element[0][r], other = g->element[0][a == 0 ? r ^ 1 : 3 - r];
            const double *x = g->x[other], *from = g->x[own], chord[3] = {x[0] - from[0], x[1] - from[1], x[2] - from[2]};
            const double slope = sign[r][a] / sqrt(dot(chord, chord));
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++)
                    g->kind.t[r][a][i][j] = (pzs_real)(slope * dot(g->e[own][i], g->e[other][j]));
                g->kind.s[r][a][i][i] = (pzs_real)-slope;
                g->kind.g_mean[r][a][i] = (pzs_real)(slope * dot(g->e[own][i], chord));
                g->kind.g_diff[r][a][i] = (pzs_real)(slope * (dot(g->e[own][i], g->e[other][2]) - (i == 2)));
            }
        }
}

/* D of an isotropic material, E = 1, nu = .3: means get h C, differences h/12 C. */
static void make_stiffness(rig *g)
{
    const double shear = 1 / 2.6, lame = 0.3 / (1.3 * 0.4), part[4] = {1, 1.0 / 3, 1.0 / 3, 1.0 / 9};
    for (int m = 0; m < 4; m++) {
        pzs_real *d = g->kind.d[m];
        for (int i = 0; i < 10; i++)
            for (int j = 0; j <= i; j++, d++) {
                const int both_normal = i < 6 && j < 6 && i % 2 == j % 2;
                const double c = both_normal ? lame + (i == j ? 2 * shear : 0) : i == j ? shear : 0;
                *d = (pzs_real)(part[m] * g->step[0] * g->step[1] * c * (i < 8 && i % 2 == 1 ? g->h / 12 : g->h));
            }
    }
    shell_stiffness(&g->kind, 7, g->stiffness);
}

static void number(rig *g, fixing *fixed)
{
    for (int i = 0; i < g->n1 + !g->closed; i++)
        for (int j = 0; j <= g->n2; j++)
            for (int k = 0; k < 7; k++)
                g->node_dof[node_at(g, i, j)][k] = fixed(i, j, k) ? PZS_FIXED : (uint16_t)g->dof++;
    for (int d = 0; d < g->dof; d++)
        g->first[d] = (uint16_t)d;
    for (int pass = 0; pass < g->elements; pass++) {
        uint16_t least = PZS_FIXED;
        for (int i = 0; i < 28; i++) {
            const uint16_t dof = g->node_dof[g->element[pass][i / 7]][i % 7];
            least = dof < least ? dof : least;
        }
        for (int i = 0; i < 28; i++) {
            const uint16_t dof = g->node_dof[g->element[pass][i / 7]][i % 7];
            if (dof != PZS_FIXED && least < g->first[dof])
                g->first[dof] = least;
        }
    }
}

/* A dead force of 1 along -e3, shared by the nodes of line `loaded`, is input 0; input 1 has an empty row. */
static void make_structure(rig *g, int loaded)
{
    pzs_structure *s = &g->structure;
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
    const pzs_structure made = {.format = PZS_TABLE_FORMAT, .nodes = (uint16_t)g->nodes, .elements = (uint16_t)g->elements,
        .kinds = 1, .unknowns = 7, .dof = (uint16_t)g->dof, .element = (const uint16_t(*)[4])g->element,
        .element_kind = g->element_kind, .node_dof = g->node_dof[0], .first = g->first, .stiffness = g->stiffness,
        .kind = &g->kind, .input = input, .output = output};
    *s = made;
    s->crc = guard_structure_crc(s);
    g->tables.format = PZS_TABLE_FORMAT;
    g->tables.crc = nonlinear_crc(&g->tables, s);
}

/* A shell at rest with a path on it. radius 0: a plate; step: lengths of an element. */
static rig *rig_open(int n1, int n2, double radius, double step1, double step2, double h, int closed, fixing *fixed,
                     int loaded)
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
    make_stiffness(g);
    number(g, fixed);
    make_structure(g, loaded);
    const size_t bytes = PZS_MODEL_BYTES(g->dof, linalg_reals(g->first, (uint32_t)g->dof));
    const size_t path_bytes = PZS_PATH_BYTES(g->dof, g->elements, 2);
    g->model_work = malloc(bytes);
    g->path_work = malloc(path_bytes);
    assert_int_equal(pzs_model_init(&g->model, &g->structure, g->model_work, bytes), PZS_OK);
    assert_int_equal(pzs_path_init(&g->path, &g->model, &g->tables, g->path_work, path_bytes), PZS_OK);
    g->path.change = IS_FLOAT ? (pzs_real)1e-4 : (pzs_real)1e-7;
    return g;
}

static void rig_close(rig *g)
{
    free(g->model_work);
    free(g->path_work);
    free(g->contact_work);
    free(g);
}

/* A follower of pressure 1 on every node, driven by input 1; corrected shares. */
static void attach_follower(rig *g, int load_face, int normal_face, int true_area)
{
    pzs_follower *f = &g->follower;
    for (int n = 0; n < g->nodes; n++)
        g->pressure[n] = 1;
    for (int r = 0; r < 4; r++)
        g->corner_area[0][r] = (pzs_real)(g->step[0] * g->step[1]);
    f->input = 1;
    f->load_face = (uint8_t)load_face;
    f->normal_face = (uint8_t)normal_face;
    f->true_area = (uint8_t)true_area;
    f->share[0] = (pzs_real)0.25;
    f->area = (const pzs_real(*)[4])g->corner_area;
    f->pressure = g->pressure;
    assert_int_equal(pzs_attach_follower(&g->path, &g->follower_load, f), PZS_OK);
}

/* Contact of the outer face below (a cylinder) or above (a plate); input 1 moves the body. */
static void attach_contact(rig *g, const pzs_body *body, const double motion[3])
{
    pzs_contact_face *f = &g->face;
    const size_t bytes = PZS_CONTACT_BYTES(g->nodes);
    for (int n = 0; n < g->nodes; n++)
        for (int i = 0; i < 3; i++) {
            g->place[n][i] = (pzs_real)(g->x[n][i] + g->h / 2 * g->e[n][2][i]);
            for (int j = 0; j < 3; j++)
                g->triad[n][i][j] = (pzs_real)g->e[n][i][j];
            f->motion[i] = (pzs_real)motion[i];
        }
    memset(g->area, 0, sizeof g->area);
    for (int e = 0; e < g->elements; e++)
        for (int r = 0; r < 4; r++)
            g->area[g->element[e][r]] += (pzs_real)(g->step[0] * g->step[1] / 4);
    f->face = 1;
    f->input = 1;
    f->size = (pzs_real)(g->radius > 0 ? 2 * g->radius : g->n1 * g->step[0]);
    f->place = (const pzs_real(*)[3])g->place;
    f->triad = (const pzs_real(*)[3][3])g->triad;
    f->area = g->area;
    if (!g->contact_work)
        g->contact_work = malloc(bytes);
    assert_int_equal(pzs_attach_contact(&g->path, &g->contact, f, body, g->contact_work, bytes), PZS_OK);
}

static int nothing(int i, int j, int k)
{
    (void)i, (void)j, (void)k;
    return 0;
}

/* ---- follower loads ----------------------------------------------------- */

/* What counts of the lean x of each chord: (1 - x cot x)/x. */
static void count_lean(rig *g)
{
    const double z = g->follower.normal_face ? g->h / 2 : -g->h / 2;
    for (int r = 0; r < 4; r++)
        for (int a = 0; a < 2; a++) {
            double chord[3];
            for (int i = 0; i < 3; i++)
                chord[i] = (double)g->kind.g_mean[r][a][i] + z * (double)g->kind.g_diff[r][a][i];
            const double flat = hypot(chord[0], chord[1]), x = atan2(chord[2], flat);
            g->lean[0][r][a] = (pzs_real)(fabs(x) > 1e-6 ? flat * (1 / x - 1 / tan(x)) : 0);
        }
    g->follower.lean = (const pzs_real(*)[4][2])g->lean;
}

static void set_random(rig *g, double size)
{
    for (int i = 0; i < g->dof; i++)
        g->path.u[i] = (pzs_real)(size * uniform());
}

static void follower_force(rig *g, pzs_real *force)
{
    memset(force, 0, (size_t)g->dof * sizeof *force);
    g->follower_load.option.call->unit(&g->follower_load.option, &g->path, 1, force);
}

/* Largest difference of the added matrix from minus the symmetric part of dF/dU, over the largest entry. */
static double tangent_error(rig *g, double step)
{
    const int n = g->dof;
    pzs_real *derivative = calloc((size_t)n * (size_t)n, sizeof *derivative), *f = calloc(2 * (size_t)n, sizeof *f);
    double worst = 0, largest = 0;
    for (int j = 0; j < n; j++) {
        const pzs_real at = g->path.u[j];
        volatile pzs_real ahead = at + (pzs_real)step, behind = at - (pzs_real)step;
        g->path.u[j] = ahead;
        follower_force(g, f);
        g->path.u[j] = behind;
        follower_force(g, f + n);
        g->path.u[j] = at;
        for (int i = 0; i < n; i++)
            derivative[i * n + j] = (f[i] - f[n + i]) / (ahead - behind);
    }
    g->path.amount[1] = 1;
    linalg_clear(&g->model.k);
    memset(f, 0, (size_t)n * sizeof *f);
    g->follower_load.option.call->add(&g->follower_load.option, &g->path, f);
    follower_force(g, f + n);
    assert_memory_equal(f, f + n, (size_t)n * sizeof *f);
    for (int i = 0; i < n; i++)
        for (int j = g->first[i]; j <= i; j++) {
            const double wanted = -(double)(derivative[i * n + j] + derivative[j * n + i]) / 2;
            worst = fmax(worst, fabs((double)*linalg_entry(&g->model.k, (uint32_t)i, (uint32_t)j) - wanted));
            largest = fmax(largest, fabs(wanted));
        }
    free(derivative);
    free(f);
    return worst / largest;
}

static void tangent_is_the_symmetric_part_of_the_derivative(void **state)
{
    (void)state;
    for (int radius = 0; radius < 2; radius++)
        for (int load_face = 0; load_face < 3; load_face++)
            for (int kind = 0; kind < 8; kind++) {
                rig *g = rig_open(2, 2, radius, 0.5, 0.7, 0.1, 0, nothing, 0);
                attach_follower(g, load_face, kind / 2 % 2, kind % 2);
                if (kind / 4)
                    count_lean(g);
                set_random(g, 0.2);
                /* True area is quadratic in u; the unit normal leaves step^2 of its third derivative, eta being about 1. */
                const double step = kind % 2 ? 0.2 : cbrt(EPS), rounding = 100 * EPS / step;
                assert_true(tangent_error(g, step) < (kind % 2 ? rounding : rounding + 100 * step * step));
                rig_close(g);
            }
}

/* y = what the symmetric matrix and the skew part that goes with it make of x: the derivative of the force along x. */
static void derivative_along(rig *g, const pzs_real *x, pzs_real *y)
{
    memset(y, 0, (size_t)g->dof * sizeof *y);
    linalg_clear(&g->model.k);
    g->path.amount[1] = 1;
    g->follower_load.option.call->add(&g->follower_load.option, &g->path, y);
    memset(y, 0, (size_t)g->dof * sizeof *y);
    for (int i = 0; i < g->dof; i++)
        for (int j = g->first[i]; j <= i; j++) {
            const pzs_real k = *linalg_entry(&g->model.k, (uint32_t)i, (uint32_t)j);
            y[i] -= k * x[j];
            y[j] -= j < i ? k * x[i] : 0;
        }
    g->follower_load.option.call->skew(&g->follower_load.option, &g->path, x, 1, y);
}

static void skew_part_completes_the_derivative(void **state)
{
    (void)state;
    for (int load_face = 0; load_face < 3; load_face++)
        for (int kind = 0; kind < 8; kind++) {
            rig *g = rig_open(2, 2, 1, 0.5, 0.7, 0.1, 0, nothing, 0);
            const size_t n = (size_t)g->dof;
            pzs_real *x = calloc(5 * n, sizeof *x), *y = x + n, *f = y + n, *middle = f + 2 * n;
            double worst = 0, largest = 0, along = 0;
            attach_follower(g, load_face, kind / 2 % 2, kind % 2);
            if (kind / 4)
                count_lean(g);
            set_random(g, 0.2);
            for (size_t i = 0; i < n; i++) {
                x[i] = (pzs_real)uniform();
                middle[i] = g->path.u[i];
            }
            derivative_along(g, x, y);
            const double step = kind % 2 ? 0.2 : 0.3 * cbrt(EPS), rounding = 200 * EPS / step;
            for (int side = 0; side < 2; side++) {
                for (size_t i = 0; i < n; i++)
                    g->path.u[i] = middle[i] + (pzs_real)(side ? step : -step) * x[i];
                follower_force(g, f + (size_t)side * n);
            }
            for (size_t i = 0; i < n; i++) {
                worst = fmax(worst, fabs((double)(f[n + i] - f[i]) / (2 * step) - (double)y[i]));
                largest = fmax(largest, fabs((double)y[i]));
            }
            assert_true(worst < (kind % 2 ? rounding : rounding + 100 * step * step) * largest);
            /* A skew matrix takes no work out of any motion. */
            memset(y, 0, n * sizeof *y);
            g->follower_load.option.call->skew(&g->follower_load.option, &g->path, x, 1, y);
            for (size_t i = 0; i < n; i++)
                along += (double)x[i] * (double)y[i];
            assert_true(fabs(along) < 100 * EPS * largest);
            free(x);
            rig_close(g);
        }
}

/* Set path->u to a rotation about the origin by a unit vector q and angle. */
static void rotate(rig *g, const double q[3], double angle, double turn[3][3])
{
    const double c = cos(angle), s = sin(angle), cross[3][3] = {{0, -q[2], q[1]}, {q[2], 0, -q[0]}, {-q[1], q[0], 0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            turn[i][j] = c * (i == j) + s * cross[i][j] + (1 - c) * q[i] * q[j];
    for (int n = 0; n < g->nodes; n++)
        for (int k = 0; k < 6; k++) {
            const double *v = k < 3 ? g->x[n] : g->e[n][2];
            const double moved[3] = {dot(turn[0], v) - v[0], dot(turn[1], v) - v[1], dot(turn[2], v) - v[2]};
            g->path.u[g->node_dof[n][k]] = (pzs_real)dot(g->e[n][k % 3], moved);
        }
}

/* Force on a node in global axes; from = 3: what goes with its difference. */
static void force_at(const rig *g, const pzs_real *force, int n, int from, double global[3])
{
    for (int i = 0; i < 3; i++) {
        global[i] = 0;
        for (int k = 0; k < 3; k++)
            global[i] += g->e[n][k][i] * (double)force[g->node_dof[n][from + k]];
    }
}

/* A rigid rotation turns every nodal force with it and changes no size, for the unit normal and for true area. */
static void force_turns_with_the_shell(void **state)
{
    (void)state;
    const double q[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
    for (int radius = 0; radius < 2; radius++)
        for (int kind = 0; kind < 4; kind++) {
            const int true_area = kind % 2;
            rig *g = rig_open(3, 2, radius, 0.5, 0.7, 0.1, 0, nothing, 0);
            pzs_real *rest = calloc(2 * (size_t)g->dof, sizeof *rest), *turned = rest + g->dof;
            double turn[3][3];
            attach_follower(g, 0, 1, true_area);
            if (kind / 2)
                count_lean(g);
            follower_force(g, rest);
            rotate(g, q, 2, turn);
            follower_force(g, turned);
            for (int n = 0; n < g->nodes; n++) {
                double before[3], after[3];
                force_at(g, rest, n, 0, before);
                force_at(g, turned, n, 0, after);
                for (int i = 0; i < 3; i++)
                    assert_true(fabs(after[i] - dot(turn[i], before)) < 100 * EPS);
            }
            free(rest);
            rig_close(g);
        }
}

/* On a flat patch the pressure at rest adds up to p A along e3; stretched by a and b, true pressure to p A a b. */
static void pressure_on_a_flat_patch_is_its_area(void **state)
{
    (void)state;
    rig *g = rig_open(3, 2, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    pzs_real *f = calloc((size_t)g->dof, sizeof *f);
    attach_follower(g, 0, 0, 1);
    for (int stretched = 0; stretched < 2; stretched++) {
        double sum[3] = {0, 0, 0};
        for (int n = 0; n < g->nodes && stretched; n++) {
            g->path.u[g->node_dof[n][0]] = (pzs_real)(0.3 * g->x[n][0]);
            g->path.u[g->node_dof[n][1]] = (pzs_real)(0.2 * g->x[n][1]);
        }
        follower_force(g, f);
        for (int n = 0; n < g->nodes; n++)
            for (int i = 0; i < 3; i++)
                sum[i] += (double)f[g->node_dof[n][i]];
        const double area = 1.5 * 1.4 * (stretched ? 1.3 * 1.2 : 1);
        assert_true(fabs(sum[0]) < 50 * EPS && fabs(sum[1]) < 50 * EPS && fabs(sum[2] - area) < 50 * EPS);
    }
    free(f);
    rig_close(g);
}

/* The source's weights: a pressure on one corner gives 4, 2, 1, 2 parts of 36 to it, its neighbours, the opposite corner. */
static void pressure_is_shared_with_consistent_weights(void **state)
{
    (void)state;
    rig *g = rig_open(1, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    pzs_real *f = calloc((size_t)g->dof, sizeof *f);
    attach_follower(g, 2, 0, 0);
    for (int k = 0; k < 3; k++)
        g->follower.share[k] = (pzs_real)((4 >> k) / 36.0);
    for (int from = 0; from < 4; from++) {
        static const double part[4] = {4, 2, 1, 2};
        memset(g->pressure, 0, sizeof g->pressure);
        g->pressure[g->element[0][from]] = 36;
        follower_force(g, f);
        for (int r = 0; r < 4; r++) {
            const uint16_t *dof = g->node_dof[g->element[0][r]];
            assert_true(fabs((double)f[dof[2]] - 0.35 * part[(r - from + 4) % 4]) < 20 * EPS);
            assert_true(f[dof[5]] == 0); /* half on each face */
        }
    }
    free(f);
    rig_close(g);
}

/*
 * Pressure p on an arc of radius R from angle 0 to phi, cut into any number of sides: the resultant is that on its chord,
 * 2 p R sin(phi/2) across it, with the moment p R^2 (1 - cos phi) about an end, on whatever face it acts.
 */
static void pressure_on_an_arc_is_that_on_its_chord(void **state)
{
    (void)state;
    for (int n = 1; n <= 16; n *= 2)
        for (int load_face = 0; load_face < 3; load_face++) {
            const double phi = 2, width = 0.7, exact[3] = {1 - cos(phi), sin(phi), 1 - cos(phi)};
            rig *g = rig_open(n, 1, 1, phi / n, width, 0.1, 0, nothing, 0);
            pzs_real *f = calloc((size_t)g->dof, sizeof *f);
            double got[3] = {0, 0, 0}; /* along x, against z, moment about the first node */
            attach_follower(g, load_face, 1, 0);
            count_lean(g);
            follower_force(g, f);
            for (int i = 0; i < g->nodes; i++) {
                const double arm[2] = {g->x[i][0] - g->x[0][0], g->x[i][2] - g->x[0][2]};
                double force[3], couple[3];
                force_at(g, f, i, 0, force);
                force_at(g, f, i, 3, couple);
                got[0] += force[0] / width;
                got[1] -= force[2] / width;
                got[2] += (arm[0] * force[2] - arm[1] * force[0]) / width;
                got[2] += (g->e[i][2][0] * couple[2] - g->e[i][2][2] * couple[0]) / width;
            }
            for (int i = 0; i < 3; i++)
                assert_true(fabs(fabs(got[i]) - fabs(exact[i])) < 100 * EPS);
            free(f);
            rig_close(g);
        }
}

/*
 * A closed ring, pushed anyhow in its plane: true pressure is a closed polygon turned by 90 degrees and adds up to 0, and so
 * does what counts of the lean, of two neighbours along their one director.
 */
static void closed_ring_adds_up(int leaning)
{
    rig *g = rig_open(12, 1, 1, 2 * acos(-1.0) / 12, 0.5, 0.1, 1, nothing, 0);
    pzs_real *f = calloc((size_t)g->dof, sizeof *f);
    attach_follower(g, 0, 1, 1);
    if (leaning)
        count_lean(g);
    for (int i = 0; i < 12; i++)
        for (int k = 0; k < 6; k++) {
            const double push = k % 3 == 1 ? 0 : 0.3 * uniform();
            for (int j = 0; j < 2; j++)
                g->path.u[g->node_dof[node_at(g, i, j)][k]] = (pzs_real)push;
        }
    follower_force(g, f);
    double sum[3] = {0, 0, 0}, size = 0;
    for (int n = 0; n < g->nodes; n++) {
        double force[3];
        force_at(g, f, n, 0, force);
        for (int i = 0; i < 3; i++)
            sum[i] += force[i];
        size += sqrt(dot(force, force));
    }
    assert_true(size > 1);
    assert_true(sqrt(dot(sum, sum)) < 20 * EPS * size);
    free(f);
    rig_close(g);
}

static void true_pressure_on_a_closed_ring_adds_up_to_nothing(void **state)
{
    (void)state;
    closed_ring_adds_up(0);
    closed_ring_adds_up(1);
}

static void follower_tables_out_of_range_are_refused(void **state)
{
    (void)state;
    rig *g = rig_open(2, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    attach_follower(g, 0, 0, 0);
    pzs_follower bad[4] = {g->follower, g->follower, g->follower, g->follower};
    bad[0].input = 2;
    bad[1].load_face = 3;
    bad[2].normal_face = 2;
    bad[3].pressure = NULL;
    for (int i = 0; i < 4; i++)
        assert_int_equal(pzs_attach_follower(&g->path, &g->follower_load, &bad[i]), PZS_E_ARGUMENT);
    rig_close(g);
}

/* An option twice in the list would be a list without end. */
static void options_are_attached_once(void **state)
{
    (void)state;
    const pzs_real amount[2] = {0, (pzs_real)1e-5};
    rig *g = rig_open(2, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    pzs_follower_load other;
    attach_follower(g, 0, 0, 0);
    assert_int_equal(pzs_attach_follower(&g->path, &other, &g->follower), PZS_OK);
    assert_int_equal(pzs_attach_follower(&g->path, &g->follower_load, &g->follower), PZS_E_ARGUMENT);
    assert_int_equal(pzs_attach_follower(&g->path, &other, &g->follower), PZS_E_ARGUMENT);
    g->path.systems_allowed = 3;
    pzs_equilibrium(&g->path, amount);
    assert_true(g->path.systems <= 3);
    rig_close(g);
}

/* Choices that would call any shape settled, or none, are refused; a path that never was is left alone. */
static void choices_out_of_range_are_refused(void **state)
{
    (void)state;
    const pzs_real amount[2] = {(pzs_real)1e-5, 0}, bad[5] = {0, -1, 1, (pzs_real)NAN, (pzs_real)HUGE_VAL};
    pzs_path never = {0};
    rig *g = rig_open(2, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 2);
    for (int i = 0; i < 5; i++) {
        g->path.change = bad[i];
        assert_int_equal(pzs_equilibrium(&g->path, amount), PZS_E_ARGUMENT);
    }
    pzs_path_rest(&never);
    assert_int_equal(pzs_equilibrium(&never, amount), PZS_E_STAGE);
    rig_close(g);
}

/* The checksum of damaged tables is not led past them by their own counts. */
static void damaged_counts_are_not_followed(void **state)
{
    (void)state;
    static const uint16_t element[1], which[1];
    static const pzs_real value[1][10];
    static const uint32_t start[2][3] = {{0, 1, 1}, {0, 1, 0x40000001u}};
    rig *g = rig_open(2, 1, 0, 0.5, 0.7, 0.1, 0, nothing, 0);
    const pzs_nonlinear sound = {PZS_TABLE_FORMAT, 0, 0, {1, start[0], element, which, value}, {0, 0, NULL, NULL}};
    pzs_nonlinear bad[3] = {sound, sound, sound};
    bad[0].given.start = start[1];
    bad[1].given.values = 0x8001u;
    bad[2].prescribed.count = 0x8000u;
    for (int i = 0; i < 3; i++)
        bad[i].crc = nonlinear_crc(&sound, &g->structure);
    for (int i = 0; i < 3; i++) {
        pzs_path path;
        pzs_real work[8];
        assert_int_equal(pzs_path_init(&path, &g->model, &bad[i], work, sizeof work), PZS_E_CRC);
    }
    pzs_structure damaged[2] = {g->structure, g->structure};
    damaged[0].kinds |= 0x8000u;
    damaged[1].nodes |= 0x8000u;
    for (int i = 0; i < 2; i++)
        assert_int_equal(pzs_model_init(&g->model, &damaged[i], g->model_work, 8), PZS_E_ARGUMENT);
    rig_close(g);
}

/* ---- influence under follower loads ------------------------------------ */

static int clamped(int i, int j, int k)
{
    (void)j, (void)k;
    return i == 0;
}

/* A cantilever arc under a dead load and a pressure that turns with it, settled; every unknown is an output. */
static rig *pressed_arc_open(uint32_t *start, uint16_t *dof, pzs_real *value)
{
    const pzs_real amount[2] = {(pzs_real)1e-5, (pzs_real)3e-5};
    rig *g = rig_open(12, 1, 1, 2.0 / 12, 0.3, 0.1, 0, clamped, 12);
    attach_follower(g, 0, 1, 0);
    count_lean(g);
    assert_int_equal(pzs_equilibrium(&g->path, amount), PZS_OK);
    for (int i = 0; i < g->dof; i++) {
        start[i] = (uint32_t)i;
        dof[i] = (uint16_t)i;
        value[i] = 1;
    }
    start[g->dof] = (uint32_t)g->dof;
    const pzs_rows all = {(uint16_t)g->dof, start, dof, value};
    g->structure.output = all;
    return g;
}

/* Every column x solves (K - W) x = f: x = K^-1 (f + W x), to the rounding of x and of a solve. */
static void influence_solves_the_unsymmetric_system(void **state)
{
    (void)state;
    static uint32_t start[7 * MOST_NODES + 1];
    static uint16_t dof[7 * MOST_NODES];
    static pzs_real value[7 * MOST_NODES], influence[2 * 7 * MOST_NODES], x[7 * MOST_NODES], y[7 * MOST_NODES];
    rig *g = pressed_arc_open(start, dof, value);
    assert_int_equal(pzs_influence_at(&g->path, influence), PZS_OK);
    for (uint32_t j = 0; j < 2; j++) {
        double worst = 0, largest = 0, skew = 0;
        memset(y, 0, sizeof y);
        for (int i = 0; i < g->dof; i++)
            x[i] = influence[2 * i + (int)j];
        g->follower_load.option.call->skew(&g->follower_load.option, &g->path, x, 1, y);
        model_backsolve(&g->model, y, y);
        for (int i = 0; i < g->dof; i++)
            skew = fmax(skew, fabs((double)y[i]));
        memset(y, 0, sizeof y);
        nonlinear_unit_force(&g->path, j, y);
        g->follower_load.option.call->skew(&g->follower_load.option, &g->path, x, 1, y);
        model_backsolve(&g->model, y, y);
        for (int i = 0; i < g->dof; i++) {
            worst = fmax(worst, fabs((double)(y[i] - x[i])));
            largest = fmax(largest, fabs((double)x[i]));
        }
        assert_true(skew > 1e-3 * largest);
        assert_true(worst < 1000 * EPS * largest);
    }
    rig_close(g);
}

static void no_force(pzs_option *option, pzs_path *path, pzs_real *load)
{
    (void)option, (void)path, (void)load;
}

/* A symmetric matrix that outweighs K. */
static void not_skew(pzs_option *option, pzs_path *path, const pzs_real *x, pzs_real factor, pzs_real *y)
{
    (void)option;
    for (uint32_t i = 0; i < path->model->structure->dof; i++)
        y[i] += 10 * factor * x[i] / (path->model->scale[i] * path->model->scale[i]);
}

/* Passes that do not converge are an error at the input they belong to. */
static void skew_part_that_is_none_is_told(void **state)
{
    (void)state;
    static const struct pzs_option_calls calls = {.add = no_force, .skew = not_skew};
    static pzs_option option;
    const pzs_real amount[2] = {(pzs_real)1e-4, 0};
    pzs_real influence[2];
    rig *g = rig_open(12, 1, 1, 2.0 / 12, 0.3, 0.1, 0, clamped, 12);
    nonlinear_attach(&g->path, &option, &calls);
    assert_int_equal(pzs_equilibrium(&g->path, amount), PZS_OK);
    assert_int_equal(pzs_influence_at(&g->path, influence), PZS_E_RESIDUAL);
    assert_int_equal(g->path.where, 0);
    rig_close(g);
}

/* ---- bodies ------------------------------------------------------------- */

#define ASLANT {(pzs_real)(2.0 / 7), (pzs_real)(3.0 / 7), (pzs_real)(6.0 / 7)}
static const pzs_body plane = {pzs_gap_plane, {1, 2, 3}, ASLANT, 0, NULL};
static const pzs_body cylinder = {pzs_gap_cylinder, {1, 2, 3}, ASLANT, 2, NULL};
static const pzs_body sphere = {pzs_gap_sphere, {1, 2, 3}, {0, 0, 0}, 2, NULL};

/* Distance by its definition. */
static double gap_in_double(const pzs_body *body, const pzs_real x[3])
{
    double from[3], along = 0, size2 = 0;
    for (int i = 0; i < 3; i++) {
        from[i] = (double)x[i] - (double)body->point[i];
        along += from[i] * (double)body->axis[i];
    }
    for (int i = 0; i < 3; i++)
        size2 += from[i] * from[i];
    const double round = sqrt(size2 - (body->gap == pzs_gap_cylinder ? along * along : 0)) - (double)body->radius;
    return body->gap == pzs_gap_plane ? along : round;
}

/* At 1000 random points: the value; its gradient, of length 1; the derivative of that. The third derivatives of a
 * distance are below 10 / r^3, r >= .5 the distance from axis or centre. */
static void gaps_are_distances_with_their_derivatives(void **state)
{
    (void)state;
    const pzs_body *const bodies[3] = {&plane, &cylinder, &sphere};
    const double step = 0.1 * cbrt(EPS), allowed = 200 * EPS / step + 80 * step * step;
    for (int trial = 0, done = 0; done < 1000; trial++) {
        const pzs_body *body = bodies[trial % 3];
        const pzs_real x[3] = {(pzs_real)(1 + 4 * uniform()), (pzs_real)(2 + 4 * uniform()), (pzs_real)(3 + 4 * uniform())};
        pzs_real n[3], h[3][3], moved_n[2][3], ignored[3][3];
        const double gap = (double)body->gap(body, x, n, h);
        if (body != &plane && gap < 0.5 - (double)body->radius)
            continue;
        done++;
        assert_true(fabs(gap - gap_in_double(body, x)) < 100 * EPS);
        assert_true(fabs((double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) - 1) < 20 * EPS);
        for (int j = 0; j < 3; j++) {
            double gaps[2];
            volatile pzs_real end[2] = {x[j] - (pzs_real)step, x[j] + (pzs_real)step};
            for (int side = 0; side < 2; side++) {
                pzs_real at[3] = {x[0], x[1], x[2]};
                at[j] = end[side];
                gaps[side] = gap_in_double(body, at);
                body->gap(body, at, moved_n[side], ignored);
            }
            const double span = (double)(end[1] - end[0]);
            assert_true(fabs((gaps[1] - gaps[0]) / span - (double)n[j]) < allowed);
            for (int i = 0; i < 3; i++)
                assert_true(fabs((double)(moved_n[1][i] - moved_n[0][i]) / span - (double)h[i][j]) < allowed);
        }
    }
}

/* On the axis of a cylinder and in the centre of a sphere no direction leads out, and nothing is NaN. */
static void gaps_are_finite_on_axis_and_centre(void **state)
{
    (void)state;
    const pzs_body *const bodies[2] = {&cylinder, &sphere};
    for (int b = 0; b < 2; b++) {
        pzs_real n[3], h[3][3];
        const pzs_real gap = bodies[b]->gap(bodies[b], bodies[b]->point, n, h);
        assert_true(gap == -bodies[b]->radius);
        assert_int_equal(guard_nonfinite(n, 3), -1);
        assert_int_equal(guard_nonfinite(h[0], 9), -1);
    }
}

/* ---- contact ------------------------------------------------------------ */

static const double still[3] = {0, 0, 0}, up[3] = {0, 0, 1}, down[3] = {0, 0, -1};

/* Half a ring from its lowest point to its top, in plane strain: free to move up and down. */
static int ring_support(int i, int j, int k)
{
    (void)j;
    return k == 1 || k == 4 || ((i == 0 || i == 12) && (k == 0 || k == 3));
}

/* The same, its top held. */
static int held_ring_support(int i, int j, int k)
{
    return ring_support(i, j, k) || (i == 12 && k == 2);
}

/* A strip clamped at both ends. */
static int strip_support(int i, int j, int k)
{
    (void)j, (void)k;
    return i == 0 || i == 12;
}

static rig *thin_ring_open(fixing *support, double h)
{
    return rig_open(12, 1, 1, acos(-1.0) / 12, 0.3, h, 0, support, support == held_ring_support ? 6 : 12);
}

static rig *ring_open(fixing *support)
{
    return thin_ring_open(support, 0.1);
}

static const pzs_body ground = {pzs_gap_plane, {0, 0, (pzs_real)-1.05}, {0, 0, 1}, 0, NULL};

static pzs_status settle(rig *g, double load, double move)
{
    const pzs_real amount[2] = {(pzs_real)load, (pzs_real)move};
    return pzs_equilibrium(&g->path, amount);
}

/* Gap of a node of the face at the shape reached. */
static double gap_of(const rig *g, int n)
{
    double x[3];
    pzs_real at[3], normal[3], hessian[3][3];
    for (int i = 0; i < 3; i++) {
        x[i] = g->x[n][i] + g->h / 2 * g->e[n][2][i] - (double)g->path.amount[1] * (double)g->face.motion[i];
        for (int k = 0; k < 3; k++)
            for (int part = 0; part < 2; part++) {
                const uint16_t dof = g->node_dof[n][3 * part + k];
                x[i] += dof == PZS_FIXED ? 0 : (part ? g->h / 2 : 1) * (double)g->path.u[dof] * g->e[n][k][i];
            }
        at[i] = (pzs_real)x[i];
    }
    return (double)g->contact.body->gap(g->contact.body, at, normal, hessian);
}

/* Gaps are open or closed, pressures push, and no pressure acts across a gap; nodes and force are their sums. */
static void assert_complementary(const rig *g)
{
    const double size = (double)g->face.size, closed = size * fmax(1e-8, 64 * EPS);
    int touching = 0;
    for (int n = 0; n < g->nodes; n++) {
        assert_true(gap_of(g, n) >= -closed);
        assert_true(g->contact.pressure[n] >= 0);
        assert_true(g->contact.pressure[n] == 0 || gap_of(g, n) <= closed);
        touching += g->contact.pressure[n] > 0;
    }
    assert_int_equal(touching, g->contact.nodes);
}

/* Force of a contact at path->u onto f. */
static void contact_force(rig *g, pzs_real *f)
{
    memset(f, 0, (size_t)g->dof * sizeof *f);
    g->contact.option.call->add(&g->contact.option, &g->path, f);
}

/* Where a gap is closed the added matrix is minus the derivative of the force, and `unit` its derivative with respect
 * to the motion: one node anywhere on a sphere of size 1, to the differences' step^2. */
static void contact_tangent_is_the_derivative_of_its_force(void **state)
{
    (void)state;
    const double step = cbrt(EPS), motion[3] = {0.3, -0.5, 0.8};
    for (int trial = 0; trial < 50; trial++) {
        pzs_body ball = {pzs_gap_sphere, {(pzs_real)uniform(), (pzs_real)uniform(), -2}, {0, 0, 0}, 1, NULL};
        rig *g = ring_open(nothing);
        pzs_real f[2][7 * MOST_NODES];
        const int n = trial % g->nodes;
        attach_contact(g, &ball, motion);
        set_random(g, 0.3);
        g->path.amount[1] = (pzs_real)0.1;
        ball.radius += (pzs_real)gap_of(g, n);
        g->contact.touching[n] = 1;
        g->contact.pressure[n] = 1;
        g->contact.stiffness = (pzs_real)0.1;
        const double tolerance = 400 * EPS / step + 100 * step * step;
        for (int k = 0; k <= 6; k++) { /* six unknowns of the node, then the motion */
            const uint16_t *dof = g->node_dof[n];
            pzs_real *moved = k < 6 ? &g->path.u[dof[k]] : &g->path.amount[1], unit[7 * MOST_NODES] = {0};
            const pzs_real at = *moved;
            volatile pzs_real ahead = at + (pzs_real)step, behind = at - (pzs_real)step;
            pzs_real column[6];
            g->contact.option.call->unit(&g->contact.option, &g->path, 1, unit);
            linalg_clear(&g->model.k);
            contact_force(g, f[0]);
            for (int i = 0; i < 6; i++) {
                const uint16_t *high = &dof[i > k ? i : k], *low = &dof[i > k ? k : i];
                column[i] = k < 6 ? -*linalg_entry(&g->model.k, *high, *low) : unit[dof[i]];
            }
            *moved = ahead;
            contact_force(g, f[1]);
            *moved = behind;
            contact_force(g, f[0]);
            *moved = at;
            for (int i = 0; i < 6; i++)
                assert_true(fabs((double)((f[1][dof[i]] - f[0][dof[i]]) / (ahead - behind) - column[i])) < tolerance);
        }
        rig_close(g);
    }
}

static void ring_on_the_ground_carries_its_load(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    assert_int_equal(g->contact.loose, 1);
    for (int k = 1; k <= 4; k++) {
        assert_int_equal(settle(g, 1e-5 * k, 0), PZS_OK);
        assert_complementary(g);
        assert_true(g->contact.nodes > 0);
        assert_true(fabs((double)g->contact.force[2] / (1e-5 * k) - 1) < (IS_FLOAT ? 2e-3 : 1e-6));
    }
    rig_close(g);
}

/* Whatever kappa, the same shape and the same pressures: on a thin ring, whose own stiffness is far below kappa's. */
static void answer_does_not_depend_on_the_stiffness(void **state)
{
    (void)state;
    const double kappa[4] = {10, IS_FLOAT ? 1 : 1e-3, 1, 1e4};
    const double h = IS_FLOAT ? 0.1 : 0.01, load = 5e-2 * h * h * h, area = 0.3;
    const pzs_body base = {pzs_gap_plane, {0, 0, (pzs_real)(-1 - h / 2)}, {0, 0, 1}, 0, NULL};
    pzs_real u[7 * MOST_NODES], pressure[MOST_NODES];
    for (int k = 0; k < 4; k++) {
        rig *g = thin_ring_open(ring_support, h);
        attach_contact(g, &base, still);
        g->contact.stiffness = (pzs_real)kappa[k];
        g->path.change = IS_FLOAT ? (pzs_real)1e-4 : (pzs_real)1e-9;
        assert_int_equal(settle(g, load, 0), PZS_OK);
        assert_complementary(g);
        for (int i = 0; i < g->dof && k > 0; i++)
            assert_true(fabs((double)(g->path.u[i] - u[i])) < (IS_FLOAT ? 1e-3 : 1e-6));
        for (int n = 0; n < g->nodes && k > 0; n++)
            assert_true(fabs((double)(g->contact.pressure[n] - pressure[n])) < (IS_FLOAT ? 1e-2 : 1e-6) * load / area);
        memcpy(u, g->path.u, (size_t)g->dof * sizeof *u);
        memcpy(pressure, g->contact.pressure, (size_t)g->nodes * sizeof *pressure);
        rig_close(g);
    }
}

/* A held shell that is pulled away feels nothing of the body: the same bits as without it. */
static void contact_never_pulls(void **state)
{
    (void)state;
    rig *g = ring_open(held_ring_support), *alone = ring_open(held_ring_support);
    attach_contact(g, &ground, down);
    assert_int_equal(g->contact.loose, 0);
    assert_int_equal(settle(g, 0, -0.01), PZS_OK); /* press first */
    assert_complementary(g);
    assert_true(g->contact.force[2] > 0);
    assert_int_equal(settle(g, 5e-5, 1), PZS_OK);
    assert_int_equal(settle(alone, 5e-5, 1), PZS_OK);
    assert_int_equal(g->contact.nodes, 0);
    assert_true(g->contact.force[2] == 0);
    for (int i = 0; i < g->dof; i++)
        assert_true(fabs((double)(g->path.u[i] - alone->path.u[i])) < (IS_FLOAT ? 1e-4 : 1e-9));
    rig_close(g);
    rig_close(alone);
}

/* A loose shell that is pulled off its body has no equilibrium, and the last one stands. */
static void pulled_off_fails_with_a_status(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    g->path.systems_allowed = 200;
    assert_int_equal(settle(g, 3e-5, 0), PZS_OK);
    assert_true(PZS_IS_ERROR(settle(g, -3e-5, 0)));
    assert_int_equal(guard_nonfinite(g->path.u, (uint32_t)g->dof), -1);
    assert_true(g->path.factor <= (pzs_real)0.5); /* half of the way is no load at all */
    assert_complementary(g);
    rig_close(g);
}

static void restart_settles_at_once(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_true(g->path.systems > 1);
    g->path.change = (pzs_real)1e-3; /* of a thousandth of the displacement: above the rounding of either precision */
    const uint16_t nodes = g->contact.nodes;
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_int_equal(g->path.systems, 1);
    assert_int_equal(g->contact.nodes, nodes);
    rig_close(g);
}

/* However coarse the increments that are let pass, gaps are closed and no node is left to change. */
static void coarse_steps_still_close_the_gaps(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    g->path.change = (pzs_real)0.9;
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_complementary(g);
    rig_close(g);
}

/* A step that is given up leaves the last equilibrium and its contact, bit by bit. */
static void failed_step_restores_the_contact(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    pzs_real u[7 * MOST_NODES], pressure[MOST_NODES];
    uint8_t touching[MOST_NODES];
    attach_contact(g, &ground, up);
    assert_int_equal(settle(g, 3e-5, 0), PZS_OK);
    memcpy(u, g->path.u, (size_t)g->dof * sizeof *u);
    memcpy(pressure, g->contact.pressure, (size_t)g->nodes * sizeof *pressure);
    memcpy(touching, g->contact.touching, (size_t)g->nodes);
    g->path.systems_allowed = 2;
    assert_int_equal(settle(g, 5e-5, 0.5), PZS_E_SYSTEMS);
    assert_memory_equal(u, g->path.u, (size_t)g->dof * sizeof *u);
    assert_memory_equal(pressure, g->contact.pressure, (size_t)g->nodes * sizeof *pressure);
    assert_memory_equal(touching, g->contact.touching, (size_t)g->nodes);
    rig_close(g);
}

/* Back at rest nothing of the contact is left, and the same way leads to the same bits. */
static void rest_forgets_the_contact(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    pzs_real u[7 * MOST_NODES];
    attach_contact(g, &ground, still);
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    const uint32_t systems = g->path.systems;
    memcpy(u, g->path.u, (size_t)g->dof * sizeof *u);
    pzs_path_rest(&g->path);
    assert_int_equal(g->contact.nodes, 0);
    assert_true(g->contact.force[2] == 0);
    assert_int_equal(settle(g, 5e-5, 0), PZS_OK);
    assert_int_equal(g->path.systems, systems);
    assert_memory_equal(u, g->path.u, (size_t)g->dof * sizeof *u);
    rig_close(g);
}

/* A body that penetrates the shell at rest pushes it out; so does one that is moved into it. */
static void penetrating_body_is_pushed_out(void **state)
{
    (void)state;
    const pzs_body ball = {pzs_gap_sphere, {(pzs_real)0.6, (pzs_real)0.15, (pzs_real)(0.05 + 0.98)}, {0, 0, 0}, 1, NULL};
    rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.1, 0, strip_support, 6);
    attach_contact(g, &ball, down);
    assert_int_equal(settle(g, 0, 0), PZS_OK);
    assert_complementary(g);
    assert_true(g->contact.force[2] < 0);
    const pzs_real first = g->contact.force[2];
    assert_int_equal(settle(g, 0, 0.03), PZS_OK);
    assert_complementary(g);
    assert_true(g->contact.force[2] < first);
    rig_close(g);
}

/* A face that looks away from the body is left alone, however deep it lies in it: it is the far side of the shell. */
static void face_that_looks_away_is_left_alone(void **state)
{
    (void)state;
    const pzs_body below = {pzs_gap_plane, {0, 0, (pzs_real)0.2}, {0, 0, 1}, 0, NULL};
    rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.1, 0, strip_support, 6);
    attach_contact(g, &below, still);
    assert_int_equal(settle(g, 1e-6, 0), PZS_OK);
    assert_int_equal(g->contact.nodes, 0);
    rig_close(g);
}

/* A sphere whose centre is a node of the face: a status, and nothing that is not finite. */
static void centre_on_a_node_stays_finite(void **state)
{
    (void)state;
    const pzs_body ball = {pzs_gap_sphere, {(pzs_real)0.6, 0, (pzs_real)0.05}, {0, 0, 0}, (pzs_real)0.15, NULL};
    rig *g = rig_open(12, 1, 0, 0.1, 0.3, 0.1, 0, strip_support, 6);
    attach_contact(g, &ball, down);
    settle(g, 1e-5, 0);
    assert_int_equal(guard_nonfinite(g->path.u, (uint32_t)g->dof), -1);
    assert_int_equal(guard_nonfinite(g->contact.pressure, (uint32_t)g->nodes), -1);
    assert_int_equal(guard_nonfinite(g->contact.force, 3), -1);
    rig_close(g);
}

/* Influence of a dead load and of the body's motion on a shell in contact: the change of the equilibrium itself, as far
 * as kappa makes the body rigid. */
static void influence_in_contact_is_the_change_of_the_equilibrium(void **state)
{
    (void)state;
    if (IS_FLOAT)
        return; /* differences of equilibria need the digits */
    const pzs_body drum = {pzs_gap_cylinder, {0, 0, (pzs_real)(-1.05 - 3)}, {0, 1, 0}, 3, NULL};
    rig *g = ring_open(held_ring_support);
    attach_contact(g, &drum, up);
    g->path.change = (pzs_real)1e-10;
    g->contact.stiffness = 10000;
    pzs_real influence[2];
    assert_int_equal(settle(g, 1e-4, 0.05), PZS_OK);
    assert_in_range(g->contact.nodes, 1, 26);
    assert_int_equal(pzs_influence_at(&g->path, influence), PZS_OK);
    const double step[2] = {1e-7, 1e-5};
    for (int j = 0; j < 2; j++) {
        double y[2];
        for (int side = 0; side < 2; side++) {
            const double change = side ? step[j] : -step[j];
            assert_int_equal(settle(g, 1e-4 + (j == 0) * change, 0.05 + (j == 1) * change), PZS_OK);
            y[side] = (double)g->path.u[g->output_dof[0]];
        }
        assert_true(fabs((y[1] - y[0]) / (2 * step[j]) / (double)influence[j] - 1) < 1e-5);
    }
    rig_close(g);
}

static void contact_tables_out_of_range_are_refused(void **state)
{
    (void)state;
    rig *g = ring_open(ring_support);
    attach_contact(g, &ground, still);
    pzs_contact_face bad[4] = {g->face, g->face, g->face, g->face};
    const size_t bytes = PZS_CONTACT_BYTES(g->nodes);
    bad[0].input = 2;
    bad[1].face = 2;
    bad[2].size = 0;
    bad[3].area = NULL;
    for (int i = 0; i < 4; i++)
        assert_int_equal(pzs_attach_contact(&g->path, &g->contact, &bad[i], &ground, g->contact_work, bytes),
                         PZS_E_ARGUMENT);
    assert_int_equal(pzs_attach_contact(&g->path, &g->contact, &g->face, &ground, g->contact_work, bytes - 1),
                     PZS_E_WORKSPACE);
    assert_int_equal(g->path.where, bytes);
    assert_int_equal(pzs_attach_contact(&g->path, &g->contact, &g->face, &ground, g->contact_work, bytes), PZS_E_ARGUMENT);
    rig_close(g);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tangent_is_the_symmetric_part_of_the_derivative),
        cmocka_unit_test(skew_part_completes_the_derivative),
        cmocka_unit_test(force_turns_with_the_shell),
        cmocka_unit_test(pressure_on_a_flat_patch_is_its_area),
        cmocka_unit_test(pressure_is_shared_with_consistent_weights),
        cmocka_unit_test(pressure_on_an_arc_is_that_on_its_chord),
        cmocka_unit_test(influence_solves_the_unsymmetric_system),
        cmocka_unit_test(skew_part_that_is_none_is_told),
        cmocka_unit_test(true_pressure_on_a_closed_ring_adds_up_to_nothing),
        cmocka_unit_test(follower_tables_out_of_range_are_refused),
        cmocka_unit_test(options_are_attached_once),
        cmocka_unit_test(choices_out_of_range_are_refused),
        cmocka_unit_test(damaged_counts_are_not_followed),
        cmocka_unit_test(gaps_are_distances_with_their_derivatives),
        cmocka_unit_test(gaps_are_finite_on_axis_and_centre),
        cmocka_unit_test(contact_tangent_is_the_derivative_of_its_force),
        cmocka_unit_test(ring_on_the_ground_carries_its_load),
        cmocka_unit_test(answer_does_not_depend_on_the_stiffness),
        cmocka_unit_test(contact_never_pulls),
        cmocka_unit_test(pulled_off_fails_with_a_status),
        cmocka_unit_test(restart_settles_at_once),
        cmocka_unit_test(coarse_steps_still_close_the_gaps),
        cmocka_unit_test(failed_step_restores_the_contact),
        cmocka_unit_test(rest_forgets_the_contact),
        cmocka_unit_test(penetrating_body_is_pushed_out),
        cmocka_unit_test(face_that_looks_away_is_left_alone),
        cmocka_unit_test(centre_on_a_node_stays_finite),
        cmocka_unit_test(influence_in_contact_is_the_change_of_the_equilibrium),
        cmocka_unit_test(contact_tables_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
