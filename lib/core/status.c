/* SPDX-License-Identifier: BSD-2-Clause */
/* Texts of the statuses, and version of the library. */
#include "pzs_base.h"

const char *pzs_version(void)
{
    return PZS_VERSION_TEXT;
}

const char *pzs_status_text(pzs_status status)
{
    switch (status) {
    case PZS_OK: return "ok";
    case PZS_W_ITERATIONS: return "iteration limit reached: voltages feasible, not yet optimal";
    case PZS_W_STEP_LIMIT:
        return "step limit and voltage limits do not overlap: the voltage limit takes precedence";
    case PZS_W_SENSOR: return "a measurement is missing or stuck: its last disturbance is kept";
    case PZS_W_HELD: return "no usable measurement or target: voltages kept, or led by the model";
    case PZS_W_ELECTRODE: return "an electrode does not follow its amplifier: it is held";
    case PZS_W_UNSTABLE: return "unstable equilibrium: the tangent has negative pivots";
    case PZS_W_BEHIND:
        return "a part of the shell that faces away from the contact body lies in it";
    case PZS_W_PARKED: return "not in control: at the park voltages, or on the way there";
    case PZS_W_RAMP: return "control was taken away: the output ramps to its park voltages";
    case PZS_W_OUTPUT: return "the last gate has corrected a voltage: working memory was damaged";
    case PZS_W_SELFTEST: return "self-test of amplifiers and sensors: not yet in control";
    case PZS_W_LIMIT_ROWS:
        return "limits between inputs allow only a gradual way to the voltages that are held";
    case PZS_W_UNOBSERVABLE:
        return "the records do not determine the effect of an input: its column is kept";
    case PZS_W_GATED:
        return "a measurement is beyond its range or contradicts the others: taken as missing";
    case PZS_W_MODE_COUNT:
        return "the vibration modes have converged, but cannot be counted in this precision";
    case PZS_W_CONTRADICTION:
        return "measurements contradict the model: an unknown load, or too many wrong sensors";
    case PZS_W_POLARITY:
        return "the shape is opposite to its prediction: ramps test the polarity of the amplifiers";
    case PZS_E_ARGUMENT: return "null pointer, or a size or index out of range";
    case PZS_E_FORMAT: return "tables of another format or scene";
    case PZS_E_CRC: return "tables do not match their checksum";
    case PZS_E_WORKSPACE: return "workspace too small or misaligned";
    case PZS_E_STAGE: return "called before the stage that it needs";
    case PZS_E_LATCHED: return "control was taken away: parked until the loop is initialised";
    case PZS_E_NONFINITE: return "NaN or infinity in an input";
    case PZS_E_LIMITS:
        return "a lower limit above the upper one, one that is no number, or a voltage outside";
    case PZS_E_LOOSE: return "no stiffness: a loose part, or a missing support";
    case PZS_E_NEGATIVE: return "negative pivot in the undeformed structure";
    case PZS_E_CONDITION: return "condition estimate above what this precision can solve";
    case PZS_E_RESIDUAL:
        return "refinement ended with an estimated error above the square root of epsilon";
    case PZS_E_DIVERGED: return "no equilibrium found beyond the last one";
    case PZS_E_LIMIT: return "a limit point or a bifurcation is near";
    case PZS_E_CONTACT:
        return "contact did not converge; a loose shell must touch the body and be pressed onto it";
    case PZS_E_PENETRATION: return "the contact body would enter the shell";
    case PZS_E_SOLVES: return "limit on linear solves reached";
    case PZS_E_SELFTEST:
        return "self-test: an amplifier or sensor is faulty, or vibration hides its response";
    case PZS_E_MASS: return "a free degree of freedom has no mass";
    case PZS_E_MODES:
        return "vibration modes not converged: more Lanczos vectors or a higher limit on solves";
    case PZS_E_MODE_COUNT:
        return "a count of pivots contradicts the vibration modes found: ask for one more or fewer";
    case PZS_E_CAPACITANCE: return "an open electrode has no capacitance of its own";
    default: return "unknown status";
    }
}
