/* SPDX-License-Identifier: BSD-2-Clause */
/* Output files that are either complete or absent (outfile.h). */
#define _POSIX_C_SOURCE 200809L
#include "outfile.h"
#include <errno.h>
#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "../system/interrupt.h"

static int cannot_write(const char *path, const char *why)
{
    fprintf(stderr, "pzs: cannot write %s: %s\n", path, why);
    return 1;
}

/* File descriptor of standard output for the output file "-"; -1 before outfile_take_stdout. */
static int standard_output = -1;

int outfile_take_stdout(void)
{
    standard_output = dup(STDOUT_FILENO);
    if (standard_output < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
        return cannot_write("-", strerror(errno));
    return 0;
}

int outfile_check(const char *path)
{
    char folder[OUTFILE_PATH];
    struct stat there;
    const bool exists = stat(path, &there) == 0;
    const char *slash = strrchr(path, '/');
    if (!*path)
        return cannot_write("''", "the name is empty");
    if (exists && !S_ISREG(there.st_mode) && !S_ISDIR(there.st_mode))
        return 0;
    if (exists && S_ISDIR(there.st_mode))
        snprintf(folder, sizeof folder, "%s", path);
    else if (slash)
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - path) + 1, path);
    else
        snprintf(folder, sizeof folder, ".");
    return access(folder, W_OK | X_OK) == 0 ? 0 : cannot_write(path, strerror(errno));
}

int outfile_begin(outfile *output, const char *path)
{
    struct stat there;
    const bool is_stdout = standard_output >= 0 && strcmp(path, "-") == 0;
    const bool is_direct = is_stdout || (stat(path, &there) == 0 && !S_ISREG(there.st_mode));
    output->path = path;
    output->slot = -1;
    output->temporary[0] = '\0';
    if (!is_direct) {
        const int length = snprintf(output->temporary, sizeof output->temporary, "%s.%ld.part",
                                    path, (long)getpid());
        if (length >= OUTFILE_PATH)
            return cannot_write(path, "path too long");
        output->slot = interrupt_file(output->temporary);
    }
    const char *name = is_direct ? path : output->temporary;
    output->file = is_stdout ? fdopen(standard_output, "w") : fopen(name, "w");
    if (output->file)
        return 0;
    interrupt_forget_file(output->slot);
    return cannot_write(path, strerror(errno));
}

static void remove_temporary(const outfile *output)
{
    if (output->temporary[0])
        remove(output->temporary);
    interrupt_forget_file(output->slot);
}

int outfile_end(outfile *output, int failed)
{
    failed |= ferror(output->file);
    failed |= fclose(output->file) != 0;
    if (!failed && output->temporary[0])
        failed = rename(output->temporary, output->path) != 0;
    if (!failed) {
        interrupt_forget_file(output->slot);
        return 0;
    }
    const int why = errno;
    remove_temporary(output);
    return cannot_write(output->path, strerror(why));
}

void outfile_drop(outfile *output)
{
    fclose(output->file);
    remove_temporary(output);
}
