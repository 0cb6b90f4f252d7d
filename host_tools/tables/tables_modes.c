/* SPDX-License-Identifier: BSD-2-Clause */
/* Generated tables of the vibration modes on the device (tables_modes.h). */
#include "tables_modes.h"
#include <string.h>
#include "../../lib/core/guard.h"
#include "../../lib/model/shell.h"
#include "../model/mass.h"

/*
 * Compute the modes about the equilibrium that the nonlinear solver has reached; none if it is
 * unstable.
 */
static int make_reached(tables_modes *modes, analysis *analysis, electrode_circuit circuit,
                        int number, char *error)
{
    if (analysis->equilibrium.solver.info.negative_pivots > 0)
        return 0;
    if (analysis_linearise(analysis, error) < 0)
        return -1;
    return vibration_solve_at(&modes->reached, &analysis->design, &analysis->about, circuit, number,
                              MASS_LUMPED, error);
}

int tables_modes_make(tables_modes *modes, analysis *analysis, electrode_circuit circuit,
                      bool at_equilibrium, int number, char *error)
{
    const design *design = &analysis->design;
    memset(modes, 0, sizeof *modes);
    if (mass_tables_make(&modes->mass, design, MASS_LUMPED, error) < 0 ||
        open_tables_make(&modes->open, design, circuit, error) < 0 ||
        vibration_solve_at(&modes->vibration, design, NULL, circuit, number, MASS_LUMPED, error) <
            0)
        return -1;
    const int count = modes->vibration.count, usual = (int)PZS_MODES_VECTORS(count),
              rigid = modes->vibration.rigid, vectors = usual + rigid;
    modes->vectors = vectors < design->mesh.free_dof ? vectors : design->mesh.free_dof;
    modes->shift = rigid > 0 ? modes->vibration.square[count - 1] : 0;
    return at_equilibrium ? make_reached(modes, analysis, circuit, count, error) : 0;
}

void tables_modes_free(tables_modes *modes)
{
    mass_tables_free(&modes->mass);
    open_tables_free(&modes->open);
    vibration_free(&modes->vibration);
    vibration_free(&modes->reached);
    memset(modes, 0, sizeof *modes);
}

static void write_mass(emitter *emitter, const pzs_mass *mass, const design *design)
{
    const size_t packed = SHELL_PACKED(SHELL_NODES * (size_t)design->mesh.dof_per_node);
    emitter->crc32 = pzs_guard_crc(GUARD_CRC_START, &mass->types, sizeof mass->types);
    emit_shorts(emitter, "mass_type", mass->element_type, (size_t)design->mesh.elements,
                "mass matrix of each element");
    emit_reals(emitter, "mass_matrix", mass->matrix, mass->types * packed,
               "element mass matrices, packed lower triangles");
    emit_begin(emitter, "mass", "mass", mass->scene, mass->crc);
    fprintf(emitter->file, " %u, %s_mass_type, %s_mass_matrix,\n};\n\n", mass->types,
            emitter->prefix, emitter->prefix);
}

void tables_modes_write(emitter *emitter, const tables_modes *modes, const design *design)
{
    const char *upper = emitter->upper;
    fputs("#if !PZS_MODES\n#error \"tables with --modes: compile library and firmware with "
          "-DPZS_MODES=1\"\n#endif\n",
          emitter->file);
    write_mass(emitter, &modes->mass.tables, design);
    open_tables_write(emitter, &modes->open, design);
    emit_comment(emitter, "number of vibration modes and of Lanczos vectors, workspace of "
                          "pzs_modes_init, settings.shift of the search");
    fprintf(emitter->file,
            "#define %s_MODES %d\n#define %s_MODES_VECTORS %d\n"
            "#define %s_MODES_BYTES PZS_MODES_BYTES(%d, %d)\n#define %s_MODES_SHIFT "
            "PZS_R(%.17g)\n\n",
            upper, modes->vibration.count, upper, modes->vectors, upper, design->mesh.free_dof,
            modes->vectors, upper, modes->shift);
    emit_reals(emitter, "frequency", modes->vibration.frequency, (size_t)modes->vibration.count,
               modes->open.count > 0
                   ? "natural frequencies of the undeformed structure with these open electrodes "
                     "(Hz where the unit of time is the second), as the host computed them in "
                     "double precision"
                   : "natural frequencies of the undeformed structure at prescribed voltages (Hz "
                     "where the unit of time is the second), as the host computed them in double "
                     "precision");
    if (modes->reached.count > 0)
        emit_reals(
            emitter, "reached_frequency", modes->reached.frequency, (size_t)modes->reached.count,
            "natural frequencies about the equilibrium at the full input values, as the host "
            "computed them in double precision");
    fputs("\n", emitter->file);
}
