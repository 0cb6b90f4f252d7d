/* SPDX-License-Identifier: BSD-2-Clause */
/* Parts of an FMU while it is put together: variables and files. */
#ifndef FMU_PARTS_H
#define FMU_PARTS_H

#include "../data/zip_archive.h"
#include "../text/words.h"
#include "fmu.h"

enum { FMU_NAME = 160, FMU_FILES = 128, FMU_GUID = 40 };

typedef enum fmu_type { FMU_REAL, FMU_INTEGER, FMU_STRING, FMU_TYPES } fmu_type;
typedef enum fmu_role { FMU_INPUT, FMU_PARAMETER, FMU_OUTPUT } fmu_role;

/* A variable of the FMU. Variables of one type are numbered in their order by value references. */
typedef struct fmu_variable {
    fmu_type type;
    fmu_role role;
    char name[FMU_NAME], about[FMU_NAME]; /* name, and description in one sentence */
    char unit[WORDS_UNIT];                /* unit, or an empty text */
    double start;                         /* value of an input or parameter before the first step */
} fmu_variable;

/* A file of the FMU that pzs writes or copies. */
typedef struct fmu_file {
    char name[ZIP_NAME]; /* name inside the folder sources/ */
    char *text;
    size_t bytes;
    FILE *stream; /* open while the file is being written, otherwise NULL */
} fmu_file;

typedef struct fmu {
    const analysis *nominal;
    const design *design; /* design of the controller's model */
    fmu_kind kind;
    char identifier[FMU_IDENTIFIER]; /* C identifier, the name of the shared library */
    char guid[FMU_GUID];             /* mark by which description and library know each other */
    char *library;                   /* contents of the shared library, or NULL */
    size_t library_bytes;
    fmu_variable *variable;
    int variables;
    fmu_file file[FMU_FILES]; /* sources */
    int files;
    bool is_full; /* true after an allocation of memory has failed, or there are too many files */
} fmu;

/* ---- fmu_variables.c -------------------------------------------------- */

/*
 * Append a variable. The name is `group` alone, or `group.name` where a name is given.
 *   about in  description, a sentence
 *   unit  in  unit of the variable, or an empty text
 */
void fmu_add(fmu *fmu, fmu_variable kind, const char *group, const char *name);

/* Append a variable whose name is `group.index`. */
void fmu_add_indexed(fmu *fmu, fmu_variable kind, const char *group, int index);

/* Number of variables of a type, or of those of them that a tool may set. */
int fmu_count(const fmu *fmu, fmu_type type);
int fmu_count_settable(const fmu *fmu, fmu_type type);

/* Append one variable for each amplifier, for each target node, or for each sensor reading. */
void fmu_add_amplifiers(fmu *fmu, fmu_variable kind, const char *group, const double *start);
void fmu_add_nodes(fmu *fmu, fmu_variable kind, const char *group, const double *start);
void fmu_add_readings(fmu *fmu, fmu_role role);

/* ---- fmu_files.c ------------------------------------------------------ */

/* Begin and end a source file. fmu_begin_file returns a stream for its text, or NULL. */
FILE *fmu_begin_file(fmu *fmu, const char *name);
void fmu_end_file(fmu *fmu);

/*
 * Copy sources of the project into the FMU. All files of an FMU lie in one folder, so that the
 * folders in #include lines are removed.
 *   pattern in  paths inside the project, ended by NULL; wildcards are allowed
 * Returns 0, or -1 with error filled.
 */
int fmu_copy_sources(fmu *fmu, const char *const *pattern, char *error);

/* Read a file as text. Returns allocated memory, or NULL. */
char *fmu_read_file(const char *path, size_t *bytes);

/* ---- the models ------------------------------------------------------- */

/*
 * Append variables, tables and sources of the plant or of the controller. Each function returns 0,
 * or -1 with error filled.
 */
int fmu_fill_plant(fmu *fmu, fmu_summary *summary, char *error);
int fmu_fill_controller(fmu *fmu, char *error);

/* ---- fmu_description.c ------------------------------------------------ */

/* Write the generated C files: numbers of variables, start values, names. */
void fmu_write_about(fmu *fmu);
void fmu_write_variables(fmu *fmu);

/* Write modelDescription.xml and the page of the documentation. */
void fmu_write_description(const fmu *fmu, FILE *file);
void fmu_write_page(const fmu *fmu, FILE *file);

/* ---- fmu_build.c ------------------------------------------------------ */

/* Folder of the shared library inside the archive, by FMI 2.0. */
extern const char *const fmu_platform;

/*
 * Compile the sources to a shared library. Returns 0, or -1 with error filled; the messages of the
 * compiler go to standard error.
 */
int fmu_build(fmu *fmu, char *error);

#endif
