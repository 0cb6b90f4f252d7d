/*
 * Version of the library and of the format of its tables.
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef PZS_VERSION_H
#define PZS_VERSION_H

#define PZS_VERSION_MAJOR 0
#define PZS_VERSION_MINOR 2
#define PZS_VERSION_PATCH 0
#define PZS_VERSION_TEXT "0.2.0"

/*
 * Format number of the generated tables. A generated header of another format does not compile with
 * this library, and every init function refuses tables of another format. The number increases when
 * the layout of a table struct changes.
 */
#define PZS_TABLE_FORMAT 6u

#endif
