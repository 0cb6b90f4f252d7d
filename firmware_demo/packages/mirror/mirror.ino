// A mirror without a model, under Arduino: one call a tick. Replace mirror.h by the tables of yours:
//   pzs tables mirror.yaml --prefix mirror -o mirror.h
// SPDX-License-Identifier: BSD-2-Clause
#define MIRROR_REAL_BITS 32
#include "mirror.h"

static pzs_real work[MIRROR_LOOP_BYTES / sizeof(pzs_real) + 1];
static pzs_real readings[MIRROR_READINGS];
static pzs_loop mirror_loop;
static pzs_status status;
static unsigned long next_tick;

// Fill `readings` with the measured shape, in the unit of the tables.
static void read_sensors()
{
}

// Give the voltages to the amplifiers.
static void write_amplifiers(const pzs_real *voltage)
{
    (void)voltage;
}

void setup()
{
    Serial.begin(115200);
    status = pzs_loop_init(&mirror_loop, mirror_blocks, MIRROR_BLOCKS, NULL, work, sizeof work);
    Serial.println(pzs_status_text(status));
    next_tick = micros();
}

void loop()
{
    if (PZS_IS_ERROR(status) || (long)(micros() - next_tick) < 0)
        return;
    next_tick += (unsigned long)(1e6 / MIRROR_TICK_RATE);
    read_sensors();
    status = pzs_loop_tick(&mirror_loop, mirror_target, readings);
    write_amplifiers(mirror_loop.info.voltage); // after an error: the last safe voltages
    if (PZS_IS_ERROR(status))
        Serial.println(pzs_status_text(status));
}
