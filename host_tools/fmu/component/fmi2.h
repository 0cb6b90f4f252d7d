/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Types of FMI 2.0 for Co-Simulation, with the names and the binary interface of the standard
 * (Modelica Association, https://fmi-standard.org). A program that links several FMUs statically
 * defines FMI2_FUNCTION_PREFIX, a text put before every function name.
 */
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>

#define fmi2TypesPlatform "default"
#define fmi2Version "2.0"
#define fmi2True 1
#define fmi2False 0

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus,
    fmi2PendingStatus,
    fmi2LastSuccessfulTime,
    fmi2Terminated
} fmi2StatusKind;

/* Callback functions of the simulator that an FMU may call, as FMI 2.0 defines them. */
typedef struct {
    void (*logger)(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                   fmi2String category, fmi2String message, ...);
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *memory);
    void (*stepFinished)(fmi2ComponentEnvironment environment, fmi2Status status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#if defined _WIN32 || defined __CYGWIN__
#define FMI2_EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2_EXPORT
#endif

#ifdef FMI2_FUNCTION_PREFIX
#define FMI2_JOIN(prefix, name) prefix##name
#define FMI2_PREFIXED(prefix, name) FMI2_JOIN(prefix, name)
#define FMI2_NAME(name) FMI2_PREFIXED(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI2_NAME(name) name
#endif

/* Beginning of the definition of a function of the FMI standard: its return type and its name. */
#define FMI2_FUNCTION(type, name) FMI2_EXPORT type FMI2_NAME(name)

#endif
