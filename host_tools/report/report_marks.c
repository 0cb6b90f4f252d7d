/* SPDX-License-Identifier: BSD-2-Clause */
/* Marks in a picture of the mesh in space: loads, outputs, directions, bodies in contact. */
#include <math.h>
#include <string.h>
#include "../mesh/springs.h"
#include "../quads/vector.h"
#include "report_shell.h"

/* Draw a point load as an arrow that ends at its node, or as a disc if it is seen end-on. */
static void draw_load(const shell *shell, const scene_load *load)
{
    const double degree = 0.017453292519943295, length = 46;
    const scene_direction direction = {.component = load->component};
    const int node = mesh_point_node(shell->mesh, &load->where);
    const expr_point place = mesh_place(shell->mesh, node);
    const double sign = expr_value(load->value, &place) < 0 ? -1 : 1;
    double along[3], tip[2];
    springs_direction(&shell->mesh->point[node], &direction, along);
    const double right = sign * vector_dot(shell->view.axis[0], along);
    const double up = sign * vector_dot(shell->view.axis[1], along);
    shell_at(shell, node, tip);
    if (hypot(right, up) < 0.25)
        draw_disc(shell->file, "force", tip, 4);
    else
        put(shell->file,
            "<path class=\"force\" transform=\"translate(%f %f) rotate(%f)\" "
            "d=\"M-8 0H-%fM-1 0l-8 -3.5v7z\"/>\n",
            tip[0], tip[1], atan2(-up, right) / degree, length * hypot(right, up));
}

void shell_marks(const shell *shell)
{
    const design *design = shell->design;
    for (int k = 0; k < design->loads; k++)
        if (design->load[k].type == LOAD_POINT)
            draw_load(shell, &design->load[k]);
    for (int k = 0; k < design->outputs; k++) {
        const scene_where *where = &design->output[k].where;
        double at[2];
        if (where->type != WHERE_POINT && where->type != WHERE_PLACE)
            continue;
        shell_at(shell, mesh_point_node(shell->mesh, where), at);
        draw_disc(shell->file, "dot", at, 3.5);
        const bool is_left = at[0] > shell->view.width * 0.65;
        const double shift = is_left ? -8 : 8;
        put(shell->file, PUT_TEXT("%t"), is_left ? "tag end" : "tag", at[0] + shift,
            at[1] + 14 + 13 * (k % 3), design->output[k].name);
    }
}

void shell_directions(const shell *shell)
{
    static const char *const name[3] = {"x", "y", "z"};
    const double x = 34, y = shell->view.height - 20, length = 22;
    for (int i = 0; i < 3; i++) {
        const double right = length * shell->view.axis[0][i];
        const double down = -length * shell->view.axis[1][i];
        put(shell->file, "<path class=\"axis\" d=\"M%f %fl%f %f\"/>" PUT_TEXT("%s"), x, y, right,
            down, "value", x + 1.4 * right, y + 1.4 * down + 4, name[i]);
    }
}

/*
 * Return the distance of a point in space from the rigid body of a contact at the present load
 * factor, negative inside the body, and compute its gradient, the normal.
 */
static double gap_at(const equilibrium *equilibrium, const double place[3], double normal[3])
{
    const double *move = equilibrium->design->contact.move;
    double from[3], hessian[3][3];
    for (int i = 0; i < 3; i++)
        from[i] = place[i] - equilibrium->solver.info.load_factor * move[i];
    return equilibrium->body.gap(&equilibrium->body, from, normal, hessian);
}

/* Project a point onto the surface of the rigid body, and compute its outward normal there. */
static void pull_to_body(const equilibrium *equilibrium, double place[3], double normal[3])
{
    for (int k = 0; k < 4; k++) {
        const double gap = gap_at(equilibrium, place, normal);
        for (int i = 0; i < 3; i++)
            place[i] -= gap * normal[i];
    }
}

/* Find the node that is nearest to the rigid body of a contact, and project it onto the body. */
static void find_foot(const equilibrium *equilibrium, const shell *shell, double foot[3],
                      double normal[3])
{
    double least = HUGE_VAL, place[3];
    for (int n = 0; n < shell->mesh->nodes; n++) {
        shell_place(shell, n, place);
        const double gap = gap_at(equilibrium, place, normal);
        if (gap < least)
            memcpy(foot, place, sizeof place);
        least = fmin(least, gap);
    }
    pull_to_body(equilibrium, foot, normal);
}

void shell_find_body(shell_body *body, const analysis *analysis, shell *shell)
{
    const equilibrium *equilibrium = &analysis->equilibrium;
    const double half = 0.2 * equilibrium->contact_face.size;
    double foot[3] = {0, 0, 0}, axis[3][3], unused[3];
    body->is_given = analysis->is_nonlinear && analysis->design.contact.given;
    if (!body->is_given)
        return;
    find_foot(equilibrium, shell, foot, body->normal);
    view_axes(body->normal, fabs(body->normal[1]) > 0.9 ? 2 : 1, axis);
    for (int k = 0; k < SHELL_NET * SHELL_NET; k++) {
        const double right = half * (2.0 * (k / SHELL_NET) / (SHELL_NET - 1) - 1);
        const double up = half * (2.0 * (k % SHELL_NET) / (SHELL_NET - 1) - 1);
        double *place = body->place[k / SHELL_NET][k % SHELL_NET];
        for (int i = 0; i < 3; i++)
            place[i] = foot[i] + right * axis[0][i] + up * axis[1][i];
        pull_to_body(equilibrium, place, unused);
        view_include(&shell->view, place);
    }
}

void shell_draw_body(const shell *shell, const shell_body *body, bool is_in_front)
{
    const bool is_hiding = vector_dot(body->normal, shell->view.axis[2]) < 0;
    if (!body->is_given || is_hiding != is_in_front)
        return;
    put(shell->file, DRAW_PATH, "body");
    for (int i = 0; i + 1 < SHELL_NET; i++)
        for (int j = 0; j + 1 < SHELL_NET; j++) {
            double at[4][2];
            for (int r = 0; r < 4; r++)
                view_project(&shell->view, body->place[i + (r == 1 || r == 2)][j + (r >= 2)],
                             at[r]);
            draw_polygon(shell->file, (const double(*)[2])at, 4);
        }
    put(shell->file, DRAW_PATH_END);
}
