/* What the plausibility rules measure; shared by the files of plausible.c. */
#ifndef PLAUSIBLE_PARTS_H
#define PLAUSIBLE_PARTS_H

#include "../mesh/mesh.h"

/* What a rule looks at; members that do not belong to its subject are NULL. */
typedef struct subject {
    const scene *scene;
    const mesh *mesh;
    const double *u, *voltage;
    int is_linear;
    const char *name;
} subject;

enum { WHAT = 200 };

/* One number of a subject. */
typedef struct measured {
    double value; /* NAN: nothing to judge */
    scene_at at;
    char what[WHAT]; /* "thickness of layer 1" */
} measured;

/* Measure the k-th number of a subject. Returns whether there is a k-th one. */
typedef int measure(const subject *of, int k, measured *found);

/* plausible_scene.c: numbers of a scene. */
measure measure_modulus, measure_density, measure_piezo, measure_thickness;
measure measure_limit_field, measure_applied_field, measure_resolution;

/* plausible_result.c: numbers of voltages and displacements that were found. */
measure measure_found_field, measure_displacement, measure_strain;

/* The k-th pair of an actuator of voltages and a grid of patches that it drives; returns 0 where
 * there is none. */
int plausible_drive(const scene *scene, int k, const scene_actuator **actuator,
                    const scene_drive **drive);

/* The largest of the amplifiers of an actuator: of volt, or where it is NULL of what the limits
 * allow. */
double plausible_voltage(const scene *scene, const scene_actuator *actuator, const double *voltage);

/* The field of a voltage in the layer of a drive, into found->value: NAN where the material has a
 * limit of its own. */
void plausible_field(const scene *scene, const scene_drive *drive, double voltage, measured *found);

#endif
