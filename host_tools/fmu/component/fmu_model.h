/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * The model inside an FMU: the interface between the functions of FMI 2.0 (fmi2_functions.c) and
 * the plant (plant_model.c) or the controller (controller_model.c). An FMU contains one model. The
 * files fmu_about.h and fmu_variables.c are written by `pzs fmu` for each FMU.
 */
#ifndef FMU_MODEL_H
#define FMU_MODEL_H

#include <stddef.h>
#include "fmi2.h"
#include "fmu_about.h"

enum { FMU_MESSAGE = 240 };

/*
 * Values of all variables, which the tool sets and gets. The index of a value is its value
 * reference in modelDescription.xml. Variables that a tool may set come first.
 */
typedef struct fmu_values {
    fmi2Real real[FMU_REALS];
    fmi2Integer integer[FMU_INTEGERS];
    fmi2String text[FMU_STRINGS];
    char message[FMU_MESSAGE]; /* reason of a status that is not fmi2OK */
} fmu_values;

extern const fmi2Real fmu_real_start[FMU_REALS];
extern const fmi2Integer fmu_integer_start[FMU_INTEGERS];
extern const char *const fmu_real_name[FMU_REALS];

/*
 * Check that inputs are finite numbers.
 *   first, count in  value reference of the first input, and number of inputs
 * Returns fmi2OK, or fmi2Error with a message.
 */
fmi2Status fmu_check_finite(fmu_values *values, int first, int count);

/* Size of the memory of the model (bytes), which belongs to one instance. */
size_t fmu_model_bytes(void);

/*
 * Start the model from the values of the inputs and compute the outputs at the start time. The
 * function may be called again, and then starts anew. Returns fmi2OK, or fmi2Error with a message.
 */
fmi2Status fmu_model_start(void *memory, fmu_values *values);

/*
 * Run one tick with the values of the inputs. Returns fmi2OK; fmi2Warning with a message; or
 * fmi2Error with a message.
 */
fmi2Status fmu_model_step(void *memory, fmu_values *values);

#endif
