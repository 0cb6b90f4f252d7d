/* SPDX-License-Identifier: BSD-2-Clause */
/* Commented scenes to start from, which `pzs new` writes. */
#ifndef TEMPLATES_H
#define TEMPLATES_H

#include <stddef.h>

/* Their names, ended by NULL. */
extern const char *const templates_name[];

/* The scene of a name, or NULL. */
const char *templates_text(const char *name);

#endif
