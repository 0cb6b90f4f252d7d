/* SPDX-License-Identifier: BSD-2-Clause */
/* Warnings on a mesh (quad_options.h). */
#include "quad_options.h"

#include <stdarg.h>
#include <stdio.h>

void quad_warn(quad_warnings *warnings, const char *format, ...)
{
    va_list list;
    if (warnings->count == QUAD_WARNINGS)
        return;
    va_start(list, format);
    vsnprintf(warnings->text[warnings->count++], QUAD_ERROR, format, list);
    va_end(list);
}
