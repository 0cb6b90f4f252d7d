// SPDX-License-Identifier: BSD-2-Clause
// Hold a shape from C++ without exceptions; the loop estimates it from eight displacements.
#include "board.h"
#include "plate.h"

namespace {

class Mirror {
  public:
    pzs_status open()
    {
        return pzs_loop_init(&loop, plate_blocks, PLATE_BLOCKS, nullptr, work, sizeof work);
    }

    pzs_status tick(const pzs_real *wanted, const pzs_real *from)
    {
        return pzs_loop_tick(&loop, wanted, from);
    }

    const pzs_real *voltage() const { return loop.info.voltage; }
    pzs_status hold(unsigned input, pzs_real volts)
    {
        return pzs_hold(loop.info.control, static_cast<uint16_t>(input), volts);
    }

  private:
    pzs_loop loop;
    pzs_real work[PLATE_LOOP_BYTES / sizeof(pzs_real) + 1];
};

Mirror mirror;
pzs_real readings[PLATE_READINGS];

// The plant: what the tables say that the sensors show per volt.
void read_sensors()
{
    for (int s = 0; s < PLATE_READINGS; s++) {
        readings[s] = 0;
        for (int k = 0; k < PLATE_INPUTS; k++)
            readings[s] += plate_direct[s * PLATE_INPUTS + k] * mirror.voltage()[k];
    }
}

} // namespace
int main()
{
    board_start();
    pzs_status status = mirror.open();
    if (!PZS_IS_ERROR(status))
        status = mirror.hold(PLATE_INPUT_v_1_1, PZS_R(5)); // an amplifier by its name
    for (int tick = 0; tick < 100 && !PZS_IS_ERROR(status); tick++) {
        read_sensors();
        status = mirror.tick(plate_target, readings);
    }
    for (const char *text = pzs_status_text(status); *text != '\0'; text++)
        board_put(*text);
    board_put('\n');
    const pzs_real held = mirror.voltage()[PLATE_INPUT_v_1_1];
    return PZS_IS_ERROR(status) || held < 5 || held > 5;
}
