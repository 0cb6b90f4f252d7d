/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * What the commands of pzs share: error messages, scenes, discretisation errors, reports and VTU
 * files.
 */
#ifndef COMMAND_PARTS_H
#define COMMAND_PARTS_H

#include "../model/mesh_measure.h"
#include "../report/report.h"
#include "../vtk/vtk.h"
#include "options.h"

/* Print an error message. Returns the exit code `code`. */
int complain(const char *error, int code);

/*
 * Find the file of a scene that is given as a path or as the name of a shipped scene. Returns an
 * exit code.
 */
int find_scene(const options *options, char path[OPTIONS_PATH]);

/* Read the scene that the options name. Returns an exit code. */
int open_scene(const options *options, scene *scene);

/*
 * Exit code of a failed analysis: the nonlinear load steps ended early, or the scene contains an
 * error.
 */
int failed_code(const analysis *analysis);

/*
 * Estimate the discretisation error of results where the options ask for it. Returns 0, or an exit
 * code after printing an error message.
 */
int estimate_error(const options *options, const scene *scene, const mesh_values *values,
                   mesh_measure *measure, const void *context, mesh_error *result);

/*
 * Function that writes one report (an HTML page or an SVG picture) of the results of a command.
 * Returns 0, or -1.
 */
typedef int write_report(const report_job *job, const void *result);

/* Write the HTML page and the SVG picture that the options request. Returns an exit code. */
int write_reports(const options *options, write_report *write, const void *result);

/* Write a VTU file of a solution. Returns an exit code. */
int write_vtu(const vtk_solution *solution, const char *path);

#endif
