/* SPDX-License-Identifier: BSD-2-Clause */
/* Compilation of an FMU to a shared library on this computer (fmu_parts.h). */
#include "fmu_parts.h"
#include <string.h>
#include "../simulate/device.h"
#include "../system/program.h"

#if defined __linux__ && defined __x86_64__
const char *const fmu_platform = "linux64";
#else
const char *const fmu_platform = NULL;
#endif

/* Write the source files of an FMU into a folder. Returns whether all of them could be written. */
static bool write_sources(const fmu *fmu, const char *folder)
{
    bool is_good = true;
    for (int i = 0; i < fmu->files && is_good; i++) {
        char path[DEVICE_PATH + ZIP_NAME];
        snprintf(path, sizeof path, "%s/%s", folder, fmu->file[i].name);
        FILE *file = fopen(path, "wb");
        is_good =
            file && fwrite(fmu->file[i].text, 1, fmu->file[i].bytes, file) == fmu->file[i].bytes;
        is_good = (!file || fclose(file) == 0) && is_good;
    }
    return is_good;
}

/*
 * Compile all C files of a folder to a shared library, with the C compiler that the environment
 * variable CC names. The function first checks that the compiler exists, so that the shell prints
 * no message of its own. Returns 0, or -1 on failure.
 */
static int compile(const char *folder, const char *library)
{
    static const char command[] =
        "cd \"$0\" && export TMPDIR=\"$0\" && set -- \"$1\" ${CC:-cc} && "
        "command -v \"$2\" >/dev/null && exec ${CC:-cc} -std=c99 -O2 -ffp-contract=off -fPIC "
        "-fvisibility=hidden -shared ${CFLAGS-} -I. -o \"$1\" *.c -lm";
    const char *const argument[] = {"sh", "-c", command, folder, library, NULL};
    return program_run(argument);
}

int fmu_build(fmu *fmu, char *error)
{
    char folder[DEVICE_PATH], library[DEVICE_PATH];
    if (!fmu_platform) {
        snprintf(error, SCENE_ERROR, "--build makes libraries for Linux on x86-64 alone");
        return -1;
    }
    if (device_folder(folder, error) < 0)
        return -1;
    snprintf(library, sizeof library, "%.240s/fmu.so", folder);
    if (write_sources(fmu, folder) && compile(folder, library) == 0)
        fmu->library = fmu_read_file(library, &fmu->library_bytes);
    device_remove(folder);
    if (fmu->library)
        return 0;
    snprintf(error, SCENE_ERROR,
             "the sources of the FMU could not be compiled; CC names the C compiler, and without "
             "--build the tool that imports the FMU compiles them");
    return -1;
}
