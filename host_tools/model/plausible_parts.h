/* SPDX-License-Identifier: BSD-2-Clause */
/* Measured numbers of the plausibility rules; shared by the files plausible*.c. */
#ifndef PLAUSIBLE_PARTS_H
#define PLAUSIBLE_PARTS_H

#include "../mesh/mesh.h"

/* Subject of a rule; members that do not belong to the type of the subject are NULL. */
typedef struct subject {
    const scene *scene;
    const mesh *mesh;
    const double *u, *voltage;
    int is_linear;
    const char *name;
    const struct plausible_optimum *optimum;
    double path_difference;   /* of analysis_path_difference */
    unsigned negative_pivots; /* of the tangent at the equilibrium */
    int older; /* ticks by which readings may be older than the scene says (certificate_loop) */
} subject;

enum { WHAT = 200 };

/* One number of a subject. */
typedef struct measured {
    double value; /* NAN: no number to compare */
    scene_at at;
    char what[WHAT]; /* description, for example "thickness of layer 1" */
} measured;

/* Measure the k-th number of a subject. Returns whether it exists. */
typedef int measure(const subject *of, int k, measured *found);

/* Rules on numbers of a scene (plausible_scene.c). */
measure measure_modulus, measure_density, measure_piezo, measure_thickness;
measure measure_limit_field, measure_applied_field, measure_resolution;

/* Rules on a mesh and its laminate (plausible_mesh.c). */
measure measure_locking, measure_coarse, measure_strips, measure_narrow;
measure measure_shear, measure_faces;

/* Rules on a mesh from a file (plausible_file.c). */
measure measure_sharp_edge, measure_slit;

/* Rules on a measured influence matrix (plausible_matrix.c). */
measure measure_matrix_entry, measure_matrix_shape, measure_dead_column, measure_repeated_column;

/* Rules on computed voltages and displacements (plausible_result.c). */
measure measure_found_field, measure_displacement, measure_strain;
measure measure_path, measure_stability;
measure measure_target, measure_unreached, measure_idle;

/* Rule on a certified loop (plausible_result.c). */
measure measure_age;

/*
 * The k-th pair of an actuator of voltages and a patch grid that it drives. Returns 0 where there
 * is none.
 */
int plausible_drive(const scene *scene, int k, const scene_actuator **actuator,
                    const scene_drive **drive);

/*
 * Largest absolute voltage of an actuator's amplifiers: of `voltage`, or where that is NULL of the
 * voltages that the limits allow.
 */
double plausible_voltage(const scene *scene, const scene_actuator *actuator, const double *voltage);

/*
 * Electric field of a voltage in the layer of a drive, as found->value; NAN where the material has
 * its own field limit.
 */
void plausible_field(const scene *scene, const scene_drive *drive, double voltage, measured *found);

#endif
