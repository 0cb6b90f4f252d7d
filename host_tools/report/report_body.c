/* The body of a contact in a picture (report_body.h). */
#include "report_body.h"
#include <math.h>
#include <string.h>

/* Distance of x from the body as it stands now, its gradient in normal. */
static double gap_at(const equilibrium *equilibrium, const double x[3], double normal[3])
{
    double from[3], hessian[3][3];
    for (int i = 0; i < 3; i++)
        from[i] = x[i] - equilibrium->solver.info.load_factor *
                             equilibrium->design->scene->contact.move[i];
    return equilibrium->body.gap(&equilibrium->body, from, normal, hessian);
}

/* Two unit vectors across a normal, the second along the axis that lies most across it. */
static void tangents(const double normal[3], double along[2][3])
{
    int least = 2;
    for (int i = 1; i >= 0; i--)
        if (fabs(normal[i]) < fabs(normal[least]) - 1e-9)
            least = i;
    double size = 0;
    for (int i = 0; i < 3; i++) {
        along[1][i] = (i == least) - normal[least] * normal[i];
        size += along[1][i] * along[1][i];
    }
    for (int i = 0; i < 3; i++)
        along[1][i] /= sqrt(size);
    for (int i = 0; i < 3; i++)
        along[0][i] = along[1][(i + 1) % 3] * normal[(i + 2) % 3] -
                      along[1][(i + 2) % 3] * normal[(i + 1) % 3];
}

/* The node nearest to the body: its foot on it, the normal there. */
static void nearest(const analysis *analysis, const double *vector, double foot[3],
                    double normal[3])
{
    double least = HUGE_VAL;
    for (int n = 0; n < analysis->design.mesh.nodes; n++) {
        double x[3], out[3];
        draw_place(&analysis->design.mesh, n, vector, 1, x);
        const double gap = gap_at(&analysis->equilibrium, x, out);
        if (!(gap < least))
            continue;
        least = gap;
        for (int i = 0; i < 3; i++) {
            normal[i] = out[i];
            foot[i] = x[i] - gap * out[i];
        }
    }
}

/* How far the nodes near the body reach along the tangents at a foot, with a margin. reach [2][2]
 * out */
static void reach_of(const analysis *analysis, const double *vector, const double foot[3],
                     double along[2][3], double reach[2][2])
{
    const double size = analysis->equilibrium.contact_face.size, near = 0.12 * size,
                 margin = 0.04 * size;
    memset(reach, 0, 4 * sizeof **reach);
    for (int n = 0; n < analysis->design.mesh.nodes; n++) {
        double x[3], unused[3];
        draw_place(&analysis->design.mesh, n, vector, 1, x);
        if (gap_at(&analysis->equilibrium, x, unused) > near)
            continue;
        for (int i = 0; i < 3; i++)
            x[i] -= foot[i];
        for (int t = 0; t < 2; t++) {
            const double place = draw_dot3(along[t], x);
            reach[t][0] = fmin(reach[t][0], place);
            reach[t][1] = fmax(reach[t][1], place);
        }
    }
    for (int t = 0; t < 2; t++) {
        reach[t][0] -= margin;
        reach[t][1] += margin;
    }
}

void body_find(body_net *net, const analysis *analysis, const double *vector)
{
    enum { PULLS = 4 };
    double foot[3] = {0, 0, 0}, along[2][3], reach[2][2];
    memset(net, 0, sizeof *net);
    net->given = analysis->nonlinear && analysis->design.scene->contact.given;
    if (!net->given)
        return;
    nearest(analysis, vector, foot, net->normal);
    tangents(net->normal, along);
    reach_of(analysis, vector, foot, along, reach);
    for (int i = 0; i < BODY_LINES; i++)
        for (int j = 0; j < BODY_LINES; j++) {
            double *x = net->x[i][j], out[3];
            const double s = reach[0][0] + (reach[0][1] - reach[0][0]) * i / (BODY_LINES - 1);
            const double t = reach[1][0] + (reach[1][1] - reach[1][0]) * j / (BODY_LINES - 1);
            for (int k = 0; k < 3; k++)
                x[k] = foot[k] + s * along[0][k] + t * along[1][k];
            for (int pull = 0; pull < PULLS; pull++) {
                const double gap = gap_at(&analysis->equilibrium, x, out);
                for (int k = 0; k < 3; k++)
                    x[k] -= gap * out[k];
            }
        }
}

void body_include(const body_net *net, draw_view *view)
{
    for (int i = 0; net->given && i < BODY_LINES; i++)
        for (int j = 0; j < BODY_LINES; j++)
            draw_view_include(view, net->x[i][j]);
}

void body_draw(FILE *file, const body_net *net, const draw_view *view, int in_front)
{
    if (!net->given || (draw_dot3(net->normal, view->axis[2]) < 0) != in_front)
        return;
    fputs("<path class=\"body\" d=\"", file);
    for (int i = 0; i + 1 < BODY_LINES; i++)
        for (int j = 0; j + 1 < BODY_LINES; j++) {
            static const int side[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
            for (int r = 0; r < 4; r++) {
                double at[2];
                draw_project(view, net->x[i + side[r][0]][j + side[r][1]], at);
                fprintf(file, "%c%.1f %.1f", r ? 'L' : 'M', at[0], at[1]);
            }
            fputc('z', file);
        }
    fputs("\"/>\n", file);
}
