// SPDX-License-Identifier: Apache-2.0

#include "engine/record/sensor.h"

#include "engine/state/state.h"

namespace mujoco_impact::engine {

namespace {

// What the sensor tells of a geom, in its order.
struct Told {
  double force[3];
  GeomReading reading;
};
static_assert(sizeof(Told) == kNumbersPerGeom * sizeof(mjtNum));

}  // namespace

void ComputeSensors(const mjModel* m, mjData* d, int instance, bool impacts) {
  if (m->opt.disableflags & mjDSBL_SENSOR) return;
  State state(m, d, instance);
  for (int i = 0; i < m->nsensor; ++i) {
    if (m->sensor_type[i] != mjSENS_PLUGIN || m->sensor_plugin[i] != instance) continue;
    auto* told = reinterpret_cast<Told*>(d->sensordata + m->sensor_adr[i]);
    for (int k = 0, count = state.capacity(); k < count; ++k) {
      const GeomRecord& record = state.record(k);
      told[k] = {{0, 0, 0}, impacts ? record.next : record.last};
      if (impacts) mju_copy3(told[k].force, record.force);
    }
  }
}

}  // namespace mujoco_impact::engine
