/* SPDX-License-Identifier: BSD-2-Clause */
/* Generation of the mesh of a panel with a hole (quad_panel.h). */
#include "quad_panel.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "quad_steps.h"

static const double pi = 3.141592653589793;

/*
 * Plan of the mesh of a rectangular panel with a circular hole: a grid of lines along x and the
 * width, in which rings of elements fill a square block around the hole. The closed lines of nodes
 * between rings have numbers from 0, the rim of the hole, to `layers`, the border of the block.
 */
typedef struct panel_plan {
    const quad_panel *panel;
    int side;    /* number of elements along a side of the square block around the hole */
    int around;  /* number of elements around the hole */
    int layers;  /* number of rings of elements between the hole and the border of the square block
                    around it */
    double half; /* half of the side length of the square block around the hole (m) */
    /*
     * number of grid elements between the edge of the panel at its smallest coordinate and the
     * square block of elements around the hole: [0] along x, [1] along the width
     */
    int before[2];
    int elements[2]; /* number of elements of the grid along x and along the width */
    size_t grid; /* number of nodes of the grid that do not lie inside the square block around the
                    hole */
} panel_plan;

/* Return the number of elements of a given size along a length, at most a million. */
static int elements_along(double length, double size)
{
    const int count = (int)fmin(length / size + 0.5, 1e6);
    return count > 1 ? count : 1;
}

/* Return half of the length of the side of the block around the hole (m). */
static double half_of_block(const quad_panel *panel)
{
    const double extent[2] = {panel->length, panel->width};
    double clear = HUGE_VAL;
    for (int axis = 0; axis < 2; axis++)
        clear = fmin(clear, extent[axis] / 2 - fabs(panel->centre[axis]));
    return fmin(2.5 * panel->hole, (panel->hole + clear) / 2);
}

static panel_plan make_plan(const quad_panel *panel)
{
    panel_plan plan = {.panel = panel, .side = panel->elements, .around = 4 * panel->elements};
    const double extent[2] = {panel->length, panel->width};
    plan.half = half_of_block(panel);
    const double size = 2 * plan.half / plan.side;
    for (int axis = 0; axis < 2; axis++) {
        const double from = extent[axis] / 2 + panel->centre[axis] - plan.half,
                     to = extent[axis] / 2 - panel->centre[axis] - plan.half;
        plan.before[axis] = elements_along(from, size);
        plan.elements[axis] = plan.before[axis] + plan.side + elements_along(to, size);
    }
    /*
     * Number of rings around the hole. Elements that are as high as wide grow by the factor 1 + 2
     * pi/around from one ring to the next, if a ring has `around` elements.
     */
    plan.layers = elements_along(log(1.1 * plan.half / panel->hole), 2 * pi / plan.around);
    const size_t inside = (size_t)(plan.side - 1) * (size_t)(plan.side - 1);
    plan.grid = (size_t)(plan.elements[0] + 1) * (size_t)(plan.elements[1] + 1) - inside;
    return plan;
}

static size_t node_count(const panel_plan *plan)
{
    return plan->grid + (size_t)plan->layers * (size_t)plan->around;
}

int quad_panel_least_elements(const quad_panel *panel)
{
    const double longest = 0.25 * panel->cylinder, side = 2 * half_of_block(panel);
    return panel->cylinder > 0 ? (int)fmin(ceil(side / longest), 1e6) : 1;
}

size_t quad_panel_nodes(const quad_panel *panel)
{
    const panel_plan plan = make_plan(panel);
    return node_count(&plan);
}

/* ---- numbers of nodes ------------------------------------------------------ */

/*
 * Return the number of the node of the panel's grid with index i along x and index j along the
 * width. The node must not lie inside the square block around the hole, where the grid has no
 * nodes. The numbers run along the width first.
 */
static uint32_t grid_node(const panel_plan *plan, int i, int j)
{
    const int first[2] = {plan->before[0] + 1, plan->before[1] + 1}, inner = plan->side - 1;
    int number = i * (plan->elements[1] + 1) + j;
    for (int line = 0; line < inner; line++) {
        if (i > first[0] + line)
            number -= inner;
        else if (i == first[0] + line && j >= first[1] + inner)
            number -= inner;
    }
    return (uint32_t)number;
}

/*
 * Return the number of node j on the border of the square block around the hole. The nodes are
 * counted counterclockwise from the corner with the smallest coordinates along x and along the
 * width.
 */
static uint32_t border_node(const panel_plan *plan, int j)
{
    const int side = j / plan->side, at = j % plan->side;
    const int column[4] = {at, plan->side, plan->side - at, 0},
              row[4] = {0, at, plan->side, plan->side - at};
    return grid_node(plan, plan->before[0] + column[side], plan->before[1] + row[side]);
}

/*
 * Return the number of node j of a ring line, a closed line of nodes around the hole. Line 0 is the
 * rim of the hole, and the last line is the border of the square block around it.
 *   layer in  number of the ring line
 */
static uint32_t layer_node(const panel_plan *plan, int layer, int j)
{
    const int at = j % plan->around;
    return layer == plan->layers ? border_node(plan, at)
                                 : (uint32_t)plan->grid + (uint32_t)(layer * plan->around + at);
}

/* ---- positions in the plane ------------------------------------------------- */

/*
 * Return the coordinate (m) of line i of the grid along x (axis 0) or along the width (axis 1).
 * Lines are equidistant in each of three parts: before, beside and behind the square block around
 * the hole.
 */
static double line_at(const panel_plan *plan, int axis, int i)
{
    const double extent = axis == 0 ? plan->panel->length : plan->panel->width;
    const double centre = plan->panel->centre[axis];
    const int before = plan->before[axis], after = before + plan->side;
    const double at[4] = {-extent / 2, centre - plan->half, centre + plan->half, extent / 2};
    const int line[4] = {0, before, after, plan->elements[axis]};
    int part = 0;
    while (part < 2 && i > line[part + 1])
        part++;
    const double share = (double)(i - line[part]) / (line[part + 1] - line[part]);
    return at[part] + share * (at[part + 1] - at[part]);
}

/*
 * Return whether a node of the panel's grid lies inside the square block around the hole, where
 * rings of elements replace the grid.
 *   i, j in  line of the grid along x and along the width
 */
static bool in_block(const panel_plan *plan, int i, int j)
{
    return i > plan->before[0] && i < plan->before[0] + plan->side && j > plan->before[1] &&
           j < plan->before[1] + plan->side;
}

static void place_nodes(const panel_plan *plan, quad_mesh *mesh)
{
    const quad_panel *panel = plan->panel;
    for (int i = 0; i <= plan->elements[0]; i++)
        for (int j = 0; j <= plan->elements[1]; j++)
            if (!in_block(plan, i, j)) {
                double *x = mesh->position[grid_node(plan, i, j)];
                x[0] = line_at(plan, 0, i);
                x[1] = line_at(plan, 1, j);
            }
    for (int layer = 0; layer < plan->layers; layer++)
        for (int j = 0; j < plan->around; j++) {
            const double angle = -3 * pi / 4 + 2 * pi * j / plan->around;
            const double unit[2] = {cos(angle), sin(angle)}, share = (double)layer / plan->layers;
            double *x = mesh->position[layer_node(plan, layer, j)];
            const double *border = mesh->position[border_node(plan, j)];
            for (int axis = 0; axis < 2; axis++) {
                const double rim = panel->centre[axis] + panel->hole * unit[axis];
                x[axis] = rim + share * (border[axis] - rim);
            }
        }
}

/* ---- elements ------------------------------------------------------------- */

static void fill_elements(const panel_plan *plan, quad_mesh *mesh)
{
    size_t element = 0;
    for (int layer = 0; layer < plan->layers; layer++)
        for (int j = 0; j < plan->around; j++) {
            const uint32_t node[4] = {layer_node(plan, layer, j), layer_node(plan, layer + 1, j),
                                      layer_node(plan, layer + 1, j + 1),
                                      layer_node(plan, layer, j + 1)};
            memcpy(mesh->element[element++], node, sizeof node);
        }
    for (int i = 0; i < plan->elements[0]; i++)
        for (int j = 0; j < plan->elements[1]; j++) {
            const bool in_column = i >= plan->before[0] && i < plan->before[0] + plan->side;
            const bool in_row = j >= plan->before[1] && j < plan->before[1] + plan->side;
            if (in_column && in_row)
                continue;
            const uint32_t node[4] = {grid_node(plan, i, j), grid_node(plan, i + 1, j),
                                      grid_node(plan, i + 1, j + 1), grid_node(plan, i, j + 1)};
            memcpy(mesh->element[element++], node, sizeof node);
        }
    for (size_t k = 0; k < mesh->elements; k++)
        mesh->element_label[k] = (int64_t)k + 1;
    for (size_t k = 0; k < mesh->nodes; k++)
        mesh->node_label[k] = (int64_t)k + 1;
}

/* ---- smoothing ------------------------------------------------------------- */

/* Largest number of nodes with which one node shares a side of an element. */
enum { NEIGHBOURS = 5 };
typedef struct panel_neighbours {
    int count;
    bool is_fixed; /* whether the node lies on the border of the panel or on the rim of the hole */
    uint32_t node[NEIGHBOURS];
} panel_neighbours;

static void join(panel_neighbours *of, uint32_t from, uint32_t to)
{
    for (int k = 0; k < of[from].count; k++)
        if (of[from].node[k] == to)
            return;
    of[from].node[of[from].count++] = to;
}

static void find_neighbours(const panel_plan *plan, const quad_mesh *mesh, panel_neighbours *of)
{
    for (size_t k = 0; k < mesh->elements; k++)
        for (int corner = 0; corner < 4; corner++) {
            const uint32_t node = mesh->element[k][corner],
                           next = mesh->element[k][(corner + 1) % 4];
            join(of, node, next);
            join(of, next, node);
        }
    for (int j = 0; j < plan->around; j++)
        of[layer_node(plan, 0, j)].is_fixed = true;
    for (int i = 0; i <= plan->elements[0]; i++)
        of[grid_node(plan, i, 0)].is_fixed = of[grid_node(plan, i, plan->elements[1])].is_fixed =
            true;
    for (int j = 0; j <= plan->elements[1]; j++)
        of[grid_node(plan, 0, j)].is_fixed = of[grid_node(plan, plan->elements[0], j)].is_fixed =
            true;
}

/*
 * Move a node towards the mean position of its neighbours. Returns the distance between the node
 * and this mean before the move.
 *   factor in  length of the move, as a multiple of this distance
 */
static double move_node(quad_mesh *mesh, const panel_neighbours *of, double *x, double factor)
{
    double mean[2] = {0, 0};
    for (int k = 0; k < of->count; k++)
        for (int axis = 0; axis < 2; axis++)
            mean[axis] += mesh->position[of->node[k]][axis] / of->count;
    const double away = hypot(mean[0] - x[0], mean[1] - x[1]);
    for (int axis = 0; axis < 2; axis++)
        x[axis] += factor * (mean[axis] - x[axis]);
    return away;
}

/*
 * Move every inner node to the mean of its neighbours, by successive overrelaxation with the factor
 * that is best for a square grid. Around the hole, the elements then grow from layer to layer in
 * proportion to their distance from its centre and keep their shape.
 */
static int smooth(const panel_plan *plan, quad_mesh *mesh)
{
    enum { ITERATIONS = 5000 };
    const int longest = (int)fmax(plan->elements[0], plan->elements[1]);
    const double factor = 2 / (1 + sin(pi / longest)), small = 1e-13 * plan->panel->hole;
    panel_neighbours *of = calloc(mesh->nodes, sizeof *of);
    double away = HUGE_VAL;
    if (!of)
        return -1;
    find_neighbours(plan, mesh, of);
    for (int k = 0; k < ITERATIONS && away > small; k++) {
        away = 0;
        for (size_t node = 0; node < mesh->nodes; node++)
            if (!of[node].is_fixed)
                away = fmax(away, move_node(mesh, &of[node], mesh->position[node], factor));
    }
    free(of);
    return 0;
}

/* ---- sets ------------------------------------------------------------------ */

/* Names of the five edge sets of a panel's mesh: its four sides and the rim of the hole. */
static const char *const edge_names[5] = {"left", "right", "bottom", "top", "hole"};

/*
 * Mark the nodes on the sides of the panel and on the rim of the hole.
 *   mark [nodes] in/out  bit k is set for nodes on the edge with the name edge_names[k]
 */
static void mark_edges(const panel_plan *plan, unsigned char *mark)
{
    for (int j = 0; j <= plan->elements[1]; j++) {
        mark[grid_node(plan, 0, j)] |= 1u;
        mark[grid_node(plan, plan->elements[0], j)] |= 2u;
    }
    for (int i = 0; i <= plan->elements[0]; i++) {
        mark[grid_node(plan, i, 0)] |= 4u;
        mark[grid_node(plan, i, plan->elements[1])] |= 8u;
    }
    for (int j = 0; j < plan->around; j++)
        mark[layer_node(plan, 0, j)] |= 16u;
}

static int fill_sets(const panel_plan *plan, quad_mesh *mesh)
{
    const size_t in_block = (size_t)plan->layers * (size_t)plan->around;
    unsigned char *mark = calloc(mesh->nodes, 1);
    bool failed = !mark || !quad_set_begin(mesh->element_set, "around_hole", in_block);
    for (int k = 0; k < 5 && !failed; k++)
        failed = !quad_set_begin(&mesh->edge_set[k], edge_names[k], 4 * mesh->elements);
    if (!failed)
        mark_edges(plan, mark);
    for (size_t k = 0; k < in_block && !failed; k++)
        mesh->element_set->index[mesh->element_set->count++] = (uint32_t)k;
    for (size_t edge = 0; edge < 4 * mesh->elements && !failed; edge++) {
        const uint32_t *node = mesh->element[edge / 4];
        const unsigned both = mark[node[edge % 4]] & mark[node[(edge + 1) % 4]];
        for (int k = 0; k < 5; k++)
            if (both >> k & 1u)
                mesh->edge_set[k].index[mesh->edge_set[k].count++] = (uint32_t)edge;
    }
    free(mark);
    return failed ? -1 : 0;
}

/* ---- mesh -------------------------------------------------------------------- */

/*
 * Move a node from the plane onto the cylinder, if the panel is curved, and compute its unit normal
 * (director) and its first axis, which points along x.
 */
static void lift_node(const quad_panel *panel, double x[3], double director[3], double axis[3])
{
    const double angle = panel->cylinder > 0 ? x[1] / panel->cylinder : 0;
    axis[0] = 1;
    director[1] = sin(angle);
    director[2] = cos(angle);
    if (!(panel->cylinder > 0))
        return;
    x[1] = panel->cylinder * sin(angle);
    x[2] = -2 * panel->cylinder * sin(angle / 2) * sin(angle / 2);
}

static int allocate(const panel_plan *plan, quad_mesh *mesh)
{
    const size_t side = (size_t)plan->side;
    mesh->nodes = node_count(plan);
    mesh->elements = (size_t)plan->elements[0] * (size_t)plan->elements[1] - side * side +
                     (size_t)plan->layers * (size_t)plan->around;
    mesh->edge_set = calloc(5, sizeof *mesh->edge_set);
    mesh->element_set = calloc(1, sizeof *mesh->element_set);
    mesh->edge_sets = mesh->edge_set ? 5 : 0;
    mesh->element_sets = mesh->element_set ? 1 : 0;
    return mesh->edge_set && mesh->element_set ? quad_mesh_allocate(mesh) : -1;
}

int quad_panel_make(quad_mesh *mesh, const quad_panel *panel)
{
    const panel_plan plan = make_plan(panel);
    memset(mesh, 0, sizeof *mesh);
    int status = allocate(&plan, mesh);
    if (status == 0) {
        mesh->region[0].present_plies = ~0u;
        place_nodes(&plan, mesh);
        fill_elements(&plan, mesh);
        status = smooth(&plan, mesh);
    }
    for (size_t k = 0; k < mesh->nodes && status == 0; k++)
        lift_node(panel, mesh->position[k], mesh->director[k], mesh->axis[k]);
    if (status == 0)
        status = fill_sets(&plan, mesh);
    if (status == 0)
        status = quad_turn(mesh);
    if (status == 0)
        status = quad_renumber(mesh);
    if (status < 0)
        quad_mesh_free(mesh);
    return status;
}
