/* Page of `pzs shape` (report.h). */
#include "report.h"
#include <math.h>
#include <stdlib.h>
#include "report_html.h"
#include "report_modes.h"
#include "report_parts.h"
#include "report_plane.h"

/* One set of volts with all that is drawn of it. */
typedef struct result {
    const voltages *volts;
    double *vector;          /* [nodes][3] displacement reached */
    double *wanted, *misfit; /* [nodes][3], [nodes] as parts_misfit has them */
    plane_outline *outline;  /* [amplifiers] */
    double worst, rms, volt; /* largest and root mean square misfit, largest volt */
    int beyond;              /* amplifiers beyond the limits of the scene */
} result;

typedef struct page {
    FILE *file;
    analysis *a;
    const design *d;
    result *result;
    int results, plans;
    const modes *modes;
    int *plan; /* [actuators] */
    draw_view view;
    double factor;           /* magnification of every drawing */
    double target;           /* largest wanted displacement */
    draw_scale misfit, volt; /* shared by every set */
    double residual;         /* largest of the drawn shapes */
} page;

/* ---- results ---------------------------------------------------------- */

static void result_free(result *r)
{
    free(r->vector);
    free(r->wanted);
    free(r->misfit);
    free(r->outline);
}

static int result_room(result *r, const design *d)
{
    const size_t nodes = (size_t)d->mesh.nodes;
    r->vector = calloc(3 * nodes, sizeof *r->vector);
    r->wanted = calloc(3 * nodes, sizeof *r->wanted);
    r->misfit = calloc(nodes, sizeof *r->misfit);
    r->outline = calloc((size_t)d->amplifiers + 1, sizeof *r->outline);
    return r->vector && r->wanted && r->misfit && r->outline ? 0 : -1;
}

static void result_misfit(const design *d, result *r)
{
    parts_misfit(d, r->volts->shape, r->volts->aim, r->vector, r->misfit, r->wanted);
    for (int t = 0; t < d->targets; t++) {
        const double miss = r->misfit[d->target_node[t]];
        r->worst = fmax(r->worst, fabs(miss));
        r->rms += miss * miss / d->targets;
    }
    r->rms = sqrt(r->rms);
}

/* At one of the limits this set obeyed, or beyond those of the scene. */
static void result_outline(const design *d, result *r)
{
    const voltages *v = r->volts;
    for (int k = 0; k < d->amplifiers; k++) {
        const double voltage = v->volt[k];
        const int at = voltage == v->limit[0] || voltage == v->limit[1] || voltage == d->lower[k] ||
                       voltage == d->upper[k];
        const int beyond = voltage < d->lower[k] || voltage > d->upper[k];
        r->outline[k] = v->active > 0 && at ? OUTLINE_LIMIT
                        : beyond            ? OUTLINE_BEYOND
                                            : OUTLINE_NONE;
        r->beyond += beyond;
        r->volt = fmax(r->volt, fabs(voltage));
    }
}

static int result_fill(const analysis *a, const voltages *voltages, result *r)
{
    r->volts = voltages;
    if (result_room(r, &a->design) < 0)
        return -1;
    report_displacement(&a->design.mesh, voltages->u, r->vector);
    result_misfit(&a->design, r);
    result_outline(&a->design, r);
    return 0;
}

/* ---- scales shared by all sets ---------------------------------------- */

static double largest_vector(const mesh *m, const double *vector)
{
    double most = 0;
    for (int n = 0; n < m->nodes; n++)
        most = fmax(most, draw_dot3(vector + 3 * n, vector + 3 * n));
    return sqrt(most);
}

static void page_scales(page *p)
{
    const mesh *m = &p->d->mesh;
    double most = 0;
    p->misfit.is_signed = p->volt.is_signed = 1;
    p->misfit.unit = p->d->scene->unit_length;
    p->volt.unit = p->d->scene->unit_voltage;
    for (int t = 0; t < p->d->targets; t++)
        p->target = fmax(p->target, fabs(p->d->target[t]));
    for (int k = 0; k < p->results; k++) {
        p->misfit.most = fmax(p->misfit.most, p->result[k].worst);
        p->volt.most = fmax(p->volt.most, p->result[k].volt);
        most = fmax(most, largest_vector(m, p->result[k].vector));
    }
    p->factor = p->a->nonlinear ? 1 : parts_magnification(m, fmax(most, p->target), 0.2);
    draw_view_begin(&p->view, m);
    for (int k = 0; k < p->results; k++) {
        parts_include(&p->view, m, p->result[k].vector, p->factor);
        parts_include(&p->view, m, p->result[k].wanted, p->factor);
    }
    draw_view_fit(&p->view, 420, 420);
}

/* ---- words ------------------------------------------------------------ */

static int is_limited(const voltages *v)
{
    return isfinite(v->limit[0]) || isfinite(v->limit[1]);
}

static void write_limits(const page *p, const voltages *v)
{
    if (!is_limited(v)) {
        fputs("&ndash;", p->file);
        return;
    }
    if (v->limit[0] == -v->limit[1]) {
        fputs("&plusmn;&nbsp;", p->file);
        html_quantity(p->file, v->limit[1], p->volt.unit);
        return;
    }
    html_number(p->file, v->limit[0]);
    fputs(" to ", p->file);
    html_quantity(p->file, v->limit[1], p->volt.unit);
}

static void write_name(const page *p, const voltages *v)
{
    html_text(p->file, v->name);
    if (is_limited(v)) {
        fputs(", ", p->file);
        write_limits(p, v);
    }
}

/* The first set within limits, as asked for, and what the best without limits would leave. */
static void write_verdict(const page *p)
{
    const voltages *asked = NULL, *unlimited = NULL;
    for (int k = 0; k < p->results; k++) {
        const voltages *v = p->result[k].volts;
        if (is_limited(v) && !asked)
            asked = v;
        if (!is_limited(v) && (!unlimited || v->error < unlimited->error))
            unlimited = v;
    }
    const voltages *best = asked ? asked : unlimited;
    if (!best)
        return;
    fputs("<p class=\"verdict\"><b>Shape error ", p->file);
    html_percent(p->file, best->error);
    fputs(" of the target</b>: ", p->file);
    write_name(p, best);
    fprintf(p->file, ", %d of %d amplifiers at a limit.", best->active, p->d->amplifiers);
    if (asked && unlimited) {
        fputs(" Without limits ", p->file);
        html_percent(p->file, unlimited->error);
        fputs(" would remain.", p->file);
    }
    fputs("</p>\n", p->file);
}

static void write_row(const page *p, const result *r, double worst_error)
{
    FILE *file = p->file;
    fputs("<tr><th scope=\"row\">", file);
    html_text(file, r->volts->name);
    fputs("</th><td>", file);
    write_limits(p, r->volts);
    fputs("</td><td>", file);
    html_percent(file, r->volts->error);
    fprintf(
        file,
        "<span class=\"bar\" aria-hidden=\"true\"><i style=\"width:%.1f%%\"></i></span></td><td>",
        worst_error > 0 ? fmin(100 * r->volts->error / worst_error, 100) : 0);
    html_alike(file, r->worst, p->misfit.most, p->misfit.unit);
    fputs("</td><td>", file);
    if (is_limited(r->volts))
        fprintf(file, "%d of %d", r->volts->active, p->d->amplifiers);
    else
        fputs("&ndash;", file);
    fputs("</td><td>", file);
    html_alike(file, r->volt, p->volt.most, p->volt.unit);
    fprintf(file, "</td><td>%s%d%s</td><td>", r->beyond ? "<b>" : "", r->beyond,
            r->beyond ? "</b>" : "");
    html_rough(file, r->volts->optimality);
    fputs("</td></tr>\n", file);
}

static void write_table(const page *p)
{
    double worst = 0;
    for (int k = 0; k < p->results; k++)
        worst = fmax(worst, p->result[k].volts->error);
    html_table_begin(
        p->file,
        "Shape error: root of the weighted squares of the misfit over those of the target. KKT: largest violated "
        "optimality condition, relative.",
        "<th scope=\"col\">Volts</th><th scope=\"col\">Limits</th><th scope=\"col\">Shape error</th>"
        "<th scope=\"col\">Largest misfit</th><th scope=\"col\">At a limit</th><th scope=\"col\">Largest volt</th>"
        "<th scope=\"col\">Beyond the<br>scene&rsquo;s limits</th><th scope=\"col\">KKT</th>");
    for (int k = 0; k < p->results; k++)
        write_row(p, &p->result[k], worst);
    html_table_end(p->file);
}

/* ---- pictures of one set ---------------------------------------------- */

static int draw_reached(const page *p, const result *r)
{
    fputs("<figure>\n", p->file);
    const int failed = parts_shape(p->file, &p->view, p->d, r->vector, r->wanted, r->misfit,
                                   p->factor, &p->misfit);
    fputs("<figcaption>Reached shape and <b>target</b> as lines, ", p->file);
    parts_magnified(p->file, &p->d->mesh, p->factor);
    fputs(". Misfit on one scale for all sets:", p->file);
    draw_legend(p->file, &p->misfit);
    fputs("</figcaption></figure>\n", p->file);
    return failed;
}

static void draw_misfit(const page *p, const result *r)
{
    const draw_scale own = {1, r->worst, p->misfit.unit};
    fputs("<figure>\n", p->file);
    plane_map(p->file, &p->d->mesh, r->misfit, &own,
              "Misfit, reached minus target, over theta1 and theta2");
    fputs("<figcaption>Misfit, reached minus target: largest <b>", p->file);
    html_alike(p->file, r->worst, r->worst, own.unit);
    fputs("</b>", p->file);
    if (p->target > 0) {
        fputs(" (", p->file);
        html_percent(p->file, r->worst / p->target);
        fputs(" of the largest target)", p->file);
    }
    fputs(", rms ", p->file);
    html_alike(p->file, r->rms, r->worst, own.unit);
    fputs(p->d->targets < p->d->mesh.nodes ? "; grey where nothing is wanted" : "", p->file);
    fputs(". Scale of this set:", p->file);
    draw_legend(p->file, &own);
    fputs("</figcaption></figure>\n", p->file);
}

/* Names of the actuators of a plan. */
static void write_plan(const page *p, int which)
{
    const char *comma = "";
    for (int k = 0; k < p->d->scene->actuators; k++)
        if (p->plan[k] == which) {
            fputs(comma, p->file);
            html_text(p->file, p->d->scene->actuator[k].name);
            comma = ", ";
        }
}

static void draw_volts(const page *p, const result *r)
{
    const scene *s = p->d->scene;
    fputs("<figure>\n", p->file);
    for (int which = 0; which < p->plans; which++) {
        if (p->plans > 1) {
            fputs("<h3>", p->file);
            write_plan(p, which);
            fputs("</h3>\n", p->file);
        }
        plane_volts(p->file, &p->d->mesh, p->plan, which, r->volts->volt, r->outline, &p->volt,
                    "Volts of the amplifiers, written in their patches where there is room");
    }
    fputs("<figcaption>Volts in their patches: largest <b>", p->file);
    html_quantity(p->file, r->volt, p->volt.unit);
    fputs("</b>", p->file);
    for (int k = 0; k < s->actuators; k++)
        if (p->plan[k] < 0) {
            fputs(", ", p->file);
            html_text(p->file, s->actuator[k].name);
            fputc(' ', p->file);
            html_quantity(p->file, r->volts->volt[s->actuator[k].first], s->unit_temperature);
        }
    fputs(". One scale for all sets:", p->file);
    draw_legend(p->file, &p->volt);
    fputs("</figcaption></figure>\n", p->file);
}

static int draw_set(const page *p, const result *r)
{
    fputs("<article class=\"set\">\n<h3>", p->file);
    write_name(p, r->volts);
    fputs(" &mdash; shape error ", p->file);
    html_percent(p->file, r->volts->error);
    fputs("</h3>\n<div class=\"row\">\n", p->file);
    const int failed = draw_reached(p, r);
    draw_misfit(p, r);
    draw_volts(p, r);
    fputs("</div>\n</article>\n", p->file);
    return failed;
}

/* ---- page ------------------------------------------------------------- */

static int page_fill(page *p, const voltages *voltages)
{
    p->plan = calloc((size_t)p->d->scene->actuators + 1, sizeof *p->plan);
    p->result = calloc((size_t)p->results + 1, sizeof *p->result);
    if (!p->plan || !p->result)
        return -1;
    p->plans = plane_plans(p->d->scene, p->plan);
    for (int k = 0; k < p->results; k++) {
        if (result_fill(p->a, &voltages[k], &p->result[k]) < 0)
            return -1;
        p->residual = k ? fmax(p->residual, voltages[k].residual) : voltages[k].residual;
    }
    page_scales(p);
    return 0;
}

static int page_write(const page *p)
{
    int failed = 0;
    html_begin(p->file, p->d->scene->name);
    parts_head(p->file, p->a, "Volts for a wanted shape", p->residual,
               p->a->nonlinear ? -1 : p->a->model.info.error_estimate);
    write_verdict(p);
    fputs("<section>\n<h2>Sets of volts</h2>\n", p->file);
    write_table(p);
    fputs("</section>\n<section>\n<h2>Shapes</h2>\n", p->file);
    parts_keys(p->file, "<span><i class=\"key stop\"></i> amplifier at its limit</span>"
                        "<span><i class=\"key over\"></i> beyond the scene&rsquo;s limits</span>");
    for (int k = 0; k < p->results; k++)
        failed |= draw_set(p, &p->result[k]);
    fputs("</section>\n", p->file);
    modes_section(p->file, p->d->scene, p->modes);
    fputs("<section>\n<h2>Structure</h2>\n<div class=\"row two\">\n", p->file);
    parts_layers(p->file, p->d->scene);
    parts_conditions(p->file, p->d);
    fputs("</div>\n</section>\n", p->file);
    html_end(p->file);
    return failed;
}

int report_shape(FILE *file, analysis *a, const voltages *voltages, int count, const modes *modes)
{
    page p = {.file = file, .a = a, .d = &a->design, .results = count, .modes = modes};
    int failed = page_fill(&p, voltages);
    if (!failed)
        failed = page_write(&p);
    for (int k = 0; p.result && k < count; k++)
        result_free(&p.result[k]);
    free(p.result);
    free(p.plan);
    return failed || ferror(file) ? -1 : 0;
}
