/* Page of `pzs solve`, and the VTU file (report.h); the page of `pzs shape` is report_shape.c. */
#include "report.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "report_body.h"
#include "report_html.h"
#include "report_lines.h"
#include "report_parts.h"
#include "report_plane.h"
#include "report_space.h"
#include "../text/words.h"

void report_displacement(const mesh *mesh, const double *u, double *vector)
{
    for (int n = 0; n < mesh->nodes; n++)
        for (int i = 0; i < 3; i++) {
            double weight[7], sum = 0;
            design_output_weights(mesh, n, (scene_component)((int)COMPONENT_X + i), FACE_MIDDLE,
                                  weight);
            for (unsigned k = 0; k < mesh->dof_per_node; k++) {
                const uint16_t dof = mesh->node_dof[(size_t)n * mesh->dof_per_node + k];
                sum += dof == PZS_CONSTRAINED ? 0 : weight[k] * u[dof];
            }
            vector[3 * n + i] = sum;
        }
}

/* ---- outputs ---------------------------------------------------------- */

typedef struct spread {
    double low, high, mean;
    int count;
} spread;

/* Values of a named output: one of a point, many of an edge or of all nodes. */
static spread spread_of(const analysis *analysis, const double *output, int k)
{
    spread s = {0, 0, 0, analysis_outputs(analysis, k)};
    for (int i = 0; i < s.count; i++) {
        const double value = analysis_output(analysis, k, i, output);
        s.low = i ? fmin(s.low, value) : value;
        s.high = i ? fmax(s.high, value) : value;
        s.mean += value / s.count;
    }
    return s;
}

static void write_output(FILE *file, const analysis *analysis, const double *output, int k)
{
    const scene_output *named = &analysis->design.scene->output[k];
    const spread s = spread_of(analysis, output, k);
    const double most = fmax(fmax(fabs(s.low), fabs(s.high)),
                             isfinite(named->reference) ? fabs(named->reference) : 0);
    char unit[WORDS_UNIT];
    words_unit(analysis->design.scene, words_of_output(named), unit);
    fputs("<tr><th scope=\"row\">", file);
    html_text(file, named->name);
    fputs("</th><td>", file);
    if (s.count == 1) {
        html_alike(file, s.mean, most, unit);
    } else {
        html_alike(file, s.low, most, "");
        fputs(" to ", file);
        html_alike(file, s.high, most, unit);
        fprintf(file, "<br><span class=\"soft\">%d values, mean ", s.count);
        html_alike(file, s.mean, most, "");
        fputs("</span>", file);
    }
    fputs("</td><td>", file);
    html_alike(file, named->reference, most, isnan(named->reference) ? "" : unit);
    fputs("</td><td>", file);
    const double ratio = analysis_output(analysis, k, 0, output) / named->reference;
    if (isfinite(ratio))
        fprintf(file, "%.4f", ratio);
    else
        fputs("&ndash;", file);
    fputs("</td></tr>\n", file);
}

static void write_outputs(FILE *file, const analysis *analysis, const double *output)
{
    const design *design = &analysis->design;
    if (design->scene->outputs == 0)
        return;
    html_table_begin(
        file, "Outputs; the ratio is value over reference, of the first node where there are more",
        "<th scope=\"col\">Output</th><th scope=\"col\">Value</th><th scope=\"col\">Reference</th><th scope=\"col\">Ratio</th>");
    for (int k = 0; k < design->scene->outputs; k++)
        write_output(file, analysis, output, k);
    html_table_end(file);
}

static void write_place(FILE *file, const analysis *analysis, int k, int i, double value)
{
    const mesh *mesh = &analysis->design.mesh;
    const int node = analysis_output_node(analysis, k, i);
    char name[SCENE_LABEL];
    fputs("<tr><th scope=\"row\">", file);
    if (node >= 0) {
        const double row[5] = {mesh->theta[node][0], mesh->theta[node][1], mesh->point[node].x[0],
                               mesh->point[node].x[1], mesh->point[node].x[2]};
        for (int c = 0; c < 5; c++) {
            fputs(c ? "</td><td>" : "</th><td>", file);
            html_number(file, row[c]);
        }
    } else {
        analysis_output_electrode(analysis, k, i, name);
        html_text(file, name);
        fputs("</th>", file);
    }
    fputs(node >= 0 ? "</td><td>" : "<td>", file);
    html_number(file, value);
    fputs("</td></tr>\n", file);
}

/* A table for each output with several values. */
static void write_places(FILE *file, const analysis *analysis, const double *output)
{
    static const char nodes[] =
        "<th></th><th scope=\"col\">&theta;&#8321;</th><th scope=\"col\">&theta;&#8322;</th><th scope=\"col\">x</th>"
        "<th scope=\"col\">y</th><th scope=\"col\">z</th><th scope=\"col\">Value</th>";
    static const char electrodes[] = "<th scope=\"col\">Electrode</th><th scope=\"col\">Value</th>";
    for (int k = 0; k < analysis->design.scene->outputs; k++) {
        const int count = analysis_outputs(analysis, k);
        if (count == 1)
            continue;
        fputs("<details><summary>Values of ", file);
        html_text(file, analysis->design.scene->output[k].name);
        fprintf(file, ", %d</summary>\n", count);
        html_table_begin(file, NULL,
                         analysis_output_node(analysis, k, 0) >= 0 ? nodes : electrodes);
        for (int i = 0; i < count; i++)
            write_place(file, analysis, k, i, analysis_output(analysis, k, i, output));
        html_table_end(file);
        fputs("</details>\n", file);
    }
}

/* ---- drawings --------------------------------------------------------- */

/* Length of each vector. size [nodes] out. Returns the largest. */
static double sizes(const mesh *mesh, const double *vector, double *size)
{
    double most = 0;
    for (int n = 0; n < mesh->nodes; n++) {
        size[n] = sqrt(draw_dot3(vector + 3 * n, vector + 3 * n));
        if (size[n] > most)
            most = size[n];
    }
    return most;
}

/* Lines and marks of the drawing, explained. */
static void deformed_keys(FILE *file, const scene *scene, const body_net *body)
{
    fputs(
        "<p class=\"keys\"><span><i class=\"key gone\"></i>at rest</span><span><i class=\"key hold\"></i>support</span>",
        file);
    for (int k = 0, said = 0; k < scene->loads && !said; k++)
        if (scene->load[k].type == LOAD_POINT)
            said = fputs("<span><i class=\"key load\"></i>point load</span>", file) != EOF;
    if (body->given)
        fputs("<span><i class=\"key solid\"></i>rigid body, the part along the shell</span>", file);
    fputs("</p>", file);
}

/* Large displacements are drawn as they are, small ones magnified. */
static int draw_deformed(FILE *file, const analysis *analysis, const double *vector,
                         const double *size, double most)
{
    const mesh *mesh = &analysis->design.mesh;
    const double factor = analysis->nonlinear ? 1 : parts_magnification(mesh, most, 0.1);
    const draw_scale scale = {0, most, mesh->scene->unit_length};
    draw_view view;
    body_net body;
    body_find(&body, analysis, vector);
    draw_view_begin(&view, mesh);
    parts_include(&view, mesh, vector, factor);
    body_include(&body, &view);
    draw_view_fit(&view, 600, 560);
    const space rest = {file, &view, mesh, NULL, 0}, moved = {file, &view, mesh, vector, factor};
    fputs("<figure>\n", file);
    draw_begin(
        file, view.width, view.height,
        "Deformed shape in space, coloured by the size of the displacement, over the undeformed mesh");
    body_draw(file, &body, &view, 0);
    space_wires(&rest, "rest");
    const int failed = space_surface(&moved, size, &scale);
    space_wires(&rest, "rest ghost");
    body_draw(file, &body, &view, 1);
    space_loads(&moved);
    space_outputs(&moved);
    space_axes(&moved);
    draw_end(file);
    fputs("<figcaption>Size of the displacement, ", file);
    parts_magnified(file, mesh, factor);
    fputs("; largest ", file);
    html_quantity(file, most, scale.unit);
    draw_legend(file, &scale);
    deformed_keys(file, mesh->scene, &body);
    fputs("</figcaption></figure>\n", file);
    return failed;
}

/* Maps of the components along the surface's own triad. size [nodes] is used as room */
static void draw_components(FILE *file, const mesh *mesh, const double *vector, double *size)
{
    const double most = sizes(mesh, vector, size);
    static const char *const name[3] = {"u1, along theta1", "u2, along theta2", "u3, outwards"};
    static const char *const label[3] = {"u&#8321; along &theta;&#8321;",
                                         "u&#8322; along &theta;&#8322;", "u&#8323; outwards"};
    fputs(
        "<section>\n<h2>Displacement of the middle surface</h2>\n<p class=\"soft\">Each on a scale of its own.</p>\n<div class=\"row three\">\n",
        file);
    for (int a = 0; a < 3; a++) {
        draw_scale scale = {1, 0, mesh->scene->unit_length};
        for (int n = 0; n < mesh->nodes; n++) {
            size[n] = draw_dot3(mesh->point[n].e[a], vector + 3 * n);
            if (fabs(size[n]) > scale.most)
                scale.most = fabs(size[n]);
        }
        const int negligible = scale.most > 0 && scale.most < 1e-9 * most;
        if (negligible)
            scale.most = 0;
        fprintf(file, "<figure><h3>%s</h3>\n", label[a]);
        plane_map(file, mesh, size, &scale, name[a]);
        if (negligible)
            fputs("<p class=\"keys\">Below 10&#8315;&#8313; of the largest displacement.</p>",
                  file);
        else
            draw_legend(file, &scale);
        fputs("</figure>\n", file);
    }
    fputs("</div>\n</section>\n", file);
}

/* Map of the contact pressure, where there is a contact. */
static void draw_contact(FILE *file, const analysis *analysis)
{
    const mesh *mesh = &analysis->design.mesh;
    const pzs_contact *contact = &analysis->equilibrium.contact;
    char unit[WORDS_UNIT];
    draw_scale scale = {0, 0, words_unit(mesh->scene, QUANTITY_PRESSURE, unit)};
    if (!analysis->nonlinear || !mesh->scene->contact.given)
        return;
    for (int n = 0; n < mesh->nodes; n++)
        scale.most = fmax(scale.most, contact->info.pressure[n]);
    fputs("<section>\n<h2>Contact pressure</h2>\n<figure class=\"map\">\n", file);
    plane_map(file, mesh, contact->info.pressure, &scale,
              "contact pressure over theta1 and theta2");
    fprintf(file, "<figcaption>%d nodes in contact, largest pressure ", contact->info.nodes);
    html_quantity(file, scale.most, unit);
    fputs(", per area at rest", file);
    draw_legend(file, &scale);
    fputs("</figcaption></figure>\n</section>\n", file);
}

static int write_solve(FILE *file, const analysis *analysis, const double *output,
                       const double *vector, double *size)
{
    const design *design = &analysis->design;
    html_begin(file, design->scene->name);
    parts_head(file, analysis, "Displacement under loads and applied volts",
               analysis->nonlinear ? analysis->equilibrium.solver.info.residual
                                   : analysis->model.info.residual,
               analysis->model.info.error_estimate);
    fputs("<section>\n<h2>Result</h2>\n<div class=\"row two\">\n", file);
    const int failed =
        draw_deformed(file, analysis, vector, size, sizes(&design->mesh, vector, size));
    fputs("<div>\n", file);
    write_outputs(file, analysis, output);
    write_places(file, analysis, output);
    parts_conditions(file, design);
    parts_layers(file, design->scene);
    fputs("</div>\n</div>\n</section>\n", file);
    lines_section(file, analysis, output);
    draw_contact(file, analysis);
    draw_components(file, &design->mesh, vector, size);
    html_end(file);
    return failed;
}

int report_solve(FILE *file, const analysis *analysis, const double *u, const double *output)
{
    const mesh *mesh = &analysis->design.mesh;
    double *vector = calloc(3 * (size_t)mesh->nodes, sizeof *vector),
           *size = calloc((size_t)mesh->nodes, sizeof *size);
    int failed = -1;
    if (vector && size) {
        report_displacement(mesh, u, vector);
        failed = write_solve(file, analysis, output, vector, size);
    }
    free(vector);
    free(size);
    return failed || ferror(file) ? -1 : 0;
}

/* ---- ParaView --------------------------------------------------------- */

/* A name without what XML reads as its own. */
static void vtu_name(FILE *file, const char *name)
{
    for (; *name; name++)
        fputc((unsigned char)*name > ' ' && (unsigned char)*name < 127 && !strchr("<>&\"", *name)
                  ? *name
                  : '_',
              file);
}

/* x [count][3] in */
static void vtu_vectors(FILE *file, const char *name, const double *x, int count)
{
    fputs("<DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\" Name=\"", file);
    vtu_name(file, name);
    fputs("\">\n", file);
    for (int i = 0; i < 3 * count; i++)
        fprintf(file, "%.9g%c", isfinite(x[i]) ? x[i] : 0, i % 3 < 2 ? ' ' : '\n');
    fputs("</DataArray>\n", file);
}

static void vtu_cells(FILE *file, const mesh *mesh)
{
    fputs("<Cells>\n<DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">\n", file);
    for (int e = 0; e < mesh->elements; e++)
        fprintf(file, "%d %d %d %d\n", mesh->element[e][0], mesh->element[e][1],
                mesh->element[e][2], mesh->element[e][3]);
    fputs("</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">\n", file);
    for (int e = 0; e < mesh->elements; e++)
        fprintf(file, "%d\n", 4 * (e + 1));
    fputs("</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">\n", file);
    for (int e = 0; e < mesh->elements; e++)
        fputs("9\n", file); /* VTK_QUAD */
    fputs("</DataArray>\n</Cells>\n", file);
}

int report_vtu(FILE *file, const mesh *mesh, const report_field *field, int fields)
{
    double *place = calloc(3 * (size_t)mesh->nodes, sizeof *place);
    if (!place)
        return -1;
    for (int n = 0; n < mesh->nodes; n++)
        memcpy(place + 3 * n, mesh->point[n].x, 3 * sizeof *place);
    fprintf(
        file,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\">\n<UnstructuredGrid>\n"
        "<Piece NumberOfPoints=\"%d\" NumberOfCells=\"%d\">\n<Points>\n",
        mesh->nodes, mesh->elements);
    vtu_vectors(file, "place", place, mesh->nodes);
    fputs("</Points>\n", file);
    vtu_cells(file, mesh);
    fputs("<PointData>\n", file);
    for (int k = 0; k < fields; k++)
        vtu_vectors(file, field[k].name, field[k].u, mesh->nodes);
    fputs("</PointData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n", file);
    free(place);
    return ferror(file) ? -1 : 0;
}
