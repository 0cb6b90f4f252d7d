/* SPDX-License-Identifier: BSD-2-Clause */
/* Export of a scene as a functional mock-up unit: the ZIP archive (fmu.h). */
#define _POSIX_C_SOURCE 200809L
#include "fmu.h"
#include <stdlib.h>
#include <string.h>
#include "../../lib/core/guard.h"
#include "../system/shipped.h"
#include "fmu_parts.h"

/* ---- names ------------------------------------------------------------ */

void fmu_identifier(const design *design, fmu_kind kind, char *name)
{
    snprintf(name, FMU_IDENTIFIER, "%s_%s", design->name,
             kind == FMU_PLANT ? "plant" : "controller");
    for (char *letter = name; *letter; letter++)
        if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", *letter) ||
            (letter == name && *letter >= '0' && *letter <= '9'))
            *letter = '_';
}

/*
 * Set the identifier that modelDescription.xml and the shared library of an FMU must share (GUID),
 * from a checksum of all source files.
 */
static void set_guid(fmu *fmu)
{
    uint32_t crc = GUARD_CRC_START;
    for (int i = 0; i < fmu->files; i++)
        crc = pzs_guard_crc(crc, fmu->file[i].text, fmu->file[i].bytes);
    snprintf(fmu->guid, sizeof fmu->guid, "{%s-%08x}", fmu->identifier, (unsigned)~crc);
}

/* ---- archive ---------------------------------------------------------- */

/*
 * Write a generated text as a member of the ZIP archive. Returns 0, or -1 where memory runs out or
 * the archive is full.
 */
static int add_text(const fmu *fmu, zip_archive *archive, const char *name,
                    void (*write)(const struct fmu *fmu, FILE *file))
{
    char *text = NULL;
    size_t bytes = 0;
    FILE *stream = open_memstream(&text, &bytes);
    if (!stream)
        return -1;
    write(fmu, stream);
    int failed = fclose(stream) != 0;
    const zip_part part = {text, bytes};
    failed = failed || zip_add(archive, name, &part, 1) < 0;
    free(text);
    return failed ? -1 : 0;
}

/*
 * Add the licence of the sources to the ZIP archive, if the source folder of the project contains
 * the licence file. Returns 0, or -1 on failure.
 */
static int add_licence(zip_archive *archive)
{
    char path[SHIPPED_PATH];
    zip_part part;
    snprintf(path, sizeof path, "%.4000s/LICENSE", shipped_sources());
    char *text = fmu_read_file(path, &part.bytes);
    part.data = text;
    const int failed = text ? zip_add(archive, "documentation/licenses/license.txt", &part, 1) : 0;
    free(text);
    return failed;
}

static int add_sources(const fmu *fmu, zip_archive *archive)
{
    int failed = 0;
    for (int i = 0; i < fmu->files && !failed; i++) {
        const zip_part part = {fmu->file[i].text, fmu->file[i].bytes};
        char name[ZIP_NAME + 16];
        snprintf(name, sizeof name, "sources/%s", fmu->file[i].name);
        failed = zip_add(archive, name, &part, 1);
    }
    return failed;
}

static int add_library(const fmu *fmu, zip_archive *archive)
{
    const zip_part part = {fmu->library, fmu->library_bytes};
    char name[ZIP_NAME + 32];
    if (!fmu->library)
        return 0;
    snprintf(name, sizeof name, "binaries/%s/%s.so", fmu_platform, fmu->identifier);
    return zip_add(archive, name, &part, 1);
}

static int write_archive(const fmu *fmu, FILE *file)
{
    zip_archive *archive = malloc(sizeof *archive);
    if (!archive)
        return -1;
    zip_begin(archive, file);
    const int failed = add_text(fmu, archive, "modelDescription.xml", fmu_write_description) < 0 ||
                       add_text(fmu, archive, "documentation/index.html", fmu_write_page) < 0 ||
                       add_licence(archive) < 0 || add_sources(fmu, archive) < 0 ||
                       add_library(fmu, archive) < 0 || zip_end(archive) < 0;
    free(archive);
    return failed ? -1 : 0;
}

/* ---- FMU -------------------------------------------------------------- */

static void close_fmu(fmu *fmu)
{
    for (int i = 0; i < fmu->files; i++)
        free(fmu->file[i].text);
    free(fmu->variable);
    free(fmu->library);
    free(fmu);
}

/* Collect all variables and source files of an FMU. Returns 0, or -1 with a message in `error`. */
static int fill(fmu *fmu, fmu_summary *summary, char *error)
{
    const design *design = fmu->design;
    if ((fmu->kind == FMU_PLANT ? fmu_fill_plant(fmu, summary, error)
                                : fmu_fill_controller(fmu, error)) < 0)
        return -1;
    fmu_write_variables(fmu);
    fmu_identifier(fmu->design, fmu->kind, fmu->identifier);
    set_guid(fmu);
    fmu_write_about(fmu);
    return fmu->is_full ? scene_fault(design->limits.at, error, "out of memory") : 0;
}

static void summarise(const fmu *fmu, fmu_summary *summary)
{
    for (int i = 0; i < fmu->variables; i++) {
        summary->inputs += fmu->variable[i].role == FMU_INPUT;
        summary->outputs += fmu->variable[i].role == FMU_OUTPUT;
    }
    summary->period = 1 / fmu->design->control.rate;
}

int fmu_check(const design *design, char *error)
{
    if (design->control.rate > 0)
        return 0;
    return scene_fault(design->limits.at, error,
                       "an FMU needs a tick rate: add control: {rate: ...} in ticks a second");
}

int fmu_write(FILE *file, const analysis *nominal, fmu_kind kind, bool builds, fmu_summary *summary,
              char *error)
{
    fmu *fmu = calloc(1, sizeof *fmu);
    const design *design = &nominal->design;
    memset(summary, 0, sizeof *summary);
    if (!fmu)
        return scene_fault(design->limits.at, error, "out of memory");
    fmu->nominal = nominal;
    fmu->design = design;
    fmu->kind = kind;
    int failed = fill(fmu, summary, error) < 0 || (builds && fmu_build(fmu, error) < 0);
    if (!failed && write_archive(fmu, file) < 0)
        failed = scene_fault(design->limits.at, error, "the FMU could not be written");
    summarise(fmu, summary);
    close_fmu(fmu);
    return failed ? -1 : 0;
}
