/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Form of a measured influence matrix in the tables of a scene: sparse rows if so many entries are
 * zero that these save instructions and memory, else a full matrix.
 */
#ifndef SPARSE_TABLES_H
#define SPARSE_TABLES_H

#include "../model/design.h"

/*
 * Sparse rows are used for an influence matrix if at most 1 in this number of its entries is not
 * zero. In sparse rows an entry takes about eight times the instructions of one in a full matrix (8
 * to 16 against 1.4 to 4 on a Cortex-M4F), and 1.5 times its flash memory.
 */
#define SPARSE_PAYS 8u

typedef struct sparse_facts {
    size_t entries, all; /* entries: number of nonzero entries of a measured influence matrix, 0 for
                            a computed one; all: number of all entries */
    bool are_entries_read; /* true where a block (stage) of the control tick reads single entries of
                              the influence matrix, for which it must be a full matrix */
    bool is_used;          /* true where the tables hold the influence matrix as sparse rows */
    size_t full_reals;     /* size that the full matrix has, or would have, in the tables: number of
                              reals */
    size_t reals, bytes; /* size that the sparse rows have, or would have, in the tables: number of
                            reals, and bytes of indices */
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
