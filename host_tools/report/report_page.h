/* SPDX-License-Identifier: BSD-2-Clause */
/* Parts that several report pages have in common: frame, figures, tables, reached shapes. */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "../text/words.h"
#include "report.h"
#include "report_shell.h"

/* A report page or picture. vector, wanted, value, largest are those of the shape drawn now. */
typedef struct page {
    FILE *file;
    const report_job *job;
    const analysis *analysis;
    const design *design;
    const mesh *mesh;
    shell space, map;
    design_inputs inputs;      /* what the amplifiers supply, such as voltages in V */
    char pressure[WORDS_UNIT]; /* unit of pressures and stresses; empty if the scene names none */
    draw_scale scale; /* colour scale of the surface, which all pictures in space have in common;
                         of misfits (reached minus target value) that of all results */
    double *vector;   /* [nodes][3] displacements of the nodes in the drawn shape */
    double *wanted;   /* [nodes][3] displacements of the nodes whose component in the target has its
                         target value; NAN at nodes outside the target */
    double *value;    /* [nodes] values shown in colours; for a reached shape its misfit, reached
                         minus target value, NAN outside the target */
    double *row;   /* [targets] misfit (reached minus target value) of each target row; work memory
                      for `value` */
    double *curve; /* [2][values of all outputs] points of curves over outputs */
    draw_series *series; /* [outputs] curves over outputs */
    double largest;      /* largest displacement of any node in the drawn shape, not magnified */
    bool has_failed;     /* whether memory has run out while the page was written */

    /* of `pzs solve` */
    const double *u;            /* [dof] displacement vector */
    const double *output;       /* values of all outputs of the scene, output after output */
    const stress_field *stress; /* recovered stresses; NULL: the page shows no stresses */
    shell_body body;

    /* of `pzs shape` */
    const voltages *result; /* [results] voltages of each result. Result 1 is the optimum within the
                               voltage limits of the scene, or within the first limit that the
                               command names */
    int results;
    const modes *modes;
    draw_scale voltage; /* colour scale of the inputs of all amplifiers in all results */

    /* of `pzs modes` */
    const loaded_modes *vibrating;

    /* of `pzs simulate` */
    const simulation *simulation;
    const simulate_record *record;
} page;

/*
 * Write a report: an HTML page, which ends with the structure, the scene file and the command line,
 * or a picture. `page` has the members of the command; the function `prepare` chooses scales and
 * views before either is written. Returns 0, or -1 if memory runs out or the file cannot be
 * written.
 */
typedef void page_function(page *page);
int page_write(page *page, const report_job *job, const analysis *analysis, page_function *prepare,
               page_function *write_page, page_function *write_picture);

/*
 * page_begin begins an HTML page with name and purpose of the scene, numerical checks and warnings;
 * page_begin_picture begins an SVG file, with a title and the size of the drawing in pixels.
 *   residual  in  largest relative residual of the solves shown on this page
 */
void page_begin(const page *page, const char *kind, double residual);
void page_begin_picture(const page *page, const char *title, double width, double height);

/*
 * page_map writes a figure with a map of values [nodes] in colours, whose caption has the title,
 * the largest value and the markup `note`. page_legend writes the legend of a figure whose caption
 * has been begun, and ends the figure.
 */
void page_map(const page *page, const double *value, draw_scale scale, const char *title,
              const char *note);
void page_legend(const page *page, const draw_scale *scale);

/*
 * Begin a figure with a diagram whose linear axes contain all its curves and whose quantities have
 * the units x_unit and y_unit, below the markup `heading`; PAGE_CAPTION, a format of the function
 * put, ends the figure. Returns false, without heading and figure, if an axis has no extent.
 */
bool page_diagram(const page *page, draw_diagram *diagram, const char *heading, const char *title,
                  const char *x_unit, const char *y_unit);
#define PAGE_CAPTION(text) "<figcaption>" text "</figcaption></figure>\n"

/*
 * Parts of report pages:
 *   page_structure  tables of layers and materials, with the text of the scene file
 *   page_stress     section of the stresses; nothing without stresses
 *   page_path       section of the load path, with the load factor over each output of one value;
 *       nothing where no path was followed
 *   page_voltages   table of the voltages: a row for each amplifier, a column for each result
 *   page_modes      for a target that is a list of modes (named target shapes), a section for each
 *       pair of limits, with the error that each mode alone leaves
 */
void page_structure(const page *page);
void page_stress(const page *page);
void page_path(const page *page);
void page_voltages(const page *page, const voltages *result, int results);
void page_modes(const page *page);

/*
 * Choose what a report page draws from now on.
 *   page_displace  displacement vector u [dof], coloured by the length of the displacement
 *   page_shape     shape of a result, coloured by its misfit, reached minus target [targets];
 *       returns the colour scale
 *   page_rows      values page->row [targets] at the nodes of the target
 *   page_include   includes shape and target in the view in space
 */
void page_displace(page *page, const double *u);
draw_scale page_shape(page *page, const voltages *result, const double *target);
void page_rows(page *page);
void page_include(page *page);

/*
 * page_draw_shape draws the reached shape in space, coloured by its misfit (reached minus target
 * value), and the mesh lines of the target over it; for a measured influence matrix, which has no
 * mesh, discs at the outputs. page_keys explains the lines and marks, and those of the markup
 * `more`: a PAGE_KEY for each.
 */
void page_draw_shape(const page *page, const draw_scale *scale);
void page_keys(const page *page, const char *more);
#define PAGE_KEY(mark, words) "<span><i class=\"key " mark "\"></i>" words "</span>"

#endif
