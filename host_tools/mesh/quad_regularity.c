/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Irregularity of a mesh of quadrilaterals in any arrangement, and the treatment of irregular thin
 * elements (quad_regularity.h).
 */
#include "quad_regularity.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "../quads/vector.h"

/* ---- nodes -------------------------------------------------------------- */

/*
 * Sums over the edges that meet at a node, for the irregularity of the mesh there: of the vectors
 * to the neighbouring nodes, and of the lengths of these vectors (m).
 */
typedef struct edge_sum {
    double vector[3], length;
    bool is_border;
} edge_sum;

static void add_edge(const quad_mesh *mesh, const quad_side *side, bool is_border, edge_sum *sum)
{
    const uint32_t node[2] = {side->low, side->high};
    for (int end = 0; end < 2; end++) {
        const double *from = mesh->position[node[end]], *to = mesh->position[node[1 - end]];
        const double step[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
        edge_sum *own = &sum[node[end]];
        for (int i = 0; i < 3; i++)
            own->vector[i] += step[i];
        own->length += vector_length(step);
        own->is_border |= is_border;
    }
}

int quad_irregularity(const quad_mesh *mesh, const quad_side *side, double *irregularity)
{
    edge_sum *sum = calloc(mesh->nodes, sizeof *sum);
    if (!sum)
        return -1;
    for (size_t k = 0; k < 4 * mesh->elements;) {
        size_t count = 1;
        while (k + count < 4 * mesh->elements && quad_side_is_same(&side[k], &side[k + count]))
            count++;
        add_edge(mesh, &side[k], count == 1, sum);
        k += count;
    }
    for (size_t node = 0; node < mesh->nodes; node++) {
        const double normal = vector_dot(sum[node].vector, mesh->director[node]);
        for (int i = 0; i < 3; i++)
            sum[node].vector[i] -= normal * mesh->director[node][i];
        irregularity[node] = 0;
        if (!sum[node].is_border && sum[node].length > 0)
            irregularity[node] = vector_length(sum[node].vector) / sum[node].length;
    }
    free(sum);
    return 0;
}

/* ---- rule --------------------------------------------------------------- */

/*
 * Return the factor that limits the correction quad_rule.asymptotic to elements along asymptotic
 * lines: max(0, 1 - 2 |B_11 B_22|/B_12^2), with the curvatures B along the directions of the
 * element. It is 1 on a twisted strip (B_11 = B_22 = 0) and 0 along lines of curvature (B_12 = 0).
 */
static double asymptotic_gate(const quad_geometry *geometry)
{
    const double *curvature = geometry->curvature, square = curvature[2] * curvature[2];
    if (!(square * geometry->length[0] * geometry->length[0] > 1e-12))
        return 0;
    return fmax(0, 1 - 2 * fabs(curvature[0] * curvature[1]) / square);
}

quad_rule quad_rule_of(const quad_geometry *geometry, double thickness, double irregularity)
{
    const double *curvature = geometry->curvature, *length = geometry->length;
    const double bent[3] = {fabs(curvature[0]) * length[0] * length[0],
                            fabs(curvature[1]) * length[1] * length[1],
                            fabs(curvature[2]) * length[0] * length[1]};
    quad_rule rule;
    rule.thinness = fmax(bent[0], fmax(bent[1], bent[2])) / thickness;
    rule.irregularity = fmax(fabs(geometry->skew[0]) + fabs(geometry->skew[1]), irregularity);
    const double rough = rule.irregularity * rule.thinness / 3;
    const double clipped = fmin(fmax((rule.irregularity - 0.2) / 0.1, 0), 1);
    const double lock = rule.thinness * clipped / 70, thin = rule.thinness / 16;
    rule.bubble_share = 1 / (1 + rough * rough);
    rule.lock = lock * lock;
    rule.asymptotic = asymptotic_gate(geometry) * rule.bubble_share / (1 + thin * thin);
    return rule;
}
