/* Version of the library, in this one place, and of the table format. SPDX-License-Identifier:
 * BSD-2-Clause */
#ifndef PZS_VERSION_H
#define PZS_VERSION_H

#define PZS_VERSION_MAJOR 0
#define PZS_VERSION_MINOR 2
#define PZS_VERSION_PATCH 0
#define PZS_VERSION_TEXT "0.2.0"

/*
 * Format of the generated tables. A header made for another format does not compile, tables of
 * another format are refused by every init function. It goes up whenever the layout of a table
 * struct changes; a test compares the layouts with the ones recorded for this number.
 */
#define PZS_TABLE_FORMAT 3u

#endif
