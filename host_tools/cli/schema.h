/* SPDX-License-Identifier: BSD-2-Clause */
/* JSON schema of scenes, made from the tables of keys of the reader. */
#ifndef SCHEMA_H
#define SCHEMA_H

#include <stdio.h>

/* Write the schema (JSON Schema 2020-12). */
void schema_write(FILE *file);

#endif
