/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions that find the numbers that the plausibility rules compare with their usual ranges,
 * shared by the files plausible*.c.
 */
#ifndef PLAUSIBLE_PARTS_H
#define PLAUSIBLE_PARTS_H

#include "../mesh/mesh.h"
#include "../scene/units.h"

/*
 * Object to which a plausibility rule is applied: a scene, a mesh, a displacement, voltages or the
 * optimum of the voltages. Members that a rule does not need are NULL.
 */
typedef struct subject {
    const scene *scene;
    const mesh *mesh;
    const double *displacement, *voltage;
    bool is_linear;
    const char *name;
    const struct plausible_optimum *optimum;
    const struct stress_field *stress;     /* recovered stresses of the structure, or NULL */
    const struct stress_summary *extremes; /* largest stresses and strains, and smallest reserve
                                              factors, of the structure */
    double path_difference;   /* difference between the displacement and the one computed with twice
                                 as many load steps, relative to the displacement */
    double load_factor;       /* part of the load that twice as many load steps have reached; 1: the
                                 full load */
    unsigned negative_pivots; /* number of negative pivots of the tangent stiffness at the
                                 equilibrium */
    double amplitude;         /* largest displacement of the target divided by the thickness of the
                                 structure */
    double unloaded, loaded; /* first natural frequency of the structure without and with its static
                                loads (Hz); NAN: not known */
    double load;   /* root mean square of the displacements of the target nodes under the loads
                      (length unit of the scene) */
    double reach;  /* root mean square of the displacements of the target nodes under half the
                      voltage range of all amplifiers with random signs (scene's length unit) */
    double noise;  /* standard deviation of the noise of the sensors divided by the root mean square
                      of the target */
    double margin; /* largest standard deviation of relative errors of the influence matrix with
                      which the control loop is stable */
    const char *cure;             /* how this margin becomes larger */
    double end_error, divergence; /* relative shape error at the end of a simulation, and divided by
                                     the largest one without voltages */
    int older; /* largest number of ticks by which the sensor readings may be older than the scene
                  file states while the control loop stays stable */
} subject;

enum { WHAT = 300 };

/*
 * An actuator counts as dead if its column of a measured influence matrix has a norm below this
 * fraction of the largest norm of a column (dimensionless).
 */
#define MATRIX_DEAD 1e-4

/*
 * An actuator counts as weak if its column of a measured influence matrix has a norm below this
 * fraction of the median of all column norms (dimensionless). Such a column may be nothing but
 * measurement noise.
 */
#define MATRIX_WEAK 1e-2

/*
 * A column of a measured influence matrix counts as reversed against the measured modes if the
 * cosine of the angle between it and their static response is below this.
 */
#define MATRIX_REVERSED (-0.5)

/*
 * A number that a plausibility rule has measured, the position in the scene file to which it
 * belongs, and its description.
 */
typedef struct measured {
    double value; /* number that a plausibility rule has measured; NAN if the rule does not apply */
    scene_at at;
    char what[WHAT]; /* description, for the text of a warning, of the number that a plausibility
                        rule has found, for example "thickness of layer 1" */
} measured;

/*
 * Function that computes number k, from 0, which a plausibility rule compares with its usual range,
 * from the scene, mesh or result `of`; some rules have several, such as one for each material.
 * Returns 1 with the number stored in `found`, or 0 if the rule has no k-th number.
 */
typedef int measure(const subject *of, int k, measured *found);

/*
 * Functions that find material constants, wave speeds and layer thicknesses, which plausibility
 * rules compare with their usual ranges (plausible_material.c).
 */
measure measure_modulus, measure_density, measure_light_material, measure_piezo, measure_thickness;
measure measure_wave_speed, measure_dense_wave_speed, measure_ply_wave_speed;
measure measure_piezo_coupling, measure_soft_piezo, measure_uneven_piezo, measure_missing_32;
measure measure_permittivity, measure_pyroelectric, measure_expansion;

/*
 * Functions that measure quantities which plausibility rules compare with their usual ranges
 * (plausible_strength.c): depolarisation fields and strengths of materials, applied voltages
 * relative to the depolarisation voltage, and reserve factors of the stresses against the
 * strengths.
 */
measure measure_field_limit, measure_ceramic_field_limit, measure_depolarisation;
measure measure_strength, measure_soft_strength, measure_strength_ratio;
measure measure_reserve;

/*
 * Functions that measure, with recovered stresses, the error that assumptions of the elements
 * cause, such as straight cross-sections, for the plausibility rules (plausible_theory.c).
 */
measure measure_theory, measure_bend;

/*
 * Functions that find stiffness, stroke and force of piezoelectric stacks, which plausibility rules
 * compare with their usual ranges (plausible_stacks.c).
 */
measure measure_stack_stiffness, measure_stack_stroke, measure_stack_energy, measure_coil;
measure measure_repeated_stack;

/*
 * Functions that find numbers of a scene, such as damping, electric fields and mesh resolution,
 * which plausibility rules compare with their usual ranges (plausible_scene.c).
 */
measure measure_surface_misfit, measure_damping, measure_missing_limits;
measure measure_limit_field, measure_applied_field, measure_resolution, measure_electrode;
measure measure_held_voltage;

/*
 * Functions that find numbers of a mesh, its laminate and its springs, such as thickness over
 * length, which plausibility rules compare with their usual ranges (plausible_mesh.c).
 */
measure measure_locking, measure_coarse, measure_strips, measure_narrow;
measure measure_shear, measure_faces, measure_slenderness, measure_thick_curvature;
measure measure_held_spring, measure_long_spring;
measure measure_file_slenderness, measure_points_height;

/*
 * Functions that find sharp edges and slits in a mesh from a file, for the plausibility rules
 * (plausible_file.c).
 */
measure measure_sharp_edge, measure_slit, measure_place;

/*
 * Functions that find numbers of a measured influence matrix, such as its largest entry and dead
 * actuators, which plausibility rules compare with their usual ranges (plausible_matrix.c).
 */
measure measure_matrix_entry, measure_matrix_shape, measure_dead_column, measure_weak_column,
    measure_repeated_column;
measure measure_strong_column, measure_modes_share, measure_mode_share, measure_shuffled_modes,
    measure_swapped_outputs, measure_reversed_column;

/*
 * Functions that find the largest field, displacement and strain and other numbers of computed
 * results, which plausibility rules compare with their usual ranges (plausible_result.c).
 */
measure measure_found_field, measure_displacement, measure_strain;
measure measure_path, measure_path_end, measure_stability;
measure measure_matrix_errors, measure_model_errors, measure_divergence;
measure measure_target, measure_unreached, measure_range, measure_idle, measure_dependent;

/*
 * Functions that measure, for a stable control loop, by how many ticks the sensor readings may be
 * older than stated, and how many thicknesses the target displaces the structure
 * (plausible_result.c).
 */
measure measure_age, measure_noise, measure_amplitude, measure_amplitude_certified,
    measure_amplitude_at_target;

/*
 * Function that measures how far the static loads change the first natural frequency
 * (plausible_result.c).
 */
measure measure_prestress;

/*
 * Function that measures how far the loads move the target nodes, relative to the voltages
 * (plausible_result.c).
 */
measure measure_sudden_loads;

/*
 * Function that measures the hysteresis of the actuators (width of the loop over the voltage range)
 * if the scene has a self-test: with a wide loop the ceramic hardly follows the small pulses of
 * this test (plausible_result.c).
 */
measure measure_tested_hysteresis;

/* Convert a number of a scene to SI units. Returns NAN if the units of the scene are unknown. */
double plausible_si(const scene *scene, double value, const units_unit *unit);

/*
 * Find the k-th pair of an actuator and a patch grid to which the actuator applies voltages,
 * counted over all actuators of the scene. Returns 0 if there is no such pair.
 */
int plausible_drive(const scene *scene, int k, const scene_actuator **actuator,
                    const scene_drive **drive);

/*
 * Return the largest absolute voltage of an actuator's amplifiers (V): the largest one in the array
 * `voltage`, or, if this is NULL, the largest one that the voltage limits allow.
 */
double plausible_voltage(const scene *scene, const scene_actuator *actuator, const double *voltage);

/*
 * Store in found->value the electric field that an actuator's voltage causes in the layer of the
 * piezoelectric patches that it drives (V/m); NAN if the scene file gives a field limit for the
 * material.
 */
void plausible_field(const scene *scene, const scene_drive *drive, double voltage, measured *found);

#endif
