/* SPDX-License-Identifier: BSD-2-Clause */
/* Parts that several report pages have in common: frame, figures, tables, reached shapes. */
#ifndef REPORT_PAGE_H
#define REPORT_PAGE_H

#include "../text/words.h"
#include "report.h"
#include "report_shell.h"

/*
 * A report page in HTML, or its main picture in an SVG file. The members vector, wanted, value
 * and largest belong to the shape that is drawn at present. Lengths are in the length unit of the
 * scene.
 */
typedef struct page {
    const report_job *job;
    FILE *file;
    const analysis *analysis;
    const mesh *mesh;
    const design *design;
    shell space, map;
    design_inputs inputs;      /* name and unit of the quantity that the amplifiers supply, such as
                                  voltage in V */
    char pressure[WORDS_UNIT]; /* unit of pressures and stresses; empty if the scene names none */
    draw_scale scale; /* colour scale of the surface, which all pictures in space have in common */
    double *vector;   /* [nodes][3] displacements of the nodes in the drawn shape */
    double *wanted; /* [nodes][3] displacements of the nodes in which the component that the target
                       prescribes has its target value; NAN at nodes outside the target */
    double *value;  /* [nodes] values shown in colours; for a reached shape its misfit,
                       reached minus target value, NAN outside the target */
    double *row;    /* [targets] misfit of each target row; work memory for `value` */
    double *curve;  /* [2][values of all outputs] points of curves over outputs */
    draw_series *series; /* [outputs] curves over outputs */
    bool has_failed;     /* whether memory has run out while the page was written */
    double largest; /* largest displacement of any node in the drawn shape, without magnification */
} page;

/*
 * page_open prepares a report page, and page_close writes and releases it. page_open returns 0, or
 * -1 if memory runs out. page_close is called in both cases, and returns -1 if the page has failed
 * or cannot be written, else 0.
 */
int page_open(page *page, const report_job *job, const analysis *analysis);
int page_close(page *page, bool has_failed);

/*
 * page_begin begins an HTML page with name and purpose of the scene, numerical checks and warnings;
 * page_end ends the page with the layers and materials of the shell, the text of the scene file and
 * the command line.
 *   residual  in  largest relative residual of the solves shown on this page
 */
void page_begin(const page *page, const char *kind, double residual);
void page_end(const page *page);

/*
 * page_begin_picture begins an SVG file that contains only the main picture of a report, with a
 * title and the size of the drawing in pixels; page_end_picture ends the file.
 */
void page_begin_picture(const page *page, const char *title, double width, double height);
void page_end_picture(const page *page, double width, double height);

/*
 * Write a figure with a map of values [nodes] in colours. Its caption has the title, the largest
 * value and the markup `note`.
 */
void page_map(const page *page, const double *value, const draw_scale *scale, const char *title,
              const char *note);

/* Write the legend of a figure, and end the figure, whose caption has been begun. */
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
 *   page_stress     section of the stresses; nothing where `field` is NULL
 *   page_path       section of the load path, with the load factor over each output of one value;
 *       nothing where no path was followed
 *   page_voltages   table of the voltages: a row for each amplifier, a column for each result
 *   page_modes      for a target that is a list of modes (named target shapes), a section for each
 *       pair of limits, with the error that each mode alone leaves
 */
void page_structure(const page *page);
void page_stress(const page *page, const stress_field *field);
void page_path(const page *page);
void page_voltages(const page *page, const voltages *result, int results);
void page_modes(const page *page, const modes *modes);

/*
 * Choose what a report page draws from now on.
 *   page_displace  displacement vector u [dof], coloured by the length of the displacement
 *   page_shape     shape of a result, coloured by its misfit, reached minus target [targets];
 *       returns the colour scale
 *   page_include   includes the shape in the view in space and, if has_target is true, the target
 */
void page_displace(page *page, const double *u);
draw_scale page_shape(page *page, const voltages *result, const double *target);
void page_include(page *page, bool has_target);

/* The lines and marks that a picture explains: style class of the mark, words. */
#define PAGE_KEY(mark, words) "<span><i class=\"key " mark "\"></i>" words "</span>"

/*
 * Draw the reached shape in space, coloured by its misfit (reached minus target value), and the
 * mesh lines of the target over it; for a measured influence matrix, which has no mesh, discs at
 * the outputs. page_keys writes the legend of the lines, followed by the markup `more`.
 */
void page_draw_shape(const page *page, const draw_scale *scale);
void page_keys(const page *page, const char *more);

#endif
