/*
 * Vibration modes on the device in either precision: tables made in double by the host tools,
 * rounded to the precision of the test program. Include it after cmocka.h.
 *
 * SPDX-License-Identifier: BSD-2-Clause
 */
#ifndef MODES_DEVICE_H
#define MODES_DEVICE_H

#include <math.h>
#include <stdio.h>
#include "rounded.h"
#include "../../lib/core/linalg.h"
#include "../../lib/model/shell.h"

#define IS_FLOAT (PZS_REAL_BITS == 32)

typedef struct device {
    bridge bridge;
    bridge_mass host;
    pzs_structure structure;
    pzs_mass mass;
    pzs_model model;
    pzs_modes modes;
    pzs_electrodes electrodes;
    pzs_real *owned[ROUNDED_ARRAYS], *matrix, *charge;
    void *work, *modes_work, *open_work;
    size_t bytes, modes_bytes;
} device;

enum { MOST_CHANGES = 12 };

/* Split "key=value;key=value" in place into at most MOST_CHANGES changes. Returns their number. */
static inline int split(char *text, const char *change[MOST_CHANGES])
{
    int count = 0;
    for (char *at = strtok(text, ";"); at && count < MOST_CHANGES; at = strtok(NULL, ";"))
        change[count++] = at;
    return count;
}

/* Open the electrodes that are open on the host while the structure vibrates. */
static inline void open_electrodes(device *d)
{
    const bridge_mass *host = &d->host;
    const size_t bytes = PZS_MODES_OPEN_BYTES(d->bridge.dof, host->open);
    if (host->electrodes == 0)
        return;
    d->electrodes.count = (uint16_t)host->electrodes;
    d->electrodes.input = host->electrode_input;
    d->electrodes.open = host->electrode_open;
    d->charge = round_rows(&host->direct, &d->electrodes.direct);
    d->open_work = malloc(bytes);
    assert_non_null(d->open_work);
    assert_int_equal(pzs_electrodes_seal(&d->electrodes, &d->structure), PZS_OK);
    assert_int_equal(
        pzs_modes_open_electrodes(&d->modes, &d->electrodes, host->is_open, d->open_work, bytes),
        PZS_OK);
}

/*
 * Open a scene on the device without looking for modes.
 *   circuit   in  circuits of the electrodes while the structure vibrates
 *   is_solved in  whether the host finds the equilibrium of the scene and its modes there
 */
static inline void device_open_at(device *d, const char *scene, const char *changes,
                                  bridge_circuit circuit, int number, size_t vectors,
                                  bool is_solved)
{
    char error[400] = "", text[2000];
    const char *change[MOST_CHANGES];
    memset(d, 0, sizeof *d);
    snprintf(text, sizeof text, "%s", changes);
    const int sets = split(text, change);
    const int failed = is_solved ? bridge_open(&d->bridge, scene, change, sets, error)
                                 : bridge_open_unsolved(&d->bridge, scene, change, sets, error);
    if (failed < 0 || bridge_mass_open(&d->host, &d->bridge, circuit, number, error) < 0)
        fail_msg("%s", error);
    const bridge *b = &d->bridge;
    const size_t corners = 4 * (size_t)b->dof_per_node;
    round_structure(b, &d->structure, d->owned);
    d->matrix = rounded(d->host.matrix, (size_t)d->host.types * SHELL_PACKED(corners));
    d->mass.types = (uint16_t)d->host.types;
    d->mass.element_type = d->host.element_type;
    d->mass.matrix = d->matrix;
    assert_int_equal(pzs_mass_seal(&d->mass, &d->structure), PZS_OK);
    d->bytes = PZS_MODEL_BYTES(b->dof, pzs_linalg_reals(b->first_column, (uint32_t)b->dof));
    d->work = malloc(d->bytes);
    d->modes_bytes = PZS_MODES_BYTES(b->dof, vectors);
    d->modes_work = malloc(d->modes_bytes);
    assert_true(d->work && d->modes_work);
    assert_int_equal(pzs_model_init(&d->model, &d->structure, d->work, d->bytes), PZS_OK);
    assert_int_equal(pzs_assemble(&d->model, NULL, NULL), PZS_OK);
    assert_int_equal(pzs_modes_init(&d->modes, &d->model, &d->mass, (uint16_t)number,
                                    (uint16_t)vectors, d->modes_work, d->modes_bytes),
                     PZS_OK);
    open_electrodes(d);
}

static inline void device_open(device *d, const char *scene, const char *changes, int number,
                               size_t vectors)
{
    device_open_at(d, scene, changes, BRIDGE_SHORT, number, vectors, false);
}

static inline void device_close(device *d)
{
    bridge_mass_close(&d->host);
    bridge_close(&d->bridge);
    for (int k = 0; k < ROUNDED_ARRAYS; k++)
        free(d->owned[k]);
    free(d->matrix);
    free(d->charge);
    free(d->open_work);
    free(d->work);
    free(d->modes_work);
}

/* Find the modes: from the factor of the stiffness matrix, or with a shift. */
static inline pzs_status find(device *d, double shift)
{
    d->modes.settings.shift = (pzs_real)shift;
    const pzs_status status = shift > 0 ? PZS_OK : pzs_factor(&d->model);
    return status == PZS_OK ? pzs_modes_find(&d->modes) : status;
}

static inline void open_and_find(device *d, const char *scene, const char *changes, int number,
                                 double shift)
{
    device_open(d, scene, changes, number, PZS_MODES_VECTORS(number));
    const pzs_status status = find(d, shift);
    if (PZS_IS_ERROR(status))
        fail_msg("%s %s: %s (%d)", scene, changes, pzs_status_text(status), d->modes.info.where);
}

static inline double square_of(const device *d, int i)
{
    return (double)d->modes.info.square[i];
}

/*
 * Bound of the relative rounding error of a squared frequency, the sum over the elements of 88
 * products of strains: errors of random sign add up to the root of their number, and each product
 * has several.
 */
static inline double rounding_of(const device *d)
{
    return 4 * (double)PZS_EPSILON * sqrt(88.0 * d->bridge.elements);
}

/* ---- with an equilibrium solver ----------------------------------------- */

/* A device with an equilibrium solver. */
typedef struct bent_device {
    device device;
    pzs_nonlinear tables;
    pzs_solver solver;
    pzs_circuit circuit;
    pzs_real *given, *value, *motion;
    void *work, *circuit_work;
} bent_device;

static inline void round_path(bent_device *d)
{
    const bridge *b = &d->device.bridge;
    d->given = rounded(b->given_value, 10 * (size_t)b->given_values);
    d->value = rounded(b->full_input, (size_t)b->input.count);
    d->motion = rounded(b->motion_value, (size_t)b->motions);
    d->tables.resultants =
        (pzs_prescribed_resultants){(uint16_t)b->given_values, b->given_start, b->given_element,
                                    b->given_which, (const pzs_real(*)[10])(const void *)d->given};
    d->tables.prescribed = (pzs_prescribed_motion){(uint16_t)b->motions, (uint16_t)b->motion_input,
                                                   b->motion_dof, d->motion};
    assert_int_equal(pzs_nonlinear_seal(&d->tables, &d->device.structure), PZS_OK);
}

/* Attach the circuit of the open electrodes of the scene, if there are any, to the solver. */
static inline void attach_circuit(bent_device *d)
{
    const bridge_mass *host = &d->device.host;
    const size_t bytes = PZS_CIRCUIT_BYTES(host->electrodes, host->electrodes);
    bool has_open = false;
    for (int k = 0; k < host->electrodes; k++)
        has_open = has_open || host->electrode_open[k] != 0;
    if (!has_open)
        return;
    d->circuit_work = malloc(bytes);
    assert_non_null(d->circuit_work);
    assert_int_equal(
        pzs_attach_circuit(&d->solver, &d->circuit, &d->device.electrodes, d->circuit_work, bytes),
        PZS_OK);
}

/*
 * Open a nonlinear scene and find its equilibrium; `circuit` as in device_open_at. Returns the
 * status of pzs_equilibrium.
 */
static inline pzs_status bent_open(bent_device *d, const char *scene, const char *changes,
                                   bridge_circuit circuit, int number)
{
    memset(d, 0, sizeof *d);
    device_open_at(&d->device, scene, changes, circuit, number, PZS_MODES_VECTORS(number), true);
    const bridge *b = &d->device.bridge;
    const size_t bytes = PZS_SOLVER_BYTES(b->dof, b->elements, b->input.count);
    round_path(d);
    d->work = malloc(bytes);
    assert_non_null(d->work);
    assert_int_equal(pzs_solver_init(&d->solver, &d->device.model, &d->tables, d->work, bytes),
                     PZS_OK);
    d->solver.settings.tolerance = (pzs_real)(IS_FLOAT ? 1e-5 : b->tolerance);
    attach_circuit(d);
    return pzs_equilibrium(&d->solver, d->value);
}

static inline void bent_close(bent_device *d)
{
    free(d->given);
    free(d->value);
    free(d->motion);
    free(d->work);
    free(d->circuit_work);
    device_close(&d->device);
}

#endif
