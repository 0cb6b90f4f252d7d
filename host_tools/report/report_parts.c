/* Parts that the report pages share (report_parts.h). */
#include "report_parts.h"
#include <math.h>
#include "report_html.h"
#include "report_space.h"
#include "../text/words.h"

/* ---- head ------------------------------------------------------------- */

static void fact(FILE *file, const char *name)
{
    fprintf(file, "<div><dt>%s</dt><dd>", name);
}

static void fact_end(FILE *file)
{
    fputs("</dd></div>\n", file);
}

/* A check of the solution that is negative where it was not made. */
static void fact_check(FILE *file, const char *name, double value)
{
    fact(file, name);
    if (value < 0)
        fputs("not checked", file);
    else
        html_rough(file, value);
    fact_end(file);
}

/* How the shape was found, and whether it stays. */
static void path_facts(FILE *file, const pzs_solver *run)
{
    fact(file, "Load steps");
    fprintf(file, "%u, %u linear systems", run->info.load_steps, run->info.linear_solves);
    fact_end(file);
    fact(file, "Equilibrium");
    if (run->info.negative_pivots)
        fprintf(file, "<b class=\"warn\">unstable</b>, %u negative pivots",
                run->info.negative_pivots);
    else
        fputs("stable", file);
    fact_end(file);
    if (run->info.load_factor < 1) {
        fact(file, "Part of the load reached");
        fputs("<b class=\"warn\">", file);
        html_rough(file, run->info.load_factor);
        fputs("</b>", file);
        fact_end(file);
    }
}

static void facts(FILE *file, const analysis *analysis, double residual, double error)
{
    const mesh *mesh = &analysis->design.mesh;
    const scene *scene = analysis->design.scene;
    fputs("<dl>\n", file);
    fact(file, "Mesh");
    fprintf(file, "%d &times; %d elements of %d kind%s, %d nodes", scene->line[0].elements,
            scene->line[1].elements, mesh->types, mesh->types == 1 ? "" : "s", mesh->nodes);
    fact_end(file);
    fact(file, "Free unknowns");
    fprintf(file, "%d, half bandwidth %d", mesh->free_dof, mesh_half_bandwidth(mesh));
    fact_end(file);
    fact(file, "Element");
    fprintf(file, "%s kinematics, %s metric, %u unknowns a node",
            scene->element.cartesian ? "Cartesian" : "local",
            scene->element.metric ? "exact" : "flat", mesh->dof_per_node);
    fact_end(file);
    fact(file, "Thickness");
    html_quantity(file, mesh->laminate.thickness, scene->unit_length);
    fact_end(file);
    fact_check(file, "Condition after scaling", analysis->model.info.condition);
    fact_check(file, "Solver residual", residual);
    if (analysis->nonlinear)
        path_facts(file, &analysis->equilibrium.solver);
    else
        fact_check(file, "Solver error estimate, energy norm; without the discretisation error",
                   error);
    fact(file, "Scene");
    fprintf(file, "%08lx", (unsigned long)scene->hash);
    fact_end(file);
    fputs("</dl>\n", file);
}

void parts_head(FILE *file, const analysis *analysis, const char *kind, double residual,
                double error)
{
    const scene *scene = analysis->design.scene;
    fprintf(file, "<header>\n<p class=\"kicker\">%s</p>\n<h1>", kind);
    html_text(file, scene->name);
    fputs("</h1>\n<p>", file);
    html_text(file, scene->about ? scene->about : "");
    fputs("</p>\n", file);
    if (words_unitless(scene))
        fputs(
            "<p class=\"soft\">The scene names no units: its numbers are in any consistent ones, angles in rad.</p>\n",
            file);
    for (int k = 0; k < scene->sets; k++) {
        fputs(k ? ", <code>" : "<p class=\"soft\">Changed: <code>", file);
        html_text(file, scene->set[k]);
        fputs(k + 1 == scene->sets ? "</code></p>\n" : "</code>", file);
    }
    facts(file, analysis, residual, error);
    fputs("</header>\n", file);
}

/* ---- structure -------------------------------------------------------- */

static const char *const component_word[] = {"u1", "u2", "u3", "x", "y", "z"};
static const char *const face_word[] = {"middle", "inner face", "outer face", "mean of the faces"};

static void write_where(FILE *file, const scene *scene, const scene_where *where)
{
    char unit[WORDS_UNIT];
    static const char *const edge[] = {"", "edge &theta;&#8321;&minus;", "edge &theta;&#8321;+",
                                       "edge &theta;&#8322;&minus;", "edge &theta;&#8322;+"};
    if (where->type == WHERE_NODES)
        fputs("all nodes", file);
    else if (where->type == WHERE_EDGE)
        fputs(edge[where->edge], file);
    else if (where->type == WHERE_REGION)
        fputs("nodes of a rectangle", file);
    else {
        fputs("point &theta;&#8321; = ", file);
        html_quantity(file, where->theta[0], words_unit(scene, words_of_theta(scene, 0), unit));
        fputs(", &theta;&#8322; = ", file);
        html_quantity(file, where->theta[1], words_unit(scene, words_of_theta(scene, 1), unit));
    }
}

void parts_layers(FILE *file, const scene *scene)
{
    double most = 0;
    for (int k = 0; k < scene->layers; k++)
        most = fmax(most, scene->layer[k].thickness);
    html_table_begin(
        file, "Layers from the inner face to the outer face",
        "<th scope=\"col\">Layer</th><th scope=\"col\" class=\"word\">Material</th>"
        "<th scope=\"col\">Thickness</th><th scope=\"col\">Angle</th><th scope=\"col\" class=\"word\">Where</th>");
    for (int k = 0; k < scene->layers; k++) {
        const scene_layer *layer = &scene->layer[k];
        fprintf(file, "<tr><th scope=\"row\">%d ", k + 1);
        html_text(file, layer->name);
        fputs("</th><td class=\"word\">", file);
        html_text(file, scene->material[layer->material].name);
        fputs("</td><td>", file);
        html_alike(file, layer->thickness, most, scene->unit_length);
        fputs("</td><td>", file);
        html_number(file, layer->angle);
        fprintf(file, "&deg;</td><td class=\"word\">%s</td></tr>\n",
                layer->patched ? "in patches" : "everywhere");
    }
    html_table_end(file);
}

/* The unknowns a support holds: both u+ and u- of a component as one word. */
static void write_fix(FILE *file, const scene_support *support, unsigned dof_per_node)
{
    static const struct {
        unsigned bits;
        const char *word;
    } held[] = {{0x09, "u1"},
                {0x12, "u2"},
                {0x64, "u3"},
                {0x01, "u1 mean"},
                {0x02, "u2 mean"},
                {0x04, "u3 mean"},
                {0x08, "u1 difference"},
                {0x10, "u2 difference"},
                {0x20, "u3 difference"},
                {0x40, "u3M"}};
    const unsigned all = (1u << dof_per_node) - 1;
    unsigned left = support->fix & all;
    const char *comma = "";
    if (left == all) {
        fputs("clamped", file);
        return;
    }
    for (size_t k = 0; k < sizeof held / sizeof *held; k++)
        if ((held[k].bits & all) != 0 && (left & held[k].bits & all) == (held[k].bits & all)) {
            fprintf(file, "%s%s", comma, held[k].word);
            left &= ~held[k].bits;
            comma = ", ";
        }
    fputs(*comma ? " held" : "free", file);
}

/* The value of a load at its nodes: one number, or its range. */
static void write_value(FILE *file, const mesh *mesh, const scene_load *load)
{
    char unit[WORDS_UNIT];
    double low = 0, high = 0;
    int first = 1;
    for (int n = 0; n < mesh->nodes; n++) {
        const expr_point at = mesh_place(mesh, n);
        const scene_where *where = &load->where;
        if (load->type == LOAD_POINT && n != mesh_node(mesh, where->node[0], where->node[1]))
            continue;
        const double value = expr_value(load->value, &at);
        low = first ? value : fmin(low, value);
        high = first ? value : fmax(high, value);
        first = 0;
    }
    html_number(file, low);
    if (low != high) {
        fputs(" to ", file);
        html_number(file, high);
    }
    html_unit(file, words_unit(mesh->scene, words_of_load(load), unit));
}

static void write_load(FILE *file, const mesh *mesh, const scene_load *load)
{
    static const char *const type[] = {"point", "line", "face", "weight", "temperature"};
    static const char *const follows[] = {"", " at rest; turns with the surface",
                                          " as deformed; turns with the surface"};
    const int pressed = load->type == LOAD_FACE && load->follower != FOLLOWER_NONE;
    fprintf(file, "<tr><th scope=\"row\">Load: %s</th><td class=\"note\">", type[load->type]);
    write_value(file, mesh, load);
    if (load->type == LOAD_WEIGHT)
        fputs(" as gravity", file);
    if (pressed)
        fprintf(file, " along the normal, per area%s", follows[load->follower]);
    else if (load->type != LOAD_TEMPERATURE)
        fprintf(file, " along %s", component_word[load->component]);
    if (load->type == LOAD_POINT || load->type == LOAD_LINE) {
        fputs(", ", file);
        write_where(file, mesh->scene, &load->where);
    }
    if (load->type == LOAD_FACE || load->type == LOAD_POINT || load->type == LOAD_LINE)
        fprintf(file, ", %s", face_word[load->face]);
    fputs("</td></tr>\n", file);
}

static void write_vector(FILE *file, const double x[3], const char *unit)
{
    for (int i = 0; i < 3; i++) {
        fputs(i ? ", " : "(", file);
        html_number(file, x[i]);
    }
    fputc(')', file);
    html_unit(file, unit);
}

/* The rigid body that the shell may touch. */
static void write_contact(FILE *file, const scene *scene)
{
    static const char *const place[] = {"plane through ", "cylinder around ", "sphere around ",
                                        "body psi(x, y, z) &lt; 0"};
    const scene_body *body = &scene->contact.body;
    fprintf(file, "<tr><th scope=\"row\">Contact</th><td class=\"note\">%s on a rigid %s",
            face_word[scene->contact.face], place[body->type]);
    if (body->type != BODY_PSI)
        write_vector(file, body->point, scene->unit_length);
    if (body->type == BODY_PLANE || body->type == BODY_CYLINDER) {
        fputs(body->type == BODY_PLANE ? ", normal " : ", along ", file);
        write_vector(file, body->type == BODY_PLANE ? body->normal : body->axis, "");
    }
    if (body->type == BODY_CYLINDER || body->type == BODY_SPHERE) {
        fputs(", radius ", file);
        html_quantity(file, body->radius, scene->unit_length);
    }
    if (scene->contact.move[0] != 0 || scene->contact.move[1] != 0 || scene->contact.move[2] != 0) {
        fputs("; moved by ", file);
        write_vector(file, scene->contact.move, scene->unit_length);
    }
    fputs("</td></tr>\n", file);
}

static void write_actuator(FILE *file, const scene *scene, const scene_actuator *actuator)
{
    const int count = actuator->grid[0] * actuator->grid[1];
    fputs("<tr><th scope=\"row\">Actuator: ", file);
    html_text(file, actuator->name);
    fputs("</th><td class=\"note\">", file);
    if (actuator->is_temperature)
        fputs("temperature of the whole", file);
    else
        fprintf(file, "%d amplifier%s on ", count, count == 1 ? "" : "s");
    for (int k = 0; k < actuator->drives; k++) {
        fputs(k ? ", " : "patches ", file);
        html_text(file, scene->patches[actuator->drive[k].patches].name);
        fputs(" &times; ", file);
        html_number(file, actuator->drive[k].factor);
    }
    if (actuator->applied != 0) {
        fputs("; applied ", file);
        html_quantity(file, actuator->applied,
                      actuator->is_temperature ? scene->unit_temperature : scene->unit_voltage);
    }
    fputs("</td></tr>\n", file);
}

void parts_conditions(FILE *file, const design *design)
{
    const scene *scene = design->scene;
    html_table_begin(file, "Supports, loads and actuators", NULL);
    for (int k = 0; k < scene->supports; k++) {
        fputs("<tr><th scope=\"row\">Support</th><td class=\"note\">", file);
        write_where(file, scene, &scene->support[k].where);
        fputs(": ", file);
        write_fix(file, &scene->support[k], design->mesh.dof_per_node);
        fputs("</td></tr>\n", file);
    }
    for (int k = 0; k < scene->loads; k++)
        write_load(file, &design->mesh, &scene->load[k]);
    if (scene->contact.given)
        write_contact(file, scene);
    for (int k = 0; k < scene->actuators; k++)
        write_actuator(file, scene, &scene->actuator[k]);
    html_table_end(file);
}

/* ---- misfit ----------------------------------------------------------- */

void parts_misfit(const design *design, const double *shape, const double *target,
                  const double *vector, double *misfit, double *wanted)
{
    for (int n = 0; n < design->mesh.nodes; n++)
        misfit[n] = wanted[3 * n] = wanted[3 * n + 1] = wanted[3 * n + 2] = (double)NAN;
    for (int t = 0; t < design->targets; t++) {
        const int n = design->target_node[t];
        double along[3];
        draw_direction(&design->mesh.point[n], design->scene->target.what.component, along);
        misfit[n] = shape[t] - target[t];
        for (int i = 0; i < 3; i++)
            wanted[3 * n + i] = vector[3 * n + i] - misfit[n] * along[i];
    }
}

int parts_shape(FILE *file, const draw_view *view, const design *design, const double *vector,
                const double *wanted, const double *misfit, double factor, const draw_scale *scale)
{
    const mesh *mesh = &design->mesh;
    const space reached = {file, view, mesh, vector, factor},
                aimed = {file, view, mesh, wanted, factor}, rest = {file, view, mesh, NULL, 0};
    draw_begin(file, view->width, view->height,
               "Reached shape in space, coloured by its misfit, with the target as lines over it");
    space_outline(&rest);
    const int failed = space_surface(&reached, misfit, scale);
    space_wires(&aimed, "wire");
    if (design->scene->target.what.where.type == WHERE_POINT)
        space_dot(&aimed, design->target_node[0]);
    space_axes(&reached);
    draw_end(file);
    return failed;
}

void parts_keys(FILE *file, const char *more)
{
    fprintf(
        file,
        "<p class=\"keys\"><span><i class=\"key\"></i>target</span><span><i class=\"key dash\"></i>edges at rest</span>"
        "<span><i class=\"key hold\"></i>support</span>%s</p>\n",
        more);
}

/* ---- magnification ---------------------------------------------------- */

/* Largest side of the box around the structure. */
static double box_size(const mesh *mesh)
{
    double size = 0;
    for (int i = 0; i < 3; i++) {
        double low = mesh->point[0].x[i], high = low;
        for (int n = 1; n < mesh->nodes; n++) {
            low = fmin(low, mesh->point[n].x[i]);
            high = fmax(high, mesh->point[n].x[i]);
        }
        size = fmax(size, high - low);
    }
    return size;
}

double parts_magnification(const mesh *mesh, double most, double share)
{
    const double wanted = share * box_size(mesh) / most;
    if (!(most > 0) || !isfinite(wanted) || wanted <= 0)
        return 1;
    const double power = pow(10, floor(log10(wanted))), lead = wanted / power;
    return power * (lead < 1.42 ? 1 : lead < 3.17 ? 2 : lead < 7.08 ? 5 : 10);
}

void parts_include(draw_view *view, const mesh *mesh, const double *vector, double factor)
{
    double x[3];
    for (int n = 0; n < mesh->nodes; n++) {
        draw_place(mesh, n, NULL, 0, x);
        draw_view_include(view, x);
        draw_place(mesh, n, vector, factor, x);
        draw_view_include(view, x);
    }
}

void parts_magnified(FILE *file, const mesh *mesh, double factor)
{
    if (factor == 1) {
        fputs("displacement to scale", file);
    } else {
        fputs("displacement <b>&times;&nbsp;", file);
        html_number(file, factor);
        fputs("</b>", file);
    }
    if (space_is_thinned(mesh))
        fputs(", not every mesh line drawn", file);
}
