/* SPDX-License-Identifier: BSD-2-Clause */
/* Drawing of the rigid body that a shell touches (report_shell.h). */
#include <math.h>
#include "report_shell.h"

/*
 * Gap between the point x and the rigid body in its present position; normal = gradient of the gap.
 */
static double gap_at(const equilibrium *p, const double x[3], double normal[3])
{
    double from[3], hessian[3][3];
    for (int i = 0; i < 3; i++)
        from[i] = x[i] - p->solver.info.load_factor * p->design->scene->contact.move[i];
    return p->body.gap(&p->body, from, normal, hessian);
}

/*
 * Two unit vectors perpendicular to a normal and to each other. The second one is the projection of
 * the Cartesian axis that is most nearly perpendicular to the normal.
 */
static void find_tangents(const double normal[3], double along[2][3])
{
    int least = 2;
    for (int i = 1; i >= 0; i--)
        if (fabs(normal[i]) < fabs(normal[least]) - 1e-9)
            least = i;
    const double size = sqrt(1 - normal[least] * normal[least]);
    for (int i = 0; i < 3; i++)
        along[1][i] = ((i == least) - normal[least] * normal[i]) / size;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        along[0][i] = along[1][j] * normal[k] - along[1][k] * normal[j];
    }
}

/*
 * Move a point onto the surface of the body. This takes several iterations, because the gap
 * function need not be the exact distance.
 */
static void pull_to_body(const analysis *analysis, double x[3], double normal[3])
{
    enum { ITERATIONS = 4 };
    for (int k = 0; k < ITERATIONS; k++) {
        const double gap = gap_at(&analysis->equilibrium, x, normal);
        for (int i = 0; i < 3; i++)
            x[i] -= gap * normal[i];
    }
}

/*
 * Find the node nearest to the body. foot = its projection onto the surface of the body, normal =
 * the surface normal there.
 */
static void find_foot(const analysis *analysis, const double *vector, double foot[3],
                      double normal[3])
{
    double least = HUGE_VAL;
    for (int n = 0; n < analysis->design.mesh.nodes; n++) {
        double x[3], unused[3];
        draw_place(&analysis->design.mesh, n, vector, 1, x);
        const double gap = gap_at(&analysis->equilibrium, x, unused);
        for (int i = 0; i < 3 && gap < least; i++)
            foot[i] = x[i];
        least = fmin(least, gap);
    }
    pull_to_body(analysis, foot, normal);
}

/*
 * Extent of the nodes near the body along the two tangents, measured from the foot point.
 *   reach [2][2]  out  lowest and highest coordinate along each tangent
 */
static void find_reach(const analysis *analysis, const double *vector, const double foot[3],
                       double along[2][3], double reach[2][2])
{
    const double near = 0.12 * analysis->equilibrium.contact_face.size,
                 margin = 0.04 * analysis->equilibrium.contact_face.size;
    for (int i = 0; i < 4; i++)
        reach[i / 2][i % 2] = 0;
    for (int n = 0; n < analysis->design.mesh.nodes; n++) {
        double x[3], unused[3];
        draw_place(&analysis->design.mesh, n, vector, 1, x);
        const bool is_near = gap_at(&analysis->equilibrium, x, unused) <= near;
        for (int t = 0; t < 2 && is_near; t++) {
            const double place = draw_dot3(along[t], x) - draw_dot3(along[t], foot);
            reach[t][0] = fmin(reach[t][0], place - margin);
            reach[t][1] = fmax(reach[t][1], place + margin);
        }
    }
}

void shell_body_find(shell_body *body, const analysis *analysis, const double *vector,
                     draw_view *view)
{
    const int last = SHELL_NET - 1;
    double foot[3] = {0, 0, 0}, along[2][3], reach[2][2], unused[3];
    body->is_given = analysis->nonlinear && analysis->design.scene->contact.given;
    if (!body->is_given)
        return;
    find_foot(analysis, vector, foot, body->normal);
    find_tangents(body->normal, along);
    find_reach(analysis, vector, foot, along, reach);
    for (int k = 0; k < SHELL_NET * SHELL_NET; k++) {
        double *x = body->x[k / SHELL_NET][k % SHELL_NET];
        const double s = reach[0][0] + (reach[0][1] - reach[0][0]) * (k / SHELL_NET) / last;
        const double t = reach[1][0] + (reach[1][1] - reach[1][0]) * (k % SHELL_NET) / last;
        for (int i = 0; i < 3; i++)
            x[i] = foot[i] + s * along[0][i] + t * along[1][i];
        pull_to_body(analysis, x, unused);
        draw_view_include(view, x);
    }
}

void shell_body_draw(FILE *file, const shell_body *body, const draw_view *view, bool is_in_front)
{
    if (!body->is_given || (draw_dot3(body->normal, view->axis[2]) < 0) != is_in_front)
        return;
    draw_path(file, "body");
    for (int i = 0; i + 1 < SHELL_NET; i++)
        for (int j = 0; j + 1 < SHELL_NET; j++) {
            double at[4][2];
            draw_project(view, body->x[i][j], at[0]);
            draw_project(view, body->x[i + 1][j], at[1]);
            draw_project(view, body->x[i + 1][j + 1], at[2]);
            draw_project(view, body->x[i][j + 1], at[3]);
            draw_polygon(file, (const double(*)[2])at, 4);
        }
    draw_path_end(file);
}
