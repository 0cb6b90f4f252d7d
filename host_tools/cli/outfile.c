/* SPDX-License-Identifier: BSD-2-Clause */
/* Output files that are either complete or absent (outfile.h). */
#define _POSIX_C_SOURCE 200809L
#include "outfile.h"
#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "../system/interrupt.h"

static int cannot_write(const char *path, const char *why)
{
    fprintf(stderr, "pzs: cannot write %s: %s\n", path, why);
    return 1;
}

int outfile_begin(outfile *f, const char *path)
{
    struct stat there;
    const int is_direct = stat(path, &there) == 0 && !S_ISREG(there.st_mode);
    f->path = path;
    f->slot = -1;
    f->temporary[0] = '\0';
    if (!is_direct) {
        const int length =
            snprintf(f->temporary, sizeof f->temporary, "%s.%ld.part", path, (long)getpid());
        if (length >= OUTFILE_PATH)
            return cannot_write(path, "path too long");
        f->slot = interrupt_file(f->temporary);
    }
    f->file = fopen(is_direct ? path : f->temporary, "w");
    if (f->file)
        return 0;
    interrupt_forget_file(f->slot);
    return cannot_write(path, strerror(errno));
}

static void remove_temporary(const outfile *f)
{
    if (f->temporary[0])
        remove(f->temporary);
    interrupt_forget_file(f->slot);
}

int outfile_end(outfile *f, int failed)
{
    failed |= ferror(f->file);
    failed |= fclose(f->file) != 0;
    if (!failed && f->temporary[0])
        failed = rename(f->temporary, f->path) != 0;
    if (!failed) {
        interrupt_forget_file(f->slot);
        return 0;
    }
    const int why = errno;
    remove_temporary(f);
    return cannot_write(f->path, strerror(why));
}

void outfile_drop(outfile *f)
{
    fclose(f->file);
    remove_temporary(f);
}
