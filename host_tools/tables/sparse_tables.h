/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Influence matrix in the tables of a scene with a measured matrix: as sparse rows where many
 * entries are zero, so that this pays, else as a full matrix.
 */
#ifndef SPARSE_TABLES_H
#define SPARSE_TABLES_H

#include "../model/design.h"

/*
 * Number of entries of an influence matrix for each nonzero one from which sparse rows pay. In a
 * product with a vector each entry of sparse rows takes about eight times the instructions of an
 * entry of a full matrix (8 to 16 against 1.4 to 4 on a Cortex-M4F), and 1.5 times its flash
 * memory.
 */
#define SPARSE_PAYS 8u

typedef struct sparse_facts {
    size_t entries, all;   /* number of entries of a measured influence matrix that are not zero,
                              and of all its entries; entries is 0 for other matrices */
    bool are_entries_read; /* true where a block (stage) of the control tick reads single entries of
                              the influence matrix, for which it must be a full matrix */
    bool is_used;          /* true where the tables hold the influence matrix as sparse rows */
    size_t full_reals;     /* size of the full matrix in the tables: number of reals */
    size_t reals, bytes;   /* size of the sparse rows in the tables: number of reals, and bytes of
                              indices */
} sparse_facts;

/*
 * Count the entries of the influence matrix of a scene, and decide whether its tables hold the
 * matrix as sparse rows.
 *   are_entries_read  in  true where a block (stage) of the control tick reads single entries
 */
sparse_facts sparse_tables_count(const design *design, bool are_entries_read);

/*
 * Make sparse rows of the influence matrix of a scene. Returns 0, or -1 where memory runs out;
 * sparse_tables_free releases the rows in both cases.
 */
int sparse_tables_make(pzs_sparse_influence *sparse, const design *design);
void sparse_tables_free(pzs_sparse_influence *sparse);

#endif
