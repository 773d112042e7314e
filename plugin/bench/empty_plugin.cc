// SPDX-License-Identifier: Apache-2.0
// A plugin that does nothing, where ours would be called: what MuJoCo's own dispatch costs.
//
// Loading the library registers it. Like ours it gives passive forces and sensor values and has a
// state; its callbacks return at once.

#include <mujoco/mujoco.h>

namespace {

int OneNumber(const mjModel*, int) { return 1; }
int OneSensorNumber(const mjModel*, int, int) { return 1; }
int Init(const mjModel*, mjData*, int) { return 0; }
void Reset(const mjModel*, mjtNum* plugin_state, void*, int) { *plugin_state = 0; }
void Compute(const mjModel*, mjData*, int, int) {}
void Advance(const mjModel*, mjData*, int) {}

}  // namespace

mjPLUGIN_LIB_INIT(mujoco_impact_bench) {
  mjpPlugin plugin;
  mjp_defaultPlugin(&plugin);
  plugin.name = "mujoco_impact.empty";
  plugin.capabilityflags = mjPLUGIN_PASSIVE | mjPLUGIN_SENSOR;
  plugin.needstage = mjSTAGE_POS;
  plugin.nstate = OneNumber;
  plugin.nsensordata = OneSensorNumber;
  plugin.init = Init;
  plugin.reset = Reset;
  plugin.compute = Compute;
  plugin.advance = Advance;
  mjp_registerPlugin(&plugin);
}
