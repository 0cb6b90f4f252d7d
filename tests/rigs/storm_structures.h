/* SPDX-License-Identifier: BSD-2-Clause */
/*
 * Structures with mass, of 0.5 Hz to 1.6 kHz, at 100 Hz to 20 kHz, on which sweeps try loops that
 * damp vibration.
 */
#ifndef STORM_STRUCTURES_H
#define STORM_STRUCTURES_H

#include <stdbool.h>

/* A structure, with a tick rate. */
typedef struct storm_structure {
    const char *name, *scene, *changes; /* scene: name of a shipped scene, or a path */
    bool is_quick;                      /* part of the short run */
} storm_structure;

#define LINEAR                                                                                     \
    "kinematics=linear;simulate.influence=undeformed;simulate.plant.kinematics=linear;"            \
    "simulate.sensors.noise=0;simulate.amplifiers.step=0;simulate.events=[];"
#define MIRROR                                                                                     \
    "dynamics={damping: 0.01};limits={voltage: [-50, 50], step_limit: 3.3};simulate={ticks: 10};"
#define RIGS "tests/rigs/scenes/"

/*
 * Initialisers of the structures. The two arguments say whether the plate, and the structure with
 * near-equal modes, are part of the short run.
 */
#define STORM_STRUCTURES(plate_is_quick, twins_are_quick)                                          \
    {"plate, 15 Hz, 1 kHz", "plate-closed-loop", LINEAR, plate_is_quick},                          \
        {"near-equal modes, 41 Hz, 1 kHz", RIGS "storm-twins.yaml", "", twins_are_quick},          \
        {"panel, 54 and 63 Hz, 500 Hz", RIGS "storm-panel.yaml", "control.rate=500", false},       \
        {"panel, 1 kHz", RIGS "storm-panel.yaml", "", true},                                       \
        {"panel, 2 kHz", RIGS "storm-panel.yaml", "control.rate=2000", false},                     \
        {"panel, 5 kHz", RIGS "storm-panel.yaml", "control.rate=5000", false},                     \
        {"mirror, 1.6 kHz, 2 kHz", "mirror", MIRROR "control={rate: 2000}", false},                \
        {"mirror, 5 kHz", "mirror", MIRROR "control={rate: 5000}", false},                         \
        {"mirror, 10 kHz", "mirror", MIRROR "control={rate: 10000}", false},                       \
        {"mirror, 20 kHz", "mirror", MIRROR "control={rate: 20000}", false},                       \
    {                                                                                              \
        "soft plate, 0.5 Hz, 100 Hz", "plate-closed-loop",                                         \
            LINEAR                                                                                 \
            "materials.AS4/3501.density=1440000;materials.G1195.density=6840000;control.rate=100;" \
            "limits={voltage: [-300, 300], step_limit: 20}",                                       \
            false                                                                                  \
    }

#endif
