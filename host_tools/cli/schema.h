/* SPDX-License-Identifier: BSD-2-Clause */
/* JSON schema of scenes, generated from the tables of keys of the scene reader. */
#ifndef SCHEMA_H
#define SCHEMA_H

#include <stdio.h>

/* Write the JSON schema of scenes (JSON Schema 2020-12). */
void schema_write(FILE *file);

#endif
