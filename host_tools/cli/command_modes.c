/* SPDX-License-Identifier: BSD-2-Clause */
/* The command `pzs modes`: natural frequencies and mode shapes of the structure alone
 * (command_modes.h). */
#include "command_modes.h"
#include <string.h>
#include "../model/loaded.h"
#include "../system/progress.h"
#include "command_parts.h"
#include "export.h"
#include "outfile.h"
#include "print_vibration.h"

/* Write a VTU file with one displacement field for each vibration mode. */
static int write_modes(const vibration *vibration, const design *design, const char *path)
{
    outfile output;
    if (outfile_begin(&output, path))
        return 1;
    return outfile_end(&output, vtk_write_modes(output.file, design, vibration));
}

static int write_vibration(const report_job *job, const void *result)
{
    return report_modes(job, result);
}

/* Estimate the discretisation error of the natural frequencies. Returns an exit code. */
static int modes_error(const options *options, const scene *scene, const vibration *vibration,
                       const modes_request *request, mesh_error *result)
{
    mesh_values values = {.count = 0};
    for (int i = 0; i < vibration->count; i++) {
        char name[SCENE_LABEL];
        mesh_mode_name(i, name);
        mesh_values_add(&values, name, vibration->frequency[i]);
    }
    return estimate_error(options, scene, &values, mesh_measure_modes, request, result);
}

/* Refuse circuits of electrodes for a measured influence matrix. Returns 0, or an exit code. */
static int check_circuit(const options *options, const scene *scene)
{
    if (options->circuit == CIRCUIT_SCENE || !scene->influence.given)
        return 0;
    return options_refuse("--electrodes needs a structure, but the scene has a measured influence "
                          "matrix:",
                          options->scene);
}

/*
 * Compute natural frequencies and mode shapes of a structure: about the reference state with linear
 * kinematics, otherwise about the equilibrium under the scene's loads and voltages. Returns 0, or
 * an exit code after the message on the error.
 *   modes out  modes, and the first natural frequency without and with the loads
 */
static int find_modes(const options *options, const scene *scene, loaded_modes *modes)
{
    enum { USUAL_NUMBER = 10 };
    char error[SCENE_ERROR];
    const modes_request request = {options->number ? options->number : USUAL_NUMBER,
                                   options->circuit};
    memset(modes, 0, sizeof *modes);
    if (check_circuit(options, scene))
        return OPTIONS_WRONG;
    progress_stage("natural frequencies");
    if (loaded_modes_open(modes, scene, &request, error) < 0)
        return complain(error, OPTIONS_WRONG);
    plausible_scene(&modes->warnings, scene);
    plausible_mesh(&modes->warnings, &modes->analysis.design.mesh);
    const modes_request computed = {modes->vibration.count, request.circuit};
    const int status =
        modes_error(options, scene, &modes->vibration, &computed, &modes->mesh_error);
    if (!modes->is_loaded) {
        modes->first = loaded_first(scene);
        plausible_prestress(&modes->warnings, scene, modes->first.unloaded, modes->first.loaded);
    }
    progress_stop();
    return status;
}

int command_modes(const options *options)
{
    scene scene;
    loaded_modes modes;
    int status = open_scene(options, &scene);
    if (status)
        return status;
    progress_start();
    status = find_modes(options, &scene, &modes);
    if (status == 0)
        (options->as_json ? print_vibration_json : print_vibration)(&modes);
    if (status == 0 && options->vtu)
        status = write_modes(&modes.vibration, &modes.analysis.design, options->vtu);
    if (status == 0)
        status = write_reports(options, write_vibration, &modes);
    if (status == 0)
        status = export_modes(options, &modes);
    if (status == 0 && options->is_strict && modes.warnings.count > 0)
        status = 1;
    loaded_modes_close(&modes);
    scene_free(&scene);
    return status;
}
