/* Checksums, finite numbers and the words of the statuses. */
#include "guard.h"

/* Remainders of the upper and of the lower half of a byte: 128 bytes of flash instead of 1 KB. */
static const uint32_t upper_half[16] = {
    0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u, 0x4DB26158u, 0x5005713Cu,
    0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu, 0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu,
};
static const uint32_t lower_half[16] = {
    0x00000000u, 0x77073096u, 0xEE0E612Cu, 0x990951BAu, 0x076DC419u, 0x706AF48Fu, 0xE963A535u, 0x9E6495A3u,
    0x0EDB8832u, 0x79DCB8A4u, 0xE0D5E91Eu, 0x97D2D988u, 0x09B64C2Bu, 0x7EB17CBDu, 0xE7B82D07u, 0x90BF1D91u,
};

uint32_t guard_crc(uint32_t crc, const void *data, size_t bytes)
{
    const uint8_t *byte = data;
    for (size_t i = 0; i < bytes; i++) {
        crc ^= byte[i];
        crc = (crc >> 8) ^ lower_half[crc & 15u] ^ upper_half[crc >> 4 & 15u];
    }
    return crc;
}

/* x - x is 0 for a finite number, NaN for NaN and the infinities. */
int32_t guard_nonfinite(const pzs_real *x, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        const pzs_real none = x[i] - x[i];
        if (!(none <= 0))
            return (int32_t)i;
    }
    return -1;
}

/* One array of `count` entries of `size` bytes; an absent array leaves no trace. */
static uint32_t array_crc(uint32_t crc, const void *data, size_t count, size_t size)
{
    return data != NULL ? guard_crc(crc, data, count * size) : crc;
}

/* The number of entries is itself in the table: start is summed first, and the sum is not
 * led past count * dof entries, the most that rows can have, by a damaged start. */
static uint32_t rows_crc(uint32_t crc, const pzs_rows *rows, uint32_t dof)
{
    if (rows->start == NULL)
        return crc;
    crc = guard_crc(crc, rows->start, ((size_t)rows->count + 1u) * sizeof rows->start[0]);
    const uint32_t entries = rows->start[rows->count];
    if (entries > (uint32_t)rows->count * dof)
        return ~crc;
    crc = array_crc(crc, rows->dof, entries, sizeof rows->dof[0]);
    return array_crc(crc, rows->value, entries, sizeof rows->value[0]);
}

uint32_t guard_structure_crc(const pzs_structure *s)
{
    const size_t corners = 4u * (size_t)s->unknowns;
    const uint16_t counts[5] = {s->nodes, s->elements, s->kinds, s->unknowns, s->dof};
    uint32_t crc = guard_crc(GUARD_CRC_START, counts, sizeof counts);
    crc = array_crc(crc, s->element, s->elements, sizeof s->element[0]);
    crc = array_crc(crc, s->element_kind, s->elements, sizeof s->element_kind[0]);
    crc = array_crc(crc, s->node_dof, (size_t)s->nodes * s->unknowns, sizeof s->node_dof[0]);
    crc = array_crc(crc, s->first, s->dof, sizeof s->first[0]);
    crc = array_crc(crc, s->stiffness, s->kinds * (corners * (corners + 1u) / 2u), sizeof s->stiffness[0]);
    crc = array_crc(crc, s->kind, s->kinds, sizeof s->kind[0]);
    crc = rows_crc(crc, &s->input, s->dof);
    return ~rows_crc(crc, &s->output, s->dof);
}

uint32_t guard_problem_crc(const pzs_problem *p)
{
    const size_t n = p->inputs, m = p->outputs;
    const uint16_t counts[2] = {p->inputs, p->outputs};
    uint32_t crc = guard_crc(GUARD_CRC_START, counts, sizeof counts);
    crc = array_crc(crc, p->influence, m * n, sizeof(pzs_real));
    crc = array_crc(crc, p->hessian, n * n, sizeof(pzs_real));
    crc = array_crc(crc, p->weight, m, sizeof(pzs_real));
    crc = array_crc(crc, p->lower, n, sizeof(pzs_real));
    crc = array_crc(crc, p->upper, n, sizeof(pzs_real));
    crc = array_crc(crc, p->slew, n, sizeof(pzs_real));
    crc = array_crc(crc, p->prefer, n, sizeof(pzs_real));
    return ~guard_crc(crc, &p->effort, sizeof p->effort);
}

const char *pzs_status_text(pzs_status status)
{
    switch (status) {
    case PZS_OK: return "ok";
    case PZS_W_PASSES: return "pass budget spent: volts allowed, not yet optimal";
    case PZS_W_SLEW: return "slew and limit do not meet: the limit won";
    case PZS_W_SENSOR: return "a measurement is not finite or frozen: its last disturbance is kept";
    case PZS_W_HELD: return "no usable measurement or target: volts held";
    case PZS_W_ELECTRODE: return "an electrode does not follow its amplifier: it is held";
    case PZS_W_UNSTABLE: return "an equilibrium with negative pivots: not a stable shape";
    case PZS_W_BEHIND: return "a part of the shell that faces away from the body lies in it";
    case PZS_E_ARGUMENT: return "null pointer, or a size or index out of range";
    case PZS_E_FORMAT: return "tables of another format or scene";
    case PZS_E_CRC: return "tables damaged";
    case PZS_E_WORKSPACE: return "workspace too small or misaligned";
    case PZS_E_STAGE: return "called before the stage it builds on";
    case PZS_E_NONFINITE: return "NaN or infinity in an input";
    case PZS_E_LIMITS: return "lower limit above upper, or not a number";
    case PZS_E_LOOSE: return "no stiffness left: a loose part, or a missing support";
    case PZS_E_NEGATIVE: return "negative pivot in a structure at rest";
    case PZS_E_CONDITION: return "condition estimate above what this precision carries";
    case PZS_E_RESIDUAL: return "refinement ended with an estimated error above the root of epsilon";
    case PZS_E_DIVERGED: return "no equilibrium found beyond the last one";
    case PZS_E_LIMIT: return "a limit or branching point is near";
    case PZS_E_CONTACT: return "contact kept changing; a loose shell must touch the body from the start, pressed";
    case PZS_E_PENETRATION: return "the body of the contact enters the shell";
    case PZS_E_SYSTEMS: return "budget of linear systems spent";
    default: return "unknown status";
    }
}
