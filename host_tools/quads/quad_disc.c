/* SPDX-License-Identifier: BSD-2-Clause */
/* Generation of the mesh of a disc: a middle block and rings of elements (quad_disc.h). */
#include "quad_disc.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "quad_steps.h"

static const double pi = 3.141592653589793;

/*
 * Shape of the middle block of the disc's mesh, a square with bent sides, over the radius of the
 * innermost circle around it: distance of the middle of a side from the centre, and both
 * coordinates of a corner. Corners from 0.42 to 0.5 make the angles of the elements at the border
 * nearly equal.
 */
static const double middle_of_side = 0.5, corner_of_block = 0.42;

/*
 * Division of the mesh of a disc into bands between circles (the rim is one of them), and the
 * number of elements across each band.
 */
typedef struct disc_plan {
    const quad_disc *disc;
    int around; /* number of elements along every circle of the disc */
    int bands;  /* number of bands of the disc, each between one circle and the next: number of
                   circles inside the rim plus 1 */
    double circle[QUAD_RINGS + 1];
    int across[QUAD_RINGS + 1]; /* number of elements across each band of the disc; the first band
                                   lies between the middle block of elements and the innermost
                                   circle */
    int layers; /* number of elements across all bands of the disc together: the number of layers
                   around the middle block */
} disc_plan;

static disc_plan make_plan(const quad_disc *disc)
{
    disc_plan plan = {.disc = disc, .around = 4 * disc->elements, .bands = disc->rings + 1};
    memcpy(plan.circle, disc->ring, sizeof disc->ring);
    plan.circle[disc->rings] = disc->radius;
    plan.across[0] = disc->elements / 2;
    for (int k = 1; k < plan.bands; k++) {
        const double width = plan.circle[k] - plan.circle[k - 1];
        const double length = pi * (plan.circle[k] + plan.circle[k - 1]) / plan.around;
        plan.across[k] = width > 1.5 * length ? (int)(width / length + 0.5) : 1;
    }
    for (int k = 0; k < plan.bands; k++)
        plan.layers += plan.across[k];
    return plan;
}

/* ---- nodes --------------------------------------------------------------- */

/*
 * Compute a point of the disc's middle block from u and v, which run from -1 to 1 across the block.
 */
static void block_point(double radius, double u, double v, double x[2])
{
    const double side = middle_of_side * radius, less = (middle_of_side - corner_of_block) * radius;
    x[0] = u * (side - less * fabs(v));
    x[1] = v * (side - less * fabs(u));
}

/*
 * Return the number of the node at position j along the border of the disc's middle block, counted
 * counterclockwise from its lower right corner.
 */
static uint32_t border_node(int elements, int j)
{
    const int side = j / elements, at = j % elements;
    const int column[4] = {elements, elements - at, 0, at},
              row[4] = {at, elements, elements - at, 0};
    return (uint32_t)(column[side] * (elements + 1) + row[side]);
}

/*
 * Compute the coordinates of node j of layer i in the mesh of a disc. A layer is a closed line of
 * nodes around the middle block; layers count from 1, and the last one is the rim.
 */
static void ring_point(const disc_plan *plan, const quad_mesh *mesh, int i, int j, double x[2])
{
    const double angle = -pi / 4 + 2 * pi * j / plan->around;
    int band = 0, before = 0;
    while (i > before + plan->across[band])
        before += plan->across[band++];
    const double part = (double)(i - before) / plan->across[band];
    const double outer[2] = {plan->circle[band] * cos(angle), plan->circle[band] * sin(angle)};
    double inner[2];
    for (int axis = 0; axis < 2; axis++) {
        if (band == 0)
            inner[axis] = mesh->position[border_node(plan->disc->elements, j)][axis];
        else
            inner[axis] = plan->circle[band - 1] * (axis ? sin(angle) : cos(angle));
        x[axis] = inner[axis] + part * (outer[axis] - inner[axis]);
    }
}

/*
 * Set the height and the director (unit normal) of a node of a dome, the part of a sphere, whose
 * position in the plane is known.
 */
static void lift_to_sphere(const quad_disc *disc, double x[3], double director[3])
{
    const double sphere = disc->sphere, square = x[0] * x[0] + x[1] * x[1];
    const double height = sqrt(sphere * sphere - square);
    x[2] = height - sqrt(sphere * sphere - disc->radius * disc->radius);
    director[0] = x[0] / sphere;
    director[1] = x[1] / sphere;
    director[2] = height / sphere;
}

/*
 * Set the height and the director (unit normal) of a node of a dish, the paraboloid
 * z = (x^2 + y^2)/(4 focal), whose position in the plane is known.
 */
static void lift_to_paraboloid(const quad_disc *disc, double x[3], double director[3])
{
    const double slope[2] = {x[0] / (2 * disc->focal), x[1] / (2 * disc->focal)};
    const double length = sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);
    x[2] = (x[0] * slope[0] + x[1] * slope[1]) / 2;
    director[0] = -slope[0] / length;
    director[1] = -slope[1] / length;
    director[2] = 1 / length;
}

static void lift_node(const quad_disc *disc, double x[3], double director[3])
{
    director[2] = 1;
    if (disc->sphere > 0)
        lift_to_sphere(disc, x, director);
    else if (disc->focal > 0)
        lift_to_paraboloid(disc, x, director);
}

static void fill_nodes(const disc_plan *plan, quad_mesh *mesh)
{
    const int elements = plan->disc->elements;
    size_t node = 0;
    for (int i = 0; i <= elements; i++)
        for (int j = 0; j <= elements; j++)
            block_point(plan->circle[0], 2.0 * i / elements - 1, 2.0 * j / elements - 1,
                        mesh->position[node++]);
    for (int i = 1; i <= plan->layers; i++)
        for (int j = 0; j < plan->around; j++)
            ring_point(plan, mesh, i, j, mesh->position[node++]);
    for (size_t k = 0; k < mesh->nodes; k++) {
        double *axis = mesh->axis[k], *director = mesh->director[k];
        lift_node(plan->disc, mesh->position[k], director);
        const double length = hypot(director[0], director[2]);
        axis[0] = director[2] / length;
        axis[2] = -director[0] / length;
        mesh->node_label[k] = (int64_t)k + 1;
    }
}

/* ---- elements ------------------------------------------------------------ */

/*
 * Return the index of node j of layer i in a disc's mesh. A layer is a closed line of nodes around
 * the middle block; layer 0 is the border of the block.
 */
static uint32_t layer_node(const disc_plan *plan, int i, int j)
{
    const int elements = plan->disc->elements, at = j % plan->around;
    return i == 0 ? border_node(elements, at)
                  : (uint32_t)((elements + 1) * (elements + 1) + (i - 1) * plan->around + at);
}

static void fill_elements(const disc_plan *plan, quad_mesh *mesh)
{
    const int elements = plan->disc->elements;
    size_t element = 0;
    for (int i = 0; i < elements; i++)
        for (int j = 0; j < elements; j++, element++) {
            const uint32_t corner = (uint32_t)(i * (elements + 1) + j),
                           next = corner + (uint32_t)elements + 1;
            const uint32_t node[4] = {corner, next, next + 1, corner + 1};
            memcpy(mesh->element[element], node, sizeof node);
        }
    for (int i = 0; i < plan->layers; i++)
        for (int j = 0; j < plan->around; j++, element++) {
            const uint32_t node[4] = {layer_node(plan, i, j), layer_node(plan, i + 1, j),
                                      layer_node(plan, i + 1, j + 1), layer_node(plan, i, j + 1)};
            memcpy(mesh->element[element], node, sizeof node);
        }
    for (size_t k = 0; k < mesh->elements; k++)
        mesh->element_label[k] = (int64_t)k + 1;
}

/* ---- sets ---------------------------------------------------------------- */

/*
 * Add the elements of one angular sector of a disc to a set, in the layers from `first` to last -
 * 1; a layer is a ring of elements one element wide.
 */
static void add_sector(const disc_plan *plan, int first, int last, int sector, int sectors,
                       quad_set *set)
{
    const int elements = plan->disc->elements, each = plan->around / sectors, turn = elements / 2;
    for (int i = first; i < last; i++)
        /*
         * The elements of a ring around the square block in the middle of the disc are counted from
         * a corner of the block. The angular sectors are counted from the x axis, which meets the
         * ring half a side of the block (`turn` elements) after this corner.
         */
        for (int j = 0; j < plan->around; j++)
            if ((j - turn + plan->around) % plan->around / each == sector)
                set->index[set->count++] = (uint32_t)(elements * elements + i * plan->around + j);
}

static int fill_element_sets(const disc_plan *plan, quad_mesh *mesh)
{
    const int elements = plan->disc->elements, sectors = plan->disc->sectors;
    char name[40];
    int first = plan->across[0];
    quad_set *set = mesh->element_set;
    if (!quad_set_begin(set, "ring1", mesh->elements))
        return -1;
    for (int element = 0; element < elements * elements; element++)
        set->index[set->count++] = (uint32_t)element;
    add_sector(plan, 0, first, 0, 1, set++);
    for (int k = 1; k < plan->bands; k++) {
        for (int sector = 0; sector < sectors; sector++, set++) {
            snprintf(name, sizeof name, "ring%d-%d", k + 1, sector + 1);
            if (sectors == 1)
                snprintf(name, sizeof name, "ring%d", k + 1);
            if (!quad_set_begin(set, name, mesh->elements))
                return -1;
            add_sector(plan, first, first + plan->across[k], sector, sectors, set);
        }
        first += plan->across[k];
    }
    return 0;
}

static int fill_sets(const disc_plan *plan, quad_mesh *mesh)
{
    const int elements = plan->disc->elements;
    if (fill_element_sets(plan, mesh) < 0 || !quad_set_begin(mesh->node_set, "centre", 1) ||
        !quad_set_begin(mesh->edge_set, "rim", (size_t)plan->around))
        return -1;
    mesh->node_set[0].index[mesh->node_set[0].count++] = (uint32_t)(elements / 2 * (elements + 2));
    for (int j = 0; j < plan->around; j++) { /* Side 1 of an element in the outermost ring lies on
                                                the rim of the disc. */
        const uint32_t element =
            (uint32_t)(elements * elements + (plan->layers - 1) * plan->around + j);
        mesh->edge_set[0].index[mesh->edge_set[0].count++] = 4 * element + 1;
    }
    return 0;
}

/* ---- mesh ---------------------------------------------------------------- */

static int allocate(const disc_plan *plan, quad_mesh *mesh)
{
    const size_t elements = (size_t)plan->disc->elements,
                 rings = (size_t)plan->layers * (size_t)plan->around;
    mesh->nodes = (elements + 1) * (elements + 1) + rings;
    mesh->elements = elements * elements + rings;
    mesh->node_sets = mesh->edge_sets = 1;
    mesh->element_sets = 1 + (size_t)(plan->bands - 1) * (size_t)plan->disc->sectors;
    mesh->node_set = calloc(1, sizeof *mesh->node_set);
    mesh->edge_set = calloc(1, sizeof *mesh->edge_set);
    mesh->element_set = calloc(mesh->element_sets, sizeof *mesh->element_set);
    if (!mesh->node_set || !mesh->edge_set || !mesh->element_set) {
        mesh->node_sets = mesh->edge_sets = mesh->element_sets = 0;
        return -1;
    }
    return quad_mesh_allocate(mesh);
}

int quad_disc_make(quad_mesh *mesh, const quad_disc *disc)
{
    const disc_plan plan = make_plan(disc);
    memset(mesh, 0, sizeof *mesh);
    int status = allocate(&plan, mesh);
    if (status == 0) {
        mesh->region[0].present_plies = ~0u;
        fill_nodes(&plan, mesh);
        fill_elements(&plan, mesh);
        status = fill_sets(&plan, mesh);
    }
    if (status == 0)
        status = quad_turn(mesh);
    if (status == 0)
        status = quad_renumber(mesh);
    if (status < 0)
        quad_mesh_free(mesh);
    return status;
}
