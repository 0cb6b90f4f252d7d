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

static void result_free(result *result)
{
    free(result->vector);
    free(result->wanted);
    free(result->misfit);
    free(result->outline);
}

static int result_room(result *result, const design *design)
{
    const size_t nodes = (size_t)design->mesh.nodes;
    result->vector = calloc(3 * nodes, sizeof *result->vector);
    result->wanted = calloc(3 * nodes, sizeof *result->wanted);
    result->misfit = calloc(nodes, sizeof *result->misfit);
    result->outline = calloc((size_t)design->amplifiers + 1, sizeof *result->outline);
    return result->vector && result->wanted && result->misfit && result->outline ? 0 : -1;
}

static void result_misfit(const design *design, result *result)
{
    parts_misfit(design, result->volts->shape, result->volts->aligned_target, result->vector,
                 result->misfit, result->wanted);
    for (int t = 0; t < design->targets; t++) {
        const double miss = result->misfit[design->target_node[t]];
        result->worst = fmax(result->worst, fabs(miss));
        result->rms += miss * miss / design->targets;
    }
    result->rms = sqrt(result->rms);
}

/* At one of the limits this set obeyed, or beyond those of the scene. */
static void result_outline(const design *design, result *r)
{
    const voltages *v = r->volts;
    for (int k = 0; k < design->amplifiers; k++) {
        const double voltage = v->voltage[k];
        const int at = voltage == v->limit[0] || voltage == v->limit[1] ||
                       voltage == design->lower[k] || voltage == design->upper[k];
        const int beyond = voltage < design->lower[k] || voltage > design->upper[k];
        r->outline[k] = v->active_limits > 0 && at ? OUTLINE_LIMIT
                        : beyond                   ? OUTLINE_BEYOND
                                                   : OUTLINE_NONE;
        r->beyond += beyond;
        r->volt = fmax(r->volt, fabs(voltage));
    }
}

static int result_fill(const analysis *analysis, const voltages *voltages, result *result)
{
    result->volts = voltages;
    if (result_room(result, &analysis->design) < 0)
        return -1;
    report_displacement(&analysis->design.mesh, voltages->u, result->vector);
    result_misfit(&analysis->design, result);
    result_outline(&analysis->design, result);
    return 0;
}

/* ---- scales shared by all sets ---------------------------------------- */

static double largest_vector(const mesh *mesh, const double *vector)
{
    double most = 0;
    for (int n = 0; n < mesh->nodes; n++)
        most = fmax(most, draw_dot3(vector + 3 * n, vector + 3 * n));
    return sqrt(most);
}

static void page_scales(page *page)
{
    const mesh *mesh = &page->d->mesh;
    double most = 0;
    page->misfit.is_signed = page->volt.is_signed = 1;
    page->misfit.unit = page->d->scene->unit_length;
    page->volt.unit = page->d->scene->unit_voltage;
    for (int t = 0; t < page->d->targets; t++)
        page->target = fmax(page->target, fabs(page->d->target[t]));
    for (int k = 0; k < page->results; k++) {
        page->misfit.most = fmax(page->misfit.most, page->result[k].worst);
        page->volt.most = fmax(page->volt.most, page->result[k].volt);
        most = fmax(most, largest_vector(mesh, page->result[k].vector));
    }
    page->factor =
        page->a->nonlinear ? 1 : parts_magnification(mesh, fmax(most, page->target), 0.2);
    draw_view_begin(&page->view, mesh);
    for (int k = 0; k < page->results; k++) {
        parts_include(&page->view, mesh, page->result[k].vector, page->factor);
        parts_include(&page->view, mesh, page->result[k].wanted, page->factor);
    }
    draw_view_fit(&page->view, 420, 420);
}

/* ---- words ------------------------------------------------------------ */

static int is_limited(const voltages *result)
{
    return isfinite(result->limit[0]) || isfinite(result->limit[1]);
}

static void write_limits(const page *page, const voltages *result)
{
    if (!is_limited(result)) {
        fputs("&ndash;", page->file);
        return;
    }
    if (result->limit[0] == -result->limit[1]) {
        fputs("&plusmn;&nbsp;", page->file);
        html_quantity(page->file, result->limit[1], page->volt.unit);
        return;
    }
    html_number(page->file, result->limit[0]);
    fputs(" to ", page->file);
    html_quantity(page->file, result->limit[1], page->volt.unit);
}

static void write_name(const page *page, const voltages *result)
{
    html_text(page->file, result->name);
    if (is_limited(result)) {
        fputs(", ", page->file);
        write_limits(page, result);
    }
}

/* The first set within limits, as asked for, and what the best without limits would leave. */
static void write_verdict(const page *page)
{
    const voltages *asked = NULL, *unlimited = NULL;
    for (int k = 0; k < page->results; k++) {
        const voltages *result = page->result[k].volts;
        if (is_limited(result) && !asked)
            asked = result;
        if (!is_limited(result) && (!unlimited || result->error < unlimited->error))
            unlimited = result;
    }
    const voltages *best = asked ? asked : unlimited;
    if (!best)
        return;
    fputs("<p class=\"verdict\"><b>Shape error ", page->file);
    html_percent(page->file, best->error);
    fputs(" of the target</b>: ", page->file);
    write_name(page, best);
    fprintf(page->file, ", %d of %d amplifiers at a limit.", best->active_limits,
            page->d->amplifiers);
    if (asked && unlimited) {
        fputs(" Without limits ", page->file);
        html_percent(page->file, unlimited->error);
        fputs(" would remain.", page->file);
    }
    fputs("</p>\n", page->file);
}

static void write_row(const page *page, const result *result, double worst_error)
{
    FILE *file = page->file;
    fputs("<tr><th scope=\"row\">", file);
    html_text(file, result->volts->name);
    fputs("</th><td>", file);
    write_limits(page, result->volts);
    fputs("</td><td>", file);
    html_percent(file, result->volts->error);
    fprintf(
        file,
        "<span class=\"bar\" aria-hidden=\"true\"><i style=\"width:%.1f%%\"></i></span></td><td>",
        worst_error > 0 ? fmin(100 * result->volts->error / worst_error, 100) : 0);
    html_alike(file, result->worst, page->misfit.most, page->misfit.unit);
    fputs("</td><td>", file);
    if (is_limited(result->volts))
        fprintf(file, "%d of %d", result->volts->active_limits, page->d->amplifiers);
    else
        fputs("&ndash;", file);
    fputs("</td><td>", file);
    html_alike(file, result->volt, page->volt.most, page->volt.unit);
    fprintf(file, "</td><td>%s%d%s</td><td>", result->beyond ? "<b>" : "", result->beyond,
            result->beyond ? "</b>" : "");
    html_rough(file, result->volts->optimality);
    fputs("</td></tr>\n", file);
}

static void write_table(const page *page)
{
    double worst = 0;
    for (int k = 0; k < page->results; k++)
        worst = fmax(worst, page->result[k].volts->error);
    html_table_begin(
        page->file,
        "Shape error: root of the weighted squares of the misfit over those of the target. KKT: largest violated "
        "optimality condition, relative.",
        "<th scope=\"col\">Volts</th><th scope=\"col\">Limits</th><th scope=\"col\">Shape error</th>"
        "<th scope=\"col\">Largest misfit</th><th scope=\"col\">At a limit</th><th scope=\"col\">Largest volt</th>"
        "<th scope=\"col\">Beyond the<br>scene&rsquo;s limits</th><th scope=\"col\">KKT</th>");
    for (int k = 0; k < page->results; k++)
        write_row(page, &page->result[k], worst);
    html_table_end(page->file);
}

/* ---- pictures of one set ---------------------------------------------- */

static int draw_reached(const page *page, const result *result)
{
    fputs("<figure>\n", page->file);
    const int failed = parts_shape(page->file, &page->view, page->d, result->vector, result->wanted,
                                   result->misfit, page->factor, &page->misfit);
    fputs("<figcaption>Reached shape and <b>target</b> as lines, ", page->file);
    parts_magnified(page->file, &page->d->mesh, page->factor);
    fputs(". Misfit on one scale for all sets:", page->file);
    draw_legend(page->file, &page->misfit);
    fputs("</figcaption></figure>\n", page->file);
    return failed;
}

static void draw_misfit(const page *page, const result *result)
{
    const draw_scale own = {1, result->worst, page->misfit.unit};
    fputs("<figure>\n", page->file);
    plane_map(page->file, &page->d->mesh, result->misfit, &own,
              "Misfit, reached minus target, over theta1 and theta2");
    fputs("<figcaption>Misfit, reached minus target: largest <b>", page->file);
    html_alike(page->file, result->worst, result->worst, own.unit);
    fputs("</b>", page->file);
    if (page->target > 0) {
        fputs(" (", page->file);
        html_percent(page->file, result->worst / page->target);
        fputs(" of the largest target)", page->file);
    }
    fputs(", rms ", page->file);
    html_alike(page->file, result->rms, result->worst, own.unit);
    fputs(page->d->targets < page->d->mesh.nodes ? "; grey where nothing is wanted" : "",
          page->file);
    fputs(". Scale of this set:", page->file);
    draw_legend(page->file, &own);
    fputs("</figcaption></figure>\n", page->file);
}

/* Names of the actuators of a plan. */
static void write_plan(const page *page, int which)
{
    const char *comma = "";
    for (int k = 0; k < page->d->scene->actuators; k++)
        if (page->plan[k] == which) {
            fputs(comma, page->file);
            html_text(page->file, page->d->scene->actuator[k].name);
            comma = ", ";
        }
}

static void draw_volts(const page *page, const result *result)
{
    const scene *scene = page->d->scene;
    fputs("<figure>\n", page->file);
    for (int which = 0; which < page->plans; which++) {
        if (page->plans > 1) {
            fputs("<h3>", page->file);
            write_plan(page, which);
            fputs("</h3>\n", page->file);
        }
        plane_volts(page->file, &page->d->mesh, page->plan, which, result->volts->voltage,
                    result->outline, &page->volt,
                    "Volts of the amplifiers, written in their patches where there is room");
    }
    fputs("<figcaption>Volts in their patches: largest <b>", page->file);
    html_quantity(page->file, result->volt, page->volt.unit);
    fputs("</b>", page->file);
    for (int k = 0; k < scene->actuators; k++)
        if (page->plan[k] < 0) {
            fputs(", ", page->file);
            html_text(page->file, scene->actuator[k].name);
            fputc(' ', page->file);
            html_quantity(page->file, result->volts->voltage[scene->actuator[k].first],
                          scene->unit_temperature);
        }
    fputs(". One scale for all sets:", page->file);
    draw_legend(page->file, &page->volt);
    fputs("</figcaption></figure>\n", page->file);
}

static int draw_set(const page *page, const result *result)
{
    fputs("<article class=\"set\">\n<h3>", page->file);
    write_name(page, result->volts);
    fputs(" &mdash; shape error ", page->file);
    html_percent(page->file, result->volts->error);
    fputs("</h3>\n<div class=\"row\">\n", page->file);
    const int failed = draw_reached(page, result);
    draw_misfit(page, result);
    draw_volts(page, result);
    fputs("</div>\n</article>\n", page->file);
    return failed;
}

/* ---- page ------------------------------------------------------------- */

static int page_fill(page *page, const voltages *voltages)
{
    page->plan = calloc((size_t)page->d->scene->actuators + 1, sizeof *page->plan);
    page->result = calloc((size_t)page->results + 1, sizeof *page->result);
    if (!page->plan || !page->result)
        return -1;
    page->plans = plane_plans(page->d->scene, page->plan);
    for (int k = 0; k < page->results; k++) {
        if (result_fill(page->a, &voltages[k], &page->result[k]) < 0)
            return -1;
        page->residual = k ? fmax(page->residual, voltages[k].residual) : voltages[k].residual;
    }
    page_scales(page);
    return 0;
}

static int page_write(const page *page)
{
    int failed = 0;
    html_begin(page->file, page->d->scene->name);
    parts_head(page->file, page->a, "Volts for a wanted shape", page->residual,
               page->a->nonlinear ? -1 : page->a->model.info.error_estimate);
    write_verdict(page);
    fputs("<section>\n<h2>Sets of volts</h2>\n", page->file);
    write_table(page);
    fputs("</section>\n<section>\n<h2>Shapes</h2>\n", page->file);
    parts_keys(page->file,
               "<span><i class=\"key stop\"></i> amplifier at its limit</span>"
               "<span><i class=\"key over\"></i> beyond the scene&rsquo;s limits</span>");
    for (int k = 0; k < page->results; k++)
        failed |= draw_set(page, &page->result[k]);
    fputs("</section>\n", page->file);
    modes_section(page->file, page->d->scene, page->modes);
    fputs("<section>\n<h2>Structure</h2>\n<div class=\"row two\">\n", page->file);
    parts_layers(page->file, page->d->scene);
    parts_conditions(page->file, page->d);
    fputs("</div>\n</section>\n", page->file);
    html_end(page->file);
    return failed;
}

int report_shape(FILE *file, analysis *analysis, const voltages *voltages, int count,
                 const modes *modes)
{
    page page = {
        .file = file, .a = analysis, .d = &analysis->design, .results = count, .modes = modes};
    int failed = page_fill(&page, voltages);
    if (!failed)
        failed = page_write(&page);
    for (int k = 0; page.result && k < count; k++)
        result_free(&page.result[k]);
    free(page.result);
    free(page.plan);
    return failed || ferror(file) ? -1 : 0;
}
