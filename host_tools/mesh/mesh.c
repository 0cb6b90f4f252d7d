/* Mesh of a scene (mesh.h). */
#include "mesh.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../../lib/model/shell.h"
#include "warp.h"

static const double full_turn = 6.283185307179586;

/* ---- nodes and elements ----------------------------------------------- */

static int is_closed(const scene *s, int direction)
{
    const scene_line *line = &s->line[direction];
    const double range = line->point[line->elements] - line->point[0];
    return surface_closes(&s->surface, direction + 1) && !line->slit &&
           fabs(range - full_turn) < 1e-6;
}

int mesh_node(const mesh *m, int i, int j)
{
    return i % m->lines[0] * m->lines[1] + j % m->lines[1];
}

expr_point mesh_place(const mesh *m, int node)
{
    const double *x = m->point[node].x, *theta = m->theta[node];
    const expr_point place = {x[0], x[1], x[2], theta[0], theta[1]};
    return place;
}

static void cell_lines(const mesh *m, int element, int *i, int *j)
{
    *i = element / m->scene->line[1].elements;
    *j = element % m->scene->line[1].elements;
}

void mesh_cell(const mesh *m, int element, double theta1[2], double theta2[2])
{
    int i, j;
    cell_lines(m, element, &i, &j);
    for (int k = 0; k < 2; k++) {
        theta1[k] = m->scene->line[0].point[i + k];
        theta2[k] = m->scene->line[1].point[j + k];
    }
}

static void place_nodes(mesh *m)
{
    for (int i = 0; i < m->lines[0]; i++)
        for (int j = 0; j < m->lines[1]; j++) {
            const int n = mesh_node(m, i, j);
            m->theta[n][0] = m->scene->line[0].point[i];
            m->theta[n][1] = m->scene->line[1].point[j];
            m->point[n] = surface_at(&m->scene->surface, m->theta[n][0], m->theta[n][1]);
        }
    for (int e = 0; e < m->elements; e++) {
        int i, j;
        cell_lines(m, e, &i, &j);
        m->element[e][0] = (uint16_t)mesh_node(m, i, j);
        m->element[e][1] = (uint16_t)mesh_node(m, i + 1, j);
        m->element[e][2] = (uint16_t)mesh_node(m, i + 1, j + 1);
        m->element[e][3] = (uint16_t)mesh_node(m, i, j + 1);
    }
}

static int in_span(const double span[2], double theta)
{
    return theta >= span[0] && theta <= span[1];
}

/* Does mesh line i of a direction lie in a region's span? The first line of a closed direction is
 * its last one too. */
static int line_in_region(const mesh *m, const scene_where *where, int direction, int i)
{
    const scene_line *line = &m->scene->line[direction];
    const double *span = where->span[direction];
    const int is_seam = i == 0 && m->lines[direction] == line->elements;
    return in_span(span, line->point[i]) || (is_seam && in_span(span, line->point[line->elements]));
}

static int in_region(const mesh *m, const scene_where *where, int i, int j)
{
    return line_in_region(m, where, 0, i) && line_in_region(m, where, 1, j);
}

int mesh_select(const mesh *m, const scene_where *where, int *node)
{
    int count = 0;
    for (int i = 0; i < m->lines[0]; i++)
        for (int j = 0; j < m->lines[1]; j++) {
            const int chosen =
                where->type == WHERE_NODES ||
                (where->type == WHERE_REGION && in_region(m, where, i, j)) ||
                (where->type == WHERE_POINT &&
                 mesh_node(m, where->node[0], where->node[1]) == mesh_node(m, i, j)) ||
                (where->type == WHERE_EDGE && where->edge == EDGE_THETA1_MINUS && i == 0) ||
                (where->type == WHERE_EDGE && where->edge == EDGE_THETA1_PLUS &&
                 i == m->scene->line[0].elements % m->lines[0]) ||
                (where->type == WHERE_EDGE && where->edge == EDGE_THETA2_MINUS && j == 0) ||
                (where->type == WHERE_EDGE && where->edge == EDGE_THETA2_PLUS &&
                 j == m->scene->line[1].elements % m->lines[1]);
            if (chosen)
                node[count++] = mesh_node(m, i, j);
        }
    return count;
}

/* ---- element kinds ---------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double distance(const double a[3], const double b[3])
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(dot(d, d));
}

/* One corner of an element: its surface point, and the neighbour along a with the sign towards
 * growing theta_a. */
typedef struct corner_pair {
    const surface_point *own, *other;
    int a;
    double sign, length;
} corner_pair;

/* Local kinematics: components interpolated in the turning triad, derivatives with A, k, B of the
 * corner. */
static void local_tables(const corner_pair *c, const laminate *l, double s[3][3], double t[3][3],
                         double g_mean[3], double g_diff[3])
{
    const double slope = c->sign / (c->own->a[c->a] * c->length), k = c->own->k[c->a];
    const double turn = c->a == 0 ? c->own->b[1] : c->own->b[0];
    const int a = c->a, b = 1 - a;
    for (int i = 0; i < 3; i++) {
        t[i][i] = slope;
        s[i][i] = -slope;
    }
    s[a][b] += turn;
    s[b][a] -= turn;
    s[a][2] += k;
    s[2][a] -= k;
    g_mean[a] = 1 + k * (l->z[0] + l->z[1]) / 2;
    g_diff[a] = k;
}

/* Cartesian kinematics: differences of vectors between the corners, in the own triad, over the
 * chord. */
static void cartesian_tables(const corner_pair *c, const laminate *l, double s[3][3],
                             double t[3][3], double g_mean[3], double g_diff[3])
{
    const double slope = c->sign / distance(c->own->x, c->other->x),
                 middle = (l->z[0] + l->z[1]) / 2;
    double step[3], turn[3];
    for (int i = 0; i < 3; i++) {
        turn[i] = c->other->e[2][i] - c->own->e[2][i];
        step[i] = c->other->x[i] - c->own->x[i] + middle * turn[i];
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            t[i][j] = slope * dot(c->own->e[i], c->other->e[j]);
        s[i][i] = -slope;
        g_mean[i] = slope * dot(c->own->e[i], step);
        g_diff[i] = slope * dot(c->own->e[i], turn);
    }
}

static void corner_tables(const mesh *m, int element, pzs_element_type *kind)
{
    static const int neighbour[4][2] = {{1, 3}, {0, 2}, {3, 1}, {2, 0}};
    static const double sign[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    double range[2][2];
    mesh_cell(m, element, range[0], range[1]);
    for (int r = 0; r < 4; r++)
        for (int a = 0; a < 2; a++) {
            const corner_pair pair = {&m->point[m->element[element][r]],
                                      &m->point[m->element[element][neighbour[r][a]]], a,
                                      sign[r][a], range[a][1] - range[a][0]};
            (m->scene->element.cartesian ? cartesian_tables : local_tables)(
                &pair, &m->laminate, kind->s[r][a], kind->t[r][a], kind->g_mean[r][a],
                kind->g_diff[r][a]);
        }
}

/* Distances between the midpoints of opposite straight sides. */
static void centre_chords(const mesh *m, const uint16_t node[4], double chord[2])
{
    static const int high[2][2] = {{1, 2}, {2, 3}}, low[2][2] = {{0, 3}, {0, 1}};
    for (int a = 0; a < 2; a++) {
        double x[2][3];
        for (int i = 0; i < 3; i++) {
            x[0][i] = (m->point[node[low[a][0]]].x[i] + m->point[node[low[a][1]]].x[i]) / 2;
            x[1][i] = (m->point[node[high[a][0]]].x[i] + m->point[node[high[a][1]]].x[i]) / 2;
        }
        chord[a] = distance(x[0], x[1]);
    }
}

/* Area, curvatures and chords of an element at its centre, and the plies present in it. */
static laminate_place element_place(const mesh *m, int element)
{
    const scene *s = m->scene;
    double t[2][2], middle[2];
    laminate_place place;
    memset(&place, 0, sizeof place);
    mesh_cell(m, element, t[0], t[1]);
    for (int a = 0; a < 2; a++)
        middle[a] = (t[a][0] + t[a][1]) / 2;
    const surface_point centre = surface_at(&s->surface, middle[0], middle[1]);
    for (int a = 0; a < 2; a++)
        place.k[a] = centre.k[a];
    centre_chords(m, m->element[element], place.chord);
    place.area = s->element.exact_area
                     ? surface_area(&s->surface, t[0], t[1])
                     : centre.a[0] * centre.a[1] * (t[0][1] - t[0][0]) * (t[1][1] - t[1][0]);
    for (int i = 0; i < s->layers; i++)
        if (!s->layer[i].patched)
            place.present |= 1u << i;
    for (int p = 0; p < s->patch_grids; p++) {
        const scene_patches *patches = &s->patches[p];
        if (middle[0] > patches->theta1[0] && middle[0] < patches->theta1[1] &&
            middle[1] > patches->theta2[0] && middle[1] < patches->theta2[1])
            place.present |= 1u << patches->layer;
    }
    return place;
}

/* Equal up to the rounding of node positions: every array within 1e-12 of its largest entry. */
static int alike(const double *x, const double *y, size_t n)
{
    double largest = 0, difference = 0;
    for (size_t i = 0; i < n; i++) {
        largest = fmax(largest, fabs(x[i]));
        difference = fmax(difference, fabs(x[i] - y[i]));
    }
    return difference <= 1e-12 * largest;
}

static int same_kind(const pzs_element_type *x, const laminate_place *at_x,
                     const pzs_element_type *y, const laminate_place *at_y)
{
    return at_x->present == at_y->present && alike(&x->s[0][0][0][0], &y->s[0][0][0][0], 72) &&
           alike(&x->t[0][0][0][0], &y->t[0][0][0][0], 72) &&
           alike(&x->g_mean[0][0][0], &y->g_mean[0][0][0], 24) &&
           alike(&x->g_diff[0][0][0], &y->g_diff[0][0][0], 24) &&
           alike(&at_x->area, &at_y->area, 1) && alike(at_x->chord, at_y->chord, 2) &&
           alike(at_x->k, at_y->k, 2);
}

static int find_kind(const mesh *m, const pzs_element_type *kind, const laminate_place *place)
{
    for (int k = m->kinds - 1; k >= 0; k--)
        if (same_kind(kind, place, &m->kind[k], &m->place[k]))
            return k;
    return -1;
}

/* Share of the warp in the membrane shear (warp.h). */
static double warp_share(const mesh *m, const laminate_place *place)
{
    double sum = 0;
    for (int a = 0; a < 2; a++)
        sum += place->chord[a] * place->chord[a] * place->k[a];
    return m->scene->element.tau * sum / (12 * m->laminate.h);
}

/* Add a kind whose corner tables and thickness are there. */
static int add_kind(mesh *m, pzs_element_type *kind, const laminate_place *place, char *error)
{
    const scene *s = m->scene;
    if (laminate_modes(&m->laminate, &s->element, place, kind->d) < 0)
        return scene_fault(s, s->at_layers, error,
                           "no stiffness where no patch lies: add a layer that is not patched");
    if (warp_fill(kind, warp_share(m, place)) < 0)
        return scene_fault(s, s->at_surface, error,
                           "an element of %g x %g is degenerate; use other mesh lines",
                           place->chord[0], place->chord[1]);
    m->kind[m->kinds] = *kind;
    m->place[m->kinds++] = *place;
    return 0;
}

static int build_kinds(mesh *m, char *error)
{
    for (int e = 0; e < m->elements; e++) {
        pzs_element_type kind;
        memset(&kind, 0, sizeof kind);
        corner_tables(m, e, &kind);
        const laminate_place place = element_place(m, e);
        kind.thickness = m->laminate.h;
        const int known = find_kind(m, &kind, &place);
        const int k = known < 0 ? m->kinds : known;
        if (known < 0 && add_kind(m, &kind, &place, error) < 0)
            return -1;
        m->element_kind[e] = (uint16_t)k;
    }
    return 0;
}

/* ---- numbering -------------------------------------------------------- */

/* Position p of a folded closed line of n: 0, n-1, 1, n-2, ... */
static int folded(int p, int n)
{
    return p % 2 ? n - 1 - p / 2 : p / 2;
}

/* Give the unknowns of one node what a support says; values as in apply_supports. */
static int hold(mesh *m, const scene_support *support, int node, double *values, char *error)
{
    const expr_point at = mesh_place(m, node);
    const double value = support->value ? expr_value(support->value, &at) : 0;
    if (!isfinite(value))
        return scene_fault(m->scene, support->at, error,
                           "value is not a finite number at theta1 = %g, theta2 = %g", at.theta1,
                           at.theta2);
    for (unsigned i = 0; i < m->unknowns; i++) {
        const size_t u = (size_t)node * m->unknowns + i;
        const int moved = (support->move >> i & 1u) != 0, fixed = m->node_dof[u] == PZS_CONSTRAINED;
        const double before = fixed ? 0 : values[u], wanted = moved ? value : 0;
        if (!(support->fix >> i & 1u))
            continue;
        if (!isnan(before) && fabs(before - wanted) > 1e-12 * fmax(fabs(before), fabs(wanted)))
            return scene_fault(
                m->scene, support->at, error,
                "at theta1 = %g, theta2 = %g another support says %g, this one %g; keep one",
                at.theta1, at.theta2, before, wanted);
        if (moved && !fixed)
            values[u] = value;
        else
            m->node_dof[u] = PZS_CONSTRAINED;
    }
    return 0;
}

/* Mark what is held at 0; values [nodes][unknowns] out: what the prescribed unknowns are to be, NAN
 * for the others. */
static int apply_supports(mesh *m, int *node, double *values, char *error)
{
    for (size_t i = 0; i < (size_t)m->nodes * m->unknowns; i++)
        values[i] = (double)NAN;
    for (int k = 0; k < m->scene->supports; k++) {
        const scene_support *support = &m->scene->support[k];
        const int count = mesh_select(m, &support->where, node);
        for (int c = 0; c < count; c++)
            if (hold(m, support, node[c], values, error) < 0)
                return -1;
    }
    return 0;
}

/* List the unknowns with a value of their own, in the order of their numbers. */
static int list_prescribed(mesh *m, const double *values)
{
    const size_t all = (size_t)m->nodes * m->unknowns;
    double *of_dof = malloc((size_t)m->dof * sizeof *of_dof);
    m->prescribed_dof = calloc((size_t)m->dof, sizeof *m->prescribed_dof);
    m->prescribed_value = calloc((size_t)m->dof, sizeof *m->prescribed_value);
    if (of_dof && m->prescribed_dof && m->prescribed_value) {
        for (size_t u = 0; u < all; u++)
            if (m->node_dof[u] != PZS_CONSTRAINED)
                of_dof[m->node_dof[u]] = values[u];
        for (int i = 0; i < m->dof; i++)
            if (!isnan(of_dof[i])) {
                m->prescribed_dof[m->prescribed_count] = (uint16_t)i;
                m->prescribed_value[m->prescribed_count++] = of_dof[i];
            }
    }
    free(of_dof);
    return of_dof && m->prescribed_dof && m->prescribed_value ? 0 : -1;
}

static void number_unknowns(mesh *m)
{
    const int closed[2] = {is_closed(m->scene, 0), is_closed(m->scene, 1)};
    const int width_2_fast = m->lines[1] * (1 + closed[0]),
              width_1_fast = m->lines[0] * (1 + closed[1]);
    const int fast = width_2_fast <= width_1_fast ? 1 : 0, slow = 1 - fast;
    m->dof = 0;
    for (int p = 0; p < m->lines[slow]; p++)
        for (int q = 0; q < m->lines[fast]; q++) {
            const int line = closed[slow] ? folded(p, m->lines[slow]) : p;
            const int node = fast == 1 ? mesh_node(m, line, q) : mesh_node(m, q, line);
            uint16_t *dof = m->node_dof + (size_t)node * m->unknowns;
            for (unsigned i = 0; i < m->unknowns; i++)
                if (dof[i] != PZS_CONSTRAINED)
                    dof[i] = (uint16_t)(m->dof++ & 0xFFFF);
        }
}

static void find_envelope(mesh *m)
{
    for (int i = 0; i < m->dof; i++)
        m->first[i] = (uint16_t)i;
    for (int e = 0; e < m->elements; e++) {
        uint16_t least = PZS_CONSTRAINED;
        for (int pass = 0; pass < 2; pass++)
            for (int r = 0; r < 4; r++)
                for (unsigned i = 0; i < m->unknowns; i++) {
                    const uint16_t dof = m->node_dof[m->element[e][r] * m->unknowns + i];
                    if (dof == PZS_CONSTRAINED)
                        continue;
                    if (pass == 0 && dof < least)
                        least = dof;
                    if (pass == 1 && least < m->first[dof])
                        m->first[dof] = least;
                }
    }
}

int mesh_half_bandwidth(const mesh *m)
{
    int widest = 0;
    for (int i = 0; i < m->dof; i++)
        if (i - m->first[i] > widest)
            widest = i - m->first[i];
    return widest;
}

/* ---- build ------------------------------------------------------------ */

static int allocate(mesh *m)
{
    const size_t nodes = (size_t)m->nodes, elements = (size_t)m->elements;
    m->point = calloc(nodes, sizeof *m->point);
    m->theta = calloc(nodes, sizeof *m->theta);
    m->element = calloc(elements, sizeof *m->element);
    m->element_kind = calloc(elements, sizeof *m->element_kind);
    m->kind = calloc(elements, sizeof *m->kind);
    m->place = calloc(elements, sizeof *m->place);
    m->node_dof = calloc(nodes * m->unknowns, sizeof *m->node_dof);
    m->first = calloc(nodes * m->unknowns, sizeof *m->first);
    return m->point && m->theta && m->element && m->element_kind && m->kind && m->place &&
           m->node_dof && m->first;
}

static int build_stiffness(mesh *m)
{
    const size_t packed = SHELL_PACKED(4 * (size_t)m->unknowns);
    m->stiffness = malloc((size_t)m->kinds * packed * sizeof *m->stiffness);
    if (!m->stiffness)
        return -1;
    for (int k = 0; k < m->kinds; k++)
        pzs_shell_stiffness(&m->kind[k], m->unknowns, m->stiffness + (size_t)k * packed);
    return 0;
}

static int build_numbers(mesh *m, char *error)
{
    const scene *s = m->scene;
    int *node = calloc((size_t)m->nodes, sizeof *node), status = -1;
    double *values = calloc((size_t)m->nodes * m->unknowns, sizeof *values);
    if (!node || !values)
        scene_fault(s, s->line[0].at, error, "%d nodes do not fit into memory", m->nodes);
    else if (apply_supports(m, node, values, error) == 0) {
        number_unknowns(m);
        if (m->dof == 0)
            scene_fault(s, s->at_surface, error, "the supports leave nothing free");
        else if (m->dof >= (int)PZS_CONSTRAINED)
            scene_fault(s, s->line[0].at, error,
                        "%d free unknowns; tables hold at most %u: use fewer elements", m->dof,
                        PZS_CONSTRAINED - 1u);
        else if ((status = list_prescribed(m, values)) < 0)
            scene_fault(s, s->line[0].at, error, "%d unknowns do not fit into memory", m->dof);
    }
    free(node);
    free(values);
    return status;
}

static int fill(mesh *m, char *error)
{
    const scene *s = m->scene;
    if (laminate_build(s, &m->laminate, error) < 0)
        return -1;
    for (int a = 0; a < 2; a++)
        if (is_closed(s, a) && s->line[a].elements < 3)
            return scene_fault(
                s, s->line[a].at, error,
                "%d elements cannot close on themselves; take at least 3 around, better 12",
                s->line[a].elements);
    if (!allocate(m))
        return scene_fault(s, s->line[0].at, error, "%d nodes do not fit into memory", m->nodes);
    place_nodes(m);
    if (build_numbers(m, error) < 0)
        return -1;
    find_envelope(m);
    if (build_kinds(m, error) < 0)
        return -1;
    if (build_stiffness(m) < 0)
        return scene_fault(s, s->line[0].at, error, "%d element matrices do not fit into memory",
                           m->kinds);
    return 0;
}

int mesh_build(mesh *m, const scene *s, char *error)
{
    memset(m, 0, sizeof *m);
    m->scene = s;
    m->unknowns = (unsigned)s->element.unknowns;
    for (int a = 0; a < 2; a++)
        m->lines[a] = s->line[a].elements + (is_closed(s, a) ? 0 : 1);
    m->nodes = m->lines[0] * m->lines[1];
    m->elements = s->line[0].elements * s->line[1].elements;
    if (fill(m, error) == 0)
        return 0;
    mesh_free(m);
    return -1;
}

void mesh_free(mesh *m)
{
    free(m->point);
    free(m->theta);
    free(m->element);
    free(m->element_kind);
    free(m->kind);
    free(m->place);
    free(m->stiffness);
    free(m->node_dof);
    free(m->first);
    free(m->prescribed_dof);
    free(m->prescribed_value);
    memset(m, 0, sizeof *m);
}
