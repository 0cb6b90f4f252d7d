/* Checksums of the tables of estimation and feed-forward, for those who make them. */
#ifndef PZS_ESTIMATE_H
#define PZS_ESTIMATE_H

#include "pzs.h"

/* CRC of the counts and arrays of a table, as stored in its crc field. */
uint32_t estimate_crc(const pzs_estimator *tables);
uint32_t estimate_known_crc(const pzs_known *tables);

#endif
