/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Functions of FMI 2.0 for Co-Simulation, which connect a simulator to the model in the FMU
 * (fmu_model.h). Each instance owns all of its memory, so that a program may run several instances
 * of an FMU.
 */
#include "fmu_model.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum instance_mode { INSTANTIATED, INITIALISING, STEPPING, TERMINATED } instance_mode;

typedef struct instance {
    fmi2CallbackFunctions tool; /* callback functions that the simulator provides to the FMU */
    char *name;                 /* name of the FMU's instance in messages to the simulator */
    instance_mode mode;
    double time; /* simulated time at the end of the latest step of the FMU (s) */
    fmu_values values;
    void *model; /* memory of the model in the FMU, fmu_model_bytes() bytes */
} instance;

/*
 * Copy of the state of an instance of the FMU. The memory of the model contains pointers into
 * itself, so the copy can be restored only in the instance from which it was taken.
 */
typedef struct snapshot {
    const instance *owner;
    instance_mode mode;
    double time;
    fmu_values values;
    void *model;
} snapshot;

/*
 * Begin the definition of a function of the FMI standard with its declaration, because strict
 * compilers demand a declaration before the definition.
 */
#define DEFINE(type, name, ...)                                                                    \
    FMI2_FUNCTION(type, name)(__VA_ARGS__);                                                        \
    FMI2_FUNCTION(type, name)(__VA_ARGS__)

/* ---- messages --------------------------------------------------------- */

static fmi2Status report(const instance *of, fmi2Status status, const char *message)
{
    const char *category = status == fmi2Warning ? "logStatusWarning" : "logStatusError";
    if (status != fmi2OK && of->tool.logger)
        of->tool.logger(of->tool.componentEnvironment, of->name, status, category, "%s", message);
    return status;
}

/*
 * Report a status of the model to the simulator, together with the message that the model has
 * stored. Returns the status.
 */
static fmi2Status report_model(const instance *of, fmi2Status status)
{
    return report(of, status, of->values.message);
}

static fmi2Status unsupported(fmi2Component component, const char *name)
{
    char message[FMU_MESSAGE];
    if (!component)
        return fmi2Error;
    snprintf(message, sizeof message, "%s is not supported", name);
    return report(component, fmi2Error, message);
}

/*
 * Check that an instance of the FMU is in the state of initialisation or simulation that a function
 * requires. Returns fmi2OK, or fmi2Error after a message that names the function called too early
 * or too late.
 */
static fmi2Status demand(const instance *of, instance_mode mode, const char *function)
{
    static const char *const when[] = {"before initialisation", "during initialisation",
                                       "after initialisation", "after termination"};
    char message[FMU_MESSAGE];
    if (!of)
        return fmi2Error;
    if (of->mode == mode)
        return fmi2OK;
    snprintf(message, sizeof message, "%s is called %s; it belongs %s", function, when[of->mode],
             when[mode]);
    return report(of, fmi2Error, message);
}

/* ---- life of an instance ---------------------------------------------- */

DEFINE(const char *, fmi2GetTypesPlatform, void)
{
    return fmi2TypesPlatform;
}

DEFINE(const char *, fmi2GetVersion, void)
{
    return fmi2Version;
}

DEFINE(fmi2Status, fmi2SetDebugLogging, fmi2Component component, fmi2Boolean on, size_t count,
       const fmi2String categories[])
{
    (void)on, (void)count, (void)categories; /* An FMU of pzs has no debug messages; it always
                                                reports errors and warnings. */
    return component ? fmi2OK : fmi2Error;
}

static void release(instance *of)
{
    if (!of)
        return;
    free(of->name);
    free(of->model);
    free(of);
}

static void set_start(instance *of)
{
    memset(&of->values, 0, sizeof of->values);
    memcpy(of->values.real, fmu_real_start, sizeof of->values.real);
    memcpy(of->values.integer, fmu_integer_start, sizeof of->values.integer);
    for (int i = 0; i < FMU_STRINGS; i++)
        of->values.text[i] = "";
    of->mode = INSTANTIATED;
    of->time = 0;
}

/* Return the reason why an instance of the FMU cannot be created, or NULL if it can be created. */
static const char *refusal(fmi2Type type, fmi2String guid)
{
    if (type != fmi2CoSimulation)
        return "this FMU is for co-simulation only";
    if (!guid || strcmp(guid, FMU_GUID) != 0)
        return "the GUID of modelDescription.xml is not that of the library: compile the sources "
               "of this FMU again";
    return NULL;
}

DEFINE(fmi2Component, fmi2Instantiate, fmi2String name, fmi2Type type, fmi2String guid,
       fmi2String resources, const fmi2CallbackFunctions *tool, fmi2Boolean visible,
       fmi2Boolean logging)
{
    const char *why = refusal(type, guid);
    instance *of = calloc(1, sizeof *of);
    (void)resources, (void)visible, (void)logging;
    if (!of || !name || !tool) {
        free(of);
        return NULL;
    }
    of->tool = *tool;
    of->name = malloc(strlen(name) + 1);
    of->model = calloc(1, fmu_model_bytes());
    if (!of->name || !of->model) {
        release(of);
        return NULL;
    }
    memcpy(of->name, name, strlen(name) + 1);
    set_start(of);
    if (!why)
        return of;
    report(of, fmi2Error, why);
    release(of);
    return NULL;
}

DEFINE(void, fmi2FreeInstance, fmi2Component component)
{
    release(component);
}

DEFINE(fmi2Status, fmi2SetupExperiment, fmi2Component component, fmi2Boolean has_tolerance,
       fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop, fmi2Real stop)
{
    instance *of = component;
    const fmi2Status status = demand(of, INSTANTIATED, "fmi2SetupExperiment");
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    if (status == fmi2OK)
        of->time = start;
    return status;
}

DEFINE(fmi2Status, fmi2EnterInitializationMode, fmi2Component component)
{
    instance *of = component;
    const fmi2Status status = demand(of, INSTANTIATED, "fmi2EnterInitializationMode");
    if (status == fmi2OK)
        of->mode = INITIALISING;
    return status;
}

/*
 * Start the model in the FMU with the present input values, and compute its outputs at the start.
 */
static fmi2Status start_model(instance *of)
{
    return report_model(of, fmu_model_start(of->model, &of->values));
}

DEFINE(fmi2Status, fmi2ExitInitializationMode, fmi2Component component)
{
    instance *of = component;
    fmi2Status status = demand(of, INITIALISING, "fmi2ExitInitializationMode");
    if (status == fmi2OK)
        status = start_model(of);
    if (status == fmi2OK)
        of->mode = STEPPING;
    return status;
}

DEFINE(fmi2Status, fmi2Terminate, fmi2Component component)
{
    instance *of = component;
    const fmi2Status status = demand(of, STEPPING, "fmi2Terminate");
    if (status == fmi2OK)
        of->mode = TERMINATED;
    return status;
}

DEFINE(fmi2Status, fmi2Reset, fmi2Component component)
{
    if (!component)
        return fmi2Error;
    set_start(component);
    return fmi2OK;
}

/* ---- variables -------------------------------------------------------- */

/*
 * Check the value references of variables. Returns fmi2OK, or fmi2Error after a message.
 *   limit in  number of variables; valid value references are 0 to limit - 1
 */
static fmi2Status check_references(const instance *of, const fmi2ValueReference *reference,
                                   size_t count, size_t limit, const char *what)
{
    char message[FMU_MESSAGE];
    if (!of || (count > 0 && !reference))
        return fmi2Error;
    for (size_t i = 0; i < count; i++) {
        if (reference[i] < limit)
            continue;
        snprintf(message, sizeof message, "%s: there is no such variable with reference %u", what,
                 reference[i]);
        return report(of, fmi2Error, message);
    }
    return fmi2OK;
}

/*
 * Check the value references of variables that the simulator reads. During initialisation, also
 * compute the outputs from the present input values.
 */
static fmi2Status prepare_get(instance *of, const fmi2ValueReference *reference, size_t count,
                              size_t limit, const char *what)
{
    const fmi2Status status = check_references(of, reference, count, limit, what);
    if (status != fmi2OK || of->mode != INITIALISING)
        return status;
    return start_model(of);
}

DEFINE(fmi2Status, fmi2GetReal, fmi2Component component, const fmi2ValueReference reference[],
       size_t count, fmi2Real value[])
{
    instance *of = component;
    const fmi2Status status = prepare_get(of, reference, count, FMU_REALS_USED, "fmi2GetReal");
    for (size_t i = 0; i < count && status == fmi2OK; i++)
        value[i] = of->values.real[reference[i]];
    return status;
}

DEFINE(fmi2Status, fmi2GetInteger, fmi2Component component, const fmi2ValueReference reference[],
       size_t count, fmi2Integer value[])
{
    instance *of = component;
    const fmi2Status status =
        prepare_get(of, reference, count, FMU_INTEGERS_USED, "fmi2GetInteger");
    for (size_t i = 0; i < count && status == fmi2OK; i++)
        value[i] = of->values.integer[reference[i]];
    return status;
}

DEFINE(fmi2Status, fmi2GetBoolean, fmi2Component component, const fmi2ValueReference reference[],
       size_t count, fmi2Boolean value[])
{
    (void)value;
    return check_references(component, reference, count, 0, "fmi2GetBoolean");
}

DEFINE(fmi2Status, fmi2GetString, fmi2Component component, const fmi2ValueReference reference[],
       size_t count, fmi2String value[])
{
    instance *of = component;
    const fmi2Status status = prepare_get(of, reference, count, FMU_STRINGS_USED, "fmi2GetString");
    for (size_t i = 0; i < count && status == fmi2OK; i++)
        value[i] = of->values.text[reference[i]];
    return status;
}

DEFINE(fmi2Status, fmi2SetReal, fmi2Component component, const fmi2ValueReference reference[],
       size_t count, const fmi2Real value[])
{
    instance *of = component;
    const fmi2Status status =
        check_references(of, reference, count, FMU_REAL_INPUTS, "fmi2SetReal of an input");
    for (size_t i = 0; i < count && status == fmi2OK; i++)
        of->values.real[reference[i]] = value[i];
    return status;
}

DEFINE(fmi2Status, fmi2SetInteger, fmi2Component component, const fmi2ValueReference reference[],
       size_t count, const fmi2Integer value[])
{
    instance *of = component;
    const fmi2Status status =
        check_references(of, reference, count, FMU_INTEGER_INPUTS, "fmi2SetInteger of an input");
    for (size_t i = 0; i < count && status == fmi2OK; i++)
        of->values.integer[reference[i]] = value[i];
    return status;
}

DEFINE(fmi2Status, fmi2SetBoolean, fmi2Component component, const fmi2ValueReference reference[],
       size_t count, const fmi2Boolean value[])
{
    (void)value;
    return check_references(component, reference, count, 0, "fmi2SetBoolean");
}

DEFINE(fmi2Status, fmi2SetString, fmi2Component component, const fmi2ValueReference reference[],
       size_t count, const fmi2String value[])
{
    (void)value;
    return check_references(component, reference, count, 0, "fmi2SetString");
}

/* ---- copies of the state ---------------------------------------------- */

DEFINE(fmi2Status, fmi2FreeFMUstate, fmi2Component component, fmi2FMUstate *state)
{
    if (!component || !state)
        return fmi2Error;
    if (*state)
        free(((snapshot *)*state)->model);
    free(*state);
    *state = NULL;
    return fmi2OK;
}

/*
 * Allocate the memory for a copy of the state of an instance of the FMU. Returns NULL if memory
 * runs out.
 */
static snapshot *open_snapshot(const instance *of)
{
    snapshot *copy = calloc(1, sizeof *copy);
    if (copy)
        copy->model = malloc(fmu_model_bytes());
    if (copy && !copy->model) {
        free(copy);
        copy = NULL;
    }
    if (copy)
        copy->owner = of;
    return copy;
}

DEFINE(fmi2Status, fmi2GetFMUstate, fmi2Component component, fmi2FMUstate *state)
{
    const instance *of = component;
    if (!of || !state)
        return fmi2Error;
    if (!*state)
        *state = open_snapshot(of);
    snapshot *copy = *state;
    if (!copy || copy->owner != of)
        return report(of, fmi2Error, "fmi2GetFMUstate: no memory, or a state of another instance");
    copy->mode = of->mode;
    copy->time = of->time;
    copy->values = of->values;
    memcpy(copy->model, of->model, fmu_model_bytes());
    return fmi2OK;
}

DEFINE(fmi2Status, fmi2SetFMUstate, fmi2Component component, fmi2FMUstate state)
{
    instance *of = component;
    const snapshot *copy = state;
    if (!of)
        return fmi2Error;
    if (!copy || copy->owner != of)
        return report(of, fmi2Error, "fmi2SetFMUstate: this is no state of this instance");
    of->mode = copy->mode;
    of->time = copy->time;
    of->values = copy->values;
    memcpy(of->model, copy->model, fmu_model_bytes());
    return fmi2OK;
}

DEFINE(fmi2Status, fmi2SerializedFMUstateSize, fmi2Component component, fmi2FMUstate state,
       size_t *size)
{
    (void)state, (void)size;
    return unsupported(component, "fmi2SerializedFMUstateSize");
}

DEFINE(fmi2Status, fmi2SerializeFMUstate, fmi2Component component, fmi2FMUstate state,
       fmi2Byte bytes[], size_t size)
{
    (void)state, (void)bytes, (void)size;
    return unsupported(component, "fmi2SerializeFMUstate");
}

DEFINE(fmi2Status, fmi2DeSerializeFMUstate, fmi2Component component, const fmi2Byte bytes[],
       size_t size, fmi2FMUstate *state)
{
    (void)bytes, (void)size, (void)state;
    return unsupported(component, "fmi2DeSerializeFMUstate");
}

/* ---- derivatives ------------------------------------------------------ */

DEFINE(fmi2Status, fmi2GetDirectionalDerivative, fmi2Component component,
       const fmi2ValueReference unknown[], size_t unknowns, const fmi2ValueReference known[],
       size_t knowns, const fmi2Real change[], fmi2Real result[])
{
    (void)unknown, (void)unknowns, (void)known, (void)knowns, (void)change, (void)result;
    return unsupported(component, "fmi2GetDirectionalDerivative");
}

DEFINE(fmi2Status, fmi2SetRealInputDerivatives, fmi2Component component,
       const fmi2ValueReference reference[], size_t count, const fmi2Integer order[],
       const fmi2Real value[])
{
    (void)reference, (void)count, (void)order, (void)value;
    return unsupported(component, "fmi2SetRealInputDerivatives");
}

DEFINE(fmi2Status, fmi2GetRealOutputDerivatives, fmi2Component component,
       const fmi2ValueReference reference[], size_t count, const fmi2Integer order[],
       fmi2Real value[])
{
    (void)reference, (void)count, (void)order, (void)value;
    return unsupported(component, "fmi2GetRealOutputDerivatives");
}

/* ---- inputs ----------------------------------------------------------- */

fmi2Status fmu_check_finite(fmu_values *values, int first, int count)
{
    for (int i = first; i < first + count; i++) {
        if (isfinite(values->real[i]))
            continue;
        snprintf(values->message, sizeof values->message, "%s is %g, which is no finite number",
                 fmu_real_name[i], values->real[i]);
        return fmi2Error;
    }
    return fmi2OK;
}

/* ---- steps ------------------------------------------------------------ */

/*
 * Largest permitted difference between the length of a step of the FMU and the tick period,
 * relative to the tick period.
 */
static const double period_tolerance = 1e-6;

/*
 * Check that a step begins at the time at which the last one ended. The permitted difference is
 * period_tolerance times the tick period, plus rounding errors of the times. Returns fmi2OK, or
 * fmi2Error after a message.
 */
static fmi2Status check_time(const instance *of, double from)
{
    char message[FMU_MESSAGE];
    const double tolerance = period_tolerance * FMU_PERIOD + 4 * DBL_EPSILON * fabs(of->time);
    if (fabs(from - of->time) <= tolerance)
        return fmi2OK;
    snprintf(message, sizeof message,
             "fmi2DoStep: a step from the time %.9g s is refused; the last step ended at %.9g s",
             from, of->time);
    return report(of, fmi2Error, message);
}

DEFINE(fmi2Status, fmi2DoStep, fmi2Component component, fmi2Real from, fmi2Real length,
       fmi2Boolean keeps_state)
{
    instance *of = component;
    char message[FMU_MESSAGE];
    fmi2Status status = demand(of, STEPPING, "fmi2DoStep");
    (void)keeps_state;
    if (status != fmi2OK)
        return status;
    if (!(fabs(length - FMU_PERIOD) <= period_tolerance * FMU_PERIOD)) {
        snprintf(message, sizeof message,
                 "fmi2DoStep: a step of %.9g s is refused; each step is one tick of %.9g s", length,
                 FMU_PERIOD);
        return report(of, fmi2Discard, message);
    }
    status = check_time(of, from);
    if (status != fmi2OK)
        return status;
    status = report_model(of, fmu_model_step(of->model, &of->values));
    if (status == fmi2OK || status == fmi2Warning)
        of->time = from + length;
    return status;
}

DEFINE(fmi2Status, fmi2CancelStep, fmi2Component component)
{
    return unsupported(component, "fmi2CancelStep");
}

DEFINE(fmi2Status, fmi2GetStatus, fmi2Component component, const fmi2StatusKind kind,
       fmi2Status *value)
{
    (void)kind, (void)value; /* Every step of the FMU ends before fmi2DoStep returns, so no status
                                is ever pending. */
    return unsupported(component, "fmi2GetStatus");
}

DEFINE(fmi2Status, fmi2GetRealStatus, fmi2Component component, const fmi2StatusKind kind,
       fmi2Real *value)
{
    if (!component || kind != fmi2LastSuccessfulTime)
        return unsupported(component, "fmi2GetRealStatus");
    *value = ((const instance *)component)->time;
    return fmi2OK;
}

DEFINE(fmi2Status, fmi2GetIntegerStatus, fmi2Component component, const fmi2StatusKind kind,
       fmi2Integer *value)
{
    (void)kind, (void)value;
    return unsupported(component, "fmi2GetIntegerStatus");
}

DEFINE(fmi2Status, fmi2GetBooleanStatus, fmi2Component component, const fmi2StatusKind kind,
       fmi2Boolean *value)
{
    if (!component || kind != fmi2Terminated)
        return unsupported(component, "fmi2GetBooleanStatus");
    *value = fmi2False;
    return fmi2OK;
}

DEFINE(fmi2Status, fmi2GetStringStatus, fmi2Component component, const fmi2StatusKind kind,
       fmi2String *value)
{
    (void)kind, (void)value;
    return unsupported(component, "fmi2GetStringStatus");
}
