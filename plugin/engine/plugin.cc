// SPDX-License-Identifier: Apache-2.0

#include "engine/plugin.h"

#include <mujoco/mujoco.h>

#include "engine/commit.h"
#include "engine/record/sensor.h"
#include "engine/record/visualize.h"
#include "engine/scene/assignment.h"
#include "engine/scene/config.h"
#include "engine/scene/meeting.h"
#include "engine/scene/ownership.h"
#include "engine/scene/texts.h"
#include "engine/state/state.h"
#include "engine/step.h"

namespace mujoco_impact::engine {

namespace {

int StateSize(const mjModel* m, int instance) { return State::Size(m, OwnedCapacity(m, instance)); }

int SensorSize(const mjModel* m, int instance, int) {
  return kNumbersPerGeom * OwnedCapacity(m, instance);
}

// What no attribute can mend: MuJoCo would not call the plugin, or would solve its contacts itself.
const char* ModelFault(const mjModel* m, int instance) {
  if ((m->opt.disableflags & mjDSBL_SPRING) && (m->opt.disableflags & mjDSBL_DAMPER)) {
    return "passive forces are off (flags spring and damper are both disabled), so bodies would "
           "fall through each other; allowed: at most one of the two disabled";
  }
  if (m->opt.enableflags & mjENBL_OVERRIDE) {
    return "the flag override gives the contacts back to MuJoCo's solver; allowed: override off";
  }
  return TupleFault(m, instance);
}

const char* Name(const mjModel* m, int type, int id) {
  const char* name = mj_id2name(m, type, id);
  return name ? name : "";
}

// Whether a contact of the instance would depend on the order of the instances, with a warning.
bool WarnOfConflict(const mjModel* m, int instance) {
  const Meeting meeting = FindConflict(m, instance);
  if (meeting.other < 0) return false;
  mju_warning(
      "%s: the instances '%s' and '%s' have different settings, and their geoms '%s' and '%s' can "
      "meet; allowed: the same settings in both, one instance for all of these geoms, or geoms "
      "kept apart by contype and conaffinity",
      kPluginName, Name(m, mjOBJ_PLUGIN, instance), Name(m, mjOBJ_PLUGIN, meeting.other),
      Name(m, mjOBJ_GEOM, meeting.geom[0]), Name(m, mjOBJ_GEOM, meeting.geom[1]));
  return true;
}

int Init(const mjModel* m, mjData* d, int instance) {
  d->plugin_data[instance] = 0;
  if (const char* fault = ModelFault(m, instance)) {
    mju_warning("%s: %s", kPluginName, fault);
    return -1;
  }
  ConfigError error;
  const Config config = ReadConfig(m, instance, Ownership(m, instance).size(), &error);
  if (!error.message[0]) error = CheckAssignment(m, instance, config);
  if (error.message[0]) {
    // MuJoCo cuts its errors off at 500 bytes, wherever that is
    mju_warning("%s: %.*s", kPluginName, ShownLength(error.message, 430), error.message);
    return -1;
  }
  return WarnOfConflict(m, instance) ? -1 : 0;
}

void Compute(const mjModel* m, mjData* d, int instance, int capability) {
  if (capability == mjPLUGIN_PASSIVE) ComputeStep(m, d, instance);
  if (capability == mjPLUGIN_SENSOR) ComputeSensors(m, d, instance, false);
}

void Reset(const mjModel* m, mjtNum* plugin_state, void*, int instance) {
  State::Reset(m, plugin_state, instance);
}

}  // namespace

void RegisterPlugin() {
  mjpPlugin plugin;
  mjp_defaultPlugin(&plugin);
  plugin.name = kPluginName;
  plugin.nattribute = kAttributeCount;
  plugin.attributes = kAttributes;
  plugin.capabilityflags = mjPLUGIN_PASSIVE | mjPLUGIN_SENSOR;
  // the later stages would make MuJoCo compute quantities that no one reads (sensor.h)
  plugin.needstage = mjSTAGE_POS;
  plugin.nstate = StateSize;
  plugin.nsensordata = SensorSize;
  plugin.init = Init;
  plugin.reset = Reset;
  plugin.compute = Compute;
  plugin.advance = CommitStep;
  plugin.visualize = DrawPulses;
  mjp_registerPlugin(&plugin);
}

}  // namespace mujoco_impact::engine
