/* SPDX-License-Identifier: BSD-2-Clause */
/* Commented example scenes and data files, which `pzs new` writes as a starting point. */
#ifndef TEMPLATES_H
#define TEMPLATES_H

#include <stddef.h>

/* Names of the example scenes and data files, ended by NULL. */
extern const char *const templates_name[];

/* Text of the example scene or data file with a given name, or NULL where there is none. */
const char *templates_text(const char *name);

#endif
