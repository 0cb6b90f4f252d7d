/* SPDX-License-Identifier: BSD-2-Clause */
/* Source files of an FMU (fmu_parts.h). */
#define _POSIX_C_SOURCE 200809L
#include "fmu_parts.h"
#include <glob.h>
#include <stdlib.h>
#include <string.h>
#include "../system/shipped.h"

/* ---- generated files -------------------------------------------------- */

FILE *fmu_begin_file(fmu *fmu, const char *name)
{
    if (fmu->files == FMU_FILES || strlen(name) >= ZIP_NAME) {
        fmu->is_full = true;
        return NULL;
    }
    fmu_file *file = &fmu->file[fmu->files];
    snprintf(file->name, sizeof file->name, "%s", name);
    file->stream = open_memstream(&file->text, &file->bytes);
    fmu->is_full |= !file->stream;
    fmu->files += file->stream != NULL;
    return file->stream;
}

void fmu_end_file(fmu *fmu)
{
    fmu_file *file = &fmu->file[fmu->files - 1];
    fmu->is_full |= fclose(file->stream) != 0;
    file->stream = NULL;
}

/* ---- copies ----------------------------------------------------------- */

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/*
 * Copy a line of C source. In an #include line, the folders before the file name are removed,
 * because all sources of an FMU are in one folder.
 */
static void copy_line(const char *line, FILE *to)
{
    static const char include[] = "#include \"";
    const size_t head = sizeof include - 1;
    if (strncmp(line, include, head) == 0)
        fprintf(to, "%s%s", include, file_name(line + head));
    else
        fputs(line, to);
}

static void copy_source(fmu *fmu, const char *path)
{
    enum { LINE = 512 };
    char line[LINE];
    FILE *from = fopen(path, "r"), *to = fmu_begin_file(fmu, file_name(path));
    while (from && to && fgets(line, sizeof line, from))
        copy_line(line, to);
    fmu->is_full |= !from || ferror(from);
    if (from)
        fclose(from);
    if (to)
        fmu_end_file(fmu);
}

int fmu_copy_sources(fmu *fmu, const char *const *pattern, char *error)
{
    for (; *pattern; pattern++) {
        char path[SHIPPED_PATH];
        glob_t found;
        snprintf(path, sizeof path, "%.4000s/%s", shipped_sources(), *pattern);
        const int missing = glob(path, 0, NULL, &found) != 0;
        for (size_t i = 0; i < found.gl_pathc && !missing; i++)
            copy_source(fmu, found.gl_pathv[i]);
        globfree(&found);
        if (!missing)
            continue;
        snprintf(error, SCENE_ERROR,
                 "the sources of the library are not in %.250s (no %.60s); PZS_SOURCES names the "
                 "folder of the sources",
                 shipped_sources(), *pattern);
        return -1;
    }
    return 0;
}

char *fmu_read_file(const char *path, size_t *bytes)
{
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    long size = -1;
    if (file && fseek(file, 0, SEEK_END) == 0)
        size = ftell(file);
    if (size >= 0 && fseek(file, 0, SEEK_SET) == 0)
        text = malloc((size_t)size + 1);
    *bytes = text ? fread(text, 1, (size_t)size, file) : 0;
    if (file)
        fclose(file);
    return text;
}
